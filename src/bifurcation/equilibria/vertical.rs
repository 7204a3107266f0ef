//! Curves of pitchforks and folds in the (V_H, K) plane: vertical lines, as both are the same at every stiffness.
//!
//! Looked for on them: a second zero eigenvalue. On a pitchfork line there is none at K > 0, as there (26) leaves
//! s^2 + 2 K s / F_V + 2 K G_psi / F_V with positive coefficients, and nothing degenerates along it. On a fold line c_1 of
//! (30) has one zero, a Bogdanov-Takens point; with the paper's parameters it lies at K = 4.4e-13, next to nothing.

use super::curves::{AlongDriving, CurveVariables};
use super::pieces::Ends;
use super::special::Teller;
use super::stationary::{Fold, fold, fold_test, pitchforks};
use crate::bifurcation::{Criticality, Label, LocusKind, LocusRequest, LocusRow, Special};
use crate::continuation::{CurveObserver, CurvePoint, PointKind, Settings, Stop, follow};
use crate::equilibrium::Symmetry;
use crate::error::{Error, Result};
use crate::friction::AnyLaw;
use crate::number::Uncertain;
use std::ops::ControlFlow;

/// The longest step in ln K.
const LONGEST: f64 = 0.2;

/// A vertical line.
struct VerticalLine {
    driving: Uncertain,
    criticality: Option<Criticality>,
    coefficient: Option<f64>,
    /// What lies on it.
    bogdanov_takens: Option<Uncertain>,
}

pub(super) fn locus(request: &LocusRequest, teller: &mut Teller<'_>) -> Result<ControlFlow<()>> {
    let (from, to) = request.driving;
    let law = &request.slab.law;
    let lines: Vec<VerticalLine> = if request.kind == LocusKind::Pitchfork {
        let all = pitchforks(law).into_iter();
        all.map(|p| VerticalLine {
            driving: p.driving,
            criticality: Some(p.criticality).filter(|_| request.criticality),
            coefficient: Some(p.coefficient).filter(|_| request.criticality),
            bogdanov_takens: None,
        })
        .collect()
    } else {
        let all = folds(law, request.driving)?.into_iter();
        all.map(|f| VerticalLine {
            driving: f.driving,
            criticality: None,
            coefficient: None,
            bogdanov_takens: f.bogdanov_takens(law),
        })
        .collect()
    };
    let inside = |line: &&VerticalLine| (from.min(to)..=from.max(to)).contains(&line.driving.value);
    for (number, line) in lines.iter().filter(inside).enumerate() {
        if along(request, line, number, teller).is_break() {
            return Ok(ControlFlow::Break(()));
        }
    }
    Ok(ControlFlow::Continue(()))
}

/// All values of K to be shown, in order, with what they are: as they are asked for, however many there may be.
fn values(
    request: &LocusRequest,
    line: &VerticalLine,
) -> impl Iterator<Item = (Uncertain, Option<Label>)> + use<> {
    let (from, to) = request.stiffness;
    let (low, high) = (from.min(to), from.max(to));
    let exact = |k: f64| Uncertain::new(k, 0.0);
    let mut special: Vec<_> = [low, high].map(|k| (exact(k), Label::Ep)).into();
    let wanted = request.at_stiffness.iter();
    special.extend(wanted.map(|&k| (exact(k), Label::Uz)));
    special.extend(line.bogdanov_takens.map(|k| (k, Label::Bt)));
    special.retain(|(k, _)| (low..=high).contains(&k.value));
    special.sort_by(|(a, _), (b, _)| a.value.total_cmp(&b.value));
    if from > to {
        special.reverse();
    }
    let (begin, width) = (from.ln(), to.ln() - from.ln());
    let parts = (width.abs() / (LONGEST * request.step)).ceil().max(1.0);
    let steps = (1_u64..)
        .map(|i| i as f64)
        .take_while(move |&i: &f64| i < parts)
        .map(move |i| (begin + width * (i / parts)).exp());
    let (mut steps, mut special) = (steps.peekable(), special.into_iter().peekable());
    let up = from < to;
    std::iter::from_fn(move || {
        let first = match (steps.peek(), special.peek()) {
            (Some(step), Some((k, _))) => (*step < k.value) == up && *step != k.value,
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
    curve: usize,
    teller: &mut Teller<'_>,
) -> ControlFlow<()> {
    for (stiffness, label) in values(request, line) {
        teller.locus(LocusRow {
            share: None,
            curve,
            symmetry: match request.kind {
                LocusKind::Pitchfork => Symmetry::Symmetric,
                _ => Symmetry::Asymmetric,
            },
            driving: line.driving,
            stiffness,
            period: None,
            angle_over_pi: None,
            criticality: line.criticality,
            label,
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

/// Sees folds and keeps the rates.
struct Hunt {
    found: Vec<[f64; 2]>,
}

impl CurveObserver for Hunt {
    fn tests(&self, point: &CurvePoint) -> Result<Vec<f64>> {
        Ok(vec![point.u[0], fold_test(point)])
    }
    fn ends(&self, test: usize) -> bool {
        test == 0
    }
    fn seen(&mut self, point: &CurvePoint, mark: PointKind) -> ControlFlow<()> {
        if mark == PointKind::Zero(1) {
            self.found
                .push(CurveVariables::Asymmetric.rates(point, point.lambda.exp()));
        }
        ControlFlow::Continue(())
    }
}

/// All folds of asymmetric states within a range of V_H.
fn folds(law: &AnyLaw, (from, to): (f64, f64)) -> Result<Vec<Fold>> {
    let settings = Settings::new((from.min(to).ln(), from.max(to).ln()), LONGEST)?;
    let problem = AlongDriving {
        law,
        curve: CurveVariables::Asymmetric,
    };
    let mut hunt = Hunt { found: Vec::new() };
    let mut ends = Ends::of(law, (from, to))?;
    while let Some(begin) = ends.next() {
        let branch = follow(&problem, &begin.start, &settings, &mut hunt)?;
        if let Stop::StepTooSmall { because, .. } = branch.stopped {
            return Err(because.unwrap_or(Error::NotConverged {
                what: "the curve of asymmetric states on which folds are looked for",
                iterations: branch.points.len(),
                residual: f64::INFINITY,
                tolerance: settings.tolerance,
            }));
        }
        ends.reached(&branch);
    }
    Ok(hunt
        .found
        .iter()
        .filter_map(|&rates| fold(law, rates))
        .collect())
}
