//! Hopf points to which curves of orbits shrink: degenerate ones, of folds; zero-Hopf and double Hopf points, of torus bifurcations; and of orbits at which a
//! function vanishes those at which it does too.
//!
//! Beside one the condition of a fold is a small power of the orbit's size, and soon rounding.

use super::half_curve::CurvesOfKind;
use crate::bifurcation::Label;
use crate::bifurcation::equilibria::generic_curve::EquilibriumBifurcation;
use crate::bifurcation::general::curves::equilibrium_curves;
use crate::bifurcation::general::{
    GeneralCurve, GeneralEvent, GeneralFollowing, GeneralPoint, GeneralSolution, SAME,
};
use crate::field::Vector;
use crate::orbit::{ContinuationPoint, TestFunction};
use std::ops::ControlFlow::Continue;
use std::sync::OnceLock;

/// A curve of orbits this much smaller than the largest shrinks to an equilibrium.
const SHRUNK: f64 = 0.05;

/// The points in the ranges of a curve, as orbits that have shrunk to a point; computed at first use.
#[derive(Debug, Default)]
pub(super) struct DegenerateHopfPoints(OnceLock<Vec<GeneralPoint>>);

impl CurvesOfKind<'_, '_> {
    /// The Hopf point to which a curve shrinks, by an orbit among all states and how far each variable goes on the largest one.
    pub fn shrinks_to(
        &self,
        number: usize,
        orbit: &ContinuationPoint,
        largest: &Vector,
    ) -> Option<GeneralPoint> {
        /// Tolerances in the ranges, in the period, and in the size of the orbit.
        const NEAR: f64 = 0.05;
        const BESIDE: f64 = 2.0;
        /// What a variable that hardly moves may be off, as a part of its size along the largest orbit.
        const STILL: f64 = 1e-3;
        let ContinuationPoint { shooting, at } = orbit;
        let extents = shooting.extents();
        let is_small = || {
            extents
                .iter()
                .zip(largest)
                .all(|(x, most)| *x < SHRUNK * most)
        };
        let labels: &[Label] = match self.test_function {
            Some(TestFunction::Fold) => &[Label::Gh],
            Some(TestFunction::Torus) => &[Label::Zh, Label::Hh],
            None => &[Label::Uf],
            Some(_) => return None,
        };
        if !is_small() {
            return None;
        }
        let ranges = self.curve.ranges;
        let near = |point: &&GeneralPoint| {
            let GeneralSolution::Orbit { shooting: rest, .. } = &point.solution else {
                return false;
            };
            let at_rest = &rest.nodes[0];
            let rounding = at_rest.map(|x| SAME * (1.0 + x.abs()));
            let size = extents.sup(&(largest * STILL)).sup(&rounding);
            let off = |x: &Vector| (x - at_rest).component_div(&size).amax();
            let part = |i: usize| (point.at[i] - at[i]) / (ranges[i].1 - ranges[i].0);
            let of_period = (shooting.period() / rest.period()).ln();
            shooting.nodes.iter().all(|x| off(x) < BESIDE)
                && [part(0), part(1), of_period]
                    .iter()
                    .all(|off| off.abs() < NEAR)
        };
        let all = self.degenerate.0.get_or_init(|| found(self.curve, labels));
        let point = all.iter().find(near)?.clone();
        Some(GeneralPoint {
            number,
            symmetry: self.chart.symmetry(),
            label: point.label.map(|label| match label {
                Label::Uf => Label::Hb,
                other => other,
            }),
            note: None,
            ..point
        })
    }
}

/// The points of curves of Hopf points that have one of these labels.
fn found(curve: &GeneralCurve<'_>, labels: &[Label]) -> Vec<GeneralPoint> {
    let mut found = Vec::new();
    let mut look = |event| {
        if let GeneralEvent::Row(point) = event
            && point.label.is_some_and(|label| labels.contains(&label))
            && let GeneralSolution::Equilibrium { state, .. } = &point.solution
            && let Some(period) = point.period
        {
            found.push(point.shrunk(state, period));
        }
        Continue(())
    };
    let curve = GeneralCurve {
        watch: match labels {
            [Label::Uf] => curve.watch.iter().take(1).cloned().collect(),
            _ => Vec::new(),
        },
        begin: None,
        following: GeneralFollowing {
            skip: Vec::new(),
            ..curve.following.clone()
        },
        ..curve.clone()
    };
    let all = equilibrium_curves(&curve, EquilibriumBifurcation::Hopf, &mut look);
    all.map_or_else(|_| Vec::new(), |()| found)
}
