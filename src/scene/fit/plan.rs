//! Fits from options: which laws, what is free, where the search begins.

use super::data::Measured;
use super::motion::loaded;
use super::options::{FitOptions, USUALLY_FREE};
use super::unit::GivenStiffness;
use crate::error::{Error, Result, did_you_mean};
use crate::fit::{
    DRIFT, Fit, FreeParameter, Guess, Intervals, Loss, Motion, Problem, Record, Scale, Sliders,
    fit, guess, spread,
};
use crate::friction::{AnyLaw, Law, positive};
use crate::model::Slider;
use crate::model::scales::Scales;
use crate::scene::set::assignments;
use crate::scene::text::TextSlider;
use crate::scene::units::Units;
use std::path::Path;

/// c of the paper.
const RESIDUAL_STRENGTH: f64 = 1e-3;
/// R of the paper, in L/V*.
const HEALING_TIME: f64 = 100.0;
/// Large residuals for a loss that lets them count less, in standard deviations from sample to sample.
const LARGE: f64 = 3.0;
/// Values of parameters stay between these, and those of others between minus and plus the larger.
const DOMAIN: (f64, f64) = (1e-30, 1e30);
/// b_2 over b and L_2 over L, where the search begins.
const SECOND: [(f64, f64); 2] = [(0.3, 5.0), (0.3, 0.2)];

/// A fit that is asked for, checked.
#[derive(Debug, Clone, PartialEq)]
pub struct FitPlan {
    /// What was measured.
    pub measured: Measured,
    /// How the load point moved.
    pub motion: Motion,
    /// What is fitted.
    pub record: Record,
    /// The laws, in the order in which they were asked for.
    pub laws: Vec<LawToFit>,
    /// What its largest step shows.
    shown: Option<Guess>,
    /// How residuals count.
    pub loss: Loss,
    /// How 95 % intervals are made.
    pub intervals: Intervals,
    /// V* in m/s.
    pub reference_rate: f64,
}

/// A law with what is fitted of it.
#[derive(Debug, Clone, PartialEq)]
pub struct LawToFit {
    /// Its name, or its file.
    pub name: String,
    /// State variables.
    pub states: usize,
    model: Model,
    /// The names of all parameters, and their values: where they are fixed, and where one was given for the search to begin with.
    values: Vec<(&'static str, Option<f64>)>,
    free: Vec<FreeParameter>,
    drift: f64,
}

#[derive(Debug, Clone, PartialEq)]
enum Model {
    BuiltIn(Slider),
    Text(Box<TextSlider>),
}

impl FitPlan {
    /// Checks the options and reads the record.
    ///
    /// # Errors
    /// [`Error::Parameter`], [`Error::Input`] and [`Error::File`], in the user's own names.
    pub fn new(options: &FitOptions) -> Result<Self> {
        let measured = Measured::read(options)?;
        let (motion, steps, record) = loaded(options, &measured)?;
        let reference_rate = match options.reference_rate {
            Some(rate) => positive("reference-rate", rate)?,
            None => motion.before,
        };
        let given = Given::new(options, measured.normal_stress)?;
        let shown = guess(&record, &steps, reference_rate);
        let names = options.law.split(',').map(str::trim);
        let laws = names.map(|name| LawToFit::new(name, options, &given, shown, reference_rate));
        Ok(FitPlan {
            laws: laws.collect::<Result<_>>()?,
            loss: loss(options, &record)?,
            intervals: match options.intervals.as_str() {
                "profile" => Intervals::Profile,
                "linear" => Intervals::Linear,
                other => return Err(Error::unknown("intervals", other, &["profile", "linear"])),
            },
            measured,
            motion,
            shown,
            record,
            reference_rate,
        })
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
                let free: Vec<&str> = law.free.iter().map(|free| free.name.as_str()).collect();
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
            "plan of this command\n  {} samples from {} to {} s; {} stretches of the load point, the first at {:e} m/s\n  {}\n  power series with derivatives along each run; Levenberg-Marquardt; errors by the autoregression of the residuals",
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
        self.fit_from(law, (&self.motion, &self.record), self.shown)
    }

    /// Fits a law to another record, such as a part of the whole.
    ///
    /// # Errors
    /// Those of [`fit()`].
    pub fn fit_to(&self, law: &LawToFit, motion: &Motion, record: &Record) -> Result<Fit> {
        let shown = guess(record, motion, self.reference_rate);
        self.fit_from(law, (motion, record), shown)
    }

    fn fit_from(
        &self,
        law: &LawToFit,
        to: (&Motion, &Record),
        shown: Option<Guess>,
    ) -> Result<Fit> {
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

struct SteadyBand<'a> {
    fit: &'a Fit,
    rates: &'a [f64],
    reference_rate: f64,
}

impl WithProblem for SteadyBand<'_> {
    type Output = Vec<[f64; 3]>;
    fn call<const N: usize>(&mut self, problem: &Problem<'_, N>) -> Result<Vec<[f64; 3]>> {
        /// Standard errors on each side of a 95 % band.
        const SIDE: f64 = 1.96;
        let errors = self.fit.standard_errors();
        let of = |&v: &f64| {
            let (mu, slopes) = problem.steady(&self.fit.variables, v / self.reference_rate)?;
            let each: Vec<f64> = slopes.iter().zip(&errors).map(|(s, e)| s * e).collect();
            let pairs = (0..each.len()).flat_map(|i| (0..each.len()).map(move |j| (i, j)));
            let variance: f64 = pairs
                .map(|(i, j)| each[i] * self.fit.correlation[(i, j)] * each[j])
                .sum();
            let side = SIDE * variance.max(0.0).sqrt();
            Ok([mu, mu - side, mu + side])
        };
        self.rates.iter().map(of).collect()
    }
}

impl LawToFit {
    fn new(
        name: &str,
        options: &FitOptions,
        given: &Given,
        shown: Option<Guess>,
        reference_rate: f64,
    ) -> Result<Self> {
        let states = options.states;
        if !(1..=2).contains(&states) {
            return Err(Error::parameter("states", states, "1 or 2"));
        }
        let is_file = name.ends_with(".toml") || name.contains('\n') || Path::new(name).is_file();
        let (model, has) = if is_file && !AnyLaw::NAMES.contains(&name) {
            if states == 2 {
                let what = "`states` 2: laws from files have one state variable";
                return Err(Error::Input(what.into()));
            }
            let slider = TextSlider::read(Path::new(name), reference_rate)?;
            let has = Sliders::<3>::names(&slider);
            (Model::Text(Box::new(slider)), has)
        } else {
            let slider = Slider::new(name, reference_rate)?;
            let has = names_of(slider, states);
            (Model::BuiltIn(slider), has)
        };
        let label = match &model {
            Model::Text(law) if name.contains('\n') => law.name().to_owned(),
            _ => name.to_owned(),
        };
        let all = match &model {
            Model::BuiltIn(_) => Slider::NAMES.to_vec(),
            Model::Text(_) => has.clone(),
        };
        let given = given.of(&has, &label, !options.law.contains(','))?;
        let usual: String = match states {
            2 => format!("{USUALLY_FREE},evolution_effect_2,slip_length_2"),
            _ => USUALLY_FREE.into(),
        };
        let asked = options.free.clone();
        let mut names: Vec<String> = Vec::new();
        for name in asked.as_deref().unwrap_or(&usual).split(',').map(str::trim) {
            let name = name.replace('-', "_");
            let known = has.contains(&name.as_str()) || name == DRIFT;
            let alone = !options.law.contains(',');
            if !known && asked.is_some() && alone {
                let mut known = has.clone();
                known.push(DRIFT);
                let near = did_you_mean(&name, known.iter().copied());
                return Err(Error::Input(format!(
                    "`free` {name}: the law {label} has the parameters {}{near}",
                    known.join(", ")
                )));
            }
            // By default what has a value is fixed.
            let is_fixed =
                asked.is_none() && given.iter().any(|(own, x)| *own == name && x.is_some());
            if known && !is_fixed && !names.contains(&name) {
                names.push(name);
            }
        }
        let constants = match &model {
            Model::Text(law) => law.constants(),
            Model::BuiltIn(_) => &[],
        };
        let mut values = Vec::with_capacity(all.len());
        for name in all {
            let own = given
                .iter()
                .find(|(own, _)| *own == name)
                .and_then(|(_, x)| *x);
            let in_file = constants
                .iter()
                .find(|(own, _)| own == name)
                .map(|(_, x)| *x);
            let value = own.or(in_file);
            let needed = has.contains(&name)
                && value.is_none()
                && !["healing_time", "residual_strength"].contains(&name);
            if needed && !names.iter().any(|free| free == name) {
                names.push(name.to_owned());
            }
            values.push((name, value));
        }
        let mut free = Vec::with_capacity(names.len());
        for name in names {
            let scale = scale(&name, constants);
            let bounds = bounds(options, &name, scale)?;
            free.push(FreeParameter {
                name,
                scale,
                bounds,
            });
        }
        if free.is_empty() {
            return Err(Error::Input("`free`: nothing is free".into()));
        }
        unknown_bounds(options, &free)?;
        let law = LawToFit {
            name: label,
            states,
            model,
            values,
            free,
            drift: options.drift.unwrap_or(0.0),
        };
        if shown.is_none() && law.starts(None, reference_rate).is_empty() {
            return Err(Error::Input(format!(
                "the record shows no step by itself: give values of {} for the search to begin with",
                law.free
                    .iter()
                    .filter(|free| law.value(&free.name).is_none() && free.name != DRIFT)
                    .map(|free| free.name.as_str())
                    .collect::<Vec<_>>()
                    .join(", ")
            )));
        }
        Ok(law)
    }

    /// What is fitted of it.
    pub fn free(&self) -> &[FreeParameter] {
        &self.free
    }

    fn value(&self, name: &str) -> Option<f64> {
        let known = self.values.iter().find(|(own, _)| *own == name);
        known.and_then(|(_, value)| *value)
    }

    /// All parameters that are fixed, in SI; the stiffness as friction per metre.
    pub fn fixed(&self, reference_rate: f64) -> Vec<(&'static str, f64)> {
        let has: Vec<&'static str> = match &self.model {
            Model::BuiltIn(slider) => names_of(*slider, self.states),
            Model::Text(law) => Sliders::<3>::names(&**law),
        };
        let all = self.values.iter().map(|(name, _)| *name);
        all.zip(self.parameters(reference_rate))
            .filter(|(name, _)| has.contains(name) && !self.free.iter().any(|f| f.name == *name))
            .collect()
    }

    /// The values of all parameters of the slider; where free any, 1 without one.
    fn parameters(&self, reference_rate: f64) -> Vec<f64> {
        let length = self.value("slip_length").unwrap_or(1e-5);
        let default = |name: &str| match name {
            "healing_time" => HEALING_TIME * length / reference_rate,
            "residual_strength" => RESIDUAL_STRENGTH,
            _ => 1.0,
        };
        let all = self.values.iter();
        all.map(|(name, value)| value.unwrap_or_else(|| default(name)))
            .collect()
    }

    /// Where the search may begin: at the given values, and at what the record shows, lengths and stiffness varied.
    fn starts(&self, shown: Option<Guess>, reference_rate: f64) -> Vec<Vec<f64>> {
        let of = |length: f64, stiffness: f64, second: (f64, f64), use_given: bool| {
            let each = self.free.iter().map(|free| {
                let given = self.value(&free.name).filter(|_| use_given);
                let value = given.or_else(|| {
                    let Guess {
                        direct_effect,
                        evolution_effect,
                        slip_length,
                        stiffness: steep,
                        reference_friction,
                    } = shown?;
                    Some(match free.name.as_str() {
                        "direct_effect" => direct_effect,
                        "evolution_effect" => evolution_effect,
                        "slip_length" => slip_length * length,
                        "stiffness" => steep * stiffness,
                        "reference_friction" => reference_friction,
                        "evolution_effect_2" => second.0 * evolution_effect,
                        "slip_length_2" => second.1 * slip_length * length,
                        _ => return None,
                    })
                });
                let value = value.or_else(|| match free.name.as_str() {
                    DRIFT => Some(self.drift),
                    "healing_time" => {
                        let length = shown.map_or(1e-5, |shown| shown.slip_length);
                        Some(HEALING_TIME * length / reference_rate)
                    }
                    "residual_strength" => Some(RESIDUAL_STRENGTH),
                    // A law from a file has values of its own.
                    name => self.value(name),
                })?;
                Some(value.clamp(free.bounds.0, free.bounds.1))
            });
            each.collect::<Option<Vec<f64>>>()
        };
        let mut starts = Vec::new();
        let seconds = if self.states == 2 {
            &SECOND[..]
        } else {
            &SECOND[..1]
        };
        for &second in seconds {
            starts.extend(of(1.0, 1.0, second, true));
            for length in [1.0, 0.3, 3.0] {
                for stiffness in [1.0, 0.4, 2.5] {
                    starts.extend(of(length, stiffness, second, false));
                }
            }
        }
        starts.dedup();
        starts
    }

    /// The steady friction coefficient at these slip rates in m/s, and the ends of its 95 % band.
    ///
    /// # Errors
    /// Those of [`Problem::steady`].
    pub fn steady_band(&self, plan: &FitPlan, fit: &Fit, rates: &[f64]) -> Result<Vec<[f64; 3]>> {
        let mut band = SteadyBand {
            fit,
            rates,
            reference_rate: plan.reference_rate,
        };
        self.with_problem(plan, (&plan.motion, &plan.record), &mut band)
    }

    /// Does something with the problem of this law.
    ///
    /// # Errors
    /// Its own.
    pub fn with_problem<W: WithProblem>(
        &self,
        plan: &FitPlan,
        (motion, record): (&Motion, &Record),
        what: &mut W,
    ) -> Result<W::Output> {
        let parts = (plan, motion, record);
        match &self.model {
            Model::BuiltIn(slider) if self.states == 2 => {
                what.call(&self.problem::<4>(slider, parts))
            }
            Model::BuiltIn(slider) => what.call(&self.problem::<3>(slider, parts)),
            Model::Text(slider) => what.call(&self.problem::<3>(&**slider, parts)),
        }
    }

    fn problem<'a, const N: usize>(
        &'a self,
        sliders: &'a dyn Sliders<N>,
        (plan, motion, record): (&'a FitPlan, &'a Motion, &'a Record),
    ) -> Problem<'a, N> {
        Problem {
            sliders,
            motion,
            record,
            parameters: self.parameters(plan.reference_rate),
            drift: self.drift,
            free: self.free.clone(),
            loss: plan.loss,
        }
    }
}

/// The parameters that a slider with a built-in law has.
fn names_of(slider: Slider, states: usize) -> Vec<&'static str> {
    let mut law = slider.law;
    let [_, _, healing, residual, _] = law.constants().map(|constant| constant.is_some());
    let has = |name: &&str| match *name {
        "healing_time" => healing,
        "residual_strength" => residual,
        "evolution_effect_2" | "slip_length_2" => states == 2,
        _ => true,
    };
    Slider::NAMES.into_iter().filter(has).collect()
}

/// Positive ones by their logarithm; b_2, the offset and the slope, and what is zero or negative in a file, by themselves.
fn scale(name: &str, constants: &[(String, f64)]) -> Scale {
    let of_file = constants.iter().find(|(own, _)| own == name);
    let signed = ["reference_friction", "evolution_effect_2", DRIFT].contains(&name);
    if signed || of_file.is_some_and(|(_, value)| *value <= 0.0) {
        Scale::Linear
    } else {
        Scale::Logarithmic
    }
}

/// Between what a parameter is looked for.
fn bounds(options: &FitOptions, name: &str, scale: Scale) -> Result<(f64, f64)> {
    let (least, most) = match scale {
        Scale::Logarithmic => DOMAIN,
        Scale::Linear => (-DOMAIN.1, DOMAIN.1),
    };
    let Some((text, own)) = options.bounds.iter().find_map(|text| {
        let (own, range) = text.split_once('=')?;
        (own.trim().replace('-', "_") == name).then_some((text, range))
    }) else {
        return Ok((least, most));
    };
    let wrong = || Error::Input(format!("`bounds` {text:?} must be NAME=A:B with A below B"));
    let (low, high) = own.split_once(':').ok_or_else(wrong)?;
    let read = |text: &str| text.trim().parse::<f64>().map_err(|_| wrong());
    let (low, high) = (read(low)?, read(high)?);
    if low >= high {
        return Err(wrong());
    }
    if low < least {
        return Err(Error::Input(format!(
            "`bounds` {text:?}: {name} is positive, so must be its lower bound"
        )));
    }
    Ok((low, high.min(most)))
}

/// # Errors
/// [`Error::Input`] for bounds of what is not free.
fn unknown_bounds(options: &FitOptions, free: &[FreeParameter]) -> Result<()> {
    for text in &options.bounds {
        let name = text
            .split('=')
            .next()
            .unwrap_or(text)
            .trim()
            .replace('-', "_");
        if !free.iter().any(|free| free.name == name) {
            return Err(Error::Input(format!(
                "`bounds` {text:?}: {name} is not fitted"
            )));
        }
    }
    Ok(())
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

/// The values that were given, by the names of parameters; the stiffness as friction per metre.
struct Given(Vec<(String, f64)>);

impl Given {
    fn new(options: &FitOptions, normal_stress: Option<f64>) -> Result<Self> {
        let stiffness = match &options.stiffness {
            None => None,
            Some(text) => Some(match (GivenStiffness::read(text)?, normal_stress) {
                (GivenStiffness::OfFriction(k), _) => k,
                (GivenStiffness::OfStress(k), Some(sigma)) => k / sigma,
                (GivenStiffness::OfStress(_), None) => {
                    return Err(Error::Input(
                        "`stiffness` in Pa/m needs the `normal_stress`; or give it as friction per length, such as 0.003/um".into(),
                    ));
                }
            }),
        };
        let mut given = Vec::new();
        for (name, value) in [
            ("direct_effect", options.direct_effect),
            ("evolution_effect", options.evolution_effect),
            ("slip_length", options.slip_length),
            ("slip_length_2", options.slip_length_2),
            ("reference_friction", options.reference_friction),
            ("healing_time", options.healing_time),
            ("stiffness", stiffness),
        ] {
            let checked = value.map(|x| positive(&name.replace('_', "-"), x));
            given.extend(checked.transpose()?.map(|x| (name.to_owned(), x)));
        }
        for (name, value) in [
            ("evolution_effect_2", options.evolution_effect_2),
            ("residual_strength", options.residual_strength),
        ] {
            given.extend(value.map(|x| (name.to_owned(), x)));
        }
        for (name, value) in assignments(&options.set)? {
            given.push((name.replace('-', "_"), value));
        }
        Ok(Given(given))
    }

    /// Those of a law's parameters.
    fn of(
        &self,
        has: &[&'static str],
        law: &str,
        alone: bool,
    ) -> Result<Vec<(&'static str, Option<f64>)>> {
        // Of several laws one has what another has not.
        let strange = self
            .0
            .iter()
            .find(|(name, _)| !has.contains(&name.as_str()));
        if let Some((name, _)) = strange.filter(|_| alone) {
            return Err(Error::Input(format!(
                "`{name}` is no parameter of the law {law}, which has {}",
                has.join(", ")
            )));
        }
        let value = |name: &str| {
            self.0
                .iter()
                .rev()
                .find(|(own, _)| own == name)
                .map(|(_, x)| *x)
        };
        Ok(has.iter().map(|name| (*name, value(name))).collect())
    }
}
