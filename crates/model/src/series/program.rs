//! A recorded formula on power series: one coefficient of all its quantities after the other.
//!
//! What depends on the variables has a row of coefficients; everything else is a number. The recurrences are those of
//! [`super::tape`], in loops over the operations instead of compiled one by one: for any number of variables, for numbers of
//! any kind, and no code for each formula.

use super::element::Element;
use super::trace::{Graph, Node, NodeIndex, Traced};
use crate::number::{DoubleDouble, Real};

/// A quantity: a number, or the row of its coefficients.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Source {
    Number(DoubleDouble),
    Row(usize),
}

/// How a row comes from others.
#[derive(Debug, Clone, Copy)]
enum Operation {
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
}

/// An operation, the row of its result, and one that it may use.
#[derive(Debug, Clone, Copy)]
struct Instruction {
    operation: Operation,
    result: usize,
    spare: usize,
}

/// The operations of a formula, whose variables stand in the first rows.
#[derive(Debug, Clone)]
pub(super) struct Program {
    instructions: Vec<Instruction>,
    variables: usize,
    rows: usize,
    /// What the formula gives, in the order in which it was asked for.
    pub outputs: Vec<Source>,
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
                instructions: Vec::with_capacity(nodes.len()),
                variables,
                rows: variables,
                outputs: Vec::new(),
                kinks: Vec::new(),
                branches: graph.branches(),
            },
            sources: Vec::with_capacity(nodes.len()),
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
        program
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
            | Node::Sign(a) => needed[a] = true,
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
    parameters: &'a [f64],
}

impl Assembly<'_> {
    fn row(&mut self) -> usize {
        self.program.rows += 1;
        self.program.rows - 1
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
        };
        Row(self.made(operation, spare))
    }
}

/// The rows of a program: the coefficients of each, one after the other.
#[derive(Debug, Clone)]
pub(super) struct ProgramRows<T> {
    coefficients: Vec<T>,
    /// Coefficients that a row has room for.
    room: usize,
    /// 1/k for every order k.
    inverses: Vec<DoubleDouble>,
    any: T,
}

impl<T: Element> ProgramRows<T> {
    /// With room for these; `any` is any number.
    pub fn new(program: &Program, room: usize, any: T) -> Self {
        ProgramRows {
            coefficients: vec![any.like(0.0); program.rows() * room],
            room,
            inverses: (0..room)
                .map(|k| DoubleDouble::from(1.0) / k as f64)
                .collect(),
            any,
        }
    }

    /// 1/k
    pub fn one_over(&self, k: usize) -> DoubleDouble {
        self.inverses[k]
    }

    /// The coefficients of a row.
    pub fn row(&self, row: usize) -> &[T] {
        &self.coefficients[row * self.room..][..self.room]
    }

    /// Puts down the k-th coefficient of a row.
    pub fn set(&mut self, row: usize, k: usize, x: T) {
        self.coefficients[row * self.room + k] = x;
    }

    fn get(&self, row: usize, k: usize) -> T {
        self.coefficients[row * self.room + k]
    }

    /// The k-th coefficient of a quantity.
    pub fn coefficient(&self, of: Source, k: usize) -> T {
        match of {
            Source::Row(row) => self.get(row, k),
            Source::Number(x) if k == 0 => self.any.like_exact(x),
            Source::Number(_) => self.any.like(0.0),
        }
    }

    /// sum of a_j b_(k-j) over `from` <= j < `to`.
    fn convolution(&self, a: usize, b: usize, k: usize, (from, to): (usize, usize)) -> T {
        let zero = self.any.like(0.0);
        if from >= to {
            return zero;
        }
        let a = &self.row(a)[from..to];
        let b = &self.row(b)[k + 1 - to..=k - from];
        inner_product(a, b, zero)
    }

    /// The k-th coefficients of all rows but those of the variables, from those up to the k-th of these.
    pub fn level(&mut self, program: &Program, k: usize) {
        for instruction in &program.instructions {
            self.carry_out(instruction, k);
        }
    }

    fn carry_out(&mut self, instruction: &Instruction, k: usize) {
        let Instruction {
            operation,
            result,
            spare,
        } = *instruction;
        let any = self.any;
        let new = match operation {
            Operation::Sum(a, b) => self.get(a, k) + self.get(b, k),
            Operation::Difference(a, b) => self.get(a, k) - self.get(b, k),
            Operation::Negative(a) => -self.get(a, k),
            Operation::Shifted(a, x) if k == 0 => self.get(a, 0) + any.like_exact(x),
            Operation::Shifted(a, _) => self.get(a, k),
            Operation::Complement(x, a) if k == 0 => any.like_exact(x) - self.get(a, 0),
            Operation::Complement(_, a) => -self.get(a, k),
            Operation::Scaled(a, x) => self.get(a, k).scale(x),
            Operation::Over(a, x) => self.get(a, k) / any.like_exact(x),
            Operation::Product(a, b) => self.convolution(a, b, k, (0, k + 1)),
            Operation::Quotient(a, b) => {
                // b_0 q_k = a_k - sum of q_j b_(k-j) over j < k
                let a = self.coefficient(a, k);
                if k == 0 {
                    self.set(spare, 0, any.like(1.0) / self.get(b, 0));
                    a / self.get(b, 0)
                } else {
                    (a - self.convolution(result, b, k, (0, k))) * self.get(spare, 0)
                }
            }
            Operation::Exponential(a) => {
                // k e_k = sum of j a_j e_(k-j) over 0 < j <= k
                self.slope(a, spare, k);
                if k == 0 {
                    self.get(a, 0).exp()
                } else {
                    self.convolution(spare, result, k, (1, k + 1))
                        .scale(self.one_over(k))
                }
            }
            Operation::ExponentialLessOne(a, _) if k == 0 => self.get(a, 0).exp_m1(),
            Operation::ExponentialLessOne(_, whole) => self.get(whole, k),
            Operation::Logarithm(a) => {
                // a_0 k l_k = k a_k - sum of j l_j a_(k-j) over 0 < j < k
                if k == 0 {
                    self.set(spare, 0, any.like(1.0) / self.get(a, 0));
                    self.get(a, 0).ln()
                } else {
                    let sum = self
                        .convolution(spare, a, k, (1, k))
                        .scale(self.one_over(k));
                    let new = (self.get(a, k) - sum) * self.get(spare, 0);
                    self.set(spare, k, new.scale(DoubleDouble::from(k as f64)));
                    new
                }
            }
            Operation::LogarithmOfOneMore(a, _) if k == 0 => self.get(a, 0).ln_1p(),
            Operation::LogarithmOfOneMore(_, whole) => self.get(whole, k),
            Operation::Hyperbolic(a, cosh) => {
                // k s_k = sum of j a_j c_(k-j), k c_k = sum of j a_j s_(k-j) over 0 < j <= k
                self.slope(a, spare, k);
                if k == 0 {
                    let (s, c) = self.get(a, 0).sinh_cosh();
                    self.set(cosh, 0, c);
                    s
                } else {
                    let one_over = self.one_over(k);
                    let c = self
                        .convolution(spare, result, k, (1, k + 1))
                        .scale(one_over);
                    let s = self.convolution(spare, cosh, k, (1, k + 1)).scale(one_over);
                    self.set(cosh, k, c);
                    s
                }
            }
            Operation::Circular(a, cos) => {
                // k s_k = sum of j a_j c_(k-j), k c_k = -sum of j a_j s_(k-j) over 0 < j <= k
                self.slope(a, spare, k);
                if k == 0 {
                    let (s, c) = self.get(a, 0).sin_cos();
                    self.set(cos, 0, c);
                    s
                } else {
                    let one_over = self.one_over(k);
                    let c = self.convolution(spare, result, k, (1, k + 1));
                    let s = self.convolution(spare, cos, k, (1, k + 1));
                    self.set(cos, k, c.scale(-one_over));
                    s.scale(one_over)
                }
            }
            Operation::Arctangent(a, u) | Operation::InverseHyperbolicSine(a, u) => {
                // y' = a' / u: u_0 k y_k = k a_k - sum of j y_j u_(k-j) over 0 < j < k
                if k == 0 {
                    self.set(spare, 0, any.like(1.0) / self.get(u, 0));
                    match operation {
                        Operation::Arctangent(..) => self.get(a, 0).atan(),
                        _ => self.get(a, 0).asinh(),
                    }
                } else {
                    let sum = self
                        .convolution(spare, u, k, (1, k))
                        .scale(self.one_over(k));
                    let new = (self.get(a, k) - sum) * self.get(spare, 0);
                    self.set(spare, k, new.scale(DoubleDouble::from(k as f64)));
                    new
                }
            }
            Operation::HyperbolicTangent(a, u) => {
                // k y_k = sum of j a_j u_(k-j) over 0 < j <= k, u_k = -sum of y_j y_(k-j) over 0 <= j <= k
                self.slope(a, spare, k);
                if k == 0 {
                    let y = self.get(a, 0).tanh();
                    self.set(u, 0, any.like(1.0) - y * y);
                    y
                } else {
                    let y = self
                        .convolution(spare, u, k, (1, k + 1))
                        .scale(self.one_over(k));
                    let first = self.get(result, 0);
                    let squared = self.convolution(result, result, k, (1, k));
                    self.set(u, k, -(first + first).mul_add(y, squared));
                    y
                }
            }
            Operation::Power(a, p) => self.power(a, p, (result, spare), k),
            Operation::Sign(a) if k == 0 => self.get(a, 0).sign(),
            Operation::Sign(_) => any.like(0.0),
            Operation::Signed(a, b) => self.get(a, k) * self.get(b, 0).sign(),
        };
        self.set(result, k, new);
    }

    /// y = a^p: k a_0 y_k = sum of (p (k-j) - j) a_(k-j) y_j over 0 <= j < k
    ///                     = p k sum a_(k-j) y_j - (1+p) sum a_(k-j) j y_j.
    fn power(&mut self, a: usize, p: f64, (y, slopes): (usize, usize), k: usize) -> T {
        let any = self.any;
        if k == 0 {
            self.set(slopes, 0, any.like(1.0) / self.get(a, 0));
            return self.get(a, 0).powf(p);
        }
        let one_and_p = DoubleDouble::of_finite(1.0, p) * self.one_over(k);
        let plain = self
            .convolution(y, a, k, (0, k))
            .scale(DoubleDouble::from(p));
        let weighted = self.convolution(slopes, a, k, (1, k)).scale(one_and_p);
        let new = (plain - weighted) * self.get(slopes, 0);
        self.set(slopes, k, new.scale(DoubleDouble::from(k as f64)));
        new
    }

    /// j a_j
    fn slope(&mut self, a: usize, slopes: usize, k: usize) {
        let new = self.get(a, k).scale(DoubleDouble::from(k as f64));
        self.set(slopes, k, new);
    }
}

/// sum of a_j b_(n-1-j) over j < n, n being the length of both. With four sums side by side: one or two would wait for each
/// other.
pub(super) fn inner_product<T: Element>(a: &[T], b: &[T], zero: T) -> T {
    let sums = T::four_sums(a, b).unwrap_or_else(|| four_sums(a, b, zero));
    (sums[0] + sums[1]) + (sums[2] + sums[3])
}

fn four_sums<T: Element>(a: &[T], b: &[T], zero: T) -> [T; 4] {
    let mut sums = [zero; 4];
    let mut left = a.chunks_exact(4);
    let mut right = b.rchunks_exact(4);
    for (a, b) in left.by_ref().zip(right.by_ref()) {
        for i in 0..4 {
            sums[i] = a[i].mul_add(b[3 - i], sums[i]);
        }
    }
    let rest = left.remainder().iter().zip(right.remainder().iter().rev());
    for (sum, (a, b)) in sums.iter_mut().zip(rest) {
        *sum = a.mul_add(*b, *sum);
    }
    sums
}
