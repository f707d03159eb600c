use super::*;
use crate::map::{Accuracy, invert};
use crate::measure::lattice::LatticeStyle;
use crate::optics::plate::{Model, SlitMirror, SlitMirrorPlate};
use crate::picture::Picture;
use crate::scene::{Loaded, load};
use std::io::Write as _;

/// A viewer at 800 mm, an image of 20 mm within the element, a display that is large enough.
fn loaded(element: &str) -> Loaded {
    let text = format!(
        "[viewpoint]\nposition = [0.0, 0.0, 800.0]\n[image]\nsize = [20.0, 20.0]\n\
         [plate]\nposition = [0.0, 0.0, -150.0]\nrotation = [-45.0, 0.0, 0.0]\nsize = [488.0, 488.0]\n\
         [display]\nresolution = [600, 600]\nsize = [40.0, 40.0]\n{element}"
    );
    let mut file = tempfile::Builder::new().suffix(".toml").tempfile().unwrap();
    file.write_all(text.as_bytes()).unwrap();
    load(file.path()).unwrap_or_else(|error| panic!("{error}"))
}

fn fringes_of(loaded: &Loaded, width: usize) -> Fringes {
    let setup = Setup::new(loaded).unwrap();
    let one = invert(&setup, Accuracy::default()).0;
    fringes(&setup, &one, &LatticeStyle::default(), width).unwrap()
}

const SLAB: &str = "[[element]]\nshape = { kind = \"box\", size = [60.0, 60.0, 50.0] }\n";

#[test]
fn a_tinted_wedge_is_as_uneven_as_its_thickness_says_and_evens_out() {
    // A cone of glass about y would do as well; a cylinder's thickness along the rays is the chord 2 sqrt(r^2 - x^2) to first order.
    let absorption = [0.0, 0.02, 0.05];
    let tinted = "[[element]]\nshape = { kind = \"cylinder\", radius = 25.0, height = 60.0 }\n\
                  material = { ior = 1.0 }\nabsorption = [0.0, 0.02, 0.05]\n";
    let setup = Setup::new(&loaded(tinted)).unwrap();
    let found = evenness(&setup, [101, 101]);
    // Glass of index 1 bends nothing: the chord at the outermost pixel (x = 10 less half a pixel, seen from 800 mm) and at the middle.
    let chord = |x: f64| 2.0 * (25.0f64 * 25.0 - x * x).sqrt();
    // Red alone would be even; blue is the worst.
    let expected = (absorption[2] * (chord(0.0) - chord(9.9))).exp();
    // The outermost points miss by the edge's display pixel (0.16 mm of 10) and by perspective (1 % of the chord's difference).
    assert!((found.plain / expected - 1.0).abs() < 0.01, "{} {expected}", found.plain);
    // Single precision, and 1 / gain interpolated between display pixels: second differences of (0.16 mm / 25 mm)^2, 4e-5.
    assert!((found.even - 1.0).abs() < 1e-4, "{}", found.even);
    assert!(found.clipped > 0.01 && found.clip_level > found.fit_level);
    let least = (-absorption[2] * chord(0.0)).exp();
    assert!((found.fit_level / least - 1.0).abs() < 1e-3, "{} {least}", found.fit_level);
}

#[test]
fn nothing_in_the_way_is_even_but_for_the_plate() {
    let setup = Setup::new(&loaded("")).unwrap();
    let found = evenness(&setup, [32, 32]);
    assert_eq!((found.plain, found.even, found.clipped), (1.0, 1.0, 0.0));
    let plate = Model::from(SlitMirrorPlate::new(SlitMirror::default()).unwrap());
    let found = evenness(&setup.with_plate(plate), [32, 32]);
    // Directions over the image differ by 1.4 degrees: enough for the plate's efficiency to vary.
    assert!(found.plain > 1.005 && found.even < 1.001, "{} {}", found.plain, found.even);
}

#[test]
fn a_turned_slab_has_the_fringes_that_the_textbook_says() {
    let flint = format!("{SLAB}rotation = [0.0, 35.0, 0.0]\nmaterial = {{ glass = \"SF10\" }}\n");
    let found = fringes_of(&loaded(&flint), 800);
    // A slab of 50 mm at 35 degrees shifts by T sin a (1 - cos a / sqrt(n^2 - sin^2 a)); 40 pixels a mm.
    let shift = |n: f64| {
        let (sin, cos) = 35f64.to_radians().sin_cos();
        50.0 * sin * (1.0 - cos / (n * n - sin * sin).sqrt())
    };
    let glass = crate::optics::glass::lookup("SF10").unwrap();
    let expected = 40.0 * (shift(glass.index(0.465)) - shift(glass.index(0.611)));
    // Horizontal lines, half of the places, have next to none: the mean is half of what vertical ones have. The textbook's light is
    // parallel; here it comes from 800 mm.
    assert!((found.one_map.max / expected - 1.0).abs() < 0.1, "{found:?} {expected}");
    assert!((2.0 * found.one_map.mean / expected - 1.0).abs() < 0.1, "{found:?} {expected}");
    // What is left is the maps' interpolation between 512 pixels.
    assert!(found.by_colour.max < 0.01, "{found:?}");
    assert!(found.places > 500, "{found:?}");
    // The close-ups: grey with three maps, coloured with one.
    let colour = |picture: &Picture| {
        let spread =
            picture.pixels.iter().map(|[r, g, b, _]| r.max(*g).max(*b) - r.min(*g).min(*b));
        f64::from(spread.fold(0.0f32, f32::max))
    };
    let [plain, by_colour] = &found.close_ups;
    // Display pixels fall upon lines differently for each colour: a tenth of a display pixel's contrast.
    assert!(
        colour(plain) > 0.5 && colour(by_colour) < 0.3,
        "{} {}",
        colour(plain),
        colour(by_colour)
    );
}

#[test]
fn without_dispersion_there_are_no_fringes() {
    let acrylic = format!("{SLAB}rotation = [0.0, 35.0, 0.0]\nmaterial = {{ ior = 1.49 }}\n");
    let found = fringes_of(&loaded(&acrylic), 200);
    assert_eq!((found.one_map.max, found.by_colour.max), (0.0, 0.0));
}
