//! Where the viewer looks from, and what part of space the view shows.

use crate::geometry::{Ray, Vec3};
use crate::media::optimal::ViewSamples;
use crate::transport::{Path, Setup};
use rayon::prelude::*;

/// A pinhole that looks at the image: its picture is what would be seen in the image's plane, so that a
/// view pixel is an image point whatever the eye's position, and views from everywhere compare pixel by pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// The eye, mm.
    pub eye: Vec3,
    /// Width and height of the view in pixels.
    pub size: [usize; 2],
    /// How much of the image's plane is shown: 1 is the image exactly, 1.5 half as much again around it.
    pub window: f64,
    /// Rays through each pixel along each side.
    pub supersampling: usize,
}

impl Camera {
    /// The viewpoint that the set-up is compensated for, looking at exactly the image.
    pub fn at_viewpoint(setup: &Setup, size: [usize; 2]) -> Self {
        Self { eye: setup.viewpoint, size, window: 1.0, supersampling: 2 }
    }

    /// Image coordinates uv at a position of the view: columns and rows from its top-left corner, in pixels.
    pub fn image_point(&self, column: f64, row: f64) -> [f64; 2] {
        [
            (column / self.size[0] as f64 - 0.5) * self.window + 0.5,
            (0.5 - row / self.size[1] as f64) * self.window + 0.5,
        ]
    }

    /// The position in the view (columns and rows from its top-left corner) of an image point.
    pub fn view_position(&self, uv: [f64; 2]) -> [f64; 2] {
        [
            ((uv[0] - 0.5) / self.window + 0.5) * self.size[0] as f64,
            (0.5 - (uv[1] - 0.5) / self.window) * self.size[1] as f64,
        ]
    }

    /// The ray from the eye through a position of the view.
    pub fn ray(&self, setup: &Setup, column: f64, row: f64) -> Ray {
        setup.ray_from(self.eye, self.image_point(column, row))
    }

    /// Where the rays through all view pixels end on the display.
    ///
    /// `progress` is called with the number of rows that are done.
    pub fn samples(&self, setup: &Setup, progress: &(dyn Fn(usize) + Sync)) -> ViewSamples {
        let [width, height] = self.size;
        let n = self.supersampling;
        let mut st = vec![[f64::NAN; 2]; width * height * n * n];
        st.par_chunks_mut(width * n * n).enumerate().for_each(|(row, line)| {
            let mut path = Path::new();
            for (index, st) in line.iter_mut().enumerate() {
                let (column, sub) = (index / (n * n), index % (n * n));
                let offset = |k: usize| (k as f64 + 0.5) / n as f64;
                let x = column as f64 + offset(sub % n);
                let y = row as f64 + offset(sub / n);
                if let Some(at) = setup.trace(self.ray(setup, x, y), &mut path).formed() {
                    *st = at;
                }
            }
            progress(1);
        });
        ViewSamples { width, height, samples_per_pixel: n * n, st }
    }
}
