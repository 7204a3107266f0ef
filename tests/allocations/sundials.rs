//! No step of CVODES, and no solution of KINSOL, allocates in Rust; what C allocates at the first step is not counted.

use allocation_counter::measure;
use twinslip::field::{Jacobian, State};
use twinslip::friction::{AnyLaw, Parameters};
use twinslip::integrate::Tolerances;
use twinslip::model::{Driven, Loading, two_interfaces};
use twinslip::sundials::{
    Cvode, Kinsol, Mode, MultistepMethod, Operations, Problem, Residual, Sensitivity,
};

struct Equilibrium(Box<dyn Driven<3>>);

impl Residual<3> for Equilibrium {
    fn residual(&self, u: &State<3>) -> State<3> {
        self.0.f(u)
    }

    fn jacobian(&self, u: &State<3>) -> Jacobian<3> {
        self.0.jacobian(u)
    }
}

fn field() -> Box<dyn Driven<3>> {
    let law = AnyLaw::Spinodal(Parameters::heslot_1994().spinodal());
    two_interfaces(law, Loading::new(10.0, 0.14).unwrap())
}

#[test]
fn no_step_of_cvodes_allocates() {
    let field = field();
    let problem = Problem {
        events: Some(&|_, y: &State<3>, g| g[0] = y[0] - 100.0),
        ..Problem::new(&*field)
    };
    let y0 = State::<3>::new(10.0, -2.0, -4.0);
    let unit: Vec<State<3>> = Jacobian::<3>::identity()
        .column_iter()
        .map(|c| c.into_owned())
        .collect();
    for operations in [Operations::Fixed, Operations::Stock] {
        let mut cvode = Cvode::<3>::new(MultistepMethod::Bdf, operations).unwrap();
        cvode
            .set_tolerances(Tolerances::equal(1e-8).unwrap())
            .unwrap();
        cvode.watch_events(1, &[]).unwrap();
        for tangent in [false, true] {
            if tangent {
                cvode
                    .start_with_sensitivities(0.0, &y0, &unit, &Sensitivity::default())
                    .unwrap();
            } else {
                cvode.start(0.0, &y0).unwrap();
            }
            // The first step sets up what is used from then on.
            let one = cvode.advance(&problem, 20.0, Mode::OneStep).unwrap();
            let counted = measure(|| {
                cvode.advance(&problem, 10.0, Mode::Normal).unwrap();
                let arrival = cvode.advance(&problem, 20.0, Mode::OneStep).unwrap();
                cvode.dense(arrival.t).unwrap();
            });
            assert!(one.t < 10.0 && cvode.work().unwrap().steps > 500);
            assert_eq!(counted.count_total, 0, "{operations:?}: {counted:?}");
        }
    }
}

#[test]
fn no_solution_of_kinsol_allocates() {
    let problem = Equilibrium(field());
    let psi: f64 = 1.0 / (1.0 + 100.0 * 5.0);
    let guess = State::<3>::new(9.9, psi.ln() + 0.01, psi.ln() - 0.01);
    let u_scale = State::<3>::repeat(1.0);
    let f_scale = State::<3>::new(1.0 / 1.4, 0.2, 0.2);
    let mut kinsol = Kinsol::<3>::new().unwrap();
    kinsol.solve(&problem, &guess, &u_scale, &f_scale).unwrap();
    let counted = measure(|| {
        kinsol.solve(&problem, &guess, &u_scale, &f_scale).unwrap();
    });
    assert!(kinsol.work().unwrap().iterations > 1);
    assert_eq!(counted.count_total, 0, "{counted:?}");
    // and the counter counts
    assert_eq!(
        measure(|| drop(std::hint::black_box(vec![0_u8; 100]))).count_total,
        1
    );
}
