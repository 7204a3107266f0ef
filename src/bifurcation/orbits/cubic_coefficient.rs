//! The cubic coefficient of the normal form: the criticality of a bifurcation, and where along a curve that changes.

use super::normal_form::Form;
use super::slab_chart::Chart;
use crate::bifurcation::{Criticality, Label, Special};
use crate::equilibrium::Symmetry;
use crate::model::{DRIVING, Parameter, STIFFNESS};
use crate::number::Uncertain;
use crate::orbit::{
    Condition, ContinuationPoint, Corrector, Goal, OverLoadings, ParametrisedField, Regular,
    TestFunction,
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

/// A curve of bifurcations, along which the cubic coefficient may be zero.
#[derive(Clone, Copy)]
pub(in crate::bifurcation) struct CoefficientCurve<'a> {
    /// The fields in which orbits of the curve are solved for.
    pub family: &'a dyn ParametrisedField,
    /// What is zero along the curve.
    pub test_function: TestFunction,
    /// The cubic coefficient of an orbit, and which way that is.
    pub coefficient: &'a dyn Fn(&ContinuationPoint) -> (Uncertain, Criticality),
    /// The coordinate in which its zero is looked for.
    pub held: usize,
}

/// An orbit on a curve where it is decided which way the bifurcation goes.
#[derive(Debug, Clone)]
pub(in crate::bifurcation) struct Decided {
    site: ContinuationPoint,
    /// ln of the multipliers' product.
    volume: f64,
    coefficient: Uncertain,
}

/// Where the cubic coefficient is zero: a Chenciner point, a degenerate period doubling or pitchfork.
#[derive(Debug, Clone)]
pub(in crate::bifurcation) struct CoefficientZero {
    /// Which of these.
    pub label: Label,
    /// The orbit.
    pub orbit: Regular,
    /// The parameters.
    pub at: [Uncertain; 2],
    /// The period.
    pub period: Uncertain,
    /// What there is to be said.
    pub note: Option<String>,
}

/// Tolerance of the orbits at which the coefficient is looked at.
const FINE: f64 = 1e-15;

impl Decided {
    /// `None` where it is not decided.
    pub fn new(here: &Regular, coefficient: Uncertain, criticality: Criticality) -> Option<Self> {
        (criticality != Criticality::Undecided).then(|| Decided {
            site: here.site.clone(),
            volume: here.spectrum.volume,
            coefficient,
        })
    }

    /// The orbit.
    pub fn site(&self) -> &ContinuationPoint {
        &self.site
    }

    /// The orbit on the curve near a site, at this value of the coordinate that is held: whether it is decided there or not.
    fn beside(
        site: &ContinuationPoint,
        curve: CoefficientCurve<'_>,
        value: f64,
    ) -> Option<(Self, Regular)> {
        let mut corrector = Corrector::new(curve.family, FINE).ok()?;
        let held = Condition::Parameter(curve.held, value);
        let conditions = [Condition::TestFunction(curve.test_function), held];
        let here = corrector
            .correct(site.clone(), &Parameter::PLANE, &conditions, Goal::SHARP)
            .ok()?;
        let (coefficient, _) = (curve.coefficient)(&here.site);
        if !coefficient.uncertainty.is_finite() {
            return None;
        }
        let decided = Decided {
            volume: here.spectrum.volume,
            coefficient,
            site: here.site.clone(),
        };
        Some((decided, here))
    }

    /// Between this orbit and another one on the same curve the bifurcation may change the way that it goes, where the
    /// coefficient is zero. By the method of false position in the coordinate that is held.
    pub fn change(&self, to: &Self, curve: CoefficientCurve<'_>) -> Option<CoefficientZero> {
        /// Steps; a change of the coordinate that is the last; and how often an end may stay before its value is halved.
        const STEPS: usize = 60;
        const LAST: f64 = 1e-13;
        let (mut a, mut b) = (self.clone(), to.clone());
        let (mut left, mut right) = (a.coefficient.value, b.coefficient.value);
        if left * right > 0.0 {
            return None;
        }
        let largest = left.abs().max(right.abs());
        // At the resonance 1:2 the coefficient of the doubling changes its sign through infinity.
        if curve.test_function == TestFunction::Doubling && a.volume * b.volume < 0.0 {
            return None;
        }
        let (mut zero, mut kept) = (None, 0_i32);
        for _ in 0..STEPS {
            let (from, to) = (a.site.at[curve.held], b.site.at[curve.held]);
            let at = (from * right - to * left) / (right - left);
            let nearer = if (at - from).abs() < (at - to).abs() {
                &a
            } else {
                &b
            };
            let (here, orbit) = Self::beside(&nearer.site, curve, at)?;
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
                zero = Some((here, orbit));
                break;
            }
        }
        let (zero, orbit) = zero.filter(|(zero, _)| zero.coefficient.value.abs() < largest)?;
        zero.told(orbit, curve)
    }

    /// The zero of the coefficient, with the uncertainty that its own leaves.
    fn told(&self, orbit: Regular, curve: CoefficientCurve<'_>) -> Option<CoefficientZero> {
        /// How far beside it the slopes are taken.
        const BESIDE: f64 = 1e-4;
        /// Rounding, in the coordinates.
        const ROUNDING: f64 = 1e-13;
        let (other, _) = Self::beside(&self.site, curve, self.site.at[curve.held] + BESIDE)?;
        let slope = (other.coefficient.value - self.coefficient.value) / BESIDE;
        let off = (self.coefficient.value.abs() + self.coefficient.uncertainty) / slope.abs();
        let uncertain = |of: &dyn Fn(&Self) -> f64| {
            let (here, there) = (of(self), of(&other));
            let by_slope = off * (there - here).abs() / BESIDE;
            Uncertain::new(here, by_slope + ROUNDING * here.abs())
        };
        let label = match curve.test_function {
            TestFunction::Torus => Label::Ch,
            TestFunction::Doubling => Label::Gpd,
            _ => Label::Cp,
        };
        let parameter = |i: usize| uncertain(&|d| curve.family.parameters(d.site.at)[i]);
        Some(CoefficientZero {
            label,
            at: [parameter(0), parameter(1)],
            period: uncertain(&|d| d.site.shooting.period()),
            note: (label == Label::Cp).then(|| DEGENERATE.into()),
            orbit,
        })
    }
}

impl CoefficientZero {
    /// As a special point of a slab in V_H and K.
    pub(super) fn special(self) -> Special {
        Special {
            period: Some(self.period),
            note: self.note,
            ..Special::new(self.label, self.at[DRIVING], self.at[STIFFNESS])
        }
    }
}

impl Chart {
    /// Does something with a curve in these variables, whose zeros are looked for in ln K.
    pub(super) fn with_curve<R>(
        self,
        test_function: TestFunction,
        then: impl FnOnce(CoefficientCurve<'_>) -> R,
    ) -> R {
        let unknown = (Uncertain::new(0.0, f64::INFINITY), Criticality::Undecided);
        let coefficient = |site: &ContinuationPoint| {
            let way = CubicCoefficient::along(self, site, test_function);
            way.map_or(unknown, |way| (way.coefficient, way.criticality))
        };
        then(CoefficientCurve {
            family: self.family(),
            test_function,
            coefficient: &coefficient,
            held: STIFFNESS,
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
    chart.with_curve(TestFunction::Transverse, |curve| {
        let [below, above] =
            [-FAR, FAR].map(|off| Decided::beside(near, curve, near.at[STIFFNESS] + off));
        let ((below, _), (above, _)) = (below?, above?);
        Some(below.change(&above, curve)?.special())
    })
}

/// What a change of the way that a pitchfork goes is.
const DEGENERATE: &str = "degenerate pitchfork: a curve of folds of asymmetric orbits ends here";
