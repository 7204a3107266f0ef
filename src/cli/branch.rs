//! `twinslip branch`.

use super::Ending;
use super::continuation::{Row, Task};
use super::diagram;
use super::equilibria::verdict as verdict_name;
use super::fields::{Column, Entry};
use super::following::{self, Following, landings, range};
use super::resume::unknown;
use crate::bifurcation::{BranchRequest, BranchRow, Event, Label, Parameter, equilibria, orbits};
use crate::equilibrium::Verdict;
use crate::error::{Error, Result};
use crate::friction::positive;
use crate::model::Loading;
use crate::number::Uncertain;
use crate::orbit::Slab;
use crate::scene::{BranchOptions, Quantity, System, Units};
use serde_json::{Value, json};

pub const EXAMPLE: &str =
    "Example, all equilibria and their Hopf points at K = 0.14, and the orbits that begin there:
  twinslip branch equilibria --stiffness 0.14 -o equilibria.csv --plot equilibria.svg
  twinslip branch orbits --stiffness 0.14 --from 0.05 --to 300 -o orbits.csv --plot orbits.svg";

/// Of what the branches are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Of {
    Equilibria,
    Orbits,
}

impl Of {
    fn named(name: Option<&str>) -> Result<Self> {
        match name {
            Some("equilibria") => Ok(Of::Equilibria),
            Some("orbits") => Ok(Of::Orbits),
            Some(other) => Err(Error::Input(format!(
                "there are no branches of {other:?}; choose branch equilibria or branch orbits"
            ))),
            None => Err(Error::Input(
                "it is missing of what the branches are: branch equilibria or branch orbits".into(),
            )),
        }
    }

    fn name(self) -> &'static str {
        match self {
            Of::Equilibria => "equilibria",
            Of::Orbits => "orbits",
        }
    }
}

/// What varies, with its name and its default range.
pub struct Along {
    pub parameter: Parameter,
    pub name: &'static str,
    pub quantity: Quantity,
    range: (f64, f64),
}

impl Along {
    fn named(name: &str) -> Result<Self> {
        match name {
            "driving" => Ok(Along {
                parameter: Parameter::Driving,
                name: "driving",
                quantity: Quantity::SlipRate,
                range: following::DRIVING,
            }),
            "stiffness" => Ok(Along {
                parameter: Parameter::Stiffness,
                name: "stiffness",
                quantity: Quantity::Stiffness,
                range: following::STIFFNESS,
            }),
            other => Err(Error::parameter("along", other, "driving or stiffness")),
        }
    }
}

/// What is to be done, checked.
struct Plan {
    of: Of,
    along: Along,
    system: System,
    request: BranchRequest,
    following: Following,
    numerics: Value,
}

impl Plan {
    fn new(options: &BranchOptions) -> Result<Self> {
        let of = Of::named(options.of.as_deref())?;
        let along = Along::named(&options.along)?;
        let system = System::new(&options.model)?;
        let units = &system.units;
        let end = |name, given: Option<f64>, default| {
            given.map_or(Ok(default), |x| {
                Ok(units.inward(along.quantity, positive(name, x)?))
            })
        };
        let ends = range(
            "the range --from --to",
            (
                end("from", options.from, along.range.0)?,
                end("to", options.to, along.range.1)?,
            ),
        )?;
        let loading = loading(&system, &along, ends.0)?;
        let following = Following::new(&options.continuation, of == Of::Orbits)?;
        let out = |x| units.outward(along.quantity, x);
        let at = landings("at", options.at.as_deref(), (along.quantity, units), ends)?;
        let numerics = json!({
            "of": of.name(),
            "along": along.name,
            "from": out(ends.0),
            "to": out(ends.1),
            "symmetry": options.symmetry,
            "at": at.iter().map(|&x| out(x)).collect::<Vec<f64>>(),
            "step_limit": following.step,
            "tolerance": following.tolerance,
            "crosscheck": following.second.map(|second| second.name()),
        });
        let request = BranchRequest {
            slab: Slab {
                law: system.law,
                interfaces: system.interfaces,
                loading,
            },
            along: along.parameter,
            range: ends,
            symmetry: following::symmetry(&options.symmetry, system.interfaces)?,
            at,
            step: following.step,
            tolerance: following.tolerance,
            skip: Vec::new(),
        };
        Ok(Plan {
            of,
            along,
            system,
            request,
            following,
            numerics,
        })
    }

    fn explain(&self) {
        let out = |x| self.system.units.outward(self.along.quantity, x);
        let (from, to) = self.request.range;
        eprintln!("plan of this command");
        following::explain_symmetry(self.request.symmetry, self.system.interfaces);
        eprintln!(
            "  range             {} from {:e} to {:e}",
            self.along.name,
            out(from),
            out(to)
        );
        match self.of {
            Of::Equilibria => eprintln!(
                "  method            all steady states in closed form or from certain brackets; the characteristic polynomials"
            ),
            Of::Orbits => eprintln!(
                "  method            taylor, tangents on, multiple shooting; begins at the Hopf points"
            ),
        }
        following::explain(&self.following, &self.request.at);
    }
}

/// V_H and K; what varies begins at `from` and must not be given.
fn loading(system: &System, along: &Along, from: f64) -> Result<Loading> {
    let twice = |given: Option<f64>| match given {
        None => Ok(()),
        Some(_) => Err(Error::Input(format!(
            "--{0} can't be given with --along {0}, for it varies; use --from and --to",
            along.name
        ))),
    };
    match along.parameter {
        Parameter::Driving => {
            twice(system.driving)?;
            Loading::new(from, system.needed_stiffness()?)
        }
        Parameter::Stiffness => {
            twice(system.stiffness)?;
            Loading::new(system.needed_driving()?, from)
        }
    }
}

pub fn run(options: &BranchOptions, words: &[String]) -> Result<Ending> {
    let plan = Plan::new(options)?;
    let recheck = |special: &_, method| {
        orbits::crosscheck(&plan.request.slab, plan.request.symmetry, special, method)
    };
    let task = Task {
        system: &plan.system,
        columns: columns(plan.of, plan.system.interfaces),
        numerics: plan.numerics.clone(),
        second: plan
            .following
            .second
            .map(|method| (method, &recheck as &dyn Fn(&_, _) -> _)),
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
            let request = BranchRequest {
                skip: skip.to_vec(),
                ..plan.request.clone()
            };
            match plan.of {
                Of::Equilibria => equilibria::branch(&request, seen),
                Of::Orbits => orbits::branch(&request, seen),
            }
        },
        |rows, _| diagram::branches(rows, &plan.along, &plan.request.slab, &plan.system),
    )
}

fn columns(of: Of, interfaces: usize) -> Vec<Column<BranchRow>> {
    type Row = BranchRow;
    let orbits = of == Of::Orbits;
    // The exponent of an equilibrium is a rate, that of an orbit belongs to its period.
    let exponent = if orbits {
        Quantity::Number
    } else {
        Quantity::Growth
    };
    let mut columns = vec![
        Column::new("driving", Quantity::SlipRate, |row: &Row| {
            Entry::Number(Some(row.driving))
        }),
        Column::new("stiffness", Quantity::Stiffness, |row: &Row| {
            Entry::Number(Some(row.stiffness))
        }),
        Column::new("stress", Quantity::Stress, |row: &Row| {
            Entry::Number(Some(row.stress))
        }),
        Column::new("stress_min", Quantity::Stress, |row: &Row| {
            Entry::Number(Some(row.stress_range.0))
        }),
        Column::new("stress_max", Quantity::Stress, |row: &Row| {
            Entry::Number(Some(row.stress_range.1))
        }),
        Column::new("period", Quantity::Time, |row: &Row| {
            Entry::Number(row.period)
        }),
        Column::new("state_1", Quantity::State, |row: &Row| {
            Entry::Number(Some(row.state[0]))
        }),
        Column::new("state_2", Quantity::State, |row: &Row| {
            Entry::Number(Some(row.state[1]))
        }),
        Column::new("slip_rate_1", Quantity::SlipRate, |row: &Row| {
            Entry::Number(Some(row.slip_rate[0]))
        }),
        Column::new("slip_rate_2", Quantity::SlipRate, |row: &Row| {
            Entry::Number(Some(row.slip_rate[1]))
        }),
        Column::new("ln_abs_multiplier_1", exponent, |row: &Row| {
            Entry::Number(row.ln_abs_multiplier[0])
        }),
        Column::new("ln_abs_multiplier_2", exponent, |row: &Row| {
            Entry::Number(row.ln_abs_multiplier[1])
        }),
        Column::new("verdict", Quantity::Number, |row: &Row| {
            Entry::word(Some(verdict_name(row.verdict)))
        }),
        Column::new("label", Quantity::Number, |row: &Row| {
            Entry::word(row.label.map(Label::name))
        }),
        Column::new("branch", Quantity::Number, |row: &Row| {
            Entry::Count(row.branch)
        }),
    ];
    if interfaces == 1 {
        columns.retain(|column| !column.name.ends_with("_2"));
    }
    let hidden: &[&str] = match of {
        Of::Equilibria => &[
            "stress_min",
            "stress_max",
            "period",
            "ln_abs_multiplier_1",
            "ln_abs_multiplier_2",
        ],
        Of::Orbits => &[
            "stress",
            "slip_rate_1",
            "slip_rate_2",
            "ln_abs_multiplier_2",
        ],
    };
    for column in &mut columns {
        column.in_table = !hidden.contains(&column.name);
    }
    columns
}

impl Row for BranchRow {
    const WHOLE: &'static str = "branch";
    const WHOLES: &'static str = "branches";

    fn of(event: Event) -> std::result::Result<Self, Event> {
        match event {
            Event::Branch(row) => Ok(row),
            other => Err(other),
        }
    }

    fn read<'a>(cell: &dyn Fn(&str) -> &'a str, units: &Units) -> Option<Self> {
        let maybe = |name: &str, quantity| {
            let x = cell(name).parse::<f64>().ok()?;
            Some(units.inward(quantity, x))
        };
        let both = |name: &str, quantity| {
            let first = maybe(&format!("{name}_1"), quantity)?;
            // A single interface has one column.
            Some([
                first,
                maybe(&format!("{name}_2"), quantity).unwrap_or(first),
            ])
        };
        let verdicts = [Verdict::Stable, Verdict::Unstable, Verdict::Undecided];
        Some(BranchRow {
            branch: cell("branch").parse().ok()?,
            driving: maybe("driving", Quantity::SlipRate)?,
            stiffness: maybe("stiffness", Quantity::Stiffness)?,
            stress: maybe("stress", Quantity::Stress)?,
            stress_range: (
                maybe("stress_min", Quantity::Stress)?,
                maybe("stress_max", Quantity::Stress)?,
            ),
            period: maybe("period", Quantity::Time),
            state: both("state", Quantity::State)?,
            slip_rate: both("slip_rate", Quantity::SlipRate)?,
            // Not shown but in the line itself, which is kept as it stands.
            ln_abs_multiplier: [None; 2],
            verdict: verdicts
                .into_iter()
                .find(|&verdict| verdict_name(verdict) == cell("verdict"))?,
            label: Label::named(cell("label")),
        })
    }

    fn number(&self) -> usize {
        self.branch
    }

    fn label(&self) -> Option<Label> {
        self.label
    }

    fn loading(&self) -> (Uncertain, Uncertain) {
        (unknown(self.driving), unknown(self.stiffness))
    }

    fn period(&self) -> Option<f64> {
        self.period
    }

    /// At a bifurcation, and where a branch ends in one, there is nothing to decide.
    fn undecided(&self) -> bool {
        self.verdict == Verdict::Undecided && matches!(self.label, None | Some(Label::Uz))
    }
}
