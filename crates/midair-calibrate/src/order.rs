//! Which pattern each photograph shows: by the squares in the patterns' corners, wherever they are seen.

use crate::number::{SQUARES, often, tolerance};
use crate::patterns::Patterns;
use crate::photographs::Photograph;
use crate::plane::median;
use std::collections::HashMap;

/// Which photograph shows which pattern.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Order {
    /// For each pattern its photograph.
    pub of: Vec<Option<usize>>,
    /// Photographs of a pattern that another one shows already.
    pub doubles: Vec<usize>,
    /// Photographs that show no pattern, or two at once.
    pub unknown: Vec<usize>,
    /// Whether the squares were not found, so that the photographs are taken in the order in which they came.
    pub as_named: bool,
}

/// Pixels that are looked at.
const LOOKED_AT: usize = 400_000;

/// The most photographs of one state: a bit each.
pub const MOST: usize = 128;

/// How bright a lit square is in its own range, at least, and a dark one at most: between them the display was changing.
const LIT: f64 = 0.8;
const DARK: f64 = 0.3;

/// Which pattern each photograph shows; all are of one size. `None` where the squares are not seen, and there are not just as many photographs as patterns.
pub fn order(patterns: &Patterns, photographs: &[Photograph]) -> Option<Order> {
    let count = patterns.numbers().count();
    let words = words(photographs, count);
    let Some(words) = words else {
        let as_named = photographs.len() == count && begins_with_white_and_black(photographs);
        return as_named.then(|| Order {
            of: (0..count).map(Some).collect(),
            doubles: Vec::new(),
            unknown: Vec::new(),
            as_named,
        });
    };
    let mut order =
        Order { of: vec![None; count], doubles: Vec::new(), unknown: Vec::new(), as_named: false };
    for (photograph, word) in words.into_iter().enumerate() {
        match word.and_then(|word| patterns.numbers().pattern(word)) {
            None => order.unknown.push(photograph),
            Some(pattern) if order.of[pattern].is_some() => order.doubles.push(photograph),
            Some(pattern) => order.of[pattern] = Some(photograph),
        }
    }
    Some(order)
}

/// Whether the first photograph is the brightest of all and the second the darkest, nearly wherever anything changes: as they are in the patterns' own
/// order, and by chance in one of a thousand others.
fn begins_with_white_and_black(photographs: &[Photograph]) -> bool {
    let stride = photographs[0].codes.len().div_ceil(LOOKED_AT);
    let (mut lit, mut so) = (0, 0);
    for place in (0..photographs[0].codes.len()).step_by(stride) {
        let codes = || photographs.iter().map(|photograph| photograph.codes[place]);
        let (low, high) = (codes().min().unwrap_or(0), codes().max().unwrap_or(0));
        if high - low < 6000 {
            continue;
        }
        lit += 1;
        let near = (high - low) / 5;
        let (white, black) = (photographs[0].codes[place], photographs[1].codes[place]);
        so += usize::from(white >= high - near && black <= low + near);
    }
    10 * so >= 9 * lit && lit > 0
}

/// What each photograph's squares show, `None` where they are neither lit nor dark; `None` where not all squares are seen.
fn words(photographs: &[Photograph], patterns: usize) -> Option<Vec<Option<u16>>> {
    let many = photographs.len();
    if !(8..=MOST).contains(&many) {
        return None;
    }
    let pixels = photographs[0].codes.len();
    let stride = pixels.div_ceil(LOOKED_AT);
    let places: Vec<usize> = (0..pixels).step_by(stride).collect();
    let ranges: Vec<(u16, u16)> = places
        .iter()
        .map(|&place| {
            photographs
                .iter()
                .map(|p| p.codes[place])
                .fold((u16::MAX, 0), |(low, high), code| (low.min(code), high.max(code)))
        })
        .collect();
    let mut contrasts: Vec<u16> = ranges.iter().map(|(low, high)| high - low).collect();
    let high = contrasts.len() * 99 / 100;
    let strong = f64::from(*contrasts.select_nth_unstable(high).1);
    // A tenth of full scale is a picture at all; a quarter of the best is not stray light by itself.
    let enough = (0.25 * strong).max(0.02 * 65535.0);
    // For each square the histories of pixels that are lit about as often as it is.
    let mut histories: Vec<HashMap<u128, Vec<usize>>> = vec![HashMap::new(); SQUARES];
    for (k, &place) in places.iter().enumerate() {
        let (low, high) = ranges[k];
        if f64::from(high - low) < enough {
            continue;
        }
        let middle = (u32::from(low) + u32::from(high)) / 2;
        let mut history = 0u128;
        for (m, photograph) in photographs.iter().enumerate() {
            history |= u128::from(u32::from(photograph.codes[place]) > middle) << m;
        }
        // Doubles and missing ones change the count a little.
        let lit = f64::from(history.count_ones()) * patterns as f64 / many as f64;
        let square = (0..SQUARES).min_by(|&a, &b| {
            let off = |square: usize| (lit - often(square, patterns) as f64).abs();
            off(a).total_cmp(&off(b))
        })?;
        if (lit - often(square, patterns) as f64).abs() <= tolerance(patterns) {
            histories[square].entry(history).or_default().push(k);
        }
    }
    let mut words = vec![Some(0u16); many];
    for (square, histories) in histories.iter().enumerate() {
        // A square's pixels all have its history; at its edges, and where stripes are met by noise or by stray light, each place has another.
        let (&history, seen) =
            histories.iter().max_by_key(|(history, seen)| (seen.len(), **history))?;
        // In a photograph that shows two patterns at once each pixel is lit or dark by chance: the same history but for that.
        let others = histories.iter().filter(|(other, _)| (**other ^ history).count_ones() > 3);
        let next = others.map(|(_, seen)| seen.len()).max().unwrap_or(0);
        if seen.len() < 6 || seen.len() < 2 * next {
            return None;
        }
        for (m, photograph) in photographs.iter().enumerate() {
            let brightness: Vec<f64> = seen
                .iter()
                .map(|&k| {
                    let (low, high) = ranges[k];
                    f64::from(photograph.codes[places[k]] - low) / f64::from(high - low)
                })
                .collect();
            // The middle one: pixels at a square's edge see its neighbours as well.
            let brightness = median(&brightness);
            let lit = history >> m & 1 == 1;
            let clear = if lit { brightness >= LIT } else { brightness <= DARK };
            words[m] = words[m].filter(|_| clear).map(|word| word | u16::from(lit) << square);
        }
    }
    Some(words)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Photographs of the display itself, each pixel of it a pixel, with a little noise.
    fn photographs(patterns: &Patterns, order: &[usize]) -> Vec<Photograph> {
        let mut draw = fastrand::Rng::with_seed(4);
        let [width, height] = patterns.resolution;
        order
            .iter()
            .map(|&pattern| {
                let light = patterns.drawn(pattern);
                let code = |light: &f32| {
                    let noise = 0.01 * (draw.f32() - 0.5);
                    (65535.0 * (0.05 + 0.8 * light.powf(0.45) + noise)) as u16
                };
                Photograph { width, height, codes: light.iter().map(code).collect() }
            })
            .collect()
    }

    fn patterns() -> Patterns {
        Patterns::new([1024, 768], 0.0)
    }

    #[test]
    fn photographs_are_known_in_any_order_with_doubles_and_missing_ones() {
        let patterns = patterns();
        let count = patterns.list.len();
        let mut draw = fastrand::Rng::with_seed(9);
        let mut shown: Vec<usize> = (0..count).collect();
        draw.shuffle(&mut shown);
        // One is missing, one was taken twice.
        let missing = shown.remove(3);
        shown.push(shown[7]);
        let found =
            order(&patterns, &photographs(&patterns, &shown)).expect("the squares are seen");
        assert!(!found.as_named && found.unknown.is_empty(), "{found:?}");
        assert_eq!(found.doubles, [count - 1]);
        for pattern in 0..count {
            let wanted = shown.iter().position(|&p| p == pattern);
            assert_eq!(found.of[pattern], wanted);
            assert_eq!(wanted.is_none(), pattern == missing);
        }
    }

    #[test]
    fn a_photograph_taken_in_mid_change_is_told_apart() {
        let patterns = patterns();
        let shown: Vec<usize> = (0..patterns.list.len()).collect();
        let mut taken = photographs(&patterns, &shown);
        let next = taken[11].codes.clone();
        let mixed = taken[10].codes.iter().zip(&next).map(|(a, b)| (a / 2) + (b / 2)).collect();
        taken.push(Photograph { codes: mixed, ..taken[10].clone() });
        let found = order(&patterns, &taken).expect("the squares are seen");
        assert_eq!(found.unknown, [shown.len()], "{found:?}");
        assert!(found.of.iter().all(Option::is_some) && found.doubles.is_empty());
    }

    #[test]
    fn without_squares_only_a_whole_set_is_taken_in_its_order() {
        let patterns = patterns();
        let shown: Vec<usize> = (0..patterns.list.len()).collect();
        let mut taken = photographs(&patterns, &shown);
        for photograph in &mut taken {
            // Both corners are behind something.
            for y in 0..photograph.height {
                for x in 0..photograph.width {
                    let i = y * photograph.width + x;
                    if (x < 330 && y + 140 >= photograph.height)
                        || (x + 330 >= photograph.width && y < 140)
                    {
                        photograph.codes[i] = 3000;
                    }
                }
            }
        }
        let found = order(&patterns, &taken).expect("as many as there are patterns");
        assert!(found.as_named && found.of[5] == Some(5));
        assert_eq!(order(&patterns, &taken[1..]), None);
        // Names that do not go by the patterns' order are not believed.
        taken.rotate_left(1);
        assert_eq!(order(&patterns, &taken), None);
    }
}
