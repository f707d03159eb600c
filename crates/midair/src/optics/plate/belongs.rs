//! Where a display belongs.

use crate::geometry::{Frame, Rectangle, Vec3};

/// Where a display belongs that is to show an image through a plate and flat mirrors: the image's centre, axes and normal mirrored in
/// each mirror (its local z = 0), nearest the viewer first, then in the plate; the normal turned to face the plate's centre, x = y cross
/// normal. With no element every pixel st then shows at image uv = st.
///
/// A display is never a mirror-reversed thing, so behind an odd number of mirrors s runs against u.
pub fn display_place(
    image: Frame,
    mirrors: &[Frame],
    plate: &Frame,
    viewpoint: Vec3,
    size: [f64; 2],
) -> Rectangle {
    let image = mirrored(plate, virtual_image(image, mirrors, viewpoint));
    let [_, up, normal] = image.axes;
    let facing = normal.dot(plate.origin - image.origin);
    let normal = if facing < 0.0 { -normal } else { normal };
    Rectangle { frame: Frame { origin: image.origin, axes: [up.cross(normal), up, normal] }, size }
}

/// The image's frame mirrored in each flat mirror, nearest the viewer first: what the plate has to form. The frame is left-handed
/// after an odd number of mirrors.
pub fn virtual_image(image: Frame, mirrors: &[Frame], viewpoint: Vec3) -> Frame {
    let mut mirrors = mirrors.to_vec();
    mirrors.sort_by(|a, b| {
        let [a, b] = [a, b].map(|m| (m.origin - viewpoint).squared_length());
        a.total_cmp(&b)
    });
    mirrors.iter().fold(image, |image, mirror| mirrored(mirror, image))
}

/// `frame` mirrored in the plane z = 0 of `mirror`.
fn mirrored(mirror: &Frame, frame: Frame) -> Frame {
    let normal = mirror.normal();
    let flip = |v: Vec3| v - normal * (2.0 * v.dot(normal));
    Frame { origin: mirror.origin + flip(frame.origin - mirror.origin), axes: frame.axes.map(flip) }
}
