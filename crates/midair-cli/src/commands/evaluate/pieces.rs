//! What an evaluation has found so far, kept until it is complete.

use super::Arguments;
use crate::failure::Failure;
use crate::output::keep_for_folder;
use midair::evaluate::paper::{Photograph, Quality, Settings, Shape};
use midair::evaluate::proof::Comparison;
use midair::files::{Kept, write_bytes_atomically};
use midair::map::format::FileError;
use serde_json::json;
use std::cell::RefCell;
use std::hash::{DefaultHasher, Hash as _, Hasher as _};
use std::path::{Path, PathBuf};

/// Findings in a hidden folder beside the output, which the next run goes on with; pictures and pages in the output itself, as they come.
pub struct Pieces {
    kept: Kept,
    out: PathBuf,
    files: RefCell<Vec<PathBuf>>,
}

impl Pieces {
    pub fn begin(
        arguments: &Arguments,
        settings: &Settings,
        photographs: &[Photograph],
        lpips: bool,
    ) -> Result<Self, Failure> {
        let work = description(arguments, settings, photographs, lpips);
        let kept = keep_for_folder(&arguments.out, &work, arguments.resume)?;
        Ok(Self { kept, out: arguments.out.clone(), files: RefCell::default() })
    }

    /// Writes a file of the output.
    pub fn write(
        &self,
        name: &str,
        write: impl FnOnce(&Path) -> Result<(), FileError>,
    ) -> Result<(), Failure> {
        let target = self.out.join(name);
        self.kept.write(&target, write)?;
        self.made(target);
        Ok(())
    }

    /// Where a file of the output is, if it is there.
    pub fn found(&self, name: &str) -> PathBuf {
        let target = self.out.join(name);
        self.made(target.clone());
        target
    }

    fn made(&self, target: PathBuf) {
        let mut files = self.files.borrow_mut();
        if !files.contains(&target) {
            files.push(target);
        }
    }

    /// The shape of a surface, and what is to be said of it, if it was found before.
    pub fn shape(&self, surface: &str) -> Option<(Shape, Vec<String>)> {
        self.known(&format!("shape-{}.json", key(surface)))
    }

    pub fn keep_shape(&self, surface: &str, found: &(Shape, Vec<String>)) -> Result<(), Failure> {
        self.keep(&format!("shape-{}.json", key(surface)), found)
    }

    /// The row of an image on a surface, and the exposure of its views, if it was found before.
    pub fn row(&self, surface: &str, image: &str) -> Option<(Quality, f64)> {
        self.known(&format!("row-{}.json", key(&format!("{surface}\n{image}"))))
    }

    pub fn keep_row(&self, row: &Quality, exposure: f64) -> Result<(), Failure> {
        let name = format!("row-{}.json", key(&format!("{}\n{}", row.surface, row.image)));
        self.keep(&name, &(row, exposure))
    }

    /// The ways to fill a surface's display, and what is to be said of them, if they were compared before.
    pub fn ways(&self, surface: &str) -> Option<(Comparison, Option<String>)> {
        self.known(&format!("ways-{}.json", key(surface)))
    }

    pub fn keep_ways(
        &self,
        surface: &str,
        found: &(Comparison, Option<String>),
    ) -> Result<(), Failure> {
        self.keep(&format!("ways-{}.json", key(surface)), found)
    }

    fn known<T: serde::de::DeserializeOwned>(&self, name: &str) -> Option<T> {
        let text = std::fs::read_to_string(self.kept.path(name)).ok()?;
        serde_json::from_str(&text).ok()
    }

    fn keep(&self, name: &str, found: &impl serde::Serialize) -> Result<(), Failure> {
        let text = json!(found).to_string();
        Ok(write_bytes_atomically(&self.kept.path(name), text.as_bytes())?)
    }

    /// The work is done; the files of the output.
    pub fn finish(self) -> Result<Vec<PathBuf>, Failure> {
        self.kept.finish()?;
        Ok(self.files.into_inner())
    }
}

/// A name's number: names may hold what no file's may.
fn key(name: &str) -> String {
    let mut hasher = DefaultHasher::new();
    name.hash(&mut hasher);
    format!("{:016x}", hasher.finish())
}

/// All that makes two runs the same work.
fn description(
    arguments: &Arguments,
    settings: &Settings,
    photographs: &[Photograph],
    lpips: bool,
) -> serde_json::Value {
    let mut hasher = DefaultHasher::new();
    for one in photographs {
        (&one.name, one.picture.width, one.picture.height).hash(&mut hasher);
        for pixel in &one.picture.pixels {
            pixel.map(f32::to_bits).hash(&mut hasher);
        }
    }
    if let Some(scene) = &arguments.scene {
        std::fs::read(scene).ok().hash(&mut hasher);
    }
    json!({
        "midair": env!("CARGO_PKG_VERSION"),
        "scene": arguments.scene,
        "images": arguments.images,
        "files": format!("{:016x}", hasher.finish()),
        "plate": format!("{:?}", arguments.plate),
        "compare": arguments.compare,
        "settings": format!("{settings:?}"),
        "lpips": lpips,
    })
}
