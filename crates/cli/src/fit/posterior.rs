//! The posterior of a fit: as an object, in lines, and as a picture of its draws.

use super::{Drawn, Fitted, object};
use serde_json::{Map, Value, json};
use twinslip::fit::{FittedParameter, Marginal, Prior, QUANTILES};
use twinslip_output::plot::{Axis, Drawing, Mark, Panel, PlotSeries, Stroke, Symbol};
use twinslip_tasks::scene::FitPlan;
use twinslip_tasks::views::{in_digits, label_of};

/// Draws that a picture shows of each pair, and bars of a histogram.
const SHOWN: usize = 1000;
const BARS: usize = 30;

/// `result.posterior`
pub fn object(plan: &FitPlan, fitted: &Fitted<'_>, drawn: &Drawn) -> Value {
    let posterior = &drawn.posterior;
    let parameters = fitted.fit().parameters.iter().enumerate();
    let each = parameters.map(|(j, one)| {
        let (factor, unit) = object::unit(plan, &one.name, one.of_record);
        let marginal = &posterior.marginals[j];
        let (middle, ends) = marginal.effective_sizes;
        let names = QUANTILES.iter().map(f64::to_string);
        let quantiles = names.zip(marginal.quantiles.map(|x| json!(x * factor)));
        let draws = posterior.draws.column(j);
        let mut object = json!({
            "name": one.name,
            "unit": unit,
            "prior": prior(drawn.sampling.priors[j], factor),
            "mean": marginal.mean * factor,
            "standard_deviation": marginal.deviation * factor,
            "quantiles": quantiles.collect::<Map<String, Value>>(),
            "r_hat": marginal.r_hat,
            "effective_sample_size": middle,
            "effective_sample_size_of_ends": ends,
            "draws": draws.iter().map(|x| x * factor).collect::<Vec<f64>>(),
        });
        if let Some(at) = one.of_record {
            object["record"] = json!(at + 1);
        }
        object
    });
    let of = |of: &dyn Fn(&Marginal) -> f64| posterior.marginals.iter().map(of).collect::<Vec<_>>();
    let least = of(&|one| one.effective_sizes.0.min(one.effective_sizes.1));
    json!({
        "draws": posterior.draws.nrows(),
        "chains": posterior.chains,
        "seed": drawn.sampling.seed,
        "effective_sample_size": least.into_iter().fold(f64::INFINITY, f64::min),
        "r_hat": of(&|one| one.r_hat).into_iter().fold(0.0, f64::max),
        "divergences": posterior.divergences,
        "minima": drawn.minima,
        "verdict": if posterior.undecided.is_empty() { "converged" } else { "undecided" },
        "undecided": posterior.undecided,
        "parameters": each.collect::<Vec<_>>(),
    })
}

/// As one gives it.
fn prior(prior: Prior, factor: f64) -> String {
    match prior {
        Prior::Normal { mean, deviation } => {
            format!("normal:{}:{}", mean * factor, deviation * factor)
        }
        Prior::Uniform { low, high } => format!("uniform:{}:{}", low * factor, high * factor),
        Prior::LogUniform { low, high } => {
            format!("log-uniform:{}:{}", low * factor, high * factor)
        }
    }
}

/// In words, one a line.
pub fn lines(plan: &FitPlan, fitted: &Fitted<'_>, drawn: &Drawn) -> Vec<String> {
    let posterior = &drawn.posterior;
    let all = posterior.marginals.iter();
    let least = all
        .clone()
        .map(|one| one.effective_sizes.0.min(one.effective_sizes.1));
    let worst = all.map(|one| one.r_hat).fold(0.0, f64::max);
    let mut lines = vec![format!(
        "posterior by {} draws in {} chains: at least {:.0} effective draws, R-hat at most {worst:.4}, {} divergences",
        posterior.draws.nrows(),
        posterior.chains,
        least.fold(f64::INFINITY, f64::min),
        posterior.divergences
    )];
    if drawn.minima > 1 {
        lines.push(format!(
            "the sum of squares has {} minima that the data do not tell apart; chains begin at each of them",
            drawn.minima
        ));
    }
    for (one, marginal) in fitted.fit().parameters.iter().zip(&posterior.marginals) {
        let (factor, unit) = object::unit(plan, &one.name, one.of_record);
        let unit = if unit == "1" {
            String::new()
        } else {
            format!(" {unit}")
        };
        let [low, _, middle, _, high] = marginal.quantiles.map(|x| x * factor);
        let digits = (middle.abs() / (high - low)).log10().floor() + 3.0;
        let digits = if digits.is_finite() {
            digits.clamp(2.0, 15.0) as usize
        } else {
            5
        };
        let number = |x: f64| in_digits(x, digits);
        lines.push(format!(
            "{}: median {}{unit}, 95 % of draws from {} to {}{unit}",
            marginal.label,
            number(middle),
            number(low),
            number(high)
        ));
    }
    lines.extend(posterior.undecided.iter().cloned());
    lines
}

/// The distribution of each parameter, and below it the draws of it with those that follow.
pub fn picture(plan: &FitPlan, fitted: &Fitted<'_>, drawn: &Drawn) -> Drawing {
    let parameters = &fitted.fit().parameters;
    let draws = &drawn.posterior.draws;
    let label = |one: &FittedParameter| label_of(one, object::stress(plan, one.of_record));
    let stride = draws.nrows().div_ceil(SHOWN).max(1);
    let columns = parameters.iter().enumerate().map(|(i, one)| {
        let (x_label, x_by) = label(one);
        let values: Vec<f64> = draws.column(i).iter().map(|x| x * x_by).collect();
        let marginal = &drawn.posterior.marginals[i];
        let mut column = vec![Panel {
            marks: [0, 2, 4]
                .map(|k| {
                    let symbol = if k == 2 {
                        Symbol::Circle
                    } else {
                        Symbol::Diamond
                    };
                    Mark::new(marginal.quantiles[k] * x_by, 0.0, "")
                        .symbol(symbol)
                        .colour(1)
                })
                .into(),
            ..histogram(&values, &marginal.label, &x_label)
        }];
        let thin = |j: usize, by: f64| {
            let all = draws.column(j);
            (0..all.len())
                .step_by(stride)
                .map(|k| all[k] * by)
                .collect::<Vec<f64>>()
        };
        let pairs = parameters.iter().enumerate().skip(i + 1);
        column.extend(pairs.map(|(j, other)| {
            let (y_label, y_by) = label(other);
            Panel {
                series: vec![PlotSeries::dots("", thin(i, x_by), thin(j, y_by)).colour(0)],
                ..Panel::new("", Axis::linear(x_label.clone()), Axis::linear(y_label))
            }
        }));
        column
    });
    Drawing::columns(columns.collect())
}

fn histogram(values: &[f64], title: &str, label: &str) -> Panel {
    let (low, high) = values
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &x| {
            (low.min(x), high.max(x))
        });
    let width = (high - low) / BARS as f64;
    let mut counts = vec![0.0; BARS];
    for x in values {
        let bar = ((x - low) / width) as usize;
        counts[bar.min(BARS - 1)] += 1.0;
    }
    let most = counts.iter().fold(1.0, |most: f64, own| most.max(*own));
    let (mut x, mut y) = (vec![low], vec![0.0]);
    for (k, count) in counts.iter().enumerate() {
        let left = low + width * k as f64;
        x.extend([left, left + width]);
        y.extend([count / most, count / most]);
    }
    x.push(high);
    y.push(0.0);
    let series = PlotSeries::new("", x, y).stroke(Stroke::Solid).colour(0);
    Panel {
        series: vec![series],
        ..Panel::new(
            title,
            Axis::linear(label),
            Axis::linear("density, of its largest"),
        )
    }
}
