//! What is varied: a key of the scene, and its values.

use crate::scene::model::{Scene, Shape};
use crate::scene::{SceneEdit, SceneError, Setting};
use serde::Serialize;
use std::str::FromStr;

/// A key of the scene and the values that it is given.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Axis {
    /// The key, as [`SceneEdit`] names it: `image.position.z`, `element.cube.rotation.y`. A list `size` keeps its proportions; the value is its
    /// first number.
    pub path: String,
    /// The values, in the key's unit.
    pub values: Vec<f64>,
}

/// A key of the scene and the interval that a search may give it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Limit {
    /// As of an [`Axis`].
    pub path: String,
    /// The least and the largest value.
    pub range: [f64; 2],
}

/// A text that is no axis.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("`{text}`: {problem}; {help}")]
pub struct AxisError {
    text: String,
    problem: &'static str,
    help: &'static str,
}

/// Of one axis; more would be a mistyped number.
const MOST: usize = 100_000;

fn split(text: &str) -> Option<(&str, &str)> {
    let (path, values) = text.split_once('=')?;
    let (path, values) = (path.trim(), values.trim());
    (!path.is_empty() && !values.is_empty()).then_some((path, values))
}

fn value(text: &str) -> Option<f64> {
    text.trim().parse().ok().filter(|number: &f64| number.is_finite())
}

fn interval(text: &str) -> Option<[f64; 2]> {
    let (from, to) = text.split_once("..")?;
    Some([value(from)?, value(to)?])
}

/// `PATH=FROM..TO:COUNT`, both ends included, or `PATH=A,B,C`.
impl FromStr for Axis {
    type Err = AxisError;

    fn from_str(text: &str) -> Result<Self, AxisError> {
        let help = "write PATH=FROM..TO:COUNT, such as image.position.z=-20..20:5, or PATH=A,B,C";
        let wrong = |problem| AxisError { text: text.to_owned(), problem, help };
        let (path, told) = split(text).ok_or_else(|| wrong("there is no key and value"))?;
        let values: Vec<f64> = if told.contains("..") {
            let (ends, count) =
                told.rsplit_once(':').ok_or_else(|| wrong("how many values is not said"))?;
            let [from, to] = interval(ends).ok_or_else(|| wrong("this is no interval"))?;
            let count: usize =
                count.trim().parse().map_err(|_| wrong("the count is no whole number"))?;
            if !(2..=MOST).contains(&count) {
                return Err(wrong("the count is to lie between 2 and 100000"));
            }
            (0..count).map(|i| from + (to - from) * i as f64 / (count - 1) as f64).collect()
        } else {
            let numbers = told.split(',').map(value).collect::<Option<_>>();
            numbers.ok_or_else(|| wrong("a value is no number"))?
        };
        Ok(Self { path: path.to_owned(), values })
    }
}

/// `PATH=FROM..TO`.
impl FromStr for Limit {
    type Err = AxisError;

    fn from_str(text: &str) -> Result<Self, AxisError> {
        let help = "write PATH=FROM..TO, such as image.position.z=-20..20";
        let wrong = |problem| AxisError { text: text.to_owned(), problem, help };
        let (path, told) = split(text).ok_or_else(|| wrong("there is no key and value"))?;
        let range = interval(told).ok_or_else(|| wrong("this is no interval"))?;
        if !(range[0] < range[1]) {
            return Err(wrong("the interval is empty"));
        }
        Ok(Self { path: path.to_owned(), range })
    }
}

impl Limit {
    /// Where an image is looked for unless somebody says otherwise: moved by up to half its larger side, of half to one and a half times its size, and
    /// every element that is not the same from all sides turned about its y axis.
    pub fn usual(scene: &Scene) -> Vec<Self> {
        let image = &scene.image;
        let room = image.size[0].max(image.size[1]) / 2.0;
        let moved = ["x", "y", "z"].into_iter().zip(image.pose.position).map(|(axis, at)| Self {
            path: format!("image.position.{axis}"),
            range: [at - room, at + room],
        });
        let sized = Self {
            path: "image.size".to_owned(),
            range: [0.5, 1.5].map(|times| times * image.size[0]),
        };
        let is_round = |shape: &Shape| {
            matches!(
                shape,
                Shape::Sphere { .. }
                    | Shape::Cylinder { .. }
                    | Shape::Cone { .. }
                    | Shape::Hemisphere { .. }
                    | Shape::Torus { .. }
                    | Shape::Lathe { .. }
            )
        };
        let turned = scene.elements.iter().enumerate().filter(|(_, e)| !is_round(&e.shape));
        let turned = turned.map(|(i, element)| Self {
            path: format!("element.{i}.rotation.y"),
            range: [element.pose.rotation[1] - 180.0, element.pose.rotation[1] + 180.0],
        });
        moved.chain([sized]).chain(turned).collect()
    }
}

/// The place of a combination of values along each axis: the last axis runs fastest.
pub(super) fn places(axes: &[Axis], mut number: usize) -> Vec<usize> {
    let mut places = vec![0; axes.len()];
    for (place, axis) in places.iter_mut().zip(axes).rev() {
        *place = number % axis.values.len();
        number /= axis.values.len();
    }
    places
}

/// The number of the combination at these places.
pub(super) fn number(axes: &[Axis], places: &[usize]) -> usize {
    places.iter().zip(axes).fold(0, |number, (place, axis)| number * axis.values.len() + place)
}

/// Gives a key a value.
pub(super) fn put(edit: &mut SceneEdit, path: &str, value: f64) -> Result<(), SceneError> {
    let setting = match edit.get(path)? {
        Some(Setting::Numbers(sides)) if path.ends_with("size") && sides[0] > 0.0 => {
            Setting::Numbers(sides.iter().map(|side| side * value / sides[0]).collect())
        }
        Some(Setting::Integer(_)) => Setting::Integer(value.round() as i64),
        _ => Setting::Number(value),
    };
    edit.set(path, setting)
}
