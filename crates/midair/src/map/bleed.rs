//! Beyond a map's coverage: the ring that a display draws, and the continuation for tools that interpolate.

use super::model::is_finite;
use super::{Gain, Map};

/// The eight neighbours: columns and rows away.
fn around() -> impl Iterator<Item = (isize, isize)> {
    (-1..=1)
        .flat_map(|dy| (-1..=1).map(move |dx| (dx, dy)))
        .filter(|&direction| direction != (0, 0))
}

/// How many rows and columns away [`continued`] looks.
pub(crate) const REACH: usize = 2;

/// A pixel's uv from what there is around it: `uv` tells it so many columns and rows away, not finite or `None` where it is not known.
/// The mean of the straight continuations through its neighbours, in those of the eight directions where two pixels in line are known, or
/// else of the known neighbours; `None` where no neighbour is known.
pub(crate) fn continued(uv: impl Fn(isize, isize) -> Option<[f64; 2]>) -> Option<[f64; 2]> {
    let known = |dx, dy| uv(dx, dy).filter(|&uv| is_finite(uv));
    let (mut straight, mut straights) = ([0.0; 2], 0.0);
    let (mut near, mut nears) = ([0.0; 2], 0.0);
    for (dx, dy) in around() {
        let Some(first) = known(dx, dy) else { continue };
        (near, nears) = ([near[0] + first[0], near[1] + first[1]], nears + 1.0);
        if let Some(second) = known(2 * dx, 2 * dy) {
            for axis in 0..2 {
                straight[axis] += 2.0 * first[axis] - second[axis];
            }
            straights += 1.0;
        }
    }
    let (sum, count) = if straights > 0.0 { (straight, straights) } else { (near, nears) };
    (count > 0.0).then(|| sum.map(|value| value / count))
}

/// The map with `rings` pixels of extrapolated uv around the covered region: tools that interpolate between
/// the map's pixels then show no jagged or dark edge. The statuses stay as they are, so that coverage is kept
/// apart: an extrapolated pixel has uv and a status that says it has no answer of its own.
///
/// Ring by ring: each new pixel is the mean of the straight continuations through its neighbours, in
/// those of the eight directions where two pixels in line are known, or else of the known neighbours. An
/// affine map is continued exactly.
pub fn bleed(map: &Map, rings: usize) -> Map {
    let mut bled = map.clone();
    let (width, height) = (map.width as isize, map.height as isize);
    let at = |x: isize, y: isize| {
        let inside = (0..width).contains(&x) && (0..height).contains(&y);
        inside.then_some((y * width + x) as usize)
    };
    let place = |i: usize| (i as isize % width, i as isize / width);
    // The pixels to look at next: those beside what is known.
    let mut front: Vec<usize> = (0..bled.uv.len())
        .filter(|&i| {
            let (x, y) = place(i);
            let known = |(dx, dy)| at(x + dx, y + dy).is_some_and(|j| is_finite(bled.uv[j]));
            !is_finite(bled.uv[i]) && around().any(known)
        })
        .collect();
    for _ in 0..rings {
        let ring: Vec<_> = front
            .iter()
            .filter_map(|&i| {
                let (x, y) = place(i);
                Some((i, continued(|dx, dy| Some(bled.uv[at(x + dx, y + dy)?]))?))
            })
            .collect();
        for &(i, uv) in &ring {
            bled.uv[i] = uv;
        }
        let mut next: Vec<usize> = ring
            .iter()
            .flat_map(|&(i, _)| {
                let (x, y) = place(i);
                around().filter_map(move |(dx, dy)| at(x + dx, y + dy))
            })
            .filter(|&i| !is_finite(bled.uv[i]))
            .collect();
        next.sort_unstable();
        next.dedup();
        front = next;
    }
    bled
}

/// An image point to the precision in which maps are drawn: that of a 32-bit float, which is what map files hold. So a map draws the same
/// picture before it was written and after it was read. Half a step is 3e-8 of the image, far below a map's own error bound.
#[inline(always)]
pub(crate) fn to_drawn_precision(uv: [f64; 2]) -> [f64; 2] {
    uv.map(|value| f64::from(value as f32))
}

impl Map {
    /// The image point that a display pixel shows: its answer, or, in the one ring of pixels around the coverage, the answers' straight
    /// continuation. Between the outermost answered pixel's centre and the next one's a display shows a mean of both, so an image
    /// would end in a dark rim, half a pixel wide, if the next one stayed dark.
    ///
    /// All that draws draws this. A [`continuation`](Self::continuation) that the map may have is not looked at: it is for other tools, and of
    /// any width.
    ///
    /// # Panics
    /// Where the map has no such pixel.
    #[inline]
    pub fn drawn(&self, column: usize, row: usize) -> Option<[f64; 2]> {
        match self.answer(row * self.width + column) {
            Some(uv) => Some(to_drawn_precision(uv)),
            None => self.ring(column, row),
        }
    }

    #[inline(never)]
    fn ring(&self, column: usize, row: usize) -> Option<[f64; 2]> {
        let answer = |dx: isize, dy: isize| {
            let (x, y) = (column.wrapping_add_signed(dx), row.wrapping_add_signed(dy));
            let on = x < self.width && y < self.height;
            on.then(|| self.answer(y * self.width + x)).flatten().map(to_drawn_precision)
        };
        continued(answer).map(to_drawn_precision)
    }
}

impl Gain {
    /// The gain of all pixels that are [drawn](Map::drawn): in the ring around what is known it is the mean of the known neighbours.
    pub(crate) fn with_ring(&self) -> Self {
        let mut wider = self.clone();
        for (index, rgb) in
            wider.rgb.iter_mut().enumerate().filter(|(_, rgb)| !Self::is_answered(rgb))
        {
            let (column, row) = (index % self.width, index / self.width);
            let (mut sum, mut count) = ([0.0; 3], 0.0);
            for y in row.saturating_sub(1)..self.height.min(row + 2) {
                for x in column.saturating_sub(1)..self.width.min(column + 2) {
                    let near = &self.rgb[y * self.width + x];
                    if Self::is_answered(near) {
                        (0..3).for_each(|c| sum[c] += near[c]);
                        count += 1.0;
                    }
                }
            }
            if count > 0.0 {
                *rgb = sum.map(|total| total / count);
            }
        }
        wider
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::map::Status;

    /// A map known in a disc only.
    fn disc(size: usize, radius: f64, uv: impl Fn([f64; 2]) -> [f64; 2]) -> (Map, Map) {
        let mut whole = Map::identity(size, size);
        whole.uv.iter_mut().for_each(|st| *st = uv(*st));
        let mut map = whole.clone();
        for (i, st) in Map::identity(size, size).uv.iter().enumerate() {
            if (st[0] - 0.5).hypot(st[1] - 0.5) > radius {
                (map.uv[i], map.status[i]) = ([f64::NAN; 2], Status::Blocked);
            }
        }
        (map, whole)
    }

    #[test]
    fn an_affine_map_is_continued_exactly_for_as_many_rings_as_asked() {
        let (map, whole) = disc(41, 0.25, |[s, t]| [0.1 + 0.7 * s - 0.2 * t, 0.3 * s + 0.5 * t]);
        let bled = bleed(&map, 5);
        assert_eq!(bled.status, map.status);
        let on = |map: &Map, i: usize| map.uv[i][0].is_finite();
        for i in 0..41 * 41 {
            let (x, y) = ((i % 41) as i32, (i / 41) as i32);
            // Within 5 steps of a king from the disc, and no further.
            let reached = (0..41 * 41usize).any(|j| {
                on(&map, j) && (x - (j % 41) as i32).abs().max((y - (j / 41) as i32).abs()) <= 5
            });
            assert_eq!(on(&bled, i), reached);
            if reached {
                // Roundings grow by at most 3 a ring: 3^5 of them.
                assert!((0..2).all(|c| (bled.uv[i][c] - whole.uv[i][c]).abs() < 1e-13));
            }
        }
    }

    #[test]
    fn a_curved_map_is_continued_to_second_order() {
        let (map, whole) = disc(200, 0.3, |[s, t]| [s + 0.1 * s * t, t + 0.1 * s * s]);
        let bled = bleed(&map, 3);
        for i in 0..200 * 200 {
            if bled.uv[i][0].is_finite() {
                // A straight line leaves a curve of second derivative 0.2 by 0.2 (k / 200)^2 / 2 times
                // k (k + 1) / 2 sums over k = 3 rings, doubled on diagonals.
                assert!(
                    (0..2).all(|c| (bled.uv[i][c] - whole.uv[i][c]).abs() < 6.0 * 2.0 * 0.2 / 4e4)
                );
            }
        }
    }

    #[test]
    fn nothing_to_go_by_gives_nothing_and_lone_pixels_are_copied() {
        let mut map = Map::identity(5, 5);
        map.uv.fill([f64::NAN; 2]);
        assert!(bleed(&map, 3).uv.iter().all(|uv| uv[0].is_nan()));
        map.uv[12] = [0.25, 0.75];
        assert!(bleed(&map, 2).uv.iter().all(|uv| *uv == [0.25, 0.75]));
        assert!(bleed(&Map::identity(0, 0), 2).uv.is_empty());
    }

    #[test]
    fn what_is_drawn_is_the_answers_and_one_ring_whatever_the_continuation() {
        // Numbers of few bits, so that no precision is lost.
        let (map, whole) = disc(32, 0.25, |[s, t]| [0.5 * s + 0.25 * t, 0.75 * t]);
        let mut drawn = 0;
        let covered = |x: isize, y: isize| {
            let on = (0..32).contains(&x) && (0..32).contains(&y);
            on && map.status[(32 * y + x) as usize].is_answered()
        };
        for map in [bleed(&map, 0), bleed(&map, 1), bleed(&map, 9)] {
            for i in 0..32 * 32 {
                let (x, y) = ((i % 32) as isize, (i / 32) as isize);
                let near = (-1..=1).any(|dy| (-1..=1).any(|dx| covered(x + dx, y + dy)));
                assert_eq!(map.drawn(i % 32, i / 32), near.then_some(whole.uv[i]));
                assert_eq!(map.answer(i), covered(x, y).then_some(whole.uv[i]));
                let beyond = map.uv[i][0].is_finite() && !covered(x, y);
                assert_eq!(map.continuation(i), beyond.then_some(map.uv[i]));
                drawn += usize::from(near && !covered(x, y));
            }
        }
        // A disc of radius 8 has a ring of about 2 pi 8.5 pixels; three times.
        assert!(drawn > 3 * 50, "{drawn}");
    }

    #[test]
    fn a_map_of_single_precision_draws_what_the_one_of_double_precision_does() {
        let (map, _) = disc(50, 0.31, |[s, t]| [s / 3.0 + 0.1 * t * s, t / 1.7 - 0.01 * s * s]);
        let mut single = map.clone();
        single.uv.iter_mut().flatten().for_each(|value| *value = f64::from(*value as f32));
        assert_ne!(single, map);
        for i in 0..50 * 50 {
            assert_eq!(single.drawn(i % 50, i / 50), map.drawn(i % 50, i / 50));
        }
    }

    #[test]
    fn a_gain_is_continued_by_one_ring() {
        let nan = [f32::NAN; 3];
        let rgb = vec![nan, [0.5, 0.25, 1.0], [0.25, 0.25, 0.5], nan, nan];
        let wider = Gain { width: 5, height: 1, rgb }.with_ring();
        assert_eq!(
            wider.rgb[..4],
            [[0.5, 0.25, 1.0], [0.5, 0.25, 1.0], [0.25, 0.25, 0.5], [0.25, 0.25, 0.5]]
        );
        assert!(wider.rgb[4].iter().all(|value| value.is_nan()));
    }
}
