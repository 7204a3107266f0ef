//! Curves of bifurcations from options: of which, and where in the (V_H, K) plane.

use super::continuation::LocusOptions;
use super::following::{self, Following, landings, number, range};
use super::general::{RowKind, by_name, user_functions};
use super::system::System;
use super::units::{Quantity, Units};
use serde_json::{Value, json};
use twinslip::bifurcation::equilibria::generic_curve::EquilibriumBifurcation;
use twinslip::bifurcation::general::GeneralBifurcation;
use twinslip::bifurcation::{EventObserver, LocusKind, LocusRequest, equilibria, orbits};
use twinslip::error::{Error, Result, option_name};
use twinslip::model::Loading;
use twinslip::orbit::{InterfaceSystem, TestFunction};
use twinslip::sweep::fields;

/// A curve that can be asked for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CurveChoice {
    /// As the command line has it.
    pub name: &'static str,
    /// As a picture has it.
    pub title: &'static str,
    /// What bifurcates; nothing, along orbits that have a number in common.
    kind: Option<LocusKind>,
    /// Whether it is of orbits.
    orbits: bool,
}

const fn curve(
    name: &'static str,
    title: &'static str,
    kind: LocusKind,
    orbits: bool,
) -> CurveChoice {
    CurveChoice {
        name,
        title,
        kind: Some(kind),
        orbits,
    }
}

const CURVES: [CurveChoice; 9] = [
    curve(
        "pitchfork",
        "pitchforks of equilibria",
        LocusKind::Pitchfork,
        false,
    ),
    curve(
        "saddle-node",
        "folds of equilibria",
        LocusKind::SaddleNode,
        false,
    ),
    curve("hopf", "Hopf points", LocusKind::Hopf, false),
    curve(
        "orbit-pitchfork",
        "pitchforks of orbits",
        LocusKind::OrbitPitchfork,
        true,
    ),
    curve(
        "orbit-saddle-node",
        "folds of orbits",
        LocusKind::OrbitSaddleNode,
        true,
    ),
    curve(
        "period-doubling",
        "period doublings",
        LocusKind::PeriodDoubling,
        true,
    ),
    curve("torus", "torus bifurcations", LocusKind::Torus, true),
    curve(
        "homoclinic",
        "homoclinic orbits",
        LocusKind::Homoclinic,
        true,
    ),
    CurveChoice {
        name: HELD,
        title: "orbits",
        kind: None,
        orbits: true,
    },
];

/// The periodic orbits that have a number in common.
const HELD: &str = "orbits";

/// A curve that is asked for, checked.
#[derive(Debug, Clone, PartialEq)]
pub struct LocusPlan {
    /// Of what.
    pub curve: CurveChoice,
    /// What slides.
    pub system: System,
    /// What is followed.
    pub request: LocusRequest,
    /// How.
    pub following: Following,
    /// The same for the output.
    pub numerics: Value,
}

impl CurveChoice {
    /// All.
    pub(super) const ALL: [CurveChoice; CURVES.len()] = CURVES;

    /// What bifurcates along it, of any system.
    pub fn bifurcation(&self) -> Option<GeneralBifurcation> {
        use GeneralBifurcation::{Equilibrium, Homoclinic, Orbit};
        self.kind.map(|kind| match kind {
            LocusKind::SaddleNode => Equilibrium(EquilibriumBifurcation::Fold),
            LocusKind::Pitchfork => Equilibrium(EquilibriumBifurcation::Pitchfork),
            LocusKind::Hopf => Equilibrium(EquilibriumBifurcation::Hopf),
            LocusKind::OrbitPitchfork => Orbit(TestFunction::Transverse),
            LocusKind::OrbitSaddleNode => Orbit(TestFunction::Fold),
            LocusKind::PeriodDoubling => Orbit(TestFunction::Doubling),
            LocusKind::Torus => Orbit(TestFunction::Torus),
            LocusKind::Homoclinic => Homoclinic,
        })
    }

    /// The names of all.
    pub(super) const NAMES: [&'static str; CURVES.len()] = {
        let mut names = [""; CURVES.len()];
        let mut i = 0;
        while i < CURVES.len() {
            names[i] = CURVES[i].name;
            i += 1;
        }
        names
    };

    /// Whether it is of periodic orbits.
    pub fn of_orbits(&self) -> bool {
        self.orbits
    }

    /// The names of those that a system of so many variables may have: with folds of equilibria where it has more than one, and with a
    /// symmetry that equilibria and orbits may break. In the plane orbits have no period doublings, and tori need three variables.
    pub(super) fn of_system(
        variables: usize,
        folds: bool,
        [broken, broken_by_orbits]: [bool; 2],
    ) -> Vec<&'static str> {
        let occurs = |curve: &&CurveChoice| match curve.kind {
            // They are no bifurcation, and need a number to hold.
            None => false,
            Some(LocusKind::Pitchfork) => broken,
            Some(LocusKind::OrbitPitchfork) => broken_by_orbits,
            Some(LocusKind::SaddleNode) => folds,
            Some(LocusKind::Hopf | LocusKind::OrbitSaddleNode | LocusKind::Homoclinic) => {
                variables > 1
            }
            Some(LocusKind::PeriodDoubling | LocusKind::Torus) => variables > 2,
        };
        CURVES
            .iter()
            .filter(occurs)
            .map(|curve| curve.name)
            .collect()
    }

    /// The names of those of a system of so many variables under a periodic forcing, in which nothing rests.
    pub(super) fn of_forced(variables: usize) -> Vec<&'static str> {
        let mut all = Self::of_system(variables + 1, false, [false; 2]);
        all.retain(|name| {
            let of_name = CURVES.iter().find(|curve| curve.name == *name);
            of_name.is_some_and(|curve| curve.orbits && curve.kind != Some(LocusKind::Homoclinic))
        });
        all
    }

    /// The names of those of equilibria, with pitchforks where there is a symmetry that they break.
    pub(super) fn of_equilibria(broken: bool) -> Vec<&'static str> {
        let all = CURVES.iter().filter(|curve| !curve.orbits);
        all.filter(|curve| broken || curve.kind != Some(LocusKind::Pitchfork))
            .map(|curve| curve.name)
            .collect()
    }

    /// Whether it is of orbits that have a number in common, and do not bifurcate; the option that says which must go with it.
    ///
    /// # Errors
    /// [`Error::Input`] for one without the other.
    pub(super) fn holds(&self, hold: Option<&str>) -> Result<bool> {
        match (self.kind, hold) {
            (None, None) => Err(Error::Input(
                "say by `hold` what the orbits of the curve have in common: \"period = 20\", for example".into(),
            )),
            (Some(_), Some(text)) => Err(Error::Input(format!(
                "`hold` {text:?} belongs to a curve of {HELD}: the orbits of a curve of {} have in common that they bifurcate",
                self.name
            ))),
            (kind, _) => Ok(kind.is_none()),
        }
    }

    /// The curve of this name.
    ///
    /// # Errors
    /// [`Error::Input`] without a name; [`Error::Parameter`] for one that is none.
    pub fn named(name: Option<&str>) -> Result<Self> {
        let name = name.ok_or_else(|| {
            Error::Input(format!(
                "say which bifurcation to follow: twinslip locus followed by one of {}",
                CurveChoice::NAMES.join(", ")
            ))
        })?;
        let found = CURVES.into_iter().find(|curve| curve.name == name);
        found.ok_or_else(|| Error::unknown("bifurcation", name, &CurveChoice::NAMES))
    }
}

/// A range `A:B`, dimensionless.
fn ends(
    name: &str,
    text: Option<&str>,
    (quantity, units): (Quantity, &Units),
    default: (f64, f64),
) -> Result<(f64, f64)> {
    let Some(text) = text else {
        return Ok(default);
    };
    let [from, to] = fields(text)[..] else {
        return Err(Error::Input(format!(
            "{} {text} must be A:B, two numbers with a colon between",
            option_name(name)
        )));
    };
    let (from, to) = (number(name, text, from)?, number(name, text, to)?);
    let (from, to) = range(
        &option_name(name),
        (units.inward(quantity, from), units.inward(quantity, to)),
    )?;
    Ok((from.min(to), from.max(to)))
}

/// V_H and K both vary along a curve.
fn not_fixed(options: &LocusOptions) -> Result<()> {
    let model = options.model.resolved()?;
    let given = [("driving", model.driving), ("stiffness", model.stiffness)];
    match given.iter().find(|(_, value)| value.is_some()) {
        None => Ok(()),
        Some((name, _)) => Err(Error::Input(format!(
            "`{name}` is a free parameter of a curve and cannot be given; use `{name}_range`, or `at_{name}` to land on a value"
        ))),
    }
}

/// The options with what `range` and `at` say of V_H and K in the flags that are of these alone.
fn by_flags(options: &LocusOptions) -> Result<LocusOptions> {
    let names = ["driving", "stiffness"];
    let [driving_range, stiffness_range] = by_name("range", &options.range, names)?;
    let [at_driving, at_stiffness] = by_name("at", &options.at, names)?;
    let range = |text: Option<&str>| text.map(|text| text.replacen(',', ":", 1));
    let list = |text: Option<&str>| text.map(str::to_owned);
    let mut options = options.clone();
    options.driving_range = range(driving_range).or(options.driving_range);
    options.stiffness_range = range(stiffness_range).or(options.stiffness_range);
    options.at_driving = list(at_driving).or(options.at_driving);
    options.at_stiffness = list(at_stiffness).or(options.at_stiffness);
    Ok(options)
}

impl LocusPlan {
    /// Checks the options.
    ///
    /// # Errors
    /// [`Error::Parameter`] and [`Error::Input`], in the user's own names.
    pub fn new(options: &LocusOptions) -> Result<Self> {
        let options = &by_flags(options)?;
        let curve = CurveChoice::named(options.of.as_deref())?;
        curve.holds(options.hold.as_deref())?;
        let kind = curve
            .kind
            .ok_or_else(|| Error::Input(format!("`hold` has no curve of {} here", curve.name)))?;
        not_fixed(options)?;
        let system = match curve.orbits {
            false => System::several(&options.model)?,
            true => System::new(&options.model)?,
        };
        let system = system.alike("locus")?;
        let rates = (Quantity::SlipRate, &system.units);
        let stiffnesses = (Quantity::Stiffness, &system.units);
        let driving = ends(
            "driving-range",
            options.driving_range.as_deref(),
            rates,
            following::DRIVING,
        )?;
        let stiffness = ends(
            "stiffness-range",
            options.stiffness_range.as_deref(),
            stiffnesses,
            following::STIFFNESS,
        )?;
        let following = Following::new(&options.continuation, curve.orbits)?;
        let rows = RowKind {
            orbits: curve.orbits,
            curve: true,
            homoclinic: false,
        };
        let free = ["driving", "stiffness"];
        let watch = user_functions(&options.watch, &system, (rows, &free))?;
        let request = LocusRequest {
            watch,
            slab: InterfaceSystem {
                law: system.law,
                interfaces: system.interfaces,
                loading: Loading::new(driving.0, stiffness.0)?,
            },
            kind,
            symmetry: following::symmetry(&options.symmetry, system.interfaces)?,
            driving,
            stiffness,
            at_driving: landings("at-driving", options.at_driving.as_deref(), rates, driving)?,
            at_stiffness: landings(
                "at-stiffness",
                options.at_stiffness.as_deref(),
                stiffnesses,
                stiffness,
            )?,
            step: following.step,
            tolerance: following.tolerance,
            criticality: options.criticality,
            skip: Vec::new(),
            max_points: following.max_points,
        };
        Ok(LocusPlan {
            numerics: numerics(curve.name, options, &request, &following, &system.units),
            curve,
            system,
            request,
            following,
        })
    }

    /// The plan, one subject a line.
    pub fn explain(&self) -> String {
        let units = &self.system.units;
        let range = |name: &str, quantity, (from, to): (f64, f64)| {
            format!(
                "  {name:<18}from {:e} to {:e}\n",
                units.outward(quantity, from),
                units.outward(quantity, to)
            )
        };
        let method = if self.curve.orbits {
            "taylor, tangents on, multiple shooting, V_H and K unknown"
        } else {
            "the equilibrium with the condition of the bifurcation; nothing is integrated"
        };
        let criticality = if self.request.criticality {
            "on: the normal form's coefficient at every point"
        } else {
            "off at rows: `criticality` is not given"
        };
        let at = [&self.request.at_driving[..], &self.request.at_stiffness[..]];
        format!(
            "plan of this command\n  curve             {}\n{}{}{}  method            {method}\n  criticality       {criticality}\n{}",
            self.curve.name,
            following::explain_symmetry(self.request.symmetry, self.system.interfaces),
            range("V_H", Quantity::SlipRate, self.request.driving),
            range("K", Quantity::Stiffness, self.request.stiffness),
            following::explain(&self.following, &at.concat(), &self.request.watch)
        )
    }

    /// Follows all of them, but those whose numbers are known.
    ///
    /// # Errors
    /// Those of the curves.
    pub fn follow(&self, known: &[usize], seen: EventObserver<'_>) -> Result<()> {
        let request = LocusRequest {
            skip: known.to_vec(),
            ..self.request.clone()
        };
        match self.curve.orbits {
            true => orbits::locus(&request, seen),
            false => equilibria::locus(&request, seen),
        }
    }
}

fn numerics(
    name: &str,
    options: &LocusOptions,
    request: &LocusRequest,
    following: &Following,
    units: &Units,
) -> Value {
    let list = |quantity, values: &[f64]| -> Vec<f64> {
        values.iter().map(|&x| units.outward(quantity, x)).collect()
    };
    let (driving, stiffness) = (request.driving, request.stiffness);
    let mut numerics = json!({
        "of": name,
        "symmetry": options.symmetry,
        "driving_range": list(Quantity::SlipRate, &[driving.0, driving.1]),
        "stiffness_range": list(Quantity::Stiffness, &[stiffness.0, stiffness.1]),
        "at_driving": list(Quantity::SlipRate, &request.at_driving),
        "at_stiffness": list(Quantity::Stiffness, &request.at_stiffness),
        "criticality": request.criticality,
        "step_limit": following.step,
        "tolerance": following.tolerance,
        "crosscheck": following.second.map(|second| second.name()),
    });
    if !options.watch.is_empty() {
        numerics["watch"] = json!(options.watch);
    }
    numerics
}
