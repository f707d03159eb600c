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
    pub fn constant(v: Vec3<f64>) -> Self {
        Self::new(T::constant(v.x), T::constant(v.y), T::constant(v.z))
    }

    /// The components' values without derivatives.
    pub fn value(self) -> Vec3<f64> {
        Vec3::new(self.x.value(), self.y.value(), self.z.value())
    }

    /// Scalar product.
    pub fn dot(self, o: Self) -> T {
        self.x * o.x + self.y * o.y + self.z * o.z
    }

    /// Scalar product with a plain vector, cheaper than lifting that to constants.
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
    pub fn scaled(self, s: T) -> Self {
        Self::new(self.x * s, self.y * s, self.z * s)
    }

    /// Squared length.
    pub fn squared_length(self) -> T {
        self.dot(self)
    }

    /// Length.
    pub fn length(self) -> T {
        self.squared_length().sqrt()
    }

    /// The same direction with length 1; NaN for the zero vector.
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
