//! WebAssembly (wasm32-unknown-unknown): its standard library, and midair run there against midair here.
//!
//! Where rustup brings the target, that is used. Where it cannot (a machine that reaches package mirrors only), Debian's `rustc-web`, unpacked into
//! the build folder and never installed, builds the standard library from Debian's sources of it.

use crate::book::{self, Profile};
use crate::test::Tally;
use crate::{process, setup};
use anyhow::{Context, Result, bail};
use std::path::{Path, PathBuf};
use std::process::Command;

const TARGET: &str = "wasm32-unknown-unknown";

/// The package that is built for WebAssembly, and for this machine as what it is compared with.
const PACKAGE: &str = "midair-wasm-check";

/// Brings node and the target's standard library.
pub fn install() -> Result<()> {
    if !process::succeeds(Command::new("node").arg("--version")) {
        setup::apt_install(&["nodejs"])?;
    }
    if has_target() || debian_rustc().is_file() {
        return Ok(());
    }
    println!("getting the standard library of {TARGET}");
    if process::succeeds(Command::new("rustup").args(["target", "add", TARGET])) && has_target() {
        return Ok(());
    }
    from_debian().with_context(|| {
        format!("there is no standard library of {TARGET}: `rustup target add {TARGET}` failed, and Debian's could not be had")
    })
}

/// Builds the package for WebAssembly, as the studio's page has its core, and for this machine, as the tests are built; the latter runs the former under
/// node and compares.
pub fn run() -> Tally {
    let module = match build(PACKAGE) {
        Ok(module) => module,
        Err(error) => return Tally::of(Err(error)),
    };
    let built = process::build_for_tests();
    if built.is_err() {
        return Tally::of(built);
    }
    let mut command = Command::new(book::program_folder(Profile::Dev).join(PACKAGE));
    // One thread here as well, so that times compare.
    command.arg(module).env("RAYON_NUM_THREADS", "1");
    Tally::watched(&mut command, |tally, line| {
        tally.passed += usize::from(line.starts_with("ok: "));
        tally.failed += usize::from(line.starts_with("FAILED: "));
    })
}

/// What is built for WebAssembly is built one way: the standard library and all dependencies serve every package.
const PROFILE: &str = "studio";

/// Builds a package's module; where it lies.
pub fn build(package: &str) -> Result<PathBuf> {
    let mut command = process::cargo(&["build", "--quiet", "--lib", "--profile", PROFILE]);
    command.args(["--package", package, "--target", TARGET]);
    let folder = crate::root().join("target/wasm-build");
    command.arg("--target-dir").arg(&folder);
    if !has_target() {
        let rustc = debian_rustc();
        if !rustc.is_file() {
            bail!("no standard library of {TARGET}; `cargo xtask test --only setup` brings it");
        }
        command.args(["-Z", "build-std=std,panic_abort"]);
        // Building the standard library is not stable yet; only this child is told that it may.
        command.env("RUSTC_BOOTSTRAP", "1").env("RUSTC", rustc);
        command.env("LD_LIBRARY_PATH", debian_folder().join("usr/lib/x86_64-linux-gnu"));
        command.env("CARGO_TARGET_WASM32_UNKNOWN_UNKNOWN_LINKER", linker()?);
    }
    process::run(&mut command)?;
    let file = format!("{}.wasm", package.replace('-', "_"));
    Ok(folder.join(TARGET).join(PROFILE).join(file))
}

/// Whether the toolchain in use has the target's standard library.
fn has_target() -> bool {
    let asked = process::output(Command::new("rustc").args([
        "--print",
        "target-libdir",
        "--target",
        TARGET,
    ]));
    asked.is_ok_and(|folder| Path::new(folder.trim()).is_dir())
}

/// LLVM's linker, which comes with each toolchain of rustup's.
fn linker() -> Result<PathBuf> {
    let sysroot = process::output(Command::new("rustc").args(["--print", "sysroot"]))?;
    let host = process::output(Command::new("rustc").args(["--print", "host-tuple"]))?;
    let beside = Path::new(sysroot.trim()).join("lib/rustlib").join(host.trim());
    let path = beside.join("bin/rust-lld");
    if !path.is_file() {
        bail!("{} is not there; install Rust by rustup", path.display());
    }
    Ok(path)
}

fn debian_folder() -> PathBuf {
    crate::root().join("target/wasm-toolchain")
}

fn debian_rustc() -> PathBuf {
    debian_folder().join("usr/bin/rustc")
}

/// Unpacks Debian's compiler and the sources of its standard library. Their package would take the place of other Rust packages if it were
/// installed; unpacked it touches nothing.
fn from_debian() -> Result<()> {
    if !process::succeeds(Command::new("dpkg-deb").arg("--version")) {
        bail!("this is no Debian system");
    }
    setup::apt_get(&["update"], "the list of packages")?;
    let driver = dependency("libstd-rust-web-dev", "libstd-rust-web-")?;
    let llvm = dependency(&driver, "libllvm")?;
    setup::apt_install(&[&llvm])?;

    let part = debian_folder().with_extension("part");
    if part.exists() {
        std::fs::remove_dir_all(&part)?;
    }
    std::fs::create_dir_all(&part)?;
    let packages = ["rustc-web", "libstd-rust-web-dev", driver.as_str(), "rust-web-src"];
    process::run(
        Command::new("apt-get").args(["-qq", "download"]).args(packages).current_dir(&part),
    )?;
    // Of the sources the library alone, not the compiler.
    let unpack = "set -euo pipefail\n\
        for package in *.deb; do case $package in\n\
          rust-web-src_*) dpkg-deb --fsys-tarfile $package | tar -x --wildcards './usr/lib/*' './usr/src/*/library/*' ;;\n\
          *) dpkg-deb -x $package . ;;\n\
        esac; rm $package; done";
    process::run(Command::new("bash").args(["-c", unpack]).current_dir(&part))?;
    std::fs::rename(&part, debian_folder())?;
    Ok(())
}

/// What a package depends on whose name begins so: their names hold versions.
fn dependency(package: &str, begins: &str) -> Result<String> {
    let depends = process::output(Command::new("apt-cache").args(["depends", package]))?;
    let mut names = depends.lines().filter_map(|line| line.trim().strip_prefix("Depends: "));
    names
        .find(|name| name.starts_with(begins))
        .map(str::to_owned)
        .with_context(|| format!("Debian's package {package} needs no {begins}*"))
}
