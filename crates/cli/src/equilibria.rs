//! `twinslip equilibria`.

use super::call::Call;
use super::report::{self, Report};
use super::words::several;
use super::{Ending, many_equilibria, text};
use nalgebra::Complex;
use serde_json::{Value, json};
use twinslip::equilibrium::{ClusterEigenvalue, ClusterStability, EigenvalueKind};
use twinslip::error::Result;
use twinslip_output::Format;
use twinslip_tasks::scene::{
    ClassifiedEquilibria, ClassifiedEquilibrium, EquilibriaOptions, EquilibriaPlan,
    ManyEquilibriumPlan, Quantity, System, TextModel,
};
use twinslip_tasks::views;

pub fn run(options: &EquilibriaOptions, call: &Call) -> Result<Ending> {
    if ManyEquilibriumPlan::is_of(options) {
        return many_equilibria::run(options, call);
    }
    let slab = &options.model.slab;
    let of_formulas = slab.needs_formulas(&[])? || !slab.has_clusters();
    if (of_formulas || slab.text.system.is_some())
        && let Some(model) = TextModel::of(&options.model, &[])?
    {
        return text::equilibria::run(options, model, call);
    }
    plan(options, call)
}

/// Of built-in laws.
fn plan(options: &EquilibriaOptions, call: &Call) -> Result<Ending> {
    let plan = EquilibriaPlan::new(options)?;
    let outputs = (&options.output, options.plot.as_deref());
    let report = report::begun(outputs, call, || plan.explain())?;
    let found = plan.solve()?;
    if let Some(path) = &options.plot {
        match views::picture_of_equilibria(&plan, &found.equilibria) {
            Some(drawing) => report.draw(path, &drawing)?,
            None => report.say("there is no steady state to draw"),
        }
    }
    let ending = write(&report, &plan, &found)?;
    Ok(match (ending, found.undecided()) {
        (Ending::Done, _) if !found.complete => report.undecided(
            "the number of steady states, as V_H is within rounding of a bifurcation, or a slip rate is beyond the range of doubles; try another `driving`",
        ),
        (Ending::Done, 1..) => report.undecided(format_args!(
            "the stability of {}, as an eigenvalue is within its error of the imaginary axis; try another `driving` or `stiffness`",
            several(found.undecided(), "steady state", "steady states")
        )),
        (ending, _) => ending,
    })
}

fn write(
    report: &Report<'_>,
    plan: &EquilibriaPlan,
    found: &ClassifiedEquilibria,
) -> Result<Ending> {
    let numerics = json!({"solver": plan.solver_name});
    let system = &plan.system;
    let columns = views::equilibria_columns(system.interfaces);
    if report.format == Format::Json {
        report.hand_on(&system.units, &columns, &found.equilibria);
        let list = found.equilibria.iter();
        let list: Vec<Value> = list.map(|one| object(one, system)).collect();
        let work = json!({"equilibria": list.len()});
        let result = json!({"equilibria": list, "complete": found.complete});
        let bytes = report.envelope(system, numerics, result, work, None);
        return report.write(&bytes);
    }
    report.write_all(
        &system.units,
        report.remarks(system, &numerics),
        &columns,
        &found.equilibria,
    )
}

fn object(found: &ClassifiedEquilibrium, system: &System) -> Value {
    let units = &system.units;
    let equilibrium = &found.equilibrium;
    let out = |quantity, values: &[f64]| -> Vec<f64> {
        values.iter().map(|&x| units.outward(quantity, x)).collect()
    };
    let pair = |z: &Complex<f64>| [z.re, z.im].map(|x| units.outward(Quantity::Growth, x));
    let radius = |one: &ClusterEigenvalue| {
        Some(units.outward(Quantity::Growth, one.uncertainty)).filter(|x| x.is_finite())
    };
    let known = found.stability.as_ref();
    let eigenvalues = known.map(|known| &known.eigenvalues);
    let [eigenvalues, eigenvalue_uncertainty] = match eigenvalues {
        None => [Value::Null, Value::Null],
        Some(all) if system.interfaces > 2 => {
            let value = |one: &ClusterEigenvalue| {
                let mut told = json!({
                    "value": pair(&one.value),
                    "multiplicity": one.multiplicity,
                    "kind": one.kind.name(),
                });
                if let EigenvalueKind::Within(cluster) = one.kind {
                    told["cluster"] = json!(cluster + 1);
                }
                told
            };
            [
                all.iter().map(value).collect(),
                all.iter().map(radius).collect(),
            ]
        }
        // As many as there are, null where one is beyond the range of doubles
        Some(all) => {
            let each = 0..=system.interfaces;
            [
                each.clone()
                    .map(|i| json!(all.get(i).map(|one| pair(&one.value))))
                    .collect(),
                each.map(|i| json!(all.get(i).and_then(radius))).collect(),
            ]
        }
    };
    let mut told = json!({
        "symmetry": equilibrium.symmetry.name(),
        "stress": report::uncertain(units, Quantity::Stress, equilibrium.stress),
        "state": out(Quantity::State, &equilibrium.state()),
        "state_uncertainty": out(Quantity::State, &equilibrium.state_uncertainty()),
        "log_state": out(Quantity::LogState, &equilibrium.log_state),
        "log_state_uncertainty": equilibrium.log_state_uncertainty(),
        "slip_rate": out(Quantity::SlipRate, &equilibrium.slip_rate),
        "slip_rate_uncertainty": out(Quantity::SlipRate, &equilibrium.slip_rate_uncertainty()),
        "eigenvalues": eigenvalues,
        "eigenvalue_uncertainty": eigenvalue_uncertainty,
        "unstable": known.map(ClusterStability::unstable),
        "verdict": known.map(|known| known.verdict.name()),
        "residual": found.residual,
    });
    if system.unequal.is_none() {
        let state = equilibrium.state();
        let cluster = |(count, i): (usize, usize)| {
            json!({
                "count": count,
                "state": units.outward(Quantity::State, state[i]),
                "log_state": units.outward(Quantity::LogState, equilibrium.log_state[i]),
                "slip_rate": units.outward(Quantity::SlipRate, equilibrium.slip_rate[i]),
            })
        };
        let clusters = equilibrium.clusters().into_iter();
        told["clusters"] = clusters.map(cluster).collect();
        told["arrangements"] = json!(equilibrium.arrangements());
    }
    told
}
