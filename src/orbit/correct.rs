//! The corrector of the continuation: Newton's method for a periodic orbit that meets as many conditions as there are free
//! parameters.
//!
//! The equations of the orbit alone leave it free to move in as many directions as there are parameters. The correction closes
//! the orbit and moves it in these directions until the conditions hold: a plane for a step of pseudo-arclength continuation,
//! a test function for a bifurcation, a value for a parameter. At folds nothing special happens.

use super::arc::Tracer;
use super::conditions::{Condition, KnownSpectrum, checked, is_function, weights};
use super::continuation_point::{ContinuationPoint, TangentVector};
use super::family::ParametrisedField;
use super::goal::Goal;
use super::gradients::{carried, test_function};
use super::linear::{Free, Linear};
use super::multipliers::eigenvalues_of;
use super::periodic_schur::LogEigenvalue;
use super::shooting_nodes::ShootingNodes;
use super::stiffness::method_for;
use super::test_function::Spectrum;
use crate::error::{Error, Result};
use crate::field::Matrix;
use crate::integrate::{Choice, MAX_STEPS};
use std::sync::Arc as Shared;

/// An orbit with what is known of its surroundings.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct Regular {
    /// Where it is.
    pub site: ContinuationPoint,
    /// Directions in which it can move, orthonormal: one for each free parameter.
    pub along: Vec<TangentVector>,
    /// Its spectrum.
    pub spectrum: Spectrum,
    /// The gradients of the test functions among the conditions, in the order of these, as tangent vectors.
    pub gradients: Vec<TangentVector>,
    /// Iterations that it took.
    pub iterations: usize,
    /// The first correction: how far the guess was off.
    pub first: f64,
    /// The last correction: the largest of a node, a duration and a parameter's coordinate.
    pub residual: f64,
    pub(super) linear: Shared<Linear>,
}

impl Regular {
    /// ln |mu| of all nontrivial multipliers, the largest first; not numbers where the maps do not tell them.
    pub fn log_multipliers(&self) -> Vec<f64> {
        let spectrum = &self.spectrum;
        if let Ok(both) = spectrum.log_multipliers() {
            return both.to_vec();
        }
        if spectrum.dimension == 2 {
            return vec![spectrum.volume];
        }
        let all = self.multipliers();
        let known = all.map(|all| all.iter().map(|one| one.ln_abs).collect());
        known.unwrap_or_else(|| vec![f64::NAN; spectrum.dimension - 1])
    }

    /// Whether a multiplier is so near to 1 that a branch point may be next to this orbit.
    pub(crate) fn branches_nearby(&self) -> bool {
        /// Of ln mu.
        const NEAR: f64 = 1.0;
        let near = |one: &LogEigenvalue| one.ln_abs.abs() < NEAR && one.arg.abs() < NEAR;
        self.multipliers().is_none_or(|all| all.iter().any(near))
    }

    /// All nontrivial multipliers, the largest modulus first.
    pub(crate) fn multipliers(&self) -> Option<Vec<LogEigenvalue>> {
        eigenvalues_of(&self.linear.maps)
    }
}

/// Corrections below this that have ceased to shrink are the flow's own noise; a first one below the second leaves nothing else.
const NOISE: f64 = 1e-8;
const NEXT_TO_NOTHING: f64 = 1e-12;
/// Indicators that are farther from zero than this ask for them too.
const NEAR: f64 = 1.0;
/// What a relative change of an arc's duration counts, where steps are chosen: the shortest arcs change by most.
const STRETCH: f64 = 0.1;
/// A correction of the time to the next plane that is a longer way there, in parts of the extents, is more than its slope says.
const ARRIVED: f64 = 1e-4;
/// Corrections larger than this are made with coarse flows, of orbits that are larger than this.
const FAR: f64 = 1e-4;
const LARGE: f64 = 0.1;
/// Newton's method is given up if, from this iteration on, a correction exceeds both the first of these and the second times the correction two
/// iterations before.
const STUCK: (f64, f64, usize) = (1e-2, 0.5, 4);
/// A correction that shrinks by less than this asks for new gradients.
const SLOW: f64 = 0.02;

/// What makes orbits of a family.
pub struct Corrector<'a> {
    /// The family.
    pub family: &'a dyn ParametrisedField,
    /// What makes its arcs.
    pub tracer: Tracer,
    /// The tolerances of an explicit and of an implicit method, and the bounds on the steps of an arc and of all, where the method is the one for each
    /// orbit.
    for_each: Option<([f64; 2], (usize, usize))>,
    /// Whether corrections begin with coarse flows.
    coarse: bool,
}

impl<'a> Corrector<'a> {
    /// With a Taylor method of this tolerance, or an implicit one for stiff orbits.
    ///
    /// # Errors
    /// [`crate::Error::Parameter`] for a tolerance outside its domain.
    pub fn new(family: &'a dyn ParametrisedField, tolerance: f64) -> crate::Result<Self> {
        let alone = (MAX_STEPS, usize::MAX);
        Self::within(family, tolerance, alone)
    }

    /// The same for no more than so many steps in an arc, and about so many in all.
    ///
    /// # Errors
    /// As of [`Self::new`].
    pub fn within(
        family: &'a dyn ParametrisedField,
        tolerance: f64,
        steps: (usize, usize),
    ) -> crate::Result<Self> {
        Ok(Corrector {
            family,
            tracer: Tracer::limited(tolerance, steps.0, steps.1)?,
            for_each: family.is_any_system().then_some(([tolerance; 2], steps)),
            coarse: true,
        })
    }

    /// With a Taylor method of the first of these tolerances, or an implicit one of the second for stiff orbits.
    ///
    /// # Errors
    /// As of [`Self::new`].
    pub fn with_tolerances(
        family: &'a dyn ParametrisedField,
        tolerances: [f64; 2],
    ) -> crate::Result<Self> {
        let mut made = Self::new(family, tolerances[0])?;
        if let Some((of_methods, _)) = &mut made.for_each {
            *of_methods = tolerances;
        }
        Ok(made)
    }

    /// With any method. Where it makes no derivatives in the parameters they are differences of its flows, which Newton's method
    /// needs but to converge.
    pub fn by(family: &'a dyn ParametrisedField, tracer: Tracer) -> Self {
        Corrector {
            family,
            tracer,
            for_each: None,
            coarse: true,
        }
    }

    /// The linearisation at a site, with the derivatives in these of the parameters that span the plane.
    pub(super) fn linear(&mut self, site: &ContinuationPoint, free: &[usize]) -> Option<Linear> {
        self.linear_in(None, site, free)
    }

    /// The same in the planes of an orbit nearby, if one is given.
    fn linear_in(
        &mut self,
        planes: Option<&Linear>,
        site: &ContinuationPoint,
        free: &[usize],
    ) -> Option<Linear> {
        let (family, tracer) = (self.family, &mut self.tracer);
        let field = family.field(site.at);
        let places = Free {
            of_plane: free,
            plane: family.plane(),
        };
        let linear = match planes {
            None => Linear::of(tracer, family, &field, &site.shooting, places),
            Some(planes) => planes.beside(tracer, &field, &site.shooting, places),
        };
        let mut linear = linear.ok()?;
        drop(field);
        if !self.tracer.differentiates() {
            self.difference(site, free, &mut linear)?;
        }
        Some(linear)
    }

    /// The derivatives in the parameters by central differences.
    fn difference(
        &mut self,
        site: &ContinuationPoint,
        free: &[usize],
        linear: &mut Linear,
    ) -> Option<()> {
        /// In the coordinates of the parameters.
        const APART: f64 = 1e-5;
        let scale = self.family.scale(site.at);
        let arcs = Shared::make_mut(&mut linear.arcs);
        for arc in arcs.iter_mut() {
            arc.parameters = Matrix::zeros(arc.end.len(), free.len());
        }
        for (column, &i) in free.iter().enumerate() {
            let beside = |step: f64| {
                let mut at = site.at;
                at[i] += step;
                self.family.field(at)
            };
            let (below, above) = (beside(-APART), beside(APART));
            let ShootingNodes { nodes, durations } = &site.shooting;
            for (k, (x, &duration)) in nodes.iter().zip(durations).enumerate() {
                let low = self.tracer.flow(&below, x, duration, None).ok()?;
                let high = self.tracer.flow(&above, x, duration, None).ok()?;
                let slope = (high - low) / (2.0 * APART * scale[i]);
                arcs[k].parameters.set_column(column, &slope);
            }
        }
        Some(())
    }

    /// The orbit near `guess` that meets the conditions, one for each of the free parameters.
    ///
    /// # Errors
    /// [`Error::NotConverged`] where Newton's method finds none; [`Error::Dimension`] where a test function among the conditions is
    /// no test function in so many dimensions; [`Error::Parameter`] where the nodes have others.
    pub fn correct(
        &mut self,
        guess: ContinuationPoint,
        free: &[usize],
        conditions: &[Condition<'_>],
        goal: Goal,
    ) -> Result<Regular> {
        self.correct_in(None, guess, free, conditions, goal)
    }

    /// The same by displacements in the planes of an orbit nearby. On a slow manifold the flow turns at a small distance from it, and the planes
    /// across the flow at nodes that are off by that would turn from one iteration to the next.
    ///
    /// # Errors
    /// Those of [`Self::correct`].
    pub fn correct_beside(
        &mut self,
        orbit: &Regular,
        guess: ContinuationPoint,
        free: &[usize],
        conditions: &[Condition<'_>],
        goal: Goal,
    ) -> Result<Regular> {
        self.correct_in(Some(&orbit.linear), guess, free, conditions, goal)
    }

    /// Takes the method for the orbits near a guess, as every correction does.
    ///
    /// # Errors
    /// As of [`Self::within`].
    pub fn suit(&mut self, guess: &ContinuationPoint) -> Result<()> {
        let Some(([explicit, implicit], steps)) = self.for_each else {
            return Ok(());
        };
        let field = self.family.field(guess.at);
        let method = method_for(&field, &guess.shooting);
        let tolerance = match method {
            Choice::Radau => implicit,
            _ => explicit,
        };
        if method.name() != self.tracer.name() {
            self.tracer = Tracer::for_orbit(method, tolerance, steps)?;
        }
        Ok(())
    }

    fn correct_in(
        &mut self,
        planes: Option<&Linear>,
        guess: ContinuationPoint,
        free: &[usize],
        conditions: &[Condition<'_>],
        goal: Goal,
    ) -> Result<Regular> {
        checked(conditions, self.family.dimension())?;
        guess.shooting.checked(self.family.dimension())?;
        self.suit(&guess)?;
        let mut reached = (0, f64::INFINITY);
        let tested = conditions.iter().any(is_function);
        let is_large = guess.shooting.extent() > LARGE;
        let coarse = self.coarse && planes.is_some() && is_large && !tested;
        let again = coarse.then(|| guess.clone());
        let from = (planes, guess);
        let mut found = self.newton(from, free, conditions, (goal, coarse), &mut reached);
        // If the last correction was larger than this, coarse flows are not the cause of the failure.
        let by_flows = reached.0 == 0 || reached.1 < STUCK.0;
        if let (None, Some(again), true) = (&found, again, by_flows) {
            let from = (planes, again);
            found = self.newton(from, free, conditions, (goal, false), &mut reached);
            // Where the fine flows have found what the coarse ones did not they are used from now on.
            self.coarse = found.is_none();
        }
        found.ok_or(Error::NotConverged {
            what: "the periodic orbit",
            iterations: reached.0,
            residual: reached.1,
            tolerance: goal.done,
        })
    }

    /// The same, beginning with coarse flows or not; `reached` are the iterations made and the last correction.
    fn newton(
        &mut self,
        (planes, guess): (Option<&Linear>, ContinuationPoint),
        free: &[usize],
        conditions: &[Condition<'_>],
        (goal, coarse): (Goal, bool),
        reached: &mut (usize, f64),
    ) -> Option<Regular> {
        let mut site = guess;
        let mut gradients: Option<Vec<TangentVector>> = None;
        let mut ways = Vec::new();
        let (mut first, mut before, mut last) = (f64::INFINITY, f64::INFINITY, f64::INFINITY);
        let tested = conditions.iter().any(is_function);
        // What the next correction will be.
        let mut expected = f64::INFINITY;
        for iterations in 1..=goal.iterations {
            let coarse = coarse && expected > FAR;
            self.tracer.coarsely(coarse);
            let made = self.linear_at(planes, &mut site, &ways, free);
            self.tracer.coarsely(false);
            let linear = made?;
            let (closing, along) = linear.solutions(free, self.family.scale(site.at))?;
            let spectrum = tested.then(|| Spectrum::new(&linear));
            let (known, by_closing) = match &spectrum {
                None => (Vec::new(), Vec::new()),
                Some(spectrum) => {
                    let known = match gradients.take() {
                        Some(known) => known,
                        None => self.gradients(&site, &linear, &along, spectrum, conditions)?,
                    };
                    let closed = self.by_closing(&site, &linear, &closing, spectrum, conditions)?;
                    (known, closed)
                }
            };
            let known_here = KnownSpectrum {
                spectrum: spectrum.as_ref(),
                gradients: &known,
                by_closing: &by_closing,
            };
            let weights = weights(
                &site,
                &closing,
                &along,
                conditions,
                &known_here,
                self.family,
            )?;
            let mut correction = closing;
            for (weight, direction) in weights.iter().zip(&along) {
                correction = correction.plus(*weight, direction);
            }
            let (size, stretch) = site.size(&correction);
            *reached = (iterations, size.max(stretch));
            if !(size < goal.largest && stretch < goal.largest) {
                return None;
            }
            if iterations == 1 {
                first = size.max(STRETCH * stretch);
            }
            let size = size.max(stretch);
            if iterations >= STUCK.2 && size > STUCK.0.max(STUCK.1 * before) {
                return None;
            }
            // What a step of quadratic convergence leaves, by how the last one went.
            let left = size * (size / last).powi(2);
            let left_is_small = iterations == 1 || size < NOISE || left < goal.done.powi(2);
            let small = (size < goal.done && left_is_small)
                || (size < NOISE && size > 0.3 * last)
                || (iterations == 1 && size < NEXT_TO_NOTHING);
            // What is only looked at roughly the coarse flows tell.
            let done = small && (!coarse || goal.done > FAR);
            expected = if iterations == 1 { size.powi(2) } else { left };
            ways = linear.ways(&site.shooting, &correction.durations);
            site = site.moved(&correction, 1.0);
            if site.shooting.durations.iter().any(|&t| t <= 0.0) {
                return None;
            }
            if done {
                let (linear, along, gradients) = match planes {
                    None => (linear, along, known),
                    Some(_) => {
                        let field = self.family.field(site.at);
                        let upright = linear.upright(self.family, &field, &site.shooting);
                        let (_, turned) = upright.solutions(free, self.family.scale(site.at))?;
                        let as_before = |one| linear.in_planes(&field, &site.shooting, one);
                        let before: Vec<_> = turned.iter().map(as_before).collect();
                        let carried = |gradient| carried(gradient, (&along, &before), &turned);
                        let gradients = known.iter().map(carried).collect::<Option<_>>()?;
                        (upright, turned, gradients)
                    }
                };
                return Some(Regular {
                    spectrum: Spectrum::new(&linear),
                    site,
                    along,
                    gradients,
                    iterations,
                    first,
                    residual: size,
                    linear: Shared::new(linear),
                });
            }
            // Old gradients serve as long as the corrections shrink, and the test functions are no longer far from zero.
            let near = spectrum.is_some_and(|spectrum| {
                let all = conditions.iter().filter_map(test_function);
                all.map(|i| i.of(&spectrum).abs()).fold(0.0, f64::max) < NEAR
            });
            // Those of the user's functions cost little, and what they are told to hold shows in every row.
            let users = |one: &Condition<'_>| matches!(one, Condition::UserFunction(_));
            let near = near && !conditions.iter().any(users);
            gradients = (near && size < SLOW * last).then_some(known);
            (before, last) = (last, size);
        }
        None
    }

    /// The linearisation at a site in the planes of an orbit nearby, if one is given: then with the durations until the flow arrives there, but for the
    /// arcs whose last corrections were short ways.
    fn linear_at(
        &mut self,
        planes: Option<&Linear>,
        site: &mut ContinuationPoint,
        ways: &[f64],
        free: &[usize],
    ) -> Option<Linear> {
        if let Some(planes) = planes {
            let field = self.family.field(site.at);
            let normals = |k| planes.normal(k);
            let method = self.tracer.name();
            let steps = |k| planes.steps(k, method);
            let uncertain = |k: usize| ways.get(k).is_none_or(|&way| way > ARRIVED);
            let tracer = &mut self.tracer;
            let shooting = site.shooting.clone();
            site.shooting = shooting
                .arriving(tracer, &field, normals, steps, uncertain)
                .ok()??;
        }
        self.linear_in(planes, site, free)
    }

    /// A displacement of an orbit's nodes in their planes: moved along the flow.
    pub(crate) fn in_planes(&self, orbit: &Regular, displacement: &TangentVector) -> TangentVector {
        let ContinuationPoint { shooting, at } = &orbit.site;
        let field = self.family.field(*at);
        orbit.linear.in_planes(&field, shooting, displacement)
    }

    /// An orbit as it stands, with its surroundings and the gradients of the conditions' test functions.
    ///
    /// # Errors
    /// As of [`Self::correct`]: [`Error::NotConverged`] where the linear equations are singular.
    pub fn look(
        &mut self,
        site: ContinuationPoint,
        free: &[usize],
        conditions: &[Condition<'_>],
    ) -> Result<Regular> {
        checked(conditions, self.family.dimension())?;
        site.shooting.checked(self.family.dimension())?;
        let looked = self
            .linear(&site, free)
            .and_then(|linear| self.look_with(site, linear, free, conditions));
        looked.ok_or(Error::NotConverged {
            what: "the directions in which the periodic orbit can move",
            iterations: 0,
            residual: f64::INFINITY,
            tolerance: Goal::STEP.done,
        })
    }

    /// The same where the linearisation is known.
    pub(super) fn look_with(
        &mut self,
        site: ContinuationPoint,
        linear: Linear,
        free: &[usize],
        conditions: &[Condition<'_>],
    ) -> Option<Regular> {
        let (closing, along) = linear.solutions(free, self.family.scale(site.at))?;
        let spectrum = Spectrum::new(&linear);
        let gradients = self.gradients(&site, &linear, &along, &spectrum, conditions)?;
        Some(Regular {
            first: site.size(&closing).0,
            residual: site.size(&closing).0,
            site,
            along,
            spectrum,
            gradients,
            iterations: 0,
            linear: Shared::new(linear),
        })
    }
}
