//! What a user can set of branches and curves; as in `options`, these fields are the flags and the keys of a scene file.

use super::branch::{BranchKind, BranchParameter};
use super::ensemble::EnsembleOptions;
use super::following::SYMMETRIES;
use super::general::{SlabSubject, by_name, ends, plane};
use super::locus::CurveChoice;
use super::options::{ModelOptions, Names, OutputOptions, count, number};
use super::orbit::SECOND_METHOD;
use super::system::System;
use super::text::not_forced;
use std::path::PathBuf;
use twinslip::bifurcation::MAX_POINTS;
use twinslip::error::{Error, Result};
use twinslip::integrate::Choice;

/// How branches and curves are followed.
#[derive(Debug, Clone, PartialEq, clap::Args)]
#[command(next_help_heading = "Numerics")]
pub struct ContinuationOptions {
    /// Factor on the limits of continuation steps: below 1 there are more points, above 1 fewer
    #[arg(long, value_name = "FACTOR", default_value = "1", value_parser = number, allow_negative_numbers = true)]
    pub step_limit: f64,
    /// Upper limit on the number of points of all branches or curves together; beyond it the command fails and the points are kept
    #[arg(long, value_name = "N", default_value_t = MAX_POINTS)]
    pub max_points: usize,
    /// Relative accuracy of special points, and of all points of a curve
    #[arg(long, value_name = "X", default_value = "1e-11", value_parser = number, allow_negative_numbers = true)]
    pub tolerance: f64,
    /// Recompute each special point of orbits with a second method and report the difference [default METHOD: cvode-adams; rodas5p in a
    /// build without SUNDIALS]
    #[arg(long, value_name = "METHOD", num_args = 0..=1, default_missing_value = SECOND_METHOD, value_parser = Names::of(Choice::names()), hide_possible_values = true)]
    pub crosscheck: Option<String>,
}

/// Where branches begin, but for those of equal interfaces in V_H and K, which all are found.
#[derive(Debug, Clone, Default, PartialEq, clap::Args)]
#[command(next_help_heading = "Search")]
pub struct SearchOptions {
    /// With --system or a --law from a file: branches of equilibria begin at all equilibria in a box, a range for every state, and end
    /// where they leave it: x=-10:10,y=0:5
    #[arg(
        id = "box",
        long = "box",
        value_name = "RANGES",
        allow_hyphen_values = true
    )]
    pub within: Option<String>,
    /// Branches of orbits begin at or near this point of an orbit, at --from: TAU,PSI1,PSI2, or with --system the values of all states in
    /// order. Branches of equilibria of a --system begin near it [default: the file's table start]
    #[arg(long, value_name = "START", allow_hyphen_values = true)]
    pub start: Option<String>,
    /// With --start of an orbit: its approximate period
    #[arg(long, value_name = "T", value_parser = number, requires = "start", allow_negative_numbers = true)]
    pub period_guess: Option<f64>,
    /// With a periodic forcing (the key period of a --system, or --modulate): orbits last Q of its periods [default: 1]
    #[arg(long, value_name = "Q", value_parser = count)]
    pub turns: Option<usize>,
}

impl SearchOptions {
    /// # Errors
    /// [`Error::Input`] for a box, of what has all its equilibria found without one, and for periods of a forcing, of what has none.
    pub fn of_built_in(&self) -> Result<()> {
        if let Some(turns) = self.turns {
            return Err(not_forced(turns));
        }
        match self.within {
            None => Ok(()),
            Some(_) => Err(Error::Input(
                "`box` limits the search for equilibria of a `system` or a `law` from a file; those of built-in laws are all found without it".into(),
            )),
        }
    }

    /// # Errors
    /// [`Error::Input`] where a start or a box is given: all branches are found without one.
    pub fn unused(&self) -> Result<()> {
        self.of_built_in()?;
        match self.start {
            None => Ok(()),
            Some(_) => Err(Error::Input(
                "`start` has no meaning here: all branches are found from equilibria and Hopf points".into(),
            )),
        }
    }
}

/// `branch`: equilibria or periodic orbits as a parameter varies.
#[derive(Debug, Clone, PartialEq, clap::Args)]
pub struct BranchOptions {
    /// What to follow: equilibria or orbits; in a scene file the key `of`
    #[arg(value_name = "equilibria|orbits", value_parser = Names::of(BranchKind::NAMES), hide_possible_values = true)]
    pub of: Option<String>,
    /// What slides, with the parameter that stays fixed: --stiffness, or --driving along stiffness.
    #[command(flatten)]
    pub model: ModelOptions,
    /// The uncertainty of a fit.
    #[command(flatten)]
    pub ensemble: EnsembleOptions,
    /// The free parameter, NAME or NAME=A:B: driving (V_H), stiffness (K) or any other parameter by its name; for a system from a file any
    /// of its parameters [default: driving]
    #[arg(
        long,
        value_name = "PARAMETER",
        value_parser = Names::of(BranchParameter::NAMES),
        hide_possible_values = true,
        help_heading = "Branch"
    )]
    pub along: Option<String>,
    /// Where the branches begin [default: V_H = 1e-3 V*; K = 1e-3 a sigma/L; required for other parameters]
    #[arg(long, value_name = "A", value_parser = number, allow_negative_numbers = true, help_heading = "Branch")]
    pub from: Option<f64>,
    /// Where they end; it may be below --from [default: V_H = 1e6 V*; K = 1 a sigma/L]
    #[arg(long, value_name = "B", value_parser = number, allow_negative_numbers = true, help_heading = "Branch")]
    pub to: Option<f64>,
    /// symmetric (both interfaces in phase), asymmetric or both
    #[arg(
        long,
        value_name = "NAME",
        default_value = "both",
        value_parser = Names::of(SYMMETRIES),
        hide_possible_values = true,
        help_heading = "Branch"
    )]
    pub symmetry: String,
    /// Values of the free parameter to land on exactly, comma-separated; their rows have the label UZ
    #[arg(
        long,
        value_name = "V1,V2,...",
        allow_hyphen_values = true,
        help_heading = "Branch"
    )]
    pub at: Option<String>,
    /// Label as UF every zero of EXPRESSION, or where EXPRESSION = VALUE: of the parameters and of what a row shows, as the states of an
    /// equilibrium, or period and x_max - x_min of an orbit; repeatable
    #[arg(
        long,
        value_name = "EXPRESSION",
        value_delimiter = ';',
        allow_hyphen_values = true,
        help_heading = "Branch"
    )]
    pub watch: Vec<String>,
    /// Number of period doublings to follow: the branches of orbits with doubled period are computed too
    #[arg(long, value_name = "N", value_parser = count, default_value = "0", help_heading = "Branch")]
    pub doublings: usize,
    /// Draw stress (and period) against the parameter, stable parts solid, as FILE.svg or FILE.png
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    pub plot: Option<PathBuf>,
    /// Continue FILE, the CSV of an interrupted run of the same command: its complete branches are kept
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    pub resume: Option<PathBuf>,
    /// Where results go.
    #[command(flatten)]
    pub output: OutputOptions,
    /// Where equilibria and orbits of a system from a file are looked for.
    #[command(flatten)]
    pub search: SearchOptions,
    /// How they are followed.
    #[command(flatten)]
    pub continuation: ContinuationOptions,
}

impl BranchOptions {
    /// Whether equilibria of many equal interfaces with a law that is built in are followed along V_H or K: by the shares of the
    /// interfaces on the branches of the steady curve, all of them.
    ///
    /// # Errors
    /// [`Error::Parameter`] and [`Error::Input`] for what `set` says of single interfaces.
    pub fn by_shares(&self) -> Result<bool> {
        let along = self.along.as_deref().unwrap_or("driving");
        Ok(self.of.as_deref() == Some("equilibria")
            && ["driving", "stiffness"].contains(&along)
            && self.search.start.is_none()
            && many_and_equal(&self.model)?)
    }

    /// The model, with a value in the range for a free parameter that SI units are made of.
    ///
    /// # Errors
    /// [`Error::Input`] for what `set` says.
    pub fn reference(&self) -> Result<ModelOptions> {
        let along = self.along.as_deref().unwrap_or("driving");
        self.model.within(&[(along, self.from.zip(self.to))])
    }

    /// The interfaces, where branches are followed in any parameter: they differ, or neither V_H nor K varies.
    ///
    /// # Errors
    /// Those of the system; [`Error::Input`] for places of a search that equilibria do without.
    pub fn any_parameter(&self) -> Result<Option<SlabSubject>> {
        let along = self.along.as_deref().unwrap_or("driving");
        let system = System::new(&self.reference()?)?;
        // The closed forms of equilibria tell of no other functions than their own.
        let own_functions = self.watch.is_empty() || self.of.as_deref() == Some("orbits");
        if system.unequal.is_none() && ["driving", "stiffness"].contains(&along) && own_functions {
            return Ok(None);
        }
        let subject = SlabSubject::new(system, &[along])?;
        let search = &self.search;
        Ok(Some(match self.of.as_deref() {
            Some("orbits") => {
                search.of_built_in()?;
                subject.beginning(search.start.as_deref(), search.period_guess)?
            }
            _ => {
                search.unused()?;
                subject
            }
        }))
    }
}

/// Whether there are more than two interfaces, all equal, with a law that is built in.
fn many_and_equal(model: &ModelOptions) -> Result<bool> {
    let slab = &model.slab;
    Ok(slab.count() > 2
        && slab.clusters.is_none()
        && slab.text.system.is_none()
        && slab.law_file().is_none()
        && !slab.needs_formulas(&[])?
        && !slab.sets_one_interface()?)
}

impl LocusOptions {
    /// Whether curves of equilibria of many equal interfaces are asked for, in the plane of V_H and K: of all their shares.
    ///
    /// # Errors
    /// As of [`BranchOptions::by_shares`].
    pub fn by_shares(&self) -> Result<bool> {
        let names = plane(self.plane.as_deref().unwrap_or("driving,stiffness"))?;
        Ok(!CurveChoice::named(self.of.as_deref())?.of_orbits()
            && names.contains(&"driving")
            && names.contains(&"stiffness")
            && self.search.start.is_none()
            && self.begin.is_none()
            && many_and_equal(&self.model)?)
    }

    /// The model, with values in their ranges for free parameters that SI units are made of.
    ///
    /// # Errors
    /// [`Error::Input`] for ranges and for what `set` says.
    pub fn reference(&self) -> Result<ModelOptions> {
        let names = plane(self.plane.as_deref().unwrap_or("driving,stiffness"))?;
        let ranges = by_name("range", &self.range, names)?;
        let range = |i: usize| {
            let range = ranges[i].map(|text| ends(names[i], text));
            Ok((names[i], range.transpose()?))
        };
        self.model.within(&[range(0)?, range(1)?])
    }

    /// The interfaces, where curves are followed in any plane: they differ, or not both V_H and K vary.
    ///
    /// # Errors
    /// Those of the system, and of [`plane`].
    pub fn any_parameter(&self) -> Result<Option<SlabSubject>> {
        let names = plane(self.plane.as_deref().unwrap_or("driving,stiffness"))?;
        let system = System::new(&self.reference()?)?;
        let loading = names.contains(&"driving") && names.contains(&"stiffness");
        let of_orbits = CurveChoice::named(self.of.as_deref())?.of_orbits();
        // The closed forms of curves of equilibria tell of no other functions than their own.
        let by_closed_forms = self.hold.is_none()
            && self.begin.is_none()
            && self.of.as_deref() != Some("homoclinic")
            && (self.watch.is_empty() || of_orbits);
        if system.unequal.is_none() && loading && by_closed_forms {
            return Ok(None);
        }
        let search = &self.search;
        let subject = SlabSubject::new(system, &names)?;
        if !of_orbits {
            search.unused()?;
            return Ok(Some(subject));
        }
        search.of_built_in()?;
        let subject = subject.beginning(search.start.as_deref(), search.period_guess)?;
        Ok(Some(subject))
    }
}

/// `locus`: a curve of bifurcations in the plane of V_H and K.
#[derive(Debug, Clone, PartialEq, clap::Args)]
pub struct LocusOptions {
    /// The bifurcation to follow: pitchfork, saddle-node or hopf of equilibria; orbit-pitchfork, orbit-saddle-node, period-doubling or
    /// torus of periodic orbits; homoclinic, the orbits of infinite period; or orbits, the periodic orbits of one period or amplitude, with --hold; in a scene file the key `of`
    #[arg(value_name = "BIFURCATION", value_parser = Names::of(CurveChoice::NAMES), hide_possible_values = true)]
    pub of: Option<String>,
    /// What slides; both V_H and K vary and are not given.
    #[command(flatten)]
    pub model: ModelOptions,
    /// The uncertainty of a fit.
    #[command(flatten)]
    pub ensemble: EnsembleOptions,
    /// symmetric (both interfaces in phase), asymmetric or both, where both exist
    #[arg(
        long,
        value_name = "NAME",
        default_value = "both",
        value_parser = Names::of(SYMMETRIES),
        hide_possible_values = true,
        help_heading = "Curve"
    )]
    pub symmetry: String,
    /// V_H from A to B [default: 1e-3:1e6 V*]
    #[arg(
        long,
        value_name = "A:B",
        allow_hyphen_values = true,
        help_heading = "Curve"
    )]
    pub driving_range: Option<String>,
    /// K from A to B [default: 1e-3:1 a sigma/L]
    #[arg(
        long,
        value_name = "A:B",
        allow_hyphen_values = true,
        help_heading = "Curve"
    )]
    pub stiffness_range: Option<String>,
    /// Values of V_H to land on exactly, comma-separated, at every crossing
    #[arg(
        long,
        value_name = "V1,V2,...",
        allow_hyphen_values = true,
        help_heading = "Curve"
    )]
    pub at_driving: Option<String>,
    /// Values of K to land on exactly, comma-separated, at every crossing
    #[arg(
        long,
        value_name = "K1,K2,...",
        allow_hyphen_values = true,
        help_heading = "Curve"
    )]
    pub at_stiffness: Option<String>,
    /// Classify the bifurcation at every point as supercritical or subcritical
    #[arg(long, help_heading = "Curve")]
    pub criticality: bool,
    /// The two free parameters by name, each with a range if needed: NAME1=A:B,NAME2=C:D [default: driving,stiffness]
    #[arg(
        id = "in",
        long = "in",
        value_name = "NAME1,NAME2",
        help_heading = "Curve"
    )]
    pub plane: Option<String>,
    /// Begin at a point of codimension two, FILE.special.csv:ROW, a row (from 1) of the special points of an earlier locus: follow the
    /// curves that leave it (CP: saddle-node; BT: saddle-node, hopf, homoclinic; GH: hopf, orbit-saddle-node; ZH: saddle-node, hopf,
    /// torus; HH: hopf, torus). The plane and the ranges are those of the file unless given
    #[arg(long, value_name = "FILE:ROW", help_heading = "Curve")]
    pub begin: Option<String>,
    /// Of orbits: follow those along which this expression, as of --watch, is zero, or has this value: "period = 20",
    /// "x_max - x_min = 3"
    #[arg(
        long,
        value_name = "CONDITION",
        allow_hyphen_values = true,
        help_heading = "Curve"
    )]
    pub hold: Option<String>,
    /// Range of a free parameter, NAME=A:B; repeatable
    #[arg(
        long,
        value_name = "NAME=A,B",
        allow_hyphen_values = true,
        help_heading = "Curve"
    )]
    pub range: Vec<String>,
    /// Values of a free parameter to land on exactly at every crossing, NAME=V1,V2,...; repeatable
    #[arg(
        long,
        value_name = "NAME=V1,V2,...",
        allow_hyphen_values = true,
        help_heading = "Curve"
    )]
    pub at: Vec<String>,
    /// Label as UF every zero of EXPRESSION, or where EXPRESSION = VALUE: of the parameters and of what a row shows, as the states of an
    /// equilibrium, or period and x_max - x_min of an orbit; repeatable
    #[arg(
        long,
        value_name = "EXPRESSION",
        value_delimiter = ';',
        allow_hyphen_values = true,
        help_heading = "Curve"
    )]
    pub watch: Vec<String>,
    /// Draw the curves in the plane of V_H and K as FILE.svg or FILE.png
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    pub plot: Option<PathBuf>,
    /// Continue FILE, the CSV of an interrupted run of the same command: its complete curves are kept
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    pub resume: Option<PathBuf>,
    /// Where results go.
    #[command(flatten)]
    pub output: OutputOptions,
    /// Where equilibria and orbits of a system from a file are looked for.
    #[command(flatten)]
    pub search: SearchOptions,
    /// How it is followed.
    #[command(flatten)]
    pub continuation: ContinuationOptions,
}
