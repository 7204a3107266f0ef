//! Curves of folds, of Hopf points and of pitchforks in the plane of two parameters.

use super::equilibria::{EquilibriumBranches, criticality};
use super::{
    GeneralBifurcation, GeneralBranch, GeneralCurve, GeneralObserver, GeneralPoint,
    GeneralSolution, Teller,
};
use crate::bifurcation::Label;
use crate::bifurcation::equilibria::generic_curve::{
    EquilibriumBifurcation, EquilibriumCurve, EquilibriumCurvePoint, FirstCoordinate,
};
use crate::continuation::{Settings, Stop};
use crate::error::Result;
use crate::field::Vector;
use crate::number::Uncertain;
use std::f64::consts::TAU;
use std::ops::ControlFlow::{self, Break, Continue};

/// Where in the range of the second coordinate the bifurcations along the first are looked for.
pub(super) const SCAN: [f64; 5] = [0.5, 0.22, 0.78, 0.06, 0.94];
/// The longest step, as a part of both ranges and of 1 + |state|.
const LONGEST: f64 = 0.03;
/// Points nearer to each other than this, in units of 1 + |x|, are one.
const SAME: f64 = 1e-6;

/// Follows all curves of folds or of Hopf points through the ranges and hands on what is found.
///
/// # Errors
/// Those of the equilibria; [`crate::Error::TooManyPoints`]. That a curve ends early is none: it is told as `MX`.
pub fn equilibrium_curves(
    curve: &GeneralCurve<'_>,
    kind: EquilibriumBifurcation,
    seen: GeneralObserver<'_>,
) -> Result<()> {
    let mut teller = Teller::new(seen, &curve.following);
    let mut curves = EquilibriumCurves {
        curve,
        kind,
        count: 0,
        passes: Vec::new(),
    };
    for held in scanned(curve) {
        for (state, at) in curves.seeds(held)? {
            if curves.is_known(&state, at) {
                continue;
            }
            if curves.follow(&state, at, &mut teller)?.is_break() {
                return teller.end();
            }
        }
    }
    teller.end()
}

/// The values of the second coordinate at which bifurcations are looked for.
pub(super) fn scanned(curve: &GeneralCurve<'_>) -> Vec<f64> {
    let (from, to) = curve.ranges[1];
    SCAN.map(|part| from + (to - from) * part).to_vec()
}

/// The branch along the first parameter at this value of the second.
pub(super) fn along_first<'a>(curve: &GeneralCurve<'a>, held: f64) -> GeneralBranch<'a> {
    GeneralBranch {
        system: curve.system,
        range: curve.ranges[0],
        held,
        at: Vec::new(),
        orbit: None,
        doublings: 0,
        following: super::GeneralFollowing {
            skip: Vec::new(),
            ..curve.following.clone()
        },
    }
}

struct EquilibriumCurves<'c, 'a> {
    curve: &'c GeneralCurve<'a>,
    kind: EquilibriumBifurcation,
    count: usize,
    /// Where curves pass the values at which bifurcations are looked for: (state, both coordinates).
    passes: Vec<Vector>,
}

impl EquilibriumCurves<'_, '_> {
    /// The bifurcations along the first parameter at a value of the second.
    fn seeds(&self, held: f64) -> Result<Vec<(Vector, [f64; 2])>> {
        let wanted = match self.kind {
            EquilibriumBifurcation::Fold => Label::Lp,
            EquilibriumBifurcation::Hopf => Label::Hb,
            EquilibriumBifurcation::Pitchfork => Label::Bp,
        };
        let branch = along_first(self.curve, held);
        let mut found = Vec::new();
        EquilibriumBranches::new(&branch).all(&mut |point, _| {
            if let GeneralSolution::Equilibrium { state, .. } = point.solution
                && point.label == Some(wanted)
            {
                found.push((state, point.at));
            }
            Continue(())
        })?;
        Ok(found)
    }

    fn is_known(&self, state: &Vector, at: [f64; 2]) -> bool {
        let here = state.push(at[0]).push(at[1]);
        let near = |pass: &Vector| {
            let mut pairs = pass.iter().zip(&here);
            pairs.all(|(a, b)| (a - b).abs() < SAME * (1.0 + a.abs()))
        };
        self.passes.iter().any(near)
    }

    /// The curve through a point, from its end on.
    fn follow(
        &mut self,
        state: &Vector,
        at: [f64; 2],
        teller: &mut Teller<'_>,
    ) -> Result<ControlFlow<()>> {
        self.passes.push(state.push(at[0]).push(at[1]));
        let number = self.count;
        self.count += 1;
        let mut back = Vec::new();
        let closed = self.half((state, at), number, false, &mut |point, special| {
            back.push((point, special));
            Continue(())
        })?;
        for (point, special) in back.into_iter().rev() {
            if teller.point(point, special).is_break() {
                return Ok(Break(()));
            }
        }
        if !closed {
            let mut first = true;
            self.half((state, at), number, true, &mut |point, special| {
                // Both halves begin with the same point.
                if std::mem::replace(&mut first, false) {
                    return Continue(());
                }
                teller.point(point, special)
            })?;
        }
        Ok(teller.told)
    }

    /// One way from a point of the curve; whether the curve is closed.
    fn half(
        &mut self,
        (state, at): (&Vector, [f64; 2]),
        number: usize,
        growing: bool,
        seen: &mut dyn FnMut(GeneralPoint, bool) -> ControlFlow<()>,
    ) -> Result<bool> {
        let GeneralCurve {
            system,
            ranges,
            at: wanted,
            ..
        } = self.curve;
        let curve = EquilibriumCurve {
            family: system.family,
            kind: self.kind,
        };
        let size = ranges.iter().map(|(a, b)| b - a).sum::<f64>() + 1.0 + state.amax();
        let longest = LONGEST * size * self.curve.following.step;
        let scan = scanned(self.curve);
        let mut values = wanted[1].clone();
        values.extend(scan.iter().filter(|value| !wanted[1].contains(value)));
        let settings = Settings {
            wanted: values,
            max_points: self.curve.following.max_points + 1,
            ..Settings::new(ranges[1], longest)?
        };
        let first = FirstCoordinate {
            range: ranges[0],
            wanted: wanted[0].clone(),
        };
        let (mut begun, mut last) = (false, None);
        let passes = &mut self.passes;
        let followed =
            curve.follow_within((state, at), growing, &settings, &first, &mut |found| {
                let begins = !std::mem::replace(&mut begun, true);
                if found.label == Some(Label::Uz) && scan.contains(&found.at[1]) {
                    let state = &found.state;
                    passes.push(state.push(found.at[0]).push(found.at[1]));
                    if !wanted[1].contains(&found.at[1]) && !wanted[0].contains(&found.at[0]) {
                        return Continue(());
                    }
                }
                let label = found.label.filter(|_| !begins);
                let point = self::point(system.family, number, found, label);
                last = Some(point.clone());
                seen(point, label.is_some())?;
                // Beyond it there are neutral saddles.
                match (self.kind, label) {
                    (EquilibriumBifurcation::Hopf, Some(Label::Bt)) if !begins => Break(()),
                    _ => Continue(()),
                }
            })?;
        match followed.stopped {
            Stop::Observer | Stop::RangeEnd | Stop::Ended(_) => Ok(false),
            Stop::Closed => Ok(true),
            other => {
                if let Some(mut point) = last {
                    point.label = Some(Label::Mx);
                    point.note = Some(other.to_string());
                    let _ = seen(point, true);
                }
                Ok(false)
            }
        }
    }
}

fn point(
    family: &dyn crate::orbit::ParametrisedField,
    number: usize,
    found: &EquilibriumCurvePoint,
    label: Option<Label>,
) -> GeneralPoint {
    let solution = GeneralSolution::Equilibrium {
        state: found.state.clone(),
        eigenvalues: Vec::new(),
    };
    let coefficient = found.coefficient.filter(|_| label != Some(Label::Gh));
    let point = GeneralPoint {
        label,
        period: found
            .frequency
            .map(|omega| Uncertain::new(TAU / omega, f64::INFINITY)),
        coefficient,
        criticality: coefficient.map(criticality),
        ..GeneralPoint::new(number, found.at, solution)
    };
    point.placed(family, found.uncertainty.unwrap_or([f64::INFINITY; 2]))
}

impl GeneralCurve<'_> {
    /// Follows all curves and hands on what is found.
    ///
    /// # Errors
    /// As of [`equilibrium_curves`] and [`super::orbit_curves()`].
    pub fn follow(&self, seen: GeneralObserver<'_>) -> Result<()> {
        match self.kind {
            GeneralBifurcation::Equilibrium(kind) => equilibrium_curves(self, kind, seen),
            GeneralBifurcation::Orbit(test_function) => {
                super::orbit_curves(self, test_function, seen)
            }
        }
    }
}
