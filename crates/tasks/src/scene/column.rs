//! Columns: what rows show, under which names and in which units. Declared once; CSV, tables, objects and pictures follow.

use super::units::{Quantity, Units};
use nalgebra::Complex;
use std::borrow::Cow;
use std::fmt;
use std::sync::Arc;
use twinslip::error::{Error, Result};
use twinslip::number::Uncertain;

/// What a row has in a column, dimensionless.
#[derive(Debug, Clone, PartialEq)]
pub enum CellValue {
    /// A number, where there is one.
    Number(Option<f64>),
    /// A number with its error budget.
    Uncertain(Option<Uncertain>),
    /// A word.
    Word(Option<String>),
    /// Numbers with their names and error budgets.
    Named(Vec<(String, Uncertain)>),
    /// A count.
    Count(usize),
}

impl From<f64> for CellValue {
    fn from(x: f64) -> Self {
        CellValue::Number(Some(x))
    }
}

impl From<Option<f64>> for CellValue {
    fn from(x: Option<f64>) -> Self {
        CellValue::Number(x)
    }
}

impl From<Uncertain> for CellValue {
    fn from(x: Uncertain) -> Self {
        CellValue::Uncertain(Some(x))
    }
}

impl From<Option<Uncertain>> for CellValue {
    fn from(x: Option<Uncertain>) -> Self {
        CellValue::Uncertain(x)
    }
}

impl From<&'static str> for CellValue {
    fn from(word: &'static str) -> Self {
        CellValue::Word(Some(word.to_owned()))
    }
}

impl From<Option<&'static str>> for CellValue {
    fn from(word: Option<&'static str>) -> Self {
        CellValue::Word(word.map(str::to_owned))
    }
}

impl From<usize> for CellValue {
    fn from(n: usize) -> Self {
        CellValue::Count(n)
    }
}

/// A column of rows of the kind R.
pub struct Column<R> {
    /// Its name in CSV and JSON.
    pub name: Cow<'static, str>,
    /// What it measures.
    pub quantity: Quantity,
    /// Whether it has an error budget.
    pub uncertain: bool,
    /// Whether a table, which has less room, shows it.
    pub in_table: bool,
    /// The sentence of the reference, where the column is declared with it.
    pub meaning: Option<&'static str>,
    /// What a row has in it.
    entry: Arc<dyn Fn(&R) -> CellValue + Send + Sync>,
}

impl<R> Column<R> {
    /// A column that tables show too.
    pub fn new(
        name: impl Into<Cow<'static, str>>,
        quantity: Quantity,
        entry: impl Fn(&R) -> CellValue + Send + Sync + 'static,
    ) -> Self {
        Column {
            name: name.into(),
            quantity,
            uncertain: false,
            in_table: true,
            meaning: None,
            entry: Arc::new(entry),
        }
    }

    /// With an error budget.
    pub fn uncertain(
        name: impl Into<Cow<'static, str>>,
        quantity: Quantity,
        entry: impl Fn(&R) -> CellValue + Send + Sync + 'static,
    ) -> Self {
        Column {
            uncertain: true,
            ..Column::new(name, quantity, entry)
        }
    }

    /// The bound on the error of a number, which no table shows, where one is known.
    pub fn bound(
        name: impl Into<Cow<'static, str>>,
        quantity: Quantity,
        entry: impl Fn(&R) -> Uncertain + Send + Sync + 'static,
    ) -> Self {
        let bound = move |row: &R| {
            Some(entry(row).uncertainty)
                .filter(|x| x.is_finite())
                .into()
        };
        Column::new(name, quantity, bound).not_in_table()
    }

    /// With the sentence that the reference prints of it.
    pub fn meaning(self, meaning: &'static str) -> Self {
        Column {
            meaning: Some(meaning),
            ..self
        }
    }

    /// The real and the imaginary part of the eigenvalue at a place, the first being 0.
    pub fn eigenvalue(
        place: usize,
        quantity: Quantity,
        of: impl Fn(&R, usize) -> Option<Complex<f64>> + Copy + Send + Sync + 'static,
    ) -> [Self; 2] {
        let part = |name: &str, part: fn(Complex<f64>) -> f64| {
            let name = format!("eigenvalue_{}_{name}", place + 1);
            Column::new(name, quantity, move |row: &R| {
                of(row, place).map(part).into()
            })
        };
        [part("re", |z| z.re), part("im", |z| z.im)]
    }

    /// The same, but no table shows it.
    pub fn not_in_table(self) -> Self {
        self.in_table_if(false)
    }

    /// The same, which a table shows only where it tells anything.
    pub fn in_table_if(self, in_table: bool) -> Self {
        Column { in_table, ..self }
    }

    /// What a row has in it, dimensionless.
    pub fn entry(&self, row: &R) -> CellValue {
        (self.entry)(row)
    }

    /// The number that a row has in it, in the user's units; NaN where there is none.
    pub fn number(&self, row: &R, units: &Units) -> f64 {
        let x = match self.entry(row) {
            CellValue::Number(x) => x,
            CellValue::Uncertain(x) => x.map(|x| x.value),
            CellValue::Count(n) => return n as f64,
            CellValue::Word(_) | CellValue::Named(_) => None,
        };
        x.map_or(f64::NAN, |x| units.outward(self.quantity, x))
    }

    /// Those of a comma-separated list of names.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a name that is none, with the nearest that is one.
    pub fn listed(all: &[Self], names: &str) -> Result<Vec<Self>> {
        let one = |name: &str| {
            let found = all.iter().find(|column| column.name == name);
            found.cloned().ok_or_else(|| {
                let known: Vec<&str> = all.iter().map(|column| &*column.name).collect();
                Error::unknown("columns", name, &known)
            })
        };
        names.split(',').map(str::trim).map(one).collect()
    }
}

impl<R> Clone for Column<R> {
    fn clone(&self) -> Self {
        Column {
            name: self.name.clone(),
            entry: Arc::clone(&self.entry),
            ..*self
        }
    }
}

/// Columns of one kind of rows that have the same name are the same.
impl<R> PartialEq for Column<R> {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
    }
}

impl<R> fmt::Debug for Column<R> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} [{:?}]", self.name, self.quantity)
    }
}
