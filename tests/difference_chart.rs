//! Two interfaces in the variables that keep their asymmetry: against published end states, against the linearised
//! antisymmetric mode, against 31 digits and against the tangent in the other variables.

use crate::common::trajectories;
use trajectories::Run;
use twinslip::field::{Jacobian, Parametrised, State, VectorField};
use twinslip::friction::{AnyLaw, Formulas, Parameters, Spinodal};
use twinslip::integrate::{
    Control, Integrator, MAX_STEPS, Rosenbrock, RosenbrockMethod, Step, Taylor, Tolerances,
};
use twinslip::model::{
    DifferenceChart, Driven, Loading, Parameter, Smooth, from_difference_chart,
    to_difference_chart, two_interfaces,
};
use twinslip::number::{Jet, Real};
use twinslip::series::Equations;

fn taylor(tolerance: f64) -> Taylor {
    Taylor::new(Tolerances::equal(tolerance).unwrap(), MAX_STEPS).unwrap()
}

fn law() -> Spinodal {
    Parameters::heslot_1994().spinodal()
}

fn field(driving: f64, stiffness: f64) -> Smooth<DifferenceChart, 3, 2> {
    DifferenceChart::new(&law().into()).at(&Loading::new(driving, stiffness).unwrap())
}

#[test]
fn the_charts_lead_to_each_other() {
    for ratio in [1e-12, 1e-3, 1.0, 30.0, 200.0] {
        let y = State::<3>::new(10.0, -3.0 + ratio, -3.0);
        let back = from_difference_chart(&to_difference_chart(&y).unwrap());
        assert!((back - y).amax() < 1e-15 * (3.0 + ratio), "{ratio}: {back}");
    }
    assert_eq!(
        to_difference_chart(&State::<3>::new(10.0, -3.0, -3.0)),
        None
    );
    assert_eq!(
        to_difference_chart(&State::<3>::new(10.0, -3.0, -2.0)),
        None
    );
    let deep = State::<3>::new(10.0, -3.0, -120.0);
    assert_eq!(from_difference_chart(&deep)[1], -3.0);
}

/// Two interfaces are the same in either chart, whatever changes places.
#[test]
fn end_states_are_met() {
    let mut met = 0;
    for run in Run::all() {
        if !matches!(run.law, AnyLaw::Spinodal(_)) {
            continue;
        }
        let Run { start, loading, .. } = &run;
        let swapped = start[1] < start[2];
        let sorted = State::<3>::new(start[0], start[1].max(start[2]), start[1].min(start[2]));
        let Some(x) = to_difference_chart(&sorted) else {
            continue;
        };
        // There the asymmetry falls below e^-700.
        if run.name == "C_K0.01_VH0.2, t = 15000" {
            continue;
        }
        let field = DifferenceChart::new(&run.law).at(loading);
        let x = taylor(1e-15)
            .flow(&field, (0.0, run.end_time), &x, None)
            .unwrap();
        let mut y = from_difference_chart(&x);
        if swapped {
            y.swap_rows(1, 2);
        }
        let error = run.error(&y);
        assert!(error < 1e-12, "{}: {error:e}", run.name);
        met += 1;
    }
    assert!(met > 5, "{met} runs");
}

/// The symmetric solution in (tau, ln psi), and the logarithm of its linearised antisymmetric mode: d(ln D)/dt = d(dpsi/dt)/dpsi.
#[derive(Debug, Clone, Copy)]
struct Mode {
    law: Spinodal,
}

impl Equations<3, 2> for Mode {
    const PARAMETERS: [&'static str; 2] = ["driving", "stiffness"];

    #[inline(always)]
    fn rates<T: Real>(&self, [tau, w, _]: [T; 3], [driving, stiffness]: [T; 2]) -> [T; 3] {
        let psi = Jet::<T, 1>::variable(w.exp(), 0);
        let activation = Jet {
            value: self.law.activation(tau),
            gradient: [T::constant(0.0)],
        };
        let v = self.law.slip_rate(activation, psi);
        let rate = self.law.evolution(v, psi);
        [
            stiffness * (driving - v.value - v.value),
            rate.value / psi.value,
            rate.gradient[0],
        ]
    }
}

#[test]
fn a_tiny_asymmetry_is_the_linearised_mode() {
    let field = field(0.2, 0.05);
    let mode = Smooth {
        equations: Mode { law: law() },
        parameters: field.parameters,
    };
    for depth in [-50.0, -120.0, -300.0] {
        let start = State::<3>::new(10.0, -1.0, depth);
        let t = (0.0, 1500.0);
        let x = taylor(1e-15).flow(&field, t, &start, None).unwrap();
        let linear = taylor(1e-15).flow(&mode, t, &start, None).unwrap();
        // It has grown or fallen by something.
        assert!((linear[2] - depth).abs() > 1.0);
        let scale = linear[2].abs().max(depth.abs());
        assert!((x[2] - linear[2]).abs() < 1e-12 * scale, "{x} {linear}");
        assert!((x - linear).amax() < 1e-12 * scale);
        let exact = Taylor::reference(MAX_STEPS)
            .unwrap()
            .flow(&mode, t, &start, None)
            .unwrap();
        assert!((x - exact).amax() < 1e-12 * scale, "{x} {exact}");
    }
}

/// At K = 0.02, above the pitchfork of the symmetric orbit: the asymmetry falls from 0.05 to e^-58 over two cycles, through
/// rises by e^11. The run with its derivatives, against 31 digits.
#[test]
fn a_deep_cycle_keeps_its_digits() {
    let field = field(0.0555, 0.02);
    let start = State::<3>::new(10.5, 0.3_f64.ln(), 0.05_f64.ln());
    let t = (0.0, 5502.0);
    let mut deepest = f64::INFINITY;
    let mut observer = |step: &Step<'_, 3>| {
        deepest = deepest.min(step.y1[2]);
        Ok(Control::Continue)
    };
    let made = taylor(1e-15)
        .flow(&field, t, &start, Some(&mut observer))
        .unwrap();
    assert!(deepest < -58.0, "{deepest}");
    let mut reference = Taylor::reference(MAX_STEPS).unwrap();
    let (end, exact) = reference.derivatives(&field, t, &start, &[0, 1]).unwrap();
    let growth = Jacobian::<3>::from(exact.start).amax();
    let allowed = 1e-12 * growth.max(1.0);
    assert!((made - end).amax() < allowed, "{:e}", (made - end).amax());
    let (_, derivatives) = taylor(1e-14)
        .derivatives(&field, t, &start, &[0, 1])
        .unwrap();
    let error = (derivatives.log_determinant - exact.log_determinant).abs();
    assert!(error < 1e-12 * exact.log_determinant.abs(), "{error:e}");
}

/// The tangent against that of two interfaces in (tau, ln psi_1, ln psi_2), by the charts' own derivatives.
#[test]
fn tangents_are_those_of_two_interfaces() {
    let (driving, stiffness) = (10.0, 0.14);
    let parted_field = field(driving, stiffness);
    let loading = Loading::new(driving, stiffness).unwrap();
    let field = two_interfaces(AnyLaw::Spinodal(law()), loading);
    let y = State::<3>::new(10.0, 0.5_f64.ln(), 0.01_f64.ln());
    let x = to_difference_chart(&y).unwrap();
    let t = (0.0, 3.0);
    let (end, of_y) = taylor(1e-14).derivatives(&*field, t, &y, &[0, 1]).unwrap();
    let (there, of_x) = taylor(1e-14)
        .derivatives(&parted_field, t, &x, &[0, 1])
        .unwrap();
    assert!((from_difference_chart(&there) - end).amax() < 1e-12);
    // d(tau, ln psi_2, ln D) / d(tau, ln psi_1, ln psi_2)
    let chart = |y: &State<3>| {
        let ratio = (y[2] - y[1]).exp();
        let (first, second) = (1.0 / (1.0 - ratio), -ratio / (1.0 - ratio));
        Jacobian::<3>::new(1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, first, second)
    };
    let made = Jacobian::<3>::from(of_x.start) * chart(&y);
    let exact = chart(&end) * Jacobian::<3>::from(of_y.start);
    assert!((made - exact).amax() < 1e-11 * exact.amax());
    for (made, exact) in of_x.parameters.into_iter().zip(of_y.parameters) {
        let exact = chart(&end) * State::<3>::from(exact);
        assert!((State::<3>::from(made) - exact).amax() < 1e-11 * exact.amax());
    }
    let volume = |y: &State<3>| chart(y).determinant().abs().ln();
    let exact = of_y.log_determinant + volume(&end) - volume(&y);
    assert!((of_x.log_determinant - exact).abs() < 1e-12 * (1.0 + exact.abs()));
}

/// The derivatives that implicit methods and continuation take, by differences; and one of those methods.
#[test]
fn it_is_a_driven_field() {
    const STEP: f64 = 1e-6;
    let field = field(0.2, 0.05);
    for depth in [-4.0, -80.0] {
        let x = State::<3>::new(11.0, -1.5, depth);
        let direction = State::<3>::new(0.3, 0.5, -0.4);
        let (up, down) = (x + direction * STEP, x - direction * STEP);
        let slope = (field.f(&up) - field.f(&down)) / (2.0 * STEP);
        let made = field.jacobian(&x) * direction;
        assert!((made - slope).amax() < 1e-8 * slope.amax());
        for i in Parameter::PLANE {
            let at = |change: f64| {
                let mut field = field;
                field.parameters[i] += change;
                field
            };
            let (up, down) = (at(STEP), at(-STEP));
            let slope = (up.f(&x) - down.f(&x)) / (2.0 * STEP);
            let made = field.parameter_derivative(&x, i);
            assert!((made - slope).amax() < 1e-8);
            let slope = (up.jacobian(&x) - down.jacobian(&x)) / (2.0 * STEP);
            let made = field.parameter_jacobian(&x, i);
            assert!((made - slope).amax() < 1e-8);
        }
        let [first, second] = field.slip_rates(&x);
        let pull = field.parameters[1] * (field.parameters[0] - first - second);
        assert!((field.f(&x)[0] - pull).abs() < 1e-15);
        let tolerances = Tolerances::equal(1e-12).unwrap();
        let other = Rosenbrock::new(RosenbrockMethod::Rodas5P, tolerances, MAX_STEPS)
            .unwrap()
            .flow(&field, (0.0, 100.0), &x, None)
            .unwrap();
        let made = taylor(1e-14).flow(&field, (0.0, 100.0), &x, None).unwrap();
        assert!((made - other).amax() < 1e-9 * made.amax());
    }
}
