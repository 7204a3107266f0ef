//! The command line as a user meets it: exit codes, messages, files.

use crate::command;
use command::{contents, csv, folder, object, run, twinslip};
use std::io::{BufRead, BufReader};
use std::process::{Command, Stdio};
use twinslip::output::{Cell, RowWriter, TableRows};

const RUN: &str = "integrate --driving 0.12 --stiffness 0.14 --until 10";

/// Exit code 2, nothing on standard output, and the sentence.
fn refused(arguments: &str, sentence: &str) {
    let ended = twinslip(arguments);
    assert_eq!(ended.code, 2, "{arguments}: {}", ended.err);
    assert_eq!(ended.out, "", "{arguments}");
    assert!(
        ended.err.starts_with("error: ") && ended.err.contains(sentence),
        "{arguments}: {}",
        ended.err
    );
}

#[test]
fn parameters_outside_their_domain_are_refused() {
    let model = |change: &str| format!("{RUN} {change}");
    for value in ["0", "-1"] {
        refused(
            &format!("integrate --driving {value} --stiffness 0.14 --until 10"),
            &format!("driving is {value}, but must be positive and finite"),
        );
        refused(
            &format!("integrate --driving 1 --stiffness {value} --until 10"),
            &format!("stiffness is {value}, but must be positive and finite"),
        );
        refused(
            &format!("integrate --driving 1 --stiffness 1 --until {value}"),
            &format!("until is {value}, but must be positive and finite"),
        );
        refused(
            &model(&format!("--healing-time {value}")),
            &format!("healing-time is {value}, but must be positive and finite"),
        );
        refused(
            &model(&format!("--start 10,{value},0.1")),
            &format!("psi in --start is {value}, but must be positive and finite"),
        );
        refused(&model(&format!("--rtol {value}")), "rtol is");
        refused(&model(&format!("--atol {value}")), "atol is");
        refused(&model(&format!("--every {value}")), "every is");
        refused(
            &model(&format!("--direct-effect {value}")),
            "direct-effect is",
        );
        refused(
            &format!("equilibria --driving {value}"),
            &format!("driving is {value}, but must be positive and finite"),
        );
        refused(&format!("law --from {value}"), "from is");
    }
    refused(&model("--residual-strength -1"), "residual-strength is -1");
    refused(
        &model("--interfaces 3"),
        "interfaces is 3, but must be 1 or 2",
    );
    refused(
        &model("--max-steps 0"),
        "max-steps is 0, but must be at least 1",
    );
    refused(&model("--points 1"), "points is 1, but must be from 2");
    refused(
        &model("--rtol 1"),
        "rtol is 1, but must be at least 1e-16 and less than 1",
    );
    for atol in ["0", "1", "1e20"] {
        refused(
            &model(&format!("--atol {atol}")),
            &format!("atol is {atol}, but must be greater than 0 and less than 1"),
        );
    }
    for command in [
        "section --driving 10 --stiffness 0.14 --atol 1e20",
        "orbit --driving 10 --stiffness 0.14 --atol 1e20",
        "orbit --driving 10 --stiffness 0.14 --rtol 1e-8 --atol 1e20",
    ] {
        refused(command, "atol is 1e20, but must be");
    }
    refused(
        &model("--law byerlee"),
        "law is byerlee, but must be one of spinodal",
    );
    refused(
        &model("--format xml"),
        "format is xml, but must be table, csv or json",
    );
    refused(
        &model("--events --event-threshold 0.5"),
        "event-threshold is 0.5",
    );
    refused("law --from 2 --to 1", "--from must be less than --to");
    refused(
        "equilibria --driving 1 --solver gauss",
        "solver is gauss, but must be kinsol or newton",
    );
}

#[test]
fn wrong_sections_are_refused() {
    let section = |change: &str| {
        format!("section --driving 0.1 --stiffness 0.2 --skip 5 --returns 5 {change}")
    };
    for surface in ["10", "stress=", "stress=high", "stress=nan", "state=1"] {
        refused(
            &section(&format!("--surface {surface}")),
            &format!("--surface \"{surface}\" must be stress=auto or stress=VALUE"),
        );
    }
    refused(
        &section("--patience 0"),
        "patience is 0, but must be positive",
    );
    refused(&section("--max-steps 0"), "max-steps is 0");
    refused(
        &section("--lyapunov"),
        "returns is 5, but must be at least 60",
    );
    refused(&section("--plot map.txt"), "must end in .svg or .png");
    refused(
        "section --driving 0.1 --stiffness 0.2 --returns 0",
        "returns is 0, but must be from 1",
    );
    refused("section --stiffness 0.2", "--driving V_H is missing");
}

/// A run that never comes to the surface ends with status 1, says where it has been, and keeps the header.
#[test]
fn a_surface_that_is_not_met_is_told() {
    let ended = twinslip(
        "section --driving 10 --stiffness 0.14 --surface stress=20 --patience 50 --format csv",
    );
    assert_eq!(ended.code, 1, "{}", ended.err);
    assert!(
        ended.err.contains("no return to the section from t = 0")
            && ended.err.contains("lies at 20"),
        "{}",
        ended.err
    );
    assert!(ended.out.contains("n,time,log_state_1"), "{}", ended.out);
    let explained = twinslip(
        "section --driving 10 --stiffness 0.14 --skip 9 --returns 9 --explain --format csv",
    );
    for line in ["dimension", "section", "returns", "periodicity", "tangents"] {
        assert!(explained.err.contains(line), "{}", explained.err);
    }
}

#[test]
fn a_state_above_one_is_refused_where_the_law_bounds_it() {
    for law in ["spinodal", "bounded"] {
        refused(
            &format!("{RUN} --law {law} --start 10,1.5,0.1"),
            "psi in --start is 1.5, but must be in (0, 1]",
        );
    }
    let free = twinslip(&format!("{RUN} --law dieterich-ruina --start 10,1.5,0.1"));
    assert_eq!(free.code, 0, "{}", free.err);
}

#[test]
fn what_is_no_finite_number_is_refused() {
    for name in ["driving", "stiffness", "until", "rtol", "healing-time"] {
        for value in ["nan", "inf", "-inf"] {
            refused(
                &format!("integrate --{name}={value}"),
                "must be a finite number",
            );
        }
        refused(&format!("integrate --{name}=ten"), "is not a number");
        let empty = run(&["integrate", &format!("--{name}="), "--interfaces", "1"]);
        assert_eq!(empty.code, 2, "{}", empty.err);
    }
    for start in [
        "nan,0.1,0.1",
        "10,inf,0.1",
        "10,,0.1",
        "near-symmetric:x",
        "ten",
    ] {
        refused(&format!("{RUN} --start {start}"), "is not a finite number");
    }
    refused(&format!("{RUN} --start 10,0.1"), "must be TAU,PSI1,PSI2");
    refused(
        &format!("{RUN} --interfaces 1 --start 10,0.1,0.1"),
        "must be TAU,PSI or",
    );
    refused(
        &format!("{RUN} --start near-symmetrical"),
        "must be TAU,PSI1,PSI2 or",
    );
}

#[test]
fn conflicts_and_gaps_are_refused() {
    for pair in [
        "--points 5 --every 1",
        "--points 5 --final-only",
        "--every 1 --final-only",
        "--final-only --plot x.svg",
    ] {
        refused(&format!("{RUN} {pair}"), "cannot be used with");
    }
    refused(&format!("{RUN} --event-threshold 3"), "--events");
    refused(&format!("{RUN} --normal-stress 1e6"), "--si");
    refused(
        "integrate --stiffness 1 --until 1",
        "--driving V_H is missing",
    );
    refused(
        "integrate --driving 1 --until 1",
        "--stiffness K is missing",
    );
    refused(
        "integrate --driving 1 --stiffness 1",
        "--until T is missing",
    );
    refused("equilibria", "--driving V_H is missing");
    refused(
        &format!("{RUN} --columns time,stres"),
        "did you mean \"stress\"?",
    );
    refused(&format!("{RUN} --plot run.pdf"), "must end in .svg or .png");
    refused(
        &format!("{RUN} --method euler"),
        "method is euler, but must be one of auto, taylor, rodas5p",
    );
}

#[cfg(not(feature = "sundials"))]
#[test]
fn without_sundials_its_methods_are_refused() {
    refused(&format!("{RUN} --method cvode-bdf"), "needs SUNDIALS");
    refused("equilibria --driving 1 --solver kinsol", "needs SUNDIALS");
}

#[test]
fn every_method_of_this_build_runs() {
    let methods = ["auto", "rodas5p", "rodas4", "rosenbrock23"];
    let sundials: &[&str] = if cfg!(feature = "sundials") {
        &["cvode-bdf", "cvode-adams"]
    } else {
        &[]
    };
    for method in methods.iter().chain(sundials) {
        let made = object(&format!("{RUN} --rtol 1e-6 --method {method}"));
        assert_eq!(made["numerics"]["asked"], *method);
    }
}

#[test]
fn paths_are_tried_before_computing_and_nothing_is_left() {
    let place = folder("paths");
    let missing = place.join("no").join("run.csv");
    refused(&format!("{RUN} -o {}", missing.display()), "cannot write");
    refused(&format!("{RUN} --plot x.png/"), "cannot write x.png/");
    refused(
        &format!("{RUN} --plot {}/no/run.svg", place.display()),
        "cannot write",
    );
    refused(
        &format!("{RUN} -o {}", place.display()),
        "it is a directory",
    );
    // A good path and bad input: no file.
    let good = place.join("run.csv");
    refused(&format!("{RUN} --rtol -1 -o {}", good.display()), "rtol");
    refused(
        &format!(
            "{RUN} --start 10,2,0.1 -o {}",
            place.join("run.json").display()
        ),
        "psi",
    );
    assert_eq!(contents(&place), Vec::<String>::new());
    let same = place.join("same.svg");
    refused(
        &format!("{RUN} -o {0} --plot {0}", same.display()),
        "cannot be both",
    );
}

#[test]
fn files_get_the_format_of_their_extension() {
    let place = folder("formats");
    for (name, begins) in [
        ("a.json", "{"),
        ("a.csv", "# twinslip"),
        ("a.dat", "# twinslip"),
    ] {
        let path = place.join(name);
        let ended = twinslip(&format!("{RUN} -q -o {}", path.display()));
        assert_eq!(
            (ended.code, ended.out.as_str(), ended.err.as_str()),
            (0, "", "")
        );
        let text = std::fs::read_to_string(&path).expect("written");
        assert!(text.starts_with(begins), "{name}: {text}");
    }
    let dash = twinslip(&format!("{RUN} -q -o - --format json"));
    assert!(dash.out.starts_with('{'));
    assert_eq!(contents(&place).len(), 3, "no temporary file is left");
}

#[test]
fn endings_of_other_formats_are_refused() {
    let place = folder("endings");
    let path = |name: &str| place.join(name).display().to_string();
    for (name, hint) in [
        ("run.xlsx", "data is written as .csv or .json, not as .xlsx"),
        ("run.svg", "pictures are drawn by --plot"),
        ("run.parquet", "Parquet is written by sweep alone"),
    ] {
        refused(&format!("{RUN} -o {}", path(name)), hint);
    }
    assert_eq!(contents(&place), Vec::<String>::new());
    // What is said outright holds for any name.
    let named = twinslip(&format!("{RUN} -q --format csv -o {}", path("run.xlsx")));
    assert_eq!(named.code, 0, "{}", named.err);
    let large = twinslip(&format!("{RUN} -q -o {}", path("run.JSON")));
    assert_eq!(large.code, 0, "{}", large.err);
    let text = std::fs::read_to_string(place.join("run.JSON")).expect("written");
    assert!(text.starts_with('{'), "{text}");
}

/// One sentence for any name that a user types: which there are, and the one that may have been meant.
#[test]
fn wrong_names_are_answered_by_the_nearest() {
    let point = "--driving 0.1 --stiffness 0.2";
    for (arguments, sentence) in [
        (
            format!("{RUN} --law dietrich-ruina"),
            "law is dietrich-ruina, but must be one of spinodal, bounded, regularised-ageing, dieterich-ruina, slip; did you mean \"dieterich-ruina\"?",
        ),
        (
            format!("{RUN} --law regularised_ageing"),
            "did you mean \"regularised-ageing\"?",
        ),
        (format!("{RUN} --method tailor"), "did you mean \"taylor\"?"),
        (format!("{RUN} --format jsn"), "did you mean \"json\"?"),
        (
            format!("equilibria {point} --solver newtn"),
            "solver is newtn, but must be kinsol or newton; did you mean \"newton\"?",
        ),
        (
            format!("orbit {point} --symmetry asymetric"),
            "symmetry is asymetric, but must be symmetric or asymmetric; did you mean \"asymmetric\"?",
        ),
        (
            format!("orbit {point} --crosscheck cvode_bdff"),
            "must be one of auto",
        ),
        (
            "branch orbits --stiffness 0.14 --symmetry symetric".into(),
            "did you mean \"symmetric\"?",
        ),
        (
            "branch orbits --stiffness 0.14 --along stifness".into(),
            "did you mean \"stiffness\"?",
        ),
        ("branch orbts".into(), "did you mean \"orbits\"?"),
        ("locus tors".into(), "did you mean \"torus\"?"),
        (
            "locus period_doubling --stiffness 3".into(),
            "did you mean \"period-doubling\"?",
        ),
        (
            "sweep --driving 1:2:2 --stiffness 1:2:2 --curves torus,hpf --plot map.svg".into(),
            "did you mean \"hopf\"?",
        ),
        (
            format!("{RUN} --columns strss"),
            "columns is strss, but must be one of time, stress",
        ),
        ("run fig9".into(), "did you mean \"fig09\"?"),
    ] {
        refused(&arguments, sentence);
    }
    // What is like nothing gets no hint.
    let far = twinslip(&format!("{RUN} --law zzz"));
    assert!(!far.err.contains("did you mean"), "{}", far.err);
    for (arguments, sentence) in [
        ("branch", "say what to follow: twinslip branch equilibria"),
        ("locus", "say which bifurcation to follow"),
    ] {
        refused(arguments, sentence);
    }
}

/// A:B or A,B, and A:B:N or A,B,N: the same rows.
#[test]
fn ranges_have_one_syntax_and_the_old_one_stays() {
    let rows = |arguments: &str| {
        let ended = twinslip(&format!("{arguments} --format csv -q"));
        assert_eq!(ended.code, 0, "{arguments}: {}", ended.err);
        csv(&ended.out)
    };
    for (new, old) in [
        (
            "locus hopf --driving-range 0.01:1000 --stiffness-range 0.1:0.2",
            "locus hopf --driving-range 0.01,1000 --stiffness-range 0.1,0.2",
        ),
        (
            "sweep --driving 100:200:2 --stiffness 0.5:2:3log",
            "sweep --driving 100,200,2 --stiffness 0.5,2,3log",
        ),
    ] {
        let rows = [rows(new), rows(old)];
        assert!(rows[0].len() > 2, "{new}");
        assert_eq!(rows[0], rows[1], "{new}");
    }
    refused(
        "sweep --driving 1:2,3 --stiffness 1",
        "--driving \"1:2,3\" must be A:B:N",
    );
}

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
fn counts_may_be_written_short_and_are_whole() {
    let short = twinslip(&format!(
        "{RUN} --max-steps 1e6 --points 2.0e1 --format csv -q"
    ));
    assert_eq!(short.code, 0, "{}", short.err);
    assert_eq!(csv(&short.out).len(), 21);
    for wrong in ["2.5", "-3", "x", "1e300", "nan"] {
        refused(&format!("{RUN} --points={wrong}"), "must be a whole number");
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
    let held = Command::new(env!("CARGO_BIN_EXE_twinslip"))
        .arg("--version")
        .env("TWINSLIP_VECTORS", "none")
        .output()
        .expect("the program starts");
    let held = String::from_utf8_lossy(&held.stdout).into_owned();
    assert!(held.contains("\nvector instructions none ("), "{held}");
}

const COMMANDS: [&str; 14] = [
    "law",
    "integrate",
    "equilibria",
    "orbit",
    "section",
    "branch",
    "locus",
    "sweep",
    "run",
    "merge",
    "reproduce",
    "figure",
    "completions",
    "man",
];

#[test]
fn shells_complete_commands_options_and_names() {
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let ended = run(&["completions", shell]);
        assert_eq!((ended.code, ended.err.as_str()), (0, ""), "{shell}");
        for word in COMMANDS {
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
}

#[test]
fn every_command_has_a_manual_page() {
    let place = folder("man").join("new");
    let ended = run(&["man", "--out", place.to_str().expect("UTF-8")]);
    assert_eq!((ended.code, ended.err.as_str()), (0, ""));
    let read = |name: String| std::fs::read_to_string(place.join(name)).expect("a page");
    assert!(read("twinslip.1".into()).contains("Exit status"));
    for command in COMMANDS {
        let page = read(format!("twinslip-{command}.1"));
        assert!(page.starts_with(".ie") || page.contains(".TH"), "{command}");
    }
    assert!(read("twinslip-integrate.1".into()).contains("Relative local error tolerance"));
    let file = folder("man-file").join("file");
    std::fs::write(&file, "").expect("written");
    refused(&format!("man --out {}", file.display()), "cannot write");
}

#[test]
fn talk_goes_to_standard_error() {
    let ended = twinslip(RUN);
    assert_eq!(ended.err.lines().count(), 1, "{}", ended.err);
    assert!(ended.err.contains("steps"), "{}", ended.err);
    assert!(csv(&ended.out)[0][0] == "time");
    assert_eq!(twinslip(&format!("{RUN} -q")).err, "");
}

#[test]
fn a_reader_who_leaves_is_no_error() {
    let mut child = Command::new(env!("CARGO_BIN_EXE_twinslip"))
        .args("integrate --driving 10 --stiffness 0.14 --until 2000".split(' '))
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program starts");
    let mut first = String::new();
    BufReader::new(child.stdout.take().expect("a pipe"))
        .read_line(&mut first)
        .expect("a line");
    let ended = child.wait_with_output().expect("it ends");
    assert_eq!(ended.status.code(), Some(0));
    assert!(first.starts_with("# twinslip"));
    assert_eq!(String::from_utf8_lossy(&ended.stderr), "");
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
            let status = Command::new(env!("CARGO_BIN_EXE_twinslip"))
                .args(
                    line.replace(
                        "scenes/",
                        &format!("{}/scenes/", env!("CARGO_MANIFEST_DIR")),
                    )
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

/// A time to wait that is beyond doubles is the longest one; that the run doesn't end is no wrong input.
#[test]
fn patience_is_finite() {
    let ended = twinslip(
        "section --driving 1.7 --stiffness 2.2250738585072014e-308 --returns 2 --max-steps 1934 --start near-symmetric:0.0085 --format csv -q",
    );
    assert!(
        ended.code != 2 && !ended.err.contains("inf"),
        "{}",
        ended.err
    );
}

/// Nothing is heard of this branch for long; whoever looks at a terminal sees that it is at work.
#[test]
fn a_run_that_is_silent_for_long_shows_that_it_goes_on() {
    let branch = "branch orbits --stiffness 0.1379 --direct-effect 0.00593264152131 --symmetry asymmetric --from 1.49311502447 --to 1.675";
    let command = format!("timeout 4 {} {branch}", env!("CARGO_BIN_EXE_twinslip"));
    let seen = Command::new("script")
        .args(["-qec", &command, "/dev/null"])
        .env("TERM", "xterm")
        .stdin(Stdio::null())
        .output()
        .expect("a terminal by script(1)");
    let seen = String::from_utf8_lossy(&seen.stdout);
    assert!(seen.contains("looking for the first point"), "{seen}");
}

/// No orbit is looked for without end: the message names the bound.
#[test]
fn a_search_for_an_orbit_ends() {
    let ended = twinslip("orbit --driving 10 --stiffness 1e-6 --crosscheck none");
    assert_eq!(ended.code, 1, "{}", ended.err);
    assert!(
        ended.err.contains("steps, as many as a search may take"),
        "{}",
        ended.err
    );
    // One step in an arc leads nowhere, at once.
    let ended = twinslip("orbit --driving 1.831e-38 --stiffness 0.56 --max-steps 1");
    assert_eq!(ended.code, 1, "{}", ended.err);
    // Where the time to search in is beyond doubles, the message names none.
    let ended = twinslip(
        "orbit --driving 5e-324 --stiffness 0.022 --law bounded --method rodas5p --max-steps 99",
    );
    assert_eq!(ended.code, 1, "{}", ended.err);
    let said = ended.err.contains("99 steps were used up at t = ");
    assert!(said && !ended.err.contains("inf"), "{}", ended.err);
}
