//! The head of a laboratory's file: the names of its columns, and their units.

use super::cells::Separator;
use super::data::is_known;
use super::unit::is_unit;

/// A column as its header has it.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Heading {
    /// The name, without the unit in parentheses or brackets.
    pub name: String,
    /// The unit in parentheses or brackets, or on a line of its own.
    pub unit: Option<String>,
    /// The name and the unit, where the name ends with one, as in `displacement_um`.
    suffix: Option<(String, String)>,
}

impl Heading {
    /// `Displ(microns)`, `Time [s]`, `shear_stress_MPa`, `friction`.
    pub fn of(text: &str) -> Self {
        let (name, unit) = match text.find(['(', '[']) {
            Some(at) if at > 0 => {
                let unit = text[at + 1..].trim_end_matches([')', ']']).trim();
                (&text[..at], Some(unit.to_owned()).filter(|u| !u.is_empty()))
            }
            _ => (text, None),
        };
        let name = name.trim().trim_end_matches('_').to_owned();
        let parts = name.rsplit_once(['_', ' ', ',', '/', '-', '.']);
        let suffix = parts
            .filter(|(stem, unit)| !stem.is_empty() && is_unit(unit))
            .map(|(stem, unit)| (stem.trim().to_owned(), unit.to_owned()));
        Heading { name, unit, suffix }
    }

    /// The unit that it states.
    pub fn stated(&self) -> Option<&str> {
        let in_name = self.suffix.as_ref().map(|(_, unit)| unit.as_str());
        self.unit.as_deref().or(in_name)
    }

    /// Its name and that without a unit, both plain.
    pub fn plain_names(&self) -> [String; 2] {
        let stem = self.suffix.as_ref().map_or(&self.name, |(stem, _)| stem);
        [plain(&self.name), plain(stem)]
    }

    /// Whether a user means it by this name.
    pub fn is(&self, name: &str) -> bool {
        self.name == name || self.plain_names().contains(&plain(name))
    }
}

/// A name without case and signs.
pub(super) fn plain(name: &str) -> String {
    let letters = name.chars().filter(|c| c.is_alphanumeric());
    let small = letters.flat_map(char::to_lowercase);
    // The micro sign is the Greek letter.
    small.map(|c| if c == 'µ' { 'μ' } else { c }).collect()
}

/// The head of a file with so many columns, from the lines before its numbers: the line that names most columns that are known, and that
/// below it where it holds units. Titles are no names. `remarks` are looked at where no other line has the names.
pub(super) fn headings(
    words: &[&str],
    remarks: &[&str],
    (separator, width): (Separator, usize),
) -> Vec<Heading> {
    let known = |cells: &[String]| {
        let each = cells.iter().map(|cell| Heading::of(cell));
        each.filter(is_known).count()
    };
    let lines = |all: &[&str]| -> Vec<Vec<String>> {
        let fitting = all.iter().map(|line| in_columns(line, separator, width));
        fitting.flatten().collect()
    };
    let mut below = lines(words);
    let mut best = (0..below.len()).rev().max_by_key(|&i| known(&below[i]));
    if best.is_none_or(|at| known(&below[at]) < 2) {
        let told = lines(remarks);
        let of_remarks = (0..told.len()).rev().max_by_key(|&i| known(&told[i]));
        if let Some(at) = of_remarks.filter(|&at| known(&told[at]) >= 2) {
            below.splice(0..0, [told[at].clone()]);
            best = Some(0);
        }
    }
    let Some(at) = best else { return Vec::new() };
    let mut headings: Vec<Heading> = below[at].iter().map(|cell| Heading::of(cell)).collect();
    let bare = |cell: &String| cell.trim_matches(['(', ')', '[', ']']).to_owned();
    let may_be_unit = |cell: &String| is_unit(&bare(cell)) || cell.starts_with(['(', '[']);
    if let Some(units) = below
        .get(at + 1)
        .filter(|cells| cells.iter().any(may_be_unit))
    {
        for (heading, unit) in headings.iter_mut().zip(units) {
            let unit = Some(bare(unit)).filter(|unit| !unit.is_empty());
            heading.unit = heading.unit.take().or(unit);
        }
    }
    headings
}

/// A line of words in so many columns, by the separator of the numbers or another one; `None` where none gives that many.
fn in_columns(line: &str, separator: Separator, width: usize) -> Option<Vec<String>> {
    let joined = |cells: Vec<String>| {
        // `Time (s)` is one name.
        let mut all: Vec<String> = Vec::new();
        for cell in cells {
            match all.last_mut() {
                Some(last) if cell.starts_with(['(', '[']) && !last.starts_with(['(', '[']) => {
                    *last += &format!(" {cell}");
                }
                _ => all.push(cell),
            }
        }
        all
    };
    let signs = [';', '\t', ','].map(Separator::Sign);
    let by_signs = std::iter::once(separator).chain(signs);
    by_signs
        .map(|by| by.cells(line))
        .chain([joined(Separator::Blanks.cells(line))])
        .find(|cells| cells.len() == width)
}
