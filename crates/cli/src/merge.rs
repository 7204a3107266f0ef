//! `twinslip merge`: the files of all parts of a sweep become the file that one run would have written.

use super::sweep::{file, undecided_rows};
use super::{Ending, say, written};
use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, BufRead, BufReader, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use twinslip::error::{Error, Result};
use twinslip::section::Regime;
use twinslip_output::{Format, Place, Status, write_whole_by};
use twinslip_tasks::scene::{Shard, SweepPlan};
use twinslip_tasks::views;

/// Parts that are missing are named, up to so many.
const NAMED: usize = 10;

pub const EXAMPLE: &str = "Example, a sweep in three parts, which may run on three machines:
  twinslip sweep --driving 0.04:0.2:40 --stiffness 0.02:0.25:40 --shard 1/3 -o part1.csv
  twinslip sweep --driving 0.04:0.2:40 --stiffness 0.02:0.25:40 --shard 2/3 -o part2.csv
  twinslip sweep --driving 0.04:0.2:40 --stiffness 0.02:0.25:40 --shard 3/3 -o part3.csv
  twinslip merge part1.csv part2.csv part3.csv -o map.csv";

/// `merge`: parts of a sweep into one file.
#[derive(Debug, Clone, PartialEq, clap::Args)]
pub struct MergeOptions {
    /// The complete CSV files of sweep --shard 1/N to N/N, in any order
    #[arg(value_name = "FILES", required = true)]
    files: Vec<PathBuf>,
    /// Write the whole sweep to FILE; - is standard output
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    /// No messages; errors are still shown
    #[arg(short, long)]
    quiet: bool,
}

pub fn run(options: &MergeOptions) -> Result<Ending> {
    let place = Place::new(Some(&options.output));
    if Format::choose(None, place.path(), false)? != Format::Csv {
        return Err(Error::Input(format!(
            "--output {}: merge writes CSV; choose a name that ends in .csv",
            options.output.display()
        )));
    }
    place.check()?;
    if let Some(file) = options
        .files
        .iter()
        .find(|file| same(file, &options.output))
    {
        return Err(file::wrong(file, "it cannot be both a part and the whole"));
    }
    let parts = parts(&options.files)?;
    let Some((plan, _)) = parts.first() else {
        return Err(Error::Input("there are no files to merge".into()));
    };
    let columns = views::sweep_columns(&plan.layout);
    let status = Status::Complete(Some(plan.settings.points()));
    let beginning = file::beginning(plan, None, &columns, place.path().map(|_| status));
    let regime = file::regime_place(&columns);
    let mut sources = Vec::new();
    let mut undecided = 0;
    for (plan, path) in &parts {
        let mut count = |_: usize, cells: &[String]| {
            undecided += usize::from(cells[regime] == Regime::Undecided.name());
        };
        let standing = file::read(path, plan, &columns, &mut count)?;
        let all = plan.part().units(plan.settings.units());
        if standing.units < all {
            let per_unit = plan.rows_per_unit();
            return Err(file::wrong(
                path,
                format!(
                    "it ends after {} of {} rows; finish it with --resume",
                    standing.units * per_unit,
                    all * per_unit
                ),
            ));
        }
        sources.push(rows(path, standing.rows).map_err(|error| file::unreadable(path, error))?);
    }
    let mut fill = |to: &mut dyn Write| interleave(plan, &beginning, &mut sources, to);
    let merged = match place.path() {
        Some(path) => write_whole_by(path, |error| error, |to| fill(to)),
        None => {
            let mut to = io::BufWriter::new(io::stdout().lock());
            fill(&mut to).and_then(|()| to.flush())
        }
    };
    let ending = written(merged, &place)?;
    if !options.quiet {
        say(format_args!(
            "{} rows of {} parts",
            plan.settings.points(),
            parts.len()
        ));
    }
    // As the sweep in one run would have ended.
    Ok(match ending {
        Ending::Done if undecided > 0 => {
            if !options.quiet {
                say(format_args!("undecided: {}", undecided_rows(undecided)));
            }
            Ending::Undecided
        }
        ending => ending,
    })
}

/// Whether two paths are one file.
fn same(one: &Path, other: &Path) -> bool {
    match (one.canonicalize(), other.canonicalize()) {
        (Ok(one), Ok(other)) => one == other,
        _ => one == other,
    }
}

/// All parts of one sweep in their order, each there once.
fn parts(files: &[PathBuf]) -> Result<Vec<(SweepPlan, &Path)>> {
    let mut parts: BTreeMap<usize, (SweepPlan, &Path)> = BTreeMap::new();
    let mut first: Option<(SweepPlan, Shard, &Path)> = None;
    for path in files {
        let plan = file::plan_of(path)?;
        let Some(shard) = plan.shard else {
            return Err(file::wrong(path, "it is a whole sweep, not a part of one"));
        };
        let (of, number, known) = first.get_or_insert_with(|| (plan.clone(), shard, path));
        if of.canonical != plan.canonical || number.of != shard.of {
            return Err(Error::Input(format!(
                "{} and {} belong to different sweeps: {}, part {number}; {}, part {shard}",
                known.display(),
                path.display(),
                of.canonical.join(" "),
                plan.canonical.join(" ")
            )));
        }
        if let Some((_, twice)) = parts.insert(shard.index, (plan, path)) {
            return Err(Error::Input(format!(
                "{} and {} are both the part {shard}",
                twice.display(),
                path.display()
            )));
        }
    }
    let of = first.map_or(0, |(_, shard, _)| shard.of);
    if parts.len() < of {
        let missing = (1..=of).filter(|index| !parts.contains_key(index));
        let named: Vec<String> = missing
            .take(NAMED)
            .map(|index| format!("{index}/{of}"))
            .collect();
        let others = match of - parts.len() - named.len() {
            0 => String::new(),
            n => format!(" and {n} others"),
        };
        return Err(Error::Input(format!(
            "the parts {}{others} are missing",
            named.join(", ")
        )));
    }
    Ok(parts.into_values().collect())
}

/// A file from its first row on.
fn rows(path: &Path, beginning: u64) -> io::Result<BufReader<File>> {
    let mut file = File::open(path)?;
    file.seek(SeekFrom::Start(beginning))?;
    Ok(BufReader::new(file))
}

/// The rows of each unit from the part that it is in.
fn interleave(
    plan: &SweepPlan,
    beginning: &[u8],
    sources: &mut [BufReader<File>],
    to: &mut dyn Write,
) -> io::Result<()> {
    to.write_all(beginning)?;
    let mut line = Vec::new();
    for unit in 0..plan.settings.units() {
        let source = unit % sources.len();
        for _ in 0..plan.rows_per_unit() {
            line.clear();
            sources[source].read_until(b'\n', &mut line)?;
            to.write_all(&line)?;
        }
    }
    Ok(())
}
