//! The difference chart: two interfaces (19) in variables that do not lose their asymmetry.
//!
//! Along cycles at small stiffness the interfaces come so near each other that psi_1 - psi_2 falls to e^-100, and part again:
//! a difference of two doubles has long lost it. It never changes sign, and D' = (difference of the rates) is D times a
//! smooth function. So the state here is (tau, ln psi_2, ln D) with D = psi_1 - psi_2 > 0, and the difference of the rates
//! comes from the laws' own formulas in [`Difference`], to full relative accuracy down to D = e^-700. To other charts, such as
//! ln ln(psi_1 / psi_2), it is preferred because psi_1 = psi_2 + D costs nothing, and since no state comes near the end of its
//! range.

use super::{Driven, Loading, Parameter, Smooth, stress_rate};
use crate::field::State;
use crate::friction::{AnyLaw, Law, LawForm};
use crate::number::{Difference, DoubleDouble, Real};
#[cfg(target_arch = "x86_64")]
use crate::series::Tangent;
use crate::series::{
    Accuracy, Equations, Expansion, Formula, KeptFormula, ROOM, Recurrences, Solution, Stepper,
};
use std::cell::Cell;

/// dtau/dt = K (V_H - v_1 - v_2), dw_2/dt = g(v_2, w_2), d(ln D)/dt = (dpsi_1/dt - dpsi_2/dt) / D, in the parameters
/// (V_H, K), from (19).
///
/// For tau of one sign: series take the sign of the slip rates at the beginning of a step. With the slip law, whose evolution
/// takes the logarithm of v psi, digits are lost where v_1 psi_1 is far below v_2 psi_2; with the others nowhere.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DifferenceChart {
    /// The law of both interfaces.
    form: LawForm,
    lasting: Option<&'static str>,
}

impl DifferenceChart {
    /// With this law for both interfaces.
    pub fn new(law: &AnyLaw) -> Self {
        DifferenceChart {
            form: law.form(),
            lasting: law.lasts().then(|| law.name()),
        }
    }

    /// The field at a loading.
    pub fn at(self, loading: &Loading) -> Smooth<Self, 3, 2> {
        Smooth {
            equations: self,
            parameters: (*loading).into(),
        }
    }
}

impl Equations<3, 2> for DifferenceChart {
    const PARAMETERS: [&'static str; 2] = Parameter::LOADING;

    #[inline(always)]
    fn rates<T: Real>(
        &self,
        [tau, log_second, log_gap]: [T; 3],
        [driving, stiffness]: [T; 2],
    ) -> [T; 3] {
        let (second, gap) = (log_second.exp(), log_gap.exp());
        let psi = Difference::ordered(second + gap, second, gap);
        let activation = self.form.activation(tau);
        // The stress is the same in both.
        let activation = Difference::ordered(activation, activation, T::constant(0.0));
        let v = self.form.slip_rate(activation, psi);
        let rate = self.form.evolution(v, psi);
        [
            stress_rate((driving, stiffness), v.first + v.second),
            rate.second / second,
            rate.gap / gap,
        ]
    }

    // Exponentials of the stress and the states hide in no series: the next step sees all that they have grown by in one. With other
    // laws, and with damping, the end of every step is checked.
    fn own_solution(&self, parameters: [f64; 2]) -> Option<Box<dyn Solution<3>>> {
        self.form.undamped_ageing()?;
        let formula = At {
            chart: *self,
            parameters,
        };
        Some(Box::new(ChartSolution {
            stepper: Stepper::new(formula, 0.0),
            recurrences: KeptFormula::new(*self, false),
        }))
    }

    #[cfg(target_arch = "x86_64")]
    fn own_tangent(
        &self,
        [driving, stiffness]: [f64; 2],
        free: &[usize],
    ) -> Option<Box<dyn Tangent<3>>> {
        let loading = Loading { driving, stiffness };
        super::difference_tangent::tangent(self.form.undamped_ageing()?, loading, free)
    }

    fn lasting(&self) -> Option<&'static str> {
        self.lasting
    }
}

/// The chart at a loading.
#[derive(Clone, Copy)]
struct At {
    chart: DifferenceChart,
    parameters: [f64; 2],
}

impl Formula<f64, 3> for At {
    fn rates(&self, x: &[f64; 3]) -> [f64; 3] {
        self.chart.rates(*x, self.parameters)
    }

    /// atol + rtol |x_i|
    fn units(&self, x: &[f64; 3], (rtol, atol): (f64, f64)) -> [f64; 3] {
        x.map(|x| x.abs() * rtol + atol)
    }

    /// 1, and no number where one of x is not finite.
    fn allows(&self, x: &[f64; 3]) -> f64 {
        x.iter().fold(1.0, |one, x| x * 0.0 + one)
    }
}

impl Recurrences<f64, At, 3> for KeptFormula {
    fn make(&mut self, formula: &At, memory: &[Cell<f64>], order: usize, unit: f64) {
        let [driving, stiffness] = formula.parameters;
        let [tau, second, gap] = [0, 1, 2].map(|i| memory[i * ROOM].get());
        self.expand(&[tau, second, gap, driving, stiffness], order, unit);
        for i in 0..3 {
            for (x, made) in memory[i * ROOM..].iter().zip(&self.variable(i)[..=order]) {
                x.set(*made);
            }
        }
    }
}

/// A solution whose steps need no check at their ends.
struct ChartSolution {
    stepper: Stepper<f64, At, 3>,
    recurrences: KeptFormula,
}

impl Solution<3> for ChartSolution {
    fn start(&mut self, y: &[f64; 3]) {
        self.stepper.start(*y);
    }

    fn advance(&mut self, accuracy: &Accuracy, limit: DoubleDouble) -> DoubleDouble {
        let step = self
            .stepper
            .advance_with(&mut self.recurrences, accuracy, limit.hi());
        DoubleDouble::from(step)
    }

    fn state(&self) -> [f64; 3] {
        *self.stepper.state()
    }

    fn expansion(&self, order: usize, into: &mut Expansion<3>) {
        into.order = order;
        into.unit = self.stepper.unit();
        into.chart = |x| x;
        for (i, variable) in into.variables.iter_mut().enumerate() {
            variable[..=order].copy_from_slice(&self.stepper.series(i)[..=order]);
        }
    }
}

/// From (tau, ln psi_1, ln psi_2) to (tau, ln psi_2, ln D); `None` unless psi_1 > psi_2. Of ln psi_1 - ln psi_2 it keeps the
/// digits that this difference has.
pub fn to_difference_chart(y: &State<3>) -> Option<State<3>> {
    let ratio = y[1] - y[2];
    // ln(e^ratio - 1)
    let log_excess = if ratio > 40.0 {
        ratio
    } else {
        ratio.exp_m1().ln()
    };
    (ratio > 0.0).then(|| State::<3>::new(y[0], y[2], y[2] + log_excess))
}

/// From (tau, ln psi_2, ln D) to (tau, ln psi_1, ln psi_2).
pub fn from_difference_chart(x: &State<3>) -> State<3> {
    let excess = x[2] - x[1];
    // ln(1 + e^excess)
    let ratio = excess.max(0.0) + (-excess.abs()).exp().ln_1p();
    State::<3>::new(x[0], x[1] + ratio, x[1])
}

impl Driven<3> for Smooth<DifferenceChart, 3, 2> {
    fn slip_rates(&self, x: &State<3>) -> [f64; 2] {
        let form = &self.equations.form;
        let (second, gap) = (x[1].exp(), x[2].exp());
        [second + gap, second].map(|psi| form.slip_rate(form.activation(x[0]), psi))
    }
}
