//! Reading a scene file with the files that it names.

use super::error::{SceneError, SceneText};
use super::model::{HeightSource, Material, Normals, ResponseSource, Scene, Shape};
use super::{Format, heights, parse_with_places, sense};
use crate::geometry::mesh::{self, Surface, TriangleMesh};
use crate::optics::plate::LuminanceTable;
use crate::optics::screen::{Response, ResponseTable, Screen};
use std::io::Read as _;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// What an element's file holds.
#[derive(Clone, Debug, PartialEq)]
pub enum Asset {
    /// The element names no file.
    None,
    /// Its mesh, checked and mended, in its own frame and in mm; with vertex normals if they are
    /// smooth.
    Mesh(Arc<TriangleMesh>),
    /// Its height samples, the first row at the +y edge, before the amplitude.
    Heights(Vec<Vec<f64>>),
}

/// A scene with the files that it names.
#[derive(Clone, Debug)]
pub struct Loaded {
    /// The set-up.
    pub scene: Scene,
    /// For each element what its file holds.
    pub assets: Vec<Asset>,
    /// How the display's codes become light.
    pub screen: Screen,
    /// The measured luminance that the plate names.
    pub luminance: Option<LuminanceTable>,
    /// The scene file's text, for messages that show a line of it.
    pub text: SceneText,
    /// The folder that the scene's files are relative to.
    pub folder: PathBuf,
    /// What was mended on meshes, and other things worth saying.
    pub notes: Vec<String>,
}

/// Scene files are read whole; this leaves room for a height-field of a million samples.
const MOST_BYTES: u64 = 1 << 26;

/// Reads a scene file and the meshes and pictures that it names. A name that ends in `.json` is
/// JSON, every other TOML.
///
/// # Errors
/// Files that cannot be read, and all that is wrong with the scene, with its line and a remedy.
pub fn load(path: &Path) -> Result<Loaded, SceneError> {
    let name = path.display().to_string();
    let whole = |message: String, help: &str| SceneText::new(&name, "").error(None, message, help);
    let mut bytes = Vec::new();
    std::fs::File::open(path)
        .and_then(|file| file.take(MOST_BYTES + 1).read_to_end(&mut bytes))
        .map_err(|e| {
            whole(format!("cannot be read: {e}"), "check the scene file's path and permissions")
        })?;
    if bytes.len() as u64 > MOST_BYTES {
        return Err(whole(
            "is larger than 64 MiB".to_owned(),
            "this is not a scene file; large samples go into a picture or a mesh file",
        ));
    }
    let text = match String::from_utf8(bytes) {
        Ok(text) => text,
        Err(error) => {
            let at = error.utf8_error().valid_up_to();
            let line = error.as_bytes()[..at].iter().filter(|&&b| b == b'\n').count() + 1;
            return Err(whole(
                format!("line {line} is not UTF-8 text"),
                "save the scene file as UTF-8",
            ));
        }
    };
    let json = path.extension().is_some_and(|e| e.eq_ignore_ascii_case("json"));
    let format = if json { Format::Json } else { Format::Toml };
    let (scene, text) = parse_with_places(&text, &name, format)?;
    let folder = path.parent().map(Path::to_path_buf).unwrap_or_default();
    with_files(scene, text, folder)
}

/// Adds the files that a parsed scene names, looked for in `folder`.
///
/// # Errors
/// As [`load`].
pub fn with_files(scene: Scene, text: SceneText, folder: PathBuf) -> Result<Loaded, SceneError> {
    let mut notes = Vec::new();
    let mut assets = Vec::with_capacity(scene.elements.len());
    for (i, element) in scene.elements.iter().enumerate() {
        let key = format!("element[{i}].shape.file");
        assets.push(match &element.shape {
            Shape::Mesh { file, scale, unit, normals } => {
                let surface = match element.material {
                    Material::Refractive { .. } => Surface::Closed,
                    Material::Mirror { .. } => Surface::Open,
                };
                let (mesh, mended) = mesh::load(&folder.join(file), surface)
                    .map_err(|e| text.error_at(&key, e.to_string(), e.help.clone()))?;
                notes.extend(
                    mended.notes().iter().map(|note| format!("{}: {note}", file.display())),
                );
                if mesh::MeshFormat::of(file) == Some(mesh::MeshFormat::Gltf)
                    && !text.has(&format!("element[{i}].shape.unit"))
                {
                    notes.push(format!(
                        "{}: read in millimetres; glTF files are in metres, for which write \
                         unit = \"m\"",
                        file.display()
                    ));
                }
                let mesh = mesh.scaled(scale * unit);
                Asset::Mesh(Arc::new(match normals {
                    Normals::Smooth => mesh.with_smooth_normals(),
                    Normals::Flat => mesh,
                }))
            }
            Shape::HeightField { source: HeightSource::File(file), .. } => {
                Asset::Heights(heights::read(&folder.join(file)).map_err(|message| {
                    text.error_at(
                        &key,
                        message,
                        "give a grey PNG of 8 or 16 bit or an EXR, of at least 2 x 2 pixels",
                    )
                })?)
            }
            _ => Asset::None,
        });
    }
    let screen = screen(&scene, &text, &folder)?;
    let luminance = match &scene.plate.luminance {
        None => None,
        Some(file) => Some(LuminanceTable::read(&folder.join(file)).map_err(|e| {
            let help = "give a CSV file with the columns azimuth, elevation (degrees) and value";
            text.error_at("plate.luminance", e.to_string(), help)
        })?),
    };
    match SceneError::gathered(sense::faults(&scene, &text, &assets)) {
        Some(error) => Err(error),
        None => Ok(Loaded { scene, assets, luminance, screen, text, folder, notes }),
    }
}

/// The display's response, with the file that it may name.
fn screen(scene: &Scene, text: &SceneText, folder: &Path) -> Result<Screen, SceneError> {
    let display = &scene.display;
    let mut measured = [0.0; 3];
    let response = match &display.response {
        ResponseSource::Srgb => Response::Srgb,
        ResponseSource::Gamma(gamma) => Response::Gamma(*gamma),
        ResponseSource::File(file) => {
            let table = ResponseTable::read(&folder.join(file)).map_err(|e| {
                let help = "give a CSV file with a header code,light or code,red,green,blue";
                text.error_at("display.response", e.to_string(), help)
            })?;
            measured = table.black();
            Response::Measured(Box::new(table))
        }
    };
    Ok(Screen { response, black: display.black.unwrap_or(measured), bits: display.bits })
}
