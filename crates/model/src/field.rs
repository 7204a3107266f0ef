//! What a dynamical system is: dy/dt = f(y), with the derivatives that implicit methods, tangents and normal forms need.
//!
//! The trait is object-safe on purpose: static and dynamic dispatch take the same time on these systems, and an integrator
//! then is compiled once per dimension and not once per law.

use crate::error::{Error, Result};
use crate::series::{Jet3, Solution, Tangent, TaylorMap};
use nalgebra::{DMatrix, DVector, SMatrix, SVector};

/// A point of the phase space.
pub type State<const N: usize> = SVector<f64, N>;

/// The matrix of first derivatives, `J[i][j] = d f_i / d y_j`; also a tangent flow, d y_i(t) / d y_j(0).
pub type Jacobian<const N: usize> = SMatrix<f64, N, N>;

/// A point, or a displacement, of a phase space whose dimension is known when the program runs.
pub type Vector = DVector<f64>;

/// The same of a matrix of derivatives.
pub type Matrix = DMatrix<f64>;

/// A state whose dimension the compiler knows, as one whose dimension it does not.
pub fn vector<const N: usize>(y: &State<N>) -> Vector {
    Vector::from_column_slice(y.as_slice())
}

/// A state whose dimension the compiler does not know, as one whose dimension it does; components that are not given are 0.
///
/// # Panics
/// Where there are more than N components.
#[inline]
pub fn state<const N: usize>(y: &[f64]) -> State<N> {
    if y.len() == N {
        return State::from_column_slice(y);
    }
    let mut state = State::<N>::zeros();
    state.as_mut_slice()[..y.len()].copy_from_slice(y);
    state
}

/// A matrix whose dimension the compiler does not know, row by row, as one whose dimension it does; rows and columns that are not given are 0.
///
/// # Panics
/// Where there are more than N rows.
#[inline]
pub fn jacobian_of_rows<const N: usize>(variables: usize, rows: &[f64]) -> Jacobian<N> {
    if variables == N {
        return Jacobian::from_row_slice(rows);
    }
    let mut jacobian = Jacobian::<N>::zeros();
    for (i, row) in rows.chunks_exact(variables).enumerate() {
        for (j, &entry) in row.iter().enumerate() {
            jacobian[(i, j)] = entry;
        }
    }
    jacobian
}

/// An autonomous system of N ordinary differential equations.
///
/// ```
/// use twinslip::field::{Jacobian, State, VectorField};
/// struct Decay;
/// impl VectorField<1> for Decay {
///     fn f(&self, y: &State<1>) -> State<1> { -y }
///     fn jacobian(&self, _: &State<1>) -> Jacobian<1> { Jacobian::<1>::new(-1.0) }
///     fn second_derivative(&self, _: &State<1>, _: &State<1>, _: &State<1>) -> State<1> { State::zeros() }
/// }
/// assert_eq!(Decay.f(&State::<1>::new(2.0))[0], -2.0);
/// ```
pub trait VectorField<const N: usize>: Send + Sync {
    /// f(y). May be non-finite where y is far outside the domain: integrators then reject the trial step.
    fn f(&self, y: &State<N>) -> State<N>;

    /// J(y) = Df(y).
    fn jacobian(&self, y: &State<N>) -> Jacobian<N>;

    /// How many of the N components are variables: the first ones. Those after them are 0 and stay so, and nothing depends on them. Where the
    /// number is known when the program runs, N is the next larger one of those that the methods are compiled for.
    fn dimension(&self) -> usize {
        N
    }

    /// D2f(y)[u, v], the second derivative applied to two directions; symmetric in u and v.
    fn second_derivative(&self, y: &State<N>, u: &State<N>, v: &State<N>) -> State<N>;

    /// The power series in s, to the fifth order, of f along a curve that is given as one. `None` for fields without such a computation.
    fn series_along(&self, _curve: &[State<N>; 6]) -> Option<[State<N>; 6]> {
        None
    }

    /// All second derivatives of f at y, but for such as are zero everywhere. Fields that know which variables each component depends on make them
    /// from few evaluations.
    fn second_derivatives(&self, y: &State<N>) -> Vec<SecondDerivative> {
        let unit = |i: usize| State::from_fn(|k, _| f64::from(u8::from(i == k)));
        let mut all = Vec::new();
        for i in 0..self.dimension() {
            for j in i..self.dimension() {
                let along = self.second_derivative(y, &unit(i), &unit(j));
                all.extend((0..self.dimension()).map(|of| SecondDerivative {
                    of,
                    by: [i, j],
                    value: along[of],
                }));
            }
        }
        all
    }

    /// Computes f(y) and J(y) in 31 digits, which avoids cancellation in double precision. `None` for fields without such a computation.
    fn exact(&self, _y: &State<N>) -> Option<ExactField<N>> {
        None
    }

    /// The law by whose name every solution, forwards in time, is known to exist for all time; `None` where that is not known.
    /// What leaves the range of doubles is then no finite-time singularity.
    fn lasting(&self) -> Option<&'static str> {
        None
    }

    /// Whether implicit methods go on through spikes that last for less than the spacing of the doubles around their time. Runs of interfaces end there:
    /// CVODES can't be held to the others behind one, as it keeps time in a double and has been seen to leave a spike anywhere.
    fn has_spikes(&self) -> bool {
        true
    }

    /// For every variable whether it is a factor of its own rate: solutions keep its sign, and what a step may err in it is counted relative
    /// to it alone.
    fn own_factors(&self) -> [bool; N] {
        [false; N]
    }

    /// Whether the last variable is time, whose rate is 1: it is known but for rounding, and no step is judged by it.
    fn last_is_time(&self) -> bool {
        false
    }

    /// The variable that is the phase of a periodic forcing, and what a whole turn of it is: the field is the same after that. `None` where there is none.
    fn phase(&self) -> Option<(usize, f64)> {
        None
    }

    /// A state at the end of a step in which the double next to the time grows by h, with the time there if that is a variable: the sum of what a
    /// method adds up in a step is rounded, and over a million steps time would be late by more than the tolerance.
    fn timed(&self, mut end: State<N>, begin: &State<N>, h: f64) -> State<N> {
        if self.last_is_time() {
            let last = self.dimension() - 1;
            end[last] = begin[last] + h;
        }
        end
    }

    /// What a step may err in every variable beside its relative error: `atol`, or next to nothing where it is a factor of its own rate; anything
    /// where it is time.
    fn absolute_tolerances(&self, atol: f64) -> State<N> {
        let own = |factor| if factor { f64::MIN_POSITIVE } else { atol };
        let mut all = State::from(self.own_factors().map(own));
        if self.last_is_time() {
            all[self.dimension() - 1] = f64::INFINITY;
        }
        all
    }

    /// Whether J may hold NaN or infinite entries where f is continuous, as that of formulas with sqrt(max(0, x)) does: steps are then made with
    /// [`with_differences`]. Of other fields these are a mistake, and an error.
    fn may_lack_slopes(&self) -> bool {
        false
    }

    /// The field as one of those that differ by parameters, where it is.
    fn parametrised(&self) -> Option<&dyn Parametrised<N>> {
        None
    }

    /// The field in power series, where it can be written so: what a Taylor integrator steps with.
    fn analytic(&self) -> Option<&dyn Analytic<N>> {
        None
    }
}

/// A second derivative of a component of f, in two variables or twice in one. It stands for both orders.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SecondDerivative {
    /// The component.
    pub of: usize,
    /// The variables.
    pub by: [usize; 2],
    /// The value.
    pub value: f64,
}

impl SecondDerivative {
    /// The variables in both orders, or once where they are one.
    pub fn orders(&self) -> impl Iterator<Item = (usize, usize)> + use<> {
        let [i, j] = self.by;
        let other = (i != j).then_some((j, i));
        std::iter::once((i, j)).chain(other)
    }
}

/// The values f(y) and J(y) computed in 31 digits, with error bounds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ExactField<const N: usize> {
    /// f, and a bound on its error before it is rounded to double precision.
    pub f: [State<N>; 2],
    /// J likewise.
    pub jacobian: [Jacobian<N>; 2],
}

/// A field with named parameters, in any of which it can be differentiated.
pub trait Parametrised<const N: usize> {
    /// The names of the parameters: a parameter is asked for by its place among them.
    fn names(&self) -> &[&'static str];

    /// df/dp of the parameter at this place.
    ///
    /// # Panics
    /// Where there is none at this place, as the next.
    fn parameter_derivative(&self, y: &State<N>, place: usize) -> State<N>;

    /// dJ/dp of the parameter at this place.
    fn parameter_jacobian(&self, y: &State<N>, place: usize) -> Jacobian<N>;
}

/// The place of a parameter among some names.
///
/// # Errors
/// [`Error::Parameter`] for a name that is not there.
pub fn place(names: &[&'static str], name: &str) -> Result<usize> {
    let place = names.iter().position(|one| *one == name);
    place.ok_or_else(|| Error::unknown("parameter", name, names))
}

/// These places, or an error for one where the field has no parameter.
#[doc(hidden)]
pub fn checked_places<const N: usize>(field: &dyn VectorField<N>, free: &[usize]) -> Result<()> {
    let known = field.parametrised().map_or(0, |field| field.names().len());
    let Some(place) = free.iter().find(|&&place| place >= known) else {
        return Ok(());
    };
    Err(Error::parameter(
        "the place of a parameter",
        place,
        format!("below {known}, the number of parameters of this field"),
    ))
}

/// A field whose solutions are made as power series in time.
pub trait Analytic<const N: usize> {
    /// A solution, to be started.
    fn solution(&self) -> Box<dyn Solution<N> + '_>;

    /// A solution in 31 digits, to be started.
    fn reference(&self) -> Box<dyn Solution<N> + '_>;

    /// A solution with its derivatives in its start and in the parameters of these places among [`VectorField::parametrised`]'s,
    /// to be started.
    fn tangent(&self, free: &[usize]) -> Box<dyn Tangent<N> + '_>;

    /// The same in 31 digits.
    fn reference_tangent(&self, free: &[usize]) -> Box<dyn Tangent<N> + '_>;

    /// A solution to third order in two variations, which are those of this start; `None` where the field has none.
    fn transport(&self, _start: [Jet3; N]) -> Option<Box<dyn TaylorMap<N> + '_>> {
        None
    }
}

/// Returns J(y) with difference quotients in place of the entries that are not finite, as those of sqrt(max(0, x)) where x is negative or 0: for methods
/// that need no more of J than that they converge. All entries of a field that has its slopes stay ([`VectorField::may_lack_slopes`]).
///
/// A variable is displaced by a part of its own value and of how far it moves in the shortest time on J's diagonal, so that its unit does not matter. Where
/// it is 0 and does not move there is no such part: the entry is 0, and the next step, which begins elsewhere, has another.
#[cold]
pub fn with_differences<const N: usize>(
    field: &dyn VectorField<N>,
    y: &State<N>,
    mut jacobian: Jacobian<N>,
) -> Jacobian<N> {
    if !field.may_lack_slopes() {
        return jacobian;
    }
    let f = field.f(y);
    let rates = (0..N).map(|i| jacobian[(i, i)].abs());
    let fastest = rates.filter(|rate| rate.is_finite()).fold(0.0, f64::max);
    for j in 0..N {
        let unknown: Vec<usize> = (0..N).filter(|&i| !jacobian[(i, j)].is_finite()).collect();
        if unknown.is_empty() {
            continue;
        }
        let moved = f[j].abs() / fastest;
        let size = y[j].abs() + if moved.is_finite() { moved } else { 0.0 };
        let displaced = |by: f64| {
            let mut beside = *y;
            beside[j] += by;
            (field.f(&beside) - f) / (beside[j] - y[j])
        };
        let by = f64::EPSILON.sqrt() * size;
        let [forwards, backwards] = [by, -by].map(displaced);
        for i in unknown {
            if size == 0.0 {
                jacobian[(i, j)] = 0.0;
                continue;
            }
            let is_known = forwards[i].is_finite();
            jacobian[(i, j)] = if is_known { forwards[i] } else { backwards[i] };
        }
    }
    jacobian
}
