//! Rosenbrock methods: implicit enough for stiff systems, and no iteration, since each stage is one linear system.
//!
//! J is exact and new at every step, so the methods keep their classical order. A step costs s evaluations of f, one of J
//! and one small factorisation; on the two interfaces three quarters of its time are the model's. [`Tableau`] has the
//! coefficients, `drive` the way from one time to another, `trajectory` and `tangent` what a step does to a state alone
//! and to a state with its tangent flow.
//!
//! At equal error on eight reference runs Rodas5P is ahead of Rodas4 in six, by a factor of 1.5 to 2.4 at 1e-6 and 2 to 4
//! at 1e-9, and is the one that [`super::Auto`] takes. Rodas4 leads by up to a third on the torus at K = 0.2 down to 1e-7, in a slow relaxation at
//! V_H = 50000, and at some places where a per mille will do. The pair of ode23s is for errors of a per cent.
//!
//! J stands in doubles, so a linear invariant of f, such as a mass, is kept in a step to the rounding of h J u and no better, u
//! being the change of the state, while the error test asks for no more than the tolerance. Where the state later falls far
//! below that rounding, as by twelve decades in E5 of the stiff test set, its end is what rounding has made of the invariant.
//! Such a variable is better eliminated by it.

pub(crate) mod control;
pub(crate) mod drive;
pub(crate) mod factors;
pub(crate) mod stages;
mod tangent;
mod trajectory;

use super::tableau::{MAX_STAGES, RODAS4, RODAS5P, ROS23, Tableau};
use super::{Control, Integrator, Observer, Tolerances, Work};
use crate::error::{Error, Result};
use crate::field::{Jacobian, State, VectorField};
use control::{MayErr, first_step};
use drive::drive;
use factors::SMALL;
use stages::{Linearisation, Scheme, Stages};
use tangent::Bundle;
use trajectory::StepState;

/// The Rosenbrock methods.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum RosenbrockMethod {
    /// Rodas5P, order 5(4): mostly the fastest where the error is to be below 1e-4.
    #[default]
    Rodas5P,
    /// RODAS, order 4(3).
    Rodas4,
    /// The pair of ode23s, order 2(3).
    Ros23,
}

impl RosenbrockMethod {
    /// All of them, in the order of the enumeration.
    pub const ALL: [RosenbrockMethod; 3] = [
        RosenbrockMethod::Rodas5P,
        RosenbrockMethod::Rodas4,
        RosenbrockMethod::Ros23,
    ];

    /// The coefficients.
    #[doc(hidden)]
    pub const fn tableau(self) -> &'static Tableau {
        match self {
            RosenbrockMethod::Rodas5P => &RODAS5P,
            RosenbrockMethod::Rodas4 => &RODAS4,
            RosenbrockMethod::Ros23 => &ROS23,
        }
    }

    /// The method of that name.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a name that is not one of `rodas5p`, `rodas4`, `rosenbrock23`.
    pub fn named(name: &str) -> Result<Self> {
        Self::ALL
            .into_iter()
            .find(|method| method.tableau().name == name)
            .ok_or_else(|| {
                Error::unknown(
                    "method",
                    name,
                    &Self::ALL.map(|method| method.tableau().name),
                )
            })
    }
}

/// The method at this place among all, for which steps are compiled.
#[derive(Clone, Copy)]
struct Compiled<const METHOD: usize>;

impl<const METHOD: usize> Scheme for Compiled<METHOD> {
    const WRITTEN_OUT: bool = true;
    #[inline(always)]
    fn tableau(self) -> &'static Tableau {
        const { RosenbrockMethod::ALL[METHOD].tableau() }
    }
}

impl Scheme for RosenbrockMethod {
    const WRITTEN_OUT: bool = false;
    fn tableau(self) -> &'static Tableau {
        RosenbrockMethod::tableau(self)
    }
}

/// Whether the steps in so many dimensions are compiled for each method: those of two interfaces and of their symmetric plane, of which
/// sweeps and figures make millions.
const fn written_out(dimension: usize) -> bool {
    matches!(dimension, 2 | 3)
}

/// An integrator that steps by a Rosenbrock method.
///
/// A step is accepted if no component errs by more than `atol + rtol |y_i|`, in a tangent flow no entry of the tangent
/// either. Nothing is allocated on the way.
///
/// ```
/// use twinslip::field::State;
/// use twinslip::friction::Parameters;
/// use twinslip::integrate::{Integrator, MAX_STEPS, RosenbrockMethod, Rosenbrock, Tolerances};
/// use twinslip::model::{Loading, TwoInterfaces};
/// # fn main() -> twinslip::Result<()> {
/// let law = Parameters::heslot_1994().spinodal();
/// let field = TwoInterfaces { law, loading: Loading::new(1000.0, 0.14)? };
/// let start = State::<3>::new(10.0, 0.5_f64.ln(), 0.001_f64.ln());
/// let mut rosenbrock = Rosenbrock::new(RosenbrockMethod::default(), Tolerances::equal(1e-8)?, MAX_STEPS)?;
/// let end = rosenbrock.flow(&field, (0.0, 200.0), &start, None)?;
/// assert!((end[0] - 8.7802282536803).abs() < 1e-8);
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Rosenbrock<const N: usize> {
    method: RosenbrockMethod,
    tolerances: Tolerances,
    max_steps: usize,
    work: Work,
}

impl<const N: usize> Rosenbrock<N> {
    /// The most dimensions: a dozen matrices stand on the stack, and all of them fit in that of any thread.
    pub const MAX_DIMENSION: usize = 100;
    /// The most dimensions of a tangent flow, which has several times as many matrices.
    pub const MAX_TANGENT_DIMENSION: usize = 24;

    /// With a bound on the steps of one call, refused ones included.
    ///
    /// # Errors
    /// [`Error::Parameter`] if `max_steps` is 0, the tolerances are not those of [`Tolerances::new`], or there are more than
    /// [`Self::MAX_DIMENSION`] dimensions.
    pub fn new(method: RosenbrockMethod, tolerances: Tolerances, max_steps: usize) -> Result<Self> {
        if N > Self::MAX_DIMENSION {
            return Err(Error::parameter(
                "the dimension",
                N,
                "at most 100 for a Rosenbrock method",
            ));
        }
        if max_steps == 0 {
            return Err(Error::parameter("max-steps", max_steps, "at least 1"));
        }
        Ok(Rosenbrock {
            method,
            tolerances: tolerances.checked()?,
            max_steps,
            work: Work::default(),
        })
    }

    /// Another bound on steps.
    pub(super) fn set_max_steps(&mut self, max_steps: usize) {
        self.max_steps = max_steps;
    }

    /// The method.
    pub fn method(&self) -> RosenbrockMethod {
        self.method
    }

    /// f and J at the start, as `linearise` makes them, finite, and the first step.
    fn start(
        &mut self,
        field: &dyn VectorField<N>,
        t: (f64, f64),
        y0: &State<N>,
        linearise: fn(&dyn VectorField<N>, &State<N>, State<N>) -> Option<Linearisation<N>>,
    ) -> Result<(Linearisation<N>, f64)> {
        if y0.iter().any(|x| !x.is_finite()) {
            return Err(Error::NonFinite {
                what: "the initial state",
                t: t.0,
            });
        }
        self.work.rhs += 1;
        self.work.jacobians += 1;
        let here = linearise(field, y0, field.f(y0)).ok_or(Error::NonFinite {
            what: "the right-hand side or its Jacobian",
            t: t.0,
        })?;
        let span = t.1 - t.0;
        let order = self.method.tableau().order;
        let length = first_step(
            MayErr::new(self.tolerances, field),
            order,
            span.abs(),
            y0,
            &here.f,
            &here.jacobian,
        );
        Ok((here, length.copysign(span)))
    }

    // Not inlined: the matrices of all methods would stand on the stack at once.
    #[inline(never)]
    fn flow_by<S: Scheme>(
        &mut self,
        scheme: S,
        field: &dyn VectorField<N>,
        t: (f64, f64),
        y0: &State<N>,
        mut observer: Option<Observer<'_, N>>,
    ) -> Result<State<N>> {
        let (here, h) = self.start(field, t, y0, Linearisation::for_steps)?;
        let mut trajectory =
            StepState::new(scheme, field, self.tolerances, &mut self.work, *y0, here);
        drive(
            &mut trajectory,
            t,
            h,
            self.max_steps,
            |moved, time| match observer.as_mut() {
                Some(observer) => moved.show(time, observer),
                None => Ok(Control::Continue),
            },
        )?;
        Ok(*trajectory.state())
    }

    /// The tangent flow in so many dimensions that its stages fill the stack.
    #[inline(never)]
    fn tangent_flow_of_many(
        &mut self,
        field: &dyn VectorField<N>,
        t: (f64, f64),
        y0: &State<N>,
    ) -> Result<(State<N>, Jacobian<N>)> {
        let stages = vec![Jacobian::zeros(); MAX_STAGES].into_boxed_slice();
        let mut stages: Box<Stages<N, N>> = stages.try_into().expect("as many as there are stages");
        self.tangent_flow_by::<_, 0>((self.method, &mut *stages), field, t, y0)
    }

    #[inline(never)]
    fn tangent_flow_by<S: Scheme, const KEPT: usize>(
        &mut self,
        (scheme, v): (S, &mut Stages<N, N>),
        field: &dyn VectorField<N>,
        t: (f64, f64),
        y0: &State<N>,
    ) -> Result<(State<N>, Jacobian<N>)> {
        let (here, h) = self.start(field, t, y0, Linearisation::new)?;
        let tolerances = self.tolerances;
        let bundle =
            Bundle::<_, N, KEPT>::new((scheme, v), field, tolerances, &mut self.work, *y0, here);
        let mut bundle = bundle.ok_or(Error::NonFinite {
            what: "the second derivative of the right-hand side",
            t: t.0,
        })?;
        drive(&mut bundle, t, h, self.max_steps, |_, _| {
            Ok(Control::Continue)
        })?;
        Ok(bundle.state_and_tangent())
    }
}

impl<const N: usize> Integrator<N> for Rosenbrock<N> {
    fn name(&self) -> &'static str {
        self.method.tableau().name
    }

    fn flow(
        &mut self,
        field: &dyn VectorField<N>,
        t: (f64, f64),
        y0: &State<N>,
        observer: Option<Observer<'_, N>>,
    ) -> Result<State<N>> {
        self.work = Work::default();
        check_times(t)?;
        if const { written_out(N) } {
            match self.method {
                RosenbrockMethod::Rodas5P => self.flow_by(Compiled::<0>, field, t, y0, observer),
                RosenbrockMethod::Rodas4 => self.flow_by(Compiled::<1>, field, t, y0, observer),
                RosenbrockMethod::Ros23 => self.flow_by(Compiled::<2>, field, t, y0, observer),
            }
        } else {
            self.flow_by(self.method, field, t, y0, observer)
        }
    }

    fn tangent_flow(
        &mut self,
        field: &dyn VectorField<N>,
        t: (f64, f64),
        y0: &State<N>,
    ) -> Result<(State<N>, Jacobian<N>)> {
        self.work = Work::default();
        check_times(t)?;
        if N > Self::MAX_TANGENT_DIMENSION {
            return Err(Error::parameter(
                "the dimension",
                N,
                "at most 24 for the tangent flow of a Rosenbrock method",
            ));
        }
        if const { N > SMALL } {
            return self.tangent_flow_of_many(field, t, y0);
        }
        let mut stages = [Jacobian::zeros(); MAX_STAGES];
        let v = &mut stages;
        if const { written_out(N) } {
            match self.method {
                RosenbrockMethod::Rodas5P => {
                    self.tangent_flow_by::<_, N>((Compiled::<0>, v), field, t, y0)
                }
                RosenbrockMethod::Rodas4 => {
                    self.tangent_flow_by::<_, N>((Compiled::<1>, v), field, t, y0)
                }
                RosenbrockMethod::Ros23 => {
                    self.tangent_flow_by::<_, N>((Compiled::<2>, v), field, t, y0)
                }
            }
        } else {
            self.tangent_flow_by::<_, N>((self.method, v), field, t, y0)
        }
    }

    fn work(&self) -> Work {
        self.work
    }
}

pub(super) fn check_times(t: (f64, f64)) -> Result<()> {
    for (name, time) in [("start time", t.0), ("end time", t.1)] {
        if !time.is_finite() {
            return Err(Error::parameter(name, time, "finite"));
        }
    }
    Ok(())
}
