//! One or two equal interfaces in V_H and K: their branches of orbits are those of any system, with a symmetry and with Hopf points that are known
//! from closed forms.

use super::branches::orbits;
use super::hopf::HopfBeginning;
use crate::bifurcation::general::{
    Exchanged, GeneralBranch, GeneralEvent, GeneralFollowing, GeneralPoint, GeneralSolution,
    GeneralSystem, in_order,
};
use crate::bifurcation::{
    BranchRequest, BranchRow, Event, EventObserver, Label, Parameter, Special, UserFunction,
    equilibria,
};
use crate::equilibrium::{Equilibrium, Solver, Symmetry, steady_states};
use crate::error::{Error, Result};
use crate::field::{State, Vector};
use crate::number::{Uncertain, eigenvalues};
use crate::orbit::{
    ContinuationPoint, Digits, HopfPoint, InterfaceSystem, OverDifferenceChart, OverLoadings,
    ParametrisedField, Profile, ShootingNodes, Solution, WithFunctions, hopf_points, profile,
};
use std::ops::ControlFlow::Break;

/// How far from the range, in logarithms, a branch may lead that begins beside it.
const BEYOND: f64 = 2.0;

/// Follows the branches that are asked for and hands on what is found: from the Hopf points of symmetric equilibria, of
/// asymmetric ones, from pitchforks of orbits that none of these has come to, and from period doublings.
///
/// # Errors
/// Those of [`BranchRequest::checked`], of the equilibria and of the flow; [`Error::TooManyPoints`];
/// that a branch ends early is none.
pub fn branch(request: &BranchRequest, seen: EventObserver<'_>) -> Result<()> {
    request.checked()?;
    let (slab, along) = (&request.slab, request.along);
    let (from, to) = (request.range.0.ln(), request.range.1.ln());
    let range = (from.min(to), from.max(to));
    let loading = in_order(
        along.place(),
        [slab.loading.driving, slab.loading.stiffness],
    );
    let hopfs = |symmetry| hopf_beginnings(slab, along, symmetry);
    let mut failed = None;
    with_system((slab, &request.watch), along, |system| {
        let branch = GeneralBranch {
            system: *system,
            range,
            beyond: (range.0 - BEYOND, range.1 + BEYOND),
            held: loading[1].ln(),
            at: request.at.iter().map(|x| x.ln()).collect(),
            watch: request.watch.iter().map(|one| one.text.clone()).collect(),
            orbit: None,
            found: None,
            hopfs: Some(&hopfs),
            symmetry: request.symmetry,
            doublings: request.doublings,
            within: None,
            following: GeneralFollowing {
                step: request.step,
                skip: request.skip.clone(),
                max_points: request.max_points,
            },
        };
        orbits(&branch, &mut |event| match request.event(event) {
            Ok(event) => seen(event),
            Err(error) => {
                failed = Some(error);
                Break(())
            }
        })
    })?;
    failed.map_or(Ok(()), Err)
}

/// Does something with a slab over the logarithms of V_H and K, of which the one that varies is the first.
pub(super) fn with_system<R>(
    (slab, watch): (&InterfaceSystem, &[UserFunction]),
    along: Parameter,
    then: impl FnOnce(&GeneralSystem<'_>) -> R,
) -> R {
    let alike = OverLoadings::new(*slab, Symmetry::Symmetric);
    let difference = OverDifferenceChart(OverLoadings::new(*slab, Symmetry::Asymmetric));
    let whole = whole(slab);
    let both = slab.interfaces == 2;
    let interchangeable = match both {
        true => vec![vec![vec![1], vec![2]]],
        false => Vec::new(),
    };
    let place = along.place();
    let known = |at: [f64; 2]| {
        let [log_driving, _] = in_order(place, at);
        let driving = log_driving.exp();
        let states = steady_states(&slab.law, driving, slab.interfaces, Solver::Newton)?;
        Ok(states
            .equilibria
            .iter()
            .map(|one| state(slab, one))
            .collect())
    };
    let functions =
        |which: usize, solution: Solution<'_>, [log_driving, log_stiffness]: [f64; 2]| {
            value_of(
                &watch[which],
                &whole.slab([log_driving, log_stiffness]),
                solution,
            )
        };
    let of_difference = |which: usize, solution: Solution<'_>, at: [f64; 2]| match solution {
        Solution::Orbit(shooting) => {
            let shooting = shooting.clone();
            let site = OverDifferenceChart::from_chart(&ContinuationPoint { shooting, at });
            functions(which, Solution::Orbit(&site.shooting), at)
        }
        Solution::Equilibrium { .. } => f64::NAN,
    };
    let with = |family, functions| WithFunctions { family, functions };
    let (whole, alike) = (with(&whole, &functions), with(&alike, &functions));
    let difference = with(&difference, &of_difference);
    let exchanged = (Exchanged(&whole), Exchanged(&alike), Exchanged(&difference));
    let mut system = GeneralSystem {
        family: &whole,
        alike: Some(&alike),
        difference: both.then_some(&difference),
        interchangeable: &interchangeable,
        names: in_order(place, ["driving", "stiffness"]),
        equilibria: &known,
        bounds: &[],
    };
    if along == Parameter::Stiffness {
        system.family = &exchanged.0;
        system.alike = Some(&exchanged.1);
        system.difference = both.then_some(&exchanged.2);
    }
    then(&system)
}

/// The value of a function of a solution at V_H and K; NaN where the flow along an orbit fails.
fn value_of(function: &UserFunction, here: &InterfaceSystem, solution: Solution<'_>) -> f64 {
    let (profile, period) = match solution {
        Solution::Orbit(shooting) => match profile(here, shooting, Digits::All) {
            Ok(profile) => (profile, Some(shooting.period())),
            Err(_) => return f64::NAN,
        },
        Solution::Equilibrium { state, period } => {
            let y = State::<3>::new(state[0], state[1], state[state.len() - 1]);
            let at_rest = Profile {
                mean_stress: y[0],
                stress_range: (y[0], y[0]),
                state: [y[1].exp(), y[2].exp()],
                slip_rate: here.whole().slip_rates(&y),
            };
            (at_rest, period)
        }
    };
    (function.value)(here.loading, &profile, period)
}

/// All states of a slab: of a single interface those in which all of them move alike.
fn whole(slab: &InterfaceSystem) -> OverLoadings {
    let symmetry = match slab.interfaces {
        1 => Symmetry::Symmetric,
        _ => Symmetry::Asymmetric,
    };
    OverLoadings::new(*slab, symmetry)
}

/// An equilibrium among all states.
fn state(slab: &InterfaceSystem, equilibrium: &Equilibrium) -> Vector {
    let logs = equilibrium.log_state.iter().take(slab.interfaces);
    let all = std::iter::once(equilibrium.stress.value).chain(logs.copied());
    Vector::from_vec(all.collect())
}

/// The Hopf points of equilibria of a symmetry, by their coordinate.
fn hopf_beginnings(
    slab: &InterfaceSystem,
    along: Parameter,
    symmetry: Symmetry,
) -> Result<Vec<HopfBeginning>> {
    let place = along.place();
    let mut hopfs = hopf_points(slab, symmetry, along)?;
    hopfs.sort_by(|a, b| a.at()[place].total_cmp(&b.at()[place]));
    let beginning = |hopf: HopfPoint| {
        let mut small = hopf.small_orbits(&OverLoadings::new(*slab, symmetry));
        let state = state(slab, &hopf.equilibrium);
        let jacobian = whole(slab).field(small.at).jacobian(&state);
        small.at = in_order(place, small.at);
        let unknown = |x: f64| Uncertain::new(x, f64::INFINITY);
        let known = equilibria::hopf(&slab.law, along, &hopf);
        let known = known.unwrap_or_else(|| Special {
            period: Some(unknown(std::f64::consts::TAU / hopf.frequency)),
            ..Special::new(Label::Hb, unknown(hopf.driving), unknown(hopf.stiffness))
        });
        let solution = GeneralSolution::Equilibrium {
            state,
            eigenvalues: eigenvalues(&jacobian).unwrap_or_default(),
        };
        let point = GeneralPoint {
            label: Some(known.label),
            parameters: in_order(place, [known.driving, known.stiffness]),
            period: known.period,
            criticality: known.criticality,
            coefficient: known.coefficient,
            coefficient_uncertainty: known.coefficient_uncertainty,
            note: known.note,
            ..GeneralPoint::new(0, small.at, solution)
        };
        (small, point)
    };
    Ok(hopfs.into_iter().map(beginning).collect())
}

impl BranchRequest {
    /// An event in V_H and K.
    fn event(&self, event: GeneralEvent) -> Result<Event> {
        let point = match event {
            GeneralEvent::Special(point) => {
                let special = special(point.clone(), self.given(&point), self.along);
                return Ok(Event::Special(special.against(self.tolerance)));
            }
            GeneralEvent::Row(point) => point,
        };
        let GeneralSolution::Orbit {
            shooting,
            log_multipliers,
            ..
        } = &point.solution
        else {
            return Err(Error::Input(
                "a branch of orbits has equilibria among its rows".into(),
            ));
        };
        Ok(Event::Branch(self.row(
            &point,
            shooting,
            log_multipliers,
        )?))
    }

    /// V_H and K of a point as they were given, where they were: not the exponentials of their logarithms.
    fn given(&self, point: &GeneralPoint) -> [Option<f64>; 2] {
        let (from, to) = self.range;
        let mut asked = [from, to].into_iter().chain(self.at.iter().copied());
        let free = asked.find(|x| x.ln() == point.at[0]);
        let mut given = [self.slab.loading.driving, self.slab.loading.stiffness].map(Some);
        given[self.along.place()] = free;
        given
    }

    fn row(
        &self,
        point: &GeneralPoint,
        shooting: &ShootingNodes,
        log_multipliers: &[f64],
    ) -> Result<BranchRow> {
        let whole = whole(&self.slab);
        let here = whole.slab(in_order(self.along.place(), point.at));
        let Profile {
            mean_stress,
            stress_range,
            state,
            slip_rate,
        } = profile(&here, shooting, Digits::Six)?;
        let [driving, stiffness] = self.given(point);
        Ok(BranchRow {
            branch: point.number,
            symmetry: point.symmetry.unwrap_or(Symmetry::Symmetric),
            driving: driving.unwrap_or(here.loading.driving),
            stiffness: stiffness.unwrap_or(here.loading.stiffness),
            stress: mean_stress,
            stress_range,
            period: Some(shooting.period()),
            state,
            slip_rate,
            ln_abs_multiplier: [0, 1].map(|i| log_multipliers.get(i).copied()),
            verdict: point.verdict(),
            label: point.label,
            equilibrium: None,
        })
    }
}

/// A special point in V_H and K, of which these are given.
pub(super) fn special(point: GeneralPoint, given: [Option<f64>; 2], along: Parameter) -> Special {
    let given = match point.solution {
        GeneralSolution::Orbit { .. } => given,
        // The closed forms know what is exact.
        GeneralSolution::Equilibrium { .. } => [None; 2],
    };
    let state = match &point.solution {
        GeneralSolution::Orbit { shooting, .. } => shooting.nodes.first(),
        GeneralSolution::Equilibrium { .. } => None,
    };
    let state = state.map(|state| state.as_slice().to_vec());
    let place = along.place();
    let parameters = in_order(place, point.parameters);
    let [driving, stiffness] =
        [0, 1].map(|i| given[i].map_or(parameters[i], |given| Uncertain::new(given, 0.0)));
    Special {
        branch: point.number,
        symmetry: point.symmetry,
        period: point.period,
        criticality: point.criticality,
        coefficient: point.coefficient,
        coefficient_uncertainty: point.coefficient_uncertainty,
        note: point.note,
        state,
        orbit: point.orbit.map(|orbit| match place {
            0 => orbit,
            _ => orbit.exchanged(),
        }),
        ..Special::new(point.label.unwrap_or(Label::Mx), driving, stiffness)
    }
}
