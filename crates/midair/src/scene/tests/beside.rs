//! What scenes name beside themselves: meshes, heights; and files that cannot be read.

use super::*;

/// The good scene with the ball replaced by the cow of the examples, or by another file.
fn with_mesh(folder: &Path, file: &Path) -> PathBuf {
    let shape = format!("kind = \"mesh\", file = '{}', scale = 40", file.display());
    let path = folder.join("mesh.toml");
    std::fs::write(&path, with("kind = \"sphere\", radius = 25.0", &shape)).unwrap();
    path
}

#[test]
fn a_mesh_comes_with_the_scene_in_millimetres() {
    let folder = tempfile::tempdir().unwrap();
    let spot = std::fs::canonicalize(scenes().join("meshes/spot.obj")).unwrap();
    let path = with_mesh(folder.path(), &spot);
    let loaded = load(&path).unwrap();
    let Asset::Mesh { mesh, .. } = &loaded.assets[0] else { panic!("no mesh") };
    let [low, high] = mesh.bounds();
    // The file's own height is 0.953646 + 0.736784.
    assert!((high.y - low.y - 40.0 * 1.69043).abs() < 1e-9);
    assert_eq!(mesh.normals.as_ref().unwrap().len(), mesh.triangles.len());
    assert!(loaded.notes.iter().any(|note| note.contains("normals: smooth up to 30 degrees")));

    // An eye in the cow's middle.
    let text = std::fs::read_to_string(&path).unwrap().replace("800.0]", "12.0]");
    std::fs::write(&path, text).unwrap();
    let error = load(&path).unwrap_err();
    assert!(error.message.contains("inside the element"), "{error}");
}

#[test]
fn what_is_wrong_with_a_mesh_is_said_at_the_scene_s_line() {
    let folder = tempfile::tempdir().unwrap();
    let spot = std::fs::read_to_string(scenes().join("meshes/spot.obj")).unwrap();
    let cut = &spot[..spot.len() - 200];
    std::fs::write(folder.path().join("cut.obj"), cut).unwrap();
    let error = load(&with_mesh(folder.path(), Path::new("cut.obj"))).unwrap_err();
    assert!(error.place.contains("mesh.toml:15:"), "{error}");
    assert!(error.message.contains("cut.obj") && error.message.contains("face"), "{error}");

    let flipped = spot.replacen("f ", "f 1 2 3\nf ", 1);
    std::fs::write(folder.path().join("extra.obj"), flipped).unwrap();
    let error = load(&with_mesh(folder.path(), Path::new("extra.obj"))).unwrap_err();
    assert!(error.message.contains("face 1 (line"), "{error}");

    let error = load(&with_mesh(folder.path(), Path::new("none.ply"))).unwrap_err();
    assert!(error.message.contains("none.ply"), "{error}");
}

#[test]
fn scene_files_that_cannot_be_read_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let missing = folder.path().join("missing.toml");
    let error = load(&missing).unwrap_err();
    assert_eq!(error.place, missing.display().to_string());
    let binary = folder.path().join("binary.toml");
    std::fs::write(&binary, b"name = 1\nname = \xff\n").unwrap();
    let error = load(&binary).unwrap_err();
    assert!(error.message.contains("line 2") && error.message.contains("UTF-8"), "{error}");
    assert!(load(folder.path()).is_err());
}

/// Writes a picture and loads the good scene with a height-field of it.
fn with_heights(write: impl Fn(&Path), name: &str) -> Result<Loaded, SceneError> {
    let folder = tempfile::tempdir().unwrap();
    write(&folder.path().join(name));
    let shape = format!("kind = \"height-field\", file = '{name}', size = [9, 9], amplitude = 2");
    let text = with("kind = \"sphere\", radius = 25.0", &shape);
    let path = folder.path().join("scene.toml");
    std::fs::write(&path, text).unwrap();
    load(&path)
}

#[test]
fn heights_are_read_from_pictures() {
    use image::{DynamicImage, ImageBuffer, Luma, Rgb};
    let eight = ImageBuffer::from_fn(3, 2, |x, y| Luma([(100 * y + 50 * x) as u8]));
    let sixteen = ImageBuffer::from_fn(3, 2, |x, y| Luma([(10_000 * y + 1_000 * x) as u16]));
    let height = |x: usize, y: usize| y as f32 * 2.0 - x as f32 * 0.25;
    let of_codes =
        |picture: DynamicImage| with_heights(|path| picture.save(path).unwrap(), "a.png");
    let of_floats = |height: &(dyn Fn(usize, usize) -> f32 + Sync)| {
        let grey = |x, y| (height(x, y), height(x, y), height(x, y));
        with_heights(|path| exr::prelude::write_rgb_file(path, 3, 2, grey).unwrap(), "a.exr")
    };
    let expected = |f: &dyn Fn(f64, f64) -> f64| {
        (0..2)
            .map(|y| (0..3).map(|x| f(f64::from(x), f64::from(y))).collect::<Vec<f64>>())
            .collect::<Vec<_>>()
    };
    let rows = |loaded: Loaded| match &loaded.assets[0] {
        Asset::Heights(heights) => heights.rows().to_vec(),
        other => panic!("{other:?}"),
    };
    let read = of_codes(DynamicImage::ImageLuma8(eight)).unwrap();
    assert_eq!(rows(read), expected(&|x, y| (100.0 * y + 50.0 * x) / 255.0));
    let read = of_codes(DynamicImage::ImageLuma16(sixteen)).unwrap();
    assert_eq!(rows(read), expected(&|x, y| (1e4 * y + 1e3 * x) / 65535.0));
    let read = of_floats(&height).unwrap();
    assert_eq!(rows(read), expected(&|x, y| y * 2.0 - x * 0.25));

    let colour = ImageBuffer::from_fn(2, 2, |x, _| Rgb([x as u8, 0, 0]));
    let error = of_codes(DynamicImage::ImageRgb8(colour)).unwrap_err();
    assert!(error.message.contains("a.png") && error.message.contains("not grey"), "{error}");
    let hole = |x, y| if (x, y) == (2, 1) { f32::NAN } else { height(x, y) };
    let error = of_floats(&hole).unwrap_err();
    assert!(error.message.contains("pixel [2, 1]"), "{error}");
    let thin = ImageBuffer::from_pixel(5, 1, Luma([7u8]));
    let error = of_codes(DynamicImage::ImageLuma8(thin)).unwrap_err();
    assert!(error.message.contains("5 x 1"), "{error}");
}
