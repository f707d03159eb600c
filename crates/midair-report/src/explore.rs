//! An exploration: maps over two of its values, small multiples over a third, curves over one.

use crate::drawing::chart_sheet::{Axis, Curve, curves, map, row};
use crate::drawing::{Chart, colour_map};
use midair::evaluate::explore::{Exploration, NAMES, Point, SHARES};
use midair::picture::Picture;

/// Maps in a row of small multiples, at most.
const MULTIPLES: usize = 6;
/// Width and height of a map in pixels, about.
const PLOT: usize = 240;
/// A curve's colour (Okabe and Ito's blue), sRGB.
const BLUE: [u8; 3] = [0, 114, 178];

/// What is drawn, a picture each: one of [`NAMES`] and what it is called.
const DRAWN: [(&str, &str); 8] = [
    ("formed", "share formed"),
    ("folded", "share folded"),
    ("total_reflection", "share lost by total reflection"),
    ("least_magnification", "least magnification"),
    ("mean_gain", "mean share of light"),
    ("evenness", "evenness of light"),
    ("stray", "stray light over the image"),
    ("sideways", "viewer may move sideways, mm"),
];

/// The pictures of an exploration by name. Over more than three axes the others stand where the best set-up has them. `units` are the axes'.
pub fn pictures(found: &Exploration, units: &[Option<&str>]) -> Vec<(String, Picture)> {
    let varied: Vec<usize> =
        (0..found.axes.len()).filter(|&axis| found.axes[axis].values.len() > 1).collect();
    DRAWN
        .iter()
        .filter_map(|&(name, title)| {
            let number = NAMES.iter().position(|known| *known == name)?;
            let picture = match varied[..] {
                [] => None,
                [axis] => curve(found, units, axis, number, title),
                [x, y] => sheets(found, units, [x, y], None, number, title),
                [x, y, third, ..] => sheets(found, units, [x, y], Some(third), number, title),
            };
            Some((format!("{}.png", name.replace('_', "-")), picture?))
        })
        .collect()
}

/// A number of a set-up; NaN where there is none.
fn number_of(point: &Point, number: usize) -> f64 {
    point.outcome.as_ref().map_or(f64::NAN, |measured| measured.numbers()[number])
}

/// Where the best set-up stands along each axis.
fn best_places(found: &Exploration) -> Vec<usize> {
    found.places(found.best(1).first().copied().unwrap_or(0))
}

fn label(found: &Exploration, units: &[Option<&str>], axis: usize) -> String {
    let path = &found.axes[axis].path;
    units
        .get(axis)
        .copied()
        .flatten()
        .map_or_else(|| path.clone(), |unit| format!("{path}, {unit}"))
}

/// The least and the largest number there is; shares reach from 0 to 1. `None` where nothing differs or is known.
fn range(found: &Exploration, number: usize) -> Option<[f64; 2]> {
    let known = found.points.iter().map(|point| number_of(point, number)).filter(|n| n.is_finite());
    let [least, most] =
        known.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], n| [a.min(n), b.max(n)]);
    if !(least < most) {
        return None;
    }
    let is_share = number < SHARES || NAMES[number] == "evenness";
    Some(if is_share { [0.0, 1.0] } else { [least, most] })
}

fn curve(
    found: &Exploration,
    units: &[Option<&str>],
    axis: usize,
    number: usize,
    title: &str,
) -> Option<Picture> {
    let y = range(found, number)?;
    let values = &found.axes[axis].values;
    let mut places = best_places(found);
    let mut points: Vec<[f64; 2]> = Vec::new();
    for (place, &value) in values.iter().enumerate() {
        places[axis] = place;
        let n = number_of(found.at(&places), number);
        if n.is_finite() {
            points.push([value, n]);
        }
    }
    points.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let ends = [points.first()?[0], points.last()?[0]];
    if ends[0] == ends[1] {
        return None;
    }
    let label = label(found, units, axis);
    let x = Axis { label: &label, range: ends, intervals: 4 };
    let y = Axis { label: "", range: y, intervals: 4 };
    Some(curves(&[Curve { name: "", colour: BLUE, points }], [420, 260], title, &x, &y))
}

fn sheets(
    found: &Exploration,
    units: &[Option<&str>],
    [x, y]: [usize; 2],
    third: Option<usize>,
    number: usize,
    title: &str,
) -> Option<Picture> {
    let range = range(found, number)?;
    let labels = [x, y].map(|axis| label(found, units, axis));
    let mut places = best_places(found);
    let shown: Vec<usize> = match third {
        None => vec![0],
        Some(third) => {
            let count = found.axes[third].values.len();
            let most = count.min(MULTIPLES);
            // Spread over all of them, both ends included.
            (0..most).map(|k| k * (count - 1) / (most - 1).max(1)).collect()
        }
    };
    let sheets: Vec<Picture> = shown
        .into_iter()
        .map(|place| {
            let mut title = title.to_owned();
            if let Some(third) = third {
                places[third] = place;
                title = format!(
                    "{title}; {} = {}",
                    found.axes[third].path, found.axes[third].values[place]
                );
            }
            let picture = plot(found, [x, y], &mut places.clone(), number, range);
            let ends = |axis: usize| {
                let values = &found.axes[axis].values;
                [values[0], values[values.len() - 1]]
            };
            let across = Axis { label: &labels[0], range: ends(x), intervals: 4 };
            let up = Axis { label: &labels[1], range: ends(y), intervals: 4 };
            map(&Chart { picture, range }, &title, &across, &up)
        })
        .collect();
    Some(row(&sheets))
}

/// The numbers over two axes as colours; the values at the ends lie on the plot's edges.
fn plot(
    found: &Exploration,
    [x, y]: [usize; 2],
    places: &mut [usize],
    number: usize,
    [least, most]: [f64; 2],
) -> Picture {
    let counts = [x, y].map(|axis| found.axes[axis].values.len());
    let [width, height] = counts.map(|count| PLOT.max(count));
    let nearest = |pixel: usize, pixels: usize, count: usize| {
        (pixel as f64 / (pixels - 1) as f64 * (count - 1) as f64).round() as usize
    };
    let mut pixels = Vec::with_capacity(width * height);
    for row in 0..height {
        places[y] = nearest(height - 1 - row, height, counts[1]);
        for column in 0..width {
            places[x] = nearest(column, width, counts[0]);
            let n = number_of(found.at(places), number);
            let [r, g, b] = colour_map((n - least) / (most - least));
            pixels.push(if n.is_finite() { [r, g, b, 1.0] } else { [0.0; 4] });
        }
    }
    Picture { width, height, pixels }
}

#[cfg(test)]
mod tests {
    use super::*;
    use midair::evaluate::explore::{Settings, explore};
    use midair::scene::{Format, InMemory, load_text};

    fn found(axes: &[&str]) -> Exploration {
        let text = "[viewpoint]\nposition = [0.0, 0.0, 800.0]\n[image]\nsize = [20.0, 20.0]\n\
             [plate]\nposition = [0.0, 0.0, -150.0]\nrotation = [-45.0, 0.0, 0.0]\nsize = [400.0, 400.0]\n\
             [display]\nsize = [10.0, 10.0]\n";
        let loaded = load_text(text, "a.toml", Format::Toml, &InMemory::new()).unwrap();
        let axes: Vec<_> = axes.iter().map(|axis| axis.parse().unwrap()).collect();
        let settings = Settings::default().resolution(16).settle(0.0);
        explore(&loaded, &axes, &settings, &InMemory::new(), &()).unwrap()
    }

    #[test]
    fn a_map_has_the_colours_of_its_numbers_at_its_corners() {
        // A display of 5 mm shows a sixteenth of the image, one of 20 mm all of it; the eye's height changes nothing.
        let found = found(&["display.size=5,20", "viewpoint.position.y=0,10"]);
        let picture = plot(&found, [0, 1], &mut [0, 0], 0, [0.0, 1.0]);
        let at = |x: usize, y: usize| picture.pixels[y * picture.width + x];
        let opaque = |[r, g, b]: [f32; 3]| [r, g, b, 1.0];
        assert_eq!(at(0, 0), opaque(colour_map(1.0 / 16.0)));
        assert_eq!(at(picture.width - 1, picture.height - 1), opaque(colour_map(1.0)));
        let names: Vec<String> =
            pictures(&found, &[Some("mm"), Some("mm")]).into_iter().map(|(name, _)| name).collect();
        assert!(names.contains(&"formed.png".to_owned()), "{names:?}");
        // Nothing folds anywhere: there is nothing to draw of it.
        assert!(!names.contains(&"folded.png".to_owned()), "{names:?}");
    }

    #[test]
    fn one_axis_is_a_curve_and_a_third_makes_small_multiples() {
        let one = pictures(&found(&["display.size=5..20:4"]), &[None]);
        assert!(one.iter().any(|(name, _)| name == "formed.png"));
        let two = pictures(&found(&["display.size=5,20", "image.position.x=0,1"]), &[None; 2]);
        let three = pictures(
            &found(&["display.size=5,20", "image.position.x=0,1", "image.position.y=0..2:3"]),
            &[None; 3],
        );
        let width = |pictures: &[(String, Picture)]| pictures[0].1.width;
        assert!(width(&three) > 2 * width(&two));
    }
}
