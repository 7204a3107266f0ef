//! Where a branch of orbits meets itself, of which no symmetry is told: at the pitchfork behind which its orbits are the mirror images of those before, or at the
//! period doubling behind which they are the same orbits, half a period later. The parameter turns there, and no multiplier passes 1.

use super::branches::Doubling;
use super::chart::Chart;
use super::crossing::{Crossing, crossing};
use super::normal_form::Form;
use super::orbit_branch::OrbitBranch;
use super::orbit_point::refined_point;
use super::refine::{RefinedPoint, refined};
use super::turning::turns_without_fold;
use crate::bifurcation::Label;
use crate::bifurcation::general::{FREE, GeneralEvent, GeneralPoint, Teller};
use crate::orbit::{
    ContinuationPoint, Corrector, DirectedPoint, Palc, Regular, ShootingNodes, TestFunction,
    WatchedFunction,
};

impl OrbitBranch<'_, '_, '_> {
    /// Whether the branch has met itself on this step, on which the parameter has turned; then that is told.
    pub fn meets_itself(
        &mut self,
        palc: &mut Palc<'_, '_>,
        (before, now): (&DirectedPoint, &DirectedPoint),
        teller: &mut Teller<'_>,
    ) -> bool {
        let here = &now.here;
        if let Some(i) = self.known_crossing(&here.site) {
            self.meets_its_image(i, here, teller);
            return true;
        }
        if self.chart.symmetry().is_some() || !turns_without_fold(before, now) {
            return false;
        }
        let Some((near, between)) = palc.curve.own_image(before, now) else {
            return false;
        };
        if let Some(simple) = half(palc.curve.corrector, &between.site) {
            self.meets_its_half(&near, doubling(self.chart, &simple), teller);
            return true;
        }
        if let Some(i) = self.known_crossing(&near.site) {
            self.meets_its_image(i, here, teller);
            return true;
        }
        let along = between.along[0].clone();
        let there = DirectedPoint {
            here: between,
            direction: along,
        };
        let of = (self.number, self.times);
        let crossing = crossing(self.chart, &near, &there, of);
        let Some(crossing) = crossing.or_else(|| Crossing::rough(self.chart, &near, &there, of))
        else {
            return false;
        };
        // Known from the other branch, but not where it is?
        let rough = self.crossing_at(&near.site);
        let crossing = Crossing {
            // Both ways along the other branch.
            switch: (there.here.site, there.direction),
            is_pitchfork: false,
            visited: rough.is_some(),
            ..crossing
        };
        let i = rough.unwrap_or(self.set.crossings.len());
        match rough {
            Some(i) => self.set.crossings[i] = crossing,
            None => self.set.crossings.push(crossing),
        }
        self.meets_its_image(i, here, teller);
        true
    }

    /// The crossing that an orbit is next to, of which it is known where it is.
    fn known_crossing(&self, site: &ContinuationPoint) -> Option<usize> {
        let found = self.crossing_at(site);
        found.filter(|&i| self.set.crossings[i].at.uncertainty.is_finite())
    }

    /// The branch has come to a pitchfork, behind which there are its mirror images.
    fn meets_its_image(&mut self, i: usize, here: &Regular, teller: &mut Teller<'_>) {
        let crossing = &mut self.set.crossings[i];
        crossing.visited |= crossing.of != self.number;
        let (at, period) = (crossing.at, crossing.period);
        if !self.set.inside(at.value) {
            return;
        }
        let end = self.row(here, Some(Label::Pf));
        let end = GeneralPoint {
            at: [at.value, end.at[1]],
            period: Some(period),
            ..end
        };
        let end = end.placed(self.set.branch.system.family, [at.uncertainty, 0.0]);
        let _ = self.tell(GeneralEvent::Special(end), teller);
    }

    /// The branch has come to the period doubling at which it begins, near an orbit.
    fn meets_its_half(
        &mut self,
        near: &Regular,
        sharp: Option<RefinedPoint>,
        teller: &mut Teller<'_>,
    ) {
        let point = match &sharp {
            Some(sharp) => {
                let way = self.chart.normal_form(&sharp.orbit.site, Form::Doubling);
                refined_point((self.chart, self.number), sharp, Label::Pd).classified(way)
            }
            None => self.row(near, Some(Label::Pd)),
        };
        if self.set.inside(point.at[FREE]) {
            let note = Some("orbits of half the period double theirs here".to_owned());
            let _ = self.tell(
                GeneralEvent::Special(GeneralPoint { note, ..point }),
                teller,
            );
        }
        if let Some(RefinedPoint { orbit, .. }) = sharp {
            self.set.doublings.push(Doubling {
                orbit,
                before: self.times,
                visited: true,
            });
        }
    }
}

/// The orbit that is traversed twice, if this one is.
fn half(corrector: &mut Corrector<'_>, site: &ContinuationPoint) -> Option<ContinuationPoint> {
    /// In parts of how far the orbit goes.
    const ONE: f64 = 1e-5;
    let field = corrector.family.field(site.at);
    let (first, half) = (&site.shooting.nodes[0], 0.5 * site.shooting.period());
    let after = corrector.tracer.flow(&field, first, half, None).ok()?;
    let off = (field.turned(after, first) - first).component_div(&site.shooting.sizes());
    if off.amax() > ONE {
        return None;
    }
    let shooting = ShootingNodes::along(&mut corrector.tracer, &field, first, half).ok()?;
    Some(ContinuationPoint {
        shooting,
        at: site.at,
    })
}

/// The period doubling near an orbit.
fn doubling(chart: Chart<'_>, near: &ContinuationPoint) -> Option<RefinedPoint> {
    let doubles = [WatchedFunction::TestFunction(TestFunction::Doubling)];
    refined(chart.family(), near, &[FREE], &doubles)
}
