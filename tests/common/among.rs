//! Systems of three equations in more dimensions.

use std::f64::consts::TAU;
use twinslip::field::{State, Vector};
use twinslip::model::classics::Langford;
use twinslip::number::Real;
use twinslip::orbit::{Condition, ContinuationPoint, Corrector, Goal, ShootingNodes, Tracer};
use twinslip::series::Equations;

/// A system of three equations with others that know nothing of it, in coordinates that mix them all.
#[derive(Debug, Clone, Copy)]
pub struct Among<S>(pub S);

/// The reflection across the plane at right angles to (1, 2, .. N).
fn reflect<T: Real>(x: &mut [T]) {
    let along: f64 = (1..=x.len()).map(|i| (i * i) as f64).sum();
    let mut dot = T::constant(0.0);
    for (i, x) in x.iter().enumerate() {
        dot = dot + *x * (i + 1) as f64;
    }
    for (i, x) in x.iter_mut().enumerate() {
        *x = *x - dot * (2.0 * (i + 1) as f64 / along);
    }
}

impl<S: Equations<3, 2>, const N: usize> Equations<N, 2> for Among<S> {
    const PARAMETERS: [&'static str; 2] = S::PARAMETERS;

    fn rates<T: Real>(&self, y: [T; N], parameters: [T; 2]) -> [T; N] {
        let mut x = y;
        reflect(&mut x);
        let own = self.0.rates([x[0], x[1], x[2]], parameters);
        let others = |i: usize| {
            // Turning pairs that decay, the last alone.
            let decay = -x[i] * (0.1 * i as f64);
            match i % 2 {
                1 if i + 1 < N => decay + x[i + 1] * 0.7,
                0 => decay - x[i - 1] * 0.7,
                _ => decay,
            }
        };
        let mut rates = std::array::from_fn(|i| if i < 3 { own[i] } else { others(i) });
        reflect(&mut rates);
        rates
    }
}

/// The point of the whole at a point of the three, the others at rest.
pub fn mixed<const N: usize>(x: &State<3>) -> State<N> {
    let mut whole = State::<N>::from_fn(|i, _| if i < 3 { x[i] } else { 0.0 });
    reflect(whole.as_mut_slice());
    whole
}

/// The same of so many variables.
fn among(count: usize, x: [f64; 3]) -> Vector {
    let mut whole = Vector::zeros(count);
    whole.as_mut_slice()[..3].copy_from_slice(&x);
    reflect(whole.as_mut_slice());
    whole
}

/// Langford's circle at omega = 3.5, eps = 0.
pub fn langford<const N: usize>(rho: f64) -> ContinuationPoint {
    let (radius, turn) = (Langford::radius(rho), TAU / 12.0);
    let nodes = (0..12).map(|k| {
        let (sin, cos) = (turn * f64::from(k)).sin_cos();
        among(N, [radius * cos, radius * sin, 0.7])
    });
    ContinuationPoint {
        shooting: ShootingNodes {
            nodes: nodes.collect(),
            durations: vec![turn / 3.5; 12],
        },
        at: [rho, 0.0],
    }
}

/// Roessler's orbit at c = 2.5 that doubles first.
pub fn roessler(corrector: &mut Corrector<'_>) -> ContinuationPoint {
    let at = [0.2, 2.5];
    let field = corrector.family.field(at);
    let mut tracer = Tracer::taylor(1e-10).expect("a tracer");
    let start = among(field.dimension(), [-3.0, 0.0, 0.1]);
    let start = tracer.flow(&field, &start, 300.0, None).expect("a run");
    let shooting = ShootingNodes::along(&mut tracer, &field, &start, 5.75).expect("nodes");
    let held = [Condition::Parameter(1, at[1])];
    let site = ContinuationPoint { shooting, at };
    let orbit = corrector.correct(site, &[1], &held, Goal::SHARP);
    orbit.expect("an orbit").site
}
