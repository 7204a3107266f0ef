//! Real roots of a polynomial on an interval: where a function given by its Taylor series crosses or touches zero within
//! a step.
//!
//! Signs of Bernstein coefficients isolate the roots (Descartes' rule; Lane and Riesenfeld 1981, Rouillier and Zimmermann
//! 2004, Efficient isolation of polynomial's real roots), with intervals halved by de Casteljau's algorithm; bracketed
//! Newton steps refine them. Every sign is trusted only beyond the rounding error of the coefficient that has it.

use super::bracketed_root;

/// The highest degree of which [`roots`] are found.
pub const MAX_DEGREE: usize = 40;

/// How a polynomial goes through a root, as its argument grows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Crossing {
    /// From negative to positive.
    Upwards,
    /// From positive to negative.
    Downwards,
    /// Without a change of sign: a root of even multiplicity, or roots too close to be told from one.
    Touching,
}

/// A real root.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Root {
    /// Where it is.
    pub at: f64,
    /// How the sign changes there.
    pub crossing: Crossing,
}

/// Value of sum_k c_k t^k (Horner).
#[inline]
pub fn evaluate(coefficients: &[f64], t: f64) -> f64 {
    let backwards = coefficients.iter().rev();
    backwards.fold(0.0, |value, c| value * t + c)
}

/// The derivative of the given order, and its slope (Horner).
#[inline]
pub fn evaluate_derivative(coefficients: &[f64], order: usize, t: f64) -> (f64, f64) {
    let (mut value, mut slope) = (0.0, 0.0);
    for (k, c) in coefficients.iter().enumerate().skip(order).rev() {
        let factor: f64 = (0..order).map(|i| (k - i) as f64).product();
        slope = slope * t + value;
        value = value * t + factor * c;
    }
    (value, slope)
}

/// Appends the real roots of sum_k c_k t^k between 0 and `length` to `found`, in the order in which they are met from 0.
///
/// The interval is half open: a root at exactly 0 belongs to the step before, one at exactly `length`, which may be
/// negative, to this one. Signs at the ends are those of c_0 and of [`evaluate`] at `length`, however small, and where these
/// are 0 those of the next derivative that is not: in steps that begin with the sign that the step before ended with, no
/// crossing is lost or found twice. An extremum that touches zero belongs to the step in whose half-open interval it lies.
///
/// With u = 2^-53, n the degree and A(t) = sum_k |c_k t^k|, the roots are those of a polynomial that differs from this one
/// by at most E(t) = (6 (n + 1) + 3 n d) u A(t), where d is the number of halvings that the closest roots take (some 20). So
/// a crossing is reported wherever the sign changes, as often as it changes by more than E in between. Where
/// |p| falls below E without a visible change of sign, [`Crossing::Touching`] is reported; where it stays above 4 E,
/// nothing is. Closer to 0 than 2^-100 of the length only a change of sign is seen. A simple root is as accurate as its evaluation; a multiple one is placed by a derivative.
///
/// No roots are found where a coefficient is not finite, a term overflows at `length`, or all coefficients are zero. Terms
/// that underflow count as zero. Nothing is allocated but in `found`.
///
/// # Panics
/// If the degree is above [`MAX_DEGREE`].
pub fn roots(coefficients: &[f64], length: f64, found: &mut Vec<Root>) {
    // Roots at 0 belong to the step before: divide by t.
    let Some(zeros) = coefficients.iter().position(|c| *c != 0.0) else {
        return;
    };
    let coefficients = &coefficients[zeros..];
    if length == 0.0 || first_outweighs(coefficients, length.abs()) {
        return;
    }
    let degree = coefficients.iter().rposition(|c| *c != 0.0).unwrap_or(0);
    assert!(
        degree <= MAX_DEGREE,
        "degree {degree} is above {MAX_DEGREE}"
    );
    let coefficients = &coefficients[..=degree];
    let terms = terms(coefficients, length);
    let end = evaluate(coefficients, length);
    let magnitudes = terms.map(f64::abs);
    let largest: f64 = magnitudes.iter().sum();
    if !(largest.is_finite() && end.is_finite()) {
        return;
    }
    let backwards = length < 0.0;
    let mut search = Search {
        coefficients,
        length,
        magnitudes,
        ends_in_zero: end == 0.0,
        turned: backwards && zeros % 2 == 0,
        sign: terms[0].signum(),
        cluster: None,
        found,
    };
    let mut control = bernstein(&terms, degree);
    let (before_end, after_end) = search.signs_around_end(end);
    control[degree] = if end == 0.0 {
        before_end * f64::MIN_POSITIVE
    } else {
        end
    };
    search.visit(&Part {
        control,
        from: 0.0,
        to: 1.0,
        noise: 6.0 * (degree + 1) as f64 * UNIT,
        depth: 0,
    });
    search.finish(end, after_end);
}

/// Unit roundoff.
const UNIT: f64 = 0.5 * f64::EPSILON;

/// How often an interval is halved at most.
const MAX_DEPTH: usize = 100;

/// Where to divide: in the middle, unless a root is there.
const DIVISIONS: [f64; 3] = [0.5, 0.4375, 0.5625];

/// By how much the ends of a bracket must exceed the error, so that no neighbour of it is [`Verdict::Noise`].
const FIRM: f64 = 8.0;

type Coefficients = [f64; MAX_DEGREE + 1];

/// Whether |c_0| exceeds all other terms together up to |t| = h: then there is no root. Four sums at a time, as one alone
/// waits for each product.
#[inline]
fn first_outweighs(coefficients: &[f64], h: f64) -> bool {
    let h4 = (h * h) * (h * h);
    let (blocks, rest) = coefficients[1..].as_chunks::<4>();
    let mut sums = [0.0; 4];
    for (sum, c) in sums.iter_mut().zip(rest) {
        *sum = c.abs();
    }
    for block in blocks.iter().rev() {
        for (sum, c) in sums.iter_mut().zip(block) {
            *sum = *sum * h4 + c.abs();
        }
    }
    let others = h * (sums[0] + h * (sums[1] + h * (sums[2] + h * sums[3])));
    // the margin is for the rounding of the sums
    coefficients[0].abs() > 1.000001 * others
}

/// c_k h^k, h^k in two factors, as it alone may overflow.
fn terms(coefficients: &[f64], length: f64) -> Coefficients {
    let mut terms = [0.0; MAX_DEGREE + 1];
    let mut power = 1.0;
    for (pair, c) in coefficients.chunks(2).enumerate() {
        for (odd, c) in c.iter().enumerate() {
            let next = if odd == 1 { power * length } else { power };
            terms[2 * pair + odd] = if *c == 0.0 { 0.0 } else { c * power * next };
        }
        power *= length;
    }
    terms
}

/// Bernstein coefficients on [0, 1]: B_i = sum_k C(i, k) / C(n, k) b_k, by the additions of Pascal's triangle.
fn bernstein(terms: &Coefficients, degree: usize) -> Coefficients {
    let mut control = *terms;
    let mut binomial = 1.0;
    for k in 1..=degree {
        binomial = binomial * (degree + 1 - k) as f64 / k as f64;
        control[k] /= binomial;
    }
    for k in 1..=degree {
        for i in (k..=degree).rev() {
            control[i] += control[i - 1];
        }
    }
    control
}

/// A part of the interval, which is [0, 1] here, with the polynomial's Bernstein coefficients on it.
struct Part {
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
enum Verdict {
    Free,
    /// One change of sign; `sharp` where no coefficient between is uncertain.
    Crossing {
        sharp: bool,
    },
    Noise,
    Unclear,
}

impl Search<'_> {
    fn visit(&mut self, part: &Part) {
        let n = self.coefficients.len() - 1;
        match self.verdict(part) {
            Verdict::Free => self.close_cluster(part.control[0].signum()),
            Verdict::Crossing { sharp } => {
                self.close_cluster(part.control[0].signum());
                let last = part.control[n].signum();
                self.cross((part.from, part.to), sharp, part.noise, last);
            }
            Verdict::Noise => {
                let from = self.cluster.map_or(part.from, |c| c.from);
                self.cluster = Some(Cluster {
                    from,
                    to: part.to,
                    noise: part.noise,
                });
            }
            Verdict::Unclear => {
                let [left, right] = self.divided(part);
                self.visit(&left);
                self.visit(&right);
            }
        }
    }

    fn verdict(&self, part: &Part) -> Verdict {
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
            Verdict::Free
        } else if !(open || gap) && changes == 1 && bracket {
            Verdict::Crossing { sharp }
        } else if largest <= 4.0 * part.noise * self.magnitude(part.from)
            || part.depth == MAX_DEPTH
            || middle <= part.from
            || middle >= part.to
        {
            Verdict::Noise
        } else {
            Verdict::Unclear
        }
    }

    /// A at a point of [0, 1].
    fn magnitude(&self, s: f64) -> f64 {
        evaluate(&self.magnitudes[..self.coefficients.len()], s)
    }

    /// Two parts, by de Casteljau's algorithm, divided where the polynomial has a certain sign if such a point is at hand.
    fn divided(&self, part: &Part) -> [Part; 2] {
        let n = self.coefficients.len() - 1;
        let width = part.to - part.from;
        let mut tried = 0;
        loop {
            let ratio = DIVISIONS[tried];
            let at = part.from + ratio * width;
            let (mut left, mut right) = (part.control, part.control);
            for j in 1..=n {
                for i in 0..=n - j {
                    right[i] = (1.0 - ratio) * right[i] + ratio * right[i + 1];
                }
                left[j] = right[0];
            }
            // a mean of two rounds once, any other three times
            let roundings = if ratio == 0.5 { 1.0 } else { 3.0 };
            let noise = part.noise + roundings * n as f64 * UNIT;
            tried += 1;
            if right[0].abs() > 2.0 * FIRM * noise * self.magnitude(at) || tried == DIVISIONS.len()
            {
                let depth = part.depth + 1;
                let side = |control, from, to| Part {
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
