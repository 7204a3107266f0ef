//! From a recorded formula to the operations of its [`Program`] at values of its parameters.

use super::program::{Instruction, Operation, Program, Source};
use super::trace::{Graph, Node, NodeIndex, Traced};
use crate::number::{DoubleDouble, Real};

/// Rows before that of a balance.
const BALANCE_ROWS: usize = 6;

/// A formula with parameters as it was recorded.
pub(super) struct RecordedFormula {
    nodes: Vec<Node>,
    /// Whether it needs each of them.
    needed: Vec<bool>,
    outputs: Vec<NodeIndex>,
    variables: usize,
    branches: bool,
}

impl RecordedFormula {
    /// These outputs in so many variables; the variables that stand after these are the parameters.
    pub fn new(graph: &Graph, variables: usize, outputs: &[Traced<'_>]) -> Self {
        let outputs: Vec<NodeIndex> = outputs.iter().map(|&x| graph.place_of(x)).collect();
        let nodes = graph.nodes();
        RecordedFormula {
            needed: needed(&nodes, &outputs),
            nodes,
            outputs,
            variables,
            branches: graph.branches(),
        }
    }

    /// The operations that the outputs need at these values of the parameters.
    pub fn program(&self, parameters: &[f64]) -> Program {
        let mut program = Program::empty(self.variables);
        program.branches = self.branches;
        let mut assembly = Assembly {
            program,
            sources: Vec::with_capacity(self.nodes.len()),
            nodes: &self.nodes,
            parameters,
        };
        for (node, needed) in self.nodes.iter().zip(&self.needed) {
            // A constant, for what nobody asks for.
            let source = if *needed {
                assembly.source(*node)
            } else {
                Source::Number(DoubleDouble::ZERO)
            };
            assembly.sources.push(source);
        }
        let mut program = assembly.program;
        let outputs = self.outputs.iter();
        program.outputs = outputs.map(|&at| assembly.sources[at]).collect();
        program.lanes = vec![0; program.outputs.len()];
        program.order();
        program
    }
}

/// Whether a node is needed, for each.
fn needed(nodes: &[Node], outputs: &[NodeIndex]) -> Vec<bool> {
    let mut needed = vec![false; nodes.len()];
    outputs.iter().for_each(|&at| needed[at] = true);
    for place in (0..nodes.len()).rev() {
        // sinh and cosh are made together, and so are sin and cos.
        if let Node::Cosh(_, first) | Node::Cos(_, first) = nodes[place] {
            needed[place] |= needed[first];
        }
        if !needed[place] {
            continue;
        }
        match nodes[place] {
            Node::Variable(_) | Node::Constant(..) => {}
            Node::Negative(a)
            | Node::Exponential(a)
            | Node::Logarithm(a)
            | Node::Sinh(a)
            | Node::Sin(a)
            | Node::HyperbolicTangent(a)
            | Node::Power(a, _)
            | Node::Ratio(a, _)
            | Node::OfBalanced(a)
            | Node::Sign(a) => needed[a] = true,
            Node::Balanced(a, g) => {
                needed[a] = true;
                g.of(|at| at).map(|at| needed[at] = true);
            }
            Node::Sum(a, b)
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
            | Node::Signed(a, b) => {
                needed[a] = true;
                needed[b] = true;
            }
        }
    }
    needed
}

/// A program on its way.
struct Assembly<'a> {
    program: Program,
    sources: Vec<Source>,
    nodes: &'a [Node],
    parameters: &'a [f64],
}

impl Assembly<'_> {
    fn row(&mut self) -> usize {
        self.program.take_row()
    }

    /// The row that an operation makes.
    fn made(&mut self, operation: Operation, spare: bool) -> usize {
        let result = self.row();
        let spare = if spare { self.row() } else { result };
        self.program.push(Instruction {
            operation,
            result,
            spare,
        });
        result
    }

    fn source(&mut self, node: Node) -> Source {
        use Operation as Op;
        use Source::{Number, Row};
        let at = |place: NodeIndex| self.sources[place];
        let (operation, spare) = match node {
            Node::Variable(i) => {
                let parameter = i.checked_sub(self.program.variables());
                return parameter.map_or(Row(i), |q| Number(self.parameters[q].into()));
            }
            Node::Constant(hi, lo) => {
                return Number(DoubleDouble::new(f64::from_bits(hi), f64::from_bits(lo)));
            }
            Node::Sum(a, b) => match (at(a), at(b)) {
                (Row(a), Row(b)) => (Op::Sum(a, b), false),
                (Row(a), Number(x)) | (Number(x), Row(a)) => (Op::Shifted(a, x), false),
                (Number(x), Number(y)) => return Number(x + y),
            },
            Node::Difference(a, b) => match (at(a), at(b)) {
                (Row(a), Row(b)) => (Op::Difference(a, b), false),
                (Row(a), Number(x)) => (Op::Shifted(a, -x), false),
                (Number(x), Row(a)) => (Op::Complement(x, a), false),
                (Number(x), Number(y)) => return Number(x - y),
            },
            Node::Product(a, b) => match (at(a), at(b)) {
                (Row(a), Row(b)) => (Op::Product(a, b), false),
                // As p x^(p-1) of p = 0, also where x is 0.
                (Row(_), Number(x)) | (Number(x), Row(_)) if x == DoubleDouble::ZERO => {
                    return Number(x);
                }
                (Row(a), Number(x)) | (Number(x), Row(a)) => (Op::Scaled(a, x), false),
                (Number(x), Number(y)) => return Number(x * y),
            },
            Node::Quotient(a, b) => match (at(a), at(b)) {
                (a, Row(b)) => (Op::Quotient(a, b), true),
                (Row(a), Number(x)) => (Op::Over(a, x), false),
                (Number(x), Number(y)) => return Number(x / y),
            },
            Node::Negative(a) => match at(a) {
                Row(a) => (Op::Negative(a), false),
                Number(x) => return Number(-x),
            },
            Node::Exponential(a) => match at(a) {
                Row(a) => (Op::Exponential(a), true),
                Number(x) => return Number(Real::exp(x)),
            },
            Node::ExponentialLessOne(a, whole) => match (at(a), at(whole)) {
                (Row(a), Row(whole)) => (Op::ExponentialLessOne(a, whole), false),
                (Number(x), _) => return Number(Real::exp_m1(x)),
                _ => unreachable!("e^a is as constant as a"),
            },
            Node::Logarithm(a) => match at(a) {
                Row(a) => (Op::Logarithm(a), true),
                Number(x) => return Number(Real::ln(x)),
            },
            Node::LogarithmOfOneMore(a, whole) => match (at(a), at(whole)) {
                (Row(a), Row(whole)) => (Op::LogarithmOfOneMore(a, whole), false),
                (Number(x), _) => return Number(Real::ln_1p(x)),
                _ => unreachable!("ln(1 + a) is as constant as a"),
            },
            Node::Sinh(a) => match at(a) {
                Row(a) => {
                    let cosh = self.row();
                    (Op::Hyperbolic(a, cosh), true)
                }
                Number(x) => return Number(x.sinh()),
            },
            Node::Cosh(a, sinh) => match (at(a), at(sinh)) {
                // As that of sinh took it.
                (Row(_), Row(sinh)) => return Row(sinh - 1),
                (Number(x), _) => return Number(x.cosh()),
                _ => unreachable!("sinh a is as constant as a"),
            },
            Node::Sin(a) => match at(a) {
                Row(a) => {
                    let cos = self.row();
                    (Op::Circular(a, cos), true)
                }
                Number(x) => return Number(Real::sin_cos(x).0),
            },
            Node::Cos(a, sin) => match (at(a), at(sin)) {
                (Row(_), Row(sin)) => return Row(sin - 1),
                (Number(x), _) => return Number(Real::sin_cos(x).1),
                _ => unreachable!("sin a is as constant as a"),
            },
            Node::Arctangent(a, u) => match (at(a), at(u)) {
                (Row(a), Row(u)) => (Op::Arctangent(a, u), true),
                (Number(x), _) => return Number(Real::atan(x)),
                _ => unreachable!("1 + a^2 is as constant as a"),
            },
            Node::InverseHyperbolicSine(a, u) => match (at(a), at(u)) {
                (Row(a), Row(u)) => (Op::InverseHyperbolicSine(a, u), true),
                (Number(x), _) => return Number(Real::asinh(x)),
                _ => unreachable!("1 + a^2 is as constant as a"),
            },
            Node::HyperbolicTangent(a) => match at(a) {
                Row(a) => {
                    let slope = self.row();
                    (Op::HyperbolicTangent(a, slope), true)
                }
                Number(x) => return Number(Real::tanh(x)),
            },
            Node::Power(a, p) => match at(a) {
                Row(a) => return self.power(a, f64::from_bits(p).into()),
                Number(x) => return Number(Real::powf(x, f64::from_bits(p))),
            },
            Node::VariablePower(a, p) => match (at(a), at(p)) {
                (Row(a), Number(p)) => return self.power(a, p),
                (Number(x), Number(p)) => return Number(Real::pow(x, p)),
                // Else e^(p ln a).
                (Number(x), Row(p)) => {
                    let exponent = self.made(Op::Scaled(p, Real::ln(x)), false);
                    (Op::Exponential(exponent), true)
                }
                (Row(a), Row(p)) => {
                    let log = self.made(Op::Logarithm(a), true);
                    let exponent = self.made(Op::Product(p, log), false);
                    (Op::Exponential(exponent), true)
                }
            },
            Node::Ratio(a, ratio) => match at(a) {
                Row(a) => (Op::Ratio(a, ratio), false),
                Number(x) => return Number(Real::ratio(x, ratio)),
            },
            Node::Sign(a) => match at(a) {
                Row(a) => {
                    self.watch_sign_of(a);
                    (Op::Sign(a), false)
                }
                Number(x) => return Number(Real::sign(x)),
            },
            Node::Signed(a, b) => match (at(a), at(b)) {
                (Row(a), Row(b)) => {
                    self.watch_sign_of(b);
                    (Op::Signed(a, b), false)
                }
                (Row(a), Number(x)) => (Op::Scaled(a, Real::sign(x)), false),
                (Number(x), Row(b)) => {
                    self.watch_sign_of(b);
                    (Op::Scaled(self.made(Op::Sign(b), false), x), false)
                }
                (Number(x), Number(y)) => return Number(x * Real::sign(y)),
            },
            Node::Balanced(a, g) => {
                let (a, g) = (at(a), g.of(at));
                let mut varies = matches!(a, Row(_));
                g.map(|c| varies |= matches!(c, Row(_)));
                if !varies {
                    let number = |x: Source| match x {
                        Number(x) => x,
                        Row(_) => unreachable!("constants"),
                    };
                    return Number(Real::balanced(number(a), g.map(number)).0);
                }
                self.program.take_rows(BALANCE_ROWS);
                (Op::Balanced(a, g), true)
            }
            Node::OfBalanced(y) => match (at(y), self.nodes[y]) {
                // As that of y took it.
                (Row(y), _) => return Row(y - 1),
                (Number(_), Node::Balanced(a, g)) => match (at(a), g.of(at)) {
                    (Number(a), g) => {
                        let number = |x: Source| match x {
                            Number(x) => x,
                            Row(_) => unreachable!("constants"),
                        };
                        return Number(Real::balanced(a, g.map(number)).1);
                    }
                    _ => unreachable!("constants"),
                },
                _ => unreachable!("of a balance"),
            },
        };
        Row(self.made(operation, spare))
    }

    /// a^p. Whole powers are products: they have series where a is 0 or negative.
    fn power(&mut self, a: usize, p: DoubleDouble) -> Source {
        /// Larger ones are left as they are.
        const MOST: f64 = 64.0;
        if p.lo() != 0.0 || p.hi().fract() != 0.0 || p.hi().abs() > MOST {
            let made = self.made(Operation::Power(a, p), true);
            self.program.bases.push(a);
            if is_of_root(p) {
                self.program.branch_points.push(made);
            }
            return Source::Row(made);
        }
        let (mut rest, mut square, mut power) = (p.hi().abs() as u32, a, None);
        while rest > 0 {
            if rest & 1 == 1 {
                power = Some(match power {
                    None => square,
                    Some(power) => self.made(Operation::Product(power, square), false),
                });
            }
            rest >>= 1;
            if rest > 0 {
                square = self.made(Operation::Product(square, square), false);
            }
        }
        let one = Source::Number(1.0.into());
        match power {
            None => one,
            Some(power) if p.hi() > 0.0 => Source::Row(power),
            Some(power) => Source::Row(self.made(Operation::Quotient(one, power), true)),
        }
    }

    /// Adds the rows at whose zeros this row changes sign to the kinks: of a product those of its factors, of an odd function that of its
    /// argument. Their series vary less within a step, so that most often a bound says that there is no zero.
    fn watch_sign_of(&mut self, row: usize) {
        use Operation::*;
        let made = self
            .program
            .instructions()
            .iter()
            .find(|one| one.result == row);
        match made.map(|one| one.operation) {
            Some(Product(a, b) | Quotient(Source::Row(a), b)) => {
                self.watch_sign_of(a);
                self.watch_sign_of(b);
            }
            Some(
                Quotient(Source::Number(_), a)
                | Scaled(a, _)
                | Over(a, _)
                | Negative(a)
                | Hyperbolic(a, _)
                | HyperbolicTangent(a, _)
                | Arctangent(a, _)
                | InverseHyperbolicSine(a, _)
                | ExponentialLessOne(a, _)
                | LogarithmOfOneMore(a, _),
            ) => self.watch_sign_of(a),
            Some(Exponential(_) | Power(..)) => {}
            _ if self.program.kinks.contains(&row) => {}
            _ => self.program.kinks.push(row),
        }
    }
}

/// Whether a^p is an odd power of the square root of a.
fn is_of_root(p: DoubleDouble) -> bool {
    let twice = 2.0 * p.hi();
    p.lo() == 0.0 && twice > 0.0 && twice % 2.0 == 1.0
}
