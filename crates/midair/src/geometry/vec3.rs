//! A vector of three numbers.

use super::Real;
use std::ops::{Add, Mul, Neg, Sub};

/// A point (mm) or direction in a right-handed frame, +y up.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct Vec3<T = f64> {
    /// First component.
    pub x: T,
    /// Second component.
    pub y: T,
    /// Third component.
    pub z: T,
}

impl<T: Real> Vec3<T> {
    /// From components.
    pub const fn new(x: T, y: T, z: T) -> Self {
        Self { x, y, z }
    }

    /// A vector whose components are all constants.
    #[inline]
    pub fn constant(v: Vec3<f64>) -> Self {
        Self::new(T::constant(v.x), T::constant(v.y), T::constant(v.z))
    }

    /// The components' values without derivatives.
    #[inline]
    pub fn value(self) -> Vec3<f64> {
        Vec3::new(self.x.value(), self.y.value(), self.z.value())
    }

    /// Scalar product.
    #[inline]
    pub fn dot(self, o: Self) -> T {
        self.x * o.x + self.y * o.y + self.z * o.z
    }

    /// Scalar product with a plain vector, cheaper than lifting that to constants.
    #[inline]
    pub fn dot_plain(self, o: Vec3<f64>) -> T {
        self.x * o.x + self.y * o.y + self.z * o.z
    }

    /// Vector product.
    pub fn cross(self, o: Self) -> Self {
        Self::new(
            self.y * o.z - self.z * o.y,
            self.z * o.x - self.x * o.z,
            self.x * o.y - self.y * o.x,
        )
    }

    /// Times a number of the same kind.
    #[inline]
    pub fn scaled(self, s: T) -> Self {
        Self::new(self.x * s, self.y * s, self.z * s)
    }

    /// Squared length.
    #[inline]
    pub fn squared_length(self) -> T {
        self.dot(self)
    }

    /// Length.
    #[inline]
    pub fn length(self) -> T {
        self.squared_length().sqrt()
    }

    /// The same direction with length 1; NaN for the zero vector.
    #[inline]
    pub fn normalized(self) -> Self {
        self.scaled(self.length().recip())
    }
}

impl Vec3<f64> {
    /// The origin.
    pub const ZERO: Self = Self::new(0.0, 0.0, 0.0);

    /// From an array x, y, z.
    pub const fn from_array([x, y, z]: [f64; 3]) -> Self {
        Self::new(x, y, z)
    }

    /// To an array x, y, z.
    pub const fn to_array(self) -> [f64; 3] {
        [self.x, self.y, self.z]
    }

    /// Two unit vectors at right angles to this one and to each other.
    pub fn perpendicular(self) -> [Self; 2] {
        let [x, y, z] = [self.x.abs(), self.y.abs(), self.z.abs()];
        let off = if y <= x && y <= z {
            Self::new(0.0, 1.0, 0.0)
        } else if x <= z {
            Self::new(1.0, 0.0, 0.0)
        } else {
            Self::new(0.0, 0.0, 1.0)
        };
        let right = self.cross(off).normalized();
        [right, right.cross(self).normalized()]
    }

    /// Whether every component is a finite number.
    pub fn is_finite(self) -> bool {
        self.x.is_finite() && self.y.is_finite() && self.z.is_finite()
    }
}

impl<T: Real> Add for Vec3<T> {
    type Output = Self;
    fn add(self, o: Self) -> Self {
        Self::new(self.x + o.x, self.y + o.y, self.z + o.z)
    }
}
impl<T: Real> Sub for Vec3<T> {
    type Output = Self;
    fn sub(self, o: Self) -> Self {
        Self::new(self.x - o.x, self.y - o.y, self.z - o.z)
    }
}
impl<T: Real> Neg for Vec3<T> {
    type Output = Self;
    fn neg(self) -> Self {
        Self::new(-self.x, -self.y, -self.z)
    }
}
impl<T: Real> Mul<f64> for Vec3<T> {
    type Output = Self;
    fn mul(self, s: f64) -> Self {
        Self::new(self.x * s, self.y * s, self.z * s)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn perpendicular_vectors_make_a_frame(x in -9.0..9.0f64, y in -9.0..9.0f64, z in -9.0..9.0f64) {
            let v = Vec3::new(x, y, z);
            prop_assume!(v.length() > 1e-3);
            let [a, b] = v.perpendicular();
            // Unit vectors: a few roundings.
            for (got, expected) in [(a.length(), 1.0), (b.length(), 1.0), (a.dot(b), 0.0)] {
                prop_assert!((got - expected).abs() < 1e-14);
            }
            prop_assert!(a.dot(v).abs().max(b.dot(v).abs()) < 1e-14 * v.length());
        }
    }
}
