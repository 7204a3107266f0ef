//! Vector fields whose dimension is known when the program runs, and the methods that integrate them.
//!
//! The methods themselves are compiled for each dimension, which is where the time goes. What stands above them, orbits,
//! continuation and Floquet theory, sees [`AnyField`] and [`AnyIntegrator`](super::AnyIntegrator) alone and is compiled once.

use super::Taylor;
use super::static_field::{Flows, Static};
use crate::error::{Error, Result};
use crate::field::{Matrix, SecondDerivative, Vector, VectorField};
use crate::model::{TextField, TextSystem};
use crate::series::Jet3;
use std::borrow::Cow;

/// A vector field of any dimension.
///
/// ```
/// use twinslip::field::Vector;
/// use twinslip::integrate::{AnyField, AnyIntegrator, Choice, MAX_STEPS, Tolerances};
/// use twinslip::friction::Parameters;
/// use twinslip::model::{Loading, TwoInterfaces};
/// # fn main() -> twinslip::Result<()> {
/// let law = Parameters::heslot_1994().spinodal();
/// let two = TwoInterfaces { law, loading: Loading::new(10.0, 0.14)? };
/// let field = AnyField::of::<3>(&two);
/// assert_eq!(field.dimension(), 3);
/// let start = Vector::from_vec(vec![10.0, 0.5_f64.ln(), 0.001_f64.ln()]);
/// let mut method = AnyIntegrator::new(Choice::Taylor, Tolerances::equal(1e-12)?, MAX_STEPS)?;
/// let there = method.flow(&field, (0.0, 1.0), &start, None)?;
/// let back = method.flow(&field, (1.0, 0.0), &there, None)?;
/// assert!((back - start).amax() < 1e-9);
/// # Ok(())
/// # }
/// ```
pub struct AnyField<'a>(pub(super) Box<dyn Flows + 'a>);

/// [`ExactField`](crate::field::ExactField) of any dimension.
pub(crate) struct AnyExact {
    pub f: [Vector; 2],
    pub jacobian: [Matrix; 2],
}

impl std::fmt::Debug for AnyField<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("AnyField")
            .field("dimension", &self.dimension())
            .finish_non_exhaustive()
    }
}

impl<'a> AnyField<'a> {
    /// This field.
    pub fn new<const N: usize>(field: Box<dyn VectorField<N> + 'a>) -> Self {
        AnyField(Box::new(Static::Owned(field)))
    }

    /// A field that stays with its owner.
    pub fn of<const N: usize>(field: &'a dyn VectorField<N>) -> Self {
        AnyField(Box::new(Static::Lent(field)))
    }

    /// A system whose equations were read.
    ///
    /// # Errors
    /// [`Error::Parameter`] where it has more variables than [`TextSystem::LARGEST`].
    pub fn of_text(system: Cow<'a, TextSystem>) -> Result<Self> {
        // The methods are compiled for these numbers of variables; others have room left.
        macro_rules! by_dimension {
            ($($n:literal)*) => {
                match system.variables() {
                    $( ..=$n => Ok(AnyField::new::<$n>(Box::new(TextField::of(system)?))), )*
                    more => {
                        let must = format!("from 1 to {}", TextSystem::LARGEST);
                        Err(Error::parameter("the number of variables", more, must))
                    }
                }
            };
        }
        by_dimension!(1 2 3 4 6 8 32 100)
    }

    /// The number of its variables.
    pub fn dimension(&self) -> usize {
        self.0.dimension()
    }

    /// The variable that is the phase of a periodic forcing, and what a whole turn of it is.
    pub fn phase(&self) -> Option<(usize, f64)> {
        self.0.phase()
    }

    /// The period of the forcing, where there is one.
    pub fn forcing_period(&self) -> Option<f64> {
        let (place, turn) = self.phase()?;
        // The same at all states.
        Some(turn / self.f(&Vector::zeros(self.dimension()))[place])
    }

    /// The state whole turns of the forcing away that is nearest to another.
    pub fn turned(&self, mut x: Vector, to: &Vector) -> Vector {
        if let Some((place, turn)) = self.phase() {
            x[place] -= ((x[place] - to[place]) / turn).round() * turn;
        }
        x
    }

    /// The same state as the one on which the flow from another comes to lie, or near which, after so long: whole turns of the forcing later.
    pub(crate) fn landing(&self, x: &Vector, (from, time): (&Vector, f64)) -> Vector {
        match self.phase() {
            None => x.clone(),
            Some(_) => self.turned(x.clone(), &(from + self.f(from) * time)),
        }
    }

    /// f(y).
    ///
    /// # Panics
    /// As all that follows: where y has another number of components.
    pub fn f(&self, y: &Vector) -> Vector {
        self.0.f(y.as_slice())
    }

    /// J(y) = Df(y).
    pub fn jacobian(&self, y: &Vector) -> Matrix {
        self.0.jacobian(y.as_slice())
    }

    /// Computes f(y) and J(y) in 31 digits if the field supports that, else in double precision.
    pub(crate) fn exact(&self, y: &Vector) -> AnyExact {
        self.0.exact(y.as_slice())
    }

    /// The trace of J(y): the rate at which volumes grow.
    pub fn trace(&self, y: &[f64]) -> f64 {
        self.0.trace(y)
    }

    /// J(y)^-1 f(y): how far Newton's method says that y is from an equilibrium. `None` where it says nothing.
    pub fn newton_step(&self, y: &[f64]) -> Option<Vector> {
        self.0.newton_step(y)
    }

    /// D2f(y)[u, v].
    pub fn second_derivative(&self, y: &Vector, u: &Vector, v: &Vector) -> Vector {
        self.0
            .second_derivative([y.as_slice(), u.as_slice(), v.as_slice()])
    }

    /// The power series in s, to the fifth order, of f along a curve that is given as one. `None` for fields without such a computation.
    pub fn series_along(&self, curve: &[Vector; 6]) -> Option<[Vector; 6]> {
        self.0.series_along(curve)
    }

    /// All second derivatives of f at y, but for such as are zero everywhere.
    pub fn second_derivatives(&self, y: &Vector) -> Vec<SecondDerivative> {
        self.0.second_derivatives(y.as_slice())
    }

    /// The names of the parameters; none where the field can't be differentiated in any.
    pub fn parameter_names(&self) -> &[&'static str] {
        self.0.parameter_names()
    }

    /// df/dp of the parameter at this place among the names.
    ///
    /// # Panics
    /// Where there is none at this place, as the next.
    pub fn parameter_derivative(&self, y: &Vector, place: usize) -> Vector {
        self.0.parameter_derivative(y.as_slice(), place)
    }

    /// dJ/dp of the parameter at this place.
    pub fn parameter_jacobian(&self, y: &Vector, place: usize) -> Matrix {
        self.0.parameter_jacobian(y.as_slice(), place)
    }

    /// The map onto the plane normal . (x - point) = 0, to third order in the variations of the start
    /// ([`Taylor::transport_onto`]).
    ///
    /// # Errors
    /// As there.
    pub fn transport_onto(
        &self,
        taylor: &mut Taylor,
        span: (f64, f64),
        start: &[Jet3],
        (normal, point): (&Vector, &Vector),
    ) -> Result<(Jet3, Vec<Jet3>)> {
        let plane = (normal.as_slice(), point.as_slice());
        self.0.transport_onto(taylor, span, start, plane)
    }
}

/// That points with so many components are of a field with so many variables.
pub(crate) fn of_dimension(components: usize, variables: usize) -> Result<()> {
    if components == variables {
        return Ok(());
    }
    let must = format!("{variables}, as many as the field has variables");
    Err(Error::parameter(
        "the number of components of a point",
        components,
        must,
    ))
}
