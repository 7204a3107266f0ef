//! `twinslip orbit`.

use super::call::Call;
use super::integrate::PlannedRun;
use super::report::{self, Report};
use super::stream::StreamOut;
use super::words::{count, several};
use super::{Ending, progress, written};
use serde_json::{Map, Value, json};
use std::path::Path;
use twinslip::equilibrium::Verdict;
use twinslip::error::{Error, Result};
use twinslip::number::Uncertain;
use twinslip::orbit::{Crosscheck, FoundOrbit, Kind, Multiplier, Orbit};
use twinslip_output::{Format, RowList, plot};
use twinslip_tasks::scene::{
    Described, OrbitDerivatives, OrbitOptions, OrbitPlan, Quantity, Units,
};
use twinslip_tasks::views;

pub fn run(options: &OrbitOptions, call: &Call) -> Result<Ending> {
    let plan = &OrbitPlan::new(options)?;
    let picture = options.plot.as_deref();
    picture.map(plot::PictureFormat::of).transpose()?;
    let others: Vec<&Path> = picture.into_iter().collect();
    let report = Report::new(&options.output, call, &others)?;
    if options.output.explain {
        call.say(plan.explain());
    }
    let FoundOrbit { orbit, others } =
        progress::during(&report, "looking for the orbit", || plan.find())?;
    let derivatives = progress::during(&report, "the derivatives", || plan.derivatives(&orbit))?;
    // Only the object tells of the second opinion: rows need not wait for it.
    let in_rows = report.format != Format::Json;
    let mut ending = Ending::Done;
    if in_rows && plan.rows.is_none() && plan.response.is_none() {
        ending = write_orbits(plan, &report, (&orbit, &derivatives), &others)?;
    }
    let rows = match plan.response {
        None => along(plan, &report, &orbit, picture)?.map(|rows| json!(rows)),
        Some(_) => responses(plan, &report, &orbit, picture)?,
    };
    let second = plan.accuracies(&orbit).1;
    let second = second.map_or("", |second| second.method.name());
    let words = format!("once more, by {second}");
    let checked = progress::during(&report, &words, || plan.crosscheck(&orbit));
    let (checked, unchecked) = match checked {
        Ok(Some(checked)) => (Some(checked), None),
        Ok(None) => (None, Some("none is asked for".to_owned())),
        Err(error) => {
            let why = match error {
                Error::TooManySteps { limit, .. } if options.crosscheck.is_none() => format!(
                    "the crosscheck by {second} was skipped, as it takes longer than the orbit itself: more than {} steps; `crosscheck` {second} asks for it all the same",
                    count(limit)
                ),
                error => format!("the crosscheck by {second} failed: {error}"),
            };
            report.say(&why);
            (None, Some(call.told(&why)))
        }
    };
    if !in_rows {
        let checked = (checked.as_ref(), unchecked.as_deref());
        let result = result(plan, (&orbit, &derivatives), &others, checked, rows);
        ending = write_object(plan, &report, &orbit, result)?;
    }
    report.say(summary(&orbit, checked.as_ref(), plan.system.units()));
    Ok(match ending {
        Ending::Done if orbit.verdict() == Verdict::Undecided => report.undecided(
            "the stability of the orbit, as ln |mu| of a multiplier is 0 within its error; try other parameters, or a smaller `rtol`",
        ),
        ending => ending,
    })
}

/// What was found, and at which cost.
fn summary(orbit: &Orbit, checked: Option<&Crosscheck>, units: &Units) -> String {
    let unit = match units.name(Quantity::Time) {
        "1" => String::new(),
        unit => format!(" {unit}"),
    };
    let period = units.outward_uncertain(Quantity::Time, orbit.period);
    let mut text = format!(
        "period ({period}){unit}, {}; {}, {}, {}",
        orbit.verdict().name(),
        several(orbit.nodes.len(), "node", "nodes"),
        several(orbit.iterations, "iteration", "iterations"),
        several(orbit.work.steps, "step", "steps")
    );
    if orbit.in_family {
        text +=
            "; one of a family of periodic orbits with these parameters: a second multiplier is 1";
    }
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

/// Goes along the orbit for the rows and the picture that are asked for, and gives the rows; none where nobody asks for them, or reads
/// them.
fn along(
    plan: &OrbitPlan,
    report: &Report<'_>,
    orbit: &Orbit,
    picture: Option<&Path>,
) -> Result<Option<RowList>> {
    let Some(run) = plan.along(orbit) else {
        return Ok(None);
    };
    let columns = run.columns();
    let out = if plan.rows.is_some() {
        let units = plan.system.units();
        let mut remarks = report.remarks(&plan.system, &numerics(plan, orbit));
        remarks.push(format!("orbit: {}", summary(orbit, None, units)));
        let columns = (columns, units);
        StreamOut::new(report, remarks, columns, report.repeats())
    } else {
        Ok(StreamOut::kept(report, columns))
    };
    let mut out = match out {
        Ok(out) => out.drawing(PlannedRun::pictured(&run)),
        Err(error) => return written(Err(error), &report.place).map(|_| None),
    };
    let failure = PlannedRun::run(&run, &mut out)?.failure;
    out.progress.finish();
    if let Some(error) = out.broken {
        return written(Err(error), &report.place).map(|_| None);
    }
    if let Some(path) = picture {
        report.draw(path, &run.picture(&out.drawn))?;
    }
    if plan.rows.is_none() {
        return failure.map_or(Ok(None), Err);
    }
    report.ended(failure.map_or(Ok(Ending::Done), Err))?;
    Ok(Some(out.rows))
}

/// Computes the phase response, draws it where a picture is asked for, and writes its rows or gives those of an object.
fn responses(
    plan: &OrbitPlan,
    report: &Report<'_>,
    orbit: &Orbit,
    picture: Option<&Path>,
) -> Result<Option<Value>> {
    let system = &plan.system;
    let rows = progress::during(report, "the phase response", || plan.responses(orbit))?;
    let rows = rows.unwrap_or_default();
    if let Some(path) = picture {
        report.draw(path, &views::picture_of_responses(system, &rows))?;
    }
    let (columns, units) = (views::response_columns(system), system.units());
    if report.format == Format::Json {
        report.hand_on(units, &columns, &rows);
        let objects = rows.iter().map(|row| views::object(&columns, row, units));
        return Ok(Some(objects.map(Value::Object).collect()));
    }
    let mut remarks = report.remarks(system, &numerics(plan, orbit));
    remarks.push(format!("orbit: {}", summary(orbit, None, units)));
    report.write_all(units, remarks, &columns, &rows)?;
    Ok(None)
}

fn numerics(plan: &OrbitPlan, orbit: &Orbit) -> Value {
    let (accuracy, second) = plan.accuracies(orbit);
    json!({
        "method": orbit.method,
        "rtol": accuracy.tolerances.rtol,
        "atol": plan.told_atol(&accuracy),
        "max_step": plan.system.units().max_step(accuracy.tolerances),
        "max_steps": accuracy.max_steps,
        "crosscheck": second.map(|second| second.method.name()),
    })
}

/// What the object holds.
fn result(
    plan: &OrbitPlan,
    (orbit, derivatives): (&Orbit, &[OrbitDerivatives]),
    others: &[Orbit],
    (checked, unchecked): (Option<&Crosscheck>, Option<&str>),
    rows: Option<Value>,
) -> Value {
    let mut main = object(plan, orbit);
    if !derivatives.is_empty() {
        main["derivatives"] = of_parameters(plan, derivatives);
    }
    main["crosscheck_note"] = json!(unchecked);
    main["crosscheck"] = checked.map_or(Value::Null, |checked| comparison(checked, plan));
    let rest: Vec<Value> = others.iter().map(|other| object(plan, other)).collect();
    let mut result = json!({"orbit": main, "others": rest});
    if let Some(rows) = rows {
        result["rows"] = rows;
    }
    result
}

fn write_object(
    plan: &OrbitPlan,
    report: &Report<'_>,
    orbit: &Orbit,
    result: Value,
) -> Result<Ending> {
    let mut work = report::work(&orbit.work);
    work["nodes"] = json!(orbit.nodes.len());
    work["iterations"] = json!(orbit.iterations);
    let bytes = report.envelope(&plan.system, numerics(plan, orbit), result, work, None);
    report.write(&bytes)
}

/// A row for each orbit.
fn write_orbits(
    plan: &OrbitPlan,
    report: &Report<'_>,
    (orbit, derivatives): (&Orbit, &[OrbitDerivatives]),
    others: &[Orbit],
) -> Result<Ending> {
    let mut columns = views::orbit_columns(plan);
    columns.extend(views::derivative_columns(plan, orbit, derivatives));
    let system = &plan.system;
    report.write_all(
        system.units(),
        report.remarks(system, &numerics(plan, orbit)),
        &columns,
        std::iter::once(orbit).chain(others),
    )
}

/// A state of each, in the user's units; where both interfaces move alike they share one.
fn outward<T: Copy>(
    plan: &OrbitPlan,
    all: &[T],
    outward: impl Fn(Quantity, T) -> Value,
) -> Vec<(String, Value)> {
    let states = plan.system.states().into_iter().enumerate();
    let one = |(i, name): (usize, std::borrow::Cow<'static, str>)| {
        let value = all[i.min(all.len() - 1)];
        (name.into_owned(), outward(plan.system.quantity(i), value))
    };
    states.map(one).collect()
}

fn object(plan: &OrbitPlan, orbit: &Orbit) -> Value {
    let units = plan.system.units();
    let uncertain = |quantity, x| report::uncertain(units, quantity, x);
    let point = outward(plan, &orbit.point, |quantity, x| {
        json!(units.outward(quantity, x))
    });
    let point: Vec<Value> = point.into_iter().map(|(_, x)| x).collect();
    let extremes = outward(
        plan,
        &orbit.extremes,
        |quantity, [least, most]| json!({"min": uncertain(quantity, least), "max": uncertain(quantity, most)}),
    );
    let mut logs: Vec<Value> = orbit.floquet.multipliers.iter().map(logarithm).collect();
    logs.extend(orbit.floquet.within.iter().map(|within| {
        json!({
            "ln_abs": uncertain(Quantity::Number, within.ln_abs),
            "angle_over_pi": 0.0,
            "kind": "within",
            "cluster": within.cluster,
            "multiplicity": within.multiplicity,
        })
    }));
    let mut object = json!({
        "period": uncertain(Quantity::Time, orbit.period),
        "point": point,
        "point_uncertainty": orbit.point_uncertainty,
        "extremes": extremes.into_iter().take(plan.system.moving()).collect::<Map<String, Value>>(),
        "multipliers": multipliers(orbit, plan.system.forcing_period().is_some()),
        "log_multipliers": logs,
        "trivial_defect": orbit.floquet.trivial_defect,
        "liouville_defect": orbit.floquet.liouville_defect,
        "verdict": orbit.verdict().name(),
        "family": orbit.in_family,
        "method": orbit.method,
    });
    if let Some(period) = plan.system.forcing_period() {
        object["forcing_period"] = json!(units.outward(Quantity::Time, period));
        object["turns"] = json!((orbit.period.value / period).round() as u64);
    }
    if let Some(symmetry) = plan.symmetry(orbit) {
        let rate = views::known(orbit.slip_rate_max);
        let rate = rate.map(|v| units.outward(Quantity::SlipRate, v));
        object["symmetry"] = json!(symmetry.name());
        object["stress_min"] = uncertain(Quantity::Stress, orbit.stress_min);
        object["stress_max"] = uncertain(Quantity::Stress, orbit.stress_max);
        object["slip_rate_max"] = json!(rate);
        object["state_min"] = json!(units.outward(Quantity::State, orbit.state_min));
    }
    object
}

/// The derivatives by what they are of, and then by parameter.
fn of_parameters(plan: &OrbitPlan, all: &[OrbitDerivatives]) -> Value {
    let by_name = |of: &dyn Fn(&OrbitDerivatives) -> Option<Uncertain>| -> Value {
        let one = |one: &OrbitDerivatives| {
            let slope = of(one).map(|x| twinslip_output::uncertain((x.value, x.uncertainty)));
            (one.name.clone(), json!(slope))
        };
        all.iter().map(one).collect::<Map<_, _>>().into()
    };
    let multipliers = all.first().map_or(0, |one| one.ln_abs.len());
    let logs: Vec<Value> = (0..multipliers)
        .map(|j| by_name(&|one| one.ln_abs[j]))
        .collect();
    let extremes = |end: usize| -> Value {
        let states = plan.system.states().into_iter().enumerate();
        let one = |(i, name): (usize, std::borrow::Cow<'static, str>)| {
            let slopes = by_name(&|one| Some(one.extremes[i][end]));
            (name.into_owned(), slopes)
        };
        states.map(one).collect::<Map<_, _>>().into()
    };
    json!({
        "period": by_name(&|one| Some(one.period)),
        "minimum": extremes(0),
        "maximum": extremes(1),
        "ln_abs": logs,
    })
}

/// All multipliers, the trivial one first, which there is none of under a forcing; of a conjugate pair the second one below the axis.
fn multipliers(orbit: &Orbit, is_forced: bool) -> Vec<[f64; 2]> {
    let mut multipliers = match is_forced {
        true => Vec::new(),
        false => vec![[1.0, 0.0]],
    };
    let mut above = true;
    for multiplier in &orbit.floquet.multipliers {
        let mu = multiplier.value();
        let complex = multiplier.kind == Kind::Complex;
        multipliers.push([mu.re, if complex && !above { -mu.im } else { mu.im }]);
        above = !complex || !above;
    }
    multipliers
}

/// A multiplier by its logarithm.
fn logarithm(multiplier: &Multiplier) -> Value {
    let Uncertain { value, uncertainty } = multiplier.ln_abs;
    let known = multiplier.kind != Kind::BelowFloor;
    json!({
        "ln_abs": known.then(|| twinslip_output::uncertain((value, uncertainty))),
        "ln_abs_at_most": (!known).then_some(value),
        "angle_over_pi": multiplier.known_angle(),
        "kind": multiplier.kind.name(),
    })
}

fn comparison(checked: &Crosscheck, plan: &OrbitPlan) -> Value {
    let second = object(plan, &checked.orbit);
    let units = plan.system.units();
    let difference = units.outward(Quantity::Time, checked.period_difference);
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
