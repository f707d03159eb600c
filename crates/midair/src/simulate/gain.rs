//! The gain: what the simulator finds on the average, for the one path of each display pixel, in closed form.

use super::Plate;
use crate::map::{Gain, Map};
use crate::transport::{Path, Setup};
use rayon::prelude::*;

/// What is left of each display pixel's light at the viewpoint, along the path that the map compensates: Fresnel's losses,
/// absorption, the mirrors' and the plate's. Radiance goes by the same factors (both ends are in air), so this is the luminance of
/// the mid-air image over the display's. The display emits alike in all directions (Lambert's law).
///
/// Light that reflections bring besides is left out: it is what the viewer sees as reflections.
pub fn gain(setup: &Setup, plate: &Plate, map: &Map) -> Gain {
    let of_pixel = |path: &mut Path, uv: [f64; 2]| -> Option<[f32; 3]> {
        // NaN: no answer.
        if uv.iter().any(|c| !c.is_finite()) {
            return None;
        }
        setup.transport(uv, path).st()?;
        let left = setup.remainder(setup.ray(uv), path)?;
        let real = plate.real_share(setup.plate.frame.to_local_direction(-left.at_plate.direction));
        Some([0, 1, 2].map(|c| (left.share[c] * real[c]) as f32))
    };
    let rgb = map
        .uv
        .par_iter()
        .map_init(Path::new, |path, &uv| of_pixel(path, uv).unwrap_or([f32::NAN; 3]))
        .collect();
    Gain { width: map.width, height: map.height, rgb }
}
