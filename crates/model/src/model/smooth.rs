//! Any small system of [`Equations`] as a vector field: everything from the right-hand side, written once.

use crate::field::{Analytic, Jacobian, Parametrised, State, VectorField};
use crate::number::Jet;
use crate::series::{ByRecording, Equations, Jet3, Recorded, Solution, Tangent, TaylorMap};

/// Equations at given parameters.
///
/// ```
/// use twinslip::field::State;
/// use twinslip::integrate::{MAX_STEPS, Taylor, Tolerances};
/// use twinslip::model::{Smooth, classics::Lorenz};
/// # fn main() -> twinslip::Result<()> {
/// let lorenz = Smooth { equations: Lorenz::classical(), parameters: [28.0, 8.0 / 3.0] };
/// let mut taylor = Taylor::new(Tolerances::equal(1e-14)?, MAX_STEPS)?;
/// let (_, derivatives) = taylor.derivatives(&lorenz, (0.0, 1.0), &State::<3>::new(1.0, 2.0, 20.0), &[0, 1])?;
/// // volumes shrink by the same factor everywhere
/// assert!((derivatives.log_determinant + 10.0 + 1.0 + 8.0 / 3.0).abs() < 1e-13);
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Smooth<S, const N: usize, const P: usize> {
    /// The right-hand side.
    pub equations: S,
    /// The parameters, as named by [`Equations::PARAMETERS`].
    pub parameters: [f64; P],
}

impl<S: Equations<N, P>, const N: usize, const P: usize> Parametrised<N> for Smooth<S, N, P> {
    fn names(&self) -> &[&'static str] {
        &S::PARAMETERS
    }

    fn parameter_derivative(&self, y: &State<N>, place: usize) -> State<N> {
        let mut parameters = self.parameters.map(constant);
        parameters[place].gradient = [1.0];
        let x = y.data.0[0].map(constant);
        State::from(self.equations.rates(x, parameters).map(|f| f.gradient[0]))
    }

    fn parameter_jacobian(&self, y: &State<N>, place: usize) -> Jacobian<N> {
        let inner = |value: f64| Jet::<f64, N> {
            value,
            gradient: [0.0; N],
        };
        let fixed = |value| Jet {
            value,
            gradient: [inner(0.0)],
        };
        let mut parameters = self.parameters.map(|p| fixed(inner(p)));
        parameters[place].gradient = [inner(1.0)];
        let x = Jet::variables(y.data.0[0]).map(fixed);
        let rates = self.equations.rates(x, parameters);
        Jacobian::from_fn(|i, j| rates[i].gradient[0].gradient[j])
    }
}

/// A number that does not vary.
fn constant(value: f64) -> Jet<f64, 1> {
    Jet {
        value,
        gradient: [0.0],
    }
}

impl<S: Equations<N, P>, const N: usize, const P: usize> VectorField<N> for Smooth<S, N, P> {
    fn parametrised(&self) -> Option<&dyn Parametrised<N>> {
        Some(self)
    }

    fn lasting(&self) -> Option<&'static str> {
        self.equations.lasting()
    }

    fn f(&self, y: &State<N>) -> State<N> {
        State::from(self.equations.rates(y.data.0[0], self.parameters))
    }

    fn jacobian(&self, y: &State<N>) -> Jacobian<N> {
        let parameters = self.parameters.map(|value| Jet {
            value,
            gradient: [0.0; N],
        });
        let rates = self
            .equations
            .rates(Jet::variables(y.data.0[0]), parameters);
        Jacobian::from_fn(|i, j| rates[i].gradient[j])
    }

    fn second_derivative(&self, y: &State<N>, u: &State<N>, v: &State<N>) -> State<N> {
        // f(y + a u + b v), differentiated in a and in b.
        let of = |value: f64, u: f64, v: f64| Jet {
            value: Jet {
                value,
                gradient: [u],
            },
            gradient: [constant(v)],
        };
        let x = std::array::from_fn(|i| of(y[i], u[i], v[i]));
        let rates = self
            .equations
            .rates(x, self.parameters.map(|p| of(p, 0.0, 0.0)));
        State::from(rates.map(|f| f.gradient[0].gradient[0]))
    }

    fn analytic(&self) -> Option<&dyn Analytic<N>> {
        Some(self)
    }
}

impl<S: Equations<N, P>, const N: usize, const P: usize> Smooth<S, N, P> {
    fn recorded(&self) -> Recorded<S, N, P> {
        Recorded {
            equations: self.equations,
            parameters: self.parameters,
            symmetric: false,
        }
    }
}

impl<S: Equations<N, P>, const N: usize, const P: usize> Analytic<N> for Smooth<S, N, P> {
    fn solution(&self) -> Box<dyn Solution<N> + '_> {
        if let Some(own) = self.equations.own_solution(self.parameters) {
            return own;
        }
        self.recorded().solution()
    }

    fn reference(&self) -> Box<dyn Solution<N> + '_> {
        self.recorded().reference()
    }

    fn tangent(&self, free: &[usize]) -> Box<dyn Tangent<N> + '_> {
        if let Some(own) = self.equations.own_tangent(self.parameters, free) {
            return own;
        }
        self.recorded().tangent(free)
    }

    fn reference_tangent(&self, free: &[usize]) -> Box<dyn Tangent<N> + '_> {
        self.recorded().reference_tangent(free)
    }

    fn transport(&self, start: [Jet3; N]) -> Option<Box<dyn TaylorMap<N> + '_>> {
        Some(self.recorded().transport(start))
    }
}
