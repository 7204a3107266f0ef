//! Lyapunov exponents by finite differences: from the returns of runs that start beside those of a run.
//!
//! The derivative of the return map P at a return x is taken by central differences, (P(x + d) - P(x - d)) / 2d, over runs of
//! one return each: they fill all lanes, and take a fraction of the time of tangents. What the differences err by follows
//! from how much P bends within them.

use super::flows::{Flows, Leg};
use super::watch::SweepRun;
use crate::error::Error;
use crate::integrate::{AnyStep, Control, StepSeries};
use crate::section::{ALIGNMENT, GrowthSegment, LyapunovSpectrum, Return, summary};
use crate::series::Zeros;
use nalgebra::{Matrix2, Vector2};
use std::rc::Rc;

/// Part of the tolerance's cube root that starts are displaced by, in ln psi: rounding and bending then matter alike.
const DISPLACED: f64 = 0.1;
/// A displaced run that comes back later than the run itself by this part has missed a return.
const LATE: f64 = 0.5;
/// Displaced by how much of d, and which way: (psi_1, psi_2).
const BESIDE: [[f64; 2]; 4] = [[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]];

/// The exponents along these consecutive returns of a run, from the first to the last; `None` where a run beside it takes
/// another way.
pub(super) fn stretching(
    run: &SweepRun,
    returns: &[Return],
    flows: &mut Flows,
    rtol: f64,
) -> Option<LyapunovSpectrum> {
    let displaced = DISPLACED * rtol.cbrt();
    let beside = beside(run, returns, flows, displaced)?;
    let mut frame = Matrix2::new(0.8, -0.6, 0.6, 0.8);
    let mut bends = 0.0;
    let mut segments = Vec::with_capacity(returns.len());
    for (pair, ends) in returns.windows(2).zip(beside.chunks(BESIDE.len())) {
        let [first, second] = [(0, 1), (2, 3)].map(|(i, j)| ends[i] - ends[j]);
        let middle = inside(pair[1].state.as_slice());
        let [bent, also] = [(0, 1), (2, 3)].map(|(i, j)| ends[i] + ends[j] - 2.0 * middle);
        let derivative = Matrix2::from_columns(&[first, second]) / (2.0 * displaced);
        // A third derivative weighs by the square of what a second one does.
        let size = first.norm().max(second.norm());
        bends += (2.0 * bent.norm().max(also.norm()) / size).powi(2);
        let (q, r) = (derivative * frame).qr().unpack();
        frame = q;
        let speed = |at: &Return| run.field.f(&at.state).norm().ln();
        let growth = [r[(0, 0)].abs().ln(), r[(1, 1)].abs().ln()];
        segments.push(GrowthSegment {
            time: pair[1].time - pair[0].time,
            growth: vec![speed(&pair[1]) - speed(&pair[0]), growth[0], growth[1]],
            log_determinant: growth[0] + growth[1],
        });
    }
    if !segments
        .iter()
        .flat_map(|segment| &segment.growth)
        .all(|x| x.is_finite())
    {
        return None;
    }
    let aligned = (ALIGNMENT * segments.len() as f64) as usize;
    // Along the flow it is the speed itself that is counted: there is no bias to be seen in it.
    let gained = segments[aligned..]
        .iter()
        .map(|segment| segment.growth[0])
        .sum();
    let mut spectrum = summary(&segments[aligned..], 0.0, gained);
    let error = bends / segments.iter().map(|segment| segment.time).sum::<f64>();
    for exponent in &mut spectrum.exponents {
        exponent.uncertainty += error;
    }
    Some(spectrum)
}

/// Where runs that start beside each return but the last come back, in (ln psi_1, ln psi_2).
fn beside(
    run: &SweepRun,
    returns: &[Return],
    flows: &mut Flows,
    displaced: f64,
) -> Option<Vec<Vector2<f64>>> {
    let mut ways = Vec::with_capacity(BESIDE.len() * returns.len());
    for pair in returns.windows(2) {
        let longest = (1.0 + LATE) * (pair[1].time - pair[0].time);
        for [first, second] in BESIDE {
            let mut start = pair[0].state.clone();
            start[1] += first * displaced;
            start[2] += second * displaced;
            ways.push(Leg {
                field: Rc::clone(&run.field),
                lane: run.lane,
                start: run.surface.nearest(&start),
                t: (0.0, longest),
            });
        }
    }
    let mut signs: Vec<Zeros> = vec![Zeros::default(); ways.len()];
    for zeros in &mut signs {
        zeros.sign = run.surface.sign_behind();
    }
    let mut ends: Vec<Option<Vector2<f64>>> = vec![None; ways.len()];
    let section = run.surface.section();
    let mut found = Vec::new();
    let mut observer = |k: usize, step: &AnyStep<'_>| {
        let surface = &run.surface;
        if !surface.may_be_passed(step.y0, signs[k].sign, step.reach) {
            return Ok(Control::Continue);
        }
        let series: &dyn StepSeries = step.series().ok_or(Error::NotAnalytic)?;
        found.clear();
        let direction = Some(surface.direction);
        series.crossings(section, direction, &mut signs[k], &mut found);
        Ok(match found.first() {
            Some(passage) => {
                ends[k] = Some(inside(&passage.state));
                Control::Stop
            }
            None => Control::Continue,
        })
    };
    let flown = flows.flow(&ways, &mut observer);
    flown.iter().all(Result::is_ok).then_some(())?;
    ends.into_iter().collect()
}

fn inside(y: &[f64]) -> Vector2<f64> {
    Vector2::new(y[1], y[2])
}
