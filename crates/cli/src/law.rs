//! `twinslip law`.

use super::Ending;
use super::call::Call;
use super::report::{self, Report};
use super::text;
use serde_json::{Map, Value, json};
use twinslip::error::{Error, Result};
use twinslip::friction::ExtremumKind;
use twinslip::number::Uncertain;
use twinslip_output::{Format, plot};
use twinslip_tasks::scene::{
    Column, Described, LawCurve, LawOptions, LawPlan, LawPoint, Quantity, TextModel, Together,
    Units,
};
use twinslip_tasks::views;

pub fn run(options: &LawOptions, call: &Call) -> Result<Ending> {
    match TextModel::of(&options.model, &["driving", "stiffness"])? {
        Some(model) if model.slab.is_some() => return text::law::run(options, model, call),
        _ => {}
    }
    let plan = LawPlan::new(options)?;
    let report = begun(options, call, || plan.explain())?;
    let curves = plan.curves()?;
    if let Some(path) = &options.plot {
        report.draw(path, &picture(&plan.system.units, &curves))?;
    }
    let columns = views::law_columns(curves.len() > 1);
    write(
        &report,
        &plan.system,
        &columns,
        (&curves, plan.together),
        None,
    )
}

/// Checks where results and pictures go, and says what will be computed.
pub fn begun<'a>(
    options: &LawOptions,
    call: &'a Call,
    explain: impl FnOnce() -> String,
) -> Result<Report<'a>> {
    if let Some(path) = &options.plot {
        plot::PictureFormat::of(path)?;
    }
    let plots: Vec<&std::path::Path> = options.plot.as_deref().into_iter().collect();
    let report = Report::new(&options.output, call, &plots)?;
    if options.output.explain {
        call.say(explain());
    }
    Ok(report)
}

/// What laws are known by, in the user's units; of two interfaces each with its number.
struct Landmarks {
    extrema: Vec<Value>,
    maxima: Vec<Value>,
    transitions: Vec<Value>,
}

impl Landmarks {
    fn of<R>(curves: &[LawCurve<R>], units: &Units) -> Self {
        let out = |quantity, x| report::uncertain(units, quantity, x);
        let mut all = Landmarks {
            extrema: Vec::new(),
            maxima: Vec::new(),
            transitions: Vec::new(),
        };
        for curve in curves {
            let numbered = |object: Value| match (curves.len(), object) {
                (2, Value::Object(own)) => {
                    let number = ("interface".to_owned(), json!(curve.interface));
                    Value::Object([number].into_iter().chain(own).collect())
                }
                (_, object) => object,
            };
            let landmarks = &curve.landmarks;
            all.extrema.extend(landmarks.extrema.iter().map(|extremum| {
                numbered(json!({
                    "kind": kind(extremum.kind),
                    "slip_rate": out(Quantity::SlipRate, extremum.slip_rate),
                    "stress": out(Quantity::Stress, extremum.stress),
                }))
            }));
            let maximum = landmarks.critical_stiffness_maximum.map(|maximum| {
                numbered(json!({
                    "slip_rate": out(Quantity::SlipRate, maximum.slip_rate),
                    "stiffness": out(Quantity::Stiffness, maximum.stiffness),
                }))
            });
            all.maxima.extend(maximum);
            let transition = landmarks.transition_rate.map(|v| {
                let v = units.outward(Quantity::SlipRate, v);
                numbered(json!({ "slip_rate": v }))
            });
            all.transitions.extend(transition);
        }
        all
    }

    /// What the object has of them: of one law the single ones, of two lists.
    fn result(&self, laws: usize, rows: Vec<Value>) -> Value {
        if laws > 1 {
            return json!({
                "extrema": self.extrema,
                "critical_stiffness_maxima": self.maxima,
                "transition_rates": self.transitions,
                "rows": rows,
            });
        }
        json!({
            "extrema": self.extrema,
            "critical_stiffness_maximum": self.maxima.first(),
            "transition_rate": self.transitions.first().map(|one| &one["slip_rate"]),
            "rows": rows,
        })
    }

    /// In words, one a line.
    fn lines(&self) -> Vec<String> {
        let pair = |x: &Value| {
            let number = |name: &str| x[name].as_f64();
            match (number("value"), number("uncertainty")) {
                (Some(value), Some(uncertainty)) => Uncertain::new(value, uncertainty).to_string(),
                (Some(value), None) => format!("{value:e}, no digit of which is certain"),
                (None, _) => "unknown".to_owned(),
            }
        };
        let whose = |object: &Value| match object["interface"].as_u64() {
            Some(number) => format!("interface {number}: "),
            None => String::new(),
        };
        let extrema = self.extrema.iter().map(|extremum| {
            format!(
                "{}{} of stress at slip_rate {}, stress {}",
                whose(extremum),
                extremum["kind"].as_str().unwrap_or_default(),
                pair(&extremum["slip_rate"]),
                pair(&extremum["stress"])
            )
        });
        let maxima = self.maxima.iter().map(|maximum| {
            format!(
                "{}maximum of critical_stiffness at slip_rate {}, stiffness {}",
                whose(maximum),
                pair(&maximum["slip_rate"]),
                pair(&maximum["stiffness"])
            )
        });
        let transitions = self.transitions.iter().map(|transition| {
            let v = transition["slip_rate"].as_f64().unwrap_or(f64::NAN);
            let whose = whose(transition);
            format!("{whose}high-velocity strengthening sets in at slip_rate {v}")
        });
        extrema.chain(maxima).chain(transitions).collect()
    }
}

fn kind(kind: ExtremumKind) -> &'static str {
    match kind {
        ExtremumKind::Maximum => "maximum",
        ExtremumKind::Minimum => "minimum",
    }
}

/// What interfaces do that slide together at V_H, of each law. To each of N interfaces that move alike the spring is N K stiff; where that
/// is more than the critical stiffness, their steady sliding is stable to what moves them alike.
fn at_driving<R>(
    curves: &[LawCurve<R>],
    together: Together,
    columns: &[Column<R>],
    units: &Units,
) -> Vec<Map<String, Value>> {
    let object = |curve: &LawCurve<R>| {
        let mut object = views::object(columns, curve.together.as_ref()?, units);
        if let Some(stiffness) = together.stiffness {
            let stiffness = units.outward(Quantity::Stiffness, stiffness);
            let critical = object.get("critical_stiffness").and_then(Value::as_f64);
            let ratio = critical.filter(|k| *k > 0.0).map(|k| stiffness / k);
            object.insert("stiffness_over_critical".into(), json!(ratio));
        }
        Some(object)
    };
    curves.iter().filter_map(object).collect()
}

pub fn write<R>(
    report: &Report<'_>,
    system: &dyn Described,
    columns: &[Column<R>],
    (curves, together): (&[LawCurve<R>], Option<Together>),
    failure: Option<&Error>,
) -> Result<Ending> {
    let units = system.units();
    let landmarks = Landmarks::of(curves, units);
    let at_driving = together
        .filter(|all| all.slip_rate.is_some())
        .map(|all| at_driving(curves, all, columns, units));
    // N K against the largest critical stiffness: above it steady sliding together is stable at every rate.
    let over_maximum = together.and_then(|all| all.stiffness).map(|stiffness| {
        let maxima = curves.iter();
        let maxima = maxima.filter_map(|curve| curve.landmarks.critical_stiffness_maximum);
        let largest = maxima
            .map(|maximum| maximum.stiffness.value)
            .fold(0.0, f64::max);
        (largest > 0.0).then(|| stiffness / largest)
    });
    let points = || curves.iter().flat_map(|curve| &curve.points);
    if report.format == Format::Json {
        report.hand_on(units, columns, points());
        let object = |point| Value::Object(views::object(columns, point, units));
        let rows: Vec<Value> = points().map(object).collect();
        let work = json!({"evaluations": rows.len()});
        let mut result = landmarks.result(curves.len(), rows);
        if let Some(at_driving) = at_driving {
            result["at_driving"] = json!(at_driving);
        }
        if let Some(ratio) = over_maximum {
            result["stiffness_over_critical_maximum"] = json!(ratio);
        }
        let bytes = report.envelope(system, json!({}), result, work, failure);
        return report.write(&bytes);
    }
    let found = landmarks.lines();
    let mut remarks = report.remarks(system, &Value::Null);
    remarks.extend(found.iter().cloned());
    if let Some(at_driving) = at_driving {
        remarks.push(format!("at_driving: {}", json!(at_driving)));
    }
    if let Some(ratio) = over_maximum {
        remarks.push(format!("stiffness_over_critical_maximum: {}", json!(ratio)));
    }
    let ending = report.write_all(units, remarks, columns, points())?;
    found.iter().for_each(|line| report.say(line));
    Ok(ending)
}

/// tau_ss, as a coefficient of friction where that is the same of all laws and known, and k_c against V.
pub fn picture(units: &Units, curves: &[LawCurve]) -> plot::Drawing {
    let first = curves.first().and_then(|curve| curve.coefficient);
    let alike = curves.iter().all(|curve| curve.coefficient == first);
    let coefficient = first.filter(|_| alike);
    let unit = |quantity| units.short_name(quantity);
    // A coefficient has no unit.
    let stress = |x: f64| match coefficient {
        Some(coefficient) => coefficient * x,
        None => units.outward(Quantity::Stress, x),
    };
    let friction = match (coefficient, unit(Quantity::Stress).as_str()) {
        (Some(_), _) => "friction coefficient τₛₛ/σ".to_owned(),
        (None, "1") => "steady stress τₛₛ".to_owned(),
        (None, unit) => format!("steady stress τₛₛ [{unit}]"),
    };
    let x = plot::Axis::log(format!("slip rate V [{}]", unit(Quantity::SlipRate)));
    let lines = |y: &dyn Fn(&LawPoint) -> f64| -> Vec<plot::PlotSeries> {
        let line = |(i, curve): (usize, &LawCurve)| {
            let rate = |at: &LawPoint| units.outward(Quantity::SlipRate, at.slip_rate);
            let rates = curve.points.iter().map(rate).collect();
            let name = match curves.len() {
                1 => String::new(),
                _ => format!("interface {}", curve.interface),
            };
            let values = curve.points.iter().map(y).collect();
            plot::PlotSeries::new(name, rates, values).colour(i)
        };
        curves.iter().enumerate().map(line).collect()
    };
    // Of two laws each mark has the colour and the number of its interface.
    let mark = |i: usize, (x, y): (f64, f64), [alone, beside]: [&str; 2]| match curves.len() {
        1 => plot::Mark::new(x, y, alone),
        _ => {
            let label = format!("{beside} ({})", curves[i].interface);
            plot::Mark::new(x, y, label).colour(i)
        }
    };
    let numbered = || curves.iter().enumerate();
    let extrema = numbered().flat_map(|(i, curve)| {
        let extrema = curve.landmarks.extrema.iter();
        extrema.map(move |extremum| (i, extremum))
    });
    let marks = extrema.map(|(i, extremum)| {
        let (names, side) = match extremum.kind {
            ExtremumKind::Maximum => (["maximum V_M", "V_M"], plot::Side::Above),
            ExtremumKind::Minimum => (["minimum V_m", "V_m"], plot::Side::Below),
        };
        let at = units.outward(Quantity::SlipRate, extremum.slip_rate.value);
        mark(i, (at, stress(extremum.stress.value)), names).side(side)
    });
    let friction = plot::Panel {
        series: lines(&|at| stress(at.stress)),
        marks: marks.collect(),
        ..plot::Panel::new(
            "steady-state friction",
            x.clone(),
            plot::Axis::linear(friction),
        )
    };
    let tops = numbered().filter_map(|(i, curve)| {
        let maximum = curve.landmarks.critical_stiffness_maximum?;
        let at = units.outward(Quantity::SlipRate, maximum.slip_rate.value);
        let stiffness = units.outward(Quantity::Stiffness, maximum.stiffness.value);
        let mark = mark(i, (at, stiffness), ["maximum", "maximum"]);
        Some(mark.side(plot::Side::Above))
    });
    let title = "critical stiffness: a stiffer single interface slides steadily";
    let critical = format!("critical stiffness k_c [{}]", unit(Quantity::Stiffness));
    let stiffness = plot::Panel {
        series: from_above(lines(&|at| {
            units.outward(Quantity::Stiffness, at.critical_stiffness)
        })),
        marks: tops.collect(),
        zero_line: true,
        ..plot::Panel::new(title, x, plot::Axis::linear(critical))
    };
    plot::Drawing::columns(vec![vec![friction, stiffness]])
}

/// Without their far negative parts: where a law strengthens, k_c falls without bound and only says that all is stable.
fn from_above(mut curves: Vec<plot::PlotSeries>) -> Vec<plot::PlotSeries> {
    let top = curves.iter().flat_map(|curve| curve.y.iter().copied());
    let top = top.fold(0.0, f64::max);
    if top > 0.0 {
        for k in curves.iter_mut().flat_map(|curve| &mut curve.y) {
            if *k < -top {
                *k = f64::NAN;
            }
        }
    }
    curves
}
