//! What makes derivatives along arcs is made once: an arc allocates its results alone.

use allocation_counter::measure;
use twinslip::field::Vector;
use twinslip::friction::{AnyLaw, Parameters};
use twinslip::integrate::{AnyField, AnyIntegrator, Choice, MAX_STEPS, Tolerances};
use twinslip::model::{Loading, two_interfaces};

#[test]
fn an_arc_allocates_its_results_alone() {
    /// The state at the end, and its derivatives.
    const RESULTS: u64 = 2;
    let law = AnyLaw::Spinodal(Parameters::heslot_1994().spinodal());
    let field = AnyField::new::<3>(two_interfaces(law, Loading::new(10.0, 0.14).unwrap()));
    let y0 = Vector::from_vec(vec![10.0, -2.0, -4.0]);
    // Of CVODES also its columns on their way in and out.
    let mut methods = vec![("rodas5p", 0), ("rodas4", 0)];
    if cfg!(feature = "sundials") {
        methods.extend([("cvode-bdf", 3), ("cvode-adams", 3)]);
    }
    for (name, columns) in methods {
        let choice = Choice::named(name).unwrap();
        let tolerances = Tolerances::equal(1e-8).unwrap();
        let mut method = AnyIntegrator::new(choice, tolerances, MAX_STEPS).unwrap();
        let mut arcs = method.arcs(&field, &[]).unwrap();
        // The first one sets up what is used from then on.
        let first = arcs.derivatives((0.0, 0.01), &y0).unwrap();
        let mut again = None;
        let counted = measure(|| again = Some(arcs.derivatives((0.0, 0.01), &y0).unwrap()));
        assert_eq!(again.unwrap(), first, "{name}");
        assert!(
            counted.count_total <= RESULTS + columns,
            "{name}: {counted:?}"
        );
    }
}
