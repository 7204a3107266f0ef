//! From the model's options to a checked system, and back to what the output says about it.

use super::options::{ModelOptions, SlabOptions};
use super::program::Program;
use super::shipped::{law_names, shipped_law};
use super::text::given_text;
use super::unequal::OfOne;
use super::units::{Quantity, TimeUnit, Units};
use serde_json::{Map, Value, json};
use std::path::Path;
use twinslip::equilibrium::MOST_INTERFACES;
use twinslip::error::{Error, Result};
use twinslip::friction::{
    AnyLaw, InterfaceConstants, Law, Parameters, ScaledLaw, UnequalLaws, positive, steady_stress,
};
use twinslip::model::scales::Scales;
use twinslip::model::{Loading, UnequalInterfaces};

/// L in m, fitted by the paper to Heslot et al. (1994).
pub(super) const SLIP_LENGTH: f64 = 0.9e-6;
/// V* in m/s of the paper.
pub(super) const REFERENCE_RATE: f64 = 1e-6;
/// sigma in Pa. The paper states none.
pub(super) const NORMAL_STRESS: f64 = 1e6;
/// R of the paper.
pub(super) const HEALING_TIME: f64 = 100.0;
/// c of the paper.
const RESIDUAL_STRENGTH: f64 = 1e-3;
/// a, b and a_v of the paper.
const DIRECT_EFFECT: f64 = 0.0349;
const EVOLUTION_EFFECT: f64 = 0.0489;
const REFERENCE_FRICTION: f64 = 0.369;

impl SlabOptions {
    /// c
    pub(super) fn c(&self) -> f64 {
        self.residual_strength.unwrap_or(RESIDUAL_STRENGTH)
    }

    /// a
    pub(super) fn a(&self) -> f64 {
        self.direct_effect.unwrap_or(DIRECT_EFFECT)
    }

    /// b
    pub(super) fn b(&self) -> f64 {
        self.evolution_effect.unwrap_or(EVOLUTION_EFFECT)
    }

    /// The file of a user-defined law, or its text; `None` where the law is built in.
    pub(super) fn law_file(&self) -> Option<&Path> {
        let path = Path::new(&self.law);
        let is_file = given_text(path).is_some()
            || path.extension().is_some_and(|ending| ending == "toml")
            || path.is_file()
            || shipped_law(path).is_some();
        (!AnyLaw::NAMES.contains(&self.law.as_str()) && is_file).then_some(path)
    }

    /// Whether the law is a file that the program carries.
    pub(super) fn law_is_shipped(&self) -> bool {
        let path = Path::new(&self.law);
        given_text(path).is_none() && !path.exists() && shipped_law(path).is_some()
    }

    /// What messages call the law: not its text, where that was given.
    pub(super) fn law_told(&self) -> &str {
        given_text(Path::new(&self.law)).map_or(&self.law, |_| "(a text)")
    }

    /// How many interfaces there are: as many as are asked for, else as in all clusters, else 2.
    pub fn count(&self) -> u32 {
        let in_clusters = |text: &String| {
            let counts = text.split(',').map(|part| part.trim().parse().ok());
            let sum: Option<Vec<u32>> = counts.collect();
            sum?.into_iter().try_fold(0, u32::checked_add)
        };
        let in_all = || self.clusters.as_ref().and_then(in_clusters);
        self.interfaces.or_else(in_all).unwrap_or(2)
    }

    /// Whether there are clusters of interfaces, or more interfaces than two: they are made of the law's formulas.
    pub fn has_clusters(&self) -> bool {
        self.clusters.is_some() || self.count() > 2
    }

    /// How many interfaces there are, of a command that takes one or two.
    ///
    /// # Errors
    /// [`Error::Parameter`] where that are neither 1 nor 2; [`Error::Input`] for clusters.
    pub(super) fn checked_interfaces(&self) -> Result<usize> {
        if self.clusters.is_some() {
            return Err(Error::Input(
                "`clusters`: this command takes none; integrate, orbit, section, branch, locus and sweep do".into(),
            ));
        }
        match self.count() {
            1 => Ok(1),
            2 => Ok(2),
            0 => Err(Error::parameter("interfaces", 0, "at least 1")),
            other => Err(Error::parameter("interfaces", other, "1 or 2")),
        }
    }

    /// a_v
    pub(super) fn a_v(&self) -> f64 {
        self.reference_friction.unwrap_or(REFERENCE_FRICTION)
    }
}

/// What a result is of, as the output tells it.
pub trait Described {
    /// Every parameter, in the user's units.
    fn echo(&self) -> &Map<String, Value>;
    /// What its numbers are measured in.
    fn units(&self) -> &Units;
}

/// What slides, checked and dimensionless, with the units that lead back.
#[derive(Debug, Clone, PartialEq)]
pub struct System {
    /// The law of every interface; of interfaces that differ that of the first.
    pub law: AnyLaw,
    /// The laws of two interfaces that differ, where they do.
    pub unequal: Option<UnequalLaws>,
    /// The constants of each interface.
    pub constants: [InterfaceConstants; 2],
    /// How many there are.
    pub interfaces: usize,
    /// V_H, where given.
    pub driving: Option<f64>,
    /// K, where given.
    pub stiffness: Option<f64>,
    /// What numbers are measured in.
    pub units: Units,
    /// a: friction = a tau.
    pub direct_effect: f64,
    echo: Map<String, Value>,
}

impl System {
    /// Checks the options.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a value outside its domain, in the user's own name and number.
    pub fn new(options: &ModelOptions) -> Result<Self> {
        let options = options.resolved()?;
        Self::of(&options.slab, options.driving, options.stiffness)
    }

    /// The same of any number of interfaces, which are equal where they are more than two.
    ///
    /// # Errors
    /// As [`System::new`]; [`Error::Input`] for more than two that differ.
    pub(super) fn several(options: &ModelOptions) -> Result<Self> {
        let interfaces = options.slab.count() as usize;
        if options.slab.clusters.is_none() && !(1..=MOST_INTERFACES).contains(&interfaces) {
            let must = format!(
                "between 1 and {MOST_INTERFACES}: the number of partitions of more interfaces is beyond the range of doubles"
            );
            return Err(Error::parameter("interfaces", interfaces, must));
        }
        Self::of_many(options)
    }

    /// The same of so many that not all their steady states can be found.
    ///
    /// # Errors
    /// As of [`System::several`], but for their number.
    pub(super) fn of_many(options: &ModelOptions) -> Result<Self> {
        let options = options.resolved()?;
        let (slab, interfaces) = (&options.slab, options.slab.count() as usize);
        if slab.clusters.is_some() {
            return Err(Error::Input(
                "`clusters`: the steady states of all clusters are found without it; leave it out"
                    .into(),
            ));
        }
        if interfaces > 2 && slab.law_file().is_some() {
            return Err(Error::Input(format!(
                "`law` {} is from a file; the steady states of {interfaces} interfaces need a built-in law, those of one or two take any law",
                slab.law_told()
            )));
        }
        if interfaces > 2 && slab.sets_one_interface()? {
            return Err(Error::Input(format!(
                "`set`: this command takes {interfaces} interfaces only if they are equal; two may differ, and more in `integrate` and `branch equilibria`"
            )));
        }
        Self::counted(slab, interfaces, options.driving, options.stiffness)
    }

    /// Checks a slab, and V_H and K where they are fixed.
    ///
    /// # Errors
    /// As [`System::new`].
    pub fn of(options: &SlabOptions, driving: Option<f64>, stiffness: Option<f64>) -> Result<Self> {
        Self::counted(options, options.checked_interfaces()?, driving, stiffness)
    }

    fn counted(
        options: &SlabOptions,
        interfaces: usize,
        driving: Option<f64>,
        stiffness: Option<f64>,
    ) -> Result<Self> {
        if options.text.system.is_some() {
            return Err(Error::Input(
                "`system` names a user-defined system, and this command is for interfaces; integrate, equilibria, section, orbit, branch, locus and sweep take it".into(),
            ));
        }
        if options.law_file().is_some() {
            return Err(Error::Input(format!(
                "`law` {} is a law from a file; law, integrate, equilibria, section, orbit, branch, locus and sweep take it",
                options.law_told()
            )));
        }
        if options.needs_formulas(&[])? {
            return Err(Error::Input(
                "`second_evolution_effect`, `second_slip_length`, `mass` and `modulate`: this command takes interfaces with one state variable, without mass and under a constant normal stress; law, integrate, equilibria, section, orbit, branch, locus and sweep of up to 7 interfaces take the first three, integrate the last".into(),
            ));
        }
        let of_one = OfOne::read(options)?;
        let first = of_one.first(options);
        let own = [0, 1].map(|i| of_one.constants(i, common(options, &first)));
        let differ = interfaces == 2 && own[0] != own[1];
        let (all, options) = (options, &first);
        // Checked in the user's numbers, before any conversion, so that the message shows what was typed.
        for (name, value) in [
            ("driving", driving),
            ("stiffness", stiffness),
            ("healing-time", options.healing_time),
        ] {
            value.map(|value| positive(name, value)).transpose()?;
        }
        let scales = options.si.then(|| scales(options)).transpose()?;
        let time = scales.map_or(1.0, |s| s.time);
        let damping = damping(options)?;
        let healing_time = options.healing_time.unwrap_or(HEALING_TIME * time);
        let parameters = Parameters::new(
            options.a(),
            options.b(),
            options.a_v(),
            positive("healing-time", healing_time / time)?,
            options.c(),
        )?
        .damped(damping / scales.map_or(1.0, |s| s.stress / s.slip_rate))?;
        if !AnyLaw::NAMES.contains(&options.law.as_str()) {
            return Err(Error::unknown("law", &options.law, &law_names()));
        }
        let law = AnyLaw::named(&options.law, parameters)?;
        let mut echo = echo(
            if differ { all } else { options },
            (driving, stiffness),
            (healing_time, damping),
        );
        let [_, _, _, _, _, length, stress] = own[0];
        let constants = own.map(|[r, c, a, b, a_v, l, sigma]| {
            InterfaceConstants::from([r / time, c, a, b, a_v, l / length, sigma / stress])
        });
        let unequal = if differ {
            of_one.echo(&own, &mut echo);
            Some(UnequalLaws::new(
                &options.law,
                constants,
                parameters.damping,
            )?)
        } else {
            None
        };
        let units =
            Units::new(scales, !law.bounds_state()).in_time(TimeUnit::named(&options.time_unit)?);
        let inward = |quantity, name, value: Option<f64>| {
            value
                .map(|x| positive(name, units.inward(quantity, x)))
                .transpose()
        };
        Ok(System {
            law,
            unequal,
            constants,
            interfaces,
            driving: inward(Quantity::SlipRate, "driving", driving)?,
            stiffness: inward(Quantity::Stiffness, "stiffness", stiffness)?,
            units,
            direct_effect: options.a(),
            echo,
        })
    }

    /// The same where V_H changes on the way, with V_H before the first change: what is given, which may be 0, or that of a change
    /// at the beginning.
    ///
    /// # Errors
    /// As [`System::new`]; [`Error::Input`] that names the missing option.
    pub(super) fn programmed(options: &ModelOptions, program: &Program) -> Result<(Self, Loading)> {
        let options = options.resolved()?;
        if let Some(driving) = options.driving.filter(|&driving| driving < 0.0) {
            return Err(Error::parameter("driving", driving, "0 or positive"));
        }
        let moving = options.driving.filter(|&driving| driving != 0.0);
        let mut system = Self::of(&options.slab, moving, options.stiffness)?;
        let first = match (options.driving, program.first()) {
            (Some(_), _) => system.driving.unwrap_or(0.0),
            (None, Some(first)) => system.units.inward(Quantity::SlipRate, first),
            (None, None) => {
                return Err(Error::Input(
                    "`driving` V_H is missing: which velocity is it before the first change of `program`?"
                        .into(),
                ));
            }
        };
        let echo = &mut system.echo;
        echo.insert("driving".into(), json!(options.driving.map(|v| v + 0.0)));
        echo.insert("program".into(), json!(program.told()));
        let stiffness = system.needed_stiffness()?;
        let loading = Loading {
            driving: first,
            stiffness,
        };
        Ok((system, loading))
    }

    /// These interfaces measured in other SI units of stress, length and time with the same V*.
    ///
    /// # Errors
    /// Those of [`UnequalLaws::new`].
    pub(super) fn measured_in(self, units: &Units) -> Result<Self> {
        if self.units == *units {
            return Ok(self);
        }
        let ratio = |quantity| self.units.factor(quantity) / units.factor(quantity);
        let constants = self.constants.map(|own| InterfaceConstants {
            healing_time: own.healing_time * ratio(Quantity::Time),
            slip_length: own.slip_length * ratio(Quantity::Length),
            normal_stress: own.normal_stress * ratio(Quantity::NormalStress),
            ..own
        });
        let damping = self.law.damping() * ratio(Quantity::Damping);
        let unit = units.factor(Quantity::Stress) / units.factor(Quantity::NormalStress);
        let laws = UnequalLaws::new(self.law.name(), constants, damping)?.measured_in(unit)?;
        Ok(System {
            unequal: Some(laws),
            constants,
            stiffness: self.stiffness.map(|k| k * ratio(Quantity::Stiffness)),
            units: *units,
            ..self
        })
    }

    /// Tells that a parameter varies: it has no one value.
    pub(super) fn vary(&mut self, name: &str) {
        self.echo.insert(name.to_owned(), Value::Null);
    }

    /// The same for a command that takes equal interfaces alone.
    ///
    /// # Errors
    /// [`Error::Input`] for interfaces that differ.
    pub(super) fn alike(self, command: &str) -> Result<Self> {
        match self.unequal {
            None => Ok(self),
            Some(_) => Err(Error::Input(format!(
                "`set`: {command} takes equal interfaces, and these differ; integrate, equilibria, orbit, section, branch, locus and sweep take interfaces that differ"
            ))),
        }
    }

    /// Interfaces that differ under this loading, where they do.
    pub fn unequal(&self, loading: Loading) -> Option<UnequalInterfaces> {
        self.unequal.map(|laws| UnequalInterfaces { laws, loading })
    }

    /// The law of each interface in the units of the first.
    pub fn laws(&self) -> [ScaledLaw; 2] {
        match &self.unequal {
            Some(laws) => *laws.laws(),
            None => [self.law.into(); 2],
        }
    }

    /// The steady stress at V_H over the number of interfaces; of interfaces that differ the mean of theirs.
    pub fn steady_stress(&self, driving: f64) -> f64 {
        match &self.unequal {
            Some(laws) if self.interfaces == 1 => steady_stress(&laws.laws()[0], driving),
            Some(laws) => laws.half_driving_stress(driving),
            None => steady_stress(&self.law, driving / self.interfaces as f64),
        }
    }

    /// V_H and K, both needed.
    ///
    /// # Errors
    /// [`Error::Input`] that names the missing option.
    pub fn loading(&self) -> Result<Loading> {
        Loading::new(self.needed_driving()?, self.needed_stiffness()?)
    }

    /// V_H, needed.
    ///
    /// # Errors
    /// [`Error::Input`] that names the missing option.
    pub fn needed_driving(&self) -> Result<f64> {
        self.needed("driving", "V_H", self.driving)
    }

    /// K, needed.
    ///
    /// # Errors
    /// [`Error::Input`] that names the missing option.
    pub fn needed_stiffness(&self) -> Result<f64> {
        self.needed("stiffness", "K", self.stiffness)
    }

    fn needed(&self, name: &str, symbol: &str, value: Option<f64>) -> Result<f64> {
        value.ok_or_else(|| {
            Error::Input(format!("`{name}` {symbol} is missing, and has no default"))
        })
    }
}

impl Described for System {
    fn echo(&self) -> &Map<String, Value> {
        &self.echo
    }

    fn units(&self) -> &Units {
        &self.units
    }
}

/// The constants that interfaces have where none has its own, in the user's units; `first` are the options of the first one.
fn common(options: &SlabOptions, first: &SlabOptions) -> [f64; 7] {
    let si = |value: Option<f64>, default| {
        if options.si {
            value.unwrap_or(default)
        } else {
            1.0
        }
    };
    // The default is in L_1/V*.
    let length = si(first.slip_length, SLIP_LENGTH);
    let time = length / si(options.reference_rate, REFERENCE_RATE);
    [
        options.healing_time.unwrap_or(HEALING_TIME * time),
        options.c(),
        options.a(),
        options.b(),
        options.a_v(),
        si(options.slip_length, SLIP_LENGTH),
        si(options.normal_stress, NORMAL_STRESS),
    ]
}

/// The units of SI by these options.
pub(super) fn scales(options: &SlabOptions) -> Result<Scales> {
    Scales::new(
        options.a(),
        options.slip_length.unwrap_or(SLIP_LENGTH),
        options.reference_rate.unwrap_or(REFERENCE_RATE),
        options.normal_stress.unwrap_or(NORMAL_STRESS),
    )
}

/// eta in the user's units: itself, or G/(2 c_s).
pub(super) fn damping(options: &SlabOptions) -> Result<f64> {
    match (options.shear_modulus, options.shear_wave_speed) {
        (Some(modulus), Some(speed)) => {
            Ok(positive("shear-modulus", modulus)? / (2.0 * positive("shear-wave-speed", speed)?))
        }
        (Some(_), None) | (None, Some(_)) => Err(Error::Input(
            "`shear-modulus` and `shear-wave-speed` give the damping only together".into(),
        )),
        (None, None) => {
            let damping = options.damping.unwrap_or(0.0);
            // In the user's number; the law's own check has another.
            if damping >= 0.0 && damping.is_finite() {
                return Ok(damping);
            }
            let must = "zero or positive, and finite";
            Err(Error::parameter("damping", damping, must))
        }
    }
}

fn echo(
    options: &SlabOptions,
    (driving, stiffness): (Option<f64>, Option<f64>),
    (healing_time, damping): (f64, f64),
) -> Map<String, Value> {
    let mut pairs = vec![
        ("law", json!(options.law)),
        ("interfaces", json!(options.count())),
        ("driving", json!(driving)),
        ("stiffness", json!(stiffness)),
        ("healing_time", json!(healing_time)),
        ("residual_strength", json!(options.c())),
        ("direct_effect", json!(options.a())),
        ("evolution_effect", json!(options.b())),
        ("reference_friction", json!(options.a_v())),
        ("damping", json!(damping)),
        ("si", json!(options.si)),
    ];
    if options.si {
        let or = |value: Option<f64>, default: f64| json!(value.unwrap_or(default));
        pairs.extend([
            ("slip_length", or(options.slip_length, SLIP_LENGTH)),
            ("reference_rate", or(options.reference_rate, REFERENCE_RATE)),
            ("normal_stress", or(options.normal_stress, NORMAL_STRESS)),
            ("time_unit", json!(options.time_unit)),
        ]);
    }
    pairs
        .into_iter()
        .map(|(name, value)| (name.to_owned(), value))
        .collect()
}
