//! Equations (11) and (19) in ln psi, for every number: what references, third-order maps and recorded formulas are made of.

use super::response::Response;
use super::{Loading, Parameter, stress_rate};
use crate::friction::{Formulas, Law};
use crate::number::{Real, With};
use crate::series::Equations;

/// One interface (11), two (19), or two that move alike, in (tau, w_1, ...), w = ln psi.
#[derive(Debug, Clone, Copy)]
pub struct Logarithmic<L> {
    pub law: L,
    /// How many interfaces move alike.
    pub alike: f64,
}

/// V_H and K.
pub(super) const LOADING: usize = Parameter::PLANE.len();
/// These, and the constants of the law.
pub(super) const ALL: usize = Parameter::NAMES.len();

impl<L> Logarithmic<L> {
    #[inline(always)]
    fn rates_with<C, T: With<C>, const N: usize>(
        &self,
        law: &impl Formulas<C>,
        x: [T; N],
        loading: (T, T),
    ) -> [T; N] {
        const { assert!(N == 2 || N == 3) }
        let activation = law.activation(x[0]);
        let first = Response::new(law, activation, x[1]);
        let mut rates = [first.g; N];
        let slip_rate = if N == 2 {
            first.v * self.alike
        } else {
            let second = Response::new(law, activation, x[2]);
            rates[2] = second.g;
            first.v + second.v
        };
        rates[0] = stress_rate(loading, slip_rate);
        rates
    }
}

fn slip_rates<C, T: With<C>, const N: usize>(law: &impl Formulas<C>, x: [T; N]) -> [Option<T>; 2] {
    let activation = law.activation(x[0]);
    [x.get(1), x.get(2)].map(|w| w.map(|&w| Response::new(law, activation, w).v))
}

/// The law's constants as they are.
impl<L: Law, const N: usize> Equations<N, LOADING> for Logarithmic<L> {
    const PARAMETERS: [&'static str; LOADING] = Parameter::LOADING;

    #[inline(always)]
    fn rates<T: Real>(&self, x: [T; N], [driving, stiffness]: [T; LOADING]) -> [T; N] {
        self.rates_with(&self.law, x, (driving, stiffness))
    }

    fn slip_rates<T: Real>(&self, x: [T; N], _: [T; LOADING]) -> [Option<T>; 2] {
        slip_rates(&self.law, x)
    }

    fn lasting(&self) -> Option<&'static str> {
        self.law.lasts().then(|| self.law.name())
    }
}

/// The law's constants as parameters, as far as it has them.
impl<L: Law, const N: usize> Equations<N, ALL> for Logarithmic<L> {
    const PARAMETERS: [&'static str; ALL] = Parameter::NAMES;

    #[inline(always)]
    fn rates<T: Real>(&self, x: [T; N], parameters: [T; ALL]) -> [T; N] {
        let [driving, stiffness, constants @ ..] = parameters;
        let law = self.law.freed(constants.into());
        self.rates_with(&law, x, (driving, stiffness))
    }

    fn slip_rates<T: Real>(&self, x: [T; N], parameters: [T; ALL]) -> [Option<T>; 2] {
        let [_, _, constants @ ..] = parameters;
        slip_rates(&self.law.freed(constants.into()), x)
    }
}

impl<L: Law> Logarithmic<L> {
    /// The values of all parameters. Those that the law does not have are no numbers, and enter nowhere.
    pub(super) fn parameters(&self, loading: Loading) -> [f64; ALL] {
        let mut law = self.law;
        let mut all = [f64::NAN; ALL];
        all[..LOADING].copy_from_slice(&<[f64; LOADING]>::from(loading));
        for (value, constant) in all[LOADING..].iter_mut().zip(law.constants()) {
            if let Some(constant) = constant {
                *value = *constant;
            }
        }
        all
    }
}
