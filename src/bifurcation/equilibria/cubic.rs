//! The cubic P_3 (30) of an asymmetric equilibrium as appendix A looks at it: its real roots are where Q_3(s) meets the line
//! L(s), which no stiffness moves.
//!
//! P_3 is linear in K, so that K is a function of a real root: where that has an extremum Q_3 touches L, and two real roots
//! become a complex pair or come from one.

use crate::equilibrium::{Interface, routh_hurwitz};
use crate::friction::AnyLaw;
use crate::number::polynomial::{evaluate, roots};

/// P_3 of two interfaces that slide at different rates.
#[derive(Debug, Clone, Copy)]
pub struct CharacteristicCubic {
    one: Interface<f64>,
    two: Interface<f64>,
}

/// A stiffness at which Q_3 touches L.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Tangency {
    /// K.
    pub stiffness: f64,
    /// The double real root, in V*/L.
    pub growth_rate: f64,
}

impl CharacteristicCubic {
    /// At the rates V_1 and V_2, in this order: the paper's V_1 is the one on the weakening part.
    pub fn new(law: &AnyLaw, [v_1, v_2]: [f64; 2]) -> Self {
        let at = |v| Interface::at(law, v);
        CharacteristicCubic {
            one: at(v_1),
            two: at(v_2),
        }
    }

    /// s_1 and s_2, the roots of Q_3 beside -K a_3.
    pub fn rates(&self) -> [f64; 2] {
        [self.one.s, self.two.s]
    }

    /// a_3 = 1/F_V^(1) + 1/F_V^(2)  (33).
    pub fn compliance(&self) -> f64 {
        self.one.compliance + self.two.compliance
    }

    /// Q_3(s) = -(a_3 + s/K) (s - s_1) (s - s_2).
    pub fn q_3(&self, k: f64, s: f64) -> f64 {
        -(self.compliance() + s / k) * (s - self.one.s) * (s - self.two.s)
    }

    /// L(s) = (a_1 s_1 + a_2 s_2) s - s_1 s_2 (a_1 + a_2).
    pub fn line(&self, s: f64) -> f64 {
        self.one.a_s * (s - self.two.s) + self.two.a_s * (s - self.one.s)
    }

    /// [c_2, c_1, c_0] of P_3 = 0, written s^3 + c_2 s^2 + c_1 s + c_0 = 0.
    pub fn coefficients(&self, k: f64) -> [f64; 3] {
        routh_hurwitz(&self.one, &self.two, k)
    }

    /// The discriminant of P_3: positive where its roots are real and differ, negative where two are complex.
    pub fn discriminant(&self, k: f64) -> f64 {
        let [b, c, d] = self.coefficients(k);
        let (bb, cc) = (b * b, c * c);
        bb * cc - 4.0 * c * cc - 4.0 * bb * b * d - 27.0 * d * d + 18.0 * b * c * d
    }

    /// The real roots of P_3, ascending; a double one once.
    pub fn real_roots(&self, k: f64) -> Vec<f64> {
        let [b, c, d] = self.coefficients(k);
        real_roots(&[d, c, b, 1.0])
    }

    /// The K of which s is a root; `None` if there is no positive one.
    pub fn stiffness_of(&self, s: f64) -> Option<f64> {
        let product = (s - self.one.s) * (s - self.two.s);
        let k = -s * product / (self.compliance() * product + self.line(s));
        (k > 0.0 && k.is_finite()).then_some(k)
    }

    /// All stiffnesses at which Q_3 touches L, ascending.
    pub fn tangencies(&self) -> Vec<Tangency> {
        let [sum, product] = [self.one.s + self.two.s, self.one.s * self.two.s];
        // K = -m(s) / n(s), with n of degree two
        let m = [0.0, product, -sum, 1.0];
        let a_3 = self.compliance();
        let n = [
            a_3 * product + self.line(0.0),
            self.one.a_s + self.two.a_s - a_3 * sum,
            a_3,
        ];
        let turning = wronskian(&m, &n);
        let at = |s: f64| {
            let k = -evaluate(&m, s) / evaluate(&n, s);
            (k > 0.0 && k.is_finite()).then_some(Tangency {
                stiffness: k,
                growth_rate: s,
            })
        };
        let mut tangencies: Vec<_> = real_roots(&turning).into_iter().filter_map(at).collect();
        tangencies.sort_by(|a, b| a.stiffness.total_cmp(&b.stiffness));
        tangencies
    }

    /// k_c* (34), at which two roots are imaginary, and their omega; `None` where there is none.
    pub fn critical_stiffness(&self) -> Option<(f64, f64)> {
        let (one, two) = (&self.one, &self.two);
        let a_3 = self.compliance();
        let (sum, product) = (one.s + two.s, one.s * two.s);
        // c of (42), which is c_2 c_1 = c_0 of (30); a_i s_i is one number
        let c = one.a_s + two.a_s - a_3 * sum;
        let quadratic = c * a_3;
        let half = 0.5 * (one.a_s * two.s + two.a_s * one.s - c * sum);
        let constant = -product * sum;
        let discriminant = (half * half - quadratic * constant).sqrt();
        // without the subtraction of like numbers
        let adding = match half > 0.0 {
            true => -(half + discriminant),
            false => discriminant - half,
        };
        let k = match (adding > 0.0) == (quadratic > 0.0) {
            true => adding / quadratic,
            false => constant / adding,
        };
        let squared = routh_hurwitz(one, two, k)[1];
        (k > 0.0 && k.is_finite() && squared > 0.0).then(|| (k, squared.sqrt()))
    }
}

/// All real roots but 0, ascending: they are within Cauchy's bound.
fn real_roots(coefficients: &[f64]) -> Vec<f64> {
    let leading = coefficients[coefficients.len() - 1].abs();
    let largest = coefficients.iter().fold(0.0_f64, |x, c| x.max(c.abs()));
    let bound = 1.0 + largest / leading;
    let mut found = Vec::new();
    for length in [bound, -bound] {
        roots(coefficients, length, &mut found);
    }
    let mut found: Vec<f64> = found.iter().map(|root| root.at).collect();
    found.sort_by(f64::total_cmp);
    found
}

/// m' n - m n' of a cubic and a quadratic.
fn wronskian(m: &[f64; 4], n: &[f64; 3]) -> [f64; 5] {
    let mut w = [0.0; 5];
    for (i, a) in m.iter().enumerate() {
        for (j, b) in n.iter().enumerate() {
            // of m_i n_j (i - j) s^(i + j - 1); the term without s has i = j
            if i + j > 0 {
                w[i + j - 1] += (i as f64 - j as f64) * a * b;
            }
        }
    }
    w
}
