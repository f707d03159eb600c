//! The files that a scene names, by name: of a folder, or in memory.

use super::error::{SceneError, SceneText};
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::io::{self, Read as _};
use std::path::{Path, PathBuf};

/// Brings the files that a scene names: meshes, pictures, tables, glasses.
///
/// Names are as the scene has them, or for the buffers of a glTF file relative to that file's folder; they are never resolved against a
/// folder of the process by the library.
pub trait Assets {
    /// A file's bytes.
    ///
    /// # Errors
    /// When there is no such file, or it cannot be read.
    fn read(&self, name: &Path) -> io::Result<Vec<u8>>;

    /// What messages call the file, and where it is if it is on a disk.
    fn place(&self, name: &Path) -> PathBuf {
        name.to_owned()
    }
}

/// Files in memory, by name: what a page or an archive brings. Empty for scenes that name none.
///
/// ```
/// use midair::Setup;
/// use midair::scene::{Format, InMemory, load_text};
///
/// # fn main() -> Result<(), midair::Error> {
/// let tetrahedron = "v 9 9 9\nv 9 -9 -9\nv -9 9 -9\nv -9 -9 9\nf 1 2 3\nf 1 4 2\nf 1 3 4\nf 2 4 3\n";
/// let scene = r#"
///     [viewpoint]
///     position = [0.0, 0.0, 800.0]
///     [image]
///     size = [10.0, 10.0]
///     [plate]
///     position = [0.0, 0.0, -150.0]
///     rotation = [-45.0, 0.0, 0.0]
///     size = [400.0, 400.0]
///     [display]
///     [[element]]
///     shape = { kind = "mesh", file = "gem.obj" }
///     material = { ior = 1.49 }
/// "#;
/// let files = InMemory::new().with("gem.obj", tetrahedron);
/// let setup = Setup::new(&load_text(scene, "gem.toml", Format::Toml, &files)?)?;
/// assert_eq!(setup.elements.len(), 1);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct InMemory(BTreeMap<PathBuf, Vec<u8>>);

impl InMemory {
    /// No files.
    pub fn new() -> Self {
        Self::default()
    }

    /// With one more file.
    #[must_use]
    pub fn with(mut self, name: impl Into<PathBuf>, bytes: impl Into<Vec<u8>>) -> Self {
        self.0.insert(name.into(), bytes.into());
        self
    }
}

impl Assets for InMemory {
    fn read(&self, name: &Path) -> io::Result<Vec<u8>> {
        let missing = || io::Error::new(io::ErrorKind::NotFound, "no file of that name was given");
        self.0.get(name).cloned().ok_or_else(missing)
    }
}

/// Files of a folder: that of the scene file.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Folder(pub PathBuf);

/// Files are read whole; a larger one is not one that can be traced in memory.
const MOST_BYTES: u64 = 1 << 29;

impl Assets for Folder {
    /// Devices and pipes without end stop at the limit, too.
    fn read(&self, name: &Path) -> io::Result<Vec<u8>> {
        let mut bytes = Vec::new();
        std::fs::File::open(self.place(name))?.take(MOST_BYTES + 1).read_to_end(&mut bytes)?;
        if bytes.len() as u64 > MOST_BYTES {
            return Err(io::Error::other("the file is larger than 512 MiB"));
        }
        Ok(bytes)
    }

    fn place(&self, name: &Path) -> PathBuf {
        self.0.join(name)
    }
}

/// What a scene's files say, with an account of which were read.
pub(super) struct Reading<'a> {
    assets: &'a dyn Assets,
    text: &'a SceneText,
    read: RefCell<Vec<PathBuf>>,
}

impl<'a> Reading<'a> {
    pub fn new(assets: &'a dyn Assets, text: &'a SceneText) -> Self {
        Self { assets, text, read: RefCell::default() }
    }

    /// A file's bytes and what messages call it; what is wrong is said at `key`.
    pub fn file(&self, key: &str, name: &Path) -> Result<(Vec<u8>, PathBuf), SceneError> {
        let place = self.assets.place(name);
        match self.bytes(name) {
            Ok(bytes) => Ok((bytes, place)),
            Err(error) => Err(self.text.error_at(
                key,
                format!("{}: cannot be read: {error}", place.display()),
                "check the path (relative to the scene file) and the permissions",
            )),
        }
    }

    /// A file's bytes.
    pub fn bytes(&self, name: &Path) -> io::Result<Vec<u8>> {
        let bytes = self.assets.read(name)?;
        self.read.borrow_mut().push(self.assets.place(name));
        Ok(bytes)
    }

    /// The files that were read, in their order.
    pub fn into_read(self) -> Vec<PathBuf> {
        self.read.into_inner()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Format, load, load_text};

    #[test]
    fn files_come_from_memory_or_from_a_folder() {
        let memory = InMemory::new().with("a/b.obj", *b"v");
        assert_eq!(memory.read("a/b.obj".as_ref()).unwrap(), b"v");
        assert_eq!(memory.read("b.obj".as_ref()).unwrap_err().kind(), io::ErrorKind::NotFound);
        let place = tempfile::tempdir().unwrap();
        std::fs::write(place.path().join("c"), "x").unwrap();
        let folder = Folder(place.path().to_owned());
        assert_eq!(folder.read("c".as_ref()).unwrap(), b"x");
        assert_eq!(folder.place("c".as_ref()), place.path().join("c"));
    }

    /// Every kind of file that a scene can name, from memory and from a folder: the same set-up, and an account of all of them.
    #[test]
    fn a_scene_of_files_in_memory_is_the_scene_of_files_on_a_disk() {
        let buffer: Vec<u8> =
            [[9.0f32, 9.0, 9.0], [9.0, -9.0, -9.0], [-9.0, 9.0, -9.0], [-9.0, -9.0, 9.0]]
                .iter()
                .flatten()
                .flat_map(|c| c.to_le_bytes())
                .chain([0u16, 1, 2, 0, 3, 1, 0, 2, 3, 1, 3, 2].iter().flat_map(|i| i.to_le_bytes()))
                .collect();
        let gltf = format!(
            r#"{{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0]}}],"nodes":[{{"mesh":0}}],
            "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"indices":1}}]}}],
            "accessors":[{{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3","min":[-9,-9,-9],"max":[9,9,9]}},
            {{"bufferView":1,"componentType":5123,"count":12,"type":"SCALAR"}}],
            "bufferViews":[{{"buffer":0,"byteLength":48}},{{"buffer":0,"byteOffset":48,"byteLength":24}}],
            "buffers":[{{"uri":"gem.bin","byteLength":{}}}]}}"#,
            buffer.len()
        );
        let mut picture = io::Cursor::new(Vec::new());
        let heights = image::GrayImage::from_fn(4, 4, |x, y| image::Luma([(20 * x + 5 * y) as u8]));
        heights.write_to(&mut picture, image::ImageFormat::Png).unwrap();
        let glass = "DATA:\n  - type: tabulated n\n    data: |\n      0.3 1.5\n      1.0 1.48\n";
        let files = [
            ("meshes/gem.gltf", gltf.into_bytes()),
            ("meshes/gem.bin", buffer),
            ("heights.png", picture.into_inner()),
            ("glass.yml", glass.as_bytes().to_vec()),
            ("response.csv", b"code,light\n0,0\n1,1\n".to_vec()),
            ("emission.csv", b"angle,radiance\n0,1\n80,0.5\n".to_vec()),
            (
                "plate.csv",
                b"azimuth,elevation,value\n-90,-90,1\n90,-90,1\n-90,90,1\n90,90,1\n".to_vec(),
            ),
        ];
        let text = r#"
            [viewpoint]
            position = [0.0, 0.0, 800.0]
            [image]
            size = [10.0, 10.0]
            [plate]
            position = [0.0, 0.0, -150.0]
            rotation = [-45.0, 0.0, 0.0]
            size = [400.0, 400.0]
            luminance = "plate.csv"
            [display]
            response = "response.csv"
            emission = "emission.csv"
            [[element]]
            shape = { kind = "mesh", file = "meshes/gem.gltf", unit = "mm", normals = "flat" }
            material = { file = "glass.yml", absorption = 0.0 }
            [[element]]
            shape = { kind = "height-field", file = "heights.png", size = [60.0, 60.0], amplitude = 1.0, depth = 5.0 }
            position = [0.0, 0.0, 60.0]
            material = { ior = 1.49 }
        "#;
        let memory =
            files.iter().fold(InMemory::new(), |all, (name, bytes)| all.with(*name, bytes.clone()));
        let folder = tempfile::tempdir().unwrap();
        std::fs::create_dir(folder.path().join("meshes")).unwrap();
        for (name, bytes) in &files {
            std::fs::write(folder.path().join(name), bytes).unwrap();
        }
        let path = folder.path().join("scene.toml");
        std::fs::write(&path, text).unwrap();

        let held = load_text(text, "scene.toml", Format::Toml, &memory).unwrap();
        let kept = load(&path).unwrap();
        let mut named: Vec<PathBuf> = files.iter().map(|(name, _)| name.into()).collect();
        named.sort();
        let mut read = held.files.clone();
        read.sort();
        assert_eq!(read, named);
        let mut read = kept.files.clone();
        read.sort();
        let placed: Vec<PathBuf> = named.iter().map(|name| folder.path().join(name)).collect();
        assert_eq!(read, placed);

        let [held, kept] = [held, kept].map(|loaded| crate::Setup::new(&loaded).unwrap());
        let mut met = 0;
        for k in 0..100 {
            let uv = [f64::from(k % 10) / 9.0, f64::from(k / 10) / 9.0];
            let [a, b] = [&held, &kept].map(|setup| {
                let mut path = crate::transport::Path::new();
                let end = setup.transport(uv, &mut path);
                (end, path)
            });
            assert_eq!(a, b, "{uv:?}");
            // Into the height field and out of it, and into the mesh.
            met += usize::from(a.1.len() >= 3);
        }
        assert!(met > 10, "{met}");
        // Each of them is needed: without it the message names it.
        for (name, _) in &files {
            let rest = files.iter().filter(|(other, _)| other != name);
            let rest =
                rest.fold(InMemory::new(), |all, (name, bytes)| all.with(*name, bytes.clone()));
            let error = load_text(text, "scene.toml", Format::Toml, &rest).unwrap_err();
            let file = Path::new(name).file_name().unwrap().to_str().unwrap();
            assert!(error.message.contains(file), "{name}: {}", error.message);
        }
    }
}
