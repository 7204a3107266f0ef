//! The curve of torus bifurcations: sections 4.2 and 4.3, Figs 12 and 14.

use super::second::{AT_THE_TOP, BY_SECOND, again, at_top, orbit_at};
use super::table1::resonances;
use super::{Answer, Entry, missing, whether};
use crate::Pieces;
use twinslip::bifurcation::{Label, LocusRow, Special};
use twinslip::equilibrium::{Symmetry, Verdict};
use twinslip::error::Result;
use twinslip::integrate::Choice;
use twinslip::orbit::InitialGuess;

/// Where asymmetric orbits lose their stability, and how they have it again: the end of section 4.2.
pub fn of_section_4_2(pieces: &Pieces<'_>) -> Result<Vec<Entry>> {
    let curves = pieces.curves("fig12")?;
    let top = curves.special.iter().find(|s| s.label == Label::Top);
    let top = top.ok_or_else(|| missing("the torus bifurcations have no top"))?;
    let (driving, stiffness) = (top.driving.value, top.stiffness.value);
    // A little above it the orbit is stable, and runs find it.
    let above = (driving, 1.02 * stiffness);
    let settled = orbit_at(
        pieces,
        above,
        Symmetry::Asymmetric,
        InitialGuess::Anywhere,
        Choice::Taylor,
    )?;
    let begin = InitialGuess::At {
        start: (settled.point[0], [settled.point[1], settled.point[2]]),
        period: Some(settled.period.value),
    };
    let second = at_top(pieces, driving, stiffness, Symmetry::Asymmetric, begin)?;
    Ok(vec![
        Entry::number(
            ("largest-K-of-torus", "sections 4.2 and 4.3.1"),
            "the largest K with a torus bifurcation of the asymmetric orbits",
            "a sigma/L",
            "< 0.216",
            top.stiffness,
        )
        .beside(AT_THE_TOP, Answer::Number(second))
        .noted(format!(
            "at V_H = {driving:.6}; the orbits become stable again in a {} at K = 0.14 and a \
             {} at K = 0.05, as the text says",
            stable_again(pieces, "fig07")?,
            stable_again(pieces, "fig09")?,
        )),
    ])
}

/// In what the asymmetric orbits of a scene become stable again, as V_H grows.
fn stable_again(pieces: &Pieces<'_>, scene: &str) -> Result<&'static str> {
    let branches = pieces.branches(scene)?;
    let rows = branches
        .rows
        .iter()
        .filter(|row| row.state[0] != row.state[1]);
    let rows: Vec<_> = rows.collect();
    let mut windows = rows.windows(3).filter(|three| {
        let one = three.iter().all(|row| row.branch == three[0].branch);
        let verdicts = [three[0].verdict, three[2].verdict];
        let grows = three[0].driving < three[1].driving;
        one && grows && verdicts == [Verdict::Unstable, Verdict::Stable]
    });
    let label = windows.find_map(|three| three[1].label);
    let label = label.ok_or_else(|| missing("no orbits that become stable again"))?;
    Ok(label.meaning())
}

/// Section 4.3.
pub fn of_section_4_3(pieces: &Pieces<'_>) -> Result<Vec<Entry>> {
    let curves = pieces.curves("fig12")?;
    let double = resonances(pieces)?
        .into_iter()
        .find(|s| s.label == Label::R2);
    let double = double.ok_or_else(|| missing("the torus bifurcations have no resonance 1:2"))?;
    let [_, stiffness] = again(pieces, &double)?;
    let angles = curves.rows.iter().filter_map(|row| row.angle_over_pi);
    let last = angles.fold(0.0, f64::max);
    Ok(vec![
        finite_gradients(&curves.rows),
        Entry::number(
            ("K-of-1:2-in-the-text", "section 4.3.2"),
            "K of the resonance 1:2",
            "a sigma/L",
            "0.138",
            double.stiffness,
        )
        .beside(BY_SECOND, Answer::Number(stiffness))
        .noted(meeting(pieces, &double)?),
        Entry::claim(
            ("angle-at-1:2", "section 4.3.2; Fig. 14"),
            "theta/pi of the multipliers as the curve comes to the resonance 1:2",
            "-> 1",
            whether(last > 0.999 && last <= 1.0, "-> 1", "otherwise"),
        )
        .noted(format!(
            "the largest on the points of the curve is {last:.6}; there the curve ends"
        )),
    ])
}

/// Whether the curve goes on smoothly through the resonances 1:3 and 1:4.
fn finite_gradients(rows: &[LocusRow]) -> Entry {
    /// Of dK/dV_H in a sigma/L over V*.
    const STEEPEST: f64 = 1e3;
    let mut slopes = Vec::new();
    let mut alike = true;
    for three in rows.windows(3) {
        if !matches!(three[1].label, Some(Label::R3 | Label::R4)) {
            continue;
        }
        let slope = |a: &LocusRow, b: &LocusRow| {
            (b.stiffness.value - a.stiffness.value) / (b.driving.value - a.driving.value)
        };
        let sides = [slope(&three[0], &three[1]), slope(&three[1], &three[2])];
        // Through a point of finite gradient both sides lie in one direction.
        alike &= sides[0] * sides[1] > 0.0 && sides.iter().all(|s| s.abs() < STEEPEST);
        slopes.push(0.5 * (sides[0] + sides[1]));
    }
    let listed: Vec<String> = slopes.iter().map(|s| format!("{s:.3}")).collect();
    Entry::claim(
        ("gradient-at-1:3-and-1:4", "section 4.3.2"),
        "the gradient of the torus curve at the resonances 1:3 and 1:4, and the curve on both \
         sides",
        "finite",
        whether(alike && slopes.len() == 4, "finite", "not finite"),
    )
    .noted(format!(
        "dK/dV_H is about {} there, in order along the curve",
        listed.join(", ")
    ))
}

/// How far the resonance 1:2 is from that on the curve of period doublings.
fn meeting(pieces: &Pieces<'_>, double: &Special) -> Result<String> {
    let doublings = pieces.curves("fig12-period-doubling")?;
    let there = doublings.special.iter().find(|s| s.label == Label::R2);
    let there = there.ok_or_else(|| missing("the period doublings have no resonance 1:2"))?;
    let apart = (there.stiffness.value / double.stiffness.value - 1.0).abs();
    Ok(format!(
        "the same point ends the curve of period doublings, found by itself, to the part \
         {apart:.0e}"
    ))
}
