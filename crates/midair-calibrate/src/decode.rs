//! From photographs of the patterns to the display point that each camera pixel sees.

use crate::decoded::{Decoded, Seen};
use crate::order::{MOST, Order, order};
use crate::patterns::{Pattern, Patterns, STEPS, cell_of_gray};
use crate::photographs::Photograph;
use midair::map::format::FileError;
use midair::{Error, Monitor};
use rayon::prelude::*;
use std::path::{Path, PathBuf};
use std::sync::Mutex;

/// A pixel whose white and black differ by less of the full scale sees nothing.
const LEAST_CONTRAST: f32 = 0.012 * 65535.0;

/// A bit whose pattern and inverse differ by less of what white and black do is not sure: at an edge between stripes, or where two images of
/// the display lie over one another.
const SURE: f32 = 0.35;

/// A sinusoid's depth, as a share of what white and black differ by: one that is blurred to less tells nothing.
const LEAST_DEPTH: f32 = 0.12;

/// How far steps may be from a sinusoid, rms over its depth: what the display's and the camera's response bend it by is half of that, and a corner's squares
/// are no sinusoid at all.
const MOST_OFF: f32 = 0.3;

/// Share of full scale above which a photograph is over-exposed.
const FULL: u16 = 64_500;

/// Decodes the photographs of one state of a view.
///
/// # Errors
/// Photographs that cannot be read, differ in size, are over-exposed, or of which patterns are missing.
pub fn decode_folder(
    patterns: &Patterns,
    folder: &Path,
    monitor: &dyn Monitor,
) -> Result<Decoded, Error> {
    let files = crate::photographs::in_folder(folder)?;
    let told = |problem: String, remedy: &str| -> Error {
        FileError::unsupported(folder, problem, remedy).into()
    };
    if files.len() > MOST {
        let problem =
            format!("{} photographs; {MOST} are the most for one state of a view", files.len());
        return Err(told(problem, "give each view and state a folder of its own"));
    }
    monitor.stage("photographs", files.len());
    let first: Mutex<Option<(usize, usize)>> = Mutex::new(None);
    let read = |path: &PathBuf| -> Result<Photograph, Error> {
        let photograph = Photograph::read(path)?;
        monitor.advance(1);
        let size = (photograph.width, photograph.height);
        let mut first = first.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        if *first.get_or_insert(size) != size {
            let problem = format!(
                "this photograph has {} x {} pixels, another one of its folder has others",
                size.0, size.1
            );
            return Err(FileError::unsupported(
                path,
                problem,
                "take all with one camera, held the same way",
            )
            .into());
        }
        Ok(photograph)
    };
    let photographs: Vec<Photograph> = files.par_iter().map(read).collect::<Result<_, _>>()?;
    let Some(order) = order(patterns, &photographs) else {
        let problem = format!(
            "it cannot be told which of the {} patterns each of the {} photographs shows: the squares in the patterns' corners are not seen",
            patterns.list.len(),
            photographs.len()
        );
        return Err(told(
            problem,
            "frame the whole floating picture, sharp and not over-exposed; or take each pattern once, in order, so that file names sort so",
        ));
    };
    let mut notes = Vec::new();
    if order.as_named {
        notes.push(format!("{}: the corners' squares are not seen; the photographs are taken in the order of their names", folder.display()));
    }
    for (which, why) in [
        (&order.doubles, "shows what another one does"),
        (&order.unknown, "shows no pattern, or was taken while it changed"),
    ] {
        notes.extend(which.iter().map(|&m| format!("{}: {why}; left out", files[m].display())));
    }
    let decoded = decode(patterns, &photographs, &order, notes).map_err(|missing| {
        told(missing, "take the missing ones again, from the same place, into the same folder")
    })?;
    exposure(&photographs, &order).map_err(|problem| {
        told(
            problem,
            "expose so that white is just below full: a shorter time, or a smaller aperture",
        )
    })?;
    agreement(&decoded).map_err(|problem| {
        told(
            problem,
            "photograph the patterns of this scene's display again, sharp, with camera and display on something firm: a tripod and a remote release",
        )
    })?;
    Ok(decoded)
}

/// Stripes from which on the mean place within a stripe means something: what is seen of a first and a last one by chance is an eighth of a stripe then.
const FEW_STRIPES: f64 = 4.0;

/// How far from 0 the mean place within a stripe may be, in stripes.
const MOST_LAG: f64 = 0.15;

/// Refuses photographs that do not agree with one another.
fn agreement(decoded: &Decoded) -> Result<(), String> {
    let counts = decoded.counts();
    let lit = counts.real + counts.unsure;
    if counts.real < lit / 4 {
        return Err(format!(
            "of {lit} pixels that see the display only {} tell which point of it: the photographs are blurred, something moved between them, or the display showed other patterns",
            counts.real
        ));
    }
    match decoded.lag.iter().find(|lag| lag.abs() > MOST_LAG) {
        Some(lag) => Err(format!(
            "something moved between the photographs: stripes and sinusoids are {:.1} stripes apart",
            lag.abs()
        )),
        None => Ok(()),
    }
}

/// Refuses photographs of which much is at full scale.
fn exposure(photographs: &[Photograph], order: &Order) -> Result<(), String> {
    let Some(white) = order.of[0].map(|m| &photographs[m]) else { return Ok(()) };
    let Some(black) = order.of[1].map(|m| &photographs[m]) else { return Ok(()) };
    let codes = || white.codes.iter().zip(&black.codes);
    let lit = codes().filter(|(w, b)| w.saturating_sub(**b) > 16_000).count();
    let full = codes().filter(|(w, b)| **w >= FULL && w.saturating_sub(**b) > 16_000).count();
    if lit > 0 && 3 * full > lit {
        return Err(format!(
            "the photographs are over-exposed: {} % of what is lit is full white",
            100 * full / lit
        ));
    }
    Ok(())
}

/// Decodes ordered photographs. The error says which patterns are missing.
///
/// # Errors
/// Where patterns are missing that nothing stands for.
pub fn decode(
    patterns: &Patterns,
    photographs: &[Photograph],
    order: &Order,
    notes: Vec<String>,
) -> Result<Decoded, String> {
    let of = |wanted: Pattern| {
        patterns
            .list
            .iter()
            .position(|&p| p == wanted)
            .and_then(|k| order.of[k])
            .map(|m| &photographs[m].codes[..])
    };
    let missing = |wanted: Pattern| {
        let k = patterns.list.iter().position(|&p| p == wanted).unwrap_or(0);
        patterns.file_name(k)
    };
    let mut lacking = Vec::new();
    let mut need = |wanted: Pattern| {
        let found = of(wanted);
        if found.is_none() {
            lacking.push(missing(wanted));
        }
        found.unwrap_or(&[])
    };
    let (white, black) = (need(Pattern::White), need(Pattern::Black));
    let mut bits: [Vec<[Option<&[u16]>; 2]>; 2] = [Vec::new(), Vec::new()];
    let mut steps: [Vec<(usize, &[u16])>; 2] = [Vec::new(), Vec::new()];
    for axis in 0..2 {
        for bit in 0..patterns.bits[axis] {
            let pair = [false, true].map(|inverse| of(Pattern::Gray { axis, bit, inverse }));
            if pair == [None, None] {
                lacking.push(missing(Pattern::Gray { axis, bit, inverse: false }));
            }
            bits[axis].push(pair);
        }
        for step in 0..STEPS {
            if let Some(codes) = of(Pattern::Phase { axis, step }) {
                steps[axis].push((step, codes));
            }
        }
        // Five of the eight tell brightness, depth and phase, and that it is a sinusoid.
        if steps[axis].len() < 5 {
            lacking.extend(
                (0..STEPS)
                    .filter(|&step| of(Pattern::Phase { axis, step }).is_none())
                    .map(|step| missing(Pattern::Phase { axis, step })),
            );
        }
    }
    if !lacking.is_empty() {
        return Err(format!("there is no photograph of {}", lacking.join(", ")));
    }
    let axes = [0, 1].map(|axis| Axis {
        bits: &bits[axis],
        sinusoid: Sinusoid::new(&steps[axis]),
        cell: patterns.cell(axis),
        pixels: patterns.resolution[axis] as f64,
    });
    let one = |pixel: usize| -> (Seen, [f32; 2]) {
        let (w, b) = (f32::from(white[pixel]), f32::from(black[pixel]));
        if !(w - b >= LEAST_CONTRAST) {
            return (Seen::None, [f32::NAN; 2]);
        }
        match [axes[0].place(pixel, w, b), axes[1].place(pixel, w, b)] {
            [Some([s, _]), Some([t, _])] if !patterns.is_mixed([s, t].map(f64::from)) => {
                (Seen::Real, [s, t])
            }
            _ => (Seen::Unsure, [f32::NAN; 2]),
        }
    };
    let (seen, st): (Vec<Seen>, Vec<[f32; 2]>) =
        (0..white.len()).into_par_iter().with_min_len(4096).map(one).unzip();
    let lag = axes.each_ref().map(|axis| {
        let real = (0..white.len()).filter(|&pixel| seen[pixel] == Seen::Real);
        // A hundredth of them tells the mean.
        let lags = real.step_by(97).filter_map(|pixel| {
            axis.place(pixel, f32::from(white[pixel]), f32::from(black[pixel]))
        });
        let (mut count, mut sum, mut range) = (0, 0.0, [f32::INFINITY, f32::NEG_INFINITY]);
        for [place, lag] in lags {
            (count, sum) = (count + 1, sum + f64::from(lag));
            range = [range[0].min(place), range[1].max(place)];
        }
        // Of a few stripes only, which parts of them are seen is chance.
        let stripes = f64::from(range[1] - range[0]) * axis.pixels / axis.cell;
        if stripes >= FEW_STRIPES { sum / f64::from(count) } else { 0.0 }
    });
    let (width, height) = (photographs[0].width, photographs[0].height);
    let stripe = [0, 1].map(|axis| (patterns.cell(axis) / axes[axis].pixels) as f32);
    let seen = without_specks(&seen, &st, [width, height], stripe);
    Ok(Decoded { width, height, seen, st, lag, notes })
}

/// The same without pixels that fewer than three of their neighbours agree with to a stripe: where a pixel's neighbour sees another stripe, the pixel itself sees
/// several, and what it was decoded to is chance.
fn without_specks(
    seen: &[Seen],
    st: &[[f32; 2]],
    [width, height]: [usize; 2],
    stripe: [f32; 2],
) -> Vec<Seen> {
    let kept = |pixel: usize| {
        if seen[pixel] != Seen::Real {
            return seen[pixel];
        }
        let (x, y) = (pixel % width, pixel / width);
        let agrees = |other: usize| {
            other != pixel
                && seen[other] == Seen::Real
                && (0..2).all(|c| (st[other][c] - st[pixel][c]).abs() <= stripe[c])
        };
        let rows = y.saturating_sub(1)..(y + 2).min(height);
        let around = rows.flat_map(|row| {
            (x.saturating_sub(1)..(x + 2).min(width)).map(move |column| row * width + column)
        });
        if around.filter(|&other| agrees(other)).count() >= 3 { Seen::Real } else { Seen::Unsure }
    };
    (0..seen.len()).into_par_iter().with_min_len(4096).map(kept).collect()
}

/// The least squares fit of a sinusoid to some of its steps: each step's cosine and sine, and its weights for the mean, the cosine and the sine.
struct Sinusoid<'a> {
    steps: Vec<(&'a [u16], [f32; 2], [f32; 3])>,
}

impl<'a> Sinusoid<'a> {
    fn new(steps: &[(usize, &'a [u16])]) -> Self {
        let rows: Vec<[f64; 3]> = steps
            .iter()
            .map(|&(step, _)| {
                let (sin, cos) = (std::f64::consts::TAU * step as f64 / STEPS as f64).sin_cos();
                [1.0, cos, sin]
            })
            .collect();
        let mut normal = nalgebra::Matrix3::<f64>::zeros();
        for row in &rows {
            let row = nalgebra::Vector3::from_row_slice(row);
            normal += row * row.transpose();
        }
        let inverse = normal.try_inverse().unwrap_or_else(nalgebra::Matrix3::zeros);
        let steps = steps.iter().zip(&rows).map(|(&(_, codes), row)| {
            let weights = inverse * nalgebra::Vector3::from_row_slice(row);
            let weights = [weights.x as f32, weights.y as f32, weights.z as f32];
            (codes, [row[1] as f32, row[2] as f32], weights)
        });
        Self { steps: steps.collect() }
    }

    /// Depth and phase (in turns) at a pixel, and how far its codes are from a sinusoid, rms.
    fn at(&self, pixel: usize) -> (f32, f32, f32) {
        let [mean, cos, sin] =
            self.steps.iter().fold([0.0f32; 3], |[m, c, s], (codes, _, weights)| {
                let code = f32::from(codes[pixel]);
                [m + weights[0] * code, c + weights[1] * code, s + weights[2] * code]
            });
        let off: f32 = self
            .steps
            .iter()
            .map(|(codes, [c, s], _)| (f32::from(codes[pixel]) - mean - cos * c - sin * s).powi(2))
            .sum();
        let rms = (off / self.steps.len().max(1) as f32).sqrt();
        (cos.hypot(sin), sin.atan2(cos) / std::f32::consts::TAU, rms)
    }
}

/// One axis' patterns.
struct Axis<'a> {
    bits: &'a [[Option<&'a [u16]>; 2]],
    sinusoid: Sinusoid<'a>,
    cell: f64,
    pixels: f64,
}

impl Axis<'_> {
    /// The display coordinate that a pixel sees, 0 to 1, and how far it is from the middle of its stripe, in stripes; `None` where the codes do not agree.
    fn place(&self, pixel: usize, white: f32, black: f32) -> Option<[f32; 2]> {
        let span = white - black;
        let (mut gray, mut unsure) = (0u32, 0);
        for (bit, pair) in self.bits.iter().enumerate() {
            let at = |codes: &[u16]| f32::from(codes[pixel]);
            let difference = match pair {
                [Some(lit), Some(inverse)] => at(lit) - at(inverse),
                // White and black stand for the one that is missing.
                [Some(lit), None] => 2.0 * at(lit) - white - black,
                [None, Some(inverse)] => white + black - 2.0 * at(inverse),
                [None, None] => return None,
            };
            unsure += u32::from(difference.abs() < SURE * span);
            gray |= u32::from(difference > 0.0) << bit;
        }
        // At an edge between two stripes of a Gray code one bit is unsure, and which of the two it is the sinusoid tells.
        if unsure > 1 {
            return None;
        }
        let (depth, phase, off) = self.sinusoid.at(pixel);
        if depth < LEAST_DEPTH * span || off > MOST_OFF * depth {
            return None;
        }
        let middle = (f64::from(cell_of_gray(gray)) + 0.5) * self.cell;
        let period = 2.0 * self.cell;
        let turns = f64::from(phase);
        let place = (turns + (middle / period - turns).round()) * period;
        // The two codes agree on the cell, or on the one beside where that is unsure.
        let most = if unsure == 0 { 0.8 } else { 1.0 };
        if (place - middle).abs() > most * self.cell {
            return None;
        }
        let lag = (place - middle) / self.cell;
        let place = place / self.pixels;
        (-0.01..=1.01).contains(&place).then_some([place as f32, lag as f32])
    }
}
