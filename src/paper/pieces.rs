//! What scenes compute: runs, return maps, branches and curves, each once however many figures show it.

use super::clock::timed;
use crate::bifurcation::{BranchRow, Event, Label, LocusRow, Special};
use crate::error::{Error, Result};
use crate::friction::{AnyLaw, Parameters};
use crate::integrate::Control;
use crate::output::RowList;
use crate::scene::{
    BranchKind, BranchPlan, Command, LocusPlan, OutputColumn, Plan, RunOutcome, Sampling,
    SceneFile, SectionColumn, SectionOutcome, SectionPlan, Sink, run, run_section, shipped,
    shipped_names,
};
use std::collections::BTreeMap;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, OnceLock};
use std::time::Duration;

/// A run in time, with its points as they are drawn.
#[derive(Debug)]
pub struct Run {
    /// What was run.
    pub plan: Plan,
    /// In the columns of [`OutputColumn::pictured`].
    pub rows: RowList,
    /// What it came to.
    pub outcome: RunOutcome,
}

/// The returns of a run.
#[derive(Debug)]
pub struct Map {
    /// What was run.
    pub plan: SectionPlan,
    /// In the columns of [`SectionColumn::all`].
    pub rows: RowList,
    /// What it came to.
    pub outcome: SectionOutcome,
}

/// Branches as a parameter varies.
#[derive(Debug)]
pub struct Branches {
    /// What was followed.
    pub plan: BranchPlan,
    /// The points.
    pub rows: Vec<BranchRow>,
    /// The special ones.
    pub special: Vec<Special>,
}

/// Curves in the (V_H, K) plane.
#[derive(Debug)]
pub struct Curves {
    /// What was followed.
    pub plan: LocusPlan,
    /// The points.
    pub rows: Vec<LocusRow>,
    /// The special ones.
    pub special: Vec<Special>,
}

#[derive(Debug, Clone)]
enum Piece {
    Run(Arc<Run>),
    Map(Arc<Map>),
    Branches(Arc<Branches>),
    Curves(Arc<Curves>),
}

/// How far a piece has come.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Reached {
    /// Such a part of its run, in percent.
    Percent(u32),
    /// So many points of its branches or curves.
    Points(usize),
    /// All of it.
    Whole,
}

/// A piece on its way.
#[derive(Debug, Clone, Copy)]
pub struct Going<'a> {
    /// Its scene.
    pub scene: &'a str,
    /// What it computes, in words.
    pub what: &'a str,
    /// How far it has come.
    pub reached: Reached,
}

/// A piece, or why there is none, and the processor time that it took.
type Computed = (Result<Piece>, Duration);

/// Whom pieces tell how far they have come.
type Hears<'a> = &'a (dyn Fn(Going<'_>) + Sync);

/// All pieces, computed when they are first asked for; safe to ask from several threads.
pub struct Pieces<'a> {
    cells: BTreeMap<&'static str, OnceLock<Computed>>,
    stop: &'a AtomicBool,
    hears: Hears<'a>,
}

impl<'a> Pieces<'a> {
    /// None yet. Once `stop` is set, what is being computed ends with [`Error::Interrupted`].
    pub fn new(stop: &'a AtomicBool) -> Self {
        fn nobody(_: Going<'_>) {}
        Pieces::heard(stop, &nobody)
    }

    /// The same, and tells how each piece goes on.
    pub fn heard(stop: &'a AtomicBool, hears: Hears<'a>) -> Self {
        let cells = shipped_names()
            .into_iter()
            .map(|name| (name, OnceLock::new()));
        Pieces {
            cells: cells.collect(),
            stop,
            hears,
        }
    }

    /// The paper's law (35).
    pub fn law(&self) -> AnyLaw {
        AnyLaw::Spinodal(Parameters::heslot_1994().spinodal())
    }

    /// The run of a scene.
    ///
    /// # Errors
    /// Those of the scene; [`Error::Interrupted`].
    pub fn run(&self, scene: &str) -> Result<Arc<Run>> {
        match self.piece(scene)? {
            Piece::Run(run) => Ok(run),
            _ => Err(not(scene, "a run")),
        }
    }

    /// The return map of a scene.
    ///
    /// # Errors
    /// As of [`Pieces::run`].
    pub fn map(&self, scene: &str) -> Result<Arc<Map>> {
        match self.piece(scene)? {
            Piece::Map(map) => Ok(map),
            _ => Err(not(scene, "a return map")),
        }
    }

    /// The branches of a scene.
    ///
    /// # Errors
    /// As of [`Pieces::run`].
    pub fn branches(&self, scene: &str) -> Result<Arc<Branches>> {
        match self.piece(scene)? {
            Piece::Branches(branches) => Ok(branches),
            _ => Err(not(scene, "a branch")),
        }
    }

    /// The curves of a scene.
    ///
    /// # Errors
    /// As of [`Pieces::run`].
    pub fn curves(&self, scene: &str) -> Result<Arc<Curves>> {
        match self.piece(scene)? {
            Piece::Curves(curves) => Ok(curves),
            _ => Err(not(scene, "a curve")),
        }
    }

    /// The processor time that the piece of a scene took; `None` if nobody asked for it.
    pub fn took(&self, scene: &str) -> Option<Duration> {
        let computed = self.cells.get(scene)?.get()?;
        Some(computed.1)
    }

    /// Computes the piece of a scene, if that is not done yet.
    ///
    /// # Errors
    /// As of [`Pieces::run`].
    pub fn compute(&self, scene: &str) -> Result<()> {
        self.piece(scene).map(|_| ())
    }

    fn piece(&self, scene: &str) -> Result<Piece> {
        let found = self.cells.get_key_value(scene);
        let (name, cell) = found.ok_or_else(|| not(scene, "shipped"))?;
        let (piece, _) = cell.get_or_init(|| timed(|| self.made(name)));
        piece.clone()
    }

    fn made(&self, name: &str) -> Result<Piece> {
        self.going_on()?;
        let text = shipped(name).ok_or_else(|| not(name, "shipped"))?;
        let file = SceneFile::parse(&format!("{name}.toml"), text, &Command::program())?;
        match Command::of_scene(&file, &[], &[])? {
            Command::Integrate(options) => self.run_of(name, Plan::new(&options)?),
            Command::Section(options) => self.map_of(name, SectionPlan::new(&options)?),
            Command::Branch(options) => self.branches_of(name, BranchPlan::new(&options)?),
            Command::Locus(options) => self.curves_of(name, LocusPlan::new(&options)?),
            _ => Err(not(name, "a run, a map, a branch or a curve")),
        }
    }

    fn voice<'b>(&'b self, scene: &'b str, what: &'b str) -> Voice<'b> {
        Voice {
            hears: self.hears,
            scene,
            what,
        }
    }

    fn run_of(&self, name: &str, plan: Plan) -> Result<Piece> {
        // Rows are the points that a picture takes, and nothing else is needed of the run.
        let plan = Plan {
            sampling: Sampling::FinalOnly,
            picture: true,
            ..plan
        };
        let columns = OutputColumn::pictured(plan.system.interfaces);
        let voice = self.voice(name, "a run in time");
        let mut kept = self.keep(
            columns.iter().map(OutputColumn::name).collect(),
            true,
            &voice,
        );
        let outcome = run(&plan, &mut kept)?;
        self.ended(&outcome.failure)?;
        let rows = kept.rows;
        voice.says(Reached::Whole);
        Ok(Piece::Run(Arc::new(Run {
            plan,
            rows,
            outcome,
        })))
    }

    fn map_of(&self, name: &str, plan: SectionPlan) -> Result<Piece> {
        let columns = SectionColumn::all(plan.system.interfaces);
        let voice = self.voice(name, "a return map");
        let columns = columns.iter().map(SectionColumn::name).collect();
        let mut kept = self.keep(columns, false, &voice);
        let outcome = run_section(&plan, &mut kept)?;
        self.ended(&outcome.failure)?;
        let rows = kept.rows;
        voice.says(Reached::Whole);
        Ok(Piece::Map(Arc::new(Map {
            plan,
            rows,
            outcome,
        })))
    }

    fn branches_of(&self, name: &str, plan: BranchPlan) -> Result<Piece> {
        let (mut rows, mut special) = (Vec::new(), Vec::new());
        let voice = self.voice(
            name,
            match plan.of {
                BranchKind::Equilibria => "branches of equilibria",
                BranchKind::Orbits => "branches of orbits",
            },
        );
        voice.says(Reached::Points(0));
        plan.follow(&[], &mut |event| {
            match event {
                Event::Branch(row) => {
                    rows.push(row);
                    voice.says(Reached::Points(rows.len()));
                }
                Event::Special(point) => special.push(point),
                Event::Locus(_) => {}
            }
            self.flow()
        })?;
        self.going_on()?;
        whole(&special)?;
        voice.says(Reached::Whole);
        Ok(Piece::Branches(Arc::new(Branches {
            plan,
            rows,
            special,
        })))
    }

    fn curves_of(&self, name: &str, plan: LocusPlan) -> Result<Piece> {
        let (mut rows, mut special) = (Vec::new(), Vec::new());
        let voice = self.voice(name, plan.curve.title);
        voice.says(Reached::Points(0));
        plan.follow(&[], &mut |event| {
            match event {
                Event::Locus(row) => {
                    rows.push(row);
                    voice.says(Reached::Points(rows.len()));
                }
                Event::Special(point) => special.push(point),
                Event::Branch(_) => {}
            }
            self.flow()
        })?;
        self.going_on()?;
        whole(&special)?;
        voice.says(Reached::Whole);
        Ok(Piece::Curves(Arc::new(Curves {
            plan,
            rows,
            special,
        })))
    }

    fn keep<'b>(&'b self, columns: Vec<String>, pictured: bool, voice: &'b Voice<'b>) -> Kept<'b> {
        voice.says(Reached::Percent(0));
        Kept {
            rows: RowList::new(columns),
            pictured,
            stop: self.stop,
            voice,
            percent: 0,
        }
    }

    fn flow(&self) -> ControlFlow<()> {
        if self.stop.load(Ordering::Relaxed) {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    }

    /// # Errors
    /// [`Error::Interrupted`].
    pub fn going_on(&self) -> Result<()> {
        match self.flow() {
            ControlFlow::Break(()) => Err(Error::Interrupted),
            ControlFlow::Continue(()) => Ok(()),
        }
    }

    fn ended(&self, failure: &Option<Error>) -> Result<()> {
        self.going_on()?;
        failure.clone().map_or(Ok(()), Err)
    }
}

/// A branch or curve that went no further than its method could is not what a figure shall show.
fn whole(special: &[Special]) -> Result<()> {
    let Some(stuck) = special.iter().find(|one| one.label == Label::Mx) else {
        return Ok(());
    };
    let (driving, stiffness) = (stuck.driving.value, stuck.stiffness.value);
    Err(Error::Stuck { driving, stiffness })
}

fn not(scene: &str, what: &str) -> Error {
    Error::Input(format!("the scene {scene} is not {what}"))
}

/// One piece's part of the talk.
struct Voice<'a> {
    hears: Hears<'a>,
    scene: &'a str,
    what: &'a str,
}

impl Voice<'_> {
    fn says(&self, reached: Reached) {
        (self.hears)(Going {
            scene: self.scene,
            what: self.what,
            reached,
        });
    }
}

/// Keeps what a run yields.
struct Kept<'a> {
    rows: RowList,
    /// Points of the picture are kept and not rows.
    pictured: bool,
    stop: &'a AtomicBool,
    voice: &'a Voice<'a>,
    /// What was told last.
    percent: u32,
}

impl Sink for Kept<'_> {
    fn row(&mut self, row: &[f64]) -> Control {
        if !self.pictured {
            self.rows.numbers.extend_from_slice(row);
        }
        Control::Continue
    }

    fn drawn(&mut self, point: &[f64]) {
        self.rows.numbers.extend_from_slice(point);
    }

    fn reached(&mut self, fraction: f64) -> Control {
        let percent = (100.0 * fraction) as u32;
        if percent > self.percent {
            self.percent = percent;
            self.voice.says(Reached::Percent(percent));
        }
        if self.stop.load(Ordering::Relaxed) {
            Control::Stop
        } else {
            Control::Continue
        }
    }
}
