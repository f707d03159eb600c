//! The view as a linear function of the display's pixels, as a sparse matrix and its transpose.

use super::ViewSamples;
use crate::media::interpolate::bilinear_taps;
use rayon::prelude::*;

/// Compressed sparse rows.
pub(super) struct SparseRows {
    /// `starts[i]..starts[i + 1]` are row i's entries.
    starts: Vec<u32>,
    columns: Vec<u32>,
    weights: Vec<f32>,
}

/// Rows that a task of the thread pool takes at a time.
const BAND: usize = 2048;

impl SparseRows {
    /// The view's rows: each view pixel is the mean of its samples, a sample the bilinear
    /// interpolation of the display's pixels (the edge goes on beyond the outermost centres).
    /// A sample without st, or off the display, is dark.
    pub(super) fn from_view(samples: &ViewSamples, width: usize, height: usize) -> Self {
        let bands: Vec<_> = samples
            .st
            .par_chunks(samples.samples_per_pixel * BAND)
            .map(|band| {
                let (mut ends, mut columns, mut weights) = (Vec::new(), Vec::new(), Vec::new());
                for pixel in band.chunks_exact(samples.samples_per_pixel) {
                    append_view_pixel(pixel, width, height, &mut columns, &mut weights);
                    ends.push(columns.len() as u32);
                }
                (ends, columns, weights)
            })
            .collect();
        let count = bands.iter().map(|band| band.1.len()).sum();
        let mut starts = Vec::with_capacity(samples.width * samples.height + 1);
        let (mut columns, mut weights) = (Vec::with_capacity(count), Vec::with_capacity(count));
        starts.push(0);
        for band in bands {
            let before = columns.len() as u32;
            starts.extend(band.0.iter().map(|end| before + end));
            columns.extend_from_slice(&band.1);
            weights.extend_from_slice(&band.2);
        }
        Self { starts, columns, weights }
    }

    /// The transpose, with `count` rows: a counting sort by column.
    pub(super) fn transposed(&self, count: usize) -> Self {
        let mut starts = vec![0u32; count + 1];
        for &column in &self.columns {
            starts[column as usize + 1] += 1;
        }
        for i in 0..count {
            starts[i + 1] += starts[i];
        }
        let mut next = starts.clone();
        let mut columns = vec![0u32; self.columns.len()];
        let mut weights = vec![0f32; self.weights.len()];
        for row in 0..self.starts.len() - 1 {
            for entry in self.starts[row] as usize..self.starts[row + 1] as usize {
                let place = &mut next[self.columns[entry] as usize];
                columns[*place as usize] = row as u32;
                weights[*place as usize] = self.weights[entry];
                *place += 1;
            }
        }
        Self { starts, columns, weights }
    }

    pub(super) fn rows(&self) -> usize {
        self.starts.len() - 1
    }

    /// One row's product with `vector`.
    #[inline]
    fn dot(&self, row: usize, vector: &[[f32; 4]]) -> [f32; 4] {
        let entries = self.starts[row] as usize..self.starts[row + 1] as usize;
        let mut sum = [0.0f32; 4];
        for (&column, &weight) in self.columns[entries.clone()].iter().zip(&self.weights[entries]) {
            let value = &vector[column as usize];
            for c in 0..4 {
                sum[c] += weight * value[c];
            }
        }
        sum
    }

    /// `output[i] = finish(i, row i times vector)`, with the sums that `finish` returns beside.
    pub(super) fn multiply(
        &self,
        vector: &[[f32; 4]],
        output: &mut [[f32; 4]],
        finish: impl Fn(usize, [f32; 4]) -> ([f32; 4], [f64; 4]) + Sync,
    ) -> [f64; 4] {
        let partial: Vec<[f64; 4]> = output
            .par_chunks_mut(BAND)
            .enumerate()
            .map(|(band, chunk)| {
                let mut sums = [0.0; 4];
                for (i, target) in chunk.iter_mut().enumerate() {
                    let row = band * BAND + i;
                    let (value, sum) = finish(row, self.dot(row, vector));
                    *target = value;
                    for c in 0..4 {
                        sums[c] += sum[c];
                    }
                }
                sums
            })
            .collect();
        // In order, so that the result does not depend on the threads.
        partial.iter().fold([0.0; 4], |sum, part| std::array::from_fn(|c| sum[c] + part[c]))
    }

    /// `sum over j of entry(i, j)^2 * scale[j]` for each row i.
    pub(super) fn squared_row_sums(&self, scale: &[[f32; 4]]) -> Vec<[f32; 4]> {
        (0..self.rows())
            .into_par_iter()
            .with_min_len(BAND)
            .map(|row| {
                let entries = self.starts[row] as usize..self.starts[row + 1] as usize;
                let mut sum = [0.0f32; 4];
                for entry in entries {
                    let square = self.weights[entry] * self.weights[entry];
                    let scale = &scale[self.columns[entry] as usize];
                    for c in 0..4 {
                        sum[c] += square * scale[c];
                    }
                }
                sum
            })
            .collect()
    }
}

/// Appends a view pixel's row, entries of the same column added up.
fn append_view_pixel(
    samples: &[[f64; 2]],
    width: usize,
    height: usize,
    columns: &mut Vec<u32>,
    weights: &mut Vec<f32>,
) {
    let first = columns.len();
    let share = 1.0 / samples.len() as f32;
    for &st in samples {
        for (column, weight) in bilinear_taps(st, width, height).into_iter().flatten() {
            if weight == 0.0 {
                continue;
            }
            match columns[first..].iter().position(|&known| known == column) {
                Some(place) => weights[first + place] += weight * share,
                None => {
                    columns.push(column);
                    weights.push(weight * share);
                }
            }
        }
    }
}
