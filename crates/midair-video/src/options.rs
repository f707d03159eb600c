//! What is said to ffmpeg's encoder: whatever options are given, the new film says which matrix and range its codes have.

use super::encode::{Encoder, Recipe};
use super::probe::coded_in;
use super::{Colour, SCALE_FLAGS, Timing, VideoError};
use std::path::Path;

/// What an encoder makes of the options that it is given.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Coded {
    /// ffmpeg's name of the pixel format.
    pub pixels: String,
    /// The matrix that the film says it has; `None`: it cannot say any.
    pub matrix: Option<String>,
    /// Whether codes span the full range.
    pub full: bool,
}

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
    /// For an encoder that codes in this way; as far as the options tell, where that is not known yet.
    pub(crate) fn new(path: &Path, recipe: &Recipe, coded: Option<&Coded>) -> Self {
        let (options, given) = without_filters(encoder_options(path, recipe));
        let after = |names: &[&str]| {
            let at = options.iter().rposition(|option| names.contains(&option.as_str()))?;
            options.get(at + 1).map(String::as_str)
        };
        let pixels = coded.map(|coded| coded.pixels.as_str()).or(after(&["-pix_fmt"]));
        let pixels = pixels.unwrap_or_default();
        let asked = matches!(
            after(&["-color_range", "-color_range:v"]),
            Some("pc" | "jpeg" | "full" | "2")
        );
        let full = asked || pixels.starts_with("yuvj") || coded.is_some_and(|coded| coded.full);
        let range = if full { "pc" } else { "tv" };
        let mut colour = recipe.colour.clone();
        if let Some(matrix) = after(&["-colorspace", "-colorspace:v"]) {
            colour.matrix = matrix.to_owned();
        }
        // What a film says is what its codes have to be; one that cannot say is taken by its size.
        match coded.map(|coded| coded.matrix.clone()) {
            Some(Some(matrix)) => colour.matrix = matrix,
            Some(None) => colour.matrix = Colour::usual(recipe.size[1]).matrix,
            None => {}
        }
        let mut filter = given.map_or_else(String::new, |given| format!("{given},"));
        let matrix = colour.scale_matrix();
        filter += &format!("scale=out_color_matrix={matrix}:out_range={range}:flags={SCALE_FLAGS}");
        let mut tags = Vec::new();
        let mut tag = |name: &str, value: &str| tags.extend([name.to_owned(), value.to_owned()]);
        if !is_rgb(pixels) {
            // Some encoders read it from the frames, others from the options.
            filter += &format!(",setparams=colorspace={}:range={range}", colour.matrix);
            tag("-colorspace", &colour.matrix);
            tag("-color_range", range);
        }
        if let Some(primaries) = &colour.primaries {
            tag("-color_primaries", primaries);
        }
        if let Some(transfer) = &colour.transfer {
            tag("-color_trc", transfer);
        }
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

/// What the encoder makes of the options: found by encoding one black frame to `path`, which is removed again. Options that ffmpeg does not
/// take are refused here, before any work.
///
/// # Errors
/// [`VideoError`] where ffmpeg cannot be started, or refuses.
pub fn coded(path: &Path, recipe: &Recipe) -> Result<Coded, VideoError> {
    if recipe.options.is_empty() {
        let matrix = Some(recipe.colour.matrix.clone());
        return Ok(Coded { pixels: usual_format(recipe).to_owned(), matrix, full: false });
    }
    let mut encoder = Encoder::start(path, recipe, &Plan::new(path, recipe, None))?;
    let [width, height] = recipe.size;
    let frame = vec![0; width * height * if recipe.deep { 6 } else { 3 }];
    encoder.write(&frame, Timing { ticks: 0, base: recipe.base })?;
    encoder.finish()?;
    let coded = coded_in(path);
    // Of no effect on what comes: the encoder writes over it.
    let _ = std::fs::remove_file(path);
    coded
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

    fn plan(options: &str, pixels: &str, matrix: Option<&str>) -> Plan {
        let options: Vec<String> = options.split_whitespace().map(str::to_owned).collect();
        let colour = Colour::usual(480);
        let recipe = Recipe {
            size: [64, 720],
            deep: false,
            rate: [25, 1],
            colour: &colour,
            base: [1, 25],
            options: &options,
            coded: None,
        };
        let coded = Coded {
            pixels: pixels.to_owned(),
            matrix: matrix.map(str::to_owned),
            full: pixels.starts_with("yuvj"),
        };
        Plan::new(Path::new("a.mkv"), &recipe, Some(&coded))
    }

    #[test]
    fn the_tags_say_what_is_coded_whatever_the_options_are() {
        let own = Some("smpte170m");
        let tags = ["-colorspace", "smpte170m", "-color_range", "tv"];
        assert_eq!(plan("-c:v libx264 -crf 10", "yuv444p", own).tags, tags);
        assert_eq!(plan("", "yuv420p", own).tags, tags);
        for pixels in ["bgr0", "gbrp", "rgb24"] {
            let rgb = plan("-c:v ffv1", pixels, Some("gbr"));
            assert!(rgb.tags.is_empty() && !rgb.filter.contains("setparams"), "{pixels}");
        }
        let full = plan("-c:v mjpeg", "yuvj420p", Some("bt470bg"));
        assert!(full.filter.contains("out_range=pc") && full.tags[3] == "pc");
        assert!(
            plan("-c:v libx264 -color_range pc", "yuv420p", own).filter.contains("out_range=pc")
        );
        // An encoder that says BT.709 whatever it is told gets BT.709; one that says nothing, what its size stands for.
        let fixed = plan("-c:v dnxhd", "yuv422p", Some("bt709"));
        assert!(fixed.filter.contains("out_color_matrix=bt709") && fixed.tags[1] == "bt709");
        assert!(plan("-c:v mpeg4", "yuv420p", None).filter.contains("out_color_matrix=bt709"));
        // Filters that are asked for come before the change to YUV, not in its place.
        let filtered = plan("-vf hflip -c:v libx264", "yuv420p", own);
        assert!(
            filtered.filter.starts_with("hflip,scale=") && filtered.options == ["-c:v", "libx264"]
        );
    }
}
