//! A white field through the set-up, with and without the gain divided out.

use super::{coarse, shows};
use crate::map::{Accuracy, Gain, Map, invert};
use crate::picture::{Evened, Overflow, Picture, display_image, even_out};
use crate::simulate::{faded_view, gain};
use crate::transport::Setup;

/// How even a white field is.
#[derive(Clone, Debug, PartialEq)]
pub struct Evenness {
    /// The gain of each display pixel.
    pub gain: Gain,
    /// Largest over smallest light of a white field seen with the display white: the worst of the three colours; NaN where nothing is formed.
    pub plain: f64,
    /// The same with the gain divided out so that nothing clips (`fit`).
    pub even: f64,
    /// How bright white is then, over the display's white.
    pub fit_level: f64,
    /// The same as `clip` has it, which clips a little.
    pub clip_level: f64,
    /// Share of the samples that `clip` clips.
    pub clipped: f64,
    /// The white field as it is seen, before and after; linear light, over the display's white. Transparent where nothing is formed.
    pub views: [Picture; 2],
}

/// Display pixels along a side.
const PIXELS: usize = 256;

/// Looks at a white field through the set-up, in views of `size` pixels. The figures are over the places whose light comes from
/// ok pixels alone: none of the image's edge, and no folds.
pub fn evenness(setup: &Setup, size: [usize; 2]) -> Evenness {
    let setup = coarse(setup.clone(), PIXELS);
    let map: Map = invert(&setup, Accuracy::default()).0;
    let gain = gain(&setup, &map);
    let white = display_image(&Picture::filled(1, 1, [1.0; 4]), &map);
    let fit: Evened = even_out(&white, &gain, Overflow::Fit);
    let clip: Evened = even_out(&white, &gain, Overflow::Clip);
    // Half a display pixel is what interpolation may miss where the map bends.
    let slack = 0.5 / PIXELS as f64;
    let seen =
        |display: &Picture| faded_view(&setup, display, size, |uv, st| shows(&map, st, uv, slack));
    let views = [seen(&white), seen(&fit.display)];
    let [plain, even] = views.each_ref().map(largest_over_smallest);
    Evenness {
        gain,
        plain,
        even,
        fit_level: fit.level,
        clip_level: clip.level,
        clipped: clip.clipped,
        views,
    }
}

/// Of the opaque pixels, the worst colour's; NaN without any.
fn largest_over_smallest(view: &Picture) -> f64 {
    let of_colour = |c: usize| {
        let lit =
            view.pixels.iter().filter(|pixel| pixel[3] > 0.0).map(|pixel| f64::from(pixel[c]));
        let (least, most) = lit.fold((f64::INFINITY, 0.0f64), |(least, most), value| {
            (least.min(value), most.max(value))
        });
        if least.is_finite() { most / least } else { f64::NAN }
    };
    // NaN in one colour is NaN in all: what is formed does not depend on it.
    [0, 1, 2].map(of_colour).into_iter().fold(f64::NAN, f64::max)
}
