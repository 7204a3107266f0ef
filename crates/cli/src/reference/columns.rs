//! The page on columns, from the lists of columns by which rows are written.

use super::meanings::meaning;
use super::{code, escaped};
use clap::Parser;
use std::fmt::Write;
use twinslip_tasks::scene::{
    AnySystem, Column, OrbitOptions, OrbitPlan, Quantity, SweepLayout, Units, many_run_columns,
    run_columns, section_columns,
};
use twinslip_tasks::views;

const HEAD: &str = "# Columns

Columns of the rows that each command writes, for two interfaces with a built-in law. CSV files and objects of JSON have the same names. An
ending `_i` stands for `_1`, `_2` and so on, one column for each interface, eigenvalue or multiplier. A column marked ± is followed in CSV by one
with the ending `_uncertainty`; in JSON its value is `{\"value\": x, \"uncertainty\": u}`. The true value lies within u of x. A number
that is not known is an empty cell in CSV and `null` in JSON.

Units are those without `--si`. With `--si` stress is in Pa, slip rate in m/s, slip in m, stiffness in Pa/m, and time in the unit of `--time-unit`,
seconds by default. JSON names them under `units`.

Rows of a user-defined system have its states under their own names in place of stress, state and slip rate; those of a friction law from a
file are the same as of a built-in one. `branch` and `locus` along other parameters than V_H and K have columns of these names in front. With `--ensemble` columns with the endings
`_lower` and `_upper` follow ([uncertainty of a fit](../uncertainty.md)). Files of `branch`, `locus` and `sweep` have a last column `row_check`
([files](files.md)).
";

/// What a list of columns belongs to, in the words of a heading.
struct Section {
    heading: &'static str,
    about: &'static str,
    columns: Vec<Described>,
}

/// A column without its rows.
struct Described {
    name: String,
    quantity: Quantity,
    uncertain: bool,
    meaning: Option<&'static str>,
}

pub fn page() -> String {
    let mut page = HEAD.to_owned();
    let units = Units::new(None, false);
    for section in sections() {
        let _ = write!(
            page,
            "\n## {}\n\n{}\n\n| column | unit | meaning |\n|---|---|---|\n",
            section.heading, section.about
        );
        for column in numbered(section.columns) {
            let unit = match units.name(column.quantity) {
                "1" => "",
                unit => unit,
            };
            let _ = writeln!(
                page,
                "| {}{} | {} | {} |",
                code(&column.name),
                if column.uncertain { " ±" } else { "" },
                escaped(&unit.replace("sigma", "σ")),
                escaped(
                    column
                        .meaning
                        .unwrap_or_else(|| meaning(section.heading, &column.name))
                ),
            );
        }
    }
    page
}

/// Two interfaces with all defaults.
#[derive(clap::Parser)]
struct Two {
    #[command(flatten)]
    options: OrbitOptions,
}

fn sections() -> Vec<Section> {
    const COUNT: usize = 2;
    let section = |heading, about, columns| Section {
        heading,
        about,
        columns,
    };
    let options = Two::parse_from(["two", "--driving=1", "--stiffness=1"]).options;
    let of_two = AnySystem::new(&options.model).expect("two interfaces");
    let orbits = OrbitPlan::new(&options).expect("an orbit of two interfaces");
    let of_grid = SweepLayout::interfaces(COUNT, std::iter::empty());
    vec![
        section(
            "law",
            "One row for each slip rate.",
            described(&views::law_columns(true)),
        ),
        section(
            "integrate",
            "One row for each step, or for each time asked for by `--points` or `--every`. With `--program` a column `driving` follows.",
            described(&run_columns(&of_two)),
        ),
        section(
            "integrate: events",
            "One row for each slip event of one or two interfaces (`--events`).",
            described(&views::event_columns(COUNT)),
        ),
        section(
            "integrate, eight interfaces and more",
            "Rows of all interfaces together. `--columns state_17,slip_rate_17` adds those of one.",
            described(&many_run_columns()),
        ),
        section(
            "integrate, three interfaces and more: events",
            "One row for each slip event (`--events`).",
            described(&views::many_event_columns(COUNT)),
        ),
        section(
            "integrate, three interfaces and more: participation",
            "One row for each interface (`--participation`). Constants that `--draw` draws follow under their names.",
            described(&views::participation_columns(&[])),
        ),
        section(
            "equilibria",
            "One row for each steady state.",
            described(&views::equilibria_columns(COUNT)),
        ),
        section(
            "equilibria of more than two interfaces",
            "One row for each kind of steady state; interfaces in the same state are counted together.",
            described(&views::equilibria_columns(COUNT + 1)),
        ),
        section(
            "equilibria with --draw",
            "One row for each interface of the steady state that was found.",
            described(&views::steady_interface_columns(&[])),
        ),
        section(
            "orbit",
            "One row for each periodic orbit. With `--points` the rows are those of `integrate`, over one period.",
            described(&views::orbit_columns(&orbits)),
        ),
        section(
            "orbit with --phase-response",
            "One row for each point of the orbit.",
            described(&views::response_columns(&of_two)),
        ),
        section(
            "section",
            "One row for each return to the section.",
            described(&section_columns(&of_two)),
        ),
        section(
            "branch orbits",
            "One row for each point.",
            described(&views::branch_columns(true, COUNT)),
        ),
        section(
            "branch equilibria",
            "One row for each point.",
            described(&views::branch_columns(false, COUNT)),
        ),
        section(
            "branch equilibria of more than two interfaces",
            "One row for each point.",
            described(&views::branch_columns(false, COUNT + 1)),
        ),
        section(
            "locus",
            "One row for each point of a curve of bifurcations.",
            described(&views::locus_columns(COUNT)),
        ),
        section(
            "branch and locus: special points",
            "One row of `FILE.special.csv` for each special point; in JSON `result.special`.",
            described(&views::special_columns()),
        ),
        section(
            "sweep",
            "One row for each point of the grid and each of its starts. Parameters of `--grid` follow V_H and K.",
            described(&views::sweep_columns(&of_grid)),
        ),
        section(
            "fit",
            "One row for each sample.",
            described(&views::fit_columns(true)),
        ),
        section(
            "fit --look",
            "One row for each stretch of one velocity; in JSON `result.look` has the columns of the record, its sampling, steps and holds.",
            described(&views::look_columns()),
        ),
    ]
}

fn described<R>(columns: &[Column<R>]) -> Vec<Described> {
    let one = |column: &Column<R>| Described {
        name: column.name.to_string(),
        quantity: column.quantity,
        uncertain: column.uncertain,
        meaning: column.meaning,
    };
    columns.iter().map(one).collect()
}

/// Columns that differ in their number alone as one: `slip_rate_i`.
fn numbered(columns: Vec<Described>) -> Vec<Described> {
    let mut kept: Vec<Described> = Vec::new();
    for column in columns {
        let is_number = |part: &&str| part.bytes().all(|byte| byte.is_ascii_digit());
        let parts: Vec<&str> = column.name.split('_').collect();
        let has_number = parts.iter().any(is_number);
        let parts = parts
            .iter()
            .map(|part| if is_number(part) { "i" } else { part });
        let name = parts.collect::<Vec<_>>().join("_");
        if !has_number {
            kept.push(column);
        } else if kept.iter().all(|one| one.name != name) {
            kept.push(Described { name, ..column });
        }
    }
    kept
}
