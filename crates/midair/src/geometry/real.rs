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

/// A number with its partial derivatives by `N` variables, forward-mode differentiation to first order; without a number, by the two
/// image coordinates (u, v).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dual<const N: usize = 2> {
    /// The value.
    pub re: f64,
    /// Partial derivatives by each variable; of two, by u and v.
    pub d: [f64; N],
}

impl<const N: usize> Dual<N> {
    /// An independent variable: derivative 1 along `axis` (of two, 0: u, 1: v).
    pub fn variable(re: f64, axis: usize) -> Self {
        let mut d = [0.0; N];
        d[axis] = 1.0;
        Self { re, d }
    }

    /// Applies a function with value `re` and slope `slope` at `self`.
    #[inline]
    fn chain(self, re: f64, slope: f64) -> Self {
        Self { re, d: self.d.map(|d| d * slope) }
    }

    /// Derivatives of both, joined one by one.
    #[inline]
    fn joined(self, o: Self, join: impl Fn(f64, f64) -> f64) -> [f64; N] {
        std::array::from_fn(|i| join(self.d[i], o.d[i]))
    }
}

impl<const N: usize> Real for Dual<N> {
    #[inline]
    fn constant(value: f64) -> Self {
        Self { re: value, d: [0.0; N] }
    }
    #[inline]
    fn value(self) -> f64 {
        self.re
    }
    #[inline]
    fn sqrt(self) -> Self {
        let root = self.re.sqrt();
        self.chain(root, 0.5 / root)
    }
}

impl<const N: usize> Add for Dual<N> {
    type Output = Self;
    #[inline]
    fn add(self, o: Self) -> Self {
        Self { re: self.re + o.re, d: self.joined(o, |a, b| a + b) }
    }
}
impl<const N: usize> Sub for Dual<N> {
    type Output = Self;
    #[inline]
    fn sub(self, o: Self) -> Self {
        Self { re: self.re - o.re, d: self.joined(o, |a, b| a - b) }
    }
}
impl<const N: usize> Mul for Dual<N> {
    type Output = Self;
    #[inline]
    #[expect(clippy::suspicious_arithmetic_impl, reason = "the product rule adds")]
    fn mul(self, o: Self) -> Self {
        Self { re: self.re * o.re, d: self.joined(o, |a, b| a * o.re + self.re * b) }
    }
}
impl<const N: usize> Div for Dual<N> {
    type Output = Self;
    #[inline]
    fn div(self, o: Self) -> Self {
        let inverse = 1.0 / o.re;
        let re = self.re * inverse;
        Self { re, d: self.joined(o, |a, b| (a - re * b) * inverse) }
    }
}
impl<const N: usize> Neg for Dual<N> {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        Self { re: -self.re, d: self.d.map(|d| -d) }
    }
}
impl<const N: usize> Add<f64> for Dual<N> {
    type Output = Self;
    #[inline]
    fn add(self, o: f64) -> Self {
        Self { re: self.re + o, d: self.d }
    }
}
impl<const N: usize> Sub<f64> for Dual<N> {
    type Output = Self;
    #[inline]
    fn sub(self, o: f64) -> Self {
        Self { re: self.re - o, d: self.d }
    }
}
impl<const N: usize> Mul<f64> for Dual<N> {
    type Output = Self;
    #[inline]
    fn mul(self, o: f64) -> Self {
        self.chain(self.re * o, o)
    }
}
