//! The display image whose view comes nearest to what would be seen with no object in the way.

use super::{Compensation, Solved};
use crate::map::Map;
use crate::picture::optimal::{OptimalError, Weighting, optimal_display, view_through};
use crate::picture::{Picture, display_image};
use crate::simulate::{Camera, Reference};

impl Compensation {
    /// The light whose view, of as many pixels as the display has, comes nearest to the picture seen with no object in the way; sought from
    /// an initial one (that of [`light`](Self::light)).
    ///
    /// Both pictures are taken over, and rays are traced as they are asked for, so that a megapixel takes little memory.
    ///
    /// # Errors
    /// [`OptimalError`] where the display has no pixels.
    pub fn best_light(&self, picture: Picture, initial: Picture) -> Result<Picture, OptimalError> {
        let setup = self.setup();
        let [width, height] = setup.resolution;
        let camera = Camera::at_viewpoint(setup, setup.view_size(width));
        // Without elements there is no dispersion: one target for all colours.
        let unbent = display_image(&picture, &Map::identity(width, height));
        drop(picture);
        let target = view_through(&Reference::new(setup, &camera), &unbent)?;
        drop(unbent);
        let best_for = |solved: &Solved, target: Picture, initial: Picture| {
            let rays = camera.rays(&solved.setup);
            optimal_display(&rays, target, initial, Weighting::default()).map(|best| best.display)
        };
        if !self.is_by_colour() {
            return best_for(self.main(), target, initial);
        }
        let mut best = initial.clone();
        for (c, solved) in self.solved().iter().enumerate() {
            let one = best_for(solved, target.clone(), initial.clone())?;
            best.pixels.iter_mut().zip(&one.pixels).for_each(|(pixel, one)| pixel[c] = one[c]);
        }
        Ok(best)
    }
}
