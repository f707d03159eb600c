//! What each display pixel's status is, by brute force: F is sampled, nothing of it is known.
//!
//! Only [`Setup::transport`] is asked. A grid over the image is refined wherever neighbouring rays take different courses, and
//! wherever they land far from each other on the display. What lies between is rasterised into pixels, each of which is then solved by
//! Broyden's method from finite differences and believed if the trace of the solution arrives at the pixel's centre.

use midair::map::{Status, pixel_at, pixel_centre};
use midair::transport::{End, Path, Setup};
use std::collections::HashMap;

/// How closely it is looked.
#[derive(Clone, Copy, Debug)]
pub struct Care {
    /// Cells of the first grid along each side.
    pub cells: usize,
    /// A cell with different courses at its corners is quartered this often, whatever else is seen.
    pub cut: u32,
    /// A cell that is wide on the display is quartered at most this often.
    pub wide: u32,
}

impl Care {
    /// Borders to 1/1600 of the image, what is wide on the display to 1/25600.
    pub const QUICK: Self = Self { cells: 100, cut: 4, wide: 8 };
    /// Borders to 1/5000 of the image, what is wide on the display to 1/80000.
    pub const THOROUGH: Self = Self { cells: 160, cut: 5, wide: 9 };
}

/// From rays of one course each pixel is tried so often: what it has of them is found by then.
const TRIES: u8 = 12;
/// A cell is wide if its rays land further than this from each other, in pixels.
const WIDE: f64 = 1.5;
/// Between two different courses the border is closed in upon to this distance.
const BORDER: f64 = 1e-11;

/// An image point that reaches a pixel.
#[derive(Clone, Copy, Debug)]
pub struct Root {
    pub uv: [f64; 2],
    pub through_plate: bool,
}

/// A ray with the course that it took.
#[derive(Clone)]
struct Sample {
    uv: [f64; 2],
    end: End,
    path: Path,
}

impl Sample {
    fn take(setup: &Setup, uv: [f64; 2]) -> Self {
        let mut path = Path::new();
        let end = setup.transport(uv, &mut path);
        Self { uv, end, path }
    }

    fn same_course(&self, other: &Self) -> bool {
        let ends_alike = match (self.end, other.end) {
            (End::Display { through_plate: a, .. }, End::Display { through_plate: b, .. }) => {
                a == b
            }
            (End::Display { .. }, _) | (_, End::Display { .. }) => false,
            (a, b) => a == b,
        };
        ends_alike && self.path == other.path
    }
}

/// All that was found out about a set-up's display.
pub struct Judge<'a> {
    setup: &'a Setup,
    size: [usize; 2],
    /// The image points that reach each pixel, row by row.
    pub roots: Vec<Vec<Root>>,
    care: Care,
    /// Roots whose neighbours are still to be tried, with their courses.
    fresh: Vec<(usize, usize, Root, usize)>,
    /// The courses of rays that arrive, as they turned up.
    courses: Vec<Path>,
    /// How often a pixel was tried from rays of a course.
    tries: HashMap<(usize, usize), u8>,
    /// Rays traced.
    pub rays: u64,
}

impl<'a> Judge<'a> {
    pub fn new(setup: &'a Setup, care: Care) -> Self {
        let size = setup.resolution;
        let mut judge = Self {
            setup,
            size,
            roots: vec![Vec::new(); size[0] * size[1]],
            care,
            fresh: Vec::new(),
            courses: Vec::new(),
            tries: HashMap::new(),
            rays: 0,
        };
        judge.sample();
        judge
    }

    /// The status that a pixel's roots give it.
    pub fn status(&self, x: usize, y: usize) -> Status {
        let roots = &self.roots[y * self.size[0] + x];
        match roots.iter().filter(|root| root.through_plate).count() {
            0 if roots.is_empty() => Status::Outside,
            0 => Status::Blocked,
            1 => Status::Ok,
            _ => Status::Folded,
        }
    }

    /// Whether all pixels around one have its status.
    pub fn is_deep(&self, x: usize, y: usize) -> bool {
        let around = |k: usize, n: usize| k.saturating_sub(1)..(k + 2).min(n);
        around(y, self.size[1])
            .all(|j| around(x, self.size[0]).all(|i| self.status(i, j) == self.status(x, y)))
    }

    fn take(&mut self, uv: [f64; 2]) -> Sample {
        self.rays += 1;
        Sample::take(self.setup, uv)
    }

    fn sample(&mut self) {
        let cells = self.care.cells;
        let place = |k: usize| k as f64 / cells as f64;
        let row = |judge: &mut Self, j: usize| -> Vec<Sample> {
            (0..=cells).map(|i| judge.take([place(i), place(j)])).collect()
        };
        let mut below = row(self, 0);
        for j in 1..=cells {
            let above = row(self, j);
            for i in 0..cells {
                self.cell([&below[i], &below[i + 1], &above[i], &above[i + 1]], 0);
            }
            below = above;
        }
    }

    /// Distance on the display in pixels.
    fn apart(&self, a: [f64; 2], b: [f64; 2]) -> f64 {
        ((a[0] - b[0]) * self.size[0] as f64).hypot((a[1] - b[1]) * self.size[1] as f64)
    }

    fn cell(&mut self, corners: [&Sample; 4], depth: u32) {
        let cut = corners[1..].iter().any(|c| !c.same_course(corners[0]));
        if !cut && corners[0].end.st().is_none() {
            return;
        }
        let mut wide = false;
        let mut bounds = [[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]];
        for (k, a) in corners.iter().enumerate() {
            let Some(at) = a.end.st() else { continue };
            for axis in 0..2 {
                bounds[0][axis] = bounds[0][axis].min(at[axis]);
                bounds[1][axis] = bounds[1][axis].max(at[axis]);
            }
            for b in &corners[k + 1..] {
                if let (true, Some(other)) = (a.same_course(b), b.end.st()) {
                    wide |= self.apart(at, other) > WIDE;
                }
            }
        }
        let near = (0..2).all(|axis| {
            // Its own extent beyond its corners, and a fifth of the display.
            let extra = 0.2 + bounds[1][axis] - bounds[0][axis];
            bounds[0][axis] < 1.0 + extra && bounds[1][axis] > -extra
        });
        if !cut && !near {
            return;
        }
        if (cut && depth < self.care.cut) || (wide && depth < self.care.wide) {
            let middle =
                |a: usize, b: usize| [0, 1].map(|k| 0.5 * (corners[a].uv[k] + corners[b].uv[k]));
            let [bottom, left, centre, right, top] =
                [middle(0, 1), middle(0, 2), middle(0, 3), middle(1, 3), middle(2, 3)]
                    .map(|uv| self.take(uv));
            let [a, b, c, d] = corners;
            self.cell([a, &bottom, &left, &centre], depth + 1);
            self.cell([&bottom, b, &centre, &right], depth + 1);
            self.cell([&left, &centre, c, &top], depth + 1);
            self.cell([&centre, &right, &top, d], depth + 1);
            return;
        }
        if cut {
            self.close_in(corners[0].clone(), corners[3].clone());
            for corner in corners {
                self.start(corner);
            }
        } else {
            self.triangle([corners[0], corners[1], corners[2]]);
            self.triangle([corners[3], corners[1], corners[2]]);
        }
        self.spread();
    }

    /// Closes in on the borders between two rays, as long as new courses turn up.
    fn close_in(&mut self, mut a: Sample, mut b: Sample) {
        while !a.same_course(&b) {
            if (a.uv[0] - b.uv[0]).hypot(a.uv[1] - b.uv[1]) < BORDER {
                return;
            }
            let middle = self.take([0, 1].map(|k| 0.5 * (a.uv[k] + b.uv[k])));
            if middle.same_course(&a) {
                a = middle;
            } else if middle.same_course(&b) {
                b = middle;
            } else {
                self.start(&middle);
                self.close_in(middle.clone(), b);
                b = middle;
            }
        }
    }

    /// Tries the pixel that a ray lands on.
    fn start(&mut self, sample: &Sample) {
        if let Some(st) = sample.end.st()
            && st.iter().all(|c| (0.0..1.0).contains(c))
        {
            let (x, y) = pixel_at(st, self.size[0], self.size[1]);
            let course = self.course(&sample.path);
            self.try_course(x, y, sample.uv, course);
        }
    }

    /// The number of a course.
    fn course(&mut self, path: &Path) -> usize {
        self.courses.iter().position(|known| known == path).unwrap_or_else(|| {
            self.courses.push(path.clone());
            self.courses.len() - 1
        })
    }

    /// Tries a pixel from a ray of a course, unless it was tried often.
    fn try_course(&mut self, x: usize, y: usize, start: [f64; 2], course: usize) {
        let tries = self.tries.entry((y * self.size[0] + x, course)).or_default();
        if *tries < TRIES {
            *tries += 1;
            self.try_root(x, y, start);
        }
    }

    /// Tries the pixels whose centres lie in a triangle of rays of one course, or next to it.
    fn triangle(&mut self, corners: [&Sample; 3]) {
        let mut at = [[0.0; 2]; 3];
        for (at, corner) in at.iter_mut().zip(corners) {
            let Some([s, t]) = corner.end.st() else { return };
            *at = [s * self.size[0] as f64 - 0.5, (1.0 - t) * self.size[1] as f64 - 0.5];
        }
        let [a, b, c] = at;
        let course = self.course(&corners[0].path);
        let size = self.size;
        let range = |axis: usize| {
            let low = a[axis].min(b[axis]).min(c[axis]) - 0.1;
            let high = a[axis].max(b[axis]).max(c[axis]) + 0.1;
            let first = low.ceil().max(0.0) as usize;
            let past = (high + 1.0).floor().clamp(0.0, size[axis] as f64) as usize;
            first..past
        };
        let area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
        for y in range(1) {
            for x in range(0) {
                let p = [x as f64 - a[0], y as f64 - a[1]];
                let second = (p[0] * (c[1] - a[1]) - p[1] * (c[0] - a[0])) / area;
                let third = ((b[0] - a[0]) * p[1] - (b[1] - a[1]) * p[0]) / area;
                let weights = [1.0 - second - third, second, third];
                // A triangle without area is a fold: its middle is a start as good as any.
                let inside = weights.iter().all(|&w| w > -0.2);
                let weights = if area.abs() < 1e-9 { [1.0 / 3.0; 3] } else { weights };
                if inside || area.abs() < 1e-9 {
                    let uv = [0, 1].map(|k| {
                        (0..3).map(|i| weights[i] * corners[i].uv[k]).sum::<f64>().clamp(0.0, 1.0)
                    });
                    self.try_course(x, y, uv, course);
                }
            }
        }
    }

    /// Tries the neighbours of what was found, each from its neighbour's root.
    fn spread(&mut self) {
        while let Some((x, y, root, course)) = self.fresh.pop() {
            let mut around = Vec::new();
            if x > 0 {
                around.push((x - 1, y));
            }
            if y > 0 {
                around.push((x, y - 1));
            }
            if x + 1 < self.size[0] {
                around.push((x + 1, y));
            }
            if y + 1 < self.size[1] {
                around.push((x, y + 1));
            }
            for (i, j) in around {
                if self.roots[j * self.size[0] + i].is_empty() {
                    self.try_course(i, j, root.uv, course);
                }
            }
        }
    }

    /// Takes an image point for a pixel's if it is one: from there a root is looked for, and traced again.
    pub fn try_root(&mut self, x: usize, y: usize, start: [f64; 2]) {
        let st = pixel_centre(x, y, self.size[0], self.size[1]);
        let known = y * self.size[0] + x;
        // Starts next to a root lead there.
        let near = |root: &Root, from: [f64; 2], by: f64| {
            (root.uv[0] - from[0]).hypot(root.uv[1] - from[1]) < by
        };
        if self.roots[known].iter().any(|root| near(root, start, 1e-6)) {
            return;
        }
        let Some(uv) = self.broyden(st, start) else { return };
        if !uv.iter().all(|c| (0.0..=1.0).contains(c))
            || self.roots[known].iter().any(|root| near(root, uv, 1e-6))
        {
            return;
        }
        let traced = self.take(uv);
        if let End::Display { through_plate, .. } = traced.end {
            let root = Root { uv, through_plate };
            self.roots[known].push(root);
            let course = self.course(&traced.path);
            self.fresh.push((x, y, root, course));
        }
    }

    /// Tries a pixel from the roots of those around it, which the grid may have led to on a thin branch; whether one more was found.
    pub fn look_around(&mut self, x: usize, y: usize) -> bool {
        let around = |k: usize, n: usize| k.saturating_sub(2)..(k + 3).min(n);
        let [width, height] = self.size;
        let starts: Vec<[f64; 2]> = around(y, height)
            .flat_map(|j| around(x, width).map(move |i| j * width + i))
            .flat_map(|place| self.roots[place].iter().map(|root| root.uv))
            .collect();
        let known = self.roots[y * width + x].len();
        starts.into_iter().for_each(|uv| self.try_root(x, y, uv));
        self.roots[y * width + x].len() > known
    }

    fn residual(&mut self, uv: [f64; 2], st: [f64; 2]) -> Option<[f64; 2]> {
        self.take(uv).end.st().map(|at| [at[0] - st[0], at[1] - st[1]])
    }

    /// How far F is from st, and its derivatives by differences, forward or backward, between rays of one course: beside the end of a branch even a small
    /// step may leave it.
    fn linearised(&mut self, uv: [f64; 2], st: [f64; 2]) -> Option<([f64; 2], [[f64; 2]; 2])> {
        let here = self.take(uv);
        let f = here.end.st().map(|at| [at[0] - st[0], at[1] - st[1]])?;
        let mut jacobian = [[0.0; 2]; 2];
        for axis in 0..2 {
            let mut difference = |h: f64| {
                let mut to = uv;
                to[axis] += h;
                let there = self.take(to);
                if !there.same_course(&here) {
                    return None;
                }
                let at = there.end.st()?;
                Some([0, 1].map(|k| (at[k] - st[k] - f[k]) / h))
            };
            let by_axis = difference(1e-8)
                .or_else(|| difference(-1e-8))
                .or_else(|| difference(1e-9))
                .or_else(|| difference(-1e-9))?;
            jacobian[0][axis] = by_axis[0];
            jacobian[1][axis] = by_axis[1];
        }
        Some((f, jacobian))
    }

    /// A root of F(uv) = st by Broyden's method (1965).
    fn broyden(&mut self, st: [f64; 2], start: [f64; 2]) -> Option<[f64; 2]> {
        let mut uv = start;
        let (mut f, mut jacobian) = self.linearised(uv, st)?;
        for _ in 0..30 {
            let step = solve(jacobian, [-f[0], -f[1]])?;
            if !(step[0].hypot(step[1]) < 1.0) {
                return None;
            }
            uv = [uv[0] + step[0], uv[1] + step[1]];
            f = self.residual(uv, st)?;
            if step[0].hypot(step[1]) < 1e-12 || f[0].hypot(f[1]) < 1e-14 {
                // Where F is so steep that the last digit of uv moves its light further, a hundredth of a pixel must do.
                return (self.apart(f, [0.0; 2]) < 0.01).then_some(uv);
            }
            let squared = step[0] * step[0] + step[1] * step[1];
            for row in 0..2 {
                for column in 0..2 {
                    jacobian[row][column] += f[row] * step[column] / squared;
                }
            }
        }
        None
    }

    /// How far an answer is from exact, and how far rounding may mislead this judgement; `None` if its light does not arrive.
    pub fn error(&mut self, x: usize, y: usize, uv: [f64; 2]) -> Option<[f64; 2]> {
        let st = pixel_centre(x, y, self.size[0], self.size[1]);
        let (f, jacobian) = self.linearised(uv, st)?;
        let off = solve(jacobian, f)?;
        // Coordinates of a metre in double precision on a display of centimetres: 1e-14, a hundredfold over a path.
        let rounding = [solve(jacobian, [1e-12, 0.0])?, solve(jacobian, [0.0, 1e-12])?];
        let length = |v: [f64; 2]| v[0].hypot(v[1]);
        Some([length(off), length(rounding[0]) + length(rounding[1])])
    }
}

fn solve([[a, b], [c, d]]: [[f64; 2]; 2], v: [f64; 2]) -> Option<[f64; 2]> {
    let determinant = a * d - b * c;
    let x = [(d * v[0] - b * v[1]) / determinant, (a * v[1] - c * v[0]) / determinant];
    (x[0].is_finite() && x[1].is_finite()).then_some(x)
}
