//! The equations of all interfaces in (ln psi of each, tau, slips) for methods that ask for rates and a Jacobian matrix.
//!
//! The interfaces see each other through tau alone, so that the matrix has an arrow's shape: the diagonal, and the row and the column of
//! tau. Linear systems with it are solved in linear time, without fill.

use super::block::Extent;
use super::constants::{LANES, of};
use super::interfaces::ManyInterfaces;
use super::local::{Local, Stress};
use super::share::CHUNK;
use super::step::{Beginning, Saved};
use crate::error::{Error, Result};
use rayon::prelude::*;

/// Numbers of a chunk.
const HELD: usize = CHUNK * LANES;

/// Which slips belong to the state.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Slips {
    /// That of all together.
    pub of_all: bool,
    /// Those of these interfaces, counted from 0 among all.
    pub of: Vec<usize>,
}

/// dy/dt = f(y) for y = (ln psi of those held here, what fills the last block, tau, the slip of all, the slips asked for).
#[derive(Debug)]
pub(crate) struct ManyField<'a> {
    pub interfaces: &'a ManyInterfaces,
    /// Whether there is the slip of all.
    of_all: bool,
    /// The places of those whose slips are asked for, as far as they are held here.
    slips: Vec<usize>,
}

impl<'a> ManyField<'a> {
    pub fn new(interfaces: &'a ManyInterfaces, slips: &Slips) -> Self {
        let held = interfaces.share.held();
        let here = slips.of.iter().filter(|one| held.contains(one));
        ManyField {
            of_all: slips.of_all,
            slips: here.map(|one| one - held.start).collect(),
            interfaces,
        }
    }

    /// ln psi are the first ones.
    pub fn logs(&self) -> usize {
        self.interfaces.blocks() * LANES
    }

    /// The place of tau.
    pub fn stress(&self) -> usize {
        self.logs()
    }

    /// The place of the slip of all.
    pub fn slip_of_all(&self) -> usize {
        self.logs() + 1
    }

    /// The place of the slip of an interface.
    pub fn slip(&self, interface: usize) -> Option<usize> {
        let here = interface - self.interfaces.share.held().start;
        let at = self.slips.iter().position(|one| *one == here)?;
        Some(self.first_slip() + at)
    }

    fn first_slip(&self) -> usize {
        self.logs() + 1 + usize::from(self.of_all)
    }

    /// How many numbers there are.
    pub fn len(&self) -> usize {
        self.first_slip() + self.slips.len()
    }

    /// (tau, psi) as y.
    pub fn start(&self, stress: f64, states: &[f64]) -> Vec<f64> {
        let mut y = vec![0.0; self.len()];
        for (w, psi) in y.iter_mut().zip(states) {
            *w = psi.ln();
        }
        y[self.stress()] = stress;
        y
    }

    /// The time, the steps and y at a beginning.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a stress or states that are not positive, or too few of these.
    pub fn begun(&self, beginning: Beginning<'_>) -> Result<(f64, usize, Vec<f64>)> {
        match beginning {
            Beginning::Start(stress, states) => {
                self.interfaces.checked(stress, states)?;
                Ok((0.0, 0, self.start(stress, states)))
            }
            Beginning::Saved(saved) => {
                let mut y = vec![0.0; self.len()];
                y[..saved.held.len()].copy_from_slice(&saved.held);
                let &[stress, slip] = &saved.shared[..] else {
                    return Err(Error::Input("what was saved is of another method".into()));
                };
                y[self.stress()] = stress;
                if self.of_all {
                    y[self.slip_of_all()] = slip;
                }
                Ok((saved.time[0], saved.steps, y))
            }
        }
    }

    /// What a run at a time needs to go on. Slips of single interfaces are counted from there.
    pub fn saved(&self, time: f64, steps: usize, y: &[f64]) -> Saved {
        let slip = if self.of_all {
            y[self.slip_of_all()]
        } else {
            0.0
        };
        Saved {
            time: [time, 0.0],
            steps,
            shared: vec![y[self.stress()], slip],
            held: y[..self.interfaces.share.held().len()].to_vec(),
        }
    }

    /// Lets the slips of single interfaces begin at 0.
    pub fn forget_slips(&self, y: &mut [f64]) {
        y[self.first_slip()..].fill(0.0);
    }

    /// dy/dt.
    pub fn rates(&self, y: &[f64], rates: &mut [f64]) {
        let kind = self.interfaces.kind;
        let stress = Stress::new(kind, y[self.stress()]);
        let (logs, rest) = rates.split_at_mut(self.logs());
        let work = |(chunk, (w, rates)): (usize, (&[f64], &mut [f64]))| {
            let mut sum = [0.0; LANES];
            let blocks = w.as_chunks::<LANES>().0.iter();
            let made = rates.as_chunks_mut::<LANES>().0.iter_mut();
            for (i, (w, made)) in blocks.zip(made).enumerate() {
                let of = of(&self.interfaces.constants, chunk * CHUNK + i);
                for l in 0..LANES {
                    let [v, evolution] = of.rates(kind, l, (stress, w[l]));
                    made[l] = evolution;
                    sum[l] += v;
                }
            }
            sum.iter().sum::<f64>()
        };
        let share = &self.interfaces.share;
        let w = &y[..self.logs()];
        let sums: Vec<f64> = if share.is_large() {
            let both = w.par_chunks(HELD).zip(logs.par_chunks_mut(HELD));
            both.enumerate().map(work).collect()
        } else {
            let both = w.chunks(HELD).zip(logs.chunks_mut(HELD));
            both.enumerate().map(work).collect()
        };
        let total = share.sum(&sums);
        let loading = self.interfaces.loading;
        rest[0] = loading.stiffness * (loading.driving - total);
        if self.of_all {
            rest[1] = total;
        }
        let slips = &mut rest[1 + usize::from(self.of_all)..];
        for (slip, &here) in slips.iter_mut().zip(&self.slips) {
            let of = of(&self.interfaces.constants, here / LANES);
            [*slip, _] = of.rates(kind, here % LANES, (stress, y[here]));
        }
    }

    /// J at y.
    pub fn linearise(&self, y: &[f64], arrow: &mut Arrow) {
        let kind = self.interfaces.kind;
        let stress = Stress::new(kind, y[self.stress()]);
        let here = |i: usize, w: f64| {
            let of = of(&self.interfaces.constants, i / LANES);
            of.linearised(kind, i % LANES, (stress, w))
        };
        let work = |(chunk, (w, each)): (usize, (&[f64], &mut [Shaft]))| {
            let mut sum = 0.0;
            for (i, (w, shaft)) in w.iter().zip(each).enumerate() {
                let local = here(chunk * HELD + i, *w);
                *shaft = Shaft::from(local);
                sum += local.rate_by_stress;
            }
            sum
        };
        let share = &self.interfaces.share;
        let w = &y[..self.logs()];
        arrow.shafts.resize(self.logs(), Shaft::default());
        let sums: Vec<f64> = if share.is_large() {
            let both = w.par_chunks(HELD).zip(arrow.shafts.par_chunks_mut(HELD));
            both.enumerate().map(work).collect()
        } else {
            let both = w.chunks(HELD).zip(arrow.shafts.chunks_mut(HELD));
            both.enumerate().map(work).collect()
        };
        arrow.by_stress = share.sum(&sums);
        let own = self.slips.iter().map(|&i| here(i, y[i]).rate_by_stress);
        arrow.slips.clear();
        arrow.slips.extend(own);
    }

    /// Makes M = d I - J of the linearised J ready for [`ManyField::solve`]; false where a pivot is none.
    pub fn factorise(&self, diagonal: f64, arrow: &mut Arrow) -> bool {
        /// A pivot that is smaller than this part of the diagonal has lost too many digits.
        const LEAST: f64 = 1e-8;
        let Arrow { shafts, pivots, .. } = arrow;
        pivots.resize(shafts.len(), 0.0);
        // What stands beside the last interface is none, and rests.
        let held = self.interfaces.share.held().len();
        let (shafts, pivots) = (&shafts[..held], &mut pivots[..held]);
        let work = |(shafts, pivots): (&[Shaft], &mut [f64])| {
            let (mut sum, mut least) = (0.0, f64::INFINITY);
            for (shaft, pivot) in shafts.iter().zip(pivots) {
                let own = diagonal - shaft.evolution_by_log;
                least = if own.is_nan() {
                    0.0
                } else {
                    least.min(own.abs())
                };
                *pivot = 1.0 / own;
                sum += shaft.rate_by_log * shaft.evolution_by_stress * *pivot;
            }
            (sum, least)
        };
        let share = &self.interfaces.share;
        let parts: Vec<(f64, f64)> = if share.is_large() {
            let both = shafts.par_chunks(HELD).zip(pivots.par_chunks_mut(HELD));
            both.map(work).collect()
        } else {
            let both = shafts.chunks(HELD).zip(pivots.chunks_mut(HELD));
            both.map(work).collect()
        };
        let sums: Vec<f64> = parts.iter().map(|part| part.0).collect();
        arrow.by_stress_inside = share.sum(&sums);
        let least = parts
            .iter()
            .fold(f64::INFINITY, |least, part| least.min(part.1));
        let [least] = share.largest([1.0 / least]).map(|largest| 1.0 / largest);
        arrow.diagonal = diagonal;
        let stiffness = self.interfaces.loading.stiffness;
        arrow.tip = diagonal + stiffness * (arrow.by_stress + arrow.by_stress_inside);
        least > LEAST * diagonal.abs() && arrow.tip.is_finite() && arrow.tip != 0.0
    }

    /// x with M x = b, in place.
    pub fn solve(&self, arrow: &Arrow, b: &mut [f64]) {
        let (logs, rest) = b.split_at_mut(self.logs());
        let share = &self.interfaces.share;
        let look = |at: usize| {
            let end = logs.len().min((at + 1) * HELD);
            let range = at * HELD..end;
            let each = arrow.shafts[range.clone()]
                .iter()
                .zip(&arrow.pivots[range.clone()]);
            let each = each.zip(&logs[range]);
            each.map(|((shaft, pivot), b)| shaft.rate_by_log * b * pivot)
                .sum::<f64>()
        };
        let inside = share.sum(&share.by_chunks(look));
        let stiffness = self.interfaces.loading.stiffness;
        let tau = (rest[0] - stiffness * inside) / arrow.tip;
        rest[0] = tau;
        if self.of_all {
            let rate = inside + tau * (arrow.by_stress + arrow.by_stress_inside);
            rest[1] = (rest[1] + rate) / arrow.diagonal;
        }
        let work = |(chunk, x): (usize, &mut [f64])| {
            let at = chunk * HELD;
            let each = arrow.shafts[at..].iter().zip(&arrow.pivots[at..]);
            for (x, (shaft, pivot)) in x.iter_mut().zip(each) {
                *x = (*x + shaft.evolution_by_stress * tau) * pivot;
            }
        };
        if share.is_large() {
            logs.par_chunks_mut(HELD).enumerate().for_each(work);
        } else {
            logs.chunks_mut(HELD).enumerate().for_each(work);
        }
        let slips = &mut rest[1 + usize::from(self.of_all)..];
        for ((slip, &here), by_stress) in slips.iter_mut().zip(&self.slips).zip(&arrow.slips) {
            let rate = by_stress * tau + arrow.shafts[here].rate_by_log * logs[here];
            *slip = (*slip + rate) / arrow.diagonal;
        }
    }

    /// The largest element of J in any process.
    pub fn largest(&self, arrow: &Arrow) -> f64 {
        let stiffness = self.interfaces.loading.stiffness;
        let each = arrow.shafts.iter().map(|shaft| {
            let row = (stiffness * shaft.rate_by_log).abs();
            row.max(shaft.evolution_by_stress.abs())
                .max(shaft.evolution_by_log.abs())
        });
        let own = each.fold((stiffness * arrow.by_stress).abs(), f64::max);
        let [largest] = self.interfaces.share.largest([own]);
        largest
    }

    /// What all interfaces do in a state.
    pub fn extent(&self, y: &[f64], faster_than: f64) -> Extent {
        let kind = self.interfaces.kind;
        let stress = Stress::new(kind, y[self.stress()]);
        let held = self.interfaces.share.held().len();
        let look = |chunk: usize| {
            let mut extent = Extent::NONE;
            let first = chunk * HELD;
            let logs = &y[first..held.min(first + HELD)];
            for (i, &w) in (first..).zip(logs) {
                let of = of(&self.interfaces.constants, i / LANES);
                let [v, _] = of.rates(kind, i % LANES, (stress, w));
                extent = extent.and(Extent::of_one(w.exp(), v, faster_than));
            }
            extent
        };
        let share = &self.interfaces.share;
        share.extent(&share.by_chunks(look))
    }

    /// psi and v of an interface that is held here.
    pub fn interface(&self, y: &[f64], interface: usize) -> [f64; 2] {
        let here = interface - self.interfaces.share.held().start;
        let of = of(&self.interfaces.constants, here / LANES);
        let kind = self.interfaces.kind;
        let stress = Stress::new(kind, y[self.stress()]);
        let [v, _] = of.rates(kind, here % LANES, (stress, y[here]));
        [y[here].exp(), v]
    }
}

/// What one interface adds to J.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
struct Shaft {
    /// dv/dw, of which the row of tau is made
    rate_by_log: f64,
    /// The column of tau.
    evolution_by_stress: f64,
    /// The diagonal.
    evolution_by_log: f64,
}

impl From<Local> for Shaft {
    fn from(local: Local) -> Self {
        Shaft {
            rate_by_log: local.rate_by_log,
            evolution_by_stress: local.evolution_by_stress,
            evolution_by_log: local.evolution_by_log,
        }
    }
}

/// J, and the factors of d I - J: the interfaces are eliminated one by one, and tau last.
#[derive(Debug, Clone, Default)]
pub(crate) struct Arrow {
    shafts: Vec<Shaft>,
    /// The sum of dv/dtau.
    by_stress: f64,
    /// dv/dtau of those whose slips are asked for.
    slips: Vec<f64>,
    diagonal: f64,
    /// 1/(d - d(dw/dt)/dw)
    pivots: Vec<f64>,
    /// How the sum of slip rates follows tau through the states.
    by_stress_inside: f64,
    /// The last pivot.
    tip: f64,
}

/// x with (d I - J) x = b for J at (tau, psi of each), both as (of each, of tau): for tests.
#[doc(hidden)]
pub fn arrow_solution(
    interfaces: &ManyInterfaces,
    (stress, states): (f64, &[f64]),
    diagonal: f64,
    b: &[f64],
) -> Option<Vec<f64>> {
    let field = ManyField::new(interfaces, &Slips::default());
    let y = field.start(stress, states);
    let mut arrow = Arrow::default();
    field.linearise(&y, &mut arrow);
    let ready = field.factorise(diagonal, &mut arrow);
    let mut x = vec![0.0; field.len()];
    x[..states.len()].copy_from_slice(&b[..states.len()]);
    x[field.stress()] = b[states.len()];
    field.solve(&arrow, &mut x);
    let tau = x[field.stress()];
    x.truncate(states.len());
    x.push(tau);
    ready.then_some(x)
}
