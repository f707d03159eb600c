//! What a scene is found to be before it is built.

use crate::setting::{data, to_python};
use midair::evaluate::{percent, preflight};
use midair::map::ImagePoint;
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// What is wrong with a set-up, or worth knowing, and what helps.
#[pyclass(module = "midair._core", frozen)]
pub struct Finding(preflight::Finding);

#[pymethods]
impl Finding {
    /// What it is about: not-formed, off-place, standing-in and so on.
    #[getter]
    fn kind(&self) -> String {
        serde_json::json!(self.0.kind).as_str().unwrap_or_default().to_owned()
    }

    /// fault (it cannot be built, or shows nothing), warning (it will disappoint) or note.
    #[getter]
    fn severity(&self) -> &'static str {
        self.0.severity.name()
    }

    /// What is found.
    #[getter]
    fn sentence(&self) -> &str {
        &self.0.sentence
    }

    /// What helps; None where nothing need be done.
    #[getter]
    fn remedy(&self) -> Option<&str> {
        self.0.remedy.as_deref()
    }

    /// The remedy as values by scene path, for Scene.update; they belong together. Empty where it cannot be said so.
    #[getter]
    fn values<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let dict = PyDict::new(py);
        for line in &self.0.lines {
            dict.set_item(&line.key, to_python(py, &line.value)?)?;
        }
        Ok(dict)
    }

    fn __repr__(&self) -> String {
        format!("<midair.Finding {}: {}>", self.0.severity.name(), self.0.sentence)
    }
}

/// A scene looked over before it is built.
#[pyclass(module = "midair._core", frozen)]
pub struct Check(preflight::Check);

impl Check {
    pub fn new(check: preflight::Check) -> Self {
        Self(check)
    }
}

#[pymethods]
impl Check {
    /// The share of the image that is formed.
    #[getter]
    fn formed(&self) -> f64 {
        self.0.share(ImagePoint::Formed)
    }

    /// Shares of the image by what becomes of them, in words.
    #[getter]
    fn shares<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let dict = PyDict::new(py);
        for part in &self.0.parts {
            dict.set_item(&part.name, part.share)?;
        }
        Ok(dict)
    }

    /// What is wrong and what is worth knowing, the gravest first.
    #[getter]
    fn findings(&self) -> Vec<Finding> {
        self.0.preflight.findings.iter().cloned().map(Finding).collect()
    }

    /// Everything that was found, as midair check --json has it.
    #[getter]
    fn data(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        data(py, &self.0.to_json())
    }

    fn __repr__(&self) -> String {
        let count = |severity| self.0.preflight.count(severity);
        format!(
            "<midair.Check: {} formed, {} faults, {} warnings>",
            percent(self.formed()),
            count(preflight::Severity::Fault),
            count(preflight::Severity::Warning)
        )
    }

    /// A table, for notebooks.
    fn _repr_html_(&self) -> String {
        let mut rows = String::new();
        for finding in &self.0.preflight.findings {
            let lines = match finding.lines_as_toml() {
                lines if lines.is_empty() => String::new(),
                lines => format!("<pre>{}</pre>", escaped(&lines)),
            };
            rows += &format!(
                "<tr><td>{}</td><td style=\"text-align:left\">{}<br><i>{}</i>{lines}</td></tr>",
                finding.severity.name(),
                escaped(&finding.sentence),
                escaped(finding.remedy.as_deref().unwrap_or_default()),
            );
        }
        let formed = percent(self.formed());
        let name = escaped(&self.0.scene);
        format!("<p><b>{name}</b>: {formed} of the image is formed</p><table>{rows}</table>")
    }
}

/// Text as HTML has it.
pub fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}
