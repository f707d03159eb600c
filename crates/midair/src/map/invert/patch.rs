//! A piece of the map as a polynomial.

use super::Cell;
use super::newton::{apply_inverse, determinant, solve};
use super::row::{MAX_DEGREE, RowPolynomial, multiply_add};
use super::tally::count_ray;
use crate::transport::{Setup, Step};

/// The inverse of one branch over a rectangle of the display: two polynomials of degree `degree` in each of the
/// rectangle's coordinates, interpolating the exact inverse at Chebyshev nodes.
#[derive(Clone, Debug)]
pub(super) struct Patch {
    /// The cell of the image whose points this patch answers for.
    pub cell: Cell,
    /// The rectangle of st that it is fitted on: lower left and upper right.
    pub rect: [[f64; 2]; 2],
    /// Whether its light is blocked (past the plate's edge).
    pub blocked: bool,
    /// Bound of |uv - exact|.
    pub error: f64,
    degree: usize,
    /// Largest error that it was held to.
    pub tolerance: f64,
    /// Monomial coefficients, `[j][i]` belonging to t^j s^i with s, t in [-1, 1], u and v.
    coefficients: Vec<[f64; 2]>,
}

/// The share of the tolerance that high degrees may amount to and still be left out: so little that what the bound
/// promises is hardly touched.
const DROPPED: f64 = 1.0 / 64.0;

impl Patch {
    /// Fits the inverse on `rect`; `None` if it cannot be proved to meet `tolerance` there.
    pub fn fit(
        setup: &Setup,
        path: &mut [Step],
        cell: Cell,
        rect: [[f64; 2]; 2],
        degree: usize,
        tolerance: f64,
    ) -> Option<Self> {
        let n = degree + 1;
        let nodes: Vec<f64> = (0..n).map(|k| chebyshev_node(k, n)).collect();
        let place = |s: f64, t: f64| {
            [0, 1].map(|axis| {
                let x = if axis == 0 { s } else { t };
                0.5 * ((rect[1][axis] - rect[0][axis]) * x + rect[0][axis] + rect[1][axis])
            })
        };
        let mut values = vec![[0.0; 2]; n * n];
        let centre = cell.centre();
        let mut near = solve(setup, path, place(nodes[0], nodes[0]), centre, centre)?;
        let mut near_st = place(nodes[0], nodes[0]);
        let orientation = determinant(near.jacobian).signum();
        for (row, &t) in nodes.iter().enumerate() {
            for k in 0..n {
                // To and fro, so that each node's neighbour is its start.
                let column = if row % 2 == 0 { k } else { n - 1 - k };
                let st = place(nodes[column], t);
                near = solve(setup, path, st, near.towards(near_st, st), near.uv)?;
                near_st = st;
                if determinant(near.jacobian).signum() != orientation {
                    return None;
                }
                values[row * n + column] = near.uv;
            }
        }
        let chebyshev = chebyshev_coefficients(&values, n);
        let tail = tail_bound(&chebyshev, n);
        // Seen through a mesh F is creased along the triangles' edges: what lies between the samples may err by several times
        // as much as they do, and the bound that is asked for is the wider one.
        let seamless = path.iter().any(|step| step.seamless);
        let (tolerance, safety) = if seamless { (8.0 * tolerance, 4.0) } else { (tolerance, 2.0) };
        // Rows and columns of the highest degree are what a lower one would have left out.
        if !(tail < 50.0 * tolerance) {
            return None;
        }
        let kept = if seamless { n } else { needed(&chebyshev, n, tolerance * DROPPED) };
        let coefficients = monomials(&corner(&chebyshev, n, kept), kept);
        let mut patch = Self {
            cell,
            rect,
            blocked: false,
            error: 0.0,
            degree: kept - 1,
            tolerance,
            coefficients,
        };
        let checked = patch.check(setup, path, seamless, place)?;
        // Twice the worst of the sampled residuals covers what lies between the samples, which sit near the error's
        // extremes: between the nodes.
        patch.error = safety * checked;
        (patch.error <= tolerance).then_some(patch)
    }

    /// The largest error at points between the nodes, by the residual of F there and F's Jacobian.
    fn check(
        &self,
        setup: &Setup,
        path: &mut [Step],
        everywhere: bool,
        place: impl Fn(f64, f64) -> [f64; 2],
    ) -> Option<f64> {
        let n = self.degree + 1;
        // Extremes of the Chebyshev polynomial T_n: where the interpolation errs most.
        let extremes: Vec<usize> =
            if everywhere { (0..=n).collect() } else { vec![0, 1, n / 3, n / 2, n - 1, n] };
        let mut worst = 0.0f64;
        for (i, &a) in extremes.iter().enumerate() {
            for (j, &b) in extremes.iter().enumerate() {
                // The outer ring and every other inner point.
                if !everywhere && (i + j) % 2 == 1 {
                    continue;
                }
                let [s, t] = [a, b].map(|k| (std::f64::consts::PI * k as f64 / n as f64).cos());
                let uv = self.row(t).at(s);
                let st = place(s, t);
                count_ray();
                let (at, jacobian) = setup.follow_with_jacobian(uv, path);
                let error = apply_inverse(jacobian, [at[0] - st[0], at[1] - st[1]]);
                let error = error[0].hypot(error[1]);
                if error.is_nan() {
                    return None;
                }
                worst = worst.max(error);
            }
        }
        Some(worst)
    }

    /// Position of a st coordinate within the rectangle, from -1 to 1.
    pub fn scaled(&self, st: f64, axis: usize) -> f64 {
        let [low, high] = [self.rect[0][axis], self.rect[1][axis]];
        (2.0 * st - low - high) / (high - low)
    }

    /// Its answer at a place of the display.
    pub fn at(&self, [s, t]: [f64; 2]) -> [f64; 2] {
        self.row(self.scaled(t, 1)).at(self.scaled(s, 0))
    }

    /// The row's polynomials at `t` in [-1, 1].
    pub fn row(&self, t: f64) -> RowPolynomial {
        let n = self.degree + 1;
        let mut row = RowPolynomial {
            u: [0.0; MAX_DEGREE + 1],
            v: [0.0; MAX_DEGREE + 1],
            degree: self.degree,
        };
        for j in (0..n).rev() {
            for i in 0..n {
                let c = self.coefficients[j * n + i];
                row.u[i] = multiply_add(row.u[i], t, c[0]);
                row.v[i] = multiply_add(row.v[i], t, c[1]);
            }
        }
        row
    }
}

/// Node k of n: a zero of the Chebyshev polynomial T_n.
fn chebyshev_node(k: usize, n: usize) -> f64 {
    (std::f64::consts::PI * (k as f64 + 0.5) / n as f64).cos()
}

/// Chebyshev coefficients `[j][i]` of T_j(t) T_i(s) from values at the nodes, by discrete orthogonality
/// (Mason and Handscomb, Chebyshev Polynomials, 2003, 6.3).
fn chebyshev_coefficients(values: &[[f64; 2]], n: usize) -> Vec<[f64; 2]> {
    let basis: Vec<f64> = (0..n * n)
        .map(|index| {
            let (order, node) = (index / n, index % n);
            let angle = std::f64::consts::PI * order as f64 * (node as f64 + 0.5) / n as f64;
            angle.cos() * if order == 0 { 1.0 } else { 2.0 } / n as f64
        })
        .collect();
    // Twice the same transform along rows, transposing each time.
    let transform = |from: &[[f64; 2]]| {
        let mut to = vec![[0.0; 2]; n * n];
        for row in 0..n {
            for order in 0..n {
                let mut sum = [0.0; 2];
                for node in 0..n {
                    let b = basis[order * n + node];
                    sum[0] += b * from[row * n + node][0];
                    sum[1] += b * from[row * n + node][1];
                }
                to[order * n + row] = sum;
            }
        }
        to
    };
    transform(&transform(values))
}

/// Sum of the magnitudes of the coefficients of the highest degree in either coordinate.
fn tail_bound(coefficients: &[[f64; 2]], n: usize) -> f64 {
    (0..n)
        .map(|k| {
            let (row, column) = (coefficients[(n - 1) * n + k], coefficients[k * n + n - 1]);
            row[0].hypot(row[1]) + column[0].hypot(column[1])
        })
        .sum()
}

/// How many degrees in each coordinate are worth their evaluation: all higher ones together amount to no more than `error`
/// anywhere (no Chebyshev polynomial exceeds 1).
fn needed(coefficients: &[[f64; 2]], n: usize, error: f64) -> usize {
    let mut dropped = 0.0;
    for kept in (2..n).rev() {
        dropped += (0..=kept)
            .map(|k| {
                let (row, column) = (coefficients[kept * n + k], coefficients[k * n + kept]);
                let both = if k == kept { 1.0 } else { 2.0 };
                0.5 * both * (row[0].hypot(row[1]) + column[0].hypot(column[1]))
            })
            .sum::<f64>();
        if !(dropped <= error) {
            return kept + 1;
        }
    }
    2
}

/// The coefficients below `kept` in both coordinates.
fn corner(coefficients: &[[f64; 2]], n: usize, kept: usize) -> Vec<[f64; 2]> {
    coefficients.chunks(n).take(kept).flat_map(|row| &row[..kept]).copied().collect()
}

/// From Chebyshev to monomial coefficients in both coordinates. At degree 15 this costs at most 2^15 ulp.
fn monomials(chebyshev: &[[f64; 2]], n: usize) -> Vec<[f64; 2]> {
    let mut polynomials = vec![0.0; n * n];
    for order in 0..n {
        match order {
            0 => polynomials[0] = 1.0,
            1 => polynomials[n + 1] = 1.0,
            _ => {
                for power in 0..n {
                    let shifted =
                        if power == 0 { 0.0 } else { polynomials[(order - 1) * n + power - 1] };
                    polynomials[order * n + power] =
                        2.0 * shifted - polynomials[(order - 2) * n + power];
                }
            }
        }
    }
    let transform = |from: &[[f64; 2]]| {
        let mut to = vec![[0.0; 2]; n * n];
        for row in 0..n {
            for power in 0..n {
                let mut sum = [0.0; 2];
                for order in power..n {
                    let p = polynomials[order * n + power];
                    sum[0] += p * from[row * n + order][0];
                    sum[1] += p * from[row * n + order][1];
                }
                to[power * n + row] = sum;
            }
        }
        to
    };
    transform(&transform(chebyshev))
}
