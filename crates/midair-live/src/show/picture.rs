//! What is to be seen of the show, and what came of showing it.

use super::{PATIENCE, Picture, Show};
use crate::trial::{Departures, Stages};
use std::time::Duration;

/// What is taken of the average of latencies at each new one.
const NEW_SHARE: f64 = 0.1;

impl Show {
    /// What is to be drawn now. Until a map for another frame or set-up has come, the last one stays, with the frames that it fits; without
    /// any for this display the picture is black, but not before the wait has become long.
    pub fn picture(&mut self, now: Duration) -> Option<Picture<'_>> {
        let fits = self.fits();
        let map = self.map.as_ref().filter(|_| fits);
        let dark = self.attendance.is_dark();
        let Some(map) = map.filter(|_| !dark) else {
            let long = dark || self.awaited.is_some_and(|since| now >= since + PATIENCE);
            let (light, number) = self.light.last();
            let (size, drive) = (self.size, &self.drive);
            return long.then_some(Picture {
                size,
                warp: None,
                source: [1, 1],
                light: (light, number),
                drive,
            });
        };
        let frames = [self.wanted(), self.frame.as_ref(), Some(&self.lattice)];
        let frame = frames.into_iter().flatten().find(|frame| frame.size == map.source)?.clone();
        let evened = map.evening.as_ref().zip(self.evened.as_ref());
        let (evening, drive) =
            evened.map_or((None, &self.drive), |(evening, drive)| (Some(evening), drive));
        let light = self.light.of(&frame, evening).ok()?;
        let warp = Some((&map.warp, map.number));
        Some(Picture { size: self.size, warp, source: map.source, light, drive })
    }

    /// The picture was begun, was ready, and has been presented.
    pub fn presented(
        &mut self,
        begun: Duration,
        ready: Duration,
        now: Duration,
        trial: Option<&Departures>,
    ) -> Option<Stages> {
        self.presented.push_back(now);
        while self.presented.len() > 60 {
            self.presented.pop_front();
        }
        // A viewpoint counts once, when it is first seen.
        let map = self.map.as_mut()?;
        let (number, came) = map.packet.take()?;
        let delay = now.saturating_sub(came).as_secs_f64();
        let known = self.delay.unwrap_or(delay);
        self.delay = Some(known + NEW_SHARE * (delay - known));
        let left = trial?.of(number)?;
        let ms = |from: Duration, to: Duration| 1e3 * to.saturating_sub(from).as_secs_f64();
        Some(Stages {
            whole: ms(left, now),
            solve: 1e3 * map.seconds,
            draw: ms(begun, ready),
            present: ms(ready, now),
        })
    }
}
