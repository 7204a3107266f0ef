//! `twinslip locus`.

use super::Ending;
use super::continuation::Task;
use super::diagram;
use super::following::{self, Following, landings, numbers, range};
use super::rows;
use crate::bifurcation::{LocusKind, LocusRequest, equilibria, orbits};
use crate::error::{Error, Result};
use crate::model::Loading;
use crate::orbit::Slab;
use crate::scene::{LocusOptions, Quantity, System, Units};
use serde_json::{Value, json};

pub const EXAMPLE: &str =
    "Example, the torus bifurcations of the paper's Figs 12 and 14, with their resonances:
  twinslip locus torus --stiffness-range 0.02,0.3 -o torus.csv --plot torus.svg";

/// A curve that can be asked for.
#[derive(Debug, Clone, Copy)]
struct Curve {
    /// As the command line has it.
    name: &'static str,
    /// As a picture has it.
    title: &'static str,
    kind: LocusKind,
    /// Whether it is of orbits.
    orbits: bool,
}

const fn curve(name: &'static str, title: &'static str, kind: LocusKind, orbits: bool) -> Curve {
    Curve {
        name,
        title,
        kind,
        orbits,
    }
}

const CURVES: [Curve; 7] = [
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
];

/// What is to be done, checked.
struct Plan {
    curve: Curve,
    system: System,
    request: LocusRequest,
    following: Following,
    numerics: Value,
}

impl Curve {
    fn named(name: Option<&str>) -> Result<Self> {
        let known = || CURVES.map(|curve| curve.name).join(", ");
        let name = name.ok_or_else(|| {
            Error::Input(format!(
                "it is missing of which bifurcation the curve is: locus followed by one of {}",
                known()
            ))
        })?;
        let found = CURVES.into_iter().find(|curve| curve.name == name);
        found.ok_or_else(|| {
            Error::Input(format!(
                "there is no curve of {name:?}; choose one of {}",
                known()
            ))
        })
    }
}

/// A range A,B, dimensionless.
fn ends(
    name: &str,
    text: Option<&str>,
    (quantity, units): (Quantity, &Units),
    default: (f64, f64),
) -> Result<(f64, f64)> {
    let Some(text) = text else {
        return Ok(default);
    };
    let [from, to] = numbers(name, text)?[..] else {
        return Err(Error::Input(format!(
            "--{name} {text} must be two numbers, A,B"
        )));
    };
    let (from, to) = range(
        &format!("--{name}"),
        (units.inward(quantity, from), units.inward(quantity, to)),
    )?;
    Ok((from.min(to), from.max(to)))
}

/// V_H and K both vary along a curve.
fn not_fixed(options: &LocusOptions) -> Result<()> {
    let given = [
        ("driving", options.model.driving),
        ("stiffness", options.model.stiffness),
    ];
    match given.iter().find(|(_, value)| value.is_some()) {
        None => Ok(()),
        Some((name, _)) => Err(Error::Input(format!(
            "--{name} varies along a curve and can't be given; use --{name}-range, or --at-{name} to land on a value"
        ))),
    }
}

impl Plan {
    fn new(options: &LocusOptions) -> Result<Self> {
        let curve = Curve::named(options.of.as_deref())?;
        not_fixed(options)?;
        let system = System::new(&options.model)?;
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
        let request = LocusRequest {
            slab: Slab {
                law: system.law,
                interfaces: system.interfaces,
                loading: Loading::new(driving.0, stiffness.0)?,
            },
            kind: curve.kind,
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
        };
        Ok(Plan {
            numerics: numerics(curve.name, options, &request, &following, &system.units),
            curve,
            system,
            request,
            following,
        })
    }

    fn explain(&self) {
        let units = &self.system.units;
        eprintln!("plan of this command");
        eprintln!("  curve             {}", self.curve.name);
        following::explain_symmetry(self.request.symmetry, self.system.interfaces);
        for (name, quantity, (from, to)) in [
            ("V_H", Quantity::SlipRate, self.request.driving),
            ("K", Quantity::Stiffness, self.request.stiffness),
        ] {
            eprintln!(
                "  {name:<18}from {:e} to {:e}",
                units.outward(quantity, from),
                units.outward(quantity, to)
            );
        }
        if self.curve.orbits {
            eprintln!(
                "  method            taylor, tangents on, multiple shooting, V_H and K unknown"
            );
        } else {
            eprintln!("  method            the conditions on equilibria; nothing is integrated");
        }
        eprintln!(
            "  criticality       {}",
            if self.request.criticality {
                "on: the normal form's coefficient at every point"
            } else {
                "off at rows: --criticality is not given"
            }
        );
        let at = [&self.request.at_driving[..], &self.request.at_stiffness[..]];
        following::explain(&self.following, &at.concat());
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
    json!({
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
    })
}

pub fn run(options: &LocusOptions, words: &[String]) -> Result<Ending> {
    let plan = Plan::new(options)?;
    let task = Task {
        system: &plan.system,
        columns: rows::locus_columns(),
        numerics: plan.numerics.clone(),
        slab: &plan.request.slab,
        second: plan.following.second,
        resume: options.resume.as_ref(),
        plot: options.plot.as_ref(),
        output: &options.output,
        words,
    };
    let report = task.report()?;
    if options.output.explain {
        plan.explain();
    }
    task.run(
        &report,
        |skip, seen| {
            let request = LocusRequest {
                skip: skip.to_vec(),
                ..plan.request.clone()
            };
            if plan.curve.orbits {
                orbits::locus(&request, seen)
            } else {
                equilibria::locus(&request, seen)
            }
        },
        |rows, special| diagram::curves(rows, special, plan.curve.title, &plan.system.units),
    )
}
