//! What the preflight says of the image: what is lost, folded, in the dark, of few pixels.

use super::*;

#[test]
fn a_display_that_is_too_small_is_enlarged_in_its_proportions_or_the_image_made_smaller() {
    // Through a ball the image asks for more than its own size; pixels of 4 : 3 stay square.
    let ball = (
        "shape = { kind = \"box\", size = [50.0, 50.0, 50.0] }",
        "shape = { kind = \"sphere\", radius = 25.0 }",
    );
    let image = ("size = [30.0, 30.0]", "size = [28.0, 28.0]");
    let text = scene(&[ball, image, ("[300, 300]", "[320, 240]\nsize = [28.0, 21.0]")]);
    let preflight = found(&text);
    let finding = one(&preflight, Kind::NotFormed);
    assert!(finding.sentence.contains("past the display"), "{}", finding.sentence);
    let size = preflight.display.unwrap().size;
    // Sides are rounded up to a tenth of a millimetre.
    assert!((size[0] / size[1] - 4.0 / 3.0).abs() < 0.01 && size[0] > 28.0, "{size:?}");
    cured(&text, Kind::NotFormed);
    // An image that nearly fills the ball would ask for a display without end: a smaller image is advised, and fits.
    let text = scene(&[ball, ("size = [30.0, 30.0]", "size = [35.0, 35.0]"), ("1.49", "1.8")]);
    let preflight = found(&text);
    let advice = preflight.display.unwrap();
    let image = advice.image.expect("a smaller image");
    assert!(image[0] < 35.0 && image[0] > 0.25 * 35.0 && advice.size[0] < 100.0, "{advice:?}");
    let lost = preflight.findings.iter().find(|f| f.sentence.contains("past the display")).unwrap();
    let after = found(&followed(&text, lost));
    assert!(!after.findings.iter().any(|f| f.sentence.contains("past the display")), "{after:?}");
}

#[test]
fn a_plate_that_the_light_misses_is_shifted_or_enlarged() {
    for (plate, larger) in [
        // Shifted aside, as large as before: it need only go back.
        (
            "position = [240.0, 0.0, -150.0]\nrotation = [-45.0, 0.0, 0.0]\nsize = [488.0, 488.0]",
            false,
        ),
        ("position = [0.0, 0.0, -150.0]\nrotation = [-45.0, 0.0, 0.0]\nsize = [60.0, 30.0]", true),
    ] {
        let text = scene(&[
            (
                "position = [0.0, 0.0, -150.0]\nrotation = [-45.0, 0.0, 0.0]\nsize = [488.0, 488.0]",
                plate,
            ),
            ("[300, 300]", "[300, 300]\nsize = [32.0, 32.0]"),
        ]);
        let preflight = found(&text);
        let finding =
            preflight.findings.iter().find(|f| f.sentence.contains("past the plate")).unwrap();
        assert_eq!(
            finding.lines.iter().any(|line| line.key == "plate.size"),
            larger,
            "{finding:?}"
        );
        let after = found(&followed(&text, finding));
        assert!(!after.findings.iter().any(|f| f.sentence.contains("past the plate")), "{after:?}");
        // The display's place has not moved.
        assert!(after.floating.is_in_place());
    }
}

#[test]
fn an_object_beside_the_light_is_told_and_the_air_in_a_glass_is_not() {
    let text = scene(&[(
        "material = { ior = 1.49 }",
        "position = [200.0, 0.0, 0.0]\nmaterial = { ior = 1.49 }",
    )]);
    let finding = one(&found(&text), Kind::Unmet).clone();
    assert!(finding.sentence.contains("\"cube\""), "{}", finding.sentence);
    // In the glass of water nothing meets the air above: it belongs to the glass.
    let glass = found_in(&load(&example("glass-of-water.toml")).unwrap());
    assert!(!wrong(&glass).contains(&Kind::Unmet), "{:?}", glass.findings);
}

#[test]
fn an_image_that_sticks_out_is_cut_to_what_fits() {
    let text = scene(&[
        ("size = [30.0, 30.0]", "size = [60.0, 40.0]"),
        ("[300, 300]", "[300, 200]\nsize = [90.0, 60.0]"),
    ]);
    let preflight = found(&text);
    let finding = one(&preflight, Kind::SticksOut);
    // A cube of 50 mm holds 50 x 33.3 of 3 : 2.
    assert_eq!(finding.lines[0].key, "image.size");
    let shown = finding.lines[0].value.to_string();
    assert!(["[49.9, 33.3]", "[50.0, 33.3]"].contains(&shown.as_str()), "{shown}");
    cured(&text, Kind::SticksOut);
}

#[test]
fn a_viewer_in_the_plates_dark_is_told_and_shown_a_lighter_place() {
    // From 45 degrees above, light meets the plate head on: no mirror is met.
    let text = scene(&[
        ("[0.0, 0.0, 800.0]", "[0.0, 560.0, 565.0]"),
        ("[0.0, 0.0, 0.0]", "[0.0, 0.0, 0.0]\nrotation = [-45.0, 0.0, 0.0]"),
    ]);
    let preflight = found(&text);
    let light = preflight.light.unwrap();
    assert!(light.assumed_plate && light.incidence < 3.0, "{light:?}");
    assert!(light.plate < 0.02 * light.best, "{light:?}");
    let finding = one(&preflight, Kind::Light);
    assert_eq!(finding.severity, Severity::Fault);
    cured(&text, Kind::Light);
    // Straight on, light meets a lossless plate at 45 degrees: 86 % of it is turned twice (Kiuchi and Koizumi 2021).
    let plate = "size = [488.0, 488.0]\nmodel = \"slit-mirror\"\nreflectance = 1.0";
    let bare = scene(&[("size = [488.0, 488.0]", plate), ("ior = 1.49", "ior = 1.0")]);
    let light = found(&bare).light.unwrap();
    assert!(!light.assumed_plate && (light.incidence - 45.0).abs() < 1.5, "{light:?}");
    // Fresnel's losses at both faces of index 1.52, about 10 % at 45 degrees, come off.
    assert!((0.75..0.86).contains(&light.plate), "{light:?}");
    assert!((light.mean / light.plate - 1.0).abs() < 1e-12, "{light:?}");
}

#[test]
fn pixels_that_are_not_square_are_told_and_swapped_sides_are_seen() {
    let display = |rest: &str| scene(&[("[300, 300]", rest)]);
    assert!(
        !wrong(&found(&display("[400, 300]\nsize = [40.0, 30.0]"))).contains(&Kind::PixelShape)
    );
    let swapped = display("[400, 300]\nsize = [30.0, 40.0]");
    let preflight = found(&swapped);
    assert!(one(&preflight, Kind::PixelShape).remedy.as_ref().unwrap().contains("swapped"));
    let text = followed(&swapped, one(&preflight, Kind::PixelShape));
    assert!(found(&text).pixels.are_square());
    for odd in ["[300, 300]\nsize = [40.0, 30.0]", "[400, 300]"] {
        let text = display(odd);
        let preflight = found(&text);
        assert!(!preflight.pixels.are_square());
        let text = followed(&text, one(&preflight, Kind::PixelShape));
        assert!(found(&text).pixels.are_square(), "{text}");
    }
    // A data sheet's rounding is none: 1920 x 1200 on 216.9 x 135.5 mm.
    assert!(found(&display("[1920, 1200]\nsize = [216.9, 135.5]")).pixels.are_square());
}

#[test]
fn few_pixels_are_told() {
    let preflight = found(&scene(&[("[300, 300]", "[40, 40]\nsize = [32.0, 32.0]")]));
    assert_eq!(one(&preflight, Kind::PixelCount).severity, Severity::Warning);
    let preflight = found(&scene(&[
        ("position = [0.0, 0.0, 0.0]", "position = [0.0, 400.0, 0.0]"),
        ("488.0, 488.0", "50.0, 50.0"),
    ]));
    assert_eq!(one(&preflight, Kind::PixelCount).severity, Severity::Fault);
    assert!(
        preflight
            .findings
            .iter()
            .any(|f| f.kind == Kind::NotFormed && f.severity == Severity::Fault)
    );
}
