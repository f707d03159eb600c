//! Scenes to begin from: usual set-ups around a plate and a display that people have.

use super::devices::{DISPLAYS, DisplayDevice, PLATES};
use crate::geometry::Vec3;
use std::f64::consts::FRAC_1_SQRT_2;
use std::fmt::Write as _;
use std::path::PathBuf;

/// A set-up to begin from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Template {
    /// An image in an acrylic cube over a display that lies on the table.
    Cube,
    /// An image in a bottle of water.
    Bottle,
    /// An image standing on a bent mirror, a glossy table, the plate upright behind it.
    Mirror,
    /// An image in a mesh, such as a bunny.
    Bunny,
}

impl Template {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Cube, Self::Bottle, Self::Mirror, Self::Bunny];

    /// What it is called.
    pub fn name(self) -> &'static str {
        match self {
            Self::Cube => "cube",
            Self::Bottle => "bottle",
            Self::Mirror => "mirror",
            Self::Bunny => "bunny",
        }
    }

    /// What it is, in a few words.
    pub fn about(self) -> &'static str {
        match self {
            Self::Cube => "an image in an acrylic cube over a display that lies on the table",
            Self::Bottle => {
                "an image in a glass bottle of water, over a display that lies on the table"
            }
            Self::Mirror => "an image that stands on a bent mirror, the plate upright behind it",
            Self::Bunny => "an image in a solid from a mesh file, such as a bunny",
        }
    }
}

/// A mesh for [`Template::Bunny`].
#[derive(Clone, Debug, PartialEq)]
pub struct MeshFile {
    /// As the scene file is to name it.
    pub file: PathBuf,
    /// Least and largest x, y and z, in the file's unit.
    pub bounds: [Vec3; 2],
}

/// What is wished of a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Wishes {
    /// What is set up.
    pub template: Template,
    /// The scene's name.
    pub name: String,
    /// The plate's width and height, mm, and what it is called.
    pub plate: ([f64; 2], String),
    /// The display's pixels, its size in mm, and what it is called.
    pub display: ([usize; 2], [f64; 2], String),
    /// The object's size, mm: the cube's edge, the bottle's height, the mesh's height, the mirror's radius; `None`: as usual.
    pub object: Option<f64>,
    /// From the viewer's eye to the image, mm; `None`: as usual.
    pub eye: Option<f64>,
    /// The mesh, where the template needs one.
    pub mesh: Option<MeshFile>,
}

/// Why there is no such scene.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum TemplateError {
    /// The template needs a mesh file.
    #[error("the template \"bunny\" needs a mesh: no mesh is part of the program")]
    NoMesh,
    /// A length that no such set-up has.
    #[error("{what} of {value} mm is not possible here: give {least} to {most} mm")]
    Length {
        /// What has the length.
        what: &'static str,
        /// The length.
        value: f64,
        /// The least that is possible, mm.
        least: f64,
        /// The most, mm.
        most: f64,
    },
}

impl Wishes {
    /// The usual: the first plate and the first display of the lists.
    pub fn new(template: Template) -> Self {
        let (plate, display) = (&PLATES[0], &DISPLAYS[0]);
        Self {
            template,
            name: template.name().to_owned(),
            plate: (plate.size, plate.name.to_owned()),
            display: Self::display_of(display),
            object: None,
            eye: None,
            mesh: None,
        }
    }

    /// A display of the list, as [`Self::display`] wants it.
    pub fn display_of(device: &DisplayDevice) -> ([usize; 2], [f64; 2], String) {
        // To a hundredth of a millimetre: finer than any data sheet.
        let size = device.size().map(|side| (side * 100.0).round() / 100.0);
        (device.resolution, size, device.name.to_owned())
    }

    /// The scene file, in TOML, with comments that explain it.
    ///
    /// # Errors
    /// [`TemplateError`] where the wishes make no set-up.
    pub fn scene(&self) -> Result<String, TemplateError> {
        let eye = within("the viewer's distance", self.eye.unwrap_or(600.0), 250.0, 10_000.0)?;
        let object =
            |usual: f64, most: f64| within("an object", self.object.unwrap_or(usual), 15.0, most);
        // A quarter of the plate's shorter side: with the plate at 45 degrees the object then stands clear of it.
        let [plate_width, plate_height] = self.plate.0;
        let room = 0.5 * plate_width.min(plate_height);
        match self.template {
            Template::Cube => {
                let edge = object(50.0, room)?;
                // Seen through its front, half its edge before the image, the cube's sides leave this much of it.
                let side = tenth(0.6 * edge);
                let element = format!(
                    "# An acrylic cube; the image stands in its middle. rotation = [0.0, 15.0, 0.0] turns it by 15 degrees about the vertical.\n\
                     [[element]]\nname = \"cube\"\nshape = {{ kind = \"box\", size = [{edge:?}, {edge:?}, {edge:?}] }}\n\
                     position = [0.0, 0.0, 0.0]\nrotation = [0.0, 0.0, 0.0]\nmaterial = {{ glass = \"acrylic\" }}\n"
                );
                Ok(self.over_a_table(eye, [side, side], edge * FRAC_1_SQRT_2, &element))
            }
            Template::Bottle => {
                let height = object(120.0, 1.5 * room)?;
                // A bottle a third as wide as it is high, with 2 mm of glass.
                let radius = tenth(height / 6.0);
                let inner = tenth(radius - 2.0);
                let element = format!(
                    "# A bottle of glass with a wall of 2 mm, full of water but for its uppermost centimetre. For another form:\n\
                     # shape = {{ kind = \"lathe\", profile = [[radius, y], ...], smooth = true }}\n\
                     [[element]]\nname = \"bottle\"\nshape = {{ kind = \"cylinder\", radius = {radius:?}, height = {height:?} }}\n\
                     material = {{ glass = \"N-BK7\" }}\nwall = 2.0\nfill = {{ height = {:?}, glass = \"water\" }}\n",
                    tenth(height - 12.0),
                );
                let reach = (radius + 0.5 * height) * FRAC_1_SQRT_2;
                // Water magnifies sideways: a narrow image is wide in it.
                Ok(self.over_a_table(eye, [tenth(inner), tenth(1.5 * inner)], reach, &element))
            }
            Template::Bunny => {
                let mesh = self.mesh.as_ref().ok_or(TemplateError::NoMesh)?;
                let height = object(80.0, room)?;
                let [low, high] = mesh.bounds;
                let extent = high - low;
                let scale = height / extent.y.max(1e-12);
                let middle = (low + high) * (0.5 * scale);
                let file = toml_edit::Value::from(mesh.file.display().to_string());
                let element = format!(
                    "# A solid from a mesh file, {height} mm high, its middle at the image. Clear acrylic; `midair check` tells which part of the\n\
                     # image it forms. An image that sticks out of it, or stands where it is thin, is better moved or made smaller.\n\
                     [[element]]\nname = \"bunny\"\nshape = {{ kind = \"mesh\", file = {}, scale = {scale:?} }}\n\
                     position = [{:?}, {:?}, {:?}]\nmaterial = {{ glass = \"acrylic\" }}\n",
                    file.to_string().trim(),
                    hundredth(-middle.x),
                    hundredth(-middle.y),
                    hundredth(-middle.z),
                );
                let side = tenth(0.15 * height);
                let reach = 0.5 * scale * (extent.y + extent.z) * FRAC_1_SQRT_2;
                Ok(self.over_a_table(eye, [side, side], reach, &element))
            }
            Template::Mirror => {
                let radius =
                    within("a mirror's radius", self.object.unwrap_or(250.0), 100.0, 5000.0)?;
                Ok(self.on_a_mirror(eye.max(600.0), radius, plate_height))
            }
        }
    }

    /// The plate at 45 degrees behind the object, the display lying on the table under both. `reach`: how far the object reaches towards the
    /// plate, along its normal.
    fn over_a_table(&self, eye: f64, image: [f64; 2], reach: f64, element: &str) -> String {
        let ([width, height], plate) = &self.plate;
        // The plate's lower edge 10 mm above the display, and 15 mm between plate and object.
        let back = (0.5 * height * FRAC_1_SQRT_2 + 10.0).max((reach + 15.0) / FRAC_1_SQRT_2).ceil();
        let mut text = self.head(&format!(
            "# The viewer looks along -z at an image that stands upright at the origin. Behind it the plate leans at 45 degrees, its upper edge towards\n\
             # the back; the display lies flat below, {back} mm lower than the image's middle and as far behind it. The plate turns the display's\n\
             # light up and forward: the image is as far before the plate as the display is behind it.\n"
        ));
        let _ = write!(
            text,
            "\n# The eye that the image is made for. An image straight ahead at 600 mm is an arm's length away.\n\
             [viewpoint]\nposition = [0.0, 0.0, {eye:?}]\n\n\
             # The mid-air image: width and height. Its front (local +z) faces the viewer.\n\
             [image]\nposition = [0.0, 0.0, 0.0]\nsize = [{:?}, {:?}]\n\n\
             # The micro-mirror array plate ({plate}). rotation = [-45, 0, 0] leans its front up and towards the viewer.\n\
             [plate]\nposition = [0.0, 0.0, -{back:?}]\nrotation = [-45.0, 0.0, 0.0]\nsize = [{width:?}, {height:?}]\n",
            image[0], image[1]
        );
        self.tail(text, element)
    }

    /// The plate upright on the table's level behind a convex mirror, the viewer 30 degrees above the horizon.
    fn on_a_mirror(&self, eye: f64, radius: f64, plate_height: f64) -> String {
        let ([width, _], plate) = &self.plate;
        // An image of 40 mm, or less before a small plate or on a small ridge; behind it, half as far as the plate is high.
        let side = tenth(40.0f64.min(plate_height / 6.0).min(radius / 4.0));
        let back = (0.4 * plate_height).ceil();
        let (s, c) = 30f64.to_radians().sin_cos();
        let middle = 0.5 * side;
        let element = format!(
            "# A sheet that is bent about z with a radius of {radius} mm, its ridge at y = 0: the image's lower edge stands on it. Its middle faces up.\n\
             [[element]]\nname = \"mirror\"\nshape = {{ kind = \"cylinder-mirror\", radius = {radius:?}, size = [{:?}, {:?}], facing = \"convex\" }}\n\
             rotation = [-90.0, 0.0, 0.0]\nmaterial = {{ mirror = true, reflectance = 0.95 }}\n",
            tenth(4.0 * side),
            // Up to 10 mm before the plate, and as far to the front.
            tenth(2.0 * (back - 10.0)),
        );
        let mut text = self.head(
            "# A glossy table: the viewer looks down at 30 degrees at an image that stands on a bent mirror. Light comes from the display behind\n\
             # the plate, through the plate, and by the mirror to the viewer, who sees the image upright.\n",
        );
        let _ = write!(
            text,
            "\n# The eye, {eye} mm from the image's middle and 30 degrees above the horizon.\n[viewpoint]\nposition = [0.0, {:?}, {:?}]\n\n\
             # The mid-air image, its lower edge on the mirror's ridge.\n[image]\nposition = [0.0, {middle:?}, 0.0]\nsize = [{side:?}, {side:?}]\n\n\
             # The micro-mirror array plate ({plate}), upright on the table's level {back} mm behind the image.\n\
             [plate]\nposition = [0.0, {:?}, -{back:?}]\nrotation = [0.0, 0.0, 0.0]\nsize = [{width:?}, {plate_height:?}]\n",
            tenth(middle + eye * s),
            tenth(eye * c),
            tenth(0.5 * plate_height),
        );
        self.tail(text, &element)
    }

    fn head(&self, about: &str) -> String {
        let name = toml_edit::Value::from(self.name.as_str());
        format!(
            "# {}.\n#\n{about}#\n# Lengths are millimetres, angles degrees; x is to the viewer's right, y up, z towards the viewer.\n\
             # `midair check` looks the set-up over, `midair draw` draws it, `midair compensate` makes what the display must show.\n\
             name = {}\n",
            sentence(self.template.about()),
            name.to_string().trim()
        )
    }

    fn tail(&self, mut text: String, element: &str) -> String {
        let ([columns, rows], [w, h], display) = &self.display;
        let _ = write!(
            text,
            "# model = \"slit-mirror\"   # with the losses, blur and stray images of a real plate\n\n\
             # The display ({display}): pixels, and width and height of its lit area. Without a position it stands where it belongs: where the\n\
             # image, mirrored in the plate, lies.\n[display]\nresolution = [{columns}, {rows}]\nsize = [{w:?}, {h:?}]\n\n{element}"
        );
        text
    }
}

fn sentence(words: &str) -> String {
    let mut letters = words.chars();
    letters.next().map(|first| first.to_uppercase().chain(letters).collect()).unwrap_or_default()
}

fn tenth(value: f64) -> f64 {
    (value * 10.0).round() / 10.0 + 0.0
}

fn hundredth(value: f64) -> f64 {
    (value * 100.0).round() / 100.0 + 0.0
}

fn within(what: &'static str, value: f64, least: f64, most: f64) -> Result<f64, TemplateError> {
    if (least..=most).contains(&value) {
        Ok(value)
    } else {
        Err(TemplateError::Length { what, value, least, most })
    }
}

#[cfg(test)]
mod tests {
    use super::super::devices::{DISPLAYS, PLATES};
    use super::*;
    use crate::evaluate::preflight::{Severity, preflight};
    use crate::map::{Accuracy, formation, invert};
    use crate::scene::{Format, load_text};
    use crate::transport::Setup;

    /// Checks a scene as `midair check` does; its display has no finding.
    fn is_sound(wishes: &Wishes) {
        let text = wishes.scene().unwrap();
        let loaded = load_text(&text, "new.toml", Format::Toml, &crate::scene::InMemory::new())
            .unwrap_or_else(|e| panic!("{e}\n{text}"));
        let setup = Setup::new(&loaded).unwrap();
        let (map, _) = invert(&setup, Accuracy::default());
        let formation = formation(&setup, &map, setup.view_size(64));
        let found = preflight(&setup, &loaded.scene, &map, &formation);
        let grave: Vec<_> =
            found.findings.iter().filter(|f| f.severity != Severity::Note).collect();
        assert!(grave.is_empty(), "{grave:#?}\n{text}");
    }

    fn of(template: Template, plate: usize, display: usize) -> Wishes {
        let (plate, display) = (&PLATES[plate], &DISPLAYS[display]);
        Wishes {
            plate: (plate.size, plate.name.to_owned()),
            display: Wishes::display_of(display),
            ..Wishes::new(template)
        }
    }

    #[test]
    fn every_scene_passes_its_check() {
        let mut checked = 0;
        for template in [Template::Cube, Template::Bottle, Template::Mirror] {
            for plate in 0..PLATES.len() {
                // A tablet, a telephone and a monitor.
                for display in [0, 6, 10] {
                    is_sound(&of(template, plate, display));
                    checked += 1;
                }
            }
        }
        assert_eq!(checked, 18);
    }

    #[test]
    fn objects_and_eyes_may_be_of_other_sizes() {
        for (template, sizes) in [
            (Template::Cube, [25.0, 100.0]),
            (Template::Bottle, [80.0, 240.0]),
            (Template::Mirror, [150.0, 1000.0]),
        ] {
            for object in sizes {
                for eye in [500.0, 2000.0] {
                    is_sound(&Wishes {
                        object: Some(object),
                        eye: Some(eye),
                        ..of(template, 0, 2)
                    });
                }
            }
        }
        let giant = Wishes { object: Some(1000.0), ..Wishes::new(Template::Cube) };
        assert!(giant.scene().unwrap_err().to_string().contains("give 15 to 244 mm"));
    }

    #[test]
    fn a_mesh_is_scaled_and_put_in_the_middle() {
        assert_eq!(Wishes::new(Template::Bunny).scene(), Err(TemplateError::NoMesh));
        let file =
            std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes/meshes/spot.obj");
        let bytes = std::fs::read(&file).unwrap();
        let closed = crate::geometry::mesh::Surface::Closed;
        let (mesh, _) = crate::geometry::mesh::load(&bytes, &file, closed, None).unwrap();
        let mesh = MeshFile { file, bounds: mesh.bounds() };
        let wishes = Wishes { mesh: Some(mesh), object: Some(90.0), ..of(Template::Bunny, 0, 0) };
        let text = wishes.scene().unwrap();
        let here = crate::scene::Folder::default();
        let loaded = load_text(&text, "new.toml", Format::Toml, &here).unwrap();
        let element = &Setup::new(&loaded).unwrap().elements[0];
        let [low, high] = element.shape.bounds();
        assert!((high.y - low.y - 90.0).abs() < 1e-6);
        // Positions are written to a hundredth of a millimetre.
        let middle = element.frame.to_world((low + high) * 0.5);
        assert!(middle.length() < 0.01, "{middle:?}");
    }
}
