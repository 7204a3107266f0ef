//! Fits from options: the record, the laws, how residuals count.

use super::data::Measured;
use super::given::Given;
use super::law::LawToFit;
use super::motion::{Loaded, loaded};
use super::options::FitOptions;
use super::recorded::Recorded;
use crate::scene::units::Units;
use twinslip::error::{Error, Result};
use twinslip::fit::{Fit, Guess, Intervals, Loss, Motion, Problem, Record, fit, guesses, spread};
use twinslip::friction::positive;
use twinslip::model::scales::Scales;

/// Large residuals for a loss that lets them count less, in standard deviations from sample to sample.
const LARGE: f64 = 3.0;
/// Samples of the record by which smoothings of the displacement are compared.
const COMPARED: usize = 400;

/// A fit that is asked for, checked.
#[derive(Debug, Clone, PartialEq)]
pub struct FitPlan {
    /// What was measured.
    pub measured: Measured,
    /// How the load point moved.
    pub motion: Motion,
    /// The steps in it.
    pub steps: Motion,
    /// What is fitted.
    pub record: Record,
    /// The laws, in the order in which they were asked for.
    pub laws: Vec<LawToFit>,
    /// What its steps and holds show.
    shown: Vec<Guess>,
    /// How residuals count.
    pub loss: Loss,
    /// How 95 % intervals are made.
    pub intervals: Intervals,
    /// V* in m/s.
    pub reference_rate: f64,
}

impl FitPlan {
    /// Checks the options and reads the record.
    ///
    /// # Errors
    /// [`Error::Parameter`], [`Error::Input`] and [`Error::File`], in the user's own names.
    pub fn new(options: &FitOptions) -> Result<Self> {
        let measured = Measured::read(options)?;
        let Loaded {
            motion,
            recorded,
            record,
        } = loaded(options, &measured)?;
        let reference_rate = match options.reference_rate {
            Some(rate) => positive("reference-rate", rate)?,
            None => motion.before,
        };
        let moved = record.displacement.iter();
        let moved = moved.fold(0.0, |most: f64, x| most.max(x.abs()));
        let lengths = (moved, moved / record.times.len() as f64);
        let given = Given::new(options, measured.normal_stress, lengths)?;
        let shown = guesses(&record, &motion, reference_rate);
        let names = options.law.split(',').map(str::trim);
        let laws = names.map(|name| LawToFit::new(name, options, &given, &shown, reference_rate));
        let mut plan = FitPlan {
            laws: laws.collect::<Result<_>>()?,
            loss: loss(options, &record)?,
            intervals: match options.intervals.as_str() {
                "profile" => Intervals::Profile,
                "linear" => Intervals::Linear,
                other => return Err(Error::unknown("intervals", other, &["profile", "linear"])),
            },
            measured,
            steps: motion.clone(),
            motion,
            shown,
            record,
            reference_rate,
        };
        if !recorded.is_empty() {
            plan.follow(recorded)?;
        }
        Ok(plan)
    }

    /// Takes the smoothing of the recorded displacement that friction follows best. What a transducer shows beside the motion of the sample is
    /// known from nothing else: where friction follows none better than the steps, these stay.
    fn follow(&mut self, recorded: Vec<Recorded>) -> Result<()> {
        let law = &self.laws[0];
        let record = self.record.thinned_along(&self.steps, COMPARED);
        let fitted = |motion: &Motion, starts: Vec<Vec<f64>>| {
            let intervals = Intervals::Linear;
            law.with_problem(self, (motion, &record), &mut FitFrom { starts, intervals })
        };
        let by_steps = fitted(&self.steps, law.starts(&self.shown, self.reference_rate))?;
        let start: Vec<f64> = by_steps.parameters.iter().map(|one| one.value).collect();
        let (mut least, mut best) = (by_steps.rms, None);
        for one in recorded {
            // A motion at which there is no friction is none that it follows.
            let Ok(fit) = fitted(&one.motion, vec![start.clone()]) else {
                continue;
            };
            if fit.rms < least {
                (least, best) = (fit.rms, Some(one));
            }
        }
        self.measured.notes.push(match &best {
            None => "the load point moves in steps: no smoothing of its recorded displacement fits the friction better, so the rest of that record is noise of the transducer".into(),
            Some(one) if one.window == 0.0 => {
                "the load point moves as it was recorded, without smoothing, which fits the friction best".into()
            }
            Some(one) => format!(
                "the load point moves as it was recorded, smoothed over {:.2} s, which fits the friction best",
                one.window
            ),
        });
        self.motion = best.map_or_else(|| self.steps.clone(), |one| one.motion);
        Ok(())
    }

    /// What the numbers of rows are in: SI.
    pub fn units(&self) -> Units {
        let one = Scales::new(1.0, 1.0, 1.0, 1.0);
        Units::new(one.ok(), false)
    }

    /// The plan, one subject a line.
    pub fn explain(&self) -> String {
        let laws: Vec<String> = self
            .laws
            .iter()
            .map(|law| {
                let free: Vec<&str> = law.free().iter().map(|free| free.name.as_str()).collect();
                format!(
                    "{} with {} state variable{}: {}",
                    law.name,
                    law.states,
                    if law.states == 1 { "" } else { "s" },
                    free.join(", ")
                )
            })
            .collect();
        format!(
            "plan of this command\n  {} samples from {} to {} s; the load point in {} segments, the first at {:e} m/s\n  {}\n  power series with derivatives along each run; Levenberg-Marquardt; errors by the autoregression of the residuals",
            self.record.times.len(),
            self.record.times[0],
            self.record.times[self.record.times.len() - 1],
            self.motion.stretches.len(),
            self.motion.before,
            laws.join("\n  ")
        )
    }

    /// Fits a law.
    ///
    /// # Errors
    /// Those of [`fit()`].
    pub fn fit(&self, law: &LawToFit) -> Result<Fit> {
        self.fit_from(law, (&self.motion, &self.record), &self.shown)
    }

    /// Fits a law to a part of the record, before which the load point has moved as `motion` says; the search begins with what the
    /// motion of the part `alone` shows.
    ///
    /// # Errors
    /// Those of [`fit()`].
    pub fn fit_to(
        &self,
        law: &LawToFit,
        (motion, alone): (&Motion, &Motion),
        record: &Record,
    ) -> Result<Fit> {
        let shown = guesses(record, alone, self.reference_rate);
        self.fit_from(law, (motion, record), &shown)
    }

    fn fit_from(&self, law: &LawToFit, to: (&Motion, &Record), shown: &[Guess]) -> Result<Fit> {
        let starts = law.starts(shown, self.reference_rate);
        let intervals = self.intervals;
        law.with_problem(self, to, &mut FitFrom { starts, intervals })
    }
}

/// What is done with the problem of a law, whatever number of variables it has.
pub trait WithProblem {
    /// What comes of it.
    type Output;
    /// Does it.
    ///
    /// # Errors
    /// Its own.
    fn call<const N: usize>(&mut self, problem: &Problem<'_, N>) -> Result<Self::Output>;
}

struct FitFrom {
    starts: Vec<Vec<f64>>,
    intervals: Intervals,
}

impl WithProblem for FitFrom {
    type Output = Fit;
    fn call<const N: usize>(&mut self, problem: &Problem<'_, N>) -> Result<Fit> {
        fit(problem, &self.starts, self.intervals)
    }
}

fn loss(options: &FitOptions, record: &Record) -> Result<Loss> {
    let usual = || f64::max(LARGE * spread(&record.friction), f64::MIN_POSITIVE);
    let scale = match options.loss_scale {
        Some(scale) => positive("loss-scale", scale)?,
        None => usual(),
    };
    match options.loss.as_str() {
        "linear" => Ok(Loss::Linear),
        "soft-l1" => Ok(Loss::SoftL1 { scale }),
        "huber" => Ok(Loss::Huber { scale }),
        "cauchy" => Ok(Loss::Cauchy { scale }),
        other => Err(Error::unknown(
            "loss",
            other,
            &["linear", "soft-l1", "huber", "cauchy"],
        )),
    }
}
