//! Curves of bifurcations that begin at a point of codimension two: which leave it, and their first points.
//!
//! Curves of equilibria go through it. Those of orbits begin with a small orbit: an ellipse of the linearised system about the equilibrium, or an orbit that is displaced in
//! the direction of its critical multiplier. Its size is held and both parameters are unknown; in the normal form they enter linearly (Kuznetsov 2004, chapters 8 and 9).
//! Homoclinic orbits of a double zero begin with the predictor of its normal form.

use super::Label;
use super::equilibria::generic_curve::EquilibriumBifurcation;
use super::general::curves::{curves_through, special_near};
use super::general::{
    GeneralBifurcation, GeneralCurve, GeneralObserver, GeneralPoint, GeneralSolution,
};
use super::homoclinic::homoclinic_curve_of;
use super::orbits::{orbit_curves_beside, orbit_curves_leaving};
use crate::error::{Error, Result};
use crate::field::{Matrix, Vector};
use crate::number::{Uncertain, eigenvalues};
use crate::orbit::TestFunction;
use nalgebra::Complex;
use std::f64::consts::TAU;

use EquilibriumBifurcation::{Fold, Hopf, Pitchfork};
use GeneralBifurcation::{Equilibrium, Homoclinic, Orbit};

/// The curves that leave a point of codimension two of equilibria.
const OF_EQUILIBRIA: &[(Label, &[GeneralBifurcation])] = &[
    (Label::Cp, &[Equilibrium(Fold), Equilibrium(Pitchfork)]),
    (
        Label::Bt,
        &[Equilibrium(Fold), Equilibrium(Hopf), Homoclinic],
    ),
    (Label::Gh, &[Equilibrium(Hopf), Orbit(TestFunction::Fold)]),
    (Label::Hh, &[Equilibrium(Hopf), Orbit(TestFunction::Torus)]),
    (
        Label::Zh,
        &[
            Equilibrium(Fold),
            Equilibrium(Hopf),
            Orbit(TestFunction::Torus),
        ],
    ),
];

/// The same of orbits.
const OF_ORBITS: &[(Label, &[GeneralBifurcation])] = &[
    (
        Label::R1,
        &[Orbit(TestFunction::Fold), Orbit(TestFunction::Torus)],
    ),
    (
        Label::R2,
        &[Orbit(TestFunction::Doubling), Orbit(TestFunction::Torus)],
    ),
    (Label::R3, &[Orbit(TestFunction::Torus)]),
    (Label::R4, &[Orbit(TestFunction::Torus)]),
    (Label::Ch, &[Orbit(TestFunction::Torus)]),
    (Label::Cp, &[Orbit(TestFunction::Fold)]),
    (
        Label::Ff,
        &[Orbit(TestFunction::Fold), Orbit(TestFunction::Doubling)],
    ),
    (
        Label::Fn,
        &[Orbit(TestFunction::Fold), Orbit(TestFunction::Torus)],
    ),
    (
        Label::Pn,
        &[Orbit(TestFunction::Doubling), Orbit(TestFunction::Torus)],
    ),
    (
        Label::Gpd,
        &[Orbit(TestFunction::Doubling), Orbit(TestFunction::Fold)],
    ),
];

/// The curves that leave a point of codimension two, of equilibria or of orbits.
pub fn curves_that_leave(label: Label, of_orbits: bool) -> &'static [GeneralBifurcation] {
    let all = if of_orbits { OF_ORBITS } else { OF_EQUILIBRIA };
    let found = all.iter().find(|(one, _)| *one == label);
    found.map_or(&[], |(_, curves)| *curves)
}

/// Follows the curves of a kind that leave a point of codimension two. It is located anew: what is known of it needs but a few digits.
///
/// # Errors
/// [`Error::NoOrbit`] where there is no such point, or no such curve leaves it; those of the curves.
pub(super) fn begun(
    curve: &GeneralCurve<'_>,
    begin: &GeneralPoint,
    seen: GeneralObserver<'_>,
) -> Result<()> {
    let of_orbits = matches!(begin.solution, GeneralSolution::Orbit { .. });
    let label = begin.label.ok_or_else(|| not_there(begin))?;
    if !curves_that_leave(label, of_orbits).contains(&curve.kind) {
        return Err(not_there(begin));
    }
    let followed = match (&begin.solution, curve.kind) {
        (GeneralSolution::Equilibrium { state, .. }, Equilibrium(kind)) => {
            special_near(curve, kind, (state, begin.at), label)?.ok_or_else(|| not_there(begin))?;
            let begins = match label {
                Label::Hh => beside_each_pair(curve, state, begin.at),
                _ => vec![(state.clone(), begin.at)],
            };
            curves_through(curve, kind, &begins, seen)?
        }
        (GeneralSolution::Equilibrium { state, .. }, Homoclinic) => {
            let there = special_near(curve, Fold, (state, begin.at), label)?;
            homoclinic_curve_of(curve, &there.ok_or_else(|| not_there(begin))?, seen)?
        }
        (GeneralSolution::Equilibrium { state, .. }, Orbit(test_function)) => {
            let there = special_near(curve, Hopf, (state, begin.at), label)?;
            let there = there.ok_or_else(|| not_there(begin))?;
            orbit_curves_leaving(curve, test_function, &shrunk(curve, &there), seen)?
        }
        (GeneralSolution::Orbit { .. }, Orbit(test_function)) => {
            orbit_curves_beside(curve, test_function, begin, seen)?
        }
        _ => false,
    };
    match followed {
        true => Ok(()),
        false => Err(Error::NoOrbit {
            what: format!(
                "no such curve is found to leave the point of {}",
                label.meaning()
            ),
            period: None,
            hint: "it may not exist there: whether it does depends on the coefficients of the normal form",
        }),
    }
}

fn not_there(begin: &GeneralPoint) -> Error {
    let name = begin.label.map_or("special point", Label::meaning);
    Error::NoOrbit {
        what: format!("there is no {name} at this place"),
        period: None,
        hint: "give the options of the model with which the point was found",
    }
}

/// Points beside a double Hopf point, one near each of the curves that cross there: along each of them the real part of one of the pairs stays zero.
fn beside_each_pair(
    curve: &GeneralCurve<'_>,
    state: &Vector,
    at: [f64; 2],
) -> Vec<(Vector, [f64; 2])> {
    /// Of both ranges: of the differences, and how far away the points are.
    const APART: f64 = 1e-4;
    const BESIDE: f64 = 2e-3;
    /// Newton's iterations from one equilibrium to the next.
    const ITERATIONS: usize = 8;
    let family = curve.system.family;
    let widths = curve.ranges.map(|(from, to)| (to - from).abs());
    let equilibrium = |at: [f64; 2]| {
        let field = family.field(at);
        let mut x = state.clone();
        for _ in 0..ITERATIONS {
            x -= field.newton_step(x.as_slice())?;
        }
        Some(x)
    };
    let growths = |at: [f64; 2], frequency: f64| {
        let all = eigenvalues(&family.field(at).jacobian(&equilibrium(at)?))?;
        let off = |z: &&Complex<f64>| (z.im - frequency).abs();
        let pair = all.iter().min_by(|a, b| off(a).total_cmp(&off(b)));
        pair.map(|z| z.re)
    };
    let beside = |frequency: f64| {
        let slope = |i: usize| {
            let moved = |sense: f64| {
                let mut there = at;
                there[i] += sense * APART * widths[i];
                growths(there, frequency)
            };
            Some(moved(1.0)? - moved(-1.0)?)
        };
        let slopes = [slope(0)?, slope(1)?];
        let part = BESIDE / slopes[0].hypot(slopes[1]);
        let there = [
            at[0] - part * slopes[1] * widths[0],
            at[1] + part * slopes[0] * widths[1],
        ];
        Some((equilibrium(there)?, there))
    };
    let jacobian = family.field(at).jacobian(state);
    frequencies(&jacobian)
        .into_iter()
        .filter_map(beside)
        .collect()
}

/// omega of the pairs of eigenvalues on the imaginary axis.
fn frequencies(jacobian: &Matrix) -> Vec<f64> {
    /// Real parts that are zero, as a part of the frequency.
    const AXIS: f64 = 1e-4;
    let all = eigenvalues(jacobian).unwrap_or_default().into_iter();
    let pairs = all.filter(|z| z.im > 0.0 && z.re.abs() < AXIS * z.im);
    let mut frequencies: Vec<f64> = pairs.map(|z| z.im).collect();
    frequencies.sort_by(f64::total_cmp);
    frequencies
}

/// A Hopf point as the orbits that have shrunk to it, one of each pair on the imaginary axis.
fn shrunk(curve: &GeneralCurve<'_>, point: &GeneralPoint) -> Vec<GeneralPoint> {
    /// Frequencies that are the same, relatively.
    const SAME: f64 = 1e-4;
    let GeneralSolution::Equilibrium { state, .. } = &point.solution else {
        return Vec::new();
    };
    let jacobian = curve.system.family.field(point.at).jacobian(state);
    let periods = frequencies(&jacobian).into_iter().map(|omega| TAU / omega);
    let of_point = point.period;
    let uncertain = |period: f64| match of_point {
        Some(one) if (one.value / period - 1.0).abs() < SAME => one,
        _ => Uncertain::new(period, f64::INFINITY),
    };
    let shrunk = |period: f64| point.shrunk(state, uncertain(period));
    periods.map(shrunk).collect()
}

impl GeneralPoint {
    /// A Hopf point as an orbit that has shrunk to it.
    pub(super) fn shrunk(&self, state: &Vector, period: Uncertain) -> Self {
        GeneralPoint {
            solution: GeneralSolution::Orbit {
                shooting: crate::orbit::ShootingNodes {
                    nodes: vec![state.clone()],
                    durations: vec![period.value],
                },
                log_multipliers: vec![0.0; state.len() - 1],
                neutral: 0.0,
            },
            period: Some(period),
            ..self.clone()
        }
    }
}
