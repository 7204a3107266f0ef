//! From a recorded formula to the operations of its [`Program`] at values of its parameters.

use super::constants::{Constant, Constants, Exponent};
use super::program::{Instruction, Operation, Program, Source};
use super::trace::{Graph, Node, NodeIndex, Traced};

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
        let constants = Constants::new(self.nodes.len(), self.variables, parameters);
        let mut program = Program::empty(self.variables, constants);
        program.branches = self.branches;
        let mut assembly = Assembly {
            program,
            sources: Vec::with_capacity(self.nodes.len()),
        };
        for (place, (node, needed)) in self.nodes.iter().zip(&self.needed).enumerate() {
            let source = if !needed {
                Source::Number(Constants::unasked(place))
            } else if assembly.is_constant(*node) {
                Source::Number(assembly.program.constants.of_node(place, *node))
            } else {
                assembly.source(*node)
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
        let operands = nodes[place].operands().into_iter().flatten();
        operands.for_each(|at| needed[at] = true);
    }
    needed
}

/// A program on its way.
struct Assembly {
    program: Program,
    sources: Vec<Source<Constant>>,
}

impl Assembly {
    /// Whether a node is made of the parameters alone.
    fn is_constant(&self, node: Node) -> bool {
        if let Node::Variable(i) = node {
            return i >= self.program.variables();
        }
        let mut operands = node.operands().into_iter().flatten();
        operands.all(|at| matches!(self.sources[at], Source::Number(_)))
    }

    fn row(&mut self) -> usize {
        self.program.take_row()
    }

    /// The row that an operation makes.
    fn made(&mut self, operation: Operation<Constant>, spare: bool) -> usize {
        let result = self.row();
        let spare = if spare { self.row() } else { result };
        self.program.push(Instruction {
            operation,
            result,
            spare,
        });
        result
    }

    /// What a node is that a variable is part of.
    fn source(&mut self, node: Node) -> Source<Constant> {
        use Operation as Op;
        use Source::{Number, Row};
        let at = |place: NodeIndex| self.sources[place];
        let row = |place: NodeIndex| match self.sources[place] {
            Row(row) => row,
            Number(_) => unreachable!("it varies as what is made of it does"),
        };
        let (operation, spare) = match node {
            Node::Variable(i) => return Row(i),
            Node::Constant(..) => unreachable!("a constant"),
            Node::Sum(a, b) => match (at(a), at(b)) {
                (Row(a), Row(b)) => (Op::Sum(a, b), false),
                (Row(a), Number(x)) | (Number(x), Row(a)) => (Op::Shifted(a, x), false),
                (Number(_), Number(_)) => unreachable!("a constant"),
            },
            Node::Difference(a, b) => match (at(a), at(b)) {
                (Row(a), Row(b)) => (Op::Difference(a, b), false),
                (Row(a), Number(x)) => (Op::Shifted(a, self.constants().negative(x)), false),
                (Number(x), Row(a)) => (Op::Complement(x, a), false),
                (Number(_), Number(_)) => unreachable!("a constant"),
            },
            Node::Product(a, b) => match (at(a), at(b)) {
                (Row(a), Row(b)) => (Op::Product(a, b), false),
                (Row(a), Number(x)) | (Number(x), Row(a)) => {
                    // As p x^(p-1) of p = 0, also where x is 0.
                    if self.constants().is_zero(x) {
                        return Number(x);
                    }
                    (Op::Scaled(a, x), false)
                }
                (Number(_), Number(_)) => unreachable!("a constant"),
            },
            Node::Quotient(a, b) => match (at(a), at(b)) {
                (a, Row(b)) => (Op::Quotient(a, b), true),
                (Row(a), Number(x)) => (Op::Over(a, x), false),
                (Number(_), Number(_)) => unreachable!("a constant"),
            },
            Node::Negative(a) => (Op::Negative(row(a)), false),
            Node::Exponential(a) => (Op::Exponential(row(a)), true),
            Node::ExponentialLessOne(a, whole) => {
                (Op::ExponentialLessOne(row(a), row(whole)), false)
            }
            Node::Logarithm(a) => (Op::Logarithm(row(a)), true),
            Node::LogarithmOfOneMore(a, whole) => {
                (Op::LogarithmOfOneMore(row(a), row(whole)), false)
            }
            Node::Sinh(a) => {
                let (a, cosh) = (row(a), self.row());
                (Op::Hyperbolic(a, cosh), true)
            }
            // As that of sinh took it, and that of sin.
            Node::Cosh(_, sinh) => return Row(row(sinh) - 1),
            Node::Sin(a) => {
                let (a, cos) = (row(a), self.row());
                (Op::Circular(a, cos), true)
            }
            Node::Cos(_, sin) => return Row(row(sin) - 1),
            Node::Arctangent(a, u) => (Op::Arctangent(row(a), row(u)), true),
            Node::InverseHyperbolicSine(a, u) => (Op::InverseHyperbolicSine(row(a), row(u)), true),
            Node::HyperbolicTangent(a) => {
                let (a, slope) = (row(a), self.row());
                (Op::HyperbolicTangent(a, slope), true)
            }
            Node::Power(a, p) => {
                let a = row(a);
                let p = self.constants().number(f64::from_bits(p));
                return self.power(a, p);
            }
            Node::VariablePower(a, p) => match (at(a), at(p)) {
                (Row(a), Number(p)) => return self.power(a, p),
                // Else e^(p ln a).
                (Number(x), Row(p)) => {
                    let log = self.constants().logarithm(x);
                    let exponent = self.made(Op::Scaled(p, log), false);
                    (Op::Exponential(exponent), true)
                }
                (Row(a), Row(p)) => {
                    let log = self.made(Op::Logarithm(a), true);
                    let exponent = self.made(Op::Product(p, log), false);
                    (Op::Exponential(exponent), true)
                }
                (Number(_), Number(_)) => unreachable!("a constant"),
            },
            Node::Ratio(a, ratio) => (Op::Ratio(row(a), ratio), false),
            Node::Sign(a) => {
                let a = row(a);
                self.watch_sign_of(a);
                (Op::Sign(a), false)
            }
            Node::Signed(a, b) => match (at(a), at(b)) {
                (Row(a), Row(b)) => {
                    self.watch_sign_of(b);
                    (Op::Signed(a, b), false)
                }
                (Row(a), Number(x)) => (Op::Scaled(a, self.constants().sign(x)), false),
                (Number(x), Row(b)) => {
                    self.watch_sign_of(b);
                    (Op::Scaled(self.made(Op::Sign(b), false), x), false)
                }
                (Number(_), Number(_)) => unreachable!("a constant"),
            },
            Node::Balanced(a, g) => {
                let (a, g) = (at(a), g.of(at));
                self.program.take_rows(BALANCE_ROWS);
                (Op::Balanced(a, g), true)
            }
            // As that of y took it.
            Node::OfBalanced(y) => return Row(row(y) - 1),
        };
        Row(self.made(operation, spare))
    }

    fn constants(&mut self) -> &mut Constants {
        &mut self.program.constants
    }

    /// a^p. Whole powers are products: they have series where a is 0 or negative.
    fn power(&mut self, a: usize, p: Constant) -> Source<Constant> {
        let exponent = self.constants().exponent(p);
        let Exponent::Whole(whole) = exponent else {
            let made = self.made(Operation::Power(a, p), true);
            self.program.bases.push(a);
            if exponent == Exponent::OfRoot {
                self.program.branch_points.push(made);
            }
            return Source::Row(made);
        };
        let (mut rest, mut square, mut power) = (whole.unsigned_abs(), a, None);
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
        let one = Source::Number(self.constants().one());
        match power {
            None => one,
            Some(power) if whole > 0 => Source::Row(power),
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
