//! Variational equations in any number of variables and parameters: the columns of the monodromy matrix, and derivatives in
//! parameters.
//!
//! With the Jacobian's entries as series along the solution, x_i' = J_ij x_j takes one product of series for each entry that is
//! there, and the columns share it: they stand in lanes. The trace is integrated too: the determinant of a strongly contracting
//! tangent is known by that alone.

use super::Accuracy;
use super::column_series::{ColumnChunks, ExpandColumns, JacobianEntry};
use super::compiled::CompiledColumns;
use super::element::{Element, rough_exp2, rough_log2};
use super::interpreted::{Interpreted, Trajectory};
use super::program::{Program, Source};
use crate::number::DoubleDouble;
use pulp::NullaryFnOnce;

/// The step, in units of the series and at most `most`, at which the last two terms of every column are below the tolerance,
/// from the sizes of the columns' first two coefficients and of these last two.
#[inline(always)]
pub(super) fn longest_of_columns<X: Element>(accuracy: &Accuracy, most: f64, sizes: [X; 4]) -> f64 {
    longest_of_terms(accuracy.order, last_terms(accuracy, most, sizes))
}

/// The largest of the last two terms of columns, in what may err in each.
#[inline(always)]
pub(super) fn last_terms<X: Element>(
    accuracy: &Accuracy,
    most: f64,
    [begins, grows, before, last]: [X; 4],
) -> [f64; 2] {
    /// Columns are not as small.
    const NOTHING: f64 = 1e-250;
    let any = begins;
    // Derivatives in parameters begin at zero.
    let grows = grows * any.like(most);
    let largest = Element::max(begins.if_zero(grows, begins), any.like(NOTHING));
    let per_tolerable = any.like(1.0) / (largest * any.like(accuracy.tolerances.0));
    [
        (before * per_tolerable).largest_lane(),
        (last * per_tolerable).largest_lane(),
    ]
}

/// The step, in units of the series, at which these last two terms may be left out.
#[inline(always)]
pub fn longest_of_terms(order: usize, [before, last]: [f64; 2]) -> f64 {
    let before = -rough_log2(before) / (order - 1) as f64;
    let last = -rough_log2(last) / order as f64;
    rough_exp2(before.min(last))
}

/// The entries of the Jacobian, and of the derivatives in parameters, that are not zero everywhere.
pub(super) struct Entries {
    pub jacobian: Vec<JacobianEntry>,
    pub forcing: Vec<JacobianEntry>,
}

impl Entries {
    /// Those of a program, which gives the Jacobian row by row at the end, and then for each rate its derivatives in so many parameters.
    pub fn of(program: &Program, variables: usize, parameters: usize) -> Self {
        let n = variables;
        let from = program.outputs.len() - n * (n + parameters);
        Entries {
            jacobian: Self::of_matrix(program, from, (n, n)),
            forcing: Self::of_matrix(program, from + n * n, (n, parameters)),
        }
    }

    /// Of a matrix with so many rows and columns that stands there in the outputs.
    fn of_matrix(
        program: &Program,
        from: usize,
        (rows, columns): (usize, usize),
    ) -> Vec<JacobianEntry> {
        let all = (0..rows * columns).map(|at| (at, program.output(from + at)));
        all.filter(|(_, series)| *series != Source::Number(DoubleDouble::ZERO))
            .map(|(at, series)| JacobianEntry {
                place: (at / columns, at % columns),
                series,
            })
            .collect()
    }

    /// Whether these are the places of others too.
    fn stand_as(&self, others: &Self) -> bool {
        let alike = |these: &[JacobianEntry], those: &[JacobianEntry]| {
            let place = |entry: &JacobianEntry| entry.place;
            these.iter().map(place).eq(those.iter().map(place))
        };
        alike(&self.jacobian, &others.jacobian) && alike(&self.forcing, &others.forcing)
    }
}

/// A solution with its derivatives, in numbers T, the columns in the lanes of X.
///
/// A step may err by `atol + rtol |x_i|` in x_i. In a column of derivatives it may err by `rtol` of the largest of its
/// components, each counted in units of 1 + |x_i|.
pub(super) struct Linearised<'a, T: Element, X> {
    solution: Interpreted<'a, T>,
    columns: ColumnChunks<X>,
    /// What the linearised equations need of the program.
    entries: Entries,
    compiled: Option<CompiledColumns<X>>,
    parameters: usize,
    /// Whether the growth across a symmetric subspace is what the last variable grows by on its own.
    symmetric: bool,
    log_determinant: DoubleDouble,
    log_transverse: DoubleDouble,
}

impl<'a, T: Element, X: Element> Linearised<'a, T, X> {
    /// To be started. The program gives, after the rates and the slip rates that the solution keeps, the Jacobian row by row
    /// and then, for each rate, its derivatives in the parameters.
    pub fn new(
        solution: Interpreted<'a, T>,
        (parameters, symmetric): (usize, bool),
        room: usize,
        any: X,
    ) -> Self {
        let variables = solution.reached().len();
        let columns = ColumnChunks::new(variables, variables + parameters, room, any);
        let (program, rows) = solution.made();
        let entries = Entries::of(program, variables, parameters);
        let compiled = (!program.branches).then(|| {
            let of = (&entries.jacobian[..], &entries.forcing[..]);
            CompiledColumns::of(of, (variables, columns.chunks), rows.room(), any)
        });
        Linearised {
            columns,
            entries,
            compiled: compiled.flatten(),
            solution,
            parameters,
            symmetric,
            log_determinant: DoubleDouble::ZERO,
            log_transverse: DoubleDouble::ZERO,
        }
    }

    /// The step of the columns, in units of the series and at most `most`. In loops: closures would not be compiled for the processor.
    #[inline(always)]
    fn longest(&self, accuracy: &Accuracy, most: f64) -> f64 {
        let chunks = self.columns.chunks;
        let any = self.columns.x[0];
        let ends = [0, 1, accuracy.order - 1, accuracy.order];
        let mut longest = most;
        for chunk in 0..chunks {
            let mut sizes = [any.like(0.0); 4];
            for (i, x) in self.solution.reached().iter().enumerate() {
                let per_unit = any.like(1.0 / (1.0 + x.first().abs()));
                for (size, k) in sizes.iter_mut().zip(ends) {
                    let relative = self.columns.level(k)[i * chunks + chunk] * per_unit;
                    *size = Element::max(*size, relative.abs());
                }
            }
            longest = f64::min(longest, longest_of_columns(accuracy, most, sizes));
        }
        longest
    }

    /// Goes on by h units.
    #[inline(always)]
    fn advance_columns(&mut self, order: usize, h: DoubleDouble) {
        let any = self.columns.x[0];
        let h = any.like_exact(h);
        let ColumnChunks {
            variables,
            chunks,
            x,
            series,
        } = &mut self.columns;
        let width = *variables * *chunks;
        for (at, x) in x.iter_mut().enumerate() {
            let mut sum = series[order * width + at];
            for k in (0..order).rev() {
                sum = sum.mul_add(h, series[k * width + at]);
            }
            *x = sum;
        }
    }

    /// A step, in the instructions that the processor has.
    #[inline(always)]
    fn advance_here(&mut self, accuracy: &Accuracy, limit: DoubleDouble) -> DoubleDouble {
        let (n, order) = (self.columns.variables, accuracy.order);
        self.solution.stay_within(limit);
        self.solution.expand(order);
        let (program, rows) = self.solution.made();
        if program.branches {
            self.entries = Entries::of(program, n, self.parameters);
        }
        let unit = self.solution.unit();
        let (columns, compiled) = (&mut self.columns, &mut self.compiled);
        columns.begin();
        let is_made = match compiled {
            Some(compiled) => compiled.expand(&mut columns.series, rows, (order, unit)),
            None => false,
        };
        if !is_made {
            ExpandColumns {
                columns,
                jacobian: &self.entries.jacobian,
                forcing: &self.entries.forcing,
                rows,
                unit,
                order,
            }
            .call();
        }
        let in_units = (limit.hi() / unit).abs();
        let most = f64::min(self.solution.longest(accuracy), in_units);
        let h = self.longest(accuracy, most);
        let taken = self.solution.advance_by(accuracy, h, limit);
        if !taken.is_finite() {
            return taken;
        }
        let h = taken / unit;
        self.advance_columns(order, h);
        for entry in &self.entries.jacobian {
            if entry.place.0 != entry.place.1 {
                continue;
            }
            let grown = self.mean(entry.series, order, h) * taken;
            self.log_determinant = self.log_determinant + grown;
            if entry.place.0 == n - 1 {
                self.log_transverse = self.log_transverse + grown;
            }
        }
        taken
    }

    /// The mean over the last step, of h units, of a diagonal entry of the Jacobian.
    #[inline(always)]
    fn mean(&self, of: Source, order: usize, h: DoubleDouble) -> DoubleDouble {
        let (_, rows) = self.solution.made();
        let row = match of {
            Source::Number(x) => return x,
            Source::Row(row) => rows.row(row),
        };
        let any = row[0];
        let (mut mean, h) = (any.like(0.0), any.like_exact(h));
        for k in (0..order).rev() {
            mean = mean.mul_add(h, row[k] * any.like_exact(rows.one_over(k + 1)));
        }
        mean.to_exact()
    }
}

/// A step of a solution with its derivatives, to be compiled for the processor.
struct AdvanceLinearised<'s, 'a, T: Element, X> {
    solution: &'s mut Linearised<'a, T, X>,
    accuracy: &'s Accuracy,
    limit: DoubleDouble,
}

impl<T: Element, X: Element> NullaryFnOnce for AdvanceLinearised<'_, '_, T, X> {
    type Output = DoubleDouble;

    #[inline(always)]
    fn call(self) -> DoubleDouble {
        self.solution.advance_here(self.accuracy, self.limit)
    }
}

impl<T: Element, X: Element> Trajectory for Linearised<'_, T, X> {
    fn is_at(&self, parameters: &[f64]) -> bool {
        self.solution.is_at(parameters)
    }

    fn set(&mut self, parameters: &[f64], own_factors: &[bool]) -> bool {
        if !self.solution.set(parameters, own_factors) {
            return false;
        }
        let (program, _) = self.solution.made();
        let entries = Entries::of(program, self.columns.variables, self.parameters);
        let stand = entries.stand_as(&self.entries);
        if stand && let Some(compiled) = &mut self.compiled {
            compiled.set((&entries.jacobian, &entries.forcing));
        }
        self.entries = entries;
        stand
    }

    fn start(&mut self, y: &[f64]) {
        self.solution.start(y);
        self.columns.start();
        self.log_determinant = DoubleDouble::ZERO;
        self.log_transverse = DoubleDouble::ZERO;
    }

    fn advance(&mut self, accuracy: &Accuracy, limit: DoubleDouble) -> DoubleDouble {
        self.columns.x[0].run(AdvanceLinearised {
            accuracy,
            limit,
            solution: self,
        })
    }

    fn rejected(&self) -> usize {
        self.solution.rejected()
    }

    fn state(&self, i: usize) -> f64 {
        self.solution.state(i)
    }

    fn unit(&self) -> f64 {
        self.solution.unit()
    }

    fn series(&self, i: usize, into: &mut [f64]) {
        self.solution.series(i, into);
    }

    fn sliding(&self) -> usize {
        self.solution.sliding()
    }

    fn slip_rates(&self, interface: usize, into: &mut [f64]) {
        self.solution.slip_rates(interface, into);
    }

    fn free(&self) -> usize {
        self.parameters
    }

    fn derivative(&self, i: usize, direction: usize) -> f64 {
        if direction < self.columns.variables + self.parameters {
            self.columns.get(i, direction)
        } else {
            0.0
        }
    }

    fn derivative_level(&self, i: usize, k: usize, into: &mut Vec<f64>) {
        let chunks = self.columns.chunks;
        let level = &self.columns.level(k)[i * chunks..][..chunks];
        let directions = self.columns.variables + self.parameters;
        let lanes = level.iter().flat_map(|x| (0..X::LANES).map(|l| x.lane(l)));
        into.extend(lanes.take(directions));
    }

    fn log_growth(&self) -> (f64, Option<f64>) {
        let across = self.symmetric.then(|| self.log_transverse.to_f64());
        (self.log_determinant.to_f64(), across)
    }
}
