//! The cubic coefficient of the normal form: the criticality of a bifurcation, and where along a curve that changes.

use super::chart::Chart;
use super::half_curve::{CurvesOfKind, HalfCurve};
use super::normal_form::Form;
use super::orbit_point::orbit_point;
use crate::bifurcation::general::{Classified, GeneralPoint};
use crate::bifurcation::{Criticality, Label};
use crate::model::Parameter;
use crate::number::Uncertain;
use crate::orbit::{
    Condition, ContinuationPoint, Corrector, Goal, ParametrisedField, Regular, TestFunction, Tracer,
};
use std::ops::ControlFlow::{self, Continue};

/// The cubic coefficient, and which way the bifurcation goes.
type Way = (Uncertain, Criticality);

/// A curve of bifurcations, along which the cubic coefficient may be zero.
#[derive(Clone, Copy)]
pub(super) struct CoefficientCurve<'a> {
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
pub(super) struct Decided {
    site: ContinuationPoint,
    /// ln of the multipliers' product.
    volume: f64,
    coefficient: Uncertain,
}

/// Where the cubic coefficient is zero: a Chenciner point, a degenerate period doubling or pitchfork.
#[derive(Debug, Clone)]
pub(super) struct CoefficientZero {
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

/// Parts of the arcs by which nodes are moved for other solutions.
const OTHER_NODES: [f64; 3] = [0.27, 0.51, 0.74];
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
        zero.with_budget(orbit, curve)
    }

    /// The zero of the coefficient, with the uncertainty that its own leaves.
    fn with_budget(&self, orbit: Regular, curve: CoefficientCurve<'_>) -> Option<CoefficientZero> {
        /// How far beside it the slopes are taken.
        const BESIDE: f64 = 1e-4;
        /// Rounding, in the coordinates.
        const ROUNDING: f64 = 1e-13;
        /// What the largest difference of the solutions counts.
        const SPREAD: f64 = 3.0;
        let held = self.site.at[curve.held];
        let (other, _) = Self::beside(&self.site, curve, held + BESIDE)?;
        let slope = (other.coefficient.value - self.coefficient.value) / BESIDE;
        // The coefficient's own uncertainty is that of one orbit; solved for with other nodes it rounds otherwise.
        let mut spread = 0.0_f64;
        for part in OTHER_NODES {
            let mut tracer = Tracer::taylor(FINE).ok()?;
            let field = curve.family.field(self.site.at);
            let shifted = self.site.shooting.shifted(&mut tracer, &field, part).ok()?;
            let site = ContinuationPoint {
                shooting: shifted,
                at: self.site.at,
            };
            let (again, _) = Self::beside(&site, curve, held)?;
            spread = spread.max((again.coefficient.value - self.coefficient.value).abs());
        }
        let uncertainty = self.coefficient.uncertainty.max(SPREAD * spread);
        let off = (self.coefficient.value.abs() + uncertainty) / slope.abs();
        let uncertain = |of: &dyn Fn(&Self) -> f64, unit: f64| {
            let (here, there) = (of(self), of(&other));
            let by_slope = off * (there - here).abs() / BESIDE;
            Uncertain::new(here, by_slope + ROUNDING * here.abs().max(unit.abs()))
        };
        let label = match curve.test_function {
            TestFunction::Torus => Label::Ch,
            TestFunction::Doubling => Label::Gpd,
            _ => Label::Cp,
        };
        let scale = curve.family.scale(self.site.at);
        let parameter = |i: usize| uncertain(&|d| curve.family.parameters(d.site.at)[i], scale[i]);
        Some(CoefficientZero {
            label,
            at: [parameter(0), parameter(1)],
            period: uncertain(&|d| d.site.shooting.period(), 0.0),
            note: (label == Label::Cp).then(|| DEGENERATE.into()),
            orbit,
        })
    }
}

/// The label where the criticality of a pitchfork changes.
const DEGENERATE: &str = "degenerate pitchfork: a curve of folds of asymmetric orbits ends here";

/// The cubic coefficient at an orbit of a curve; `None` for folds.
fn way(chart: Chart<'_>, test_function: TestFunction, site: &ContinuationPoint) -> Option<Way> {
    let form = match test_function {
        TestFunction::Torus => Form::Torus,
        TestFunction::Doubling => Form::Doubling,
        TestFunction::Transverse => Form::Pitchfork,
        _ => return None,
    };
    chart.normal_form(site, form)
}

/// Does something with a curve in these variables, whose zeros are looked for in one of the coordinates.
fn with_curve<R>(
    chart: Chart<'_>,
    test_function: TestFunction,
    held: usize,
    then: impl FnOnce(CoefficientCurve<'_>) -> R,
) -> R {
    let unknown = (Uncertain::new(0.0, f64::INFINITY), Criticality::Undecided);
    then(CoefficientCurve {
        family: chart.family(),
        test_function,
        coefficient: &|site| way(chart, test_function, site).unwrap_or(unknown),
        held,
    })
}

impl CurvesOfKind<'_, '_> {
    /// The degenerate pitchfork near a symmetric orbit that a curve of folds of asymmetric orbits has come to.
    pub fn degenerate_pitchfork(
        &self,
        chart: Chart<'_>,
        near: &ContinuationPoint,
    ) -> Option<CoefficientZero> {
        /// How far to both sides it is looked for, in the second coordinate.
        const FAR: f64 = 0.01;
        with_curve(chart, TestFunction::Transverse, 1, |curve| {
            let [below, above] =
                [-FAR, FAR].map(|off| Decided::beside(near, curve, near.at[1] + off));
            let ((below, _), (above, _)) = (below?, above?);
            below.change(&above, curve)
        })
    }
}

impl HalfCurve<'_, '_, '_> {
    /// Which way the bifurcation goes at an orbit of the curve; folds have none.
    pub fn way(&self, site: &ContinuationPoint) -> Option<Way> {
        way(self.chart, self.kind.test_function?, site)
    }

    /// The criticality at every point, where that is asked for.
    pub fn wanted_way(&self, site: &ContinuationPoint) -> Option<Way> {
        match self.kind.curve.criticality {
            Classified::Every => self.way(site),
            _ => None,
        }
    }

    /// Which way the bifurcation goes at the next orbit, where that is asked for. Tells of where the coefficient is zero between the last orbit at which
    /// that was decided and this one.
    pub fn changes(&mut self, here: &Regular) -> ControlFlow<(), Option<Way>> {
        let way = self.wanted_way(&here.site);
        let now = way.and_then(|(coefficient, way)| Decided::new(here, coefficient, way));
        if let Some(test_function) = self.kind.test_function
            && let Some(now) = now
            && let Some(before) = self.decided.replace(now.clone())
        {
            let moved = |i: usize| (now.site.at[i] - before.site.at[i]).abs();
            let held = usize::from(moved(1) >= moved(0));
            let zero = with_curve(self.chart, test_function, held, |curve| {
                before.change(&now, curve)
            });
            if let Some(zero) = zero {
                let point = self.zero_of_coefficient(self.chart, zero);
                self.special(point)?;
            }
        }
        Continue(way)
    }

    /// Where the coefficient is zero, as a point of the curve.
    pub fn zero_of_coefficient(&self, chart: Chart<'_>, zero: CoefficientZero) -> GeneralPoint {
        let point = GeneralPoint {
            parameters: zero.at,
            period: Some(zero.period),
            note: zero.note,
            symmetry: self.chart.symmetry(),
            ..orbit_point(chart, self.number, &zero.orbit, Some(zero.label))
        };
        self.angled(point, &zero.orbit)
    }
}
