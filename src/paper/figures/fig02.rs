//! Figure 2: whether the asymmetric steady states around an extremum of tau_ss branch off super- or subcritically, by the shape
//! of the law there: the sign of its third derivative.

use super::curve::{Curve, cells, even};
use crate::equilibrium::Pitchfork;
use crate::error::{Error, Result};
use crate::friction::{ExtremumKind, Law, Parameters, Spinodal, steady_slope, steady_stress};
use crate::output::Cell;
use crate::output::plot::{Axis, Block, Drawing, Mark, Panel, Series, Side, Stroke};
use crate::paper::{Made, Make, Pieces, Product, Sheet};

/// What it is.
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

/// A law about one of its extrema, as it is or turned about it.
struct Case {
    part: &'static str,
    law: Spinodal,
    fork: Pitchfork,
    turned: bool,
    /// Slip rates that are shown, and the largest z, in that of the extremum.
    range: (f64, f64),
    largest: f64,
}

/// The figure.
///
/// # Errors
/// None that these laws allow.
pub fn make(_: &Pieces<'_>) -> Result<Made> {
    use ExtremumKind::{Maximum, Minimum};
    let paper = Parameters::heslot_1994();
    let merged = Parameters {
        residual_strength: NEARLY_MERGED,
        ..paper
    };
    let case = |part, parameters: Parameters, kind, turned, range, largest| -> Result<Case> {
        let law = parameters.spinodal();
        let fork = Pitchfork::all(&law)
            .into_iter()
            .find(|fork| fork.kind == kind);
        Ok(Case {
            part,
            law,
            fork: fork.ok_or_else(|| Error::Input("the law has no such extremum".into()))?,
            turned,
            range,
            largest,
        })
    };
    let maxima = [
        case(
            "maximum-supercritical",
            paper,
            Maximum,
            false,
            (0.3, 2.5),
            1.0,
        )?,
        case("maximum-subcritical", paper, Minimum, true, (0.1, 1.7), 0.7)?,
    ];
    let minima = [
        case(
            "minimum-supercritical",
            merged,
            Minimum,
            false,
            (0.6, 1.4),
            0.3,
        )?,
        case(
            "minimum-subcritical",
            paper,
            Minimum,
            false,
            (0.3, 1.9),
            0.7,
        )?,
    ];
    let mut sheet = Sheet::new();
    let mut block = |title: &str, cases: [Case; 2]| -> Result<Block> {
        let mut columns = Vec::new();
        for case in cases {
            columns.push(vec![case.stress(&mut sheet), case.branches(&mut sheet)?]);
        }
        Ok(Block {
            title: title.into(),
            columns,
        })
    };
    let blocks = vec![
        block("(a) τ_ss has a maximum", maxima)?,
        block("(b) τ_ss has a minimum", minima)?,
    ];
    Ok(Made {
        sheet,
        drawing: Some(Drawing::blocks(blocks)),
        method: "(20) solved for V_H along z = (V_1 − V_2)/2 by bracketed Newton steps to the last digit; stability by the sign \
of (22); derivatives exact"
            .into(),
    })
}

impl Case {
    /// A slip rate of the law as it is drawn, from one of the law as it is.
    fn drawn(&self, v: f64) -> f64 {
        if self.turned {
            2.0 * self.fork.slip_rate - v
        } else {
            v
        }
    }

    /// The steady stress there.
    fn drawn_stress(&self, v: f64) -> f64 {
        let tau = steady_stress(&self.law, v);
        if self.turned {
            2.0 * steady_stress(&self.law, self.fork.slip_rate) - tau
        } else {
            tau
        }
    }

    fn is_maximum(&self) -> bool {
        (self.fork.kind == ExtremumKind::Maximum) != self.turned
    }

    fn stress(&self, sheet: &mut Sheet) -> Panel {
        let v_e = self.fork.slip_rate;
        let mut curve = Curve::default();
        // of the law as it is, and so that both ends are drawn as they are given
        let ends = [self.range.0 * v_e, self.range.1 * v_e].map(|v| self.drawn(v));
        let mut rates = even(ends[0], ends[1], POINTS);
        rates.push(v_e);
        rates.sort_by(|a, b| self.drawn(*a).total_cmp(&self.drawn(*b)));
        for v in rates {
            let strengthens = steady_slope(&self.law, v) > 0.0;
            curve.push(self.drawn(v), self.drawn_stress(v), strengthens);
        }
        let rows = (0..curve.x.len()).map(|i| [curve.x[i], curve.y[i]]);
        sheet.add(
            format!("{}-law", self.part),
            &["slip_rate", "stress"],
            cells(rows),
        );
        let (name, kind, side) = if self.is_maximum() {
            ("V_M", "maximum", Side::Above)
        } else {
            ("V_m", "minimum", Side::Below)
        };
        let (critical, sign) = if self.fork.third > 0.0 {
            ("supercritical", ">")
        } else {
            ("subcritical", "<")
        };
        let mut panel = Panel::new(
            format!("{kind}, {critical}: τ''' {sign} 0"),
            Axis::linear("slip rate V/V*"),
            Axis::linear("τ_ss/(aσ)"),
        );
        panel.series = curve.series(["strengthening", "weakening"], 0);
        let tau = steady_stress(&self.law, v_e);
        panel.marks.push(Mark::new(v_e, tau, name).side(side));
        panel
    }

    fn branches(&self, sheet: &mut Sheet) -> Result<Panel> {
        let v_e = self.fork.slip_rate;
        let [mut upper, mut lower] = [Curve::default(), Curve::default()];
        let (mut parabola, mut rows) = (Vec::new(), Vec::new());
        for i in 1..=POINTS {
            // Closer together next to the pitchfork, where V_H changes with the square of z.
            let z = self.largest * v_e * (i as f64 / POINTS as f64);
            let lambda = self.fork.branch(&self.law, z)?;
            let rates = [lambda + z, lambda - z];
            // (22), divided by two where z = 0
            let stable = rates
                .iter()
                .map(|&v| steady_slope(&self.law, v))
                .sum::<f64>()
                > 0.0;
            let driving = 2.0 * self.drawn(lambda);
            let [one, two] = rates.map(|v| self.drawn(v));
            if i == 1 {
                upper.push(2.0 * v_e, v_e, stable);
                lower.push(2.0 * v_e, v_e, stable);
            }
            upper.push(driving, one.max(two), stable);
            lower.push(driving, one.min(two), stable);
            rows.push(row(driving, [one.max(two), one.min(two)], stable));
            let near = self.drawn(self.fork.parabola(z));
            parabola.push([2.0 * near, near + z, near - z]);
        }
        let columns = ["driving", "slip_rate_1", "slip_rate_2", "stability"];
        sheet.add(format!("{}-asymmetric", self.part), &columns, rows);
        let both = self.symmetric(&lower, sheet);
        let near = parabola
            .iter()
            .map(|&[driving, one, two]| [driving, one, two]);
        sheet.add(
            format!("{}-parabola", self.part),
            &columns[..3],
            cells(near),
        );

        let mut panel = Panel::new(
            "",
            Axis::linear("driving velocity V_H/V*"),
            Axis::linear("V_1, V_2 (V*)"),
        );
        panel.series = both.series(["V_1 = V_2, stable", "unstable"], 0);
        panel
            .series
            .extend(upper.series(["V_1 ≠ V_2, stable", "V_1 ≠ V_2, unstable"], 1));
        panel.series.extend(lower.series(["", ""], 1));
        for (i, label) in [(1, "parabola (24)"), (2, "")] {
            let column = |i: usize| parabola.iter().map(|row| row[i]).collect();
            let line = Series::new(label, column(0), column(i));
            panel.series.push(line.stroke(Stroke::Dotted).colour(7));
        }
        let name = if self.is_maximum() { "2 V_M" } else { "2 V_m" };
        panel.marks.push(Mark::new(2.0 * v_e, v_e, name));
        Ok(panel)
    }

    /// V_1 = V_2 = V_H/2 as far again on the other side of the pitchfork.
    fn symmetric(&self, branch: &Curve, sheet: &mut Sheet) -> Curve {
        let v_e = self.fork.slip_rate;
        let last = branch.x[branch.x.len() - 1];
        let reach = (last - 2.0 * v_e).abs();
        let mut curve = Curve::default();
        let [before, after] = [2.0 * v_e - reach, 2.0 * v_e + reach];
        // The stretch up to the pitchfork is what the state was before.
        for (driving, at) in [(before, before), (2.0 * v_e, before), (after, after)] {
            let slope = steady_slope(&self.law, self.drawn(0.5 * at));
            curve.push(driving, 0.5 * driving, slope > 0.0);
        }
        let rows = (0..3).map(|i| row(curve.x[i], [curve.y[i]; 2], curve.stable[i]));
        let columns = ["driving", "slip_rate_1", "slip_rate_2", "stability"];
        sheet.add(format!("{}-symmetric", self.part), &columns, rows.collect());
        curve
    }
}

fn row(driving: f64, rates: [f64; 2], stable: bool) -> Vec<Cell> {
    let stability = if stable { "stable" } else { "unstable" };
    vec![
        driving.into(),
        rates[0].into(),
        rates[1].into(),
        stability.into(),
    ]
}
