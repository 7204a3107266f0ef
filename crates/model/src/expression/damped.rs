//! A slip rate that is given as a formula solved for the stress, and with radiation damping: tau - eta v stands in the place of tau.
//!
//! With damping v is defined by an equation. Where the formula is w s(k tau), with s one of sinh and exp and with w and k that the stress does not
//! change, as those of rate-and-state laws are, that is y + g(y) = k tau of y = k (tau - eta v) and g(y) = k eta v = (k eta w) s(y): see
//! [`crate::number::Balance`].

use super::{Activation, Binary, Builder, Expressions, Function, Operation, Place};
use crate::error::Result;

/// How an operation depends on the stress.
#[derive(Debug, Clone, Copy)]
enum Dependence {
    /// Not at all.
    None,
    /// k tau + b, b being 0 where there is none.
    Linear(Place, Option<Place>),
    /// w s(k tau).
    Activated(Place, Activation, Place),
    /// Otherwise.
    Other,
}

use Dependence::{Activated, Linear, Other};

impl Expressions {
    /// The slip rate, which is the one formula here and has the stress tau as its first variable, with tau - eta v in place of tau, where
    /// eta > 0 is the parameter of this place; `None` where it is not a factor times sinh or exp of a multiple of the stress.
    ///
    /// # Errors
    /// [`crate::error::Error::Input`] where there are too many operations.
    pub fn damped(&self, damping: usize) -> Result<Option<Expressions>> {
        let mut builder = Builder::default();
        let Some((factor, activation, slope)) = self.activated(&mut builder)? else {
            return Ok(None);
        };
        let (stress, damping) = (builder.variable(0)?, builder.parameter(damping)?);
        let drop = builder.binary(Binary::Product, slope, damping)?;
        let rate = builder.binary(Binary::Product, drop, factor)?;
        let argument = builder.binary(Binary::Product, slope, stress)?;
        let radiated = builder.place(Operation::Balanced(argument, rate, activation))?;
        let slip_rate = builder.binary(Binary::Quotient, radiated, drop)?;
        Ok(Some(builder.complete(vec![slip_rate])))
    }

    /// The stress at which the slip rate, which is the one formula here and has the stress as its first variable, is the first variable: s^-1(v/w)/k;
    /// `None` where it is not a factor times sinh or exp of a multiple of the stress.
    ///
    /// # Errors
    /// [`crate::error::Error::Input`] where there are too many operations.
    pub fn stress(&self) -> Result<Option<Expressions>> {
        let mut builder = Builder::default();
        let Some((factor, activation, slope)) = self.activated(&mut builder)? else {
            return Ok(None);
        };
        let v = builder.variable(0)?;
        let ratio = builder.binary(Binary::Quotient, v, factor)?;
        let inverse = match activation {
            Activation::Sinh => Function::Asinh,
            Activation::Exponential => Function::Ln,
        };
        let argument = builder.call(inverse, &[ratio])?;
        let stress = builder.binary(Binary::Quotient, argument, slope)?;
        Ok(Some(builder.complete(vec![stress])))
    }

    /// w, s and k of the one formula w s(k tau); `None` where it is none of these.
    fn activated(&self, builder: &mut Builder) -> Result<Option<(Place, Activation, Place)>> {
        let one = builder.number(1.0)?;
        let mut places: Vec<Place> = Vec::with_capacity(self.operations.len());
        let mut depends: Vec<Dependence> = Vec::with_capacity(self.operations.len());
        for operation in &self.operations {
            let place = builder.place(operation.moved(|place| places[place]))?;
            let of = |operand: Place| (places[operand], depends[operand]);
            depends.push(match *operation {
                Operation::Variable(0) => Linear(one, None),
                operation => dependence(builder, operation, of)?,
            });
            places.push(place);
        }
        Ok(match self.outputs[..] {
            [output] => match depends[output] {
                Activated(factor, activation, slope) => Some((factor, activation, slope)),
                _ => None,
            },
            _ => None,
        })
    }
}

/// How the result of an operation depends on the stress, from its operands: where they are now, and how they depend on it.
fn dependence(
    builder: &mut Builder,
    operation: Operation,
    of: impl Fn(Place) -> (Place, Dependence),
) -> Result<Dependence> {
    let mut operands = Vec::new();
    let _ = operation.moved(|operand| {
        operands.push(of(operand));
        operand
    });
    if operands
        .iter()
        .all(|(_, depends)| matches!(depends, Dependence::None))
    {
        return Ok(Dependence::None);
    }
    Ok(match (operation, &operands[..]) {
        (Operation::Negative(_), &[(_, Linear(k, b))]) => {
            let b = b.map(|b| builder.negative(b)).transpose()?;
            Linear(builder.negative(k)?, b)
        }
        (Operation::Negative(_), &[(_, Activated(w, s, k))]) => {
            Activated(builder.negative(w)?, s, k)
        }
        (Operation::Sum(..), &[(_, Linear(k, b)), (other, Dependence::None)])
        | (Operation::Sum(..), &[(other, Dependence::None), (_, Linear(k, b))]) => {
            let sum = b.map(|b| builder.binary(Binary::Sum, b, other));
            Linear(k, Some(sum.unwrap_or(Ok(other))?))
        }
        (Operation::Difference(..), &[(_, Linear(k, b)), (other, Dependence::None)]) => {
            let less = match b {
                Some(b) => builder.binary(Binary::Difference, b, other)?,
                None => builder.negative(other)?,
            };
            Linear(k, Some(less))
        }
        (Operation::Difference(..), &[(other, Dependence::None), (_, Linear(k, b))]) => {
            let less = b.map(|b| builder.binary(Binary::Difference, other, b));
            Linear(builder.negative(k)?, Some(less.unwrap_or(Ok(other))?))
        }
        (Operation::Product(..), &[(_, of_stress), (other, Dependence::None)])
        | (Operation::Product(..), &[(other, Dependence::None), (_, of_stress)]) => {
            times(builder, of_stress, (Binary::Product, other))?
        }
        (Operation::Quotient(..), &[(_, of_stress), (other, Dependence::None)]) => {
            times(builder, of_stress, (Binary::Quotient, other))?
        }
        (Operation::Call(Function::Sinh, _), &[(_, Linear(k, None))]) => {
            Activated(builder.number(1.0)?, Activation::Sinh, k)
        }
        (Operation::Call(Function::Exp, _), &[(_, Linear(k, b))]) => {
            let factor = match b {
                Some(b) => builder.call(Function::Exp, &[b])?,
                None => builder.number(1.0)?,
            };
            Activated(factor, Activation::Exponential, k)
        }
        _ => Other,
    })
}

/// What depends on the stress so, times another number or over it.
fn times(
    builder: &mut Builder,
    of_stress: Dependence,
    (binary, other): (Binary, Place),
) -> Result<Dependence> {
    Ok(match of_stress {
        Linear(k, b) => {
            let b = b.map(|b| builder.binary(binary, b, other)).transpose()?;
            Linear(builder.binary(binary, k, other)?, b)
        }
        Activated(w, s, k) => Activated(builder.binary(binary, w, other)?, s, k),
        kept => kept,
    })
}
