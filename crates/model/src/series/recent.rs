//! The programs that were recorded last. The arcs of an orbit are solutions of one formula at the same parameters, and so are runs from several
//! starts: recording it anew for each takes longer than a short arc.

use super::program::Program;
use crate::expression::Expressions;
use std::cell::RefCell;

/// Programs that are kept, in each thread.
const KEPT: usize = 4;
/// Longer ones are not.
const LONGEST: usize = 2000;

/// Formulas at given parameters, and the places of the parameters in which they are differentiated.
#[derive(Debug, Clone, Copy)]
pub(super) struct Formulas<'a> {
    pub rates: &'a Expressions,
    pub slip_rates: Option<&'a Expressions>,
    pub variables: usize,
    pub parameters: &'a [f64],
    pub free: Option<&'a [usize]>,
}

/// The same, kept with its program.
struct Kept {
    rates: Expressions,
    slip_rates: Option<Expressions>,
    variables: usize,
    /// By their bits.
    parameters: Vec<u64>,
    free: Option<Vec<usize>>,
    program: Program,
}

thread_local! {
    /// The newest last.
    static RECENT: RefCell<Vec<Kept>> = const { RefCell::new(Vec::new()) };
}

impl Formulas<'_> {
    /// The program of these formulas, recorded by `record` if it is not one of the last. A program that holds only where it was recorded is
    /// recorded each time.
    pub fn program(&self, record: impl FnOnce() -> Program) -> Program {
        let known = RECENT.with_borrow(|all| {
            let kept = all.iter().rev().find(|kept| kept.is_of(self));
            kept.map(|kept| kept.program.clone())
        });
        known.unwrap_or_else(|| {
            let program = record();
            if !program.branches && program.instructions().len() <= LONGEST {
                let kept = Kept::new(self, &program);
                RECENT.with_borrow_mut(|all| {
                    if all.len() == KEPT {
                        all.remove(0);
                    }
                    all.push(kept);
                });
            }
            program
        })
    }
}

impl Kept {
    fn new(of: &Formulas<'_>, program: &Program) -> Self {
        Kept {
            rates: of.rates.clone(),
            slip_rates: of.slip_rates.cloned(),
            variables: of.variables,
            parameters: of.parameters.iter().map(|x| x.to_bits()).collect(),
            free: of.free.map(<[usize]>::to_vec),
            program: program.clone(),
        }
    }

    fn is_of(&self, of: &Formulas<'_>) -> bool {
        let parameters = of.parameters.iter().map(|x| x.to_bits());
        self.variables == of.variables
            && self.parameters.iter().copied().eq(parameters)
            && self.free.as_deref() == of.free
            && self.rates == *of.rates
            && self.slip_rates.as_ref() == of.slip_rates
    }
}
