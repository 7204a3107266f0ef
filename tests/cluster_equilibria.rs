//! All equilibria of N equal interfaces: against references of thirty digits, a scan, two interfaces and the whole Jacobian matrix.

use crate::{command, common};
use command::{csv, object, refused, twinslip};
use common::{assert_close, data, number};
use nalgebra::{Complex, DMatrix, Schur};
use proptest::prelude::*;
use serde_json::Value;
use twinslip::equilibrium::{
    ClusterStability, EigenvalueKind, Equilibrium, Solver, SteadyStates, Symmetry, Verdict,
    cluster_stability, cluster_steady_states, stability, steady_states,
};
use twinslip::friction::{AnyLaw, Formulas, Law, Parameters, steady_stress};
use twinslip::number::Jet;

fn spinodal() -> AnyLaw {
    AnyLaw::Spinodal(Parameters::heslot_1994().spinodal())
}

fn all(law: &AnyLaw, driving: f64, interfaces: usize) -> SteadyStates {
    cluster_steady_states(law, driving, interfaces).expect("solved")
}

fn list(value: &Value) -> &Vec<Value> {
    value.as_array().expect("a list")
}

/// A real number, or [re, im].
fn complex(value: &Value) -> Complex<f64> {
    match value.as_array() {
        Some(parts) => Complex::new(number(&parts[0]), number(&parts[1])),
        None => Complex::new(number(value), 0.0),
    }
}

/// The eigenvalues of a kind, each as often as it counts.
fn of_kind(made: &ClusterStability, kind: EigenvalueKind) -> Vec<(Complex<f64>, f64)> {
    let these = made.eigenvalues.iter().filter(|one| one.kind == kind);
    these.map(|one| (one.value, one.uncertainty)).collect()
}

#[test]
fn states_and_eigenvalues_match_the_reference() {
    let reference = data("clusters.json");
    for (name, interfaces, driving, arrangements) in [
        ("N3_VH10", 3, 10.0, 7.0),
        ("N3_VH1500", 3, 1500.0, 19.0),
        ("N10_VH1", 10, 1.0, 1023.0),
    ] {
        let case = &reference["equilibria"][name];
        let found = all(&spinodal(), driving, interfaces);
        assert!(found.complete, "{name}");
        let total: f64 = found.equilibria.iter().map(Equilibrium::arrangements).sum();
        assert_eq!(total, arrangements, "{name}");
        let told = number(&case["number_of_equilibria_with_permutations"]);
        assert_eq!(total, told, "{name}");
        let states = list(&case["states"]);
        assert_eq!(found.equilibria.len(), states.len(), "{name}");
        for truth in states {
            let clusters = list(&truth["clusters"]);
            let rates: Vec<f64> = clusters.iter().map(|one| number(&one["v"])).collect();
            let counts: Vec<usize> = { clusters.iter() }
                .map(|one| number(&one["size"]) as usize)
                .collect();
            let stress = number(&truth["stress"]);
            let off = |one: &&Equilibrium| (one.stress.value - stress).abs();
            let state = { found.equilibria.iter() }.min_by(|a, b| off(a).total_cmp(&off(b)));
            let state = state.expect("one");
            let what = format!("{name}: {counts:?}");
            assert_eq!(state.counts, counts, "{what}");
            assert_close(state.stress.value, stress, 1e-15, &what);
            assert!(off(&state) <= state.stress.uncertainty, "{what}");
            for (i, rate) in rates.iter().enumerate() {
                let psi = number(&clusters[i]["psi"]);
                assert_close(state.slip_rate[i], *rate, 1e-14, &what);
                assert_close(state.state()[i], psi, 1e-14, &what);
                let error = (state.slip_rate[i] - rate).abs();
                let bound = state.slip_rate_uncertainty()[i];
                assert!(error <= bound && bound <= 1e-13 * rate, "{what}: {bound:e}");
                let error = (state.state()[i] - psi).abs();
                assert!(error <= state.state_uncertainty()[i], "{what}");
            }
            let made = cluster_stability(&spinodal(), state, 0.14).expect("K is valid");
            let mut collective = of_kind(&made, EigenvalueKind::Clusters);
            for known in list(&truth["eigenvalues_reduced"]) {
                let known = complex(known);
                let off = |(value, _): &(Complex<f64>, f64)| (value - known).norm();
                let nearest = (0..collective.len())
                    .min_by(|&i, &j| off(&collective[i]).total_cmp(&off(&collective[j])));
                let (value, bound) = collective.remove(nearest.expect("as many"));
                let error = (value - known).norm() / known.norm();
                assert!(error < 1e-13, "{what}: {value} {known}: {error:e}");
                assert!((value - known).norm() <= bound, "{what}: {bound:e}");
                assert!(bound <= 1e-11 * known.norm(), "{what}: {known} {bound:e}");
            }
            assert!(collective.is_empty(), "{what}");
            for (i, cluster) in clusters.iter().enumerate() {
                let within = of_kind(&made, EigenvalueKind::Within(i));
                if cluster["transverse_eigenvalue"].is_null() {
                    assert!(within.is_empty(), "{what}");
                    continue;
                }
                let [(value, bound)] = within[..] else {
                    panic!("{what}: {within:?}");
                };
                let known = number(&cluster["transverse_eigenvalue"]);
                assert_close(value.re, known, 1e-13, &what);
                assert!((value.re - known).abs() <= bound, "{what}");
            }
            let unstable = number(&truth["number_unstable_full"]) as usize;
            assert_eq!(made.unstable(), unstable, "{what}");
            let stable = unstable == 0;
            let verdict = match stable {
                true => Verdict::Stable,
                false => Verdict::Unstable,
            };
            assert_eq!(made.verdict, verdict, "{what}");
            let multiplicities: usize = made.eigenvalues.iter().map(|one| one.multiplicity).sum();
            assert_eq!(multiplicities, interfaces + 1, "{what}");
        }
    }
}

/// The Jacobian matrix of (tau, ln psi_1, .., ln psi_N), row by row.
pub fn jacobian(law: &AnyLaw, state: &Equilibrium, stiffness: f64) -> DMatrix<f64> {
    let each: Vec<f64> = { state.log_state.iter().zip(&state.counts) }
        .flat_map(|(&w, &count)| vec![w; count])
        .collect();
    let n = each.len() + 1;
    let mut matrix = DMatrix::zeros(n, n);
    for (i, &w) in each.iter().enumerate() {
        let [tau, log] = Jet::<f64, 2>::variables([state.stress.value, w]);
        let psi = twinslip::number::Real::exp(log);
        let v = law.slip_rate(law.activation(tau), psi);
        let rate = law.evolution(v, psi) / psi;
        matrix[(0, 0)] -= stiffness * v.gradient[0];
        matrix[(0, i + 1)] = -stiffness * v.gradient[1];
        matrix[(i + 1, 0)] = rate.gradient[0];
        matrix[(i + 1, i + 1)] = rate.gradient[1];
    }
    matrix
}

/// The eigenvalues of a matrix. The iteration may not end where one is there several times: then it is tried in another basis.
pub fn eigenvalues(matrix: &DMatrix<f64>) -> Vec<Complex<f64>> {
    let n = matrix.nrows();
    let tried = (0..20).find_map(|k| {
        let other = |i: usize, j: usize| (1.0 + ((7 * i + 3 * j + 1) * (k + 1)) as f64).sin();
        let basis = match k {
            0 => DMatrix::identity(n, n),
            _ => DMatrix::from_fn(n, n, other).qr().q(),
        };
        Schur::try_new(basis.transpose() * matrix * basis, 1e-14, 1000)
    });
    let found = tried.expect("ends in one of them").complex_eigenvalues();
    found.iter().copied().collect()
}

fn matches_the_matrix(law: &AnyLaw, state: &Equilibrium, stiffness: f64) {
    let matrix = jacobian(law, state, stiffness);
    let size = matrix.norm();
    let mut known = eigenvalues(&matrix);
    let made = cluster_stability(law, state, stiffness).expect("K is valid");
    let what = format!("{:?} {:?}", state.counts, state.slip_rate);
    for one in &made.eigenvalues {
        for _ in 0..one.multiplicity {
            let off = |z: &Complex<f64>| (z - one.value).norm();
            let nearest =
                (0..known.len()).min_by(|&i, &j| off(&known[i]).total_cmp(&off(&known[j])));
            let z = known.remove(nearest.expect("as many"));
            // several times the same eigenvalue is known to the root of rounding
            assert!(
                off(&z) < 1e-6 * size.min(1.0 + off(&z) + z.norm()),
                "{what}: {z} {}",
                one.value
            );
        }
    }
    assert!(known.is_empty(), "{what}");
}

#[test]
fn eigenvalues_are_those_of_the_whole_matrix() {
    for interfaces in [3, 4, 6] {
        let mut seen = 0;
        for driving in [0.01, 0.5, 10.0, 700.0, 1500.0, 2500.0] {
            let found = all(&spinodal(), driving, interfaces);
            assert!(found.complete);
            for state in &found.equilibria {
                for stiffness in [0.01, 0.14, 3.0] {
                    matches_the_matrix(&spinodal(), state, stiffness);
                    seen += 1;
                }
            }
        }
        assert!(seen > 50, "{seen}");
    }
}

#[test]
fn two_interfaces_have_the_same_states_either_way() {
    let mut seen = 0;
    for i in 0..200 {
        let driving = 10f64.powf(-3.0 + 0.04 * f64::from(i));
        let old = steady_states(&spinodal(), driving, 2, Solver::Newton).expect("solved");
        let new = all(&spinodal(), driving, 2);
        assert!(old.complete && new.complete, "{driving}");
        assert_eq!(old.equilibria.len(), new.equilibria.len(), "{driving}");
        for (a, b) in old.equilibria.iter().zip(&new.equilibria) {
            let what = format!("V_H = {driving}");
            assert_eq!(a.symmetry, b.symmetry);
            assert_close(a.stress.value, b.stress.value, 1e-15, &what);
            assert_close(a.slip_rate[0], b.slip_rate[0], 4e-16, &what);
            let last = b.slip_rate.len() - 1;
            assert_close(a.slip_rate[1], b.slip_rate[last], 4e-16, &what);
            let one = stability(&spinodal(), a, 0.14).expect("K is valid");
            let two = cluster_stability(&spinodal(), b, 0.14).expect("K is valid");
            assert_eq!(one.verdict, two.verdict, "{what}");
            for (z, other) in one.eigenvalues.iter().zip(&two.eigenvalues) {
                assert!(
                    (z - other.value).norm() <= 1e-12 * z.norm(),
                    "{what}: {z} {other:?}"
                );
            }
            seen += usize::from(a.symmetry == Symmetry::Asymmetric);
        }
    }
    assert!(seen > 100);
}

/// At N v_e, v_e an extremum, all shares of the two branches that meet there meet the state in which all slide alike. Of unlike numbers
/// of interfaces two pass into one another, (n, m) and (m, n); equal numbers are born as a pitchfork, or die.
#[test]
fn numbers_are_certain_close_to_where_clusters_are_born() {
    let law = spinodal();
    for extremum in law.steady_extrema() {
        for (interfaces, born) in [(3, 0.0), (4, 6.0), (5, 0.0), (6, 20.0)] {
            let birth = extremum * f64::from(interfaces);
            for by in [1e-4, 1e-7, 1e-10, 1e-13] {
                let count = |factor: f64| {
                    let found = all(&law, birth * factor, interfaces as usize);
                    assert!(found.complete, "{birth} {factor}");
                    let each = found.equilibria.iter().map(Equilibrium::arrangements);
                    each.sum::<f64>()
                };
                let (less, more) = (count(1.0 - by), count(1.0 + by));
                assert_eq!((less - more).abs(), born, "{birth} {by:e}: {less} {more}");
            }
        }
    }
    let pitchfork = 3.0 * law.steady_extrema()[0];
    assert!(!all(&law, pitchfork, 3).complete);
}

#[test]
fn a_hundred_interfaces_and_those_without_extrema() {
    let found = all(&spinodal(), 1500.0, 100);
    assert!(found.complete);
    assert!(found.equilibria.len() > 100);
    for state in &found.equilibria {
        assert!(state.residual(&spinodal(), 1500.0) < 1e-12);
        assert_eq!(state.counts.iter().sum::<usize>(), 100);
    }
    for name in ["dieterich-ruina", "slip", "regularised-ageing"] {
        let law = AnyLaw::named(name, Parameters::heslot_1994()).expect("known");
        let found = all(&law, 10.0, 5);
        assert!(found.complete && found.equilibria.len() == 1, "{name}");
        let made = cluster_stability(&law, &found.equilibria[0], 0.3).expect("K is valid");
        assert_eq!(made.verdict, Verdict::Unstable, "{name} weakens everywhere");
    }
}

#[test]
fn bad_numbers_are_refused() {
    for (driving, interfaces, message) in [
        (0.0, 3, "driving is 0, but must be positive and finite"),
        (1.0, 0, "interfaces is 0, but must be between 1 and 600"),
        (1.0, 601, "interfaces is 601, but must be between 1 and 600"),
    ] {
        let refused = cluster_steady_states(&spinodal(), driving, interfaces).unwrap_err();
        assert_eq!(refused.to_string(), message);
    }
}

#[test]
fn the_command_tells_clusters() {
    let made = object("equilibria --interfaces 3 --driving 1500 --stiffness 0.14");
    assert_eq!(made["model"]["interfaces"], 3);
    assert_eq!(made["numerics"]["solver"], "newton");
    assert_eq!(made["result"]["complete"], true);
    let states = list(&made["result"]["equilibria"]);
    let numbers: Vec<f64> = states
        .iter()
        .map(|one| number(&one["arrangements"]))
        .collect();
    assert_eq!(numbers, [3.0, 6.0, 3.0, 3.0, 3.0, 1.0]);
    for one in states {
        let clusters = list(&one["clusters"]);
        let total: f64 = clusters.iter().map(|one| number(&one["count"])).sum();
        assert_eq!(total, 3.0);
        for field in ["state", "log_state", "slip_rate"] {
            let each: Vec<&Value> = clusters.iter().map(|one| &one[field]).collect();
            assert_eq!(list(&one[field]).iter().collect::<Vec<_>>(), each);
        }
        let rates: Vec<f64> = list(&one["slip_rate"]).iter().map(number).collect();
        assert!(rates.is_sorted(), "{rates:?}");
        let eigenvalues = list(&one["eigenvalues"]);
        assert_eq!(
            list(&one["eigenvalue_uncertainty"]).len(),
            eigenvalues.len()
        );
        let total: f64 = eigenvalues
            .iter()
            .map(|one| number(&one["multiplicity"]))
            .sum();
        assert_eq!(total, 4.0);
        let kinds = |kind: &str| eigenvalues.iter().filter(|one| one["kind"] == kind).count();
        assert_eq!(kinds("clusters"), clusters.len() + 1);
        let several = clusters
            .iter()
            .filter(|one| number(&one["count"]) > 1.0)
            .count();
        assert_eq!(kinds("within"), several);
        assert!(eigenvalues.iter().all(|one| list(&one["value"]).len() == 2));
        assert!(one["verdict"].is_string() && one["residual"].is_f64());
    }
    let bare = object("equilibria --interfaces 3 --driving 10");
    assert!(bare["result"]["equilibria"][0]["eigenvalues"].is_null());
}

#[test]
fn one_and_two_interfaces_have_clusters_beside_their_fields() {
    let made = object("equilibria --driving 10 --stiffness 0.14");
    let [symmetric, asymmetric] = &list(&made["result"]["equilibria"])[..] else {
        panic!("two states");
    };
    assert_eq!(list(&symmetric["slip_rate"]).len(), 2);
    assert_eq!(list(&symmetric["eigenvalues"]).len(), 3);
    let counts = |one: &Value| -> Vec<Value> {
        list(&one["clusters"])
            .iter()
            .map(|one| one["count"].clone())
            .collect()
    };
    assert_eq!(counts(symmetric), [2]);
    assert_eq!(symmetric["arrangements"], 1.0);
    assert_eq!(counts(asymmetric), [1, 1]);
    assert_eq!(asymmetric["arrangements"], 2.0);
    assert_eq!(
        asymmetric["clusters"][1]["slip_rate"],
        asymmetric["slip_rate"][1]
    );
    let single = object("equilibria --driving 10 --interfaces 1");
    assert_eq!(counts(&single["result"]["equilibria"][0]), [1]);
    let differ = object("equilibria --driving 10 --set residual_strength_2=0.0011");
    assert!(differ["result"]["equilibria"][0].get("clusters").is_none());
}

#[test]
fn rows_have_counts_and_kinds() {
    let rows = csv(&twinslip(
        "equilibria --interfaces 6 --driving 2000 --stiffness 0.14 --format csv",
    )
    .out);
    let place = |name: &str| {
        rows[0]
            .iter()
            .position(|column| column == name)
            .expect("a column")
    };
    let made = object("equilibria --interfaces 6 --driving 2000 --stiffness 0.14");
    let states = list(&made["result"]["equilibria"]);
    assert_eq!(rows.len(), states.len() + 1);
    for (row, one) in rows[1..].iter().zip(states) {
        let clusters = list(&one["clusters"]);
        for i in 0..3 {
            let count = &row[place(&format!("count_{}", i + 1))];
            let told = clusters
                .get(i)
                .map_or(String::new(), |one| one["count"].to_string());
            assert_eq!(*count, told);
        }
        let eigenvalues = list(&one["eigenvalues"]);
        assert_eq!(row[place("eigenvalue_1_kind")], eigenvalues[0]["kind"]);
        let multiplicity = &row[place("eigenvalue_1_multiplicity")];
        assert_eq!(*multiplicity, eigenvalues[0]["multiplicity"].to_string());
        assert_eq!(row[place("verdict")], one["verdict"]);
    }
    let explained = twinslip("equilibria --interfaces 6 --driving 2000 --explain").err;
    assert!(
        explained
            .contains("every partition of the interfaces among the slow, middle and fast branch"),
        "{explained}"
    );
}

#[test]
fn what_several_interfaces_do_not_have_is_refused() {
    let model = |change: &str| format!("equilibria --driving 10 {change}");
    for interfaces in [0, 601] {
        refused(
            &model(&format!("--interfaces {interfaces}")),
            &format!(
                "interfaces is {interfaces}, but must be between 1 and 600: the number of partitions of more interfaces is beyond the range of doubles"
            ),
        );
    }
    refused(
        &model("--interfaces 3 --set residual_strength_2=0.0011"),
        "takes 3 interfaces only if they are equal; two may differ",
    );
    refused(
        &model("--interfaces 3 --law composite.toml"),
        "the steady states of 3 interfaces need a built-in law, those of one or two take any law",
    );
    refused(
        &model("--interfaces 3 --solver kinsol"),
        "solver kinsol is for one or two interfaces, and there are more; choose newton",
    );
    refused(
        &model("--clusters 1,2"),
        "the steady states of all clusters are found",
    );
}

/// The rate on a stretch of the steady curve under a stress, by bisection.
fn rate_under(law: &AnyLaw, stress: f64, ends: (f64, f64)) -> Option<f64> {
    let above = |ln_v: f64| steady_stress(law, ln_v.exp()) > stress;
    let (mut a, mut b) = (ends.0.ln(), ends.1.ln());
    let left = above(a);
    if above(b) == left {
        return None;
    }
    for _ in 0..60 {
        let middle = 0.5 * (a + b);
        if above(middle) == left {
            a = middle;
        } else {
            b = middle;
        }
    }
    Some((0.5 * (a + b)).exp())
}

/// Sign changes of the sum of the rates less V_H for each share, over stresses between the extrema: for each share with its number.
fn scanned(law: &AnyLaw, driving: f64, interfaces: usize) -> Vec<([usize; 3], usize)> {
    const POINTS: i32 = 600;
    let extrema = law.steady_extrema();
    let (rest, far) = (1e-60, 1e60);
    let (peak, trough) = match extrema[..] {
        [trough] if law.weakens_from_rest() => (rest, trough),
        [peak] => (peak, far),
        [peak, trough] => (peak, trough),
        _ => return Vec::new(),
    };
    let [top, bottom] = [peak, trough].map(|v| steady_stress(law, v));
    // finer towards both ends
    let part = |i: i32| 0.5 - 0.5 * (std::f64::consts::PI * f64::from(i) / f64::from(POINTS)).cos();
    let rates: Vec<[Option<f64>; 3]> = (1..POINTS)
        .map(|i| {
            let stress = bottom + (top - bottom) * part(i);
            let stretches = [(rest, peak), (peak, trough), (trough, far)];
            stretches.map(|ends| rate_under(law, stress, ends))
        })
        .collect();
    let mut all = Vec::new();
    for slow in 0..=interfaces {
        for middle in 0..=interfaces - slow {
            let counts = [slow, middle, interfaces - slow - middle];
            if counts.iter().filter(|&&n| n > 0).count() < 2 {
                continue;
            }
            let signs: Vec<bool> = { rates.iter() }
                .filter_map(|rates| {
                    let terms = counts.iter().zip(rates).filter(|(count, _)| **count > 0);
                    let sum: Option<f64> = terms.map(|(n, v)| Some(*n as f64 * (*v)?)).sum();
                    Some(sum? > driving)
                })
                .collect();
            let changes = signs.windows(2).filter(|pair| pair[0] != pair[1]).count();
            all.push((counts, changes));
        }
    }
    all
}

/// On which stretch of the steady curve each interface slides.
fn share(law: &AnyLaw, state: &Equilibrium) -> [usize; 3] {
    let extrema = law.steady_extrema();
    let mut counts = [0; 3];
    for (&v, &count) in state.slip_rate.iter().zip(&state.counts) {
        let passed = extrema.iter().filter(|&&extremum| v > extremum).count();
        counts[passed + usize::from(law.weakens_from_rest())] += count;
    }
    counts
}

/// The middle branch has no end in doubles, and its other end is so far away that the ratio of both is no double.
#[test]
fn a_branch_from_the_smallest_rate_to_large_ones_is_searched() {
    let parameters = Parameters::new(0.0349, 0.0349 * 1.02, 0.369, 100.0, 1e-3);
    let law = AnyLaw::named(
        "regularised-ageing",
        parameters.and_then(|p| p.damped(4e-3)).expect("valid"),
    );
    let law = law.expect("known");
    assert!(law.weakens_from_rest() && law.steady_extrema()[0] > 4.0);
    let found = all(&law, 1e4, 3);
    assert!(!found.equilibria.is_empty());
    // as two interfaces: their search has cells of its own
    assert_eq!(
        steady_states(&law, 1e4, 2, Solver::Newton)
            .expect("solved")
            .equilibria
            .len(),
        all(&law, 1e4, 2).equilibria.len()
    );
}

fn laws() -> impl Strategy<Value = AnyLaw> {
    let damping = prop_oneof![Just(0.0), (-6.0..0.0_f64).prop_map(|log| 10f64.powf(log))];
    let numbers = (1.02..3.0_f64, 0.0..8.0_f64, -6.0..-1.0_f64, damping);
    (0..3_usize, numbers).prop_map(|(law, (beta, ln_r, log_c, damping))| {
        let name = ["spinodal", "bounded", "regularised-ageing"][law];
        let parameters =
            Parameters::new(0.0349, 0.0349 * beta, 0.369, ln_r.exp(), 10f64.powf(log_c));
        let parameters = parameters.and_then(|p| p.damped(damping));
        AnyLaw::named(name, parameters.expect("valid")).expect("known")
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn nothing_is_missed(law in laws(), log_v in -3.0..4.0_f64, interfaces in 3_usize..=6, log_k in -2.0..1.0_f64) {
        let driving = 10f64.powf(log_v);
        let found = all(&law, driving, interfaces);
        let told: Vec<[usize; 3]> = found.equilibria.iter().map(|one| share(&law, one)).collect();
        if found.complete {
            for (counts, changes) in scanned(&law, driving, interfaces) {
                let count = told.iter().filter(|one| **one == counts).count();
                // a scan overlooks pairs between its points, and what lies beyond its ends
                prop_assert!(count >= changes, "{counts:?}: {count} found, a scan shows {changes}");
            }
        }
        for state in &found.equilibria {
            prop_assert!(state.residual(&law, driving) < 1e-9);
            let made = cluster_stability(&law, state, 10f64.powf(log_k)).expect("K is valid");
            let told: usize = made.eigenvalues.iter().map(|one| one.multiplicity).sum();
            prop_assert_eq!(told, interfaces + 1);
            let growing = made.unstable() > 0;
            prop_assert!(made.verdict == Verdict::Undecided || growing == (made.verdict == Verdict::Unstable));
        }
    }

    #[test]
    fn bounds_hold_for_inputs_that_were_rounded(log_v in -3.0..4.0_f64, interfaces in 3_usize..=6, up in prop::array::uniform5(any::<bool>())) {
        let driving = 10f64.powf(log_v);
        let next = |x: f64, up: bool| if up { x.next_up() } else { x.next_down() };
        let mut law = spinodal();
        for (constant, up) in law.constants().into_iter().flatten().zip(up) {
            *constant = next(*constant, up);
        }
        let (one, two) = (all(&spinodal(), driving, interfaces), all(&law, next(driving, up[4]), interfaces));
        if one.complete && two.complete {
            prop_assert_eq!(one.equilibria.len(), two.equilibria.len());
            for (a, b) in one.equilibria.iter().zip(&two.equilibria) {
                prop_assert_eq!(&a.counts, &b.counts);
                let (known, other) = (a.slip_rate_uncertainty(), b.slip_rate_uncertainty());
                for i in 0..a.counts.len() {
                    let apart = (a.slip_rate[i] - b.slip_rate[i]).abs();
                    prop_assert!(apart <= known[i] + other[i], "{a:?} {b:?}");
                }
                let apart = (a.stress.value - b.stress.value).abs();
                prop_assert!(apart <= a.stress.uncertainty + b.stress.uncertainty);
            }
        }
    }
}
