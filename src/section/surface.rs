//! Poincare sections of the phase space by a plane, and the return map from the section to itself that a flow makes.
//!
//! The plane lies in the variables x that power series are made in, (tau, psi) for the interfaces, where a crossing is a root
//! of a polynomial: it is landed on to the last digits, and none is missed. The paper's section is tau = tau_ss(V_H/2) (4.3.1).

use crate::error::{Error, Result};
use crate::field::{Jacobian, State, VectorField};
use crate::friction::{Law, steady_stress};
use crate::integrate::{Control, Integrator, Taylor};
use crate::number::{DoubleDouble, polynomial::Crossing};
use crate::series::{Section, Zeros};
use nalgebra::DMatrix;

/// From the state that a field is integrated in to the variables of its series.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SeriesVariables {
    /// They are the same.
    Plain,
    /// (tau, ln psi, ..) to (tau, psi, ..).
    LogStates,
}

impl SeriesVariables {
    /// The variables at a state.
    pub fn variables<const N: usize>(self, y: &State<N>) -> State<N> {
        State::from_fn(|i, _| self.variable(y, i))
    }

    fn variable<const N: usize>(self, y: &State<N>, i: usize) -> f64 {
        match self {
            SeriesVariables::LogStates if i > 0 => y[i].exp(),
            _ => y[i],
        }
    }

    /// The derivative of each variable in its component of the state.
    fn slopes<const N: usize>(self, y: &State<N>) -> State<N> {
        State::from_fn(|i, _| match self {
            SeriesVariables::LogStates if i > 0 => y[i].exp(),
            _ => 1.0,
        })
    }
}

/// A plane normal . x = offset that a flow crosses in one direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Surface<const N: usize> {
    /// The normal, in the variables of the series.
    pub normal: [f64; N],
    /// normal . x on the plane.
    pub offset: f64,
    /// [`Crossing::Upwards`] or [`Crossing::Downwards`] along the normal.
    pub direction: Crossing,
    /// What the variables are.
    pub chart: SeriesVariables,
}

/// tau_ss of the mean slip rate: the stress of the symmetric steady state, and the section of the paper.
pub fn half_driving_stress(law: &impl Law, driving: f64, interfaces: usize) -> f64 {
    steady_stress(law, driving / interfaces as f64)
}

impl<const N: usize> Surface<N> {
    /// tau = const, in (tau, ln psi, ..).
    pub fn stress(tau: f64, direction: Crossing) -> Self {
        let mut normal = [0.0; N];
        normal[0] = 1.0;
        Surface {
            normal,
            offset: tau,
            direction,
            chart: SeriesVariables::LogStates,
        }
    }

    /// normal . x - offset at a state.
    pub fn height(&self, y: &State<N>) -> f64 {
        // Of a plane of constant stress, without the exponentials.
        let terms = (0..N).filter(|&i| self.normal[i] != 0.0);
        terms
            .map(|i| self.normal[i] * self.chart.variable(y, i))
            .sum::<f64>()
            - self.offset
    }

    /// Whether a step that begins at y and in which the first component strays no farther than `reach` may pass the plane.
    pub(crate) fn within(&self, y: &State<N>, reach: f64) -> bool {
        /// For the rounding of the bound.
        const MARGIN: f64 = 1.000_001;
        // Of the other components nothing is known.
        self.normal[1..].iter().any(|x| *x != 0.0)
            || self.height(y).abs() <= MARGIN * reach * self.normal[0].abs()
    }

    /// Its derivative in the state.
    pub(crate) fn gradient(&self, y: &State<N>) -> State<N> {
        State::from(self.normal).component_mul(&self.chart.slopes(y))
    }

    /// The plane as the series know it.
    pub fn section(&self) -> Section<N> {
        Section::Plane {
            normal: self.normal,
            offset: self.offset,
        }
    }

    /// The sign of the height just after a crossing.
    pub(crate) fn sign_behind(&self) -> f64 {
        match self.direction {
            Crossing::Downwards => -1.0,
            Crossing::Upwards | Crossing::Touching => 1.0,
        }
    }

    /// N - 1 orthonormal directions within the surface at a state, as columns.
    pub(crate) fn directions(&self, y: &State<N>) -> DMatrix<f64> {
        let normal = self.gradient(y).normalize();
        // The axes without the one closest to the normal, made orthogonal to it and to each other.
        let closest = normal.iamax();
        let mut columns: Vec<State<N>> = Vec::with_capacity(N - 1);
        for axis in (0..N).filter(|&axis| axis != closest) {
            let mut e = State::<N>::zeros();
            e[axis] = 1.0;
            for against in std::iter::once(&normal).chain(&columns) {
                e -= against * against.dot(&e);
            }
            columns.push(e.normalize());
        }
        DMatrix::from_fn(N, N - 1, |i, j| columns[j][i])
    }

    /// The point of the surface near a state that is almost on it.
    pub fn nearest(&self, y: &State<N>) -> State<N> {
        /// Newton's method on one equation that is nearly linear.
        const ITERATIONS: usize = 6;
        let mut y = *y;
        for _ in 0..ITERATIONS {
            let gradient = self.gradient(&y);
            y -= gradient * (self.height(&y) / gradient.norm_squared());
        }
        y
    }
}

/// Where the return map leads.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Landing<const N: usize> {
    /// The time it takes.
    pub time: f64,
    /// The point on the section.
    pub state: State<N>,
    /// The derivative of the map: it takes directions within the section to such directions.
    pub derivative: Jacobian<N>,
}

/// Steps of a piece of the way over which a derivative is taken at once.
pub(crate) const STEPS_OF_PIECE: usize = 6;

/// The return map from a point of the section: the next crossing in the surface's direction, after at most `patience`.
///
/// Its derivative is the product of those from section to section along the way. Over the whole way at once it would be lost:
/// along the flow perturbations grow as its speed does, which in stick-slip is by ten orders, and back.
///
/// # Errors
/// [`Error::NoReturn`], and those of [`Taylor::derivatives`].
///
/// ```
/// use twinslip::field::State;
/// use twinslip::friction::{AnyLaw, Parameters};
/// use twinslip::integrate::{MAX_STEPS, Taylor, Tolerances};
/// use twinslip::model::{Loading, two_interfaces};
/// use twinslip::number::polynomial::Crossing;
/// use twinslip::section::{Surface, half_driving_stress, return_map};
/// # fn main() -> twinslip::Result<()> {
/// let law = AnyLaw::Spinodal(Parameters::heslot_1994().spinodal());
/// let field = two_interfaces(law, Loading::new(0.12, 0.14)?);
/// let surface = Surface::<3>::stress(half_driving_stress(&law, 0.12, 2), Crossing::Downwards);
/// let mut taylor = Taylor::new(Tolerances::equal(1e-12)?, MAX_STEPS)?;
/// let mut y = State::<3>::new(surface.offset, -4.0, -3.5);
/// for _ in 0..100 {
///     y = return_map(&*field, &surface, &mut taylor, &y, 2e4)?.state;
/// }
/// // The stick-slip cycle is a fixed point.
/// let again = return_map(&*field, &surface, &mut taylor, &y, 2e4)?;
/// assert!((again.state - y).amax() < 1e-8);
/// # Ok(())
/// # }
/// ```
pub fn return_map<const N: usize>(
    field: &dyn VectorField<N>,
    surface: &Surface<N>,
    taylor: &mut Taylor,
    from: &State<N>,
    patience: f64,
) -> Result<Landing<N>> {
    let section = surface.section();
    let mut zeros = Zeros::default();
    zeros.sign = surface.sign_behind();
    let mut found = Vec::new();
    let (mut lowest, mut highest) = (f64::INFINITY, f64::NEG_INFINITY);
    let (mut steps, mut now) = (0, DoubleDouble::ZERO);
    let mut points = vec![(now, *from)];
    taylor.flow(
        field,
        (0.0, patience),
        from,
        Some(&mut |step| {
            let height = surface.height(step.y1);
            (lowest, highest) = (lowest.min(height), highest.max(height));
            let series = step.series().ok_or(Error::NotAnalytic)?;
            series.crossings(&section, Some(surface.direction), &mut zeros, &mut found);
            if let Some(passage) = found.first() {
                now = series.begin + passage.time;
                return Ok(Control::Stop);
            }
            steps += 1;
            if steps % STEPS_OF_PIECE == 0 {
                points.push((series.begin + series.length, *step.y1));
            }
            Ok(Control::Continue)
        }),
    )?;
    let Some(passage) = found.first() else {
        return Err(Error::NoReturn {
            since: 0.0,
            t: patience,
            section: surface.offset,
            lowest: surface.offset + lowest,
            highest: surface.offset + highest,
        });
    };
    let (_, derivative) = derivative_along(field, surface, taylor, &points, now)?;
    Ok(Landing {
        time: now.hi(),
        state: State::from(passage.state),
        derivative,
    })
}

/// The derivative of the map that leads from the first of these points, through the others, to the surface at the time `now`,
/// after the last of them; and the state there.
pub(crate) fn derivative_along<const N: usize>(
    field: &dyn VectorField<N>,
    surface: &Surface<N>,
    taylor: &mut Taylor,
    points: &[(DoubleDouble, State<N>)],
    now: DoubleDouble,
) -> Result<(State<N>, Jacobian<N>)> {
    let mut derivative = Jacobian::<N>::identity();
    let mut state = State::zeros();
    for (k, (begin, y)) in points.iter().enumerate() {
        let next = points.get(k + 1);
        let end = next.map_or(now, |(end, _)| *end);
        let span = (0.0, (end - *begin).hi());
        let (to, tangent) = taylor.derivatives(field, span, y, &[])?;
        state = to;
        let f = field.f(&to);
        // Between, the section that the flow crosses at a right angle.
        let gradient = next.map_or_else(|| surface.gradient(&to), |_| f);
        derivative = Jacobian::from(tangent.start) * derivative;
        // A perturbation arrives earlier or later: what it moves across the section is taken back along the flow.
        derivative -= f * (gradient.transpose() * derivative) / gradient.dot(&f);
    }
    Ok((state, derivative))
}
