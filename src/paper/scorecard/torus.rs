//! Torus bifurcations and period doublings: section 4.3, Figs 12 to 14 and 16.

use super::orbits::{AT_THE_TOP, at_top, orbit_at};
use super::table1::{again, resonances};
use super::{Answer, BY_SECOND, Entry, missing, second_method, slab, whether};
use crate::bifurcation::{Criticality, Label, LocusRow, Special};
use crate::equilibrium::{Symmetry, Verdict};
use crate::error::Result;
use crate::field::State;
use crate::integrate::{Choice, Control, MAX_STEPS, Tolerances};
use crate::number::Uncertain;
use crate::number::polynomial::Crossing;
use crate::orbit::Begin;
use crate::paper::Pieces;
use crate::section::{Return, Surface, Watching, record};

/// K of Figs 7 and 16.
const STIFFNESS: f64 = 0.14;

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
        Begin::Anywhere,
        Choice::Taylor,
    )?;
    let begin = Begin::At {
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
            "at V_H = {driving:.6}; the orbits become stable again in a {} at K = 0.14 and a {} at K = \
                0.05, as the text says",
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
        "the gradient of the torus curve at the resonances 1:3 and 1:4, and the curve on both sides",
        "finite",
        whether(alike && slopes.len() == 4, "finite", "not finite"),
    )
    .noted(format!("dK/dV_H is about {} there, in order along the curve", listed.join(", ")))
}

/// How far the resonance 1:2 is from that on the curve of period doublings.
fn meeting(pieces: &Pieces<'_>, double: &Special) -> Result<String> {
    let doublings = pieces.curves("fig12-period-doubling")?;
    let there = doublings.special.iter().find(|s| s.label == Label::R2);
    let there = there.ok_or_else(|| missing("the period doublings have no resonance 1:2"))?;
    let apart = (there.stiffness.value / double.stiffness.value - 1.0).abs();
    Ok(format!(
        "the same point ends the curve of period doublings, found by itself, to the part {apart:.0e}"
    ))
}

/// The caption of Fig. 16, and which way the torus bifurcation goes.
pub fn of_fig_16(pieces: &Pieces<'_>) -> Result<Vec<Entry>> {
    let branches = pieces.branches("fig07")?;
    let of = |label: Label| -> Result<[&Special; 2]> {
        let mut all: Vec<_> = branches
            .special
            .iter()
            .filter(|s| s.label == label)
            .collect();
        all.sort_by(|a, b| a.driving.value.total_cmp(&b.driving.value));
        all.try_into()
            .map_err(|_| missing("fig07 has not two torus bifurcations and two period doublings"))
    };
    let ([first, last], doublings) = (of(Label::Tr)?, of(Label::Pd)?);
    let printed = [
        (
            "TR-first",
            first,
            "V_H of the first torus bifurcation at K = 0.14",
            "0.0767",
        ),
        (
            "PD-first",
            doublings[0],
            "V_H of the first period doubling at K = 0.14",
            "0.0842",
        ),
        (
            "PD-last",
            doublings[1],
            "V_H of the last period doubling at K = 0.14",
            "0.0980",
        ),
        (
            "TR-last",
            last,
            "V_H of the last torus bifurcation at K = 0.14",
            "0.1000",
        ),
    ];
    let mut all = vec![way(pieces, first)?];
    for (id, special, quantity, printed) in printed {
        let [driving, _] = again(pieces, special)?;
        all.push(
            Entry::number(
                (id, "Fig. 16, caption"),
                quantity,
                "V*",
                printed,
                special.driving,
            )
            .beside(BY_SECOND, Answer::Number(driving))
            .misprinted(
                "two methods agree on the computed value to nine digits, and the torus \
                    bifurcations of the same caption are right",
            ),
        );
    }
    Ok(all)
}

/// Which way the first torus bifurcation goes: by its cubic coefficient; by returns above it, which come from both sides to a
/// torus; and how returns below it that begin far off look as if it went the other way.
fn way(pieces: &Pieces<'_>, torus: &Special) -> Result<Entry> {
    /// V_H above and below.
    const ABOVE: f64 = 0.0767405;
    const BELOW: f64 = 0.0767;
    let word = match torus.criticality {
        Some(Criticality::Supercritical) => "supercritical",
        Some(Criticality::Subcritical) => "subcritical",
        _ => "undecided",
    };
    let inside = distances(pieces, torus, ABOVE, 0.01)?;
    let outside = distances(pieces, torus, ABOVE, 0.05)?;
    let far = distances(pieces, torus, BELOW, 0.3)?;
    let between = inside[0] < inside[1] && inside[1] < outside[1] && outside[1] < outside[0];
    let coefficient = torus.coefficient.unwrap_or(f64::NAN);
    Ok(Entry::claim(
        ("torus-at-0.14", "section 4.3.2; Fig. 16(a)"),
        "the torus bifurcation at K = 0.14, V_H = 0.0767",
        "subcritical",
        word,
    )
    .beside(
        "returns above the bifurcation, from inside and outside of a torus",
        Answer::Word(whether(between, "supercritical", "no torus found")),
    )
    .noted(format!(
        "by a hair: the cubic coefficient is {coefficient:.5}; at V_H = {ABOVE} the distance of returns \
            from the orbit grows from {:.4} to {:.4} and falls from {:.4} to {:.4}, to a torus between; \
            at {BELOW}, where the orbit is stable, returns that begin 0.3 away stay {:.2} away, so that \
            simulations look subcritical",
        inside[0], inside[1], outside[0], outside[1], far[1]
    )))
}

/// The largest distance from the orbit's own return among early and among late returns, of a run that begins beside it.
fn distances(pieces: &Pieces<'_>, torus: &Special, driving: f64, beside: f64) -> Result<[f64; 2]> {
    /// Returns, and how many of them are looked at in either part.
    const RETURNS: usize = 3000;
    const WINDOW: usize = 500;
    const TOLERANCE: f64 = 1e-15;
    let orbit = torus.orbit.as_ref();
    let node = &orbit
        .ok_or_else(|| missing("a torus bifurcation without its orbit"))?
        .nodes()
        .0[0];
    let begin = Begin::At {
        start: (node[0], [node[1], node[2]]),
        period: torus.period.map(|period| period.value),
    };
    let at = (driving, STIFFNESS);
    let orbit = orbit_at(pieces, at, Symmetry::Asymmetric, begin, Choice::Taylor)?;
    let fixed = State::<3>::from_column_slice(&orbit.point);
    let slab = slab(pieces, driving, STIFFNESS)?;
    let field = slab.whole();
    // The orbit's point is where it falls through this very stress.
    let surface = Surface::stress(slab.steady_stress(), Crossing::Downwards);
    let watching = Watching {
        skip: 0,
        returns: RETURNS,
        patience: 100.0 * slab.rough_period(),
        accuracy: TOLERANCE,
        waypoints: false,
    };
    let mut taylor = Choice::Taylor.integrator::<3>(Tolerances::equal(TOLERANCE)?, MAX_STEPS)?;
    let start = fixed + State::<3>::new(0.0, beside, 0.0);
    let mut seen = |_: usize, _: Option<&Return<3>>| Control::Continue;
    let found = record(
        &mut *taylor,
        &*field,
        &start,
        &surface,
        &watching,
        &mut seen,
    );
    let all: Vec<f64> = found
        .returns
        .iter()
        .map(|at| (at.state - fixed).norm())
        .collect();
    if all.len() < RETURNS {
        return Err(missing(
            "a run beside the torus bifurcation that does not come back",
        ));
    }
    let largest = |all: &[f64]| all.iter().copied().fold(0.0, f64::max);
    Ok([largest(&all[..WINDOW]), largest(&all[RETURNS - WINDOW..])])
}

/// A number that a second method found.
pub(super) fn moved(first: Uncertain, part: f64) -> Uncertain {
    let value = first.value * (1.0 + part);
    Uncertain::new(value, (value - first.value).abs() + first.uncertainty)
}

/// The second method.
pub(super) fn crosscheck(pieces: &Pieces<'_>, special: &Special) -> Result<[f64; 3]> {
    let slab = slab(pieces, special.driving.value, special.stiffness.value)?;
    let parts = crate::bifurcation::orbits::crosscheck(&slab, special, second_method()?)?;
    parts.ok_or_else(|| missing("a special point without its orbit"))
}
