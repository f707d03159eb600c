//! Media, interfaces and plates: what light does at each thing it meets.

pub mod glass;
