//! Which way bifurcations go, and where along a curve of them that changes.

use super::chart::Chart;
use super::normal_form::Form;
use crate::bifurcation::{Criticality, Label, Special};
use crate::number::Uncertain;
use crate::orbit::{Condition, Corrector, Goal, Indicator, OverLoadings, Regular, Site};

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

    /// The same at a point of a curve. `None` for folds.
    pub fn along<F: Chart<N>, const N: usize>(
        family: &F,
        site: &Site<N>,
        indicator: Indicator,
    ) -> Option<Self> {
        let form = match indicator {
            Indicator::Torus => Form::Torus,
            Indicator::Doubling => Form::Doubling,
            Indicator::Across => Form::Pitchfork,
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
        self.coefficient_uncertainty = sure.map(|way| way.coefficient.uncertainty);
    }
}

/// An orbit on a curve where it is decided which way the bifurcation goes.
#[derive(Debug, Clone)]
pub(super) struct Decided<const N: usize> {
    site: Site<N>,
    /// ln of the multipliers' product.
    volume: f64,
    coefficient: Uncertain,
}

/// Tolerance of the orbits at which the coefficient is looked at.
const FINE: f64 = 1e-15;

impl<const N: usize> Decided<N> {
    /// `None` where it is not decided.
    pub fn new(here: &Regular<N>, way: &Way) -> Option<Self> {
        (way.criticality != Criticality::Undecided).then(|| Decided {
            site: here.site.clone(),
            volume: here.spectrum.volume,
            coefficient: way.coefficient,
        })
    }

    /// The orbit on the curve near a site, at this ln K: whether it is decided there or not.
    fn beside<F: Chart<N>>(
        site: &Site<N>,
        family: &F,
        indicator: Indicator,
        log_stiffness: f64,
    ) -> Option<Self> {
        let mut corrector = Corrector::new(family, FINE).ok()?;
        let held = Condition::Parameter(1, log_stiffness);
        let conditions = [Condition::Indicator(indicator), held];
        let here = corrector
            .correct(site.clone(), &[0, 1], &conditions, Goal::SHARP)
            .ok()?;
        let way = Way::along(family, &here.site, indicator)?;
        Some(Decided {
            volume: here.spectrum.volume,
            coefficient: way.coefficient,
            site: here.site,
        })
    }

    /// Between this orbit and another one on the same curve the bifurcation may change the way that it goes, where the
    /// coefficient is zero: a Chenciner point, a degenerate period doubling or pitchfork. By the method of false position in
    /// ln K.
    pub fn change<F: Chart<N>>(
        &self,
        to: &Self,
        family: &F,
        indicator: Indicator,
    ) -> Option<Special> {
        /// Steps; a change of ln K that is the last; and how often an end may stay before its value is halved.
        const STEPS: usize = 60;
        const LAST: f64 = 1e-13;
        let (mut a, mut b) = (self.clone(), to.clone());
        let (mut left, mut right) = (a.coefficient.value, b.coefficient.value);
        if left * right > 0.0 {
            return None;
        }
        let largest = left.abs().max(right.abs());
        // At the resonance 1:2 the coefficient of the doubling changes its sign through infinity.
        if indicator == Indicator::Doubling && a.volume * b.volume < 0.0 {
            return None;
        }
        let (mut zero, mut kept) = (None, 0_i32);
        for _ in 0..STEPS {
            let (from, to) = (a.site.at[1], b.site.at[1]);
            let at = (from * right - to * left) / (right - left);
            let nearer = if (at - from).abs() < (at - to).abs() {
                &a
            } else {
                &b
            };
            let here = Self::beside(&nearer.site, family, indicator, at)?;
            let value = here.coefficient.value;
            let moved = (at - from).abs().min((at - to).abs());
            let found = value.abs() <= here.coefficient.uncertainty || moved < LAST;
            if value * right > 0.0 {
                (b, right) = (here.clone(), value);
                if kept > 0 {
                    left *= 0.5;
                }
                kept = 1;
            } else {
                (a, left) = (here.clone(), value);
                if kept < 0 {
                    right *= 0.5;
                }
                kept = -1;
            }
            if found {
                zero = Some(here);
                break;
            }
        }
        let zero = zero.filter(|zero| zero.coefficient.value.abs() < largest)?;
        zero.special(family, indicator)
    }

    /// The zero of the coefficient, with the uncertainty that its own leaves.
    fn special<F: Chart<N>>(&self, family: &F, indicator: Indicator) -> Option<Special> {
        /// How far beside it the slopes are taken, in ln K.
        const BESIDE: f64 = 1e-4;
        /// Rounding, in the logarithms.
        const ROUNDING: f64 = 1e-13;
        let other = Self::beside(&self.site, family, indicator, self.site.at[1] + BESIDE)?;
        let slope = (other.coefficient.value - self.coefficient.value) / BESIDE;
        let off = (self.coefficient.value.abs() + self.coefficient.uncertainty) / slope.abs();
        let uncertain = |of: &dyn Fn(&Self) -> f64| {
            let (here, there) = (of(self), of(&other));
            let by_slope = off * (there - here).abs() / BESIDE;
            Uncertain::new(here, by_slope + ROUNDING * here.abs())
        };
        let label = match indicator {
            Indicator::Torus => Label::Ch,
            Indicator::Doubling => Label::Gpd,
            _ => Label::Cp,
        };
        let driving = uncertain(&|d| d.site.at[0].exp());
        let stiffness = uncertain(&|d| d.site.at[1].exp());
        Some(Special {
            period: Some(uncertain(&|d| d.site.polygon.period())),
            note: (label == Label::Cp).then(|| DEGENERATE.into()),
            ..Special::new(label, driving, stiffness)
        })
    }
}

/// The degenerate pitchfork near an orbit at which a curve of folds of asymmetric orbits has come to symmetric ones.
pub(super) fn degenerate_pitchfork(family: &OverLoadings, near: &Site<2>) -> Option<Special> {
    /// How far to both sides it is looked for, in ln K.
    const FAR: f64 = 0.01;
    let [below, above] =
        [-FAR, FAR].map(|off| Decided::beside(near, family, Indicator::Across, near.at[1] + off));
    below?.change(&above?, family, Indicator::Across)
}

/// What a change of the way that a pitchfork goes is.
const DEGENERATE: &str = "degenerate pitchfork: a curve of folds of asymmetric orbits ends here";
