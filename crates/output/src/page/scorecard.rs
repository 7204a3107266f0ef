//! The scorecard: what differs first, then misprints, then what agrees.

use super::Score;
use super::words::{anchor, percent, prose};
use maud::{Markup, html};

/// Entries of one verdict.
struct Group<'a> {
    verdict: &'a str,
    scores: Vec<&'a Score>,
}

impl<'a> Group<'a> {
    /// Groups that have entries, in the order of reading. A verdict that is none of the three is shown before what agrees.
    fn all(scores: &'a [Score]) -> Vec<Group<'a>> {
        let mut verdicts = vec!["differs", "misprint"];
        for score in scores {
            if score.verdict != "agrees" && !verdicts.contains(&score.verdict.as_str()) {
                verdicts.push(&score.verdict);
            }
        }
        verdicts.push("agrees");
        verdicts
            .into_iter()
            .map(|verdict| {
                let mut scores: Vec<&Score> =
                    scores.iter().filter(|s| s.verdict == verdict).collect();
                // What can't be said in numbers differs altogether; what agrees keeps its order.
                let size = |s: &Score| s.difference.map_or(f64::INFINITY, f64::abs);
                scores.sort_by(|a, b| size(b).total_cmp(&size(a)));
                Group { verdict, scores }
            })
            .filter(|group| !group.scores.is_empty())
            .collect()
    }

    /// How many they are, in words.
    fn heading(&self) -> String {
        let n = self.scores.len();
        match (self.verdict, n) {
            ("differs", 1) => "1 entry differs".into(),
            ("differs", _) => format!("{n} entries differ"),
            ("misprint", 1) => "1 misprint".into(),
            ("misprint", _) => format!("{n} misprints"),
            ("agrees", 1) => "1 entry agrees".into(),
            ("agrees", _) => format!("{n} entries agree"),
            (other, _) => format!("{n} × {other}"),
        }
    }

    fn meaning(&self) -> &'static str {
        match self.verdict {
            "differs" => {
                "The computed value is not the printed one. Claims that fail come first, then numbers by how far they are off."
            }
            "misprint" => "The printed value is taken for a slip in print; the note says why.",
            "agrees" => "The computed value is the printed one, as far as its digits go.",
            _ => "",
        }
    }

    /// The class of the badge: a colour, besides sign and word.
    fn kind(&self) -> &'static str {
        match self.verdict {
            "differs" => "differs",
            "misprint" => "misprint",
            "agrees" => "agrees",
            _ => "other",
        }
    }

    fn place(&self) -> String {
        format!("verdict-{}", anchor(self.verdict))
    }

    fn badge(&self) -> Markup {
        let sign = match self.kind() {
            "differs" => "≠",
            "misprint" => "†",
            "agrees" => "✓",
            _ => "?",
        };
        html! { span class={ "badge " (self.kind()) } { span aria-hidden="true" { (sign) } " " (self.verdict) } }
    }
}

/// The ways to the groups, for the contents.
pub fn places(scores: &[Score]) -> Markup {
    html! {
        ol {
            @for group in &Group::all(scores) {
                li { a href={ "#" (group.place()) } { (group.heading()) } }
            }
        }
    }
}

/// The section of all entries.
pub fn section(scores: &[Score]) -> Markup {
    let groups = Group::all(scores);
    html! {
        section #scorecard aria-labelledby="scorecard-title" {
            h2 #scorecard-title { "Scorecard" }
            div.tally aria-hidden="true" {
                @for group in &groups { span class=(group.kind()) style={ "flex-grow:" (group.scores.len()) } {} }
            }
            ul.tally-key {
                @for group in &groups {
                    li { a href={ "#" (group.place()) } { (group.badge()) " " (group.scores.len()) } }
                }
            }
            @for group in &groups { (table(group)) }
        }
    }
}

fn table(group: &Group) -> Markup {
    let second = group.scores.iter().any(|score| !score.second.is_empty());
    let difference = group.scores.iter().any(|score| score.difference.is_some());
    let columns = 5 + usize::from(second) + usize::from(difference);
    html! {
        section.verdict id=(group.place()) aria-labelledby={ (group.place()) "-title" } {
            h3 id={ (group.place()) "-title" } { (group.heading()) }
            div.scroll role="region" aria-label=(group.heading()) tabindex="0" {
                table.scores {
                    caption { (group.meaning()) }
                    thead {
                        tr {
                            th scope="col" { "Quantity" }
                            th scope="col" { "Where" }
                            th scope="col" { "Printed" }
                            th scope="col" { "Computed" }
                            @if difference { th scope="col" { "Off by" } }
                            @if second { th scope="col" { "Second method" } }
                            th scope="col" { "Verdict" }
                        }
                    }
                    @for score in &group.scores { (row(group, score, (difference, second), columns)) }
                }
            }
        }
    }
}

/// An entry, and its note below it in full width.
fn row(group: &Group, score: &Score, (difference, second): (bool, bool), columns: usize) -> Markup {
    html! {
        tbody id={ "score-" (anchor(&score.id)) } {
            tr {
                th scope="row" { (prose(&score.quantity)) " " code.id { (score.id) } }
                td data-label="Where" { (prose(&score.place)) }
                td.value data-label="Printed" { (prose(&score.printed)) }
                td.value data-label="Computed" { (prose(&score.computed)) }
                @if difference { td.value data-label="Off by" { (score.difference.map(percent).unwrap_or_default()) } }
                @if second { td.value data-label="Second method" { (prose(&score.second)) } }
                td data-label="Verdict" { (group.badge()) }
            }
            @if !score.note.is_empty() {
                tr.note { td colspan=(columns) { (prose(&score.note)) } }
            }
        }
    }
}
