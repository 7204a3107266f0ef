//! Charts: the variables in which orbits of a slab are followed, and the way from one to the other.

use super::normal_form::{Form, classified};
use crate::bifurcation::Criticality;
use crate::field::State;
use crate::number::Uncertain;
use crate::orbit::{
    ContinuationPoint, OverDifferenceChart, OverLoadings, ParametrisedField, Regular, ShootingNodes,
};

/// Orbits of a slab in some variables.
pub trait Chart<const N: usize>: ParametrisedField<N> + Copy {
    /// The slab over the plane of parameters.
    fn slab(&self) -> OverLoadings;
    /// An orbit in (tau, ln psi) or (tau, ln psi_1, ln psi_2).
    fn usual(&self, site: &ContinuationPoint<N>) -> ContinuationPoint<N>;
    /// Whether the continuation from `last` to `here` has come to a symmetric orbit.
    fn merges(&self, here: &ContinuationPoint<N>, last: &ContinuationPoint<N>) -> bool;
    /// Whether the interfaces come so near each other along the orbit that these variables lose their difference.
    fn loses(&self, site: &ContinuationPoint<N>) -> bool;
    /// Whether this is the difference chart, which does not lose it.
    fn keeps_difference(&self) -> bool {
        false
    }
    /// The same orbit in the difference chart.
    fn keeping(
        &self,
        site: &ContinuationPoint<N>,
    ) -> Option<(OverDifferenceChart, ContinuationPoint<3>)>;
    /// The same orbit as a symmetric one, from which asymmetric ones part at a pitchfork, where orbits have so many variables.
    fn symmetric<'o>(&self, _: &'o Regular<N>) -> Option<&'o Regular<2>> {
        None
    }
    /// The same orbit as one in all variables, where periods double, where orbits have so many.
    fn whole<'o>(&self, _: &'o Regular<N>) -> Option<&'o Regular<3>> {
        None
    }
    /// The cubic coefficient of an orbit that bifurcates, in the space of all states, and which way that is.
    fn normal_form(&self, site: &ContinuationPoint<N>, form: Form) -> (Uncertain, Criticality);
}

/// The least difference of ln psi along an orbit that is left with digits enough.
const LEAST: f64 = 1e-4;
/// The greatest difference of psi along an orbit that is symmetric but for it: its square changes nothing.
const SYMMETRIC: f64 = -15.0;

impl Chart<2> for OverLoadings {
    fn slab(&self) -> OverLoadings {
        *self
    }
    fn usual(&self, site: &ContinuationPoint<2>) -> ContinuationPoint<2> {
        site.clone()
    }
    fn merges(&self, _: &ContinuationPoint<2>, _: &ContinuationPoint<2>) -> bool {
        false
    }
    fn loses(&self, _: &ContinuationPoint<2>) -> bool {
        false
    }
    fn keeping(
        &self,
        _: &ContinuationPoint<2>,
    ) -> Option<(OverDifferenceChart, ContinuationPoint<3>)> {
        None
    }
    fn symmetric<'o>(&self, orbit: &'o Regular<2>) -> Option<&'o Regular<2>> {
        Some(orbit)
    }
    fn normal_form(&self, site: &ContinuationPoint<2>, form: Form) -> (Uncertain, Criticality) {
        classified(self, &embedded(site), form)
    }
}

impl Chart<3> for OverLoadings {
    fn slab(&self) -> OverLoadings {
        *self
    }
    fn usual(&self, site: &ContinuationPoint<3>) -> ContinuationPoint<3> {
        site.clone()
    }
    // The difference has one sign all along an asymmetric orbit.
    fn merges(&self, here: &ContinuationPoint<3>, last: &ContinuationPoint<3>) -> bool {
        asymmetry(here) * asymmetry(last) <= 0.0
    }
    fn loses(&self, site: &ContinuationPoint<3>) -> bool {
        let apart = site.shooting.nodes.iter().map(|x| (x[1] - x[2]).abs());
        apart.fold(f64::INFINITY, f64::min) < LEAST
    }
    fn keeping(
        &self,
        site: &ContinuationPoint<3>,
    ) -> Option<(OverDifferenceChart, ContinuationPoint<3>)> {
        Some((
            OverDifferenceChart(*self),
            OverDifferenceChart::to_chart(site)?,
        ))
    }
    fn whole<'o>(&self, orbit: &'o Regular<3>) -> Option<&'o Regular<3>> {
        Some(orbit)
    }
    fn normal_form(&self, site: &ContinuationPoint<3>, form: Form) -> (Uncertain, Criticality) {
        classified(self, site, form)
    }
}

impl Chart<3> for OverDifferenceChart {
    fn keeps_difference(&self) -> bool {
        true
    }
    fn slab(&self) -> OverLoadings {
        self.0
    }
    fn usual(&self, site: &ContinuationPoint<3>) -> ContinuationPoint<3> {
        OverDifferenceChart::from_chart(site)
    }
    fn merges(&self, here: &ContinuationPoint<3>, _: &ContinuationPoint<3>) -> bool {
        let gaps = here.shooting.nodes.iter().map(|x| x[2]);
        gaps.fold(f64::NEG_INFINITY, f64::max) < SYMMETRIC
    }
    fn loses(&self, _: &ContinuationPoint<3>) -> bool {
        false
    }
    fn keeping(
        &self,
        _: &ContinuationPoint<3>,
    ) -> Option<(OverDifferenceChart, ContinuationPoint<3>)> {
        None
    }
    fn whole<'o>(&self, orbit: &'o Regular<3>) -> Option<&'o Regular<3>> {
        Some(orbit)
    }
    fn normal_form(&self, site: &ContinuationPoint<3>, form: Form) -> (Uncertain, Criticality) {
        classified(self, site, form)
    }
}

/// The mean of ln psi_1 - ln psi_2.
fn asymmetry(site: &ContinuationPoint<3>) -> f64 {
    let apart = site.shooting.nodes.iter().map(|x| x[1] - x[2]);
    apart.sum::<f64>() / site.shooting.nodes.len() as f64
}

/// The symmetric orbit in the middle of one in (tau, ln psi_1, ln psi_2).
pub(super) fn middle<const N: usize>(site: &ContinuationPoint<N>) -> ContinuationPoint<2> {
    let nodes = site.shooting.nodes.iter();
    ContinuationPoint {
        shooting: ShootingNodes {
            nodes: nodes
                .map(|x| State::<2>::new(x[0], 0.5 * (x[1] + x[N - 1])))
                .collect(),
            durations: site.shooting.durations.clone(),
        },
        at: site.at,
    }
}

/// A symmetric orbit among all.
pub(super) fn embedded(site: &ContinuationPoint<2>) -> ContinuationPoint<3> {
    let nodes = site.shooting.nodes.iter();
    ContinuationPoint {
        shooting: ShootingNodes {
            nodes: nodes.map(|x| State::<3>::new(x[0], x[1], x[1])).collect(),
            durations: site.shooting.durations.clone(),
        },
        at: site.at,
    }
}
