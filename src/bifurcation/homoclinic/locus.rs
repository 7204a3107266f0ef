//! All curves of homoclinic orbits in the ranges of two parameters, with what is met on them.

use super::begin::{ARC, WORK};
use super::bogdanov_takens::BogdanovTakens;
use super::codimension_two::Test;
use super::connection::Frame;
use super::curve::{HomoclinicCurve, HomoclinicPoint, NonCentral};
use super::linear::{Solved, Solver};
use super::saddle::Kind;
use crate::bifurcation::Label;
use crate::bifurcation::equilibria::generic_curve::EquilibriumBifurcation;
use crate::bifurcation::general::curves::{in_order, looked_along, scanned};
use crate::bifurcation::general::{
    FoundOrbits, GeneralBranch, GeneralCurve, GeneralEvent, GeneralObserver, GeneralPoint,
    GeneralSolution, SAME, Teller, equilibrium_curves, orbits,
};
use crate::continuation::{Continuation, Met, Stop, WatchedFunction};
use crate::error::Result;
use crate::field::Vector;
use crate::integrate::Choice;
use crate::orbit::{ContinuationPoint, Tracer};
use std::ops::ControlFlow::{self, Break, Continue};

/// What arcs are computed to.
const TOLERANCE: f64 = 1e-15;

/// Follows all curves of homoclinic orbits through the ranges and hands on what is found.
///
/// # Errors
/// Those of the orbits; [`crate::Error::TooManyPoints`]. That a curve ends early is none: it is told as `MX`.
pub fn homoclinic_curves(curve: &GeneralCurve<'_>, seen: GeneralObserver<'_>) -> Result<()> {
    let mut teller = Teller::new(seen, &curve.following);
    let mut curves = HomoclinicCurves::new(curve);
    for along in [0, 1] {
        let held = 1 - along;
        let own = curve.own.iter().map(|at| at[held]).filter(|own| {
            let (from, to) = curve.ranges[held];
            (from.min(to)..=from.max(to)).contains(own)
        });
        let given = curve.orbit.iter().map(|orbit| orbit.at[held]).chain(own);
        let scan: Vec<f64> = given.chain(scanned(curve, held)).collect();
        for value in scan {
            for (orbit, kind) in curves.seeds(along, value)? {
                let mut solver = curves.solver(kind)?;
                if let Some(first) = solver.first(&orbit, held) {
                    curves.through(solver, first, held, &mut teller)?;
                }
                if teller.told.is_break() {
                    return teller.end();
                }
            }
        }
        // Branches of orbits take seconds: they are followed along the second coordinate only where a curve may lie along it.
        if curves.count > 0 {
            break;
        }
    }
    teller.end()
}

/// Follows the curve that leaves a double zero of equilibria; whether it is found.
///
/// # Errors
/// As of [`homoclinic_curves`].
pub(in crate::bifurcation) fn homoclinic_curve_of(
    curve: &GeneralCurve<'_>,
    end: &GeneralPoint,
    seen: GeneralObserver<'_>,
) -> Result<bool> {
    /// What the first orbit goes through, in units of 1 + |x|: where the largest is too large for the normal form smaller ones are tried.
    const LARGEST: f64 = 0.1;
    const SMALLER: f64 = 0.5;
    const LEAST: f64 = 1e-3;
    let mut teller = Teller::new(seen, &curve.following);
    let mut curves = HomoclinicCurves::new(curve);
    curves.double_zeros = Some(vec![end.clone()]);
    let GeneralSolution::Equilibrium { state, .. } = &end.solution else {
        return Ok(false);
    };
    let family = curve.system.family;
    let Some(zero) = BogdanovTakens::of(family, state, end.at, widths(curve)) else {
        return Ok(false);
    };
    let mut size = LARGEST * (1.0 + state.amax());
    while curves.count == 0 && size > LEAST {
        let mut solver = curves.solver(Kind::Saddle)?;
        if let Some((first, held)) = solver.beside(&zero, size) {
            curves.through(solver, first, held, &mut teller)?;
        }
        size *= SMALLER;
    }
    teller.end().map(|()| curves.count > 0)
}

struct HomoclinicCurves<'c, 'a> {
    curve: &'c GeneralCurve<'a>,
    count: usize,
    /// Where curves pass the values at which they are looked for: (saddle, both coordinates).
    passes: Vec<Vector>,
    /// The Bogdanov-Takens points in the ranges, once they have been looked for.
    double_zeros: Option<Vec<GeneralPoint>>,
}

impl<'c, 'a> HomoclinicCurves<'c, 'a> {
    fn new(curve: &'c GeneralCurve<'a>) -> Self {
        HomoclinicCurves {
            curve,
            count: 0,
            passes: Vec::new(),
            double_zeros: None,
        }
    }

    fn solver(&self, kind: Kind) -> Result<Solver<'a>> {
        let family = self.curve.system.family;
        Ok(Solver {
            family,
            tracer: Tracer::for_orbit(Choice::Taylor, TOLERANCE, (ARC, WORK))?,
            frame: Frame::new(family.dimension(), self.curve.ranges, kind),
        })
    }

    /// The last orbits of branches along a coordinate whose period grows without bound, and what at.
    fn seeds(&self, along: usize, held: f64) -> Result<Vec<(ContinuationPoint, Kind)>> {
        let mut found = Vec::new();
        looked_along(self.curve, along, held, |branch| {
            let given = self.curve.orbit.clone();
            let given = given.filter(|orbit| orbit.at[1 - along] == held);
            let searched = |coordinate: f64| {
                let at = in_order(along, [coordinate, held]);
                self.curve.found.map_or_else(Vec::new, |found| found(at))
            };
            let branch = GeneralBranch {
                found: self.curve.found.map(|_| FoundOrbits {
                    at: &searched,
                    within: self.curve.own.map(|own| own[along]),
                }),
                orbit: given.map(|orbit| ContinuationPoint {
                    at: in_order(along, orbit.at),
                    ..orbit
                }),
                ..branch.clone()
            };
            orbits(&branch, &mut |event| {
                if let GeneralEvent::Special(point) = event
                    && point.label == Some(Label::Hom)
                    && let GeneralSolution::Orbit { shooting, .. } = point.solution
                {
                    let at = in_order(along, point.at);
                    let kind = match point.saddle_node {
                        true => Kind::SaddleNode,
                        false => Kind::Saddle,
                    };
                    found.push((ContinuationPoint { shooting, at }, kind));
                }
                Continue(())
            })
        })?;
        Ok(found)
    }

    fn pass(&self, point: &HomoclinicPoint) -> Vector {
        let connection = &point.solved.connection;
        let saddle = self.curve.system.representative(&connection.saddle);
        saddle.push(connection.at[0]).push(connection.at[1])
    }

    fn is_known(&self, point: &HomoclinicPoint) -> bool {
        let here = self.pass(point);
        let near = |pass: &Vector| {
            let mut pairs = pass.iter().zip(&here);
            pairs.all(|(a, b)| (a - b).abs() < SAME * (1.0 + a.abs()))
        };
        self.passes.iter().any(near)
    }

    /// The curve through a homoclinic orbit at a value of a parameter, unless it is known.
    fn through(
        &mut self,
        mut solver: Solver<'a>,
        first: HomoclinicPoint,
        held: usize,
        teller: &mut Teller<'_>,
    ) -> Result<()> {
        let curve = self.curve;
        if self.is_known(&first) {
            return Ok(());
        }
        self.passes.push(self.pass(&first));
        // A special point at the begin would be on neither half.
        let mut begin = HomoclinicCurve {
            solver: &mut solver,
            step: curve.following.step,
        };
        let first = begin.regular(first);
        let number = self.count;
        self.count += 1;
        let frame = solver.frame.clone();
        let turned = -&first.tangent;
        let mut before = Vec::new();
        if let Some(back) = solver.point(first.solved.clone(), &turned, None) {
            self.half(&mut solver, back, number, &mut |point, special| {
                before.push((point, special));
                Continue(())
            })?;
        }
        for (point, special) in before.into_iter().rev() {
            if teller.point(point, special).is_break() {
                return Ok(());
            }
        }
        let value = first.solved.connection.at[held];
        let label = curve.at[held].contains(&value).then_some(Label::Uz);
        let begin = self.told(&first, number, label, label.map(|_| (held, value)));
        if teller.point(begin, label.is_some()).is_break() {
            return Ok(());
        }
        solver.frame = frame;
        self.half(&mut solver, first, number, &mut |point, special| {
            teller.point(point, special)
        })
    }

    /// One way from a point of the curve, which itself is not told.
    fn half(
        &mut self,
        solver: &mut Solver<'_>,
        first: HomoclinicPoint,
        number: usize,
        seen: &mut dyn FnMut(GeneralPoint, bool) -> ControlFlow<()>,
    ) -> Result<()> {
        let curve = self.curve;
        let mut watches: Vec<_> = Test::ALL.map(WatchedFunction::TestFunction).to_vec();
        for i in 0..2 {
            let (from, to) = curve.ranges[i];
            let mut values = vec![from, to];
            values.extend(curve.at[i].iter().chain(&scanned(curve, i)));
            let begins = first.solved.connection.at[i];
            values.retain(|value| *value != begins);
            watches.extend(
                values
                    .into_iter()
                    .map(|value| WatchedFunction::Value(i, value)),
            );
        }
        let step = curve.following.step;
        let first_rate = first.solved.linear.splitting.fastest();
        let mut last = first.clone();
        let mut continuation = Continuation::new(HomoclinicCurve { solver, step }, first);
        let most = curve.following.max_points;
        let stopped =
            continuation.follow(&watches, most, &mut |continuation, _, met| match met {
                Met::Point(at) => {
                    last = at.clone();
                    if let Some(end) = self.double_zero(at, number) {
                        seen(end, true)?;
                        return Break(());
                    }
                    if let Some(why) = at.solved.linear.splitting.degenerates(first_rate) {
                        let end = GeneralPoint {
                            note: Some(why.to_owned()),
                            ..self.told(at, number, Some(Label::Mx), None)
                        };
                        seen(end, true)?;
                        return Break(());
                    }
                    seen(self.told(at, number, None, None), false)
                }
                // With the orbit's end at some distance it is near there, if anywhere.
                Met::Zero(WatchedFunction::TestFunction(Test::NonCentral), at) => {
                    match self.non_central(at, continuation.curve.solver, number) {
                        Some(end) => {
                            seen(end, true)?;
                            Break(())
                        }
                        None => Continue(()),
                    }
                }
                Met::Zero(WatchedFunction::TestFunction(test), at) => {
                    let along = continuation.curve.off_along(at, test);
                    let label = test.label(&at.solved.linear.splitting);
                    let point = self.told(at, number, Some(label), None);
                    seen(self.off_along(point, at, along), true)
                }
                Met::Zero(WatchedFunction::Value(i, value), at) => {
                    let (from, to) = curve.ranges[i];
                    let ends = value == from || value == to;
                    if !ends && !curve.at[i].contains(&value) {
                        self.passes.push(self.pass(at));
                        return Continue(());
                    }
                    let label = if ends { Label::Ep } else { Label::Uz };
                    seen(self.told(at, number, Some(label), Some((i, value))), true)?;
                    if ends { Break(()) } else { Continue(()) }
                }
                Met::Zero(WatchedFunction::Turn(_) | WatchedFunction::UserFunction(_), _) => {
                    Continue(())
                }
            })?;
        if stopped != Stop::Observer {
            let end = self.non_central(&last, continuation.curve.solver, number);
            let end = end.unwrap_or_else(|| GeneralPoint {
                note: Some(stopped.to_string()),
                ..self.told(&last, number, Some(Label::Mx), None)
            });
            let _ = seen(end, true);
        }
        Ok(())
    }

    /// The non-central homoclinic orbit to a saddle-node near a point, if there is one.
    fn non_central(
        &self,
        near: &HomoclinicPoint,
        solver: &mut Solver<'_>,
        number: usize,
    ) -> Option<GeneralPoint> {
        let NonCentral { solved, off } = NonCentral::near(near, solver)?;
        let at = solved.connection.at;
        let point = self.told_of(&solved, number, Some(Label::Nch), at);
        Some(point.placed(self.curve.system.family, off))
    }

    /// A point as it is told; of a value of a parameter that is landed on with what the other one may be off by.
    fn told(
        &self,
        at: &HomoclinicPoint,
        number: usize,
        label: Option<Label>,
        landed: Option<(usize, f64)>,
    ) -> GeneralPoint {
        let widths = widths(self.curve);
        let (mut place, mut off) = (at.solved.connection.at, at.uncertainty(widths));
        if let Some((i, value)) = landed {
            place[i] = value;
            off[i] = 0.0;
            off[1 - i] = at.uncertainty_at(1 - i, widths);
        }
        let point = self.told_of(&at.solved, number, label, place);
        point.placed(self.curve.system.family, off)
    }

    /// The same without what its parameters may be off by.
    fn told_of(
        &self,
        solved: &Solved,
        number: usize,
        label: Option<Label>,
        at: [f64; 2],
    ) -> GeneralPoint {
        let Solved { connection, linear } = solved;
        let splitting = &linear.splitting;
        // What is rounding beside the orbit is 0.
        let sizes = connection.sizes();
        let rounded = |x: &Vector| {
            x.zip_map(&sizes, |x, size| {
                if x.abs() < f64::EPSILON * size {
                    0.0
                } else {
                    x
                }
            })
        };
        let solution = GeneralSolution::Equilibrium {
            state: rounded(&connection.saddle),
            eigenvalues: splitting.eigenvalues.clone(),
        };
        GeneralPoint {
            label,
            note: label.map(|_| splitting.consequence().to_owned()),
            saddle_node: splitting.kind != Kind::Saddle,
            ..GeneralPoint::new(number, at, solution)
        }
    }

    /// A point that may be off along the curve as well.
    fn off_along(&self, point: GeneralPoint, at: &HomoclinicPoint, along: f64) -> GeneralPoint {
        let widths = widths(self.curve);
        let across = at.uncertainty(widths);
        let layout = at.layout();
        let off = |i: usize| across[i] + at.tangent[layout.parameter(i)].abs() * along * widths[i];
        point.placed(self.curve.system.family, [0, 1].map(off))
    }

    /// The Bogdanov-Takens point that the curve has come to: there the orbit shrinks to a point.
    fn double_zero(&mut self, at: &HomoclinicPoint, number: usize) -> Option<GeneralPoint> {
        /// How near it is, in parts of the ranges.
        const NEAR: f64 = 3e-3;
        let curve = self.curve;
        let all = self.double_zeros.get_or_insert_with(|| {
            let mut found = Vec::new();
            let folds = GeneralCurve {
                begin: None,
                at: [Vec::new(), Vec::new()],
                ..curve.clone()
            };
            let fold = EquilibriumBifurcation::Fold;
            // Without its folds the curve is followed as far as it goes.
            let _ = equilibrium_curves(&folds, fold, &mut |event| {
                if let GeneralEvent::Special(point) = event
                    && point.label == Some(Label::Bt)
                {
                    found.push(point);
                }
                Continue(())
            });
            found
        });
        let widths = widths(curve);
        let here = &at.solved.connection;
        let sizes = here.sizes();
        let distance = |point: &GeneralPoint| {
            let each = [0, 1].map(|i| (point.at[i] - here.at[i]) / widths[i]);
            each[0].hypot(each[1])
        };
        let is_near = |point: &&GeneralPoint| {
            let GeneralSolution::Equilibrium { state, .. } = &point.solution else {
                return false;
            };
            // Both the equilibrium and the orbit's extent shrink as the distance does, or its root.
            let away = (state - &here.saddle).component_div(&sizes).amax();
            distance(point) < NEAR && away < 2.0
        };
        let near = all.iter().find(is_near)?;
        Some(GeneralPoint {
            number,
            note: Some("the orbit shrinks to this point".to_owned()),
            ..near.clone()
        })
    }
}

/// The widths of both ranges.
fn widths(curve: &GeneralCurve<'_>) -> [f64; 2] {
    curve.ranges.map(|(a, b)| (b - a).abs())
}
