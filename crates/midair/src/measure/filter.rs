//! Separable filters with mirrored borders.

use rayon::prelude::*;

use super::Plane;

/// Row-major double-precision samples, the filters' working form.
#[derive(Clone, Debug)]
pub(super) struct Samples {
    pub width: usize,
    pub height: usize,
    pub values: Vec<f64>,
}

impl From<&Plane> for Samples {
    fn from(plane: &Plane) -> Self {
        let values = plane.values.iter().map(|&value| f64::from(value)).collect();
        Self { width: plane.width, height: plane.height, values }
    }
}

impl Samples {
    /// The samples convolved with a symmetric kernel of odd length along rows and columns.
    ///
    /// Beyond the border the picture is mirrored about the border itself (d c b a | a b c d),
    /// scipy's mode "reflect".
    pub fn filtered(&self, kernel: &[f64]) -> Self {
        Self::filtered_of(self.width, self.height, |index| self.values[index], kernel)
    }

    /// As [`Self::filtered`], of samples that are worked out when they are needed, by index.
    pub fn filtered_of(
        width: usize,
        height: usize,
        sample: impl Fn(usize) -> f64 + Sync,
        kernel: &[f64],
    ) -> Self {
        if width * height == 0 {
            return Self { width, height, values: Vec::new() };
        }
        let radius = kernel.len() / 2;
        let mut rows = vec![0.0; width * height];
        rows.par_chunks_mut(width).enumerate().for_each_init(
            || vec![0.0; width + 2 * radius],
            |padded, (row, out)| {
                for (at, value) in padded.iter_mut().enumerate() {
                    *value = sample(row * width + mirrored(at as isize - radius as isize, width));
                }
                for (tap, &weight) in kernel.iter().enumerate() {
                    accumulate(out, &padded[tap..], weight);
                }
            },
        );
        let mut values = vec![0.0; width * height];
        values.par_chunks_mut(width).enumerate().for_each(|(at, out)| {
            for (tap, &weight) in kernel.iter().enumerate() {
                let from = mirrored(at as isize + tap as isize - radius as isize, height);
                accumulate(out, &rows[from * width..], weight);
            }
        });
        Self { width, height, values }
    }

    /// The samples blurred by a Gaussian of `sigma` pixels.
    pub fn blurred(&self, sigma: f64) -> Self {
        self.filtered(&gaussian_kernel(sigma))
    }
}

fn accumulate(out: &mut [f64], samples: &[f64], weight: f64) {
    for (sum, sample) in out.iter_mut().zip(samples) {
        *sum += weight * sample;
    }
}

/// The index that `at` falls on when the samples are mirrored about their borders, as often as needed.
fn mirrored(at: isize, length: usize) -> usize {
    let folded = at.rem_euclid(2 * length as isize) as usize;
    folded.min(2 * length - 1 - folded)
}

/// A normalised Gaussian, cut at 3.5 sigma as scikit-image's SSIM cuts it (11 taps at 1.5).
pub(super) fn gaussian_kernel(sigma: f64) -> Vec<f64> {
    if sigma.is_nan() || sigma <= 0.0 {
        return vec![1.0];
    }
    let radius = (3.5 * sigma + 0.5).floor() as isize;
    let mut kernel: Vec<f64> =
        (-radius..=radius).map(|at| (-0.5 * (at as f64 / sigma).powi(2)).exp()).collect();
    let sum: f64 = kernel.iter().sum();
    kernel.iter_mut().for_each(|weight| *weight /= sum);
    kernel
}

fn plane(samples: Samples) -> Plane {
    let values = samples.values.into_iter().map(|value| value as f32).collect();
    Plane { width: samples.width, height: samples.height, values }
}

/// The plane blurred by a Gaussian of `sigma` pixels (cut at 3.5 sigma, borders mirrored).
pub fn gaussian_blur(picture: &Plane, sigma: f64) -> Plane {
    plane(Samples::from(picture).blurred(sigma))
}

/// The plane's mean over 5 x 5 pixels, borders mirrored: the blur under which the paper compares
/// its views a second time.
pub fn box_blur5(picture: &Plane) -> Plane {
    plane(Samples::from(picture).filtered(&[0.2; 5]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mirrors_about_the_border_even_far_beyond() {
        let at: Vec<usize> = (-7..10).map(|at| mirrored(at, 3)).collect();
        assert_eq!(at, [0, 0, 1, 2, 2, 1, 0, 0, 1, 2, 2, 1, 0, 0, 1, 2, 2]);
        assert_eq!(mirrored(-5, 1), 0);
    }

    #[test]
    fn a_kernel_of_ones_and_a_fifth_is_the_mean_of_twenty_five() {
        let picture = Plane::from_fn(9, 7, |c, r| ((c * 7 + r * 13) % 11) as f32 / 11.0);
        let blurred = box_blur5(&picture);
        for row in 0..7 {
            for column in 0..9 {
                let mut sum = 0.0;
                for down in -2..=2_isize {
                    for right in -2..=2_isize {
                        let fold = |at: isize, last: isize| match at {
                            at if at < 0 => -1 - at,
                            at if at > last => 2 * last + 1 - at,
                            at => at,
                        };
                        let c = fold(column as isize + right, 8);
                        let r = fold(row as isize + down, 6);
                        sum += picture.at(c as usize, r as usize);
                    }
                }
                // Single precision sums of 25 values below one.
                assert!((blurred.at(column, row) - sum / 25.0).abs() < 1e-6);
            }
        }
    }

    #[test]
    fn two_gaussians_in_a_row_add_their_variances() {
        let mut point = Samples { width: 61, height: 61, values: vec![0.0; 61 * 61] };
        point.values[30 * 61 + 30] = 1.0;
        let (once, twice) = (point.blurred(5.0), point.blurred(3.0).blurred(4.0));
        for (a, b) in once.values.iter().zip(&twice.values) {
            // The peak is 6e-3; cutting each kernel at 3.5 sigma leaves out 5e-4 of the weight.
            assert!((a - b).abs() < 1e-5, "{a} {b}");
        }
    }

    #[test]
    fn the_structural_similarity_kernel_has_eleven_taps() {
        assert_eq!(gaussian_kernel(1.5).len(), 11);
        assert_eq!(gaussian_kernel(0.0), [1.0]);
    }
}
