//! A viewer who walks around the set-up: what is seen with the map of one viewpoint, and with a map that follows.
//!
//! The paper names it as its first limitation that the compensation holds for one viewpoint.

use super::proof::ProofError;
use super::proof::displacement::interpolated;
use crate::geometry::Vec3;
use crate::map::{Accuracy, Map, invert};
use crate::measure::Plane;
use crate::measure::lattice::{Displacement, LatticeStyle, detect_at, displacement, draw_lattice};
use crate::monitor::Monitor;
use crate::picture::optimal::{ViewSamples, view_through};
use crate::picture::{Picture, display_image};
use crate::simulate::Camera;
use crate::transport::{Path, Setup};
use serde::ser::SerializeMap as _;
use serde::{Serialize, Serializer};

/// What is seen, and how finely.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// Width and height of the views in pixels.
    pub view: [usize; 2],
    /// How much of the image's plane the views show, see [`Camera`].
    pub window: f64,
    /// Rays through each view pixel along each side.
    pub supersampling: usize,
    /// The lattice that displacement is measured on.
    pub lattice: LatticeStyle,
}

/// What is seen from one place; serialised, without the views.
#[derive(Clone, Debug, Serialize)]
pub struct Station {
    /// Degrees about the vertical through the image's centre, from the scene's viewpoint to the viewer's right.
    pub azimuth: f64,
    /// The eye, mm.
    #[serde(serialize_with = "coordinates")]
    pub eye: Vec3,
    /// With the map of the scene's viewpoint.
    pub fixed: Seen,
    /// With the map of this eye.
    pub tracked: Seen,
}

/// A view and its lattice.
#[derive(Clone, Debug)]
pub struct Seen {
    /// The view; linear light.
    pub view: Picture,
    /// How far the lattice's intersections are from where they belong, by calculation; view pixels.
    pub exact: Displacement,
    /// The same of the intersections that are found in the view; or why none are.
    pub measured: Result<Displacement, String>,
}

fn coordinates<S: Serializer>(point: &Vec3, serializer: S) -> Result<S::Ok, S::Error> {
    point.to_array().serialize(serializer)
}

/// Without the view.
impl Serialize for Seen {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(3))?;
        map.serialize_entry("exact", &self.exact)?;
        map.serialize_entry("measured", &self.measured.as_ref().ok())?;
        map.serialize_entry("not_measured", &self.measured.as_ref().err())?;
        map.end()
    }
}

/// The eye after a turn about the vertical through the image's centre; positive to the right of a viewer who looks at it.
pub fn eye_at(setup: &Setup, azimuth: f64) -> Vec3 {
    let centre = setup.image.frame.origin;
    let from = setup.viewpoint - centre;
    let (sin, cos) = azimuth.to_radians().sin_cos();
    centre + Vec3::new(cos * from.x + sin * from.z, from.y, cos * from.z - sin * from.x)
}

/// What is seen of `picture` (the lattice if there is none) from each azimuth, degrees.
///
/// # Errors
/// [`ProofError`] where the lattice cannot be drawn, or sizes do not fit.
pub fn orbit(
    setup: &Setup,
    picture: Option<&Picture>,
    azimuths: &[f64],
    settings: &Settings,
    monitor: &dyn Monitor,
) -> Result<Vec<Station>, ProofError> {
    // Twice as fine as view and display, so that display pixels average over exact shares of the lines' edges.
    let [columns, rows] = [0, 1].map(|axis| 2 * settings.view[axis].max(setup.resolution[axis]));
    let drawn = draw_lattice(columns, rows, &settings.lattice)?;
    let (fixed, _) = invert(setup, Accuracy::default());
    let shown = picture.unwrap_or(&drawn);
    let fixed_display = display_image(shown, &fixed);
    let mut stations = Vec::with_capacity(azimuths.len());
    for &azimuth in azimuths {
        let eye = eye_at(setup, azimuth);
        let there = setup.with_viewpoint(eye);
        let (tracked, _) = invert(&there, Accuracy::default());
        let camera = Camera {
            eye,
            size: settings.view,
            window: settings.window,
            supersampling: settings.supersampling,
        };
        let samples = ViewSamples::of(&camera.rays(setup), &|_| {});
        // What is displaced beyond the image's edge is seen in the window around it.
        let mut wide = there.clone();
        wide.image.size = wide.image.size.map(|side| side * settings.window);
        let (around, _) = invert(&wide, Accuracy::default());
        let seen = |display: &Picture, shown_by: &Setup| -> Result<Seen, ProofError> {
            let view = view_through(&samples, display)?;
            let places = lattice_places(shown_by, &around, settings);
            Ok(measure(view, &places, &camera, &settings.lattice, picture.is_none()))
        };
        stations.push(Station {
            azimuth,
            eye,
            fixed: seen(&fixed_display, setup)?,
            tracked: seen(&display_image(shown, &tracked), &there)?,
        });
        monitor.advance(1);
    }
    Ok(stations)
}

/// Where the lattice's intersections are seen, uv: the transport of `shown_by` tells the display points that show them, and
/// `from_here`, the map of the eye that looks for an image as large as the window, where those are seen.
fn lattice_places(shown_by: &Setup, from_here: &Map, settings: &Settings) -> Vec<Option<[f64; 2]>> {
    let places = settings.lattice.intersections_uv().into_iter().map(|uv| {
        let st = shown_by.transport(uv, &mut Path::new()).formed()?;
        let seen = interpolated(from_here, st)?;
        Some(seen.map(|c| 0.5 + (c - 0.5) * settings.window))
    });
    places.collect()
}

fn measure(
    view: Picture,
    places: &[Option<[f64; 2]>],
    camera: &Camera,
    style: &LatticeStyle,
    lattice: bool,
) -> Seen {
    let uv = style.intersections_uv();
    let belongs: Vec<_> = uv.iter().map(|&uv| Some(camera.view_position(uv))).collect();
    let seen: Vec<_> = places.iter().map(|uv| uv.map(|uv| camera.view_position(uv))).collect();
    let nothing = Displacement { mean: f64::NAN, max: f64::NAN, points: vec![None; uv.len()] };
    let exact = displacement(&seen, &belongs).unwrap_or(nothing);
    let measured = if lattice {
        let [width, height] = camera.size.map(|side| side as f64);
        let in_view = |[x, y]: &[f64; 2]| (0.0..=width).contains(x) && (0.0..=height).contains(y);
        let expected: Vec<_> = seen.iter().map(|place| place.filter(in_view)).collect();
        detect_at(&Plane::luminance(&view), style.lines, &expected)
            .map_err(|error| error.to_string())
            .and_then(|found| {
                displacement(&found.points(), &belongs).map_err(|error| error.to_string())
            })
    } else {
        Err("the view shows another picture".to_owned())
    };
    Seen { view, exact, measured }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Shape;
    use crate::transport::bench_setup::{ACRYLIC, block, element, setup};

    fn settings() -> Settings {
        Settings {
            view: [240, 240],
            window: 1.25,
            supersampling: 1,
            lattice: LatticeStyle { line_width: 0.02, ..LatticeStyle::default() },
        }
    }

    #[test]
    fn the_eye_goes_around_at_its_distance_and_height() {
        let setup = setup(20.0, vec![]);
        for azimuth in [-15.0, 0.0, 7.5, 90.0] {
            let eye = eye_at(&setup, azimuth);
            assert!((eye.dot(eye).sqrt() - 800.0).abs() < 1e-9 && eye.y == 0.0);
            assert!((eye.x - 800.0 * azimuth.to_radians().sin()).abs() < 1e-9);
        }
    }

    #[test]
    fn without_an_object_nothing_moves() {
        let mut setup = setup(20.0, vec![]);
        setup.resolution = [240, 240];
        for station in orbit(&setup, None, &[-10.0, 15.0], &settings(), &()).unwrap() {
            for seen in [&station.fixed, &station.tracked] {
                // The map is exact to 1e-6 of 240 px; detection to a few hundredths.
                assert!(seen.exact.max < 1e-3, "{}", seen.exact.max);
                assert!(seen.measured.as_ref().unwrap().mean < 0.1);
            }
        }
    }

    #[test]
    fn a_slab_moves_the_image_as_snells_law_says_and_a_map_that_follows_does_not() {
        // A block with its faces square to the first line of sight: from an angle a it shifts what lies in its
        // middle sideways. A plane-parallel slab of thickness d: d sin a (1 - cos a / sqrt(n^2 - sin^2 a)).
        let block: Shape = block(80.0, 80.0, 50.0);
        let mut setup = setup(20.0, vec![element(block, ACRYLIC, [0.0; 3], [0.0; 3], 0)]);
        setup.viewpoint = Vec3::new(0.0, 0.0, 8000.0);
        // Large enough for what has to be shown beside it.
        setup.display.size = [30.0; 2];
        setup.resolution = [360, 360];
        let stations = orbit(&setup, None, &[0.0, 8.0], &settings(), &()).unwrap();
        let [ahead, aside] = &stations[..] else { panic!() };
        assert_eq!(aside.fixed.exact.compared(), 49);
        assert!(ahead.fixed.exact.max < 0.01);
        let a = 8f64.to_radians();
        let shift = 50.0 * a.sin() * (1.0 - a.cos() / (1.49f64.powi(2) - a.sin().powi(2)).sqrt());
        // Across the line of sight; on the image's plane, which is seen aslant, 1 / cos a of it. View pixels are 20 mm
        // times 1.25 over 240.
        let pixels = shift / a.cos() / (25.0 / 240.0);
        // The eye is not at infinity: angles differ over the image by up to 10 / 8000.
        let mean = aside.fixed.exact.mean;
        assert!((mean - pixels).abs() < 0.02 * pixels, "{mean} {pixels}");
        assert!((aside.fixed.measured.as_ref().unwrap().mean - mean).abs() < 0.3);
        assert!(aside.tracked.exact.max < 0.01, "{}", aside.tracked.exact.max);
        assert!(aside.tracked.measured.as_ref().unwrap().mean < 0.1);
    }
}
