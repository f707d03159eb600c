//! What went wrong, as the user is told: one message with place and remedy.

use midair::evaluate::proof::ProofError;
use midair::map::format::FileError;
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

impl From<FileError> for Failure {
    fn from(error: FileError) -> Self {
        match error {
            FileError::Malformed { path, place, problem, remedy } => {
                Self::new(format!("{}: {place}: {problem}", path.display()), remedy)
            }
            FileError::SourceUnknown { path } => Self::new(
                format!(
                    "{}: this kind of map holds pixels of the picture, whose size is not known",
                    path.display()
                ),
                "add --source WxH, the picture's size in pixels",
            ),
            FileError::Unsupported { path, problem, remedy } => {
                Self::new(format!("{}: {problem}", path.display()), remedy)
            }
            FileError::Io { .. } => Self::Told { message: error.to_string(), help: None },
        }
    }
}

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

impl From<SetupError> for Failure {
    fn from(error: SetupError) -> Self {
        Self::new(
            format!("the scene cannot be traced: {error}"),
            "change the elements that it names",
        )
    }
}

impl From<OptimalError> for Failure {
    fn from(error: OptimalError) -> Self {
        Self::new(error.to_string(), "ask for a smaller --size or --supersampling")
    }
}

impl From<ProofError> for Failure {
    fn from(error: ProofError) -> Self {
        match error {
            ProofError::Setup(error) => error.into(),
            ProofError::View(error) => error.into(),
            ProofError::Lattice(error) => Self::Told { message: error.to_string(), help: None },
            ProofError::Similarity(error) => Self::new(
                format!("the views cannot be compared: {error}"),
                "ask for a larger --size",
            ),
        }
    }
}
