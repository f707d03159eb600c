//! `midair evaluate --compare`: other ways to fill the display, beside the exact map.

use super::pieces::Pieces;
use super::subjects::Subjects;
use crate::arguments::FitMode;
use crate::failure::Failure;
use crate::progress::Bar;
use midair::Monitor as _;
use midair::evaluate::paper::{Photograph, Settings};
use midair::evaluate::proof::{Comparison, Way, WaySettings, compare_ways};
use midair::files::write_bytes_atomically;
use midair::map::format::FileError;
use midair::scene::Loaded;
use midair::transport::Setup;
use midair_calibrate::decode::decode_folder;
use midair_calibrate::model_free::model_free;
use midair_calibrate::rehearsal::film::Film;
use midair_calibrate::rehearsal::{camera, dice};
use midair_calibrate::{Patterns, stray};
use std::time::Instant;

/// Photographs of fewer columns show no corner's squares.
const FEWEST_COLUMNS: usize = 600;

/// What ways are compared on.
pub struct Ground<'a> {
    pub subjects: &'a Subjects,
    pub photographs: &'a [Photograph],
    pub settings: &'a Settings,
    /// The most columns of the photographs of structured light.
    pub columns: usize,
}

/// Compares the ways on each surface, once for each; notes tell which could not be had.
pub fn compare(
    ground: &Ground<'_>,
    pieces: &Pieces,
    bar: &Bar,
    notes: &mut Vec<String>,
) -> Result<Vec<Comparison>, Failure> {
    let subjects = ground.subjects;
    let mut all: Vec<Comparison> = Vec::new();
    for (surface, loaded) in subjects.shape.iter().chain(&subjects.quality) {
        if all.iter().any(|known| known.surface == *surface) {
            continue;
        }
        let (found, why) = match pieces.ways(surface) {
            Some(known) => known,
            None => {
                let found = ground.of_surface(surface, loaded, bar)?;
                pieces.keep_ways(surface, &found)?;
                found
            }
        };
        all.push(found);
        notes.extend(why);
    }
    Ok(all)
}

impl Ground<'_> {
    fn of_surface(
        &self,
        surface: &str,
        loaded: &Loaded,
        bar: &Bar,
    ) -> Result<(Comparison, Option<String>), Failure> {
        let setup = Setup::new(loaded)?.with_plate(self.subjects.plate.clone());
        let photographs = self.photographs.iter();
        let pictures: Vec<_> = photographs
            .map(|photograph| FitMode::Cover.apply(&setup, photograph.picture.clone()))
            .collect();
        bar.stage(&format!("{surface}: structured light"), 1);
        // The image fills half of a photograph: as many pixels as the display has.
        let columns = (2 * setup.resolution[0]).clamp(FEWEST_COLUMNS, self.columns);
        let (others, why) = match structured_light(&setup, columns)? {
            Ok(way) => (vec![way], None),
            Err(why) => (Vec::new(), Some(format!("{surface}, structured light: {why}."))),
        };
        let pixels_per_mm = self.settings.pixels_per_mm;
        let settings = WaySettings { pixels_per_mm, ..WaySettings::default() };
        let found = compare_ways(surface, &setup, &pictures, others, &settings, bar)?;
        Ok((found, why))
    }
}

/// The map without a model, from photographs that the simulator takes from the viewpoint; or why they do not tell it.
fn structured_light(setup: &Setup, columns: usize) -> Result<Result<Way, String>, Failure> {
    let (film, eye) = (Film::over_image(setup, columns), camera(setup, 0.0, 0.0));
    let patterns = Patterns::of(setup);
    let (files, _) = film.shoot(setup, &eye, &patterns, dice(1).u64(..));
    let folder = tempfile::tempdir()
        .map_err(|error| FileError::io(std::env::temp_dir().as_path(), "write", error))?;
    for (pattern, file) in files.iter().enumerate() {
        let name = folder.path().join(format!("{pattern:02}.jpg"));
        write_bytes_atomically(&name, file)?;
    }
    let start = Instant::now();
    let mut decoded = match decode_folder(&patterns, folder.path(), &()) {
        Ok(decoded) => decoded,
        Err(error) => return Ok(Err(error.to_string())),
    };
    stray::mark(&mut decoded, setup, &eye, &film.lens);
    let map = model_free(setup, &eye, &film.lens, &decoded);
    let name = format!("structured light, {} photographs", files.len());
    Ok(Ok(Way { name, map, seconds: start.elapsed().as_secs_f64() }))
}
