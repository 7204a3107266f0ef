//! The multipliers of return maps of any dimension, from the periodic Schur form of the arcs' maps, with a budget for each.
//!
//! The budget is what the arcs' errors make of a logarithm: its spread over maps with random errors of that size. Where the
//! smallest multiplier drowns in them, the quadrature of the trace (Liouville) has it from the others.

use super::floquet::{Kind, Multiplier, TANGENT};
use super::noise::{PROBES, Signs, graded};
use super::periodic_schur::LogEigenvalue;
pub(crate) use super::periodic_schur::eigenvalues as eigenvalues_of;
use crate::field::Matrix;
use crate::number::Uncertain;
use nalgebra::Complex;
use std::f64::consts::{PI, TAU};

/// Angles below this, from 0 and from pi, are those of real numbers: rounding parts two equal ones by as much.
const REAL: f64 = 1e-9;
/// So many multipliers may be two pairs.
const TWO_PAIRS: usize = 4;
/// A logarithm with a larger error is not known.
const LOST: f64 = 0.5;

/// The eigenvalues of the maps' product, the largest first, where the maps' relative errors are given and the logarithm of the
/// product of all eigenvalues is known.
pub fn multipliers(maps: &[Matrix], errors: &[f64], volume: Uncertain) -> Vec<Multiplier> {
    let found = eigenvalues_of(maps);
    let spreads = found.as_ref().and_then(|all| spreads(maps, errors, all));
    let (Some(mut all), Some(spreads)) = (found, spreads) else {
        let count = maps.first().map_or(0, |map| map.nrows());
        let unknown = Multiplier {
            ln_abs: Uncertain::new(volume.value / count as f64, f64::INFINITY),
            angle_over_pi: 0.0,
            kind: Kind::BelowFloor,
        };
        return vec![unknown; count];
    };
    conjugated(&mut all);
    let pairs = all.iter().zip(&spreads);
    let mut multipliers: Vec<_> = pairs.map(|(one, spread)| spread.multiplier(one)).collect();
    by_volume(&mut multipliers, volume);
    multipliers
}

/// What the errors make of an eigenvalue.
#[derive(Debug, Clone, Copy, Default)]
struct Spread {
    ln_abs: f64,
    arg: f64,
    /// The largest that was seen.
    bound: f64,
}

impl Spread {
    fn multiplier(&self, one: &LogEigenvalue) -> Multiplier {
        let arg = one.arg.abs();
        if self.ln_abs.is_nan() || self.ln_abs >= LOST {
            return Multiplier {
                ln_abs: Uncertain::new(self.bound + TANGENT.ln(), 0.0),
                angle_over_pi: 0.0,
                kind: Kind::BelowFloor,
            };
        }
        let error = self.arg.max(REAL);
        let (kind, angle_over_pi) = if arg <= error {
            (Kind::Real, 0.0)
        } else if PI - arg <= error {
            (Kind::Real, 1.0)
        } else {
            (Kind::Complex, arg / PI)
        };
        Multiplier {
            ln_abs: Uncertain::new(one.ln_abs, self.ln_abs),
            angle_over_pi,
            kind,
        }
    }
}

/// Of every eigenvalue, over some maps with errors of random sign. `None` where one of these has no eigenvalues.
fn spreads(maps: &[Matrix], errors: &[f64], all: &[LogEigenvalue]) -> Option<Vec<Spread>> {
    let mut signs = Signs::new();
    let mut spreads: Vec<_> = all
        .iter()
        .map(|one| Spread {
            bound: one.ln_abs,
            ..Spread::default()
        })
        .collect();
    for _ in 0..PROBES {
        let noisy = maps.iter().zip(errors).map(|(map, error)| {
            let sizes = graded(map) * *error;
            map + sizes.map(|size| size * signs.next())
        });
        let noisy: Vec<_> = noisy.collect();
        let mut others = eigenvalues_of(&noisy)?;
        for (one, spread) in all.iter().zip(&mut spreads) {
            let off = |other: &LogEigenvalue| {
                let ln_abs = (other.ln_abs - one.ln_abs).abs();
                (ln_abs, (other.arg.abs() - one.arg.abs()).abs())
            };
            let distance = |other: &LogEigenvalue| off(other).0.hypot(off(other).1);
            let nearest = (0..others.len())
                .min_by(|&i, &j| distance(&others[i]).total_cmp(&distance(&others[j])))?;
            let other = others.swap_remove(nearest);
            let (ln_abs, arg) = off(&other);
            spread.ln_abs += ln_abs * ln_abs;
            spread.arg += arg * arg;
            spread.bound = spread.bound.max(other.ln_abs);
        }
    }
    let deviation = |squares: f64| TANGENT * (squares / PROBES as f64).sqrt();
    for (one, spread) in all.iter().zip(&mut spreads) {
        // The logarithms of the factors' diagonals are rounded too.
        spread.ln_abs = deviation(spread.ln_abs) + f64::EPSILON * (1.0 + one.ln_abs.abs());
        spread.arg = deviation(spread.arg);
    }
    Some(spreads)
}

/// Both of a conjugate pair with the same logarithm: rounding makes it two.
fn conjugated(all: &mut [LogEigenvalue]) {
    for i in 0..all.len() {
        let one = all[i];
        if one.arg <= 0.0 {
            continue;
        }
        let off =
            |other: &LogEigenvalue| (other.ln_abs - one.ln_abs).abs() + (other.arg + one.arg).abs();
        let below = (0..all.len()).filter(|&j| all[j].arg < 0.0);
        if let Some(j) = below.min_by(|&a, &b| off(&all[a]).total_cmp(&off(&all[b])))
            && off(&all[j]) < REAL
        {
            all[j] = LogEigenvalue {
                arg: -one.arg,
                ..one
            };
        }
    }
}

/// The smallest from the volume, where that knows it better.
fn by_volume(multipliers: &mut [Multiplier], volume: Uncertain) {
    let Some((last, others)) = multipliers.split_last_mut() else {
        return;
    };
    let known = |one: &Multiplier| one.kind != Kind::BelowFloor;
    if !others.iter().all(known) || last.kind == Kind::Complex {
        return;
    }
    let sums = others.iter().fold((0.0, 0.0), |sums, one| {
        let Uncertain { value, uncertainty } = one.ln_abs;
        (sums.0 + value, sums.1 + uncertainty)
    });
    let uncertainty = volume.uncertainty + sums.1;
    if known(last) && last.ln_abs.uncertainty <= uncertainty {
        return;
    }
    // The product of all is positive: the flow keeps its orientation.
    let negative = others.iter().filter(|one| one.angle_over_pi == 1.0).count() % 2 == 1;
    *last = Multiplier {
        ln_abs: Uncertain::new(volume.value - sums.0, uncertainty),
        angle_over_pi: if negative { 1.0 } else { 0.0 },
        kind: Kind::Real,
    };
}

/// Two eigenvalues, conjugate or both real.
#[derive(Debug, Clone, Copy)]
pub(crate) struct UnitPair {
    /// Their sum.
    pub sum: f64,
    /// |ln| of their product.
    pub off: f64,
}

/// The two whose product is nearest to 1: of a pair that is near the unit circle this one. Where the two are equal each is off by
/// the root of what their sum and product are.
pub(crate) fn unit_pair(all: &[LogEigenvalue]) -> Option<UnitPair> {
    let off = |a: &LogEigenvalue, b: &LogEigenvalue| {
        let arg = (a.arg + b.arg + PI).rem_euclid(TAU) - PI;
        (a.ln_abs + b.ln_abs).hypot(arg)
    };
    let pairs = all.iter().enumerate();
    let pairs = pairs.flat_map(|(i, a)| all[..i].iter().map(move |b| (a, b)));
    let of = |(a, b)| (off(a, b), a, b);
    let (off, a, b) = pairs.map(of).min_by(|a, b| a.0.total_cmp(&b.0))?;
    let real = |one: &LogEigenvalue| one.ln_abs.exp() * one.arg.cos();
    Some(UnitPair {
        sum: real(a) + real(b),
        off,
    })
}

/// Products over all multipliers that vanish at bifurcations, each factor over its largest size.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Products {
    /// Of 1 - mu: a multiplier is 1.
    pub fold: f64,
    /// Of 1 + mu: a multiplier is -1.
    pub doubling: f64,
    /// Of 1 - mu_i mu_j over all pairs: a conjugate pair on the unit circle, or two real numbers whose product is 1.
    pub torus: f64,
    /// The sum, no product, of the two whose product is nearest to 1: 2 cos of the angle of a pair on the unit circle.
    pub pair: f64,
    /// The two conjugate pairs that are nearest to the unit circle, the nearest first. Not numbers where there are no two.
    pub circle: [CirclePair; 2],
}

/// A conjugate pair of multipliers next to the unit circle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CirclePair {
    /// 2 cos of its angle.
    pub sum: f64,
    /// ln of its product.
    pub ln_product: f64,
    /// As [`Products::torus`], without this pair.
    pub others: f64,
}

impl CirclePair {
    const NONE: Self = CirclePair {
        sum: f64::NAN,
        ln_product: f64::NAN,
        others: f64::NAN,
    };

    /// The two pairs nearest to the circle, by all products of two multipliers and their places.
    fn nearest(
        all: &[LogEigenvalue],
        products: &[((usize, usize), LogEigenvalue)],
    ) -> [CirclePair; 2] {
        let mut found = [CirclePair::NONE; 2];
        let upper = all.iter().enumerate().filter(|(_, one)| one.arg > 0.0);
        let mut pairs: Vec<(usize, usize)> = upper
            .filter_map(|(i, one)| {
                let off =
                    |j: &usize| (all[*j].ln_abs - one.ln_abs).abs() + (all[*j].arg + one.arg).abs();
                let lower = (0..all.len()).filter(|&j| all[j].arg < 0.0);
                let j = lower.min_by(|a, b| off(a).total_cmp(&off(b)))?;
                Some((i.max(j), i.min(j)))
            })
            .collect();
        let ln_product = |&(i, j): &(usize, usize)| all[i].ln_abs + all[j].ln_abs;
        pairs.sort_by(|a, b| ln_product(a).abs().total_cmp(&ln_product(b).abs()));
        for (one, place) in found.iter_mut().zip(&pairs) {
            let others = products.iter().filter(|(other, _)| other != place);
            *one = CirclePair {
                sum: 2.0 * all[place.0].arg.cos(),
                ln_product: ln_product(place),
                others: product(others.map(|(_, product)| *product)),
            };
        }
        found
    }

    /// Of some pairs the place of the one whose sum is nearest to a value.
    pub(super) fn place_near(pairs: &[CirclePair; 2], sum: f64) -> usize {
        let off = |one: &CirclePair| (one.sum - sum).abs();
        usize::from(off(&pairs[1]) < off(&pairs[0]))
    }
}

impl Products {
    /// Of the maps' product; `None` where its eigenvalues are not found.
    pub(super) fn new(maps: &[Matrix]) -> Option<Self> {
        let all = eigenvalues_of(maps)?;
        let pairs = all.iter().enumerate().flat_map(|(i, a)| {
            all[..i].iter().enumerate().map(move |(j, b)| {
                let product = LogEigenvalue {
                    ln_abs: a.ln_abs + b.ln_abs,
                    arg: a.arg + b.arg,
                };
                ((i, j), product)
            })
        });
        let pairs: Vec<_> = pairs.collect();
        let circle = match all.len() < TWO_PAIRS {
            true => [CirclePair::NONE; 2],
            false => CirclePair::nearest(&all, &pairs),
        };
        let negative = all.iter().map(|one| LogEigenvalue {
            arg: one.arg + PI,
            ..*one
        });
        Some(Products {
            fold: product(all.iter().copied()),
            doubling: product(negative),
            torus: product(pairs.into_iter().map(|(_, product)| product)),
            pair: unit_pair(&all)?.sum,
            circle,
        })
    }

    /// Less others, of whose pairs each has its own.
    pub(super) fn less(&self, other: &Self) -> Self {
        Products {
            fold: self.fold - other.fold,
            doubling: self.doubling - other.doubling,
            torus: self.torus - other.torus,
            pair: self.pair - other.pair,
            circle: other.circle.map(|pair| {
                let own = self.circle[CirclePair::place_near(&self.circle, pair.sum)];
                CirclePair {
                    sum: own.sum - pair.sum,
                    ln_product: own.ln_product - pair.ln_product,
                    others: own.others - pair.others,
                }
            }),
        }
    }

    /// Times x.
    pub(super) fn scaled(&self, x: f64) -> Self {
        Products {
            fold: x * self.fold,
            doubling: x * self.doubling,
            torus: x * self.torus,
            pair: x * self.pair,
            circle: self.circle.map(|pair| CirclePair {
                sum: x * pair.sum,
                ln_product: x * pair.ln_product,
                others: x * pair.others,
            }),
        }
    }
}

/// The product of (1 - mu) / (1 + |mu|): real, as what is not comes in conjugate pairs.
fn product(all: impl Iterator<Item = LogEigenvalue>) -> f64 {
    // Without cancellation near mu = 1, for |mu| <= 1.
    let small = |ln_abs: f64, arg: f64| {
        let (size, half) = (ln_abs.exp(), (0.5 * arg).sin());
        let real = 2.0 * size * half * half - ln_abs.exp_m1();
        Complex::new(real, -size * arg.sin()) / (1.0 + size)
    };
    let factors = all.map(|LogEigenvalue { ln_abs, arg }| {
        if ln_abs > 0.0 {
            // 1 - mu = -mu (1 - 1 / mu), over |mu|
            -Complex::from_polar(1.0, arg) * small(-ln_abs, -arg)
        } else {
            small(ln_abs, arg)
        }
    });
    factors.product::<Complex<f64>>().re
}
