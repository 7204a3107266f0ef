//! Poincare sections of the phase space by a plane, and the return map from the section to itself that a flow makes.
//!
//! The plane lies in the variables x that power series are made in, (tau, psi) for the interfaces, where a crossing is a root
//! of a polynomial: it is landed on to the last digits, and none is missed. The paper's section is tau = tau_ss(V_H/2) (4.3.1).

use crate::error::{Error, Result};
use crate::field::{Matrix, Vector};
use crate::friction::{Law, steady_stress};
use crate::integrate::{AnyField, AnyIntegrator, Control, of_dimension};
use crate::number::{DoubleDouble, polynomial::Crossing};
use crate::series::{Section, Zeros};
use std::borrow::Cow;

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
    pub fn variables(self, y: &[f64]) -> Vector {
        Vector::from_fn(y.len(), |i, _| self.variable(y, i))
    }

    fn variable(self, y: &[f64], i: usize) -> f64 {
        match self {
            SeriesVariables::LogStates if i > 0 => y[i].exp(),
            _ => y[i],
        }
    }

    /// The derivative of a variable in its component of the state.
    fn slope(self, y: &[f64], i: usize) -> f64 {
        match self {
            SeriesVariables::LogStates if i > 0 => y[i].exp(),
            _ => 1.0,
        }
    }
}

/// A plane normal . x = offset that a flow crosses in one direction.
#[derive(Debug, Clone, PartialEq)]
pub struct Surface {
    /// The normal, in the variables of the series.
    pub normal: Vector,
    /// normal . x on the plane.
    pub offset: f64,
    /// [`Crossing::Upwards`] or [`Crossing::Downwards`] along the normal.
    pub direction: Crossing,
    /// What the variables are.
    pub chart: SeriesVariables,
    /// Where the normal is along the phase of a periodic forcing: a whole turn of it, after which the plane comes again.
    pub turn: Option<f64>,
}

/// tau_ss of the mean slip rate: the stress of the symmetric steady state, and the section of the paper.
pub fn half_driving_stress(law: &impl Law, driving: f64, interfaces: usize) -> f64 {
    steady_stress(law, driving / interfaces as f64)
}

impl Surface {
    /// tau = const, in (tau, ln psi, ..), so many variables in all.
    pub fn stress(dimension: usize, tau: f64, direction: Crossing) -> Self {
        Surface {
            normal: Vector::from_fn(dimension, |i, _| if i == 0 { 1.0 } else { 0.0 }),
            offset: tau,
            direction,
            chart: SeriesVariables::LogStates,
            turn: None,
        }
    }

    /// The stroboscopic section: one phase of a periodic forcing, whose place among so many variables and whole turn these are.
    pub fn stroboscopic(dimension: usize, (place, turn): (usize, f64), phase: f64) -> Self {
        Surface {
            normal: Vector::from_fn(dimension, |i, _| f64::from(u8::from(i == place))),
            offset: phase,
            direction: Crossing::Upwards,
            chart: SeriesVariables::Plain,
            turn: Some(turn),
        }
    }

    /// The same plane as it comes next after a state: turns later, where it comes again.
    pub(crate) fn ahead(&self, y: &[f64]) -> Cow<'_, Self> {
        /// Of a turn: a state that is nearer is on the plane.
        const ON: f64 = 1e-9;
        let Some(turn) = self.turn else {
            return Cow::Borrowed(self);
        };
        let phase = y[self.normal.iamax()];
        let passed = ((phase - self.offset) / turn + ON).floor();
        Cow::Owned(Surface {
            offset: self.offset + (passed + 1.0) * turn,
            turn: None,
            ..self.clone()
        })
    }

    /// A state of a plane that has come again, on the first.
    pub(crate) fn on_first(&self, mut state: Vec<f64>) -> Vec<f64> {
        if self.turn.is_some() {
            state[self.normal.iamax()] = self.offset;
        }
        state
    }

    /// normal . x - offset at a state; of a plane that comes again, to the nearest one.
    ///
    /// # Panics
    /// Where the state has fewer components than the normal.
    #[inline]
    pub fn height(&self, y: &[f64]) -> f64 {
        let mut sum = 0.0;
        for (i, &normal) in self.normal.as_slice().iter().enumerate() {
            // Of a plane of constant stress, without the exponentials.
            if normal != 0.0 {
                sum += normal * self.chart.variable(y, i);
            }
        }
        let height = sum - self.offset;
        match self.turn {
            None => height,
            Some(turn) => height - (height / turn).round() * turn,
        }
    }

    /// Whether a step that begins at y and in which the first component strays no farther than `reach` may pass the plane, where the
    /// height had this sign before.
    #[inline]
    pub(crate) fn may_be_passed(&self, y: &[f64], sign: f64, reach: f64) -> bool {
        /// For the rounding of the bound.
        const MARGIN: f64 = 1.000_001;
        if self.turn.is_some() {
            return true;
        }
        let (height, normal) = (self.height(y), self.normal.as_slice());
        // Of the other components nothing is known.
        height.signum() != sign
            || height.abs() <= MARGIN * reach * normal[0].abs()
            || normal[1..].iter().any(|x| *x != 0.0)
    }

    /// Its derivative in the state.
    pub(crate) fn gradient(&self, y: &[f64]) -> Vector {
        Vector::from_fn(self.normal.len(), |i, _| {
            self.normal[i] * self.chart.slope(y, i)
        })
    }

    /// How fast the height grows at a state that moves at this velocity.
    pub(crate) fn rate(&self, y: &[f64], velocity: &Vector) -> f64 {
        let mut sum = 0.0;
        for (i, &normal) in self.normal.as_slice().iter().enumerate() {
            // As of the height.
            if normal != 0.0 {
                sum += normal * self.chart.slope(y, i) * velocity[i];
            }
        }
        sum
    }

    /// The plane as the series know it.
    pub fn section(&self) -> Section<'_> {
        Section::Plane {
            normal: self.normal.as_slice(),
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

    /// Orthonormal directions within the surface at a state, one fewer than variables, as columns.
    pub(crate) fn directions(&self, y: &[f64]) -> Matrix {
        let n = self.normal.len();
        let normal = self.gradient(y).normalize();
        // The axes without the one closest to the normal, made orthogonal to it and to each other.
        let closest = normal.iamax();
        let mut columns: Vec<Vector> = Vec::with_capacity(n - 1);
        for axis in (0..n).filter(|&axis| axis != closest) {
            let mut e = Vector::zeros(n);
            e[axis] = 1.0;
            for against in std::iter::once(&normal).chain(&columns) {
                e -= against * against.dot(&e);
            }
            columns.push(e.normalize());
        }
        Matrix::from_fn(n, n - 1, |i, j| columns[j][i])
    }

    /// The point of the surface near a state that is almost on it.
    pub fn nearest(&self, y: &Vector) -> Vector {
        /// Newton's method on one equation that is nearly linear.
        const ITERATIONS: usize = 6;
        let mut y = y.clone();
        for _ in 0..ITERATIONS {
            let gradient = self.gradient(y.as_slice());
            let along = self.height(y.as_slice()) / gradient.norm_squared();
            y -= gradient * along;
        }
        y
    }
}

/// Where the return map leads.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Landing {
    /// The time it takes.
    pub time: f64,
    /// The point on the section.
    pub state: Vector,
    /// The derivative of the map: it takes directions within the section to such directions.
    pub derivative: Matrix,
}

/// Steps of a piece of the way over which a derivative is taken at once.
pub(crate) const STEPS_OF_PIECE: usize = 6;

/// The return map from a point of the section: the next crossing in the surface's direction, after at most `patience`, by
/// Taylor's method.
///
/// Its derivative is the product of those from section to section along the way. Over the whole way at once it would be lost:
/// along the flow perturbations grow as its speed does, which in stick-slip is by ten orders, and back.
///
/// # Errors
/// [`Error::NoReturn`], [`Error::Parameter`] for a surface or a point of another dimension than the field,
/// [`Error::NotAnalytic`] for methods other than Taylor's, and those of [`AnyIntegrator::derivatives`].
///
/// ```
/// use twinslip::field::Vector;
/// use twinslip::friction::{AnyLaw, Parameters};
/// use twinslip::integrate::{AnyField, AnyIntegrator, Choice, MAX_STEPS, Tolerances};
/// use twinslip::model::{Loading, two_interfaces};
/// use twinslip::number::polynomial::Crossing;
/// use twinslip::section::{Surface, half_driving_stress, return_map};
/// # fn main() -> twinslip::Result<()> {
/// let law = AnyLaw::Spinodal(Parameters::heslot_1994().spinodal());
/// let field = AnyField::new::<3>(two_interfaces(law, Loading::new(0.12, 0.14)?));
/// let surface = Surface::stress(3, half_driving_stress(&law, 0.12, 2), Crossing::Downwards);
/// let mut taylor = AnyIntegrator::new(Choice::Taylor, Tolerances::equal(1e-12)?, MAX_STEPS)?;
/// let mut y = Vector::from_vec(vec![surface.offset, -4.0, -3.5]);
/// for _ in 0..100 {
///     y = return_map(&field, &surface, &mut taylor, &y, 2e4)?.state;
/// }
/// // The stick-slip cycle is a fixed point.
/// let again = return_map(&field, &surface, &mut taylor, &y, 2e4)?;
/// assert!((again.state - y).amax() < 1e-8);
/// # Ok(())
/// # }
/// ```
pub fn return_map(
    field: &AnyField<'_>,
    surface: &Surface,
    by: &mut AnyIntegrator,
    from: &Vector,
    patience: f64,
) -> Result<Landing> {
    of_dimension(surface.normal.len(), field.dimension())?;
    let plane = surface.ahead(from.as_slice());
    let section = plane.section();
    let mut zeros = Zeros::default();
    zeros.sign = match surface.turn {
        None => surface.sign_behind(),
        // Before the plane that comes next.
        Some(_) => -surface.sign_behind(),
    };
    let mut found = Vec::new();
    let (mut lowest, mut highest) = (f64::INFINITY, f64::NEG_INFINITY);
    let (mut steps, mut now) = (0, DoubleDouble::ZERO);
    let mut points = vec![(now, from.clone())];
    by.flow(
        field,
        (0.0, patience),
        from,
        Some(&mut |step| {
            let height = surface.height(step.y1);
            (lowest, highest) = (lowest.min(height), highest.max(height));
            let series = step.series().ok_or(Error::NotAnalytic)?;
            series.crossings(section, Some(surface.direction), &mut zeros, &mut found);
            if let Some(passage) = found.first() {
                now = series.begin() + passage.time;
                return Ok(Control::Stop);
            }
            steps += 1;
            if steps % STEPS_OF_PIECE == 0 {
                points.push((
                    series.begin() + series.length(),
                    Vector::from_column_slice(step.y1),
                ));
            }
            Ok(Control::Continue)
        }),
    )?;
    let Some(passage) = found.into_iter().next() else {
        return Err(Error::NoReturn {
            since: 0.0,
            t: patience,
            section: surface.offset,
            lowest: surface.offset + lowest,
            highest: surface.offset + highest,
        });
    };
    let (_, derivative) = derivative_along(field, surface, by, &points, now)?;
    Ok(Landing {
        time: now.hi(),
        state: Vector::from_vec(surface.on_first(passage.state)),
        derivative,
    })
}

/// The derivative of the map that leads from the first of these points, through the others, to the surface at the time `now`,
/// after the last of them; and the state there.
pub(crate) fn derivative_along(
    field: &AnyField<'_>,
    surface: &Surface,
    by: &mut AnyIntegrator,
    points: &[(DoubleDouble, Vector)],
    now: DoubleDouble,
) -> Result<(Vector, Matrix)> {
    let n = field.dimension();
    let mut derivative = Matrix::identity(n, n);
    let mut state = Vector::zeros(n);
    let mut arcs = by.arcs(field, &[])?;
    for (k, (begin, y)) in points.iter().enumerate() {
        let next = points.get(k + 1);
        let end = next.map_or(now, |(end, _)| *end);
        let span = (0.0, (end - *begin).hi());
        let (to, tangent) = arcs.derivatives(span, y)?;
        state = to;
        let f = field.f(&state);
        // Between, the section that the flow crosses at a right angle.
        let gradient = match next {
            Some(_) => f.clone(),
            None => surface.gradient(state.as_slice()),
        };
        derivative = tangent.start * derivative;
        // A perturbation arrives earlier or later: what it moves across the section is taken back along the flow.
        derivative -= &f * (gradient.transpose() * &derivative) / gradient.dot(&f);
    }
    Ok((state, derivative))
}
