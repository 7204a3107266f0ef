//! A recorded formula on power series: one coefficient of all its quantities after the other.
//!
//! What depends on the variables has a row of coefficients; everything else is a number. The recurrences run in loops over the
//! operations ([`super::program_rows`]) instead of compiled one by one: for any number of variables, for numbers of any kind, and no
//! code for each formula.

use super::later::LaterOrders;
use super::trace::{Graph, Node, NodeIndex, Traced};
use crate::number::{Balance, DoubleDouble, Real};

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
    Power(usize, f64),
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
            | Operation::Logarithm(a)
            | Operation::Hyperbolic(a, _)
            | Operation::Circular(a, _)
            | Operation::HyperbolicTangent(a, _)
            | Operation::Power(a, _)
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
            | Operation::Power(a, _)
            | Operation::Over(a, _) => Some(a),
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
            Operation::Hyperbolic(_, row)
            | Operation::Circular(_, row)
            | Operation::HyperbolicTangent(_, row) => Some(row),
            Operation::Balanced(..) => Some(self.result - 1),
            _ => None,
        }
    }
}

/// Rows before that of a balance.
const BALANCE_ROWS: usize = 6;

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
    /// What is carried out at all orders but the first.
    pub later: LaterOrders,
    /// The rows whose signs it takes.
    pub kinks: Vec<usize>,
    /// Whether it holds only where it was recorded, as the formula asks for values.
    pub branches: bool,
}

impl Program {
    /// The operations that these outputs of a formula need, in so many variables; what stands after these has those values.
    pub fn new(
        graph: &Graph,
        (variables, parameters): (usize, &[f64]),
        outputs: &[Traced<'_>],
    ) -> Self {
        let outputs: Vec<NodeIndex> = outputs.iter().map(|&x| graph.place_of(x)).collect();
        let nodes = graph.nodes();
        let mut assembly = Assembly {
            program: Program {
                branches: graph.branches(),
                ..Program::empty(variables)
            },
            sources: Vec::with_capacity(nodes.len()),
            nodes: &nodes,
            parameters,
        };
        let needed = needed(&nodes, &outputs);
        for (place, node) in nodes.iter().enumerate() {
            // A constant, for what nobody asks for.
            let source = if needed[place] {
                assembly.source(*node)
            } else {
                Source::Number(DoubleDouble::ZERO)
            };
            assembly.sources.push(source);
        }
        let mut program = assembly.program;
        program.outputs = outputs.iter().map(|&at| assembly.sources[at]).collect();
        program.lanes = vec![0; program.outputs.len()];
        program.order();
        program
    }

    /// Nothing yet, in so many variables.
    pub fn empty(variables: usize) -> Self {
        Program {
            instructions: Vec::new(),
            variables,
            rows: variables,
            outputs: Vec::new(),
            lanes: Vec::new(),
            places: (0..variables).map(|i| (i, 0)).collect(),
            later: LaterOrders::default(),
            kinks: Vec::new(),
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

    /// An operation more.
    #[cfg(target_arch = "x86_64")]
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

    /// Rows that it takes.
    pub fn rows(&self) -> usize {
        self.rows
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
        self.program.instructions.push(Instruction {
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
                let parameter = i.checked_sub(self.program.variables);
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
                Row(a) => (Op::Power(a, f64::from_bits(p)), true),
                Number(x) => return Number(Real::powf(x, f64::from_bits(p))),
            },
            Node::VariablePower(a, p) => match (at(a), at(p)) {
                (Row(a), Number(p)) if p.lo() == 0.0 => (Op::Power(a, p.hi()), true),
                (Number(x), Number(p)) => return Number(Real::pow(x, p)),
                // Else e^(p ln a).
                (Number(x), Row(p)) => {
                    let exponent = self.made(Op::Scaled(p, Real::ln(x)), false);
                    (Op::Exponential(exponent), true)
                }
                (Row(a), p) => {
                    let log = self.made(Op::Logarithm(a), true);
                    let exponent = match p {
                        Row(p) => Op::Product(p, log),
                        Number(p) => Op::Scaled(log, p),
                    };
                    (Op::Exponential(self.made(exponent, false)), true)
                }
            },
            Node::Sign(a) => match at(a) {
                Row(a) => {
                    self.program.kinks.push(a);
                    (Op::Sign(a), false)
                }
                Number(x) => return Number(Real::sign(x)),
            },
            Node::Signed(a, b) => match (at(a), at(b)) {
                (Row(a), Row(b)) => {
                    self.program.kinks.push(b);
                    (Op::Signed(a, b), false)
                }
                (Row(a), Number(x)) => (Op::Scaled(a, Real::sign(x)), false),
                (Number(x), Row(b)) => {
                    self.program.kinks.push(b);
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
                self.program.rows += BALANCE_ROWS;
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
}
