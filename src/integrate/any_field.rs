//! Vector fields whose dimension is known when the program runs, and the methods that integrate them.
//!
//! The methods themselves are compiled for each dimension, which is where the time goes. What stands above them, orbits,
//! continuation and Floquet theory, sees [`AnyField`] and [`AnyIntegrator`] alone and is compiled once.

use super::{Choice, Control, Integrator, Observer, Step, Taylor, Tolerances, Work};
use crate::error::{Error, Result};
use crate::field::{Jacobian, Matrix, State, Vector, VectorField};
use crate::number::{DoubleDouble, polynomial::Crossing};
use crate::series::{Expansion, Jet3, Section, Tangent, Zeros};

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
pub struct AnyField<'a>(Box<dyn Flows + 'a>);

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

    /// The number of its variables.
    pub fn dimension(&self) -> usize {
        self.0.dimension()
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

    /// That a point has as many components as the field has variables.
    fn holds(&self, y: &Vector) -> Result<()> {
        of_dimension(y.len(), self.dimension())
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

impl<'a, const N: usize> From<Box<dyn VectorField<N> + 'a>> for AnyField<'a> {
    fn from(field: Box<dyn VectorField<N> + 'a>) -> Self {
        AnyField::new(field)
    }
}

/// A method of integration for fields of any dimension.
#[derive(Debug, Clone)]
pub struct AnyIntegrator {
    method: Method,
    name: &'static str,
    work: Work,
}

/// Taylor's method knows no dimension; the others are made where they are called.
#[derive(Debug, Clone)]
enum Method {
    Taylor(Taylor),
    Other {
        choice: Choice,
        tolerances: Tolerances,
        max_steps: usize,
    },
}

/// The derivatives of a state in its start and in parameters.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct FlowDerivatives {
    /// In the start.
    pub start: Matrix,
    /// In the parameters that were asked for, a column for each, in that order; none from methods that make none.
    pub parameters: Matrix,
    /// The integral of the trace of the Jacobian, of methods that make it beside the tangent.
    pub log_determinant: Option<f64>,
    /// In the plane of symmetric states: the logarithm by which a small difference between the interfaces grows, where the
    /// method makes it.
    pub log_transverse: Option<f64>,
}

impl AnyIntegrator {
    /// At most `max_steps` steps in a flow.
    ///
    /// # Errors
    /// [`Error::Parameter`] for tolerances outside their domain or no steps.
    pub fn new(choice: Choice, tolerances: Tolerances, max_steps: usize) -> Result<Self> {
        // The least of all integrators says whether these are allowed.
        let taylor = Taylor::new(tolerances, max_steps)?;
        let method = match choice {
            Choice::Taylor => Method::Taylor(taylor),
            choice => Method::Other {
                choice,
                tolerances,
                max_steps,
            },
        };
        Ok(AnyIntegrator {
            method,
            name: choice.name(),
            work: Work::default(),
        })
    }

    /// The method's name.
    pub fn name(&self) -> &'static str {
        self.name
    }

    /// The work of the last call, finished or failed.
    pub fn work(&self) -> Work {
        self.work
    }

    /// Whether [`AnyIntegrator::derivatives`] has those in parameters.
    pub fn differentiates(&self) -> bool {
        matches!(self.method, Method::Taylor(_))
    }

    /// The state at `t.1` from `y0` at `t.0`.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a start of another dimension; those of [`Integrator::flow`].
    pub fn flow(
        &mut self,
        field: &AnyField<'_>,
        t: (f64, f64),
        y0: &Vector,
        observer: Option<AnyObserver<'_>>,
    ) -> Result<Vector> {
        self.work = Work::default();
        field.holds(y0)?;
        field.0.flow(self, t, y0.as_slice(), observer)
    }

    /// The state at `t.1` and its derivatives in `y0` and, of Taylor's method, in the parameters of these places.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a start of another dimension and for a place where there is no parameter; those of
    /// [`Integrator::flow`].
    pub fn derivatives(
        &mut self,
        field: &AnyField<'_>,
        t: (f64, f64),
        y0: &Vector,
        free: &[usize],
    ) -> Result<(Vector, FlowDerivatives)> {
        self.arcs(field, free)?.derivatives(t, y0)
    }

    /// The same along several arcs, one after the other: what makes the derivatives is made once.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a place where there is no parameter, [`Error::NotAnalytic`] where the method asks for series.
    pub fn arcs<'f>(
        &'f mut self,
        field: &'f AnyField<'_>,
        free: &'f [usize],
    ) -> Result<DerivativesAlongArcs<'f>> {
        self.work = Work::default();
        let dimension = field.dimension();
        Ok(DerivativesAlongArcs {
            by: field.0.arcs(self, free)?,
            dimension,
        })
    }
}

/// What makes the derivatives along arcs of one field.
pub struct DerivativesAlongArcs<'f> {
    by: Box<dyn ArcByArc + 'f>,
    dimension: usize,
}

impl DerivativesAlongArcs<'_> {
    /// [`AnyIntegrator::derivatives`].
    ///
    /// # Errors
    /// As of those.
    pub fn derivatives(&mut self, t: (f64, f64), y0: &Vector) -> Result<(Vector, FlowDerivatives)> {
        of_dimension(y0.len(), self.dimension)?;
        self.by.derivatives(t, y0.as_slice())
    }

    /// The work of the last arc, finished or failed.
    pub fn work(&self) -> Work {
        self.by.work()
    }
}

/// Sees every accepted step; an error from it ends the flow.
pub type AnyObserver<'a> = &'a mut dyn FnMut(&AnyStep<'_>) -> Result<Control>;

/// One accepted step in any dimension, as [`Step`].
#[non_exhaustive]
pub struct AnyStep<'a> {
    /// Time at the beginning.
    pub t0: f64,
    /// State at `t0`.
    pub y0: &'a [f64],
    /// Time at the end.
    pub t1: f64,
    /// State at `t1`.
    pub y1: &'a [f64],
    /// A bound on how far the first component strays from its value at `t0`, of methods to which it costs nothing; else
    /// infinity.
    pub reach: f64,
    dense: &'a dyn Fn(f64) -> Vector,
    series: &'a dyn Fn() -> Option<&'a dyn StepSeries>,
}

impl<'a> AnyStep<'a> {
    /// What `see` makes of a step of a field whose dimension the compiler knows.
    pub(crate) fn of<const N: usize, T>(
        step: &Step<'_, N>,
        see: impl FnOnce(&AnyStep<'_>) -> T,
    ) -> T {
        see(&AnyStep {
            t0: step.t0,
            y0: step.y0.as_slice(),
            t1: step.t1,
            y1: step.y1.as_slice(),
            reach: step.reach,
            dense: &|t| vector(&(step.dense)(t)),
            series: &|| step.series().map(|series| series as &dyn StepSeries),
        })
    }

    /// The continuous solution at a time within the step.
    pub fn dense(&self, t: f64) -> Vector {
        (self.dense)(t)
    }

    /// The series at `t0`, of methods that step by one.
    pub fn series(&self) -> Option<&'a dyn StepSeries> {
        (self.series)()
    }
}

/// The power series of a step in any dimension: an [`Expansion`].
pub trait StepSeries {
    /// The time of the beginning, in 31 digits.
    fn begin(&self) -> DoubleDouble;
    /// The time from the beginning of the step to its end.
    fn length(&self) -> f64;
    /// The unit of time.
    fn unit(&self) -> f64;
    /// The order to which the variables are known.
    fn order(&self) -> usize;
    /// The coefficients of the i-th variable, to the order.
    fn variable(&self, i: usize) -> &[f64];
    /// The coefficients of the slip rates of both interfaces, to one order less; zero for fields without any.
    fn slip_rates(&self) -> [&[f64]; 2];
    /// Appends the zeros of a section within this step to `found` ([`Expansion::crossings`]).
    fn crossings(
        &self,
        section: AnySection<'_>,
        direction: Option<Crossing>,
        zeros: &mut Zeros,
        found: &mut Vec<AnyPassage>,
    );
}

/// A function that is watched for zeros, as [`Section`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum AnySection<'a> {
    /// normal . x - offset.
    Plane {
        /// The plane's normal.
        normal: &'a Vector,
        /// Its distance from 0 in the length of the normal.
        offset: f64,
    },
    /// The time derivative of normal . x.
    Extremum {
        /// What is largest or smallest.
        normal: &'a Vector,
    },
}

/// A zero of a section along a step.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct AnyPassage {
    /// Time since the beginning of the step.
    pub time: f64,
    /// How the section's sign changes as time grows.
    pub crossing: Crossing,
    /// The state there.
    pub state: Vector,
}

impl<const N: usize> StepSeries for Expansion<N> {
    fn begin(&self) -> DoubleDouble {
        self.begin
    }

    fn length(&self) -> f64 {
        self.length
    }

    fn unit(&self) -> f64 {
        self.unit
    }

    fn order(&self) -> usize {
        self.order
    }

    fn variable(&self, i: usize) -> &[f64] {
        &self.variables[i][..=self.order]
    }

    fn slip_rates(&self) -> [&[f64]; 2] {
        self.slip_rates.each_ref().map(|rates| &rates[..self.order])
    }

    fn crossings(
        &self,
        section: AnySection<'_>,
        direction: Option<Crossing>,
        zeros: &mut Zeros,
        found: &mut Vec<AnyPassage>,
    ) {
        let components = |normal: &Vector| -> [f64; N] { std::array::from_fn(|i| normal[i]) };
        let section = match section {
            AnySection::Plane { normal, offset } => Section::Plane {
                normal: components(normal),
                offset,
            },
            AnySection::Extremum { normal } => Section::Extremum {
                normal: components(normal),
            },
        };
        let mut here = Vec::new();
        self.crossings(&section, direction, zeros, &mut here);
        found.extend(here.into_iter().map(|passage| AnyPassage {
            time: passage.time,
            crossing: passage.crossing,
            state: Vector::from_column_slice(&passage.state),
        }));
    }
}

/// What a field of a dimension that the compiler knows does for one of any.
trait Flows: Send + Sync {
    fn dimension(&self) -> usize;
    fn f(&self, y: &[f64]) -> Vector;
    fn jacobian(&self, y: &[f64]) -> Matrix;
    fn trace(&self, y: &[f64]) -> f64;
    fn newton_step(&self, y: &[f64]) -> Option<Vector>;
    fn second_derivative(&self, y_u_v: [&[f64]; 3]) -> Vector;
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

/// The solution of A x = b by elimination with partial pivoting: runs ask for it so often that it shall not allocate.
fn solve<const N: usize>(mut a: Jacobian<N>, mut b: State<N>) -> Option<State<N>> {
    for k in 0..N {
        let pivot = (k..N).max_by(|&i, &j| a[(i, k)].abs().total_cmp(&a[(j, k)].abs()))?;
        if a[(pivot, k)] == 0.0 {
            return None;
        }
        a.swap_rows(k, pivot);
        b.swap_rows(k, pivot);
        for i in k + 1..N {
            let factor = a[(i, k)] / a[(k, k)];
            for j in k..N {
                a[(i, j)] -= factor * a[(k, j)];
            }
            b[i] -= factor * b[k];
        }
    }
    for k in (0..N).rev() {
        for j in k + 1..N {
            b[k] -= a[(k, j)] * b[j];
        }
        b[k] /= a[(k, k)];
    }
    Some(b)
}

/// A field of N variables.
enum Static<'a, const N: usize> {
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
}

fn state<const N: usize>(y: &[f64]) -> State<N> {
    State::from_column_slice(y)
}

fn vector<const N: usize>(y: &State<N>) -> Vector {
    Vector::from_column_slice(y.as_slice())
}

fn matrix<const N: usize>(m: &Jacobian<N>) -> Matrix {
    Matrix::from_column_slice(N, N, m.as_slice())
}

impl<const N: usize> Flows for Static<'_, N> {
    fn dimension(&self) -> usize {
        N
    }

    fn f(&self, y: &[f64]) -> Vector {
        vector(&self.field().f(&state(y)))
    }

    fn jacobian(&self, y: &[f64]) -> Matrix {
        matrix(&self.field().jacobian(&state(y)))
    }

    fn trace(&self, y: &[f64]) -> f64 {
        self.field().jacobian(&state(y)).trace()
    }

    fn newton_step(&self, y: &[f64]) -> Option<Vector> {
        let y = state(y);
        let step = solve(self.field().jacobian(&y), self.field().f(&y))?;
        step.iter().all(|x| x.is_finite()).then(|| vector(&step))
    }

    fn second_derivative(&self, [y, u, v]: [&[f64]; 3]) -> Vector {
        vector(
            &self
                .field()
                .second_derivative(&state(y), &state(u), &state(v)),
        )
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
        vector(&field.parameter_derivative(&state(y), place))
    }

    fn parameter_jacobian(&self, y: &[f64], place: usize) -> Matrix {
        let field = self
            .field()
            .parametrised()
            .expect("a field with parameters");
        matrix(&field.parameter_jacobian(&state(y), place))
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
                    let end = taylor.flow(self.field(), t, &state(y0), observer);
                    (end, Integrator::<N>::work(taylor))
                }
                Method::Other {
                    choice,
                    tolerances,
                    max_steps,
                } => match choice.integrator::<N>(*tolerances, *max_steps) {
                    Ok(mut method) => {
                        let end = method.flow(self.field(), t, &state(y0), observer);
                        (end, method.work())
                    }
                    Err(error) => (Err(error), Work::default()),
                },
            }
        };
        let (end, work) = match observer {
            None => run(None),
            Some(observer) => run(Some(&mut |step: &Step<'_, N>| {
                AnyStep::of(step, &mut *observer)
            })),
        };
        by.work = work;
        Ok(vector(&end?))
    }

    fn arcs<'f>(
        &'f self,
        by: &'f mut AnyIntegrator,
        free: &'f [usize],
    ) -> Result<Box<dyn ArcByArc + 'f>> {
        let field = self.field();
        let tangent = match &mut by.method {
            Method::Taylor(taylor) => Some(taylor.tangent(field, free)?),
            Method::Other { .. } => None,
        };
        Ok(Box::new(StaticArcs { field, by, tangent }))
    }

    fn transport_onto(
        &self,
        taylor: &mut Taylor,
        span: (f64, f64),
        start: &[Jet3],
        (normal, point): (&[f64], &[f64]),
    ) -> Result<(Jet3, Vec<Jet3>)> {
        let start = std::array::from_fn(|i| start[i]);
        let plane = (&state(normal), &state(point));
        let (time, end) = taylor.transport_onto::<N>(self.field(), span, start, plane)?;
        Ok((time, end.to_vec()))
    }
}

/// Derivatives along arcs, one after the other.
trait ArcByArc {
    fn derivatives(&mut self, t: (f64, f64), y0: &[f64]) -> Result<(Vector, FlowDerivatives)>;
    fn work(&self) -> Work;
}

struct StaticArcs<'f, const N: usize> {
    field: &'f dyn VectorField<N>,
    by: &'f mut AnyIntegrator,
    /// Of Taylor's method.
    tangent: Option<Box<dyn Tangent<N> + 'f>>,
}

impl<const N: usize> ArcByArc for StaticArcs<'_, N> {
    fn derivatives(&mut self, t: (f64, f64), y0: &[f64]) -> Result<(Vector, FlowDerivatives)> {
        let (field, start) = (self.field, state(y0));
        match (&mut self.by.method, &mut self.tangent) {
            (Method::Taylor(taylor), Some(tangent)) => {
                let made = taylor.derivatives_by(&mut **tangent, field, t, &start);
                // Also of what fails.
                self.by.work = Integrator::<N>::work(taylor);
                let (end, made) = made?;
                let columns = &made.parameters;
                let derivatives = FlowDerivatives {
                    start: Matrix::from_column_slice(N, N, made.start.as_flattened()),
                    parameters: Matrix::from_column_slice(N, columns.len(), columns.as_flattened()),
                    log_determinant: Some(made.log_determinant),
                    log_transverse: made.log_transverse,
                };
                Ok((vector(&end), derivatives))
            }
            (Method::Taylor(_), None) => Err(Error::NotAnalytic),
            (
                Method::Other {
                    choice,
                    tolerances,
                    max_steps,
                },
                _,
            ) => {
                let mut method = choice.integrator::<N>(*tolerances, *max_steps)?;
                let made = method.tangent_flow(field, t, &start);
                self.by.work = method.work();
                let (end, tangent) = made?;
                let derivatives = FlowDerivatives {
                    start: matrix(&tangent),
                    parameters: Matrix::zeros(N, 0),
                    log_determinant: None,
                    log_transverse: None,
                };
                Ok((vector(&end), derivatives))
            }
        }
    }

    fn work(&self) -> Work {
        self.by.work
    }
}
