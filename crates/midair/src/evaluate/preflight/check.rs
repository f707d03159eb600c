//! A scene looked over as a whole: what is formed and what is not, and the findings.

use super::{Preflight, preflight, reason};
use crate::map::{Accuracy, Formation, ImagePoint, Map, formation, invert};
use crate::scene::Loaded;
use crate::transport::{Setup, SetupError};
use serde_json::{Value, json};

/// A kind of image point and how much of the image it is.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    /// What becomes of the points.
    pub point: ImagePoint,
    /// The same in words.
    pub name: String,
    /// Their share of the image.
    pub share: f64,
}

/// A scene looked over: data of `midair check`.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Check {
    /// The scene's name.
    pub scene: String,
    /// Its set-up.
    pub setup: Setup,
    /// The set-up's map.
    pub map: Map,
    /// What becomes of the image's points.
    pub formation: Formation,
    /// The kinds of image points that there are, the most frequent first, formed ones before all.
    pub parts: Vec<Part>,
    /// What is wrong, and what helps.
    pub preflight: Preflight,
}

/// Image points along the longer side that are followed.
const POINTS: usize = 512;

impl Check {
    /// Looks a scene over.
    ///
    /// # Errors
    /// [`SetupError`] where the scene cannot be traced.
    pub fn of(loaded: &Loaded) -> Result<Self, SetupError> {
        let setup = Setup::new(loaded)?;
        let (map, _) = invert(&setup, Accuracy::default());
        let [w, h] = setup.image.size;
        let width = if w >= h { POINTS } else { ((POINTS as f64 * w / h) as usize).max(1) };
        let formation = formation(&setup, &map, setup.view_size(width));
        let parts = parts(&setup, &formation);
        let preflight = preflight(&setup, &loaded.scene, &map, &formation);
        Ok(Self { scene: loaded.scene.name.clone(), setup, map, formation, parts, preflight })
    }

    /// The share of the image that becomes this.
    pub fn share(&self, point: ImagePoint) -> f64 {
        self.parts.iter().find(|part| part.point == point).map_or(0.0, |part| part.share)
    }

    /// All of it as data.
    pub fn to_json(&self) -> Value {
        let Self { scene, setup, map, parts, preflight, .. } = self;
        let not_formed: serde_json::Map<String, Value> = parts
            .iter()
            .filter(|part| !matches!(part.point, ImagePoint::Formed | ImagePoint::Folded))
            .map(|part| (part.name.clone(), json!(part.share)))
            .collect();
        json!({
            "scene": scene,
            "image": {
                "formed": self.share(ImagePoint::Formed),
                "folded": self.share(ImagePoint::Folded),
                "not_formed": not_formed,
                "floating": preflight.floating,
            },
            "light": preflight.light,
            "display": {
                "resolution": setup.resolution,
                "size": setup.display.size,
                "pixels": preflight.pixels,
                "status": map.counts(),
                "advice": preflight.display,
            },
            "findings": preflight.findings,
        })
    }
}

fn parts(setup: &Setup, formation: &Formation) -> Vec<Part> {
    let mut shares = formation.shares();
    shares.entry(ImagePoint::Formed).or_default();
    let part = |(point, share)| Part { point, name: reason(setup, point), share };
    let mut parts: Vec<Part> = shares.into_iter().map(part).collect();
    parts.sort_by(|a, b| {
        let formed = |part: &Part| part.point != ImagePoint::Formed;
        formed(a).cmp(&formed(b)).then(b.share.total_cmp(&a.share)).then(a.name.cmp(&b.name))
    });
    parts
}
