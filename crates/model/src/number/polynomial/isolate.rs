//! Root isolation on [0, 1] by halving (Bernstein coefficients): parts where the sign does not change, brackets of one root, and
//! clusters of parts in which the polynomial is lost in its rounding errors.

use super::{Coefficients, Crossing, Root, bernstein, evaluate, evaluate_derivative, terms};
use crate::number::bracketed_root;

/// Unit roundoff.
const UNIT: f64 = 0.5 * f64::EPSILON;

/// How often an interval is halved at most.
const MAX_DEPTH: usize = 100;

/// Where to divide: in the middle, unless a root is there.
const DIVISIONS: [f64; 3] = [0.5, 0.4375, 0.5625];

/// By how much the ends of a bracket must exceed the error, so that no neighbour of it is [`SignTest::Noise`].
const FIRM: f64 = 8.0;

/// Part of A beyond which signs are trusted in any polynomial up to the highest degree, ends of brackets included.
const CERTAIN: f64 = 1e-12;

/// Whether the slope has the sign of c_1 on all of [0, 1].
fn keeps_rising_or_falling(terms: &Coefficients) -> bool {
    let others = terms.iter().enumerate().skip(2);
    let others: f64 = others.map(|(k, c)| k as f64 * c.abs()).sum();
    // the margin is for the rounding of the sum
    terms[1].abs() > 1.000001 * others
}

/// Appends the roots of a polynomial with c_0 != 0 between 0 and `length`; `turned` where what rises along the way falls as
/// the argument grows.
pub(super) fn search(coefficients: &[f64], length: f64, turned: bool, found: &mut Vec<Root>) {
    let degree = coefficients.len() - 1;
    let terms = terms(coefficients, length);
    let magnitudes = terms.map(f64::abs);
    let end = evaluate(coefficients, length);
    let largest: f64 = magnitudes.iter().sum();
    if !(largest.is_finite() && end.is_finite()) {
        return;
    }
    let mut search = Search {
        coefficients,
        length,
        magnitudes,
        ends_in_zero: end == 0.0,
        turned,
        sign: terms[0].signum(),
        cluster: None,
        found,
    };
    // Most polynomials of steps only rise or only fall: then the signs at the ends tell all, where they are beyond doubt.
    let certain = CERTAIN * largest;
    if keeps_rising_or_falling(&terms) && terms[0].abs() > certain && end.abs() > certain {
        if end.signum() != search.sign {
            search.cross((0.0, 1.0), true, 0.0, end.signum());
        }
        return;
    }
    let (before_end, after_end) = search.signs_around_end(end);
    let mut control = bernstein(&terms, degree);
    control[degree] = if end == 0.0 {
        before_end * f64::MIN_POSITIVE
    } else {
        end
    };
    search.visit(&Subinterval {
        control,
        from: 0.0,
        to: 1.0,
        noise: 6.0 * (degree + 1) as f64 * UNIT,
        depth: 0,
    });
    search.finish(end, after_end);
}

/// A part of the interval, which is [0, 1] here, with the polynomial's Bernstein coefficients on it.
struct Subinterval {
    control: Coefficients,
    from: f64,
    to: f64,
    /// Bound on the errors of the coefficients, relative to A.
    noise: f64,
    depth: usize,
}

/// Neighbouring parts in which the polynomial is no larger than its rounding errors.
#[derive(Clone, Copy)]
struct Cluster {
    from: f64,
    to: f64,
    /// That of its last part.
    noise: f64,
}

struct Search<'a> {
    coefficients: &'a [f64],
    length: f64,
    /// |c_k h^k|
    magnitudes: Coefficients,
    /// Whether the end is a root.
    ends_in_zero: bool,
    /// Whether what rises along the way falls as t grows.
    turned: bool,
    /// The last certain sign.
    sign: f64,
    cluster: Option<Cluster>,
    found: &'a mut Vec<Root>,
}

/// What the signs of the coefficients on a part say.
enum SignTest {
    Free,
    /// One change of sign; `sharp` where no coefficient between is uncertain.
    Crossing {
        sharp: bool,
    },
    Noise,
    Unclear,
}

impl Search<'_> {
    fn visit(&mut self, part: &Subinterval) {
        let n = self.coefficients.len() - 1;
        match self.verdict(part) {
            SignTest::Free => self.close_cluster(part.control[0].signum()),
            SignTest::Crossing { sharp } => {
                self.close_cluster(part.control[0].signum());
                let last = part.control[n].signum();
                self.cross((part.from, part.to), sharp, part.noise, last);
            }
            SignTest::Noise => {
                let from = self.cluster.map_or(part.from, |c| c.from);
                self.cluster = Some(Cluster {
                    from,
                    to: part.to,
                    noise: part.noise,
                });
            }
            SignTest::Unclear => {
                let [left, right] = self.divided(part);
                self.visit(&left);
                self.visit(&right);
            }
        }
    }

    fn verdict(&self, part: &Subinterval) -> SignTest {
        let n = self.coefficients.len() - 1;
        let uncertain = part.noise * self.magnitude(part.to);
        let (mut sign, mut changes, mut largest) = (0.0, 0, 0.0_f64);
        // uncertain coefficients between two of the same sign, or at an end, leave open what happens there
        let (mut gap, mut sharp, mut open) = (false, true, false);
        // a root at the end would stop the search for another one before it
        let mut bracket = !(self.ends_in_zero && part.to == 1.0);
        for (i, &x) in part.control[..=n].iter().enumerate() {
            largest = largest.max(x.abs());
            let end = (i == 0 && part.from == 0.0) || (i == n && part.to == 1.0);
            if x.abs() <= uncertain && !end {
                (gap, sharp) = (true, false);
                continue;
            }
            bracket &= end || (0 < i && i < n) || x.abs() > FIRM * uncertain;
            open |= gap && sign != -x.signum();
            changes += usize::from(sign == -x.signum());
            sign = x.signum();
            gap = false;
        }
        let middle = 0.5 * part.from + 0.5 * part.to;
        if !(open || gap) && changes == 0 {
            SignTest::Free
        } else if !(open || gap) && changes == 1 && bracket {
            SignTest::Crossing { sharp }
        } else if largest <= 4.0 * part.noise * self.magnitude(part.from)
            || part.depth == MAX_DEPTH
            || middle <= part.from
            || middle >= part.to
        {
            SignTest::Noise
        } else {
            SignTest::Unclear
        }
    }

    /// A at a point of [0, 1].
    fn magnitude(&self, s: f64) -> f64 {
        evaluate(&self.magnitudes[..self.coefficients.len()], s)
    }

    /// Two parts, by de Casteljau's algorithm, divided where the polynomial has a certain sign if such a point is at hand.
    fn divided(&self, part: &Subinterval) -> [Subinterval; 2] {
        let n = self.coefficients.len() - 1;
        let width = part.to - part.from;
        let mut tried = 0;
        loop {
            let ratio = DIVISIONS[tried];
            let at = part.from + ratio * width;
            let (mut left, mut right) = (part.control, part.control);
            for (j, corner) in left[..=n].iter_mut().enumerate() {
                *corner = right[0];
                let row = &mut right[..=n - j];
                for i in 1..row.len() {
                    row[i - 1] = (1.0 - ratio) * row[i - 1] + ratio * row[i];
                }
            }
            // a mean of two rounds once, any other three times
            let roundings = if ratio == 0.5 { 1.0 } else { 3.0 };
            let noise = part.noise + roundings * n as f64 * UNIT;
            tried += 1;
            if right[0].abs() > 2.0 * FIRM * noise * self.magnitude(at) || tried == DIVISIONS.len()
            {
                let depth = part.depth + 1;
                let side = |control, from, to| Subinterval {
                    control,
                    from,
                    to,
                    noise,
                    depth,
                };
                return [side(left, part.from, at), side(right, at, part.to)];
            }
        }
    }

    /// The signs just before and just after the end, in the order of the way.
    fn signs_around_end(&self, end: f64) -> (f64, f64) {
        if end != 0.0 {
            return (end.signum(), end.signum());
        }
        let along = self.length.signum();
        let mut direction = 1.0;
        for order in 1..self.coefficients.len() {
            direction *= along;
            let (slope, _) = evaluate_derivative(self.coefficients, order, self.length);
            if slope != 0.0 {
                let after = (slope * direction).signum();
                return (if order % 2 == 0 { after } else { -after }, after);
            }
        }
        (self.sign, self.sign)
    }

    /// A cluster ends where the polynomial has a certain sign again.
    fn close_cluster(&mut self, sign: f64) {
        let Some(cluster) = self.cluster.take() else {
            return;
        };
        if sign != self.sign {
            self.cross((cluster.from, cluster.to), false, cluster.noise, sign);
        } else if let Some(at) = self.extremum(cluster) {
            self.push(at, sign);
        }
    }

    fn finish(&mut self, end: f64, after_end: f64) {
        if end == 0.0 {
            // what clusters at the end is one with the root there
            self.cluster = None;
            self.push(self.length, after_end);
        } else {
            self.close_cluster(end.signum());
        }
    }

    /// The root between two points of opposite signs, the second with the sign given.
    fn cross(&mut self, (from, to): (f64, f64), sharp: bool, noise: f64, sign: f64) {
        let at = if sharp {
            None
        } else {
            // a multiple root is flat: its second derivative tells better where it is
            self.zero_of_derivative(2, from, to).filter(|t| {
                let s = t / self.length;
                evaluate(self.coefficients, *t).abs() <= 4.0 * noise * self.magnitude(s)
            })
        };
        let at = at.or_else(|| self.zero_of_derivative(0, from, to));
        self.push(at.unwrap_or(self.length * to), sign);
    }

    /// Where a cluster without a change of sign comes closest to zero. `None` if that is beyond the end, or so close to 0
    /// that nothing is known.
    fn extremum(&self, cluster: Cluster) -> Option<f64> {
        if cluster.from == 0.0 {
            return None;
        }
        let at = self.zero_of_derivative(1, cluster.from, cluster.to);
        let (_, slope) = evaluate_derivative(self.coefficients, 0, self.length);
        if at.is_none() && cluster.to == 1.0 && self.sign * slope * self.length < 0.0 {
            return None;
        }
        let middle = 0.5 * cluster.from + 0.5 * cluster.to;
        Some(at.unwrap_or(self.length * middle))
    }

    /// The zero of a derivative between two points, if it changes sign there.
    fn zero_of_derivative(&self, order: usize, from: f64, to: f64) -> Option<f64> {
        let g = |t| evaluate_derivative(self.coefficients, order, t);
        let (a, b) = (self.length * from, self.length * to);
        bracketed_root("a root of a polynomial", a, b, g).ok()
    }

    /// Appends a root after which the polynomial has the sign given.
    fn push(&mut self, at: f64, sign: f64) {
        let crossing = if sign == self.sign {
            Crossing::Touching
        } else if (sign > 0.0) != self.turned {
            Crossing::Upwards
        } else {
            Crossing::Downwards
        };
        self.sign = sign;
        // 0 is not of this step, even where the root underflows
        let at = if at == 0.0 {
            f64::from_bits(1).copysign(self.length)
        } else {
            at
        };
        self.found.push(Root { at, crossing });
    }
}
