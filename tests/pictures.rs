//! What pictures show and where: read from the SVG as a viewer would, with the font that is built in.

use crate::drawn;
use drawn::{BLUE, GRID, INK, PAPER, Shape, alone, numbers, seen, unit};
use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg::Rect;
use resvg::usvg::{Options, Tree};
use twinslip_output::plot::{
    Axis, Block, Cells, Drawing, Key, Mark, Note, Panel, PlotSeries, Shade, Side, Stroke, Swatch,
    Symbol,
};

/// Curves, points and words of all kinds, within the frame, beyond it and on its edge.
fn crowded() -> Panel {
    let x = numbers(-3.0, 4.0, 500);
    let wave = x.iter().map(|x| 0.5 + 2.0 * (5.0 * x).sin()).collect();
    let turn: Vec<f64> = numbers(0.0, 30.0, 700);
    let around = |f: fn(f64) -> f64| turn.iter().map(|t| 0.5 + 0.03 * t * f(*t)).collect();
    let mut panel = unit("");
    for stroke in [Stroke::Solid, Stroke::Dashed, Stroke::Dotted] {
        let spiral = PlotSeries::new("", around(f64::cos), around(f64::sin));
        panel.series.push(spiral.stroke(stroke));
    }
    panel
        .series
        .push(PlotSeries::new("", x.clone(), wave).wide());
    panel.series.push(PlotSeries::dots("", x.clone(), x));
    let corners = [(0.0, 0.0), (1.0, 0.3), (0.4, 1.0), (1.2, 0.5), (0.5, -9.0)];
    let symbols = [
        Symbol::Star,
        Symbol::Plus,
        Symbol::Circle,
        Symbol::Square,
        Symbol::Cross,
    ];
    for ((x, y), symbol) in corners.into_iter().zip(symbols) {
        let name = format!("({x}, {y})");
        let side = if y == 1.0 { Side::Above } else { Side::Free };
        panel
            .marks
            .push(Mark::new(x, y, name).symbol(symbol).side(side).colour(1));
        panel.notes.push(Note {
            x,
            y: y + 0.1,
            text: format!("note at {x} and {y}"),
            colour: Some(2),
        });
    }
    panel
}

#[test]
fn nothing_is_drawn_outside_of_a_fixed_range() {
    let seen = seen(&alone(crowded()));
    let [frame] = seen.frames()[..] else {
        panic!("not one frame")
    };
    let within = |place: Rect, air: f32| {
        place.left() >= frame.left() - air
            && place.right() <= frame.right() + air
            && place.top() >= frame.top() - air
            && place.bottom() <= frame.bottom() + air
    };
    let (mut curves, mut reached) = (0, [false; 4]);
    for shape in &seen.shapes {
        let colour = shape.stroke.or(shape.fill).expect("something");
        let ground = shape.place.width() > frame.width() + 50.0;
        if colour != INK && !ground {
            assert!(within(shape.place, 0.06), "{shape:?} leaves {frame:?}");
            let place = shape.place;
            curves += usize::from(colour != GRID && colour != PAPER);
            let ends = [
                place.left() - frame.left(),
                frame.right() - place.right(),
                place.top() - frame.top(),
                frame.bottom() - place.bottom(),
            ];
            for (reached, end) in reached.iter_mut().zip(ends) {
                *reached |= colour == BLUE && end < 0.06;
            }
        }
    }
    assert!(curves > 100, "{curves}");
    assert_eq!(reached, [true; 4], "the curve goes up to the frame");
    for word in ["(1, 0.3)", "note at 1 and 0.3"] {
        assert!(seen.says(word), "{word}");
    }
    for (text, place) in &seen.words {
        let inside = text.starts_with('(') || text.starts_with("note");
        assert!(!inside || within(*place, 0.0), "{text}: {place:?}");
    }
    for word in ["(1.2, 0.5)", "(0.5, -9)", "note at 0.4 and 1"] {
        assert!(!seen.says(word), "{word} is outside");
    }
}

/// The line from (-1, -1) to (2, 2) passes the window from corner to corner.
#[test]
fn a_segment_with_both_ends_outside_is_cut_at_the_frame() {
    let mut panel = unit("");
    let ends = vec![-1.0, 2.0];
    panel.series.push(PlotSeries::new("", ends.clone(), ends));
    let seen = seen(&alone(panel));
    let frame = seen.frames()[0];
    let lines = seen
        .shapes
        .iter()
        .filter(|shape| shape.stroke == Some(BLUE));
    let lines: Vec<Rect> = lines.map(|shape| shape.place).collect();
    assert_eq!(lines.len(), 1);
    for (a, b) in [
        (lines[0].left(), frame.left()),
        (lines[0].right(), frame.right()),
        (lines[0].top(), frame.top()),
        (lines[0].bottom(), frame.bottom()),
    ] {
        assert!((a - b).abs() < 0.06, "{lines:?} in {frame:?}");
    }
}

#[test]
fn a_free_axis_follows_what_the_other_shows() {
    let x = numbers(0.0, 100.0, 101);
    let mut panel = Panel::new("", Axis::linear("x").within(0.0, 3.0), Axis::linear("y"));
    panel.series.push(PlotSeries::new("", x.clone(), x));
    let seen = seen(&alone(panel));
    assert!(seen.says("3.0") && !seen.says("100"), "{:?}", seen.words);
}

#[test]
fn long_legends_wrap_and_lack_nothing() {
    let names = [
        "Hopf bifurcations of symmetric states",
        "of asymmetric states",
        "pitchforks",
        "folds of equilibria",
        "folds of orbits",
        "pitchforks of orbits",
        "period doublings",
        "tori",
        "homoclinic orbits",
    ];
    let mut panel = unit("curves in the plane of driving and stiffness");
    for (i, name) in names.iter().enumerate() {
        let height = 0.1 * i as f64;
        let series = PlotSeries::new(*name, vec![0.0, 1.0], vec![height, height]);
        panel.series.push(series.colour(i));
    }
    let keys = ["cusp", "generalised Hopf", "1:1 resonance", "1:2 resonance"];
    panel.keys.extend(keys.iter().map(|label| Key {
        symbol: Symbol::Diamond,
        filled: false,
        colour: None,
        label: (*label).to_owned(),
    }));
    let top = |drawing: &Drawing| seen(drawing).frames()[0];
    let short = top(&alone(Panel {
        keys: Vec::new(),
        series: vec![PlotSeries::new("", vec![0.0, 1.0], vec![0.0, 1.0])],
        ..panel.clone()
    }));
    for columns in [1, 3] {
        let drawing = Drawing::columns(vec![vec![panel.clone()]; columns]);
        let seen = seen(&drawing);
        seen.assert_legible();
        let first = seen.frames()[0];
        for name in names.iter().chain(&keys) {
            let (_, place) = seen.words.iter().find(|(text, _)| text == name).unwrap();
            assert!(place.bottom() <= first.top(), "{name} is above the frame");
        }
        assert!(seen.frames().len() == columns && first.top() > 80.0);
        if columns == 1 {
            assert!(first.height() > short.height() - 1.0, "frames don't shrink");
        }
    }
}

#[test]
fn strokes_differ_in_the_frame_and_in_the_legend() {
    let strokes = [
        Stroke::Solid,
        Stroke::Dashed,
        Stroke::DashDot,
        Stroke::DashDotDot,
        Stroke::Dotted,
    ];
    let patterns = |stroke| {
        let mut panel = unit("");
        let line = PlotSeries::new("line", vec![0.0, 1.0], vec![0.5, 0.5]);
        panel.series.push(line.stroke(stroke).colour(0));
        let seen = seen(&alone(panel));
        let frame = seen.frames()[0];
        let blue = seen
            .shapes
            .iter()
            .filter(|shape| shape.stroke == Some(BLUE));
        let (inside, above): (Vec<Shape>, Vec<Shape>) =
            blue.partition(|shape| shape.place.top() >= frame.top());
        let lengths = |shapes: &[Shape]| -> Vec<i32> {
            let rounded = |shape: &Shape| (10.0 * shape.place.width()).round() as i32;
            shapes.iter().map(rounded).collect()
        };
        (lengths(&inside), lengths(&above))
    };
    let patterns = strokes.map(patterns);
    assert_eq!((patterns[0].0.len(), patterns[0].1.len()), (1, 1));
    for (i, (inside, above)) in patterns.iter().enumerate() {
        // As in the frame, so in the legend.
        let dashes = above.len() - 1;
        let alike = inside
            .iter()
            .zip(&above[..dashes])
            .all(|(a, b)| (a - b).abs() <= 1);
        assert!(i == 0 || (dashes > 0 && alike), "{inside:?} {above:?}");
        for (other, legend) in &patterns[..i] {
            assert!(inside != other && above != legend);
        }
    }
}

#[test]
fn symbols_are_open_or_filled_on_white() {
    let red = [213, 94, 0];
    for filled in [true, false] {
        let mut panel = unit("");
        let mark = Mark::new(0.5, 0.5, "").symbol(Symbol::Square).colour(1);
        panel.marks.push(if filled { mark } else { mark.open() });
        let seen = seen(&alone(panel));
        let middle = |shape: &&Shape| {
            shape.place.width() < 20.0 && ![Some(INK), Some(GRID)].contains(&shape.stroke)
        };
        let shapes: Vec<&Shape> = seen.shapes.iter().filter(middle).collect();
        let inside = shapes.iter().filter_map(|shape| shape.fill).next_back();
        assert_eq!(inside, Some(if filled { red } else { PAPER }));
        assert_eq!(shapes[0].stroke, Some(PAPER), "a white edge below it");
        assert_eq!(shapes.last().and_then(|shape| shape.stroke), Some(red));
    }
}

#[test]
fn labels_stand_apart_on_every_kind_of_axis() {
    let logarithmic = [
        (1e-12, 1.0),
        (1e-16, 1e14),
        (0.0123, 0.0456),
        (1.35, 1.58),
        (2e-7, 9e-7),
        (1.0, 1e3),
        (1e-3, 0.5),
        (1e3, 2e6),
    ];
    let linear = [
        (1.234_567, 1.234_569),
        (0.0, 123_456_789.0),
        (-3e-7, 1e-7),
        (100_000.5, 100_001.5),
        (-1.0, 1.0),
        (0.0, 2e-13),
    ];
    let name = "a rather long name of an axis that goes on and on [MPa/mm]";
    let panel = |make: fn(&'static str) -> Axis, (lo, hi): (f64, f64)| {
        let axis = || make(name).within(lo, hi);
        let title = "a title that would not have room above the frame at all";
        Panel::new(title, axis(), axis())
    };
    let mut panels: Vec<Panel> = Vec::new();
    panels.extend(logarithmic.map(|range| panel(Axis::log, range)));
    panels.extend(linear.map(|range| panel(Axis::linear, range)));
    let rows: Vec<Vec<Panel>> = panels.chunks(3).map(<[Panel]>::to_vec).collect();
    let drawing = Drawing::columns(rows);
    let seen = seen(&drawing);
    assert_eq!(seen.frames().len(), panels.len());
    seen.assert_legible();
    // Each axis has two numbers at least, but for those whose numbers are too long for that.
    let few: Vec<Rect> = seen
        .frames()
        .into_iter()
        .filter(|frame| {
            let beside = |place: &Rect| {
                let middle = 0.5 * (place.top() + place.bottom());
                place.right() < frame.left()
                    && frame.left() - place.right() < 10.0
                    && middle > frame.top() - 3.0
                    && middle < frame.bottom() + 3.0
            };
            seen.words.iter().filter(|(_, place)| beside(place)).count() < 2
        })
        .collect();
    assert!(few.is_empty(), "{few:?} {:?}", seen.words);
}

#[test]
fn blocks_stand_one_below_the_other() {
    let run = || {
        let x = numbers(0.0, 9.0, 200);
        let y = x.iter().map(|x| x.sin()).collect();
        Panel {
            series: vec![PlotSeries::new("stress", x, y)],
            ..Panel::new("run", Axis::linear("t"), Axis::linear("τ"))
        }
    };
    let block = |title: &str| Block {
        title: title.to_owned(),
        columns: vec![
            vec![run(), run(), run()],
            vec![run()],
            vec![run()],
            vec![run()],
        ],
    };
    let drawing = Drawing::blocks(vec![block("(a) K = 0.05"), block("(b) K = 0.1")]);
    let seen = seen(&drawing);
    seen.assert_legible();
    let frames = seen.frames();
    assert_eq!(frames.len(), 12);
    let title = |words: &str| seen.words.iter().find(|(text, _)| text == words).unwrap().1;
    let (first, second) = (title("(a) K = 0.05"), title("(b) K = 0.1"));
    assert!(frames[..6].iter().all(|frame| frame.top() > first.bottom()));
    assert!(
        frames[..6]
            .iter()
            .all(|frame| frame.bottom() < second.top())
    );
    assert!(
        frames[6..]
            .iter()
            .all(|frame| frame.top() > second.bottom())
    );
    for block in frames.chunks(6) {
        let (stack, planes) = block.split_at(3);
        for plane in planes {
            assert!((plane.top() - stack[0].top()).abs() < 0.06, "aligned above");
            assert!(plane.height() > 2.0 * stack[0].height());
            assert!(
                plane.height() <= plane.width() + 0.1,
                "not higher than wide"
            );
        }
        for pair in stack.windows(2) {
            assert!((pair[0].left() - pair[1].left()).abs() < 0.06);
            assert!((pair[0].width() - pair[1].width()).abs() < 0.06);
        }
    }
}

#[test]
fn nothing_to_draw_is_refused() {
    let empty = Panel::new("nothing", Axis::linear("x"), Axis::linear("y"));
    let refused = alone(empty).svg().expect_err("no points").to_string();
    assert!(refused.contains("nothing"), "{refused}");
    assert!(Drawing::blocks(Vec::new()).svg().is_err());
    // A fixed range can be drawn without points.
    assert!(alone(unit("")).svg().is_ok());
}

const SHADES: [[u8; 3]; 3] = [[10, 20, 30], [200, 40, 40], [250, 240, 200]];

/// A map of n by n cells from 0 to 1, filled by the number of the shade, none for other numbers.
fn map(n: usize, fill: impl Fn(usize, usize) -> Vec<usize>) -> Cells {
    let shade = |number: usize| SHADES.get(number).copied().map(Shade::new);
    let fills = (0..n * n).map(|k| fill(k % n, k / n).into_iter().filter_map(shade).collect());
    Cells {
        x_edges: numbers(0.0, 1.0, n + 1),
        y_edges: numbers(0.0, 1.0, n + 1),
        fills: fills.collect(),
        swatches: Vec::new(),
    }
}

/// The pixels of a panel's picture, and its frame in them.
fn pixels(panel: &Panel, zoom: f32) -> (Pixmap, Rect) {
    let drawing = alone(panel.clone());
    let frame = seen(&drawing).frames()[0];
    let tree = Tree::from_str(&drawing.svg().expect("SVG"), &Options::default()).expect("SVG");
    let size = |x: f32| (zoom * x).ceil() as u32;
    let mut pixels = Pixmap::new(size(tree.size().width()), size(tree.size().height())).unwrap();
    resvg::render(
        &tree,
        Transform::from_scale(zoom, zoom),
        &mut pixels.as_mut(),
    );
    let frame = frame.transform(Transform::from_scale(zoom, zoom)).unwrap();
    (pixels, frame)
}

/// How many pixels within the frame, but for its line, have each of the colours of the maps, and how many none of them.
fn counts(pixels: &Pixmap, frame: Rect) -> ([usize; 3], usize) {
    let (mut of, mut others) = ([0; 3], 0);
    for y in frame.top() as u32 + 3..frame.bottom() as u32 - 3 {
        for x in frame.left() as u32 + 3..frame.right() as u32 - 3 {
            let pixel = pixels.pixel(x, y).unwrap().demultiply();
            let colour = [pixel.red(), pixel.green(), pixel.blue()];
            match SHADES.iter().position(|shade| *shade == colour) {
                Some(shade) => of[shade] += 1,
                None => others += 1,
            }
        }
    }
    (of, others)
}

/// Sides of cells that fall between pixels let nothing through, at any size.
#[test]
fn maps_have_no_seams() {
    // 37 cells fit no whole number of pixels.
    let mut panel = unit("");
    panel.cells = Some(map(37, |i, j| vec![(i * i + 3 * j) / 7 % 3]));
    for zoom in [0.73, 1.0, 2.0] {
        let (pixels, frame) = pixels(&panel, zoom);
        let (of, others) = counts(&pixels, frame);
        assert_eq!(others, 0, "of {of:?} at {zoom}");
    }
}

/// Each shade covers its share, alone and in stripes, though runs and rows are merged.
#[test]
fn merged_cells_cover_the_same_area() {
    let n = 24;
    let number = |i: usize, j: usize| ((i / 3) * (j / 5) + i / 7) % 4;
    let mut panel = unit("");
    panel.cells = Some(map(n, |i, j| vec![number(i, j)]));
    let (whole, frame) = pixels(&panel, 4.0);
    let (of, _) = counts(&whole, frame);
    let all = f64::from(frame.width() * frame.height());
    for (shade, count) in of.into_iter().enumerate() {
        let cells = (0..n * n).filter(|k| number(k % n, k / n) == shade).count();
        let (share, expected) = (count as f64 / all, cells as f64 / (n * n) as f64);
        assert!(
            (share - expected).abs() < 0.01,
            "{shade}: {share} for {expected}"
        );
    }
    // Far fewer rectangles than cells.
    let svg = alone(panel.clone()).svg().unwrap();
    let rectangles = svg.matches("z").count();
    assert!(rectangles < n * n / 3, "{rectangles}");
    panel.cells = Some(map(n, |_, _| vec![0, 1, 2]));
    let (striped, frame) = pixels(&panel, 4.0);
    for count in counts(&striped, frame).0 {
        let share = count as f64 / all;
        // A part of the pixels is at the sides of stripes.
        assert!((0.25..0.34).contains(&share), "{share}");
    }
}

#[test]
fn maps_end_at_the_frame_and_follow_logarithmic_axes() {
    let mut panel = Panel::new(
        "",
        Axis::linear("x").within(0.5, 2.0),
        Axis::log("y").within(0.01, 1.0),
    );
    // Rows from 0 to 0.1 and from there to 1: halves of two decades.
    let edges = vec![0.0, 0.1, 1.0];
    panel.cells = Some(Cells {
        x_edges: vec![-3.0, 9.0],
        y_edges: edges,
        fills: vec![vec![Shade::new(SHADES[0])], vec![Shade::new(SHADES[1])]],
        swatches: Vec::new(),
    });
    let shown = seen(&alone(panel.clone()));
    let frame = shown.frames()[0];
    let place = |shade: [u8; 3]| {
        let mut shapes = shown.shapes.iter();
        shapes
            .find(|shape| shape.fill == Some(shade))
            .expect("filled")
            .place
    };
    let (low, high) = (place(SHADES[0]), place(SHADES[1]));
    for rect in [low, high] {
        assert!(
            (rect.left() - frame.left()).abs() < 0.06
                && (rect.right() - frame.right()).abs() < 0.06
        );
        assert!((rect.height() - 0.5 * frame.height()).abs() < 0.11);
    }
    assert!(low.top() == high.bottom() && (low.bottom() - frame.bottom()).abs() < 0.06);
    // Without fixed ends the axes end where the map does.
    panel.x.range = None;
    panel.y = Axis::linear("y");
    let shown = seen(&alone(panel));
    assert!(shown.says("1.0") && !shown.says("1.2"), "{:?}", shown.words);
}

#[test]
fn curves_and_names_lie_on_maps() {
    let mut panel = unit("");
    panel.cells = Some(Cells {
        swatches: vec![Swatch {
            shades: vec![Shade::new(SHADES[1])],
            label: "red".to_owned(),
        }],
        ..map(3, |_, _| vec![1])
    });
    panel
        .series
        .push(PlotSeries::new("", vec![0.0, 1.0], vec![0.2, 0.9]).colour(0));
    panel.marks.push(Mark::new(0.5, 0.3, "name"));
    let seen = seen(&alone(panel));
    assert!(seen.says("red"));
    let at = |is: &dyn Fn(&drawn::Shape) -> bool| seen.shapes.iter().rposition(is).expect("drawn");
    let frame = seen.frames()[0];
    let ground =
        at(&|shape| shape.fill == Some(SHADES[1]) && shape.place.top() >= frame.top() - 0.1);
    let casing = at(&|shape| shape.stroke == Some(PAPER) && shape.place.width() > 100.0);
    let curve = at(&|shape| shape.stroke == Some(BLUE));
    let backing = at(&|shape| shape.fill == Some(PAPER) && shape.place.width() < 100.0);
    assert!(ground < casing && casing < curve && curve < backing);
    let key = seen
        .shapes
        .iter()
        .find(|shape| shape.fill == Some(SHADES[1]))
        .unwrap()
        .place;
    assert!(key.bottom() < frame.top() && (key.width() - key.height()).abs() < 0.11);
}

#[test]
fn large_maps_are_small_files() {
    let mut panel = unit("");
    // All cells differ from their neighbours; and rings, some of them striped.
    panel.cells = Some(map(200, |i, j| vec![(i * 7 + j * 13 + i * j) % 3]));
    let worst = alone(panel.clone()).svg().unwrap().len();
    let ring = |i: usize, j: usize| (i as f64 - 99.5).hypot(j as f64 - 99.5) as usize / 9;
    panel.cells = Some(map(200, |i, j| match ring(i, j) % 5 {
        3 => vec![0, 1],
        ring => vec![ring % 3],
    }));
    let usual = alone(panel).svg().unwrap().len();
    assert!(worst < 1_000_000 && usual < 300_000, "{worst}, {usual}");
}
