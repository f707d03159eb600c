//! The best display image there is.
//!
//! What a viewer sees is linear in the display's pixels: a display's pixel is a box that shines evenly, an eye's pixel a box that gathers what its rays
//! end on. So the display image
//! whose view comes nearest to the target is a least-squares problem with bounds, 0 to what the display can
//! emit; it is sparse, and a few conjugate-gradient steps from the plain filter's image solve it.
//!
//! For whom? Nobody knows how fine a viewer's eye is: an image that is best for one eye can be worse than the plain filter's for another. So three eyes
//! count alike ([`EYES`]): twice as fine as the display, as fine, and half as fine. And no eye of these is to see it worse
//! than the plain filter's by more than [`WORST`] dB.
//!
//! Differences count by the slope of the sRGB curve at the target's light as the coarsest eye sees it, so that an error counts as it
//! shows in the encoded view (and to the eye), not as light, and what a pixel cannot resolve keeps its mean light.

mod eyes;
mod operator;
mod scatter;
mod solve;

pub use eyes::{EYES, eye_views, seen_coarser};
pub use scatter::scatter_average;

use super::{Picture, srgb};
use eyes::Eyes;
use operator::{Rgb, SparseRows};
use rayon::prelude::*;
use solve::{Effort, Problem};
use std::ops::Range;

/// The rays of a view, traced when they are asked for: a view of a megapixel has more of them than should be held.
pub trait ViewRays: Sync {
    /// View pixels in a row, and rows.
    fn size(&self) -> [usize; 2];

    /// Rays through each view pixel.
    fn rays_per_pixel(&self) -> usize;

    /// Where the rays through some view pixels (row by row from the top left) end on the display: st (right, up, \[0, 1\]), those of one
    /// pixel and then of the next; NaN where a ray ends dark. `ends` holds [`Self::rays_per_pixel`] for each pixel.
    fn ends(&self, pixels: Range<usize>, ends: &mut [[f64; 2]]);
}

/// Where the view's rays end on the display, held: for views that are looked at again and again.
#[derive(Clone, Debug, PartialEq)]
pub struct ViewSamples {
    size: [usize; 2],
    each: usize,
    st: Vec<[f64; 2]>,
}

impl ViewSamples {
    /// Traces all of a view's rays. `progress` is called with the number of rows that are done.
    ///
    /// Memory: 16 B a ray.
    pub fn of(rays: &impl ViewRays, progress: &(dyn Fn(usize) + Sync)) -> Self {
        let (size, each) = (rays.size(), rays.rays_per_pixel());
        let width = size[0];
        let mut st = vec![[f64::NAN; 2]; width * size[1] * each];
        st.par_chunks_mut((width * each).max(1)).enumerate().for_each(|(row, ends)| {
            rays.ends(row * width..(row + 1) * width, ends);
            progress(1);
        });
        Self { size, each, st }
    }

    /// The same rays, their ends told in other coordinates.
    pub fn map(mut self, to: impl Fn([f64; 2]) -> [f64; 2]) -> Self {
        self.st.iter_mut().for_each(|st| *st = to(*st));
        self
    }

    /// Where the rays end: st of each, in the order of [`ViewRays::ends`]; NaN where a ray ends dark.
    pub fn st(&self) -> &[[f64; 2]] {
        &self.st
    }
}

impl ViewRays for ViewSamples {
    fn size(&self) -> [usize; 2] {
        self.size
    }

    fn rays_per_pixel(&self) -> usize {
        self.each
    }

    fn ends(&self, pixels: Range<usize>, ends: &mut [[f64; 2]]) {
        let each = self.each;
        ends.copy_from_slice(&self.st[pixels.start * each..pixels.end * each]);
    }
}

/// How the difference between view and target counts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Weighting {
    /// As light: linear values.
    Linear,
    /// As it shows: by the slope of the sRGB curve at the target.
    #[default]
    Encoded,
}

/// What no eye of [`EYES`] finds the best display image worse by than the initial one, dB.
pub const WORST: f64 = 0.3;

/// The outcome of [`optimal_display`].
#[derive(Clone, Debug)]
pub struct Optimal {
    /// The display image; alpha as in the initial one.
    pub display: Picture,
    /// Conjugate-gradient steps taken.
    pub steps: usize,
    /// Whether it is not the optimum, because an eye would have found that worse than the initial one by more than [`WORST`].
    pub held_back: bool,
}

/// Why a best display image cannot be sought.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum OptimalError {
    /// The arguments' sizes do not fit together.
    #[error("the view samples' size does not fit: {0}")]
    Size(String),
}

/// The display image in \[0, 1\] whose views for all [`EYES`] are nearest to `target`, from the `initial` one (the plain
/// filter's), whose pixels stay where no ray ends. Linear light. `rays` and `target` are the finest eye's: twice as fine as the display.
///
/// Both pictures are taken over: at a megapixel what is held at once is what limits a user's machine (some 400 B for each display pixel that is seen).
///
/// # Errors
/// [`OptimalError::Size`] where the sizes of `rays`, `target` and their counts disagree or anything is empty.
pub fn optimal_display(
    rays: &impl ViewRays,
    target: Picture,
    initial: Picture,
    weighting: Weighting,
) -> Result<Optimal, OptimalError> {
    check_sizes(rays, &target, &initial)?;
    let (width, height) = (initial.width, initial.height);
    // The matrices are at their largest while they are built: before the vectors are there.
    let forward = SparseRows::from_view(rays, width, height);
    let backward = forward.transposed(width * height);
    let (count, columns) = (target.pixels.len(), target.width);
    let opaque = |[r, g, b, _]: [f32; 4]| [r, g, b];
    let target: Vec<Rgb> = target.pixels.into_iter().map(opaque).collect();
    let alpha: Vec<f32> = initial.pixels.iter().map(|pixel| pixel[3]).collect();
    let within = |pixel: [f32; 4]| opaque(pixel.map(|value| value.clamp(0.0, 1.0)));
    let mut pixels: Vec<Rgb> = initial.pixels.into_iter().map(within).collect();
    let start = pixels.clone();
    let eyes = Eyes::new(&target, columns, &Weights::new(weighting));
    let problem = Problem { forward: &forward, backward: &backward, target: &target, eyes: &eyes };
    let effort = Effort {
        // On photographs through a ball lens 16 to 24 steps come within 0.05 dB of 300.
        steps: 40,
        steps_per_face: 4,
        tolerance: 5e-4,
        // A quarter of an 8-bit step, root mean square: below what the display can show.
        negligible: match weighting {
            Weighting::Linear => 0.0,
            Weighting::Encoded => (0.25f64 / 255.0).powi(2) * count as f64,
        },
    };
    let steps = problem.solve(&mut pixels, effort);
    let held_back = problem.hold(&mut pixels, &start, 10f64.powf(0.1 * WORST));
    drop((forward, backward, target, start));
    let whole = |([r, g, b], alpha): (Rgb, f32)| [r, g, b, alpha];
    let pixels = pixels.into_iter().zip(alpha).map(whole).collect();
    Ok(Optimal { display: Picture { width, height, pixels }, steps, held_back })
}

/// The view of a display image by a camera whose rays interpolate between display pixels: smooth, as a camera that is focused on the image and blurs pixels sees it. Linear light; alpha 1.
///
/// # Errors
/// [`OptimalError::Size`] where the rays' counts disagree or anything is empty.
pub fn view_through(rays: &impl ViewRays, display: &Picture) -> Result<Picture, OptimalError> {
    check_rays(rays, display)?;
    let ([width, height], each) = (rays.size(), rays.rays_per_pixel());
    let mut pixels = vec![[0.0, 0.0, 0.0, 1.0]; width * height];
    pixels.par_chunks_mut(width).enumerate().for_each(|(row, line)| {
        let mut ends = vec![[f64::NAN; 2]; width * each];
        rays.ends(row * width..(row + 1) * width, &mut ends);
        for (pixel, ends) in line.iter_mut().zip(ends.chunks_exact(each)) {
            for light in ends.iter().filter_map(|&st| display.emitted(st)) {
                for c in 0..3 {
                    pixel[c] += light[c] / each as f32;
                }
            }
        }
    });
    Ok(Picture { width, height, pixels })
}

/// How much an error counts, by the target's value.
struct Weights(Vec<f32>);

impl Weights {
    /// Steps of the target's value from 0 to 1: a weight for each is a table that stays in the nearest cache, where one for each
    /// pixel would be a picture more. A weight off by a step's width moves no optimum that could be seen.
    const STEPS: usize = 4095;

    /// The squared slope of the sRGB curve, or 1.
    fn new(weighting: Weighting) -> Self {
        let weight = |step: usize| match weighting {
            Weighting::Linear => 1.0,
            Weighting::Encoded => {
                srgb::encode_slope(step as f64 / Self::STEPS as f64).powi(2) as f32
            }
        };
        Self((0..=Self::STEPS).map(weight).collect())
    }

    /// The weights at a target's pixel.
    #[inline]
    fn at(&self, target: Rgb) -> Rgb {
        // A float to an integer saturates, and takes NaN to 0.
        target.map(|value| self.0[((value * Self::STEPS as f32 + 0.5) as usize).min(Self::STEPS)])
    }
}

fn check_rays(rays: &impl ViewRays, display: &Picture) -> Result<(), OptimalError> {
    let ([width, height], each) = (rays.size(), rays.rays_per_pixel());
    let count = width * height * each;
    if count == 0 {
        return Err(OptimalError::Size(format!(
            "a view of {width} x {height} pixels of {each} rays each"
        )));
    }
    // Indices are 32 bits wide, and a row has at most four entries a ray.
    if count.saturating_mul(4) > u32::MAX as usize {
        return Err(OptimalError::Size(format!("{count} rays are more than can be handled")));
    }
    if display.width * display.height == 0
        || display.pixels.len() != display.width * display.height
        || display.pixels.len() > u32::MAX as usize
    {
        return Err(OptimalError::Size(format!(
            "a display of {} x {} pixels",
            display.width, display.height
        )));
    }
    Ok(())
}

fn check_sizes(
    rays: &impl ViewRays,
    target: &Picture,
    initial: &Picture,
) -> Result<(), OptimalError> {
    check_rays(rays, initial)?;
    let [width, height] = rays.size();
    if [target.width, target.height] != [width, height] || target.pixels.len() != width * height {
        return Err(OptimalError::Size(format!(
            "a target of {} x {} pixels for a view of {width} x {height}",
            target.width, target.height
        )));
    }
    Ok(())
}

#[cfg(test)]
mod tests;
