//! What a picture's file says of its colours, obeyed: ICC profiles, and PNG's chunks cICP, sRGB, gAMA and cHRM.

use super::colour::{Primaries, ToSrgb};
use super::{Curve, srgb, wide};
use image::ImageFormat;
use moxcms::{
    ColorProfile, DataColorSpace, Layout, ProfileText, RenderingIntent, ToneReprCurve,
    TransformF32Executor, TransformOptions,
};
use std::io::Cursor;
use std::sync::Arc;

/// How codes become light.
pub(super) enum Encoding {
    /// As sRGB says.
    Srgb,
    /// By a curve for each colour, then to sRGB's primaries. `narrow`: black and white are 16 and 235 of 255, as in films.
    Curve { transfer: Transfer, matrix: Option<ToSrgb>, narrow: bool },
    /// By an ICC profile, of grey or of red, green and blue.
    Icc { transform: Arc<TransformF32Executor>, grey: bool },
}

/// A curve from codes to light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Transfer {
    Curve(Curve),
    /// Light is the code to this power.
    Power(f64),
}

impl Transfer {
    pub(super) fn decode(self, code: f64) -> f64 {
        match self {
            Self::Curve(curve) => curve.decode(code),
            Self::Power(exponent) => code.powf(exponent),
        }
    }

    /// Whether light is of a wide range, to be brought into a display's.
    pub(super) fn wide(self) -> Option<Curve> {
        match self {
            Self::Curve(curve @ (Curve::Pq | Curve::Hlg)) => Some(curve),
            _ => None,
        }
    }
}

/// What a file says of its colours, and a sentence for the user if there is something to say.
pub(super) struct Told {
    pub encoding: Encoding,
    pub note: Option<String>,
}

impl Told {
    fn srgb() -> Self {
        Self { encoding: Encoding::Srgb, note: None }
    }

    fn unheard(why: &str) -> Self {
        Self {
            encoding: Encoding::Srgb,
            note: Some(format!("{why}: the colours are taken as sRGB")),
        }
    }
}

/// What a file says, PNG's code points before its profile and that before its other chunks (PNG, third edition, section 13.1).
pub(super) fn read(bytes: &[u8], format: ImageFormat, icc: Option<&[u8]>, grey: bool) -> Told {
    let chunks = match format {
        ImageFormat::Png => png::Decoder::new(Cursor::new(bytes)).read_info().ok(),
        _ => None,
    };
    let info = chunks.as_ref().map(png::Reader::info);
    if let Some(told) = info.and_then(|info| info.coding_independent_code_points) {
        let narrow = !told.is_video_full_range_image;
        return of_codes(told.color_primaries, told.transfer_function, narrow);
    }
    if let Some(icc) = icc {
        return of_icc(icc, grey);
    }
    match info {
        Some(info) if info.srgb.is_none() => of_chunks(info),
        _ => Told::srgb(),
    }
}

/// Code points of ITU-T H.273.
fn of_codes(primaries: u8, transfer: u8, narrow: bool) -> Told {
    let transfer = match transfer {
        // Films' curves are shown by a display as sRGB's.
        1 | 2 | 6 | 13..=15 => Transfer::Curve(Curve::Srgb),
        4 => Transfer::Power(2.2),
        5 => Transfer::Power(2.8),
        8 => Transfer::Curve(Curve::Linear),
        16 => Transfer::Curve(Curve::Pq),
        18 => Transfer::Curve(Curve::Hlg),
        _ => {
            return Told::unheard(&format!(
                "its transfer function, code {transfer}, is not known here"
            ));
        }
    };
    let known = match primaries {
        2 => Primaries::SRGB,
        _ => match Primaries::of_code(primaries) {
            Some(known) => known,
            None => {
                return Told::unheard(&format!(
                    "its primaries, code {primaries}, are not known here"
                ));
            }
        },
    };
    of_curve(transfer, known, narrow)
}

fn of_curve(transfer: Transfer, primaries: Primaries, narrow: bool) -> Told {
    if transfer == Transfer::Curve(Curve::Srgb) && primaries.is_srgb() && !narrow {
        return Told::srgb();
    }
    let matrix = match primaries.is_srgb() {
        true => None,
        false => match primaries.to_srgb() {
            Some(matrix) => Some(matrix),
            None => return Told::unheard("its primaries span no colours"),
        },
    };
    let note = match transfer.wide() {
        Some(curve) => Some(format!("a wide range of light ({}); {}", name(curve), wide::SAID)),
        None => matrix.is_some().then(|| "its primaries are converted to those of sRGB".to_owned()),
    };
    Told { encoding: Encoding::Curve { transfer, matrix, narrow }, note }
}

fn name(curve: Curve) -> &'static str {
    if curve == Curve::Pq { "PQ" } else { "HLG" }
}

/// gAMA of what sRGB's curve comes to: written beside sRGB's own chunk, and by programs that mean it. 1/2.2 is another curve in the dark only.
const SRGB_GAMMA: f64 = 0.45455;

fn of_chunks(info: &png::Info) -> Told {
    let gamma = info.gama_chunk.map(|gamma| f64::from(gamma.into_value()));
    let transfer = match gamma {
        Some(gamma) if (gamma - SRGB_GAMMA).abs() > 2e-4 && gamma > 0.05 && gamma < 20.0 => {
            Transfer::Power(1.0 / gamma)
        }
        _ => Transfer::Curve(Curve::Srgb),
    };
    let primaries = info.chrm_chunk.map_or(Primaries::SRGB, |told| {
        let pair = |(x, y): (png::ScaledFloat, png::ScaledFloat)| [x.into_value(), y.into_value()];
        Primaries {
            red: pair(told.red),
            green: pair(told.green),
            blue: pair(told.blue),
            white: pair(told.white),
        }
    });
    of_curve(transfer, primaries, false)
}

/// Floating-point samples without a profile.
pub(super) fn linear() -> Told {
    let transfer = Transfer::Curve(Curve::Linear);
    let encoding = Encoding::Curve { transfer, matrix: None, narrow: false };
    let note = "its floating-point samples are taken as linear light with sRGB's primaries";
    Told { encoding, note: Some(note.to_owned()) }
}

/// A profile's own name.
fn title(profile: &ColorProfile) -> String {
    let text = match &profile.description {
        Some(ProfileText::PlainString(text)) => text.clone(),
        Some(ProfileText::Localizable(texts)) => {
            texts.first().map(|text| text.value.clone()).unwrap_or_default()
        }
        Some(ProfileText::Description(text)) => text.ascii_string.clone(),
        None => String::new(),
    };
    let text = text.trim_matches(|c: char| c.is_control() || c.is_whitespace()).to_owned();
    if text.is_empty() { String::new() } else { format!(" ({text})") }
}

fn of_icc(icc: &[u8], grey: bool) -> Told {
    // A damaged profile is an error in the file, whatever the reader makes of it.
    let parsed = std::panic::catch_unwind(|| ColorProfile::new_from_slice(icc));
    let Ok(Ok(profile)) = parsed else {
        return Told::unheard("its colour profile is damaged");
    };
    let title = title(&profile);
    let of_grey = match profile.color_space {
        DataColorSpace::Rgb => false,
        DataColorSpace::Gray if grey => true,
        _ => {
            return Told::unheard(&format!(
                "its colour profile{title} is for other colours than it has"
            ));
        }
    };
    if let Some(told) = profile.cicp
        && let (Some(curve), Some(primaries)) = (
            match told.transfer_characteristics {
                moxcms::TransferCharacteristics::Smpte2084 => Some(Curve::Pq),
                moxcms::TransferCharacteristics::Hlg => Some(Curve::Hlg),
                _ => None,
            },
            Primaries::of_code(told.color_primaries as u8),
        )
    {
        return of_curve(Transfer::Curve(curve), primaries, false);
    }
    // To sRGB's primaries, in light.
    let mut light = ColorProfile::new_srgb();
    let straight = Some(ToneReprCurve::Lut(Vec::new()));
    (light.red_trc, light.green_trc, light.blue_trc) =
        (straight.clone(), straight.clone(), straight);
    light.cicp = None;
    let options = TransformOptions {
        rendering_intent: RenderingIntent::RelativeColorimetric,
        prefer_fixed_point: false,
        ..TransformOptions::default()
    };
    let layout = if of_grey { Layout::Gray } else { Layout::Rgb };
    let made = std::panic::catch_unwind(|| {
        profile.create_transform_f32(layout, &light, Layout::Rgb, options)
    });
    let Ok(Ok(transform)) = made else {
        return Told::unheard(&format!(
            "its colour profile{title} is of a kind that is not known here"
        ));
    };
    if is_srgb(&transform, of_grey) {
        return Told::srgb();
    }
    let note = Some(format!("its colours are converted from its profile{title} to sRGB"));
    Told { encoding: Encoding::Icc { transform, grey: of_grey }, note }
}

/// Whether a profile is sRGB's own, in one of the many forms that it is written in: no code of 8 bits would change.
fn is_srgb(transform: &Arc<TransformF32Executor>, grey: bool) -> bool {
    const STEPS: usize = 8;
    let level = |i: usize| i as f32 / STEPS as f32;
    let codes: Vec<[f32; 3]> = match grey {
        true => (0..=STEPS).map(|i| [level(i); 3]).collect(),
        false => (0..(STEPS + 1).pow(3))
            .map(|i| [level(i % 9), level(i / 9 % 9), level(i / 81)])
            .collect(),
    };
    let given: Vec<f32> = match grey {
        true => codes.iter().map(|code| code[0]).collect(),
        false => codes.as_flattened().to_vec(),
    };
    let mut light = vec![0.0; codes.len() * 3];
    transform.transform(&given, &mut light).is_ok()
        && light.iter().zip(codes.as_flattened()).all(|(&light, &code)| {
            (srgb::encode(f64::from(light.clamp(0.0, 1.0))) - f64::from(code)).abs() < 0.5 / 255.0
        })
}
