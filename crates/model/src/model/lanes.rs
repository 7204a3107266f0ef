//! The vector registers of an x86-64 processor with a trajectory of two interfaces in every lane.

use super::Loading;
use super::batch::{BatchSolution, MAX_LANES};
use super::in_states::{Trajectories, logarithms};
use crate::friction::LawForm;
use crate::series::{Accuracy, Eight, Element, Expansion, Four, Recurrences, Stepper};

/// An element whose lanes are trajectories.
pub(super) trait Wide: Element {
    /// These numbers, as many as there are lanes.
    fn filled(self, x: &[f64; MAX_LANES]) -> Self;
    /// The numbers in the lanes, and zeros.
    fn spilled(self) -> [f64; MAX_LANES];
}

macro_rules! wide {
    ($name:ident $n:literal) => {
        impl Wide for $name {
            #[inline(always)]
            fn filled(self, x: &[f64; MAX_LANES]) -> Self {
                let mut lanes = [0.0; $n];
                lanes.copy_from_slice(&x[..$n]);
                self.like_lanes(lanes)
            }
            #[inline(always)]
            fn spilled(self) -> [f64; MAX_LANES] {
                let mut x = [0.0; MAX_LANES];
                x[..$n].copy_from_slice(&self.lanes());
                x
            }
        }
    };
}
wide!(Four 4);
wide!(Eight 8);

/// R makes the coefficients.
pub(super) struct Lanes<S, E, R> {
    simd: S,
    recurrences: R,
    stepper: Stepper<E, Trajectories<E>, 3>,
    /// What begins with the next step: the lanes are negative here.
    new: [f64; MAX_LANES],
    starts: [[f64; MAX_LANES]; 3],
    driving: [f64; MAX_LANES],
    stiffness: [f64; MAX_LANES],
    reaches: [f64; MAX_LANES],
}

impl<S, E: Wide, R> Lanes<S, E, R> {
    pub fn new(simd: S, law: LawForm, zero: E, recurrences: R) -> Self {
        let formula = Trajectories {
            law,
            driving: zero,
            stiffness: zero,
        };
        let mut lanes = Lanes {
            simd,
            recurrences,
            stepper: Stepper::new(formula, zero),
            new: [1.0; MAX_LANES],
            starts: [[1.0; MAX_LANES]; 3],
            driving: [0.0; MAX_LANES],
            stiffness: [0.0; MAX_LANES],
            reaches: [f64::INFINITY; MAX_LANES],
        };
        (0..E::LANES).for_each(|lane| lanes.seat(lane, (0.0, 0.0), [1.0; 3]));
        lanes
    }

    fn seat(&mut self, lane: usize, (driving, stiffness): (f64, f64), x: [f64; 3]) {
        self.new[lane] = -1.0;
        self.driving[lane] = driving;
        self.stiffness[lane] = stiffness;
        for (starts, x) in self.starts.iter_mut().zip(x) {
            starts[lane] = x;
        }
    }
}

/// A step, to be compiled for the processor's vector instructions.
struct Advance<'a, S, E, R> {
    lanes: &'a mut Lanes<S, E, R>,
    accuracy: &'a Accuracy,
    limits: &'a [f64; MAX_LANES],
}

impl<S, E, R> pulp::NullaryFnOnce for Advance<'_, S, E, R>
where
    E: Wide,
    R: Recurrences<E, Trajectories<E>, 3>,
{
    type Output = [f64; MAX_LANES];
    #[inline(always)]
    fn call(self) -> [f64; MAX_LANES] {
        let lanes = self.lanes;
        let any = lanes.stepper.state()[0];
        let new = any.filled(&lanes.new);
        if !new.none_negative() {
            let formula = lanes.stepper.formula_mut();
            formula.driving = any.filled(&lanes.driving);
            formula.stiffness = any.filled(&lanes.stiffness);
            let [tau, p, q] = &lanes.starts;
            let starts = [any.filled(tau), any.filled(p), any.filled(q)];
            lanes.stepper.start_where(new, starts);
            lanes.new = [1.0; MAX_LANES];
        }
        let limit = any.filled(self.limits);
        let recurrences = &mut lanes.recurrences;
        let steps = (lanes.stepper).advance_with(recurrences, self.accuracy, limit);
        lanes.reaches = lanes.stepper.reach(0, self.accuracy.order, steps).spilled();
        steps.spilled()
    }
}

macro_rules! convoys {
    ($($token:ident $element:ident)*) => { $(
        impl<R> BatchSolution for Lanes<pulp::x86::$token, $element, R>
        where
            R: Recurrences<$element, Trajectories<$element>, 3> + Send,
        {
            fn lanes(&self) -> usize {
                $element::LANES
            }

            fn start(&mut self, lane: usize, loading: &Loading, y: &[f64; 3]) {
                let x = [y[0], y[1].exp(), y[2].exp()];
                self.seat(lane, (loading.driving, loading.stiffness), x);
            }

            fn idle(&mut self, lane: usize) {
                self.seat(lane, (0.0, 0.0), [1.0; 3]);
            }

            fn advance(
                &mut self,
                accuracy: &Accuracy,
                limits: &[f64; MAX_LANES],
            ) -> [f64; MAX_LANES] {
                let simd = self.simd;
                simd.vectorize(Advance {
                    lanes: self,
                    accuracy,
                    limits,
                })
            }

            fn state(&self, lane: usize) -> [f64; 3] {
                let [tau, p, q] = self.stepper.state().map(|x| x.lanes()[lane]);
                [tau, p.ln(), q.ln()]
            }

            fn reaches(&self) -> &[f64; MAX_LANES] {
                &self.reaches
            }

            fn expansion(&self, lane: usize, order: usize, into: &mut Expansion<3>) {
                into.order = order;
                into.unit = self.stepper.unit().lanes()[lane];
                into.chart = logarithms;
                for (i, variable) in into.variables.iter_mut().enumerate() {
                    let series = &self.stepper.series(i)[..=order];
                    for (x, all) in variable.iter_mut().zip(series) {
                        *x = all.lanes()[lane];
                    }
                }
                for (i, rate) in into.slip_rates.iter_mut().enumerate() {
                    let series = &self.stepper.slip_rates(i)[..order];
                    for (x, all) in rate.iter_mut().zip(series) {
                        *x = all.lanes()[lane];
                    }
                }
            }
        }
    )* };
}
convoys!(V3 Four V4 Eight);
