//! Test functions along a curve of homoclinic orbits (Champneys & Kuznetsov 1994, Int. J. Bifurcation Chaos 4, 785), as far as they can be decided.

use super::connection::Frame;
use super::linear::{Linear, Solved};
use super::saddle::{Kind, Splitting};
use crate::bifurcation::Label;
use crate::field::{Matrix, Vector};
use crate::number::null_vector;
use nalgebra::Complex;

/// The unstable side, and the stable one.
const UNSTABLE: f64 = 1.0;
const STABLE: f64 = -1.0;

/// What is zero at a point of codimension two.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Test {
    /// The saddle quantity.
    Neutral,
    /// The difference of the two leading eigenvalues of a side, squared: they are real, or a pair.
    Double(Side),
    /// The difference of a real leading eigenvalue and the real part of a pair on the same side.
    Three(Side),
    /// The divergence in the leading directions, of which a pair is on this side.
    Divergent(Side),
    /// The part of the orbit in the leading direction, as it leaves or arrives.
    OrbitFlip(Side),
    /// The part of the adjoint solution in the leading direction of this side.
    InclinationFlip(Side),
    /// At a saddle-node the part of the orbit in the direction of the eigenvalue 0, as it arrives.
    NonCentral,
}

/// On which side of the imaginary axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Side {
    Stable,
    Unstable,
}

impl Side {
    fn sign(self) -> f64 {
        match self {
            Side::Stable => STABLE,
            Side::Unstable => UNSTABLE,
        }
    }
}

impl Test {
    pub const ALL: [Test; 12] = [
        Test::Neutral,
        Test::Double(Side::Stable),
        Test::Double(Side::Unstable),
        Test::Three(Side::Stable),
        Test::Three(Side::Unstable),
        Test::Divergent(Side::Stable),
        Test::Divergent(Side::Unstable),
        Test::OrbitFlip(Side::Stable),
        Test::OrbitFlip(Side::Unstable),
        Test::InclinationFlip(Side::Stable),
        Test::InclinationFlip(Side::Unstable),
        Test::NonCentral,
    ];

    /// The label of a zero.
    pub fn label(self, splitting: &Splitting) -> Label {
        let by_side = |side, [stable, unstable]: [Label; 2]| match side {
            Side::Stable => stable,
            Side::Unstable => unstable,
        };
        match self {
            Test::Neutral => {
                let pairs = [STABLE, UNSTABLE].map(|sign| {
                    let first = splitting.of_side(sign).first().copied();
                    usize::from(first.is_some_and(|z| z.im != 0.0))
                });
                [Label::Nss, Label::Nsf, Label::Nff][pairs[0] + pairs[1]]
            }
            Test::Double(side) => by_side(side, [Label::Drs, Label::Dru]),
            Test::Three(side) => by_side(side, [Label::Tls, Label::Tlu]),
            Test::Divergent(side) => by_side(side, [Label::Nds, Label::Ndu]),
            Test::OrbitFlip(side) => by_side(side, [Label::Ofs, Label::Ofu]),
            Test::InclinationFlip(side) => by_side(side, [Label::Ifs, Label::Ifu]),
            Test::NonCentral => Label::Nch,
        }
    }

    /// Whether it depends on the sense of eigenvectors.
    fn is_flip(self) -> bool {
        matches!(self, Test::OrbitFlip(_) | Test::InclinationFlip(_))
    }

    /// The value, of order one; NaN where it is not defined.
    pub fn value(self, splitting: &Splitting, ends: &Ends) -> f64 {
        if (self == Test::NonCentral) != (splitting.kind == Kind::SaddleNode) {
            return f64::NAN;
        }
        let both = [STABLE, UNSTABLE].map(|sign| splitting.of_side(sign));
        let of = |side| match side {
            Side::Stable => (&both[0], &both[1]),
            Side::Unstable => (&both[1], &both[0]),
        };
        let part = |a: f64, b: f64| (a + b) / (a.abs() + b.abs());
        let value = match self {
            Test::Neutral => Some(part(both[0][0].re, both[1][0].re)),
            Test::Double(side) => double(of(side).0),
            Test::Three(side) => three(of(side).0),
            Test::Divergent(side) => {
                let (own, other) = of(side);
                (own[0].im != 0.0).then(|| part(2.0 * own[0].re, other[0].re))
            }
            Test::OrbitFlip(side) => ends.of(side).map(|end| end.orbit),
            Test::InclinationFlip(side) => ends.of(side).map(|end| end.adjoint),
            Test::NonCentral => ends.centre,
        };
        value.unwrap_or(f64::NAN)
    }

    /// What the value may be off by.
    pub fn error(self, solved: &Solved, frame: &Frame) -> f64 {
        /// Rounding of eigenvalues.
        const ROUNDING: f64 = 1e-13;
        let linear = &solved.linear;
        let layout = solved.connection.layout();
        let bent = linear.errors.rows_range(layout.ends()..).amax();
        match self.is_flip() {
            true => bent / frame.radii[0].min(frame.radii[1]) + ROUNDING,
            false => ROUNDING,
        }
    }
}

/// Both leading eigenvalues, of which the first is the nearest to the axis.
fn double(own: &[Complex<f64>]) -> Option<f64> {
    let [a, b] = *own.first_chunk()?;
    if a.im != 0.0 {
        return Some(-(a.im / a.norm()).powi(2));
    }
    (b.im == 0.0).then(|| ((a.re - b.re) / (a.re.abs() + b.re.abs())).powi(2))
}

/// One real among the first three, and a pair.
fn three(own: &[Complex<f64>]) -> Option<f64> {
    let three: &[Complex<f64>; 3] = own.first_chunk()?;
    let [mut reals, mut pairs] = [false, true].map(|pair| {
        let own = three.iter().filter(move |z| (z.im != 0.0) == pair);
        own.map(|z| z.re.abs())
    });
    let (real, pair) = (reals.next()?, pairs.next()?);
    let alone = reals.next().is_none();
    alone.then(|| (pair - real) / (pair + real))
}

/// At an end, the parts in the leading direction of a side.
#[derive(Debug, Clone)]
struct Leading {
    /// The right and the left eigenvector.
    vectors: [Vector; 2],
    orbit: f64,
    adjoint: f64,
}

/// The same of both sides, where the leading eigenvalue is real and not alone.
#[derive(Debug, Clone, Default)]
pub(super) struct Ends {
    stable: Option<Leading>,
    unstable: Option<Leading>,
    /// At a saddle-node how far the orbit arrives from the side opposite to that to which it leaves.
    centre: Option<f64>,
}

impl Ends {
    fn of(&self, side: Side) -> Option<&Leading> {
        match side {
            Side::Stable => self.stable.as_ref(),
            Side::Unstable => self.unstable.as_ref(),
        }
    }

    /// Of a connection, with eigenvectors in the sense of those of another.
    pub fn new(solved: &Solved, sizes: &Vector, adjoint: &Vector, before: Option<&Self>) -> Self {
        let Solved { connection, linear } = solved;
        let away = |k: usize| {
            let away = &connection.nodes[k] - &connection.saddle;
            away.component_div(sizes).normalize()
        };
        let arcs = connection.durations.len();
        if linear.splitting.kind != Kind::Saddle {
            let left = null_vector(linear.splitting.matrix.transpose());
            let centre = left.map(|left| -left.dot(&away(arcs)) * left.dot(&away(0)).signum());
            return Ends {
                centre,
                ..Ends::default()
            };
        }
        let [begins, ends] = adjoint_at_ends(linear, connection.layout().ends(), adjoint);
        let of = |side: Side, away: Vector, adjoint: Vector| {
            let [right, left] = linear.splitting.leading(side.sign())?;
            let known = before.and_then(|before| before.of(side));
            let sense = |x: Vector, i: usize| match known {
                Some(known) if known.vectors[i].dot(&x) < 0.0 => -x,
                _ => x,
            };
            let (right, left) = (sense(right, 0), sense(left, 1));
            Some(Leading {
                orbit: left.dot(&away),
                adjoint: right.dot(&adjoint),
                vectors: [right, left],
            })
        };
        Ends {
            stable: of(Side::Stable, away(arcs), begins),
            unstable: of(Side::Unstable, away(0), ends),
            centre: None,
        }
    }
}

/// The adjoint solution where the orbit begins and where it ends, of length one: by the equations of both ends.
fn adjoint_at_ends(linear: &Linear, first: usize, adjoint: &Vector) -> [Vector; 2] {
    let begin = &linear.splitting.unstable.across;
    let end = &linear.splitting.stable.across;
    let at = |across: &Matrix, row: usize| {
        let solution = across.transpose() * adjoint.rows(row, across.nrows());
        solution.clone().try_normalize(0.0).unwrap_or(solution)
    };
    // Behind the equations of the begin there is one for its distance.
    [at(begin, first), at(end, first + begin.nrows() + 1)]
}
