//! The two measurements.

use super::evaluation::{Displacements, Quality, Scores, Shape, ShapeView};
use super::stage::{Display, PaperError, Stage, Take};
use crate::geometry::{Rectangle, Vec3};
use crate::measure::lattice::{LatticeError, LatticeStyle, detect_at, draw_lattice};
use crate::measure::lpips::Lpips;
use crate::measure::{Plane, blurred_ssim, ssim_over_channels};
use crate::monitor::Monitor;
use crate::optics::plate::Model;
use crate::picture::Picture;
use crate::scene::Loaded;
use crate::simulate::tone::exposed;
use crate::simulate::{Camera, Light};

/// How an evaluation is rendered.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// Pixels of a view in a row, where likeness is measured; its height follows from the image's proportions.
    pub quality_width: usize,
    /// Pixels of a view along each side, where shape is measured.
    pub shape_size: usize,
    /// How much of the image's plane such a view shows (1: the image exactly), so that a displaced lattice stays in sight.
    pub shape_window: f64,
    /// Paths through each pixel, where likeness is measured.
    pub samples_per_pixel: u32,
    /// Paths through each pixel, where shape is measured: lines that the plate blurs need little noise to be found.
    pub shape_samples_per_pixel: u32,
    /// Width of the lattice's lines, as a share of the image's width.
    pub line_width: f64,
    /// Diameter of the camera's pupil, mm.
    pub aperture: f64,
    /// Azimuths of the camera about the image's centre, degrees; 0 is the scene's viewpoint.
    pub azimuths: Vec<f64>,
    /// Pixels of the camera's picture to a millimetre in the image's plane: what a displacement is told in.
    pub pixels_per_mm: f64,
}

impl Default for Settings {
    /// 512 paths a pixel and 128 for the lattice, whose lines are 2 % of the image wide, views of 384 and 480 pixels, a pupil of 20 mm, azimuths from -15 to 15 by 5, and 16.8 pixels to a millimetre, which the
    /// paper's 78.87 pixels for a slab of 50 mm at 15.8 degrees suggest. With 32 paths a pixel two views of one thing have an SSIM of 0.76 through the cylinder and 0.36 on
    /// the mirrors, all by the plate's slits, which a path meets or not; with 512 it is 0.98 and 0.86.
    fn default() -> Self {
        Self {
            quality_width: 384,
            shape_size: 480,
            shape_window: 1.8,
            samples_per_pixel: 512,
            shape_samples_per_pixel: 128,
            line_width: 0.02,
            aperture: 20.0,
            azimuths: (-3..=3).map(|step| 5.0 * f64::from(step)).collect(),
            pixels_per_mm: 16.8,
        }
    }
}

/// A surface of the paper.
#[derive(Clone, Copy, Debug)]
pub struct Subject<'a> {
    /// Its name in tables.
    pub surface: &'a str,
    /// Its scene.
    pub scene: &'a Loaded,
}

/// A picture that is looked at.
#[derive(Clone, Debug)]
pub struct Photograph {
    /// Its name in tables.
    pub name: String,
    /// Linear light; what exceeds the image's proportions is cropped evenly at both ends.
    pub picture: Picture,
}

/// A row of table 1 with its three views, exposed; linear light.
#[derive(Clone, Debug)]
pub struct QualityView {
    /// The scores.
    pub row: Quality,
    /// Without the object.
    pub reference: Picture,
    /// With the object, compensated.
    pub with: Picture,
    /// With the object, shown as it is.
    pub without: Picture,
    /// What light was multiplied by in all three, so that the reference is on average as bright as the photograph.
    pub exposure: f64,
}

/// Table 1 for one surface: photographs as they are seen without the object (the reference), with it and compensated, and with it as
/// they are. `done` gets each row as soon as it is there.
///
/// # Errors
/// [`PaperError`] where a scene cannot be traced or views cannot be compared.
pub fn quality<E: From<PaperError>>(
    subject: Subject,
    photographs: &[Photograph],
    plate: &Model,
    settings: &Settings,
    lpips: Option<&Lpips>,
    monitor: &dyn Monitor,
    mut done: impl FnMut(QualityView) -> Result<(), E>,
) -> Result<(), E> {
    let stage = Stage::new(subject.scene, plate).map_err(PaperError::from)?;
    let image = stage.image();
    let compensated = stage.display(stage.viewpoint(), true, 1536)?;
    let plain = stage.display(stage.viewpoint(), false, 1536)?;
    let height = (settings.quality_width as f64 * image.size[1] / image.size[0]).round();
    let camera = Camera {
        eye: stage.viewpoint(),
        size: [settings.quality_width, (height as usize).max(1)],
        window: 1.0,
        supersampling: 1,
    };
    monitor.stage(&format!("{}: views", subject.surface), photographs.len());
    // Paths do not depend on the photograph: what a batch costs is memory, a megapixel and a half of floats for each.
    for batch in photographs.chunks(BATCH) {
        let take = |seed| Take {
            camera,
            aperture: settings.aperture,
            samples_per_pixel: settings.samples_per_pixel,
            seed,
            light: Light::All,
        };
        let pictures: Vec<Picture> =
            batch.iter().map(|one| cropped(&one.picture, image.size[0] / image.size[1])).collect();
        let drawn = |display: &Display| -> Vec<Picture> {
            pictures.iter().map(|picture| display.showing(picture)).collect()
        };
        let views = |display, shown: &[Picture], with_object, seed| {
            stage.views(display, shown, with_object, take(seed)).map_err(PaperError::from)
        };
        let shown = drawn(&plain);
        let references = views(&plain, &shown, false, 0)?;
        let without = views(&plain, &shown, true, 1)?;
        // The same view once more, with other random numbers: what noise alone takes off.
        let again = views(&plain, &shown, false, 3)?;
        drop(shown);
        let with = views(&compensated, &drawn(&compensated), true, 2)?;
        let all = references.into_iter().zip(with).zip(without).zip(again);
        for ((photograph, picture), (((reference, with), without), again)) in
            batch.iter().zip(&pictures).zip(all)
        {
            let exposure = mean_light(picture) / mean_light(&reference).max(1e-6);
            let [reference, with, without, again] =
                [reference, with, without, again].map(|view| exposed(&view, exposure));
            let [with_scores, without_scores, floor] =
                compare(&reference, [&with, &without, &again], lpips)?;
            let row = Quality {
                surface: subject.surface.to_owned(),
                image: photograph.name.clone(),
                with: with_scores,
                without: without_scores,
                floor,
            };
            done(QualityView { row, reference, with, without, exposure })?;
            monitor.advance(1);
        }
    }
    Ok(())
}

/// Photographs that are rendered together.
const BATCH: usize = 8;

/// Three views against the reference.
fn compare(
    reference: &Picture,
    views: [&Picture; 3],
    lpips: Option<&Lpips>,
) -> Result<[Scores; 3], PaperError> {
    let planes = Plane::channels(reference);
    let features = lpips.map(|lpips| lpips.features(&planes)).transpose()?;
    let mut scores = [Scores::default(); 3];
    for (scores, view) in scores.iter_mut().zip(views) {
        let view = Plane::channels(view);
        scores.ssim = ssim_over_channels(&view, &planes)?;
        scores.blurred_ssim = blurred_ssim(&view, &planes)?;
        if let (Some(lpips), Some(features)) = (lpips, &features) {
            scores.lpips = Some(lpips.distance(&lpips.features(&view)?, features)?);
        }
    }
    Ok(scores)
}

fn mean_light(picture: &Picture) -> f64 {
    let sum: f64 =
        picture.pixels.iter().map(|&[r, g, b, _]| f64::from(r) + f64::from(g) + f64::from(b)).sum();
    sum / (3 * picture.pixels.len().max(1)) as f64
}

/// The largest part of a picture about its middle that has these proportions (width / height).
pub(super) fn cropped(picture: &Picture, proportions: f64) -> Picture {
    let (w, h) = (picture.width as f64, picture.height as f64);
    let width = ((h * proportions).round().min(w) as usize).max(1);
    let height = ((w / proportions).round().min(h) as usize).max(1);
    let (left, top) = ((picture.width - width) / 2, (picture.height - height) / 2);
    let rows = (top..top + height).map(|row| row * picture.width + left);
    let pixels = rows.flat_map(|at| picture.pixels[at..at + width].iter().copied()).collect();
    Picture { width, height, pixels }
}

/// Figure 7 for one surface: the lattice's mean displacement from where it is seen without the object, over the camera's azimuth: by calculation, and
/// measured on views.
///
/// Views are measured in the light of the mid-air image alone: stray images that lie across the lattice hide its lines. Intersections are named by where
/// the calculation has them, to a third of a step, for an edge of the object may drop, repeat and reorder lines. Notes tell what could not be measured. `done` gets the views from each azimuth: the reference, compensated, with the compensation for
/// azimuth 0 kept, and without; a black one where nothing can be formed.
///
/// # Errors
/// [`PaperError`] where the scene cannot be traced. Where nothing of the image is formed from an azimuth, its row is empty.
pub fn shape<E: From<PaperError>>(
    subject: Subject,
    plate: &Model,
    settings: &Settings,
    monitor: &dyn Monitor,
    mut done: impl FnMut(f64, [Picture; 4]) -> Result<(), E>,
) -> Result<(Shape, Vec<String>), E> {
    let stage = Stage::new(subject.scene, plate).map_err(PaperError::from)?;
    let image = stage.image();
    // What sticks out of the lattice, up to the image's border, lets its outer crossings be measured from both sides: a tenth of the
    // image, for in noise a line is followed only from a line's width or so beyond a crossing.
    let mut style =
        LatticeStyle { line_width: settings.line_width, margin: 0.1, ..LatticeStyle::default() };
    style.overhang = style.margin;
    let [columns, rows] = [768, (768.0 * image.size[1] / image.size[0]).round() as usize];
    let drawn = draw_lattice(columns, rows.max(1), &style).map_err(PaperError::from)?;
    let crossings = style.intersections_uv();
    let straight = stage.display(stage.viewpoint(), true, 768)?;
    let mut notes = Vec::new();
    let mut seen: Vec<Seen> = Vec::new();
    monitor.stage(&format!("{}: lattice", subject.surface), settings.azimuths.len());
    for &azimuth in &settings.azimuths {
        let eye = orbited(stage.viewpoint(), image.frame.origin, azimuth);
        let camera = Camera {
            eye,
            size: [settings.shape_size, settings.shape_size],
            window: settings.shape_window,
            supersampling: 1,
        };
        let to_sensor = |uv| sensor(&image, eye, uv, settings.pixels_per_mm);
        // Where the display shows each intersection, and where the eye sees that.
        let calculated = |display: &Display| -> Vec<Option<[f64; 2]>> {
            let sight = stage.sight(display, eye, settings.shape_window);
            let within =
                |uv: &[f64; 2]| uv.iter().all(|c| (c - 0.5).abs() <= 0.5 * settings.shape_window);
            let seen = |&uv: &[f64; 2]| sight.seen_at(display.shown_at(uv)?).filter(within);
            crossings.iter().map(seen).collect()
        };
        let mut look = |display: &Display,
                        with_object: bool,
                        condition: &str,
                        seed: u32,
                        exact: Vec<Option<[f64; 2]>>|
         -> Result<(Picture, Look), PaperError> {
            let take = Take {
                camera,
                aperture: settings.aperture,
                samples_per_pixel: settings.shape_samples_per_pixel,
                seed,
                light: Light::Real,
            };
            let shown = [display.showing(&drawn)];
            let view = stage.views(display, &shown, with_object, take)?.remove(0);
            let expected: Vec<_> =
                exact.iter().map(|uv| uv.map(|uv| camera.view_position(uv))).collect();
            let measured = match detect_at(&Plane::luminance(&view), style.lines, &expected) {
                Ok(lattice) => lattice.points(),
                Err(LatticeError::NoLattice) => {
                    notes.push(format!(
                        "{}, {azimuth}°, {condition}: nothing of the lattice is seen where it is calculated to be; the calculated displacement stands by itself.",
                        subject.surface
                    ));
                    vec![None; crossings.len()]
                }
                Err(why) => {
                    notes.push(format!("{}, {azimuth}°, {condition}: {why}.", subject.surface));
                    vec![None; crossings.len()]
                }
            };
            let uv = |p: [f64; 2]| camera.image_point(p[0], p[1]);
            let measured = measured.into_iter().map(|p| p.map(|p| to_sensor(uv(p)))).collect();
            let exact = exact.into_iter().map(|uv| uv.map(to_sensor)).collect();
            Ok((view, Look { measured, exact }))
        };
        let plain = stage.display(eye, false, 768)?;
        let belongs = crossings.iter().copied().map(Some).collect();
        let (seen_reference, reference) = look(&plain, false, "reference", 0, belongs)?;
        let exact = calculated(&plain);
        let (seen_without, without) = look(&plain, true, "without compensation", 1, exact)?;
        let exact = calculated(&straight);
        let (seen_kept, kept) = look(&straight, true, "compensated for 0°", 2, exact)?;
        let (seen_with, with) = match stage.display(eye, true, 768) {
            Ok(own) => {
                let exact = calculated(&own);
                look(&own, true, "compensated", 3, exact)?
            }
            Err(error @ PaperError::NothingFormed { .. }) => {
                notes.push(error.to_string());
                let [width, height] = camera.size;
                (Picture::filled(width, height, [0.0, 0.0, 0.0, 1.0]), Look::default())
            }
            Err(error) => return Err(error.into()),
        };
        seen.push(Seen { azimuth, reference, conditions: [with, kept, without] });
        done(azimuth, [seen_reference, seen_with, seen_kept, seen_without])?;
        monitor.advance(1);
    }
    Ok((summary(subject.surface, &seen, crossings.len()), notes))
}

/// The intersections under one condition, in the sensor's pixels.
#[derive(Default)]
struct Look {
    measured: Vec<Option<[f64; 2]>>,
    /// By calculation; all are missing where nothing is formed.
    exact: Vec<Option<[f64; 2]>>,
}

/// What was seen from one azimuth: without the object, compensated, compensated for 0 degrees, and without compensation.
struct Seen {
    azimuth: f64,
    reference: Look,
    conditions: [Look; 3],
}

/// Means over the same intersections at every azimuth, so that azimuths and conditions compare: of the calculated displacements over
/// those that are formed from everywhere, of the measured ones over those that were found in every view in which anything was.
fn summary(surface: &str, seen: &[Seen], count: usize) -> Shape {
    let formed = |at: &usize| {
        let of = |look: &Look| look.exact.is_empty() || look.exact[*at].is_some();
        seen.iter().all(|one| one.conditions.iter().all(of))
    };
    let formed: Vec<usize> = (0..count).filter(formed).collect();
    let anything = |look: &Look| look.measured.iter().any(Option::is_some);
    let found = |at: &usize| {
        let of = |look: &Look| !anything(look) || look.measured[*at].is_some();
        seen.iter().all(|one| of(&one.reference) && one.conditions.iter().all(of))
    };
    let found: Vec<usize> = (0..count).filter(found).collect();
    let view = |one: &Seen| {
        let mean = |places: &[Option<[f64; 2]>], from: &[Option<[f64; 2]>], over: &[usize]| {
            let off = |&at: &usize| {
                let (a, b) = ((*places.get(at)?)?, (*from.get(at)?)?);
                Some((a[0] - b[0]).hypot(a[1] - b[1]))
            };
            let all: Option<Vec<f64>> = over.iter().map(off).collect();
            all.filter(|all| !all.is_empty()).map(|all| all.iter().sum::<f64>() / all.len() as f64)
        };
        let by = |of: &dyn Fn(&Look) -> Option<f64>| {
            let [with, kept, without] = one.conditions.each_ref().map(of);
            Displacements { with, kept, without }
        };
        ShapeView {
            azimuth: one.azimuth,
            exact: by(&|look| mean(&look.exact, &one.reference.exact, &formed)),
            measured: by(&|look| mean(&look.measured, &one.reference.measured, &found)),
            exact_there: by(&|look| match anything(look) {
                true => mean(&look.exact, &one.reference.exact, &found),
                false => None,
            }),
        }
    };
    Shape {
        surface: surface.to_owned(),
        views: seen.iter().map(view).collect(),
        intersections: formed.len(),
        measured_intersections: found.len(),
        lattice: count,
    }
}

/// The eye carried about the vertical through `centre`, degrees counter-clockwise seen from above.
pub(super) fn orbited(eye: Vec3, centre: Vec3, azimuth: f64) -> Vec3 {
    let (sin, cos) = azimuth.to_radians().sin_cos();
    let from = eye - centre;
    centre + Vec3::new(cos * from.x + sin * from.z, from.y, cos * from.z - sin * from.x)
}

/// Where a camera at `eye`, turned to the image's centre, pictures an image point: pixels from its axis, right and down. A
/// millimetre across the axis at the image's centre is `pixels_per_mm` long.
pub(super) fn sensor(image: &Rectangle, eye: Vec3, uv: [f64; 2], pixels_per_mm: f64) -> [f64; 2] {
    let axis = image.frame.origin - eye;
    let (sight, distance) = (axis.normalized(), axis.squared_length().sqrt());
    let right = sight.cross(image.frame.axes[1]).normalized();
    let up = right.cross(sight);
    let to = image.point(uv) - eye;
    let scale = pixels_per_mm * distance / to.dot(sight);
    [scale * to.dot(right), -scale * to.dot(up)]
}
