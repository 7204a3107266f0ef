//! The curves of Hopf points in the plane of V_H and K: Fig. 6.

use super::{Answer, Entry, extrema, missing, slab, whether};
use crate::Pieces;
use std::ops::ControlFlow;
use twinslip::bifurcation::{
    Criticality, Event, Label, LocusKind, LocusRequest, LocusRow, Parameter, Special, equilibria,
};
use twinslip::equilibrium::{Symmetry, Verdict};
use twinslip::error::Result;
use twinslip::friction::critical_stiffness_maximum;
use twinslip::number::Uncertain;
use twinslip::orbit::hopf_points;

/// The least K that the curves are followed to.
const SOFTEST: f64 = 1e-6;

/// A curve of Hopf points with what is special on it.
struct HopfCurve {
    rows: Vec<LocusRow>,
    special: Vec<Special>,
}

impl HopfCurve {
    fn of(pieces: &Pieces<'_>, symmetry: Symmetry) -> Result<Self> {
        let request = LocusRequest {
            symmetry: Some(symmetry),
            criticality: true,
            ..LocusRequest::new(
                slab(pieces, 1.0, 0.1)?,
                LocusKind::Hopf,
                (1e-3, 1e6),
                (SOFTEST, 1.0),
            )
        };
        let (mut rows, mut special) = (Vec::new(), Vec::new());
        equilibria::locus(&request, &mut |event| {
            match event {
                Event::Locus(row) => rows.push(row),
                Event::Special(point) => special.push(point),
                Event::Branch(_) => {}
            }
            ControlFlow::Continue(())
        })?;
        Ok(HopfCurve { rows, special })
    }

    /// V_H of both ends, at the least K, the smaller one first.
    fn ends(&self) -> Result<[f64; 2]> {
        let ends = self.special.iter().filter(|s| s.label == Label::Ep);
        let mut ends: Vec<f64> = ends.map(|s| s.driving.value).collect();
        ends.sort_by(f64::total_cmp);
        match ends[..] {
            [left, right] => Ok([left, right]),
            _ => Err(missing("the curve of Hopf points has no two ends")),
        }
    }
}

/// How many Hopf points there are along V_H.
fn count(pieces: &Pieces<'_>, stiffness: f64, symmetry: Symmetry) -> Result<usize> {
    let slab = slab(pieces, 1.0, stiffness)?;
    Ok(hopf_points(&slab, symmetry, Parameter::Driving)?.len())
}

/// All of it.
pub fn entries(pieces: &Pieces<'_>) -> Result<Vec<Entry>> {
    let symmetric = HopfCurve::of(pieces, Symmetry::Symmetric)?;
    let asymmetric = HopfCurve::of(pieces, Symmetry::Asymmetric)?;
    let [v_peak, v_trough] = extrema(&pieces.law())?;
    Ok(vec![
        no_hopf_points(pieces, &symmetric, &asymmetric)?,
        left_ends([symmetric.ends()?[0], asymmetric.ends()?[0]], v_peak),
        right_end(asymmetric.ends()?[1], v_trough),
        always_supercritical(pieces, &asymmetric)?,
        top(pieces, &symmetric)?,
    ])
}

fn no_hopf_points(
    pieces: &Pieces<'_>,
    symmetric: &HopfCurve,
    asymmetric: &HopfCurve,
) -> Result<Entry> {
    let mut there = count(pieces, 0.45, Symmetry::Asymmetric)?;
    for stiffness in [0.45, 0.3, 0.2] {
        there += count(pieces, stiffness, Symmetry::Symmetric)?;
    }
    let beyond = |curve: &HopfCurve, k: f64| curve.rows.iter().any(|row| row.stiffness.value > k);
    let above = beyond(symmetric, 0.2) || beyond(asymmetric, 0.45);
    Ok(Entry::claim(
        ("no-hopf", "Figs 5, 6"),
        "Hopf points of equilibria at K = 0.45, and of symmetric ones at K = 0.3 and 0.2",
        "none",
        whether(there == 0, "none", "some"),
    )
    .beside(
        "the largest K of both curves of Hopf points",
        Answer::Word(whether(above, "some", "none")),
    ))
}

fn left_ends(ends: [f64; 2], v_peak: f64) -> Entry {
    let parts = ends.map(|v| v / (2.0 * v_peak) - 1.0);
    let near = parts.iter().all(|part| (0.0..1e-4).contains(part));
    Entry::claim(
        ("approach-to-2V_M", "section 4.2; Fig. 6"),
        "where both curves of Hopf points go as K -> 0, at small V_H",
        "2 V_M",
        whether(near, "2 V_M", "elsewhere"),
    )
    .noted(format!(
        "at K = {SOFTEST:e} V_H exceeds 2 V_M by the parts {:.1e} and {:.1e}",
        parts[0], parts[1]
    ))
}

fn right_end(end: f64, v_trough: f64) -> Entry {
    let part = end / v_trough - 1.0;
    Entry::claim(
        ("end-of-asymmetric-hopf", "section 4.2; Fig. 6"),
        "where the curve of asymmetric Hopf points vanishes at large V_H",
        "V_m",
        whether(part.abs() < 1e-5, "V_m", "elsewhere"),
    )
    .noted(format!(
        "at K = {SOFTEST:e} V_H is V_m but for the part {part:.1e}"
    ))
}

fn always_supercritical(pieces: &Pieces<'_>, curve: &HopfCurve) -> Result<Entry> {
    let to = |way: Criticality| {
        curve
            .rows
            .iter()
            .filter(move |row| row.criticality == Some(way))
    };
    let all = to(Criticality::Supercritical).count() == curve.rows.len();
    let degenerate = curve.special.iter().any(|s| s.label == Label::Gh);
    // Orbits beside the Hopf points at K = 0.14: the first and the last of the branch.
    let branches = pieces.branches("fig07")?;
    let orbits = branches
        .rows
        .iter()
        .filter(|row| row.state[0] != row.state[1] && row.label.is_none());
    let orbits: Vec<_> = orbits.collect();
    let ends = [orbits.first(), orbits.last()];
    let stable = ends
        .iter()
        .all(|row| row.is_some_and(|row| row.verdict == Verdict::Stable));
    let word = |it_is| whether(it_is, "always supercritical", "not always supercritical");
    Ok(Entry::claim(
        ("asymmetric-hopf-supercritical", "section 4.2; Fig. 6"),
        "the Hopf bifurcations from the asymmetric equilibria",
        "always supercritical",
        word(all && !degenerate),
    )
    .beside(
        "Floquet multipliers of the orbits beside both Hopf points at K = 0.14",
        Answer::Word(word(stable)),
    )
    .noted(format!(
        "the first Lyapunov coefficient in 31 digits is negative at all {} points of the \
         curve from K = {SOFTEST:e}, and nowhere zero",
        curve.rows.len()
    )))
}

fn top(pieces: &Pieces<'_>, symmetric: &HopfCurve) -> Result<Entry> {
    let top = symmetric.special.iter().find(|s| s.label == Label::Top);
    let top = top.ok_or_else(|| missing("the symmetric Hopf points have no top"))?;
    let largest = critical_stiffness_maximum(&pieces.law())?;
    let Uncertain { value, uncertainty } = largest
        .ok_or_else(|| missing("k_c has no maximum"))?
        .stiffness;
    Ok(Entry::number(
        ("largest-K-of-symmetric-hopf", "section 4.2, after Fig. 7"),
        "the largest K with Hopf points of the symmetric equilibrium",
        "a sigma/L",
        "< 0.2",
        top.stiffness,
    )
    .beside_number(
        "half the largest k_c(V), in intervals",
        0.5 * value,
        0.5 * uncertainty,
    )
    .noted(format!("at V_H = {:.6}", top.driving.value)))
}
