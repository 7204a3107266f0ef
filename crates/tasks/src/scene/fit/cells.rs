//! What the lines of a laboratory's file are made of: cells between separators, numbers as laboratories write them.

/// How a file separates its columns.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Separator {
    /// A sign between two cells.
    Sign(char),
    /// Any number of blanks.
    Blanks,
}

impl Separator {
    /// That of a line of numbers. A comma within quotes, or between digits where blanks or another sign separate the columns, is one of decimals.
    pub fn of(line: &str) -> Self {
        let bare = without_quotes(line);
        if let Some(sign) = [';', '\t'].into_iter().find(|&sign| bare.contains(sign)) {
            return Separator::Sign(sign);
        }
        let words: Vec<&str> = bare.split_whitespace().collect();
        let is_decimal = |word: &&str| {
            word.matches(',').count() <= 1 && !word.contains('.') && numeral(word).is_some()
        };
        let by_blanks = words.len() > 1
            && words.iter().all(is_decimal)
            && words.iter().any(|word| word.contains(','));
        if bare.contains(',') && !by_blanks {
            Separator::Sign(',')
        } else {
            Separator::Blanks
        }
    }

    /// The cells of a line, without their quotes.
    pub fn cells(self, line: &str) -> Vec<String> {
        let mut cells = vec![String::new()];
        let mut is_quoted = false;
        for c in line.trim_end_matches('\r').chars() {
            let ends = match self {
                Separator::Sign(sign) => c == sign,
                Separator::Blanks => c.is_whitespace(),
            };
            if c == '"' {
                is_quoted = !is_quoted;
            } else if ends && !is_quoted {
                cells.push(String::new());
            } else if let Some(last) = cells.last_mut() {
                last.push(c);
            }
        }
        let trimmed = cells.iter().map(|cell| cell.trim().to_owned());
        let mut cells: Vec<String> = match self {
            Separator::Sign(_) => trimmed.collect(),
            Separator::Blanks => trimmed.filter(|cell| !cell.is_empty()).collect(),
        };
        while cells.last().is_some_and(String::is_empty) {
            cells.pop();
        }
        cells
    }
}

/// A line with nothing between its quotes.
fn without_quotes(line: &str) -> String {
    line.split('"').step_by(2).collect()
}

/// A number with a decimal point, or a decimal comma.
pub(super) fn numeral(cell: &str) -> Option<f64> {
    number(cell).or_else(|| number(&with_point(cell)?))
}

/// The same with a point in place of its only comma.
pub(super) fn with_point(cell: &str) -> Option<String> {
    let is_comma = cell.matches(',').count() == 1 && !cell.contains('.');
    is_comma.then(|| cell.replace(',', "."))
}

/// A number, NaN and infinity among them; its exponent may be Fortran's, `1.0D-03`.
pub(super) fn number(cell: &str) -> Option<f64> {
    let begins_as_number = cell.starts_with(|c: char| c.is_ascii_digit() || "+-.".contains(c));
    let is_word = ["nan", "inf"].contains(&cell.to_lowercase().as_str());
    if !begins_as_number && !is_word {
        return None;
    }
    cell.parse()
        .ok()
        .or_else(|| cell.replace(['d', 'D'], "e").parse().ok())
}

/// Whether a number stands for a missing one: -999, -9999, ...
pub(super) fn is_mark(x: f64) -> bool {
    x < 0.0 && [999.0, 9999.0, 99999.0, 999_999.0].contains(&-x)
}

/// A text in UTF-8, or in Latin-1, as instruments write `µ`.
pub(super) fn decoded(bytes: Vec<u8>) -> String {
    String::from_utf8(bytes)
        .unwrap_or_else(|error| error.as_bytes().iter().map(|&b| char::from(b)).collect())
}
