//! Figure 17: the roots of the cubic (30) as intersections of Q_3 and L of appendix A, for an asymmetric steady state of the
//! spinodal law; and what the construction does not show, the roots that are complex.

use super::curve::{cells, even, geometric};
use crate::{Made, Make, Pieces, Product, Sheet};
use twinslip::bifurcation::equilibria::{CharacteristicCubic, Tangency};
use twinslip::equilibrium::{Equilibrium, Solver, Symmetry, stability, steady_states};
use twinslip::error::{Error, Result};
use twinslip::friction::AnyLaw;
use twinslip_output::plot::{Axis, Drawing, Mark, Panel, PlotSeries, Stroke};

/// The figure.
pub const FIGURE: Product = Product {
    id: "fig17",
    title: "Roots of the cubic of an asymmetric steady state",
    caption: "The asymmetric steady state at V_H = 0.06 V*, where s_1 = 0.00835 and s_2 = −0.00428: their sum is positive, against \
the paper's assumption.\n\n(a) The real roots of (30) are where Q_3(s) meets the line L(s), thin. Solid: at K = 0.00691, where Q_3 \
touches L. Dashed: at half of that, where two roots are real and positive. Dash-dotted: at K = k_c* = 0.1179 (34), where the \
other two roots are imaginary and nothing is to be seen of them.\n\n(b) The three roots as K grows: real parts solid, the \
imaginary part dashed. Two positive roots become a complex pair at the first tangency, cross the imaginary axis at k_c*, and \
become real and negative at the second tangency.",
    alt: "Left a line and three cubics, which meet it three times, touch it, or meet it once. Right the roots over stiffness: \
two positive ones merge, their common real part falls through zero at the critical stiffness, and they part again.",
    scenes: &[],
    make: Make::Figure(make),
};

/// V_H in V*: between 2 V_M and 1, so that s_1 and s_2 are of one size.
const DRIVING: f64 = 0.06;
/// Of growth rates, and of Q_3 and L, in the picture.
const THOUSANDTHS: f64 = 1e3;
const MILLIONTHS: f64 = 1e6;
/// s in the picture of the cubic.
const SHOWN: (f64, f64) = (-9e-3, 1.15e-2);

/// The state with all that is marked.
struct Setting {
    law: AnyLaw,
    state: Equilibrium,
    cubic: CharacteristicCubic,
    tangencies: [Tangency; 2],
    /// k_c* and omega there.
    critical: (f64, f64),
}

fn make(pieces: &Pieces<'_>) -> Result<Made> {
    let setting = Setting::new(pieces.law())?;
    let mut sheet = Sheet::new();
    setting.points(&mut sheet);
    let left = setting.intersections(&mut sheet);
    let roots = setting.roots()?;
    let columns = [
        "stiffness",
        "growth_rate_1",
        "growth_rate_2",
        "growth_rate_3",
        "frequency",
    ];
    sheet.add("roots", &columns, cells(roots.iter().copied()));
    let first = setting.panel(&roots, (1e-3, 0.4), (-8.0, 30.0), "(b) roots as K grows");
    let second = setting.panel(
        &roots,
        (0.1, 10.0),
        (-250.0, 100.0),
        "(c) up to the second tangency",
    );
    Ok(Made {
        sheet,
        drawing: Some(Drawing::columns(vec![vec![left], vec![first, second]])),
        method: "coefficients of (30) by exact derivatives of the law; tangencies where K as a function of a real root has an \
extremum, real roots of polynomials by Descartes' rule; k_c* by (34); eigenvalues by a matrix algorithm, refined on (30)"
            .into(),
    })
}

impl Setting {
    fn new(law: AnyLaw) -> Result<Self> {
        let missing = || Error::Input("there is no such steady state".into());
        let states = steady_states(&law, DRIVING, 2, Solver::Newton)?.equilibria;
        let mut asymmetric = states
            .into_iter()
            .filter(|state| state.symmetry == Symmetry::Asymmetric);
        let state = asymmetric.next().ok_or_else(missing)?;
        // the paper's V_1 is the one on the weakening part: the faster one
        let cubic = CharacteristicCubic::new(&law, [state.slip_rate[1], state.slip_rate[0]]);
        let tangencies = <[Tangency; 2]>::try_from(cubic.tangencies()).map_err(|_| missing())?;
        let critical = cubic.critical_stiffness().ok_or_else(missing)?;
        Ok(Setting {
            law,
            state,
            cubic,
            tangencies,
            critical,
        })
    }

    /// What is marked.
    fn points(&self, sheet: &mut Sheet) {
        let (k, omega) = self.critical;
        let [s_1, s_2] = self.cubic.rates();
        let at = |t: Tangency| [[t.stiffness, t.growth_rate, 0.0]];
        let columns = ["stiffness", "growth_rate", "frequency"];
        sheet.add("first-tangency", &columns, cells(at(self.tangencies[0])));
        sheet.add("second-tangency", &columns, cells(at(self.tangencies[1])));
        sheet.add("critical", &columns, cells([[k, 0.0, omega]]));
        let columns = ["driving", "slip_rate_1", "slip_rate_2", "s_1", "s_2", "a_3"];
        let [slow, fast] = [self.state.slip_rate[0], self.state.slip_rate[1]];
        let row = [DRIVING, fast, slow, s_1, s_2, self.cubic.compliance()];
        sheet.add("state", &columns, cells([row]));
    }

    fn intersections(&self, sheet: &mut Sheet) -> Panel {
        let line = [SHOWN.0, SHOWN.1].map(|s| self.cubic.line(s) * MILLIONTHS);
        let height = line[1] - line[0];
        let ends = [SHOWN.0 * THOUSANDTHS, SHOWN.1 * THOUSANDTHS];
        let mut panel = Panel::new(
            "(a) Q₃(s) and L(s), V_H = 0.06",
            Axis::linear("s [10⁻³ V*/L]").within(ends[0], ends[1]),
            Axis::linear("Q₃, L [10⁻⁶]").within(line[0] - 0.05 * height, line[1] + 0.1 * height),
        );
        panel.zero_line = true;
        let touching = self.tangencies[0];
        let k = touching.stiffness;
        // The double root as the tangency has it: rounding takes it away, or makes two of it.
        let mut roots = self.cubic.real_roots(k);
        roots.retain(|&s| s < 0.0);
        roots.push(touching.growth_rate);
        let tangent = ("Q₃ tangent to L", Stroke::Solid, 0);
        self.curve(k, &roots, tangent, &mut panel, sheet);
        let smaller = ("Q₃, smaller K", Stroke::Dashed, 1);
        let roots = self.cubic.real_roots(0.5 * k);
        self.curve(0.5 * k, &roots, smaller, &mut panel, sheet);
        let critical = ("Q₃, K = k_c*", Stroke::DashDot, 2);
        let roots = self.cubic.real_roots(self.critical.0);
        self.curve(self.critical.0, &roots, critical, &mut panel, sheet);
        let line = PlotSeries::new("L", ends.to_vec(), line.to_vec());
        panel.series.push(line.colour(7));
        panel
    }

    /// Q_3 at one K, with its real roots marked.
    fn curve(
        &self,
        k: f64,
        roots: &[f64],
        (label, stroke, colour): (&str, Stroke, usize),
        panel: &mut Panel,
        sheet: &mut Sheet,
    ) {
        const POINTS: usize = 401;
        let cubic = &self.cubic;
        let grid = even(SHOWN.0, SHOWN.1, POINTS);
        let rows = grid.iter().map(|&s| [k, s, cubic.q_3(k, s), cubic.line(s)]);
        sheet.add("cubic", &["stiffness", "s", "q_3", "line"], cells(rows));
        let rows = cells(roots.iter().map(|&s| [k, s]));
        sheet.add("real-roots", &["stiffness", "s"], rows);
        let x = grid.iter().map(|s| s * THOUSANDTHS).collect();
        let y = grid.iter().map(|&s| cubic.q_3(k, s) * MILLIONTHS).collect();
        let line = PlotSeries::new(label, x, y).stroke(stroke).colour(colour);
        panel.series.push(line.wide());
        panel.marks.extend(roots.iter().map(|&s| {
            let (x, y) = (s * THOUSANDTHS, cubic.line(s) * MILLIONTHS);
            Mark::new(x, y, "").colour(colour)
        }));
    }

    /// [K, the pair's real roots or twice its real part, the third root, the imaginary part where there is one].
    fn roots(&self) -> Result<Vec<[f64; 5]>> {
        const POINTS: usize = 301;
        let [first, second] = self.tangencies.map(|t| t.stiffness);
        let mut grid = geometric(1e-3, 10.0, POINTS);
        // the pair parts with a square root
        for k in [first, second] {
            grid.extend(
                geometric(1e-8, 1e-2, 25)
                    .iter()
                    .flat_map(|x| [k * (1.0 - x), k * (1.0 + x)]),
            );
        }
        grid.push(self.critical.0);
        grid.sort_by(f64::total_cmp);
        let mut rows = Vec::new();
        for k in grid {
            let found = stability(&self.law, &self.state, k)?.eigenvalues;
            let re = |i: usize| found[i].re;
            rows.push(if k < first {
                [k, re(0), re(1), re(2), f64::NAN]
            } else if k > second {
                [k, re(1), re(2), re(0), f64::NAN]
            } else {
                let pair = found.iter().position(|s| s.im > 0.0).unwrap_or(0);
                let third = if pair == 0 { 2 } else { 0 };
                [k, re(pair), re(pair), re(third), found[pair].im]
            });
        }
        rows.extend(self.tangencies.map(|t| {
            let third = -self.cubic.coefficients(t.stiffness)[0] - 2.0 * t.growth_rate;
            [t.stiffness, t.growth_rate, t.growth_rate, third, 0.0]
        }));
        rows.sort_by(|a, b| a[0].total_cmp(&b[0]));
        Ok(rows)
    }

    fn panel(
        &self,
        roots: &[[f64; 5]],
        stiffness: (f64, f64),
        heights: (f64, f64),
        title: &str,
    ) -> Panel {
        let mut panel = Panel::new(
            title,
            Axis::log("stiffness K [aσ/L]").within(stiffness.0, stiffness.1),
            Axis::linear("s [10⁻³ V*/L]").within(heights.0, heights.1),
        );
        let column = |i: usize| -> Vec<f64> { roots.iter().map(|row| row[i]).collect() };
        let line = |label: &str, i: usize, colour: usize| {
            let y = column(i).iter().map(|s| s * THOUSANDTHS).collect();
            PlotSeries::new(label, column(0), y).colour(colour)
        };
        panel.series = vec![
            line("the pair, real part", 1, 0),
            line("", 2, 0),
            line("imaginary part", 4, 1).stroke(Stroke::Dashed),
            line("third root", 3, 2),
        ];
        let tangent = |t: Tangency| Mark::new(t.stiffness, t.growth_rate * THOUSANDTHS, "tangency");
        let critical = Mark::new(self.critical.0, 0.0, "k_c*");
        let all = self.tangencies.map(tangent).into_iter().chain([critical]);
        panel.marks = all
            .filter(|mark| (stiffness.0..stiffness.1).contains(&mark.x))
            .collect();
        panel.zero_line = true;
        panel
    }
}
