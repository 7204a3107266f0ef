//! Branch points of equilibria at which several eigenvalues are 0 together: all branches that algebra gives, each once.

use crate::command::{self, folder, number};
use serde_json::Value;

fn branch(arguments: &str) -> Value {
    let ended = command::twinslip(&format!("branch equilibria {arguments} --format json -q"));
    assert_eq!(ended.code, 0, "{arguments}: {}", ended.err);
    serde_json::from_str(&ended.out).expect("JSON")
}

fn points<'v>(made: &'v Value, label: &str) -> Vec<&'v Value> {
    let all = made["result"]["special"]
        .as_array()
        .expect("special points");
    all.iter().filter(|one| one["label"] == label).collect()
}

/// The states of all rows at a value of the parameter with the label `EP`, in ascending order.
fn ends(made: &Value, (parameter, value): (&str, f64), states: &[&str]) -> Vec<Vec<f64>> {
    let rows = made["result"]["rows"].as_array().expect("rows").iter();
    let ends = rows.filter(|row| row["label"] == "EP" && row[parameter] == value);
    let state = |row: &Value| {
        states
            .iter()
            .map(|name| number(row, &format!("/{name}")))
            .collect()
    };
    let mut ends: Vec<Vec<f64>> = ends.map(state).collect();
    sort(&mut ends);
    ends
}

fn sort(states: &mut [Vec<f64>]) {
    let rounded =
        |state: &[f64]| -> Vec<i64> { state.iter().map(|x| (x * 1e6).round() as i64).collect() };
    states.sort_by_key(|state| rounded(state));
}

#[track_caller]
fn are(found: &[Vec<f64>], truth: &[Vec<f64>], what: &str) {
    let mut truth = truth.to_vec();
    sort(&mut truth);
    assert_eq!(found.len(), truth.len(), "{what}: {found:?}");
    for (found, truth) in found.iter().zip(&truth) {
        let off = found.iter().zip(truth).map(|(a, b)| (a - b).abs());
        assert!(
            off.fold(0.0, f64::max) < 1e-9,
            "{what}: {found:?}, not {truth:?}"
        );
    }
}

/// All branch points are this one, in its bound, with its multiplicity, and all is whole.
#[track_caller]
fn meet_at(made: &Value, (parameter, value): (&str, f64), multiplicity: u64, count: usize) {
    let all = points(made, "BP");
    assert!(!all.is_empty());
    for point in all {
        let at = number(point, &format!("/{parameter}/value"));
        let off = number(point, &format!("/{parameter}/uncertainty"));
        assert!((at - value).abs() <= off && off < 1e-11, "{at} +- {off}");
        assert_eq!(point["multiplicity"], multiplicity);
        let note = format!("{multiplicity} zero eigenvalues; branches that begin here: {count}");
        assert_eq!(point["note"], note);
    }
    for label in ["MX", "LP", "HB"] {
        assert!(points(made, label).is_empty(), "{label}: {made}");
    }
}

/// Two of the eigenvalues g - 1, g - 1, -2 g - 1 of the origin are 0 at g = 1. With (u, v, w) = (a, -b, c) the equations are symmetric in
/// the exchange of all three and in the sign: six branches and their mirror images, of which three have two equal numbers and three a zero.
#[test]
fn twelve_branches_begin_where_a_network_begins_to_decide() {
    let system = "--system tests/data/cases/hopfield-three.toml --along g --from 0.2 --to 3";
    for more in [
        "",
        "--box a=-3:3,b=-3:3,c=-3:3",
        "--start 0,0,0",
        "--step-limit 0.5",
    ] {
        let made = branch(&format!("{system} {more}"));
        meet_at(&made, ("g", 1.0), 2, 12);
        let found = ends(&made, ("g", 3.0), &["a", "b", "c"]);
        assert_eq!(found.len(), 13, "{more}: {found:?}");
        for (i, state) in found.iter().enumerate() {
            let apart = |other: &Vec<f64>| {
                let off = state.iter().zip(other).map(|(a, b)| (a - b).abs());
                off.fold(0.0, f64::max) > 1e-3
            };
            assert!(found[..i].iter().all(apart), "{more}: twice {state:?}");
            // With a state its mirror image, and those with the variables exchanged.
            let [a, b, c] = state[..] else { panic!() };
            for image in [[-a, -b, -c], [-b, -a, c], [c, b, a]] {
                let is =
                    |other: &&Vec<f64>| other.iter().zip(image).all(|(x, y)| (x - y).abs() < 1e-9);
                assert!(found.iter().any(|other| is(&other)), "{more}: no {image:?}");
            }
        }
    }
}

/// On the axes l = x^2, on the diagonals l = 3 x^2.
#[test]
fn eight_branches_begin_at_the_pitchforks_of_a_square() {
    let system = "--system tests/data/cases/pitchforks-of-a-square.toml --along l --from -1 --to 1";
    let third = (1.0_f64 / 3.0).sqrt();
    let mut truth = vec![vec![0.0, 0.0]];
    for sign in [1.0, -1.0] {
        truth.extend([vec![sign, 0.0], vec![0.0, sign]]);
        truth.extend([vec![sign * third, third], vec![sign * third, -third]]);
    }
    for more in ["", "--box x=-2:2,y=-2:2", "--start 1,0", "--step-limit 2"] {
        let made = branch(&format!("{system} {more}"));
        meet_at(&made, ("l", 0.0), 2, 8);
        are(&ends(&made, ("l", 1.0), &["x", "y"]), &truth, more);
        are(&ends(&made, ("l", -1.0), &["x", "y"]), &truth[..1], more);
    }
}

/// z' = l z + conj(z)^2: z = -l and what is turned by a third of a circle.
#[test]
fn three_lines_cross_at_a_point_of_triangular_symmetry() {
    let system = "--system tests/data/cases/crossing-of-a-triangle.toml --along l --from -1 --to 1";
    let half = 0.75_f64.sqrt();
    let truth = |l: f64| {
        let [x, y] = [-l, l * half];
        vec![
            vec![0.0, 0.0],
            vec![x, 0.0],
            vec![-0.5 * x, y],
            vec![-0.5 * x, -y],
        ]
    };
    for more in [
        "",
        "--box x=-2:2,y=-2:2",
        "--start 1,0",
        "--start 0.5,0.8660254037844386",
    ] {
        let made = branch(&format!("{system} {more}"));
        meet_at(&made, ("l", 0.0), 2, 6);
        for l in [-1.0, 1.0] {
            are(&ends(&made, ("l", l), &["x", "y"]), &truth(l), more);
        }
    }
}

/// Three pitchforks that know nothing of each other, in variables of which each is a mixture, at a state and a parameter that are no round numbers: 3^3 - 1 branches
/// begin at one point.
#[test]
fn all_branches_begin_where_three_eigenvalues_are_zero() {
    let file = folder("three-pitchforks").join("system.toml");
    let text = "name = \"three pitchforks\"\nstates = [\"x\", \"y\", \"z\"]\n[parameters]\nl = -1.0\n[rates]
x = \"m*u - u^3 - 0.3*(m*v - v^3)\"\ny = \"m*v - v^3 + 0.2*(m*w - w^3)\"\nz = \"m*w - w^3\"
[where]\nm = \"l - 0.137\"\nw = \"z - 0.3*l\"\nv = \"y - 0.2*z + 0.06*l\"\nu = \"x + 0.3*(y - 0.2*z + 0.06*l)\"
[start]\nx = 0.0\ny = -0.0\nz = -0.3\n";
    std::fs::write(&file, text).expect("a file");
    let made = branch(&format!(
        "--system {} --along l --from -1 --to 1.137",
        file.display()
    ));
    let all = points(&made, "BP");
    assert!(!all.is_empty() && points(&made, "MX").is_empty());
    for point in all {
        let (at, off) = (number(point, "/l/value"), number(point, "/l/uncertainty"));
        assert!((at - 0.137).abs() <= off && off < 1e-11, "{at} +- {off}");
        assert_eq!(point["multiplicity"], 3);
    }
    let mut truth = Vec::new();
    for i in 0..27 {
        let [u, v, w] = [i % 3, i / 3 % 3, i / 9].map(|digit| f64::from(digit) - 1.0);
        let z = w + 0.3 * 1.137;
        let y = v + 0.2 * z - 0.06 * 1.137;
        truth.push(vec![u - 0.3 * v, y, z]);
    }
    are(&ends(&made, ("l", 1.137), &["x", "y", "z"]), &truth, "ends");
}

/// A crossing of one eigenvalue has the multiplicity 1; of two Hopf pairs each point is one of two.
#[test]
fn the_multiplicity_of_hopf_points_and_of_simple_ones_is_told() {
    let made =
        branch("--system tests/data/cases/two-hopf-pairs.toml --along m --from -0.5 --to 0.5");
    let pairs = points(&made, "HB");
    assert_eq!(pairs.len(), 2);
    for pair in &pairs {
        assert_eq!(pair["multiplicity"], 2);
        assert!(number(pair, "/m/value").abs() <= number(pair, "/m/uncertainty"));
    }
    let tau = std::f64::consts::TAU;
    let mut periods: Vec<f64> = pairs
        .iter()
        .map(|one| number(one, "/period/value"))
        .collect();
    periods.sort_by(f64::total_cmp);
    assert!((periods[0] - tau / 1.7).abs() < 1e-9 && (periods[1] - tau).abs() < 1e-9);
    let made =
        branch("--system tests/data/cases/chemostat-wash-out.toml --along D --from 0.1 --to 0.98");
    let simple = points(&made, "BP");
    assert!(!simple.is_empty() && simple.iter().all(|one| one["multiplicity"] == 1));
    assert!(
        points(&made, "EP")
            .iter()
            .all(|one| one["multiplicity"].is_null())
    );
}
