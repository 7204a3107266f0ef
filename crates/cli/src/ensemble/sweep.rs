//! The probabilities of regimes at the points of a grid.

use super::added::Added;
use super::gather::Members;
use super::member::Yield;
use super::percent;
use crate::words::{count, several};
use serde_json::{Map, Value, json};
use twinslip::section::Regime;
use twinslip_tasks::scene::EnsemblePlan;
use twinslip_tasks::views::REGIMES;

/// How often there is which regime at each row.
pub struct Tally {
    /// Of each row how many draws have each of the regimes.
    pub counts: Vec<[usize; REGIMES.len()]>,
    /// How many draws there are.
    pub draws: usize,
}

/// The number of a regime of this name.
fn regime(name: &str) -> Option<usize> {
    REGIMES.iter().position(|regime| regime.name() == name)
}

/// The regimes of all rows.
pub fn regimes(found: &Yield) -> Vec<Option<usize>> {
    let regime = |row: &Vec<_>| regime(found.word(row, "regime"));
    found.rows.iter().map(regime).collect()
}

impl Tally {
    /// Draws, one after the other: each is on all threads. Those until the run is to stop.
    pub fn of(plan: &EnsemblePlan, members: &Members<'_>, rows: usize) -> Self {
        let mut tally = Tally {
            counts: vec![[0; REGIMES.len()]; rows],
            draws: 0,
        };
        for draw in 0..plan.draws {
            let found = members.run(&plan.member(&members.drawn(draw)));
            let Some(found) = found.filter(|found| found.rows.len() == rows) else {
                continue;
            };
            tally.draws += 1;
            for (counts, regime) in tally.counts.iter_mut().zip(regimes(&found)) {
                if let Some(regime) = regime {
                    counts[regime] += 1;
                }
            }
        }
        tally
    }

    /// The part of draws that have a regime at a row.
    pub fn probability(&self, row: usize, regime: usize) -> Option<f64> {
        let count = self.counts.get(row)?[regime];
        (self.draws > 0).then(|| count as f64 / self.draws as f64)
    }

    /// The most probable regime at a row, with its probability.
    pub fn likeliest(&self, row: usize) -> Option<(usize, f64)> {
        let parts = (0..REGIMES.len()).filter_map(|i| Some((i, self.probability(row, i)?)));
        parts.reduce(|best, next| if next.1 > best.1 { next } else { best })
    }

    /// What is added to rows and put into the object: a probability of every regime that occurs, and of all rows the mean of it.
    pub fn finish(&self, estimate: &mut Yield) -> (Added, Map<String, Value>, Vec<String>) {
        let own = regimes(estimate);
        let occurs =
            |i: &usize| own.contains(&Some(*i)) || self.counts.iter().any(|counts| counts[*i] > 0);
        let mut added = Added {
            rows: vec![Vec::new(); estimate.rows.len()],
            ..Added::default()
        };
        let mut means = Map::new();
        for i in (0..REGIMES.len()).filter(occurs) {
            let name = REGIMES[i].name();
            let each = |row: usize| self.probability(row, i);
            let rows = estimate.rows.len();
            added = added.with(&format!("probability_{name}"), (0..rows).map(each));
            let sum: Option<f64> = (0..rows).map(each).sum();
            means.insert(name.into(), json!(sum.map(|sum| sum / rows.max(1) as f64)));
        }
        added.put_into(&mut estimate.object["result"]["rows"]);
        let sure = |row: usize| self.likeliest(row).filter(|&(_, part)| part >= SURE);
        let sure: Vec<usize> = (0..estimate.rows.len())
            .filter_map(|row| Some(sure(row)?.0))
            .collect();
        // What is undecided in all draws may be one regime or another.
        let open = |&&regime: &&usize| REGIMES[regime] == Regime::Undecided;
        let undecided = sure.iter().filter(open).count();
        let line = format!(
            "at {} of {} the same regime in at least {} of draws{}",
            several(sure.len() - undecided, "point", "points"),
            several(estimate.rows.len(), "point", "points"),
            percent(SURE),
            match undecided {
                0 => String::new(),
                n => format!(", at {} undecided in as many", count(n)),
            }
        );
        let lines = (self.draws > 0).then_some(line);
        (added, means, lines.into_iter().collect())
    }
}

/// A probability above which a regime is taken for sure.
pub const SURE: f64 = 0.95;
