//! What the errors of the flow make of an orbit: its linear equations with random errors of the size of those of the arcs.
//!
//! Rounding errors of the steps add up like a random walk, with the square root of their number; a bound that adds up all of
//! them is a hundred times too wide. So the standard deviation of what is solved for is taken over a few such probes, whatever
//! the conditions are that the orbit meets. Of the truncation error, which is no noise, this knows nothing: the tolerance must
//! be of the order of rounding, or a second solution must tell.

use super::conditions::{Condition, combination};
use super::continuation_point::TangentVector;
use super::correct::{Corrector, Regular};
use super::linear::Linear;
use super::shooting::relative;
use super::shooting_nodes::ShootingNodes;
use super::test_function::{Spectrum, TestFunction};
use super::user_function;
use crate::field::{Matrix, Vector};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

/// Standard deviations of what an orbit's equations determine.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Noise {
    /// Of the coordinates of both parameters.
    pub parameters: [f64; 2],
    /// Of the period, relative.
    pub period: f64,
    /// Of the worst node, in units of 1 + |x|.
    pub nodes: f64,
}

impl Noise {
    /// Nothing is known.
    pub const UNKNOWN: Noise = Noise {
        parameters: [f64::INFINITY; 2],
        period: f64::INFINITY,
        nodes: f64::INFINITY,
    };
}

/// Relative errors of derivatives in units of that of the state.
pub(super) const TANGENT: f64 = 3.0;
/// Random errors that are tried: enough for a standard deviation to a third of itself.
pub(super) const PROBES: usize = 8;

/// Errors of either sign, the same ones each time.
pub(super) struct Signs(ChaCha8Rng);

impl Signs {
    pub fn new() -> Self {
        Signs(ChaCha8Rng::seed_from_u64(1))
    }

    pub fn next(&mut self) -> f64 {
        if self.0.next_u32() & 1 == 0 {
            1.0
        } else {
            -1.0
        }
    }
}

impl Linear {
    /// The same with errors of random sign: of the ends of all arcs in place of the gaps, and of their derivatives.
    pub(super) fn noisy(&self, shooting: &ShootingNodes, signs: &mut Signs) -> Self {
        let mut noisy = self.without_gaps();
        let count = self.arcs.len();
        for (k, arc) in self.arcs.iter().enumerate() {
            let size = arc.rounding();
            let next = &shooting.nodes[(k + 1) % count];
            noisy.gaps.push(Vector::from_fn(next.len(), |i, _| {
                size * (1.0 + next[i].abs()) * signs.next()
            }));
            let map = &mut noisy.maps[k];
            let sizes = graded(map);
            for i in 0..map.nrows() {
                for j in 0..map.ncols() {
                    map[(i, j)] += TANGENT * size * sizes[(i, j)] * signs.next();
                }
            }
            let logs = &mut noisy.logs[k];
            // By the trace of the Jacobian; else it is the map's.
            if arc.log_determinant.is_some() {
                logs.volume += TANGENT * size * logs.volume.abs() * signs.next();
            }
            if let Some(log) = &mut logs.transverse {
                *log += TANGENT * size * log.abs() * signs.next();
            }
        }
        noisy
    }
}

/// What the rounding of each entry of a map is relative to: what two maps like it make of their entries without their signs. Where
/// one variable hardly feels another all the way, rounding doesn't couple them, as errors relative to the whole map would.
pub(super) fn graded(map: &Matrix) -> Matrix {
    let sizes = map.abs();
    let passed = &sizes * &sizes / map.norm().max(f64::MIN_POSITIVE);
    passed.sup(&sizes)
}

impl Corrector<'_> {
    /// What the errors of the flow make of an orbit that meets these conditions, which it was corrected to. `None` where they do
    /// not determine it.
    pub(crate) fn noise(
        &mut self,
        orbit: &Regular,
        free: &[usize],
        conditions: &[Condition<'_>],
    ) -> Option<Noise> {
        let shooting = &orbit.site.shooting;
        let mut squares = Noise::default();
        let mut nodes = vec![0.0; shooting.nodes.len()];
        let mut signs = Signs::new();
        for _ in 0..PROBES {
            let noisy = orbit.linear.noisy(shooting, &mut signs);
            let tangent = self.answer(orbit, &noisy, free, conditions, &mut signs)?;
            for i in 0..2 {
                squares.parameters[i] += tangent.parameters[i].powi(2);
            }
            let [_, _, of_period] = tangent.seen_from_afar(shooting);
            squares.period += of_period * of_period;
            let moved = tangent.nodes.iter().zip(&shooting.nodes);
            for (sum, (dx, x)) in nodes.iter_mut().zip(moved) {
                *sum += relative(dx, x).powi(2);
            }
        }
        Some(Noise {
            parameters: squares.parameters.map(deviation),
            period: deviation(squares.period),
            nodes: deviation(nodes.into_iter().fold(0.0, f64::max)),
        })
    }

    /// The same of a test function at an orbit in this plane.
    pub(crate) fn noise_of(
        &mut self,
        test_function: TestFunction,
        orbit: &Regular,
        free: &[usize],
        plane: Condition<'_>,
    ) -> Option<f64> {
        let (mut sum, mut signs) = (0.0, Signs::new());
        for _ in 0..PROBES {
            let noisy = orbit.linear.noisy(&orbit.site.shooting, &mut signs);
            let tangent = self.answer(orbit, &noisy, free, &[plane], &mut signs)?;
            let changes = [orbit.direct(&noisy), self.by_tangent(orbit, &tangent)?];
            let change = changes.map(|by| test_function.change_along(&orbit.spectrum, &by));
            sum += (change[0] + change[1]).powi(2);
        }
        Some(deviation(sum))
    }

    /// How an orbit moves where the flow errs so and the conditions still hold.
    fn answer(
        &mut self,
        orbit: &Regular,
        noisy: &Linear,
        free: &[usize],
        conditions: &[Condition<'_>],
        signs: &mut Signs,
    ) -> Option<TangentVector> {
        // The directions are those without errors.
        let scale = self.family.scale(orbit.site.at);
        let (closing, along) = orbit.linear.closing(&noisy.gaps, free, scale)?;
        let test_functions = conditions
            .iter()
            .any(|condition| matches!(condition, Condition::TestFunction(_)));
        let of_spectrum = if test_functions {
            vec![orbit.direct(noisy), self.by_tangent(orbit, &closing)?]
        } else {
            Vec::new()
        };
        let mut gradients = orbit.gradients.iter();
        let mut rows = Vec::with_capacity(conditions.len());
        for condition in conditions {
            let slopes = |of: &dyn Fn(&TangentVector) -> f64| along.iter().map(of).collect();
            rows.push(match condition {
                Condition::Plane(across, _) => (slopes(&|t| across.dot(t)), -across.dot(&closing)),
                Condition::Parameter(i, _) => {
                    (slopes(&|t| t.parameters[*i]), -closing.parameters[*i])
                }
                Condition::UserFunction(which) => {
                    let gradient = gradients.next()?;
                    let (family, site) = (self.family, &orbit.site);
                    let change = user_function::slope(family, *which, site, &closing);
                    let own = user_function::rounding_at(family, *which, site);
                    (slopes(&|t| gradient.dot(t)), -change - own * signs.next())
                }
                Condition::TestFunction(test_function) => {
                    let gradient = gradients.next()?;
                    let change = |by| test_function.change_along(&orbit.spectrum, by);
                    let change: f64 = of_spectrum.iter().map(change).sum();
                    (slopes(&|t| gradient.dot(t)), -change)
                }
            });
        }
        let weights = combination(&rows)?;
        let mut tangent = closing;
        for (weight, direction) in weights.iter().zip(&along) {
            tangent = tangent.plus(*weight, direction);
        }
        Some(tangent)
    }
}

impl Regular {
    /// What errors of the derivatives make of the spectrum, the orbit as it is.
    fn direct(&self, noisy: &Linear) -> Spectrum {
        Spectrum::change(&self.linear, &self.spectrum, noisy, 1.0)
    }
}

fn deviation(squares: f64) -> f64 {
    (squares / PROBES as f64).sqrt()
}
