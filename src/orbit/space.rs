//! The spaces in which orbits are found: all of (tau, ln psi_1, ln psi_2), and the plane where both interfaces move alike.

use super::arc::{Arc, Tracer};
use super::floquet::{Floquet, floquet, symmetric_floquet};
use super::interface_system::InterfaceSystem;
use super::shooting::Closed;
use super::shooting_nodes::ShootingNodes;
use super::solve::OrbitAccuracy;
use crate::equilibrium::Symmetry;
use crate::error::Result;
use crate::field::Vector;
use crate::integrate::{AnyField, Work};
use std::sync::Arc as Shared;

/// A space in which orbits are found.
pub(super) trait Space {
    /// The vector field.
    fn field(&self) -> &AnyField<'_>;
    /// The end of an arc from a node, and the digits that its tangent loses in the space of all multipliers, with the variables in units of
    /// their sizes.
    fn loss(
        &self,
        tracers: &mut Tracers,
        arc: (&Vector, f64),
        sizes: &Vector,
    ) -> Result<(Vector, f64)> {
        loss_along(self.field(), tracers, arc, sizes)
    }
    /// The multipliers.
    fn floquet(&self, tracers: &mut Tracers, closed: &Closed) -> Result<Floquet> {
        traced_floquet(self.field(), tracers, closed)
    }
    /// Whether both interfaces move alike.
    fn symmetry(&self, shooting: &ShootingNodes) -> Symmetry;
}

/// Where the orbits of a slab are that have a symmetry: all orbits of two interfaces, or the symmetric ones, within all where
/// there are two interfaces.
pub(super) fn space_of(slab: &InterfaceSystem, symmetry: Symmetry) -> Box<dyn Space> {
    let whole = || AnyField::new::<3>(slab.whole());
    match symmetry {
        Symmetry::Asymmetric => Box::new(Whole(whole())),
        Symmetry::Symmetric => Box::new(Plane {
            plane: AnyField::new::<2>(slab.plane()),
            whole: (slab.interfaces == 2).then(whole),
        }),
    }
}

/// The tracers of one accuracy.
pub(super) struct Tracers {
    pub here: Tracer,
    /// In the whole space, for symmetric orbits.
    whole: Tracer,
}

impl Tracers {
    pub fn new(accuracy: &OrbitAccuracy) -> Result<Self> {
        let OrbitAccuracy {
            method,
            tolerances,
            max_steps,
            all_steps,
            ..
        } = *accuracy;
        let tracer = || Ok(Tracer::new(method, tolerances, max_steps)?.within(all_steps));
        Ok(Tracers {
            here: tracer()?,
            whole: tracer()?,
        })
    }

    pub fn work(&self) -> Work {
        let mut work = self.here.work();
        work += self.whole.work();
        work
    }
}

/// The whole space of two interfaces.
pub(super) struct Whole<'a>(pub AnyField<'a>);

impl Space for Whole<'_> {
    fn field(&self) -> &AnyField<'_> {
        &self.0
    }

    fn symmetry(&self, shooting: &ShootingNodes) -> Symmetry {
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

/// The space of any field, in which there are no parts that might move alike.
pub(super) struct Alone<'f, 'a> {
    pub field: &'f AnyField<'a>,
    /// What is said of all its orbits.
    pub symmetry: Symmetry,
}

impl Space for Alone<'_, '_> {
    fn field(&self) -> &AnyField<'_> {
        self.field
    }

    fn symmetry(&self, _: &ShootingNodes) -> Symmetry {
        self.symmetry
    }
}

fn loss_along(
    field: &AnyField<'_>,
    tracers: &mut Tracers,
    (x, duration): (&Vector, f64),
    sizes: &Vector,
) -> Result<(Vector, f64)> {
    let arc = tracers.here.arc(field, x, duration, &[])?;
    // In the plane the trace alone says what the multiplier is.
    let loss = if sizes.len() == 2 {
        0.0
    } else {
        arc.loss_in(sizes)
    };
    Ok((arc.end, loss))
}

/// The multipliers, with the integrals of the trace by quadrature where the method does not have them with the tangents.
fn traced_floquet(field: &AnyField<'_>, tracers: &mut Tracers, closed: &Closed) -> Result<Floquet> {
    let has_trace = |arc: &Arc| arc.log_determinant.is_some();
    if closed.arcs().iter().all(has_trace) {
        return Ok(floquet(closed, field));
    }
    let mut traced = closed.clone();
    let arcs = Shared::make_mut(&mut traced.linear.arcs).iter_mut();
    let along = closed.shooting.nodes.iter().zip(&closed.shooting.durations);
    for (arc, (x, &duration)) in arcs.zip(along) {
        let (volume, off) = tracers.here.trace_along(field, x, duration)?;
        (arc.log_determinant, arc.volume_error) = (Some(volume), off);
    }
    Ok(floquet(&traced, field))
}

/// tau and ln psi of both interfaces, which move alike.
fn embedded(x: &Vector) -> Vector {
    Vector::from_column_slice(&[x[0], x[1], x[1]])
}

/// The plane of a single interface, or of two that move alike, with the whole space around it.
pub(super) struct Plane<'a> {
    pub plane: AnyField<'a>,
    pub whole: Option<AnyField<'a>>,
}

impl Plane<'_> {
    fn across(&self, tracers: &mut Tracers, x: &Vector, duration: f64) -> Result<Option<Arc>> {
        let embedded = embedded(x);
        self.whole
            .as_ref()
            .map(|whole| tracers.whole.arc(whole, &embedded, duration, &[]))
            .transpose()
    }
}

impl Space for Plane<'_> {
    fn field(&self) -> &AnyField<'_> {
        &self.plane
    }

    fn loss(
        &self,
        tracers: &mut Tracers,
        along: (&Vector, f64),
        sizes: &Vector,
    ) -> Result<(Vector, f64)> {
        let (x, duration) = along;
        let Some(arc) = self.across(tracers, x, duration)? else {
            return loss_along(&self.plane, tracers, along, sizes);
        };
        Ok((
            arc.end.rows(0, 2).into_owned(),
            arc.loss_in(&embedded(sizes)),
        ))
    }

    fn floquet(&self, tracers: &mut Tracers, closed: &Closed) -> Result<Floquet> {
        if self.whole.is_none() {
            return traced_floquet(&self.plane, tracers, closed);
        }
        let shooting = &closed.shooting;
        let mut arcs = Vec::with_capacity(shooting.nodes.len());
        for (x, &duration) in shooting.nodes.iter().zip(&shooting.durations) {
            arcs.extend(self.across(tracers, x, duration)?);
        }
        Ok(symmetric_floquet(closed, &self.plane, &arcs))
    }

    fn symmetry(&self, _: &ShootingNodes) -> Symmetry {
        Symmetry::Symmetric
    }
}
