//! For tests only: the programs and devices that results are held against, and what happens where one is missing.
//!
//! A test asks for its peer ([`ffmpeg`], [`python`], ...) and returns if it gets none. Where the peer is named in the environment variable
//! [`REQUIRED`], asking for it in vain fails the test. Elsewhere the test skips itself: it says so on standard error, which the test runner
//! does not swallow, and in the file that [`SKIPS`] names, from which `cargo xtask test` counts.

pub mod campaign;
pub mod corpus;

use std::fmt::{self, Display};
use std::fs::OpenOptions;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::str::FromStr;

/// The environment variable that lists the required peers by [name](Peer::name), separated by commas.
pub const REQUIRED: &str = "MIDAIR_REQUIRE";

/// The environment variable that names a file for the skips: a line each, `test`, `peer` and why, separated by tabulators.
pub const SKIPS: &str = "MIDAIR_SKIPS";

/// What tests are held against beyond Rust.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Peer {
    /// ffmpeg and ffprobe.
    Ffmpeg,
    /// A Python with numpy, OpenCV and scikit-image.
    Python,
    /// A Python with Blender's module `bpy`.
    Blender,
    /// A virtual screen with its tools: Xvfb, xwd, xdotool.
    Screen,
    /// A graphics device, be it in software.
    Graphics,
    /// The weights of LPIPS in midair's cache.
    Lpips,
    /// User and mount namespaces (unshare): a disk that is full, a folder that may not be written.
    Namespaces,
    /// A processor with AVX2, whose vectors are held against plain code.
    Avx2,
}

impl Peer {
    /// All of them.
    pub const ALL: [Self; 8] = [
        Self::Ffmpeg,
        Self::Python,
        Self::Blender,
        Self::Screen,
        Self::Graphics,
        Self::Lpips,
        Self::Namespaces,
        Self::Avx2,
    ];

    /// As in [`REQUIRED`].
    pub fn name(self) -> &'static str {
        match self {
            Self::Ffmpeg => "ffmpeg",
            Self::Python => "python",
            Self::Blender => "blender",
            Self::Screen => "screen",
            Self::Graphics => "graphics",
            Self::Lpips => "lpips",
            Self::Namespaces => "namespaces",
            Self::Avx2 => "avx2",
        }
    }
}

impl Display for Peer {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(self.name())
    }
}

impl FromStr for Peer {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, String> {
        Self::ALL.into_iter().find(|peer| peer.name() == name).ok_or_else(|| {
            format!("there is no peer `{name}`; there are {}", Self::ALL.map(Self::name).join(", "))
        })
    }
}

/// Says that a test skips itself for want of a peer.
///
/// # Panics
/// Where the peer is required, [`REQUIRED`] names an unknown peer, or [`SKIPS`] a file that cannot be written.
pub fn missing(peer: Peer, why: impl Display) {
    let required = std::env::var(REQUIRED).unwrap_or_default();
    let skips = std::env::var_os(SKIPS).map(PathBuf::from);
    tell_missing(peer, &why.to_string(), &required, skips.as_deref());
}

fn tell_missing(peer: Peer, why: &str, required: &str, skips: Option<&Path>) {
    let required: Vec<Peer> = required
        .split(',')
        .map(str::trim)
        .filter(|name| !name.is_empty())
        .map(|name| name.parse().unwrap_or_else(|error| panic!("{REQUIRED}: {error}")))
        .collect();
    assert!(!required.contains(&peer), "{peer} is required here ({REQUIRED}), but {why}");
    let thread = std::thread::current();
    let test = thread.name().unwrap_or("a test");
    let why = why.replace(['\t', '\n'], " ");
    // Written past the runner, which keeps what a passing test prints to itself.
    let _ = writeln!(std::io::stderr(), "skipped: {test}: {why} ({peer})");
    if let Some(file) = skips {
        let line = format!("{test}\t{peer}\t{why}\n");
        let written = OpenOptions::new()
            .create(true)
            .append(true)
            .open(file)
            .and_then(|mut file| file.write_all(line.as_bytes()));
        written.unwrap_or_else(|error| panic!("{}: {error}", file.display()));
    }
}

/// Whether ffmpeg and ffprobe are here.
pub fn ffmpeg() -> bool {
    let here = ["ffmpeg", "ffprobe"].into_iter().all(|program| runs(program, &["-version"]));
    if !here {
        missing(Peer::Ffmpeg, "ffmpeg or ffprobe is not installed");
    }
    here
}

/// A Python that has numpy, cv2 and skimage: the workspace's own, or the system's.
pub fn python() -> Option<PathBuf> {
    let found = [in_workspace(".venv/bin/python3"), PathBuf::from("python3")]
        .into_iter()
        .find(|python| runs(python, &["-c", "import cv2, numpy, skimage"]));
    if found.is_none() {
        missing(Peer::Python, "no python3 has numpy, cv2 and skimage");
    }
    found
}

/// A Python that has `bpy`: the one that MIDAIR_BPY_PYTHON names, or the workspace's own.
pub fn blender() -> Option<PathBuf> {
    let named = std::env::var_os("MIDAIR_BPY_PYTHON").map(PathBuf::from);
    let python = named.unwrap_or_else(|| in_workspace(".venv-blender/bin/python3"));
    let here = runs(&python, &["-c", "import bpy"]);
    if !here {
        missing(Peer::Blender, "no Python has bpy; name one in MIDAIR_BPY_PYTHON");
    }
    here.then_some(python)
}

/// Whether Xvfb, xwd and xdotool are here.
pub fn screen() -> bool {
    let here = ["Xvfb", "xwd", "xdotool"].into_iter().all(|program| {
        // None of them has an option that does nothing and succeeds: that it starts is enough.
        Command::new(program).arg("-version").stdin(Stdio::null()).output().is_ok()
    });
    if !here {
        missing(Peer::Screen, "Xvfb, xwd or xdotool is not installed");
    }
    here
}

/// Whether user namespaces are here.
pub fn namespaces() -> bool {
    let here = runs("unshare", &["--user", "--map-root-user", "--mount", "true"]);
    if !here {
        missing(Peer::Namespaces, "unshare makes no namespaces for this user");
    }
    here
}

fn runs(program: impl AsRef<std::ffi::OsStr>, arguments: &[&str]) -> bool {
    let output = Command::new(program).args(arguments).stdin(Stdio::null()).output();
    output.is_ok_and(|output| output.status.success())
}

fn in_workspace(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").join(path)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_peer_s_name_leads_back_to_it() {
        for peer in Peer::ALL {
            assert_eq!(peer.name().parse(), Ok(peer));
        }
        assert!("nuke".parse::<Peer>().unwrap_err().contains("ffmpeg, python"));
    }

    #[test]
    fn a_skip_is_written_down() {
        let file = std::env::temp_dir().join(format!("midair-skips-{}", std::process::id()));
        tell_missing(Peer::Blender, "not\there", "ffmpeg, python", Some(&file));
        tell_missing(Peer::Lpips, "neither", "", Some(&file));
        let written = std::fs::read_to_string(&file).unwrap();
        std::fs::remove_file(&file).unwrap();
        let test = "tests::a_skip_is_written_down";
        assert_eq!(written, format!("{test}\tblender\tnot here\n{test}\tlpips\tneither\n"));
    }

    #[test]
    #[should_panic = "ffmpeg is required here"]
    fn a_required_peer_that_is_missing_fails_its_test() {
        tell_missing(Peer::Ffmpeg, "there is none", "python,ffmpeg", None);
    }

    #[test]
    #[should_panic = "there is no peer `ffmpge`"]
    fn a_misspelt_requirement_is_no_permission() {
        tell_missing(Peer::Ffmpeg, "there is none", "ffmpge", None);
    }
}
