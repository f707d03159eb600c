//! The gain: what the simulator finds on the average, for the one path of each display pixel, in closed form.

use super::Plate;
use crate::map::{Gain, Map, pixel_centre};
use crate::media::Picture;
use crate::transport::{Path, Setup};
use rayon::prelude::*;

/// What is left of each display pixel's light at the viewpoint, along the path that the map compensates: Fresnel's losses,
/// absorption, the mirrors' and the plate's. Radiance goes by the same factors (both ends are in air), so this is the luminance of
/// the mid-air image over the display's along its normal: what a measured display emits less aslant is part of it.
///
/// Light that reflections bring besides is left out: it is what the viewer sees as reflections.
pub fn gain(setup: &Setup, plate: &Plate, map: &Map) -> Gain {
    let of_pixel = |path: &mut Path, uv: [f64; 2]| -> Option<[f32; 3]> {
        // NaN: no answer.
        if uv.iter().any(|c| !c.is_finite()) {
            return None;
        }
        Some(arriving(setup, plate, uv, path)?.1.map(|share| share as f32))
    };
    let rgb = map
        .uv
        .par_iter()
        .map_init(Path::new, |path, &uv| of_pixel(path, uv).unwrap_or([f32::NAN; 3]))
        .collect();
    Gain { width: map.width, height: map.height, rgb }
}

/// Where on the display the viewer looks who looks at an image point, and which share of the light from there arrives.
fn arriving(
    setup: &Setup,
    plate: &Plate,
    uv: [f64; 2],
    path: &mut Path,
) -> Option<([f64; 2], [f64; 3])> {
    let st = setup.transport(uv, path).st()?;
    let left = setup.remainder(setup.ray(uv), path)?;
    let real = plate.real_share(setup.plate.frame.to_local_direction(-left.at_plate.direction));
    let emitted = setup.emitted_against(left.at_display);
    Some((st, [0, 1, 2].map(|c| left.share[c] * real[c] * emitted[c])))
}

/// The view of a display with its losses, in closed form: one line of sight through each pixel of a view of the image. Transparent black
/// where nothing is formed or `shown`, of an image point uv and its display place st, is false.
pub fn faded_view(
    setup: &Setup,
    plate: &Plate,
    display: &Picture,
    [width, height]: [usize; 2],
    shown: impl Fn([f64; 2], [f64; 2]) -> bool + Sync,
) -> Picture {
    let of_pixel = |path: &mut Path, index: usize| -> Option<[f32; 4]> {
        let uv = pixel_centre(index % width, index / width, width, height);
        let (st, share) = arriving(setup, plate, uv, path)?;
        if !shown(uv, st) {
            return None;
        }
        let [r, g, b, _] = display.emitted(st)?;
        let [r, g, b] = [r * share[0] as f32, g * share[1] as f32, b * share[2] as f32];
        Some([r, g, b, 1.0])
    };
    let pixels = (0..width * height)
        .into_par_iter()
        .map_init(Path::new, |path, index| of_pixel(path, index).unwrap_or_default())
        .collect();
    Picture { width, height, pixels }
}
