//! Points with names, many of them at a few places, and what stands above a frame.
#![allow(missing_docs)]

use crate::drawn::{BLUE, alone, numbers, seen, unit};
use twinslip::bifurcation::LocusRow;
use twinslip::equilibrium::Symmetry;
use twinslip::number::Uncertain;
use twinslip_output::plot::{Axis, Key, Mark, Panel, PlotSeries, Stroke, Symbol};
use twinslip_tasks::scene::Units;
use twinslip_tasks::views;

/// As where a branch of orbits winds up to a homoclinic orbit.
#[test]
fn names_of_a_crowd_are_counted_at_one_place() {
    let mut panel = unit("");
    for i in 0..20 {
        let name = if i % 4 == 0 { "PD" } else { "SN" };
        let at = 0.3 + 2e-4 * f64::from(i);
        panel.marks.push(Mark::new(at, at, name));
    }
    panel.marks.push(Mark::new(0.8, 0.2, "HB"));
    let shown = seen(&alone(panel));
    shown.assert_legible();
    assert!(shown.says("PD ×5, SN ×15"), "{:?}", shown.words);
    assert!(shown.says("HB"), "one that stands alone has no number");
}

/// The orbits next to a Hopf point are small, and yet the picture would have a gap there.
#[test]
fn branches_of_orbits_are_drawn_to_their_hopf_points() {
    let file = crate::command::folder("drawn-to-hopf").join("branch.svg");
    for what in [
        "--system fitzhugh-nagumo --along I --from 0.1 --to 1.6",
        "--stiffness 0.14 --from 0.05 --to 300",
    ] {
        let ended = crate::command::twinslip(&format!(
            "branch orbits {what} -q --force --plot {}",
            file.display()
        ));
        assert_eq!(ended.code, 0, "{}", ended.err);
        let svg = std::fs::read_to_string(&file).expect("a picture");
        // Both in every panel, and in the legend.
        assert!(svg.matches("HB").count() >= 5, "{what}");
    }
}

#[test]
fn a_legend_without_room_beside_the_title_begins_below_it() {
    let headed = |title: &str| {
        let mut panel = unit(title);
        for (i, name) in ["symmetric", "asymmetric"].into_iter().enumerate() {
            let line = PlotSeries::new(name, vec![0.0, 1.0], vec![0.0, 1.0]);
            panel.series.push(line.colour(i));
        }
        let shown = seen(&alone(panel));
        shown.assert_legible();
        let of = |words: &str| {
            let found = shown.words.iter().find(|(text, _)| text == words);
            found.unwrap_or_else(|| panic!("{words}")).1
        };
        let (title, first) = (of(title), of("symmetric"));
        (
            first.top() - title.top(),
            of("asymmetric").top() - first.top(),
        )
    };
    assert_eq!(headed("short"), (0.0, 0.0));
    let (below, beside) = headed("equilibria of interfaces at K = 0.14");
    assert!(below > 10.0 && beside == 0.0, "{below}, {beside}");
}

/// librsvg drops spaces at the ends of parts unless it is told to keep them.
#[test]
fn spaces_beside_subscripts_are_kept() {
    let svg = alone(unit("V_H = 10")).svg().expect("SVG");
    let title = svg
        .lines()
        .find(|line| line.contains("> = 10<"))
        .expect("the title");
    assert!(title.contains("xml:space=\"preserve\""), "{title}");
}

/// As the stairs of twenty interfaces.
#[test]
fn many_lines_side_by_side_leave_gaps() {
    let lines = |many: usize| {
        let mut panel = unit("");
        for x in numbers(0.3, 0.7, many) {
            let line = PlotSeries::new("", vec![x, x + 1e-3], vec![0.0, 1.0]);
            panel.series.push(line.colour(0));
        }
        let svg = alone(panel).svg().expect("SVG");
        let colour = format!("stroke=\"#{:02X}{:02X}{:02X}\"", BLUE[0], BLUE[1], BLUE[2]);
        let line = svg
            .lines()
            .find(|line| line.contains(&colour))
            .expect("a line");
        let (_, rest) = line.split_once("stroke-width=\"").expect("a width");
        let (width, _) = rest.split_once('"').expect("its end");
        0.1 * width.parse::<f64>().expect("a number")
    };
    assert!(lines(5) > 1.5);
    // 60 lines within 150 pixels.
    assert!(lines(60) < 1.3, "{}", lines(60));
}

fn row(curve: usize, symmetry: Symmetry, driving: f64) -> LocusRow {
    LocusRow::new(
        curve,
        symmetry,
        Uncertain::new(driving, 0.0),
        Uncertain::new(0.1 * driving, 0.0),
    )
}

#[test]
fn curves_of_symmetric_and_asymmetric_states_are_named() {
    let units = Units::new(None, false);
    let both = [
        row(0, Symmetry::Asymmetric, 1.0),
        row(0, Symmetry::Asymmetric, 2.0),
        row(1, Symmetry::Symmetric, 1.0),
        row(1, Symmetry::Symmetric, 3.0),
    ];
    let shown = seen(&views::curves(&both, &[], "Hopf points", &units));
    assert!(
        shown.says("symmetric") && shown.says("asymmetric"),
        "{:?}",
        shown.words
    );
    let shown = seen(&views::curves(&both[..2], &[], "Hopf points", &units));
    assert!(
        !shown.says("asymmetric"),
        "where all are there is nothing to tell apart"
    );
}

/// An entry of the legend without a curve changes neither the axes nor the strokes that are explained.
#[test]
fn entries_of_the_legend_alone_draw_nothing() {
    let mut panel = Panel::new("", Axis::linear("x"), Axis::linear("y"));
    let x = numbers(0.0, 5.0, 11);
    panel
        .series
        .push(PlotSeries::new("name", Vec::new(), Vec::new()).colour(0));
    let line = PlotSeries::new("", x.clone(), x).stroke(Stroke::Dashed);
    panel.series.push(line.colour(0));
    panel.keys.push(Key {
        symbol: Symbol::Circle,
        filled: true,
        colour: None,
        label: "HB: Hopf".into(),
    });
    assert!(views::named_strokes(&panel.series[..1]).is_empty());
    assert_eq!(views::named_strokes(&panel.series).len(), 1);
    let shown = seen(&alone(panel));
    assert!(
        shown.says("name") && shown.says("5") && !shown.says("6"),
        "{:?}",
        shown.words
    );
}

/// As a vertical curve of folds, which no equilibrium's stiffness moves.
#[test]
fn points_and_vertical_lines_stand_off_the_frame() {
    let mut panel = Panel::new("", Axis::linear("x"), Axis::linear("y"));
    panel
        .marks
        .extend([1.0, 2.0].map(|x| Mark::new(x, x, "").colour(0)));
    let shown = seen(&alone(panel));
    let frame = shown.frames()[0];
    let marks = shown
        .shapes
        .iter()
        .filter(|shape| shape.stroke == Some(BLUE) || shape.fill == Some(BLUE));
    let mut count = 0;
    for mark in marks {
        count += 1;
        assert!(mark.place.left() > frame.left() + 1.0, "{:?}", mark.place);
        assert!(mark.place.right() < frame.right() - 1.0, "{:?}", mark.place);
    }
    assert!(count >= 2);
}
