//! What is sent to a display so that it emits a picture's light, and the other way.

use super::{Picture, srgb};
use crate::optics::screen::Screen;
use rayon::prelude::*;

/// A picture made for a display.
#[derive(Clone, Debug, PartialEq)]
pub struct Driven {
    /// The picture whose sRGB codes, as image files have them, are the display's codes.
    pub picture: Picture,
    /// Share of the samples (opaque pixels times colours) that are darker than the display's black, so that it shows more than
    /// they ask for.
    pub too_dark: f64,
}

/// The picture to be sent to a display so that it emits this one's light. Pictures are encoded as sRGB where they are written;
/// here light is changed so that the codes written are the display's own.
pub fn drive(light: &Picture, screen: &Screen) -> Driven {
    let darker = |pixel: &[f32; 4]| {
        // Without an answer a pixel asks for nothing.
        (0..3).filter(|&c| pixel[3] > 0.0 && f64::from(pixel[c]) < screen.black[c]).count()
    };
    let answered = light.pixels.iter().filter(|pixel| pixel[3] > 0.0).count();
    let too_dark: usize = light.pixels.iter().map(darker).sum();
    let code = |c: usize, light: f32| srgb::decode(screen.code(c, f64::from(light))) as f32;
    Driven {
        picture: mapped(light, code),
        too_dark: too_dark as f64 / (3 * answered).max(1) as f64,
    }
}

/// The light that a display emits while it is sent a picture: the inverse of [`drive`].
pub fn emitted(picture: &Picture, screen: &Screen) -> Picture {
    mapped(picture, |c, value| {
        let code = srgb::encode(f64::from(value).clamp(0.0, 1.0));
        screen.light(c, code) as f32
    })
}

fn mapped(picture: &Picture, colour: impl Fn(usize, f32) -> f32 + Sync) -> Picture {
    let of_pixel = |&[r, g, b, a]: &[f32; 4]| [colour(0, r), colour(1, g), colour(2, b), a];
    let pixels = picture.pixels.par_iter().map(of_pixel).collect();
    Picture { width: picture.width, height: picture.height, pixels }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::optics::screen::Response;

    fn ramp() -> Picture {
        let pixels = (0..64).map(|i| [i as f32 / 63.0, 0.5, (63 - i) as f32 / 63.0, 1.0]).collect();
        Picture { width: 64, height: 1, pixels }
    }

    #[test]
    fn the_display_emits_what_was_asked_for() {
        let screen =
            Screen { response: Response::Gamma(1.8), black: [0.01, 0.02, 0.0], bits: None };
        let driven = drive(&ramp(), &screen);
        let shown = emitted(&driven.picture, &screen);
        for (asked, shown) in ramp().pixels.iter().zip(&shown.pixels) {
            for c in 0..3 {
                let possible = asked[c].max(screen.black[c] as f32);
                // Single precision through two curves that are steep near black.
                assert!((shown[c] - possible).abs() < 1e-5, "{asked:?} {shown:?}");
            }
        }
        // Red 0 of 64 lies below 0.01, of green and blue none.
        assert!((driven.too_dark - 1.0 / 192.0).abs() < 1e-12);
    }

    #[test]
    fn a_plain_display_is_sent_the_picture_itself() {
        let driven = drive(&ramp(), &Screen::default());
        for (a, b) in driven.picture.pixels.iter().zip(&ramp().pixels) {
            assert!((0..4).all(|c| (a[c] - b[c]).abs() < 1e-6));
        }
        assert_eq!(driven.too_dark, 0.0);
    }
}
