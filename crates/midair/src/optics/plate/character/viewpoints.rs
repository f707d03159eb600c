//! How bright the mid-air image is from all viewpoints.

use crate::geometry::{Ray, Rectangle, Vec3};
use crate::optics::plate::{pass_ideal, viewing_direction};
use rayon::prelude::*;

/// Plate, mid-air image and display, without anything in between.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arrangement {
    /// The plate.
    pub plate: Rectangle,
    /// The mid-air image.
    pub image: Rectangle,
    /// The display: it shines from its front, +z, equally in all directions.
    pub display: Rectangle,
}

impl Arrangement {
    /// Luminance of the image's point `at` (world, mm) from `viewpoint`, over the display's.
    ///
    /// It is `efficiency` if the line of sight leads from the viewpoint over the image's point
    /// through the plate to the display's front, and 0 if it misses one of them. `efficiency` is
    /// given the unit direction in which light leaves the plate, in the plate's frame; for the
    /// model it is [`SlitMirrorPlate::efficiency`](crate::optics::plate::SlitMirrorPlate::efficiency).
    pub fn luminance(&self, viewpoint: Vec3, at: Vec3, efficiency: impl Fn(Vec3) -> f64) -> f64 {
        let sight = at - viewpoint;
        let distance = sight.length();
        let ray = Ray { origin: viewpoint, direction: sight * (1.0 / distance) };
        let Some(crossing) = meet(&self.plate, &ray, distance) else { return 0.0 };
        let behind = Ray {
            origin: crossing,
            direction: pass_ideal(ray.direction, self.plate.frame.normal()),
        };
        let from_front = behind.direction.dot(self.display.frame.normal()) < 0.0;
        if !from_front || meet(&self.display, &behind, 0.0).is_none() {
            return 0.0;
        }
        efficiency(self.plate.frame.to_local_direction(-ray.direction))
    }
}

/// Where a ray meets a rectangle, no nearer than `from` mm.
fn meet(rectangle: &Rectangle, ray: &Ray, from: f64) -> Option<Vec3> {
    // An image or display may touch the plate: rounding must not put it behind.
    let t = rectangle.plane_distance(ray);
    if !t.is_finite() || t < from - 1e-9 {
        return None;
    }
    let point = ray.at(t);
    let inside = |x: f64| (-1e-12..=1.0 + 1e-12).contains(&x);
    rectangle.coordinates(point).into_iter().all(inside).then_some(point)
}

/// Luminance over a grid of viewpoints around the image.
#[derive(Clone, Debug, PartialEq)]
pub struct Viewpoints {
    /// Azimuths in the image's frame, degrees, rising.
    pub azimuth: Vec<f64>,
    /// Elevations in the image's frame, degrees, rising.
    pub elevation: Vec<f64>,
    /// The image's mean luminance over the display's; one row of azimuths for each elevation.
    pub luminance: Vec<f64>,
}

/// The image's mean luminance from viewpoints `distance` mm from its centre, in the directions of
/// all pairs of an azimuth and an elevation (degrees, in the image's frame:
/// [`viewing_direction`]). `samples` x `samples` points of the image are looked at; `efficiency`
/// is as for [`Arrangement::luminance`].
pub fn over_viewpoints(
    arrangement: &Arrangement,
    distance: f64,
    azimuth: &[f64],
    elevation: &[f64],
    samples: usize,
    efficiency: impl Fn(Vec3) -> f64 + Sync,
) -> Viewpoints {
    let frame = &arrangement.image.frame;
    let step = 1.0 / samples as f64;
    let seen_from = |a: f64, e: f64| {
        let towards = frame.to_world_direction(viewing_direction([a, e]));
        let viewpoint = frame.origin + towards * distance;
        let mut sum = 0.0;
        for i in 0..samples {
            for j in 0..samples {
                let uv = [(i as f64 + 0.5) * step, (j as f64 + 0.5) * step];
                sum += arrangement.luminance(viewpoint, arrangement.image.point(uv), &efficiency);
            }
        }
        sum * step * step
    };
    let row = |e: f64| azimuth.iter().map(move |&a| (a, e));
    let grid: Vec<_> = elevation.iter().flat_map(|&e| row(e)).collect();
    Viewpoints {
        azimuth: azimuth.to_vec(),
        elevation: elevation.to_vec(),
        luminance: grid.into_par_iter().map(|(a, e)| seen_from(a, e)).collect(),
    }
}

/// An interval of viewing angles, degrees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Span {
    /// The lower end.
    pub from: f64,
    /// The upper end.
    pub to: f64,
    /// Whether the grid ended there, at either end, before the luminance fell.
    pub cut: [bool; 2],
}

/// Where the image can be seen well.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VisibleRange {
    /// Azimuth and elevation of the largest luminance, degrees.
    pub brightest: [f64; 2],
    /// The largest luminance.
    pub luminance: f64,
    /// Azimuths around the brightest, at its elevation, where luminance is above half of its.
    pub azimuth: Span,
    /// Elevations around the brightest, at its azimuth, where luminance is above half of its.
    pub elevation: Span,
}

impl Viewpoints {
    /// The range around the brightest viewpoint where luminance is above half of its maximum,
    /// with ends interpolated between the grid's points; `None` if the image is dark everywhere.
    pub fn visible_range(&self) -> Option<VisibleRange> {
        let width = self.azimuth.len();
        let (brightest, &luminance) =
            self.luminance.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1))?;
        (luminance > 0.0).then(|| self.range_about(brightest % width, brightest / width))
    }

    /// As [`Self::visible_range`], about the brightest viewpoint of the lobe that a viewer is in: the one that is reached
    /// from its azimuth and elevation (degrees) by going to the brightest neighbour, as long as there is a brighter one.
    pub fn visible_range_from(&self, viewer: [f64; 2]) -> Option<VisibleRange> {
        let nearest = |axis: &[f64], to: f64| {
            let off = |&i: &usize| (axis[i] - to).abs();
            (0..axis.len()).min_by(|a, b| off(a).total_cmp(&off(b)))
        };
        let (width, height) = (self.azimuth.len(), self.elevation.len());
        let mut at = (nearest(&self.azimuth, viewer[0])?, nearest(&self.elevation, viewer[1])?);
        let seen = |(i, j): (usize, usize)| self.luminance[j * width + i];
        loop {
            let columns = at.0.saturating_sub(1)..=(at.0 + 1).min(width - 1);
            let rows = at.1.saturating_sub(1)..=(at.1 + 1).min(height - 1);
            let around = columns.flat_map(|i| rows.clone().map(move |j| (i, j)));
            let best =
                around.fold(at, |best, next| if seen(next) > seen(best) { next } else { best });
            if best == at {
                break;
            }
            at = best;
        }
        (seen(at) > 0.0).then(|| self.range_about(at.0, at.1))
    }

    /// The range about a viewpoint of the grid.
    fn range_about(&self, i: usize, j: usize) -> VisibleRange {
        let width = self.azimuth.len();
        let luminance = self.luminance[j * width + i];
        let column: Vec<f64> = self.luminance.iter().skip(i).step_by(width).copied().collect();
        let row = &self.luminance[j * width..(j + 1) * width];
        VisibleRange {
            brightest: [self.azimuth[i], self.elevation[j]],
            luminance,
            azimuth: above_half(&self.azimuth, row, i),
            elevation: above_half(&self.elevation, &column, j),
        }
    }
}

/// The interval around index `peak` where `y` stays at or above half of `y[peak]`.
fn above_half(x: &[f64], y: &[f64], peak: usize) -> Span {
    let half = 0.5 * y[peak];
    // Between a point inside and its neighbour outside.
    let end = |inside: usize, outside: usize| {
        let share = (y[inside] - half) / (y[inside] - y[outside]);
        x[inside] + share * (x[outside] - x[inside])
    };
    let last = x.len() - 1;
    let low = (0..peak).rev().find(|&k| y[k] < half);
    let high = (peak + 1..=last).find(|&k| y[k] < half);
    Span {
        from: low.map_or(x[0], |k| end(k + 1, k)),
        to: high.map_or(x[last], |k| end(k - 1, k)),
        cut: [low.is_none(), high.is_none()],
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::geometry::Frame;
    use crate::optics::plate::{LuminanceTable, SlitMirror, SlitMirrorPlate, viewing_angles};
    use std::path::Path;

    /// The usual bench: the plate at 45 degrees, the image upright `floating` mm away from it, the
    /// display lying below.
    pub fn bench(floating: f64) -> Arrangement {
        let plate =
            Rectangle { frame: Frame::new(Vec3::ZERO, [-45.0, 0.0, 0.0]), size: [488.0, 488.0] };
        let image = Rectangle {
            frame: Frame::new(Vec3::new(0.0, 0.0, floating), [0.0; 3]),
            size: [30.0, 30.0],
        };
        // The image mirrored in the plate: its centre below, facing up.
        let display = Rectangle {
            frame: Frame::new(plate.mirrored(image.frame.origin), [-90.0, 0.0, 0.0]),
            size: [30.0, 30.0],
        };
        Arrangement { plate, image, display }
    }

    #[test]
    fn seen_at_45_degrees_the_image_has_the_plates_efficiency() {
        let bench = bench(150.0);
        let plate = SlitMirrorPlate::new(SlitMirror::default()).unwrap();
        let (s, c) = 45f64.to_radians().sin_cos();
        let eye = Vec3::new(0.0, 0.0, 600.0);
        let centre = bench.luminance(eye, bench.image.frame.origin, |d| plate.efficiency(d));
        assert!((centre - plate.efficiency(Vec3::new(0.0, s, c))).abs() < 1e-12);
        assert!(centre > 0.3, "{centre}");
        // What the efficiency is asked for is the way to the viewer, in the plate's frame.
        bench.luminance(eye, bench.image.frame.origin, |d| {
            assert!((d - Vec3::new(0.0, -s, c)).length() < 1e-12, "{d:?}");
            1.0
        });
    }

    #[test]
    fn a_measured_table_stands_in_for_the_model() {
        let csv = "azimuth,elevation,value\n-10,-5,2\n10,-5,4\n-10,5,6\n10,5,8\n";
        let table = LuminanceTable::from_csv(csv.as_bytes(), Path::new("bench.csv")).unwrap();
        let bench = bench(150.0);
        let efficiency = |d: Vec3| {
            let world = bench.plate.frame.to_world_direction(d);
            let angles = viewing_angles(bench.image.frame.to_local_direction(world));
            table.relative(angles).unwrap_or(0.0)
        };
        let map = over_viewpoints(&bench, 450.0, &[-4.0, 8.0, 16.0], &[-1.0, 3.0], 1, efficiency);
        // 5 + 0.1 azimuth + 0.4 elevation over the table's largest value; nothing far outside it.
        for (got, value) in map.luminance.iter().zip([4.2, 5.4, 0.0, 5.8, 7.0, 0.0]) {
            assert!((got - value / 8.0).abs() < 1e-12, "{:?}", map.luminance);
        }
        // From the table's last angle half of the image is seen further outside: it is as bright as at the end of the table.
        let last = over_viewpoints(&bench, 450.0, &[10.0], &[0.0], 4, efficiency).luminance[0];
        let middle = over_viewpoints(&bench, 450.0, &[10.0], &[0.0], 1, efficiency).luminance[0];
        // An image of 30 mm at 450 is two degrees wide to either side, of 0.1 / 8 a degree; and elevations are even about 0.
        assert!(
            (middle - 6.0 / 8.0).abs() < 1e-12 && (last - middle).abs() < 0.02,
            "{last} {middle}"
        );
    }

    #[test]
    fn what_the_line_of_sight_misses_is_dark() {
        let bench = bench(150.0);
        let at = bench.image.frame.origin;
        let seen = |b: &Arrangement, eye: Vec3| b.luminance(eye, at, |_| 1.0);
        let eye = Vec3::new(0.0, 0.0, 600.0);
        assert_eq!(seen(&bench, eye), 1.0);
        // The plate passed by, the viewer behind the image, the viewer behind the plate.
        assert_eq!(seen(&bench, Vec3::new(2000.0, 0.0, 400.0)), 0.0);
        assert_eq!(seen(&bench, Vec3::new(0.0, 0.0, 50.0)), 0.0);
        assert_eq!(seen(&bench, Vec3::new(0.0, 0.0, -600.0)), 0.0);
        // A display from behind, or moved away.
        let mut turned = bench;
        turned.display.frame = Frame::new(bench.display.frame.origin, [90.0, 0.0, 0.0]);
        assert_eq!(seen(&turned, eye), 0.0);
        let mut moved = bench;
        moved.display.frame.origin.x += 16.0;
        assert_eq!(seen(&moved, eye), 0.0);
    }

    #[test]
    fn luminance_is_symmetric_and_brightest_near_one_mirror_per_layer() {
        let bench = bench(150.0);
        let plate = SlitMirrorPlate::new(SlitMirror::default()).unwrap();
        let azimuth: Vec<f64> = (-15..=15).map(|i| 2.0 * f64::from(i)).collect();
        let elevation: Vec<f64> = (-10..=10).map(|i| 2.0 * f64::from(i)).collect();
        let map = over_viewpoints(&bench, 450.0, &azimuth, &elevation, 4, |d| plate.efficiency(d));
        for j in 0..elevation.len() {
            for i in 0..azimuth.len() {
                let there = map.luminance[j * 31 + i];
                let mirrored = map.luminance[j * 31 + 30 - i];
                assert!((there - mirrored).abs() < 1e-12);
            }
        }
        let range = map.visible_range().unwrap();
        // 48.5 degrees of incidence is 3.5 degrees below or above the axis of a 45 degree plate:
        // the plate's normal rises, so larger incidence is seen from below.
        assert_eq!(range.brightest[0], 0.0);
        assert!((range.brightest[1] + 3.5).abs() <= 3.0, "{range:?}");
        assert!(range.azimuth.from < -10.0 && range.azimuth.to > 10.0);
        assert!((range.azimuth.from + range.azimuth.to).abs() < 1e-9);
    }

    #[test]
    fn the_visible_range_is_found_between_grid_points() {
        // A tent of height 1 at (4, -2), falling by 0.1 a degree along both axes.
        let azimuth: Vec<f64> = (-10..=6).map(f64::from).collect();
        let elevation: Vec<f64> = (-10..=10).map(f64::from).collect();
        let tent = |a: f64, e: f64| 1.0 - 0.12 * (a - 4.0).abs() - 0.09 * (e + 2.0).abs();
        let luminance = elevation
            .iter()
            .flat_map(|&e| azimuth.iter().map(move |&a| tent(a, e).max(0.0)))
            .collect();
        let range = Viewpoints { azimuth, elevation, luminance }.visible_range().unwrap();
        assert_eq!((range.brightest, range.luminance), ([4.0, -2.0], 1.0));
        assert!((range.azimuth.from - (4.0 - 0.5 / 0.12)).abs() < 1e-12);
        assert_eq!((range.azimuth.to, range.azimuth.cut), (6.0, [false, true]));
        assert!((range.elevation.from - (-2.0 - 0.5 / 0.09)).abs() < 1e-12);
        assert!((range.elevation.to - (-2.0 + 0.5 / 0.09)).abs() < 1e-12);
        // Two hills: each viewer finds the own one.
        let hills =
            |a: f64| (1.0 - 0.2 * (a + 6.0).abs()).max(0.8 - 0.2 * (a - 4.0).abs()).max(0.0);
        let azimuth: Vec<f64> = (-10..=10).map(f64::from).collect();
        let luminance = [azimuth.as_slice(); 2].concat().into_iter().map(hills).collect();
        let two = Viewpoints { azimuth, elevation: vec![0.0, 1.0], luminance };
        assert_eq!(two.visible_range_from([2.2, 0.0]).unwrap().brightest, [4.0, 0.0]);
        assert_eq!(two.visible_range_from([-2.0, 1.0]).unwrap().brightest[0], -6.0);
        assert_eq!(two.visible_range_from([90.0, 0.0]), None);
        assert_eq!(two.visible_range().unwrap().brightest[0], -6.0);
        let dark = Viewpoints {
            azimuth: vec![0.0, 1.0],
            elevation: vec![0.0, 1.0],
            luminance: vec![0.0; 4],
        };
        assert_eq!(dark.visible_range(), None);
    }
}
