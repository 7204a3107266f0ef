//! Radiation damping against values of 27 digits: runs, orbits and the critical stiffness; the equation for the slip rate in every kind
//! of number; and every method against the others.

use crate::common;
use common::{assert_close, data, number, relative};
use proptest::prelude::*;
use serde_json::Value;
use twinslip::equilibrium::{Solver, Symmetry, steady_states};
use twinslip::field::State;
use twinslip::friction::{
    AnyLaw, Extremum, ExtremumKind, Formulas, Parameters, critical_stiffness, steady_log_slope,
    steady_stress,
};
use twinslip::integrate::{Choice, Control, Integrator, MAX_STEPS, Step, Taylor, Tolerances};
use twinslip::model::{
    Driven, Loading, from_difference_chart, interfaces_in_difference_chart, single_interface,
    to_difference_chart, two_interfaces,
};
use twinslip::number::{Balance, Difference, DoubleDouble, Interval, Jet, Real};
use twinslip::orbit::{InitialGuess, InterfaceSystem, OrbitAccuracy, Query, find};

fn law(name: &str, damping: f64) -> AnyLaw {
    let constants = Parameters::heslot_1994().damped(damping).expect("damping");
    AnyLaw::named(name, constants).expect("a law")
}

fn entries(value: &Value) -> impl Iterator<Item = (&String, &Value)> {
    value.as_object().expect("an object").iter()
}

fn list(value: &Value) -> &[Value] {
    value.as_array().expect("a list")
}

fn exact(x: f64) -> DoubleDouble {
    DoubleDouble::from(x)
}

/// y + g(y) = x with coefficients from tiny to huge.
fn balances() -> impl Strategy<Value = (f64, Balance<f64>)> {
    let coefficient = || prop_oneof![Just(0.0), (-60.0..60.0_f64).prop_map(f64::exp)];
    (-60.0..60.0_f64, coefficient(), coefficient(), 0..3).prop_map(|(x, a, b, kind)| match kind {
        0 => (x, Balance::Exponential(a)),
        1 => (x, Balance::Sinh(a)),
        _ => (x, Balance::Difference(a, b)),
    })
}

/// The same with each coefficient multiplied by one of these.
fn scaled<T: Real>(g: Balance<f64>, factors: [T; 2]) -> Balance<T> {
    let mut factors = factors.into_iter();
    g.map(|c| factors.next().expect("two at most") * c)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn what_is_left_of_a_stress_is_known_in_every_number((x, g) in balances(), seed in prop::array::uniform3(-1.0..1.0_f64)) {
        let (precise, of_precise) = exact(x).balanced(g.map(exact));
        let (value, slope) = g.map(exact).at(precise);
        let whole = (slope + 1.0).hi();
        let residual = ((precise + value - x) / whole).hi();
        let size = precise.hi().abs();
        prop_assert!(residual.abs() <= 1e-30 * (size + x.abs() / whole), "{x} {g:?}: {residual:e}");
        prop_assert!((of_precise - value).hi().abs() <= 1e-29 * value.hi().abs());

        let (y, of_y) = x.balanced(g);
        // The rounding of x alone is worth x eps / (1 + g').
        let rounded = f64::EPSILON * (size + x.abs() / whole);
        prop_assert!((exact(y) - precise).hi().abs() <= 4.0 * rounded, "{x} {g:?}: {y} for {precise:?}");
        let rounded_of = f64::EPSILON * value.hi().abs() + 4.0 * rounded * slope.hi();
        prop_assert!((exact(of_y) - value).hi().abs() <= 4.0 * rounded_of, "{x} {g:?}: {of_y} for {value:?}");

        let (bounds, of_bounds) = Interval::constant(x).balanced(g.map(Interval::constant));
        prop_assert!(bounds.lo() <= precise.hi() && precise.hi() <= bounds.hi(), "{bounds:?} {precise:?}");
        prop_assert!(of_bounds.lo() <= value.hi() && value.hi() <= of_bounds.hi(), "{of_bounds:?} {value:?}");
        prop_assert!(bounds.hi() - bounds.lo() <= 1e3 * rounded + 1e-300, "{x} {g:?}: {bounds:?}");

        // Along a direction, against the difference quotient in 31 digits.
        let at = |t: f64| {
            let factors = [seed[1], seed[2]].map(|s| exact(s * t) + 1.0);
            (exact(x) + seed[0] * t).balanced(scaled(g, factors))
        };
        let step = 1e-9;
        let (after, before) = (at(step), at(-step));
        let quotients = [after.0 - before.0, after.1 - before.1].map(|change| (change / (2.0 * step)).hi());
        let along = |value: f64, slope: f64| Jet::<f64, 1> { value, gradient: [slope] };
        let factors = [seed[1], seed[2]].map(|s| along(1.0, s));
        let jets = along(x, seed[0]).balanced(scaled(g, factors));
        for (jet, quotient) in [(jets.0, quotients[0]), (jets.1, quotients[1])] {
            prop_assert!((jet.gradient[0] - quotient).abs() <= 1e-9 * (1.0 + quotient.abs()), "{jet:?} {quotient}");
        }
    }

    #[test]
    fn differences_keep_their_digits((x, g) in balances(), gaps in prop::array::uniform3(-1.0..1.0_f64), size in -30.0..1.0_f64) {
        // The numbers of the second point are exact, and the first lies away by the gap.
        fn of<T: Real>(second: f64, gap: f64) -> Difference<T> {
            let (second, gap) = (T::constant(second), T::constant(gap));
            Difference::new(second + gap, second, gap)
        }
        let gap_of = |value: f64, gap: f64| 0.9 * gap * size.exp().min(1.0) * value.abs();
        let gap = 0.5 * gaps[0] * size.exp();
        let mut parts = Vec::new();
        let mut both = |c: f64| {
            let of_c = gap_of(c, gaps[1 + parts.len()]);
            parts.push(of_c);
            of_c
        };
        let moved = g.map(|c| (c, both(c)));
        let (precise, of_precise) = of::<DoubleDouble>(x, gap).balanced(moved.map(|(c, gap)| of(c, gap)));
        let (plain, of_plain) = of::<f64>(x, gap).balanced(moved.map(|(c, gap)| of(c, gap)));
        // Contributions to the gap may cancel; each has its own digits.
        let (at, slope) = g.at(precise.second.hi());
        let largest = gap.abs() + at.abs() * size.exp().min(1.0);
        let bound = 1e-12 * (precise.gap.hi().abs() + largest / (1.0 + slope));
        prop_assert!((plain.gap - precise.gap.hi()).abs() <= bound, "{x} {g:?}: {plain:?} {precise:?}");
        let bound = 1e-12 * (of_precise.gap.hi().abs() + largest);
        prop_assert!((of_plain.gap - of_precise.gap.hi()).abs() <= bound, "{x} {g:?}: {of_plain:?} {of_precise:?}");
        let subtracted = (precise.first - precise.second - precise.gap).hi().abs();
        prop_assert!(subtracted <= 1e-28 * (precise.first.hi().abs() + precise.second.hi().abs() + x.abs()));
    }
}

/// A run of one or two interfaces, and the states at the times that a reference gives.
struct Run {
    name: String,
    law: AnyLaw,
    loading: Loading,
    start: Vec<f64>,
    ends: Vec<(f64, Vec<f64>)>,
}

/// Those of the references.
fn runs() -> Vec<Run> {
    let all = data("damping.json");
    let mut runs = Vec::new();
    for (name, run) in entries(&all["single_interface"]) {
        let ends = list(&run["trajectory"]).iter().map(|end| {
            (
                number(&end["t"]),
                vec![number(&end["tau"]), number(&end["psi"]).ln()],
            )
        });
        runs.push(Run {
            name: name.clone(),
            law: law(run["law"].as_str().expect("a name"), number(&run["eta"])),
            loading: Loading::new(number(&run["V_H"]), number(&run["K"])).expect("positive"),
            start: vec![number(&run["y0"]["tau"]), number(&run["y0"]["psi"]).ln()],
            ends: ends.collect(),
        });
    }
    for (name, run) in entries(&all["two_interface_trajectories"]) {
        let psi = |at: &Value| [number(&at["1"]).ln(), number(&at["2"]).ln()];
        let start = run["y0"].as_str().expect("a start");
        let numbers: Vec<f64> = start
            .split(['=', '(', ')', ','])
            .filter_map(|word| word.trim().parse().ok())
            .collect();
        let ends = list(&run["ends"]).iter().map(|end| {
            let [first, second] = psi(&end["psi"]);
            (number(&end["t"]), vec![number(&end["tau"]), first, second])
        });
        runs.push(Run {
            name: name.clone(),
            law: law("spinodal", number(&run["eta"])),
            loading: Loading::new(number(&run["V_H"]), number(&run["K"])).expect("positive"),
            start: vec![numbers[0], numbers[1].ln(), numbers[2].ln()],
            ends: ends.collect(),
        });
    }
    assert_eq!(runs.len(), 5);
    runs
}

fn end<const N: usize>(
    field: &dyn Driven<N>,
    method: Choice,
    rtol: f64,
    start: &[f64],
    t: f64,
) -> Vec<f64> {
    let tolerances = Tolerances::equal(rtol).expect("positive");
    let mut integrator = method
        .integrator::<N>(tolerances, MAX_STEPS)
        .expect("a method");
    let y0 = State::<N>::from_column_slice(start);
    let end = integrator.flow(field, (0.0, t), &y0, None).expect("a run");
    end.as_slice().to_vec()
}

#[test]
fn runs_end_where_the_references_do() {
    let mut methods = vec![
        ("taylor", 1e-14, 1e-11),
        ("auto", 1e-13, 1e-10),
        ("rodas5p", 1e-12, 1e-8),
    ];
    if cfg!(feature = "sundials") {
        methods.push(("cvode-adams", 1e-13, 1e-9));
        methods.push(("cvode-bdf", 1e-13, 1e-8));
    }
    for run in runs() {
        let Run {
            name,
            law,
            loading,
            start,
            ends,
        } = run;
        for &(method, rtol, bound) in &methods {
            let choice = Choice::named(method).expect("a method");
            for (t, truth) in &ends {
                let reached = if start.len() == 2 {
                    end(&*single_interface(law, loading), choice, rtol, &start, *t)
                } else {
                    end(&*two_interfaces(law, loading), choice, rtol, &start, *t)
                };
                for (mine, truth) in reached.iter().zip(truth) {
                    let off = (mine - truth).abs() / truth.abs().max(1.0);
                    assert!(
                        off < bound,
                        "{name}, {method}, t = {t}: {mine} for {truth}, off by {off:e}"
                    );
                }
            }
        }
    }
}

#[test]
fn orbits_have_the_periods_and_multipliers_of_the_references() {
    let all = data("damping.json");
    let accuracy = OrbitAccuracy::of(Choice::Taylor);
    for (name, orbit) in entries(&all["two_interface_orbits"]) {
        let symmetry = match orbit["kind"].as_str() {
            Some("symmetric") => Symmetry::Symmetric,
            _ => Symmetry::Asymmetric,
        };
        let slab = InterfaceSystem {
            law: law("spinodal", number(&orbit["eta"])),
            interfaces: 2,
            loading: Loading::new(number(&orbit["V_H"]), number(&orbit["K"])).expect("positive"),
        };
        let begin = InitialGuess::Anywhere;
        let found = find(&slab, &Query { symmetry, begin }, &accuracy)
            .expect("an orbit")
            .orbit;
        let mut truth: Vec<f64> = match symmetry {
            Symmetry::Symmetric => vec![
                number(&orbit["ln_abs_mu_in_phase"]),
                number(&orbit["transverse"][0]["ln_mu_transverse"]),
            ],
            Symmetry::Asymmetric => list(&orbit["ln_abs_multipliers_reduced"])
                .iter()
                .map(number)
                .collect(),
        };
        truth.sort_by(|a, b| b.total_cmp(a));
        check_orbit(name, &found, number(&orbit["period"]), &truth);
    }
    for (name, run) in entries(&all["single_interface"]) {
        let slab = InterfaceSystem {
            law: law(run["law"].as_str().expect("a name"), number(&run["eta"])),
            interfaces: 1,
            loading: Loading::new(number(&run["V_H"]), number(&run["K"])).expect("positive"),
        };
        let query = Query {
            symmetry: Symmetry::Symmetric,
            begin: InitialGuess::Anywhere,
        };
        let found = find(&slab, &query, &accuracy).expect("an orbit").orbit;
        check_orbit(
            name,
            &found,
            number(&run["orbit"]["period"]),
            &[number(&run["orbit"]["ln_abs_mu"])],
        );
    }
}

fn check_orbit(name: &str, found: &twinslip::orbit::Orbit, period: f64, truth: &[f64]) {
    assert_close(found.period.value, period, 1e-10, name);
    let off = (found.period.value - period).abs();
    assert!(
        off <= found.period.uncertainty,
        "{name}: the period is off by {off:e}"
    );
    assert!(
        found.period.uncertainty < 1e-9 * period,
        "{name}: {:?}",
        found.period
    );
    for (mine, truth) in found.floquet.multipliers.iter().zip(truth) {
        let off = (mine.ln_abs.value - truth).abs();
        assert!(
            off < 1e-8 && off <= mine.ln_abs.uncertainty,
            "{name}: {mine:?} for {truth}, off by {off:e}"
        );
        assert!(mine.ln_abs.uncertainty < 1e-6, "{name}: {mine:?}");
    }
}

#[test]
fn the_critical_stiffness_is_that_of_the_closed_form() {
    let all = data("damping.json");
    let spinodal = list(&all["hopf_one_interface_spinodal"]["table"]);
    for row in spinodal {
        let (eta, v) = (number(&row["eta"]), number(&row["V"]));
        let mine = critical_stiffness(&law("spinodal", eta), v);
        let truth = number(&row["k_c"]);
        // where both parts nearly cancel the digits are those of the parts
        let part = eta * (0.01 + v);
        assert!(
            (mine - truth).abs() <= 1e-13 * (truth.abs() + part),
            "eta = {eta}, V = {v}: {mine} for {truth}"
        );
    }
    let others = list(&all["hopf_one_interface_other_laws"]["table"]);
    for row in others {
        let (eta, v) = (number(&row["eta"]), number(&row["V"]));
        for (name, key) in [
            ("dieterich-ruina", "k_c_dieterich_ruina_and_slip"),
            ("slip", "k_c_dieterich_ruina_and_slip"),
            ("regularised-ageing", "k_c_regularised_ageing"),
        ] {
            let mine = critical_stiffness(&law(name, eta), v);
            let truth = number(&row[key]);
            assert!(
                (mine - truth).abs() <= 1e-13 * (truth.abs() + eta * v),
                "{name}, eta = {eta}, V = {v}: {mine} for {truth}"
            );
        }
    }
    assert!(spinodal.len() + others.len() >= 20);
}

#[test]
fn a_damped_law_has_the_extrema_at_which_its_stress_turns() {
    for name in AnyLaw::NAMES {
        for eta in [1e-12, 1e-8, 1e-4, 1e-3, 1e-2, 0.1, 0.3, 1.0] {
            let damped = law(name, eta);
            let extrema = Extremum::all(&damped);
            // every change of sign of the slope on a fine grid is one of them
            let rates = (0..6000).map(|i| f64::exp(-30.0 + 0.01 * f64::from(i)));
            let signs: Vec<_> = rates
                .map(|v| (v, steady_log_slope(&damped, v) > 0.0))
                .collect();
            let turns: Vec<_> = signs
                .windows(2)
                .filter(|pair| pair[0].1 != pair[1].1)
                .collect();
            assert_eq!(
                turns.len(),
                extrema.len(),
                "{name}, eta = {eta}: {extrema:?}"
            );
            for (turn, extremum) in turns.iter().zip(&extrema) {
                let rate = extremum.slip_rate;
                assert!(
                    (turn[0].0..=turn[1].0).contains(&rate.value),
                    "{name}, {eta}: {extremum:?}"
                );
                assert!(
                    rate.uncertainty < 1e-9 * rate.value,
                    "{name}, {eta}: {extremum:?}"
                );
                let kind = if turn[1].1 {
                    ExtremumKind::Minimum
                } else {
                    ExtremumKind::Maximum
                };
                assert_eq!(extremum.kind, kind, "{name}, {eta}");
            }
        }
    }
    // d tau_ss/dV = (1 - beta)/V + eta of the plain laws
    let trough = Extremum::all(&law("dieterich-ruina", 1e-3))[0].slip_rate;
    let truth = (489.0 / 349.0 - 1.0) / 1e-3;
    assert!((trough.value - truth).abs() <= trough.uncertainty.max(1e-13 * truth));
}

#[test]
fn cycles_run_over_twelve_decades_of_slip_rate() {
    for name in ["regularised-ageing", "dieterich-ruina", "slip"] {
        for (eta, decades) in [(1e-9, 11.0), (1e-6, 8.0), (1e-2, 3.0)] {
            let loading = Loading::new(0.1, 0.05).expect("positive");
            let law = law(name, eta);
            let field = single_interface(law, loading);
            let v = loading.driving;
            let y0 = State::<2>::new(law.stress(v, 1.0 / v), (1.001 / v).ln());
            let (mut peak, mut least) = (0.0_f64, f64::INFINITY);
            let mut observer = |step: &Step<'_, 2>| {
                let rate = field.slip_rates(step.y1)[0];
                (peak, least) = (peak.max(rate), least.min(rate));
                Ok(Control::Continue)
            };
            let tolerances = Tolerances::equal(1e-12).expect("positive");
            let mut taylor = Taylor::new(tolerances, MAX_STEPS).expect("a method");
            let end = taylor
                .flow(&*field, (0.0, 1e4), &y0, Some(&mut observer))
                .expect("a run");
            assert!(end.iter().all(|x| x.is_finite()), "{name}, {eta}");
            let range = (peak / least).log10();
            assert!(
                range > decades,
                "{name}, eta = {eta}: {least:e} to {peak:e}"
            );
            // What the stress drives at most.
            assert!(peak * eta < 30.0, "{name}, eta = {eta}: {peak:e}");
        }
    }
}

#[test]
fn without_damping_nothing_is_another_law() {
    for name in AnyLaw::NAMES {
        let plain = AnyLaw::named(name, Parameters::heslot_1994()).expect("a law");
        assert_eq!(law(name, 0.0), plain);
        // and with the least of it hardly
        let damped = law(name, 1e-300);
        for (tau, psi) in [(9.0, 0.01), (12.0, 0.9), (3.0, 0.3)] {
            let rate = |law: &AnyLaw| law.slip_rate(law.activation(tau), psi);
            assert!(relative(rate(&damped), rate(&plain)) < 1e-14, "{name}");
        }
    }
    for damping in [-1.0, f64::NAN, f64::INFINITY] {
        assert!(
            Parameters::heslot_1994()
                .damped(damping)
                .unwrap_err()
                .is_input()
        );
    }
}

#[test]
fn small_differences_keep_their_digits_along_a_run() {
    for name in AnyLaw::NAMES {
        let damped = law(name, 1e-3);
        let loading = Loading::new(1.0, 0.14).expect("positive");
        let chart = interfaces_in_difference_chart(damped, loading);
        let plain = two_interfaces(damped, loading);
        let tolerances = Tolerances::equal(1e-14).expect("positive");
        let mut taylor = Taylor::new(tolerances, MAX_STEPS).expect("a method");
        // Far from each other both charts have all digits.
        let y = State::<3>::new(11.0, -1.5, -2.0);
        let x = to_difference_chart(&y).expect("psi_1 > psi_2");
        let rates = [chart.slip_rates(&x), plain.slip_rates(&y)];
        assert_close(rates[0][0], rates[1][0], 1e-13, name);
        assert_close(rates[0][1], rates[1][1], 1e-13, name);
        let span = (0.0, 4.0);
        let there = taylor.flow(&*chart, span, &x, None).expect("a run");
        let here = taylor.flow(&*plain, span, &y, None).expect("a run");
        let off = (from_difference_chart(&there) - here).amax();
        assert!(off < 1e-10, "{name}: {off:e}");
        // Close to each other only one has: the difference grows or falls by the same factor, however small it is.
        let growth = |log_gap: f64, taylor: &mut Taylor| {
            let x = State::<3>::new(11.0, -2.0, log_gap);
            let end = taylor.flow(&*chart, span, &x, None).expect("a run");
            end[2] - log_gap
        };
        let tiny = growth(-60.0, &mut taylor);
        let tinier = growth(-90.0, &mut taylor);
        assert!(
            (tiny - tinier).abs() < 1e-10 * (1.0 + tiny.abs()),
            "{name}: {tiny} and {tinier}"
        );
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn no_equilibrium_is_overlooked(
        law in 0..AnyLaw::NAMES.len(),
        beta in 0.9..1.9_f64,
        (log_r, log_c, log_eta, log_v) in (0.0..3.0_f64, -5.0..-1.0_f64, -7.0..0.0_f64, -2.5..4.0_f64),
    ) {
        let ten = |x: f64| 10_f64.powf(x);
        let constants = Parameters {
            beta,
            healing_time: ten(log_r),
            residual_strength: ten(log_c),
            damping: ten(log_eta),
            ..Parameters::heslot_1994()
        };
        let law = AnyLaw::named(AnyLaw::NAMES[law], constants).expect("a law");
        let driving = ten(log_v);
        let found = steady_states(&law, driving, 2, Solver::Newton).expect("equilibria");
        for state in &found.equilibria {
            prop_assert!(state.residual(&law, driving) < 1e-9, "{law:?} {driving}: {state:?}");
        }
        // Every change of sign of the difference of the stresses on a grid of slower rates V_H/2 e^(-x); within a cell of it there may be
        // two more.
        let apart = |x: f64| {
            let slow = 0.5 * driving * (-x).exp();
            steady_stress(&law, driving - slow) > steady_stress(&law, slow)
        };
        let grid = (0..12_000).map(|i| apart((-14.0 + 0.0017 * f64::from(i)).exp()));
        let signs: Vec<bool> = grid.collect();
        let turns = signs.windows(2).filter(|pair| pair[0] != pair[1]).count();
        if found.complete {
            let asymmetric = found.equilibria.len() - 1;
            prop_assert!(asymmetric >= turns && (asymmetric - turns).is_multiple_of(2), "{:?} {}: {} and {}", law, driving, asymmetric, turns);
        }
    }
}
