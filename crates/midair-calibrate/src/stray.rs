//! Stray light told apart: it is another image of the same display, so what it would show at a pixel is known as well as what the real one would.

use crate::camera::{Lens, pixel_ray};
use crate::decoded::{Decoded, Seen};
use midair::geometry::{Frame, Ray, Vec3};
use midair::optics::plate::Model;
use midair::simulate::STRAY;
use midair::transport::{Action, Path, Placing, Setup};
use rayon::prelude::*;

/// The ray that meets the plate at the end of a path's elements, its origin on the plate, and the share of green light that got there; `None` where it misses the plate.
pub(crate) fn at_plate(setup: &Setup, ray: Ray, path: &Path) -> Option<(Ray, f64)> {
    let until = path.iter().position(|step| step.action == Action::Plate)?;
    let left = setup.remainder(ray, &path[..=until])?;
    let at = setup.plate.rectangle.coordinates(left.at_plate.origin);
    at.iter().all(|c| (0.0..=1.0).contains(c)).then_some((left.at_plate, left.share[1]))
}

/// The display point that light behind the plate comes from, if it is turned across these of the two layers' mirrors.
fn passed(setup: &Setup, ray: &Ray, odd: [bool; 2]) -> Option<[f64; 2]> {
    let Model::SlitMirror(plate) = setup.plate.model() else { return None };
    let frame = &setup.plate.rectangle.frame;
    let d = frame.to_local_direction(ray.direction);
    let along = plate.across([d.x, d.y]);
    let [x, y] = plate.across_inverse([0, 1].map(|k| if odd[k] { -along[k] } else { along[k] }));
    let direction = frame.to_world_direction(Vec3::new(x, y, d.z));
    let behind = Ray { origin: ray.origin, direction };
    let distance = setup.display.plane_distance(&behind);
    let seen = distance > 0.0 && direction.dot(setup.display.frame.normal()) < 0.0;
    seen.then(|| setup.display.coordinates(behind.at(distance)))
}

/// Camera pixels along either side of a square for which one prediction serves, where what they see is near it.
const COARSE: usize = 8;

/// A pixel that is nearer than this to what the real image would show there is real, as a share of the display: the object may stand some millimetres elsewhere.
const NEAR: f64 = 0.04;

/// Marks the pixels that see the display by stray light: what they see is nearer to what one of the plate's stray images would show there than to what the
/// real one would: by half, or it is not sure.
pub fn mark(decoded: &mut Decoded, setup: &Setup, camera: &Frame, lens: &Lens) {
    let placed = Placing::constant(camera);
    let (width, height) = (decoded.width, decoded.height);
    let columns = width.div_ceil(COARSE);
    let ray_of = |pixel: [f64; 2]| {
        Some(pixel_ray(&placed, lens, pixel)).filter(|ray| ray.direction.is_finite())
    };
    let of_cell = |cell: usize| {
        let middle = [cell % columns, cell / columns].map(|k| (k * COARSE + COARSE / 2) as f64);
        setup.trace(ray_of(middle)?, &mut Path::new()).st()
    };
    let cells = columns * height.div_ceil(COARSE);
    let coarse: Vec<Option<[f64; 2]>> = (0..cells).into_par_iter().map(of_cell).collect();
    let st = &decoded.st;
    decoded.seen.par_iter_mut().enumerate().for_each(|(pixel, seen)| {
        if *seen != Seen::Real {
            return;
        }
        let (x, y) = (pixel % width, pixel / width);
        let off = |place: &Option<[f64; 2]>| match place {
            Some([s, t]) => (s - f64::from(st[pixel][0])).hypot(t - f64::from(st[pixel][1])),
            None => f64::INFINITY,
        };
        if off(&coarse[(y / COARSE) * columns + x / COARSE]) <= NEAR {
            return;
        }
        // A stray image may be seen at a slant, many of the display's pixels in one of the camera's.
        let Some(ray) = ray_of([x as f64 + 0.5, y as f64 + 0.5]) else { return };
        let mut path = Path::new();
        let real = off(&setup.trace(ray, &mut path).st());
        let Some((left, _)) = at_plate(setup, ray, &path) else { return };
        let strays = STRAY.map(|odd| off(&passed(setup, &left, odd)));
        let stray = strays.into_iter().fold(f64::INFINITY, f64::min);
        if real > NEAR && stray < real {
            // Between the two where both lie over one another.
            *seen = if stray < 0.5 * real { Seen::Stray } else { Seen::Unsure };
        }
    });
}
