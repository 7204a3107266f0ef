//! Branches from Hopf points.

use twinslip::equilibrium::Symmetry;
use twinslip::friction::{AnyLaw, Parameters};
use twinslip::internals::period_from_hopf;
use twinslip::model::Loading;
use twinslip::model::Parameter;
use twinslip::orbit::{InterfaceSystem, hopf_points};

fn slab(driving: f64) -> InterfaceSystem {
    InterfaceSystem {
        law: AnyLaw::Spinodal(Parameters::heslot_1994().spinodal()),
        interfaces: 2,
        loading: Loading::new(driving, 0.14).unwrap(),
    }
}

#[test]
fn hopf_points_are_where_they_are_known_to_be() {
    let fast =
        |symmetry| hopf_points(&slab(200.0), symmetry, Parameter::Driving).unwrap()[0].driving;
    assert!((fast(Symmetry::Asymmetric) - 231.309).abs() < 5e-4);
    assert!((fast(Symmetry::Symmetric) - 190.983).abs() < 5e-4);
}

#[test]
fn branches_lead_from_there_to_the_orbits_known() {
    let period = |driving, symmetry| period_from_hopf(&slab(driving), symmetry).unwrap().unwrap();
    let asymmetric = period(200.0, Symmetry::Asymmetric) / 0.087_116_411_866_969_16;
    assert!((asymmetric - 1.0).abs() < 1e-7, "{asymmetric}");
    let symmetric = period(100.0, Symmetry::Symmetric) / 0.269_687_217_909_473_3;
    assert!((symmetric - 1.0).abs() < 1e-7, "{symmetric}");
}
