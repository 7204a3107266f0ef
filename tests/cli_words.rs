//! What the program says of results and of itself: tables, messages, version, completions, manual, help.

use crate::command;
use crate::common::ROOT;
use command::{folder, refused, run, twinslip};
use twinslip_output::{Cell, RowWriter, TableRows};

/// What computes, and the others.
const COMPUTING: [&str; 9] = [
    "law",
    "integrate",
    "equilibria",
    "orbit",
    "section",
    "branch",
    "locus",
    "sweep",
    "fit",
];
const OTHERS: [&str; 6] = ["run", "merge", "reproduce", "figure", "completions", "man"];

/// The first columns and the last one; which are missing can be asked.
#[test]
fn tables_keep_to_the_width_of_the_terminal() {
    let names = [
        "symmetry",
        "stress",
        "state_1",
        "a_name_that_is_longer",
        "verdict",
    ];
    let names = names.map(str::to_owned);
    let units = ["", "a sigma", "", "L", ""].map(str::to_owned);
    let cells: [Cell; 5] = [
        "symmetric".into(),
        9.945522.into(),
        0.5.into(),
        1e-30.into(),
        "unstable".into(),
    ];
    let made = |width: usize| {
        let mut text = Vec::new();
        let mut table = TableRows::within(width, &mut text, &names, &units).expect("a table");
        table.row(&cells).expect("a row");
        let hidden = table.hidden().to_vec();
        (String::from_utf8(text).expect("UTF-8"), hidden)
    };
    let (whole, hidden) = made(usize::MAX);
    assert!(hidden.is_empty() && whole.lines().count() == 3, "{whole}");
    for width in [20, 30, 46, 62, 84, 85, 86, 200] {
        let (text, hidden) = made(width);
        let widest = text.lines().map(str::len).max().expect("lines");
        // Two columns there are always.
        assert!(widest <= width.max(30), "{width}: {text}");
        assert!(
            text.contains("symmetry") && text.contains("unstable"),
            "{text}"
        );
        for name in &names {
            assert_ne!(
                text.contains(name),
                hidden.contains(name),
                "{width}: {name}"
            );
        }
        assert_eq!(hidden.is_empty(), width >= 85, "{width}: {hidden:?}");
    }
}

#[test]
fn messages_write_numbers_as_people_do() {
    let ended = twinslip("integrate --driving 10 --stiffness 0.14 --until 200 -o -");
    let (count, _) = ended.err.split_once(" steps").expect("steps");
    let (thousands, rest) = count.split_once(',').expect("more than a thousand steps");
    assert!(thousands.len() <= 3 && rest.len() == 3, "{}", ended.err);
    let (_, time) = ended.err.split_once("Jacobians, ").expect("a time");
    assert!(time.trim_end().ends_with('s'), "{}", ended.err);
    // Two digits of an uncertainty, and one sign for it.
    let law = twinslip("law --points 2 --format csv");
    let remark = law
        .out
        .lines()
        .find(|line| line.contains("minimum of stress"));
    let remark = remark.expect("a remark");
    assert!(
        remark.contains("405.1126615400") && remark.contains(" ± ") && !remark.contains("+-"),
        "{remark}"
    );
    for part in remark.split(" ± ").skip(1) {
        let digits = part.split(['e', ',']).next().expect("digits");
        assert_eq!(digits.len(), "5.8".len(), "{remark}");
    }
}

#[test]
fn version_says_what_the_program_computes_with() {
    let long = run(&["--version"]);
    assert_eq!(long.code, 0);
    let version = env!("CARGO_PKG_VERSION");
    assert!(
        long.out.starts_with(&format!("twinslip {version}\n")),
        "{}",
        long.out
    );
    assert!(long.out.contains("\nSUNDIALS "), "{}", long.out);
    assert_eq!(run(&["-V"]).out, format!("twinslip {version}\n"));
    let held = crate::command::program()
        .arg("--version")
        .env("TWINSLIP_VECTORS", "none")
        .output()
        .expect("the program starts");
    let held = String::from_utf8_lossy(&held.stdout).into_owned();
    assert!(held.contains("\nvector instructions none ("), "{held}");
}

#[test]
fn how_formulas_are_carried_out_is_said() {
    let runs = [
        "--version",
        "integrate --system lorenz --until 1 --explain -q",
        "orbit --system van-der-pol --explain -q",
        "section --system lorenz --surface z=27 --returns 3 --explain -q",
    ];
    for command in runs {
        let with = |way: &str| {
            let ended = crate::command::program()
                .args(command.split(' '))
                .env("TWINSLIP_COMPILE", way)
                .env_remove("TWINSLIP_VECTORS")
                .output()
                .expect("the program starts");
            String::from_utf8_lossy(&[ended.stdout, ended.stderr].concat()).into_owned()
        };
        assert!(
            with("off").contains("in loops"),
            "{command}: {}",
            with("off")
        );
        // Where the processor has no AVX2 nothing is compiled.
        #[cfg(target_arch = "x86_64")]
        let compiles = is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma");
        #[cfg(not(target_arch = "x86_64"))]
        let compiles = false;
        let always = with("always");
        assert_eq!(
            always.contains("before the first step"),
            compiles,
            "{command}: {always}"
        );
    }
}

#[test]
fn shells_complete_commands_options_and_names() {
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let ended = run(&["completions", shell]);
        assert_eq!((ended.code, ended.err.as_str()), (0, ""), "{shell}");
        for word in COMPUTING.into_iter().chain(OTHERS) {
            assert!(ended.out.contains(word), "{shell}: {word}");
        }
        assert!(ended.out.contains("residual-strength"), "{shell}");
    }
    for shell in ["bash", "zsh", "fish"] {
        let script = run(&["completions", shell]).out;
        for name in ["dieterich-ruina", "taylor", "asymmetric"] {
            assert!(script.contains(name), "{shell}: {name}");
        }
        let solvers = cfg!(feature = "sundials");
        assert!(script.contains("cvode-bdf") || !solvers, "{shell}");
        // fish completes the names of options alone.
        let words = script.contains("orbit-pitchfork");
        assert_eq!(words, shell != "fish", "{shell}");
    }
    assert_eq!(run(&["completions", "tcsh"]).code, 2);
    let file = folder("completions").join("twinslip.bash");
    let path = file.to_str().expect("UTF-8");
    let ended = run(&["completions", "bash", "-o", path]);
    assert_eq!((ended.code, ended.out.as_str()), (0, ""));
    let said = format!("wrote the completions for bash into {path}\n");
    assert_eq!(ended.err, said);
    let written = std::fs::read_to_string(&file).expect("a script");
    assert_eq!(written, run(&["completions", "bash"]).out);
}

#[test]
fn every_command_has_a_manual_page() {
    let place = folder("man").join("new");
    let ended = run(&["man", "--out", place.to_str().expect("UTF-8")]);
    assert_eq!((ended.code, ended.out.as_str()), (0, ""));
    let pages = std::fs::read_dir(&place).expect("a folder").count();
    let said = format!("wrote {pages} pages into {}", place.display());
    assert!(ended.err.starts_with(&said), "{}", ended.err);
    let read = |name: String| std::fs::read_to_string(place.join(name)).expect("a page");
    assert!(read("twinslip.1".into()).contains("Exit status"));
    for command in COMPUTING.into_iter().chain(OTHERS) {
        let page = read(format!("twinslip-{command}.1"));
        assert!(page.starts_with(".ie") || page.contains(".TH"), "{command}");
    }
    assert!(read("twinslip-integrate.1".into()).contains("Relative local error tolerance"));
    let file = folder("man-file").join("file");
    std::fs::write(&file, "").expect("written");
    refused(&format!("man --out {}", file.display()), "cannot write");
}

#[test]
fn short_help_is_an_example_and_the_options_most_used() {
    for command in COMPUTING {
        let [short, all] = ["-h", "--help"].map(|flag| twinslip(&format!("{command} {flag}")));
        assert_eq!((short.code, all.code), (0, 0));
        let lines: Vec<&str> = short.out.lines().collect();
        assert!(lines.len() <= 16, "{}", short.out);
        assert!(lines.iter().all(|line| line.chars().count() <= 140));
        let example = lines[2].trim();
        assert!(example.starts_with(&format!("twinslip {command} ")) && all.out.contains(example));
        let options = lines.iter().filter(|line| line.starts_with("  --"));
        let options: Vec<&str> = options
            .filter_map(|line| line.split_whitespace().next())
            .collect();
        assert!(options.len() >= 7, "{}", short.out);
        for option in options {
            assert!(
                all.out.contains(&format!("{option} ")),
                "{command} {option}"
            );
        }
        assert!(short.out.contains(&format!("`twinslip {command} --help`")));
        // Not where -h is a value, nor where all is asked for.
        assert_eq!(twinslip(&format!("{command} -h --help")).out, all.out);
    }
}

#[test]
fn help_shows_an_example_that_runs() {
    for command in [
        "law",
        "integrate",
        "equilibria",
        "branch",
        "locus",
        "run",
        "man",
    ] {
        let help = twinslip(&format!("{command} --help"));
        assert_eq!(help.code, 0);
        let (_, example) = help.out.split_once("Example").expect("an example");
        assert!(
            example.contains(&format!("twinslip {command} ")),
            "{example}"
        );
        for line in example
            .lines()
            .filter_map(|line| line.trim().strip_prefix("twinslip "))
        {
            let place = folder(&format!("help-{command}"));
            let status = crate::command::program()
                .args(
                    line.replace("scenes/", &format!("{}/scenes/", ROOT))
                        .split(' '),
                )
                .current_dir(place)
                .output()
                .expect("the program starts")
                .status;
            assert!(status.success(), "{line}");
        }
    }
}
