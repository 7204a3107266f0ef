//! `twinslip integrate` of many interfaces.

use super::Ending;
use super::call::Call;
use super::checkpoint::{CheckpointFile, SavingOut};
use super::integrate::{Beside, PlannedRun, integrate};
use super::ranks::Joined;
#[cfg(feature = "mpi")]
use super::ranks::Ranks;
use super::stream::StreamOut;
use serde_json::{Value, json};
use std::borrow::Cow;
use std::path::Path;
use twinslip::error::{Error, Result};
#[cfg(feature = "mpi")]
use twinslip::integrate::Control;
use twinslip::many::Processes;
#[cfg(feature = "mpi")]
use twinslip::many::Share;
use twinslip_output::{Format, RowList, plot};
#[cfg(feature = "mpi")]
use twinslip_tasks::scene::Sink;
use twinslip_tasks::scene::{
    Described, IntegrateOptions, Keeping, ManyPlan, Program, Quantity, RunOutcome, Saving, run_many,
};
use twinslip_tasks::views::{self, Listed};

/// A run that is planned, with the file of its checkpoints.
struct ManyRun {
    plan: ManyPlan,
    checkpoints: Option<CheckpointFile>,
    /// Bytes of earlier rows that stay.
    kept: Option<u64>,
}

impl ManyRun {
    fn new(options: &IntegrateOptions, processes: Processes) -> Result<Self> {
        let mut run = ManyRun {
            plan: ManyPlan::new(options, processes)?,
            checkpoints: None,
            kept: None,
        };
        let Some(path) = &options.checkpoint else {
            return Ok(run);
        };
        let file = checkpoint_file(&run, options, path)?;
        let last = file.read(run.plan.interfaces.share())?;
        run.kept = last.as_ref().map(|earlier| earlier.bytes);
        run.plan.saving = Saving {
            every: Some(options.checkpoint_steps),
            from: last.and_then(|earlier| earlier.checkpoint),
        };
        run.checkpoints = Some(file);
        Ok(run)
    }
}

/// The file of the checkpoints of a run, which must have a file of rows.
fn checkpoint_file(
    run: &ManyRun,
    options: &IntegrateOptions,
    path: &Path,
) -> Result<CheckpointFile> {
    let refused = |why: &str| {
        let path = path.display();
        Err(Error::Input(format!("--checkpoint {path}: {why}")))
    };
    if options.checkpoint_steps == 0 {
        let must = "at least 1";
        return Err(Error::parameter("checkpoint-steps", 0, must));
    }
    if options.plot.is_some() {
        return refused("points of a picture are not saved; leave out --plot and draw the rows");
    }
    let output = options.output.output.as_deref();
    let Some(rows) = output.filter(|rows| *rows != Path::new("-")) else {
        return refused("rows must go into a CSV file: -o FILE.csv");
    };
    let format = Format::choose(options.output.format.as_deref(), Some(rows), false)?;
    if format != Format::Csv {
        return refused(
            "only rows in CSV can be resumed; leave out --format, and name a file that does not end in .json",
        );
    }
    if rows == path {
        return refused("it is the file of the rows");
    }
    let of = json!({
        "rows": rows,
        "until": run.plan.until,
        "sampling": format!("{:?}", run.plan.sampling),
        "columns": run.columns().into_iter().map(|(name, _)| name).collect::<Vec<_>>(),
        "start": options.start,
        "events": format!("{:?}", run.plan.catalogue),
        "numerics": run.numerics(),
        "checkpoint_steps": options.checkpoint_steps,
    });
    let mut all = run.plan.echo().clone();
    all.extend(of.as_object().cloned().unwrap_or_default());
    Ok(CheckpointFile::new(path, rows, all))
}

pub fn run(options: &IntegrateOptions, call: &Call) -> Result<Ending> {
    match Joined::join()? {
        None => integrate(&ManyRun::new(options, Processes::One)?, options, call),
        #[cfg(feature = "mpi")]
        Some(_joined) => by_ranks(options, call),
        #[cfg(not(feature = "mpi"))]
        Some(joined) => match joined {},
    }
}

/// The ranks integrate together, and the first one writes. What is wrong with the input, all of them see, and one says.
#[cfg(feature = "mpi")]
fn by_ranks(options: &IntegrateOptions, call: &Call) -> Result<Ending> {
    let run = ManyRun::new(options, Processes::Several(&Ranks));
    let leads = Share::new(1, Processes::Several(&Ranks)).rank() == 0;
    if leads {
        let run = run?;
        let ended = integrate(&run, options, call);
        run.plan.dismiss();
        return ended;
    }
    if let Ok(run) = run {
        // A failure on the way is the same in all.
        let _same = run_many(&run.plan, &mut Silent);
    }
    Ok(Ending::Done)
}

/// Of a process that writes nothing.
#[cfg(feature = "mpi")]
struct Silent;

#[cfg(feature = "mpi")]
impl Sink for Silent {
    fn row(&mut self, _: &[f64]) -> Control {
        Control::Continue
    }

    fn reached(&mut self, _: f64) -> Control {
        Control::Continue
    }
}

impl PlannedRun for ManyRun {
    fn explain(&self, _: Keeping) -> String {
        self.plan.explain()
    }

    fn system(&self) -> &dyn Described {
        &self.plan
    }

    fn numerics(&self) -> Value {
        json!({
            "method": self.plan.method.name(),
            "asked": self.plan.asked_method,
            "order": self.plan.method.order(),
            "rtol": self.plan.rtol,
            "max_steps": self.plan.max_steps,
            "dimension": self.plan.interfaces.count() + 1,
        })
    }

    fn columns(&self) -> Vec<(String, Quantity)> {
        views::names(&self.plan.columns, false)
    }

    fn pictured(&self) -> Vec<(String, Quantity)> {
        views::names(&self.plan.pictured(), false)
    }

    fn beside<'a>(&'a self, outcome: &'a RunOutcome) -> Beside<'a> {
        let catalogue = outcome.catalogue.as_ref();
        let count = self.plan.interfaces.count();
        let events = catalogue.map(|catalogue| Listed {
            columns: views::many_event_columns(count),
            rows: Cow::Borrowed(&*catalogue.events),
            units: self.plan.units(),
        });
        let all = catalogue.and_then(|catalogue| catalogue.participants(&self.plan.drawn));
        let participation = all.map(|rows| Listed {
            columns: views::participation_columns(&self.plan.drawn),
            rows: Cow::Owned(rows),
            units: self.plan.units(),
        });
        Beside {
            events: events.map(|events| Box::new(events) as _),
            participation: participation.map(|all| Box::new(all) as _),
        }
    }

    fn program(&self) -> Option<&Program> {
        None
    }

    fn observed(&self) -> bool {
        true
    }

    fn kept_bytes(&self) -> Option<u64> {
        self.kept
    }

    fn run(&self, out: &mut StreamOut<'_>) -> Result<RunOutcome> {
        let Some(file) = &self.checkpoints else {
            return run_many(&self.plan, out);
        };
        if self.plan.saving.from.is_none() {
            file.begin()?;
        }
        run_many(&self.plan, &mut SavingOut { out, file })
    }

    /// Not before all files say that they are complete: a run that is killed in between goes on from its last checkpoint.
    fn ended(&self) {
        if let Some(file) = &self.checkpoints {
            file.remove();
        }
    }

    fn picture(&self, drawn: &RowList) -> plot::Drawing {
        views::many_run(&self.plan, drawn)
    }

    fn picture_of_events(&self, outcome: &RunOutcome) -> Option<plot::Drawing> {
        let catalogue = outcome.catalogue.as_ref();
        catalogue.map(|catalogue| views::picture_of_events(&self.plan, &catalogue.events))
    }
}
