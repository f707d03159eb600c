//! Patterns for a display: to see whether it shows things in their true size, where an object belongs on it, and how its codes become light.

use super::Lettering;
use midair::evaluate::layout::{Layout, Role, View};
use midair::geometry::Rectangle;
use midair::measure::lattice::{LatticeStyle, LatticeStyleError, draw_lattice};
use midair::picture::{Picture, srgb};
use midair::transport::Setup;

/// What is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pattern {
    /// A lattice of yellow lines, as the paper's.
    Lattice {
        /// Lines in each direction.
        lines: usize,
    },
    /// A ruler along both sides through the middle, and a square of 50 mm (or less, if it does not fit) to measure.
    Ruler,
    /// Where objects stand: their outlines, seen along the display's normal, with its middle and its border.
    Registration,
    /// Seventeen steps of grey, evenly spaced in their codes.
    Grey,
    /// White all over.
    White,
}

const BLACK: [f32; 3] = [0.0; 3];
const WHITE: [f32; 3] = [1.0; 3];
const RED: [f32; 3] = [1.0, 0.05, 0.02];
const GREEN: [f32; 3] = [0.05, 0.8, 0.2];

/// A display to draw on.
struct Sheet {
    picture: Picture,
    /// Width and height of a pixel, mm.
    pitch: [f64; 2],
}

/// A pattern for a set-up's display, in its pixels.
///
/// # Errors
/// [`LatticeStyleError`] where the lattice cannot be drawn.
pub fn draw(pattern: Pattern, setup: &Setup) -> Result<Picture, LatticeStyleError> {
    let [width, height] = setup.resolution;
    let pitch = setup.pixel_pitch();
    let ground = |colour: [f32; 3]| {
        let [r, g, b] = colour;
        Sheet { picture: Picture::filled(width, height, [r, g, b, 1.0]), pitch }
    };
    Ok(match pattern {
        Pattern::Lattice { lines } => {
            // Fewer pixels than usual to a line where there are many.
            let line_width = 0.01f64.min(0.25 / lines.max(1) as f64);
            draw_lattice(
                width,
                height,
                &LatticeStyle { lines, line_width, ..LatticeStyle::default() },
            )?
        }
        Pattern::Ruler => {
            let mut sheet = ground(WHITE);
            ruler(&mut sheet);
            sheet.picture
        }
        Pattern::Registration => {
            let mut sheet = ground(BLACK);
            registration(&mut sheet, &setup.display, &Layout::of(setup));
            sheet.picture
        }
        Pattern::Grey => {
            let mut sheet = ground(BLACK);
            grey(&mut sheet);
            sheet.picture
        }
        Pattern::White => ground(WHITE).picture,
    })
}

impl Sheet {
    /// Pixels in a row and rows.
    fn size(&self) -> [f64; 2] {
        [self.picture.width as f64, self.picture.height as f64]
    }

    /// Where a place in mm from the display's middle (right, up) lies, in pixels from the top left.
    fn at(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let [w, h] = self.size();
        [0.5 * w + x / self.pitch[0], 0.5 * h - y / self.pitch[1]]
    }

    /// A smooth line of a width in pixels between two places in pixels.
    fn line(&mut self, a: [f64; 2], b: [f64; 2], width: f64, colour: [f32; 3]) {
        if !a.iter().chain(&b).all(|c| c.is_finite()) {
            return;
        }
        let reach = 0.5 * width + 1.0;
        let [w, h] = self.size();
        let span = |axis: usize, most: f64| {
            let low = (a[axis].min(b[axis]) - reach).floor().clamp(0.0, most) as usize;
            let high = (a[axis].max(b[axis]) + reach).ceil().clamp(0.0, most) as usize;
            low..high
        };
        let along = [b[0] - a[0], b[1] - a[1]];
        let squared = along[0] * along[0] + along[1] * along[1];
        for row in span(1, h) {
            for column in span(0, w) {
                let from = [column as f64 + 0.5 - a[0], row as f64 + 0.5 - a[1]];
                let t = if squared > 0.0 {
                    ((from[0] * along[0] + from[1] * along[1]) / squared).clamp(0.0, 1.0)
                } else {
                    0.0
                };
                let off = (from[0] - t * along[0]).hypot(from[1] - t * along[1]);
                let cover = (0.5 * width + 0.5 - off).clamp(0.0, 1.0) as f32;
                if cover > 0.0 {
                    let pixel = &mut self.picture.pixels[row * self.picture.width + column];
                    (0..3).for_each(|c| pixel[c] += cover * (colour[c] - pixel[c]));
                }
            }
        }
    }

    fn text(&mut self, text: &str, [x, y]: [f64; 2], scale: f64, colour: [f32; 3]) {
        let letters = Lettering::small(colour);
        let wide = letters.width(text) as f64 * scale;
        letters.enlarged(&mut self.picture, text, [x - 0.5 * wide, y], scale);
    }

    /// How much larger than 16 pixels letters are, to be about 3 mm high.
    fn letters(&self) -> f64 {
        (3.0 / self.pitch[1] / 16.0).clamp(0.6, 8.0)
    }
}

/// Ticks each millimetre along both axes, longer and numbered each ten; a square with a sentence to check it by.
fn ruler(sheet: &mut Sheet) {
    let [w, h] = [0, 1].map(|axis| sheet.size()[axis] * sheet.pitch[axis]);
    let scale = sheet.letters();
    // Where a millimetre is fewer than three pixels only each fifth is drawn.
    let step = if sheet.pitch[0].max(sheet.pitch[1]) > 1.0 / 3.0 { 5 } else { 1 };
    for (axis, length) in [w, h].into_iter().enumerate() {
        let place =
            |along: f64, across: f64| if axis == 0 { [along, across] } else { [across, along] };
        let last = (0.5 * length).floor() as i64;
        let [a, b] = [-0.5, 0.5].map(|end| sheet.at(place(end * length, 0.0)));
        sheet.line(a, b, 1.5, BLACK);
        for k in (-last..=last).filter(|k| k % step == 0) {
            let long = if k % 10 == 0 {
                4.0
            } else if k % 5 == 0 {
                2.5
            } else {
                1.5
            };
            let [a, b] = [0.0, long].map(|across| sheet.at(place(k as f64, across)));
            sheet.line(a, b, if k % 10 == 0 { 1.5 } else { 1.0 }, BLACK);
            if k % 10 == 0 && k != 0 {
                let across = if axis == 0 { long + 4.0 } else { long + 4.5 };
                let at = sheet.at(place(k as f64, across));
                let at = if axis == 0 { at } else { [at[0], at[1] - 8.0 * scale] };
                sheet.text(&k.abs().to_string(), at, scale, BLACK);
            }
        }
    }
    // As large as fits in a quarter, to the ten millimetres.
    let side = (0.45 * w.min(h) / 10.0).floor().clamp(1.0, 5.0) * 10.0;
    let [left, bottom] = [-0.25 * w - 0.5 * side, -0.25 * h - 0.5 * side];
    let corners = [[0.0, 0.0], [side, 0.0], [side, side], [0.0, side]];
    for k in 0..4 {
        let [a, b] =
            [corners[k], corners[(k + 1) % 4]].map(|[x, y]| sheet.at([left + x, bottom + y]));
        sheet.line(a, b, 2.0, RED);
    }
    let length = format!("is {side} mm long");
    let lines = ["each side of this square", length.as_str()];
    for (k, line) in lines.into_iter().enumerate() {
        let at = sheet.at([left + 0.5 * side, bottom + 0.5 * side]);
        sheet.text(line, [at[0], at[1] + 18.0 * scale * (k as f64 - 1.0)], scale, RED);
    }
}

/// The display's border and middle, and what stands on or over it, seen along its normal.
fn registration(sheet: &mut Sheet, display: &Rectangle, layout: &Layout) {
    let [x, y, _] = display.frame.axes;
    let view = View::Parallel { right: x, up: y };
    let [ox, oy] = view.place(display.frame.origin);
    let width = (0.4 / sheet.pitch[0]).clamp(1.5, 8.0);
    let scale = sheet.letters();
    let [w, h] = sheet.size();
    let corners = [[0.0, 0.0], [w, 0.0], [w, h], [0.0, h]];
    (0..4).for_each(|k| sheet.line(corners[k], corners[(k + 1) % 4], 2.0 * width, WHITE));
    let middle = [0.5 * w, 0.5 * h];
    for arm in [[5.0, 0.0], [0.0, 5.0]] {
        let [dx, dy] = [arm[0] / sheet.pitch[0], arm[1] / sheet.pitch[1]];
        sheet.line(
            [middle[0] - dx, middle[1] - dy],
            [middle[0] + dx, middle[1] + dy],
            width,
            WHITE,
        );
    }
    for body in &layout.bodies {
        let colour = match body.role {
            Role::Display | Role::Plate => continue,
            Role::Image => GREEN,
            Role::Solid | Role::Mirror | Role::Opaque => WHITE,
        };
        let seen = body.seen(&view);
        let mut lines = seen.lines;
        lines.push(seen.contour.iter().chain(seen.contour.first()).copied().collect());
        let mut highest: Option<[f64; 2]> = None;
        for line in &lines {
            let points: Vec<[f64; 2]> =
                line.iter().map(|p| sheet.at([p[0] - ox, p[1] - oy])).collect();
            for pair in points.windows(2) {
                sheet.line(pair[0], pair[1], width, colour);
            }
            for &point in &points {
                if highest.is_none_or(|top| point[1] < top[1]) {
                    highest = Some(point);
                }
            }
        }
        if let Some(top) = highest {
            sheet.text(&body.name, [top[0], top[1] - 20.0 * scale], scale, colour);
        }
    }
}

/// Steps of grey.
const STEPS: usize = 17;

/// Fields from black to white, the codes evenly spaced, each with its code of 8 bits below.
fn grey(sheet: &mut Sheet) {
    let [width, height] = [sheet.picture.width, sheet.picture.height];
    let letters = sheet.letters().min(width as f64 / STEPS as f64 / 30.0);
    let foot = ((20.0 * letters) as usize).min(height / 4);
    for step in 0..STEPS {
        let code = step as f64 / (STEPS - 1) as f64;
        let light = srgb::decode(code) as f32;
        let [from, to] = [step, step + 1].map(|k| k * width / STEPS);
        for row in 0..height - foot {
            sheet.picture.pixels[row * width + from..row * width + to]
                .fill([light, light, light, 1.0]);
        }
        let text = format!("{:.0}", 255.0 * code);
        let at = [0.5 * (from + to) as f64, (height - foot) as f64 + 2.0 * letters];
        sheet.text(&text, at, letters, WHITE);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use midair::scene::{Format, load_text};

    /// A display of 100 x 80 mm with ten pixels to the millimetre, under a bottle of 20 mm radius.
    fn drawn(pattern: Pattern) -> Picture {
        let text = "[viewpoint]\nposition = [0.0, 0.0, 800.0]\n[image]\nsize = [20.0, 20.0]\n[plate]\n\
            position = [0.0, 0.0, -150.0]\nrotation = [-45.0, 0.0, 0.0]\nsize = [200.0, 200.0]\n[display]\n\
            resolution = [1000, 800]\nsize = [100.0, 80.0]\n[[element]]\nname = \"bottle\"\n\
            shape = { kind = \"cylinder\", radius = 20.0, height = 50.0 }\nposition = [10.0, 0.0, -150.0]\nmaterial = { ior = 1.5 }\n";
        let setup = Setup::new(
            &load_text(text, "x.toml", Format::Toml, &midair::scene::InMemory::new()).unwrap(),
        )
        .unwrap();
        draw(pattern, &setup).unwrap()
    }

    fn is(picture: &Picture, [x, y]: [usize; 2], colour: [f32; 3]) -> bool {
        let pixel = picture.pixels[y * picture.width + x];
        (0..3).all(|c| (pixel[c] - colour[c]).abs() < 0.5)
    }

    #[test]
    fn the_ruler_has_a_tick_each_millimetre_and_a_square_to_measure() {
        let picture = drawn(Pattern::Ruler);
        // A millimetre above the middle line, ticks are dark and half-way between them is white.
        let row = 400 - 10;
        let mut ticks = 0;
        for k in -49i32..=49 {
            let column = (500 + 10 * k) as usize;
            // A line of one pixel that falls between two covers half of each.
            let dark = |x: usize| picture.pixels[row * 1000 + x][0];
            // Beside the middle the other ruler's ticks are met.
            if !(0..=2).contains(&k) {
                assert!(dark(column).min(dark(column - 1)) < 0.6, "{k}");
                assert!(dark(column + 5) > 0.9 && dark(column - 5) > 0.9, "{k}");
                ticks += 1;
            }
        }
        assert_eq!(ticks, 96);
        // 30 mm is what fits in a quarter of 80: the red lines are 300 pixels apart.
        let red: Vec<usize> = (0..500).filter(|&x| is(&picture, [x, 480], RED)).collect();
        assert!(
            red.last().unwrap() - red[0] >= 300 && red.last().unwrap() - red[0] <= 303,
            "{red:?}"
        );
    }

    #[test]
    fn marks_show_where_the_foot_stands() {
        let picture = drawn(Pattern::Registration);
        // The display lies flat below, its middle at (0, -150, -150): the bottle's foot is a circle of 20 mm 10 mm to the right.
        let mut met = 0;
        for k in 0..360 {
            let (s, c) = f64::from(k).to_radians().sin_cos();
            let place = [500.0 + 100.0 + 200.0 * c, 400.0 - 200.0 * s].map(|c: f64| c as usize);
            met += usize::from(is(&picture, place, WHITE));
        }
        assert!(met >= 350, "{met}");
        assert!(is(&picture, [600, 300], BLACK) && is(&picture, [520, 400], WHITE));
    }

    #[test]
    fn greys_are_even_in_their_codes_and_white_is_white() {
        let picture = drawn(Pattern::Grey);
        for step in 0..STEPS {
            let x = (2 * step + 1) * 1000 / (2 * STEPS);
            let code = srgb::encode_8(picture.pixels[10_000 + x][1]);
            assert_eq!(usize::from(code), (255 * step + 8) / 16, "{step}");
        }
        assert!(drawn(Pattern::White).pixels.iter().all(|p| *p == [1.0; 4]));
        let lattice = drawn(Pattern::Lattice { lines: 7 });
        assert!(lattice.pixels.iter().any(|p| p[0] > 0.9 && p[2] < 0.1));
    }
}
