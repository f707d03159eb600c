//! Which key stands for what.

use midair_live::{Command, Nudge};
use winit::keyboard::{Key, ModifiersState, NamedKey};

/// What a key with these others held down stands for.
pub(crate) fn command(key: &Key, modifiers: ModifiersState) -> Option<Command> {
    let step = if modifiers.shift_key() { 1.0 } else { 0.1 };
    let turn = modifiers.control_key();
    // Along x and y the arrows move what they point to; a turn by an arrow moves the front that way.
    let nudge = |axis, sign: f64| Some(Command::Nudge(Nudge { axis, by: sign * step, turn }));
    match (key, turn) {
        (Key::Named(NamedKey::ArrowRight), false) => nudge(0, 1.0),
        (Key::Named(NamedKey::ArrowLeft), false) => nudge(0, -1.0),
        (Key::Named(NamedKey::ArrowUp), false) => nudge(1, 1.0),
        (Key::Named(NamedKey::ArrowDown), false) => nudge(1, -1.0),
        (Key::Named(NamedKey::ArrowRight), true) => nudge(1, 1.0),
        (Key::Named(NamedKey::ArrowLeft), true) => nudge(1, -1.0),
        (Key::Named(NamedKey::ArrowUp), true) => nudge(0, -1.0),
        (Key::Named(NamedKey::ArrowDown), true) => nudge(0, 1.0),
        (Key::Named(NamedKey::PageUp), _) => nudge(2, 1.0),
        (Key::Named(NamedKey::PageDown), _) => nudge(2, -1.0),
        (Key::Named(NamedKey::Escape), _) => Some(Command::End),
        (Key::Named(NamedKey::Space), _) => Some(Command::Pause),
        (Key::Named(NamedKey::Tab), _) => Some(Command::NextTarget),
        (Key::Named(NamedKey::Backspace), _) => Some(Command::Undo),
        (Key::Character(character), turn) => match (&character.to_lowercase()[..], turn) {
            ("z", true) => Some(Command::Undo),
            ("q", _) => Some(Command::End),
            ("h" | "?", _) => Some(Command::Help),
            ("l", _) => Some(Command::Lattice),
            ("u", _) => Some(Command::Uncompensated),
            ("o", _) => Some(Command::Figures),
            ("f", _) => Some(Command::FillScreen),
            ("r", _) => Some(Command::Reset),
            ("c", _) => Some(Command::Calibrate),
            ("s", _) => Some(Command::Save),
            _ => None,
        },
        _ => None,
    }
}

/// What a key stands for where pictures follow one another.
pub(crate) fn slide(key: &Key) -> Option<Slide> {
    match key {
        Key::Named(
            NamedKey::Space
            | NamedKey::Enter
            | NamedKey::ArrowRight
            | NamedKey::ArrowDown
            | NamedKey::PageDown,
        ) => Some(Slide::Next),
        Key::Named(
            NamedKey::Backspace | NamedKey::ArrowLeft | NamedKey::ArrowUp | NamedKey::PageUp,
        ) => Some(Slide::Previous),
        Key::Named(NamedKey::Escape) => Some(Slide::End),
        Key::Character(character) if character.eq_ignore_ascii_case("q") => Some(Slide::End),
        _ => None,
    }
}

/// A wish where pictures follow one another.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Slide {
    Next,
    Previous,
    End,
}
