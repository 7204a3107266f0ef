//! Holds as a picture: how far friction falls and how it heals with time.

use twinslip::fit::{Estimate, Hold, Levels, healing_rate};
use twinslip_output::plot::{Axis, Bars, Drawing, Mark, Panel, PlotSeries, Stroke, Symbol};

/// Standard errors on each side of 95 %.
const SIDE: f64 = 1.96;

/// The holds that were measured with how healing grows with the time of the hold.
pub fn measured_healing(holds: &[Hold]) -> Option<Estimate> {
    let all = holds.iter();
    healing_rate(all.filter_map(|hold| Some((hold.duration, hold.measured?.healing))))
}

/// Healing, and the friction at the end of holds and at the peaks after them, against the duration.
pub fn picture_of_holds(holds: &[Hold]) -> Drawing {
    let healing = |levels: &Levels<Estimate>| levels.healing;
    let mut upper = panel(
        holds,
        "healing",
        "peak less friction before",
        &[(&healing, 0)],
    );
    if let Some(rate) = measured_healing(holds) {
        upper.title = format!(
            "healing, {:.3e} ± {:.1e} per decade",
            rate.value, rate.uncertainty
        );
    }
    let least = |levels: &Levels<Estimate>| levels.minimum;
    let most = |levels: &Levels<Estimate>| levels.peak;
    let lower = panel(
        holds,
        "peaks, and ends of holds",
        "friction coefficient μ",
        &[(&most, 1), (&least, 2)],
    );
    Drawing::columns(vec![vec![upper, lower]])
}

/// Of some levels, each with its colour.
type Shown<'a> = (&'a dyn Fn(&Levels<Estimate>) -> Estimate, usize);

fn panel(holds: &[Hold], title: &str, y: &str, shown: &[Shown<'_>]) -> Panel {
    let mut sorted: Vec<&Hold> = holds.iter().collect();
    sorted.sort_by(|one, other| one.duration.total_cmp(&other.duration));
    let mut panel = Panel::new(title, Axis::log("hold [s]"), Axis::linear(y));
    for (i, (of, colour)) in shown.iter().enumerate() {
        let fitted = sorted.iter().map(|hold| of(&hold.fitted).value);
        let label = if i == 0 { "fitted" } else { "" };
        let along = sorted.iter().map(|hold| hold.duration).collect();
        let line = PlotSeries::new(label, along, fitted.collect());
        panel
            .series
            .push(line.stroke(Stroke::Dashed).colour(*colour));
        let measured = sorted
            .iter()
            .filter_map(|hold| Some((hold.duration, of(&hold.measured?))));
        panel.marks.extend(measured.map(|(duration, one)| {
            Mark {
                bars: Bars {
                    x: None,
                    y: Some((
                        one.value - SIDE * one.uncertainty,
                        one.value + SIDE * one.uncertainty,
                    )),
                },
                ..Mark::new(duration, one.value, "")
                    .symbol(Symbol::Circle)
                    .colour(*colour)
            }
        }));
    }
    panel
}
