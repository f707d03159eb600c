//! Drawings as other programs read them.

use super::*;
use midair::evaluate::layout::Layout;
use midair::scene::{Format, load_text};
use midair::transport::Setup;

fn layout(eye: &str) -> Layout {
    let text = format!(
        "[viewpoint]\nposition = {eye}\n[image]\nsize = [30.0, 30.0]\n[plate]\nposition = [0.0, 0.0, -150.0]\n\
         rotation = [-45.0, 0.0, 0.0]\nsize = [200.0, 200.0]\n[display]\nresolution = [64, 64]\n[[element]]\n\
         name = \"cube & <box>\"\nshape = {{ kind = \"box\", size = [50.0, 50.0, 50.0] }}\nmaterial = {{ ior = 1.49 }}\n"
    );
    Layout::of(
        &Setup::new(
            &load_text(&text, "bench.toml", Format::Toml, &midair::scene::InMemory::new()).unwrap(),
        )
        .unwrap(),
    )
}

/// The ends of all straight lines of two points with a stroke of this colour, on the sheet.
fn lines(svg: &str, stroke: &str) -> Vec<Vec<[f64; 2]>> {
    let document = roxmltree::Document::parse(svg).unwrap();
    let of_colour = |node: &roxmltree::Node| {
        node.has_tag_name("path") && node.attribute("stroke") == Some(stroke)
    };
    document
        .descendants()
        .filter(of_colour)
        .map(|node| {
            let d = node.attribute("d").unwrap().trim_start_matches('M').trim_end_matches('z');
            let number = |c: &str| c.parse::<f64>().unwrap();
            d.split('L')
                .map(|p| p.split_once(' ').unwrap())
                .map(|(x, y)| [number(x), number(y)])
                .collect()
        })
        .collect()
}

#[test]
fn the_drawing_is_to_the_scale_that_it_names() {
    let svg = drawing(&layout("[0.0, 0.0, 800.0]"), "A & B");
    let document = roxmltree::Document::parse(&svg).unwrap();
    let told: Vec<&str> = document.descendants().filter_map(|n| n.text()).collect();
    let scale = told.iter().find_map(|t| t.strip_prefix("scale 1 : ")).unwrap();
    let scale: f64 = scale.split(' ').next().unwrap().parse().unwrap();
    let root = document.root_element();
    assert_eq!(
        (root.attribute("width"), root.attribute("viewBox")),
        (Some("210mm"), Some("0 0 210 297"))
    );
    // The plate is 200 mm square at 45 degrees: in both views its longest extent along the sheet is known.
    let plates = lines(&svg, ink(Role::Plate));
    let extent = |line: &Vec<[f64; 2]>, axis: usize| {
        let all = line.iter().map(|p| p[axis]);
        all.clone().fold(f64::NEG_INFINITY, f64::max) - all.fold(f64::INFINITY, f64::min)
    };
    let slanted = 200.0 * 0.5f64.sqrt() / scale;
    let whole = 200.0 / scale;
    let mut compared = 0;
    for line in &plates {
        // Coordinates are written to a hundredth of a millimetre.
        assert!((extent(line, 0) - slanted).abs() < 0.021, "{line:?}");
        let height = extent(line, 1);
        assert!((height - slanted).abs() < 0.021 || (height - whole).abs() < 0.021, "{line:?}");
        compared += 1;
    }
    assert!(compared >= 3, "{compared}");
    // Distances between the middles: 150 along both axes of the side view, and none in the top view.
    assert!(told.iter().filter(|t| **t == "150").count() >= 2, "{told:?}");
    assert!(told.contains(&"cube & <box>") && told.contains(&"A & B"));
}

#[test]
fn everything_lies_on_the_sheet_wherever_the_eye_is() {
    for eye in ["[0.0, 0.0, 800.0]", "[0.0, 0.0, 9000.0]", "[30.0, 60.0, 300.0]"] {
        let layout = layout(eye);
        for (svg, least) in [(drawing(&layout, "x"), 40), (picture(&layout, "x"), 15)] {
            let document = roxmltree::Document::parse(&svg).unwrap();
            let bounds: Vec<f64> = document
                .root_element()
                .attribute("viewBox")
                .unwrap()
                .split(' ')
                .map(|c| c.parse().unwrap())
                .collect();
            let mut points = 0;
            for colour in [
                ink(Role::Display),
                ink(Role::Plate),
                ink(Role::Image),
                ink(Role::Solid),
                LIGHT,
                INK,
            ] {
                for [x, y] in lines(&svg, colour).concat() {
                    assert!(
                        (0.0..=bounds[2]).contains(&x) && (0.0..=bounds[3]).contains(&y),
                        "{eye} {colour} {x} {y}"
                    );
                    points += 1;
                }
            }
            assert!(points > least, "{eye}: {points}");
            assert!(!lines(&svg, LIGHT).is_empty());
        }
    }
}
