//! Where a branch of orbits ends as their period grows without bound: at an orbit that is homoclinic to a saddle, or at a saddle-node on the
//! cycle.
//!
//! Beside a saddle the parameter tends to its limit as e^(-k T), k being the least of the real parts of the saddle's eigenvalues on one side of the axis
//! (Shilnikov, Shilnikov, Turaev & Chua 2001, Methods of qualitative theory in nonlinear dynamics, chapter 13); beside a saddle-node as T^(-2) (Strogatz 1994, section 8.4). Two pairs of orbits have to agree
//! on the limit, by one law or the other. Beside a saddle-focus whose complex eigenvalues are the nearest to the axis the parameter goes to and fro about its limit,
//! ever less (Glendinning & Sparrow 1984, J. Stat. Phys. 35, 645): then it is between where the last two turns are. Else nothing is said.

use super::branches::{ARC, ROUGH, WORK};
use crate::bifurcation::Label;
use crate::bifurcation::equilibria::generic::FieldEquilibria;
use crate::bifurcation::general::equilibria::{EquilibriumBranches, Reported};
use crate::bifurcation::general::{FREE, GeneralBranch, GeneralPoint};
use crate::field::Vector;
use crate::integrate::AnyField;
use crate::number::{Uncertain, eigenvalues};
use crate::orbit::{ContinuationPoint, ShootingNodes, Tracer, method_for};
use nalgebra::Complex;
use std::f64::consts::TAU;
use std::ops::ControlFlow::Continue;

/// Orbits that are looked at: the last one, and others before it, from each of which to the next what is left of the way falls by so much.
const LAST: usize = 3;
const APART: f64 = 1.3;
/// The way to the limit is at most this part of the branch's; between two turns it is known to be there.
const NEAR: f64 = 1e-2;
const NEAR_TURNS: f64 = 0.06;
/// Beside a saddle-focus the parameter turns each time that the period has grown by half a rotation about it, or by a whole one where the orbit passes
/// the saddle twice in a period. After one and a half rotations without a turn it goes straight on.
const ROTATIONS: f64 = 1.5;
/// Two pairs of orbits agree on the limit to this part of the way that the first pair sees before it.
const AGREE: f64 = 0.2;
/// An equilibrium that an orbit passes is nearer than this to where it is slowest, in parts of the extent of the orbit.
const PASSED: f64 = 0.1;

/// The coordinates and the periods of the orbits of a branch, as it goes.
#[derive(Debug, Default, Clone)]
pub(super) struct Periods(Vec<[f64; 2]>);

/// The coordinates and the periods at the folds of a branch, as they are met.
#[derive(Debug, Default)]
pub(super) struct Folds(Vec<[f64; 2]>);

impl Folds {
    /// The next one.
    pub fn push(&mut self, at: f64, period: f64) {
        self.0.push([at, period]);
    }

    /// Whether the oscillation of the parameter shrinks from one fold to the next, as it does about a limit.
    pub fn close_in(&self) -> bool {
        /// The distance from one fold to the next, relative to the distance before.
        const LESS: f64 = 0.5;
        let Some([a, b, c]) = self.0.last_chunk() else {
            return false;
        };
        (c[0] - b[0]).abs() < LESS * (b[0] - a[0]).abs()
    }

    /// The two coordinates between which the branch goes to and fro without end, its period longer by the same time after every turn: as it does beside
    /// orbits that are homoclinic to another periodic orbit (Gavrilov & Shilnikov 1972, Math. USSR Sbornik 17, 467), whose tangencies the folds tend to.
    pub fn winding(&self) -> Option<[f64; 2]> {
        /// Folds that show it: three turns.
        const FOLDS: usize = 6;
        /// What folds of one side are apart, in parts of the way to the other side; and the times of turns, in parts of themselves.
        const STAY: f64 = 1e-6;
        const SAME_TIME: f64 = 1e-3;
        let last = &self.0[self.0.len().checked_sub(FOLDS)?..];
        let way = (last[FOLDS - 1][0] - last[FOLDS - 2][0]).abs();
        let mut turns = last.windows(3);
        let stays = turns.all(|three| (three[2][0] - three[0][0]).abs() <= STAY * way);
        let times: Vec<f64> = last
            .windows(3)
            .map(|three| three[2][1] - three[0][1])
            .collect();
        // Of one side: the other orbit has another period at either.
        let mut sides = times.windows(3);
        let grows = sides.all(|three| {
            three[0] > 0.0 && three[1] > 0.0 && (three[2] / three[0] - 1.0).abs() <= SAME_TIME
        });
        (stays && grows).then(|| [last[FOLDS - 2][0], last[FOLDS - 1][0]])
    }
}

/// The limit of the parameter, and whether there is a saddle-node.
pub(super) struct Limit {
    pub at: Uncertain,
    pub is_saddle_node: bool,
}

impl Periods {
    /// The next one, unless it is on the way by which the branch has come: where what is left of the way is rounding a step may turn it round.
    pub fn push(&mut self, at: f64, period: f64) {
        let between = |x: f64, a: f64, b: f64| (x - a) * (x - b) <= 0.0;
        let mut ways = self.0.windows(2);
        let is_known = ways.any(|way| {
            let [a, b] = [way[0], way[1]];
            between(at, a[0], b[0]) && between(period, a[1], b[1])
        });
        if !is_known {
            self.0.push([at, period]);
        }
    }

    /// Leaves the last one out.
    pub fn pop(&mut self) {
        self.0.pop();
    }

    /// What the coordinates are off, by their corrections.
    fn off(&self) -> f64 {
        /// What the orbits of a branch are corrected to, in parts of the coordinate.
        const CORRECTED: f64 = 1e-12;
        let all = self.0.iter().map(|[at, _]| at.abs());
        CORRECTED * all.fold(0.0, f64::max)
    }

    /// Whether the last two orbits have the same coordinate but for that.
    pub fn stay(&self) -> bool {
        self.last_that_stay(1).is_some()
    }

    /// Whether on some steps the coordinate stayed the same, but for that, while the period grew: at a fold it stays as well.
    pub fn grow_in_place(&self) -> bool {
        const STEPS: usize = 3;
        const GROWN: f64 = 1.05;
        let last = self.last_that_stay(STEPS);
        last.is_some_and(|orbits| orbits[STEPS][1] > GROWN * orbits[0][1])
    }

    /// The orbits at the ends of so many of the last steps, if the coordinate stayed the same on all of them.
    fn last_that_stay(&self, steps: usize) -> Option<&[[f64; 2]]> {
        let last = &self.0[self.0.len().checked_sub(steps + 1)?..];
        let stays = |pair: &[[f64; 2]]| (pair[1][0] - pair[0][0]).abs() <= self.off();
        last.windows(2).all(stays).then_some(last)
    }

    /// The limit of the coordinate at the end of the branch, whose last orbit passes by this saddle, if it does; `None` where the period does not
    /// grow without bound as far as can be told.
    pub fn limit<'s>(
        &self,
        branch: &GeneralBranch<'_>,
        saddle: &dyn Fn() -> Option<&'s Saddle>,
    ) -> Option<Limit> {
        let off = self.off();
        let within = |limit: Uncertain, part: f64| {
            let way = self.0.iter().map(|[at, _]| (at - limit.value).abs());
            limit.uncertainty <= part * way.fold(0.0, f64::max)
        };
        let near = |limit: Uncertain| within(limit, NEAR);
        let focus = saddle().and_then(Saddle::frequency);
        if let Some(at) = self
            .between_turns(off)
            .filter(|limit| within(*limit, NEAR_TURNS))
            && focus.is_some()
        {
            return Some(Limit {
                at,
                is_saddle_node: false,
            });
        }
        // It may turn once more.
        if focus.is_some_and(|frequency| self.time_since_turn() < ROTATIONS * TAU / frequency) {
            return None;
        }
        let by_rate = |rate: f64| {
            let falls = |first: f64, second: f64| (rate * (second - first)).exp();
            extrapolated(self.apart(falls)?, falls, off).filter(|limit| near(*limit))
        };
        let rates = saddle().map(Saddle::rates);
        if let Some(at) = rates.into_iter().flatten().find_map(by_rate) {
            return Some(Limit {
                at,
                is_saddle_node: false,
            });
        }
        let falls = |first: f64, second: f64| (second / first).powi(2);
        let limit = extrapolated(self.apart(falls)?, falls, off)?;
        let fold = near(limit).then(|| fold_within(branch, limit)).flatten()?;
        Some(Limit {
            at: fold,
            is_saddle_node: true,
        })
    }

    /// By how much the period has grown since the coordinate turned for the last time.
    fn time_since_turn(&self) -> f64 {
        let turned =
            |three: &[[f64; 2]]| (three[1][0] - three[0][0]) * (three[2][0] - three[1][0]) < 0.0;
        let turn = self.0.windows(3).rposition(turned).map_or(0, |at| at + 1);
        self.0.last().map_or(0.0, |last| last[1] - self.0[turn][1])
    }

    /// The limit of a coordinate that goes to and fro, ever less, as the period grows: between the last two turns, as the ways between turns
    /// shrink. `None` where there are fewer than four turns, or a way is no shorter than the one before.
    fn between_turns(&self, corrected: f64) -> Option<Uncertain> {
        /// Turns between which three ways show how they shrink.
        const TURNS: usize = 4;
        let turns = |three: &[[f64; 2]]| {
            let [a, b, c] = [three[0][0], three[1][0], three[2][0]];
            let grows = three[0][1] < three[1][1] && three[1][1] < three[2][1];
            (grows && (b - a) * (c - b) < 0.0).then_some(b)
        };
        let all: Vec<f64> = self.0.windows(3).filter_map(turns).collect();
        let last = all.get(all.len().checked_sub(TURNS)?..)?;
        let ways: Vec<f64> = last.windows(2).map(|pair| pair[1] - pair[0]).collect();
        let shrink = ways
            .windows(2)
            .all(|pair| pair[0] * pair[1] < 0.0 && pair[1].abs() < pair[0].abs());
        // Where rounding turns the branch nothing is said.
        let [before, way] = [ways[ways.len() - 2], ways[ways.len() - 1]];
        if !shrink || way.abs() <= 2.0 * corrected {
            return None;
        }
        let part = (way / before).abs();
        let at = last[last.len() - 1] - way * part / (1.0 + part);
        Some(Uncertain::new(at, way.abs() + corrected))
    }

    /// The last orbit and others before it, between whose periods what is left of the way falls; `None` where there are none such on a
    /// way that goes on and a period that grows.
    fn apart(&self, falls: impl Fn(f64, f64) -> f64) -> Option<[[f64; 2]; LAST]> {
        let mut last = self.0.len().checked_sub(1)?;
        let c = self.0[last];
        let mut before = |later: [f64; 2]| {
            last = self.0[..last]
                .iter()
                .rposition(|orbit| falls(orbit[1], later[1]) > APART)?;
            Some(self.0[last])
        };
        let b = before(c)?;
        let a = before(b)?;
        let way = &self.0[last..];
        let goes_on = way
            .windows(2)
            .all(|pair| pair[1][1] > pair[0][1] && (pair[1][0] - pair[0][0]) * (c[0] - a[0]) > 0.0);
        goes_on.then_some([a, b, c])
    }
}

/// The limit of the coordinate where what is left of the way falls by this factor between two periods, by the last two of three orbits, whose
/// own coordinates are off by `corrected`; as uncertain as it is far. `None` where the first two say otherwise.
fn extrapolated(
    orbits: [[f64; 2]; LAST],
    falls: impl Fn(f64, f64) -> f64,
    corrected: f64,
) -> Option<Uncertain> {
    let limit = |[first, second]: [[f64; 2]; 2]| {
        second[0] + (second[0] - first[0]) / (falls(first[1], second[1]) - 1.0)
    };
    let [a, b, c] = orbits;
    let (before, now) = (limit([a, b]), limit([b, c]));
    let off = (now - before).abs();
    let agree = off <= AGREE * (before - b[0]).abs();
    agree.then(|| Uncertain::new(now, (now - c[0]).abs().max(off) + corrected))
}

/// The eigenvalues of the saddle by which an orbit passes.
pub(super) struct Saddle(Vec<Complex<f64>>);

impl Saddle {
    /// The saddle where an orbit among all states is slowest; `None` where no equilibrium is there, or one that is no saddle.
    pub fn passed(branch: &GeneralBranch<'_>, orbit: &ContinuationPoint) -> Option<Self> {
        let field = branch.system.family.field(orbit.at);
        let passage = Passage::of(&field, &orbit.shooting)?;
        let saddle = passage.equilibrium(branch, orbit.at[FREE])?;
        let found = eigenvalues(&field.jacobian(&saddle))?;
        let both_signs = found.iter().any(|z| z.re > 0.0) && found.iter().any(|z| z.re < 0.0);
        both_signs.then_some(Saddle(found))
    }

    /// The rates at which the parameter may tend to its limit: the least absolute values of the real parts on either side of the axis, the lesser one first.
    /// It is that one in the end; the other one before that, where the orbit contracts much on its way around; half of them where the orbit passes
    /// the saddle twice in a period.
    fn rates(&self) -> [f64; 4] {
        let mut rates = [1.0, -1.0].map(|side| {
            let own = self.0.iter().map(|z| z.re * side).filter(|re| *re > 0.0);
            own.fold(f64::INFINITY, f64::min)
        });
        rates.sort_by(f64::total_cmp);
        let [least, other] = rates;
        [least, other, 0.5 * least, 0.5 * other]
    }

    /// The angular frequency of a saddle-focus: of the complex pair that is the nearest to the axis on its side; of two the lower one.
    fn frequency(&self) -> Option<f64> {
        let nearest = |side: f64| {
            let own = self.0.iter().filter(|z| z.re * side > 0.0);
            own.min_by(|a, b| a.re.abs().total_cmp(&b.re.abs()))
        };
        let both = [1.0, -1.0].into_iter().filter_map(nearest);
        let frequencies = both.map(|z| z.im.abs()).filter(|&one| one > 0.0);
        frequencies.reduce(f64::min)
    }
}

/// Where an orbit is slowest.
struct Passage {
    place: Vector,
    /// How far the orbit goes in each variable.
    extents: Vector,
}

impl Passage {
    fn of(field: &AnyField<'_>, orbit: &ShootingNodes) -> Option<Self> {
        /// Places on each arc.
        const PLACES: usize = 16;
        let method = method_for(field, orbit);
        let mut tracer = Tracer::for_orbit(method, ROUGH, (ARC, WORK)).ok()?;
        let mut places = Vec::with_capacity(PLACES * orbit.nodes.len());
        for (node, &duration) in orbit.nodes.iter().zip(&orbit.durations) {
            places.extend(tracer.seen(field, node, duration, PLACES).ok()?);
        }
        let mut least = places[0].clone();
        let mut most = least.clone();
        for place in &places {
            least = least.inf(place);
            most = most.sup(place);
        }
        // What stays the same is no less than it is.
        let extents = (most - least).map(|extent| extent.max(f64::MIN_POSITIVE));
        let speed = |place: &Vector| field.f(place).component_div(&extents).amax();
        let slowest = places
            .into_iter()
            .min_by(|a, b| speed(a).total_cmp(&speed(b)))?;
        Some(Passage {
            place: slowest,
            extents,
        })
    }

    /// The equilibrium that the orbit passes there.
    fn equilibrium(&self, branch: &GeneralBranch<'_>, coordinate: f64) -> Option<Vector> {
        let near = |family: &FieldEquilibria<'_>| family.corrected(&self.place, coordinate);
        let state = EquilibriumBranches::new(branch).with_family(near)?;
        let off = (&state - &self.place).component_div(&self.extents).amax();
        (off < PASSED).then_some(state)
    }
}

/// The one fold of equilibria whose coordinate is within a limit.
fn fold_within(branch: &GeneralBranch<'_>, limit: Uncertain) -> Option<Uncertain> {
    let mut folds: Vec<GeneralPoint> = Vec::new();
    let found = EquilibriumBranches::new(branch).all(&mut |point, kind| {
        let within = (point.at[FREE] - limit.value).abs() <= limit.uncertainty;
        if kind == Reported::Special && within && point.label == Some(Label::Lp) {
            folds.push(point);
        }
        Continue(())
    });
    found.ok()?;
    let fold = folds.first()?;
    // In the coordinate, as the rest is.
    let scale = branch.system.family.scale(fold.at)[FREE];
    let off = fold.parameters[FREE].uncertainty / scale.abs();
    Some(Uncertain::new(fold.at[FREE], off))
}
