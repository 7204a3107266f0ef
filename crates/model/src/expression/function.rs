//! The functions that an expression may call.

use crate::number::{Numerator, Real};

/// A function by its name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Function {
    /// e^x
    Exp,
    /// e^x - 1, accurate near 0
    Expm1,
    /// (e^x - 1)/x, which is 1 at 0
    Exprel,
    /// natural logarithm
    Ln,
    /// ln(1 + x), accurate near 0
    Log1p,
    /// logarithm to base 10
    Log10,
    /// square root
    Sqrt,
    /// sine
    Sin,
    /// cosine
    Cos,
    /// tangent
    Tan,
    /// hyperbolic sine
    Sinh,
    /// hyperbolic cosine
    Cosh,
    /// hyperbolic tangent
    Tanh,
    /// inverse of the hyperbolic sine
    Asinh,
    /// inverse of the tangent
    Atan,
    /// absolute value
    Abs,
    /// the lesser of two
    Min,
    /// the greater of two
    Max,
    /// x^p, as `^`
    Pow,
}

use Function::*;

impl Function {
    /// All, by their names; the natural logarithm has both of its own.
    const ALL: [(&'static str, Function); 20] = [
        ("exp", Exp),
        ("expm1", Expm1),
        ("exprel", Exprel),
        ("ln", Ln),
        ("log", Ln),
        ("log1p", Log1p),
        ("log10", Log10),
        ("sqrt", Sqrt),
        ("sin", Sin),
        ("cos", Cos),
        ("tan", Tan),
        ("sinh", Sinh),
        ("cosh", Cosh),
        ("tanh", Tanh),
        ("asinh", Asinh),
        ("atan", Atan),
        ("abs", Abs),
        ("min", Min),
        ("max", Max),
        ("pow", Pow),
    ];

    /// Their names.
    pub const NAMES: [&'static str; Self::ALL.len()] = {
        let mut names = [""; Self::ALL.len()];
        let mut i = 0;
        while i < names.len() {
            names[i] = Self::ALL[i].0;
            i += 1;
        }
        names
    };

    /// The one of this name.
    pub fn named(name: &str) -> Option<Self> {
        let found = Self::ALL.iter().find(|(known, _)| *known == name);
        found.map(|(_, function)| *function)
    }

    /// The number of its arguments, 1 or 2.
    pub fn arguments(self) -> usize {
        match self {
            Min | Max | Pow => 2,
            _ => 1,
        }
    }

    /// Its value at x; of one with two arguments nothing is asked here.
    pub(super) fn of<T: Real>(self, x: T) -> T {
        match self {
            Exp => x.exp(),
            Expm1 => x.exp_m1(),
            Exprel => x.ratio(Numerator::ExpM1.into()),
            Ln => x.ln(),
            Log1p => x.ln_1p(),
            Log10 => x.log10(),
            Sqrt => x.sqrt(),
            Sin => x.sin(),
            Cos => x.cos(),
            Tan => {
                let (sin, cos) = x.sin_cos();
                sin / cos
            }
            Sinh => x.sinh(),
            Cosh => x.cosh(),
            Tanh => x.tanh(),
            Asinh => x.asinh(),
            Atan => x.atan(),
            Abs => x.abs(),
            Min | Max | Pow => unreachable!("of two arguments"),
        }
    }
}
