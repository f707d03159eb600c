//! Which kinds of map files there are.

use std::fmt;
use std::path::Path;
use std::str::FromStr;

/// A kind of map file: what a tool expects. u runs right and v up, samples stand at pixel centres, row 0 is
/// the top row, unless said otherwise.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Format {
    /// `exr`: an STMap for Nuke, Natron and midair itself. 32-bit float OpenEXR with R = u, G = v,
    /// A = 1 where the status is ok, else 0; a channel `status` (0 ok, 1 folded, 2 outside, 3 blocked);
    /// u and v are NaN where there is no answer.
    Exr,
    /// `exr-half`: the same in 16-bit floats, whose step near 1 is 1/2048.
    ExrHalf,
    /// `npy`: `map.npy` (height x width x 2, float64, NaN where there is no answer) and beside
    /// it `status.npy` (height x width, uint8). Where the name has no "map" in it, `-status` is appended.
    Npy,
    /// `png16`: 16-bit PNG with R = u, G = v (65535 is 1), B = 0, alpha 65535 where there is an answer.
    Png16,
    /// `blender`: for the compositor's Map UV node. 32-bit float OpenEXR with R = u, G = v, B = 1 where there
    /// is an answer; all 0 where not. To be loaded as non-colour data.
    Blender,
    /// `touchdesigner`: for the Remap TOP. 32-bit float OpenEXR with R = u, G = v, A = 1 where there is an
    /// answer; all 0 where not.
    TouchDesigner,
    /// `touchdesigner-png`: for the Remap TOP, as `png16`.
    TouchDesignerPng,
    /// `ffmpeg`: for the remap filter. `NAME_x.pgm` and `NAME_y.pgm`, 16 bits: the source's nearest column and row,
    /// counted from the top left; 65535 where there is no answer. Beside them the mask `NAME_coverage.png`.
    Ffmpeg,
    /// `opencv`: for cv2.remap. `NAME_x.npy` and `NAME_y.npy`, float32: the source's pixel coordinates, 0 at the
    /// centre of the top left pixel, y down; NaN where there is no answer. Beside them the mask `NAME_coverage.png`.
    OpenCv,
    /// `opencv-yaml`: the same as matrices `map1`, `map2` and `coverage` of a FileStorage, with the source's size. XML and JSON are read as well, packed
    /// or not, and matrices of other names and types (CV_32FC2, CV_16SC2).
    OpenCvYaml,
    /// `mpcdi`: MPCDI 2.0, 2D profile. A zip of `mpcdi.xml`, a PFM (x right and y down in \[0, 1\] of the
    /// source, and an unused third value of 1; x and y NaN where there is no answer) and an alpha PNG.
    Mpcdi,
}

/// Every format with its name and the file name that it gets by default.
const FORMATS: [(Format, &str, &str); 11] = [
    (Format::Exr, "exr", "map.exr"),
    (Format::ExrHalf, "exr-half", "map-half.exr"),
    (Format::Npy, "npy", "map.npy"),
    (Format::Png16, "png16", "map.png"),
    (Format::Blender, "blender", "map-blender.exr"),
    (Format::TouchDesigner, "touchdesigner", "map-touchdesigner.exr"),
    (Format::TouchDesignerPng, "touchdesigner-png", "map-touchdesigner.png"),
    (Format::Ffmpeg, "ffmpeg", "map-ffmpeg.pgm"),
    (Format::OpenCv, "opencv", "map-opencv.npy"),
    (Format::OpenCvYaml, "opencv-yaml", "map-opencv.yml"),
    (Format::Mpcdi, "mpcdi", "map.mpcdi"),
];

impl Format {
    /// All formats.
    pub fn all() -> impl Iterator<Item = Self> {
        FORMATS.iter().map(|entry| entry.0)
    }

    /// The name by which the program and the book call it.
    pub fn name(self) -> &'static str {
        self.entry().1
    }

    /// The file name in an output folder.
    pub fn file_name(self) -> &'static str {
        self.entry().2
    }

    /// The format that a file's name speaks of, where it does.
    pub fn of_path(path: &Path) -> Option<Self> {
        let extension = path.extension()?.to_str()?.to_ascii_lowercase();
        match extension.as_str() {
            // FileStorage packs what is called so.
            "gz" => Self::of_path(Path::new(path.file_stem()?)).filter(|f| *f == Self::OpenCvYaml),
            "xml" | "json" => Some(Self::OpenCvYaml),
            "exr" => Some(Self::Exr),
            "npy" => Some(Self::Npy),
            "png" => Some(Self::Png16),
            "pgm" => Some(Self::Ffmpeg),
            "yml" | "yaml" => Some(Self::OpenCvYaml),
            "mpcdi" => Some(Self::Mpcdi),
            _ => None,
        }
    }

    fn entry(self) -> &'static (Self, &'static str, &'static str) {
        // The table holds every variant, in order.
        &FORMATS[self as usize]
    }
}

impl fmt::Display for Format {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(self.name())
    }
}

/// A name that no format has.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("there is no map format `{0}`; there are {list}", list = FORMATS.map(|entry| entry.1).join(", "))]
pub struct UnknownFormat(pub String);

impl FromStr for Format {
    type Err = UnknownFormat;

    fn from_str(name: &str) -> Result<Self, UnknownFormat> {
        let found = FORMATS.iter().find(|entry| entry.1 == name);
        found.map(|entry| entry.0).ok_or_else(|| UnknownFormat(name.to_owned()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_format_has_its_own_row() {
        for (index, (format, name, file)) in FORMATS.iter().enumerate() {
            assert_eq!(*format as usize, index);
            assert_eq!(name.parse::<Format>().unwrap(), *format);
            assert!(Format::of_path(Path::new(file)).is_some());
        }
        let message = "tiff".parse::<Format>().unwrap_err().to_string();
        assert!(message.contains("`tiff`") && message.contains("mpcdi"));
    }
}
