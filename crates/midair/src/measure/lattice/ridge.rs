//! Bright lines as ridges of the smoothed picture (Steger 1998, "An unbiased detector of
//! curvilinear structures", section 3).

use rayon::prelude::*;

use super::super::Plane;
use super::super::filter::Samples;

/// A picture smoothed at one scale, with the strength of ridges and of their crossings.
pub(super) struct RidgeField {
    smooth: Samples,
    /// The scale: the Gaussian's sigma, pixels.
    pub sigma: f64,
    /// Curvature across the strongest ridge direction, times sigma squared (0 where not bright).
    pub strength: Vec<f32>,
    /// Curvature in the other direction: positive only where the picture falls off both ways,
    /// as it does where two lines meet.
    pub crossing: Vec<f32>,
}

/// Value, slope and curvature at a place: what one line looks like from there.
pub(super) struct Jet {
    /// Unit vector along the ridge.
    pub along: [f64; 2],
    /// Curvature across the ridge, times sigma squared; positive on a bright line.
    pub strength: f64,
    /// From the place to the ridge's centre, across the ridge, pixels.
    pub to_centre: [f64; 2],
}

impl RidgeField {
    pub fn new(picture: &Plane, sigma: f64) -> Self {
        let smooth = Samples::from(picture).blurred(sigma);
        let (width, height) = (smooth.width, smooth.height);
        let mut strength = vec![0.0; width * height];
        let mut crossing = vec![0.0; width * height];
        let rows = strength.par_chunks_mut(width).zip(crossing.par_chunks_mut(width));
        rows.enumerate().skip(1).take(height.saturating_sub(2)).for_each(
            |(row, (lines, meets))| {
                for column in 1..width - 1 {
                    let value = |dx: isize, dy: isize| {
                        let at = (row as isize + dy) * width as isize + column as isize + dx;
                        smooth.values[at as usize]
                    };
                    let (least, most) = eigenvalues(second_differences(value));
                    lines[column] = (-least * sigma * sigma).max(0.0) as f32;
                    meets[column] = (-most * sigma * sigma).max(0.0) as f32;
                }
            },
        );
        Self { smooth, sigma, strength, crossing }
    }

    pub fn width(&self) -> usize {
        self.smooth.width
    }

    pub fn height(&self) -> usize {
        self.smooth.height
    }

    /// Whether a place has all the neighbours that [`RidgeField::jet`] reads.
    pub fn contains(&self, [x, y]: [f64; 2]) -> bool {
        x >= 2.0 && y >= 2.0 && x <= self.width() as f64 - 2.0 && y <= self.height() as f64 - 2.0
    }

    /// The ridge as seen from a place inside the picture (two pixels from its border at least).
    pub fn jet(&self, [x, y]: [f64; 2]) -> Jet {
        let value = |dx: isize, dy: isize| {
            bilinear(&self.smooth.values, self.width(), self.height(), x + dx as f64, y + dy as f64)
        };
        let hessian = second_differences(value);
        let gradient = [0.5 * (value(1, 0) - value(-1, 0)), 0.5 * (value(0, 1) - value(0, -1))];
        let (least, _) = eigenvalues(hessian);
        let [xx, xy, yy] = hessian;
        // The eigenvector of the least eigenvalue, from the better conditioned of its two forms.
        let across = if (xx - least).abs() > (yy - least).abs() {
            unit([-xy, xx - least])
        } else {
            unit([yy - least, -xy])
        };
        let slope = gradient[0] * across[0] + gradient[1] * across[1];
        let offset = if least < 0.0 { -slope / least } else { 0.0 };
        Jet {
            along: [-across[1], across[0]],
            strength: -least * self.sigma * self.sigma,
            to_centre: [offset * across[0], offset * across[1]],
        }
    }
}

/// Second differences of a 3 x 3 neighbourhood: xx, xy, yy.
fn second_differences(value: impl Fn(isize, isize) -> f64) -> [f64; 3] {
    let centre = 2.0 * value(0, 0);
    let mixed = value(1, 1) - value(1, -1) - value(-1, 1) + value(-1, -1);
    [value(1, 0) - centre + value(-1, 0), 0.25 * mixed, value(0, 1) - centre + value(0, -1)]
}

/// Least and greatest eigenvalue of the symmetric matrix xx, xy, yy.
fn eigenvalues([xx, xy, yy]: [f64; 3]) -> (f64, f64) {
    let (mean, spread) = (0.5 * (xx + yy), (0.5 * (xx - yy)).hypot(xy));
    (mean - spread, mean + spread)
}

/// The vector at length one; x for a vector without direction.
pub(super) fn unit([x, y]: [f64; 2]) -> [f64; 2] {
    let length = x.hypot(y);
    if length > 0.0 { [x / length, y / length] } else { [1.0, 0.0] }
}

/// Bilinear interpolation at a place in pixels from the top left corner, clamped to the picture.
pub(super) fn bilinear<T: Copy + Into<f64>>(
    values: &[T],
    width: usize,
    height: usize,
    x: f64,
    y: f64,
) -> f64 {
    let x = (x - 0.5).clamp(0.0, (width - 1) as f64);
    let y = (y - 0.5).clamp(0.0, (height - 1) as f64);
    let (column, row) = ((x as usize).min(width.max(2) - 2), (y as usize).min(height.max(2) - 2));
    let (right, down) = (usize::from(width > 1), usize::from(height > 1) * width);
    let (fx, fy) = (x - column as f64, y - row as f64);
    let at = row * width + column;
    let value = |offset: usize| -> f64 { values[at + offset].into() };
    let upper = value(0) + fx * (value(right) - value(0));
    let lower = value(down) + fx * (value(down + right) - value(down));
    upper + fy * (lower - upper)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_straight_line_is_a_ridge_along_itself_at_its_centre() {
        // A Gaussian line of sigma 2 through (40, 30), 25 degrees from x.
        let (sin, cos) = 25_f64.to_radians().sin_cos();
        let picture = Plane::from_fn(80, 60, |c, r| {
            let (x, y) = (c as f64 + 0.5 - 40.0, r as f64 + 0.5 - 30.0);
            (-0.5 * ((y * cos - x * sin) / 2.0).powi(2)).exp() as f32
        });
        let field = RidgeField::new(&picture, 2.0);
        // 0.8 px off the line, to one side.
        let jet = field.jet([40.0 + 0.8 * sin, 30.0 - 0.8 * cos]);
        // Differences over one pixel are not quite isotropic: half a degree at this scale.
        assert!((jet.along[0] * sin - jet.along[1] * cos).abs() < 0.01, "{:?}", jet.along);
        // One Newton step from 0.8 px on a Gaussian of total sigma 2.8: third-order remainder.
        let moved = jet.to_centre[1] * cos - jet.to_centre[0] * sin;
        assert!((moved - 0.8).abs() < 0.1, "{moved}");
        // Smoothing sigma 2 by 2: peak 1/sqrt 2, curvature peak / 8, times sigma^2 = 0.354. Second
        // differences over one pixel and interpolation at a pixel's corner smooth by 5/12 pixel
        // squared more each way, to the power -3/2: 0.354 * (8 / 8.42)^1.5 = 0.327.
        let strength = field.jet([40.0, 30.0]).strength;
        assert!((strength - 0.327).abs() < 0.01, "{strength}");
    }

    #[test]
    fn bilinear_reproduces_a_plane_and_clamps() {
        let values: Vec<f64> = (0..12).map(|i| (i % 4) as f64 + 10.0 * (i / 4) as f64).collect();
        assert!((bilinear(&values, 4, 3, 1.75, 2.25) - (1.25 + 17.5)).abs() < 1e-12);
        assert_eq!(bilinear(&values, 4, 3, -5.0, 99.0), 20.0);
        assert_eq!(bilinear(&[7.0_f64], 1, 1, 0.2, 0.9), 7.0);
    }
}
