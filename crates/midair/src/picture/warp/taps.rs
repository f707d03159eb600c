//! What of a warp depends on the map alone.

use super::Filter;
use super::bilinear::{spans_of_row, tap_row};
use crate::map::Map;
use crate::picture::interpolate::cubic_weights;
use crate::picture::resample::Footprint;
use rayon::prelude::*;
use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};

/// Bits of a bilinear fraction and of every weight.
pub(super) const WEIGHT_BITS: u32 = 14;
/// One, as a weight.
pub(super) const ONE: i32 = 1 << WEIGHT_BITS;
/// Steps of a cubic sample's fraction: 1/1024 px moves a sample by at most 255 * 1.25 / 2048, 0.16 codes.
const CUBIC_STEPS: usize = 1024;

/// One sample of the source: the first pixel that it needs, and how far on it lies.
///
/// For bilinear sampling the first of 2 x 2 pixels, and 14-bit fractions. For cubic sampling the first of 4 x 4,
/// and indices into [`CubicTables`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(C)]
pub(super) struct Tap {
    pub(super) pixel: u32,
    pub(super) x: u16,
    pub(super) y: u16,
}

/// Taps are asked for so many ahead of their use: a kilobyte. They lie in memory one after another, but the processor by itself looks
/// ahead only within a page, and each 512 taps begin a new one. Without it warping takes twice as long.
#[cfg(target_arch = "x86_64")]
pub(super) const AHEAD: usize = 128;

/// Every output pixel's samples, and which pixels have any.
#[derive(Clone, Debug)]
pub(super) struct Plan {
    taps: Vec<Tap>,
    /// Where each pixel's samples start, if any pixel has more than one.
    starts: Option<Vec<u32>>,
    /// Covered runs of columns, row after row, and where each row's start.
    spans: Vec<Range<u32>>,
    row_spans: Vec<usize>,
}

impl Plan {
    pub(super) fn new(map: &Map, source: [usize; 2], filter: Filter) -> Self {
        match filter {
            Filter::Bilinear => Self::bilinear(map, source),
            Filter::Sharp => {
                let footprint =
                    |column: usize, row: usize| Footprint::new(map, source, column, row);
                // Most maps magnify everywhere, and then no list is needed: tried first, given up at
                // the first pixel that has more samples.
                let crowded = AtomicBool::new(false);
                let plan = Self::single(map, |column, row| {
                    if crowded.load(Ordering::Relaxed) {
                        return None;
                    }
                    let footprint = footprint(column, row)?;
                    if footprint.count() > 1 {
                        crowded.store(true, Ordering::Relaxed);
                    }
                    footprint.samples().next().map(|at| cubic_tap(at, source))
                });
                if crowded.into_inner() { Self::several(map, source, footprint) } else { plan }
            }
        }
    }

    fn bilinear(map: &Map, source: [usize; 2]) -> Self {
        let mut taps = vec![Tap::default(); map.width * map.height];
        let line = map.width.max(1);
        let spans = taps
            .par_chunks_mut(line)
            .enumerate()
            .map_init(Vec::new, |uv, (row, taps)| {
                uv.clear();
                uv.extend((0..map.width).map(|x| map.drawn(x, row).unwrap_or([f64::NAN; 2])));
                tap_row(uv, source, taps);
                spans_of_row(uv)
            })
            .collect();
        Self::with_spans(taps, None, spans)
    }

    /// The memory of a plan that is no longer needed.
    pub(super) fn into_taps(self) -> Vec<Tap> {
        self.taps
    }

    /// Each pixel has one sample or none; a pixel's number is its sample's index.
    fn single(map: &Map, tap: impl Fn(usize, usize) -> Option<Tap> + Sync) -> Self {
        let mut taps = vec![Tap::default(); map.width * map.height];
        let spans = taps
            .par_chunks_mut(map.width.max(1))
            .enumerate()
            .map(|(row, line)| {
                let mut spans = Vec::new();
                for (column, target) in line.iter_mut().enumerate() {
                    if let Some(tap) = tap(column, row) {
                        *target = tap;
                        extend_spans(&mut spans, column as u32);
                    }
                }
                spans
            })
            .collect();
        Self::with_spans(taps, None, spans)
    }

    /// Some pixels have several samples: their places are kept.
    fn several(
        map: &Map,
        source: [usize; 2],
        footprint: impl Fn(usize, usize) -> Option<Footprint> + Sync,
    ) -> Self {
        let rows: Vec<_> = (0..map.height)
            .into_par_iter()
            .map(|row| {
                let mut taps = Vec::with_capacity(map.width);
                let mut ends = Vec::with_capacity(map.width);
                let mut spans = Vec::new();
                for column in 0..map.width {
                    if let Some(footprint) = footprint(column, row) {
                        taps.extend(footprint.samples().map(|at| cubic_tap(at, source)));
                        extend_spans(&mut spans, column as u32);
                    }
                    ends.push(taps.len() as u32);
                }
                (taps, ends, spans)
            })
            .collect();
        let mut taps = Vec::with_capacity(rows.iter().map(|row| row.0.len()).sum());
        let mut starts = Vec::with_capacity(map.width * map.height + 1);
        starts.push(0);
        let mut spans = Vec::with_capacity(rows.len());
        for (row_taps, ends, row_spans) in rows {
            let before = taps.len() as u32;
            taps.extend_from_slice(&row_taps);
            starts.extend(ends.iter().map(|end| before + end));
            spans.push(row_spans);
        }
        Self::with_spans(taps, Some(starts), spans)
    }

    /// Samples, where each pixel's start if any has more than one, and each row's covered runs of columns.
    pub(super) fn with_spans(
        taps: Vec<Tap>,
        starts: Option<Vec<u32>>,
        rows: Vec<Vec<Range<u32>>>,
    ) -> Self {
        let mut row_spans = vec![0];
        row_spans.extend(rows.iter().scan(0, |end, row| {
            *end += row.len();
            Some(*end)
        }));
        Self { taps, starts, spans: rows.into_iter().flatten().collect(), row_spans }
    }

    /// The covered runs of columns in a row.
    pub(super) fn spans(&self, row: usize) -> impl Iterator<Item = Range<usize>> {
        let spans = &self.spans[self.row_spans[row]..self.row_spans[row + 1]];
        spans.iter().map(|span| span.start as usize..span.end as usize)
    }

    /// The samples of pixels that have one each.
    pub(super) fn taps(&self, pixels: Range<usize>) -> &[Tap] {
        &self.taps[pixels]
    }

    /// Whether no pixel has more than one sample, so that [`Self::taps`] tells all.
    pub(super) fn is_single(&self) -> bool {
        self.starts.is_none()
    }

    /// The samples of one pixel.
    #[inline(always)]
    pub(super) fn samples(&self, pixel: usize) -> &[Tap] {
        match &self.starts {
            None => &self.taps[pixel..pixel + 1],
            Some(starts) => &self.taps[starts[pixel] as usize..starts[pixel + 1] as usize],
        }
    }
}

/// Adds a column to the runs of those before it.
fn extend_spans(spans: &mut Vec<Range<u32>>, column: u32) {
    match spans.last_mut() {
        Some(span) if span.end == column => span.end += 1,
        _ => spans.push(column..column + 1),
    }
}

/// The first of two neighbouring pixels and the way from there to the coordinate.
fn split(coordinate: f64, size: usize) -> (usize, f64) {
    let x = coordinate.clamp(0.0, (size - 1) as f64);
    let below = (x as usize).min(size.saturating_sub(2));
    (below, x - below as f64)
}

fn cubic_tap([x, y]: [f64; 2], source: [usize; 2]) -> Tap {
    let (first_column, x) = cubic_axis(x, source[0]);
    let (first_row, y) = cubic_axis(y, source[1]);
    Tap { pixel: (first_row * source[0] + first_column) as u32, x, y }
}

/// The first of four pixels and the table row that holds their weights.
fn cubic_axis(coordinate: f64, size: usize) -> (usize, u16) {
    let (below, fraction) = split(coordinate, size);
    let step = (fraction * CUBIC_STEPS as f64 + 0.5) as usize;
    let (edge, first) = if size < 4 {
        // Too few pixels for four taps: the table is made for this size.
        (below, 0)
    } else if below == 0 {
        (1, 0)
    } else if below + 2 == size {
        (2, size - 4)
    } else {
        (0, below - 1)
    };
    (first, (edge * (CUBIC_STEPS + 1) + step) as u16)
}

/// Weights of four pixels in a row (or column) by where among them the sample lies: three parts of 1025 rows,
/// for the interior and for the first and the last gap of the source, where the edge goes on. Two weights of
/// 16 bits in each number, the earlier in the lower half.
#[derive(Clone, Debug)]
pub(super) struct CubicTables {
    pub(super) x: Vec<[i32; 2]>,
    pub(super) y: Vec<[i32; 2]>,
}

/// Packs a row of a table.
fn pack(w: [i16; 4]) -> [i32; 2] {
    [0, 2].map(|i| i32::from(w[i]) & 0xffff | i32::from(w[i + 1]) << 16)
}

/// The weights that a row of a table holds.
#[inline(always)]
pub(super) fn unpack(row: [i32; 2]) -> [i32; 4] {
    let [near, far] = row;
    [i32::from(near as i16), near >> 16, i32::from(far as i16), far >> 16]
}

impl CubicTables {
    pub(super) fn new(source: [usize; 2]) -> Self {
        let [x, y] = source.map(|size| {
            (0..3 * (CUBIC_STEPS + 1))
                .map(|row| pack(cubic_row(row / (CUBIC_STEPS + 1), row % (CUBIC_STEPS + 1), size)))
                .collect()
        });
        Self { x, y }
    }
}

fn cubic_row(edge: usize, step: usize, size: usize) -> [i16; 4] {
    let w = cubic_weights(step as f32 / CUBIC_STEPS as f32);
    // Where the four taps fall among the four pixels that are read.
    let first = if size < 4 { edge as isize - 1 } else { [0, -1, 1][edge] };
    let last = size.min(4) as isize - 1;
    let mut exact = [0.0f32; 4];
    for (i, weight) in w.iter().enumerate() {
        exact[(first + i as isize).clamp(0, last) as usize] += weight;
    }
    let mut fixed = exact.map(|weight| (weight * ONE as f32).round() as i16);
    // They sum to one exactly, so that a constant stays constant.
    let excess = fixed.iter().map(|&w| i32::from(w)).sum::<i32>() - ONE;
    let largest = (0..4).max_by_key(|&i| fixed[i]).unwrap_or(0);
    fixed[largest] -= excess as i16;
    fixed
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cubic_rows_sum_to_one_and_hit_the_pixels() {
        for size in [1, 2, 3, 4, 9] {
            let tables = CubicTables::new([size, 50]);
            for place in 0..size {
                let (first, row) = cubic_axis(place as f64, size);
                let weights = unpack(tables.x[usize::from(row)]);
                let mut expected = [0; 4];
                expected[place - first] = ONE;
                assert_eq!(weights, expected, "pixel {place} of {size}");
            }
            let sums = tables.x.iter().map(|&row| unpack(row).iter().sum::<i32>());
            assert!(sums.into_iter().all(|sum| sum == ONE));
        }
    }
}
