//! What all commands share: format and place of the output, the object around a result, remarks, messages.

use super::call::{Call, Outlet};
use super::progress::Progress;
use super::{Ending, interrupt, written};
use serde::Serialize;
use serde_json::{Value, json};
use std::io::{self, IsTerminal, Write};
use std::path::Path;
use std::sync::Arc;
use twinslip::error::{Error, Result};
use twinslip::integrate::Work;
use twinslip::number::Uncertain;
use twinslip_output::{
    CsvRows, Envelope, Format, Over, Place, RowFile, RowWriter, Status, TableRows, plot,
};
use twinslip_tasks::scene::{Column, Described, OutputOptions, Quantity, Units};
use twinslip_tasks::views;

/// Where a command's output goes, checked.
pub struct Report<'a> {
    /// In which form.
    pub format: Format,
    /// Where to.
    pub place: Place,
    /// No talk.
    pub quiet: bool,
    /// The file of rows, which is written row by row; none for a whole object, for a device and for a pipe.
    pub file: Option<RowFile>,
    /// What the command was called by.
    pub call: &'a Call,
}

/// Checks where results and a picture go, and says what will be computed.
pub fn begun<'a>(
    (options, plot): (&OutputOptions, Option<&Path>),
    call: &'a Call,
    explain: impl FnOnce() -> String,
) -> Result<Report<'a>> {
    if let Some(path) = plot {
        plot::PictureFormat::of(path)?;
    }
    let plots: Vec<&Path> = plot.into_iter().collect();
    let report = Report::new(options, call, &plots)?;
    if options.explain {
        call.say(explain());
    }
    Ok(report)
}

impl<'a> Report<'a> {
    /// Chooses the format and makes sure that all files can be written, before anything is computed.
    pub fn new(options: &OutputOptions, call: &'a Call, others: &[&Path]) -> Result<Self> {
        let over = if options.force {
            Over::All
        } else {
            Over::Ended
        };
        Self::over(options, call, others, over)
    }

    /// The same where a file of rows may be replaced that others would be refused.
    pub fn over(
        options: &OutputOptions,
        call: &'a Call,
        others: &[&Path],
        over: Over,
    ) -> Result<Self> {
        if call.outlet.is_some() {
            return Ok(Report {
                format: Format::Json,
                place: Place::Standard,
                quiet: options.quiet,
                file: None,
                call,
            });
        }
        let place = Place::new(options.output.as_deref());
        let terminal = std::io::stdout().is_terminal();
        if let Some(path) = others.iter().find(|path| place.path() == Some(path)) {
            return Err(Error::Input(format!(
                "{} cannot be both data and picture",
                path.display()
            )));
        }
        let format = Format::choose(options.format.as_deref(), place.path(), terminal)?;
        let rows = place.path().filter(|_| format != Format::Json);
        let file = match rows {
            Some(path) => RowFile::claim(path, over)?,
            None => place.check().map(|()| None)?,
        };
        if let (Some(_), Some(path)) = (&file, rows) {
            interrupt::keeps(format!("the rows so far are in {}", path.display()));
        }
        for path in others {
            Place::File(path.to_path_buf()).check()?;
        }
        Ok(Report {
            format,
            place,
            quiet: options.quiet,
            file,
            call,
        })
    }

    /// The same where the CSV of an earlier run may be gone on with, which is then the place of the output.
    pub fn resuming(
        options: &OutputOptions,
        call: &'a Call,
        (resume, plot): (Option<&Path>, Option<&Path>),
    ) -> Result<Self> {
        if let Some(path) = plot {
            plot::PictureFormat::of(path)?;
        }
        let others: Vec<&Path> = plot.into_iter().collect();
        let goes_on = |report: &Report<'_>| {
            if let (Some(_), Format::Csv, Some(path)) =
                (&report.file, report.format, report.place.path())
            {
                interrupt::keeps(format!("resume with --resume {}", path.display()));
            }
        };
        let Some(resumed) = resume else {
            let report = Report::new(options, call, &others)?;
            goes_on(&report);
            return Ok(report);
        };
        let refused = |why: &str| Err(Error::Input(format!("--resume {}{why}", resumed.display())));
        let output = options.output.as_deref();
        if output.is_some_and(|output| output != resumed) {
            return refused(" writes into that file; leave out --output");
        }
        // What can be gone on with is CSV, whatever its name.
        let csv = || (resumed.extension() != Some("json".as_ref())).then(|| "csv".to_owned());
        let output = OutputOptions {
            output: Some(resumed.to_owned()),
            format: options.format.clone().or_else(csv),
            ..options.clone()
        };
        let report = Report::over(&output, call, &others, Over::All)?;
        match (report.format, &report.file) {
            (Format::Csv, Some(_)) => {
                if !resumed.exists() {
                    report.say(format_args!(
                        "{} does not exist yet: nothing to resume",
                        resumed.display()
                    ));
                }
                goes_on(&report);
                Ok(report)
            }
            (Format::Csv | Format::Table, None) => refused(": only a file can be resumed"),
            _ if report.place.path().is_none() => refused(": only a file can be resumed"),
            _ => refused(
                ": only CSV can be resumed; leave out --format, and name a file that does not end in .json",
            ),
        }
    }

    /// A message on standard error.
    pub fn say(&self, text: impl std::fmt::Display) {
        if !self.quiet {
            self.call.say(text);
        }
    }

    /// How a command ends that has left something undecided: it says what is, and what would help.
    pub fn undecided(&self, what: impl std::fmt::Display) -> Ending {
        self.say(format_args!("undecided: {what}"));
        Ending::Undecided
    }

    /// Shows how far the command has come.
    pub fn progress(&self) -> Progress {
        self.call.progress(self.quiet)
    }

    /// Whether rows are written as they come, not only at the end in an object.
    pub fn streams(&self) -> bool {
        self.format != Format::Json || self.call.outlet.is_some()
    }

    /// Whether the rows are in the object.
    pub fn repeats(&self) -> bool {
        let all = |outlet: &Arc<dyn Outlet>| outlet.keeps_all();
        !self.streams() || self.call.outlet.as_ref().is_some_and(all)
    }

    /// Hands on rows that are in the object too, to whom takes both.
    pub fn hand_on<'r, R: 'r>(
        &self,
        units: &Units,
        columns: &[Column<R>],
        rows: impl IntoIterator<Item = &'r R>,
    ) {
        let Some(outlet) = self.call.outlet.as_ref().filter(|one| one.keeps_all()) else {
            return;
        };
        let (names, quantities): (Vec<_>, Vec<_>) =
            views::names(columns, false).into_iter().unzip();
        outlet.columns(&names);
        outlet.units(&unit_names(units, quantities.into_iter()));
        for row in rows {
            outlet.row(&views::cells(columns, row, units, false));
        }
    }

    /// Writes an object.
    pub fn write(&self, bytes: &[u8]) -> Result<Ending> {
        match &self.call.outlet {
            Some(outlet) => {
                outlet.object(bytes);
                Ok(Ending::Done)
            }
            None => written(self.place.write(bytes), &self.place),
        }
    }

    /// Draws into a file, or hands the picture on.
    pub fn draw(&self, path: &Path, drawing: &plot::Drawing) -> Result<()> {
        match &self.call.outlet {
            Some(outlet) => {
                outlet.picture(drawing);
                Ok(())
            }
            None => plot::write(path, drawing),
        }
    }

    /// Begins the table or CSV, a new one.
    pub fn begin(
        &self,
        mut remarks: Vec<String>,
        columns: &[String],
        units: &[String],
    ) -> io::Result<Box<dyn RowWriter>> {
        if let Some(rows) = self.call.rows(columns, units) {
            return Ok(rows);
        }
        let mut to = self.stream(0)?;
        if self.file.is_some() {
            remarks.push(Status::Unfinished.remark());
            if self.format == Format::Table {
                remarks
                    .iter()
                    .try_for_each(|remark| writeln!(to, "# {remark}"))?;
            }
        }
        self.rows(to, &remarks, columns, units)
    }

    /// Where rows go: in a file after the first so many bytes of it.
    pub fn stream(&self, bytes: u64) -> io::Result<Box<dyn Write>> {
        match &self.file {
            Some(file) => Ok(Box::new(file.after(bytes)?)),
            None => self.place.stream().map_err(io::Error::other),
        }
    }

    /// Says in the file how the run ended; hands on what is said of it.
    pub fn ended(&self, ended: Result<Ending>) -> Result<Ending> {
        let status = match &ended {
            Ok(Ending::Interrupted) => Status::Unfinished,
            Ok(_) => Status::Complete(None),
            Err(error) if error.is_input() => return ended,
            Err(_) => Status::Failed,
        };
        self.end(status)?;
        ended
    }

    /// Says in the file how far its rows are.
    pub fn end(&self, status: Status) -> Result<()> {
        self.file.as_ref().map_or(Ok(()), |file| file.end(status))
    }

    /// The `# ` lines of CSV: program, command, parameters, units.
    pub fn remarks(&self, system: &dyn Described, numerics: &Value) -> Vec<String> {
        remarks(&self.call.words, system, numerics)
    }

    /// Begins a table or CSV at any place.
    pub fn rows(
        &self,
        to: Box<dyn std::io::Write>,
        remarks: &[String],
        columns: &[String],
        units: &[String],
    ) -> std::io::Result<Box<dyn RowWriter>> {
        self.rows_as(self.format, to, remarks, columns, units)
    }

    /// The same in another format than the command's rows.
    pub fn rows_as(
        &self,
        format: Format,
        to: Box<dyn std::io::Write>,
        remarks: &[String],
        columns: &[String],
        units: &[String],
    ) -> std::io::Result<Box<dyn RowWriter>> {
        Ok(match format {
            Format::Table => self.table(to, columns, units)?,
            Format::Csv | Format::Json => Box::new(CsvRows::new(to, remarks, columns)?),
        })
    }

    /// Writes all rows as a table or CSV, below remarks.
    pub fn write_all<'r, R: 'r>(
        &self,
        units: &Units,
        remarks: Vec<String>,
        columns: &[Column<R>],
        rows: impl IntoIterator<Item = &'r R>,
    ) -> Result<Ending> {
        let table = self.format == Format::Table;
        let (names, quantities): (Vec<_>, Vec<_>) =
            views::names(columns, table).into_iter().unzip();
        let unit_names = unit_names(units, quantities.into_iter());
        let all = self
            .begin(remarks, &names, &unit_names)
            .and_then(|mut writer| {
                let mut rows = rows.into_iter();
                rows.try_for_each(|row| writer.row(&views::cells(columns, row, units, table)))
            });
        self.ended(written(all, &self.place))
    }

    /// Opens a table no wider than the terminal, and says which columns that has no room for.
    fn table(
        &self,
        to: Box<dyn std::io::Write>,
        columns: &[String],
        units: &[String],
    ) -> std::io::Result<Box<dyn RowWriter>> {
        let width = match self.place {
            Place::Standard => terminal_size::terminal_size_of(std::io::stdout()),
            Place::File(_) => None,
        };
        let width = width.map_or(usize::MAX, |(width, _)| usize::from(width.0));
        let table = TableRows::within(width, to, columns, units)?;
        if !table.hidden().is_empty() {
            self.say(format!(
                "no room for {}: widen the terminal, or ask for --format csv or json",
                table.hidden().join(", ")
            ));
        }
        Ok(Box::new(table))
    }

    /// The object of a command as one line.
    pub fn envelope<R: Serialize>(
        &self,
        system: &dyn Described,
        numerics: Value,
        result: R,
        work: Value,
        error: Option<&Error>,
    ) -> Vec<u8> {
        let envelope = Envelope {
            twinslip: env!("CARGO_PKG_VERSION"),
            command: &self.call.words,
            sundials: sundials(),
            model: system.echo(),
            units: units(system.units()),
            numerics,
            result,
            work,
            error: error.map(|error| {
                self.call
                    .told(&system.units().told(error.clone()).to_string())
            }),
        };
        let mut bytes = serde_json::to_vec(&envelope).expect("numbers and names can be written");
        bytes.push(b'\n');
        bytes
    }
}

/// The `# ` lines of CSV made by a command: program, command, parameters, units.
pub fn remarks(words: &[String], system: &dyn Described, numerics: &Value) -> Vec<String> {
    remarks_of(words, system.echo(), numerics, &system.units().names())
}

/// The same by what an object has of them.
pub fn remarks_of(
    words: &[String],
    echo: &serde_json::Map<String, Value>,
    numerics: &Value,
    units: &[(&str, &str)],
) -> Vec<String> {
    let list = |pairs: &serde_json::Map<String, Value>| {
        let pairs: Vec<String> = pairs
            .iter()
            .filter(|(_, value)| !value.is_null())
            .map(|(name, value)| match value.as_str() {
                Some(text) => format!("{name} = {text}"),
                None => format!("{name} = {value}"),
            })
            .collect();
        pairs.join(", ")
    };
    let words: Vec<String> = words.iter().map(|word| quoted(word)).collect();
    let with_units = units.iter().filter(|(_, unit)| *unit != "1");
    let units: Vec<String> = with_units
        .map(|(name, unit)| format!("{name} [{unit}]"))
        .collect();
    let mut remarks = vec![
        format!("twinslip {}", env!("CARGO_PKG_VERSION")),
        format!("command: {}", words.join(" ")),
        format!("model: {}", list(echo)),
    ];
    if let Some(numerics) = numerics.as_object().filter(|map| !map.is_empty()) {
        remarks.push(format!("numerics: {}", list(numerics)));
    }
    if !units.is_empty() {
        remarks.push(format!("units: {}", units.join(", ")));
    }
    remarks
}

/// The version of SUNDIALS, where it is built in.
pub fn sundials() -> Option<String> {
    #[cfg(feature = "sundials")]
    return Some(twinslip::sundials::version().to_owned());
    #[cfg(not(feature = "sundials"))]
    return None;
}

fn units(units: &Units) -> Value {
    let names = units
        .names()
        .into_iter()
        .map(|(name, unit)| (name.to_owned(), json!(unit)));
    Value::Object(names.into_iter().collect())
}

/// The names of the units of some quantities.
pub fn unit_names(units: &Units, quantities: impl Iterator<Item = Quantity>) -> Vec<String> {
    quantities
        .map(|quantity| units.name(quantity).to_owned())
        .collect()
}

/// A quantity with its error budget, in the user's units.
pub fn uncertain(units: &Units, quantity: Quantity, x: Uncertain) -> Value {
    let x = units.outward_uncertain(quantity, x);
    twinslip_output::uncertain((x.value, x.uncertainty))
}

/// The work as an object.
pub fn work(work: &Work) -> Value {
    json!({
        "steps": work.steps,
        "rejected": work.rejected,
        "rhs": work.rhs,
        "jacobians": work.jacobians,
        "factorisations": work.factorisations,
        "nonlinear": work.nonlinear,
    })
}

/// A word as a shell would need it.
fn quoted(word: &str) -> String {
    let plain = |c: char| c.is_alphanumeric() || "-_=./,:+".contains(c);
    if !word.is_empty() && word.chars().all(plain) {
        word.to_owned()
    } else if word.contains('\n') {
        // A remark has one line.
        let escaped = word.replace('\\', r"\\").replace('\'', r"\'");
        format!("$'{}'", escaped.replace('\n', r"\n"))
    } else {
        format!("'{}'", word.replace('\'', r"'\''"))
    }
}
