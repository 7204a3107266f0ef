//! What scenes compute: runs, return maps, branches and curves, each once however many figures show it.

use super::clock::timed;
use super::going::{Going, Hears, Kept, Reached, Voice};
use super::piece::{
    Branches, Curves, Equilibria, GeneralCurves, Laws, Map, PeriodicOrbit, Piece, Run,
};
use std::collections::BTreeMap;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, OnceLock};
use std::time::Duration;
use twinslip::bifurcation::{Event, Label, Special};
use twinslip::error::{Error, Result};
use twinslip::friction::{AnyLaw, Parameters};
use twinslip_output::RowList;
use twinslip_tasks::scene::{
    BranchKind, BranchOptions, BranchPlan, Column, Command, EquilibriaPlan, GeneralBranchPlan,
    GeneralFound, GeneralLocusPlan, GeneralRow, LawPlan, LocusOptions, LocusPlan, OrbitPlan, Plan,
    Quantity, Sampling, SceneFile, SectionPlan, SlabSubject, run, run_section, section_columns,
    shipped, shipped_names, shown,
};

/// A piece, or why there is none, and the processor time that it took.
type Computed = (Result<Piece>, Duration);

/// All pieces, computed when they are first asked for; safe to ask from several threads.
pub struct Pieces<'a> {
    cells: BTreeMap<&'static str, OnceLock<Computed>>,
    stop: &'a AtomicBool,
    hears: Hears<'a>,
}

/// What a scene has computed, by kind: an error where the scene has a command of another kind.
macro_rules! of_scenes {
    ($($(#[$doc:meta])* $name:ident: $kind:ident($what:ty), $words:literal;)*) => {$(
        $(#[$doc])*
        ///
        /// # Errors
        /// Those of the scene; [`Error::Interrupted`].
        pub fn $name(&self, scene: &str) -> Result<Arc<$what>> {
            match self.piece(scene)? {
                Piece::$kind(piece) => Ok(piece),
                _ => Err(not(scene, $words)),
            }
        }
    )*};
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

    of_scenes! {
        /// The run of a scene.
        run: Run(Run), "a run";
        /// The return map of a scene.
        map: Map(Map), "a return map";
        /// The branches of a scene.
        branches: Branches(Branches), "a branch";
        /// The curves of a scene.
        curves: Curves(Curves), "a curve";
        /// The branches or curves of a scene in any parameters.
        general: General(GeneralCurves), "a branch or a curve in any parameters";
        /// The periodic orbit of a scene.
        orbit: Orbit(PeriodicOrbit), "an orbit";
        /// The steady states of a scene.
        equilibria: Equilibria(Equilibria), "the equilibria at a point";
        /// The friction law of a scene.
        law_of: Law(Laws), "a law";
    }

    /// The processor time that the piece of a scene took; `None` if nobody asked for it.
    pub fn took(&self, scene: &str) -> Option<Duration> {
        let computed = self.cells.get(scene)?.get()?;
        Some(computed.1)
    }

    /// Computes the piece of a scene, if that is not done yet.
    ///
    /// # Errors
    /// Those of the scene; [`Error::Interrupted`].
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
        match Command::of_scene(&file, &[])? {
            Command::Integrate(options) => self.run_of(name, Plan::new(&options)?),
            Command::Section(options) => self.map_of(name, SectionPlan::new(&options)?),
            Command::Branch(options) => match options.any_parameter()? {
                Some(subject) => self.general_branches_of(name, &options, subject),
                None => self.branches_of(name, BranchPlan::new(&options)?),
            },
            Command::Locus(options) => match options.any_parameter()? {
                Some(subject) => self.general_curves_of(name, &options, subject),
                None => self.curves_of(name, LocusPlan::new(&options)?),
            },
            Command::Orbit(options) => self.orbit_of(name, OrbitPlan::new(&options)?),
            Command::Equilibria(options) => {
                let plan = EquilibriaPlan::new(&options)?;
                let found = plan.solve()?;
                Ok(Piece::Equilibria(Arc::new(Equilibria { plan, found })))
            }
            Command::Law(options) => {
                let plan = LawPlan::new(&options)?;
                let (curves, failure) = plan.curves()?;
                match failure {
                    Some(error) => Err(error),
                    None => Ok(Piece::Law(Arc::new(Laws { curves, plan }))),
                }
            }
            Command::Sweep(_) => Err(not(name, "what figures show, but a sweep")),
            Command::Fit(_) => Err(not(name, "what figures show, but a fit")),
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
        let columns = plan.pictured();
        let voice = self.voice(name, "a run in time");
        let mut kept = self.keep(&columns, true, &voice);
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
        let columns = section_columns(&plan.system);
        let voice = self.voice(name, "a return map");
        let mut kept = self.keep(&columns, false, &voice);
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

    fn general_branches_of(
        &self,
        name: &str,
        options: &BranchOptions,
        subject: SlabSubject,
    ) -> Result<Piece> {
        let plan = GeneralBranchPlan::new(options, &subject)?;
        let (kind, names) = (plan.kind, shown(&subject, &[&plan.free]));
        let what = if kind.orbits {
            "branches of orbits"
        } else {
            "branches of equilibria"
        };
        let (rows, special) = self.followed(&self.voice(name, what), &names, |seen| {
            plan.follow(&[], seen)
        })?;
        Ok(Piece::General(Arc::new(GeneralCurves {
            kind,
            names,
            rows,
            special,
            subject,
        })))
    }

    fn general_curves_of(
        &self,
        name: &str,
        options: &LocusOptions,
        subject: SlabSubject,
    ) -> Result<Piece> {
        let plan = GeneralLocusPlan::new(options, None, &subject)?;
        let (kind, names) = (plan.kind, shown(&subject, &plan.free.each_ref()));
        let voice = self.voice(name, plan.choice.title);
        let (rows, special) = self.followed(&voice, &names, |seen| plan.follow(&[], seen))?;
        Ok(Piece::General(Arc::new(GeneralCurves {
            kind,
            names,
            rows,
            special,
            subject,
        })))
    }

    /// The rows and the special points of branches or curves in any parameters.
    fn followed(
        &self,
        voice: &Voice<'_>,
        names: &[(&'static str, Quantity)],
        follow: impl FnOnce(&mut dyn FnMut(GeneralFound) -> ControlFlow<()>) -> Result<()>,
    ) -> Result<(Vec<GeneralRow>, Vec<GeneralRow>)> {
        let (mut rows, mut special) = (Vec::new(), Vec::new());
        voice.says(Reached::Points(0));
        follow(&mut |found| {
            match found {
                GeneralFound::Row(row) => {
                    rows.push(row);
                    voice.says(Reached::Points(rows.len()));
                }
                GeneralFound::Special(point) => special.push(point),
            }
            self.flow()
        })?;
        self.going_on()?;
        if let Some(stuck) = special.iter().find(|one| one.label == Some(Label::Mx)) {
            let of = |name: &str| {
                let place = names.iter().position(|(known, _)| *known == name);
                place.map_or(f64::NAN, |place| stuck.parameters[place].value)
            };
            let (driving, stiffness) = (of("driving"), of("stiffness"));
            return Err(Error::Stuck { driving, stiffness });
        }
        voice.says(Reached::Whole);
        Ok((rows, special))
    }

    fn orbit_of(&self, name: &str, plan: OrbitPlan) -> Result<Piece> {
        let voice = self.voice(name, "a periodic orbit");
        voice.says(Reached::Percent(0));
        let found = plan.find()?;
        self.going_on()?;
        let checked = plan.crosscheck(&found.orbit)?;
        voice.says(Reached::Whole);
        Ok(Piece::Orbit(Arc::new(PeriodicOrbit {
            plan,
            found,
            checked,
        })))
    }

    fn keep<'b, R>(
        &'b self,
        columns: &[Column<R>],
        pictured: bool,
        voice: &'b Voice<'b>,
    ) -> Kept<'b> {
        voice.says(Reached::Percent(0));
        let names = columns.iter().map(|column| column.name.to_string());
        Kept {
            rows: RowList::new(names.collect()),
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
