//! Periodic orbits, multipliers and bifurcations of systems of four, six and twelve equations.

use crate::common::among::{Among, langford, roessler};
use crate::common::branches::first;
use crate::common::{data, number};
use serde_json::Value;
use std::f64::consts::{PI, TAU};
use std::ops::ControlFlow::Continue;
use twinslip::bifurcation::Label;
use twinslip::bifurcation::equilibria::generic::{FieldEquilibria, FoundEquilibrium, Onward};
use twinslip::continuation::{Met, Settings};
use twinslip::field::Vector;
use twinslip::integrate::AnyField;
use twinslip::model::Smooth;
use twinslip::model::classics::{Langford, Roessler};
use twinslip::number::{Real, Uncertain};
use twinslip::orbit::{
    Closed, Condition, ContinuationPoint, Corrector, Floquet, Kind, Multiplier, OverParameters,
    Palc, PalcSettings, ParametrisedField, ShootingNodes, TestFunction, Tracer, close, floquet,
};
use twinslip::series::Equations;

/// Two van der Pol oscillators, drawn together, in (mu, k); the second one's frequency squared.
#[derive(Debug, Clone, Copy)]
struct Pair {
    squared: f64,
}

impl Equations<4, 2> for Pair {
    const PARAMETERS: [&'static str; 2] = ["mu", "k"];

    fn rates<T: Real>(&self, [x1, y1, x2, y2]: [T; 4], [mu, k]: [T; 2]) -> [T; 4] {
        let one = T::constant(1.0);
        [
            y1,
            mu * (one - x1 * x1) * y1 - x1 + k * (x2 - x1),
            y2,
            mu * (one - x2 * x2) * y2 - x2 * self.squared + k * (x1 - x2),
        ]
    }
}

fn numbers(list: &Value) -> Vec<f64> {
    list.as_array()
        .expect("a list")
        .iter()
        .map(number)
        .collect()
}

/// The orbit through a point, closed, its period and its multipliers: the budgets as they are made of a slab's orbit, of the noise
/// and of a second solution on other nodes.
fn solved(field: &AnyField<'_>, point: &[f64], period: f64) -> (Closed, Uncertain, Floquet) {
    let start = Vector::from_column_slice(point);
    let (closed, mut multipliers) = once(field, &start, period, 1e-15);
    let elsewhere = Tracer::taylor(1e-15)
        .expect("a tracer")
        .flow(field, &start, 0.037 * period, None)
        .expect("a run");
    let (other, its) = once(field, &elsewhere, period, 8e-15);
    multipliers.widened_by(&its);
    let (mut period, _) = closed.budget(false);
    period.uncertainty += 2.0 * (period.value - other.shooting.period()).abs();
    (closed, period, multipliers)
}

fn once(field: &AnyField<'_>, start: &Vector, period: f64, tolerance: f64) -> (Closed, Floquet) {
    let mut tracer = Tracer::taylor(tolerance).expect("a tracer");
    let shooting = ShootingNodes::along(&mut tracer, field, start, period).expect("a shooting");
    let mut loss = |x: &Vector, duration: f64| {
        let mut tracer = Tracer::taylor(tolerance)?;
        let arc = tracer.arc(field, x, duration, &[])?;
        let loss = arc.loss();
        Ok((arc.end, loss))
    };
    let shooting = shooting.refined(&mut loss).expect("finer nodes");
    let closed = close(&mut tracer, field, shooting).expect("an orbit");
    let multipliers = floquet(&closed, field);
    (closed, multipliers)
}

/// The multipliers, each with those of a record that it is: ln |mu| and the angle, which it has within a bar.
fn matched(
    record: &Value,
    dimension: usize,
    floquet: &Floquet,
    bar: f64,
) -> Vec<(Multiplier, f64)> {
    assert_eq!(floquet.multipliers.len(), dimension - 1);
    assert!(floquet.trivial_defect < 1e-10, "{floquet:?}");
    let defect = floquet.liouville_defect.expect("the trace");
    assert!(defect.abs() < 1e-10, "{floquet:?}");
    let mut left = floquet.multipliers.clone();
    let known = record["values"]["multipliers"].as_array();
    let known = known.expect("multipliers").iter().map(|one| {
        let (ln_abs, arg) = (number(&one["ln_abs"]), number(&one["arg"]).abs());
        let off =
            |m: &Multiplier| (m.ln_abs.value - ln_abs).abs() + (PI * m.angle_over_pi - arg).abs();
        let nearest = (0..left.len())
            .min_by(|&i, &j| off(&left[i]).total_cmp(&off(&left[j])))
            .expect("as many");
        let found = left.swap_remove(nearest);
        let complex = arg > 1e-6 && PI - arg > 1e-6;
        assert_eq!(found.kind == Kind::Complex, complex, "{one}: {found:?}");
        assert!(off(&found) < bar, "{one}: {found:?}");
        (found, ln_abs)
    });
    known.collect()
}

/// Of a record: the period and all multipliers, within their budgets, and the budgets within a bar.
fn assert_as_known(record: &Value, (closed, period, floquet): (Closed, Uncertain, Floquet)) {
    let error = (period.value - number(&record["values"]["period"])).abs();
    assert!(error <= period.uncertainty, "{period:?}, {error:e}");
    assert!(error < 1e-12 * period.value, "{period:?}, {error:e}");
    for (found, ln_abs) in matched(record, closed.shooting.dimension(), &floquet, 1e-9) {
        let error = (found.ln_abs.value - ln_abs).abs();
        assert!(error <= found.ln_abs.uncertainty, "{found:?}, {ln_abs}");
        assert!(found.ln_abs.uncertainty < 1e-10, "{found:?}");
    }
}

#[test]
fn locked_oscillators_have_the_multipliers_of_forty_digits() {
    let all = data("foreign_orbits.json");
    for name in [
        "1a_two_coupled_vdp_antiphase_k0.2",
        "1b_two_coupled_vdp_antiphase_k0.5",
        "1c_two_coupled_vdp_inphase_k0.5",
        "1d_two_coupled_vdp_symmetric_mu5",
    ] {
        let record = &all["records"][name];
        let [mu, squared, k] = ["mu", "w2", "k"].map(|p| number(&record["parameters"][p]));
        let field = Smooth {
            equations: Pair { squared },
            parameters: [mu, k],
        };
        let point = numbers(&record["values"]["point"]);
        let period = number(&record["values"]["period"]);
        // From a point and a period of four digits.
        let rough = |x: f64| (x * 1e4).round() / 1e4;
        let point: Vec<_> = point.into_iter().map(rough).collect();
        let field = AnyField::of::<4>(&field);
        assert_as_known(record, solved(&field, &point, rough(period)));
    }
}

fn torus_among_others<const N: usize>() {
    let family = OverParameters::<_, N, 2>::both(Among(Langford { omega: 3.5 }));
    let mut corrector = Corrector::new(&family, 1e-13).expect("a corrector");
    let site = langford::<N>(0.3);
    let torus = first(&mut corrector, site, (0, 1.5), TestFunction::Torus).expect("a torus");
    let error = (torus.at[0] / Langford::torus() - 1.0).abs();
    assert!(error < 1e-10, "{N}: {error:e}");
    // The pair that leaves: e^(+-i k r T), k = sqrt(2 (1 + 0.7 rho)).
    let here = corrector.look(torus.clone(), &[0], &[]).expect("an orbit");
    let floquet = here.floquet(&family.field(torus.at));
    let rho = Langford::torus();
    let frequency = (2.0 * (1.0 + 0.7 * rho)).sqrt() * Langford::radius(rho);
    let angle = (frequency * torus.shooting.period()).rem_euclid(TAU);
    let angle = angle.min(TAU - angle) / PI;
    let pair = &floquet.multipliers[..2];
    for one in pair {
        assert!(one.ln_abs.value.abs() < 1e-9, "{N}: {pair:?}");
        assert!(
            (one.angle_over_pi - angle).abs() < 1e-9,
            "{N}: {pair:?}, {angle}"
        );
    }
}

#[test]
fn a_torus_is_shed_where_it_is_in_three_dimensions() {
    torus_among_others::<4>();
    torus_among_others::<6>();
    torus_among_others::<12>();
}

fn doublings<const N: usize>(expected: &[(f64, f64)]) {
    let family = OverParameters::<_, N, 2>::both(Among(Roessler { b: 0.2 }));
    let mut corrector = Corrector::new(&family, 1e-13).expect("a corrector");
    let mut site = roessler(&mut corrector);
    for (i, &(c, period)) in expected.iter().enumerate() {
        let doubling = first(&mut corrector, site, (1, 5.0), TestFunction::Doubling);
        let doubling = doubling.expect("a doubling");
        let error = (doubling.at[1] / c - 1.0).abs();
        assert!(error < 1e-10, "{N}, {i}: {}, {error:e}", doubling.at[1]);
        let error = (doubling.shooting.period() / period - 1.0).abs();
        assert!(error < 1e-10, "{N}, {i}: {error:e}");
        let meets = [Condition::TestFunction(TestFunction::Doubling)];
        let here = corrector.look(doubling, &[1], &meets).expect("an orbit");
        let (twice, direction) = here.doubled().expect("a multiplier -1");
        let settings = PalcSettings::branch(1, 0.3);
        let begun = Palc::from(
            &mut corrector,
            settings,
            twice.moved(&direction, 0.05),
            direction,
        );
        site = begun.expect("onto the doubled branch").now.here.site;
    }
}

/// Along a curve of bifurcations from one of them: the parameters of so many orbits.
fn curve(
    corrector: &mut Corrector<'_>,
    site: ContinuationPoint,
    test_function: TestFunction,
    (most, growing): (usize, usize),
) -> Vec<[f64; 2]> {
    let settings = PalcSettings::locus(test_function, 0.1);
    let meets = [Condition::TestFunction(test_function)];
    let here = corrector.look(site, &[0, 1], &meets).expect("an orbit");
    let any = here.along[0].clone();
    let direction = settings.direction(&here, &any).expect("a direction");
    let sign = direction.parameters[growing].signum();
    let begun = Palc::from(corrector, settings, here.site, direction.scaled(sign));
    let mut palc = begun.expect("a continuation");
    let mut passed = Vec::new();
    palc.follow(&[], most, &mut |_, _, met| {
        if let Met::Point(point) = met {
            passed.push(point.here.site.at);
        }
        Continue(())
    })
    .expect("a curve");
    passed
}

/// In three dimensions the test functions are others, of the return map's trace and determinant.
#[test]
fn curves_of_tori_and_doublings_are_those_of_three_dimensions() {
    fn tori<const N: usize>() -> Vec<[f64; 2]> {
        let family = OverParameters::<_, N, 2>::both(Among(Langford { omega: 3.5 }));
        let mut corrector = Corrector::new(&family, 1e-14).expect("a corrector");
        let site = langford::<N>(0.3);
        let torus = first(&mut corrector, site, (0, 1.5), TestFunction::Torus);
        let torus = torus.expect("a torus");
        curve(&mut corrector, torus, TestFunction::Torus, (12, 1))
    }
    fn doublings<const N: usize>() -> Vec<[f64; 2]> {
        let family = OverParameters::<_, N, 2>::both(Among(Roessler { b: 0.2 }));
        let mut corrector = Corrector::new(&family, 1e-14).expect("a corrector");
        let site = roessler(&mut corrector);
        let doubling = first(&mut corrector, site, (1, 5.0), TestFunction::Doubling);
        let doubling = doubling.expect("a doubling");
        curve(&mut corrector, doubling, TestFunction::Doubling, (12, 0))
    }
    /// The second parameter's value at the first one's, by the polynomial through the four nearest points.
    fn at(curve: &[[f64; 2]], (of, value): (usize, f64)) -> f64 {
        let mut near = curve.to_vec();
        near.sort_by(|a, b| (a[of] - value).abs().total_cmp(&(b[of] - value).abs()));
        let near = &near[..6];
        near.iter()
            .map(|p| {
                let others = near.iter().filter(|q| q[of] != p[of]);
                let basis = others.map(|q| (value - q[of]) / (p[of] - q[of]));
                p[1 - of] * basis.product::<f64>()
            })
            .sum()
    }
    for (three, four, of) in [
        (tori::<3>(), tori::<4>(), 1),
        (doublings::<3>(), doublings::<4>(), 0),
    ] {
        assert_eq!((three.len(), four.len()), (12, 12));
        let ends = [&three, &four].map(|curve| curve[11][of]);
        assert!(
            ends.iter().all(|end| (end - three[0][of]).abs() > 0.02),
            "{ends:?}"
        );
        for p in &four[2..8] {
            let error = (at(&three, (of, p[of])) / p[1 - of] - 1.0).abs();
            assert!(error < 1e-6, "{p:?}, {error:e}");
        }
    }
}

#[test]
fn roesslers_cascade_in_three_four_and_twelve_dimensions() {
    let all = data("foreign_orbits.json");
    let expected = ["2_roessler_PD1", "2_roessler_PD2", "2_roessler_PD3"].map(|name| {
        let values = &all["records"][name]["values"];
        (number(&values["c"]), number(&values["period"]))
    });
    doublings::<3>(&expected);
    doublings::<4>(&expected[..2]);
    doublings::<12>(&expected[..1]);
}

/// A ring: x_i' = (x_{i+1} - x_{i-2}) x_{i-1} - x_i + F, in (F, nothing). Lorenz, E. N. (1996). Predictability - a problem partly
/// solved. Proc. Seminar on Predictability, ECMWF, 1-18.
#[derive(Debug, Clone, Copy)]
struct Ring;

impl<const N: usize> Equations<N, 2> for Ring {
    const PARAMETERS: [&'static str; 2] = ["force", "unused"];

    fn rates<T: Real>(&self, x: [T; N], [force, _]: [T; 2]) -> [T; N] {
        let at = |i: usize| x[i % N];
        std::array::from_fn(|i| (at(i + 1) - at(i + N - 2)) * at(i + N - 1) - x[i] + force)
    }
}

fn wave(record: &Value, force: f64) -> (Closed, Uncertain, Floquet) {
    let values = &record["values"];
    let field = Smooth {
        equations: Ring,
        parameters: [force, 0.0],
    };
    solved(
        &AnyField::of::<6>(&field),
        &numbers(&values["point"]),
        number(&values["period"]),
    )
}

#[test]
fn waves_around_a_ring_of_six_have_five_multipliers_and_shed_a_torus() {
    let all = data("foreign_orbits.json");
    for (name, force) in [("4a_lorenz96_N6_F2", 2.0), ("4b_lorenz96_N6_F4", 4.0)] {
        let record = &all["records"][name];
        assert_as_known(record, wave(record, force));
    }
    let (closed, ..) = wave(&all["records"]["4b_lorenz96_N6_F4"], 4.0);
    let family = OverParameters::<_, 6, 2>::both(Ring);
    let mut corrector = Corrector::new(&family, 1e-14).expect("a corrector");
    let site = ContinuationPoint {
        shooting: closed.shooting,
        at: [4.0, 0.0],
    };
    let torus = first(&mut corrector, site, (0, 7.0), TestFunction::Torus).expect("a torus");
    let record = &all["records"]["4c_lorenz96_N6_neimark_sacker"];
    let force = number(&record["parameters"]["F"]);
    let error = (torus.at[0] / force - 1.0).abs();
    assert!(error < 1e-11, "{}, {error:e}", torus.at[0]);
    let period = number(&record["values"]["period"]);
    let error = (torus.shooting.period() / period - 1.0).abs();
    assert!(error < 1e-11, "{error:e}");
    let here = corrector.look(torus, &[0], &[]).expect("an orbit");
    let field = Smooth {
        equations: Ring,
        parameters: [force, 0.0],
    };
    let floquet = here.floquet(&AnyField::of::<6>(&field));
    let pair = floquet.multipliers[0];
    let angle = number(&record["values"]["multipliers"][0]["arg"]).abs() / PI;
    assert!(
        pair.kind == Kind::Complex && pair.ln_abs.value.abs() < 1e-10,
        "{pair:?}"
    );
    assert!(
        (pair.angle_over_pi - angle).abs() < 1e-10,
        "{pair:?}, {angle}"
    );
}

/// Six van der Pol oscillators in a ring, x_i' = y_i, y_i' = mu (1 - x_i^2) y_i - x_i + k (x_{i+1} - 2 x_i + x_{i-1}), in
/// (mu, k).
#[derive(Debug, Clone, Copy)]
struct Oscillators;

impl Equations<12, 2> for Oscillators {
    const PARAMETERS: [&'static str; 2] = ["mu", "k"];

    fn rates<T: Real>(&self, z: [T; 12], [mu, k]: [T; 2]) -> [T; 12] {
        let one = T::constant(1.0);
        let x = |i: usize| z[2 * (i % 6)];
        std::array::from_fn(|j| {
            let (i, y) = (j / 2, z[j | 1]);
            if j % 2 == 0 {
                return y;
            }
            let pull = x(i + 1) - x(i) * 2.0 + x(i + 5);
            mu * (one - x(i) * x(i)) * y - x(i) + k * pull
        })
    }
}

#[test]
fn a_wave_around_six_oscillators_has_eleven_multipliers() {
    let all = data("foreign_orbits.json");
    let record = &all["records"]["5_ring6_vdp_rotating_wave"];
    let field = Smooth {
        equations: Oscillators,
        parameters: [1.0, 0.3],
    };
    let values = &record["values"];
    let start = numbers(&values["point"]);
    let exact = number(&values["period"]);
    assert_as_known(record, solved(&AnyField::of::<12>(&field), &start, exact));
}

/// Of the equilibria along the first parameter of some equations: the labelled ones.
fn labelled<S: Equations<N, 2> + 'static, const N: usize>(
    equations: S,
    (from, to): (f64, f64),
    held: f64,
    start: Vector,
) -> Vec<FoundEquilibrium> {
    let fields = |first: f64| {
        AnyField::new::<N>(Box::new(Smooth {
            equations,
            parameters: [first, held],
        }))
    };
    let family = FieldEquilibria {
        fields: &fields,
        along: S::PARAMETERS[0],
        scale: None,
        bounds: &[],
    };
    let settings = Settings::new((from.min(to), from.max(to)), 0.2).expect("settings");
    let mut found = Vec::new();
    let onward = Onward::along(start, from, to > from);
    family
        .follow(&onward, &settings, &mut |point| {
            found.extend(point.label.is_some().then(|| point.clone()));
            Continue(())
        })
        .expect("a branch");
    found
}

fn only(all: &[FoundEquilibrium], label: Label) -> Vec<&FoundEquilibrium> {
    all.iter().filter(|one| one.label == Some(label)).collect()
}

#[test]
fn equilibria_of_rings_oscillate_where_their_eigenvalues_say() {
    // x = F: F (e^(i a) - e^(-2 i a)) - 1, a = 2 pi j / N, is imaginary at F = 1 for N = 4 and 6.
    fn hopf<const N: usize>(frequency: f64) {
        let all = labelled::<_, N>(Ring, (0.2, 2.0), 0.0, Vector::repeat(N, 0.2));
        let hopf = only(&all, Label::Hb);
        assert_eq!(hopf.len(), 1, "{N}");
        assert!((hopf[0].parameter - 1.0).abs() < 1e-10, "{N}: {hopf:?}");
        let period = hopf[0].period.expect("a period");
        assert!(
            (period * frequency / TAU - 1.0).abs() < 1e-10,
            "{N}: {period}"
        );
    }
    hopf::<4>(1.0);
    hopf::<6>(3.0_f64.sqrt());
}

/// Lorenz, E. N. (1984). Irregularity: a fundamental property of the atmosphere. Tellus 36A, 98-110; in (F, G).
#[derive(Debug, Clone, Copy)]
struct Atmosphere;

impl Equations<3, 2> for Atmosphere {
    const PARAMETERS: [&'static str; 2] = ["f", "g"];

    fn rates<T: Real>(&self, [x, y, z]: [T; 3], [f, g]: [T; 2]) -> [T; 3] {
        let (a, b) = (0.25, 4.0);
        [
            f * a - y * y - z * z - x * a,
            x * y - x * z * b - y + g,
            x * y * b + x * z - z,
        ]
    }
}

#[test]
fn lorenzs_atmosphere_folds_oscillates_and_doubles() {
    let all = data("foreign_orbits.json");
    for name in [
        "3a_lorenz84_equilibria_G0.5",
        "3a_lorenz84_equilibria_G0.25",
    ] {
        let record = &all["records"][name];
        let held = number(&record["parameters"]["G"]);
        // At F = 0 near (0, G, 0).
        let start = vec![-held * held * 4.0 / 1.5, 0.7 * held, -0.3 * held];
        let found = labelled(Atmosphere, (0.0, 2.0), held, start.into());
        for (label, list) in [(Label::Lp, "folds"), (Label::Hb, "hopfs")] {
            let mut known: Vec<_> = record["values"][list]
                .as_array()
                .expect("a list")
                .iter()
                .collect();
            let ours = only(&found, label);
            assert_eq!(ours.len(), known.len(), "{name}, {list}");
            known.sort_by(|a, b| number(&b["F"]).total_cmp(&number(&a["F"])));
            let mut ours: Vec<_> = ours.into_iter().collect();
            ours.sort_by(|a, b| b.parameter.total_cmp(&a.parameter));
            for (one, known) in ours.iter().zip(known) {
                let error = (one.parameter / number(&known["F"]) - 1.0).abs();
                assert!(error < 1e-10, "{name}, {list}: {error:e}");
                if label == Label::Hb {
                    let frequency = TAU / one.period.expect("a period");
                    assert!((frequency / number(&known["omega"]) - 1.0).abs() < 1e-10);
                    let exact = number(&known["first_lyapunov_coefficient_q_normalised"]);
                    let coefficient = one.coefficient.expect("a coefficient");
                    assert!(
                        (coefficient / exact - 1.0).abs() < 1e-5,
                        "{coefficient}, {exact}"
                    );
                }
            }
        }
    }
    let family = OverParameters::both(Atmosphere);
    let record = &all["records"]["3b_lorenz84_orbit_F2_G0.5"];
    let values = &record["values"];
    let field = Smooth {
        equations: Atmosphere,
        parameters: [2.0, 0.5],
    };
    let found = solved(
        &AnyField::of::<3>(&field),
        &numbers(&values["point"]),
        number(&values["period"]),
    );
    let site = ContinuationPoint {
        shooting: found.0.shooting.clone(),
        at: [2.0, 0.5],
    };
    assert_as_known(record, found);
    let mut corrector = Corrector::new(&family, 1e-14).expect("a corrector");
    let doubling = first(&mut corrector, site, (0, 8.0), TestFunction::Doubling);
    let doubling = doubling.expect("a doubling");
    let record = &all["records"]["3c_lorenz84_PD_G0.5"];
    for (found, exact) in [
        (doubling.at[0], number(&record["parameters"]["F"])),
        (
            doubling.shooting.period(),
            number(&record["values"]["period"]),
        ),
    ] {
        assert!((found / exact - 1.0).abs() < 1e-11, "{found}, {exact}");
    }
}
