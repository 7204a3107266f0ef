//! Solutions that are computed by a recorded formula: references, tangents and Taylor maps of any [`Equations`], and all solutions
//! of [`Expressions`].

use super::assembly::RecordedFormula;
use super::compiled::{self, BothWays};
use super::cubic::Jet3;
#[cfg(target_arch = "x86_64")]
use super::element::Element;
use super::equations::Equations;
use super::interpreted::{Anew, Interpreted, RecordFormula, Trajectory, Transported};
use super::linearised::Linearised;
use super::recent::{Formulas, Reused};
use super::trace::{Graph, Traced};
use super::{
    Accuracy, Derivatives, Expansion, REFERENCE_ORDER, ROOM, Solution, Tangent, TaylorMap,
};
#[cfg(target_arch = "x86_64")]
use super::{Four, Pair, avx2};
use crate::expression::Expressions;
use crate::number::{DoubleDouble, Real};
use std::cell::OnceCell;
use std::ops::{Deref, DerefMut};
use std::sync::Arc;

const REFERENCE_ROOM: usize = REFERENCE_ORDER + 1;

/// Equations at given parameters, whose solutions are made by a recorded formula.
#[derive(Debug, Clone, Copy)]
pub struct Recorded<S, const N: usize, const P: usize> {
    /// The right-hand side.
    pub equations: S,
    /// The parameters.
    pub parameters: [f64; P],
    /// Whether they are the symmetric subspace of two equal parts under one common variable, the first: the difference between
    /// the parts then grows as the last variable does on its own.
    pub symmetric: bool,
}

/// A recorded formula: its variables, the slip rates among its outputs, the parameters in which it has derivatives.
pub struct Recording<'a> {
    record: RecordFormula<'a>,
    variables: usize,
    slip_rates: usize,
    /// In how many parameters it has derivatives.
    free: usize,
    symmetric: bool,
    /// Where solutions that are done with are kept, if anywhere.
    formulas: Option<Formulas<'a>>,
}

/// Slip rates that are kept, parameters in which there are derivatives, and whether the solution is a symmetric one.
type Kind = (usize, usize, bool);

/// What a solution is made in. None of these is generic: they are compiled with this crate, not with each system.
impl<'a> Recording<'a> {
    fn solution(self) -> Reused<'a> {
        self.reused(solution_of)
    }

    fn tangent(self) -> Reused<'a> {
        self.reused(tangent_of)
    }

    /// A solution of these formulas that is done with, else a new one.
    fn reused(
        mut self,
        make: for<'b> fn(Anew<'b>, Kind) -> Box<dyn Trajectory + 'b>,
    ) -> Reused<'a> {
        let formulas = self.formulas.take();
        if let Some(idle) = formulas.as_ref().and_then(Formulas::idle) {
            return idle;
        }
        let ((program, record), kind) = self.anew();
        if program.branches {
            return Reused::Once(make((program, record), kind));
        }
        let made = make((program, None), kind);
        match &formulas {
            Some(formulas) => formulas.kept(made),
            None => Reused::Once(made),
        }
    }

    /// The program, what records it anew, and what it is of.
    fn anew(self) -> (Anew<'a>, Kind) {
        let kind = (self.slip_rates, self.free, self.symmetric);
        let program = (self.record)(&vec![1.0; self.variables]);
        ((program, Some(self.record)), kind)
    }

    fn reference(self) -> Box<dyn Trajectory + 'a> {
        let (anew, (watched, ..)) = self.anew();
        let zero = DoubleDouble::ZERO;
        Box::new(Interpreted::new(anew, watched, REFERENCE_ROOM, zero))
    }

    fn reference_tangent(self) -> Box<dyn Trajectory + 'a> {
        let (anew, (watched, free, symmetric)) = self.anew();
        let zero = DoubleDouble::ZERO;
        let solution = Interpreted::new(anew, watched, REFERENCE_ROOM, zero);
        let kind = (free, symmetric);
        Box::new(Linearised::new(solution, kind, REFERENCE_ROOM, zero))
    }

    fn transport(self, start: &[Jet3]) -> Transported<'a> {
        let (anew, (watched, ..)) = self.anew();
        Transported::new(anew, watched, ROOM, start)
    }
}

#[cfg_attr(not(target_arch = "x86_64"), allow(unused_mut))]
fn solution_of<'b>(
    (mut program, record): Anew<'b>,
    (watched, ..): Kind,
) -> Box<dyn Trajectory + 'b> {
    #[cfg(target_arch = "x86_64")]
    if let Some(simd) = avx2()
        && let Some(program) = program.in_two_lanes()
    {
        let any = Pair::new(simd, [0.0; 2]);
        return Box::new(Interpreted::new((program, record), watched, ROOM, any));
    }
    Box::new(Interpreted::new((program, record), watched, ROOM, 0.0))
}

fn tangent_of<'b>(anew: Anew<'b>, (watched, free, symmetric): Kind) -> Box<dyn Trajectory + 'b> {
    let kind = (free, symmetric);
    let solution = Interpreted::new(anew, watched, ROOM, 0.0);
    #[cfg(target_arch = "x86_64")]
    if let Some(simd) = avx2() {
        let any = Four::new(simd, [0.0; 4]);
        return Box::new(Linearised::new(solution, kind, ROOM, any));
    }
    Box::new(Linearised::new(solution, kind, ROOM, 0.0))
}

/// A trajectory whose number of dimensions the compiler knows: N, of which so many are variables.
struct Known<T, const N: usize>(T, usize);

impl<T, const N: usize> Known<T, N> {
    /// What is made for each variable, and nothing for the rest.
    fn each<X: Default>(&self, make: impl Fn(usize) -> X) -> [X; N] {
        std::array::from_fn(|i| if i < self.1 { make(i) } else { X::default() })
    }
}

impl<T: Deref<Target: Trajectory> + DerefMut, const N: usize> Solution<N> for Known<T, N> {
    fn order(&self, rtol: f64) -> usize {
        self.0.order(rtol)
    }

    fn start(&mut self, y: &[f64; N]) {
        self.0.start(&y[..self.1]);
    }

    fn advance(&mut self, accuracy: &Accuracy, limit: DoubleDouble) -> DoubleDouble {
        self.0.advance(accuracy, limit)
    }

    fn rejected(&self) -> usize {
        self.0.rejected()
    }

    fn state(&self) -> [f64; N] {
        self.each(|i| self.0.state(i))
    }

    fn expansion(&self, order: usize, into: &mut Expansion<N>) {
        into.order = order;
        into.unit = self.0.unit();
        into.chart = |x| x;
        for (i, variable) in into.variables.iter_mut().enumerate().take(self.1) {
            self.0.series(i, &mut variable[..=order]);
        }
        // A single interface stands in both places.
        let sliding = self.0.sliding().max(2);
        into.slip_rates.resize(sliding, [0.0; REFERENCE_ROOM]);
        for (i, rates) in into.slip_rates.iter_mut().enumerate() {
            self.0.slip_rates(i, &mut rates[..order]);
        }
    }
}

impl<const N: usize, T: Deref<Target: Trajectory> + DerefMut> Tangent<N> for Known<T, N> {
    fn derivatives(&self) -> Derivatives<N> {
        let column = |at: usize| self.each(|i| self.0.derivative(i, at));
        let (log_determinant, log_transverse) = self.0.log_growth();
        Derivatives {
            start: std::array::from_fn(|at| if at < self.1 { column(at) } else { [0.0; N] }),
            parameters: (0..self.0.free()).map(|i| column(self.1 + i)).collect(),
            log_determinant,
            log_transverse,
        }
    }

    fn derivative_series(&self, variable: usize, order: usize, into: &mut Vec<f64>) -> bool {
        into.clear();
        for k in 0..=order {
            self.0.derivative_level(variable, k, into);
        }
        true
    }
}

impl<const N: usize> TaylorMap<N> for Known<Box<Transported<'_>>, N> {
    fn polynomials(&self) -> [Jet3; N] {
        self.each(|i| self.0.polynomial(i))
    }

    fn after(&self, time: Jet3) -> [[Jet3; N]; 2] {
        let each: [[Jet3; 2]; N] = self.each(|i| self.0.after(i, time));
        [0, 1].map(|k| each.map(|both| both[k]))
    }
}

/// Equations whose solutions are made by a recorded formula.
pub trait ByRecording<'a, const N: usize>: Sized {
    /// The formula; with the places of parameters its derivatives in the variables and in these.
    fn recording(self, free: Option<&[usize]>) -> Recording<'a>;

    /// A solution.
    fn solution(self) -> Box<dyn Solution<N> + 'a> {
        let recording = self.recording(None);
        let variables = recording.variables;
        Box::new(Known(recording.solution(), variables))
    }

    /// A solution in 31 digits.
    fn reference(self) -> Box<dyn Solution<N> + 'a> {
        let recording = self.recording(None);
        let variables = recording.variables;
        Box::new(Known(recording.reference(), variables))
    }

    /// A solution with its derivatives in its start and in the parameters of these places.
    fn tangent(self, free: &[usize]) -> Box<dyn Tangent<N> + 'a> {
        let recording = self.recording(Some(free));
        let variables = recording.variables;
        Box::new(Known(recording.tangent(), variables))
    }

    /// The same in 31 digits.
    fn reference_tangent(self, free: &[usize]) -> Box<dyn Tangent<N> + 'a> {
        let recording = self.recording(Some(free));
        let variables = recording.variables;
        Box::new(Known(recording.reference_tangent(), variables))
    }

    /// A solution to third order in two variations, which are those of this start.
    fn transport(self, start: [Jet3; N]) -> Box<dyn TaylorMap<N> + 'a> {
        let recording = self.recording(None);
        let variables = recording.variables;
        let map = recording.transport(&start[..variables]);
        Box::new(Known(Box::new(map), variables))
    }
}

impl<'a, S: Equations<N, P> + 'a, const N: usize, const P: usize> ByRecording<'a, N>
    for Recorded<S, N, P>
{
    fn recording(self, free: Option<&[usize]>) -> Recording<'a> {
        let free = free.map(<[usize]>::to_vec);
        let constant = self.parameters.map(f64::constant);
        let slip_rates = self.equations.slip_rates([1.0; N], constant);
        Recording {
            slip_rates: slip_rates.iter().flatten().count(),
            symmetric: self.symmetric,
            variables: N,
            free: free.as_ref().map_or(0, Vec::len),
            record: Box::new(move |x| {
                let graph = Graph::default();
                let x = std::array::from_fn(|i| graph.variable(i, x[i]));
                let p = std::array::from_fn(|q| graph.variable(N + q, self.parameters[q]));
                let rates = self.equations.rates(x, p);
                let slip_rates = self.equations.slip_rates(x, p);
                let all = (&rates[..], &slip_rates[..]);
                formula(&graph, all, free.as_deref()).program(&self.parameters)
            }),
            formulas: None,
        }
    }
}

/// Right-hand sides that are known when the program runs, at given parameters, whose solutions are made by their recorded
/// formulas.
#[derive(Debug, Clone, Copy)]
pub struct RecordedExpressions<'a, const N: usize> {
    /// The right-hand sides, N of them at most, and as many variables.
    pub rates: &'a Arc<Expressions>,
    /// The slip rates of the interfaces, where there are any: one or two.
    pub slip_rates: Option<&'a Arc<Expressions>>,
    /// The parameters.
    pub parameters: &'a [f64],
}

impl<'a, const N: usize> ByRecording<'a, N> for RecordedExpressions<'a, N> {
    fn recording(self, free: Option<&[usize]>) -> Recording<'a> {
        let variables = self.rates.count();
        Recording::of_expressions(
            (self.rates, self.slip_rates),
            variables,
            self.parameters,
            free,
        )
    }
}

/// The formulas at a state, in one lane and, where they have two parts that are alike, in two: to be run in loops and compiled, for tests.
#[cfg_attr(not(target_arch = "x86_64"), allow(unused_mut))]
pub fn both_ways(
    rates: &Arc<Expressions>,
    parameters: &[f64],
    (state, free): (&[f64], Option<&[usize]>),
) -> Vec<Box<dyn BothWays>> {
    let recording = Recording::of_expressions((rates, None), state.len(), parameters, free);
    let mut program = (recording.record)(state);
    let mut all = Vec::new();
    all.extend(compiled::both_ways(&program, ROOM, (state.to_vec(), 0.0)));
    #[cfg(target_arch = "x86_64")]
    if let Some(simd) = avx2()
        && let Some(program) = program.in_two_lanes()
    {
        let any = Pair::new(simd, [0.0; 2]);
        let mut lanes = vec![any; program.variables()];
        for (&(row, lane), &x) in program.places.iter().zip(state) {
            lanes[row] = if lane == 0 {
                any.like(x)
            } else {
                lanes[row].with_lane(lane, x)
            };
        }
        all.extend(compiled::both_ways(&program, ROOM, (lanes, any)));
    }
    all
}

/// The series of the derivatives of the formulas' solution at a state, in its components and in the parameters of these places, in loops and
/// compiled, for tests; `None` where they are not compiled.
pub fn columns_both_ways(
    rates: &Arc<Expressions>,
    parameters: &[f64],
    (state, free): (&[f64], &[usize]),
    (order, unit): (usize, f64),
) -> Option<[Vec<f64>; 2]> {
    #[cfg(target_arch = "x86_64")]
    if let Some(simd) = avx2() {
        let n = state.len();
        let recording = Recording::of_expressions((rates, None), n, parameters, Some(free));
        let program = (recording.record)(state);
        let (of, any) = ((&program, free.len()), Four::new(simd, [0.0; 4]));
        return compiled::columns_both_ways(of, state, (order, unit), (ROOM, any));
    }
    let _ = (rates, parameters, state, free, order, unit);
    None
}

impl<'a> Recording<'a> {
    /// As of [`ByRecording::recording`].
    fn of_expressions(
        (rates, slip_rates): (&'a Arc<Expressions>, Option<&'a Arc<Expressions>>),
        variables: usize,
        parameters: &'a [f64],
        free: Option<&[usize]>,
    ) -> Self {
        let formulas = Formulas {
            rates,
            slip_rates,
            variables,
            parameters,
            free: free.map(<[usize]>::to_vec),
            own_factors: OnceCell::new(),
        };
        Recording {
            slip_rates: slip_rates.map_or(0, |all| all.count()),
            symmetric: false,
            variables,
            free: free.map_or(0, <[usize]>::len),
            formulas: Some(formulas.clone()),
            record: Box::new(move |x| {
                let record = || {
                    let graph = Graph::default();
                    let place = |(i, &value): (usize, &f64)| graph.variable(i, value);
                    let x: Vec<_> = x.iter().enumerate().map(place).collect();
                    let beside = |(q, &value): (usize, &f64)| graph.variable(variables + q, value);
                    let p: Vec<_> = parameters.iter().enumerate().map(beside).collect();
                    let made = rates.evaluate(&x, &p);
                    // The same nodes as of the rates, as far as these have them.
                    let slip_rates = slip_rates.map_or_else(Vec::new, |v| v.evaluate(&x, &p));
                    let slip_rates: Vec<_> = slip_rates.into_iter().map(Some).collect();
                    let all = (&made[..], &slip_rates[..]);
                    formula(&graph, all, formulas.free.as_deref())
                };
                formulas.program(record)
            }),
        }
    }
}

/// The formula of these rates and slip rates. Its outputs: the rates, the slip rates, and with places of parameters the Jacobian
/// row by row and for each rate its derivatives in these.
fn formula(
    graph: &Graph,
    (rates, slip_rates): (&[Traced<'_>], &[Option<Traced<'_>>]),
    free: Option<&[usize]>,
) -> RecordedFormula {
    let n = rates.len();
    let mut outputs = rates.to_vec();
    outputs.extend(slip_rates.iter().flatten());
    let mut append = |variables: Vec<usize>| {
        let columns = variables.into_iter().map(|i| graph.derivatives(rates, i));
        let columns: Vec<Vec<Traced<'_>>> = columns.collect();
        for i in 0..n {
            outputs.extend(columns.iter().map(|column| column[i]));
        }
    };
    if let Some(free) = free {
        append((0..n).collect());
        append(free.iter().map(|q| n + q).collect());
    }
    RecordedFormula::new(graph, n, &outputs)
}
