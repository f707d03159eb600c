//! Colour fringes at a lattice's lines, with one map for all colours and with one for each.

use super::super::proof::ProofError;
use super::super::proof::displacement::Sight;
use super::{coarse, shows};
use crate::map::{Accuracy, Map, invert};
use crate::measure::lattice::{LatticeStyle, draw_lattice};
use crate::picture::optimal::{ViewSamples, view_through};
use crate::picture::{Picture, display_image, display_image_by_colour};
use crate::simulate::Camera;
use crate::transport::{Path, Setup, on_display};
use serde::Serialize;

/// How wide fringes are at lattice lines: the distance across the line between the outermost of the three colours, in view pixels.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct FringeWidth {
    /// Mean over all places; NaN where nothing is formed.
    pub mean: f64,
    /// At the worst place.
    pub max: f64,
}

/// The fringes of a lattice, with and without a map for each colour.
#[derive(Clone, Debug, PartialEq)]
pub struct Fringes {
    /// With one map, made for [`DESIGN_WAVELENGTH`](crate::transport::DESIGN_WAVELENGTH).
    pub one_map: FringeWidth,
    /// With a map for each colour.
    pub by_colour: FringeWidth,
    /// Places on the lines that were compared: those that all three colours reach.
    pub places: usize,
    /// Display pixels along a side of the maps of each colour.
    pub resolution: [usize; 2],
    /// A white lattice about the worst place, a fifth of the view wide: with one map, and with three. Linear light.
    pub close_ups: [Picture; 2],
}

/// Display pixels along a side of the maps of each colour.
const PIXELS: usize = 512;
/// Places between two neighbouring lines.
const PLACES: usize = 8;
/// Width of the close-ups: pixels, and as a share of the image.
const CLOSE_UP: usize = 192;
const CLOSE_UP_SHARE: f64 = 0.2;
/// Pixels along a side that the lattice of a close-up is drawn with, at least and at most.
const DRAWN: [usize; 2] = [768, 2048];

/// Fringes of a scene at the lines of a lattice, in pixels of a view that is `width` pixels wide; `one` is the scene's map for all colours.
///
/// # Errors
/// [`ProofError`] where the scene cannot be traced or the lattice not be drawn.
pub fn fringes(
    setup: &Setup,
    one: &Map,
    style: &LatticeStyle,
    width: usize,
) -> Result<Fringes, ProofError> {
    let setups = setup.by_colour().map(|setup| coarse(setup, PIXELS));
    let three = setups.each_ref().map(|setup| invert(setup, Accuracy::default()).0);
    let camera = Camera::at_viewpoint(setup, setup.view_size(width));

    let mut sums = [FringeWidth { mean: 0.0, max: 0.0 }; 2];
    let (mut places, mut worst) = (0, [0.5; 2]);
    for (uv, across) in on_lines(style) {
        let at = |map: &Map, c: usize| -> Option<f64> {
            let seen = Sight { setup: &setups[c], map }.compensated(uv)?;
            Some(camera.view_position(seen)[across])
        };
        let width = |maps: [&Map; 3]| -> Option<f64> {
            let [r, g, b] = [at(maps[0], 0)?, at(maps[1], 1)?, at(maps[2], 2)?];
            Some(r.max(g).max(b) - r.min(g).min(b))
        };
        let whole = |c: usize| {
            let st = setups[c].transport(uv, &mut Path::new()).formed();
            st.is_some_and(|st| shows(&three[c], st, uv, 0.5 / PIXELS as f64))
        };
        let widths = (width([one; 3]), width(three.each_ref()));
        let ((Some(plain), Some(by_colour)), true) = (widths, (0..3).all(whole)) else {
            continue;
        };
        places += 1;
        if plain > sums[0].max {
            worst = uv;
        }
        for (sum, width) in sums.iter_mut().zip([plain, by_colour]) {
            sum.mean += width;
            sum.max = sum.max.max(width);
        }
    }
    let [one_map, by_colour] = sums.map(|sum| match places {
        0 => FringeWidth { mean: f64::NAN, max: f64::NAN },
        n => FringeWidth { mean: sum.mean / n as f64, ..sum },
    });
    let close_ups = close_ups(setup, &setup.by_colour(), style, worst)?;
    let resolution = setups[0].resolution;
    Ok(Fringes { one_map, by_colour, places, resolution, close_ups })
}

/// Image points on the lines of a lattice, each with the axis that runs across its line.
fn on_lines(style: &LatticeStyle) -> impl Iterator<Item = ([f64; 2], usize)> {
    let lines = style.lines_at();
    let steps = PLACES * (style.lines - 1);
    let (first, last) = (style.margin, 1.0 - style.margin);
    lines.into_iter().flat_map(move |line| {
        (0..=steps).flat_map(move |k| {
            let along = first + (last - first) * k as f64 / steps as f64;
            [([line, along], 0), ([along, line], 1)]
        })
    })
}

/// A white lattice seen in its three colours, about an image point, on the part of the display that is seen there: with the
/// display's own pixels, so that what looks blurred or coloured is so on the display.
fn close_ups(
    main: &Setup,
    setups: &[Setup; 3],
    style: &LatticeStyle,
    about: [f64; 2],
) -> Result<[Picture; 2], ProofError> {
    let style = LatticeStyle { line: [1.0; 4], ground: [0.0, 0.0, 0.0, 1.0], ..style.clone() };
    let drawn = {
        // Twice as fine as the display, whose pixels average over exact shares of the lines' edges.
        let side = (2 * main.resolution[0].max(main.resolution[1])).clamp(DRAWN[0], DRAWN[1]);
        draw_lattice(side, side, &style)?
    };
    let half = 0.5 * CLOSE_UP_SHARE;
    let middle = main.image.point(about.map(|c| c.clamp(half, 1.0 - half)));
    // What a ray meets does not depend on the image: a smaller one is a closer look.
    let closer = |setup: &Setup| {
        let mut closer = setup.clone();
        closer.image.frame.origin = middle;
        closer.image.size = closer.image.size.map(|side| side * CLOSE_UP_SHARE);
        closer
    };
    let [width, height] = closer(main).view_size(CLOSE_UP);
    let sights = setups.each_ref().map(|setup| {
        let closer = closer(setup);
        let camera = Camera::at_viewpoint(&closer, [width, height]);
        ViewSamples::of(&camera.rays(&closer), &|_| {})
    });
    let part = Part::seen(main.resolution, sights.iter().flat_map(ViewSamples::st));
    let map = |setup: &Setup| invert(&part.of(setup), Accuracy::default()).0;
    let (one, three) = (map(main), setups.each_ref().map(map));
    let displays = [display_image(&drawn, &one), display_image_by_colour(&drawn, three.each_ref())];
    let mut views = [0, 1].map(|_| Picture::filled(width, height, [0.0, 0.0, 0.0, 1.0]));
    for (c, samples) in sights.into_iter().enumerate() {
        let samples = samples.map(|st| part.place(st));
        for (view, display) in views.iter_mut().zip(&displays) {
            let seen = view_through(&samples, display)?;
            let pixels = view.pixels.iter_mut().zip(&seen.pixels);
            pixels.for_each(|(pixel, seen)| pixel[c] = seen[c]);
        }
    }
    Ok(views)
}

/// Whole pixels of a display: columns and rows (from below) `from .. to`.
struct Part {
    whole: [usize; 2],
    from: [usize; 2],
    to: [usize; 2],
}

impl Part {
    /// The pixels about these display points and a few beside them.
    fn seen<'a>(whole: [usize; 2], points: impl Iterator<Item = &'a [f64; 2]>) -> Self {
        let none = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        let (low, high) = points.filter(|st| on_display(**st)).fold(none, |(low, high), st| {
            ([low[0].min(st[0]), low[1].min(st[1])], [high[0].max(st[0]), high[1].max(st[1])])
        });
        let pixel = |axis: usize, at: f64, aside: f64| {
            let place = at * whole[axis] as f64 + aside;
            place.clamp(0.0, whole[axis] as f64)
        };
        // Filters reach two pixels; where nothing is seen, one pixel is as good as any.
        let from = [0, 1]
            .map(|axis| (pixel(axis, low[axis].min(0.5), -3.0) as usize).min(whole[axis] - 1));
        let to = [0, 1].map(|axis| (pixel(axis, high[axis], 4.0) as usize).max(from[axis] + 1));
        Self { whole, from, to }
    }

    /// The set-up with this part of its display alone.
    fn of(&self, setup: &Setup) -> Setup {
        let share = |axis: usize, pixel: f64| pixel / self.whole[axis] as f64;
        let middle = [0, 1].map(|a| share(a, 0.5 * (self.from[a] + self.to[a]) as f64));
        let pixels = [0, 1].map(|axis| self.to[axis] - self.from[axis]);
        let mut part = setup.with_resolution(pixels);
        part.display.frame.origin = setup.display.point(middle);
        part.display.size =
            [0, 1].map(|axis| setup.display.size[axis] * share(axis, pixels[axis] as f64));
        part
    }

    /// A point of the whole display on this part.
    fn place(&self, st: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|axis| {
            let (from, to) = (self.from[axis] as f64, self.to[axis] as f64);
            (st[axis] * self.whole[axis] as f64 - from) / (to - from)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::transport::bench_setup::setup;

    /// A part's pixels are the display's own: the same points in the world.
    #[test]
    fn a_part_of_a_display_has_its_pixels() {
        let whole = setup(20.0, vec![]).with_resolution([40, 50]);
        let points = [[0.2, 0.5], [0.31, 0.62], [f64::NAN; 2], [1.4, 0.2]];
        let part = Part::seen(whole.resolution, points.iter());
        // 0.2 and 0.31 of 40, 0.5 and 0.62 of 50, with three pixels more on each side.
        assert_eq!((part.from, part.to), ([5, 22], [16, 35]));
        let cropped = part.of(&whole);
        assert_eq!(cropped.resolution, [11, 13]);
        for st in &points[..2] {
            let (a, b) = (whole.display.point(*st), cropped.display.point(part.place(*st)));
            assert!((a - b).length() < 1e-12, "{a:?} {b:?}");
        }
        let nothing = Part::seen([40, 50], [[f64::NAN; 2]].iter());
        assert!((0..2).all(|axis| nothing.from[axis] < nothing.to[axis]));
    }
}
