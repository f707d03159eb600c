//! The forward simulator: what the viewpoint sees.
