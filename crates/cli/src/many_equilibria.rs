//! `twinslip equilibria --draw`: the steady state of many interfaces that differ.

use super::Ending;
use super::call::Call;
use super::report::{self, Report};
use serde_json::{Map, Value, json};
use twinslip::error::Result;
use twinslip_output::Format;
use twinslip_tasks::scene::{
    Described, EquilibriaOptions, FoundManyEquilibrium, ManyEquilibriumPlan, Quantity,
};
use twinslip_tasks::views;

pub fn run(options: &EquilibriaOptions, call: &Call) -> Result<Ending> {
    let plan = ManyEquilibriumPlan::new(options)?;
    let outputs = (&options.output, options.plot.as_deref());
    let report = report::begun(outputs, call, || plan.explain())?;
    let found = plan.solve()?;
    if let Some(path) = &options.plot {
        report.draw(path, &views::picture_of_many_equilibrium(&plan, &found))?;
    }
    let ending = write(&report, &plan, &found)?;
    Ok(match ending {
        Ending::Done if found.undecided() => report.undecided(
            "the stability, as an eigenvalue is within rounding of the imaginary axis; try another `driving` or `stiffness`",
        ),
        ending => ending,
    })
}

fn write(
    report: &Report<'_>,
    plan: &ManyEquilibriumPlan,
    found: &FoundManyEquilibrium,
) -> Result<Ending> {
    let numerics = json!({"solver": plan.solver_name, "search": "near a start"});
    let told = together(plan, found);
    if report.format == Format::Json {
        let mut told = told;
        told.extend(each(plan, found));
        let work = json!({"iterations": found.equilibrium.iterations});
        let result = json!({"equilibrium": told});
        let bytes = report.envelope(plan, numerics, result, work, None);
        return report.write(&bytes);
    }
    let stability = found.stability.map(|stability| {
        let unstable = stability.unstable.map_or(String::new(), |unstable| {
            format!(", {unstable} unstable eigenvalues")
        });
        format!(": {}{unstable}", stability.verdict.name())
    });
    let stress = found.equilibrium.stress;
    let stability = stability.unwrap_or_default();
    report.say(format!(
        "one steady state of possibly many: stress {stress}{stability}"
    ));
    let mut remarks = report.remarks(plan, &numerics);
    remarks.push(format!("equilibrium: {}", Value::Object(told)));
    report.write_all(
        plan.units(),
        remarks,
        &views::steady_interface_columns(&plan.drawn),
        &found.interfaces(&plan.drawn),
    )
}

/// What they do together.
fn together(plan: &ManyEquilibriumPlan, found: &FoundManyEquilibrium) -> Map<String, Value> {
    let equilibrium = &found.equilibrium;
    let least = |all: &[f64]| all.iter().copied().fold(f64::INFINITY, f64::min);
    let greatest = |all: &[f64]| all.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let (rates, logs) = (&equilibrium.slip_rate, &equilibrium.log_state);
    let mean = plan.interfaces.loading.driving / plan.interfaces.count() as f64;
    let all = [
        (
            "stress",
            report::uncertain(plan.units(), Quantity::Stress, equilibrium.stress),
        ),
        (
            "unstable",
            json!(found.stability.and_then(|stability| stability.unstable)),
        ),
        (
            "verdict",
            json!({ found.stability }.map(|stability| stability.verdict.name())),
        ),
        ("residual", json!(equilibrium.residual)),
        ("slip_rate_min", json!(least(rates))),
        ("slip_rate_max", json!(greatest(rates))),
        (
            "sliding",
            json!(rates.iter().filter(|&&rate| rate > mean).count()),
        ),
        ("state_min", json!(least(logs).exp())),
        ("state_max", json!(greatest(logs).exp())),
    ];
    all.map(|(name, value)| (name.to_owned(), value))
        .into_iter()
        .collect()
}

/// What each does, in lists.
fn each(plan: &ManyEquilibriumPlan, found: &FoundManyEquilibrium) -> Map<String, Value> {
    let equilibrium = &found.equilibrium;
    let states: Vec<f64> = equilibrium.log_state.iter().map(|w| w.exp()).collect();
    let drawn = plan.drawn.iter();
    let drawn: Map<String, Value> = drawn
        .map(|drawn| (drawn.name.to_owned(), json!(drawn.values)))
        .collect();
    let all = [
        ("state", json!(states)),
        ("log_state", json!(equilibrium.log_state)),
        (
            "log_state_uncertainty",
            json!(equilibrium.log_state_uncertainty),
        ),
        ("slip_rate", json!(equilibrium.slip_rate)),
        (
            "slip_rate_uncertainty",
            json!(equilibrium.slip_rate_uncertainty),
        ),
        ("drawn", Value::Object(drawn)),
    ];
    all.map(|(name, value)| (name.to_owned(), value))
        .into_iter()
        .collect()
}
