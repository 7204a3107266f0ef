//! Figure 15: the bifurcation curves of the approximating system (39)-(40) in the (mu_1, mu_2) plane, and its steady states and
//! cycles along two paths across them. Everything is of the full system at finite mu.

use super::curve::{StabilityCurve, cells, even, geometric};
use crate::{Made, Make, Pieces, Product, Sheet};
use twinslip::bifurcation::strong_resonance::{Around, Homoclinic, ResonanceCycle};
use twinslip::error::Result;
use twinslip::model::normal_form::StrongResonance;
use twinslip_output::Cell;
use twinslip_output::plot::{Axis, Block, Drawing, Mark, Note, Panel, PlotSeries, Stroke, Symbol};

/// The figure.
pub const FIGURE: Product = Product {
    id: "fig15",
    title: "Bifurcations of the approximating system near the 1:2 resonance",
    caption: "(a) Curves of the system (39)-(40): TR, torus bifurcation of the orbit; PD, its period doubling; TR2, torus \
bifurcation of the doubled orbit; global, a pair of homoclinic orbits of the origin, where tori of the doubled orbit become one; \
sn, where a stable and an unstable torus merge. Stable are: in region 1 the orbit, in 2 and 3 a torus, in 4 and 5 a torus and the \
doubled orbit, in 6 the doubled orbit. Between them are unstable tori: around each point of the doubled orbit in 4, around both \
in 5. Enlarged, the same for μ_2 < 0 with μ_1 over |μ_2|; dotted are the limits −4/5 and −0.75226 of global and sn at the \
resonance.\n\n(b) Steady states and the largest v of cycles along the paths l_1 and l_2, stable solid and unstable dashed. The \
mirror images at −v are not drawn.",
    alt: "Left the plane of both parameters with curves that meet at the origin. Right two bifurcation diagrams: along the first \
path a stable cycle grows from the origin; along the second unstable cycles grow from the states beside the origin, become one \
at the homoclinic orbits, and merge with the large stable cycle at a fold.",
    scenes: &[],
    make: Make::Figure(make),
};

/// Both parameters reach from minus this to this.
const REACH: f64 = 0.8;
/// mu_2 along the paths.
const L_1: f64 = 0.4;
const L_2: f64 = -0.5;
/// mu_1 along them.
const ALONG_1: (f64, f64) = (-0.3, 0.15);
const ALONG_2: (f64, f64) = (-0.58, -0.32);

/// Colours as in the other figures: of tori and of what period doubling leads to; and of tori of the doubled orbit.
const TORUS: usize = 2;
const DOUBLING: usize = 3;
const SECOND_TORUS: usize = 0;

const NAMES: [(&str, usize, Stroke); 5] = [
    ("TR", TORUS, Stroke::Solid),
    ("PD", DOUBLING, Stroke::Dotted),
    ("TR2", SECOND_TORUS, Stroke::Solid),
    ("global", 1, Stroke::DashDot),
    ("sn", 7, Stroke::DashDotDot),
];

fn make(_: &Pieces<'_>) -> Result<Made> {
    let mut sheet = Sheet::new();
    let curves = curves()?;
    for ((name, _, _), points) in NAMES.iter().zip(&curves) {
        sheet.add(*name, &["mu_1", "mu_2"], cells(points.iter().copied()));
    }
    let block = |left, right| Block {
        title: String::new(),
        columns: vec![vec![left], vec![right]],
    };
    let planes = block(plane(&curves), enlarged(&curves));
    let paths = block(first_path(&mut sheet)?, second_path(&mut sheet)?);
    Ok(Made {
        sheet,
        drawing: Some(Drawing::blocks(vec![planes, paths])),
        method: "global: the manifolds of the origin, from series of order 19, meet on w = 0. sn and all cycles: the return map \
of w = 0 by a Taylor integrator at a relative tolerance of 1e-15 in each step, zeros by bracketed secants; stability by the \
integral of the divergence. TR, PD, TR2 in closed form"
            .into(),
    })
}

/// The curves as points (mu_1, mu_2), in the order of their names.
fn curves() -> Result<[Vec<[f64; 2]>; 5]> {
    const POINTS: usize = 33;
    let below = even(0.0, -REACH, POINTS);
    // at the resonance itself there is nothing but the origin
    let mut global = vec![[0.0; 2]];
    let mut fold = vec![[0.0; 2]];
    for &mu2 in &below[1..] {
        global.push(Homoclinic::at(mu2)?.mu);
        fold.push(ResonanceCycle::fold(mu2)?.mu);
    }
    let line = |point: fn(f64) -> [f64; 2], from: f64, to: f64| [from, to].map(point).to_vec();
    Ok([
        line(|mu2| [StrongResonance::torus(mu2), mu2], 0.0, REACH),
        line(
            |mu1| [mu1, StrongResonance::period_doubling(mu1)],
            -REACH,
            REACH,
        ),
        line(|mu2| [StrongResonance::second_torus(mu2), mu2], 0.0, -REACH),
        global,
        fold,
    ])
}

fn plane(curves: &[Vec<[f64; 2]>; 5]) -> Panel {
    let mut panel = Panel::new(
        "(a)",
        Axis::linear("μ₁").within(-REACH, REACH),
        Axis::linear("μ₂").within(-REACH, REACH),
    );
    for ((name, colour, stroke), points) in NAMES.into_iter().zip(curves) {
        let column = |i: usize| points.iter().map(|point| point[i]).collect();
        let line = PlotSeries::new(name, column(0), column(1));
        panel.series.push(line.stroke(stroke).colour(colour));
    }
    for (mu2, (from, to)) in [(L_1, ALONG_1), (L_2, ALONG_2)] {
        let path = PlotSeries::new("", vec![from, to], vec![mu2; 2]);
        panel.series.push(path.stroke(Stroke::Dotted).colour(7));
    }
    panel.marks.push(Mark::new(0.0, 0.0, "1:2"));
    // Region 5 is narrower than its name.
    let five = Mark::new(-0.525, -0.67, "5").symbol(Symbol::Dot);
    panel.marks.push(five.colour(7));
    panel.notes = vec![
        Note::new(0.5, 0.55, "1: orbit"),
        Note::new(-0.45, 0.55, "2: torus"),
        Note::new(-0.6, -0.25, "3: torus"),
        Note::new(-0.64, -0.72, "4"),
        Note::new(0.2, -0.4, "6: doubled orbit"),
        Note::new(ALONG_1.1 + 0.05, L_1, "l₁"),
        Note::new(ALONG_2.1 + 0.05, L_2, "l₂"),
    ];
    panel
}

/// mu_1 over |mu_2|: what starts at the resonance with different slopes stands apart.
fn enlarged(curves: &[Vec<[f64; 2]>; 5]) -> Panel {
    let range = (-1.06, -0.66);
    let mut panel = Panel::new(
        "(a) enlarged",
        Axis::linear("μ₁/|μ₂|").within(range.0, range.1),
        Axis::linear("μ₂").within(-REACH, 0.0),
    );
    for ((name, colour, stroke), points) in NAMES.into_iter().zip(curves).skip(2) {
        let points = points.iter().filter(|[_, mu2]| *mu2 < 0.0);
        let (mut x, mut y): (Vec<f64>, Vec<f64>) =
            points.map(|[mu1, mu2]| (mu1 / mu2.abs(), *mu2)).unzip();
        if name == "TR2" {
            (x, y) = (vec![x[0]; 2], vec![0.0, -REACH]);
        }
        panel
            .series
            .push(PlotSeries::new(name, x, y).stroke(stroke).colour(colour));
    }
    for limit in [
        StrongResonance::homoclinic(-1.0),
        StrongResonance::fold_of_cycles(-1.0),
    ] {
        let line = PlotSeries::new("", vec![limit; 2], vec![0.0, -REACH]);
        panel.series.push(line.stroke(Stroke::Dotted).colour(6));
    }
    let path = PlotSeries::new("", vec![range.0, range.1], vec![L_2; 2]);
    panel.series.push(path.stroke(Stroke::Dotted).colour(7));
    panel.notes = vec![
        Note::new(-1.03, -0.2, "3"),
        Note::new(-0.9, -0.2, "4"),
        Note::new(-0.777, -0.2, "5"),
        Note::new(-0.71, -0.2, "6"),
        Note::new(-0.68, L_2 + 0.07, "l₂"),
        Note::new(-0.84, -0.7, "−4/5"),
        Note::new(-0.705, -0.7, "−0.752"),
    ];
    panel
}

/// Cycles of these amplitudes, as a curve over mu_1.
fn cycles(
    around: Around,
    mu2: f64,
    amplitudes: &[f64],
    part: &str,
    sheet: &mut Sheet,
) -> Result<StabilityCurve> {
    let (mut curve, mut rows) = (StabilityCurve::default(), Vec::new());
    for &amplitude in amplitudes {
        let cycle = ResonanceCycle::of(around, mu2, amplitude)?;
        let stable = cycle.log_multiplier < 0.0;
        curve.push(cycle.mu[0], amplitude, stable);
        let mut row: Vec<Cell> = [cycle.mu[0], mu2, amplitude].map(Cell::Number).to_vec();
        row.push(stability(stable));
        row.extend([cycle.period, cycle.log_multiplier].map(Cell::Number));
        rows.push(row);
    }
    let columns = [
        "mu_1",
        "mu_2",
        "v",
        "stability",
        "period",
        "ln_abs_multiplier",
    ];
    sheet.add(part, &columns, rows);
    Ok(curve)
}

fn stability(stable: bool) -> Cell {
    (if stable { "stable" } else { "unstable" }).into()
}

/// A steady state along a path, which at mu_1 = `change` becomes stable or never does.
fn steady(
    mu2: f64,
    v: f64,
    (from, to): (f64, f64),
    change: Option<f64>,
    part: &str,
    sheet: &mut Sheet,
) -> StabilityCurve {
    let mut curve = StabilityCurve::default();
    curve.push(from, v, false);
    if let Some(mu1) = change {
        curve.push(mu1, v, false);
    }
    curve.push(to, v, change.is_some());
    let row = |i: usize| {
        let mut row: Vec<Cell> = [curve.x[i], mu2, v].map(Cell::Number).to_vec();
        row.push(stability(curve.stable[i]));
        row
    };
    let rows = (0..curve.x.len()).map(row).collect();
    sheet.add(part, &["mu_1", "mu_2", "v", "stability"], rows);
    curve
}

fn path_panel(name: &str, mu2: f64, along: (f64, f64), top: f64) -> Panel {
    let title = format!("(b) along {name}: μ₂ = {mu2}").replace('-', "−");
    Panel::new(
        title,
        Axis::linear("μ₁").within(along.0, along.1),
        Axis::linear("v, steady or largest").within(-0.06 * top, top),
    )
}

/// l1: the origin loses its stability to a cycle.
fn first_path(sheet: &mut Sheet) -> Result<Panel> {
    let mut panel = path_panel("l₁", L_1, ALONG_1, 1.2);
    let torus = StrongResonance::torus(L_1);
    let origin = steady(L_1, 0.0, ALONG_1, Some(torus), "l1-origin", sheet);
    // A = 2 sqrt(-mu_1) to leading order, and less than that
    let most = 2.0 * (-ALONG_1.0).sqrt();
    let mut amplitudes = even(0.0, most, 49);
    amplitudes[0] = 1e-3;
    let mut tori = cycles(Around::Origin, L_1, &amplitudes, "l1-cycles", sheet)?;
    (tori.x[0], tori.y[0]) = (torus, 0.0);
    panel.series = origin.series(["orbit", ""], 7);
    panel.series.extend(tori.series(["torus", ""], TORUS));
    panel.marks.push(Mark::new(torus, 0.0, "TR"));
    Ok(panel)
}

/// l2: the states beside the origin lose theirs; cycles around one and around all three meet at the homoclinic orbits.
fn second_path(sheet: &mut Sheet) -> Result<Panel> {
    const POINTS: usize = 41;
    let mut panel = path_panel("l₂", L_2, ALONG_2, 1.5);
    let beside = StrongResonance::steady(L_2).unwrap_or(0.0);
    let second = StrongResonance::second_torus(L_2);
    let global = Homoclinic::at(L_2)?;
    let fold = ResonanceCycle::fold(L_2)?;
    let origin = steady(L_2, 0.0, ALONG_2, None, "l2-origin", sheet);
    let doubled = steady(L_2, beside, ALONG_2, Some(second), "l2-beside", sheet);

    // Towards the homoclinic orbits mu_1 changes with the logarithm of the distance.
    let gap = global.amplitude - beside;
    let mut inner: Vec<f64> = even(0.0, 0.9, POINTS)
        .iter()
        .map(|x| beside + gap * x)
        .collect();
    inner[0] = beside + 1e-3 * gap;
    inner.extend(
        geometric(0.09, 1e-6, POINTS)
            .iter()
            .map(|x| global.amplitude - gap * x),
    );
    let mut small = cycles(Around::Beside, L_2, &inner, "l2-cycles-beside", sheet)?;
    (small.x[0], small.y[0]) = (second, beside);
    small.push(global.mu[0], global.amplitude, false);

    let mut outer: Vec<f64> = geometric(1e-6, 0.7, 2 * POINTS)
        .iter()
        .map(|x| global.amplitude + gap * x)
        .collect();
    outer.extend(even(global.amplitude + 0.75 * gap, 1.65, POINTS));
    outer.push(fold.amplitude);
    outer.sort_by(f64::total_cmp);
    let mut large = cycles(Around::Origin, L_2, &outer, "l2-cycles", sheet)?;
    (large.x[0], large.y[0]) = (global.mu[0], global.amplitude);

    panel.series = origin.series(["", "orbit"], 7);
    panel
        .series
        .extend(doubled.series(["doubled orbit", ""], DOUBLING));
    panel
        .series
        .extend(small.series(["", "tori of the doubled orbit"], SECOND_TORUS));
    panel.series.extend(large.series(["torus", ""], TORUS));
    for (x, y, name) in [
        (second, beside, "TR2"),
        (global.mu[0], global.amplitude, "global"),
        (fold.mu[0], fold.amplitude, "sn"),
    ] {
        panel.marks.push(Mark::new(x, y, name));
    }
    let special = [
        [second, L_2, beside],
        [global.mu[0], L_2, global.amplitude],
        [fold.mu[0], L_2, fold.amplitude],
    ];
    sheet.add("l2-special", &["mu_1", "mu_2", "v"], cells(special));
    Ok(panel)
}
