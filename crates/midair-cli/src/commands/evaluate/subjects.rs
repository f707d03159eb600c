//! What is evaluated: the set-ups, their plate, and the photographs.

use super::{Arguments, PlateKind};
use crate::arguments::{open_picture, open_scene};
use crate::failure::Failure;
use midair::evaluate::paper::Photograph;
use midair::map::format::FileError;
use midair::optics::plate::{Model, SlitMirror, SlitMirrorPlate};
use midair::picture::{READ, is_picture_name};
use midair::scene::{Format, InMemory, Loaded, load_text};
use midair::transport::Setup;
use std::path::Path;

/// Set-ups by the names that tables have for them.
pub struct Subjects {
    /// Whose lattice is looked at.
    pub shape: Vec<(String, Loaded)>,
    /// On which photographs are looked at.
    pub quality: Vec<(String, Loaded)>,
    /// The plate of all of them.
    pub plate: Model,
}

/// Name, file name, text.
type Scene = (&'static str, &'static str, &'static str);

macro_rules! scene {
    ($surface:literal, $file:literal) => {
        ($surface, $file, include_str!(concat!("../../../../../scenes/paper/", $file)))
    };
}

const QUALITY: [Scene; 3] = [
    scene!("cylinder", "cylinder.toml"),
    scene!("bent mirror, convex", "bent-mirror-quality-convex.toml"),
    scene!("bent mirror, concave", "bent-mirror-quality-concave.toml"),
];
const SHAPE: [Scene; 3] = [
    scene!("cube", "cube.toml"),
    scene!("bent mirror, convex", "bent-mirror-convex.toml"),
    scene!("bent mirror, concave", "bent-mirror-concave.toml"),
];

impl Subjects {
    pub fn of(arguments: &Arguments, notes: &mut Vec<String>) -> Result<Self, Failure> {
        let paper = |scenes: [Scene; 3]| {
            let read = |(surface, file, text): Scene| {
                let loaded = load_text(text, file, Format::Toml, &InMemory::new())?;
                Ok((surface.to_owned(), loaded))
            };
            scenes.into_iter().map(read).collect::<Result<Vec<_>, Failure>>()
        };
        let slit_mirror = || {
            SlitMirrorPlate::new(SlitMirror::default())
                .map(Model::from)
                .map_err(|error| Failure::Told { message: error.to_string(), help: None })
        };
        let Some(scene) = &arguments.scene else {
            let plate = match arguments.plate {
                Some(PlateKind::Ideal) => Model::Ideal,
                Some(PlateKind::SlitMirror) | None => slit_mirror()?,
            };
            return Ok(Self { shape: paper(SHAPE)?, quality: paper(QUALITY)?, plate });
        };
        let loaded = open_scene(scene, None)?;
        notes.extend(loaded.notes.iter().cloned());
        let own = Setup::new(&loaded)?.plate.model().clone();
        let plate = match arguments.plate {
            Some(PlateKind::Ideal) => Model::Ideal,
            Some(PlateKind::SlitMirror) if matches!(own, Model::Ideal) => slit_mirror()?,
            Some(PlateKind::SlitMirror) | None => own,
        };
        if arguments.plate.is_none() && matches!(plate, Model::Ideal) {
            notes.push("the scene's plate is ideal: no blur, no loss and no stray light are in the views; --plate slit-mirror has them".to_owned());
        }
        let all = vec![(loaded.scene.name.clone(), loaded)];
        Ok(Self { shape: all.clone(), quality: all, plate })
    }

    pub fn plate_name(&self) -> &'static str {
        match self.plate {
            Model::Ideal => "ideal",
            Model::SlitMirror(_) => "slit-mirror",
            Model::Measured(_) => "measured",
        }
    }
}

/// The pictures of a folder in the order of their names.
pub fn photographs(folder: &Path, notes: &mut Vec<String>) -> Result<Vec<Photograph>, Failure> {
    let unreadable = |error| Failure::from(FileError::io(folder, "read", error));
    let mut files = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(unreadable)? {
        let path = entry.map_err(unreadable)?.path();
        // Names that begin with a dot are the system's: `._a.jpg` beside a.jpg on disks that a Mac has written.
        let hidden = path.file_name().is_some_and(|name| name.as_encoded_bytes().starts_with(b"."));
        if !hidden && path.is_file() && is_picture_name(&path) {
            files.push(path);
        }
    }
    files.sort();
    if files.is_empty() {
        return Err(Failure::new(
            format!("{}: there is no picture in this folder", folder.display()),
            format!("name a folder with {READ} files"),
        ));
    }
    files
        .into_iter()
        .map(|path| {
            let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
            let picture = open_picture(&path, notes)?.picture;
            Ok(Photograph { name, picture })
        })
        .collect()
}
