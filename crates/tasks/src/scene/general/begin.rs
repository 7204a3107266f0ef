//! A point of codimension two from a file of special points, at which a curve begins.

use super::{Free, Subject};
use crate::scene::continuation::{LocusOptions, SearchOptions};
use crate::scene::file::read_bounded;
use crate::scene::locus::CurveChoice;
use crate::scene::text::{TextModel, given_text};
use crate::scene::units::Quantity;
use std::borrow::Cow;
use std::path::Path;
use twinslip::bifurcation::Label;
use twinslip::bifurcation::curves_that_leave;
use twinslip::bifurcation::general::{GeneralBifurcation, GeneralPoint, GeneralSolution};
use twinslip::error::{Error, Result};
use twinslip::field::Vector;
use twinslip::number::{Uncertain, eigenvalues};
use twinslip::orbit::ShootingNodes;

/// No file of special points is longer than so many bytes.
const LONGEST: u64 = 1 << 26;

/// A row of a file of special points.
#[derive(Debug, Clone, PartialEq)]
pub struct SpecialRow {
    /// FILE:ROW, as it was given.
    text: String,
    /// What is special there.
    label: Label,
    columns: Vec<String>,
    cells: Vec<String>,
    /// The curve it is on, and its plane with both ranges, as the head of the file has them.
    curve: CurveChoice,
    plane: [String; 2],
    ranges: [[f64; 2]; 2],
}

/// What follows `name = ` in a remark, up to its end.
fn told<T: for<'d> serde::Deserialize<'d>>(remarks: &[&str], name: &str) -> Option<T> {
    let key = format!("{name} = ");
    let rest = remarks.iter().find_map(|remark| {
        let from = remark.find(&key)?;
        Some(&remark[from + key.len()..])
    })?;
    let mut values = serde_json::Deserializer::from_str(rest).into_iter();
    values.next()?.ok()
}

impl SpecialRow {
    /// The row of this number, from 1, of the file in FILE:ROW.
    ///
    /// # Errors
    /// [`Error::Input`] for a text that names none, for a file that is not one of special points of `locus`, and for points at which no curve begins;
    /// [`Error::File`] where it can't be read.
    pub fn read(text: &str) -> Result<Self> {
        let shown = match given_text(Path::new(text)) {
            None => text,
            Some(_) => "the file",
        };
        let wrong = |what: String| Error::Input(format!("`begin` {shown}: {what}"));
        let (file, row) = text.rsplit_once(':').ok_or_else(|| {
            wrong("must be FILE.special.csv:ROW, a row of a file of special points".into())
        })?;
        let number: usize = row.trim().parse().unwrap_or(0);
        if number == 0 {
            return Err(wrong(format!(
                "{row:?} must be the number of a row, from 1"
            )));
        }
        let held: Cow<'_, str> = match given_text(Path::new(file)) {
            Some(text) => text.into(),
            None => read_bounded(Path::new(file), LONGEST)?.into(),
        };
        let remarks: Vec<&str> = held.lines().filter(|line| line.starts_with('#')).collect();
        let mut reader = csv::ReaderBuilder::new();
        let mut reader = reader.comment(Some(b'#')).from_reader(held.as_bytes());
        let unreadable = |error: csv::Error| wrong(format!("it is no CSV, {error}"));
        let columns: Vec<String> = reader
            .headers()
            .map_err(unreadable)?
            .iter()
            .map(str::to_owned)
            .collect();
        let rows: Vec<csv::StringRecord> = reader
            .records()
            .collect::<std::result::Result<_, _>>()
            .map_err(unreadable)?;
        let of = remarks.iter().find_map(|remark| {
            let rest = remark.strip_prefix("# numerics: of = ")?;
            Some(rest.split(',').next().unwrap_or_default())
        });
        let not_ours = || wrong("it is no file of special points of `locus`".into());
        let curve = CurveChoice::named(Some(of.ok_or_else(not_ours)?))?;
        let plane =
            told(&remarks, "in").or_else(|| Some(["driving", "stiffness"].map(str::to_owned)));
        let ranges = told(&remarks, "ranges").unwrap_or([[f64::NAN; 2]; 2]);
        let count = rows.len();
        let cells = rows.into_iter().nth(number - 1).ok_or_else(|| {
            wrong(match count {
                0 => "it has no row".into(),
                1 => "it has one row".into(),
                _ => format!("it has {count} rows"),
            })
        })?;
        let cells: Vec<String> = cells.iter().map(str::to_owned).collect();
        let place = columns.iter().position(|name| name == "label");
        let label = place.and_then(|place| cells.get(place));
        let label = label.and_then(|label| Label::named(label));
        Ok(SpecialRow {
            text: shown.to_owned(),
            label: label.ok_or_else(not_ours)?,
            columns,
            cells,
            curve,
            plane: plane.ok_or_else(not_ours)?,
            ranges,
        })
    }

    /// The number in a column, where there is one.
    fn number(&self, column: &str) -> Option<f64> {
        let place = self.columns.iter().position(|name| name == column)?;
        self.cells.get(place)?.parse().ok()
    }

    /// That this curve leaves the point.
    ///
    /// # Errors
    /// [`Error::Input`] where it does not.
    pub fn checked(&self, choice: CurveChoice, kind: GeneralBifurcation) -> Result<()> {
        let of_orbits = self.curve.of_orbits();
        let leave = curves_that_leave(self.label, of_orbits);
        if leave.contains(&kind) {
            return Ok(());
        }
        let (text, name, meaning) = (&self.text, self.label.name(), self.label.meaning());
        Err(Error::Input(match leave {
            [] => format!(
                "`begin` {text} is {name} ({meaning}), but must be a point of codimension two that curves leave, as CP, BT, GH, ZH, HH, R1, R2 or GPD"
            ),
            _ => {
                let names: Vec<&str> = CurveChoice::ALL
                    .iter()
                    .filter(|one| one.bifurcation().is_some_and(|kind| leave.contains(&kind)))
                    .map(|one| one.name)
                    .collect();
                format!(
                    "`begin` {text} is {name} ({meaning}), which no curve of {} leaves; {} do",
                    choice.name,
                    names.join(", ")
                )
            }
        }))
    }

    /// The states as they stand in the file, in the user's units, where it has them.
    fn states(&self, subject: &dyn Subject) -> Option<Vec<f64>> {
        let names = subject.states();
        let values = names.iter().map(|(name, _)| self.number(name));
        values.collect()
    }

    /// What the output tells of it.
    pub fn told(&self) -> String {
        format!("{} of {}", self.label.name(), self.text)
    }

    /// Whether it is on a curve of orbits.
    pub fn of_orbits(&self) -> bool {
        self.curve.of_orbits()
    }

    /// Where a system is looked at first: the state there. Interfaces have a scale of their own.
    pub fn search(&self, model: &TextModel, turns: Option<usize>) -> SearchOptions {
        let search = SearchOptions {
            turns,
            ..SearchOptions::default()
        };
        if model.slab.is_some() {
            return search;
        }
        let values = model.system.states().iter().map(|name| self.number(name));
        let start: Option<Vec<String>> = values.map(|x| Some(format!("{:?}", x?))).collect();
        SearchOptions {
            start: start.map(|values| values.join(",")),
            ..search
        }
    }

    /// The point, in the coordinates of both parameters that vary.
    ///
    /// # Errors
    /// [`Error::Input`] where the file lacks one of them, or the state; those of the equilibria.
    pub fn point(&self, subject: &dyn Subject, free: [&Free; 2]) -> Result<GeneralPoint> {
        let units = subject.units();
        let value = |free: &Free| {
            let value = self
                .number(free.name)
                .map(|x| units.inward(free.quantity, x));
            value.ok_or_else(|| {
                Error::Input(format!(
                    "`begin` {}: there is no {}, which varies along the curve; its plane is {}",
                    self.text,
                    free.name,
                    self.plane.join(", ")
                ))
            })
        };
        let values = [value(free[0])?, value(free[1])?];
        let at = [0, 1].map(|i| free[i].coordinate.inward(values[i]));
        let state = match self.states(subject) {
            Some(states) => {
                let states = states.iter().zip(subject.states());
                let inward = states.map(|(&x, (_, quantity))| units.inward(quantity, x));
                subject.state_inward(&inward.collect::<Vec<f64>>())
            }
            None if !self.of_orbits() => self.equilibrium(subject, &free, values, at)?,
            None => return Err(self.without_state()),
        };
        let mut period_told = None;
        let solution = match self.curve.of_orbits() {
            false => GeneralSolution::Equilibrium {
                state,
                eigenvalues: Vec::new(),
            },
            true => {
                let period = self
                    .number("period")
                    .map(|t| units.inward(Quantity::Time, t));
                let period = period.ok_or_else(|| {
                    Error::Input(format!("`begin` {}: the period is missing", self.text))
                })?;
                let period = period / subject.unit_of_time();
                let off = self.number("period_uncertainty");
                let off = off.map_or(f64::INFINITY, |off| {
                    off / units.factor(Quantity::Time) / subject.unit_of_time()
                });
                period_told = Some(Uncertain::new(period, off));
                GeneralSolution::Orbit {
                    log_multipliers: vec![0.0; state.len() - 1],
                    shooting: ShootingNodes {
                        nodes: vec![state],
                        durations: vec![period],
                    },
                    neutral: 0.0,
                }
            }
        };
        let mut point = GeneralPoint::new(0, at, solution);
        point.label = Some(self.label);
        point.period = period_told;
        point.parameters = [0, 1].map(|i| {
            let off = self.number(&format!("{}_uncertainty", free[i].name));
            let off = off.map_or(f64::INFINITY, |off| off / units.factor(free[i].quantity));
            Uncertain::new(values[i], off)
        });
        Ok(point)
    }
}

impl SpecialRow {
    /// The equilibrium there, of those that the system finds: that with its eigenvalues nearest to the imaginary axis.
    fn equilibrium(
        &self,
        subject: &dyn Subject,
        free: &[&Free; 2],
        values: [f64; 2],
        at: [f64; 2],
    ) -> Result<Vector> {
        let names = [free[0].name, free[1].name];
        let family = subject.family(&names, free.map(|free| free.coordinate))?;
        let all = subject.equilibria(&[(names[0], values[0]), (names[1], values[1])])?;
        let off = |state: &Vector| {
            let all = eigenvalues(&family.field(at).jacobian(state)).unwrap_or_default();
            let mut off: Vec<f64> = all.iter().map(|z| z.re.abs()).collect();
            off.sort_by(f64::total_cmp);
            // At a cusp it is one eigenvalue, at other points two or more.
            let which = usize::from(self.label != Label::Cp);
            off.get(which).copied().unwrap_or(f64::INFINITY)
        };
        let nearest = all.into_iter().min_by(|a, b| off(a).total_cmp(&off(b)));
        nearest.ok_or_else(|| self.without_state())
    }

    fn without_state(&self) -> Error {
        Error::Input(format!(
            "`begin` {}: the file does not tell the state of its points; it was written by another version, or of other variables",
            self.text
        ))
    }
}

impl LocusOptions {
    /// The same with the plane and the ranges of the point at which the curve begins, where none are given.
    ///
    /// # Errors
    /// Those of [`SpecialRow::read`].
    pub fn beginning(&self) -> Result<(Cow<'_, Self>, Option<SpecialRow>)> {
        let Some(text) = &self.begin else {
            return Ok((Cow::Borrowed(self), None));
        };
        let row = SpecialRow::read(text)?;
        let search = &self.search;
        let places = [
            ("start", search.start.is_some()),
            ("box", search.within.is_some()),
            ("period_guess", search.period_guess.is_some()),
            ("hold", self.hold.is_some()),
        ];
        if let Some((name, _)) = places.iter().find(|(_, given)| *given) {
            return Err(Error::Input(format!(
                "`{name}` has no meaning beside `begin`, which says where the curve begins"
            )));
        }
        let mut options = self.clone();
        if options.plane.is_none() {
            options.plane = Some(row.plane.join(","));
        }
        let plane = options.plane.clone().unwrap_or_default();
        for (name, [from, to]) in row.plane.iter().zip(row.ranges) {
            let of_name = |text: &String| {
                let mut all = text.split(';');
                all.any(|text| text.split('=').next().map(str::trim) == Some(name))
            };
            let is_given = options.range.iter().any(of_name)
                || name == "driving" && options.driving_range.is_some()
                || name == "stiffness" && options.stiffness_range.is_some();
            if !is_given && from.is_finite() && plane.split(',').any(|one| one.trim() == name) {
                options.range.push(format!("{name}={from:?},{to:?}"));
            }
        }
        Ok((Cow::Owned(options), Some(row)))
    }
}

/// The states of a solution: of an equilibrium, or of a point of an orbit.
pub(super) fn state_of(solution: &GeneralSolution) -> &Vector {
    match solution {
        GeneralSolution::Equilibrium { state, .. } => state,
        GeneralSolution::Orbit { shooting, .. } => &shooting.nodes[0],
    }
}
