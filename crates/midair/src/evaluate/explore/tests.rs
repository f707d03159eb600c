//! Explorations against what is known of them in closed form.

use super::*;
use crate::scene::{Format, InMemory, load_text};

/// A bare plate, or one with something before it.
fn scene(elements: &str) -> Loaded {
    let text = format!(
        "[viewpoint]\nposition = [0.0, 0.0, 800.0]\n[image]\nsize = [20.0, 10.0]\n\
         [plate]\nposition = [0.0, 0.0, -150.0]\nrotation = [-45.0, 0.0, 0.0]\nsize = [400.0, 400.0]\n{elements}"
    );
    load_text(&text, "bench.toml", Format::Toml, &InMemory::new()).unwrap()
}

const BALL: &str = "[[element]]\nname = \"ball\"\nshape = { kind = \"sphere\", radius = 25.0 }\nmaterial = { ior = 1.49 }\n";

fn axes(texts: &[&str]) -> Vec<Axis> {
    texts.iter().map(|text| text.parse().unwrap()).collect()
}

fn settings() -> Settings {
    Settings::default().resolution(32)
}

#[test]
fn axes_and_limits_are_read_or_refused_with_what_to_write() {
    let axis: Axis = "image.position.z = -20..20:5".parse().unwrap();
    assert_eq!(
        axis,
        Axis { path: "image.position.z".to_owned(), values: vec![-20.0, -10.0, 0.0, 10.0, 20.0] }
    );
    let axis: Axis = "a=1,2.5,-3".parse().unwrap();
    assert_eq!(axis.values, [1.0, 2.5, -3.0]);
    let limit: Limit = "a=-1..1".parse().unwrap();
    assert_eq!(limit.range, [-1.0, 1.0]);
    for (text, word) in [
        ("a", "no key and value"),
        ("=1..2:3", "no key and value"),
        ("a=1..2", "how many"),
        ("a=1..x:3", "no interval"),
        ("a=1..2:1", "between 2 and"),
        ("a=1,inf", "no number"),
    ] {
        let message = text.parse::<Axis>().unwrap_err().to_string();
        assert!(message.contains(word) && message.contains("PATH="), "{message}");
    }
    assert!("a=2..1".parse::<Limit>().is_err());
}

#[test]
fn a_bare_plate_forms_all_of_its_image_at_its_own_size() {
    let found = explore(
        &scene(""),
        &axes(&["image.position.x=-5..5:3", "image.size=10,20"]),
        &settings(),
        &InMemory::new(),
        &(),
    )
    .unwrap();
    assert_eq!(found.points.len(), 6);
    for point in &found.points {
        let measured = point.outcome.as_ref().unwrap();
        assert_eq!((measured.formed, measured.folded), (1.0, 0.0));
        // Proportions stay: 10 x 5 and 20 x 10.
        assert!((measured.formed_area - point.values[1] * point.values[1] / 2.0).abs() < 1e-9);
        for magnification in [measured.least_magnification, measured.largest_magnification] {
            assert!((magnification - 1.0).abs() < 1e-9, "{magnification}");
        }
        assert!((measured.mean_gain - 1.0).abs() < 1e-9 && (measured.evenness - 1.0).abs() < 1e-9);
    }
    // The larger image is the better one.
    assert_eq!(found.points[found.best(1)[0]].values[1], 20.0);
}

/// Beyond the display's edge nothing is formed: the share that is left has a closed form.
#[test]
fn a_display_that_is_too_small_shows_its_share_of_the_image() {
    let display = "[display]\nsize = [10.0, 10.0]\n";
    let settings = settings().resolution(100);
    let found = explore(
        &scene(display),
        &axes(&["display.size=5..20:4"]),
        &settings,
        &InMemory::new(),
        &(),
    )
    .unwrap();
    for point in &found.points {
        let side = point.values[0];
        let share = (side / 20.0).min(1.0) * (side / 10.0).min(1.0);
        let measured = point.outcome.as_ref().unwrap();
        // Image points in hundredths along each side.
        assert!((measured.formed - share).abs() < 0.011, "{side}: {} {share}", measured.formed);
        assert!((measured.formed + measured.missed_display - 1.0).abs() < 1e-12);
    }
}

/// How far the eye may move, against rays from where it then stands.
#[test]
fn the_viewer_may_move_until_a_twentieth_is_lost() {
    let loaded = scene(BALL);
    let found =
        explore(&loaded, &axes(&["image.size=10,30"]), &settings(), &InMemory::new(), &()).unwrap();
    let mut compared = 0;
    for point in &found.points {
        let measured = point.outcome.as_ref().unwrap();
        let mut edit = SceneEdit::of(&loaded.text).unwrap();
        edit.set("image.size", [point.values[0], point.values[0] / 2.0]).unwrap();
        let setup = Setup::new(&loaded.changed(&edit, &InMemory::new()).unwrap()).unwrap();
        let at = |i: usize| (i as f64 + 0.5) / 12.0;
        let is_formed_from = |x: f64, i: usize| {
            let step = crate::geometry::Vec3::new(x, 0.0, 0.0);
            let there = setup.with_viewpoint(setup.viewpoint + step);
            let end = there.transport([at(i % 12), at(i / 12)], &mut crate::transport::Path::new());
            end.formed().is_some()
        };
        let formed: Vec<usize> = (0..144).filter(|&i| is_formed_from(0.0, i)).collect();
        let lost = |x: f64| formed.iter().filter(|&&i| !is_formed_from(x, i)).count() as f64;
        let (all, x) = (formed.len() as f64, measured.sideways);
        if x < 799.0 {
            let beyond = x + 800.0 / 16.0 / 128.0;
            let lost = lost(beyond).max(lost(-beyond));
            assert!(lost >= 0.05 * all, "{x}: {lost} of {all}");
            compared += 1;
        }
        let near = lost(0.98 * x).max(lost(-0.98 * x));
        assert!(near < 0.05 * all, "{x}: {near} of {all}");
    }
    assert!(compared > 0);
}

/// A display that is large enough for the image, and one that is not: the first kind is known without being looked at.
#[test]
fn where_neighbours_agree_what_lies_between_is_interpolated() {
    let loaded = scene("[display]\nsize = [10.0, 10.0]\n");
    let axes = axes(&["display.size=4..68:33", "image.position.x=-1..1:5"]);
    let settings = settings().settle(0.01);
    let found = explore(&loaded, &axes, &settings, &InMemory::new(), &()).unwrap();
    let mut skipped = 0;
    for point in &found.points {
        let side = point.values[0];
        let share = (side / 20.0).min(1.0) * (side / 10.0).min(1.0);
        let measured = point.outcome.as_ref().unwrap();
        // 32 image points along each side, each a thirty-second, of which one may lie on the border; the centres stay where they are.
        assert!((measured.formed - share).abs() < 2.0 / 32.0, "{:?}: {share}", point);
        assert!(!point.interpolated || side > 20.0, "{point:?}");
        skipped += usize::from(point.interpolated);
    }
    assert!(skipped > 40 && skipped < found.points.len() / 2 + 60, "{skipped}");
}

#[test]
fn what_cannot_be_says_why_and_a_misspelt_key_is_told_at_once() {
    let loaded = scene(BALL);
    let found = explore(
        &loaded,
        &axes(&["viewpoint.position.z=0,800", "element.ball.shape.radius=20,25"]),
        &settings(),
        &InMemory::new(),
        &(),
    )
    .unwrap();
    let why = found.points[0].outcome.as_ref().unwrap_err();
    assert!(why.contains("ball"), "{why}");
    assert!(found.points[3].outcome.is_ok());
    let wrong =
        explore(&loaded, &axes(&["image.positoin.z=0,1"]), &settings(), &InMemory::new(), &());
    assert!(wrong.unwrap_err().to_string().contains("positoin"));
}

#[test]
fn an_exploration_goes_on_with_what_is_known() {
    let loaded = scene(BALL);
    let axes = axes(&["image.position.x=-20..20:5"]);
    let kept = std::sync::Mutex::new(std::collections::HashMap::new());
    let keep = |number: usize, point: &Point| {
        let text = serde_json::to_string(point).unwrap();
        kept.lock().unwrap().insert(number, serde_json::from_str::<Point>(&text).unwrap());
    };
    let first =
        explore_further(&loaded, &axes, &settings(), &InMemory::new(), &(), &|_| None, &keep)
            .unwrap();
    let known = kept.lock().unwrap().clone();
    assert!(!known.is_empty());
    let never = |_: usize, _: &Point| panic!("looked at again");
    let again = explore_further(
        &loaded,
        &axes,
        &settings(),
        &InMemory::new(),
        &(),
        &|number| known.get(&number).cloned(),
        &never,
    )
    .unwrap();
    assert_eq!(format!("{first:?}"), format!("{again:?}"));
}

/// A display that is half covered by a screen before it: the image is best where all of it is beside the screen.
#[test]
fn the_search_finds_where_the_image_is_free() {
    let screen = "[[element]]\nname = \"screen\"\nshape = { kind = \"box\", size = [100.0, 100.0, 1.0] }\n\
                  position = [-50.0, 0.0, 60.0]\nmaterial = { opaque = true }\n";
    let loaded = scene(screen);
    let limits = [Limit { path: "image.position.x".to_owned(), range: [-40.0, 40.0] }];
    let found = best(&loaded, &limits, &settings(), &InMemory::new(), &()).unwrap();
    let measured = found.point.outcome.as_ref().unwrap();
    assert!(measured.formed > 0.999 && found.score > 1.5 * found.before, "{found:?}");
    // The screen's edge at x = 0 hides image points left of 0 (lines from the eye lead a little to the left behind it).
    assert!(found.point.values[0] >= 9.0, "{found:?}");
}
