//! What the commands take and write of parameters: `--set`, radiation damping in SI, and units of time.

use crate::command;
use command::{csv, number, object, refused, refused_in_one_line, twinslip};

#[test]
fn a_parameter_that_is_set_is_as_one_that_has_a_flag() {
    let by_flags = "equilibria --driving 10 --stiffness 0.14 --residual-strength 0.002 --healing-time 90 --damping 1e-3";
    let by_names = "equilibria --set driving=10,stiffness=0.14 --set residual_strength=0.002 --set healing_time=90 --set damping=1e-3";
    let [flags, names] = [by_flags, by_names].map(object);
    assert_eq!(flags["result"], names["result"]);
    assert_eq!(flags["model"], names["model"]);
    assert_eq!(number(&names, "/model/damping"), 1e-3);
    for direct_effect in ["0.03", "0.04"] {
        let by_flag = object(&format!("law --points 5 --direct-effect {direct_effect}"));
        let by_name = object(&format!(
            "law --points 5 --set direct_effect={direct_effect}"
        ));
        assert_eq!(by_flag["result"], by_name["result"]);
    }
    let swept = |words: &str| {
        let ended = twinslip(&format!(
            "sweep --driving 1:10:2 --stiffness 0.1:0.2:2 {words} --format csv -q"
        ));
        assert_eq!(ended.code, 0, "{}", ended.err);
        csv(&ended.out)
    };
    assert_eq!(swept("--set damping=0.01"), swept("--damping 0.01"));
}

#[test]
fn what_cannot_be_set_is_refused_in_one_sentence() {
    let model = "equilibria --driving 10 --stiffness 0.14";
    for (set, sentence) in [
        ("damping=1 --set damping=2", "--set gives damping twice"),
        (
            "driving=10",
            "--set driving and --driving say the same thing",
        ),
        (
            "residual_strength=0.002 --residual-strength 0.003",
            "--set residual_strength and --residual-strength say the same thing",
        ),
        (
            "damping=1 --law scenes/laws/spinodal.toml --damping 2",
            "--set damping and --damping say the same thing",
        ),
        ("residual_strenght=1", "did you mean \"residual_strength\""),
        ("damping", "must be NAME=VALUE"),
        ("damping=much", "\"much\" is not a finite number"),
        ("damping=inf", "is not a finite number"),
        ("damping=-1", "damping is -1, but must be zero or positive"),
        ("healing_time=0", "healing-time is 0, but must be positive"),
        ("slip_length=2", "without --si it is the unit"),
    ] {
        refused_in_one_line(&format!("{model} --set {set}"), sentence);
    }
    refused_in_one_line(
        "locus hopf --set stiffness=1",
        "is a free parameter of a curve",
    );
    refused_in_one_line(
        "sweep --driving 1:2:2 --stiffness 1:2:2 --set driving=1",
        "the grid of this command sets it",
    );
    refused_in_one_line(
        &format!("{model} --damping -1"),
        "damping is -1, but must be zero or positive",
    );
    refused(&format!("{model} --si --damping nan"), "damping");
}

/// Granite.
const GRANITE: &str = "--law regularised-ageing --interfaces 1 --si --direct-effect 0.010 --evolution-effect 0.015 --slip-length 10e-6 \
    --normal-stress 50e6 --shear-modulus 30e9 --shear-wave-speed 3000";

#[test]
fn damping_in_si_is_that_of_the_rock() {
    // eta = G/(2 c_s) = 5 MPa s/m, and k_c = [(b - a) sigma - eta V]/D_c up to the regularisation
    let made = object(&format!("law {GRANITE} --from 1e-9 --to 0.01 --points 2"));
    assert_eq!(number(&made, "/model/damping"), 5e6);
    let k_c = |row: usize| number(&made, &format!("/result/rows/{row}/critical_stiffness"));
    for (row, rate) in [(0, 1e-9), (1, 0.01)] {
        let truth = (0.005 * 50e6 - 5e6 * rate) / 10e-6;
        assert!(
            (k_c(row) / truth - 1.0).abs() < 1e-9,
            "{} for {truth}",
            k_c(row)
        );
    }
    let same = GRANITE.replace(
        "--shear-modulus 30e9 --shear-wave-speed 3000",
        "--damping 5e6",
    );
    let again = object(&format!("law {same} --from 1e-9 --to 0.01 --points 2"));
    assert_eq!(made["result"], again["result"]);
    // eta V*/(a sigma) without units
    let plain = object(
        "law --law regularised-ageing --direct-effect 0.010 --evolution-effect 0.015 --damping 1e-5 --from 1e-3 --to 1e4 --points 2",
    );
    let stiffness = |row: usize| number(&plain, &format!("/result/rows/{row}/critical_stiffness"));
    assert!((k_c(1) / stiffness(1) / (0.01 * 50e6 / 10e-6) - 1.0).abs() < 1e-12);
    refused("law --shear-modulus 30e9", "--shear-wave-speed");
}

#[test]
fn times_have_the_unit_that_is_asked_for() {
    let run = format!("integrate {GRANITE} --driving 1e-9 --stiffness 1e9 --final-only --events");
    let year = 31_557_600.0;
    let seconds = object(&format!("{run} --until {}", 2.0 * year));
    let years = object(&format!("{run} --until 2 --time-unit year"));
    assert_eq!(years["units"]["time"], "year");
    let of = |made: &serde_json::Value, pointer: &str| number(made, pointer);
    for pointer in [
        "/result/events/1/recurrence",
        "/result/events/0/onset",
        "/result/final/state_1",
        "/result/final/time",
    ] {
        let ratio = of(&seconds, pointer) / of(&years, pointer) / year;
        assert!((ratio - 1.0).abs() < 1e-6, "{pointer}: {ratio}");
    }
    let (fast, again) = (
        of(&seconds, "/result/events/0/peak_slip_rate"),
        of(&years, "/result/events/0/peak_slip_rate"),
    );
    assert!((fast / again - 1.0).abs() < 1e-6);
    refused_in_one_line(
        &format!("{run} --until 2 --time-unit yaer"),
        "did you mean \"year\"",
    );
    let said = twinslip("integrate --driving 1 --stiffness 1 --until 2 --time-unit year");
    assert_eq!(said.code, 2, "{}", said.err);
}
