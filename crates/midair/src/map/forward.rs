//! F as a map: for each image pixel the display point that forms it.

use super::formation::{ImagePoint, classify};
use super::{Map, Status, pixel_centre};
use crate::transport::Setup;

/// F at the pixel centres of an image of `width` x `height` pixels, by the transport itself: where G says which image point a
/// display pixel shows, this says which display point an image pixel is shown by. Its `uv` are display
/// coordinates st.
///
/// A point is `Ok` where it is formed, `Folded` where its display pixel serves other image points as well (which `map`,
/// the set-up's G, knows), `Outside` where its path gets through and goes past the display (a larger display, or another place, would
/// form it), and `Blocked` where something on the way ends it: the plate's edge or back, total internal reflection, too
/// many interactions. The error bound is 0: nothing is approximated.
pub fn forward(setup: &Setup, map: &Map, [width, height]: [usize; 2]) -> Map {
    let centre = |index| pixel_centre(index % width, index / width, width, height);
    let nowhere = [f64::NAN; 2];
    let points = setup.each_end(width * height, centre, (nowhere, Status::Blocked), |end| {
        let (st, status) = match classify(end, map) {
            ImagePoint::Formed => (end.formed(), Status::Ok),
            ImagePoint::Folded => (end.formed(), Status::Folded),
            ImagePoint::MissedDisplay => (None, Status::Outside),
            _ => (None, Status::Blocked),
        };
        (st.unwrap_or(nowhere), status)
    });
    let (uv, status) = points.into_iter().unzip();
    Map { width, height, uv, status, error_bound: 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::map::{Accuracy, formation, invert, reversed};
    use crate::transport::bench_setup::{ACRYLIC, block, element, setup, sphere};

    /// By hand, with no element: the display shows the image point at its own place, and the plate is crossed 150 mm behind the image, which
    /// the eye sees from 800 mm.
    #[test]
    fn what_is_outside_and_what_is_blocked_is_told_by_what_is_too_small() {
        let count = |setup: &crate::transport::Setup| {
            let (map, _) = invert(setup, Accuracy::default());
            let forward = forward(setup, &map, [100, 100]);
            [&map, &forward].map(|map| {
                [Status::Ok, Status::Outside, Status::Blocked]
                    .map(|status| map.status.iter().filter(|&&s| s == status).count())
            })
        };
        let mut display = setup(40.0, vec![]);
        display.resolution = [100, 100];
        let (mut plate, mut large) = (display.clone(), display.clone());
        // Half of the image has its place on a display half as wide.
        display.display.size[0] = 20.0;
        assert_eq!(count(&display), [[10_000, 0, 0], [5_000, 5_000, 0]]);
        // Of a display twice as wide half is asked for.
        large.display.size[0] = 80.0;
        assert_eq!(count(&large), [[5_000, 5_000, 0], [10_000, 0, 0]]);
        // 23.75 mm of the plate are 20 mm of the image, and a fortieth more or less at its edges, as the plate is tilted. Either side
        // lacks the same answers, because of the plate.
        plate.plate.rectangle.size[0] = 23.75;
        let [map, forward] = count(&plate);
        assert_eq!(map, forward);
        assert!(map[1] == 0 && map[2].abs_diff(5_000) < 100, "{map:?}");
    }

    #[test]
    fn the_transport_and_the_reversed_map_agree() {
        let ball = element(sphere(25.0), ACRYLIC, [0.0; 3], [0.0; 3], 0);
        let cube = element(block(50.0, 50.0, 50.0), ACRYLIC, [0.0; 3], [0.0, 15.8, 0.0], 0);
        for (name, elements) in [("none", vec![]), ("ball", vec![ball]), ("cube", vec![cube])] {
            let mut setup = setup(20.0, elements);
            setup.resolution = [400, 400];
            let (map, _) = invert(&setup, Accuracy::default());
            let size = [90, 70];
            let (direct, reversed) = (forward(&setup, &map, size), reversed(&map, size));
            let formed = formation(&setup, &map, size);
            let mut compared = 0;
            for i in 0..size[0] * size[1] {
                assert_eq!(direct.status[i] == Status::Ok, formed.points[i] == ImagePoint::Formed);
                assert_eq!(direct.uv[i][0].is_nan(), direct.status[i] as u8 > 1);
                if direct.status[i] == Status::Ok && reversed.status[i] == Status::Ok {
                    // Bilinear cells of 1/400 bend by h^2 / 8 times the second derivatives, which stay below 10.
                    for axis in 0..2 {
                        let off = (direct.uv[i][axis] - reversed.uv[i][axis]).abs();
                        assert!(off < 10.0 / 8.0 / 400.0 / 400.0, "{name} {i}: {off}");
                    }
                    compared += 1;
                }
            }
            // But for a rim, all that the transport forms is found in the map.
            let ok = direct.status.iter().filter(|&&status| status == Status::Ok).count();
            assert!(ok > 1000 && compared as f64 > 0.97 * ok as f64, "{name}: {compared} of {ok}");
        }
    }
}
