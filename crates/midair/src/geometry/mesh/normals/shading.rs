//! How a mesh's normals were chosen, in figures and in a sentence.

/// How a mesh's normals were chosen.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub struct Shading {
    /// Edges between faces that differ by more than the crease angle.
    pub sharp_edges: usize,
    /// Corners whose normal is the file's.
    pub given: usize,
    /// Corners for which the file has a normal that does not fit the faces.
    pub unfit: usize,
    /// Whether the file's normals are only those of its flat faces, which say nothing.
    pub flat: bool,
    /// Corners in all.
    pub corners: usize,
}

impl Shading {
    /// What was chosen, in a sentence.
    pub fn note(&self, crease_angle: f64) -> String {
        let found = format!(
            "smooth up to {crease_angle} degrees between faces, sharp above ({} sharp edges)",
            self.sharp_edges
        );
        if self.given == self.corners {
            "normals: the file's own".to_owned()
        } else if self.given > 0 {
            let share = 100.0 * self.given as f64 / self.corners as f64;
            format!(
                "normals: the file's own at {share:.0} % of the corners, where they fit its faces; elsewhere {found}"
            )
        } else if self.unfit > 0 {
            format!("normals: {found}; the file's own do not fit its faces")
        } else if self.flat {
            format!(
                "normals: {found}; the file's own are those of flat faces, for which write normals = \"flat\""
            )
        } else {
            format!("normals: {found}")
        }
    }
}
