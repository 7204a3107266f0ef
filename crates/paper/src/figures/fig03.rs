//! Fig. 3: the Dieterich-Ruina law localises slip on the weaker interface, which oscillates where K < K_c.

use super::runs::{column, combined, in_time, method, title as title_of};
use crate::product::{Made, Make, Product};
use crate::sheet::Sheet;
use crate::{Pieces, Run};
use twinslip::error::Result;
use twinslip::friction::steady_stress;
use twinslip_output::plot::{Axis, Block, Drawing, Key, Mark, Panel, PlotSeries, Symbol};

/// The figure.
pub const FIGURE: Product = Product {
    id: "fig03",
    title: "Slip localises on the weaker of two Dieterich-Ruina interfaces",
    caption: "Two interfaces that obey the Dieterich-Ruina law, driven at V_H = V*. From beside the symmetric steady state (open square, with the dot of the start in it), where both share the driving velocity, the interface that begins with the smaller state takes over; the other one all but stops and heals without end.

(a) Stiffer than the single interface needs (K = 0.45): slip settles on steady sliding of one interface (star). (b) A little softer than K_c = (b - a)/a = 0.401 (K = 0.395): the interface that slides alone starts to oscillate, with slowly growing amplitude. The stars lie at (±1, 10.573); the 10.7 of the printed caption is not the steady stress of this law.",
    alt: "Two rows of panels: stress against the difference of the slip rates, and stress, states and slip rates in time. In both rows one interface takes over the whole slip; in the lower row stress and slip rate then oscillate with growing amplitude.",
    scenes: &["fig03a", "fig03b"],
    make: Make::Figure(make),
};

fn make(pieces: &Pieces<'_>) -> Result<Made> {
    let (a, b) = (pieces.run("fig03a")?, pieces.run("fig03b")?);
    let mut sheet = Sheet::new();
    sheet.add_run("a", &a);
    sheet.add_run("b", &b);
    Ok(Made {
        sheet,
        drawing: Some(Drawing::blocks(vec![
            block("(a) localisation: ", &a),
            block("(b) localisation, then oscillation: ", &b),
        ])),
        method: format!("(a) {}; (b) {}", method(&a), method(&b)),
    })
}

fn block(title: &str, run: &Run) -> Block {
    let mut left = vec![differences(run)];
    let mut right = in_time(run, &run.rows);
    // Stress against the difference of the slip rates has stress in time beside it.
    left.extend(right.pop());
    Block {
        title: title_of(title, run),
        columns: vec![left, right],
    }
}

/// Stress against the difference of the slip rates, with the steady states of both interfaces and of one alone.
fn differences(run: &Run) -> Panel {
    let rows = &run.rows;
    let apart = combined(rows, ["slip_rate_1", "slip_rate_2"], |a, b| a - b);
    let stress = column(rows, "stress");
    let (law, driving) = (run.law(), run.loading().driving);
    let alone = steady_stress(&law, driving);
    let mut marks = vec![
        Mark::new(0.0, steady_stress(&law, 0.5 * driving), "")
            .symbol(Symbol::Square)
            .open(),
        Mark::new(driving, alone, "").symbol(Symbol::Star).behind(),
        Mark::new(-driving, alone, "").symbol(Symbol::Star).behind(),
    ];
    if let (Some(&x), Some(&y)) = (apart.first(), stress.first()) {
        marks.push(Mark::new(x, y, "").symbol(Symbol::Dot).colour(1));
    }
    let key = |symbol, filled, colour, label: &str| Key {
        symbol,
        filled,
        colour,
        label: label.into(),
    };
    Panel {
        series: vec![PlotSeries::new("", apart, stress).colour(0)],
        marks,
        keys: vec![
            key(Symbol::Dot, true, Some(1), "start"),
            key(Symbol::Square, false, None, "both slide"),
            key(Symbol::Star, true, None, "one alone"),
        ],
        ..Panel::new(
            "",
            Axis::linear("v₁ − v₂ [V*]"),
            Axis::linear("stress τ [aσ]"),
        )
    }
}
