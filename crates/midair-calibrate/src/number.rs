//! Each pattern's number, shown by squares that are lit or dark. Where the squares are seen nobody knows: an object may bend them anywhere. But over all
//! patterns together each square is lit a number of times that no other square, and nothing else on the display, is: every other place is
//! lit in about half of the patterns. So a pixel tells by its own history which square it sees, whatever the order of the photographs.

/// How the squares are lit in each pattern.
#[derive(Clone, Debug)]
pub struct Numbers {
    /// For each pattern its squares, a bit each.
    words: Vec<u16>,
}

/// Squares of a corner.
pub const SQUARES: usize = 10;

/// A sequence that is the same in every version of everything: patterns that were printed once are decoded for ever (Knuth's MMIX).
struct Sequence(u64);

impl Sequence {
    fn below(&mut self, n: usize) -> usize {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((self.0 >> 33) % n.max(1) as u64) as usize
    }
}

impl Numbers {
    /// Numbers for so many patterns.
    pub fn new(count: usize) -> Self {
        let mut draw = Sequence(2026);
        let mut words = vec![0u16; count];
        for square in 0..SQUARES {
            let mut order: Vec<usize> = (0..count).collect();
            for i in (1..count).rev() {
                order.swap(i, draw.below(i + 1));
            }
            for &pattern in order.iter().take(often(square, count)) {
                words[pattern] |= 1 << square;
            }
        }
        // Exchange squares of two patterns until no two have the same number: how often each square is lit stays.
        for _ in 0..1_000_000 {
            let Some(twin) = (0..count).find(|&i| words[..i].contains(&words[i])) else { break };
            let (square, other) = (draw.below(SQUARES), draw.below(count));
            let bit = 1u16 << square;
            if (words[twin] ^ words[other]) & bit == 0 {
                continue;
            }
            let twins =
                |words: &[u16]| (0..count).filter(|&i| words[..i].contains(&words[i])).count();
            let before = twins(&words);
            words[twin] ^= bit;
            words[other] ^= bit;
            if twins(&words) > before {
                words[twin] ^= bit;
                words[other] ^= bit;
            }
        }
        Self { words }
    }

    /// Whether a square is lit in a pattern.
    pub fn lit(&self, pattern: usize, square: usize) -> bool {
        self.words[pattern] >> square & 1 == 1
    }

    /// The pattern whose squares these are.
    pub fn pattern(&self, word: u16) -> Option<usize> {
        self.words.iter().position(|&known| known == word)
    }

    /// How many patterns there are.
    pub fn count(&self) -> usize {
        self.words.len()
    }
}

/// In how many of so many patterns a square is lit. What is no square is lit in half of the stripes, in three to six of each sinusoid's eight steps (as
/// the camera's response has it) and in white: from two less than half of the patterns to four more. Squares keep clear of that.
pub fn often(square: usize, count: usize) -> usize {
    let half = count as f64 / 2.0;
    let step = (square % 5) as f64;
    let often = if square < 5 {
        (step + 1.0) * (half - 5.0) / 5.0
    } else {
        half + 7.0 + step * (half - 8.0) / 4.0
    };
    often.round() as usize
}

/// How far off a count may be and still be a square's.
pub fn tolerance(count: usize) -> f64 {
    let gaps = (1..SQUARES).map(|square| often(square, count) - often(square - 1, count));
    0.5 * gaps.min().unwrap_or(0) as f64 - 0.05
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_pattern_has_its_own_number_and_every_square_its_own_count() {
        for count in 30..60 {
            let numbers = Numbers::new(count);
            for pattern in 0..count {
                assert_eq!(numbers.pattern(numbers.words[pattern]), Some(pattern), "{count}");
            }
            for square in 0..SQUARES {
                let lit = (0..count).filter(|&pattern| numbers.lit(pattern, square)).count();
                assert_eq!(lit, often(square, count));
                // What is no square is lit in about half of them.
                assert!(2 * lit + 8 < count || 2 * lit > count + 12, "{count} {square}");
            }
        }
    }
}
