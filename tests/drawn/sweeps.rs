//! Pictures of sweeps say what was found: colours, legends, stripes, numbers of attractors.
#![allow(missing_docs)]

use crate::drawn::{self, Seen, seen};
use resvg::usvg::Rect;
use twinslip::bifurcation::LocusRow;
use twinslip::equilibrium::Symmetry;
use twinslip::number::Uncertain;
use twinslip::section::Regime;
use twinslip_tasks::scene::Units;
use twinslip_tasks::views::{GridSide, PointOutcome, basin_map, regime_map};

const TORUS: [u8; 3] = [182, 168, 113];
const PERIOD_3: [u8; 3] = [182, 71, 132];

fn outcome(
    number: usize,
    regime: Regime,
    symmetry: Option<Symmetry>,
    returns: usize,
) -> PointOutcome {
    PointOutcome {
        number,
        regime,
        symmetry,
        returns_per_period: (regime == Regime::Periodic).then_some(returns),
        period: None,
        stress_range: None,
        lyapunov_max: None,
    }
}

fn side(from: f64, to: f64, count: usize) -> GridSide {
    GridSide {
        values: drawn::numbers(from, to, count),
        log: false,
    }
}

/// Where a colour is in the frame.
fn filled(seen: &Seen, colour: [u8; 3]) -> Vec<Rect> {
    let frame = seen.frames()[0];
    let shapes = seen.shapes.iter();
    let of_colour = shapes.filter(|shape| shape.fill == Some(colour));
    let places = of_colour.map(|shape| shape.place);
    places
        .filter(|place| place.top() >= frame.top() - 0.1)
        .collect()
}

#[test]
fn the_legend_has_what_there_is_and_no_more() {
    let mut found = vec![
        outcome(0, Regime::Steady, Some(Symmetry::Asymmetric), 0),
        outcome(1, Regime::Periodic, Some(Symmetry::Asymmetric), 1),
        outcome(2, Regime::Periodic, Some(Symmetry::Asymmetric), 3),
        outcome(3, Regime::Torus, None, 0),
        outcome(4, Regime::Chaotic, None, 0),
        outcome(5, Regime::Chaotic, None, 0),
    ];
    found[4].lyapunov_max = Some(Uncertain::new(2e-4, 1e-6));
    found[5].lyapunov_max = Some(Uncertain::new(8e-4, 1e-6));
    let exact = |x| Uncertain::new(x, 0.0);
    let curve = |k| LocusRow::new(0, Symmetry::Asymmetric, exact(10.0 * k), exact(k));
    let rows = [curve(0.1), curve(0.2)];
    let sides = (&side(1.0, 2.0, 3), &side(0.1, 0.2, 2));
    let curves: [(&str, &[LocusRow]); 2] = [("TR", &rows), ("PD", &[])];
    let map = regime_map(&found, sides, 1, &curves, &Units::new(None, false));
    let seen = seen(&map);
    seen.assert_legible();
    for words in [
        "regimes at 3 × 2 points",
        "steady, asymmetric",
        "periodic, asymmetric",
        "period 3",
        "torus",
        "chaotic, exponent 2e-4 to 8e-4 [V*/L]",
        "TR",
        "V_H [V*]",
        "K [aσ/L]",
    ] {
        assert!(seen.says(words), "{words}: {:?}", seen.words);
    }
    let none = ["steady, symmetric", "period 2", "undecided", "PD"];
    for words in none.iter().chain(&["striped: the starts end differently"]) {
        assert!(!seen.says(words), "{words}");
    }
    // The exponent is largest in the last cell, upper right, which is the darkest.
    let frame = seen.frames()[0];
    let right = filled(&seen, [69, 8, 32]);
    assert!(right.len() == 1 && (right[0].right() - frame.right()).abs() < 0.1);
    assert!((right[0].width() - frame.width() / 3.0).abs() < 0.2);
    // The first point of the upper row.
    let torus = filled(&seen, TORUS)[0];
    assert!((torus.left() - frame.left()).abs() < 0.1 && (torus.top() - frame.top()).abs() < 0.1);
    assert!((torus.height() - frame.height() / 2.0).abs() < 0.2);
}

#[test]
fn cells_whose_starts_differ_show_both() {
    let found = [
        outcome(0, Regime::Torus, None, 0),
        outcome(1, Regime::Periodic, Some(Symmetry::Asymmetric), 3),
        outcome(2, Regime::Torus, None, 0),
        outcome(3, Regime::Undecided, None, 0),
    ];
    let alone = GridSide {
        values: vec![0.1],
        log: true,
    };
    let sides = (&side(1.0, 2.0, 2), &alone);
    let map = regime_map(&found, sides, 2, &[], &Units::new(None, false));
    let seen = seen(&map);
    assert!(seen.says("striped: the starts end differently"));
    assert!(seen.says("regimes at 2 × 1 points, 2 starts each"));
    assert!(seen.says("torus") && seen.says("period 3"));
    let frame = seen.frames()[0];
    let middle = 0.5 * (frame.left() + frame.right());
    // Below is what comes first in the legend, in the left cell only; above the stripes, and the right cell whole.
    let orbit = filled(&seen, PERIOD_3);
    assert!(orbit.len() == 1 && (orbit[0].right() - middle).abs() < 0.1);
    let torus = filled(&seen, TORUS);
    assert_eq!(torus.len(), 2, "a cell and stripes");
    assert!(
        torus
            .iter()
            .any(|place| (place.left() - middle).abs() < 0.1)
    );
    assert!(
        torus
            .iter()
            .any(|place| (place.right() - middle).abs() < 0.2)
    );
    assert!(!seen.says("undecided"), "another start has a verdict");
}

#[test]
fn attractors_are_numbered_by_their_basins() {
    let orbit = |number: usize, period: f64| PointOutcome {
        period: Some(period),
        ..outcome(number, Regime::Periodic, Some(Symmetry::Asymmetric), 1)
    };
    let found: Vec<PointOutcome> = (0..12)
        .map(|number| match number {
            0..2 => orbit(number, 300.0),
            // The same up to the accuracy of runs.
            2..7 => orbit(number, 512.25 * (1.0 + 1e-7 * number as f64)),
            7..11 => PointOutcome {
                period: Some(300.0),
                ..outcome(number, Regime::Periodic, Some(Symmetry::Symmetric), 1)
            },
            _ => outcome(number, Regime::Undecided, None, 0),
        })
        .collect();
    let sides = (&side(0.1, 0.9, 4), &side(0.15, 0.95, 3));
    let map = basin_map(&found, sides, (0.09, 0.1), &Units::new(None, false));
    let seen = seen(&map);
    seen.assert_legible();
    for words in [
        "basins at K = 0.1, V_H = 0.09",
        "1: periodic, asymmetric, T = 512.3 L/V*, 41.7 %",
        "2: periodic, symmetric, T = 300.0 L/V*, 33.3 %",
        "3: periodic, asymmetric, T = 300.0 L/V*, 16.7 %",
        "undecided, 8.3 %",
    ] {
        assert!(seen.says(words), "{words}: {:?}", seen.words);
    }
}

/// Equal states are a line, which no grid gives an area.
#[test]
fn starts_on_the_diagonal_are_no_basin() {
    let n = 10;
    let orbit = |number: usize| {
        let equal = number % n == number / n;
        let corner = number % n < 3 && number / n < 3;
        let symmetry = if equal || corner {
            Symmetry::Symmetric
        } else {
            Symmetry::Asymmetric
        };
        outcome(number, Regime::Periodic, Some(symmetry), 1)
    };
    let found: Vec<PointOutcome> = (0..n * n).map(orbit).collect();
    let sides = (&side(0.1, 1.0, n), &side(0.1, 1.0, n));
    let map = basin_map(&found, sides, (2.0, 0.1), &Units::new(None, false));
    let seen = seen(&map);
    seen.assert_legible();
    // Of 90 starts that are not on it 6 lie in the corner.
    for words in [
        "1: periodic, asymmetric, 93.3 %",
        "2: periodic, symmetric, 6.7 %",
        "basins at K = 0.1, V_H = 2",
    ] {
        assert!(seen.says(words), "{words}: {:?}", seen.words);
    }
    let counted = seen
        .words
        .iter()
        .any(|(text, _)| text.contains("not counted"));
    assert!(counted, "{:?}", seen.words);
    let frame = seen.frames()[0];
    let [green] = filled(&seen, [0, 110, 52])[..] else {
        panic!("the corner alone, without steps along the diagonal")
    };
    assert!(
        green.width() < 0.31 * frame.width() + 0.2,
        "{green:?} in {frame:?}"
    );
    // Without such starts nothing is said of them.
    let beside = (&side(0.1, 1.0, n), &side(0.15, 1.05, n));
    let map = basin_map(&found, beside, (2.0, 0.1), &Units::new(None, false));
    let seen = drawn::seen(&map);
    assert!(
        !seen
            .words
            .iter()
            .any(|(text, _)| text.contains("not counted"))
    );
}
