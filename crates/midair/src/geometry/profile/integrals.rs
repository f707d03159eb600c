//! Area and volume that a profile surrounds, each piece's part of them in closed form (Green's theorem).

use super::{Piece, Profile, Sag};
use std::f64::consts::PI;

impl Profile {
    /// The area that it surrounds, mm^2.
    pub fn area(&self) -> f64 {
        self.pieces().iter().map(Piece::area_term).sum()
    }

    /// The volume that it sweeps when it is turned about the axis, mm^3.
    pub fn turned_volume(&self) -> f64 {
        PI * self.pieces().iter().map(volume_term).sum::<f64>()
    }
}

impl Piece {
    /// Its part of the area: half the integral of x dy - y dx.
    pub(super) fn area_term(&self) -> f64 {
        match self {
            Self::Line { from, to } => 0.5 * (from[0] * to[1] - to[0] * from[1]),
            Self::Arc { centre, radius, from, to } => {
                let ((s0, c0), (s1, c1)) = (from.sin_cos(), to.sin_cos());
                let [x, y] = *centre;
                0.5 * radius * (radius * (to - from) + x * (s1 - s0) - y * (c1 - c0))
            }
            // Its points are enough for the sign.
            Self::Sag(_) => {
                let mut points = self.samples(64);
                points.push(self.to());
                points.windows(2).map(|p| 0.5 * (p[0][0] * p[1][1] - p[1][0] * p[0][1])).sum()
            }
        }
    }
}

/// The integral of r^2 dy.
fn volume_term(piece: &Piece) -> f64 {
    match piece {
        Piece::Line { from: [a, low], to: [b, high] } => {
            (high - low) * (a * a + a * b + b * b) / 3.0
        }
        Piece::Arc { centre: [c, _], radius, from, to } => {
            let r = *radius;
            let part = |angle: f64| {
                let (s, cosine) = angle.sin_cos();
                r * (c * c * s + c * r * (angle + s * cosine) + r * r * (s - s * s * s / 3.0))
            };
            part(*to) - part(*from)
        }
        Piece::Sag(sag) => sag_volume(sag),
    }
}

/// The integral of r^2 S'(r) dr from the axis to the rim, by Simpson's rule: alike for either side.
fn sag_volume(sag: &Sag) -> f64 {
    const STEPS: usize = 256;
    let h = sag.reach / STEPS as f64;
    // At a rim that is as steep as a wall the slope has no bound: there the sum stops a little short of it.
    let value = |k: usize| {
        let r = (h * k as f64).min(sag.reach * (1.0 - 1e-9));
        2.0 * r * r * r * sag.slope(r * r)
    };
    let inner = (1..STEPS).map(|k| value(k) * if k % 2 == 1 { 4.0 } else { 2.0 });
    h / 3.0 * (value(0) + inner.sum::<f64>() + value(STEPS))
}
