//! Families of vector fields over the plane of two of their parameters, in which orbits are continued.

use super::continuation_point::ContinuationPoint;
use super::interface_system::InterfaceSystem;
use super::user_function::Solution;
use crate::equilibrium::Symmetry;
use crate::error::{Error, Result};
use crate::field::{Matrix, State, Vector, place, state, vector};
use crate::integrate::AnyField;
use crate::model::{Loading, Parameter, Smooth, from_difference_chart, to_difference_chart};
use crate::series::Equations;

/// Vector fields over a plane of two parameters.
///
/// Continuation moves in coordinates of the plane that suit it: logarithms where decades are spanned.
pub trait ParametrisedField: Sync {
    /// The number of variables.
    fn dimension(&self) -> usize;

    /// The places, among all of the field's parameters, of the two that span the plane.
    fn plane(&self) -> [usize; 2];

    /// The field at these coordinates.
    fn field(&self, at: [f64; 2]) -> AnyField<'_>;

    /// The parameters themselves.
    fn parameters(&self, at: [f64; 2]) -> [f64; 2];

    /// Of each parameter, its derivative in its coordinate.
    fn scale(&self, at: [f64; 2]) -> [f64; 2];

    /// The normal of the plane in which a node at x may move where the flow is `flow`: the flow itself, unless some variables
    /// had better stay out of it.
    fn normal(&self, _x: &Vector, flow: Vector) -> Vector {
        flow
    }

    /// Whether nothing is known of the equations beforehand. Then the planes of nodes also regard how far each variable moves along the orbit: those
    /// across the flow cut an orbit that is thin in one variable at a shallow angle. And a stiff orbit takes an implicit method.
    fn is_any_system(&self) -> bool {
        false
    }

    /// What takes a displacement of a point x, where the flow is `flow`, to its part across the flow, in the variables in which
    /// displacements are measured. Under a forcing it is a displacement at one phase, which it leaves as it is.
    fn across(&self, _x: &Vector, flow: &Vector) -> Matrix {
        projection(flow)
    }

    /// The units of the variables, where lengths are told in others.
    fn units(&self) -> Option<&[f64]> {
        None
    }

    /// The value of the user's function of this number for a solution at these coordinates, in no unit that is known. NaN where it is undefined, or
    /// there is none.
    fn user_function(&self, _which: usize, _of: Solution<'_>, _at: [f64; 2]) -> f64 {
        f64::NAN
    }
}

/// As [`ParametrisedField::across`], with the displacement measured in other units than the variables, of which these are the sizes; from one plane of a phase
/// to the next there is nothing to leave out.
pub fn across_in_units(units: &[f64], flow: &Vector, is_forced: bool) -> Matrix {
    let outward = Matrix::from_diagonal(&Vector::from_column_slice(units));
    match is_forced {
        true => outward,
        false => projection(&(&outward * flow)) * outward,
    }
}

/// The projection across a direction.
fn projection(along: &Vector) -> Matrix {
    let count = along.len();
    Matrix::identity(count, count) - along * along.transpose() / along.norm_squared()
}

/// The places of two parameters among all.
pub(super) fn places(all: &[&'static str], names: [&str; 2]) -> Result<[usize; 2]> {
    let [first, second] = names.map(|name| place(all, name));
    let plane = [first?, second?];
    if plane[0] == plane[1] {
        return Err(Error::parameter(
            "the plane of parameters",
            names[0],
            "two different parameters",
        ));
    }
    Ok(plane)
}

/// Any system over two of its parameters as they are, the others being held.
#[derive(Debug, Clone, Copy)]
pub struct OverParameters<S, const N: usize, const P: usize> {
    field: Smooth<S, N, P>,
    plane: [usize; 2],
}

impl<S: Equations<N, P>, const N: usize, const P: usize> OverParameters<S, N, P> {
    /// Over the parameters of these names; the others have the field's values.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a name that is not among [`Equations::PARAMETERS`], or if both are the same.
    pub fn new(field: Smooth<S, N, P>, names: [&str; 2]) -> Result<Self> {
        let plane = places(&S::PARAMETERS, names)?;
        Ok(OverParameters { field, plane })
    }

    /// The field at these values of the two.
    pub fn at(&self, at: [f64; 2]) -> Smooth<S, N, P> {
        let mut field = self.field;
        for (place, value) in self.plane.into_iter().zip(at) {
            field.parameters[place] = value;
        }
        field
    }
}

impl<S: Equations<N, 2>, const N: usize> OverParameters<S, N, 2> {
    /// A system of two parameters over both.
    pub fn both(equations: S) -> Self {
        OverParameters {
            field: Smooth {
                equations,
                parameters: [0.0; 2],
            },
            plane: [0, 1],
        }
    }
}

impl<S: Equations<N, P>, const N: usize, const P: usize> ParametrisedField
    for OverParameters<S, N, P>
{
    fn dimension(&self) -> usize {
        N
    }

    fn plane(&self) -> [usize; 2] {
        self.plane
    }

    fn field(&self, at: [f64; 2]) -> AnyField<'_> {
        AnyField::new::<N>(Box::new(self.at(at)))
    }

    fn parameters(&self, at: [f64; 2]) -> [f64; 2] {
        at
    }

    fn scale(&self, _: [f64; 2]) -> [f64; 2] {
        [1.0; 2]
    }
}

/// Orbits of a slab over (ln V_H, ln K).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OverLoadings {
    /// The slab; its own V_H and K do not matter.
    pub slab: InterfaceSystem,
    /// Whether the interfaces move alike. Symmetric orbits are in (tau, ln psi), as those of a single interface; all others in (tau,
    /// ln psi_1, ln psi_2).
    pub symmetry: Symmetry,
}

impl OverLoadings {
    /// The orbits of this symmetry.
    pub fn new(slab: InterfaceSystem, symmetry: Symmetry) -> Self {
        OverLoadings { slab, symmetry }
    }

    /// The slab there.
    pub fn slab(&self, at: [f64; 2]) -> InterfaceSystem {
        InterfaceSystem {
            loading: Loading {
                driving: at[0].exp(),
                stiffness: at[1].exp(),
            },
            ..self.slab
        }
    }

    fn places(&self) -> [usize; 2] {
        Parameter::PLANE
    }
}

/// Orbits of a slab over the logarithms of any two of its parameters, constants of its law among them; the others are held.
///
/// Derivatives in V_H and K are compiled, as those of [`OverLoadings`]; those in constants of the law run in loops, several times as
/// long.
#[derive(Debug, Clone, Copy)]
pub struct OverLogarithms {
    slab: InterfaceSystem,
    symmetry: Symmetry,
    plane: [usize; 2],
}

impl OverLogarithms {
    /// Over the parameters of these names among [`InterfaceSystem::parameter_names`], the orbits of this symmetry.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a name that is not among them, or if both are the same.
    pub fn new(slab: InterfaceSystem, symmetry: Symmetry, names: [&str; 2]) -> Result<Self> {
        let plane = places(slab.parameter_names(), names)?;
        Ok(OverLogarithms {
            slab,
            symmetry,
            plane,
        })
    }

    /// The slab there.
    pub fn slab(&self, at: [f64; 2]) -> InterfaceSystem {
        let [first, second] = self.plane;
        let slab = self.slab.with_parameter(first, at[0].exp());
        slab.with_parameter(second, at[1].exp())
    }

    fn places(&self) -> [usize; 2] {
        self.plane
    }
}

/// A slab over the logarithms of two parameters, in all its dimensions or in the plane of interfaces that move alike.
macro_rules! over_logarithms {
    ($($family:ident)*) => { $(
        impl ParametrisedField for $family {
            fn dimension(&self) -> usize {
                match self.symmetry {
                    Symmetry::Symmetric => 2,
                    Symmetry::Asymmetric => 3,
                }
            }

            fn plane(&self) -> [usize; 2] {
                self.places()
            }

            fn field(&self, at: [f64; 2]) -> AnyField<'_> {
                let slab = self.slab(at);
                match self.symmetry {
                    Symmetry::Symmetric => AnyField::new::<2>(slab.plane()),
                    Symmetry::Asymmetric => AnyField::new::<3>(slab.whole()),
                }
            }

            fn parameters(&self, at: [f64; 2]) -> [f64; 2] {
                at.map(f64::exp)
            }

            fn scale(&self, at: [f64; 2]) -> [f64; 2] {
                at.map(f64::exp)
            }
        }
    )* };
}
over_logarithms! { OverLoadings OverLogarithms }

/// Two interfaces over (ln V_H, ln K), in the variables that do not lose their difference.
///
/// Slower than [`OverLoadings`], for orbits along which the interfaces come near each other.
#[derive(Debug, Clone, Copy)]
pub struct OverDifferenceChart(pub OverLoadings);

impl ParametrisedField for OverDifferenceChart {
    fn dimension(&self) -> usize {
        3
    }

    fn plane(&self) -> [usize; 2] {
        Parameter::PLANE
    }

    fn field(&self, at: [f64; 2]) -> AnyField<'_> {
        AnyField::new::<3>(self.0.slab(at).in_difference_chart())
    }

    fn parameters(&self, at: [f64; 2]) -> [f64; 2] {
        at.map(f64::exp)
    }

    fn scale(&self, at: [f64; 2]) -> [f64; 2] {
        at.map(f64::exp)
    }

    /// Without ln D where D is small: tau and psi_2 know nothing of it there, and a shift of ln D stays as it is all along the
    /// orbit. A plane that leans towards ln D would mix that shift with what grows by e^(0.5 / K) along the canard. Where the
    /// interfaces part, nodes go with them.
    fn normal(&self, x: &Vector, mut flow: Vector) -> Vector {
        let ratio = (x[2] - x[1]).exp();
        let squared = ratio * ratio;
        flow[2] *= if squared.is_finite() {
            squared / (1.0 + squared)
        } else {
            1.0
        };
        flow
    }

    /// Measured in (tau, ln psi_1, ln psi_2), as on orbits whose interfaces differ by more.
    fn across(&self, x: &Vector, flow: &Vector) -> Matrix {
        // psi_1 = psi_2 + D
        let part = 1.0 / (1.0 + (x[1] - x[2]).exp());
        let rows = [1.0, 0.0, 0.0, 0.0, 1.0 - part, part, 0.0, 1.0, 0.0];
        let to_states = Matrix::from_row_slice(3, 3, &rows);
        projection(&(&to_states * flow)) * to_states
    }
}

impl OverDifferenceChart {
    /// An orbit in these variables; `None` where the interfaces do not differ everywhere, or not always in the same sense.
    pub(crate) fn to_chart(site: &ContinuationPoint) -> Option<ContinuationPoint> {
        let nodes = |each: &dyn Fn(&State<3>) -> Option<State<3>>| {
            let nodes = site.shooting.nodes.iter();
            let each = |x: &Vector| Some(vector(&each(&state(x.as_slice()))?));
            nodes.map(each).collect::<Option<Vec<_>>>()
        };
        let exchanged = |x: &State<3>| to_difference_chart(&State::<3>::new(x[0], x[2], x[1]));
        let nodes = nodes(&to_difference_chart).or_else(|| nodes(&exchanged))?;
        Some(site.with_nodes(nodes))
    }

    /// The orbit in (tau, ln psi_1, ln psi_2).
    pub(crate) fn from_chart(site: &ContinuationPoint) -> ContinuationPoint {
        let node = |x: &Vector| vector(&from_difference_chart(&state(x.as_slice())));
        site.with_nodes(site.shooting.nodes.iter().map(node).collect())
    }
}
