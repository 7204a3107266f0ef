//! The head of a laboratory's file: the names of its columns, and their units.

use super::cells::Separator;
use super::roles::{is_known, is_name};
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
    /// `Displ(microns)`, `Time [s]`, `Shear stress (tau) [MPa]`, `shear_stress_MPa`, `friction`.
    pub fn of(text: &str) -> Self {
        let (name, behind) = match text.find(['(', '[']) {
            Some(at) if at > 0 => text.split_at(at),
            _ => (text, ""),
        };
        let groups = behind.split(['(', '[']).skip(1);
        let groups: Vec<&str> = groups
            .map(|group| group.split([')', ']']).next().unwrap_or(group).trim())
            .filter(|group| !group.is_empty())
            .collect();
        // A symbol in parentheses is another name of the column, anything else is meant as its unit.
        let unit = groups.iter().find(|group| is_unit(group));
        let is_name = |group: &&&str| !is_name(&plain(group));
        let unit = unit.or_else(|| groups.iter().find(is_name));
        let name = name
            .trim()
            .trim_end_matches(['_', ',', ':', '/'])
            .trim_end();
        // The longest end of the name that is a unit: `um/s` of `velocity_um/s`.
        let ends = name.char_indices();
        let mut ends = ends.filter(|(at, c)| *at > 0 && "_ ,/-.:".contains(*c));
        let suffix = ends.find_map(|(at, _)| {
            let (stem, end) = (&name[..at], &name[at + 1..]);
            is_unit(end).then(|| (stem.trim().to_owned(), end.trim().to_owned()))
        });
        Heading {
            name: name.to_owned(),
            unit: unit.map(|unit| (*unit).to_owned()),
            suffix,
        }
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

/// A name without case, accents and signs.
pub(super) fn plain(name: &str) -> String {
    let letters = name.chars().filter(|c| c.is_alphanumeric());
    letters
        .flat_map(char::to_lowercase)
        .map(|c| match c {
            // The micro sign is the Greek letter.
            'µ' => 'μ',
            'á' | 'à' | 'â' | 'ä' => 'a',
            'é' | 'è' | 'ê' => 'e',
            'í' | 'ì' => 'i',
            'ó' | 'ò' | 'ö' => 'o',
            'ú' | 'ù' | 'ü' => 'u',
            c => c,
        })
        .collect()
}

/// The head of a file with so many columns, from the lines before its numbers: the line that names most columns that are known, and that
/// below it where it holds units. Titles are no names. `remarks` are looked at where no other line has the names.
pub(super) fn headings_of(
    words: &[&str],
    remarks: &[&str],
    (separator, width): (Separator, usize),
) -> Vec<Heading> {
    let known = |cells: &[String]| {
        let each = cells.iter().map(|cell| Heading::of(cell));
        each.filter(|one| is_known(&one.plain_names())).count()
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
    let owned =
        |cells: Vec<&str>| -> Vec<String> { cells.into_iter().map(str::to_owned).collect() };
    // Columns without a name or a unit stand as empty cells at the end, and so do names of columns without numbers.
    if let Separator::Sign(_) = separator
        && separator.cells(line).count() >= width
    {
        let mut cells = owned(separator.filled(line));
        cells.resize(width.max(cells.len()), String::new());
        return Some(cells);
    }
    let joined = |cells: Vec<&str>| {
        // `Time (s)` is one name.
        let mut all: Vec<String> = Vec::new();
        for cell in cells {
            match all.last_mut() {
                Some(last) if cell.starts_with(['(', '[']) && !last.starts_with(['(', '[']) => {
                    *last += &format!(" {cell}");
                }
                _ => all.push(cell.to_owned()),
            }
        }
        all
    };
    let signs = [b';', b'\t', b','].map(Separator::Sign);
    // Names of several words stand two blanks apart.
    let apart = line.split("  ").map(str::trim);
    let apart: Vec<&str> = apart.filter(|cell| !cell.is_empty()).collect();
    std::iter::once(separator)
        .chain(signs)
        .map(|by| owned(by.filled(line)))
        .chain([joined(Separator::Blanks.filled(line)), owned(apart)])
        .find(|cells: &Vec<String>| cells.len() == width)
}
