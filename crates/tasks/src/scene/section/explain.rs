//! A return map's plan in words.

use super::super::plan::{dimension_in_words, longest_in_words, tolerance_in_words};
use super::super::system::Described;
use super::super::units::Quantity;
use super::SectionPlan;
use std::fmt::Write;
use twinslip::error::count;
use twinslip::integrate::HasSeries;
use twinslip::number::polynomial::Crossing;
use twinslip::section::LONGEST_PERIOD;

/// The plan, one subject a line.
pub fn explain_section(plan: &SectionPlan) -> String {
    let mut text = String::from("plan of this return map\n");
    let mut line = |subject: &str, words: String| {
        writeln!(text, "  {subject:<18}{words}").expect("writing to a string");
    };
    let units = plan.system.units();
    line(
        "dimension",
        dimension_in_words(&plan.system, plan.subspace, &plan.start),
    );
    line(
        "method",
        format!("{}: {}", plan.method.name(), plan.method.reason()),
    );
    if let Some(words) = plan.system.formulas_in_words() {
        line("formulas", words);
    }
    line(
        "tolerances",
        format!(
            "rtol {:e}, {}, at most {} steps{}",
            plan.tolerances.rtol,
            tolerance_in_words(&plan.system, plan.tolerances.atol, &plan.told_atol()),
            count(plan.max_steps),
            longest_in_words(plan.tolerances, units)
        ),
    );
    line("section", section(plan));
    let unit = match units.name(Quantity::Time) {
        "1" => String::new(),
        unit => format!(" {unit}"),
    };
    line(
        "returns",
        format!(
            "{} after {} skipped; a run that does not return for {}{unit} ends",
            plan.returns,
            plan.skip,
            units.outward(Quantity::Time, plan.patience),
        ),
    );
    line(
        "periodicity",
        format!(
            "Newton's method on the return map, up to period {LONGEST_PERIOD}; the periodic point must be attracting"
        ),
    );
    line("tangents", tangents(plan).into());
    line(
        "trajectory",
        "not stored: only returns, and some points between them for the tangents".into(),
    );
    text
}

fn section(plan: &SectionPlan) -> String {
    if plan.system.forcing_period().is_some() {
        return format!(
            "stroboscopic, at the phase {} of the forcing",
            plan.outward_value()
        );
    }
    let sense = match plan.direction {
        Crossing::Downwards => "falling",
        Crossing::Upwards | Crossing::Touching => "rising",
    };
    let how = match plan.method.series() {
        HasSeries::Always => "by the roots of the series' polynomials",
        HasSeries::Sometimes => {
            "by the roots of the series' polynomials; on the dense output of the steps that have none"
        }
        HasSeries::Never => "by root finding on the dense output",
    };
    let unit = plan.system.units().name(plan.system.quantity(plan.state));
    let unit = match unit {
        "1" => String::new(),
        unit => format!(" {unit}"),
    };
    let (state, value) = (plan.state_name(), plan.outward_value());
    format!("{state} {sense} through {value}{unit}, {how}")
}

fn tangents(plan: &SectionPlan) -> &'static str {
    if plan.lyapunov {
        "on, for the Lyapunov exponents: ln |mu| / T of a periodic orbit; otherwise by power series along a separate run from the first return, with tolerance 1e-13, so that the error of the method adds no bias"
    } else {
        "only for the periodic point: `lyapunov` is not given"
    }
}
