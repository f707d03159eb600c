//! Scenes with their files.

use super::*;
use crate::transport::{Matter, Setup};

const GLASS: &str = "DATA:\n  - type: formula 2\n    wavelength_range: 0.4 0.8\n    \
    coefficients: 0 1.03961212 0.00600069867 0.231792344 0.0200179144 1.01046945 103.560653\n  \
    - type: tabulated k\n    data: |\n      0.45 1.0e-7\n      0.65 3.0e-7\n";

/// A ball of the glass file's, with more keys of the material and of the display.
fn ball(glass: &str, material: &str, display: &str) -> Result<Loaded, SceneError> {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("glass.yml"), glass).unwrap();
    let text = format!(
        "[viewpoint]\nposition = [0.0, 0.0, 800.0]\n[image]\nsize = [20.0, 20.0]\n\
         [plate]\nposition = [0.0, 0.0, -150.0]\nrotation = [-45.0, 0.0, 0.0]\nsize = [400.0, 400.0]\n\
         [display]\n{display}\n[[element]]\nshape = {{ kind = \"sphere\", radius = 30.0 }}\n\
         material = {{ file = \"glass.yml\"{material} }}\n"
    );
    let scene = folder.path().join("scene.toml");
    std::fs::write(&scene, text).unwrap();
    load(&scene)
}

fn matter(loaded: &Loaded) -> [Matter; 3] {
    Setup::new(loaded).unwrap().by_colour().map(|setup| setup.elements[0].matter)
}

#[test]
fn a_glass_file_gives_index_and_absorption() {
    let loaded = ball(GLASS, "", "").unwrap();
    assert!(Setup::new(&loaded).unwrap().disperses());
    let known = crate::optics::glass::lookup("N-BK7").unwrap();
    // k rises from 1e-7 by 1e-8 every 0.01 micrometres; 4 pi k / lambda.
    let expected = [0.611, 0.549, 0.465]
        .map(|w: f64| 4.0 * std::f64::consts::PI * (1e-7 + (w - 0.45) * 1e-6) / (w / 1000.0));
    for (matter, w) in matter(&loaded).into_iter().zip([0.611, 0.549, 0.465]) {
        let Matter::Refractive { index, absorption } = matter else { panic!("{matter:?}") };
        assert!((index - known.index(w)).abs() < 1e-12);
        for c in 0..3 {
            assert!((absorption[c] / expected[c] - 1.0).abs() < 1e-9, "{absorption:?}");
        }
    }
    // What the scene says counts.
    let loaded = ball(GLASS, ", absorption = 0.0", "").unwrap();
    let clear = |matter| matches!(matter, Matter::Refractive { absorption: [0.0, 0.0, 0.0], .. });
    assert!(matter(&loaded).into_iter().all(clear));
}

/// A changed scene is the scene of a file that says the same; files are read again where the change concerns them.
#[test]
fn a_changed_scene_is_that_of_a_changed_file() {
    use crate::scene::InMemory;
    const TEXT: &str = "[viewpoint]\nposition = [0.0, 0.0, 800.0]\n[image]\nsize = [20.0, 20.0]\n\
         [plate]\nposition = [0.0, 0.0, -150.0]\nrotation = [-45.0, 0.0, 0.0]\nsize = [400.0, 400.0]\n\
         [display]\n[[element]]\nname = \"gem\"\nshape = { kind = \"mesh\", file = \"gem.obj\" }\n\
         material = { ior = 1.49 }\n";
    let gem = "v 9 9 9\nv 9 -9 -9\nv -9 9 -9\nv -9 -9 9\nf 1 2 3\nf 1 4 2\nf 1 3 4\nf 2 4 3\n";
    let files = InMemory::new().with("gem.obj", gem);
    let loaded = load_text(TEXT, "a.toml", Format::Toml, &files).unwrap();
    let surface = |loaded: &Loaded| match &loaded.assets[0] {
        Asset::Mesh { surface, .. } => Arc::clone(surface),
        other => panic!("{other:?}"),
    };
    let mut edit = SceneEdit::new(TEXT, "a.toml", Format::Toml).unwrap();
    edit.set("element.gem.rotation.y", 10.0).unwrap();
    edit.set("element.gem.material.ior", 1.6).unwrap();
    let turned = loaded.changed(&edit, &InMemory::new()).unwrap();
    assert!(Arc::ptr_eq(&surface(&turned), &surface(&loaded)));
    edit.set("element.gem.shape.scale", 2.0).unwrap();
    let larger = turned.changed(&edit, &files).unwrap();
    assert!(!Arc::ptr_eq(&surface(&larger), &surface(&loaded)));
    assert!(turned.changed(&edit, &InMemory::new()).is_err());
    let fresh = load_text(edit.text(), "a.toml", Format::Toml, &files).unwrap();
    assert_eq!(larger.scene, fresh.scene);
    let [a, b] = [&larger, &fresh].map(|loaded| {
        let setup = Setup::new(loaded).unwrap();
        let uv: Vec<_> =
            (0..100).map(|i| [f64::from(i % 10), f64::from(i / 10)].map(|x| x / 9.0)).collect();
        setup.transport_all(&uv, crate::transport::End::st)
    });
    assert_eq!(format!("{a:?}"), format!("{b:?}"));
    // What no set-up can be is refused, at its line.
    edit.set("viewpoint.position", [0.0, 0.0, 1.0]).unwrap();
    let error = larger.changed(&edit, &files).unwrap_err();
    assert_eq!(error.file_and_line(), ("a.toml", Some(2)), "{error}");
}

#[test]
fn what_a_glass_file_does_not_know_is_said_at_its_key() {
    let cases = [
        (GLASS, "", "wavelengths = [611.0, 549.0, 390.0]", "no index at 0.39 micrometres"),
        (GLASS, "", "wavelengths = [611.0, 549.0, 430.0]", "no k at 0.43 micrometres"),
        ("DATA:\n  - type: formula 99\n", "", "", "glass.yml, line 2: formula 99"),
        (
            "DATA:\n  - type: tabulated n\n    data: |\n      0.4 0.2\n      0.8 0.2\n",
            "",
            "",
            "mirror",
        ),
    ];
    for (glass, material, display, part) in cases {
        let error = ball(glass, material, display).unwrap_err();
        let told = format!("{error} {}", error.help);
        assert!(told.contains(part) && told.contains("glass.yml"), "{told}");
    }
    // Absorption said in the scene needs no k.
    let display = "wavelengths = [611.0, 549.0, 430.0]";
    assert!(ball(GLASS, ", absorption = 0.01", display).is_ok());
}
