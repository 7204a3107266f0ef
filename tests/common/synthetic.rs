//! Laboratory records with known parameters: a step of velocity, measured with noise.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use twinslip::fit::{DRIFT, FreeParameter, Loss, Motion, Problem, Record, Scale, Stretch};
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
}

impl Synthetic {
    /// With parameters as laboratories find them, on a spring stiff enough for steady sliding.
    pub fn new(making: &Making, chance: &mut Chance) -> Self {
        let a = chance.between_in_log(0.005, 0.02);
        let b = a * chance.between(0.6, 1.4);
        let length = chance.between_in_log(2e-6, 3e-5);
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
        let (rest, slides) = (4.0 * length / SLOW, 20.0 * length / FAST);
        let end = rest + slides;
        let stretch = |span: (f64, f64), velocity| Stretch {
            span,
            velocity: (velocity, velocity),
        };
        let motion = Motion {
            before: SLOW,
            stretches: vec![stretch((0.0, rest), SLOW), stretch((rest, end), FAST)],
        };
        // As many samples in each, as laboratories do: with the load point.
        let half = making.samples / 4;
        let before = (0..half).map(|i| rest * i as f64 / half as f64);
        let after = making.samples - half;
        let after = (0..after).map(|i| rest + slides * i as f64 / (after - 1) as f64);
        let times: Vec<f64> = before.chain(after).collect();
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
        let problem = synthetic.problem(&["reference_friction"]);
        let problem = Problem { drift, ..problem };
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
        let of = |name: &&str| {
            let is_linear = ["reference_friction", DRIFT].contains(name);
            FreeParameter {
                name: (*name).into(),
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
            }
        };
        Problem {
            sliders: &self.slider,
            motion: &self.motion,
            record: &self.record,
            parameters: self.truth.to_vec(),
            drift: 0.0,
            free: free.iter().map(of).collect(),
            loss: Loss::Linear,
        }
    }

    /// The true value of a parameter.
    pub fn value(&self, name: &str) -> f64 {
        let place = Slider::NAMES.iter().position(|own| *own == name);
        place.map_or(self.drift, |place| self.truth[place])
    }
}
