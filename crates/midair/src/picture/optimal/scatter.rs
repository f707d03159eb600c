//! The paper's way: what the view's rays see of the image lands on the display.

use super::{OptimalError, ViewSamples};
use crate::picture::Picture;
use crate::picture::interpolate::bilinear_taps;

/// The averaged scatter, the baseline that [`optimal_display`](super::optimal_display) is measured
/// against: each ray carries the target's colour at its view pixel to where it ends on the
/// display, spread bilinearly over four pixels; a display pixel is the weighted mean of what
/// arrives, and black where nothing does (alpha 0 there, 1 elsewhere). Linear light.
///
/// # Errors
/// [`OptimalError::Size`] where the sizes disagree or anything is empty.
pub fn scatter_average(
    samples: &ViewSamples,
    target: &Picture,
    width: usize,
    height: usize,
) -> Result<Picture, OptimalError> {
    let mut display = Picture::filled(width, height, [0.0; 4]);
    super::check_sizes(samples, target, &display)?;
    let mut total = vec![0.0f32; width * height];
    for (rays, colour) in samples.st.chunks_exact(samples.each).zip(&target.pixels) {
        for &st in rays {
            for (pixel, weight) in bilinear_taps(st, width, height).into_iter().flatten() {
                let pixel = pixel as usize;
                total[pixel] += weight;
                for c in 0..3 {
                    display.pixels[pixel][c] += weight * colour[c];
                }
            }
        }
    }
    for (pixel, total) in display.pixels.iter_mut().zip(total) {
        if total > 0.0 {
            *pixel = [pixel[0] / total, pixel[1] / total, pixel[2] / total, 1.0];
        }
    }
    Ok(display)
}
