//! A finding: what is wrong, how bad it is, and what helps.

use crate::scene::Setting;
use serde::Serialize;
use std::fmt::Write as _;

/// What a finding is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum Kind {
    /// Two things stand in one another.
    StandingIn,
    /// The image that the plate forms of the display floats elsewhere.
    OffPlace,
    /// A part of the image is not formed.
    NotFormed,
    /// A part of the image shares its display pixels with others.
    Folded,
    /// No path meets an element.
    Unmet,
    /// The image sticks out of the object that it stands in.
    SticksOut,
    /// How much light arrives.
    Light,
    /// Display pixels are not square.
    PixelShape,
    /// Which display pixels the image gets.
    PixelCount,
    /// A length looks as if it was measured in another unit.
    Unit,
    /// The eye stands in something.
    EyeInside,
}

/// How grave a finding is; the gravest is the least.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Severity {
    /// It cannot be built, or shows nothing.
    Fault,
    /// It can be built and will disappoint.
    Warning,
    /// Worth knowing.
    Note,
}

impl Severity {
    /// Of a lost share of the image.
    pub(super) fn of_lost(share: f64) -> Self {
        // Half an image is no image; what is lost at a rim or an edge is a warning.
        if share > 0.5 { Self::Fault } else { Self::Warning }
    }

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Fault => "fault",
            Self::Warning => "warning",
            Self::Note => "note",
        }
    }
}

/// A value to write into the scene file.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Line {
    /// The key's path, as [`SceneEdit`](crate::scene::SceneEdit) has it.
    pub key: String,
    /// What to write there.
    pub value: Setting,
}

/// One finding.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Finding {
    /// What it is about.
    pub kind: Kind,
    /// How grave it is.
    pub severity: Severity,
    /// What is found, in a sentence.
    pub sentence: String,
    /// What helps; `None` where nothing need be done.
    pub remedy: Option<String>,
    /// The remedy as values for the scene file; empty where it cannot be said so. All of them belong together.
    pub lines: Vec<Line>,
}

impl Finding {
    pub(super) fn new(kind: Kind, severity: Severity, sentence: impl Into<String>) -> Self {
        Self { kind, severity, sentence: sentence.into(), remedy: None, lines: Vec::new() }
    }

    pub(super) fn remedy(self, remedy: impl Into<String>) -> Self {
        Self { remedy: Some(remedy.into()), ..self }
    }

    pub(super) fn line(mut self, key: impl Into<String>, value: impl Into<Setting>) -> Self {
        self.lines.push(Line { key: key.into(), value: value.into() });
        self
    }

    /// The lines as a scene file in TOML has them; empty if there are none.
    pub fn lines_as_toml(&self) -> String {
        let mut text = String::new();
        let mut block = None;
        for Line { key, value } in &self.lines {
            let (path, name) = key.rsplit_once('.').unwrap_or(("", key));
            if block != Some(path) && !path.is_empty() {
                let _ = match path.strip_prefix("element.") {
                    Some(element) => writeln!(text, "[[element]]   # {element}"),
                    None => writeln!(text, "[{path}]"),
                };
            }
            block = Some(path);
            let _ = writeln!(text, "{name} = {value}");
        }
        text
    }
}

/// Millimetres as they are to be written: to a hundredth, and no negative zero.
pub(super) fn millimetres<const N: usize>(values: [f64; N]) -> [f64; N] {
    values.map(|value| (value * 100.0).round() / 100.0 + 0.0)
}

/// Degrees as they are to be written: to a millionth, and no negative zero.
pub(super) fn degrees<const N: usize>(values: [f64; N]) -> [f64; N] {
    values.map(|value| (value * 1e6).round() / 1e6 + 0.0)
}

/// A key's path to an element: its name in quotes where it needs them.
pub(super) fn element_key(name: &str, key: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '_';
    if !name.is_empty() && name.chars().all(plain) {
        format!("element.{name}.{key}")
    } else {
        format!("element.\"{name}\".{key}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_stand_under_their_blocks() {
        let finding = Finding::new(Kind::Unit, Severity::Note, "")
            .line("plate.position", [0.0, 0.0, -180.0])
            .line("plate.size", [100.0, 90.5])
            .line("display.resolution", [4i64, 3])
            .line("element.\"my cube\".priority", 2i64)
            .line("max_interactions", 64i64);
        assert_eq!(
            finding.lines_as_toml(),
            "[plate]\nposition = [0.0, 0.0, -180.0]\nsize = [100.0, 90.5]\n[display]\nresolution = [4, 3]\n\
             [[element]]   # \"my cube\"\npriority = 2\nmax_interactions = 64\n"
        );
    }
}
