//! What interfaces are made of, eight side by side: the constants of their laws, and which formulas these are.

use crate::error::{Error, Result};
use crate::friction::{AgeingForm, AnyLaw, positive};

/// Interfaces in a block.
pub(super) const LANES: usize = 8;
/// A number of each.
pub(super) type Lanes = [f64; LANES];

/// Which formulas all interfaces have.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Kind {
    /// s is the exponential alone, and not the hyperbolic sine.
    pub exponential: bool,
    /// Each has a stress of its own, q (tau - eta v), for its direct effect, normal stress or damping.
    pub own_stress: bool,
    /// The state obeys the slip law, and no ageing law.
    pub slip: bool,
}

/// One interface: its law, and what it has in units of the nominal one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OneOfMany {
    /// The law of its slip length ([`AnyLaw::of_slip_length`]), without damping.
    pub law: AnyLaw,
    /// eta, the radiation damping, in units of the nominal a sigma.
    pub damping: f64,
    /// l, its slip length.
    pub slip_length: f64,
    /// q, the nominal a sigma over its own.
    pub stress_factor: f64,
}

impl From<AnyLaw> for OneOfMany {
    /// A nominal one.
    fn from(law: AnyLaw) -> Self {
        OneOfMany {
            law,
            damping: 0.0,
            slip_length: 1.0,
            stress_factor: 1.0,
        }
    }
}

/// What the interfaces of a block are: v = s(q (tau - eta v)) f x^(-beta), with the strength x = a_0 + a_1 psi, and
/// dpsi/dt = g_0 + g_1 psi - |v| psi / l, or by the slip law dpsi/dt = -(v psi / l) ln(v psi / l) with x = psi.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Constants {
    /// beta
    pub beta: Lanes,
    /// f: gamma0, or half of it where the direct effect is exponential; 0 where there is no interface.
    pub factor: Lanes,
    /// a_0
    pub rest: Lanes,
    /// a_1
    pub slope: Lanes,
    /// g_0
    pub source: Lanes,
    /// g_1
    pub relaxation: Lanes,
    /// 1/l
    pub per_length: Lanes,
    /// q
    pub stress_factor: Lanes,
    /// q eta
    pub damping: Lanes,
}

/// The constants of one.
#[derive(Debug, Clone, Copy)]
pub(super) struct Single {
    pub exponential: bool,
    pub slip: bool,
    beta: f64,
    pub factor: f64,
    strength: [f64; 2],
    healing: [f64; 2],
    per_length: f64,
    stress_factor: f64,
    damping: f64,
}

impl Single {
    pub fn new(one: &OneOfMany) -> Result<Self> {
        let stress_factor = one.stress_factor;
        for (name, value) in [
            ("slip_length", one.slip_length),
            ("stress factor", stress_factor),
        ] {
            positive(name, value)?;
        }
        if !(one.damping >= 0.0 && one.damping.is_finite()) {
            return Err(Error::parameter("damping", one.damping, "0 or more"));
        }
        let form = one.law.form();
        if form.damping != 0.0 {
            let what = "spinodal, bounded, regularised-ageing, dieterich-ruina or slip, with its damping beside it";
            return Err(Error::parameter(
                "the law of many interfaces",
                one.law.name(),
                what,
            ));
        }
        let AgeingForm {
            strength,
            healing,
            beta,
            gamma0,
            exponential,
        } = form.ageing;
        Ok(Single {
            exponential,
            slip: form.slip_law,
            beta,
            factor: if exponential { 0.5 * gamma0 } else { gamma0 },
            strength,
            healing: if form.slip_law { [0.0; 2] } else { healing },
            per_length: 1.0 / one.slip_length,
            stress_factor,
            damping: stress_factor * one.damping,
        })
    }

    /// Whether it has a stress of its own.
    pub fn own_stress(&self) -> bool {
        self.stress_factor != 1.0 || self.damping != 0.0
    }
}

impl Constants {
    pub fn of(all: [Single; LANES]) -> Self {
        Constants {
            beta: all.map(|one| one.beta),
            factor: all.map(|one| one.factor),
            rest: all.map(|one| one.strength[0]),
            slope: all.map(|one| one.strength[1]),
            source: all.map(|one| one.healing[0]),
            relaxation: all.map(|one| one.healing[1]),
            per_length: all.map(|one| one.per_length),
            stress_factor: all.map(|one| one.stress_factor),
            damping: all.map(|one| one.damping),
        }
    }
}

/// The constants of the i-th block: one for all, or each its own.
#[inline(always)]
pub(super) fn of(all: &[Constants], i: usize) -> &Constants {
    match all {
        [only] => only,
        _ => &all[i],
    }
}
