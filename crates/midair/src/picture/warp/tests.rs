use super::*;
use crate::map::{Gain, Status};
use crate::optics::screen::{Response, Screen};
use crate::picture::{Curve, Overflow, Picture, display_image, drive, even_out, srgb};
use proptest::prelude::*;

pub(super) fn noise(width: usize, height: usize, channels: usize) -> Vec<u8> {
    (0..(width * height * channels) as u32)
        .map(|i| (i.wrapping_mul(2_654_435_761) ^ (i >> 3)).wrapping_mul(40_503).to_be_bytes()[0])
        .collect()
}

pub(super) fn bent_map(width: usize, height: usize) -> Map {
    let mut map = Map::identity(width, height);
    for i in 0..map.uv.len() {
        let [s, t] = map.uv[i];
        map.uv[i] = [s * s * (1.6 - 0.6 * s), t + 0.2 * (6.0 * s).sin() * t * (1.0 - t)];
        if i % 13 == 5 || (s - 0.5).hypot(t - 0.4) < 0.1 {
            (map.uv[i], map.status[i]) = ([f64::NAN; 2], Status::Blocked);
        }
    }
    map
}

fn warp(map: &Map, source: [usize; 2], filter: Filter, frame: &[u8], channels: usize) -> Vec<u8> {
    let warp = Warp::new(map, source, filter).unwrap();
    let mut output = vec![77; map.width * map.height * channels];
    let mut light = LightFrame::default();
    light.decode(frame, channels).unwrap();
    warp.apply_light(&light, channels, &Drive::default(), &mut output).unwrap();
    output
}

/// The ideal bilinear value in linear light, in double precision.
fn bilinear(frame: &[u8], [w, h]: [usize; 2], channels: usize, uv: [f64; 2], c: usize) -> f64 {
    let x = (uv[0] * w as f64 - 0.5).clamp(0.0, (w - 1) as f64);
    let y = ((1.0 - uv[1]) * h as f64 - 0.5).clamp(0.0, (h - 1) as f64);
    let (i, j) = (x as usize, y as usize);
    let at = |i: usize, j: usize| {
        let code = frame[(j.min(h - 1) * w + i.min(w - 1)) * channels + c];
        if c == 3 { f64::from(code) / 255.0 } else { f64::from(srgb::decode_8(code)) }
    };
    let (fx, fy) = (x.fract(), y.fract());
    (1.0 - fy) * ((1.0 - fx) * at(i, j) + fx * at(i + 1, j))
        + fy * ((1.0 - fx) * at(i, j + 1) + fx * at(i + 1, j + 1))
}

#[test]
fn bilinear_is_the_ideal_value_rounded() {
    for source in [[50, 41], [7, 3], [1, 6], [90, 2]] {
        for channels in [3, 4] {
            let (map, frame) = (bent_map(83, 59), noise(source[0], source[1], channels));
            let result = warp(&map, source, Filter::Bilinear, &frame, channels);
            let mut compared = 0;
            for (i, &sample) in result.iter().enumerate() {
                let (pixel, c) = (i / channels, i % channels);
                let Some(uv) = map.drawn(pixel % 83, pixel / 83) else {
                    assert_eq!(sample, 0);
                    continue;
                };
                let ideal = bilinear(&frame, source, channels, uv, c);
                // In light: 14-bit fractions (1 / 2^15 of white each way), and three roundings to 15 bits (the decoded value, across, down).
                let slack = 2.0 / 32768.0 + 3.0 / 32767.0;
                // Encoded, half a code more.
                let code = |light: f64| match c {
                    3 => 255.0 * light,
                    _ => 255.0 * srgb::encode(light.clamp(0.0, 1.0)),
                };
                let (low, high) = (code(ideal - slack) - 0.501, code(ideal + slack) + 0.501);
                assert!((low..=high).contains(&f64::from(sample)), "{sample}: {low} to {high}");
                compared += 1;
            }
            assert!(compared > 83 * 59 * channels * 8 / 10, "{compared}");
        }
    }
}

#[test]
fn in_linear_light_the_warp_is_the_display_image_of_a_still() {
    for source in [[150, 130], [40, 31], [3, 2]] {
        for channels in [3, 4] {
            let (map, mut frame) = (bent_map(64, 50), noise(source[0], source[1], channels));
            frame[..channels].fill(255);
            let mut result = vec![77; 64 * 50 * channels];
            let mut light = LightFrame::default();
            light.decode(&frame, channels).unwrap();
            let warp = Warp::new(&map, source, Filter::Sharp).unwrap();
            warp.apply_light(&light, channels, &Drive::default(), &mut result).unwrap();
            let mut picture = Picture::filled(source[0], source[1], [1.0; 4]);
            for (pixel, code) in picture.pixels.iter_mut().zip(frame.chunks(channels)) {
                (0..3).for_each(|c| pixel[c] = srgb::decode_8(code[c]));
            }
            let still = display_image(&picture, &map);
            for (i, pixel) in still.pixels.iter().enumerate() {
                for c in 0..3 {
                    let ours = f64::from(srgb::decode_8(result[channels * i + c]));
                    let ideal = f64::from(pixel[c]);
                    // In light: the 1/1024 px (up to 2 * 1.25 / 2048 of white) and three steps of 15 bits;
                    // encoded: rounding by half a code, whose light the curve's slope tells.
                    let slope = srgb::encode_slope(ours.max(ideal)) * 255.0;
                    let tolerance = 0.0013 + 3.0 / 32767.0 + 0.51 / slope;
                    assert!((ours - ideal).abs() < tolerance, "{source:?} {i}: {ours} {ideal}");
                }
            }
        }
    }
}

#[test]
fn in_linear_light_the_identity_gives_the_frame_back_and_a_mean_is_a_mean_of_light() {
    let (mut light, plain) = (LightFrame::default(), Drive::default());
    for (w, h) in [(37, 5), (1, 1), (3, 2), (16, 16)] {
        for channels in [3, 4] {
            for filter in [Filter::Bilinear, Filter::Sharp] {
                let frame = noise(w, h, channels);
                let warp = Warp::new(&Map::identity(w, h), [w, h], filter).unwrap();
                let mut back = vec![77; frame.len()];
                light.decode(&frame, channels).unwrap();
                warp.apply_light(&light, channels, &plain, &mut back).unwrap();
                assert_eq!(back, frame, "{w} x {h} x {channels} {filter:?}");
            }
        }
    }
    // Half way between black and white is half the light, which sRGB encodes as 188; alpha is 128.
    let mut map = Map::identity(1, 1);
    map.uv[0] = [0.5, 0.5];
    let warp = Warp::new(&map, [2, 1], Filter::Bilinear).unwrap();
    let mut output = [0; 4];
    let frame = [0, 0, 0, 0, 255, 255, 255, 255];
    light.decode(&frame, 4).unwrap();
    warp.apply_light(&light, 4, &plain, &mut output).unwrap();
    assert_eq!(output, [188, 188, 188, 128]);
}

#[test]
fn deep_frames_are_warped_as_stills_are_and_the_identity_gives_them_back() {
    let codes = |source: [usize; 2]| -> Vec<u16> {
        let noise = noise(source[0], source[1], 6);
        let mut frame: Vec<u16> =
            noise.as_chunks::<2>().0.iter().map(|&b| u16::from_le_bytes(b)).collect();
        frame[..3].fill(65535);
        frame
    };
    let mut scratch = DeepScratch::default();
    for filter in [Filter::Bilinear, Filter::Sharp] {
        for source in [[40, 31], [3, 2], [1, 1]] {
            let frame = codes(source);
            let warp = Warp::new(&Map::identity(source[0], source[1]), source, filter).unwrap();
            let mut back = vec![7; frame.len()];
            for curve in [Curve::Srgb, Curve::Linear, Curve::Hlg] {
                warp.apply_deep(&frame, curve, None, &mut scratch, &mut back).unwrap();
                assert_eq!(back, frame, "{source:?} {curve:?}");
            }
        }
    }
    for source in [[150, 130], [40, 31], [3, 2]] {
        let (map, frame) = (bent_map(64, 50), codes(source));
        let warp = Warp::new(&map, source, Filter::Sharp).unwrap();
        let mut result = vec![7; 64 * 50 * 3];
        warp.apply_deep(&frame, Curve::Srgb, None, &mut scratch, &mut result).unwrap();
        let mut picture = Picture::filled(source[0], source[1], [1.0; 4]);
        for (pixel, code) in picture.pixels.iter_mut().zip(frame.as_chunks::<3>().0) {
            (0..3).for_each(|c| pixel[c] = srgb::decode_16(code[c]));
        }
        let still = display_image(&picture, &map);
        for (i, pixel) in still.pixels.iter().enumerate() {
            for c in 0..3 {
                let (ours, ideal) = (srgb::decode_16(result[3 * i + c]), pixel[c]);
                // The 1/1024 px of a tap's fraction: up to 2 * 1.25 / 2048 of white.
                assert!((ours - ideal).abs() < 0.0013, "{source:?} {i}: {ours} {ideal}");
            }
        }
    }
    let warp = Warp::new(&Map::identity(2, 2), [2, 2], Filter::Sharp).unwrap();
    assert!(warp.apply_deep(&[0; 5], Curve::Pq, None, &mut scratch, &mut [0; 12]).is_err());
}

#[test]
fn a_constant_frame_stays_constant() {
    for code in [0u8, 1, 127, 254, 255] {
        for filter in [Filter::Bilinear, Filter::Sharp] {
            let (map, frame) = (bent_map(64, 50), vec![code; 30 * 90 * 3]);
            let result = warp(&map, [30, 90], filter, &frame, 3);
            for (i, pixel) in result.as_chunks::<3>().0.iter().enumerate() {
                let drawn = map.drawn(i % 64, i / 64).is_some();
                assert_eq!(*pixel, if drawn { [code; 3] } else { [0; 3] });
            }
        }
    }
}

#[cfg(target_arch = "x86_64")]
#[test]
fn vectors_and_plain_code_agree_to_the_bit() {
    // Without AVX2 both are the plain code, and there is nothing to be held to it.
    fn check<const C: usize>(source: [usize; 2], filter: Filter) {
        let (map, frame) = (bent_map(83, 59), noise(source[0], source[1], C));
        let fast = warp(&map, source, filter, &frame, C);
        let warp = Warp::new(&map, source, filter).unwrap();
        let (mut light, drive) = (LightFrame::default(), Drive::default());
        light.decode(&frame, C).unwrap();
        let mut plain = vec![0; fast.len()];
        for row in 0..59 {
            for span in warp.plan.spans(row) {
                let pixels = row * 83 + span.start..row * 83 + span.end;
                let target = &mut plain[pixels.start * C..pixels.end * C];
                let (light, plan, tables) = (&light.light[..], &warp.plan, warp.tables.as_ref());
                let run = linear::Run { light, source, tables, plan, pixels, drive: &drive };
                match tables {
                    Some(t) => run.warp_plain::<C, true>(&t.x, &t.y, target),
                    None => run.warp_plain::<C, false>(&[], &[], target),
                }
            }
        }
        assert!(fast == plain, "{source:?} {filter:?}");
    }
    for source in [[50, 41], [150, 130], [4, 4], [2, 2], [1, 7]] {
        for filter in [Filter::Bilinear, Filter::Sharp] {
            check::<3>(source, filter);
            check::<4>(source, filter);
        }
    }
}

#[test]
fn frames_of_the_wrong_size_are_refused() {
    let warp = Warp::new(&Map::identity(4, 4), [8, 8], Filter::Bilinear).unwrap();
    let (mut light, drive, mut output) = (LightFrame::default(), Drive::default(), vec![0; 48]);
    light.decode(&[0; 12], 3).unwrap();
    let error = warp.apply_light(&light, 3, &drive, &mut output).unwrap_err();
    assert!(error.to_string().contains("64 samples, not 4"), "{error}");
    light.decode(&[0; 192], 3).unwrap();
    assert_eq!(warp.apply_light(&light, 1, &drive, &mut output), Err(WarpError::Channels(1)));
    assert!(warp.apply_light(&light, 3, &drive, &mut output[1..]).is_err());
    assert!(warp.apply_light(&light, 3, &drive, &mut output).is_ok());
    assert!(Warp::new(&Map::identity(4, 4), [0, 8], Filter::Sharp).is_err());
    assert!(Warp::new(&Map::identity(4, 4), [1 << 40, 1 << 40], Filter::Sharp).is_err());
}

proptest! {
    #[test]
    fn wild_maps_are_warped_without_a_fault(
        uv in prop::collection::vec((-2.0f64..3.0, -2.0f64..3.0, 0u8..4), 30),
        width in 1usize..12,
        height in 1usize..12,
    ) {
        let mut map = Map::identity(6, 5);
        for (target, (u, v, hole)) in map.uv.iter_mut().zip(uv) {
            *target = if hole == 0 { [f64::NAN, v] } else { [u, v] };
        }
        for channels in [3, 4] {
            let frame = noise(width, height, channels);
            for filter in [Filter::Bilinear, Filter::Sharp] {
                let result = warp(&map, [width, height], filter, &frame, channels);
                for (i, pixel) in result.chunks(channels).enumerate() {
                    let drawn = map.drawn(i % 6, i / 6).is_some();
                    prop_assert!(drawn || pixel.iter().all(|&sample| sample == 0));
                }
            }
        }
    }
}

/// A gain that differs from pixel to pixel and colour to colour, without an answer where the map has none.
fn uneven(map: &Map) -> Gain {
    let of = |(i, uv): (usize, &[f64; 2])| match uv[0].is_nan() {
        true => [f32::NAN; 3],
        false => [0, 1, 2].map(|c| 0.4 + 0.05 * ((3 * i + 5 * c) % 11) as f32),
    };
    let rgb = map.uv.iter().enumerate().map(of).collect();
    Gain { width: map.width, height: map.height, rgb }
}

#[test]
fn a_gain_and_a_displays_response_are_those_of_stills() {
    let source = [40, 31];
    let (map, mut frame) = (bent_map(64, 50), noise(source[0], source[1], 3));
    // White somewhere that is seen: the level of a film is that of white.
    frame.iter_mut().enumerate().for_each(|(i, code)| {
        if i / 3 % 5 < 2 {
            *code = 255;
        }
    });
    let gain = uneven(&map);
    let screen = Screen { response: Response::Gamma(1.8), black: [0.004, 0.01, 0.0], bits: None };
    let mut picture = Picture::filled(source[0], source[1], [1.0; 4]);
    for (pixel, code) in picture.pixels.iter_mut().zip(frame.chunks(3)) {
        (0..3).for_each(|c| pixel[c] = srgb::decode_8(code[c]));
    }
    for overflow in [Overflow::Fit, Overflow::Clip, Overflow::Soft] {
        let evening = Evening::for_white(&gain, overflow);
        // What a still does, at white's level: of a picture with all its pixels white and the film's picture in turn.
        let white = even_out(&Picture::filled(64, 50, [1.0; 4]), &gain, overflow);
        assert_eq!(white.level, evening.level());
        let mut wanted = display_image(&picture, &map);
        for (i, pixel) in wanted.pixels.iter_mut().enumerate() {
            (0..3).for_each(|c| pixel[c] = evening.emitted(i, c, pixel[c]));
        }
        let wanted = drive(&wanted, &screen).picture;
        let warp = Warp::new(&map, source, Filter::Sharp).unwrap();
        // The channels the other way about, as windows have them.
        let swapped: Vec<u8> = frame.chunks(3).flat_map(|p| [p[2], p[1], p[0], 255]).collect();
        let mut light = LightFrame::default();
        light.decode(&swapped, 4).unwrap();
        let driver = Drive::of_screen(&screen, [2, 1, 0]).with_evening(Some(evening.clone()));
        let mut shown = vec![77; 64 * 50 * 4];
        warp.apply_light(&light, 4, &driver, &mut shown).unwrap();
        for (i, pixel) in wanted.pixels.iter().enumerate() {
            for c in 0..3 {
                if map.drawn(i % 64, i / 64).is_none() {
                    assert_eq!(shown[4 * i + 2 - c], 0);
                    continue;
                }
                let ideal = srgb::encode(f64::from(pixel[c])) * 255.0;
                // Light is known to 0.0013 and three steps of 15 bits; a gain of a half doubles that at most (0.8 / 0.4), and a
                // response of light^(1/1.8) turns it into codes by its slope.
                let emitted = screen.light(c, ideal / 255.0);
                let over = ((emitted - screen.black[c]) / (1.0 - screen.black[c])).max(1e-9);
                let error = 2.0 * (0.0013 + 3.0 / 32767.0);
                let slack = 255.0
                    * ((over + error).powf(1.0 / 1.8) - (over - error).max(0.0).powf(1.0 / 1.8));
                let code = f64::from(shown[4 * i + 2 - c]);
                assert!(
                    (code - ideal).abs() < 0.51 + slack,
                    "{overflow:?} {i} {c}: {code} {ideal}"
                );
            }
        }
        // Frames of 16 bits, in sRGB.
        let deep: Vec<u16> = frame.iter().map(|&code| u16::from(code) * 257).collect();
        let mut shown = vec![7; 64 * 50 * 3];
        let mut scratch = DeepScratch::default();
        warp.apply_deep(&deep, Curve::Srgb, Some(&evening), &mut scratch, &mut shown).unwrap();
        let still = display_image(&picture, &map);
        for (i, pixel) in still.pixels.iter().enumerate() {
            for c in 0..3 {
                let drawn = map.drawn(i % 64, i / 64).is_some();
                let ideal = if drawn { evening.emitted(i, c, pixel[c]) } else { 0.0 };
                // As without a gain, doubled by it at most.
                assert!((srgb::decode_16(shown[3 * i + c]) - ideal).abs() < 0.0026, "{i} {c}");
            }
        }
    }
    let other =
        Evening::for_white(&Gain { width: 1, height: 1, rgb: vec![[0.5; 3]] }, Overflow::Fit);
    let warp = Warp::new(&map, source, Filter::Bilinear).unwrap();
    let (mut light, mut shown) = (LightFrame::default(), vec![0; 64 * 50 * 3]);
    light.decode(&frame, 3).unwrap();
    let driver = Drive::default().with_evening(Some(other));
    let error = warp.apply_light(&light, 3, &driver, &mut shown).unwrap_err();
    assert_eq!(error, WarpError::Gain { expected: 3200, found: 1 });
    assert_eq!(light.decode(&frame, 2), Err(WarpError::Channels(2)));
}
