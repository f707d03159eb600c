//! Small moves of what the scene file says, to make it agree with what stands on the table.

use midair::scene::Loaded;

/// What is moved.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Target {
    /// The eye; it is not turned.
    Viewpoint,
    /// An element, by its place in the scene.
    Element(usize),
}

impl Target {
    /// The next one: the viewpoint, then each element.
    pub fn next(self, elements: usize) -> Self {
        match self {
            Self::Viewpoint if elements > 0 => Self::Element(0),
            Self::Element(i) if i + 1 < elements => Self::Element(i + 1),
            _ => Self::Viewpoint,
        }
    }

    /// Its name.
    pub fn name(self, loaded: &Loaded) -> String {
        match self {
            Self::Viewpoint => "viewpoint".to_owned(),
            Self::Element(i) => loaded.scene.elements[i].name.clone(),
        }
    }
}

/// One step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nudge {
    /// 0, 1, 2 for x, y, z.
    pub axis: usize,
    /// mm; for a turn, degrees.
    pub by: f64,
    /// Whether the angle about the axis changes and not the place along it.
    pub turn: bool,
}

impl Nudge {
    /// Moves a target. Places and angles are kept to a thousandth, so that a scene that is saved reads well.
    pub fn apply(self, loaded: &mut Loaded, target: Target) {
        let scene = &mut loaded.scene;
        let value = match (target, self.turn) {
            (Target::Viewpoint, true) => return,
            (Target::Viewpoint, false) => &mut scene.viewpoint[self.axis],
            (Target::Element(i), true) => &mut scene.elements[i].pose.rotation[self.axis],
            (Target::Element(i), false) => &mut scene.elements[i].pose.position[self.axis],
        };
        *value = ((*value + self.by) * 1000.0).round() / 1000.0;
    }
}
