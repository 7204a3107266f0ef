//! A law that is fitted: its parameters, which are free, where the search begins.

use super::given::{Given, bounds, is_negative, unknown_bounds};
use super::options::{FitOptions, USUALLY_FREE};
use super::plan::{FitPlan, Piece, Recording, WithProblem};
use crate::scene::shipped::shipped_law;
use crate::scene::text::TextSlider;
use std::path::Path;
use twinslip::error::{Error, Result, did_you_mean};
use twinslip::fit::{DRIFT, Fit, FittedRecord, FreeParameter, Guess, Problem, Scale, Sliders};
use twinslip::friction::{AnyLaw, Law};
use twinslip::model::Slider;

/// c of the paper.
const RESIDUAL_STRENGTH: f64 = 1e-3;
/// R of the paper, in L/V*.
const HEALING_TIME: f64 = 100.0;
/// b_2 over b and L_2 over L, where the search begins.
const SECOND: [(f64, f64); 2] = [(0.3, 5.0), (0.3, 0.2)];

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
    /// Of several records, which of these each has its own of.
    each: Vec<String>,
    drift: f64,
    /// By what a stiffness that is given is multiplied for each recording: in Pa/m it is another friction per metre under another normal stress.
    softer: Vec<f64>,
}

#[derive(Debug, Clone, PartialEq)]
enum Model {
    BuiltIn(Slider),
    Text(Box<TextSlider>),
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
        let of = |&v: &f64| {
            let (mu, slopes) = problem.steady(0, &self.fit.variables, v / self.reference_rate)?;
            let side = SIDE * self.fit.propagated(&slopes);
            Ok([mu, mu - side, mu + side])
        };
        self.rates.iter().map(of).collect()
    }
}

/// The name that a fit has for a parameter of the second state variable, which models call otherwise.
pub(super) fn own_name(name: &str) -> &str {
    match name {
        "second_evolution_effect" => "evolution_effect_2",
        "second_slip_length" => "slip_length_2",
        other => other,
    }
}

impl LawToFit {
    pub(super) fn new(
        name: &str,
        options: &FitOptions,
        recordings: &[Recording],
        reference_rate: f64,
    ) -> Result<Self> {
        let given = &Given::new(options, recordings)?;
        let states = options.states;
        if !(1..=2).contains(&states) {
            return Err(Error::parameter("states", states, "1 or 2"));
        }
        let is_file = name.ends_with(".toml")
            || name.contains('\n')
            || Path::new(name).is_file()
            || shipped_law(Path::new(name)).is_some();
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
        let all_given = given;
        let softer = given.softer(recordings);
        let given = given.of(&has, &label, !options.law.contains(','))?;
        let usual: String = match states {
            2 => format!("{USUALLY_FREE},evolution_effect_2,slip_length_2"),
            _ => USUALLY_FREE.into(),
        };
        let asked = options.free.clone();
        let mut names: Vec<String> = Vec::new();
        for name in asked.as_deref().unwrap_or(&usual).split(',').map(str::trim) {
            let name = own_name(&name.replace('-', "_")).to_owned();
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
            if known && !names.contains(&name) {
                names.push(name);
            }
        }
        // What has a value and is not named is fixed. Values of all are no fit, but its start.
        let is_fixed = |name: &String| given.iter().any(|(own, x)| own == name && x.is_some());
        if asked.is_none() && !names.iter().all(is_fixed) {
            names.retain(|name| !is_fixed(name));
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
            let scale = match is_negative(options, &name) {
                true => Scale::Linear,
                false => scale(&name, constants),
            };
            let bounds = bounds((options, all_given), &name, scale)?;
            free.push(FreeParameter {
                name,
                scale,
                bounds,
                of_record: None,
            });
        }
        if free.is_empty() {
            return Err(Error::Input("`free`: nothing is free".into()));
        }
        unknown_bounds(options, &free)?;
        let law = LawToFit {
            each: each(options, &free)?,
            softer,
            name: label,
            states,
            model,
            values,
            free,
            drift: options.drift.unwrap_or(0.0),
        };
        law.check_stiffness(recordings)?;
        let shows_none = |own: &Recording| law.starts(&own.shown, reference_rate).is_empty();
        if recordings.iter().any(shows_none) {
            return Err(Error::Input(format!(
                "the record has neither a step nor a hold from which to estimate starting values: give values of {}, and list in `free` all that is fitted",
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

    pub(super) fn value(&self, name: &str) -> Option<f64> {
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
    pub(super) fn starts(&self, shown: &[Guess], reference_rate: f64) -> Vec<Vec<f64>> {
        let of =
            |shown: Option<Guess>, (length, stiffness), second: (f64, f64), use_given: bool| {
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
        let mut free = self.free.iter();
        let may_harden = free.any(|one| one.name == "evolution_effect" && one.bounds.0 < 0.0)
            || self.value("evolution_effect").is_some_and(|b| b < 0.0);
        let mut starts = Vec::new();
        let seconds = if self.states == 2 {
            &SECOND[..]
        } else {
            &SECOND[..1]
        };
        for &second in seconds {
            starts.extend(of(shown.first().copied(), (1.0, 1.0), second, true));
            let hardens = shown.iter().filter(|_| may_harden).map(hardening);
            for one in shown.iter().copied().chain(hardens) {
                for length in [1.0, 0.3, 3.0] {
                    for stiffness in [1.0, 0.4, 2.5] {
                        starts.extend(of(Some(one), (length, stiffness), second, false));
                    }
                }
            }
        }
        starts.dedup();
        starts
    }

    /// Which parameters each of several records has its own of.
    pub fn each(&self) -> &[String] {
        &self.each
    }

    /// # Errors
    /// [`Error::Input`] for one stiffness, in friction per metre, of records under different normal stresses.
    fn check_stiffness(&self, recordings: &[Recording]) -> Result<()> {
        /// Normal stresses that differ by less are one.
        const SAME: f64 = 1e-2;
        let name = "stiffness";
        let is_shared = recordings.len() > 1
            && self.free.iter().any(|free| free.name == name)
            && !self.each.iter().any(|own| own == name);
        let stresses = recordings
            .iter()
            .filter_map(|own| own.measured.normal_stress);
        let (low, high) = stresses.fold((f64::INFINITY, 0.0_f64), |(low, high), one| {
            (low.min(one), high.max(one))
        });
        if is_shared && high > low * (1.0 + SAME) {
            return Err(Error::Input(format!(
                "`each` has no stiffness, but the records' normal stresses are {low} to {high} Pa: one stiffness is another friction per length in each"
            )));
        }
        Ok(())
    }

    /// What is looked for in so many records: what they share, then what each has its own of.
    pub(super) fn free_of(&self, records: usize) -> Vec<FreeParameter> {
        let is_own = |free: &&FreeParameter| self.each.contains(&free.name);
        if records == 1 {
            return self.free.clone();
        }
        let shared = self.free.iter().filter(|free| !is_own(free)).cloned();
        let own = (0..records).flat_map(|at| {
            let all = self.free.iter().filter(is_own);
            all.map(move |free| FreeParameter {
                of_record: Some(at),
                ..free.clone()
            })
        });
        shared.chain(own).collect()
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
        self.with_problem(plan, &plan.pieces(), &mut band)
    }

    /// Does something with the problem of this law and some records.
    ///
    /// # Errors
    /// Its own.
    pub fn with_problem<W: WithProblem>(
        &self,
        plan: &FitPlan,
        pieces: &[Piece<'_>],
        what: &mut W,
    ) -> Result<W::Output> {
        match &self.model {
            Model::BuiltIn(slider) if self.states == 2 => {
                what.call(&self.problem::<4>(slider, plan, pieces))
            }
            Model::BuiltIn(slider) => what.call(&self.problem::<3>(slider, plan, pieces)),
            Model::Text(slider) => what.call(&self.problem::<3>(&**slider, plan, pieces)),
        }
    }

    fn problem<'a, const N: usize>(
        &'a self,
        sliders: &'a dyn Sliders<N>,
        plan: &FitPlan,
        pieces: &[Piece<'a>],
    ) -> Problem<'a, N> {
        let names = self.values.iter().map(|(name, _)| *name);
        let parameters = |of: usize| {
            let all = names.clone().zip(self.parameters(plan.reference_rate));
            let own = all.map(|(name, value)| match name {
                "stiffness" => value * self.softer[of],
                _ => value,
            });
            own.collect()
        };
        let records = pieces.iter().map(|piece| FittedRecord {
            record: piece.record,
            motion: piece.motion,
            parameters: parameters(piece.of),
            drift: self.drift,
        });
        Problem {
            sliders,
            records: records.collect(),
            free: self.free_of(pieces.len()),
            loss: plan.loss,
        }
    }
}

/// Which of the parameters that are fitted each of several records has its own of.
fn each(options: &FitOptions, free: &[FreeParameter]) -> Result<Vec<String>> {
    /// Of the apparatus, and what differs from sample to sample.
    const USUALLY: [&str; 3] = ["stiffness", "reference_friction", DRIFT];
    let is_free = |name: &String| free.iter().any(|free| free.name == *name);
    let Some(asked) = &options.each else {
        let usual = USUALLY.into_iter().map(String::from);
        return Ok(usual.filter(is_free).collect());
    };
    let names = asked.split(',').map(|name| name.trim().replace('-', "_"));
    let names: Vec<String> = names.filter(|name| !name.is_empty()).collect();
    match names.iter().find(|name| !is_free(name)) {
        Some(name) => {
            let known: Vec<&str> = free.iter().map(|free| free.name.as_str()).collect();
            Err(Error::Input(format!(
                "`each` {name}: it is not fitted; what is fitted is {}",
                known.join(", ")
            )))
        }
        None => Ok(names),
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

/// What a step shows if friction, after its direct effect, goes on in the direction of the step: b is negative.
fn hardening(shown: &Guess) -> Guess {
    /// Of the change from one steady level to the other, a tells that much, and -b the rest.
    const AT_ONCE: f64 = 0.6;
    /// By what the spring is stiffer than it seems, as friction reaches its peak long after the spring has been stretched.
    const STIFFER: f64 = 10.0;
    let change = shown.direct_effect - shown.evolution_effect;
    Guess {
        direct_effect: AT_ONCE * change.abs(),
        evolution_effect: (AT_ONCE - 1.0) * change.abs(),
        stiffness: STIFFER * shown.stiffness,
        ..*shown
    }
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
