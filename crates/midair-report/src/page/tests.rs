//! Pages, read back by an XML parser and a PNG decoder.

use std::path::Path;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use proptest::prelude::*;

use super::chart::{label, ticks};
use super::*;
use midair::picture::{Picture, decode_still};

/// The page as a tree; pages are written so that they are well-formed XML too.
fn with_tree<T>(html: &str, check: impl FnOnce(&roxmltree::Document<'_>) -> T) -> T {
    let xml = html.strip_prefix("<!doctype html>\n").unwrap();
    check(&roxmltree::Document::parse(xml).unwrap())
}

fn page_of(text: &str) -> Page {
    let cell = || Cell::text(text).best();
    let table = Table {
        caption: text.to_owned(),
        head: vec![vec![(text.to_owned(), 1), (text.to_owned(), 2)]],
        rows: vec![vec![cell(), cell(), Cell::number(Some(1.5), 2)]],
        foot: vec![vec![cell(), cell(), Cell::number(None, 2)]],
    };
    let chart = LineChart {
        x_label: text.to_owned(),
        y_label: text.to_owned(),
        series: vec![Series { name: text.to_owned(), points: vec![[0.0, 1.0], [1.0, 2.0]] }],
    };
    let vectors = VectorChart {
        size: [200.0, 100.0],
        lines: 2,
        reference: vec![Some([20.0, 20.0]), Some([180.0, 20.0]), None, Some([180.0, 80.0])],
        seen: vec![Some([23.0, 20.0]), None, None, Some([180.0, 80.0])],
    };
    let figure = |image| Figure { image, caption: text.to_owned() };
    let picture = Picture::filled(3, 2, [1.0, 0.0, 0.0, 1.0]);
    Page {
        title: text.to_owned(),
        lead: text.to_owned(),
        summary: vec![SummaryRow { label: text.into(), value: text.into(), note: text.into() }],
        sections: vec![Section {
            heading: text.to_owned(),
            blocks: vec![
                Block::Text(text.to_owned()),
                Block::Figures(vec![
                    Figure::picture(&picture, text).unwrap(),
                    figure(Image::Line(chart)),
                    figure(Image::Vectors(vectors)),
                ]),
                Block::Table(table),
                Block::Notes(vec![text.to_owned()]),
            ],
        }],
        colophon: text.to_owned(),
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    #[test]
    fn any_text_arrives_as_text(text in "[ -~äπ\u{1F600}<>&\"']{1,30}") {
        with_tree(&page_of(&text).to_html(), |tree| {
            for name in ["title", "h1", "h2", "dt", "li", "caption", "footer"] {
                let node = tree.descendants().find(|node| node.has_tag_name(name)).unwrap();
                assert_eq!(node.text(), Some(text.as_str()), "{name}");
                assert!(node.children().all(|child| child.is_text()));
            }
            let image = tree.descendants().find(|node| node.has_tag_name("img")).unwrap();
            assert_eq!(image.attribute("alt"), Some(text.as_str()));
        });
    }

    #[test]
    fn ticks_span_the_range_at_a_round_step(
        from in -1e6_f64..1e6,
        span in 1e-6_f64..1e6,
        count in 2_usize..9,
    ) {
        let found = ticks(from, from + span, count);
        prop_assert!(found.len() >= 2 && found.len() <= count + 2, "{:?}", found);
        let step = found[1] - found[0];
        prop_assert!(found[0] <= from + 1e-6 * step && found[found.len() - 1] >= from + span - 1e-6 * step);
        prop_assert!(found[0] > from - 1.001 * step);
        // Differences of numbers up to 1e6 at steps from 1e-7 keep four digits.
        let mantissa = step / 10_f64.powf((step * 1.001).log10().floor());
        prop_assert!([1.0, 2.0, 5.0].iter().any(|m| (mantissa / m - 1.0).abs() < 2e-3), "{}", step);
    }
}

#[test]
fn nothing_is_loaded_from_elsewhere_and_nothing_runs() {
    let html = page_of("javascript:alert(1)").to_html();
    with_tree(&html, |tree| {
        for node in tree.descendants() {
            assert!(!["script", "link", "iframe", "object", "a"].contains(&node.tag_name().name()));
            for attribute in node.attributes() {
                match attribute.name() {
                    "src" => assert!(attribute.value().starts_with("data:image/png;base64,")),
                    name => assert!(!name.starts_with("on") && name != "href" && name != "style"),
                }
            }
        }
    });
    assert!(!html.contains("url(") && !html.contains("@import"));
}

#[test]
fn control_characters_are_replaced() {
    let html = page_of("a\0b\u{1b}[31m").to_html();
    with_tree(&html, |tree| {
        let title = tree.descendants().find(|node| node.has_tag_name("title")).unwrap();
        assert_eq!(title.text(), Some("a\u{fffd}b\u{fffd}[31m"));
    });
}

#[test]
fn a_picture_comes_back_from_the_page() {
    let mut picture = Picture::filled(5, 4, [0.0, 0.0, 0.0, 1.0]);
    picture.pixels[7] = [1.0, 0.214_041, 0.0, 1.0];
    let figure = Figure::picture(&picture, "").unwrap();
    let section = Section { heading: String::new(), blocks: vec![Block::Figures(vec![figure])] };
    let html = Page { sections: vec![section], ..Page::default() }.to_html();
    let bytes = with_tree(&html, |tree| {
        let image = tree.descendants().find(|node| node.has_tag_name("img")).unwrap();
        let data = image.attribute("src").unwrap().split_once(',').unwrap().1;
        STANDARD.decode(data).unwrap()
    });
    let still = decode_still(Path::new("picture.png"), &bytes).unwrap();
    assert_eq!((still.picture.width, still.picture.height), (5, 4));
    let [r, g, b, _] = still.picture.pixels[7];
    // One of 256 codes: sRGB 0.5 is between 127 and 128.
    assert!((r - 1.0).abs() < 1e-6 && (g - 0.214).abs() < 0.004 && b == 0.0);
    assert!(Figure::picture(&Picture::filled(0, 4, [0.0; 4]), "").is_err());
}

#[test]
fn points_lie_where_the_axes_say() {
    let series = |points: Vec<[f64; 2]>| Series { name: "a".to_owned(), points };
    let chart = LineChart {
        x_label: "x".to_owned(),
        y_label: "y".to_owned(),
        series: vec![series(vec![[-15.0, 0.0], [0.0, 40.0], [5.0, f64::NAN], [15.0, 80.0]])],
    };
    let svg = chart.to_svg();
    let tree = roxmltree::Document::parse(&svg).unwrap();
    let number = |node: roxmltree::Node<'_, '_>, name: &str| -> f64 {
        node.attribute(name).unwrap().parse().unwrap()
    };
    let place = |node| [number(node, "cx"), number(node, "cy")];
    let marks: Vec<[f64; 2]> =
        tree.descendants().filter(|node| node.has_tag_name("circle")).map(place).collect();
    // The legend's mark comes last.
    let [a, b, c, _] = marks[..] else { panic!("{marks:?}") };
    // Coordinates are written to a hundredth.
    assert!((b[0] - 0.5 * (a[0] + c[0])).abs() < 0.02 && (b[1] - 0.5 * (a[1] + c[1])).abs() < 0.02);
    assert!(a[0] < c[0] && a[1] > c[1]);
    // As a file it has the same shapes, and colours that are written out.
    let file = chart.to_svg_file();
    let alone = roxmltree::Document::parse(&file).unwrap();
    assert_eq!(alone.root_element().tag_name().namespace(), Some("http://www.w3.org/2000/svg"));
    let circles = |tree: &roxmltree::Document<'_>| {
        tree.descendants().filter(|node| node.tag_name().name() == "circle").count()
    };
    assert_eq!(circles(&alone), circles(&tree));
    assert!(file.contains(".s0 { stroke: #") && file.contains("fill=\"#"), "{file}");
    assert!(!file.contains("var(") && !file.contains("svg ."), "{file}");
    let texts: Vec<&str> = tree.descendants().filter_map(|node| node.text()).collect();
    assert!(texts.contains(&"80") && texts.contains(&"−15"), "{texts:?}");
    let curves = tree.descendants().filter(|node| node.attribute("class") == Some("curve s0"));
    let lines: Vec<_> =
        curves.map(|node| node.attribute("d").unwrap().matches('L').count()).collect();
    // From the first point to the second, and the legend's: NaN interrupts the curve, and one point alone is but a mark.
    assert_eq!(lines, [1, 1]);
    // Empty and flat charts are drawn, without NaN.
    for points in [vec![], vec![[3.0, 0.0]], vec![[1.0, f64::INFINITY]]] {
        let svg = LineChart { series: vec![series(points)], ..LineChart::default() }.to_svg();
        assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
    }
}

#[test]
fn labels_have_the_decimals_of_their_step() {
    assert_eq!(label(0.25, 0.05), "0.25");
    assert_eq!(label(-20.0, 10.0), "−20");
    assert_eq!(label(0.30000000000000004, 0.1), "0.3");
}

#[test]
fn arrows_are_exaggerated_by_a_stated_round_number() {
    let chart = |length: f64| VectorChart {
        size: [700.0, 700.0],
        lines: 7,
        reference: vec![Some([100.0, 100.0]), Some([200.0, 100.0])],
        seen: vec![Some([100.0 + length, 100.0]), None],
    };
    // Spacing 100 px: 3 px times 20 stays below it, times 50 does not.
    assert_eq!(chart(3.0).exaggeration(), 20.0);
    assert_eq!(chart(0.02).exaggeration(), 5000.0);
    assert_eq!(chart(170.0).exaggeration(), 1.0);
    // What is rounding is not blown up, and said to be nothing.
    assert_eq!(chart(1e-5).exaggeration(), 1.0);
    assert!(chart(1e-5).to_svg().contains("no displacement is longer than"));
    let svg = chart(3.0).to_svg();
    // 480 units for 700 px: the tip at (100 + 20 * 3) px.
    assert!(
        svg.contains(&format!("M{:.2} {:.2}L", 480.0 / 700.0 * 160.0, 480.0 / 700.0 * 100.0)),
        "{svg}"
    );
    assert!(svg.contains("arrows 20 ×") && svg.contains("1 not found"));
}

#[test]
fn a_page_is_written_whole_or_not_at_all() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("report.html");
    let page = page_of("a");
    page.write_atomically(&path).unwrap();
    assert_eq!(std::fs::read_to_string(&path).unwrap(), page.to_html());
    let missing = folder.path().join("none").join("report.html");
    let error = page.write_atomically(&missing).unwrap_err().to_string();
    assert!(error.contains("none"), "{error}");
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
}
