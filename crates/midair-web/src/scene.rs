//! Scenes.

use crate::bodies::{Lines, described};
use crate::fault::{data, refused, thrown};
use crate::files::Files;
use crate::rays::Rays;
use crate::solution::Solution;
use crate::still::{Still, codes};
use midair::evaluate::layout::Layout;
use midair::evaluate::preflight;
use midair::evaluate::stray::WINDOW;
use midair::geometry::Vec3;
use midair::map::Map;
use midair::optics::plate::SlitMirrorPlate;
use midair::picture::optimal::{ViewRays, view_through};
use midair::picture::{Picture, check_size, display_image};
use midair::scene::{Format, Loaded, SceneEdit, SceneError, Setting, load_text, to_toml};
use midair::simulate::{Camera, Reference, Sights, check_view, faded_view};
use midair::transport::Setup;
use midair_report::drawing::set_up;
use midair_report::proof::field_picture;
use midair_report::stray;
use serde_json::{Value, json};
use wasm_bindgen::prelude::*;

/// A set-up as a text describes it.
#[wasm_bindgen]
pub struct Scene {
    edit: SceneEdit,
    loaded: Loaded,
    setup: Setup,
    layout: Layout,
}

/// A scene's text is bounded: what is larger is no text that a person has written.
const MOST_BYTES: usize = 1 << 26;

#[wasm_bindgen]
impl Scene {
    /// Reads a scene: TOML, or JSON where `name` ends in .json, which becomes TOML.
    pub fn read(text: &str, name: &str, files: &Files) -> Result<Scene, JsValue> {
        if text.len() > MOST_BYTES {
            return Err(refused("the scene is larger than 64 MiB", "open a scene file"));
        }
        let loaded = load_text(text, name, Format::of_name(name), files.held()).map_err(thrown)?;
        let edit = match Format::of_name(name) {
            Format::Toml => SceneEdit::new(text, name, Format::Toml),
            Format::Json => SceneEdit::new(&to_toml(&loaded.scene), "scene.toml", Format::Toml),
        };
        Self::of(edit.map_err(thrown)?, loaded)
    }

    /// The scene's text.
    #[wasm_bindgen(getter)]
    pub fn text(&self) -> String {
        self.edit.text().to_owned()
    }

    /// What it says at these keys, be it by default; null where it leaves a key out or there is none.
    #[wasm_bindgen(unchecked_return_type = "Value[]")]
    pub fn values(&self, keys: Vec<String>) -> JsValue {
        let value =
            |key: &String| self.edit.get(key).ok().flatten().map_or(Value::Null, |v| json!(v));
        data(&keys.iter().map(value).collect())
    }

    /// With other values at some keys, all or none. Files that the change does not concern are not read again.
    pub fn changed(
        &self,
        #[wasm_bindgen(unchecked_param_type = "Change[]")] changes: JsValue,
        files: &Files,
    ) -> Result<Scene, JsValue> {
        let changes = js_sys::JSON::stringify(&changes).ok().and_then(|text| text.as_string());
        let changes: Option<Vec<Value>> = changes.and_then(|text| serde_json::from_str(&text).ok());
        let read =
            |change: &Value| Some((change["key"].as_str()?.to_owned(), setting(&change["value"])?));
        let changes =
            changes.and_then(|changes| changes.iter().map(read).collect::<Option<Vec<_>>>());
        let Some(changes) = changes else {
            return Err(refused("this is no value of a scene", "give a number, a text or a list"));
        };
        self.edited(files, |edit| {
            let changes: Vec<_> =
                changes.iter().map(|(key, value)| (&key[..], value.clone())).collect();
            edit.change(&changes)
        })
    }

    /// With a block in braces in the place of another, such as a shape of another kind.
    pub fn with_block(&self, key: &str, block: &str, files: &Files) -> Result<Scene, JsValue> {
        self.edited(files, |edit| edit.set_block(key, block))
    }

    /// With one more element, of these keys.
    pub fn with_element(&self, keys: &str, files: &Files) -> Result<Scene, JsValue> {
        self.edited(files, |edit| edit.add_element(keys))
    }

    /// Without an element.
    pub fn without_element(&self, number: usize, files: &Files) -> Result<Scene, JsValue> {
        self.edited(files, |edit| edit.remove_element(number))
    }

    /// With one more element like another.
    pub fn with_copy(&self, number: usize, name: &str, files: &Files) -> Result<Scene, JsValue> {
        self.edited(files, |edit| edit.copy_element(number, name))
    }

    /// Where things stand.
    #[wasm_bindgen(unchecked_return_type = "Layout")]
    pub fn layout(&self) -> JsValue {
        let elements = &self.loaded.scene.elements;
        data(&json!({
            "name": self.loaded.scene.name,
            "bodies": described(&self.layout, &self.setup, elements.len()),
            "eye": self.layout.eye.to_array(),
            "image": self.layout.image.to_array(),
            "elements": elements.iter().map(|element| &element.name).collect::<Vec<_>>(),
            "resolution": self.setup.resolution,
            "pitch": self.setup.pixel_pitch(),
            "notes": self.loaded.notes,
        }))
    }

    /// The lines and faces of a body, by its number in the layout.
    pub fn lines(&self, body: usize) -> Lines {
        Lines::of(&self.layout, &self.loaded, &self.setup, body)
    }

    /// Ways from the viewpoint through `count` x `count` points of the image.
    pub fn rays(&self, count: usize) -> Rays {
        Rays::of(&self.setup, count.clamp(1, 65))
    }

    /// The map on a display of the scene's resolution, or of at most so many pixels along its longer side.
    pub fn solve(&self, longest: Option<usize>) -> Result<Solution, JsValue> {
        let [width, height] = self.setup.resolution;
        let factor = longest.map_or(1.0, |most| (most as f64 / width.max(height) as f64).min(1.0));
        let size = [width, height].map(|side| ((side as f64 * factor).round() as usize).max(1));
        check_size(size).map_err(thrown)?;
        Ok(Solution::of(self.setup.with_resolution(size)))
    }

    /// What is seen of a display that shows this light, from an eye (the viewpoint without one): sRGB codes of a view `width` pixels wide.
    pub fn view(
        &self,
        display: &Still,
        eye: Option<Vec<f64>>,
        width: usize,
        rays: usize,
    ) -> Result<Vec<u8>, JsValue> {
        let camera = self.camera(eye, width, rays)?;
        let setup = self.setup.with_resolution([display.width(), display.height()]);
        seen(&camera.rays(&setup), display)
    }

    /// What is to be seen: the picture with no object in the way.
    pub fn reference(
        &self,
        picture: &Still,
        width: usize,
        rays: usize,
    ) -> Result<Vec<u8>, JsValue> {
        let camera = self.camera(None, width, rays)?;
        let [columns, rows] = camera.size;
        // As a display shows it that is just as fine as the view.
        let flat = Still::of(display_image(picture.picture(), &Map::identity(columns, rows)));
        seen(&Reference::new(&self.setup, &camera), &flat)
    }

    /// How bright a white field is over the image, stretched so that differences show: sRGB codes of a view `width` pixels wide.
    pub fn brightness(&self, width: usize) -> Vec<u8> {
        let white = Picture { width: 1, height: 1, pixels: vec![[1.0; 4]] };
        let size = self.setup.view_size(width.max(1));
        codes(&field_picture(&faded_view(&self.setup, &white, size, |_, _| true)))
    }

    /// The image (white) and the plate's stray light (orange, blue, green) over four times its width and height, of a display that is lit as the scene's map
    /// says: sRGB codes.
    pub fn stray(&self, solved: &Solution, width: usize) -> Result<Vec<u8>, JsValue> {
        let (parameters, _) = self.loaded.scene.plate.model.slit_mirror_or_usual();
        let plate = SlitMirrorPlate::new(parameters).map_err(thrown)?;
        let size = self.setup.view_size(width.max(1));
        let sights = Sights::new(&self.setup, size, WINDOW);
        Ok(codes(&stray::picture(&sights.through(&plate, &self.setup, solved.map()))))
    }

    /// Height of a view that is so many pixels wide.
    pub fn view_height(&self, width: usize) -> usize {
        self.setup.view_size(width.max(1))[1]
    }

    /// What is formed, what is not and why, and what helps.
    #[wasm_bindgen(unchecked_return_type = "Check")]
    pub fn check(&self) -> Result<JsValue, JsValue> {
        let check = preflight::Check::of(&self.loaded).map_err(thrown)?;
        Ok(data(&check.to_json()))
    }

    /// The drawing to build by: SVG.
    pub fn drawing(&self) -> String {
        set_up::drawing(&self.layout, &self.loaded.scene.name)
    }

    /// The set-up in perspective: SVG.
    pub fn perspective(&self) -> String {
        set_up::picture(&self.layout, &self.loaded.scene.name)
    }
}

impl Scene {
    fn of(edit: SceneEdit, loaded: Loaded) -> Result<Self, JsValue> {
        let setup = Setup::new(&loaded).map_err(thrown)?;
        let layout = Layout::of(&setup);
        Ok(Self { edit, loaded, setup, layout })
    }

    fn edited(
        &self,
        files: &Files,
        change: impl FnOnce(&mut SceneEdit) -> Result<(), SceneError>,
    ) -> Result<Self, JsValue> {
        let mut edit = self.edit.clone();
        change(&mut edit).map_err(thrown)?;
        let loaded = self.loaded.changed(&edit, files.held()).map_err(thrown)?;
        Self::of(edit, loaded)
    }

    fn camera(&self, eye: Option<Vec<f64>>, width: usize, rays: usize) -> Result<Camera, JsValue> {
        let eye = match eye.as_deref() {
            None => self.setup.viewpoint,
            Some(&[x, y, z]) if [x, y, z].iter().all(|c| c.is_finite()) => Vec3::new(x, y, z),
            Some(_) => return Err(refused("an eye has three numbers", "give x, y and z in mm")),
        };
        let size = self.setup.view_size(width.max(1));
        check_view(size, rays.max(1)).map_err(thrown)?;
        Ok(Camera { eye, size, window: 1.0, supersampling: rays.max(1) })
    }
}

fn seen(rays: &impl ViewRays, display: &Still) -> Result<Vec<u8>, JsValue> {
    Ok(codes(&view_through(rays, display.picture()).map_err(thrown)?))
}

/// A value as the page has it; the inner `None`: the key goes.
fn setting(value: &Value) -> Option<Option<Setting>> {
    let numbers = |list: &[Value]| list.iter().map(Value::as_f64).collect::<Option<Vec<f64>>>();
    Some(Some(match value {
        Value::Null => return Some(None),
        Value::Bool(flag) => Setting::Flag(*flag),
        Value::Number(number) => match number.as_i64() {
            Some(integer) => Setting::Integer(integer),
            None => Setting::Number(number.as_f64()?),
        },
        Value::String(text) => Setting::Text(text.clone()),
        Value::Array(list) => match list.iter().map(Value::as_i64).collect::<Option<Vec<i64>>>() {
            Some(integers) => Setting::Integers(integers),
            None => match numbers(list) {
                Some(numbers) => Setting::Numbers(numbers),
                None => Setting::Rows(
                    list.iter().map(|row| numbers(row.as_array()?)).collect::<Option<_>>()?,
                ),
            },
        },
        Value::Object(_) => return None,
    }))
}
