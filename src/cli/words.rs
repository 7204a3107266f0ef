//! Numbers in messages, as people write them.

/// A count with its thousands apart: `63,183`.
pub fn count(n: usize) -> String {
    crate::error::count(n)
}

/// A count of things: `1 point`, `1,200 points`.
pub fn several(n: usize, one: &str, more: &str) -> String {
    format!("{} {}", count(n), if n == 1 { one } else { more })
}

/// A time on the clock: `21 ms`, `1.2 s`, `3 min 20 s`, `2 h 5 min`.
pub fn time(seconds: f64) -> String {
    let whole = seconds.round() as u64;
    match seconds {
        s if s < 0.0995 => format!("{:.0} ms", (1e3 * s).max(1.0)),
        s if s < 0.995 => format!("{s:.2} s"),
        s if s < 59.95 => format!("{s:.1} s"),
        _ if whole < 3600 => format!("{} min {} s", whole / 60, whole % 60),
        _ => format!("{} h {} min", whole / 3600, whole % 3600 / 60),
    }
}
