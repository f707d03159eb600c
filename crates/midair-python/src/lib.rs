//! midair for Python: the module `midair._core`.
//!
//! What is computed and said is the library's; here are Python's forms of it. Arrays are numpy's where numpy is there, and bytes where it is
//! not, as in Blender's extensions: the module itself is imported without numpy.

mod arrays;
mod calibration;
mod check;
mod error;
mod evaluation;
mod map;
mod picture;
mod rays;
mod scene;
mod set_up;
mod setting;
mod threads;
mod view;

/// The part of midair that is written in Rust.
#[pyo3::pymodule]
mod _core {
    use pyo3::prelude::*;

    #[pymodule_export]
    use crate::calibration::{Calibration, fit};
    #[pymodule_export]
    use crate::check::{Check, Finding};
    #[pymodule_export]
    use crate::map::{Map, Samples, load_map};
    #[pymodule_export]
    use crate::rays::Rays;
    #[pymodule_export]
    use crate::scene::Scene;
    #[pymodule_export]
    use crate::threads::{thread_count, use_threads};

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("__version__", env!("CARGO_PKG_VERSION"))?;
        crate::error::add(module)
    }
}
