//! Rosenbrock methods for all interfaces at once: every stage is one linear system with an arrow matrix, solved in linear time.
//!
//! The controller of steps is that of the few dimensions. A step is accepted if no ln psi errs by more than the tolerance, tau by no more than
//! the tolerance times 1 + |tau|, and no slip by more than the tolerance times itself and a slip that is told beforehand.

use super::constants::LANES;
use super::field::{Arrow, ManyField, Slips};
use super::interfaces::ManyInterfaces;
use super::share::CHUNK;
use super::state::{Dense, DenseStep, ManyState, Scales};
use super::step::{Beginning, ManyObserver, until_save};
use crate::error::{Error, Result};
use crate::friction::positive;
use crate::integrate::rosenbrock::drive::{Steppable, drive};
use crate::integrate::rosenbrock::stages::error_order;

use crate::integrate::{Control, RosenbrockMethod, Tableau, Work};
use rayon::prelude::*;

/// A Rosenbrock method with its tolerance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ManyRosenbrock {
    method: RosenbrockMethod,
    tolerance: f64,
    max_steps: usize,
}

impl ManyRosenbrock {
    /// # Errors
    /// [`Error::Parameter`] for a tolerance or a bound on steps that is not positive.
    pub fn new(method: RosenbrockMethod, tolerance: f64, max_steps: usize) -> Result<Self> {
        positive("rtol", tolerance)?;
        if max_steps == 0 {
            return Err(Error::parameter("max-steps", 0, "at least 1"));
        }
        Ok(ManyRosenbrock {
            method,
            tolerance: tolerance.max(f64::EPSILON),
            max_steps,
        })
    }

    /// The method.
    pub fn method(&self) -> RosenbrockMethod {
        self.method
    }

    /// Bytes that a run takes, without rows.
    pub fn memory(&self, interfaces: &ManyInterfaces) -> usize {
        // stages, two matrices with their factors, and y, the next one, f twice, two sums, the error and dense output
        let vectors = self.method.tableau().stages + 2 * 4 + 8;
        let held = interfaces.blocks() * LANES * size_of::<f64>();
        vectors * held + interfaces.constants_memory()
    }

    /// From a beginning on until a time, or until the observer says `false`; it sees every step, with the slips that are asked for.
    ///
    /// # Errors
    /// As [`super::ManyTaylor::flow`], and [`Error::NonFinite`].
    pub fn run<'a>(
        &self,
        interfaces: &'a ManyInterfaces,
        beginning: Beginning<'_>,
        until: f64,
        slips: &Slips,
        observer: &mut dyn ManyObserver,
    ) -> Result<ManyState<'a>> {
        let field = ManyField::new(interfaces, slips);
        let (mut time, mut steps, y) = field.begun(beginning)?;
        let mut carried = self.carried(field, y, until);
        let mut goes_on = true;
        while goes_on && time < until {
            let left = until_save(observer, steps);
            let mut done = 0;
            let first = carried.first_step(self.tolerance, time)?;
            let allowed = self.max_steps.saturating_sub(steps);
            drive(
                &mut carried,
                (time, until),
                first.min(until - time),
                allowed,
                |carried, step| {
                    let (begin, end) = (step.begin.hi(), step.end.hi());
                    (time, done) = (end, done + 1);
                    let slipped = &carried.y[carried.field.logs()..];
                    let step = Continuous {
                        carried,
                        begin,
                        end,
                    };
                    goes_on = observer.step(&DenseStep::new(step, (begin, end), slipped))?;
                    Ok(if goes_on && done < left {
                        Control::Continue
                    } else {
                        Control::Stop
                    })
                },
            )?;
            steps += done;
            if done == left {
                carried.field.forget_slips(&mut carried.y);
                observer.save(carried.field.saved(time, steps, &carried.y))?;
            }
        }
        let Carried { field, y, work, .. } = carried;
        Ok(ManyState::new(field, y, time, work))
    }

    fn carried<'a>(&self, field: ManyField<'a>, y: Vec<f64>, until: f64) -> Carried<'a> {
        let tableau = self.method.tableau();
        let none = || vec![0.0; y.len()];
        Carried {
            scales: Scales::new(&field, self.tolerance, until),
            tableau,
            f: none(),
            next: none(),
            last_f: none(),
            ahead_f: none(),
            argument: none(),
            stages: vec![none(); tableau.stages],
            here: Arrow::default(),
            ahead: Arrow::default(),
            work: Work::default(),
            field,
            y,
        }
    }
}

/// A state on its way.
struct Carried<'a> {
    field: ManyField<'a>,
    scales: Scales,
    tableau: &'static Tableau,
    y: Vec<f64>,
    f: Vec<f64>,
    /// The end of the tried step, f at its last stage and at its end.
    next: Vec<f64>,
    last_f: Vec<f64>,
    ahead_f: Vec<f64>,
    argument: Vec<f64>,
    stages: Vec<Vec<f64>>,
    here: Arrow,
    ahead: Arrow,
    work: Work,
}

impl Carried<'_> {
    /// Makes f and J where it is, and tells a first step that resolves the fastest motion: the controller makes the next ones longer.
    fn first_step(&mut self, tolerance: f64, t: f64) -> Result<f64> {
        self.work.rhs += 1;
        self.work.jacobians += 1;
        self.field.rates(&self.y, &mut self.f);
        self.field.linearise(&self.y, &mut self.here);
        let fastest = self.field.largest(&self.here);
        if !self.scales.are_finite(&self.field, &self.f) || !fastest.is_finite() {
            let what = "the right-hand side or its Jacobian";
            return Err(Error::NonFinite { what, t });
        }
        Ok(tolerance.powf(1.0 / f64::from(self.tableau.order)) / fastest)
    }
}

/// `made` = start + the sum of weights times vectors.
fn combine(made: &mut [f64], start: Option<&[f64]>, weights: &[f64], vectors: &[Vec<f64>]) {
    const PIECE: usize = CHUNK * LANES;
    let terms = || {
        weights
            .iter()
            .zip(vectors)
            .filter(|(weight, _)| **weight != 0.0)
    };
    let work = |(piece, made): (usize, &mut [f64])| {
        let at = piece * PIECE;
        match start {
            Some(start) => made.copy_from_slice(&start[at..][..made.len()]),
            None => made.fill(0.0),
        }
        for (weight, vector) in terms() {
            for (sum, x) in made.iter_mut().zip(&vector[at..]) {
                *sum += weight * x;
            }
        }
    };
    if made.len() >= super::share::MANY {
        made.par_chunks_mut(PIECE).enumerate().for_each(work);
    } else {
        made.chunks_mut(PIECE).enumerate().for_each(work);
    }
}

impl Steppable for Carried<'_> {
    fn error_order(&self) -> u32 {
        error_order(self.tableau)
    }

    fn work(&mut self) -> &mut Work {
        &mut self.work
    }

    fn underflow(&self, t: f64, h: f64) -> Error {
        Error::StepTooSmall { t, h }
    }

    fn attempt(&mut self, h: f64, _: f64) -> Option<f64> {
        let tableau = self.tableau;
        self.work.factorisations += 1;
        let diagonal = 1.0 / (h * tableau.gamma);
        if !self.field.factorise(diagonal, &mut self.here) {
            return None;
        }
        self.work.rhs += tableau.stages - 1;
        self.stages[0].copy_from_slice(&self.f);
        self.field.solve(&self.here, &mut self.stages[0]);
        for i in 1..tableau.stages {
            let (known, rest) = self.stages.split_at_mut(i);
            combine(&mut self.argument, Some(&self.y), &tableau.a[i][..i], known);
            self.field.rates(&self.argument, &mut self.last_f);
            let coupling = tableau.c[i].map(|c| c / h);
            combine(&mut rest[0], Some(&self.last_f), &coupling[..i], known);
            self.field.solve(&self.here, &mut rest[0]);
        }
        let stages = tableau.stages;
        combine(
            &mut self.next,
            Some(&self.y),
            &tableau.m[..stages],
            &self.stages,
        );
        combine(&mut self.argument, None, &tableau.e[..stages], &self.stages);
        self.scales
            .norm(&self.field, &self.argument, (&self.y, &self.next))
    }

    /// Such runs are saved, and seen, at times that are doubles.
    fn goes_through_spikes(&self) -> bool {
        false
    }

    fn fastest(&self) -> (f64, f64) {
        (
            self.field.largest(&self.here),
            self.field.largest(&self.ahead),
        )
    }

    fn look_ahead(&mut self) -> bool {
        if self.tableau.ends_at_last_stage {
            std::mem::swap(&mut self.ahead_f, &mut self.last_f);
        } else {
            self.work.rhs += 1;
            self.field.rates(&self.next, &mut self.ahead_f);
        }
        self.work.jacobians += 1;
        self.field.linearise(&self.next, &mut self.ahead);
        self.scales.are_finite(&self.field, &self.ahead_f)
    }

    fn advance(&mut self) {
        std::mem::swap(&mut self.y, &mut self.next);
        std::mem::swap(&mut self.f, &mut self.ahead_f);
        std::mem::swap(&mut self.here, &mut self.ahead);
    }
}

/// A step with its continuous solution.
struct Continuous<'a, 'f> {
    carried: &'a Carried<'f>,
    begin: f64,
    end: f64,
}

impl Dense for Continuous<'_, '_> {
    fn field(&self) -> &ManyField<'_> {
        &self.carried.field
    }

    fn stands(&self, time: f64) -> Option<&[f64]> {
        if time == self.begin {
            Some(&self.carried.y)
        } else if time == self.end {
            Some(&self.carried.next)
        } else {
            None
        }
    }

    fn make(&self, time: f64, state: &mut [f64]) {
        let Carried {
            tableau,
            y,
            next,
            stages,
            ..
        } = self.carried;
        let theta = (time - self.begin) / (self.end - self.begin);
        let rest = 1.0 - theta;
        // y (1 - theta) + theta (next + (1 - theta) (k_1 + theta (k_2 + theta k_3)))
        let weights: Vec<f64> = (0..tableau.stages)
            .map(|i| {
                let [a, b, c] = [0, 1, 2].map(|l| tableau.d[l][i]);
                theta * rest * (a + (b + c * theta) * theta)
            })
            .collect();
        combine(state, None, &weights, stages);
        for (made, (y, next)) in state.iter_mut().zip(y.iter().zip(next)) {
            *made += rest * y + theta * next;
        }
    }
}
