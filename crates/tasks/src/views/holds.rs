//! Holds as a picture: how far friction falls and how it heals with time.

use twinslip::fit::{Hold, Levels, healing_rate};
use twinslip::number::Uncertain;
use twinslip_output::plot::{Axis, Bars, Drawing, Mark, Panel, PlotSeries, Stroke, Symbol};

/// Standard errors on each side of 95 %.
const SIDE: f64 = 1.96;
/// How far the axis goes beyond the holds, as a factor.
const BESIDE: f64 = 1.5;
/// The colour of what was fitted.
const FITTED: usize = 6;

/// The holds that were measured with how healing grows with the time of the hold.
pub fn measured_healing(holds: &[Hold]) -> Option<Uncertain> {
    let all = holds.iter();
    healing_rate(all.filter_map(|hold| Some((hold.duration, hold.measured.healing?))))
}

/// Healing, and the friction at the end of holds and at the peaks after them, against the duration.
pub fn picture_of_holds(holds: &[Hold]) -> Drawing {
    let mut upper = panel(
        holds,
        "healing",
        "peak less friction before",
        &[(|levels| levels.healing, 0)],
    );
    if let Some(rate) = measured_healing(holds) {
        upper.title = format!(
            "healing, {:.3e} ± {:.1e} per decade",
            rate.value, rate.uncertainty
        );
    }
    let lower = panel(
        holds,
        "peaks, and ends of holds",
        "friction coefficient μ",
        &[(|levels| levels.peak, 1), (|levels| levels.minimum, 2)],
    );
    Drawing::columns(vec![vec![upper, lower]])
}

/// Which of the levels, with its colour.
type Shown = (fn(&Levels) -> Option<Uncertain>, usize);

fn panel(holds: &[Hold], title: &str, y: &str, shown: &[Shown]) -> Panel {
    let all = || holds.iter().map(|hold| hold.duration);
    let (low, high) = (
        all().fold(f64::INFINITY, f64::min),
        all().fold(0.0, f64::max),
    );
    let along = Axis::log("hold [s]").within(low / BESIDE, high * BESIDE);
    let mut panel = Panel::new(title, along, Axis::linear(y));
    for (i, (of, colour)) in shown.iter().enumerate() {
        let colour = *colour;
        for (record, fitted) in by_record(holds).into_iter().enumerate() {
            let label = if i == 0 && record == 0 { "fitted" } else { "" };
            let (along, values) = fitted
                .iter()
                .filter_map(|hold| Some((hold.duration, of(&hold.fitted)?.value)))
                .unzip();
            let line = PlotSeries::new(label, along, values);
            panel
                .series
                .push(line.stroke(Stroke::Dashed).colour(FITTED));
        }
        let measured = holds
            .iter()
            .filter_map(|hold| Some((hold.duration, of(&hold.measured)?)));
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
                    .colour(colour)
            }
        }));
    }
    panel
}

/// The holds of each record by their duration, one of those that last as long.
fn by_record(holds: &[Hold]) -> Vec<Vec<&Hold>> {
    /// Durations nearer to each other than this factor are one.
    const SAME: f64 = 1.01;
    let records = holds.chunk_by(|one, other| one.record == other.record);
    let sorted = records.map(|all| {
        let mut all: Vec<&Hold> = all.iter().collect();
        all.sort_by(|one, other| one.duration.total_cmp(&other.duration));
        all.dedup_by(|next, kept| next.duration < SAME * kept.duration);
        all
    });
    sorted.collect()
}
