//! From light to what is sent to the display.

use super::Compensation;
use super::report::{Brightness, GainReport};
use crate::map::Gain;
use crate::picture::{Picture, drive, even_out};

/// A display image, and what was done to it.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Shown {
    /// The picture whose sRGB codes, as image files have them, are the display's codes.
    pub display: Picture,
    /// What became of its brightness.
    pub brightness: Brightness,
}

impl Compensation {
    /// Light as it is sent to the display: the gain divided out where that was asked for, then encoded for the set-up's screen.
    pub fn shown(&self, light: Picture) -> Shown {
        let mut display = light;
        let mut brightness = Brightness::default();
        if let Some((gains, overflow)) = &self.gains {
            let gain = merged(gains);
            let evened = even_out(&display, &gain, *overflow);
            display = evened.display;
            let range = gain.range();
            brightness.gain = Some(GainReport {
                mode: *overflow,
                level: evened.level,
                clipped: evened.clipped,
                least: range.map(|[least, _]| least),
                most: range.map(|[_, most]| most),
            });
        }
        let screen = &self.setup().screen;
        if !screen.is_plain() {
            let driven = drive(&display, screen);
            display = driven.picture;
            brightness.darker_than_black = Some(driven.too_dark);
        }
        Shown { display, brightness }
    }
}

/// Each colour's gain from its own map.
fn merged(gains: &[Gain]) -> Gain {
    let mut all = gains[0].clone();
    for (c, gain) in gains.iter().enumerate().skip(1) {
        for (rgb, other) in all.rgb.iter_mut().zip(&gain.rgb) {
            rgb[c] = other[c];
        }
    }
    all
}
