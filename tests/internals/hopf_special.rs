//! Closed forms of Hopf points.

use twinslip::equilibrium::{Solver, steady_states};
use twinslip::friction::AnyLaw;
use twinslip::friction::Parameters;
use twinslip::internals::{by_both, certain_zero};

/// (29) and (34) against the Jacobian of the vector field, over the whole curves.
#[test]
fn closed_forms_and_the_jacobian_agree() {
    let law = AnyLaw::Spinodal(Parameters::heslot_1994().spinodal());
    let mut compared = 0;
    for i in 0..60 {
        let v = 0.0505 * (403.0_f64 / 0.0505).powf(f64::from(i) / 59.0);
        for state in steady_states(&law, v, 2, Solver::Newton)
            .unwrap()
            .equilibria
        {
            let rates = [state.slip_rate[0], state.slip_rate[1]];
            let both = by_both(&law, v, rates, state.symmetry).expect("a Hopf point");
            let (closed, numerical, widened) = both;
            let apart = (numerical / closed.value - 1.0).abs();
            assert!(apart < 1e-11, "V_H = {v}, {:?}: {apart:e}", state.symmetry);
            assert!((numerical - closed.value).abs() <= widened.uncertainty);
            compared += 1;
        }
    }
    assert_eq!(compared, 120);
}

#[test]
fn a_zero_is_as_certain_as_its_signs() {
    let found = certain_zero("test", 1.414, |x| {
        (x * x - 2.0, (x * x - 2.0).abs() > 1e-12)
    });
    let (zero, radius) = found.unwrap();
    let off = (zero - std::f64::consts::SQRT_2).abs();
    assert!(off <= radius && radius < 2e-12, "{off:e} {radius:e}");
    assert!(certain_zero("test", 1.0, |x| (x * x + 1.0, true)).is_none());
    assert!(certain_zero("test", 1.0, |x| (x - 1.001, false)).is_none());
}
