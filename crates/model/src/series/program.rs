//! A recorded formula on power series: one coefficient of all its quantities after the other.
//!
//! What depends on the variables has a row of coefficients; everything else is a number, which the program knows by its place among its
//! [`Constants`]: it holds at other values of the parameters too. The recurrences run in loops over the
//! operations ([`super::program_rows`]) instead of compiled one by one: for any number of variables, for numbers of any kind, and no
//! code for each formula.

use super::constants::{Constant, Constants};
use super::later::{Later, LaterOrders};
use crate::number::{Balance, DoubleDouble, Ratio};

/// A quantity: a number, or the row of its coefficients.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Source<C = DoubleDouble> {
    Number(C),
    Row(usize),
}

impl<C> Source<C> {
    /// The same with another kind of numbers, of rows that stand elsewhere.
    pub fn map<D>(self, at: impl FnOnce(usize) -> usize, number: impl FnOnce(C) -> D) -> Source<D> {
        match self {
            Source::Number(x) => Source::Number(number(x)),
            Source::Row(row) => Source::Row(at(row)),
        }
    }
}

/// How a row comes from others.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Operation<C = DoubleDouble> {
    /// One lane of a row, in both.
    #[cfg_attr(not(target_arch = "x86_64"), allow(dead_code))]
    Lane(usize, usize),
    Sum(usize, usize),
    Difference(usize, usize),
    Negative(usize),
    /// a + x
    Shifted(usize, C),
    /// x - a
    Complement(C, usize),
    /// a x
    Scaled(usize, C),
    /// a / x
    Over(usize, C),
    Product(usize, usize),
    /// a / b; the spare row holds 1 / b_0
    Quotient(Source<C>, usize),
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
    Power(usize, C),
    /// N(a)/a, or a derivative of it
    Ratio(usize, Ratio),
    Sign(usize),
    Signed(usize, usize),
    /// The y of y + g(y) = a. Before it stand exp y and exp(-y), or sinh y and cosh y, g'(y_0), what the newest coefficients of g count, and g(y); the spare row
    /// holds 1 / (1 + g'(y_0)), then j y_j.
    Balanced(Source<C>, Balance<Source<C>>),
}

impl<C: Copy> Operation<C> {
    /// The rows whose coefficients it needs at the order of its result.
    pub fn operands(self) -> [Option<usize>; 3] {
        let row = |source: Source<C>| match source {
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
    pub fn moved(self, at: impl FnMut(usize) -> usize) -> Self {
        self.map(at, |x| x)
    }

    /// The same of rows that stand elsewhere, with another kind of numbers.
    pub fn map<D>(
        self,
        mut at: impl FnMut(usize) -> usize,
        mut number: impl FnMut(C) -> D,
    ) -> Operation<D> {
        use Operation::*;
        match self {
            Sum(a, b) => Sum(at(a), at(b)),
            Difference(a, b) => Difference(at(a), at(b)),
            Product(a, b) => Product(at(a), at(b)),
            Quotient(a, b) => {
                let a = a.map(&mut at, number);
                Quotient(a, at(b))
            }
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
            Shifted(a, x) => Shifted(at(a), number(x)),
            Complement(x, a) => Complement(number(x), at(a)),
            Scaled(a, x) => Scaled(at(a), number(x)),
            Over(a, x) => Over(at(a), number(x)),
            Exponential(a) => Exponential(at(a)),
            Logarithm(a) => Logarithm(at(a)),
            Power(a, p) => Power(at(a), number(p)),
            Ratio(a, ratio) => Ratio(at(a), ratio),
            Sign(a) => Sign(at(a)),
            Lane(a, lane) => Lane(at(a), lane),
            Balanced(x, g) => {
                let x = x.map(&mut at, &mut number);
                Balanced(x, g.map(|c| c.map(&mut at, &mut number)))
            }
        }
    }
}

#[cfg(target_arch = "x86_64")]
impl Operation<Constant> {
    /// Whether this makes what the other one would, of the same operands; the row that either makes beside its result does not count.
    pub fn is_like(self, other: Self, constants: &mut Constants) -> bool {
        use Operation::*;
        match (self, other) {
            (Balanced(..), _) => false,
            (Hyperbolic(a, _), Hyperbolic(b, _))
            | (Circular(a, _), Circular(b, _))
            | (HyperbolicTangent(a, _), HyperbolicTangent(b, _)) => a == b,
            (Sum(a, b), Sum(c, d)) | (Product(a, b), Product(c, d)) => {
                (a, b) == (c, d) || (a, b) == (d, c)
            }
            (Shifted(a, x), Shifted(b, y))
            | (Complement(x, a), Complement(y, b))
            | (Scaled(a, x), Scaled(b, y))
            | (Over(a, x), Over(b, y))
            | (Power(a, x), Power(b, y))
            | (Quotient(Source::Number(x), a), Quotient(Source::Number(y), b)) => {
                a == b && constants.are_same(x, y)
            }
            _ => self == other,
        }
    }
}

/// An operation, the row of its result, and one that it may use.
#[derive(Debug, Clone, Copy)]
pub(super) struct Instruction<C = DoubleDouble> {
    pub operation: Operation<C>,
    pub result: usize,
    pub spare: usize,
}

impl<C> Instruction<C> {
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
    instructions: Vec<Instruction<Constant>>,
    pub constants: Constants,
    variables: usize,
    rows: usize,
    /// What the formula gives, in the order in which it was asked for.
    pub outputs: Vec<Source<Constant>>,
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
}

impl Program {
    /// Nothing yet, in so many variables and of these constants.
    pub fn empty(variables: usize, constants: Constants) -> Self {
        Program {
            instructions: Vec::new(),
            constants,
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
    pub fn push(&mut self, instruction: Instruction<Constant>) {
        self.instructions.push(instruction);
    }

    /// The operations, in an order in which they can be carried out.
    pub fn instructions(&self) -> &[Instruction<Constant>] {
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
        let mut constants = std::mem::take(&mut self.constants);
        self.later = LaterOrders::of(self, &mut constants);
        self.constants = constants;
    }

    /// Whether parameters are part of the constants of an operation.
    pub fn varies(&self, operation: Operation<Constant>) -> bool {
        let mut varies = false;
        operation.map(|row| row, |x| varies |= self.constants.varies(x));
        varies
    }

    /// The same of what is carried out at later orders.
    pub fn varies_later(&self, later: &Later) -> bool {
        match later {
            Later::Sum { from, to, .. } => {
                let mut terms = self.later.terms[*from..*to].iter();
                terms.any(|term| self.constants.varies(term.factor))
            }
            Later::Other(one, multiple) => {
                self.varies(one.operation) || self.constants.varies(multiple.factor)
            }
        }
    }

    /// An output, with its value where it is a number.
    pub fn output(&self, i: usize) -> Source {
        self.outputs[i].map(|row| row, |x| self.constants.value(x))
    }

    /// The places of those of the operations that the rates of the variables need.
    pub fn of_rates(&self) -> Vec<usize> {
        let mut needed = vec![false; self.rows];
        for rate in &self.outputs[..self.variables] {
            if let Source::Row(row) = *rate {
                needed[row] = true;
            }
        }
        let mut found = Vec::new();
        for (place, one) in self.instructions.iter().enumerate().rev() {
            let second = one.second_result().is_some_and(|row| needed[row]);
            if needed[one.result] || second || matches!(one.operation, Operation::Balanced(..)) {
                for row in one.operation.operands().into_iter().flatten() {
                    needed[row] = true;
                }
                found.push(place);
            }
        }
        found.reverse();
        found
    }

    /// Whether the variables of a row are counted relative to their size alone, as one of them is a factor of its own rate.
    pub fn relative(&self) -> Vec<bool> {
        let mut relative = vec![false; self.variables];
        for (&(row, _), &factor) in self.places.iter().zip(&self.own_factors) {
            relative[row] |= factor;
        }
        relative
    }

    /// Rows that it takes.
    pub fn rows(&self) -> usize {
        self.rows
    }
}
