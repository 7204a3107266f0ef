//! Rows as columns: numbers, counts or words, with a mask where some are missing.

use twinslip_output::Cell;

/// What a column holds.
#[derive(Debug, Clone, PartialEq)]
pub enum Values {
    /// Nothing but missing cells so far, so many.
    Missing(usize),
    /// Numbers; 0 where one is missing.
    Numbers(Vec<f64>),
    /// Whole numbers; 0 where one is missing.
    Counts(Vec<i64>),
    /// Words; empty where one is missing.
    Words(Vec<String>),
}

/// A column by its name.
#[derive(Debug, Clone, PartialEq)]
pub struct Column {
    /// The name.
    pub name: String,
    /// The values.
    pub values: Values,
    /// Which cells are missing, from the first on; those behind its end are not.
    pub missing: Vec<bool>,
}

impl Column {
    fn new(name: &str) -> Self {
        Column {
            name: name.to_owned(),
            values: Values::Missing(0),
            missing: Vec::new(),
        }
    }

    /// So many cells.
    pub fn len(&self) -> usize {
        match &self.values {
            Values::Missing(count) => *count,
            Values::Numbers(all) => all.len(),
            Values::Counts(all) => all.len(),
            Values::Words(all) => all.len(),
        }
    }

    fn push(&mut self, cell: &Cell) {
        match cell {
            Cell::Number(x) if x.is_finite() => self.number(*x),
            Cell::Number(_) | Cell::Missing => self.skip(),
            Cell::Text(text) => self.text(text),
        }
    }

    fn number(&mut self, x: f64) {
        let count = self.len();
        match &mut self.values {
            Values::Numbers(all) => all.push(x),
            Values::Missing(_) => {
                let mut all = vec![0.0; count];
                all.push(x);
                self.values = Values::Numbers(all);
            }
            Values::Counts(counts) => {
                let mut all: Vec<f64> = counts.iter().map(|&n| n as f64).collect();
                all.push(x);
                self.values = Values::Numbers(all);
            }
            Values::Words(all) => all.push(x.to_string()),
        }
    }

    /// A cell of text is a count if it reads as one, and all before it are.
    fn text(&mut self, text: &str) {
        let count = self.len();
        match (&mut self.values, text.parse::<i64>()) {
            (Values::Counts(all), Ok(n)) => all.push(n),
            (Values::Numbers(all), Ok(n)) => all.push(n as f64),
            (Values::Missing(_), Ok(n)) => {
                let mut all = vec![0; count];
                all.push(n);
                self.values = Values::Counts(all);
            }
            (Values::Words(all), _) => all.push(text.to_owned()),
            (Values::Missing(_), Err(_)) => {
                let mut all = vec![String::new(); count];
                all.push(text.to_owned());
                self.values = Values::Words(all);
            }
            (Values::Numbers(numbers), Err(_)) => {
                let mut all: Vec<String> = numbers.iter().map(f64::to_string).collect();
                all.push(text.to_owned());
                self.values = Values::Words(all);
            }
            (Values::Counts(counts), Err(_)) => {
                let mut all: Vec<String> = counts.iter().map(i64::to_string).collect();
                all.push(text.to_owned());
                self.values = Values::Words(all);
            }
        }
    }

    fn skip(&mut self) {
        let count = self.len();
        self.missing.resize(count, false);
        self.missing.push(true);
        match &mut self.values {
            Values::Missing(count) => *count += 1,
            Values::Numbers(all) => all.push(0.0),
            Values::Counts(all) => all.push(0),
            Values::Words(all) => all.push(String::new()),
        }
    }
}

/// All rows.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Table {
    /// The columns.
    pub columns: Vec<Column>,
    /// So many rows.
    pub rows: usize,
}

impl Table {
    /// Without rows.
    pub fn new(names: &[String]) -> Self {
        Table {
            columns: names.iter().map(|name| Column::new(name)).collect(),
            rows: 0,
        }
    }

    /// One row more.
    pub fn push(&mut self, cells: &[Cell]) {
        for (column, cell) in self.columns.iter_mut().zip(cells) {
            column.push(cell);
        }
        self.rows += 1;
    }
}
