//! F at many image points at once.

use super::packet::Packets;
use super::path::{End, Path};
use super::setup::Setup;
use rayon::prelude::*;

/// Points that a thread takes at a time: their tracing takes a hundred times as long as handing them over.
const AT_ONCE: usize = 256;

impl Setup {
    /// F at image points uv: what `of` takes of the ends of their paths, NaN where it takes nothing. [`End::formed`] takes what lights the
    /// image, [`End::st`] also what goes past the plate's or the display's edges.
    pub fn transport_all(
        &self,
        uv: &[[f64; 2]],
        of: impl Fn(&End) -> Option<[f64; 2]> + Sync,
    ) -> Vec<[f64; 2]> {
        let st = |end| of(&end).unwrap_or([f64::NAN; 2]);
        self.each_end(uv.len(), |i| uv[i], [f64::NAN; 2], st)
    }

    /// What `of` makes of the ends of the paths through so many image points; `none`: what each is before.
    pub(crate) fn each_end<T: Clone + Send>(
        &self,
        count: usize,
        uv: impl Fn(usize) -> [f64; 2] + Sync,
        none: T,
        of: impl Fn(End) -> T + Sync,
    ) -> Vec<T> {
        let mut made = vec![none; count];
        made.par_chunks_mut(AT_ONCE).enumerate().for_each_init(
            || (Packets::new(self, self.viewpoint), Vec::with_capacity(AT_ONCE)),
            |(packets, points), (chunk, made)| {
                let first = chunk * AT_ONCE;
                points.clear();
                points.extend((first..first + made.len()).map(&uv));
                packets.ends(points, |i, end| made[i] = of(end));
            },
        );
        made
    }

    /// The derivatives of F at image points uv: rows d(s)/d(u, v) and d(t)/d(u, v), NaN where `of` takes nothing of the path's end.
    pub fn jacobians(
        &self,
        uv: &[[f64; 2]],
        of: impl Fn(&End) -> Option<[f64; 2]> + Sync,
    ) -> Vec<[[f64; 2]; 2]> {
        let jacobian = |path: &mut Path, &uv: &[f64; 2]| {
            of(&self.transport(uv, path))?;
            Some(self.follow_with_jacobian(uv, path).1)
        };
        uv.par_iter()
            .with_min_len(AT_ONCE)
            .map_init(Path::new, |path, uv| jacobian(path, uv).unwrap_or([[f64::NAN; 2]; 2]))
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::transport::bench_setup::{ACRYLIC, element, setup, sphere};

    #[test]
    fn with_nothing_in_the_way_f_is_the_identity() {
        let mut bare = setup(20.0, vec![]);
        // The display's left half alone.
        bare.display.size[0] = 10.0;
        let uv: Vec<[f64; 2]> =
            (0..1000).map(|i| [f64::from(i % 40) / 39.0, f64::from(i / 40) / 24.0]).collect();
        let formed = bare.transport_all(&uv, End::formed);
        let everywhere = bare.transport_all(&uv, End::st);
        let slopes = bare.jacobians(&uv, End::st);
        let mut seen = 0;
        for i in 0..uv.len() {
            // Half as wide, its middle where it was.
            let st = [2.0 * uv[i][0] - 0.5, uv[i][1]];
            for axis in 0..2 {
                assert!((everywhere[i][axis] - st[axis]).abs() < 1e-9, "{st:?}");
            }
            let on = st.iter().all(|c| (1e-9..=1.0 - 1e-9).contains(c));
            if on {
                assert_eq!(formed[i], everywhere[i]);
                seen += 1;
            } else if st.iter().any(|c| !(-1e-9..=1.0 + 1e-9).contains(c)) {
                assert!(formed[i][0].is_nan());
            }
            for (row, expected) in slopes[i].iter().zip([[2.0, 0.0], [0.0, 1.0]]) {
                assert!((0..2).all(|k| (row[k] - expected[k]).abs() < 1e-9), "{row:?}");
            }
        }
        assert!(seen > 300, "{seen}");
    }

    #[test]
    fn derivatives_are_those_of_differences() {
        let ball = setup(20.0, vec![element(sphere(25.0), ACRYLIC, [0.0; 3], [0.0; 3], 0)]);
        let uv = [[0.3, 0.6], [0.5, 0.5], [0.71, 0.22]];
        let slopes = ball.jacobians(&uv, End::st);
        let h = 1e-5;
        for (&[u, v], slope) in uv.iter().zip(&slopes) {
            let around = [[u + h, v], [u - h, v], [u, v + h], [u, v - h]];
            let st = ball.transport_all(&around, End::st);
            for axis in 0..2 {
                let differences = [0, 2].map(|k| (st[k][axis] - st[k + 1][axis]) / (2.0 * h));
                // Third derivatives of at most a hundred times h^2, and rounding over h.
                for k in 0..2 {
                    assert!((differences[k] - slope[axis][k]).abs() < 1e-7, "{slope:?}");
                }
            }
        }
    }
}
