//! How fits are shown: rows beside data, the picture of both, what is known of each pair of parameters.

use crate::scene::{Column, Quantity};
use twinslip::fit::{DRIFT, Fit, FittedParameter, ProfilePoint, Scale};
use twinslip_output::plot::{Axis, Drawing, Mark, Panel, PlotSeries, Stroke, Symbol};

/// A sample of a record, and what was fitted to it; in SI.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FitRow {
    /// Which of several records, from 1.
    pub record: usize,
    /// In s, as in the record.
    pub time: f64,
    /// Of the load point since the beginning of the window, in m.
    pub displacement: f64,
    /// The friction coefficient that was measured.
    pub observed: f64,
    /// And that of the fit.
    pub fitted: f64,
}

/// The columns of a fit, of one record or of several.
pub fn fit_columns(several: bool) -> Vec<Column<FitRow>> {
    use Quantity::{Length, Number, Time};
    let number = Column::new("record", Number, |row: &FitRow| row.record.into())
        .meaning("number of the record");
    let mut columns = vec![
        Column::new("time", Time, |row: &FitRow| row.time.into()).meaning("time"),
        Column::new("displacement", Length, |row: &FitRow| {
            row.displacement.into()
        })
        .meaning("displacement of the load point since the record began"),
        Column::new("observed", Number, |row: &FitRow| row.observed.into())
            .meaning("measured friction coefficient"),
        Column::new("fitted", Number, |row: &FitRow| row.fitted.into())
            .meaning("friction coefficient of the fitted model"),
        Column::new("residual", Number, |row: &FitRow| {
            (row.observed - row.fitted).into()
        })
        .meaning("observed minus fitted friction"),
    ];
    if several {
        columns.insert(0, number);
    }
    columns
}

/// Metres, as laboratories have them.
const MICRO: f64 = 1e6;
/// Points that an ellipse goes through.
const AROUND: usize = 128;
/// The square of the radius that holds 95 % of a normal distribution in two variables.
const TWO_OF_95: f64 = 5.991;
/// And 68 %.
const TWO_OF_68: f64 = 2.279;
/// Standard errors on each side of 95 %.
const NORMAL_95: f64 = 1.96;

/// Friction and residuals against the displacement, a column for each record.
pub fn picture_of_fit(rows: &[FitRow], law: &str) -> Drawing {
    let records = rows.chunk_by(|one, other| one.record == other.record);
    Drawing::columns(records.map(|rows| one_record(rows, law)).collect())
}

fn one_record(rows: &[FitRow], law: &str) -> Vec<Panel> {
    let x = || Axis::linear("load-point displacement [µm]");
    let along: Vec<f64> = rows.iter().map(|row| row.displacement * MICRO).collect();
    let of = |y: &dyn Fn(&FitRow) -> f64| rows.iter().map(y).collect::<Vec<f64>>();
    let title = match rows[0].record {
        1 => "friction".to_owned(),
        number => format!("friction, record {number}"),
    };
    let friction = Panel {
        series: vec![
            PlotSeries::dots("measured", along.clone(), of(&|row| row.observed)).colour(4),
            PlotSeries::new(
                format!("fitted, {law}"),
                along.clone(),
                of(&|row| row.fitted),
            )
            .colour(1)
            .wide(),
        ],
        ..Panel::new(title, x(), Axis::linear("friction coefficient μ"))
    };
    let residuals = Panel {
        series: vec![
            PlotSeries::dots("", along, of(&|row| (row.observed - row.fitted) * 1e3)).colour(4),
        ],
        zero_line: true,
        ..Panel::new("measured less fitted", x(), Axis::linear("residual [10⁻³]"))
    };
    vec![friction, residuals]
}

/// The name of a parameter with its symbol, its unit, and by what it is to be multiplied for that.
pub fn parameter_label(name: &str, per_stress: bool) -> (String, f64) {
    let (symbol, unit, by) = match name {
        "direct_effect" => ("a", "", 1.0),
        "evolution_effect" => ("b", "", 1.0),
        "evolution_effect_2" => ("b₂", "", 1.0),
        "slip_length" => ("L", "µm", MICRO),
        "slip_length_2" => ("L₂", "µm", MICRO),
        "reference_friction" => ("μ*", "", 1.0),
        "stiffness" if per_stress => ("k", "GPa/m", 1e-9),
        "stiffness" => ("k", "1/m", 1.0),
        "healing_time" => ("t**", "s", 1.0),
        "residual_strength" => ("c", "", 1.0),
        DRIFT => ("slope", "1/m", 1.0),
        other => return (other.to_owned(), 1.0),
    };
    let unit = match unit {
        "" => String::new(),
        unit => format!(" [{unit}]"),
    };
    (format!("{symbol}{unit}"), by)
}

/// The profile of each parameter, and below it the ellipses of it with those that follow. `stress` is the normal stress by which the stiffness
/// is multiplied, where it is known.
pub fn picture_of_parameters(fit: &Fit, stress: Option<f64>) -> Drawing {
    let count = fit.parameters.len();
    let columns = (0..count).map(|i| {
        let mut column = vec![profile(fit, i, stress)];
        column.extend((i + 1..count).map(|j| ellipses(fit, (i, j), stress)));
        column
    });
    Drawing::columns(columns.collect())
}

/// The label of a parameter and its factor, with the normal stress where the stiffness is in Pa/m.
pub fn label_of(parameter: &FittedParameter, stress: Option<f64>) -> (String, f64) {
    let (label, by) = parameter_label(&parameter.name, stress.is_some());
    let is_stiffness = parameter.name == "stiffness";
    (label, by * stress.filter(|_| is_stiffness).unwrap_or(1.0))
}

/// A parameter where its variable is so many standard errors from the best.
fn moved(parameter: &FittedParameter, errors: f64) -> f64 {
    let error = parameter.uncertainty / parameter.scale.slope(parameter.value);
    let best = parameter.scale.inward(parameter.value);
    parameter.scale.outward(best + errors * error)
}

fn profile(fit: &Fit, i: usize, stress: Option<f64>) -> Panel {
    let parameter = &fit.parameters[i];
    let (label, by) = label_of(parameter, stress);
    let x = |at: &ProfilePoint| parameter.scale.outward(at.variable) * by;
    let steps: Vec<f64> = (-30..=30).map(|k| f64::from(k) * 0.1).collect();
    let straight = PlotSeries::new(
        if i == 0 { "by the standard error" } else { "" },
        steps.iter().map(|s| moved(parameter, *s) * by).collect(),
        steps,
    )
    .stroke(Stroke::Dashed)
    .colour(6);
    let points = fit.profiles.get(i).map(|profile| &profile.points[..]);
    let points = points.unwrap_or_default();
    let shown = PlotSeries::new(
        if i == 0 { "profile" } else { "" },
        points.iter().map(x).collect(),
        points.iter().map(|at| at.deviation).collect(),
    )
    .colour(0);
    let (low, high) = parameter.interval;
    let ends = [(low, -NORMAL_95), (high, NORMAL_95)];
    let there = ends.into_iter().filter(|(x, _)| x.is_finite() && *x != 0.0);
    let mark = |(x, y): (f64, f64)| Mark::new(x * by, y, "").symbol(Symbol::Diamond).colour(1);
    Panel {
        series: vec![straight, shown],
        marks: there.map(mark).collect(),
        zero_line: true,
        ..Panel::new(
            match fit.verdict.has_run_away(parameter) {
                true => "not determined".into(),
                false => format!(
                    "{} ± {}",
                    in_digits(parameter.value * by, 3),
                    in_digits(parameter.uncertainty * by, 3)
                ),
            },
            Axis::linear(label),
            Axis::linear("standard errors").within(-3.0, 3.0),
        )
    }
}

/// The curves that hold 68 and 95 % of two parameters.
fn ellipses(fit: &Fit, (i, j): (usize, usize), stress: Option<f64>) -> Panel {
    let (one, other) = (&fit.parameters[i], &fit.parameters[j]);
    let ((x_label, x_by), (y_label, y_by)) = (label_of(one, stress), label_of(other, stress));
    let rho = fit.correlation[(i, j)];
    let ellipse = |square: f64, stroke: Stroke| {
        let radius = square.sqrt();
        let angles = (0..=AROUND).map(|k| std::f64::consts::TAU * k as f64 / AROUND as f64);
        let (x, y) = angles
            .map(|angle| {
                let (u, w) = (radius * angle.cos(), radius * angle.sin());
                let across = rho * u + (1.0 - rho * rho).max(0.0).sqrt() * w;
                (moved(one, u) * x_by, moved(other, across) * y_by)
            })
            .unzip();
        PlotSeries::new("", x, y).stroke(stroke).colour(0)
    };
    Panel {
        series: vec![
            ellipse(TWO_OF_95, Stroke::Solid),
            ellipse(TWO_OF_68, Stroke::Dashed),
        ],
        marks: vec![Mark::new(one.value * x_by, other.value * y_by, "").colour(1)],
        ..Panel::new(
            format!("correlation {rho:.3}"),
            Axis::linear(x_label),
            Axis::linear(y_label),
        )
    }
}

/// The digits of a parameter's value that its error does not hide: two of the error.
pub fn digits_of(parameter: &FittedParameter) -> usize {
    /// Of one without an error.
    const USUAL: usize = 5;
    /// Of a double.
    const MOST: f64 = 15.0;
    let [size, error] = [parameter.value, parameter.uncertainty].map(|x| x.abs().log10().floor());
    let digits = size - error + 2.0;
    match digits.is_finite() {
        true => digits.clamp(2.0, MOST) as usize,
        false => USUAL,
    }
}

/// A number in so many digits, at least one, with an exponent only where it is small or large.
pub fn in_digits(x: f64, digits: usize) -> String {
    if x == 0.0 || !x.is_finite() {
        return x.to_string();
    }
    let behind = digits - 1;
    // As it is rounded: 9.999 is 10.0.
    let rounded = format!("{x:.behind$e}");
    let size = rounded
        .split_once('e')
        .map_or(0, |(_, size)| size.parse().unwrap_or(0));
    if (-3..5).contains(&size) {
        let behind = usize::try_from(behind as i32 - size).unwrap_or(0);
        format!("{x:.behind$}")
    } else {
        rounded
    }
}

/// Whether a parameter is told by its logarithm.
pub fn scale_name(scale: Scale) -> &'static str {
    match scale {
        Scale::Logarithmic => "log",
        Scale::Linear => "linear",
    }
}
