//! `midair explore`: where an image can be formed.

mod known;
mod views;

use crate::arguments::open_scene;
use crate::failure::Failure;
use crate::progress::Bar;
use crate::summary::{Voice, milliseconds, paths, percent, wrote};
use known::Known;
use midair::evaluate::explore::{
    Axis, Best, Limit, Point, Settings, best, explore_further, varied,
};
use midair::files::{Output, renamed, write_bytes_atomically};
use midair::picture::{Depth, write_still};
use midair::scene::{Folder, Loaded, SceneEdit};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Find out where an image can be formed: vary values of a scene, or search for the best set-up
///
/// Each set-up is looked at with a map of its own: which share of the image is formed, which share is folded or lost and why, how much the image is magnified, how
/// much light arrives and how evenly, stray light over the image, and how far the viewer may move until a twentieth of the image is lost.
///
/// With --vary all combinations of values are looked at, coarsely first; with --settle what lies between neighbours that agree is interpolated. Writes
/// explore.csv, explore.json, pictures over two values (small multiples over a third), views of the best set-ups, and best.toml, the scene of the best one.
///
/// With --best the set-up with the largest formed image is searched for, evenly lit and with little stray light: the score is the formed area times the
/// formed share, less for uneven and stray light. Keys are named as in the scene file, elements by their name or number; a `size` keeps its
/// proportions.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Examples:\n  midair explore scene.toml --vary image.position.z=-25..25:11 --vary image.size=10..30:5 --out found\n  \
    midair explore scene.toml --best --limit image.position.z=-25..25 --limit element.cube.rotation.y=0..90 --out found"
)]
pub struct Arguments {
    /// Scene file (TOML or JSON)
    scene: PathBuf,
    /// Key and its values: PATH=FROM..TO:COUNT or PATH=A,B,C; may be given several times
    #[arg(long, value_name = "VALUES", required_unless_present = "best", conflicts_with = "best")]
    vary: Vec<Axis>,
    /// Search for the best set-up
    #[arg(long)]
    best: bool,
    /// Key and where to search: PATH=FROM..TO; may be given several times; left out: the image's place and size, and turns of elements
    #[arg(long, value_name = "LIMITS", requires = "best", visible_alias = "limits")]
    limit: Vec<Limit>,
    /// Folder for all that is written
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Pixels of each map, and image points, along each side
    #[arg(long, value_name = "N", default_value = "128", value_parser = clap::value_parser!(u16).range(8..=1024))]
    resolution: u16,
    /// Between set-ups whose shares of formed, folded and lost points differ by less than this, interpolate; quicker, but what is narrow may be overlooked
    #[arg(long, value_name = "SHARE", default_value = "0", value_parser = share)]
    settle: f64,
    /// So many of the best set-ups are shown as views
    #[arg(long, value_name = "N", default_value = "3", value_parser = clap::value_parser!(u8).range(0..=20))]
    views: u8,
    /// Go on with what an interrupted run has found
    #[arg(long, conflicts_with = "best")]
    resume: bool,
}

fn share(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(share) if (0.0..=0.5).contains(&share) => Ok(share),
        _ => Err("give a share from 0 to 0.5".to_owned()),
    }
}

/// Set-ups of one exploration; more would be a mistyped count.
const MOST: usize = 10_000_000;

pub fn run(arguments: &Arguments, voice: Voice) -> Result<(), Failure> {
    let count =
        arguments.vary.iter().try_fold(1usize, |all, axis| all.checked_mul(axis.values.len()));
    if count.is_none_or(|count| count > MOST) {
        let problem = format!("more than {MOST} set-ups are asked for");
        return Err(Failure::new(problem, "vary fewer values, or give smaller counts"));
    }
    let loaded = open_scene(&arguments.scene, None)?;
    let folder = arguments.scene.parent().map(Path::to_path_buf).unwrap_or_default();
    let bench = Bench { arguments, loaded: &loaded, files: Folder(folder), voice };
    if arguments.best { bench.search() } else { bench.vary() }
}

struct Bench<'a> {
    arguments: &'a Arguments,
    loaded: &'a Loaded,
    files: Folder,
    voice: Voice,
}

impl Bench<'_> {
    fn settings(&self) -> Settings {
        let Arguments { resolution, settle, .. } = self.arguments;
        Settings::default().resolution(usize::from(*resolution)).settle(*settle)
    }

    fn vary(&self) -> Result<(), Failure> {
        let axes = &self.arguments.vary;
        let start = Instant::now();
        let known = Known::begin(self.arguments, self.loaded)?;
        let bar = Bar::new();
        let found = explore_further(
            self.loaded,
            axes,
            &self.settings(),
            &self.files,
            &bar,
            &|number| known.get(number),
            &|number, point| known.keep(number, point),
        )?;
        bar.finish();
        let seconds = start.elapsed();
        let edit = SceneEdit::of(&self.loaded.text)?;
        let units: Vec<_> = axes.iter().map(|axis| edit.unit(&axis.path).ok().flatten()).collect();
        let mut output = crate::output::into_folder(&self.arguments.out)?;
        output
            .write("explore.csv", |path| write_bytes_atomically(path, found.to_csv().as_bytes()))?;
        for (name, picture) in midair_report::explore::pictures(&found, &units) {
            output.write(&name, |path| write_still(path, &picture, Depth::Eight))?;
        }
        let shown = found.best(usize::from(self.arguments.views).max(1));
        let paths_of: Vec<&str> = axes.iter().map(|axis| axis.path.as_str()).collect();
        for (rank, &place) in shown.iter().enumerate() {
            let scene = varied(&edit, &paths_of, &found.points[place].values)?;
            if rank == 0 {
                self.write_scene(&mut output, scene.clone())?;
            }
            if rank < self.arguments.views.into() {
                self.write_view(&mut output, &format!("best-{}.png", rank + 1), &scene)?;
            }
        }
        let looked_at = found.points.iter().filter(|point| !point.interpolated).count();
        let told = json!({
            "axes": found.axes,
            "looked_at": looked_at,
            "points": found.points.iter().map(point_told).collect::<Vec<_>>(),
            "best": shown,
        });
        let mut lines = format!(
            "{}: {} set-ups{}\n",
            self.loaded.scene.name,
            found.points.len(),
            match found.points.len() - looked_at {
                0 => String::new(),
                between => format!(", {between} of them interpolated"),
            }
        );
        for &place in &shown {
            lines += &line(&paths_of, &found.points[place]);
        }
        if shown.is_empty() {
            let why = found.points.iter().find_map(|point| point.outcome.as_ref().err());
            lines += &format!("no set-up can be: {}\n", why.map_or("", String::as_str));
        }
        self.conclude(output, told, seconds, &lines)?;
        known.finish()
    }

    fn search(&self) -> Result<(), Failure> {
        let limits = match &self.arguments.limit[..] {
            [] => Limit::usual(&self.loaded.scene),
            given => given.to_vec(),
        };
        let start = Instant::now();
        let bar = Bar::new();
        let found = best(self.loaded, &limits, &self.settings(), &self.files, &bar)?;
        bar.finish();
        let seconds = start.elapsed();
        let Best { point, score, before, looked_at, .. } = &found;
        if let Err(why) = &point.outcome {
            let remedy = "give other limits, or mend the scene: midair check tells what is wrong";
            return Err(Failure::new(format!("no set-up within the limits can be: {why}"), remedy));
        }
        let paths_of: Vec<&str> = limits.iter().map(|limit| limit.path.as_str()).collect();
        let edit = SceneEdit::of(&self.loaded.text)?;
        let scene = varied(&edit, &paths_of, &point.values)?;
        let mut output = crate::output::into_folder(&self.arguments.out)?;
        self.write_view(&mut output, "best-1.png", &scene)?;
        self.write_scene(&mut output, scene)?;
        let told = json!({
            "limits": limits,
            "looked_at": looked_at,
            "best": point_told(point),
            "score": score,
            "score_before": before,
        });
        let lines = format!(
            "{}: {looked_at} set-ups looked at; the score goes from {before:.1} to {score:.1} mm²\n{}",
            self.loaded.scene.name,
            line(&paths_of, point)
        );
        self.conclude(output, told, seconds, &lines)
    }

    /// Writes explore.json, puts all files in their place, and tells. `told` is what was found.
    fn conclude(
        &self,
        mut output: Output,
        mut told: Value,
        time: Duration,
        lines: &str,
    ) -> Result<(), Failure> {
        told["midair"] = json!(env!("CARGO_PKG_VERSION"));
        told["command"] = json!("explore");
        told["scene"] = json!(self.loaded.scene.name);
        told["resolution"] = json!(self.arguments.resolution);
        told["notes"] = json!(self.loaded.notes);
        told["timings_ms"] = json!({ "all": milliseconds(time) });
        output.write("explore.json", |path| {
            write_bytes_atomically(path, format!("{told:#}\n").as_bytes())
        })?;
        let files = output.finish()?;
        self.voice.note(&self.loaded.notes);
        told["files"] = paths(&files);
        self.voice.tell(&format!("{lines}{}", wrote(&files)), &told)
    }

    /// The scene of the best set-up; the files that it names are found from there.
    fn write_scene(&self, output: &mut Output, mut scene: SceneEdit) -> Result<(), Failure> {
        scene.rename_files(&|name| renamed(name, &self.files.0, &self.arguments.out))?;
        let name = match scene.format() {
            midair::scene::Format::Toml => "best.toml",
            midair::scene::Format::Json => "best.json",
        };
        Ok(output.write(name, |path| write_bytes_atomically(path, scene.text().as_bytes()))?)
    }

    fn write_view(
        &self,
        output: &mut Output,
        name: &str,
        scene: &SceneEdit,
    ) -> Result<(), Failure> {
        let loaded = self.loaded.changed(scene, &self.files)?;
        let picture = views::views(&loaded)?;
        Ok(output.write(name, |path| write_still(path, &picture, Depth::Eight))?)
    }
}

/// A set-up in a line.
fn line(paths: &[&str], point: &Point) -> String {
    let values: Vec<String> = paths
        .iter()
        .zip(&point.values)
        .map(|(path, value)| format!("{path} = {value:.4}"))
        .collect();
    let found = match &point.outcome {
        Ok(measured) => format!(
            "{} formed, {} folded; score {:.1} mm²",
            percent(measured.formed),
            percent(measured.folded),
            measured.score()
        ),
        Err(why) => why.clone(),
    };
    format!("{}: {found}\n", values.join(", "))
}

/// A set-up as JSON.
fn point_told(point: &Point) -> Value {
    match &point.outcome {
        Ok(measured) => {
            let mut told = json!(measured);
            told["values"] = json!(point.values);
            told["score"] = json!(measured.score());
            told["interpolated"] = json!(point.interpolated);
            told
        }
        Err(why) => json!({ "values": point.values, "refused": why }),
    }
}
