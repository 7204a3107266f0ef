//! Formulas as data: the operations of a formula, recorded once (a Wengert list), to be carried out again and again.
//!
//! A formula written for any [`Real`] is evaluated on [`Traced`] numbers, each the name of a node of a [`Graph`]. What occurs
//! twice is recorded once, constants are folded in 31 digits, and a product with zero is zero. Derivatives
//! are nodes too, made by the rules of differentiation, of which those that are zero everywhere leave nothing.
//!
//! Griewank, A. and Walther, A. (2008). Evaluating Derivatives, 2nd edition, chapters 2 and 6. SIAM.

use crate::number::{Balance, DoubleDouble, Ratio, Real};
use std::cell::{Cell, RefCell};
use std::collections::HashMap;
use std::hash::{BuildHasherDefault, Hasher};
use std::ops::{Add, Div, Mul, Neg, Sub};

/// A node by its place in the list: every operand stands before what is made of it.
pub(super) type NodeIndex = usize;

/// What a node is, of which operands.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(super) enum Node {
    /// The i-th variable; after the variables of a formula its parameters.
    Variable(usize),
    /// A constant, by the bits of its two parts.
    Constant(u64, u64),
    Sum(NodeIndex, NodeIndex),
    Difference(NodeIndex, NodeIndex),
    Negative(NodeIndex),
    Product(NodeIndex, NodeIndex),
    Quotient(NodeIndex, NodeIndex),
    Exponential(NodeIndex),
    /// e^a - 1, and the node of e^a.
    ExponentialLessOne(NodeIndex, NodeIndex),
    Logarithm(NodeIndex),
    /// ln(1 + a), and the node of that logarithm as it is for larger a.
    LogarithmOfOneMore(NodeIndex, NodeIndex),
    Sinh(NodeIndex),
    /// cosh a, and the node of sinh a, which stands before.
    Cosh(NodeIndex, NodeIndex),
    Sin(NodeIndex),
    /// cos a, and the node of sin a, which stands before.
    Cos(NodeIndex, NodeIndex),
    /// atan a, and the node of 1 + a^2.
    Arctangent(NodeIndex, NodeIndex),
    HyperbolicTangent(NodeIndex),
    /// asinh a, and the node of sqrt(1 + a^2).
    InverseHyperbolicSine(NodeIndex, NodeIndex),
    /// a to the power of a constant, by its bits.
    Power(NodeIndex, u64),
    /// a to the power of b.
    VariablePower(NodeIndex, NodeIndex),
    /// A ratio at a.
    Ratio(NodeIndex, Ratio),
    /// 1 with the sign of a.
    Sign(NodeIndex),
    /// a with the sign of b.
    Signed(NodeIndex, NodeIndex),
    /// The y of y + g(y) = a.
    Balanced(NodeIndex, NodeBalance),
    /// g(y) of that node, which stands before.
    OfBalanced(NodeIndex),
}

/// g of a balance, of these nodes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(super) enum NodeBalance {
    Exponential(NodeIndex),
    Sinh(NodeIndex),
    Difference(NodeIndex, NodeIndex),
}

impl NodeBalance {
    /// g with the numbers that stand for its nodes.
    pub fn of<T: Copy>(self, at: impl Fn(NodeIndex) -> T) -> Balance<T> {
        match self {
            NodeBalance::Exponential(a) => Balance::Exponential(at(a)),
            NodeBalance::Sinh(a) => Balance::Sinh(at(a)),
            NodeBalance::Difference(a, b) => Balance::Difference(at(a), at(b)),
        }
    }
}

/// Multiplies and rotates (Fx hash): nodes are few words, and a graph is made for every solution.
#[derive(Debug, Default, Clone, Copy)]
pub(super) struct Hash(u64);

impl Hasher for Hash {
    fn finish(&self) -> u64 {
        self.0
    }
    fn write(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            self.write_u64(u64::from(byte));
        }
    }
    fn write_u64(&mut self, x: u64) {
        self.0 = (self.0.rotate_left(5) ^ x).wrapping_mul(0x517c_c1b7_2722_0a95);
    }
    fn write_usize(&mut self, x: usize) {
        self.write_u64(x as u64);
    }
    fn write_isize(&mut self, x: isize) {
        self.write_u64(x as u64);
    }
}

/// The nodes of a formula, and their values at the point where it was recorded.
#[derive(Debug, Default)]
pub struct Graph {
    nodes: RefCell<Vec<(Node, f64)>>,
    places: RefCell<HashMap<Node, NodeIndex, BuildHasherDefault<Hash>>>,
    branches: Cell<bool>,
}

/// A number of a formula that is being recorded.
#[derive(Debug, Clone, Copy)]
pub enum Traced<'g> {
    /// A constant.
    Constant(DoubleDouble),
    /// A node.
    Node(&'g Graph, usize),
}

use Traced::Constant;

impl Graph {
    /// The i-th variable, and its value.
    pub fn variable(&self, i: usize, value: f64) -> Traced<'_> {
        Traced::Node(self, self.place(Node::Variable(i), value))
    }

    /// Whether the formula asked for a value: it may be another one elsewhere.
    pub(super) fn branches(&self) -> bool {
        self.branches.get()
    }

    /// The nodes, in order.
    pub(super) fn nodes(&self) -> Vec<Node> {
        self.nodes.borrow().iter().map(|(node, _)| *node).collect()
    }

    /// The node of a number.
    pub(super) fn place_of(&self, x: Traced<'_>) -> NodeIndex {
        match x {
            Constant(x) => self.place(Node::Constant(x.hi().to_bits(), x.lo().to_bits()), x.hi()),
            Traced::Node(_, place) => place,
        }
    }

    /// The derivatives of these numbers in a variable, by the rules of differentiation node after node (forward mode).
    pub(super) fn derivatives(&self, of: &[Traced<'_>], variable: usize) -> Vec<Traced<'_>> {
        let mut nodes = self.nodes();
        // What other derivatives have added is no part of these numbers.
        let part = |x: &Traced<'_>| match x {
            Constant(_) => 0,
            Traced::Node(_, place) => place + 1,
        };
        nodes.truncate(of.iter().map(part).max().unwrap_or(0));
        let zero = Constant(DoubleDouble::ZERO);
        let mut slopes: Vec<Traced<'_>> = Vec::with_capacity(nodes.len());
        for (place, node) in nodes.iter().enumerate() {
            let at = |place| Traced::Node(self, place);
            let (this, slope) = (at(place), |place: NodeIndex| slopes[place]);
            slopes.push(match *node {
                Node::Variable(i) => Traced::constant(f64::from(u8::from(i == variable))),
                Node::Constant(..) | Node::Sign(_) => zero,
                Node::Sum(a, b) => slope(a) + slope(b),
                Node::Difference(a, b) => slope(a) - slope(b),
                Node::Negative(a) => -slope(a),
                Node::Product(a, b) => slope(a) * at(b) + at(a) * slope(b),
                Node::Quotient(a, b) => (slope(a) - this * slope(b)) / at(b),
                Node::Exponential(a) => slope(a) * this,
                Node::ExponentialLessOne(a, whole) => slope(a) * at(whole),
                Node::Logarithm(a) => slope(a) / at(a),
                Node::LogarithmOfOneMore(a, _) => slope(a) / (at(a) + 1.0),
                Node::Sinh(a) => slope(a) * at(a).cosh(),
                Node::Cosh(a, sinh) => slope(a) * at(sinh),
                Node::Sin(a) => slope(a) * at(a).cos(),
                Node::Cos(a, sin) => -(slope(a) * at(sin)),
                Node::Arctangent(a, u) | Node::InverseHyperbolicSine(a, u) => slope(a) / at(u),
                Node::HyperbolicTangent(a) => slope(a) * (-(this * this) + 1.0),
                Node::Power(a, p) => match f64::from_bits(p) {
                    0.5 => slope(a) * (Traced::constant(0.5) / this),
                    p => slope(a) * (at(a).powf(p - 1.0) * p),
                },
                Node::VariablePower(a, p) => {
                    let of_base = at(a).pow(at(p) - 1.0) * at(p);
                    slope(a) * of_base + slope(p) * (this * at(a).ln())
                }
                Node::Ratio(a, ratio) => slope(a) * at(a).ratio(ratio.derived()),
                Node::Signed(a, b) => slope(a) * at(b).sign(),
                Node::Balanced(a, g) => {
                    // g with its coefficients' slopes, at the y that is held
                    let (of_coefficients, _) = g.of(slope).at(this);
                    let (_, steepness) = g.of(at).at(this);
                    (slope(a) - of_coefficients) / (steepness + 1.0)
                }
                Node::OfBalanced(y) => {
                    let Node::Balanced(a, g) = nodes[y] else {
                        unreachable!("a balance");
                    };
                    let (of_coefficients, _) = g.of(slope).at(at(y));
                    let (_, steepness) = g.of(at).at(at(y));
                    (steepness * slope(a) + of_coefficients) / (steepness + 1.0)
                }
            });
        }
        let slope = |x: &Traced<'_>| match x {
            Constant(_) => zero,
            Traced::Node(_, place) => slopes[*place],
        };
        of.iter().map(slope).collect()
    }

    fn place(&self, node: Node, value: f64) -> NodeIndex {
        *self.places.borrow_mut().entry(node).or_insert_with(|| {
            let mut nodes = self.nodes.borrow_mut();
            nodes.push((node, value));
            nodes.len() - 1
        })
    }

    fn value(&self, place: NodeIndex) -> f64 {
        self.nodes.borrow()[place].1
    }
}

// Called and not inlined: a formula is recorded once in a solution.
impl<'g> Traced<'g> {
    /// A node of one operand.
    #[inline(never)]
    fn unary(
        self,
        of_constant: fn(DoubleDouble) -> DoubleDouble,
        of_value: fn(f64) -> f64,
        node: fn(NodeIndex) -> Node,
    ) -> Self {
        match self {
            Constant(x) => Constant(of_constant(x)),
            Traced::Node(graph, a) => {
                let value = of_value(graph.value(a));
                Traced::Node(graph, graph.place(node(a), value))
            }
        }
    }

    /// A node of two operands, not both of them constant.
    #[inline(never)]
    fn binary(
        self,
        other: Self,
        of_values: fn(f64, f64) -> f64,
        node: fn(NodeIndex, NodeIndex) -> Node,
    ) -> Self {
        let graph = match (self, other) {
            (Traced::Node(graph, _), _) | (_, Traced::Node(graph, _)) => graph,
            _ => unreachable!("of constants"),
        };
        let (a, b) = (graph.place_of(self), graph.place_of(other));
        let value = of_values(graph.value(a), graph.value(b));
        Traced::Node(graph, graph.place(node(a, b), value))
    }

    /// Whether it is this constant.
    fn is(self, x: f64) -> bool {
        matches!(self, Constant(c) if c.hi() == x && c.lo() == 0.0)
    }

    /// The operand whose sign this is.
    fn as_sign(self) -> Option<Self> {
        match self {
            Traced::Node(graph, place) => match graph.nodes.borrow()[place].0 {
                Node::Sign(of) => Some(Traced::Node(graph, of)),
                _ => None,
            },
            Constant(_) => None,
        }
    }

    /// The same with the sign of `of`.
    fn signed(self, of: Self) -> Self {
        self.binary(of, |a, b| a * 1_f64.copysign(b), Node::Signed)
    }
}

impl Neg for Traced<'_> {
    type Output = Self;
    fn neg(self) -> Self {
        self.unary(|x| -x, |x| -x, Node::Negative)
    }
}

impl Add for Traced<'_> {
    type Output = Self;
    #[inline(never)]
    fn add(self, o: Self) -> Self {
        match (self, o) {
            (Constant(x), Constant(y)) => Constant(x + y),
            _ if self.is(0.0) => o,
            _ if o.is(0.0) => self,
            _ => self.binary(o, |a, b| a + b, |a, b| Node::Sum(a.min(b), a.max(b))),
        }
    }
}

impl Sub for Traced<'_> {
    type Output = Self;
    #[inline(never)]
    fn sub(self, o: Self) -> Self {
        match (self, o) {
            (Constant(x), Constant(y)) => Constant(x - y),
            _ if self.is(0.0) => -o,
            _ if o.is(0.0) => self,
            _ => self.binary(o, |a, b| a - b, Node::Difference),
        }
    }
}

impl Mul for Traced<'_> {
    type Output = Self;
    #[inline(never)]
    fn mul(self, o: Self) -> Self {
        match (self, o) {
            (Constant(x), Constant(y)) => Constant(x * y),
            _ if self.is(0.0) || o.is(0.0) => Constant(DoubleDouble::ZERO),
            _ if self.is(1.0) => o,
            _ if o.is(1.0) => self,
            _ if self.is(-1.0) => -o,
            _ if o.is(-1.0) => -self,
            _ => match (self.as_sign(), o.as_sign()) {
                (Some(of), _) => o.signed(of),
                (_, Some(of)) => self.signed(of),
                _ => self.binary(o, |a, b| a * b, |a, b| Node::Product(a.min(b), a.max(b))),
            },
        }
    }
}

impl Div for Traced<'_> {
    type Output = Self;
    #[inline(never)]
    fn div(self, o: Self) -> Self {
        match (self, o) {
            (Constant(x), Constant(y)) => Constant(x / y),
            _ if self.is(0.0) => self,
            _ if o.is(1.0) => self,
            _ => self.binary(o, |a, b| a / b, Node::Quotient),
        }
    }
}

/// The same with an ordinary number, which is exact.
macro_rules! mixed {
    ($($trait:ident $method:ident)*) => { $(
        impl $trait<f64> for Traced<'_> {
            type Output = Self;
            fn $method(self, x: f64) -> Self {
                self.$method(Self::constant(x))
            }
        }
    )* };
}
mixed!(Add add Sub sub Mul mul Div div);

impl Real for Traced<'_> {
    fn constant(x: f64) -> Self {
        Constant(DoubleDouble::from(x))
    }

    fn leading(self) -> f64 {
        match self {
            Constant(x) => x.hi(),
            Traced::Node(graph, place) => {
                graph.branches.set(true);
                graph.value(place)
            }
        }
    }

    fn exp(self) -> Self {
        self.unary(Real::exp, f64::exp, Node::Exponential)
    }

    #[inline(never)]
    fn exp_m1(self) -> Self {
        match self {
            Constant(x) => Constant(Real::exp_m1(x)),
            _ => self.binary(self.exp(), |a, _| a.exp_m1(), Node::ExponentialLessOne),
        }
    }

    fn ln(self) -> Self {
        self.unary(Real::ln, f64::ln, Node::Logarithm)
    }

    #[inline(never)]
    fn ln_1p(self) -> Self {
        match self {
            Constant(x) => Constant(Real::ln_1p(x)),
            _ => self.binary(
                (self + 1.0).ln(),
                |a, _| a.ln_1p(),
                Node::LogarithmOfOneMore,
            ),
        }
    }

    #[inline(never)]
    fn powf(self, p: f64) -> Self {
        match self {
            Constant(x) => Constant(Real::powf(x, p)),
            Traced::Node(graph, a) => {
                let value = graph.value(a).powf(p);
                Traced::Node(graph, graph.place(Node::Power(a, p.to_bits()), value))
            }
        }
    }

    #[inline(never)]
    fn pow(self, p: Self) -> Self {
        match (self, p) {
            (Constant(x), Constant(p)) => Constant(Real::pow(x, p)),
            (_, Constant(p)) if p.lo() == 0.0 => self.powf(p.hi()),
            _ => self.binary(p, f64::powf, Node::VariablePower),
        }
    }

    fn sqrt(self) -> Self {
        self.powf(0.5)
    }

    // They are made together.
    #[inline(never)]
    fn sinh_cosh(self) -> (Self, Self) {
        let sinh = self.unary(Real::sinh, Real::sinh, Node::Sinh);
        let cosh = match self {
            Constant(x) => Constant(Real::cosh(x)),
            _ => self.binary(sinh, |a, _| Real::cosh(a), Node::Cosh),
        };
        (sinh, cosh)
    }

    fn sinh(self) -> Self {
        self.sinh_cosh().0
    }

    fn cosh(self) -> Self {
        self.sinh_cosh().1
    }

    // Likewise.
    #[inline(never)]
    fn sin_cos(self) -> (Self, Self) {
        let sin = self.unary(|x| Real::sin_cos(x).0, f64::sin, Node::Sin);
        let cos = match self {
            Constant(x) => Constant(Real::sin_cos(x).1),
            _ => self.binary(sin, |a, _| a.cos(), Node::Cos),
        };
        (sin, cos)
    }

    #[inline(never)]
    fn atan(self) -> Self {
        match self {
            Constant(x) => Constant(Real::atan(x)),
            _ => self.binary(self * self + 1.0, |a, _| a.atan(), Node::Arctangent),
        }
    }

    fn tanh(self) -> Self {
        self.unary(Real::tanh, f64::tanh, Node::HyperbolicTangent)
    }

    #[inline(never)]
    fn asinh(self) -> Self {
        match self {
            Constant(x) => Constant(Real::asinh(x)),
            _ => {
                let root = (self * self + 1.0).sqrt();
                self.binary(root, |a, _| Real::asinh(a), Node::InverseHyperbolicSine)
            }
        }
    }

    fn abs(self) -> Self {
        match self {
            Constant(x) => Constant(Real::abs(x)),
            _ => self.signed(self),
        }
    }

    fn sign(self) -> Self {
        self.unary(
            |x| DoubleDouble::from(1_f64.copysign(x.hi())),
            |x| 1_f64.copysign(x),
            Node::Sign,
        )
    }

    #[inline(never)]
    fn ratio(self, ratio: Ratio) -> Self {
        match self {
            Constant(x) => Constant(Real::ratio(x, ratio)),
            Traced::Node(graph, a) => {
                let value = graph.value(a).ratio(ratio);
                Traced::Node(graph, graph.place(Node::Ratio(a, ratio), value))
            }
        }
    }

    #[inline(never)]
    fn balanced(self, g: Balance<Self>) -> (Self, Self) {
        let graph_of = |x: Self| match x {
            Traced::Node(graph, _) => Some(graph),
            Constant(_) => None,
        };
        let mut graph = graph_of(self);
        g.map(|c| graph = graph.or(graph_of(c)));
        let Some(graph) = graph else {
            let number = |x: Self| match x {
                Constant(x) => x,
                Traced::Node(..) => unreachable!("constants"),
            };
            let (y, of_y) = Real::balanced(number(self), g.map(number));
            return (Constant(y), Constant(of_y));
        };
        let place = graph.place_of(self);
        let nodes = match g.map(|c| graph.place_of(c)) {
            Balance::Exponential(a) => NodeBalance::Exponential(a),
            Balance::Sinh(a) => NodeBalance::Sinh(a),
            Balance::Difference(a, b) => NodeBalance::Difference(a, b),
        };
        let values = nodes.of(|at| graph.value(at));
        let (value, of_value) = Real::balanced(graph.value(place), values);
        let y = graph.place(Node::Balanced(place, nodes), value);
        let of_y = graph.place(Node::OfBalanced(y), of_value);
        (Traced::Node(graph, y), Traced::Node(graph, of_y))
    }
    // Chosen by a sign, so that steps end at the kink; the factor of the one that it is is exactly 1, of the other 0.
    fn lesser(self, o: Self) -> Self {
        let half = (o - self).sign() * 0.5;
        self * (half + 0.5) + o * (-half + 0.5)
    }

    fn greater(self, o: Self) -> Self {
        let half = (self - o).sign() * 0.5;
        self * (half + 0.5) + o * (-half + 0.5)
    }
}
