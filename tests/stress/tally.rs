//! Counts of what came out, and the table they are written to.

use super::trial::{Outcome, promised};
use super::truth::Rule;
use std::collections::BTreeMap;
use std::fmt::Write;

/// What came of the trials of one method at one tolerance.
#[derive(Debug, Clone, Default)]
pub struct Count {
    pub runs: usize,
    pub unmeasured: usize,
    pub refused: BTreeMap<&'static str, usize>,
    /// Factors measured.
    pub factors: Vec<f64>,
}

impl Count {
    fn add(&mut self, other: &Count) {
        self.runs += other.runs;
        self.unmeasured += other.unmeasured;
        for (kind, n) in &other.refused {
            *self.refused.entry(kind).or_default() += n;
        }
        self.factors.extend(&other.factors);
    }

    pub fn worst(&self) -> f64 {
        self.factors.iter().copied().fold(0.0, f64::max)
    }

    /// The part of the runs that has an answer: a state, or a singularity, which is no fault of the method.
    pub fn answered(&self) -> f64 {
        let gave_up = ["too many steps", "step too small", "sundials"];
        let without: usize = gave_up
            .iter()
            .filter_map(|kind| self.refused.get(kind))
            .sum();
        1.0 - without as f64 / self.runs as f64
    }

    fn median(&self) -> f64 {
        let mut sorted = self.factors.clone();
        sorted.sort_by(f64::total_cmp);
        sorted.get(sorted.len() / 2).copied().unwrap_or(f64::NAN)
    }
}

/// Everything counted.
#[derive(Debug, Clone, Default)]
pub struct Tally {
    /// By method, law and power of ten of the tolerance.
    counts: BTreeMap<(&'static str, &'static str, i32), Count>,
    rules: BTreeMap<Rule, usize>,
    /// What is wrong, in words.
    pub faults: Vec<String>,
    /// By method, the worst factor and where.
    worst: BTreeMap<&'static str, (f64, String)>,
}

impl Tally {
    pub fn ends_known_by(&mut self, rule: Rule) {
        *self.rules.entry(rule).or_default() += 1;
    }

    /// Notes one outcome; `place` says where, and is asked only if that is worth a word.
    pub fn note(
        &mut self,
        method: &'static str,
        law: &'static str,
        tolerance: f64,
        outcome: Outcome,
        place: impl Fn() -> String,
    ) {
        let key = (method, law, tolerance.log10().round() as i32);
        let count = self.counts.entry(key).or_default();
        count.runs += 1;
        match outcome {
            Outcome::Measured(factor) => {
                count.factors.push(factor);
                let worst = self.worst.entry(method).or_default();
                if factor > worst.0 {
                    *worst = (factor, place());
                }
                if factor.is_nan() || factor > promised(method).factor {
                    self.faults
                        .push(format!("{method}: factor {factor:.3e}, {}", place()));
                }
            }
            Outcome::Unmeasured => count.unmeasured += 1,
            Outcome::Refused(kind) => *count.refused.entry(kind).or_default() += 1,
            Outcome::Broken(what) => self.faults.push(format!("{method}: {what}, {}", place())),
        }
    }

    pub fn merge(&mut self, other: Tally) {
        for (key, count) in &other.counts {
            self.counts.entry(*key).or_default().add(count);
        }
        for (rule, n) in other.rules {
            *self.rules.entry(rule).or_default() += n;
        }
        self.faults.extend(other.faults);
        for (method, (factor, place)) in other.worst {
            let worst = self.worst.entry(method).or_default();
            if factor > worst.0 {
                *worst = (factor, place);
            }
        }
    }

    /// By method, the runs at tolerances from 1e-7 on.
    pub fn loose(&self) -> BTreeMap<&'static str, Count> {
        let mut rows = self.rows(|&(method, _, power)| (power >= -7).then_some(method));
        rows.remove(&None);
        rows.into_iter()
            .filter_map(|(method, count)| Some((method?, count)))
            .collect()
    }

    fn rows<K: Ord + Copy>(
        &self,
        key: impl Fn(&(&'static str, &'static str, i32)) -> K,
    ) -> BTreeMap<K, Count> {
        let mut rows: BTreeMap<K, Count> = BTreeMap::new();
        for (place, count) in &self.counts {
            rows.entry(key(place)).or_default().add(count);
        }
        rows
    }

    /// The tables, in Markdown.
    pub fn markdown(&self) -> String {
        let mut text = String::new();
        let scenes: usize = self.rules.values().sum();
        let runs: usize = self.counts.values().map(|count| count.runs).sum();
        writeln!(
            text,
            "{scenes} scenes, {runs} runs. How the ends are known:\n"
        )
        .expect("to memory");
        text += "| rule | scenes |\n|---|---|\n";
        for (rule, n) in &self.rules {
            let rule = format!("{rule:?}").to_lowercase();
            writeln!(text, "| {rule} | {n} |").expect("to memory");
        }
        text += "\n| method | tolerance | runs | met | unmeasured | refused | worst factor | median factor | stated |\n";
        text += "|---|---|---|---|---|---|---|---|---|\n";
        for ((method, power), count) in self.rows(|&(method, _, power)| (method, -power)) {
            line(
                &mut text,
                method,
                &format!("1e-{power}"),
                &count,
                promised(method).factor,
            );
        }
        text += "\n| method | law | runs | met | unmeasured | refused | worst factor | median factor | stated |\n";
        text += "|---|---|---|---|---|---|---|---|---|\n";
        for ((method, law), count) in self.rows(|&(method, law, _)| (method, law)) {
            line(&mut text, method, law, &count, promised(method).factor);
        }
        text += "\nThe worst of each method:\n\n";
        for (method, (factor, place)) in &self.worst {
            writeln!(text, "- {method}, {factor:.2e}: {place}").expect("to memory");
        }
        text
    }
}

fn line(text: &mut String, method: &str, second: &str, count: &Count, promise: f64) {
    let met = count.factors.iter().filter(|&&f| f <= promise).count();
    let kinds: Vec<_> = count
        .refused
        .iter()
        .map(|(kind, n)| format!("{n} {kind}"))
        .collect();
    let refused = if kinds.is_empty() {
        "-".into()
    } else {
        kinds.join(", ")
    };
    writeln!(
        text,
        "| {method} | {second} | {} | {met} | {} | {refused} | {:.1e} | {:.1e} | {promise} |",
        count.runs,
        count.unmeasured,
        count.worst(),
        count.median(),
    )
    .expect("to memory");
}
