//! `twinslip reproduce` and `twinslip figure`: the whole paper again, or a part of it.

use super::Ending;
use super::call::Call;
use super::progress::Progress;
use super::report::sundials;
use super::words::{count, time};
use indicatif::{ProgressBar, ProgressStyle};
use std::collections::BTreeMap;
use std::io::IsTerminal;
use std::path::PathBuf;
use std::sync::Mutex;
use std::time::{Duration, Instant};
use twinslip::error::{Error, Result};
use twinslip::integrate::used_vectors;
use twinslip::sweep::threads_checked;
use twinslip_paper::{
    Done, Going, PRODUCTS, Product, Reached, RunEvent, Selection, hash, reproduce,
};

pub const EXAMPLE: &str = "Example, everything into paper/, and then only what Fig. 12 and Table 1 need into another directory:
  twinslip reproduce
  twinslip reproduce --only fig12,table1 --out curves";

pub const FIGURE_EXAMPLE: &str = "Example, fig07.csv, fig07.svg and fig07.png here:
  twinslip figure 7 --png";

/// `reproduce`: the paper's figures, Table 1, the scorecard and a report to read.
#[derive(Debug, Clone, PartialEq, clap::Args)]
pub struct ReproduceOptions {
    /// Directory of all files
    #[arg(long, value_name = "DIR", default_value = "paper")]
    out: PathBuf,
    /// Only these parts, comma-separated: fig01 to fig17, fig05-unfolded, fig06-unfolded, table1, scorecard
    #[arg(long, value_name = "LIST")]
    only: Option<String>,
    /// Recompute also what an earlier run has completed
    #[arg(long)]
    force: bool,
    /// How.
    #[command(flatten)]
    making: Making,
}

/// `figure`: one figure as CSV and SVG.
#[derive(Debug, Clone, PartialEq, clap::Args)]
pub struct FigureOptions {
    /// Its number in the paper, 1 to 17, or 5-unfolded or 6-unfolded; fig7 and fig07 mean the same
    #[arg(value_name = "N")]
    number: String,
    /// Directory of the files
    #[arg(long, value_name = "DIR", default_value = ".")]
    out: PathBuf,
    /// How.
    #[command(flatten)]
    making: Making,
}

/// What both share.
#[derive(Debug, Clone, PartialEq, clap::Args)]
pub struct Making {
    /// Also write pictures as PNG
    #[arg(long)]
    png: bool,
    /// Threads [default: one per processor]; results do not depend on them
    #[arg(long, value_name = "N")]
    threads: Option<usize>,
    /// No messages; errors are still shown
    #[arg(short, long)]
    quiet: bool,
}

/// What a directory is to those who read it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum DirectoryKind {
    /// A reproduction: manifest, report, and nothing made twice but by `force`.
    Whole { force: bool },
    /// A place for files.
    Files,
}

pub fn run(options: &ReproduceOptions, call: &Call) -> Result<Ending> {
    let products = match &options.only {
        Some(names) => Product::listed(names)?,
        None => PRODUCTS.to_vec(),
    };
    make(
        &options.out,
        products,
        &options.making,
        DirectoryKind::Whole {
            force: options.force,
        },
        call,
    )
}

pub fn run_figure(options: &FigureOptions, call: &Call) -> Result<Ending> {
    let product = Product::named(&options.number)?;
    make(
        &options.out,
        vec![product],
        &options.making,
        DirectoryKind::Files,
        call,
    )
}

fn make(
    out: &std::path::Path,
    products: Vec<&'static Product>,
    making: &Making,
    kept: DirectoryKind,
    call: &Call,
) -> Result<Ending> {
    threads_checked(making.threads)?;
    let machine = machine();
    let order = Selection {
        out: out.to_owned(),
        products,
        force: matches!(kept, DirectoryKind::Whole { force: true }),
        png: making.png,
        report: kept != DirectoryKind::Files,
        command: |product| format!("twinslip reproduce --only {}", product.id),
        threads: making.threads,
        program: program(&machine, call),
        machine,
    };
    let begun = Instant::now();
    let bar = Bar::new(making.quiet, call);
    call.keeps(match kept {
        DirectoryKind::Whole { .. } => format!(
            "finished parts are in {}, and the same command keeps them",
            out.display()
        ),
        DirectoryKind::Files => "the figure was not finished, and no file was written".into(),
    });
    call.watch();
    let done = reproduce(&order, call.flag(), &|told| bar.tell(told));
    call.unwatch();
    bar.finish();
    let done = done?;
    if !making.quiet {
        summary(&done, &order, begun.elapsed(), call);
    }
    ending(done, call)
}

/// What the manifest says: versions, and the class of machine.
fn machine() -> BTreeMap<String, String> {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let facts = [
        ("twinslip", env!("CARGO_PKG_VERSION").to_owned()),
        (
            "SUNDIALS",
            sundials().unwrap_or_else(|| "not built in".into()),
        ),
        ("architecture", std::env::consts::ARCH.to_owned()),
        ("system", std::env::consts::OS.to_owned()),
        ("processors", cores.to_string()),
        ("vectors", used_vectors().name().to_owned()),
    ];
    facts
        .into_iter()
        .map(|(name, value)| (name.to_owned(), value))
        .collect()
}

/// What decides about the numbers: all of that but the number of processors, and the program itself, to the byte.
fn program(machine: &BTreeMap<String, String>, call: &Call) -> String {
    let itself = call.program().and_then(std::fs::read);
    let mut text = itself.map_or_else(|_| String::new(), |bytes| hash(&bytes));
    for (name, value) in machine.iter().filter(|(name, _)| *name != "processors") {
        text += &format!("; {name} {value}");
    }
    text
}

fn summary(done: &Done, order: &Selection, wall: Duration, call: &Call) {
    for (product, seconds) in &done.made {
        call.say(format_args!(
            "{:<10} {seconds:7.2} s  {}",
            product.id, product.title
        ));
    }
    if !done.stood.is_empty() {
        let ids: Vec<&str> = done.stood.iter().map(|product| product.id).collect();
        call.say(format_args!(
            "up to date, not made again: {}",
            ids.join(", ")
        ));
    }
    let of_processor = match done.made.len() {
        0 => "",
        _ => "; the times above are processor times, with shared work counted for each figure",
    };
    let report = if order.report { ", report.html" } else { "" };
    call.say(format_args!(
        "{} made in {}{report}, in the directory {}{of_processor}",
        count(done.made.len()),
        time(wall.as_secs_f64()),
        order.out.display()
    ));
}

/// One clear error: what can't be written goes before what was interrupted for that.
fn ending(done: Done, call: &Call) -> Result<Ending> {
    let file = |error: &Error| matches!(error, Error::File { .. });
    if let Some((_, error)) = done.failed.iter().find(|(_, error)| file(error)) {
        return Err(error.clone());
    }
    let mut ending = Ending::Done;
    for (product, error) in &done.failed {
        if *error == Error::Interrupted {
            ending = Ending::Interrupted;
        } else {
            call.say(format_args!("error: {}: {error}", product.id));
            if ending == Ending::Done {
                ending = Ending::Stuck;
            }
        }
    }
    Ok(ending)
}

/// Shows what is being made: as a bar on a terminal, elsewhere in lines.
struct Bar<'a> {
    call: &'a Call,
    lines: Option<Mutex<Progress>>,
    /// How many there are, and how many have ended.
    count: Mutex<(usize, usize)>,
    bar: ProgressBar,
    /// What goes on now, by its name.
    going: Mutex<BTreeMap<String, String>>,
}

impl<'a> Bar<'a> {
    fn new(quiet: bool, call: &'a Call) -> Self {
        let silent = quiet || call.outlet.is_some();
        let terminal = std::io::stderr().is_terminal();
        let lines = (!silent && !terminal).then(|| {
            let mut progress = call.progress(quiet);
            progress.begin("starting");
            Mutex::new(progress)
        });
        let bar = if silent || !terminal {
            ProgressBar::hidden()
        } else {
            let style =
                ProgressStyle::with_template("{bar:20} {pos} of {len}  {elapsed}  {wide_msg}")
                    .expect("the template is valid");
            let bar = ProgressBar::new(0).with_style(style);
            bar.enable_steady_tick(Duration::from_millis(200));
            bar
        };
        Bar {
            call,
            lines,
            count: Mutex::default(),
            bar,
            going: Mutex::default(),
        }
    }

    fn tell(&self, told: RunEvent<'_>) {
        if let Some(outlet) = &self.call.outlet {
            let mut count = self.count.lock().expect("no thread panicked");
            match told {
                RunEvent::Begun { products, pieces } => count.0 = products + pieces,
                RunEvent::Made(..) => count.1 += 1,
                RunEvent::Piece(Going {
                    reached: Reached::Whole,
                    ..
                }) => count.1 += 1,
                _ => (),
            }
            outlet.reached(count.1 as f64 / count.0.max(1) as f64);
        }
        if self.bar.is_hidden() && self.lines.is_none() {
            return;
        }
        match told {
            RunEvent::Begun { products, pieces } => self.bar.set_length((products + pieces) as u64),
            RunEvent::Piece(Going {
                scene,
                what,
                reached,
            }) => {
                let so_far = match reached {
                    Reached::Percent(percent) => format!("{percent} %"),
                    Reached::Points(1) => "1 point".into(),
                    Reached::Points(points) => format!("{points} points"),
                    Reached::Whole => return self.ended(scene),
                };
                self.goes(scene, format!("{scene}: {what}, {so_far}"));
            }
            RunEvent::Making(product) => {
                self.goes(product.id, format!("{}: {}", product.id, product.title));
            }
            RunEvent::Made(product, _) => self.ended(product.id),
        }
    }

    fn goes(&self, name: &str, words: String) {
        let mut going = self.going.lock().expect("no thread panicked");
        going.insert(name.to_owned(), words);
        self.show(&going);
    }

    fn ended(&self, name: &str) {
        self.bar.inc(1);
        let mut going = self.going.lock().expect("no thread panicked");
        going.remove(name);
        self.show(&going);
    }

    fn show(&self, going: &BTreeMap<String, String>) {
        let words: Vec<&str> = going.values().map(String::as_str).collect();
        let words = words.join("; ");
        if let Some(lines) = &self.lines {
            let (done, all) = (self.bar.position(), self.bar.length().unwrap_or(0));
            let lines = lines.lock().expect("no thread panicked");
            lines.reached_at(|| format!("{done} of {all}, {words}"));
        }
        self.bar.set_message(words);
    }

    fn finish(&self) {
        if let Some(lines) = &self.lines {
            lines.lock().expect("no thread panicked").finish();
        }
        self.bar.finish_and_clear();
    }
}
