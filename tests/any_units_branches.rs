//! Branches of orbits and curves of bifurcations in any units, of states, parameters and time: the same points in the same order.

use crate::command;
use crate::common::in_units::{Scaled, drawn, own};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use serde_json::Value;

/// A value with its bound, as far as both are told.
type Told = Option<(f64, f64)>;

/// What a command tells: its exit status, how many rows, and of each special point the number of its curve, its label, the parameters and
/// the period, in the system's own units.
#[derive(Debug)]
struct Found {
    code: i32,
    rows: usize,
    points: Vec<(u64, String, Vec<Told>)>,
}

fn told(value: &Value, unit: f64) -> Told {
    let known = value["value"].as_f64()?;
    // Where no bound is told, any will do.
    let off = value["uncertainty"].as_f64().unwrap_or(f64::INFINITY);
    Some((unit * known, unit * off))
}

fn found(system: &Scaled, command: &str, parameters: &[&str]) -> Found {
    let ended = command::twinslip(&format!("{command} --format json -q"));
    let made: Value = serde_json::from_str(&ended.out)
        .unwrap_or_else(|error| panic!("{command}: {error}: {}", ended.err));
    let result = &made["result"];
    let special = result["special"].as_array().expect("a list").iter();
    let points = special.map(|one| {
        let number = one["branch"].as_u64().or(one["curve"].as_u64());
        let label = one["label"].as_str().expect("a label").to_owned();
        let at = parameters
            .iter()
            .map(|&name| told(&one[name], system.of(name)));
        // At a double zero the period is beyond all bounds, or rounding.
        let period = told(&one["period"], system.time).filter(|_| label != "BT");
        (
            number.expect("a number"),
            label,
            at.chain([period]).collect(),
        )
    });
    Found {
        code: ended.code,
        rows: result["rows"].as_array().expect("rows").len(),
        points: points.collect(),
    }
}

/// What both tell is the same but for their bounds, with about as many rows.
fn are_same(name: &str, a: &Found, b: &Found) {
    const ROWS: f64 = 1.3;
    let both = || format!("{name}: {a:#?} {b:#?}");
    assert_eq!(a.code, b.code, "{}", both());
    assert_eq!(a.points.len(), b.points.len(), "{}", both());
    for (x, y) in a.points.iter().zip(&b.points) {
        assert_eq!((x.0, &x.1), (y.0, &y.1), "{}", both());
        for pair in x.2.iter().zip(&y.2) {
            let (Some(x), Some(y)) = pair else {
                assert_eq!(pair.0.is_some(), pair.1.is_some(), "{}", both());
                continue;
            };
            // The ends of ranges are exact, but for their rounding in another unit.
            let told = x.1 + y.1 + 2.0 * f64::EPSILON * x.0.abs();
            assert!((x.0 - y.0).abs() <= told, "{x:?} {y:?} {}", both());
        }
    }
    let more = b.rows as f64 / a.rows as f64;
    assert!((1.0 / ROWS..=ROWS).contains(&more), "{}", both());
}

/// Models of all kinds, and classical oscillators: from Hopf points to others, through folds and doublings, or from an orbit that is found.
#[test]
fn branches_of_orbits_are_the_same_in_any_units() {
    const ALL: [(&str, &str, f64, f64); 48] = [
        ("chemostat-ciliate", "D", 0.03, 0.1),
        ("circadian-per", "hr", 2520.0, 4680.0),
        ("colpitts", "R", 40.0, 200.0),
        ("connor-stevens", "I", 100.0, 500.0),
        ("cstr", "tau", 40.0, 80.0),
        ("cstr", "Tc", 295.0, 315.0),
        ("goldbeter-lefever", "v", 0.1, 1.5),
        ("goldbeter-mitotic", "mi", 42.0, 78.0),
        ("goodwin", "b", 0.3, 0.8),
        ("hastings-powell", "ba", 1.8, 2.6),
        ("holling-tanner", "b", 0.02, 0.4),
        ("jansen-rit", "p", 50.0, 350.0),
        ("lengyel-epstein", "b", 1.0, 5.0),
        ("li-rinzel", "ip", 2e-07, 8e-07),
        ("loladze", "b", 0.84, 1.56),
        ("mckean", "a", 0.175, 0.325),
        ("morris-lecar-si", "I", 0.2, 6.0),
        ("nf-kb", "A", 0.0049, 0.0091),
        ("repressilator", "al", 5.0, 300.0),
        ("rosenzweig-macarthur", "K", 100.0, 600.0),
        ("selkov", "b", 0.3, 1.1),
        ("sherman-beta-cell", "tau", 14.0, 26.0),
        ("stribeck-belt", "m", 0.7, 1.3),
        ("tsodyks-markram", "tau", 0.0091, 0.0169),
        ("tunnel-diode", "E", 0.05, 0.5),
        ("wang-buzsaki", "I", 0.5, 8.0),
        ("watt-governor", "ep", 0.5, 1.5),
        ("wheel-shimmy", "V", 20.0, 120.0),
        ("wien-bridge", "R", 7000.0, 13000.0),
        ("wilson-cowan", "P", 0.5, 2.5),
        ("wilson-cowan", "tau", 0.0056, 0.0104),
        ("cases/brusselator-stiff", "B", 1.5, 12.0),
        ("cases/goldbeter-cycle", "vi", 0.005, 0.095276),
        ("cases/morris-lecar-cycle", "I", 80.0, 230.0),
        ("oscillators/ab-reaction", "D", 0.01, 0.4),
        ("oscillators/adaptive-control", "alpha", 0.2, 1.5),
        ("oscillators/bazykin", "delta", 0.01, 0.5),
        ("oscillators/co-oxidation", "k2", 0.5, 2.0),
        ("oscillators/enzyme-cell", "rho", 1.0, 15.0),
        ("oscillators/hodgkin-huxley-warm", "I", 1.0, 250.0),
        ("oscillators/koper", "l", -8.0, 8.0),
        ("oscillators/langford", "l", -1.0, 3.0),
        ("oscillators/peroxidase", "k1", 0.05, 0.4),
        ("npz", "d", 0.5, 2.0),
        ("herd-sqrt", "d", 0.45, 0.75),
        ("cases/fitzhugh-nagumo-canard", "I", 0.1, 1.6),
        ("oscillators/chua-smooth", "alpha", 1.0, 20.0),
        ("oscillators/food-chain", "p", 0.01, 1.0),
    ];
    let mut random = ChaCha8Rng::seed_from_u64(53);
    // Every other one, others each time.
    let half = crate::common::random() as usize % 2;
    for (name, along, from, to) in ALL.into_iter().skip(half).step_by(2) {
        let systems = [own(name), drawn("orbits", name, &mut random)];
        let [a, b] = systems.each_ref().map(|system| {
            let command = format!(
                "branch orbits --system {} --along {along} --from {} --to {}",
                system.file,
                system.inward(along, from),
                system.inward(along, to)
            );
            found(system, &command, &[along])
        });
        are_same(name, &a, &b);
    }
}

/// Each curve from its end with the lesser first parameter on: which way it is told may be a matter of rounding.
fn turned(mut found: Found) -> Found {
    for curve in found.points.chunk_by_mut(|a, b| a.0 == b.0) {
        let first = |point: &(u64, String, Vec<Told>)| point.2[0].map_or(f64::NAN, |x| x.0);
        if curve.first().map(first) > curve.last().map(first) {
            curve.reverse();
        }
    }
    found
}

/// Folds and Hopf points of equilibria, folds and tori of orbits, with what is special on them.
#[test]
fn curves_are_the_same_in_any_units() {
    type Range = (&'static str, f64, f64);
    const ALL: [(&str, &str, Range, Range); 34] = [
        ("selkov", "hopf", ("a", 0.01, 0.13), ("b", 0.2, 1.1)),
        ("goodwin", "hopf", ("n", 8.0, 16.0), ("b", 0.2, 0.9)),
        ("holling-tanner", "hopf", ("a", 0.5, 2.0), ("b", 0.02, 0.4)),
        (
            "goldbeter-lefever",
            "hopf",
            ("v", 0.1, 1.5),
            ("ks", 0.02, 0.3),
        ),
        ("lengyel-epstein", "hopf", ("a", 5.0, 20.0), ("b", 0.5, 6.0)),
        (
            "li-rinzel",
            "hopf",
            ("ip", 2e-07, 8e-07),
            ("ct", 1e-06, 3e-06),
        ),
        ("jansen-rit", "hopf", ("p", 50.0, 350.0), ("A", 2.5, 4.0)),
        (
            "jansen-rit",
            "saddle-node",
            ("p", 0.0, 350.0),
            ("A", 2.5, 4.0),
        ),
        (
            "morris-lecar-si",
            "hopf",
            ("I", 0.2, 6.0),
            ("gca", 30.0, 60.0),
        ),
        ("repressilator", "hopf", ("al", 5.0, 300.0), ("n", 1.5, 3.0)),
        (
            "rosenzweig-macarthur",
            "hopf",
            ("K", 100.0, 600.0),
            ("d", 0.2, 0.65),
        ),
        (
            "hastings-powell",
            "hopf",
            ("ba", 1.5, 4.0),
            ("bb", 1.5, 3.0),
        ),
        (
            "tsodyks-markram",
            "hopf",
            ("I0", -1.8, -1.0),
            ("J", 2.5, 3.5),
        ),
        (
            "tsodyks-markram",
            "saddle-node",
            ("I0", -1.8, -1.0),
            ("J", 2.5, 3.5),
        ),
        ("tunnel-diode", "hopf", ("E", 0.05, 0.5), ("R", 5.0, 40.0)),
        (
            "tunnel-diode",
            "saddle-node",
            ("E", 0.05, 0.6),
            ("R", 5.0, 400.0),
        ),
        ("watt-governor", "hopf", ("al", 0.3, 1.0), ("ep", 0.5, 1.5)),
        (
            "wheel-shimmy",
            "hopf",
            ("V", 20.0, 120.0),
            ("c", -200000.0, -50000.0),
        ),
        ("wilson-cowan", "hopf", ("P", 0.5, 2.5), ("ae", 1.0, 1.6)),
        (
            "wilson-cowan",
            "saddle-node",
            ("P", 0.3, 2.5),
            ("ae", 1.0, 1.6),
        ),
        ("cstr", "hopf", ("tau", 40.0, 90.0), ("Tc", 295.0, 315.0)),
        (
            "cstr",
            "saddle-node",
            ("tau", 40.0, 90.0),
            ("Tc", 295.0, 315.0),
        ),
        (
            "chemostat-ciliate",
            "hopf",
            ("D", 0.03, 0.1),
            ("s", 0.1, 0.7),
        ),
        ("npz", "hopf", ("d", 0.5, 2.0), ("Nd", 0.3, 1.5)),
        (
            "sherman-beta-cell",
            "hopf",
            ("lam", 0.5, 1.2),
            ("gs", 2.0, 6.0),
        ),
        (
            "oscillators/bazykin",
            "hopf",
            ("delta", 0.01, 0.5),
            ("alpha", 0.1, 0.6),
        ),
        (
            "oscillators/co-oxidation",
            "hopf",
            ("k2", 0.5, 2.0),
            ("K", 0.2, 0.6),
        ),
        (
            "oscillators/co-oxidation",
            "saddle-node",
            ("k2", 0.5, 2.0),
            ("K", 0.2, 0.6),
        ),
        (
            "oscillators/ab-reaction",
            "hopf",
            ("D", 0.01, 0.4),
            ("beta", 1.5, 4.0),
        ),
        (
            "oscillators/ab-reaction",
            "saddle-node",
            ("D", 0.01, 0.4),
            ("beta", 1.5, 4.0),
        ),
        (
            "oscillators/koper",
            "hopf",
            ("l", -8.0, 8.0),
            ("k", -15.0, -5.0),
        ),
        (
            "tsodyks-markram",
            "orbit-saddle-node",
            ("tau", 0.0091, 0.0169),
            ("J", 3.0, 3.2),
        ),
        (
            "oscillators/langford",
            "torus",
            ("l", -1.0, 3.0),
            ("a", 0.7, 1.1),
        ),
        (
            "li-rinzel",
            "orbit-saddle-node",
            ("ip", 2e-07, 8e-07),
            ("ct", 1.8e-06, 2.2e-06),
        ),
    ];
    let mut random = ChaCha8Rng::seed_from_u64(54);
    for (name, kind, first, second) in ALL {
        let systems = [own(name), drawn(kind, name, &mut random)];
        let [a, b] = systems.each_ref().map(|system| {
            let range = |(name, from, to): Range| {
                let [from, to] = [from, to].map(|x| system.inward(name, x));
                format!("--range {name}={from},{to}")
            };
            let command = format!(
                "locus {kind} --system {} --in {},{} {} {}",
                system.file,
                first.0,
                second.0,
                range(first),
                range(second)
            );
            turned(found(system, &command, &[first.0, second.0]))
        });
        are_same(&format!("{kind} of {name}"), &a, &b);
    }
}
