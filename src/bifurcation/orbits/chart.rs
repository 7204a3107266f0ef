//! Charts: the variables in which orbits are followed, and the way from one to the other.
//!
//! A system of two equal parts has three: those of all its states (y, x_1, x_2), those of states in which both parts move alike, (y, x), and
//! (y, x_2, ln D), which keep the difference of the parts where the first lose it.

use super::normal_form::{Form, normal_form};
use crate::bifurcation::Criticality;
use crate::bifurcation::general::{FREE, GeneralSystem};
use crate::equilibrium::Symmetry;
use crate::field::Vector;
use crate::number::Uncertain;
use crate::orbit::{
    ContinuationPoint, OverDifferenceChart, ParametrisedField, Regular, TestFunction,
    WatchedFunction,
};

/// The variables of an orbit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Variables {
    /// All states.
    Whole,
    /// The states in which equal parts move in phase.
    Alike,
    /// The other states, with the logarithm of the parts' difference.
    Difference,
}

/// Orbits of a system in some variables.
#[derive(Clone, Copy)]
pub(in crate::bifurcation) struct Chart<'a> {
    whole: &'a dyn ParametrisedField,
    alike: Option<&'a dyn ParametrisedField>,
    difference: Option<&'a dyn ParametrisedField>,
    variables: Variables,
}

/// The least difference of both parts along an orbit that is left with digits enough.
const LEAST: f64 = 1e-4;
/// The greatest ln D along an orbit that is symmetric but for it: its square changes nothing.
const SYMMETRIC: f64 = -15.0;

impl<'a> Chart<'a> {
    /// Orbits among all states.
    pub fn whole(system: &GeneralSystem<'a>) -> Self {
        Chart {
            whole: system.family,
            alike: system.alike,
            difference: system.difference,
            variables: Variables::Whole,
        }
    }

    /// Orbits of this symmetry, where the system has equal parts.
    pub fn of(system: &GeneralSystem<'a>, symmetry: Symmetry) -> Self {
        let whole = Chart::whole(system);
        match symmetry {
            Symmetry::Symmetric if system.alike.is_some() => Chart {
                variables: Variables::Alike,
                ..whole
            },
            _ => whole,
        }
    }

    /// The vector fields over the plane of parameters.
    pub fn family(&self) -> &'a dyn ParametrisedField {
        let own = match self.variables {
            Variables::Whole => None,
            Variables::Alike => self.alike,
            Variables::Difference => self.difference,
        };
        own.unwrap_or(self.whole)
    }

    /// The vector fields of all states.
    pub fn whole_family(&self) -> &'a dyn ParametrisedField {
        self.whole
    }

    /// Whether both parts move alike along its orbits; `None` for systems without equal parts.
    pub fn symmetry(&self) -> Option<Symmetry> {
        self.alike.map(|_| match self.variables {
            Variables::Alike => Symmetry::Symmetric,
            _ => Symmetry::Asymmetric,
        })
    }

    /// Whether its orbits are symmetric ones that may part from symmetry.
    fn may_part(&self) -> bool {
        self.variables == Variables::Alike && self.family().dimension() < self.whole.dimension()
    }

    /// The test functions along a branch. Without a symmetry folds are found by their multiplier, as along a canard the parameter turns
    /// within its rounding; that multiplier is 1 at pitchforks too, so that where these have a test function of their own a fold is a turn.
    pub fn watches(&self) -> Vec<WatchedFunction> {
        let dimension = self.family().dimension();
        let fold = match self.symmetry() {
            Some(_) => WatchedFunction::Turn(FREE),
            None => WatchedFunction::TestFunction(TestFunction::Fold),
        };
        let others = match self.may_part() {
            true => vec![TestFunction::Transverse],
            false => vec![TestFunction::Doubling, TestFunction::Torus],
        };
        let known = others
            .into_iter()
            .filter(|one| one.checked(dimension).is_ok());
        let others = known.map(WatchedFunction::TestFunction);
        [fold].into_iter().chain(others).collect()
    }

    /// ln |mu| of the nontrivial multipliers of an orbit, the largest first; of a symmetric one that across symmetry among them.
    pub fn log_multipliers(&self, orbit: &Regular) -> Vec<f64> {
        let mut logs = orbit.log_multipliers();
        if self.may_part() {
            logs.push(orbit.spectrum.across);
            logs.sort_by(|a, b| b.total_cmp(a));
        }
        logs
    }

    /// Whether the multiplier of an orbit across symmetry is larger than this.
    pub fn grows_across(&self, orbit: &Regular, ln_abs: f64) -> bool {
        self.may_part() && orbit.spectrum.across > ln_abs
    }

    /// An orbit in the variables of all states, or in those of states in which both parts move alike.
    pub fn usual(&self, site: &ContinuationPoint) -> ContinuationPoint {
        match self.variables {
            Variables::Difference => OverDifferenceChart::from_chart(site),
            _ => site.clone(),
        }
    }

    /// An orbit in the variables of all states.
    pub fn in_whole(&self, site: &ContinuationPoint) -> ContinuationPoint {
        match self.may_part() {
            true => embedded(site),
            false => self.usual(site),
        }
    }

    /// Whether the continuation from `last` to `here` has come to a symmetric orbit.
    pub fn merges(&self, here: &ContinuationPoint, last: &ContinuationPoint) -> bool {
        match self.variables {
            Variables::Difference => {
                let gaps = here.shooting.nodes.iter().map(|x| x[2]);
                gaps.fold(f64::NEG_INFINITY, f64::max) < SYMMETRIC
            }
            // The difference has one sign all along an asymmetric orbit.
            Variables::Whole => self.alike.is_some() && asymmetry(here) * asymmetry(last) <= 0.0,
            Variables::Alike => false,
        }
    }

    /// Whether both parts come so near each other along the orbit that these variables lose their difference, and there are others.
    pub fn loses(&self, site: &ContinuationPoint) -> bool {
        let apart = || site.shooting.nodes.iter().map(|x| (x[1] - x[2]).abs());
        self.variables == Variables::Whole
            && self.difference.is_some()
            && apart().fold(f64::INFINITY, f64::min) < LEAST
    }

    /// Whether this is the difference chart, which does not lose it.
    pub fn keeps_difference(&self) -> bool {
        self.variables == Variables::Difference
    }

    /// The same orbit in the difference chart.
    pub fn keeping(&self, site: &ContinuationPoint) -> Option<(Self, ContinuationPoint)> {
        if self.variables != Variables::Whole || self.difference.is_none() {
            return None;
        }
        let chart = Chart {
            variables: Variables::Difference,
            ..*self
        };
        Some((chart, OverDifferenceChart::to_chart(site)?))
    }

    /// The symmetric orbit in the middle of one of these variables, with its own.
    pub fn symmetric(&self, site: &ContinuationPoint) -> (Self, ContinuationPoint) {
        let chart = Chart {
            variables: Variables::Alike,
            ..*self
        };
        (chart, middle(&self.usual(site)))
    }

    /// An orbit of its symmetry, in the variables of all states or in those of states in which both parts move alike, in its own.
    pub fn own(&self, site: &ContinuationPoint) -> ContinuationPoint {
        match self.variables {
            Variables::Alike => middle(site),
            _ => site.clone(),
        }
    }

    /// The cubic coefficient of an orbit that bifurcates, in the space of all states, and which way that is; `None` for orbits that do not have the form.
    pub fn normal_form(
        &self,
        site: &ContinuationPoint,
        form: Form,
    ) -> Option<(Uncertain, Criticality)> {
        let way = match self.may_part() {
            true => normal_form(self.whole, &embedded(site), form),
            false => normal_form(self.family(), site, form),
        };
        way.ok()
    }
}

/// The mean of ln psi_1 - ln psi_2.
fn asymmetry(site: &ContinuationPoint) -> f64 {
    let apart = site.shooting.nodes.iter().map(|x| x[1] - x[2]);
    apart.sum::<f64>() / site.shooting.nodes.len() as f64
}

/// The symmetric orbit in the middle of one of all states; a symmetric one is its own.
fn middle(site: &ContinuationPoint) -> ContinuationPoint {
    let nodes = site.shooting.nodes.iter();
    let node = |x: &Vector| {
        let state = [x[0], 0.5 * (x[1] + x[x.len() - 1])];
        Vector::from_column_slice(&state)
    };
    site.with_nodes(nodes.map(node).collect())
}

/// A symmetric orbit among all states.
fn embedded(site: &ContinuationPoint) -> ContinuationPoint {
    let nodes = site.shooting.nodes.iter();
    let node = |x: &Vector| Vector::from_column_slice(&[x[0], x[1], x[1]]);
    site.with_nodes(nodes.map(node).collect())
}
