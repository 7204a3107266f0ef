//! From a laboratory's file to a record: which columns, in which units, which window.

use super::heading::Heading;
use super::options::FitOptions;
use super::sizes;
use super::table::Table;
use super::unit::factor;
use crate::scene::words::Kind;
use std::path::Path;
use twinslip::error::{Error, Result};
use twinslip::friction::positive;

/// Fewer samples are no record.
const FEWEST: usize = 20;
/// A sample that comes so many times later than its neighbours do is behind a gap.
const GAP: f64 = 50.0;

const TIMES: &[&str] = &["time", "t", "elapsed", "times"];
const DISPLACEMENTS: &[&str] = &[
    "displacement",
    "displ",
    "disp",
    "loadpoint",
    "loadpointdisplacement",
    "lp",
    "position",
    "shearslip",
    "x",
];
/// In names of what moves across the fault.
const ACROSS: &[&str] = &["normal", "vertical", "horizontal", "dilat", "compaction"];
const FRICTIONS: &[&str] = &[
    "friction",
    "mu",
    "frictioncoefficient",
    "coefficient",
    "μ",
    "shearnormal",
    "shearstress",
    "tau",
];
const NORMAL_STRESSES: &[&str] = &[
    "effectivenormalstress",
    "effnormalstress",
    "normalstress",
    "normal",
    "sigman",
    "sigma",
];

/// Whether a name is one of those that columns are found by.
pub(super) fn is_known(heading: &Heading) -> bool {
    let all = [TIMES, DISPLACEMENTS, FRICTIONS, NORMAL_STRESSES].concat();
    let known = |own: &String| {
        let same = |name: &&str| own == name || name.len() > 2 && own.contains(name);
        all.iter().any(same)
    };
    heading.plain_names().iter().any(known)
}

/// What was measured, in SI.
#[derive(Debug, Clone, PartialEq)]
pub struct Measured {
    /// In s, as in the file.
    pub times: Vec<f64>,
    /// Of the load point in m, where it was recorded.
    pub displacement: Option<Vec<f64>>,
    /// The friction coefficient.
    pub friction: Vec<f64>,
    /// By which squares of residuals are multiplied; their mean is 1.
    pub weights: Vec<f64>,
    /// sigma in Pa, where it is known.
    pub normal_stress: Option<f64>,
    /// The file.
    pub file: String,
    /// The names of the columns that were taken: time, displacement, friction, normal stress.
    pub columns: [Option<String>; 4],
    /// What was made of the columns that a user may not have meant, a sentence each.
    pub notes: Vec<String>,
    /// The columns of the file, in words.
    pub seen: String,
}

impl Measured {
    /// Reads a file that the options name.
    ///
    /// # Errors
    /// [`Error::File`]; [`Error::Input`] for what is no record: columns that are not there, numbers that are none, times that run back,
    /// gaps, too few samples.
    pub fn read(path: &Path, options: &FitOptions) -> Result<Self> {
        let table = Table::read(path)?;
        let mut taken = Vec::new();
        let mut find = |asked: &Option<String>, option: &str, names: &[&str], others: &[&str]| {
            let found = match asked {
                Some(column) => Some(table.asked(option, column)?),
                None => table.like(names, others, &taken),
            };
            taken.extend(found);
            Ok::<_, Error>(found)
        };
        let time = find(&options.time, "time", TIMES, &[])?;
        // Before the normal stress: `shear/normal` has both names.
        let friction = find(&options.friction, "friction", FRICTIONS, &[])?;
        let asked = &options.displacement;
        let displacement = find(asked, "displacement", DISPLACEMENTS, ACROSS)?;
        let asked = &options.normal_stress_column;
        let others = ["displ", "disp", "strain"];
        let normal = find(asked, "normal_stress_column", NORMAL_STRESSES, &others)?;
        let needed = |place: Option<usize>, option: &str| {
            place.ok_or_else(|| {
                Error::Input(format!(
                    "{}: which column is the {option}? {}; say so by `{option}`",
                    table.file,
                    table.seen()
                ))
            })
        };
        let (time, friction) = (needed(time, "time")?, needed(friction, "friction")?);
        // A unit that is asked for holds over that of the header.
        let asked_unit = |place: usize| {
            let asked = [
                (Some(time), &options.time),
                (displacement, &options.displacement),
                (Some(friction), &options.friction),
                (normal, &options.normal_stress_column),
            ];
            let mut own = asked.into_iter().filter(|(at, _)| *at == Some(place));
            own.find_map(|(_, text)| Heading::of(text.as_deref()?).unit)
        };
        let unit = |place: usize, kind: Kind| -> Result<Option<f64>> {
            let heading = table.headings.get(place);
            let name = heading.map_or("", |one| &one.name);
            let explicit = asked_unit(place).or(heading.and_then(|one| one.unit.clone()));
            if explicit.is_some() {
                return factor(kind, explicit.as_deref(), name).map(Some);
            }
            let suffix = heading.and_then(Heading::stated);
            Ok(suffix.and_then(|unit| factor(kind, Some(unit), name).ok()))
        };
        let column = |place: usize, what: &str, kind: Kind| -> Result<Vec<f64>> {
            let size = unit(place, kind)?.unwrap_or(1.0);
            let numbers = table.numbers(place, what)?;
            Ok(numbers.into_iter().map(|x| x * size).collect())
        };
        let times = column(time, "time", Kind::Time)?;
        ascend(&table, &times)?;
        let rows = window(options, &table, &times)?;
        let cut = |all: Vec<f64>| -> Vec<f64> { rows.iter().map(|&row| all[row]).collect() };
        let mean = |all: &Vec<f64>| all.iter().sum::<f64>() / all.len() as f64;
        let name = |place: usize| {
            let heading = table.headings.get(place);
            heading.map_or((place + 1).to_string(), |one| one.name.clone())
        };
        let mut notes = Vec::new();
        let given = options.normal_stress;
        let given = given.map(|x| positive("normal-stress", x)).transpose()?;
        let of_shear = unit(friction, Kind::Stress).ok().flatten();
        let normal_stress = match normal {
            Some(place) => {
                let mut values = cut(column(place, "normal stress", Kind::Stress)?);
                let own = format!("{}: the normal stress, column {}", table.file, name(place));
                let is_stated = unit(place, Kind::Stress)?.is_some();
                match of_shear.filter(|_| !is_stated) {
                    Some(factor) => {
                        values.iter_mut().for_each(|sigma| *sigma *= factor);
                        notes.push(format!(
                            "{own}, states no unit and is taken in that of the shear stress"
                        ));
                    }
                    None if given.is_none() => {
                        sizes::normal_stress(mean(&values), &own, is_stated)?;
                    }
                    None => {}
                }
                Some(values)
            }
            None => None,
        };
        let friction_values = if of_shear.is_some() {
            let shear = cut(column(friction, "shear stress", Kind::Stress)?);
            let by = |i: usize| {
                match (given, &normal_stress) {
                (Some(sigma), _) => Ok(sigma),
                (None, Some(column)) => Ok(column[i]),
                (None, None) => Err(Error::Input(
                    "`friction` is a stress: give the `normal_stress`, or the `normal_stress_column`"
                        .into(),
                )),
            }
            };
            let ratios = shear.iter().enumerate();
            ratios
                .map(|(i, tau)| Ok(tau / by(i)?))
                .collect::<Result<_>>()?
        } else {
            cut(column(friction, "friction", Kind::Number)?)
        };
        let weights = match &options.weights {
            None => vec![1.0; rows.len()],
            Some(name) => normalised(cut(table.numbers(table.asked("weights", name)?, "weight")?))?,
        };
        let line = |i: usize| format!("{}:{}", table.file, table.line(rows[i]));
        sizes::friction(&friction_values, &name(friction), line)?;
        let times = cut(times);
        let displacement_values = match displacement {
            None => None,
            Some(place) => {
                let mut moved = cut(column(place, "displacement", Kind::Length)?);
                let is_stated = unit(place, Kind::Length)?.is_some();
                let own = format!("{}: the displacement, column {}", table.file, name(place));
                notes.extend(sizes::displacement(&times, &mut moved, &own, is_stated)?);
                Some(moved)
            }
        };
        Ok(Measured {
            file: table.file.clone(),
            displacement: displacement_values,
            friction: friction_values,
            weights,
            normal_stress: given.or_else(|| normal_stress.as_ref().map(mean)),
            columns: [Some(time), displacement, Some(friction), normal].map(|one| one.map(name)),
            times,
            notes,
            seen: table.seen(),
        })
    }
}

/// # Errors
/// [`Error::Input`] for times that do not ascend, and gaps between them.
fn ascend(table: &Table, times: &[f64]) -> Result<()> {
    for (row, pair) in times.windows(2).enumerate() {
        if pair[1] <= pair[0] {
            return Err(Error::Input(format!(
                "{}:{}: the time {} must be after {}, that of the row before",
                table.file,
                table.line(row + 1),
                pair[1],
                pair[0]
            )));
        }
    }
    Ok(())
}

/// The rows of the window, thinned, without gaps.
fn window(options: &FitOptions, table: &Table, times: &[f64]) -> Result<Vec<usize>> {
    if options.decimate == 0 {
        return Err(Error::parameter("decimate", 0, "at least 1"));
    }
    let from = options.from.unwrap_or(f64::NEG_INFINITY);
    let to = options.to.unwrap_or(f64::INFINITY);
    let inside = (0..times.len()).filter(|&row| (from..=to).contains(&times[row]));
    let rows: Vec<usize> = inside.step_by(options.decimate).collect();
    if rows.len() < FEWEST {
        let (first, last) = (times[0], times[times.len() - 1]);
        return Err(Error::Input(format!(
            "{}: the window has {} samples, but must have at least {FEWEST}; the record goes from {first} to {last} s, {} rows",
            table.file,
            rows.len(),
            table.len()
        )));
    }
    let spacing = |i: usize| times[rows[i + 1]] - times[rows[i]];
    for i in 1..rows.len().saturating_sub(2) {
        let usual = f64::max(spacing(i - 1), spacing(i + 1));
        if spacing(i) > GAP * usual {
            return Err(Error::Input(format!(
                "{}:{}: a gap of {} s before this row, {:.0} times as long as its neighbours; give a window on one side of it by `from` and `to`",
                table.file,
                table.line(rows[i + 1]),
                spacing(i),
                spacing(i) / usual
            )));
        }
    }
    Ok(rows)
}

/// # Errors
/// [`Error::Input`] for a weight that is negative, and where all are zero.
fn normalised(weights: Vec<f64>) -> Result<Vec<f64>> {
    if let Some(negative) = weights.iter().find(|&&weight| weight < 0.0) {
        return Err(Error::Input(format!(
            "`weights`: {negative} must be zero or positive"
        )));
    }
    let mean = weights.iter().sum::<f64>() / weights.len() as f64;
    if mean > 0.0 {
        Ok(weights.into_iter().map(|weight| weight / mean).collect())
    } else {
        Err(Error::Input("`weights`: all are zero".into()))
    }
}
