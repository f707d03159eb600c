//! Reading a scene file with the files that it names.

use super::assets::{Assets, Folder, Reading};
use super::error::{SceneError, SceneText};
use super::heights::{self, Heights};
use super::model::{
    Display, Element, HeightSource, Index, Material, Normals, ResponseSource, Scene, Shape,
};
use super::{Format, SceneEdit, parse_with_places, sense, validate};
use crate::geometry::MeshSurface;
use crate::geometry::mesh::{self, Surface, TriangleMesh};
use crate::optics::emission::{Emission, EmissionTable};
use crate::optics::glass::DESIGN_WAVELENGTH;
use crate::optics::glass_file::GlassFile;
use crate::optics::plate::LuminanceTable;
use crate::optics::screen::{Response, ResponseTable, Screen};
use std::io::Read as _;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// What an element's file holds.
#[derive(Clone, Debug)]
pub enum Asset {
    /// The element names no file.
    None,
    /// Its mesh, checked and mended, in its own frame and in mm.
    Mesh {
        /// With normals at its corners if they are not each face's own.
        mesh: Arc<TriangleMesh>,
        /// The same as rays meet it: its tree of boxes is built once, whatever becomes of the scene.
        surface: Arc<MeshSurface>,
    },
    /// Its height samples.
    Heights(Arc<Heights>),
}

impl Asset {
    /// A mesh in mm.
    pub fn mesh(mesh: TriangleMesh) -> Self {
        let surface = Arc::new(MeshSurface::new(&mesh));
        Self::Mesh { mesh: Arc::new(mesh), surface }
    }
}

/// A scene with the files that it names.
#[derive(Clone, Debug)]
pub struct Loaded {
    /// The set-up.
    pub scene: Scene,
    /// For each element what its file holds.
    pub assets: Vec<Asset>,
    /// For each element the glass file that it names.
    pub glasses: Vec<Option<Arc<GlassFile>>>,
    /// How the display's codes become light.
    pub screen: Screen,
    /// How its light goes with the direction.
    pub emission: Emission,
    /// The measured luminance that the plate names.
    pub luminance: Option<LuminanceTable>,
    /// The scene file's text, for messages that show a line of it.
    pub text: SceneText,
    /// The files that were read besides the scene, where [`Assets::place`] says that they are.
    pub files: Vec<PathBuf>,
    /// What was mended on meshes, and other things worth saying.
    pub notes: Vec<String>,
}

impl Loaded {
    /// The scene as an edit has it. Files that the change does not concern are not read again: what was made of them is shared.
    ///
    /// # Errors
    /// What [`load`] would refuse of a file that said the same.
    pub fn changed(&self, edit: &SceneEdit, files: &dyn Assets) -> Result<Self, SceneError> {
        let (scene, text) = (edit.scene().clone(), edit.places().clone());
        if !has_same_files(&self.scene, &scene) {
            return with_files(scene, text, files);
        }
        let changed = Self { scene, text, ..self.clone() };
        validate(&changed)?;
        Ok(changed)
    }
}

/// Whether files say the same for both scenes.
fn has_same_files(a: &Scene, b: &Scene) -> bool {
    let shape = |element: &Element| match &element.shape {
        // A solid's mesh is closed, a mirror's need not be.
        shape @ (Shape::Mesh { .. } | Shape::HeightField { .. }) => {
            Some((shape.clone(), matches!(element.material, Material::Mirror { .. })))
        }
        _ => None,
    };
    let glass = |element: &Element| match &element.material {
        Material::Refractive { index: Index::File(file), .. } => Some(file.clone()),
        _ => None,
    };
    let display = |scene: &Scene| {
        let Display { response, black, bits, emission, .. } = scene.display.clone();
        (response, black, bits, emission)
    };
    a.elements.len() == b.elements.len()
        && a.elements
            .iter()
            .zip(&b.elements)
            .all(|(a, b)| shape(a) == shape(b) && glass(a) == glass(b))
        && a.plate.luminance == b.plate.luminance
        && display(a) == display(b)
}

/// Scene files are read whole; this leaves room for a height-field of a million samples.
const MOST_BYTES: u64 = 1 << 26;

/// Reads a scene file and the meshes and pictures that it names. A name that ends in `.json` is
/// JSON, every other TOML.
///
/// # Errors
/// Files that cannot be read, and all that is wrong with the scene, with its line and a remedy.
pub fn load(path: &Path) -> Result<Loaded, SceneError> {
    let (name, text) = (path.display().to_string(), scene_file_text(path)?);
    let (scene, text) = parse_with_places(&text, &name, Format::of_name(&name))?;
    let folder = path.parent().map(Path::to_path_buf).unwrap_or_default();
    with_files(scene, text, &Folder(folder))
}

/// A scene file's text.
///
/// # Errors
/// Where the file cannot be read, or holds no text or more than a scene.
pub fn scene_file_text(path: &Path) -> Result<String, SceneError> {
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
    String::from_utf8(bytes).map_err(|error| {
        let at = error.utf8_error().valid_up_to();
        let line = error.as_bytes()[..at].iter().filter(|&&b| b == b'\n').count() + 1;
        whole(format!("line {line} is not UTF-8 text"), "save the scene file as UTF-8")
    })
}

/// Reads a scene that is text in memory, with the files that it names; `file_name` stands in messages.
///
/// # Errors
/// As [`load`].
pub fn load_text(
    text: &str,
    file_name: &str,
    format: Format,
    files: &dyn Assets,
) -> Result<Loaded, SceneError> {
    let (scene, text) = parse_with_places(text, file_name, format)?;
    with_files(scene, text, files)
}

/// Adds the files that a parsed scene names.
///
/// # Errors
/// As [`load`].
pub fn with_files(scene: Scene, text: SceneText, files: &dyn Assets) -> Result<Loaded, SceneError> {
    let reading = Reading::new(files, &text);
    let mut notes = Vec::new();
    let mut assets = Vec::with_capacity(scene.elements.len());
    for (i, element) in scene.elements.iter().enumerate() {
        let key = format!("element[{i}].shape.file");
        assets.push(match &element.shape {
            Shape::Mesh { file, scale, unit, smoothing, normals } => {
                let surface = match element.material {
                    Material::Refractive { .. } => Surface::Closed,
                    Material::Mirror { .. } | Material::Opaque => Surface::Open,
                };
                let (bytes, place) = reading.file(&key, file)?;
                let folder = file.parent().unwrap_or(Path::new(""));
                let beside = |name: &Path| reading.bytes(&folder.join(name));
                let (mesh, mended) = mesh::load(&bytes, &place, surface, Some(&beside))
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
                let (mesh, moved) = mesh.scaled(scale * unit).smoothed(*smoothing);
                if *smoothing > 0 {
                    notes.push(format!(
                        "{}: smoothed by {smoothing} steps, which moves the surface by {:.3} mm (root mean square), {:.3} mm at most",
                        file.display(),
                        moved.rms,
                        moved.most
                    ));
                }
                if !matches!(normals, Normals::Auto { .. })
                    && text.has(&format!("element[{i}].shape.crease_angle"))
                {
                    notes.push(format!(
                        "{}: crease_angle counts only with normals = \"auto\"",
                        file.display()
                    ));
                }
                Asset::mesh(match normals {
                    Normals::Auto { crease_angle } => {
                        let (mesh, shading) = mesh.with_creased_normals(*crease_angle);
                        notes.push(format!("{}: {}", file.display(), shading.note(*crease_angle)));
                        mesh
                    }
                    Normals::Smooth => mesh.with_smooth_normals(),
                    Normals::Flat => mesh,
                })
            }
            Shape::HeightField { source: HeightSource::File(file), .. } => {
                let (bytes, place) = reading.file(&key, file)?;
                let rows = heights::decode(&bytes, &place.display().to_string());
                let help = "give a grey PNG of 8 or 16 bit or an EXR, of at least 2 x 2 pixels";
                let rows = rows.map_err(|message| text.error_at(&key, message, help))?;
                Asset::Heights(Arc::new(Heights::new(rows)))
            }
            _ => Asset::None,
        });
    }
    let glasses = glasses(&scene, &text, &reading)?;
    let screen = screen(&scene, &text, &reading)?;
    let emission = match &scene.display.emission {
        None => Emission::Lambert,
        Some(file) => {
            let (csv, place) = reading.file("display.emission", file)?;
            let table = EmissionTable::from_csv(&csv, &place).map_err(|e| {
                let help = "give a CSV file with a header angle,radiance or angle,red,green,blue";
                text.error_at("display.emission", e.to_string(), help)
            })?;
            Emission::Measured(Arc::new(table))
        }
    };
    let luminance = match &scene.plate.luminance {
        None => None,
        Some(file) => {
            let (csv, place) = reading.file("plate.luminance", file)?;
            let help = "give a CSV file with the columns azimuth, elevation (degrees) and value";
            let table = LuminanceTable::from_csv(&csv, &place)
                .map_err(|e| text.error_at("plate.luminance", e.to_string(), help))?;
            Some(table)
        }
    };
    let files = reading.into_read();
    match SceneError::gathered(sense::faults(&scene, &text, &assets)) {
        Some(error) => Err(error),
        None => {
            Ok(Loaded { scene, assets, glasses, luminance, screen, emission, text, files, notes })
        }
    }
}

/// The glass files that the elements name, which must know the wavelengths that they will be asked for.
fn glasses(
    scene: &Scene,
    text: &SceneText,
    reading: &Reading<'_>,
) -> Result<Vec<Option<Arc<GlassFile>>>, SceneError> {
    let mut glasses = Vec::with_capacity(scene.elements.len());
    for (i, element) in scene.elements.iter().enumerate() {
        let Material::Refractive { index: Index::File(file), absorption } = &element.material
        else {
            glasses.push(None);
            continue;
        };
        let key = format!("element[{i}].material.file");
        let wrong = |message: String, help: &str| text.error_at(&key, message, help);
        let (yaml, place) = reading.file(&key, file)?;
        let glass = GlassFile::from_yaml(&yaml, &place).map_err(|e| {
            let help =
                "give a YAML file of the refractiveindex.info database, or glass = \"N-BK7\"";
            wrong(e.to_string(), help)
        })?;
        glass_serves(&glass, file, scene.display.wavelengths, absorption.is_some())
            .map_err(|(message, help)| wrong(message, help))?;
        glasses.push(Some(Arc::new(glass)));
    }
    Ok(glasses)
}

/// Whether a glass file knows what it is asked for at the display's wavelengths, nm; `absorbs` where the scene says the absorption itself.
///
/// # Errors
/// What is wrong, and what helps.
pub(super) fn glass_serves(
    glass: &GlassFile,
    file: &Path,
    wavelengths: [f64; 3],
    absorbs: bool,
) -> Result<(), (String, &'static str)> {
    let colours = wavelengths.map(|nm| nm / 1000.0);
    let told = |[low, high]: [f64; 2]| format!("from {low} to {high} micrometres");
    for wavelength in colours.into_iter().chain([DESIGN_WAVELENGTH]) {
        let n = glass.index(wavelength);
        if n.is_nan() {
            let message = format!(
                "{}: no index at {wavelength} micrometres; the file has it {}",
                file.display(),
                told(glass.range())
            );
            let help = "take a file that covers the display's wavelengths and 0.58756, or change `wavelengths` in [display]";
            return Err((message, help));
        }
        if !(1.0..=5.0).contains(&n) {
            let message =
                format!("{}: the index at {wavelength} micrometres is {n:.3}", file.display());
            let help = "a transparent material has one between 1 and 5; a metal is material = { mirror = true, reflectance = ... }";
            return Err((message, help));
        }
    }
    let unknown = colours.into_iter().find(|&colour| glass.absorption(colour).is_nan());
    if let (Some(wavelength), false) = (unknown, absorbs) {
        let range = glass.absorption_range().unwrap_or_default();
        let message = format!(
            "{}: no k at {wavelength} micrometres; the file has it {}",
            file.display(),
            told(range)
        );
        return Err((message, "say absorption = ... in the scene, which then counts"));
    }
    Ok(())
}

/// The display's response, with the file that it may name.
fn screen(scene: &Scene, text: &SceneText, reading: &Reading<'_>) -> Result<Screen, SceneError> {
    let display = &scene.display;
    let mut measured = [0.0; 3];
    let response = match &display.response {
        ResponseSource::Srgb => Response::Srgb,
        ResponseSource::Gamma(gamma) => Response::Gamma(*gamma),
        ResponseSource::File(file) => {
            let (csv, place) = reading.file("display.response", file)?;
            let table = ResponseTable::from_csv(&csv, &place).map_err(|e| {
                let help = "give a CSV file with a header code,light or code,red,green,blue";
                text.error_at("display.response", e.to_string(), help)
            })?;
            measured = table.black();
            Response::Measured(Box::new(table))
        }
    };
    Ok(Screen { response, black: display.black.unwrap_or(measured), bits: display.bits })
}

#[cfg(test)]
mod tests;
