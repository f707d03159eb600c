//! Whether anybody is to see the show: its hours, and whether a tracker sees somebody.

use std::str::FromStr;
use std::time::Duration;

/// The hours of a day in which there is a show, in minutes from midnight: from one to the other, over midnight if the second comes first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Hours {
    from: u16,
    to: u16,
}

const DAY: u16 = 24 * 60;

impl Hours {
    /// Whether there is a show at this minute of the day.
    pub fn hold(&self, minute: u16) -> bool {
        if self.from <= self.to {
            (self.from..self.to).contains(&minute)
        } else {
            minute >= self.from || minute < self.to
        }
    }
}

impl FromStr for Hours {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = || "give two times of the day, such as 09:30-18:00".to_owned();
        let time = |text: &str| {
            let (hour, minute) = text.trim().split_once(':').ok_or_else(wrong)?;
            let number = |text: &str, least: usize| {
                let digits =
                    (least..=2).contains(&text.len()) && text.bytes().all(|b| b.is_ascii_digit());
                digits.then(|| text.parse::<u16>().ok()).flatten().ok_or_else(wrong)
            };
            let (hour, minute) = (number(hour, 1)?, number(minute, 2)?);
            let all = hour * 60 + minute;
            if minute < 60 && all <= DAY { Ok(all) } else { Err(wrong()) }
        };
        let (from, to) = text.split_once('-').ok_or_else(wrong)?;
        let (from, to) = (time(from)?, time(to)?);
        if from == to { Err(wrong()) } else { Ok(Self { from, to }) }
    }
}

/// Whether the display is dark for want of anybody to see it.
#[derive(Clone, Debug)]
pub(crate) struct Attendance {
    /// So long after the last reading of a viewer the display goes dark.
    blank_after: Option<Duration>,
    /// When there was a viewer last; at the beginning somebody is at the keyboard.
    seen: Duration,
    open: bool,
    dark: bool,
}

impl Attendance {
    pub fn new(blank_after: Option<Duration>) -> Self {
        Self { blank_after, seen: Duration::ZERO, open: true, dark: false }
    }

    /// Somebody is there, or the hours have begun or ended.
    pub fn somebody(&mut self, now: Duration) {
        self.seen = now;
    }

    pub fn open(&mut self, open: bool) {
        self.open = open;
    }

    pub fn is_dark(&self) -> bool {
        self.dark
    }

    /// Whether the display has just gone dark, or light again.
    pub fn tick(&mut self, now: Duration) -> bool {
        let dark = !self.open || self.leaves_at().is_some_and(|then| now >= then);
        std::mem::replace(&mut self.dark, dark) != dark
    }

    /// When the display would go dark, if nothing else happens.
    pub fn next(&self) -> Option<Duration> {
        self.leaves_at().filter(|_| !self.dark)
    }

    fn leaves_at(&self) -> Option<Duration> {
        self.blank_after.map(|after| self.seen + after)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hours_are_of_a_day_or_over_midnight() {
        let day: Hours = "09:30-18:00".parse().unwrap();
        assert!(
            !day.hold(9 * 60 + 29)
                && day.hold(9 * 60 + 30)
                && day.hold(17 * 60 + 59)
                && !day.hold(18 * 60)
        );
        let night: Hours = "20:00-2:15".parse().unwrap();
        assert!(
            night.hold(23 * 60)
                && night.hold(2 * 60 + 14)
                && !night.hold(2 * 60 + 15)
                && !night.hold(12 * 60)
        );
        assert!("0:00-24:00".parse::<Hours>().unwrap().hold(DAY - 1));
        for wrong in [
            "",
            "9-18",
            "09:00",
            "09:00-09:00",
            "25:00-26:00",
            "09:61-10:00",
            "9:1-10:00",
            "-1:00-2:00",
        ] {
            assert!(wrong.parse::<Hours>().is_err(), "{wrong}");
        }
    }

    #[test]
    fn nobody_leaves_the_display_dark_until_somebody_comes() {
        let s = Duration::from_secs;
        let mut attendance = Attendance::new(Some(s(30)));
        assert!(!attendance.tick(s(29)) && attendance.next() == Some(s(30)));
        assert!(attendance.tick(s(30)) && attendance.is_dark() && attendance.next().is_none());
        attendance.somebody(s(50));
        assert!(attendance.tick(s(50)) && !attendance.is_dark());
        attendance.open(false);
        assert!(attendance.tick(s(51)) && attendance.is_dark());
        attendance.somebody(s(52));
        assert!(!attendance.tick(s(52)) && attendance.is_dark());
    }
}
