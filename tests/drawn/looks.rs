//! How curves and words look, in panels made for it and in the figures of the paper.
#![allow(missing_docs)]

use crate::drawn::{BLUE, Shape, alone, numbers, seen, unit};
use std::sync::atomic::AtomicBool;
use twinslip_output::plot::{Axis, Drawing, Mark, Note, Panel, PlotSeries};
use twinslip_paper::{Make, Pieces, Product};

/// Where curves of a colour run: the ends of their straight pieces, in order.
fn pieces(svg: &str, colour: [u8; 3]) -> Vec<Vec<(f64, f64)>> {
    let stroke = format!(
        "stroke=\"#{:02X}{:02X}{:02X}\"",
        colour[0], colour[1], colour[2]
    );
    let lines = svg
        .lines()
        .filter(|line| line.starts_with("<polyline") && line.contains(&stroke));
    let points = |line: &str| {
        let (_, rest) = line.split_once("points=\"").expect("points");
        let (all, _) = rest.split_once('"').expect("their end");
        let pair = |text: &str| {
            let (x, y) = text.split_once(',').expect("a pair");
            (x.parse().expect("x"), y.parse().expect("y"))
        };
        all.split_whitespace().map(pair).collect()
    };
    lines.map(points).collect()
}

/// The largest turn from one straight piece to the next, in degrees, of pieces that are long enough to have a direction.
fn sharpest(line: &[(f64, f64)]) -> f64 {
    let mut kept = vec![line[0]];
    for &(x, y) in &line[1..] {
        let (a, b) = kept[kept.len() - 1];
        if (x - a).hypot(y - b) > 50.0 {
            kept.push((x, y));
        }
    }
    let turn = |three: &[(f64, f64)]| {
        let (a, b) = (
            (three[1].0 - three[0].0, three[1].1 - three[0].1),
            (three[2].0 - three[1].0, three[2].1 - three[1].1),
        );
        (a.0 * b.1 - a.1 * b.0)
            .atan2(a.0 * b.0 + a.1 * b.1)
            .to_degrees()
            .abs()
    };
    kept.windows(3).map(turn).fold(0.0, f64::max)
}

/// A loop of sixteen points with a fold in both directions, as continuation gives it.
#[test]
fn curves_have_no_corners_at_their_points() {
    let angle = numbers(0.0, 5.9, 17);
    let around = |f: fn(f64) -> f64, size: f64| angle.iter().map(|t| 0.5 + size * f(*t)).collect();
    let mut panel = unit("");
    panel
        .series
        .push(PlotSeries::new("", around(f64::cos, 0.4), around(f64::sin, 0.3)).colour(0));
    let svg = alone(panel.clone()).svg().unwrap();
    let [line] = &pieces(&svg, BLUE)[..] else {
        panic!("one curve")
    };
    // Straight pieces between the points turn by 14 to 35 degrees.
    assert!(sharpest(line) < 13.9, "{}", sharpest(line));
    // A part of it runs where the whole does.
    panel.series[0].left_out = (0..16).map(|i| !(5..9).contains(&i)).collect();
    let svg = alone(panel).svg().unwrap();
    let [part] = &pieces(&svg, BLUE)[..] else {
        panic!("one part")
    };
    let near = |at: &(f64, f64)| line.iter().any(|p| (p.0 - at.0).hypot(p.1 - at.1) < 20.0);
    assert!(part.len() < line.len() / 2 && part.iter().all(near));
}

#[test]
fn oscillations_that_fill_an_area_are_drawn_as_their_envelope() {
    let x = numbers(0.0, 1.0, 60_001);
    let growing = |x: &f64| 0.5 + 0.4 * x * (6000.0 * x).sin();
    let y = x.iter().map(growing).collect();
    let mut panel = unit("");
    panel.series.push(PlotSeries::new("", x, y).colour(0));
    let svg = alone(panel).svg().unwrap();
    assert!(
        svg.contains("fill-opacity"),
        "an area that lets the grid through"
    );
    let points: usize = pieces(&svg, BLUE).iter().map(Vec::len).sum();
    assert!(points < 1500, "{points} points of two envelopes");
}

#[test]
fn symbols_have_subscripts() {
    let mut panel = Panel::new(
        "near 2 V_M",
        Axis::linear("driving velocity V_H [V*]").within(0.0, 1.0),
        Axis::linear("steady friction μ_ss").within(0.0, 1.0),
    );
    let line = PlotSeries::new("τ_ss(V_H/2)", vec![0.0, 1.0], vec![0.2, 0.3]);
    panel.series.push(line);
    panel.marks.push(Mark::new(0.5, 0.25, "k_c* < 1 & more"));
    panel.notes.push(Note::new(0.3, 0.7, "H_a"));
    let seen = seen(&alone(panel));
    // `seen` reads smaller letters with an underscore, and refuses one that is drawn.
    for words in [
        "near 2 V_M",
        "driving velocity V_H [V*]",
        "steady friction μ_ss",
        "τ_ss(V_H/2)",
        "k_c* < 1 & more",
        "H_a",
    ] {
        assert!(seen.says(words), "{words}: {:?}", seen.words);
    }
}

/// A page is 800 pixels broad on a desk, and 360 on a telephone.
#[test]
fn words_are_legible_where_pictures_are_shown() {
    let curve = || {
        let mut panel = unit("a title");
        panel
            .series
            .push(PlotSeries::new("", vec![0.0, 1.0], vec![0.0, 1.0]));
        panel
    };
    for columns in [1, 2] {
        let shown = seen(&Drawing::columns(vec![vec![curve(), curve()]; columns]));
        shown.assert_readable(800.0, 12.0);
        shown.assert_readable(360.0, 5.9);
    }
}

#[test]
fn notes_stand_beside_curves() {
    let mut panel = unit("");
    let x = numbers(0.0, 1.0, 200);
    let y = x.iter().map(|x| 0.5 + 0.3 * (7.0 * x).sin()).collect();
    panel.series.push(PlotSeries::new("", x, y).colour(0));
    for i in 1..10 {
        let at = 0.1 * f64::from(i);
        panel
            .notes
            .push(Note::new(at, 0.5 + 0.3 * (7.0 * at).sin(), "region"));
    }
    let drawing = alone(panel);
    let shown = seen(&drawing);
    shown.assert_legible();
    let line = &pieces(&drawing.svg().unwrap(), BLUE)[0];
    let words = shown.words.iter().filter(|(text, _)| text == "region");
    let mut count = 0;
    for (_, place) in words {
        count += 1;
        let cut = line.iter().any(|&(x, y)| {
            let (x, y) = (0.1 * x as f32, 0.1 * y as f32);
            x > place.left() && x < place.right() && y > place.top() && y < place.bottom()
        });
        assert!(!cut, "the curve is cut at {place:?}");
    }
    assert_eq!(count, 9);
}

/// As the torus and period-doubling points of a branch of orbits: two pairs, one of them nearly one point.
#[test]
fn names_of_near_points_stand_apart() {
    let mut panel = unit("");
    let x = numbers(0.0, 1.0, 100);
    panel
        .series
        .push(PlotSeries::new("", x.clone(), x).colour(0));
    let points = [
        (0.2, 0.2, "TR"),
        (0.22, 0.22, "PD"),
        (0.2405, 0.2405, "PD"),
        (0.241, 0.241, "TR"),
    ];
    panel
        .marks
        .extend(points.map(|(x, y, name)| Mark::new(x, y, name)));
    let shown = seen(&alone(panel));
    shown.assert_legible();
    assert!(
        shown.says("PD, TR"),
        "two points that look like one: {:?}",
        shown.words
    );
    let frame = shown.frames()[0];
    for (text, place) in shown
        .words
        .iter()
        .filter(|(text, _)| text == "TR" || text == "PD")
    {
        for (x, y, _) in points {
            let at = (
                frame.left() + x as f32 * frame.width(),
                frame.bottom() - y as f32 * frame.height(),
            );
            let covered = at.0 > place.left() - 3.0
                && at.0 < place.right() + 3.0
                && at.1 > place.top() - 1.0
                && at.1 < place.bottom() + 1.0;
            assert!(!covered, "{text} at {place:?} covers a point at {at:?}");
        }
    }
}

/// The picture of a figure of the paper.
fn figure(id: &str) -> Drawing {
    let stop = AtomicBool::new(false);
    let Make::Figure(make) = Product::named(id).expect("a figure").make else {
        panic!("{id} is no figure");
    };
    make(&Pieces::new(&stop))
        .expect("made")
        .drawing
        .expect("drawn")
}

/// Those that take a second at most.
#[test]
fn figures_are_legible_and_say_their_parameters() {
    let figures = [
        ("fig01", "V_M = 2.49×10⁻⁸ m/s: μ_ss = 0.405"),
        ("fig02", "(a) maximum of τ_ss"),
        ("fig03", "(a) localisation: K = 0.45, V_H = 1"),
        ("fig04", "V_M = 0.0249 V*"),
        ("fig05", "(a) stress, K = 0.45"),
        ("fig08", "(a) K = 0.14, V_H = 0.07"),
        ("fig11", "K = 0.01, V_H = 0.2"),
        ("fig15", "5"),
        ("fig17", "(a) Q₃(s) and L(s), V_H = 0.06"),
    ];
    for (id, words) in figures {
        let shown = seen(&figure(id));
        shown.assert_legible();
        shown.assert_readable(800.0, 12.0);
        shown.assert_readable(360.0, 5.9);
        assert!(shown.says(words), "{id}: no {words:?} in {:?}", shown.words);
    }
}

/// The fast interface solid below the slow one, dashed: where both coincide each is seen.
#[test]
fn the_slow_interface_is_dashed_over_the_fast_one() {
    let drawing = figure("fig11");
    let shown = seen(&drawing);
    let named = |role: &str| {
        shown
            .words
            .iter()
            .filter(|(text, _)| text.ends_with(role))
            .count()
    };
    // States and slip rates in time, and the phase plane.
    assert_eq!(
        (named(", fast"), named(", slow")),
        (3, 3),
        "{:?}",
        shown.words
    );
    let orange = [213, 94, 0];
    let slip_rates = shown.frames()[2];
    let within = |shape: &&Shape| {
        shape.place.left() >= slip_rates.left() - 0.1
            && shape.place.right() <= slip_rates.right() + 0.1
            && shape.place.top() >= slip_rates.top() - 0.1
            && shape.place.bottom() <= slip_rates.bottom() + 0.1
    };
    let inside: Vec<&Shape> = shown.shapes.iter().filter(within).collect();
    let of = |colour| -> Vec<usize> {
        let places = inside.iter().enumerate();
        let coloured = places.filter(|(_, shape)| shape.stroke == Some(colour));
        coloured.map(|(i, _)| i).collect()
    };
    let (fast, slow) = (of(orange), of(BLUE));
    assert_eq!(fast.len(), 1, "one line");
    assert!(slow.len() > 50, "{} dashes", slow.len());
    assert!(fast[0] < slow[0], "the dashes lie above the line");
}
