//! What went wrong, as the user is told: one message with place and remedy.

use midair::evaluate::proof::ProofError;
use midair::map::format::FileError;
use midair::optics::plate::PlateError;
use midair::picture::optimal::OptimalError;
use midair::scene::SceneError;
use midair::transport::SetupError;
use midair_video::VideoError;

/// Why a command could not do its work.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
pub enum Failure {
    /// Something is wrong with a scene file: shown with the line.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Scene(Box<SceneError>),
    /// Anything else.
    #[error("{message}")]
    Told {
        /// What is wrong, and with what.
        message: String,
        /// What to do about it.
        #[help]
        help: Option<String>,
    },
}

impl Failure {
    /// A message with its remedy.
    pub fn new(message: impl Into<String>, help: impl Into<String>) -> Self {
        Self::Told { message: message.into(), help: Some(help.into()) }
    }
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
