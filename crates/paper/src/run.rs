//! One run of the whole: what stands is left, pieces are computed on all cores, and every product is written when its pieces are
//! there.

use super::clock::timed;
use super::going::Going;
use super::pieces::Pieces;
use super::product::{Made, Make, Product};
use super::record::{self, ProductEntry, Record, Written};
use super::{report, scorecard};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::time::{Duration, Instant};
use twinslip::error::{Error, Result};
use twinslip_output::{Place, write_whole};

/// Pieces that take long, the longest first: they are begun before the others, so that no core waits for one of them at the
/// end.
const LONG: &[&str] = &[
    "fig06-orbit-folds",
    "fig12-period-doubling",
    "fig06-orbit-pitchforks",
    "fig09",
    "fig12",
    "fig13-map",
    "fig07",
];

/// What is to be made.
#[derive(Debug, Clone)]
pub struct Selection {
    /// The directory.
    pub out: PathBuf,
    /// The products, in the order of the paper.
    pub products: Vec<&'static Product>,
    /// Whether what stands is made again.
    pub force: bool,
    /// Whether pictures are made as pixels too.
    pub png: bool,
    /// Whether the directory is kept as a whole: with a manifest, by which what stands is not made again, and with the report.
    /// Otherwise there are just the products.
    pub report: bool,
    /// The command that makes a product alone, which its CSV tells.
    pub command: fn(&Product) -> String,
    /// Threads; as many as there are processors without.
    pub threads: Option<usize>,
    /// What the manifest says of program and machine.
    pub machine: BTreeMap<String, String>,
    /// What of these decides about the numbers, the program itself included.
    pub program: String,
}

/// What happens on the way.
#[derive(Debug, Clone, Copy)]
pub enum RunEvent<'a> {
    /// What will be made; the others stand.
    Begun {
        /// So many products.
        products: usize,
        /// Of so many pieces.
        pieces: usize,
    },
    /// A piece goes on.
    Piece(Going<'a>),
    /// All pieces of a product are there, and it is made of them.
    Making(&'a Product),
    /// A product was made, in so many seconds of processor time.
    Made(&'a Product, f64),
}

/// What became of an order.
#[derive(Debug, Default)]
pub struct Done {
    /// What was made, with the seconds of processor time that it took, all its pieces included.
    pub made: Vec<(&'static Product, f64)>,
    /// What stood.
    pub stood: Vec<&'static Product>,
    /// What could not be made.
    pub failed: Vec<(&'static Product, Error)>,
}

/// Makes what is ordered. Setting `stop` ends it soon; what is finished by then is complete.
///
/// # Errors
/// [`Error::File`] if the directory can't be written; of products, see [`Done::failed`].
pub fn reproduce(
    order: &Selection,
    stop: &AtomicBool,
    told: &(dyn Fn(RunEvent<'_>) + Sync),
) -> Result<Done> {
    let failed = |error: std::io::Error| file_error("create", &order.out, error);
    std::fs::create_dir_all(&order.out).map_err(failed)?;
    Place::File(order.out.join(record::FILE)).check()?;
    let mut before = if order.report {
        Record::read(&order.out)
    } else {
        Record::default()
    };
    before.machine = order.machine.clone();
    let keys: Vec<String> = order
        .products
        .iter()
        .map(|product| record::key(product, &order.program))
        .collect();
    let stands = |product: &Product, key: &str| {
        !order.force && before.current(product, key, order.png, &order.out)
    };
    let (mut wanted, mut done) = (Vec::new(), Done::default());
    for (&product, key) in order.products.iter().zip(keys) {
        if stands(product, &key) {
            done.stood.push(product);
        } else {
            wanted.push(Wanted::new(product, key));
        }
    }
    let scenes = scenes(&wanted);
    told(RunEvent::Begun {
        products: wanted.len(),
        pieces: scenes.len(),
    });
    let hears = |going: Going<'_>| told(RunEvent::Piece(going));
    let workshop = Workshop {
        order,
        stop,
        told,
        pieces: Pieces::heard(stop, &hears),
        record: Mutex::new(before),
        done: Mutex::new(done),
    };
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(order.threads.unwrap_or(0))
        .build()
        .map_err(|error| Error::Input(format!("there are no threads to compute on: {error}")))?;
    let begun = Instant::now();
    pool.install(|| workshop.work(&wanted, &scenes));
    let mut done = workshop.done.into_inner().expect("no thread panicked");
    let place = |product: &Product| order.products.iter().position(|one| one.id == product.id);
    done.made.sort_by_key(|(product, _)| place(product));
    done.failed.sort_by_key(|(product, _)| place(product));
    if order.report {
        let mut record = workshop.record.into_inner().expect("no thread panicked");
        if !wanted.is_empty() {
            record.seconds = Some(begun.elapsed().as_secs_f64());
            write(&order.out.join(record::FILE), &record.bytes())?;
        }
        report::write(&order.out, &record)?;
    }
    Ok(done)
}

/// A product that is to be made, with how many of its pieces are missing.
struct Wanted {
    product: &'static Product,
    key: String,
    missing: AtomicUsize,
}

impl Wanted {
    fn new(product: &'static Product, key: String) -> Self {
        Wanted {
            product,
            key,
            missing: AtomicUsize::new(product.scenes.len()),
        }
    }
}

/// What a product is, as files, and how it was computed.
struct Contents {
    files: Vec<(String, Vec<u8>)>,
    method: String,
    /// The processor time that it took besides its pieces.
    time: Duration,
}

/// The scenes of what is wanted, each once, in the order in which they are computed.
fn scenes(wanted: &[Wanted]) -> Vec<&'static str> {
    let needed = || wanted.iter().flat_map(|one| one.product.scenes);
    let long = LONG
        .iter()
        .filter(|&scene| needed().any(|other| other == scene));
    let mut scenes: Vec<&str> = Vec::new();
    for &scene in long.chain(needed()) {
        if !scenes.contains(&scene) {
            scenes.push(scene);
        }
    }
    scenes
}

struct Workshop<'a> {
    order: &'a Selection,
    stop: &'a AtomicBool,
    told: &'a (dyn Fn(RunEvent<'_>) + Sync),
    pieces: Pieces<'a>,
    record: Mutex<Record>,
    done: Mutex<Done>,
}

impl Workshop<'_> {
    /// Computes pieces, and makes each product as soon as its last one is there.
    fn work(&self, wanted: &[Wanted], scenes: &[&'static str]) {
        rayon::scope_fifo(|scope| {
            for &scene in scenes {
                scope.spawn_fifo(move |_| {
                    // Why it failed is told by the products that need it.
                    let _ = self.pieces.compute(scene);
                    for one in wanted
                        .iter()
                        .filter(|one| one.product.scenes.contains(&scene))
                    {
                        if one.missing.fetch_sub(1, Ordering::AcqRel) == 1 {
                            self.make(one);
                        }
                    }
                });
            }
            for one in wanted.iter().filter(|one| one.product.scenes.is_empty()) {
                scope.spawn_fifo(move |_| self.make(one));
            }
        });
    }

    fn make(&self, wanted: &Wanted) {
        let product = wanted.product;
        (self.told)(RunEvent::Making(product));
        let made = self.contents(product).and_then(|contents| {
            self.pieces.going_on()?;
            let pieces = product
                .scenes
                .iter()
                .filter_map(|scene| self.pieces.took(scene));
            let seconds = (contents.time + pieces.sum()).as_secs_f64();
            self.keep(wanted, contents, seconds)?;
            Ok(seconds)
        });
        if let Err(Error::File { .. }) = made {
            // What can't be written need not be computed.
            self.stop.store(true, Ordering::Relaxed);
        }
        let mut done = self.done.lock().expect("no thread panicked");
        match made {
            Ok(seconds) => {
                done.made.push((product, seconds));
                (self.told)(RunEvent::Made(product, seconds));
            }
            Err(error) => done.failed.push((product, error)),
        }
    }

    /// The files of a product, not yet written.
    fn contents(&self, product: &Product) -> Result<Contents> {
        let names = product.files(self.order.png).into_iter();
        let (contents, method, time) = match product.make {
            Make::Figure(make) | Make::Table(make) => {
                let (made, time) = timed(|| self.drawn(product, make));
                let (contents, method) = made?;
                (contents, method, time)
            }
            Make::Scorecard => {
                let (entries, time) = scorecard::timed_entries(&self.pieces)?;
                let json = scorecard::json(&entries);
                let mut bytes = serde_json::to_vec_pretty(&json).expect("words and numbers");
                bytes.push(b'\n');
                (vec![bytes], scorecard::METHOD.to_owned(), time)
            }
        };
        Ok(Contents {
            files: names.zip(contents).collect(),
            method,
            time,
        })
    }

    /// The bytes of the files of a figure or a table, and how it was computed.
    fn drawn(
        &self,
        product: &Product,
        make: fn(&Pieces<'_>) -> Result<Made>,
    ) -> Result<(Vec<Vec<u8>>, String)> {
        let Made {
            sheet,
            drawing,
            method,
        } = make(&self.pieces)?;
        let mut contents =
            vec![sheet.csv(&remarks(product, &(self.order.command)(product), &method))?];
        if let Some(drawing) = drawing {
            contents.push(drawing.svg()?.into_bytes());
            if self.order.png {
                contents.push(drawing.png()?);
            }
        }
        Ok((contents, method))
    }

    /// Writes the files, each complete or not at all, and then the manifest that vouches for them.
    fn keep(&self, wanted: &Wanted, contents: Contents, seconds: f64) -> Result<()> {
        let mut written = Vec::new();
        for (name, bytes) in contents.files {
            write(&self.order.out.join(&name), &bytes)?;
            written.push(Written::new(name, &bytes));
        }
        let entry = ProductEntry {
            key: wanted.key.clone(),
            method: contents.method,
            seconds,
            files: written,
        };
        let mut record = self.record.lock().expect("no thread panicked");
        record.products.insert(wanted.product.id.to_owned(), entry);
        if !self.order.report {
            return Ok(());
        }
        write(&self.order.out.join(record::FILE), &record.bytes())
    }
}

/// Writes a file, complete or not at all.
///
/// # Errors
/// [`Error::File`].
pub(super) fn write(path: &Path, bytes: &[u8]) -> Result<()> {
    write_whole(path, bytes).map_err(|error| file_error("write", path, error))
}

fn file_error(action: &'static str, path: &Path, error: std::io::Error) -> Error {
    Error::File {
        action,
        path: path.to_owned(),
        reason: error.to_string(),
    }
}

/// The `# ` lines of a CSV.
fn remarks(product: &Product, command: &str, method: &str) -> Vec<String> {
    let mut remarks = vec![
        format!("twinslip {}", env!("CARGO_PKG_VERSION")),
        format!("command: {command}"),
        format!("{}: {}", product.id, product.title),
    ];
    if !product.scenes.is_empty() {
        remarks.push(format!("scenes: {}", product.scenes.join(", ")));
    }
    remarks.push(format!("method: {}", method.replace('\n', " ")));
    remarks.push("units: stress [a sigma], slip rate and driving [V*], time [L/V*], stiffness [a sigma/L], unless a column says otherwise".into());
    remarks
}
