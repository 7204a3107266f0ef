//! `twinslip equilibria --system`.

use crate::Ending;
use crate::call::Call;
use crate::report::{self, Report};
use crate::words::several;
use serde_json::{Map, Value, json};
use twinslip::equilibrium::Verdict;
use twinslip::error::Result;
use twinslip::number::Interval;
use twinslip_output::Format;
use twinslip_tasks::scene::{
    Described, EquilibriaOptions, Quantity, SearchPlace, TextEquilibria, TextEquilibriaPlan,
    TextEquilibrium, TextModel,
};
use twinslip_tasks::views;

pub fn run(options: &EquilibriaOptions, model: TextModel, call: &Call) -> Result<Ending> {
    let plan = TextEquilibriaPlan::new(options, model)?;
    let outputs = (&options.output, options.plot.as_deref());
    let report = report::begun(outputs, call, || plan.explain())?;
    let found = plan.solve()?;
    if let Some(path) = &options.plot {
        match views::picture_of_text_equilibria(&plan.model, &found.equilibria) {
            Some(drawing) => report.draw(path, &drawing)?,
            None => report.say("there is no steady state to draw"),
        }
    }
    let ending = write(&report, &plan, &found)?;
    let undecided = |one: &&TextEquilibrium| one.stability.verdict == Verdict::Undecided;
    let verdicts = found.equilibria.iter().filter(undecided).count();
    Ok(match (ending, &found.undecided[..]) {
        (Ending::Done, [first, ..]) => report.undecided(format_args!(
            "the number of equilibria, as {} may contain any, near {}; try a `box` without that place",
            several(found.undecided.len(), "part of the box", "parts of the box"),
            near(&plan.model, first)
        )),
        (Ending::Done, []) if verdicts > 0 => report.undecided(format_args!(
            "the stability of {}, as an eigenvalue is within its error of the imaginary axis; try other parameters",
            several(verdicts, "equilibrium", "equilibria")
        )),
        (ending, _) => ending,
    })
}

fn near(model: &TextModel, part: &[Interval]) -> String {
    let states = model.system.states().iter().zip(part);
    let middle = |x: &Interval| 0.5 * x.lo() + 0.5 * x.hi();
    let states = states.map(|(name, x)| format!("{name} = {:.6}", middle(x)));
    states.collect::<Vec<_>>().join(", ")
}

fn write(report: &Report<'_>, plan: &TextEquilibriaPlan, found: &TextEquilibria) -> Result<Ending> {
    let search = match plan.place {
        SearchPlace::Near(_) => "near a start",
        SearchPlace::Within(_) => "in a box",
    };
    let model = &plan.model;
    let mut numerics = json!({"search": search});
    if let SearchPlace::Within(all) = &plan.place {
        numerics["box"] = Value::Object(ends(model, all));
    }
    if report.format == Format::Json {
        let list: Vec<Value> = found
            .equilibria
            .iter()
            .map(|one| object(one, model))
            .collect();
        let work = json!({"equilibria": list.len()});
        let undecided = found.undecided.iter();
        let undecided: Vec<_> = undecided.map(|part| ends(model, part)).collect();
        let result = json!({
            "equilibria": list,
            "complete": matches!(plan.place, SearchPlace::Within(_)) && undecided.is_empty(),
            "undecided": undecided,
        });
        let bytes = report.envelope(model, numerics, result, work, None);
        return report.write(&bytes);
    }
    report.write_all(
        model.units(),
        report.remarks(model, &numerics),
        &views::text_equilibria_columns(model),
        &found.equilibria,
    )
}

/// The ends of a box by the names of the states.
fn ends(model: &TextModel, part: &[Interval]) -> Map<String, Value> {
    let states = model.system.states().iter().zip(part).enumerate();
    let pair = |(i, (name, x)): (usize, (&&str, &Interval))| {
        let outward = |x| model.units().outward(model.quantity(i), x);
        (
            (*name).to_owned(),
            json!([outward(x.lo()), outward(x.hi())]),
        )
    };
    states.map(pair).collect()
}

fn object(found: &TextEquilibrium, model: &TextModel) -> Value {
    let states = model.system.states().iter().zip(&found.state);
    let units = model.units();
    let mut all = Map::new();
    for (i, (name, x)) in states.enumerate() {
        let x = units.outward_uncertain(model.quantity(i), *x);
        all.insert(
            (*name).to_owned(),
            twinslip_output::uncertain((x.value, x.uncertainty)),
        );
    }
    if model.slab.is_some() {
        let rates = found.slip_rate.iter();
        let rates: Vec<f64> = rates
            .map(|v| units.outward(Quantity::SlipRate, *v))
            .collect();
        let psi = found.state[1..=rates.len()].iter();
        let psi: Vec<f64> = psi
            .map(|w| units.outward(Quantity::State, w.value.exp()))
            .collect();
        all.insert("state".into(), json!(psi));
        all.insert("slip_rate".into(), json!(rates));
    }
    let growth = |x: f64| units.outward(Quantity::Growth, x);
    let eigenvalues = found.stability.eigenvalues.iter();
    all.insert(
        "eigenvalues".into(),
        eigenvalues
            .map(|z| json!([growth(z.re), growth(z.im)]))
            .collect(),
    );
    let uncertainty = found.stability.uncertainty.iter();
    let uncertainty: Vec<f64> = uncertainty.map(|x| growth(*x)).collect();
    all.insert("eigenvalue_uncertainty".into(), json!(uncertainty));
    all.insert("unstable".into(), json!(found.stability.unstable()));
    all.insert("verdict".into(), json!(found.stability.verdict.name()));
    all.insert("residual".into(), json!(found.residual));
    Value::Object(all)
}
