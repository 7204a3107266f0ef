//! Lyapunov exponents of a flow: the mean growth rates of perturbations along it.
//!
//! Perturbations are carried along short pieces of a run by its tangent flow and made orthogonal after each (Benettin et al.
//! 1980). The direction of the flow itself is kept as the first of them: in its own direction nothing grows on a bounded run,
//! which checks the tangents, and the others are measured across it, where a small exponent is not drowned by that zero.
//!
//! The points of a run err by its tolerance, all in the same way, and so would the exponents along them: a bias that no number of
//! returns averages away. So they are taken along a run of their own, as accurate as the tangents ([`record_finely`]), whatever
//! the first one was; what is left of the bias shows in the direction of the flow, where the truth is known.
//!
//! Benettin, G., Galgani, L., Giorgilli, A. and Strelcyn, J.-M. (1980). Lyapunov characteristic exponents for smooth dynamical
//! systems and for Hamiltonian systems; a method for computing all of them. Meccanica 15, 9-20 and 21-30.

use super::curve::weighted_mean;
use super::returns::{Return, ReturnRecord, See, Watching, record};
use super::surface::Surface;
use crate::error::{Error, Result};
use crate::field::{Matrix, Vector};
use crate::integrate::{
    AnyField, AnyIntegrator, Choice, Control, DerivativesAlongArcs, MAX_STEPS, Tolerances,
    of_dimension,
};
use crate::number::{self, Uncertain};
use nalgebra::{Complex, DMatrix, DVector};

/// The tolerance of the tangents, and of the run that they are taken along.
const TOLERANCE: f64 = 1e-13;
/// Blocks whose means the interval is made of, and Student's factor for 99 % with one degree of freedom less.
const BLOCKS: usize = 20;
const STUDENT: f64 = 2.861;
/// Returns needed: some for each block.
pub const FEWEST_FOR_EXPONENTS: usize = 3 * BLOCKS;
/// Part of the run over which the perturbations turn into their directions before anything is counted.
pub(crate) const ALIGNMENT: f64 = 0.1;
/// Halves whose means are this many of their intervals apart are drifting.
const DRIFT: f64 = 1.5;
/// The error of exponents relative to the largest: that of the tangents, and that of the points of the run, in tolerances.
const SYSTEMATIC: f64 = 3e-9;
const PER_ACCURACY: f64 = 100.0;
/// How many times larger the bias of an exponent may be than what is seen of it along the flow.
const BIAS: f64 = 10.0;
/// What the eigenvalues of a matrix err by, in units of its norm and of the rounding.
const EIGENVALUES: f64 = 8.0 * f64::EPSILON;

/// The Lyapunov exponents of a run, in descending order.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct LyapunovSpectrum {
    /// Exponents in one over time, each with an interval of 99 % confidence from block averages and the bias of the run. That of
    /// the flow's own direction is zero; its interval is what the run and the tangents can tell of that.
    pub exponents: Vec<Uncertain>,
    /// Whether the two halves of the run agree on all of them within these intervals. If not, there is no saying where the
    /// exponents end.
    pub converged: bool,
    /// The growth rate in the direction of the flow: zero on a bounded run that does not come to rest.
    pub along_flow: f64,
    /// What the sum of the exponents, each from its own perturbation, differs from the mean of the Jacobian's trace by
    /// (Liouville).
    pub liouville_defect: f64,
    /// The time over which the means are taken.
    pub time: f64,
}

/// Exponents as a verdict needs them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Exponents<'a> {
    /// In descending order, as many as the system has dimensions.
    pub values: &'a [Uncertain],
    /// Whether both halves of the run agree on them.
    pub converged: bool,
}

impl LyapunovSpectrum {
    /// The largest exponent but that along the flow; `None` where there is no other.
    pub fn across_flow(&self) -> Option<Uncertain> {
        let mut others = self.exponents.iter();
        others.find(|x| x.value != self.along_flow).copied()
    }

    /// As a verdict needs them.
    pub fn known(&self) -> Exponents<'_> {
        Exponents {
            values: &self.exponents,
            converged: self.converged,
        }
    }
}

/// What a part of the run does to the perturbations.
#[derive(Debug, Clone)]
pub(crate) struct GrowthSegment {
    pub time: f64,
    /// Logarithms of the growth of the orthogonal perturbations, along the flow first.
    pub growth: Vec<f64>,
    pub log_determinant: f64,
}

/// The exponents along the returns of a run that was recorded with waypoints.
///
/// The means are weighted within each block of returns ([`weighted_mean`]): where the run is regular they then converge
/// faster than any power of the number of returns. The last exponent, whose perturbations shrink the most, follows from the
/// sum of all, which is the mean of the trace.
///
/// # Errors
/// [`Error::Parameter`] for fewer than 60 returns and for those of another dimension, [`Error::NonFinite`] where the field
/// vanishes or a tangent does, and those of [`AnyIntegrator::derivatives`].
pub fn spectrum(field: &AnyField<'_>, record: &ReturnRecord) -> Result<LyapunovSpectrum> {
    let found = spectrum_watched(field, record, &mut |_| Control::Continue)?;
    Ok(found.expect("nobody stops it"))
}

/// The returns of a run from `start`, accurate enough for [`spectrum`], with waypoints. None are let pass; the accuracy that
/// `watching` tells is not used.
///
/// # Errors
/// [`Error::Parameter`] for no steps.
pub fn record_finely(
    field: &AnyField<'_>,
    start: &Vector,
    surface: &Surface,
    watching: &Watching,
    max_steps: usize,
    see: See<'_>,
) -> Result<ReturnRecord> {
    let tolerances = Tolerances::equal(TOLERANCE)?.stepping(watching.max_step);
    let mut taylor = AnyIntegrator::new(Choice::Taylor, tolerances, max_steps)?;
    let watching = Watching {
        skip: 0,
        accuracy: TOLERANCE,
        waypoints: true,
        ..*watching
    };
    Ok(record(&mut taylor, field, start, surface, &watching, see))
}

/// As [`spectrum`]; `see` is told how far it has come, after each return, and may stop it: then there is none.
///
/// # Errors
/// Those of [`spectrum`].
pub fn spectrum_watched(
    field: &AnyField<'_>,
    record: &ReturnRecord,
    see: &mut dyn FnMut(f64) -> Control,
) -> Result<Option<LyapunovSpectrum>> {
    if record.returns.len() < FEWEST_FOR_EXPONENTS {
        return Err(Error::parameter(
            "returns",
            record.returns.len(),
            "at least 60 for exponents",
        ));
    }
    for point in record.returns.iter().chain(&record.waypoints) {
        of_dimension(point.state.len(), field.dimension())?;
    }
    let Some(segments) = segments(field, record, see)? else {
        return Ok(None);
    };
    let aligned = (ALIGNMENT * segments.len() as f64) as usize;
    let relative = SYSTEMATIC.max(PER_ACCURACY * record.accuracy);
    // The flow's own growth is that of |f|, which the ends of the run alone decide.
    let speed = |point: &Return| field.f(&point.state).norm().ln();
    let returns = &record.returns[aligned..];
    let gained = speed(&returns[returns.len() - 1]) - speed(&returns[0]);
    Ok(Some(summary(&segments[aligned..], relative, gained)))
}

/// The exponents where the run is at rest: the real parts of the eigenvalues of the Jacobian, in descending order. They err by
/// what another step of Newton's method to the equilibrium changes, and by the rounding of the eigenvalues, each as far as its
/// condition lets it; without a bound where the Jacobian is not finite.
///
/// # Panics
/// Where the equilibrium has another number of components than the field has variables.
pub fn at_equilibrium(field: &AnyField<'_>, equilibrium: &Vector) -> Vec<Uncertain> {
    let here = field.jacobian(equilibrium);
    let jacobian = match field.newton_step(equilibrium.as_slice()) {
        Some(step) => field.jacobian(&(equilibrium - step)),
        None => here.clone(),
    };
    let (Some(before), Some(values)) = (eigenvalues(&here), eigenvalues(&jacobian)) else {
        return vec![Uncertain::new(0.0, f64::INFINITY); equilibrium.len()];
    };
    let exponent = |i: usize| {
        let moved = (values[i].re - before[i].re).abs();
        Uncertain::new(values[i].re, moved + rounding(&jacobian, &values, i))
    };
    (0..values.len()).map(exponent).collect()
}

/// The eigenvalues, those with the largest real part first.
fn eigenvalues(matrix: &Matrix) -> Option<Vec<Complex<f64>>> {
    let mut values = number::eigenvalues(matrix)?;
    values.sort_by(|a, b| b.re.total_cmp(&a.re));
    Some(values)
}

/// What an eigenvalue errs by: the product of the other factors J - lambda_j is what the adjugate of J - lambda_i is, and over
/// the derivative of the characteristic polynomial the condition of lambda_i. Where they coincide they err by a root.
fn rounding(matrix: &Matrix, values: &[Complex<f64>], i: usize) -> f64 {
    /// Of more variables the condition is that of the eigenvectors: the product takes the fourth power of their number, and leaves the range of doubles.
    const FEW: usize = 8;
    let (n, size) = (matrix.nrows(), matrix.norm());
    if n > FEW {
        let condition = condition(matrix, values[i]).unwrap_or(f64::INFINITY);
        // Each has the rounding of as many more steps.
        let simple = EIGENVALUES * (n as f64 / FEW as f64) * size * condition;
        return if simple.is_finite() { simple } else { size };
    }
    let matrix = matrix.map(|x| Complex::new(x, 0.0));
    let identity = DMatrix::<Complex<f64>>::identity(n, n);
    let (mut adjugate, mut slope) = (identity.clone(), 1.0);
    for (_, other) in values.iter().enumerate().filter(|(j, _)| *j != i) {
        adjugate *= &matrix - &identity * *other;
        slope *= (values[i] - other).norm();
    }
    let worst = size * EIGENVALUES.powf(1.0 / n as f64);
    let simple = EIGENVALUES * size * adjugate.norm() / slope;
    if simple.is_finite() {
        simple.min(worst)
    } else {
        worst
    }
}

/// By how much a change of the matrix may move an eigenvalue: one over the product of its unit eigenvectors from the left and from the right, which inverse
/// iteration finds.
fn condition(matrix: &Matrix, value: Complex<f64>) -> Option<f64> {
    const ITERATIONS: usize = 3;
    let n = matrix.nrows();
    // Beside the eigenvalue, for the equations to have a solution.
    let shift = value + Complex::from(EIGENVALUES * matrix.norm());
    let shifted = matrix.map(Complex::from) - DMatrix::identity(n, n) * shift;
    let vector = |matrix: DMatrix<Complex<f64>>| {
        let lu = matrix.lu();
        let mut x = DVector::from_fn(n, |k, _| Complex::from((0.7 + 1.3 * k as f64).cos()));
        for _ in 0..ITERATIONS {
            x = lu.solve(&x)?;
            x /= Complex::from(x.norm());
        }
        Some(x)
    };
    let (right, left) = (vector(shifted.clone())?, vector(shifted.adjoint())?);
    Some(1.0 / left.dotc(&right).norm())
}

/// From each return to the next; `None` if it was stopped.
fn segments(
    field: &AnyField<'_>,
    record: &ReturnRecord,
    see: &mut dyn FnMut(f64) -> Control,
) -> Result<Option<Vec<GrowthSegment>>> {
    let tolerances = Tolerances::equal(TOLERANCE)?.stepping(record.max_step);
    let mut taylor = AnyIntegrator::new(Choice::Taylor, tolerances, MAX_STEPS)?;
    let mut arcs = taylor.arcs(field, &[])?;
    let start = &record.returns[0];
    let mut frame = beginning(&field.f(&start.state));
    orthonormalise(&mut frame, start.time)?;
    let mut points = record.waypoints.iter().peekable();
    let mut segments = Vec::with_capacity(record.returns.len());
    for pair in record.returns.windows(2) {
        let (mut here, end) = (&pair[0], &pair[1]);
        let mut segment = GrowthSegment {
            time: end.time - here.time,
            growth: vec![0.0; field.dimension()],
            log_determinant: 0.0,
        };
        while here.time < end.time {
            let between = |point: &&Return| point.time < end.time;
            let next = points.next_if(between).unwrap_or(end);
            if next.time > here.time {
                carry(field, &mut arcs, (here, next), &mut frame, &mut segment)?;
                here = next;
            }
        }
        segments.push(segment);
        if see(segments.len() as f64 / record.returns.len() as f64) == Control::Stop {
            return Ok(None);
        }
    }
    Ok(Some(segments))
}

/// The flow's direction, and others that lie in no subspace that a symmetry might keep.
fn beginning(f: &Vector) -> Matrix {
    let n = f.len();
    let mut frame = Matrix::from_fn(n, n, |i, j| (0.7 + 1.3 * i as f64 + 2.1 * j as f64).cos());
    frame.set_column(0, f);
    frame
}

/// Carries the perturbations over a piece of a segment.
fn carry(
    field: &AnyField<'_>,
    arcs: &mut DerivativesAlongArcs<'_>,
    (here, next): (&Return, &Return),
    frame: &mut Matrix,
    segment: &mut GrowthSegment,
) -> Result<()> {
    let span = (0.0, next.time - here.time);
    let (end, tangent) = arcs.derivatives(span, &here.state)?;
    *frame = tangent.start * &*frame;
    let along = frame.column(0).norm().ln();
    // The flow's direction anew at each point: it would turn into one that grows.
    frame.set_column(0, &field.f(&end));
    let mut growth = orthonormalise(frame, next.time)?;
    growth[0] = along;
    for (sum, growth) in segment.growth.iter_mut().zip(growth) {
        *sum += growth;
    }
    // Taylor's method makes it.
    segment.log_determinant += tangent.log_determinant.ok_or(Error::NotAnalytic)?;
    Ok(())
}

/// Makes the columns orthonormal from the first on, twice over for what rounding leaves; the logarithms of their lengths.
fn orthonormalise(columns: &mut Matrix, t: f64) -> Result<Vec<f64>> {
    let mut lengths = vec![0.0; columns.ncols()];
    for (j, of_column) in lengths.iter_mut().enumerate() {
        let mut column = columns.column(j).into_owned();
        let mut length = 0.0;
        for _ in 0..2 {
            for i in 0..j {
                let against = columns.column(i);
                column -= against * against.dot(&column);
            }
            let norm = column.norm();
            length += norm.ln();
            column /= norm;
        }
        if !column.iter().all(|x| x.is_finite()) {
            return Err(Error::NonFinite {
                what: "a perturbation's direction",
                t,
            });
        }
        columns.set_column(j, &column);
        *of_column = length;
    }
    Ok(lengths)
}

/// The exponents, with what these growths err by in terms of the largest of them, and what |f| gained, in the logarithm: what
/// the growth along the flow differs from that by is the bias of the run.
pub(crate) fn summary(segments: &[GrowthSegment], relative: f64, gained: f64) -> LyapunovSpectrum {
    let n = segments.first().map_or(0, |segment| segment.growth.len());
    let time: f64 = segments.iter().map(|segment| segment.time).sum();
    let growth =
        |segment: &GrowthSegment| segment.growth.iter().fold(0.0_f64, |a, x| a.max(x.abs()));
    let size = segments.iter().map(growth).sum::<f64>() / time;
    let along_flow = segments
        .iter()
        .map(|segment| segment.growth[0])
        .sum::<f64>()
        / time;
    let systematic = relative * size + BIAS * (along_flow - gained / time).abs();
    let mut converged = true;
    let exponent = |i: usize| {
        if i == 0 && n > 1 {
            return Uncertain::new(along_flow, gained.abs() / time + systematic);
        }
        let of = |segment: &GrowthSegment| {
            if i + 1 == n {
                segment.log_determinant - segment.growth[..i].iter().sum::<f64>()
            } else {
                segment.growth[i]
            }
        };
        let blocks = block_means(segments, of);
        let (value, interval) = mean_with_interval(&blocks);
        // Blocks as long as a beat of a torus all err alike; the plain mean errs otherwise.
        let plain = segments.iter().map(of).sum::<f64>() / time;
        let uncertainty = interval + (plain - value).abs() + systematic;
        let (first, second) = blocks.split_at(BLOCKS / 2);
        let drift = (mean_with_interval(first).0 - mean_with_interval(second).0).abs();
        // Each half has an interval wider by the root of two, and so has their difference again.
        converged &= drift <= DRIFT * 2.0 * uncertainty;
        Uncertain::new(value, uncertainty)
    };
    let mut exponents: Vec<Uncertain> = (0..n).map(exponent).collect();
    if n > 1 {
        // The sum of all is the mean of the trace, exactly.
        let trace = segments
            .iter()
            .map(|segment| segment.log_determinant)
            .sum::<f64>()
            / time;
        let others: f64 = exponents[..n - 1].iter().map(|x| x.value).sum();
        let last = &mut exponents[n - 1];
        last.uncertainty += (trace - others - last.value).abs();
        last.value = trace - others;
    }
    exponents.sort_by(|a, b| b.value.total_cmp(&a.value));
    let defect =
        |segment: &GrowthSegment| segment.growth.iter().sum::<f64>() - segment.log_determinant;
    LyapunovSpectrum {
        exponents,
        converged,
        along_flow,
        liouville_defect: segments.iter().map(defect).sum::<f64>() / time,
        time,
    }
}

/// The rates over blocks of as many segments, with what is left over in the last.
fn block_means(segments: &[GrowthSegment], of: impl Fn(&GrowthSegment) -> f64) -> Vec<f64> {
    (0..BLOCKS)
        .map(|block| {
            let block =
                &segments[block * segments.len() / BLOCKS..(block + 1) * segments.len() / BLOCKS];
            weighted_mean(block.iter().map(&of))
                / weighted_mean(block.iter().map(|segment| segment.time))
        })
        .collect()
}

/// The mean, and the half width of its interval of 99 % confidence.
fn mean_with_interval(blocks: &[f64]) -> (f64, f64) {
    let n = blocks.len() as f64;
    let mean = blocks.iter().sum::<f64>() / n;
    let squares: f64 = blocks.iter().map(|x| (x - mean) * (x - mean)).sum();
    (mean, STUDENT * (squares / (n * (n - 1.0))).sqrt())
}
