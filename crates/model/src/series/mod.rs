//! Solutions as power series in time: what a Taylor method steps with.
//!
//! A differential equation is a formula, written for any [`crate::number::Real`]: the laws' own, the same that give values and exact
//! derivatives. Evaluated once, on numbers that write down what is done with them (`trace`), it becomes a list of operations
//! (`program`), each with a recurrence that makes the next coefficient of its result from those of its operands. What is made of the
//! parameters alone stands apart (`constants`), so that the list serves at other values of these. The recurrences run in
//! loops (`interpreted`), and compiled to machine code once a formula has made enough steps (`compiled`).
//!
//! Recurrences that are written by hand for one kind of law take less time: those of most laws stand in `model::ageing_series`, for
//! what is run most. `Stepper` makes steps of them; where they do not hold, the recorded formula makes its coefficients (`lane_formula`).
//!
//! The coefficients are `Element`s: ordinary numbers, both interfaces in one vector register, or several trajectories at
//! once. What the processor can do is asked when the program runs, so that a binary for any x86-64 uses AVX2 and AVX-512.
//!
//! Jorba, A. and Zou, M. (2005). A software package for the numerical integration of ODEs by means of high-order Taylor
//! methods. Experimental Mathematics 14, 99-117.

mod assembly;
mod column_series;
#[cfg(target_arch = "x86_64")]
mod columns;
mod compiled;
mod compiling;
mod composition;
mod constants;
mod cubic;
pub(crate) mod element;
mod equations;
mod event;
#[cfg(target_arch = "x86_64")]
mod exact_products;
mod first_order;
#[cfg(target_arch = "x86_64")]
mod functions;
mod interpreted;
mod lane_formula;
#[cfg(target_arch = "x86_64")]
pub(crate) mod lanes;
mod later;
mod later_orders;
mod linearised;
mod placed;
mod products;
mod program;
mod program_rows;
mod recent;
mod recorded;
mod rounding;
mod stepper;
mod trace;
mod transport;
#[cfg(target_arch = "x86_64")]
mod twins;
mod vectors;

use crate::number::DoubleDouble;
use crate::number::polynomial::evaluate;
#[cfg(target_arch = "x86_64")]
pub(crate) use columns::{Along, JacobianTerm, VariationalEquations};
#[doc(hidden)]
pub use compiled::BothWays;
pub use compiling::{
    Compiling, VARIABLE as COMPILE, allowed as allowed_compiling, used as used_compiling,
};
pub use cubic::Jet3;
pub(crate) use element::Element;
pub use equations::Equations;
pub use event::{Passage, Section, Zeros};
pub(crate) use lane_formula::{KeptFormula, LaneFormula};
#[cfg(target_arch = "x86_64")]
pub(crate) use lanes::{Eight, Four, Pair};
#[cfg(target_arch = "x86_64")]
pub(crate) use linearised::longest_of_terms;
pub(crate) use recorded::{ByRecording, Recorded, RecordedExpressions};
#[doc(hidden)]
pub use recorded::{both_ways, columns_both_ways};
pub(crate) use stepper::{Formula, Recurrences, Stepper};
pub use transport::TaylorMap;
pub use vectors::{VARIABLE as VECTORS, Vectors, allowed as allowed_vectors, used as used_vectors};
#[cfg(target_arch = "x86_64")]
pub(crate) use vectors::{avx2, avx512};

/// The highest order of series in doubles.
pub const MAX_ORDER: usize = 24;

/// Coefficients that a row has room for.
pub(crate) const ROOM: usize = MAX_ORDER + 1;

/// 1/k
pub(crate) const ONE_OVER: [f64; MAX_ORDER + 2] = {
    let mut one_over = [0.0; MAX_ORDER + 2];
    let mut k = 1;
    while k < MAX_ORDER + 2 {
        one_over[k] = 1.0 / k as f64;
        k += 1;
    }
    one_over
};

/// The order of the series in double-double arithmetic, run in loops.
pub const REFERENCE_ORDER: usize = 32;

/// The order of a step, and what it may err by.
#[derive(Debug, Clone, Copy)]
pub struct Accuracy {
    /// An even one from 12 to [`MAX_ORDER`]; [`REFERENCE_ORDER`] in
    /// double-double arithmetic.
    pub order: usize,
    /// Relative and absolute tolerance.
    pub tolerances: (f64, f64),
}

/// The order with which series in loops take the least time for a relative tolerance.
pub fn usual_order(rtol: f64) -> usize {
    /// Tolerances above which lower orders win.
    const LOW: f64 = 1e-7;
    const MIDDLE: f64 = 1e-12;
    if rtol > LOW {
        12
    } else if rtol > MIDDLE {
        16
    } else {
        18
    }
}

/// A solution in N dimensions on its way, step by step.
pub trait Solution<const N: usize> {
    /// The order with which it takes the least time for a relative tolerance.
    fn order(&self, rtol: f64) -> usize {
        usual_order(rtol)
    }
    /// Begins at y.
    fn start(&mut self, y: &[f64; N]);
    /// Goes on by the step that the accuracy asks for, at most `limit` (negative: back in time), and returns it. Not a number
    /// if there is no step; the state then stays.
    fn advance(&mut self, accuracy: &Accuracy, limit: DoubleDouble) -> DoubleDouble;
    /// How many steps, or parts of them, were tried and not taken since the start: their ends were not on the solution.
    fn rejected(&self) -> usize {
        0
    }
    /// The state reached.
    fn state(&self) -> [f64; N];
    /// The slips of both interfaces in the last step, of this length, where they are had without all of the series.
    fn slips(&self, _order: usize, _length: f64) -> Option<[f64; 2]> {
        None
    }
    /// The series at the beginning of the last step.
    fn expansion(&self, order: usize, into: &mut Expansion<N>);
}

/// A solution with its derivatives in its start and in some parameters, on its way. Started with y, those in y are the identity
/// and those in parameters zero; every step has all of them within the accuracy.
pub trait Tangent<const N: usize>: Solution<N> {
    /// The derivatives of the state reached.
    fn derivatives(&self) -> Derivatives<N>;

    /// The series, at the beginning of the last step and in its unit of time, of a variable's derivatives in the N components of the
    /// start and then in the parameters: the k-th coefficients of all stand together. Whether there are any: systems without a
    /// recorded formula keep none.
    fn derivative_series(&self, _variable: usize, _order: usize, _into: &mut Vec<f64>) -> bool {
        false
    }
}

/// Derivatives of a state in its start and in parameters.
#[derive(Debug, Clone, PartialEq)]
pub struct Derivatives<const N: usize> {
    /// In the j-th component of the start: column j.
    pub start: [[f64; N]; N],
    /// In the parameters that were asked for, in that order.
    pub parameters: Vec<[f64; N]>,
    /// The integral of the trace of the Jacobian: by Liouville's theorem the logarithm of the determinant of `start`, of which
    /// it knows nothing.
    pub log_determinant: f64,
    /// Where the system is the symmetric subspace of two equal parts under one common variable: the logarithm by which a small
    /// difference between the parts grows.
    pub log_transverse: Option<f64>,
}

/// The series of a solution at the beginning of a step, in the variables that it is made in.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct Expansion<const N: usize> {
    /// The time of the beginning, in 31 digits: stress and state can change ten thousand times faster than time.
    pub begin: DoubleDouble,
    /// The time from the beginning of the step to its end.
    pub length: f64,
    /// The unit of time.
    pub unit: f64,
    /// The order to which the variables are known.
    pub order: usize,
    /// The coefficients of tau and psi, or of whatever the field's variables are.
    pub variables: [[f64; REFERENCE_ORDER + 1]; N],
    /// The coefficients of the slip rates of all interfaces, of two at least, to one order less; zero for fields without any.
    pub slip_rates: Vec<[f64; REFERENCE_ORDER + 1]>,
    /// From these variables to the state that the field is integrated in.
    pub chart: fn([f64; N]) -> [f64; N],
}

impl<const N: usize> Expansion<N> {
    /// Of nothing yet.
    pub fn new() -> Self {
        Expansion {
            begin: DoubleDouble::ZERO,
            length: 0.0,
            unit: 1.0,
            order: 0,
            variables: [[0.0; REFERENCE_ORDER + 1]; N],
            slip_rates: vec![[0.0; REFERENCE_ORDER + 1]; 2],
            chart: |x| x,
        }
    }

    /// The state at a time after the beginning of the step.
    pub fn state(&self, time: f64) -> [f64; N] {
        self.state_at(time / self.unit)
    }

    /// The state after s units.
    fn state_at(&self, s: f64) -> [f64; N] {
        let mut x = [0.0; N];
        for (x, series) in x.iter_mut().zip(&self.variables) {
            *x = evaluate(&series[..=self.order], s);
        }
        (self.chart)(x)
    }

    /// The slips of both interfaces up to a time after the beginning of the step.
    pub fn slips(&self, time: f64) -> [f64; 2] {
        [0, 1].map(|interface| self.slip(interface, time))
    }

    /// The slip of one interface up to a time after the beginning of the step: its slip rate integrated term by term.
    pub fn slip(&self, interface: usize, time: f64) -> f64 {
        let s = time / self.unit;
        let rates = &self.slip_rates[interface][..self.order];
        let terms = rates.iter().enumerate().rev();
        let mean = terms.fold(0.0, |sum, (j, rate)| sum * s + rate / (j + 1) as f64);
        mean * time
    }
}

impl<const N: usize> Default for Expansion<N> {
    fn default() -> Self {
        Self::new()
    }
}
