//! The steady state of many interfaces that differ: both solvers against each other, against roots on each branch and against double-double
//! arithmetic; the number of eigenvalues that grow against all eigenvalues of the dense matrix.

use crate::command::{csv, number, object, refused_in_one_line, twinslip};
use crate::common::assert_close;
use crate::many_methods::{jacobian, law};
use nalgebra::{Complex, Schur};
use serde_json::Value;
use twinslip::equilibrium::{Solver, Verdict};
use twinslip::friction::Formulas;
use twinslip::many::{
    ManyEquilibrium, ManyInterfaces, OneOfMany, equilibrium_of_many, stability_of_many,
};
use twinslip::model::Loading;
use twinslip::number::{DoubleDouble, Jet, Real, bracketed_root};

const SOLVERS: &[Solver] = &[
    Solver::Newton,
    #[cfg(feature = "sundials")]
    Solver::Kinsol,
];

/// Some number between -1 and 1, another one for each i and k.
fn some(i: usize, k: usize) -> f64 {
    let x = (i as f64 + 1.0) * 0.618_033_988_749_894_9 + (k as f64 + 1.0) * 0.414_213_562_373_095;
    2.0 * (x * (1.0 + k as f64)).fract() - 1.0
}

/// Interfaces that differ by so much, in everything that is drawn.
fn differing(name: &str, count: usize, by: f64, damping: f64) -> Vec<OneOfMany> {
    let one = |i: usize| OneOfMany {
        damping,
        slip_length: 1.0 + by * some(i, 0),
        stress_factor: 1.0 + 0.1 * by * some(i, 1),
        ..law(
            name,
            0.0349 * (1.0 + 0.1 * by * some(i, 2)),
            0.0489 * (1.0 + 0.1 * by * some(i, 3)),
        )
        .into()
    };
    (0..count).map(one).collect()
}

/// The stress at which an interface slides at a constant rate.
fn steady_stress<T: Real>(one: &OneOfMany, v: T) -> T {
    let psi = one.law.steady_state(v / one.slip_length);
    one.law.stress(v, psi) / one.stress_factor + v * one.damping
}

/// tau of the first and psi of each where all slide at V_H/N.
fn alike(all: &[OneOfMany], driving: f64) -> (f64, Vec<f64>) {
    let rate = driving / all.len() as f64;
    let psi = all
        .iter()
        .map(|one| one.law.steady_state(rate / one.slip_length));
    (steady_stress(&all[0], rate), psi.collect())
}

struct Case {
    all: Vec<OneOfMany>,
    loading: Loading,
    interfaces: ManyInterfaces,
}

impl Case {
    fn new(all: Vec<OneOfMany>, driving: f64, stiffness: f64) -> Self {
        let loading = Loading::new(driving, stiffness).expect("positive");
        let interfaces = ManyInterfaces::new(&all, loading).expect("laws of one kind");
        Case {
            all,
            loading,
            interfaces,
        }
    }

    fn from(&self, (stress, states): (f64, &[f64]), solver: Solver) -> ManyEquilibrium {
        let found = equilibrium_of_many(&self.interfaces, (stress, states), solver);
        found.unwrap_or_else(|error| panic!("{:?}: {error}", (solver, self.loading)))
    }

    /// From where all slide alike.
    fn found(&self, solver: Solver) -> ManyEquilibrium {
        let (stress, states) = alike(&self.all, self.loading.driving);
        self.from((stress, &states), solver)
    }
}

/// Of each law, in both senses of its steady curve where it has these.
fn cases(count: usize) -> Vec<(String, Case)> {
    let n = count as f64;
    let mut all = Vec::new();
    for (name, rate, by, damping) in [
        ("spinodal", 5000.0, 0.03, 0.0),
        ("spinodal", 10.0, 0.03, 0.0),
        ("spinodal", 1e-4, 0.1, 1e-3),
        ("spinodal", 3.0, 0.03, 0.02),
        ("bounded", 2.0, 0.03, 0.0),
        ("regularised-ageing", 1.0, 0.03, 0.1),
        ("dieterich-ruina", 1.0, 0.03, 0.0),
        ("dieterich-ruina", 0.3, 0.03, 0.02),
        ("slip", 0.8, 0.03, 0.0),
        ("slip", 0.8, 0.03, 0.05),
    ] {
        let interfaces = differing(name, count, by, damping);
        let what = format!("{name}, {count} at {rate}");
        all.push((what, Case::new(interfaces, rate * n, 0.14 / n)));
    }
    all
}

#[test]
fn both_solvers_come_to_the_same_state() {
    for count in [1, 3, 8, 50, 1003] {
        for (what, case) in cases(count) {
            let newton = case.found(Solver::Newton);
            assert!(newton.residual < 1e-12, "{what}: {:e}", newton.residual);
            for solver in SOLVERS {
                let other = case.found(*solver);
                let off = (newton.stress.value - other.stress.value).abs();
                assert!(off <= 1e-12 * newton.stress.value, "{what}: {off:e}");
                let both = newton.log_state.iter().zip(&other.log_state);
                for (a, b) in both {
                    assert!((a - b).abs() <= 1e-12 * (1.0 + a.abs()), "{what}: {a} {b}");
                }
            }
        }
    }
}

/// On its branch each interface has one rate under a stress, and these add up to V_H under one stress: roots in brackets.
#[test]
fn the_state_is_that_of_roots_on_each_branch() {
    for count in [3, 50] {
        for (what, case) in cases(count) {
            let found = case.found(Solver::Newton);
            let rate = |one: &OneOfMany, near: f64, tau: f64| {
                let curve = |v: f64| {
                    let stress = steady_stress(one, Jet::<f64, 1>::variable(v, 0));
                    (stress.value - tau, stress.gradient[0])
                };
                bracketed_root("a rate", near * 0.99, near * 1.01, curve).expect("a root")
            };
            let excess = |tau: f64| {
                let rates = case.all.iter().zip(&found.slip_rate);
                let total: f64 = rates.map(|(one, near)| rate(one, *near, tau)).sum();
                total - case.loading.driving
            };
            let middle = found.stress.value;
            let (mut low, mut high) = (middle - 1e-5, middle + 1e-5);
            let sign = excess(low).signum();
            assert_eq!(sign, -excess(high).signum(), "{what}");
            while high - low > 1e-14 * middle {
                let between = 0.5 * (low + high);
                if between <= low || between >= high {
                    break;
                }
                if excess(between).signum() == sign {
                    low = between;
                } else {
                    high = between;
                }
            }
            let off = (0.5 * (low + high) - middle).abs();
            assert!(off <= 1e-12 * middle, "{what}: {off:e}");
            for (one, v) in case.all.iter().zip(&found.slip_rate) {
                let root = rate(one, *v, middle);
                assert!((root / v - 1.0).abs() < 1e-11, "{what}: {v} for {root}");
            }
        }
    }
}

/// tau and v of each in 31 digits: Newton's method on the steady curves, whose residuals are in double-double.
fn precise(case: &Case, found: &ManyEquilibrium) -> (DoubleDouble, Vec<DoubleDouble>) {
    let mut tau = DoubleDouble::from(found.stress.value);
    let rates = found.slip_rate.iter();
    let mut rates: Vec<DoubleDouble> = rates.map(|v| DoubleDouble::from(*v)).collect();
    for _ in 0..8 {
        let slopes: Vec<f64> = { case.all.iter().zip(&rates) }
            .map(|(one, v)| steady_stress(one, Jet::<f64, 1>::variable(v.to_f64(), 0)).gradient[0])
            .collect();
        let left: Vec<DoubleDouble> = { case.all.iter().zip(&rates) }
            .map(|(one, v)| tau - steady_stress(one, *v))
            .collect();
        let mut missing = DoubleDouble::from(case.loading.driving);
        let mut compliance = 0.0;
        for ((v, left), slope) in rates.iter().zip(&left).zip(&slopes) {
            missing = missing - *v - *left / *slope;
            compliance += 1.0 / slope;
        }
        let moved = missing / compliance;
        tau = tau + moved;
        for ((v, left), slope) in rates.iter_mut().zip(left).zip(slopes) {
            *v = *v + (left + moved) / slope;
        }
    }
    (tau, rates)
}

#[test]
fn uncertainties_hold_against_double_double_arithmetic() {
    for count in [3, 50] {
        for (what, case) in cases(count) {
            for solver in SOLVERS {
                let found = case.found(*solver);
                let (tau, rates) = precise(&case, &found);
                let off = (tau - found.stress.value).to_f64().abs();
                let bound = found.stress.uncertainty;
                assert!(off <= bound, "{what}: tau off by {off:e}, {bound:e} said");
                assert!(bound < 1e-10 * found.stress.value, "{what}: {bound:e}");
                for (i, v) in rates.iter().enumerate() {
                    let off = (*v - found.slip_rate[i]).to_f64().abs();
                    let bound = found.slip_rate_uncertainty[i];
                    assert!(off <= bound, "{what}: v off by {off:e}, {bound:e} said");
                    assert!(bound < 1e-9 * v.to_f64(), "{what}: {bound:e}");
                    let psi = case.all[i].law.steady_state(*v / case.all[i].slip_length);
                    let off = (psi.ln() - found.log_state[i]).to_f64().abs();
                    let bound = found.log_state_uncertainty[i];
                    assert!(
                        off <= bound,
                        "{what}: ln psi off by {off:e}, {bound:e} said"
                    );
                }
            }
        }
    }
}

/// All eigenvalues, by the Schur form of the dense matrix.
fn eigenvalues(case: &Case, found: &ManyEquilibrium) -> Vec<Complex<f64>> {
    let states: Vec<f64> = found.log_state.iter().map(|w| w.exp()).collect();
    let matrix = jacobian(&case.all, case.loading, found.stress.value, &states);
    let all = Schur::new(matrix).complex_eigenvalues();
    all.iter().copied().collect()
}

#[test]
fn eigenvalues_that_grow_are_as_many_as_those_of_the_dense_matrix() {
    let (mut stable, mut unstable) = (0, 0);
    for count in [3, 10, 60] {
        let n = count as f64;
        for (name, rates) in [
            ("spinodal", [1e-3, 0.3, 10.0, 100.0, 2000.0, 1e4]),
            ("slip", [0.1, 0.5, 1.0, 3.0, 10.0, 30.0]),
            ("dieterich-ruina", [0.1, 0.5, 1.0, 3.0, 10.0, 30.0]),
        ] {
            for rate in rates {
                for stiffness in [1e-3, 0.14, 2.0] {
                    let all = differing(name, count, 0.003, 0.0);
                    let case = Case::new(all, rate * n, stiffness / n);
                    let found = case.found(Solver::Newton);
                    let all = eigenvalues(&case, &found);
                    let norm = all.iter().map(|z| z.norm()).fold(0.0, f64::max);
                    let nearest = all.iter().map(|z| z.re.abs()).fold(norm, f64::min);
                    let what = format!("{name}, {count} at {rate}, K N = {stiffness}");
                    assert!(nearest > 1e-11 * norm, "{what}: {nearest:e} of {norm:e}");
                    let known = all.iter().filter(|z| z.re > 0.0).count();
                    let made = stability_of_many(&case.interfaces, &found);
                    assert_eq!(made.unstable, Some(known), "{what}");
                    let verdict = match known {
                        0 => Verdict::Stable,
                        _ => Verdict::Unstable,
                    };
                    assert_eq!(made.verdict, verdict, "{what}");
                    match known {
                        0 => stable += 1,
                        _ => unstable += 1,
                    }
                }
            }
        }
    }
    assert!(stable > 20 && unstable > 20, "{stable} {unstable}");
}

/// K at which a pair of eigenvalues crosses the axis: of one interface where K T = d, in closed form.
#[test]
fn a_hopf_point_is_seen_from_both_sides() {
    for (name, rate) in [("spinodal", 10.0), ("slip", 2.0), ("dieterich-ruina", 0.5)] {
        let all = vec![OneOfMany::from(law(name, 0.0349, 0.0489))];
        let unit = Case::new(all.clone(), rate, 1.0);
        let found = unit.found(Solver::Newton);
        let states = [found.log_state[0].exp()];
        let matrix = jacobian(&all, unit.loading, found.stress.value, &states);
        // the trace is d - K T
        let critical = matrix[(0, 0)] / -matrix[(1, 1)];
        assert!(critical > 0.0, "{name}");
        for (factor, growing) in [(1.0 - 1e-9, 2), (1.0 + 1e-9, 0)] {
            let case = Case::new(all.clone(), rate, critical * factor);
            let made = stability_of_many(&case.interfaces, &case.found(Solver::Newton));
            assert_eq!(made.unstable, Some(growing), "{name}, {factor}");
        }
        let case = Case::new(all.clone(), rate, critical);
        let made = stability_of_many(&case.interfaces, &case.found(Solver::Newton));
        assert_eq!(made.verdict, Verdict::Undecided, "{name}");
    }
}

/// The same with two that differ: p_2 p_1 = p_0 of the cubic is a quadratic in K, and a pair is on the axis where p_1 > 0.
#[test]
fn a_hopf_point_of_two_is_seen_from_both_sides() {
    let mut crossed = 0;
    for driving in [0.5, 2.0, 10.0, 40.0, 200.0, 1000.0, 4000.0] {
        let all = differing("spinodal", 2, 0.02, 0.0);
        // the first one slides at nearly V_H, the second one on the slow branch
        let fast = steady_stress(&all[0], driving);
        let mut slow = (1..4000).map(|i| driving * (-0.005 * f64::from(i)).exp());
        let below = slow.rfind(|v| steady_stress(&all[1], *v) > fast);
        let Some(slow) = below else { continue };
        let rates = [(driving, &all[0]), (slow, &all[1])];
        let start = rates.map(|(v, one)| one.law.steady_state(v / one.slip_length));
        let state = |stiffness: f64| {
            let case = Case::new(all.clone(), driving, stiffness);
            let found = case.from((fast, &start), Solver::Newton);
            (case, found)
        };
        let (unit, found) = state(1.0);
        let states: Vec<f64> = found.log_state.iter().map(|w| w.exp()).collect();
        let m = jacobian(&all, unit.loading, found.stress.value, &states);
        let (d, t) = ([m[(0, 0)], m[(1, 1)]], -m[(2, 2)]);
        let ab = [0, 1].map(|i| -m[(2, i)] * m[(i, 2)]);
        let (sum, product) = (d[0] + d[1], d[0] * d[1]);
        let beside = ab[0] + ab[1] - t * sum;
        let last = t * product - ab[0] * d[1] - ab[1] * d[0];
        // (K T - sum) (product + K beside) - K last
        let [a, b, c] = [
            t * beside,
            t * product - sum * beside - last,
            -sum * product,
        ];
        let root = (b * b - 4.0 * a * c).sqrt();
        let roots = [(-b - root) / (2.0 * a), (-b + root) / (2.0 * a)];
        for k in roots {
            if !(k > 0.0 && product + k * beside > 0.0) {
                continue;
            }
            let grow = |k: f64| {
                let (case, found) = state(k);
                stability_of_many(&case.interfaces, &found).unstable
            };
            let (below, above) = (grow(k * (1.0 - 1e-9)), grow(k * (1.0 + 1e-9)));
            let (below, above) = (below.expect("decided"), above.expect("decided"));
            assert_eq!(below.abs_diff(above), 2, "K = {k}: {below}, {above}");
            crossed += 1;
        }
    }
    assert!(crossed > 0);
}

/// Equal interfaces, all of whose states are known with all eigenvalues.
#[test]
fn of_equal_interfaces_it_is_one_of_all_states() {
    let model = "--interfaces 6 --driving 6 --stiffness 0.05";
    let known = object(&format!("equilibria {model}"));
    let states = known["result"]["equilibria"].as_array().expect("a list");
    assert!(states.len() > 3);
    for state in states {
        let mut logs = Vec::new();
        let mut rates = Vec::new();
        for cluster in state["clusters"].as_array().expect("a list") {
            for _ in 0..number(cluster, "/count") as usize {
                logs.push(number(cluster, "/log_state"));
                rates.push(number(cluster, "/slip_rate"));
            }
        }
        let psi: Vec<String> = logs.iter().map(|w| (w * 1.001).exp().to_string()).collect();
        let start = format!("{},{}", number(state, "/stress/value"), psi.join(","));
        let growing = { state["eigenvalues"].as_array().expect("a list").iter() }
            .filter(|one| number(one, "/value/0") > 0.0)
            .map(|one| number(one, "/multiplicity"));
        let growing: f64 = growing.sum();
        for solver in ["newton", "kinsol"] {
            if solver == "kinsol" && cfg!(not(feature = "sundials")) {
                continue;
            }
            let found = object(&format!(
                "equilibria {model} --draw residual_strength=1e-3:1e-3 --solver {solver} --start {start}"
            ));
            let found = &found["result"]["equilibrium"];
            assert_eq!(number(found, "/unstable"), growing);
            assert_eq!(found["verdict"], state["verdict"]);
            let stress = number(found, "/stress/value") / number(state, "/stress/value") - 1.0;
            assert!(stress.abs() < 1e-13, "{stress:e}");
            for (i, rate) in rates.iter().enumerate() {
                let off = number(found, &format!("/slip_rate/{i}")) / rate - 1.0;
                assert!(off.abs() < 1e-11, "{off:e}");
            }
        }
    }
}

#[test]
fn every_law_and_damping_are_taken() {
    for law in [
        "spinodal",
        "bounded",
        "regularised-ageing",
        "dieterich-ruina",
        "slip",
    ] {
        for damping in ["", "--damping 0.01"] {
            let made = object(&format!(
                "equilibria --interfaces 20 --driving 20 --stiffness 0.01 --law {law} {damping} \
                 --draw slip_length=0.9:1.1,normal_stress=0.99:1.01 --seed 3"
            ));
            let found = &made["result"]["equilibrium"];
            let rates = found["slip_rate"].as_array().expect("a list");
            let total: f64 = rates.iter().filter_map(Value::as_f64).sum();
            assert!((total / 20.0 - 1.0).abs() < 1e-12, "{law}: {total}");
            assert!(number(found, "/residual") < 1e-12, "{law}");
            assert!(found["unstable"].is_u64(), "{law}");
        }
    }
}

#[test]
fn rows_are_one_for_each_interface() {
    let ended = twinslip(
        "equilibria --interfaces 5 --driving 5 --draw healing_time=50:200log,slip_length=0.9:1.1 --format csv",
    );
    assert_eq!(ended.code, 0, "{}", ended.err);
    let rows = csv(&ended.out);
    let header = "interface,state,log_state,log_state_uncertainty,slip_rate,slip_rate_uncertainty,healing_time,slip_length";
    assert_eq!(rows[0].join(","), header);
    assert_eq!(rows.len(), 6);
    let total: f64 = rows[1..]
        .iter()
        .map(|row| row[4].parse::<f64>().expect("a rate"))
        .sum();
    assert!((total / 5.0 - 1.0).abs() < 1e-13);
    let told = ended
        .out
        .lines()
        .find(|line| line.starts_with("# equilibrium: "));
    let told = told.and_then(|line| line.strip_prefix("# equilibrium: "));
    let told: Value = serde_json::from_str(told.expect("a remark")).expect("JSON");
    // without a stiffness there is no stability
    assert!(told["verdict"].is_null() && told["unstable"].is_null());
    assert!(number(&told, "/stress/uncertainty") < 1e-11);
    // what is drawn is what runs draw
    let run = object(
        "integrate --interfaces 5 --driving 5 --stiffness 0.1 --until 1e-9 --final-only --start near-symmetric:0 \
         --draw healing_time=50:200log,slip_length=0.9:1.1 --columns stress",
    );
    let start = number(&run, "/result/final/stress");
    // All slide at V*, and so under the reference friction that they share.
    assert_close(number(&told, "/stress/value"), start, 1e-11, "stress");
}

#[test]
fn many_are_no_harder() {
    let made = object(
        "equilibria --interfaces 20000 --driving 2e4 --stiffness 1e-5 --draw residual_strength=9e-4:1.1e-3,slip_length=0.9:1.1",
    );
    let found = &made["result"]["equilibrium"];
    assert_eq!(found["verdict"], "unstable");
    assert!(number(found, "/unstable") <= 20_001.0);
    assert_eq!(found["state"].as_array().map(Vec::len), Some(20_000));
}

#[test]
fn what_is_no_question_is_refused() {
    let asked = "equilibria --interfaces 9 --driving 9 --draw slip_length=0.9:1.1";
    refused_in_one_line(
        &format!("{asked} --start near:1"),
        "\"near:1\" must be TAU,PSI1",
    );
    refused_in_one_line(&format!("{asked} --start 9,1,2"), "must be TAU,PSI1");
    refused_in_one_line(
        "equilibria --interfaces 9 --driving 9 --draw size=1:2",
        "is none of",
    );
    refused_in_one_line(
        "equilibria --interfaces 9 --draw slip_length=1:2",
        "driving",
    );
    refused_in_one_line(&format!("{asked} --stiffness -1"), "stiffness");
    for other in [
        "--system lorenz",
        "--driving 9 --clusters 4,5",
        "--driving 9 --box x=0:1",
    ] {
        refused_in_one_line(
            &format!("equilibria --draw slip_length=0.9:1.1 {other}"),
            "does not have",
        );
    }
    // one slides away from the others without end
    let lost = twinslip(
        "equilibria --interfaces 50 --driving 5000 --draw normal_stress=0.95:1.05 --solver newton --format csv -q",
    );
    assert_eq!(lost.code, 1);
    assert_eq!(lost.err.lines().count(), 1, "{}", lost.err);
    assert!(lost.err.contains("did not converge"), "{}", lost.err);
}
