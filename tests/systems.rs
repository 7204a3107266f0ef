//! Any small system written once: the classics and the normal form of the 1:2 resonance. Derivatives against differences,
//! flows and tangents against 31 digits and an unlike method, special points against their closed forms.

use std::f64::consts::PI;
use twinslip::field::{Jacobian, Parametrised, State, VectorField};
use twinslip::integrate::{
    Control, Integrator, MAX_STEPS, Rosenbrock, RosenbrockMethod, Step, Taylor, Tolerances,
};
use twinslip::model::Smooth;
use twinslip::model::classics::{Brusselator, Langford, Lorenz, Roessler, VanDerPol};
use twinslip::model::normal_form::StrongResonance;
use twinslip::number::polynomial::Crossing;
use twinslip::series::{Equations, Section, Zeros};

fn taylor(tolerance: f64) -> Taylor {
    Taylor::new(Tolerances::equal(tolerance).unwrap(), MAX_STEPS).unwrap()
}

fn rodas<const N: usize>() -> Rosenbrock<N> {
    let tolerances = Tolerances::equal(1e-12).unwrap();
    Rosenbrock::new(RosenbrockMethod::Rodas5P, tolerances, MAX_STEPS).unwrap()
}

fn lorenz() -> Smooth<Lorenz, 3, 2> {
    Smooth {
        equations: Lorenz::classical(),
        parameters: [28.0, 8.0 / 3.0],
    }
}

fn van_der_pol(mu: f64) -> Smooth<VanDerPol, 2, 2> {
    Smooth {
        equations: VanDerPol,
        parameters: [mu, 0.0],
    }
}

/// The largest difference of two vectors, in units of the largest entry of the second.
fn apart<const N: usize>(made: [f64; N], exact: [f64; N]) -> f64 {
    let (made, exact) = (State::from(made), State::from(exact));
    (made - exact).amax() / exact.amax()
}

/// f, J and D2f against each other by differences at y.
fn check_derivatives<S: Equations<N, 2>, const N: usize>(field: &Smooth<S, N, 2>, y: [f64; N]) {
    const STEP: f64 = 1e-5;
    let y = State::from(y);
    let direction = State::<N>::from_fn(|i, _| 0.3 + 0.4 * i as f64);
    let (up, down) = (y + direction * STEP, y - direction * STEP);
    let slope = (field.f(&up) - field.f(&down)) / (2.0 * STEP);
    let made = field.jacobian(&y) * direction;
    assert!((made - slope).amax() < 1e-8 * (1.0 + slope.amax()), "J");
    let other = State::<N>::from_fn(|i, _| 1.0 - 0.7 * i as f64);
    let slope = (field.jacobian(&up) - field.jacobian(&down)) / (2.0 * STEP) * other;
    let made = field.second_derivative(&y, &other, &direction);
    assert!((made - slope).amax() < 1e-8 * (1.0 + slope.amax()), "D2f");
    for i in 0..2 {
        let at = |change: f64| {
            let mut field = *field;
            field.parameters[i] += change;
            field.f(&y)
        };
        let slope = (at(STEP) - at(-STEP)) / (2.0 * STEP);
        let made = field.parameter_derivative(&y, i);
        assert!((made - slope).amax() < 1e-8 * (1.0 + slope.amax()), "df/dp");
    }
}

/// Flow, tangent, derivatives in the parameters and the integral of the trace at t, against 31 digits, against Rodas5P and,
/// for the parameters and the start, against differences.
fn check_flows<S: Equations<N, 2>, const N: usize>(field: &Smooth<S, N, 2>, y: [f64; N], t: f64) {
    let (span, y) = ((0.0, t), State::from(y));
    let mut reference = Taylor::reference(MAX_STEPS).unwrap();
    let (end, exact) = reference.derivatives(field, span, &y, &[0, 1]).unwrap();
    let alone = reference.flow(field, span, &y, None).unwrap();
    assert!((alone - end).amax() < 1e-15 * end.amax());
    let flow = taylor(1e-14).flow(field, span, &y, None).unwrap();
    assert!((flow - end).amax() < 1e-12 * end.amax(), "flow");
    let (state, made) = taylor(1e-14).derivatives(field, span, &y, &[0, 1]).unwrap();
    assert!((state - end).amax() < 1e-12 * end.amax(), "state");
    for j in 0..N {
        let error = apart(made.start[j], exact.start[j]);
        assert!(error < 1e-11, "column {j}: {error:e}");
    }
    for j in 0..2 {
        let error = apart(made.parameters[j], exact.parameters[j]);
        assert!(error < 1e-11, "parameter {j}: {error:e}");
    }
    let error = (made.log_determinant - exact.log_determinant).abs();
    assert!(error < 1e-13 * (1.0 + exact.log_determinant.abs()), "trace");
    let (other_end, other) = rodas().tangent_flow(field, span, &y).unwrap();
    assert!((other_end - end).amax() < 1e-8 * end.amax(), "Rodas5P");
    let matrix = Jacobian::<N>::from(exact.start);
    assert!(
        (other - matrix).amax() < 1e-7 * matrix.amax(),
        "its tangent"
    );
    check_differences(field, &y, t, &exact.start, &exact.parameters);
}

/// The columns against differences of two runs in 31 digits.
fn check_differences<S: Equations<N, 2>, const N: usize>(
    field: &Smooth<S, N, 2>,
    y: &State<N>,
    t: f64,
    start: &[[f64; N]; N],
    parameters: &[[f64; N]],
) {
    const STEP: f64 = 1e-6;
    let end = |field: &Smooth<S, N, 2>, y: State<N>| {
        let mut reference = Taylor::reference(MAX_STEPS).unwrap();
        reference.flow(field, (0.0, t), &y, None).unwrap()
    };
    for (j, column) in start.iter().enumerate() {
        let mut e = State::<N>::zeros();
        e[j] = STEP;
        let slope = (end(field, y + e) - end(field, y - e)) / (2.0 * STEP);
        assert!(apart(slope.into(), *column) < 1e-7, "column {j}");
    }
    for (j, column) in parameters.iter().enumerate() {
        let at = |change: f64| {
            let mut field = *field;
            field.parameters[j] += change;
            end(&field, *y)
        };
        let slope = (at(STEP) - at(-STEP)) / (2.0 * STEP);
        assert!(apart(slope.into(), *column) < 1e-7, "parameter {j}");
    }
}

pub fn check<S: Equations<N, 2>, const N: usize>(field: Smooth<S, N, 2>, y: [f64; N], t: f64) {
    check_derivatives(&field, y);
    check_flows(&field, y, t);
}

#[test]
fn lorenz_is_right() {
    check(lorenz(), [1.0, 2.0, 20.0], 2.0);
}

#[test]
fn roessler_is_right() {
    let field = Smooth {
        equations: Roessler { b: 0.2 },
        parameters: [0.2, 5.7],
    };
    check(field, [1.0, 2.0, 0.2], 12.0);
    let steady = field.equations.steady(field.parameters);
    assert!(field.f(&State::from(steady)).amax() < 1e-14);
}

#[test]
fn brusselator_is_right() {
    let field = Smooth {
        equations: Brusselator,
        parameters: [1.0, 3.0],
    };
    check(field, [1.0, 2.0], 8.0);
}

#[test]
fn langford_is_right() {
    let field = Smooth {
        equations: Langford { omega: 3.5 },
        parameters: [0.25, 0.02],
    };
    check(field, [1.0, 0.2, 0.2], 8.0);
}

#[test]
fn van_der_pol_is_right() {
    let field = Smooth {
        equations: VanDerPol,
        parameters: [2.0, 0.1],
    };
    check(field, [2.0, 0.3], 6.0);
}

#[test]
fn the_normal_form_is_right() {
    let field = Smooth {
        equations: StrongResonance,
        parameters: [-0.1, -0.3],
    };
    check(field, [0.3, 0.2], 10.0);
}

/// The same in reverse, and both ways to the beginning.
#[test]
fn flows_turn_back() {
    let y = State::<3>::new(1.0, 2.0, 20.0);
    let there = taylor(1e-15).flow(&lorenz(), (0.0, 0.5), &y, None).unwrap();
    let (back, d) = taylor(1e-15)
        .derivatives(&lorenz(), (0.5, 0.0), &there, &[])
        .unwrap();
    assert!((back - y).amax() < 1e-10);
    assert!((d.log_determinant - 0.5 * (11.0 + 8.0 / 3.0)).abs() < 1e-13);
}

/// Where the tangent's own determinant has long lost its digits.
#[test]
fn the_trace_knows_strongly_contracting_determinants() {
    let y = State::<3>::new(1.0, 2.0, 20.0);
    let t = 40.0;
    let (_, d) = taylor(1e-14)
        .derivatives(&lorenz(), (0.0, t), &y, &[])
        .unwrap();
    let exact = -t * (11.0 + 8.0 / 3.0);
    assert!((d.log_determinant - exact).abs() < 1e-13 * exact.abs());
}

/// rho = 470/19 = 24.7368421 for sigma = 10, beta = 8/3: a pair of eigenvalues +-i omega, so that trace and sum of principal
/// minors have the determinant as their product.
#[test]
fn lorenz_has_its_hopf_point() {
    let lorenz = lorenz();
    let [_, beta] = lorenz.parameters;
    let rho = lorenz.equations.hopf(beta);
    assert!((rho - 470.0 / 19.0).abs() < 1e-13);
    let field = Smooth {
        parameters: [rho, beta],
        ..lorenz
    };
    let steady = State::from(field.equations.steady(field.parameters));
    assert!(field.f(&steady).amax() < 1e-13);
    let j = field.jacobian(&steady);
    let minors = 0.5 * (j.trace() * j.trace() - (j * j).trace());
    let determinant = j.determinant();
    assert!((j.trace() * minors - determinant).abs() < 1e-12 * determinant.abs());
}

#[test]
fn brusselator_has_its_hopf_point() {
    for a in [0.5, 1.0, 2.0] {
        let field = Smooth {
            equations: Brusselator,
            parameters: [a, Brusselator::hopf(a)],
        };
        let steady = State::from(Brusselator::steady(field.parameters));
        assert!(field.f(&steady).amax() < 1e-14);
        let j = field.jacobian(&steady);
        assert!(j.trace().abs() < 1e-14);
        assert!((j.determinant() - a * a).abs() < 1e-13);
    }
}

/// The periodic orbit of Langford's system in closed form, and the torus that it sheds: there the multipliers beside 1 have
/// the product 1, and are complex.
#[test]
fn langford_has_its_torus() {
    let omega = 3.5;
    let rho = Langford::torus();
    assert!((rho - 0.615_446_500_402_25).abs() < 1e-12);
    let field = Smooth {
        equations: Langford { omega },
        parameters: [rho, 0.0],
    };
    let y = State::<3>::new(Langford::radius(rho), 0.0, 0.7);
    let (end, d) = taylor(1e-15)
        .derivatives(&field, (0.0, 2.0 * PI / omega), &y, &[])
        .unwrap();
    assert!((end - y).amax() < 1e-13);
    assert!(d.log_determinant.abs() < 1e-13);
    let trace = Jacobian::<3>::from(d.start).trace() - 1.0;
    // In (r, z) the eigenvalues are +-i nu with nu^2 = 2 r^2 (1 + 0.7 rho).
    let nu = y[0] * (2.0 * (1.0 + 0.7 * rho)).sqrt();
    assert!((trace - 2.0 * (nu * 2.0 * PI / omega).cos()).abs() < 1e-12);
}

/// The period of van der Pol's oscillator, between its passages of x = 0 downwards after `wait`.
fn period(mu: f64, wait: f64, tolerance: f64) -> f64 {
    let field = van_der_pol(mu);
    let section = Section::Plane {
        normal: &[1.0, 0.0],
        offset: 0.0,
    };
    let (mut zeros, mut passages) = (Zeros::default(), Vec::new());
    let mut times = Vec::new();
    let mut observer = |step: &Step<'_, 2>| {
        let series = step.series().expect("series");
        passages.clear();
        series.crossings(
            section,
            Some(Crossing::Downwards),
            &mut zeros,
            &mut passages,
        );
        times.extend(
            passages
                .iter()
                .map(|passage| (series.begin + passage.time).to_f64())
                .filter(|time| *time > wait),
        );
        Ok(if times.len() > 1 {
            Control::Stop
        } else {
            Control::Continue
        })
    };
    let start = State::<2>::new(2.0, 0.0);
    taylor(tolerance)
        .flow(&field, (0.0, 1e6), &start, Some(&mut observer))
        .unwrap();
    times[1] - times[0]
}

/// omega = 1 - mu^2/16 + 17 mu^4/3072 + 35 mu^6/884736 - 678899 mu^8/5096079360 + ...: Andersen, C. M. and Geer, J. F. (1982).
/// Power series expansions for the frequency and period of the limit cycle of the van der Pol equation. SIAM Journal on
/// Applied Mathematics 42, 678-693.
#[test]
fn van_der_pol_has_its_period_for_small_mu() {
    for mu in [0.1, 0.2] {
        let m = mu * mu;
        let omega = 1.0
            + m * (-1.0 / 16.0
                + m * (17.0 / 3072.0 + m * (35.0 / 884_736.0 - m * 678_899.0 / 5_096_079_360.0)));
        let error = period(mu, 60.0 / mu, 1e-15) - 2.0 * PI / omega;
        // The next term: below 1e-4 mu^10.
        assert!(error.abs() < 5e-13 + 1e-3 * m.powi(5), "{mu}: {error:e}");
    }
}

/// Dorodnitsyn's first two terms; the rest is of the order of ln mu / mu.
#[test]
fn van_der_pol_has_its_period_for_large_mu() {
    for mu in [100.0, 1000.0] {
        let error = period(mu, 1.5 * mu, 1e-10) - VanDerPol::relaxation_period(mu);
        let rest = f64::ln(mu) / mu;
        assert!(error.abs() < 3.0 * rest, "{mu}: {error:e}");
    }
}

/// The local bifurcations of (39)-(40) by the Jacobian.
#[test]
fn the_normal_form_has_its_local_curves() {
    let jacobian = |mu1: f64, mu2: f64, v: f64| {
        let field = Smooth {
            equations: StrongResonance,
            parameters: [mu1, mu2],
        };
        let y = State::<2>::new(v, 0.0);
        assert!(field.f(&y).amax() < 1e-15);
        field.jacobian(&y)
    };
    for mu2 in [0.02, 0.5] {
        let j = jacobian(StrongResonance::torus(mu2), mu2, 0.0);
        assert!(j.trace().abs() < 1e-15 && (j.determinant() - mu2).abs() < 1e-15);
    }
    for mu1 in [-0.3, 0.4] {
        let mu2 = StrongResonance::period_doubling(mu1);
        let j = jacobian(mu1, mu2, 0.0);
        assert!(j.determinant().abs() < 1e-15);
        assert_eq!(
            StrongResonance::trace_and_determinant([mu1, mu2]),
            [j.trace(), 0.0]
        );
    }
    for mu2 in [-0.02, -0.5] {
        let v = StrongResonance::steady(mu2).unwrap();
        let j = jacobian(StrongResonance::second_torus(mu2), mu2, v);
        assert!(j.trace().abs() < 1e-15 && (j.determinant() + 2.0 * mu2).abs() < 1e-15);
    }
    assert_eq!(StrongResonance::steady(0.1), None);
}

/// The stable cycle that the origin sheds at TR: A = 2 sqrt(-mu_1).
#[test]
fn the_normal_form_sheds_a_stable_torus() {
    let mu1 = -1e-4;
    let field = Smooth {
        equations: StrongResonance,
        parameters: [mu1, 1.0],
    };
    let amplitude = 2.0 * (-mu1).sqrt();
    for start in [0.5 * amplitude, 2.0 * amplitude] {
        let y = State::<2>::new(start, 0.0);
        let end = taylor(1e-12).flow(&field, (0.0, 2e5), &y, None).unwrap();
        assert!((end.norm() - amplitude).abs() < 1e-3 * amplitude, "{start}");
    }
}

/// One loop along the unstable manifold of the origin: the energy w^2/2 + mu_2 v^2/2 + v^4/4 falls on one side of the
/// homoclinic curve and rises on the other.
#[test]
fn the_normal_form_has_its_homoclinic_curve() {
    let mu2: f64 = -1e-4;
    let energy_after_a_loop = |mu1: f64| {
        let field = Smooth {
            equations: StrongResonance,
            parameters: [mu1, mu2],
        };
        let unstable = 0.5 * (-mu1 + (mu1 * mu1 - 4.0 * mu2).sqrt());
        let v = 1e-5;
        let y = State::<2>::new(v, unstable * v);
        // Twice the time from 1e-5 to the turn at sqrt(2 |mu_2|), of a motion v = sqrt(2 |mu_2|) sech(sqrt(|mu_2|) t).
        let turn = (2.0 * (-2.0 * mu2).sqrt() / v).acosh() / (-mu2).sqrt();
        let end = taylor(1e-13)
            .flow(&field, (0.0, 1.9 * turn), &y, None)
            .unwrap();
        let squared = end[0] * end[0];
        0.5 * end[1] * end[1] + (0.5 * mu2 + 0.25 * squared) * squared
    };
    let there = StrongResonance::homoclinic(mu2);
    assert!(energy_after_a_loop(1.02 * there) > 0.0);
    assert!(energy_after_a_loop(0.98 * there) < 0.0);
}

/// The factor of the fold of cycles by quadrature, with u = u_max sin t.
#[test]
fn the_normal_form_has_its_fold_of_cycles() {
    let ratio = |h: f64| {
        let root = (1.0 + 4.0 * h).sqrt();
        let (mut of_one, mut of_square) = (0.0, 0.0);
        // The trapezoidal rule of a smooth periodic function.
        const POINTS: usize = 400;
        for i in 0..POINTS {
            let t = PI * i as f64 / POINTS as f64;
            let squared = (1.0 + root) * t.sin().powi(2);
            let weight = t.cos().powi(2) * (squared + root - 1.0).sqrt();
            of_one += weight;
            of_square += squared * weight;
        }
        of_square / of_one
    };
    let least = (0..2000)
        .map(|i| ratio(0.05 + 5e-5 * i as f64))
        .fold(f64::INFINITY, f64::min);
    assert!((least - StrongResonance::fold_of_cycles(1.0)).abs() < 1e-9);
    assert!((ratio(1e-9) - StrongResonance::homoclinic(1.0)).abs() < 1e-3);
}
