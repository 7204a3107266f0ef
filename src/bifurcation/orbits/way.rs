//! Which way bifurcations go, and where along a curve of them that changes.

use super::branch::ROUGH;
use super::chart::Chart;
use super::normal_form::Form;
use crate::bifurcation::{Criticality, Label, Special};
use crate::number::Uncertain;
use crate::orbit::{Condition, Corrector, Goal, Indicator, Regular, Site};

/// Which way a bifurcation goes.
#[derive(Debug, Clone, Copy)]
pub(super) struct Way {
    pub criticality: Criticality,
    /// The cubic coefficient whose sign that is.
    pub coefficient: Uncertain,
}

impl Way {
    /// By the cubic coefficient in the space of all states.
    pub fn at<F: Chart<N>, const N: usize>(family: &F, site: &Site<N>, form: Form) -> Self {
        let (coefficient, criticality) = family.normal_form(site, form);
        Way {
            criticality,
            coefficient,
        }
    }

    /// The same at a point of a curve. `None` for bifurcations that are not decided by such a coefficient.
    pub fn along<F: Chart<N>, const N: usize>(
        family: &F,
        site: &Site<N>,
        indicator: Indicator,
    ) -> Option<Self> {
        let form = match indicator {
            Indicator::Torus => Form::Torus,
            Indicator::Doubling => Form::Doubling,
            _ => return None,
        };
        Some(Way::at(family, site, form))
    }
}

impl Special {
    /// Which way it goes, as far as that is decided.
    pub(super) fn goes(&mut self, way: Option<Way>) {
        self.criticality = way.map(|way| way.criticality);
        let sure = way.filter(|way| way.coefficient.uncertainty.is_finite());
        self.coefficient = sure.map(|way| way.coefficient.value);
    }
}

/// An orbit on a curve, the logarithm of its multipliers' product, and which way the bifurcation goes there.
#[derive(Debug, Clone)]
pub(super) struct Decided<const N: usize> {
    site: Site<N>,
    volume: f64,
    goes: Criticality,
}

impl<const N: usize> Decided<N> {
    /// `None` where it is not decided.
    pub fn new(here: &Regular<N>, goes: Criticality) -> Option<Self> {
        (goes != Criticality::Undecided).then(|| Decided {
            site: here.site.clone(),
            volume: here.spectrum.volume,
            goes,
        })
    }

    /// Between this orbit and another one the bifurcation may change the way that it goes: a Chenciner point, or a degenerate
    /// period doubling. By halves in K, for of the coefficient the sign alone does not depend on the plane; where neither way is
    /// decided the point is somewhere.
    pub fn change<F: Chart<N>>(
        &self,
        to: &Self,
        family: &F,
        indicator: Indicator,
    ) -> Option<Special> {
        if self.goes == to.goes {
            return None;
        }
        let label = match indicator {
            Indicator::Torus => Label::Ch,
            _ => Label::Gpd,
        };
        let (from, to) = (
            self.last_towards(to, family, indicator),
            to.last_towards(self, family, indicator),
        );
        // At the resonance 1:2 the coefficient of the doubling changes its sign through infinity.
        if label == Label::Gpd && from.volume * to.volume < 0.0 {
            return None;
        }
        let (from, to) = (from.site, to.site);
        let between = |a: f64, b: f64| Uncertain::new(0.5 * (a + b), 0.5 * (a - b).abs());
        let [driving, stiffness] = [0, 1].map(|i| between(from.at[i].exp(), to.at[i].exp()));
        Some(Special {
            period: Some(between(from.polygon.period(), to.polygon.period())),
            ..Special::new(label, driving, stiffness)
        })
    }

    /// The last orbit on the way to another that is decided as this one is.
    fn last_towards<F: Chart<N>>(&self, other: &Self, family: &F, indicator: Indicator) -> Self {
        /// How near, in ln K.
        const NEAR: f64 = 1e-6;
        let (mut from, mut to) = (self.clone(), other.site.clone());
        while (to.at[1] - from.site.at[1]).abs() > NEAR
            && let Ok(mut corrector) = Corrector::new(family, ROUGH)
        {
            let middle = Condition::Parameter(1, 0.5 * (from.site.at[1] + to.at[1]));
            let conditions = [Condition::Indicator(indicator), middle];
            let begin = from.site.clone();
            let Some(half) = corrector.correct(begin, &[0, 1], &conditions, Goal::STEP) else {
                break;
            };
            let way = Way::along(family, &half.site, indicator);
            if way.is_some_and(|way| way.criticality == self.goes) {
                (from.site, from.volume) = (half.site, half.spectrum.volume);
            } else {
                to = half.site;
            }
        }
        from
    }
}
