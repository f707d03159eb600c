//! What an evaluation takes for granted, and where it differs from the paper, in words.

use super::subjects::Subjects;
use super::{Arguments, PlateKind};
use midair::evaluate::paper::Settings;
use midair::optics::plate::{Model, SlitMirror};

/// Every assumption, in words.
pub fn assumptions(
    arguments: &Arguments,
    subjects: &Subjects,
    settings: &Settings,
    exposures: &[f64],
) -> Vec<String> {
    let plate = match &subjects.plate {
        Model::Ideal => {
            "The plate is ideal: plane symmetry, without blur, loss or stray light.".to_owned()
        }
        Model::SlitMirror(_) | Model::Measured(_) if !arguments.paper => {
            "The plate is the scene's, two layers of slit mirrors. Stray light and what is seen through the plate are in the views.".to_owned()
        }
        Model::SlitMirror(_) | Model::Measured(_) => {
            let SlitMirror { pitch, layer_depth, ior, reflectance, cover_glass, .. } =
                SlitMirror::default();
            format!(
                "The plate has two layers of slit mirrors at 45 degrees to its edges: pitch {pitch} mm, depth {layer_depth} mm each, glass of index {ior}, mirrors that reflect {:.0} %, cover glass {cover_glass} mm on either side: what is in use for an ASKA3D-like plate (Kiuchi and Koizumi 2021) at the paper's thickness of 4 mm. Stray light and what is seen through the plate are in the views.",
                100.0 * reflectance[0]
            )
        }
    };
    let least = exposures.iter().copied().fold(f64::INFINITY, f64::min);
    let most = exposures.iter().copied().fold(0.0, f64::max);
    if !arguments.paper {
        return of_own_scene(plate, settings, [least, most]);
    }
    vec![
        plate,
        format!("{} paths go through each pixel ({} for the lattice), with Fresnel's reflections and every refraction on the way.", settings.samples_per_pixel, settings.shape_samples_per_pixel),
        "Camera distance: the cube is seen from 3.3 m, the cylinder from 0.8 m, the bent mirrors from 1 m and 30 degrees above the horizon; the paper gives none of them. The compensation is for the same place.".to_owned(),
        format!("Aperture: the camera's pupil is {} mm wide, and the image's plane is in focus.", settings.aperture),
        format!("Crop: photographs are cropped about their middle to the image's 3 : 2, and views show the image's rectangle and nothing else, {} pixels wide. All of the view is compared, also where nothing can be formed.", settings.quality_width),
        format!("Exposure: the light of all three views of a photograph is multiplied by the factor that makes the reference as bright on average as the photograph ({least:.2} to {most:.2} here), as by a camera set once; what is brighter than white is clipped."),
        "The reference is the view through the same plate without the object: a bent mirror is replaced by a flat one at its crest or bottom, for without a mirror nothing would be seen from there.".to_owned(),
        "Maps know that the slit-mirror plate's two layers stand one behind the other: what the display shows for the reference is where this plate, without the object, shows the photograph in its place. Without compensation it shows the same with the object there. With compensation it is as large as the whole image needs, which is larger than the scene files' for the cube.".to_owned(),
        format!("Figure 7: the camera goes round the vertical through the image's centre and looks at it. Displacement is told in pixels of a camera that pictures a millimetre at the image as {} pixels: the paper gives the sensor (6000 x 4000) and no lens; its 78.87 pixels for the cube fit that scale. It is calculated by the transport from the eye to the display, over the intersections that are formed from every azimuth, and measured between intersections detected in rendered views ({} pixels a side, {} of the image's width), without aligning them, over those that were found under every condition at every azimuth at which any was. An intersection in a view has its name from where it is calculated to be, to a third of the way to the next one. The lattice fills the middle 80 % of the image, its lines go on to the image's border and are {} of the image wide. Only the light of the mid-air image is in these views: with stray light, stray images lay across the bent mirrors' lattices and hid their lines. Where none are found, the lattice is torn or folded there (the cube seen through two of its faces, the bent mirrors' outer corners from the side) or too dark; the calculated displacement needs no view.", settings.pixels_per_mm, settings.shape_size, settings.shape_window, settings.line_width),
        "“Compensated” is computed anew for each azimuth; “for 0° only” keeps what compensates for the middle one. The paper does not say which of them its figure shows.".to_owned(),
        "The bent mirror's facing is not given: both are here, each beside the paper's one figure.".to_owned(),
        "SSIM after Wang et al. 2004 (11 x 11 Gaussian, sigma 1.5), the mean over the three sRGB-encoded channels; LPIPS v0.1 with AlexNet.".to_owned(),
    ]
}

/// What is taken for granted of a scene of one's own.
fn of_own_scene(plate: String, settings: &Settings, [least, most]: [f64; 2]) -> Vec<String> {
    vec![
        plate,
        format!("{} paths go through each pixel ({} for the lattice), with Fresnel's reflections and every refraction on the way.", settings.samples_per_pixel, settings.shape_samples_per_pixel),
        format!("The camera is at the scene's viewpoint; its pupil is {} mm wide, and the image's plane is in focus. For the lattice it goes round the vertical through the image's centre and looks at it.", settings.aperture),
        format!("Photographs are cropped about their middle to the image's proportions, and views show the image's rectangle and nothing else, {} pixels wide. All of the view is compared, also where nothing can be formed.", settings.quality_width),
        format!("The light of all three views of a photograph is multiplied by the factor that makes the reference as bright on average as the photograph ({least:.2} to {most:.2} here), as by a camera set once; what is brighter than white is clipped."),
        "The reference is the view through the same plate without the object; a bent mirror is replaced by a flat one in its place.".to_owned(),
        "The display is as large as the whole image needs, where it belongs without the object: larger than the scene's, if the scene's is too small.".to_owned(),
        format!("Displacement is told in pixels of a camera that pictures a millimetre at the image as {} pixels. It is calculated by the transport from the eye to the display, over the intersections that are formed from every azimuth, and measured between intersections detected in rendered views, over those that were found under every condition at every azimuth at which any was.", settings.pixels_per_mm),
        "“Compensated” is computed anew for each azimuth; “for 0° only” keeps what compensates for the scene's viewpoint.".to_owned(),
        "SSIM after Wang et al. 2004 (11 x 11 Gaussian, sigma 1.5), the mean over the three sRGB-encoded channels; LPIPS v0.1 with AlexNet.".to_owned(),
    ]
}

/// Where ours differ from the paper's, and why.
pub fn differences(arguments: &Arguments) -> Vec<String> {
    if !arguments.paper {
        return Vec::new();
    }
    let mut differences = vec![
        "The paper's displacements were measured on photographs of a real set-up; ours are simulated, where everything stands exactly. Conjecture, not tested: errors of placing and, if it kept one compensation for all azimuths, the camera's motion make up its 23.91 and 30.53 pixels with compensation.".to_owned(),
        "The paper states neither its renderer's paths through a pixel nor its camera's pupil, and SSIM depends on both. Paths: \"noise alone\" tells what they take off here. The pupil: a pinhole (--aperture 0) sees the plate's slits, which the paper names as a cause of its low figures, and through the cylinder it gives about theirs (0.19 and 0.18 with and without compensation in views of 384 pixels, 0.10 and 0.10 in views of 768; the paper has 0.16 and 0.13). It does not explain the bent mirrors'.".to_owned(),
        "How much an uncompensated view suffers depends on the image's size and place and on the camera's distance, which the paper does not give. Whether that accounts for the differences without compensation was not tested.".to_owned(),
        "Its photographs are those of LIVE1, all 29; these are the ones in the folder that was named.".to_owned(),
    ];
    if arguments.plate == Some(PlateKind::Ideal) {
        differences.push("The plate here is ideal, the paper's was not: this tells what the geometry alone does.".to_owned());
    }
    differences
}
