//! Two interfaces with the Dieterich-Ruina law: section 3.3 and Fig. 3. The text gives neither stiffness nor starts of its runs;
//! those of the scenes fig03a and fig03b are on the two sides of K_c.

use super::{Answer, Entry, exact, missing, of_rounded_parameters, whether};
use crate::{Pieces, Run};
use twinslip::equilibrium::{Solver, Verdict, stability, steady_states};
use twinslip::error::Result;
use twinslip::friction::{AnyLaw, critical_stiffness, steady_stress_within};
use twinslip::integrate::Control;
use twinslip::number::{DoubleDouble, Uncertain};
use twinslip_tasks::scene::{Plan, Sampling, Sink, run};

/// How long localisation is waited for, beyond the scenes' own ends; below K_c the growing oscillation blows up at twice that.
const LONG: f64 = 1e3;

/// All of it.
pub fn entries(pieces: &Pieces<'_>) -> Result<Vec<Entry>> {
    let (stiff, soft) = (pieces.run("fig03a")?, pieces.run("fig03b")?);
    let law = stiff.law();
    let mut all = of_the_text(&law)?;
    all.push(localises(&stiff, &soft)?);
    all.push(the_weaker_one(&stiff, &soft)?);
    all.push(stick_slip(&stiff, &soft)?);
    Ok(all)
}

/// Whether the selected interface oscillates more and more: by the runs, and by the eigenvalues of one interface.
fn stick_slip(stiff: &Run, soft: &Run) -> Result<Entry> {
    let law = stiff.law();
    let state = &steady_states(&law, 1.0, 1, Solver::Newton)?.equilibria[0];
    let alone = |run: &Run| -> Result<bool> {
        Ok(stability(&law, state, run.loading().stiffness)?.eigenvalues[0].re > 0.0)
    };
    let word = |grows: [bool; 2]| match grows {
        [false, true] => "below K_c only",
        [true, true] => "on both sides",
        _ => "otherwise",
    };
    Ok(Entry::claim(
        ("stick-slip", "section 3.3; Fig. 3(b)"),
        "where an oscillation grows on the selected interface",
        "below K_c only",
        word([grows(stiff)?, grows(soft)?]),
    )
    .beside(
        "eigenvalues of one interface",
        Answer::Word(word([alone(stiff)?, alone(soft)?])),
    )
    .noted(format!(
        "runs at K = {} and {}, K_c = {:.6}; the text gives no stiffness",
        stiff.loading().stiffness,
        soft.loading().stiffness,
        critical_stiffness(&law, 1.0)
    )))
}

fn of_the_text(law: &AnyLaw) -> Result<Vec<Entry>> {
    let onset = critical_stiffness(law, 1.0);
    let less_one = (exact::beta::<DoubleDouble>() - 1.0).to_f64();
    let stress = steady_stress_within(law, 1.0, 0.0);
    let in_decimals = exact::reference_stress::<DoubleDouble>().to_f64();
    let symmetric = steady_stress_within(law, 0.5, 0.0).value;
    let place = "Fig. 3, caption";
    Ok(vec![
        Entry::number(
            ("stress-of-fig-3", place),
            "tau of the steady states of one interface \
         at V_H = V*",
            "a sigma",
            "10.7",
            of_rounded_parameters(stress),
        )
        .beside_number(
            "a_v/a in 31 digits",
            in_decimals,
            4.0 * f64::EPSILON * in_decimals,
        )
        .misprinted(&format!(
            "tau_ss(V*) = a_v/a rounds to 10.6; 10.7 is neither this nor \
             that of the symmetric state, {symmetric:.4}"
        )),
        no_effect_of_stiffness(law)?,
        Entry::number(
            ("K_c", "section 3.3"),
            "K_c = (b-a)/a of one interface with the Dieterich-Ruina law",
            "a sigma/L",
            "0.401",
            of_rounded_parameters(Uncertain::new(onset, 0.0)),
        )
        .beside_number("(b-a)/a in 31 digits", less_one, f64::EPSILON),
    ])
}

/// The verdict on the symmetric state and its eigenvalue k_c/F_V  (27), whatever the stiffness.
fn no_effect_of_stiffness(law: &AnyLaw) -> Result<Entry> {
    let state = &steady_states(law, 1.0, 2, Solver::Newton)?.equilibria[0];
    // k_c/F_V = (beta-1) V_H/2
    let expected = 0.5 * critical_stiffness(law, 1.0);
    let (mut unstable, mut moved) = (true, 0.0_f64);
    for i in 0..=24 {
        let stiffness = 10_f64.powf(-3.0 + 0.25 * f64::from(i));
        let found = stability(law, state, stiffness)?;
        unstable &= found.verdict == Verdict::Unstable;
        let near = found.eigenvalues.iter().map(|z| (z - expected).norm());
        moved = moved.max(near.fold(f64::INFINITY, f64::min) / expected);
    }
    Ok(Entry::claim(
        ("no-effect-of-stiffness", "section 3.3"),
        "effect of the stiffness on the instability of the symmetric state, Dieterich-Ruina law",
        "none",
        whether(unstable && moved < 1e-12, "none", "some"),
    )
    .noted(
        "unstable for K from 1e-3 to 1e3 by Routh-Hurwitz in interval arithmetic, always with \
         the eigenvalue k_c/F_V = (beta-1) V_H/2 of (27)",
    ))
}

/// The slip rates at the end of a longer run of the same scene, from its start or with the interfaces exchanged.
fn later(run_of: &Run, exchanged: bool) -> Result<[f64; 2]> {
    let mut start = run_of.plan.start.clone();
    if exchanged {
        start.swap_rows(1, 2);
    }
    let plan = Plan {
        start,
        until: LONG,
        sampling: Sampling::FinalOnly,
        picture: false,
        ..run_of.plan.clone()
    };
    let outcome = run(&plan, &mut Deaf)?;
    if let Some(failure) = outcome.failure {
        return Err(failure);
    }
    let last = outcome
        .last
        .ok_or_else(|| missing("a run without an end"))?;
    let at = |name: &str| {
        let column = plan.columns.iter().position(|column| column.name == name);
        column
            .map(|i| last[i])
            .ok_or_else(|| missing("a run without slip rates"))
    };
    Ok([at("slip_rate_1")?, at("slip_rate_2")?])
}

/// Only the end of the run is of interest.
struct Deaf;

impl Sink for Deaf {
    fn row(&mut self, _: &[f64]) -> Control {
        Control::Continue
    }
    fn reached(&mut self, _: f64) -> Control {
        Control::Continue
    }
}

fn localises(stiff: &Run, soft: &Run) -> Result<Entry> {
    let rates = [later(stiff, false)?, later(soft, false)?];
    let slow = rates.map(|[v1, v2]| v1.min(v2));
    // Of two interfaces that began at V*/2 each.
    let orders = slow.map(|v| (0.5 / v).log10());
    let localised = orders.iter().all(|&orders| orders > 3.0);
    Ok(Entry::claim(
        ("localisation", "section 3.3; Fig. 3"),
        "the slip of two interfaces near the symmetric state, above and below K_c",
        "localises",
        whether(localised, "localises", "is shared"),
    )
    .noted(format!(
        "at t = {LONG} the slower interface has lost {:.1} and {:.1} orders of magnitude, at \
         K = 0.45 and 0.395",
        orders[0], orders[1]
    )))
}

fn the_weaker_one(stiff: &Run, soft: &Run) -> Result<Entry> {
    let (mut weaker, mut exchanged) = (true, true);
    for run in [stiff, soft] {
        let (first, second) = (run.plan.start[1], run.plan.start[2]);
        let [v1, v2] = later(run, false)?;
        weaker &= (first < second) == (v1 > v2);
        let [v1, v2] = later(run, true)?;
        exchanged &= (second < first) == (v1 > v2);
    }
    let word = |weaker| whether(weaker, "the weaker", "the stronger");
    Ok(Entry::claim(
        ("the-weaker-is-selected", "section 3.3; Fig. 3, caption"),
        "the interface that goes on slipping, of the one with the smaller initial state and \
         the other",
        "the weaker",
        word(weaker),
    )
    .beside(
        "the same runs with the interfaces exchanged",
        Answer::Word(word(exchanged)),
    ))
}

/// Whether the faster interface departs from V_H more and more, in thirds of the run after the first.
fn grows(run: &Run) -> Result<bool> {
    let column = |name| {
        run.rows
            .column(name)
            .ok_or_else(|| missing("a run without slip rates"))
    };
    let (time, first, second) = (
        column("time")?,
        column("slip_rate_1")?,
        column("slip_rate_2")?,
    );
    let driving = run.loading().driving;
    let third = run.plan.until / 3.0;
    let mut largest = [0.0_f64; 3];
    for ((t, v1), v2) in time.iter().zip(&first).zip(&second) {
        let part = ((t / third) as usize).min(2);
        largest[part] = largest[part].max((v1.max(*v2) - driving).abs());
    }
    Ok(largest[2] > largest[1])
}
