//! All equilibria of N equal interfaces under one stress.
//!
//! Each interface slides on one of the branches of the steady curve: slow, middle or fast. Up to the order of the interfaces an
//! equilibrium is a share (n_s, n_m, n_f) of N with a stress under which the rates add up to V_H; those that slide alike are a cluster.
//! The middle rate is the unknown, also where no interface slides at it: the stress falls from V_M to V_m, and the other rates with it.

mod along;
mod cell;
mod curve;
mod root;
mod search;
mod stability;

pub(crate) use along::{Along, Bracket, EquilibriumCurve, Share, SteadyPoint, constant};
pub(crate) use curve::{FAST, MIDDLE, SLOW, SteadyCurve};
pub use stability::{ClusterEigenvalue, ClusterStability, EigenvalueKind, cluster_stability};

use super::{Equilibrium, SteadyStates, Symmetry};
use crate::error::{Error, Result};
use crate::friction::{AnyLaw, positive};
use crate::number::DoubleDouble;
use curve::Rates;
use search::Cells;

/// The largest number of interfaces: of more the number of arrangements, up to 3^N, is no double.
pub const MOST_INTERFACES: usize = 600;

/// All steady states of N equal interfaces at V_H, for every stiffness, by stress descending, up to the order of the interfaces. The
/// slip rates and states of each are those of its clusters, slowest first, of [`Equilibrium::counts`] interfaces.
///
/// ```
/// use twinslip::equilibrium::cluster_steady_states;
/// use twinslip::friction::{AnyLaw, Parameters};
/// let law = AnyLaw::Spinodal(Parameters::heslot_1994().spinodal());
/// let found = cluster_steady_states(&law, 10.0, 3)?;
/// let counts: Vec<_> = found.equilibria.iter().map(|one| one.counts.clone()).collect();
/// assert_eq!(counts, [vec![3], vec![1, 2], vec![2, 1]]);
/// # Ok::<(), twinslip::Error>(())
/// ```
///
/// # Errors
/// [`Error::Parameter`] unless V_H is positive and finite and N is between 1 and [`MOST_INTERFACES`]; [`Error::NotConverged`] if a search
/// fails, which a certain bracket excludes.
pub fn cluster_steady_states(
    law: &AnyLaw,
    driving: f64,
    interfaces: usize,
) -> Result<SteadyStates> {
    let mut found = SteadyStates {
        equilibria: Vec::new(),
        complete: true,
    };
    let complete = share_states(law, driving, interfaces, |one| {
        found.add(one.state, law, driving);
    })?;
    found.complete &= complete;
    Ok(found.sorted())
}

/// A steady state with its share, and the middle rate under its stress: where all slide alike theirs.
pub(crate) struct ShareState {
    pub share: Share,
    pub rate: DoubleDouble,
    pub state: Equilibrium,
}

/// All of them, and whether their number is certain.
///
/// # Errors
/// As [`cluster_steady_states`].
pub(crate) fn share_states(
    law: &AnyLaw,
    driving: f64,
    interfaces: usize,
    mut seen: impl FnMut(ShareState),
) -> Result<bool> {
    positive("driving", driving)?;
    if !(1..=MOST_INTERFACES).contains(&interfaces) {
        return Err(Error::parameter(
            "interfaces",
            interfaces,
            format!("between 1 and {MOST_INTERFACES}"),
        ));
    }
    seen(ShareState {
        share: [0, interfaces, 0],
        rate: DoubleDouble::from(driving) / interfaces as f64,
        state: alike(law, driving, interfaces),
    });
    let Some(curve) = SteadyCurve::new(law, 4.0 * driving) else {
        return Ok(interfaces == 1);
    };
    let shares = shares(curve.has(), interfaces);
    if shares.is_empty() {
        return Ok(true);
    }
    let mut complete = curve.branch(driving / interfaces as f64).is_some();
    let mut cells = Cells::new(curve, driving);
    for share in shares {
        let isolation = cells.isolate(&share, driving);
        complete &= isolation.certain;
        let mut states = Vec::new();
        if isolation.at_rest {
            let fast = DoubleDouble::from(driving) / share[FAST] as f64;
            let rates = [DoubleDouble::ZERO, DoubleDouble::ZERO, fast];
            let tiny = f64::MIN_POSITIVE;
            let radii = [tiny, tiny, fast.to_f64() * f64::EPSILON];
            states.push((rates, root::Reach::apart(radii)));
        }
        for bracket in isolation.brackets {
            states.push(root::in_bracket(&curve, &share, driving, bracket)?);
        }
        for (rates, reach) in states {
            seen(ShareState {
                share,
                rate: rates[MIDDLE],
                state: of_share(law, driving, &share, &rates, &reach),
            });
        }
    }
    Ok(complete)
}

/// The state in which all slide alike.
fn alike(law: &AnyLaw, driving: f64, interfaces: usize) -> Equilibrium {
    let each = DoubleDouble::from(driving) / interfaces as f64;
    let radius = each.to_f64() * f64::EPSILON;
    let mut state = Equilibrium::at(law, driving, Symmetry::Symmetric, &[(each, radius)]);
    state.counts = vec![interfaces];
    state
}

fn of_share(
    law: &AnyLaw,
    driving: f64,
    counts: &Rates<usize>,
    rates: &Rates<DoubleDouble>,
    reach: &root::Reach,
) -> Equilibrium {
    let present = || [SLOW, MIDDLE, FAST].into_iter().filter(|&i| counts[i] > 0);
    let known: Vec<_> = present().map(|i| (rates[i], reach.radii[i])).collect();
    let mut state = Equilibrium::at(law, driving, Symmetry::Asymmetric, &known);
    state.counts = present().map(|i| counts[i]).collect();
    state.together = present().map(|i| reach.together[i]).collect();
    state
}

/// All shares of two branches and more.
pub(crate) fn shares(has: [bool; 3], interfaces: usize) -> Vec<Rates<usize>> {
    let mut all = Vec::new();
    for slow in 0..=interfaces {
        for fast in 0..=interfaces - slow {
            let counts = [slow, interfaces - slow - fast, fast];
            let used = counts.iter().filter(|&&n| n > 0).count();
            if used > 1 && (0..3).all(|i| has[i] || counts[i] == 0) {
                all.push(counts);
            }
        }
    }
    all
}
