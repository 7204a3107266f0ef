//! A system whose equations are read when the program runs, as a vector field: everything from its formulas.

mod derivatives;

use crate::error::{Error, Result};
use crate::expression::{ColumnGroups, Expressions};
use crate::field::{
    Analytic, ExactField, Jacobian, Parametrised, SecondDerivative, State, VectorField,
    jacobian_of_rows, state,
};
use crate::number::{DoubleDouble, Interval, Real};
use crate::series::{ByRecording, Jet3, RecordedExpressions, Solution, Tangent, TaylorMap};
use std::borrow::Cow;
use std::collections::BTreeSet;
use std::sync::{Arc, Mutex, OnceLock};

/// Equations with the names of their variables and parameters, at values of the latter.
#[derive(Debug, Clone, PartialEq)]
pub struct TextSystem {
    rates: Arc<Expressions>,
    /// Variables along which the rates are differentiated together.
    columns: Arc<ColumnGroups>,
    slip_rates: Option<Arc<Expressions>>,
    states: Vec<&'static str>,
    /// Whether the formulas name time: it is then one variable more, the last, and its rate is 1.
    is_timed: bool,
    /// Whether the last state is the phase of a periodic forcing.
    is_forced: bool,
    names: Vec<&'static str>,
    parameters: Vec<f64>,
    /// The units of the states, in those of the formulas as they were read.
    sizes: Vec<f64>,
}

impl TextSystem {
    /// As many variables as there are, at most.
    pub const LARGEST: usize = 100;

    /// The rates of the states, one for each, in the states and the parameters by their places in these lists.
    ///
    /// # Errors
    /// [`Error::Parameter`] unless there are 1 to [`TextSystem::LARGEST`] states.
    pub fn new(rates: Expressions, states: &[&str], parameters: &[(&str, f64)]) -> Result<Self> {
        if !(1..=Self::LARGEST).contains(&states.len()) {
            let must = format!("from 1 to {}", Self::LARGEST);
            return Err(Error::parameter("the number of states", states.len(), must));
        }
        Ok(TextSystem {
            columns: Arc::new(rates.column_groups(rates.count())),
            rates: Arc::new(rates),
            slip_rates: None,
            states: states.iter().map(|name| kept(name)).collect(),
            is_timed: false,
            is_forced: false,
            names: parameters.iter().map(|(name, _)| kept(name)).collect(),
            parameters: parameters.iter().map(|(_, value)| *value).collect(),
            sizes: vec![1.0; states.len()],
        })
    }

    /// The same where formulas name time: the rates of the states in these, in time, which is the variable after them, and in the parameters;
    /// and the rate of time after theirs, which is 1. So a start has the initial time after the values of the states.
    ///
    /// # Errors
    /// [`Error::Parameter`] unless there are 1 to [`TextSystem::LARGEST`] - 1 states.
    ///
    /// # Panics
    /// Where there is not one rate more than there are states.
    pub fn in_time(
        rates: Expressions,
        states: &[&str],
        parameters: &[(&str, f64)],
    ) -> Result<Self> {
        assert_eq!(rates.count(), states.len() + 1, "the last rate is of time");
        if states.len() >= Self::LARGEST {
            let must = format!("at most {} beside time", Self::LARGEST - 1);
            return Err(Error::parameter("the number of states", states.len(), must));
        }
        Ok(TextSystem {
            is_timed: true,
            ..Self::new(rates, states, parameters)?
        })
    }

    /// The same system, whose last state is the phase of a periodic forcing: a whole turn is 1, and the formulas are the same after it.
    pub fn forced(self) -> Self {
        TextSystem {
            is_forced: true,
            ..self
        }
    }

    /// The place of the state that is the phase of a periodic forcing, and what a whole turn of it is in the unit of that state.
    pub fn phase(&self) -> Option<(usize, f64)> {
        let last = self.states.len() - 1;
        self.is_forced.then(|| (last, 1.0 / self.sizes[last]))
    }

    /// The period of the forcing, where there is one.
    pub fn forcing_period(&self) -> Option<f64> {
        let (place, turn) = self.phase()?;
        let rates: Vec<f64> = self.rates(&vec![0.0; self.variables()]);
        Some(turn / rates[place])
    }

    /// The same of interfaces that slide, with their slip rates in the same states and parameters. Where there is a rate more than there are
    /// states the last one is of time, as of [`TextSystem::in_time`].
    ///
    /// # Errors
    /// As of [`TextSystem::new`].
    pub fn sliding(
        (rates, slip_rates): (Expressions, Expressions),
        states: &[&str],
        parameters: &[(&str, f64)],
    ) -> Result<Self> {
        let system = match rates.count() > states.len() {
            true => Self::in_time(rates, states, parameters)?,
            false => Self::new(rates, states, parameters)?,
        };
        Ok(TextSystem {
            slip_rates: Some(Arc::new(slip_rates)),
            ..system
        })
    }

    /// The same in other units of its states and of time, which are powers of two: all numbers are the same but for these factors.
    ///
    /// # Errors
    /// [`Error::Input`] where the formulas become too long.
    ///
    /// # Panics
    /// Of interfaces, whose states have units, for others than these.
    pub fn in_units(&self, sizes: &[f64], time: f64) -> Result<Self> {
        if time == 1.0 && sizes.iter().all(|size| *size == 1.0) {
            return Ok(self.clone());
        }
        assert!(self.slip_rates.is_none(), "interfaces have their own units");
        let of_time = self.is_timed.then_some(time);
        let units: Vec<f64> = sizes.iter().copied().chain(of_time).collect();
        let rates = self.rates.in_units(&units, time, self.names.len())?;
        Ok(TextSystem {
            rates: Arc::new(rates),
            sizes: self.sizes.iter().zip(sizes).map(|(x, y)| x * y).collect(),
            ..self.clone()
        })
    }

    /// The same in the logarithms of states that are factors of their own rates, of these signs; those whose sign is 0 stay as they are. `None`
    /// where the formulas don't show what a rate is over its state.
    ///
    /// # Errors
    /// [`Error::Input`] where the formulas become too long.
    pub fn in_logarithms(&self, signs: &[f64]) -> Result<Option<Self>> {
        let of_time = self.is_timed.then_some(0.0);
        let signs: Vec<f64> = signs.iter().copied().chain(of_time).collect();
        let rates = self.rates.in_logarithms(&signs, self.names.len())?;
        Ok(rates.map(|rates| TextSystem {
            columns: Arc::new(rates.column_groups(rates.count())),
            rates: Arc::new(rates),
            ..self.clone()
        }))
    }

    /// For every variable whether it is a factor of its own rate, which is 0 where it is.
    pub fn own_factors(&self) -> Vec<bool> {
        self.rates.own_factors(self.variables(), &self.parameters)
    }

    /// Whether the formulas take powers that are not whole, or roots: their slopes may be infinite at a zero of the base.
    pub fn takes_powers(&self) -> bool {
        self.rates.take_powers()
    }

    /// For every state whether it can be followed by its logarithm: it is a factor of its own rate, and the formulas show what that is over it.
    pub fn have_logarithms(&self) -> Vec<bool> {
        let mut all = self.own_factors();
        all.truncate(self.states.len());
        for (i, has) in all.iter_mut().enumerate().filter(|(_, own)| **own) {
            let mut signs = vec![0.0; self.states.len()];
            signs[i] = 1.0;
            *has = matches!(self.in_logarithms(&signs), Ok(Some(_)));
        }
        all
    }

    /// The units of the states, in those of the formulas as they were read.
    pub fn sizes(&self) -> &[f64] {
        &self.sizes
    }

    /// The number of variables: one for each state, and where formulas name time one more, the last.
    pub fn variables(&self) -> usize {
        self.states.len() + usize::from(self.is_timed)
    }

    /// Whether formulas name time, which is then the variable after the states.
    pub fn is_timed(&self) -> bool {
        self.is_timed
    }

    /// The names of the states.
    pub fn states(&self) -> &[&'static str] {
        &self.states
    }

    /// The names of the parameters.
    pub fn parameter_names(&self) -> &[&'static str] {
        &self.names
    }

    /// Their values.
    pub fn parameters(&self) -> &[f64] {
        &self.parameters
    }

    /// Gives the parameter of this name another value.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a name that is none.
    pub fn set(&mut self, name: &str, value: f64) -> Result<()> {
        let place = crate::field::place(&self.names, name)?;
        self.put(place, value);
        Ok(())
    }

    /// Gives the parameter at this place another value.
    ///
    /// # Panics
    /// Where there is none.
    pub fn put(&mut self, place: usize, value: f64) {
        self.parameters[place] = value;
    }

    /// The field.
    ///
    /// # Errors
    /// [`Error::Parameter`] where it has more than N variables.
    pub fn field<const N: usize>(&self) -> Result<TextField<'_, N>> {
        TextField::of(Cow::Borrowed(self))
    }

    /// The rates in numbers of any kind.
    ///
    /// # Panics
    /// Where x has fewer components than there are variables, as all that follow.
    pub fn rates<T: Real>(&self, x: &[T]) -> Vec<T> {
        let parameters: Vec<T> = self.parameters.iter().map(|&p| T::constant(p)).collect();
        self.rates.evaluate(x, &parameters)
    }

    /// The slip rates of all interfaces, in numbers of any kind; none where nothing slides.
    pub fn slip_rates<T: Real>(&self, x: &[T]) -> Vec<T> {
        let parameters: Vec<T> = self.parameters.iter().map(|&p| T::constant(p)).collect();
        let of = |formulas: &Arc<Expressions>| formulas.evaluate(x, &parameters);
        self.slip_rates.as_ref().map_or_else(Vec::new, of)
    }
}

/// The same name for as long as the program runs: fields have names that do not end. Each is kept once.
fn kept(name: &str) -> &'static str {
    static NAMES: Mutex<BTreeSet<&'static str>> = Mutex::new(BTreeSet::new());
    let mut names = NAMES.lock().unwrap_or_else(|held| held.into_inner());
    if let Some(known) = names.get(name) {
        return known;
    }
    let new: &'static str = Box::leak(name.to_owned().into_boxed_str());
    names.insert(new);
    new
}

/// A [`TextSystem`] of N variables, or of fewer ([`VectorField::dimension`]).
#[derive(Debug, Clone)]
pub struct TextField<'a, const N: usize> {
    system: Cow<'a, TextSystem>,
    /// Once they were asked for: each arc of an orbit asks.
    own_factors: OnceLock<[bool; N]>,
}

impl<'a, const N: usize> TextField<'a, N> {
    /// The field of a system that stays with its owner, or an owned one.
    ///
    /// # Errors
    /// [`Error::Parameter`] where the system has more than N variables.
    pub fn of(system: Cow<'a, TextSystem>) -> Result<Self> {
        let count = system.variables();
        if count > N {
            let must = format!("at most {N}, as many as the field is asked for");
            return Err(Error::parameter("the number of variables", count, must));
        }
        Ok(TextField {
            system,
            own_factors: OnceLock::new(),
        })
    }

    /// The variables among the components of a state.
    fn variables<'y>(&self, y: &'y State<N>) -> &'y [f64] {
        &y.as_slice()[..self.system.variables()]
    }

    fn matrix(&self, rows: &[f64]) -> Jacobian<N> {
        jacobian_of_rows(self.system.variables(), rows)
    }

    fn recorded(&self) -> RecordedExpressions<'_, N> {
        RecordedExpressions {
            rates: &self.system.rates,
            slip_rates: self.system.slip_rates.as_ref(),
            parameters: &self.system.parameters,
        }
    }
}

impl<const N: usize> VectorField<N> for TextField<'_, N> {
    fn f(&self, y: &State<N>) -> State<N> {
        let TextSystem {
            rates, parameters, ..
        } = &*self.system;
        state(&rates.evaluate(self.variables(y), parameters))
    }

    fn dimension(&self) -> usize {
        self.system.variables()
    }

    fn jacobian(&self, y: &State<N>) -> Jacobian<N> {
        self.matrix(&self.system.jacobian(self.variables(y)))
    }

    fn second_derivative(&self, y: &State<N>, u: &State<N>, v: &State<N>) -> State<N> {
        let made = self
            .system
            .second_derivative([y, u, v].map(|x| self.variables(x)));
        state(&made)
    }

    fn series_along(&self, curve: &[State<N>; 6]) -> Option<[State<N>; 6]> {
        let curve = curve.each_ref().map(|x| self.variables(x));
        Some(self.system.series_along(curve).map(|rates| state(&rates)))
    }

    fn second_derivatives(&self, y: &State<N>) -> Vec<SecondDerivative> {
        self.system.second_derivatives(self.variables(y))
    }

    fn exact(&self, y: &State<N>) -> Option<ExactField<N>> {
        /// What is left of the error of doubles, which intervals bound.
        const OF_DOUBLES: f64 = 2.0 * f64::EPSILON;
        let y = self.variables(y).iter();
        let x: Vec<DoubleDouble> = y.clone().map(|&y| y.into()).collect();
        let within: Vec<Interval> = y.map(|&y| Interval::constant(y)).collect();
        let doubles =
            |all: Vec<DoubleDouble>| -> Vec<f64> { all.into_iter().map(|x| x.to_f64()).collect() };
        // Where a bound is infinite, as around a kink, nothing is known of rounding there.
        let off = |all: Vec<Interval>| -> Vec<f64> {
            let width = all.into_iter().map(|x| OF_DOUBLES * (x.hi() - x.lo()));
            width.map(|x| if x.is_finite() { x } else { 0.0 }).collect()
        };
        let state = |all: Vec<f64>| state(&all);
        let matrix = |all: Vec<f64>| self.matrix(&all);
        Some(ExactField {
            f: [
                state(doubles(self.system.rates(&x))),
                state(off(self.system.rates(&within))),
            ],
            jacobian: [
                matrix(doubles(self.system.jacobian(&x))),
                matrix(off(self.system.jacobian(&within))),
            ],
        })
    }

    fn may_lack_slopes(&self) -> bool {
        true
    }

    fn own_factors(&self) -> [bool; N] {
        *self.own_factors.get_or_init(|| {
            let all = self.system.own_factors();
            std::array::from_fn(|i| all.get(i).is_some_and(|own| *own))
        })
    }

    fn last_is_time(&self) -> bool {
        self.system.is_timed
    }

    fn phase(&self) -> Option<(usize, f64)> {
        self.system.phase()
    }

    fn parametrised(&self) -> Option<&dyn Parametrised<N>> {
        Some(self)
    }

    fn analytic(&self) -> Option<&dyn Analytic<N>> {
        Some(self)
    }
}

impl<const N: usize> Parametrised<N> for TextField<'_, N> {
    fn names(&self) -> &[&'static str] {
        &self.system.names
    }

    fn parameter_derivative(&self, y: &State<N>, place: usize) -> State<N> {
        let y = self.variables(y);
        state(&self.system.parameter_derivative(y, place))
    }

    fn parameter_jacobian(&self, y: &State<N>, place: usize) -> Jacobian<N> {
        let y = self.variables(y);
        self.matrix(&self.system.parameter_jacobian(y, place))
    }
}

impl<const N: usize> Analytic<N> for TextField<'_, N> {
    fn solution(&self) -> Box<dyn Solution<N> + '_> {
        self.recorded().solution()
    }

    fn reference(&self) -> Box<dyn Solution<N> + '_> {
        self.recorded().reference()
    }

    fn tangent(&self, free: &[usize]) -> Box<dyn Tangent<N> + '_> {
        self.recorded().tangent(free)
    }

    fn reference_tangent(&self, free: &[usize]) -> Box<dyn Tangent<N> + '_> {
        self.recorded().reference_tangent(free)
    }

    fn transport(&self, start: [Jet3; N]) -> Option<Box<dyn TaylorMap<N> + '_>> {
        Some(self.recorded().transport(start))
    }
}
