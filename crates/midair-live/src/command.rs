//! What a person at the show may ask for.

use crate::arrangement::Nudge;

/// A wish, whichever key it stands on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Command {
    /// The end of the show.
    End,
    /// A pause, and on again.
    Pause,
    /// Another thing to be nudged.
    NextTarget,
    /// A step of it.
    Nudge(Nudge),
    /// The last step back.
    Undo,
    /// All steps back: everything as the scene file has it.
    Reset,
    /// The lattice in the place of the source, and back.
    Lattice,
    /// The source as it is, and compensated again.
    Uncompensated,
    /// Figures over the picture, and none.
    Figures,
    /// The keys over the picture, and none.
    Help,
    /// The tracker's present reading is the scene's viewpoint.
    Calibrate,
    /// The scene as it is now into a file.
    Save,
    /// The picture over all of the screen, and in a window again.
    FillScreen,
}

/// What only the face of the show can do.
#[derive(Clone, Debug, PartialEq)]
pub enum Wish {
    /// Ends the show.
    End,
    /// Fills the screen, or gives it back.
    FillScreen,
    /// Writes this text to the file that nudged scenes are saved in, and tells [`Show::saved`](crate::Show::saved) what came of it.
    Save(String),
}

/// The keys and what they do, for people.
pub const KEYS: [[&str; 2]; 15] = [
    ["H", "these keys"],
    ["O", "figures"],
    ["Space", "pause"],
    ["L", "lattice"],
    ["U", "uncompensated"],
    ["F", "fill the screen"],
    ["Tab", "what to nudge"],
    ["arrows, PgUp, PgDn", "nudge by 0.1 mm"],
    ["with Ctrl", "turn by 0.1 degree"],
    ["with Shift", "ten times as much"],
    ["Backspace", "last step back"],
    ["R", "all steps back"],
    ["C", "the eye is at the viewpoint"],
    ["S", "save the scene"],
    ["Esc", "end"],
];
