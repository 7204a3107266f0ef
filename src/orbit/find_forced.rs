//! The search for orbits of whole periods of a forcing.

use super::arc::Tracer;
use super::find::Guesses;
use super::shooting_nodes::ShootingNodes;
use super::solve::traversals;
use super::{no_orbit, other_orbit};
use crate::error::{Error, Result};
use crate::field::Vector;
use crate::integrate::Control;

impl Guesses<'_> {
    /// Newton's method on this duration, some periods of the forcing, from the start and from where a run from it has come to, once such a piece of the
    /// run nearly closes; else from where each piece of a long run began, the last first.
    pub fn forced(&mut self, period: f64, tracer: &mut Tracer, start: &Vector) -> Result<()> {
        /// Pieces of the run that are looked at, and of those that do not close how many are tried.
        const PIECES: usize = 400;
        const TRIED: usize = 5;
        /// Nodes of a guess that rests.
        const AT_REST: usize = 16;
        /// A piece nearly closes whose ends are nearer, in parts of how far each variable moves.
        const NEAR: f64 = 0.1;
        let field = self.space.field();
        let (mut here, mut begins) = (start.clone(), Vec::new());
        let mut seen = [start.clone(), start.clone()];
        for _ in 0..PIECES {
            let there = tracer.flow(
                field,
                &here,
                period,
                Some(&mut |step| {
                    for (i, &x) in step.y1.iter().enumerate() {
                        seen[0][i] = seen[0][i].min(x);
                        seen[1][i] = seen[1][i].max(x);
                    }
                    Ok(Control::Continue)
                }),
            );
            let there = match there {
                Ok(mut there) => {
                    // But for rounding it is the same phase.
                    if let Some((place, _)) = field.phase() {
                        there[place] = start[place];
                    }
                    there
                }
                Err(error) if begins.is_empty() => return Err(error),
                Err(_) => break,
            };
            let extents = (&seen[1] - &seen[0]).map(|extent| extent.max(f64::MIN_POSITIVE));
            let gap = (&there - &here).component_div(&extents).amax();
            if gap < NEAR && self.closes_once(tracer, &here, period) {
                return Ok(());
            }
            begins.push(std::mem::replace(&mut here, there));
        }
        let tried = begins.iter().rev().take(TRIED - 1).chain([start]);
        for begin in tried {
            if self.closes_once(tracer, begin, period) {
                return Ok(());
            }
        }
        // What answers a forcing beside an unstable state of rest is left by every run: all nodes begin there.
        if let Some((place, turn)) = field.phase() {
            let turns = period / field.forcing_period().unwrap_or(period);
            let node = |k: usize| {
                let mut node = start.clone();
                node[place] += turns.round() * turn * k as f64 / AT_REST as f64;
                node
            };
            let resting = ShootingNodes {
                nodes: (0..AT_REST).map(node).collect(),
                durations: vec![period / AT_REST as f64; AT_REST],
            };
            if self.closes_from(tracer, Ok(resting)) && self.goes_once(tracer, period) {
                return Ok(());
            }
        }
        if matches!(self.otherwise, Some(Error::NotConverged { .. })) {
            self.otherwise = Some(no_orbit(
                format!(
                    "the run from the start does not repeat after {period}, and Newton's method finds no orbit of that period near it"
                ),
                "use `section` to see what the run does, ask for other `turns`, or give a `start` near the orbit",
            ));
        }
        Ok(())
    }

    /// The same as [`Self::closes`], of orbits that are no shorter one traversed several times.
    fn closes_once(&mut self, tracer: &mut Tracer, begin: &Vector, period: f64) -> bool {
        self.closes(tracer, begin, period) && self.goes_once(tracer, period)
    }

    /// Whether the orbit found last is no shorter one traversed several times; else it is left out.
    fn goes_once(&mut self, tracer: &mut Tracer, period: f64) -> bool {
        let found = self.closed.last().expect("one is closed");
        match traversals(tracer, self.space.field(), found) {
            Ok(Some(times)) => {
                self.closed.pop();
                self.otherwise = Some(other_orbit(
                    format!("the search ended on an orbit that is shorter by a factor of {times}"),
                    period / f64::from(times),
                    "give a `start` near the orbit, or ask for fewer `turns`",
                ));
                false
            }
            _ => true,
        }
    }
}
