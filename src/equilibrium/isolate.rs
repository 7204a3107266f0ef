//! Where the asymmetric steady states are: one bracket of the slower rate for each solution of (20), and none overlooked.
//!
//! Two interfaces slide steadily at s < V_H/2 and V_H - s where tau_ss(V_H - s) = tau_ss(s)  (21). Stresses are compared by
//! what they activate, ln s(tau_ss), which rises and falls with them and has a double for any parameters: the zeros are those of
//! phi(s) = ln s(tau_ss(V_H - s)) - ln s(tau_ss(s)). The trivial one, s = V_H/2, the symmetric state, is divided out:
//! Q(s) = phi(s) / (V_H - 2 s), whose sign at V_H/2 is that of tau_ss'(V_H/2). The extrema of tau_ss cut (0, V_H/2) into pieces on which both stresses are monotonic. Where they fall and rise together phi is
//! monotonic and its signs at the ends decide; elsewhere its turning points, found by the sign of phi', cut further.
//! All signs that decide a count are evaluated in interval arithmetic: what can't be told is said.

use crate::error::Result;
use crate::friction::{Law, steady_log_activation, steady_log_slope};
use crate::number::{Difference, Interval, Jet, Real, bracketed_root, log_ratio};

/// Halvings of a piece towards each of its ends, in ln s, at which the sign of phi' is looked at: turning points gather
/// at the ends, where one of the two stresses has its extremum (near the fold V_sn at 2e-6 of V_M).
const GRADING: i32 = 40;
/// Equal parts of a piece besides.
const PARTS: i32 = 24;

/// Q(s), the difference quotient of the logarithm of the steady activation at the two rates s and V_H - s.
pub(super) fn quotient<T: Real>(law: &impl Law, driving: f64, s: T) -> T {
    let fast = T::constant(driving) - s;
    let gap = T::constant(driving) - s * 2.0;
    steady_log_activation(law, Difference::new(fast, s, gap)).gap / gap
}

/// phi'(s) s.
fn phi_slope<T: Real>(law: &impl Law, driving: f64, s: T) -> T {
    let fast = T::constant(driving) - s;
    -(steady_log_slope(law, fast) * (s / fast) + steady_log_slope(law, s))
}

/// A range of s with exactly one zero of Q.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Bracket {
    pub low: f64,
    pub high: f64,
}

/// All brackets by s ascending, and whether their number is certain.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Isolation {
    pub brackets: Vec<Bracket>,
    /// Whether there is one more below all, whose slower rate is smaller than any double.
    pub at_rest: bool,
    pub certain: bool,
}

/// Brackets of every asymmetric steady state at V_H.
pub(super) fn asymmetric(law: &impl Law, driving: f64) -> Result<Isolation> {
    let half = 0.5 * driving;
    let extrema = law.steady_extrema();
    let mut cuts: Vec<f64> = extrema
        .iter()
        .flat_map(|&e| [e, driving - e])
        .filter(|&s| s > 0.0 && s < half)
        .collect();
    cuts.sort_by(f64::total_cmp);
    if cuts.is_empty() {
        // Both rates lie on one monotonic piece of tau_ss. The pitchfork itself needs a look: is V_H/2 certainly on one side?
        let certain = extrema.is_empty()
            || steady_log_slope(law, Interval::constant(half))
                .sign()
                .is_some();
        return Ok(Isolation {
            brackets: Vec::new(),
            at_rest: false,
            certain,
        });
    }
    // Of tau_ss(V_H - s) less tau_ss(s) for s -> 0: tau_ss rises from 0, or falls from infinity.
    let at_rest = if law.weakens_from_rest() { -1.0 } else { 1.0 };
    cuts.insert(0, below_all(law, driving, cuts[0], at_rest));
    cuts.push(half);
    let mut ends = Vec::new();
    for piece in cuts.windows(2) {
        ends.push(piece[0]);
        ends.extend(turning_points(law, driving, piece[0], piece[1])?);
    }
    ends.push(half);

    let sign = |s: f64| {
        let point = Interval::constant(s);
        if s == half {
            steady_log_slope(law, point).sign()
        } else {
            quotient(law, driving, point).sign()
        }
    };
    let mut found = Isolation {
        brackets: Vec::new(),
        at_rest: sign(ends[0]) == Some(-at_rest),
        certain: true,
    };
    let mut last: Option<(f64, f64)> = None;
    for s in ends {
        match (last, sign(s)) {
            (_, None) => found.certain = false,
            (Some((low, left)), Some(right)) => {
                if left != right {
                    found.brackets.push(Bracket { low, high: s });
                }
                last = Some((s, right));
            }
            (None, Some(right)) => last = Some((s, right)),
        }
    }
    Ok(found)
}

/// A rate so small that nothing lies further down, as phi has the sign there that it has at rest: the first piece of tau_ss is monotonic.
/// The smallest normal double where no rate is so small.
fn below_all(law: &impl Law, driving: f64, first: f64, at_rest: f64) -> f64 {
    let mut s = 0.5 * first;
    while s > f64::MIN_POSITIVE
        && quotient(law, driving, Interval::constant(s)).sign() != Some(at_rest)
    {
        s = (0.125 * s).max(f64::MIN_POSITIVE);
    }
    s
}

/// The zeros of phi' inside a piece.
fn turning_points(law: &impl Law, driving: f64, low: f64, high: f64) -> Result<Vec<f64>> {
    let middle = low.sqrt() * high.sqrt();
    let [slow, fast] = [middle, driving - middle].map(|v| steady_log_slope(law, v));
    if slow * fast > 0.0 {
        return Ok(Vec::new());
    }
    let (a, width) = (low.ln(), log_ratio(low, high));
    let graded = (1..=GRADING).flat_map(|j| [0.5_f64.powi(j), 1.0 - 0.5_f64.powi(j)]);
    let even = (1..PARTS).map(|j| f64::from(j) / f64::from(PARTS));
    let mut samples: Vec<f64> = graded.chain(even).map(|x| (a + width * x).exp()).collect();
    samples.retain(|&s| s > low && s < high);
    samples.extend([low, high]);
    samples.sort_by(f64::total_cmp);
    samples.dedup();
    let mut found = Vec::new();
    for pair in samples.windows(2) {
        let (left, right) = (
            phi_slope(law, driving, pair[0]),
            phi_slope(law, driving, pair[1]),
        );
        if left * right < 0.0 {
            found.push(bracketed_root(
                "a turning point of the steady stress difference",
                pair[0],
                pair[1],
                |s| {
                    let jet = phi_slope(law, driving, Jet::<f64, 1>::variable(s, 0));
                    (jet.value, jet.gradient[0])
                },
            )?);
        }
    }
    Ok(found)
}
