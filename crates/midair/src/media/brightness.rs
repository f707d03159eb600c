//! Dividing the gain out of a display image, within what the display can show.

use super::Picture;
use crate::map::Gain;

/// What is done where the display would have to be brighter than it can.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Overflow {
    /// It shows its brightest: that part of the image stays too dark. The level is such that a white image clips at a tenth
    /// of its pixels.
    Clip,
    /// It does not happen: the image is as bright as its most demanding pixel allows.
    #[default]
    Fit,
    /// The level of `Clip`, but from four fifths of the brightest on the display follows ever more slowly and never quite gets
    /// there: details stay, a little darker than they should be.
    Soft,
}

/// A display image with the gain divided out.
#[derive(Clone, Debug, PartialEq)]
pub struct Evened {
    /// The display image.
    pub display: Picture,
    /// How bright white is in the mid-air image, over the display's white.
    pub level: f64,
    /// Share of the image's samples (pixels times colours) that the display's white was not bright enough for.
    pub clipped: f64,
}

/// Where `Overflow::Soft` begins.
const KNEE: f64 = 0.8;

/// Divides the gain out of a display image, so that the mid-air image shows the picture with one brightness all over: the viewer sees
/// `level` times the picture. Linear light; alpha is kept, and pixels without an answer stay.
pub fn even_out(display: &Picture, gain: &Gain, overflow: Overflow) -> Evened {
    let answered = || {
        display.pixels.iter().zip(&gain.rgb).filter(|(_, gain)| gain.iter().all(|g| g.is_finite()))
    };
    let level = match overflow {
        Overflow::Fit => {
            let allowed = answered().flat_map(|(pixel, gain)| {
                (0..3).filter(|&c| pixel[c] > 0.0).map(|c| f64::from(gain[c]) / f64::from(pixel[c]))
            });
            allowed.fold(f64::INFINITY, f64::min)
        }
        Overflow::Clip | Overflow::Soft => {
            let mut least: Vec<f32> = answered()
                .map(|(_, gain)| gain.iter().copied().fold(f32::INFINITY, f32::min))
                .collect();
            let tenth = least.len() / 10;
            match least.is_empty() {
                true => f64::INFINITY,
                false => f64::from(*least.select_nth_unstable_by(tenth, f32::total_cmp).1),
            }
        }
    };
    // Nothing lit: any level will do.
    let level = if level.is_finite() { level } else { 1.0 };
    let (mut clipped, mut samples) = (0usize, 0usize);
    let pixels = display
        .pixels
        .iter()
        .zip(&gain.rgb)
        .map(|(pixel, gain)| {
            if gain.iter().any(|g| !g.is_finite()) {
                return *pixel;
            }
            let mut out = *pixel;
            for c in 0..3 {
                samples += 1;
                let wanted = level * f64::from(pixel[c]);
                // No light arrives, and none is wanted.
                let emitted = if wanted > 0.0 { wanted / f64::from(gain[c]) } else { 0.0 };
                // Rounding of the level's own pixel is no clipping.
                clipped += usize::from(emitted > 1.0 + 1e-6);
                let emitted = match overflow {
                    Overflow::Soft if emitted > KNEE => roll_off(emitted),
                    _ => emitted,
                };
                out[c] = emitted.min(1.0) as f32;
            }
            out
        })
        .collect();
    Evened {
        display: Picture { width: display.width, height: display.height, pixels },
        level,
        clipped: clipped as f64 / samples.max(1) as f64,
    }
}

/// From the knee on towards 1, at first with slope 1.
fn roll_off(x: f64) -> f64 {
    let room = 1.0 - KNEE;
    KNEE + room * (1.0 - (-(x - KNEE) / room).exp())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn gain(rgb: Vec<[f32; 3]>) -> Gain {
        Gain { width: rgb.len(), height: 1, rgb }
    }

    fn grey(values: &[f32]) -> Picture {
        let pixels = values.iter().map(|&v| [v, v, v, 1.0]).collect();
        Picture { width: values.len(), height: 1, pixels }
    }

    #[test]
    fn fitted_the_image_is_even_and_as_bright_as_can_be() {
        let gain = gain(vec![[0.9, 0.8, 0.9], [0.5, 0.4, 0.5], [0.7, 0.6, 0.7], [f32::NAN; 3]]);
        let picture = grey(&[1.0, 1.0, 0.5, 0.25]);
        let evened = even_out(&picture, &gain, Overflow::Fit);
        assert!((evened.level - 0.4).abs() < 1e-7);
        assert_eq!(evened.clipped, 0.0);
        let pairs = evened.display.pixels.iter().zip(&gain.rgb);
        let seen = pairs.map(|(p, g)| f64::from(p[1] * g[1]));
        for (seen, wanted) in seen.zip([0.4, 0.4, 0.2]) {
            // Single precision.
            assert!((seen - wanted).abs() < 1e-6, "{seen:?}");
        }
        assert_eq!(evened.display.pixels[3], picture.pixels[3]);
    }

    #[test]
    fn what_the_display_cannot_show_is_counted() {
        let mut rgb = vec![[0.8f32; 3]; 20];
        rgb[0] = [0.1; 3];
        let gain = gain(rgb);
        let evened = even_out(&grey(&[1.0; 20]), &gain, Overflow::Clip);
        assert!((evened.level - 0.8).abs() < 1e-7);
        assert!((evened.clipped - 0.05).abs() < 1e-12);
        assert_eq!(evened.display.pixels[0][0], 1.0);
    }

    #[test]
    fn a_soft_shoulder_keeps_order_and_never_clips() {
        let gain = gain((1..=40).map(|i| [0.02 * i as f32; 3]).collect());
        let evened = even_out(&grey(&[0.9; 40]), &gain, Overflow::Soft);
        let shown: Vec<f32> = evened.display.pixels.iter().map(|p| p[0]).collect();
        assert!(shown.windows(2).all(|w| w[0] >= w[1]) && shown[0] <= 1.0, "{shown:?}");
        // Below the knee nothing is changed.
        let last = evened.level * 0.9 / 0.8;
        assert!((f64::from(shown[39]) - last).abs() < 1e-6);
        assert!((roll_off(KNEE + 1e-6) - KNEE - 1e-6).abs() < 1e-11);
    }

    #[test]
    fn without_light_nothing_is_divided_by() {
        let evened = even_out(&grey(&[0.0, 0.0]), &gain(vec![[0.0; 3]; 2]), Overflow::Fit);
        assert!(evened.display.pixels.iter().all(|p| p.iter().all(|v| v.is_finite())));
    }
}
