//! Figure 2: whether the asymmetric steady states around an extremum of tau_ss branch off super- or subcritically, by the shape
//! of the law there: the sign of its third derivative.

use super::curve::{StabilityCurve, cells, even};
use crate::{Made, Make, Pieces, Product, Sheet};
use twinslip::equilibrium::Pitchfork;
use twinslip::error::{Error, Result};
use twinslip::friction::{ExtremumKind, Parameters, Spinodal, steady_slope, steady_stress};
use twinslip_output::Cell;
use twinslip_output::plot::{Axis, Block, Drawing, Mark, Panel, PlotSeries, Stroke};

/// The figure.
pub const FIGURE: Product = Product {
    id: "fig02",
    title: "The pitchfork of steady states and the shape of the law",
    caption: "In each case above the steady stress about an extremum, strengthening solid and weakening dashed, and below it the \
slip rates V_1 and V_2 of both interfaces as V_H varies (20): stable solid, unstable dashed, in stiff slabs. The branch leaves \
V_1 = V_2 at twice the slip rate of the extremum (23). Dotted: the parabola (24). At a maximum and at a minimum alike the \
pitchfork is supercritical where τ_ss''' > 0 and subcritical where τ_ss''' < 0.\n\nMaximum supercritical and minimum \
subcritical: the spinodal law (36) with the paper's parameters. Minimum supercritical: the same with c = 2.75, where both extrema \
are close to merging. A spinodal law has τ_ss'''(V_M) > 0 whatever its parameters; the maximum with a subcritical pitchfork is \
that of the law turned by half a turn about its minimum, τ*(V) = 2 τ_ss(V_m) − τ_ss(2 V_m − V).",
    alt: "Four pairs of panels. Where the third derivative of the stress is positive a stable pair of branches opens towards the \
side on which equal sliding is unstable; where it is negative an unstable pair opens towards the other side.",
    scenes: &[],
    make: Make::Figure(make),
};

/// c with which V_M and V_m nearly merge: they do at 2.90.
const NEARLY_MERGED: f64 = 2.75;
const POINTS: usize = 201;
/// Of branches.
const COLUMNS: [&str; 4] = ["driving", "slip_rate_1", "slip_rate_2", "stability"];

/// What is shown.
struct Given {
    part: &'static str,
    residual_strength: f64,
    kind: ExtremumKind,
    /// Whether the law is turned by half a turn about the extremum.
    turned: bool,
    /// Slip rates that are shown, and the largest z, in that of the extremum.
    range: (f64, f64),
    largest: f64,
}

/// Both maxima, then both minima.
const CASES: [Given; 4] = [
    Given {
        part: "maximum-supercritical",
        residual_strength: 1e-3,
        kind: ExtremumKind::Maximum,
        turned: false,
        range: (0.3, 2.5),
        largest: 1.0,
    },
    Given {
        part: "maximum-subcritical",
        residual_strength: 1e-3,
        kind: ExtremumKind::Minimum,
        turned: true,
        range: (0.1, 1.7),
        largest: 0.7,
    },
    Given {
        part: "minimum-supercritical",
        residual_strength: NEARLY_MERGED,
        kind: ExtremumKind::Minimum,
        turned: false,
        range: (0.45, 1.5),
        largest: 0.36,
    },
    Given {
        part: "minimum-subcritical",
        residual_strength: 1e-3,
        kind: ExtremumKind::Minimum,
        turned: false,
        range: (0.3, 1.9),
        largest: 0.9,
    },
];

/// A law about one of its extrema, as it is or turned about it.
struct Case {
    given: &'static Given,
    law: Spinodal,
    fork: Pitchfork,
}

/// [V_H, V_1, V_2] with V_1 > V_2, of an asymmetric state and of the parabola (24) at its z.
struct AsymmetricPoint {
    state: [f64; 3],
    near: [f64; 3],
    stable: bool,
}

fn make(_: &Pieces<'_>) -> Result<Made> {
    let mut sheet = Sheet::new();
    let mut block = |title: &str, cases: &'static [Given]| -> Result<Block> {
        let mut columns = Vec::new();
        for given in cases {
            let case = Case::new(given)?;
            columns.push(vec![case.stress(&mut sheet), case.branches(&mut sheet)?]);
        }
        Ok(Block {
            title: title.into(),
            columns,
        })
    };
    let blocks = vec![
        block("(a) maximum of τ_ss", &CASES[..2])?,
        block("(b) minimum of τ_ss", &CASES[2..])?,
    ];
    Ok(Made {
        sheet,
        drawing: Some(Drawing::blocks(blocks)),
        method: "(20) solved for V_H along z = (V₁ − V₂)/2 by bracketed Newton steps to the last digit; stability by the sign \
of (22); derivatives exact"
            .into(),
    })
}

impl Case {
    fn new(given: &'static Given) -> Result<Self> {
        let parameters = Parameters {
            residual_strength: given.residual_strength,
            ..Parameters::heslot_1994()
        };
        let law = parameters.spinodal();
        let mut forks = Pitchfork::all(&law).into_iter();
        let fork = forks.find(|fork| fork.kind == given.kind);
        let missing = || Error::Input("the law has no such extremum".into());
        Ok(Case {
            given,
            law,
            fork: fork.ok_or_else(missing)?,
        })
    }

    /// A slip rate of the law as it is drawn, from one of the law as it is.
    fn drawn(&self, v: f64) -> f64 {
        if self.given.turned {
            2.0 * self.fork.slip_rate - v
        } else {
            v
        }
    }

    /// The steady stress there.
    fn drawn_stress(&self, v: f64) -> f64 {
        let tau = steady_stress(&self.law, v);
        if self.given.turned {
            2.0 * steady_stress(&self.law, self.fork.slip_rate) - tau
        } else {
            tau
        }
    }

    /// What the extremum is called as it is drawn.
    fn name(&self) -> &'static str {
        if (self.fork.kind == ExtremumKind::Maximum) == self.given.turned {
            "V_m"
        } else {
            "V_M"
        }
    }

    fn stress(&self, sheet: &mut Sheet) -> Panel {
        let v_e = self.fork.slip_rate;
        let mut curve = StabilityCurve::default();
        // of the law as it is, and so that both ends are drawn as they are given
        let ends = [self.given.range.0 * v_e, self.given.range.1 * v_e].map(|v| self.drawn(v));
        let mut rates = even(ends[0], ends[1], POINTS);
        rates.push(v_e);
        rates.sort_by(|a, b| self.drawn(*a).total_cmp(&self.drawn(*b)));
        for v in rates {
            let strengthens = steady_slope(&self.law, v) > 0.0;
            curve.push(self.drawn(v), self.drawn_stress(v), strengthens);
        }
        let rows = (0..curve.x.len()).map(|i| [curve.x[i], curve.y[i]]);
        sheet.add(
            format!("{}-law", self.given.part),
            &["slip_rate", "stress"],
            cells(rows),
        );
        let (critical, sign) = if self.fork.third > 0.0 {
            ("supercritical", ">")
        } else {
            ("subcritical", "<")
        };
        let mut panel = Panel::new(
            format!("{critical}: τ_ss''' {sign} 0"),
            Axis::linear("slip rate V [V*]"),
            Axis::linear("stress τ_ss [aσ]"),
        );
        panel.series = curve.series(["strengthening", "weakening"], 0);
        let tau = steady_stress(&self.law, v_e);
        panel.marks.push(Mark::new(v_e, tau, self.name()));
        panel
    }

    /// Along z.
    fn asymmetric(&self) -> Result<Vec<AsymmetricPoint>> {
        let state = |lambda: f64, z: f64| {
            let [one, two] = [lambda + z, lambda - z].map(|v| self.drawn(v));
            [2.0 * self.drawn(lambda), one.max(two), one.min(two)]
        };
        let at = |i: usize| {
            let z = self.given.largest * self.fork.slip_rate * (i as f64 / POINTS as f64);
            let lambda = self.fork.branch(&self.law, z)?;
            // (22)
            let slopes = [lambda + z, lambda - z].map(|v| steady_slope(&self.law, v));
            Ok(AsymmetricPoint {
                state: state(lambda, z),
                near: state(self.fork.parabola(z), z),
                stable: slopes[0] + slopes[1] > 0.0,
            })
        };
        (1..=POINTS).map(at).collect()
    }

    fn branches(&self, sheet: &mut Sheet) -> Result<Panel> {
        let v_e = self.fork.slip_rate;
        let points = self.asymmetric()?;
        let rows = points.iter().map(|point| row(point.state, point.stable));
        sheet.add(
            format!("{}-asymmetric", self.given.part),
            &COLUMNS,
            rows.collect(),
        );
        let rows = cells(points.iter().map(|point| point.near));
        sheet.add(format!("{}-parabola", self.given.part), &COLUMNS[..3], rows);

        let mut panel = Panel::new(
            "",
            Axis::linear("driving velocity V_H [V*]"),
            Axis::linear("slip rates V₁, V₂ [V*]"),
        );
        let [mut upper, mut lower] = [StabilityCurve::default(), StabilityCurve::default()];
        for (rate, curve) in [(1, &mut upper), (2, &mut lower)] {
            // (24) below the branch that it approximates
            let near = |i: usize| points.iter().map(|point| point.near[i]).collect();
            let name = if rate == 1 { "parabola (24)" } else { "" };
            let line = PlotSeries::new(name, near(0), near(rate));
            panel.series.push(line.stroke(Stroke::Dotted).colour(7));
            curve.push(2.0 * v_e, v_e, points[0].stable);
            for point in &points {
                curve.push(point.state[0], point.state[rate], point.stable);
            }
        }
        let reach = (upper.x[POINTS] - 2.0 * v_e).abs();
        panel.x = panel.x.within(2.0 * v_e - reach, 2.0 * v_e + reach);
        let both = self.symmetric(reach, sheet);
        panel.series.extend(both.series(["V₁ = V₂", ""], 0));
        panel.series.extend(upper.series(["asymmetric"; 2], 1));
        panel.series.extend(lower.series([""; 2], 1));
        let name = format!("2 {}", self.name());
        panel.marks.push(Mark::new(2.0 * v_e, v_e, name));
        Ok(panel)
    }

    /// V_1 = V_2 = V_H/2 as far on both sides of the pitchfork.
    fn symmetric(&self, reach: f64, sheet: &mut Sheet) -> StabilityCurve {
        let v_e = self.fork.slip_rate;
        let mut curve = StabilityCurve::default();
        let [before, after] = [2.0 * v_e - reach, 2.0 * v_e + reach];
        // The stretch up to the pitchfork is what the state was before.
        for (driving, at) in [(before, before), (2.0 * v_e, before), (after, after)] {
            let slope = steady_slope(&self.law, self.drawn(0.5 * at));
            curve.push(driving, 0.5 * driving, slope > 0.0);
        }
        let rows = (0..3).map(|i| row([curve.x[i], curve.y[i], curve.y[i]], curve.stable[i]));
        sheet.add(
            format!("{}-symmetric", self.given.part),
            &COLUMNS,
            rows.collect(),
        );
        curve
    }
}

fn row(state: [f64; 3], stable: bool) -> Vec<Cell> {
    let stability = if stable { "stable" } else { "unstable" };
    let mut row: Vec<Cell> = state.map(Cell::Number).to_vec();
    row.push(stability.into());
    row
}
