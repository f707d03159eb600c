//! The display image whose views come nearest to what would be seen with no object in the way.

use super::{Compensation, Solved};
use crate::map::{ImagePoint, Map, formation};
use crate::picture::optimal::{EYES, Optimal, OptimalError, Weighting, optimal_display};
use crate::picture::{Picture, display_image};
use crate::simulate::Camera;
use crate::transport::Setup;

/// Image points along a side that tell how much of the image is formed.
const PROBES: usize = 64;
/// Of an image of which less is formed, no more pixels are looked at than if this share were.
const LEAST_FORMED: f64 = 0.25;

/// The view of the finest of the [`EYES`]: twice as fine as the display, along a side and on the average, where the image is seen of it.
pub(crate) fn finest_eye(setup: &Setup, map: &Map) -> Camera {
    let counts = map.counts();
    let seen = (counts.ok + counts.folded) as f64;
    let points = formation(setup, map, [PROBES; 2]).points;
    let formed = points
        .iter()
        .filter(|point| matches!(point, ImagePoint::Formed | ImagePoint::Folded))
        .count();
    let formed = (formed as f64 / points.len() as f64).max(LEAST_FORMED);
    let [width, height] = setup.image.size;
    let side = |length: f64, other: f64| {
        let as_fine = (seen / formed * length / other).sqrt().round() as usize;
        (EYES[1] * as_fine).max(2 * EYES[2])
    };
    Camera::at_viewpoint(setup, [side(width, height), side(height, width)])
}

/// The best display image for an eye: see [`optimal_display`]. With no object in the way, and a display that is drawn for that, an image point is seen where it
/// belongs: the target is the picture itself.
pub(crate) fn best_display(
    setup: &Setup,
    finest: &Camera,
    target: Picture,
    initial: Picture,
) -> Result<Optimal, OptimalError> {
    optimal_display(&finest.rays(setup), target, initial, Weighting::default())
}

/// The picture as the finest eye would see it with no object in the way.
pub(crate) fn best_target(picture: &Picture, finest: &Camera) -> Picture {
    let [width, height] = finest.size;
    display_image(picture, &Map::identity(width, height))
}

impl Compensation {
    /// The light whose views come nearest to the picture seen with no object in the way, for eyes twice as fine as the display, as fine and half as
    /// fine; sought from an initial one (that of [`light`](Self::light)).
    ///
    /// Both pictures are taken over, and rays are traced as they are asked for, so that a megapixel takes little memory.
    ///
    /// # Errors
    /// [`OptimalError`] where the display has no pixels.
    pub fn best_light(&self, picture: Picture, initial: Picture) -> Result<Picture, OptimalError> {
        let finest = finest_eye(self.setup(), self.map());
        // Without elements there is no dispersion: one target for all colours.
        let target = best_target(&picture, &finest);
        drop(picture);
        let best_for = |solved: &Solved, target: Picture, initial: Picture| {
            best_display(&solved.setup, &finest, target, initial).map(|best| best.display)
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
