//! Periodic orbits of systems that have nothing to do with friction, by the same continuation.

use crate::common::branches::first;
use crate::common::{data, number};
use std::ops::ControlFlow::{Break, Continue};
use twinslip::Error;
use twinslip::continuation::{Met, Stop, WatchedFunction};
use twinslip::field::{Jacobian, State, Vector, VectorField};
use twinslip::integrate::{AnyField, Choice, MAX_STEPS, Tolerances};
use twinslip::model::classics::{Brusselator, Langford, Roessler, VanDerPol};
use twinslip::number::Real;
use twinslip::orbit::{
    Condition, ContinuationPoint, Corrector, Goal, OverParameters, Palc, PalcSettings,
    ParametrisedField, ShootingNodes, TestFunction, Tracer,
};
use twinslip::series::Equations;

/// The orbit that a run settles on, of about this period.
fn settled(
    family: &dyn ParametrisedField,
    at: [f64; 2],
    start: &[f64],
    (settling, period): (f64, f64),
) -> ContinuationPoint {
    let field = family.field(at);
    let mut tracer = Tracer::taylor(1e-10).expect("a tracer");
    let start = Vector::from_column_slice(start);
    let start = tracer.flow(&field, &start, settling, None).expect("a run");
    let shooting = ShootingNodes::along(&mut tracer, &field, &start, period).expect("a shooting");
    ContinuationPoint { shooting, at }
}

/// The orbit at exactly these parameters.
fn closed(
    corrector: &mut Corrector<'_>,
    site: ContinuationPoint,
    free: usize,
) -> ContinuationPoint {
    let held = [Condition::Parameter(free, site.at[free])];
    let orbit = corrector.correct(site, &[free], &held, Goal::SHARP);
    orbit.expect("an orbit").site
}

#[test]
fn langfords_orbit_sheds_its_torus_where_the_closed_form_says() {
    let family = OverParameters::both(Langford { omega: 3.5 });
    let rho = 0.3;
    let radius = Langford::radius(rho);
    let turn = std::f64::consts::TAU / 12.0;
    let nodes = (0..12).map(|k| {
        let (sin, cos) = (turn * f64::from(k)).sin_cos();
        Vector::from_vec(vec![radius * cos, radius * sin, 0.7])
    });
    let site = ContinuationPoint {
        shooting: ShootingNodes {
            nodes: nodes.collect(),
            durations: vec![turn / 3.5; 12],
        },
        at: [rho, 0.0],
    };
    let mut corrector = Corrector::new(&family, 1e-12).expect("a corrector");
    let torus = first(&mut corrector, site, (0, 1.5), TestFunction::Torus).expect("a torus");
    let error = (torus.at[0] / Langford::torus() - 1.0).abs();
    assert!(error < 1e-10, "{error}");
    let period = torus.shooting.period() * 3.5 / std::f64::consts::TAU;
    assert!((period - 1.0).abs() < 1e-12);
}

#[test]
fn roesslers_orbit_doubles_its_period_and_again() {
    let family = OverParameters::both(Roessler { b: 0.2 });
    let site = settled(&family, [0.2, 2.5], &[-3.0, 0.0, 0.1], (300.0, 5.75));
    let mut corrector = Corrector::new(&family, 1e-14).expect("a corrector");
    let site = closed(&mut corrector, site, 1);
    let mut rougher = Corrector::new(&family, 1e-12).expect("a corrector");
    let doubling = first(&mut rougher, site, (1, 4.0), TestFunction::Doubling).expect("a doubling");
    assert!((2.8..2.9).contains(&doubling.at[1]), "{}", doubling.at[1]);
    // The same by an unlike method, on nodes cut to six digits.
    let mut rough = doubling.clone();
    for x in &mut rough.shooting.nodes {
        *x = x.map(|x| (x * 1e6).round() / 1e6);
    }
    let choice = Choice::named("rodas5p").expect("a method");
    let tolerances = Tolerances::equal(1e-12).expect("tolerances");
    let tracer = Tracer::new(choice, tolerances, MAX_STEPS).expect("a tracer");
    let mut second = Corrector::by(&family, tracer);
    let meets = [Condition::TestFunction(TestFunction::Doubling)];
    let again = second
        .correct(rough, &[1], &meets, Goal::SHARP)
        .expect("the same");
    assert!((again.site.at[1] / doubling.at[1] - 1.0).abs() < 1e-9);
    // The orbit of twice the period, and its own doubling: the cascade.
    let here = corrector
        .look(doubling.clone(), &[1], &meets)
        .expect("an orbit");
    let (twice, direction) = here.doubled().expect("a multiplier -1");
    let settings = PalcSettings::branch(1, 0.3);
    let mut palc = Palc::from(
        &mut corrector,
        settings,
        twice.moved(&direction, 0.05),
        direction,
    )
    .expect("a walk onto the doubled branch");
    let mut cascade = None;
    palc.follow(
        &[WatchedFunction::TestFunction(TestFunction::Doubling)],
        400,
        &mut |_, _, met| match met {
            Met::Zero(_, at) => {
                cascade = Some(at.here.site.clone());
                Break(())
            }
            Met::Point(_) => Continue(()),
        },
    )
    .expect("a branch");
    let next = cascade.expect("a second doubling");
    assert!((3.7..3.9).contains(&next.at[1]), "{}", next.at[1]);
    let ratio = next.shooting.period() / doubling.shooting.period();
    assert!((1.9..2.2).contains(&ratio), "{ratio}");
}

#[test]
fn van_der_pols_period_at_damping_one_and_a_thousand() {
    let family = OverParameters::both(VanDerPol);
    let site = settled(&family, [1.0, 0.0], &[2.0, 0.0], (60.0, 6.66));
    let mut corrector = Corrector::new(&family, 1e-15).expect("a corrector");
    let site = closed(&mut corrector, site, 0);
    // Andersen, C. M. and Geer, J. F. (1982). SIAM J. Appl. Math. 42, 678-693.
    assert!((site.shooting.period() / 6.663_286_859_323_13 - 1.0).abs() < 1e-13);
    let choice = Choice::named("rodas5p").expect("a method");
    let tolerances = Tolerances::equal(1e-9).expect("tolerances");
    let tracer = Tracer::new(choice, tolerances, MAX_STEPS).expect("a tracer");
    let mut stiff = Corrector::by(&family, tracer);
    let (damping, held) = (1000.0, [Condition::Parameter(0, 1000.0)]);
    let at = [damping, 0.0];
    let period = VanDerPol::relaxation_period(damping);
    let field = family.field(at);
    // On the slow part of the cycle, and once around.
    let start = Vector::from_vec(vec![1.9, -1.9 / (damping * (1.9 * 1.9 - 1.0))]);
    let start = stiff
        .tracer
        .flow(&field, &start, period, None)
        .expect("a run");
    let shooting = ShootingNodes::along(&mut stiff.tracer, &field, &start, period).expect("a run");
    drop(field);
    let orbit = stiff.correct(ContinuationPoint { shooting, at }, &[0], &held, Goal::STEP);
    let site = orbit.expect("a stiff orbit").site;
    let error = (site.shooting.period() - VanDerPol::relaxation_period(1000.0)).abs();
    assert!(error < 5.0 * 1000.0_f64.ln() / 1000.0, "{error}");
}

#[test]
fn brusselators_orbits_begin_with_the_period_of_their_hopf_point() {
    let family = OverParameters::both(Brusselator);
    let site = settled(&family, [1.0, 2.05], &[1.2, 2.0], (2000.0, 6.3));
    let mut corrector = Corrector::new(&family, 1e-14).expect("a corrector");
    let near = closed(&mut corrector, site, 1);
    let site = settled(
        &family,
        [1.0, 2.01],
        near.shooting.nodes[0].as_slice(),
        (4000.0, 6.29),
    );
    let nearer = closed(&mut corrector, site, 1);
    // T - 2 pi shrinks in proportion with B - 2.
    let tau = std::f64::consts::TAU;
    let off = [&near, &nearer].map(|site| site.shooting.period() - tau);
    assert!(off[0].abs() < 0.05, "{off:?}");
    assert!((off[0] / off[1] / 5.0 - 1.0).abs() < 0.15, "{off:?}");
}

/// Roessler's equations with a fourth one that has nothing to do with them: w' = -w / 10.
#[derive(Debug, Clone, Copy)]
struct WithAnother([f64; 2]);

impl VectorField<4> for WithAnother {
    fn f(&self, y: &State<4>) -> State<4> {
        let [a, c] = self.0;
        State::<4>::new(
            -y[1] - y[2],
            y[0] + a * y[1],
            0.2 + y[2] * (y[0] - c),
            -0.1 * y[3],
        )
    }

    fn jacobian(&self, y: &State<4>) -> Jacobian<4> {
        let [a, c] = self.0;
        #[rustfmt::skip]
        let jacobian = Jacobian::<4>::new(
            0.0, -1.0, -1.0, 0.0,
            1.0, a, 0.0, 0.0,
            y[2], 0.0, y[0] - c, 0.0,
            0.0, 0.0, 0.0, -0.1,
        );
        jacobian
    }

    fn second_derivative(&self, _: &State<4>, u: &State<4>, v: &State<4>) -> State<4> {
        State::<4>::new(0.0, 0.0, u[0] * v[2] + u[2] * v[0], 0.0)
    }
}

struct FourOfThem;

impl ParametrisedField for FourOfThem {
    fn dimension(&self) -> usize {
        4
    }

    fn plane(&self) -> [usize; 2] {
        [0, 1]
    }

    fn field(&self, at: [f64; 2]) -> AnyField<'_> {
        AnyField::new::<4>(Box::new(WithAnother(at)))
    }

    fn parameters(&self, at: [f64; 2]) -> [f64; 2] {
        at
    }

    fn scale(&self, _: [f64; 2]) -> [f64; 2] {
        [1.0; 2]
    }
}

/// The trace of a return map of three dimensions is no sum of two multipliers. Products over all of them serve in any dimension.
#[test]
fn indicators_are_refused_where_they_are_no_test_functions() {
    let family = FourOfThem;
    let choice = Choice::named("rodas5p").expect("a method");
    let tolerances = Tolerances::equal(1e-10).expect("tolerances");
    let mut corrector = Corrector::by(
        &family,
        Tracer::new(choice, tolerances, MAX_STEPS).expect("a tracer"),
    );
    let at = [0.2, 2.5];
    let field = family.field(at);
    let start = Vector::from_vec(vec![-3.0, 0.0, 0.1, 0.0]);
    let tracer = &mut corrector.tracer;
    let start = tracer.flow(&field, &start, 100.0, None).expect("a run");
    let shooting = ShootingNodes::along(tracer, &field, &start, 5.75).expect("a shooting");
    drop(field);
    let held = [Condition::Parameter(1, 2.5)];
    // The orbit itself is found in any dimension.
    let orbit = corrector
        .correct(ContinuationPoint { shooting, at }, &[1], &held, Goal::STEP)
        .expect("an orbit");
    assert!((orbit.site.shooting.period() - 5.75).abs() < 0.05);
    assert_eq!(orbit.spectrum.dimension, 4);
    assert!(matches!(
        orbit.spectrum.log_multipliers(),
        Err(Error::Dimension { dimension: 4, .. })
    ));
    // By a method that knows nothing of power series: where the three equations alone double, the fourth beside them.
    let meets = [Condition::TestFunction(TestFunction::Doubling)];
    let doubling = corrector
        .correct(orbit.site.clone(), &[1], &meets, Goal::STEP)
        .expect("a doubling");
    let known = &data("foreign_orbits.json")["records"]["2_roessler_PD1"]["values"];
    let error = (doubling.site.at[1] / number(&known["c"]) - 1.0).abs();
    assert!(error < 1e-8, "{error:e}");
    let test_function = TestFunction::Transverse;
    let refused = |error: Error| {
        assert!(
            matches!(error, Error::Dimension { dimension: 4, .. }),
            "{test_function:?}: {error}"
        );
        assert!(error.is_input());
    };
    let site = orbit.site.clone();
    let meets = [Condition::TestFunction(test_function)];
    refused(
        corrector
            .correct(site.clone(), &[1], &meets, Goal::STEP)
            .unwrap_err(),
    );
    refused(corrector.look(site.clone(), &[1], &meets).unwrap_err());
    let direction = orbit.along[0].clone();
    let settings = PalcSettings::locus(test_function, 0.3);
    let begun = Palc::from(&mut corrector, settings, site.clone(), direction.clone());
    refused(begun.err().expect("no continuation"));
    let mut palc = Palc::from(
        &mut corrector,
        PalcSettings::branch(1, 0.3),
        site,
        direction,
    )
    .expect("a continuation");
    let watches = [WatchedFunction::TestFunction(test_function)];
    refused(
        palc.follow(&watches, 5, &mut |_, _, _| Continue(()))
            .unwrap_err(),
    );
    // In the plane there are neither period doublings nor tori.
    for test_function in [TestFunction::Doubling, TestFunction::Torus] {
        assert!(test_function.checked(2).is_err() && test_function.checked(3).is_ok());
    }
}

/// An extent of a small orbit: no step of [`along`] leads past it.
const SMALL: f64 = 0.4;

/// Of an orbit's branch until it ends, leaves the range or has so many orbits: why, and the orbits' parameter and extent.
fn along(
    family: &dyn ParametrisedField,
    site: ContinuationPoint,
    (free, sign): (usize, f64),
    range: (f64, f64),
    most: usize,
) -> (Stop, Vec<(f64, f64)>) {
    let mut corrector = Corrector::new(family, 1e-11).expect("a corrector");
    let settings = PalcSettings::branch(free, 0.1);
    let here = corrector.look(site, &settings.free, &[]).expect("an orbit");
    let mut direction = here.along[0].clone();
    if direction.parameters[free] * sign < 0.0 {
        direction = direction.scaled(-1.0);
    }
    let mut palc =
        Palc::from(&mut corrector, settings, here.site, direction).expect("a continuation");
    let mut orbits = Vec::new();
    let end = palc.follow(&[], most, &mut |_, _, met| {
        if let Met::Point(now) = met {
            let site = &now.here.site;
            orbits.push((site.at[free], site.shooting.extent()));
            if !(range.0..range.1).contains(&site.at[free]) || site.shooting.extent() < SMALL {
                return Break(());
            }
        }
        Continue(())
    });
    (end.expect("a branch"), orbits)
}

/// The reaction A -> B -> C in a stirred tank, in (p_1, p_3): Uppal, A., Ray, W. H. and Poore, A. B. (1974). On the dynamic
/// behavior of continuous stirred tank reactors. Chem. Eng. Sci. 29, 967-985; with the numbers of AUTO's demo `abc`.
#[derive(Debug, Clone, Copy)]
struct Reaction;

impl Equations<3, 2> for Reaction {
    const PARAMETERS: [&'static str; 2] = ["p1", "p3"];

    fn rates<T: Real>(&self, [u, v, w]: [T; 3], [p1, p3]: [T; 2]) -> [T; 3] {
        let one = T::constant(1.0);
        let rate = p1 * w.exp();
        let first = rate * (one - u);
        let second = rate * v * 0.04;
        [
            first - u,
            first - v - second,
            (first + second) * 8.0 - w - p3 * w,
        ]
    }
}

/// v' = v - v^3/3 - w + I, w' = eps (v + 0.7 - 0.8 w), in (I, eps): FitzHugh, R. (1961). Biophys. J. 1, 445-466.
#[derive(Debug, Clone, Copy)]
struct FitzHughNagumo;

impl Equations<2, 2> for FitzHughNagumo {
    const PARAMETERS: [&'static str; 2] = ["v", "w"];

    fn rates<T: Real>(&self, [v, w]: [T; 2], [current, eps]: [T; 2]) -> [T; 2] {
        [v - v * v * v / 3.0 - w + current, eps * (v - w * 0.8 + 0.7)]
    }
}

/// On other scales steps are shorter; a branch ends where it gets nowhere, not where steps are short.
#[test]
fn branches_of_systems_on_other_scales_are_followed_to_their_ends() {
    let family = OverParameters::both(Reaction);
    let site = settled(&family, [0.21, 1.55], &[0.5, 0.4, 2.0], (400.0, 7.1585));
    let site = closed(&mut Corrector::new(&family, 1e-12).expect("one"), site, 0);
    // As many orbits as are asked for, and always further.
    const MOST: usize = 60;
    let (end, orbits) = along(&family, site, (0, -1.0), (0.1, 0.4), MOST);
    assert!(
        end == Stop::MaxPoints(MOST),
        "{end:?} after {}",
        orbits.len()
    );
    assert!(
        orbits.windows(2).all(|pair| pair[1].0 < pair[0].0),
        "{orbits:?}"
    );
    // Through the canards, where steps are short, to the Hopf point v = -sqrt(1 - 0.8 eps).
    let family = OverParameters::both(FitzHughNagumo);
    let (eps, period) = (0.08, 39.47);
    let site = settled(&family, [0.5, eps], &[1.0, 0.0], (2000.0, period));
    let site = closed(&mut Corrector::new(&family, 1e-12).expect("one"), site, 0);
    let (end, orbits) = along(&family, site, (0, -1.0), (0.0, 0.6), 2000);
    let &(current, extent) = orbits.last().expect("orbits");
    assert!(end == Stop::Observer && extent < SMALL, "{end:?}, {extent}");
    let v = -(1.0_f64 - 0.8 * eps).sqrt();
    let hopf = (v + 0.7) / 0.8 - v + v * v * v / 3.0;
    assert!((current - hopf).abs() < 0.02, "{current}, {hopf}");
}
