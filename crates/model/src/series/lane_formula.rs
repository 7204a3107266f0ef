//! A recorded formula that makes the coefficients of a [`super::Stepper`]: in every lane at its own parameters and in its own unit of time.

use super::ROOM;
use super::assembly::RecordedFormula;
use super::compiled::{Compiled, expand};
use super::element::Element;
use super::equations::Equations;
use super::program::{Program, Source};
use super::program_rows::ProgramRows;
use super::trace::{Graph, Traced};
use pulp::NullaryFnOnce;
use std::any::Any;
use std::cell::RefCell;
use std::ops::{Deref, DerefMut};

/// The formula of N variables and P parameters, and the series that were made of it last.
pub(crate) struct LaneFormula<T: Element> {
    rows: ProgramRows<T>,
    compiled: Option<Compiled<T>>,
    /// What it gives after the rates.
    others: Vec<Source>,
}

impl<T: Element> LaneFormula<T> {
    /// The formula, which gives after its rates both slip rates; with `slopes` also, for one variable after the other, the derivatives in it of
    /// these and of all rates but the first. `any` is any number.
    #[cold]
    #[inline(never)]
    pub fn new<S: Equations<N, P>, const N: usize, const P: usize>(
        equations: &S,
        slopes: bool,
        any: T,
    ) -> Self {
        let graph = Graph::default();
        let x: [_; N] = std::array::from_fn(|i| graph.variable(i, 1.0));
        // Variables that stay: a number would be the same in all lanes.
        let parameters: [_; P] = std::array::from_fn(|q| graph.variable(N + q, 1.0));
        let mut outputs = equations.rates(x, parameters).to_vec();
        let own_rates = outputs[1..].to_vec();
        outputs.resize(N + P, Traced::Constant(0.0.into()));
        let slip_rates = equations.slip_rates(x, parameters);
        let mut others: Vec<_> = slip_rates.into_iter().flatten().collect();
        outputs.extend(&others);
        if slopes {
            others.extend(own_rates);
            (0..N).for_each(|i| outputs.extend(graph.derivatives(&others, i)));
        }
        let program = RecordedFormula::new(&graph, N + P, &outputs).program(&[]);
        assert!(!program.branches, "it holds everywhere");
        Self::of(&program, any)
    }

    fn of(program: &Program, any: T) -> Self {
        let rows = ProgramRows::new(program, ROOM, any);
        LaneFormula {
            compiled: Compiled::of(&rows, any),
            rows,
            others: (program.variables()..program.outputs.len())
                .map(|i| program.output(i))
                .collect(),
        }
    }

    /// Makes the series that begin at these variables and parameters, to an order, in that unit of time.
    #[inline(never)]
    pub fn expand(&mut self, begin: &[T], order: usize, unit: T) {
        unit.run(Expand {
            formula: self,
            begin,
            order,
            unit,
        });
    }

    /// The series of the i-th variable.
    #[inline(always)]
    pub fn variable(&self, i: usize) -> &[T] {
        self.rows.row(i)
    }

    /// The k-th coefficient of what it gives, the i-th after the rates.
    #[inline(always)]
    pub fn other(&self, i: usize, k: usize) -> T {
        self.rows.coefficient(self.others[i], k)
    }
}

/// Formulas that are kept in each thread while nobody uses them: recording one takes longer than a short arc.
const KEPT: usize = 8;

thread_local! {
    /// With what they are the formulas of. The newest last.
    static IDLE: RefCell<Vec<Known>> = const { RefCell::new(Vec::new()) };
}

/// A formula, and what it is of: the equations, and whether it gives slopes.
struct Known {
    of: Box<dyn Any>,
    formula: Box<LaneFormula<f64>>,
}

/// A formula that others use after this one.
pub(crate) struct KeptFormula(Option<Known>);

impl KeptFormula {
    /// As of [`LaneFormula::new`].
    pub fn new<S, const N: usize, const P: usize>(equations: S, slopes: bool) -> Self
    where
        S: Equations<N, P> + PartialEq + 'static,
    {
        let of = (equations, slopes);
        let is_it = |known: &Known| known.of.downcast_ref() == Some(&of);
        let idle = IDLE.with_borrow_mut(|all| {
            let at = all.iter().rposition(is_it)?;
            Some(all.remove(at))
        });
        KeptFormula(Some(idle.unwrap_or_else(|| Known {
            formula: Box::new(LaneFormula::new(&of.0, slopes, 0.0)),
            of: Box::new(of),
        })))
    }
}

impl Deref for KeptFormula {
    type Target = LaneFormula<f64>;

    fn deref(&self) -> &LaneFormula<f64> {
        &self.0.as_ref().expect("it is in use").formula
    }
}

impl DerefMut for KeptFormula {
    fn deref_mut(&mut self) -> &mut LaneFormula<f64> {
        &mut self.0.as_mut().expect("it is in use").formula
    }
}

impl Drop for KeptFormula {
    fn drop(&mut self) {
        let known = self.0.take();
        // Where the thread ends nothing keeps it.
        let _ = IDLE.try_with(|all| {
            let mut all = all.borrow_mut();
            if all.len() == KEPT {
                all.remove(0);
            }
            all.extend(known);
        });
    }
}

/// All orders, to be compiled for the processor.
struct Expand<'a, T: Element> {
    formula: &'a mut LaneFormula<T>,
    begin: &'a [T],
    order: usize,
    unit: T,
}

impl<T: Element> NullaryFnOnce for Expand<'_, T> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let LaneFormula { rows, compiled, .. } = self.formula;
        let order_and_unit = (self.order, self.unit);
        expand((rows, compiled.as_mut()), self.begin, order_and_unit);
    }
}
