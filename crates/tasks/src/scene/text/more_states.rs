//! Interfaces with more than stress and one state variable: a law with a second state variable, and with mass.

use super::law_file::{HEALING_TIME, Inertia, LawFile};
use twinslip::error::{Error, Result};
use twinslip::expression::{Binary, Builder, Expressions, Place};

/// b of the second state variable.
pub(in crate::scene) const SECOND_EVOLUTION_EFFECT: &str = "second_evolution_effect";
/// L of the second state variable, in units of the L of the first.
pub(in crate::scene) const SECOND_SLIP_LENGTH: &str = "second_slip_length";
/// m V*^2/(a sigma L), with the mass m of an interface per area.
pub(in crate::scene) const MASS: &str = "mass";
/// b of the first state variable.
pub(super) const EVOLUTION_EFFECT: &str = "evolution_effect";

impl LawFile {
    /// The law with a second state variable, which has a b and a slip length of its own and else the constants of the first: v = s(tau)
    /// /(strength_1(psi_1) strength_2(psi_2)), and each state variable evolves at v by the law's own evolution with its slip length
    /// (Gu, Rice, Ruina and Tse 1984, J. Mech. Phys. Solids 32, 167-196).
    ///
    /// For the ageing and the slip law: tau = mu_*/a + ln v + (b_1/a) ln psi_1 + (b_2/a) ln(psi_2/L_2), psi_i = theta_i V*/L_1.
    ///
    /// # Errors
    /// [`Error::Input`] for a law without a parameter evolution_effect, with which the state has no strength where that is 0, and for a slip
    /// rate that is not a factor times sinh or exp of the stress.
    pub(super) fn with_second_state(mut self, b: f64, slip_length: f64) -> Result<Self> {
        let Some(first_b) = self.place(EVOLUTION_EFFECT) else {
            return Err(Error::Input(format!(
                "`second_evolution_effect`: the law {} has no parameter {EVOLUTION_EFFECT}, which a second state variable has too",
                self.name
            )));
        };
        self.separable("second_evolution_effect")?;
        if self.names_stress_rate() {
            return Err(Error::Input(format!(
                "`second_evolution_effect`: the evolution of the law {} names stress_rate, and takes no second state variable",
                self.name
            )));
        }
        let count = self.parameters.len();
        let second = |builder: &mut Builder, b: Option<Place>| -> Result<(Vec<Place>, Place)> {
            let length = builder.parameter(count + 1)?;
            let all = (0..count).map(|i| builder.parameter(i));
            let mut all = all.collect::<Result<Vec<Place>>>()?;
            all[first_b] = match b {
                Some(b) => b,
                None => builder.parameter(count)?,
            };
            if let Some(i) = self.place(HEALING_TIME) {
                all[i] = builder.binary(Binary::Quotient, all[i], length)?;
            }
            Ok((all, length))
        };
        let bounds_state = self.bounds_state();
        let in_own_units =
            |builder: &mut Builder, x: Place, length: Place, is_rate: bool| match bounds_state
                == is_rate
            {
                true => builder.binary(Binary::Quotient, x, length),
                false => Ok(x),
            };

        let mut builder = Builder::default();
        let [tau, first, psi] = [0, 1, 2].map(|i| builder.variable(i));
        let own = (0..count).map(|i| builder.parameter(i));
        let own = own.collect::<Result<Vec<Place>>>()?;
        let slip_rate = builder.insert(&self.slip_rate, &[tau?, first?], &own)?[0];
        let (own, length) = second(&mut builder, None)?;
        let psi = in_own_units(&mut builder, psi?, length, false)?;
        // At any stress the factor of the state is the same.
        let one = builder.number(1.0)?;
        let weaker = builder.insert(&self.slip_rate, &[one, psi], &own)?[0];
        let zero = builder.number(0.0)?;
        let (none, _) = second(&mut builder, Some(zero))?;
        let without = builder.insert(&self.slip_rate, &[one, one], &none)?[0];
        let factor = builder.binary(Binary::Quotient, weaker, without)?;
        let slip_rate = builder.binary(Binary::Product, slip_rate, factor)?;
        let slip_rate = builder.complete(vec![slip_rate]);

        let mut builder = Builder::default();
        let (own, length) = second(&mut builder, None)?;
        let [v, psi, stress_rate] = [0, 1, 2].map(|i| builder.variable(i));
        let psi = in_own_units(&mut builder, psi?, length, false)?;
        let rate = builder.insert(&self.evolutions[0], &[v?, psi, stress_rate?], &own)?[0];
        let rate = in_own_units(&mut builder, rate, length, true)?;
        let evolution = builder.complete(vec![rate]);

        self.slip_rate = slip_rate;
        self.evolutions.push(evolution);
        let more = [
            (SECOND_EVOLUTION_EFFECT, b),
            (SECOND_SLIP_LENGTH, slip_length),
        ];
        let more = more.map(|(name, value)| (name.to_owned(), value));
        self.parameters.extend(more);
        Ok(self)
    }

    /// The law of interfaces with mass, before it has damping: m dv/dt = tau - tau_f(v, psi).
    ///
    /// # Errors
    /// [`Error::Input`] for a slip rate that is not a factor times sinh or exp of the stress.
    pub(super) fn with_mass(mut self, mass: f64) -> Result<Self> {
        let friction = self.separable("mass")?;
        self.inertia = Some(Inertia {
            friction,
            mass: self.parameters.len(),
        });
        self.parameters.push((MASS.into(), mass));
        Ok(self)
    }

    /// The stress at which it slides at a rate.
    fn separable(&self, option: &str) -> Result<Expressions> {
        self.slip_rate.stress()?.ok_or_else(|| {
            Error::Input(format!(
                "`{option}`: the slip rate of the law {} must be a factor times sinh or exp of a multiple of tau",
                self.name
            ))
        })
    }
}
