//! The remarks that a file has behind its parameters.

use std::collections::BTreeMap;
use toml::de::DeTable;

/// What stands behind `#` on the lines of `[parameters]`, by the names of the parameters that have a remark.
pub(in crate::scene) fn remarks(text: &str) -> BTreeMap<String, String> {
    let Ok(table) = DeTable::parse(text) else {
        return BTreeMap::new();
    };
    let parameters = table.get_ref().get("parameters");
    let parameters = parameters.and_then(|value| value.get_ref().as_table());
    let remark = |end: usize| {
        let rest = text.get(end..)?.lines().next()?;
        Some(rest.trim().strip_prefix('#')?.trim().to_owned())
    };
    let all = parameters.into_iter().flat_map(|all| all.iter());
    all.filter_map(|(name, value)| Some((name.get_ref().to_string(), remark(value.span().end)?)))
        .collect()
}
