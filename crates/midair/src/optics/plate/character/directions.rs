//! Shares of light over incidence and azimuth.

use crate::geometry::Vec3;
use crate::optics::plate::{Shares, SlitMirrorPlate};

/// [`Shares`] over a grid of directions.
#[derive(Clone, Debug, PartialEq)]
pub struct Directions {
    /// Angles of incidence, degrees.
    pub incidence: Vec<f64>,
    /// Azimuths of the light's component along the plate, degrees from the plate's +x.
    pub azimuth: Vec<f64>,
    /// One row of incidences for each azimuth.
    pub shares: Vec<Shares>,
}

impl Directions {
    /// The shares at the i-th incidence and the j-th azimuth.
    pub fn at(&self, i: usize, j: usize) -> &Shares {
        &self.shares[j * self.incidence.len() + i]
    }
}

/// What a plate makes of light from every incidence (0 to 90 degrees) and azimuth.
pub fn over_directions(plate: &SlitMirrorPlate, incidence: &[f64], azimuth: &[f64]) -> Directions {
    let shares = azimuth.iter().flat_map(|&a| incidence.iter().map(move |&i| direction(i, a)));
    Directions {
        incidence: incidence.to_vec(),
        azimuth: azimuth.to_vec(),
        shares: shares.map(|d| plate.shares(d)).collect(),
    }
}

fn direction(incidence: f64, azimuth: f64) -> Vec3 {
    let (si, ci) = incidence.to_radians().sin_cos();
    let (sa, ca) = azimuth.to_radians().sin_cos();
    Vec3::new(si * ca, si * sa, ci)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::optics::plate::SlitMirror;

    #[test]
    fn character_repeats_every_quarter_turn_and_hides_in_the_mirrors_plane() {
        let plate = SlitMirrorPlate::new(SlitMirror::default()).unwrap();
        let incidence: Vec<f64> = (0..=18).map(|i| 5.0 * f64::from(i)).collect();
        let azimuth: Vec<f64> = (0..=8).map(|i| 45.0 * f64::from(i)).collect();
        let map = over_directions(&plate, &incidence, &azimuth);
        assert_eq!(map.shares.len(), 19 * 9);
        for i in 0..19 {
            for j in 0..7 {
                // Two crossed layers look the same after a quarter turn.
                let (a, b) = (map.at(i, j), map.at(i, j + 2));
                assert!((a.real[0] - b.real[0]).abs() < 1e-12);
                assert!((a.stray[0] - b.stray[0]).abs() < 1e-12);
            }
            // Along one layer's mirrors light never meets them: no mid-air image.
            assert!(map.at(i, 1).real[0] < 1e-12);
            // Along +x both layers meet alike: the published table is on this row.
            let d = direction(incidence[i], 0.0);
            assert_eq!(map.at(i, 0), &plate.shares(d));
            assert!((d.z - incidence[i].to_radians().cos()).abs() < 1e-15);
        }
    }
}
