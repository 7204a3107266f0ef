//! Closed forms of Hopf points.

use crate::common::heard::{slab, spinodal};
use std::ops::ControlFlow::Continue;
use twinslip::bifurcation::{BranchRequest, Event, Label, Parameter, equilibria};
use twinslip::equilibrium::Symmetry;
use twinslip::field::{Matrix, State};
use twinslip::model::{Loading, two_interfaces};

/// c_2 c_1 - c_0 of the characteristic polynomial of a matrix: zero where a pair of eigenvalues crosses.
fn crossing(matrix: &Matrix) -> f64 {
    let minor =
        |i: usize, j: usize| matrix[(i, i)] * matrix[(j, j)] - matrix[(i, j)] * matrix[(j, i)];
    let minors = minor(0, 1) + minor(0, 2) + minor(1, 2);
    matrix.clone().determinant() - matrix.trace() * minors
}

/// (29) and (34) against the Jacobian of the vector field, over the whole curves.
#[test]
fn closed_forms_and_the_jacobian_agree() {
    let law = spinodal();
    let mut compared = 0;
    for i in 0..60 {
        let v = 0.0505 * (403.0_f64 / 0.0505).powf(f64::from(i) / 59.0);
        let request = BranchRequest::new(slab(law, 2, v, 1.0), Parameter::Stiffness, (1e-4, 10.0));
        let mut rows = Vec::new();
        equilibria::branch(&request, &mut |event| {
            if let Event::Branch(row) = event
                && row.label == Some(Label::Hb)
            {
                rows.push(row);
            }
            Continue(())
        })
        .expect("branches");
        assert_eq!(rows.len(), 2, "V_H = {v}");
        for row in rows {
            let w = row.state.map(f64::ln);
            let y = State::<3>::new(row.stress, w[0], w[1]);
            let at = |k: f64| {
                let loading = Loading::new(v, k).expect("a loading");
                let jacobian = two_interfaces(law, loading).jacobian(&y);
                let matrix = Matrix::from_fn(3, 3, |i, j| jacobian[(i, j)]);
                match row.symmetry {
                    // in the plane of symmetry the trace vanishes
                    Symmetry::Symmetric => matrix[(0, 0)] + matrix[(1, 1)],
                    Symmetry::Asymmetric => crossing(&matrix),
                }
            };
            const NEAR: f64 = 1e-11;
            let [below, above] = [1.0 - NEAR, 1.0 + NEAR].map(|part| at(row.stiffness * part));
            assert!(
                below * above < 0.0,
                "V_H = {v}, {:?}: {below:e} {above:e}",
                row.symmetry
            );
            compared += 1;
        }
    }
    assert_eq!(compared, 120);
}
