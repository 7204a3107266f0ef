//! The formulas of the last solutions: recording them anew, and making room for the series, takes longer than a short arc.
//!
//! The arcs of an orbit are solutions of one formula at the same parameters, and so are runs from several starts: a solution that is done with
//! begins anew elsewhere. Along a branch the parameters change from one orbit to the next: the recorded formula stays, and its program is made
//! of it at the new values.

use super::assembly::RecordedFormula;
use super::interpreted::Trajectory;
use super::program::Program;
use crate::expression::Expressions;
use std::cell::RefCell;
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
    pub rates: &'a Expressions,
    pub slip_rates: Option<&'a Expressions>,
    pub variables: usize,
    pub parameters: &'a [f64],
    pub free: Option<Vec<usize>>,
}

/// The same, kept with its program.
struct Kept {
    rates: Expressions,
    slip_rates: Option<Expressions>,
    variables: usize,
    /// By their bits.
    parameters: Vec<u64>,
    free: Option<Vec<usize>>,
    recorded: Arc<RecordedFormula>,
    program: Program,
    number: usize,
    idle: Vec<Box<dyn Trajectory>>,
}

thread_local! {
    /// The newest last.
    static RECENT: RefCell<Vec<Kept>> = const { RefCell::new(Vec::new()) };
}

impl Formulas<'_> {
    /// The program of these formulas, recorded by `record` if they are not among the last. Those that hold only where they were recorded are
    /// recorded each time.
    pub fn program(
        &self,
        record: impl FnOnce() -> RecordedFormula,
        own_factors: impl FnOnce() -> Vec<bool>,
    ) -> Program {
        let known = RECENT.with_borrow(|all| {
            let at_these = all.iter().rev().find(|kept| kept.is_of(self));
            at_these.map(|kept| kept.program.clone())
        });
        if let Some(program) = known {
            return program;
        }
        let recorded = RECENT.with_borrow(|all| {
            let of_these = all.iter().rev().find(|kept| kept.is_of_formulas(self));
            of_these.map(|kept| Arc::clone(&kept.recorded))
        });
        let recorded = recorded.unwrap_or_else(|| Arc::new(record()));
        let mut program = recorded.program(self.parameters);
        program.own_factors = own_factors();
        if !program.branches && program.instructions().len() <= LONGEST {
            let kept = Kept::new(self, recorded, &program);
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
        RECENT.with_borrow_mut(|all| {
            let kept = all.iter_mut().rev().find(|kept| kept.is_of(self))?;
            Some(Reused::Kept(Some(kept.idle.pop()?), kept.number))
        })
    }

    /// This solution, to be used again when it is done with. It holds for any start.
    pub fn kept(&self, solution: Box<dyn Trajectory>) -> Reused<'static> {
        let number = RECENT.with_borrow(|all| {
            let kept = all.iter().rev().find(|kept| kept.is_of(self));
            kept.map(|kept| kept.number)
        });
        match number {
            Some(number) => Reused::Kept(Some(solution), number),
            None => Reused::Once(solution),
        }
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
    fn new(of: &Formulas<'_>, recorded: Arc<RecordedFormula>, program: &Program) -> Self {
        /// Numbers hold for all threads: solutions may move from one to another.
        static NEXT: AtomicUsize = AtomicUsize::new(0);
        Kept {
            rates: of.rates.clone(),
            slip_rates: of.slip_rates.cloned(),
            variables: of.variables,
            parameters: of.parameters.iter().map(|x| x.to_bits()).collect(),
            free: of.free.clone(),
            recorded,
            program: program.clone(),
            number: NEXT.fetch_add(1, Ordering::Relaxed),
            idle: Vec::new(),
        }
    }

    fn is_of(&self, of: &Formulas<'_>) -> bool {
        let parameters = of.parameters.iter().map(|x| x.to_bits());
        self.parameters.iter().copied().eq(parameters) && self.is_of_formulas(of)
    }

    fn is_of_formulas(&self, of: &Formulas<'_>) -> bool {
        self.variables == of.variables
            && self.free == of.free
            && self.rates == *of.rates
            && self.slip_rates.as_ref() == of.slip_rates
    }
}
