//! What is said to ffmpeg's encoder: whatever options are given, the new film says which matrix and range its codes have.

use super::encode::{Encoder, Recipe};
use super::probe::pixel_format_of;
use super::{SCALE_FLAGS, Timing, VideoError};
use std::path::Path;

/// What is said to ffmpeg for a film.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Plan {
    /// The chain of filters.
    pub filter: String,
    /// What the film says of its codes; before the options, so that these have the last word.
    pub tags: Vec<String>,
    /// The encoder's options, without those for filters.
    pub options: Vec<String>,
}

impl Plan {
    /// For an encoder whose pixels will have this format.
    pub(crate) fn new(path: &Path, recipe: &Recipe, format: Option<&str>) -> Self {
        let (mut options, given) = without_filters(encoder_options(path, recipe));
        let after = |options: &[String], names: &[&str]| {
            let at = options.iter().rposition(|option| names.contains(&option.as_str()))?;
            options.get(at + 1).cloned()
        };
        let format = format.unwrap_or_default();
        let range = after(&options, &["-color_range", "-color_range:v"]);
        let full = format.starts_with("yuvj")
            || matches!(range.as_deref(), Some("pc" | "jpeg" | "full" | "2"));
        let range = if full { "pc" } else { "tv" };
        let mut colour = recipe.colour.clone();
        if let Some(matrix) = after(&options, &["-colorspace", "-colorspace:v"]) {
            colour.matrix = matrix;
        }
        let mut filter = given.map_or_else(String::new, |given| format!("{given},"));
        let matrix = colour.scale_matrix();
        filter += &format!("scale=out_color_matrix={matrix}:out_range={range}:flags={SCALE_FLAGS}");
        let mut tags = Vec::new();
        let mut tag = |name: &str, value: &str| tags.extend([name.to_owned(), value.to_owned()]);
        if !is_rgb(format) {
            tag("-colorspace", &colour.matrix);
            tag("-color_range", range);
        }
        if let Some(primaries) = &colour.primaries {
            tag("-color_primaries", primaries);
        }
        if let Some(transfer) = &colour.transfer {
            tag("-color_trc", transfer);
        }
        options.retain(|option| !option.is_empty());
        Self { filter, tags, options }
    }
}

/// The options, and the chain of filters among them.
fn without_filters(options: Vec<String>) -> (Vec<String>, Option<String>) {
    let (mut kept, mut filter) = (Vec::new(), None);
    let mut options = options.into_iter();
    while let Some(option) = options.next() {
        match option.as_str() {
            "-vf" | "-filter:v" | "-filter:v:0" => filter = options.next(),
            _ => kept.push(option),
        }
    }
    (kept, filter)
}

/// Whether a pixel format's name is of red, green and blue, which need no matrix.
fn is_rgb(name: &str) -> bool {
    ["rgb", "bgr", "gbr", "argb", "abgr", "0rgb", "0bgr", "x2rgb", "x2bgr", "pal8"]
        .iter()
        .any(|kind| name.starts_with(kind))
}

/// The pixel format that the encoder will use: found by encoding one black frame to `path`, which is removed again. Options that ffmpeg does not
/// take are refused here, before any work.
///
/// # Errors
/// [`VideoError`] where ffmpeg cannot be started, or refuses.
pub fn pixel_format(path: &Path, recipe: &Recipe) -> Result<String, VideoError> {
    if recipe.options.is_empty() {
        return Ok(usual_format(recipe).to_owned());
    }
    let mut encoder = Encoder::start(path, recipe, &Plan::new(path, recipe, None))?;
    let [width, height] = recipe.size;
    let frame = vec![0; width * height * if recipe.deep { 6 } else { 3 }];
    encoder.write(&frame, Timing { ticks: 0, base: recipe.base })?;
    encoder.finish()?;
    let format = pixel_format_of(path);
    // Of no effect on what comes: the encoder writes over it.
    let _ = std::fs::remove_file(path);
    format
}

/// The options as given, or a choice that looks the same as the source.
fn encoder_options(path: &Path, recipe: &Recipe) -> Vec<String> {
    if !recipe.options.is_empty() {
        return recipe.options.to_vec();
    }
    let extension =
        path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase();
    let codec = match (extension.as_str(), recipe.deep) {
        ("webm", _) => "-c:v libvpx-vp9 -crf 18 -b:v 0 -row-mt 1 -cpu-used 4",
        ("mp4" | "mov" | "m4v", true) => {
            "-c:v libx265 -crf 16 -preset fast -x265-params log-level=none -tag:v hvc1"
        }
        (_, true) => "-c:v libx265 -crf 16 -preset fast -x265-params log-level=none",
        (_, false) => "-c:v libx264 -crf 16 -preset fast",
    };
    let mut options: Vec<String> = codec.split(' ').map(str::to_owned).collect();
    options.extend(["-pix_fmt".to_owned(), usual_format(recipe).to_owned()]);
    options
}

fn usual_format(recipe: &Recipe) -> &'static str {
    let odd = recipe.size.iter().any(|side| side % 2 == 1);
    match (recipe.deep, odd) {
        (false, false) => "yuv420p",
        (false, true) => "yuv444p",
        (true, false) => "yuv420p10le",
        (true, true) => "yuv444p10le",
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Colour;

    fn plan(options: &str, format: &str) -> Plan {
        let options: Vec<String> = options.split_whitespace().map(str::to_owned).collect();
        let colour = Colour::usual(480);
        let recipe = Recipe {
            size: [64, 48],
            deep: false,
            rate: [25, 1],
            colour: &colour,
            base: [1, 25],
            options: &options,
            format: None,
        };
        Plan::new(Path::new("a.mkv"), &recipe, Some(format))
    }

    #[test]
    fn the_tags_say_what_was_coded_whatever_the_options_are() {
        let tags = ["-colorspace", "smpte170m", "-color_range", "tv"];
        assert_eq!(plan("-c:v libx264 -crf 10", "yuv444p").tags, tags);
        assert_eq!(plan("", "yuv420p").tags, tags);
        assert!(
            plan("-c:v ffv1", "bgr0").tags.is_empty() && plan("-c:v ffv1", "gbrp").tags.is_empty()
        );
        let full = plan("-c:v mjpeg", "yuvj420p");
        assert!(
            full.filter.contains("out_range=pc")
                && full.tags.ends_with(&["-color_range".into(), "pc".into()])
        );
        assert!(plan("-c:v libx264 -color_range pc", "yuv420p").filter.contains("out_range=pc"));
        let own = plan("-c:v libx264 -colorspace bt709", "yuv420p");
        assert!(own.filter.contains("out_color_matrix=bt709") && own.tags[1] == "bt709");
        // Filters that are asked for come before the change to YUV, not in its place.
        let filtered = plan("-vf hflip -c:v libx264", "yuv420p");
        assert!(
            filtered.filter.starts_with("hflip,scale=") && filtered.options == ["-c:v", "libx264"]
        );
    }
}
