//! What the display must show of a picture: colour, brightness, the display's own response.

use super::maps::Solutions;
use crate::arguments::{GainMode, check_view};
use crate::failure::Failure;
use crate::output::Output;
use crate::summary::percent;
use midair::evaluate::proof::{Reference, view_size};
use midair::map::{Gain, Map};
use midair::picture::optimal::{Weighting, optimal_display, view_through};
use midair::picture::{
    Depth, Picture, Still, display_image, display_image_by_colour, drive, even_out, write_still,
};
use midair::scene::Loaded;
use midair::simulate::{Camera, gain};
use midair::transport::Setup;
use serde_json::{Value, json};

/// The gain of each map.
pub fn gains(solutions: &Solutions) -> Vec<Gain> {
    solutions.0.iter().map(|solved| gain(&solved.setup, &solved.map)).collect()
}

/// Each colour's gain from its own map.
fn merged(gains: &[Gain]) -> Gain {
    let mut all = gains[0].clone();
    for (c, gain) in gains.iter().enumerate().skip(1) {
        for (rgb, other) in all.rgb.iter_mut().zip(&gain.rgb) {
            rgb[c] = other[c];
        }
    }
    all
}

/// A display image, and what is to be said of it.
pub struct Shown {
    pub display: Picture,
    pub lines: String,
    pub json: Value,
}

/// The display image with the gain divided out, if asked for, and in the display's own codes.
pub fn finish(loaded: &Loaded, light: Picture, evening: Option<(GainMode, &[Gain])>) -> Shown {
    let mut display = light;
    let mut lines = String::new();
    let mut told = json!({});
    if let Some((mode, gains)) = evening {
        let gain = merged(gains);
        let evened = even_out(&display, &gain, mode.overflow());
        display = evened.display;
        let range = gain.range();
        let [least, most] = range.unwrap_or_default();
        told["gain"] = json!({
            "mode": mode.name(),
            "level": evened.level,
            "clipped": evened.clipped,
            "least": range.map(|[least, _]| least),
            "most": range.map(|[_, most]| most),
        });
        lines += &format!(
            "{:.1} to {:.1} % of the display's light arrives; evened out ({}) white is {:.1} % of the display's, {} of the samples clipped\n",
            100.0 * least,
            100.0 * most,
            mode.name(),
            100.0 * evened.level,
            percent(evened.clipped)
        );
    }
    if !loaded.screen.is_plain() {
        let driven = drive(&display, &loaded.screen);
        display = driven.picture;
        told["darker_than_black"] = json!(driven.too_dark);
        if driven.too_dark > 0.0 {
            lines += &format!(
                "{} of the samples are darker than the display's black: there the image stays too bright\n",
                percent(driven.too_dark)
            );
        }
    }
    Shown { display, lines, json: told }
}

/// The picture through the maps.
pub fn colour(picture: &Picture, solutions: &Solutions) -> Picture {
    if !solutions.by_colour() {
        return display_image(picture, &solutions.main().map);
    }
    let maps = [0, 1, 2].map(|c| &solutions.of_colour(c).map);
    display_image_by_colour(picture, maps)
}

/// The display image whose view comes nearest to what would be seen with no object in the way.
///
/// Both pictures are taken over, and rays are traced as they are asked for, so that a megapixel takes little memory.
pub fn optimal(
    solutions: &Solutions,
    picture: Picture,
    initial: Picture,
) -> Result<Picture, Failure> {
    let setup = &solutions.main().setup;
    let [width, height] = setup.resolution;
    let camera = Camera::at_viewpoint(setup, view_size(setup, width));
    check_view(camera.size, camera.supersampling)?;
    // Without elements there is no dispersion: one target for all colours.
    let unbent = display_image(&picture, &Map::identity(width, height));
    drop(picture);
    let target = view_through(&Reference::new(setup, &camera), &unbent)?;
    drop(unbent);
    let best_for = |setup: &Setup, target: Picture, initial: Picture| -> Result<Picture, Failure> {
        Ok(optimal_display(&camera.rays(setup), target, initial, Weighting::default())?.display)
    };
    if !solutions.by_colour() {
        return best_for(setup, target, initial);
    }
    let mut best = initial.clone();
    for (c, solved) in solutions.0.iter().enumerate() {
        let one = best_for(&solved.setup, target.clone(), initial.clone())?;
        best.pixels.iter_mut().zip(&one.pixels).for_each(|(pixel, one)| pixel[c] = one[c]);
    }
    Ok(best)
}

/// Writes what the display shows: 8 bits for a picture of 8 bits, else 16, and OpenEXR for an OpenEXR picture as well.
pub fn write_display(output: &mut Output, still: &Still, display: &Picture) -> Result<(), Failure> {
    output.write("display.png", |path| write_still(path, display, still.depth))?;
    if still.depth == Depth::Float {
        output.write("display.exr", |path| write_still(path, display, Depth::Float))?;
    }
    Ok(())
}
