//! Pictures in linear light, and applying a map to stills and video.

mod picture;

pub use picture::Picture;
