//! What arcs of multiple shooting err by, against 31 digits, beside what they say of it.

use twinslip::field::{State, VectorField, vector};
use twinslip::friction::{AnyLaw, Parameters};
use twinslip::integrate::{AnyField, Integrator, MAX_STEPS, Taylor};
use twinslip::model::classics::{Brusselator, Langford, Lorenz, Roessler, VanDerPol};
use twinslip::model::{Loading, Smooth, interfaces_in_difference_chart, symmetric, two_interfaces};
use twinslip::number::Real;
use twinslip::orbit::{Arc, ShootingNodes, Tracer};
use twinslip::series::Equations;

/// A ring: x_i' = (x_{i+1} - x_{i-2}) x_{i-1} - x_i + F (Lorenz 1996).
#[derive(Debug, Clone, Copy)]
struct Ring;

impl<const N: usize> Equations<N, 1> for Ring {
    const PARAMETERS: [&'static str; 1] = ["force"];
    fn rates<T: Real>(&self, x: [T; N], [force]: [T; 1]) -> [T; N] {
        let at = |i: usize| x[i % N];
        std::array::from_fn(|i| (at(i + 1) - at(i + N - 2)) * at(i + N - 1) - x[i] + force)
    }
}

/// Van der Pol's oscillators in a ring, in (mu, k).
#[derive(Debug, Clone, Copy)]
struct Oscillators;

impl<const N: usize> Equations<N, 2> for Oscillators {
    const PARAMETERS: [&'static str; 2] = ["mu", "k"];
    fn rates<T: Real>(&self, z: [T; N], [mu, k]: [T; 2]) -> [T; N] {
        let one = T::constant(1.0);
        let x = |i: usize| z[(2 * i) % N];
        std::array::from_fn(|j| {
            let (i, y) = (j / 2, z[j | 1]);
            if j % 2 == 0 {
                return y;
            }
            let pull = x(i + 1) - x(i) * 2.0 + x(i + N / 2 - 1);
            mu * (one - x(i) * x(i)) * y - x(i) + k * pull
        })
    }
}

/// The root mean square of the ends' errors in units of what arcs say, and the largest, over arcs of so many durations along a
/// solution. Of what the solution grows by along an arc, the arcs know nothing: they are short.
fn errors<const N: usize>(
    field: &dyn VectorField<N>,
    start: State<N>,
    (duration, tolerance): (f64, f64),
) -> (f64, f64, f64) {
    const ARCS: usize = 200;
    let mut reference = Taylor::reference(MAX_STEPS).unwrap();
    let mut tracer = Tracer::taylor(tolerance).unwrap();
    let any = AnyField::of(field);
    let start = vector(&start);
    let mut x = tracer.flow(&any, &start, 20.0 * duration, None).unwrap();
    let (mut sum, mut largest, mut steps) = (0.0, 0.0_f64, 0);
    for _ in 0..ARCS {
        let arc = tracer.arc(&any, &x, duration, &[]).unwrap();
        let x_0 = State::<N>::from_column_slice(x.as_slice());
        let exact = reference.flow(field, (0.0, duration), &x_0, None).unwrap();
        let growth = arc.tangent.amax().max(1.0);
        let worst = (0..N)
            .map(|i| (arc.end[i] - exact[i]).abs() / (1.0 + exact[i].abs()))
            .fold(0.0, f64::max);
        let ratio = worst / arc.rounding() / growth;
        sum += ratio * ratio;
        largest = largest.max(ratio);
        steps += arc.steps;
        x = arc.end;
    }
    (
        (sum / ARCS as f64).sqrt(),
        largest,
        steps as f64 / ARCS as f64,
    )
}

#[test]
fn the_ends_of_arcs_err_by_what_they_say() {
    let mut all: Vec<(String, (f64, f64, f64))> = Vec::new();
    // The tolerance with which orbits are solved: what is left is rounding.
    let tolerance = 1e-15;
    {
        let any = AnyLaw::named("spinodal", Parameters::heslot_1994()).unwrap();
        let loading = Loading::new(10.0, 0.14).unwrap();
        let y = State::<3>::new(9.0, 0.01_f64.ln(), 0.0101_f64.ln());
        let pair = two_interfaces(any, loading);
        all.push((
            format!("pair {tolerance:e}"),
            errors(&*pair, y, (1.0, tolerance)),
        ));
        let one = symmetric(any, loading);
        let y = State::<2>::new(9.0, 0.01_f64.ln());
        all.push((
            format!("symmetric {tolerance:e}"),
            errors(&*one, y, (1.0, tolerance)),
        ));
        let apart = interfaces_in_difference_chart(any, Loading::new(10.0, 0.14).unwrap());
        let y = State::<3>::new(9.0, 0.01_f64.ln(), 0.001_f64.ln());
        all.push((
            format!("chart {tolerance:e}"),
            errors(&*apart, y, (1.0, tolerance)),
        ));
        let three = State::<3>::new(1.0, 2.0, 3.0);
        let lorenz = Smooth {
            equations: Lorenz::classical(),
            parameters: [28.0, 8.0 / 3.0],
        };
        all.push((
            format!("lorenz {tolerance:e}"),
            errors(&lorenz, three, (0.3, tolerance)),
        ));
        let roessler = Smooth {
            equations: Roessler { b: 0.2 },
            parameters: [0.2, 5.0],
        };
        all.push((
            format!("roessler {tolerance:e}"),
            errors(&roessler, State::<3>::new(-3.0, 0.0, 0.1), (1.0, tolerance)),
        ));
        let langford = Smooth {
            equations: Langford { omega: 3.5 },
            parameters: [0.3, 0.0],
        };
        all.push((
            format!("langford {tolerance:e}"),
            errors(&langford, State::<3>::new(0.6, 0.0, 0.7), (0.3, tolerance)),
        ));
        let two = State::<2>::new(2.0, 0.1);
        let vdp = Smooth {
            equations: VanDerPol,
            parameters: [5.0, 0.0],
        };
        all.push((
            format!("vdp {tolerance:e}"),
            errors(&vdp, two, (1.0, tolerance)),
        ));
        let brusselator = Smooth {
            equations: Brusselator,
            parameters: [1.0, 3.0],
        };
        all.push((
            format!("brusselator {tolerance:e}"),
            errors(&brusselator, two, (1.0, tolerance)),
        ));
        let ring = Smooth {
            equations: Ring,
            parameters: [2.0],
        };
        all.push((
            format!("ring 6 {tolerance:e}"),
            errors(
                &ring,
                State::<6>::from_fn(|i, _| 2.0 + 0.1 * i as f64),
                (0.3, tolerance),
            ),
        ));
        let ring = Smooth {
            equations: Ring,
            parameters: [8.0],
        };
        all.push((
            format!("ring 12 {tolerance:e}"),
            errors(
                &ring,
                State::<12>::from_fn(|i, _| 2.0 + 0.1 * i as f64),
                (0.3, tolerance),
            ),
        ));
        let oscillators = Smooth {
            equations: Oscillators,
            parameters: [1.0, 0.25],
        };
        all.push((
            format!("oscillators 4 {tolerance:e}"),
            errors(
                &oscillators,
                State::<4>::from_fn(|i, _| 1.0 - 0.3 * i as f64),
                (0.5, tolerance),
            ),
        ));
        let oscillators = Smooth {
            equations: Oscillators,
            parameters: [1.0, 0.25],
        };
        all.push((
            format!("oscillators 12 {tolerance:e}"),
            errors(
                &oscillators,
                State::<12>::from_fn(|i, _| 1.0 - 0.3 * i as f64),
                (0.5, tolerance),
            ),
        ));
    }
    for (name, (rms, largest, steps)) in &all {
        println!("{name:30} rms {rms:8.3} largest {largest:8.3} steps {steps:6.1}");
    }
    for (name, (rms, ..)) in all {
        assert!(rms < 1.0 && rms > 0.02, "{name}: {rms}");
    }
}

/// Steps of much contraction take the place of several arcs; what follows them, and what is left of arcs whose nodes have come near each
/// other, is not cut the finer for that.
#[test]
fn no_arc_is_much_shorter_than_it_should_be() {
    /// What the mesh makes equal, of an arc: its steps and what its volume shrinks by, in units of what one arc may.
    const STEPS: f64 = 12.0;
    const VOLUME: f64 = 3.0;
    /// The least part of it.
    const LEAST: f64 = 0.3;
    let law = AnyLaw::Spinodal(Parameters::heslot_1994().spinodal());
    for (driving, stiffness) in [(0.2, 0.01), (0.06, 0.0025), (1.0, 0.001)] {
        let loading = Loading::new(driving, stiffness).unwrap();
        let field = symmetric(law, loading);
        let any = AnyField::of(&*field);
        let mut tracer = Tracer::taylor(1e-12).unwrap();
        let start = vector(&State::<2>::new(9.0, -1.0));
        let (before, period) = (40.0 / (driving * stiffness), 2.5 / (driving * stiffness));
        let start = tracer.flow(&any, &start, before, None).unwrap();
        let mesh = ShootingNodes::along(&mut tracer, &any, &start, period).unwrap();
        // Nodes near the ends of their arcs, and at their beginnings: short arcs between long ones.
        let count = mesh.nodes.len();
        let late = mesh.shifted(&mut tracer, &any, 0.99).unwrap();
        let mut mixed = ShootingNodes {
            nodes: Vec::new(),
            durations: Vec::new(),
        };
        for k in 0..count {
            let parts = [0.99, 0.01].map(|part| part * mesh.durations[k]);
            mixed
                .nodes
                .extend([mesh.nodes[k].clone(), late.nodes[k].clone()]);
            mixed.durations.extend(parts);
        }
        let again = mixed.meshed(&mut tracer, &any).unwrap();
        for mesh in [mesh, again] {
            let arcs = mesh.nodes.iter().zip(&mesh.durations);
            let arcs = arcs.map(|(x, &t)| tracer.arc(&any, x, t, &[]).unwrap());
            let measure = |arc: Arc| arc.steps as f64 / STEPS + arc.volume().abs() / VOLUME;
            let measures: Vec<f64> = arcs.map(measure).collect();
            let least = measures.iter().fold(f64::INFINITY, |a, &b| a.min(b));
            assert!(least > LEAST, "{driving} {stiffness}: {measures:?}");
        }
    }
}
