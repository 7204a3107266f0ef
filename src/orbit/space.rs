//! The spaces in which orbits are found: all of (tau, ln psi_1, ln psi_2), and the plane where both interfaces move alike.

use super::arc::{Arc, Tracer};
use super::floquet::{Floquet, floquet, symmetric_floquet};
use super::shooting::Closed;
use super::shooting_nodes::ShootingNodes;
use super::solve::OrbitAccuracy;
use crate::equilibrium::Symmetry;
use crate::error::Result;
use crate::field::{State, VectorField};
use crate::integrate::Work;

/// A dimension in which orbits are found.
pub(super) trait Space<const N: usize> {
    /// The vector field.
    fn field(&self) -> &dyn VectorField<N>;
    /// A node and its arc in the space of all multipliers: the arc's end and the digits that it loses.
    fn loss(
        &self,
        tracers: &mut Tracers<N>,
        x: &State<N>,
        duration: f64,
    ) -> Result<(State<N>, f64)>;
    /// The multipliers.
    fn floquet(&self, tracers: &mut Tracers<N>, closed: &Closed<N>) -> Result<Floquet>;
    /// Whether both interfaces move alike.
    fn symmetry(&self, shooting: &ShootingNodes<N>) -> Symmetry;
}

/// The tracers of one accuracy.
pub(super) struct Tracers<const N: usize> {
    pub here: Tracer<N>,
    /// In the whole space, for symmetric orbits.
    whole: Tracer<3>,
}

impl<const N: usize> Tracers<N> {
    pub fn new(accuracy: &OrbitAccuracy) -> Result<Self> {
        let OrbitAccuracy {
            method,
            tolerances,
            max_steps,
            ..
        } = *accuracy;
        Ok(Tracers {
            here: Tracer::new(method, tolerances, max_steps)?,
            whole: Tracer::new(method, tolerances, max_steps)?,
        })
    }

    pub fn work(&self) -> Work {
        let mut work = self.here.work();
        work += self.whole.work();
        work
    }
}

/// The whole space of two interfaces.
pub(super) struct Whole<'a>(pub &'a dyn VectorField<3>);

impl Space<3> for Whole<'_> {
    fn field(&self) -> &dyn VectorField<3> {
        self.0
    }

    fn loss(
        &self,
        tracers: &mut Tracers<3>,
        x: &State<3>,
        duration: f64,
    ) -> Result<(State<3>, f64)> {
        let arc = tracers.here.arc(self.0, x, duration, &[])?;
        Ok((arc.end, arc.loss()))
    }

    fn floquet(&self, _: &mut Tracers<3>, closed: &Closed<3>) -> Result<Floquet> {
        Ok(floquet(closed, &|x| self.0.f(x)))
    }

    fn symmetry(&self, shooting: &ShootingNodes<3>) -> Symmetry {
        /// Interfaces that differ by less move alike: they would by rounding.
        const ALIKE: f64 = 1e-9;
        let apart = shooting.nodes.iter().map(|x| (x[1] - x[2]).abs());
        if apart.fold(0.0, f64::max) < ALIKE {
            Symmetry::Symmetric
        } else {
            Symmetry::Asymmetric
        }
    }
}

/// The plane of a single interface, or of two that move alike, with the whole space around it.
pub(super) struct Plane<'a> {
    pub plane: &'a dyn VectorField<2>,
    pub whole: Option<&'a dyn VectorField<3>>,
}

impl Plane<'_> {
    fn across(
        &self,
        tracers: &mut Tracers<2>,
        x: &State<2>,
        duration: f64,
    ) -> Result<Option<Arc<3>>> {
        let embedded = State::<3>::new(x[0], x[1], x[1]);
        self.whole
            .map(|whole| tracers.whole.arc(whole, &embedded, duration, &[]))
            .transpose()
    }
}

impl Space<2> for Plane<'_> {
    fn field(&self) -> &dyn VectorField<2> {
        self.plane
    }

    fn loss(
        &self,
        tracers: &mut Tracers<2>,
        x: &State<2>,
        duration: f64,
    ) -> Result<(State<2>, f64)> {
        Ok(match self.across(tracers, x, duration)? {
            Some(arc) => (State::<2>::new(arc.end[0], arc.end[1]), arc.loss()),
            None => {
                let arc = tracers.here.arc(self.plane, x, duration, &[])?;
                (arc.end, arc.loss())
            }
        })
    }

    fn floquet(&self, tracers: &mut Tracers<2>, closed: &Closed<2>) -> Result<Floquet> {
        let f = |x: &State<2>| self.plane.f(x);
        if self.whole.is_none() {
            return Ok(floquet(closed, &f));
        }
        let shooting = &closed.shooting;
        let mut arcs = Vec::with_capacity(shooting.nodes.len());
        for (x, &duration) in shooting.nodes.iter().zip(&shooting.durations) {
            arcs.extend(self.across(tracers, x, duration)?);
        }
        Ok(symmetric_floquet(closed, &f, &arcs))
    }

    fn symmetry(&self, _: &ShootingNodes<2>) -> Symmetry {
        Symmetry::Symmetric
    }
}
