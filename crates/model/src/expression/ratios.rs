//! Quotients such as u/(exp(u) - 1) and sin(u)/u, found where formulas are built: they are analytic where numerator and denominator
//! are 0, and evaluated by [`Ratio`](crate::number::Ratio) have all their digits there.
//!
//! The factors of a product are looked through for a function N(w) with N(0) = 0 on one side of the fraction bar and the factors of w on
//! the other, up to constants: 0.1 (25 - v)/(exp((25 - v)/10) - 1) is one.

use super::{Binary, Builder, Function, Operation, Place};
use crate::error::Result;
use crate::number::Numerator;

/// A factor, above the fraction bar or below.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Factor {
    pub place: Place,
    pub above: bool,
}

/// The factors that are left, and the numbers, each above the fraction bar or not.
type Cancelled = (Vec<Factor>, Vec<(f64, bool)>);

/// A sum of multiples of places, and of a constant, over the factor of the first place.
#[derive(Debug, Clone)]
struct Linear {
    factor: f64,
    terms: Vec<(Place, f64)>,
    constant: f64,
    /// Operations that were looked at.
    seen: usize,
}

/// Products of more factors and sums of more terms are not taken apart: what occurs twice in them would be looked at again and again.
const MOST: usize = 64;

impl Builder {
    /// The same as a product or quotient of these two, if it has such a part.
    pub(super) fn with_ratio(
        &mut self,
        a: Place,
        b: Place,
        binary: Binary,
    ) -> Result<Option<Place>> {
        let mut factors = Vec::new();
        self.factors(a, true, &mut factors);
        self.factors(b, binary == Binary::Product, &mut factors);
        for (i, &factor) in factors.iter().enumerate() {
            let beyond = |other: &Factor| other.above != factor.above && self.varies[other.place];
            if !factors.iter().any(beyond) {
                continue;
            }
            let Some((numerator, w, sign)) = self.zero_function(factor.place)? else {
                continue;
            };
            let mut rest = factors.clone();
            rest.remove(i);
            let Some((rest, numbers)) = self.without(&rest, w, !factor.above) else {
                continue;
            };
            let ratio = self.place(Operation::Ratio(numerator, w))?;
            let ratio = Factor {
                place: ratio,
                ..factor
            };
            let all = rest.into_iter().chain([ratio]).collect();
            return self
                .product(all, numbers.into_iter().chain([(sign, true)]))
                .map(Some);
        }
        Ok(None)
    }

    /// The factors of what stands at a place, numbers too.
    pub(super) fn factors(&self, place: Place, above: bool, into: &mut Vec<Factor>) {
        match self.operations[place] {
            _ if into.len() >= MOST => into.push(Factor { place, above }),
            Operation::Product(a, b) => {
                self.factors(a, above, into);
                self.factors(b, above, into);
            }
            Operation::Quotient(a, b) => {
                self.factors(a, above, into);
                self.factors(b, !above, into);
            }
            _ => into.push(Factor { place, above }),
        }
    }

    /// N, w and a sign, where a number of that sign times N(w) stands here.
    fn zero_function(&mut self, place: Place) -> Result<Option<(Numerator, Place, f64)>> {
        let exponent = |place: Place| match self.operations[place] {
            Operation::Call(Function::Exp, w) => Some(w),
            _ => None,
        };
        let one = |place: Place| self.known(place);
        let found = match self.operations[place] {
            Operation::Negative(a) => {
                let of = self.zero_function(a)?;
                return Ok(of.map(|(numerator, w, sign)| (numerator, w, -sign)));
            }
            Operation::Difference(a, b) => match (exponent(a), exponent(b)) {
                (Some(w), _) if one(b) == Some(1.0) => (Numerator::ExpM1, w, 1.0),
                (_, Some(w)) if one(a) == Some(1.0) => (Numerator::ExpM1, w, -1.0),
                _ => return Ok(None),
            },
            Operation::Sum(a, b) => match (exponent(a), exponent(b)) {
                (Some(w), _) if one(b) == Some(-1.0) => (Numerator::ExpM1, w, 1.0),
                (_, Some(w)) if one(a) == Some(-1.0) => (Numerator::ExpM1, w, 1.0),
                _ => return Ok(None),
            },
            Operation::Call(Function::Expm1, w) => (Numerator::ExpM1, w, 1.0),
            Operation::Call(Function::Sin, w) => (Numerator::Sin, w, 1.0),
            Operation::Call(Function::Sinh, w) => (Numerator::Sinh, w, 1.0),
            Operation::Call(Function::Tanh, w) => (Numerator::Tanh, w, 1.0),
            Operation::Call(Function::Log1p, w) => (Numerator::Ln1p, w, 1.0),
            Operation::Call(Function::Ln, x) => {
                let w = match self.operations[x] {
                    Operation::Sum(a, w) | Operation::Sum(w, a) if one(a) == Some(1.0) => w,
                    Operation::Difference(a, b) if one(a) == Some(1.0) => self.negative(b)?,
                    _ => {
                        let one = self.number(1.0)?;
                        self.place(Operation::Difference(x, one))?
                    }
                };
                (Numerator::Ln1p, w, 1.0)
            }
            _ => return Ok(None),
        };
        Ok(Some(found))
    }

    /// The factors over w, where they have all of its factors that vary above the fraction bar, on this side of it; and the numbers that are left, each
    /// above it or not.
    fn without(&self, factors: &[Factor], w: Place, above: bool) -> Option<Cancelled> {
        let mut of_w = Vec::new();
        self.factors(w, true, &mut of_w);
        let (mut rest, mut numbers, mut any) = (factors.to_vec(), Vec::new(), false);
        for factor in of_w {
            let side = factor.above == above;
            let linear = self.linear(factor.place);
            let same = |other: &Factor| {
                other.above == side && self.linear(other.place).is_multiple_of(&linear)
            };
            let varies = self.varies[factor.place];
            match rest.iter().position(same).filter(|_| varies) {
                Some(at) => {
                    let cancelled = self.linear(rest.remove(at).place);
                    if cancelled.factor != linear.factor {
                        numbers.extend([(cancelled.factor, side), (linear.factor, !side)]);
                    }
                    any |= factor.above;
                }
                None if varies && factor.above => return None,
                None => rest.push(Factor {
                    above: !side,
                    ..factor
                }),
            }
        }
        any.then_some((rest, numbers))
    }

    /// The product of these factors, divided by those that are not above, and numbers.
    pub(super) fn product(
        &mut self,
        factors: Vec<Factor>,
        numbers: impl Iterator<Item = (f64, bool)>,
    ) -> Result<Place> {
        let mut all = factors;
        for (x, above) in numbers {
            if x != 1.0 {
                let place = self.number(x)?;
                all.push(Factor { place, above });
            }
        }
        all.retain(|factor| self.known(factor.place) != Some(1.0));
        // Numbers first: their product is one.
        all.sort_by_key(|factor| (!factor.above, self.known(factor.place).is_none()));
        let mut made = None;
        for factor in all {
            made = Some(match (made, factor.above) {
                (None, true) => factor.place,
                (None, false) => {
                    let one = self.number(1.0)?;
                    self.place(Operation::Quotient(one, factor.place))?
                }
                (Some(made), true) => {
                    let (a, b) = (factor.place.min(made), factor.place.max(made));
                    self.place(Operation::Product(a, b))?
                }
                (Some(made), false) => self.place(Operation::Quotient(made, factor.place))?,
            });
        }
        made.map_or_else(|| self.number(1.0), Ok)
    }

    fn linear(&self, place: Place) -> Linear {
        let mut linear = Linear {
            factor: 1.0,
            terms: Vec::new(),
            constant: 0.0,
            seen: 0,
        };
        self.add_to(&mut linear, place, 1.0);
        linear.terms.retain(|(_, c)| *c != 0.0);
        linear.terms.sort_by_key(|(place, _)| *place);
        if let Some(&(_, factor)) = linear.terms.first() {
            linear.factor = factor;
            linear.terms.iter_mut().for_each(|(_, c)| *c /= factor);
            linear.constant /= factor;
        }
        linear
    }

    fn add_to(&self, linear: &mut Linear, place: Place, times: f64) {
        linear.seen += 1;
        match self.operations[place] {
            _ if linear.seen > MOST => linear.terms.push((place, times)),
            Operation::Number(bits) => linear.constant += times * f64::from_bits(bits),
            Operation::Negative(a) => self.add_to(linear, a, -times),
            Operation::Sum(a, b) => {
                self.add_to(linear, a, times);
                self.add_to(linear, b, times);
            }
            Operation::Difference(a, b) => {
                self.add_to(linear, a, times);
                self.add_to(linear, b, -times);
            }
            operation => {
                let multiple = match operation {
                    Operation::Product(a, b) => match (self.known(a), self.known(b)) {
                        (Some(x), _) => Some((b, times * x)),
                        (_, Some(x)) => Some((a, times * x)),
                        _ => None,
                    },
                    Operation::Quotient(a, b) => self.known(b).map(|x| (a, times / x)),
                    _ => None,
                };
                if let Some((of, times)) = multiple {
                    return self.add_to(linear, of, times);
                }
                match linear.terms.iter_mut().find(|(known, _)| *known == place) {
                    Some((_, c)) => *c += times,
                    None => linear.terms.push((place, times)),
                }
            }
        }
    }
}

impl Linear {
    /// Whether one is the other, but for their factors and the rounding of the numbers that a formula gives them by.
    fn is_multiple_of(&self, other: &Self) -> bool {
        const ROUNDED: f64 = 8.0 * f64::EPSILON;
        let same = |a: f64, b: f64| (a - b).abs() <= ROUNDED * a.abs().max(b.abs());
        let mut both = self.terms.iter().zip(&other.terms);
        !self.terms.is_empty()
            && self.terms.len() == other.terms.len()
            && same(self.constant, other.constant)
            && both.all(|(a, b)| a.0 == b.0 && same(a.1, b.1))
    }
}
