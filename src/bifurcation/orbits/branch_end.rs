//! Where one branch of periodic orbits ends, and what it tends to there.

use super::chart::Chart;
use super::growing_period::{Limit, Saddle};
use super::orbit_branch::OrbitBranch;
use super::vertical::Vertical;
use crate::bifurcation::Label;
use crate::bifurcation::general::{FREE, GeneralPoint, GeneralSolution};
use crate::number::Uncertain;
use crate::orbit::{DirectedPoint, Palc, Regular};
use std::cell::OnceCell;

/// How many of the last orbits of a branch may say nothing of its limit.
const LEFT_OUT: usize = 4;

impl OrbitBranch<'_, '_, '_> {
    /// Where the branch goes no further, or tends to.
    pub fn end(&self, last: &Regular, why: &str) -> GeneralPoint {
        if let Some(vertical) = self.vertical.filter(Vertical::is_shown) {
            return self.of_vertical(&vertical, last);
        }
        self.homoclinic_end(last).unwrap_or_else(|| GeneralPoint {
            note: Some(why.to_owned()),
            ..self.row(last, Some(Label::Mx))
        })
    }

    /// Where the branch tends to as its period grows without bound, if it does.
    pub fn homoclinic_end(&self, last: &Regular) -> Option<GeneralPoint> {
        // What is left of the way may be less than the last orbits are off by.
        let mut periods = self.periods.clone();
        let mut left_out = 0;
        let branch = self.set.branch;
        let whole = self.chart.in_whole(&last.site);
        let passed = OnceCell::new();
        let saddle = || {
            passed
                .get_or_init(|| Saddle::passed(branch, &whole))
                .as_ref()
        };
        let limit = loop {
            let limit = periods.limit(branch, &saddle);
            if limit.is_some() || (left_out >= LEFT_OUT && !periods.stay()) {
                break limit?;
            }
            periods.pop();
            left_out += 1;
        };
        let point = self.row(last, None);
        let unlisted = match self.are_listed {
            true => "",
            false => "; folds and period doublings of its last turns coincide, and are not listed",
        };
        let why = format!("the period grows without bound{unlisted}");
        Some(self.longest(point, limit, why))
    }

    /// The end of a branch whose period grows without bound; all but that as at its last orbit.
    fn longest(&self, last: GeneralPoint, limit: Limit, why: String) -> GeneralPoint {
        let Limit { at, is_saddle_node } = limit;
        let end = GeneralPoint {
            label: Some(Label::Hom),
            at: [at.value, last.at[1]],
            saddle_node: is_saddle_node,
            period: None,
            note: Some(why),
            ..last
        };
        end.placed(self.set.branch.system.family, [at.uncertainty, 0.0])
    }

    /// The end of a branch that winds without end.
    pub fn winding_end(&self, last: &Regular) -> Option<GeneralPoint> {
        let [a, b] = self.folds.winding()?;
        let limit = Limit {
            at: Uncertain::new(0.5 * (a + b), 0.5 * (b - a).abs()),
            is_saddle_node: false,
        };
        let why = "the period grows without bound: the branch oscillates between two folds, and its period grows by the same time at each pass, as near orbits homoclinic to another periodic orbit";
        let point = self.row(last, None);
        let mut end = self.longest(point, limit, why.to_owned());
        // The middle of two coordinates need not be that of the parameters.
        let family = self.set.branch.system.family;
        let [a, b] = [a, b].map(|at| family.parameters([at, end.at[1]])[FREE]);
        let off = 0.5 * (b - a).abs() + 2.0 * f64::EPSILON * a.abs();
        end.parameters[FREE] = Uncertain::new(0.5 * (a + b), off);
        Some(end)
    }

    /// Whether its orbits so far have one value of the parameter.
    pub fn is_vertical(&self) -> bool {
        self.vertical.is_some_and(|vertical| vertical.is_shown())
    }

    /// Where so many orbits have the same parameter that the branch is followed no further.
    pub fn vertical_end(
        &mut self,
        palc: &mut Palc<'_, '_>,
        now: &DirectedPoint,
    ) -> Option<GeneralPoint> {
        self.vertical = self
            .vertical
            .and_then(|vertical| vertical.and(palc, now, FREE));
        let vertical = self.vertical.filter(Vertical::is_enough)?;
        Some(self.of_vertical(&vertical, &now.here))
    }

    /// The end of a vertical branch.
    fn of_vertical(&self, vertical: &Vertical, last: &Regular) -> GeneralPoint {
        let point = GeneralPoint {
            note: Some(format!(
                "vertical branch: on {} orbits the parameter varies by no more than its error; all these orbits exist at the same value, as in a conservative system; not followed further",
                vertical.orbits()
            )),
            ..self.row(last, Some(Label::Ep))
        };
        point.placed(self.set.branch.system.family, [vertical.uncertainty(), 0.0])
    }
}

/// Whether all multipliers of an orbit are about those at a Hopf point. Else the branch has yet to pass what makes them so.
pub(super) fn grows_as_at(hopf: &GeneralPoint, chart: Chart<'_>, orbit: &Regular) -> bool {
    /// Allowed difference of a logarithm, relative and absolute; below the second constant a multiplier counts as zero.
    const OFF: f64 = 0.3;
    const NONE: f64 = -20.0;
    let (GeneralSolution::Equilibrium { eigenvalues, .. }, Some(period)) =
        (&hopf.solution, hopf.period)
    else {
        return true;
    };
    // One of the critical pair is the trivial multiplier.
    let mut all: Vec<f64> = eigenvalues.iter().map(|z| z.re * period.value).collect();
    let critical = (0..all.len()).min_by(|&i, &j| all[i].abs().total_cmp(&all[j].abs()));
    if let Some(critical) = critical {
        all.remove(critical);
    }
    all.sort_by(|a, b| b.total_cmp(a));
    let near = |(at_hopf, here): (&f64, &f64)| {
        let (a, b) = (at_hopf.max(NONE), here.max(NONE));
        here.is_nan() || (a - b).abs() <= OFF * (1.0 + a.abs())
    };
    all.iter().zip(&chart.log_multipliers(orbit)).all(near)
}
