//! The map G as data.

/// What a map says of a sample: of a display pixel (G), or of an image pixel (F as a map). What has no answer is told apart by what
/// would have to be changed to give it one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default)]
#[repr(u8)]
pub enum Status {
    /// One image point and one display point belong together, error bound met.
    Ok = 0,
    /// Several image points share a display pixel (a caustic); of a display pixel's one is shown.
    Folded = 1,
    /// Nothing is in the way, but no path joins it to the other side's rectangle: a display pixel that no image point asks for, an
    /// image point whose path goes past the display. Place and size of the display (or the image) decide it.
    #[default]
    Outside = 2,
    /// Something on the way cuts its path short, and that would have to be changed: the plate's edge, past which the path of the
    /// image point that asks for this display pixel goes; for an image point also total internal reflection, the plate's back, or
    /// the limit on interactions.
    Blocked = 3,
}

impl Status {
    /// Whether the pixel has an answer: an image point that it shows.
    pub fn is_answered(self) -> bool {
        matches!(self, Self::Ok | Self::Folded)
    }

    /// The status that a file's number stands for.
    pub fn from_code(code: f32) -> Option<Self> {
        [Self::Ok, Self::Folded, Self::Outside, Self::Blocked]
            .into_iter()
            .find(|&status| f32::from(status as u8) == code)
    }
}

/// Display st -> image uv, one sample at each display pixel's centre.
///
/// The *coverage* is the pixels with an answer, as their status says ([`answer`](Self::answer)). Beyond it there may be a
/// *continuation* ([`continuation`](Self::continuation)): values for tools that interpolate between a map's pixels, made by
/// [`bleed`](super::bleed()). What a display shows depends on the coverage alone: [`drawn`](Self::drawn).
#[derive(Clone, Debug, PartialEq)]
pub struct Map {
    /// Display pixels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Image coordinates (u right, v up); row 0 is the display's top row, row-major. In \[0, 1\] where the status is `Ok` or
    /// `Folded`; elsewhere NaN, or the continuation.
    pub uv: Vec<[f64; 2]>,
    /// Each pixel's status, in the order of `uv`.
    pub status: Vec<Status>,
    /// Upper bound of |uv - exact| over the ok pixels.
    pub error_bound: f64,
}

impl Map {
    /// A map without any answer.
    pub fn unanswered(width: usize, height: usize) -> Self {
        let pixels = width * height;
        Self {
            width,
            height,
            uv: vec![[f64::NAN; 2]; pixels],
            status: vec![Status::Outside; pixels],
            error_bound: 0.0,
        }
    }

    /// The image point of a pixel that has one of its own: what the map covers.
    #[inline]
    pub fn answer(&self, pixel: usize) -> Option<[f64; 2]> {
        let uv = self.uv[pixel];
        (self.status[pixel].is_answered() && is_finite(uv)).then_some(uv)
    }

    /// The value of a pixel beyond the coverage, where there is one.
    #[inline]
    pub fn continuation(&self, pixel: usize) -> Option<[f64; 2]> {
        let uv = self.uv[pixel];
        (!self.status[pixel].is_answered() && is_finite(uv)).then_some(uv)
    }

    /// The identity: every pixel shows the image point at its own place.
    pub fn identity(width: usize, height: usize) -> Self {
        let uv = (0..height)
            .flat_map(|row| (0..width).map(move |column| pixel_centre(column, row, width, height)))
            .collect();
        Self { width, height, uv, status: vec![Status::Ok; width * height], error_bound: 0.0 }
    }
}

/// Whether uv are numbers.
#[inline]
pub(crate) fn is_finite(uv: [f64; 2]) -> bool {
    uv[0].is_finite() & uv[1].is_finite()
}

/// What is left of each display pixel's light when it reaches the viewpoint.
#[derive(Clone, Debug, PartialEq)]
pub struct Gain {
    /// Display pixels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Share of the light that survives, by linear R, G, B; as a map's `uv`: row 0 at the top, NaN where there is no answer.
    pub rgb: Vec<[f32; 3]>,
}

impl Gain {
    /// Whether a pixel's share of R, G, B is known.
    pub fn is_answered(rgb: &[f32; 3]) -> bool {
        rgb.iter().all(|share| share.is_finite())
    }

    /// The least and the largest share of any colour; `None` where no pixel has an answer.
    pub fn range(&self) -> Option<[f32; 2]> {
        let known = self.rgb.iter().flatten().copied().filter(|share| share.is_finite());
        known.fold(None, |range, share| {
            let [least, most] = range.unwrap_or([share; 2]);
            Some([least.min(share), most.max(share)])
        })
    }
}

/// The st (or uv) coordinates of a pixel's centre: right and up, row 0 at the top.
pub fn pixel_centre(column: usize, row: usize, width: usize, height: usize) -> [f64; 2] {
    [(column as f64 + 0.5) / width as f64, ((height - row) as f64 - 0.5) / height as f64]
}

/// Column and row of the pixel that a place st (or uv) lies in; of the nearest one, beyond the edges.
pub fn pixel_at([s, t]: [f64; 2], width: usize, height: usize) -> (usize, usize) {
    // A negative number becomes 0.
    let index = |x: f64, n: usize| ((x * n as f64) as usize).min(n - 1);
    (index(s, width), index(1.0 - t, height))
}
