//! The built-in picture: colours, edges, fine detail and text, on which distortion and blur show at once.

use super::Lettering;
use midair::picture::{Picture, srgb};

/// Samples along each side of a pixel: edges are drawn smooth.
const SAMPLES: usize = 4;

/// Draws the picture at any size; linear light.
pub fn draw(width: usize, height: usize) -> Picture {
    let aspect = width as f64 / height as f64;
    let mut pixels = Vec::with_capacity(width * height);
    for row in 0..height {
        for column in 0..width {
            let mut sum = [0.0f32; 3];
            for sample in 0..SAMPLES * SAMPLES {
                let at = |pixel: usize, k: usize| pixel as f64 + (k as f64 + 0.5) / SAMPLES as f64;
                // x from -aspect to aspect, y from -1 (bottom) to 1.
                let x = (2.0 * at(column, sample % SAMPLES) / width as f64 - 1.0) * aspect;
                let y = 1.0 - 2.0 * at(row, sample / SAMPLES) / height as f64;
                let colour = colour(x, y, aspect);
                (0..3).for_each(|c| sum[c] += colour[c]);
            }
            let [r, g, b] = sum.map(|total| total / (SAMPLES * SAMPLES) as f32);
            pixels.push([r, g, b, 1.0]);
        }
    }
    let mut picture = Picture { width, height, pixels };
    label(&mut picture);
    picture
}

fn label(picture: &mut Picture) {
    let (width, height) = (picture.width as f64, picture.height as f64);
    let white = Lettering::large([1.0; 3]);
    let mut centred = |letters: Lettering, text: &str, middle: f64, size: f64| {
        let scale = size * height / letters.height() as f64;
        let left = 0.5 * (width - letters.width(text) as f64 * scale);
        letters.enlarged(picture, text, [left, middle * height - 0.5 * size * height], scale);
    };
    centred(white, "midair", 0.199, 0.115);
    centred(white, "straight where it floats, whatever bends the light", 0.921, 0.035);
}

/// Linear colour at a place of the picture: x from -aspect to aspect, y from -1 at the bottom to 1.
fn colour(x: f64, y: f64, aspect: f64) -> [f32; 3] {
    let radius = x.hypot(y);
    let angle = y.atan2(x);
    let border = (1.0 - y.abs()).min(aspect - x.abs());
    if border < 0.04 {
        // A checkered frame: its squares show where the border goes.
        let squares = 25.0;
        let odd = ((x + aspect) * squares).floor() as i64 + ((y + 1.0) * squares).floor() as i64;
        return if odd % 2 == 0 {
            encoded([0.93, 0.93, 0.90])
        } else {
            encoded([0.10, 0.11, 0.13])
        };
    }
    if radius < 0.16 {
        // A Siemens star: 36 spokes, as fine as they get towards the middle.
        let dark = (angle * 36.0 / std::f64::consts::TAU).rem_euclid(1.0) < 0.5;
        return encoded(if dark && radius > 0.012 {
            [0.08, 0.08, 0.10]
        } else {
            [0.97, 0.97, 0.95]
        });
    }
    if (0.185..0.36).contains(&radius) {
        return hue(angle / std::f64::consts::TAU, 0.25 + 0.75 * ((radius - 0.185) / 0.175));
    }
    if (0.36..0.375).contains(&radius) {
        return encoded([0.97, 0.97, 0.95]);
    }
    if let Some(patch) = corner(x, y, aspect) {
        return patch;
    }
    let grid = |at: f64| (at / 0.24 - (at / 0.24).round()).abs() * 0.24 < 0.006;
    let background = background(x / aspect, y);
    if grid(x) || grid(y) {
        // The lattice lets a third of the ground through.
        let line = encoded([1.0, 0.86, 0.30]);
        return std::array::from_fn(|c| 0.67 * line[c] + 0.33 * background[c]);
    }
    background
}

/// Round patches towards the four corners: rings, grey steps, bars, a smooth ball.
fn corner(x: f64, y: f64, aspect: f64) -> Option<[f32; 3]> {
    let (cx, cy) = (x.abs() - (aspect - 0.36), y.abs() - 0.48);
    let radius = cx.hypot(cy);
    if radius > 0.2 {
        return None;
    }
    if radius > 0.187 {
        return Some(encoded([0.97, 0.97, 0.95]));
    }
    // Coordinates within the patch, right and up.
    let (px, py) = (x - x.signum() * (aspect - 0.36), y - y.signum() * 0.48);
    Some(match (x > 0.0, y > 0.0) {
        // Rings that narrow outwards.
        (false, true) => {
            let wave = 0.5 + 0.5 * (1600.0 * radius * radius).cos();
            [wave as f32; 3]
        }
        // Six steps of grey.
        (true, true) => {
            let step = ((px + 0.187) / 0.374 * 6.0).floor().clamp(0.0, 5.0) / 5.0;
            encoded([step as f32; 3])
        }
        // Bars, finer downwards.
        (false, false) => {
            let period = if py > 0.06 {
                0.05
            } else if py > -0.06 {
                0.025
            } else {
                0.0125
            };
            encoded(if (px / period).rem_euclid(1.0) < 0.5 {
                [0.95, 0.25, 0.20]
            } else {
                [0.98, 0.95, 0.85]
            })
        }
        // A lit ball.
        (true, false) => {
            let z = (0.187f64 * 0.187 - px * px - py * py).max(0.0).sqrt();
            let light = ((-0.45 * px + 0.55 * py + 0.70 * z) / 0.187).max(0.0);
            let gleam = light.powi(24);
            [0.02 + 0.12 * light + gleam, 0.03 + 0.55 * light + gleam, 0.08 + 0.80 * light + gleam]
                .map(|value| value.min(1.0) as f32)
        }
    })
}

/// A dusk sky: dark blue above, through violet, to orange below.
fn background(x: f64, y: f64) -> [f32; 3] {
    let stops = [[0.96, 0.55, 0.28], [0.74, 0.24, 0.45], [0.25, 0.16, 0.47], [0.05, 0.09, 0.24]];
    let place = (0.5 * (y + 1.0) + 0.06 * x).clamp(0.0, 1.0) * 3.0;
    let (index, share) = ((place as usize).min(2), place - (place as usize).min(2) as f64);
    let mix = |c: usize| {
        let (low, high): (f64, f64) = (stops[index][c], stops[index + 1][c]);
        (low + (high - low) * share) as f32
    };
    encoded([mix(0), mix(1), mix(2)])
}

/// A hue (a turn is 1) of full brightness and some saturation.
fn hue(turn: f64, saturation: f64) -> [f32; 3] {
    encoded(std::array::from_fn(|c| {
        let distance = ((turn - c as f64 / 3.0).rem_euclid(1.0) * 6.0 - 3.0).abs();
        let full = (distance - 1.0).clamp(0.0, 1.0);
        (1.0 - saturation * (1.0 - full)) as f32
    }))
}

/// Linear light of an sRGB-encoded colour.
fn encoded(colour: [f32; 3]) -> [f32; 3] {
    colour.map(|value| srgb::decode(f64::from(value)) as f32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_has_all_tones_and_colours_and_fine_detail() {
        let picture = draw(256, 256);
        let channel = |c: usize| picture.pixels.iter().map(move |pixel| pixel[c]);
        for c in 0..3 {
            assert!(channel(c).all(|value| (0.0..=1.0).contains(&value)));
            assert!(channel(c).any(|value| value > 0.9) && channel(c).any(|value| value < 0.02));
        }
        // Detail: the mean step between neighbours is a few percent of the range.
        let steps =
            picture.pixels.windows(2).map(|pair| f64::from((pair[0][1] - pair[1][1]).abs()));
        assert!(steps.sum::<f64>() / 65535.0 > 0.02);
    }
}
