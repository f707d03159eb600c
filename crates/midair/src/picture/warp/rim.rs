//! Bilinear taps of an inverse, one ring wider than its answers, without a map in memory.
//!
//! A pixel of the ring needs uv of up to [`REACH`] rows above and below it. So each thread goes down a piece of the display band by
//! band, keeps three bands, and adds the ring to the middle one.

use super::bilinear::{spans_of_row, tap_row};
use super::taps::{Plan, Tap};
use crate::map::{Inverse, InverseRows, REACH, continued, to_drawn_precision};
use rayon::prelude::*;
use std::cell::RefCell;
use std::ops::Range;

/// Rows that one thread samples at a time: few enough that their uv, and that of the two bands before, is still in its cache. At least
/// [`REACH`].
const BAND: usize = 4;
const _: () = assert!(BAND >= REACH);

/// Rows of a piece, in whole bands: where its border is cut, [`REACH`] rows beyond either end are sampled once more.
const PIECE: usize = 16 * BAND;

/// Taps in the memory of earlier ones.
pub(super) fn plan(inverse: &Inverse, source: [usize; 2], mut taps: Vec<Tap>) -> Plan {
    thread_local! {
        static WINDOW: RefCell<Window> = RefCell::default();
    }
    let [width, height] = inverse.size();
    taps.resize(width * height, Tap::default());
    let spans: Vec<_> = taps
        .par_chunks_mut(PIECE * width.max(1))
        .enumerate()
        .map(|(index, taps)| {
            let piece = Piece { inverse, source, first: index * PIECE, taps };
            WINDOW.with_borrow_mut(|window| piece.fill(window))
        })
        .collect();
    Plan::with_spans(taps, None, spans.into_iter().flatten().collect())
}

/// Columns of a row that follow one another.
type Run = Range<u32>;

/// Rows that follow one another, and their answered runs.
#[derive(Debug, Default)]
struct Band {
    rows: InverseRows,
    answered: Vec<Vec<Run>>,
}

impl Band {
    fn sample(&mut self, inverse: &Inverse, rows: Range<usize>) {
        inverse.sample(rows, &mut self.rows);
        self.answered.clear();
        self.answered.extend(inverse.uv(&self.rows).chunks(inverse.size()[0]).map(spans_of_row));
    }
}

/// The bands that are at hand.
#[derive(Debug, Default)]
struct Window {
    bands: [Band; 3],
}

/// A row's uv and answered runs; nothing beyond the display.
#[derive(Clone, Copy, Default)]
struct Line<'a> {
    uv: &'a [[f64; 2]],
    answered: &'a [Run],
}

impl Window {
    fn line<'a>(&'a self, inverse: &'a Inverse, row: Option<usize>) -> Line<'a> {
        let width = inverse.size()[0];
        let of = |row: usize| {
            let band = self.bands.iter().find(|band| band.rows.range().contains(&row))?;
            let index = row - band.rows.range().start;
            let uv = &inverse.uv(&band.rows)[index * width..(index + 1) * width];
            Some(Line { uv, answered: &band.answered[index] })
        };
        row.and_then(of).unwrap_or_default()
    }
}

/// A part of the display that one thread makes the taps of.
struct Piece<'a> {
    inverse: &'a Inverse,
    source: [usize; 2],
    first: usize,
    taps: &'a mut [Tap],
}

impl Piece<'_> {
    /// Makes the taps; the runs of columns that have one, row by row.
    fn fill(mut self, window: &mut Window) -> Vec<Vec<Run>> {
        let [width, height] = self.inverse.size();
        let end = self.first + self.taps.len() / width;
        for band in &mut window.bands {
            band.sample(self.inverse, 0..0);
        }
        let bands: Vec<_> =
            (self.first..end).step_by(BAND).map(|start| start..end.min(start + BAND)).collect();
        let whole = |runs: &Vec<Run>| *runs == std::array::from_ref(&(0..width as u32));
        let mut spans = Vec::with_capacity(end - self.first);
        // The rows above the piece have the first place in the window, and its bands those that follow, round and round.
        for (index, rows) in bands.iter().enumerate() {
            let band = &mut window.bands[(index + 1) % 3];
            band.sample(self.inverse, rows.clone());
            let taps = &mut self.taps[(rows.start - self.first) * width..];
            tap_row(self.inverse.uv(&band.rows), self.source, taps);
            if index > 0 {
                self.widen(&bands[index - 1], window, &mut spans);
            } else if !band.answered.iter().take(REACH).all(whole) {
                let above = self.first.saturating_sub(REACH)..self.first;
                window.bands[0].sample(self.inverse, above);
            }
        }
        let below = (bands.len() + 1) % 3;
        let last = &window.bands[bands.len() % 3];
        let cut = !last.answered.iter().rev().take(REACH).all(whole);
        let rows = if cut { end..height.min(end + REACH) } else { 0..0 };
        window.bands[below].sample(self.inverse, rows);
        if let Some(rows) = bands.last() {
            self.widen(rows, window, &mut spans);
        }
        spans
    }

    /// Adds the ring to rows whose neighbours are at hand.
    fn widen(&mut self, rows: &Range<usize>, window: &Window, spans: &mut Vec<Vec<Run>>) {
        let width = self.inverse.size()[0];
        let mut ring = Vec::new();
        for row in rows.clone() {
            let lines: [Line<'_>; 2 * REACH + 1] =
                std::array::from_fn(|i| window.line(self.inverse, (row + i).checked_sub(REACH)));
            let near = [-1, 0, 1].map(|down| lines[REACH.wrapping_add_signed(down)].answered);
            let wide = widened(near, width as u32);
            for run in gaps(&wide, near[1]) {
                let columns = run.start as usize..run.end as usize;
                ring.clear();
                ring.extend(columns.clone().map(|column| {
                    let uv = |right, down| {
                        let line = lines[REACH.wrapping_add_signed(down)].uv;
                        let uv = line.get(column.wrapping_add_signed(right)).copied();
                        uv.map(to_drawn_precision)
                    };
                    continued(uv).unwrap_or([f64::NAN; 2])
                }));
                let start = (row - self.first) * width;
                let taps = &mut self.taps[start + columns.start..start + columns.end];
                tap_row(&ring, self.source, taps);
            }
            spans.push(wide);
        }
    }
}

/// The columns, of a row and of those above and below it, that are in runs or beside one.
fn widened(near: [&[Run]; 3], width: u32) -> Vec<Run> {
    let mut all: Vec<Run> = near
        .into_iter()
        .flatten()
        .map(|run| run.start.saturating_sub(1)..width.min(run.end + 1))
        .collect();
    all.sort_unstable_by_key(|run| run.start);
    all.dedup_by(|next, run| {
        let touches = next.start <= run.end;
        if touches {
            run.end = run.end.max(next.end);
        }
        touches
    });
    all
}

/// What of wider runs is not in narrower ones, which lie within them.
fn gaps(wide: &[Run], narrow: &[Run]) -> Vec<Run> {
    let mut narrow = narrow.iter().peekable();
    let mut gaps = Vec::new();
    for run in wide {
        let mut start = run.start;
        while let Some(inner) = narrow.next_if(|inner| inner.start < run.end) {
            gaps.push(start..inner.start);
            start = inner.end;
        }
        gaps.push(start..run.end);
    }
    gaps.retain(|gap| !gap.is_empty());
    gaps
}

#[cfg(test)]
mod tests {
    use crate::geometry::Shape;
    use crate::map::{Accuracy, Inverse, InverseRows, Map, Status, invert};
    use crate::picture::{Drive, Filter, LightFrame, Warp};
    use crate::scene;
    use crate::transport::Setup;
    use crate::transport::bench_setup::{ACRYLIC, block, element, setup, sphere};
    use crate::transport::tests::ball_mesh;
    use proptest::prelude::*;
    use std::path::Path;
    use std::sync::Arc;

    /// Where two warps differ.
    fn difference(found: &Warp, wanted: &Warp) -> Option<String> {
        if found.size() != wanted.size() {
            return Some(format!("{:?}, not {:?}", found.size(), wanted.size()));
        }
        let [width, height] = found.size();
        for row in 0..height {
            let spans = [found, wanted].map(|warp| warp.plan.spans(row).collect::<Vec<_>>());
            if spans[0] != spans[1] {
                return Some(format!("row {row}: {:?}, not {:?}", spans[0], spans[1]));
            }
            for columns in &spans[0] {
                let pixels = row * width + columns.start..row * width + columns.end;
                let [a, b] = [found, wanted].map(|warp| warp.plan.taps(pixels.clone()));
                if a != b {
                    return Some(format!("row {row}, columns {columns:?}: {a:?}, not {b:?}"));
                }
            }
        }
        None
    }

    #[test]
    fn an_inverse_is_warped_as_its_map_is_whatever_the_memory_held() {
        // Several sheets, pixels by themselves, holes; and seen through a mesh.
        let mesh = Shape::Mesh(Arc::new(ball_mesh(25.0, true)));
        let cube = block(50.0, 50.0, 50.0);
        let made = [
            setup(40.0, vec![element(sphere(25.0), ACRYLIC, [0.0; 3], [0.0; 3], 1)]),
            setup(30.0, vec![element(cube, ACRYLIC, [0.0; 3], [0.0, 15.8, 0.0], 1)]),
            setup(30.0, vec![element(mesh, ACRYLIC, [0.0; 3], [0.0; 3], 1)]),
        ];
        // A part of the light passes the plate by.
        let made =
            made.into_iter().zip([[131, 197], [64, 111], [40, 30]]).map(|(mut setup, size)| {
                setup.plate.rectangle.size = [25.0; 2];
                Setup { resolution: size, ..setup }
            });
        let paper = ["sphere", "cube", "cylinder", "bent-mirror-convex"].map(|name| {
            let scenes = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes/paper");
            let loaded = scene::load(&scenes.join(name).with_extension("toml")).unwrap();
            Setup { resolution: [320, 180], ..Setup::new(&loaded).unwrap() }
        });
        let source = [90, 71];
        let (mut old, mut ringed) = (None, 0);
        for setup in made.chain(paper) {
            let (map, effort) = invert(&setup, Accuracy::default());
            let inverse = Inverse::new(&setup, Accuracy::default());
            assert_eq!((inverse.size(), inverse.effort()), (setup.resolution, effort));
            let bits =
                |uv: &[[f64; 2]]| uv.iter().map(|uv| uv.map(f64::to_bits)).collect::<Vec<_>>();
            let mut rows = InverseRows::default();
            inverse.sample(7..12, &mut rows);
            assert_eq!(
                bits(inverse.uv(&rows)),
                bits(&map.uv[7 * setup.resolution[0]..12 * setup.resolution[0]])
            );
            let found = Warp::of_inverse(&inverse, source, old).unwrap();
            let wanted = Warp::new(&map, source, Filter::Bilinear).unwrap();
            let drawn = |row| wanted.plan.spans(row).map(|span| span.len()).sum::<usize>();
            let covered = map.status.iter().filter(|status| status.is_answered()).count();
            ringed += usize::from((0..map.height).map(drawn).sum::<usize>() > covered);
            assert_eq!(difference(&found, &wanted), None);
            old = Some(found);
        }
        // Not every display has dark pixels, but most.
        assert!(ringed >= 5, "{ringed}");
        let inverse = Inverse::new(&setup(40.0, vec![]), Accuracy::default());
        assert!(Warp::of_inverse(&inverse, [0, 8], None).is_err());
    }

    /// A map of uneven uv with pixels here and there and rectangles of answers and holes.
    fn made_up() -> impl Strategy<Value = Map> {
        // One row or column, ends in the middle of a band, several pieces.
        let size = (
            prop_oneof![1usize..4, 1usize..40],
            prop_oneof![1usize..10, 1usize..200, prop::sample::select(vec![64, 65, 66, 127])],
        );
        let rectangle = (0.0..1.0, 0.0..1.0, 0.0..0.6, 0.0..0.6, any::<bool>());
        let rectangles = prop::collection::vec(rectangle, 0..6);
        let singles = prop_oneof![Just(0u32), Just(4), Just(300)];
        (size, rectangles, singles, any::<bool>(), any::<u32>()).prop_map(
            |((width, height), rectangles, singles, answered, seed)| {
                let mut map = Map::identity(width, height);
                for i in 0..width * height {
                    let [s, t] = map.uv[i];
                    let chance = (i as u32 ^ seed).wrapping_mul(2_654_435_761).rotate_left(15);
                    let chance = chance.wrapping_mul(2_246_822_519) >> 22;
                    let within = |&&(left, low, wide, high, _): &&(f64, f64, f64, f64, bool)| {
                        (left..left + wide).contains(&s) && (low..low + high).contains(&t)
                    };
                    let last = rectangles.iter().rev().find(within);
                    let answered = last.map_or(answered, |rectangle| rectangle.4);
                    map.uv[i] = [0.9 * s * s + 0.05 * t, t - 1e-4 * f64::from(chance)];
                    if answered == (chance < singles) {
                        (map.uv[i], map.status[i]) = ([f64::NAN; 2], Status::Outside);
                    }
                }
                map
            },
        )
    }

    proptest! {
        #[test]
        fn whatever_is_covered_the_warp_is_that_of_the_map(maps in [made_up(), made_up()]) {
            let (source, mut old) = ([90, 71], None);
            for map in maps {
                let wanted = Warp::new(&map, source, Filter::Bilinear).unwrap();
                let found = Warp::of_inverse(&Inverse::of_map(map), source, old).unwrap();
                prop_assert_eq!(difference(&found, &wanted), None);
                old = Some(found);
            }
        }
    }

    #[test]
    fn a_display_without_answers_or_pixels_stays_dark() {
        for [width, height] in [[0, 0], [0, 5], [5, 0], [7, 70]] {
            let inverse = Inverse::of_map(Map::unanswered(width, height));
            let warp = Warp::of_inverse(&inverse, [3, 2], None).unwrap();
            let mut shown = vec![77; width * height * 3];
            let mut light = LightFrame::default();
            light.decode(&[200; 18], 3).unwrap();
            warp.apply_light(&light, 3, &Drive::default(), &mut shown).unwrap();
            assert!(shown.iter().all(|&sample| sample == 0));
        }
    }
}
