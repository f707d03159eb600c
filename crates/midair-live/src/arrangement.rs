//! Small moves of what the scene file says, to make it agree with what stands on the table; taken back one by one, or all at once.

use midair::scene::model::{Pose, Scene};

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
    pub fn name(self, scene: &Scene) -> &str {
        match self {
            Self::Viewpoint => "viewpoint",
            Self::Element(i) => &scene.elements[i].name,
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

/// Where everything stands that can be moved.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Arrangement {
    viewpoint: [f64; 3],
    elements: Vec<Pose>,
}

impl Arrangement {
    pub fn of(scene: &Scene) -> Self {
        let elements = scene.elements.iter().map(|element| element.pose).collect();
        Self { viewpoint: scene.viewpoint, elements }
    }

    /// Puts everything of a scene there.
    pub fn put(&self, scene: &mut Scene) {
        scene.viewpoint = self.viewpoint;
        for (element, pose) in scene.elements.iter_mut().zip(&self.elements) {
            element.pose = *pose;
        }
    }

    /// Moves a target. Places and angles are kept to a thousandth, so that a scene that is saved reads well. False where there is nothing
    /// to be moved.
    pub fn nudge(&mut self, nudge: Nudge, target: Target) -> bool {
        let value = match (target, nudge.turn) {
            (Target::Viewpoint, true) => return false,
            (Target::Viewpoint, false) => &mut self.viewpoint[nudge.axis],
            (Target::Element(i), true) => &mut self.elements[i].rotation[nudge.axis],
            (Target::Element(i), false) => &mut self.elements[i].position[nudge.axis],
        };
        *value = ((*value + nudge.by) * 1000.0).round() / 1000.0;
        true
    }

    /// How far a target has been moved from where another arrangement has it: mm, and degrees.
    pub fn moved(&self, from: &Self, target: Target) -> ([f64; 3], [f64; 3]) {
        let less = |a: [f64; 3], b: [f64; 3]| std::array::from_fn(|i| a[i] - b[i]);
        match target {
            Target::Viewpoint => (less(self.viewpoint, from.viewpoint), [0.0; 3]),
            Target::Element(i) => {
                let [here, there] = [&self.elements[i], &from.elements[i]];
                (less(here.position, there.position), less(here.rotation, there.rotation))
            }
        }
    }
}
