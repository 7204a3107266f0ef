//! Charts: the variables in which orbits of a slab are followed, and the way from one to the other.

use super::normal_form::{Form, classified};
use crate::bifurcation::Criticality;
use crate::equilibrium::Symmetry;
use crate::field::Vector;
use crate::number::Uncertain;
use crate::orbit::{
    ContinuationPoint, InterfaceSystem, OverDifferenceChart, OverLoadings, ParametrisedField,
    Regular,
};

/// Orbits of a slab in some variables.
#[derive(Debug, Clone, Copy)]
pub enum Chart {
    /// Symmetric orbits, or those of a single interface, in (tau, ln psi).
    Plane(OverLoadings),
    /// Orbits of two interfaces in (tau, ln psi_1, ln psi_2).
    Whole(OverLoadings),
    /// Orbits of two interfaces in the difference chart.
    Difference(OverDifferenceChart),
}

/// The least difference of ln psi along an orbit that is left with digits enough.
const LEAST: f64 = 1e-4;
/// The greatest difference of psi along an orbit that is symmetric but for it: its square changes nothing.
const SYMMETRIC: f64 = -15.0;

impl Chart {
    /// The orbits of this symmetry in the usual variables.
    pub fn new(slab: InterfaceSystem, symmetry: Symmetry) -> Self {
        let family = OverLoadings::new(slab, symmetry);
        match symmetry {
            Symmetry::Symmetric => Chart::Plane(family),
            Symmetry::Asymmetric => Chart::Whole(family),
        }
    }

    /// The vector fields over the plane of parameters.
    pub fn family(&self) -> &dyn ParametrisedField {
        match self {
            Chart::Plane(family) | Chart::Whole(family) => family,
            Chart::Difference(family) => family,
        }
    }

    /// The number of variables.
    pub fn dimension(&self) -> usize {
        self.family().dimension()
    }

    /// The slab over the plane of parameters.
    pub fn slab(&self) -> OverLoadings {
        match *self {
            Chart::Plane(family) | Chart::Whole(family) => family,
            Chart::Difference(OverDifferenceChart(family)) => family,
        }
    }

    /// An orbit in (tau, ln psi) or (tau, ln psi_1, ln psi_2).
    pub fn usual(&self, site: &ContinuationPoint) -> ContinuationPoint {
        match self {
            Chart::Plane(_) | Chart::Whole(_) => site.clone(),
            Chart::Difference(_) => OverDifferenceChart::from_chart(site),
        }
    }

    /// Whether the continuation from `last` to `here` has come to a symmetric orbit.
    pub fn merges(&self, here: &ContinuationPoint, last: &ContinuationPoint) -> bool {
        match self {
            Chart::Plane(_) => false,
            // The difference has one sign all along an asymmetric orbit.
            Chart::Whole(_) => asymmetry(here) * asymmetry(last) <= 0.0,
            Chart::Difference(_) => {
                let gaps = here.shooting.nodes.iter().map(|x| x[2]);
                gaps.fold(f64::NEG_INFINITY, f64::max) < SYMMETRIC
            }
        }
    }

    /// Whether the interfaces come so near each other along the orbit that these variables lose their difference.
    pub fn loses(&self, site: &ContinuationPoint) -> bool {
        match self {
            Chart::Whole(_) => {
                let apart = site.shooting.nodes.iter().map(|x| (x[1] - x[2]).abs());
                apart.fold(f64::INFINITY, f64::min) < LEAST
            }
            Chart::Plane(_) | Chart::Difference(_) => false,
        }
    }

    /// Whether this is the difference chart, which does not lose it.
    pub fn keeps_difference(&self) -> bool {
        matches!(self, Chart::Difference(_))
    }

    /// The same orbit in the difference chart.
    pub fn keeping(&self, site: &ContinuationPoint) -> Option<(Chart, ContinuationPoint)> {
        match *self {
            Chart::Whole(family) => Some((
                Chart::Difference(OverDifferenceChart(family)),
                OverDifferenceChart::to_chart(site)?,
            )),
            Chart::Plane(_) | Chart::Difference(_) => None,
        }
    }

    /// The same orbit as a symmetric one, from which asymmetric ones part at a pitchfork, where orbits have so many variables.
    pub fn symmetric<'o>(&self, orbit: &'o Regular) -> Option<&'o Regular> {
        matches!(self, Chart::Plane(_)).then_some(orbit)
    }

    /// The same orbit as one in all variables, where periods double, where orbits have so many.
    pub fn whole<'o>(&self, orbit: &'o Regular) -> Option<&'o Regular> {
        (!matches!(self, Chart::Plane(_))).then_some(orbit)
    }

    /// The cubic coefficient of an orbit that bifurcates, in the space of all states, and which way that is.
    pub fn normal_form(&self, site: &ContinuationPoint, form: Form) -> (Uncertain, Criticality) {
        match self {
            Chart::Plane(family) => {
                let whole = OverLoadings::new(family.slab, Symmetry::Asymmetric);
                classified(&whole, &embedded(site), form)
            }
            Chart::Whole(_) | Chart::Difference(_) => classified(self.family(), site, form),
        }
    }
}

/// The mean of ln psi_1 - ln psi_2.
fn asymmetry(site: &ContinuationPoint) -> f64 {
    let apart = site.shooting.nodes.iter().map(|x| x[1] - x[2]);
    apart.sum::<f64>() / site.shooting.nodes.len() as f64
}

/// The symmetric orbit in the middle of one in (tau, ln psi_1, ln psi_2).
pub(super) fn middle(site: &ContinuationPoint) -> ContinuationPoint {
    let nodes = site.shooting.nodes.iter();
    let node = |x: &Vector| {
        let state = [x[0], 0.5 * (x[1] + x[x.len() - 1])];
        Vector::from_column_slice(&state)
    };
    site.with_nodes(nodes.map(node).collect())
}

/// A symmetric orbit among all.
pub(super) fn embedded(site: &ContinuationPoint) -> ContinuationPoint {
    let nodes = site.shooting.nodes.iter();
    let node = |x: &Vector| Vector::from_column_slice(&[x[0], x[1], x[1]]);
    site.with_nodes(nodes.map(node).collect())
}
