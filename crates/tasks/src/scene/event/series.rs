//! Events on the series of a step: stress maxima and minima, and the peaks between, are roots of polynomials.

use super::super::slip::{Slips, sum};
use super::{Detector, Log, Moment};
use twinslip::number::polynomial::{Crossing, Root, evaluate, roots};
use twinslip::series::{Expansion, REFERENCE_ORDER};

impl Detector {
    pub(super) fn see_series<const N: usize>(&mut self, series: &Expansion<N>, before: &Slips) {
        let mut excess = [0.0; REFERENCE_ORDER];
        let excess = &mut excess[..series.order];
        for (j, c) in excess.iter_mut().enumerate() {
            *c = series.slip_rates[..self.interfaces]
                .iter()
                .map(|rates| rates[j])
                .sum();
        }
        let driving = self.driving_at(series.begin.hi());
        let rate = self.rate() * series.unit;
        excess[0] -= driving;
        excess[1] -= rate;
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
            turnings(excess, rate, length, &mut self.turnings);
            if rate != 0.0 {
                let by = (1.0 - self.threshold) * rate;
                turnings(excess, by, length, &mut self.turnings);
            }
        }
        let (threshold, found) = (self.threshold, &self.turnings);
        let raise = |log: &mut Log, from: f64, to: f64| {
            let inside = found.iter().map(|turning| turning.at);
            let inside = inside.filter(|s| (from..=to).contains(s));
            for s in inside.chain([from, to]) {
                let driving = driving + rate * s;
                log.raise(driving + evaluate(excess, s), threshold * driving);
            }
        };
        let mut from = 0.0;
        for extremum in extrema {
            let at = extremum.at;
            match extremum.crossing {
                Crossing::Upwards => {
                    self.log.open(Some(moment(at)));
                    from = at;
                }
                Crossing::Downwards if self.log.open.is_some() => {
                    raise(&mut self.log, from, at);
                    self.log.close(moment(at));
                }
                // Slip as fast as V_H and no faster, or an excursion that the run began in.
                Crossing::Touching | Crossing::Downwards => {}
            }
        }
        if self.log.open.is_some() {
            raise(&mut self.log, from, length);
        }
    }
}

/// Where a polynomial, with so much more in its slope, is largest or smallest.
fn turnings(coefficients: &[f64], more: f64, length: f64, found: &mut Vec<Root>) {
    let mut slope = [0.0; REFERENCE_ORDER];
    for (j, (slope, c)) in slope.iter_mut().zip(&coefficients[1..]).enumerate() {
        *slope = (j + 1) as f64 * c;
    }
    slope[0] += more;
    roots(&slope[..coefficients.len() - 1], length, found);
}
