//! The number that optics computes with: a plain `f64`, or a dual number that carries derivatives.

use std::ops::{Add, Div, Mul, Neg, Sub};

/// A real number type for which the optics is written once.
///
/// Every formula that does not exist for its argument (the square root of a negative number)
/// gives NaN, which travels to the end of the path: callers test the end, not every step.
pub trait Real:
    Copy
    + std::fmt::Debug
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + Add<f64, Output = Self>
    + Sub<f64, Output = Self>
    + Mul<f64, Output = Self>
{
    /// A constant: all derivatives zero.
    fn constant(value: f64) -> Self;
    /// The value without its derivatives.
    fn value(self) -> f64;
    /// Square root; NaN below zero.
    fn sqrt(self) -> Self;

    /// Absolute value.
    fn abs(self) -> Self {
        if self.value() < 0.0 { -self } else { self }
    }

    /// `1 / self`.
    fn recip(self) -> Self {
        Self::constant(1.0) / self
    }

    /// `self` squared.
    fn squared(self) -> Self {
        self * self
    }
}

impl Real for f64 {
    fn constant(value: f64) -> Self {
        value
    }
    fn value(self) -> f64 {
        self
    }
    fn sqrt(self) -> Self {
        f64::sqrt(self)
    }
    fn abs(self) -> Self {
        f64::abs(self)
    }
}

/// A number with its partial derivatives by the two image coordinates (u, v):
/// forward-mode differentiation to first order.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dual {
    /// The value.
    pub re: f64,
    /// Partial derivatives by u and v.
    pub d: [f64; 2],
}

impl Dual {
    /// An independent variable: derivative 1 along `axis` (0: u, 1: v).
    pub fn variable(re: f64, axis: usize) -> Self {
        let mut d = [0.0; 2];
        d[axis] = 1.0;
        Self { re, d }
    }

    /// Applies a function with value `re` and slope `slope` at `self`.
    fn chain(self, re: f64, slope: f64) -> Self {
        Self { re, d: [self.d[0] * slope, self.d[1] * slope] }
    }
}

impl Real for Dual {
    fn constant(value: f64) -> Self {
        Self { re: value, d: [0.0; 2] }
    }
    fn value(self) -> f64 {
        self.re
    }
    fn sqrt(self) -> Self {
        let root = self.re.sqrt();
        self.chain(root, 0.5 / root)
    }
}

impl Add for Dual {
    type Output = Self;
    fn add(self, o: Self) -> Self {
        Self { re: self.re + o.re, d: [self.d[0] + o.d[0], self.d[1] + o.d[1]] }
    }
}
impl Sub for Dual {
    type Output = Self;
    fn sub(self, o: Self) -> Self {
        Self { re: self.re - o.re, d: [self.d[0] - o.d[0], self.d[1] - o.d[1]] }
    }
}
impl Mul for Dual {
    type Output = Self;
    fn mul(self, o: Self) -> Self {
        Self {
            re: self.re * o.re,
            d: [self.d[0] * o.re + self.re * o.d[0], self.d[1] * o.re + self.re * o.d[1]],
        }
    }
}
impl Div for Dual {
    type Output = Self;
    fn div(self, o: Self) -> Self {
        let inverse = 1.0 / o.re;
        let re = self.re * inverse;
        Self { re, d: [(self.d[0] - re * o.d[0]) * inverse, (self.d[1] - re * o.d[1]) * inverse] }
    }
}
impl Neg for Dual {
    type Output = Self;
    fn neg(self) -> Self {
        Self { re: -self.re, d: [-self.d[0], -self.d[1]] }
    }
}
impl Add<f64> for Dual {
    type Output = Self;
    fn add(self, o: f64) -> Self {
        Self { re: self.re + o, d: self.d }
    }
}
impl Sub<f64> for Dual {
    type Output = Self;
    fn sub(self, o: f64) -> Self {
        Self { re: self.re - o, d: self.d }
    }
}
impl Mul<f64> for Dual {
    type Output = Self;
    fn mul(self, o: f64) -> Self {
        self.chain(self.re * o, o)
    }
}
