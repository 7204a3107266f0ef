//! Derivatives of a periodic orbit in a parameter: of its period, of the least and the largest value of each variable, and of the
//! logarithms of its multipliers.
//!
//! The nodes and the period follow from the linear equations of the closed shooting, with the derivatives of the arcs' ends in the parameter on the
//! right-hand side (the implicit function theorem); an extreme moves as the orbit does at the moment at which it is taken. Those of the
//! multipliers have second derivatives of the flow in them: they are central differences between orbits at parameters to both sides, closed anew from where
//! these derivatives say, extrapolated to a step of nothing (Ridders, C. J. F. (1982). Accurate computation of F'(x) and F'(x) F''(x). Advances in Engineering
//! Software 4, 75-76).

use super::arc::{Arc, Tracer};
use super::extremes::extremes;
use super::family::ParametrisedField;
use super::floquet::{Floquet, Kind, Multiplier, TANGENT as CLAIMED, around, volume};
use super::linear::{Free, Linear};
use super::no_orbit;
use super::noise::{PROBES, Signs, TANGENT, graded};
use super::shooting::close;
use super::shooting_nodes::ShootingNodes;
use super::solve::{Orbit, OrbitAccuracy, SHIFTS, SPREAD};
use crate::error::{Error, Result};
use crate::field::Vector;
use crate::integrate::Choice;
use crate::number::Uncertain;

/// ln |mu| within clusters of an orbit at these coordinates of the parameters.
pub type WithinAt<'a> = &'a dyn Fn([f64; 2], &ShootingNodes) -> Result<Vec<f64>>;

/// What an orbit's numbers change by with a parameter.
#[derive(Debug, Clone, PartialEq)]
pub struct Sensitivity {
    /// Of the period.
    pub period: Uncertain,
    /// Of the least and the largest value of every variable.
    pub extremes: Vec<[Uncertain; 2]>,
    /// Of ln |mu| of the multipliers, in the order of the orbit's; `None` of what is below the floor.
    pub ln_abs: Vec<Option<Uncertain>>,
    /// The same of those within clusters.
    pub within: Vec<Uncertain>,
}

/// The families that an orbit is one of. The parameter is the first of their planes.
pub struct Families<'a> {
    /// Of the variables that the orbit is in.
    pub own: &'a dyn ParametrisedField,
    /// Of an orbit in (tau, ln psi) of two interfaces that move alike, in the variables of both.
    pub whole: Option<&'a dyn ParametrisedField>,
    /// What the multipliers within clusters are at these coordinates along these nodes, where there are any.
    pub within: Option<WithinAt<'a>>,
}

impl<'a> Families<'a> {
    /// The only one.
    pub fn of(own: &'a dyn ParametrisedField) -> Self {
        Families {
            own,
            whole: None,
            within: None,
        }
    }
}

/// Standard deviations that are claimed of noise.
const DEVIATIONS: f64 = 3.0;
/// How far an orbit is moved at first, in its extents, parts of its durations and coordinates of the parameter; by which factor less far each time;
/// how often.
const FARTHEST: f64 = 0.05;
const NEARER: f64 = 1.6;
const LEVELS: usize = 7;
/// How often there may be no orbit before one is found.
const FAILURES: usize = 16;
/// An orbit whose period is off by more, in parts of the change, is another one.
const ELSEWHERE: f64 = 0.5;

/// The derivatives of an orbit at these coordinates, in the parameter.
///
/// # Errors
/// [`Error::NoOrbit`] for one of a family of orbits of the same parameters, which is not the same one at others; those of the flow.
pub fn sensitivity(
    families: &Families<'_>,
    at: [f64; 2],
    orbit: &Orbit,
    accuracy: &OrbitAccuracy,
) -> Result<Sensitivity> {
    let family = families.own;
    let field = family.field(at);
    let mut tracer = tracer(accuracy)?;
    // What has no derivatives in parameters is no method for this.
    let accuracy = &match tracer.differentiates() {
        true => *accuracy,
        false => OrbitAccuracy::of(Choice::Taylor).stepping(accuracy.tolerances.max_step),
    };
    tracer = self::tracer(accuracy)?;
    let shooting = close(&mut tracer, &field, orbit.clone().beginning().shooting)?.shooting;
    let motion = Motion::new(&mut tracer, (family, at), shooting, accuracy)?;
    let noise = motion.noise().ok_or_else(undetermined)?;
    let mut apart = vec![0.0_f64; noise.len()];
    for shift in SHIFTS {
        let looser = accuracy.looser();
        let mut other = self::tracer(&looser)?;
        let moved = motion.shooting.shifted(&mut other, &field, shift)?;
        let moved = close(&mut other, &field, moved)?.shooting;
        let again = Motion::new(&mut other, (family, at), moved, &looser)?;
        let pairs = motion.numbers().into_iter().zip(again.numbers());
        for (apart, (one, other)) in apart.iter_mut().zip(pairs) {
            *apart = apart.max((one - other).abs());
        }
    }
    // In the parameter itself.
    let per = 1.0 / family.scale(at)[0];
    let of_parameter = |x: Uncertain| Uncertain::new(x.value * per, x.uncertainty * per.abs());
    let numbers = motion.numbers().into_iter().zip(noise).zip(apart);
    let mut numbers = numbers.map(|((value, noise), apart)| {
        let rounding = 4.0 * f64::EPSILON * value.abs();
        let off = DEVIATIONS * noise + SPREAD * apart + rounding;
        of_parameter(Uncertain::new(value, off))
    });
    let period = numbers.next().ok_or_else(undetermined)?;
    let ends: Vec<Uncertain> = numbers.collect();
    let (ln_abs, within) = logarithms(families, at, &motion, &mut tracer, &orbit.floquet)?;
    Ok(Sensitivity {
        period,
        extremes: ends.chunks_exact(2).map(|two| [two[0], two[1]]).collect(),
        ln_abs: ln_abs.into_iter().map(|x| x.map(of_parameter)).collect(),
        within: within.into_iter().map(of_parameter).collect(),
    })
}

fn tracer(accuracy: &OrbitAccuracy) -> Result<Tracer> {
    Tracer::new(accuracy.method, accuracy.tolerances, accuracy.max_steps)
}

fn undetermined() -> Error {
    no_orbit(
        "the orbit has no derivatives in parameters: a second multiplier is 1, as on a family of orbits".into(),
        "ask for them at other parameters",
    )
}

/// How a closed shooting moves with the coordinate of the parameter.
struct Motion {
    shooting: ShootingNodes,
    linear: Linear,
    /// Of every node, and of every duration.
    nodes: Vec<Vector>,
    durations: Vec<f64>,
    /// The arcs from the nodes before to the extremes of every variable, and on which arc each is; `None` of what stands at a node.
    ends: Vec<[(usize, Option<Arc>); 2]>,
    /// The variable whose extremes a forcing fixes.
    phase: Option<usize>,
    /// The derivative of the parameter in its coordinate.
    scale: f64,
}

impl Motion {
    fn new(
        tracer: &mut Tracer,
        (family, at): (&dyn ParametrisedField, [f64; 2]),
        shooting: ShootingNodes,
        accuracy: &OrbitAccuracy,
    ) -> Result<Self> {
        let (field, scale) = (&family.field(at), family.scale(at)[0]);
        let free = Free {
            of_plane: &[0],
            plane: family.plane(),
        };
        let linear = Linear::of(tracer, family, field, &shooting, free)?;
        let gaps = linear.arcs.iter().map(|arc| pull(arc) * scale);
        let gaps: Vec<Vector> = gaps.collect();
        let (nodes, durations) = linear.correction(&gaps).ok_or_else(undetermined)?;
        let moments = extremes(field, &shooting, None, accuracy)?.moments;
        let place = [free.plane[0]];
        let mut end = |i: usize, (k, time): (usize, f64)| -> Result<(usize, Option<Arc>)> {
            let start = &shooting.nodes[k];
            let mut arc_to = |time: f64| match time > 0.0 {
                true => tracer.arc(field, start, time, &place).map(Some),
                false => Ok(None),
            };
            let arc = arc_to(time)?;
            // Rounding of a largest value says little of its time: the rate is zero there.
            let there = arc.as_ref().map_or(start, |arc| &arc.end);
            let rate = field.f(there);
            let later = -rate[i] / (field.jacobian(there) * &rate)[i];
            if later.abs() < NEAR * shooting.durations[k] && later != 0.0 {
                return Ok((k, arc_to(time + later)?));
            }
            Ok((k, arc))
        };
        let mut ends = Vec::with_capacity(moments.len());
        for (i, [least, most]) in moments.into_iter().enumerate() {
            ends.push([end(i, least)?, end(i, most)?]);
        }
        Ok(Motion {
            phase: field.phase().map(|(place, _)| place),
            shooting,
            linear,
            nodes,
            durations,
            ends,
            scale,
        })
    }

    /// What the period changes by, and the least and the largest value of each variable.
    fn numbers(&self) -> Vec<f64> {
        self.numbers_of(&self.nodes, &self.durations, &mut |_, _, _| 0.0, self.scale)
    }

    /// The same of other motions of the nodes, with this part of what the parameter alone does along the arcs, and with errors at their ends.
    fn numbers_of(
        &self,
        nodes: &[Vector],
        durations: &[f64],
        error: &mut dyn FnMut(&Arc, &Vector, usize) -> f64,
        part: f64,
    ) -> Vec<f64> {
        let mut numbers = vec![durations.iter().sum()];
        for (i, ends) in self.ends.iter().enumerate() {
            for (k, arc) in ends {
                numbers.push(match arc {
                    _ if self.phase == Some(i) => 0.0,
                    None => nodes[*k][i],
                    Some(arc) => {
                        let moved = &arc.tangent * &nodes[*k] + pull(arc) * part;
                        moved[i] + error(arc, &self.nodes[*k], i)
                    }
                });
            }
        }
        numbers
    }

    /// The standard deviations that rounding makes of the numbers.
    fn noise(&self) -> Option<Vec<f64>> {
        let mut squares = vec![0.0; 1 + 2 * self.ends.len()];
        let mut signs = Signs::new();
        for _ in 0..PROBES {
            let gaps = self.linear.arcs.iter().zip(&self.nodes);
            let gaps = gaps.map(|(arc, moved)| {
                let sizes = self.sizes(arc, moved);
                sizes.map(|size| size * signs.next())
            });
            let gaps: Vec<Vector> = gaps.collect();
            let (nodes, durations) = self.linear.correction(&gaps)?;
            let mut error =
                |arc: &Arc, moved: &Vector, i: usize| self.sizes(arc, moved)[i] * signs.next();
            let numbers = self.numbers_of(&nodes, &durations, &mut error, 0.0);
            for (square, number) in squares.iter_mut().zip(numbers) {
                *square += number * number;
            }
        }
        let deviation = |square: f64| (square / PROBES as f64).sqrt();
        Some(squares.into_iter().map(deviation).collect())
    }

    /// What rounding makes of the motion of an arc's end.
    fn sizes(&self, arc: &Arc, moved: &Vector) -> Vector {
        let pull = pull(arc).abs() * self.scale.abs();
        let norm = arc.tangent.norm().max(f64::MIN_POSITIVE);
        let passed = arc.tangent.abs() * &pull / norm;
        let sum = graded(&arc.tangent) * moved.abs() + pull.sup(&passed);
        sum * (TANGENT * arc.rounding())
    }

    /// How far the orbit is moved with the coordinate, in its extents and in parts of its durations.
    fn speed(&self) -> f64 {
        let extents = self.shooting.sizes();
        let nodes = self
            .nodes
            .iter()
            .map(|dx| dx.component_div(&extents).amax());
        let durations = self.durations.iter().zip(&self.shooting.durations);
        let stretches = durations.map(|(dt, t)| (dt / t).abs());
        nodes.chain(stretches).fold(1.0, f64::max)
    }
}

/// A correction of the time of an extreme that is a longer part of its arc is none.
const NEAR: f64 = 1e-3;

/// What the parameter alone moves the end of an arc by, per parameter.
fn pull(arc: &Arc) -> Vector {
    arc.parameters.column(0).into_owned()
}

/// The derivatives of the logarithms of the multipliers, and of those within clusters, in the coordinate.
fn logarithms(
    families: &Families<'_>,
    at: [f64; 2],
    motion: &Motion,
    tracer: &mut Tracer,
    known: &Floquet,
) -> Result<(Vec<Option<Uncertain>>, Vec<Uncertain>)> {
    let mut farthest = FARTHEST / motion.speed();
    let mut found: Vec<(f64, Vec<(f64, f64)>)> = Vec::new();
    let (mut failed, mut failures) = (None, 0);
    while found.len() < LEVELS {
        let mut both = [farthest, -farthest].map(|step| {
            let there = [at[0] + step, at[1]];
            beside(families, (there, step), motion, tracer, known)
        });
        match &mut both {
            [Ok(above), Ok(below)] => {
                let slopes = above.iter().zip(below.iter()).map(|(a, b)| {
                    let slope = (a.value - b.value) / (2.0 * farthest);
                    // The differences between the levels show what is lost as well: once is enough of what bounds count several times.
                    let bounds = a.uncertainty + b.uncertainty;
                    let noise = bounds / (2.0 * farthest * CLAIMED);
                    (slope, noise)
                });
                found.push((farthest, slopes.collect()));
            }
            [Err(error), _] | [_, Err(error)] => {
                // Farther away there need be no orbit.
                failed = Some(error.clone());
                farthest /= NEARER;
                failures += 1;
                if !found.is_empty() || failures > FAILURES {
                    break;
                }
            }
        }
        farthest /= NEARER;
    }
    if found.is_empty() {
        return Err(failed.unwrap_or_else(undetermined));
    }
    let count = known.multipliers.len();
    let all = (0..count + known.within.len()).map(|j| {
        let slopes: Vec<(f64, f64)> = found.iter().map(|(_, slopes)| slopes[j]).collect();
        extrapolated(&slopes)
    });
    let mut all: Vec<Uncertain> = all.collect();
    let within = all.split_off(count);
    let of_known = all.into_iter().zip(&known.multipliers);
    let ln_abs = of_known.map(|(slope, one)| {
        (one.kind != Kind::BelowFloor && slope.value.is_finite()).then_some(slope)
    });
    Ok((ln_abs.collect(), within))
}

/// The logarithms of the multipliers in the order of those that are known, and of those within clusters, with their noise, of the orbit a step away.
fn beside(
    families: &Families<'_>,
    (at, step): ([f64; 2], f64),
    motion: &Motion,
    tracer: &mut Tracer,
    known: &Floquet,
) -> Result<Vec<Uncertain>> {
    let moved = motion
        .shooting
        .moved(&motion.nodes, &motion.durations, step);
    let field = families.own.field(at);
    let (expected, known_period) = (moved.period(), motion.shooting.period());
    // Not the linear motion itself: where a slow arc ends in a fast one, what is left to second order of its duration is as long as the fast one.
    let closed = close(tracer, &field, moved)?;
    let (shooting, linear) = (closed.shooting, closed.linear);
    let off = (shooting.period() - expected).abs();
    if off
        > ELSEWHERE
            * (expected - known_period)
                .abs()
                .max(step.abs() * expected.abs())
    {
        return Err(undetermined());
    }
    let multipliers = match families.whole {
        None => around(&shooting.nodes, &linear, &field).multipliers,
        Some(whole) => {
            let field = whole.field(at);
            let along = shooting.nodes.iter().zip(&shooting.durations);
            let arcs = along.map(|(x, &duration)| {
                let both = Vector::from_column_slice(&[x[0], x[1], x[1]]);
                tracer.arc(&field, &both, duration, &[])
            });
            let all = volume(&arcs.collect::<Result<Vec<_>>>()?).0;
            let within = volume(&linear.arcs).0;
            let off = all.uncertainty + within.uncertainty;
            let across = Uncertain::new(all.value - within.value, off);
            vec![Multiplier::positive(within), Multiplier::positive(across)]
        }
    };
    let mut logs = matched(known, &multipliers);
    if let Some(within) = families.within {
        let rounding = |x: f64| Uncertain::new(x, 4.0 * f64::EPSILON * (1.0 + x.abs()));
        logs.extend(within(at, &shooting)?.into_iter().map(rounding));
    }
    Ok(logs)
}

/// Of each of the known multipliers the one that is it nearby.
fn matched(known: &Floquet, found: &[Multiplier]) -> Vec<Uncertain> {
    let mut left: Vec<&Multiplier> = found.iter().collect();
    let one = |one: &Multiplier| {
        let off = |other: &Multiplier| {
            let turned = (one.angle_over_pi - other.angle_over_pi).abs();
            (one.ln_abs.value - other.ln_abs.value).abs() + turned
        };
        let nearest = (0..left.len()).min_by(|&i, &j| off(left[i]).total_cmp(&off(left[j])));
        nearest.map_or(Uncertain::new(f64::NAN, f64::INFINITY), |i| {
            left.swap_remove(i).ln_abs
        })
    };
    known.multipliers.iter().map(one).collect()
}

/// What central differences tend to, each with a step smaller by the same factor than the one before, and with the bounds of their noise: the value of the
/// tableau whose neighbours are nearest.
fn extrapolated(slopes: &[(f64, f64)]) -> Uncertain {
    let mut best = Uncertain::new(slopes[0].0, f64::INFINITY);
    let mut before: Vec<f64> = Vec::new();
    for &(slope, noise) in slopes {
        let mut row = vec![slope];
        let mut factor = 1.0;
        for k in 0..before.len() {
            factor *= NEARER * NEARER;
            let better = row[k] + (row[k] - before[k]) / (factor - 1.0);
            let off = (better - row[k]).abs().max((better - before[k]).abs());
            let off = SPREAD * off + noise + 4.0 * f64::EPSILON * better.abs();
            if off < best.uncertainty {
                best = Uncertain::new(better, off);
            }
            row.push(better);
        }
        before = row;
    }
    best
}
