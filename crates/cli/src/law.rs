//! `twinslip law`.

use super::Ending;
use super::call::Call;
use super::report::{self, Report};
use serde_json::{Map, Value, json};
use twinslip::error::{Error, Result};
use twinslip::friction::ExtremumKind;
use twinslip::number::Uncertain;
use twinslip_output::Format;
use twinslip_tasks::scene::{
    Column, LawCurve, LawOptions, LawPlan, LawPoint, MeasuredFriction, Quantity, Together, Units,
};
use twinslip_tasks::views;

pub fn run(options: &LawOptions, call: &Call) -> Result<Ending> {
    let plan = LawPlan::new(options)?;
    let outputs = (&options.output, options.plot.as_deref());
    let report = report::begun(outputs, call, || plan.explain())?;
    let compared = plan.compared()?;
    let (curves, failure) = plan.curves()?;
    if let Some(path) = &options.plot {
        let units = plan.system().units();
        report.draw(path, &views::picture_of_law(units, &curves, &plan.measured))?;
    }
    let ending = write(&plan, &report, (&curves, &compared), failure.as_ref())?;
    failure.map_or(Ok(ending), Err)
}

/// What laws are known by, in the user's units; of two interfaces each with its number.
struct Landmarks {
    extrema: Vec<Value>,
    maxima: Vec<Value>,
    transitions: Vec<Value>,
}

impl Landmarks {
    fn of(curves: &[LawCurve], units: &Units) -> Self {
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
fn at_driving(
    curves: &[LawCurve],
    together: Together,
    columns: &[Column<LawPoint>],
    units: &Units,
) -> Vec<Map<String, Value>> {
    let object = |curve: &LawCurve| {
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

/// `result.data`: what was measured beside the law.
fn data(compared: &[(MeasuredFriction, Option<f64>)], units: &Units) -> Value {
    let each = compared.iter().map(|(one, law)| {
        json!({
            "rate": units.outward(Quantity::SlipRate, one.slip_rate),
            "friction": one.friction,
            "uncertainty": one.uncertainty,
            "law": law,
        })
    });
    each.collect()
}

/// How far the law is from what was measured, in words.
fn compared_in_words(compared: &[(MeasuredFriction, Option<f64>)]) -> Option<String> {
    let off = compared.iter();
    let off: Vec<(f64, Option<f64>)> = off
        .filter_map(|(one, law)| Some((one.friction - (*law)?, one.uncertainty)))
        .collect();
    let count = off.len() as f64;
    let rms = (off.iter().map(|(off, _)| off * off).sum::<f64>() / count).sqrt();
    let within = off
        .iter()
        .filter(|(off, error)| error.is_some_and(|error| off.abs() <= error));
    let errors = off.iter().all(|(_, error)| error.is_some());
    let within = match errors {
        true => format!("; {} are within their uncertainty", within.count()),
        false => String::new(),
    };
    (!off.is_empty()).then(|| {
        format!(
            "measured friction at {count} slip rates differs from the law by {} (root mean square){within}",
            views::in_digits(rms, 3)
        )
    })
}

fn write(
    plan: &LawPlan,
    report: &Report<'_>,
    (curves, compared): (&[LawCurve], &[(MeasuredFriction, Option<f64>)]),
    failure: Option<&Error>,
) -> Result<Ending> {
    let (system, together) = (plan.system(), plan.together);
    let units = system.units();
    let columns = &views::law_columns(curves.len() > 1)[..];
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
        if !compared.is_empty() {
            result["data"] = data(compared, units);
        }
        if let Some(at_driving) = at_driving {
            result["at_driving"] = json!(at_driving);
        }
        if let Some(ratio) = over_maximum {
            result["stiffness_over_critical_maximum"] = json!(ratio);
        }
        let bytes = report.envelope(system, json!({}), result, work, failure);
        return report.write(&bytes);
    }
    let mut found = landmarks.lines();
    found.extend(compared_in_words(compared));
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
