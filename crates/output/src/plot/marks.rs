//! The points that are pointed out with their names, and words at a place.

use super::canvas::{Align, Canvas, Colour, INK, MARK, PAPER, Pixel, colour};
use super::clip::Window;
use super::frame::Frame;
use super::symbols::{self, Look};
use super::text::{self, TEXT};
use super::{Mark, Note, Panel, names};

/// Room between a name and its neighbours.
const AIR: f64 = 4.0;
/// Room around words that lines don't cross.
const BACKING: f64 = 2.0;
/// A name that begins farther than this from its point is tied to it.
const TIED: f64 = 12.0;
/// Points nearer than this look like one: they share a name.
const ONE: f64 = 3.0;
/// Of more names than this in a panel, those of symbols that touch are one, with the number of points that it stands for.
const CROWD: usize = 8;
const TOUCH: f64 = 12.0;
/// Breadth of bars, and half the length of the lines at their ends.
const BAR: f64 = 1.2;
const CAP: f64 = 3.5;
/// Distance of the points along bars that names avoid.
const ALONG: f64 = 2.5;
/// Breadth of the tie.
const TIE: f64 = 0.7;

/// A note with its middle and size.
pub type Written<'a> = (&'a Note, (Pixel, (f64, f64)));

/// Where the notes that lie in the frame stand: each where it covers neither a curve nor another one, as near to its place as that
/// allows.
pub fn notes<'a>(panel: &'a Panel, frame: &Frame, curves: &[Pixel]) -> Vec<Written<'a>> {
    let marks = panel.marks.iter();
    let points: Vec<Pixel> = marks
        .filter_map(|mark| frame.place(mark.x, mark.y))
        .collect();
    let mut written: Vec<Written<'_>> = Vec::new();
    for note in &panel.notes {
        let Some(at) = frame.place(note.x, note.y) else {
            continue;
        };
        let size = (
            text::width(&note.text, TEXT) + 2.0 * BACKING,
            TEXT + 2.0 * BACKING,
        );
        let half = (0.5 * size.0, 0.5 * size.1);
        // Near a side, words move inwards.
        let at = frame.inside().without(half).nearest(at);
        let words: Vec<(Pixel, (f64, f64))> = written.iter().map(|(_, place)| *place).collect();
        let at = names::beside(at, size, (curves, &points, &words), frame.inside());
        written.push((note, (at, size)));
    }
    written
}

/// Writes the notes.
pub fn write(canvas: &Canvas, frame: &Frame, notes: &[Written<'_>]) {
    for &(note, (at, size)) in notes {
        backed(canvas, frame, at, size);
        let ink = note.colour.map_or(INK, colour);
        canvas.words(&note.text, at, Align::Middle, TEXT, ink);
    }
}

/// White behind words of that size with their middle there.
fn backed(canvas: &Canvas, frame: &Frame, at: Pixel, (width, height): (f64, f64)) {
    let backing = Window {
        x: (at.0 - 0.5 * width, at.0 + 0.5 * width),
        y: (at.1 - 0.5 * height, at.1 + 0.5 * height),
    };
    canvas.area(&frame.inside().area(&backing.corners()), PAPER)
}

/// Draws the points in the frame that are pointed out, with their names where there is room.
pub fn marks(
    canvas: &Canvas,
    panel: &Panel,
    frame: &Frame,
    curves: &[Pixel],
    notes: &[Written<'_>],
) {
    let (shown, centres) = placed(panel, frame, curves, notes);
    for (one, centre) in shown.iter().zip(&centres) {
        tie(canvas, &one.named, *centre, mark_colour(one.mark));
    }
    for one in &shown {
        bars(canvas, frame, one.mark);
    }
    for one in shown.iter().filter(|one| !one.mark.behind) {
        symbols::draw(canvas, look(one.mark), one.named.at, frame.inside());
    }
    for (one, centre) in shown.iter().zip(&centres) {
        let Shown { mark, name, named } = one;
        if !name.is_empty() {
            // Dark red is hard to read on a map.
            if panel.cells.is_some() {
                backed(canvas, frame, *centre, named.size);
            }
            canvas.words(name, *centre, Align::Middle, TEXT, mark_colour(mark));
        }
    }
}

/// The points in the frame, each with its name and how far the middle of that is from it.
pub fn named<'a>(
    panel: &'a Panel,
    frame: &Frame,
    curves: &[Pixel],
    notes: &[Written<'_>],
) -> Vec<(&'a Mark, String, Pixel)> {
    let (shown, centres) = placed(panel, frame, curves, notes);
    let both = shown.into_iter().zip(centres);
    both.map(|(one, centre)| {
        let at = one.named.at;
        (one.mark, one.name, (centre.0 - at.0, centre.1 - at.1))
    })
    .collect()
}

/// The points in the frame, and the middles of their names.
fn placed<'a>(
    panel: &'a Panel,
    frame: &Frame,
    curves: &[Pixel],
    notes: &[Written<'_>],
) -> (Vec<Shown<'a>>, Vec<Pixel>) {
    let shown = shown(panel, frame);
    let named: Vec<names::Named> = shown.iter().map(|one| one.named).collect();
    let words: Vec<(Pixel, (f64, f64))> = notes.iter().map(|(_, place)| *place).collect();
    let bars = panel.marks.iter().flat_map(|mark| bar_lines(frame, mark));
    let mut lines = curves.to_vec();
    for (line, _) in bars {
        lines.extend(names::along(&line, ALONG));
    }
    let centres = names::placed(&named, &lines, &words, frame.inside());
    (shown, centres)
}

/// Draws the points that the curves go over.
pub fn behind(canvas: &Canvas, panel: &Panel, frame: &Frame) {
    let marks = panel.marks.iter().filter(|mark| mark.behind);
    for mark in marks {
        if let Some(at) = frame.place(mark.x, mark.y) {
            symbols::draw(canvas, look(mark), at, frame.inside());
        }
    }
}

fn look(mark: &Mark) -> Look {
    Look {
        symbol: mark.symbol,
        filled: mark.filled,
        colour: mark_colour(mark),
    }
}

fn mark_colour(mark: &Mark) -> Colour {
    mark.colour.map_or(MARK, colour)
}

/// A point within the frame.
struct Shown<'a> {
    mark: &'a Mark,
    /// Its name, with those of other points that look like the same one.
    name: String,
    named: names::Named,
}

/// The points within the frame, with the sizes of their names.
fn shown<'a>(panel: &'a Panel, frame: &Frame) -> Vec<Shown<'a>> {
    let mut shown: Vec<Shown<'a>> = Vec::new();
    for mark in &panel.marks {
        let Some(at) = frame.place(mark.x, mark.y) else {
            continue;
        };
        let (size, side) = ((0.0, 0.0), mark.side);
        shown.push(Shown {
            mark,
            name: String::new(),
            named: names::Named { at, size, side },
        });
    }
    let named = |one: &Shown<'_>| !one.mark.label.is_empty();
    let crowd = shown.iter().filter(|one| named(one)).count() > CROWD;
    // Each name at the first of the points that it stands for, with those of the others.
    let mut together: Vec<(usize, Vec<(&str, usize)>)> = Vec::new();
    for (i, one) in shown.iter().enumerate().filter(|(_, one)| named(one)) {
        let near = |(first, _): &&mut (usize, Vec<(&str, usize)>)| {
            let ((x, y), (a, b)) = (shown[*first].named.at, one.named.at);
            (x - a).hypot(y - b) < if crowd { TOUCH } else { ONE }
        };
        let label = one.mark.label.as_str();
        let Some((_, names)) = together.iter_mut().find(near) else {
            together.push((i, vec![(label, 1)]));
            continue;
        };
        match names.iter_mut().find(|(name, _)| *name == label) {
            Some((_, count)) => *count += 1,
            None => names.push((label, 1)),
        }
    }
    for (i, names) in together {
        let each = names.into_iter().map(|(name, count)| match count {
            2.. if crowd => format!("{name} ×{count}"),
            _ => name.to_owned(),
        });
        let name = each.collect::<Vec<_>>().join(", ");
        shown[i].named.size = (text::width(&name, TEXT) + AIR, TEXT + AIR);
        shown[i].name = name;
    }
    shown
}

/// The bars of a point within the frame, each with whether it ends there.
fn bar_lines(frame: &Frame, mark: &Mark) -> Vec<([Pixel; 2], [bool; 2])> {
    let along = mark.bars.x.map(|(a, b)| [(a, mark.y), (b, mark.y)]);
    let across = mark.bars.y.map(|(a, b)| [(mark.x, a), (mark.x, b)]);
    let ends = along.into_iter().chain(across);
    ends.filter_map(|ends| {
        let [from, to] = ends.map(|(x, y)| frame.coordinates(x, y));
        let (start, end) = frame.window().segment(from, to)?;
        let line = [start, end].map(|at| frame.pixel(at));
        // Not where the frame cuts it.
        Some((line, [start == from, end == to]))
    })
    .collect()
}

/// Draws the bars of a point, each with a short line across at both ends.
fn bars(canvas: &Canvas, frame: &Frame, mark: &Mark) {
    let colour = mark_colour(mark);
    for (line, ends) in bar_lines(frame, mark) {
        canvas.line(&line, colour, BAR);
        let level = line[0].1 == line[1].1;
        let (dx, dy) = if level { (0.0, CAP) } else { (CAP, 0.0) };
        for ((x, y), _) in line.into_iter().zip(ends).filter(|(_, ends)| *ends) {
            canvas.line(&[(x - dx, y - dy), (x + dx, y + dy)], colour, BAR);
        }
    }
}

/// Ties a name that stands far off to its point, up to its edge.
fn tie(canvas: &Canvas, named: &names::Named, centre: Pixel, colour: Colour) {
    let off = (centre.0 - named.at.0, centre.1 - named.at.1);
    let edge = names::edge(off, named.size);
    if named.size == (0.0, 0.0) || edge.0.hypot(edge.1) <= TIED {
        return;
    }
    let end = (named.at.0 + edge.0, named.at.1 + edge.1);
    canvas.line(&[named.at, end], colour, TIE)
}
