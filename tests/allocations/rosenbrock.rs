//! No step of a Rosenbrock integrator allocates.

use allocation_counter::measure;
use twinslip::field::State;
use twinslip::friction::{AnyLaw, Parameters};
use twinslip::integrate::{
    Control, Integrator, MAX_STEPS, Rosenbrock, RosenbrockMethod, Step, Tolerances,
};
use twinslip::model::{Loading, two_interfaces};

#[test]
fn no_step_allocates() {
    let law = AnyLaw::Spinodal(Parameters::heslot_1994().spinodal());
    let field = two_interfaces(law, Loading::new(10.0, 0.14).unwrap());
    let start = State::<3>::new(10.0, -2.0, -4.0);
    let t = (0.0, 50.0);
    for method in RosenbrockMethod::ALL {
        let tolerances = Tolerances::equal(1e-6).unwrap();
        let mut rosenbrock = Rosenbrock::<3>::new(method, tolerances, MAX_STEPS).unwrap();
        let plain = measure(|| {
            rosenbrock.flow(&*field, t, &start, None).unwrap();
        });
        let steps = rosenbrock.work().steps;
        let mut middle = State::<3>::zeros();
        let mut look = |step: &Step<'_, 3>| {
            middle = step.dense(0.5 * (step.t0 + step.t1));
            Ok(Control::Continue)
        };
        let observed = measure(|| {
            rosenbrock
                .flow(&*field, t, &start, Some(&mut look))
                .unwrap();
        });
        let tangent = measure(|| {
            rosenbrock.tangent_flow(&*field, t, &start).unwrap();
        });
        assert!(steps > 100, "{method:?}: {steps} steps");
        for (what, counted) in [
            ("plain", plain),
            ("observed", observed),
            ("tangent", tangent),
        ] {
            assert_eq!(counted.count_total, 0, "{method:?}, {what}: {counted:?}");
        }
    }
    // and the counter counts
    assert_eq!(
        measure(|| drop(std::hint::black_box(vec![0_u8; 100]))).count_total,
        1
    );
}
