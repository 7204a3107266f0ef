//! The constants of a program: what is made of the parameters alone, and what the program decides by it.
//!
//! At other values of the parameters the constants are made anew and the program stays, as long as it would decide the same.

use super::trace::{Node, NodeBalance, NodeIndex};
use crate::number::{DoubleDouble, Real};

/// A constant by its place: that of its node among those of the formula, or one after all of these.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Constant(NodeIndex);

/// The constants, at values of the parameters.
#[derive(Debug, Clone, Default)]
pub(super) struct Constants {
    values: Vec<DoubleDouble>,
    /// Whether a parameter is part of each.
    vary: Vec<bool>,
    /// The places of those that parameters are part of, in order, and how they are made of those before them.
    varying: Vec<(NodeIndex, Node)>,
    /// The same of balances, each of which gives two constants.
    balances: Vec<(NodeIndex, Node)>,
    /// Parameters are the variables after so many.
    variables: usize,
    parameters: Vec<f64>,
    decisions: Vec<Decision>,
    /// The places before those of 1 and -1.
    nodes: usize,
}

/// What was asked of constants, and the answer.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Decision {
    IsZero(Constant, bool),
    IsDouble(Constant, bool),
    AreSame([Constant; 2], bool),
    Exponent(Constant, Exponent),
}

/// What an exponent makes of a power.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Exponent {
    /// Products.
    Whole(i32),
    /// An odd power of a square root.
    OfRoot,
    Other,
}

impl Exponent {
    /// Whole ones are those of at most 64: larger powers are left as they are.
    fn of(p: DoubleDouble) -> Self {
        const MOST: f64 = 64.0;
        let twice = 2.0 * p.hi();
        if p.lo() != 0.0 {
            Exponent::Other
        } else if p.hi().fract() == 0.0 && p.hi().abs() <= MOST {
            Exponent::Whole(p.hi() as i32)
        } else if twice > 0.0 && twice % 2.0 == 1.0 {
            Exponent::OfRoot
        } else {
            Exponent::Other
        }
    }
}

impl Constants {
    /// Of a formula of so many nodes, none of which is asked for yet; the variables that stand after so many are the parameters.
    pub fn new(nodes: usize, variables: usize, parameters: &[f64]) -> Self {
        let mut values = vec![DoubleDouble::ZERO; nodes];
        values.extend([DoubleDouble::ONE, -DoubleDouble::ONE]);
        Constants {
            nodes,
            vary: vec![false; values.len()],
            values,
            variables,
            parameters: parameters.to_vec(),
            ..Constants::default()
        }
    }

    /// That of a node that is asked for, whose operands are constants.
    pub fn of_node(&mut self, place: NodeIndex, node: Node) -> Constant {
        if matches!(node, Node::Balanced(..)) {
            self.balances.push((place, node));
        }
        let mut operands = node.operands().into_iter().flatten();
        let varies = matches!(node, Node::Variable(_)) || operands.any(|at| self.vary[at]);
        if varies {
            self.varying.push((place, node));
        }
        self.vary[place] = varies;
        self.values[place] = self.evaluated(node);
        Constant(place)
    }

    /// That of a node that nobody asks for.
    pub fn unasked(place: NodeIndex) -> Constant {
        Constant(place)
    }

    pub fn value(&self, constant: Constant) -> DoubleDouble {
        self.values[constant.0]
    }

    /// Whether a parameter is part of it.
    pub fn varies(&self, constant: Constant) -> bool {
        self.vary[constant.0]
    }

    /// Whether they are those at these values of the parameters.
    pub fn are_at(&self, parameters: &[f64]) -> bool {
        let bits = |x: &f64| x.to_bits();
        self.parameters
            .iter()
            .map(bits)
            .eq(parameters.iter().map(bits))
    }

    /// Makes them at these values. Returns whether what was decided by them still holds.
    pub fn set(&mut self, parameters: &[f64]) -> bool {
        // Others may stand after those that the formula names.
        self.parameters.clear();
        self.parameters.extend(parameters);
        for at in 0..self.varying.len() {
            let (place, node) = self.varying[at];
            self.values[place] = self.evaluated(node);
        }
        self.decisions.iter().all(|&decision| match decision {
            Decision::IsZero(a, was) => (self.value(a) == DoubleDouble::ZERO) == was,
            Decision::IsDouble(a, was) => (self.value(a).lo() == 0.0) == was,
            Decision::AreSame([a, b], was) => (self.value(a) == self.value(b)) == was,
            Decision::Exponent(a, was) => Exponent::of(self.value(a)) == was,
        })
    }

    pub fn is_zero(&mut self, a: Constant) -> bool {
        let is_zero = self.value(a) == DoubleDouble::ZERO;
        self.decide(self.varies(a), Decision::IsZero(a, is_zero));
        is_zero
    }

    pub fn is_double(&mut self, a: Constant) -> bool {
        let is_double = self.value(a).lo() == 0.0;
        self.decide(self.varies(a), Decision::IsDouble(a, is_double));
        is_double
    }

    pub fn are_same(&mut self, a: Constant, b: Constant) -> bool {
        let are_same = self.value(a) == self.value(b);
        let vary = self.varies(a) || self.varies(b);
        self.decide(vary, Decision::AreSame([a, b], are_same));
        are_same
    }

    pub fn exponent(&mut self, a: Constant) -> Exponent {
        let exponent = Exponent::of(self.value(a));
        self.decide(self.varies(a), Decision::Exponent(a, exponent));
        exponent
    }

    fn decide(&mut self, varies: bool, decision: Decision) {
        if varies && !self.decisions.contains(&decision) {
            self.decisions.push(decision);
        }
    }

    pub fn one(&self) -> Constant {
        Constant(self.nodes)
    }

    pub fn minus_one(&self) -> Constant {
        Constant(self.nodes + 1)
    }

    pub fn number(&mut self, x: f64) -> Constant {
        self.more(Node::Constant(x.to_bits(), 0.0_f64.to_bits()))
    }

    pub fn negative(&mut self, a: Constant) -> Constant {
        self.more(Node::Negative(a.0))
    }

    pub fn sum(&mut self, a: Constant, b: Constant) -> Constant {
        self.more(Node::Sum(a.0, b.0))
    }

    pub fn product(&mut self, a: Constant, b: Constant) -> Constant {
        self.more(Node::Product(a.0, b.0))
    }

    pub fn quotient(&mut self, a: Constant, b: Constant) -> Constant {
        self.more(Node::Quotient(a.0, b.0))
    }

    pub fn logarithm(&mut self, a: Constant) -> Constant {
        self.more(Node::Logarithm(a.0))
    }

    pub fn sign(&mut self, a: Constant) -> Constant {
        self.more(Node::Sign(a.0))
    }

    /// What is no node of the formula.
    fn more(&mut self, node: Node) -> Constant {
        let place = self.values.len();
        self.values.push(DoubleDouble::ZERO);
        self.vary.push(false);
        self.of_node(place, node)
    }

    fn evaluated(&self, node: Node) -> DoubleDouble {
        let at = |place: NodeIndex| self.values[place];
        match node {
            Node::Variable(i) => self.parameters[i - self.variables].into(),
            Node::Constant(hi, lo) => DoubleDouble::new(f64::from_bits(hi), f64::from_bits(lo)),
            Node::Sum(a, b) => at(a) + at(b),
            Node::Difference(a, b) => at(a) - at(b),
            Node::Negative(a) => -at(a),
            Node::Product(a, b) => at(a) * at(b),
            Node::Quotient(a, b) => at(a) / at(b),
            Node::Exponential(a) => Real::exp(at(a)),
            Node::ExponentialLessOne(a, _) => Real::exp_m1(at(a)),
            Node::Logarithm(a) => Real::ln(at(a)),
            Node::LogarithmOfOneMore(a, _) => Real::ln_1p(at(a)),
            Node::Sinh(a) => at(a).sinh(),
            Node::Cosh(a, _) => at(a).cosh(),
            Node::Sin(a) => Real::sin_cos(at(a)).0,
            Node::Cos(a, _) => Real::sin_cos(at(a)).1,
            Node::Arctangent(a, _) => Real::atan(at(a)),
            Node::HyperbolicTangent(a) => Real::tanh(at(a)),
            Node::InverseHyperbolicSine(a, _) => Real::asinh(at(a)),
            Node::Power(a, p) => Real::powf(at(a), f64::from_bits(p)),
            Node::VariablePower(a, p) => Real::pow(at(a), at(p)),
            Node::Ratio(a, ratio) => Real::ratio(at(a), ratio),
            Node::Sign(a) => Real::sign(at(a)),
            Node::Signed(a, b) => at(a) * Real::sign(at(b)),
            Node::Balanced(a, g) => Real::balanced(at(a), g.of(at)).0,
            Node::OfBalanced(y) => match self.balances.iter().find(|(place, _)| *place == y) {
                Some(&(_, Node::Balanced(a, g))) => Real::balanced(at(a), g.of(at)).1,
                _ => unreachable!("of a balance"),
            },
        }
    }
}

impl Node {
    /// What it is made of: of a function of two results, of that of the first one too.
    pub fn operands(self) -> [Option<NodeIndex>; 3] {
        match self {
            Node::Variable(_) | Node::Constant(..) => [None; 3],
            Node::Negative(a)
            | Node::Exponential(a)
            | Node::Logarithm(a)
            | Node::Sinh(a)
            | Node::Sin(a)
            | Node::HyperbolicTangent(a)
            | Node::Power(a, _)
            | Node::Ratio(a, _)
            | Node::OfBalanced(a)
            | Node::Sign(a) => [Some(a), None, None],
            Node::Balanced(a, NodeBalance::Exponential(b) | NodeBalance::Sinh(b))
            | Node::Sum(a, b)
            | Node::Difference(a, b)
            | Node::Product(a, b)
            | Node::Quotient(a, b)
            | Node::ExponentialLessOne(a, b)
            | Node::LogarithmOfOneMore(a, b)
            | Node::Cosh(a, b)
            | Node::Cos(a, b)
            | Node::Arctangent(a, b)
            | Node::InverseHyperbolicSine(a, b)
            | Node::VariablePower(a, b)
            | Node::Signed(a, b) => [Some(a), Some(b), None],
            Node::Balanced(a, NodeBalance::Difference(b, c)) => [Some(a), Some(b), Some(c)],
        }
    }
}
