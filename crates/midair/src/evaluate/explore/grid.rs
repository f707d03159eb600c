//! All combinations of values, looked at coarsely first, then between neighbours that differ.

use super::axis::{number, places};
use super::{Axis, Measured, NAMES, Point, SHARES};
use crate::Monitor;

/// The combinations and what is known of them.
pub(super) struct Grid<'a> {
    axes: &'a [Axis],
    points: Vec<Option<Point>>,
    /// The level that is known or being looked at: along each axis, every so many values count.
    strides: Vec<usize>,
}

impl<'a> Grid<'a> {
    pub fn new(axes: &'a [Axis]) -> Self {
        let count = axes.iter().map(|axis| axis.values.len()).product();
        // A power of two that leaves at least five values, where there are five: fewer overlook what lies between.
        let stride = |axis: &Axis| {
            let most = (axis.values.len().saturating_sub(1) / 4).max(1);
            1 << most.ilog2()
        };
        Self { axes, points: vec![None; count], strides: axes.iter().map(stride).collect() }
    }

    pub fn len(&self) -> usize {
        self.points.len()
    }

    pub fn values(&self, number: usize) -> Vec<f64> {
        places(self.axes, number)
            .iter()
            .zip(self.axes)
            .map(|(&place, axis)| axis.values[place])
            .collect()
    }

    /// Whether a combination belongs to the level.
    fn is_on(&self, places: &[usize]) -> bool {
        places.iter().zip(self.axes).zip(&self.strides).all(|((place, axis), stride)| {
            place.is_multiple_of(*stride) || *place == axis.values.len() - 1
        })
    }

    /// The combinations of the first, coarsest level.
    pub fn begin(&self) -> Vec<usize> {
        (0..self.len()).filter(|&number| self.is_on(&places(self.axes, number))).collect()
    }

    pub fn put(&mut self, found: Vec<(usize, Point)>) {
        for (number, point) in found {
            self.points[number] = Some(point);
        }
    }

    /// Goes on to the next level: those of its combinations that are to be looked at; the others are interpolated. `None` after the last level.
    pub fn finer(&mut self, settle: f64, monitor: &dyn Monitor) -> Option<Vec<usize>> {
        if self.strides.iter().all(|&stride| stride == 1) {
            return None;
        }
        let coarse = self.strides.clone();
        self.strides.iter_mut().for_each(|stride| *stride = (*stride / 2).max(1));
        let mut todo = Vec::new();
        let mut between = Vec::new();
        for number in 0..self.len() {
            let places = places(self.axes, number);
            if self.points[number].is_some() || !self.is_on(&places) {
                continue;
            }
            match self.interpolated(&places, &coarse, settle) {
                Some(measured) => between.push((number, measured)),
                None => todo.push(number),
            }
        }
        monitor.advance(between.len());
        for (number, measured) in between {
            let values = self.values(number);
            self.points[number] = Some(Point { values, outcome: Ok(measured), interpolated: true });
        }
        Some(todo)
    }

    /// What is to be expected of a combination within a cell of the level before; `None` where the cell's corners differ by more than `settle`.
    fn interpolated(&self, places: &[usize], coarse: &[usize], settle: f64) -> Option<Measured> {
        let mut corners = vec![(Vec::new(), 1.0)];
        for ((&place, axis), &stride) in places.iter().zip(self.axes).zip(coarse) {
            let low = place / stride * stride;
            let high = (low + stride).min(axis.values.len() - 1);
            let share = if low == high { 0.0 } else { (place - low) as f64 / (high - low) as f64 };
            corners = corners
                .into_iter()
                .flat_map(|(known, weight): (Vec<usize>, f64)| {
                    let with = |place: usize, share: f64| {
                        let mut places = known.clone();
                        places.push(place);
                        (places, weight * share)
                    };
                    let mut ends = vec![with(low, 1.0 - share)];
                    if share > 0.0 {
                        ends.push(with(high, share));
                    }
                    ends
                })
                .collect();
        }
        let mut sum = [0.0; NAMES.len()];
        let mut range = [[f64::INFINITY, f64::NEG_INFINITY]; SHARES];
        for (places, weight) in corners {
            let numbers =
                self.points[number(self.axes, &places)].as_ref()?.outcome.as_ref().ok()?.numbers();
            for (sum, number) in sum.iter_mut().zip(numbers) {
                *sum += weight * number;
            }
            for (range, number) in range.iter_mut().zip(numbers) {
                *range = [range[0].min(number), range[1].max(number)];
            }
        }
        let settled = range.iter().all(|[least, largest]| largest - least < settle);
        settled.then(|| Measured::of_numbers(sum))
    }

    /// All points: after the last level each is known.
    pub fn into_points(self) -> Vec<Point> {
        self.points.into_iter().flatten().collect()
    }
}
