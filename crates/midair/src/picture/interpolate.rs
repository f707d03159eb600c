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
    // A coordinate that is a pixel's centre but for the rounding of uv to single precision (2^-25 of the picture) is that
    // centre: then the pixel comes back bit for bit.
    // (Truncation is the floor of what is not negative, and needs no call to a library.)
    let nearest = (x + 0.5) as isize;
    let rounding = size as f64 / f64::from(1 << 24);
    let x = if (x - nearest as f64).abs() < rounding { nearest as f64 } else { x };
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

/// The four display pixels around st and their bilinear weights; nothing off the display.
#[inline]
pub(crate) fn bilinear_taps(st: [f64; 2], width: usize, height: usize) -> Option<[(u32, f32); 4]> {
    // Written so that NaN is refused.
    if !((0.0..=1.0).contains(&st[0]) && (0.0..=1.0).contains(&st[1])) {
        return None;
    }
    let x = (st[0] * width as f64 - 0.5).clamp(0.0, (width - 1) as f64);
    let y = ((1.0 - st[1]) * height as f64 - 0.5).clamp(0.0, (height - 1) as f64);
    let (column, row) = (x as usize, y as usize);
    let (fx, fy) = ((x - column as f64) as f32, (y - row as f64) as f32);
    let right = (column + 1).min(width - 1);
    let (line, below) = (row * width, (row + 1).min(height - 1) * width);
    Some([
        ((line + column) as u32, (1.0 - fx) * (1.0 - fy)),
        ((line + right) as u32, fx * (1.0 - fy)),
        ((below + column) as u32, (1.0 - fx) * fy),
        ((below + right) as u32, fx * fy),
    ])
}

impl Picture {
    /// What a display that shows this picture emits at st (right, up, \[0, 1\]): bilinear between the
    /// pixels' centres, the edge going on beyond the outermost; `None` off the display.
    #[inline]
    pub fn emitted(&self, st: [f64; 2]) -> Option<[f32; 4]> {
        let mut sum = [0.0; 4];
        for (pixel, weight) in bilinear_taps(st, self.width, self.height)? {
            let value = &self.pixels[pixel as usize];
            for c in 0..4 {
                sum[c] += weight * value[c];
            }
        }
        Some(sum)
    }
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

    #[test]
    fn a_display_emits_its_pixels_at_their_centres_and_the_mean_between() {
        let mut picture = Picture::filled(2, 2, [0.0, 0.0, 0.0, 1.0]);
        picture.pixels[0] = [1.0, 0.5, 0.25, 1.0];
        // The first pixel is at the top left: s = 1/4, t = 3/4. Powers of two are exact in float.
        assert_eq!(picture.emitted([0.25, 0.75]), Some([1.0, 0.5, 0.25, 1.0]));
        assert_eq!(picture.emitted([0.0, 1.0]), Some([1.0, 0.5, 0.25, 1.0]));
        assert_eq!(picture.emitted([0.5, 0.5]), Some([0.25, 0.125, 0.0625, 1.0]));
        assert_eq!(picture.emitted([0.75, 0.25]), Some([0.0, 0.0, 0.0, 1.0]));
        for off in [[-0.01, 0.5], [0.5, 1.01], [f64::NAN, 0.5]] {
            assert_eq!(picture.emitted(off), None);
        }
    }
}
