//! What a path met, and how it ended.

use crate::geometry::Crossing;
use smallvec::SmallVec;

/// What happens to a path where it meets something.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Action {
    /// Snell's law with `eta` = index before over index behind.
    Refract {
        /// Index before over index behind.
        eta: f64,
    },
    /// Mirror law, at a mirror or at total internal reflection.
    Reflect,
    /// The surface lies inside a solid of higher priority (or between equal media): nothing happens.
    Pass,
    /// The path ends at an opaque part.
    Stop,
    /// Through the plate: plane symmetry, in one plane or in one for each layer.
    Plate,
}

/// One meeting on a path.
///
/// Steps are equal if F goes on smoothly (or at least without a jump) from one to the other: on the same part of a surface.
#[derive(Clone, Copy, Debug)]
pub struct Step {
    /// Index of the element in the set-up; meaningless at the plate.
    pub element: u16,
    /// Which way through a solid, or which meeting with a sheet.
    pub crossing: Crossing,
    /// Which face of the element.
    pub face: u32,
    /// The part of the surface that the face belongs to: itself, or triangles that join without a sharp edge.
    pub part: u32,
    /// Whether that part is bent and made of many faces: the face changes along it.
    pub seamless: bool,
    /// What happens there.
    pub action: Action,
}

impl PartialEq for Step {
    fn eq(&self, other: &Self) -> bool {
        (self.element, self.crossing, self.action, self.part)
            == (other.element, other.crossing, other.action, other.part)
    }
}

/// Everything that a path met, in order. Paths with equal steps lie on one *branch* of the transport, on
/// which it is smooth.
pub type Path = SmallVec<[Step; 6]>;

/// How a path ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum End {
    /// On the display, at st; `within` tells whether that lies inside the display's edges.
    Display {
        /// Display coordinates (0 to 1 on the display).
        st: [f64; 2],
        /// Whether the path went through the plate's rectangle and not past its edge.
        through_plate: bool,
    },
    /// Total internal reflection in this element, and the scene does not ask to follow it.
    TotalReflection {
        /// Index of the element.
        element: u16,
    },
    /// It met this element, which is opaque.
    Stopped {
        /// Index of the element.
        element: u16,
    },
    /// It went off without meeting the plate.
    MissedPlate,
    /// It met the plate from behind, or a second time.
    PlateBehind,
    /// Beyond the plate it went off without meeting the display's front.
    MissedDisplay,
    /// More interactions than the scene allows.
    TooManyInteractions,
}

impl End {
    /// Display coordinates of a path that reached the display's plane through the plate's plane.
    pub fn st(&self) -> Option<[f64; 2]> {
        match *self {
            Self::Display { st, .. } => Some(st),
            _ => None,
        }
    }

    /// Display coordinates of a path that lights the image: through the plate's rectangle, within the
    /// display's edges.
    pub fn formed(&self) -> Option<[f64; 2]> {
        match *self {
            Self::Display { st, through_plate: true } if on_display(st) => Some(st),
            _ => None,
        }
    }
}

/// Whether display coordinates lie within the display's edges.
pub fn on_display(st: [f64; 2]) -> bool {
    st.iter().all(|c| (0.0..=1.0).contains(c))
}
