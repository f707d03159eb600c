//! A proof for people: in a few lines, as a page, and what it rests on.

mod colour;
mod page;

pub use colour::{field_picture, pictures as colour_pictures};

use crate::{counts_line, percent};
use midair::evaluate::colour::Colour;
use midair::evaluate::proof::{Likeness, Proof, Shape, Shown};
use midair::scene::Loaded;
use midair::scene::model::PlateModel;
use midair::transport::{DESIGN_WAVELENGTH, Setup};

/// Everything that a report draws on.
pub struct Report<'a> {
    /// The scene.
    pub loaded: &'a Loaded,
    /// The same, ready for tracing.
    pub setup: &'a Setup,
    /// What was found.
    pub proof: &'a Proof,
    /// What was found of brightness and colour.
    pub colour: &'a Colour,
    /// What the user should know.
    pub notes: &'a [String],
}

impl Report<'_> {
    /// The ways to fill the display with their names, in the order of the table.
    fn ways(&self) -> Vec<(&'static str, String, &Shown)> {
        let named = |(key, shown): (&'static str, _)| {
            let name = match key {
                "uncompensated" => "shown as it is".to_owned(),
                "compensated" => "plain filter (what compensate writes)".to_owned(),
                "scattered" => "averaged scatter of the view's rays".to_owned(),
                "optimal" => "best display image (--optimal)".to_owned(),
                _ => {
                    let spp = self.proof.splat.as_ref().map_or(0, |splat| splat.spp);
                    format!("map by splat, {spp} samples a pixel")
                }
            };
            (key, name, shown)
        };
        self.proof.ways().into_iter().map(named).collect()
    }

    /// The summary for people.
    pub fn lines(&self) -> String {
        let Self { loaded, setup, proof, .. } = self;
        let [width, height] = setup.resolution;
        let mut lines = format!(
            "{}: {width} x {height} display pixels mapped in {:.1} ms, each ok one to {:.0e} pixels of a 1024-pixel image\n\
             {}\n{:34}{:>12}{:>12}{:>9}{:>12}\n",
            loaded.scene.name,
            proof.map_time.as_secs_f64() * 1e3,
            proof.map.error_bound * 1024.0,
            counts_line(&proof.map.counts()),
            "",
            "lattice off",
            "exactly",
            "SSIM",
            "PSNR",
        );
        for (key, name, shown) in self.ways() {
            let shape = match key {
                "uncompensated" => Some(&proof.lattice.uncompensated),
                "compensated" => Some(&proof.lattice.compensated),
                _ => None,
            };
            let pixels = |mean: Option<f64>| match mean {
                Some(mean) if mean.is_finite() => format!("{mean:.3} px"),
                _ => "-".to_owned(),
            };
            let measured = shape.and_then(|s| s.measured.as_ref().ok()).map(|d| d.mean);
            let exact = shape.map(|shape| shape.exact.mean);
            let (ssim, psnr) = likeness_text(shown.likeness);
            // The first words say enough here; the page has them all.
            let name = name.split(" (").next().unwrap_or_default();
            let columns = match shape {
                Some(_) => (pixels(measured), pixels(exact)),
                None => (String::new(), String::new()),
            };
            lines += &format!("  {name:32}{:>12}{:>12}{ssim:>9}{psnr:>12}\n", columns.0, columns.1);
        }
        for (name, shape) in [
            ("plain filter", &proof.lattice.compensated),
            ("shown as it is", &proof.lattice.uncompensated),
        ] {
            if let (Ok(measured), Some(there)) = (&shape.measured, &shape.exact_there)
                && measured.compared() < shape.exact.compared()
            {
                lines += &format!(
                    "{name}: measured on {} of {} formed intersections, which are exactly {:.3} px off\n",
                    measured.compared(),
                    shape.exact.compared(),
                    there.mean
                );
            }
        }
        if let Some(splat) = &proof.splat {
            lines += &format!(
                "the paper's method at {} samples a pixel: {:.1} s, {} holes in {} reached pixels, {:.3} pixels off (rms)\n",
                splat.spp,
                splat.time.as_secs_f64(),
                splat.holes,
                splat.reached,
                splat.rms_error * 1024.0,
            );
        }
        lines += &colour::lines(self.colour);
        lines
    }

    /// Every assumption, in words.
    pub fn assumptions(&self) -> Vec<String> {
        let Self { loaded, proof, .. } = self;
        let settings = &proof.settings;
        let plate = match loaded.scene.plate.model {
            PlateModel::Ideal => {
                "The plate is ideal: plane symmetry, without blur, loss or stray light."
            }
            PlateModel::SlitMirror(_) => {
                "Of the scene's slit-mirror plate the views follow the mean course of the light that forms the image, with a plane of symmetry for each layer, without blur, loss or stray light."
            }
        };
        let n = settings.supersampling;
        let reference = match proof.reference_completed {
            0.0 => String::new(),
            share => format!(
                " {} of it would go past the plate that stands where the object sends the light: there it is what a plate without edges would show.",
                percent(share)
            ),
        };
        vec![
            "The viewer is one pinhole eye at the scene's viewpoint; the view shows the image's rectangle and nothing else.".to_owned(),
            plate.to_owned(),
            "Light that surfaces reflect or absorb on its way (Fresnel, absorption, mirror reflectance) is not taken off, but for the white field under \"Brightness and colour\": views show geometry, not brightness.".to_owned(),
            format!("Refractive indices are those at {:.1} nm, but for the colour fringes.", DESIGN_WAVELENGTH * 1e3),
            format!("A view pixel is the mean of {} rays, each the bilinear interpolation of four display pixels, in linear light.", n * n),
            format!("The reference is the view without any object, the display where it then belongs, drawn for the plate alone and showing the picture at its own resolution.{reference}"),
            "Uncompensated, the display shows the picture in the image's true size where it belongs if mirrors are flat and solids absent (the other way round behind an odd number of mirrors), as far as the scene's display reaches there.".to_owned(),
            "Views are compared over the pixels whose whole 11 x 11 window is formed; sRGB-encoded, SSIM after Wang et al. 2004 as the mean over the three channels.".to_owned(),
            format!(
                "The lattice has {} x {} lines, {} of the image wide. Measured displacement is between intersections detected in the view and in the reference, in linear light, each named by the transport's prediction to a third of a step; the exact one is the map interpolated at F.",
                settings.lattice.lines, settings.lattice.lines, settings.lattice.line_width
            ),
            "The best display image is sought, and the scatter made, with the same rays that the views are then rendered with.".to_owned(),
            "Holes are pixels that have an answer (ok or folded) in the exact map and that no sample hit.".to_owned(),
        ]
    }
}

/// What the reader of a displacement should know: where the view does not tell what the transport does.
fn shape_notes(name: &str, shape: &Shape) -> Vec<String> {
    let mut notes = Vec::new();
    match (&shape.measured, &shape.exact_there) {
        (Err(why), _) => notes.push(format!(
            "The {name} view could not be measured as a photograph would be: {why}. The exact displacement counts."
        )),
        (Ok(measured), Some(there)) => {
            let (seen, formed) = (measured.compared(), shape.exact.compared());
            if seen < formed {
                notes.push(format!(
                    "In the {name} view {seen} of {formed} formed intersections could be measured: {:.3} px on average, exactly {:.3} px; over all {formed} it is exactly {:.3} px.",
                    measured.mean, there.mean, shape.exact.mean
                ));
            }
            // What blur by the display's pixels does to a line is a fraction of a pixel.
            if (measured.mean - there.mean).abs() > 0.5 + 0.01 * there.mean {
                notes.push(format!(
                    "The displacement measured on the {name} view is not the exact one of the same intersections, {:.3} px: the exact one counts.",
                    there.mean
                ));
            }
        }
        (Ok(_), None) => {}
    }
    if shape.left_out > 0 {
        notes.push(format!(
            "{} places in the {name} view where lines seem to cross lie next to no expected intersection, as beside an edge that cuts the lattice: they are left out.",
            shape.left_out
        ));
    }
    notes
}

/// SSIM and PSNR in words; a dash where nothing could be compared.
fn likeness_text(likeness: Option<Likeness>) -> (String, String) {
    match likeness {
        Some(likeness) => (format!("{:.4}", likeness.ssim), format!("{:.2} dB", likeness.psnr)),
        None => ("-".to_owned(), "-".to_owned()),
    }
}
