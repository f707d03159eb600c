//! A photograph with the intersections that were found in it.

use midair::measure::lattice::Lattice;
use midair::picture::Picture;

/// Found: a ring about the place, and a cross through it (linear light).
const FOUND: [f32; 3] = [1.0, 0.02, 0.25];
/// Where it belongs: a disc, and a line to it.
const BELONGS: [f32; 3] = [0.0, 0.5, 1.0];

/// Draws the intersections of a lattice, and where they belong if that is known.
pub fn draw(photo: &Picture, lattice: &Lattice, belongs: Option<&[Option<[f64; 2]>]>) -> Picture {
    let mut drawn = photo.clone();
    let points = lattice.points();
    let spacing = lattice.spacing().unwrap_or(20.0);
    let radius = (0.16 * spacing).clamp(3.0, 60.0);
    // A hair line in a small photograph, still seen in one of 6000 pixels that is looked at as a whole.
    let pen = (0.1 * radius).max(0.6);
    for (place, wanted) in points.iter().zip(belongs.unwrap_or(&vec![None; points.len()])) {
        if let (Some(place), Some(wanted)) = (place, wanted) {
            paint(&mut drawn, BELONGS, [*place, *wanted], pen, |p| to_segment(p, *place, *wanted));
            paint(&mut drawn, BELONGS, [*wanted; 2], 3.0 * pen, |p| length(p, *wanted));
        }
    }
    for place in points.into_iter().flatten() {
        let box_ = [[place[0] - radius, place[1] - radius], [place[0] + radius, place[1] + radius]];
        paint(&mut drawn, FOUND, box_, pen, |p| (length(p, place) - radius).abs());
        let arm = 0.5 * radius;
        for [dx, dy] in [[arm, 0.0], [0.0, arm]] {
            let ends = [[place[0] - dx, place[1] - dy], [place[0] + dx, place[1] + dy]];
            paint(&mut drawn, FOUND, ends, 0.5 * pen, |p| to_segment(p, ends[0], ends[1]));
        }
    }
    drawn
}

/// Colours what is within `reach` of a figure in a box, its edge smooth over a pixel.
fn paint(
    picture: &mut Picture,
    colour: [f32; 3],
    corners: [[f64; 2]; 2],
    reach: f64,
    distance: impl Fn([f64; 2]) -> f64,
) {
    let span = |axis: usize, size: usize| {
        let (a, b) = (corners[0][axis], corners[1][axis]);
        let (from, to) = (a.min(b) - reach - 1.0, a.max(b) + reach + 2.0);
        (from.max(0.0) as usize)..(to.max(0.0) as usize).min(size)
    };
    for row in span(1, picture.height) {
        for column in span(0, picture.width) {
            let off = distance([column as f64 + 0.5, row as f64 + 0.5]);
            let cover = (reach + 0.5 - off).clamp(0.0, 1.0) as f32;
            let pixel = &mut picture.pixels[row * picture.width + column];
            for (value, ink) in pixel.iter_mut().zip(colour) {
                *value += cover * (ink - *value);
            }
        }
    }
}

fn length(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

fn to_segment(p: [f64; 2], a: [f64; 2], b: [f64; 2]) -> f64 {
    let (along, size) = ([b[0] - a[0], b[1] - a[1]], length(a, b).powi(2));
    let t = if size > 0.0 {
        (((p[0] - a[0]) * along[0] + (p[1] - a[1]) * along[1]) / size).clamp(0.0, 1.0)
    } else {
        0.0
    };
    length(p, [a[0] + t * along[0], a[1] + t * along[1]])
}

#[cfg(test)]
mod tests {
    use super::*;
    use midair::measure::lattice::Missing;

    #[test]
    fn marks_lie_where_the_places_are_and_borders_cut_them_off() {
        let photo = Picture::filled(60, 60, [0.0, 0.0, 0.0, 1.0]);
        let intersections =
            vec![Ok([20.0, 20.0]), Ok([45.0, 20.0]), Err(Missing::NotSeen), Ok([59.5, 45.0])];
        let lattice = Lattice { count: 2.into(), intersections, line_width: 2.0, left_out: 0 };
        let belongs = [Some([20.0, 30.0]), None, Some([3.0, 3.0]), None];
        let drawn = draw(&photo, &lattice, Some(&belongs));
        let at = |x: usize, y: usize| drawn.pixels[y * 60 + x];
        // On the ring to the right of the first place: a sixth of the spacing of 25 to 29.
        assert!(at(24, 20)[0] > 0.5 && at(40, 20)[0] > 0.5);
        assert_eq!(at(30, 20), [0.0, 0.0, 0.0, 1.0]);
        // On the way to where the first belongs, beyond its ring; nothing for the missing one.
        assert!(at(20, 27)[2] > 0.5);
        assert_eq!(at(3, 3), [0.0, 0.0, 0.0, 1.0]);
        // Neighbours are 25 to the right, and 29 down: the larger of two.
        assert!((lattice.spacing().unwrap() - 25.0).abs() < 5.0);
    }

    #[test]
    fn a_segment_is_as_far_as_its_nearest_point() {
        assert_eq!(to_segment([5.0, 3.0], [0.0, 0.0], [10.0, 0.0]), 3.0);
        assert_eq!(to_segment([13.0, 4.0], [0.0, 0.0], [10.0, 0.0]), 5.0);
        assert_eq!(to_segment([3.0, 4.0], [0.0; 2], [0.0; 2]), 5.0);
    }
}
