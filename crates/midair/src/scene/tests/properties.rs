//! Any scene, any text, any damage.

use super::*;

proptest! {
    /// The line identity without elements: the ray from the viewpoint through any image point, turned
    /// by the plate, meets the display at that very st.
    #[test]
    fn without_elements_every_pixel_shows_at_its_own_place(
        u in 0.0..1.0, v in 0.0..1.0, tilt in -20.0..20.0, turn in -20.0..20.0, roll in -180.0..180.0,
        plate in -65.0..-25.0, eye in (-100.0..100.0, -100.0..100.0, 300.0..900.0),
    ) {
        let mut scene = toml(GOOD).unwrap();
        scene.elements.clear();
        scene.image.pose.rotation = [tilt, turn, roll];
        scene.plate.rectangle.pose.rotation = [plate, turn, tilt];
        let eye = Vec3::new(eye.0, eye.1, eye.2);
        let [w, h] = scene.image.size;
        let local = Vec3::new((u - 0.5) * w, (v - 0.5) * h, 0.0);
        let point = scene.image.pose.frame().to_world(local);
        let d = point - eye;
        let plate = scene.plate.rectangle.pose.frame();
        let n = plate.normal();
        let hit = eye + d * ((plate.origin - eye).dot(n) / d.dot(n));
        let out = n * (2.0 * d.dot(n)) - d;
        let display = scene.display_rectangle();
        let m = display.frame.normal();
        let end = hit + out * ((display.frame.origin - hit).dot(m) / out.dot(m));
        let st = display.frame.to_local(end);
        // Lengths of hundreds of mm, grazing angles to 1 in 10: 1e-10 is a thousand ulp.
        prop_assert!((st - local).length() < 1e-10, "{st:?} is not {local:?}");
    }

    #[test]
    fn what_is_saved_reads_back(scene in scene_strategy()) {
        let text = to_toml(&scene);
        let (read, _) = parse_with_places(&text, "saved.toml", Format::Toml)
            .map_err(|e| TestCaseError::fail(format!("{e}\n{text}")))?;
        prop_assert_eq!(read, scene);
    }

    #[test]
    fn any_text_is_read_or_refused_by_name(text in "\\PC*", json: bool) {
        refused_by_name(&text, json)?;
    }

    /// A valid file with some bytes changed, cut or doubled.
    #[test]
    fn any_damage_is_read_or_refused_by_name(
        json: bool,
        cuts in proptest::collection::vec((any::<prop::sample::Index>(), any::<prop::sample::Index>(), 0..4u8, any::<char>()), 1..5),
    ) {
        let mut text: Vec<char> = if json { JSON.chars().collect() } else { GOOD.chars().collect() };
        for (a, b, what, c) in cuts {
            let (a, b) = (a.index(text.len()), b.index(text.len()));
            match what {
                0 => text[a] = c,
                1 => text.truncate(a.max(1)),
                2 => { let part = text[a.min(b)..a.max(b)].to_vec(); text.splice(a..a, part); }
                _ => { text.remove(a); if text.is_empty() { text.push(' ') } }
            }
        }
        refused_by_name(&text.into_iter().collect::<String>(), json)?;
    }
}

pub(super) const JSON: &str = r#"{"viewpoint":{"position":[0,0,800]},"image":{"size":[20,20]},"plate":
{"position":[0,0,-150],"rotation":[-45,0,0],"size":[488,488]},"element":[{"shape":{"kind":"sphere","radius":25},
"material":{"ior":1.49}}]}"#;

fn refused_by_name(text: &str, json: bool) -> Result<(), TestCaseError> {
    let format = if json { Format::Json } else { Format::Toml };
    if let Err(error) = parse(text, "some.file", format) {
        prop_assert!(error.to_string().starts_with("some.file"), "{}", error);
        prop_assert!(!error.help.is_empty());
        // The whole message stays readable whatever the file holds.
        prop_assert!(error.to_string().len() < 2000, "{}", error);
    }
    Ok(())
}

#[test]
fn depth_and_size_do_not_overwhelm() {
    for text in ["[".repeat(100_000), "a=".to_owned() + &"[".repeat(100_000)] {
        assert!(toml(&text).is_err());
        assert!(parse(&text, "a.json", Format::Json).is_err());
    }
    let json = "{\"a\":".repeat(100_000);
    assert!(parse(&json, "a.json", Format::Json).is_err());
    let many: String = (0..50_000).map(|i| format!("k{i} = 1\n")).collect();
    assert!(toml(&many).unwrap_err().others.len() < 100);
}

fn numbers<const N: usize>(range: std::ops::Range<f64>) -> impl Strategy<Value = [f64; N]> {
    proptest::collection::vec(range, N).prop_map(|v| v.try_into().unwrap())
}

fn pose_strategy() -> impl Strategy<Value = Pose> {
    (numbers::<3>(-1e6..1e6), numbers::<3>(-360.0..360.0))
        .prop_map(|(position, rotation)| Pose { position, rotation })
}

fn rectangle_strategy() -> impl Strategy<Value = Rectangle> {
    (pose_strategy(), numbers::<2>(1e-6..1e6)).prop_map(|(pose, size)| Rectangle { pose, size })
}

fn shape_strategy() -> impl Strategy<Value = Shape> {
    let length = 1e-6..1e6f64;
    let facing = prop_oneof![Just(Facing::Convex), Just(Facing::Concave)];
    prop_oneof![
        length.clone().prop_map(|radius| Shape::Sphere { radius }),
        numbers::<3>(length.clone()).prop_map(|radii| Shape::Ellipsoid { radii }),
        numbers::<3>(length.clone()).prop_map(|size| Shape::Box { size }),
        numbers::<2>(length.clone())
            .prop_map(|[radius, height]| Shape::Cylinder { radius, height }),
        numbers::<3>(length.clone()).prop_map(|[radius, top_radius, height]| Shape::Cone {
            radius,
            top_radius,
            height
        }),
        numbers::<2>(length.clone()).prop_map(|size| Shape::Plane { size }),
        (numbers::<3>(length.clone()), facing.clone()).prop_map(|([radius, a, b], facing)| {
            Shape::CylinderMirror { radius, size: [a, b], facing }
        }),
        (numbers::<2>(length.clone()), facing).prop_map(|([radius, diameter], facing)| {
            Shape::SphereMirror { radius, diameter, facing }
        }),
        (
            prop_oneof![
                "[^\\x00]{1,20}".prop_map(|f| HeightSource::File(f.into())),
                (2..4usize, 2..4usize)
                    .prop_flat_map(|(w, h)| proptest::collection::vec(
                        proptest::collection::vec(-10.0..10.0f64, w),
                        h
                    ))
                    .prop_map(HeightSource::Samples),
            ],
            numbers::<4>(length)
        )
            .prop_map(|(source, [w, h, amplitude, depth])| Shape::HeightField {
                source,
                size: [w, h],
                amplitude,
                depth
            }),
        (
            "[^\\x00]{1,20}",
            1e-9..1e9f64,
            prop::sample::select(tree::UNITS.to_vec()),
            0usize..1000,
            prop_oneof![
                (0.0..180.0f64).prop_map(|crease_angle| Normals::Auto { crease_angle }),
                Just(Normals::Smooth),
                Just(Normals::Flat)
            ]
        )
            .prop_map(|(file, scale, (_, unit), smoothing, normals)| Shape::Mesh {
                file: file.into(),
                scale,
                unit,
                smoothing,
                normals
            }),
    ]
}

fn material_strategy() -> impl Strategy<Value = Material> {
    let index = prop_oneof![
        (1.0..5.0).prop_map(Index::Constant),
        (1.2..2.0, 0.0..0.02).prop_map(|(a, b)| Index::Cauchy(a, b)),
        prop::sample::select(crate::optics::glass::names().collect::<Vec<_>>())
            .prop_map(|name| Index::Glass(name.to_owned())),
        "[^\\x00]{1,20}".prop_map(|file| Index::File(file.into())),
    ];
    prop_oneof![
        (index, prop::option::of(numbers::<3>(0.0..10.0)))
            .prop_map(|(index, absorption)| Material::Refractive { index, absorption }),
        numbers::<3>(0.0..1.0).prop_map(|reflectance| Material::Mirror { reflectance }),
    ]
}

fn element_strategy() -> impl Strategy<Value = Element> {
    (any::<String>(), shape_strategy(), pose_strategy(), material_strategy(), any::<Option<i32>>())
        .prop_map(|(name, shape, pose, material, priority)| Element {
            name,
            shape,
            pose,
            material,
            priority,
            hollow: None,
        })
}

pub(in crate::scene) fn scene_strategy() -> impl Strategy<Value = Scene> {
    let lengths = (numbers::<2>(1e-6..1e6), 0.0..1e3, 0.0..0.99);
    let slit = (lengths, -360.0..360.0, numbers::<3>(0.0..1.0), 1.0..5.0).prop_map(
        |(([pitch, layer_depth], cover_glass, share), azimuth, reflectance, ior)| {
            PlateModel::SlitMirror(SlitMirror {
                pitch,
                layer_depth,
                azimuth,
                reflectance,
                ior,
                absorption: reflectance.map(|r| 0.01 * r),
                cover_glass,
                mirror_thickness: share * pitch,
            })
        },
    );
    let display = (
        (1..=32768usize, 1..=32768usize),
        proptest::option::of(pose_strategy()),
        proptest::option::of(numbers::<2>(1e-6..1e6)),
        (
            numbers::<3>(380.0..780.0),
            prop_oneof![
                Just(ResponseSource::Srgb),
                (0.2..10.0).prop_map(ResponseSource::Gamma),
                Just(ResponseSource::File("bench.csv".into()))
            ],
            proptest::option::of(numbers::<3>(0.0..0.5)),
            proptest::option::of(1..=16u32),
        ),
    )
        .prop_map(|((w, h), pose, size, (wavelengths, response, black, bits))| {
            let emission = bits.map(|_| "angles.csv".into());
            let polarisation = bits.map(|bits| f64::from(bits) * 7.5 - 60.0);
            Display {
                resolution: [w, h],
                pose,
                size,
                wavelengths,
                response,
                emission,
                polarisation,
                black,
                bits,
            }
        });
    (
        (any::<String>(), 1..=10_000usize, any::<bool>(), numbers::<3>(-1e6..1e6)),
        rectangle_strategy(),
        (rectangle_strategy(), prop_oneof![Just(PlateModel::Ideal), slit]),
        display,
        (
            proptest::collection::vec(element_strategy(), 0..4),
            proptest::option::of((pose_strategy(), numbers::<3>(-1e6..1e6))),
        ),
    )
        .prop_map(|(top, image, (rectangle, model), display, (elements, tracker))| Scene {
            name: top.0,
            max_interactions: top.1,
            follow_total_reflection: top.2,
            viewpoint: top.3,
            image,
            plate: Plate { rectangle, model, luminance: Some("bench.csv".into()) },
            display,
            elements,
            tracker: tracker.map(|(pose, offset)| Tracker { pose, offset }),
        })
}
