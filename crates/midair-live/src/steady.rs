//! A tracker's trembling taken out, and its delay made up for.

use midair::geometry::Vec3;
use std::time::Duration;

/// The one-euro filter's settings (Casiez, Roussel and Vogel, CHI 2012): still hands are smoothed, quick ones followed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OneEuro {
    /// Cut-off frequency at rest, Hz.
    pub min_cutoff: f64,
    /// How much the cut-off rises with speed, Hz per mm/s.
    pub beta: f64,
    /// Cut-off frequency of the speed itself, Hz.
    pub derivative_cutoff: f64,
}

impl Default for OneEuro {
    /// For heads: half a millimetre of trembling is taken out, a step to the side is not held back.
    fn default() -> Self {
        Self { min_cutoff: 1.5, beta: 0.05, derivative_cutoff: 2.0 }
    }
}

/// A filter in use, with prediction.
#[derive(Clone, Debug, Default)]
pub(crate) struct Steady {
    settings: Option<OneEuro>,
    last: Option<(Duration, Vec3)>,
    velocity: Vec3,
}

impl Steady {
    /// With smoothing, or without.
    pub fn new(settings: Option<OneEuro>) -> Self {
        Self { settings, last: None, velocity: Vec3::ZERO }
    }

    /// The smoothed place of a measured one, `ahead` seconds later at the present speed. `time` is a clock's reading.
    pub fn follow(&mut self, time: Duration, measured: Vec3, ahead: f64) -> Vec3 {
        let Some((before, place)) = self.last else {
            self.last = Some((time, measured));
            return measured;
        };
        let step = time.saturating_sub(before).as_secs_f64();
        // A tracker that was away begins anew: what it did before says nothing.
        if step > 0.5 {
            self.last = Some((time, measured));
            self.velocity = Vec3::ZERO;
            return measured;
        }
        if step <= 0.0 {
            return place;
        }
        let settings = self.settings.unwrap_or_default();
        let speed = (measured - place) * (1.0 / step);
        self.velocity =
            self.velocity + (speed - self.velocity) * share(settings.derivative_cutoff, step);
        let place = match self.settings {
            None => measured,
            Some(settings) => {
                let speed = self.velocity.dot(self.velocity).sqrt();
                let cutoff = settings.min_cutoff + settings.beta * speed;
                place + (measured - place) * share(cutoff, step)
            }
        };
        self.last = Some((time, place));
        place + self.velocity * ahead
    }
}

/// The new value's share in a first-order low-pass (equation 5 there).
fn share(cutoff: f64, step: f64) -> f64 {
    let r = std::f64::consts::TAU * cutoff * step;
    r / (r + 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    fn run(settings: Option<OneEuro>, ahead: f64, place: impl Fn(f64) -> f64) -> Vec<f64> {
        let mut steady = Steady::new(settings);
        (0..300)
            .map(|i| {
                let t = f64::from(i) / 100.0;
                steady.follow(Duration::from_secs_f64(t), Vec3::new(place(t), 0.0, 0.0), ahead).x
            })
            .collect()
    }

    #[test]
    fn trembling_is_taken_out_and_what_stands_still_stays() {
        let noise = |t: f64| 0.5 * (t * 12345.678).sin();
        let out = run(Some(OneEuro::default()), 0.0, noise);
        let power = |values: &[f64]| values.iter().map(|v| v * v).sum::<f64>();
        let raw: Vec<f64> = (0..300).map(|i| noise(f64::from(i) / 100.0)).collect();
        assert!(
            power(&out[50..]) < 0.15 * power(&raw[50..]),
            "{} {}",
            power(&out[50..]),
            power(&raw[50..])
        );
        assert!(
            run(Some(OneEuro::default()), 0.1, |_| 7.0).iter().all(|&x| (x - 7.0).abs() < 1e-12)
        );
    }

    #[test]
    fn an_even_motion_is_predicted() {
        // 200 mm/s, without smoothing: after the speed has settled, 50 ms ahead is 10 mm further.
        let out = run(None, 0.05, |t| 200.0 * t);
        for (i, x) in out.iter().enumerate().skip(150) {
            assert!((x - (200.0 * i as f64 / 100.0 + 10.0)).abs() < 1e-3, "{i}: {x}");
        }
        // Smoothed, a quick motion lags by less than 10 ms.
        let out = run(Some(OneEuro::default()), 0.0, |t| 400.0 * t);
        assert!((out[250] - 1000.0).abs() < 4.0, "{}", out[250]);
    }

    #[test]
    fn after_a_pause_it_begins_anew() {
        let mut steady = Steady::new(Some(OneEuro::default()));
        steady.follow(Duration::ZERO, Vec3::ZERO, 0.0);
        let far = Vec3::new(100.0, 0.0, 0.0);
        assert_eq!(steady.follow(Duration::from_secs(2), far, 0.1), far);
    }
}
