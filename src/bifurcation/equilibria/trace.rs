//! What is told of the Hopf points along a curve of equilibria: stretches within the range of K, and what is special on them.

use super::curves::CurveVariables;
use super::hopf::{Hopf, HopfPoints};
use super::pieces::PieceEnd;
use super::special::Teller;
use super::stationary::fold;
use crate::bifurcation::{Label, LocusRequest, LocusRow, Special};
use crate::continuation::{Branch, CurveObserver, CurvePoint, PointKind};
use crate::equilibrium::{Interface, routh_hurwitz};
use crate::error::Result;
use crate::number::Uncertain;
use std::ops::ControlFlow;

/// The largest change of ln K in a step.
const LARGEST: f64 = 0.1;

/// What a test function is zero at.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Meaning {
    /// K is this end of its range.
    Limit(f64),
    /// K is this wanted value.
    Wanted(f64),
    Top,
    Degenerate,
    BogdanovTakens,
    ZeroHopf,
    /// The asymmetric states end at a pitchfork.
    Pitchfork,
}

pub(super) struct Trace<'a, 'b> {
    pub request: &'a LocusRequest,
    pub points: HopfPoints<'a>,
    pub begin: &'a PieceEnd,
    pub teller: &'a mut Teller<'b>,
    /// How many there have been.
    pub curves: &'a mut usize,
    /// Whether Hopf points within the range of K are passed.
    pub inside: bool,
}

/// A place on the curve of equilibria.
#[derive(Debug, Clone, Copy)]
struct CurvePosition {
    driving: f64,
    rates: [f64; 2],
}

impl Trace<'_, '_> {
    fn meanings(&self) -> Vec<Meaning> {
        let (a, b) = self.request.stiffness;
        let (low, high) = (a.min(b), a.max(b));
        let mut all = vec![Meaning::Limit(low), Meaning::Limit(high)];
        let wanted = self.request.at_stiffness.iter();
        all.extend(
            wanted
                .filter(|k| (low..=high).contains(*k))
                .map(|&k| Meaning::Wanted(k)),
        );
        all.extend([Meaning::Top, Meaning::Degenerate]);
        if self.points.curve == CurveVariables::Asymmetric {
            all.extend([
                Meaning::BogdanovTakens,
                Meaning::ZeroHopf,
                Meaning::Pitchfork,
            ]);
        }
        all
    }

    fn place(&self, point: &CurvePoint, driving: f64) -> CurvePosition {
        let near = self.points.curve.rates(point, driving);
        CurvePosition {
            driving,
            rates: self.points.curve.rates_at(self.points.law, driving, near),
        }
    }

    /// K of a Hopf point within the range.
    fn stiffness(&self, place: &CurvePosition) -> Option<f64> {
        let (a, b) = self.request.stiffness;
        let within = |k: &f64| *k >= a.min(b) && *k <= a.max(b);
        self.points.stiffness(place.rates).filter(within)
    }

    fn test(&self, meaning: Meaning, point: &CurvePoint, place: &CurvePosition, k: f64) -> f64 {
        let points = &self.points;
        match meaning {
            Meaning::Limit(value) | Meaning::Wanted(value) => k / value - 1.0,
            Meaning::Pitchfork => point.u[0],
            _ if points.stiffness(place.rates).is_none() && meaning != Meaning::BogdanovTakens => {
                f64::NAN
            }
            Meaning::Top => {
                points.stiffness_slope(place.driving, place.rates) * point.lambda_slope()
            }
            Meaning::Degenerate => {
                let l_1 = points.lyapunov(place.driving, place.rates);
                l_1.sign().map_or(f64::NAN, |_| l_1.value / l_1.scale)
            }
            Meaning::BogdanovTakens if k > 0.0 => points.frequency_squared(place.rates, k) / k,
            Meaning::BogdanovTakens => f64::NAN,
            Meaning::ZeroHopf => {
                let [one, two] = place.rates.map(|v| Interface::at(points.law, v));
                routh_hurwitz(&one, &two, k)[0]
            }
        }
    }

    fn row(&mut self, point: &Hopf, label: Option<Label>) -> ControlFlow<()> {
        let criticality = self
            .request
            .criticality
            .then(|| self.points.criticality(point));
        self.teller.locus(LocusRow {
            share: None,
            curve: self.curves.saturating_sub(1),
            symmetry: self.points.curve.symmetry(),
            driving: point.driving,
            stiffness: point.stiffness,
            period: point.period.map(|period| period.value),
            angle_over_pi: None,
            criticality,
            label,
        })
    }

    fn labelled(&mut self, point: Hopf, label: Label) -> ControlFlow<()> {
        let point = self.points.crosschecked(point);
        self.row(&point, Some(label))?;
        let l_1 = self.points.lyapunov(point.driving.value, point.rates);
        let asked = self.request.criticality && label != Label::Gh;
        self.teller.special(Special {
            period: point.period,
            criticality: asked.then(|| self.points.criticality(&point)),
            coefficient: Some(l_1.value),
            ..Special::new(label, point.driving, point.stiffness)
        })
    }

    /// What is told of next has no row but is of this curve.
    fn here(&mut self) {
        let number = self.curves.saturating_sub(1);
        self.teller.on(number, self.points.curve.symmetry());
    }

    fn enter(&mut self) {
        self.inside = true;
        *self.curves += 1;
    }

    /// At exactly this V_H.
    fn landed(&mut self, place: &CurvePosition, label: Label) -> ControlFlow<()> {
        match self.points.at_driving(place.driving, place.rates) {
            Some(point) if self.inside => self.labelled(point, label),
            _ => ControlFlow::Continue(()),
        }
    }

    /// K passes an end of its range.
    fn limit(&mut self, place: &CurvePosition, k: f64) -> ControlFlow<()> {
        let Some(point) = self.points.at_stiffness(k, place.driving, place.rates) else {
            return ControlFlow::Continue(());
        };
        let leaves = self.inside;
        if !leaves {
            self.enter();
        }
        let shown = self.labelled(point, Label::Ep);
        self.inside = !leaves;
        shown
    }

    fn met(&mut self, meaning: Meaning, place: &CurvePosition) -> ControlFlow<()> {
        let (points, CurvePosition { driving, rates }) = (self.points, *place);
        let found = match meaning {
            Meaning::Limit(k) => return self.limit(place, k),
            Meaning::Wanted(k) => (points.at_stiffness(k, driving, rates), Label::Uz),
            Meaning::Top => (points.top(driving, rates), Label::Top),
            Meaning::Degenerate => (points.degenerate(driving, rates), Label::Gh),
            Meaning::BogdanovTakens => return self.bogdanov_takens(place),
            Meaning::ZeroHopf => (points.at_driving(driving, rates).map(unbounded), Label::Zh),
            Meaning::Pitchfork => (None, Label::Bp),
        };
        match found {
            (Some(point), label) if self.inside => self.labelled(point, label),
            _ => ControlFlow::Continue(()),
        }
    }

    /// omega^2 changes its sign: the curve ends here, or begins.
    fn bogdanov_takens(&mut self, place: &CurvePosition) -> ControlFlow<()> {
        let k = self.points.closed_form(place.rates);
        let (a, b) = self.request.stiffness;
        if !(k >= a.min(b) && k <= a.max(b)) {
            return ControlFlow::Continue(());
        }
        let leaves = self.inside;
        if !leaves {
            self.enter();
        }
        self.inside = !leaves;
        // omega^2 = c_0 / c_2 there: it is the fold's point
        let fold = fold(self.points.law, place.rates);
        let at = fold.and_then(|f| Some((f.driving, f.bogdanov_takens(self.points.law)?)));
        let unknown = |x: f64| Uncertain::new(x, f64::INFINITY);
        let (driving, stiffness) = at.unwrap_or((unknown(place.driving), unknown(k)));
        self.here();
        self.teller.special(Special {
            note: Some("a curve of Hopf points ends here".into()),
            ..Special::new(Label::Bt, driving, stiffness)
        })
    }

    fn step(&mut self, place: &CurvePosition) -> ControlFlow<()> {
        let within = self.stiffness(place).is_some();
        if within && !self.inside {
            self.enter();
        }
        self.inside = within;
        match self.points.at_driving(place.driving, place.rates) {
            Some(point) if within => self.row(&point, None),
            _ => ControlFlow::Continue(()),
        }
    }

    /// Says that the curve of equilibria was followed no further.
    pub fn gave_up(&mut self, branch: &Branch) -> ControlFlow<()> {
        let Some((point, _)) = branch.points.last() else {
            return ControlFlow::Continue(());
        };
        let place = self.place(point, point.lambda.exp());
        let unknown = |x: f64| Uncertain::new(x, f64::INFINITY);
        let k = self.points.closed_form(place.rates);
        self.here();
        self.teller.special(Special {
            note: Some(format!("no further: {}", branch.stopped)),
            ..Special::new(Label::Mx, unknown(place.driving), unknown(k))
        })
    }

    /// V_H as it was asked for where it was.
    fn value(&self, point: &CurvePoint, mark: PointKind) -> f64 {
        let (a, b) = self.request.driving;
        let near = |x: &&f64| (x.ln() - point.lambda).abs() < 1e-12;
        match mark {
            PointKind::Begin => self.begin.value,
            PointKind::Lowest => a.min(b),
            PointKind::Highest => a.max(b),
            PointKind::Wanted(_) => *self
                .request
                .at_driving
                .iter()
                .find(near)
                .unwrap_or(&point.lambda.exp()),
            PointKind::Step | PointKind::Zero(_) => point.lambda.exp(),
        }
    }
}

/// The place is good, but how good is not known.
fn unbounded(mut point: Hopf) -> Hopf {
    point.driving.uncertainty = f64::INFINITY;
    point.stiffness.uncertainty = f64::INFINITY;
    point
}

impl CurveObserver for Trace<'_, '_> {
    fn tests(&self, point: &CurvePoint) -> Result<Vec<f64>> {
        let place = self.place(point, point.lambda.exp());
        let k = self.points.along(point, place.rates);
        let all = self.meanings();
        Ok(all
            .iter()
            .map(|&m| self.test(m, point, &place, k))
            .collect())
    }

    fn ends(&self, test: usize) -> bool {
        self.meanings()[test] == Meaning::Pitchfork
    }

    fn too_far(&self, from: &CurvePoint, to: &CurvePoint) -> bool {
        let [a, b] = [from, to].map(|p| self.stiffness(&self.place(p, p.lambda.exp())));
        matches!((a, b), (Some(a), Some(b)) if (a / b).ln().abs() > LARGEST * self.request.step)
    }

    fn seen(&mut self, point: &CurvePoint, mark: PointKind) -> ControlFlow<()> {
        let place = self.place(point, self.value(point, mark));
        match mark {
            PointKind::Step => self.step(&place),
            PointKind::Begin => {
                if self.stiffness(&place).is_some() {
                    self.enter();
                }
                self.landed(&place, Label::Ep)
            }
            PointKind::Lowest | PointKind::Highest => self.landed(&place, Label::Ep),
            PointKind::Wanted(_) => self.landed(&place, Label::Uz),
            PointKind::Zero(i) => self.met(self.meanings()[i], &place),
        }
    }
}
