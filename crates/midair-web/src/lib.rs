//! midair for a page: what the studio's worker calls.
//!
//! A [`Scene`] is a set-up as its text describes it, with the [`Files`] that the text names; it is not changed, but makes another. A [`Solution`] is
//! its map on a display of some resolution. [`Still`] is a picture in linear light. Nothing is computed here: what crosses the border is text,
//! numbers in arrays, and data as the interfaces of `types.rs` have them. Every failure is thrown as a `Fault`.

mod bodies;
mod fault;
mod files;
mod rays;
mod scene;
mod solution;
mod still;
mod types;

pub use bodies::Lines;
pub use files::{File, Files};
pub use rays::Rays;
pub use scene::Scene;
pub use solution::Solution;
pub use still::Still;

use fault::data;
use midair::map::format::Format;
use midair::optics::glass;
use midair::scene::devices;
use serde_json::json;
use wasm_bindgen::prelude::*;

/// Lends the library the page's clock, and has a panic say where it was: the module ends by it, and the page starts another.
#[wasm_bindgen(start)]
pub fn start() {
    #[cfg(all(target_arch = "wasm32", target_os = "unknown"))]
    midair::clock::lend(|| std::time::Duration::from_secs_f64(now() / 1e3));
    std::panic::set_hook(Box::new(|panic| report(&panic.to_string())));
}

#[cfg(all(target_arch = "wasm32", target_os = "unknown"))]
#[wasm_bindgen]
extern "C" {
    #[wasm_bindgen(js_namespace = performance)]
    fn now() -> f64;
}

#[wasm_bindgen]
extern "C" {
    #[wasm_bindgen(js_namespace = console, js_name = warn)]
    fn report(text: &str);
}

/// The scene file's JSON Schema.
#[wasm_bindgen(unchecked_return_type = "Schema")]
pub fn schema() -> JsValue {
    data(&midair::scene::schema())
}

/// What people have and can choose from: plates, displays, glasses, and the kinds of map files.
#[wasm_bindgen(unchecked_return_type = "Catalogue")]
pub fn catalogue() -> JsValue {
    let plates =
        devices::PLATES.iter().map(|plate| json!({ "name": plate.name, "size": plate.size }));
    let displays = devices::DISPLAYS.iter().map(|display| {
        let [width, height] = display.size();
        let pitch = [width / display.resolution[0] as f64, height / display.resolution[1] as f64];
        json!({ "name": display.name, "resolution": display.resolution, "size": [width, height], "pitch": pitch })
    });
    let formats =
        Format::all().map(|format| json!({ "name": format.name(), "file": format.file_name() }));
    data(&json!({
        "plates": plates.collect::<Vec<_>>(),
        "displays": displays.collect::<Vec<_>>(),
        "glasses": glass::names().collect::<Vec<_>>(),
        "formats": formats.collect::<Vec<_>>(),
        "version": env!("CARGO_PKG_VERSION"),
    }))
}
