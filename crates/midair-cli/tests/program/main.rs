//! The program from outside: what it writes, says and refuses.

mod apply;
mod bad_input;
mod calibrate;
mod check;
mod compensate;
mod delivery;
mod evaluate;
mod explore;
mod files;
mod films;
mod fit;
mod map;
mod measure;
mod plate;
#[cfg(feature = "show")]
mod play;
mod proof;
mod set_ups;
mod studio;
mod view;
mod viewpoints;

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// The program, run in an empty folder of its own.
struct Bench {
    folder: tempfile::TempDir,
}

impl Bench {
    fn new() -> Self {
        Self { folder: tempfile::tempdir().unwrap() }
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn write(&self, name: &str, bytes: impl AsRef<[u8]>) -> PathBuf {
        let path = self.path(name);
        std::fs::write(&path, bytes).unwrap();
        path
    }

    fn command(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_midair"));
        command.args(arguments).current_dir(self.folder.path()).env("NO_COLOR", "1");
        command
    }

    fn run(&self, arguments: &[&str]) -> Output {
        self.command(arguments).output().unwrap()
    }

    /// What a run that must succeed says on standard output.
    fn succeed(&self, arguments: &[&str]) -> String {
        let output = self.run(arguments);
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{arguments:?}: {said}");
        String::from_utf8(output.stdout).unwrap()
    }

    /// The JSON that a run that must succeed prints.
    fn json(&self, arguments: &[&str]) -> serde_json::Value {
        let mut all = vec!["--json"];
        all.extend(arguments);
        serde_json::from_str(&self.succeed(&all)).unwrap()
    }

    /// What a run that must be refused says: exit code 2, no panic.
    fn refuse(&self, arguments: &[&str]) -> String {
        let output = self.run(arguments);
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {said}");
        assert!(!said.contains("panicked"), "{said}");
        assert!(output.stdout.is_empty(), "{arguments:?}");
        said
    }

    /// The names in a folder, sorted.
    fn names(&self, folder: &str) -> Vec<String> {
        let entries = std::fs::read_dir(self.path(folder)).unwrap();
        let mut names: Vec<String> =
            entries.map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }
}

/// A scene file of the repository.
fn scene(name: &str) -> String {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    root.join("scenes").join(name).display().to_string()
}

/// A set-up with a viewpoint straight ahead and a plate at 45 degrees, and more.
fn set_up(rest: &str) -> String {
    format!(
        "[viewpoint]\nposition = [0.0, 0.0, 800.0]\n[image]\nsize = [20.0, 20.0]\n[plate]\n\
         position = [0.0, 0.0, -150.0]\nrotation = [-45.0, 0.0, 0.0]\nsize = [488.0, 488.0]\n{rest}"
    )
}

const BALL: &str = "[[element]]\nname = \"ball\"\nshape = { kind = \"sphere\", radius = 25.0 }\n\
                        material = { ior = 1.49 }\n";

/// A picture of smooth waves.
fn waves(width: usize, height: usize) -> midair::picture::Picture {
    let wave = |x: f64, y: f64| (0.5 + 0.45 * x.sin() * y.cos()) as f32;
    let pixels = (0..width * height)
        .map(|i| {
            let (x, y) = ((i % width) as f64, (i / width) as f64);
            [
                wave(0.2 * x, 0.15 * y),
                wave(0.1 * x + 0.1 * y, 0.2 * y),
                wave(0.05 * y, 0.3 * x),
                1.0,
            ]
        })
        .collect();
    midair::picture::Picture { width, height, pixels }
}

/// A scene's text with the display as `midair check` advises it; as it is where no advice is given.
fn as_advised(bench: &Bench, text: &str) -> String {
    bench.write("unadvised.toml", text);
    let told = bench.json(&["check", "unadvised.toml", "--size", "64x64"]);
    let advice = &told["display"]["advice"];
    if advice.is_null() {
        return text.to_owned();
    }
    let (head, rest) = text.split_once("[display]").unwrap();
    let rest = &rest[rest.find("[[element]]").unwrap()..];
    let (position, rotation, size) = (&advice["position"], &advice["rotation"], &advice["size"]);
    format!("{head}[display]\nposition = {position}\nrotation = {rotation}\nsize = {size}\n{rest}")
}
