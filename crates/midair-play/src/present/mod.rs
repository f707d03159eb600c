//! How the picture is made and gets to the window: by the processor, or by a graphics device. Both show the same codes.

mod graphics;
mod processor;

use crate::letters::Letters;
use crate::options::{PlayError, Renderer};
use graphics::Graphics;
use midair_live::{Clock, Picture};
pub(crate) use processor::Processor;
use std::sync::Arc;
use std::time::Duration;
use winit::window::Window;

/// Who makes the picture of a window.
pub(crate) trait Presenter {
    /// Warps the frame and shows it in the window. The clock's reading when the picture was ready to be handed over; `None` if the window
    /// takes none just now.
    ///
    /// # Errors
    /// Why this presenter will not work any more.
    fn show(
        &mut self,
        picture: &Picture<'_>,
        letters: &Letters,
        clock: Clock,
    ) -> Result<Option<Duration>, String>;

    /// What makes the picture, for people.
    fn name(&self) -> &str;
}

/// The presenter that was asked for.
pub(crate) fn open(
    window: &Arc<Window>,
    renderer: Renderer,
) -> Result<Box<dyn Presenter>, PlayError> {
    match renderer {
        Renderer::Cpu => processor(window),
        Renderer::Gpu => match Graphics::open(window, true) {
            Ok(graphics) => Ok(Box::new(graphics)),
            Err(why) => Err(PlayError::Graphics(why.to_string())),
        },
        // A device that is the processor in disguise would only be a slower way to the same picture.
        Renderer::Auto => match Graphics::open(window, false) {
            Ok(graphics) => Ok(Box::new(graphics)),
            Err(_) => processor(window),
        },
    }
}

/// The processor, which works on every machine with a window.
pub(crate) fn processor(window: &Arc<Window>) -> Result<Box<dyn Presenter>, PlayError> {
    Ok(Box::new(Processor::open(window)?))
}
