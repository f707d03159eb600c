//! What tests need beyond Rust: ffmpeg, a Python environment with the peers that results are held to, and LPIPS' weights.

use crate::{process, python, studio, wasm};
use anyhow::{Context, Result, bail};
use midair_peers::Peer;
use std::path::{Path, PathBuf};
use std::process::Command;

/// What is pinned for the tests, and what benchmarks add.
pub const TEST_PACKAGES: &str = "xtask/peers/requirements.txt";
/// See [`TEST_PACKAGES`].
pub const BENCH_PACKAGES: &str = "xtask/peers/requirements-bench.txt";

/// The Python of `.venv`.
pub fn python() -> PathBuf {
    python_in(&crate::root().join(".venv"))
}

/// An environment's Python.
pub fn python_in(environment: &Path) -> PathBuf {
    environment.join("bin/python3")
}

/// Installs what is missing; with everything in place the network is not touched. Where an `optional` peer cannot be had, a note says so.
pub fn install(optional: &[Peer]) -> Result<()> {
    for peer in Peer::ALL {
        match install_one(peer) {
            Err(error) if optional.contains(&peer) => println!("note: without {peer}: {error:#}"),
            outcome => outcome?,
        }
    }
    wasm::install()?;
    studio::install_browser()?;
    python::install()?;
    println!("what the tests need is in place");
    Ok(())
}

/// Installs what a peer needs, if it is missing.
pub fn install_one(peer: Peer) -> Result<()> {
    match peer {
        Peer::Ffmpeg if !process::succeeds(Command::new("ffmpeg").arg("-version")) => {
            apt_install(&["ffmpeg"])
        }
        // For the live show's window: a virtual screen, keys and screenshots.
        Peer::Screen if !["Xvfb", "xdotool", "xwd"].into_iter().all(on_path) => {
            apt_install(&["xvfb", "xdotool", "x11-apps", "libx11-xcb1", "libxkbcommon-x11-0"])
        }
        // A graphics device in software, for machines without one.
        Peer::Graphics if !Path::new("/usr/share/vulkan/icd.d").is_dir() => {
            apt_install(&["mesa-vulkan-drivers", "libvulkan1"])
        }
        Peer::Python => python_packages(TEST_PACKAGES),
        Peer::Lpips => weights(),
        Peer::Blender => blender(),
        Peer::Ffmpeg | Peer::Screen | Peer::Graphics => Ok(()),
        // Part of the machine.
        Peer::Namespaces | Peer::Avx2 => Ok(()),
    }
}

/// Gets LPIPS' weights into midair's cache, unless they are there: 64 MB, once.
pub fn weights() -> Result<()> {
    let script = "crates/midair-cli/lpips_weights.py";
    let asked = |more: &[&str]| {
        let mut command = Command::new(python());
        command.arg(script).args(more).current_dir(crate::root());
        command
    };
    if process::succeeds(&mut asked(&["--check"])) {
        return Ok(());
    }
    println!("getting LPIPS' weights");
    process::run(&mut asked(&[])).context("LPIPS' weights cannot be had")
}

/// Blender as a Python module, in an environment of its own: its wheels are for one version of Python each, this one for 3.11.
const BLENDER: &str = "bpy==4.2.23";

fn blender() -> Result<()> {
    let folder = crate::root().join(".venv-blender");
    let python = folder.join("bin/python3");
    if process::succeeds(Command::new(&python).args(["-c", "import bpy"])) {
        return Ok(());
    }
    let fits = "import sys; sys.exit(sys.version_info[:2] != (3, 11))";
    if !process::succeeds(Command::new("python3").args(["-c", fits])) {
        bail!(
            "Blender's module {BLENDER} needs Python 3.11: install it, or test --optional blender"
        );
    }
    println!("installing {BLENDER} into .venv-blender");
    let made = make_environment(&folder).and_then(|()| {
        process::run(pip_install(&python).args(["--timeout", "30", "--retries", "1", BLENDER]))
    });
    made.context("Blender's Python module cannot be had")
}

/// `pip install` of an environment's Python; what to install follows.
pub fn pip_install(python: &Path) -> Command {
    let mut pip = Command::new(python);
    // Modules are compiled when they are first imported, which most of them never are.
    pip.args(["-m", "pip", "install", "--quiet", "--disable-pip-version-check", "--no-compile"]);
    pip
}

/// Whether there is a program of this name.
fn on_path(name: &str) -> bool {
    let path = std::env::var_os("PATH").unwrap_or_default();
    std::env::split_paths(&path).any(|folder| folder.join(name).is_file())
}

/// Brings the packages of a requirements file into `.venv`, which is made if it is not there.
pub fn python_packages(requirements: &str) -> Result<()> {
    packages_into(&crate::root().join(".venv"), requirements)
}

/// Brings the packages of a requirements file into an environment, which is made if it is not there.
pub fn packages_into(environment: &Path, requirements: &str) -> Result<()> {
    let python = python_in(environment);
    if has_packages(&python, requirements)? {
        return Ok(());
    }
    if !process::succeeds(Command::new(&python).arg("--version")) {
        make_environment(environment)?;
    }
    println!("installing {requirements} into {}", environment.display());
    let mut pip = pip_install(&python);
    process::run(pip.arg("--requirement").arg(requirements).current_dir(crate::root()))
        .with_context(|| format!("the packages of {requirements} cannot be installed"))
}

/// Makes an environment; one that is there is emptied.
pub fn make_environment(folder: &Path) -> Result<()> {
    // On Debian `venv` is there without `ensurepip` unless python3-venv is installed.
    if !process::succeeds(Command::new("python3").args(["-c", "import ensurepip, venv"])) {
        apt_install(&["python3", "python3-venv"])?;
    }
    println!("making the Python environment {}", folder.display());
    process::run(Command::new("python3").args(["-m", "venv", "--clear"]).arg(folder))
}

/// Whether an environment holds exactly the versions that a requirements file pins.
fn has_packages(python: &Path, requirements: &str) -> Result<bool> {
    let path = crate::root().join(requirements);
    let pins = pins(&path)?;
    let program = "import sys, importlib.metadata as m\n\
                   sys.exit(any(m.version(a[0]) != a[1] for a in \
                   (p.split('==') for p in sys.argv[1:])))";
    Ok(process::succeeds(Command::new(python).args(["-c", program]).args(pins)))
}

fn pins(path: &Path) -> Result<Vec<String>> {
    let text = std::fs::read_to_string(path)
        .with_context(|| format!("{} cannot be read", path.display()))?;
    let lines = text.lines().map(|line| line.split('#').next().unwrap_or_default().trim());
    let pins: Vec<String> = lines.filter(|line| !line.is_empty()).map(str::to_owned).collect();
    if let Some(loose) = pins.iter().find(|pin| !pin.contains("==")) {
        bail!("{}: `{loose}` names no version; write NAME==VERSION", path.display());
    }
    Ok(pins)
}

/// Installs Debian's packages.
pub fn apt_install(packages: &[&str]) -> Result<()> {
    let list = packages.join(" ");
    println!("installing {list}");
    apt_get(&["update"], &list)?;
    apt_get(&[&["install", "--no-install-recommends"], packages].concat(), &list)
        .with_context(|| format!("{list} cannot be installed"))
}

/// Runs `apt-get` as root, for what `wanted` names.
pub fn apt_get(arguments: &[&str], wanted: &str) -> Result<()> {
    let root = process::succeeds(Command::new("bash").args(["-c", "test $(id -u) = 0"]));
    let sudo = !root && process::succeeds(Command::new("sudo").args(["-n", "true"]));
    let apt = process::succeeds(Command::new("apt-get").arg("--version"));
    if !apt || !(root || sudo) {
        bail!(
            "{wanted}: not installed, and {}; install by hand what is called so on this system",
            if apt { "this user is neither root nor may use sudo" } else { "there is no apt-get" }
        );
    }
    let mut command = Command::new(if root { "env" } else { "sudo" });
    if !root {
        command.args(["-n", "env"]);
    }
    command.args(["DEBIAN_FRONTEND=noninteractive", "apt-get", "-qq", "-y"]).args(arguments);
    process::run(&mut command)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_requirements_files_pin_every_package() {
        for file in [TEST_PACKAGES, BENCH_PACKAGES] {
            assert!(!pins(&crate::root().join(file)).unwrap().is_empty());
        }
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("loose.txt");
        std::fs::write(&path, "a==1 # why\n\nnumpy>=2\n").unwrap();
        assert!(pins(&path).unwrap_err().to_string().contains("numpy>=2"));
    }
}
