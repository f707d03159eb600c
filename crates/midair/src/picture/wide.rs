//! Light of a wide range (PQ, HLG) for a display of an ordinary one.
//!
//! Reference white, 203 cd/m2 (ITU-R BT.2408), is light of 1. What is brighter than a display's white, up to the 1000 cd/m2 that most films are
//! graded to, is brought below it by the curve of ITU-R BT.2390 (section 5.4.1), applied to the largest of the three colours, so that hues
//! stay. BT.2390 leaves dark and middle tones as they are: what it changes begins at 88 cd/m2.

use super::Curve;
use super::colour::ToSrgb;

/// ITU-R BT.2408: the luminance of diffuse white, cd/m2.
pub const REFERENCE_WHITE: f64 = 203.0;
/// The brightest light that detail is kept for, cd/m2.
pub const PEAK: f64 = 1000.0;
/// What is said of it to the user.
pub const SAID: &str = "reference white, 203 cd/m2, is near a display's white, and highlights up to 1000 cd/m2 are rolled off below that (BT.2390)";
/// What PQ's 1 stands for, cd/m2.
const PQ_PEAK: f64 = 10_000.0;
/// HLG's system gamma for a display of 1000 cd/m2 (BT.2100, note 5f).
const SYSTEM_GAMMA: f64 = 1.2;
/// BT.2100's luminance, of its own primaries.
const LUMINANCE: [f64; 3] = [0.2627, 0.6780, 0.0593];

/// Light of codes of a wide range, in the codes' own primaries, as a display for it would emit: 1 is reference white.
pub fn display_light(curve: Curve, light: [f64; 3]) -> [f64; 3] {
    match curve {
        Curve::Pq => light.map(|light| light * PQ_PEAK / REFERENCE_WHITE),
        Curve::Hlg => {
            // The scene's light, through the display's own transfer (BT.2100, table 5).
            let luminance: f64 = (0..3).map(|c| LUMINANCE[c] * light[c]).sum();
            let factor = luminance.max(0.0).powf(SYSTEM_GAMMA - 1.0) * PEAK / REFERENCE_WHITE;
            light.map(|light| light * factor)
        }
        Curve::Srgb | Curve::Linear => light,
    }
}

/// What an ordinary display shows of light whose reference white is 1: colours outside sRGB at its edge, highlights below white.
pub fn shown(light: [f32; 3]) -> [f32; 3] {
    let light = light.map(|light| light.max(0.0));
    let most = light.iter().copied().fold(0.0, f32::max);
    if most <= 0.0 {
        return [0.0; 3];
    }
    let factor = roll_off(f64::from(most)) / f64::from(most);
    light.map(|light| (f64::from(light) * factor).min(1.0) as f32)
}

/// BT.2390's curve from a display of [`PEAK`] to one of [`REFERENCE_WHITE`], both without a black of their own; light in units of reference white.
fn roll_off(light: f64) -> f64 {
    let pq = |light: f64| Curve::Pq.encode((light * REFERENCE_WHITE / PQ_PEAK).min(1.0));
    let top = pq(PEAK / REFERENCE_WHITE);
    let most = pq(1.0) / top;
    let knee = 1.5 * most - 0.5;
    let from = (pq(light) / top).min(1.0);
    if from < knee {
        return light;
    }
    let t = (from - knee) / (1.0 - knee);
    let (t2, t3) = (t * t, t * t * t);
    let to = (2.0 * t3 - 3.0 * t2 + 1.0) * knee
        + (t3 - 2.0 * t2 + t) * (1.0 - knee)
        + (3.0 * t2 - 2.0 * t3) * most;
    Curve::Pq.decode(to * top) * PQ_PEAK / REFERENCE_WHITE
}

/// Codes of a wide range, as light of an ordinary display.
pub fn shown_of_codes(curve: Curve, codes: [f64; 3], matrix: Option<&ToSrgb>) -> [f32; 3] {
    shown(light_of_codes(curve, codes, matrix))
}

/// Codes as light in sRGB's primaries, 1 being reference white; below 0 for colours outside them.
pub fn light_of_codes(curve: Curve, codes: [f64; 3], matrix: Option<&ToSrgb>) -> [f32; 3] {
    let light = display_light(curve, codes.map(|code| curve.decode(code))).map(|l| l as f32);
    matrix.map_or(light, |matrix| matrix.apply(light))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reference_white_is_1_by_both_systems() {
        // BT.2408, table 1: diffuse white is 58 % of PQ and 75 % of HLG; both to the full percent.
        for (curve, code, step) in [(Curve::Pq, 0.58, 0.05), (Curve::Hlg, 0.75, 0.05)] {
            let [r, g, b] = light_of_codes(curve, [code; 3], None);
            assert!((r - 1.0).abs() < step && r == g && g == b, "{curve:?} {r}");
        }
        // HLG's 1 is the 1000 cd/m2 that its system gamma is for.
        let [most, ..] = light_of_codes(Curve::Hlg, [1.0; 3], None);
        assert!((f64::from(most) * REFERENCE_WHITE - PEAK).abs() < 0.1);
    }

    #[test]
    fn the_roll_off_keeps_the_dark_rises_and_ends_at_white() {
        let mut last = 0.0;
        for i in 1..2000 {
            let light = f64::from(i) / 100.0;
            let now = roll_off(light);
            assert!(now >= last && now <= light + 1e-12 && now <= 1.0 + 1e-9, "{light} {now}");
            // The curve begins at the knee, 1.5 maxLum - 0.5 (BT.2390): PQ's 0.495 of 0.752, which is 87.8 cd/m2.
            if light * REFERENCE_WHITE < 87.8 {
                assert!((now - light).abs() < 1e-12, "{light}");
            }
            last = now;
        }
        // A cubic that meets the knee with slope 1 and the top at white with slope 0 (BT.2390's stated ends).
        assert!((roll_off(PEAK / REFERENCE_WHITE) - 1.0).abs() < 1e-9);
        assert!((roll_off(100.0) - 1.0).abs() < 1e-9);
    }

    #[test]
    fn hues_stay_and_nothing_exceeds_white() {
        for light in [[3.0f32, 1.5, 0.3], [0.5, 0.25, 0.05], [40.0, 4.0, 0.0]] {
            let out = shown(light);
            assert!(out.iter().all(|&l| (0.0..=1.0).contains(&l)), "{out:?}");
            // One factor for all three; floats have 24 bits.
            assert!((out[1] * light[0] - out[0] * light[1]).abs() <= 4e-7 * light[0]);
        }
        assert_eq!(shown([-1.0, 0.0, 0.0]), [0.0; 3]);
    }
}
