//! A row of the map and the polynomials that answer for it.

use super::pixels::SAME;
use crate::map::Status;

/// The highest degree of a patch.
pub(super) const MAX_DEGREE: usize = 15;

/// A patch's polynomials along one row of the display: coefficients of s^i, highest last.
pub(super) struct RowPolynomial {
    pub u: [f64; MAX_DEGREE + 1],
    pub v: [f64; MAX_DEGREE + 1],
    pub degree: usize,
}

/// A stretch of a row of the map. Where the status is `Outside`, uv may be anything yet.
pub(super) struct Row<'a> {
    pub uv: &'a mut [[f64; 2]],
    pub status: &'a mut [Status],
}

/// Which answers are entered into a stretch of a row.
pub(super) struct Stretch {
    /// Where the first pixel lies, from -1 to 1 over the patch, and how far it is to the next.
    pub start: f64,
    pub step: f64,
    /// The image points that the patch answers for: lower left, upper right.
    pub within: [[f64; 2]; 2],
    /// Whether its light is blocked.
    pub blocked: bool,
}

/// Pixels that are worked out at once: as many as keep the units for multiplication busy.
const LANES: usize = 16;

impl RowPolynomial {
    /// uv at `s` in [-1, 1].
    pub fn at(&self, s: f64) -> [f64; 2] {
        let [u, v] = self.lanes(s, 0.0, 0);
        [u[0], v[0]]
    }

    /// Enters the answers into a stretch of a row, NaN where there is none. With the widest instructions that this machine has.
    pub fn enter(&self, stretch: &Stretch, row: Row<'_>) {
        #[cfg(target_arch = "x86_64")]
        {
            if is_x86_feature_detected!("avx512f") {
                // SAFETY: the instructions were just found to exist.
                return unsafe { self.enter_avx512(stretch, row) };
            }
            if is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma") {
                // SAFETY: the instructions were just found to exist.
                return unsafe { self.enter_avx2(stretch, row) };
            }
        }
        self.enter_lanes(stretch, row);
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx512f")]
    fn enter_avx512(&self, stretch: &Stretch, row: Row<'_>) {
        self.enter_lanes(stretch, row);
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2,fma")]
    fn enter_avx2(&self, stretch: &Stretch, row: Row<'_>) {
        self.enter_lanes(stretch, row);
    }

    #[inline(always)]
    fn enter_lanes(&self, stretch: &Stretch, row: Row<'_>) {
        let Stretch { start, step, within: [low, high], blocked } = *stretch;
        let answered = if blocked { Status::Blocked } else { Status::Ok };
        let blocks = row.uv.chunks_mut(LANES).zip(row.status.chunks_mut(LANES));
        for (block, (uv, status)) in blocks.enumerate() {
            let [u, v] = self.lanes(start, step, block * LANES);
            let inside =
                |u: f64, v: f64| (u >= low[0]) & (u <= high[0]) & (v >= low[1]) & (v <= high[1]);
            // Mostly these are the first answers here: then no pixel need be looked at.
            if status.iter().fold(true, |all, &s| all & (s == Status::Outside)) {
                for lane in 0..uv.len() {
                    let inside = inside(u[lane], v[lane]);
                    uv[lane] = [u[lane], v[lane]].map(|c| if inside { c } else { f64::NAN });
                    status[lane] = if inside { answered } else { Status::Outside };
                }
                continue;
            }
            for (lane, (uv, status)) in uv.iter_mut().zip(status).enumerate() {
                if inside(u[lane], v[lane]) {
                    enter(uv, status, [u[lane], v[lane]], blocked);
                }
            }
        }
    }

    /// u and v at `start + (first + lane) * step` for each lane.
    #[inline(always)]
    fn lanes(&self, start: f64, step: f64, first: usize) -> [[f64; LANES]; 2] {
        let mut s = [0.0; LANES];
        for lane in 0..LANES {
            s[lane] = start + step * (first + lane) as f64;
        }
        let mut u = [self.u[self.degree]; LANES];
        let mut v = [self.v[self.degree]; LANES];
        for i in (0..self.degree).rev() {
            for lane in 0..LANES {
                u[lane] = multiply_add(u[lane], s[lane], self.u[i]);
            }
            for lane in 0..LANES {
                v[lane] = multiply_add(v[lane], s[lane], self.v[i]);
            }
        }
        [u, v]
    }
}

/// a * b + c, rounded once where the processor can. WebAssembly cannot, and in software that takes twenty times as long; two roundings
/// differ from one by less than what the monomials have lost already.
#[inline(always)]
pub(super) fn multiply_add(a: f64, b: f64, c: f64) -> f64 {
    if cfg!(target_family = "wasm") { a * b + c } else { a.mul_add(b, c) }
}

/// Enters one answer of a pixel. Of several, the image point nearest to the image's centre is shown.
#[inline]
pub(super) fn enter(uv: &mut [f64; 2], status: &mut Status, found: [f64; 2], blocked: bool) {
    match *status {
        Status::Outside => {
            *uv = found;
            *status = if blocked { Status::Blocked } else { Status::Ok };
        }
        Status::Blocked => {
            if !blocked {
                *uv = found;
                *status = Status::Ok;
            }
        }
        Status::Ok | Status::Folded => {
            if blocked || (uv[0] - found[0]).hypot(uv[1] - found[1]) < SAME {
                return;
            }
            if from_centre(found) < from_centre(*uv) {
                *uv = found;
            }
            *status = Status::Folded;
        }
    }
}

/// How far an image point lies from the image's centre.
pub(super) fn from_centre(uv: [f64; 2]) -> f64 {
    (uv[0] - 0.5).hypot(uv[1] - 0.5)
}
