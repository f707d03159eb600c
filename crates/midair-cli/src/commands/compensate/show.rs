//! What the display must show of a picture: colour, brightness, the display's own response.

use super::maps::Solutions;
use crate::arguments::{GainMode, check_view};
use crate::failure::Failure;
use crate::output::Output;
use crate::summary::percent;
use midair::evaluate::proof::{Reference, view_size};
use midair::map::{Gain, Map};
use midair::media::optimal::{Weighting, optimal_display, view_through};
use midair::media::{
    Depth, Picture, Still, display_image, display_image_by_colour, drive, even_out, write_still,
};
use midair::scene::Loaded;
use midair::simulate::{Camera, Plate, gain};
use midair::transport::Setup;
use serde_json::{Value, json};

/// The gain of each map.
pub fn gains(loaded: &Loaded, solutions: &Solutions) -> Result<Vec<Gain>, Failure> {
    let plate = Plate::new(&loaded.scene.plate.model).map_err(|error| {
        Failure::new(error.to_string(), "change that value in the scene's [plate]")
    })?;
    let plate = plate.with_luminance(loaded.luminance.as_ref(), &solutions.main().setup);
    Ok(solutions.0.iter().map(|solved| gain(&solved.setup, &plate, &solved.map)).collect())
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
        let finite = || gain.rgb.iter().flatten().copied().filter(|g| g.is_finite());
        let least = finite().fold(f32::INFINITY, f32::min);
        let most = finite().fold(0.0, f32::max);
        told["gain"] = json!({
            "mode": mode.name(),
            "level": evened.level,
            "clipped": evened.clipped,
            "least": if least.is_finite() { json!(least) } else { Value::Null },
            "most": most,
        });
        lines += &format!(
            "{:.1} to {:.1} % of the display's light arrives; evened out ({}) white is {:.1} % of the display's, {} of the samples clipped\n",
            100.0 * if least.is_finite() { least } else { 0.0 },
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
    display_image_by_colour(picture, [0, 1, 2].map(|c| &solutions.of_colour(c).map))
}

/// The display image whose view comes nearest to what would be seen with no object in the way.
pub fn optimal(
    loaded: &Loaded,
    solutions: &Solutions,
    picture: &Picture,
    initial: &Picture,
) -> Result<Picture, Failure> {
    let setup = &solutions.main().setup;
    let [width, height] = setup.resolution;
    let camera = Camera::at_viewpoint(setup, view_size(setup, width));
    check_view(camera.size, camera.supersampling)?;
    // Without elements there is no dispersion: one target for all colours. Its rays are let go before those of the views.
    let target = {
        let open = Reference::new(loaded, &camera, &|_| {});
        view_through(&open.samples, &display_image(picture, &Map::identity(width, height)))?
    };
    let best_for = |setup: &Setup| -> Result<Picture, Failure> {
        let samples = camera.samples(setup, &|_| {});
        Ok(optimal_display(&samples, &target, initial, Weighting::default())?.display)
    };
    let mut best = best_for(&solutions.0[0].setup)?;
    for (c, solved) in solutions.0.iter().enumerate().skip(1) {
        let other = best_for(&solved.setup)?;
        best.pixels.iter_mut().zip(&other.pixels).for_each(|(pixel, other)| pixel[c] = other[c]);
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
