//! Elements that come and go, and blocks that are exchanged whole.

use super::grammar::Kind;
use super::path::{Place, Step};
use super::{SceneEdit, Setting, toml};
use crate::scene::{Format, SceneError};

impl SceneEdit {
    /// Makes several changes, all or none: a value for a key, or `None` for a key that goes, as where one key takes the place of another.
    ///
    /// # Errors
    /// As [`set`](Self::set).
    pub fn change(&mut self, values: &[(&str, Option<Setting>)]) -> Result<(), SceneError> {
        let mut changes = Vec::with_capacity(values.len());
        for (path, value) in values {
            let (place, key) = self.place(path)?;
            let value = match (&place.component, value) {
                (Some(component), Some(value)) => {
                    let known = self.known(&place.steps).and_then(|node| super::setting(&node));
                    let put = component.put(known, value.clone());
                    Some(put.map_err(|(message, help)| self.wrong(path, &message, help))?)
                }
                (Some(_), None) => {
                    let help = "leave its last part out";
                    return Err(self.wrong(path, "one number of a list cannot go", help));
                }
                (None, value) => value.clone().map(|value| fitted(&key.kind, value)),
            };
            changes.push((place.steps, value));
        }
        self.accept(changes)
    }

    /// Adds an element: its keys as TOML has them, such as `shape = { kind = "sphere", radius = 25.0 }`.
    ///
    /// # Errors
    /// [`SceneError`] where the text does not conform with it, or is JSON; it stays as it was.
    pub fn add_element(&mut self, keys: &str) -> Result<(), SceneError> {
        self.in_toml()?;
        self.accept_text(&toml::added(&self.text, keys))
    }

    /// Takes an element away.
    ///
    /// # Errors
    /// [`SceneError`] where there is no such element, or the text is JSON; it stays as it was.
    pub fn remove_element(&mut self, number: usize) -> Result<(), SceneError> {
        self.in_toml()?;
        let text = toml::without(&self.text, number).map_err(|problem| self.refused(problem))?;
        self.accept_text(&text)
    }

    /// Adds an element like another, by another name.
    ///
    /// # Errors
    /// As [`remove_element`](Self::remove_element).
    pub fn copy_element(&mut self, number: usize, name: &str) -> Result<(), SceneError> {
        self.in_toml()?;
        let text = toml::with_copy(&self.text, number, name);
        self.accept_text(&text.map_err(|problem| self.refused(problem))?)
    }

    /// Puts a block in the place of another, such as a shape of another kind: `{ kind = "box", size = [50, 50, 50] }`.
    ///
    /// # Errors
    /// [`SceneError`] where there is no such block, or the text does not conform with it, or is JSON; it stays as it was.
    pub fn set_block(&mut self, path: &str, block: &str) -> Result<(), SceneError> {
        self.in_toml()?;
        let place = Place::new(path, &self.scene)
            .map_err(|(message, help)| self.wrong(path, &message, help))?;
        if place.component.is_some() || matches!(place.steps.last(), Some(Step::Item(_)) | None) {
            return Err(self.wrong(path, "this is no block of keys", "name one, as plate"));
        }
        let text = toml::with_block(&self.text, &place.steps, block);
        self.accept_text(&text.map_err(|problem| self.refused(problem))?)
    }

    /// Elements are moved about in TOML only: JSON is what programs write, and they write it anew.
    fn in_toml(&self) -> Result<(), SceneError> {
        match self.format {
            Format::Toml => Ok(()),
            Format::Json => {
                let help = "save the scene as TOML first";
                Err(self.places.error(None, "elements are added and removed in TOML only", help))
            }
        }
    }

    fn refused(&self, problem: String) -> SceneError {
        self.places.error(None, problem, "change the file by hand")
    }

    fn accept_text(&mut self, text: &str) -> Result<(), SceneError> {
        *self = Self::new(text, self.places.name(), self.format)?;
        Ok(())
    }
}

/// A value as its key has them: whole numbers for lengths and angles are numbers, as they come from languages that do not tell the two apart.
fn fitted(kind: &Kind, value: Setting) -> Setting {
    match (kind, value) {
        (Kind::Number(..) | Kind::Colour(..), Setting::Integer(i)) => Setting::Number(i as f64),
        (Kind::Numbers(..) | Kind::Colour(..) | Kind::List(..), Setting::Integers(list)) => {
            Setting::Numbers(list.into_iter().map(|i| i as f64).collect())
        }
        (_, value) => value,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SCENE: &str = "[viewpoint]\nposition = [0.0, 0.0, 800.0]\n[image]\nsize = [20.0, 20.0]\n\
        [plate]\nsize = [90.0, 90.0]\n\n[[element]] # of glass\nname = \"a\"\nmaterial = { ior = 1.5 }\n\
        [element.shape]\nkind = \"sphere\"\nradius = 25.0\n";

    fn scene() -> SceneEdit {
        SceneEdit::new(SCENE, "a.toml", Format::Toml).unwrap()
    }

    fn names(edit: &SceneEdit) -> Vec<&str> {
        edit.scene().elements.iter().map(|element| element.name.as_str()).collect()
    }

    #[test]
    fn elements_come_and_go_and_the_rest_of_the_text_stays() {
        let mut edit = scene();
        edit.copy_element(0, "b").unwrap();
        edit.add_element("name = \"c\"\nshape = { kind = \"plane\", size = [1.0, 2.0] }\nmaterial = { mirror = true }\n")
            .unwrap();
        assert_eq!(names(&edit), ["a", "b", "c"]);
        assert_eq!(edit.scene().elements[0].shape, edit.scene().elements[1].shape);
        assert!(edit.text().starts_with(SCENE), "{}", edit.text());
        edit.remove_element(0).unwrap();
        assert_eq!(names(&edit), ["b", "c"]);
        edit.remove_element(1).unwrap();
        edit.remove_element(0).unwrap();
        assert!(edit.scene().elements.is_empty());
        // A new one after the last has gone.
        edit.add_element("shape = { kind = \"sphere\", radius = 1.0 }\nmaterial = { ior = 1.5 }")
            .unwrap();
        assert_eq!(edit.scene().elements.len(), 1);
    }

    #[test]
    fn elements_in_one_line_come_and_go_as_well() {
        let text = "element = [{ name = \"a\", shape = { kind = \"sphere\", radius = 25.0 }, material = { ior = 1.5 } }]\n\
            [viewpoint]\nposition = [0.0, 0.0, 800.0]\n[image]\nsize = [20.0, 20.0]\n[plate]\nsize = [90.0, 90.0]\n";
        let mut edit = SceneEdit::new(text, "a.toml", Format::Toml).unwrap();
        edit.copy_element(0, "b").unwrap();
        assert_eq!(names(&edit), ["a", "b"]);
        edit.remove_element(0).unwrap();
        assert_eq!(names(&edit), ["b"]);
    }

    #[test]
    fn a_block_and_a_key_take_the_place_of_others() {
        let mut edit = scene();
        edit.set_block("element.a.shape", "{ kind = \"box\", size = [1.0, 2.0, 3.0] }").unwrap();
        assert_eq!(edit.get("element.a.shape.size.z").unwrap(), Some(Setting::Number(3.0)));
        let glass = Setting::Text("N-BK7".to_owned());
        edit.change(&[
            ("element.a.material.ior", None),
            ("element.a.material.glass", Some(glass.clone())),
        ])
        .unwrap();
        assert_eq!(edit.get("element.a.material.glass").unwrap(), Some(glass));
        assert_eq!(edit.get("element.a.material.ior").unwrap(), None);
        // Whole numbers are numbers where lengths are meant, and stay whole where counts are.
        edit.change(&[
            ("viewpoint.position", Some([0i64, 5, 800].into())),
            ("display.resolution", Some([4i64, 3].into())),
        ])
        .unwrap();
        assert!(edit.text().contains("position = [0.0, 5.0, 800.0]"), "{}", edit.text());
        assert!(edit.text().contains("resolution = [4, 3]"), "{}", edit.text());
    }

    #[test]
    fn what_does_not_fit_is_refused_and_the_text_stays() {
        let mut edit = scene();
        type Change = fn(&mut SceneEdit) -> Result<(), SceneError>;
        let refusals: [Change; 6] = [
            |edit| edit.remove_element(1),
            |edit| edit.copy_element(7, "b"),
            |edit| edit.add_element("name = 3"),
            |edit| edit.set_block("element.a.shape", "{ kind = \"box\" }"),
            |edit| edit.set_block("element.a.shape", "nonsense"),
            |edit| edit.change(&[("element.a.material.ior", None)]),
        ];
        for refused in refusals {
            refused(&mut edit).unwrap_err();
            assert_eq!(edit.text(), SCENE);
        }
    }
}
