//! Messages as people write and type them: numbers, and the options of this command line.

use std::collections::BTreeSet;
use std::sync::LazyLock;

/// The flags of all commands, without their hyphens in front.
static FLAGS: LazyLock<BTreeSet<String>> = LazyLock::new(|| {
    let program = super::program();
    let commands = program.get_subcommands();
    let flags =
        commands.flat_map(|command| command.get_arguments().filter_map(|arg| arg.get_long()));
    flags.map(str::to_owned).collect()
});

/// A text of the library as it is told here: an option's name in backticks becomes its flag, `max_steps` thus --max-steps. Other
/// words in backticks stay.
pub fn flagged(text: &str) -> String {
    let mut told = String::with_capacity(text.len());
    let mut rest = text;
    while let Some((before, after)) = rest.split_once('`') {
        told.push_str(before);
        let named = after.split_once('`').and_then(|(name, behind)| {
            let flag = name.replace('_', "-");
            FLAGS.contains(&flag).then_some((flag, behind))
        });
        match named {
            Some((flag, behind)) => {
                told.push_str("--");
                told.push_str(&flag);
                rest = behind;
            }
            None => {
                told.push('`');
                rest = after;
            }
        }
    }
    told.push_str(rest);
    told
}

/// A count with its thousands apart: `63,183`.
pub fn count(n: usize) -> String {
    twinslip::error::count(n)
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
