//! Lenses, lathes, prisms and hollow things: as they are written, as light takes them, and what is refused.

use super::model::Shape;
use super::*;
use crate::geometry::{Ray, Vec3};
use crate::transport::{Action, End, Path, Setup};

/// A scene with these elements.
fn scene(elements: &str) -> String {
    format!(
        "[viewpoint]\nposition = [0.0, 40.0, 800.0]\n[image]\nsize = [30.0, 50.0]\n[plate]\n\
         position = [0.0, 0.0, -150.0]\nrotation = [-45.0, 0.0, 0.0]\nsize = [488.0, 488.0]\n{elements}"
    )
}

fn element(shape: &str, more: &str) -> String {
    scene(&format!(
        "[[element]]\nname = \"it\"\nshape = {{ {shape} }}\nmaterial = {{ ior = 1.5 }}\n{more}"
    ))
}

fn setup(text: &str) -> Setup {
    let loaded = load_text(text, "test.toml", Format::Toml, &InMemory::new());
    Setup::new(&loaded.unwrap_or_else(|error| panic!("{error:?}"))).unwrap()
}

fn refused(text: &str) -> String {
    let error = parse(text, "test.toml", Format::Toml).expect_err(text);
    format!("{} ({})", error.message, error.help)
}

const SHAPES: [&str; 8] = [
    r#"kind = "hemisphere", radius = 25.0"#,
    r#"kind = "torus", radius = 25.0, tube = 6.0"#,
    r#"kind = "lens", radii = [60.0, -80.0], thickness = 6.0, diameter = 40.0"#,
    r#"kind = "lens", radii = [60.0, 0.0], thickness = 8.0, diameter = 40.0, conic = [-0.5, 0.0], aspheric_front = [1e-6, -2e-9]"#,
    r#"kind = "lathe", profile = [[20, -40], [30, 0], [20, 40]]"#,
    r#"kind = "lathe", profile = [[0.0, -40.0], [30.0, -10.0], [12.0, 40.0], [12.0, 40.0], [0.0, 40.0]], smooth = true"#,
    r#"kind = "prism", outline = [[-20, -20], [20, -20], [0, 20]], depth = 30.0"#,
    r#"kind = "prism", outline = [[-20, 0], [0, -15], [20, 0], [0, 15]], depth = 30.0, smooth = true"#,
];

#[test]
fn what_is_written_is_read_again() {
    for shape in SHAPES {
        let read = parse(&element(shape, ""), "test.toml", Format::Toml).unwrap();
        let again = parse(&to_toml(&read), "test.toml", Format::Toml).unwrap();
        assert_eq!(read, again, "{shape}");
    }
    let hollow =
        "wall = 2\nopen = true\nfill = { height = 40, glass = \"water\", absorption = 0.001 }\n";
    let bottle = element(r#"kind = "cylinder", radius = 30.0, height = 80.0"#, hollow);
    let read = parse(&bottle, "test.toml", Format::Toml).unwrap();
    assert!(read.elements[0].hollow.as_ref().is_some_and(|h| h.open && h.fill.is_some()));
    assert_eq!(read, parse(&to_toml(&read), "test.toml", Format::Toml).unwrap());
}

#[test]
fn every_shape_lets_light_through_to_the_display() {
    for shape in SHAPES {
        let setup = setup(&element(shape, ""));
        let mut path = Path::new();
        let mut formed = 0;
        for k in 0..100 {
            let uv = [(f64::from(k % 10) + 0.5) / 10.0, (f64::from(k / 10) + 0.5) / 10.0];
            let end = setup.transport(uv, &mut path);
            if let End::Display { st, .. } = end {
                formed += usize::from(path.len() > 1);
                // Along the path that was found F is the same.
                let [s, t] = setup.follow(uv, &mut path);
                assert!((s - st[0]).abs() < 1e-9 && (t - st[1]).abs() < 1e-9, "{shape} {uv:?}");
                assert!(path.len() % 2 == 1, "in and out of solids: {shape} {path:?}");
            }
        }
        assert!(formed >= 15, "{shape}: {formed}");
    }
}

/// Where a ray that comes down parallel to the axis, this far from it, meets the axis behind a lens.
fn focus(setup: &Setup, height: f64) -> f64 {
    let mut ray = Ray {
        origin: Vec3::new(0.6 * height, 0.8 * height, 700.0),
        direction: Vec3::new(0.0, 0.0, -1.0),
    };
    let mut path = Path::new();
    setup.trace(ray, &mut path);
    let steps: Vec<_> = path.iter().filter(|step| step.action != Action::Plate).collect();
    assert_eq!(steps.len(), 2, "{path:?}");
    for step in steps {
        ray = setup.advance(&ray, step);
    }
    let t = -(ray.origin.x + ray.origin.y) / (ray.direction.x + ray.direction.y);
    let p = ray.at(t);
    // It stays in the plane of incidence.
    assert!(p.x.hypot(p.y) < 1e-9 * p.length());
    p.z
}

#[test]
fn a_thin_ray_meets_the_axis_where_the_lensmaker_says() {
    let n = 1.5;
    for ([front, back], d) in
        [([60.0, 80.0], 10.0), ([60.0, -200.0], 5.0), ([0.0, 50.0], 8.0), ([45.0, 0.0], 8.0)]
    {
        let shape = format!(
            "kind = \"lens\", radii = [{front:?}, {back:?}], thickness = {d:?}, diameter = 30.0"
        );
        let [a, b] = [front, back].map(|r: f64| if r == 0.0 { 0.0 } else { r.recip() });
        let power = (n - 1.0) * (a + b - (n - 1.0) * d / n * a * b);
        // From the vertex of the back surface.
        let back_focus = (1.0 - (n - 1.0) * d / n * a) / power;
        let found = focus(&setup(&element(&shape, "")), 1e-3);
        // Spherical aberration grows with the square of the height: 1e-6 / 50^2 of the focal length.
        assert!(
            (found + 0.5 * d + back_focus).abs() < 1e-6 * back_focus.abs(),
            "{shape} {found} {back_focus}"
        );
    }
}

#[test]
fn a_hyperboloid_brings_all_parallel_light_to_one_point() {
    // Light that leaves glass of index n by a hyperboloid of conic constant -n^2 (Descartes).
    let shape = "kind = \"lens\", radii = [0.0, 50.0], thickness = 20.0, diameter = 50.0, conic = [0.0, -2.25]";
    let setup = setup(&element(shape, ""));
    for height in [0.5, 5.0, 12.0, 20.0, 24.0] {
        let z = focus(&setup, height);
        assert!((z + 10.0 + 100.0).abs() < 1e-9, "{height} {z}");
    }
    // Aspheric terms that are a paraboloid's next ones: a sphere's fall is r^2/2R + r^4/8R^3 + r^6/16R^5 + 5 r^8/128R^7 + ...
    let r: f64 = 100.0;
    let terms = [
        1.0 / (8.0 * r.powi(3)),
        1.0 / (16.0 * r.powi(5)),
        5.0 / (128.0 * r.powi(7)),
        7.0 / (256.0 * r.powi(9)),
    ];
    let by_terms = format!(
        "kind = \"lens\", radii = [0.0, {r:?}], thickness = 5.0, diameter = 20.0, conic = [0.0, -1.0], aspheric_back = {terms:?}"
    );
    let sphere = format!("kind = \"lens\", radii = [0.0, {r:?}], thickness = 5.0, diameter = 20.0");
    let [a, b] = [by_terms, sphere].map(|shape| self::setup(&element(&shape, "")));
    for height in [1.0, 5.0, 9.0] {
        // The next term, 21 r^12 / 1024 R^11 at 9 mm, bends by its slope: 8e-12, at 200 mm and over 9 mm from the axis 4e-8 mm.
        assert!((focus(&a, height) - focus(&b, height)).abs() < 1e-7);
    }
}

/// Both scenes have the same F, over a grid of image points; how many were compared.
fn same(a: &str, b: &str) -> usize {
    let (a, b) = (setup(a), setup(b));
    let (mut path, mut compared) = (Path::new(), 0);
    for k in 0..400 {
        let uv = [(f64::from(k % 20) + 0.37) / 20.0, (f64::from(k / 20) + 0.41) / 20.0];
        match (a.transport(uv, &mut path).st(), b.transport(uv, &mut path).st()) {
            (Some(p), Some(q)) => {
                // A hundred operations on places of a metre, through surfaces that magnify tenfold.
                assert!((p[0] - q[0]).hypot(p[1] - q[1]) < 1e-9, "{uv:?} {p:?} {q:?}");
                compared += 1;
            }
            (p, q) => assert_eq!(p, q, "{uv:?}"),
        }
    }
    compared
}

#[test]
fn a_wall_and_a_fill_are_nested_elements() {
    let written = element(
        r#"kind = "cylinder", radius = 30.0, height = 100.0"#,
        "wall = 2.5\nfill = { height = 55.0, ior = 1.33 }\n",
    );
    let nested = scene(
        "[[element]]\nname = \"glass\"\nshape = { kind = \"cylinder\", radius = 30.0, height = 100.0 }\nmaterial = { ior = 1.5 }\n\
         [[element]]\nname = \"air\"\nshape = { kind = \"cylinder\", radius = 27.5, height = 95.0 }\nmaterial = { ior = 1.0 }\n\
         [[element]]\nname = \"water\"\nshape = { kind = \"cylinder\", radius = 27.5, height = 55.0 }\nposition = [0.0, -20.0, 0.0]\nmaterial = { ior = 1.33 }\n",
    );
    assert!(same(&written, &nested) > 250);
    // A ball of glass that is hollow is two balls.
    let written = element(r#"kind = "sphere", radius = 30.0"#, "wall = 4.0\n");
    let nested = scene(
        "[[element]]\nshape = { kind = \"sphere\", radius = 30.0 }\nmaterial = { ior = 1.5 }\n\
         [[element]]\nshape = { kind = \"sphere\", radius = 26.0 }\nmaterial = { ior = 1.0 }\n",
    );
    assert!(same(&written, &nested) > 250);
    // An aquarium without a lid, filled to its middle.
    let written = element(
        r#"kind = "box", size = [80.0, 60.0, 40.0]"#,
        "wall = 3.0\nopen = true\nfill = { height = 30.0, ior = 1.33 }\n",
    );
    let nested = scene(
        "[[element]]\nshape = { kind = \"box\", size = [80.0, 60.0, 40.0] }\nmaterial = { ior = 1.5 }\n\
         [[element]]\nshape = { kind = \"box\", size = [74.0, 57.0, 34.0] }\nposition = [0.0, 1.5, 0.0]\nmaterial = { ior = 1.0 }\n\
         [[element]]\nshape = { kind = \"box\", size = [74.0, 30.0, 34.0] }\nposition = [0.0, -12.0, 0.0]\nmaterial = { ior = 1.33 }\n",
    );
    assert!(same(&written, &nested) > 250);
}

#[test]
fn a_straight_lathe_and_a_prism_are_what_they_look_like() {
    let cone = element(r#"kind = "cone", radius = 30.0, top_radius = 18.0, height = 70.0"#, "");
    let lathe = element(r#"kind = "lathe", profile = [[30.0, -35.0], [18.0, 35.0]]"#, "");
    assert!(same(&cone, &lathe) > 250);
    let block =
        element(r#"kind = "box", size = [50.0, 60.0, 40.0]"#, "rotation = [0.0, 20.0, 0.0]\n");
    let prism = element(
        r#"kind = "prism", outline = [[-25, -30], [25, -30], [25, 30], [-25, 30]], depth = 40.0"#,
        "rotation = [0.0, 20.0, 0.0]\n",
    );
    assert!(same(&block, &prism) > 250);
}

#[test]
fn what_is_inside_of_a_thing_stands_after_the_scene_s_elements_and_ranks_above_it() {
    let more = "wall = 2.0\nfill = { ior = 1.33 }\n[[element]]\nshape = { kind = \"sphere\", radius = 9.0 }\nmaterial = { ior = 1.6 }\n";
    let setup = setup(&element(r#"kind = "hemisphere", radius = 30.0"#, more));
    let names: Vec<&str> = setup.elements.iter().map(|e| e.name.as_str()).collect();
    assert_eq!(names, ["it", "sphere", "it (air inside)", "it (fill)"]);
    let ranks: Vec<u8> = setup.elements.iter().map(|e| e.rank).collect();
    // The outside, its air, the liquid that fills it, the ball in the liquid.
    assert_eq!(ranks, [0, 3, 1, 2]);
    assert_eq!(setup.elements[3].inside_of, Some(0));
}

#[test]
fn what_cannot_be_is_refused_in_its_own_words() {
    let cases = [
        (r#"kind = "torus", radius = 10.0, tube = 12.0"#, "", "leaves no hole"),
        (
            r#"kind = "lens", radii = [10.0, 10.0], thickness = 6.0, diameter = 30.0"#,
            "",
            "cannot be 30 mm wide",
        ),
        (
            r#"kind = "lens", radii = [40.0, 40.0], thickness = 2.0, diameter = 30.0"#,
            "",
            "its two surfaces meet",
        ),
        (r#"kind = "lathe", profile = [[-5, -40], [30, 0]]"#, "", "beyond the axis"),
        (r#"kind = "lathe", profile = [[20, -40], [30, 0], 7]"#, "", "is not two numbers"),
        (r#"kind = "lathe", profile = [[20, -40]]"#, "", "too few points"),
        (
            r#"kind = "lathe", profile = [[10, 0], [30, 20], [30, 0], [10, 20]]"#,
            "",
            "crosses itself",
        ),
        (
            r#"kind = "prism", outline = [[0, 0], [9, 9], [4, 4]], depth = 5.0"#,
            "",
            "surrounds nothing",
        ),
        (r#"kind = "sphere", radius = 20.0"#, "wall = 25.0", "leaves no room"),
        (r#"kind = "sphere", radius = 20.0"#, "wall = 2.0\nopen = true", "no flat top"),
        (r#"kind = "ellipsoid", radii = [20.0, 20.0, 10.0]"#, "wall = 2.0", "even distance"),
        (r#"kind = "sphere", radius = 20.0"#, "open = true", "no meaning for a solid"),
        (
            r#"kind = "cylinder", radius = 20.0, height = 50.0"#,
            "rotation = [10.0, 0.0, 0.0]\nwall = 2.0\nfill = { height = 20.0, ior = 1.33 }",
            "does not stand upright",
        ),
        (r#"kind = "vase", radius = 20.0"#, "", "did you mean `lathe`"),
    ];
    for (shape, more, part) in cases {
        let told = refused(&element(shape, more));
        assert!(told.contains(part), "{shape} {more}: {told}");
    }
}

#[test]
fn a_viewpoint_in_a_lathe_is_in_it() {
    let shape = r#"kind = "lathe", profile = [[20, -40], [30, 0], [20, 40]]"#;
    let told = refused(&element(shape, "position = [0.0, 40.0, 800.0]"));
    assert!(told.contains("the viewpoint lies inside the element `it`"), "{told}");
    assert!(matches!(
        parse(&element(shape, ""), "t", Format::Toml).unwrap().elements[0].shape,
        Shape::Lathe { .. }
    ));
}

#[test]
fn lengths_and_angles_may_have_units() {
    let plain = element(
        r#"kind = "box", size = [50.0, 25.4, 300.0]"#,
        "position = [0.0, -20.0, 12.7]\nrotation = [0.0, 15.5, 0.0]\n",
    );
    let with = element(
        r#"kind = "box", size = ["5 cm", "1in", "0.3 m"]"#,
        "position = [0, \"-2cm\", \"0.5 in\"]\nrotation = [0.0, \"15.5 deg\", 0.0]\n",
    );
    let [a, b] = [&plain, &with].map(|text| parse(text, "test.toml", Format::Toml).unwrap());
    for (x, y) in a.elements[0].pose.position.iter().zip(b.elements[0].pose.position) {
        assert!((x - y).abs() < 1e-12);
    }
    assert_eq!(a.elements[0].pose.rotation, b.elements[0].pose.rotation);
    let (Shape::Box { size: p }, Shape::Box { size: q }) =
        (&a.elements[0].shape, &b.elements[0].shape)
    else {
        panic!("two boxes")
    };
    assert!(p.iter().zip(q).all(|(x, y)| (x - y).abs() < 1e-12));
    for (wrong, part) in [
        (r#"kind = "sphere", radius = "25""#, "write 25.0"),
        (r#"kind = "sphere", radius = "25 kg""#, "\"5 cm\""),
        (r#"kind = "sphere", radius = "-2 cm""#, "negative"),
        (r#"kind = "sphere", radius = "30 deg""#, "\"5 cm\""),
    ] {
        let told = refused(&element(wrong, ""));
        assert!(told.contains(part), "{wrong}: {told}");
    }
    // What is changed becomes a number; what is not stays as it was written.
    let mut edit = SceneEdit::of(&SceneText::new("test.toml", &with)).unwrap();
    let mut moved = edit.scene().clone();
    moved.elements[0].pose.position[0] = 1.5;
    edit.set_scene(&moved).unwrap();
    assert!(edit.text().contains("1.5, \"-2cm\", \"0.5 in\""), "{}", edit.text());
}

#[test]
fn an_opaque_part_stops_the_light_and_is_told_by_its_name() {
    // A label that covers the right half of a bottle's front, up to the middle of what is seen.
    let label = "[[element]]\nname = \"label\"\nshape = { kind = \"box\", size = [30.0, 100.0, 0.2] }\nposition = [15.0, 0.0, 60.0]\n\
                 material = { opaque = true }\n";
    let text = scene(label).replace("[0.0, 40.0, 800.0]", "[0.0, 0.0, 800.0]");
    let setup = setup(&text);
    let mut path = Path::new();
    let mut seen = [0, 0];
    for k in 0..100 {
        let uv = [(f64::from(k % 10) + 0.5) / 10.0, (f64::from(k / 10) + 0.5) / 10.0];
        match setup.transport(uv, &mut path) {
            End::Stopped { element } => {
                // Lines of sight through the right half meet the label, as it begins on the axis.
                assert!(
                    uv[0] > 0.5 && setup.elements[usize::from(element)].name == "label",
                    "{uv:?}"
                );
                seen[0] += 1;
            }
            end => {
                assert!(uv[0] < 0.5 && matches!(end, End::Display { .. }), "{uv:?} {end:?}");
                seen[1] += 1;
            }
        }
    }
    assert_eq!(seen, [50, 50]);
    let (map, _) = crate::map::invert(&setup, crate::map::Accuracy::default());
    let formed = crate::map::formation(&setup, &map, [100, 100]);
    assert!((formed.formed() - 0.5).abs() < 0.011, "{}", formed.formed());
    let read = parse(&text, "test.toml", Format::Toml).unwrap();
    assert_eq!(read, parse(&to_toml(&read), "test.toml", Format::Toml).unwrap());
    let told = refused(&scene(&label.replace("opaque = true", "opaque = true, absorption = 1.0")));
    assert!(told.contains("no meaning for an opaque part"), "{told}");
}
