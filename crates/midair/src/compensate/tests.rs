//! A compensation against what its parts are known to be.

use super::*;
use crate::optics::Index;
use crate::optics::screen::{Response, Screen};
use crate::transport::Matter;
use crate::transport::bench_setup::{ACRYLIC, element, setup, sphere};

fn ramp() -> Picture {
    let pixels = (0..64 * 64).map(|i| [(i % 64) as f32 / 64.0, 0.5, 0.25, 1.0]).collect();
    Picture { width: 64, height: 64, pixels }
}

#[test]
fn with_nothing_in_the_way_the_display_shows_the_picture_as_it_is() {
    let setup = setup(20.0, vec![]).with_resolution([64, 64]);
    let compensation = Compensation::of(&setup, &Options::new(), &());
    let shown = compensation.display(&ramp());
    // The map is the identity within 1e-6 of the image, 6e-5 pixels; the ramp rises by 1/64 in a pixel.
    for (a, b) in shown.display.pixels.iter().zip(&ramp().pixels) {
        assert!((0..4).all(|c| (a[c] - b[c]).abs() < 1e-5), "{a:?} {b:?}");
    }
    assert_eq!(shown.brightness, Brightness::default());
    let report = compensation.report();
    assert_eq!((report.status.ok, report.status.all()), (64 * 64, 64 * 64));
    assert!(report.error_bound.is_some_and(|bound| bound <= 1e-6) && report.colours.is_none());
}

#[test]
fn each_colour_has_its_own_map_where_that_is_asked_for() {
    let mut ball = element(sphere(25.0), ACRYLIC, [0.0; 3], [0.0; 3], 0);
    ball.index = Some(Index::Cauchy(1.45, 2e-2));
    let setup = setup(20.0, vec![ball]).with_resolution([64, 64]);
    let compensation = Compensation::of(&setup, &Options::new().by_colour(true), &());
    assert!(compensation.is_by_colour() && setup.disperses());
    let shown = compensation.display(&ramp()).display;
    for (c, solved) in compensation.solved().iter().enumerate() {
        let Matter::Refractive { index, .. } = solved.setup.elements[0].matter else { panic!() };
        let micrometres = setup.wavelengths[c] / 1000.0;
        assert!((index - (1.45 + 2e-2 / micrometres.powi(2))).abs() < 1e-12);
        let alone = display_image(&ramp(), &solved.map);
        assert!(shown.pixels.iter().zip(&alone.pixels).all(|(all, one)| all[c] == one[c]));
    }
    let report = serde_json::to_value(compensation.report()).unwrap();
    let blue = compensation.solved()[2].map.counts();
    assert_eq!(report["colours"]["blue"]["status"]["ok"], blue.ok);
    assert_eq!(report["method"], "inverse");
}

#[test]
fn the_gain_is_divided_out_and_the_screen_is_sent_its_own_codes() {
    // Tinted glass of index 1 bends nothing: what arrives goes by the chord alone.
    let tinted = Matter::Refractive { index: 1.0, absorption: [0.02; 3] };
    let mut setup = setup(20.0, vec![element(sphere(25.0), tinted, [0.0; 3], [0.0; 3], 0)])
        .with_resolution([64, 64]);
    setup.screen = Screen { response: Response::Gamma(1.0), ..Screen::default() };
    let options = Options::new().gain(Some(Overflow::Fit));
    let compensation = Compensation::of(&setup, &options, &());
    let white = Picture::filled(1, 1, [1.0; 4]);
    let shown = compensation.display(&white);
    let gain = &compensation.gains().unwrap()[0];
    let Some(GainReport { level, clipped, .. }) = shown.brightness.gain else { panic!() };
    // The longest chord through the ball, at its middle, leaves least.
    assert!((level / (-0.02f64 * 50.0).exp() - 1.0).abs() < 1e-3, "{level}");
    assert_eq!(clipped, 0.0);
    let mut compared = 0;
    for (pixel, gain) in shown.display.pixels.iter().zip(&gain.rgb) {
        if Gain::is_answered(gain) {
            // A screen of gamma 1 emits its code: the sRGB code of the picture is the light itself.
            let code = crate::picture::srgb::encode(f64::from(pixel[1]));
            assert!((code * f64::from(gain[1]) / level - 1.0).abs() < 1e-5);
            compared += 1;
        }
    }
    assert_eq!(compared, 64 * 64);
    assert_eq!(shown.brightness.darker_than_black, Some(0.0));
}
