//! Which columns of a file are which, and in which units.

use super::data::TakenColumn;
use super::heading::Heading;
use super::options::FitOptions;
use super::roles::{Found, Role, columns_of};
use super::table::Table;
use super::unit::factor;
use crate::scene::words::Kind;
use twinslip::error::{Error, Result};

/// The places of the columns of a record.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Columns<'a> {
    pub time: usize,
    pub friction: usize,
    pub displacement: Option<usize>,
    /// That of the load point's velocity, where there is no displacement.
    pub velocity: Option<usize>,
    pub normal_stress: Option<usize>,
    /// What a user may not have meant.
    pub notes: Vec<String>,
    options: &'a FitOptions,
}

/// What an option says of a column.
fn asked(options: &FitOptions, role: Role) -> Option<&str> {
    let option = match role {
        Role::Time => &options.time,
        Role::Friction => &options.friction,
        Role::Displacement => &options.displacement,
        Role::NormalStress => &options.normal_stress_column,
        Role::Velocity | Role::Uncertainty => return None,
    };
    option.as_deref()
}

impl<'a> Columns<'a> {
    /// Finds them, by options or by names; `moves` is whether a displacement must be known where several columns may be it.
    ///
    /// # Errors
    /// [`Error::Input`] where no column or several may be what is needed.
    pub fn of(options: &'a FitOptions, table: &Table, moves: bool) -> Result<Self> {
        // Words are no measurement, wherever they stand.
        let mut taken: Vec<usize> = (0..table.width())
            .filter(|&at| !table.is_numeric(at))
            .collect();
        let mut notes = Vec::new();
        let mut places = [None; Role::OF_RECORD.len()];
        for (place, role) in places.iter_mut().zip(Role::OF_RECORD) {
            let found = match asked(options, role) {
                Some(column) => Found::One(table.asked(role.option(), column)?),
                None => columns_of(role, &table.headings, &taken),
            };
            *place = match found {
                Found::One(one) => Some(one),
                Found::None if role == Role::Time => clock(table, &mut notes),
                Found::None => None,
                Found::Several(all) => {
                    let names: Vec<String> = all.iter().map(|&at| table.name(at)).collect();
                    let may_be = format!("{} may each be the {}", names.join(" and "), role.name());
                    let is_needed = match role {
                        Role::Time | Role::Friction => true,
                        Role::Displacement => moves,
                        Role::NormalStress => options.normal_stress.is_none(),
                        Role::Velocity | Role::Uncertainty => false,
                    };
                    if is_needed {
                        return Err(Error::Input(format!(
                            "{}: the columns {may_be}; say which by `{}`",
                            table.file,
                            role.option()
                        )));
                    }
                    notes.push(format!(
                        "{}: none is taken of the columns {may_be}",
                        table.file
                    ));
                    None
                }
            };
            taken.extend(*place);
        }
        let needed = |place: Option<usize>, role: Role| {
            let how = match table.headings.is_empty() {
                true => "say which is which by `time`, `friction` and `displacement`".into(),
                false => format!("say so by `{}`", role.option()),
            };
            place.ok_or_else(|| {
                Error::Input(format!(
                    "{}: which column is the {}? {}; {how}",
                    table.file,
                    role.name(),
                    table.seen()
                ))
            })
        };
        let [time, friction, velocity, displacement, normal_stress] = places;
        Ok(Columns {
            time: needed(time, Role::Time)?,
            friction: needed(friction, Role::Friction)?,
            displacement,
            velocity: velocity.filter(|_| displacement.is_none()),
            normal_stress,
            notes,
            options,
        })
    }

    /// The places of all, with what they are.
    fn all(&self) -> impl Iterator<Item = (usize, Role)> + use<'_> {
        let each = [
            (Some(self.time), Role::Time),
            (self.displacement, Role::Displacement),
            (self.velocity, Role::Velocity),
            (Some(self.friction), Role::Friction),
            (self.normal_stress, Role::NormalStress),
        ];
        each.into_iter()
            .filter_map(|(place, role)| Some((place?, role)))
    }

    /// The unit of a column as an option or the header states it. A unit that is asked for holds over that of the header.
    fn stated(&self, table: &Table, place: usize) -> Option<String> {
        let mut own = self.all().filter(|(at, _)| *at == place);
        let of_option = own.find_map(|(_, role)| Heading::of(asked(self.options, role)?).unit);
        let heading = table.headings.get(place);
        of_option.or_else(|| heading.and_then(|one| one.unit.clone()))
    }

    /// The size in SI of the unit of a column, where it states one.
    ///
    /// # Errors
    /// [`Error::Input`] for a unit that is not known, or of another kind.
    pub fn unit(&self, table: &Table, place: usize, kind: Kind) -> Result<Option<f64>> {
        if let Some(unit) = self.stated(table, place) {
            return factor(kind, Some(&unit), &table.name(place)).map(Some);
        }
        // The end of a name may mean something else.
        let suffix = table.headings.get(place).and_then(Heading::stated);
        Ok(suffix.and_then(|unit| factor(kind, Some(unit), "").ok()))
    }

    /// The numbers of a column in SI.
    ///
    /// # Errors
    /// Those of [`Table::numbers`] and of [`Columns::unit`].
    pub fn numbers(
        &self,
        table: &Table,
        (place, what, kind): (usize, &str, Kind),
    ) -> Result<Vec<f64>> {
        let size = self.unit(table, place, kind)?.unwrap_or(1.0);
        let mut numbers = table.numbers(place, what)?;
        numbers.iter_mut().for_each(|x| *x *= size);
        Ok(numbers)
    }

    /// The times, in s.
    ///
    /// # Errors
    /// [`Error::Input`] for what is none.
    pub fn times(&self, table: &Table) -> Result<Vec<f64>> {
        match table.is_clock(self.time) {
            true => table.clock(self.time),
            false => self.numbers(table, (self.time, "time", Kind::Time)),
        }
    }

    /// What the columns were taken to be.
    pub fn taken(&self, table: &Table) -> Vec<TakenColumn> {
        let of = |(place, role)| {
            let heading = table.headings.get(place).and_then(Heading::stated);
            TakenColumn {
                name: table.name(place),
                role,
                unit: self.stated(table, place).or(heading.map(str::to_owned)),
            }
        };
        self.all().map(of).collect()
    }

    /// The names of the columns that are none of these.
    pub fn left(&self, table: &Table) -> Vec<String> {
        let is_left = |at: &usize| self.all().all(|(place, _)| place != *at);
        let left = (0..table.width()).filter(is_left);
        left.map(|at| table.name(at)).collect()
    }
}

/// The column of a clock, of dates and times of day.
fn clock(table: &Table, notes: &mut Vec<String>) -> Option<usize> {
    let found = (0..table.width()).find(|&at| table.is_clock(at))?;
    notes.push(format!(
        "{}: the times, column {}, are of a clock and count in s from the first row",
        table.file,
        table.name(found)
    ));
    Some(found)
}
