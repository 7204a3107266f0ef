//! The observer of a branch of equilibria: makes rows of its points, and names what is special on it.

use super::crossing::QuadraticRoot;
use super::curves::CurveVariables;
use super::hopf::HopfPoints;
use super::hopf_special::hopf_point;
use super::pieces::PieceEnd;
use super::special::Teller;
use super::stationary::{fold, fold_test, pitchforks};
use crate::bifurcation::{BranchRequest, BranchRow, Label, Special};
use crate::continuation::{Branch, CurveObserver, CurvePoint, PointKind, Stop};
use crate::equilibrium::{Equilibrium, stability};
use crate::error::{Error, Result};
use crate::friction::{steady_slope, steady_stress};
use crate::number::Uncertain;
use std::ops::ControlFlow;

/// The largest change of the stress in a step.
const LARGEST: f64 = 0.2;

/// What looks on along one branch: names what is special, and hands on.
pub(super) struct BranchObserver<'a, 'b> {
    pub request: &'a BranchRequest,
    pub curve: CurveVariables,
    /// The slip rates along K, where they don't change.
    pub rates: Option<[f64; 2]>,
    pub begin: &'a PieceEnd,
    pub number: usize,
    pub teller: &'a mut Teller<'b>,
    pub failure: Option<Error>,
}

/// Where on the branch.
#[derive(Debug, Clone, Copy)]
struct BranchPosition {
    driving: f64,
    stiffness: f64,
    rates: [f64; 2],
}

impl BranchObserver<'_, '_> {
    fn place(&self, point: &CurvePoint, value: f64) -> BranchPosition {
        let loading = self.request.slab.loading;
        match self.rates {
            Some(rates) => BranchPosition {
                driving: loading.driving,
                stiffness: value,
                rates,
            },
            None => BranchPosition {
                driving: value,
                stiffness: loading.stiffness,
                rates: self.curve.rates(point, value),
            },
        }
    }

    /// The varied parameter: as it was asked for where it was.
    fn value(&self, point: &CurvePoint, mark: PointKind) -> f64 {
        let (a, b) = self.request.range;
        match mark {
            PointKind::Begin => self.begin.value,
            PointKind::Lowest => a.min(b),
            PointKind::Highest => a.max(b),
            PointKind::Wanted(_) => {
                let near = |x: &&f64| (x.ln() - point.lambda).abs() < 1e-12;
                *self
                    .request
                    .at
                    .iter()
                    .find(near)
                    .unwrap_or(&point.lambda.exp())
            }
            PointKind::Step | PointKind::Zero(_) => point.lambda.exp(),
        }
    }

    /// What the zeros of the test functions mean.
    fn labels(&self) -> &'static [Label] {
        match (self.rates, self.curve) {
            (_, CurveVariables::Symmetric { interfaces: 1 }) => &[Label::Hb],
            (Some(_), CurveVariables::Symmetric { .. }) => &[Label::Hb],
            (None, CurveVariables::Symmetric { .. }) => &[Label::Hb, Label::Bp],
            // one for each root of (42)
            (Some(_), CurveVariables::Asymmetric) => &[Label::Hb, Label::Hb],
            (None, CurveVariables::Asymmetric) => &[Label::Hb, Label::Hb, Label::Bp, Label::Lp],
        }
    }

    /// How far K of a Hopf point is above the actual one, relative.
    fn oscillation(&self, point: &CurvePoint, place: &BranchPosition, root: QuadraticRoot) -> f64 {
        let points = HopfPoints {
            law: &self.request.slab.law,
            curve: self.curve,
            root,
        };
        match self.rates {
            Some(rates) => points.closed_form(rates) / place.stiffness - 1.0,
            None => points.along(point, place.rates) / place.stiffness - 1.0,
        }
    }

    fn row(&self, place: &BranchPosition, label: Option<Label>) -> Result<BranchRow> {
        let slab = &self.request.slab;
        let distinct = place.rates[0] < place.rates[1];
        let state = match self.curve {
            CurveVariables::Asymmetric if distinct => {
                let [slow, _] = self.curve.rates_at(&slab.law, place.driving, place.rates);
                Equilibrium::asymmetric(&slab.law, place.driving, slow)
            }
            _ => Equilibrium::symmetric(&slab.law, place.driving, slab.interfaces),
        };
        let stress = state.stress.value;
        let pair = |all: &[f64]| [all[0], *all.last().unwrap_or(&all[0])];
        Ok(BranchRow {
            branch: self.number,
            symmetry: self.curve.symmetry(),
            driving: place.driving,
            stiffness: place.stiffness,
            stress,
            stress_range: (stress, stress),
            period: None,
            state: pair(&state.state()),
            slip_rate: pair(&state.slip_rate),
            ln_abs_multiplier: [None; 2],
            verdict: stability(&slab.law, &state, place.stiffness)?.verdict,
            label,
        })
    }

    fn hand_on(&mut self, place: &BranchPosition, special: Special) -> Result<ControlFlow<()>> {
        let row = self.row(place, Some(special.label))?;
        if self.teller.branch(row).is_break() {
            return Ok(ControlFlow::Break(()));
        }
        Ok(self.teller.special(special))
    }

    fn plain(
        &mut self,
        place: &BranchPosition,
        label: Label,
        note: &str,
    ) -> Result<ControlFlow<()>> {
        let mut special = Special::new(label, exact(place.driving), exact(place.stiffness));
        special.note = (!note.is_empty()).then(|| note.to_string());
        self.hand_on(place, special)
    }

    fn special(&mut self, label: Label, place: &BranchPosition) -> Result<ControlFlow<()>> {
        match label {
            Label::Bp => self.pitchfork(place),
            Label::Lp => self.fold(place),
            _ => self.hopf(place),
        }
    }

    fn pitchfork(&mut self, place: &BranchPosition) -> Result<ControlFlow<()>> {
        let all = pitchforks(&self.request.slab.law);
        let far = |v: f64| (v / place.driving).ln().abs();
        let nearest = all
            .iter()
            .min_by(|a, b| far(a.driving.value).total_cmp(&far(b.driving.value)));
        let Some(pitchfork) = nearest else {
            return Ok(ControlFlow::Continue(()));
        };
        let driving = pitchfork.driving.value;
        let at = BranchPosition {
            driving,
            rates: [0.5 * driving; 2],
            ..*place
        };
        // the symmetric branch has told of it already, if it was followed
        if self.curve == CurveVariables::Asymmetric && self.request.symmetry.is_none() {
            let row = self.row(&at, Some(Label::Bp))?;
            return Ok(self.teller.branch(row));
        }
        let special = Special {
            criticality: Some(pitchfork.criticality),
            coefficient: Some(pitchfork.coefficient),
            note: Some(
                "coefficient: -3 tau''/tau''' of (24); asymmetric states at larger V_H if positive"
                    .into(),
            ),
            ..Special::new(Label::Bp, pitchfork.driving, exact(place.stiffness))
        };
        self.hand_on(&at, special)
    }

    fn fold(&mut self, place: &BranchPosition) -> Result<ControlFlow<()>> {
        // a fold is where dV_H/dz certainly changes its sign
        let Some(fold) = fold(&self.request.slab.law, place.rates) else {
            return Ok(ControlFlow::Continue(()));
        };
        let at = BranchPosition {
            driving: fold.driving.value,
            rates: fold.rates,
            ..*place
        };
        let special = Special::new(Label::Lp, fold.driving, exact(at.stiffness));
        self.hand_on(&at, special)
    }

    fn hopf(&mut self, place: &BranchPosition) -> Result<ControlFlow<()>> {
        let BranchPosition {
            driving,
            stiffness,
            rates,
        } = *place;
        let request = self.request;
        let at = [driving, stiffness];
        let found = hopf_point(&request.slab.law, self.curve, request.along, at, rates);
        if let Some((special, rates)) = found {
            let at = BranchPosition {
                driving: special.driving.value,
                stiffness: special.stiffness.value,
                rates,
            };
            return self.hand_on(&at, special);
        }
        // two real eigenvalues of opposite sign: no bifurcation
        Ok(ControlFlow::Continue(()))
    }

    /// Why the branch was followed no further.
    pub fn gave_up(&mut self, branch: &Branch) -> ControlFlow<()> {
        let Some((point, mark)) = branch.points.last() else {
            return ControlFlow::Continue(());
        };
        let place = self.place(point, self.value(point, *mark));
        let mut special = Special::new(Label::Mx, exact(place.driving), exact(place.stiffness));
        special.note = Some(match &branch.stopped {
            Stop::StepTooSmall {
                because: Some(error),
                ..
            } => format!("no step is short enough: {error}"),
            stop => stop.to_string(),
        });
        self.teller.on(self.number, self.curve.symmetry());
        self.teller.special(special)
    }

    fn shown(&mut self, point: &CurvePoint, mark: PointKind) -> Result<ControlFlow<()>> {
        let place = self.place(point, self.value(point, mark));
        match mark {
            PointKind::Step => {
                let row = self.row(&place, None)?;
                Ok(self.teller.branch(row))
            }
            PointKind::Begin if self.begin.pitchfork => self.special(Label::Bp, &place),
            PointKind::Begin => self.plain(&place, Label::Ep, "begin of the range"),
            PointKind::Wanted(_) => self.plain(&place, Label::Uz, ""),
            PointKind::Lowest | PointKind::Highest => {
                self.plain(&place, Label::Ep, "end of the range")
            }
            PointKind::Zero(i) => self.special(self.labels()[i], &place),
        }
    }
}

fn exact(x: f64) -> Uncertain {
    Uncertain::new(x, 0.0)
}

impl CurveObserver for BranchObserver<'_, '_> {
    fn tests(&self, point: &CurvePoint) -> Result<Vec<f64>> {
        let place = self.place(point, point.lambda.exp());
        let law = &self.request.slab.law;
        let labels = self.labels().iter().enumerate();
        let tests = labels.map(|(i, label)| match (label, self.curve) {
            (Label::Hb, _) => self.oscillation(
                point,
                &place,
                [QuadraticRoot::Larger, QuadraticRoot::Smaller][i],
            ),
            (Label::Bp, CurveVariables::Asymmetric) => point.u[0],
            (Label::Bp, _) => steady_slope(law, place.rates[0]) * place.rates[0],
            _ => fold_test(point),
        });
        Ok(tests.collect())
    }

    fn ends(&self, test: usize) -> bool {
        self.curve == CurveVariables::Asymmetric && self.labels()[test] == Label::Bp
    }

    fn too_far(&self, from: &CurvePoint, to: &CurvePoint) -> bool {
        let stress = |point: &CurvePoint| {
            let place = self.place(point, point.lambda.exp());
            steady_stress(&self.request.slab.law, place.rates[0])
        };
        (stress(from) - stress(to)).abs() > LARGEST * self.request.step
    }

    fn seen(&mut self, point: &CurvePoint, mark: PointKind) -> ControlFlow<()> {
        self.shown(point, mark).unwrap_or_else(|error| {
            self.failure = Some(error);
            ControlFlow::Break(())
        })
    }
}
