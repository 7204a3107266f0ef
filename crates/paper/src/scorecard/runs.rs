//! Runs in time and their return maps: Figs 8, 11, 13 and 16.

use super::second::{MULTIPLIERS, orbit_at, second_method};
use super::{Answer, Entry, missing, range, whether};
use crate::{Pieces, Run};
use twinslip::equilibrium::{Symmetry, Verdict};
use twinslip::error::Result;
use twinslip::friction::Parameters;
use twinslip::integrate::Choice;
use twinslip::model::Loading;
use twinslip::orbit::InitialGuess;
use twinslip::section::Regime;

/// The part of a run that is looked at, its end.
const LATE: f64 = 0.5;

/// A column of the later part of a run.
fn late(run: &Run, name: &str) -> Result<Vec<f64>> {
    let column = |name| {
        run.rows
            .column(name)
            .ok_or_else(|| missing("a run without its columns"))
    };
    let (time, values) = (column("time")?, column(name)?);
    let begin = LATE * run.plan.until;
    let both = time.iter().zip(values);
    Ok(both.filter(|(t, _)| **t >= begin).map(|(_, x)| x).collect())
}

/// Stick-slip at larger V_H, Fig. 8(b).
pub fn of_fig_8(pieces: &Pieces<'_>) -> Result<Vec<Entry>> {
    let run = pieces.run("fig08b")?;
    let [first, second] = [late(&run, "state_1")?, late(&run, "state_2")?];
    let states = [range(first.into_iter()), range(second.into_iter())];
    // The faster interface is the one whose state falls farther.
    let fast = usize::from(states[1].0 < states[0].0);
    Ok(vec![
        fast_interface(pieces, &run, states[fast].0)?,
        slow_interface(states[1 - fast]),
    ])
}

fn fast_interface(pieces: &Pieces<'_>, run: &Run, least: f64) -> Result<Entry> {
    let c = Parameters::heslot_1994().residual_strength;
    let Loading { driving, stiffness } = run.loading();
    let (at, kind) = ((driving, stiffness), Symmetry::Asymmetric);
    let orbit = orbit_at(pieces, at, kind, InitialGuess::Anywhere, Choice::Taylor)?;
    let word = |least: f64| whether(least < 0.1 * c, "much less than c", "not much less than c");
    Ok(Entry::claim(
        ("state-of-the-fast-interface", "section 4.2; Fig. 8(b)"),
        "the state of the fast interface in a stick-slip event",
        "much less than c",
        word(least),
    )
    .beside(
        "the periodic orbit, by multiple shooting",
        Answer::Word(word(orbit.state_min)),
    )
    .noted(format!(
        "it falls to {least:.3e}, c = {c}; K = {stiffness}, V_H = {driving}, chosen by the scene"
    )))
}

fn slow_interface((least, most): (f64, f64)) -> Entry {
    // "Of order 0.1" is between the geometric means with 0.01 and with 1.
    let tenth = |x: f64| (0.1 / 10_f64.sqrt()..0.1 * 10_f64.sqrt()).contains(&x);
    Entry::claim(
        ("state-of-the-slow-interface", "section 4.2; Fig. 8(b)"),
        "the state of the slow interface meanwhile",
        "of order 0.1",
        whether(tenth(least) && tenth(most), "of order 0.1", "otherwise"),
    )
    .noted(format!("it stays between {least:.3} and {most:.3}"))
}

/// Fig. 11: from an asymmetric start to the symmetric orbit.
pub fn of_fig_11(pieces: &Pieces<'_>) -> Result<Vec<Entry>> {
    let run = pieces.run("fig11")?;
    let (first, second) = (late(&run, "state_1")?, late(&run, "state_2")?);
    let apart = |i: usize| (first[i] / second[i]).ln().abs();
    let last = first
        .len()
        .checked_sub(1)
        .ok_or_else(|| missing("fig11 has no rows"))?;
    let (start, end) = (&run.plan.start, apart(last));
    let at = (run.loading().driving, run.loading().stiffness);
    let method = second_method()?;
    let orbit = orbit_at(
        pieces,
        at,
        Symmetry::Symmetric,
        InitialGuess::Anywhere,
        method,
    )?;
    let stable = orbit.verdict() == Verdict::Stable;
    let word = |it_is| whether(it_is, "the symmetric orbit", "elsewhere");
    Ok(vec![
        Entry::claim(
            ("end-of-asymmetric-start", "section 4.2; Fig. 11"),
            "where an asymmetric start leads at K = 0.01, V_H = 0.2",
            "the symmetric orbit",
            word(end < 1e-9),
        )
        .beside(MULTIPLIERS, Answer::Word(word(stable)))
        .noted(match (start[1] - start[2]).abs() {
            begin if end == 0.0 => format!(
                "|ln psi_1 - ln psi_2| is {begin:.3} at the start; at the end both states are the same double"
            ),
            begin => format!("|ln psi_1 - ln psi_2| falls from {begin:.3} to {end:.0e}"),
        }),
    ])
}

/// Fig. 13.
pub fn of_fig_13(pieces: &Pieces<'_>) -> Result<Vec<Entry>> {
    let map = pieces.map("fig13-map")?;
    let rotation = map.outcome.rotation_number.map_or(f64::NAN, |r| r.value);
    let exponents = map.outcome.lyapunov.as_ref();
    let vanish = exponents.is_some_and(|found| {
        let zero = |x: &&twinslip::number::Uncertain| x.value.abs() <= x.uncertainty;
        found.exponents.iter().filter(zero).count() == 2
    });
    Ok(vec![
        Entry::claim(
            ("torus-of-fig-13", "section 4.3.1; Fig. 13"),
            "what the run at K = 0.2, V_H = 0.102 settles on",
            "torus",
            map.outcome.regime.name(),
        )
        .beside(
            "two Lyapunov exponents that vanish",
            Answer::Word(whether(vanish, "torus", "no torus")),
        )
        .noted(format!(
            "the returns lie on one closed curve, the rotation number is {rotation:.6}"
        )),
    ])
}

/// Fig. 16(b).
pub fn of_fig_16(pieces: &Pieces<'_>) -> Result<Vec<Entry>> {
    let map = pieces.map("fig16b-map")?;
    let periodic = map.outcome.regime == Regime::Periodic;
    let returns = map.outcome.period_of_orbit.unwrap_or(0);
    let sums = map.rows.column("slip_rate_sum");
    let sums = sums.ok_or_else(|| missing("a map without slip rates"))?;
    let repeat = |q: usize| {
        let pairs = sums.iter().zip(sums.iter().skip(q));
        pairs.map(|(a, b)| (a / b - 1.0).abs()).fold(0.0, f64::max) < 1e-3
    };
    let seen = (1..=8).find(|&q| repeat(q)).unwrap_or(0);
    let word = |q: usize| whether(q == 4, "four-fold", "otherwise");
    let driving = map.loading().driving;
    Ok(vec![
        Entry::claim(
            ("four-fold-structure", "section 4.3.2; Fig. 16(b)"),
            "the structure of the returns near the resonance 1:4 at K = 0.14",
            "four-fold",
            word(if periodic { returns } else { 0 }),
        )
        .beside(
            "after how many returns the slip rates repeat",
            Answer::Word(word(seen)),
        )
        .noted(format!(
            "at V_H = {driving}, which the scene chooses: a stable orbit that returns four times"
        )),
    ])
}
