//! Beside Fig. 5: the steady states of interfaces that differ in their residual strength, with unfolded pitchforks.

use super::fig05;
use super::plane::{keys, mark};
use crate::product::{Made, Make, Product};
use crate::sheet::Sheet;
use crate::{Branches, GeneralCurves, Pieces};
use twinslip::bifurcation::BranchRow;
use twinslip::error::Result;
use twinslip_output::plot::{Axis, Block, Drawing, Panel, PlotSeries, Stroke};
use twinslip_tasks::scene::{GeneralRow, Subject};
use twinslip_tasks::views::{general_lines, named_strokes};

/// The figure.
pub const FIGURE: Product = Product {
    id: "fig05-unfolded",
    title: "Steady states at K = 0.45 of interfaces that differ",
    caption: "The steady states of Fig. 5 where the second interface is a little stronger: c_2 = 0.0012 and c_1 = 0.001 (stable solid, unstable dashed; dotted grey those of equal interfaces). No pitchfork is left. Each has parted into a branch that passes by and one that turns back in a fold.

On the blue branch the first interface slides fast between 2 V_M and V_sn: it passes by the first pitchfork, turns in the fold at 4.298e4 V*, where the second one, which creeps, fails, and again in a fold near 2 V_m. On the vermillion branch the second interface is the fast one: it has a fold near 2 V_M, at 0.0499 V*, and one at 3.321e4 V*. So V_sn is two folds.

(a) The stress. (b) The slip rate of the first interface near 2 V_M, where all that unfolds is within 0.1 % of V_H. (c) The stress near 2 V_m, where it unfolds widely. (d, e) The slip rates of both interfaces.",
    alt: "Five panels of steady states against driving velocity: stress, slip rate and stress enlarged near the pitchforks of equal interfaces, and the slip rate of each interface. There are two branches that do not meet, each with two folds, beside the dotted branches of equal interfaces that meet in pitchforks.",
    scenes: &["fig05-unfolded", "fig05"],
    make: Make::Figure(make),
};

/// The frame about what was the first pitchfork, V_H and V_1; that of the other is as in Fig. 5.
const FIRST: [(f64, f64); 2] = [(0.0497, 0.0501), (0.0235, 0.0265)];

fn make(pieces: &Pieces<'_>) -> Result<Made> {
    let (unfolded, equal) = (pieces.general("fig05-unfolded")?, pieces.branches("fig05")?);
    let mut sheet = Sheet::new();
    sheet.add_general("steady states", &unfolded);
    let stress = |title: &str| {
        let y = Axis::linear("stress τ [aσ]");
        panel(
            &unfolded,
            &equal,
            title,
            y,
            ("stress", &[&|row| row.stress]),
        )
    };
    let rate = |title: &str, y: Axis, name: &str| {
        let both: [Of<'_>; 2] = [&|row| row.slip_rate[0], &|row| row.slip_rate[1]];
        panel(&unfolded, &equal, title, y, (name, &both))
    };
    let mut all = stress("(a) stress, K = 0.45, c₂ = 1.2 c₁");
    let labels = unfolded.special.iter().filter_map(|one| one.label);
    all.keys = keys(labels);
    all.strokes = named_strokes(&all.series[1..]);
    all.series[0].label = "c₂ = c₁".into();
    // In the legend alone: the curves have a series for each stroke.
    for (colour, name) in ["first fast", "second fast"].into_iter().enumerate() {
        let curve = PlotSeries::new(name, Vec::new(), Vec::new());
        all.series.push(curve.colour(colour));
    }
    let near = |panel: Panel, [x, y]: [(f64, f64); 2]| {
        let mut panel = panel;
        panel.x = panel.x.within(x.0, x.1);
        panel.y = panel.y.within(y.0, y.1);
        panel.marks.retain(|mark| (x.0..=x.1).contains(&mark.x));
        panel
    };
    let first = |title: &str, y: Axis| rate(title, y, "slip_rate_1");
    let mut passing = first(
        "(b) first interface near 2 V_M",
        Axis::linear("slip rate V₁ [V*]"),
    );
    passing.x.log = false;
    let block = |columns| Block {
        title: String::new(),
        columns,
    };
    Ok(Made {
        sheet,
        drawing: Some(Drawing::blocks(vec![
            block(vec![vec![all]]),
            block(vec![
                vec![near(passing, FIRST)],
                vec![near(stress("(c) stress near 2 V_m"), fig05::SECOND)],
            ]),
            block(vec![
                vec![first("(d) first interface", Axis::log("slip rate V₁ [V*]"))],
                vec![rate(
                    "(e) second interface",
                    Axis::log("slip rate V₂ [V*]"),
                    "slip_rate_2",
                )],
            ]),
        ])),
        method: "Steady states from certain brackets at both ends of the range, followed by pseudo-arclength with exact derivatives; folds to 1e-11".into(),
    })
}

type Of<'a> = &'a dyn Fn(&BranchRow) -> f64;

/// A number of the branches, by its name in rows, above the same of equal interfaces.
fn panel(
    unfolded: &GeneralCurves,
    equal: &Branches,
    title: &str,
    y: Axis,
    (name, of_equal): (&str, &[Of<'_>]),
) -> Panel {
    let numbers = unfolded.subject.numbers(unfolded.kind);
    let place = numbers.iter().position(|(known, _)| known == name);
    let x = |row: &GeneralRow| row.parameters[0].value;
    let of = |row: &GeneralRow| place.map_or(f64::NAN, |place| row.numbers[place]);
    let mut panel = Panel::new(title, Axis::log("driving velocity V_H [V*]"), y);
    for of in of_equal {
        let (mut xs, mut ys) = (Vec::new(), Vec::new());
        for branch in equal.rows.chunk_by(|a, b| a.branch == b.branch) {
            xs.extend(branch.iter().map(|row| row.driving).chain([f64::NAN]));
            ys.extend(branch.iter().map(of).chain([f64::NAN]));
        }
        let thin = PlotSeries::new("", xs, ys).stroke(Stroke::Dotted);
        panel.series.push(thin.colour(6));
    }
    panel.series.extend(general_lines(&unfolded.rows, &x, &of));
    let special = unfolded.rows.iter();
    let marks = special.filter_map(|row| mark(row.label?, x(row), of(row)));
    panel.marks.extend(marks);
    panel
}
