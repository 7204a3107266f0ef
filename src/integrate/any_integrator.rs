//! Methods of integration for fields of any dimension.

use super::any_field::{AnyField, of_dimension};
use super::any_step::AnyObserver;
use super::static_field::ArcByArc;
use super::{Choice, Radau, Taylor, Tolerances, Work};
use crate::error::Result;
use crate::field::{Matrix, Vector};

/// A method of integration for fields of any dimension.
#[derive(Debug, Clone)]
pub struct AnyIntegrator {
    pub(super) method: Method,
    name: &'static str,
    pub(super) work: Work,
}

/// Taylor's and Radau's methods know no dimension; the others are made where they are called.
#[derive(Debug, Clone)]
pub(super) enum Method {
    Taylor(Taylor),
    Radau(Radau),
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
    /// [`Error::Parameter`](crate::Error::Parameter) for tolerances outside their domain or no steps.
    pub fn new(choice: Choice, tolerances: Tolerances, max_steps: usize) -> Result<Self> {
        // The least of all integrators says whether these are allowed.
        let taylor = Taylor::new(tolerances, max_steps)?;
        let method = match choice {
            Choice::Taylor => Method::Taylor(taylor),
            Choice::Radau => Method::Radau(Radau::new(tolerances, max_steps)?),
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

    /// Taylor's method in double-double arithmetic ([`Taylor::reference`]), with this largest step.
    ///
    /// # Errors
    /// As there.
    pub fn reference(max_steps: usize, max_step: f64) -> Result<Self> {
        Ok(AnyIntegrator {
            method: Method::Taylor(Taylor::reference(max_steps)?.stepping(max_step)),
            name: Choice::Taylor.name(),
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
        !matches!(self.method, Method::Other { .. })
    }

    /// The state at `t.1` from `y0` at `t.0`.
    ///
    /// # Errors
    /// [`Error::Parameter`](crate::Error::Parameter) for a start of another dimension; those of
    /// [`Integrator::flow`](super::Integrator::flow).
    pub fn flow(
        &mut self,
        field: &AnyField<'_>,
        t: (f64, f64),
        y0: &Vector,
        observer: Option<AnyObserver<'_>>,
    ) -> Result<Vector> {
        self.work = Work::default();
        of_dimension(y0.len(), field.dimension())?;
        field.0.flow(self, t, y0.as_slice(), observer)
    }

    /// The state at `t.1` and its derivatives in `y0` and, of Taylor's method, in the parameters of these places.
    ///
    /// # Errors
    /// [`Error::Parameter`](crate::Error::Parameter) for a start of another dimension and for a place where there is no parameter;
    /// those of [`Integrator::flow`](super::Integrator::flow).
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
    /// [`Error::Parameter`](crate::Error::Parameter) for a place where there is no parameter,
    /// [`Error::NotAnalytic`](crate::Error::NotAnalytic) where the method asks for series.
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
