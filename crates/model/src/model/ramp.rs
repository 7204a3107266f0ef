//! Interfaces whose driving velocity changes at a steady rate: V_H is one variable more, so the field stays autonomous and has all
//! derivatives.

use super::logarithmic::{LOADING, Logarithmic};
use super::unequal::InTargets;
use super::{Driven, Loading, Smooth, UnequalInterfaces};
use crate::field::State;
use crate::friction::{AnyLaw, UnequalLaws};
use crate::number::Real;
use crate::series::Equations;

/// (11) or (19) in (tau, w_1, ..., V_H), w = ln psi, with dV_H/dt a parameter. Runs along ramps are rare: one code serves all laws.
#[derive(Debug, Clone, Copy)]
pub struct Ramp<E = Logarithmic<AnyLaw>> {
    /// The equations in V_H and K.
    interfaces: E,
}

/// The rate of V_H, and K.
const PARAMETERS: [&str; LOADING] = ["driving_rate", "stiffness"];

macro_rules! equations {
    ($variables:literal, $interfaces:literal) => {
        impl<E: Equations<$interfaces, LOADING>> Equations<$variables, LOADING> for Ramp<E> {
            const PARAMETERS: [&'static str; LOADING] = PARAMETERS;

            #[inline(always)]
            fn rates<T: Real>(
                &self,
                x: [T; $variables],
                [rate, stiffness]: [T; LOADING],
            ) -> [T; $variables] {
                let [interfaces @ .., driving] = x;
                let loading = [driving, stiffness];
                let moved: [T; $interfaces] = self.interfaces.rates(interfaces, loading);
                let mut rates = [rate; $variables];
                rates[..$interfaces].copy_from_slice(&moved);
                rates
            }

            fn slip_rates<T: Real>(
                &self,
                x: [T; $variables],
                [_, stiffness]: [T; LOADING],
            ) -> [Option<T>; 2] {
                let [interfaces @ .., driving] = x;
                let of: [T; $interfaces] = interfaces;
                self.interfaces.slip_rates(of, [driving, stiffness])
            }

            fn lasting(&self) -> Option<&'static str> {
                self.interfaces.lasting()
            }
        }

        impl<E: Equations<$interfaces, LOADING>> Driven<$variables>
            for Smooth<Ramp<E>, $variables, LOADING>
        {
            fn slip_rates(&self, y: &State<$variables>) -> [f64; 2] {
                let x = y.data.0[0];
                let [first, second] = Equations::slip_rates(&self.equations, x, self.parameters);
                let first = first.unwrap_or(0.0);
                [first, second.unwrap_or(first)]
            }
        }
    };
}

// One interface, or two that move alike; and two.
equations!(3, 2);
equations!(4, 3);

/// One interface, or two that move alike, in (tau, ln psi, V_H), where V_H changes at this rate.
pub fn alike_on_ramp(
    law: AnyLaw,
    alike: usize,
    (rate, stiffness): (f64, f64),
) -> Smooth<Ramp, 3, LOADING> {
    ramp(law, alike, [rate, stiffness])
}

/// Two interfaces in (tau, ln psi_1, ln psi_2, V_H), where V_H changes at this rate.
pub fn two_interfaces_on_ramp(
    law: AnyLaw,
    (rate, stiffness): (f64, f64),
) -> Smooth<Ramp, 4, LOADING> {
    ramp(law, 1, [rate, stiffness])
}

/// Two interfaces that differ, likewise.
pub fn unequal_interfaces_on_ramp(
    laws: UnequalLaws,
    (rate, stiffness): (f64, f64),
) -> Smooth<Ramp<InTargets<LOADING>>, 4, LOADING> {
    // V_H itself is a variable.
    let loading = Loading {
        driving: f64::NAN,
        stiffness,
    };
    let interfaces = UnequalInterfaces { laws, loading }.in_loading().equations;
    Smooth {
        equations: Ramp { interfaces },
        parameters: [rate, stiffness],
    }
}

fn ramp<const N: usize>(
    law: AnyLaw,
    alike: usize,
    parameters: [f64; LOADING],
) -> Smooth<Ramp, N, LOADING> {
    let alike = alike as f64;
    Smooth {
        equations: Ramp {
            interfaces: Logarithmic { law, alike },
        },
        parameters,
    }
}
