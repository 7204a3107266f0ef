//! Linear stability of steady sliding: sections 3.1 and 3.2.2, appendix A. The paper's letters are taken from the friction law
//! here once more, beside what the room of equilibria does.

use super::{Answer, Entry, extrema, holds, missing, range, whether};
use crate::Pieces;
use twinslip::equilibrium::{Equilibrium, Solver, Symmetry, Verdict, stability, steady_states};
use twinslip::error::Result;
use twinslip::friction::{AnyLaw, Formulas, Parameters, critical_stiffness};
use twinslip::number::Jet;
use twinslip::orbit::hopf_points;

/// The stiffnesses that "whatever the stiffness" is held against.
const STIFFNESSES: [f64; 7] = [1e-4, 1e-3, 1e-2, 0.1, 1.0, 10.0, 100.0];

/// The frequency at the onset of stick-slip.
pub fn single_interface(_: &Pieces<'_>) -> Result<Vec<Entry>> {
    let law = AnyLaw::DieterichRuina(Parameters::heslot_1994().dieterich_ruina());
    let squared = |v: f64| -> Result<f64> {
        let states = steady_states(&law, v, 1, Solver::Newton)?;
        let at_onset = stability(&law, &states.equilibria[0], critical_stiffness(&law, v))?;
        Ok(at_onset.eigenvalues[0].im.powi(2))
    };
    let [one, ten] = [squared(1.0)?, squared(10.0)?];
    let constant = (ten / one - 1.0).abs() < 1e-6;
    let as_square = (ten / one / 100.0 - 1.0).abs() < 1e-6;
    let computed = match (constant, as_square) {
        (true, _) => "(b-a)/a",
        (_, true) => "(V/L)^2 (b-a)/a",
        _ => "otherwise",
    };
    Ok(vec![
        Entry::claim(
            ("frequency-at-onset", "section 3.1, (17)"),
            "omega_c^2 of one interface with the Dieterich-Ruina law",
            "(b-a)/a",
            computed,
        )
        .noted(format!(
            "from the eigenvalues at k_c: {one:.6} at V = V*, {ten:.4} at V = 10 V*, in (V*/L)^2"
        ))
        .misprinted("the factor (V/L)^2 is missing, which is 1 at V = V* in units of L/V*"),
    ])
}

/// What one interface contributes to (30), at its slip rate V.
#[derive(Debug, Clone, Copy)]
struct Letters {
    /// 1/F_V
    compliance: f64,
    /// s_i = k_c/F_V
    s: f64,
    /// a_i s_i = F_psi G_V / F_V^2  (31)
    a_s: f64,
}

impl Letters {
    fn at(law: &AnyLaw, v: f64) -> Self {
        let [rate, psi] = Jet::<f64, 2>::variables([v, law.steady_state(v)]);
        let [f_v, f_psi] = law.stress(rate, psi).gradient;
        let [minus_g_v, minus_g_psi] = law.evolution(rate, psi).gradient;
        // k_c = -G_psi tau_ss', with (15)
        let k_c = -(f_v * -minus_g_psi - f_psi * -minus_g_v);
        Letters {
            compliance: 1.0 / f_v,
            s: k_c / f_v,
            a_s: -f_psi * minus_g_v / (f_v * f_v),
        }
    }
}

/// The letters of appendix A for a pair of rates, the one on the weakening part first.
#[derive(Debug, Clone, Copy)]
struct RatePair {
    s: [f64; 2],
    a: [f64; 3],
}

impl RatePair {
    fn at(law: &AnyLaw, state: &Equilibrium) -> Self {
        let [one, two] = [1, 0].map(|i| Letters::at(law, state.slip_rate[i]));
        RatePair {
            s: [one.s, two.s],
            a: [
                one.a_s / one.s,
                two.a_s / two.s,
                one.compliance + two.compliance,
            ],
        }
    }

    /// c of (42).
    fn c(&self) -> f64 {
        let ([s1, s2], [a1, a2, a3]) = (self.s, self.a);
        s1 * (a1 - a3) + s2 * (a2 - a3)
    }

    /// Delta  (43)
    fn discriminant(&self) -> f64 {
        let ([s1, s2], [a1, a2, a3]) = (self.s, self.a);
        let mixed = -a3 * a3 + (a1 + a2) * a3 + a1 * a2;
        (a1 - a3).powi(2) * s1.powi(4)
            + 2.0 * mixed * (s1 * s2).powi(2)
            + (a2 - a3).powi(2) * s2.powi(4)
    }

    /// k_c^*  (34)
    fn critical(&self) -> f64 {
        let ([s1, s2], [a1, a2, a3]) = (self.s, self.a);
        let sum = s1 * s1 * (a1 - a3) + s2 * s2 * (a2 - a3) - 2.0 * s1 * s2 * a3;
        0.5 * (sum + self.discriminant().sqrt()) / (a3 * self.c())
    }

    /// How many roots of (42) are positive.
    fn positive_roots(&self) -> usize {
        let ([s1, s2], [a1, a2, a3]) = (self.s, self.a);
        let c = self.c();
        let linear = s1 * s2 * (a1 + a2) - c * (s1 + s2);
        let (product, sum) = (-s1 * s2 * (s1 + s2) / (c * a3), -linear / (c * a3));
        if sum * sum < 4.0 * product {
            return 0;
        }
        match (product > 0.0, sum > 0.0) {
            (true, true) => 2,
            (true, false) => 0,
            (false, _) => 1,
        }
    }
}

/// The asymmetric states with one interface on the weakening part, from near 2 V_M to near V_m.
fn weakening_states(law: &AnyLaw) -> Result<Vec<(f64, Equilibrium)>> {
    /// How many.
    const STATES: usize = 120;
    let [v_peak, v_trough] = extrema(law)?;
    let (from, to) = (2.0 * v_peak * (1.0 + 1e-4), v_trough * (1.0 - 1e-4));
    let mut all = Vec::new();
    for i in 0..STATES {
        let driving = from * (to / from).powf(i as f64 / (STATES - 1) as f64);
        let states = steady_states(law, driving, 2, Solver::Newton)?.equilibria;
        let state = states
            .into_iter()
            .find(|e| e.symmetry == Symmetry::Asymmetric);
        all.push((
            driving,
            state.ok_or_else(|| missing("no asymmetric steady state"))?,
        ));
    }
    Ok(all)
}

/// The verdicts on the symmetric state at these rates of an interface, whatever the stiffness; `None` if they are not all one.
fn symmetric(law: &AnyLaw, rates: &[f64]) -> Result<Option<Verdict>> {
    let mut verdicts = Vec::new();
    for v in rates {
        let states = steady_states(law, 2.0 * v, 2, Solver::Newton)?.equilibria;
        let state = states.iter().find(|e| e.symmetry == Symmetry::Symmetric);
        let state = state.ok_or_else(|| missing("no symmetric steady state"))?;
        for stiffness in STIFFNESSES {
            verdicts.push(stability(law, state, stiffness)?.verdict);
        }
    }
    let all = verdicts.iter().all(|v| *v == verdicts[0]);
    Ok(verdicts.first().copied().filter(|_| all))
}

/// Symmetric and asymmetric equilibria, section 3.2.2.
pub fn two_interfaces(pieces: &Pieces<'_>) -> Result<Vec<Entry>> {
    let law = pieces.law();
    let [v_peak, v_trough] = extrema(&law)?;
    let outside = [1e-3, 0.01, 0.9999 * v_peak, 1.0001 * v_trough, 1e4, 1e6];
    let inside = [1.0001 * v_peak, 0.05, 1.0, 10.0, 100.0, 0.9999 * v_trough];
    let as_told = symmetric(&law, &outside)? == Some(Verdict::Stable)
        && symmetric(&law, &inside)? == Some(Verdict::Unstable);
    let sums = weakening_states(&law)?.into_iter().map(|(_, state)| {
        let [s1, s2] = RatePair::at(&law, &state).s;
        (s1 + s2) / s1
    });
    let (least, most) = range(sums);
    let sign = match (least > 0.0, most < 0.0) {
        (true, _) => "positive",
        (_, true) => "negative",
        _ => "of either sign",
    };
    Ok(vec![
        Entry::claim(
            ("symmetric-state", "section 3.2.2, after (28)"),
            "the symmetric state is stable where V_H/2 is on a strengthening part and \
             unstable where on the weakening one, whatever K",
            "holds",
            holds(as_told),
        )
        .noted("Routh-Hurwitz in interval arithmetic, K from 1e-4 to 100"),
        Entry::claim(
            ("sum-of-rates", "section 3.2.2, before (34)"),
            "s_1 + s_2 of the asymmetric equilibria with s_1 > 0",
            "negative",
            sign,
        )
        .noted(format!(
            "(s_1 + s_2)/s_1 is between {least:.3} and {most:.3} from 2 V_M to \
         V_m: the slower interface's G_psi is much smaller"
        )),
        critical_stiffness_of_pairs(&law)?,
    ])
}

/// (34) against the Hopf points of the eigenvalues.
fn critical_stiffness_of_pairs(law: &AnyLaw) -> Result<Entry> {
    let mut largest: f64 = 0.0;
    for stiffness in [0.05, 0.14, 0.3] {
        let loading = twinslip::model::Loading::new(1.0, stiffness)?;
        let slab = twinslip::orbit::InterfaceSystem {
            law: *law,
            interfaces: 2,
            loading,
        };
        let along = twinslip::bifurcation::Parameter::Driving;
        for point in hopf_points(&slab, Symmetry::Asymmetric, along)? {
            let by_formula = RatePair::at(law, &point.equilibrium).critical();
            largest = largest.max((by_formula / stiffness - 1.0).abs());
        }
    }
    Ok(Entry::claim(
        (
            "critical-stiffness-of-asymmetric",
            "section 3.2.2, (34) with (43)",
        ),
        "k_c^* is the stiffness at which the asymmetric equilibrium has its Hopf point",
        "holds",
        holds(largest < 1e-9),
    )
    .noted(format!(
        "at the Hopf points that the eigenvalues of (30) have at K = 0.05, 0.14 \
     and 0.3 it differs from K by at most the part {largest:.0e}; it is the larger root of \
     (42) also where s_1 + s_2 > 0"
    )))
}

/// Appendix A.
pub fn of_the_appendix(pieces: &Pieces<'_>) -> Result<Vec<Entry>> {
    let law = pieces.law();
    let states = weakening_states(&law)?;
    let roots: Vec<usize> = states
        .iter()
        .map(|(_, state)| RatePair::at(&law, state).positive_roots())
        .collect();
    let all = |n: usize| roots.iter().all(|&roots| roots == n);
    let word = if all(1) {
        "one"
    } else if all(2) {
        "two"
    } else {
        "of either number"
    };
    let mut neutral = Vec::new();
    for (_, state) in states.iter().skip(20).step_by(25) {
        neutral.push(neutral_pairs(&law, state)?);
    }
    let second = whether(neutral.iter().all(|&n| n == 2), "two", "not two");
    Ok(vec![
        Entry::claim(
            ("roots-of-42", "appendix A, (42), before (44)"),
            "positive roots k of (42) for these parameters",
            "one",
            word,
        )
        .beside(
            "how often a pair of eigenvalues has the sum zero, over ten decades of K",
            Answer::Word(second),
        )
        .noted(
            "said under s_1 + s_2 < 0, which never is; k_c^* is the larger one, and at the \
             smaller one, below k_c^**, the pair is real: no Hopf point",
        ),
    ])
}

/// At how many K, over ten decades, two eigenvalues have the sum zero.
fn neutral_pairs(law: &AnyLaw, state: &Equilibrium) -> Result<usize> {
    let sums = |stiffness: f64| -> Result<f64> {
        let found = stability(law, state, stiffness)?.eigenvalues;
        let [a, b, c] = found[..] else {
            return Err(missing("a state of two interfaces has three eigenvalues"));
        };
        Ok(((a + b) * (a + c) * (b + c)).re)
    };
    let mut changes = 0;
    let mut last = sums(1e-8)?;
    for i in 1..=400 {
        let here = sums(10_f64.powf(-8.0 + 0.025 * f64::from(i)))?;
        changes += usize::from(here * last < 0.0);
        last = here;
    }
    Ok(changes)
}
