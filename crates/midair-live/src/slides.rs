//! Pictures in the display's own pixels, one after the other: by key, by time, or by a command that photographs each.

use std::time::Duration;

/// What the next picture comes by.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Turn {
    /// A key.
    ByKey,
    /// So long after the last one, or a key; the show ends after the last picture.
    After(Duration),
    /// The end of a command that is run once for each picture; the show ends after the last.
    Released {
        /// From the picture's presentation to the command: screens take a while to light up and to fade.
        settle: Duration,
    },
}

/// What is to be done.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Act {
    /// This picture is to be presented.
    Show(usize),
    /// The command is to be run for this picture.
    Release(usize),
    /// The window keeps this size, which is not the display's.
    Refuse([usize; 2]),
    /// The show is over.
    End,
}

/// When a window that took no picture is offered it again.
const AGAIN: Duration = Duration::from_millis(50);

/// Pictures one after the other, as they stand. It has no clock: readings come with what happens.
#[derive(Clone, Debug)]
pub struct Slides {
    /// The display's pixels: what has others is not shown in.
    resolution: [usize; 2],
    count: usize,
    turn: Turn,
    /// Which picture it is the turn of; `count` after the last.
    at: usize,
    /// The window's pixels, and since when.
    size: Option<([usize; 2], Duration)>,
    /// Whether the window does not show what it should.
    stale: bool,
    /// When the picture was presented.
    presented: Option<Duration>,
    /// Whether the command runs.
    releasing: bool,
}

/// So long a window system may take until a window has the size that was asked for.
pub const GRACE: Duration = Duration::from_secs(1);

impl Slides {
    /// So many pictures for a display of these pixels.
    pub fn new(resolution: [usize; 2], count: usize, turn: Turn) -> Self {
        Self {
            resolution,
            count,
            turn,
            at: 0,
            size: None,
            stale: true,
            presented: None,
            releasing: false,
        }
    }

    /// How many pictures have had their turn.
    pub fn done(&self) -> usize {
        self.at
    }

    /// The window has so many pixels.
    pub fn resize(&mut self, size: [usize; 2], now: Duration) {
        if self.size.is_none_or(|(known, _)| known != size) {
            self.size = Some((size, now));
        }
        self.stale = true;
    }

    /// The window lost what it showed.
    pub fn redraw(&mut self) {
        self.stale = true;
    }

    /// The picture is on the screen.
    pub fn presented(&mut self, now: Duration) {
        self.stale = false;
        // Drawn anew it stands no longer; but a camera is to see what has settled.
        match self.turn {
            Turn::Released { .. } => self.presented = Some(now),
            Turn::ByKey | Turn::After(_) => self.presented = self.presented.or(Some(now)),
        }
    }

    /// A key asks for the next picture, or the one before. There is none beyond the last, and while a command photographs, order is the command's.
    pub fn step(&mut self, forward: bool) {
        if !matches!(self.turn, Turn::Released { .. }) {
            let last = self.count.saturating_sub(1);
            self.turn_to(if forward { (self.at + 1).min(last) } else { self.at.saturating_sub(1) });
        }
    }

    /// The command did what it should.
    pub fn released(&mut self) {
        self.releasing = false;
        self.turn_to(self.at + 1);
    }

    fn turn_to(&mut self, at: usize) {
        if at != self.at {
            (self.at, self.stale, self.presented) = (at, true, None);
        }
    }

    /// What is to be done now, one thing after the other until there is none.
    pub fn act(&mut self, now: Duration) -> Option<Act> {
        let (size, since) = self.size?;
        if size != self.resolution {
            return (now >= since + GRACE).then_some(Act::Refuse(size));
        }
        if self.is_due(now) {
            match self.turn {
                Turn::Released { .. } => {
                    self.releasing = true;
                    return Some(Act::Release(self.at));
                }
                Turn::After(_) => self.turn_to(self.at + 1),
                Turn::ByKey => {}
            }
        }
        match self.at < self.count {
            false => Some(Act::End),
            true => self.stale.then_some(Act::Show(self.at)),
        }
    }

    /// Whether what comes after the picture's presentation is due.
    fn is_due(&self, now: Duration) -> bool {
        self.due().is_some_and(|due| now >= due)
    }

    fn due(&self) -> Option<Duration> {
        let (_, since) = self.size?;
        let presented = self.presented.filter(|_| self.at < self.count)?;
        match self.turn {
            Turn::ByKey => None,
            Turn::After(pause) => Some(presented + pause),
            // Nothing is photographed in a window that may still become another.
            Turn::Released { settle } => {
                (!self.releasing && !self.stale).then(|| (presented + settle).max(since + GRACE))
            }
        }
    }

    /// When there may be something to be done, if nothing else happens.
    pub fn next(&self, now: Duration) -> Option<Duration> {
        let (size, since) = self.size?;
        match (size == self.resolution, self.stale && self.at < self.count) {
            (false, _) => Some(since + GRACE),
            // The window took no picture: it is offered the same again.
            (true, true) => Some(now + AGAIN),
            (true, false) => self.due(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: [usize; 2] = [640, 480];

    fn ms(ms: u64) -> Duration {
        Duration::from_millis(ms)
    }

    /// Three pictures in a window that has its size from the beginning.
    fn slides(turn: Turn) -> Slides {
        let mut slides = Slides::new(SIZE, 3, turn);
        assert_eq!(slides.act(ms(0)), None);
        slides.resize(SIZE, ms(0));
        assert_eq!(slides.act(ms(0)), Some(Act::Show(0)));
        slides.presented(ms(10));
        assert_eq!(slides.act(ms(10)), None);
        slides
    }

    #[test]
    fn keys_go_forth_and_back_and_not_beyond_either_end() {
        let mut slides = slides(Turn::ByKey);
        assert_eq!((slides.act(ms(100_000)), slides.next(ms(100_000))), (None, None));
        slides.step(false);
        assert_eq!(slides.act(ms(11)), None);
        for wanted in [1, 2] {
            slides.step(true);
            assert_eq!(slides.act(ms(12)), Some(Act::Show(wanted)));
            slides.presented(ms(13));
        }
        slides.step(true);
        assert_eq!(slides.act(ms(14)), None);
        slides.step(false);
        assert_eq!(slides.act(ms(15)), Some(Act::Show(1)));
    }

    #[test]
    fn by_time_each_stands_as_long_and_the_last_ends_the_show() {
        let mut slides = slides(Turn::After(ms(500)));
        for wanted in [1, 2] {
            let due = slides.next(ms(10)).unwrap();
            assert_eq!(slides.act(due - ms(1)), None);
            assert_eq!(slides.act(due), Some(Act::Show(wanted)));
            // A picture that takes a while to come stands as long.
            slides.presented(due + ms(40));
            assert_eq!(slides.next(due), Some(due + ms(540)));
        }
        let due = slides.next(ms(10)).unwrap();
        // What is drawn anew in between does not begin anew.
        slides.redraw();
        assert_eq!(slides.act(due - ms(9)), Some(Act::Show(2)));
        slides.presented(due - ms(8));
        assert_eq!(slides.act(due), Some(Act::End));
        assert_eq!((slides.done(), slides.next(due)), (3, None));
    }

    #[test]
    fn the_command_is_run_once_for_each_after_it_has_settled() {
        let mut slides = slides(Turn::Released { settle: ms(300) });
        // Not before the window is sure to stay.
        assert_eq!((slides.next(ms(999)), slides.act(ms(999))), (Some(GRACE), None));
        let mut now = GRACE;
        for picture in 0..3 {
            assert_eq!(slides.act(now), Some(Act::Release(picture)));
            // However long it takes; keys do nothing.
            slides.step(true);
            assert_eq!((slides.act(now + ms(60_000)), slides.next(now)), (None, None));
            slides.released();
            now += ms(60_000);
            if picture < 2 {
                assert_eq!(slides.act(now), Some(Act::Show(picture + 1)));
                // A window that takes none just now is asked again.
                assert_eq!(slides.next(now), Some(now + AGAIN));
                slides.presented(now);
                assert_eq!((slides.act(now), slides.next(now)), (None, Some(now + ms(300))));
                now += ms(300);
            }
        }
        assert_eq!((slides.act(now), slides.done()), (Some(Act::End), 3));
    }

    #[test]
    fn a_window_of_another_size_is_given_a_moment_and_then_refused() {
        let mut slides = Slides::new(SIZE, 3, Turn::Released { settle: ms(0) });
        slides.resize([800, 600], ms(0));
        assert_eq!((slides.act(ms(999)), slides.next(ms(999))), (None, Some(GRACE)));
        // The window system has made it right.
        slides.resize(SIZE, ms(999));
        assert_eq!(slides.act(ms(999)), Some(Act::Show(0)));
        slides.presented(ms(1000));
        // And wrong: what was shown there is not photographed.
        slides.resize([1024, 768], ms(1500));
        assert_eq!(slides.act(ms(2499)), None);
        assert_eq!(slides.act(ms(2500)), Some(Act::Refuse([1024, 768])));
        // The same size told once more is no new one.
        slides.resize([1024, 768], ms(2499));
        assert_eq!(slides.act(ms(2500)), Some(Act::Refuse([1024, 768])));
    }
}
