//! The scorecard: every number that the paper prints and every claim of its text that a computation can decide, beside what
//! is computed here, and beside a second, unlike computation where there is one.
//!
//! The verdict is never written down: it follows from what is printed and what is computed by the rule. All that is
//! curated is the wording of a claim, and why a number that differs must be a misprint.

mod equilibria;
mod exact;
mod fig16;
mod hopf;
mod laws;
mod localisation;
mod orbits;
mod rule;
mod runs;
mod second;
mod small_stiffness;
mod stability;
mod table1;
mod torus;

pub use rule::{Agreement, compare, difference};
pub use table1::table1;

use super::clock::timed;
use super::pieces::Pieces;
use super::product::{Make, Product};
use rayon::prelude::*;
use serde_json::{Value, json};
use std::time::Duration;
use twinslip::bifurcation::Criticality;
use twinslip::equilibrium::Verdict as Stability;
use twinslip::error::{Error, Result};
use twinslip::friction::{AnyLaw, Extremum};
use twinslip::model::Loading;
use twinslip::number::Uncertain;
use twinslip::orbit::InterfaceSystem;

/// How the entries are computed, in a sentence.
pub const METHOD: &str = "steady states and their bifurcations from closed forms and enclosed \
 zeros; orbits by multiple shooting with Taylor series at 1e-16; runs as their scenes say; \
 every entry with its own second method where it has one";

/// Table 1 again.
pub const TABLE1: Product = Product {
    id: "table1",
    title: "Coordinates of the strong resonances along the torus bifurcation curve",
    caption: "Of each resonance V_H, its logarithm and K: as printed, as computed, and as \
     computed by a second method from nodes cut to a few digits. The resonance 1:2 agrees in \
     V_H and K, and in the logarithm but for a unit of the last digit; the others are printed \
     0.3 to 4 % away from where both methods find them.",
    alt: "A table of five strong resonances, each with three numbers: printed, computed, \
     computed otherwise.",
    scenes: &["fig12"],
    make: Make::Table(table1),
};

/// All that can be held against a computation.
pub const SCORECARD: Product = Product {
    id: "scorecard",
    title: "What the paper says and what is computed",
    caption: "Every number that the text prints and every claim that a computation can \
     decide. A number agrees if rounding the computed one to the printed digits gives it, a \
     bound if it is right and tight, a claim if it holds.",
    alt: "A list of numbers and claims, each with where it is, what is printed, what is \
     computed and the verdict.",
    scenes: &[
        "fig12-period-doubling",
        "fig09",
        "fig12",
        "fig06-orbit-pitchforks",
        "fig07",
        "fig13-map",
        "fig16b-map",
        "fig05",
        "fig03a",
        "fig03b",
        "fig08b",
        "fig11",
    ],
    make: Make::Scorecard,
};

/// What a computation answers.
#[derive(Debug, Clone, PartialEq)]
pub enum Answer {
    /// To a number that is printed.
    Number(Uncertain),
    /// To a claim, in the word that the claim would have right, or in another.
    Word(&'static str),
}

/// The same by another method.
#[derive(Debug, Clone, PartialEq)]
pub struct Second {
    /// The method.
    pub method: &'static str,
    /// What it answers.
    pub value: Answer,
}

/// A number or a claim of the paper.
#[derive(Debug, Clone, PartialEq)]
pub struct Entry {
    /// Its name, unlike all others.
    pub id: &'static str,
    /// Where in the paper it is.
    pub place: &'static str,
    /// Of what.
    pub quantity: &'static str,
    /// The unit of both numbers; empty where there is none.
    pub unit: &'static str,
    /// As the paper has it.
    pub printed: &'static str,
    /// As it is computed here.
    pub computed: Answer,
    /// Once more, otherwise.
    pub second: Option<Second>,
    /// By the rule.
    pub verdict: Agreement,
    /// What the answer rests on, and what is to be said of a difference.
    pub note: String,
}

impl Entry {
    /// A number.
    fn number(
        (id, place): (&'static str, &'static str),
        quantity: &'static str,
        unit: &'static str,
        printed: &'static str,
        computed: Uncertain,
    ) -> Self {
        let computed = Answer::Number(computed);
        let (verdict, decided) = compare(printed, &computed);
        let entry = Entry {
            id,
            place,
            quantity,
            unit,
            printed,
            computed,
            second: None,
            verdict,
            note: String::new(),
        };
        if decided {
            entry
        } else {
            entry.noted(
                "the uncertainty reaches across the edge of what rounds to the \
             printed one",
            )
        }
    }

    /// A claim.
    fn claim(
        (id, place): (&'static str, &'static str),
        quantity: &'static str,
        printed: &'static str,
        computed: &'static str,
    ) -> Self {
        let computed = Answer::Word(computed);
        Entry {
            id,
            place,
            quantity,
            unit: "",
            printed,
            verdict: compare(printed, &computed).0,
            computed,
            second: None,
            note: String::new(),
        }
    }

    /// The same by another method.
    fn beside(mut self, method: &'static str, value: Answer) -> Self {
        self.second = Some(Second { method, value });
        self
    }

    /// The same number by another method.
    fn beside_number(self, method: &'static str, value: f64, uncertainty: f64) -> Self {
        self.beside(method, Answer::Number(Uncertain::new(value, uncertainty)))
    }

    /// What is to be said.
    fn noted(mut self, note: impl AsRef<str>) -> Self {
        if !self.note.is_empty() {
            self.note += "; ";
        }
        self.note += note.as_ref();
        self
    }

    /// Why a difference must be a misprint. Where there is none it says nothing.
    fn misprinted(mut self, reason: &str) -> Self {
        if self.verdict == Agreement::Differs {
            self.verdict = Agreement::Misprint;
            self = self.noted(format!("misprint: {reason}"));
        }
        self
    }
}

/// Entries that belong together.
type ScorecardSection = fn(&Pieces<'_>) -> Result<Vec<Entry>>;

/// All of them, in the order of the paper.
const SECTIONS: [ScorecardSection; 19] = [
    laws::of_section_2,
    stability::single_interface,
    equilibria::of_section_3,
    stability::two_interfaces,
    localisation::entries,
    laws::of_section_4,
    equilibria::of_section_4,
    hopf::entries,
    runs::of_fig_8,
    orbits::entries,
    small_stiffness::entries,
    runs::of_fig_11,
    torus::of_section_4_2,
    runs::of_fig_13,
    table1::entries,
    torus::of_section_4_3,
    fig16::entries,
    runs::of_fig_16,
    stability::of_the_appendix,
];

/// All entries, in the order of the paper.
///
/// # Errors
/// Those of the pieces and of the computations; [`Error::NoOrbit`] where something that must be there is not.
pub fn entries(pieces: &Pieces<'_>) -> Result<Vec<Entry>> {
    Ok(timed_entries(pieces)?.0)
}

/// The same, with the processor time that they took beside the pieces. Each section is timed by itself: a thread that waits for
/// the others may do quite different work meanwhile.
pub(super) fn timed_entries(pieces: &Pieces<'_>) -> Result<(Vec<Entry>, Duration)> {
    let sections: Vec<(Vec<Entry>, Duration)> = SECTIONS
        .par_iter()
        .map(|section| timed(|| section(pieces)))
        .map(|(entries, time)| Ok((entries?, time)))
        .collect::<Result<_>>()?;
    let time = sections.iter().map(|(_, time)| time).sum();
    let entries = sections.into_iter().flat_map(|(entries, _)| entries);
    Ok((entries.collect(), time))
}

/// What `scorecard.json` holds.
pub fn json(entries: &[Entry]) -> Value {
    let all: Vec<Value> = entries.iter().map(object).collect();
    let count = |verdict: Agreement| entries.iter().filter(|e| e.verdict == verdict).count();
    json!({
        "entries": all,
        "agrees": count(Agreement::Agrees),
        "differs": count(Agreement::Differs),
        "misprint": count(Agreement::Misprint),
    })
}

fn object(entry: &Entry) -> Value {
    let second = entry
        .second
        .as_ref()
        .map(|second| json!({"method": second.method, "computed": answer(&second.value)}));
    json!({
        "id": entry.id,
        "where": entry.place,
        "quantity": entry.quantity,
        "unit": entry.unit,
        "printed": entry.printed,
        "computed": answer(&entry.computed),
        "second": second,
        "verdict": entry.verdict.name(),
        "relative_difference": difference(entry.printed, &entry.computed),
        "note": entry.note,
    })
}

fn answer(answer: &Answer) -> Value {
    match answer {
        Answer::Number(x) => json!({"value": x.value, "uncertainty": x.uncertainty}),
        Answer::Word(word) => json!(word),
    }
}

/// The paper's two interfaces at V_H and K.
fn slab(pieces: &Pieces<'_>, driving: f64, stiffness: f64) -> Result<InterfaceSystem> {
    Ok(InterfaceSystem {
        law: pieces.law(),
        interfaces: 2,
        loading: Loading::new(driving, stiffness)?,
    })
}

/// "holds" or "fails".
fn holds(it_does: bool) -> &'static str {
    if it_does { "holds" } else { "fails" }
}

/// One of two words.
fn whether(it_is: bool, then: &'static str, otherwise: &'static str) -> &'static str {
    if it_is { then } else { otherwise }
}

/// What a piece should have had.
fn missing(what: impl Into<String>) -> Error {
    Error::NoOrbit {
        what: what.into(),
        period: None,
        hint: "the scenes of the paper must be as they were shipped",
    }
}

/// With what the parameters' own rounding to doubles may do.
fn of_rounded_parameters(x: Uncertain) -> Uncertain {
    /// In units of the last place.
    const UNITS: f64 = 16.0;
    Uncertain::new(
        x.value,
        x.uncertainty + UNITS * f64::EPSILON * x.value.abs(),
    )
}

/// V_M and V_m.
fn extrema(law: &AnyLaw) -> Result<[f64; 2]> {
    match Extremum::all(law)[..] {
        [maximum, minimum] => Ok([maximum.slip_rate.value, minimum.slip_rate.value]),
        _ => Err(missing("the spinodal law has no two extrema")),
    }
}

/// Least and greatest.
fn range(all: impl Iterator<Item = f64>) -> (f64, f64) {
    let none = (f64::INFINITY, f64::NEG_INFINITY);
    all.fold(none, |(least, most), x| (least.min(x), most.max(x)))
}

fn criticality_word(criticality: Option<Criticality>) -> &'static str {
    match criticality {
        Some(Criticality::Supercritical) => "supercritical",
        Some(Criticality::Subcritical) => "subcritical",
        Some(Criticality::Undecided) | None => "undecided",
    }
}

fn stability_word(verdict: Stability) -> &'static str {
    match verdict {
        Stability::Stable => "stable",
        Stability::Unstable => "unstable",
        Stability::Undecided => "undecided",
    }
}
