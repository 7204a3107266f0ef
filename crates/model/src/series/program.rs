//! A recorded formula on power series: one coefficient of all its quantities after the other.
//!
//! What depends on the variables has a row of coefficients; everything else is a number. The recurrences run in loops over the
//! operations ([`super::program_rows`]) instead of compiled one by one: for any number of variables, for numbers of any kind, and no
//! code for each formula.

use super::later::LaterOrders;
use crate::number::{Balance, DoubleDouble, Ratio};
#[cfg(target_arch = "x86_64")]
use std::sync::{Arc, OnceLock};

/// A quantity: a number, or the row of its coefficients.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Source {
    Number(DoubleDouble),
    Row(usize),
}

/// How a row comes from others.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Operation {
    /// One lane of a row, in both.
    #[cfg_attr(not(target_arch = "x86_64"), allow(dead_code))]
    Lane(usize, usize),
    Sum(usize, usize),
    Difference(usize, usize),
    Negative(usize),
    /// a + x
    Shifted(usize, DoubleDouble),
    /// x - a
    Complement(DoubleDouble, usize),
    /// a x
    Scaled(usize, DoubleDouble),
    /// a / x
    Over(usize, DoubleDouble),
    Product(usize, usize),
    /// a / b; the spare row holds 1 / b_0
    Quotient(Source, usize),
    /// the spare row holds j a_j
    Exponential(usize),
    /// e^a and, in that row, e^-a; the spare row holds j a_j
    Exponentials(usize, usize),
    /// e^a - 1 beside e^a
    ExponentialLessOne(usize, usize),
    /// the spare row holds 1 / a_0, then j l_j
    Logarithm(usize),
    LogarithmOfOneMore(usize, usize),
    /// sinh a and, in that row, cosh a; the spare row holds j a_j
    Hyperbolic(usize, usize),
    /// sin a and, in that row, cos a; the spare row holds j a_j
    Circular(usize, usize),
    /// atan a beside 1 + a^2; the spare row holds 1 / (1 + a_0^2), then j y_j
    Arctangent(usize, usize),
    /// asinh a beside sqrt(1 + a^2); likewise
    InverseHyperbolicSine(usize, usize),
    /// tanh a and, in that row, 1 - tanh^2 a; the spare row holds j a_j
    HyperbolicTangent(usize, usize),
    /// a^p; the spare row holds 1 / a_0, then j y_j
    Power(usize, DoubleDouble),
    /// N(a)/a, or a derivative of it
    Ratio(usize, Ratio),
    Sign(usize),
    Signed(usize, usize),
    /// The y of y + g(y) = a. Before it stand exp y and exp(-y), or sinh y and cosh y, g'(y_0), what the newest coefficients of g count, and g(y); the spare row
    /// holds 1 / (1 + g'(y_0)), then j y_j.
    Balanced(Source, Balance<Source>),
}

impl Operation {
    /// The rows whose coefficients it needs at the order of its result.
    pub fn operands(self) -> [Option<usize>; 3] {
        let row = |source: Source| match source {
            Source::Row(row) => Some(row),
            Source::Number(_) => None,
        };
        match self {
            Operation::Balanced(x, Balance::Exponential(a) | Balance::Sinh(a)) => {
                [row(x), row(a), None]
            }
            Operation::Balanced(x, Balance::Difference(a, b)) => [row(x), row(a), row(b)],
            Operation::Sum(a, b)
            | Operation::Difference(a, b)
            | Operation::Product(a, b)
            | Operation::Quotient(Source::Row(a), b)
            | Operation::ExponentialLessOne(a, b)
            | Operation::LogarithmOfOneMore(a, b)
            | Operation::Arctangent(a, b)
            | Operation::InverseHyperbolicSine(a, b)
            | Operation::Signed(a, b) => [Some(a), Some(b), None],
            Operation::Negative(a)
            | Operation::Shifted(a, _)
            | Operation::Complement(_, a)
            | Operation::Scaled(a, _)
            | Operation::Over(a, _)
            | Operation::Quotient(Source::Number(_), a)
            | Operation::Exponential(a)
            | Operation::Exponentials(a, _)
            | Operation::Logarithm(a)
            | Operation::Hyperbolic(a, _)
            | Operation::Circular(a, _)
            | Operation::HyperbolicTangent(a, _)
            | Operation::Power(a, _)
            | Operation::Ratio(a, _)
            | Operation::Sign(a)
            | Operation::Lane(a, _) => [Some(a), None, None],
        }
    }

    /// The operand of which a multiple does as well at all orders but the first.
    pub fn of_multiple(self) -> Option<usize> {
        match self {
            Operation::Exponential(a)
            | Operation::Logarithm(a)
            | Operation::Hyperbolic(a, _)
            | Operation::Circular(a, _)
            | Operation::HyperbolicTangent(a, _)
            | Operation::Arctangent(a, _)
            | Operation::InverseHyperbolicSine(a, _)
            | Operation::Power(a, _) => Some(a),
            Operation::Product(a, _) => Some(a),
            Operation::Quotient(Source::Row(a), b) if a != b => Some(a),
            _ => None,
        }
    }

    /// The same of rows that stand elsewhere.
    pub fn moved(self, mut at: impl FnMut(usize) -> usize) -> Self {
        use Operation::*;
        let mut source = |source: Source| match source {
            Source::Row(row) => Source::Row(at(row)),
            number => number,
        };
        match self {
            Balanced(x, g) => {
                let x = source(x);
                return Balanced(x, g.map(source));
            }
            Quotient(a, b) => {
                let a = source(a);
                return Quotient(a, at(b));
            }
            _ => {}
        }
        match self {
            Sum(a, b) => Sum(at(a), at(b)),
            Difference(a, b) => Difference(at(a), at(b)),
            Product(a, b) => Product(at(a), at(b)),
            ExponentialLessOne(a, b) => ExponentialLessOne(at(a), at(b)),
            LogarithmOfOneMore(a, b) => LogarithmOfOneMore(at(a), at(b)),
            Arctangent(a, b) => Arctangent(at(a), at(b)),
            InverseHyperbolicSine(a, b) => InverseHyperbolicSine(at(a), at(b)),
            Signed(a, b) => Signed(at(a), at(b)),
            Exponentials(a, b) => Exponentials(at(a), at(b)),
            Hyperbolic(a, b) => Hyperbolic(at(a), at(b)),
            Circular(a, b) => Circular(at(a), at(b)),
            HyperbolicTangent(a, b) => HyperbolicTangent(at(a), at(b)),
            Negative(a) => Negative(at(a)),
            Shifted(a, x) => Shifted(at(a), x),
            Complement(x, a) => Complement(x, at(a)),
            Scaled(a, x) => Scaled(at(a), x),
            Over(a, x) => Over(at(a), x),
            Exponential(a) => Exponential(at(a)),
            Logarithm(a) => Logarithm(at(a)),
            Power(a, p) => Power(at(a), p),
            Ratio(a, ratio) => Ratio(at(a), ratio),
            Sign(a) => Sign(at(a)),
            Lane(a, lane) => Lane(at(a), lane),
            Balanced(..) | Quotient(..) => unreachable!("moved above"),
        }
    }

    /// Whether this makes what the other one would, of the same operands; the row that either makes beside its result does not count.
    #[cfg(target_arch = "x86_64")]
    pub fn is_like(self, other: Self) -> bool {
        use Operation::*;
        match (self, other) {
            (Balanced(..), _) => false,
            (Hyperbolic(a, _), Hyperbolic(b, _))
            | (Circular(a, _), Circular(b, _))
            | (HyperbolicTangent(a, _), HyperbolicTangent(b, _)) => a == b,
            (Sum(a, b), Sum(c, d)) | (Product(a, b), Product(c, d)) => {
                (a, b) == (c, d) || (a, b) == (d, c)
            }
            _ => self == other,
        }
    }
}

/// An operation, the row of its result, and one that it may use.
#[derive(Debug, Clone, Copy)]
pub(super) struct Instruction {
    pub operation: Operation,
    pub result: usize,
    pub spare: usize,
}

impl Instruction {
    /// The row that it makes beside its result.
    pub fn second_result(self) -> Option<usize> {
        match self.operation {
            Operation::Exponentials(_, row)
            | Operation::Hyperbolic(_, row)
            | Operation::Circular(_, row)
            | Operation::HyperbolicTangent(_, row) => Some(row),
            Operation::Balanced(..) => Some(self.result - 1),
            _ => None,
        }
    }
}

/// The operations of a formula, whose variables stand in the first rows.
#[derive(Debug, Clone)]
pub(super) struct Program {
    instructions: Vec<Instruction>,
    variables: usize,
    rows: usize,
    /// What the formula gives, in the order in which it was asked for.
    pub outputs: Vec<Source>,
    /// The lane of each of these, of those that have but one.
    pub lanes: Vec<usize>,
    /// The row of each variable, and its lane there.
    pub places: Vec<(usize, usize)>,
    /// For each variable whether it is a factor of its own rate.
    pub own_factors: Vec<bool>,
    /// What is carried out at all orders but the first.
    pub later: LaterOrders,
    /// The rows at whose zeros a sign that it takes changes.
    pub kinks: Vec<usize>,
    /// The rows that it takes powers of that are not whole: where one is 0 these have no series.
    pub bases: Vec<usize>,
    /// The rows of square roots: where one is 0 its series goes on with the other sign.
    pub branch_points: Vec<usize>,
    /// Whether it holds only where it was recorded, as the formula asks for values.
    pub branches: bool,
    /// The same in two lanes, once that was asked for: of copies as well.
    #[cfg(target_arch = "x86_64")]
    pub two_lanes: Arc<OnceLock<Option<Program>>>,
}

impl Program {
    /// Nothing yet, in so many variables.
    pub fn empty(variables: usize) -> Self {
        Program {
            instructions: Vec::new(),
            variables,
            rows: variables,
            outputs: Vec::new(),
            lanes: Vec::new(),
            places: (0..variables).map(|i| (i, 0)).collect(),
            own_factors: vec![false; variables],
            later: LaterOrders::default(),
            kinks: Vec::new(),
            bases: Vec::new(),
            branch_points: Vec::new(),
            branches: false,
            #[cfg(target_arch = "x86_64")]
            two_lanes: Arc::default(),
        }
    }

    /// How many variables there are, which have the first rows.
    pub fn variables(&self) -> usize {
        self.variables
    }

    /// A row more.
    pub fn take_row(&mut self) -> usize {
        self.rows += 1;
        self.rows - 1
    }

    /// So many rows more.
    pub fn take_rows(&mut self, count: usize) {
        self.rows += count;
    }

    /// An operation more.
    pub fn push(&mut self, instruction: Instruction) {
        self.instructions.push(instruction);
    }

    /// The operations, in an order in which they can be carried out.
    pub fn instructions(&self) -> &[Instruction] {
        &self.instructions
    }

    /// Puts operations that need the same number of others before them side by side: none of these waits for another, which would
    /// take most of the time. What is carried out at later orders then follows.
    pub fn order(&mut self) {
        let mut depths = vec![0; self.rows];
        for instruction in &self.instructions {
            let operands = instruction.operation.operands().into_iter().flatten();
            let depth = 1 + operands.map(|row| depths[row]).max().unwrap_or(0);
            depths[instruction.result] = depth;
            if let Some(second) = instruction.second_result() {
                depths[second] = depth;
            }
        }
        self.instructions
            .sort_by_key(|instruction| depths[instruction.result]);
        self.later = LaterOrders::of(self);
    }

    /// Those of the operations that the rates of the variables need.
    pub fn of_rates(&self) -> Vec<Instruction> {
        let mut needed = vec![false; self.rows];
        for rate in &self.outputs[..self.variables] {
            if let Source::Row(row) = *rate {
                needed[row] = true;
            }
        }
        let mut found = Vec::new();
        for one in self.instructions.iter().rev() {
            let second = one.second_result().is_some_and(|row| needed[row]);
            if needed[one.result] || second || matches!(one.operation, Operation::Balanced(..)) {
                for row in one.operation.operands().into_iter().flatten() {
                    needed[row] = true;
                }
                found.push(*one);
            }
        }
        found.reverse();
        found
    }

    /// Rows that it takes.
    pub fn rows(&self) -> usize {
        self.rows
    }
}
