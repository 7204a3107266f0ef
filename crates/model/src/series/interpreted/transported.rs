//! Solutions to third order in variations of their start.

use super::{Anew, Interpreted, Trajectory};
use crate::number::DoubleDouble;
use crate::series::Accuracy;
use crate::series::cubic::Jet3;
use crate::series::linearised::longest_of_columns;

/// A solution to third order in two variations of its start.
pub(in crate::series) struct Transported<'a> {
    solution: Interpreted<'a, Jet3>,
    start: Vec<Jet3>,
    order: usize,
}

impl<'a> Transported<'a> {
    /// To be started; the variations of the start are those of `start`.
    pub fn new(anew: Anew<'a>, watched: usize, room: usize, start: &[Jet3]) -> Self {
        Transported {
            solution: Interpreted::new(anew, watched, room, Jet3::default()),
            start: start.to_vec(),
            order: 0,
        }
    }

    /// The i-th variable of the state reached.
    pub fn polynomial(&self, i: usize) -> Jet3 {
        self.solution.reached.x[i]
    }

    /// The i-th variable, and its time derivative, at a time after the beginning of the last step.
    pub fn after(&self, i: usize, time: Jet3) -> [Jet3; 2] {
        let one_over = 1.0 / self.solution.unit;
        let h = time.scaled(one_over);
        let (mut state, mut rate) = (Jet3::default(), Jet3::default());
        for c in self.solution.rows.row(i)[..=self.order].iter().rev() {
            rate = rate * h + state;
            state = state * h + *c;
        }
        [state, rate.scaled(one_over)]
    }

    /// The step, in units of the series and at most `most`, at which the last terms of every monomial are below the tolerance.
    fn longest(&self, accuracy: &Accuracy, most: f64) -> f64 {
        let rows = &self.solution.rows;
        let size = |monomial: usize, k: usize| {
            let relative = |i: usize| {
                let series = rows.row(i);
                series[k].0[monomial].abs() / (1.0 + series[0].value().abs())
            };
            (0..self.start.len()).map(relative).fold(0.0, f64::max)
        };
        let ends = [0, 1, accuracy.order - 1, accuracy.order];
        let of = |monomial| longest_of_columns(accuracy, most, ends.map(|k| size(monomial, k)));
        (0..10).map(of).fold(most, f64::min)
    }
}

impl Trajectory for Transported<'_> {
    fn start(&mut self, y: &[f64]) {
        let mut x = self.start.clone();
        for (x, y) in x.iter_mut().zip(y) {
            x.0[0] = *y;
        }
        self.solution.begin(&x);
    }

    fn advance(&mut self, accuracy: &Accuracy, limit: DoubleDouble) -> DoubleDouble {
        self.order = accuracy.order;
        self.solution.expand(accuracy.order);
        let in_units = (limit.hi() / self.solution.unit).abs();
        let most = f64::min(self.solution.longest(accuracy), in_units);
        let h = self.longest(accuracy, most);
        self.solution.advance_by(accuracy, h, limit)
    }

    fn rejected(&self) -> usize {
        self.solution.rejected
    }

    fn state(&self, i: usize) -> f64 {
        self.solution.state(i)
    }

    fn unit(&self) -> f64 {
        self.solution.unit
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
}
