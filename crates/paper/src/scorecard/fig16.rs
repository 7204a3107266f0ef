//! Fig. 16, K = 0.14: its caption, and which way the first torus bifurcation goes.

use super::second::{BY_SECOND, again, orbit_at};
use super::{Answer, Entry, criticality_word, missing, slab, whether};
use crate::Pieces;
use twinslip::bifurcation::{Label, Special};
use twinslip::equilibrium::Symmetry;
use twinslip::error::Result;
use twinslip::field::Vector;
use twinslip::integrate::{AnyField, AnyIntegrator, Choice, Control, MAX_STEPS, Tolerances};
use twinslip::number::polynomial::Crossing;
use twinslip::orbit::InitialGuess;
use twinslip::section::{Return, Surface, Watching, record};

/// K.
const STIFFNESS: f64 = 0.14;
/// V_H just above the torus bifurcation, and below it.
const ABOVE: f64 = 0.0767405;
const BELOW: f64 = 0.0767;

/// The caption: name, label, which of the two by V_H, of what, V_H as printed.
const CAPTION: [(&str, Label, usize, &str, &str); 4] = [
    (
        "TR-first",
        Label::Tr,
        0,
        "V_H of the first torus bifurcation at K = 0.14",
        "0.0767",
    ),
    (
        "PD-first",
        Label::Pd,
        0,
        "V_H of the first period doubling at K = 0.14",
        "0.0842",
    ),
    (
        "PD-last",
        Label::Pd,
        1,
        "V_H of the last period doubling at K = 0.14",
        "0.0980",
    ),
    (
        "TR-last",
        Label::Tr,
        1,
        "V_H of the last torus bifurcation at K = 0.14",
        "0.1000",
    ),
];

/// All of it.
pub fn entries(pieces: &Pieces<'_>) -> Result<Vec<Entry>> {
    let branches = pieces.branches("fig07")?;
    let of = |label: Label| -> Result<[&Special; 2]> {
        let these = branches.special.iter().filter(|s| s.label == label);
        let mut these: Vec<_> = these.collect();
        these.sort_by(|a, b| a.driving.value.total_cmp(&b.driving.value));
        let two = these.try_into();
        two.map_err(|_| missing("fig07 has not two torus bifurcations and two period doublings"))
    };
    let mut all = vec![way(pieces, of(Label::Tr)?[0])?];
    for (id, label, which, quantity, printed) in CAPTION {
        let special = of(label)?[which];
        let [driving, _] = again(pieces, special)?;
        let place = (id, "Fig. 16, caption");
        let entry = Entry::number(place, quantity, "V*", printed, special.driving);
        all.push(entry.beside(BY_SECOND, Answer::Number(driving)).misprinted(
            "two methods agree on the computed value to nine digits, and the torus bifurcations \
             of the same caption are right",
        ));
    }
    Ok(all)
}

/// Which way the first torus bifurcation goes: by its cubic coefficient; by returns above it, which come from both sides to a
/// torus; and how returns below it that begin far off look as if it went the other way.
fn way(pieces: &Pieces<'_>, torus: &Special) -> Result<Entry> {
    let inside = distances(pieces, torus, ABOVE, 0.01)?;
    let outside = distances(pieces, torus, ABOVE, 0.05)?;
    let far = distances(pieces, torus, BELOW, 0.3)?;
    let between = inside[0] < inside[1] && inside[1] < outside[1] && outside[1] < outside[0];
    Ok(Entry::claim(
        ("torus-at-0.14", "section 4.3.2; Fig. 16(a)"),
        "the torus bifurcation at K = 0.14, V_H = 0.0767",
        "subcritical",
        criticality_word(torus.criticality),
    )
    .beside(
        "returns above the bifurcation, from inside and outside of a torus",
        Answer::Word(whether(between, "supercritical", "no torus found")),
    )
    .noted(format!(
        "only just: the cubic coefficient is {:.5}; at V_H = {ABOVE} the distance of returns from \
         the orbit grows from {:.4} to {:.4} and falls from {:.4} to {:.4}, to a torus between; at \
         {BELOW}, where the orbit is stable, returns that begin 0.3 away stay {:.2} away, so that \
         simulations look subcritical",
        torus.coefficient.unwrap_or(f64::NAN),
        inside[0],
        inside[1],
        outside[0],
        outside[1],
        far[1]
    )))
}

/// Returns of a run.
const RETURNS: usize = 3000;

/// The largest distance from the orbit's own return among early and among late returns, of a run that begins beside it.
fn distances(pieces: &Pieces<'_>, torus: &Special, driving: f64, beside: f64) -> Result<[f64; 2]> {
    /// How many returns are looked at, early and late.
    const WINDOW: usize = 500;
    let orbit = torus.orbit.as_ref();
    let orbit = orbit.ok_or_else(|| missing("a torus bifurcation without its orbit"))?;
    let node = &orbit.nodes().0[0];
    let begin = InitialGuess::At {
        start: (node[0], [node[1], node[2]]),
        period: torus.period.map(|period| period.value),
    };
    let (at, kind) = ((driving, STIFFNESS), Symmetry::Asymmetric);
    let orbit = orbit_at(pieces, at, kind, begin, Choice::Taylor)?;
    // Where it falls through the stress of the section.
    let fixed = Vector::from_column_slice(&orbit.point);
    let mut start = fixed.clone();
    start[1] += beside;
    let returns = returns(pieces, driving, &start)?;
    let all: Vec<f64> = returns.iter().map(|y| (y - &fixed).norm()).collect();
    let largest = |all: &[f64]| all.iter().copied().fold(0.0, f64::max);
    Ok([largest(&all[..WINDOW]), largest(&all[RETURNS - WINDOW..])])
}

/// The returns of a run to tau = tau_ss(V_H/2).
fn returns(pieces: &Pieces<'_>, driving: f64, start: &Vector) -> Result<Vec<Vector>> {
    const TOLERANCE: f64 = 1e-15;
    let slab = slab(pieces, driving, STIFFNESS)?;
    let field = AnyField::new::<3>(slab.whole());
    let surface = Surface::stress(field.dimension(), slab.steady_stress(), Crossing::Downwards);
    let watching = Watching {
        skip: 0,
        returns: RETURNS,
        patience: 100.0 * slab.rough_period(),
        accuracy: TOLERANCE,
        max_step: f64::INFINITY,
        waypoints: false,
    };
    let tolerances = Tolerances::equal(TOLERANCE)?;
    let mut taylor = AnyIntegrator::new(Choice::Taylor, tolerances, MAX_STEPS)?;
    let mut seen = |_: usize, _: Option<&Return>| Control::Continue;
    let run = record(&mut taylor, &field, start, &surface, &watching, &mut seen);
    let all: Vec<_> = run.returns.into_iter().map(|at| at.state).collect();
    if all.len() < RETURNS {
        return Err(missing("a run at K = 0.14 that does not come back"));
    }
    Ok(all)
}
