//! Slip length, normal stress and a that vary in SI: what stays fixed in SI stays so, and each row is that of the dimensionless computation
//! at its own units.

use crate::command;
use command::{number, object, refused};
use serde_json::Value;

const A: f64 = 0.0349;
const RATE: f64 = 1e-6;
/// V_H in m/s, k in Pa/m and t** in s; eta in Pa s/m.
const DRIVING: f64 = 1e-5;
const STIFFNESS: f64 = 6e9;
const HEALING: f64 = 90.0;
const DAMPING: f64 = 2e6;

/// The units of an interface with this L, sigma and a.
#[derive(Clone, Copy)]
struct Own {
    length: f64,
    sigma: f64,
    a: f64,
}

/// The paper's L and a, and the default of sigma.
const PAPER: Own = Own {
    length: 0.9e-6,
    sigma: 1e6,
    a: A,
};

impl Own {
    fn with(self, name: &str, value: f64) -> Self {
        match name {
            "slip_length" => Own {
                length: value,
                ..self
            },
            "normal_stress" => Own {
                sigma: value,
                ..self
            },
            "direct_effect" => Own { a: value, ..self },
            other => panic!("{other}"),
        }
    }

    fn stress(self) -> f64 {
        self.a * self.sigma
    }

    fn time(self) -> f64 {
        self.length / RATE
    }

    /// V_H and K, dimensionless, with R where the law heals and the damping.
    fn options(self, law: &str) -> String {
        let heals = ["spinodal", "bounded"].contains(&law);
        let healing = match heals {
            true => format!("--healing-time {:?}", HEALING / self.time()),
            false => String::new(),
        };
        format!(
            "--law {law} --driving {:?} --stiffness {:?} --direct-effect {:?} --damping {:?} {healing}",
            DRIVING / RATE,
            STIFFNESS * self.length / self.stress(),
            self.a,
            DAMPING * RATE / self.stress(),
        )
    }
}

/// The options of the same in SI, without what varies.
fn in_si(law: &str) -> String {
    format!(
        "--si --law {law} --driving {DRIVING:?} --stiffness {STIFFNESS:?} --damping {DAMPING:?}"
    )
}

fn rows(made: &Value) -> &[Value] {
    made["result"]["rows"].as_array().expect("rows")
}

#[track_caller]
fn near(found: f64, by_hand: f64, tolerance: f64, what: &str) {
    assert!(
        (found / by_hand - 1.0).abs() < tolerance,
        "{what}: {found} for {by_hand}"
    );
}

/// Parameters that make units, with values far apart.
const VARIED: [(&str, [f64; 3]); 3] = [
    ("slip_length", [0.3e-6, 0.9e-6, 4e-6]),
    ("normal_stress", [0.4e6, 1e6, 7e6]),
    ("direct_effect", [0.03, 0.0349, 0.04]),
];

#[test]
fn equilibria_along_a_unit_are_those_at_its_values() {
    for (law, interfaces) in [("spinodal", 2), ("dieterich-ruina", 1), ("slip", 2)] {
        for (name, values) in VARIED {
            let [low, at, high] = values;
            let branch = format!(
                "branch equilibria {} --interfaces {interfaces} --along {name}={low:?}:{high:?} --at {at:?}",
                in_si(law)
            );
            let made = object(&branch);
            assert_eq!(made["model"][name], Value::Null, "{branch}");
            for value in values {
                let own = PAPER.with(name, value);
                let by_hand = object(&format!(
                    "equilibria --interfaces {interfaces} {}",
                    own.options(law)
                ));
                let there: Vec<&Value> = rows(&made)
                    .iter()
                    .filter(|row| (number(row, &format!("/{name}")) / value - 1.0).abs() < 1e-13)
                    .collect();
                let all = by_hand["result"]["equilibria"].as_array().expect("a list");
                assert!(!there.is_empty() && !all.is_empty(), "{branch} at {value}");
                for one in all {
                    let stress = number(one, "/stress/value") * own.stress();
                    let found = there.iter().min_by(|a, b| {
                        let off = |row: &Value| (number(row, "/stress") - stress).abs();
                        off(a).total_cmp(&off(b))
                    });
                    let row = found.expect("a row");
                    near(number(row, "/stress"), stress, 1e-9, &branch);
                    near(number(row, "/driving"), DRIVING, 1e-13, &branch);
                    near(number(row, "/stiffness"), STIFFNESS, 1e-13, &branch);
                    let verdict = one["verdict"].as_str();
                    assert_eq!(row["verdict"].as_str(), verdict, "{branch} at {value}");
                    // The leading eigenvalue, per second.
                    let eigenvalue = one["eigenvalues"][0][0].as_f64().expect("a number");
                    let growth = number(row, "/ln_abs_multiplier_1");
                    near(growth, eigenvalue / own.time(), 1e-6, &branch);
                    let mut states: Vec<f64> = ["/state_1", "/state_2"]
                        .iter()
                        .filter_map(|name| row.pointer(name)?.as_f64())
                        .collect();
                    states.sort_by(f64::total_cmp);
                    let unit = if law == "spinodal" { 1.0 } else { own.time() };
                    let known = one["state"].as_array().expect("a list");
                    let mut known: Vec<f64> = known
                        .iter()
                        .map(|x| x.as_f64().expect("a number") * unit)
                        .collect();
                    known.sort_by(f64::total_cmp);
                    for (state, known) in states.iter().zip(known) {
                        near(*state, known, 1e-8, &branch);
                    }
                }
            }
        }
    }
}

/// Where K = k L/(a sigma) is that of a Hopf point without units, there is one in SI.
#[test]
fn hopf_points_along_a_unit_are_those_along_the_stiffness() {
    let law = "--law regularised-ageing --interfaces 1";
    let made = object(&format!(
        "branch equilibria {law} --driving 10 --along stiffness=0.01:2"
    ));
    let of = |made: &Value, name: &str| {
        let all = made["result"]["special"].as_array().expect("a list");
        let mut hopf = all.iter().filter(|one| one["label"] == "HB");
        let one = &hopf.next().expect("a Hopf point")[name];
        assert!(hopf.next().is_none());
        [number(one, "/value"), number(one, "/uncertainty")]
    };
    let [critical, by] = of(&made, "stiffness");
    let si =
        format!("branch equilibria --si {law} --driving {DRIVING:?} --stiffness {STIFFNESS:?}");
    for (name, range, known) in [
        (
            "slip_length",
            "1e-7:1e-4",
            critical * PAPER.stress() / STIFFNESS,
        ),
        (
            "normal_stress",
            "1e5:1e8",
            STIFFNESS * PAPER.length / (A * critical),
        ),
    ] {
        let made = object(&format!("{si} --along {name}={range}"));
        let [found, bound] = of(&made, name);
        let allowed = bound + known * (by / critical + 1e-14);
        assert!(
            (found - known).abs() <= allowed,
            "{name}: {found} for {known}"
        );
        assert!(bound < 1e-9 * known, "{name}: {bound}");
    }
}

#[test]
fn orbits_along_a_unit_have_the_periods_at_its_values() {
    for (name, [low, at, high]) in [
        ("slip_length", [0.5e-6, 0.7e-6, 0.9e-6]),
        ("normal_stress", [1e6, 1.3e6, 2e6]),
    ] {
        let made = object(&format!(
            "branch orbits {} --interfaces 1 --along {name}={low:?}:{high:?} --at {at:?}",
            in_si("spinodal")
        ));
        let own = PAPER.with(name, at);
        let by_hand = object(&format!("orbit --interfaces 1 {}", own.options("spinodal")));
        let orbit = &by_hand["result"]["orbit"];
        let landed = rows(&made).iter().find(|row| row["label"] == "UZ");
        let row = landed.expect("a row there");
        near(
            number(row, "/period"),
            number(orbit, "/period/value") * own.time(),
            1e-8,
            name,
        );
        near(
            number(row, "/stress_max"),
            number(orbit, "/stress_max/value") * own.stress(),
            1e-6,
            name,
        );
    }
}

#[test]
fn curves_in_the_plane_of_a_unit_go_through_the_points_at_its_values() {
    let made = object(&format!(
        "locus hopf --si --interfaces 1 --stiffness {STIFFNESS:?} --in slip_length=2e-7:2e-6,driving=1e-8:1e-4 --at slip_length=6e-7"
    ));
    let special = made["result"]["special"].as_array().expect("a list");
    let landed: Vec<&Value> = special.iter().filter(|one| one["label"] == "UZ").collect();
    assert!(!landed.is_empty());
    let own = PAPER.with("slip_length", 6e-7);
    let by_hand = object(&format!(
        "branch equilibria --interfaces 1 --stiffness {:?} --healing-time {:?} --along driving=1e-2:100",
        STIFFNESS * own.length / own.stress(),
        HEALING / own.time()
    ));
    let all = by_hand["result"]["special"].as_array().expect("a list");
    let hopf: Vec<f64> = all
        .iter()
        .filter(|one| one["label"] == "HB")
        .map(|one| number(one, "/driving/value") * RATE)
        .collect();
    assert_eq!(hopf.len(), landed.len());
    for one in landed {
        assert_eq!(number(one, "/slip_length/value"), 6e-7);
        assert_eq!(number(one, "/slip_length/uncertainty"), 0.0);
        let found = number(one, "/driving/value");
        let off = hopf.iter().map(|known| (found / known - 1.0).abs());
        assert!(off.fold(f64::INFINITY, f64::min) < 1e-9, "{found}");
    }
}

#[test]
fn a_unit_of_one_interface_varies_while_the_other_has_its_own() {
    let made = object(&format!(
        "branch equilibria {} --along slip_length_1=0.5um:2um --at 1.2um --set slip_length_2=1.8um",
        in_si("spinodal")
    ));
    let first = Own {
        length: 1.2e-6,
        ..PAPER
    };
    let by_hand = object(&format!(
        "equilibria {} --set slip_length_2=1.5 --set healing_time_2={:?}",
        first.options("spinodal"),
        HEALING / first.time()
    ));
    let all = by_hand["result"]["equilibria"].as_array().expect("a list");
    let there = |row: &&Value| row["label"] == "UZ";
    let stresses: Vec<f64> = rows(&made)
        .iter()
        .filter(there)
        .map(|row| number(row, "/stress"))
        .collect();
    assert_eq!(stresses.len(), all.len());
    for one in all {
        let known = number(one, "/stress/value") * first.stress();
        let off = stresses.iter().map(|found| (found / known - 1.0).abs());
        assert!(off.fold(f64::INFINITY, f64::min) < 1e-9, "{known}");
    }
}

#[test]
fn points_of_a_grid_have_units_of_their_own() {
    for (law, interfaces) in [("spinodal", 2), ("dieterich-ruina", 1)] {
        for (name, [low, _, high]) in VARIED {
            let swept = object(&format!(
                "sweep {} --interfaces {interfaces} --grid {name}={low:?}:{high:?}:2 --starts 1",
                in_si(law)
            ));
            for (row, value) in rows(&swept).iter().zip([low, high]) {
                let own = PAPER.with(name, value);
                // A grid of one point.
                let by_hand = object(&format!(
                    "sweep --interfaces {interfaces} --starts 1 {}",
                    own.options(law)
                ));
                let known = &rows(&by_hand)[0];
                let what = format!("{law} {name} {value}: {row} for {known}");
                near(number(row, &format!("/{name}")), value, 1e-13, &what);
                assert_eq!(row["regime"], known["regime"], "{what}");
                let unit = own.stress();
                near(
                    number(row, "/stress_max"),
                    number(known, "/stress_max") * unit,
                    1e-5,
                    &what,
                );
                if let Some(period) = known["period"].as_f64() {
                    near(number(row, "/period"), period * own.time(), 1e-6, &what);
                }
            }
        }
    }
}

#[test]
fn without_units_a_unit_stays_one() {
    refused(
        "branch equilibria --driving 10 --stiffness 0.1 --along slip_length=1:2",
        "--slip-length is the unit of other numbers and cannot vary without --si; vary --stiffness and --healing-time instead",
    );
    refused(
        "sweep --driving 10 --stiffness 0.1 --grid normal_stress=1:2:2",
        "without --si it is the unit of other numbers and cannot vary",
    );
}

/// Clusters and three interfaces have the units of two.
#[test]
fn clusters_along_a_unit_are_those_at_its_values() {
    for law in ["spinodal", "dieterich-ruina"] {
        for (name, [low, at, high]) in VARIED {
            let made = object(&format!(
                "branch equilibria {} --clusters 1,2 --along {name}={low:?}:{high:?} --at {at:?}",
                in_si(law)
            ));
            for value in [low, at, high] {
                let own = PAPER.with(name, value);
                let stiffness = STIFFNESS * own.length / own.stress();
                let options = own.options(law);
                // The ends of a branch are the equilibria there.
                let by_hand = object(&format!(
                    "branch equilibria {} --clusters 1,2 --along stiffness={stiffness:?}:{:?}",
                    options.replace(&format!("--stiffness {stiffness:?}"), ""),
                    1.01 * stiffness
                ));
                let of = |made: &Value, name: &str, value: f64, unit: f64| -> Vec<f64> {
                    let there = rows(made).iter().filter(|row| {
                        (number(row, &format!("/{name}")) / value - 1.0).abs() < 1e-13
                    });
                    let mut all: Vec<f64> =
                        there.map(|row| number(row, "/stress") * unit).collect();
                    all.sort_by(f64::total_cmp);
                    all.dedup_by(|a, b| (*a / *b - 1.0).abs() < 1e-9);
                    all
                };
                let found = of(&made, name, value, 1.0);
                let known = of(&by_hand, "stiffness", stiffness, own.stress());
                assert!(!known.is_empty());
                assert_eq!(
                    found.len(),
                    known.len(),
                    "{law} {name} {value}: {found:?} for {known:?}"
                );
                for (found, known) in found.iter().zip(known) {
                    near(*found, known, 1e-9, &format!("{law} {name} {value}"));
                }
            }
        }
    }
}

#[test]
fn interfaces_of_a_cluster_may_have_units_of_their_own() {
    let more = "--set slip_length_3=1.8um,normal_stress_2=1.2MPa,direct_effect_2=0.036";
    let made = object(&format!(
        "branch equilibria --si --damping {DAMPING:?} --stiffness {STIFFNESS:?} --interfaces 3 {more} --along driving=5e-6:2e-5 --at {DRIVING:?}"
    ));
    let landed: Vec<&Value> = rows(&made)
        .iter()
        .filter(|row| row["label"] == "UZ")
        .collect();
    assert!(!landed.is_empty());
    for row in landed {
        // tau = n a (law) + eta v of each interface, and the rates add up to V_H.
        let stress = number(row, "/stress");
        let mut total = 0.0;
        for (i, [length, sigma, a]) in [[0.9e-6, 1e6, A], [0.9e-6, 1.2e6, 0.036], [1.8e-6, 1e6, A]]
            .into_iter()
            .enumerate()
        {
            let psi = number(row, &format!("/log_state_{}", i + 1)).exp();
            // dpsi/dt = (1 - psi)/t** - v psi/L
            let v = (1.0 - psi) / psi * length / HEALING;
            let healing = HEALING * RATE / length;
            let (b, a_v, c) = (0.0489_f64, 0.369_f64, 1e-3_f64);
            let gamma = 2.0 * (-a_v / a).exp();
            let strength = (c + (1.0 + healing) * psi).powf(b / a);
            let own = (v / RATE * strength / gamma).asinh() * a * sigma + DAMPING * v;
            near(stress, own, 1e-9, &format!("interface {}", i + 1));
            total += v;
        }
        near(total, DRIVING, 1e-9, "the sum of the rates");
    }
}

#[test]
fn sweeps_and_laws_of_clusters_have_units() {
    let swept = object(&format!(
        "sweep {} --clusters 1,2 --grid slip_length=0.6um:0.9um:2 --starts 1",
        in_si("spinodal")
    ));
    for (row, length) in rows(&swept).iter().zip([0.6e-6, 0.9e-6]) {
        let own = PAPER.with("slip_length", length);
        let by_hand = object(&format!(
            "sweep --clusters 1,2 --starts 1 {}",
            own.options("spinodal")
        ));
        let known = &rows(&by_hand)[0];
        assert_eq!(row["regime"], known["regime"]);
        let [max, by] = [row, known].map(|row| number(row, "/stress_max"));
        near(max, by * own.stress(), 1e-5, "the largest stress");
    }
    let law = |interfaces| object(&format!("law --si --interfaces {interfaces} --points 3"));
    for (three, two) in rows(&law(3)).iter().zip(rows(&law(2))) {
        for name in ["/slip_rate", "/stress", "/critical_stiffness"] {
            near(number(three, name), number(two, name), 1e-12, name);
        }
    }
}

/// A healing time stays in seconds, whatever the unit of times is.
#[test]
fn a_healing_time_along_a_branch_is_in_seconds() {
    let of = |unit: &str| {
        object(&format!(
            "branch equilibria --si --driving 1e-5 --stiffness 6e9 --along healing_time=50:200 --at 90s --time-unit {unit}"
        ))
    };
    let (years, seconds) = (of("year"), of("s"));
    for (row, other) in rows(&years).iter().zip(rows(&seconds)) {
        near(
            number(row, "/healing_time"),
            number(other, "/healing_time"),
            1e-12,
            "t**",
        );
        assert_eq!(row["stress"], other["stress"]);
    }
}

/// Without units the stress is in a_1 sigma_1 and time in L_1/V*, of three interfaces as of two.
#[test]
fn three_interfaces_are_measured_in_units_of_the_first() {
    const K: f64 = 0.2;
    let more = "--set slip_length_3=1.8,normal_stress_2=1.2,direct_effect_2=0.036";
    let made = object(&format!(
        "branch equilibria --interfaces 3 --stiffness {K:?} {more} --along driving=5:20 --at 10"
    ));
    let landed = rows(&made).iter().filter(|row| row["label"] == "UZ");
    let landed: Vec<&Value> = landed.collect();
    assert!(!landed.is_empty());
    for row in landed {
        // tau = n (a/a_1) (law) of each interface, and the rates add up to V_H.
        let stress = number(row, "/stress");
        let mut total = 0.0;
        for (i, [length, n, a]) in [[1.0, 1.0, A], [1.0, 1.2, 0.036], [1.8, 1.0, A]]
            .into_iter()
            .enumerate()
        {
            let psi = number(row, &format!("/log_state_{}", i + 1)).exp();
            // dpsi/dt = (1 - psi)/R - v psi/l
            let v = (1.0 - psi) / psi * length / 100.0;
            let healing = 100.0 / length;
            let (b, a_v, c) = (0.0489_f64, 0.369_f64, 1e-3_f64);
            let gamma = 2.0 * (-a_v / a).exp();
            let strength = (c + (1.0 + healing) * psi).powf(b / a);
            let own = (v * strength / gamma).asinh() * n * a / A;
            near(stress, own, 1e-9, &format!("interface {}", i + 1));
            total += v;
        }
        near(total, 10.0, 1e-9, "the sum of the rates");
    }
}
