//! From a laboratory's file to a record: which columns, in which units, which window.

use super::columns::Columns;
use super::options::FitOptions;
use super::roles::Role;
use super::sizes;
use super::table::Table;
use crate::scene::words::Kind;
use std::path::Path;
use twinslip::error::{Error, Result};
use twinslip::friction::positive;

/// Fewer samples are no record.
const FEWEST: usize = 20;
/// A sample that comes so many times later than its neighbours do is behind a gap.
const GAP: f64 = 50.0;

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
    /// What each of the columns was taken to be.
    pub taken: Vec<TakenColumn>,
    /// The columns that were not.
    pub left: Vec<String>,
    /// What was made of the columns that a user may not have meant, a sentence each.
    pub notes: Vec<String>,
    /// The columns of the file, in words.
    pub seen: String,
    /// From when to when there are no samples, in s: none in a record that is fitted.
    pub gaps: Vec<(f64, f64)>,
}

/// A column of a file, and what it was taken to be.
#[derive(Debug, Clone, PartialEq)]
pub struct TakenColumn {
    /// Its name.
    pub name: String,
    /// What it was taken to measure.
    pub role: Role,
    /// The unit that its numbers were taken in, as it was written; none where it states none.
    pub unit: Option<String>,
}

impl Measured {
    /// Reads a file that the options name.
    ///
    /// # Errors
    /// [`Error::File`]; [`Error::Input`] for what is no record: columns that are not there, numbers that are none, times that run back,
    /// gaps, too few samples.
    pub fn read(path: &Path, options: &FitOptions) -> Result<Self> {
        let measured = Self::with_gaps(path, options, options.program.is_none())?;
        match measured.gaps.first() {
            None => Ok(measured),
            Some((from, to)) => Err(Error::Input(format!(
                "{}: a gap from {from} to {to} s, more than {GAP:.0} times as long as its neighbours; give a window on one side of it by `from` and `to`",
                measured.file
            ))),
        }
    }

    /// The same where a record may have gaps; `moves` is whether a displacement must be known where several columns may be it.
    ///
    /// # Errors
    /// Those of [`Measured::read`] but for gaps.
    pub(super) fn with_gaps(path: &Path, options: &FitOptions, moves: bool) -> Result<Self> {
        let table = Table::read(path)?;
        let columns = Columns::of(options, &table, moves)?;
        let mut notes = columns.notes.clone();
        let times = columns.times(&table)?;
        ascend(&table, &times)?;
        let rows = window(options, &table, &times)?;
        let cut = |all: Vec<f64>| -> Vec<f64> { rows.iter().map(|&row| all[row]).collect() };
        let mean = |all: &Vec<f64>| all.iter().sum::<f64>() / all.len() as f64;
        let of =
            |place: usize, what: &str, kind: Kind| columns.numbers(&table, (place, what, kind));
        let given = options.normal_stress;
        let given = given.map(|x| positive("normal-stress", x)).transpose()?;
        let friction = columns.friction;
        let of_shear = columns.unit(&table, friction, Kind::Stress).ok().flatten();
        let normal_stress = match columns.normal_stress {
            Some(place) => {
                let mut values = cut(of(place, "normal stress", Kind::Stress)?);
                let own = format!(
                    "{}: the normal stress, column {}",
                    table.file,
                    table.name(place)
                );
                let is_stated = columns.unit(&table, place, Kind::Stress)?.is_some();
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
            let shear = cut(of(friction, "shear stress", Kind::Stress)?);
            ratios(shear, given, normal_stress.as_deref(), |i| {
                format!("{}:{}", table.file, table.line(rows[i]))
            })?
        } else {
            cut(of(friction, "friction", Kind::Number)?)
        };
        let weights = match &options.weights {
            None => vec![1.0; rows.len()],
            Some(name) => normalised(cut(table.numbers(table.asked("weights", name)?, "weight")?))?,
        };
        let line = |i: usize| format!("{}:{}", table.file, table.line(rows[i]));
        sizes::friction(&friction_values, &table.name(friction), line)?;
        let times = cut(times);
        let displacement = match (columns.displacement, columns.velocity) {
            (None, None) => None,
            (Some(place), _) => {
                let mut moved = cut(of(place, "displacement", Kind::Length)?);
                let is_stated = columns.unit(&table, place, Kind::Length)?.is_some();
                let own = format!(
                    "{}: the displacement, column {}",
                    table.file,
                    table.name(place)
                );
                notes.extend(sizes::displacement(&times, &mut moved, &own, is_stated)?);
                Some(moved)
            }
            (None, Some(place)) => {
                let velocities = cut(of(place, "velocity", Kind::Velocity)?);
                let is_stated = columns.unit(&table, place, Kind::Velocity)?.is_some();
                let own = format!("{}: the velocity, column {}", table.file, table.name(place));
                let mut moved = integrated(&times, &velocities);
                notes.push(format!("{own}, is integrated, as there is no displacement"));
                notes.extend(sizes::displacement(&times, &mut moved, &own, is_stated)?);
                Some(moved)
            }
        };
        let name = |place: usize| table.name(place);
        Ok(Measured {
            file: table.file.clone(),
            displacement,
            friction: friction_values,
            weights,
            normal_stress: given.or_else(|| normal_stress.as_ref().map(mean)),
            columns: [
                Some(columns.time),
                columns.displacement,
                Some(friction),
                columns.normal_stress,
            ]
            .map(|one| one.map(name)),
            taken: columns.taken(&table),
            left: columns.left(&table),
            gaps: gaps(&times),
            times,
            notes,
            seen: table.seen(),
        })
    }

    /// What the columns were taken to be, in one sentence.
    pub fn taken_in_words(&self) -> String {
        let unit = |one: &TakenColumn| match &one.unit {
            Some(unit) => format!(" [{unit}]"),
            None => String::new(),
        };
        let each = self.taken.iter();
        let each: Vec<String> = each
            .map(|one| format!("{} from {:?}{}", one.role.name(), one.name, unit(one)))
            .collect();
        format!("{}: {}", self.file, each.join(", "))
    }
}

/// Shear stress over normal stress; `line` says where a sample is.
fn ratios(
    shear: Vec<f64>,
    given: Option<f64>,
    normal: Option<&[f64]>,
    line: impl Fn(usize) -> String,
) -> Result<Vec<f64>> {
    let over = |(i, tau): (usize, f64)| {
        let sigma = given.or(normal.map(|all| all[i])).ok_or_else(|| {
            Error::Input(
                "`friction` is a stress: give the `normal_stress`, or the `normal_stress_column`"
                    .into(),
            )
        })?;
        match sigma > 0.0 {
            true => Ok(tau / sigma),
            false => Err(Error::Input(format!(
                "{}: the normal stress {sigma} Pa must be positive, as the shear stress is divided by it",
                line(i)
            ))),
        }
    };
    shear.into_iter().enumerate().map(over).collect()
}

/// How far a load point of these velocities has gone.
fn integrated(times: &[f64], velocities: &[f64]) -> Vec<f64> {
    let mut gone = vec![0.0; times.len()];
    for i in 1..times.len() {
        let mean = 0.5 * (velocities[i - 1] + velocities[i]);
        gone[i] = gone[i - 1] + mean * (times[i] - times[i - 1]);
    }
    gone
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

/// The rows of the window, thinned.
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
    Ok(rows)
}

/// From when to when there are no samples.
fn gaps(times: &[f64]) -> Vec<(f64, f64)> {
    let spacing = |i: usize| times[i + 1] - times[i];
    let inner = 1..times.len().saturating_sub(2);
    let is_gap = |&i: &usize| spacing(i) > GAP * f64::max(spacing(i - 1), spacing(i + 1));
    let found = inner.filter(is_gap);
    found.map(|i| (times[i], times[i + 1])).collect()
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
