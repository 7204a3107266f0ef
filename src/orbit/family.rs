//! Vector fields that depend on two parameters, along which orbits are continued.

use super::slab::Slab;
use crate::field::VectorField;
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
}
