//! Failures and data on their way to the page.

use midair::Error;
use midair::scene::SceneError;
use serde_json::{Value, json};
use wasm_bindgen::JsValue;

/// Data as the page has them.
pub fn data(value: &Value) -> JsValue {
    // Its own text is JSON; should it ever not be, the page sees no data.
    js_sys::JSON::parse(&value.to_string()).unwrap_or(JsValue::NULL)
}

/// An error of the library as a `Fault`.
pub fn thrown(error: impl Into<Error>) -> JsValue {
    let error = error.into();
    let line = |error: &SceneError| error.file_and_line().1;
    let others = error.scene().map(|scene| {
        let other = |other: &SceneError| json!({ "message": other.message, "remedy": other.help, "line": line(other) });
        scene.others.iter().map(other).collect::<Vec<_>>()
    });
    let place = error.place();
    let part = place.and_then(|place| place.part.as_ref());
    let message = match part {
        Some(part) => format!("{part}: {}", error.message()),
        None => error.message().to_owned(),
    };
    data(&json!({
        "fault": true,
        "message": message,
        "remedy": error.remedy(),
        "file": place.map(|place| &place.file),
        "line": place.and_then(|place| place.line),
        "others": others.unwrap_or_default(),
    }))
}

/// A request that cannot be fulfilled.
pub fn refused(message: &str, remedy: &str) -> JsValue {
    thrown(Error::request(message, remedy))
}
