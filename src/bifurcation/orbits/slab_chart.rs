//! Charts: the variables in which orbits of a slab are followed, and the way from one to the other.

use super::normal_form::{Form, classified};
use crate::bifurcation::Criticality;
use crate::equilibrium::Symmetry;
use crate::field::Vector;
use crate::number::Uncertain;
use crate::orbit::{
    ContinuationPoint, InterfaceSystem, OverDifferenceChart, OverLoadings, ParametrisedField,
};

/// Orbits of a slab in some variables.
#[derive(Debug, Clone, Copy)]
pub enum Chart {
    /// In (tau, ln psi) where they are symmetric or of a single interface, else in (tau, ln psi_1, ln psi_2).
    Usual(OverLoadings),
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
        Chart::Usual(OverLoadings::new(slab, symmetry))
    }

    /// The vector fields over the plane of parameters.
    pub fn family(&self) -> &dyn ParametrisedField {
        match self {
            Chart::Usual(family) => family,
            Chart::Difference(family) => family,
        }
    }

    /// The slab over the plane of parameters.
    pub fn slab(&self) -> OverLoadings {
        match *self {
            Chart::Usual(family) | Chart::Difference(OverDifferenceChart(family)) => family,
        }
    }

    /// The symmetry of its orbits: asymmetric ones part from symmetric ones at a pitchfork, and only they double their period.
    pub fn symmetry(&self) -> Symmetry {
        self.slab().symmetry
    }

    /// The family, where it is of asymmetric orbits in the usual variables.
    fn asymmetric(&self) -> Option<OverLoadings> {
        match *self {
            Chart::Usual(family) if family.symmetry == Symmetry::Asymmetric => Some(family),
            _ => None,
        }
    }

    /// An orbit in (tau, ln psi) or (tau, ln psi_1, ln psi_2).
    pub fn usual(&self, site: &ContinuationPoint) -> ContinuationPoint {
        match self {
            Chart::Usual(_) => site.clone(),
            Chart::Difference(_) => OverDifferenceChart::from_chart(site),
        }
    }

    /// Whether the continuation from `last` to `here` has come to a symmetric orbit.
    pub fn merges(&self, here: &ContinuationPoint, last: &ContinuationPoint) -> bool {
        if self.keeps_difference() {
            let gaps = here.shooting.nodes.iter().map(|x| x[2]);
            return gaps.fold(f64::NEG_INFINITY, f64::max) < SYMMETRIC;
        }
        // The difference has one sign all along an asymmetric orbit.
        self.asymmetric().is_some() && asymmetry(here) * asymmetry(last) <= 0.0
    }

    /// Whether the interfaces come so near each other along the orbit that these variables lose their difference.
    pub fn loses(&self, site: &ContinuationPoint) -> bool {
        let apart = || site.shooting.nodes.iter().map(|x| (x[1] - x[2]).abs());
        self.asymmetric().is_some() && apart().fold(f64::INFINITY, f64::min) < LEAST
    }

    /// Whether this is the difference chart, which does not lose it.
    pub fn keeps_difference(&self) -> bool {
        matches!(self, Chart::Difference(_))
    }

    /// The same orbit in the difference chart.
    pub fn keeping(&self, site: &ContinuationPoint) -> Option<(Chart, ContinuationPoint)> {
        let chart = Chart::Difference(OverDifferenceChart(self.asymmetric()?));
        Some((chart, OverDifferenceChart::to_chart(site)?))
    }

    /// The cubic coefficient of an orbit that bifurcates, in the space of all states, and which way that is.
    pub fn normal_form(&self, site: &ContinuationPoint, form: Form) -> (Uncertain, Criticality) {
        match self.symmetry() {
            Symmetry::Symmetric => {
                let whole = OverLoadings::new(self.slab().slab, Symmetry::Asymmetric);
                classified(&whole, &embedded(site), form)
            }
            Symmetry::Asymmetric => classified(self.family(), site, form),
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
fn embedded(site: &ContinuationPoint) -> ContinuationPoint {
    let nodes = site.shooting.nodes.iter();
    let node = |x: &Vector| Vector::from_column_slice(&[x[0], x[1], x[1]]);
    site.with_nodes(nodes.map(node).collect())
}
