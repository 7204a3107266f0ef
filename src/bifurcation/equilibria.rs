//! Stub.

use super::{
    BranchRequest, BranchRow, Criticality, Event, Label, LocusKind, LocusRequest, LocusRow, Seen,
    Special,
};
use crate::equilibrium::{Symmetry, Verdict};
use crate::error::Result;
use crate::model::Parameter;
use crate::number::Uncertain;

/// Stub: curves that look a little like the real ones.
pub fn branch(request: &BranchRequest, seen: Seen<'_>) -> Result<()> {
    synthetic_branch(request, false, seen)
}

/// Stub.
pub fn locus(request: &LocusRequest, seen: Seen<'_>) -> Result<()> {
    synthetic_locus(request, seen)
}

pub(super) fn synthetic_branch(r: &BranchRequest, orbits: bool, seen: Seen<'_>) -> Result<()> {
    let wanted = |s| r.symmetry.is_none_or(|w| w == s);
    for (n, symmetry) in [Symmetry::Symmetric, Symmetry::Asymmetric]
        .into_iter()
        .enumerate()
    {
        if !wanted(symmetry) || r.skip.contains(&n) {
            continue;
        }
        let points = 80;
        for i in 0..points {
            let part = f64::from(i) / f64::from(points - 1);
            let x = r.range.0 * (r.range.1 / r.range.0).powf(part);
            let (driving, stiffness) = match r.along {
                Parameter::Driving => (x, r.slab.loading.stiffness),
                _ => (r.slab.loading.driving, x),
            };
            let split = if n == 1 {
                1.0 - (2.0 * part - 1.0).powi(2)
            } else {
                0.0
            };
            let stress = 11.0 - 2.0 * part + 0.8 * (9.0 * part).sin() - 1.5 * split;
            let wide = if orbits {
                1.5 * (1.0 - (2.0 * part - 1.0).powi(2)) + 0.2 * split
            } else {
                0.0
            };
            let label = match i {
                0 => Some(Label::Ep),
                20 if n == 0 && !orbits => Some(Label::Bp),
                22 if orbits => Some(Label::Pd),
                24 if orbits => Some(Label::Tr),
                26 => Some(if orbits { Label::Sn } else { Label::Hb }),
                60 => Some(if orbits { Label::Pf } else { Label::Hb }),
                _ if i == points - 1 => Some(Label::Ep),
                _ => None,
            };
            let row = BranchRow {
                branch: n,
                driving,
                stiffness,
                stress,
                stress_range: (stress - wide, stress + wide),
                period: orbits.then_some(5.0 / (driving * stiffness)),
                state: [0.1 + 0.1 * split, 0.1],
                slip_rate: [driving / 2.0 * (1.0 - split), driving / 2.0 * (1.0 + split)],
                ln_abs_multiplier: [orbits.then_some(-0.5), orbits.then_some(-7.5)],
                verdict: match label {
                    Some(Label::Ep | Label::Uz) | None if (20..60).contains(&i) => {
                        Verdict::Unstable
                    }
                    Some(Label::Ep | Label::Uz) | None => Verdict::Stable,
                    _ => Verdict::Undecided,
                },
                label,
            };
            if seen(Event::Branch(row)).is_break() {
                return Ok(());
            }
            if let Some(label) = label {
                let special = special(
                    label,
                    driving,
                    stiffness,
                    orbits.then_some(5.0 / (driving * stiffness)),
                );
                if seen(Event::Special(special)).is_break() {
                    return Ok(());
                }
            }
        }
    }
    Ok(())
}

fn special(label: Label, driving: f64, stiffness: f64, period: Option<f64>) -> Special {
    Special {
        label,
        driving: Uncertain::new(driving, 1e-13 * driving),
        stiffness: Uncertain::new(stiffness, 0.0),
        period: period.map(|t| Uncertain::new(t, 1e-12 * t)),
        criticality: (!matches!(label, Label::Ep | Label::Uz))
            .then_some(Criticality::Supercritical),
        coefficient: (!matches!(label, Label::Ep | Label::Uz)).then_some(-0.25),
        note: None,
    }
}

pub(super) fn synthetic_locus(r: &LocusRequest, seen: Seen<'_>) -> Result<()> {
    for n in 0..2 {
        if r.skip.contains(&n) {
            continue;
        }
        let points = 60;
        for i in 0..points {
            let part = f64::from(i) / f64::from(points - 1);
            let driving = 0.05 * (3000.0 + 2000.0 * n as f64).powf(part);
            let stiffness = 0.002 + (0.4 + 0.2 * n as f64) * (std::f64::consts::PI * part).sin();
            let label = match i {
                0 => Some(Label::Ep),
                14 => Some(Label::R4),
                15 => Some(Label::R3),
                16 => Some(Label::R2),
                30 => Some(Label::Top),
                _ if i == points - 1 => Some(Label::Ep),
                _ => None,
            };
            let row = LocusRow {
                curve: n,
                driving: Uncertain::new(driving, 1e-12),
                stiffness: Uncertain::new(stiffness, 0.0),
                period: Some(100.0),
                angle_over_pi: (r.kind == LocusKind::Torus).then_some(part),
                criticality: r.criticality.then_some(Criticality::Subcritical),
                label,
            };
            if seen(Event::Locus(row)).is_break() {
                return Ok(());
            }
            if let Some(label) = label
                && seen(Event::Special(special(
                    label,
                    driving,
                    stiffness,
                    Some(100.0),
                )))
                .is_break()
            {
                return Ok(());
            }
        }
    }
    Ok(())
}
