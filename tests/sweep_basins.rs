//! `sweep --basin` of any system, and pictures of sweeps along one parameter: against energy, against the basins of equal interfaces and
//! against itself.

use crate::command;
use command::{csv, folder, object, refused_in_one_line as refused, twinslip};
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

type Row = BTreeMap<String, String>;

/// The rows of a sweep, each by the names of its columns.
fn rows(arguments: &str) -> Vec<Row> {
    let ended = twinslip(&format!("sweep -q --format csv {arguments}"));
    assert!(matches!(ended.code, 0 | 3), "{arguments}: {}", ended.err);
    let table = csv(&ended.out);
    let named = |row: &Vec<String>| table[0].iter().cloned().zip(row.iter().cloned()).collect();
    table[1..].iter().map(named).collect()
}

fn number(row: &Row, name: &str) -> f64 {
    let text = &row[name];
    text.parse().unwrap_or_else(|_| panic!("{name}: {row:?}"))
}

fn written(place: &Path, name: &str, text: &str) -> String {
    let path = place.join(name);
    fs::write(&path, text).expect("a file");
    path.display().to_string()
}

/// A damped particle in the potential x^4/4 - x^2/2.
const DOUBLE_WELL: &str = "name = \"double well\"
states = [\"x\", \"y\"]
[parameters]
d = 0.3
[rates]
x = \"y\"
y = \"x - x^3 - d*y\"
";

/// The energy y^2/2 + x^4/4 - x^2/2 falls all the time: what starts below the hill at x = 0 stays in its well. Turning by half a turn
/// changes nothing but the well.
#[test]
fn a_particle_below_the_hill_stays_in_its_well() {
    let file = written(&folder("basin-well"), "well.toml", DOUBLE_WELL);
    let found = rows(&format!(
        "--system {file} --basin --state-1 x=-1.8:1.8:8 --state-2 y=-1.5:1.5:6"
    ));
    assert_eq!(found.len(), 48);
    let mut below = 0;
    for (i, row) in found.iter().enumerate() {
        assert_eq!(row["regime"], "steady", "{row:?}");
        let (x, y) = (number(row, "start_x"), number(row, "start_y"));
        let well = number(row, "x_min");
        assert!((well.abs() - 1.0).abs() < 1e-9, "{row:?}");
        if 0.5 * y * y + 0.25 * x.powi(4) - 0.5 * x * x < 0.0 {
            below += 1;
            assert_eq!(well.signum(), x.signum(), "{row:?}");
        }
        let turned = &found[found.len() - 1 - i];
        assert!((number(turned, "x_min") + well).abs() < 1e-9, "{row:?}");
    }
    assert!(below >= 8, "{below}");
    // The first state varies fastest.
    let start = |i: usize| (number(&found[i], "start_x"), number(&found[i], "start_y"));
    assert_eq!(start(0), (-1.8, -1.5));
    assert!(start(1).0 > -1.8 && start(1).1 == -1.5);
}

/// The law of the paper, as a file has it.
const SPINODAL: &str = include_str!("../scenes/laws/spinodal.toml");

#[test]
fn basins_of_all_ways_to_have_equal_interfaces_agree() {
    let file = written(&folder("basin-law"), "spinodal.toml", SPINODAL);
    let grid = "--driving 0.14 --stiffness 0.3 --basin --state-1 0.05:0.5:2 --state-2 0.08:0.8:2";
    let built_in = rows(grid);
    for more in [
        format!("--law {file}"),
        "--set residual_strength_2=1.0000000001e-3".into(),
    ] {
        let other = rows(&format!("{more} {grid}"));
        assert_eq!(other.len(), built_in.len());
        for (one, other) in built_in.iter().zip(&other) {
            for name in ["regime", "period_of_orbit", "driving", "stiffness"] {
                assert_eq!(one[name], other[name], "{more}: {one:?} {other:?}");
            }
            for name in ["stress_min", "stress_max", "start_state_1", "start_state_2"] {
                let (x, y) = (number(one, name), number(other, name));
                assert!((x / y - 1.0).abs() < 1e-6, "{more}: {name} {x} {y}");
            }
        }
    }
    // By their names, and stress in the place of a state.
    let named = rows(
        &grid
            .replace("--state-1 ", "--state-1 state_1=")
            .replace("--state-2 ", "--state-2 state_2="),
    );
    for (one, other) in built_in.iter().zip(&named) {
        assert_eq!(one["regime"], other["regime"]);
        assert_eq!(one["symmetry"], other["symmetry"]);
    }
    let stress = rows(
        "--driving 0.14 --stiffness 0.4 --basin --state-1 stress=10:11:2 --state-2 state_2=0.1:0.2:2",
    );
    let start = |i: usize, name| number(&stress[i], name);
    assert_eq!(
        (start(1, "start_stress"), start(0, "start_stress")),
        (11.0, 10.0)
    );
    assert!((start(2, "start_state_2") - 0.2).abs() < 1e-15);
}

/// One interface has one attractor.
#[test]
fn all_starts_of_one_interface_lead_to_its_orbit() {
    let found = rows(
        "--interfaces 1 --driving 1 --stiffness 0.2 --basin --state-1 0.01:0.1:2log --state-2 9:11:2",
    );
    let orbit = object("orbit --interfaces 1 --driving 1 --stiffness 0.2");
    let period = command::number(&orbit, "/result/orbit/period/value");
    assert_eq!(found.len(), 4);
    for row in &found {
        assert_eq!(row["regime"], "periodic", "{row:?}");
        assert!((number(row, "period") / period - 1.0).abs() < 1e-7);
    }
    assert_eq!(number(&found[3], "start_stress"), 11.0);
}

#[test]
fn basins_are_drawn_with_what_tells_their_attractors_apart() {
    let place = folder("basin-picture");
    let file = written(&place, "well.toml", DOUBLE_WELL);
    let picture = place.join("basin.svg");
    let ended = twinslip(&format!(
        "sweep -q --system {file} --basin --state-1 x=-1.8:1.8:4 --state-2 y=-1.5:1.5:4 --plot {} --format csv",
        picture.display()
    ));
    assert_eq!(ended.code, 0, "{}", ended.err);
    let svg = fs::read_to_string(picture).expect("drawn");
    for words in [
        "basins of double well",
        "steady, x = 1.000, 50.0 %",
        "steady, x = -1.000, 50.0 %",
        "x at the start",
        "y at the start",
    ] {
        assert!(svg.contains(words), "{words}");
    }
}

#[test]
fn one_parameter_is_drawn_as_a_line() {
    let place = folder("sweep-line");
    let drawn = |arguments: &str, name: &str| {
        let picture = place.join(name);
        let ended = twinslip(&format!(
            "sweep -q {arguments} --plot {} --format csv",
            picture.display()
        ));
        assert_eq!(ended.code, 0, "{arguments}: {}", ended.err);
        fs::read_to_string(picture).expect("drawn")
    };
    let nerve = drawn("--system fitzhugh-nagumo --grid I=0.2:0.5:4", "nerve.svg");
    for words in [
        "regimes at 4 points",
        "least and largest v",
        "steady",
        "periodic",
        "period",
    ] {
        assert!(nerve.contains(words), "{words}");
    }
    let rest = drawn("--system lorenz --grid r=10:20:2", "rest.svg");
    assert!(rest.contains("least and largest x") && !rest.contains("period"));
    let slab = drawn("--driving 0.14:0.3:2 --stiffness 0.4", "slab.svg");
    assert!(slab.contains("least and largest stress") && slab.contains("regimes at 2 points"));
}

/// Whether a file of rows may be gone on with depends on the formulas, and not on how they are laid out.
#[test]
fn a_sweep_is_not_gone_on_with_other_formulas() {
    let place = folder("basin-resume");
    let file = written(&place, "well.toml", DOUBLE_WELL);
    let out = place.join("rows.csv").display().to_string();
    let sweep = format!("sweep -q --system {file} --start 0.1,0 --grid d=0.2:0.4:3");
    let ended = twinslip(&format!("{sweep} -o {out}"));
    assert_eq!(ended.code, 0, "{}", ended.err);
    let whole = fs::read_to_string(&out).expect("rows");
    let cut = |text: &str| {
        fs::write(&out, &whole[..whole.len() - 30]).expect("written");
        written(&place, "well.toml", text);
    };
    cut(&DOUBLE_WELL
        .replace("x - x^3 - d*y", "x  -  x^3-d*y")
        .replace("[rates]", "# why\n[rates]"));
    let ended = twinslip(&format!("{sweep} --resume {out}"));
    assert_eq!((ended.code, ended.err.as_str()), (0, ""));
    assert_eq!(fs::read_to_string(&out).expect("rows"), whole);
    cut(&DOUBLE_WELL.replace("x^3", "x^5"));
    refused(
        &format!("{sweep} --resume {out}"),
        "it was written with other formulas: the file of the system or law has changed since",
    );
    // So it is of branches, and of laws.
    let law = written(&place, "law.toml", SPINODAL);
    let rows = place.join("branch.csv").display().to_string();
    let branch = format!("branch equilibria -q --law {law} --stiffness 0.3 --from 0.1 --to 1");
    let ended = twinslip(&format!("{branch} -o {rows}"));
    assert_eq!(ended.code, 0, "{}", ended.err);
    written(&place, "law.toml", &SPINODAL.replace("2*exp", "2.5*exp"));
    refused(
        &format!("{branch} --resume {rows}"),
        "it was written with other formulas",
    );
}

#[test]
fn what_is_no_basin_is_refused_in_one_sentence() {
    for (arguments, sentence) in [
        (
            "--system lorenz --basin --state-1 x=0:1:2 --state-2 y=0:1:2 --grid r=1:2:2",
            "with --basin only the starts vary; give r a single value",
        ),
        (
            "--system lorenz --basin --state-1 x=0:1:2 --state-2 0:1:2",
            "--state-2 \"0:1:2\" must be NAME=A:B:N, NAME one of x, y, z",
        ),
        (
            "--system lorenz --basin --state-1 x=0:1:2 --state-2 q=0:1:2",
            "state-2 is q, but must be x, y or z",
        ),
        (
            "--system lorenz --basin --state-1 x=0:1:2 --state-2 x=0:1:2",
            "--state-1 and --state-2 are both of x",
        ),
        (
            "--interfaces 1 --driving 0.1 --stiffness 0.1:0.2:2 --basin --state-1 0.1:0.2:2 --state-2 9:10:2",
            "give stiffness a single value",
        ),
        (
            "--interfaces 1 --driving 0.1 --stiffness 0.1 --basin --state-1 -0.1:0.2:2 --state-2 9:10:2",
            "state_1 is -0.1, but must be positive",
        ),
    ] {
        refused(&format!("sweep {arguments}"), sentence);
    }
}
