//! The friction of an interface whose law is from a file: its formulas, and steady sliding by their zeros.

use super::law_file::LawFile;
use twinslip::error::{Error, Result};
use twinslip::number::{Interval, Jet, Real, Uncertain, bracketed_root};

/// How far zeros are looked for, by powers of two from 1 on, of ln psi and of tau.
const FARTHEST: i32 = 9;
/// Powers of two by which a bound is widened until it holds.
const WIDENINGS: i32 = 40;

/// A law at the parameters of an interface.
#[derive(Debug, Clone)]
pub struct Friction<'a> {
    law: &'a LawFile,
    parameters: Vec<f64>,
}

/// Steady sliding at a rate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Steady {
    /// tau_ss(V)
    pub stress: f64,
    /// ln psi_ss(V)
    pub log_state: f64,
}

impl<'a> Friction<'a> {
    pub(super) fn new(law: &'a LawFile, parameters: Vec<f64>) -> Self {
        Friction { law, parameters }
    }

    /// The value of a parameter of the law; `None` for a name that it does not have.
    pub fn parameter(&self, name: &str) -> Option<f64> {
        self.law.place(name).map(|place| self.parameters[place])
    }

    fn constants<T: Real>(&self) -> Vec<T> {
        self.parameters.iter().map(|&x| T::constant(x)).collect()
    }

    /// v(tau, psi)
    pub fn slip_rate<T: Real>(&self, tau: T, psi: T) -> T {
        self.law.slip_rate.evaluate(&[tau, psi], &self.constants())[0]
    }

    /// dpsi/dt, in (v, psi)
    pub fn evolution<T: Real>(&self, v: T, psi: T) -> T {
        self.law.evolution.evaluate(&[v, psi], &self.constants())[0]
    }

    /// The steady state at a slip rate v > 0: ln psi where the evolution falls through zero, next to psi = 1/v, and tau where the slip rate
    /// rises through v, next to 0, or to the stress that is radiated.
    ///
    /// # Errors
    /// [`Error::NotConverged`] where there is none.
    pub fn steady(&self, v: f64) -> Result<Steady> {
        let evolution = |w: Jet<f64, 1>| -self.evolution(Jet::constant(v), w.exp());
        let log_state = rising_zero("the steady state of the law", -v.ln(), evolution)?;
        let psi = Jet::constant(log_state.exp());
        let radiated = self.law.damping.map_or(0.0, |i| self.parameters[i] * v);
        let excess = |tau: Jet<f64, 1>| self.slip_rate(tau, psi) - v;
        let stress = rising_zero("the steady stress of the law", radiated, excess)?;
        Ok(Steady { stress, log_state })
    }

    /// The same with bounds, which are infinite where the formulas do not say by intervals that there is a zero.
    pub fn enclosed(&self, v: Interval, at: Steady) -> [Uncertain; 2] {
        let evolution = |w: Interval| self.evolution(v, Real::exp(w));
        let log_state = enclosed(at.log_state, evolution);
        let all = Interval::around(at.log_state, log_state);
        let psi = Real::exp(all);
        let stress = if log_state.is_finite() {
            enclosed(at.stress, |tau| self.slip_rate(tau, psi) - v)
        } else {
            f64::INFINITY
        };
        [
            Uncertain::new(at.stress, stress),
            Uncertain::new(at.log_state, log_state),
        ]
    }

    /// What follows from the derivatives s_tau, s_psi of the slip rate and g_v, g_psi of the evolution at steady sliding: k_c(V) =
    /// (g_psi + s_psi g_v)/s_tau (16), and d tau_ss/d ln V over dtau/d ln v at a fixed state, which is 1 + s_psi g_v/g_psi.
    pub fn steady_slopes<T: Real>(&self, v: T, tau: T, psi: T) -> (T, T) {
        let [of_tau, of_psi] = gradient(tau, psi, |tau, psi| self.slip_rate(tau, psi));
        let [by_rate, by_state] = gradient(v, psi, |v, psi| self.evolution(v, psi));
        let critical = (by_state + of_psi * by_rate) / of_tau;
        let relative = of_psi * by_rate / by_state + 1.0;
        (critical, relative)
    }
}

impl Friction<'_> {
    /// dg/dpsi + s_psi dg/dv: the rate at which a small difference of psi grows between interfaces that are in this state, under one
    /// stress.
    pub fn split_rate<T: Real>(&self, tau: T, psi: T) -> T {
        let v = self.slip_rate(tau, psi);
        let [_, of_psi] = gradient(tau, psi, |tau, psi| self.slip_rate(tau, psi));
        let [by_rate, by_state] = gradient(v, psi, |v, psi| self.evolution(v, psi));
        by_state + of_psi * by_rate
    }

    /// The same with their derivatives in V along steady sliding, where dpsi_ss/dV = -g_v/g_psi and dtau_ss/dV = (1 - s_psi
    /// dpsi_ss/dV)/s_tau.
    pub fn along_steady<T: Real>(&self, v: T, tau: T, psi: T) -> (Jet<T, 1>, Jet<T, 1>) {
        let [of_tau, of_psi] = gradient(tau, psi, |tau, psi| self.slip_rate(tau, psi));
        let [by_rate, by_state] = gradient(v, psi, |v, psi| self.evolution(v, psi));
        let state = -by_rate / by_state;
        let stress = (-(of_psi * state) + 1.0) / of_tau;
        let along = |value: T, slope: T| Jet {
            value,
            gradient: [slope],
        };
        let one = T::constant(1.0);
        self.steady_slopes(along(v, one), along(tau, stress), along(psi, state))
    }
}

/// Both first derivatives.
fn gradient<T: Real>(x: T, y: T, of: impl Fn(Jet<T, 2>, Jet<T, 2>) -> Jet<T, 2>) -> [T; 2] {
    of(Jet::variable(x, 0), Jet::variable(y, 1)).gradient
}

/// The zero next to a point through which a function rises.
fn rising_zero(
    what: &'static str,
    from: f64,
    function: impl Fn(Jet<f64, 1>) -> Jet<f64, 1>,
) -> Result<f64> {
    let at = |x: f64| function(Jet::variable(x, 0));
    let distances = (0..=FARTHEST).map(|k| f64::from(1 << k));
    let (mut low, mut high) = (from, from);
    let (mut at_low, mut at_high) = (at(from).value, at(from).value);
    for distance in std::iter::once(0.0).chain(distances) {
        let (next_low, next_high) = (from - distance, from + distance);
        let values = (at(next_low).value, at(next_high).value);
        // The nearest bracket, on either side.
        let bracket = if at_high <= 0.0 && values.1 >= 0.0 {
            Some((high, next_high))
        } else if values.0 <= 0.0 && at_low >= 0.0 {
            Some((next_low, low))
        } else {
            None
        };
        if let Some((low, high)) = bracket {
            return bracketed_root(what, low, high, |x| {
                let Jet { value, gradient } = at(x);
                (value, gradient[0])
            });
        }
        (low, high, at_low, at_high) = (next_low, next_high, values.0, values.1);
    }
    Err(Error::NotConverged {
        what,
        iterations: FARTHEST as usize,
        residual: at(from).value.abs(),
        tolerance: 0.0,
    })
}

/// How far on either side of x a function certainly has opposite signs; infinite where no such distance is found.
fn enclosed(x: f64, function: impl Fn(Interval) -> Interval) -> f64 {
    let mut radius = f64::EPSILON * (1.0 + x.abs());
    for _ in 0..WIDENINGS {
        let sign = |at: f64| function(Interval::constant(at)).sign();
        if let (Some(left), Some(right)) = (sign(x - radius), sign(x + radius))
            && left != right
        {
            return radius;
        }
        radius *= 2.0;
    }
    f64::INFINITY
}
