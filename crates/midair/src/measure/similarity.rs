//! How alike two pictures are: SSIM, its blurred form, PSNR.

use rayon::prelude::*;

use super::filter::{Samples, gaussian_kernel};
use super::{Plane, box_blur5};

/// The range L of the values that are compared: planes run from black 0 to white 1.
const RANGE: f64 = 1.0;
/// Wang et al. 2004, K1.
const K1: f64 = 0.01;
/// Wang et al. 2004, K2.
const K2: f64 = 0.03;
/// Wang et al. 2004: the window is an 11 x 11 Gaussian of standard deviation 1.5 pixels.
const SIGMA: f64 = 1.5;
const WINDOW: usize = 11;

/// What [`ssim`] found.
#[derive(Clone, Debug, PartialEq)]
pub struct Similarity {
    /// Mean of the map over the pixels whose whole window lies inside the picture.
    pub mean: f64,
    /// SSIM at each pixel; near the border the window sees the mirrored picture.
    pub map: Plane,
}

/// Why two pictures cannot be compared.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SimilarityError {
    /// The sizes differ.
    #[error(
        "the pictures differ in size ({first_width} x {first_height} and \
         {second_width} x {second_height} pixels): render or crop them to one size"
    )]
    SizesDiffer {
        /// Width of the first picture.
        first_width: usize,
        /// Height of the first picture.
        first_height: usize,
        /// Width of the second picture.
        second_width: usize,
        /// Height of the second picture.
        second_height: usize,
    },
    /// The window does not fit.
    #[error(
        "a picture of {width} x {height} pixels is too small: at least {WINDOW} x {WINDOW} are needed"
    )]
    TooSmall {
        /// Width of both pictures.
        width: usize,
        /// Height of both pictures.
        height: usize,
    },
    /// A value is NaN or infinite.
    #[error("a picture holds a value that is not a number, first at column {column}, row {row}")]
    NotFinite {
        /// Column of the first such pixel.
        column: usize,
        /// Row of the first such pixel, from the top.
        row: usize,
    },
}

/// Structural similarity (Wang, Bovik, Sheikh and Simoncelli 2004, equation 13), values in \[0, 1\].
///
/// An 11 x 11 Gaussian window of sigma 1.5, K1 = 0.01, K2 = 0.03, variances of the population:
/// scikit-image's `structural_similarity(gaussian_weights=True, sigma=1.5,
/// use_sample_covariance=False, data_range=1)`.
///
/// # Errors
/// When the sizes differ, are below 11 x 11, or a value is not finite.
pub fn ssim(first: &Plane, second: &Plane) -> Result<Similarity, SimilarityError> {
    comparable(first, second)?;
    Ok(compared(first, &Means::of(first)?, second, &Means::of(second)?))
}

/// What SSIM's window finds in one plane: its weighted means of the values and of their squares, at each pixel.
struct Means {
    values: Vec<f64>,
    squares: Vec<f64>,
}

impl Means {
    fn of(plane: &Plane) -> Result<Self, SimilarityError> {
        if plane.width < WINDOW || plane.height < WINDOW {
            return Err(SimilarityError::TooSmall { width: plane.width, height: plane.height });
        }
        let at = |i: usize| f64::from(plane.values[i]);
        Ok(Self { values: weighted(plane, at), squares: weighted(plane, |i| at(i) * at(i)) })
    }
}

/// The window's weighted means of a value of each of a plane's indices.
fn weighted(plane: &Plane, value: impl Fn(usize) -> f64 + Sync) -> Vec<f64> {
    Samples::filtered_of(plane.width, plane.height, value, &gaussian_kernel(SIGMA)).values
}

/// A plane that several others are compared with: what SSIM needs of it alone is found once.
pub(crate) struct Standard {
    plane: Plane,
    means: Means,
}

impl Standard {
    /// # Errors
    /// Where the plane is below 11 x 11, or a value is not finite.
    pub(crate) fn new(plane: Plane) -> Result<Self, SimilarityError> {
        comparable(&plane, &plane)?;
        let means = Means::of(&plane)?;
        Ok(Self { plane, means })
    }

    pub(crate) fn plane(&self) -> &Plane {
        &self.plane
    }

    /// [`ssim`] of another plane and this one.
    ///
    /// # Errors
    /// As [`ssim`].
    pub(crate) fn ssim(&self, other: &Plane) -> Result<Similarity, SimilarityError> {
        comparable(other, &self.plane)?;
        Ok(compared(other, &Means::of(other)?, &self.plane, &self.means))
    }
}

/// SSIM of two planes of one size, with the window's means in each.
fn compared(first: &Plane, x: &Means, second: &Plane, y: &Means) -> Similarity {
    let product = |i: usize| f64::from(first.values[i]) * f64::from(second.values[i]);
    let xy = weighted(first, product);
    let (c1, c2) = ((K1 * RANGE).powi(2), (K2 * RANGE).powi(2));
    let at = |i: usize| {
        let (mean_x, mean_y) = (x.values[i], y.values[i]);
        let variances = x.squares[i] - mean_x * mean_x + y.squares[i] - mean_y * mean_y;
        let covariance = xy[i] - mean_x * mean_y;
        (2.0 * mean_x * mean_y + c1) * (2.0 * covariance + c2)
            / ((mean_x * mean_x + mean_y * mean_y + c1) * (variances + c2))
    };
    let map: Vec<f64> = (0..xy.len()).into_par_iter().map(at).collect();

    let (width, height, border) = (first.width, first.height, WINDOW / 2);
    let inner = (width - 2 * border) * (height - 2 * border);
    let sum: f64 = (border..height - border)
        .map(|row| map[row * width + border..(row + 1) * width - border].iter().sum::<f64>())
        .sum();
    let values = map.into_iter().map(|value| value as f32).collect();
    Similarity { mean: sum / inner as f64, map: Plane { width, height, values } }
}

/// The mean of [`ssim`] over colour channels, as scikit-image's `channel_axis` gives it.
///
/// # Errors
/// As [`ssim`], for any channel.
pub fn ssim_over_channels(first: &[Plane; 3], second: &[Plane; 3]) -> Result<f64, SimilarityError> {
    let mut sum = 0.0;
    for (a, b) in first.iter().zip(second) {
        sum += ssim(a, b)?.mean;
    }
    Ok(sum / 3.0)
}

/// [`ssim_over_channels`] after [`box_blur5`] of every channel of both pictures: the paper's
/// second comparison, which forgives the plate's blur.
///
/// # Errors
/// As [`ssim`], for any channel.
pub fn blurred_ssim(first: &[Plane; 3], second: &[Plane; 3]) -> Result<f64, SimilarityError> {
    let blurred = |planes: &[Plane; 3]| planes.each_ref().map(box_blur5);
    ssim_over_channels(&blurred(first), &blurred(second))
}

/// Peak signal-to-noise ratio in dB over all the planes together (10 log10 of 1 / mean squared
/// difference); infinite when they are equal.
///
/// # Errors
/// When sizes differ or a value is not finite.
pub fn psnr(first: &[Plane], second: &[Plane]) -> Result<f64, SimilarityError> {
    let (mut sum, mut count) = (0.0, 0_usize);
    for (a, b) in first.iter().zip(second) {
        comparable(a, b)?;
        sum += a.values.iter().zip(&b.values).map(|(a, b)| f64::from(a - b).powi(2)).sum::<f64>();
        count += a.values.len();
    }
    Ok(-10.0 * (sum / (count.max(1) as f64 * RANGE * RANGE)).log10())
}

fn comparable(first: &Plane, second: &Plane) -> Result<(), SimilarityError> {
    if (first.width, first.height) != (second.width, second.height) {
        return Err(SimilarityError::SizesDiffer {
            first_width: first.width,
            first_height: first.height,
            second_width: second.width,
            second_height: second.height,
        });
    }
    let bad = |plane: &Plane| plane.values.iter().position(|value| !value.is_finite());
    match bad(first).or_else(|| bad(second)) {
        Some(at) => {
            Err(SimilarityError::NotFinite { column: at % first.width, row: at / first.width })
        }
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use std::io::Write;
    use std::process::{Command, Stdio};

    use proptest::prelude::*;

    use super::*;

    /// The tests' pictures: k-th channel of a chirp, and of the same darkened under a sawtooth.
    fn chirp(width: usize, height: usize, k: usize) -> Plane {
        Plane::from_fn(width, height, |c, r| chirp_value(c, r, k) as f32 / 255.0)
    }

    fn chirp_value(c: usize, r: usize, k: usize) -> usize {
        (3 * c * c + 7 * c * r + 5 * r * r + 31 * k * c) / 8 % 256
    }

    fn altered(width: usize, height: usize, k: usize) -> Plane {
        Plane::from_fn(width, height, |c, r| {
            let value = chirp_value(c, r, k) * 3 / 4 + (11 * c + 17 * r + 5 * k) % 64;
            value.min(255) as f32 / 255.0
        })
    }

    /// scikit-image 0.26 on these pictures: size, mean, map at (0, 0), map at (width / 3,
    /// height / 2), PSNR.
    const FROZEN: [(usize, usize, [f64; 4]); 3] = [
        (64, 48, [0.915_064_680_8, 0.050_915_105_0, 0.925_995_793_9, 19.801_857_573]),
        (37, 51, [0.913_224_148_7, 0.050_915_105_0, 0.974_818_235_6, 19.785_693_585]),
        (11, 11, [0.635_848_061_5, 0.050_915_105_0, 0.488_889_801_5, 19.486_428_354]),
    ];

    #[test]
    fn equals_the_values_that_scikit_image_gave() {
        for (width, height, [mean, corner, inside, noise]) in FROZEN {
            let (a, b) = (chirp(width, height, 0), altered(width, height, 0));
            let found = ssim(&a, &b).unwrap();
            // Both work in double precision; the inputs are rounded to single.
            assert!((found.mean - mean).abs() < 1e-6, "{width} x {height}: {}", found.mean);
            assert!((f64::from(found.map.at(0, 0)) - corner).abs() < 1e-5);
            assert!((f64::from(found.map.at(width / 3, height / 2)) - inside).abs() < 1e-5);
            assert!((psnr(&[a], &[b]).unwrap() - noise).abs() < 1e-5);
        }
        let a = [0, 1, 2].map(|k| chirp(64, 48, k));
        let b = [0, 1, 2].map(|k| altered(64, 48, k));
        assert!((ssim_over_channels(&a, &b).unwrap() - 0.916_537_949_6).abs() < 1e-6);
        assert!((blurred_ssim(&a, &b).unwrap() - 0.965_703_859_9).abs() < 1e-6);
    }

    #[test]
    fn equals_scikit_image() {
        let Some(python) = midair_peers::python() else { return };
        let (a, b) = (chirp(83, 70, 4), altered(83, 70, 5));
        let program = format!(
            "import sys, numpy as np\n\
             from skimage.metrics import structural_similarity as ssim\n\
             a = np.frombuffer(sys.stdin.buffer.read(), '<f4').reshape(2, {}, {}).astype(float)\n\
             print(ssim(a[0], a[1], data_range=1.0, gaussian_weights=True, sigma=1.5,\n\
                        use_sample_covariance=False))",
            a.height, a.width
        );
        let mut child = Command::new(python)
            .args(["-c", &program])
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let bytes: Vec<u8> =
            a.values.iter().chain(&b.values).flat_map(|value| value.to_le_bytes()).collect();
        child.stdin.take().unwrap().write_all(&bytes).unwrap();
        let output = child.wait_with_output().unwrap();
        assert!(output.status.success(), "scikit-image failed: {}", output.status);
        let theirs: f64 = String::from_utf8(output.stdout).unwrap().trim().parse().unwrap();
        let ours = ssim(&a, &b).unwrap().mean;
        // Same doubles in, same formula; only the order of sums differs.
        assert!((ours - theirs).abs() < 1e-9, "{ours} {theirs}");
    }

    #[test]
    fn a_constant_shift_of_flat_pictures_leaves_the_luminance_term() {
        // No variance: SSIM = (2 a b + C1) / (a^2 + b^2 + C1), Wang et al. equation 6.
        let found = ssim(&Plane::filled(20, 20, 0.25), &Plane::filled(20, 20, 0.5)).unwrap();
        let expected = (2.0 * 0.125 + 1e-4) / (0.0625 + 0.25 + 1e-4);
        assert!((found.mean - expected).abs() < 1e-12);
        let noise = psnr(&[Plane::filled(2, 2, 0.25)], &[Plane::filled(2, 2, 0.35)]).unwrap();
        assert!((noise - 20.0).abs() < 1e-5, "a tenth of the range is 20 dB: {noise}");
    }

    #[test]
    fn what_cannot_be_compared_is_said() {
        let plane = |w, h| Plane::filled(w, h, 0.5);
        assert!(matches!(
            ssim(&plane(11, 11), &plane(11, 12)),
            Err(SimilarityError::SizesDiffer { .. })
        ));
        assert!(matches!(
            ssim(&plane(10, 40), &plane(10, 40)),
            Err(SimilarityError::TooSmall { .. })
        ));
        let mut holed = plane(12, 12);
        holed.values[12 * 3 + 5] = f32::NAN;
        let error = Err(SimilarityError::NotFinite { column: 5, row: 3 });
        assert_eq!(ssim(&plane(12, 12), &holed), error);
        assert_eq!(psnr(&[plane(4, 4)], &[plane(4, 4)]), Ok(f64::INFINITY));
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(32))]
        #[test]
        fn is_symmetric_bounded_and_one_only_for_equals(
            values in prop::collection::vec((0.0_f32..1.0, 0.0_f32..1.0), 13 * 12),
        ) {
            let plane = |pick: fn(&(f32, f32)) -> f32| Plane {
                width: 13,
                height: 12,
                values: values.iter().map(pick).collect(),
            };
            let (a, b) = (plane(|v| v.0), plane(|v| v.1));
            let (there, back) = (ssim(&a, &b).unwrap(), ssim(&b, &a).unwrap());
            prop_assert!((there.mean - back.mean).abs() < 1e-12);
            // |SSIM| <= 1 by Cauchy-Schwarz; 1e-6 for the rounding of the map to single.
            prop_assert!(there.map.values.iter().all(|value| value.abs() < 1.0 + 1e-6));
            prop_assert!(there.mean < 0.99);
            prop_assert!((ssim(&a, &a).unwrap().mean - 1.0).abs() < 1e-12);
        }
    }
}
