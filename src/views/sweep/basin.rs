//! Basins: on which attractor the runs from starts (psi_1, psi_2) end.

use super::attractors::attractors;
use super::tints::Kind;
use super::{Outcome, Side};
use crate::equilibrium::Symmetry;
use crate::output::plot::{Cells, Drawing, Panel, Shade, Swatch};
use crate::output::seven_digits;
use crate::scene::{Quantity, Units};
use crate::section::Regime;
use crate::views::axis_label;

/// Colours of attractors, the largest basin first, far apart in lightness and hue where there are few.
const ORDER: [Kind; 9] = [
    Kind::PeriodicSymmetric,
    Kind::PeriodHigher,
    Kind::SteadySymmetric,
    Kind::Torus,
    Kind::PeriodicAsymmetric,
    Kind::Period4,
    Kind::SteadyAsymmetric,
    Kind::Period3,
    Kind::Chaotic,
];

/// The attractor that each start goes to, numbered by the size of their basins. Points that are missing stay white; all beyond
/// the eighth attractor share a colour. V_H and K are for the title.
pub fn basin_map(
    outcomes: &[Outcome],
    (state_1, state_2): (&Side, &Side),
    (driving, stiffness): (f64, f64),
    units: &Units,
) -> Drawing {
    let label = |name| axis_label(name, Quantity::State, units);
    let outward = |x| units.outward(Quantity::State, x);
    let (x, x_edges) = state_1.axis(label("ψ₁ at the start"), outward);
    let (y, y_edges) = state_2.axis(label("ψ₂ at the start"), outward);
    let (all, of) = attractors(outcomes);
    let mut fills = vec![Vec::new(); state_1.values.len() * state_2.values.len()];
    for (outcome, attractor) in outcomes.iter().zip(&of) {
        if let Some(cell) = fills.get_mut(outcome.number) {
            *cell = vec![attractor.map_or(Kind::Undecided.shade(), tint)];
        }
    }
    let short = |quantity, x: f64| {
        let digits = seven_digits(units.outward(quantity, x));
        match digits.contains(['e', 'E']) || !digits.contains('.') {
            true => digits,
            false => digits
                .trim_end_matches('0')
                .trim_end_matches('.')
                .to_owned(),
        }
    };
    let title = format!(
        "basins at V_H = {}, K = {}",
        short(Quantity::SlipRate, driving),
        short(Quantity::Stiffness, stiffness)
    );
    let map = Cells {
        x_edges,
        y_edges,
        fills,
        swatches: swatches(&all, &of, units),
    };
    let panel = Panel {
        cells: Some(map),
        ..Panel::new(title, x, y)
    };
    Drawing::columns(vec![vec![panel]])
}

fn tint(attractor: usize) -> Shade {
    ORDER[attractor.min(ORDER.len() - 1)].shade()
}

/// The legend: each attractor with what it is and its share of the starts.
fn swatches(all: &[(Outcome, usize)], of: &[Option<usize>], units: &Units) -> Vec<Swatch> {
    let share = |count: usize| 100.0 * count as f64 / of.len().max(1) as f64;
    let last = ORDER.len() - 1;
    let named = all
        .iter()
        .take(last)
        .enumerate()
        .map(|(i, (one, count))| Swatch {
            shades: vec![tint(i)],
            label: format!("{}: {}, {:.1} %", i + 1, words(one, units), share(*count)),
        });
    let others: usize = all.iter().skip(last).map(|(_, count)| count).sum();
    let others = (others > 0).then(|| Swatch {
        shades: vec![tint(last)],
        label: format!("{} others, {:.1} %", all.len() - last, share(others)),
    });
    let undecided = of.iter().filter(|attractor| attractor.is_none()).count();
    let undecided = (undecided > 0).then(|| Swatch {
        shades: vec![Kind::Undecided.shade()],
        label: format!("undecided, {:.1} %", share(undecided)),
    });
    named.chain(others).chain(undecided).collect()
}

/// Regime, symmetry and period.
fn words(one: &Outcome, units: &Units) -> String {
    let mut words = vec![one.regime.name().to_owned()];
    words.extend(one.symmetry.map(|symmetry| match symmetry {
        Symmetry::Symmetric => "symmetric".to_owned(),
        Symmetry::Asymmetric => "asymmetric".to_owned(),
    }));
    if one.regime == Regime::Periodic {
        let returns = one.returns_per_period.filter(|&returns| returns > 1);
        words.extend(returns.map(|returns| format!("{returns} returns")));
        let period = one
            .period
            .map(|period| units.outward(Quantity::Time, period));
        let unit = units.short_name(Quantity::Time);
        words.extend(period.map(|period| format!("T = {} {unit}", four_digits(period))));
    }
    words.join(", ")
}

/// Enough to tell periods apart.
fn four_digits(x: f64) -> String {
    let digits = (3.0 - x.abs().log10().floor()).clamp(0.0, 9.0) as usize;
    format!("{x:.digits$}")
}
