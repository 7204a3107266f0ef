//! The cubic coefficient of the normal form: the criticality of a bifurcation, and where along a curve that changes.

use super::chart::Chart;
use super::normal_form::Form;
use crate::bifurcation::{Criticality, Label, Special};
use crate::equilibrium::Symmetry;
use crate::model::{DRIVING, Parameter, STIFFNESS};
use crate::number::Uncertain;
use crate::orbit::{
    Condition, ContinuationPoint, Corrector, Goal, OverLoadings, Regular, TestFunction,
};

/// Which way a bifurcation goes.
#[derive(Debug, Clone, Copy)]
pub(super) struct CubicCoefficient {
    pub criticality: Criticality,
    /// The cubic coefficient whose sign that is.
    pub coefficient: Uncertain,
}

impl CubicCoefficient {
    /// By the cubic coefficient in the space of all states.
    pub fn at(chart: Chart, site: &ContinuationPoint, form: Form) -> Self {
        let (coefficient, criticality) = chart.normal_form(site, form);
        CubicCoefficient {
            criticality,
            coefficient,
        }
    }

    /// The same at a point of a curve. `None` for folds.
    pub fn along(
        chart: Chart,
        site: &ContinuationPoint,
        test_function: TestFunction,
    ) -> Option<Self> {
        let form = match test_function {
            TestFunction::Torus => Form::Torus,
            TestFunction::Doubling => Form::Doubling,
            TestFunction::Transverse => Form::Pitchfork,
            _ => return None,
        };
        Some(CubicCoefficient::at(chart, site, form))
    }
}

impl Special {
    /// Which way it goes, as far as that is decided.
    pub(super) fn goes(&mut self, way: Option<CubicCoefficient>) {
        self.criticality = way.map(|way| way.criticality);
        let sure = way.filter(|way| way.coefficient.uncertainty.is_finite());
        self.coefficient = sure.map(|way| way.coefficient.value);
        self.coefficient_uncertainty = sure.map(|way| way.coefficient.uncertainty);
    }
}

/// An orbit on a curve where it is decided which way the bifurcation goes.
#[derive(Debug, Clone)]
pub(super) struct Decided {
    site: ContinuationPoint,
    /// ln of the multipliers' product.
    volume: f64,
    coefficient: Uncertain,
}

/// Tolerance of the orbits at which the coefficient is looked at.
const FINE: f64 = 1e-15;

impl Decided {
    /// `None` where it is not decided.
    pub fn new(here: &Regular, way: &CubicCoefficient) -> Option<Self> {
        (way.criticality != Criticality::Undecided).then(|| Decided {
            site: here.site.clone(),
            volume: here.spectrum.volume,
            coefficient: way.coefficient,
        })
    }

    /// The orbit on the curve near a site, at this ln K: whether it is decided there or not.
    fn beside(
        site: &ContinuationPoint,
        chart: Chart,
        test_function: TestFunction,
        log_stiffness: f64,
    ) -> Option<Self> {
        let mut corrector = Corrector::new(chart.family(), FINE).ok()?;
        let held = Condition::Parameter(STIFFNESS, log_stiffness);
        let conditions = [Condition::TestFunction(test_function), held];
        let here = corrector
            .correct(site.clone(), &Parameter::PLANE, &conditions, Goal::SHARP)
            .ok()?;
        let way = CubicCoefficient::along(chart, &here.site, test_function)?;
        Some(Decided {
            volume: here.spectrum.volume,
            coefficient: way.coefficient,
            site: here.site,
        })
    }

    /// Between this orbit and another one on the same curve the bifurcation may change the way that it goes, where the
    /// coefficient is zero: a Chenciner point, a degenerate period doubling or pitchfork. By the method of false position in
    /// ln K.
    pub fn change(&self, to: &Self, chart: Chart, test_function: TestFunction) -> Option<Special> {
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
        if test_function == TestFunction::Doubling && a.volume * b.volume < 0.0 {
            return None;
        }
        let (mut zero, mut kept) = (None, 0_i32);
        for _ in 0..STEPS {
            let (from, to) = (a.site.at[STIFFNESS], b.site.at[STIFFNESS]);
            let at = (from * right - to * left) / (right - left);
            let nearer = if (at - from).abs() < (at - to).abs() {
                &a
            } else {
                &b
            };
            let here = Self::beside(&nearer.site, chart, test_function, at)?;
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
        zero.special(chart, test_function)
    }

    /// The zero of the coefficient, with the uncertainty that its own leaves.
    fn special(&self, chart: Chart, test_function: TestFunction) -> Option<Special> {
        /// How far beside it the slopes are taken, in ln K.
        const BESIDE: f64 = 1e-4;
        /// Rounding, in the logarithms.
        const ROUNDING: f64 = 1e-13;
        let other = Self::beside(
            &self.site,
            chart,
            test_function,
            self.site.at[STIFFNESS] + BESIDE,
        )?;
        let slope = (other.coefficient.value - self.coefficient.value) / BESIDE;
        let off = (self.coefficient.value.abs() + self.coefficient.uncertainty) / slope.abs();
        let uncertain = |of: &dyn Fn(&Self) -> f64| {
            let (here, there) = (of(self), of(&other));
            let by_slope = off * (there - here).abs() / BESIDE;
            Uncertain::new(here, by_slope + ROUNDING * here.abs())
        };
        let label = match test_function {
            TestFunction::Torus => Label::Ch,
            TestFunction::Doubling => Label::Gpd,
            _ => Label::Cp,
        };
        let driving = uncertain(&|d| d.site.at[DRIVING].exp());
        let stiffness = uncertain(&|d| d.site.at[STIFFNESS].exp());
        Some(Special {
            period: Some(uncertain(&|d| d.site.shooting.period())),
            note: (label == Label::Cp).then(|| DEGENERATE.into()),
            ..Special::new(label, driving, stiffness)
        })
    }
}

/// The degenerate pitchfork near an orbit at which a curve of folds of asymmetric orbits has come to symmetric ones.
pub(super) fn degenerate_pitchfork(
    family: &OverLoadings,
    near: &ContinuationPoint,
) -> Option<Special> {
    /// How far to both sides it is looked for, in ln K.
    const FAR: f64 = 0.01;
    let chart = Chart::new(family.slab, Symmetry::Symmetric);
    let [below, above] = [-FAR, FAR].map(|off| {
        Decided::beside(
            near,
            chart,
            TestFunction::Transverse,
            near.at[STIFFNESS] + off,
        )
    });
    below?.change(&above?, chart, TestFunction::Transverse)
}

/// What a change of the way that a pitchfork goes is.
const DEGENERATE: &str = "degenerate pitchfork: a curve of folds of asymmetric orbits ends here";
