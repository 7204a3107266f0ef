//! Curves of folds, of Hopf points and of pitchforks in the plane of two parameters.

use super::equilibria::{EquilibriumBranches, criticality};
use super::{
    GeneralBifurcation, GeneralBranch, GeneralCurve, GeneralObserver, GeneralPoint,
    GeneralSolution, GeneralSystem, SAME, Teller,
};
use crate::bifurcation::Label;
use crate::bifurcation::begin::begun;
use crate::bifurcation::equilibria::generic_curve::{
    EquilibriumBifurcation, EquilibriumCurve, EquilibriumCurvePoint, FirstCoordinate,
};
use crate::bifurcation::equilibria::normal_form::{Unfolding, unfolding};
use crate::bifurcation::homoclinic::homoclinic_curves;
use crate::continuation::{Settings, Stop};
use crate::error::Result;
use crate::field::{Matrix, Vector};
use crate::integrate::AnyField;
use crate::number::Uncertain;
use crate::orbit::{ParametrisedField, Solution};
use std::f64::consts::TAU;
use std::ops::ControlFlow::{self, Break, Continue};

/// Where in the range of a coordinate the bifurcations along the other one are looked for. These are no round parts: at the middle
/// of a symmetric range there is often something that is special.
const SCAN: [f64; 5] = [0.4967, 0.2203, 0.7811, 0.0607, 0.9409];
/// The longest step, as a part of both ranges and of 1 + |state|.
const LONGEST: f64 = 0.03;

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
    let mut curves = EquilibriumCurves::new(curve, kind);
    // A curve along which the second is the same is not met along the first.
    for along in [0, 1] {
        for held in scanned(curve, 1 - along) {
            for (state, at) in curves.seeds(along, held)? {
                if curves.is_known(&state, at) {
                    continue;
                }
                if curves.follow(&state, at, &mut teller)?.is_break() {
                    return teller.end();
                }
            }
        }
    }
    teller.end()
}

/// The curves through these points, each once; whether there is one.
///
/// # Errors
/// As of [`equilibrium_curves`].
pub(in crate::bifurcation) fn curves_through(
    curve: &GeneralCurve<'_>,
    kind: EquilibriumBifurcation,
    points: &[(Vector, [f64; 2])],
    seen: GeneralObserver<'_>,
) -> Result<bool> {
    let mut teller = Teller::new(seen, &curve.following);
    let mut curves = EquilibriumCurves::new(curve, kind);
    for (state, at) in points {
        if !curves.is_known(state, *at) && curves.follow(state, *at, &mut teller)?.is_break() {
            break;
        }
    }
    teller.end().map(|()| curves.count > 0)
}

/// The special point of this label on a curve of bifurcations, near a place on it.
///
/// # Errors
/// As of [`equilibrium_curves`].
pub(in crate::bifurcation) fn special_near(
    curve: &GeneralCurve<'_>,
    kind: EquilibriumBifurcation,
    place: (&Vector, [f64; 2]),
    label: Label,
) -> Result<Option<GeneralPoint>> {
    /// How far away the point may be, as a part of both ranges.
    const BESIDE: f64 = 1e-3;
    /// Where it is looked for from, as a part of that.
    const PART: f64 = 0.3;
    let (state, at) = place;
    let ranges = [0, 1].map(|i| {
        let beside = BESIDE * (curve.ranges[i].1 - curve.ranges[i].0).abs();
        (at[i] - beside, at[i] + beside)
    });
    let near = GeneralCurve {
        ranges,
        beyond: ranges,
        at: [Vec::new(), Vec::new()],
        watch: Vec::new(),
        begin: None,
        following: super::GeneralFollowing {
            skip: Vec::new(),
            ..curve.following.clone()
        },
        ..curve.clone()
    };
    let family = curve.system.family;
    let along = EquilibriumCurve { family, kind };
    // A zero at which a curve begins may be none but for rounding: then it is met from beside it.
    let beside = |held: usize| {
        let mut there = at;
        there[held] += PART * (ranges[held].1 - at[held]);
        let sharp = along.sharp(state, there, held)?;
        Some((sharp.state, sharp.at))
    };
    let begins = [Some((state.clone(), at)), beside(0), beside(1)];
    let mut found = None;
    for begin in begins.into_iter().flatten() {
        curves_through(&near, kind, &[begin], &mut |event| {
            if let super::GeneralEvent::Special(point) = event
                && point.label == Some(label)
            {
                found = Some(point);
            }
            Continue(())
        })?;
        if found.is_some() {
            break;
        }
    }
    Ok(found)
}

/// The values of a coordinate at which bifurcations along the other one are looked for.
pub(in crate::bifurcation) fn scanned(curve: &GeneralCurve<'_>, coordinate: usize) -> Vec<f64> {
    let (from, to) = curve.ranges[coordinate];
    SCAN.map(|part| from + (to - from) * part).to_vec()
}

/// Looks along one of both coordinates at a value of the other one; the coordinates of what is met come in the order of the branch.
pub(in crate::bifurcation) fn looked_along<R>(
    curve: &GeneralCurve<'_>,
    along: usize,
    held: f64,
    look: impl FnOnce(&GeneralBranch<'_>) -> R,
) -> R {
    let system = curve.system;
    let family = Exchanged(system.family);
    let alike = system.alike.map(Exchanged);
    let difference = system.difference.map(Exchanged);
    let equilibria = |at: [f64; 2]| (system.equilibria)([at[1], at[0]]);
    let system = match along {
        0 => system,
        _ => GeneralSystem {
            family: &family,
            alike: alike.as_ref().map(|alike| alike as _),
            difference: difference.as_ref().map(|difference| difference as _),
            names: [system.names[1], system.names[0]],
            equilibria: &equilibria,
            ..system
        },
    };
    look(&GeneralBranch {
        system,
        range: curve.ranges[along],
        beyond: curve.beyond[along],
        held,
        at: Vec::new(),
        watch: Vec::new(),
        orbit: None,
        found: None,
        hopfs: None,
        symmetry: None,
        doublings: 0,
        within: None,
        following: super::GeneralFollowing {
            skip: Vec::new(),
            ..curve.following.clone()
        },
    })
}

/// The coordinates in the order of the curve of those of a branch along one of them.
pub(in crate::bifurcation) fn in_order<T: Copy>(along: usize, at: [T; 2]) -> [T; 2] {
    match along {
        0 => at,
        _ => [at[1], at[0]],
    }
}

/// A family with its coordinates exchanged.
pub(in crate::bifurcation) struct Exchanged<'a>(pub &'a dyn ParametrisedField);

impl ParametrisedField for Exchanged<'_> {
    fn dimension(&self) -> usize {
        self.0.dimension()
    }

    fn plane(&self) -> [usize; 2] {
        in_order(1, self.0.plane())
    }

    fn field(&self, at: [f64; 2]) -> AnyField<'_> {
        self.0.field(in_order(1, at))
    }

    fn parameters(&self, at: [f64; 2]) -> [f64; 2] {
        in_order(1, self.0.parameters(in_order(1, at)))
    }

    fn scale(&self, at: [f64; 2]) -> [f64; 2] {
        in_order(1, self.0.scale(in_order(1, at)))
    }

    fn normal(&self, x: &Vector, flow: Vector) -> Vector {
        self.0.normal(x, flow)
    }

    fn is_any_system(&self) -> bool {
        self.0.is_any_system()
    }

    fn across(&self, x: &Vector, flow: &Vector) -> Matrix {
        self.0.across(x, flow)
    }

    fn units(&self) -> Option<&[f64]> {
        self.0.units()
    }

    fn user_function(&self, which: usize, of: Solution<'_>, at: [f64; 2]) -> f64 {
        self.0.user_function(which, of, in_order(1, at))
    }
}

/// A point of a curve: (state, both coordinates), the same for its mirror images.
fn pass(system: &GeneralSystem<'_>, state: &Vector, at: [f64; 2]) -> Vector {
    system.representative(state).push(at[0]).push(at[1])
}

/// What a special point is known by.
struct Landmark {
    label: Option<Label>,
    place: Vector,
}

impl Landmark {
    fn of(point: &GeneralPoint) -> Self {
        let state = match &point.solution {
            GeneralSolution::Equilibrium { state, .. } => state.clone(),
            _ => Vector::zeros(0),
        };
        Landmark {
            label: point.label,
            place: state.push(point.at[0]).push(point.at[1]),
        }
    }

    fn is(&self, other: &Self) -> bool {
        let mut pairs = self.place.iter().zip(&other.place);
        self.label == other.label && pairs.all(|(a, b)| (a - b).abs() < SAME * (1.0 + a.abs()))
    }
}

struct EquilibriumCurves<'c, 'a> {
    curve: &'c GeneralCurve<'a>,
    kind: EquilibriumBifurcation,
    count: usize,
    /// Where curves pass the values at which bifurcations are looked for: (state, both coordinates).
    passes: Vec<Vector>,
}

impl<'c, 'a> EquilibriumCurves<'c, 'a> {
    fn new(curve: &'c GeneralCurve<'a>, kind: EquilibriumBifurcation) -> Self {
        EquilibriumCurves {
            curve,
            kind,
            count: 0,
            passes: Vec::new(),
        }
    }

    /// The bifurcations along one of the coordinates at a value of the other one.
    fn seeds(&self, along: usize, held: f64) -> Result<Vec<(Vector, [f64; 2])>> {
        let wanted = match self.kind {
            EquilibriumBifurcation::Fold => Label::Lp,
            EquilibriumBifurcation::Hopf => Label::Hb,
            EquilibriumBifurcation::Pitchfork => Label::Bp,
        };
        let mut found = Vec::new();
        looked_along(self.curve, along, held, |branch| {
            EquilibriumBranches::new(branch).all(&mut |point, _| {
                if let GeneralSolution::Equilibrium { state, .. } = point.solution
                    && point.label == Some(wanted)
                {
                    found.push((state, in_order(along, point.at)));
                }
                Continue(())
            })
        })?;
        Ok(found)
    }

    fn pass(&self, state: &Vector, at: [f64; 2]) -> Vector {
        pass(&self.curve.system, state, at)
    }

    fn is_known(&self, state: &Vector, at: [f64; 2]) -> bool {
        let here = self.pass(state, at);
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
        self.passes.push(self.pass(state, at));
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
        let scan = [0, 1].map(|i| scanned(self.curve, i));
        let values = |i: usize| {
            let others = scan[i].iter().filter(|value| !wanted[i].contains(value));
            wanted[i].iter().chain(others).copied().collect()
        };
        // Landings on what is held are exact, those on the first coordinate to some digits.
        let among = |values: &[f64], x: f64| {
            let near = |value: &f64| (value - x).abs() < SAME * (1.0 + x.abs());
            values.iter().any(near)
        };
        let settings = Settings {
            wanted: values(1),
            max_points: self.curve.following.max_points + 1,
            ..Settings::new(ranges[1], longest)?
        };
        let first = FirstCoordinate {
            range: ranges[0],
            wanted: values(0),
            functions: self.curve.watch.len(),
        };
        let (mut begun, mut begin, mut last) = (false, None, None);
        let passes = &mut self.passes;
        let followed =
            curve.follow_within((state, at), growing, &settings, &first, &mut |found| {
                let begins = !std::mem::replace(&mut begun, true);
                // Neutral saddles, where the curve begins at a double zero.
                let saddle = self.kind == EquilibriumBifurcation::Hopf && found.frequency.is_none();
                if saddle && found.label.is_none_or(|label| label == Label::Ep) {
                    return if begins { Continue(()) } else { Break(()) };
                }
                let on = |values: &[Vec<f64>; 2]| (0..2).any(|i| among(&values[i], found.at[i]));
                if found.label == Some(Label::Uz) && on(&scan) {
                    passes.push(pass(system, &found.state, found.at));
                    if !on(wanted) {
                        return Continue(());
                    }
                }
                // No curve ends where it is begun.
                let label = found.label.filter(|label| !begins || *label != Label::Ep);
                let mut point = self::point(system.family, number, found, label);
                if let Some(which) = found.zero_of {
                    point = point.at_zero_of(&self.curve.watch, which);
                }
                // A special point that the curve begins at may be met once more, where what is zero there is not quite.
                let landmark = label.is_some().then(|| Landmark::of(&point));
                if begins {
                    begin = landmark;
                } else if landmark.is_some_and(|one| begin.as_ref().is_some_and(|b| b.is(&one))) {
                    return Continue(());
                }
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
    family: &dyn ParametrisedField,
    number: usize,
    found: &EquilibriumCurvePoint,
    label: Option<Label>,
) -> GeneralPoint {
    let solution = GeneralSolution::Equilibrium {
        state: found.state.clone(),
        eigenvalues: Vec::new(),
    };
    // At these points it is zero, has a pole, or is that of one pair of two.
    let of_pair = found
        .coefficient
        .filter(|_| !matches!(label, Some(Label::Gh | Label::Zh | Label::Hh)));
    let Unfolding { criticality, case } = label.map_or_else(Unfolding::default, |label| {
        unfolding(label, &found.normal_form)
    });
    let alone = match &found.normal_form[..] {
        [alone] => Some(alone.value),
        _ => None,
    };
    let by_pair = of_pair.map(|l_1| self::criticality(l_1, &[]));
    let point = GeneralPoint {
        label,
        period: found
            .frequency
            .map(|omega| Uncertain::new(TAU / omega, f64::INFINITY)),
        coefficient: alone.map(|alone| alone.value).or(of_pair),
        coefficient_uncertainty: alone.map(|alone| alone.uncertainty),
        criticality: criticality.or(by_pair),
        normal_form: found.normal_form.clone(),
        note: case,
        ..GeneralPoint::new(number, found.at, solution)
    };
    point.placed(family, found.uncertainty.unwrap_or([f64::INFINITY; 2]))
}

impl GeneralCurve<'_> {
    /// Follows all curves and hands on what is found.
    ///
    /// # Errors
    /// As of [`equilibrium_curves`] and [`super::orbit_curves()`]; [`crate::Error::NoOrbit`] where none leaves the point at which they are to begin.
    pub fn follow(&self, seen: GeneralObserver<'_>) -> Result<()> {
        if let Some(begin) = &self.begin {
            return begun(self, begin, seen);
        }
        match self.kind {
            GeneralBifurcation::Equilibrium(kind) => equilibrium_curves(self, kind, seen),
            GeneralBifurcation::Orbit(test_function) => {
                super::orbit_curves(self, Some(test_function), seen)
            }
            GeneralBifurcation::Held => super::orbit_curves(self, None, seen),
            GeneralBifurcation::Homoclinic => homoclinic_curves(self, seen),
        }
    }
}
