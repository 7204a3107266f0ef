//! A solver may move to another thread, and many work at once.

use super::*;
use std::thread;
use twinslip::sundials::{Kinsol, Mode, Problem, Residual, Sensitivity};

fn is_send<T: Send>() {}

struct Root(f64);

impl Residual<1> for Root {
    fn residual(&self, u: &State<1>) -> State<1> {
        State::<1>::new(u[0] * u[0] - self.0)
    }
    fn jacobian(&self, u: &State<1>) -> Jacobian<1> {
        Jacobian::<1>::new(2.0 * u[0])
    }
}

fn work(i: usize) -> (State<2>, Vec<State<2>>, f64) {
    let start = State::<2>::new(0.1 * i as f64, 1.0);
    let mut cvode = cvode::<2>(METHODS[i % 2], OPERATIONS[i / 2 % 2], 1e-9, 1e-9);
    let columns = [State::<2>::new(1.0, 0.0), State::<2>::new(0.0, 1.0)];
    cvode
        .start_with_sensitivities(0.0, &start, &columns, &Sensitivity::default())
        .unwrap();
    cvode
        .advance(&Problem::new(&oscillator()), 10.0, Mode::Normal)
        .unwrap();
    let one = State::<1>::new(1.0);
    let root = Kinsol::<1>::new()
        .unwrap()
        .solve(&Root(1.0 + i as f64), &one, &one, &one)
        .unwrap();
    (cvode.state(), cvode.sensitivities().unwrap(), root[0])
}

#[test]
fn twelve_threads_give_what_one_gives() {
    is_send::<Cvode<3>>();
    is_send::<Kinsol<3>>();
    let alone: Vec<_> = (0..12).map(work).collect();
    let together: Vec<_> = thread::scope(|scope| {
        let handles: Vec<_> = (0..12).map(|i| scope.spawn(move || work(i))).collect();
        handles.into_iter().map(|h| h.join().unwrap()).collect()
    });
    assert_eq!(alone, together);
}

#[test]
fn a_started_solver_goes_on_in_another_thread() {
    let field = oscillator();
    let mut cvode = cvode::<2>(MultistepMethod::Bdf, Operations::Fixed, 1e-10, 1e-10);
    cvode.start(0.0, &State::<2>::new(0.0, 1.0)).unwrap();
    cvode
        .advance(&Problem::new(&field), 1.0, Mode::Normal)
        .unwrap();
    let state = thread::scope(|scope| {
        scope
            .spawn(move || {
                let mut cvode = cvode;
                cvode
                    .advance(&Problem::new(&oscillator()), 2.0, Mode::Normal)
                    .unwrap();
                cvode.state()
            })
            .join()
            .unwrap()
    });
    assert!((state[0] - 2.0_f64.sin()).abs() < 1e-7);
}
