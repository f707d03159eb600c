//! The fitted scene as a file: the user's own text with the fitted values in it, and how sure they are as comments.

use crate::finding::Finding;
use crate::freedom::sizes;
use midair::scene::model::{Element, Index, Material, Pose};
use midair::scene::{Format, Loaded, SceneEdit, SceneError};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// A length or angle to a ten-thousandth: far below what any photograph tells.
fn rounded(value: f64) -> f64 {
    let value = (value * 1e4).round() / 1e4;
    // No minus before nothing.
    if value == 0.0 { 0.0 } else { value }
}

/// The text of the scene file that was assumed, with what was found written into it. `rename` says how the files that it names are found from where it is
/// to be saved.
///
/// # Errors
/// Where the text does not take a value.
pub fn fitted_text(
    assumed: &Loaded,
    finding: &Finding,
    rename: &dyn Fn(&Path) -> PathBuf,
) -> Result<String, SceneError> {
    let mut edit = SceneEdit::of(&assumed.text)?;
    edit.rename_files(rename)?;
    let found = &finding.loaded.scene;
    for (i, (before, after)) in assumed.scene.elements.iter().zip(&found.elements).enumerate() {
        let key = |key: &str| format!("element.{i}.{key}");
        set_pose(&mut edit, &format!("element.{i}"), &before.pose, &after.pose)?;
        if let (Some(n), true) = (constant(after), constant(after) != constant(before)) {
            edit.set(&key("material.ior"), (n * 1e6).round() / 1e6)?;
        }
        for (old, new) in sizes(before).iter().zip(sizes(after)) {
            if new.value != old.value {
                let item = new.item.map(|item| format!(".{item}")).unwrap_or_default();
                edit.set(&key(&format!("shape.{}{item}", new.key)), rounded(new.value))?;
            }
        }
    }
    let (before, after) = (&assumed.scene.plate.rectangle.pose, &found.plate.rectangle.pose);
    set_pose(&mut edit, "plate", before, after)?;
    // Left out, the display's place would go by the elements' and the viewpoint, and it does not.
    if let (None, Some(pose)) = (&assumed.scene.display.pose, &found.display.pose) {
        edit.set("display.position", pose.position.map(rounded))?;
        edit.set("display.rotation", pose.rotation.map(rounded))?;
    }
    Ok(match edit.format() {
        Format::Toml => format!("{}{}", comments(finding), edit.text()),
        Format::Json => edit.text().to_owned(),
    })
}

fn constant(element: &Element) -> Option<f64> {
    match element.material {
        Material::Refractive { index: Index::Constant(n), .. } => Some(n),
        _ => None,
    }
}

fn set_pose(
    edit: &mut SceneEdit,
    key: &str,
    before: &Pose,
    after: &Pose,
) -> Result<(), SceneError> {
    // What no step changed comes back from its frame with rounding.
    let same = |a: [f64; 3], b: [f64; 3]| (0..3).all(|k| (a[k] - b[k]).abs() < 1e-9);
    if !same(before.position, after.position) {
        edit.set(&format!("{key}.position"), after.position.map(rounded))?;
    }
    if !same(before.rotation, after.rotation) {
        edit.set(&format!("{key}.rotation"), after.rotation.map(rounded))?;
    }
    Ok(())
}

fn comments(finding: &Finding) -> String {
    let mut lines = String::from(
        "# Fitted to photographs by `midair calibrate fit`; after ± one standard deviation:\n",
    );
    for parameter in &finding.parameters {
        if parameter.name.starts_with("view.") || parameter.name.starts_with("camera.") {
            continue;
        }
        let told = if parameter.determined { "" } else { "  (not determined)" };
        // A string takes all that is written to it.
        let _ = writeln!(
            lines,
            "#   {} = {:.4} ± {:.4}, assumed {:.4}{told}",
            parameter.name, parameter.value, parameter.sigma, parameter.start
        );
    }
    lines += "\n";
    lines
}
