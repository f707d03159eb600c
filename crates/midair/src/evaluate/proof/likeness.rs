//! Likeness of a view to the reference, over the part of the image that is formed.

use crate::map::{Formation, ImagePoint};
use crate::measure::{Plane, SimilarityError, Standard, psnr};
use crate::picture::Picture;

/// How like the reference a view is, over a [`Region`]; sRGB-encoded values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Likeness {
    /// Structural similarity, the mean over the three colour channels.
    pub ssim: f64,
    /// Peak signal-to-noise ratio, dB.
    pub psnr: f64,
}

/// The view pixels that are compared: those whose whole 11 x 11 window, SSIM's, lies in the view and is formed.
#[derive(Clone, Debug, PartialEq)]
pub struct Region {
    /// For each view pixel, row by row from the top, whether it is compared.
    pub pixels: Vec<bool>,
    /// Their share of all view pixels.
    pub share: f64,
}

/// The channels of what views are compared with.
pub(super) struct Channels([Standard; 3]);

/// SSIM's window reaches so far from its pixel.
const REACH: usize = 5;

impl Region {
    /// The region of a formation that was taken at the view's pixels.
    pub fn of(formation: &Formation) -> Self {
        let (width, height) = (formation.width, formation.height);
        // Sums of unformed points over all rectangles from the top left corner, so that any window's is four of them.
        let mut sums = vec![0usize; (width + 1) * (height + 1)];
        for row in 0..height {
            let mut line = 0;
            for column in 0..width {
                line += usize::from(formation.points[row * width + column] != ImagePoint::Formed);
                sums[(row + 1) * (width + 1) + column + 1] =
                    sums[row * (width + 1) + column + 1] + line;
            }
        }
        let at = |column: usize, row: usize| sums[row * (width + 1) + column];
        let mut pixels = vec![false; width * height];
        for row in REACH..height.saturating_sub(REACH) {
            for column in REACH..width.saturating_sub(REACH) {
                let (x0, x1) = (column - REACH, column + REACH + 1);
                let (y0, y1) = (row - REACH, row + REACH + 1);
                pixels[row * width + column] = at(x1, y1) + at(x0, y0) == at(x0, y1) + at(x1, y0);
            }
        }
        let count = pixels.iter().filter(|&&compared| compared).count();
        Self { share: count as f64 / pixels.len().max(1) as f64, pixels }
    }

    /// The reference made ready for comparisons; `None` where the region is empty.
    ///
    /// # Errors
    /// Where a value of the reference is not finite.
    pub(super) fn standard(
        &self,
        reference: &Picture,
    ) -> Result<Option<Channels>, SimilarityError> {
        if !self.pixels.contains(&true) {
            return Ok(None);
        }
        let [red, green, blue] = Plane::channels(reference);
        let channels = [Standard::new(red)?, Standard::new(green)?, Standard::new(blue)?];
        Ok(Some(Channels(channels)))
    }

    /// Compares a view with the reference.
    ///
    /// # Errors
    /// When the views' sizes differ from one another.
    pub(super) fn likeness(
        &self,
        view: &Picture,
        reference: &Channels,
    ) -> Result<Likeness, SimilarityError> {
        let views = Plane::channels(view);
        let mut similarity = 0.0;
        for (view, reference) in views.iter().zip(&reference.0) {
            let map = reference.ssim(view)?.map;
            let values = self.compared(&map);
            similarity += values.iter().map(|&v| f64::from(v)).sum::<f64>() / values.len() as f64;
        }
        // PSNR does not know where a pixel is: those compared, in one long row.
        let row = |plane: &Plane| {
            let values = self.compared(plane);
            Plane { width: values.len(), height: 1, values }
        };
        let references = reference.0.each_ref().map(|channel| row(channel.plane()));
        let psnr = psnr(&views.each_ref().map(row), &references)?;
        Ok(Likeness { ssim: similarity / 3.0, psnr })
    }

    fn compared(&self, plane: &Plane) -> Vec<f32> {
        let values = plane.values.iter().zip(&self.pixels);
        values.filter(|(_, compared)| **compared).map(|(&value, _)| value).collect()
    }
}
