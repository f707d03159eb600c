//! Where a display belongs.

use super::LayerPlanes;
use crate::geometry::{Frame, Rectangle, Vec3};

/// Where a display belongs that is to show an image through a plate and flat mirrors: the image's centre, axes and normal mirrored in
/// each mirror (its local z = 0), nearest the viewer first, then in the plate; the normal turned to face the plate's centre, x = y cross
/// normal. With no element every pixel st then shows at image uv = st.
///
/// A plate of two `layers` has two planes of symmetry: the display goes where it brings the light of the image's centre, half a millimetre or so
/// along the plate. Then st = uv at the centre; towards the image's corners, where directions differ, it is off by some hundredths of a
/// millimetre.
///
/// A display is never a mirror-reversed thing, so behind an odd number of mirrors s runs against u.
pub fn display_place(
    image: Frame,
    mirrors: &[Frame],
    plate: &Frame,
    layers: Option<&LayerPlanes>,
    viewpoint: Vec3,
    size: [f64; 2],
) -> Rectangle {
    let eye = Frame { origin: viewpoint, ..image };
    let [eye, image] = [eye, image].map(|frame| virtual_image(frame, mirrors, viewpoint));
    let shift = layers.map_or(Vec3::ZERO, |layers| {
        let sight = (image.origin - eye.origin).normalized();
        let [x, y] = layers.shift(plate.to_local_direction(sight));
        plate.axes[0] * x + plate.axes[1] * y
    });
    let image = mirrored(plate, image);
    let [_, up, normal] = image.axes;
    let facing = normal.dot(plate.origin - image.origin);
    let normal = if facing < 0.0 { -normal } else { normal };
    let frame = Frame { origin: image.origin + shift, axes: [up.cross(normal), up, normal] };
    Rectangle { frame, size }
}

/// The image's frame mirrored in each flat mirror, nearest the viewer first: what the plate has to form. The frame is left-handed
/// after an odd number of mirrors.
pub fn virtual_image(image: Frame, mirrors: &[Frame], viewpoint: Vec3) -> Frame {
    nearest_first(mirrors, viewpoint).iter().fold(image, |image, mirror| mirrored(mirror, image))
}

/// Where the image of a display floats: its frame mirrored in the plate, then in the flat mirrors from the one farthest from the viewer on. What
/// [`display_place`] of an ideal plate undoes.
pub fn floating_place(display: Frame, mirrors: &[Frame], plate: &Frame, viewpoint: Vec3) -> Frame {
    let behind_mirrors = mirrored(plate, display);
    let mirrors = nearest_first(mirrors, viewpoint);
    mirrors.iter().rev().fold(behind_mirrors, |frame, mirror| mirrored(mirror, frame))
}

fn nearest_first(mirrors: &[Frame], viewpoint: Vec3) -> Vec<Frame> {
    let mut mirrors = mirrors.to_vec();
    mirrors.sort_by(|a, b| {
        let [a, b] = [a, b].map(|m| (m.origin - viewpoint).squared_length());
        a.total_cmp(&b)
    });
    mirrors
}

/// `frame` mirrored in the plane z = 0 of `mirror`.
fn mirrored(mirror: &Frame, frame: Frame) -> Frame {
    let normal = mirror.normal();
    let flip = |v: Vec3| v - normal * (2.0 * v.dot(normal));
    Frame { origin: mirror.origin + flip(frame.origin - mirror.origin), axes: frame.axes.map(flip) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Ray;
    use crate::optics::interface::reflect;
    use crate::optics::plate::{Class, SlitMirror, SlitMirrorPlate};

    /// Against the light itself: rays of the line of sight to the image's centre, traced mirror by mirror over a whole cell of the
    /// lattice, arrive on average at the display's centre. Straight ahead, aslant, and by way of a flat mirror.
    #[test]
    fn behind_two_layers_the_display_stands_where_light_arrives() {
        const EACH: usize = 300;
        let image = Frame::new(Vec3::new(2.0, 30.0, -3.0), [5.0, -8.0, 3.0]);
        let level = Frame::new(Vec3::ZERO, [-90.0, 0.0, 0.0]);
        let cases = [
            (vec![], Vec3::new(0.0, 30.0, 800.0), [-45.0, 0.0, 0.0], 45.0),
            (vec![], Vec3::new(-150.0, 120.0, 700.0), [-40.0, 12.0, 4.0], 20.0),
            (vec![level], Vec3::new(30.0, 500.0, 800.0), [0.0, 6.0, 0.0], 45.0),
        ];
        for (mirrors, eye, rotation, azimuth) in cases {
            let parameters = SlitMirror { azimuth, ..SlitMirror::default() };
            let model = SlitMirrorPlate::new(parameters).unwrap();
            let plate = Frame::new(Vec3::new(0.0, 0.0, -200.0), rotation);
            let layers = LayerPlanes::new(&parameters);
            let place = |layers| display_place(image, &mirrors, &plate, layers, eye, [20.0; 2]);
            let (ideal, display) = (place(None), place(Some(&layers)));
            let mut ray = Ray { origin: eye, direction: (image.origin - eye).normalized() };
            for mirror in &mirrors {
                let from = mirror.to_local(ray.origin);
                let local = mirror.to_local_direction(ray.direction);
                let at = ray.at(-from.z / local.z);
                ray = Ray { origin: at, direction: reflect(ray.direction, mirror.normal()) };
            }
            let (from, d) = (plate.to_local(ray.origin), plate.to_local_direction(ray.direction));
            let crossing = from - d * (from.z / d.z);
            let (mut sum, mut real) = ([0.0; 2], 0u32);
            for index in 0..EACH * EACH {
                let of_cell = [index % EACH, index / EACH].map(|i| (i as f64 + 0.5) / EACH as f64);
                // Not the light is moved but the lattice of mirrors.
                let [x, y] = model.across_inverse(of_cell.map(|share| share * parameters.pitch));
                let moved = Vec3::new(x, y, 0.0);
                let Some(passage) = model.pass(crossing + moved, d) else { continue };
                if passage.class == Class::Real {
                    let behind = Ray {
                        origin: plate.to_world(passage.exit_point - moved),
                        direction: plate.to_world_direction(passage.direction),
                    };
                    let st = display.coordinates(behind.at(display.plane_distance(&behind)));
                    sum = [0, 1].map(|axis| sum[axis] + st[axis]);
                    real += 1;
                }
            }
            assert!(real > 5_000, "{real}");
            let off = sum.map(|sum| (sum / f64::from(real) - 0.5) * 20.0);
            // The ends of the open range of offsets are known to half a step in each direction, on a slant of up to 50 degrees.
            let step = parameters.pitch / EACH as f64;
            assert!(off[0].hypot(off[1]) < 3.0 * step, "{off:?} {step}");
            // And the ideal plate's place is half a millimetre off.
            let apart = (ideal.frame.origin - display.frame.origin).length();
            assert!((0.3..1.0).contains(&apart), "{apart}");
            assert_eq!(ideal.frame.axes, display.frame.axes);
        }
    }
}
