//! Criticality of orbits of four and more variables, and what it says of those that bifurcate from them.

use crate::common::among::{Among, langford, roessler};
use crate::common::branches::first;
use crate::common::{data, number};
use std::f64::consts::TAU;
use twinslip::Error;
use twinslip::bifurcation::Criticality;
use twinslip::bifurcation::orbits::normal_form::{Form, normal_form};
use twinslip::equilibrium::Symmetry;
use twinslip::field::{Matrix, Vector};
use twinslip::friction::{AnyLaw, Parameters};
use twinslip::integrate::{AnyField, Choice};
use twinslip::model::Loading;
use twinslip::model::classics::{Langford, Roessler, VanDerPol};
use twinslip::number::{Real, Uncertain};
use twinslip::orbit::{
    Condition, ContinuationPoint, Corrector, Goal, InitialGuess, InterfaceSystem, OrbitAccuracy,
    OverLoadings, OverParameters, Palc, PalcSettings, ParametrisedField, Query, ShootingNodes,
    TestFunction, Tracer, find,
};
use twinslip::series::Equations;

/// A coefficient within its uncertainty of a number, and within a bar.
fn assert_is(coefficient: Uncertain, exact: f64, what: &str) {
    let off = (coefficient.value - exact).abs();
    assert!(
        off <= coefficient.uncertainty,
        "{what}: {coefficient:?}, {exact}"
    );
    assert!(off < 1e-8 * exact.abs(), "{what}: {coefficient:?}, {exact}");
}

/// Roessler's first doubling among others, with the coefficient.
fn doubling<const N: usize>() -> (Uncertain, Criticality) {
    let family = OverParameters::<_, N, 2>::both(Among(Roessler { b: 0.2 }));
    let mut corrector = Corrector::new(&family, 1e-14).expect("a corrector");
    let site = roessler(&mut corrector);
    let site = first(&mut corrector, site, (1, 4.0), TestFunction::Doubling);
    normal_form(&family, &site.expect("a doubling"), Form::Doubling).expect("a form")
}

#[test]
fn a_doubling_has_the_coefficient_of_three_variables_among_others() {
    let (three, _) = doubling::<3>();
    for (n, (coefficient, criticality)) in [
        (4, doubling::<4>()),
        (6, doubling::<6>()),
        (12, doubling::<12>()),
    ] {
        assert_is(coefficient, three.value, &n.to_string());
        assert_eq!(criticality, Criticality::Supercritical);
    }
}

/// Re d of Langford's torus, in closed form: in (r, z) it is a Hopf point, with R' = a R^3 in x = z - 0.7, y = k (r - r_0).
/// Guckenheimer, J. and Holmes, P. (1983). Nonlinear Oscillations, Dynamical Systems, and Bifurcations of Vector Fields, (3.4.11).
fn of_langford(period: f64) -> f64 {
    let rho = Langford::torus();
    let (radius, c) = (Langford::radius(rho), 1.0 + 0.7 * rho);
    let k = (2.0 * c).sqrt();
    let (f_xx, f_yy, f_xy) = (-1.4, -2.0 * c / (k * k), -2.0 * rho * radius / k);
    let (f_xxx, f_xyy) = (-2.0, -2.0 * rho / (k * k));
    let a = (f_xxx + f_xyy) / 16.0 + f_xy * (f_xx + f_yy) / (16.0 * k * radius);
    // Of an eigenvector of length 1, around the orbit once.
    4.0 * a * k * k / (1.0 + k * k) * period
}

fn torus_among_others<const N: usize>() {
    let family = OverParameters::<_, N, 2>::both(Among(Langford { omega: 3.5 }));
    let mut corrector = Corrector::new(&family, 1e-14).expect("a corrector");
    let circle = langford::<N>(0.3);
    let torus = first(&mut corrector, circle, (0, 1.5), TestFunction::Torus);
    let form = normal_form(&family, &torus.expect("a torus"), Form::Torus);
    let (coefficient, criticality) = form.expect("a form");
    assert_is(coefficient, of_langford(TAU / 3.5), &N.to_string());
    assert_eq!(criticality, Criticality::Supercritical);
}

#[test]
fn a_torus_has_the_coefficient_of_the_closed_form() {
    torus_among_others::<3>();
    torus_among_others::<4>();
    torus_among_others::<6>();
    torus_among_others::<12>();
}

/// A system of three equations that drives a fourth one, w' = x - decay w.
#[derive(Debug, Clone, Copy)]
struct Driving<S> {
    system: S,
    decay: f64,
}

impl<S: Equations<3, 2>> Equations<4, 2> for Driving<S> {
    const PARAMETERS: [&'static str; 2] = S::PARAMETERS;

    fn rates<T: Real>(&self, [x, y, z, w]: [T; 4], parameters: [T; 2]) -> [T; 4] {
        let [dx, dy, dz] = self.system.rates([x, y, z], parameters);
        [dx, dy, dz, x - w * self.decay]
    }
}

/// Its orbits, with lengths measured in the three, and planes that regard the extents: no coefficient depends on planes.
struct InThree<S>(OverParameters<Driving<S>, 4, 2>);

impl<S: Equations<3, 2>> ParametrisedField for InThree<S> {
    fn dimension(&self) -> usize {
        4
    }

    fn plane(&self) -> [usize; 2] {
        self.0.plane()
    }

    fn field(&self, at: [f64; 2]) -> AnyField<'_> {
        self.0.field(at)
    }

    fn parameters(&self, at: [f64; 2]) -> [f64; 2] {
        self.0.parameters(at)
    }

    fn scale(&self, at: [f64; 2]) -> [f64; 2] {
        self.0.scale(at)
    }

    fn is_any_system(&self) -> bool {
        true
    }

    fn across(&self, _: &Vector, flow: &Vector) -> Matrix {
        let (mut three, mut along) = (Matrix::identity(4, 4), flow.clone());
        three[(3, 3)] = 0.0;
        along[3] = 0.0;
        three - &along * along.transpose() / along.norm_squared()
    }
}

/// The fourth equation's multiplier is up to e^-250.
#[test]
fn what_is_driven_changes_no_coefficient() {
    let (three, _) = doubling::<3>();
    for decay in [0.05, 1.0, 43.0] {
        let system = Roessler { b: 0.2 };
        let family = InThree(OverParameters::both(Driving { system, decay }));
        let mut corrector = Corrector::new(&family, 1e-14).expect("a corrector");
        let site = settled(&family, [0.2, 2.5], &[-3.0, 0.0, 0.1, 0.0], 5.73);
        let held = [Condition::Parameter(1, 2.5)];
        let orbit = corrector.correct(site, &[1], &held, Goal::SHARP);
        let site = orbit.expect("an orbit").site;
        let site = first(&mut corrector, site, (1, 4.0), TestFunction::Doubling);
        let form = normal_form(&family, &site.expect("a doubling"), Form::Doubling);
        assert_is(
            form.expect("a form").0,
            three.value,
            &format!("doubling, {decay}"),
        );

        let system = Langford { omega: 3.5 };
        let family = InThree(OverParameters::both(Driving { system, decay }));
        let mut corrector = Corrector::new(&family, 1e-14).expect("a corrector");
        let mut circle = langford::<4>(0.3);
        for (k, node) in circle.shooting.nodes.iter_mut().enumerate() {
            // w = Re r e^(i omega t) / (decay + i omega)
            let (radius, angle) = (Langford::radius(0.3), TAU / 12.0 * k as f64);
            let lag = 3.5_f64.atan2(decay);
            let w = radius / decay.hypot(3.5) * (angle - lag).cos();
            *node = Vector::from_vec(vec![radius * angle.cos(), radius * angle.sin(), 0.7, w]);
        }
        let torus = first(&mut corrector, circle, (0, 1.5), TestFunction::Torus);
        let form = normal_form(&family, &torus.expect("a torus"), Form::Torus);
        let exact = of_langford(TAU / 3.5);
        assert_is(form.expect("a form").0, exact, &format!("torus, {decay}"));
    }
}

/// The orbit that a run of 400 settles on, of about this period.
fn settled(
    family: &dyn ParametrisedField,
    at: [f64; 2],
    start: &[f64],
    period: f64,
) -> ContinuationPoint {
    let field = family.field(at);
    let mut tracer = Tracer::taylor(1e-10).expect("a tracer");
    let start = Vector::from_column_slice(start);
    let start = tracer.flow(&field, &start, 400.0, None).expect("a run");
    let shooting = ShootingNodes::along(&mut tracer, &field, &start, period).expect("nodes");
    ContinuationPoint { shooting, at }
}

/// Roessler's equations with a fourth one that acts back on them.
#[derive(Debug, Clone, Copy)]
struct Coupled;

impl Equations<4, 2> for Coupled {
    const PARAMETERS: [&'static str; 2] = ["a", "c"];

    fn rates<T: Real>(&self, [x, y, z, w]: [T; 4], [a, c]: [T; 2]) -> [T; 4] {
        [
            -(y + z),
            x + a * y + w * 0.1,
            z * (x - c) + 0.2,
            x * 0.1 + x * y * 0.02 - w,
        ]
    }
}

/// By how much ln |mu| of what bifurcates grows with a parameter: the multiplier nearest to the unit circle, by orbits at both sides.
fn growth(
    corrector: &mut Corrector<'_>,
    site: &ContinuationPoint,
    (free, apart): (usize, f64),
) -> f64 {
    let mut ln = |value: f64| {
        let held = [Condition::Parameter(free, value)];
        let orbit = corrector.correct(site.clone(), &[free], &held, Goal::SHARP);
        let orbit = orbit.expect("an orbit");
        let field = corrector.family.field(orbit.site.at);
        let multipliers = orbit.floquet(&field).multipliers;
        let logs = multipliers.iter().map(|one| one.ln_abs.value);
        logs.min_by(|a, b| a.abs().total_cmp(&b.abs()))
            .expect("one")
    };
    let at = site.at[free];
    (ln(at + apart) - ln(at - apart)) / (2.0 * apart)
}

/// Where the ratio of two quantities is known beside a bifurcation at two distances from it, its limit there.
fn limit([(near, at_near), (far, at_far)]: [(f64, f64); 2]) -> f64 {
    (at_near * far - at_far * near) / (far - near)
}

/// With the multiplier -(1 + beta), both rounds of the doubled orbit are eta q and -eta q away from the orbit that doubles, where
/// eta^2 = beta / b.
#[test]
fn doubled_orbits_part_as_the_coefficient_says() {
    let family = OverParameters::both(Coupled);
    let mut corrector = Corrector::new(&family, 1e-14).expect("a corrector");
    let site = settled(&family, [0.2, 2.5], &[-3.0, 0.0, 0.1, 0.0], 5.72);
    let site = first(&mut corrector, site, (1, 4.0), TestFunction::Doubling);
    let site = site.expect("a doubling");
    let (b, criticality) = normal_form(&family, &site, Form::Doubling).expect("a form");
    assert_eq!(criticality, Criticality::Supercritical);
    let growth = growth(&mut corrector, &site, (1, 1e-3));
    let meets = [Condition::TestFunction(TestFunction::Doubling)];
    let here = corrector
        .look(site.clone(), &[1], &meets)
        .expect("an orbit");
    let (twice, direction) = here.doubled().expect("a multiplier -1");
    let by_amplitude = [0.05, 0.1].map(|step| {
        let begun = Palc::from(
            &mut corrector,
            PalcSettings::branch(1, 0.3),
            twice.moved(&direction, step),
            direction.clone(),
        );
        let doubled = begun.expect("onto the doubled branch").now.here.site;
        let distance = doubled.at[1] - site.at[1];
        let ratio = doubled.shooting.period() / site.shooting.period();
        assert!((ratio - 2.0).abs() < 0.01, "{ratio}");
        (distance, growth * distance / apart(&family, &doubled))
    });
    let error = (limit(by_amplitude) / b.value - 1.0).abs();
    assert!(error < 1e-3, "{b:?}, {by_amplitude:?}");
}

/// The mean square, across the flow, of half the distance between both rounds of an orbit.
fn apart(family: &dyn ParametrisedField, doubled: &ContinuationPoint) -> f64 {
    const POINTS: usize = 400;
    let field = family.field(doubled.at);
    let mut tracer = Tracer::taylor(1e-13).expect("a tracer");
    let part = doubled.shooting.period() / (2 * POINTS) as f64;
    let mut x = doubled.shooting.nodes[0].clone();
    let mut rounds = Vec::new();
    for _ in 0..2 * POINTS {
        let next = tracer.flow(&field, &x, part, None).expect("a flow");
        rounds.push(std::mem::replace(&mut x, next));
    }
    let squares = (0..POINTS).map(|k| {
        let (one, other) = (&rounds[k], &rounds[k + POINTS]);
        let half = (one - other) / 2.0;
        let flow = field.f(&((one + other) / 2.0));
        half.norm_squared() - flow.dot(&half).powi(2) / flow.norm_squared()
    });
    squares.sum::<f64>() / POINTS as f64
}

/// A ring: x_i' = (x_{i+1} - x_{i-2}) x_{i-1} - d x_i + F, in (F, d). Lorenz (1996).
#[derive(Debug, Clone, Copy)]
struct Ring;

impl Equations<6, 2> for Ring {
    const PARAMETERS: [&'static str; 2] = ["force", "damping"];

    fn rates<T: Real>(&self, x: [T; 6], [force, damping]: [T; 2]) -> [T; 6] {
        let at = |i: usize| x[i % 6];
        std::array::from_fn(|i| (at(i + 1) - at(i + 4)) * at(i + 5) - damping * x[i] + force)
    }
}

/// On the torus that is shed |w|^2 = -beta / Re d, and w q + w* q* across the flow has the mean square 2 |w|^2.
#[test]
fn a_torus_is_as_thick_as_the_coefficient_says() {
    let record = &data("foreign_orbits.json")["records"]["4c_lorenz96_N6_neimark_sacker"]["values"];
    let point = record["point"].as_array().expect("a point");
    let start = Vector::from_iterator(6, point.iter().map(number));
    let family = OverParameters::both(Ring);
    let mut corrector = Corrector::new(&family, 1e-14).expect("a corrector");
    let at = [5.456_660_705_337_415, 1.0];
    let mut tracer = Tracer::taylor(1e-12).expect("a tracer");
    let shooting = ShootingNodes::along(
        &mut tracer,
        &family.field(at),
        &start,
        number(&record["period"]),
    );
    let site = ContinuationPoint {
        shooting: shooting.expect("nodes"),
        at,
    };
    let meets = [Condition::TestFunction(TestFunction::Torus)];
    let torus = corrector.correct(site, &[0], &meets, Goal::SHARP);
    let site = torus.expect("a torus").site;
    let (d, criticality) = normal_form(&family, &site, Form::Torus).expect("a form");
    assert_eq!(criticality, Criticality::Supercritical);
    let growth = growth(&mut corrector, &site, (0, 1e-3));
    let by_thickness = [0.01, 0.02].map(|distance| {
        let force = at[0] + distance;
        let held = [Condition::Parameter(0, force)];
        let orbit = corrector.correct(site.clone(), &[0], &held, Goal::SHARP);
        let orbit = orbit.expect("an orbit").site;
        let beta = growth * distance;
        let thickness = thickness(
            &family.field(orbit.at),
            &orbit,
            8.0 / beta,
            2.0 * beta / -d.value,
        );
        (distance, -2.0 * beta / thickness)
    });
    let error = (limit(by_thickness) / d.value - 1.0).abs();
    assert!(error < 0.01, "{d:?}, {growth}, {by_thickness:?}, {error}");
}

/// The mean square distance from an orbit on the attractor around it, after so many rounds that begin with this square of a
/// distance.
fn thickness(field: &AnyField<'_>, orbit: &ContinuationPoint, rounds: f64, square: f64) -> f64 {
    /// Points of the orbit, and of the run.
    const POINTS: usize = 200;
    const SAMPLES: usize = 4000;
    let mut fine = Tracer::taylor(1e-12).expect("a tracer");
    let period = orbit.shooting.period();
    let mut x = orbit.shooting.nodes[0].clone();
    let mut circle = Vec::new();
    for _ in 0..POINTS {
        let next = fine.flow(field, &x, period / POINTS as f64, None);
        circle.push(std::mem::replace(&mut x, next.expect("a flow")));
    }
    x[0] += square.sqrt();
    let mut tracer = Tracer::taylor(1e-10).expect("a tracer");
    x = tracer
        .flow(field, &x, rounds * period, None)
        .expect("a run");
    let mut sum = 0.0;
    for _ in 0..SAMPLES {
        let distance = |p: &Vector| (&x - p).norm_squared();
        let nearest = circle
            .iter()
            .min_by(|a, b| distance(a).total_cmp(&distance(b)));
        let mut foot = nearest.expect("points").clone();
        for _ in 0..2 {
            let flow = field.f(&foot);
            let time = flow.dot(&(&x - &foot)) / flow.norm_squared();
            foot = fine.flow(field, &foot, time, None).expect("a flow");
        }
        sum += distance(&foot);
        x = tracer.flow(field, &x, 0.618 * period, None).expect("a run");
    }
    sum / SAMPLES as f64
}

#[test]
fn forms_are_refused_where_there_are_none() {
    let family = OverParameters::both(VanDerPol);
    let flat = settled(&family, [1.0, 0.0], &[2.0, 0.0], 6.66);
    for form in [Form::Doubling, Form::Torus, Form::Pitchfork] {
        let refused = normal_form(&family, &flat, form).unwrap_err();
        assert!(
            matches!(refused, Error::Dimension { dimension: 2, .. }),
            "{refused}"
        );
    }
    let family = OverParameters::<_, 4, 2>::both(Among(Roessler { b: 0.2 }));
    assert!(normal_form(&family, &flat, Form::Torus).is_err());
    let mut corrector = Corrector::new(&family, 1e-13).expect("a corrector");
    let site = roessler(&mut corrector);
    let refused = normal_form(&family, &site, Form::Pitchfork).unwrap_err();
    assert!(
        matches!(refused, Error::Dimension { dimension: 4, .. }),
        "{refused}"
    );
    // What does not bifurcate goes no way.
    for form in [Form::Doubling, Form::Torus] {
        goes_no_way(&family, &site, form);
    }
    let family = OverParameters::<_, 3, 2>::both(Among(Roessler { b: 0.2 }));
    let mut corrector = Corrector::new(&family, 1e-13).expect("a corrector");
    let site = roessler(&mut corrector);
    for form in [Form::Doubling, Form::Torus] {
        goes_no_way(&family, &site, form);
    }
    let at = [10.0_f64.ln(), 0.14_f64.ln()];
    let family = two_interfaces();
    let slab = family.slab(at);
    let query = Query {
        symmetry: Symmetry::Symmetric,
        begin: InitialGuess::Anywhere,
    };
    let orbit = find(&slab, &query, &OrbitAccuracy::of(Choice::Taylor)).expect("an orbit");
    let nodes = orbit
        .orbit
        .nodes
        .into_iter()
        .map(|x| Vector::from_vec(vec![x[0], x[1], x[1]]));
    let shooting = ShootingNodes {
        nodes: nodes.collect(),
        durations: orbit.orbit.durations,
    };
    goes_no_way(
        &family,
        &ContinuationPoint { shooting, at },
        Form::Pitchfork,
    );
}

fn goes_no_way(family: &dyn ParametrisedField, site: &ContinuationPoint, form: Form) {
    let (coefficient, criticality) = normal_form(family, site, form).expect("a form");
    assert_eq!(criticality, Criticality::Undecided, "{form:?}");
    assert!(coefficient.uncertainty.is_infinite(), "{form:?}");
}

/// Over (ln V_H, ln K).
fn two_interfaces() -> OverLoadings {
    let slab = InterfaceSystem {
        law: AnyLaw::Spinodal(Parameters::heslot_1994().spinodal()),
        interfaces: 2,
        loading: Loading::new(1.0, 1.0).expect("positive"),
    };
    OverLoadings::new(slab, Symmetry::Asymmetric)
}
