//! Pictures in linear light, and applying a map to stills and frames.
//!
//! ```
//! use midair::map::Map;
//! use midair::picture::{Picture, display_image};
//!
//! // A red half and a green one, in linear light, through the map of a display that shows the picture as it is.
//! let mut picture = Picture::filled(2, 1, [1.0, 0.0, 0.0, 1.0]);
//! picture.pixels[1] = [0.0, 1.0, 0.0, 1.0];
//! let display = display_image(&picture, &Map::identity(2, 1));
//! assert_eq!(display.pixels, picture.pixels);
//! ```

mod brightness;
pub mod colour;
mod curve;
mod interpolate;
mod jpeg;
mod linear;
pub mod optimal;
mod over_black;
mod profile;
mod raster;
mod resample;
mod samples;
mod screen;
mod sequence;
mod still;
mod tiff;
mod warp;
pub mod wide;

pub use crate::map::format::FileError;
pub use crate::optics::srgb;
pub use brightness::{Evened, Evening, Overflow, even_out};
pub use curve::Curve;
pub use linear::{LONGEST, Picture, check_size};
pub use over_black::OverBlack;
pub use resample::{display_image, display_image_by_colour};
pub use samples::Samples;
pub use screen::{Driven, drive, emitted};
pub use sequence::Sequence;
pub use still::{
    Depth, READ, Still, decode_still, encode_still, is_picture, is_picture_name, read_still,
    write_still, write_still_of_pitch,
};
pub use warp::{
    DeepScratch, Drive, Filter, FixedPoint, FrameEvening, HEADROOM, LightFrame, NO_TAP, Warp,
    WarpError,
};
