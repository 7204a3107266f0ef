//! The formulas of the last solutions: recording them anew, and making room for the series, takes longer than a short arc.
//!
//! The arcs of an orbit are solutions of one formula at the same parameters, and so are runs from several starts: a solution that is done with
//! begins anew elsewhere. Along a branch the parameters change from one orbit to the next: solutions take over the new values, and are made
//! anew only where a value decides what there is to compute ([`super::constants`]).

use super::assembly::RecordedFormula;
use super::interpreted::Trajectory;
use super::program::Program;
use crate::expression::Expressions;
use std::cell::{OnceCell, RefCell};
use std::ops::{Deref, DerefMut};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Formulas that are kept, in each thread, and the solutions of each that are done with.
const KEPT: usize = 4;
const IDLE: usize = 4;
/// Longer formulas are not.
const LONGEST: usize = 2000;

/// Formulas at given parameters, and the places of the parameters in which they are differentiated.
#[derive(Debug, Clone)]
pub(super) struct Formulas<'a> {
    pub rates: &'a Arc<Expressions>,
    pub slip_rates: Option<&'a Arc<Expressions>>,
    pub variables: usize,
    pub parameters: &'a [f64],
    pub free: Option<Vec<usize>>,
    /// For each variable whether it is a factor of its own rate, once that was asked for.
    pub own_factors: OnceCell<Vec<bool>>,
}

/// The same, kept with its program at the parameters of the last solution that was made of it.
struct Kept {
    rates: Arc<Expressions>,
    slip_rates: Option<Arc<Expressions>>,
    variables: usize,
    free: Option<Vec<usize>>,
    recorded: RecordedFormula,
    program: Program,
    number: usize,
    idle: Vec<Box<dyn Trajectory>>,
}

thread_local! {
    /// The one used last is the last.
    static RECENT: RefCell<Vec<Kept>> = const { RefCell::new(Vec::new()) };
}

impl Formulas<'_> {
    /// The program of these formulas, recorded by `record` if they are not among the last. Those that hold only where they were recorded are
    /// recorded each time.
    pub fn program(&self, record: impl FnOnce() -> RecordedFormula) -> Program {
        let known = self.kept_ones(|kept| {
            kept.set(self);
            kept.program.clone()
        });
        if let Some(program) = known {
            return program;
        }
        let recorded = record();
        let mut program = recorded.program(self.parameters);
        program.own_factors.clone_from(self.own_factors());
        if !program.branches && program.instructions().len() <= LONGEST {
            let kept = Kept::new(self, recorded, program.clone());
            RECENT.with_borrow_mut(|all| {
                if all.len() == KEPT {
                    all.remove(0);
                }
                all.push(kept);
            });
        }
        program
    }

    /// A solution of these formulas that is done with, if there is one.
    pub fn idle(&self) -> Option<Reused<'static>> {
        self.kept_ones(|kept| Some(Reused::Kept(Some(kept.take(self)?), kept.number)))?
    }

    /// This solution, to be used again when it is done with. It holds for any start.
    pub fn kept(&self, solution: Box<dyn Trajectory>) -> Reused<'static> {
        match self.kept_ones(|kept| kept.number) {
            Some(number) => Reused::Kept(Some(solution), number),
            None => Reused::Once(solution),
        }
    }

    /// What is made of the kept ones, if they are.
    fn kept_ones<X>(&self, make: impl FnOnce(&mut Kept) -> X) -> Option<X> {
        RECENT.with_borrow_mut(|all| {
            let place = all.iter().rposition(|kept| kept.is_of(self))?;
            all[place..].rotate_left(1);
            all.last_mut().map(make)
        })
    }

    fn own_factors(&self) -> &Vec<bool> {
        self.own_factors
            .get_or_init(|| self.rates.own_factors(self.variables, self.parameters))
    }
}

/// A solution that may go back to its formulas when it is done with.
pub(super) enum Reused<'a> {
    /// It does, to those of this number.
    Kept(Option<Box<dyn Trajectory>>, usize),
    Once(Box<dyn Trajectory + 'a>),
}

impl<'a> Deref for Reused<'a> {
    type Target = dyn Trajectory + 'a;

    fn deref(&self) -> &Self::Target {
        match self {
            Reused::Kept(solution, _) => solution.as_deref().expect("it is not done with"),
            Reused::Once(solution) => &**solution,
        }
    }
}

impl DerefMut for Reused<'_> {
    fn deref_mut(&mut self) -> &mut Self::Target {
        match self {
            Reused::Kept(solution, _) => solution.as_deref_mut().expect("it is not done with"),
            Reused::Once(solution) => &mut **solution,
        }
    }
}

impl Drop for Reused<'_> {
    fn drop(&mut self) {
        let Reused::Kept(solution, number) = self else {
            return;
        };
        let (solution, number) = (solution.take(), *number);
        // Where the thread ends nothing keeps it.
        let _ = RECENT.try_with(|all| {
            let mut all = all.borrow_mut();
            let kept = all.iter_mut().find(|kept| kept.number == number);
            if let Some(kept) = kept.filter(|kept| kept.idle.len() < IDLE) {
                kept.idle.extend(solution);
            }
        });
    }
}

impl Kept {
    fn new(of: &Formulas<'_>, recorded: RecordedFormula, program: Program) -> Self {
        /// Numbers hold for all threads: solutions may move from one to another.
        static NEXT: AtomicUsize = AtomicUsize::new(0);
        Kept {
            rates: Arc::clone(of.rates),
            slip_rates: of.slip_rates.cloned(),
            variables: of.variables,
            free: of.free.clone(),
            recorded,
            program,
            number: NEXT.fetch_add(1, Ordering::Relaxed),
            idle: Vec::new(),
        }
    }

    fn is_of(&self, of: &Formulas<'_>) -> bool {
        // What is shared is not looked into.
        self.variables == of.variables
            && self.free == of.free
            && self.rates == *of.rates
            && self.slip_rates.as_ref() == of.slip_rates
    }

    /// Makes the program the one at these parameters.
    fn set(&mut self, of: &Formulas<'_>) {
        let constants = &mut self.program.constants;
        if constants.are_at(of.parameters) {
            return;
        }
        if !constants.set(of.parameters) {
            self.program = self.recorded.program(of.parameters);
        }
        self.program.own_factors.clone_from(of.own_factors());
    }

    /// A solution that is done with, made the one at these parameters. Those that can't be are dropped.
    fn take(&mut self, of: &Formulas<'_>) -> Option<Box<dyn Trajectory>> {
        let mut idle = self.idle.iter();
        if let Some(place) = idle.rposition(|one| one.is_at(of.parameters)) {
            return Some(self.idle.swap_remove(place));
        }
        while let Some(mut solution) = self.idle.pop() {
            if solution.set(of.parameters, of.own_factors()) {
                return Some(solution);
            }
        }
        None
    }
}
