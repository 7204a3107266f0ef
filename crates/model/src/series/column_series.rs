//! The series of columns of derivatives: of all columns at once, which stand in lanes.
//!
//! The (k+1)-th coefficients are k-th ones of sums of products, (J x)_k = sum of J_l x_(k-l) over 0 <= l <= k. Older coefficients
//! of the columns come first: nothing waits for the newest ones but their own products.

use super::element::Element;
use super::program::Source;
use super::program_rows::ProgramRows;
use pulp::NullaryFnOnce;

/// Chunks whose sums are made at once, out of one read of the Jacobian.
const TOGETHER: usize = 4;

/// An entry of the Jacobian, or of the derivatives in parameters, that is not zero everywhere.
#[derive(Debug, Clone, Copy)]
pub(super) struct JacobianEntry {
    /// The rate, and what it is differentiated in.
    pub place: (usize, usize),
    pub series: Source,
}

/// The columns: `chunks` elements X for every variable, whose lanes are the N components of the start and then the parameters.
pub(super) struct ColumnChunks<X> {
    pub variables: usize,
    pub chunks: usize,
    /// At the beginning of the next step.
    pub x: Vec<X>,
    /// The series, in the order of the powers.
    pub series: Vec<X>,
}

impl<X: Element> ColumnChunks<X> {
    pub fn new(variables: usize, directions: usize, room: usize, any: X) -> Self {
        let chunks = directions.div_ceil(X::LANES);
        let zero = any.like(0.0);
        ColumnChunks {
            variables,
            chunks,
            x: vec![zero; variables * chunks],
            series: vec![zero; room * variables * chunks],
        }
    }

    /// Begins the series at the state reached.
    #[inline(always)]
    pub fn begin(&mut self) {
        self.series[..self.x.len()].copy_from_slice(&self.x);
    }

    /// The identity, and zero in the parameters.
    pub fn start(&mut self) {
        let zero = self.x[0].like(0.0);
        self.x.fill(zero);
        for i in 0..self.variables {
            let x = &mut self.x[i * self.chunks + i / X::LANES];
            *x = x.with_lane(i % X::LANES, 1.0);
        }
    }

    pub fn get(&self, i: usize, direction: usize) -> f64 {
        self.x[i * self.chunks + direction / X::LANES].lane(direction % X::LANES)
    }

    /// The k-th coefficients.
    #[inline(always)]
    pub fn level(&self, k: usize) -> &[X] {
        let width = self.variables * self.chunks;
        &self.series[k * width..][..width]
    }
}

/// The series of the columns, which are begun, from that of the entries.
pub(super) struct ExpandColumns<'a, T: Element, X> {
    pub columns: &'a mut ColumnChunks<X>,
    /// Row by row.
    pub jacobian: &'a [JacobianEntry],
    pub forcing: &'a [JacobianEntry],
    pub rows: &'a ProgramRows<T>,
    pub unit: f64,
    pub order: usize,
}

impl<T: Element, X: Element> NullaryFnOnce for ExpandColumns<'_, T, X> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let ExpandColumns {
            columns,
            jacobian,
            forcing,
            rows,
            unit,
            order,
        } = self;
        let ColumnChunks {
            variables,
            chunks,
            x,
            series,
        } = columns;
        let (variables, chunks) = (*variables, *chunks);
        let width = variables * chunks;
        let any = x[0];
        for k in 0..order {
            let (known, rest) = series.split_at_mut((k + 1) * width);
            let next = &mut rest[..width];
            for (i, sums) in next.chunks_exact_mut(chunks).enumerate() {
                let of_row = of_row(jacobian, i);
                let at = (k, width, chunks);
                let mut c = 0;
                while c + TOGETHER <= chunks {
                    let made = sums_over::<T, X, TOGETHER>((of_row, rows), &known[c..], at, any);
                    sums[c..c + TOGETHER].copy_from_slice(&made);
                    c += TOGETHER;
                }
                while c < chunks {
                    [sums[c]] = sums_over((of_row, rows), &known[c..], at, any);
                    c += 1;
                }
            }
            for entry in forcing {
                let (i, parameter) = entry.place;
                // A number has no further coefficients.
                if k > 0 && matches!(entry.series, Source::Number(_)) {
                    continue;
                }
                let lane = variables + parameter;
                let x = rows.coefficient(entry.series, k);
                let sum = &mut next[i * chunks + lane / X::LANES];
                let one = any.like(0.0).with_lane(lane % X::LANES, 1.0);
                *sum = one.mul_add(any.like_exact(x.to_exact()), *sum);
            }
            let share = any.like(unit) / any.like((k + 1) as f64);
            for sum in next {
                *sum = *sum * share;
            }
        }
    }
}

/// The entries of a row.
#[inline(always)]
fn of_row(jacobian: &[JacobianEntry], i: usize) -> &[JacobianEntry] {
    let begin = jacobian.partition_point(|entry| entry.place.0 < i);
    let all = &jacobian[begin..];
    &all[..all.partition_point(|entry| entry.place.0 == i)]
}

/// The k-th coefficients of a row of the Jacobian times the columns of B chunks, whose coefficients stand `width` apart: the products with
/// all but the last two coefficients of the columns in two sums, which do not wait for each other; then those with the last but one, and
/// with the newest in two sums again.
#[inline(always)]
fn sums_over<T: Element, X: Element, const B: usize>(
    (of_row, rows): (&[JacobianEntry], &ProgramRows<T>),
    known: &[X],
    (k, width, chunks): (usize, usize, usize),
    any: X,
) -> [X; B] {
    let zero = any.like(0.0);
    let (mut sums, mut others) = ([zero; B], [zero; B]);
    for entry in of_row {
        if let Source::Row(row) = entry.series {
            let a = &rows.row(row)[..=k];
            let column = &known[entry.place.1 * chunks..];
            add_older(a, column, width, (&mut sums, &mut others));
        }
    }
    for b in 0..B {
        sums[b] = sums[b] + others[b];
    }
    if k > 0 {
        for entry in of_row {
            if let Source::Row(row) = entry.series {
                let a = any.like_exact(rows.row(row)[1].to_exact());
                let column = &known[(k - 1) * width + entry.place.1 * chunks..];
                add_product(&mut sums, a, column);
            }
        }
    }
    others = [zero; B];
    for (place, entry) in of_row.iter().enumerate() {
        let a = match entry.series {
            Source::Number(a) => any.like_exact(a),
            Source::Row(row) => any.like_exact(rows.row(row)[0].to_exact()),
        };
        let column = &known[k * width + entry.place.1 * chunks..];
        if place % 2 == 0 {
            add_product(&mut sums, a, column);
        } else {
            add_product(&mut others, a, column);
        }
    }
    for b in 0..B {
        sums[b] = sums[b] + others[b];
    }
    sums
}

/// Adds a times so many columns.
#[inline(always)]
fn add_product<X: Element, const B: usize>(sums: &mut [X; B], a: X, columns: &[X]) {
    let columns = &columns[..B];
    for b in 0..B {
        sums[b] = a.mul_add(columns[b], sums[b]);
    }
}

/// Adds a_l b_(k-l) for l from k to 2, of columns whose coefficients stand `width` apart, to two sums in turn.
#[inline(always)]
fn add_older<T: Element, X: Element, const B: usize>(
    a: &[T],
    column: &[X],
    width: usize,
    (even, odd): (&mut [X; B], &mut [X; B]),
) {
    let any = column[0];
    let k = a.len() - 1;
    let mut l = k;
    while l > 2 {
        let (first, second) = (a[l].to_exact(), a[l - 1].to_exact());
        add_product(even, any.like_exact(first), &column[(k - l) * width..]);
        add_product(odd, any.like_exact(second), &column[(k - l + 1) * width..]);
        l -= 2;
    }
    if l == 2 {
        add_product(
            even,
            any.like_exact(a[2].to_exact()),
            &column[(k - 2) * width..],
        );
    }
}
