//! Laboratory records with known parameters: a step of velocity, measured with noise.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use twinslip::fit::{
    DRIFT, FittedRecord, FreeParameter, Loss, Motion, Problem, Record, Scale, Sliders, Stretch,
};
use twinslip::model::Slider;

/// Random numbers that follow from a seed.
pub struct Chance(ChaCha8Rng);

impl Chance {
    pub fn new(seed: u64) -> Self {
        Chance(ChaCha8Rng::seed_from_u64(seed))
    }

    /// Between 0 and 1.
    pub fn uniform(&mut self) -> f64 {
        (self.0.next_u64() >> 11) as f64 / (1_u64 << 53) as f64
    }

    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.uniform()
    }

    /// Between these, by its logarithm.
    pub fn between_in_log(&mut self, low: f64, high: f64) -> f64 {
        self.between(low.ln(), high.ln()).exp()
    }

    /// Standard normal, by Box and Muller.
    pub fn normal(&mut self) -> f64 {
        let radius = (-2.0 * (1.0 - self.uniform()).ln()).sqrt();
        radius * (std::f64::consts::TAU * self.uniform()).cos()
    }
}

/// A measurement whose parameters are known.
pub struct Synthetic {
    pub slider: Slider,
    pub motion: Motion,
    pub record: Record,
    /// In the order of [`Slider::NAMES`].
    pub truth: [f64; Slider::NAMES.len()],
    /// Slope of the drift, in friction per metre.
    pub drift: f64,
}

/// V before the step, in m/s: V* too.
pub const SLOW: f64 = 1e-6;
/// And after it.
pub const FAST: f64 = 1e-5;

/// How a record is made.
#[derive(Debug, Clone, Copy)]
pub struct Making {
    pub law: &'static str,
    pub samples: usize,
    /// The standard deviation of the noise, over a ln(V_2/V_1).
    pub noise: f64,
    /// How noise goes on from sample to sample.
    pub memory: f64,
    pub has_drift: bool,
    pub shows: Shows,
}

/// How the load point of a record moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shows {
    /// From [`SLOW`] to [`FAST`].
    Step,
    /// Three holds, each ten times as long as the one before, while sliding at [`FAST`].
    Holds,
    /// The step, and then the holds.
    Both,
}

impl Shows {
    /// The stretches: how long each lasts, in s, and its velocity in m/s; for a slip length in m.
    fn stretches(self, length: f64) -> Vec<(f64, f64)> {
        let step = [(4.0 * length / SLOW, SLOW), (20.0 * length / FAST, FAST)];
        let slides = 25.0 * length / FAST;
        let hold = |lasts: f64| [(lasts * length / FAST, 0.0), (slides, FAST)];
        let holds = [1.0, 10.0, 100.0].map(hold).concat();
        match self {
            Shows::Step => step.to_vec(),
            Shows::Holds => [vec![(slides, FAST)], holds].concat(),
            Shows::Both => [step.to_vec(), holds].concat(),
        }
    }
}

impl Synthetic {
    /// With parameters as laboratories find them, on a spring stiff enough for steady sliding.
    pub fn new(making: &Making, chance: &mut Chance) -> Self {
        let a = chance.between_in_log(0.005, 0.02);
        let b = a * chance.between(0.6, 1.4);
        let length = chance.between_in_log(2e-6, 3e-5);
        Self::of(making, (a, b, length), chance)
    }

    /// With these a, b and L, and another spring.
    pub fn of(making: &Making, (a, b, length): (f64, f64, f64), chance: &mut Chance) -> Self {
        // k_c = (b - a)/L: well above it, and above zero.
        let stiffness = chance.between(1.0, 3.0) * a / length + 3.0 * (b - a).max(0.0) / length;
        let truth = [
            stiffness,
            a,
            b,
            length,
            0.6,
            1e4,
            1e-3,
            0.3 * b,
            5.0 * length,
        ];
        let mut now = 0.0;
        let stretches = making.shows.stretches(length).into_iter();
        let stretches = stretches.map(|(lasts, velocity)| {
            let begin = now;
            now += lasts;
            Stretch {
                span: (begin, now),
                velocity: (velocity, velocity),
            }
        });
        let stretches: Vec<Stretch> = stretches.collect();
        let motion = Motion {
            before: stretches[0].velocity.0,
            stretches,
        };
        // A quarter of the samples before a step, and as many in each stretch of holds: laboratories take them with the load point.
        let count = motion.stretches.len();
        let last = motion.stretches[count - 1].span.1;
        let each = motion.stretches.iter().enumerate().flat_map(|(i, own)| {
            let of = match making.shows {
                Shows::Step if i == 0 => making.samples / 4,
                Shows::Step => making.samples - making.samples / 4 - 1,
                Shows::Holds | Shows::Both => making.samples / count,
            };
            let (begin, end) = own.span;
            (0..of).map(move |k| begin + (end - begin) * k as f64 / of as f64)
        });
        let times: Vec<f64> = each.chain([last]).collect();
        let displacement = motion.displacement(&times);
        let drift = if making.has_drift {
            chance.between(-0.2, 0.2) * a / (10.0 * length)
        } else {
            0.0
        };
        let slider = Slider::new(making.law, SLOW).expect("a law");
        let record = Record {
            friction: vec![0.0; times.len()],
            weights: vec![1.0; times.len()],
            times,
            displacement,
        };
        let mut synthetic = Synthetic {
            slider,
            motion,
            record,
            truth,
            drift,
        };
        let mut problem = synthetic.problem(&["reference_friction"]);
        problem.records[0].drift = drift;
        let (clean, _) = problem.response(&[truth[4]]).expect("a friction");
        let size = making.noise * a * (FAST / SLOW).ln();
        let fresh = (1.0 - making.memory * making.memory).sqrt();
        let mut noise = chance.normal();
        let noisy = clean.into_iter().map(|mu| {
            noise = making.memory * noise + fresh * chance.normal();
            mu + size * noise
        });
        let noisy: Vec<f64> = noisy.collect();
        synthetic.record.friction = noisy;
        synthetic
    }

    /// The fit of these parameters, the others being known.
    pub fn problem(&self, free: &[&str]) -> Problem<'_, 3> {
        self.problem_of(&self.slider, free)
    }

    /// The same with another number of variables.
    pub fn problem_of<'a, const N: usize>(
        &'a self,
        sliders: &'a dyn Sliders<N>,
        free: &[&str],
    ) -> Problem<'a, N> {
        Problem {
            sliders,
            records: vec![self.fitted()],
            free: free.iter().map(|name| free_parameter(name, None)).collect(),
            loss: Loss::Linear,
        }
    }

    /// The record, with what is known for it.
    pub fn fitted(&self) -> FittedRecord<'_> {
        FittedRecord {
            record: &self.record,
            motion: &self.motion,
            parameters: self.truth.to_vec(),
            drift: 0.0,
        }
    }

    /// The true value of a parameter.
    pub fn value(&self, name: &str) -> f64 {
        let place = Slider::NAMES.iter().position(|own| *own == name);
        place.map_or(self.drift, |place| self.truth[place])
    }
}

/// A free parameter without bounds.
pub fn free_parameter(name: &str, of_record: Option<usize>) -> FreeParameter {
    let is_linear = ["reference_friction", "evolution_effect_2", DRIFT].contains(&name);
    FreeParameter {
        name: name.into(),
        scale: if is_linear {
            Scale::Linear
        } else {
            Scale::Logarithmic
        },
        bounds: if is_linear {
            (-1e30, 1e30)
        } else {
            (1e-30, 1e30)
        },
        of_record,
    }
}
