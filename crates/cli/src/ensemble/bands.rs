//! Bands that hold a number with 95 %: by its derivatives in the fitted parameters, and, as a check, by draws of these.

use super::item::{Item, Measured, matched};
use nalgebra::{DMatrix, DVector};
use twinslip::number::quantile;

/// Of a standard normal number: so far from 0 it is with 5 %.
pub const DEVIATIONS: f64 = 1.959_963_984_540_054;
/// The part of draws below the lower end, and above the upper one.
const TAIL: f64 = 0.025;
/// Of fewer draws an end of 95 % is not known.
const FEWEST: usize = 40;
/// Both kinds of bands are apart where their ends differ by more than this part of half the band.
const APART: f64 = 0.2;
/// Bands that are narrower than this, relatively, are rounding.
const ROUNDING: f64 = 1e-8;

/// The things of a member as those of the estimate.
#[derive(Debug, Clone, PartialEq)]
pub struct Sample {
    /// The numbers of all things, scaled; NaN where the member does not have them.
    values: Vec<f64>,
    /// Which of the things it has.
    has: Vec<bool>,
    /// Of which of them what may hold does.
    holds: Vec<bool>,
    /// How many things the member has.
    pub things: usize,
}

impl Sample {
    /// Of the things of the estimate those that a member has.
    pub fn of(estimate: &[Item], member: &[Item]) -> Self {
        let found = matched(estimate, member);
        let pairs = || estimate.iter().zip(&found);
        let values = pairs().flat_map(|(item, found)| {
            let value = |i: usize| {
                let number = found.and_then(|found| member[found].numbers.get(i));
                number.map_or(f64::NAN, Measured::scaled)
            };
            (0..item.numbers.len()).map(value).collect::<Vec<f64>>()
        });
        Sample {
            values: values.collect(),
            things: member.len(),
            has: found.iter().map(Option::is_some).collect(),
            holds: pairs()
                .map(|(_, found)| found.is_some_and(|found| member[found].holds))
                .collect(),
        }
    }
}

/// The members on both sides of the estimate, in each parameter.
#[derive(Debug, Clone)]
pub struct Sides {
    /// Below and above; `None` of a member that failed.
    pub samples: [Option<Sample>; 2],
    /// How far on either side, in standard errors of the parameter.
    pub step: f64,
}

/// The ends of a band in the user's units.
pub type Ends = [f64; 2];

/// What is known of a number.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Band {
    /// By derivatives.
    pub linear: Option<Ends>,
    /// By draws.
    pub draws: Option<Ends>,
}

/// What is known of a thing.
#[derive(Debug, Clone, PartialEq)]
pub struct Banded {
    /// Of each of its numbers.
    pub bands: Vec<Band>,
    /// The part of draws that have it; `None` without draws.
    pub probability: Option<f64>,
    /// The part of draws that have it, and in which what may hold does.
    pub holds: Option<f64>,
}

/// How far both kinds of bands are apart.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Check {
    /// The largest difference of two ends, in units of half the band by derivatives.
    pub largest: f64,
    /// The number of which it is: the thing, and the place among its numbers.
    pub at: Option<(usize, usize)>,
    /// How many numbers have bands that differ by more than a fifth, and by more than chance makes them.
    pub apart: usize,
    /// How many numbers have both kinds of bands.
    pub numbers: usize,
    /// What the draws of it differ by chance: three standard errors of such an end.
    pub by_chance: f64,
}

/// The bands of all things of the estimate.
pub fn bands(
    estimate: &[Item],
    (sides, correlation): (&[Sides], &DMatrix<f64>),
    draws: &[Sample],
) -> (Vec<Banded>, Check) {
    let (mut all, mut check) = (Vec::with_capacity(estimate.len()), Check::default());
    let mut place = 0;
    let mut of_draws = Vec::with_capacity(draws.len());
    for (number, item) in estimate.iter().enumerate() {
        let mut own = Vec::with_capacity(item.numbers.len());
        for (i, measured) in item.numbers.iter().enumerate() {
            let deviation = deviation(place, sides, correlation);
            let middle = measured.scaled();
            let linear = deviation
                .map(|deviation| DEVIATIONS * deviation)
                .filter(|half| (middle + half).is_finite());
            of_draws.clear();
            of_draws.extend(draws.iter().map(|draw| draw.values[place]));
            of_draws.retain(|x| x.is_finite());
            let quantiles = quantiles(&mut of_draws);
            if let (Some(half), Some(ends)) = (linear, quantiles)
                && half > ROUNDING * (1.0 + middle.abs())
            {
                let apart = [middle - half, middle + half].into_iter().zip(ends);
                let apart = apart.map(|(one, other)| (one - other).abs() / half);
                let apart = apart.fold(0.0, f64::max);
                let chance = by_chance(of_draws.len());
                check.numbers += 1;
                check.apart += usize::from(apart > chance.max(APART));
                if apart > check.largest {
                    check = Check {
                        largest: apart,
                        at: Some((number, i)),
                        by_chance: chance,
                        ..check
                    };
                }
            }
            let out = |ends: Ends| ends.map(|x| measured.unscaled(x));
            // Through a logarithm and back rounding may leave the value itself outside.
            let around = |[low, high]: Ends| [low.min(measured.value), high.max(measured.value)];
            own.push(Band {
                linear: linear.map(|half| around(out([middle - half, middle + half]))),
                draws: quantiles.map(out),
            });
            place += 1;
        }
        let part = |of: &dyn Fn(&Sample) -> bool| {
            let count = draws.iter().filter(|draw| of(draw)).count();
            (!draws.is_empty()).then(|| count as f64 / draws.len() as f64)
        };
        all.push(Banded {
            bands: own,
            probability: part(&|draw| draw.has[number]),
            holds: part(&|draw| draw.holds[number]),
        });
    }
    (all, check)
}

/// The standard error of a number, by its derivatives in the parameters in units of their own.
fn deviation(place: usize, sides: &[Sides], correlation: &DMatrix<f64>) -> Option<f64> {
    let slope = |sides: &Sides| {
        if sides.step == 0.0 {
            return Some(0.0);
        }
        let [below, above] = sides.samples.each_ref().map(|sample| {
            let value = sample.as_ref()?.values.get(place).copied();
            value.filter(|x| x.is_finite())
        });
        Some((above? - below?) / (2.0 * sides.step))
    };
    let gradient: Option<Vec<f64>> = sides.iter().map(slope).collect();
    let gradient = DVector::from_vec(gradient?);
    let variance = gradient.dot(&(correlation * &gradient));
    Some(variance.max(0.0).sqrt())
}

/// The ends between which 95 % of numbers are.
fn quantiles(numbers: &mut [f64]) -> Option<Ends> {
    if numbers.len() < FEWEST {
        return None;
    }
    numbers.sort_by(f64::total_cmp);
    Some([TAIL, 1.0 - TAIL].map(|part| quantile(numbers, part)))
}

/// Three standard errors of an end of the middle 95 % of so many normal numbers, in units of half of these.
fn by_chance(draws: usize) -> f64 {
    let density = (-0.5 * DEVIATIONS * DEVIATIONS).exp() / std::f64::consts::TAU.sqrt();
    let error = (TAIL * (1.0 - TAIL) / draws as f64).sqrt() / density;
    3.0 * error / DEVIATIONS
}
