//! Runs so long that their oscillations run into one another on the picture: their last part, enlarged.

use twinslip_output::plot::{Block, Drawing, Panel};

/// More oscillations than this are too many for a panel.
const MANY: usize = 30;
/// So many of them are shown of the last part.
const SHOWN: usize = 5;

/// The panels of a run and, where it oscillates too often for them, the same ones of its last part beside them; then what else there is
/// beside or below. Oscillations are those of `values` at `times`.
pub(super) fn with_last_part(
    in_time: Vec<Panel>,
    others: Vec<Vec<Panel>>,
    (times, values): (&[f64], &[f64]),
) -> Drawing {
    let block = |columns| Block {
        title: String::new(),
        columns,
    };
    match last_part(times, values) {
        None => Drawing::columns([vec![in_time], others].concat()),
        Some(ends) => {
            let last = enlarged(&in_time, ends);
            let mut blocks = vec![block(vec![in_time, last])];
            if !others.is_empty() {
                blocks.push(block(others));
            }
            Drawing::blocks(blocks)
        }
    }
}

/// The same panels between two times, without the legends that stand beside them.
pub(super) fn enlarged(panels: &[Panel], (from, to): (f64, f64)) -> Vec<Panel> {
    let panels = panels.iter().enumerate();
    let one = |(number, panel): (usize, &Panel)| {
        let mut panel = panel.clone();
        panel.title = match number {
            0 => format!("the last {SHOWN} oscillations"),
            _ => String::new(),
        };
        panel.x = panel.x.within(from, to);
        panel.keys.clear();
        panel.strokes.clear();
        for series in &mut panel.series {
            series.label.clear();
        }
        panel
    };
    panels.map(one).collect()
}

/// Between which times the last oscillations are, where there are many: from one rise through the middle of the range to another.
pub(super) fn last_part(times: &[f64], values: &[f64]) -> Option<(f64, f64)> {
    // What a run begins with may go far beyond what it settles on.
    let settled = &values[values.len() / 2..];
    let finite = || settled.iter().copied().filter(|x| x.is_finite());
    let least = finite().fold(f64::INFINITY, f64::min);
    let most = finite().fold(f64::NEG_INFINITY, f64::max);
    let middle = 0.5 * (least + most);
    let pairs = values.windows(2).zip(times);
    let rises = pairs.filter(|(pair, _)| pair[0] < middle && pair[1] >= middle);
    let rises: Vec<f64> = rises.map(|(_, &time)| time).collect();
    let (first, last) = (rises.len().checked_sub(SHOWN + 1)?, rises.len() - 1);
    (rises.len() > MANY && rises[first] < rises[last]).then(|| (rises[first], rises[last]))
}

#[cfg(test)]
mod test {
    use super::*;

    /// A sine of so many turns in 100 units of time.
    fn wave(turns: f64) -> (Vec<f64>, Vec<f64>) {
        let times: Vec<f64> = (0..10_000).map(|i| 0.01 * f64::from(i)).collect();
        let height = |t: &f64| (std::f64::consts::TAU * turns * t / 100.0).sin();
        let values = times.iter().map(height).collect();
        (times, values)
    }

    #[test]
    fn many_oscillations_have_a_last_part_of_five_periods() {
        let (times, values) = wave(10.0);
        assert_eq!(last_part(&times, &values), None);
        let (times, values) = wave(200.0);
        let (from, to) = last_part(&times, &values).expect("many");
        assert!((to - from - 2.5).abs() < 0.02, "{from} to {to}");
        assert!(to > 99.0 && to <= 100.0);
        assert_eq!(last_part(&[], &[]), None);
    }
}
