//! All zeros of a system of equations in a box, each isolated for certain.
//!
//! A box in which an equation certainly does not vanish has no zero; one that Krawczyk's operator maps into itself has exactly
//! one. What is neither is cut in two, down to boxes too small to cut: these are undecided, as around a double zero.
//!
//! Neumaier, A. (1990). Interval Methods for Systems of Equations, chapter 5. Cambridge University Press.

use crate::model::TextSystem;
use crate::number::Interval;
use nalgebra::DMatrix;
use std::collections::VecDeque;

/// A box: a range for every variable.
pub type IntervalBox = Vec<Interval>;

/// As many equations as variables, over boxes.
pub trait Enclosed {
    /// The values of all equations, for all points of a box.
    fn values(&self, x: &[Interval]) -> Vec<Interval>;
    /// The derivatives, row by row.
    fn jacobian(&self, x: &[Interval]) -> Vec<Interval>;
}

impl Enclosed for TextSystem {
    fn values(&self, x: &[Interval]) -> Vec<Interval> {
        self.rates(x)
    }

    fn jacobian(&self, x: &[Interval]) -> Vec<Interval> {
        TextSystem::jacobian(self, x)
    }
}

/// A zero.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct IsolatedZero {
    /// Where it is.
    pub at: Vec<f64>,
    /// It is in here.
    pub within: IntervalBox,
}

/// What there is in a box.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct ZerosInBox {
    /// Its zeros, by their first component, then by the next ones.
    pub zeros: Vec<IsolatedZero>,
    /// Boxes that may have others, or none.
    pub undecided: Vec<IntervalBox>,
}

/// Boxes that are looked at, at most: some seconds of work. It grows with the cube of the number of variables, beyond these.
const MOST: usize = 300_000;
const FEW: usize = 8;
/// A box is cut here, and not in its middle, where zeros often lie.
const CUT: f64 = 0.4871;
/// A box narrower than this, in units of 1 + |x|, is not cut.
const NARROW: f64 = 1e-9;
/// A box is made larger by this part, so that a zero on its edge lies inside.
const MARGIN: f64 = 0.1;
/// Components nearer than this part of the box are as good as equal, where zeros are put in order.
const SAME: f64 = 1e-9;
/// Times that the operator is applied to a box with one zero: it shrinks by squares.
const SHARPENED: usize = 12;

/// All zeros in a box.
pub fn zeros_in_box(equations: &dyn Enclosed, all: &[Interval]) -> ZerosInBox {
    let sizes: Vec<f64> = all
        .iter()
        .map(|x| width(*x).max(f64::MIN_POSITIVE))
        .collect();
    // The largest first: boxes around a pole, which are never decided, must not use up the work before the rest has been looked at.
    let mut open = VecDeque::from([all.to_vec()]);
    let (mut zeros, mut undecided): (Vec<IsolatedZero>, Vec<IntervalBox>) = Default::default();
    let times = all.len().max(FEW) as f64 / FEW as f64;
    let most = (MOST as f64 / times.powi(3)) as usize;
    let mut looked = 0;
    while let Some(part) = open.pop_front() {
        looked += 1;
        if looked > most {
            join(&mut undecided, part);
            continue;
        }
        match look(equations, &part) {
            Found::Nothing => {}
            Found::One(zero) => {
                let known = |other: &IsolatedZero| overlap(&other.within, &zero.within);
                if overlap(&zero.within, all) && !zeros.iter().any(known) {
                    zeros.push(zero);
                }
            }
            Found::Part(part) => {
                let narrow = |x: &Interval| width(*x) < NARROW * (1.0 + middle(*x).abs());
                if part.iter().all(narrow) {
                    join(&mut undecided, part);
                } else {
                    open.extend(halves(part, &sizes));
                }
            }
        }
    }
    // A zero may also lie in what could not be decided beside it.
    undecided.retain(|part| !zeros.iter().any(|zero| encloses(part, &zero.within)));
    // Mirror images have the same first component but for rounding.
    let key = |zero: &IsolatedZero| -> Vec<i64> {
        let parts = zero.at.iter().zip(&sizes);
        parts
            .map(|(x, size)| (x / size / SAME).round() as i64)
            .collect()
    };
    zeros.sort_by_cached_key(key);
    ZerosInBox { zeros, undecided }
}

/// The zero near a point, where it is certain that there is exactly one so near.
pub fn zero_near(equations: &dyn Enclosed, at: &[f64]) -> Option<IsolatedZero> {
    /// Distances that are tried, in units of 1 + |x|.
    const NEAR: [f64; 4] = [1e-12, 1e-10, 1e-8, 1e-6];
    let around = |by: f64| {
        at.iter()
            .map(move |x| Interval::around(*x, by * (1.0 + x.abs())))
    };
    let mut boxes = NEAR
        .into_iter()
        .map(|by| around(by).collect::<IntervalBox>());
    boxes.find_map(|near| match look(equations, &near) {
        Found::One(zero) => Some(zero),
        _ => None,
    })
}

enum Found {
    Nothing,
    One(IsolatedZero),
    /// All zeros of the box are in this part of it.
    Part(IntervalBox),
}

fn look(equations: &dyn Enclosed, part: &[Interval]) -> Found {
    let vanish = |values: &[Interval]| values.iter().all(|f| f.sign().is_none());
    if !vanish(&equations.values(part)) {
        return Found::Nothing;
    }
    let larger: IntervalBox = part
        .iter()
        .map(|x| {
            let margin = MARGIN * width(*x) + f64::EPSILON * middle(*x).abs() + f64::MIN_POSITIVE;
            Interval::new(x.lo() - margin, x.hi() + margin)
        })
        .collect();
    let Some(image) = krawczyk(equations, &larger) else {
        return Found::Part(part.to_vec());
    };
    if inside(&image, &larger) {
        let zero = sharpened(equations, meet(&image, &larger).unwrap_or(image));
        // It is the only one, and may be beside this part.
        return if overlap(&zero.within, part) {
            Found::One(zero)
        } else {
            Found::Nothing
        };
    }
    match meet(&image, part) {
        None => Found::Nothing,
        Some(smaller) => Found::Part(smaller),
    }
}

/// m - C f(m) + (1 - C J)(x - m), C the inverse of J in the middle m: all zeros of the box lie in there. `None` where J has no
/// inverse, and where something has no bounds.
fn krawczyk(equations: &dyn Enclosed, x: &[Interval]) -> Option<IntervalBox> {
    let n = x.len();
    let m: Vec<f64> = x.iter().map(|x| middle(*x)).collect();
    let jacobian = equations.jacobian(x);
    let inverse = DMatrix::from_fn(n, n, |i, j| middle(jacobian[i * n + j])).try_inverse()?;
    let point: Vec<Interval> = m.iter().map(|&m| Interval::new(m, m)).collect();
    let values = equations.values(&point);
    let exact = |x: f64| Interval::new(x, x);
    // Of many variables most equations have few.
    let with = |j: usize| -> Vec<usize> {
        let rows = (0..n).filter(|k| jacobian[k * n + j] != exact(0.0));
        rows.collect()
    };
    let with: Vec<Vec<usize>> = (0..n).map(with).collect();
    let image = |i: usize| {
        let mut sum = point[i];
        for k in 0..n {
            sum = sum - exact(inverse[(i, k)]) * values[k];
        }
        for j in 0..n {
            let mut rest = exact(f64::from(u8::from(i == j)));
            for &k in &with[j] {
                rest = rest - exact(inverse[(i, k)]) * jacobian[k * n + j];
            }
            sum = sum + rest * (x[j] - point[j]);
        }
        sum
    };
    let image: IntervalBox = (0..n).map(image).collect();
    let known = image
        .iter()
        .all(|x| x.lo().is_finite() && x.hi().is_finite());
    known.then_some(image)
}

/// The only zero in a box, as narrowly as doubles have it.
fn sharpened(equations: &dyn Enclosed, mut within: IntervalBox) -> IsolatedZero {
    for _ in 0..SHARPENED {
        let smaller = krawczyk(equations, &within).and_then(|image| meet(&image, &within));
        match smaller {
            Some(smaller) if smaller != within => within = smaller,
            _ => break,
        }
    }
    IsolatedZero {
        at: within.iter().map(|x| middle(*x)).collect(),
        within,
    }
}

fn width(x: Interval) -> f64 {
    x.hi() - x.lo()
}

fn middle(x: Interval) -> f64 {
    0.5 * x.lo() + 0.5 * x.hi()
}

/// Both parts of a box, cut across where it is widest beside the whole.
fn halves(part: IntervalBox, sizes: &[f64]) -> [IntervalBox; 2] {
    let relative = |i: &usize| width(part[*i]) / sizes[*i];
    let widest = (0..part.len()).max_by(|i, j| relative(i).total_cmp(&relative(j)));
    let widest = widest.unwrap_or(0);
    let x = part[widest];
    let at = x.lo() + CUT * width(x);
    let (mut low, mut high) = (part.clone(), part);
    low[widest] = Interval::new(x.lo(), at);
    high[widest] = Interval::new(at, x.hi());
    [low, high]
}

fn meet(a: &[Interval], b: &[Interval]) -> Option<IntervalBox> {
    let both = |(a, b): (&Interval, &Interval)| {
        let (lo, hi) = (a.lo().max(b.lo()), a.hi().min(b.hi()));
        (lo <= hi).then(|| Interval::new(lo, hi))
    };
    a.iter().zip(b).map(both).collect()
}

fn overlap(a: &[Interval], b: &[Interval]) -> bool {
    meet(a, b).is_some()
}

fn encloses(a: &[Interval], b: &[Interval]) -> bool {
    a.iter()
        .zip(b)
        .all(|(a, b)| a.lo() <= b.lo() && b.hi() <= a.hi())
}

/// Whether a lies in the interior of b.
fn inside(a: &[Interval], b: &[Interval]) -> bool {
    a.iter()
        .zip(b)
        .all(|(a, b)| b.lo() < a.lo() && a.hi() < b.hi())
}

/// Adds a box; those that touch become one.
fn join(boxes: &mut Vec<IntervalBox>, mut new: IntervalBox) {
    while let Some(i) = boxes.iter().position(|other| overlap(other, &new)) {
        let other = boxes.swap_remove(i);
        let hull =
            |(a, b): (&Interval, &Interval)| Interval::new(a.lo().min(b.lo()), a.hi().max(b.hi()));
        new = other.iter().zip(&new).map(hull).collect();
    }
    boxes.push(new);
}
