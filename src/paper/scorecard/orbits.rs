//! Periodic orbits: Figs 6, 7, 9 and 10, and what section 4.2 says of them.

use super::{Answer, Entry, missing, second_method, slab, whether};
use crate::bifurcation::{
    BranchRequest, BranchRow, Criticality, Event, Label, LocusKind, LocusRequest, Parameter,
    Special, orbits,
};
use crate::equilibrium::{Symmetry, Verdict};
use crate::error::Result;
use crate::integrate::Choice;
use crate::number::Uncertain;
use crate::orbit::{Accuracy, Begin, Orbit, Query, find};
use crate::paper::Pieces;
use std::ops::ControlFlow;

/// The words of a second computation of the largest K of a curve.
pub(super) const AT_THE_TOP: &str = "where |mu| = 1 at that V_H, by a second integrator";

/// The orbit of a symmetry at V_H and K that runs lead to, by a method; with the uncertainties of two solutions, or without.
pub(super) fn orbit_at(
    pieces: &Pieces<'_>,
    (driving, stiffness): (f64, f64),
    symmetry: Symmetry,
    begin: Begin,
    method: Choice,
) -> Result<Orbit> {
    let query = Query { symmetry, begin };
    let found = find(
        &slab(pieces, driving, stiffness)?,
        &query,
        &Accuracy::of(method),
    )?;
    Ok(found.orbit)
}

fn is_symmetric(row: &BranchRow) -> bool {
    row.state[0] == row.state[1]
}

fn word(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Stable => "stable",
        Verdict::Unstable => "unstable",
        Verdict::Undecided => "undecided",
    }
}

/// K = 0.14, Fig. 7.
pub fn at_moderate_stiffness(pieces: &Pieces<'_>) -> Result<Vec<Entry>> {
    let branches = pieces.branches("fig07")?;
    let of = |symmetric: bool| -> Vec<&BranchRow> {
        let rows = branches.rows.iter();
        rows.filter(|row| is_symmetric(row) == symmetric).collect()
    };
    let (symmetric, asymmetric) = (of(true), of(false));
    let all = |verdict| symmetric.iter().all(|row| row.verdict == verdict);
    let transverse = if all(Verdict::Unstable) {
        "unstable"
    } else if all(Verdict::Stable) {
        "stable"
    } else {
        "not always the same"
    };
    let within = symmetric
        .iter()
        .all(|row| row.ln_abs_multiplier[1].is_some_and(|x| x < 0.0));
    let at = (1.0, 0.14);
    let again = orbit_at(
        pieces,
        at,
        Symmetry::Symmetric,
        Begin::Anywhere,
        second_method()?,
    )?;
    let second: Vec<Uncertain> = again.floquet.multipliers.iter().map(|m| m.ln_abs).collect();
    let place = "section 4.2; Fig. 7";
    let mut entries = vec![
        Entry::claim(
            ("symmetric-orbits-across", place),
            "the symmetric orbits at K = 0.14 against asymmetric perturbations",
            "unstable",
            transverse,
        )
        .beside("multipliers at V_H = 1 by a second integrator", Answer::Word(word(again.verdict())))
        .noted(format!(
            "ln |mu| = {:.6} and {:.6} there; within the subspace psi_1 = psi_2 they are {}, as the \
                text says",
            second[0].value,
            second[1].value,
            whether(within, "all stable", "not all stable")
        )),
    ];
    entries.extend(likeness(&symmetric, &asymmetric)?);
    Ok(entries)
}

/// A quantity of the symmetric orbits at this V_H, between its neighbours on the branch.
fn between(rows: &[&BranchRow], driving: f64, of: impl Fn(&BranchRow) -> f64) -> Option<f64> {
    let pair = rows.windows(2).find(|pair| {
        let (a, b) = (pair[0].driving, pair[1].driving);
        pair[0].branch == pair[1].branch && a <= driving && driving < b
    })?;
    let part = (driving / pair[0].driving).ln() / (pair[1].driving / pair[0].driving).ln();
    Some(of(pair[0]) * (1.0 - part) + of(pair[1]) * part)
}

/// Amplitudes and periods of both kinds of orbits, away from the Hopf points where the symmetric ones vanish.
fn likeness(symmetric: &[&BranchRow], asymmetric: &[&BranchRow]) -> Result<[Entry; 2]> {
    /// V_H of the comparison.
    const COMPARED: (f64, f64) = (0.2, 100.0);
    /// Periods are very similar if Fig. 7(b), with its logarithmic axis, has them within this part of its height.
    const SIMILAR: f64 = 0.05;
    let amplitude = |row: &BranchRow| row.stress_range.1 - row.stress_range.0;
    let period = |row: &BranchRow| row.period.unwrap_or(f64::NAN);
    let (mut amplitudes, mut periods) = (Vec::new(), Vec::new());
    for row in asymmetric {
        let v = row.driving;
        if !(COMPARED.0..=COMPARED.1).contains(&v) {
            continue;
        }
        amplitudes.extend(between(symmetric, v, amplitude).map(|a| amplitude(row) / a));
        periods.extend(between(symmetric, v, period).map(|t| [t, period(row)]));
    }
    let range = |all: &[f64]| {
        let ends = (f64::INFINITY, f64::NEG_INFINITY);
        all.iter().fold(ends, |(a, b), &x| (a.min(x), b.max(x)))
    };
    if amplitudes.is_empty() {
        return Err(missing("fig07 has no orbits of both kinds"));
    }
    let (a, b) = range(&amplitudes);
    let ratios: Vec<f64> = periods.iter().map(|[t, other]| other / t).collect();
    let (s, t) = range(&ratios);
    let (shortest, longest) = range(&periods.concat());
    let part = s.ln().abs().max(t.ln().abs()) / (longest / shortest).ln();
    let place = "section 4.2; Fig. 7";
    Ok([
        Entry::claim(
            ("amplitudes-at-0.14", place),
            "the amplitudes of stress of the asymmetric orbits beside those of the symmetric ones, K = 0.14",
            "smaller",
            whether(b < 1.0, "smaller", "not always smaller"),
        )
        .noted(format!("their ratio is {a:.3} to {b:.3} from V_H = 0.2 to 100; nearer to the Hopf \
            points where they vanish the symmetric orbits are the smaller ones")),
        Entry::claim(
            ("periods-at-0.14", "section 4.2; Fig. 7(b)"),
            "the periods of symmetric and asymmetric orbits, K = 0.14",
            "very similar",
            whether(part < SIMILAR, "very similar", "unlike"),
        )
        .noted(format!("the ratio of the asymmetric to the symmetric one is {s:.3} to {t:.3} from V_H = \
            0.2 to 100, where they fall from {longest:.0} to {shortest:.2}: on the logarithmic axis of \
            the figure they are within the part {part:.3} of that")),
    ])
}

/// Small stiffness, Figs 9 and 10.
pub fn at_small_stiffness(pieces: &Pieces<'_>) -> Result<Vec<Entry>> {
    let mut all = vec![largest_of_pitchforks(pieces)?, coexistence(pieces)?];
    all.extend(from_the_second_hopf_point(pieces)?);
    all.push(doublings_at_pitchforks(pieces)?);
    Ok(all)
}

fn largest_of_pitchforks(pieces: &Pieces<'_>) -> Result<Entry> {
    let curves = pieces.curves("fig06-orbit-pitchforks")?;
    let top = curves.special.iter().find(|s| s.label == Label::Top);
    let top = top.ok_or_else(|| missing("the pitchforks of orbits have no top"))?;
    let driving = top.driving.value;
    let again = at_top(
        pieces,
        driving,
        top.stiffness.value,
        Symmetry::Symmetric,
        Begin::Anywhere,
    )?;
    Ok(Entry::number(
        (
            "largest-K-of-orbit-pitchforks",
            "section 4.2, before Fig. 8",
        ),
        "the largest K at which symmetric orbits are stable somewhere, that of PF",
        "a sigma/L",
        "< 0.135",
        top.stiffness,
    )
    .beside(AT_THE_TOP, Answer::Number(again))
    .noted(format!("at V_H = {driving:.6}; the bound is rounded up")))
}

/// K near a top where the larger multiplier is of modulus 1 at the top's V_H: there the multiplier does not depend on V_H, so
/// that the K found is that of the top, to second order.
pub(super) fn at_top(
    pieces: &Pieces<'_>,
    driving: f64,
    near: f64,
    symmetry: Symmetry,
    begin: Begin,
) -> Result<Uncertain> {
    /// How far off the search begins, relative, and its steps.
    const OFF: f64 = 1e-4;
    const STEPS: usize = 3;
    let method = second_method()?;
    let logarithm = |stiffness: f64| -> Result<Uncertain> {
        let orbit = orbit_at(pieces, (driving, stiffness), symmetry, begin, method)?;
        let first = orbit.floquet.multipliers.first();
        Ok(first
            .ok_or_else(|| missing("an orbit without multipliers"))?
            .ln_abs)
    };
    let (mut k, mut next) = (near * (1.0 + 2.0 * OFF), near * (1.0 + OFF));
    let mut at = logarithm(k)?;
    let mut slope = f64::NAN;
    for _ in 0..STEPS {
        let there = logarithm(next)?;
        slope = (there.value - at.value) / (next - k);
        (k, at) = (next, there);
        next = k - at.value / slope;
    }
    Ok(Uncertain::new(
        next,
        (at.uncertainty / slope).abs() + (next - k).abs(),
    ))
}

fn coexistence(pieces: &Pieces<'_>) -> Result<Entry> {
    let both = |method: Choice| -> Result<[Orbit; 2]> {
        let at = |symmetry| orbit_at(pieces, (0.2, 0.05), symmetry, Begin::Anywhere, method);
        Ok([at(Symmetry::Symmetric)?, at(Symmetry::Asymmetric)?])
    };
    let word = |orbits: &[Orbit; 2]| {
        let stable = orbits
            .iter()
            .all(|orbit| orbit.verdict() == Verdict::Stable);
        whether(stable, "both stable", "not both stable")
    };
    let first = both(Choice::Taylor)?;
    let second = both(second_method()?)?;
    let logarithms = first
        .each_ref()
        .map(|orbit| orbit.floquet.multipliers[0].ln_abs.value);
    let periods = first.each_ref().map(|orbit| orbit.period.value);
    Ok(Entry::claim(
        ("coexistence", "section 4.2, K < 0.135; Fig. 10"),
        "symmetric and asymmetric orbits at K = 0.05, V_H = 0.2",
        "both stable",
        word(&first),
    )
    .beside("a second integrator", Answer::Word(word(&second)))
    .noted(format!(
        "the larger multipliers have ln |mu| = {:.3} and {:.4}, the periods are {:.3} and {:.3}",
        logarithms[0], logarithms[1], periods[0], periods[1]
    )))
}

/// The branch of asymmetric orbits from the Hopf point at the larger V_H, K = 0.05.
fn from_the_second_hopf_point(pieces: &Pieces<'_>) -> Result<[Entry; 2]> {
    let (mut rows, mut special) = (Vec::new(), Vec::new());
    let request = BranchRequest {
        symmetry: Some(Symmetry::Asymmetric),
        ..BranchRequest::new(slab(pieces, 1.0, 0.05)?, Parameter::Driving, (0.15, 400.0))
    };
    orbits::branch(&request, &mut |event| {
        match event {
            Event::Branch(row) => rows.push(row),
            Event::Special(point) => special.push(point),
            Event::Locus(_) => {}
        }
        ControlFlow::Continue(())
    })?;
    let labels: Vec<Label> = special.iter().map(|s: &Special| s.label).collect();
    let fold = rows
        .iter()
        .position(|row: &BranchRow| row.label == Some(Label::Sn));
    let (before, after) = rows.split_at(fold.unwrap_or(rows.len()));
    let all = |rows: &[BranchRow], verdict| {
        let mut plain = rows.iter().filter(|row| row.label.is_none());
        plain.all(|row| row.verdict == verdict)
    };
    let as_told = labels == [Label::Hb, Label::Sn, Label::Pf]
        && all(before, Verdict::Stable)
        && all(after, Verdict::Unstable);
    let pitchfork = special.iter().find(|s| s.label == Label::Pf);
    let pitchfork = pitchfork.ok_or_else(|| missing("no pitchfork of orbits at K = 0.05"))?;
    let way = match pitchfork.criticality {
        Some(Criticality::Supercritical) => "supercritical",
        Some(Criticality::Subcritical) => "subcritical",
        _ => "undecided",
    };
    let place = "section 4.2; Fig. 9";
    let beside = whether(
        all(after, Verdict::Unstable),
        "subcritical",
        "supercritical",
    );
    let at: Vec<String> = special
        .iter()
        .map(|s| format!("{:.6}", s.driving.value))
        .collect();
    Ok([
        Entry::claim(
            ("branch-from-H_a^2", place),
            "the asymmetric orbits from H_a^2: stable, unstable after a fold SN, ending on the \
                symmetric ones at PF^2",
            "holds",
            super::holds(as_told),
        )
        .noted(format!("at K = 0.05, V_H = {}", at.join(", "))),
        Entry::claim(
            ("pitchfork-PF^2", place),
            "the pitchfork of orbits PF^2 in which they end",
            "subcritical",
            way,
        )
        .beside(
            "multipliers of the asymmetric orbits that end there",
            Answer::Word(beside),
        )
        .noted("by the cubic coefficient, K = 0.05"),
    ])
}

/// How far the period doublings are from the pitchforks of orbits, at two small K.
fn doublings_at_pitchforks(pieces: &Pieces<'_>) -> Result<Entry> {
    let branches = pieces.branches("fig09")?;
    let last = |label: Label, all: &[Special]| {
        let these = all
            .iter()
            .filter(|s| s.label == label)
            .map(|s| s.driving.value);
        these.fold(0.0, f64::max)
    };
    let (double, fork) = (
        last(Label::Pd, &branches.special),
        last(Label::Pf, &branches.special),
    );
    let curves = pieces.curves("fig12-period-doubling")?;
    let ends = curves.special.iter().filter(|s| s.label == Label::Ep);
    let softest = ends.max_by(|a, b| a.driving.value.total_cmp(&b.driving.value));
    let softest = softest.ok_or_else(|| missing("the period doublings have no end"))?;
    let k = softest.stiffness.value;
    let mut forks = Vec::new();
    let request = LocusRequest {
        at_stiffness: vec![k],
        ..LocusRequest::new(
            slab(pieces, 1.0, k)?,
            LocusKind::OrbitPitchfork,
            (1e-3, 1.0),
            (0.999 * k, 1.001 * k),
        )
    };
    orbits::locus(&request, &mut |event| {
        if let Event::Special(point) = event {
            forks.push(point);
        }
        ControlFlow::Continue(())
    })?;
    let distances = [
        fork / double - 1.0,
        last(Label::Uz, &forks) / softest.driving.value - 1.0,
    ];
    let aligned = distances[0] < 1e-2 && distances[1] < 0.2 * distances[0];
    Ok(Entry::claim(
        ("doublings-at-pitchforks", "section 4.2; Figs 6, 9"),
        "the curve PD at the larger V_H beside PF as K -> 0",
        "aligned",
        whether(aligned && distances[1] > 0.0, "aligned", "apart"),
    )
    .noted(format!(
        "PF is at larger V_H by the part {:.1e} at K = 0.05 and {:.1e} at K = {k}",
        distances[0], distances[1]
    )))
}
