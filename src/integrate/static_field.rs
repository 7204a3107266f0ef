//! Fields of a dimension that the compiler knows behind those of any: where [`AnyField`](super::AnyField) meets the integrators.

use super::any_field::AnyExact;
use super::any_integrator::{AnyIntegrator, FlowDerivatives, Method};
use super::any_step::{AnyObserver, AnyStep};
use super::{Control, Integrator, Observer, Radau, Step, Taylor, Work};
use crate::error::{Error, Result};
use crate::field::{
    ExactField, Jacobian, Matrix, SecondDerivative, State, Vector, VectorField, state,
};
use crate::series::{Jet3, Tangent};

/// What a field of a dimension that the compiler knows does for one of any.
pub(super) trait Flows: Send + Sync {
    fn dimension(&self) -> usize;
    fn phase(&self) -> Option<(usize, f64)>;
    fn f(&self, y: &[f64]) -> Vector;
    fn jacobian(&self, y: &[f64]) -> Matrix;
    fn exact(&self, y: &[f64]) -> AnyExact;
    fn trace(&self, y: &[f64]) -> f64;
    fn newton_step(&self, y: &[f64]) -> Option<Vector>;
    fn second_derivative(&self, y_u_v: [&[f64]; 3]) -> Vector;
    fn series_along(&self, curve: &[Vector; 6]) -> Option<[Vector; 6]>;
    fn second_derivatives(&self, y: &[f64]) -> Vec<SecondDerivative>;
    fn parameter_names(&self) -> &[&'static str];
    fn parameter_derivative(&self, y: &[f64], place: usize) -> Vector;
    fn parameter_jacobian(&self, y: &[f64], place: usize) -> Matrix;
    fn flow(
        &self,
        by: &mut AnyIntegrator,
        t: (f64, f64),
        y0: &[f64],
        observer: Option<AnyObserver<'_>>,
    ) -> Result<Vector>;
    fn arcs<'f>(
        &'f self,
        by: &'f mut AnyIntegrator,
        free: &'f [usize],
    ) -> Result<Box<dyn ArcByArc + 'f>>;
    fn transport_onto(
        &self,
        taylor: &mut Taylor,
        span: (f64, f64),
        start: &[Jet3],
        plane: (&[f64], &[f64]),
    ) -> Result<(Jet3, Vec<Jet3>)>;
}

/// The solution of A x = b in the variables by elimination with partial pivoting: runs ask for it so often that it shall not allocate.
fn solve<const N: usize>(
    variables: usize,
    mut a: Jacobian<N>,
    mut b: State<N>,
) -> Option<State<N>> {
    for k in 0..variables {
        let pivot = (k..variables).max_by(|&i, &j| a[(i, k)].abs().total_cmp(&a[(j, k)].abs()))?;
        if a[(pivot, k)] == 0.0 {
            return None;
        }
        a.swap_rows(k, pivot);
        b.swap_rows(k, pivot);
        for i in k + 1..variables {
            let factor = a[(i, k)] / a[(k, k)];
            for j in k..variables {
                a[(i, j)] -= factor * a[(k, j)];
            }
            b[i] -= factor * b[k];
        }
    }
    for k in (0..variables).rev() {
        for j in k + 1..variables {
            b[k] -= a[(k, j)] * b[j];
        }
        b[k] /= a[(k, k)];
    }
    Some(b)
}

/// A field of N variables, or of fewer ([`VectorField::dimension`]): what goes out of here has the variables alone.
pub(super) enum Static<'a, const N: usize> {
    Owned(Box<dyn VectorField<N> + 'a>),
    Lent(&'a dyn VectorField<N>),
}

impl<const N: usize> Static<'_, N> {
    fn field(&self) -> &dyn VectorField<N> {
        match self {
            Static::Owned(field) => &**field,
            Static::Lent(field) => *field,
        }
    }

    fn state(&self, y: &[f64]) -> State<N> {
        assert_eq!(
            y.len(),
            self.field().dimension(),
            "a number for each variable"
        );
        state(y)
    }

    fn vector(&self, y: &State<N>) -> Vector {
        vector(self.field(), y)
    }
}

fn vector<const N: usize>(field: &dyn VectorField<N>, y: &State<N>) -> Vector {
    Vector::from_column_slice(&y.as_slice()[..field.dimension()])
}

/// Below this a factor of its own rate is about to lose its digits: the least double is no longer a rounding error of it.
pub(super) const SUNKEN: f64 = f64::MIN_POSITIVE / f64::EPSILON;

/// Watches variables that are factors of their own rates. Where one has fallen below the least double its rate over itself, an entry of the
/// Jacobian's diagonal, still says how it goes on, and when it would be back.
struct Sinking<const N: usize> {
    own: [bool; N],
    /// The logarithm of each that has fallen so low, over that of the least double.
    below: [Option<f64>; N],
}

impl<const N: usize> Sinking<N> {
    /// `None` where there are no such variables.
    fn of(field: &dyn VectorField<N>) -> Option<Self> {
        let own = field.own_factors();
        own.contains(&true).then_some(Sinking {
            own,
            below: [None; N],
        })
    }

    fn see(&mut self, field: &dyn VectorField<N>, step: &Step<'_, N>) -> Result<()> {
        let mut rates: Option<[State<N>; 3]> = None;
        for variable in (0..field.dimension()).filter(|&i| self.own[i]) {
            let is_below = step.y1[variable].abs() < f64::MIN_POSITIVE;
            let Some(below) = &mut self.below[variable] else {
                self.below[variable] = (is_below && step.y0[variable] != 0.0).then_some(0.0);
                continue;
            };
            // By Simpson's rule: steps may be long, where nothing else moves.
            let [begin, middle, end] = rates.get_or_insert_with(|| {
                let middle = step.after(0.5 * step.length);
                [*step.y0, middle, *step.y1].map(|y| field.jacobian(&y).diagonal())
            });
            let rate = (begin[variable] + 4.0 * middle[variable] + end[variable]) / 6.0;
            *below += rate * step.length;
            // A value just above the least double may be all error: the rates say whether it is there.
            let is_back = step.y1[variable].abs() > SUNKEN;
            if is_back || below.is_nan() || *below > 0.0 {
                let t = step.t1;
                return Err(Error::Underflow { variable, t });
            }
        }
        Ok(())
    }
}

fn matrix<const N: usize>(field: &dyn VectorField<N>, m: &Jacobian<N>) -> Matrix {
    let n = field.dimension();
    Matrix::from_fn(n, n, |i, j| m[(i, j)])
}

impl<const N: usize> Flows for Static<'_, N> {
    fn dimension(&self) -> usize {
        self.field().dimension()
    }

    fn phase(&self) -> Option<(usize, f64)> {
        self.field().phase()
    }

    fn f(&self, y: &[f64]) -> Vector {
        self.vector(&self.field().f(&self.state(y)))
    }

    fn jacobian(&self, y: &[f64]) -> Matrix {
        matrix(self.field(), &self.field().jacobian(&self.state(y)))
    }

    fn exact(&self, y: &[f64]) -> AnyExact {
        let (field, y) = (self.field(), self.state(y));
        let exact = field.exact(&y).unwrap_or_else(|| ExactField {
            f: [field.f(&y), State::zeros()],
            jacobian: [field.jacobian(&y), Jacobian::zeros()],
        });
        AnyExact {
            f: exact.f.map(|f| vector(field, &f)),
            jacobian: exact.jacobian.map(|jacobian| matrix(field, &jacobian)),
        }
    }

    fn trace(&self, y: &[f64]) -> f64 {
        self.field().jacobian(&self.state(y)).trace()
    }

    fn newton_step(&self, y: &[f64]) -> Option<Vector> {
        let (field, y) = (self.field(), self.state(y));
        let step = solve(field.dimension(), field.jacobian(&y), field.f(&y))?;
        step.iter()
            .all(|x| x.is_finite())
            .then(|| vector(field, &step))
    }

    fn second_derivative(&self, [y, u, v]: [&[f64]; 3]) -> Vector {
        let [y, u, v] = [y, u, v].map(|x| self.state(x));
        self.vector(&self.field().second_derivative(&y, &u, &v))
    }

    fn series_along(&self, curve: &[Vector; 6]) -> Option<[Vector; 6]> {
        let curve = curve.each_ref().map(|x| self.state(x.as_slice()));
        let made = self.field().series_along(&curve)?;
        Some(made.map(|x| self.vector(&x)))
    }

    fn second_derivatives(&self, y: &[f64]) -> Vec<SecondDerivative> {
        self.field().second_derivatives(&self.state(y))
    }

    fn parameter_names(&self) -> &[&'static str] {
        match self.field().parametrised() {
            Some(field) => field.names(),
            None => &[],
        }
    }

    fn parameter_derivative(&self, y: &[f64], place: usize) -> Vector {
        let field = self
            .field()
            .parametrised()
            .expect("a field with parameters");
        self.vector(&field.parameter_derivative(&self.state(y), place))
    }

    fn parameter_jacobian(&self, y: &[f64], place: usize) -> Matrix {
        let field = self
            .field()
            .parametrised()
            .expect("a field with parameters");
        matrix(
            self.field(),
            &field.parameter_jacobian(&self.state(y), place),
        )
    }

    fn flow(
        &self,
        by: &mut AnyIntegrator,
        t: (f64, f64),
        y0: &[f64],
        observer: Option<AnyObserver<'_>>,
    ) -> Result<Vector> {
        let mut run = |observer: Option<Observer<'_, N>>| -> (Result<State<N>>, Work) {
            match &mut by.method {
                Method::Taylor(taylor) => {
                    let end = taylor.flow(self.field(), t, &self.state(y0), observer);
                    (end, Integrator::<N>::work(taylor))
                }
                Method::Radau(radau) => {
                    let end = radau.flow(self.field(), t, &self.state(y0), observer);
                    (end, Integrator::<N>::work(radau))
                }
                Method::Other {
                    choice,
                    tolerances,
                    max_steps,
                } => match choice.integrator::<N>(*tolerances, *max_steps) {
                    Ok(mut method) => {
                        let end = method.flow(self.field(), t, &self.state(y0), observer);
                        (end, method.work())
                    }
                    Err(error) => (Err(error), Work::default()),
                },
            }
        };
        let variables = self.dimension();
        let mut sinking = Sinking::of(self.field());
        let (end, work) = match (observer, &mut sinking) {
            (None, None) => run(None),
            (Some(observer), None) => run(Some(&mut |step: &Step<'_, N>| {
                AnyStep::of(step, variables, &mut *observer)
            })),
            (mut observer, Some(sinking)) => run(Some(&mut |step: &Step<'_, N>| {
                sinking.see(self.field(), step)?;
                let told = match &mut observer {
                    Some(observer) => AnyStep::of(step, variables, &mut **observer)?,
                    None => Control::Continue,
                };
                // Every step is to be seen.
                Ok(match told {
                    Control::Rest(_) => Control::Continue,
                    told => told,
                })
            })),
        };
        by.work = work;
        Ok(self.vector(&end?))
    }

    fn arcs<'f>(
        &'f self,
        by: &'f mut AnyIntegrator,
        free: &'f [usize],
    ) -> Result<Box<dyn ArcByArc + 'f>> {
        let field = self.field();
        let tangents = match &mut by.method {
            Method::Taylor(taylor) => {
                let tangent = taylor.tangent(field, free)?;
                Tangents::Series(taylor, tangent)
            }
            Method::Radau(radau) => Tangents::Radau(radau, free),
            Method::Other {
                choice,
                tolerances,
                max_steps,
            } => Tangents::Other(choice.integrator(*tolerances, *max_steps)?),
        };
        Ok(Box::new(StaticArcs {
            field,
            work: &mut by.work,
            tangents,
        }))
    }

    fn transport_onto(
        &self,
        taylor: &mut Taylor,
        span: (f64, f64),
        start: &[Jet3],
        (normal, point): (&[f64], &[f64]),
    ) -> Result<(Jet3, Vec<Jet3>)> {
        let start = std::array::from_fn(|i| start.get(i).copied().unwrap_or_default());
        let plane = (&self.state(normal), &self.state(point));
        let (time, end) = taylor.transport_onto::<N>(self.field(), span, start, plane)?;
        Ok((time, end[..self.dimension()].to_vec()))
    }
}

/// Derivatives along arcs, one after the other.
pub(super) trait ArcByArc {
    fn derivatives(&mut self, t: (f64, f64), y0: &[f64]) -> Result<(Vector, FlowDerivatives)>;
    fn work(&self) -> Work;
}

struct StaticArcs<'f, const N: usize> {
    field: &'f dyn VectorField<N>,
    work: &'f mut Work,
    tangents: Tangents<'f, N>,
}

/// What makes the derivatives, made once for all arcs: CVODES allocates a hundred vectors.
enum Tangents<'f, const N: usize> {
    Series(&'f mut Taylor, Box<dyn Tangent<N> + 'f>),
    /// With the places of the parameters.
    Radau(&'f mut Radau, &'f [usize]),
    Other(Box<dyn Integrator<N>>),
}

impl<const N: usize> ArcByArc for StaticArcs<'_, N> {
    fn derivatives(&mut self, t: (f64, f64), y0: &[f64]) -> Result<(Vector, FlowDerivatives)> {
        let (field, start) = (self.field, state(y0));
        let n = field.dimension();
        match &mut self.tangents {
            Tangents::Series(taylor, tangent) => {
                let made = taylor.derivatives_by(&mut **tangent, field, t, &start);
                // Also of what fails.
                *self.work = Integrator::<N>::work(*taylor);
                let (end, made) = made?;
                let columns = &made.parameters;
                let derivatives = FlowDerivatives {
                    start: Matrix::from_fn(n, n, |i, j| made.start[j][i]),
                    parameters: Matrix::from_fn(n, columns.len(), |i, j| columns[j][i]),
                    log_determinant: Some(made.log_determinant),
                    log_transverse: made.log_transverse,
                };
                Ok((vector(field, &end), derivatives))
            }
            Tangents::Radau(method, free) => {
                let made = method.derivatives(field, t, &start, free);
                *self.work = Integrator::<N>::work(*method);
                let (end, columns, volume) = made?;
                let derivatives = FlowDerivatives {
                    start: columns.columns(0, n).into_owned(),
                    parameters: columns.columns_range(n..).into_owned(),
                    log_determinant: Some(volume),
                    log_transverse: None,
                };
                Ok((end, derivatives))
            }
            Tangents::Other(method) => {
                let made = method.tangent_flow(field, t, &start);
                *self.work = method.work();
                let (end, tangent) = made?;
                let derivatives = FlowDerivatives {
                    start: matrix(field, &tangent),
                    parameters: Matrix::zeros(n, 0),
                    log_determinant: None,
                    log_transverse: None,
                };
                Ok((vector(field, &end), derivatives))
            }
        }
    }

    fn work(&self) -> Work {
        *self.work
    }
}
