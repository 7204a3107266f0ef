//! Any named parameter is free: derivatives of flows in it, and continuation over any two.

use crate::common::{data, number};
use std::ops::ControlFlow::{Break, Continue};
use twinslip::Error;
use twinslip::continuation::{Met, WatchedFunction};
use twinslip::field::{Parametrised, State, Vector, place};
use twinslip::integrate::{Integrator, MAX_STEPS, Taylor, Tolerances};
use twinslip::model::Smooth;
use twinslip::number::Real;
use twinslip::orbit::{
    Condition, ContinuationPoint, Corrector, Goal, OverParameters, Palc, PalcSettings,
    ParametrisedField, ShootingNodes, TestFunction, Tracer,
};
use twinslip::series::Equations;

/// Roessler's equations in all their parameters.
#[derive(Debug, Clone, Copy)]
struct Roessler;

impl Equations<3, 3> for Roessler {
    const PARAMETERS: [&'static str; 3] = ["a", "b", "c"];

    #[inline(always)]
    fn rates<T: Real>(&self, [x, y, z]: [T; 3], [a, b, c]: [T; 3]) -> [T; 3] {
        [-(y + z), x + a * y, b + z * (x - c)]
    }
}

/// Two of FitzHugh's cells of unlike recovery, one driving the other: more variables than are compiled.
#[derive(Debug, Clone, Copy)]
struct Cells;

impl Equations<4, 5> for Cells {
    const PARAMETERS: [&'static str; 5] =
        ["current", "slowness", "second_slowness", "gap", "power"];

    fn rates<T: Real>(&self, [v, w, u, r]: [T; 4], [i, e, d, g, p]: [T; 5]) -> [T; 4] {
        let cubic = |v: T| v - v * v * v / 3.0;
        // |v|^p = exp(p ln |v|): a power of a parameter.
        let pulled = (p * (v * v + 1.0).ln()).exp();
        [
            cubic(v) - w + i,
            e * (v + 0.7 - w * 0.8),
            cubic(u) - r + g * (v - u),
            d * (pulled - r * 0.8),
        ]
    }
}

fn roessler(a: f64, b: f64, c: f64) -> Smooth<Roessler, 3, 3> {
    Smooth {
        equations: Roessler,
        parameters: [a, b, c],
    }
}

fn cells() -> Smooth<Cells, 4, 5> {
    Smooth {
        equations: Cells,
        parameters: [0.5, 0.08, 0.11, 0.3, 0.7],
    }
}

fn apart<const N: usize>(made: &[f64; N], exact: &[f64; N]) -> f64 {
    let (made, exact) = (State::from(*made), State::from(*exact));
    (made - exact).amax() / exact.amax()
}

/// The derivatives in these parameters, in this order: against 31 digits, these against differences, and forward sensitivities
/// against them.
fn check<S: Equations<N, P>, const N: usize, const P: usize>(
    field: &Smooth<S, N, P>,
    y: State<N>,
    free: &[usize],
) {
    const STEP: f64 = 1e-6;
    let span = (0.0, 7.0);
    let mut reference = Taylor::reference(MAX_STEPS).unwrap();
    let (_, exact) = reference.derivatives(field, span, &y, free).unwrap();
    assert_eq!(exact.parameters.len(), free.len());
    for (&place, exact) in free.iter().zip(&exact.parameters) {
        let mut at = |change: f64| {
            let mut field = *field;
            field.parameters[place] += change;
            reference.flow(&field, span, &y, None).unwrap()
        };
        let slope = (at(STEP) - at(-STEP)) / (2.0 * STEP);
        let error = apart(&slope.into(), exact);
        assert!(error < 1e-8, "{free:?}, {place}: {error:e}");
    }
    let tolerances = Tolerances::equal(1e-14).unwrap();
    let mut taylor = Taylor::new(tolerances, MAX_STEPS).unwrap();
    let (_, made) = taylor.derivatives(field, span, &y, free).unwrap();
    for (made, exact) in made.parameters.iter().zip(&exact.parameters) {
        let error = apart(made, exact);
        assert!(error < 1e-11, "{free:?}: {error:e}");
    }
    #[cfg(feature = "sundials")]
    {
        use twinslip::integrate::CvodeIntegrator;
        use twinslip::sundials::MultistepMethod;
        let tolerances = Tolerances::equal(1e-11).unwrap();
        let mut cvode = CvodeIntegrator::new(MultistepMethod::Bdf, tolerances, MAX_STEPS).unwrap();
        let (_, tangent, made) = cvode.derivatives(field, span, &y, free).unwrap();
        assert_eq!(made.len(), free.len());
        for (made, exact) in made.into_iter().zip(&exact.parameters) {
            let error = apart(&made.into(), exact);
            assert!(error < 1e-6, "{free:?}, sensitivities: {error:e}");
        }
        for (j, exact) in exact.start.iter().enumerate() {
            let exact = State::<N>::from(*exact);
            let error = (tangent.column(j) - exact).amax() / (1.0 + exact.amax());
            assert!(error < 1e-7, "{free:?}, column {j}: {error:e}");
        }
    }
}

#[test]
fn flows_are_differentiated_in_any_parameters_in_any_order() {
    let y = State::<3>::new(1.0, -3.0, 0.4);
    // One and two are compiled, three run in loops.
    for free in [&[1][..], &[2, 0], &[1, 2], &[2, 1, 0]] {
        check(&roessler(0.2, 0.3, 4.0), y, free);
    }
    for free in [&[4][..], &[3, 0], &[0, 1, 2, 3, 4]] {
        check(&cells(), State::<4>::new(0.3, -0.1, -0.5, 0.6), free);
    }
}

/// Powers of variables and of parameters, by themselves or by logarithms.
#[derive(Debug, Clone, Copy)]
struct Powers {
    by_logarithms: bool,
}

impl Equations<2, 2> for Powers {
    const PARAMETERS: [&'static str; 2] = ["p", "q"];

    #[inline(always)]
    fn rates<T: Real>(&self, [x, y]: [T; 2], [p, q]: [T; 2]) -> [T; 2] {
        let pow = |a: T, b: T| {
            if self.by_logarithms {
                (b * a.ln()).exp()
            } else {
                a.pow(b)
            }
        };
        [
            pow(y, p) - pow(x, q * 0.1) * 0.5,
            pow(q, x) * 0.3 - pow(y, x),
        ]
    }
}

#[test]
fn powers_of_numbers_are_differentiated_in_base_and_exponent() {
    let [field, other] = [false, true].map(|by_logarithms| Smooth {
        equations: Powers { by_logarithms },
        parameters: [0.7, 1.3],
    });
    let y = State::<2>::new(1.0, 0.8);
    check(&field, y, &[0, 1]);
    check(&field, y, &[1]);
    for place in [0, 1] {
        let made = field.parameter_jacobian(&y, place);
        let error = (made - other.parameter_jacobian(&y, place)).amax();
        assert!(error < 1e-15, "{place}: {error:e}");
    }
    let mut reference = Taylor::reference(MAX_STEPS).unwrap();
    let mut at = |field| {
        reference
            .derivatives(field, (0.0, 7.0), &y, &[0, 1])
            .unwrap()
    };
    let ((_, made), (_, known)) = (at(&field), at(&other));
    for (made, known) in made.parameters.iter().zip(&known.parameters) {
        assert!(apart(made, known) < 1e-15, "{made:?}, {known:?}");
    }
}

#[test]
fn a_parameter_that_is_not_there_is_an_error_of_input() {
    let field = roessler(0.2, 0.2, 2.5);
    let y = State::<3>::new(1.0, -3.0, 0.4);
    let tolerances = Tolerances::equal(1e-8).unwrap();
    let mut taylor = Taylor::new(tolerances, MAX_STEPS).unwrap();
    let error = taylor.derivatives(&field, (0.0, 1.0), &y, &[0, 3]);
    let error = error.unwrap_err();
    assert!(
        error.is_input() && error.to_string().contains('3'),
        "{error}"
    );
    #[cfg(feature = "sundials")]
    {
        use twinslip::integrate::CvodeIntegrator;
        use twinslip::sundials::MultistepMethod;
        let mut cvode =
            CvodeIntegrator::<3>::new(MultistepMethod::Bdf, tolerances, MAX_STEPS).unwrap();
        let error = cvode.derivatives(&field, (0.0, 1.0), &y, &[3]);
        assert!(error.unwrap_err().is_input());
    }
    assert_eq!(place(field.names(), "c").unwrap(), 2);
    for (names, word) in [(["a", "d"], "d"), (["c", "c"], "c")] {
        let error = OverParameters::new(field, names).unwrap_err();
        assert!(matches!(error, Error::Parameter { .. }), "{error}");
        assert!(error.to_string().contains(word), "{error}");
    }
    assert!(
        place(cells().names(), "slownes")
            .unwrap_err()
            .to_string()
            .contains("slowness")
    );
}

type Over = OverParameters<Roessler, 3, 3>;

/// The doubling of the simple orbit along the parameter of this place in the plane, from the attractor at `at`.
fn doubling(family: &Over, at: [f64; 2], free: usize) -> ContinuationPoint {
    let mut corrector = Corrector::new(family, 1e-14).unwrap();
    let field = family.field(at);
    let start = Vector::from_column_slice(&[-3.0, 0.0, 0.1]);
    let mut tracer = Tracer::taylor(1e-10).unwrap();
    let start = tracer.flow(&field, &start, 300.0, None).unwrap();
    let shooting = ShootingNodes::along(&mut tracer, &field, &start, 5.8).unwrap();
    let held = [Condition::Parameter(free, at[free])];
    let site = ContinuationPoint { shooting, at };
    let orbit = corrector
        .correct(site, &[free], &held, Goal::SHARP)
        .unwrap();
    let mut direction = orbit.along[0].clone();
    if direction.parameters[free] < 0.0 {
        direction = direction.scaled(-1.0);
    }
    let settings = PalcSettings::branch(free, 0.3);
    let mut palc = Palc::from(&mut corrector, settings, orbit.site, direction).unwrap();
    let mut found = None;
    let watched = [WatchedFunction::TestFunction(TestFunction::Doubling)];
    palc.follow(&watched, 400, &mut |_, _, met| match met {
        Met::Zero(_, at) => {
            found = Some(at.here.site.clone());
            Break(())
        }
        Met::Point(_) => Continue(()),
    })
    .unwrap();
    let meets = [Condition::TestFunction(TestFunction::Doubling)];
    let sharp = corrector.correct(found.unwrap(), &[free], &meets, Goal::SHARP);
    sharp.unwrap().site
}

/// Along the curve of doublings to this value of the parameter of that place in the plane.
fn along_curve(
    family: &Over,
    from: ContinuationPoint,
    (to, value): (usize, f64),
) -> ContinuationPoint {
    let mut corrector = Corrector::new(family, 1e-14).unwrap();
    let settings = PalcSettings::locus(TestFunction::Doubling, 0.1);
    let meets = [Condition::TestFunction(TestFunction::Doubling)];
    let here = corrector.look(from, &[0, 1], &meets).unwrap();
    let direction = settings.direction(&here, &here.along[0]).unwrap();
    let towards = (value - here.site.at[to]).signum() * direction.parameters[to].signum();
    let direction = direction.scaled(towards);
    let begun = here.site.at[to];
    let mut palc = Palc::from(&mut corrector, settings, here.site, direction).unwrap();
    let mut near = None;
    palc.follow(&[], 200, &mut |_, _, met| match met {
        Met::Point(point) if (point.here.site.at[to] - value) * (begun - value) <= 0.0 => {
            near = Some(point.here.site.clone());
            Break(())
        }
        _ => Continue(()),
    })
    .unwrap();
    let mut near = near.expect("beyond the value");
    near.at[to] = value;
    let sharp = corrector.correct(near, &[1 - to], &meets, Goal::SHARP);
    sharp.unwrap().site
}

/// Around a triangle of parameters, over three planes and back to where it began.
#[test]
fn curves_of_bifurcations_run_over_any_two_parameters() {
    let known = &data("foreign_orbits.json")["records"]["2_roessler_PD1"]["values"];
    let known = number(&known["c"]);
    // The plane's order is the caller's.
    let plane = OverParameters::new(roessler(0.2, 0.2, 0.0), ["c", "b"]).unwrap();
    let first = doubling(&plane, [2.5, 0.2], 0);
    assert!((first.at[0] / known - 1.0).abs() < 1e-11, "{:?}", first.at);
    // In b and c to b = 0.25.
    let second = along_curve(&plane, first.clone(), (1, 0.25));
    let beside = OverParameters::new(roessler(0.2, 0.25, 0.0), ["a", "c"]).unwrap();
    let again = doubling(&beside, [0.2, 2.5], 1);
    assert!(
        (second.at[0] / again.at[1] - 1.0).abs() < 1e-10,
        "{:?}, {:?}",
        second.at,
        again.at
    );
    // At this b in a and c to the first c.
    let third = along_curve(&beside, again, (1, first.at[0]));
    // At this c in a and b back to b = 0.2, where a must be the first one.
    let plane = OverParameters::new(roessler(0.0, 0.0, first.at[0]), ["a", "b"]).unwrap();
    let at = [third.at[0], 0.25];
    let last = along_curve(&plane, ContinuationPoint { at, ..third }, (1, 0.2));
    assert!((last.at[0] / 0.2 - 1.0).abs() < 1e-10, "{:?}", last.at);
    let periods = last.shooting.period() / first.shooting.period();
    assert!((periods - 1.0).abs() < 1e-10, "{periods}");
}
