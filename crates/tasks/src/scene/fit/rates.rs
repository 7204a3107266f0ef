//! Steady friction as it was measured at slip rates: a table beside a law.

use super::heading::Heading;
use super::roles::{Found, Role, columns_of};
use super::table::Table;
use super::unit::factor;
use crate::scene::units::{Quantity, Units};
use crate::scene::words::Kind;
use std::path::Path;
use twinslip::error::{Error, Result};
use twinslip::friction::positive;

/// Steady friction measured at a slip rate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeasuredFriction {
    /// In V*.
    pub slip_rate: f64,
    /// The friction coefficient.
    pub friction: f64,
    /// Its uncertainty, where the table has one.
    pub uncertainty: Option<f64>,
}

/// Reads a table of slip rates, friction coefficients and, if it has them, uncertainties, ascending by slip rate. Rates without a unit are in
/// the user's. Without a header these are its columns, in this order.
///
/// # Errors
/// [`Error::File`]; [`Error::Input`] for a table without such columns, for a rate that is not positive, for an uncertainty that is negative, and
/// for a unit of rates where the law is dimensionless.
pub(in crate::scene) fn measured_friction(
    path: &Path,
    units: &Units,
) -> Result<Vec<MeasuredFriction>> {
    let table = Table::read(path)?;
    let mut taken = Vec::new();
    let mut column = |role: Role, place: usize| {
        let found = match table.headings.is_empty() {
            true => Some(place).filter(|place| *place < table.width()),
            false => match columns_of(role, &table.headings, &taken) {
                Found::None => None,
                Found::One(one) => Some(one),
                Found::Several(all) => {
                    let names: Vec<String> = all.iter().map(|&at| table.name(at)).collect();
                    return Err(Error::Input(format!(
                        "`data` {}: the columns {} may each be the {}; leave one of them out",
                        table.file,
                        names.join(" and "),
                        role.name()
                    )));
                }
            },
        };
        taken.extend(found);
        Ok(found)
    };
    let needed = |place: Option<usize>, what: &str| {
        place.ok_or_else(|| {
            Error::Input(format!(
                "`data` {}: which column is the {what}? {}; name it {what}",
                table.file,
                table.seen()
            ))
        })
    };
    // An uncertainty of the friction has its name in it too.
    let uncertainty = column(Role::Uncertainty, 2)?;
    let rate = needed(column(Role::Velocity, 0)?, "slip rate")?;
    let friction = needed(column(Role::Friction, 1)?, "friction")?;
    let stated = table.headings.get(rate).and_then(Heading::stated);
    let scale = match stated {
        Some(unit) if units.si() => factor(Kind::Velocity, Some(unit), &table.name(rate))?,
        Some(unit) => {
            return Err(Error::Input(format!(
                "`data` {}: the slip rates are in {unit}, but the law is dimensionless; give `si`, or rates in V*",
                table.file
            )));
        }
        None => 1.0,
    };
    let rates = table.numbers(rate, "slip rate")?;
    let coefficients = table.numbers(friction, "friction")?;
    let uncertainties = match uncertainty {
        Some(at) => table
            .numbers(at, "uncertainty")?
            .into_iter()
            .map(Some)
            .collect(),
        None => vec![None; rates.len()],
    };
    let mut all = Vec::with_capacity(rates.len());
    for (i, ((v, mu), error)) in rates
        .into_iter()
        .zip(coefficients)
        .zip(uncertainties)
        .enumerate()
    {
        let here = |error: Error| {
            Error::Input(format!("`data` {}:{}: {error}", table.file, table.line(i)))
        };
        let v = positive("slip rate", v * scale).map_err(here)?;
        if error.is_some_and(|error| error < 0.0) {
            return Err(here(Error::Input(
                "the uncertainty must not be negative".into(),
            )));
        }
        all.push(MeasuredFriction {
            slip_rate: units.inward(Quantity::SlipRate, v),
            friction: mu,
            uncertainty: error,
        });
    }
    all.sort_by(|one, other| one.slip_rate.total_cmp(&other.slip_rate));
    Ok(all)
}
