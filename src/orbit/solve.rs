//! A periodic orbit with all that is said of it.

use super::arc::Tracer;
use super::extremes::{Extremes, extremes};
use super::floquet::Floquet;
use super::other_orbit;
use super::shooting::{Closed, close, relative};
use super::shooting_nodes::{MOST_ARCS, MOST_IMPLICIT_ARCS, ShootingNodes};
use super::space::{Space, Tracers};
use crate::equilibrium::{Symmetry, Verdict};
use crate::error::Result;
use crate::integrate::{AnyField, Choice, MAX_STEPS, Tolerances, Work};
use crate::number::Uncertain;

/// A periodic orbit.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Orbit {
    /// Symmetric: both interfaces move alike (also said of a single one).
    pub symmetry: Symmetry,
    /// In L/V*.
    pub period: Uncertain,
    /// tau and ln psi of every interface: where tau falls through tau_ss(V_H/2), or at a node where it never does. Of another
    /// system's variables a node, as all that speaks of stress is of the first of them.
    pub point: Vec<f64>,
    /// The time from the first node to the point.
    pub point_time: f64,
    /// The point may be off by this, in units of 1 + |y|.
    pub point_uncertainty: f64,
    /// Least stress, in a sigma.
    pub stress_min: Uncertain,
    /// Greatest stress, in a sigma.
    pub stress_max: Uncertain,
    /// Greatest slip rate of an interface, in V*.
    pub slip_rate_max: f64,
    /// Least psi.
    pub state_min: f64,
    /// Least and greatest value of every variable.
    pub extremes: Vec<[Uncertain; 2]>,
    /// Whether it is one of a family of orbits of the same parameters, as those of a conservative system: a multiplier beside the trivial one
    /// is 1.
    pub in_family: bool,
    /// Its multipliers.
    pub floquet: Floquet,
    /// The method.
    pub method: &'static str,
    /// Nodes along the cycle, (tau, ln psi) of every interface.
    pub nodes: Vec<Vec<f64>>,
    /// From each node to the next, from the last to the first.
    pub durations: Vec<f64>,
    /// Newton iterations, over all closings.
    pub iterations: usize,
    /// All work.
    pub work: Work,
}

impl Orbit {
    /// Stable, unstable or undecided.
    pub fn verdict(&self) -> Verdict {
        self.floquet.verdict()
    }

    /// The nodes by their times since the point, ascending, but those as good as the point itself: from there an unstable orbit, which a
    /// run soon leaves, is gone along piece by piece.
    pub fn nodes_since_point(&self) -> Vec<(f64, &[f64])> {
        /// A node nearer to the point than this part of the period is as good as it.
        const SAME: f64 = 1e-12;
        let period = self.period.value;
        let begins = self.durations.iter().scan(0.0, |sum, duration| {
            let begin = *sum;
            *sum += duration;
            Some(begin)
        });
        // What stands before the point comes at the end.
        let times = begins.map(|begin| {
            let time = begin - self.point_time;
            if time > 0.0 { time } else { time + period }
        });
        let within = SAME * period..(1.0 - SAME) * period;
        let nodes = times.zip(self.nodes.iter().map(Vec::as_slice));
        let mut nodes: Vec<_> = nodes.filter(|(time, _)| within.contains(time)).collect();
        nodes.sort_by(|(a, _), (b, _)| a.total_cmp(b));
        nodes
    }
}

/// What an orbit is computed with.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OrbitAccuracy {
    /// The method that makes the flow and its derivatives.
    pub method: Choice,
    /// What it is asked for in a step.
    pub tolerances: Tolerances,
    /// The bound on steps of an arc.
    pub max_steps: usize,
    /// The bound on steps of a solution, about.
    pub all_steps: usize,
    /// Whether other solutions, with other nodes and another tolerance, check the uncertainties. Without them the errors of all
    /// steps are taken to have one sign.
    pub checked: bool,
}

impl OrbitAccuracy {
    /// What a method is asked for where nobody says otherwise: all digits of Taylor, what the others reach in their time.
    pub fn of(method: Choice) -> Self {
        let tolerance = match method {
            Choice::Auto | Choice::Taylor => 1e-15,
            Choice::Radau => 1e-13,
            _ => 1e-11,
        };
        OrbitAccuracy {
            method,
            tolerances: Tolerances {
                rtol: tolerance,
                atol: tolerance,
                max_step: f64::INFINITY,
            },
            max_steps: MAX_STEPS,
            all_steps: usize::MAX,
            checked: true,
        }
    }

    /// That of orbits from which more is followed: their own uncertainties are of no use there.
    pub fn unchecked() -> Self {
        OrbitAccuracy {
            checked: false,
            ..Self::of(Choice::Auto)
        }
    }

    /// The same by the implicit method, for the orbit of a stiff system.
    pub fn stiff(self) -> Self {
        let implicit = Self::of(Choice::Radau);
        OrbitAccuracy {
            method: implicit.method,
            tolerances: implicit.tolerances.stepping(self.tolerances.max_step),
            ..self
        }
    }

    /// With this largest step.
    pub fn stepping(self, max_step: f64) -> Self {
        OrbitAccuracy {
            tolerances: self.tolerances.stepping(max_step),
            ..self
        }
    }

    pub(super) fn looser(self) -> Self {
        let Tolerances { rtol, atol, .. } = self.tolerances;
        OrbitAccuracy {
            tolerances: Tolerances {
                rtol: LOOSER * rtol,
                atol: LOOSER * atol,
                ..self.tolerances
            },
            ..self
        }
    }
}

/// Tolerance of the other solutions over that of the first.
const LOOSER: f64 = 8.0;
/// Parts of the arcs by which their nodes are moved.
pub(super) const SHIFTS: [f64; 2] = [0.37, 0.71];
/// What the period differs by counts so many times.
pub(super) const SPREAD: f64 = 2.0;

/// A closed shooting with its multipliers.
pub(super) struct Solved {
    pub closed: Closed,
    pub floquet: Floquet,
    pub iterations: usize,
}

/// Closes a guess, refines its nodes for the multipliers, and closes it again.
pub(super) fn solve(
    space: &dyn Space,
    tracers: &mut Tracers,
    guess: ShootingNodes,
) -> Result<Solved> {
    let field = space.field();
    let first = close(&mut tracers.here, field, guess)?;
    if let Some(times) = traversals(&mut tracers.here, field, &first.shooting)? {
        let period = first.shooting.period();
        return Err(other_orbit(
            format!("the cycle found is a shorter one traversed {times} times"),
            period,
            "give a shorter `period_guess`, or a `start` farther from that orbit",
        ));
    }
    let sizes = first.shooting.sizes();
    let most = if tracers.here.name() == Choice::Taylor.name() {
        MOST_ARCS
    } else {
        MOST_IMPLICIT_ARCS
    };
    let finer = first.shooting.refined_to(most, &mut |x, duration| {
        space.loss(tracers, (x, duration), &sizes)
    })?;
    let closed = close(&mut tracers.here, field, finer)?;
    let mut floquet = space.floquet(tracers, &closed)?;
    if closed.in_family {
        floquet.one_is_one();
    }
    Ok(Solved {
        iterations: first.iterations + closed.iterations,
        closed,
        floquet,
    })
}

/// How many times the cycle is a shorter one traversed; `None` where it is its own.
pub(super) fn traversals(
    tracer: &mut Tracer,
    field: &AnyField<'_>,
    shooting: &ShootingNodes,
) -> Result<Option<u32>> {
    /// Times around that are looked for, and how near the beginning such a part ends, in units of the extent.
    const TIMES: [u32; 5] = [2, 3, 5, 7, 11];
    const SAME: f64 = 1e-5;
    let (period, extent) = (shooting.period(), shooting.extent());
    for times in TIMES {
        // From the node before such a part's end.
        let part = period / f64::from(times);
        let (mut before, mut k) = (0.0, 0);
        while k + 1 < shooting.nodes.len() && before + shooting.durations[k] <= part {
            before += shooting.durations[k];
            k += 1;
        }
        let there = if part == before {
            shooting.nodes[k].clone()
        } else {
            tracer.flow(field, &shooting.nodes[k], part - before, None)?
        };
        let begin = &shooting.nodes[0];
        if (field.turned(there, begin) - begin).amax() < SAME * extent {
            return Ok(Some(times));
        }
    }
    Ok(None)
}

/// The orbit near a guess, with everything. Its point is where the first variable falls through the level, where one is given.
pub(super) fn orbit(
    level: Option<f64>,
    space: &dyn Space,
    accuracy: &OrbitAccuracy,
    guess: ShootingNodes,
) -> Result<Orbit> {
    let mut tracers = Tracers::new(accuracy)?;
    let Solved {
        closed,
        mut floquet,
        iterations,
    } = solve(space, &mut tracers, guess)?;
    let shooting = &closed.shooting;
    let (mut period, node_error) = closed.budget(!accuracy.checked);
    let mut work = tracers.work();
    let mut others = Vec::new();
    if !accuracy.checked {
        floquet.widened((work.steps.max(1) as f64).sqrt());
    } else {
        let mut apart = 0.0_f64;
        for shift in SHIFTS {
            let mut other = Tracers::new(&accuracy.looser())?;
            let moved = shooting.shifted(&mut other.here, space.field(), shift);
            match moved.and_then(|moved| solve(space, &mut other, moved)) {
                Ok(again) => {
                    floquet.widened_by(&again.floquet);
                    let shooting = &again.closed.shooting;
                    apart = apart.max((period.value - shooting.period()).abs());
                    others.push(extremes(space.field(), shooting, level, accuracy)?);
                }
                // Nothing is claimed that could not be done again.
                Err(_) => {
                    floquet.doubt();
                    apart = f64::INFINITY;
                }
            }
            work += other.work();
        }
        period.uncertainty += SPREAD * apart;
    }
    let extremes = extremes(space.field(), shooting, level, accuracy)?;
    let passage = extremes.passage.as_ref();
    let (point_time, point) =
        passage.map_or((0.0, &shooting.nodes[0]), |(time, point)| (*time, point));
    // What others differ by, and within an extreme's rounding as well.
    let bounded = |of: &dyn Fn(&Extremes) -> f64| {
        let extreme = of(&extremes);
        let apart = others.iter().map(|other| (of(other) - extreme).abs());
        let noise = (node_error + 4.0 * f64::EPSILON) * (1.0 + extreme.abs());
        Uncertain::new(extreme, noise + SPREAD * apart.fold(0.0, f64::max))
    };
    let both = |i: usize| [bounded(&|of| of.ranges[i].0), bounded(&|of| of.ranges[i].1)];
    let of_all: Vec<[Uncertain; 2]> = (0..extremes.ranges.len()).map(both).collect();
    /// Of several passages in a cycle another one is farther off.
    const SAME: f64 = 1e-3;
    let passages = others.iter().filter_map(|other| other.passage.as_ref());
    let of_point = passages.map(|(_, other)| relative(&(other - point), point));
    let of_point = of_point.filter(|&off| off < SAME);
    let point_uncertainty = node_error + SPREAD * of_point.fold(0.0, f64::max);
    Ok(Orbit {
        symmetry: space.symmetry(shooting),
        period,
        point: point.iter().copied().collect(),
        point_time,
        point_uncertainty,
        stress_min: of_all[0][0],
        stress_max: of_all[0][1],
        slip_rate_max: extremes.slip_rate_max,
        state_min: extremes.state_min(),
        extremes: of_all,
        in_family: closed.in_family,
        floquet,
        method: tracers.here.name(),
        nodes: shooting
            .nodes
            .iter()
            .map(|x| x.iter().copied().collect())
            .collect(),
        durations: shooting.durations.clone(),
        iterations,
        work,
    })
}
