//! The picture of a steady-state friction law.

use super::diagram::axis_label;
use crate::scene::{LawCurve, LawPoint, MeasuredFriction, Quantity, Units};
use twinslip::friction::ExtremumKind;
use twinslip_output::plot::{Axis, Bars, Drawing, Key, Mark, Panel, PlotSeries, Side, Symbol};

/// tau_ss, as a coefficient of friction where that is the same of all laws and known, with what was measured of it, and k_c against V.
pub fn picture_of_law(
    units: &Units,
    curves: &[LawCurve],
    measured: &[MeasuredFriction],
) -> Drawing {
    let first = curves.first().and_then(|curve| curve.coefficient);
    let alike = curves.iter().all(|curve| curve.coefficient == first);
    let coefficient = first.filter(|_| alike);
    let label = |name: &str, quantity| axis_label(name, quantity, units);
    // A coefficient has no unit.
    let stress = |x: f64| match coefficient {
        Some(coefficient) => coefficient * x,
        None => units.outward(Quantity::Stress, x),
    };
    let friction = match coefficient {
        Some(_) => "friction coefficient τ_ss/σ".to_owned(),
        None => label("steady stress τ_ss", Quantity::Stress),
    };
    let x = Axis::log(label("slip rate V", Quantity::SlipRate));
    let lines = |y: &dyn Fn(&LawPoint) -> f64| -> Vec<PlotSeries> {
        let line = |(i, curve): (usize, &LawCurve)| {
            let rate = |at: &LawPoint| units.outward(Quantity::SlipRate, at.slip_rate);
            let rates = curve.points.iter().map(rate).collect();
            let name = match curves.len() {
                1 => String::new(),
                _ => format!("interface {}", curve.interface),
            };
            let values = curve.points.iter().map(y).collect();
            PlotSeries::new(name, rates, values).colour(i)
        };
        curves.iter().enumerate().map(line).collect()
    };
    // Of two laws each mark has the colour and the number of its interface.
    let mark = |i: usize, (x, y): (f64, f64), [alone, beside]: [&str; 2]| match curves.len() {
        1 => Mark::new(x, y, alone),
        _ => {
            let label = format!("{beside} ({})", curves[i].interface);
            Mark::new(x, y, label).colour(i)
        }
    };
    let numbered = || curves.iter().enumerate();
    let extrema = numbered().flat_map(|(i, curve)| {
        let extrema = curve.landmarks.extrema.iter();
        extrema.map(move |extremum| (i, extremum))
    });
    let marks = extrema.map(|(i, extremum)| {
        let (names, side) = match extremum.kind {
            ExtremumKind::Maximum => (["maximum V_M", "V_M"], Side::Above),
            ExtremumKind::Minimum => (["minimum V_m", "V_m"], Side::Below),
        };
        let at = units.outward(Quantity::SlipRate, extremum.slip_rate.value);
        mark(i, (at, stress(extremum.stress.value)), names).side(side)
    });
    let friction = Panel {
        series: lines(&|at| stress(at.stress.value)),
        marks: measured_marks(units, measured).chain(marks).collect(),
        keys: measured.first().map(measured_key).into_iter().collect(),
        ..Panel::new("steady-state friction", x.clone(), Axis::linear(friction))
    };
    let tops = numbered().filter_map(|(i, curve)| {
        let maximum = curve.landmarks.critical_stiffness_maximum?;
        let at = units.outward(Quantity::SlipRate, maximum.slip_rate.value);
        let stiffness = units.outward(Quantity::Stiffness, maximum.stiffness.value);
        let mark = mark(i, (at, stiffness), ["maximum", "maximum"]);
        Some(mark.side(Side::Above))
    });
    let title = "critical stiffness, above which sliding is steady";
    let critical = label("critical stiffness k_c", Quantity::Stiffness);
    let stiffness = Panel {
        series: from_zero(lines(&|at| {
            units.outward(Quantity::Stiffness, at.critical_stiffness)
        })),
        marks: tops.collect(),
        zero_line: true,
        ..Panel::new(title, x, Axis::linear(critical))
    };
    Drawing::columns(vec![vec![friction, stiffness]])
}

/// The colour of what was measured.
const MEASURED: usize = 1;

/// What was measured, each with its uncertainty as a bar.
fn measured_marks(units: &Units, measured: &[MeasuredFriction]) -> impl Iterator<Item = Mark> {
    measured.iter().map(|one| {
        let rate = units.outward(Quantity::SlipRate, one.slip_rate);
        let ends = |error: f64| (one.friction - error, one.friction + error);
        let mark = Mark::new(rate, one.friction, "").symbol(Symbol::Diamond);
        Mark {
            bars: Bars {
                x: None,
                y: one.uncertainty.map(ends),
            },
            ..mark.colour(MEASURED)
        }
    })
}

fn measured_key(_: &MeasuredFriction) -> Key {
    Key {
        symbol: Symbol::Diamond,
        filled: true,
        colour: Some(MEASURED),
        label: "measured".into(),
    }
}

/// Down to zero: where a law strengthens with velocity k_c is negative, which only says that every stiffness is stable. Curves that are
/// negative everywhere stay as they are.
fn from_zero(curves: Vec<PlotSeries>) -> Vec<PlotSeries> {
    if curves.iter().all(|curve| curve.y.iter().all(|k| *k <= 0.0)) {
        return curves;
    }
    curves.into_iter().map(cut_at_zero).collect()
}

/// What of a curve is not negative, with the points at which it is zero; its abscissa is logarithmic.
fn cut_at_zero(curve: PlotSeries) -> PlotSeries {
    let points: Vec<(f64, f64)> = curve
        .x
        .iter()
        .copied()
        .zip(curve.y.iter().copied())
        .collect();
    let (mut x, mut y) = (Vec::new(), Vec::new());
    let mut put = |(rate, k): (f64, f64)| {
        x.push(rate);
        y.push(if k < 0.0 { f64::NAN } else { k });
    };
    points.first().into_iter().for_each(|first| put(*first));
    for pair in points.windows(2) {
        let [(from, before), (to, after)] = [pair[0], pair[1]];
        if before * after < 0.0 {
            let part = before / (before - after);
            put((from * (to / from).powf(part), 0.0));
        }
        put((to, after));
    }
    PlotSeries { x, y, ..curve }
}

#[cfg(test)]
mod test {
    use super::*;

    #[test]
    fn critical_stiffness_is_drawn_down_to_zero() {
        let curve = |y: [f64; 4]| PlotSeries::new("", vec![1.0, 10.0, 100.0, 1000.0], y.into());
        let cut = from_zero(vec![curve([-1.0, 1.0, 3.0, -1.0])]).remove(0);
        let seen: Vec<(f64, f64)> = cut
            .x
            .into_iter()
            .zip(cut.y)
            .filter(|(_, k)| k.is_finite())
            .collect();
        let expected = [
            (10_f64.sqrt(), 0.0),
            (10.0, 1.0),
            (100.0, 3.0),
            (10_f64.powf(2.75), 0.0),
        ];
        assert_eq!(seen.len(), expected.len());
        for ((x, y), (a, b)) in seen.into_iter().zip(expected) {
            assert!((x / a - 1.0).abs() < 1e-12 && y == b, "{x}, {y}");
        }
        let negative = curve([-4.0, -3.0, -2.0, -1.0]);
        assert_eq!(from_zero(vec![negative.clone()]), [negative]);
    }
}
