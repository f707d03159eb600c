//! The device's pictures against the processor's, code by code; skipped with a note where there is no device, not even in software.

use super::*;
use crate::OffScreen;
use midair::map::Map;
use midair::optics::screen::{Response, Screen};
use midair::picture::{Filter, Overflow};
use proptest::prelude::*;

fn device() -> Option<Device> {
    match pollster::block_on(Device::off_screen(true)) {
        Ok(device) => Some(device),
        Err(error) => {
            midair_peers::missing(midair_peers::Peer::Graphics, error);
            None
        }
    }
}

/// The picture in a texture: blue, green, red and one more byte for each pixel.
fn drawn(device: &Device, warper: &mut Warper, size: [usize; 2]) -> Vec<u8> {
    OffScreen::new(device, size).draw(device, warper).unwrap()
}

/// Three of four bytes are seen.
fn seen(bytes: &[u8]) -> Vec<[u8; 3]> {
    bytes.as_chunks::<4>().0.iter().map(|&[b, g, r, _]| [b, g, r]).collect()
}

fn place() -> impl Strategy<Value = f64> {
    prop_oneof![8 => -0.1f64..1.1, 1 => Just(f64::NAN), 1 => prop::sample::select(vec![0.0, 1.0])]
}

/// A display, a source, the map's places and the source's codes.
fn scene() -> impl Strategy<Value = ([usize; 2], [usize; 2], Vec<[f64; 2]>, Vec<u8>)> {
    ([1usize..90, 1usize..40], [1usize..30, 1usize..30]).prop_flat_map(|(display, source)| {
        (
            Just(display),
            Just(source),
            prop::collection::vec([place(), place()], display[0] * display[1]),
            prop::collection::vec(any::<u8>(), 4 * source[0] * source[1]),
        )
    })
}

#[test]
fn a_device_shows_the_processors_codes() {
    let Some(device) = device() else { return };
    println!("on {}", device.name());
    // One warper for all: what is left of a larger picture must not show in a smaller one.
    let warper = std::cell::RefCell::new(Warper::new(&device));
    let measured = Screen { response: Response::Gamma(1.8), ..Screen::default() };
    let drives = [
        Drive::default(),
        Drive::of_screen(&measured, [2, 1, 0]),
        Drive::of_evened(&Screen::default(), [2, 1, 0], Overflow::Soft),
    ];
    proptest!(ProptestConfig::with_cases(60), |((display, source, uv, frame) in scene())| {
        let warper = &mut *warper.borrow_mut();
        let mut map = Map::identity(display[0], display[1]);
        map.uv = uv;
        let warp = Warp::new(&map, source, Filter::Bilinear).unwrap();
        let mut expected = vec![0; 4 * display[0] * display[1]];
        prop_assert!(warper.take_map(&device, &warp, source));
        warper.take_letters(&device, Letters::default());
        let mut light = LightFrame::default();
        light.decode(&frame, 4).unwrap();
        for drive in &drives {
            warp.apply_light(&light, 4, drive, &mut expected).unwrap();
            warper.take_frame(&device, &light, drive);
            prop_assert_eq!(seen(&drawn(&device, warper, display)), seen(&expected));
        }
        // Text over it, no larger than the display: words that let every third pixel through.
        let size = [display[0].min(7), display[1].min(5)];
        let words: Vec<u32> =
            (0..size[0] * size[1]).map(|i| if i % 3 == 0 { 0 } else { 0x01_02_03 * (i as u32 % 80) }).collect();
        warper.take_letters(&device, Letters { size, words: &words });
        for (i, &word) in words.iter().enumerate().filter(|(_, word)| **word != 0) {
            let at = 4 * (i / size[0] * display[0] + i % size[0]);
            expected[at..at + 3].copy_from_slice(&word.to_le_bytes()[..3]);
        }
        prop_assert_eq!(seen(&drawn(&device, warper, display)), seen(&expected));
        // Without a map there is the text alone.
        warper.take_black(&device, display);
        let shown = seen(&drawn(&device, warper, display));
        for (i, shown) in shown.into_iter().enumerate() {
            let [x, y] = [i % display[0], i / display[0]];
            let word = if x < size[0] && y < size[1] { words[y * size[0] + x] } else { 0 };
            prop_assert_eq!(shown.as_slice(), &word.to_le_bytes()[..3]);
        }
    });
}

#[test]
fn only_bilinear_warps_are_taken() {
    let Some(device) = device() else { return };
    let mut warper = Warper::new(&device);
    let sharp = Warp::new(&Map::identity(4, 4), [4, 4], Filter::Sharp).unwrap();
    assert!(!warper.take_map(&device, &sharp, [4, 4]));
}
