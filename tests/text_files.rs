//! What is wrong in the file of a system is told in one sentence with its place, whatever it is.

use crate::command;
use command::{folder, run};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use std::fs;
use std::path::{Path, PathBuf};

const GOOD: &str = r#"name = "Roessler"
states = ["x", "y", "z"]
[parameters]
a = 0.2
b = 0.2
c = 2.5
[rates]
x = "-y - z"
y = "x + a*y"
z = "b + z*rate"
[where]
rate = "x - c"
[start]
x = 1.0
y = 1.0
z = 0.0
"#;

/// Exit status and standard error of a short run of this file.
fn run_of(path: &Path) -> (i32, String) {
    let path = path.to_str().expect("a path");
    let run = run(&[
        "integrate",
        "--system",
        path,
        "--until",
        "1e-3",
        "--max-steps",
        "1000",
        "--final-only",
    ]);
    (run.code, run.err)
}

fn written(place: &Path, text: impl AsRef<[u8]>) -> PathBuf {
    let path = place.join("system.toml");
    fs::write(&path, text).expect("a file");
    path
}

#[test]
fn mistakes_are_told_by_line_and_column() {
    let place = folder("text_mistakes");
    let changed = |from: &str, to: &str| {
        assert!(GOOD.contains(from), "{from}");
        GOOD.replacen(from, to, 1)
    };
    let cases = [
        (
            changed("x + a*y", "x + aa*y"),
            "9:10: \"aa\" is no state, no parameter and not defined in [where]; did you mean \"a\"?",
        ),
        (
            changed("x + a*y", "x + a*time"),
            "9:12: \"time\" is no state: in formulas time is called t",
        ),
        (
            changed("x + a*y", "x + a y"),
            "9:12: `y` stands where an operator is expected; products need `*`",
        ),
        (
            changed("x + a*y", "2x + a*y"),
            "9:7: `x` stands where an operator is expected",
        ),
        (changed("x + a*y", "x + (a*y"), "9:10: `(` is not closed"),
        (changed("x + a*y", "x + a*y)"), "9:13: `)` closes nothing"),
        (
            changed("x + a*y", "x + a**y"),
            "9:11: `**` is no operator; powers are written with ^",
        ),
        (
            changed("x + a*y", "x + a*"),
            "9:12: the formula ends where a number, a name or `(` is expected",
        ),
        (
            changed("x + a*y", "x + *y"),
            "9:10: `*` stands where a number",
        ),
        (
            changed("x + a*y", ""),
            "9:5: the formula ends where a number",
        ),
        (
            changed("x + a*y", "x + sn(y)"),
            "9:10: \"sn\" is no function",
        ),
        (
            changed("x + a*y", "x + sin(y, a)"),
            "9:10: \"sin\" takes one argument, and has 2 here",
        ),
        (
            changed("x + a*y", "x + min(y)"),
            "9:10: \"min\" takes two arguments, and has 1 here",
        ),
        (
            changed("x + a*y", "x + sin"),
            "9:10: \"sin\" is a function, whose argument must follow in parentheses",
        ),
        (
            changed("x + a*y", "x + ()"),
            "9:11: `)` stands where a number",
        ),
        (
            changed("x + a*y", "x + min(x,)"),
            "9:16: `)` stands where a number",
        ),
        (
            changed("x + a*y", "x + sin()"),
            "9:14: `)` stands where a number",
        ),
        (
            changed("x + a*y", "x % a"),
            "9:8: `%` is no operator; there are + - * / ^",
        ),
        (
            changed("x + a*y", "x^5000"),
            "9:8: a whole exponent is 5000, but must be between -1024 and 1024",
        ),
        (
            changed("x + a*y", "1e999*x"),
            "9:6: 1e999 is beyond the range of numbers",
        ),
        (
            changed("x + a*y", "system('ls')"),
            "9:6: \"system\" is no function",
        ),
        (
            changed("x - c", "x - rate"),
            "12:13: \"rate\" is defined by itself",
        ),
        (
            changed("rate = \"x - c\"", "rate = \"x - d\"\nd = \"rate\""),
            "is defined by \"",
        ),
        (changed("a = 0.2", "x = 0.2"), "4:1: \"x\" is given twice"),
        (
            changed("a = 0.2", "sin = 0.2"),
            "4:1: \"sin\" is reserved in formulas",
        ),
        (
            changed("a = 0.2", "a = \"0.2\""),
            "4:5: a number is expected here, not string",
        ),
        (
            changed("a = 0.2", "a = nan"),
            "4:5: nan is not a finite number",
        ),
        (
            changed("a = 0.2", "\"a b\" = 0.2"),
            "4:1: \"a b\" is not a name",
        ),
        (
            changed("z = \"b + z*rate\"\n", ""),
            "the state z has no formula in [rates]",
        ),
        (
            changed("z = \"b", "zz = \"b"),
            "10:1: \"zz\" is no state, there are x, y, z; did you mean \"z\"?",
        ),
        (changed("z = 0.0", "w = 0.0"), "16:1: \"w\" is no state"),
        (
            changed("[where]", "[were]"),
            "11:2: unknown key \"were\", there are name, states, parameters, period, rates, where, start; did you mean \"where\"?",
        ),
        (
            changed("name = \"Roessler\"\n", ""),
            "1:1: the key name is missing",
        ),
        (
            changed("[\"x\", \"y\", \"z\"]", "[]"),
            "2:10: there are 0 states, but there must be 1 to 100",
        ),
        (
            changed("[\"x\", \"y\", \"z\"]", "\"x\""),
            "2:10: states must be a list of names, not string",
        ),
        (
            changed("\"x\", \"y\"", "\"time\", \"y\""),
            "2:11: no state can be called time",
        ),
        (changed("[rates]", "[rates"), "7:"),
    ];
    for (text, told) in cases {
        let path = written(&place, &text);
        let (code, err) = run_of(&path);
        assert_eq!(code, 2, "{told}: {err}");
        assert!(
            err.starts_with("error: ") && err.contains(told),
            "{told}: {err}"
        );
        assert!(err.contains("system.toml:"), "{err}");
        assert_eq!(err.lines().count(), 1, "{err}");
    }
    // An escape moves letters: then the begin of the formula is told.
    let path = written(&place, changed("x + a*y", "x\\u0020+ aa*y"));
    assert!(
        run_of(&path)
            .1
            .contains("system.toml:9:5: \"aa\" is no state")
    );
}

#[test]
fn depth_and_size_are_bounded() {
    let place = folder("text_bounds");
    let refused = |text: String, told: &str| {
        let (code, err) = run_of(&written(&place, &text));
        assert!(
            code == 2 && err.contains(told),
            "{code}: {}",
            &err[..err.len().min(400)]
        );
        assert_eq!(err.lines().count(), 1);
    };
    let with = |formula: &str| GOOD.replacen("x + a*y", formula, 1);
    let nested = |n: usize| format!("{}x{}", "(".repeat(n), ")".repeat(n));
    assert_eq!(run_of(&written(&place, with(&nested(60)))).0, 0);
    refused(with(&nested(70)), "are nested more than 64 deep");
    refused(with(&nested(1900)), "are nested more than 64 deep");
    refused(with(&nested(20_000)), "at most 4000 are allowed");
    refused(
        with(&format!("{}x", "-".repeat(70))),
        "are nested more than 64 deep",
    );
    refused(
        with(&format!("x{}", "^x".repeat(70))),
        "are nested more than 64 deep",
    );
    refused(
        with(&format!("{}x", "sin(".repeat(900))),
        "are nested more than 64 deep",
    );
    let long = vec!["x"; 1900].join("+");
    assert_eq!(run_of(&written(&place, with(&long))).0, 0);
    refused(with(&vec!["x"; 2100].join("+")), "at most 4000 are allowed");
    refused(
        format!("{GOOD}\n# {}", "x".repeat(70_000)),
        "it is longer than 65536 bytes",
    );
    // Formulas that double, again and again, are no larger than their text; other ones are counted.
    let doubled: String = (1..150)
        .map(|i| format!("d{i} = \"d{} + d{}\"\n", i - 1, i - 1))
        .collect();
    let text = GOOD.replacen("[where]\n", &format!("[where]\nd0 = \"x\"\n{doubled}"), 1);
    let text = text.replacen("x + a*y", "x + a*y + 1e-60*d149", 1);
    assert_eq!(run_of(&written(&place, text)).0, 0);
    let many: String = (0..190)
        .map(|i| {
            format!(
                "k{i} = \"{}\"\n",
                (0..60)
                    .map(|j| format!("{i}.{j:02}7*x"))
                    .collect::<Vec<_>>()
                    .join("+")
            )
        })
        .collect();
    refused(
        GOOD.replacen("[where]\n", &format!("[where]\n{many}"), 1),
        "",
    );
}

#[test]
fn files_that_are_none_are_refused() {
    let place = folder("text_none");
    for (path, told) in [
        (place.join("missing.toml"), "there is no such file"),
        (place.clone(), "cannot read"),
        (written(&place, b"\xff\xfe"), "it is not UTF-8"),
    ] {
        let (code, err) = run_of(&path);
        assert_eq!(code, 2, "{err}");
        assert!(err.contains(told), "{err}");
        assert_eq!(err.lines().count(), 1, "{err}");
    }
}

#[test]
fn broken_files_are_told_in_one_sentence() {
    let place = folder("text_broken");
    let mut random = ChaCha8Rng::seed_from_u64(20_261_125);
    let mut below = |n: usize| (random.next_u64() % n as u64) as usize;
    let pieces = [
        "(", ")", "\"", "[", "]", "=", "^", "**", "-", ",", ".", "e", "x", "1e400", "\n", "#",
        "'''", "\\", "\u{3b1}", "\0", "nan", "sin(", "pi", "where", "[rates]", "{", "}", "0x1f",
        "1_0", "a*", "/0", " ",
    ];
    let mut refused = 0;
    for case in 0..500 {
        let mut text = GOOD.as_bytes().to_vec();
        for _ in 0..1 + below(3) {
            let at = below(text.len());
            match below(4) {
                0 => drop(text.drain(at..(at + 1 + below(8)).min(text.len()))),
                1 => {
                    let piece = pieces[below(pieces.len())].bytes();
                    drop(text.splice(at..at, piece));
                }
                2 => {
                    let other = below(text.len());
                    text.swap(at, other);
                }
                _ => {
                    let piece = pieces[below(pieces.len())].bytes();
                    let end = (at + piece.len()).min(text.len());
                    drop(text.splice(at..end, piece));
                }
            }
        }
        let (code, err) = run_of(&written(&place, &text));
        let shown = || format!("{case}: {code}: {err}\n{}", String::from_utf8_lossy(&text));
        assert!(!err.contains("panicked"), "{}", shown());
        assert!((0..=2).contains(&code), "{}", shown());
        if code == 2 {
            refused += 1;
            assert!(
                err.starts_with("error: ") && err.len() < 1300,
                "{}",
                shown()
            );
            assert_eq!(err.lines().count(), 1, "{}", shown());
        }
    }
    // Others are good files with another number or remark.
    assert!(refused > 250, "{refused}");
}
