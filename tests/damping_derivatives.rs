//! Derivatives under radiation damping: of the field, along runs, and in the damping itself, of every law.

use twinslip::field::{State, place};
use twinslip::friction::{AnyLaw, Formulas, Law, Parameters};
use twinslip::integrate::{Integrator, MAX_STEPS, Taylor, Tolerances};
use twinslip::model::{Loading, two_interfaces};

fn law(name: &str, damping: f64) -> AnyLaw {
    let constants = Parameters::heslot_1994().damped(damping).expect("damping");
    AnyLaw::named(name, constants).expect("a law")
}

#[test]
fn the_field_has_derivatives_in_the_damping() {
    for name in AnyLaw::NAMES {
        let at = |eta: f64| {
            let loading = Loading::new(1.0, 0.14).expect("positive");
            two_interfaces(law(name, eta), loading)
        };
        let field = at(1e-3);
        let of = field.parametrised().expect("parameters");
        let names = of.names();
        let damping = place(names, "damping").expect("a parameter");
        assert_eq!(damping, names.len() - 1, "{names:?}");
        let y = if law(name, 0.1).bounds_state() {
            State::<3>::new(11.0, -1.0, -4.0)
        } else {
            State::<3>::new(11.0, -1.0, -3.0)
        };
        let step = 1e-6;
        let quotient = (at(1e-3 + step).f(&y) - at(1e-3 - step).f(&y)) / (2.0 * step);
        let mine = of.parameter_derivative(&y, damping);
        assert!(
            (mine - quotient).amax() < 1e-6 * quotient.amax(),
            "{name}: {mine} {quotient}"
        );

        let mut taylor =
            Taylor::new(Tolerances::equal(1e-13).expect("positive"), MAX_STEPS).expect("a method");
        let span = (0.0, 3.0);
        let (_, derivatives) = taylor
            .derivatives(&*field, span, &y, &[damping])
            .expect("a run");
        let mut run = |eta: f64| taylor.flow(&*at(eta), span, &y, None).expect("a run");
        let quotient = (run(1e-3 + step) - run(1e-3 - step)) / (2.0 * step);
        let mine = State::<3>::from(derivatives.parameters[0]);
        assert!(
            (mine - quotient).amax() < 1e-5 * quotient.amax(),
            "{name}: {mine} {quotient}"
        );
    }
}

/// The derivatives of laws are written out for the series of tangents; the references take them from the recorded formulas.
#[test]
fn tangents_of_every_law_are_those_in_31_digits() {
    let loading = Loading::new(1.0, 0.14).expect("positive");
    let mut taylor =
        Taylor::new(Tolerances::equal(1e-15).expect("positive"), MAX_STEPS).expect("a method");
    let mut reference = Taylor::reference(MAX_STEPS).expect("a method");
    for name in AnyLaw::NAMES {
        for eta in [0.0, 1e-4, 1e-2, 1.0] {
            let law = law(name, eta);
            let sliding = law.stress(2.0, 0.4);
            // Slip rates of laws with an exponential alone are positive.
            let one_sign = ["dieterich-ruina", "slip"].contains(&name);
            for tau in [sliding, 0.2, -sliding] {
                if one_sign && tau != sliding {
                    continue;
                }
                let field = two_interfaces(law, loading);
                let y = State::<3>::new(tau, 0.4_f64.ln(), 0.3_f64.ln());
                let span = (0.0, 0.2);
                let of = |taylor: &mut Taylor| {
                    let made = taylor.derivatives(&*field, span, &y, &[0, 1]);
                    made.unwrap_or_else(|e| panic!("{name} {eta} {tau}: {e}")).1
                };
                let (mine, exact) = (of(&mut taylor), of(&mut reference));
                let columns = mine.start.iter().chain(&mine.parameters);
                let others = exact.start.iter().chain(&exact.parameters);
                for (column, other) in columns.zip(others) {
                    let size = State::from(*other).amax();
                    let off = (State::from(*column) - State::from(*other)).amax();
                    assert!(
                        off < 1e-13 * size,
                        "{name} {eta} {tau}: {off:e} of {size:e}"
                    );
                }
            }
        }
    }
}

#[cfg(feature = "sundials")]
#[test]
fn sensitivities_to_the_damping_are_those_of_taylor() {
    use twinslip::integrate::CvodeIntegrator;
    use twinslip::sundials::MultistepMethod;
    for name in AnyLaw::NAMES {
        let field = two_interfaces(law(name, 1e-3), Loading::new(1.0, 0.14).expect("positive"));
        let names = field.parametrised().expect("parameters").names();
        let damping = place(names, "damping").expect("a parameter");
        let (y, span) = (State::<3>::new(11.0, -1.0, -3.0), (0.0, 3.0));
        let mut taylor =
            Taylor::new(Tolerances::equal(1e-13).expect("positive"), MAX_STEPS).expect("a method");
        let (_, truth) = taylor
            .derivatives(&*field, span, &y, &[damping])
            .expect("a run");
        let tolerances = Tolerances::equal(1e-11).expect("positive");
        let mut cvode =
            CvodeIntegrator::new(MultistepMethod::Bdf, tolerances, MAX_STEPS).expect("a method");
        let (_, _, made) = cvode
            .derivatives(&*field, span, &y, &[damping])
            .expect("a run");
        let truth = State::<3>::from(truth.parameters[0]);
        assert!(
            (made[0] - truth).amax() < 1e-6 * truth.amax(),
            "{name}: {} for {truth}",
            made[0]
        );
    }
}
