//! What to write instead: near misses, words of the field, examples.

use crate::optics::glass;
use crate::scene::grammar::{Key, Kind};
use crate::scene::tree::{Entry, Value, millimetres, split_unit};

/// What to write instead of a value that is nearly right: a name for a block, one number for several.
pub(super) fn instead(key: &Key, value: &Value) -> Option<String> {
    match (&key.kind, value) {
        (Kind::Block(_), Value::Text(text)) if key.name == "material" => Some(material_of(text)),
        (Kind::Variants(variants), Value::Text(text)) => {
            let names = || variants.iter().map(|(name, _)| *name);
            let name = nearest(text, names()).or_else(|| names().next())?;
            Some(format!("write `{} = {{ kind = \"{name}\", ... }}` with its measures", key.name))
        }
        (Kind::Numbers(..) | Kind::Integers(..), Value::Integer(number)) => {
            Some(for_one_number(key, *number as f64))
        }
        (Kind::Numbers(..) | Kind::Integers(..), Value::Number(number)) => {
            Some(for_one_number(key, *number))
        }
        _ => None,
    }
}

/// What to write instead of a material's name.
fn material_of(text: &str) -> String {
    let name = shortened(text);
    if text.eq_ignore_ascii_case("mirror") {
        return "write `material = { mirror = true }`".to_owned();
    }
    match glass::names()
        .find(|known| known.eq_ignore_ascii_case(text))
        .or_else(|| nearest(text, glass::names()))
    {
        Some(known) => format!("write `material = {{ glass = \"{known}\" }}`"),
        None => format!(
            "no glass of the catalogue is called `{name}`: write `material = {{ ior = 1.49 }}` with its refractive index, or \
             `material = {{ mirror = true }}`"
        ),
    }
}

/// What to write instead of one number where the key needs several.
fn for_one_number(key: &Key, number: f64) -> String {
    let line = match (&key.kind, key.unit) {
        (Kind::Numbers(3, ..), Some("degrees")) => {
            format!(
                "`{} = [0.0, {number:?}, 0.0]` for a turn about the vertical; the others are about x (nodding) and about z",
                key.name
            )
        }
        (Kind::Numbers(len @ 2.., ..), _) if key.name == "size" => {
            format!("`size = [{}]` for equal sides", vec![format!("{number:?}"); *len].join(", "))
        }
        (Kind::Integers(len, ..), _) => {
            format!("`{} = [{}]`", key.name, vec![format!("{number}"); *len].join(", "))
        }
        _ => example(key),
    };
    format!("write {line}: {}", in_sentence(key.about))
}

/// What to write instead of a number in quotes.
pub(super) fn number_in_text(key: &Key, text: &str) -> String {
    let rule = match key.unit {
        Some("mm") => "lengths are numbers in millimetres, or texts such as \"5 cm\"".to_owned(),
        Some(unit) => format!("this is a plain number ({unit}), without quotes or unit"),
        None => "this is a plain number, without quotes or unit".to_owned(),
    };
    let Some((number, unit)) = split_unit(text) else { return rule };
    let number = match (key.unit, unit) {
        (Some("mm"), "") => Some(number),
        (Some("mm"), unit) => millimetres(unit).map(|factor| number * factor),
        (Some("degrees"), "deg" | "degrees" | "°") => Some(number),
        (_, "") => Some(number),
        _ => None,
    };
    match number {
        Some(number) => format!("{rule}: write {number:?}"),
        None => rule,
    }
}

pub(super) fn numeric(kind: &Kind) -> bool {
    matches!(
        kind,
        Kind::Number(..)
            | Kind::Integer(..)
            | Kind::Numbers(..)
            | Kind::Integers(..)
            | Kind::Colour(..)
            | Kind::Rows(..)
            | Kind::List(..)
            | Kind::Points(..)
    )
}

pub(super) fn wanted(kind: &Kind) -> String {
    match kind {
        Kind::Text | Kind::Choice(_) | Kind::Glass => "a text in quotes".to_owned(),
        Kind::File => "a file name in quotes".to_owned(),
        Kind::Flag => "true or false".to_owned(),
        Kind::Number(..) => "a number".to_owned(),
        Kind::Integer(..) => "a whole number".to_owned(),
        Kind::Numbers(len, ..) => format!("a list of {len} numbers"),
        Kind::Integers(len, ..) => format!("a list of {len} whole numbers"),
        Kind::Colour(..) => "a number or a list of 3".to_owned(),
        Kind::Rows(..) => "a list of rows of numbers".to_owned(),
        Kind::List(..) => "a list of numbers".to_owned(),
        Kind::Points(..) => "a list of points [.., ..]".to_owned(),
        Kind::Block(_) | Kind::Variants(_) => "a block of keys".to_owned(),
        Kind::Blocks(_) => "a list of blocks".to_owned(),
    }
}

/// How one would write this key, as text for a remedy.
pub(super) fn example(key: &Key) -> String {
    let name = key.name;
    match &key.kind {
        Kind::Text => format!("`{name} = \"...\"`"),
        Kind::File => format!("`{name} = \"folder/file\"`"),
        Kind::Flag => format!("`{name} = true`"),
        Kind::Number(least, most) => {
            let value = [50.0, 1.0].into_iter().find(|v| (least..=most).contains(&v));
            format!("`{name} = {:?}`", value.unwrap_or(*least))
        }
        Kind::Integer(least, most) => format!("`{name} = {}`", 32.clamp(*least, *most)),
        Kind::Numbers(3, ..) if key.unit == Some("degrees") => {
            format!("`{name} = [0.0, 30.0, 0.0]`")
        }
        Kind::Numbers(3, ..) if name == "position" => format!("`{name} = [0.0, 0.0, -150.0]`"),
        Kind::Numbers(len, ..) => format!("`{name} = [{}]`", vec!["50.0"; *len].join(", ")),
        Kind::Integers(len, ..) => format!("`{name} = [{}]`", vec!["1024"; *len].join(", ")),
        Kind::Colour(..) => format!("`{name} = 0.9` or `{name} = [0.9, 0.9, 0.9]`"),
        Kind::Rows(..) => format!("`{name} = [[0.0, 0.0], [0.0, 0.0]]`"),
        Kind::List(..) => format!("`{name} = [1e-5]`"),
        Kind::Points(..) => format!("`{name} = [[20.0, -40.0], [30.0, 0.0], [20.0, 40.0]]`"),
        Kind::Choice(choices) => format!("`{name} = \"{}\"`", choices.first().unwrap_or(&"")),
        Kind::Glass => format!("`{name} = \"N-BK7\"`"),
        Kind::Block(_) | Kind::Variants(_) => format!("a block `{name}`"),
        Kind::Blocks(_) => format!("a block `[[{name}]]`"),
    }
}

pub(super) fn chosen(group: &[&str], entry: &Entry) -> bool {
    // `mirror = false` chooses nothing.
    group.contains(&entry.key.as_str()) && !matches!(entry.node.value, Value::Flag(false))
}

pub(super) fn join(path: &str, key: &str) -> String {
    if path.is_empty() { key.to_owned() } else { format!("{path}.{key}") }
}

pub(super) fn quoted<'a>(names: impl Iterator<Item = &'a str>) -> String {
    names.map(|n| format!("`{n}`")).collect::<Vec<_>>().join(", ")
}

/// "did you mean" for the nearest name, then all of them.
pub(super) fn suggestion<'a>(
    given: &str,
    known: impl Iterator<Item = &'a str> + Clone,
    all: &str,
) -> String {
    match nearest(given, known) {
        Some(name) => format!("did you mean `{name}`? {all}"),
        None => all.to_owned(),
    }
}

/// Words that people use, and what they are called here: too far apart for a typing error.
const WORDS: [(&str, &str); 43] = [
    ("cube", "box"),
    ("cuboid", "box"),
    ("block", "box"),
    ("ball", "sphere"),
    ("globe", "sphere"),
    ("rod", "cylinder"),
    ("tube", "cylinder"),
    ("frustum", "cone"),
    ("egg", "ellipsoid"),
    ("bottle", "lathe"),
    ("vase", "lathe"),
    ("bowl", "lathe"),
    ("glass", "lathe"),
    ("revolution", "lathe"),
    ("turned", "lathe"),
    ("dome", "hemisphere"),
    ("ring", "torus"),
    ("donut", "torus"),
    ("wedge", "prism"),
    ("extrusion", "prism"),
    ("hollow", "wall"),
    ("liquid", "fill"),
    ("flat", "plane"),
    ("mirror", "plane"),
    ("model", "mesh"),
    ("eye", "viewpoint"),
    ("viewer", "viewpoint"),
    ("camera", "viewpoint"),
    ("mmap", "plate"),
    ("aska3d", "plate"),
    ("screen", "display"),
    ("monitor", "display"),
    ("tablet", "display"),
    ("object", "element"),
    ("pixels", "resolution"),
    ("dimensions", "size"),
    ("location", "position"),
    ("centre", "position"),
    ("center", "position"),
    ("angles", "rotation"),
    ("orientation", "rotation"),
    ("index", "ior"),
    ("n", "ior"),
];

/// The known name that was probably meant.
pub(super) fn nearest<'a>(
    given: &str,
    known: impl Iterator<Item = &'a str> + Clone,
) -> Option<&'a str> {
    let given = shortened(given).to_lowercase();
    if let Some((_, meant)) = WORDS.iter().find(|(word, _)| *word == given)
        && let Some(name) = known.clone().find(|name| name == meant)
    {
        return Some(name);
    }
    let (distance, name) = known
        .map(|name| (strsim::damerau_levenshtein(&given, &name.to_lowercase()), name))
        .min_by_key(|(distance, _)| *distance)?;
    // Half the letters right, or a word cut short or drawn out: nearer names are typing errors,
    // farther ones guesses.
    let begun = name.len() > 1 && (given.starts_with(name) || name.starts_with(&given));
    (begun || distance * 2 <= name.len().max(2)).then_some(name)
}

/// Hostile names are cut for messages, and for the comparison's cost.
pub(super) fn shortened(text: &str) -> String {
    const MOST: usize = 60;
    let clean = |c: char| if c.is_control() { '\u{fffd}' } else { c };
    if text.chars().count() <= MOST {
        text.chars().map(clean).collect()
    } else {
        text.chars().take(MOST).map(clean).chain("...".chars()).collect()
    }
}

/// A description as the second half of a sentence.
pub(super) fn in_sentence(about: &str) -> String {
    let mut chars = about.trim_end_matches('.').chars();
    chars.next().map_or(String::new(), |first| first.to_lowercase().chain(chars).collect())
}
