//! The view as a linear function of the display's pixels, as a sparse matrix and its transpose.

use super::ViewRays;
use crate::picture::interpolate::bilinear_taps;
use rayon::prelude::*;

/// Red, green, blue.
pub(super) type Rgb = [f32; 3];

/// A sparse matrix whose rows are read one after the other.
///
/// A view pixel is a mean over a few neighbouring display pixels, so a row is a few runs of columns that follow each other: the
/// first of each and how many are kept, not each column. With weights of 16 bits that is half of what
/// compressed sparse rows take, and its reading is what a step of the solver waits for.
pub(super) struct SparseRows {
    /// Each of [`BAND`] rows, the last of fewer.
    bands: Vec<Band>,
    rows: usize,
}

/// Rows that a task of the thread pool takes at a time.
const BAND: usize = 2048;

/// A weight of 1. The rounding, 8e-6, is made up for by a row's next weight, so that their sum is right.
const ONE: f32 = 65535.0;

#[derive(Default)]
struct Band {
    /// How many runs each row has.
    runs: Vec<u32>,
    /// The first column of each run.
    columns: Vec<u32>,
    /// How many columns each run has.
    lengths: Vec<u8>,
    /// The weights, in units of 1 / [`ONE`].
    weights: Vec<u16>,
}

impl Band {
    /// Appends a row: its columns in ascending order, each once.
    fn push(&mut self, row: impl Iterator<Item = (u32, u16)>) {
        let before = self.columns.len();
        for (column, weight) in row {
            let follows = self.columns.len() > before
                && self.columns.last().zip(self.lengths.last()).is_some_and(|(first, length)| {
                    *length < u8::MAX && first + u32::from(*length) == column
                });
            match self.lengths.last_mut() {
                Some(length) if follows => *length += 1,
                _ => {
                    self.columns.push(column);
                    self.lengths.push(1);
                }
            }
            self.weights.push(weight);
        }
        self.runs.push((self.columns.len() - before) as u32);
    }

    fn shrink(&mut self) {
        self.runs.shrink_to_fit();
        self.columns.shrink_to_fit();
        self.lengths.shrink_to_fit();
        self.weights.shrink_to_fit();
    }

    /// Calls `row` with each row's index in the band and its sum over `term(weight, column)`.
    #[inline]
    fn sums(&self, term: impl Fn(f32, usize) -> Rgb, mut row: impl FnMut(usize, Rgb)) {
        let mut runs = self.columns.iter().zip(&self.lengths);
        let mut weights = &self.weights[..];
        for (index, &count) in self.runs.iter().enumerate() {
            let mut sum = [0.0f32; 3];
            for (&first, &length) in runs.by_ref().take(count as usize) {
                let (run, rest) = weights.split_at(usize::from(length));
                weights = rest;
                for (k, &weight) in run.iter().enumerate() {
                    let term = term(f32::from(weight), first as usize + k);
                    for c in 0..3 {
                        sum[c] += term[c];
                    }
                }
            }
            row(index, sum);
        }
    }

    /// Calls `entry` with each entry's row in the band, column and weight.
    fn entries(&self, mut entry: impl FnMut(usize, u32, u16)) {
        let (mut run, mut at) = (0, 0);
        for (row, &count) in self.runs.iter().enumerate() {
            for _ in 0..count {
                for k in 0..u32::from(self.lengths[run]) {
                    entry(row, self.columns[run] + k, self.weights[at]);
                    at += 1;
                }
                run += 1;
            }
        }
    }
}

impl SparseRows {
    /// The view's rows: each view pixel is the mean of its rays, a ray the bilinear
    /// interpolation of the display's pixels (the edge goes on beyond the outermost centres).
    /// A ray that does not end on the display is dark.
    pub(super) fn from_view(rays: &impl ViewRays, width: usize, height: usize) -> Self {
        let ([columns, lines], each) = (rays.size(), rays.rays_per_pixel());
        let rows = columns * lines;
        let bands = (0..rows.div_ceil(BAND))
            .into_par_iter()
            .map(|band| {
                let pixels = band * BAND..rows.min((band + 1) * BAND);
                let mut ends = vec![[f64::NAN; 2]; pixels.len() * each];
                rays.ends(pixels, &mut ends);
                let mut band = Band::default();
                let mut taps = Vec::new();
                for pixel in ends.chunks_exact(each) {
                    view_pixel(pixel, width, height, &mut taps);
                    band.push(in_units(&taps));
                }
                band.shrink();
                band
            })
            .collect();
        Self { bands, rows }
    }

    /// The transpose, with `count` rows: a counting sort by column.
    pub(super) fn transposed(&self, count: usize) -> Self {
        // Where the next entry of each row goes, counted from its band's first.
        let mut next = vec![0u32; count];
        for band in &self.bands {
            band.entries(|_, column, _| next[column as usize] += 1);
        }
        let mut sorted: Vec<Vec<(u32, u16)>> = next
            .chunks_mut(BAND)
            .map(|counts| {
                let mut before = 0;
                for count in counts {
                    before += std::mem::replace(count, before);
                }
                vec![(0, 0); before as usize]
            })
            .collect();
        for (index, band) in self.bands.iter().enumerate() {
            band.entries(|row, column, weight| {
                let place = &mut next[column as usize];
                sorted[column as usize / BAND][*place as usize] =
                    ((index * BAND + row) as u32, weight);
                *place += 1;
            });
        }
        // Now each row's place is where it ends.
        let bands = sorted
            .into_par_iter()
            .zip(next.par_chunks(BAND))
            .map(|(entries, ends)| {
                let mut band = Band::default();
                let mut start = 0;
                for &end in ends {
                    band.push(entries[start..end as usize].iter().copied());
                    start = end as usize;
                }
                band.shrink();
                band
            })
            .collect();
        Self { bands, rows: count }
    }

    pub(super) fn rows(&self) -> usize {
        self.rows
    }

    /// `output[i] = finish(i, row i times vector, output[i])`, with the sums that `finish` returns beside.
    pub(super) fn multiply(
        &self,
        vector: &[Rgb],
        output: &mut [Rgb],
        finish: impl Fn(usize, Rgb, Rgb) -> (Rgb, [f64; 3]) + Sync,
    ) -> [f64; 3] {
        let partial: Vec<[f64; 3]> = output
            .par_chunks_mut(BAND)
            .zip(&self.bands)
            .enumerate()
            .map(|(index, (chunk, band))| {
                let mut sums = [0.0; 3];
                let term = |weight: f32, column: usize| vector[column].map(|value| weight * value);
                band.sums(term, |i, sum| {
                    let product = sum.map(|s| s * (1.0 / ONE));
                    let (value, sum) = finish(index * BAND + i, product, chunk[i]);
                    chunk[i] = value;
                    for c in 0..3 {
                        sums[c] += sum[c];
                    }
                });
                sums
            })
            .collect();
        // In order, so that the result does not depend on the threads.
        partial.iter().fold([0.0; 3], |sum, part| std::array::from_fn(|c| sum[c] + part[c]))
    }

    /// `finish(sum over j of entry(i, j)^2 * scale(j))` for each row i.
    pub(super) fn squared_row_sums<T: Send>(
        &self,
        scale: impl Fn(usize) -> Rgb + Sync,
        finish: impl Fn(Rgb) -> T + Sync,
    ) -> Vec<T> {
        let bands: Vec<Vec<T>> = self
            .bands
            .par_iter()
            .map(|band| {
                let mut values = Vec::with_capacity(band.runs.len());
                let term =
                    |weight: f32, column: usize| scale(column).map(|scale| weight * weight * scale);
                band.sums(term, |_, sum| values.push(finish(sum.map(|s| s * (1.0 / (ONE * ONE))))));
                values
            })
            .collect();
        bands.into_iter().flatten().collect()
    }
}

/// A view pixel's row, by ascending column, entries of the same column added up.
fn view_pixel(ends: &[[f64; 2]], width: usize, height: usize, taps: &mut Vec<(u32, f32)>) {
    taps.clear();
    let share = 1.0 / ends.len() as f32;
    for &st in ends {
        for (column, weight) in bilinear_taps(st, width, height).into_iter().flatten() {
            match taps.iter_mut().find(|tap| tap.0 == column) {
                Some(known) => known.1 += weight * share,
                None => taps.push((column, weight * share)),
            }
        }
    }
    taps.sort_unstable_by_key(|tap| tap.0);
}

/// The weights in units, each with what the ones before it lack; those of none left out.
fn in_units(taps: &[(u32, f32)]) -> impl Iterator<Item = (u32, u16)> {
    let mut owed = 0.0;
    taps.iter().filter_map(move |&(column, weight)| {
        let exact = weight * ONE + owed;
        let units = exact.round().clamp(0.0, ONE);
        owed = exact - units;
        (units > 0.0).then_some((column, units as u16))
    })
}
