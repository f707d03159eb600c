//! What is seen of a set-up: compensated, uncompensated, and as it should be.

use crate::failure::Failure;
use midair::compensate::{Compensation, Options, uncompensated_map};
use midair::map::Map;
use midair::picture::optimal::view_through;
use midair::picture::{Picture, display_image};
use midair::scene::Loaded;
use midair::simulate::{Camera, Reference};
use midair::transport::Setup;
use midair_report::drawing::test_picture;
use midair_report::paper::strip;

/// Pixels of a view's longer side.
const SIDE: f64 = 320.0;

/// Three views of the built-in picture side by side.
pub fn views(loaded: &Loaded) -> Result<Picture, Failure> {
    let setup = Setup::new(loaded)?;
    let [w, h] = setup.image.size;
    let size = [w, h].map(|side| (SIDE * side / w.max(h)).round().max(1.0) as usize);
    let setup = setup.with_resolution(size.map(|side| 2 * side));
    let picture = test_picture::draw(2 * size[0], 2 * size[1]);
    let camera = Camera { eye: setup.viewpoint, size, window: 1.0, supersampling: 2 };
    let rays = camera.rays(&setup);
    let compensated = Compensation::of(&setup, &Options::new(), &()).light(&picture);
    let uncompensated = display_image(&picture, &uncompensated_map(&setup));
    let [width, height] = setup.resolution;
    let as_it_is = display_image(&picture, &Map::identity(width, height));
    let reference = Reference::new(&setup, &camera);
    let views = [
        view_through(&rays, &compensated)?,
        view_through(&rays, &uncompensated)?,
        view_through(&reference, &as_it_is)?,
    ];
    let of: Vec<&Picture> = views.iter().collect();
    strip(&of, 6).map_err(|error| Failure::new(error.to_string(), "ask for fewer --views"))
}
