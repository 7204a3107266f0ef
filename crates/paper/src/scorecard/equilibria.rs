//! Steady states of the two interfaces, their pitchforks and the fold V_sn: sections 3.2.1 and 4.2, Fig. 5.

use super::exact::{self, Strength};
use super::{
    Answer, Entry, criticality_word, extrema, holds, missing, of_rounded_parameters, slab, whether,
};
use crate::Pieces;
use twinslip::bifurcation::{Label, Special};
use twinslip::equilibrium::{
    Equilibrium, Solver, SteadyStates, Symmetry, Verdict, stability, steady_states,
};
use twinslip::error::Result;
use twinslip::friction::{AnyLaw, steady_stress};
use twinslip::number::{DoubleDouble, Real, Uncertain};

/// How near to a pitchfork the steady states are counted, relative.
const BESIDE: f64 = 1e-9;
/// K of Fig. 5.
const STIFFNESS: f64 = 0.45;

fn states(law: &AnyLaw, driving: f64) -> Result<SteadyStates> {
    steady_states(law, driving, 2, Solver::Newton)
}

/// How many steady states there are just below and just above a V_H; `None` where that is not certain.
fn counted(law: &AnyLaw, driving: f64) -> Result<Option<[usize; 2]>> {
    let sides = [1.0 - BESIDE, 1.0 + BESIDE].map(|side| states(law, driving * side));
    let [below, above] = sides;
    let (below, above) = (below?, above?);
    let certain = below.complete && above.complete;
    Ok(certain.then_some([below.equilibria.len(), above.equilibria.len()]))
}

/// The states of different slip rates that the text of 3.2.1 finds near the extrema.
pub fn of_section_3(pieces: &Pieces<'_>) -> Result<Vec<Entry>> {
    let law = pieces.law();
    let extrema = extrema(&law)?;
    let counts = [
        counted(&law, 2.0 * extrema[0])?,
        counted(&law, 2.0 * extrema[1])?,
    ];
    let diagram = pieces.branches("fig05")?;
    let coefficients = pitchforks(&diagram.special).filter_map(|special| special.coefficient);
    let coefficients: Vec<f64> = coefficients.collect();
    let [at_peak, at_trough] = coefficients[..] else {
        return Err(missing("fig05 has no two pitchforks"));
    };
    // At a minimum tau_ss'' > 0, so that -3 tau_ss''/tau_ss''' > 0 means tau_ss''' < 0.
    let in_spite = counts[1] == Some([2, 3]) && at_trough > 0.0;
    Ok(vec![
        at_extrema(&law, counts, extrema[0], at_peak)?,
        Entry::claim(
            ("steeper-strengthening", "section 3.2.1, last paragraph"),
            "asymmetric states near an extremum require that strengthening is steeper than \
             weakening, tau_ss''' > 0",
            "required",
            whether(in_spite, "not required", "required"),
        )
        .noted(
            "at V_m tau_ss''' < 0, and asymmetric states are there all the same, subcritical and \
             unstable",
        ),
    ])
}

/// Where the asymmetric states begin, and how.
fn at_extrema(
    law: &AnyLaw,
    counts: [Option<[usize; 2]>; 2],
    v_peak: f64,
    coefficient: f64,
) -> Result<Entry> {
    let square = |part: f64| -> Result<f64> {
        let driving = 2.0 * v_peak * (1.0 + part);
        let states = states(law, driving)?;
        let rates = &asymmetric(&states, 0)?.slip_rate;
        Ok((0.5 * (rates[1] - rates[0])).powi(2) / (driving - 2.0 * v_peak))
    };
    // The limit, up to the square of the distance.
    let limit = 2.0 * square(1e-4)? - square(2e-4)?;
    let there = counts == [Some([1, 2]), Some([2, 3])];
    let as_told = there && (limit / coefficient - 1.0).abs() < 1e-6;
    Ok(Entry::claim(
        ("pitchforks-at-extrema", "section 3.2.1, (23), (24)"),
        "asymmetric states part from the symmetric one at V_H = 2 V_e, as (24) says",
        "holds",
        holds(as_told),
    )
    .noted(format!(
        "the steady states are counted at 1e-9 below and above, with certain signs: 1 and 2 at \
         2 V_M, 2 and 3 at 2 V_m; the coefficient of (24) is {coefficient:.9}, and {limit:.9} the \
         limit of [(V_1 - V_2)/2]^2/(V_H - 2 V_M) of steady states beside 2 V_M"
    )))
}

fn pitchforks(special: &[Special]) -> impl Iterator<Item = &Special> {
    special.iter().filter(|s| s.label == Label::Bp)
}

/// The asymmetric state with the i-th slowest slower interface.
fn asymmetric(states: &SteadyStates, i: usize) -> Result<&Equilibrium> {
    let of = |e: &&Equilibrium| e.symmetry == Symmetry::Asymmetric;
    let mut all: Vec<_> = states.equilibria.iter().filter(of).collect();
    all.sort_by(|a, b| a.slip_rate[0].total_cmp(&b.slip_rate[0]));
    let found = all.get(i).copied();
    found.ok_or_else(|| missing("an asymmetric steady state"))
}

/// Which way the pitchfork at twice this rate goes, from the state next to the symmetric one on its upper side: stable or not.
fn way(law: &AnyLaw, v: f64) -> Result<&'static str> {
    let beside = states(law, 2.0 * v * (1.0 + 1e-4))?;
    let near = |e: &&Equilibrium| {
        e.symmetry == Symmetry::Asymmetric && (e.slip_rate[0] / v - 1.0).abs() < 0.1
    };
    let next = beside.equilibria.iter().find(near);
    let next = next.ok_or_else(|| missing("no steady state beside the pitchfork"))?;
    Ok(match stability(law, next, STIFFNESS)?.verdict {
        Verdict::Stable => "supercritical",
        Verdict::Unstable => "subcritical",
        Verdict::Undecided => "undecided",
    })
}

/// The pitchforks by their names, and which way they go as printed.
const PITCHFORKS: [[&str; 3]; 2] = [
    [
        "pitchfork-at-2V_M",
        "the pitchfork at V_H = 2 V_M",
        "supercritical",
    ],
    [
        "pitchfork-at-2V_m",
        "the pitchfork at V_H = 2 V_m",
        "subcritical",
    ],
];

/// The spinodal branch of Fig. 5, its pitchforks and its fold.
pub fn of_section_4(pieces: &Pieces<'_>) -> Result<Vec<Entry>> {
    let law = pieces.law();
    let extrema = extrema(&law)?;
    let diagram = pieces.branches("fig05")?;
    let mut all = vec![at_the_ends(pieces)?];
    let found = pitchforks(&diagram.special).zip(PITCHFORKS).zip(extrema);
    for ((special, [id, quantity, printed]), v) in found {
        let word = criticality_word(special.criticality);
        let entry = Entry::claim((id, "section 4.2; Figs 5, 6"), quantity, printed, word);
        let beside = Answer::Word(way(&law, v)?);
        let at = special.driving.value;
        all.push(
            entry
                .beside("stability of the states beside it", beside)
                .noted(format!("at V_H = {at:.9}, by the sign of tau_ss'''")),
        );
    }
    let fold = diagram.special.iter().find(|s| s.label == Label::Lp);
    let fold = fold.ok_or_else(|| missing("fig05 has no fold"))?.driving;
    all.push(unstable_pair(&law, 2.0 * extrema[1], fold.value)?);
    all.extend(the_fold(&law, extrema[0], fold));
    all.push(slow_interface(pieces, extrema[0])?);
    Ok(all)
}

fn at_the_ends(pieces: &Pieces<'_>) -> Result<Entry> {
    let mut stable = true;
    for driving in [1e-3, 1e6] {
        for stiffness in [1e-3, 0.14, STIFFNESS, 10.0] {
            let law = slab(pieces, driving, stiffness)?.law;
            let found = states(&law, driving)?;
            let alone = found.complete && found.equilibria.len() == 1;
            let verdict = stability(&law, &found.equilibria[0], stiffness)?.verdict;
            stable &= alone && verdict == Verdict::Stable;
        }
    }
    Ok(Entry::claim(
        ("stable-at-both-ends", "section 4.2; Fig. 5"),
        "the symmetric equilibrium at V_H = 1e-3 V* and 1e6 V*",
        "stable",
        whether(stable, "stable", "not stable"),
    )
    .noted("Routh-Hurwitz in interval arithmetic, K from 1e-3 to 10"))
}

fn unstable_pair(law: &AnyLaw, from: f64, to: f64) -> Result<Entry> {
    /// V_H between the pitchfork and the fold.
    const PARTS: usize = 40;
    let mut unstable = true;
    for i in 0..PARTS {
        let part = (i as f64 + 0.5) / PARTS as f64;
        let driving = from * (to / from).powf(part);
        let found = states(law, driving)?;
        let middle = asymmetric(&found, 1)?;
        for stiffness in [1e-2, STIFFNESS, 10.0] {
            let verdict = stability(law, middle, stiffness)?.verdict;
            unstable &= found.equilibria.len() == 3 && verdict == Verdict::Unstable;
        }
    }
    let counts = [counted(law, from)?, counted(law, to)?];
    let ends = counts == [Some([2, 3]), Some([3, 1])];
    Ok(Entry::claim(
        ("unstable-pair", "section 4.2; Fig. 5"),
        "the asymmetric equilibria that exist for 2 V_m <= V_H <= V_sn besides the stable ones",
        "unstable pair",
        whether(unstable && ends, "unstable pair", "otherwise"),
    )
    .noted(
        "counted with certain signs within, and at 1e-9 inside and outside of both ends; K = \
         0.01, 0.45, 10",
    ))
}

fn the_fold(law: &AnyLaw, v_peak: f64, fold: Uncertain) -> [Entry; 3] {
    let [slow, fast] = Strength::Residual.fold([v_peak, fold.value - v_peak]);
    let exact = (slow + fast).to_f64();
    let entry = Entry::number(
        ("V_sn", "section 4.2"),
        "V_sn, the fold of the asymmetric equilibria",
        "V*",
        "4.30e4",
        fold,
    );
    [
        entry.beside_number(
            "Newton's method in 31 digits, decimal parameters",
            exact,
            2.0 * f64::EPSILON * exact,
        ),
        stress_at_the_fold(law, v_peak, [slow, fast]),
        approximate_fold(),
    ]
}

fn stress_at_the_fold(law: &AnyLaw, v_peak: f64, [slow, fast]: [DoubleDouble; 2]) -> Entry {
    let driving = (slow + fast).to_f64();
    let apart = steady_stress(law, driving) - steady_stress(law, v_peak);
    let stress = |v: DoubleDouble| Strength::Residual.steady_stress(v);
    let below = (stress(DoubleDouble::constant(v_peak)) - stress(slow)).to_f64();
    Entry::claim(
        ("stress-at-V_sn", "section 4.2"),
        "tau_ss(V_sn) = tau_ss(V_M)",
        "exactly",
        whether(apart == 0.0, "exactly", "nearly"),
    )
    .noted(format!(
        "tau_ss(V_sn) - tau_ss(V_M) = {apart:.2e}; at the fold the faster interface has {:.6}, \
         V_sn less the slower one's rate, and tau_ss there is still {below:.1e} below that at V_M",
        fast.to_f64(),
    ))
}

/// V_sn/V* ~ (beta-1)^(beta-1)/R [(1+R)/(c beta)]^beta
fn approximate_fold() -> Entry {
    let beta = 0.0489_f64 / 0.0349;
    let near = (beta - 1.0).powf(beta - 1.0) / 100.0 * (101.0 / (1e-3 * beta)).powf(beta);
    let beta = exact::beta::<DoubleDouble>();
    let less_one = beta - 1.0;
    let power = beta * (DoubleDouble::constant(1.01e5) / beta).ln() + less_one * less_one.ln();
    let in_31_digits = (power.exp() / 100.0).to_f64();
    let rounding = 16.0 * f64::EPSILON * near;
    Entry::number(
        ("V_sn-approximate", "section 4.2"),
        "(beta-1)^(beta-1)/R [(1+R)/(c beta)]^beta, to which V_sn comes near",
        "V*",
        "4.440e4",
        of_rounded_parameters(Uncertain::new(near, rounding)),
    )
    .beside_number(
        "31 digits, decimal parameters",
        in_31_digits,
        2.0 * f64::EPSILON * near,
    )
}

/// The rate of the slower interface along the branch of stable asymmetric equilibria.
fn slow_interface(pieces: &Pieces<'_>, v_peak: f64) -> Result<Entry> {
    let diagram = pieces.branches("fig05")?;
    let stable = |row: &&twinslip::bifurcation::BranchRow| {
        row.slip_rate[0] != row.slip_rate[1] && row.verdict == Verdict::Stable
    };
    let largest = diagram.rows.iter().filter(stable);
    let largest = largest
        .map(|row| row.slip_rate[0].min(row.slip_rate[1]))
        .fold(0.0, f64::max);
    let fold = diagram.rows.iter().find(|row| row.label == Some(Label::Lp));
    let fold = fold.ok_or_else(|| missing("fig05 has no fold"))?;
    let at_fold = fold.slip_rate[0].min(fold.slip_rate[1]);
    Ok(Entry::claim(
        ("slow-interface-below-V_M", "section 4.2; Fig. 5(d)"),
        "the slower interface of an asymmetric equilibrium has V < V_M, up to V_sn",
        "always",
        whether(
            largest.max(at_fold) < v_peak,
            "always",
            "but for the last bit before V_sn",
        ),
    )
    .noted(format!(
        "at V_sn it exceeds V_M by the part {:.2e}: the fold is not where the slower rate is \
         V_M",
        at_fold / v_peak - 1.0
    )))
}
