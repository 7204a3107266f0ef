//! Sweeps from options: which grid of points, what is computed of each, and which part of it here.

mod axes;
mod basin;
mod diagram;
mod explain;
mod grain;
mod interfaces;
mod layout;
mod options;
mod shard;
mod text;
mod words;

pub use basin::BasinStates;
pub use diagram::Diagram;
pub use layout::{Moving, SweepLayout};
pub use options::SweepOptions;
pub use shard::Shard;

use super::continuation::LocusOptions;
use super::locus::LocusPlan;
use super::system::{Described, System};
use super::text::TextModel;
use super::units::{Quantity, Units};
use axes::Axes;
use basin::BasinPoints;
use clap::Parser;
use grain::Grain;
use interfaces::{InterfacePoints, is_loading};
use options::SweepLine;
use serde_json::{Map, Value};
use std::sync::Arc;
use text::TextPoints;
use twinslip::error::{Error, Result, option_name};
use twinslip::model::Loading;
use twinslip::sweep::{Grid, SweepSettings, SystemPoints, threads_checked};
use words::{canonical, numerics};

/// A sweep that is asked for, checked.
#[derive(Debug, Clone)]
pub struct SweepPlan {
    /// What moves.
    pub system: Swept,
    /// What is computed.
    pub settings: SweepSettings,
    /// What rows are of.
    pub layout: SweepLayout,
    /// Which part of it.
    pub shard: Option<Shard>,
    /// By how many threads.
    pub threads: Option<usize>,
    /// Bifurcations to draw over the map.
    pub curves: Vec<LocusPlan>,
    /// The states that vary where the grid is of starts of another system than two equal interfaces.
    pub basin: Option<BasinStates>,
    /// Of what a diagram is asked for, in the place of regimes.
    pub diagram: Option<Diagram>,
    /// The settings for the output.
    pub numerics: Value,
    /// The command line of the whole sweep in one order, without what changes no row: equal sweeps have equal ones.
    pub canonical: Vec<String>,
    /// The parameters that vary.
    axes: Axes,
    /// Where the section was asked for.
    surface: Option<String>,
    /// Whether there is a picture.
    drawn: bool,
}

/// What moves at all points of a sweep; what varies has no value.
#[derive(Debug, Clone, PartialEq)]
pub enum Swept {
    /// Interfaces with a law that is built in.
    Interfaces(Box<System>),
    /// What is from a file.
    Text(Box<TextModel>),
}

impl Described for Swept {
    fn echo(&self) -> &Map<String, Value> {
        match self {
            Swept::Interfaces(system) => system.echo(),
            Swept::Text(model) => model.echo(),
        }
    }

    fn units(&self) -> &Units {
        match self {
            Swept::Interfaces(system) => &system.units,
            Swept::Text(model) => model.units(),
        }
    }
}

/// A grid, with what moves at its points.
struct SweptGrid {
    system: Swept,
    grid: Grid,
    layout: SweepLayout,
    axes: Axes,
    /// The options of a basin.
    states: Vec<(&'static str, String)>,
    basin: Option<BasinStates>,
}

impl SweepPlan {
    /// Checks the options.
    ///
    /// # Errors
    /// [`Error::Parameter`] and [`Error::Input`], in the user's own names.
    pub fn new(options: &SweepOptions) -> Result<Self> {
        threads_checked(options.threads)?;
        let SweptGrid {
            system,
            grid,
            layout,
            axes,
            states,
            basin,
        } = swept(options)?;
        let diagram = Diagram::of(options, &system)?;
        let settings = SweepSettings {
            diagram: diagram.as_ref().map(|diagram| diagram.place),
            grid,
            starts: options.starts,
            seed: options.seed,
            follow: options.follow,
            rtol: options.rtol,
            lyapunov: options.lyapunov,
            max_returns: options.max_returns,
            max_steps: options.max_steps,
        };
        settings.checked()?;
        let shard = options.shard.as_deref().map(Shard::parse).transpose()?;
        let said: Vec<(&str, String)> = axes.said.iter().chain(&states).cloned().collect();
        let curves = match (&options.plot, &system) {
            (Some(_), _) if settings.grid.ranges().is_empty() => {
                return Err(Error::Input(
                    "`plot` needs one or two free parameters, and here there is none; leave it out, or vary a parameter".into(),
                ));
            }
            (Some(_), _) if diagram.is_some() => {
                let varying = settings
                    .grid
                    .ranges()
                    .into_iter()
                    .filter(|range| range.count > 1);
                if varying.count() != 1 {
                    return Err(Error::Input(
                        "`plot` of a `diagram` is over one parameter: vary one, or leave it out"
                            .into(),
                    ));
                }
                no_curves(options)?
            }
            (Some(_), Swept::Interfaces(system)) => {
                curves(options, system, (&settings.grid, &axes.names))?
            }
            (Some(_), Swept::Text(_)) => no_curves(options)?,
            (None, _) => Vec::new(),
        };
        Ok(SweepPlan {
            curves,
            numerics: numerics(options, &said),
            canonical: canonical(options, &said),
            system,
            settings,
            layout,
            shard,
            threads: options.threads,
            surface: options.surface.clone(),
            drawn: options.plot.is_some(),
            axes,
            basin,
            diagram,
        })
    }

    /// From the command line that another sweep tells in its file.
    ///
    /// # Errors
    /// [`Error::Input`] if it is none of a sweep.
    pub fn of_command(command: &str) -> Result<Self> {
        if command.contains("$'") {
            return Err(Error::Input(
                "its system or law was given as text; only parts with one from a file can be joined".into(),
            ));
        }
        let words = command.strip_prefix("twinslip sweep").unwrap_or_default();
        let words = std::iter::once("sweep").chain(words.split_whitespace());
        let line = SweepLine::try_parse_from(words)
            .map_err(|_| Error::Input(format!("{command:?} is not the command of a sweep")))?;
        SweepPlan::new(&line.options)
    }

    /// The part that is computed here.
    pub fn part(&self) -> Shard {
        self.shard.unwrap_or(Shard::WHOLE)
    }

    /// Rows of each unit: what is computed in one go gives so many.
    pub fn rows_per_unit(&self) -> usize {
        self.settings.points_per_unit()
    }

    /// The number of rows of the part that is computed here.
    pub fn rows(&self) -> usize {
        self.part().units(self.settings.units()) * self.rows_per_unit()
    }
}

/// What nothing but a system from a file has.
///
/// # Errors
/// [`Error::Input`] for what is given of it.
fn of_a_system(options: &SweepOptions) -> Result<()> {
    let asked = [
        (
            "surface",
            &options.surface,
            "theirs is the steady stress at the mean slip rate",
        ),
        ("start", &options.start, "theirs follow from `starts`"),
    ];
    match asked.into_iter().find(|(_, text, _)| text.is_some()) {
        None => Ok(()),
        Some((name, _, theirs)) => Err(Error::Input(format!(
            "`{name}` is for a `system`, not for interfaces: {theirs}"
        ))),
    }
}

/// The grid that is asked for.
fn swept(options: &SweepOptions) -> Result<SweptGrid> {
    let axes = Axes::read(options)?;
    if let Some(model) = TextModel::named(&options.slab.text)? {
        let states = model.system.states().to_vec();
        let names = axes.names.iter().cloned();
        let parameters = names.map(|name| (name, Quantity::Number)).collect();
        let moving = |section| Moving::States(states.clone(), section);
        let starts = starts(options, &axes, &moving(0), model.units())?;
        let free = starts.as_ref().map_or(&[][..], BasinStates::places);
        let points = TextPoints::of_system(options, model, (&axes, free))?;
        let layout = SweepLayout {
            parameters,
            moves: moving(points.section_state()),
        };
        layout.names_differ()?;
        return of_text(points, layout, axes, starts);
    }
    of_a_system(options)?;
    if let Some(points) = TextPoints::of_law(options, &axes)? {
        let others = axes.names.iter().filter(|name| !is_loading(name)).cloned();
        let layout = SweepLayout::interfaces(points.parts(), others);
        layout.names_differ()?;
        let starts = starts(options, &axes, &layout.moves, points.model().units())?;
        return of_text(points, layout, axes, starts);
    }
    axes.needs_loading()?;
    let slab = options.slab.resolved()?;
    axes.known_of_interfaces(&slab)?;
    let interfaces = slab.checked_interfaces()?;
    let psi_of_both = !options.basin || BasinStates::are_plain(options);
    if interfaces == 2 && axes.are_of_loading() && psi_of_both {
        let fixed = |grain: &Grain| options.basin.then_some(grain.range.from);
        let (driving, stiffness) = (axes.grain("driving")?, axes.grain("stiffness")?);
        let system = System::of(&slab, fixed(&driving), fixed(&stiffness))?;
        if system.unequal.is_none() {
            return plane(options, system, axes, (&driving, &stiffness));
        }
    }
    let (points, mut system) = InterfacePoints::new(&options.slab, &axes)?;
    axes.names.iter().for_each(|name| system.vary(name));
    let others = axes.names.iter().filter(|name| !is_loading(name)).cloned();
    let layout = SweepLayout::interfaces(interfaces, others);
    let starts = starts(options, &axes, &layout.moves, &system.units)?;
    Ok(SweptGrid {
        grid: systems(points, &axes, starts.as_ref()),
        layout,
        system: Swept::Interfaces(Box::new(system)),
        axes,
        states: starts.as_ref().map_or(Vec::new(), BasinStates::said),
        basin: starts,
    })
}

/// The starts of a basin, where one is asked for; then nothing else varies.
fn starts(
    options: &SweepOptions,
    axes: &Axes,
    moves: &Moving,
    units: &Units,
) -> Result<Option<BasinStates>> {
    if !options.basin {
        return Ok(None);
    }
    if let Some(name) = axes.names.first() {
        return Err(Error::Input(format!(
            "with `basin` only the starts vary; give {name} a single value"
        )));
    }
    BasinStates::read(options, moves, units).map(Some)
}

/// Systems at the points of the axes, or one from the points of a grid of starts.
fn systems(points: impl SystemPoints + 'static, axes: &Axes, starts: Option<&BasinStates>) -> Grid {
    match starts {
        Some(states) => Grid::Systems {
            axes: states.ranges.to_vec(),
            at: Arc::new(BasinPoints {
                system: points,
                states: states.clone(),
            }),
        },
        None => Grid::Systems {
            axes: axes.ranges.clone(),
            at: Arc::new(points),
        },
    }
}

/// Of a system or a law from a file.
fn of_text(
    points: TextPoints,
    layout: SweepLayout,
    axes: Axes,
    starts: Option<BasinStates>,
) -> Result<SweptGrid> {
    let mut model = points.model().clone();
    axes.names.iter().for_each(|name| model.vary(name));
    Ok(SweptGrid {
        grid: systems(points, &axes, starts.as_ref()),
        layout,
        system: Swept::Text(Box::new(model)),
        axes,
        states: starts.as_ref().map_or(Vec::new(), BasinStates::said),
        basin: starts,
    })
}

/// V_H and K of two equal interfaces with a law that is built in, or their starts at one V_H and K.
fn plane(
    options: &SweepOptions,
    system: System,
    axes: Axes,
    (driving, stiffness): (&Grain, &Grain),
) -> Result<SweptGrid> {
    let units = &system.units;
    let mut states = Vec::new();
    let grid = if options.basin {
        let mut needed = |name: &'static str, text: &Option<String>| {
            let missing = || {
                Error::Input(format!(
                    "{} A:B:N is missing, and has no default",
                    option_name(name)
                ))
            };
            let grain = Grain::parse(name, text.as_deref().ok_or_else(missing)?)?;
            states.push((name, grain.to_string()));
            grain.inward(Quantity::State, units)
        };
        Grid::Basin {
            law: system.law,
            state_1: needed("state-1", &options.state_1)?,
            state_2: needed("state-2", &options.state_2)?,
            loading: loading(&system, driving, stiffness)?,
        }
    } else {
        Grid::Plane {
            law: system.law,
            driving: driving.inward(Quantity::SlipRate, units)?,
            stiffness: stiffness.inward(Quantity::Stiffness, units)?,
        }
    };
    Ok(SweptGrid {
        grid,
        layout: SweepLayout::interfaces(2, std::iter::empty()),
        system: Swept::Interfaces(Box::new(system)),
        axes,
        states,
        basin: None,
    })
}

/// V_H and K of a basin, which are single values.
fn loading(system: &System, driving: &Grain, stiffness: &Grain) -> Result<Loading> {
    for grain in [driving, stiffness] {
        if !grain.single {
            return Err(Error::Input(format!(
                "with `basin` `{}` must be a single value, not {grain}",
                grain.name
            )));
        }
    }
    system.loading()
}

/// No curves over what is no map of V_H and K with an area.
///
/// # Errors
/// [`Error::Input`] where any are asked for.
fn no_curves(options: &SweepOptions) -> Result<Vec<LocusPlan>> {
    let usual = SweepLine::parse_from(["sweep"]).options.curves;
    if ["none", usual.as_str()].contains(&options.curves.as_str()) {
        return Ok(Vec::new());
    }
    Err(Error::Input(format!(
        "`curves` {} are drawn over a map of driving and stiffness of equal interfaces alone; leave it out",
        options.curves
    )))
}

#[derive(Parser)]
struct LocusLine {
    #[command(flatten)]
    options: LocusOptions,
}

/// The bifurcations of these interfaces within a grid, if it is a plane of V_H and K that has an area.
fn curves(
    options: &SweepOptions,
    system: &System,
    (grid, names): (&Grid, &[String]),
) -> Result<Vec<LocusPlan>> {
    let usual = SweepLine::parse_from(["sweep"]).options.curves;
    let outward = |quantity, range: &twinslip::sweep::Range| {
        [range.from, range.to].map(|x| system.units.outward(quantity, x))
    };
    let (ends, asked_for) = match (grid, &grid.ranges()[..]) {
        (
            Grid::Plane {
                driving, stiffness, ..
            },
            _,
        ) => (
            [
                outward(Quantity::SlipRate, driving),
                outward(Quantity::Stiffness, stiffness),
            ],
            options.curves.as_str(),
        ),
        // Of a single interface there are Hopf points alone; its ranges are in the user's units.
        (Grid::Systems { .. }, [driving, stiffness])
            if system.interfaces == 1 && names == ["driving", "stiffness"] =>
        {
            let asked_for = match options.curves == usual {
                true => "hopf",
                false => options.curves.as_str(),
            };
            let ends = [driving, stiffness].map(|range| [range.from, range.to]);
            (ends, asked_for)
        }
        _ => return no_curves(options),
    };
    if options.curves == "none" || grid.ranges().iter().any(|range| range.count == 1) {
        return no_curves(options);
    }
    let [driving, stiffness] = ends.map(|[from, to]| Some(format!("{from:?}:{to:?}")));
    let mut asked = LocusLine::parse_from(["locus"]).options;
    asked.model.slab = options.slab.clone();
    asked.driving_range = driving;
    asked.stiffness_range = stiffness;
    let names = asked_for.split(',');
    names
        .map(|name| {
            LocusPlan::new(&LocusOptions {
                of: Some(name.trim().to_owned()),
                ..asked.clone()
            })
        })
        .collect()
}
