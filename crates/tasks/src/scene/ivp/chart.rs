//! Between the values that the user knows and the variables that are integrated.

use crate::scene::any_system::AnySystem;
use crate::scene::equations::Subspace;
use crate::scene::system::Described;
use crate::scene::units::Quantity;
use twinslip::error::{Error, Result};
use twinslip::number::Real;

/// What the variables of a field mean: of interfaces the first is tau and the others are ln psi, dimensionless; of a system all are
/// the user's.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Chart {
    /// How many variables the field has, without time, which may be one more.
    pub variables: usize,
    /// Whether they are tau and ln psi.
    pub slides: bool,
    /// Whether the last variable is that of two interfaces, which move alike.
    pub doubled: bool,
    /// One unit of time, stress and psi in the user's units.
    pub units: [f64; 3],
}

/// What a polynomial gives.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Given {
    /// The variables.
    Variables,
    /// tau and psi.
    States,
}

impl Chart {
    pub fn new(system: &AnySystem, subspace: Subspace) -> Self {
        use Quantity::{State, Stress, Time};
        let doubled = subspace == Subspace::Symmetric;
        Chart {
            variables: system.states().len() - usize::from(doubled),
            slides: system.slides(),
            doubled,
            units: [Time, Stress, State].map(|quantity| system.units().factor(quantity)),
        }
    }

    /// How many values the user knows.
    pub fn values(&self) -> usize {
        self.variables + usize::from(self.doubled)
    }

    /// Dimensionless time.
    pub fn time_inward(&self, time: f64) -> f64 {
        time / self.units[0]
    }

    /// The user's time.
    pub fn time_outward(&self, time: f64) -> f64 {
        time * self.units[0]
    }

    /// Appends the user's values.
    pub fn outward(&self, y: &[f64], given: Given, into: &mut Vec<f64>) {
        let [_, stress, state] = self.units;
        if !self.slides {
            into.extend_from_slice(&y[..self.variables]);
            return;
        }
        let psi = |&x: &f64| match given {
            Given::Variables => x.exp() * state,
            // As the series itself is taken to the variables.
            Given::States => x.max(f64::MIN_POSITIVE) * state,
        };
        into.push(y[0] * stress);
        into.extend(y[1..self.variables].iter().map(psi));
        if self.doubled {
            into.extend(y.last().map(psi));
        }
    }

    /// The user's values, in numbers of any kind.
    pub fn outward_of<T: Real>(&self, y: &[T], given: Given) -> Vec<T> {
        if !self.slides {
            return y.to_vec();
        }
        let [_, stress, state] = self.units;
        let psi = |&x: &T| match given {
            Given::Variables => x.exp() * state,
            Given::States => x * state,
        };
        let mut values = vec![y[0] * stress];
        values.extend(y[1..self.variables].iter().map(psi));
        if self.doubled {
            values.extend(y.last().map(psi));
        }
        values
    }

    /// As numbers.
    pub fn to_numbers(self) -> Vec<f64> {
        let mut numbers = vec![
            self.variables as f64,
            f64::from(u8::from(self.slides)),
            f64::from(u8::from(self.doubled)),
        ];
        numbers.extend(self.units);
        numbers
    }

    /// From these numbers.
    pub fn from_numbers(numbers: &[f64]) -> Result<Self> {
        let wrong = || {
            Error::Input(format!(
                "`chart` of a solution is {numbers:?}, but must be the six numbers that a solution gave"
            ))
        };
        let &[variables, slides, doubled, time, stress, state] = numbers else {
            return Err(wrong());
        };
        let truth = |x: f64| match x {
            0.0 => Ok(false),
            1.0 => Ok(true),
            _ => Err(wrong()),
        };
        let chart = Chart {
            variables: variables as usize,
            slides: truth(slides)?,
            doubled: truth(doubled)?,
            units: [time, stress, state],
        };
        let least = if chart.slides { 2 } else { 1 };
        let whole = chart.variables as f64 == variables && chart.variables >= least;
        let scaled = chart.units.iter().all(|x| *x > 0.0 && x.is_finite());
        if whole && scaled && (chart.slides || !chart.doubled) {
            Ok(chart)
        } else {
            Err(wrong())
        }
    }
}
