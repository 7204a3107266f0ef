//! Loading histories: the driving velocity that changes on the way, in steps, holds and ramps.

use super::file::read_bounded;
use super::options::number;
use super::text::given_text;
use super::units::{Quantity, Units};
use std::borrow::Cow;
use std::path::Path;
use twinslip::error::{Error, Result};

/// No file of changes is longer, in bytes.
const LONGEST: u64 = 1 << 24;
/// Times nearer to each other than this, relative to the later one, are one but for rounding.
const APART: f64 = 1e-12;
/// Programs of more changes are told by their number.
const TOLD: usize = 100;
/// The columns of a file; the last one is of ramps alone.
const COLUMNS: [&str; 3] = ["time", "driving", "until"];

/// A change of the driving velocity, in the user's units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Change {
    /// When it begins.
    pub time: f64,
    /// When a ramp ends; `None` for a step.
    pub until: Option<f64>,
    /// V_H from then on.
    pub driving: f64,
}

impl Change {
    /// When V_H is what it is changed to.
    fn end(&self) -> f64 {
        self.until.unwrap_or(self.time)
    }
}

/// A stretch of a run, in which V_H is constant or changes at a steady rate; dimensionless.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stretch {
    /// Its begin and its end.
    pub span: (f64, f64),
    /// V_H at both.
    pub driving: (f64, f64),
}

impl Stretch {
    /// dV_H/dt.
    pub fn rate(&self) -> f64 {
        let (from, to) = self.driving;
        if from == to {
            0.0
        } else {
            (to - from) / (self.span.1 - self.span.0)
        }
    }

    /// V_H at a time.
    pub fn driving_at(&self, t: f64) -> f64 {
        if t >= self.span.1 {
            return self.driving.1;
        }
        self.driving.0 + self.rate() * (t - self.span.0)
    }
}

/// All changes of a run, in the order of time.
#[derive(Debug, Clone, PartialEq)]
pub struct Program {
    /// The changes, at least one.
    pub changes: Vec<Change>,
}

impl Program {
    /// `T:V` for a step and `T1-T2:V` for a ramp, comma-separated; or the name of a CSV file with the columns `time`, `driving`
    /// and, for ramps, `until`, or the text of such a file. `end` is that of the run.
    ///
    /// # Errors
    /// [`Error::Input`] for what can't be read, and for times and velocities outside their domain, with the place;
    /// [`Error::File`].
    pub fn read(text: &str, end: f64) -> Result<Self> {
        let (changes, place): (_, Box<dyn Fn(usize) -> String>) = if is_table(text) {
            let name = given_text(Path::new(text)).map_or(text, |_| "(a text)");
            let (changes, lines) = from_table(name, text)?;
            let place = move |i: usize| format!("`program` {name}:{}", lines[i]);
            (changes, Box::new(place))
        } else {
            let parts: Vec<&str> = text.split(',').map(str::trim).collect();
            let changes = parts.iter().map(|part| from_text(part));
            let changes: Vec<Change> = changes.collect::<Result<_>>()?;
            let place = move |i: usize| format!("`program` {}", shown(parts[i]));
            (changes, Box::new(place))
        };
        check(&changes, end, &*place)?;
        Ok(Program { changes })
    }

    /// The velocity from the beginning on, where the first change is a step at 0.
    pub fn first(&self) -> Option<f64> {
        let change = self.changes.first()?;
        (change.time == 0.0 && change.until.is_none()).then_some(change.driving)
    }

    /// The same as one would type it, or how many changes there are.
    pub fn told(&self) -> String {
        if self.changes.len() > TOLD {
            return format!("{} changes", twinslip::error::count(self.changes.len()));
        }
        let one = |change: &Change| match change.until {
            Some(until) => format!("{}-{until}:{}", change.time, change.driving),
            None => format!("{}:{}", change.time, change.driving),
        };
        let all: Vec<String> = self.changes.iter().map(one).collect();
        all.join(",")
    }

    /// The stretches of a run up to a time, from a velocity on, both dimensionless.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a velocity that is beyond doubles without its unit.
    pub(super) fn stretches(&self, first: f64, end: f64, units: &Units) -> Result<Vec<Stretch>> {
        let time = |t| units.inward(Quantity::Time, t);
        let velocity = |v| match units.inward(Quantity::SlipRate, v) {
            inward if inward.is_finite() => Ok(inward),
            _ => Err(Error::parameter("program", v, "a velocity within doubles")),
        };
        let stretch = |span, driving| Stretch { span, driving };
        let (mut stretches, mut now, mut driving) = (Vec::new(), 0.0, first);
        for change in &self.changes {
            let (from, next) = (time(change.time), velocity(change.driving)?);
            if from > now {
                stretches.push(stretch((now, from), (driving, driving)));
            }
            if let Some(until) = change.until {
                stretches.push(stretch((from, time(until)), (driving, next)));
            }
            (now, driving) = (time(change.end()), next);
        }
        // Also where it ends with a change: the run then ends on its far side.
        stretches.push(stretch((now, end), (driving, driving)));
        Ok(stretches)
    }
}

/// That times ascend to the end of the run at most, and velocities do not pull back.
fn check(changes: &[Change], end: f64, place: &dyn Fn(usize) -> String) -> Result<()> {
    let mut before: Option<Change> = None;
    for (i, change) in changes.iter().enumerate() {
        let wrong = |what: String| Err(Error::Input(format!("{}: {what}", place(i))));
        let Change { time, driving, .. } = *change;
        if time < 0.0 {
            return wrong(format!("the time is {time}, but must be 0 or positive"));
        }
        if let Some(before) = before.filter(|before| !apart(before.end(), time)) {
            // Ramps may meet each other and steps.
            let meets = time == before.end() && (before.until.or(change.until)).is_some();
            if !meets {
                return wrong(format!(
                    "the time is {time}, but must be after {}, the time of the change before",
                    before.end()
                ));
            }
        }
        if let Some(until) = change.until.filter(|&until| !apart(time, until)) {
            return wrong(format!(
                "the ramp ends at {until}, but must end after it begins, at {time}"
            ));
        }
        let last = change.end();
        if last > end || (last < end && !apart(last, end)) {
            let nearer = if last < end {
                ", or less by more than rounding"
            } else {
                ""
            };
            return wrong(format!(
                "the time is {last}, but must be at most {end}, when the run ends{nearer}"
            ));
        }
        if driving < 0.0 {
            return wrong(format!(
                "the driving velocity is {driving}, but must be 0 or positive"
            ));
        }
        before = Some(*change);
    }
    Ok(())
}

fn apart(earlier: f64, later: f64) -> bool {
    later - earlier > APART * later.abs()
}

/// A part of a text that may be long.
fn shown(part: &str) -> String {
    const SHOWN: usize = 40;
    let begin: String = part.chars().take(SHOWN).collect();
    let more = if begin.len() < part.len() { "..." } else { "" };
    format!("{:?}", begin + more)
}

/// `T:V` or `T1-T2:V`.
fn from_text(part: &str) -> Result<Change> {
    let read = |text: &str| {
        number(text)
            .map(|x| x + 0.0)
            .map_err(|why| Error::Input(format!("`program` {}: {text:?} {why}", shown(part))))
    };
    let Some((when, driving)) = part.split_once(':') else {
        return Err(Error::Input(format!(
            "`program` {} must be T:V, for a ramp T1-T2:V, several of them comma-separated, or a file FILE.csv",
            shown(part)
        )));
    };
    let (time, until) = match ramp(when) {
        Some((from, to)) => (read(from)?, Some(read(to)?)),
        None => (read(when)?, None),
    };
    Ok(Change {
        time,
        until,
        driving: read(driving)?,
    })
}

/// The times of `T1-T2`: parted by a hyphen that is no sign, of a number or of its exponent.
fn ramp(when: &str) -> Option<(&str, &str)> {
    let mut before = ' ';
    for (i, c) in when.char_indices() {
        if c == '-' && !matches!(before, ' ' | 'e' | 'E') {
            return Some((&when[..i], &when[i + 1..]));
        }
        before = c;
    }
    None
}

/// Whether changes are in the rows of a table: of a CSV file, or of a text whose first line names columns and has no change.
pub(super) fn is_table(text: &str) -> bool {
    let remark = |line: &&str| line.trim().is_empty() || line.starts_with('#');
    match given_text(Path::new(text)) {
        None => text.to_lowercase().ends_with(".csv"),
        Some(text) => text
            .lines()
            .find(|line| !remark(line))
            .is_some_and(|head| !head.contains(':')),
    }
}

/// The changes in the rows of a file or of its text, by the names of its columns, with the line of each.
fn from_table(name: &str, given: &str) -> Result<(Vec<Change>, Vec<u64>)> {
    let text: Cow<'_, str> = match given_text(Path::new(given)) {
        Some(text) => text.into(),
        None => read_bounded(Path::new(given), LONGEST)?.into(),
    };
    let wrong = |line: u64, what: String| Error::Input(format!("`program` {name}:{line}: {what}"));
    let mut reader = csv::ReaderBuilder::new();
    let mut reader = reader
        .comment(Some(b'#'))
        .trim(csv::Trim::All)
        .from_reader(text.as_bytes());
    let unreadable = |error: csv::Error| {
        let line = error.position().map_or(1, csv::Position::line);
        wrong(line, format!("it is no CSV, {error}"))
    };
    let header = reader.headers().map_err(unreadable)?.clone();
    let places = COLUMNS.map(|column| header.iter().position(|name| name == column));
    if let Some(other) = header.iter().find(|name| !COLUMNS.contains(name)) {
        return Err(Error::unknown(
            format!("a column of `program` {name}"),
            other,
            &COLUMNS,
        ));
    }
    let [Some(time), Some(driving), until] = places else {
        let missing = COLUMNS[usize::from(places[0].is_some())];
        return Err(wrong(1, format!("the column {missing} is missing")));
    };
    let (mut changes, mut lines) = (Vec::new(), Vec::new());
    for record in reader.records() {
        let record = record.map_err(unreadable)?;
        let line = record.position().map_or(1, |at| {
            // The reader counts empty lines and remarks before a row to it.
            let from = text.get(at.byte() as usize..).unwrap_or_default();
            let skipped = |line: &&str| line.trim().is_empty() || line.starts_with('#');
            at.line() + from.lines().take_while(skipped).count() as u64
        });
        let cell = |place: usize| {
            let text = record.get(place).unwrap_or_default();
            number(text)
                .map(|x| x + 0.0)
                .map_err(|why| wrong(line, format!("{} {text:?} {why}", &header[place])))
        };
        let filled = |place: &usize| record.get(*place).is_some_and(|text| !text.is_empty());
        changes.push(Change {
            time: cell(time)?,
            until: until.filter(filled).map(cell).transpose()?,
            driving: cell(driving)?,
        });
        lines.push(line);
    }
    if changes.is_empty() {
        return Err(wrong(1, "there is no row".into()));
    }
    Ok((changes, lines))
}
