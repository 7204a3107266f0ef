//! Floquet multipliers of a closed shooting, by their logarithms.
//!
//! A plain monodromy matrix is noise below 1e-14 of its norm, where relaxation orbits have multipliers of 1e-22 and 1e-75.
//! So the maps of the arcs are kept apart. Their determinants come from Liouville's theorem, ln det = integral of tr J, a
//! quadrature beside the tangents; the larger one of two multipliers from the trace of the product with a budget of its own,
//! and where cancellation leaves nothing of the trace from the growth along its direction; the smaller one from both. More than
//! two are those of the periodic Schur form ([`multipliers`]).
//!
//! On a symmetric orbit, which lies in two dimensions, both are quadratures: the integral of the trace there, and that of the
//! antisymmetric mode, the difference of the traces in three dimensions and in two.

use super::arc::Arc;
use super::correct::Regular;
use super::linear::Linear;
use super::multipliers::multipliers;
use super::shooting::Closed;
use crate::equilibrium::Verdict;
use crate::field::{Matrix, Vector};
use crate::integrate::AnyField;
use crate::number::Uncertain;
use nalgebra::{Complex, Matrix2, Vector2};

/// What a multiplier is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// A real number.
    Real,
    /// One of a conjugate pair.
    Complex,
    /// Too small beside the other one to be told from the noise of the method; `ln_abs` then is a bound.
    BelowFloor,
}

impl Kind {
    /// In a word or two.
    pub fn name(self) -> &'static str {
        match self {
            Kind::Real => "real",
            Kind::Complex => "complex",
            Kind::BelowFloor => "below floor",
        }
    }
}

/// A nontrivial multiplier.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Multiplier {
    /// ln |mu|.
    pub ln_abs: Uncertain,
    /// arg mu / pi, between 0 and 1: 0 for a positive number, 1 for a negative one.
    pub angle_over_pi: f64,
    /// Real, complex, or not known.
    pub kind: Kind,
}

impl Multiplier {
    fn real(ln_abs: f64, uncertainty: f64, negative: bool) -> Self {
        Multiplier {
            ln_abs: Uncertain::new(ln_abs, uncertainty),
            angle_over_pi: if negative { 1.0 } else { 0.0 },
            kind: Kind::Real,
        }
    }

    /// A positive number.
    pub(super) fn positive(ln_abs: Uncertain) -> Self {
        Multiplier::real(ln_abs.value, ln_abs.uncertainty, false)
    }

    /// arg mu / pi, where it is known.
    pub fn known_angle(&self) -> Option<f64> {
        (self.kind != Kind::BelowFloor).then_some(self.angle_over_pi)
    }

    /// mu itself; zero where its logarithm is below what a double holds.
    pub fn value(&self) -> Complex<f64> {
        let size = self.ln_abs.value.exp();
        match self.kind {
            Kind::Complex => Complex::from_polar(size, std::f64::consts::PI * self.angle_over_pi),
            _ if self.angle_over_pi == 1.0 => Complex::new(-size, 0.0),
            _ => Complex::new(size, 0.0),
        }
    }
}

/// A multiplier of states in which the interfaces of a cluster, which move alike on the orbit, part.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WithinCluster {
    /// Which cluster, from 1.
    pub cluster: usize,
    /// How many multipliers are this one.
    pub multiplicity: usize,
    /// ln mu; mu is positive.
    pub ln_abs: Uncertain,
}

/// The multipliers of an orbit.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Floquet {
    /// The nontrivial ones, the largest first; of a complex pair the one with positive imaginary part.
    pub multipliers: Vec<Multiplier>,
    /// Of interfaces in clusters those across each cluster that can split.
    pub within: Vec<WithinCluster>,
    /// How far the trivial multiplier is from 1.
    pub trivial_defect: f64,
    /// Sum of the logarithms of the arcs' determinants minus the integral of the trace; `None` from methods without it.
    pub liouville_defect: Option<f64>,
}

impl Floquet {
    /// Stable if all are certainly less than 1 in absolute value, unstable if one is certainly larger.
    pub fn verdict(&self) -> Verdict {
        let mut verdict = Verdict::Stable;
        for multiplier in &self.multipliers {
            let Uncertain { value, uncertainty } = multiplier.ln_abs;
            if multiplier.kind != Kind::BelowFloor && value - uncertainty > 0.0 {
                return Verdict::Unstable;
            }
            let below = value + uncertainty < 0.0;
            if !below {
                verdict = Verdict::Undecided;
            }
        }
        for Uncertain { value, uncertainty } in self.within.iter().map(|within| within.ln_abs) {
            if value - uncertainty > 0.0 {
                return Verdict::Unstable;
            }
            if value.is_nan() || value + uncertainty >= 0.0 {
                verdict = Verdict::Undecided;
            }
        }
        verdict
    }

    /// Gives the multiplier that is next to 1 an uncertainty in which 1 is: on one of a family of orbits it is 1, and of a double one rounding
    /// takes half of the digits.
    pub(super) fn one_is_one(&mut self) {
        let distance = |multiplier: &Multiplier| multiplier.ln_abs.value.abs();
        let known = self
            .multipliers
            .iter_mut()
            .filter(|one| one.kind != Kind::BelowFloor);
        if let Some(one) = known.min_by(|a, b| distance(a).total_cmp(&distance(b))) {
            one.ln_abs.uncertainty += 2.0 * distance(one);
        }
    }

    /// Every uncertainty so many times.
    pub(super) fn widened(&mut self, times: f64) {
        for multiplier in &mut self.multipliers {
            multiplier.ln_abs.uncertainty *= times;
        }
    }

    /// Claims nothing.
    pub(super) fn doubt(&mut self) {
        for multiplier in &mut self.multipliers {
            multiplier.ln_abs.uncertainty = f64::INFINITY;
        }
    }

    /// Widens every uncertainty by what another computation differs, a few times over. A single difference can be small by chance:
    /// of many multipliers none counts as less, in units of its uncertainty, than the root mean square of all.
    pub fn widened_by(&mut self, other: &Floquet) {
        /// How many times.
        const MARGIN: f64 = 3.0;
        /// So many differences have a mean square.
        const MANY: usize = 3;
        let differences = self.multipliers.iter().zip(&other.multipliers);
        let differences = differences.map(|(mine, its)| match its.kind {
            Kind::BelowFloor => 0.0,
            _ => (mine.ln_abs.value - its.ln_abs.value).abs(),
        });
        let differences: Vec<_> = differences.collect();
        let known = self.multipliers.iter().zip(&differences);
        let in_units = known
            .filter(|(mine, difference)| mine.ln_abs.uncertainty.is_normal() && **difference > 0.0);
        let squares =
            in_units.map(|(mine, difference)| (difference / mine.ln_abs.uncertainty).powi(2));
        let squares: Vec<_> = squares.collect();
        let least = if squares.len() < MANY {
            0.0
        } else {
            (squares.iter().sum::<f64>() / squares.len() as f64).sqrt()
        };
        for (mine, difference) in self.multipliers.iter_mut().zip(differences) {
            let uncertainty = &mut mine.ln_abs.uncertainty;
            *uncertainty += MARGIN * difference.max(least * *uncertainty);
        }
    }
}

/// Relative error of a tangent in units of that of the state: it loses two digits more at most.
pub(super) const TANGENT: f64 = 10.0;
/// Times around for a direction to settle.
const TURNS: usize = 30;
/// Change of a direction once around that counts as settled.
const SETTLED: f64 = 1e-12;

/// The sums of the logarithms of the determinants: by the best the method has, and its uncertainty; and their defect.
pub(super) fn volume(arcs: &[Arc]) -> (Uncertain, Option<f64>) {
    let by_matrix: f64 = arcs.iter().map(|arc| arc.tangent_volume()).sum();
    let by_trace: Option<f64> = arcs.iter().map(|arc| arc.log_determinant).sum();
    match by_trace {
        Some(volume) => {
            let scale = arcs.iter().filter_map(|arc| arc.log_determinant);
            let scale = scale.fold(1.0, |sum, x| sum + x.abs());
            let quadrature: f64 = arcs.iter().map(|arc| arc.volume_error).sum();
            let off = TANGENT * noise(arcs) + f64::EPSILON * scale + quadrature;
            // A tangent that has shrunk to nothing has no determinant to compare with.
            let defect = Some(by_matrix - volume).filter(|defect| defect.is_finite());
            (Uncertain::new(volume, off), defect)
        }
        None => {
            // The smallest direction of an arc errs by the norm over it.
            let loss = arcs.iter().map(|arc| arc.noise() * arc.loss().exp());
            (Uncertain::new(by_matrix, TANGENT * together(loss)), None)
        }
    }
}

/// Independent errors together.
fn together(errors: impl Iterator<Item = f64>) -> f64 {
    errors.map(|error| error * error).sum::<f64>().sqrt()
}

/// The noise of all arcs.
fn noise(arcs: &[Arc]) -> f64 {
    together(arcs.iter().map(Arc::noise))
}

/// f at the next node over f carried there: the trivial multiplier of every arc, and their product minus 1.
fn trivial_defect(nodes: &[Vector], arcs: &[Arc], field: &AnyField<'_>) -> f64 {
    let flows: Vec<_> = nodes.iter().map(|x| field.f(x)).collect();
    let logs = arcs.iter().enumerate().map(|(k, arc)| {
        let next = &flows[(k + 1) % flows.len()];
        let carried = &arc.tangent * &flows[k];
        (next.dot(&carried) / next.norm_squared()).abs().ln()
    });
    logs.sum::<f64>().exp_m1().abs()
}

/// The multipliers of an orbit in the space of its field.
///
/// # Panics
/// Where the field has another number of variables.
pub fn floquet(closed: &Closed, field: &AnyField<'_>) -> Floquet {
    around(&closed.shooting.nodes, &closed.linear, field)
}

impl Regular {
    /// Its multipliers in the space of its field.
    ///
    /// # Panics
    /// Where the field has another number of variables.
    pub fn floquet(&self, field: &AnyField<'_>) -> Floquet {
        around(&self.site.shooting.nodes, &self.linear, field)
    }
}

/// The same by a linearisation at these nodes.
pub(super) fn around(nodes: &[Vector], linear: &Linear, field: &AnyField<'_>) -> Floquet {
    let Linear { arcs, maps, .. } = linear;
    let (volume, liouville_defect) = volume(arcs);
    let errors: Vec<f64> = arcs.iter().map(Arc::noise).collect();
    let multipliers = match linear.dimension() {
        2 => vec![Multiplier::real(volume.value, volume.uncertainty, false)],
        3 => pair(maps, &errors, volume),
        _ => multipliers(maps, &errors, volume),
    };
    Floquet {
        multipliers,
        within: Vec::new(),
        trivial_defect: trivial_defect(nodes, arcs, field),
        liouville_defect,
    }
}

/// The multipliers of an orbit in the symmetric subspace: across it, from the arcs of the whole space along its nodes.
///
/// # Panics
/// Where the field has other than two variables, or these arcs other than three.
pub fn symmetric_floquet(closed: &Closed, field: &AnyField<'_>, across: &[Arc]) -> Floquet {
    let (within, within_defect) = volume(closed.arcs());
    // The antisymmetric mode (0, 1, -1) stays one.
    let by_matrix: f64 = across
        .iter()
        .map(|arc| (arc.tangent[(1, 1)] - arc.tangent[(1, 2)]).abs().ln())
        .sum();
    let whole: Option<f64> = across.iter().map(|arc| arc.log_determinant).sum();
    let (value, defect) = match whole {
        Some(whole) => (
            whole - within.value,
            Some(by_matrix - (whole - within.value)),
        ),
        None => (by_matrix, None),
    };
    let loss = match whole {
        Some(_) => TANGENT * noise(across) + f64::EPSILON * value.abs(),
        None => {
            let loss = across.iter().map(|arc| {
                let mode = (arc.tangent[(1, 1)] - arc.tangent[(1, 2)]).abs();
                arc.noise() * (arc.tangent.norm() / mode).max(1.0)
            });
            TANGENT * together(loss)
        }
    };
    let mut multipliers = vec![
        Multiplier::real(within.value, within.uncertainty, false),
        Multiplier::real(value, loss + within.uncertainty, false),
    ];
    multipliers.sort_by(|a, b| b.ln_abs.value.total_cmp(&a.ln_abs.value));
    let larger = |a: Option<f64>, b: Option<f64>| Some(a?.abs().max(b?.abs()));
    Floquet {
        multipliers,
        within: Vec::new(),
        trivial_defect: trivial_defect(&closed.shooting.nodes, closed.arcs(), field),
        liouville_defect: larger(within_defect, defect),
    }
}

/// A matrix times e^log.
#[derive(Debug, Clone, Copy)]
struct Scaled {
    matrix: Matrix2<f64>,
    log: f64,
}

impl Scaled {
    fn identity() -> Self {
        Scaled {
            matrix: Matrix2::identity(),
            log: 0.0,
        }
    }

    fn normalised(matrix: Matrix2<f64>, log: f64) -> Self {
        let size = matrix.norm();
        if size == 0.0 {
            return Scaled { matrix, log };
        }
        Scaled {
            matrix: matrix / size,
            log: log + size.ln(),
        }
    }
}

/// Both multipliers of maps of two dimensions, whose relative errors are given, with the logarithm of their product known.
pub fn pair(maps: &[Matrix], errors: &[f64], volume: Uncertain) -> Vec<Multiplier> {
    let maps: Vec<_> = maps
        .iter()
        .map(|map| Matrix2::from_fn(|i, j| map[(i, j)]))
        .collect();
    // Of the first k maps, and of those after the k-th.
    let mut before = vec![Scaled::identity()];
    for map in &maps {
        let last = before[before.len() - 1];
        before.push(Scaled::normalised(map * last.matrix, last.log));
    }
    let mut after = vec![Scaled::identity()];
    for map in maps.iter().rev() {
        let last = after[after.len() - 1];
        after.push(Scaled::normalised(last.matrix * map, last.log));
    }
    after.reverse();
    let product = before[maps.len()];
    // The trace in units of sqrt(det): both multipliers are real where it is above 2.
    let half = 0.5 * volume.value;
    let trace = product.matrix.trace() * (product.log - half).exp();
    let of_maps = maps.iter().enumerate().map(|(k, map)| {
        let log = before[k].log + after[k + 1].log - half;
        log.exp() * map.norm() * TANGENT * errors[k]
    });
    let error = trace.abs() * 0.5 * volume.uncertainty + together(of_maps);
    if !(trace.is_finite() && error.is_finite()) || error > 0.5 * trace.abs().max(2.0) {
        return along_direction(&maps, errors, volume);
    }
    let uncertain = 0.5 * volume.uncertainty;
    if trace.abs() - error > 2.0 {
        // mu = sqrt(det) e^(+-x), tr = 2 cosh x in these units
        let x = (0.5 * trace.abs()).acosh();
        let of_x = 0.5 * error / (0.25 * trace * trace - 1.0).sqrt();
        let negative = trace < 0.0;
        let budget = uncertain + of_x;
        return vec![
            Multiplier::real(half + x, budget, negative),
            Multiplier::real(half - x, budget, negative),
        ];
    }
    if trace.abs() + error < 2.0 {
        let angle = (0.5 * trace).acos() / std::f64::consts::PI;
        let one = Multiplier {
            ln_abs: Uncertain::new(half, uncertain),
            angle_over_pi: angle,
            kind: Kind::Complex,
        };
        return vec![one, one];
    }
    // Within the error of a double multiplier.
    let apart = (0.5 * (trace.abs() + error)).max(1.0).acosh();
    let one = Multiplier::real(half, uncertain + apart, trace < 0.0);
    vec![one, one]
}

/// The same where the trace is lost to cancellation: the growth along the direction that dominates, carried around until it
/// repeats, and along its dual.
fn along_direction(maps: &[Matrix2<f64>], errors: &[f64], volume: Uncertain) -> Vec<Multiplier> {
    let count = maps.len();
    let floor = || {
        let bound = maps.iter().map(|map| map.norm().ln()).sum::<f64>();
        let bound = bound.min(0.0).max(volume.value);
        let one = Multiplier {
            ln_abs: Uncertain::new(bound, 0.0),
            angle_over_pi: 0.0,
            kind: Kind::BelowFloor,
        };
        vec![one, one]
    };
    let of_length_one = |x: Vector2<f64>| {
        let size = x.norm();
        (size > 0.0).then(|| (x / size, size))
    };
    let Some((mut x, _)) = of_length_one(Vector2::new(1.0 / 2.0, 1.0 / 3.0)) else {
        return floor();
    };
    let mut directions = vec![x; count];
    let (mut log, mut settled, mut sign) = (0.0, false, 1.0);
    for _ in 0..TURNS {
        let begin = x;
        log = 0.0;
        for k in 0..count {
            directions[k] = x;
            let Some((next, size)) = of_length_one(maps[k] * x) else {
                return floor();
            };
            log += size.ln();
            x = next;
        }
        sign = x.dot(&begin).signum();
        if (x * sign - begin).norm() < SETTLED {
            settled = true;
            break;
        }
    }
    let Some((mut y, _)) = of_length_one(x) else {
        return floor();
    };
    let mut duals = vec![y; count];
    for _ in 0..2 {
        for k in (0..count).rev() {
            duals[k] = y;
            let Some((next, _)) = of_length_one(maps[k].tr_mul(&y)) else {
                return floor();
            };
            y = next;
        }
    }
    let error = together((0..count).map(|k| {
        let seen = duals[k].dot(&(maps[k] * directions[k])).abs();
        TANGENT * errors[k] * maps[k].norm() / seen
    }));
    let smaller = volume.value - log;
    if !settled || !error.is_finite() || error > 0.5 || smaller > log {
        return floor();
    }
    vec![
        Multiplier::real(log, error, sign < 0.0),
        Multiplier::real(smaller, error + volume.uncertainty, sign < 0.0),
    ]
}
