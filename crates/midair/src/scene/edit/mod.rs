//! Writing values back into a scene file: its comments, the order of its keys and their layout stay as they are.

mod elements;
mod json;
mod path;
mod toml;

#[cfg(test)]
mod tests;

use super::error::{SceneError, SceneText};
use super::grammar::{self, Key};
use super::model::Scene;
use super::tree::{self, Entry, Node, Value};
use super::{Format, parse_with_places, to_toml};
use path::{Place, Step};
use serde::Serialize;
use std::fmt;
use std::path::{Path, PathBuf};

/// A value for a key of a scene file. Shown, it is as TOML has it.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Setting {
    /// True or false.
    Flag(bool),
    /// A whole number.
    Integer(i64),
    /// A number, in the key's unit.
    Number(f64),
    /// Several whole numbers.
    Integers(Vec<i64>),
    /// Several numbers, in the key's unit.
    Numbers(Vec<f64>),
    /// Rows of numbers.
    Rows(Vec<Vec<f64>>),
    /// A text, or the name of a file.
    Text(String),
}

impl fmt::Display for Setting {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Flag(flag) => write!(f, "{flag}"),
            Self::Integer(number) => write!(f, "{number}"),
            Self::Number(number) => write!(f, "{number:?}"),
            Self::Integers(numbers) => write!(f, "{numbers:?}"),
            Self::Numbers(numbers) => write!(f, "{numbers:?}"),
            Self::Rows(rows) => write!(f, "{rows:?}"),
            Self::Text(text) => write!(f, "{}", toml_edit::Value::from(text.as_str())),
        }
    }
}

impl From<bool> for Setting {
    fn from(flag: bool) -> Self {
        Self::Flag(flag)
    }
}

impl From<i64> for Setting {
    fn from(number: i64) -> Self {
        Self::Integer(number)
    }
}

impl From<f64> for Setting {
    fn from(number: f64) -> Self {
        Self::Number(number)
    }
}

impl<const N: usize> From<[f64; N]> for Setting {
    fn from(numbers: [f64; N]) -> Self {
        Self::Numbers(numbers.to_vec())
    }
}

impl<const N: usize> From<[i64; N]> for Setting {
    fn from(numbers: [i64; N]) -> Self {
        Self::Integers(numbers.to_vec())
    }
}

impl From<&str> for Setting {
    fn from(text: &str) -> Self {
        Self::Text(text.to_owned())
    }
}

/// A scene file that is being changed.
///
/// Keys are named by their path: `viewpoint.position`, `plate.rotation.x` (x, y and z or 0, 1 and 2 of a list), and an element by its
/// name or its number from 0: `element.cube.rotation`, `element.0.position`. A name with a dot stands in quotes.
///
/// ```
/// use midair::scene::{Format, SceneEdit};
///
/// let text = "[viewpoint]\nposition = [0, 0, 800] # measured\n[image]\nsize = [20, 20]\n[plate]\nsize = [90, 90]\n";
/// let mut file = SceneEdit::new(text, "scene.toml", Format::Toml)?;
/// file.set("viewpoint.position.y", 12.5)?;
/// assert!(file.text().contains("position = [0, 12.5, 800] # measured"));
/// # Ok::<(), midair::scene::SceneError>(())
/// ```
#[derive(Clone, Debug)]
pub struct SceneEdit {
    text: String,
    format: Format,
    scene: Scene,
    places: SceneText,
}

impl SceneEdit {
    /// A file's text. `file_name` stands in messages.
    ///
    /// # Errors
    /// [`SceneError`] where the text does not conform to the grammar. Whether the scene makes sense is for
    /// [`parse`](super::parse) and [`validate`](super::validate) to say.
    pub fn new(text: &str, file_name: &str, format: Format) -> Result<Self, SceneError> {
        let text = text.strip_prefix('\u{feff}').unwrap_or(text).to_owned();
        let (scene, places) = parse_with_places(&text, file_name, format)?;
        Ok(Self { text, format, scene, places })
    }

    /// The file that a scene was read from, as it was then.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub fn of(text: &SceneText) -> Result<Self, SceneError> {
        Self::new(text.text(), text.name(), Format::of_name(text.name()))
    }

    /// The file's text as it is now.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// The text's notation.
    pub fn format(&self) -> Format {
        self.format
    }

    /// The scene that the text describes now.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// What the scene says at a key, be it by default; `None` where it leaves the key out.
    ///
    /// # Errors
    /// [`SceneError`] where there is no such key or element, or the path names a block.
    pub fn get(&self, path: &str) -> Result<Option<Setting>, SceneError> {
        let (place, _) = self.place(path)?;
        let known = self.known(&place.steps).and_then(|node| setting(&node));
        match (&place.component, known) {
            (Some(component), Some(list)) => component
                .get(&list)
                .map(Some)
                .map_err(|(message, help)| self.wrong(path, &message, help)),
            (_, known) => Ok(known),
        }
    }

    /// The unit of a key's numbers, as the scene file's reference has it; `None` where they have none.
    ///
    /// # Errors
    /// As [`get`](Self::get).
    pub fn unit(&self, path: &str) -> Result<Option<&'static str>, SceneError> {
        Ok(self.place(path)?.1.unit)
    }

    /// Where a key stands, and what the grammar says of it.
    fn place(&self, path: &str) -> Result<(Place, &'static Key), SceneError> {
        let place = Place::new(path, &self.scene)
            .map_err(|(message, help)| self.wrong(path, &message, help))?;
        let names = place.steps.iter().filter_map(|step| match step {
            Step::Key(name) => Some(name.as_str()),
            Step::Item(_) => None,
        });
        let all = "`midair schema` lists all keys";
        match grammar::key(names) {
            Some(key) if key.kind.is_block() => {
                Err(self.wrong(path, "this is a block of keys", "name one of its keys"))
            }
            Some(key) => Ok((place, key)),
            None => Err(self.wrong(path, "there is no such key", all)),
        }
    }

    fn wrong(&self, path: &str, message: &str, help: impl Into<String>) -> SceneError {
        self.places.error_at(path, format!("`{path}`: {message}"), help)
    }

    /// The text, and where each of its keys stands.
    pub(in crate::scene) fn places(&self) -> &SceneText {
        &self.places
    }

    /// Gives a key a value. A key that the file leaves out is added to its block, and the block if need be.
    ///
    /// # Errors
    /// [`SceneError`] where there is no such key or element, or where the value does not conform; the text stays as it was.
    pub fn set(&mut self, path: &str, value: impl Into<Setting>) -> Result<(), SceneError> {
        let wrong = |message: String, help: String| self.wrong(path, &message, help);
        let place =
            Place::new(path, &self.scene).map_err(|(message, help)| wrong(message, help))?;
        let value = match &place.component {
            None => value.into(),
            Some(component) => {
                let known = self.known(&place.steps).and_then(|node| setting(&node));
                component
                    .put(known, value.into())
                    .map_err(|(message, help)| wrong(message, help))?
            }
        };
        self.accept(vec![(place.steps, Some(value))])
    }

    /// Gives the files that the scene names other names: those by which they are found from where the scene is to be saved.
    ///
    /// # Errors
    /// [`SceneError`] where a name is no text.
    pub fn rename_files(&mut self, rename: &dyn Fn(&Path) -> PathBuf) -> Result<(), SceneError> {
        let of_element = |i: usize| {
            ["shape", "material", "fill"].map(|block| format!("element.{i}.{block}.file"))
        };
        let others = ["plate.luminance", "display.response", "display.emission"];
        let elements = (0..self.scene.elements.len()).flat_map(of_element);
        for key in elements.chain(others.map(str::to_owned)).collect::<Vec<_>>() {
            let Ok(Some(Setting::Text(name))) = self.get(&key) else { continue };
            let renamed = rename(Path::new(&name));
            let Some(renamed) = renamed.to_str() else {
                let message = format!("{} is not a name in UTF-8", renamed.display());
                return Err(self.wrong(&key, &message, "save the scene elsewhere"));
            };
            if renamed != name {
                self.set(&key, renamed)?;
            }
        }
        Ok(())
    }

    /// Writes all that another scene says differently.
    ///
    /// # Errors
    /// [`SceneError`] where the scene cannot be written so that the text describes it, such as one with more elements; the text stays as
    /// it was. [`to_toml`] writes any scene, without the file's comments.
    pub fn set_scene(&mut self, scene: &Scene) -> Result<(), SceneError> {
        let whole = |message: &str| {
            self.places.error(
                None,
                message,
                "save it as a scene of its own, without the file's comments",
            )
        };
        if scene.elements.len() != self.scene.elements.len() {
            return Err(whole("the changed scene has other elements than the file"));
        }
        let [Some(before), Some(after)] = [described(&self.scene), described(scene)] else {
            return Err(whole("the changed scene has numbers that are none"));
        };
        let mut changes = Vec::new();
        differences(&before, &after, &mut Vec::new(), &mut changes);
        let mut changed = self.clone();
        changed.accept(changes)?;
        if changed.scene != *scene {
            return Err(whole("the changed scene cannot be written into the file"));
        }
        *self = changed;
        Ok(())
    }

    /// What the scene says at a key, be it by default.
    fn known(&self, steps: &[Step]) -> Option<Node> {
        let mut node = described(&self.scene)?;
        for step in steps {
            node = match (node.value, step) {
                (Value::Table(entries), Step::Key(key)) => {
                    entries.into_iter().find(|entry| entry.key == *key)?.node
                }
                (Value::List(nodes), Step::Item(i)) => nodes.into_iter().nth(*i)?,
                _ => return None,
            };
        }
        Some(node)
    }

    /// Makes changes if the text conforms with them.
    fn accept(&mut self, changes: Vec<Change>) -> Result<(), SceneError> {
        let write = match self.format {
            Format::Toml => toml::write,
            Format::Json => json::write,
        };
        let changes = changes.into_iter().map(|(steps, value)| (self.where_given(steps), value));
        let text = write(&self.text, &changes.collect::<Vec<_>>()).map_err(|problem| {
            let help = "write the key into the file by hand, then it can be changed";
            self.places.error(None, problem, help)
        })?;
        *self = Self::new(&text, self.places.name(), self.format)?;
        Ok(())
    }

    /// An element's absorption may stand beside its material as well as in it.
    fn where_given(&self, mut steps: Vec<Step>) -> Vec<Step> {
        if let [Step::Key(_), Step::Item(i), Step::Key(material), Step::Key(key)] = &steps[..]
            && material == "material"
            && key == "absorption"
            && self.places.has(&format!("element[{i}].absorption"))
        {
            steps.remove(2);
        }
        steps
    }
}

/// What is to stand at a key; `None`: the key goes.
type Change = (Vec<Step>, Option<Setting>);

/// A scene with all its keys, those left to their defaults as well. `None` if some number is none.
fn described(scene: &Scene) -> Option<Node> {
    let text = to_toml(scene);
    tree::parse(&SceneText::new("scene", &text), &text, Format::Toml).ok()
}

/// What is different, key by key.
fn differences(before: &Node, after: &Node, at: &mut Vec<Step>, changes: &mut Vec<Change>) {
    let find = |table: &[Entry], key: &str| table.iter().position(|entry| entry.key == key);
    match (&before.value, &after.value) {
        (Value::Table(old), Value::Table(new)) => {
            for entry in old.iter().filter(|entry| find(new, &entry.key).is_none()) {
                at.push(Step::Key(entry.key.clone()));
                changes.push((at.clone(), None));
                at.pop();
            }
            for entry in new {
                at.push(Step::Key(entry.key.clone()));
                match find(old, &entry.key) {
                    Some(i) => differences(&old[i].node, &entry.node, at, changes),
                    None => additions(&entry.node, at, changes),
                }
                at.pop();
            }
        }
        (Value::List(old), Value::List(new))
            if new.iter().all(|node| matches!(node.value, Value::Table(_))) =>
        {
            for (i, (old, new)) in old.iter().zip(new).enumerate() {
                at.push(Step::Item(i));
                differences(old, new, at, changes);
                at.pop();
            }
        }
        _ => {
            let value = setting(after);
            if value != setting(before) {
                changes.push((at.clone(), value));
            }
        }
    }
}

/// All of a node that was not there before.
fn additions(node: &Node, at: &mut Vec<Step>, changes: &mut Vec<Change>) {
    match &node.value {
        Value::Table(entries) => {
            for entry in entries {
                at.push(Step::Key(entry.key.clone()));
                additions(&entry.node, at, changes);
                at.pop();
            }
        }
        _ => changes.push((at.clone(), setting(node))),
    }
}

/// A node as a value; `None` for blocks.
fn setting(node: &Node) -> Option<Setting> {
    let number = |node: &Node| match node.value {
        Value::Integer(i) => Some(i as f64),
        Value::Number(n) => Some(n),
        _ => None,
    };
    let numbers = |nodes: &[Node]| nodes.iter().map(number).collect::<Option<Vec<f64>>>();
    let integer = |node: &Node| match node.value {
        Value::Integer(i) => Some(i),
        _ => None,
    };
    Some(match &node.value {
        Value::Flag(flag) => Setting::Flag(*flag),
        Value::Integer(i) => Setting::Integer(*i),
        Value::Number(n) => Setting::Number(*n),
        Value::Text(text) => Setting::Text(text.clone()),
        Value::List(nodes) => match nodes.iter().map(integer).collect() {
            Some(integers) => Setting::Integers(integers),
            None => match numbers(nodes) {
                Some(numbers) => Setting::Numbers(numbers),
                None => Setting::Rows(
                    nodes
                        .iter()
                        .map(|row| match &row.value {
                            Value::List(row) => numbers(row),
                            _ => None,
                        })
                        .collect::<Option<_>>()?,
                ),
            },
        },
        Value::Table(_) | Value::Other(_) => return None,
    })
}
