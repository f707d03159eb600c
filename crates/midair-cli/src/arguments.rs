//! What stands on the command line: sizes, points, formats; and the files that it names.

use crate::failure::Failure;
use crate::output::inputs;
use clap::ValueEnum;
use clap::builder::PossibleValuesParser;
use clap::builder::TypedValueParser as _;
use midair::map::format::{FileError, Format, LoadedMap, MAX_PIXELS, Reading, decode_map};
use midair::picture::{Fit, LONGEST, Overflow, Picture, Still, read_still};
use midair::scene::{Loaded, load};
use midair::transport::Setup;
use std::path::Path;
use std::str::FromStr;

/// What is done where evening the brightness out would take a brighter display.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum GainMode {
    /// As bright as the pixel of lowest gain allows: nothing clips
    Fit,
    /// A white image clips at a tenth of its pixels
    Clip,
    /// As clip, with a soft shoulder (highlights keep their details)
    Soft,
}

impl GainMode {
    pub fn overflow(self) -> Overflow {
        match self {
            Self::Fit => Overflow::Fit,
            Self::Clip => Overflow::Clip,
            Self::Soft => Overflow::Soft,
        }
    }
}

/// How a picture of other proportions fills the image.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum FitMode {
    /// All of it, squeezed or drawn out
    #[default]
    Stretch,
    /// All of it in its proportions, black beside it
    Contain,
    /// In its proportions over all of the image, cut off where it sticks out
    Cover,
}

impl FitMode {
    pub fn fit(self) -> Fit {
        match self {
            Self::Stretch => Fit::Stretch,
            Self::Contain => Fit::Contain,
            Self::Cover => Fit::Cover,
        }
    }

    /// The picture as the set-up's image is to show it.
    pub fn apply(self, setup: &Setup, picture: Picture) -> Picture {
        let crop = self.fit().crop([picture.width, picture.height], setup.image.size);
        crop.picture(picture)
    }
}

/// Proportions, written `30:40`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Proportions(pub [f64; 2]);

impl FromStr for Proportions {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = || "give width : height, such as 30:40".to_owned();
        let (width, height) = text.split_once(':').ok_or_else(wrong)?;
        let side = |text: &str| {
            let side = text.trim().parse::<f64>().ok().filter(|side| (1e-3..1e6).contains(side));
            side.ok_or_else(wrong)
        };
        Ok(Self([side(width)?, side(height)?]))
    }
}

/// Width and height in pixels, written `1024x768`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Size(pub [usize; 2]);

impl FromStr for Size {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = || "give width x height in pixels, such as 1024x768".to_owned();
        let (width, height) = text.split_once(['x', 'X', '×']).ok_or_else(wrong)?;
        let side = |text: &str| text.trim().parse::<usize>().map_err(|_| wrong());
        let size = [side(width)?, side(height)?];
        if size.iter().any(|side| !(1..=LONGEST).contains(side)) {
            return Err(format!("each side must be from 1 to {LONGEST} pixels"));
        }
        if (size[0] as u64) * (size[1] as u64) > MAX_PIXELS {
            return Err(format!("that is more than {MAX_PIXELS} pixels"));
        }
        Ok(Self(size))
    }
}

/// A point in mm, written `X,Y,Z`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point(pub [f64; 3]);

impl FromStr for Point {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = || "give three numbers in mm, such as 0,0,800".to_owned();
        let parts: Vec<f64> = text
            .split(',')
            .map(|part| part.trim().parse::<f64>().map_err(|_| wrong()))
            .collect::<Result<_, _>>()?;
        let point: [f64; 3] = parts.try_into().map_err(|_| wrong())?;
        // As far out as a scene file may go.
        if point.iter().all(|c| c.is_finite() && c.abs() <= 1e6) {
            Ok(Self(point))
        } else {
            Err("each coordinate must lie within 1000000 mm".to_owned())
        }
    }
}

/// A positive number that is finite.
pub fn positive(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value > 0.0 && value <= 1e3 => Ok(value),
        _ => Err("give a number above 0, at most 1000".to_owned()),
    }
}

/// A length on the command line, mm.
pub fn length(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if (0.0..=1e6).contains(&value) => Ok(value),
        _ => Err("give a length from 0 to 1000000 mm".to_owned()),
    }
}

/// The names of the map formats; a misspelt one gets a suggestion.
pub fn map_formats() -> impl clap::builder::TypedValueParser<Value = Format> {
    PossibleValuesParser::new(Format::all().map(Format::name))
        .try_map(|name| name.parse::<Format>())
}

/// Reads a scene, with another display resolution if one is asked for.
pub fn open_scene(path: &Path, size: Option<Size>) -> Result<Loaded, Failure> {
    inputs().add(path);
    let mut loaded = load(path)?;
    loaded.files.iter().for_each(|file| inputs().add(file));
    if let Some(Size(size)) = size {
        loaded.scene.display.resolution = size;
    }
    let [width, height] = loaded.scene.display.resolution;
    if width as u64 * height as u64 > MAX_PIXELS {
        let error = loaded.text.error_at(
            "display.resolution",
            format!("{width} x {height} are more than {MAX_PIXELS} pixels"),
            "give a smaller resolution here or by --size",
        );
        return Err(error.into());
    }
    Ok(loaded)
}

/// Reads a picture; what was passed over or mended goes to `notes`.
pub fn open_picture(path: &Path, notes: &mut Vec<String>) -> Result<Still, Failure> {
    inputs().add(path);
    let still = read_still(path)?;
    notes.extend(still.notes.iter().cloned());
    Ok(still)
}

/// Reads a map, as [`decode_map`].
pub fn open_map(path: &Path, reading: &Reading) -> Result<LoadedMap, FileError> {
    inputs().add(path);
    decode_map(path, &|file| std::fs::read(file), reading)
}

/// Refuses a view that would not fit into memory.
pub fn check_view(size: [usize; 2], supersampling: usize) -> Result<(), Failure> {
    Ok(midair::simulate::check_view(size, supersampling)?)
}

/// Refuses an output name that is not a picture's before any work is done.
pub fn check_picture_name(path: &Path) -> Result<(), Failure> {
    let extension = path.extension().and_then(|extension| extension.to_str()).unwrap_or_default();
    if ["png", "exr"].iter().any(|known| extension.eq_ignore_ascii_case(known)) {
        return Ok(());
    }
    Err(Failure::new(
        format!("{}: pictures are written as PNG or OpenEXR", path.display()),
        "let the name end in .png or .exr",
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_read_and_typos_refused() {
        assert_eq!("1024x768".parse(), Ok(Size([1024, 768])));
        assert_eq!("4X3".parse(), Ok(Size([4, 3])));
        for wrong in [
            "",
            "x",
            "12",
            "12x",
            "0x5",
            "-1x5",
            "1.5x2",
            "40000x1",
            "32768x32768",
            "1x2x3",
            "12*3",
        ] {
            assert!(wrong.parse::<Size>().is_err(), "{wrong}");
        }
    }

    #[test]
    fn points_are_read_and_typos_refused() {
        assert_eq!("1,-2.5, 3e2".parse(), Ok(Point([1.0, -2.5, 300.0])));
        for wrong in ["", "1,2", "1,2,3,4", "nan,0,0", "inf,0,0", "1;2;3", "1e9,0,0"] {
            assert!(wrong.parse::<Point>().is_err(), "{wrong}");
        }
    }

    #[test]
    fn lengths_are_read_and_typos_refused() {
        assert_eq!(length("0"), Ok(0.0));
        for wrong in ["", "-1", "nan", "inf", "4mm", "1e9"] {
            assert!(length(wrong).is_err(), "{wrong}");
        }
    }
}
