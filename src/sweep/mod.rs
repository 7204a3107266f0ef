//! Maps of regimes: what runs settle on at the points of a grid, of (V_H, K) or any other parameters, or of starts at one (V_H, K).
//!
//! Points are numbered, and what is found at one depends on its number and the settings alone: not on threads, lanes, chunks or
//! neighbours, to the bit, on one kind of processor. So a sweep may be cut anywhere and taken up again, or be shared out among
//! machines of that kind.
//!
//! A run is followed only as long as its verdict is open: to a stable steady state's neighbourhood that no run leaves; to a
//! periodic point of the return map that attracts; or through enough returns to tell a torus or chaos.

mod aperiodic;
mod attraction;
mod classify;
mod closing;
mod diagram;
mod finite_difference_exponent;
mod flows;
mod orbit;
mod points;
mod range;
mod run;
mod slow_convergence;
mod start;
mod sweeper;
mod transient;
mod watch;

pub use points::{Enclosure, SectionPlace, SystemPoint, SystemPoints};

pub use range::Range;
#[doc(hidden)]
pub use range::fields;
#[doc(hidden)]
pub use run::threads_checked;
pub use run::{UnitShare, run};
#[doc(hidden)]
pub use start::{equal_interfaces, start_of_interfaces};
pub use sweeper::Sweeper;

use crate::equilibrium::Symmetry;
use crate::error::{Error, Result};
use crate::friction::AnyLaw;
use crate::integrate::Tolerances;
use crate::model::Loading;
use crate::number::Uncertain;
use crate::section::{FEWEST_RETURNS, Regime};
use std::sync::Arc;

/// More points than this are a slip of the pen.
const MOST_POINTS: usize = 1_000_000_000_000;
/// More starts or returns than this, too.
const MOST_STARTS: usize = 1000;
const MOST_RETURNS: usize = 1_000_000;

/// What varies from point to point.
#[derive(Debug, Clone)]
pub enum Grid {
    /// V_H, fastest, and K, of two equal interfaces.
    Plane {
        /// How they resist.
        law: AnyLaw,
        /// V_H in V*.
        driving: Range,
        /// K in a sigma / L.
        stiffness: Range,
    },
    /// Starts at the stress tau_ss(V_H/2) of one slab: psi_1, fastest, and psi_2.
    Basin {
        /// How it resists.
        law: AnyLaw,
        /// V_H and K.
        loading: Loading,
        /// psi_1
        state_1: Range,
        /// psi_2
        state_2: Range,
    },
    /// One or two parameters, the first fastest, of any system.
    Systems {
        /// Their values.
        axes: Vec<Range>,
        /// The system at these.
        at: Arc<dyn SystemPoints>,
    },
}

impl Grid {
    /// The inner range, which varies fastest, and the outer one, where there are two.
    pub fn ranges(&self) -> Vec<&Range> {
        match self {
            Grid::Plane {
                driving, stiffness, ..
            } => vec![driving, stiffness],
            Grid::Basin {
                state_1, state_2, ..
            } => vec![state_1, state_2],
            Grid::Systems { axes, .. } => axes.iter().collect(),
        }
    }

    /// The law of all points, where they are of two equal interfaces.
    fn law(&self) -> Option<AnyLaw> {
        match self {
            Grid::Plane { law, .. } | Grid::Basin { law, .. } => Some(*law),
            Grid::Systems { .. } => None,
        }
    }

    /// How many values the inner range has, and the outer one.
    pub fn shape(&self) -> [usize; 2] {
        let ranges = self.ranges();
        [0, 1].map(|i| ranges.get(i).map_or(1, |range| range.count))
    }

    /// The values along all axes at the i-th of the inner range and the j-th of the outer one.
    fn values(&self, place: [usize; 2]) -> Vec<f64> {
        let ranges = self.ranges().into_iter().zip(place);
        ranges.map(|(range, i)| range.value(i)).collect()
    }

    /// The parameters that a row tells at the i-th value of the inner range and the j-th of the outer one.
    fn parameters(&self, place: [usize; 2]) -> Vec<f64> {
        let values = self.values(place);
        match self {
            Grid::Plane { .. } => values,
            Grid::Basin { loading, .. } => vec![loading.driving, loading.stiffness],
            Grid::Systems { at, .. } => at.parameters(&values),
        }
    }
}

/// What a sweep computes. The point of number k = (j N + i) S + s is the i-th of N in the inner range, the j-th in the outer one,
/// with the s-th of S starts.
#[derive(Debug, Clone)]
pub struct SweepSettings {
    /// The points.
    pub grid: Grid,
    /// Starts at each: the first beside the symmetric steady state, the second with equal interfaces, which it leaves only where
    /// they part by themselves, the third far from it with states far apart, the others random. The equal ones matter: a
    /// symmetric orbit that is stable may attract only what is symmetric to a part in a million. A basin has one start, which is
    /// its point. Those of other systems are theirs ([`SystemPoints`]).
    pub starts: usize,
    /// Of the random starts.
    pub seed: u64,
    /// Whether a point starts on the attractor of the one before it along the inner range, with the same start.
    pub follow: bool,
    /// Tolerance of the runs, relative and absolute.
    pub rtol: f64,
    /// Whether the largest exponent is wanted where the verdict needs none.
    pub lyapunov: bool,
    /// The variable whose values on the attractors are wanted.
    pub diagram: Option<usize>,
    /// The most returns of a run.
    pub max_returns: usize,
    /// The most steps of a run.
    pub max_steps: usize,
}

impl SweepSettings {
    /// How many points there are, starts counted.
    pub fn points(&self) -> usize {
        let [inner, outer] = self.grid.shape();
        inner * outer * self.starts
    }

    /// The parameters that the row of this number tells.
    pub fn parameters(&self, number: usize) -> Vec<f64> {
        self.grid.parameters(self.place(number))
    }

    /// Where along the axes the point of this number is.
    fn place(&self, number: usize) -> [usize; 2] {
        let point = number / self.starts;
        let inner = self.grid.shape()[0];
        [point % inner, point / inner]
    }

    /// How many there are of what can be computed on its own: points, or lines along the inner range where they follow one another.
    pub fn units(&self) -> usize {
        self.points() / self.points_per_unit()
    }

    /// Points of a unit: their numbers follow one another.
    pub fn points_per_unit(&self) -> usize {
        if self.follow {
            self.grid.shape()[0] * self.starts
        } else {
            1
        }
    }

    /// Whether they can be computed with.
    ///
    /// # Errors
    /// [`Error::Parameter`] and [`Error::Input`], in the names of the options.
    pub fn checked(&self) -> Result<()> {
        let names = match self.grid {
            Grid::Plane { .. } => ["driving", "stiffness"],
            Grid::Basin { .. } => ["state-1", "state-2"],
            Grid::Systems { .. } => ["grid"; 2],
        };
        let ranges = self.grid.ranges();
        if ranges.len() > names.len() {
            return Err(Error::parameter(
                "grid",
                ranges.len(),
                "of two axes at most",
            ));
        }
        for (range, name) in ranges.into_iter().zip(names) {
            match self.grid {
                Grid::Plane { .. } | Grid::Basin { .. } => range.checked_positive(name)?,
                Grid::Systems { .. } => range.checked(name)?,
            }
        }
        if let Grid::Basin { loading, .. } = &self.grid {
            Loading::new(loading.driving, loading.stiffness)?;
            if self.follow || self.starts != 1 {
                return Err(Error::Input(
                    "a basin has one start at each point, and points do not follow one another; leave out `starts` and `follow`".into(),
                ));
            }
        }
        let within = |name: &str, value: usize, least: usize, most: usize, must| {
            if (least..=most).contains(&value) {
                Ok(())
            } else {
                Err(Error::parameter(name, value, must))
            }
        };
        within("starts", self.starts, 1, MOST_STARTS, "from 1 to 1000")?;
        let [inner, outer] = self.grid.shape();
        let points = inner.saturating_mul(outer);
        let points = points.saturating_mul(self.starts);
        within("points", points, 1, MOST_POINTS, "at most 1e12")?;
        within(
            "max-returns",
            self.max_returns,
            FEWEST_RETURNS,
            MOST_RETURNS,
            "from 200, which tell a torus, to 1e6",
        )?;
        within("max-steps", self.max_steps, 1, usize::MAX, "at least 1")?;
        Tolerances::equal(self.rtol).map(|_| ())
    }
}

/// What was found at a point.
#[derive(Debug, Clone, PartialEq)]
pub struct SweepRow {
    /// The point's number.
    pub number: usize,
    /// The parameters that rows tell: of interfaces V_H in V* and K in a sigma / L, then the others that vary; of other systems all that
    /// vary.
    pub parameters: Vec<f64>,
    /// Where the run starts: of interfaces tau and ln psi of each, of other systems all states. Empty where there is no start.
    pub start: Vec<f64>,
    /// What it settles on.
    pub regime: Regime,
    /// Whether both interfaces move alike there; of steady and periodic runs.
    pub symmetry: Option<Symmetry>,
    /// q, of a periodic run.
    pub returns_per_period: Option<usize>,
    /// The time of these.
    pub period: Option<f64>,
    /// The least and the greatest stress there, or value of the state that the section is in: over a period, or over the returns
    /// that were recorded.
    pub range: Option<(f64, f64)>,
    /// The largest Lyapunov exponent of those across the flow. Where the run rests or is periodic it is negative, from
    /// eigenvalues or multipliers; that along the flow, which is zero, is not counted.
    pub lyapunov_max: Option<Uncertain>,
    /// Returns of the run to the section, those let pass included.
    pub returns: usize,
    /// Why it is undecided, and other remarks.
    pub note: Option<String>,
    /// What a variable comes back to on the attractor, where that is wanted ([`SweepSettings::diagram`]): its local maxima, or its values at one
    /// phase of a forcing.
    pub dots: Vec<f64>,
}

impl SweepRow {
    /// A row of which no more is known than where the run starts and what it settles on.
    pub fn new(number: usize, parameters: Vec<f64>, start: Vec<f64>, regime: Regime) -> Self {
        SweepRow {
            number,
            parameters,
            start,
            regime,
            symmetry: None,
            returns_per_period: None,
            period: None,
            range: None,
            lyapunov_max: None,
            returns: 0,
            note: None,
            dots: Vec::new(),
        }
    }
}
