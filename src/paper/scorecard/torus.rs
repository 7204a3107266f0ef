//! Torus bifurcations and period doublings: section 4.3, Figs 12 to 14 and 16.

use super::orbits::{at_top, orbit_at};
use super::table1::{again, resonances};
use super::{Answer, Entry, missing, second_method, slab, whether};
use crate::bifurcation::{Criticality, Label, LocusRow, Special};
use crate::equilibrium::{Symmetry, Verdict};
use crate::error::Result;
use crate::field::State;
use crate::integrate::{Choice, MAX_STEPS, Tolerances};
use crate::number::Uncertain;
use crate::number::polynomial::Crossing;
use crate::orbit::Begin;
use crate::paper::Pieces;
use crate::section::{Surface, Watching, half_driving_stress, record};

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
    let settled = orbit_at(pieces, above, Symmetry::Asymmetric, Begin::Anywhere, Choice::Taylor)?;
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
        .beside("where |mu| = 1 at that V_H, by a second integrator", Answer::Number(second))
        .noted(format!("at V_H = {driving:.6}")),
        stable_again(pieces)?,
    ])
}

fn stable_again(pieces: &Pieces<'_>) -> Result<Entry> {
    // The label at the largest V_H below which asymmetric orbits are unstable and above which they are stable.
    let by = |scene: &str| -> Result<Label> {
        let branches = pieces.branches(scene)?;
        let rows: Vec<_> = branches.rows.iter().filter(|row| row.state[0] != row.state[1]).collect();
        let windows = rows.windows(3).filter(|three| {
            let verdicts = [three[0].verdict, three[2].verdict];
            three[1].branch == three[0].branch
                && three[1].branch == three[2].branch
                && three[0].driving < three[1].driving
                && verdicts == [Verdict::Unstable, Verdict::Stable]
        });
        let mut labels = windows.filter_map(|three| three[1].label);
        labels.next().ok_or_else(|| missing("no orbits that become stable again"))
    };
    let (here, softer) = (by("fig07")?, by("fig09")?);
    let as_told = here == Label::Tr && softer == Label::Pd;
    Ok(Entry::claim(
        ("stable-again", "section 4.2, after Fig. 11; Fig. 7(a)"),
        "in what the asymmetric orbits become stable again, depending on K",
        "torus or period doubling",
        whether(as_told, "torus or period doubling", "otherwise"),
    )
    .noted(format!("{} at K = 0.14, {} at K = 0.05", here.meaning(), softer.meaning())))
}

/// Section 4.3.
pub fn of_section_4_3(pieces: &Pieces<'_>) -> Result<Vec<Entry>> {
    let curves = pieces.curves("fig12")?;
    let place = "section 4.3.2";
    let double = resonances(pieces)?.into_iter().find(|s| s.label == Label::R2);
    let double = double.ok_or_else(|| missing("the torus bifurcations have no resonance 1:2"))?;
    let [_, stiffness] = again(pieces, &double)?;
    let last = curves.rows.iter().filter_map(|row| row.angle_over_pi).fold(0.0, f64::max);
    let counts = [Label::R4, Label::R3, Label::R2].map(|label| {
        let these = curves.special.iter().filter(|s| s.label == label);
        these.count()
    });
    Ok(vec![
        Entry::claim(
            ("resonances-met", "Table 1; Fig. 14"),
            "how often the curve of torus bifurcations meets the resonances 1:4, 1:3, 1:2",
            "3, 1, 1",
            whether(counts == [3, 1, 1], "3, 1, 1", "otherwise"),
        ),
        finite_gradients(&curves.rows),
        Entry::number(
            ("K-of-1:2-in-the-text", place),
            "K of the resonance 1:2",
            "a sigma/L",
            "0.138",
            double.stiffness,
        )
        .beside(super::BY_SECOND, Answer::Number(stiffness)),
        Entry::claim(
            ("angle-at-1:2", "section 4.3.2; Fig. 14"),
            "theta/pi of the multipliers as the curve comes to the resonance 1:2",
            "1",
            whether(last > 0.999 && last <= 1.0, "1", "otherwise"),
        )
        .noted(format!("the largest on the points of the curve is {last:.6}; there the curve ends")),
        meeting(pieces, &double)?,
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

/// The resonance 1:2 on the curve of period doublings.
fn meeting(pieces: &Pieces<'_>, double: &Special) -> Result<Entry> {
    let doublings = pieces.curves("fig12-period-doubling")?;
    let there = doublings.special.iter().find(|s| s.label == Label::R2);
    let there = there.ok_or_else(|| missing("the period doublings have no resonance 1:2"))?;
    let apart = [
        there.driving.value / double.driving.value - 1.0,
        there.stiffness.value / double.stiffness.value - 1.0,
    ];
    let meet = apart.iter().all(|part| part.abs() < 1e-9);
    Ok(Entry::claim(
        ("meeting-at-1:2", "Figs 6, 12"),
        "the torus and the period-doubling curve at the resonance 1:2",
        "meet",
        whether(meet, "meet", "are apart"),
    )
    .noted(format!("found on either curve by itself, the point is the same to the parts {:.0e} and {:.0e}", apart[0].abs(), apart[1].abs())))
}

/// The caption of Fig. 16, and which way the torus bifurcation goes.
pub fn of_fig_16(pieces: &Pieces<'_>) -> Result<Vec<Entry>> {
    let branches = pieces.branches("fig07")?;
    let of = |label: Label| -> Result<[&Special; 2]> {
        let mut all: Vec<_> = branches.special.iter().filter(|s| s.label == label).collect();
        all.sort_by(|a, b| a.driving.value.total_cmp(&b.driving.value));
        all.try_into().map_err(|_| missing("fig07 has not two torus bifurcations and two period doublings"))
    };
    let ([first, last], doublings) = (of(Label::Tr)?, of(Label::Pd)?);
    let printed = [
        ("TR-first", first, "V_H of the first torus bifurcation at K = 0.14", "0.0767"),
        ("PD-first", doublings[0], "V_H of the first period doubling at K = 0.14", "0.0842"),
        ("PD-last", doublings[1], "V_H of the last period doubling at K = 0.14", "0.0980"),
        ("TR-last", last, "V_H of the last torus bifurcation at K = 0.14", "0.1000"),
    ];
    let mut all = vec![way(pieces, first)?];
    for (id, special, quantity, printed) in printed {
        let [driving, _] = again(pieces, special)?;
        all.push(
            Entry::number((id, "Fig. 16, caption"), quantity, "V*", printed, special.driving)
                .beside(super::BY_SECOND, Answer::Number(driving))
                .misprinted("two methods agree on the computed value to nine digits, and the torus bifurcations of the same caption are right"),
        );
    }
    Ok(all)
}

/// Which way the first torus bifurcation goes: by its cubic coefficient, and by what returns beside the orbit do.
fn way(pieces: &Pieces<'_>, torus: &Special) -> Result<Entry> {
    let word = match torus.criticality {
        Some(Criticality::Supercritical) => "supercritical",
        Some(Criticality::Subcritical) => "subcritical",
        _ => "undecided",
    };
    let [early, late] = returns(pieces, torus)?;
    let coefficient = torus.coefficient.unwrap_or(f64::NAN);
    Ok(Entry::claim(
        ("torus-at-0.14", "section 4.3.2; Fig. 16(a)"),
        "the torus bifurcation at K = 0.14, V_H = 0.0767",
        "subcritical",
        word,
    )
    .beside(
        "4000 returns beside the orbit at the bifurcation itself",
        Answer::Word(whether(late < early, "supercritical", "subcritical")),
    )
    .noted(format!(
        "by a hair: the cubic coefficient is {coefficient:.5}, and the distance of returns falls from {early:.5} to {late:.5}; runs that start farther away than 0.07 escape, so that simulations look subcritical, as the text says"
    )))
}

/// The largest distance from the periodic point among early and among late returns, of a run that begins beside the orbit.
fn returns(pieces: &Pieces<'_>, torus: &Special) -> Result<[f64; 2]> {
    /// Returns, and how many of them are looked at in either part.
    const RETURNS: usize = 4000;
    const WINDOW: usize = 500;
    /// How far off the run begins, in ln psi.
    const BESIDE: f64 = 0.01;
    let orbit = torus.orbit.as_ref().ok_or_else(|| missing("a torus bifurcation without its orbit"))?;
    let node = &orbit.nodes().0[0];
    let slab = slab(pieces, torus.driving.value, torus.stiffness.value)?;
    let field = slab.whole();
    let stress = half_driving_stress(&slab.law, slab.loading.driving, 2);
    let surface = Surface::stress(stress, Crossing::Downwards);
    let tolerance = 1e-15;
    let landed = |off: f64, skip: usize, returns: usize| -> Result<Vec<State<3>>> {
        let mut taylor = Choice::Taylor.integrator::<3>(Tolerances::equal(tolerance)?, MAX_STEPS)?;
        let watching = Watching {
            skip,
            returns,
            patience: 100.0 * slab.rough_period(),
            accuracy: tolerance,
            waypoints: false,
        };
        let start = State::<3>::new(node[0], node[1] + off, node[2]);
        let found = record(&mut *taylor, &*field, &start, &surface, &watching, &mut |_, _| {
            crate::integrate::Control::Continue
        });
        Ok(found.returns.iter().map(|at| at.state).collect())
    };
    let fixed = landed(0.0, 0, 1)?;
    let fixed = fixed.first().ok_or_else(|| missing("an orbit that does not come back"))?;
    let passed = landed(BESIDE, 0, RETURNS)?;
    if passed.len() < RETURNS {
        return Err(missing("a run beside the torus bifurcation that does not come back"));
    }
    let largest = |all: &[State<3>]| all.iter().map(|y| (y - fixed).norm()).fold(0.0, f64::max);
    Ok([largest(&passed[..WINDOW]), largest(&passed[RETURNS - WINDOW..])])
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
