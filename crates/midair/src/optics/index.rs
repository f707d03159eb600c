//! The refractive index of a medium by wavelength.

use super::glass::Glass;
use super::glass_file::GlassFile;
use std::sync::Arc;

/// A refractive index by wavelength.
#[derive(Clone, Debug, PartialEq)]
pub enum Index {
    /// The same for every wavelength.
    Constant(f64),
    /// n = a + b / lambda^2, lambda in micrometres (Cauchy 1836, to its second term).
    Cauchy(f64, f64),
    /// A glass of the catalogue.
    Glass(&'static Glass),
    /// A glass file.
    File(Arc<GlassFile>),
}

impl Index {
    /// The index at a wavelength in micrometres.
    pub fn at(&self, wavelength: f64) -> f64 {
        match self {
            Self::Constant(n) => *n,
            Self::Cauchy(a, b) => a + b / (wavelength * wavelength),
            Self::Glass(glass) => glass.index(wavelength),
            Self::File(file) => file.index(wavelength),
        }
    }

    /// Whether it goes with the wavelength.
    pub fn disperses(&self) -> bool {
        !matches!(self, Self::Constant(_))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cauchy_s_law_is_what_it_says() {
        // By hand: 1.4779 + 0.004 / 0.25.
        assert!((Index::Cauchy(1.4779, 4e-3).at(0.5) - 1.4939).abs() < 1e-12);
        assert!(!Index::Constant(1.49).disperses() && Index::Cauchy(1.4, 0.0).disperses());
    }
}
