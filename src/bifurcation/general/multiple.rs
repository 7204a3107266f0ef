//! Branch points of equilibria at which several eigenvalues are 0: which branches begin there, and which of these are followed already.

use super::equilibria::{EquilibriumBranches, PointObserver, near};
use crate::bifurcation::equilibria::generic::Onward;
use crate::bifurcation::equilibria::multiple::MultiplePoint;
use crate::error::Result;
use crate::field::Vector;
use std::ops::ControlFlow::{self, Continue};

/// A branch point at which several eigenvalues are 0.
pub(super) struct Multiple {
    pub point: MultiplePoint,
    /// Where branches that begin there pass a cylinder around it, (state, coordinate), and its radius.
    pub begins: Vec<Vector>,
    radius: f64,
}

impl Multiple {
    /// What is said of it.
    pub fn note(&self) -> String {
        let begins = match self.begins.len() {
            0 => "the other branches that begin here are unknown".to_owned(),
            count => format!("branches that begin here: {count}"),
        };
        format!("{} zero eigenvalues; {begins}", self.point.multiplicity())
    }
}

impl EquilibriumBranches<'_, '_> {
    /// A branch point at which several eigenvalues are 0, with the branches that begin there; cylinders have at first this radius.
    pub(super) fn multiple(&self, point: &MultiplePoint, radius: f64) -> Multiple {
        let branches = self.with_family(|family| point.branches(family, radius));
        let (all, radius) = branches.unwrap_or_default();
        // Mirror images are one.
        let place = |begin: &Vector| {
            let (state, parameter) = apart(begin);
            self.place(&state, parameter)
        };
        let mut begins: Vec<Vector> = Vec::new();
        for begin in all {
            if !begins
                .iter()
                .any(|other| near(&place(other), &place(&begin)))
            {
                begins.push(begin);
            }
        }
        Multiple {
            point: point.clone(),
            begins,
            radius,
        }
    }

    /// One of the branches that begin at a multiple branch point, if none is known that passes there.
    pub fn begin(
        &mut self,
        multiple: usize,
        which: usize,
        seen: PointObserver<'_>,
    ) -> Result<ControlFlow<()>> {
        let Some(begin) = self.multiples[multiple].begins.get(which) else {
            return Ok(Continue(()));
        };
        let (state, parameter) = apart(begin);
        if !self.inside(parameter) || !self.in_box(&state) || self.passes(multiple, which) {
            return Ok(Continue(()));
        }
        let direction = (begin - self.multiples[multiple].point.place()).normalize();
        let onward = Onward {
            state,
            parameter,
            direction,
            across: true,
        };
        self.follow(&onward, seen)
    }

    /// Whether a branch that is known is one of those that begin at a multiple branch point: it passes the cylinder there, and nearest to this one.
    fn passes(&self, multiple: usize, which: usize) -> bool {
        /// Of the radius: where it passes.
        const NEAR: f64 = 0.5;
        let Multiple {
            point,
            begins,
            radius,
        } = &self.multiples[multiple];
        let place = |x: &Vector| {
            let (state, parameter) = apart(x);
            self.place(&state, parameter)
        };
        let begins: Vec<Vector> = begins.iter().map(place).collect();
        let mut steps = self.traces.iter().flat_map(|trace| trace.windows(2));
        steps.any(|step| {
            let [a, b] = [&step[0], &step[1]].map(|x| point.radius(x) - radius);
            if a * b > 0.0 || a == b {
                return false;
            }
            let passed = place(&(&step[0] + (&step[1] - &step[0]) * (a / (a - b))));
            let distance = |begin: &Vector| (begin - &passed).norm();
            let here = distance(&begins[which]);
            here < NEAR * radius && begins.iter().all(|other| here <= distance(other))
        })
    }
}

/// The state and the coordinate.
fn apart(place: &Vector) -> (Vector, f64) {
    let last = place.len() - 1;
    (place.rows(0, last).into_owned(), place[last])
}
