//! The database's YAML: entries of DATA with their lines, formulas' coefficients, tables in columns.

use super::{COEFFICIENTS, Dispersion, GlassFile, Table};
use saphyr::{MarkedYaml, ScalarStyle, ScanError, YamlData, YamlLoader};
use saphyr_parser::{Event, Parser, SpannedEventReceiver as _};

/// A line and what is wrong with it.
type Fault = (usize, String);

/// A value of an entry of DATA: its text and line.
#[derive(Clone, Debug)]
struct Text {
    key: String,
    value: String,
    line: usize,
}

/// An entry of the list DATA.
struct Entry {
    line: usize,
    texts: Vec<Text>,
}

impl Entry {
    fn text(&self, key: &str) -> Option<&Text> {
        self.texts.iter().find(|text| text.key == key)
    }

    fn needed(&self, key: &str) -> Result<&Text, Fault> {
        self.text(key)
            .ok_or_else(|| (self.line, format!("this entry of DATA has no `{key}`; add it")))
    }
}

pub(super) fn parse(yaml: &str) -> Result<GlassFile, Fault> {
    let entries = entries(yaml)?;
    let mut index: Option<(Dispersion, [f64; 2])> = None;
    let mut extinction = None;
    for entry in &entries {
        let kind = entry.needed("type")?;
        let words: Vec<&str> = kind.value.split_whitespace().collect();
        let found = match words[..] {
            ["tabulated", "n"] => {
                let [n] = columns(entry, ["n"])?;
                Some((n.range(), Dispersion::Table(n)))
            }
            ["tabulated", "nk"] => {
                let [n, k] = columns(entry, ["n", "k"])?;
                extinction = Some(k);
                Some((n.range(), Dispersion::Table(n)))
            }
            ["tabulated", "k"] => {
                let [k] = columns(entry, ["k"])?;
                extinction = Some(k);
                None
            }
            ["formula", number] => Some(dispersion(entry, kind, number)?),
            _ => {
                let problem = format!(
                    "the type `{}` is not known; it must be tabulated n, tabulated nk, tabulated k, or formula 1 to formula 9",
                    kind.value.trim()
                );
                return Err((kind.line, problem));
            }
        };
        if let Some((range, dispersion)) = found {
            // A fit and the table that it was made of are both in some files: the last entry counts, as for those who read the database otherwise.
            index = Some((dispersion, range));
        }
    }
    let Some((index, range)) = index else {
        let line = entries.first().map_or(1, |entry| entry.line);
        let problem = "DATA says nothing of an index; it needs an entry of type tabulated n, tabulated nk, or formula 1 to formula 9";
        return Err((line, problem.to_owned()));
    };
    Ok(GlassFile { index, range, extinction })
}

/// A formula's wavelengths and coefficients.
fn dispersion(entry: &Entry, kind: &Text, number: &str) -> Result<([f64; 2], Dispersion), Fault> {
    let known = number.parse::<u8>().ok().filter(|number| (1..=9).contains(number));
    let Some(number) = known else {
        let problem = format!(
            "formula {number} is not known; it must be 1 to 9, else give the index as tabulated n"
        );
        return Err((kind.line, problem));
    };
    let text = entry.needed("coefficients")?;
    let coefficients = numbers(&text.value).map_err(|problem| (text.line, problem))?;
    let (least, most) = COEFFICIENTS[usize::from(number) - 1];
    if !(least..=most).contains(&coefficients.len()) {
        let many = if least == most { least.to_string() } else { format!("{least} to {most}") };
        let problem =
            format!("formula {number} has {many} coefficients; here are {}", coefficients.len());
        return Err((text.line, problem));
    }
    let key = if entry.text("wavelength_range").is_some() { "wavelength_range" } else { "range" };
    let text = entry.text(key).ok_or_else(|| {
        let problem =
            "this formula has no `wavelength_range`; add it, such as 0.4 0.8 (micrometres)";
        (entry.line, problem.to_owned())
    })?;
    match numbers(&text.value).map_err(|problem| (text.line, problem))?[..] {
        [low, high] if 0.0 < low && low < high => {
            Ok(([low, high], Dispersion::Formula { number, coefficients }))
        }
        _ => {
            let problem = format!(
                "the range `{}` must be two wavelengths in micrometres, the shorter one first",
                text.value.trim()
            );
            Err((text.line, problem))
        }
    }
}

/// The columns after the wavelength of an entry's table.
fn columns<const N: usize>(entry: &Entry, names: [&str; N]) -> Result<[Table; N], Fault> {
    let text = entry.needed("data")?;
    let mut rows: Vec<(f64, [f64; N])> = Vec::new();
    for (k, row) in text.value.lines().enumerate() {
        let line = text.line + k;
        if row.trim().is_empty() {
            continue;
        }
        let row = numbers(row).map_err(|problem| (line, problem))?;
        if row.len() != N + 1 {
            let problem = format!(
                "{} numbers; a line of this table is a wavelength in micrometres and {}",
                row.len(),
                names.join(" and ")
            );
            return Err((line, problem));
        }
        let wavelength = row[0];
        if wavelength <= 0.0 {
            return Err((
                line,
                format!("the wavelength {wavelength} must be more than 0 micrometres"),
            ));
        }
        let mut values = [0.0; N];
        for ((value, &found), name) in values.iter_mut().zip(&row[1..]).zip(names) {
            // A measured k that is too small to be told from none comes out on either side of it.
            let none = name == "k" && found > -NOISE;
            if found < 0.0 && !none {
                if ASKED_FOR.contains(&wavelength) {
                    return Err((line, format!("{name} is {found}; it cannot be negative")));
                }
                *value = f64::NAN;
                continue;
            }
            *value = found.max(0.0);
        }
        rows.push((wavelength, values));
    }
    if rows.is_empty() {
        return Err((text.line, "the table is empty; give it at least one line".to_owned()));
    }
    // Tables put together of several measurements have pairs out of order, and wavelengths twice: then the first counts.
    rows.sort_by(|a, b| a.0.total_cmp(&b.0));
    rows.dedup_by(|next, kept| next.0 == kept.0);
    let column = |c: usize| Table {
        wavelengths: rows.iter().map(|row| row.0).collect(),
        values: rows.iter().map(|row| row.1[c]).collect(),
    };
    Ok(std::array::from_fn(column))
}

/// Wavelengths in micrometres that displays have. A slip of the pen beyond them, as some of the database's files have, says nothing of these.
const ASKED_FOR: std::ops::RangeInclusive<f64> = 0.38..=0.78;

/// A k above minus this is none: what the tables are measured with does not tell smaller ones from it.
const NOISE: f64 = 1e-6;

/// Numbers between blanks.
fn numbers(text: &str) -> Result<Vec<f64>, String> {
    let number = |word: &str| match word.parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value),
        _ => Err(format!("`{word}` is not a number")),
    };
    text.split_whitespace().map(number).collect()
}

/// The entries of the top level's list DATA.
fn entries(yaml: &str) -> Result<Vec<Entry>, Fault> {
    let root = tree(yaml)?;
    let keys = root.as_ref().and_then(|root| root.data.as_mapping());
    let data = keys.and_then(|keys| keys.iter().find(|(key, _)| scalar(key) == Some("DATA")));
    let Some((_, data)) = data else {
        let problem = "there is no DATA; a glass file is YAML as refractiveindex.info has it, with a list DATA";
        return Err((1, problem.to_owned()));
    };
    let no_list = || {
        let problem = "DATA must be a list of entries, each with a `type`";
        (data.span.start.line(), problem.to_owned())
    };
    let list = data.data.as_sequence().filter(|list| !list.is_empty()).ok_or_else(no_list)?;
    list.iter().map(|node| entry(yaml, node).ok_or_else(no_list)).collect()
}

/// A scalar as it is written.
fn scalar<'a>(node: &'a MarkedYaml<'_>) -> Option<&'a str> {
    match &node.data {
        YamlData::Representation(text, ..) => Some(text),
        _ => None,
    }
}

/// An entry's texts; what is no text is passed over. `None` if it is no mapping.
fn entry(yaml: &str, node: &MarkedYaml<'_>) -> Option<Entry> {
    let text = |(key, node): (&MarkedYaml<'_>, &MarkedYaml<'_>)| {
        let (key, value) = (scalar(key)?.to_owned(), scalar(node)?.to_owned());
        let line = node.span.start.line();
        // A block begins on the line after its mark.
        let block = matches!(node.data, YamlData::Representation(_, ScalarStyle::Literal, _));
        let line = line + usize::from(block && at_mark(yaml, line));
        Some(Text { key, value, line })
    };
    let texts = node.data.as_mapping()?.iter().filter_map(text).collect();
    Some(Entry { line: node.span.start.line(), texts })
}

/// Nodes within nodes: a glass file has three levels, and a tree that is as deep as a hostile file exhausts the stack.
const DEEPEST: usize = 32;

/// The first document, each scalar as it is written; `None` if there is none.
fn tree(yaml: &str) -> Result<Option<MarkedYaml<'_>>, Fault> {
    let fault =
        |error: ScanError| (error.marker().line(), format!("this is no YAML: {}", error.info()));
    let mut loader = YamlLoader::<MarkedYaml<'_>>::default();
    loader.early_parse(false);
    let mut depth = 0;
    for event in Parser::new_from_str(yaml) {
        let (event, span) = event.map_err(fault)?;
        // Nothing is kept for aliases, which would bring their own depth and number of nodes with them.
        let event = match event {
            Event::Alias(_) => {
                let problem = "an alias (`*name`) is not followed; write its value in its place";
                return Err((span.start.line(), problem.to_owned()));
            }
            Event::Scalar(text, style, _, tag) => Event::Scalar(text, style, 0, tag),
            Event::SequenceStart(_, tag) => Event::SequenceStart(0, tag),
            Event::MappingStart(_, tag) => Event::MappingStart(0, tag),
            event => event,
        };
        match event {
            Event::SequenceStart(..) | Event::MappingStart(..) => depth += 1,
            Event::SequenceEnd | Event::MappingEnd => depth -= 1,
            _ => {}
        }
        if depth > DEEPEST {
            let problem =
                format!("lists within lists, more than {DEEPEST} deep; this is no glass file");
            return Err((span.start.line(), problem));
        }
        loader.on_event(event, span);
    }
    match loader.error() {
        Some(error) => Err(fault(error.clone())),
        None => Ok(loader.into_documents().into_iter().next()),
    }
}

/// Whether a line ends in the mark of a block of text, rather than being the block's first.
fn at_mark(yaml: &str, line: usize) -> bool {
    let text = yaml.lines().nth(line.saturating_sub(1)).unwrap_or_default();
    let text = text.split(" #").next().unwrap_or_default().trim_end();
    text.trim_end_matches(['-', '+']).ends_with('|')
}
