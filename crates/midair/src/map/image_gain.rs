//! The gain as a function of the image point.

use super::Gain;

/// What is left of the light that comes to the viewpoint through each point of the image, at the nodes of a regular grid over it.
///
/// For one viewpoint there is one path through each image point, whatever the display: this says the same as a [`Gain`], which
/// samples it at the image points of the display's pixels, in far fewer samples.
#[derive(Clone, Debug, PartialEq)]
pub struct ImageGain {
    /// The nodes: those at the edges lie on the image's edges, row 0 at v = 1. At least two in each direction. NaN where there is no
    /// answer.
    pub nodes: Gain,
}

impl ImageGain {
    /// The share of R, G, B at an image point, bilinear between the nodes; that of the nearest edge for points beyond the image.
    pub fn at(&self, [u, v]: [f64; 2]) -> [f32; 3] {
        let (columns, rows) = (self.nodes.width, self.nodes.height);
        let (column, x) = cell(u, columns - 1);
        let (row, y) = cell(1.0 - v, rows - 1);
        let node = |dx: usize, dy: usize| self.nodes.rgb[(row + dy) * columns + column + dx];
        let across = |dy: usize| mix3(node(0, dy), node(1, dy), x);
        mix3(across(0), across(1), y)
    }
}

/// Which of the cells along one side a place in \[0, 1\] lies in, and how far on in it.
pub(crate) fn cell(place: f64, cells: usize) -> (usize, f32) {
    let place = place.clamp(0.0, 1.0) * cells as f64;
    let index = (place as usize).min(cells - 1);
    (index, (place - index as f64) as f32)
}

fn mix3(a: [f32; 3], b: [f32; 3], t: f32) -> [f32; 3] {
    std::array::from_fn(|c| a[c] + t * (b[c] - a[c]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bilinear_gain_is_told_exactly_everywhere() {
        let truth = |u: f64, v: f64| [0.2 + 0.5 * u, 0.9 - 0.4 * v, 0.3 + 0.1 * u * v];
        let (width, height) = (5, 4);
        let rgb = (0..width * height)
            .map(|i| {
                let (u, v) = ((i % width) as f64 / 4.0, 1.0 - (i / width) as f64 / 3.0);
                truth(u, v).map(|share| share as f32)
            })
            .collect();
        let gain = ImageGain { nodes: Gain { width, height, rgb } };
        for i in 0..=70 {
            let (u, v) = (f64::from(i) / 70.0, f64::from(i * 37 % 71) / 70.0);
            for (found, exact) in gain.at([u, v]).into_iter().zip(truth(u, v)) {
                // Single precision, a few operations.
                assert!((f64::from(found) - exact).abs() < 5e-7, "{u} {v}");
            }
        }
        assert_eq!(gain.at([-0.5, 2.0]), gain.at([0.0, 1.0]));
    }
}
