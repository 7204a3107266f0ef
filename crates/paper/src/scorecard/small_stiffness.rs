//! Orbits at small stiffness: where symmetric ones are stable, the sketch of Fig. 9, and both kinds side by side, Fig. 10.

use super::second::{AT_THE_TOP, MULTIPLIERS, at_top, orbit_at, second_method};
use super::{Answer, Entry, criticality_word, holds, missing, whether};
use crate::{Branches, Pieces};
use twinslip::bifurcation::{BranchRow, Label, Special};
use twinslip::equilibrium::{Symmetry, Verdict};
use twinslip::error::Result;
use twinslip::integrate::Choice;
use twinslip::orbit::{InitialGuess, Orbit};

/// K of Figs 9 and 10.
const STIFFNESS: f64 = 0.05;

/// All of it.
pub fn entries(pieces: &Pieces<'_>) -> Result<Vec<Entry>> {
    let branches = pieces.branches("fig09")?;
    let (rows, special) = from_the_second_hopf_point(&branches);
    Ok(vec![
        largest_of_pitchforks(pieces)?,
        coexistence(pieces)?,
        as_sketched(rows, special),
        pitchfork(rows, special)?,
        doublings_at_pitchforks(pieces)?,
    ])
}

fn largest_of_pitchforks(pieces: &Pieces<'_>) -> Result<Entry> {
    let curves = pieces.curves("fig06-orbit-pitchforks")?;
    let top = curves.special.iter().find(|s| s.label == Label::Top);
    let top = top.ok_or_else(|| missing("the pitchforks of orbits have no top"))?;
    let (driving, near) = (top.driving.value, top.stiffness.value);
    let kind = Symmetry::Symmetric;
    let again = at_top(pieces, driving, near, kind, InitialGuess::Anywhere)?;
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

fn coexistence(pieces: &Pieces<'_>) -> Result<Entry> {
    let both = |method: Choice| -> Result<[Orbit; 2]> {
        let at = |kind| {
            orbit_at(
                pieces,
                (0.2, STIFFNESS),
                kind,
                InitialGuess::Anywhere,
                method,
            )
        };
        Ok([at(Symmetry::Symmetric)?, at(Symmetry::Asymmetric)?])
    };
    let word = |orbits: &[Orbit; 2]| {
        let stable = orbits.iter().all(|o| o.verdict() == Verdict::Stable);
        whether(stable, "both stable", "not both stable")
    };
    let (first, second) = (both(Choice::Taylor)?, both(second_method()?)?);
    let periods = first.each_ref().map(|orbit| orbit.period.value);
    Ok(Entry::claim(
        ("coexistence", "section 4.2, K < 0.135; Fig. 10"),
        "symmetric and asymmetric orbits at K = 0.05, V_H = 0.2",
        "both stable",
        word(&first),
    )
    .beside(MULTIPLIERS, Answer::Word(word(&second)))
    .noted(format!(
        "the periods are {:.3} and {:.3}",
        periods[0], periods[1]
    )))
}

/// The branch of asymmetric orbits from H_a^2, the Hopf point at the larger V_H: the last one, with the special points that it
/// was told with.
fn from_the_second_hopf_point(branches: &Branches) -> (&[BranchRow], &[Special]) {
    let mut all = branches.rows.chunk_by(|a, b| a.branch == b.branch);
    let points = &branches.special;
    let begin = points.iter().rposition(|point| point.label == Label::Hb);
    let special = &points[begin.unwrap_or(0)..];
    (all.next_back().unwrap_or_default(), special)
}

/// Whether all orbits of a part of a branch have the verdict; those with a label may be too close to call.
fn all(rows: &[BranchRow], verdict: Verdict) -> bool {
    let mut plain = rows.iter().filter(|row| row.label.is_none());
    plain.all(|row| row.verdict == verdict)
}

/// The branch before its fold and after it.
fn at_the_fold(rows: &[BranchRow]) -> (&[BranchRow], &[BranchRow]) {
    let fold = rows.iter().position(|row| row.label == Some(Label::Sn));
    rows.split_at(fold.unwrap_or(rows.len()))
}

fn as_sketched(rows: &[BranchRow], special: &[Special]) -> Entry {
    let labels: Vec<Label> = special.iter().map(|s| s.label).collect();
    let (before, after) = at_the_fold(rows);
    let as_told = labels == [Label::Hb, Label::Sn, Label::Pf]
        && all(before, Verdict::Stable)
        && all(after, Verdict::Unstable);
    let places = special.iter().map(|s| {
        let name = s.label.name();
        format!("{name} {:.6}", s.driving.value)
    });
    let places: Vec<String> = places.collect();
    Entry::claim(
        ("branch-from-H_a^2", "section 4.2; Fig. 9"),
        "the asymmetric orbits from H_a^2: stable, after a fold SN unstable, ending at PF^2",
        "holds",
        holds(as_told),
    )
    .noted(format!("at K = 0.05, V_H of {}", places.join(", ")))
}

fn pitchfork(rows: &[BranchRow], special: &[Special]) -> Result<Entry> {
    let found = special.iter().find(|s| s.label == Label::Pf);
    let found = found.ok_or_else(|| missing("no pitchfork of orbits at K = 0.05"))?;
    let (_, after) = at_the_fold(rows);
    let unstable = !after.is_empty() && all(after, Verdict::Unstable);
    Ok(Entry::claim(
        ("pitchfork-PF^2", "section 4.2; Fig. 9"),
        "the pitchfork of orbits PF^2 in which they end",
        "subcritical",
        criticality_word(found.criticality),
    )
    .beside(
        "multipliers of the asymmetric orbits that end there",
        Answer::Word(whether(unstable, "subcritical", "supercritical")),
    )
    .noted("by the cubic coefficient, K = 0.05"))
}

/// The largest V_H with a label at slow driving, where the Hopf points crowd.
fn last(label: Label, special: &[Special]) -> f64 {
    const SLOW: f64 = 0.1;
    let these = special.iter().filter(|s| s.label == label);
    let driving = these.map(|s| s.driving.value).filter(|&v| v < SLOW);
    driving.fold(0.0, f64::max)
}

/// How far the period doublings are from the pitchforks of orbits, at two small K.
fn doublings_at_pitchforks(pieces: &Pieces<'_>) -> Result<Entry> {
    let at_005 = pieces.branches("fig09")?;
    let curves = pieces.curves("fig12-period-doubling")?;
    let forks = pieces.curves("fig06-orbit-pitchforks")?;
    let mut landed = forks.special.iter();
    let fork = landed.find(|s| s.label == Label::Uz && s.driving.value < 1.0);
    let fork = fork.ok_or_else(|| missing("the pitchforks of orbits have no landing"))?;
    let k = fork.stiffness.value;
    // Of the two there, the one beside the pitchforks.
    let landed = curves.special.iter();
    let landed = landed.filter(|s| s.label == Label::Uz && s.stiffness.value == k);
    let doubling = landed.max_by(|a, b| a.driving.value.total_cmp(&b.driving.value));
    let doubling =
        doubling.ok_or_else(|| missing("the period doublings have no landing at the same K"))?;
    let distances = [
        last(Label::Pf, &at_005.special) / last(Label::Pd, &at_005.special) - 1.0,
        fork.driving.value / doubling.driving.value - 1.0,
    ];
    // The distance falls much faster than K.
    let falls = distances[1] > 0.0 && distances[1] < 0.1 * distances[0];
    Ok(Entry::claim(
        ("doublings-at-pitchforks", "section 4.2; Figs 6, 9"),
        "the curve PD at the larger V_H beside PF as K -> 0",
        "aligned",
        whether(distances[0] < 1e-2 && falls, "aligned", "apart"),
    )
    .noted(format!(
        "PF is at larger V_H by the part {:.1e} at K = 0.05 and {:.1e} at K = {k}",
        distances[0], distances[1]
    )))
}
