//! Any small system with its variational equations.
//!
//! The formula runs on series of [`Dual`]s. Their lanes are the derivatives in the N components of the start, in the two
//! parameters, and N more in which every step begins with x_i' = e_i and stays there: the rates then have the columns of the
//! Jacobian along the solution in these, and its trace is integrated with the rest. The determinant of a strongly contracting
//! tangent is known by that alone.

use super::dual::Dual;
use super::element::Element;
use super::equations::Equations;
use super::formula::{Formula, Rates, WATCHED};
use super::handle::{Series, value};
use super::linearised::longest_of_columns;
use super::stepper::Stepper;
use super::tape::Order;
use super::{Accuracy, Derivatives, Expansion, Solution, Tangent};
use crate::number::DoubleDouble;
use pulp::NullaryFnOnce;

/// The equations on duals, with the trace of the Jacobian watched first.
#[derive(Debug, Clone, Copy)]
struct WithTrace<S, X, const P: usize> {
    equations: S,
    parameters: [Dual<X>; P],
    /// 1 in the lanes that change along the solution, 0 in those that stand for directions.
    changing: X,
}

impl<S, X: Element, const P: usize> WithTrace<S, X, P> {
    /// A rate without the derivatives in directions.
    #[inline(always)]
    fn changing<'t, O: Order>(&self, rate: Series<'t, Dual<X>, O>) -> Series<'t, Dual<X>, O> {
        rate.lanewise(|d| Dual {
            gradient: d.gradient * self.changing,
            ..d
        })
    }
}

/// The derivative of a rate in the direction of this lane.
#[inline(always)]
fn slope<X: Element, O: Order>(
    rate: Series<'_, Dual<X>, O>,
    lane: usize,
) -> Series<'_, Dual<X>, O> {
    rate.lanewise(|d| d.like(d.gradient.lane(lane)))
}

impl<S: Equations<N, P>, X: Element, const N: usize, const P: usize> Formula<Dual<X>, N>
    for WithTrace<S, X, P>
{
    #[inline(always)]
    fn rates<'t, O: Order>(&self, x: [Series<'t, Dual<X>, O>; N]) -> Rates<'t, Dual<X>, O, N> {
        // Two or three, one by one: what is in a loop folds too late.
        let mut rates = self.equations.rates(x, self.parameters.map(value));
        let mut trace = slope(rates[0], N + FREE) + slope(rates[1], N + FREE + 1);
        if N == 3 {
            trace = trace + slope(rates[2], N + FREE + 2);
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
    fn units(&self, x: &[Dual<X>; N], tolerances: (f64, f64)) -> [Dual<X>; N] {
        let (rtol, atol) = tolerances;
        let mut units = *x;
        let mut i = 0;
        while i < N {
            units[i] = x[i].plain().abs().mul_add(x[i].like(rtol), x[i].like(atol));
            i += 1;
        }
        units
    }

    #[inline(always)]
    fn allows(&self, x: &[Dual<X>; N]) -> Dual<X> {
        let mut one = x[0].like(1.0);
        let mut i = 0;
        while i < N {
            one = x[i].mul_add(x[i].like(0.0), one);
            i += 1;
        }
        one
    }
}

/// Parameters that there are lanes for.
pub const FREE: usize = 2;

/// A solution of the equations with its derivatives in its start and in one or two of the parameters; X has at least 2 N + 2
/// lanes.
///
/// A step may err by `atol + rtol |x_i|` in x_i. In a column of derivatives it may err by `rtol` of the largest of its
/// components, each counted in units of 1 + |x_i|.
pub struct Variational<S, X, const N: usize, const P: usize> {
    stepper: Stepper<Dual<X>, WithTrace<S, X, P>, N>,
    /// In how many parameters.
    free: usize,
    log_determinant: f64,
}

impl<S: Equations<N, P>, X: Element, const N: usize, const P: usize> Variational<S, X, N, P> {
    /// To be started, with derivatives in the parameters of these places, of which there are no more than [`FREE`]; `gradient` is
    /// any.
    pub fn new(equations: S, parameters: [f64; P], free: &[usize], gradient: X) -> Self {
        assert!(
            2 * N + FREE <= X::LANES && free.len() <= FREE,
            "more variables than lanes"
        );
        let zero = gradient.like(0.0);
        let mut changing = zero;
        for lane in 0..N + FREE {
            changing = changing.with_lane(lane, 1.0);
        }
        let parameter = |i: usize| Dual {
            value: parameters[i],
            gradient: match free.iter().position(|&at| at == i) {
                Some(lane) => zero.with_lane(N + lane, 1.0),
                None => zero,
            },
        };
        let formula = WithTrace {
            equations,
            parameters: std::array::from_fn(parameter),
            changing,
        };
        let any = Dual {
            value: 0.0,
            gradient,
        };
        Variational {
            free: free.len(),
            stepper: Stepper::new(formula, any),
            log_determinant: 0.0,
        }
    }

    #[inline(always)]
    fn step(&mut self, accuracy: &Accuracy, limit: Dual<X>) -> Dual<X> {
        self.stepper.expand(accuracy);
        let unit = self.stepper.unit();
        let most = Element::min(self.stepper.longest(accuracy), (limit / unit).abs());
        // One by one: a closure would be compiled for any processor.
        let sizes = [
            self.column_sizes(0),
            self.column_sizes(1),
            self.column_sizes(accuracy.order - 1),
            self.column_sizes(accuracy.order),
        ];
        let longest = longest_of_columns(accuracy, most.first(), sizes);
        let h = Element::min(most, limit.like(longest));
        let taken = self.stepper.advance_by(accuracy, h, limit);
        let grown = self.mean_trace(accuracy.order, (taken / unit).value) * taken.value;
        self.log_determinant += grown;
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
    fn mean_trace(&self, order: usize, h: f64) -> f64 {
        let mut mean = 0.0;
        // The trace of constant rates is none.
        let Some(trace) = self.stepper.watched_series(0) else {
            return mean;
        };
        let mut j = order;
        while j > 0 {
            j -= 1;
            mean = mean * h + trace[j].value / (j + 1) as f64;
        }
        mean
    }
}

/// A step, to be compiled for the processor.
struct VariationalStep<'a, S, X, const N: usize, const P: usize> {
    track: &'a mut Variational<S, X, N, P>,
    accuracy: &'a Accuracy,
    limit: Dual<X>,
}

impl<S: Equations<N, P>, X: Element, const N: usize, const P: usize> NullaryFnOnce
    for VariationalStep<'_, S, X, N, P>
{
    type Output = Dual<X>;
    #[inline(always)]
    fn call(self) -> Dual<X> {
        self.track.step(self.accuracy, self.limit)
    }
}

impl<S: Equations<N, P>, X: Element, const N: usize, const P: usize> Solution<N>
    for Variational<S, X, N, P>
{
    fn start(&mut self, y: &[f64; N]) {
        let zero = self.stepper.state()[0].like(0.0);
        let mut x = [zero; N];
        for (i, x) in x.iter_mut().enumerate() {
            x.value = y[i];
            x.gradient = zero.gradient.with_lane(i, 1.0).with_lane(N + FREE + i, 1.0);
        }
        self.stepper.start(x);
        self.log_determinant = 0.0;
    }

    fn advance(&mut self, accuracy: &Accuracy, limit: DoubleDouble) -> DoubleDouble {
        let limit = self.stepper.state()[0].like_exact(limit);
        let step = VariationalStep {
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
        into.order = order;
        into.unit = self.stepper.unit().value;
        into.chart = |x| x;
        for (i, variable) in into.variables.iter_mut().enumerate() {
            for (to, x) in variable[..=order].iter_mut().zip(self.stepper.series(i)) {
                *to = x.value;
            }
        }
    }
}

impl<S: Equations<N, P>, X: Element, const N: usize, const P: usize> Tangent<N>
    for Variational<S, X, N, P>
{
    fn derivatives(&self) -> Derivatives<N> {
        let column = |lane: usize| self.stepper.state().map(|x| x.gradient.lane(lane));
        Derivatives {
            start: std::array::from_fn(column),
            parameters: (0..self.free).map(|i| column(N + i)).collect(),
            log_determinant: self.log_determinant,
            log_transverse: None,
        }
    }
}
