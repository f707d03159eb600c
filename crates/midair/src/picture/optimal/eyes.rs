//! For whom a display image is best: eyes of several fineness.

use super::operator::{Rgb, SparseRows};
use super::{OptimalError, ViewRays, Weights, check_rays};
use crate::picture::Picture;
use rayon::prelude::*;

/// Pixels along a side that the three eyes take together of the finest one's view: nobody knows from how near, and how well, a viewer looks, so
/// that eyes twice as fine as the display, as fine, and half as fine all count alike.
pub const EYES: [usize; 3] = [1, 2, 4];

/// Pixels of the finest eye along a side of the coarsest one's.
const BLOCK: usize = EYES[2];

/// The views of a display image for the three [`EYES`]; the rays are the finest one's, twice as fine as the display. A display's pixel is a box
/// that shines evenly, and so is an eye's. Linear light, alpha 1.
///
/// # Errors
/// [`OptimalError::Size`] where the rays' counts disagree or anything is empty.
pub fn eye_views(rays: &impl ViewRays, display: &Picture) -> Result<[Picture; 3], OptimalError> {
    check_rays(rays, display)?;
    let [width, height] = rays.size();
    let forward = SparseRows::from_view(rays, display.width, display.height);
    let shown: Vec<Rgb> = display.pixels.iter().map(|&[r, g, b, _]| [r, g, b]).collect();
    let mut seen: Vec<Rgb> = vec![[0.0; 3]; width * height];
    forward.multiply(&shown, &mut seen, |_, value, _| (value, [0.0; 3]));
    let pixels = seen.into_iter().map(|[r, g, b]| [r, g, b, 1.0]).collect();
    let finest = Picture { width, height, pixels };
    Ok(EYES.map(|side| seen_coarser(&finest, side)))
}

/// A view whose pixels take `side` x `side` of this one's together, as far as there are so many.
pub fn seen_coarser(view: &Picture, side: usize) -> Picture {
    let (width, height) = (view.width.div_ceil(side), view.height.div_ceil(side));
    let pixel = |at: usize| {
        let (left, top) = (at % width * side, at / width * side);
        let (right, bottom) = ((left + side).min(view.width), (top + side).min(view.height));
        let mut sum = [0.0f32; 4];
        for row in top..bottom {
            for pixel in &view.pixels[row * view.width + left..row * view.width + right] {
                for c in 0..4 {
                    sum[c] += pixel[c];
                }
            }
        }
        sum.map(|sum| sum / ((right - left) * (bottom - top)) as f32)
    };
    Picture { width, height, pixels: (0..width * height).into_par_iter().map(pixel).collect() }
}

/// How differences from a target count: each eye's squared ones by themselves, all by a weight that goes with the target's light as the
/// coarsest eye sees it. (A weight that went with each pixel's own light would draw what a display's pixel cannot resolve towards its darker half.)
pub(super) struct Eyes {
    width: usize,
    across: usize,
    /// Of each block.
    weights: Vec<Rgb>,
}

impl Eyes {
    pub(super) fn new(target: &[Rgb], width: usize, weights: &Weights) -> Self {
        let across = width.div_ceil(BLOCK);
        let of_strip = |strip: &[Rgb]| -> Vec<Rgb> {
            let rows = strip.len() / width;
            (0..across)
                .map(|block| weights.at(mean(strip, width, 0..rows, columns(block, width))))
                .collect()
        };
        let strips: Vec<Vec<Rgb>> = target.par_chunks(BLOCK * width).map(of_strip).collect();
        Self { width, across, weights: strips.into_iter().flatten().collect() }
    }

    /// The weight of a view pixel.
    #[inline]
    pub(super) fn weight(&self, pixel: usize) -> Rgb {
        let (column, row) = (pixel % self.width, pixel / self.width);
        self.weights[row / BLOCK * self.across + column / BLOCK]
    }

    /// Makes of a view what the sum of the eyes' weighted squares goes with: half its gradient. Returns that sum: per channel.
    pub(super) fn weigh(&self, view: &mut [Rgb]) -> [f64; 3] {
        let strips =
            view.par_chunks_mut(BLOCK * self.width).zip(self.weights.par_chunks(self.across));
        let sums: Vec<[f64; 3]> = strips
            .map(|(strip, weights)| {
                let mut sum = [0.0; 3];
                for (block, weight) in weights.iter().enumerate() {
                    self.block(strip, block, |value, quarter, whole| {
                        for c in 0..3 {
                            let eyes = (value[c] + quarter[c] + whole[c]) * (1.0 / 3.0);
                            let weighed = weight[c] * eyes;
                            sum[c] += f64::from(weighed) * f64::from(value[c]);
                            value[c] = weighed;
                        }
                    });
                }
                sum
            })
            .collect();
        // In order, so that the result does not depend on the threads.
        sums.iter().fold([0.0; 3], |sum, part| std::array::from_fn(|c| sum[c] + part[c]))
    }

    /// The sum of weighted squares of all channels for each eye.
    pub(super) fn errors(&self, mut view: Vec<Rgb>) -> [f64; 3] {
        let strips =
            view.par_chunks_mut(BLOCK * self.width).zip(self.weights.par_chunks(self.across));
        let sums: Vec<[f64; 3]> = strips
            .map(|(strip, weights)| {
                let mut sum = [0.0; 3];
                for (block, weight) in weights.iter().enumerate() {
                    self.block(strip, block, |value, quarter, whole| {
                        for c in 0..3 {
                            for (sum, x) in sum.iter_mut().zip([value[c], quarter[c], whole[c]]) {
                                *sum += f64::from(weight[c]) * f64::from(x).powi(2);
                            }
                        }
                    });
                }
                sum
            })
            .collect();
        sums.iter().fold([0.0; 3], |sum, part| std::array::from_fn(|c| sum[c] + part[c]))
    }

    /// Calls with each pixel of a block, the mean about it that the middle eye sees, and the whole block's.
    #[inline]
    fn block(&self, strip: &mut [Rgb], block: usize, mut with: impl FnMut(&mut Rgb, Rgb, Rgb)) {
        const HALF: usize = EYES[1];
        let (width, rows) = (self.width, strip.len() / self.width);
        let columns = columns(block, width);
        let whole = mean(strip, width, 0..rows, columns.clone());
        for top in (0..rows).step_by(HALF) {
            for left in columns.clone().step_by(HALF) {
                let (below, beside) = ((top + HALF).min(rows), (left + HALF).min(columns.end));
                let quarter = mean(strip, width, top..below, left..beside);
                for row in top..below {
                    for value in &mut strip[row * width + left..row * width + beside] {
                        with(value, quarter, whole);
                    }
                }
            }
        }
    }
}

fn columns(block: usize, width: usize) -> std::ops::Range<usize> {
    block * BLOCK..((block + 1) * BLOCK).min(width)
}

#[inline]
fn mean(
    strip: &[Rgb],
    width: usize,
    rows: std::ops::Range<usize>,
    columns: std::ops::Range<usize>,
) -> Rgb {
    let scale = 1.0 / (rows.len() * columns.len()) as f32;
    let mut sum = [0.0f32; 3];
    for row in rows {
        for value in &strip[row * width + columns.start..row * width + columns.end] {
            for c in 0..3 {
                sum[c] += value[c];
            }
        }
    }
    sum.map(|sum| sum * scale)
}

#[cfg(test)]
mod tests {
    use super::super::Weighting;
    use super::*;

    /// A view of 7 x 9 pixels, so that blocks at two edges are cut: by the definition, eye by eye.
    #[test]
    fn the_eyes_squares_add_up_and_their_gradient_is_a_difference_quotient() {
        let (width, height) = (7, 9);
        let mut random = fastrand::Rng::with_seed(3);
        let mut noise = || -> Vec<Rgb> {
            (0..width * height).map(|_| [random.f32(), random.f32(), random.f32()]).collect()
        };
        let (target, view) = (noise(), noise());
        let eyes = Eyes::new(&target, width, &Weights::new(Weighting::Encoded));
        let picture = |values: &[Rgb]| Picture {
            width,
            height,
            pixels: values.iter().map(|v| [v[0], v[1], v[2], 1.0]).collect(),
        };
        let by_definition = |view: &[Rgb]| -> [f64; 3] {
            let mut sum = [0.0; 3];
            for (eye, side) in EYES.into_iter().enumerate() {
                let seen = seen_coarser(&picture(view), side);
                let local = seen_coarser(&picture(&target), 4);
                for (at, value) in seen.pixels.iter().enumerate() {
                    let (column, row) = (at % seen.width * side, at / seen.width * side);
                    let count =
                        ((column + side).min(width) - column) * ((row + side).min(height) - row);
                    let light = local.pixels[row / 4 * local.width + column / 4];
                    for c in 0..3 {
                        let weight =
                            crate::picture::srgb::encode_slope(f64::from(light[c])).powi(2);
                        // Each eye's pixel counts as the area that it sees.
                        sum[eye] += weight * f64::from(value[c]).powi(2) * count as f64;
                    }
                }
            }
            sum
        };
        let expected = by_definition(&view);
        for (found, expected) in eyes.errors(view.clone()).into_iter().zip(expected) {
            // Weights are tabulated in steps of 1 / 4095: their slope is below a thousand there.
            assert!((found / expected - 1.0).abs() < 5e-3, "{found} {expected}");
        }
        let mut gradient = view.clone();
        let sum: f64 = eyes.weigh(&mut gradient).iter().sum();
        let mean: f64 = eyes.errors(view.clone()).iter().sum::<f64>() / 3.0;
        assert!((sum / mean - 1.0).abs() < 1e-5, "{sum} {mean}");
        for at in [0, 10, 33, 62] {
            let objective = |by: f32| {
                let mut moved = view.clone();
                moved[at][1] += by;
                eyes.errors(moved).iter().sum::<f64>() / 3.0
            };
            let slope = (objective(0.25) - objective(-0.25)) / 0.5;
            // The objective is a square: the central difference is exact but for single precision.
            assert!((2.0 * f64::from(gradient[at][1]) / slope - 1.0).abs() < 1e-3, "{at}");
        }
    }

    #[test]
    fn coarser_views_are_means() {
        let pixels = (0..15).map(|i| [i as f32, 1.0, 0.0, 1.0]).collect();
        let view = Picture { width: 5, height: 3, pixels };
        let seen = seen_coarser(&view, 2);
        assert_eq!((seen.width, seen.height), (3, 2));
        // (0 + 1 + 5 + 6) / 4, and the cut ones: (4 + 9) / 2 and (10 + 11) / 2.
        assert_eq!([seen.pixels[0][0], seen.pixels[2][0], seen.pixels[3][0]], [3.0, 6.5, 10.5]);
    }
}
