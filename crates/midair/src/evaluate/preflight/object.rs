//! The objects against the image's light: what no path meets, what the image sticks out of, and what the eye stands in.

use super::bodies::boxes_meet;
use super::finding::{Finding, Kind, Severity};
use super::places;
use crate::evaluate::percent;
use crate::transport::{Action, Element, Matter, Path, Setup};

/// Places along each edge of the image.
const EDGE: usize = 64;

pub(super) fn findings(setup: &Setup) -> Vec<Finding> {
    let mut findings = eye_inside(setup);
    findings.extend(unmet(setup));
    findings.extend(sticks_out(setup));
    findings
}

fn solids(setup: &Setup) -> impl Iterator<Item = &Element> {
    setup.elements.iter().filter(|e| matches!(e.matter, Matter::Refractive { .. }))
}

/// A scene file that says so is refused; a set-up that a program made is told.
fn eye_inside(setup: &Setup) -> Vec<Finding> {
    let described = setup.elements.iter().filter(|element| element.inside_of.is_none());
    described
        .filter(|element| element.holds(setup.viewpoint))
        .map(|element| {
            let sentence = format!("the viewpoint lies inside \"{}\"", element.name);
            Finding::new(Kind::EyeInside, Severity::Fault, sentence)
                .remedy("move the viewpoint out of it")
        })
        .collect()
}

/// Elements that no path to the image meets, but for those that belong to one that is met: a vessel's other side, air above the water.
fn unmet(setup: &Setup) -> Vec<Finding> {
    let mut met = vec![false; setup.elements.len()];
    let mut path = Path::new();
    for uv in places() {
        setup.transport(uv, &mut path);
        for step in path.iter().filter(|step| step.action != Action::Plate) {
            met[usize::from(step.element)] = true;
        }
    }
    let mut findings = Vec::new();
    for (i, element) in setup.elements.iter().enumerate() {
        let belongs = || (0..met.len()).any(|j| met[j] && boxes_meet(element, &setup.elements[j]));
        if met[i] || element.inside_of.is_some() || belongs() {
            continue;
        }
        let sentence = format!("no light between the image and the eye meets \"{}\"", element.name);
        findings.push(Finding::new(Kind::Unmet, Severity::Warning, sentence).remedy(
            "it stands beside the way from the viewpoint through the image to the plate: move it there, or the image into it, or leave it out",
        ));
    }
    findings
}

/// An image whose middle lies in a solid and whose edge does not.
fn sticks_out(setup: &Setup) -> Option<Finding> {
    let inside = |uv: [f64; 2]| solids(setup).find(|e| e.holds(setup.image.point(uv)));
    let object = inside([0.5; 2])?;
    let edge = |scale: f64| {
        (0..4 * EDGE).map(move |k| {
            let along = (k % EDGE) as f64 / EDGE as f64;
            let [u, v] =
                [[along, 0.0], [1.0, along], [1.0 - along, 1.0], [0.0, 1.0 - along]][k / EDGE];
            [(u - 0.5) * scale + 0.5, (v - 0.5) * scale + 0.5]
        })
    };
    let out = edge(1.0).filter(|&uv| inside(uv).is_none()).count();
    if out == 0 {
        return None;
    }
    let (mut small, mut large) = (0.0, 1.0);
    // To a thousandth of the image.
    for _ in 0..10 {
        let middle = 0.5 * (small + large);
        *if edge(middle).all(|uv| inside(uv).is_some()) { &mut small } else { &mut large } = middle;
    }
    let [w, h] = setup.image.size;
    let fits = [w, h].map(|side| (side * small * 10.0).floor() / 10.0);
    let share = percent(out as f64 / (4 * EDGE) as f64);
    let finding = Finding::new(
        Kind::SticksOut,
        Severity::Warning,
        format!(
            "the image ({w} x {h} mm) sticks out of \"{}\": {share} of its edge is in the open, and jumps there as the viewer moves",
            object.name
        ),
    );
    Some(if fits.iter().all(|&side| side >= 1.0) {
        finding
            .remedy(format!("about its centre, {} x {} mm fit in", fits[0], fits[1]))
            .line("image.size", fits)
    } else {
        finding.remedy("move the image to the middle of its object")
    })
}
