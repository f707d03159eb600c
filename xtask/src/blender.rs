//! `cargo xtask blender`: Blender's extension as an installable .zip, with midair's wheel and no other in it; and its tests.
//!
//! Blender's own tool, which comes with its Python module, builds and validates the .zip. The tests install it as a user would.

use crate::book::{self, Profile};
use crate::test::Tally;
use crate::{process, python as python_package, setup};
use anyhow::{Context, Result, bail, ensure};
use clap::Args;
use midair_peers::Peer;
use std::path::{Path, PathBuf};
use std::process::Command;

#[derive(Args)]
pub struct Options {
    /// The wheel to put in; left out: the newest of target/wheels, which `cargo xtask wheel` makes if there is none.
    #[arg(long, value_name = "FILE")]
    wheel: Option<PathBuf>,
    /// Run the tests on what was built, and put the pictures that they make into docs/pictures.
    #[arg(long)]
    pictures: bool,
}

/// Where Blender's tool lies in its Python module.
const TOOL: &str = "\
import glob, importlib.util, os
folder = importlib.util.find_spec('bpy').submodule_search_locations[0]
print(glob.glob(os.path.join(folder, '*/scripts/addons_core/bl_pkg/cli/blender_ext.py'))[0])";

/// Builds the .zip, validates it, and says where it is.
pub fn run(options: &Options) -> Result<bool> {
    setup::install_one(Peer::Blender)?;
    let python = midair_peers::blender().context("there is no Python with bpy")?;
    let zip = build(&python, options.wheel.as_deref())?;
    println!("{}", zip.display());
    if !options.pictures {
        return Ok(true);
    }
    // The tests hold the extension to the program.
    python_package::assemble()?;
    let tally = run_tests(&python, &zip, Some(&crate::root().join("docs/pictures")));
    println!("{tally}");
    Ok(tally.failed == 0)
}

/// Builds the extension and runs its tests; without Blender they are skipped where that is allowed.
pub fn test(optional: &[Peer]) -> Tally {
    let Some(python) = midair_peers::blender() else {
        if optional.contains(&Peer::Blender) {
            return Tally { skipped: 1, ..Tally::default() };
        }
        return Tally::of(Err(anyhow::anyhow!("the extension's tests need a Python with bpy")));
    };
    let folder = tempfile::tempdir();
    let built = folder.context("there is no place for a wheel").and_then(|folder| {
        python_package::assemble()?;
        build(&python, Some(&packed(&python, folder.path())?))
    });
    match built {
        Ok(zip) => run_tests(&python, &zip, None),
        Err(error) => Tally::of(Err(error)),
    }
}

/// Packs a folder of a Python package as a wheel.
const PACK: &str = "xtask/peers/pack_wheel.py";

/// A wheel of the package as it was built for the tests: one for users takes minutes to build.
fn packed(python: &Path, folder: &Path) -> Result<PathBuf> {
    let package = python_package::package_folder().join("midair");
    let mut pack = Command::new(python);
    pack.arg(PACK).arg(package).arg(env!("CARGO_PKG_VERSION")).arg(folder);
    pack.current_dir(crate::root());
    let wheel = process::output(&mut pack).context("the package cannot be packed as a wheel")?;
    Ok(PathBuf::from(wheel.trim()))
}

fn build(python: &Path, wheel: Option<&Path>) -> Result<PathBuf> {
    let wheel = match wheel {
        Some(wheel) => wheel.to_path_buf(),
        None => newest_wheel()?,
    };
    let name = wheel.file_name().context("the wheel has no name")?.to_string_lossy().into_owned();
    let staged = tempfile::tempdir()?;
    copy_sources(&crate::root().join("blender"), staged.path())?;
    let wheels = staged.path().join("wheels");
    std::fs::create_dir(&wheels)?;
    std::fs::copy(&wheel, wheels.join(&name))
        .with_context(|| format!("{} cannot be copied", wheel.display()))?;
    let path = staged.path().join("blender_manifest.toml");
    let manifest = std::fs::read_to_string(&path)?;
    std::fs::write(&path, with_wheel(&manifest, &name)?)?;

    let folder = crate::root().join("target/blender");
    std::fs::create_dir_all(&folder)?;
    let zip = folder.join(format!("midair-{}.zip", env!("CARGO_PKG_VERSION")));
    let tool = process::output(Command::new(python).args(["-c", TOOL]))
        .context("Blender's tool for extensions is not in its Python module")?;
    let tool = |task: &str| {
        let mut command = Command::new(python);
        command.arg(tool.trim()).arg(task);
        command
    };
    let mut build = tool("build");
    build.arg("--source-dir").arg(staged.path()).arg("--output-filepath").arg(&zip);
    process::run(&mut build)?;
    process::run(tool("validate").arg(&zip))?;
    Ok(zip)
}

/// The newest wheel of midair's in target/wheels, made if there is none.
fn newest_wheel() -> Result<PathBuf> {
    let folder = crate::root().join("target/wheels");
    if let Some(wheel) = newest(&folder)? {
        return Ok(wheel);
    }
    process::run(&mut process::cargo(&["xtask", "wheel"]))
        .context("there is no wheel of midair's Python package")?;
    newest(&folder)?
        .with_context(|| format!("`cargo xtask wheel` left none in {}", folder.display()))
}

fn newest(folder: &Path) -> Result<Option<PathBuf>> {
    let Ok(entries) = std::fs::read_dir(folder) else { return Ok(None) };
    let mut wheels = Vec::new();
    for entry in entries {
        let entry = entry?;
        let name = entry.file_name().to_string_lossy().into_owned();
        if name.starts_with("midair-") && name.ends_with(".whl") {
            wheels.push((entry.metadata()?.modified()?, entry.path()));
        }
    }
    Ok(wheels.into_iter().max().map(|(_, path)| path))
}

/// The manifest with its wheel, of this version and for that wheel's platform.
fn with_wheel(manifest: &str, wheel: &str) -> Result<String> {
    let version = format!("version = \"{}\"", env!("CARGO_PKG_VERSION"));
    ensure!(
        manifest.lines().any(|line| line == version),
        "blender/blender_manifest.toml: write {version}, as the workspace has it"
    );
    let head = "schema_version = \"1.0.0\"\n";
    let Some(rest) = manifest.strip_prefix(head) else {
        bail!("blender/blender_manifest.toml does not begin with {}", head.trim());
    };
    let platform = platform(wheel)?;
    Ok(format!("{head}wheels = [\"./wheels/{wheel}\"]\nplatforms = [\"{platform}\"]\n{rest}"))
}

/// Blender's name of a wheel's platform.
fn platform(wheel: &str) -> Result<&'static str> {
    let tag = wheel.trim_end_matches(".whl").rsplit('-').next().unwrap_or_default();
    let arm = tag.contains("arm64") || tag.contains("aarch64");
    Ok(match (tag.split('_').next().unwrap_or_default(), arm) {
        (linux, false) if linux.contains("linux") => "linux-x64",
        (linux, true) if linux.contains("linux") => "linux-arm64",
        ("macosx", true) => "macos-arm64",
        ("macosx", false) => "macos-x64",
        ("win", true) => "windows-arm64",
        ("win", false) => "windows-x64",
        _ => bail!("{wheel}: Blender runs on none of this wheel's platforms"),
    })
}

/// The extension's own files: all but its tests.
fn copy_sources(from: &Path, to: &Path) -> Result<()> {
    for entry in std::fs::read_dir(from)? {
        let entry = entry?;
        if entry.file_type()?.is_file() {
            std::fs::copy(entry.path(), to.join(entry.file_name()))?;
        }
    }
    Ok(())
}

/// Runs the tests on an extension, which they install; the pictures that they make go into a folder if there is one.
fn run_tests(python: &Path, zip: &Path, pictures: Option<&Path>) -> Tally {
    let mut command = Command::new(python);
    command.arg("blender/tests").current_dir(crate::root());
    command.env("MIDAIR_EXTENSION", zip);
    command.env("MIDAIR_PROGRAM", book::program_folder(Profile::Dev).join("midair"));
    // Structural similarity by scikit-image, which Blender's Python lacks.
    command.env("MIDAIR_PEERS_PYTHON", setup::python());
    if let Some(folder) = pictures {
        command.env("MIDAIR_PICTURES", folder);
    }
    Tally::watched(&mut command, |tally, line| {
        tally.passed += usize::from(line.starts_with("ok: "));
        tally.failed += usize::from(line.starts_with("FAILED: "));
        tally.skipped += usize::from(line.starts_with("skipped: "));
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_manifest_is_of_this_version_and_names_one_wheel() {
        let path = crate::root().join("blender/blender_manifest.toml");
        let manifest = std::fs::read_to_string(path).unwrap();
        let wheel = "midair-0.1.0-cp310-abi3-manylinux_2_34_x86_64.whl";
        let told = with_wheel(&manifest, wheel).unwrap();
        assert_eq!(told.matches(".whl").count(), 1);
        assert!(told.contains("platforms = [\"linux-x64\"]\n"));
        let other = manifest.replace("\nversion = ", "\nversion = \"9\" #");
        assert!(with_wheel(&other, wheel).unwrap_err().to_string().contains("write version = "));
    }

    #[test]
    fn a_wheel_s_platform_is_blender_s() {
        for (tag, blender) in [
            ("linux_x86_64", "linux-x64"),
            ("manylinux_2_28_aarch64", "linux-arm64"),
            ("macosx_11_0_arm64", "macos-arm64"),
            ("macosx_10_12_x86_64", "macos-x64"),
            ("win_amd64", "windows-x64"),
            ("win_arm64", "windows-arm64"),
        ] {
            let wheel = format!("midair-0.1.0-cp310-abi3-{tag}.whl");
            assert_eq!(platform(&wheel).unwrap(), blender);
        }
        assert!(platform("midair-0.1.0-py3-none-any.whl").is_err());
    }

    #[test]
    fn of_several_wheels_the_newest_counts() {
        let folder = tempfile::tempdir().unwrap();
        assert!(newest(&folder.path().join("none")).unwrap().is_none());
        for (name, age) in [("midair-2.whl", 60), ("midair-1.whl", 5), ("numpy-3.whl", 0)] {
            let file = std::fs::File::create(folder.path().join(name)).unwrap();
            let time = std::time::SystemTime::now() - std::time::Duration::from_secs(age);
            file.set_modified(time).unwrap();
        }
        let found = newest(folder.path()).unwrap().unwrap();
        assert_eq!(found.file_name().unwrap(), "midair-1.whl");
    }
}
