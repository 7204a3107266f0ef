//! Bifurcation diagrams by brute force: what a state comes back to on the attractors of a sweep.

use crate::command::{folder, number, object_or_undecided, refused_in_one_line, twinslip};
use serde_json::Value;

/// The rows of a diagram at a value of its parameter.
fn at<'a>(made: &'a Value, name: &str, value: f64) -> Vec<&'a Value> {
    let rows = made["result"]["rows"].as_array().expect("rows").iter();
    let near = |row: &&Value| (number(row, &format!("/{name}")) - value).abs() < 1e-9;
    rows.filter(near).collect()
}

#[test]
fn maxima_are_as_many_as_the_turns_of_the_orbit() {
    let made = object_or_undecided("sweep --system roessler --grid c=2.5:5.5:13 --diagram x");
    // Of one period, of two and of four.
    for (c, count) in [(2.5, 1), (3.5, 2), (4.0, 4)] {
        let rows = at(&made, "c", c);
        assert_eq!(rows.len(), count, "{rows:?}");
        assert!(rows.iter().all(|row| row["regime"] == "periodic"));
        if count > 2 {
            continue;
        }
        let orbit = object_or_undecided(&format!("orbit --system roessler --set c={c}"));
        let most = number(&orbit["result"]["orbit"], "/extremes/x/max/value");
        let largest = rows.iter().map(|row| number(row, "/x"));
        let off = (largest.fold(f64::NEG_INFINITY, f64::max) / most - 1.0).abs();
        assert!(off < 1e-6, "c = {c}: {off}");
    }
    // Chaos has many, all of them different.
    let rows = at(&made, "c", 5.0);
    assert!(
        rows.len() > 100 && rows[0]["regime"] == "chaotic",
        "{}",
        rows.len()
    );
    let mut values: Vec<f64> = rows.iter().map(|row| number(row, "/x")).collect();
    values.sort_by(f64::total_cmp);
    assert!(values.windows(2).all(|pair| pair[0] < pair[1]));
}

#[test]
fn steady_states_have_their_value_and_interfaces_their_stress() {
    let made = object_or_undecided("sweep --system lorenz --grid r=0.5:10:2 --diagram z");
    let [rest] = at(&made, "r", 10.0)[..] else {
        panic!("{made}");
    };
    assert!((number(rest, "/z") - 9.0).abs() < 1e-9, "{rest}");
    assert_eq!(rest["n"], 1);
    let made = object_or_undecided("sweep --driving 0.09:0.09:1 --stiffness 0.14 --diagram stress");
    let orbit = object_or_undecided("orbit --driving 0.09 --stiffness 0.14");
    let most = number(&orbit["result"]["orbit"], "/stress_max/value");
    let rows = made["result"]["rows"].as_array().expect("rows");
    let largest = rows.iter().map(|row| number(row, "/stress"));
    let largest = largest.fold(f64::NEG_INFINITY, f64::max);
    assert!((largest / most - 1.0).abs() < 1e-6, "{largest} for {most}");
}

#[test]
fn under_a_forcing_values_are_those_once_a_period() {
    let words = "--system duffing --set omega=1.2 --set gamma=0.25";
    let made = object_or_undecided(&format!(
        "sweep {words} --grid delta=0.25:0.3:2 --diagram x"
    ));
    let rows = at(&made, "delta", 0.25);
    assert_eq!(rows.len(), 2, "{rows:?}");
    let orbit = object_or_undecided(&format!("orbit {words} --turns 2"));
    let orbit = &orbit["result"]["orbit"];
    let first = number(orbit, "/point/0");
    let near = rows.iter().map(|row| (number(row, "/x") - first).abs());
    assert!(
        near.fold(f64::INFINITY, f64::min) < 1e-6,
        "{first}: {rows:?}"
    );
}

/// Each start has its rows, and a picture is drawn; what is of regimes is refused.
#[test]
fn diagrams_are_written_and_drawn() {
    let place = folder("diagrams");
    let (rows, picture) = (place.join("dots.csv"), place.join("dots.svg"));
    let made = twinslip(&format!(
        "sweep --system roessler --grid c=2.5:3:3 --starts 2 --diagram x -o {} --plot {}",
        rows.display(),
        picture.display()
    ));
    assert_eq!(made.code, 0, "{}", made.err);
    let text = std::fs::read_to_string(&rows).expect("rows");
    let head = text
        .lines()
        .find(|line| !line.starts_with('#'))
        .expect("names");
    assert_eq!(head, "c,start,n,x,regime,row_check");
    assert!(
        std::fs::read_to_string(&picture)
            .expect("a picture")
            .contains("maxima of x")
    );
    for (words, sentence) in [
        (
            "--grid c=2:3:2 --diagram w",
            "diagram is w, but must be x, y or z",
        ),
        (
            "--grid c=2:3:2 --diagram x --lyapunov",
            "leave one of them out",
        ),
        (
            "--grid c=2:3:2 --grid a=0.1:0.2:2 --diagram x --plot dots.svg",
            "over one parameter",
        ),
    ] {
        refused_in_one_line(&format!("sweep --system roessler {words}"), sentence);
    }
}

/// The command in a file is that of the rows, with all that changes them.
#[test]
fn the_command_in_a_file_has_every_option() {
    let words = "sweep --interfaces 1 --law ageing --driving 1:1.5:2 --stiffness 0.6 --damping 1e-2 --second-evolution-effect 0.002 --second-slip-length 3 --modulate driving=0.1:5 --modulate normal_stress=0.05:5:0.25 --normal-stress-coupling 0.2";
    let first = twinslip(&format!("{words} -q"));
    let command = first
        .out
        .lines()
        .find_map(|line| line.strip_prefix("# command: twinslip "));
    let again = twinslip(&format!("{} -q", command.expect("a command")));
    assert_eq!(first.out, again.out);
    assert_eq!(first.code, again.code);
}
