//! Fits from options: the record, the laws, how residuals count.

use super::data::Measured;
use super::law::LawToFit;
use super::motion::{Loaded, loaded};
use super::options::FitOptions;
use super::priors::priors;
use super::recorded::Recorded;
use super::records::FittedRecords;
use crate::scene::units::Units;
use std::path::Path;
use twinslip::error::{Error, Result};
use twinslip::fit::{
    Fit, Guess, Intervals, Loss, Motion, Posterior, Problem, Record, Sampling, fit, guesses,
    minima, posterior, spread,
};
use twinslip::friction::positive;

/// The seed of draws where none is given.
const SEED: u64 = 1;
/// Large residuals for a loss that lets them count less, in standard deviations from sample to sample.
const LARGE: f64 = 3.0;
/// Fewer draws are none.
const FEWEST: usize = 100;
/// Samples of the record by which smoothings of the displacement are compared.
const COMPARED: usize = 400;

/// A record that is fitted, with what it shows.
#[derive(Debug, Clone, PartialEq)]
pub struct Recording {
    /// What was measured.
    pub measured: Measured,
    /// How the load point moved.
    pub motion: Motion,
    /// The steps in it.
    pub steps: Motion,
    /// What is fitted.
    pub record: Record,
    /// What its steps and holds show.
    pub(super) shown: Vec<Guess>,
}

impl Recording {
    /// The name of its file, without the folder.
    pub fn name(&self) -> String {
        let file = Path::new(&self.measured.file);
        let name = file.file_name().unwrap_or(file.as_os_str());
        name.to_string_lossy().into_owned()
    }
}

/// A part of a recording that is fitted, before which the load point has moved as `motion` says.
#[derive(Debug, Clone, Copy)]
pub struct Piece<'a> {
    /// Of which recording, by its place among them.
    pub of: usize,
    /// How the load point moves.
    pub motion: &'a Motion,
    /// What was measured.
    pub record: &'a Record,
}

/// A fit that is asked for, checked.
#[derive(Debug, Clone, PartialEq)]
pub struct FitPlan {
    /// The records, at least one.
    pub recordings: Vec<Recording>,
    /// The laws, in the order in which they were asked for.
    pub laws: Vec<LawToFit>,
    /// How residuals count.
    pub loss: Loss,
    /// How 95 % intervals are made.
    pub intervals: Intervals,
    /// V* in m/s.
    pub reference_rate: f64,
    /// How posteriors are drawn from, for each law, where they are asked for.
    pub sampling: Vec<Sampling>,
}

impl FitPlan {
    /// Checks the options and reads the records.
    ///
    /// # Errors
    /// [`Error::Parameter`], [`Error::Input`] and [`Error::File`], in the user's own names.
    pub fn new(options: &FitOptions) -> Result<Self> {
        let Some(first) = options.data.first() else {
            return Err(Error::Input(
                "`data`: the file of the record is missing".into(),
            ));
        };
        let intervals = match options.intervals.as_str() {
            "profile" => Intervals::Profile,
            "linear" => Intervals::Linear,
            other => return Err(Error::unknown("intervals", other, &["profile", "linear"])),
        };
        if let (Some(_), 1) = (&options.each, options.data.len()) {
            return Err(Error::Input(
                "`each`: there is one record, and nothing that it shares with others".into(),
            ));
        }
        let begun = Begun::read(first, options)?;
        let reference_rate = match options.reference_rate {
            Some(rate) => positive("reference-rate", rate)?,
            None => begun.loaded.motion.before,
        };
        let rest = options.data[1..].iter();
        let mut all = vec![begun];
        for path in rest {
            all.push(Begun::read(path, options)?);
        }
        let (recordings, recorded): (Vec<Recording>, Vec<Vec<Recorded>>) = all
            .into_iter()
            .map(|one| one.recording(reference_rate))
            .unzip();
        let laws = options.law.split(',').map(str::trim);
        let laws = laws.map(|name| LawToFit::new(name, options, &recordings, reference_rate));
        let mut plan = FitPlan {
            laws: laws.collect::<Result<_>>()?,
            loss: loss(options, &recordings)?,
            intervals,
            recordings,
            reference_rate,
            sampling: Vec::new(),
        };
        plan.sampling = plan.samplings(options)?;
        for (at, recorded) in recorded.into_iter().enumerate() {
            if !recorded.is_empty() {
                plan.follow(at, recorded)?;
            }
        }
        Ok(plan)
    }

    /// How posteriors are drawn from.
    fn samplings(&self, options: &FitOptions) -> Result<Vec<Sampling>> {
        let Some(draws) = options.posterior else {
            let given = match (&options.prior[..], options.seed) {
                ([], None) => return Ok(Vec::new()),
                ([], Some(_)) => "seed",
                (_, _) => "prior",
            };
            return Err(Error::Input(format!(
                "`{given}` is of the draws that `posterior` asks for, which is missing"
            )));
        };
        if self.loss != Loss::Linear {
            let what = "`posterior` and `loss`: draws are those of normal noise, loss linear";
            return Err(Error::Input(what.into()));
        }
        if draws < FEWEST {
            return Err(Error::parameter(
                "posterior",
                draws,
                "at least 100 draws, of which quantiles are told",
            ));
        }
        let each = self.laws.iter().map(|law| {
            Ok(Sampling {
                draws,
                seed: options.seed.unwrap_or(SEED),
                priors: priors(options, self, law)?,
            })
        });
        each.collect()
    }

    /// Draws from the posterior of a law that was fitted.
    ///
    /// # Errors
    /// Those of [`posterior`].
    pub fn posterior(
        &self,
        law: &LawToFit,
        (together, sampling): (&FittedRecords, &Sampling),
        go_on: &(dyn Fn() -> bool + Sync),
    ) -> Result<(Posterior, Vec<Vec<f64>>)> {
        let shown = &self.recordings[0].shown;
        let mut draw = Draw {
            together,
            sampling,
            go_on,
            // Of several records the fits of each alone have looked for minima.
            starts: match &self.recordings[..] {
                [_] => law.starts(shown, self.reference_rate),
                _ => Vec::new(),
            },
        };
        law.with_problem(self, &together.pieces(self), &mut draw)
    }

    /// Takes the smoothing of the recorded displacement that friction follows best. What a transducer shows beside the motion of the sample is
    /// known from nothing else: where friction follows none better than the steps, these stay.
    fn follow(&mut self, of: usize, recorded: Vec<Recorded>) -> Result<()> {
        let law = &self.laws[0];
        let own = &self.recordings[of];
        let record = own.record.thinned_along(&own.steps, COMPARED);
        let fitted = |motion: &Motion, starts: Vec<Vec<f64>>| {
            let intervals = Intervals::Linear;
            let piece = Piece {
                of,
                motion,
                record: &record,
            };
            law.with_problem(self, &[piece], &mut FitFrom { starts, intervals })
        };
        let by_steps = fitted(&own.steps, law.starts(&own.shown, self.reference_rate))?;
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
        let own = &mut self.recordings[of];
        own.measured.notes.push(match &best {
            None => "the load point moves in steps: no smoothing of its recorded displacement fits the friction better, so the rest of that record is noise of the transducer".into(),
            Some(one) if one.window == 0.0 => {
                "the load point moves as it was recorded, without smoothing, which fits the friction best".into()
            }
            Some(one) => format!(
                "the load point moves as it was recorded, smoothed over {:.2} s, which fits the friction best",
                one.window
            ),
        });
        own.motion = best.map_or_else(|| own.steps.clone(), |one| one.motion);
        Ok(())
    }

    /// What the numbers of rows are in: SI.
    pub fn units(&self) -> Units {
        Units::measured()
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
        let records = self.recordings.iter().map(|Recording { record, motion, .. }| {
            format!(
                "{} samples from {} to {} s; the load point in {} segments, the first at {:e} m/s",
                record.times.len(),
                record.times[0],
                record.times[record.times.len() - 1],
                motion.stretches.len(),
                motion.before,
            )
        });
        format!(
            "plan of this command\n  {}\n  {}\n  power series with derivatives along each run; Levenberg-Marquardt; errors by the autoregression of the residuals",
            records.collect::<Vec<_>>().join("\n  "),
            laws.join("\n  ")
        )
    }

    /// The recordings, each as a whole.
    pub fn pieces(&self) -> Vec<Piece<'_>> {
        let each = self.recordings.iter().enumerate();
        each.map(|(of, own)| Piece {
            of,
            motion: &own.motion,
            record: &own.record,
        })
        .collect()
    }

    /// Fits a law to a part of a record; the search begins with what the motion of the part `alone` shows.
    ///
    /// # Errors
    /// Those of [`fit()`].
    pub fn fit_to(&self, law: &LawToFit, piece: Piece<'_>, alone: &Motion) -> Result<Fit> {
        let shown = guesses(piece.record, alone, self.reference_rate);
        self.fit_from(law, &[piece], law.starts(&shown, self.reference_rate))
    }

    /// Fits a law to some records from the best of some starts.
    ///
    /// # Errors
    /// Those of [`fit()`].
    pub(super) fn fit_from(
        &self,
        law: &LawToFit,
        pieces: &[Piece<'_>],
        starts: Vec<Vec<f64>>,
    ) -> Result<Fit> {
        let intervals = self.intervals;
        law.with_problem(self, pieces, &mut FitFrom { starts, intervals })
    }
}

/// A record that is read.
struct Begun {
    measured: Measured,
    loaded: Loaded,
}

impl Begun {
    fn read(path: &Path, options: &FitOptions) -> Result<Self> {
        let measured = Measured::read(path, options)?;
        let loaded = loaded(options, &measured)?;
        Ok(Begun { measured, loaded })
    }

    fn recording(self, reference_rate: f64) -> (Recording, Vec<Recorded>) {
        let Loaded {
            motion,
            recorded,
            record,
        } = self.loaded;
        let recording = Recording {
            measured: self.measured,
            shown: guesses(&record, &motion, reference_rate),
            steps: motion.clone(),
            motion,
            record,
        };
        (recording, recorded)
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

struct Draw<'a> {
    together: &'a FittedRecords,
    sampling: &'a Sampling,
    starts: Vec<Vec<f64>>,
    go_on: &'a (dyn Fn() -> bool + Sync),
}

impl WithProblem for Draw<'_> {
    type Output = (Posterior, Vec<Vec<f64>>);
    fn call<const N: usize>(&mut self, problem: &Problem<'_, N>) -> Result<Self::Output> {
        let fit = &self.together.fit;
        let minima = minima(problem, fit, &self.starts)?;
        let drawn = posterior(problem, fit, &minima, self.sampling, self.go_on)?;
        Ok((drawn, minima))
    }
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

fn loss(options: &FitOptions, recordings: &[Recording]) -> Result<Loss> {
    let usual = || {
        let spreads = recordings.iter().map(|one| spread(&one.record.friction));
        LARGE * spreads.fold(f64::MIN_POSITIVE, f64::max)
    };
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
