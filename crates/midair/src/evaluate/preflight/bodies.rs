//! Things that stand in one another.

use super::finding::{Finding, Kind, Severity, element_key, millimetres};
use crate::geometry::{Ray, Rectangle, Vec3};
use crate::scene::model::Scene;
use crate::transport::{Element, Matter, Setup};

/// Things that touch do not stand in one another: nothing is built to a twentieth of a millimetre.
const CONTACT: f64 = 0.05;
/// Lines along each side, over the part of a rectangle (or the box) that the other thing can reach.
const LINES: usize = 64;

/// All pairs that stand in one another.
pub(super) fn findings(setup: &Setup, scene: &Scene) -> Vec<Finding> {
    let mut findings = Vec::new();
    for crowd in crowded(setup) {
        let finding = Finding::new(Kind::StandingIn, Severity::Fault, crowd.sentence(setup));
        findings.push(apart(finding, setup, scene));
    }
    findings.extend(image_in_mirrors(setup));
    for (i, a) in setup.elements.iter().enumerate() {
        for (j, b) in setup.elements.iter().enumerate().skip(i + 1) {
            let stated = |k: usize| scene.elements.get(k).is_some_and(|e| e.priority.is_some());
            // What is inside of a hollow thing is there on purpose.
            let nested = a.inside_of.is_some() || b.inside_of.is_some();
            let stated = nested || stated(i) || stated(j);
            findings.extend(two_elements(a, b, stated).or_else(|| two_elements(b, a, stated)));
        }
    }
    findings
}

/// A thing that stands in the plate, the display or the image.
#[derive(Clone, Copy, PartialEq)]
enum Crowd {
    Plate(usize),
    Display(usize),
    PlateDisplay,
    PlateImage,
    DisplayImage,
}

impl Crowd {
    fn sentence(self, setup: &Setup) -> String {
        let name = |i: usize| &setup.elements[i].name;
        match self {
            Self::Plate(i) => format!("\"{}\" and the plate stand in one another", name(i)),
            Self::Display(i) => format!("\"{}\" and the display stand in one another", name(i)),
            Self::PlateDisplay => "the plate and the display stand in one another".to_owned(),
            Self::PlateImage => "the image stands in the plate".to_owned(),
            Self::DisplayImage => "the image stands in the display".to_owned(),
        }
    }
}

fn crowded(setup: &Setup) -> Vec<Crowd> {
    let (plate, display, image) = (&setup.plate.rectangle, &setup.display, &setup.image);
    let mut crowds = Vec::new();
    // What is inside of a thing stands in no more than the thing does.
    for (i, element) in setup.elements.iter().enumerate().filter(|(_, e)| e.inside_of.is_none()) {
        if stands_in(element, plate) {
            crowds.push(Crowd::Plate(i));
        }
        if stands_in(element, display) {
            crowds.push(Crowd::Display(i));
        }
    }
    for (a, b, crowd) in [
        (plate, display, Crowd::PlateDisplay),
        (plate, image, Crowd::PlateImage),
        (display, image, Crowd::DisplayImage),
    ] {
        if cross(a, b) {
            crowds.push(crowd);
        }
    }
    crowds
}

/// What would bring plate and display clear of everything: the display to its place if it stands elsewhere, else the plate further back (and
/// the display with it, as the image is to stay).
fn apart(finding: Finding, setup: &Setup, scene: &Scene) -> Finding {
    let placed = scene.display.pose.is_some();
    if placed {
        let mut there = setup.clone();
        there.display = Rectangle { size: setup.display.size, ..setup.display_place() };
        if crowded(&there).is_empty() {
            return finding
                .remedy("put the display where the image, mirrored in the plate, lies: nothing is in the way there")
                .line("display.position", millimetres(there.display.frame.origin.to_array()))
                .line("display.rotation", super::finding::degrees(there.display.frame.rotation()));
        }
    }
    let back = -setup.plate.rectangle.frame.normal();
    let clear = (1..=100).map(|step| 5.0 * f64::from(step)).find_map(|by| {
        let mut there = setup.clone();
        there.plate.rectangle.frame.origin = there.plate.rectangle.frame.origin + back * by;
        // Mirrored in a plane that moves by `by`, the image moves by twice as much.
        there.display.frame.origin = there.display.frame.origin + back * (2.0 * by);
        crowded(&there).is_empty().then_some((by, there))
    });
    let Some((by, there)) = clear else {
        return finding.remedy(
            "move one of them: no shift of the plate along its normal by up to 500 mm clears it",
        );
    };
    let with = if placed { "the display moves with it" } else { "the display follows by itself" };
    let finding = finding
        .remedy(format!(
            "move the plate back by {by:.0} mm along its normal; {with}, and the image stays"
        ))
        .line("plate.position", millimetres(there.plate.rectangle.frame.origin.to_array()));
    if placed {
        finding.line("display.position", millimetres(there.display.frame.origin.to_array()))
    } else {
        finding
    }
}

/// Whether an element reaches through a rectangle.
///
/// Asked twice, a contact's depth before the rectangle and behind it: what merely stands on it is met on one side only.
fn stands_in(element: &Element, rectangle: &Rectangle) -> bool {
    let Some([x, y]) = window(element, rectangle) else { return false };
    let [right, up, normal] = rectangle.frame.axes;
    [-CONTACT, CONTACT].into_iter().all(|off| {
        let origin = rectangle.frame.origin + normal * off;
        let line = |k: usize, across: [f64; 2], along: [f64; 2], a: Vec3, b: Vec3| {
            let share = (k as f64 + 0.5) / LINES as f64;
            let place = across[0] + share * (across[1] - across[0]);
            let ray = Ray { origin: origin + a * place + b * along[0], direction: b };
            met(element, &ray, along[1] - along[0])
        };
        (0..LINES).any(|k| line(k, x, y, right, up) || line(k, y, x, up, right))
    })
}

/// Whether a line of this length meets an element, and not only at its ends.
fn met(element: &Element, ray: &Ray, length: f64) -> bool {
    let local = ray.to_local(&element.frame);
    if element.shape.is_solid() {
        let chords = element.shape.chords(&local);
        chords.iter().any(|&[enter, leave]| leave.min(length) - enter.max(0.0) > CONTACT)
    } else {
        element.shape.meetings(&local).iter().any(|&t| t > 0.0 && t < length)
    }
}

/// The part of a rectangle that an element can reach: from and to along its x and its y, mm. `None`: no part.
fn window(element: &Element, rectangle: &Rectangle) -> Option<[[f64; 2]; 2]> {
    let mut reach = [[f64::INFINITY, f64::NEG_INFINITY]; 3];
    for corner in corners(element) {
        let local = rectangle.frame.to_local(corner).to_array();
        for (span, c) in reach.iter_mut().zip(local) {
            *span = [span[0].min(c), span[1].max(c)];
        }
    }
    let [x, y, z] = reach;
    // A flat mirror's box has no thickness: a contact's depth to either side gives lines a way through it.
    let within = |span: [f64; 2], size: f64| {
        let half = 0.5 * size - CONTACT;
        let span = [(span[0] - CONTACT).max(-half), (span[1] + CONTACT).min(half)];
        (span[0] < span[1]).then_some(span)
    };
    if z[0] > -CONTACT || z[1] < CONTACT {
        return None;
    }
    Some([within(x, rectangle.size[0])?, within(y, rectangle.size[1])?])
}

/// The corners of an element's box, in the world.
pub(super) fn corners(element: &Element) -> [Vec3; 8] {
    let [low, high] = element.shape.bounds();
    std::array::from_fn(|k| {
        let pick = |bit: usize, a: f64, b: f64| if k >> bit & 1 == 0 { a } else { b };
        let corner =
            Vec3::new(pick(0, low.x, high.x), pick(1, low.y, high.y), pick(2, low.z, high.z));
        element.frame.to_world(corner)
    })
}

/// Whether two rectangles cut through one another. Where they do, an edge of one goes through the other.
fn cross(a: &Rectangle, b: &Rectangle) -> bool {
    let edges_through = |a: &Rectangle, b: &Rectangle| {
        let corner = |k: usize| a.point([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]][k % 4]);
        (0..4).any(|k| {
            let [p, q] = [corner(k), corner(k + 1)];
            let height = |p: Vec3| (p - b.frame.origin).dot(b.frame.normal());
            let [from, to] = [height(p), height(q)];
            // From one side to the other, each further than a contact.
            if from.abs().min(to.abs()) <= CONTACT || (from > 0.0) == (to > 0.0) {
                return false;
            }
            let local = b.frame.to_local(p + (q - p) * (from / (from - to)));
            local.x.abs() < 0.5 * b.size[0] - CONTACT && local.y.abs() < 0.5 * b.size[1] - CONTACT
        })
    };
    edges_through(a, b) || edges_through(b, a)
}

/// Mirrors that cut the image: what is behind them is not where it seems.
fn image_in_mirrors(setup: &Setup) -> Vec<Finding> {
    let mut findings = Vec::new();
    for mirror in setup.mirrors() {
        if !stands_in(mirror, &setup.image) {
            continue;
        }
        let sentence = format!("the image stands in the mirror \"{}\"", mirror.name);
        let finding = Finding::new(Kind::StandingIn, Severity::Warning, sentence);
        // Off the mirror, on the side that it faces, by as little as clears it.
        let [w, h] = setup.image.size;
        let clear = (1..=(w + h).ceil().min(2000.0) as usize).find_map(|by| {
            let mut image = setup.image;
            image.frame.origin = image.frame.origin + mirror.frame.normal() * by as f64;
            (!stands_in(mirror, &image)).then_some((by, image.frame.origin))
        });
        findings.push(match clear {
            Some((by, origin)) => finding
                .remedy(format!("raise the image by {by} mm off the mirror"))
                .line("image.position", millimetres(origin.to_array())),
            None => finding.remedy("move the image off the mirror"),
        });
    }
    findings
}

/// Two elements of which `a` is a solid, if they cut one another.
fn two_elements(a: &Element, b: &Element, stated: bool) -> Option<Finding> {
    let solid = |e: &Element| matches!(e.matter, Matter::Refractive { .. });
    if !solid(a) || !boxes_meet(a, b) {
        return None;
    }
    // Of b: how much lies in a, and how much outside; of a: how much lies outside b.
    let (mut within, mut outside, mut of_a_outside) = (0.0f64, 0.0f64, 0.0f64);
    for ray in lines_through(b) {
        let in_a = a.shape.chords(&ray.to_local(&a.frame));
        if solid(b) {
            let in_b = b.shape.chords(&ray.to_local(&b.frame));
            for &chord in &in_b {
                let shared = shared(chord, &in_a);
                within = within.max(shared);
                outside = outside.max(chord[1] - chord[0] - shared);
            }
            for chord in in_a {
                of_a_outside = of_a_outside.max(chord[1] - chord[0] - shared(chord, &in_b));
            }
        } else {
            for t in b.shape.meetings(&ray.to_local(&b.frame)) {
                // How deep in a the sheet is there: what stands on its surface is not in it.
                let depth = in_a.iter().map(|c| (t - c[0]).min(c[1] - t)).fold(-1.0, f64::max);
                if depth > CONTACT {
                    within = within.max(depth);
                } else if depth < 0.0 {
                    outside = 1.0;
                }
            }
            of_a_outside = 1.0;
        }
    }
    if [within, outside, of_a_outside].iter().any(|&length| length <= CONTACT) {
        return None;
    }
    let sentence = format!("\"{}\" and \"{}\" stand in one another", a.name, b.name);
    if solid(b) {
        if stated {
            return None;
        }
        return Some(
            Finding::new(Kind::StandingIn, Severity::Warning, sentence)
                .remedy(
                    "move one of them; if they are meant to (water in a glass), say which one fills where both are: the one of higher priority",
                )
                .line(element_key(&a.name, "priority"), 1i64),
        );
    }
    Some(
        Finding::new(Kind::StandingIn, Severity::Warning, sentence)
            .remedy("move one of them until they only touch"),
    )
}

/// How much of a chord lies in some of another solid's, mm.
fn shared([from, to]: [f64; 2], others: &[[f64; 2]]) -> f64 {
    others.iter().map(|c| (c[1].min(to) - c[0].max(from)).max(0.0)).sum()
}

/// Lines through an element's box, along its three axes.
fn lines_through(element: &Element) -> Vec<Ray> {
    let [low, high] = element.shape.bounds();
    let ([low, high], mut lines) = ([low.to_array(), high.to_array()], Vec::new());
    // A third of the lines across a rectangle: what is looked for here is whole parts, not contacts.
    let count = LINES / 3;
    for axis in 0..3 {
        for index in 0..count * count {
            let mut origin = low;
            for (other, k) in [((axis + 1) % 3, index % count), ((axis + 2) % 3, index / count)] {
                let share = (k as f64 + 0.5) / count as f64;
                origin[other] = low[other] + share * (high[other] - low[other]);
            }
            let mut direction = [0.0; 3];
            direction[axis] = 1.0;
            lines.push(Ray {
                origin: element.frame.to_world(Vec3::from_array(origin)),
                direction: element.frame.to_world_direction(Vec3::from_array(direction)),
            });
        }
    }
    lines
}

/// Whether the boxes of two elements, along the world's axes, meet.
pub(super) fn boxes_meet(a: &Element, b: &Element) -> bool {
    let span = |element: &Element, axis: usize| {
        corners(element)
            .iter()
            .map(|corner| corner.to_array()[axis])
            .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], c| [low.min(c), high.max(c)])
    };
    (0..3).all(|axis| {
        let ([a0, a1], [b0, b1]) = (span(a, axis), span(b, axis));
        a0 <= b1 + CONTACT && b0 <= a1 + CONTACT
    })
}
