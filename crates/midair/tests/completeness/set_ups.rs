//! Random set-ups of all kinds, as scene files.

use fastrand::Rng;
use std::fmt::Write as _;

/// The kinds, in the order in which they come.
const KINDS: [&str; 9] = [
    "single solid",
    "glass of water",
    "overlapping solids",
    "solids in a row",
    "bent mirror",
    "ball on a mirror",
    "total reflection",
    "small plate",
    "image at a border",
];

/// Set-up `seed` of an endless sequence: its kind and its text.
pub fn random(seed: u64) -> (&'static str, String) {
    let mut rng = Rng::with_seed(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ 0x5EED);
    let kind = KINDS[(seed % KINDS.len() as u64) as usize];
    let text = Maker { rng: &mut rng }.scene(seed, kind);
    (kind, text)
}

struct Maker<'a> {
    rng: &'a mut Rng,
}

impl Maker<'_> {
    fn within(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.rng.f64()
    }

    fn chance(&mut self, share: f64) -> bool {
        self.rng.f64() < share
    }

    fn around(&mut self, spread: f64) -> [f64; 3] {
        [0; 3].map(|_| self.within(-spread, spread))
    }

    /// Half of the time within `spread`, else any turn at all.
    fn turn(&mut self, spread: f64) -> [f64; 3] {
        if self.chance(0.5) { self.around(spread) } else { self.around(80.0) }
    }

    fn index(&mut self) -> f64 {
        match self.rng.u32(0..4) {
            0 => 1.49,
            1 => 1.52,
            2 => 2.4,
            _ => self.within(1.2, 2.4),
        }
    }

    fn scene(&mut self, seed: u64, kind: &str) -> String {
        let mut text = format!("name = \"random {seed}: {kind}\"\n");
        if kind == "total reflection" || self.chance(0.1) {
            text += "follow_total_reflection = true\n";
        }
        let table = matches!(kind, "bent mirror" | "ball on a mirror");
        if table {
            self.on_a_table(&mut text, kind)
        } else {
            self.before_a_plate(&mut text, kind)
        }
        text
    }

    fn display(&mut self, text: &mut String, image: [f64; 2]) {
        let [w, h] = [0; 2].map(|_| self.rng.u32(80..200));
        let _ = writeln!(text, "[display]\nresolution = [{w}, {h}]");
        if self.chance(0.5) {
            let scale = self.within(0.6, 1.8);
            let _ = writeln!(text, "size = [{}, {}]", image[0] * scale, image[1] * scale);
        }
    }

    fn on_a_table(&mut self, text: &mut String, kind: &str) {
        let ball = (kind == "ball on a mirror").then(|| self.within(15.0, 35.0));
        let size = [0; 2].map(|_| match ball {
            Some(radius) => self.within(0.3, 0.9) * radius,
            None => self.within(20.0, 60.0),
        });
        let height = ball.unwrap_or(0.5 * size[1]);
        let x = self.within(-60.0, 60.0);
        let _ = writeln!(
            text,
            "[viewpoint]\nposition = [{x}, {}, {}]\n[image]\nposition = [0.0, {height}, 0.0]\nsize = [{}, {}]",
            self.within(250.0, 550.0),
            self.within(500.0, 900.0),
            size[0],
            size[1],
        );
        let plate = if self.chance(0.2) { 120.0 } else { 488.0 };
        let _ = writeln!(
            text,
            "[plate]\nposition = [0.0, 244.0, {}]\nsize = [488.0, {plate}]",
            self.within(-260.0, -150.0),
        );
        self.display(text, size);
        if let Some(radius) = ball {
            self.solid_of(
                text,
                &format!("{{ kind = \"sphere\", radius = {radius} }}"),
                [0.0, radius, 0.0],
                [0.0; 3],
                None,
            );
            let below = self.within(0.0, 2.0);
            let _ = writeln!(
                text,
                "[[element]]\nshape = {{ kind = \"plane\", size = [300.0, 400.0] }}\nrotation = [-90.0, 0.0, 0.0]\nposition = [0.0, {}, 0.0]\nmaterial = {{ mirror = true }}",
                -below,
            );
            return;
        }
        let facing = if self.chance(0.5) { "convex" } else { "concave" };
        let radius = self.within(150.0, 600.0);
        let shape = if self.chance(0.5) {
            format!(
                "{{ kind = \"cylinder-mirror\", radius = {radius}, size = [200.0, 300.0], facing = \"{facing}\" }}"
            )
        } else {
            format!(
                "{{ kind = \"sphere-mirror\", radius = {radius}, diameter = 200.0, facing = \"{facing}\" }}"
            )
        };
        let [a, _, c] = self.around(8.0);
        let _ = writeln!(
            text,
            "[[element]]\nshape = {shape}\nrotation = [{}, 0.0, {c}]\nmaterial = {{ mirror = true }}",
            a - 90.0,
        );
    }

    fn before_a_plate(&mut self, text: &mut String, kind: &str) {
        let distance =
            if self.chance(0.25) { self.within(150.0, 350.0) } else { self.within(400.0, 1100.0) };
        let [x, y, _] = self.around(0.2 * distance);
        let border = kind == "image at a border";
        let size =
            [0; 2].map(|_| if border { self.within(40.0, 80.0) } else { self.within(12.0, 45.0) });
        let [dx, dy, dz] = if border { self.around(20.0) } else { self.around(5.0) };
        let [a, b, c] = self.around(15.0);
        let _ = writeln!(
            text,
            "[viewpoint]\nposition = [{x}, {y}, {distance}]\n[image]\nposition = [{dx}, {dy}, {dz}]\nrotation = [{a}, {b}, {c}]\nsize = [{}, {}]",
            size[0], size[1],
        );
        let small = kind == "small plate";
        let plate =
            [0; 2].map(|_| if small { self.within(15.0, 80.0) } else { self.within(250.0, 550.0) });
        let [dx, dy, _] = self.around(20.0);
        let [a, b, c] = self.around(15.0);
        let _ = writeln!(
            text,
            "[plate]\nposition = [{dx}, {dy}, {}]\nrotation = [{}, {b}, {c}]\nsize = [{}, {}]",
            self.within(-250.0, -130.0),
            a - 42.0,
            plate[0],
            plate[1],
        );
        self.display(text, size);
        match kind {
            "glass of water" => self.glass_of_water(text),
            "overlapping solids" => {
                for priority in 1..=self.rng.i32(2..5) {
                    let place = self.around(20.0);
                    self.solid(text, place, [6.0, 40.0], Some(priority));
                }
            }
            "solids in a row" => {
                let count = self.rng.usize(2..4);
                for k in 0..count {
                    let [x, y, _] = self.around(8.0);
                    self.solid(text, [x, y, 70.0 - 70.0 * k as f64], [18.0, 34.0], None);
                }
            }
            _ => {
                let place = self.around(8.0);
                self.solid(text, place, [18.0, 50.0], None);
            }
        }
    }

    fn solid(
        &mut self,
        text: &mut String,
        place: [f64; 3],
        [low, high]: [f64; 2],
        priority: Option<i32>,
    ) {
        let r = self.within(low, high);
        let [x, y, z] = [0; 3].map(|_| self.within(low, high));
        let shape = match self.rng.u32(0..5) {
            0 => format!("{{ kind = \"sphere\", radius = {r} }}"),
            1 => format!("{{ kind = \"ellipsoid\", radii = [{x}, {y}, {z}] }}"),
            2 => format!("{{ kind = \"box\", size = [{}, {}, {}] }}", 1.6 * x, 1.6 * y, 1.6 * z),
            3 => format!("{{ kind = \"cylinder\", radius = {r}, height = {} }}", 2.0 * y),
            _ => format!(
                "{{ kind = \"cone\", radius = {r}, top_radius = {}, height = {} }}",
                if self.chance(0.5) { 0.0 } else { 0.5 * x },
                1.5 * y,
            ),
        };
        let turn = self.turn(20.0);
        self.solid_of(text, &shape, place, turn, priority);
    }

    fn solid_of(
        &mut self,
        text: &mut String,
        shape: &str,
        place: [f64; 3],
        turn: [f64; 3],
        priority: Option<i32>,
    ) {
        let index = self.index();
        let _ = writeln!(
            text,
            "[[element]]\nshape = {shape}\nposition = {place:?}\nrotation = {turn:?}\nmaterial = {{ ior = {index} }}",
        );
        if let Some(priority) = priority {
            let _ = writeln!(text, "priority = {priority}");
        }
    }

    /// Glass, water and the air above it, whose faces coincide, and mostly a bead in the water.
    fn glass_of_water(&mut self, text: &mut String) {
        let (radius, height) = (self.within(25.0, 50.0), self.within(60.0, 120.0));
        let inner = radius - self.within(1.5, 4.0);
        let (foot, surface) = (4.0 - 0.5 * height, self.within(-0.2, 0.35) * height);
        // As people write it: the water's surface is the air's lower face, to the last digit or nearly.
        let digits = |x: f64| (x * 16.0).round() / 16.0;
        let (inner, foot, surface) = (digits(inner), digits(foot), digits(surface));
        let cylinder = |radius: f64, low: f64, high: f64, matter: &str, priority: u32| {
            format!(
                "[[element]]\nshape = {{ kind = \"cylinder\", radius = {radius}, height = {} }}\nposition = [0.0, {}, 0.0]\nmaterial = {{ {matter} }}\npriority = {priority}\n",
                high - low,
                0.5 * (low + high),
            )
        };
        let glass = format!("ior = {}", self.within(1.45, 1.6));
        *text += &cylinder(
            digits(radius + 0.0625),
            -0.5 * digits(height),
            0.5 * digits(height),
            &glass,
            0,
        );
        *text += &cylinder(inner, foot, surface, "ior = 1.333", 1);
        *text += &cylinder(inner, surface, surface + digits(height), "ior = 1.0", 1);
        if self.chance(0.7) {
            let bead = self.within(1.5, 7.0);
            let x = self.within(-5.0, 5.0);
            let z = self.within(-5.0, 5.0);
            let y = self.within(foot + bead, (surface - bead).max(foot + bead + 1.0));
            self.solid_of(
                text,
                &format!("{{ kind = \"sphere\", radius = {bead} }}"),
                [x, y, z],
                [0.0; 3],
                Some(2),
            );
        }
    }
}
