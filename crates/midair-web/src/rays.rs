//! Rays of light, and what becomes of them.

use midair::transport::{End, Setup};
use wasm_bindgen::prelude::*;

/// Ways from the eye through the image.
#[wasm_bindgen]
pub struct Rays {
    ends: Vec<f32>,
    fates: Vec<u8>,
}

#[wasm_bindgen]
impl Rays {
    /// The pieces' two ends each, x, y and z, mm.
    pub fn ends(&mut self) -> Vec<f32> {
        std::mem::take(&mut self.ends)
    }

    /// What becomes of the ray that a piece is of: 0 it lights the image, 1 it ends by total reflection, 2 it goes past the plate, 3 past the
    /// display, 4 something opaque is in the way, 5 it meets the plate from behind or has too many interactions.
    pub fn fates(&mut self) -> Vec<u8> {
        std::mem::take(&mut self.fates)
    }
}

/// What a ray that ends nowhere is drawn on by, as a share of its way so far.
const ON: f64 = 0.12;

impl Rays {
    /// Of `count` x `count` image points.
    pub(crate) fn of(setup: &Setup, count: usize) -> Self {
        let mut rays = Self { ends: Vec::new(), fates: Vec::new() };
        let place = |index: usize| match count {
            1 => 0.5,
            _ => index as f64 / (count - 1) as f64,
        };
        for index in 0..count * count {
            let course = setup.course(setup.ray([place(index % count), place(index / count)]));
            let mut points = course.points;
            let on_display = matches!(course.end, End::Display { .. });
            if let (false, Some(&last), Some(&direction)) =
                (on_display, points.last(), course.directions.last())
            {
                let way = (last - setup.viewpoint).length().max(setup.image.size[0]);
                points.push(last + direction * (ON * way));
            }
            let fate = fate(course.end);
            for pair in points.windows(2).filter(|pair| pair.iter().all(|p| p.is_finite())) {
                rays.ends.extend(pair.iter().flat_map(|p| p.to_array()).map(|c| c as f32));
                rays.fates.push(fate);
            }
        }
        rays
    }
}

fn fate(end: End) -> u8 {
    match end {
        _ if end.formed().is_some() => 0,
        End::TotalReflection { .. } => 1,
        End::Display { through_plate: false, .. } | End::MissedPlate => 2,
        End::Display { .. } | End::MissedDisplay => 3,
        End::Stopped { .. } => 4,
        End::PlateBehind | End::TooManyInteractions => 5,
    }
}
