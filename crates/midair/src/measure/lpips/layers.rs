//! The layers of AlexNet: convolution, rectifier, maximum.

use ndarray::linalg::general_mat_mul;
use ndarray::{Array2, ArrayView2};
use rayon::prelude::*;

/// Channels of one picture: channel-major, each row-major from the top.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Tensor {
    pub channels: usize,
    pub height: usize,
    pub width: usize,
    pub values: Vec<f32>,
}

/// A convolution (cross-correlation, as networks mean it) with a rectifier after it.
#[derive(Clone, Debug)]
pub(super) struct Convolution {
    pub outputs: usize,
    pub inputs: usize,
    /// Kernel height and width are equal.
    pub size: usize,
    /// outputs x inputs x size x size.
    pub kernel: Vec<f32>,
    /// One for each output.
    pub bias: Vec<f32>,
    pub stride: usize,
    /// Zeros on every side.
    pub padding: usize,
}

/// Output pixels to a matrix product: their columns of input (up to 3456 values each) then stay
/// in a core's second-level cache together with a kernel block.
const PIXELS_AT_ONCE: usize = 512;

impl Convolution {
    /// max(0, kernel * input + bias): the input's patches are laid out as columns, and a matrix product
    /// does the rest.
    pub fn apply(&self, input: &Tensor) -> Tensor {
        let reach = |length: usize| (length + 2 * self.padding - self.size) / self.stride + 1;
        let (height, width) = (reach(input.height), reach(input.width));
        let (pixels, depth) = (height * width, self.inputs * self.size * self.size);
        let chunks: Vec<Array2<f32>> = (0..pixels.div_ceil(PIXELS_AT_ONCE))
            .into_par_iter()
            .map(|chunk| {
                let from = chunk * PIXELS_AT_ONCE;
                let count = PIXELS_AT_ONCE.min(pixels - from);
                let mut columns = Array2::<f32>::zeros((depth, count));
                for (row, mut values) in columns.rows_mut().into_iter().enumerate() {
                    let (channel, tap) =
                        (row / (self.size * self.size), row % (self.size * self.size));
                    let (down, right) = (tap / self.size, tap % self.size);
                    let plane = &input.values[channel * input.height * input.width..];
                    for (at, value) in values.iter_mut().enumerate() {
                        let (y, x) = ((from + at) / width, (from + at) % width);
                        // Less than the padding is above or left of the picture: wraps beyond it.
                        let y = (y * self.stride + down).wrapping_sub(self.padding);
                        let x = (x * self.stride + right).wrapping_sub(self.padding);
                        if y < input.height && x < input.width {
                            *value = plane[y * input.width + x];
                        }
                    }
                }
                let mut out = Array2::<f32>::zeros((self.outputs, count));
                // The shape is that of the kernel, which was checked when it was read.
                if let Ok(kernel) = ArrayView2::from_shape((self.outputs, depth), &self.kernel) {
                    general_mat_mul(1.0, &kernel, &columns, 0.0, &mut out);
                }
                out
            })
            .collect();
        let mut values = vec![0.0; self.outputs * pixels];
        values.par_chunks_mut(pixels).enumerate().for_each(|(output, plane)| {
            let rows = chunks.iter().flat_map(|chunk| chunk.row(output).into_iter());
            for (value, sum) in plane.iter_mut().zip(rows) {
                *value = (sum + self.bias[output]).max(0.0);
            }
        });
        Tensor { channels: self.outputs, height, width, values }
    }
}

impl Tensor {
    /// Maxima of 3 x 3 at every second place; what is left at the far borders does not count.
    pub fn pooled(&self) -> Self {
        let reach = |length: usize| (length - 3) / 2 + 1;
        let (height, width) = (reach(self.height), reach(self.width));
        let mut values = vec![0.0; self.channels * height * width];
        let planes = self.values.par_chunks(self.height * self.width);
        values.par_chunks_mut(height * width).zip(planes).for_each(|(out, plane)| {
            for (at, value) in out.iter_mut().enumerate() {
                let (top, left) = (2 * (at / width), 2 * (at % width));
                let rows = top..top + 3;
                let maximum = |row: usize| {
                    let row = &plane[row * self.width..(row + 1) * self.width];
                    row[left..left + 3].iter().copied().fold(f32::MIN, f32::max)
                };
                *value = rows.map(maximum).fold(f32::MIN, f32::max);
            }
        });
        Self { channels: self.channels, height, width, values }
    }

    /// Divides the features at each place by their length, plus LPIPS' 1e-10.
    pub fn normalise(&mut self) {
        let pixels = self.height * self.width;
        let mut lengths = vec![0.0_f32; pixels];
        for plane in self.values.chunks(pixels) {
            for (length, value) in lengths.iter_mut().zip(plane) {
                *length += value * value;
            }
        }
        lengths.iter_mut().for_each(|length| *length = 1.0 / (length.sqrt() + 1e-10));
        for plane in self.values.chunks_mut(pixels) {
            for (value, length) in plane.iter_mut().zip(&lengths) {
                *value *= length;
            }
        }
    }

    /// Mean over places of the squared differences, weighted per channel.
    pub fn weighted_difference(&self, other: &Self, weights: &[f32]) -> f64 {
        let pixels = self.height * self.width;
        let planes = self.values.par_chunks(pixels).zip(other.values.par_chunks(pixels));
        let sums: Vec<f64> = planes
            .zip(weights)
            .map(|((a, b), &weight)| {
                let squares = a.iter().zip(b).map(|(a, b)| f64::from(a - b).powi(2));
                f64::from(weight) * squares.sum::<f64>()
            })
            .collect();
        sums.iter().sum::<f64>() / pixels as f64
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn numbers(count: usize, seed: usize) -> Vec<f32> {
        (0..count).map(|i| ((i * 7919 + seed * 104_729) % 1009) as f32 / 504.5 - 1.0).collect()
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(32))]
        #[test]
        fn a_convolution_is_its_sum(
            (inputs, outputs, size) in (1_usize..4, 1_usize..5, 1_usize..6),
            (stride, padding) in (1_usize..5, 0_usize..3),
            (height, width) in (6_usize..40, 6_usize..40),
            seed in 0_usize..1000,
        ) {
            let layer = Convolution {
                outputs, inputs, size, stride, padding,
                kernel: numbers(outputs * inputs * size * size, seed),
                bias: numbers(outputs, seed + 1),
            };
            let input =
                Tensor { channels: inputs, height, width, values: numbers(inputs * height * width, seed + 2) };
            let found = layer.apply(&input);
            prop_assert_eq!(found.height, (height + 2 * padding - size) / stride + 1);
            for output in 0..outputs {
                for y in 0..found.height {
                    for x in 0..found.width {
                        let mut sum = f64::from(layer.bias[output]);
                        for (c, dy, dx) in (0..inputs).flat_map(|c| {
                            (0..size).flat_map(move |dy| (0..size).map(move |dx| (c, dy, dx)))
                        }) {
                            let (iy, ix) = (y * stride + dy, x * stride + dx);
                            if (padding..padding + height).contains(&iy) && (padding..padding + width).contains(&ix) {
                                let value = input.values[(c * height + iy - padding) * width + ix - padding];
                                let weight = layer.kernel[((output * inputs + c) * size + dy) * size + dx];
                                sum += f64::from(value) * f64::from(weight);
                            }
                        }
                        let value = found.values[(output * found.height + y) * found.width + x];
                        // Up to 75 products below one, summed in single precision.
                        prop_assert!((f64::from(value) - sum.max(0.0)).abs() < 1e-5);
                    }
                }
            }
        }
    }

    #[test]
    fn pooling_takes_whole_windows() {
        let tensor = |height, width| Tensor {
            channels: 2,
            height,
            width,
            values: (0..2 * height * width).map(|i| i as f32).collect(),
        };
        // Rows of 6: windows at 0 and 2 (PyTorch's formula: floor of (6 - 3) / 2, plus 1).
        let pooled = tensor(3, 6).pooled();
        assert_eq!((pooled.width, pooled.values), (2, vec![14.0, 16.0, 32.0, 34.0]));
        assert_eq!(tensor(7, 7).pooled().width, 3);
    }

    #[test]
    fn directions_are_compared_and_not_lengths() {
        let tensor = |values: &[f32]| {
            let mut tensor = Tensor { channels: 2, height: 1, width: 2, values: values.to_vec() };
            tensor.normalise();
            tensor
        };
        // Place 0: (3, 4) and (4, 3) become (.6, .8) and (.8, .6); place 1: parallel.
        let (a, b) = (tensor(&[3.0, 1.0, 4.0, 2.0]), tensor(&[4.0, 5.0, 3.0, 10.0]));
        // (1 * .04 + 10 * .04 + 0) / 2 places.
        assert!((a.weighted_difference(&b, &[1.0, 10.0]) - 0.22).abs() < 1e-6);
        let nothing = tensor(&[0.0; 4]);
        assert!(nothing.values.iter().all(|value| *value == 0.0));
    }
}
