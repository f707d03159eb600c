//! Which of an EXR file's channels are meant: tools put them into layers and parts, and spell them in several ways.

use super::FileError;
use super::exr_channels::{Channels, ExrFile};
use std::path::Path;

/// The spellings of a channel, in lower case.
type Spellings = &'static [&'static str];

const RED: Spellings = &["r", "red"];
const GREEN: Spellings = &["g", "green"];
const BLUE: Spellings = &["b", "blue"];
const ALPHA: Spellings = &["a", "alpha"];
const LUMINANCE: Spellings = &["y", "luminance", "grey", "gray"];
const U: Spellings = &["u"];
const V: Spellings = &["v"];

/// What tools call the layer that is the picture itself: Blender, Nuke, Houdini, Maya's and Cinema 4D's renderers.
const MAIN: [&str; 6] = ["combined", "rgba", "rgb", "beauty", "c", "color"];

/// Channels of one part whose names differ only behind their last dot: one layer.
#[derive(Debug)]
pub(crate) struct Layer {
    pub part: usize,
    /// What stands before the last dot; empty for plain names.
    pub name: String,
    /// Names as the file has them, and behind the last dot in lower case.
    channels: Vec<(String, String)>,
}

impl Layer {
    /// The name in the file of the channel that is spelt in one of these ways.
    fn find(&self, spellings: Spellings) -> Option<&str> {
        let is = |(_, base): &&(String, String)| spellings.contains(&base.as_str());
        self.channels.iter().find(is).map(|(name, _)| name.as_str())
    }

    fn has(&self, wanted: &[Spellings]) -> bool {
        wanted.iter().all(|spellings| self.find(spellings).is_some())
    }

    /// What it is called in a message.
    fn title(&self, file: &ExrFile) -> String {
        let part = file.headers()[self.part].own_attributes.layer_name.as_ref();
        match (part, self.name.as_str()) {
            (Some(part), "") => part.to_string(),
            (None, "") => format!("part {}", self.part + 1),
            (Some(part), name) if part != name => format!("{part}/{name}"),
            (_, name) => name.to_owned(),
        }
    }

    fn is_main(&self, file: &ExrFile) -> bool {
        let title = self.title(file).to_ascii_lowercase();
        MAIN.contains(&title.rsplit(['.', '/']).next().unwrap_or_default())
    }

    /// Blender's compositor puts what it made beside the layers that it made it from.
    fn is_composite(&self) -> bool {
        self.name.to_ascii_lowercase().starts_with("composite.")
    }
}

/// The layers of all flat parts, in the file's order.
fn layers(file: &ExrFile) -> Vec<Layer> {
    let mut layers: Vec<Layer> = Vec::new();
    for (part, header) in file.headers().iter().enumerate().filter(|(_, header)| !header.deep) {
        for channel in &header.channels.list {
            let full = channel.name.to_string();
            let (layer, base) = full.rsplit_once('.').unwrap_or(("", &full));
            let entry = (full.clone(), base.to_ascii_lowercase());
            match layers.iter_mut().find(|known| known.part == part && known.name == layer) {
                Some(known) => known.channels.push(entry),
                None => {
                    layers.push(Layer { part, name: layer.to_owned(), channels: vec![entry] });
                }
            }
        }
    }
    layers
}

/// All channels' names, for a message.
fn names(file: &ExrFile) -> String {
    let layers = layers(file);
    let all: Vec<&str> = layers.iter().flat_map(|l| &l.channels).map(|c| c.0.as_str()).collect();
    match all.len() {
        0..=24 => all.join(", "),
        more => format!("{} and {} more", all[..24].join(", "), more - 24),
    }
}

/// The one layer of several that is meant: the one without a name (of several parts what tools call the picture itself, else the first), else what
/// tools call the picture itself, else the only one.
fn choose<'l>(
    path: &Path,
    file: &ExrFile,
    found: &[&'l Layer],
    what: &str,
) -> Result<Option<&'l Layer>, FileError> {
    let mut plain = found.iter().filter(|layer| layer.name.is_empty());
    if let Some(first) = plain.clone().next() {
        return Ok(Some(plain.find(|layer| layer.is_main(file)).unwrap_or(first)));
    }
    let mut main: Vec<_> = found.iter().filter(|layer| layer.is_main(file)).collect();
    if main.iter().filter(|layer| layer.is_composite()).count() == 1 {
        main.retain(|layer| layer.is_composite());
    }
    match (found, main.as_slice()) {
        ([], _) => Ok(None),
        ([only], _) => Ok(Some(only)),
        (_, [only]) => Ok(Some(only)),
        _ => {
            let titles: Vec<String> = found.iter().map(|layer| layer.title(file)).collect();
            let problem = format!("several layers hold {what}: {}", titles.join(", "));
            Err(FileError::malformed(path, "layers", problem, "export the one that is meant alone"))
        }
    }
}

/// The channels of a picture: three colours, or luminance for all of them, and alpha if there is one.
pub(crate) struct PictureChannels {
    pub channels: Channels,
    /// Names of red, green and blue.
    pub colours: [String; 3],
    pub alpha: Option<String>,
    /// The layer, where it has a name.
    pub layer: Option<String>,
}

/// Reads a picture's channels.
pub(crate) fn read_picture(path: &Path, file: &ExrFile) -> Result<PictureChannels, FileError> {
    const COLOURS: [Spellings; 3] = [RED, GREEN, BLUE];
    let layers = layers(file);
    // A plain R without G and B is a picture that lacks something, whatever other layers hold.
    let torn = layers.iter().any(|layer| {
        let any = COLOURS.iter().any(|spellings| layer.find(spellings).is_some());
        layer.name.is_empty() && any && !layer.has(&COLOURS)
    });
    let having = |wanted: &[Spellings]| -> Vec<&Layer> {
        layers.iter().filter(|layer| layer.has(wanted)).collect()
    };
    let missing = |which: &str| {
        FileError::malformed(
            path,
            format!("channel {which}"),
            format!("it is missing; the file has {}", names(file)),
            "export R, G and B (or Y), without subsampled chroma",
        )
    };
    let (layer, wanted) = match choose(path, file, &having(&COLOURS), "a picture")? {
        Some(layer) if !torn => (layer, COLOURS),
        _ => {
            let greys: Vec<&Layer> = having(&[LUMINANCE])
                .into_iter()
                // A normal's y is no luminance, nor is luminance with its chroma apart.
                .filter(|layer| {
                    ["x", "z", "ry", "by"].iter().all(|o| layer.find_plain(o).is_none())
                })
                .collect();
            let plain = layers.iter().find(|layer| layer.name.is_empty());
            let lacks = |plain: &Layer| {
                let lacking = COLOURS.iter().find(|spellings| plain.find(spellings).is_none());
                lacking.map_or("R".to_owned(), |spellings| spellings[0].to_ascii_uppercase())
            };
            match choose(path, file, &greys, "a picture")? {
                Some(layer) if !torn => (layer, [LUMINANCE; 3]),
                _ => return Err(missing(&plain.map_or("R".to_owned(), lacks))),
            }
        }
    };
    let name = |spellings: Spellings| layer.find(spellings).unwrap_or_default().to_owned();
    let colours = wanted.map(name);
    let alpha = layer.find(ALPHA).map(str::to_owned);
    let all: Vec<&str> = colours.iter().chain(&alpha).map(String::as_str).collect();
    let channels = file.read(layer.part, &all, 0.0)?;
    Ok(PictureChannels { channels, colours, alpha, layer: layer.told(file, &layers) })
}

impl Layer {
    /// Its title, where it is not the file's only plain one.
    fn told(&self, file: &ExrFile, all: &[Layer]) -> Option<String> {
        let alike = |other: &&Layer| other.name.is_empty() && other.has(&[RED, GREEN]);
        let several = all.iter().filter(alike).count() > 1;
        (!self.name.is_empty() || self.part > 0 || several).then(|| self.title(file))
    }

    fn find_plain(&self, base: &str) -> Option<&str> {
        self.channels.iter().find(|channel| channel.1 == base).map(|channel| channel.0.as_str())
    }
}

/// The channels of a map.
pub(crate) struct MapChannels {
    pub channels: Channels,
    pub u: String,
    pub v: String,
    pub blue: Option<String>,
    pub alpha: Option<String>,
    /// The layer, where it has a name.
    pub layer: Option<String>,
    /// What the user should know.
    pub notes: Vec<String>,
}

/// Reads a map's channels: plain R and G, unless they are empty; else u and v, in a layer or not; else R and G in a layer. What a part leaves out is
/// NaN. `more` are further channels of the same part, read where they are there.
pub(crate) fn read_map_channels(
    path: &Path,
    file: &ExrFile,
    more: &[&str],
) -> Result<MapChannels, FileError> {
    let layers = layers(file);
    let having = |wanted: &[Spellings]| -> Vec<&Layer> {
        layers.iter().filter(|layer| layer.has(wanted)).collect()
    };
    let (coded, named) = (having(&[RED, GREEN]), having(&[U, V]));
    let mut plains = coded.iter().copied().filter(|layer| layer.name.is_empty());
    let first = plains.clone().next();
    let plain = plains.find(|layer| layer.is_main(file)).or(first);
    let read = |layer: &Layer, [u, v]: [Spellings; 2]| -> Result<MapChannels, FileError> {
        let name = |spellings: Spellings| layer.find(spellings).map(str::to_owned);
        let (u, v) = (name(u).unwrap_or_default(), name(v).unwrap_or_default());
        let (blue, alpha) = (name(BLUE), name(ALPHA));
        let wanted = [Some(&u), Some(&v), blue.as_ref(), alpha.as_ref()];
        let mut wanted: Vec<&str> = wanted.into_iter().flatten().map(String::as_str).collect();
        wanted.extend(more);
        let channels = file.read(layer.part, &wanted, f32::NAN)?;
        let told = layer.told(file, &layers);
        Ok(MapChannels { channels, u, v, blue, alpha, layer: told, notes: Vec::new() })
    };
    if let Some(plain) = plain {
        let mut map = read(plain, [RED, GREEN])?;
        if !map.is_empty() {
            if let Some(other) = named.first() {
                map.notes.push(format!(
                    "{}: R and G are read; layer {} with u and v is passed over",
                    path.display(),
                    other.title(file)
                ));
            }
            return Ok(map);
        }
    }
    let map = if let Some(layer) = choose(path, file, &named, "u and v")? {
        read(layer, [U, V])?
    } else if let Some(layer) = choose(path, file, &coded, "R and G")? {
        read(layer, [RED, GREEN])?
    } else {
        return Err(FileError::malformed(
            path,
            "channel R",
            format!("it is missing; the file has {}", names(file)),
            "export u as R and v as G, or as channels u and v",
        ));
    };
    if map.is_empty() {
        return Err(FileError::malformed(
            path,
            format!("channels {} and {}", map.u, map.v),
            "they are 0 everywhere, which is no map",
            format!("export the map into R and G; the file has {}", names(file)),
        ));
    }
    Ok(map)
}

impl MapChannels {
    pub(super) fn get(&self, name: &str) -> &[f32] {
        self.channels.get(name).unwrap_or_default()
    }

    /// Whether every sample leads to the same corner.
    fn is_empty(&self) -> bool {
        [&self.u, &self.v].iter().all(|name| self.get(name).iter().all(|&x| x == 0.0))
    }
}
