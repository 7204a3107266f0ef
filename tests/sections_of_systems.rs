//! Return maps, regimes and exponents of systems of three, four, six and twelve equations.

use crate::common::among::{Among, mixed};
use crate::common::{data, number};
use twinslip::Error;
use twinslip::field::{Matrix, State, Vector, vector};
use twinslip::integrate::{AnyField, AnyIntegrator, Choice, Control, MAX_STEPS, Tolerances};
use twinslip::model::Smooth;
use twinslip::model::classics::{Langford, Lorenz};
use twinslip::number::polynomial::Crossing;
use twinslip::number::{Real, Uncertain};
use twinslip::section::{
    Ended, LyapunovSpectrum, Regime, RegimeVerdict, ReturnRecord, SeriesVariables, Surface,
    Watching, record, record_finely, return_map, spectrum, verdict,
};
use twinslip::series::Equations;

/// A plane normal . x = offset, passed upwards.
fn plane(normal: Vector, offset: f64) -> Surface {
    Surface {
        normal,
        offset,
        direction: Crossing::Upwards,
        chart: SeriesVariables::Plain,
        turn: None,
    }
}

/// A point of three variables, among others.
fn point<const N: usize>(x: [f64; 3]) -> Vector {
    vector(&mixed::<N>(&State::from(x)))
}

/// A plane of three variables, among others.
fn of_three<const N: usize>(normal: [f64; 3], offset: f64) -> Surface {
    plane(point::<N>(normal), offset)
}

fn taylor(tolerance: f64) -> AnyIntegrator {
    let tolerances = Tolerances::equal(tolerance).unwrap();
    AnyIntegrator::new(Choice::Taylor, tolerances, MAX_STEPS).unwrap()
}

fn watching(skip: usize, returns: usize) -> Watching {
    Watching {
        skip,
        returns,
        patience: 1e3,
        accuracy: 1e-12,
        max_step: f64::INFINITY,
        waypoints: false,
    }
}

/// The exponents along a run from a start on or near what attracts it.
fn exponents(
    field: &AnyField<'_>,
    start: &Vector,
    surface: &Surface,
    returns: usize,
) -> (ReturnRecord, LyapunovSpectrum) {
    let see = &mut |_: usize, _: Option<&_>| Control::Continue;
    let watching = watching(0, returns);
    let run = record_finely(field, start, surface, &watching, MAX_STEPS, see).unwrap();
    assert_eq!(run.ended, Ended::Complete);
    let found = spectrum(field, &run).unwrap();
    assert!(found.liouville_defect.abs() < 1e-8, "{found:?}");
    (run, found)
}

#[track_caller]
fn assert_holds(found: &[Uncertain], exact: &[f64], within: f64) {
    assert_eq!(found.len(), exact.len());
    for (found, exact) in found.iter().zip(exact) {
        let apart = (found.value - exact).abs();
        assert!(apart <= found.uncertainty, "{found:?}, {exact}");
        assert!(found.uncertainty < within, "{found:?}");
    }
}

/// Two van der Pol oscillators, drawn together.
#[derive(Debug, Clone, Copy)]
struct Pair;

impl Equations<4, 3> for Pair {
    const PARAMETERS: [&'static str; 3] = ["mu", "squared", "k"];

    fn rates<T: Real>(&self, [x1, y1, x2, y2]: [T; 4], [mu, squared, k]: [T; 3]) -> [T; 4] {
        let one = T::constant(1.0);
        [
            y1,
            mu * (one - x1 * x1) * y1 - x1 + k * (x2 - x1),
            y2,
            mu * (one - x2 * x2) * y2 - squared * x2 + k * (x1 - x2),
        ]
    }
}

/// x_i' = (x_{i+1} - x_{i-2}) x_{i-1} - x_i + F.
#[derive(Debug, Clone, Copy)]
struct Ring;

impl Equations<6, 1> for Ring {
    const PARAMETERS: [&'static str; 1] = ["force"];

    fn rates<T: Real>(&self, x: [T; 6], [force]: [T; 1]) -> [T; 6] {
        std::array::from_fn(|i| (x[(i + 1) % 6] - x[(i + 4) % 6]) * x[(i + 5) % 6] - x[i] + force)
    }
}

/// The orbit of a record through its point: the exponents are ln |mu| / T, and the multipliers those of the return map, in a
/// section x_0 = const that it passes so many times in a period.
fn check_orbit<S: Equations<N, P>, const N: usize, const P: usize>(
    name: &str,
    field: Smooth<S, N, P>,
) {
    let record = &data("foreign_orbits.json")["records"][name]["values"];
    let period = number(&record["period"]);
    let point: Vec<f64> = record["point"]
        .as_array()
        .unwrap()
        .iter()
        .map(number)
        .collect();
    let point = Vector::from_vec(point);
    let field = AnyField::of::<N>(&field);
    let multipliers = record["multipliers"].as_array().unwrap();
    let logs: Vec<f64> = multipliers.iter().map(|m| number(&m["ln_abs"])).collect();
    let mut normal = Vector::zeros(N);
    normal[1] = 1.0;
    // In the direction in which it passes its point.
    let mut surface = plane(normal, point[1]);
    if field.f(&point)[1] < 0.0 {
        surface.direction = Crossing::Downwards;
    }
    let (_, found) = exponents(&field, &point, &surface, 400);
    let mut exact: Vec<f64> = logs.iter().map(|log| log / period).collect();
    exact.push(0.0);
    exact.sort_by(|a, b| b.total_cmp(a));
    assert_holds(&found.exponents, &exact, 0.02);
    assert!(found.converged);

    let mut taylor = taylor(1e-14);
    let (mut y, mut time) = (point.clone(), 0.0);
    let mut derivative = Matrix::identity(N, N);
    while time < period - 1e-6 {
        let landing = return_map(&field, &surface, &mut taylor, &y, 10.0 * period).unwrap();
        derivative = landing.derivative * derivative;
        (y, time) = (landing.state, time + landing.time);
    }
    assert!((time - period).abs() < 1e-11, "{time}, {period}");
    assert!((&y - point).amax() < 1e-11, "{y}");
    let mut moduli: Vec<f64> = derivative
        .complex_eigenvalues()
        .iter()
        .map(|z| z.norm())
        .collect();
    moduli.sort_by(|a, b| b.total_cmp(a));
    let mut logs = logs;
    logs.sort_by(|a, b| b.total_cmp(a));
    for (modulus, log) in moduli.iter().zip(logs) {
        assert!(
            (modulus / log.exp() - 1.0).abs() < 1e-6,
            "{modulus:e}, {log}"
        );
    }
    // Out of the section nothing is left.
    assert!(moduli[N - 1] < 1e-12, "{moduli:?}");
}

#[test]
fn exponents_of_orbits_are_their_multipliers_over_the_period() {
    let pair = Smooth {
        equations: Pair,
        parameters: [1.0, 1.05, 0.2],
    };
    check_orbit("1a_two_coupled_vdp_antiphase_k0.2", pair);
    let ring = Smooth {
        equations: Ring,
        parameters: [2.0],
    };
    check_orbit("4a_lorenz96_N6_F2", ring);
}

/// The exponents of what is added to three equations.
fn of_others<const N: usize>() -> Vec<f64> {
    let of = |i: usize| {
        let partner = if i % 2 == 1 { i + 1 } else { i - 1 };
        let other = if partner < N { partner } else { i };
        -0.05 * (i + other) as f64
    };
    (3..N).map(of).collect()
}

fn langford<const N: usize>(rho: f64) -> Smooth<Among<Langford>, N, 2> {
    Smooth {
        equations: Among(Langford { omega: 3.5 }),
        parameters: [rho, 0.0],
    }
}

/// The orbit at eps = 0: its pair is that of the steady state of (r, z).
fn check_circle<const N: usize>() {
    const RHO: f64 = 1.0;
    let radius = Langford::radius(RHO);
    let start = point::<N>([radius, 0.0, 0.7]);
    let surface = of_three::<N>([0.0, 1.0, 0.0], 0.0);
    let field = langford::<N>(RHO);
    let (_, found) = exponents(&AnyField::of::<N>(&field), &start, &surface, 400);
    let pair = 0.5 * (1.0 - 0.49 - RHO * radius * radius);
    let mut exact = vec![0.0, pair, pair];
    exact.extend(of_others::<N>());
    exact.sort_by(|a, b| b.total_cmp(a));
    assert_holds(&found.exponents, &exact, 0.02);
}

#[test]
fn exponents_of_a_circle_among_others_are_known() {
    check_circle::<3>();
    check_circle::<4>();
    check_circle::<6>();
    check_circle::<12>();
}

/// The regime on the torus that the orbit sheds, and how fast it winds.
fn torus<const N: usize>() -> RegimeVerdict {
    let rho = 0.98 * Langford::torus();
    let field = langford::<N>(rho);
    let field = AnyField::of::<N>(&field);
    let start = point::<N>([Langford::radius(rho) + 0.05, 0.0, 0.7]);
    let surface = of_three::<N>([0.0, 1.0, 0.0], 0.0);
    let see = &mut |_: usize, _: Option<&_>| Control::Continue;
    let run = record(
        &mut taylor(1e-12),
        &field,
        &start,
        &surface,
        &watching(3000, 600),
        see,
    );
    assert_eq!(run.ended, Ended::Complete);
    verdict(&field, &surface, &run, None).unwrap()
}

#[test]
fn a_torus_among_others_winds_as_in_three_dimensions() {
    let three = torus::<3>();
    assert_eq!(three.regime, Regime::Torus, "{three:?}");
    let rotation = three.curve.unwrap().rotation;
    // Near its birth as the multipliers turn: omega_n T / 2 pi, omega_n^2 = 2 r^2 (1 + 0.7 rho) at the orbit.
    let rho = 0.98 * Langford::torus();
    let frequency = Langford::radius(rho) * (2.0 * (1.0 + 0.7 * rho)).sqrt();
    let turns = frequency / 3.5;
    let turns = (turns - turns.round()).abs();
    assert!(
        (rotation.value - turns).abs() < 0.02,
        "{rotation:?}, {turns}"
    );
    for (told, n) in [(torus::<4>(), 4), (torus::<6>(), 6), (torus::<12>(), 12)] {
        assert_eq!(told.regime, Regime::Torus, "{n}");
        let other = told.curve.unwrap().rotation;
        let apart = (other.value - rotation.value).abs();
        assert!(
            apart < other.uncertainty + rotation.uncertainty,
            "{n}: {other:?}, {rotation:?}"
        );
        assert!(apart < 1e-6, "{n}: {apart:e}");
    }
}

fn chaos<const N: usize>() {
    let field = Smooth {
        equations: Among(Lorenz::classical()),
        parameters: [28.0, 8.0 / 3.0],
    };
    let field = AnyField::of::<N>(&field);
    let surface = of_three::<N>([0.0, 0.0, 1.0], 27.0);
    let start = point::<N>([1.0, 1.0, 27.5]);
    let (run, found) = exponents(&field, &start, &surface, 3000);
    // Sprott, J. C. (2003). Chaos and Time-Series Analysis, table A.3.
    let mut exact = vec![0.9056, 0.0, -14.5723];
    exact.extend(of_others::<N>());
    exact.sort_by(|a, b| b.total_cmp(a));
    for (found, exact) in found.exponents.iter().zip(&exact) {
        let apart = (found.value - exact).abs();
        assert!(apart <= found.uncertainty + 5e-5, "{N}: {found:?}, {exact}");
        assert!(found.uncertainty < 0.05, "{N}: {found:?}");
    }
    let told = verdict(&field, &surface, &run, Some(found.known())).unwrap();
    assert_eq!(told.regime, Regime::Chaotic, "{N}: {told:?}");
    // Without exponents nobody says so.
    let told = verdict(&field, &surface, &run, None).unwrap();
    assert_eq!(told.regime, Regime::Undecided, "{N}: {told:?}");
}

#[test]
fn chaos_is_told_in_any_number_of_dimensions() {
    chaos::<4>();
    chaos::<6>();
}

/// Starts and surfaces of another dimension than the field's end in a typed error.
#[test]
fn points_and_surfaces_of_another_dimension_are_refused() {
    let field = langford::<4>(1.0);
    let field = AnyField::of::<4>(&field);
    let (start, surface) = (
        point::<4>([1.0, 0.0, 0.7]),
        of_three::<4>([0.0, 1.0, 0.0], 0.0),
    );
    let (short, flat) = (
        point::<3>([1.0, 0.0, 0.7]),
        of_three::<3>([0.0, 1.0, 0.0], 0.0),
    );
    for (start, surface) in [(&short, &surface), (&start, &flat)] {
        let see = &mut |_: usize, _: Option<&_>| Control::Continue;
        let watching = watching(0, 3);
        let run = record(&mut taylor(1e-9), &field, start, surface, &watching, see);
        assert!(
            matches!(run.ended, Ended::Failed(Error::Parameter { .. })),
            "{:?}",
            run.ended
        );
        assert!(run.returns.is_empty() && run.waypoints.is_empty());
        let landing = return_map(&field, surface, &mut taylor(1e-9), start, 10.0);
        assert!(matches!(landing, Err(Error::Parameter { .. })));
    }
}

/// Only Taylor's method has the series that a return map lands by.
#[test]
fn a_return_map_needs_series() {
    let field = langford::<3>(1.0);
    let field = AnyField::of::<3>(&field);
    let surface = of_three::<3>([0.0, 1.0, 0.0], 0.0);
    let tolerances = Tolerances::equal(1e-9).unwrap();
    let mut rodas =
        AnyIntegrator::new(Choice::named("rodas5p").unwrap(), tolerances, MAX_STEPS).unwrap();
    let landing = return_map(
        &field,
        &surface,
        &mut rodas,
        &point::<3>([1.0, 0.0, 0.7]),
        10.0,
    );
    assert!(matches!(landing, Err(Error::NotAnalytic)));
}
