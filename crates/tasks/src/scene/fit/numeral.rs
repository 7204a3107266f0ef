//! Numbers as laboratories and spreadsheets write them.

/// Signs between groups of three digits, beside the one of the two that does not separate decimals.
const GROUPING: [char; 6] = [' ', '\u{a0}', '\u{202f}', '\u{2009}', '\'', '\u{2019}'];
/// What negative numbers of some spreadsheets begin with.
const MINUS: char = '\u{2212}';

/// How a file writes numbers: with a decimal point, or a decimal comma.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Decimal {
    Point,
    Comma,
}

impl Decimal {
    fn sign(self) -> char {
        match self {
            Decimal::Point => '.',
            Decimal::Comma => ',',
        }
    }

    fn other(self) -> Self {
        match self {
            Decimal::Point => Decimal::Comma,
            Decimal::Comma => Decimal::Point,
        }
    }

    /// That of a file with these cells. `1,5` has a decimal comma, and `1.234,5` too; `1,234` alone may be either.
    pub fn of<'a>(cells: impl Iterator<Item = &'a str>) -> Self {
        let (mut points, mut commas, mut has_comma, mut has_point) = (false, false, false, false);
        for cell in cells {
            match shown(cell) {
                Some(Decimal::Point) => points = true,
                Some(Decimal::Comma) => commas = true,
                None if is_numeral(cell) => {
                    has_comma |= cell.contains(',');
                    has_point |= cell.contains('.');
                }
                None => {}
            }
        }
        match (points, commas) {
            (false, true) => Decimal::Comma,
            (false, false) if has_comma && !has_point => Decimal::Comma,
            _ => Decimal::Point,
        }
    }

    /// A number, NaN and infinity among them; its exponent may be Fortran's, `1.0D-03`, and its digits in groups of three.
    pub fn number(self, cell: &str) -> Option<f64> {
        let begins =
            cell.starts_with(|c: char| c.is_ascii_digit() || "+-.,".contains(c) || c == MINUS);
        if !begins {
            let is_word = ["nan", "inf"]
                .iter()
                .any(|word| cell.eq_ignore_ascii_case(word));
            return is_word.then(|| cell.parse().ok()).flatten();
        }
        if self == Decimal::Point
            && let Ok(x) = cell.parse()
        {
            return Some(x);
        }
        let written = cell.replace(MINUS, "-");
        let (whole, rest) = match written.find([self.sign(), 'e', 'E', 'd', 'D']) {
            Some(at) => written.split_at(at),
            None => (&written[..], ""),
        };
        let rest = rest.replacen(self.sign(), ".", 1).replace(['d', 'D'], "e");
        (ungrouped(whole, self.other().sign())? + &rest)
            .parse()
            .ok()
    }
}

/// A number with a decimal point, or a decimal comma.
pub(super) fn numeral(cell: &str) -> Option<f64> {
    let by = |decimal: Decimal| decimal.number(cell);
    by(Decimal::Point).or_else(|| by(Decimal::Comma))
}

/// Whole digits without the signs between groups of three; `None` where a sign does not stand between such.
fn ungrouped(whole: &str, also: char) -> Option<String> {
    let is_grouping = |c: char| c == also || GROUPING.contains(&c);
    let Some(sign) = whole.chars().find(|c| is_grouping(*c)) else {
        return Some(whole.to_owned());
    };
    let mut parts = whole.split(sign);
    let first = parts.next()?;
    let digits = |part: &str| !part.is_empty() && part.bytes().all(|b| b.is_ascii_digit());
    let leading = first.trim_start_matches(['-', '+']);
    let is_grouped = digits(leading) && leading.len() <= 3 && !leading.starts_with('0');
    let rest: Vec<&str> = parts.collect();
    let are_threes = rest.iter().all(|part| part.len() == 3 && digits(part));
    (is_grouped && are_threes).then(|| first.to_owned() + &rest.concat())
}

/// Whether a cell is made of what numbers are made of.
fn is_numeral(cell: &str) -> bool {
    let may = |c: char| {
        c.is_ascii_digit() || "+-.,eEdD".contains(c) || c == MINUS || GROUPING.contains(&c)
    };
    cell.chars().all(may) && cell.contains(|c: char| c.is_ascii_digit())
}

/// The decimal sign that a number shows beyond doubt.
fn shown(cell: &str) -> Option<Decimal> {
    let at = |decimal: Decimal| cell.rfind(decimal.sign());
    let last = match (at(Decimal::Point), at(Decimal::Comma)) {
        (None, None) => return None,
        (point, comma) if point > comma => Decimal::Point,
        _ => Decimal::Comma,
    };
    if !is_numeral(cell) {
        return None;
    }
    let as_grouping = last.other().number(cell).is_some();
    let as_decimal = last.number(cell).is_some();
    match (as_decimal, as_grouping) {
        (true, false) => Some(last),
        (false, true) => Some(last.other()),
        _ => None,
    }
}

/// Whether a number stands for a missing one: -999, -9999, ...
pub(super) fn is_mark(x: f64) -> bool {
    x < 0.0 && [999.0, 9999.0, 99999.0, 999_999.0].contains(&-x)
}

#[cfg(test)]
mod test {
    use super::*;

    #[test]
    fn numbers_of_spreadsheets_are_read() {
        for (decimal, cell, x) in [
            (Decimal::Point, "1,234,567.5", 1_234_567.5),
            (Decimal::Point, "-1'234.5", -1234.5),
            (Decimal::Point, "1.0D-03", 1e-3),
            (Decimal::Point, "\u{2212}0.5", -0.5),
            (Decimal::Comma, "1.234.567,5", 1_234_567.5),
            (Decimal::Comma, "1\u{a0}234,5", 1234.5),
            (Decimal::Comma, "1.234", 1234.0),
            (Decimal::Comma, "-0,5E-3", -5e-4),
            (Decimal::Comma, ",5", 0.5),
        ] {
            assert_eq!(decimal.number(cell), Some(x), "{cell}");
        }
        for (decimal, cell) in [
            (Decimal::Point, "1,5"),
            (Decimal::Point, "0,123"),
            (Decimal::Point, "12,34,567"),
            (Decimal::Comma, "1.5"),
            (Decimal::Comma, "01.05.2023"),
            (Decimal::Comma, "1,234,567"),
            (Decimal::Point, "12:30:00"),
            (Decimal::Point, "2023-05-01"),
            (Decimal::Point, "e5"),
        ] {
            assert_eq!(decimal.number(cell), None, "{cell}");
        }
    }

    #[test]
    fn what_separates_decimals_is_decided_by_the_whole_file() {
        for (cells, decimal) in [
            (["1,234", "0,5", "2"], Decimal::Comma),
            (["1,234", "0.5", "2"], Decimal::Point),
            (["1.234", "2.345", "3.456"], Decimal::Point),
            (["1,234", "2,345", "3,456"], Decimal::Comma),
            (["1.234,5", "2.345", "3.456"], Decimal::Comma),
            (["1,234.5", "2,345", "3"], Decimal::Point),
            (["01.05.2023", "0,5", "1"], Decimal::Comma),
        ] {
            assert_eq!(Decimal::of(cells.into_iter()), decimal, "{cells:?}");
        }
    }
}
