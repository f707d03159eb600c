//! Where the viewer looks from, and what part of space the view shows.

use crate::Error;
use crate::geometry::{Ray, Vec3};
use crate::picture::check_size;
use crate::picture::optimal::ViewRays;
use crate::transport::{Packets, Setup};
use std::ops::Range;

/// Rays that one view may have: what they hold in memory grows to 50 bytes each.
const MOST_RAYS: usize = 1 << 26;

/// Refuses a view that would not fit into memory: so many pixels (width, height), and rays along each side of a pixel.
///
/// # Errors
/// What is too large, and what is possible.
pub fn check_view(size: [usize; 2], supersampling: usize) -> Result<(), Error> {
    check_size(size)?;
    let [width, height] = size;
    let rays = (width as u128) * (height as u128) * (supersampling as u128).pow(2);
    if rays > MOST_RAYS as u128 {
        return Err(Error::request(
            format!(
                "a view of {width} x {height} pixels with {supersampling} x {supersampling} rays each is too large"
            ),
            format!(
                "ask for at most {MOST_RAYS} rays in all: a smaller size or less supersampling"
            ),
        ));
    }
    Ok(())
}

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

    /// The rays through the view's pixels, as they go in a set-up.
    pub fn rays<'a>(&'a self, setup: &'a Setup) -> Sight<'a> {
        Sight { camera: self, setup }
    }

    /// The position in the view of a ray: the `sub`th of a pixel.
    fn position(&self, pixel: usize, sub: usize) -> [f64; 2] {
        let n = self.supersampling;
        let offset = |k: usize| (k as f64 + 0.5) / n as f64;
        let (column, row) = (pixel % self.size[0], pixel / self.size[0]);
        [column as f64 + offset(sub % n), row as f64 + offset(sub / n)]
    }
}

/// A camera's rays through a set-up.
#[derive(Clone, Copy, Debug)]
pub struct Sight<'a> {
    camera: &'a Camera,
    setup: &'a Setup,
}

impl Sight<'_> {
    /// The image point uv that a ray looks at: the `sub`th of those through a pixel (row by row from the top left).
    pub fn image_point(&self, pixel: usize, sub: usize) -> [f64; 2] {
        let [column, row] = self.camera.position(pixel, sub);
        self.camera.image_point(column, row)
    }
}

impl ViewRays for Sight<'_> {
    fn size(&self) -> [usize; 2] {
        self.camera.size
    }

    fn rays_per_pixel(&self) -> usize {
        self.camera.supersampling.pow(2)
    }

    fn ends(&self, pixels: Range<usize>, ends: &mut [[f64; 2]]) {
        let rays = self.rays_per_pixel();
        let uv: Vec<[f64; 2]> = pixels
            .flat_map(|pixel| (0..rays).map(move |sub| (pixel, sub)))
            .map(|(pixel, sub)| self.image_point(pixel, sub))
            .collect();
        let mut packets = Packets::new(self.setup, self.camera.eye);
        packets.ends(&uv, |i, end| ends[i] = end.formed().unwrap_or([f64::NAN; 2]));
    }
}
