//! Return maps: landings, regimes of the paper's runs, rotation numbers against Floquet theory, what is never said wrongly.

use crate::command;
use crate::common as shared;
use nalgebra::{Complex, DMatrix};
use std::f64::consts::TAU;
use twinslip::Error;
use twinslip::field::State;
use twinslip::friction::{AnyLaw, Parameters};
use twinslip::integrate::{Choice, Control, Integrator, MAX_STEPS, Taylor, Tolerances};
use twinslip::model::{Driven, Loading, two_interfaces};
use twinslip::number::polynomial::Crossing;
use twinslip::section::{
    Ended, Periodic, Regime, RegimeVerdict, ReturnRecord, Surface, Watching, half_driving_stress,
    invariant_curve, record, regularity, return_map, spectrum, verdict, weighted_mean,
};

fn spinodal() -> AnyLaw {
    AnyLaw::Spinodal(Parameters::heslot_1994().spinodal())
}

/// Two interfaces with the paper's section.
struct Case {
    field: Box<dyn Driven<3>>,
    surface: Surface<3>,
    law: AnyLaw,
    v: f64,
}

impl Case {
    fn new(law: AnyLaw, k: f64, v: f64) -> Self {
        Case {
            field: two_interfaces(law, Loading::new(v, k).unwrap()),
            surface: Surface::stress(half_driving_stress(&law, v, 2), Crossing::Downwards),
            law,
            v,
        }
    }

    fn paper(k: f64, v: f64) -> Self {
        Self::new(spinodal(), k, v)
    }

    /// psi_2 off the symmetric steady state by exp(asymmetry).
    fn near_symmetric(&self, asymmetry: f64) -> State<3> {
        use twinslip::friction::Law;
        let w = self.law.steady_state(0.5 * self.v).ln();
        State::<3>::new(self.surface.offset, w, w + asymmetry)
    }

    fn record(
        &self,
        method: &str,
        rtol: f64,
        start: State<3>,
        count: (usize, usize),
    ) -> ReturnRecord<3> {
        let watching = Watching {
            skip: count.0,
            returns: count.1,
            patience: 2e4,
            accuracy: rtol,
            waypoints: true,
        };
        let mut integrator = Choice::named(method)
            .unwrap()
            .integrator::<3>(Tolerances::equal(rtol).unwrap(), MAX_STEPS)
            .unwrap();
        let see = &mut |_: usize, _: Option<&_>| Control::Continue;
        record(
            &mut *integrator,
            &*self.field,
            &start,
            &self.surface,
            &watching,
            see,
        )
    }

    fn verdict(&self, record: &ReturnRecord<3>) -> RegimeVerdict<3> {
        verdict(&*self.field, &self.surface, record, None).unwrap()
    }

    fn periodic(&self, record: &ReturnRecord<3>) -> Periodic<3> {
        let verdict = self.verdict(record);
        verdict
            .periodic
            .clone()
            .unwrap_or_else(|| panic!("{verdict:?}"))
    }

    /// The fixed point of the map near a state, stable or not, by Newton's method on (ln psi_1, ln psi_2), and its multipliers.
    fn fixed_point(&self, near: State<3>) -> (State<3>, [Complex<f64>; 2]) {
        let mut taylor = Taylor::new(Tolerances::equal(1e-13).unwrap(), MAX_STEPS).unwrap();
        let mut y = near;
        y[0] = self.surface.offset;
        for _ in 0..30 {
            let to = return_map(&*self.field, &self.surface, &mut taylor, &y, 2e4).unwrap();
            let d = DMatrix::from_fn(2, 2, |i, j| to.derivative[(i + 1, j + 1)]);
            let r = DMatrix::from_fn(2, 1, |i, _| to.state[i + 1] - y[i + 1]);
            let step = (DMatrix::identity(2, 2) - &d).lu().solve(&r).unwrap();
            (y[1], y[2]) = (y[1] + step[0], y[2] + step[1]);
            if step.amax() < 1e-11 {
                let mu = d.complex_eigenvalues();
                return (y, [mu[0], mu[1]]);
            }
        }
        panic!("no fixed point near {near}");
    }
}

/// At K = 0.14 the orbit that is born at the Hopf point of the asymmetric equilibria, followed from V_H = 0.07, where it
/// attracts everything; and its multipliers.
fn orbit_beyond_hopf(v: f64) -> (State<3>, [Complex<f64>; 2]) {
    let case = Case::paper(0.14, 0.07);
    let record = case.record("auto", 1e-10, case.near_symmetric(0.01), (200, 60));
    let mut point = case.periodic(&record).point;
    for i in 1..10 {
        let case = Case::paper(0.14, 0.07 + (v - 0.07) * f64::from(i) / 10.0);
        point = case.fixed_point(point).0;
    }
    let case = Case::paper(0.14, v);
    case.fixed_point(point)
}

fn mean(record: &ReturnRecord<3>) -> State<3> {
    record.returns.iter().map(|r| r.state).sum::<State<3>>() / record.returns.len() as f64
}

/// Every crossing is found and landed on, whatever the method: their number is that of the sign changes on a fine grid.
#[test]
fn landings_are_on_the_section_and_none_is_missed() {
    let case = Case::paper(0.14, 10.0);
    let start = case.near_symmetric(0.01);
    let exact = case.record("taylor", 1e-13, start, (0, 60));
    for point in &exact.returns {
        assert!((point.state[0] - case.surface.offset).abs() < 4e-15 * case.surface.offset);
        assert!(case.field.f(&point.state)[0] < 0.0, "not downwards");
    }
    let end = exact.returns.last().unwrap().time;
    let mut taylor = Taylor::new(Tolerances::equal(1e-13).unwrap(), MAX_STEPS).unwrap();
    let (mut before, mut falls) = (1.0, 0);
    let mut count = |step: &twinslip::integrate::Step<'_, 3>| {
        for part in 1..=50 {
            let t = step.t0 + (step.t1 - step.t0) * f64::from(part) / 50.0;
            let height = (step.dense)(t)[0] - case.surface.offset;
            falls += usize::from(before > 0.0 && height < 0.0 && t <= end + 1e-6);
            before = height;
        }
        Ok(Control::Continue)
    };
    taylor
        .flow(&*case.field, (0.0, end + 0.1), &start, Some(&mut count))
        .unwrap();
    assert_eq!(falls, exact.returns.len());
    for method in ["auto", "rodas5p", "rodas4"] {
        let other = case.record(method, 1e-9, start, (0, 60));
        assert_eq!(other.returns.len(), exact.returns.len());
        for (a, b) in other.returns.iter().zip(&exact.returns) {
            assert!(
                (a.time - b.time).abs() < 1e-4,
                "{method}: {} {}",
                a.time,
                b.time
            );
        }
    }
}

/// The derivative of the map against differences.
#[test]
fn the_map_has_the_derivative_that_it_says() {
    let case = Case::paper(0.2, 0.102);
    let mut taylor = Taylor::new(Tolerances::equal(1e-15).unwrap(), MAX_STEPS).unwrap();
    let y = State::<3>::new(case.surface.offset, -3.6, -2.1);
    let mut map =
        |y: &State<3>| return_map(&*case.field, &case.surface, &mut taylor, y, 2e4).unwrap();
    let here = map(&y);
    const STEP: f64 = 1e-5;
    for j in 1..3 {
        let mut e = State::<3>::zeros();
        e[j] = STEP;
        let difference = (map(&(y + e)).state - map(&(y - e)).state) / (2.0 * STEP);
        for i in 1..3 {
            let apart = (difference[i] - here.derivative[(i, j)]).abs();
            assert!(
                apart < 1e-6 * here.derivative.amax(),
                "d{i}/d{j}: {apart:e}"
            );
        }
    }
}

/// K = 0.2, V_H = 0.102, the paper's Fig. 13: an invariant circle around the orbit that has lost its stability. Where it is
/// born the rotation number is the angle of the multipliers over 2 pi; it departs from that as the square of the circle's
/// radius, which is as the distance in V_H.
#[test]
fn the_torus_turns_as_floquet_theory_says() {
    let settled = |v: f64, skip: usize| {
        let case = Case::paper(0.2, v);
        let record = case.record("auto", 1e-11, case.near_symmetric(0.3), (skip, 1000));
        let made = case.verdict(&record);
        assert_eq!(made.regime, Regime::Torus, "{v}: {made:?}");
        let rotation = made.curve.unwrap().rotation;
        assert!(rotation.uncertainty < 1e-6, "{rotation:?}");
        let (point, mu) = case.fixed_point(mean(&record));
        assert!(mu[0].norm() > 1.0 && mu[0].im != 0.0, "{mu:?}");
        let angle = mu[0].arg().abs() / TAU;
        println!(
            "V_H = {v}: {rotation:?}, angle {angle}, modulus {}",
            mu[0].norm()
        );
        (point, (rotation.value - angle).abs())
    };
    let (point, whole) = settled(0.102, 2000);
    // The torus bifurcation, where the modulus is one.
    let (mut low, mut high) = (0.099, 0.102);
    for _ in 0..30 {
        let middle = 0.5 * (low + high);
        let (_, mu) = Case::paper(0.2, middle).fixed_point(point);
        if mu[0].norm() > 1.0 {
            high = middle;
        } else {
            low = middle;
        }
    }
    assert!(low > 0.0991 && high < 0.1019, "{low}");
    let departure = |part: f64| settled(high + part * (0.102 - high), 10_000).1;
    let (some, quarter_of_it) = (departure(0.2), departure(0.05));
    let ratio = some / quarter_of_it;
    println!("torus bifurcation at {low}, ratio {ratio}");
    assert!(
        whole < 1e-3 && (3.5..5.0).contains(&ratio),
        "{whole:e} {ratio}"
    );
}

/// At the torus bifurcation of K = 0.14 the derivative of the map has the multipliers of an independent computation.
#[test]
fn the_multipliers_at_a_torus_bifurcation() {
    let data = &shared::data("multipliers.json")["torus_bifurcation"];
    let (_, mu) = orbit_beyond_hopf(shared::number(&data["V_H"]));
    let (re, im) = shared::complex(&data["mu"][0]);
    assert!((mu[0].norm() - 1.0).abs() < 1e-9, "{mu:?}");
    assert!(
        (mu[0].re - re).abs() < 1e-8 && (mu[0].im.abs() - im.abs()).abs() < 1e-8,
        "{mu:?}"
    );
    let angle = mu[0].arg().abs() / (0.5 * TAU);
    assert!(
        (angle - shared::number(&data["theta/pi"])).abs() < 1e-8,
        "{angle}"
    );
}

/// With exponents a torus has two that vanish and one that does not.
#[test]
fn the_exponents_of_a_torus() {
    let case = Case::paper(0.2, 0.102);
    let record = case.record("auto", 1e-10, case.near_symmetric(0.3), (3000, 2000));
    let found = spectrum(&*case.field, &record).unwrap();
    assert!(found.converged);
    for x in &found.exponents[..2] {
        assert!(
            x.value.abs() <= x.uncertainty && x.uncertainty < 1e-5,
            "{x:?}"
        );
    }
    assert!(found.exponents[2].value < -1e-4);
    let made = verdict(&*case.field, &case.surface, &record, Some(found.known())).unwrap();
    assert_eq!(made.regime, Regime::Torus, "{made:?}");
}

/// K = 0.14, V_H = 0.0765: before the torus bifurcation at 0.0767399 the orbit is stable, but runs from afar stay away: the
/// bifurcation looks subcritical, as in the paper's Fig. 16(a).
#[test]
fn beside_the_stable_orbit_there_is_another_attractor() {
    let case = Case::paper(0.14, 0.0765);
    let far = case.record("auto", 1e-10, case.near_symmetric(0.3), (1500, 400));
    let away = case.periodic(&far);
    assert!(away.returns > 1, "{away:?}");
    let (point, mu) = orbit_beyond_hopf(0.0765);
    assert!(mu[0].norm() < 1.0 && mu[0].im != 0.0, "{mu:?}");
    let near = case.record(
        "auto",
        1e-10,
        point + State::<3>::new(0.0, 1e-3, 0.0),
        (3000, 400),
    );
    let orbit = case.periodic(&near);
    assert_eq!(orbit.returns, 1);
    assert!((orbit.point - point).amax() < 1e-8, "{orbit:?}");
    assert!((orbit.multiplier - mu[0].norm()).abs() < 1e-6);
}

/// Fig. 16(b), K = 0.14 near the 1:4 resonance: three little loops and one long excursion, in turn. Another method finds the
/// same.
#[test]
fn the_fourfold_map_has_three_little_loops_and_one_excursion() {
    let case = Case::paper(0.14, 0.079);
    let start = case.near_symmetric(-0.01);
    let record = case.record("auto", 1e-10, start, (1000, 100));
    let found = case.periodic(&record);
    assert_eq!(found.returns, 4, "{found:?}");
    let last = &record.returns[record.returns.len() - 5..];
    let mut times: Vec<f64> = last
        .windows(2)
        .map(|pair| pair[1].time - pair[0].time)
        .collect();
    times.sort_by(f64::total_cmp);
    assert!(
        times[2] < 1.35 * times[0] && times[3] > 1.5 * times[2],
        "{times:?}"
    );
    let sum: f64 = times.iter().sum();
    assert!(
        (sum - found.period.value).abs() < 1e-5,
        "{sum} {:?}",
        found.period
    );
    let other = case.periodic(&case.record("rodas5p", 1e-9, start, (400, 60)));
    assert_eq!(other.returns, 4);
    assert!((other.period.value / found.period.value - 1.0).abs() < 1e-10);
}

/// K = 0.14: relaxation oscillations are period-1; strongly driven, the run comes to rest.
#[test]
fn relaxation_orbits_and_rest() {
    for (v, skip) in [(1.0, 100), (10.0, 400), (100.0, 8000)] {
        let case = Case::paper(0.14, v);
        let record = case.record("auto", 1e-10, case.near_symmetric(0.01), (skip, 60));
        assert_eq!(case.periodic(&record).returns, 1, "V_H = {v}");
    }
    let case = Case::paper(0.14, 1000.0);
    for start in [
        case.near_symmetric(0.01),
        State::<3>::new(10.0, 0.5_f64.ln(), 1e-3_f64.ln()),
    ] {
        let record = case.record("auto", 1e-9, start, (10, 1000));
        let Ended::Steady {
            equilibrium,
            stable,
            ..
        } = record.ended
        else {
            panic!("{:?}", record.ended);
        };
        assert!(stable && case.field.f(&equilibrium).amax() < 1e-4);
        assert_eq!(case.verdict(&record).regime, Regime::Steady);
    }
    // Just before the Hopf point the way to rest is a spiral too long to wait for: its rate says where it ends.
    let case = Case::paper(0.18, 0.07);
    let record = case.record("auto", 1e-9, case.near_symmetric(0.3), (10, 1000));
    assert!(
        matches!(record.ended, Ended::Steady { stable: true, .. }),
        "{:?}",
        record.ended
    );
}

/// Chaos: K = 0.14, V_H = 0.094, between the period-doubling points. Positive beyond its interval, by two unlike methods.
#[test]
fn chaos_has_a_positive_exponent() {
    let case = Case::paper(0.14, 0.094);
    for (method, rtol, returns) in [("auto", 1e-10, 6000), ("rodas5p", 1e-7, 1500)] {
        let record = case.record(method, rtol, case.near_symmetric(0.01), (500, returns));
        let found = spectrum(&*case.field, &record).unwrap();
        println!("{method}: {:?}", found.exponents);
        assert!(
            found.exponents[0].value > found.exponents[0].uncertainty,
            "{method}: {found:?}"
        );
        assert!(found.liouville_defect.abs() < 1e-6 && found.converged);
        let made = verdict(&*case.field, &case.surface, &record, Some(found.known())).unwrap();
        assert_eq!(made.regime, Regime::Chaotic, "{method}: {made:?}");
        assert_eq!(case.verdict(&record).regime, Regime::Undecided);
    }
}

/// Slip localises on one interface: the stress never comes back up. The error says where the run has been.
#[test]
fn a_run_that_does_not_return_says_where_it_stays() {
    let law = AnyLaw::DieterichRuina(Parameters::heslot_1994().dieterich_ruina());
    let case = Case::new(law, 0.45, 1.0);
    let start = State::<3>::new(10.85, 1.99_f64.ln(), 2.01_f64.ln());
    let record = case.record("auto", 1e-9, start, (10, 10));
    let Ended::Failed(Error::NoReturn {
        since,
        t,
        section,
        lowest,
        highest,
    }) = record.ended
    else {
        panic!("{:?}", record.ended);
    };
    assert_eq!(section, case.surface.offset);
    assert!(t - since >= 2e4 && lowest <= highest && highest < section);
}

/// Points of a rotation by known amounts, on an ellipse, bent, or on several curves.
#[test]
fn rotation_numbers_of_known_rotations() {
    let golden = 0.5 * (5.0_f64.sqrt() - 1.0);
    for turn in [
        golden,
        0.25 + 0.1 * golden,
        golden / 7.0,
        1.0 - golden / 3.0,
    ] {
        let points: Vec<[f64; 2]> = (0..1500)
            .map(|n| {
                let a = TAU * turn * f64::from(n);
                // Not a rotation, but conjugate to one.
                let a = a + 0.3 * a.sin();
                [
                    3.0 + a.cos(),
                    1e-3 * (a.sin() + 0.2 * (2.0 * a).cos()) - 2.0 * a.cos(),
                ]
            })
            .collect();
        assert!(
            regularity(&points) < 1e-7,
            "{turn}: {:e}",
            regularity(&points)
        );
        let curve = invariant_curve(&points).unwrap();
        let expected = turn.min(1.0 - turn);
        let apart = (curve.rotation.value - expected).abs();
        assert_eq!(curve.curves, 1);
        assert!(
            apart <= curve.rotation.uncertainty + 1e-12,
            "{turn}: {curve:?}"
        );
        assert!(apart < 1e-9, "{turn}: {apart:e}");
    }
    let three: Vec<[f64; 2]> = (0..1800)
        .map(|n| {
            let (a, b) = (
                TAU * golden * f64::from(n / 3),
                TAU * f64::from(n % 3) / 3.0,
            );
            [5.0 * b.cos() + a.cos(), 5.0 * b.sin() + a.sin()]
        })
        .collect();
    let curve = invariant_curve(&three).unwrap();
    assert_eq!(curve.curves, 3);
    assert!(
        (curve.rotation.value - (1.0 - golden)).abs() < 1e-9,
        "{curve:?}"
    );
}

/// The Henon map at its usual parameters is chaotic: no curve, no convergence of averages.
#[test]
fn chaos_is_no_curve() {
    let mut p = [0.1, 0.1];
    let points: Vec<[f64; 2]> = (0..4000)
        .map(|_| {
            p = [1.0 - 1.4 * p[0] * p[0] + p[1], 0.3 * p[0]];
            p
        })
        .collect();
    assert!(regularity(&points[100..]) > 1e-3);
    assert!(invariant_curve(&points[100..]).is_none());
    let first = weighted_mean(points.iter().map(|p| p[0]));
    assert!((first - 0.2569).abs() < 0.02, "{first}");
    assert_eq!(
        weighted_mean(std::iter::empty::<f64>().collect::<Vec<_>>().into_iter()),
        0.0
    );
}

/// A torus near a resonance almost repeats: that is not periodic. Ended early, a spiral into an orbit is.
#[test]
fn nearly_periodic_is_not_periodic() {
    let case = Case::paper(0.2, 0.102);
    let record = case.record("auto", 1e-10, case.near_symmetric(0.3), (4000, 900));
    let made = case.verdict(&record);
    assert!(made.periodic.is_none(), "{made:?}");
    // Returns of K = 0.14, V_H = 0.0765 that still spiral: multipliers of modulus 0.997.
    let case = Case::paper(0.14, 0.0765);
    let (point, mu) = orbit_beyond_hopf(0.0765);
    assert!(mu[0].norm() > 0.98 && mu[0].norm() < 1.0, "{mu:?}");
    let spiral = case.record(
        "auto",
        1e-10,
        point + State::<3>::new(0.0, 2e-3, 0.0),
        (0, 400),
    );
    assert_eq!(case.periodic(&spiral).returns, 1);
}

/// A run that leaves an equilibrium just beyond its Hopf point, so slowly that its exponent is positive all the while.
#[test]
fn a_slow_passage_is_not_chaos() {
    let ended = command::twinslip(
        "section --driving 0.08615384615384616 --stiffness 0.23517241379310346 --start near-symmetric:0.01 --surface stress=11.4455 --skip 20 --returns 600 --lyapunov --format json -q",
    );
    assert_eq!(ended.code, 3, "{}", ended.err);
    let made: serde_json::Value = serde_json::from_str(&ended.out).expect("JSON");
    let largest = command::number(&made, "/result/lyapunov/0/value");
    let bound = command::number(&made, "/result/lyapunov/0/uncertainty");
    assert!(largest > bound, "{largest} +- {bound}");
    assert_eq!(made["result"]["regime"], "undecided");
}

fn exponents(found: &serde_json::Value) -> Vec<(f64, f64)> {
    let all = found["result"]["lyapunov"].as_array().expect("exponents");
    let pair = |x: &serde_json::Value| {
        let number = |name: &str| x[name].as_f64().expect("a number");
        (number("value"), number("uncertainty"))
    };
    all.iter().map(pair).collect()
}

/// Methods and tolerances whose errors differ by orders.
fn numerics() -> Vec<&'static str> {
    let mut all = vec!["", "--rtol 1e-4", "--method rodas5p --rtol 1e-6"];
    if cfg!(feature = "sundials") {
        all.push("--method cvode-bdf");
    }
    all
}

/// ln |mu| / T by the multipliers of an independent computation, whatever the run was made with.
#[test]
fn exponents_of_periodic_orbits_are_those_of_their_multipliers() {
    let data = shared::data("multipliers.json");
    for orbit in data["orbits"].as_array().unwrap() {
        let at = |name: &str| shared::number(&orbit[name]);
        let text = |name: &str| orbit[name].as_str().unwrap().to_owned();
        let period = at("period");
        for numerics in numerics() {
            let words = format!(
                "section --driving {} --stiffness {} --start {},{},{} --skip 20 --returns 60 --lyapunov {numerics}",
                text("V_H"),
                text("K"),
                text("section tau_s"),
                text("psi1"),
                text("psi2")
            );
            let found = command::object(&words);
            assert_eq!(found["result"]["regime"], "periodic", "{words}");
            let all = exponents(&found);
            assert_eq!(all[0], (0.0, 0.0), "{words}");
            for (i, (value, uncertainty)) in all[1..].iter().enumerate() {
                let (re, im) = shared::complex(&orbit["mu"][i]);
                let off = (value - re.hypot(im).ln() / period).abs();
                assert!(off <= *uncertainty, "{words}: {value} is off by {off:e}");
                assert!(uncertainty * period < 1e-7, "{words}: {uncertainty:e}");
            }
        }
    }
    // An orbit of three returns; the third exponent by multiple shooting at 31 digits.
    for numerics in numerics() {
        let words = format!("section --driving 0.08433 --stiffness 0.14617 --lyapunov {numerics}");
        let (value, uncertainty) = exponents(&command::object(&words))[2];
        let off = (value + 0.002_595_534_446_2).abs();
        assert!(off < uncertainty + 5e-14, "{words}: {value}");
        assert!(uncertainty < 1e-11, "{words}: {uncertainty:e}");
    }
}

/// The error of the method would be a bias, the same at every return: two exponents of a torus vanish, and the third is that of
/// a long and accurate run.
#[test]
fn the_exponents_of_a_torus_have_no_bias() {
    for (v, k) in [(0.11, 0.185), (0.104, 0.2)] {
        let run =
            format!("section --driving {v} --stiffness {k} --start near-symmetric:0.3 --lyapunov");
        let long = exponents(&command::object(&format!(
            "{run} --returns 5000 --rtol 1e-12"
        )))[2];
        for numerics in numerics() {
            let words = format!("{run} --skip 2000 --returns 2000 {numerics}");
            let ended = command::twinslip(&format!("{words} --format json -q"));
            let found: serde_json::Value = serde_json::from_str(&ended.out).expect("JSON");
            let regime = found["result"]["regime"].as_str().expect("a regime");
            // The returns of a coarse run may be too rough to tell, but never tell anything else.
            let coarse = numerics.contains("1e-4") && regime == "undecided";
            assert!(regime == "torus" || coarse, "{words}: {found}");
            let all = exponents(&found);
            for (value, uncertainty) in &all[..2] {
                assert!(value.abs() <= *uncertainty, "{words}: {all:?}");
            }
            let (value, uncertainty) = all[2];
            let off = (value - long.0).abs();
            assert!(off <= uncertainty + long.1, "{words}: {all:?}, {long:?}");
            assert!(uncertainty < 0.05 * value.abs(), "{words}: {all:?}");
        }
    }
}

/// Along a record that is made coarsely the bias is seen in the direction of the flow, and counted.
#[test]
fn the_bias_of_a_coarse_record_is_counted() {
    let case = Case::paper(0.2, 0.102);
    let start = case.near_symmetric(0.3);
    let of = |rtol: f64| {
        let record = case.record("taylor", rtol, start, (3000, 2000));
        spectrum(&*case.field, &record).unwrap()
    };
    let (coarse, fine) = (of(1e-4), of(1e-12));
    for (coarse, fine) in coarse.exponents.iter().zip(&fine.exponents) {
        let off = (coarse.value - fine.value).abs();
        assert!(
            off <= coarse.uncertainty + fine.uncertainty,
            "{coarse:?} {fine:?}"
        );
    }
    let flow = coarse
        .exponents
        .iter()
        .find(|x| x.value == coarse.along_flow);
    assert!(flow.is_some_and(|x| x.value.abs() <= x.uncertainty));
}

/// Returns that are made up, about the orbit inside a torus: each so far from it, at the angle of its number.
fn made_up(accuracy: f64, at: impl Fn(f64) -> [f64; 2]) -> (Case, ReturnRecord<3>) {
    let case = Case::paper(0.2, 0.102);
    let settled = case.record("auto", 1e-10, case.near_symmetric(0.3), (1000, 300));
    let centre = case.fixed_point(mean(&settled)).0;
    let returns = (0..600).map(|n| {
        let [x, y] = at(f64::from(n));
        twinslip::section::Return {
            time: 60.0 * f64::from(n),
            state: centre + State::<3>::new(0.0, x, y),
        }
    });
    let record = ReturnRecord {
        returns: returns.collect(),
        waypoints: Vec::new(),
        ended: Ended::Complete,
        accuracy,
    };
    (case, record)
}

/// Five points in turn that drift by less than the error of the run are no torus, though they never repeat to the last digit.
#[test]
fn returns_that_repeat_to_the_error_of_the_run_are_no_torus() {
    let turning = |rotation: f64| {
        move |n: f64| {
            let (sin, cos) = (TAU * rotation * n).sin_cos();
            [1e-2 * cos, 1e-2 * sin]
        }
    };
    let (case, drifting) = made_up(1e-8, turning(0.2 + 1e-9));
    let made = case.verdict(&drifting);
    assert_eq!(made.regime, Regime::Undecided, "{made:?}");
    assert!(
        made.why.is_some_and(|why| why.contains("repeat")),
        "{made:?}"
    );
    // The same circle is one where they don't.
    let (case, winding) = made_up(1e-8, turning(0.2 + 1e-3 * 2.0_f64.sqrt()));
    let made = case.verdict(&winding);
    assert_eq!(made.regime, Regime::Torus, "{made:?}");
}

/// A figure of eight has no order that could be seen: there only exponents that are known to vanish tell a torus.
#[test]
fn exponents_that_are_hardly_known_make_no_torus() {
    use twinslip::number::Uncertain;
    use twinslip::section::Exponents;
    let eight = |n: f64| {
        let angle = TAU * 0.381_966_011_250_105 * n;
        [1e-2 * angle.cos(), 1e-2 * (2.0 * angle).sin()]
    };
    let (case, record) = made_up(1e-10, eight);
    assert_eq!(case.verdict(&record).regime, Regime::Undecided);
    let duration = record.returns[599].time;
    let with = |uncertainty: f64| {
        let zero = Uncertain::new(0.0, uncertainty);
        let values = [zero, zero, Uncertain::new(-1e-3, 1e-6)];
        let known = Exponents {
            values: &values,
            converged: true,
        };
        let made = verdict(&*case.field, &case.surface, &record, Some(known)).unwrap();
        made.regime
    };
    assert_eq!(with(0.05 / duration), Regime::Torus);
    assert_eq!(with(1.0 / duration), Regime::Undecided);
}
