//! Formulas in other units of their variables and of time.

use super::{Binary, Builder, Expressions};
use crate::error::Result;

impl Expressions {
    /// The same rates of the variables in these units, in time in its unit: of X = x/size, dX/dT = (time/size) f(size X). Where the units are
    /// powers of two no rounding is added.
    ///
    /// # Errors
    /// As of [`Builder::variable`].
    pub fn in_units(&self, sizes: &[f64], time: f64, parameters: usize) -> Result<Self> {
        let mut builder = Builder::default();
        let variables: Result<Vec<_>> = sizes
            .iter()
            .enumerate()
            .map(|(i, &size)| {
                let variable = builder.variable(i)?;
                builder.times(variable, size)
            })
            .collect();
        let parameters: Result<Vec<_>> = (0..parameters).map(|q| builder.parameter(q)).collect();
        let rates = builder.insert(self, &variables?, &parameters?)?;
        let rates: Result<Vec<_>> = rates
            .into_iter()
            .zip(sizes)
            .map(|(rate, size)| builder.times(rate, time / size))
            .collect();
        Ok(builder.complete(rates?))
    }
}

impl Builder {
    pub(super) fn times(&mut self, place: super::Place, factor: f64) -> Result<super::Place> {
        if factor == 1.0 {
            return Ok(place);
        }
        let factor = self.number(factor)?;
        self.binary(Binary::Product, factor, place)
    }
}
