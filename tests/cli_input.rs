//! What a user types: which parameters, names, ranges and counts are taken, and how others are refused.

use crate::command;
use command::{RUN, csv, refused, run, twinslip};

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
        &model("--interfaces 0"),
        "interfaces is 0, but must be at least 1",
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
    for surface in ["10", "stress=", "stress=high", "stress=nan"] {
        refused(
            &section(&format!("--surface {surface}")),
            &format!("--surface \"{surface}\" must be stress=auto or STATE=VALUE"),
        );
    }
    refused(
        &section("--surface state=1"),
        "the state of --surface is state, but must be",
    );
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

/// One sentence for any name that a user types: which there are, and the one that may have been meant.
#[test]
fn wrong_names_are_answered_by_the_nearest() {
    let point = "--driving 0.1 --stiffness 0.2";
    for (arguments, sentence) in [
        (
            format!("{RUN} --law dietrich-ruina"),
            "law is dietrich-ruina, but must be one of spinodal, bounded, regularised-ageing, dieterich-ruina, slip, composite, cutoff, flash-heating, nagata, perrin-rice-zheng; did you mean \"dieterich-ruina\"?",
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
