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

impl Overflow {
    /// As on the command line and in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Clip => "clip",
            Self::Fit => "fit",
            Self::Soft => "soft",
        }
    }

    /// What a display emits that is to emit `wanted` of its white.
    #[inline(always)]
    pub(super) fn held(self, wanted: f32) -> f32 {
        if self == Self::Soft && wanted > KNEE {
            roll_off(wanted).min(1.0)
        } else {
            wanted.min(1.0)
        }
    }
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

/// A gain made ready to be divided out of one display image after another, at one level: of all pixels that are
/// [drawn](crate::map::Map::drawn), in the ring around the gain's own pixels by the mean of those beside.
#[derive(Clone, Debug, PartialEq)]
pub struct Evening {
    /// What the light of each pixel and colour is multiplied by: level over gain; 1 where there is no answer.
    factors: Vec<[f32; 3]>,
    /// How many pixels have an answer.
    answered: usize,
    level: f64,
    overflow: Overflow,
}

/// Where `Overflow::Soft` begins.
const KNEE: f32 = 0.8;

impl Evening {
    /// The level at which a white image is shown as `overflow` says: that of all pictures of a film, so that none is
    /// brighter than another.
    pub fn for_white(gain: &Gain, overflow: Overflow) -> Self {
        Self::new(gain, overflow, gain.rgb.iter().map(|_| [1.0; 3]))
    }

    /// The level that lets a display image be shown as `overflow` says.
    fn new(gain: &Gain, overflow: Overflow, image: impl Iterator<Item = [f32; 3]>) -> Self {
        let gain = &gain.with_ring();
        let answered = || gain.rgb.iter().filter(|gain| Gain::is_answered(gain));
        let level = match overflow {
            Overflow::Fit => image
                .zip(&gain.rgb)
                .filter(|(_, gain)| Gain::is_answered(gain))
                .flat_map(|(pixel, gain)| {
                    (0..3)
                        .filter(move |&c| pixel[c] > 0.0)
                        .map(move |c| f64::from(gain[c]) / f64::from(pixel[c]))
                })
                .fold(f64::INFINITY, f64::min),
            Overflow::Clip | Overflow::Soft => {
                let mut least: Vec<f32> = answered()
                    .map(|gain| gain.iter().copied().fold(f32::INFINITY, f32::min))
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
        let factor = |gain: &[f32; 3]| match Gain::is_answered(gain) {
            // Finite, so that no light at all times no gain at all is no light.
            true => gain.map(|g| (level / f64::from(g)).min(f64::from(f32::MAX)) as f32),
            false => [1.0; 3],
        };
        let factors = gain.rgb.iter().map(factor).collect();
        Self { factors, answered: answered().count(), level, overflow }
    }

    /// How bright white is in the mid-air image, over the display's white.
    pub fn level(&self) -> f64 {
        self.level
    }

    /// How many pixels it is for.
    pub(super) fn pixels(&self) -> usize {
        self.factors.len()
    }

    /// Divides the gain out of a display image of its size. Returns the share of its samples that the display's white was not bright
    /// enough for.
    pub fn apply(&self, display: &mut Picture) -> f64 {
        let mut clipped = 0usize;
        for (index, pixel) in display.pixels.iter_mut().enumerate().take(self.factors.len()) {
            for c in 0..3 {
                let light = pixel[c].max(0.0);
                // Rounding of the level's own pixel is no clipping.
                clipped += usize::from(self.wanted(index, c, light) > 1.0 + 1e-6);
                pixel[c] = self.emitted(index, c, light);
            }
        }
        clipped as f64 / (3 * self.answered).max(1) as f64
    }

    /// What colour `c` of a pixel would have to emit so that the viewer sees this light at the level; above 1 the display
    /// cannot.
    #[inline(always)]
    fn wanted(&self, pixel: usize, c: usize, light: f32) -> f32 {
        light * self.factors[pixel][c]
    }

    /// What colour `c` of a pixel is to emit, at most 1.
    #[inline(always)]
    pub(super) fn emitted(&self, pixel: usize, c: usize, light: f32) -> f32 {
        self.overflow.held(self.wanted(pixel, c, light))
    }
}

/// Divides the gain out of a display image, so that the mid-air image shows the picture with one brightness all over: the viewer sees
/// `level` times the picture. Linear light; alpha is kept, and pixels without an answer stay.
pub fn even_out(display: &Picture, gain: &Gain, overflow: Overflow) -> Evened {
    let colours = display.pixels.iter().map(|&[r, g, b, _]| [r, g, b]);
    let evening = Evening::new(gain, overflow, colours);
    let mut display = display.clone();
    let clipped = evening.apply(&mut display);
    Evened { display, level: evening.level, clipped }
}

/// From the knee on towards 1, at first with slope 1.
fn roll_off(x: f32) -> f32 {
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
        let nan = [f32::NAN; 3];
        let gain = gain(vec![[0.9, 0.8, 0.9], [0.5, 0.4, 0.5], [0.7, 0.6, 0.7], nan, nan]);
        let picture = grey(&[1.0, 1.0, 0.5, 0.25, 0.25]);
        let evened = even_out(&picture, &gain, Overflow::Fit);
        assert!((evened.level - 0.4).abs() < 1e-7);
        assert_eq!(evened.clipped, 0.0);
        let pairs = evened.display.pixels.iter().zip(&gain.rgb);
        let seen = pairs.map(|(p, g)| f64::from(p[1] * g[1]));
        for (seen, wanted) in seen.zip([0.4, 0.4, 0.2]) {
            // Single precision.
            assert!((seen - wanted).abs() < 1e-6, "{seen:?}");
        }
        // The ring has its neighbour's gain; beyond it nothing is drawn, and nothing changed.
        assert!((f64::from(evened.display.pixels[3][1]) - 0.25 * 0.4 / 0.6).abs() < 1e-6);
        assert_eq!(evened.display.pixels[4], picture.pixels[4]);
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
        // At first with slope 1: the next term, step^2 / 0.4, and single precision (6e-8, twice).
        assert!((roll_off(KNEE + 1e-3) - KNEE - 1e-3).abs() < 3e-6);
    }

    #[test]
    fn a_film_has_one_level_that_white_is_shown_at() {
        let gain = gain(vec![[0.9, 0.8, 0.9], [0.5, 0.4, 0.5], [f32::NAN; 3]]);
        for overflow in [Overflow::Fit, Overflow::Clip, Overflow::Soft] {
            let film = Evening::for_white(&gain, overflow);
            let white = even_out(&grey(&[1.0; 3]), &gain, overflow);
            assert_eq!(film.level(), white.level);
            for (pixel, shown) in white.display.pixels.iter().enumerate() {
                assert_eq!([0, 1, 2].map(|c| film.emitted(pixel, c, 1.0)), shown[..3]);
            }
        }
        // A darker picture alone could be shown brighter; within a film it is not.
        let dim = even_out(&grey(&[0.5; 3]), &gain, Overflow::Fit);
        let film = Evening::for_white(&gain, Overflow::Fit);
        assert!((dim.level - 0.8).abs() < 1e-7 && (film.level() - 0.4).abs() < 1e-7);
        // Half of white is half of what white takes: 0.4 / 0.9 / 2.
        assert!((film.emitted(0, 0, 0.5) - 0.4 / 0.9 / 2.0).abs() < 1e-6);
    }

    #[test]
    fn without_light_nothing_is_divided_by() {
        let evened = even_out(&grey(&[0.0, 0.0]), &gain(vec![[0.0; 3]; 2]), Overflow::Fit);
        assert!(evened.display.pixels.iter().all(|p| p.iter().all(|v| v.is_finite())));
    }
}
