//! What tells one file of formulas from another: a number that comments, spaces and values of parameters do not change.

use sha2::{Digest, Sha256};
use toml::de::{DeTable, DeValue};

/// What of a file is told elsewhere, or changes nothing.
const LEFT_OUT: [&str; 2] = ["name", "parameters"];
/// Bytes of the digest that are told: enough that no two files of a user share them.
const TOLD: usize = 8;

/// The first digits of the SHA-256 of the states, formulas and start of a file, as hexadecimal digits.
pub fn fingerprint(table: &DeTable<'_>) -> String {
    let mut hasher = Sha256::new();
    take_table(&mut hasher, table, &LEFT_OUT);
    let digest = hasher.finalize();
    let digits = digest[..TOLD].iter().map(|byte| format!("{byte:02x}"));
    digits.collect()
}

/// Keys in the order of their names: that of the file means nothing.
fn take_table(hasher: &mut Sha256, table: &DeTable<'_>, left_out: &[&str]) {
    let mut entries: Vec<_> = table.iter().collect();
    entries.sort_by(|a, b| a.0.get_ref().cmp(b.0.get_ref()));
    for (key, value) in entries {
        let key: &str = key.get_ref();
        if !left_out.contains(&key) {
            take_text(hasher, key);
            take(hasher, value.get_ref());
        }
    }
    hasher.update([0]);
}

fn take(hasher: &mut Sha256, value: &DeValue<'_>) {
    match value {
        DeValue::String(text) => take_text(hasher, text),
        DeValue::Integer(number) => take_text(hasher, number.as_str()),
        DeValue::Float(number) => take_text(hasher, number.as_str()),
        DeValue::Boolean(value) => take_text(hasher, &value.to_string()),
        DeValue::Datetime(time) => take_text(hasher, &time.to_string()),
        DeValue::Array(items) => {
            items.iter().for_each(|item| take(hasher, item.get_ref()));
            hasher.update([0]);
        }
        DeValue::Table(table) => take_table(hasher, table, &[]),
    }
}

/// A text without its spaces, and where it ends.
fn take_text(hasher: &mut Sha256, text: &str) {
    for word in text.split_whitespace() {
        hasher.update(word.as_bytes());
    }
    hasher.update([0]);
}
