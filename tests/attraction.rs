//! Balls around stable equilibria that no run leaves, and what sweeps make of them.
#![allow(missing_docs)]

use crate::command;
use command::{csv, folder, twinslip};
use std::borrow::Cow;
use std::fs;
use twinslip::equilibrium::LyapunovBall;
use twinslip::field::Vector;
use twinslip::integrate::AnyField;
use twinslip_tasks::scene::SystemFile;

const DOUBLE_WELL: &str = "name = \"double well\"
states = [\"x\", \"y\"]
[rates]
x = \"y\"
y = \"x - x^3 - 0.3*y\"
";

fn point(x: f64, y: f64) -> Vector {
    Vector::from_vec(vec![x, y])
}

/// The function falls along the field at all points within, and the saddle at the origin is without.
#[test]
fn the_function_falls_all_over_its_ball() {
    let well = SystemFile::parse("well", DOUBLE_WELL)
        .expect("a system")
        .system;
    let field = AnyField::of_text(Cow::Borrowed(&well)).expect("a field");
    let ball = LyapunovBall::around(&well, &point(1.0, 0.0)).expect("a ball");
    assert!((ball.equilibrium() - point(1.0, 0.0)).amax() < 1e-15);
    assert!(ball.holds(&[1.02, 0.0]) && ball.holds(&[1.0, -0.02]));
    assert!(!ball.holds(&[0.0, 0.0]));
    let mut within = 0;
    for i in 0..4000 {
        let (angle, distance) = (0.37 * f64::from(i), f64::from(i) / 4000.0);
        let at = point(1.0 + distance * angle.cos(), distance * angle.sin());
        if !ball.holds(at.as_slice()) || distance == 0.0 {
            continue;
        }
        within += 1;
        let h = 1e-6;
        let later = &at + field.f(&at) * h;
        let rate = (ball.value(later.as_slice()) - ball.value(at.as_slice())) / h;
        assert!(rate < 0.0, "{at} {rate}");
    }
    assert!(within > 50, "{within}");
}

#[test]
fn unstable_equilibria_have_no_ball() {
    let well = SystemFile::parse("well", DOUBLE_WELL)
        .expect("a system")
        .system;
    assert!(LyapunovBall::around(&well, &point(0.0, 0.0)).is_none());
    assert!(LyapunovBall::around(&well, &point(0.5, 0.3)).is_none());
}

/// A focus that draws its runs in by a part in a million a turn, or less: they are not followed to it. One that pushes them off is no rest.
#[test]
fn a_weak_focus_is_rest_for_certain() {
    let path = folder("attraction-focus").join("focus.toml");
    let text = "name = \"focus\"\nstates = [\"x\", \"y\"]\n[parameters]\ne = 1e-7\n[rates]\nx = \"-e*x - y\"\ny = \"x - e*y\"\n[start]\nx = 0.3\ny = 0.0\n";
    fs::write(&path, text).expect("a file");
    let ended = twinslip(&format!(
        "sweep -q --system {} --grid e=-1e-7:1e-7:3 --max-returns 400 --format csv",
        path.display()
    ));
    assert_eq!(ended.code, 3, "{}", ended.err);
    let rows = csv(&ended.out);
    let place = |name: &str| {
        rows[0]
            .iter()
            .position(|known| known == name)
            .expect("a column")
    };
    let regimes: Vec<&str> = rows[1..]
        .iter()
        .map(|row| row[place("regime")].as_str())
        .collect();
    assert_eq!(regimes, ["undecided", "undecided", "steady"]);
    let returns: usize = rows[3][place("returns")].parse().expect("a number");
    assert!(returns < 100, "{returns}");
}
