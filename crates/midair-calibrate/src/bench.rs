//! The bench file: what was photographed, what was assumed, and how sure one is of it.

use crate::camera::Lens;
use crate::storage;
use midair::Error;
use midair::map::format::FileError;
use midair::scene::form::{self, Block, Fields, Kind, Need, block, optional, required};
use midair::scene::{Format, SceneText};
use std::path::{Path, PathBuf};

const BEYOND: f64 = 1e6;

static CAMERA: Block = Block {
    name: "camera",
    about: "The camera's lens, the same in all views, by OpenCV's model. Left out, it is found from the empty photographs of three views or more.",
    keys: &[
        optional(
            "file",
            Kind::File,
            None,
            Need::Optional,
            "What cv2.FileStorage wrote of cv2.calibrateCamera (YAML, XML or JSON), in the place of focal, centre and distortion.",
        ),
        optional(
            "size",
            Kind::Integers(2, 1, 100_000),
            Some("px"),
            Need::Optional,
            "Width and height of its photographs.",
        ),
        optional(
            "focal",
            Kind::Numbers(2, 1.0, BEYOND),
            Some("px"),
            Need::Optional,
            "Focal lengths fx and fy.",
        ),
        optional(
            "centre",
            Kind::Numbers(2, -BEYOND, BEYOND),
            Some("px"),
            Need::Optional,
            "Where the optical axis meets the photograph; pixel centres are at half-integers, so OpenCV's cx and cy plus 0.5.",
        ),
        optional(
            "distortion",
            Kind::Numbers(5, -1e3, 1e3),
            None,
            Need::Optional,
            "OpenCV's k1, k2, p1, p2 and k3; left out, the lens does not distort.",
        ),
    ],
    exactly_one: &[&["file", "focal"], &["file", "centre"]],
};

static UNCERTAINTY: Block = block(
    "uncertainty",
    "How sure one is of the scene's measures: one standard deviation of each.",
    &[
        optional(
            "position",
            Kind::Number(1e-6, 1e4),
            Some("mm"),
            Need::Number(3.0),
            "Of where an element stands, along each axis.",
        ),
        optional(
            "rotation",
            Kind::Number(1e-6, 180.0),
            Some("degrees"),
            Need::Number(3.0),
            "Of how it is turned, about each axis.",
        ),
        optional(
            "ior",
            Kind::Number(1e-9, 1.0),
            None,
            Need::Number(0.02),
            "Of a refractive index.",
        ),
        optional(
            "size",
            Kind::Number(1e-6, 1e4),
            Some("mm"),
            Need::Number(0.5),
            "Of lengths that are asked to be fitted: radii, edges, heights.",
        ),
    ],
);

static TOGETHER: Block = block(
    "together",
    "Elements that are one thing and move as one, such as a glass and the water in it.",
    &[required("elements", Kind::Text, None, "Their names, with commas between.")],
);

static VIEW: Block = Block {
    name: "view",
    about: "What was photographed from one place, without the object and with it.",
    keys: &[
        required("name", Kind::Text, None, "What it is called."),
        optional(
            "empty",
            Kind::File,
            None,
            Need::Optional,
            "Folder with photographs of the patterns without the object.",
        ),
        optional(
            "object",
            Kind::File,
            None,
            Need::Optional,
            "Folder with photographs of the patterns with the object in place.",
        ),
        optional(
            "empty_points",
            Kind::File,
            None,
            Need::Optional,
            "CSV file x,y,s,t[,sigma] of what was decoded without the object.",
        ),
        optional(
            "object_points",
            Kind::File,
            None,
            Need::Optional,
            "CSV file x,y,s,t[,sigma] of what was decoded with the object.",
        ),
    ],
    exactly_one: &[&["empty", "empty_points"], &["object", "object_points"]],
};

static BENCH: Block = block(
    "the bench",
    "Photographs of a display's patterns, and the scene that was assumed.",
    &[
        required("scene", Kind::File, None, "Scene file as it was assumed, relative to this file."),
        optional("camera", Kind::Block(&CAMERA), None, Need::Optional, "The camera."),
        optional(
            "uncertainty",
            Kind::Block(&UNCERTAINTY),
            None,
            Need::Optional,
            "How sure one is of the scene's measures.",
        ),
        optional(
            "together",
            Kind::Blocks(&TOGETHER),
            None,
            Need::Optional,
            "Elements that move as one.",
        ),
        required("view", Kind::Blocks(&VIEW), None, "The places that were photographed from."),
    ],
);

/// One standard deviation of each kind of measure, before anything was photographed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Uncertainty {
    /// Of a place, mm.
    pub position: f64,
    /// Of a turn, degrees.
    pub rotation: f64,
    /// Of a refractive index.
    pub ior: f64,
    /// Of a length, mm.
    pub size: f64,
}

impl Default for Uncertainty {
    fn default() -> Self {
        Self { position: 3.0, rotation: 3.0, ior: 0.02, size: 0.5 }
    }
}

/// Where the correspondences of one state of a view come from.
#[derive(Clone, Debug, PartialEq)]
pub enum Source {
    /// A folder of photographs.
    Photographs(PathBuf),
    /// What another tool decoded.
    Points(PathBuf),
}

/// A place that was photographed from.
#[derive(Clone, Debug, PartialEq)]
pub struct ViewSource {
    /// What it is called.
    pub name: String,
    /// Without the object.
    pub empty: Source,
    /// With it.
    pub object: Source,
}

/// A bench file as it was read.
#[derive(Clone, Debug)]
pub struct Bench {
    /// The scene file, as a path from here.
    pub scene: PathBuf,
    /// The camera's lens, if it is known.
    pub lens: Option<Lens>,
    /// The photographs' width and height, if they are given.
    pub size: Option<[usize; 2]>,
    /// How sure one is of the scene.
    pub uncertainty: Uncertainty,
    /// Elements that move as one: their names, and the key for messages.
    pub together: Vec<Vec<String>>,
    /// The views.
    pub views: Vec<ViewSource>,
    /// The file's text, for messages that show a line of it.
    pub text: SceneText,
}

impl Bench {
    /// Reads a bench file; files that it names are relative to it.
    ///
    /// # Errors
    /// A file that cannot be read, and all that is wrong with it, with line and remedy.
    pub fn load(path: &Path) -> Result<Self, Error> {
        let text =
            std::fs::read_to_string(path).map_err(|error| FileError::io(path, "read", error))?;
        Self::parse(&text, path)
    }

    /// As [`load`](Self::load), of a file's text.
    ///
    /// # Errors
    /// All that is wrong with the text.
    pub fn parse(text: &str, path: &Path) -> Result<Self, Error> {
        let name = path.display().to_string();
        let (table, text) = form::read(&BENCH, text, &name, Format::of_name(&name))?;
        let folder = path.parent().map(Path::to_path_buf).unwrap_or_default();
        let fields = Fields::new(&BENCH, &table);
        let unread =
            || text.error_at("view", "the bench cannot be read", "compare it with the book");
        let place = |fields: &Fields, key: &str| fields.text(key).map(|file| folder.join(file));
        let source = |fields: &Fields, photographs: &str, points: &str| {
            let photographs = place(fields, photographs).map(Source::Photographs);
            photographs.or_else(|| place(fields, points).map(Source::Points))
        };
        let mut views: Vec<ViewSource> = Vec::new();
        for (i, view) in fields.blocks("view").iter().enumerate() {
            let name = view.text("name").ok_or_else(unread)?.to_owned();
            let key = format!("view[{i}].name");
            if views.iter().any(|other| other.name == name) {
                let message = format!("two views are called `{name}`");
                return Err(text
                    .error_at(&key, message, "give each view a name of its own")
                    .into());
            }
            let fit_for_a_file = |c: char| c.is_alphanumeric() || "-_. ".contains(c);
            if name.is_empty() || name.starts_with('.') || !name.chars().all(fit_for_a_file) {
                let message = format!("`{name}` cannot be a part of a file's name");
                let help = "name it with letters, digits, - and _";
                return Err(text.error_at(&key, message, help).into());
            }
            views.push(ViewSource {
                name,
                empty: source(view, "empty", "empty_points").ok_or_else(unread)?,
                object: source(view, "object", "object_points").ok_or_else(unread)?,
            });
        }
        let usual = Uncertainty::default();
        let uncertainty = fields.block("uncertainty").map_or(usual, |given| Uncertainty {
            position: given.number("position").unwrap_or(usual.position),
            rotation: given.number("rotation").unwrap_or(usual.rotation),
            ior: given.number("ior").unwrap_or(usual.ior),
            size: given.number("size").unwrap_or(usual.size),
        });
        let camera = fields.block("camera");
        let mut size = camera.as_ref().and_then(|camera| camera.sizes("size"));
        let mut lens = camera.as_ref().and_then(|camera| {
            Some(Lens {
                focal: camera.numbers("focal")?,
                centre: camera.numbers("centre")?,
                distortion: camera.numbers("distortion").unwrap_or_default(),
            })
        });
        if let Some(file) = camera.as_ref().and_then(|camera| place(camera, "file")) {
            if camera.as_ref().is_some_and(|camera| camera.numbers::<5>("distortion").is_some()) {
                let message = "the camera's file tells its distortion";
                let help = "leave distortion out, or give focal, centre and distortion in place of the file";
                return Err(text.error_at("camera.distortion", message, help).into());
            }
            let found = storage::load(&file)?;
            lens = Some(found.lens);
            size = size.or(found.size);
        }
        if views.is_empty() {
            let help = "give a [[view]] for each place that was photographed from";
            return Err(text.error_at("view", "there is no view", help).into());
        }
        if lens.is_none() && views.len() < 3 {
            let message = match views.len() {
                1 => "one view does not tell the camera's lens",
                _ => "two views do not tell the camera's lens",
            };
            let help = "give [camera] with focal, centre and distortion (OpenCV's calibrateCamera finds them), or photograph from three places or more";
            return Err(text.error_at("view", message, help).into());
        }
        let together = fields.blocks("together");
        let together = together
            .iter()
            .filter_map(|block| block.text("elements"))
            .map(|names| names.split(',').map(|name| name.trim().to_owned()).collect())
            .collect();
        Ok(Self {
            scene: place(&fields, "scene").ok_or_else(unread)?,
            lens,
            size,
            uncertainty,
            together,
            views,
            text,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const WHOLE: &str = r#"
scene = "scene.toml"
[camera]
size = [6000, 4000]
focal = [9870.0, 9870.0]
centre = [3000.0, 2000.0]
distortion = [-0.1, 0.0, 0.0, 0.0, 0.0]
[uncertainty]
position = "5 mm"
[[together]]
elements = "glass, water"
[[view]]
name = "front"
empty = "front-empty/"
object_points = "front.csv"
"#;

    fn told(text: &str) -> String {
        match Bench::parse(text, "a/bench.toml".as_ref()) {
            Ok(bench) => format!("{bench:?}"),
            Err(error) => format!("{error} | {}", error.remedy().unwrap_or_default()),
        }
    }

    #[test]
    fn a_whole_bench_is_read() {
        let bench = Bench::parse(WHOLE, "a/bench.toml".as_ref()).expect("it conforms");
        assert_eq!(bench.scene, Path::new("a/scene.toml"));
        assert_eq!(bench.uncertainty, Uncertainty { position: 5.0, ..Uncertainty::default() });
        assert_eq!(bench.lens.expect("a lens").distortion[0], -0.1);
        assert_eq!(bench.together, [["glass".to_owned(), "water".to_owned()]]);
        assert_eq!(bench.views[0].object, Source::Points("a/front.csv".into()));
        assert_eq!(bench.views[0].empty, Source::Photographs("a/front-empty/".into()));
    }

    #[test]
    fn mistakes_are_told_with_place_and_remedy() {
        for (from, to, wanted) in [
            ("focal =", "focals =", ["a/bench.toml:5: unknown key `focals`", "focal"]),
            ("position = ", "positon = ", ["unknown key `positon`", "position"]),
            ("name = \"front\"\n", "", ["lacks the key `name`", "name"]),
            ("object_points = \"front.csv\"\n", "", ["needs one of", "object"]),
            ("\"5 mm\"", "\"5 kg\"", ["position", "millimetres"]),
            ("[9870.0, 9870.0]", "9870.0", ["focal", "focal"]),
            ("centre = [3000.0, 2000.0]\n", "", ["needs one of", "centre"]),
            ("focal = [", "file = \"camera.yml\"\nfocal = [", ["`file`", "exactly one"]),
            ("\"front\"", "\"../front\"", ["cannot be a part of a file's name", "letters"]),
        ] {
            let told = told(&WHOLE.replace(from, to));
            assert!(wanted.iter().all(|wanted| told.contains(wanted)), "{told}");
        }
    }

    #[test]
    fn a_camera_has_one_distortion() {
        let own = "focal = [9870.0, 9870.0]\ncentre = [3000.0, 2000.0]\n";
        assert!(WHOLE.contains(own) && WHOLE.contains("distortion"));
        let told = told(&WHOLE.replace(own, "file = \"camera.yml\"\n"));
        assert!(told.contains("distortion") && told.contains("leave"), "{told}");
    }

    #[test]
    fn a_lens_takes_three_views() {
        let start = WHOLE.find("[camera]").expect("it is there");
        let end = WHOLE.find("[uncertainty]").expect("it is there");
        let without = format!("{}{}", &WHOLE[..start], &WHOLE[end..]);
        assert!(told(&without).contains("three places or more"), "{}", told(&without));
    }
}
