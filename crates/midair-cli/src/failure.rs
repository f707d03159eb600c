//! What went wrong, as the user is told: one message with place and remedy.

use annotate_snippets::{AnnotationKind, Group, Level, Renderer, Snippet};
use midair::evaluate::proof::ProofError;
use midair::map::format::FileError;
use midair::optics::plate::PlateError;
use midair::picture::optimal::OptimalError;
use midair::scene::SceneError;
use midair::transport::SetupError;
use midair_video::VideoError;

/// Why a command could not do its work.
#[derive(Debug, thiserror::Error)]
pub enum Failure {
    /// Something is wrong with a scene file: shown with the line.
    #[error(transparent)]
    Scene(Box<SceneError>),
    /// Anything else.
    #[error("{message}")]
    Told {
        /// What is wrong, and with what.
        message: String,
        /// What to do about it.
        help: Option<String>,
    },
}

impl Failure {
    /// A message with its remedy.
    pub fn new(message: impl Into<String>, help: impl Into<String>) -> Self {
        Self::Told { message: message.into(), help: Some(help.into()) }
    }

    /// As the terminal shows it: what is wrong, the line of the scene file if one is to blame, what to do about it; in colours, which a stream that goes
    /// elsewhere takes out.
    pub fn shown(&self) -> String {
        let groups: Vec<Group> = match self {
            Self::Scene(error) => {
                std::iter::once(&**error).chain(&error.others).map(of_scene).collect()
            }
            Self::Told { message, help } => {
                let group = Group::with_title(Level::ERROR.primary_title(message));
                vec![group.elements(help.iter().map(|help| Level::HELP.message(help)))]
            }
        };
        Renderer::styled().render(&groups)
    }
}

fn of_scene(error: &SceneError) -> Group<'_> {
    // The place is shown with the line, if there is one.
    let (file, line) = error.file_and_line();
    let title = match line {
        Some(_) => error.message.clone(),
        None => error.to_string(),
    };
    let snippet = error.span().map(|span| {
        let here = AnnotationKind::Primary.span(span);
        Snippet::source(error.text()).path(file).annotation(here)
    });
    let group = Group::with_title(Level::ERROR.primary_title(title));
    group.elements(snippet).element(Level::HELP.message(&error.help))
}

impl From<SceneError> for Failure {
    fn from(error: SceneError) -> Self {
        Self::Scene(Box::new(error))
    }
}

impl From<midair::Error> for Failure {
    fn from(error: midair::Error) -> Self {
        match error.scene() {
            Some(scene) => scene.clone().into(),
            None => {
                Self::Told { message: error.to_string(), help: error.remedy().map(str::to_owned) }
            }
        }
    }
}

impl From<FileError> for Failure {
    fn from(error: FileError) -> Self {
        match error {
            FileError::SourceUnknown { .. } => {
                let message = midair::Error::from(error).to_string();
                Self::new(message, "add --source WxH, the picture's size in pixels")
            }
            error => midair::Error::from(error).into(),
        }
    }
}

/// Errors of the library's floors.
macro_rules! of_the_library {
    ($($kind:ty),* $(,)?) => {$(
        impl From<$kind> for Failure {
            fn from(error: $kind) -> Self {
                midair::Error::from(error).into()
            }
        }
    )*};
}

of_the_library!(SetupError, PlateError, OptimalError, ProofError);

impl From<VideoError> for Failure {
    fn from(error: VideoError) -> Self {
        let help = match &error {
            VideoError::Missing { .. } => "films go through ffmpeg 5.1 or later, ffprobe included",
            VideoError::Refused { .. } => {
                "check the file with `ffprobe`; copy or export it again if it is damaged"
            }
            VideoError::NoVideo { .. } => "name a film or a picture",
            VideoError::Pipe { .. } => "check the disk and the installed ffmpeg",
        };
        Self::new(error.to_string(), help)
    }
}
