//! A picture between its pixels.

use super::Picture;

/// A picture with what interpolation needs to know of it once.
pub(crate) struct Sampler<'a> {
    picture: &'a Picture,
    /// The largest value of each channel: interpolation overshoots no further.
    ceiling: [f32; 4],
}

impl<'a> Sampler<'a> {
    pub(crate) fn new(picture: &'a Picture) -> Self {
        let mut ceiling = [0.0f32; 4];
        for pixel in &picture.pixels {
            for c in 0..4 {
                ceiling[c] = ceiling[c].max(pixel[c]);
            }
        }
        Self { picture, ceiling }
    }

    /// The value at pixel coordinates (x right, y down, 0 at the first pixel's centre), by
    /// Catmull-Rom interpolation (Keys 1981, a = -1/2) over 4 x 4 pixels; beyond the edge the
    /// edge goes on. Clamped to 0 and the picture's largest value.
    #[inline]
    pub(crate) fn cubic(&self, x: f64, y: f64) -> [f32; 4] {
        let (column, wx) = cubic_taps(x, self.picture.width);
        let (row, wy) = cubic_taps(y, self.picture.height);
        let (width, height) = (self.picture.width as isize, self.picture.height as isize);
        let mut sum = [0.0f32; 4];
        let pixels = &self.picture.pixels;
        if column >= 1 && column + 2 < width && row >= 1 && row + 2 < height {
            let first = (row - 1) * width + column - 1;
            for j in 0..4 {
                let start = first as usize + j * self.picture.width;
                let line = &pixels[start..start + 4];
                let mut across = [0.0f32; 4];
                for i in 0..4 {
                    for c in 0..4 {
                        across[c] += wx[i] * line[i][c];
                    }
                }
                for c in 0..4 {
                    sum[c] += wy[j] * across[c];
                }
            }
        } else {
            for j in 0..4 {
                let line = (row - 1 + j as isize).clamp(0, height - 1) * width;
                for i in 0..4 {
                    let index = line + (column - 1 + i as isize).clamp(0, width - 1);
                    let weight = wy[j] * wx[i];
                    for c in 0..4 {
                        sum[c] += weight * pixels[index as usize][c];
                    }
                }
            }
        }
        for c in 0..4 {
            sum[c] = sum[c].clamp(0.0, self.ceiling[c]);
        }
        sum
    }
}

/// The pixel below a coordinate (which is held to the picture's outermost centres: beyond them the edge
/// goes on) and the weights of the pixels -1, 0, 1, 2 from it.
#[inline]
fn cubic_taps(x: f64, size: usize) -> (isize, [f32; 4]) {
    let x = x.clamp(0.0, (size - 1) as f64);
    // A coordinate that is a pixel's centre but for the rounding of uv to a double is that centre:
    // then the pixel comes back bit for bit. 1e-9 px is far below a float's step.
    // (Truncation is the floor of what is not negative, and needs no call to a library.)
    let nearest = (x + 0.5) as isize;
    let x = if (x - nearest as f64).abs() < 1e-9 { nearest as f64 } else { x };
    let below = x as isize;
    (below, cubic_weights((x - below as f64) as f32))
}

/// The weights of the pixels -1, 0, 1, 2 from the one below, at the fraction t from it.
#[inline]
pub(crate) fn cubic_weights(t: f32) -> [f32; 4] {
    [
        t * (-0.5 + t * (1.0 - 0.5 * t)),
        1.0 + t * t * (1.5 * t - 2.5),
        t * (0.5 + t * (2.0 - 1.5 * t)),
        t * t * (0.5 * t - 0.5),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn cubic_weights_reproduce_quadratics(x in 1.0f64..8.0) {
            // Keys' kernel has third-order accuracy: 1, x and x^2 are interpolated exactly.
            let (column, weights) = cubic_taps(x, 12);
            for power in 0..3 {
                let sum: f64 = (0..4)
                    .map(|i| f64::from(weights[i]) * ((column + i as isize - 1) as f64).powi(power))
                    .sum();
                // Four products with float weights of size at most 1, values at most 100.
                prop_assert!((sum - x.powi(power)).abs() < 4.0 * 100.0 * 1.2e-7);
            }
        }
    }

    #[test]
    fn a_picture_of_one_pixel_is_constant() {
        let picture = Picture::filled(1, 1, [0.3, 0.2, 0.1, 1.0]);
        let sampler = Sampler::new(&picture);
        for (x, y) in [(0.0, 0.0), (-0.5, 0.5), (0.2, -3.0), (9.0, 9.0)] {
            let value = sampler.cubic(x, y);
            // The weights sum to 1 within a few float roundings.
            assert!((0..4).all(|c| (value[c] - picture.pixels[0][c]).abs() < 1e-6));
        }
    }
}
