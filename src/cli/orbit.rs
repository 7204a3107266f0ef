//! `twinslip orbit`.

use super::equilibria::symmetry as symmetry_name;
use super::report::{self, Report, unit_names};
use super::words::several;
use super::{Ending, progress, say, written};
use crate::equilibrium::{Symmetry, Verdict};
use crate::error::{Error, Result};
use crate::friction::positive;
use crate::integrate::Choice;
use crate::number::Uncertain;
use crate::orbit::{
    Crosscheck, FoundOrbit, InitialGuess, InterfaceSystem, Kind, Multiplier, Orbit, OrbitAccuracy,
    Query, crosscheck, find,
};
use crate::output::{self, Cell, Format};
use crate::scene::{OrbitOptions, Quantity, System, start, tolerances};
use serde_json::{Value, json};

/// What is to be done, checked.
struct OrbitPlan {
    system: System,
    slab: InterfaceSystem,
    query: Query,
    accuracy: OrbitAccuracy,
    /// The second method.
    second: Option<OrbitAccuracy>,
}

impl OrbitPlan {
    fn new(options: &OrbitOptions) -> Result<Self> {
        let system = System::new(&options.model)?;
        let loading = system.loading()?;
        let symmetry = match options.symmetry.as_str() {
            "symmetric" => Symmetry::Symmetric,
            "asymmetric" => Symmetry::Asymmetric,
            other => {
                return Err(Error::unknown(
                    "symmetry",
                    other,
                    &["symmetric", "asymmetric"],
                ));
            }
        };
        let period = options
            .period_guess
            .map(|t| {
                Ok(system
                    .units
                    .inward(Quantity::Time, positive("period-guess", t)?))
            })
            .transpose()?;
        let begin = match options.start.as_deref() {
            None => InitialGuess::Anywhere,
            Some("hopf") if period.is_some() => {
                return Err(Error::Input(
                    "--period-guess goes with a --start near the orbit, not with --start hopf"
                        .into(),
                ));
            }
            Some("hopf") => InitialGuess::Hopf,
            Some(text) => InitialGuess::At {
                start: start(text, &system, &loading)?,
                period,
            },
        };
        let mut accuracy = OrbitAccuracy::of(Choice::named(&options.method)?);
        if options.max_steps == 0 {
            return Err(Error::parameter("max-steps", 0, "at least 1"));
        }
        accuracy.max_steps = options.max_steps;
        if let Some(rtol) = options.rtol {
            accuracy.tolerances = tolerances(rtol, options.atol)?;
        } else if let Some(atol) = options.atol {
            accuracy.tolerances = tolerances(accuracy.tolerances.rtol, Some(atol))?;
        }
        Ok(OrbitPlan {
            slab: InterfaceSystem {
                law: system.law,
                interfaces: system.interfaces,
                loading,
            },
            query: Query { symmetry, begin },
            second: second(options.crosscheck.as_deref(), accuracy.method)?,
            accuracy,
            system,
        })
    }

    fn explain(&self) {
        let interfaces = self.slab.interfaces;
        let dimension = if self.query.symmetry == Symmetry::Symmetric {
            2
        } else {
            3
        };
        say("plan of this command");
        say(format_args!(
            "  dimension         {dimension}{}",
            match (dimension, interfaces) {
                (2, 2) => ": both interfaces move alike; the multiplier across is a quadrature",
                _ => "",
            }
        ));
        say(format_args!(
            "  guess             {}",
            match self.query.begin {
                InitialGuess::At {
                    period: Some(_), ..
                } => "the start, over the period given",
                InitialGuess::At { .. } => "the returns of the start, else what it settles on",
                InitialGuess::Anywhere =>
                    "what runs settle on, else the branch from the nearest Hopf point",
                InitialGuess::Hopf => "the branch from the nearest Hopf point, past its folds",
            }
        ));
        say(format_args!(
            "  method            {}, tangents on, multiple shooting; rtol {:e}",
            method_name(self.accuracy.method),
            self.accuracy.tolerances.rtol
        ));
        say(
            "  uncertainties     the noise of all arcs, and two more solutions at other nodes and 8 times looser",
        );
        match &self.second {
            Some(second) => say(format_args!(
                "  crosscheck        {}, from nodes cut to three digits; rtol {:e}",
                second.method.name(),
                second.tolerances.rtol
            )),
            None => say("  crosscheck        off: --crosscheck none"),
        }
        say("  dense output      on, for the extremes alone");
    }
}

fn method_name(choice: Choice) -> &'static str {
    match choice {
        Choice::Auto => Choice::Taylor.name(),
        other => other.name(),
    }
}

/// The method of the crosscheck: another one than the first.
fn second(name: Option<&str>, first: Choice) -> Result<Option<OrbitAccuracy>> {
    #[cfg(feature = "sundials")]
    const DEFAULT: &str = "cvode-bdf";
    #[cfg(not(feature = "sundials"))]
    const DEFAULT: &str = "rodas5p";
    let name = match name {
        Some("none") => return Ok(None),
        Some(name) => name,
        None if method_name(first) == DEFAULT => Choice::Taylor.name(),
        None => DEFAULT,
    };
    let method = Choice::named_by("crosscheck", name)?;
    if method_name(method) == method_name(first) {
        return Err(Error::Input(format!(
            "--crosscheck {name} is the method of the orbit itself; choose another, or none"
        )));
    }
    Ok(Some(OrbitAccuracy {
        checked: false,
        ..OrbitAccuracy::of(method)
    }))
}

pub fn run(options: &OrbitOptions, words: &[String]) -> Result<Ending> {
    let plan = OrbitPlan::new(options)?;
    let report = Report::new(&options.output, words, &[])?;
    if options.output.explain {
        plan.explain();
    }
    let searched = || find(&plan.slab, &plan.query, &plan.accuracy);
    let FoundOrbit { orbit, others } =
        progress::during(report.quiet, "looking for the orbit", searched)?;
    let mut trouble = None;
    let checked = plan.second.as_ref().and_then(|second| {
        let words = format!("once more, by {}", second.method.name());
        progress::during(report.quiet, &words, || {
            crosscheck(&plan.slab, &orbit, second)
        })
        .map_err(|error| trouble = Some((second.method.name(), error)))
        .ok()
    });
    if let Some((name, error)) = &trouble {
        report.say(format!("the crosscheck by {name} failed: {error}"));
    }
    let ending = write(&plan, &report, &orbit, &others, checked.as_ref())?;
    report.say(summary(&orbit, checked.as_ref(), &plan.system));
    if ending == Ending::Done && orbit.verdict() == Verdict::Undecided {
        return Ok(Ending::Undecided);
    }
    Ok(ending)
}

fn summary(orbit: &Orbit, checked: Option<&Crosscheck>, system: &System) -> String {
    let unit = system.units.name(Quantity::Time);
    let period = system.units.outward_uncertain(Quantity::Time, orbit.period);
    let mut text = format!(
        "period ({period}) {unit}, {}; {}, {}, {}",
        orbit.verdict().name(),
        several(orbit.nodes.len(), "node", "nodes"),
        several(orbit.iterations, "iteration", "iterations"),
        several(orbit.work.steps, "step", "steps")
    );
    if let Some(Crosscheck {
        orbit: second,
        period_difference,
        ..
    }) = checked
    {
        let relative = period_difference / orbit.period.value;
        text += &format!(
            "; the period by {} differs by {relative:.1e} of it",
            second.method
        );
    }
    text
}

fn write(
    plan: &OrbitPlan,
    report: &Report<'_>,
    orbit: &Orbit,
    others: &[Orbit],
    checked: Option<&Crosscheck>,
) -> Result<Ending> {
    let numerics = json!({
        "method": orbit.method,
        "rtol": plan.accuracy.tolerances.rtol,
        "atol": plan.accuracy.tolerances.atol,
        "max_steps": plan.accuracy.max_steps,
        "crosscheck": plan.second.map(|second| second.method.name()),
    });
    let system = &plan.system;
    if report.format == Format::Json {
        let mut main = object(orbit, system);
        main["crosscheck"] = checked.map_or(Value::Null, |checked| comparison(checked, system));
        let rest: Vec<Value> = others.iter().map(|other| object(other, system)).collect();
        let result = json!({"orbit": main, "others": rest});
        let mut work = report::work(&orbit.work);
        work["nodes"] = json!(orbit.nodes.len());
        work["iterations"] = json!(orbit.iterations);
        let bytes = report.envelope(system, numerics, result, work, None);
        return written(report.place.write(&bytes), &report.place);
    }
    let table = report.format == Format::Table;
    let columns = columns(system, table);
    let names: Vec<String> = columns.iter().map(|(name, _)| name.clone()).collect();
    let units = unit_names(&system.units, columns.iter().map(|(_, quantity)| *quantity));
    let remarks = report.remarks(system, &numerics);
    let all = report
        .begin(remarks, &names, &units)
        .and_then(|mut writer| {
            std::iter::once(orbit)
                .chain(others)
                .try_for_each(|one| writer.row(&cells(one, system, table)))
        });
    report.ended(written(all, &report.place))
}

/// The columns of CSV; a table has room for what is looked at first.
fn columns(system: &System, table: bool) -> Vec<(String, Quantity)> {
    let mut columns: Vec<(String, Quantity)> = Vec::new();
    let mut add = |name: &str, quantity, with_uncertainty: bool| {
        columns.push((name.to_owned(), quantity));
        if with_uncertainty && !table {
            columns.push((format!("{name}_uncertainty"), quantity));
        }
    };
    add("symmetry", Quantity::Number, false);
    add("period", Quantity::Time, true);
    add("stress_min", Quantity::Stress, true);
    add("stress_max", Quantity::Stress, true);
    add("slip_rate_max", Quantity::SlipRate, false);
    add("state_min", Quantity::State, false);
    for i in 1..=system.interfaces {
        add(&format!("ln_abs_multiplier_{i}"), Quantity::Number, true);
        add(&format!("angle_over_pi_{i}"), Quantity::Number, false);
        if !table {
            add(&format!("kind_{i}"), Quantity::Number, false);
        }
    }
    add("verdict", Quantity::Number, false);
    if !table {
        add("stress", Quantity::Stress, false);
        for i in 1..=system.interfaces {
            add(&format!("log_state_{i}"), Quantity::LogState, false);
        }
        add("trivial_defect", Quantity::Number, false);
        add("liouville_defect", Quantity::Number, false);
    }
    columns
}

fn cells(orbit: &Orbit, system: &System, table: bool) -> Vec<Cell> {
    let units = &system.units;
    let mut cells = vec![Cell::from(symmetry_name(orbit.symmetry))];
    let mut add = |quantity, x: Uncertain| {
        let x = units.outward_uncertain(quantity, x);
        cells.push(x.value.into());
        if !table {
            cells.push(x.uncertainty.into());
        }
    };
    add(Quantity::Time, orbit.period);
    add(Quantity::Stress, orbit.stress_min);
    add(Quantity::Stress, orbit.stress_max);
    cells.push(
        units
            .outward(Quantity::SlipRate, orbit.slip_rate_max)
            .into(),
    );
    cells.push(units.outward(Quantity::State, orbit.state_min).into());
    for multiplier in &orbit.floquet.multipliers {
        cells.push(multiplier.ln_abs.value.into());
        if !table {
            cells.push(multiplier.ln_abs.uncertainty.into());
        }
        cells.push(angle(multiplier).into());
        if !table {
            cells.push(Cell::from(kind(multiplier.kind)));
        }
    }
    cells.push(Cell::from(orbit.verdict().name()));
    if !table {
        let point = outward_point(orbit, system);
        cells.extend(point.into_iter().map(Cell::Number));
        cells.push(orbit.floquet.trivial_defect.into());
        cells.push(orbit.floquet.liouville_defect.into());
    }
    cells
}

/// tau and ln psi of each interface in the user's units.
fn outward_point(orbit: &Orbit, system: &System) -> Vec<f64> {
    let quantity = |i| {
        if i == 0 {
            Quantity::Stress
        } else {
            Quantity::LogState
        }
    };
    let point = orbit.point.iter().enumerate();
    let mut point: Vec<f64> = point
        .map(|(i, &x)| system.units.outward(quantity(i), x))
        .collect();
    // Where both interfaces move alike they share a state.
    while point.len() < system.interfaces + 1 {
        point.push(point[1]);
    }
    point
}

fn object(orbit: &Orbit, system: &System) -> Value {
    let units = &system.units;
    let mut multipliers = vec![[1.0, 0.0]];
    let mut below = 1.0;
    for multiplier in &orbit.floquet.multipliers {
        let mu = multiplier.value();
        let conjugate = multiplier.kind == Kind::Complex && below < 0.0;
        multipliers.push([mu.re, if conjugate { -mu.im } else { mu.im }]);
        below = -below;
    }
    let logs: Vec<Value> = orbit.floquet.multipliers.iter().map(logarithm).collect();
    json!({
        "symmetry": symmetry_name(orbit.symmetry),
        "period": report::uncertain(units, Quantity::Time, orbit.period),
        "point": outward_point(orbit, system),
        "point_uncertainty": orbit.point_uncertainty,
        "stress_min": report::uncertain(units, Quantity::Stress, orbit.stress_min),
        "stress_max": report::uncertain(units, Quantity::Stress, orbit.stress_max),
        "slip_rate_max": units.outward(Quantity::SlipRate, orbit.slip_rate_max),
        "state_min": units.outward(Quantity::State, orbit.state_min),
        "multipliers": multipliers,
        "log_multipliers": logs,
        "trivial_defect": orbit.floquet.trivial_defect,
        "liouville_defect": orbit.floquet.liouville_defect,
        "verdict": orbit.verdict().name(),
        "method": orbit.method,
    })
}

fn logarithm(multiplier: &Multiplier) -> Value {
    let Uncertain { value, uncertainty } = multiplier.ln_abs;
    let known = multiplier.kind != Kind::BelowFloor;
    json!({
        "ln_abs": known.then(|| output::uncertain((value, uncertainty))),
        "ln_abs_at_most": (!known).then_some(value),
        "angle_over_pi": angle(multiplier),
        "kind": kind(multiplier.kind),
    })
}

fn angle(multiplier: &Multiplier) -> Option<f64> {
    (multiplier.kind != Kind::BelowFloor).then_some(multiplier.angle_over_pi)
}

fn kind(kind: Kind) -> &'static str {
    match kind {
        Kind::Real => "real",
        Kind::Complex => "complex",
        Kind::BelowFloor => "below floor",
    }
}

fn comparison(checked: &Crosscheck, system: &System) -> Value {
    let second = object(&checked.orbit, system);
    let difference = system
        .units
        .outward(Quantity::Time, checked.period_difference);
    json!({
        "method": checked.orbit.method,
        "period_difference": difference,
        "ln_abs_difference": checked.ln_abs_difference,
        "period": second["period"],
        "log_multipliers": second["log_multipliers"],
        "verdict": second["verdict"],
        "steps": checked.orbit.work.steps,
    })
}
