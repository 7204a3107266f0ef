//! How texts, names and numbers are written on the page.

use maud::{Markup, html};

/// Longest index of a symbol: the `crit` of `V_crit`.
const INDEX: usize = 4;

/// Longest number that is kept on one line: it fits a phone beside its label.
const NUMBER: usize = 24;

/// The text with its symbols typeset: a single letter, an underscore and a short index, as in `V_H` or `τ_ss`. Names of
/// columns such as `state_1` stay as they are.
pub fn prose(text: &str) -> Markup {
    let mut pieces = Vec::new();
    let mut rest = text;
    while let Some((before, letter, index, after)) = first_symbol(rest) {
        pieces.push((before, letter, index));
        rest = after;
    }
    html! {
        @for (before, letter, index) in pieces { (unbroken(before)) var { (letter) } sub { (index) } }
        (unbroken(rest))
    }
}

/// Browsers end lines after the hyphen of `2e-10`; not here.
fn unbroken(text: &str) -> Markup {
    html! {
        @for word in text.split_inclusive(' ') {
            @let number = word.trim_end();
            @if number.contains("e-") && number.starts_with(begins_number) && number.chars().count() <= NUMBER {
                span.unbroken { (number) } (word[number.len()..])
            } @else { (word) }
        }
    }
}

/// What is before the first symbol, its letter, its index, and what follows.
fn first_symbol(text: &str) -> Option<(&str, &str, &str, &str)> {
    for (underscore, _) in text.match_indices('_') {
        let Some(letter) = text[..underscore].chars().next_back() else {
            continue;
        };
        let start = underscore - letter.len_utf8();
        let alone = !text[..start].ends_with(in_word);
        let tail = &text[underscore + 1..];
        let end = tail.find(|c| !in_word(c)).unwrap_or(tail.len());
        let (index, after) = tail.split_at(end);
        let short = (1..=INDEX).contains(&index.chars().count()) && !index.contains('_');
        // the dot of `a_b.csv` belongs to a name, that at the end of a sentence doesn't
        let named = after
            .strip_prefix('.')
            .is_some_and(|rest| rest.starts_with(in_word));
        if letter.is_alphabetic() && alone && short && !named {
            return Some((&text[..start], &text[start..underscore], index, after));
        }
    }
    None
}

fn in_word(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

fn begins_number(c: char) -> bool {
    c.is_ascii_digit() || "+-±([".contains(c)
}

/// Paragraphs: what blank lines separate.
pub fn paragraphs(text: &str) -> Vec<String> {
    let mut found = vec![String::new()];
    for line in text.lines().map(str::trim) {
        let last = found.last_mut().expect("never empty");
        if line.is_empty() {
            found.push(String::new());
        } else {
            if !last.is_empty() {
                last.push(' ');
            }
            last.push_str(line);
        }
    }
    found.retain(|paragraph| !paragraph.is_empty());
    found
}

/// The identifier as the name of a place on the page: no blanks, nothing that an address would need to escape.
pub fn anchor(id: &str) -> String {
    id.chars()
        .map(|c| {
            if c.is_ascii_alphanumeric() || c == '_' {
                c
            } else {
                '-'
            }
        })
        .collect()
}

/// The identifier as a reader calls it: `fig07` is Figure 7, `fig05-unfolded` is Figure 5, unfolded, `table1` is Table 1; any
/// other is itself.
pub fn label(id: &str) -> String {
    for (prefix, name) in [("fig", "Figure"), ("table", "Table")] {
        let number = id
            .strip_prefix(prefix)
            .map(|rest| rest.trim_start_matches('0'));
        if let Some(number) =
            number.filter(|number| number.starts_with(|c: char| c.is_ascii_digit()))
        {
            return format!("{name}\u{a0}{}", number.replacen('-', ", ", 1));
        }
    }
    id.to_owned()
}

/// The address of a file beside the report or below it, whatever its name is: never one on another machine.
pub fn address(file: &str) -> String {
    let segments = file.split('/').filter(|segment| !segment.is_empty());
    segments.map(escaped).collect::<Vec<_>>().join("/")
}

/// RFC 3986: all but the unreserved characters as `%` and two digits.
fn escaped(segment: &str) -> String {
    let mut address = String::new();
    for byte in segment.bytes() {
        if byte.is_ascii_alphanumeric() || b"-._~".contains(&byte) {
            address.push(char::from(byte));
        } else {
            address.push_str(&format!("%{byte:02X}"));
        }
    }
    address
}

/// A link to that file, by its name.
pub fn link(file: &str) -> Markup {
    html! { a href=(address(file)) { code { (file) } } }
}

/// A time in the unit that one would say it in.
pub fn duration(seconds: f64) -> String {
    match seconds {
        s if s < 0.1 => "less than 0.1 s".into(),
        s if s < 9.95 => format!("{s:.1} s"),
        s if s < 119.5 => format!("{s:.0} s"),
        s => {
            let whole = s.round();
            format!("{:.0} min {:.0} s", (whole / 60.0).floor(), whole % 60.0)
        }
    }
}

/// A part of one in percent, with two digits: what differs by 4.4 % and by 0.022 % is not the same.
pub fn percent(part: f64) -> String {
    let percent = 100.0 * part;
    if !percent.is_finite() {
        return String::new();
    }
    if percent == 0.0 {
        return "0 %".into();
    }
    let behind = 1 - percent.abs().log10().floor() as i32;
    match usize::try_from(behind) {
        Ok(behind) if behind <= 6 => format!("{percent:.behind$} %"),
        Ok(_) => format!("{percent:.1e} %"),
        Err(_) => format!("{percent:.0} %"),
    }
}

/// A whole number in groups of three digits.
pub fn grouped(number: u64) -> String {
    let digits = number.to_string();
    let mut text = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            text.push('\u{202f}');
        }
        text.push(digit);
    }
    text
}
