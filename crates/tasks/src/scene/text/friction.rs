//! The friction of an interface whose law is from a file: its formulas, and steady sliding by their zeros.

use super::law_file::LawFile;
use twinslip::error::{Error, Result};
use twinslip::number::{Interval, Jet, Real, Uncertain, bracketed_root};

/// How far zeros are looked for, of ln psi and of tau, and the factors from one distance to the next, from 1 on; the second one where the first
/// finds none, as a slip rate may have a pole not far beyond the zero.
const FARTHEST: f64 = 512.0;
const FARTHER: [f64; 2] = [1.25, 1.02];
/// Powers of two by which a bound is widened until it holds.
const WIDENINGS: i32 = 40;

/// A law at the parameters of an interface.
#[derive(Debug, Clone)]
pub struct Friction<'a> {
    law: &'a LawFile,
    parameters: Vec<f64>,
}

/// Steady sliding at a rate.
#[derive(Debug, Clone, PartialEq)]
pub struct Steady {
    /// tau_ss(V)
    pub stress: f64,
    /// ln psi_ss(V) of each state variable.
    pub log_states: Vec<f64>,
}

/// First derivatives at a slip rate and the states that it has: s_tau and each s_psi of the slip rate, g_v and g_psi of each evolution, and by the
/// stress rate g_r of the first.
struct Slopes<T> {
    by_stress_rate: T,
    of_stress: T,
    of_states: Vec<T>,
    by_rate: Vec<T>,
    by_state: Vec<T>,
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

    /// v(tau, psi) of steady sliding, in the psi of all state variables.
    pub fn slip_rate<T: Real>(&self, tau: T, psi: &[T]) -> T {
        let variables: Vec<T> = std::iter::once(tau).chain(psi.iter().copied()).collect();
        self.law.slip_rate.evaluate(&variables, &self.constants())[0]
    }

    /// dpsi/dt of a state variable at a constant stress, in (v, psi)
    pub fn evolution<T: Real>(&self, which: usize, v: T, psi: T) -> T {
        self.evolution_under(which, v, psi, T::constant(0.0))
    }

    /// The same at a stress with this rate.
    fn evolution_under<T: Real>(&self, which: usize, v: T, psi: T, stress_rate: T) -> T {
        let variables = [v, psi, stress_rate];
        self.law.evolutions[which].evaluate(&variables, &self.constants())[0]
    }

    /// The steady state at a slip rate v > 0: ln psi where the evolution falls through zero, next to psi = 1/v, and tau where the slip rate
    /// rises through v, next to 0, or to the stress that is radiated.
    ///
    /// # Errors
    /// [`Error::NotConverged`] where there is none.
    pub fn steady(&self, v: f64) -> Result<Steady> {
        let log_state = |which: usize| {
            let evolution = |w: Jet<f64, 1>| -self.evolution(which, Jet::constant(v), w.exp());
            rising_zero("the steady state of the law", -v.ln(), evolution)
        };
        let log_states = (0..self.law.evolutions.len()).map(log_state);
        let log_states = log_states.collect::<Result<Vec<f64>>>()?;
        let psi = log_states.iter().map(|w| Jet::constant(w.exp()));
        let psi: Vec<Jet<f64, 1>> = psi.collect();
        let radiated = self.law.damping.map_or(0.0, |i| self.parameters[i] * v);
        let excess = |tau: Jet<f64, 1>| self.slip_rate(tau, &psi) - v;
        let stress = rising_zero("the steady stress of the law", radiated, excess)?;
        Ok(Steady { stress, log_states })
    }

    /// The bounds of the stress and of each ln psi, which are infinite where the formulas do not say by intervals that there is a zero.
    pub fn enclosed(&self, v: Interval, at: &Steady) -> (Uncertain, Vec<Uncertain>) {
        let each = at.log_states.iter().enumerate().map(|(which, &w)| {
            Uncertain::new(
                w,
                enclosed(w, |w: Interval| self.evolution(which, v, Real::exp(w))),
            )
        });
        let log_states: Vec<Uncertain> = each.collect();
        let psi = log_states
            .iter()
            .map(|w| Real::exp(Interval::around(w.value, w.uncertainty)));
        let psi: Vec<Interval> = psi.collect();
        let stress = if log_states.iter().all(|w| w.uncertainty.is_finite()) {
            enclosed(at.stress, |tau| self.slip_rate(tau, &psi) - v)
        } else {
            f64::INFINITY
        };
        (Uncertain::new(at.stress, stress), log_states)
    }

    fn slopes<T: Real>(&self, v: T, tau: T, psi: &[T]) -> Slopes<T> {
        let fixed = |value: T| Jet {
            value,
            gradient: [T::constant(0.0); 2],
        };
        let all: Vec<Jet<T, 2>> = psi.iter().map(|&psi| fixed(psi)).collect();
        let of_stress = self.slip_rate(Jet::variable(tau, 0), &all).gradient[0];
        let of_states = (0..psi.len()).map(|which| {
            let mut all = all.clone();
            all[which] = Jet::variable(psi[which], 1);
            self.slip_rate(fixed(tau), &all).gradient[1]
        });
        let evolutions = psi.iter().enumerate().map(|(which, &psi)| {
            self.evolution(which, Jet::variable(v, 0), Jet::variable(psi, 1))
                .gradient
        });
        let (by_rate, by_state) = evolutions.map(|[rate, state]| (rate, state)).unzip();
        let stress_rate = Jet::variable(T::constant(0.0), 0);
        let first = self.evolution_under(0, fixed(v), fixed(psi[0]), stress_rate);
        Slopes {
            by_stress_rate: first.gradient[0],
            of_stress,
            of_states: of_states.collect(),
            by_rate,
            by_state,
        }
    }

    /// What follows from the derivatives s_tau, s_psi of the slip rate and g_v, g_psi of the evolution at steady sliding: k_c(V), and d
    /// tau_ss/d ln V over dtau/d ln v at a fixed state, which is 1 + s_psi g_v/g_psi, summed over the state variables.
    ///
    /// At k_c an eigenvalue is i omega, and a slider resists its slip rate by Z = (1 - sum of s_psi g_v/(i omega - g_psi))/s_tau + i omega m: k_c =
    /// -i omega Z. With D = -s_psi g_v g_psi of each state variable 1 is the sum of D/(g_psi^2 + omega^2), which is linear in omega^2 for one and
    /// quadratic for two; the larger root has the stiffer spring. For one without mass that is k_c = (g_psi + s_psi g_v)/s_tau (16), and with an
    /// evolution that has dtau/dt, as g_r, s_tau + s_psi g_r in place of s_tau.
    pub fn steady_slopes<T: Real>(&self, v: T, tau: T, psi: &[T]) -> (T, T) {
        let Slopes {
            of_stress,
            of_states,
            by_rate,
            by_state,
            by_stress_rate,
        } = self.slopes(v, tau, psi);
        let each = || of_states.iter().zip(&by_rate).zip(&by_state);
        let relative = each().fold(T::constant(1.0), |sum, ((&s, &g_v), &g)| sum + s * g_v / g);
        let square = |x: T| x * x;
        let frequency = match each().collect::<Vec<_>>()[..] {
            [((&s, &g_v), &g)] => {
                -(g * (g + s * g_v)) * of_stress / (of_stress + s * by_stress_rate)
            }
            [((&s, &g_v), &g), ((&s_2, &g_v2), &g_2)] => {
                let (d, d_2) = (-(s * g_v * g), -(s_2 * g_v2 * g_2));
                let (g, g_2) = (square(g), square(g_2));
                let half = (d + d_2 - g - g_2) * 0.5;
                half + (square(half) - (g * g_2 - d * g_2 - d_2 * g)).sqrt()
            }
            _ => unreachable!("one state variable, or two"),
        };
        let critical = match each().collect::<Vec<_>>()[..] {
            [((&s, &g_v), &g)] => (g + s * g_v) / (of_stress + s * by_stress_rate),
            _ => each().fold(T::constant(0.0), |sum, ((&s, &g_v), &g)| {
                sum + s * g_v / of_stress * frequency / (square(g) + frequency)
            }),
        };
        let critical = match &self.law.inertia {
            Some(inertia) => critical + frequency * self.parameters[inertia.mass],
            None => critical,
        };
        (critical, relative)
    }
}

impl Friction<'_> {
    /// dg/dpsi + s_psi dg/dv: the rate at which a small difference of psi grows between interfaces that are in this state, under one
    /// stress; of those that have but one state variable and no mass.
    pub fn split_rate<T: Real>(&self, tau: T, psi: T) -> T {
        let v = self.slip_rate(tau, &[psi]);
        let slopes = self.slopes(v, tau, &[psi]);
        slopes.by_state[0] + slopes.of_states[0] * slopes.by_rate[0]
    }

    /// The same with their derivatives in V along steady sliding, where dpsi_ss/dV = -g_v/g_psi and dtau_ss/dV = (1 - sum of s_psi
    /// dpsi_ss/dV)/s_tau.
    pub fn along_steady<T: Real>(&self, v: T, tau: T, psi: &[T]) -> (Jet<T, 1>, Jet<T, 1>) {
        let slopes = self.slopes(v, tau, psi);
        let each = slopes.by_rate.iter().zip(&slopes.by_state);
        let states: Vec<T> = each.map(|(&g_v, &g)| -g_v / g).collect();
        let by_states = slopes.of_states.iter().zip(&states);
        let by_states = by_states.fold(T::constant(0.0), |sum, (&s, &w)| sum + s * w);
        let stress = (-by_states + 1.0) / slopes.of_stress;
        let along = |value: T, slope: T| Jet {
            value,
            gradient: [slope],
        };
        let psi = psi
            .iter()
            .zip(states)
            .map(|(&psi, slope)| along(psi, slope));
        let psi: Vec<Jet<T, 1>> = psi.collect();
        self.steady_slopes(along(v, T::constant(1.0)), along(tau, stress), &psi)
    }
}

/// The zero next to a point through which a function rises.
fn rising_zero(
    what: &'static str,
    from: f64,
    function: impl Fn(Jet<f64, 1>) -> Jet<f64, 1>,
) -> Result<f64> {
    let at = |x: f64| function(Jet::variable(x, 0));
    let bracket = FARTHER
        .into_iter()
        .find_map(|factor| bracket(from, factor, |x| at(x).value));
    let Some((low, high)) = bracket else {
        return Err(Error::NotConverged {
            what,
            iterations: FARTHEST.log(FARTHER[1]) as usize,
            residual: at(from).value.abs(),
            tolerance: 0.0,
        });
    };
    bracketed_root(what, low, high, |x| {
        let Jet { value, gradient } = at(x);
        (value, gradient[0])
    })
}

/// The nearest place, on either side, in which a function rises through zero, between distances that grow by a factor.
fn bracket(from: f64, factor: f64, at: impl Fn(f64) -> f64) -> Option<(f64, f64)> {
    let next = |distance: &f64| Some(distance * factor).filter(|next| *next < FARTHEST * factor);
    let distances = std::iter::successors(Some(1.0), next);
    let (mut low, mut high) = (from, from);
    let (mut at_low, mut at_high) = (at(from), at(from));
    for distance in std::iter::once(0.0).chain(distances) {
        let (next_low, next_high) = (from - distance, from + distance);
        let values = (at(next_low), at(next_high));
        if at_high <= 0.0 && values.1 >= 0.0 {
            return Some((high, next_high));
        }
        if values.0 <= 0.0 && at_low >= 0.0 {
            return Some((next_low, low));
        }
        (low, high, at_low, at_high) = (next_low, next_high, values.0, values.1);
    }
    None
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
