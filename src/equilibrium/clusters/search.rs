//! Where the equilibria of a share of the branches are: one bracket of the middle rate x for each, and none overlooked.
//!
//! Under the stress of x the rates of the interfaces add up to F(x) + V_H. The middle branch is cut into cells, finer towards the extrema
//! and halved where that is needed. In a cell F has no zero, or is monotonic, or is cut further: all signs are those of interval
//! arithmetic. The cells serve all shares.
//!
//! Neumaier, A. (1990). Interval Methods for Systems of Equations, chapter 5. Cambridge University Press.

use super::cell::{Cell, between_nodes, weighted};
use super::curve::{FAST, MIDDLE, Rates, SteadyCurve};
use crate::number::{Interval, Real, log_ratio};

/// The first cells towards an extremum, in ln x.
const INNERMOST: f64 = 1e-3;
/// A cell is larger by this than the next one towards the extremum, and at most so large.
const GRADING: f64 = 1.3;
const LARGEST: f64 = 0.3;
/// Times that a cell is halved, at most: to the rounding of its ends.
const DEEPEST: usize = 44;
/// Cells beyond the first ones that are looked at for a share, at most.
const MOST: usize = 20_000;

/// Cells of the middle branch.
pub(super) struct Cells<'a> {
    pub curve: SteadyCurve<'a>,
    cells: Vec<Cell>,
    /// The first of the two parts of a cell that was cut.
    parts: Vec<Option<usize>>,
    /// How many cover the branch.
    roots: usize,
}

/// What is found of a share.
#[derive(Debug, Default)]
pub(super) struct Isolation {
    /// From where to where F changes its sign once, and its sign at the lower end.
    pub brackets: Vec<(f64, f64, f64)>,
    /// Whether there is another one whose middle rate is smaller than any double.
    pub at_rest: bool,
    pub certain: bool,
}

impl<'a> Cells<'a> {
    /// The middle branch as far as rates up to V_H need it.
    pub fn new(curve: SteadyCurve<'a>, driving: f64) -> Self {
        let enough = 2.0 * driving;
        let low = curve.peak.unwrap_or_else(|| {
            let mut x = curve.trough.map_or(driving, Interval::leading);
            while x > f64::MIN_POSITIVE && curve.rates(x)[FAST] < enough {
                x = (x / 8.0).max(f64::MIN_POSITIVE);
            }
            Interval::constant(x)
        });
        let high = curve.trough.unwrap_or(Interval::constant(
            enough.min(f64::MAX).max(low.leading() * 2.0),
        ));
        let nodes = nodes(&curve, low, high);
        let cells: Vec<Cell> = nodes
            .windows(2)
            .map(|ends| Cell::new(&curve, ends[0], ends[1]))
            .collect();
        Cells {
            curve,
            parts: vec![None; cells.len()],
            roots: cells.len(),
            cells,
        }
    }

    /// Brackets of all equilibria with so many interfaces on each branch.
    pub fn isolate(&mut self, counts: &Rates<usize>, driving: f64) -> Isolation {
        let sign = |rates: &Rates<Interval>| (weighted(counts, rates) - driving).sign();
        let mut found = Isolation {
            certain: true,
            ..Isolation::default()
        };
        let (begin, end) = (self.cells[0].low, self.cells[self.roots - 1].high);
        let mut run = Run {
            sign: sign(&begin),
            from: begin[MIDDLE].leading(),
            open: false,
        };
        // tau_ss falls from infinity: at rest the fast rate is infinite
        if self.curve.peak.is_none() && counts[FAST] > 0 && counts[MIDDLE] > 0 {
            match run.sign {
                Some(sign) => found.at_rest = sign < 0.0,
                None => found.certain = false,
            }
        }
        if sign(&between_nodes(&begin, &end)).is_some() {
            return found;
        }
        let mut left = self.roots + MOST;
        for root in 0..self.roots {
            let mut open = vec![(root, 0)];
            while let Some((i, depth)) = open.pop() {
                let cell = &self.cells[i];
                left = left.saturating_sub(1);
                if let Some(sign) = cell.excess(counts, driving).sign() {
                    run.close(&mut found, cell.low[MIDDLE].leading(), Some(sign));
                } else if cell.slope_sign(counts).is_some() {
                    run.opened(cell.low[MIDDLE].leading());
                } else if depth < DEEPEST && left > 0 {
                    let first = self.parts_of(i);
                    open.extend([(first + 1, depth + 1), (first, depth + 1)]);
                } else {
                    run.close(&mut found, cell.low[MIDDLE].leading(), sign(&cell.low));
                    run.sign = sign(&cell.high);
                    found.certain = false;
                }
            }
        }
        if run.open {
            run.close(&mut found, end[MIDDLE].leading(), sign(&end));
        }
        found
    }

    /// The first of the two parts of a cell.
    fn parts_of(&mut self, i: usize) -> usize {
        if let Some(first) = self.parts[i] {
            return first;
        }
        let Cell {
            low, high, middle, ..
        } = self.cells[i];
        let first = self.cells.len();
        let halves = [(low, middle), (middle, high)].map(|(a, b)| Cell::new(&self.curve, a, b));
        self.cells.extend(halves);
        self.parts.extend([None; 2]);
        self.parts[i] = Some(first);
        first
    }
}

/// Cells in a row in all of which F is monotonic: in one sense, as they share their ends.
struct Run {
    /// The sign of F where the last one without a zero, or the branch itself, ended.
    sign: Option<f64>,
    from: f64,
    open: bool,
}

impl Run {
    fn opened(&mut self, from: f64) {
        if !self.open {
            (self.open, self.from) = (true, from);
        }
    }

    /// Here F has this sign.
    fn close(&mut self, found: &mut Isolation, to: f64, sign: Option<f64>) {
        if self.open {
            match (self.sign, sign) {
                (Some(left), Some(right)) if left == right => {}
                (Some(left), Some(_)) => found.brackets.push((self.from, to, left)),
                _ => found.certain = false,
            }
        }
        (self.sign, self.open) = (sign, false);
    }
}

/// The ends of the first cells.
fn nodes(curve: &SteadyCurve<'_>, low: Interval, high: Interval) -> Vec<Rates<Interval>> {
    let (a, b) = (low.leading(), high.leading());
    let width = log_ratio(a, b);
    let half = 0.5 * width;
    let mut steps = Vec::new();
    let (mut at, mut step) = (0.0, INNERMOST.min(0.1 * half));
    while at + step < half {
        at += step;
        steps.push(at);
        step = (GRADING * step).min(LARGEST);
    }
    let upper = steps.iter().rev().map(|at| b * (-at).exp());
    let lower = steps.iter().map(|at| a * at.exp());
    let between: Vec<f64> = lower.chain(upper).collect();
    let mut nodes = vec![curve.enclosed(low)];
    for x in between {
        if x > low.hi() && x < high.lo() {
            nodes.push(curve.enclosed(Interval::constant(x)));
        }
    }
    nodes.push(curve.enclosed(high));
    nodes
}
