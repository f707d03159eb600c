use super::*;
use crate::map::{Map, Status, pixel_centre};
use crate::picture::display_image;

/// Where the line of sight to image uv meets the display behind a glass ball: the image, 26 x 26, at the
/// centre of a sphere of radius 25 and index 1.49, seen from 400; the display, 32 x 32, is where the image's mirror image
/// in the plate is, so that plate and display drop out and the refracted ray's line meets the image plane.
fn ball(uv: [f64; 2]) -> Option<[f64; 2]> {
    let (radius, index) = (25.0f64, 1.49f64);
    let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let along =
        |p: [f64; 3], t: f64, d: [f64; 3]| [p[0] + t * d[0], p[1] + t * d[1], p[2] + t * d[2]];
    let refract = |d: [f64; 3], n: [f64; 3], ratio: f64| {
        let cosine = -dot(d, n);
        let square = 1.0 - ratio * ratio * (1.0 - cosine * cosine);
        (square > 0.0).then(|| {
            let k = ratio * cosine - square.sqrt();
            [ratio * d[0] + k * n[0], ratio * d[1] + k * n[1], ratio * d[2] + k * n[2]]
        })
    };
    let eye = [0.0, 0.0, 400.0];
    let d = [26.0 * uv[0] - 13.0, 26.0 * uv[1] - 13.0, -400.0];
    let d = d.map(|x| x / dot(d, d).sqrt());
    let b = dot(eye, d);
    let t = -b - (b * b - dot(eye, eye) + radius * radius).sqrt();
    let entry = along(eye, t, d);
    let inside = refract(d, entry.map(|x| x / radius), 1.0 / index)?;
    let exit = along(entry, -2.0 * dot(entry, inside), inside);
    let out = refract(inside, exit.map(|x| -x / radius), index)?;
    let hit = along(exit, -exit[2] / out[2], out);
    Some([hit[0] / 32.0 + 0.5, hit[1] / 32.0 + 0.5])
}

fn view_samples(size: usize, side: usize) -> ViewSamples {
    let mut st = Vec::new();
    for index in 0..size * size {
        for k in 0..side * side {
            let u = ((index % size) as f64 + ((k % side) as f64 + 0.5) / side as f64) / size as f64;
            let v = 1.0
                - ((index / size) as f64 + ((k / side) as f64 + 0.5) / side as f64) / size as f64;
            st.push(ball([u, v]).unwrap_or([f64::NAN; 2]));
        }
    }
    ViewSamples { size: [size; 2], each: side * side, st }
}

/// The ball's map, by Newton's method with difference quotients.
fn ball_map(size: usize) -> Map {
    let mut map = Map::identity(size, size);
    for (index, uv) in map.uv.iter_mut().enumerate() {
        let st = pixel_centre(index % size, index / size, size, size);
        let mut guess = st;
        for _ in 0..30 {
            let step = 1e-6;
            let difference = |f: Option<[f64; 2]>| f.map(|f| [f[0] - st[0], f[1] - st[1]]);
            let (Some(f), Some(fu), Some(fv)) = (
                difference(ball(guess)),
                difference(ball([guess[0] + step, guess[1]])),
                difference(ball([guess[0], guess[1] + step])),
            ) else {
                break;
            };
            let [a, c] = [(fu[0] - f[0]) / step, (fu[1] - f[1]) / step];
            let [b, d] = [(fv[0] - f[0]) / step, (fv[1] - f[1]) / step];
            let determinant = a * d - b * c;
            guess[0] -= (d * f[0] - b * f[1]) / determinant;
            guess[1] -= (a * f[1] - c * f[0]) / determinant;
        }
        let met = ball(guess).is_some_and(|f| (f[0] - st[0]).hypot(f[1] - st[1]) < 1e-9);
        if met && guess.iter().all(|x| (0.0..=1.0).contains(x)) {
            *uv = guess;
        } else {
            (*uv, map.status[index]) = ([f64::NAN; 2], Status::Outside);
        }
    }
    map
}

/// What photographs have: waves whose strength falls as their frequency grows, edges all over, deep shadows and lights.
fn scenery(size: usize, seed: u64) -> Picture {
    let mut random = fastrand::Rng::with_seed(seed);
    let waves: Vec<[f64; 4]> = (0..60)
        .map(|k| {
            let frequency = 1.08f64.powi(k);
            let turn = std::f64::consts::TAU * random.f64();
            let (sin, cos) = turn.sin_cos();
            [
                frequency * cos,
                frequency * sin,
                std::f64::consts::TAU * random.f64(),
                0.25 / frequency,
            ]
        })
        .collect();
    let discs: Vec<[f64; 6]> = (0..40)
        .map(|_| {
            let [x, y, radius, r, g, b] = std::array::from_fn(|_| random.f64());
            [x, y, 0.02 + 0.15 * radius * radius, r * r, g * g, b * b]
        })
        .collect();
    let pixels = (0..size * size)
        .map(|i| {
            let [x, y] = [i % size, i / size].map(|k| (k as f64 + 0.5) / size as f64);
            let wave = |[a, b, phase, height]: &[f64; 4]| {
                height * (std::f64::consts::TAU * (a * x + b * y) + phase).sin()
            };
            let shade = 1.0 + waves.iter().map(wave).sum::<f64>();
            let over = discs.iter().rev().find(|d| (x - d[0]).hypot(y - d[1]) < d[2]);
            let colour = over.map_or([0.3, 0.25 + 0.3 * y, 0.4], |d| [d[3], d[4], d[5]]);
            let [r, g, b] = colour.map(|c| (c * shade).clamp(0.0, 1.0) as f32);
            [r, g, b, 1.0]
        })
        .collect();
    Picture { width: size, height: size, pixels }
}

fn psnr(a: &Picture, b: &Picture) -> f64 {
    let mut sum = 0.0;
    for (p, q) in a.pixels.iter().zip(&b.pixels) {
        for c in 0..3 {
            let difference = f64::from(srgb::encode_8(p[c])) - f64::from(srgb::encode_8(q[c]));
            sum += difference * difference / 65025.0;
        }
    }
    -10.0 * (sum / (3 * a.pixels.len()) as f64).log10()
}

/// Solves (m + m^T) / 2 x = b for a positive definite m by Cholesky's decomposition.
fn cholesky_solve(m: &[Vec<f64>], b: &[f64]) -> Vec<f64> {
    let n = b.len();
    let mut l = vec![vec![0.0; n]; n];
    for i in 0..n {
        for j in 0..=i {
            let sum: f64 = m[i][j] - (0..j).map(|k| l[i][k] * l[j][k]).sum::<f64>();
            l[i][j] = if i == j { sum.sqrt() } else { sum / l[j][j] };
        }
    }
    let mut x = b.to_vec();
    for i in 0..n {
        x[i] = (x[i] - (0..i).map(|k| l[i][k] * x[k]).sum::<f64>()) / l[i][i];
    }
    for i in (0..n).rev() {
        x[i] = (x[i] - (i + 1..n).map(|k| l[k][i] * x[k]).sum::<f64>()) / l[i][i];
    }
    x
}

/// The optimum of |A x - y|^2 weighted, 0 <= x <= 1, by projected Newton steps (Bertsekas 1982) on dense
/// matrices; certified by the conditions of Karush, Kuhn and Tucker.
fn dense_optimum(a: &[Vec<f64>], y: &[f64], weight: &[f64]) -> f64 {
    let (rows, n) = (a.len(), a[0].len());
    let mut h = vec![vec![0.0; n]; n];
    let mut b = vec![0.0; n];
    for r in 0..rows {
        let entries: Vec<usize> = (0..n).filter(|&i| a[r][i] != 0.0).collect();
        for &i in &entries {
            b[i] += weight[r] * a[r][i] * y[r];
            for &j in &entries {
                h[i][j] += weight[r] * a[r][i] * a[r][j];
            }
        }
    }
    let objective = |x: &[f64]| -> f64 {
        let row = |r: usize| (0..n).map(|i| a[r][i] * x[i]).sum::<f64>() - y[r];
        (0..rows).map(|r| weight[r] * row(r).powi(2)).sum()
    };
    let mut x = vec![0.5; n];
    for _ in 0..200 {
        let g: Vec<f64> =
            (0..n).map(|i| (0..n).map(|j| h[i][j] * x[j]).sum::<f64>() - b[i]).collect();
        let free: Vec<usize> = (0..n)
            .filter(|&i| !(x[i] <= 0.0 && g[i] >= 0.0 || x[i] >= 1.0 && g[i] <= 0.0))
            .collect();
        if free.iter().all(|&i| g[i].abs() < 1e-10) {
            return objective(&x);
        }
        let sub: Vec<Vec<f64>> =
            free.iter().map(|&i| free.iter().map(|&j| h[i][j]).collect()).collect();
        let rhs: Vec<f64> = free.iter().map(|&i| -g[i]).collect();
        let step = cholesky_solve(&sub, &rhs);
        let before = objective(&x);
        let mut length = 1.0;
        loop {
            let mut next = x.clone();
            for (&i, s) in free.iter().zip(&step) {
                next[i] = (x[i] + length * s).clamp(0.0, 1.0);
            }
            if objective(&next) < before || length < 1e-12 {
                x = next;
                break;
            }
            length *= 0.5;
        }
    }
    panic!("the dense solver did not reach the optimum");
}

/// A hard small target: noise with black and white, so that many bounds are active.
fn noise_target(size: usize) -> Picture {
    let mut state = 1u64;
    let pixels = (0..size * size)
        .map(|_| {
            let mut next = || {
                state = state
                    .wrapping_mul(6_364_136_223_846_793_005)
                    .wrapping_add(1_442_695_040_888_963_407);
                ((state >> 40) as f32 / (1u64 << 24) as f32 * 1.6 - 0.3).clamp(0.0, 1.0)
            };
            [next(), next(), next(), 1.0]
        })
        .collect();
    Picture { width: size, height: size, pixels }
}

#[test]
fn the_sparse_solution_is_within_a_tenth_of_a_decibel_of_the_dense_optimum() {
    // The view is a little finer than the display, so that every display pixel is seen and the optimum
    // is not a perfect fit.
    let (view, display) = (28, 24);
    let samples = view_samples(view, 4);
    let target = noise_target(view);
    let mut matrix = vec![vec![0.0f64; display * display]; view * view];
    for (r, rays) in samples.st.chunks(16).enumerate() {
        for st in rays {
            // Written out anew: the bilinear weights as a product of two hats.
            let hat = |x: f64, centre: usize| (1.0 - (x - centre as f64).abs()).max(0.0);
            for row in 0..display {
                for column in 0..display {
                    let x = (st[0] * display as f64 - 0.5).clamp(0.0, display as f64 - 1.0);
                    let y = ((1.0 - st[1]) * display as f64 - 0.5).clamp(0.0, display as f64 - 1.0);
                    matrix[r][row * display + column] += hat(x, column) * hat(y, row) / 16.0;
                }
            }
        }
    }
    // Pixels in the display's corners that no ray reaches have no say: leave their columns out.
    let seen: Vec<usize> =
        (0..display * display).filter(|&i| matrix.iter().any(|row| row[i] > 0.0)).collect();
    let matrix: Vec<Vec<f64>> =
        matrix.iter().map(|row| seen.iter().map(|&i| row[i]).collect()).collect();
    let initial = Picture::filled(display, display, [0.5, 0.5, 0.5, 1.0]);
    for weighting in [Weighting::Linear, Weighting::Encoded] {
        let best = optimal_display(&samples, target.clone(), initial.clone(), weighting).unwrap();
        let reached = view_through(&samples, &best.display).unwrap();
        assert!(best.display.pixels.iter().flatten().all(|value| (0.0..=1.0).contains(value)));
        for c in 0..3 {
            let y: Vec<f64> = target.pixels.iter().map(|pixel| f64::from(pixel[c])).collect();
            let weight: Vec<f64> = match weighting {
                Weighting::Linear => vec![1.0; y.len()],
                Weighting::Encoded => y.iter().map(|&y| srgb::encode_slope(y).powi(2)).collect(),
            };
            let optimum = dense_optimum(&matrix, &y, &weight);
            let ours: f64 = reached
                .pixels
                .iter()
                .zip(y.iter().zip(&weight))
                .map(|(pixel, (y, weight))| weight * (f64::from(pixel[c]) - y).powi(2))
                .sum();
            let gap = 10.0 * (ours / optimum).log10();
            println!("{weighting:?} channel {c}: optimum {optimum:.4}, {gap:.4} dB above it");
            // Not below it either, but for the float sums of 784 rows.
            assert!((-1e-3..0.1).contains(&gap), "{gap} dB");
        }
    }
}

#[test]
fn the_view_of_white_is_the_share_of_rays_that_end_on_the_display() {
    let mut samples = view_samples(16, 2);
    for st in samples.st.iter_mut().step_by(3) {
        *st = [f64::NAN; 2];
    }
    samples.st[4] = [1.5, 0.5];
    let view = view_through(&samples, &Picture::filled(9, 7, [1.0; 4])).unwrap();
    for (pixel, rays) in view.pixels.iter().zip(samples.st.chunks(4)) {
        let lit = rays.iter().filter(|st| (0.0..=1.0).contains(&st[0])).count();
        // Sixteen float weights that sum to 1.
        assert!((pixel[0] - lit as f32 / 4.0).abs() < 1e-6);
    }
}

#[test]
fn the_transpose_is_the_transpose() {
    let samples = view_samples(20, 2);
    let forward = SparseRows::from_view(&samples, 13, 17);
    let backward = forward.transposed(13 * 17);
    let mut pixels = noise_target(20).pixels;
    let y = pixels.split_off(100)[..].to_vec();
    let (x, y) = (noise_target(15).pixels[..221].to_vec(), [y, pixels].concat());
    let shown = Picture { width: 13, height: 17, pixels: x.clone() };
    let view = view_through(&samples, &shown).unwrap();
    let [x, y] = [x, y]
        .map(|pixels| -> Vec<Rgb> { pixels.into_iter().map(|[r, g, b, _]| [r, g, b]).collect() });
    let mut ax = vec![[0.0; 3]; 400];
    let mut aty = vec![[0.0; 3]; 221];
    forward.multiply(&x, &mut ax, |_, value, _| (value, [0.0; 3]));
    backward.multiply(&y, &mut aty, |_, value, _| (value, [0.0; 3]));
    for (product, seen) in ax.iter().zip(&view.pixels) {
        // The matrix is the view, but for up to 16 weights of 16 bits, each less than a unit off.
        assert!((0..3).all(|c| (product[c] - seen[c]).abs() < 16.0 / 65535.0));
    }
    let dot = |a: &[Rgb], b: &[Rgb]| -> f64 {
        a.iter().zip(b).map(|(a, b)| f64::from(a[0]) * f64::from(b[0])).sum()
    };
    let (left, right) = (dot(&ax, &y), dot(&x, &aty));
    // <A x, y> = <x, A^T y>, both sums of about 100 built of floats.
    assert!((left / right - 1.0).abs() < 1e-5 && left > 10.0);
}

#[test]
fn an_identity_view_asks_for_the_target_itself() {
    let target = noise_target(16);
    let st = (0..256).map(|i| pixel_centre(i % 16, i / 16, 16, 16)).collect();
    let samples = ViewSamples { size: [16; 2], each: 1, st };
    let black = Picture::filled(16, 16, [0.0, 0.0, 0.0, 1.0]);
    let best = optimal_display(&samples, target.clone(), black, Weighting::Linear).unwrap();
    let scatter = scatter_average(&samples, &target, 16, 16).unwrap();
    for i in 0..256 {
        for c in 0..4 {
            // A is the identity but for the rounding of the st, 1e-7 of a pixel.
            assert!((best.display.pixels[i][c] - target.pixels[i][c]).abs() < 1e-5);
            assert!((scatter.pixels[i][c] - target.pixels[i][c]).abs() < 1e-5);
        }
    }
}

#[test]
fn pixels_that_no_ray_reaches_stay_as_they_were() {
    let samples = ViewSamples { size: [2, 1], each: 1, st: vec![[0.1, 0.1]; 2] };
    let initial = noise_target(8);
    let best = optimal_display(&samples, noise_target(2), initial.clone(), Weighting::Encoded);
    assert!(best.is_err());
    let target = Picture::filled(2, 1, [0.2, 0.9, 0.0, 1.0]);
    let best = optimal_display(&samples, target.clone(), initial.clone(), Weighting::Encoded)
        .unwrap()
        .display;
    let changed = (0..64).filter(|&i| best.pixels[i] != initial.pixels[i]).count();
    assert!((1..=4).contains(&changed), "{changed}");
    let dark = ViewSamples { st: vec![[f64::NAN; 2]; 2], ..samples };
    assert_eq!(
        optimal_display(&dark, target, initial.clone(), Weighting::Encoded).unwrap().display,
        initial
    );
}

#[test]
fn sizes_that_disagree_are_refused() {
    let samples = ViewSamples { size: [2, 2], each: 1, st: vec![[0.5; 2]; 4] };
    let picture = noise_target(2);
    let none = ViewSamples { size: [0, 2], each: 1, st: vec![] };
    let error = view_through(&none, &picture).unwrap_err().to_string();
    assert!(error.contains("0 x 2 pixels"), "{error}");
    let best = optimal_display(&samples, noise_target(3), picture, Weighting::Linear);
    assert!(best.is_err());
    let picture = noise_target(2);
    assert!(scatter_average(&samples, &picture, 0, 5).is_err());
}

/// Plain filter, averaged scatter and best image side by side. That of all displays the best one comes nearest is what it is sought
/// for; that a filter without holes is better than an average of what was scattered, and either than no compensation, is what compensation is for.
#[test]
fn the_best_image_beats_the_plain_filter_and_the_averaged_scatter() {
    let size = 192;
    let samples = view_samples(size, 3);
    let map = ball_map(size);
    println!("PSNR in dB of a {size} x {size} view, display {size} x {size}");
    for seed in [1, 2] {
        let target = scenery(size, seed);
        let see = |display: &Picture| psnr(&view_through(&samples, display).unwrap(), &target);
        let plain = display_image(&target, &map);
        let none = see(&display_image(&target, &Map::identity(size, size)));
        let scatter = see(&scatter_average(&samples, &target, size, size).unwrap());
        let best = |weighting| {
            see(&optimal_display(&samples, target.clone(), plain.clone(), weighting)
                .unwrap()
                .display)
        };
        let (linear, encoded) = (best(Weighting::Linear), best(Weighting::Encoded));
        let plain = see(&plain);
        println!(
            "{seed}: uncompensated {none:.2}, averaged scatter {scatter:.2}, plain filter {plain:.2}, \
             best by light {linear:.2}, best as encoded {encoded:.2}"
        );
        assert!(encoded > plain + 2.0 && plain > scatter && scatter > none + 5.0);
        assert!(encoded > linear);
    }
}
