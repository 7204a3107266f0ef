//! The coefficients of the normal forms of equilibria at points of codimension two: cusp, Bogdanov-Takens, generalised Hopf, zero-Hopf, double Hopf.
//!
//! Kuznetsov, Y. A. (2004). Elements of Applied Bifurcation Theory, 3rd edition, sections 8.2 to 8.7;
//!
//! Kuznetsov, Y. A. (1999). Numerical normalization techniques for all codim 2 bifurcations of equilibria in ODE's. SIAM J. Numer. Anal. 36, 1104-1124.
//!
//! Critical eigenvectors have the length 1. The coefficients are computed again at points that differ by what the point may be off, and from other
//! directions: what they differ by there, several times, is their bound.

use super::centre_manifold::{CentreManifold, Critical, DoubleZero};
use crate::bifurcation::{Criticality, Label};
use crate::field::Vector;
use crate::number::Uncertain;
use crate::orbit::ParametrisedField;

/// A coefficient of a normal form.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NormalFormCoefficient {
    /// Its name in the book.
    pub name: &'static str,
    /// Its value, for the unit of time in which the system is followed.
    pub value: Uncertain,
    /// The power of time that it is measured in.
    pub time: i32,
}

/// A point of codimension two.
pub(super) struct CodimensionTwo<'a> {
    pub family: &'a dyn ParametrisedField,
    pub label: Label,
    /// The state with both coordinates, and what these may be off.
    pub unknowns: &'a Vector,
    pub off: &'a Vector,
    /// omega of all pairs on the imaginary axis, the slowest first.
    pub frequencies: &'a [f64],
}

type Values = Vec<(&'static str, f64, i32)>;

impl CodimensionTwo<'_> {
    /// Its coefficients; none where they are not known.
    pub fn coefficients(&self) -> Vec<NormalFormCoefficient> {
        /// So many points beside it, what the largest difference counts, and what is left by rounding at least.
        const TRIED: usize = 6;
        const SAFETY: f64 = 8.0;
        const LEAST: f64 = 16.0 * f64::EPSILON;
        let Some(here) = self.values(self.unknowns, 0) else {
            return Vec::new();
        };
        let mut far = vec![0.0_f64; here.len()];
        for trial in 1..=TRIED {
            let moved = Vector::from_fn(self.unknowns.len(), |i, _| {
                let sign = super::generic_curve_problem::sign(i, trial);
                let x = self.unknowns[i];
                x + sign * (self.off[i] + f64::EPSILON * x.abs())
            });
            let there = self.values(&moved, trial);
            for (i, (far, (_, x, _))) in far.iter_mut().zip(&here).enumerate() {
                let there = there.as_ref().map_or(f64::INFINITY, |there| there[i].1);
                *far = far.max((there - x).abs());
            }
        }
        let all = here.into_iter().zip(far);
        let all = all.map(|((name, x, time), far)| NormalFormCoefficient {
            name,
            value: Uncertain::new(x, SAFETY * far + LEAST * x.abs()),
            time,
        });
        let all: Vec<_> = all.collect();
        let known = |one: &NormalFormCoefficient| one.value.uncertainty.is_finite();
        match all.iter().all(known) {
            true => all,
            false => Vec::new(),
        }
    }

    fn values(&self, unknowns: &Vector, trial: usize) -> Option<Values> {
        let n = unknowns.len() - 2;
        let state = unknowns
            .rows(0, self.family.dimension().min(n))
            .into_owned();
        if state.len() != self.family.dimension() {
            return None;
        }
        let field = self.family.field([unknowns[n], unknowns[n + 1]]);
        let units = self.family.units();
        let manifold = |zero: bool, order: usize| {
            let critical = Critical {
                field: &field,
                state: &state,
                zero,
                frequencies: self.frequencies,
            };
            CentreManifold::of(&critical, units, (order, trial))
        };
        match self.label {
            // (8.28): w' = c w^3.
            Label::Cp => {
                let made = manifold(true, 3)?;
                Some(vec![("c", made.term(&[3], 0).re, -1)])
            }
            // (8.75): w_0' = w_1, w_1' = a w_0^2 + b w_0 w_1.
            Label::Bt => {
                let DoubleZero { q, p } = DoubleZero::of(&field.jacobian(&state), units)?;
                let square = field.second_derivative(&state, &q[0], &q[0]);
                let mixed = field.second_derivative(&state, &q[0], &q[1]);
                let a = 0.5 * p[1].dot(&square);
                let b = p[0].dot(&square) + p[1].dot(&mixed);
                // With the other sign of the vectors both have the other sign.
                let sign = a.signum();
                Some(vec![("a", a * sign, -2), ("b", b * sign, -1)])
            }
            // w' = i omega w + c_1 w |w|^2 + c_2 w |w|^4, where the real part of c_1 is zero.
            Label::Gh => {
                let made = manifold(false, 5)?;
                let l_2 = made.term(&[3, 2], 0).re / self.frequencies.first()?;
                Some(vec![("l_2", l_2, 0)])
            }
            Label::Zh => zero_hopf(&manifold(true, 3)?),
            Label::Hh => double_hopf(&manifold(false, 3)?),
            _ => None,
        }
    }
}

/// s, theta and E of (8.83) to (8.86): u' = beta_1 + u^2 + s |v|^2, v' = (beta_2 + i omega) v + (theta + i theta_1) u v + u^2 v.
fn zero_hopf(made: &CentreManifold) -> Option<Values> {
    // (j! k! l!) times the terms.
    let of = |powers: [u8; 3], j: usize| {
        let factorials: f64 = powers
            .iter()
            .map(|&k| [1.0, 1.0, 2.0, 6.0][usize::from(k)])
            .product();
        made.term(&powers, j) * factorials
    };
    let [g_200, g_300] = [of([2, 0, 0], 0).re, of([3, 0, 0], 0).re];
    let [g_011, g_111] = [of([0, 1, 1], 0).re, of([1, 1, 1], 0).re];
    let [g_110, g_210, g_021] = [[1, 1, 0], [2, 1, 0], [0, 2, 1]].map(|powers| of(powers, 1));
    let theta = g_110.re / (0.5 * g_200);
    let other = g_021.re / g_011 - g_300 / g_200 + g_111 / g_011;
    let e = 0.5 * (g_210 + g_110 * other - g_021 * (g_200 / (2.0 * g_011))).re;
    let values = vec![
        ("s", (g_200 * g_011).signum(), 0),
        ("theta", theta, 0),
        ("E_0", e, -1),
    ];
    values
        .iter()
        .all(|(_, x, _)| x.is_finite())
        .then_some(values)
}

/// Of the slower pair and the faster one p_jk, theta and delta of (8.110) and (8.112): r_1' = r_1 (mu_1 + p_11 r_1^2 + p_12 r_2^2), r_2' = r_2 (mu_2 + p_21 r_1^2 + p_22 r_2^2).
fn double_hopf(made: &CentreManifold) -> Option<Values> {
    let p_11 = made.term(&[2, 1, 0, 0], 0).re;
    let p_12 = made.term(&[1, 0, 1, 1], 0).re;
    let p_21 = made.term(&[1, 1, 1, 0], 2).re;
    let p_22 = made.term(&[0, 0, 2, 1], 2).re;
    let values = vec![
        ("theta", p_12 / p_22, 0),
        ("delta", p_21 / p_11, 0),
        ("p_11", p_11, -1),
        ("p_12", p_12, -1),
        ("p_21", p_21, -1),
        ("p_22", p_22, -1),
    ];
    values
        .iter()
        .all(|(_, x, _)| x.is_finite())
        .then_some(values)
}

/// What the coefficients say.
#[derive(Debug, Clone, Default, PartialEq)]
pub(in crate::bifurcation) struct Unfolding {
    /// Whether what bifurcates is stable, where one coefficient says that.
    pub criticality: Option<Criticality>,
    /// The case of the book.
    pub case: Option<String>,
}

/// What the coefficients of a point say of its surroundings.
pub(in crate::bifurcation) fn unfolding(label: Label, all: &[NormalFormCoefficient]) -> Unfolding {
    let of = |name: &str| all.iter().find(|one| one.name == name).map(|one| one.value);
    let sign = |x: Uncertain| (x.value.abs() > x.uncertainty).then(|| x.value.signum());
    let product = |a: &str, b: &str| Some(sign(of(a)?)? * sign(of(b)?)?);
    let unknown = Unfolding::default();
    if all.is_empty() {
        return unknown;
    }
    let stable = |sign: Option<f64>| {
        Some(match sign {
            Some(sign) if sign < 0.0 => Criticality::Supercritical,
            Some(_) => Criticality::Subcritical,
            None => Criticality::Undecided,
        })
    };
    match label {
        Label::Cp => Unfolding {
            criticality: stable(of("c").and_then(sign)),
            ..unknown
        },
        Label::Gh => Unfolding {
            criticality: stable(of("l_2").and_then(sign)),
            ..unknown
        },
        // The orbits that begin at the Hopf points are stable where a b < 0.
        Label::Bt => Unfolding {
            criticality: stable(product("a", "b")),
            ..unknown
        },
        // Of w_0' = w_1, w_1' = a w_0^2 + (b - 2 a) w_0 w_1, which the map approximates for the time 1, as at a Bogdanov-Takens point.
        Label::R1 => {
            let flow = of("a").zip(of("b")).and_then(|(a, b)| {
                let off = b.uncertainty + 2.0 * a.uncertainty;
                Some(sign(a)? * sign(Uncertain::new(b.value - 2.0 * a.value, off))?)
            });
            Unfolding {
                criticality: stable(flow),
                ..unknown
            }
        }
        // Of w_0' = w_1, w_1' = 4 C_1 w_0^3 - (2 D_1 + 6 C_1) w_0^2 w_1, which its square does.
        Label::R2 => {
            let flow = of("C_1").zip(of("D_1")).and_then(|(c, d)| {
                let off = d.uncertainty + 3.0 * c.uncertainty;
                sign(Uncertain::new(-d.value - 3.0 * c.value, off))
            });
            let case = match of("C_1").and_then(sign) {
                Some(s) => format!("s = {s}"),
                None => "undecided case".into(),
            };
            Unfolding {
                criticality: stable(flow),
                case: Some(case),
            }
        }
        Label::R3 => Unfolding {
            criticality: stable(of("C_1").and_then(sign)),
            ..unknown
        },
        Label::R4 => Unfolding {
            criticality: stable(of("Re A_0").and_then(sign)),
            ..unknown
        },
        Label::Zh => {
            let theta = of("theta").and_then(sign);
            let s = of("s").and_then(sign);
            let case = s.zip(theta).map(|(s, theta)| {
                let tori = if s * theta < 0.0 { "" } else { "no " };
                let side = if theta < 0.0 { "<" } else { ">" };
                format!("s = {s}, theta {side} 0: {tori}tori")
            });
            Unfolding {
                case: Some(case.unwrap_or_else(|| "undecided case".into())),
                ..unknown
            }
        }
        Label::Hh => Unfolding {
            case: Some(double_hopf_case(all).unwrap_or_else(|| "undecided case".into())),
            ..unknown
        },
        _ => unknown,
    }
}

/// The case of a double Hopf point (section 8.6.2): of the simple ones, where the coefficients of both pairs have one sign, which of the five it is.
fn double_hopf_case(all: &[NormalFormCoefficient]) -> Option<String> {
    let of = |name: &str| all.iter().find(|one| one.name == name).map(|one| one.value);
    let sign = |x: Uncertain| (x.value.abs() > x.uncertainty).then(|| x.value.signum());
    let (theta, delta) = (of("theta")?, of("delta")?);
    if sign(of("p_11")?)? * sign(of("p_22")?)? < 0.0 {
        return Some("difficult case".into());
    }
    let product = Uncertain::new(
        theta.value * delta.value - 1.0,
        theta.uncertainty * delta.value.abs()
            + delta.uncertainty * (theta.value.abs() + theta.uncertainty)
            + f64::EPSILON,
    );
    let case = match (sign(theta)?, sign(delta)?) {
        (a, b) if a != b => "III",
        (a, _) => match (a > 0.0, sign(product)? > 0.0) {
            (true, true) => "I",
            (true, false) => "II",
            (false, false) => "IV",
            (false, true) => "V",
        },
    };
    Some(format!("simple case {case}"))
}
