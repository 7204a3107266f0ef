//! Special points on pictures: their marks, and the legend that says what their names mean.

use twinslip::bifurcation::Label;
use twinslip_output::plot::{Key, Mark, PlotSeries, Stroke, Symbol};

/// The points with their labels, each once. Values that were asked for are small points, which have names only where they are few.
pub(super) fn distinct(points: impl Iterator<Item = (Label, f64, f64)>, named: bool) -> Vec<Mark> {
    /// Points nearer than this, relatively, are drawn as one.
    const SAME: f64 = 1e-6;
    /// More values than these have no names.
    const FEW: usize = 3;
    let near = |a: f64, b: f64| (a - b).abs() <= SAME * a.abs().max(b.abs());
    let mut marks: Vec<(Label, Mark)> = Vec::new();
    for (label, x, y) in points {
        let known =
            |(other, mark): &(Label, Mark)| *other == label && near(mark.x, x) && near(mark.y, y);
        if !marks.iter().any(known) {
            let text = if named { label.name() } else { "" };
            marks.push((label, Mark::new(x, y, text).symbol(symbol(label))));
        }
    }
    let values = marks.iter().filter(|(label, _)| *label == Label::Uz);
    let many = values.count() > FEW;
    let nameless = |(label, mark): (Label, Mark)| match label {
        Label::Uz if many => Mark {
            label: String::new(),
            ..mark
        },
        _ => mark,
    };
    marks.into_iter().map(nameless).collect()
}

fn symbol(label: Label) -> Symbol {
    match label {
        Label::Uz => Symbol::Dot,
        _ => Symbol::Circle,
    }
}

/// What the names of these points mean, for the legend: those of one symbol together.
pub(super) fn meanings(labels: impl Iterator<Item = Label>) -> Vec<Key> {
    meanings_of(labels.map(|label| (label, label.meaning())))
}

/// The same where a label may mean several things: each is named once.
pub(super) fn meanings_of<'a>(labels: impl Iterator<Item = (Label, &'a str)>) -> Vec<Key> {
    let present: Vec<(Label, &str)> = labels.collect();
    let key = |shape: Symbol| {
        let named = Label::ALL
            .into_iter()
            .filter(|label| *label != Label::Ep && symbol(*label) == shape);
        let words = named.filter_map(|label| {
            let mut known: Vec<&str> = Vec::new();
            for (_, meaning) in present.iter().filter(|(one, _)| *one == label) {
                if !known.contains(meaning) {
                    known.push(meaning);
                }
            }
            (!known.is_empty()).then(|| format!("{}: {}", label.name(), known.join(" or ")))
        });
        let words = words.collect::<Vec<_>>().join(", ");
        (!words.is_empty()).then_some(Key {
            symbol: shape,
            filled: true,
            colour: None,
            label: words,
        })
    };
    [Symbol::Circle, Symbol::Dot]
        .into_iter()
        .filter_map(key)
        .collect()
}

/// The rows of branches of orbits with the Hopf points at their ends. Rows and special points have the numbers of their branches; `at_hopf` makes a row of a
/// special point that is a Hopf point.
pub(super) fn with_hopf_points<R: Clone, S>(
    rows: &[R],
    special: &[S],
    numbers: (impl Fn(&R) -> usize, impl Fn(&S) -> usize),
    at_hopf: impl Fn(&S) -> Option<R>,
) -> Vec<R> {
    let mut all = Vec::new();
    for branch in rows.chunk_by(|a, b| numbers.0(a) == numbers.0(b)) {
        let number = numbers.0(&branch[0]);
        let mut of_branch = special.iter().filter(|one| numbers.1(one) == number);
        all.extend(of_branch.next().and_then(&at_hopf));
        all.extend_from_slice(branch);
        all.extend(of_branch.next_back().and_then(&at_hopf));
    }
    all
}

/// An entry of the legend for all curves of a colour, whatever their strokes: a curve without points.
pub(super) fn colour_name(name: impl Into<String>, colour: usize) -> PlotSeries {
    PlotSeries::new(name, Vec::new(), Vec::new()).colour(colour)
}

/// The legend of the strokes that occur: dashes are what is not stable, in whatever colour.
pub fn named_strokes(series: &[PlotSeries]) -> Vec<(Stroke, String)> {
    let named = [(Stroke::Solid, "stable"), (Stroke::Dashed, "unstable")];
    let occurs = |stroke| {
        let mut drawn = series.iter().filter(|one| !one.x.is_empty());
        drawn.any(|one| one.stroke == stroke)
    };
    let broken = occurs(Stroke::Dashed);
    let present = named
        .into_iter()
        .filter(|(stroke, _)| broken && occurs(*stroke));
    present
        .map(|(stroke, words)| (stroke, words.to_owned()))
        .collect()
}

#[cfg(test)]
mod test {
    use super::*;

    fn values(many: usize) -> Vec<Mark> {
        let values = (0..many).map(|i| (Label::Uz, i as f64, 1.0));
        distinct(values.chain([(Label::Hb, -1.0, 1.0)]), true)
    }

    #[test]
    fn many_values_that_were_asked_for_have_no_names() {
        let named = |marks: &[Mark]| marks.iter().filter(|mark| mark.label == "UZ").count();
        assert_eq!(named(&values(3)), 3);
        let many = values(25);
        assert_eq!((many.len(), named(&many)), (26, 0));
        assert!(many[..25].iter().all(|mark| mark.symbol == Symbol::Dot));
        assert_eq!(
            (many[25].label.as_str(), many[25].symbol),
            ("HB", Symbol::Circle)
        );
    }

    #[test]
    fn the_legend_says_what_names_mean_once_and_nothing_of_ends() {
        let labels = [Label::Hb, Label::Ep, Label::Bp, Label::Hb, Label::Uz];
        let keys = meanings(labels.into_iter());
        let words: Vec<&str> = keys.iter().map(|key| key.label.as_str()).collect();
        assert_eq!(words, ["BP: pitchfork, HB: Hopf", "UZ: value asked for"]);
        assert!(meanings([Label::Ep].into_iter()).is_empty());
    }
}
