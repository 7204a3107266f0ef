//! `twinslip fit --look`: what a record holds, without a fit.

use super::About;
use crate::Ending;
use crate::call::Call;
use crate::report::{begun, uncertain};
use serde_json::{Value, json};
use twinslip::error::Result;
use twinslip::number::Uncertain;
use twinslip_output::{Format, seven_digits};
use twinslip_tasks::scene::{FitOptions, Look, LookStretch, Quantity, Units};
use twinslip_tasks::views::{self, in_digits};

pub fn run(options: &FitOptions, call: &Call) -> Result<Ending> {
    let explain = || {
        "plan of this command\n  the record is read; steps of velocity are looked for in its displacement; nothing is fitted".to_owned()
    };
    let report = begun((&options.output, options.plot.as_deref()), call, explain)?;
    let look = Look::new(options)?;
    let about = About::of_record(&look.measured);
    if let Some(path) = &options.plot {
        report.draw(path, &views::picture_of_look(&look))?;
    }
    let columns = views::look_columns();
    let lines = lines(&look);
    let ending = if report.format == Format::Json {
        let mut result =
            json!({ "look": object(&look, &about.units), "notes": look.measured.notes });
        let rows = look.stretches.iter();
        let rows = rows.map(|row| Value::Object(views::object(&columns, row, &about.units)));
        result["rows"] = rows.collect();
        report.write(&report.envelope(&about, json!({}), result, json!({}), None))?
    } else if report.format == Format::Table && options.output.format.is_none() {
        return report.write((lines.join("\n") + "\n").as_bytes());
    } else {
        let mut remarks = report.remarks(&about, &Value::Null);
        remarks.extend(lines.iter().cloned());
        report.write_all(&about.units, remarks, &columns, &look.stretches)?
    };
    for line in lines {
        report.say(line);
    }
    Ok(ending)
}

/// `result.look`.
fn object(look: &Look, units: &Units) -> Value {
    let measured = &look.measured;
    let (from, to) = ends(&measured.times);
    let [shortest, median, longest] = look.intervals;
    let [mean, least, most] = look.friction;
    let number = |x: Option<Uncertain>| x.map(|x| uncertain(units, Quantity::Number, x));
    let rate = |of: &LookStretch| uncertain(units, Quantity::SlipRate, of.velocity);
    let columns = measured
        .taken
        .iter()
        .map(|one| json!({ "name": one.name, "unit": one.unit, "role": one.role.name() }));
    let left = measured.left.iter();
    let left = left.map(|name| json!({ "name": name, "unit": null, "role": null }));
    let gaps = measured.gaps.iter();
    let gaps = gaps.map(|(from, to)| json!({ "from": from, "to": to }));
    let steps = look.steps().map(|(before, after)| {
        json!({
            "time": after.span.0,
            "velocity_before": rate(before),
            "velocity_after": rate(after),
            "friction_before": number(before.settled),
            "friction_after": number(after.settled),
            "peak": number(after.peak_after(before.velocity.value)),
        })
    });
    let holds = look.holds().map(|(before, hold, after)| {
        json!({
            "start": hold.span.0,
            "duration": hold.span.1 - hold.span.0,
            "velocity_before": rate(before),
            "velocity_after": after.map(rate),
            "friction_before": number(before.settled),
            "minimum": number(hold.lowest),
            "peak": number(after.and_then(|after| after.highest)),
        })
    });
    json!({
        "columns": columns.chain(left).collect::<Vec<Value>>(),
        "samples": measured.times.len(),
        "from": from,
        "to": to,
        "duration": to - from,
        "sampling": { "interval": median, "shortest": shortest, "longest": longest, "rate": 1.0 / median },
        "gaps": gaps.collect::<Vec<Value>>(),
        "displacement": measured.displacement.as_deref().map(|x| x[x.len() - 1] - x[0]),
        "normal_stress": measured.normal_stress,
        "friction": { "mean": mean, "least": least, "largest": most, "noise": number(Some(look.noise)) },
        "steps": steps.collect::<Vec<Value>>(),
        "holds": holds.collect::<Vec<Value>>(),
    })
}

fn ends(times: &[f64]) -> (f64, f64) {
    (times[0], times[times.len() - 1])
}

/// In words, one a line.
fn lines(look: &Look) -> Vec<String> {
    let measured = &look.measured;
    let mut lines = vec![measured.taken_in_words()];
    if !measured.left.is_empty() {
        lines.push(format!(
            "columns that are not used: {}",
            measured.left.join(", ")
        ));
    }
    lines.extend(measured.notes.iter().cloned());
    let (from, to) = ends(&measured.times);
    let [shortest, median, longest] = look.intervals;
    let every = match longest > 1.5 * shortest {
        true => format!(
            "every {} s (from {} to {} s)",
            in_digits(median, 3),
            in_digits(shortest, 3),
            in_digits(longest, 3)
        ),
        false => format!("every {} s", in_digits(median, 3)),
    };
    lines.push(format!(
        "{} samples from {} to {} s, {every}, {} Hz",
        measured.times.len(),
        seven_digits(from),
        seven_digits(to),
        in_digits(1.0 / median, 3)
    ));
    let gaps = measured.gaps.iter();
    lines.extend(gaps.map(|(from, to)| {
        format!("a gap from {from} to {to} s: give a window on one side of it by --from and --to")
    }));
    if let Some(moved) = &measured.displacement {
        let gone = moved[moved.len() - 1] - moved[0];
        lines.push(format!(
            "the load point goes {} µm",
            in_digits(gone * 1e6, 4)
        ));
    }
    let [mean, least, most] = look.friction;
    lines.push(format!(
        "friction from {} to {}, {} on average; it scatters by {} from sample to sample",
        in_digits(least, 4),
        in_digits(most, 4),
        in_digits(mean, 4),
        in_digits(look.noise.value, 2)
    ));
    let (steps, holds) = (look.steps().count(), look.holds().count());
    let many = |n: usize| if n == 1 { "" } else { "s" };
    lines.push(match look.stretches.first() {
        None => "the motion of the load point is not known: no column is known as displacement, and there is no --program".into(),
        Some(first) => format!(
            "{steps} step{} of velocity and {holds} hold{}; the load point begins at {} µm/s",
            many(steps),
            many(holds),
            in_digits(first.velocity.value * 1e6, 3)
        ),
    });
    let told = |x: Option<Uncertain>| x.map_or("unknown".into(), |x| in_digits(x.value, 4));
    for (before, after) in look.steps() {
        lines.push(format!(
            "step at {} s from {} to {} µm/s: friction {} before, {} after, peak {}",
            seven_digits(after.span.0),
            in_digits(before.velocity.value * 1e6, 3),
            in_digits(after.velocity.value * 1e6, 3),
            told(before.settled),
            told(after.settled),
            told(after.peak_after(before.velocity.value))
        ));
    }
    for (before, hold, after) in look.holds() {
        lines.push(format!(
            "hold at {} s for {} s: friction {} before, minimum {}, peak {}",
            seven_digits(hold.span.0),
            in_digits(hold.span.1 - hold.span.0, 4),
            told(before.settled),
            told(hold.lowest),
            told(after.and_then(|after| after.highest))
        ));
    }
    lines
}
