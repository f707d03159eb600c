//! Photographs that our simulator takes: of the patterns through the plate's slit mirrors, stray light and all, through a lens with distortion, with
//! photon noise, as JPEG.

use crate::camera::{Lens, pixel_ray};
use crate::patterns::Patterns;
use crate::rehearsal::{lens, normal};
use crate::stray::at_plate;
use image::codecs::jpeg::JpegEncoder;
use midair::geometry::{Frame, Ray};
use midair::optics::plate::{Class, Model};
use midair::optics::srgb;
use midair::transport::{Path, Placing, Setup};
use rayon::prelude::*;

/// A camera that photographs a display's patterns.
#[derive(Clone, Debug)]
pub struct Film {
    /// Width and height of its photographs, px.
    pub size: [usize; 2],
    /// Its lens.
    pub lens: Lens,
    /// Rays for each pixel along either axis.
    pub rays: usize,
    /// Photons that a pixel at full scale counts: shot noise is their root.
    pub photons: f64,
    /// JPEG's quality.
    pub quality: u8,
}

/// Where a camera pixel's light comes from.
#[derive(Clone, Copy, Debug)]
struct Tap {
    /// The display's pixel, row 0 at the top.
    pixel: u32,
    /// How much of its light.
    weight: f32,
    /// Whether the light forms the mid-air image.
    real: bool,
}

/// A row of pixels: the light of each pattern, the truth.
struct Row {
    light: Vec<Vec<f32>>,
    seen: Vec<Option<[f64; 2]>>,
    stray: Vec<f32>,
}

/// What a camera pixel sees, for those that judge a decoder.
#[derive(Clone, Debug)]
pub struct Truth {
    /// The point of the display's plane that the pixel's middle sees by the plate's mean course, be it beyond the display's edge; `None` where it sees none.
    pub st: Vec<Option<[f64; 2]>>,
    /// The stray light's share of each pixel's.
    pub stray: Vec<f32>,
}

/// Steps of a sequence that fills a square evenly: powers of one over the plastic number (Roberts 2018).
const EVENLY: [f64; 2] = [0.754_877_666_246_692_7, 0.569_840_290_998_053_2];

impl Film {
    /// A camera with photographs of so many columns, 3 : 2, that sees the image over half of their width from the viewpoint's distance.
    pub fn over_image(setup: &Setup, width: usize) -> Self {
        let full = lens(setup);
        // Of a lens for 6000 columns.
        let scale = width as f64 / 6000.0;
        let lens = Lens {
            focal: full.focal.map(|f| f * scale),
            centre: full.centre.map(|c| c * scale),
            ..full
        };
        Self { size: [width, width * 2 / 3], lens, rays: 3, photons: 20_000.0, quality: 92 }
    }

    /// The set-up's patterns as the camera at a place photographs them: a JPEG file for each, and what each pixel really sees.
    pub fn shoot(
        &self,
        setup: &Setup,
        camera: &Frame,
        patterns: &Patterns,
        seed: u64,
    ) -> (Vec<Vec<u8>>, Truth) {
        let [width, height] = self.size;
        let lights: Vec<Vec<f32>> = (0..patterns.list.len()).map(|k| patterns.drawn(k)).collect();
        let placed = Placing::constant(camera);
        let rows: Vec<Row> = (0..height)
            .into_par_iter()
            .map(|row| {
                let mut draw = fastrand::Rng::with_seed(seed ^ (row as u64) << 20);
                let mut light = vec![vec![0.0f32; width]; patterns.list.len()];
                let (mut seen, mut stray) = (vec![None; width], vec![0.0; width]);
                let mut taps = Vec::new();
                for column in 0..width {
                    let middle = [column as f64 + 0.5, row as f64 + 0.5];
                    let ray = pixel_ray(&placed, &self.lens, middle);
                    seen[column] = setup.trace(ray, &mut Path::new()).st();
                    taps.clear();
                    self.taps(setup, &placed, [column, row], &mut draw, &mut taps);
                    for (light, pattern) in light.iter_mut().zip(&lights) {
                        light[column] =
                            taps.iter().map(|tap| tap.weight * pattern[tap.pixel as usize]).sum();
                    }
                    let of = |real: bool| {
                        taps.iter().filter(|t| t.real == real).map(|t| t.weight).sum::<f32>()
                    };
                    stray[column] = of(false) / (of(false) + of(true)).max(1e-12);
                }
                Row { light, seen, stray }
            })
            .collect();
        // White is exposed to nine tenths of full scale.
        let mut whites: Vec<f32> =
            rows.iter().flat_map(|row| row.light[0].iter().copied()).collect();
        let high = whites.len() * 995 / 1000;
        let exposure =
            0.9 / f64::from(*whites.select_nth_unstable_by(high, f32::total_cmp).1).max(1e-9);
        let files = (0..patterns.list.len())
            .into_par_iter()
            .map(|pattern| {
                let mut draw =
                    fastrand::Rng::with_seed(seed.wrapping_add(977 * (pattern as u64 + 1)));
                let mut grey = Vec::with_capacity(width * height);
                for row in &rows {
                    for &light in &row.light[pattern] {
                        // A dark room is not quite dark.
                        let exposed = f64::from(light) * exposure + 0.004;
                        let noise = (exposed / self.photons).sqrt() * normal(&mut draw);
                        let code = srgb::encode((exposed + noise).clamp(0.0, 1.0));
                        grey.push((255.0 * code).round() as u8);
                    }
                }
                let mut file = Vec::new();
                let encoder = JpegEncoder::new_with_quality(&mut file, self.quality);
                let size = [width, height].map(|side| side as u32);
                // Into memory nothing fails but what has no pixels.
                match image::ImageEncoder::write_image(
                    encoder,
                    &grey,
                    size[0],
                    size[1],
                    image::ExtendedColorType::L8,
                ) {
                    Ok(()) => file,
                    Err(_) => Vec::new(),
                }
            })
            .collect();
        let mut truth = Truth { st: Vec::new(), stray: Vec::new() };
        for row in rows {
            truth.st.extend(row.seen);
            truth.stray.extend(row.stray);
        }
        (files, truth)
    }

    /// Where a pixel's light comes from: some rays, each through the lattice at a place of its own, as the camera's pupil averages over it.
    fn taps(
        &self,
        setup: &Setup,
        camera: &Placing<f64>,
        [column, row]: [usize; 2],
        draw: &mut fastrand::Rng,
        taps: &mut Vec<Tap>,
    ) {
        let [width, height] = setup.resolution;
        let many = self.rays * self.rays;
        let shift = [draw.f64(), draw.f64()];
        for k in 0..many {
            let at =
                [k % self.rays, k / self.rays].map(|k| (k as f64 + draw.f64()) / self.rays as f64);
            let pixel = [column as f64 + at[0], row as f64 + at[1]];
            let ray = pixel_ray(camera, &self.lens, pixel);
            let mut path = Path::new();
            setup.trace(ray, &mut path);
            let Some((left, share)) = at_plate(setup, ray, &path) else { continue };
            let frame = &setup.plate.rectangle.frame;
            let crossing = left.origin;
            let (real, behind, plate_share) = match setup.plate.model() {
                Model::SlitMirror(plate) => {
                    // A lattice that stands elsewhere: the ray is moved and moved back. Rays share the distances between mirrors among them evenly, as a
                    // pupil does, and not in step with their places in the pixel.
                    let across = [0, 1].map(|c| (shift[c] + k as f64 * EVENLY[c]).fract());
                    let across = across.map(|share| share * plate.parameters().pitch);
                    let [x, y] = plate.across_inverse(across);
                    let aside = frame.axes[0] * x + frame.axes[1] * y;
                    let moved = Ray { origin: crossing + aside, ..left };
                    let Some((class, behind, passed)) = setup.plate.pass(&moved, moved.origin)
                    else {
                        continue;
                    };
                    let behind = Ray { origin: behind.origin - aside, ..behind };
                    (class == Class::Real, behind, passed)
                }
                Model::Ideal | Model::Measured(_) => {
                    let Some((class, behind, passed)) = setup.plate.pass(&left, crossing) else {
                        continue;
                    };
                    (class == Class::Real, behind, passed)
                }
            };
            let distance = setup.display.plane_distance(&behind);
            let towards = behind.direction.dot(setup.display.frame.normal()) < 0.0;
            let st = setup.display.coordinates(behind.at(distance));
            if !(distance > 0.0) || !towards || !st.iter().all(|c| (0.0..1.0).contains(c)) {
                continue;
            }
            let emitted = setup.emitted_against(behind.direction)[1];
            let (x, y) =
                ((st[0] * width as f64) as usize, ((1.0 - st[1]) * height as f64) as usize);
            taps.push(Tap {
                pixel: (y.min(height - 1) * width + x) as u32,
                weight: (share * plate_share[1] * emitted / many as f64) as f32,
                real,
            });
        }
    }
}
