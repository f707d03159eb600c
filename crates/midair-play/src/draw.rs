//! The window, and what is drawn in it.

use crate::options::PlayError;
use crate::present::{self, Picture, Presenter};
use crate::show::Show;
use midair_live::Stages;
use std::sync::Arc;
use std::time::Instant;
use winit::dpi::PhysicalSize;
use winit::event_loop::ActiveEventLoop;
use winit::window::{Fullscreen, Window};

/// The window, and who makes its picture.
pub(crate) struct Screen {
    pub window: Arc<Window>,
    pub presenter: Box<dyn Presenter>,
}

impl Show {
    pub fn open(&self, events: &ActiveEventLoop) -> Result<Screen, PlayError> {
        let wrong = |error: &dyn std::fmt::Display| PlayError::Window(error.to_string());
        let [width, height] = self.options.size.unwrap_or(self.loaded.scene.display.resolution);
        let mut attributes = Window::default_attributes()
            .with_title(format!("midair: {}", self.loaded.scene.name))
            .with_inner_size(PhysicalSize::new(width as u32, height as u32));
        let monitors: Vec<_> = events.available_monitors().collect();
        let monitor = match self.options.screen {
            None => None,
            Some(asked) => match monitors.get(asked) {
                Some(monitor) => Some(monitor.clone()),
                None => return Err(PlayError::Screen { asked, there: monitors.len() }),
            },
        };
        if let Some(monitor) = &monitor {
            attributes = attributes.with_position(monitor.position());
        }
        if self.options.fullscreen {
            attributes = attributes.with_fullscreen(Some(Fullscreen::Borderless(monitor)));
        }
        let window = Arc::new(events.create_window(attributes).map_err(|error| wrong(&error))?);
        window.set_cursor_visible(!self.options.fullscreen);
        let presenter = present::open(&window, self.options.renderer)?;
        Ok(Screen { window, presenter })
    }

    /// The show goes on by the processor where a graphics device gives up.
    fn fall_back(&mut self, why: &str) {
        let Some(screen) = &mut self.screen else { return };
        match present::processor(&screen.window) {
            Ok(processor) => {
                screen.presenter = processor;
                screen.window.request_redraw();
                self.say(format!("the graphics device gave up, the processor goes on: {why}"));
            }
            // Without either there is nothing to be done but to keep the last picture.
            Err(_) => self.say(why.to_owned()),
        }
    }

    /// Warps the newest frame by the newest map, and presents it.
    pub fn draw(&mut self) {
        let lines = if self.show_overlay { self.figures() } else { Vec::new() };
        let Some(frame) = self.shown_frame().cloned() else { return };
        let (Some(map), Some(screen)) = (&self.map, &mut self.screen) else { return };
        let size = screen.window.inner_size();
        // A map for another window or source is on its way to be replaced.
        if map.warp.size() != [size.width as usize, size.height as usize]
            || map.source != frame.size
        {
            return;
        }
        let started = Instant::now();
        let evened = map.evening.as_ref().zip(self.evened.as_ref());
        let (evening, drive) =
            evened.map_or((None, &self.drive), |(evening, drive)| (Some(evening), drive));
        let Ok((light, light_number)) = self.light.of(&frame, evening) else { return };
        let picture = Picture { map, light, light_number, drive, lines: &lines };
        let drawn = match screen.presenter.show(size.into(), &picture) {
            Ok(Some(drawn)) => drawn,
            Ok(None) => return,
            Err(why) => return self.fall_back(&why),
        };
        let now = Instant::now();
        self.presented.push_back(now);
        while self.presented.len() > 60 {
            self.presented.pop_front();
        }
        // A viewpoint counts once, when it is first seen.
        if let Some(map) = &mut self.map
            && let Some((number, came)) = map.packet.take()
        {
            let delay = now.duration_since(came).as_secs_f64();
            self.delay = Some(self.delay.map_or(delay, |known| 0.9 * known + 0.1 * delay));
            if let Some(left) =
                self.departures.as_ref().and_then(|departures| departures.of(number))
            {
                let ms = |from: Instant, to: Instant| 1e3 * to.duration_since(from).as_secs_f64();
                self.shown.push(Stages {
                    whole: ms(left, now),
                    solve: 1e3 * map.seconds,
                    draw: ms(started, drawn),
                    present: ms(drawn, now),
                });
            }
        }
    }

    fn figures(&self) -> Vec<String> {
        let rate = match (self.presented.front(), self.presented.back()) {
            (Some(first), Some(last)) if last > first => {
                (self.presented.len() - 1) as f64 / last.duration_since(*first).as_secs_f64()
            }
            _ => 0.0,
        };
        let mut lines = vec![format!(
            "{rate:.0} frames/s   map {:.1} ms",
            self.map.as_ref().map_or(0.0, |map| 1e3 * map.seconds)
        )];
        lines.extend(self.screen.as_ref().map(|screen| screen.presenter.name().to_owned()));
        if let Some(map) = &self.map {
            let (eye, followed) =
                (map.viewpoint, if self.tracked.is_some() { " (followed)" } else { "" });
            lines.push(format!("eye {:.1} {:.1} {:.1} mm{followed}", eye.x, eye.y, eye.z));
        }
        if let Some(delay) = self.delay {
            lines.push(format!("packet to screen {:.1} ms", 1e3 * delay));
        }
        if self.map.as_ref().is_some_and(|map| map.evening.is_some()) {
            lines.push(format!("gain divided out, {:.1} % clipped", 100.0 * self.light.clipped));
        }
        lines.push(format!("nudging: {}", self.target.name(&self.loaded)));
        if self.uncompensated {
            lines.push("uncompensated".to_owned());
        }
        lines.extend(
            self.message
                .as_ref()
                .filter(|(_, time)| time.elapsed().as_secs() < 5)
                .map(|(text, _)| text.clone()),
        );
        lines
    }
}
