//! Where a scene ends, how well that is known, and how much of an error on the way arrives there.

use super::scene::Scene;
use nalgebra::SVector;
use twinslip::error::Error;
use twinslip::field::{Jacobian, State, VectorField};
use twinslip::integrate::{
    Choice, Control, Integrator, Rosenbrock, RosenbrockMethod, Taylor, Tolerances,
};

/// Bounds on the steps of the reference and of the tight methods.
const REFERENCE_STEPS: usize = 1500;
const TIGHT_STEPS: usize = 50_000;
/// By how much two tight methods may differ to count as agreeing.
const AGREEMENT: f64 = 1e-8;
/// Times that the end is drawn nearer, and how much nearer.
const SHORTENINGS: usize = 4;
const SHORTENED: f64 = 0.01;
/// Pieces in which the conditioning of a run is looked at.
const PIECES: usize = 40;

/// How an end became known.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Rule {
    /// Power series in double-double arithmetic reached it.
    Reference,
    /// That took too many steps; two unlike methods at tight tolerances agree.
    Agreement,
    /// Neither; the same with an end time nearer by powers of [`SHORTENED`].
    Shortened,
    /// The reference blows up, or finds the field infinite at the start.
    Singular,
    /// None of these: the runs are only watched.
    Unknown,
}

/// What a method is held to.
#[derive(Debug, Clone)]
pub enum Truth<const N: usize> {
    /// The state at the end, what is uncertain of it, and how far an error of one in the units of the tolerance grows.
    End {
        time: f64,
        state: State<N>,
        uncertainty: f64,
        conditioning: f64,
    },
    /// No solution beyond this time, of which an error at the start in the units of the tolerance moves this part.
    Singular { time: f64, conditioning: f64 },
    /// Nothing is known.
    Unknown { time: f64 },
}

impl<const N: usize> Truth<N> {
    /// Of a scene, and how it became known.
    pub fn of(field: &dyn VectorField<N>, start: &State<N>, scene: &Scene) -> (Self, Rule) {
        let mut time = scene.end;
        for shortenings in 0..=SHORTENINGS {
            let rule = |rule| {
                if shortenings == 0 {
                    rule
                } else {
                    Rule::Shortened
                }
            };
            let mut reference = Taylor::reference(REFERENCE_STEPS).expect("valid");
            match reference.flow(field, (0.0, time), start, None) {
                Ok(state) => {
                    let known = Self::known(field, start, time, state, 0.0);
                    return (known, rule(Rule::Reference));
                }
                Err(Error::TooManySteps { .. }) => {}
                Err(Error::BlowUp { t, .. }) => {
                    let conditioning = of_singularity(field, start, time, t);
                    let singular = Truth::Singular {
                        time: t,
                        conditioning,
                    };
                    return (singular, Rule::Singular);
                }
                Err(Error::NonFinite { t, .. }) => {
                    let singular = Truth::Singular {
                        time: t,
                        conditioning: 1.0,
                    };
                    return (singular, Rule::Singular);
                }
                Err(_) => {}
            }
            if let Some((state, apart)) = agreed(field, start, time) {
                let known = Self::known(field, start, time, state, apart);
                return (known, rule(Rule::Agreement));
            }
            time *= SHORTENED;
        }
        (Truth::Unknown { time: scene.end }, Rule::Unknown)
    }

    fn known(
        field: &dyn VectorField<N>,
        start: &State<N>,
        time: f64,
        state: State<N>,
        uncertainty: f64,
    ) -> Self {
        match conditioning(field, start, time) {
            Some(conditioning) => Truth::End {
                time,
                state,
                uncertainty,
                conditioning,
            },
            None => Truth::Unknown { time },
        }
    }

    /// When the runs are to end.
    pub fn until(&self, scene: &Scene) -> f64 {
        match self {
            Truth::End { time, .. } | Truth::Unknown { time } => *time,
            Truth::Singular { .. } => scene.end,
        }
    }
}

/// The error of an end: relative in psi, in tau relative to at least one.
///
/// As a difference of logarithms, which is the relative error of psi where that is small and stays comparable where not.
pub fn error<const N: usize>(state: &State<N>, truth: &State<N>) -> f64 {
    let apart = (state - truth).abs();
    (0..N)
        .map(|i| apart[i] / end_unit(truth, i))
        .fold(0.0, f64::max)
}

fn end_unit<const N: usize>(state: &State<N>, i: usize) -> f64 {
    if i == 0 { state[0].abs().max(1.0) } else { 1.0 }
}

/// An end on which two unlike methods agree at tight tolerances, and by how much they differ.
fn agreed<const N: usize>(
    field: &dyn VectorField<N>,
    start: &State<N>,
    time: f64,
) -> Option<(State<N>, f64)> {
    let second = if cfg!(feature = "sundials") {
        ("cvode-bdf", 1e-13)
    } else {
        ("rodas4", 1e-11)
    };
    let end = |(name, tolerance): (&str, f64)| {
        let tolerances = Tolerances::equal(tolerance).expect("valid");
        let method = Choice::named(name).expect("known");
        let mut integrator = method.integrator(tolerances, TIGHT_STEPS).expect("valid");
        integrator.flow(field, (0.0, time), start, None).ok()
    };
    let (first, second) = (end(("rodas5p", 1e-12))?, end(second)?);
    let apart = error(&second, &first);
    (apart < AGREEMENT).then_some((first, apart))
}

/// How much of its time a singularity moves for an error of one at the start in the units of [`conditioning`]; at least one.
///
/// A fall of psi from w = ln psi takes a time like exp(beta w): an error of rtol |w| in w is beta |w| rtol of that time.
fn of_singularity<const N: usize>(
    field: &dyn VectorField<N>,
    start: &State<N>,
    time: f64,
    singularity: f64,
) -> f64 {
    /// Of the unit, small enough to be linear and large enough to be seen.
    const NUDGE: f64 = 1e-7;
    let moved = |i: usize| {
        let mut nudged = *start;
        nudged[i] += NUDGE * (1.0 + start[i].abs());
        let mut reference = Taylor::reference(REFERENCE_STEPS).expect("valid");
        match reference.flow(field, (0.0, time), &nudged, None) {
            Err(Error::BlowUp { t, .. }) => ((t / singularity - 1.0) / NUDGE).abs(),
            // The singularity is gone.
            _ => f64::INFINITY,
        }
    };
    (0..N).map(moved).fold(1.0, f64::max)
}

/// The largest growth, from any time on the way to the end, of an error that the tolerance lets pass there.
///
/// An error test allows `atol + rtol |y|` in each component of (tau, ln psi), which is the unit of an error on the way; the
/// unit at the end is that of [`error`]. Products of tangent flows over pieces of the run carry the one to the other.
fn conditioning<const N: usize>(
    field: &dyn VectorField<N>,
    start: &State<N>,
    time: f64,
) -> Option<f64> {
    let rodas = |tolerance: f64| {
        let tolerances = Tolerances::equal(tolerance).expect("valid");
        Rosenbrock::<N>::new(RosenbrockMethod::Rodas5P, tolerances, TIGHT_STEPS).expect("valid")
    };
    let mut way = vec![(0.0, *start)];
    rodas(1e-7)
        .flow(
            field,
            (0.0, time),
            start,
            Some(&mut |step| {
                way.push((step.t1, *step.y1));
                Ok(Control::Continue)
            }),
        )
        .ok()?;
    let stride = way.len().div_ceil(PIECES);
    let end = way[way.len() - 1].1;
    let growth = |carried: &Jacobian<N>, from: &State<N>| {
        let units: State<N> = SVector::from_fn(|i, _| 1.0 + from[i].abs());
        let arriving = carried.abs() * units;
        (0..N)
            .map(|i| arriving[i] / end_unit(&end, i))
            .fold(0.0, f64::max)
    };
    let mut carried = Jacobian::<N>::identity();
    let mut worst = growth(&carried, &end);
    let mut to = way.len() - 1;
    while to > 0 {
        let from = to.saturating_sub(stride);
        let span = (way[from].0, way[to].0);
        let (_, tangent) = rodas(1e-4).tangent_flow(field, span, &way[from].1).ok()?;
        carried *= tangent;
        worst = worst.max(growth(&carried, &way[from].1));
        to = from;
    }
    worst.is_finite().then_some(worst.max(1.0))
}
