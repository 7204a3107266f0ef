//! The solution as a function of time: polynomials, one for each step.

mod bounds;

use super::chart::{Chart, Given};
use std::f64::consts::PI;
use twinslip::error::{Error, Result};
use twinslip::integrate::AnyStep;
use twinslip::number::DoubleDouble;

/// The solution at any time: the polynomial of every step, in the variables that were integrated. Of a method of power series it is
/// the series, of others the continuous solution of the step, by its values at Chebyshev points: as its degree is known, that is exact.
#[derive(Debug, Clone, PartialEq)]
pub struct IvpSolution {
    chart: Chart,
    /// The user's times: the beginning, and the end of every piece.
    times: Vec<f64>,
    pieces: Vec<Piece>,
    /// Of every piece those of each variable, one after the other.
    coefficients: Vec<f64>,
}

/// One step.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Piece {
    /// Its beginning, in 31 digits: stress and state can change ten thousand times faster than time.
    begin: DoubleDouble,
    /// From there to its end, which is known better than the user's time.
    length: f64,
    /// The unit of time of a series; of Chebyshev polynomials the time from -1 to 1.
    scale: f64,
    basis: Basis,
    order: usize,
    /// Where its coefficients are.
    first: usize,
}

/// What the coefficients are of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Basis {
    /// Chebyshev polynomials, of the variables.
    Chebyshev,
    /// Powers.
    Powers(Given),
}

impl Basis {
    const ALL: [Basis; 3] = [
        Basis::Chebyshev,
        Basis::Powers(Given::Variables),
        Basis::Powers(Given::States),
    ];
}

/// A solution as plain numbers, to be written and read back.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct IvpParts {
    /// What the variables mean: six numbers.
    pub chart: Vec<f64>,
    /// The times between which the pieces are, in the user's units; one more than pieces.
    pub times: Vec<f64>,
    /// Six numbers for each piece: its beginning in two, its length, its unit of time, its kind and its order.
    pub pieces: Vec<f64>,
    /// The coefficients, piece by piece, variable by variable.
    pub coefficients: Vec<f64>,
}

/// Numbers for each piece.
const OF_PIECE: usize = 6;

impl IvpSolution {
    /// Of nothing yet.
    pub(super) fn new(chart: Chart, begin: f64) -> Self {
        IvpSolution {
            chart,
            times: vec![begin],
            pieces: Vec::new(),
            coefficients: Vec::new(),
        }
    }

    /// Goes on by a step up to the user's time `end`; `degree` is that of the dense output where there is no series.
    pub(super) fn push(&mut self, step: &AnyStep<'_>, end: f64, degree: usize) {
        let first = self.coefficients.len();
        let n = self.chart.variables;
        let piece = match step.series() {
            Some(series) => {
                for i in 0..n {
                    self.coefficients.extend_from_slice(series.variable(i));
                }
                // ln 1 = 0 tells whether they are logarithms already.
                let ones = vec![1.0; step.y0.len()];
                let same = series.state_of(&ones).as_slice() == ones;
                Piece {
                    begin: series.begin(),
                    length: series.length(),
                    scale: series.unit(),
                    basis: Basis::Powers(if same {
                        Given::Variables
                    } else {
                        Given::States
                    }),
                    order: series.order(),
                    first,
                }
            }
            None => {
                let length = step.length;
                self.coefficients.extend(interpolated(step, n, degree));
                Piece {
                    begin: step.begin,
                    length,
                    scale: length,
                    basis: Basis::Chebyshev,
                    order: degree,
                    first,
                }
            }
        };
        self.pieces.push(piece);
        self.times.push(end);
    }

    /// Ends the last piece at a time within it; without any length it goes, if it is not the only one.
    pub(super) fn end_at(&mut self, end: f64) {
        let begin = self.times[self.times.len().saturating_sub(2)];
        if end == begin && self.pieces.len() > 1 {
            self.times.pop();
            if let Some(piece) = self.pieces.pop() {
                self.coefficients.truncate(piece.first);
            }
            return;
        }
        let inward = self.chart.time_inward(end);
        if let (Some(piece), Some(last)) = (self.pieces.last_mut(), self.times.last_mut()) {
            piece.length = (DoubleDouble::from(inward) - piece.begin).hi();
            *last = end;
        }
    }

    /// How many values there are at a time.
    pub fn dimension(&self) -> usize {
        self.chart.values()
    }

    /// The times at which pieces begin and end, in the order of the run, in the user's units: one more than there are pieces.
    pub fn times(&self) -> &[f64] {
        &self.times
    }

    /// The user's values at a time, [`IvpSolution::dimension`] of them. At the end of a piece they are of that piece; outside the
    /// solution the first or the last piece goes on, which has no accuracy any more.
    pub fn at(&self, time: f64) -> Vec<f64> {
        self.fill(&[time])
    }

    /// The same at many times: the values at the first, then those at the second, and so on.
    pub fn fill(&self, times: &[f64]) -> Vec<f64> {
        let mut values = Vec::with_capacity(times.len() * self.dimension());
        let mut variables = Vec::with_capacity(self.chart.variables);
        for &time in times {
            let (piece, since) = self.piece(time);
            variables.clear();
            let of_one = self.coefficients[piece.first..].chunks(piece.order + 1);
            let of_one = of_one.take(self.chart.variables);
            let s = since / piece.scale;
            let given = match piece.basis {
                Basis::Chebyshev => {
                    variables.extend(of_one.map(|c| clenshaw(c, 2.0 * s - 1.0)));
                    Given::Variables
                }
                Basis::Powers(given) => {
                    variables.extend(of_one.map(|c| horner(c, s)));
                    given
                }
            };
            self.chart.outward(&variables, given, &mut values);
        }
        values
    }

    /// The piece that ends at a time or after it, and the time since its beginning.
    fn piece(&self, time: f64) -> (&Piece, f64) {
        let ends = &self.times[1..];
        let forward = self.times[0] <= ends[ends.len() - 1];
        let before = |&end: &f64| if forward { end < time } else { end > time };
        let place = ends.partition_point(before).min(ends.len() - 1);
        let piece = &self.pieces[place];
        if time == ends[place] {
            return (piece, piece.length);
        }
        let inward = self.chart.time_inward(time);
        (piece, (DoubleDouble::from(inward) - piece.begin).hi())
    }

    /// As plain numbers.
    pub fn to_parts(&self) -> IvpParts {
        let numbers = |piece: &Piece| -> [f64; OF_PIECE] {
            let kind = Basis::ALL.iter().position(|basis| *basis == piece.basis);
            [
                piece.begin.hi(),
                piece.begin.lo(),
                piece.length,
                piece.scale,
                kind.unwrap_or_default() as f64,
                piece.order as f64,
            ]
        };
        IvpParts {
            chart: self.chart.to_numbers(),
            times: self.times.clone(),
            pieces: self.pieces.iter().flat_map(numbers).collect(),
            coefficients: self.coefficients.clone(),
        }
    }

    /// From the numbers of [`IvpSolution::to_parts`].
    ///
    /// # Errors
    /// [`Error::Input`] for numbers that are of no solution.
    pub fn from_parts(parts: IvpParts) -> Result<Self> {
        let wrong =
            |what: &str| Error::Input(format!("the parts of a solution do not fit: {what}"));
        let chart = Chart::from_numbers(&parts.chart)?;
        if parts.pieces.is_empty() || !parts.pieces.len().is_multiple_of(OF_PIECE) {
            return Err(wrong("`pieces` must be six numbers for each piece"));
        }
        if parts.times.len() != parts.pieces.len() / OF_PIECE + 1 {
            return Err(wrong("`times` must be one more than there are pieces"));
        }
        let mut first = 0;
        let mut pieces = Vec::with_capacity(parts.times.len());
        for numbers in parts.pieces.chunks(OF_PIECE) {
            let &[hi, lo, length, scale, kind, order] = numbers else {
                return Err(wrong("`pieces` must be six numbers for each piece"));
            };
            let place = Basis::ALL
                .iter()
                .enumerate()
                .find(|(i, _)| *i as f64 == kind);
            let Some((_, &basis)) = place else {
                return Err(wrong("the kind of a piece must be 0, 1 or 2"));
            };
            let most = parts.coefficients.len();
            if !(order >= 0.0 && order.fract() == 0.0 && order < most as f64) {
                return Err(wrong("the order of a piece must have its coefficients"));
            }
            pieces.push(Piece {
                begin: DoubleDouble::new(hi, lo),
                length,
                scale,
                basis,
                order: order as usize,
                first,
            });
            first += (order as usize + 1) * chart.variables;
        }
        if first != parts.coefficients.len() {
            return Err(wrong("`coefficients` must be as many as the pieces have"));
        }
        Ok(IvpSolution {
            chart,
            times: parts.times,
            pieces,
            coefficients: parts.coefficients,
        })
    }
}

/// The Chebyshev coefficients of n variables over a step, from the dense output at as many points as its degree needs.
fn interpolated(step: &AnyStep<'_>, n: usize, degree: usize) -> Vec<f64> {
    /// Shorter steps, in spacings of the times around them, have no room for the points.
    const ROOM: f64 = 1e4;
    /// What is left of the errors of the points falls by more than 10 each time.
    const CORRECTIONS: usize = 3;
    let (t0, length) = (step.t0, step.length);
    let angle = |k: usize| PI * (2 * k + 1) as f64 / (2 * degree + 2) as f64;
    let times = (0..=degree).map(|k| 0.5 * length * (1.0 + angle(k).cos()));
    let spacing = f64::EPSILON * t0.abs().max(step.t1.abs());
    // A solver may round times, in a short step by much of it: the polynomial is corrected by what it is off where the points really are.
    let has_room = length.abs() > ROOM * spacing;
    let times = times.map(|time| if has_room { (t0 + time) - t0 } else { time });
    let times: Vec<f64> = times.collect();
    let corrections = if has_room { CORRECTIONS } else { 0 };
    let values: Vec<_> = times.iter().map(|&time| step.after(time)).collect();
    let mut coefficients = vec![0.0; n * (degree + 1)];
    for (i, of_one) in coefficients.chunks_mut(degree + 1).enumerate() {
        let mut off: Vec<f64> = values.iter().map(|y| y[i]).collect();
        for correction in 0..=corrections {
            for (j, c) in of_one.iter_mut().enumerate() {
                let terms = off.iter().enumerate();
                let sum: f64 = terms.map(|(k, y)| y * (j as f64 * angle(k)).cos()).sum();
                *c += sum * if j == 0 { 1.0 } else { 2.0 } / (degree + 1) as f64;
            }
            if correction < corrections {
                for ((off, y), t) in off.iter_mut().zip(&values).zip(&times) {
                    *off = y[i] - clenshaw(of_one, 2.0 * t / length - 1.0);
                }
            }
        }
    }
    coefficients
}

/// A sum of Chebyshev polynomials (Clenshaw).
fn clenshaw(coefficients: &[f64], x: f64) -> f64 {
    let (mut later, mut last) = (0.0, 0.0);
    for c in coefficients[1..].iter().rev() {
        (last, later) = (2.0 * x * last - later + c, last);
    }
    coefficients[0] + x * last - later
}

/// A sum of powers.
fn horner(coefficients: &[f64], s: f64) -> f64 {
    coefficients.iter().rev().fold(0.0, |sum, c| sum * s + c)
}
