//! The path of a key: `element.cube.rotation.y`.

use super::super::model::Scene;
use super::Setting;

/// One step from the outermost block to a key.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Step {
    /// Into a block, or to its key.
    Key(String),
    /// To an element, counted from 0.
    Item(usize),
}

/// A number of a list.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Component(usize);

/// What is wrong, and what helps.
type Fault = (String, String);

impl Component {
    fn named(name: &str) -> Option<Self> {
        match name {
            "x" => Some(Self(0)),
            "y" => Some(Self(1)),
            "z" => Some(Self(2)),
            digits => digits.parse().ok().map(Self),
        }
    }

    /// This number of a list.
    pub fn get(&self, list: &Setting) -> Result<Setting, Fault> {
        let (length, found) = match list {
            Setting::Integers(list) => {
                (list.len(), list.get(self.0).copied().map(Setting::Integer))
            }
            Setting::Numbers(list) => (list.len(), list.get(self.0).copied().map(Setting::Number)),
            _ => {
                return Err((
                    "this is no list of numbers".to_owned(),
                    "leave its last part out".to_owned(),
                ));
            }
        };
        found.ok_or_else(|| short(length))
    }

    /// The list with this number of it replaced.
    pub fn put(&self, list: Option<Setting>, value: Setting) -> Result<Setting, Fault> {
        let missing = || {
            (
                "the file gives no list there".to_owned(),
                "give the key all of its numbers first, such as [0.0, 0.0, 0.0]".to_owned(),
            )
        };
        match (list, value) {
            (Some(Setting::Integers(mut list)), Setting::Integer(value)) => {
                let length = list.len();
                *list.get_mut(self.0).ok_or_else(|| short(length))? = value;
                Ok(Setting::Integers(list))
            }
            (Some(Setting::Numbers(mut list)), Setting::Number(value)) => {
                let length = list.len();
                *list.get_mut(self.0).ok_or_else(|| short(length))? = value;
                Ok(Setting::Numbers(list))
            }
            (Some(Setting::Numbers(list)), Setting::Integer(value)) => {
                self.put(Some(Setting::Numbers(list)), Setting::Number(value as f64))
            }
            (Some(Setting::Integers(_) | Setting::Numbers(_)), _) => Err((
                "this is one number of a list".to_owned(),
                "give it a number; whole pixels for a resolution".to_owned(),
            )),
            _ => Err(missing()),
        }
    }
}

fn short(length: usize) -> Fault {
    (format!("the list has {length} numbers"), "they are x, y and z, or 0, 1 and 2".to_owned())
}

/// Where a value stands.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Place {
    pub steps: Vec<Step>,
    /// One of its numbers only.
    pub component: Option<Component>,
}

impl Place {
    pub fn new(path: &str, scene: &Scene) -> Result<Self, Fault> {
        let mut words = words(path)?.into_iter().peekable();
        let mut place = Self { steps: Vec::new(), component: None };
        while let Some(word) = words.next() {
            let last = words.peek().is_none();
            match (Component::named(&word), last, place.steps.is_empty()) {
                (Some(component), true, false) => place.component = Some(component),
                _ => place.steps.push(Step::Key(word.clone())),
            }
            if word == "element" && place.steps.len() == 1 {
                let which = words.next().ok_or_else(|| no_element("", scene))?;
                place.steps.push(Step::Item(element(&which, scene)?));
            }
        }
        if place.steps.is_empty() {
            return Err((
                "this names no key".to_owned(),
                "name one by its blocks, such as viewpoint.position".to_owned(),
            ));
        }
        Ok(place)
    }
}

/// The words between dots and within brackets; a word in quotes may hold either.
fn words(path: &str) -> Result<Vec<String>, Fault> {
    let mut words = vec![String::new()];
    let mut quoted = false;
    for c in path.chars() {
        match c {
            '"' => quoted = !quoted,
            '.' | '[' if !quoted => words.push(String::new()),
            ']' if !quoted => {}
            c => words.last_mut().expect("there is a first word").push(c),
        }
    }
    if quoted || words.iter().any(String::is_empty) {
        let help = "write keys with single dots between them, such as element.cube.rotation";
        return Err(("this is no path of a key".to_owned(), help.to_owned()));
    }
    Ok(words)
}

/// An element by its name, or else by its number.
fn element(which: &str, scene: &Scene) -> Result<usize, Fault> {
    let mut named = (0..scene.elements.len()).filter(|&i| scene.elements[i].name == which);
    match (named.next(), named.next()) {
        (Some(_), Some(_)) => Err((
            format!("several elements have the name {which}"),
            "name the element by its number, counted from 0, such as element.0".to_owned(),
        )),
        (Some(i), None) => Ok(i),
        (None, _) => {
            let number = which.parse().ok().filter(|&i: &usize| i < scene.elements.len());
            number.ok_or_else(|| no_element(which, scene))
        }
    }
}

fn no_element(which: &str, scene: &Scene) -> Fault {
    let names: Vec<&str> = scene.elements.iter().map(|element| &element.name[..]).collect();
    let help = match names.len() {
        0 => "the scene has no elements".to_owned(),
        count => format!("the scene has {}, or 0 to {}", names.join(", "), count - 1),
    };
    (format!("there is no element {which}").trim_end().to_owned(), help)
}
