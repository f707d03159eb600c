//! What photographs of a flat picture tell: the homography, the lens (Zhang 2000, A flexible new technique for camera calibration) and the
//! camera's place. All of it is a beginning that the fit goes on from.

use crate::camera::Lens;
use midair::geometry::{Frame, Vec3};
use nalgebra::{DMatrix, Matrix3, SMatrix, Vector3};

/// A place in the plane and where it is seen.
#[derive(Clone, Copy, Debug)]
pub struct Pair {
    /// In the plane.
    pub on_plane: [f64; 2],
    /// In the picture.
    pub seen: [f64; 2],
}

/// A similarity that brings points to the origin and to a size of about 1: without it the equations lose half their digits (Hartley 1997).
fn normalising(points: impl Iterator<Item = [f64; 2]> + Clone) -> Matrix3<f64> {
    let count = points.clone().count().max(1) as f64;
    let sum = points.clone().fold([0.0; 2], |s, p| [s[0] + p[0], s[1] + p[1]]);
    let mean = sum.map(|s| s / count);
    let spread = points.map(|p| (p[0] - mean[0]).hypot(p[1] - mean[1])).sum::<f64>() / count;
    let scale = if spread > 0.0 { std::f64::consts::SQRT_2 / spread } else { 1.0 };
    Matrix3::new(scale, 0.0, -scale * mean[0], 0.0, scale, -scale * mean[1], 0.0, 0.0, 1.0)
}

/// A point through a homography.
pub fn through(h: &Matrix3<f64>, [x, y]: [f64; 2]) -> [f64; 2] {
    let p = h * Vector3::new(x, y, 1.0);
    [p.x / p.z, p.y / p.z]
}

/// How far each pair's point is from where a homography puts it.
pub fn distances(h: &Matrix3<f64>, pairs: &[Pair]) -> Vec<f64> {
    let distance = |pair: &Pair| {
        let at = through(h, pair.on_plane);
        (at[0] - pair.seen[0]).hypot(at[1] - pair.seen[1])
    };
    pairs.iter().map(distance).collect()
}

/// The homography from the plane to the picture, little moved by wrong pairs; `None` where the pairs do not tell it (fewer than four, or all on a line).
pub fn homography(pairs: &[Pair]) -> Option<Matrix3<f64>> {
    let mut weights = vec![1.0; pairs.len()];
    let mut best = None;
    // Weights by how far off each pair is (Cauchy's loss, its scale the median): a few rounds suffice for a beginning.
    for _ in 0..12 {
        let h = weighted_homography(pairs, &weights)?;
        let off = distances(&h, pairs);
        let scale = median(&off).max(1e-12) * 2.0;
        weights = off.iter().map(|off| 1.0 / (1.0 + (off / scale).powi(2))).collect();
        best = Some(h);
    }
    best
}

/// The middle one of some numbers; 0 of none.
pub(crate) fn median(numbers: &[f64]) -> f64 {
    let mut sorted: Vec<f64> = numbers.iter().copied().filter(|n| !n.is_nan()).collect();
    if sorted.is_empty() {
        return 0.0;
    }
    let middle = sorted.len() / 2;
    *sorted.select_nth_unstable_by(middle, f64::total_cmp).1
}

fn weighted_homography(pairs: &[Pair], weights: &[f64]) -> Option<Matrix3<f64>> {
    if pairs.len() < 4 {
        return None;
    }
    let from = normalising(pairs.iter().map(|p| p.on_plane));
    let to = normalising(pairs.iter().map(|p| p.seen));
    let mut normal = SMatrix::<f64, 9, 9>::zeros();
    for (pair, weight) in pairs.iter().zip(weights) {
        let ([x, y], [u, v]) = (through(&from, pair.on_plane), through(&to, pair.seen));
        for row in [
            [x, y, 1.0, 0.0, 0.0, 0.0, -u * x, -u * y, -u],
            [0.0, 0.0, 0.0, x, y, 1.0, -v * x, -v * y, -v],
        ] {
            let row = SMatrix::<f64, 9, 1>::from_row_slice(&row);
            normal += row * row.transpose() * *weight;
        }
    }
    let eigen = normal.symmetric_eigen();
    let mut order: Vec<usize> = (0..9).collect();
    order.sort_by(|&a, &b| eigen.eigenvalues[a].total_cmp(&eigen.eigenvalues[b]));
    // Two vanishing directions: the points lie on a line.
    if !(eigen.eigenvalues[order[1]] > 1e-9 * eigen.eigenvalues[order[8]]) {
        return None;
    }
    let h = eigen.eigenvectors.column(order[0]);
    let h = Matrix3::from_row_slice(h.clone_owned().as_slice());
    let h = to.try_inverse()? * h * from;
    h.iter().all(|x| x.is_finite()).then(|| h / h[(2, 2)])
}

/// The lens of a camera that saw a plane from several places, without distortion: Zhang's closed form, without skew. `None` where they do not tell it.
pub fn lens_of(homographies: &[Matrix3<f64>]) -> Option<Lens> {
    // Bring pixels to about 1, for the digits.
    let reach = homographies
        .iter()
        .map(|h| through(h, [0.0, 0.0]))
        .fold(1.0f64, |most, [x, y]| most.max(x.abs()).max(y.abs()));
    let shrink = Matrix3::from_diagonal(&Vector3::new(1.0 / reach, 1.0 / reach, 1.0));
    let mut rows: Vec<[f64; 6]> = Vec::new();
    for h in homographies {
        let h = shrink * h;
        let h = h / h.column(0).norm().max(h.column(1).norm());
        let v = |i: usize, j: usize| {
            let (a, b) = (h.column(i), h.column(j));
            [
                a[0] * b[0],
                a[0] * b[1] + a[1] * b[0],
                a[1] * b[1],
                a[2] * b[0] + a[0] * b[2],
                a[2] * b[1] + a[1] * b[2],
                a[2] * b[2],
            ]
        };
        let (v01, v00, v11) = (v(0, 1), v(0, 0), v(1, 1));
        rows.push(v01);
        rows.push(std::array::from_fn(|i| v00[i] - v11[i]));
    }
    // No skew.
    rows.push([0.0, 1.0, 0.0, 0.0, 0.0, 0.0]);
    let matrix = DMatrix::from_fn(rows.len(), 6, |i, j| rows[i][j]);
    let eigen = (matrix.transpose() * &matrix).symmetric_eigen();
    let least = eigen.eigenvalues.imin();
    let b = eigen.eigenvectors.column(least);
    let [b11, b12, b22, b13, b23, b33] = [b[0], b[1], b[2], b[3], b[4], b[5]];
    let determinant = b11 * b22 - b12 * b12;
    let cy = (b12 * b13 - b11 * b23) / determinant;
    let lambda = b33 - (b13 * b13 + cy * (b12 * b13 - b11 * b23)) / b11;
    let (fx, fy) = ((lambda / b11).sqrt(), (lambda * b11 / determinant).sqrt());
    let cx = -b13 * fx * fx / lambda;
    let lens = Lens {
        focal: [fx * reach, fy * reach],
        centre: [cx * reach, cy * reach],
        distortion: [0.0; 5],
    };
    lens.numbers().iter().all(|n| n.is_finite()).then_some(lens)
}

/// Where the camera stands that sees a plane thus: the plane's origin and its two axes in the world (unit length, at right angles), the homography
/// from mm along them to directions (x right, y down at distance 1). `None` where no camera sees it so.
pub fn camera_of(h: &Matrix3<f64>, origin: Vec3, axes: [Vec3; 2]) -> Option<Frame> {
    let scale = 2.0 / (h.column(0).norm() + h.column(1).norm());
    // The plane is ahead of the camera.
    let scale = if h[(2, 2)] < 0.0 { -scale } else { scale };
    let (a, b, t) = (h.column(0) * scale, h.column(1) * scale, h.column(2) * scale);
    let turned = Matrix3::from_columns(&[a, b, a.cross(&b)]);
    let svd = turned.svd(true, true);
    let rotation = svd.u? * svd.v_t?;
    let plain = |v: Vec3| Vector3::new(v.x, v.y, v.z);
    let plane =
        Matrix3::from_columns(&[plain(axes[0]), plain(axes[1]), plain(axes[0].cross(axes[1]))]);
    // Rows: the camera's axes in the world.
    let world = rotation * plane.transpose();
    let axis = |i: usize| Vec3::new(world[(i, 0)], world[(i, 1)], world[(i, 2)]);
    let axes = [axis(0), axis(1), axis(2)];
    let place = origin - axes[0] * t[0] - axes[1] * t[1] - axes[2] * t[2];
    let frame = Frame { origin: place, axes };
    (place.is_finite() && world.determinant() > 0.0).then_some(frame)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::{looking_at, seen_at};

    const LENS: Lens =
        Lens { focal: [3000.0, 2950.0], centre: [1510.0, 990.0], distortion: [0.0; 5] };

    fn plane() -> (Vec3, [Vec3; 2]) {
        let frame = Frame::new(Vec3::new(2.0, -3.0, 5.0), [4.0, 12.0, -7.0]);
        (frame.origin, [frame.axes[0], frame.axes[1]])
    }

    fn photograph(from: Vec3, wrong: usize) -> Vec<Pair> {
        let (origin, [a, b]) = plane();
        let camera = looking_at(from, Vec3::ZERO);
        let mut pairs = Vec::new();
        for i in -5..=5 {
            for j in -4..=4 {
                let on_plane = [3.0 * f64::from(i), 3.0 * f64::from(j)];
                let point = origin + a * on_plane[0] + b * on_plane[1];
                let seen = seen_at(&camera, &LENS, point).expect("ahead");
                pairs.push(Pair { on_plane, seen });
            }
        }
        for pair in pairs.iter_mut().step_by(7).take(wrong) {
            pair.seen[0] += 60.0;
        }
        pairs
    }

    const PLACES: [Vec3; 4] = [
        Vec3::new(0.0, 30.0, 700.0),
        Vec3::new(250.0, -40.0, 600.0),
        Vec3::new(-220.0, 150.0, 650.0),
        Vec3::new(60.0, 260.0, 560.0),
    ];

    #[test]
    fn the_lens_and_the_place_of_a_perfect_camera_come_back() {
        let homographies: Vec<_> =
            PLACES.iter().map(|&from| homography(&photograph(from, 0)).expect("pairs")).collect();
        let lens = lens_of(&homographies).expect("four views");
        for (found, true_one) in lens.numbers().iter().zip(LENS.numbers()) {
            // No noise: what is left is rounding, a thousandfold by the inversion.
            assert!((found - true_one).abs() < 1e-3, "{lens:?}");
        }
        let (origin, axes) = plane();
        let pairs: Vec<Pair> = photograph(PLACES[1], 0)
            .into_iter()
            .map(|pair| Pair { seen: LENS.direction(pair.seen), ..pair })
            .collect();
        let camera =
            camera_of(&homography(&pairs).expect("pairs"), origin, axes).expect("a camera");
        assert!((camera.origin - PLACES[1]).length() < 1e-5, "{camera:?}");
        let ahead = (Vec3::ZERO - PLACES[1]).normalized();
        assert!((camera.axes[2] - ahead).length() < 1e-8, "{camera:?}");
    }

    #[test]
    fn some_wrong_pairs_change_little() {
        let pairs = photograph(PLACES[2], 10);
        let h = homography(&pairs).expect("pairs");
        let right = photograph(PLACES[2], 0);
        for pair in right {
            let at = through(&h, pair.on_plane);
            // A tenth of the pairs are 60 px off; a beginning within half a pixel leads the fit home.
            assert!((at[0] - pair.seen[0]).hypot(at[1] - pair.seen[1]) < 0.5, "{at:?}");
        }
    }

    #[test]
    fn points_on_a_line_tell_no_homography() {
        let on_a_line: Vec<Pair> = (0..9)
            .map(|i| Pair {
                on_plane: [f64::from(i), 2.0 * f64::from(i)],
                seen: [f64::from(i), 1.0],
            })
            .collect();
        assert!(homography(&on_a_line).is_none());
        assert!(homography(&on_a_line[..3]).is_none());
    }
}
