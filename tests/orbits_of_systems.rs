//! Periodic orbits of systems that have nothing to do with friction, by the same continuation.
#![allow(missing_docs)]

use std::ops::ControlFlow::{Break, Continue};
use twinslip::bifurcation::orbits::{Met, Watch, follow};
use twinslip::field::State;
use twinslip::integrate::{Choice, MAX_STEPS, Tolerances};
use twinslip::model::classics::{Brusselator, Langford, Roessler, VanDerPol};
use twinslip::orbit::{
    Condition, Corrector, Family, Goal, Indicator, OverParameters, Path, Polygon, Site, Tracer,
    Walk,
};

/// The orbit that a run settles on, of about this period.
fn settled<F: Family<N>, const N: usize>(
    family: &F,
    at: [f64; 2],
    start: State<N>,
    (settling, period): (f64, f64),
) -> Site<N> {
    let field = family.field(at);
    let mut tracer = Tracer::taylor(1e-10).expect("a tracer");
    let start = tracer.flow(&*field, &start, settling, None).expect("a run");
    let polygon = Polygon::along(&mut tracer, &*field, &start, period).expect("a polygon");
    Site { polygon, at }
}

/// The orbit at exactly these parameters.
fn closed<F: Family<N>, const N: usize>(
    corrector: &mut Corrector<'_, F, N>,
    site: Site<N>,
    free: usize,
) -> Site<N> {
    let held = [Condition::Parameter(free, site.at[free])];
    let orbit = corrector.correct(site, &[free], &held, Goal::SHARP);
    orbit.expect("an orbit").site
}

/// Along a branch from an orbit towards greater values of a parameter: the first zero of what is watched below `end`.
fn first<F: Family<3>>(
    family: &F,
    site: Site<3>,
    (free, end): (usize, f64),
    watch: Indicator,
) -> Option<Site<3>> {
    let mut corrector = Corrector::new(family, 1e-12).expect("a corrector");
    let path = Path::branch(free, 0.3);
    let here = corrector.look(site, &path.free, &[]).expect("an orbit");
    let mut direction = here.along[0].clone();
    if direction.parameters[free] < 0.0 {
        direction = direction.scaled(-1.0);
    }
    let mut walk = Walk::from(&mut corrector, path, here.site, direction).expect("a walk");
    let mut found = None;
    follow(
        &mut walk,
        &[Watch::Indicator(watch)],
        400,
        &mut |_, _, met| match met {
            Met::Zero(_, at) => {
                found = Some(at.site.clone());
                Break(())
            }
            Met::Orbit(pace) if pace.here.site.at[free] > end => Break(()),
            Met::Orbit(_) => Continue(()),
        },
    );
    let site = found?;
    let meets = [Condition::Indicator(watch)];
    let sharp = corrector.correct(site, &[free], &meets, Goal::SHARP);
    Some(sharp.expect("the bifurcation").site)
}

#[test]
fn langfords_orbit_sheds_its_torus_where_the_closed_form_says() {
    let family = OverParameters(Langford { omega: 3.5 });
    let rho = 0.3;
    let radius = Langford::radius(rho);
    let turn = std::f64::consts::TAU / 12.0;
    let nodes = (0..12).map(|k| {
        let (sin, cos) = (turn * f64::from(k)).sin_cos();
        State::<3>::new(radius * cos, radius * sin, 0.7)
    });
    let site = Site {
        polygon: Polygon {
            nodes: nodes.collect(),
            durations: vec![turn / 3.5; 12],
        },
        at: [rho, 0.0],
    };
    let torus = first(&family, site, (0, 1.5), Indicator::Torus).expect("a torus");
    let error = (torus.at[0] / Langford::torus() - 1.0).abs();
    assert!(error < 1e-10, "{error}");
    let period = torus.polygon.period() * 3.5 / std::f64::consts::TAU;
    assert!((period - 1.0).abs() < 1e-12);
}

#[test]
fn roesslers_orbit_doubles_its_period_and_again() {
    let family = OverParameters(Roessler { b: 0.2 });
    let start = State::<3>::new(-3.0, 0.0, 0.1);
    let site = settled(&family, [0.2, 2.5], start, (300.0, 5.75));
    let mut corrector = Corrector::<_, 3>::new(&family, 1e-14).expect("a corrector");
    let site = closed(&mut corrector, site, 1);
    let doubling = first(&family, site, (1, 4.0), Indicator::Doubling).expect("a doubling");
    assert!((2.8..2.9).contains(&doubling.at[1]), "{}", doubling.at[1]);
    // The same by an unlike method, on nodes cut to six digits.
    let mut rough = doubling.clone();
    for x in &mut rough.polygon.nodes {
        *x = x.map(|x| (x * 1e6).round() / 1e6);
    }
    let choice = Choice::named("rodas5p").expect("a method");
    let tolerances = Tolerances::equal(1e-12).expect("tolerances");
    let tracer = Tracer::new(choice, tolerances, MAX_STEPS).expect("a tracer");
    let mut second = Corrector::by(&family, tracer);
    let meets = [Condition::Indicator(Indicator::Doubling)];
    let again = second
        .correct(rough, &[1], &meets, Goal::SHARP)
        .expect("the same");
    assert!((again.site.at[1] / doubling.at[1] - 1.0).abs() < 1e-9);
    // The orbit of twice the period, and its own doubling: the cascade.
    let here = corrector
        .look(doubling.clone(), &[1], &meets)
        .expect("an orbit");
    let (twice, direction) = here.doubled().expect("a multiplier -1");
    let path = Path::branch(1, 0.3);
    let mut walk = Walk::from(
        &mut corrector,
        path,
        twice.moved(&direction, 0.05),
        direction,
    )
    .expect("a walk onto the doubled branch");
    let mut cascade = None;
    follow(
        &mut walk,
        &[Watch::Indicator(Indicator::Doubling)],
        400,
        &mut |_, _, met| match met {
            Met::Zero(_, at) => {
                cascade = Some(at.site.clone());
                Break(())
            }
            Met::Orbit(_) => Continue(()),
        },
    );
    let next = cascade.expect("a second doubling");
    assert!((3.7..3.9).contains(&next.at[1]), "{}", next.at[1]);
    let ratio = next.polygon.period() / doubling.polygon.period();
    assert!((1.9..2.2).contains(&ratio), "{ratio}");
}

#[test]
fn van_der_pols_period_at_damping_one_and_a_thousand() {
    let family = OverParameters(VanDerPol);
    let site = settled(&family, [1.0, 0.0], State::<2>::new(2.0, 0.0), (60.0, 6.66));
    let mut corrector = Corrector::<_, 2>::new(&family, 1e-15).expect("a corrector");
    let site = closed(&mut corrector, site, 0);
    // Andersen, C. M. and Geer, J. F. (1982). SIAM J. Appl. Math. 42, 678-693.
    assert!((site.polygon.period() / 6.663_286_859_323_13 - 1.0).abs() < 1e-13);
    let choice = Choice::named("rodas5p").expect("a method");
    let tolerances = Tolerances::equal(1e-9).expect("tolerances");
    let tracer = Tracer::new(choice, tolerances, MAX_STEPS).expect("a tracer");
    let mut stiff = Corrector::by(&family, tracer);
    let (damping, held) = (1000.0, [Condition::Parameter(0, 1000.0)]);
    let at = [damping, 0.0];
    let period = VanDerPol::relaxation_period(damping);
    let field = Family::<2>::field(&family, at);
    // On the slow part of the cycle, and once around.
    let start = State::<2>::new(1.9, -1.9 / (damping * (1.9 * 1.9 - 1.0)));
    let start = stiff
        .tracer
        .flow(&*field, &start, period, None)
        .expect("a run");
    let polygon = Polygon::along(&mut stiff.tracer, &*field, &start, period).expect("a run");
    drop(field);
    let orbit = stiff.correct(Site { polygon, at }, &[0], &held, Goal::STEP);
    let site = orbit.expect("a stiff orbit").site;
    let error = (site.polygon.period() - VanDerPol::relaxation_period(1000.0)).abs();
    assert!(error < 5.0 * 1000.0_f64.ln() / 1000.0, "{error}");
}

#[test]
fn brusselators_orbits_begin_with_the_period_of_their_hopf_point() {
    let family = OverParameters(Brusselator);
    let start = State::<2>::new(1.2, 2.0);
    let site = settled(&family, [1.0, 2.05], start, (2000.0, 6.3));
    let mut corrector = Corrector::<_, 2>::new(&family, 1e-14).expect("a corrector");
    let near = closed(&mut corrector, site, 1);
    let site = settled(&family, [1.0, 2.01], near.polygon.nodes[0], (4000.0, 6.29));
    let nearer = closed(&mut corrector, site, 1);
    // T - 2 pi shrinks in proportion with B - 2.
    let tau = std::f64::consts::TAU;
    let off = [&near, &nearer].map(|site| site.polygon.period() - tau);
    assert!(off[0].abs() < 0.05, "{off:?}");
    assert!((off[0] / off[1] / 5.0 - 1.0).abs() < 0.15, "{off:?}");
}
