//! The variables in which orbits of a slab are followed, and the way from one to the other.

use super::normal_form::{Form, normal_form};
use crate::bifurcation::Criticality;
use crate::field::State;
use crate::number::Uncertain;
use crate::orbit::{Family, OverLoadings, OverParted, Polygon, Site};

/// Orbits of a slab in some variables.
pub trait Chart<const N: usize>: Family<N> + Copy {
    /// The slab over the plane of parameters.
    fn slab(&self) -> OverLoadings;
    /// An orbit in (tau, ln psi) or (tau, ln psi_1, ln psi_2).
    fn usual(&self, site: &Site<N>) -> Site<N>;
    /// Whether the walk from `last` to `here` has come to a symmetric orbit.
    fn merges(&self, here: &Site<N>, last: &Site<N>) -> bool;
    /// Whether the interfaces come so near each other along the orbit that these variables lose their difference.
    fn loses(&self, site: &Site<N>) -> bool;
    /// Whether these are the variables that don't.
    fn parted(&self) -> bool {
        false
    }
    /// The same orbit in the variables that don't.
    fn keeping(&self, site: &Site<N>) -> Option<(OverParted, Site<3>)>;
    /// The cubic coefficient of an orbit that bifurcates, in the space of all states, and which way that is.
    fn normal_form(&self, site: &Site<N>, form: Form) -> (Uncertain, Criticality);
}

/// The least difference of ln psi along an orbit that is left with digits enough.
const LEAST: f64 = 1e-4;
/// The greatest difference of psi along an orbit that is symmetric but for it: its square changes nothing.
const SYMMETRIC: f64 = -15.0;

impl Chart<2> for OverLoadings {
    fn slab(&self) -> OverLoadings {
        *self
    }
    fn usual(&self, site: &Site<2>) -> Site<2> {
        site.clone()
    }
    fn merges(&self, _: &Site<2>, _: &Site<2>) -> bool {
        false
    }
    fn loses(&self, _: &Site<2>) -> bool {
        false
    }
    fn keeping(&self, _: &Site<2>) -> Option<(OverParted, Site<3>)> {
        None
    }
    fn normal_form(&self, site: &Site<2>, form: Form) -> (Uncertain, Criticality) {
        normal_form(self, &embedded(site), form)
    }
}

impl Chart<3> for OverLoadings {
    fn slab(&self) -> OverLoadings {
        *self
    }
    fn usual(&self, site: &Site<3>) -> Site<3> {
        site.clone()
    }
    // The difference has one sign all along an asymmetric orbit.
    fn merges(&self, here: &Site<3>, last: &Site<3>) -> bool {
        asymmetry(here) * asymmetry(last) <= 0.0
    }
    fn loses(&self, site: &Site<3>) -> bool {
        let apart = site.polygon.nodes.iter().map(|x| (x[1] - x[2]).abs());
        apart.fold(f64::INFINITY, f64::min) < LEAST
    }
    fn keeping(&self, site: &Site<3>) -> Option<(OverParted, Site<3>)> {
        Some((OverParted(*self), OverParted::parted(site)?))
    }
    fn normal_form(&self, site: &Site<3>, form: Form) -> (Uncertain, Criticality) {
        normal_form(self, site, form)
    }
}

impl Chart<3> for OverParted {
    fn parted(&self) -> bool {
        true
    }
    fn slab(&self) -> OverLoadings {
        self.0
    }
    fn usual(&self, site: &Site<3>) -> Site<3> {
        OverParted::united(site)
    }
    fn merges(&self, here: &Site<3>, _: &Site<3>) -> bool {
        let gaps = here.polygon.nodes.iter().map(|x| x[2]);
        gaps.fold(f64::NEG_INFINITY, f64::max) < SYMMETRIC
    }
    fn loses(&self, _: &Site<3>) -> bool {
        false
    }
    fn keeping(&self, _: &Site<3>) -> Option<(OverParted, Site<3>)> {
        None
    }
    fn normal_form(&self, site: &Site<3>, form: Form) -> (Uncertain, Criticality) {
        normal_form(self, site, form)
    }
}

/// The mean of ln psi_1 - ln psi_2.
fn asymmetry(site: &Site<3>) -> f64 {
    let apart = site.polygon.nodes.iter().map(|x| x[1] - x[2]);
    apart.sum::<f64>() / site.polygon.nodes.len() as f64
}

/// The symmetric orbit in the middle of one in (tau, ln psi_1, ln psi_2).
pub(super) fn middle<const N: usize>(site: &Site<N>) -> Site<2> {
    let nodes = site.polygon.nodes.iter();
    Site {
        polygon: Polygon {
            nodes: nodes
                .map(|x| State::<2>::new(x[0], 0.5 * (x[1] + x[N - 1])))
                .collect(),
            durations: site.polygon.durations.clone(),
        },
        at: site.at,
    }
}

/// A symmetric orbit among all.
pub(super) fn embedded(site: &Site<2>) -> Site<3> {
    let nodes = site.polygon.nodes.iter();
    Site {
        polygon: Polygon {
            nodes: nodes.map(|x| State::<3>::new(x[0], x[1], x[1])).collect(),
            durations: site.polygon.durations.clone(),
        },
        at: site.at,
    }
}
