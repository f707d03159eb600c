//! An aspheric surface of revolution, as optical drawings have it (ISO 10110-12).

use crate::geometry::Real;

/// The fall of a surface from its vertex, by q, the square of the distance from the axis: c q / (1 + sqrt(1 - (1 + k) c^2 q)) + a4 q^2 + a6 q^3 + ...
#[derive(Clone, Debug, PartialEq)]
pub struct Sag {
    /// Where the vertex lies on the axis, mm.
    pub vertex: f64,
    /// 1 where the surface's outside is up along the axis, -1 where it is down.
    pub side: f64,
    /// Curvature at the vertex, per mm; positive where the surface falls away inwards (it bulges).
    pub curvature: f64,
    /// Conic constant k: 0 a sphere, -1 a paraboloid.
    pub conic: f64,
    /// a4, a6, ...: mm^-3, mm^-5, ...
    pub terms: Vec<f64>,
    /// How far from the axis the surface reaches, mm.
    pub reach: f64,
}

impl Sag {
    /// The fall at q = r^2, mm; NaN where there is no surface.
    pub fn at<T: Real>(&self, q: T) -> T {
        let c = self.curvature;
        let root = (-(q * ((1.0 + self.conic) * c * c)) + 1.0).sqrt();
        self.terms.iter().rev().fold(T::constant(0.0), |sum, &a| sum * q + a) * q * q
            + q * c / (root + 1.0)
    }

    /// Its change by q, per mm.
    pub fn slope<T: Real>(&self, q: T) -> T {
        let c = self.curvature;
        let root = (-(q * ((1.0 + self.conic) * c * c)) + 1.0).sqrt();
        let polynomial = self.terms.iter().enumerate().rev();
        polynomial.fold(T::constant(0.0), |sum, (i, &a)| sum * q + a * (i + 2) as f64) * q
            + root.recip() * (0.5 * c)
    }

    /// The height along the axis at a distance from it, mm.
    pub fn height(&self, r: f64) -> f64 {
        self.vertex - self.side * self.at(r * r)
    }

    /// q up to which the surface goes on beyond its rim, for paths near the rim.
    pub fn farthest(&self) -> f64 {
        let limit = (1.0 + self.conic) * self.curvature * self.curvature;
        let beyond = (1.5 * self.reach).powi(2);
        if limit > 0.0 { beyond.min((1.0 - 1e-9) / limit) } else { beyond }
    }

    /// Bounds of the fall over an interval of q, each term of which is monotone.
    pub fn range(&self, [low, high]: [f64; 2]) -> [f64; 2] {
        let conic = Self { terms: Vec::new(), ..self.clone() };
        self.sum_of_ranges([conic.at(low), conic.at(high)], |i, a| {
            [low, high].map(|q| a * q.powi(i as i32 + 2))
        })
    }

    /// Bounds of its slope over an interval of q.
    pub fn slope_range(&self, [low, high]: [f64; 2]) -> [f64; 2] {
        let conic = Self { terms: Vec::new(), ..self.clone() };
        self.sum_of_ranges([conic.slope(low), conic.slope(high)], |i, a| {
            [low, high].map(|q| a * (i + 2) as f64 * q.powi(i as i32 + 1))
        })
    }

    fn sum_of_ranges(&self, conic: [f64; 2], term: impl Fn(usize, f64) -> [f64; 2]) -> [f64; 2] {
        let terms = self.terms.iter().enumerate().map(|(i, &a)| term(i, a));
        terms
            .chain([conic])
            .fold([0.0, 0.0], |[low, high], [a, b]| [low + a.min(b), high + a.max(b)])
    }
}
