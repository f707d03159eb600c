//! The description of a set-up: model, files, validation.

pub mod model;
