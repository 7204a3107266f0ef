//! Signs, and signed powers: quotients such as z/|z| are the sign of z, also at z = 0, and products such as |z|^q z are rewritten as |z|^(q + 1) with the sign of z. Its derivative (q + 1) |z|^q is finite at z = 0,
//! where the derivative of |z|^q alone may be infinite.

use super::ratios::Factor;
use super::{Binary, Builder, Function, Operation, Place};
use crate::error::Result;

impl Builder {
    /// Returns the product of these two with a signed power in it, if a factor |z|^q meets a factor z.
    pub(super) fn with_signed_power(&mut self, a: Place, b: Place) -> Result<Option<Place>> {
        let mut factors = Vec::new();
        self.factors(a, true, &mut factors);
        self.factors(b, true, &mut factors);
        for (i, &factor) in factors.iter().enumerate() {
            let Some((absolute, argument, exponent)) = self.power_of_absolute(factor.place) else {
                continue;
            };
            let meets = |other: &Factor| other.above && other.place == argument;
            let (true, Some(at)) = (factor.above, factors.iter().position(meets)) else {
                continue;
            };
            let exponent = match exponent {
                None => self.number(1.5)?,
                Some(place) => {
                    let one = self.number(1.0)?;
                    self.binary(Binary::Sum, place, one)?
                }
            };
            let power = self.binary(Binary::Power, absolute, exponent)?;
            let signed = self.place(Operation::Signed(power, argument))?;
            let mut all = factors.clone();
            all[i].place = signed;
            all.remove(at);
            return self.product(all, std::iter::empty()).map(Some);
        }
        Ok(None)
    }

    /// Returns the quotient with a sign in place of z/|z|, if a factor z is over |z|.
    pub(super) fn with_sign(&mut self, over: Place, under: Place) -> Result<Option<Place>> {
        let Operation::Call(Function::Abs, argument) = self.operations[under] else {
            return Ok(None);
        };
        let mut factors = Vec::new();
        self.factors(over, true, &mut factors);
        let meets = |factor: &Factor| factor.above && factor.place == argument;
        let Some(at) = factors.iter().position(meets) else {
            return Ok(None);
        };
        let one = self.number(1.0)?;
        factors[at].place = self.place(Operation::Signed(one, argument))?;
        self.product(factors, std::iter::empty()).map(Some)
    }

    /// Returns |z|, z and q if the operation is |z|^q; q is `None` for a square root.
    fn power_of_absolute(&self, place: Place) -> Option<(Place, Place, Option<Place>)> {
        let (absolute, exponent) = match self.operations[place] {
            Operation::Power(a, q) => (a, Some(q)),
            Operation::Call(Function::Sqrt, a) => (a, None),
            _ => return None,
        };
        match self.operations[absolute] {
            Operation::Call(Function::Abs, argument) => Some((absolute, argument, exponent)),
            _ => None,
        }
    }
}
