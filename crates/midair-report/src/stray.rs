//! Stray light over the image: in words, and as pictures.

use crate::drawing::stray_picture;
use crate::percent;
use midair::evaluate::stray::{KINDS, Stray};
use midair::picture::{Picture, srgb};
use midair::simulate::StrayView;

/// What the kinds are drawn in, linear light.
const COLOURS: [[f32; 3]; 3] = [[1.0, 0.45, 0.1], [0.15, 0.4, 1.0], [0.2, 0.8, 0.3]];

/// How much there is, in one line: for summaries of other things.
pub fn line(stray: &Stray) -> String {
    let plate = if stray.assumed { "with the usual slit-mirror plate, " } else { "" };
    let better = stray.best.view.burden() < stray.near.burden();
    format!(
        "{plate}{} of the image's light is stray light over it{}\n",
        percent(stray.near.burden()),
        if better { "; report.html says which pose has less" } else { "" }
    )
}

/// What there is, where, and what would be better.
pub fn lines(stray: &Stray) -> String {
    let mut lines = String::new();
    if stray.assumed {
        lines += "the scene's plate is ideal; with the usual slit-mirror plate:\n";
    }
    for (kind, name) in KINDS.iter().enumerate() {
        let covered = stray.near.covered(kind);
        if covered > 0.0 {
            lines += &format!(
                "{name}: over {} of the image, up to {} as bright\n",
                percent(covered),
                percent(stray.near.brightness(kind))
            );
        } else if stray.wide.brightness(kind) > 0.0 {
            lines += &format!("{name}: beside the image\n");
        }
    }
    if stray.near.burden() == 0.0 {
        lines += "no stray light lies over the image\n";
    } else if stray.best.azimuth == stray.azimuth && stray.best.shift == 0.0 {
        lines += &format!(
            "no turn of the plate in its plane, and no shift of the display along its normal by up to {:.0} mm, leaves less of it over the image\n",
            stray.limits.shift[1]
        );
    } else {
        let mut pose = Vec::new();
        if stray.best.azimuth != stray.azimuth {
            pose.push(format!("the plate turned in its plane to azimuth = {}", stray.best.azimuth));
        }
        if stray.best.shift != 0.0 {
            let way =
                if stray.best.shift > 0.0 { "towards the plate" } else { "away from the plate" };
            let position = stray.display.map(|c| (c * 100.0).round() / 100.0 + 0.0);
            pose.push(format!(
                "the display moved {:.0} mm {way} to position = {position:?}",
                stray.best.shift.abs()
            ));
        }
        lines += &format!(
            "{} would leave {} of the image's light over it instead of {}\n",
            pose.join(" and "),
            percent(stray.best.view.burden()),
            percent(stray.near.burden())
        );
    }
    lines
}

/// The [`picture`] of four times the image's width and height, with what its colours mean.
pub fn sheet(stray: &Stray) -> Picture {
    let colours = [[255, 255, 255]].into_iter().chain(COLOURS.map(|c| c.map(srgb::encode_8)));
    let names = std::iter::once("the image").chain(KINDS).enumerate();
    let told = |(i, name): (usize, &str)| match i {
        0 => "the image, in the middle".to_owned(),
        _ if stray.wide.brightness(i - 1) > 0.0 => {
            format!("{name}: up to {} as bright", percent(stray.wide.brightness(i - 1)))
        }
        _ => format!("{name}: none"),
    };
    let legend: Vec<_> = colours.zip(names.map(told)).collect();
    let plate = if stray.assumed { " of the usual slit-mirror plate" } else { "" };
    let title = format!("Stray light{plate}, four times as wide as the image");
    stray_picture::draw(&title, &picture(&stray.wide), &legend)
}

/// The image (white) with the two stray images (orange and blue) and what is seen through the plate (green): luminances over the image's
/// brightest.
pub fn picture(view: &StrayView) -> Picture {
    let most = view.image.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
    let pixels = (0..view.image.len()).map(|pixel| {
        let mut rgb = [view.image[pixel] / most; 3];
        for (kind, colour) in view.stray.iter().zip(COLOURS) {
            (0..3).for_each(|c| rgb[c] += f64::from(colour[c]) * kind[pixel] / most);
        }
        let [r, g, b] = rgb.map(|value| value.min(1.0) as f32);
        [r, g, b, 1.0]
    });
    let [width, height] = view.size;
    Picture { width, height, pixels: pixels.collect() }
}
