//! Events on the series of a step: stress maxima and minima, and the peaks between, are roots of polynomials.

use super::super::slip::{Slips, sum};
use super::{Detector, Moment};
use crate::number::polynomial::{Crossing, Root, evaluate, roots};
use crate::series::{Expansion, REFERENCE_ORDER};

impl<const N: usize> Detector<'_, N> {
    pub(super) fn see_series(&mut self, series: &Expansion<N>, before: &Slips) {
        let mut excess = [0.0; REFERENCE_ORDER];
        let excess = &mut excess[..series.order];
        for (j, c) in excess.iter_mut().enumerate() {
            *c = series.slip_rates[..self.interfaces]
                .iter()
                .map(|rates| rates[j])
                .sum();
        }
        excess[0] -= self.loading.driving;
        let length = series.length / series.unit;
        let moment = |s: f64| {
            let time = s * series.unit;
            Moment {
                time: series.begin + time,
                stress: series.state(time)[0],
                slips: sum(before, series.slips(time)),
            }
        };

        let extrema = self.zeros.follow(excess, length);
        self.turnings.clear();
        if self.log.open.is_some() || !extrema.is_empty() {
            turnings(excess, length, &mut self.turnings);
        }
        let peak = |from: f64, to: f64| {
            let inside = self.turnings.iter().map(|turning| turning.at);
            let largest = inside
                .filter(|s| (from..=to).contains(s))
                .chain([from, to])
                .map(|s| evaluate(excess, s))
                .fold(0.0, f64::max);
            self.loading.driving + largest
        };
        let mut from = 0.0;
        for extremum in extrema {
            let at = extremum.at;
            match extremum.crossing {
                Crossing::Upwards => {
                    self.log.open(moment(at));
                    from = at;
                }
                Crossing::Downwards if self.log.open.is_some() => {
                    self.log.raise(peak(from, at));
                    self.log.close(moment(at));
                }
                // Slip as fast as V_H and no faster, or an excursion that the run began in.
                Crossing::Touching | Crossing::Downwards => {}
            }
        }
        if self.log.open.is_some() {
            self.log.raise(peak(from, length));
        }
    }
}

/// Where a polynomial is largest or smallest.
fn turnings(coefficients: &[f64], length: f64, found: &mut Vec<Root>) {
    let mut slope = [0.0; REFERENCE_ORDER];
    for (j, (slope, c)) in slope.iter_mut().zip(&coefficients[1..]).enumerate() {
        *slope = (j + 1) as f64 * c;
    }
    roots(&slope[..coefficients.len() - 1], length, found);
}
