//! What went wrong, for a person: what, where, and what helps.

use crate::evaluate::proof::ProofError;
use crate::map::format::{FileError, io_remedy};
use crate::measure::SimilarityError;
use crate::measure::lattice::LatticeStyleError;
use crate::optics::plate::PlateError;
use crate::picture::WarpError;
use crate::picture::optimal::OptimalError;
use crate::scene::SceneError;
use crate::simulate::SimulateError;
use crate::transport::SetupError;
use std::fmt;

/// What kind of thing is wrong: what a caller does about it goes by this.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Kind {
    /// The description of a set-up.
    Scene,
    /// A file cannot be read or written.
    File,
    /// A file's content is damaged, or of a kind that is not read.
    Content,
    /// What was asked for cannot be done: a size, a number, an option.
    Request,
}

/// Where it is wrong.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub struct Place {
    /// The file, as it was named.
    pub file: String,
    /// The line in it, from 1.
    pub line: Option<usize>,
    /// Where in the file, in words, if not by line.
    pub part: Option<String>,
}

/// What went wrong, for a person. `Display` gives one line with the place.
///
/// Every error of the library becomes one of these by `?`; the parts keep their own types, so that callers of a single floor can tell them
/// apart.
pub struct Error(Box<Parts>);

struct Parts {
    kind: Kind,
    place: Option<Place>,
    message: String,
    remedy: Option<String>,
    source: Option<Box<dyn std::error::Error + Send + Sync>>,
}

impl Error {
    /// Something that cannot be done, and what helps.
    pub fn request(message: impl Into<String>, remedy: impl Into<String>) -> Self {
        Self::new(Kind::Request, None, message.into(), Some(remedy.into()))
    }

    fn new(kind: Kind, place: Option<Place>, message: String, remedy: Option<String>) -> Self {
        Self(Box::new(Parts { kind, place, message, remedy, source: None }))
    }

    /// What kind of thing is wrong.
    pub fn kind(&self) -> Kind {
        self.0.kind
    }

    /// Where, if it is in a file.
    pub fn place(&self) -> Option<&Place> {
        self.0.place.as_ref()
    }

    /// What is wrong, without the place.
    pub fn message(&self) -> &str {
        &self.0.message
    }

    /// What helps.
    pub fn remedy(&self) -> Option<&str> {
        self.0.remedy.as_deref()
    }

    /// The fault in a scene's text, with the line to show.
    pub fn scene(&self) -> Option<&SceneError> {
        self.0.source.as_deref()?.downcast_ref()
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(Place { file, line, part }) = &self.0.place {
            write!(f, "{file}")?;
            if let Some(line) = line {
                write!(f, ":{line}")?;
            }
            if let Some(part) = part {
                write!(f, ": {part}")?;
            }
            write!(f, ": ")?;
        }
        write!(f, "{}", self.0.message)
    }
}

impl fmt::Debug for Error {
    /// As people read it: this is what `main` prints.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{self}")?;
        match &self.0.remedy {
            Some(remedy) => write!(f, "\n  help: {remedy}"),
            None => Ok(()),
        }
    }
}

impl std::error::Error for Error {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        self.0.source.as_deref().map(|source| source as _)
    }
}

impl From<SceneError> for Error {
    fn from(error: SceneError) -> Self {
        let (file, line) = error.file_and_line();
        let place = Place { file: file.to_owned(), line, part: None };
        let (message, remedy) = (error.message.clone(), Some(error.help.clone()));
        let mut told = Self::new(Kind::Scene, Some(place), message, remedy);
        told.0.source = Some(Box::new(error));
        told
    }
}

impl From<FileError> for Error {
    fn from(error: FileError) -> Self {
        let at = |path: &std::path::Path, part: Option<String>| {
            Some(Place { file: path.display().to_string(), line: None, part })
        };
        match error {
            FileError::Malformed { path, place, problem, remedy } => {
                Self::new(Kind::Content, at(&path, Some(place)), problem, Some(remedy))
            }
            FileError::SourceUnknown { path } => Self::new(
                Kind::Request,
                at(&path, None),
                "this kind of map holds pixels of the picture, whose size is not known".to_owned(),
                Some("say the picture's width and height in pixels".to_owned()),
            ),
            FileError::Unsupported { path, problem, remedy } => {
                Self::new(Kind::Content, at(&path, None), problem, Some(remedy))
            }
            FileError::Io { path, doing, source } => {
                let message = format!("cannot {doing}: {source}");
                let remedy = Some(io_remedy(&source).to_owned());
                let mut told = Self::new(Kind::File, at(&path, None), message, remedy);
                told.0.source = Some(Box::new(source));
                told
            }
        }
    }
}

impl From<SetupError> for Error {
    fn from(error: SetupError) -> Self {
        let message = format!("the scene cannot be traced: {error}");
        let remedy = "change the elements that it names".to_owned();
        Self::new(Kind::Scene, None, message, Some(remedy))
    }
}

impl From<PlateError> for Error {
    fn from(error: PlateError) -> Self {
        let remedy = format!("give {}", error.allowed);
        Self::new(Kind::Scene, None, error.to_string(), Some(remedy))
    }
}

impl From<ProofError> for Error {
    fn from(error: ProofError) -> Self {
        match error {
            ProofError::Setup(error) => error.into(),
            ProofError::View(error) => error.into(),
            ProofError::Lattice(error) => error.into(),
            ProofError::Similarity(error) => error.into(),
        }
    }
}

#[cfg(feature = "lpips")]
impl From<crate::evaluate::paper::PaperError> for Error {
    fn from(error: crate::evaluate::paper::PaperError) -> Self {
        Self::new(Kind::Request, None, error.to_string(), None)
    }
}

#[cfg(feature = "lpips")]
impl From<crate::measure::lpips::LpipsError> for Error {
    fn from(error: crate::measure::lpips::LpipsError) -> Self {
        Self::new(Kind::File, None, error.to_string(), None)
    }
}

/// Errors that are of what was asked for, and what helps.
macro_rules! requests {
    ($($kind:ty => $remedy:expr),* $(,)?) => {$(
        impl From<$kind> for Error {
            fn from(error: $kind) -> Self {
                Self::request(error.to_string(), $remedy)
            }
        }
    )*};
}

requests! {
    OptimalError => "ask for a smaller size or fewer rays per pixel",
    SimilarityError => "ask for a larger size",
    LatticeStyleError => "change the lattice's lines or their width",
    SimulateError => "change that value",
    WarpError => "ask for a smaller size",
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Format, parse};

    #[test]
    fn an_error_says_what_where_and_what_helps() {
        let text = "[viewpoint]\nposition = [0.0, 0.0, 800.0]\n[image]\nsize = [20.0, 20.0]\n\
                    [plate]\nposition = [0.0, 0.0, -150.0]\nsise = [400.0, 400.0]\n[display]\n";
        let error = Error::from(parse(text, "a.toml", Format::Toml).unwrap_err());
        assert_eq!(error.kind(), Kind::Scene);
        let place = error.place().unwrap();
        assert_eq!((place.file.as_str(), place.line), ("a.toml", Some(7)));
        assert!(error.to_string().starts_with("a.toml:7: "), "{error}");
        assert!(
            error.remedy().is_some_and(|remedy| remedy.contains("size")) && error.scene().is_some()
        );
        assert!(format!("{error:?}").contains("help: "), "{error:?}");
    }

    #[test]
    fn a_file_s_error_names_the_file() {
        let cause = std::io::Error::from(std::io::ErrorKind::NotFound);
        let error = Error::from(FileError::io("no.png".as_ref(), "read", cause));
        assert_eq!(error.kind(), Kind::File);
        assert!(error.to_string().starts_with("no.png: cannot read: "), "{error}");
        assert!(std::error::Error::source(&error).is_some());
    }
}
