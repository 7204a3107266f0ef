//! What is compared between the members of an ensemble: things with numbers, such as rows, equilibria and special points, and which of
//! one member is which of another.

use std::collections::BTreeMap;

/// A number of a thing.
#[derive(Debug, Clone, PartialEq)]
pub struct Measured {
    /// Its name, as that of a column.
    pub name: String,
    /// Its value; NaN where it has none.
    pub value: f64,
    /// Whether it is positive, and its logarithm is what has a band.
    pub log: bool,
}

impl Measured {
    /// A number of any sign.
    pub fn linear(name: impl Into<String>, value: f64) -> Self {
        Measured {
            name: name.into(),
            value,
            log: false,
        }
    }

    /// A positive number.
    pub fn log(name: impl Into<String>, value: f64) -> Self {
        Measured {
            name: name.into(),
            value,
            log: true,
        }
    }

    /// On the scale on which it has a band.
    pub fn scaled(&self) -> f64 {
        match self.log {
            true => self.value.ln(),
            false => self.value,
        }
    }

    /// From that scale back.
    pub fn unscaled(&self, x: f64) -> f64 {
        if self.log { x.exp() } else { x }
    }
}

/// A thing.
#[derive(Debug, Clone, PartialEq)]
pub struct Item {
    /// What it is: only things of one class can be the same.
    pub class: String,
    /// Where it is among these: they are sorted by it, and the nearest is found.
    pub place: Vec<f64>,
    /// Its numbers, of all of a class the same.
    pub numbers: Vec<Measured>,
    /// What may be so or not, as that it is stable.
    pub holds: bool,
}

/// Which thing of a member each of these is, if any.
///
/// Where there are equally many of a class they are the same in their order; else those that are nearest to each other.
pub fn matched(these: &[Item], others: &[Item]) -> Vec<Option<usize>> {
    let (own, other) = (by_class(these), by_class(others));
    let mut all = vec![None; these.len()];
    for (class, own) in own {
        let Some(other) = other.get(class) else {
            continue;
        };
        if own.len() == other.len() {
            for (&one, &found) in own.iter().zip(other) {
                all[one] = Some(found);
            }
            continue;
        }
        let nearest = |from: &Item, among: &[usize], items: &[Item]| {
            let distance = |&i: &usize| distance(&from.place, &items[i].place);
            let found = among
                .iter()
                .copied()
                .min_by(|a, b| distance(a).total_cmp(&distance(b)));
            found.expect("no class is empty")
        };
        for &one in &own {
            let found = nearest(&these[one], other, others);
            if nearest(&others[found], &own, these) == one {
                all[one] = Some(found);
            }
        }
    }
    all
}

/// The things of each class, sorted by their places.
fn by_class(items: &[Item]) -> BTreeMap<&str, Vec<usize>> {
    let mut all: BTreeMap<&str, Vec<usize>> = BTreeMap::new();
    for (i, item) in items.iter().enumerate() {
        all.entry(&item.class).or_default().push(i);
    }
    for places in all.values_mut() {
        places.sort_by(|&a, &b| {
            let pairs = items[a].place.iter().zip(&items[b].place);
            let mut orders = pairs.map(|(x, y)| x.total_cmp(y));
            orders
                .find(|order| order.is_ne())
                .unwrap_or(std::cmp::Ordering::Equal)
        });
    }
    all
}

fn distance(one: &[f64], other: &[f64]) -> f64 {
    let pairs = one.iter().zip(other);
    let squares = pairs.map(|(x, y)| (x - y).powi(2));
    // What one of both does not have tells nothing.
    squares.filter(|x| x.is_finite()).sum()
}
