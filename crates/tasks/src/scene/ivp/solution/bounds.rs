//! Bounds for a solution over a part of a step, by interval arithmetic.

use super::super::chart::Given;
use super::{Basis, IvpSolution};
use twinslip::number::{Interval, Jet, Real};

impl IvpSolution {
    /// Bounds for the user's values over a part of the last piece, of which 0 is the beginning and 1 the end, with their slopes in that.
    ///
    /// # Panics
    /// Where there is no piece.
    pub(in crate::scene::ivp) fn bounds(&self, part: (f64, f64)) -> Vec<Jet<Interval, 1>> {
        let piece = &self.pieces[self.pieces.len() - 1];
        let ratio = piece.length / piece.scale;
        let at = |u: f64| Jet {
            value: Interval::constant(u) * ratio,
            gradient: [Interval::constant(ratio)],
        };
        let s = Jet {
            value: Interval::new(part.0, part.1) * ratio,
            ..at(0.0)
        };
        let of_one = self.coefficients[piece.first..].chunks(piece.order + 1);
        let variables = of_one.map(|c| polynomial(piece.basis, c, s));
        let given = match piece.basis {
            Basis::Chebyshev => Given::Variables,
            Basis::Powers(given) => given,
        };
        let variables: Vec<_> = variables.collect();
        self.chart.outward_of(&variables, given)
    }

    /// The same for the user's time.
    pub(in crate::scene::ivp) fn time_bounds(&self, part: (f64, f64)) -> Jet<Interval, 1> {
        let [.., begin, end] = self.times[..] else {
            unreachable!("a piece has two ends");
        };
        let length = end - begin;
        Jet {
            value: Interval::new(part.0, part.1) * length + begin,
            gradient: [Interval::constant(length)],
        }
    }
}

/// Value and slope of a piece's polynomial, for s since its beginning in its own unit. The mean value form from the middle is sharper for narrow
/// parts; as both hold, the value is in what they have in common.
fn polynomial(basis: Basis, coefficients: &[f64], s: Jet<Interval, 1>) -> Jet<Interval, 1> {
    let of = |s: Jet<Interval, 1>| match basis {
        Basis::Chebyshev => {
            let x = s * 2.0 - 1.0;
            let (mut later, mut last) = (Jet::constant(0.0), Jet::constant(0.0));
            for &c in coefficients[1..].iter().rev() {
                (last, later) = (x * 2.0 * last - later + c, last);
            }
            x * last - later + coefficients[0]
        }
        Basis::Powers(_) => {
            let sums = coefficients.iter().rev();
            sums.fold(Jet::constant(0.0), |sum, &c| sum * s + c)
        }
    };
    let whole = of(s);
    let middle = Interval::constant(s.value.leading());
    let at = of(Jet {
        value: middle,
        gradient: [Interval::constant(0.0)],
    });
    let [unit] = s.gradient;
    let [slope] = whole.gradient;
    let near = at.value + slope / unit * (s.value - middle);
    Jet {
        value: near.common(whole.value),
        ..whole
    }
}
