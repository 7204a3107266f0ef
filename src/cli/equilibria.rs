//! `twinslip equilibria`.

use super::report::{self, Report, unit_names};
use super::{Ending, say, written};
use crate::equilibrium::{
    Equilibrium, Solver, Stability, SteadyStates, Symmetry, Verdict, stability, steady_states,
};
use crate::error::{Error, Result};
use crate::output::{Cell, Format};
use crate::scene::{EquilibriaOptions, Quantity, System};
use nalgebra::Complex;
use serde_json::{Value, json};

/// An equilibrium with what the stiffness makes of it.
struct ClassifiedEquilibrium {
    equilibrium: Equilibrium,
    stability: Option<Stability>,
    residual: f64,
}

pub fn run(options: &EquilibriaOptions, words: &[String]) -> Result<Ending> {
    let system = System::new(&options.model)?;
    let driving = system.needed_driving()?;
    let (name, solver) = solver(options.solver.as_deref())?;
    let report = Report::new(&options.output, words, &[])?;
    if options.output.explain {
        explain(&system, name);
    }
    let SteadyStates {
        equilibria,
        complete,
    } = steady_states(&system.law, driving, system.interfaces, solver)?;
    let found = equilibria
        .into_iter()
        .map(|equilibrium| {
            let stability = system
                .stiffness
                .map(|k| stability(&system.law, &equilibrium, k))
                .transpose()?;
            Ok(ClassifiedEquilibrium {
                residual: equilibrium.residual(&system.law, driving),
                stability,
                equilibrium,
            })
        })
        .collect::<Result<Vec<_>>>()?;
    let ending = write(&report, &system, name, &found, complete)?;
    if !complete {
        report.say(
            "the number of steady states is undecided: V_H is within rounding of a bifurcation",
        );
    }
    let undecided = |found: &ClassifiedEquilibrium| {
        let verdict = found.stability.as_ref().map(|stability| stability.verdict);
        verdict == Some(Verdict::Undecided)
    };
    if ending == Ending::Done && (!complete || found.iter().any(undecided)) {
        return Ok(Ending::Undecided);
    }
    Ok(ending)
}

fn solver(name: Option<&str>) -> Result<(&'static str, Solver)> {
    #[cfg(feature = "sundials")]
    const DEFAULT: &str = "kinsol";
    #[cfg(not(feature = "sundials"))]
    const DEFAULT: &str = "newton";
    match name.unwrap_or(DEFAULT) {
        #[cfg(feature = "sundials")]
        "kinsol" => Ok(("kinsol", Solver::Kinsol)),
        #[cfg(not(feature = "sundials"))]
        "kinsol" => Err(Error::Input(
            "solver kinsol needs SUNDIALS, which this build is without; choose newton".into(),
        )),
        "newton" => Ok(("newton", Solver::Newton)),
        other => Err(Error::unknown("solver", other, &["kinsol", "newton"])),
    }
}

fn explain(system: &System, solver: &str) {
    say("plan of this command");
    say("  symmetric         closed formula at V_H over the number of interfaces");
    if system.interfaces == 2 {
        say(format_args!(
            "  asymmetric        {solver}, from a certain bracket around each solution"
        ));
    } else {
        say("  asymmetric        off: one interface has none");
    }
    if system.stiffness.is_some() {
        say(
            "  stability         on: Routh-Hurwitz in interval arithmetic, eigenvalues from the characteristic polynomials",
        );
    } else {
        say("  stability         off: it depends on the stiffness, which is not given");
    }
}

fn write(
    report: &Report<'_>,
    system: &System,
    solver: &str,
    found: &[ClassifiedEquilibrium],
    complete: bool,
) -> Result<Ending> {
    let numerics = json!({"solver": solver});
    if report.format == Format::Json {
        let list: Vec<Value> = found.iter().map(|one| object(one, system)).collect();
        let result = json!({"equilibria": list, "complete": complete});
        let work = json!({"equilibria": found.len()});
        let bytes = report.envelope(system, numerics, result, work, None);
        return written(report.place.write(&bytes), &report.place);
    }
    let table = report.format == Format::Table;
    let columns = columns(system.interfaces, table);
    let remarks = report.remarks(system, &numerics);
    let names: Vec<String> = columns.iter().map(|(name, _)| name.clone()).collect();
    let units = unit_names(&system.units, columns.iter().map(|(_, quantity)| *quantity));
    let all = report
        .begin(remarks, &names, &units)
        .and_then(|mut writer| {
            found
                .iter()
                .try_for_each(|one| writer.row(&cells(one, system, table)))
        });
    report.ended(written(all, &report.place))
}

/// The columns of CSV; a table has room for what is looked at first.
fn columns(interfaces: usize, table: bool) -> Vec<(String, Quantity)> {
    let mut columns = vec![
        ("symmetry".to_owned(), Quantity::Number),
        ("stress".to_owned(), Quantity::Stress),
    ];
    if !table {
        columns.push(("stress_uncertainty".to_owned(), Quantity::Stress));
    }
    let per_interface = [
        ("state", Quantity::State),
        ("log_state", Quantity::LogState),
        ("slip_rate", Quantity::SlipRate),
    ];
    for (name, quantity) in per_interface {
        if !(table && quantity == Quantity::LogState) {
            columns.extend((1..=interfaces).map(|i| (format!("{name}_{i}"), quantity)));
        }
        if !table {
            let uncertainty = |i| (format!("{name}_uncertainty_{i}"), quantity);
            columns.extend((1..=interfaces).map(uncertainty));
        }
    }
    for i in 1..=shown_eigenvalues(interfaces, table) {
        columns.push((format!("eigenvalue_{i}_re"), Quantity::Growth));
        columns.push((format!("eigenvalue_{i}_im"), Quantity::Growth));
        if !table {
            columns.push((format!("eigenvalue_uncertainty_{i}"), Quantity::Growth));
        }
    }
    columns.push(("verdict".to_owned(), Quantity::Number));
    if !table {
        columns.push(("residual".to_owned(), Quantity::Number));
    }
    columns
}

/// A table shows the leading one, which decides.
fn shown_eigenvalues(interfaces: usize, table: bool) -> usize {
    if table { 1 } else { interfaces + 1 }
}

fn cells(found: &ClassifiedEquilibrium, system: &System, table: bool) -> Vec<Cell> {
    let units = &system.units;
    let equilibrium = &found.equilibrium;
    let stress = units.outward_uncertain(Quantity::Stress, equilibrium.stress);
    let mut cells = vec![
        Cell::from(symmetry(equilibrium.symmetry)),
        stress.value.into(),
    ];
    if !table {
        cells.push(stress.uncertainty.into());
    }
    let mut extend = |quantity, values: Vec<f64>, uncertainties: Vec<f64>| {
        let shown = if table { Vec::new() } else { uncertainties };
        let all = values.into_iter().chain(shown);
        cells.extend(all.map(|x| Cell::Number(units.outward(quantity, x))));
    };
    let [state, log_state, slip_rate] = uncertainties(equilibrium);
    extend(Quantity::State, equilibrium.state(), state);
    if !table {
        let values = equilibrium.log_state.clone();
        extend(Quantity::LogState, values, log_state);
    }
    extend(Quantity::SlipRate, equilibrium.slip_rate.clone(), slip_rate);
    for i in 0..shown_eigenvalues(system.interfaces, table) {
        let known = found.stability.as_ref();
        let eigenvalue = known.and_then(|s| s.eigenvalues.get(i));
        let uncertainty = known.and_then(|s| s.uncertainty.get(i).copied());
        let mut parts = vec![eigenvalue.map(|z| z.re), eigenvalue.map(|z| z.im)];
        if !table {
            parts.push(uncertainty);
        }
        for part in parts {
            cells.push(part.map(|x| units.outward(Quantity::Growth, x)).into());
        }
    }
    let verdict = found.stability.as_ref().map(|s| s.verdict.name());
    cells.push(verdict.map_or(Cell::Missing, Cell::from));
    if !table {
        cells.push(found.residual.into());
    }
    cells
}

/// Of the states, of their logarithms and of the slip rates.
fn uncertainties(equilibrium: &Equilibrium) -> [Vec<f64>; 3] {
    [
        equilibrium.state_uncertainty(),
        equilibrium.log_state_uncertainty(),
        equilibrium.slip_rate_uncertainty(),
    ]
}

fn object(found: &ClassifiedEquilibrium, system: &System) -> Value {
    let units = &system.units;
    let equilibrium = &found.equilibrium;
    let out = |quantity, values: &[f64]| -> Vec<f64> {
        values.iter().map(|&x| units.outward(quantity, x)).collect()
    };
    let pair = |z: &Complex<f64>| [z.re, z.im].map(|x| units.outward(Quantity::Growth, x));
    // as many as there are, null where one is beyond the range of doubles
    let count = shown_eigenvalues(system.interfaces, false);
    let [eigenvalues, eigenvalue_uncertainty] = match &found.stability {
        None => [Value::Null, Value::Null],
        Some(stability) => {
            let known = |i| stability.eigenvalues.get(i).map(pair);
            let radius = |i| stability.uncertainty.get(i).copied();
            let radius = |i| radius(i).map(|x| units.outward(Quantity::Growth, x));
            [
                json!((0..count).map(known).collect::<Vec<_>>()),
                json!((0..count).map(radius).collect::<Vec<_>>()),
            ]
        }
    };
    let [state, log_state, slip_rate] = uncertainties(equilibrium);
    json!({
        "symmetry": symmetry(equilibrium.symmetry),
        "stress": report::uncertain(units, Quantity::Stress, equilibrium.stress),
        "state": out(Quantity::State, &equilibrium.state()),
        "state_uncertainty": out(Quantity::State, &state),
        "log_state": out(Quantity::LogState, &equilibrium.log_state),
        "log_state_uncertainty": out(Quantity::LogState, &log_state),
        "slip_rate": out(Quantity::SlipRate, &equilibrium.slip_rate),
        "slip_rate_uncertainty": out(Quantity::SlipRate, &slip_rate),
        "eigenvalues": eigenvalues,
        "eigenvalue_uncertainty": eigenvalue_uncertainty,
        "verdict": found.stability.as_ref().map(|s| s.verdict.name()),
        "residual": found.residual,
    })
}

pub(super) fn symmetry(symmetry: Symmetry) -> &'static str {
    match symmetry {
        Symmetry::Symmetric => "symmetric",
        Symmetry::Asymmetric => "asymmetric",
    }
}
