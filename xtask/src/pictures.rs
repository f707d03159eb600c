//! `cargo xtask pictures`: remakes the pictures that the README and the book show.

use crate::{book, process, setup};
use anyhow::{Result, ensure};
use midair_peers::Peer;
use std::path::Path;
use std::process::Command;

/// Where they lie, relative to the workspace's root.
const FOLDER: &str = "docs/pictures";

/// Side by side in each strip: seen of an uncompensated display, the compensated display, seen of that.
const STRIP: [&str; 3] = ["view-uncompensated.png", "display.png", "view-compensated.png"];

/// Strips of scenes beside the demo's and the tutorial's: the picture's name, the scene.
const SCENES: [(&str, &str); 2] = [
    ("bent-mirror.png", "scenes/paper/bent-mirror-convex.toml"),
    ("glass-of-water.png", "scenes/glass-of-water.toml"),
];

/// The tutorial's cube: the paper's, with a display that covers all of the image.
const TUTORIAL: [(&str, &str); 2] = [
    ("scenes/paper/cube.toml", "resolution = [1024, 1024]"),
    (
        "cube.toml",
        "resolution = [1024, 1024]\nposition = [-4.7, -150.0, -150.0]\n\
         rotation = [-90.0, 0.0, 0.0]\nsize = [32.0, 32.0]",
    ),
];

/// Views of a bare plate: by a pinhole, by an eye, and what else is to be seen around the image.
const PLATE_VIEWS: [(&str, &[&str]); 3] = [
    ("pinhole.png", &["--exposure", "1.5"]),
    ("eye.png", &["--exposure", "1.5", "--aperture", "6"]),
    ("stray.png", &["--exposure", "1.5", "--aperture", "6", "--window", "8"]),
];

/// Three pictures side by side, 360 pixels wide each, in 256 colours to keep the repository small.
const SIDE_BY_SIDE: &str = "[0]scale=360:-1:flags=lanczos,pad=iw+12:ih:0:0:white[a];\
                            [1]scale=360:-1:flags=lanczos,pad=iw+12:ih:0:0:white[b];\
                            [2]scale=360:-1:flags=lanczos[c];\
                            [a][b][c]hstack=inputs=3,split[x][y];\
                            [x]palettegen[p];[y][p]paletteuse=dither=sierra2_4a";

/// Runs the program and puts its pictures where the pages look for them.
pub fn run() -> Result<()> {
    setup::install_one(Peer::Ffmpeg)?;
    let mut build = Command::new(std::env::var("CARGO").unwrap_or_else(|_| "cargo".to_owned()));
    build.args(["build", "--quiet", "--release", "--package", "midair-cli"]);
    process::run(build.current_dir(crate::root()))?;
    let out = tempfile::tempdir()?;
    let pictures = crate::root().join(FOLDER);
    std::fs::create_dir_all(&pictures)?;

    process::run(midair().arg("demo").arg("--out").arg(out.path().join("demo")))?;
    strip(&out.path().join("demo"), &pictures.join("demo.png"))?;
    let [(paper, too_small), (file, large)] = TUTORIAL;
    let scene = std::fs::read_to_string(crate::root().join(paper))?;
    ensure!(scene.contains(too_small), "{paper} has another display");
    let cube = out.path().join(file);
    std::fs::write(&cube, scene.replace(too_small, large))?;

    let scenes = SCENES.map(|(name, scene)| (name, crate::root().join(scene)));
    for (name, scene) in scenes.into_iter().chain([("cube.png", cube)]) {
        let folder = out.path().join(name);
        let mut report = midair();
        report.arg("report").arg(scene).args(["--splat-spp", "0", "--out"]).arg(&folder);
        process::run(&mut report)?;
        strip(&folder, &pictures.join(name))?;
    }
    let demo = out.path().join("demo");
    let mut measure = midair();
    measure.args(["measure", "lattice"]).arg(demo.join("lattice-uncompensated.png"));
    measure.arg("--against").arg(demo.join("lattice-reference.png"));
    process::run(measure.arg("--out").arg(out.path().join("measured")))?;
    let mut smaller = Command::new("ffmpeg");
    smaller.args(["-y", "-v", "error", "-i"]).arg(out.path().join("measured/lattice.png"));
    let filter =
        "scale=640:-1:flags=lanczos,split[x][y];[x]palettegen[p];[y][p]paletteuse=dither=none";
    process::run(smaller.args(["-vf", filter]).arg(pictures.join("measure.png")))?;
    plate(out.path(), &pictures)?;
    let mut check = midair();
    check.args(["check", "scenes/paper/cube.toml", "--out"]).arg(pictures.join("check.png"));
    process::run(&mut check)?;
    let bench = out.path().join("bench.toml");
    let mut new = midair();
    process::run(new.args(["new", "cube", "--name", "A cube over a tablet", "--out"]).arg(&bench))?;
    let mut draw = midair();
    draw.arg("draw").arg(&bench).arg("--out").arg(pictures.join("drawing.svg"));
    process::run(draw.arg("--picture").arg(pictures.join("set-up.svg")))
}

/// The pictures of the page on the plate, by the commands that it shows.
fn plate(out: &Path, pictures: &Path) -> Result<()> {
    let character = out.join("plate");
    process::run(midair().args(["plate", "scenes/paper/cube.toml", "--out"]).arg(&character))?;
    for name in ["shares.png", "viewpoints.png", "sharpness.png"] {
        std::fs::copy(character.join(name), pictures.join(format!("plate-{name}")))?;
    }
    let lattice = out.join("demo/picture.png");
    for (name, options) in PLATE_VIEWS {
        let mut view = midair();
        view.args(["view", "scenes/plate.toml", "--size", "360x360", "--spp", "256", "--display"]);
        process::run(view.arg(&lattice).arg("--out").arg(out.join(name)).args(options))?;
    }
    let mut ffmpeg = Command::new("ffmpeg");
    ffmpeg.args(["-y", "-v", "error"]);
    for (name, _) in PLATE_VIEWS {
        ffmpeg.arg("-i").arg(out.join(name));
    }
    process::run(
        ffmpeg.args(["-filter_complex", SIDE_BY_SIDE]).arg(pictures.join("plate-views.png")),
    )
}

fn midair() -> Command {
    let mut command = Command::new(book::program_folder(book::Profile::Release).join("midair"));
    command.current_dir(crate::root());
    command
}

/// Sets a report's three pictures side by side.
fn strip(folder: &Path, to: &Path) -> Result<()> {
    let mut ffmpeg = Command::new("ffmpeg");
    ffmpeg.args(["-y", "-v", "error"]);
    for name in STRIP {
        ffmpeg.arg("-i").arg(folder.join(name));
    }
    process::run(ffmpeg.args(["-filter_complex", SIDE_BY_SIDE]).arg(to))
}
