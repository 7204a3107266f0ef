//! A return map's plan in words.

use super::super::plan::{Dimension, longest_in_words};
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
    let units = &plan.system.units;
    line(
        "dimension",
        match plan.dimension {
            Dimension::Single => "2: one interface, (tau, ln psi)",
            Dimension::Symmetric => {
                "2: psi1 = psi2 at the start, so the run stays in the symmetric subspace for ever"
            }
            Dimension::Full if plan.system.unequal.is_some() => {
                "3: the interfaces differ, (tau, ln psi1, ln psi2)"
            }
            Dimension::Full => "3: psi1 and psi2 differ, (tau, ln psi1, ln psi2)",
        }
        .into(),
    );
    line(
        "method",
        format!("{}: {}", plan.method.name(), plan.method.reason()),
    );
    line(
        "tolerances",
        format!(
            "rtol {:e}, atol {:e} on (tau, ln psi), at most {} steps{}",
            plan.tolerances.rtol,
            plan.tolerances.atol,
            count(plan.max_steps),
            longest_in_words(plan.tolerances, &plan.system.units)
        ),
    );
    line("section", section(plan));
    line(
        "returns",
        format!(
            "{} after {} that are skipped; a run that does not return for {} {} ends",
            plan.returns,
            plan.skip,
            units.outward(Quantity::Time, plan.patience),
            units.name(Quantity::Time)
        ),
    );
    line(
        "periodicity",
        format!(
            "by Newton's method on the return map, up to {LONGEST_PERIOD} returns: its periodic point must attract"
        ),
    );
    line("tangents", tangents(plan).into());
    line(
        "trajectory",
        "not stored: returns only, and some points between them for the tangents".into(),
    );
    text
}

fn section(plan: &SectionPlan) -> String {
    let units = &plan.system.units;
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
    let stress = units.outward(Quantity::Stress, plan.stress);
    let unit = units.name(Quantity::Stress);
    format!("stress {sense} through {stress} {unit}, {how}")
}

fn tangents(plan: &SectionPlan) -> &'static str {
    if plan.lyapunov {
        "on, for the Lyapunov exponents: ln |mu| / T of a periodic orbit; else carried by power series along a run of their own from the first return, at 1e-13, so that the error of the method is no bias"
    } else {
        "off but for the periodic point: `lyapunov` is not given"
    }
}
