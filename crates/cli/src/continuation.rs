//! What `branch` and `locus` share: rows on their way out, special points, how a run ends.

use super::call::Call;
use super::progress::{Progress, during};
use super::report::{Report, unit_names};
use super::resume::{EarlierRun, Expected, ReadRow, beside, row_key, special_key};
use super::rows::{CurveRow, Found, SpecialPoint};
use super::words::{several, time};
use super::{Ending, interrupt, special, written};
use serde_json::{Value, json};
use std::fs::File;
use std::io::{self, IsTerminal, Write};
use std::ops::ControlFlow;
use std::path::PathBuf;
use std::time::Instant;
use twinslip::bifurcation::{Criticality, Label};
use twinslip::error::{Error, Result};
use twinslip::integrate::Choice;
use twinslip_output::{Format, Over, ROW_CHECK, RowFile, RowWriter, Status, checked_line, plot};
use twinslip_tasks::scene::{Column, Described, OutputOptions, Quantity};
use twinslip_tasks::views;

/// How a special point of orbits is computed once more, by which method.
pub type Recheck<'a, S> = (Choice, &'a dyn Fn(&S) -> Result<Option<Vec<f64>>>);

/// Whether to go on.
pub type FoundObserver<'a, R> = &'a mut dyn FnMut(Found<R>) -> ControlFlow<()>;

/// What a table says of special points, in lines.
pub type SpecialLines<'a, S> = &'a dyn Fn(&[S], &special::Checks<'_>) -> Vec<String>;

/// Everything that a run needs.
pub struct Task<'a, R: CurveRow> {
    /// What the rows are of.
    pub system: &'a dyn Described,
    /// What rows of one number make up, and what several do: `["branch", "branches"]`.
    pub whole: [&'static str; 2],
    /// What is said where there is none.
    pub nothing: &'a str,
    /// The names of the parameters that vary.
    pub names: Vec<&'a str>,
    /// The columns of rows.
    pub columns: Vec<Column<R>>,
    /// The columns of special points.
    pub special_columns: Vec<Column<R::Special>>,
    /// Rows and special points from the cells of an earlier run.
    pub read: (ReadRow<'a, R>, ReadRow<'a, R::Special>),
    /// Special points in lines of a table.
    pub lines: SpecialLines<'a, R::Special>,
    /// What was asked for.
    pub numerics: Value,
    /// How special points are computed once more, where they are.
    pub second: Option<Recheck<'a, R::Special>>,
    /// The file to go on with.
    pub resume: Option<&'a PathBuf>,
    /// The picture.
    pub plot: Option<&'a PathBuf>,
    /// Where results go.
    pub output: &'a OutputOptions,
    /// The command line.
    pub call: &'a Call,
}

impl<'a, R: CurveRow> Task<'a, R> {
    /// Files and format, checked before anything is computed.
    pub fn report(&self) -> Result<Report<'a>> {
        let (resume, plot) = (self.resume, self.plot);
        Report::resuming(
            self.output,
            self.call,
            (resume.map(PathBuf::as_path), plot.map(PathBuf::as_path)),
        )
    }

    /// Computes, writes, draws; says how it ended.
    pub fn run(
        &self,
        report: &Report<'_>,
        compute: impl FnOnce(&[usize], FoundObserver<'_, R>) -> Result<()>,
        picture: impl Fn(&[R], &[R::Special]) -> plot::Drawing,
    ) -> Result<Ending> {
        let (call, mut out) = (self.call, ContinuationOut::new(self, report)?);
        call.watch();
        let skipped = std::mem::take(&mut out.skipped);
        out.progress.begin("looking for the first point");
        let computed = match out.complete {
            true => Ok(()),
            false => compute(&skipped, &mut |found| out.take(found)),
        };
        let failure = match computed {
            Err(error) if error.is_input() && out.new == 0 => return Err(error),
            computed => computed.err(),
        };
        if let Err(error) = out.open() {
            out.broken.get_or_insert(error);
        }
        if let Some(error) = out.broken.take() {
            out.progress.finish();
            return written(Err(error), &report.place);
        }
        out.end(failure.is_some())?;
        let seconds = out.progress.finish();
        let begun = Instant::now();
        let checks = self.recheck(report, &out.special, failure.is_some());
        call.unwatch();
        let seconds = (seconds + begun.elapsed()).as_secs_f64();
        let ending = self.write(report, &out, &checks, failure.as_ref())?;
        match self.plot {
            Some(path) if !out.rows.is_empty() => {
                report.draw(path, &picture(&out.rows, &out.special))?;
            }
            Some(_) => report.say("there is no point to draw"),
            None => {}
        }
        report.say(out.summary(seconds));
        let empty = out.rows.is_empty() && out.special.is_empty();
        if empty && failure.is_none() && !call.stops() {
            report.say(self.nothing);
        }
        match failure {
            Some(error) => Err(error),
            None if call.stops() => Ok(Ending::Interrupted),
            None if ending == Ending::Done => Ok(out.ending()),
            None => Ok(ending),
        }
    }

    /// Every special point by the second method.
    fn recheck(
        &self,
        report: &Report<'_>,
        special: &[R::Special],
        failed: bool,
    ) -> special::Checks<'_> {
        let mut checks = special::Checks {
            names: match self.names[..] {
                [] => vec!["driving", "stiffness"],
                _ => self.names.clone(),
            },
            ..special::Checks::default()
        };
        let Some((method, again)) = self.second.filter(|_| !failed) else {
            return checks;
        };
        checks.method = Some(method.name());
        let words = format!("computing the special points by {}", method.name());
        let mut unchecked = Vec::new();
        during(report, &words, || {
            for one in special.iter().take_while(|_| !self.call.stops()) {
                let difference = again(one).unwrap_or_else(|error| {
                    unchecked.push((one, error));
                    None
                });
                checks.differences.push(difference);
            }
        });
        for (one, error) in unchecked {
            let label = one.label().map_or("", Label::name);
            report.say(format!(
                "the crosscheck of {label} at {} by {} failed: {error}",
                one.place(&self.names, self.system.units()),
                method.name()
            ));
        }
        checks
    }

    /// The object, or the special points in words.
    fn write(
        &self,
        report: &Report<'_>,
        out: &ContinuationOut<'_, R>,
        checks: &special::Checks<'_>,
        failure: Option<&Error>,
    ) -> Result<Ending> {
        if report.format != Format::Json {
            for line in (self.lines)(&out.special, checks) {
                report.say(line);
            }
            return Ok(Ending::Done);
        }
        let units = self.system.units();
        if let Some(outlet) = &self.call.outlet {
            let names = views::names(&self.special_columns, false).into_iter();
            let names: Vec<String> = names.map(|(name, _)| name).collect();
            let cells = |one| views::cells(&self.special_columns, one, units, false);
            outlet.special(&names, out.special.iter().map(cells).collect());
        }
        // Those that were handed on need not be there twice.
        let rows = out.rows.iter().filter(|_| report.repeats());
        let rows: Vec<Value> = rows
            .map(|row| Value::Object(views::object(&self.columns, row, units)))
            .collect();
        let result = json!({
            "rows": rows,
            "special": special::objects(&out.special, &self.special_columns, checks, units),
        });
        let bytes = report.envelope(
            self.system,
            self.numerics.clone(),
            result,
            json!({"points": out.new}),
            failure,
        );
        report.write(&bytes)
    }
}

/// Where rows go.
enum ContinuationSink {
    Nothing,
    Table(Box<dyn RowWriter>),
    /// Checked lines of rows, and of special points where there is a file for them.
    Lines(Box<dyn Write>, Option<File>),
}

/// Takes what is found: writes it and keeps it.
struct ContinuationOut<'a, R: CurveRow> {
    task: &'a Task<'a, R>,
    report: &'a Report<'a>,
    remarks: Vec<String>,
    names: Vec<(String, Quantity)>,
    /// Opened with the first row: a request that is refused leaves no file.
    to: ContinuationSink,
    /// The file of special points beside that of the rows.
    special_file: Option<RowFile>,
    broken: Option<io::Error>,
    /// Whether an earlier run has left nothing to do.
    complete: bool,
    /// Where what stays of an earlier run ends, in the file of rows and in that of special points.
    bytes: [u64; 2],
    /// So many special points stay.
    kept_special: usize,
    skipped: Vec<usize>,
    rows: Vec<R>,
    new: usize,
    special: Vec<R::Special>,
    progress: Progress,
    /// Rows scroll by on the terminal: progress enough, once the first one is there.
    scrolling: bool,
}

impl<'a, R: CurveRow> ContinuationOut<'a, R> {
    fn new(task: &'a Task<'a, R>, report: &'a Report<'a>) -> Result<Self> {
        let remarks = report.remarks(task.system, &task.numerics);
        let table = report.format == Format::Table;
        let names = views::names(&task.columns, table);
        let mut kept = EarlierRun::default();
        let csv = report
            .place
            .path()
            .filter(|_| report.file.is_some() && report.format == Format::Csv);
        let special_file = match csv {
            // Whoever may replace the rows may replace what belongs to them.
            Some(path) if !task.output.force => RowFile::claim(&beside(path), Over::Ours)?,
            Some(path) => RowFile::claim(&beside(path), Over::All)?,
            None => None,
        };
        if let Some(path) = task.resume {
            let [rows, special] = [
                checked(&names),
                checked(&views::names(&task.special_columns, false)),
            ];
            let expected = |columns| Expected {
                remarks: &remarks,
                columns,
            };
            kept = EarlierRun::read(path, &expected(&rows), &expected(&special), task.read)?;
        }
        let scrolling = report.format != Format::Json
            && report.place.path().is_none()
            && io::stdout().is_terminal();
        Ok(ContinuationOut {
            task,
            report,
            remarks,
            names,
            to: ContinuationSink::Nothing,
            special_file,
            broken: None,
            complete: kept.complete,
            bytes: [kept.bytes, kept.special_bytes],
            kept_special: kept.special.len(),
            special: kept.special,
            skipped: kept.numbers,
            rows: kept.rows,
            new: 0,
            progress: report.progress(),
            scrolling,
        })
    }

    /// Opens the table or CSV, once.
    fn open(&mut self) -> io::Result<()> {
        if !matches!(self.to, ContinuationSink::Nothing) || !self.report.streams() || self.complete
        {
            return Ok(());
        }
        if self.report.format != Format::Csv {
            let (names, quantities): (Vec<_>, Vec<_>) = self.names.iter().cloned().unzip();
            let units = unit_names(self.task.system.units(), quantities.into_iter());
            self.to =
                ContinuationSink::Table(self.report.begin(self.remarks.clone(), &names, &units)?);
            return Ok(());
        }
        let mut remarks = self.remarks.clone();
        remarks.extend(
            self.report
                .file
                .as_ref()
                .map(|_| Status::Unfinished.remark()),
        );
        let [bytes, special_bytes] = self.bytes;
        // First the rows are cut: they must never be ahead of their special points.
        let mut to = self.report.stream(bytes)?;
        let special = match &self.special_file {
            None => None,
            Some(file) => {
                let mut to = file.after(special_bytes)?;
                if special_bytes == 0 {
                    let names = checked(&views::names(&self.task.special_columns, false));
                    to.write_all(&twinslip_output::head(&remarks, &names))?;
                }
                for (number, one) in self.special.iter().enumerate().skip(self.kept_special) {
                    to.write_all(self.task.special_line(number, one).as_bytes())?;
                }
                Some(to)
            }
        };
        if bytes == 0 {
            to.write_all(&twinslip_output::head(&remarks, &checked(&self.names)))?;
            to.flush()?;
        }
        self.to = ContinuationSink::Lines(to, special);
        Ok(())
    }

    fn row(&mut self, row: &R) -> io::Result<()> {
        self.open()?;
        let table = self.report.format == Format::Table;
        let cells = views::cells(&self.task.columns, row, self.task.system.units(), table);
        match &mut self.to {
            ContinuationSink::Nothing => {
                interrupt::holds();
                Ok(())
            }
            ContinuationSink::Table(writer) => writer.row(&cells),
            ContinuationSink::Lines(to, _) => {
                let key = row_key(self.rows.len(), self.special.len());
                to.write_all(checked_line(&key, &cells).as_bytes())?;
                to.flush()
            }
        }
    }

    fn special(&mut self, special: &R::Special) -> io::Result<()> {
        let line = self.task.special_line(self.special.len(), special);
        match &mut self.to {
            ContinuationSink::Lines(_, Some(to)) => to.write_all(line.as_bytes()),
            _ => Ok(()),
        }
    }

    /// Says in the files how far they are.
    fn end(&self, failed: bool) -> Result<()> {
        let status = |rows: usize| match (failed, self.task.call.stops()) {
            (true, _) => Status::Failed,
            (false, true) => Status::Unfinished,
            (false, false) => Status::Complete(Some(rows)),
        };
        if let Some(file) = &self.special_file {
            file.end(status(self.special.len()))?;
        }
        self.report.end(status(self.rows.len()))
    }

    fn take(&mut self, found: Found<R>) -> ControlFlow<()> {
        let written = match &found {
            Found::Special(_) => Ok(()),
            Found::Row(row) => self.row(row),
        };
        let written = written.and_then(|()| match found {
            Found::Special(mut special) => {
                let note = special.note().map(|note| self.task.call.told(note));
                special.noted(note);
                self.special(&special)?;
                self.special.push(special);
                Ok(())
            }
            Found::Row(row) => {
                self.new += 1;
                if self.scrolling {
                    self.progress.finish();
                }
                let (points, task) = (self.new, self.task);
                self.progress.reached_at(|| {
                    let place = row.place(&task.names, task.system.units());
                    format!("{points} points, {place}")
                });
                self.rows.push(row);
                Ok(())
            }
        });
        if let Err(error) = written {
            self.broken = Some(error);
            return ControlFlow::Break(());
        }
        if self.task.call.stops() {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    }

    fn summary(&self, seconds: f64) -> String {
        let mut numbers: Vec<usize> = self.rows.iter().map(R::number).collect();
        numbers.sort_unstable();
        numbers.dedup();
        let mut text = format!(
            "{} on {}, {}, {}",
            several(self.rows.len(), "point", "points"),
            several(numbers.len(), self.task.whole[0], self.task.whole[1]),
            several(self.special.len(), "special point", "special points"),
            time(seconds)
        );
        if self.rows.iter().any(R::is_mirrored) {
            let whole = self.task.whole[0];
            text += &format!("; an asymmetric {whole} stands for its mirror image too");
        }
        if self.task.resume.is_some() {
            let kept = self.rows.len() - self.new;
            text += &format!("; {} kept", several(kept, "point", "points"));
        }
        text
    }

    /// How it ended, if nothing failed outright.
    fn ending(&self) -> Ending {
        let is_stuck = |one: &&R::Special| one.label() == Some(Label::Mx);
        let mut ending = Ending::Done;
        let mut said = Vec::new();
        for one in self.special.iter().filter(is_stuck) {
            let note = one.note();
            let note = note.unwrap_or("the method goes no further");
            let place = one.place(&self.task.names, self.task.system.units());
            let text = format!("error: a {} ends at {place}: {note}", self.task.whole[0]);
            // Those of mirror images are one.
            if !said.contains(&text) {
                self.task.call.say(&text);
                said.push(text);
            }
            ending = Ending::Stuck;
        }
        // Where a coefficient is zero by definition, as at GH, nothing is left to decide.
        let side = |one: &R::Special| {
            let bifurcates = |label| Label::BIFURCATIONS.contains(&label);
            one.criticality() == Some(Criticality::Undecided) && one.label().is_some_and(bifurcates)
        };
        if ending != Ending::Done {
            return ending;
        }
        let units = self.task.system.units();
        if let Some(first) = self.rows.iter().find(|row| row.undecided()) {
            let count = self.rows.iter().filter(|row| row.undecided()).count();
            return self.report.undecided(format_args!(
                "the stability at {}, the first one at {}, as a multiplier or an eigenvalue is neutral within its error; try another `step_limit`",
                several(count, "point", "points"),
                first.place(&self.task.names, units)
            ));
        }
        match self.special.iter().find(|&one| side(one)) {
            Some(one) => self.report.undecided(format_args!(
                "on which side {} at {} bifurcates, as its coefficient is 0 within its error; change the fixed parameters",
                one.label().map_or("", Label::name),
                one.place(&self.task.names, units)
            )),
            None => ending,
        }
    }
}

/// The names of columns with that of the check.
fn checked(names: &[(String, Quantity)]) -> Vec<String> {
    let names = names.iter().map(|(name, _)| name.clone());
    names.chain([ROW_CHECK.to_owned()]).collect()
}

impl<R: CurveRow> Task<'_, R> {
    fn special_line(&self, number: usize, special: &R::Special) -> String {
        let cells = views::cells(&self.special_columns, special, self.system.units(), false);
        checked_line(&special_key(number), &cells)
    }
}
