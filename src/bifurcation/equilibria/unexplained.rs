//! Bifurcations at which several eigenvalues cross the imaginary axis together, such as two complex pairs.
//!
//! The test functions are products, and keep their sign where an even number of factors vanishes at once. So the numbers of unstable
//! eigenvalues at neighbouring points are compared. Where they differ and no test function changed sign, bisection locates the crossing.

use super::generic::{FieldEquilibria, FoundEquilibrium};
use crate::bifurcation::Label;
use nalgebra::Complex;
use std::f64::consts::TAU;

/// Real parts below this, against the largest eigenvalue, have no certain sign.
const CERTAIN: f64 = 1e-9;

/// The modulus of the largest.
fn largest(eigenvalues: &[Complex<f64>]) -> f64 {
    eigenvalues.iter().map(|z| z.norm()).fold(0.0, f64::max)
}

/// How many eigenvalues have a positive real part; `None` where that of one has no certain sign.
pub(super) fn unstable(eigenvalues: &[Complex<f64>]) -> Option<usize> {
    unstable_of(eigenvalues, largest(eigenvalues))
}

/// The same of a system with eigenvalues of this size.
fn unstable_of(eigenvalues: &[Complex<f64>], size: f64) -> Option<usize> {
    let certain = eigenvalues.iter().all(|z| z.re.abs() > CERTAIN * size);
    certain.then(|| eigenvalues.iter().filter(|z| z.re > 0.0).count())
}

/// Locates the crossing between two points of a branch without a fold between them. Returns one point for each complex pair, or one for all
/// real eigenvalues; none where the crossing is not found.
pub(super) fn crossings(
    family: &FieldEquilibria<'_>,
    from: &FoundEquilibrium,
    to: &FoundEquilibrium,
) -> Vec<FoundEquilibrium> {
    located(family, from, to).unwrap_or_default()
}

fn located(
    family: &FieldEquilibria<'_>,
    from: &FoundEquilibrium,
    to: &FoundEquilibrium,
) -> Option<Vec<FoundEquilibrium>> {
    /// Bisections, which end at the last digits or where rounding hides the signs.
    const BISECTIONS: usize = 60;
    let size = largest(&from.eigenvalues).max(largest(&to.eigenvalues));
    let before = unstable_of(&from.eigenvalues, size)?;
    let (mut near, mut far) = (from.clone(), to.clone());
    for _ in 0..BISECTIONS {
        let parameter = 0.5 * (near.parameter + far.parameter);
        let guess = (&near.state + &far.state) * 0.5;
        let state = family.corrected(&guess, parameter)?;
        let eigenvalues = family.eigenvalues(&state, parameter)?;
        let count = unstable_of(&eigenvalues, size);
        let middle = FoundEquilibrium {
            state,
            parameter,
            eigenvalues,
            ..near.clone()
        };
        match count {
            Some(count) if count == before => near = middle,
            Some(_) => far = middle,
            None => return at(family, (&near, &far), size),
        }
    }
    at(family, (&near, &far), size)
}

/// Interpolates the crossing between two points that are so close that the real parts depend linearly on the parameter.
fn at(
    family: &FieldEquilibria<'_>,
    (near, far): (&FoundEquilibrium, &FoundEquilibrium),
    size: f64,
) -> Option<Vec<FoundEquilibrium>> {
    /// In sizes of the eigenvalues: what is on the axis.
    const ON_AXIS: f64 = 1e-6;
    /// Units in the last place by which eigenvalues are off, and the part of the distance of both points by which they bend.
    const ROUNDING: f64 = 64.0 * f64::EPSILON;
    const BENT: f64 = 1e-3;
    let crossing = |all: &[Complex<f64>]| -> Vec<Complex<f64>> {
        let on_axis = all.iter().filter(|z| z.re.abs() < ON_AXIS * size);
        on_axis.copied().collect()
    };
    let mean = |all: &[Complex<f64>]| {
        let crossing = crossing(all);
        crossing.iter().map(|z| z.re).sum::<f64>() / crossing.len() as f64
    };
    let width = far.parameter - near.parameter;
    let (before, behind) = (mean(&near.eigenvalues), mean(&far.eigenvalues));
    let slope = (behind - before) / width;
    let parameter = near.parameter - before / slope;
    // Where eigenvalues are zero Newton's method may have no step.
    let part = (parameter - near.parameter) / width;
    let between = &near.state * (1.0 - part) + &far.state * part;
    let state = family.corrected(&between, parameter).unwrap_or(between);
    let eigenvalues = family.eigenvalues(&state, parameter)?;
    let off = ROUNDING * size / slope.abs() + BENT * width.abs();
    let crossing = crossing(&eigenvalues);
    let frequencies = crossing.iter().map(|z| z.im);
    let frequencies: Vec<f64> = frequencies.filter(|im| *im > ON_AXIS * size).collect();
    let point = |label: Label, period: Option<f64>| FoundEquilibrium {
        state: state.clone(),
        parameter,
        eigenvalues: eigenvalues.clone(),
        uncertainty: Some(off + f64::EPSILON * parameter.abs()),
        label: Some(label),
        period,
        together: crossing.len(),
        crossing: None,
        coefficient: None,
        ..near.clone()
    };
    Some(match frequencies.is_empty() {
        true => vec![point(Label::Bp, None)],
        false => frequencies
            .into_iter()
            .map(|omega| point(Label::Hb, Some(TAU / omega)))
            .collect(),
    })
}
