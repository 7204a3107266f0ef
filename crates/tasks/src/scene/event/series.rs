//! Events on the series of a step: stress maxima and minima, and the peaks between, are roots of polynomials.

use super::super::slip::Slips;
use super::{Detector, Log, Moment};
use twinslip::integrate::StepSeries;
use twinslip::number::DoubleDouble;
use twinslip::number::polynomial::{Crossing, Root, evaluate, roots};
use twinslip::series::REFERENCE_ORDER;

impl Detector {
    pub(super) fn see_series(&mut self, series: &dyn StepSeries, before: &[DoubleDouble]) {
        let mut excess = [0.0; REFERENCE_ORDER];
        let excess = &mut excess[..series.order()];
        for (i, &count) in self.rates.counts().iter().enumerate() {
            let rates = excess.iter_mut().zip(series.slip_rate(i));
            match count {
                1 => rates.for_each(|(c, rate)| *c += rate),
                count => rates.for_each(|(c, rate)| *c += count as f64 * rate),
            }
        }
        let (begin, unit) = (series.begin(), series.unit());
        let driving = self.driving_at(begin.hi());
        let rate = self.rate() * unit;
        excess[0] -= driving;
        excess[1] -= rate;
        let length = series.length() / unit;
        // Stress is a variable of the series itself.
        let stress = series.variable(0);
        let moment = |s: f64| {
            let time = s * unit;
            let each = before.iter().enumerate();
            let slips = each.map(|(i, slip)| *slip + series.slip(i, time));
            Moment::new(begin + time, evaluate(stress, s), &slips.collect::<Slips>())
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
