//! Vector fields that depend on two parameters, along which orbits are continued.

use super::arc::Tracer;
use super::polygon::Polygon;
use super::slab::Slab;
use crate::error::Result;
use crate::field::{State, VectorField};
use crate::model::Loading;

/// Vector fields over a plane of two parameters.
///
/// Continuation moves in coordinates of the plane that suit it: logarithms where decades are spanned.
pub trait Family<const N: usize>: Sync {
    /// The field at these coordinates, whose Taylor tangents have the derivatives in both parameters.
    fn field(&self, at: [f64; 2]) -> Box<dyn VectorField<N> + '_>;

    /// The parameters themselves.
    fn parameters(&self, at: [f64; 2]) -> [f64; 2];

    /// Of each parameter, its derivative in its coordinate.
    fn scale(&self, at: [f64; 2]) -> [f64; 2];

    /// The integral of the trace of the whole system's Jacobian along an orbit, where the family is that of a symmetric
    /// subspace: less that of the subspace's own it is the logarithm of the multiplier across. `None` where the family is all
    /// there is.
    ///
    /// # Errors
    /// Those of the flow.
    fn whole_volume(
        &self,
        at: [f64; 2],
        polygon: &Polygon<N>,
        tolerance: f64,
    ) -> Result<Option<f64>> {
        let _ = (at, polygon, tolerance);
        Ok(None)
    }
}

/// A slab over (ln V_H, ln K).
#[derive(Debug, Clone, Copy)]
pub struct OverLoadings(pub Slab);

impl OverLoadings {
    /// The slab there.
    pub fn slab(&self, at: [f64; 2]) -> Slab {
        Slab {
            loading: Loading {
                driving: at[0].exp(),
                stiffness: at[1].exp(),
            },
            ..self.0
        }
    }
}

impl Family<3> for OverLoadings {
    fn field(&self, at: [f64; 2]) -> Box<dyn VectorField<3> + '_> {
        self.slab(at).whole()
    }

    fn parameters(&self, at: [f64; 2]) -> [f64; 2] {
        at.map(f64::exp)
    }

    fn scale(&self, at: [f64; 2]) -> [f64; 2] {
        at.map(f64::exp)
    }
}

impl Family<2> for OverLoadings {
    fn field(&self, at: [f64; 2]) -> Box<dyn VectorField<2> + '_> {
        self.slab(at).plane()
    }

    fn parameters(&self, at: [f64; 2]) -> [f64; 2] {
        at.map(f64::exp)
    }

    fn scale(&self, at: [f64; 2]) -> [f64; 2] {
        at.map(f64::exp)
    }

    fn whole_volume(
        &self,
        at: [f64; 2],
        polygon: &Polygon<2>,
        tolerance: f64,
    ) -> Result<Option<f64>> {
        if self.0.interfaces == 1 {
            return Ok(None);
        }
        let whole = self.slab(at).whole();
        let mut tracer = Tracer::<3>::taylor(tolerance)?;
        let mut sum = 0.0;
        for (x, &duration) in polygon.nodes.iter().zip(&polygon.durations) {
            let embedded = State::<3>::new(x[0], x[1], x[1]);
            sum += tracer.arc(&*whole, &embedded, duration, false)?.volume();
        }
        Ok(Some(sum))
    }
}
