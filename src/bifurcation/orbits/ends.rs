//! Where branches of orbits begin and end, so that none is followed from both ends, and what is told of one way backwards.

use super::chart::Chart;
use crate::bifurcation::general::{GeneralEvent, GeneralSystem, SAME};
use crate::error::Result;
use crate::field::Vector;
use crate::orbit::{ContinuationPoint, Digits, ranges};

/// An orbit at an end of the range, the same for its mirror images.
pub(super) struct End {
    coordinate: f64,
    log_period: f64,
    /// Of all variables the least values and the greatest ones.
    extremes: [Vector; 2],
}

impl End {
    /// The end that an orbit in these variables makes.
    ///
    /// # Errors
    /// Those of the flow along it.
    pub fn of(
        system: &GeneralSystem<'_>,
        chart: Chart<'_>,
        site: &ContinuationPoint,
    ) -> Result<Self> {
        let site = chart.in_whole(site);
        let ranges = ranges(
            &chart.whole_family().field(site.at),
            &site.shooting,
            Digits::Six,
        )?;
        let (least, greatest): (Vec<f64>, Vec<f64>) = ranges.into_iter().unzip();
        let representative = |numbers| system.representative(&Vector::from_vec(numbers));
        Ok(End {
            coordinate: site.at[0],
            log_period: site.shooting.period().ln(),
            extremes: [representative(least), representative(greatest)],
        })
    }

    /// Whether both are one orbit, or its mirror images.
    pub fn is(&self, other: &End) -> bool {
        /// Of extremes that are good to some six digits, as a part of how far each variable goes.
        const NEAR: f64 = 1e-5;
        let goes = &self.extremes[1] - &self.extremes[0];
        let near = |(a, b): (&Vector, &Vector)| {
            let off = a - b;
            let mut pairs = off.iter().zip(&goes);
            pairs.all(|(off, goes)| off.abs() <= NEAR * goes)
        };
        (self.coordinate - other.coordinate).abs() < SAME
            && (self.log_period - other.log_period).abs() < SAME
            && self.extremes.iter().zip(&other.extremes).all(near)
    }
}

/// What is told of one way along a branch, in the order of the other way: a special point comes before its row both ways.
pub(super) fn backwards(told: Vec<GeneralEvent>) -> Vec<GeneralEvent> {
    let mut backwards: Vec<GeneralEvent> = told.into_iter().rev().collect();
    for i in 1..backwards.len() {
        let pair = &backwards[i - 1..=i];
        if let [GeneralEvent::Row(row), GeneralEvent::Special(_)] = pair
            && row.label.is_some()
        {
            backwards.swap(i - 1, i);
        }
    }
    backwards
}
