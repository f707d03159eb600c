//! How sharp the mid-air image is: point-spread and modulation transfer in its plane.

use crate::geometry::{Ray, Rectangle, Vec3};
use crate::optics::plate::{Class, SlitMirrorPlate, luminance};

/// How a point of the image is looked at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointSpreadSettings {
    /// Centre of the viewer's pupil in the world, mm.
    pub eye: Vec3,
    /// Diameter of the pupil, mm (an eye's is 2 to 8).
    pub pupil: f64,
    /// Lines of sight followed.
    pub rays: usize,
    /// Whether to average over where the point lies relative to the plate's lattice, as small
    /// motions of the viewer do; otherwise this very point's spread.
    pub lattice_averaged: bool,
}

/// The mid-air image of one point of the display, as seen through a pupil focused on it.
///
/// Geometrical: neither the slits' nor the pupil's diffraction is in it. Only real light is.
#[derive(Clone, Debug, PartialEq)]
pub struct PointSpread {
    /// Places in the image's frame, mm from the point, where its light is seen, and how much:
    /// x, y, luminance.
    pub light: Vec<[f64; 3]>,
    /// Luminance of the image over the display's: the sum of the light over all lines of sight.
    pub efficiency: f64,
}

/// Looks at the point `at` (world, mm; in `image`'s plane) through the plate.
///
/// Lines of sight run from low-discrepancy points of the pupil (Roberts's R4 sequence, 2018)
/// through `at` and the plate, whose rectangle's edges stop them; what they meet in the display's
/// place, the image's mirror image, is the point spread, turned about.
pub fn point_spread(
    model: &SlitMirrorPlate,
    plate: &Rectangle,
    image: &Rectangle,
    at: Vec3,
    settings: &PointSpreadSettings,
) -> PointSpread {
    let sight = (at - settings.eye).normalized();
    let [right, up] = sight.perpendicular();
    let pitch = model.parameters().pitch;
    let at_image = image.frame.to_local(at);
    let mut light = Vec::new();
    let mut sum = 0.0;
    for i in 0..settings.rays {
        let [r, turn, a, b] = low_discrepancy(i);
        let radius = 0.5 * settings.pupil * r.sqrt();
        let (s, c) = (std::f64::consts::TAU * turn).sin_cos();
        let from = settings.eye + right * (radius * c) + up * (radius * s);

        let origin = plate.frame.to_local(from);
        let d = plate.frame.to_local_direction((at - from).normalized());
        let crossing = origin - d * (origin.z / d.z);
        let inside = |x: f64, size: f64| x.abs() <= 0.5 * size;
        if !(inside(crossing.x, plate.size[0]) && inside(crossing.y, plate.size[1])) {
            continue;
        }
        // Moving the lattice instead of the viewer and the point.
        let [x, y] = match settings.lattice_averaged {
            true => model.across_inverse([a * pitch, b * pitch]),
            false => [0.0; 2],
        };
        let shift = Vec3::new(x, y, 0.0);
        let Some(passage) = model.pass(origin + shift, d) else { continue };
        if passage.class != Class::Real {
            continue;
        }
        // Mirrored in the plate, the display's plane is the image's.
        let mirrored = |v: Vec3| Vec3::new(v.x, v.y, -v.z);
        let back = Ray {
            origin: plate.frame.to_world(mirrored(passage.exit_point - shift)),
            direction: plate.frame.to_world_direction(mirrored(passage.direction)),
        };
        let met = image.frame.to_local(back.at(image.plane_distance(&back)));
        let weight = luminance(passage.weight);
        sum += weight;
        light.push([at_image.x - met.x, at_image.y - met.y, weight]);
    }
    PointSpread { light, efficiency: sum / settings.rays as f64 }
}

impl PointSpread {
    /// The mean place of the light, mm; NaN if there is none.
    pub fn centroid(&self) -> [f64; 2] {
        self.mean(|x, y| [x, y])
    }

    /// Standard deviations along x and y about the centroid, mm; NaN if there is no light.
    pub fn deviation(&self) -> [f64; 2] {
        let [cx, cy] = self.centroid();
        self.mean(|x, y| [(x - cx).powi(2), (y - cy).powi(2)]).map(f64::sqrt)
    }

    fn mean(&self, of: impl Fn(f64, f64) -> [f64; 2]) -> [f64; 2] {
        let (mut sums, mut total) = ([0.0; 2], 0.0);
        for &[x, y, w] in &self.light {
            let [a, b] = of(x, y);
            sums[0] += w * a;
            sums[1] += w * b;
            total += w;
        }
        sums.map(|s| s / total)
    }

    /// Modulation transfer along x and along y at spatial frequencies in cycles per mm: 1 at 0;
    /// NaN if there is no light. The modulus of the spread's Fourier transform, summed directly.
    pub fn modulation_transfer(&self, frequencies: &[f64]) -> [Vec<f64>; 2] {
        let at = |f: f64, axis: usize| {
            let k = std::f64::consts::TAU * f;
            let pick = move |x: f64, y: f64| if axis == 0 { x } else { y };
            let [re, im] = self.mean(|x, y| {
                let (s, c) = (k * pick(x, y)).sin_cos();
                [c, s]
            });
            re.hypot(im)
        };
        [0, 1].map(|axis| frequencies.iter().map(|&f| at(f, axis)).collect())
    }

    /// The spread as a picture: shares of the light in `bins` x `bins` cells of a square of
    /// `size` mm about the point, the top row first; light outside is left out.
    pub fn histogram(&self, size: f64, bins: usize) -> Vec<f64> {
        let mut cells = vec![0.0; bins * bins];
        let total: f64 = self.light.iter().map(|l| l[2]).sum();
        let cell = |x: f64| ((x / size + 0.5) * bins as f64).floor();
        let within = 0.0..bins as f64;
        for &[x, y, w] in &self.light {
            let (column, row) = (cell(x), cell(-y));
            if within.contains(&column) && within.contains(&row) {
                cells[row as usize * bins + column as usize] += w / total;
            }
        }
        cells
    }
}

/// The i-th point of Roberts's R4 sequence in \[0, 1)^4: steps by powers of 1 / g, g^5 = g + 1.
fn low_discrepancy(i: usize) -> [f64; 4] {
    const STEP: f64 = 1.0 / 1.167_303_978_261_418_7;
    let i = (i + 1) as f64;
    std::array::from_fn(|k| (0.5 + i * STEP.powi(k as i32 + 1)).fract())
}

#[cfg(test)]
mod tests {
    use super::super::viewpoints::tests::bench;
    use super::*;
    use crate::geometry::Frame;
    use crate::optics::plate::SlitMirror;

    const EYE: Vec3 = Vec3::new(0.0, 0.0, 650.0);

    fn settings(pupil: f64, rays: usize, lattice_averaged: bool) -> PointSpreadSettings {
        PointSpreadSettings { eye: EYE, pupil, rays, lattice_averaged }
    }

    fn model(pitch: f64) -> SlitMirrorPlate {
        let layer_depth = 2.5 * pitch;
        SlitMirrorPlate::new(SlitMirror { pitch, layer_depth, ..SlitMirror::default() }).unwrap()
    }

    /// Seen along one direction, averaged over the lattice, light spreads evenly: across each
    /// layer's mirrors over +- pitch times the odd share, because k mirrors bring light that
    /// enters at x back to (k + 1) p - m h - x.
    #[test]
    fn through_a_pinhole_the_spread_is_an_even_square() {
        for degrees in [35.0, 52.0] {
            // Mirrors along the plate's own axes; the image parallel to the plate.
            let model =
                SlitMirrorPlate::new(SlitMirror { azimuth: 0.0, ..SlitMirror::default() }).unwrap();
            let plate = Rectangle { frame: Frame::WORLD, size: [1e4, 1e4] };
            let at = Vec3::new(0.0, 0.0, 100.0);
            let image =
                Rectangle { frame: Frame { origin: at, ..Frame::WORLD }, size: [30.0, 30.0] };
            let (s, c) = f64::to_radians(degrees).sin_cos();
            let half = 0.5f64.sqrt();
            let d = Vec3::new(s * half, s * half, c);
            let settings = PointSpreadSettings {
                eye: at + d * 400.0,
                pupil: 0.0,
                rays: 100_000,
                lattice_averaged: true,
            };
            let spread = point_spread(&model, &plate, &image, at, &settings);
            let odd = model.odd_shares(d);
            // The efficiency is the closed form's.
            assert!((spread.efficiency - model.efficiency(d)).abs() < 1e-3);
            // Half widths in x (layer 1) and y (layer 0).
            let widths = [0.5 * odd[1], 0.5 * odd[0]];
            let deviation = spread.deviation();
            let frequencies = [0.0, 0.3, 0.8, 1.5];
            let transfer = spread.modulation_transfer(&frequencies);
            for axis in 0..2 {
                assert!((deviation[axis] - widths[axis] / 3f64.sqrt()).abs() < 1e-3);
                for (&f, &m) in frequencies.iter().zip(&transfer[axis]) {
                    let x = std::f64::consts::TAU * f * widths[axis];
                    let sinc = if x == 0.0 { 1.0 } else { (x.sin() / x).abs() };
                    // 100 000 low-discrepancy points: errors of some 1e-4.
                    assert!((m - sinc).abs() < 2e-3, "{f} {m} {sinc}");
                }
            }
            // Mirrors act as if in the middle of their layer, so the two layers' images lie apart
            // in depth and are moved along the sight. The display's light meets layer 1 first,
            // whose image (across x) lies nearer to the plate by h m / tan: crossing the image
            // plane beyond it, light is off by + h m along its way; layer 0's (across y) by - h m.
            let [cx, cy] = spread.centroid();
            let moved = 1.25 * d.x / (1.52 * (1.0 - (s / 1.52).powi(2)).sqrt());
            assert!((cx - moved).abs() < 1e-3 && (cy + moved).abs() < 1e-3, "{cx} {cy}");
            // Cells of the histogram share all light evenly where they lie within the square.
            let cells = spread.histogram(4.0, 40);
            // Sums of tens of thousands of shares.
            assert!((cells.iter().sum::<f64>() - 1.0).abs() < 1e-9);
            let full = 0.01 / (4.0 * widths[0] * widths[1]);
            let inside =
                |centre: f64, middle: f64, width: f64| (centre - middle).abs() < width - 0.06;
            for (row, column) in (0..40).flat_map(|row| (0..40).map(move |c| (row, c))) {
                let x = -1.95 + 0.1 * f64::from(column);
                let y = 1.95 - 0.1 * f64::from(row);
                if inside(x, cx, widths[0]) && inside(y, cy, widths[1]) {
                    let share = cells[(row * 40 + column) as usize];
                    // Some thousand points in a cell.
                    assert!((share / full - 1.0).abs() < 0.1, "{share} {full}");
                }
            }
        }
    }

    #[test]
    fn blur_grows_with_pitch() {
        let bench = bench(100.0);
        let at = bench.image.frame.origin;
        let blur = |pitch: f64| {
            let set = settings(4.0, 20_000, true);
            let spread = point_spread(&model(pitch), &bench.plate, &bench.image, at, &set);
            let [x, y] = spread.deviation();
            x.hypot(y)
        };
        let blurs: Vec<f64> = [0.05, 0.1, 0.25, 0.5, 1.0].into_iter().map(blur).collect();
        for pair in blurs.windows(2) {
            assert!(pair[1] > 1.5 * pair[0], "{blurs:?}");
        }
        // It is made by the lattice: in proportion to it.
        assert!((blurs[4] / blurs[1] - 10.0).abs() < 0.5, "{blurs:?}");
    }

    /// A pupil looks through a wider part of the lattice the further the image floats from it; the
    /// blur levels off when that part holds whole cells (4 mm * 90 / 590 is more than a pitch).
    #[test]
    fn blur_grows_with_floating_distance() {
        let blur = |floating: f64, lattice_averaged: bool| {
            let bench = bench(floating);
            let mut sum = 0.0;
            for i in 0..40 {
                let off = Vec3::new(0.37 * f64::from(i % 8), 0.41 * f64::from(i / 8), 0.0);
                let at = bench.image.frame.origin + off;
                let eye = at + Vec3::new(0.0, 0.0, 500.0);
                let set = PointSpreadSettings { eye, ..settings(4.0, 2_000, lattice_averaged) };
                let spread = point_spread(&model(0.5), &bench.plate, &bench.image, at, &set);
                let [x, y] = spread.deviation();
                sum += x.hypot(y);
            }
            sum / 40.0
        };
        let blurs = [5.0, 10.0, 20.0, 40.0, 80.0].map(|f| blur(f, false));
        assert!(blurs.windows(2).all(|pair| pair[1] > 1.1 * pair[0]), "{blurs:?}");
        let most = blur(150.0, true);
        for far in [150.0, 300.0] {
            assert!((blur(far, false) / most - 1.0).abs() < 0.05, "{far} {most}");
        }
    }

    #[test]
    fn the_image_of_a_fine_lattice_is_a_point_in_its_place() {
        let bench = bench(100.0);
        let at = bench.image.point([0.8, 0.3]);
        let set = settings(4.0, 5_000, true);
        let spread = point_spread(&model(1e-4), &bench.plate, &bench.image, at, &set);
        assert!(spread.light.len() > 2_000);
        // A pitch of 1e-4 and layers of 2.5e-4 mm displace light by no more.
        assert!(spread.light.iter().all(|l| l[0].hypot(l[1]) < 5e-4));
    }

    #[test]
    fn a_plate_out_of_sight_gives_no_light() {
        let mut bench = bench(100.0);
        bench.plate.size = [1.0, 1.0];
        bench.plate.frame.origin.x += 50.0;
        let at = bench.image.frame.origin;
        let set = settings(4.0, 100, true);
        let spread = point_spread(&model(0.5), &bench.plate, &bench.image, at, &set);
        assert!(spread.light.is_empty() && spread.efficiency == 0.0);
        assert!(spread.deviation()[0].is_nan());
    }
}
