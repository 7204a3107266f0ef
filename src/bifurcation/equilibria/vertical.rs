//! Curves of branch points and folds in the (V_H, K) plane: vertical lines, as both are the same at every stiffness.
//!
//! Looked for on them: a second zero eigenvalue. On a line of pitchforks of two interfaces there is none at K > 0, as there (26) leaves
//! s^2 + 2 K s / F_V + 2 K G_psi / F_V with positive coefficients, and nothing degenerates along it. On a fold line the coefficient of z
//! has one zero, a Bogdanov-Takens point; of V_sn with the paper's parameters it lies at K = 4.4e-13, next to nothing.

use super::course::{Course, Step, steady_curve};
use super::special::Teller;
use super::stationary::{meeting, parting};
use crate::bifurcation::{Criticality, Label, LocusKind, LocusRequest, LocusRow, Special};
use crate::equilibrium::{EquilibriumCurve, FAST, SLOW, Share, Symmetry, shares};
use crate::error::Result;
use crate::number::Uncertain;
use std::ops::ControlFlow;

/// The longest step in ln K.
const LONGEST: f64 = 0.2;

/// A vertical line.
struct VerticalLine {
    share: Share,
    symmetry: Symmetry,
    driving: Uncertain,
    criticality: Option<Criticality>,
    coefficient: Option<f64>,
    /// What lies on it.
    bogdanov_takens: Option<Uncertain>,
}

pub(super) fn locus(request: &LocusRequest, teller: &mut Teller<'_>) -> Result<ControlFlow<()>> {
    let mut lines = match request.kind {
        LocusKind::SaddleNode => folds(request)?,
        _ => branch_points(request)?,
    };
    lines.retain(|line| (request.driving.0..=request.driving.1).contains(&line.driving.value));
    for (number, line) in lines.iter().enumerate() {
        if !request.skip.contains(&number) && along(request, line, number, teller).is_break() {
            return Ok(ControlFlow::Break(()));
        }
    }
    Ok(ControlFlow::Continue(()))
}

fn wants(request: &LocusRequest, symmetry: Symmetry) -> bool {
    request.symmetry.is_none_or(|wanted| wanted == symmetry)
}

fn folds(request: &LocusRequest) -> Result<Vec<VerticalLine>> {
    let steady = steady_curve(&request.slab, request.driving.1)?;
    let step = Step::new(request.step, request.max_points);
    let course = Course::shares(steady, request.driving.1, step);
    let course = course.filter(|_| wants(request, Symmetry::Asymmetric));
    let mut all = Vec::new();
    if let Some(course) = &course {
        for share in shares(steady.has(), request.slab.interfaces) {
            for fold in course.folds(&share, request.driving)? {
                all.push(VerticalLine {
                    share,
                    symmetry: Symmetry::Asymmetric,
                    driving: fold.driving,
                    criticality: None,
                    coefficient: None,
                    bogdanov_takens: fold.bogdanov_takens(),
                });
            }
        }
    }
    Ok(all)
}

/// Where n > 1 interfaces pass an extremum together: n = N first, then by their number.
fn branch_points(request: &LocusRequest) -> Result<Vec<VerticalLine>> {
    let interfaces = request.slab.interfaces;
    let steady = steady_curve(&request.slab, request.driving.1)?;
    let curve = EquilibriumCurve::Shares(steady);
    let mut all = Vec::new();
    for together in (2..=interfaces).rev() {
        let symmetry = match together == interfaces {
            true => Symmetry::Symmetric,
            false => Symmetry::Asymmetric,
        };
        for (branch, other) in [(SLOW, FAST), (FAST, SLOW)] {
            let mut share = [0; 3];
            (share[branch], share[other]) = (together, interfaces - together);
            let there = steady.has()[other] || share[other] == 0;
            let met = meeting(&curve, &share, branch).filter(|_| there && wants(request, symmetry));
            let Some((_, driving)) = met else {
                continue;
            };
            // the same at every K
            let at = [driving, Uncertain::new(request.stiffness.0, 0.0)];
            let point = parting(&steady, branch, at, (together, interfaces));
            all.push(VerticalLine {
                share,
                symmetry,
                driving,
                criticality: point.criticality.filter(|_| request.criticality),
                coefficient: point.coefficient.filter(|_| request.criticality),
                bogdanov_takens: None,
            });
        }
    }
    Ok(all)
}

/// All values of K to be shown, in order, with what they are: as they are asked for, however many there may be.
fn values(
    request: &LocusRequest,
    line: &VerticalLine,
) -> impl Iterator<Item = (Uncertain, Option<Label>)> + use<> {
    let (low, high) = request.stiffness;
    let exact = |k: f64| Uncertain::new(k, 0.0);
    let ends = [low, high].into_iter();
    let ends = ends.filter(|k| !request.at_stiffness.contains(k));
    let mut special: Vec<_> = ends.map(|k| (exact(k), Label::Ep)).collect();
    let wanted = request.at_stiffness.iter();
    special.extend(wanted.map(|&k| (exact(k), Label::Uz)));
    special.extend(line.bogdanov_takens.map(|k| (k, Label::Bt)));
    special.retain(|(k, _)| (low..=high).contains(&k.value));
    special.sort_by(|(a, _), (b, _)| a.value.total_cmp(&b.value));
    let (begin, width) = (low.ln(), high.ln() - low.ln());
    let parts = (width / (LONGEST * request.step)).ceil().max(1.0);
    let steps = (1_u64..)
        .map(|i| i as f64)
        .take_while(move |&i: &f64| i < parts)
        .map(move |i| (begin + width * (i / parts)).exp());
    let (mut steps, mut special) = (steps.peekable(), special.into_iter().peekable());
    std::iter::from_fn(move || {
        let first = match (steps.peek(), special.peek()) {
            (Some(step), Some((k, _))) => *step < k.value,
            (step, _) => step.is_some(),
        };
        if first {
            steps.next().map(|k| (exact(k), None))
        } else {
            special.next().map(|(k, label)| (k, Some(label)))
        }
    })
}

fn along(
    request: &LocusRequest,
    line: &VerticalLine,
    number: usize,
    teller: &mut Teller<'_>,
) -> ControlFlow<()> {
    for (stiffness, label) in values(request, line) {
        teller.locus(LocusRow {
            criticality: line.criticality,
            label,
            share: (request.slab.interfaces > 2).then_some(line.share),
            ..LocusRow::new(number, line.symmetry, line.driving, stiffness)
        })?;
        if let Some(label) = label {
            teller.special(Special {
                criticality: line.criticality,
                coefficient: line.coefficient,
                ..Special::new(label, line.driving, stiffness)
            })?;
        }
    }
    ControlFlow::Continue(())
}
