//! What a display without compensation shows.

use crate::geometry::Rectangle;
use crate::map::{Map, Status, pixel_centre};
use crate::transport::Setup;

/// Where a display without compensation shows the image: in its true size, at the place where it belongs if mirrors are flat
/// and solids absent, wherever the scene's display stands. It is turned about if an odd number of mirrors would show it the
/// wrong way round.
pub(crate) struct AsIs {
    /// The image's place in the display's plane.
    place: Rectangle,
    display: Rectangle,
    turned: bool,
}

impl AsIs {
    pub fn new(setup: &Setup) -> Self {
        // A display is never a mirror-reversed thing, so behind an odd number of mirrors s runs against u.
        let turned = setup.mirrors().count() % 2 == 1;
        Self { place: setup.display_place(), display: setup.display, turned }
    }

    /// The display point that shows an image point.
    pub fn shown_at(&self, uv: [f64; 2]) -> [f64; 2] {
        self.display.coordinates(self.place.point(self.turn(uv)))
    }

    /// The image point that a display point shows.
    pub fn image_point(&self, st: [f64; 2]) -> [f64; 2] {
        self.turn(self.place.coordinates(self.display.point(st)))
    }

    fn turn(&self, [s, t]: [f64; 2]) -> [f64; 2] {
        if self.turned { [1.0 - s, t] } else { [s, t] }
    }
}

/// The map of a display that shows the image as it is: in its true size where it belongs if mirrors are flat and solids
/// absent, as far as the display reaches there. Then the viewer would see the image undistorted.
pub fn uncompensated_map(setup: &Setup) -> Map {
    let as_is = AsIs::new(setup);
    let [width, height] = setup.resolution;
    let mut map = Map::unanswered(width, height);
    for index in 0..width * height {
        let uv = as_is.image_point(pixel_centre(index % width, index / width, width, height));
        if uv.iter().all(|c| (0.0..=1.0).contains(c)) {
            map.uv[index] = uv;
            map.status[index] = Status::Ok;
        }
    }
    map
}
