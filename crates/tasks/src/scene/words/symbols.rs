//! The symbols that papers write for parameters and laws, and what the parameters measure.

use super::unit::Kind;

/// The parameter that V* is, which is an option and not a parameter of the model.
pub(super) const REFERENCE_RATE: &str = "reference_rate";

/// Symbols and the names of their parameters; of several symbols of one parameter the last is that of the paper and of the help.
const SYMBOLS: [(&str, &str); 19] = [
    ("a", "direct_effect"),
    ("b", "evolution_effect"),
    ("c", "residual_strength"),
    ("Dc", "slip_length"),
    ("D_c", "slip_length"),
    ("L", "slip_length"),
    ("mu0", "reference_friction"),
    ("f0", "reference_friction"),
    ("a_v", "reference_friction"),
    ("V0", REFERENCE_RATE),
    ("V*", REFERENCE_RATE),
    ("sigma", "normal_stress"),
    ("K", "stiffness"),
    ("V_H", "driving"),
    ("R", "healing_time"),
    ("eta", "damping"),
    ("b2", "second_evolution_effect"),
    ("L2", "second_slip_length"),
    ("m", "mass"),
];

/// Other names of laws.
const LAWS: [(&str, &str); 3] = [
    ("ageing", "dieterich-ruina"),
    ("aging", "dieterich-ruina"),
    ("regularised-aging", "regularised-ageing"),
];

fn found(all: &[(&'static str, &'static str)], known: &str) -> Option<&'static str> {
    let pair = all.iter().find(|(symbol, _)| *symbol == known);
    pair.map(|(_, name)| *name)
}

/// The name without the index of an interface, and the index with its line.
pub(in crate::scene) fn indexed(name: &str) -> (&str, &str) {
    let digits = name.trim_end_matches(|c: char| c.is_ascii_digit());
    match digits.strip_suffix('_') {
        Some(base) if digits.len() < name.len() => (base, &name[base.len()..]),
        _ => (name, ""),
    }
}

/// The name of a parameter: that of the symbol, with its index, or the same.
pub(super) fn parameter(symbol: &str) -> String {
    let (base, index) = indexed(symbol);
    let name = found(&SYMBOLS, symbol).map(str::to_owned);
    name.or_else(|| Some(format!("{}{index}", found(&SYMBOLS, base)?)))
        .unwrap_or_else(|| symbol.to_owned())
}

/// The symbol of a parameter, with the index of an interface; the name itself where it has none.
pub(in crate::scene) fn symbol(name: &str) -> String {
    let (base, index) = indexed(name);
    let pair = SYMBOLS.iter().rfind(|(_, known)| *known == base);
    pair.map_or_else(|| name.to_owned(), |(symbol, _)| format!("{symbol}{index}"))
}

/// The law of this name, or the same.
pub(super) fn law(name: &str) -> &str {
    found(&LAWS, name).unwrap_or(name)
}

/// What the parameter of this name measures; `None` where that is not known, as of a law from a file.
pub(super) fn measures(name: &str) -> Option<Kind> {
    Some(match indexed(name).0 {
        "driving"
        | REFERENCE_RATE
        | "direct_cutoff_rate"
        | "evolution_cutoff_rate"
        | "weakening_rate" => Kind::Velocity,
        "stiffness" => Kind::Stiffness,
        "damping" => Kind::Damping,
        "healing_time" => Kind::Time,
        "slip_length" | "second_slip_length" => Kind::Length,
        "mass" => Kind::MassPerArea,
        "normal_stress" | "stress" => Kind::Stress,
        "residual_strength"
        | "direct_effect"
        | "evolution_effect"
        | "second_evolution_effect"
        | "reference_friction" => Kind::Number,
        _ => return None,
    })
}
