//! Any small system with its variational equations.
//!
//! The formula runs on series of [`Dual`]s. Their lanes are the derivatives in the N components of the start, in the two
//! parameters, and N more in which every step begins with x_i' = e_i and stays there: the rates then have the columns of the
//! Jacobian along the solution in these, and its trace is integrated with the rest. The determinant of a strongly contracting
//! tangent is known by that alone.

use super::dual::Dual;
use super::element::{Element, rough_exp2, rough_log2};
use super::equations::{Equations, Fixed, copy};
use super::formula::{Formula, Rates, WATCHED};
use super::handle::Series;
use super::stepper::Stepper;
use super::tape::Order;
use super::{Accuracy, Derivatives, Expansion, Solution, Tangent};
use crate::number::DoubleDouble;
use pulp::NullaryFnOnce;

/// The equations on duals, with the trace of the Jacobian watched first.
#[derive(Debug, Clone, Copy)]
struct Along<S, T, X> {
    fixed: Fixed<S, Dual<T, X>>,
    /// 1 in the lanes that change along the solution, 0 in those that stand for directions.
    changing: X,
}

impl<S, T: Element, X: Element> Along<S, T, X> {
    /// A rate without the derivatives in directions.
    #[inline(always)]
    fn changing<'t, O: Order>(&self, rate: Series<'t, Dual<T, X>, O>) -> Series<'t, Dual<T, X>, O> {
        rate.lanewise(|d| Dual {
            gradient: d.gradient * self.changing,
            ..d
        })
    }
}

/// The derivative of a rate in the direction of this lane.
#[inline(always)]
fn slope<T: Element, X: Element, O: Order>(
    rate: Series<'_, Dual<T, X>, O>,
    lane: usize,
) -> Series<'_, Dual<T, X>, O> {
    rate.lanewise(|d| d.like_exact(d.gradient.lane_exact(lane)))
}

impl<S: Equations<N>, T: Element, X: Element, const N: usize> Formula<Dual<T, X>, N>
    for Along<S, T, X>
{
    #[inline(always)]
    fn rates<'t, O: Order>(
        &self,
        x: [Series<'t, Dual<T, X>, O>; N],
    ) -> Rates<'t, Dual<T, X>, O, N> {
        // Two or three, one by one: what is in a loop folds too late.
        let mut rates = self.fixed.rates(x).variables;
        let mut trace = slope(rates[0], N + 2) + slope(rates[1], N + 3);
        if N == 3 {
            trace = trace + slope(rates[2], N + 4);
            rates[2] = self.changing(rates[2]);
        }
        rates[0] = self.changing(rates[0]);
        rates[1] = self.changing(rates[1]);
        Rates {
            variables: rates,
            watched: [trace; WATCHED],
        }
    }

    #[inline(always)]
    fn units(&self, x: &[Dual<T, X>; N], tolerances: (f64, f64)) -> [Dual<T, X>; N] {
        Fixed::<S, _>::units(x, tolerances)
    }

    #[inline(always)]
    fn allows(&self, x: &[Dual<T, X>; N]) -> Dual<T, X> {
        Fixed::<S, _>::finite(x)
    }
}

/// A solution of the equations with its derivatives in its start and in both parameters, in numbers T; X has at least 2 N + 2
/// lanes of them.
///
/// A step may err by `atol + rtol |x_i|` in x_i. In a column of derivatives it may err by `rtol` of the largest of its
/// components, each counted in units of 1 + |x_i|.
pub struct Variational<S, T, X, const N: usize, const ROOM: usize> {
    stepper: Stepper<Dual<T, X>, Along<S, T, X>, N, ROOM>,
    log_determinant: DoubleDouble,
}

impl<S: Equations<N>, T: Element, X: Element, const N: usize, const ROOM: usize>
    Variational<S, T, X, N, ROOM>
{
    /// To be started; `value` and `gradient` are any.
    pub fn new(equations: S, parameters: [f64; 2], value: T, gradient: X) -> Self {
        const { assert!(2 * N + 2 <= X::LANES, "more variables than lanes") };
        let zero = gradient.like(0.0);
        let mut changing = zero;
        for lane in 0..N + 2 {
            changing = changing.with_lane(lane, 1.0);
        }
        let parameter = |i: usize| Dual {
            value: value.like(parameters[i]),
            gradient: zero.with_lane(N + i, 1.0),
        };
        let fixed = Fixed {
            equations,
            parameters: [parameter(0), parameter(1)],
        };
        Variational {
            stepper: Stepper::new(Along { fixed, changing }, Dual { value, gradient }),
            log_determinant: DoubleDouble::ZERO,
        }
    }

    #[inline(always)]
    fn step(&mut self, accuracy: &Accuracy, limit: Dual<T, X>) -> Dual<T, X> {
        self.stepper.expand(accuracy);
        let unit = self.stepper.unit();
        let most = Element::min(self.stepper.longest(accuracy), (limit / unit).abs());
        let longest = longest_of_columns(accuracy, most.first(), |k| self.column_sizes(k));
        let h = Element::min(most, limit.like(longest));
        let taken = self.stepper.advance_by(accuracy, h, limit);
        let grown = self.mean_trace(accuracy.order, (taken / unit).value) * taken.value;
        self.log_determinant = self.log_determinant + grown.to_exact();
        taken
    }

    /// The largest component of the k-th coefficient of every column, in units of 1 + |x_i|.
    #[inline(always)]
    fn column_sizes(&self, k: usize) -> X {
        let mut largest = self.stepper.state()[0].gradient.like(0.0);
        let mut i = 0;
        while i < N {
            let series = self.stepper.series(i);
            let per_unit = largest.like(1.0 / (1.0 + series[0].first().abs()));
            largest = Element::max(largest, (series[k].gradient * per_unit).abs());
            i += 1;
        }
        largest
    }

    /// The mean of the Jacobian's trace over the last step, of h units.
    #[inline(always)]
    fn mean_trace(&self, order: usize, h: T) -> T {
        let mut mean = h.like(0.0);
        // The trace of constant rates is none.
        let Some(trace) = self.stepper.watched_series(0) else {
            return mean;
        };
        let mut j = order;
        while j > 0 {
            j -= 1;
            mean = mean.mul_add(h, trace[j].value / h.like((j + 1) as f64));
        }
        mean
    }
}

/// The step, in units of the series and at most `most`, at which the last two terms of every column are below the tolerance,
/// from the sizes of the columns' k-th coefficients.
#[inline(always)]
pub(super) fn longest_of_columns<X: Element>(
    accuracy: &Accuracy,
    most: f64,
    sizes: impl Fn(usize) -> X,
) -> f64 {
    /// Columns are not as small.
    const NOTHING: f64 = 1e-250;
    let order = accuracy.order;
    let begins = sizes(0);
    let any = begins;
    // Derivatives in parameters begin at zero.
    let grows = sizes(1) * any.like(most);
    let largest = Element::max(begins.if_zero(grows, begins), any.like(NOTHING));
    let per_tolerable = any.like(1.0) / (largest * any.like(accuracy.tolerances.0));
    let before = (sizes(order - 1) * per_tolerable).largest_lane();
    let last = (sizes(order) * per_tolerable).largest_lane();
    let before = -rough_log2(before) / (order - 1) as f64;
    let last = -rough_log2(last) / order as f64;
    rough_exp2(before.min(last))
}

/// A step, to be compiled for the processor.
struct Step<'a, S, T, X, const N: usize, const ROOM: usize> {
    track: &'a mut Variational<S, T, X, N, ROOM>,
    accuracy: &'a Accuracy,
    limit: Dual<T, X>,
}

impl<S: Equations<N>, T: Element, X: Element, const N: usize, const ROOM: usize> NullaryFnOnce
    for Step<'_, S, T, X, N, ROOM>
{
    type Output = Dual<T, X>;
    #[inline(always)]
    fn call(self) -> Dual<T, X> {
        self.track.step(self.accuracy, self.limit)
    }
}

impl<S: Equations<N>, T: Element, X: Element, const N: usize, const ROOM: usize> Solution<N>
    for Variational<S, T, X, N, ROOM>
{
    fn start(&mut self, y: &[f64; N]) {
        let zero = self.stepper.state()[0].like(0.0);
        let mut x = [zero; N];
        for (i, x) in x.iter_mut().enumerate() {
            x.value = zero.value.like(y[i]);
            x.gradient = zero.gradient.with_lane(i, 1.0).with_lane(N + 2 + i, 1.0);
        }
        self.stepper.start(x);
        self.log_determinant = DoubleDouble::ZERO;
    }

    fn advance(&mut self, accuracy: &Accuracy, limit: DoubleDouble) -> DoubleDouble {
        let limit = self.stepper.state()[0].like_exact(limit);
        let step = Step {
            track: self,
            accuracy,
            limit,
        };
        limit.run(step).to_exact()
    }

    fn state(&self) -> [f64; N] {
        self.stepper.state().map(Element::first)
    }

    fn expansion(&self, order: usize, into: &mut Expansion<N>) {
        copy(&self.stepper, order, into);
    }
}

impl<S: Equations<N>, T: Element, X: Element, const N: usize, const ROOM: usize> Tangent<N>
    for Variational<S, T, X, N, ROOM>
{
    fn derivatives(&self) -> Derivatives<N> {
        let column = |lane: usize| self.stepper.state().map(|x| x.gradient.lane(lane));
        Derivatives {
            start: std::array::from_fn(column),
            parameters: [column(N), column(N + 1)],
            log_determinant: self.log_determinant.to_f64(),
            log_across: None,
        }
    }
}
