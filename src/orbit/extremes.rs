//! How far an orbit goes: the least and greatest values of its variables and slip rates, on the series along it.

use super::arc::Tracer;
use super::profile::Digits;
use super::settle::axis;
use super::shooting_nodes::ShootingNodes;
use super::solve::OrbitAccuracy;
use super::stiffness::method_for;
use crate::error::Result;
use crate::field::Vector;
use crate::integrate::{AnyField, AnyStep, Choice, Control, MAX_STEPS, Tolerances};
use crate::number::bracketed_root;
use crate::number::polynomial::{Crossing, evaluate, roots};
use crate::series::{REFERENCE_ORDER, Section, Zeros};

/// The extremes over one cycle, and the point where a plane is passed.
#[derive(Debug, Clone)]
pub(super) struct Extremes {
    /// Of every variable.
    pub ranges: Vec<(f64, f64)>,
    /// Where these are: on which arc, and the time since its node.
    pub moments: Vec<[(usize, f64); 2]>,
    pub slip_rate_max: f64,
    /// The time since the first node, and where the first variable, tau, falls through the level asked for then.
    pub passage: Option<(f64, Vector)>,
}

/// The least and greatest value of every variable along an orbit.
///
/// # Errors
/// [`crate::Error::Dimension`] and [`crate::Error::Parameter`] for nodes with another number of variables than the field; those of
/// the flow.
pub fn ranges(
    field: &AnyField<'_>,
    shooting: &ShootingNodes,
    digits: Digits,
) -> Result<Vec<(f64, f64)>> {
    shooting.checked(field.dimension())?;
    let method = method_for(field, shooting);
    let [explicit, implicit] = digits.tolerances();
    let tolerance = match (digits, method) {
        (Digits::All, Choice::Auto | Choice::Taylor) => explicit,
        _ => implicit,
    };
    let tracer = Tracer::for_orbit(method, tolerance, (MAX_STEPS, usize::MAX))?;
    Ok(extremes_by(tracer, field, shooting, None)?.ranges)
}

/// Along the shooting's arcs, each from its own node.
pub(super) fn extremes(
    field: &AnyField<'_>,
    shooting: &ShootingNodes,
    level: Option<f64>,
    accuracy: &OrbitAccuracy,
) -> Result<Extremes> {
    /// Tolerance of the run.
    const FINE: f64 = 1e-14;
    let tracer = match (accuracy.method, level) {
        (Choice::Auto | Choice::Taylor, _) | (_, Some(_)) => {
            let fine = Tolerances::equal(FINE)?.stepping(accuracy.tolerances.max_step);
            Tracer::new(Choice::Taylor, fine, accuracy.max_steps)?
        }
        // The orbit may be that of a stiff system.
        (method, None) => Tracer::new(method, accuracy.tolerances, accuracy.max_steps)?,
    };
    extremes_by(tracer, field, shooting, level)
}

fn extremes_by(
    mut tracer: Tracer,
    field: &AnyField<'_>,
    shooting: &ShootingNodes,
    level: Option<f64>,
) -> Result<Extremes> {
    let dimension = field.dimension();
    let axes: Vec<_> = (0..dimension).map(|i| axis(dimension, i)).collect();
    let plane = Section::Plane {
        normal: axes[0].as_slice(),
        offset: level.unwrap_or_default(),
    };
    let mut all = Extremes {
        ranges: vec![(f64::INFINITY, f64::NEG_INFINITY); dimension],
        moments: vec![[(0, 0.0); 2]; dimension],
        slip_rate_max: f64::NEG_INFINITY,
        passage: None,
    };
    let mut found = Vec::new();
    let mut turns = Vec::new();
    // The sign goes on from arc to arc, so that no passage at a node is lost.
    let mut through = Zeros::default();
    let mut begin = 0.0;
    let arcs = shooting.nodes.iter().zip(&shooting.durations);
    for (k, (x, &duration)) in arcs.enumerate() {
        let mut turns_of = vec![Zeros::default(); dimension];
        all.see(x.as_slice(), (k, 0.0));
        tracer.flow(
            field,
            x,
            duration,
            Some(&mut |step| {
                all.see(step.y1, (k, step.t1));
                found.clear();
                let Some(series) = step.series() else {
                    turns_within(field, step, &mut |turn, at| all.see(turn, (k, at)))?;
                    return Ok(Control::Continue);
                };
                for (normal, zeros) in axes.iter().zip(&mut turns_of) {
                    let section = Section::Extremum {
                        normal: normal.as_slice(),
                    };
                    series.crossings(section, None, zeros, &mut found);
                }
                for turn in &found {
                    let at = (series.begin() + turn.time).hi();
                    all.see(&turn.state, (k, at));
                }
                if level.is_some() && all.passage.is_none() {
                    found.clear();
                    let down = Some(Crossing::Downwards);
                    series.crossings(plane, down, &mut through, &mut found);
                    all.passage = found.drain(..).next().map(|passage| {
                        let time = (series.begin() + passage.time).hi();
                        (begin + time, Vector::from_vec(passage.state))
                    });
                }
                let end = series.length() / series.unit();
                for rates in (0..series.sliding()).map(|i| series.slip_rate(i)) {
                    let mut slope = [0.0; REFERENCE_ORDER];
                    let slope = &mut slope[..series.order() - 1];
                    for (j, c) in slope.iter_mut().enumerate() {
                        *c = (j + 1) as f64 * rates[j + 1];
                    }
                    turns.clear();
                    roots(slope, end, &mut turns);
                    let inside = turns.iter().map(|root| root.at);
                    for s in inside.chain([0.0, end]) {
                        all.slip_rate_max = all.slip_rate_max.max(evaluate(rates, s));
                    }
                }
                Ok(Control::Continue)
            }),
        )?;
        begin += duration;
    }
    // What a phase goes through is known: whole turns.
    if let (Some((place, turn)), Some(period)) = (field.phase(), field.forcing_period()) {
        all.ranges[place] = (0.0, (begin / period).round() * turn);
    }
    Ok(all)
}

/// The states, and their times, within a step that has no series where the rate of a variable is 0.
fn turns_within(
    field: &AnyField<'_>,
    step: &AnyStep<'_>,
    see: &mut dyn FnMut(&[f64], f64),
) -> Result<()> {
    /// Parts of the step: a variable that turns twice in one is missed.
    const PARTS: usize = 4;
    let (begin, end) = step.room();
    let part = (end - begin) / PARTS as f64;
    let time = |k: usize| begin + part * k as f64;
    let rate = |t: f64| field.f(&step.at(t).0);
    let rates: Vec<Vector> = (0..=PARTS).map(|k| rate(time(k))).collect();
    for (k, pair) in rates.windows(2).enumerate() {
        for (i, (before, after)) in pair[0].iter().zip(&pair[1]).enumerate() {
            if before * after < 0.0 {
                let turn = bracketed_root("an extremum", time(k), time(k + 1), |t| {
                    (rate(t)[i], f64::NAN)
                })?;
                see(step.at(turn).0.as_slice(), step.t0 + (turn - begin));
            }
        }
    }
    Ok(())
}

impl Extremes {
    fn see(&mut self, y: &[f64], at: (usize, f64)) {
        let seen = self.ranges.iter_mut().zip(&mut self.moments).zip(y);
        for (((least, most), moments), &y) in seen {
            if y < *least {
                (*least, moments[0]) = (y, at);
            }
            if y > *most {
                (*most, moments[1]) = (y, at);
            }
        }
    }

    /// Least psi.
    pub fn state_min(&self) -> f64 {
        let states = self.ranges.iter().skip(1);
        states
            .map(|range| range.0.exp())
            .fold(f64::INFINITY, f64::min)
    }
}
