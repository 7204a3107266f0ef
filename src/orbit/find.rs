//! Finding periodic orbits: from a given point, from settled runs, or along a branch from a Hopf point.

use super::arc::Tracer;
use super::continuation_point::ContinuationPoint;
use super::interface_system::InterfaceSystem;
use super::settle::{passages, settle};
use super::shooting::close;
use super::shooting_nodes::ShootingNodes;
use super::solve::{Orbit, OrbitAccuracy, orbit, traversals};
use super::space::{Space, space_of};
use super::{branch, no_orbit, other_orbit};
use crate::equilibrium::{Symmetry, Verdict};
use crate::error::{Error, Result};
use crate::field::Vector;
use crate::integrate::{AnyField, Choice};
use crate::model::Loading;

/// The time in which a loading alone raises the stress by some units: that of a stick-slip cycle, roughly.
pub(super) fn rough_period(loading: &Loading) -> f64 {
    /// Typical stress drop of a cycle, in a sigma.
    const DROP: f64 = 5.0;
    DROP / (loading.stiffness * loading.driving)
}

/// Which orbit is wanted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Query {
    /// Whether both interfaces move alike; a single one always does.
    pub symmetry: Symmetry,
    /// Where the search begins.
    pub begin: InitialGuess,
}

/// Where a search for an orbit begins.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum InitialGuess {
    /// With runs from several starts; where they lead to no orbit of the symmetry, as from [`InitialGuess::Hopf`].
    Anywhere,
    /// At the nearest Hopf point along V_H, whose branch is followed, past its folds, to the slab's V_H.
    Hopf,
    /// At or near the orbit.
    At {
        /// tau and ln psi of both interfaces; equal ones for a single interface.
        start: (f64, [f64; 2]),
        /// The period, roughly. With it no shorter cycle is taken for the orbit.
        period: Option<f64>,
    },
}

/// What was found.
#[derive(Debug, Clone, PartialEq)]
pub struct FoundOrbit {
    /// The orbit asked for; where several have the symmetry, a stable one.
    pub orbit: Orbit,
    /// The others of that symmetry that were met.
    pub others: Vec<Orbit>,
}

impl FoundOrbit {
    /// All of them, as branches of orbits begin.
    pub fn beginnings(self) -> Vec<ContinuationPoint> {
        let all = std::iter::once(self.orbit).chain(self.others);
        all.map(Orbit::beginning).collect()
    }

    /// With those of another search: a stable one first, else as they come.
    fn with(self, more: FoundOrbit) -> Self {
        let first = [self.orbit, more.orbit];
        let all = first.into_iter().chain(self.others).chain(more.others);
        Self::stable_first(all.collect())
    }

    /// A stable one first, then that of the fewest turns.
    fn by_turns(self) -> Self {
        let mut orbits: Vec<Orbit> = std::iter::once(self.orbit).chain(self.others).collect();
        orbits.sort_by(|a, b| a.period.value.abs().total_cmp(&b.period.value.abs()));
        orbits.dedup_by(|a, b| (a.period.value / b.period.value - 1.0).abs() < SAME_PERIOD);
        Self::stable_first(orbits)
    }

    fn stable_first(mut orbits: Vec<Orbit>) -> Self {
        orbits.sort_by_key(|orbit| orbit.verdict() != Verdict::Stable);
        let orbit = orbits.remove(0);
        FoundOrbit {
            orbit,
            others: orbits,
        }
    }
}

/// Tolerance with which guesses are made and first closed.
pub(super) const ROUGH: f64 = 1e-10;
/// Tolerance with which cycles are told from ones traversed twice.
pub(super) const FINE: f64 = 1e-15;
/// Steps of a search, at most: some seconds of work for few variables.
pub(super) const SEARCH: usize = 2_000_000;

/// The same for so many variables: what a step with its tangents takes grows with the square of their number.
pub(super) fn search_steps(variables: usize) -> usize {
    const FEW: usize = 8;
    SEARCH * FEW.pow(2) / variables.max(FEW).pow(2)
}

/// Periods that differ by less, relatively, are of one orbit.
const SAME_PERIOD: f64 = 1e-7;

/// The periodic orbit of a slab.
///
/// Without a start it is looked for with runs from several starts; where those come to rest, or end on an orbit of the other
/// symmetry, along the branch of orbits from a Hopf point.
///
/// # Errors
/// [`Error::NoOrbit`] says what was found instead; [`Error::NotConverged`]; those of the flow.
pub fn find(slab: &InterfaceSystem, query: &Query, accuracy: &OrbitAccuracy) -> Result<FoundOrbit> {
    if query.symmetry == Symmetry::Asymmetric && slab.interfaces == 1 {
        return Err(Error::Input(
            "a single interface has no asymmetric orbit; ask for the symmetric one".into(),
        ));
    }
    let space = space_of(slab, query.symmetry);
    search(slab, &*space, query, accuracy)
}

/// A periodic orbit of either symmetry, as runs settle on it: a stable one, the symmetric one first.
///
/// # Errors
/// As of [`find`].
pub fn find_either(slab: &InterfaceSystem, accuracy: &OrbitAccuracy) -> Result<FoundOrbit> {
    let of = |symmetry| {
        let begin = InitialGuess::Anywhere;
        find(slab, &Query { symmetry, begin }, accuracy)
    };
    let symmetric = of(Symmetry::Symmetric);
    let is_stable = |found: &FoundOrbit| found.orbit.verdict() == Verdict::Stable;
    if slab.interfaces == 1 || symmetric.as_ref().is_ok_and(is_stable) {
        return symmetric;
    }
    match (symmetric, of(Symmetry::Asymmetric)) {
        (Ok(symmetric), Ok(asymmetric)) => Ok(symmetric.with(asymmetric)),
        (Ok(found), Err(_)) | (Err(_), Ok(found)) => Ok(found),
        (Err(error), Err(_)) => Err(error),
    }
}

/// Of tau and ln psi of both interfaces, the variables in which orbits of a symmetry are.
fn variables(symmetry: Symmetry, (tau, [first, second]): (f64, [f64; 2])) -> Vector {
    Vector::from_vec(match symmetry {
        Symmetry::Symmetric => vec![tau, first],
        Symmetry::Asymmetric => vec![tau, first, second],
    })
}

/// Starts from which runs are made: below the equilibrium; asymmetric ones beside the symmetric equilibrium and far from it.
fn starts(slab: &InterfaceSystem, symmetry: Symmetry) -> Vec<Vector> {
    let (tau, w) = (slab.steady_stress(), slab.steady_log_state());
    let starts = match symmetry {
        Symmetry::Symmetric => vec![(tau, [w - 0.5; 2]), (tau, [w - 3.0; 2])],
        Symmetry::Asymmetric => vec![
            (tau, [w, w + 0.3]),
            (tau + 1.0, [w, w - 4.0]),
            (10.0, [0.5_f64.ln(), 1e-3_f64.ln()]),
        ],
    };
    let starts = starts.into_iter();
    starts.map(|start| variables(symmetry, start)).collect()
}

fn search(
    slab: &InterfaceSystem,
    space: &dyn Space,
    query: &Query,
    accuracy: &OrbitAccuracy,
) -> Result<FoundOrbit> {
    let mut tracer = Tracer::limited(ROUGH, accuracy.max_steps, SEARCH)?;
    let mut guesses = Guesses::new(space, query.symmetry);
    let rough = rough_period(&slab.loading);
    match query.begin {
        InitialGuess::At { start, period } => {
            let start = variables(query.symmetry, start);
            match period {
                Some(period) => guesses.over(period, &mut tracer, &start)?,
                None => guesses.near(rough, &mut tracer, &start)?,
            }
        }
        InitialGuess::Anywhere => {
            for start in starts(slab, query.symmetry) {
                guesses.settled(rough, &mut tracer, &start);
            }
        }
        InitialGuess::Hopf => {}
    }
    let at = matches!(query.begin, InitialGuess::At { .. });
    if guesses.closed.is_empty() && !at && tracer.used_up().is_none() {
        for shooting in branch::from_hopf(slab, query.symmetry, space, &mut tracer)? {
            guesses.take(shooting);
        }
    }
    if guesses.closed.is_empty() {
        let used_up = tracer.used_up().is_some();
        return Err(no_orbit_met(guesses, used_up));
    }
    let whole_cycle = matches!(
        query.begin,
        InitialGuess::At {
            period: Some(_),
            ..
        }
    );
    let level = Some(slab.steady_stress());
    let found = completed(guesses, level, accuracy, whole_cycle)?;
    if query.begin != InitialGuess::Anywhere || found.orbit.verdict() == Verdict::Stable {
        return Ok(found);
    }
    // Nor is it what runs settle on: an orbit of fewer turns may be on the branch.
    let mut branching = Guesses::new(space, query.symmetry);
    for shooting in branch::from_hopf(slab, query.symmetry, space, &mut tracer).unwrap_or_default()
    {
        branching.take(shooting);
    }
    if branching.closed.is_empty() {
        return Ok(found);
    }
    Ok(match completed(branching, level, accuracy, false) {
        Ok(others) => found.with(others).by_turns(),
        Err(_) => found,
    })
}

/// Why there is no orbit.
pub(super) fn no_orbit_met(guesses: Guesses<'_>, used_up: bool) -> Error {
    if used_up {
        return no_orbit(
            format!("no periodic orbit was found in {SEARCH} steps, the limit of a search"),
            "give a `start` on the orbit and its `period_guess`, or other `driving` and `stiffness`",
        );
    }
    guesses.otherwise.unwrap_or_else(|| {
        no_orbit(
            "no periodic orbit of this symmetry was found".into(),
            "give a `start` near it, or other `driving` and `stiffness`",
        )
    })
}

/// The orbits that closed polygons are, a stable one first. Where their period was given they are whole cycles.
pub(super) fn completed(
    mut guesses: Guesses<'_>,
    level: Option<f64>,
    accuracy: &OrbitAccuracy,
    whole_cycle: bool,
) -> Result<FoundOrbit> {
    /// The steps of closing what a search has met, in those of the search.
    const CLOSING: usize = 4;
    let space = guesses.space;
    let mut orbits: Vec<Orbit> = Vec::new();
    let mut fine = match accuracy.method {
        Choice::Auto | Choice::Taylor => Tracer::taylor(FINE)?,
        other => {
            let steps = CLOSING.saturating_mul(accuracy.all_steps);
            Tracer::new(other, accuracy.tolerances, accuracy.max_steps.min(steps))?.within(steps)
        }
    };
    let (mut done, mut fewer) = (0, whole_cycle);
    while done < guesses.closed.len() {
        let mut shooting = guesses.closed[done].clone();
        done += 1;
        if !whole_cycle {
            // Close to a period doubling only the last digits tell a cycle from one traversed twice.
            shooting = close(&mut fine, space.field(), shooting)?.shooting;
            shooting = once_around(&mut fine, space.field(), shooting)?;
        }
        let orbit = orbit(level, space, accuracy, shooting)?;
        let period = orbit.period.value;
        let known = |other: &Orbit| (other.period.value / period - 1.0).abs() < SAME_PERIOD;
        if !orbits.iter().any(known) {
            orbits.push(orbit);
        }
        let all_unstable = || {
            orbits
                .iter()
                .all(|orbit| orbit.verdict() != Verdict::Stable)
        };
        if done == guesses.closed.len() && !fewer && all_unstable() {
            fewer = true;
            guesses.of_fewer_turns(&orbits[0], accuracy)?;
        }
    }
    // Of unstable ones that of the fewest turns.
    orbits.sort_by(|a, b| a.period.value.abs().total_cmp(&b.period.value.abs()));
    Ok(FoundOrbit::stable_first(orbits))
}

/// Closed polygons on the way to an answer.
pub(super) struct Guesses<'a> {
    pub(super) space: &'a dyn Space,
    wanted: Symmetry,
    pub closed: Vec<ShootingNodes>,
    /// Why there is none, so far.
    pub otherwise: Option<Error>,
}

impl<'a> Guesses<'a> {
    /// None yet.
    pub fn new(space: &'a dyn Space, wanted: Symmetry) -> Self {
        Guesses {
            space,
            wanted,
            closed: Vec::new(),
            otherwise: None,
        }
    }

    /// Keeps a closed shooting if it has the symmetry and is new.
    fn take(&mut self, shooting: ShootingNodes) -> bool {
        if self.space.symmetry(&shooting) != self.wanted {
            self.otherwise = Some(other_orbit(
                "the search ended on the symmetric orbit".into(),
                shooting.period(),
                "give a `start` near an asymmetric one, or ask for `symmetry` symmetric",
            ));
            return false;
        }
        let period = shooting.period();
        let known = |other: &ShootingNodes| (other.period() / period - 1.0).abs() < SAME_PERIOD;
        if !self.closed.iter().any(known) {
            self.closed.push(shooting);
        }
        true
    }

    /// Newton's method on the cycle of a given duration that begins at a point, or some cycles after it: the directions that
    /// contract have come to rest there.
    pub fn over(&mut self, period: f64, tracer: &mut Tracer, start: &Vector) -> Result<()> {
        /// Cycles that are waited.
        const WAITED: usize = 3;
        let field = self.space.field();
        let mut begins = vec![start.clone()];
        for k in 0..=WAITED {
            match tracer.flow(field, &begins[k], period, None) {
                Ok(next) => begins.push(next),
                Err(error) if k == 0 => return Err(error),
                Err(_) => break,
            }
        }
        let mut cycles: Vec<_> = begins
            .windows(2)
            .map(|pair| ((&pair[1] - &pair[0]).amax(), pair[0].clone()))
            .collect();
        cycles.sort_by(|a, b| a.0.total_cmp(&b.0));
        for (_, begin) in cycles {
            if self.closes(tracer, &begin, period) {
                break;
            }
        }
        Ok(())
    }

    /// Whether Newton's method on the cycle of this duration from this point leads to an orbit of the symmetry.
    pub(super) fn closes(&mut self, tracer: &mut Tracer, begin: &Vector, period: f64) -> bool {
        let guess = ShootingNodes::along(tracer, self.space.field(), begin, period);
        self.closes_from(tracer, guess)
    }

    /// Whether Newton's method on these nodes does.
    pub(super) fn closes_from(
        &mut self,
        tracer: &mut Tracer,
        guess: Result<ShootingNodes>,
    ) -> bool {
        let field = self.space.field();
        match guess.and_then(|shooting| close(tracer, field, shooting)) {
            Ok(closed) => self.take(closed.shooting),
            Err(error) => {
                self.otherwise.get_or_insert(error);
                false
            }
        }
    }

    /// Newton's method on parts of an orbit of several turns, each from one passage of the middle of the first variable to the next.
    fn of_fewer_turns(&mut self, orbit: &Orbit, accuracy: &OrbitAccuracy) -> Result<()> {
        /// Turns of the longest part that is tried.
        const TRIED: usize = 6;
        /// Turns of an orbit that is looked at.
        const TURNS: usize = 64;
        let field = self.space.field();
        let search = search_steps(field.dimension());
        let mut tracer = Tracer::limited_by(accuracy.method, ROUGH, accuracy.max_steps, search)?;
        let [low, high] = orbit.extremes[0];
        let level = 0.5 * (low.value + high.value);
        let (mut passed, mut begin) = (Vec::new(), 0.0);
        for (node, &duration) in orbit.nodes.iter().zip(&orbit.durations) {
            let node = Vector::from_column_slice(node);
            let found = passages(&mut tracer, field, &node, duration, level, TURNS)?.found;
            passed.extend(found.into_iter().map(|(time, y)| (begin + time, y)));
            begin += duration;
        }
        // Of parts of one turn, of two, ... the most nearly closed one.
        for turns in 1..passed.len().min(TRIED + 1) {
            let parts = passed.iter().zip(&passed[turns..]);
            let gap = |part: &(&(f64, Vector), &(f64, Vector))| (&part.1.1 - &part.0.1).amax();
            let best = parts.min_by(|a, b| gap(a).total_cmp(&gap(b)));
            if let Some(((begin, start), (end, _))) = best
                && self.closes(&mut tracer, start, end - begin)
            {
                break;
            }
        }
        Ok(())
    }

    /// Newton's method from a point, on the cycles that its returns suggest; a settled run where they lead nowhere.
    pub fn near(&mut self, rough_period: f64, tracer: &mut Tracer, start: &Vector) -> Result<()> {
        /// Rough periods that the returns are looked for in; returns; those that a cycle may begin with; cycles tried.
        const LONG: f64 = 30.0;
        const RETURNS: usize = 8;
        const LATER: usize = 4;
        const TRIED: usize = 6;
        let field = self.space.field();
        let length = LONG * rough_period;
        let run = passages(tracer, field, start, length, start[0], RETURNS);
        let mut returns = Vec::new();
        if let Ok(run) = run {
            // Counted from the start itself if it falls there, else from the first passage.
            let mut found = run.found.into_iter();
            let begin = if field.f(start)[0] < 0.0 {
                Some((0.0, start.clone()))
            } else {
                found.next()
            };
            // Some returns later the directions that contract have come to rest.
            let passed: Vec<_> = begin.into_iter().chain(found).collect();
            for (i, (time, begin)) in passed.iter().take(LATER).enumerate() {
                let later = passed[i + 1..].iter();
                returns.extend(later.map(|(t, y)| ((y - begin).amax(), begin.clone(), t - time)));
            }
        }
        returns.retain(|&(_, _, period)| period > 1e-9 * length);
        returns.sort_by(|a, b| a.0.total_cmp(&b.0));
        for (_, begin, period) in returns.into_iter().take(TRIED) {
            if self.closes(tracer, &begin, period) {
                return Ok(());
            }
        }
        self.settled(rough_period, tracer, start);
        Ok(())
    }

    /// What a run from this start settles on.
    pub fn settled(&mut self, rough_period: f64, tracer: &mut Tracer, start: &Vector) {
        let field = self.space.field();
        let mut polygons = Vec::new();
        let run = settle(
            tracer,
            field,
            start,
            rough_period,
            &mut |tracer, shooting| match close(tracer, field, shooting) {
                Ok(closed) => once_around(tracer, field, closed.shooting)
                    .map(|shooting| polygons.push(shooting))
                    .is_ok(),
                Err(_) => false,
            },
        );
        for shooting in polygons {
            self.take(shooting);
        }
        if let Err(error) = run {
            self.otherwise.get_or_insert(error);
        }
    }
}

/// The cycle, once around.
fn once_around(
    tracer: &mut Tracer,
    field: &AnyField<'_>,
    mut shooting: ShootingNodes,
) -> Result<ShootingNodes> {
    while let Some(times) = traversals(tracer, field, &shooting)? {
        let part = shooting.period() / f64::from(times);
        let once = ShootingNodes::along(tracer, field, &shooting.nodes[0], part)?;
        shooting = close(tracer, field, once)?.shooting;
    }
    Ok(shooting)
}
