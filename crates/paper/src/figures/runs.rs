//! Panels of runs in time and of their returns.

use crate::product::Made;
use crate::sheet::Sheet;
use crate::{Map, Pieces, Run};
use twinslip::error::Result;
use twinslip::friction::steady_stress;
use twinslip_output::RowList;
use twinslip_output::plot::{Axis, Block, Drawing, Note, Panel, PlotSeries, Stroke};
use twinslip_tasks::scene::Described;
use twinslip_tasks::views;

/// The colour of what is drawn for comparison: a law, a diagonal.
const GREY: usize = 6;
/// Returns up to this number are drawn broad.
const FEW: usize = 400;
/// Points of a law's curve.
const LAW_POINTS: usize = 200;

/// How runs are computed, in words.
pub fn method(run: &Run) -> String {
    let work = &run.outcome.work;
    format!(
        "{} with rtol {:e} on (tau, ln psi), {} steps",
        run.plan.method.name(),
        run.plan.tolerances.rtol,
        work.steps
    )
}

/// The rows of the end of a run.
pub fn last(run: &Run, shown: f64) -> RowList {
    let mut some = RowList::new(run.rows.columns.clone());
    let from = run.plan.until - shown;
    // Time is the first column.
    for row in run.rows.iter().filter(|row| row[0] >= from) {
        some.numbers.extend_from_slice(row);
    }
    some
}

/// A column by name.
pub fn column(rows: &RowList, name: &str) -> Vec<f64> {
    rows.column(name).unwrap_or_default()
}

/// What follows from two columns, row by row.
pub fn combined(rows: &RowList, names: [&str; 2], of: impl Fn(f64, f64) -> f64) -> Vec<f64> {
    let (a, b) = (column(rows, names[0]), column(rows, names[1]));
    a.iter().zip(&b).map(|(&a, &b)| of(a, b)).collect()
}

/// Stress, states and slip rates in time.
pub fn in_time(run: &Run, rows: &RowList) -> Vec<Panel> {
    let mut panels = views::panels_in_time(&run.plan, rows);
    // The parameters stand above all panels.
    panels[0].title = "stress".into();
    panels
}

/// The title of a run: what is special of it, and its parameters.
pub fn title(words: &str, run: &Run) -> String {
    let plan = &run.plan;
    let (driving, stiffness) = (run.loading().driving, run.loading().stiffness);
    let parameters = views::parameters(driving, stiffness, plan.system.units());
    format!("{words}{parameters}")
}

/// The phase plane with the steady-state law as a dotted line.
fn plane_with_law(run: &Run, rows: &RowList) -> Panel {
    let mut panel = views::phase_plane(&run.plan, rows);
    let law = run.law();
    let rates = [column(rows, "slip_rate_1"), column(rows, "slip_rate_2")].concat();
    let rates = rates.into_iter().filter(|&v| v > 0.0);
    let (lo, hi) = rates.fold((f64::INFINITY, 0.0), |(lo, hi): (f64, f64), v| {
        (lo.min(v), hi.max(v))
    });
    if lo < hi {
        let at = |i: usize| lo * (hi / lo).powf(i as f64 / LAW_POINTS as f64);
        let x: Vec<f64> = (0..=LAW_POINTS).map(at).collect();
        let y = x.iter().map(|&v| steady_stress(&law, v)).collect();
        let dotted = PlotSeries::new("steady-state law", x, y);
        panel
            .series
            .push(dotted.stroke(Stroke::Dotted).colour(GREY));
    }
    panel
}

/// How far the interfaces differ: ln psi_1 - ln psi_2, against stress.
fn asymmetry(rows: &RowList) -> Panel {
    let apart = combined(rows, ["state_1", "state_2"], |a, b| (a / b).ln());
    Panel {
        series: vec![PlotSeries::new("", apart, column(rows, "stress"))],
        ..Panel::new(
            "asymmetric subspace",
            Axis::linear("ln ψ₁ − ln ψ₂"),
            Axis::linear("stress τ [aσ]"),
        )
    }
}

/// A figure of runs with their return maps, from scenes NAME and NAME-map, each under its parameters after its name; so much time
/// of the end is shown.
pub fn of_runs(pieces: &Pieces<'_>, scenes: &[(&str, &str)], shown: f64) -> Result<Made> {
    let (mut sheet, mut blocks, mut methods) = (Sheet::new(), Vec::new(), Vec::new());
    for (scene, title) in scenes {
        let (run, map) = (pieces.run(scene)?, pieces.map(&format!("{scene}-map"))?);
        sheet.add_run(*scene, &run);
        sheet.add_map(format!("{scene} returns"), &map);
        blocks.extend(with_returns(
            &self::title(title, &run),
            &run,
            &last(&run, shown),
            &map,
        ));
        methods.push(format!(
            "{scene}: {}; {} returns after {}, each landed on",
            method(&run),
            map.outcome.returns,
            map.plan.skip
        ));
    }
    Ok(Made {
        sheet,
        drawing: Some(Drawing::blocks(blocks)),
        method: methods.join(". "),
    })
}

/// A run with its return map: in time, in the phase plane and the asymmetric subspace, and at the section.
fn with_returns(title: &str, run: &Run, rows: &RowList, map: &Map) -> [Block; 2] {
    let block = |title: &str, columns| Block {
        title: title.into(),
        columns,
    };
    let planes = vec![plane_with_law(run, rows), asymmetry(rows)];
    let returns = vec![
        vec![return_map(map)],
        vec![views::states_at_returns(&map.rows)],
    ];
    [
        block(title, vec![in_time(run, rows), planes]),
        block("", returns),
    ]
}

/// A run with its path in the phase plane and in the phase space.
pub fn with_phase_space(title: &str, run: &Run, rows: &RowList) -> Vec<Block> {
    let [front, side, above] = phase_space(rows);
    let block = |title: &str, columns| Block {
        title: title.into(),
        columns,
    };
    let law = plane_with_law(run, rows);
    // Equal interfaces leave nothing to be seen across.
    if run.plan.start.len() < 3 {
        return vec![block(title, vec![in_time(run, rows), vec![law, front]])];
    }
    vec![
        block(title, vec![in_time(run, rows), vec![law, front]]),
        block("", vec![vec![side, above], vec![in_space(rows)]]),
    ]
}

/// The phase space in oblique projection, in a box whose sides are the ranges of what it shows.
fn in_space(rows: &RowList) -> Panel {
    /// Where what is behind is drawn, as parts of the sides of the box.
    const BACK: (f64, f64) = (0.45, 0.35);
    let part = |values: Vec<f64>| -> Vec<f64> {
        let lo = values.iter().copied().fold(f64::INFINITY, f64::min);
        let hi = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        values.into_iter().map(|x| (x - lo) / (hi - lo)).collect()
    };
    let at = |[x, y, z]: [f64; 3]| (x + BACK.0 * y, z + BACK.1 * y);
    let across = part(combined(rows, ["state_1", "state_2"], |a, b| {
        (a * b).log10()
    }));
    let back = part(combined(rows, ["state_1", "state_2"], |a, b| {
        (a / b).log10()
    }));
    let up = part(column(rows, "stress"));
    let path = (0..up.len()).map(|i| at([across[i], back[i], up[i]]));
    let (x, y): (Vec<f64>, Vec<f64>) = path.unzip();
    // The edges that meet in the corner behind, and those of the floor and the left side.
    let edges = [
        ([0.0, 0.0, 0.0], [1.0, 0.0, 0.0]),
        ([0.0, 0.0, 0.0], [0.0, 1.0, 0.0]),
        ([0.0, 0.0, 0.0], [0.0, 0.0, 1.0]),
        ([1.0, 0.0, 0.0], [1.0, 1.0, 0.0]),
        ([0.0, 1.0, 0.0], [1.0, 1.0, 0.0]),
        ([0.0, 1.0, 0.0], [0.0, 1.0, 1.0]),
        ([0.0, 0.0, 1.0], [0.0, 1.0, 1.0]),
        ([1.0, 1.0, 0.0], [1.0, 1.0, 1.0]),
        ([0.0, 1.0, 1.0], [1.0, 1.0, 1.0]),
    ];
    let (mut box_x, mut box_y) = (Vec::new(), Vec::new());
    for (from, to) in edges {
        let (from, to) = (at(from), at(to));
        box_x.extend([from.0, to.0, f64::NAN]);
        box_y.extend([from.1, to.1, f64::NAN]);
    }
    let frame = PlotSeries::new("", box_x, box_y);
    let name = |place, text: &str| {
        let (x, y) = at(place);
        Note::new(x, y, text)
    };
    Panel {
        series: vec![
            frame.stroke(Stroke::Dotted).colour(GREY),
            PlotSeries::new("", x, y).colour(0),
        ],
        notes: vec![
            name([0.5, -0.2, 0.0], "w₁ + w₂"),
            name([1.12, 0.5, 0.0], "w₁ − w₂"),
            name([-0.1, 0.0, 0.5], "τ"),
        ],
        ..Panel::new(
            "phase space",
            Axis::linear("").within(-0.25, 1.75),
            Axis::linear("").within(-0.12, 1.42),
        )
    }
}

/// The phase space (tau, w_1 + w_2, w_1 - w_2), w = log10 psi, seen from three sides.
fn phase_space(rows: &RowList) -> [Panel; 3] {
    let sum = || combined(rows, ["state_1", "state_2"], |a, b| (a * b).log10());
    let apart = || combined(rows, ["state_1", "state_2"], |a, b| (a / b).log10());
    let panel = |title: &str, names: [&str; 2], x: Vec<f64>, y: Vec<f64>| Panel {
        series: vec![PlotSeries::new("", x, y)],
        ..Panel::new(title, Axis::linear(names[0]), Axis::linear(names[1]))
    };
    let (tau, stress) = ("stress τ [aσ]", || column(rows, "stress"));
    let (both, difference) = ("w₁ + w₂, w = log₁₀ ψ", "w₁ − w₂");
    [
        panel("from the front", [both, tau], sum(), stress()),
        panel("from the side", [difference, tau], apart(), stress()),
        panel("from above", [both, difference], sum(), apart()),
    ]
}

/// The return map, its diagonal thin.
fn return_map(map: &Map) -> Panel {
    let mut panel = views::return_map(&map.plan, &map.rows);
    for dots in panel.series.iter_mut().filter(|series| series.dots) {
        dots.wide = map.rows.iter().len() <= FEW;
    }
    if let Some(diagonal) = panel.series.last_mut() {
        *diagonal = diagonal.clone().stroke(Stroke::Dotted).colour(GREY);
    }
    panel
}
