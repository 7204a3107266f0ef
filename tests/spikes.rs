//! Runs by implicit methods through spikes that last for less than the spacing of the doubles around the time.

use crate::common::ROOT;
use crate::common::ivp::{plan, solved};
use twinslip::field::{Jacobian, State, VectorField};
use twinslip::integrate::{
    Control, Integrator, MAX_STEPS, Radau, Rosenbrock, RosenbrockMethod, Step, Tolerances,
};
use twinslip::number::DoubleDouble;
use twinslip_tasks::scene::{IvpAsked, IvpEvent};

/// y' = y^2 (1 - y / m), a flame (O'Malley 1991, Singular Perturbation Methods for Ordinary Differential Equations): from y(0) = 1e-6 it waits for a time of a
/// million and goes to m within some 10 / m.
struct Flame(f64);

impl Flame {
    /// -1 / y + ln(y / (m - y)) / m, which grows as time does.
    fn clock(&self, y: f64) -> f64 {
        -1.0 / y + (y / (self.0 - y)).ln() / self.0
    }
}

impl VectorField<1> for Flame {
    fn f(&self, y: &State<1>) -> State<1> {
        State::<1>::new(y[0] * y[0] * (1.0 - y[0] / self.0))
    }

    fn jacobian(&self, y: &State<1>) -> Jacobian<1> {
        Jacobian::<1>::new(y[0] * (2.0 - 3.0 * y[0] / self.0))
    }

    fn second_derivative(&self, y: &State<1>, u: &State<1>, v: &State<1>) -> State<1> {
        State::<1>::new((2.0 - 6.0 * y[0] / self.0) * u[0] * v[0])
    }
}

/// Steps of 1e-14 at t = 1e6, around which doubles are 1e-10 apart: their times are those of the closed form, and so is the solution within them.
#[test]
fn the_time_within_a_spike_is_known() {
    let flame = Flame(1e13);
    let tolerances = Tolerances::equal(1e-9).expect("positive");
    let mut methods: Vec<Box<dyn Integrator<1>>> = vec![Box::new(
        Radau::new(tolerances, MAX_STEPS).expect("a method"),
    )];
    for method in [RosenbrockMethod::Rodas5P, RosenbrockMethod::Rodas4] {
        let made = Rosenbrock::new(method, tolerances, MAX_STEPS);
        methods.push(Box::new(made.expect("a method")));
    }
    for mut method in methods {
        let name = method.name();
        let (mut first, mut shorter, mut middle) = (None::<(DoubleDouble, f64)>, 0, 0.0_f64);
        let mut see = |step: &Step<'_, 1>| {
            let (y, end) = (step.y0[0], step.y1[0]);
            if y < 1e-3 * flame.0 || end > 0.9 * flame.0 {
                return Ok(Control::Continue);
            }
            shorter += usize::from(step.t0 == step.t1);
            let (begin, from) = *first.get_or_insert((step.begin, y));
            for part in [0.0, 0.5, 1.0] {
                let after = part * step.length;
                let time = (step.begin + after - begin).hi();
                let exact = flame.clock(step.after(after)[0]) - flame.clock(from);
                // In parts of the time in which the flame bursts.
                middle = middle.max((time - exact).abs() * 1e-3 * flame.0);
            }
            Ok(Control::Continue)
        };
        let start = State::<1>::new(1e-6);
        let end = method.flow(&flame, (0.0, 1.1e6), &start, Some(&mut see));
        let end = end.expect(name);
        assert!((end[0] / flame.0 - 1.0).abs() < 1e-8, "{name}: {end}");
        assert!(shorter > 10, "{name}: {shorter}");
        assert!(middle < 1e-6, "{name}: {middle:e}");
    }
}

/// The stiff Brusselator at B = 1000: the fifth time that x passes 1e5 upwards, which it does within 1e-10. Reference: Radau's methods of order 13 and 17 in 34 digits.
#[test]
fn spikes_late_in_a_run_come_in_time() {
    const KNOWN: f64 = 1_153_728.419_330_676_5;
    for (method, rtol, allowed) in [("radau", "1e-13", 1e-7), ("rodas5p", "1e-12", 1e-5)] {
        let words = format!(
            "--system {ROOT}/tests/data/cases/brusselator-stiff.toml --set B=1000 --method {method} --rtol {rtol}"
        );
        let plan = plan(&words, (0.0, 1.2e6), &[1e-3, 1e5]);
        let asked = IvpAsked {
            events: vec![IvpEvent {
                direction: 1.0,
                ..IvpEvent::new(|_, y: &[f64]| Ok(y[0] - 1e5))
            }],
            ..IvpAsked::default()
        };
        let made = solved(&plan, asked);
        assert_eq!(made.failure, None);
        let times = &made.t_events[0];
        assert_eq!(times.len(), 5, "{method}: {times:?}");
        assert!((times[4] - KNOWN).abs() < allowed, "{method}: {times:?}");
    }
}
