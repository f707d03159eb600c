//! The image side of the map: which image points can be formed, and why the others cannot.

use super::{Map, Status, pixel_at, pixel_centre};
use crate::transport::{End, Setup, on_display};
use std::collections::HashMap;

/// What becomes of an image point.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ImagePoint {
    /// The viewer sees it where it belongs.
    Formed,
    /// Its display pixel is seen at other image points as well (a caustic).
    Folded,
    /// Its path ends by total internal reflection in this element.
    TotalReflection(u16),
    /// Its path ends at this element, which is opaque.
    Stopped(u16),
    /// Its path goes past the plate.
    MissedPlate,
    /// Its path meets the plate from behind.
    PlateBehind,
    /// Its path goes past the display's edge, or away from its front.
    MissedDisplay,
    /// Its path has more interactions than the scene allows.
    TooManyInteractions,
}

/// What becomes of the image's points, and what display they ask for.
#[derive(Clone, Debug, PartialEq)]
pub struct Formation {
    /// Points in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Row-major, the image's top row first.
    pub points: Vec<ImagePoint>,
    /// The part of the display's plane, lower left and upper right in st, that all points whose light gets through the
    /// plate together ask for: within \[0, 1\], the display is large enough. `None` if there are none.
    pub wanted: Option<[[f64; 2]; 2]>,
}

/// Follows the path of each image point of a `width` x `height` grid. `map` is the set-up's: it knows what folds.
pub fn formation(setup: &Setup, map: &Map, [width, height]: [usize; 2]) -> Formation {
    let centre = |index| pixel_centre(index % width, index / width, width, height);
    let followed = setup.each_end(width * height, centre, (ImagePoint::Formed, None), |end| {
        let through = match end {
            End::Display { st, through_plate: true } => Some(st),
            _ => None,
        };
        (classify(end, map), through)
    });
    let wanted = reach(followed.iter().filter_map(|(_, st)| *st));
    let points = followed.into_iter().map(|(point, _)| point).collect();
    Formation { width, height, points, wanted }
}

/// The least and the largest of each coordinate; `None` of no points.
pub(crate) fn reach(points: impl Iterator<Item = [f64; 2]>) -> Option<[[f64; 2]; 2]> {
    points.fold(None, |reach: Option<[[f64; 2]; 2]>, point| {
        let [low, high] = reach.unwrap_or([point; 2]);
        Some([
            [low[0].min(point[0]), low[1].min(point[1])],
            [high[0].max(point[0]), high[1].max(point[1])],
        ])
    })
}

impl Formation {
    /// Which share of the points each fate has that any of them has.
    pub fn shares(&self) -> HashMap<ImagePoint, f64> {
        let mut counts: HashMap<ImagePoint, usize> = HashMap::new();
        self.points.iter().for_each(|&point| *counts.entry(point).or_default() += 1);
        let all = self.points.len().max(1) as f64;
        counts.into_iter().map(|(point, count)| (point, count as f64 / all)).collect()
    }

    /// The share that is formed.
    pub fn formed(&self) -> f64 {
        self.shares().get(&ImagePoint::Formed).copied().unwrap_or(0.0)
    }
}

pub(super) fn classify(end: End, map: &Map) -> ImagePoint {
    match end {
        End::Display { through_plate: false, .. } | End::MissedPlate => ImagePoint::MissedPlate,
        End::Display { st, .. } if !on_display(st) => ImagePoint::MissedDisplay,
        End::Display { st, .. } => {
            let (x, y) = pixel_at(st, map.width, map.height);
            match map.status[y * map.width + x] {
                Status::Folded => ImagePoint::Folded,
                _ => ImagePoint::Formed,
            }
        }
        End::TotalReflection { element } => ImagePoint::TotalReflection(element),
        End::Stopped { element } => ImagePoint::Stopped(element),
        End::PlateBehind => ImagePoint::PlateBehind,
        End::MissedDisplay => ImagePoint::MissedDisplay,
        End::TooManyInteractions => ImagePoint::TooManyInteractions,
    }
}
