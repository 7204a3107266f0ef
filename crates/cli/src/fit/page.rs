//! The page of a fit: all that is known of it, to be read in a browser.

use super::Fitted;
use super::steps::FittedStep;
use super::{object, posterior, records};
use crate::call::Call;
use crate::report::sundials;
use std::path::Path;
use twinslip::error::{Error, Result};
use twinslip::fit::FittedParameter;
use twinslip::number::between_in_log;
use twinslip_output::Place;
use twinslip_output::page::{Figure, Page, Table};
use twinslip_output::plot::{Area, Axis, Drawing, Panel, PlotSeries};
use twinslip_tasks::scene::FitPlan;
use twinslip_tasks::views::{
    FitRow, digits_of, in_digits, parameter_label, picture_of_fit, picture_of_holds,
    picture_of_parameters,
};

/// Points of the law.
const POINTS: usize = 200;
/// How far beyond the velocities of the record the law is drawn.
const BEYOND: f64 = 10.0;

/// The steady friction coefficient against the slip rate, with its 95 % band.
///
/// # Errors
/// Those of the law's steady state.
pub fn law_picture(plan: &FitPlan, fitted: &Fitted<'_>) -> Result<Drawing> {
    let rates = plan.recordings.iter().flat_map(|own| {
        let stretches = own.steps.stretches.iter();
        let ends = stretches.flat_map(|one| [one.velocity.0, one.velocity.1]);
        ends.chain([own.steps.before])
    });
    let rates = rates.filter(|v| *v > 0.0);
    let (low, high) = rates.fold((f64::INFINITY, 0.0_f64), |(low, high), v| {
        (low.min(v), high.max(v))
    });
    let part = |i: usize| i as f64 / (POINTS - 1) as f64;
    let grid = (0..POINTS).map(|i| between_in_log(low / BEYOND, high * BEYOND, part(i)));
    let grid: Vec<f64> = grid.collect();
    let band = fitted.law.steady_band(plan, fitted.fit(), &grid)?;
    let of = |i: usize| band.iter().map(|three| three[i]).collect::<Vec<f64>>();
    let band = Area {
        label: "95 % of the fit".into(),
        x: grid.clone(),
        lower: of(1),
        upper: of(2),
        colour: 0,
        // Where friction depends on what the data do not determine there is no band.
        left_out: band.iter().map(|three| !three[1].is_finite()).collect(),
    };
    let panel = Panel {
        series: vec![
            PlotSeries::new(&fitted.law.name, grid.clone(), of(0))
                .colour(0)
                .wide(),
        ],
        areas: vec![band],
        ..Panel::new(
            "steady-state friction",
            Axis::log("slip rate V [m/s]"),
            Axis::linear("friction coefficient μₛₛ"),
        )
    };
    Ok(Drawing::columns(vec![vec![panel]]))
}

/// What is known of the parameters: the draws where there are some, else profiles and ellipses.
pub fn parameters_picture(plan: &FitPlan, fitted: &Fitted<'_>) -> Drawing {
    match &fitted.drawn {
        Some(drawn) => posterior::picture(plan, fitted, drawn),
        None => picture_of_parameters(fitted.fit(), object::stress(plan, None)),
    }
}

/// Whether a page can have this name.
///
/// # Errors
/// [`Error::Input`] unless it ends in .html.
pub fn check_name(path: &Path) -> Result<()> {
    match path.extension() {
        Some(ending) if ending == "html" => Ok(()),
        _ => Err(Error::Input(format!(
            "`report` {}: the name must end in .html",
            path.display()
        ))),
    }
}

/// Writes the page.
///
/// # Errors
/// [`Error::File`], and those of [`law_picture`].
pub fn write(
    path: &Path,
    call: &Call,
    plan: &FitPlan,
    (found, steps): (&[Fitted<'_>], &[FittedStep]),
    rows: &[FitRow],
) -> Result<()> {
    let best = &found[0];
    let figure = |id: &str, title: &str, caption: &str, drawing: &Drawing| -> Result<Figure> {
        Ok(Figure {
            id: id.into(),
            title: title.into(),
            caption: caption.into(),
            alt: title.into(),
            svg: drawing.svg()?,
            ..Figure::default()
        })
    };
    let mut figures = vec![
        figure(
            "fig01",
            "Friction and residuals",
            "Measured friction with the fit; below, measured less fitted.",
            &picture_of_fit(rows, &best.law.name),
        )?,
        figure(
            "fig02",
            "Parameters",
            "Above each column how the sum of squares grows along a parameter, in standard errors, and the ends of its 95 % interval; \
             below, the ellipses that hold 68 and 95 % of each pair.",
            &picture_of_parameters(best.fit(), object::stress(plan, None)),
        )?,
    ];
    if best.drawn.is_some() {
        figures.push(figure(
            "posterior",
            "Posterior",
            "Above each column the distribution of a parameter by the draws, with its median and the values between which 95 % lie; below, the draws of each pair.",
            &parameters_picture(plan, best),
        )?);
    }
    if !best.holds.is_empty() {
        figures.push(figure(
            "holds",
            "Holds",
            "Healing, and the friction at the end of holds, against their duration.",
            &picture_of_holds(&best.holds),
        )?);
    }
    if plan.recordings.len() > 1 {
        figures.push(figure(
            "records",
            "Records",
            "What each record says of the parameters that they share, with 95 % intervals, and all of them together.",
            &records::picture(plan, best),
        )?);
    }
    figures.push(figure(
        "fig03",
        "Steady-state law",
        "The steady-state friction that follows, with its 95 % band.",
        &law_picture(plan, best)?,
    )?);
    let names = plan.recordings.iter().map(|own| own.name());
    let samples: usize = plan
        .recordings
        .iter()
        .map(|own| own.record.times.len())
        .sum();
    let page = Page {
        title: format!("Fit of {}", names.collect::<Vec<_>>().join(", ")),
        lead: object::lines(plan, found, steps),
        facts: vec![
            ("verdict".into(), best.fit().verdict.name().into()),
            ("samples".into(), samples.to_string()),
            (
                "effective sample size".into(),
                format!("{:.0}", best.fit().effective_samples),
            ),
            (
                "residuals, root mean square".into(),
                in_digits(best.fit().rms, 3),
            ),
        ],
        figures,
        tables: vec![parameters(plan, best), correlations(best)],
        manifest: vec![
            ("version".into(), env!("CARGO_PKG_VERSION").into()),
            ("command".into(), call.words.join(" ")),
            (
                "SUNDIALS".into(),
                sundials().unwrap_or_else(|| "not built in".into()),
            ),
        ],
        ..Page::default()
    };
    Place::File(path.to_owned())
        .write(page.html().as_bytes())
        .map_err(|error| Error::File {
            action: "write",
            path: path.to_owned(),
            reason: error.to_string(),
        })
}

fn parameters(plan: &FitPlan, fitted: &Fitted<'_>) -> Table {
    let rows = fitted.fit().parameters.iter().map(|one| {
        let stress = object::stress(plan, one.of_record);
        let (label, by) = parameter_label(&one.name, stress.is_some());
        let by = by * stress.filter(|_| one.name == "stiffness").unwrap_or(1.0);
        let digits = digits_of(one);
        let number = |x: f64| match (x * by).is_finite() {
            true => in_digits(x * by, digits),
            false => "none".into(),
        };
        vec![
            one.label(),
            label,
            match fitted.fit().verdict.has_run_away(one) {
                true => "not determined".into(),
                false => number(one.value),
            },
            match one.uncertainty.is_finite() {
                true => in_digits(one.uncertainty * by, 2),
                false => "none".into(),
            },
            number(one.interval.0),
            number(one.interval.1),
            format!("{:.2}", one.widening),
        ]
    });
    Table {
        id: "table1".into(),
        title: "Parameters".into(),
        caption: "Standard errors are those of noise as the residuals show it; the last column says how many times larger they are than those of white noise.".into(),
        columns: ["parameter", "symbol", "value", "standard error", "95 % from", "to", "widening"]
            .map(String::from)
            .to_vec(),
        rows: rows.collect(),
        ..Table::default()
    }
}

fn correlations(fitted: &Fitted<'_>) -> Table {
    let parameters = &fitted.fit().parameters;
    let names = parameters.iter().map(FittedParameter::label);
    let rows = parameters.iter().enumerate().map(|(i, one)| {
        let each =
            (0..parameters.len()).map(|j| format!("{:.3}", fitted.fit().correlation[(i, j)]));
        std::iter::once(one.label()).chain(each).collect()
    });
    Table {
        id: "table2".into(),
        title: "Correlation".into(),
        caption: "Of logarithms where parameters are positive.".into(),
        columns: std::iter::once(String::new()).chain(names).collect(),
        rows: rows.collect(),
        ..Table::default()
    }
}
