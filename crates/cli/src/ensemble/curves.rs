//! Bands of branches and of curves: at the same values of what varies, on which the curves of all members land; and of special points.

use super::added::{Added, put_band};
use super::bands::Banded;
use super::item::{Item, Measured};
use super::member::{Yield, number, word};
use super::picture::{BandsAt, PointAt};
use super::told;
use twinslip_output::Cell;
use twinslip_tasks::scene::EnsemblePlan;

/// Values of a parameter that agree to this are the same: they went into other units and back.
const SAME: f64 = 1e-9;
/// A row of the estimate is that of its second run to this: both are located to far less.
const LOCATED: f64 = 1e-6;
/// Curves land on so many values at most.
const MOST: usize = 1000;
/// And those of draws on so many.
const MOST_OF_DRAWS: usize = 40;

/// What is compared along curves.
pub struct Course<'a> {
    /// The parameter at the same values of which they are compared.
    abscissa: &'a str,
    /// What depends on it, of curves in a plane.
    ordinate: Option<&'a str>,
    /// The columns that have bands there.
    names: Vec<String>,
    /// The values, sorted.
    pub landings: Vec<f64>,
    /// Those of them on which the user wants curves to land.
    own: Vec<f64>,
    /// The names of the numbers of special points.
    special: Vec<String>,
}

fn same(one: f64, other: f64) -> bool {
    (one - other).abs() <= SAME * one.abs().max(other.abs())
}

/// How far the numbers of two rows are apart, relatively.
fn apart(one: &Item, other: &Item) -> f64 {
    let pairs = one.numbers.iter().zip(&other.numbers);
    let each = pairs.map(|(x, y)| (x.value - y.value).abs() / y.value.abs());
    each.filter(|x| x.is_finite()).fold(0.0, f64::max)
}

impl<'a> Course<'a> {
    /// Along the curves of the estimate.
    pub fn new(plan: &'a EnsemblePlan, estimate: &Yield) -> Option<Self> {
        let (abscissa, ordinate) = plan.abscissa()?;
        let is_of_interface = |name: &str| {
            let rest = ["state_", "slip_rate_"]
                .iter()
                .find_map(|base| name.strip_prefix(base));
            rest.is_some_and(|rest| rest.bytes().all(|byte| byte.is_ascii_digit()))
        };
        let wanted = |name: &&String| match (ordinate, plan.of_orbits()) {
            (Some(ordinate), _) => *name == ordinate,
            (None, true) => ["stress_min", "stress_max", "period"].contains(&name.as_str()),
            (None, false) => *name == "stress" || is_of_interface(name),
        };
        let names = estimate.columns.iter().filter(wanted).cloned().collect();
        let at = |row: &Vec<Cell>| estimate.number(row, abscissa);
        let mut landings: Vec<f64> = estimate.rows.iter().map(at).collect();
        landings.retain(|x| x.is_finite());
        landings.sort_by(f64::total_cmp);
        landings.dedup_by(|one, other| same(*one, *other));
        // The ends of the range are ends of the curves anyway.
        if landings.len() > 2 {
            landings.remove(0);
            landings.pop();
        }
        let every = landings.len().div_ceil(MOST).max(1);
        let mut landings: Vec<f64> = landings.into_iter().step_by(every).collect();
        let own = plan.own_landings();
        landings.extend(&own);
        landings.sort_by(f64::total_cmp);
        landings.dedup_by(|one, other| same(*one, *other));
        let has_bound = |name: &&String| {
            let bound = format!("{name}_uncertainty");
            **name != "coefficient" && estimate.special_columns.contains(&bound)
        };
        let special = estimate.special_columns.iter().filter(has_bound);
        Some(Course {
            abscissa,
            ordinate,
            names,
            own,
            special: special.cloned().collect(),
            landings,
        })
    }

    /// Fewer values, on which the curves of draws land: they check what is known of the others.
    pub fn thinned(&self) -> Vec<f64> {
        let every = self.landings.len().div_ceil(MOST_OF_DRAWS).max(1);
        let kept = self.landings.iter().enumerate();
        let is_own = |x: f64| self.own.iter().any(|&own| same(own, x));
        kept.filter(|(i, x)| i % every == 0 || is_own(**x))
            .map(|(_, &x)| x)
            .collect()
    }

    /// The rows of a member at the values on which curves land, each once, and at the ends.
    pub fn rows(&self, found: &Yield) -> Vec<Item> {
        let mut all: Vec<Item> = Vec::new();
        for row in &found.rows {
            let Some(item) = self.row(found, row) else {
                continue;
            };
            // A curve that closes, or two that meet, have a row twice.
            let twice = |other: &Item| other.class == item.class && apart(other, &item) <= LOCATED;
            if !all.iter().rev().any(twice) {
                all.push(item);
            }
        }
        all
    }

    fn row(&self, found: &Yield, row: &[Cell]) -> Option<Item> {
        let at = found.number(row, self.abscissa);
        let near = self.landings.partition_point(|x| *x < at);
        let candidates = [near.wrapping_sub(1), near];
        let landed = candidates
            .into_iter()
            .find(|&i| self.landings.get(i).is_some_and(|&x| same(x, at)));
        // Ends are where nothing lands.
        let place = match landed {
            Some(i) => format!("{:.6e}", self.landings[i]),
            None if self.ends(at) => format!("{at:.6e}"),
            None => return None,
        };
        let words = ["symmetry", "slow", "middle", "fast"].map(|name| found.word(row, name));
        let words = words.join(" ");
        let numbers = self.names.iter().map(|name| {
            let value = found.number(row, name);
            // A stiffness that depends on something may come down to 0, where its logarithm has no band.
            match name.starts_with("stress") || name == "stiffness" {
                true => Measured::linear(name, value),
                false => Measured::log(name, value),
            }
        });
        let numbers: Vec<Measured> = numbers.collect();
        Some(Item {
            class: format!("{} curve at {} {place}", words.trim(), self.abscissa),
            place: numbers.iter().map(Measured::scaled).collect(),
            numbers,
            holds: found.word(row, "verdict") == "stable",
        })
    }

    /// Whether a value is beyond all on which curves land.
    fn ends(&self, at: f64) -> bool {
        let (first, last) = (self.landings.first(), self.landings.last());
        first.is_none_or(|&x| at < x) || last.is_none_or(|&x| at > x)
    }

    /// The special points of a member, but those on which only the members land.
    pub fn special(&self, found: &Yield, landed: bool) -> Vec<Item> {
        let points = found.special.iter();
        let items = points.filter_map(|cells| self.special_point(found, cells, landed));
        items.collect()
    }

    fn special_point(&self, found: &Yield, cells: &[Cell], landed: bool) -> Option<Item> {
        let cell = |name: &str| {
            let at = found.special_columns.iter().position(|own| own == name);
            at.map_or(&Cell::Missing, |at| &cells[at])
        };
        let label = word(cell("label"));
        let at = number(cell(self.abscissa));
        if landed && label == "UZ" {
            let is_in = |all: &[f64]| all.iter().any(|&x| same(x, at));
            if is_in(&self.landings) && !is_in(&self.own) {
                return None;
            }
        }
        let numbers = self.special.iter();
        let numbers: Vec<Measured> = numbers
            .map(|name| Measured::log(name, number(cell(name))))
            .collect();
        let words = [label, word(cell("name")), word(cell("symmetry"))];
        let words: Vec<&str> = words.into_iter().filter(|word| !word.is_empty()).collect();
        Some(Item {
            class: words.join(" "),
            place: std::iter::once(at.ln())
                .chain(numbers.iter().map(Measured::scaled))
                .collect(),
            numbers,
            holds: false,
        })
    }

    /// What is known of each row of the estimate, by the rows of its second run, which lands.
    pub fn of_rows<'b>(
        &self,
        estimate: &Yield,
        landed: &[Item],
        banded: &'b [Banded],
    ) -> Vec<Option<&'b Banded>> {
        let one = |row: &Vec<Cell>| {
            let item = self.row(estimate, row)?;
            let own = landed
                .iter()
                .enumerate()
                .filter(|(_, other)| other.class == item.class);
            let nearest = own.min_by(|(_, a), (_, b)| apart(a, &item).total_cmp(&apart(b, &item)));
            let (i, found) = nearest?;
            (apart(found, &item) <= LOCATED).then(|| &banded[i])
        };
        estimate.rows.iter().map(one).collect()
    }

    /// Where a picture shows the rows, with their bands.
    pub fn shown(&self, estimate: &Yield, rows: &[Option<&Banded>]) -> BandsAt {
        let mut at = BandsAt::default();
        for (row, known) in estimate.rows.iter().zip(rows) {
            let bands = known.iter().flat_map(|known| &known.bands);
            for (name, band) in self.names.iter().zip(bands) {
                let Some(ends) = band.linear else { continue };
                let x = estimate.number(row, self.abscissa);
                at.put(x, estimate.number(row, name), ends);
                // Of equilibria a picture shows the largest stress, which is the only one.
                if name == "stress" {
                    at.put(x, estimate.number(row, "stress_max"), ends);
                }
            }
        }
        at
    }

    /// Where a picture shows the special points: those of curves in a plane in it, those of branches at their parameter.
    pub fn points(&self, items: &[Item], special: &[Banded]) -> Vec<PointAt> {
        let of = |name: &str| self.special.iter().position(|own| own == name);
        let Some(abscissa) = of(self.abscissa) else {
            return Vec::new();
        };
        let ordinate = self.ordinate.and_then(of);
        let both = items.iter().zip(special);
        both.map(|(item, known)| PointAt {
            x: item.numbers[abscissa].value,
            y: ordinate.map(|i| item.numbers[i].value),
            along: known.bands[abscissa].linear,
            across: ordinate.and_then(|i| known.bands[i].linear),
        })
        .collect()
    }

    /// What is added to rows and special points, and put into the object; and the special points in words.
    pub fn finish(
        &self,
        estimate: &mut Yield,
        rows: &[Option<&Banded>],
        (items, special): (&[Item], &[Banded]),
    ) -> (Added, Added, Vec<String>) {
        let of_rows = Added::bands(estimate, &self.names, rows);
        let known: Vec<Option<&Banded>> = special.iter().map(Some).collect();
        let of_special = Added::bands(estimate, &self.special, &known)
            .with("probability", special.iter().map(|one| one.probability));
        let result = &mut estimate.object["result"];
        of_rows.put_into(&mut result["rows"]);
        let objects = result["special"].as_array_mut();
        for (object, known) in objects.into_iter().flatten().zip(special) {
            let Some(object) = object.as_object_mut() else {
                continue;
            };
            for (name, band) in self.special.iter().zip(&known.bands) {
                put_band(object, name, band);
            }
            object.insert("probability".into(), known.probability.into());
        }
        let lines = items.iter().zip(special);
        let lines = lines.filter(|(item, _)| !item.class.starts_with("EP"));
        (
            of_rows,
            of_special,
            lines.map(|(item, known)| told(item, known)).collect(),
        )
    }
}
