//! How long a new viewpoint takes from its packet to the screen, measured from end to end.

use crate::clock::Clock;
use std::net::{Ipv4Addr, UdpSocket};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

/// A trial with a synthetic tracker.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Trial {
    /// Packets to send.
    pub packets: usize,
    /// Packets a second.
    pub rate: f64,
}

/// What came of it; milliseconds from the sending of a packet to the end of the presentation of the frame that obeys it.
#[derive(Clone, Debug, PartialEq)]
pub struct Latency {
    /// Packets sent.
    pub sent: usize,
    /// Viewpoints that were shown; the others were overtaken by newer ones.
    pub shown: usize,
    /// Half of them took less.
    pub median: f64,
    /// All but one in a hundred took less.
    pub percentile_99: f64,
    /// The longest.
    pub max: f64,
    /// Medians of what this is made of, each by itself.
    pub stages: Stages,
}

/// Where the time went between a packet and its frame, ms.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stages {
    /// From the packet's sending to the end of the frame's presentation: all of it, with what the stages wait for one another.
    pub whole: f64,
    /// Map and weights.
    pub solve: f64,
    /// Warping the frame into the window's memory.
    pub draw: f64,
    /// Handing it to the window system.
    pub present: f64,
}

/// When each packet left.
#[derive(Clone, Debug, Default)]
pub struct Departures(Arc<Mutex<Vec<Duration>>>);

impl Departures {
    /// When a packet left.
    pub fn of(&self, packet: u64) -> Option<Duration> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).get(packet as usize).copied()
    }
}

/// From the first picture to the first packet: until then memory is touched for the first time and the window system gets ready, which
/// no viewer sees who comes to a running show.
const SETTLING: Duration = Duration::from_millis(500);

/// Sends the packets of a head that sways, half a second from now: real UDP packets in opentrack's form, their number in the place of
/// the yaw. `done` is called a second after the last.
///
/// # Errors
/// What the system says where packets cannot be sent.
pub fn send(
    trial: Trial,
    port: u16,
    around: [f64; 3],
    clock: Clock,
    done: impl FnOnce() + Send + 'static,
) -> std::io::Result<Departures> {
    let socket = UdpSocket::bind((Ipv4Addr::LOCALHOST, 0))?;
    let departures = Departures::default();
    let log = departures.clone();
    std::thread::spawn(move || {
        std::thread::sleep(SETTLING);
        let start = clock.now();
        for number in 0..trial.packets {
            let due = Duration::from_secs_f64(number as f64 / trial.rate);
            std::thread::sleep((start + due).saturating_sub(clock.now()));
            let t = number as f64 / trial.rate;
            let sway = [40.0 * (2.1 * t).sin(), 15.0 * (1.3 * t).sin(), 20.0 * (0.7 * t).sin()];
            let place: [f64; 3] = std::array::from_fn(|i| (around[i] + sway[i]) / 10.0);
            let numbers = [place[0], place[1], place[2], number as f64, 0.0, 0.0];
            let packet: Vec<u8> = numbers.iter().flat_map(|n| n.to_le_bytes()).collect();
            log.0.lock().unwrap_or_else(PoisonError::into_inner).push(clock.now());
            // A packet that is lost is counted as never shown.
            let _ = socket.send_to(&packet, (Ipv4Addr::LOCALHOST, port));
        }
        std::thread::sleep(Duration::from_secs(1));
        done();
    });
    Ok(departures)
}

/// The figures of a trial; `None` if nothing was shown.
pub fn latency(sent: usize, shown: &[Stages]) -> Option<Latency> {
    let at = |stage: fn(&Stages) -> f64, share: f64| {
        let mut sorted: Vec<f64> = shown.iter().map(stage).collect();
        sorted.sort_by(f64::total_cmp);
        let rank = (share * sorted.len() as f64).ceil() as usize;
        sorted.get(rank.saturating_sub(1)).copied()
    };
    Some(Latency {
        sent,
        shown: shown.len(),
        median: at(|s| s.whole, 0.5)?,
        percentile_99: at(|s| s.whole, 0.99)?,
        max: at(|s| s.whole, 1.0)?,
        stages: Stages {
            whole: at(|s| s.whole, 0.5)?,
            solve: at(|s| s.solve, 0.5)?,
            draw: at(|s| s.draw, 0.5)?,
            present: at(|s| s.present, 0.5)?,
        },
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn percentiles_are_by_the_nearest_rank() {
        let stages = |whole: f64| Stages { whole, solve: whole % 3.0, draw: 7.0, present: -whole };
        let shown: Vec<Stages> = (1..=200).rev().map(f64::from).map(stages).collect();
        let told = latency(210, &shown).unwrap();
        assert_eq!((told.median, told.percentile_99, told.max), (100.0, 198.0, 200.0));
        // Each by itself: the ones of rest 0 are the smallest third.
        assert_eq!(told.stages, Stages { whole: 100.0, solve: 1.0, draw: 7.0, present: -101.0 });
        assert_eq!((told.sent, told.shown), (210, 200));
        assert!(latency(3, &[]).is_none());
    }
}
