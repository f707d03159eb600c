//! What a display without compensation shows.

use crate::map::{Map, Status, pixel_centre};
use crate::scene::Loaded;
use crate::scene::model::Material;
use crate::transport::Setup;

/// The map of a display that shows the image as it is: in its true size in the middle of the display, turned about if an
/// odd number of mirrors would show it the wrong way round. With flat mirrors and no solids, and the display where the
/// scene puts it by itself, the viewer sees the image undistorted.
pub fn uncompensated_map(loaded: &Loaded, setup: &Setup) -> Map {
    let [width, height] = setup.resolution;
    let mut map = Map::unanswered(width, height);
    for index in 0..width * height {
        let st = pixel_centre(index % width, index / width, width, height);
        let uv = image_point(loaded, setup, st);
        if uv.iter().all(|c| (0.0..=1.0).contains(c)) {
            map.uv[index] = uv;
            map.status[index] = Status::Ok;
        }
    }
    map
}

/// The display point that shows an image point without compensation.
pub(super) fn shown_at(loaded: &Loaded, setup: &Setup, uv: [f64; 2]) -> [f64; 2] {
    turned(loaded, scaled(uv, setup.image.size, setup.display.size))
}

fn image_point(loaded: &Loaded, setup: &Setup, st: [f64; 2]) -> [f64; 2] {
    scaled(turned(loaded, st), setup.display.size, setup.image.size)
}

fn scaled(at: [f64; 2], from: [f64; 2], to: [f64; 2]) -> [f64; 2] {
    std::array::from_fn(|axis| (at[axis] - 0.5) * from[axis] / to[axis] + 0.5)
}

/// A display is never a mirror-reversed thing, so behind an odd number of mirrors s runs against u.
fn turned(loaded: &Loaded, [s, t]: [f64; 2]) -> [f64; 2] {
    let mirrors = loaded.scene.elements.iter();
    let mirrors = mirrors.filter(|element| matches!(element.material, Material::Mirror { .. }));
    if mirrors.count() % 2 == 1 { [1.0 - s, t] } else { [s, t] }
}
