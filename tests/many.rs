//! Many interfaces under one stress, in linear time: against references, the other engines, and themselves on other vectors and cores.

use crate::command::{csv, number, object, refused_in_one_line};
use serde_json::Value;
use twinslip::friction::{AnyLaw, Parameters};
use twinslip::many::{ManyInterfaces, ManyTaylor, OneOfMany};
use twinslip::model::Loading;

fn spinodal() -> AnyLaw {
    AnyLaw::Spinodal(Parameters::heslot_1994().spinodal())
}

fn decimal(value: &Value) -> f64 {
    let text = value
        .as_str()
        .map_or_else(|| value.to_string(), str::to_owned);
    text.parse().expect("a number")
}

#[track_caller]
fn close(made: f64, known: f64, tolerance: f64) {
    let off = (made / known - 1.0).abs();
    assert!(off <= tolerance, "{made} for {known}: {off:e}");
}

#[test]
fn a_thousand_meet_their_reference() {
    let text = include_str!("data/clusters.json");
    let all: Value = serde_json::from_str(text).expect("JSON");
    let known = &all["trajectories"]["N1000_K0.14_VH10"];
    let loading = Loading::new(10.0, 0.14).expect("positive");
    let interfaces = ManyInterfaces::alike(spinodal(), 1000, loading).expect("a law that ages");
    let states = (1..=1000).map(|i| 0.002 * (1.0 + 0.01 * f64::from(i)));
    let states: Vec<f64> = states.collect();
    let taylor = ManyTaylor::new(1e-15, 10_000).expect("a tolerance");
    for end in known["ends"].as_array().expect("ends") {
        let until = decimal(&end["t"]);
        let made = taylor.flow(&interfaces, (9.9, &states), until, &mut |_| Ok(true));
        let made = made.expect("a flow");
        close(made.stress(), decimal(&end["tau"]), 1e-12);
        for (i, psi) in end["psi"].as_object().expect("psi") {
            let i: usize = i.parse().expect("a number");
            close(made.state(i - 1), decimal(psi), 1e-12);
        }
        let mean = (0..1000).map(|i| made.state(i)).sum::<f64>() / 1000.0;
        close(mean, decimal(&end["mean_psi"]), 1e-12);
    }
}

/// Three by the engine of few, ten and a hundred by that of many.
#[test]
fn all_are_those_in_clusters() {
    for (few, all) in [(1, 3), (3, 10), (30, 100)] {
        let rest = all - few;
        let loading = format!(
            "--driving {} --stiffness {} --until 4 --final-only --rtol 1e-15 --method taylor",
            all,
            1.4 / f64::from(all)
        );
        let clusters = object(&format!(
            "integrate --clusters {few},{rest} --start 9.9,0.0021,0.0018 {loading}"
        ));
        let start = [vec!["0.0021"; few as usize], vec!["0.0018"; rest as usize]].concat();
        let mut columns = format!(
            "stress,state_1,state_{all},slip_rate_{few},slip_rate_{all},slip_{few},slip_{all}"
        );
        if all > 7 {
            columns += ",slip";
        }
        let full = object(&format!(
            "integrate --interfaces {all} --start 9.9,{} {loading} --columns {columns}",
            start.join(",")
        ));
        let (known, made) = (&clusters["result"]["final"], &full["result"]["final"]);
        let of = |base: &str, number: i32| format!("{base}_{number}");
        for (mine, its) in [
            ("stress".to_owned(), "stress"),
            (of("state", 1), "state_1"),
            (of("state", all), "state_2"),
            (of("slip_rate", few), "slip_rate_1"),
            (of("slip_rate", all), "slip_rate_2"),
            (of("slip", few), "slip_1"),
            (of("slip", all), "slip_2"),
        ] {
            let [made, known] =
                [(made, &*mine), (known, its)].map(|(of, name)| number(of, &format!("/{name}")));
            close(made, known, 1e-11);
        }
        if all > 7 {
            let [one, other] = [few, all].map(|i| number(made, &format!("/slip_{i}")));
            let together = f64::from(few) * one + f64::from(rest) * other;
            close(number(made, "/slip"), together, 1e-12);
        }
    }
}

#[test]
fn two_that_differ_are_those_of_the_other_engine() {
    let known = object(
        "integrate --driving 10 --stiffness 0.14 --set residual_strength_2=0.002,slip_length_2=1.5,healing_time_2=80,evolution_effect_2=0.047 \
         --start 9.9,0.003,0.002 --until 3 --final-only --rtol 1e-15 --method taylor",
    );
    let law = |healing_time: f64, residual_strength: f64, b: f64, length: f64| {
        let parameters = Parameters::new(0.0349, b, 0.369, healing_time, residual_strength);
        let parameters = parameters.expect("parameters");
        AnyLaw::of_slip_length("spinodal", parameters, length).expect("a law")
    };
    let laws = [
        OneOfMany::from(law(100.0, 1e-3, 0.0489, 1.0)),
        OneOfMany {
            slip_length: 1.5,
            ..law(80.0, 2e-3, 0.047, 1.5).into()
        },
    ];
    let loading = Loading::new(10.0, 0.14).expect("positive");
    let interfaces = ManyInterfaces::new(&laws, loading).expect("laws that age");
    let taylor = ManyTaylor::new(1e-15, 10_000).expect("a tolerance");
    let made = taylor.flow(&interfaces, (9.9, &[0.003, 0.002]), 3.0, &mut |_| Ok(true));
    let made = made.expect("a flow");
    let known = &known["result"]["final"];
    close(made.stress(), number(known, "/stress"), 1e-12);
    close(made.state(0), number(known, "/state_1"), 1e-12);
    close(made.state(1), number(known, "/state_2"), 1e-12);
}

/// The laws whose state ages, also with an exponential direct effect.
#[test]
fn every_ageing_law_runs_as_alone() {
    for (law, driving, stiffness) in [
        ("bounded", 1.0, 0.5),
        ("regularised-ageing", 1.0, 2.0),
        ("dieterich-ruina", 1.0, 2.0),
    ] {
        let run = |interfaces: u32, start: &str| {
            object(&format!(
                "integrate --law {law} --interfaces {interfaces} --driving {} --stiffness {} --start {start} --until 3 --final-only --rtol 1e-14 --method taylor",
                driving * f64::from(interfaces),
                stiffness / f64::from(interfaces)
            ))
        };
        let psi = if law == "bounded" { 0.011 } else { 1.2 };
        let alone = run(1, &format!("10.4,{psi}"));
        let each = vec![psi.to_string(); 16].join(",");
        let many = run(16, &format!("10.4,{each}"));
        let [made, known] = [&many, &alone].map(|one| number(one, "/result/final/stress"));
        close(made, known, 1e-12);
        let [made, known] = [(&many, "state_max"), (&alone, "state_1")]
            .map(|(one, name)| number(one, &format!("/result/final/{name}")));
        close(made, known, 1e-12);
    }
}

/// Rates of 1e18 V* and times of 1e16 L/V*: the unit of time follows.
#[test]
fn no_scale_of_time_is_assumed() {
    // While the state of the second heals, dpsi/dt = (1 - psi)/R, the stress rises by K V_H t: by quadrature in 30 digits. What slip takes
    // of the state, 3e-9 of what heals, is left out.
    let healing = (5.334_314_909_497_934e-9, 1e-8);
    for (law, constants, (driving, stiffness), start, until, slip) in [
        (
            "regularised-ageing",
            "",
            (1.0, 2.0),
            ("25", "1e-9"),
            3.0,
            None,
        ),
        (
            "spinodal",
            "--healing-time 1e16",
            (1e-14, 1e-3),
            ("4", "0.01"),
            1e15,
            Some(healing),
        ),
    ] {
        let run = |interfaces: u32, psi: &str| {
            let n = f64::from(interfaces);
            object(&format!(
                "integrate --law {law} {constants} --interfaces {interfaces} --driving {:e} --stiffness {:e} --start {},{psi} --until {until:e} \
                 --final-only --rtol 1e-13 --method taylor",
                driving * n,
                stiffness / n,
                start.0
            ))
        };
        let alone = run(1, start.1);
        let many = run(8, &[start.1; 8].join(","));
        let known = |name: &str| number(&alone, &format!("/result/final/{name}"));
        let made = |name: &str| number(&many, &format!("/result/final/{name}"));
        close(made("stress"), known("stress"), 1e-10);
        close(made("state_max"), known("state_1"), 1e-10);
        let (slip, tolerance) = slip.unwrap_or_else(|| (known("slip_1"), 1e-10));
        close(made("slip") / 8.0, slip, tolerance);
    }
}

/// Sums are taken in an order of their own: vectors and cores change no digit.
#[test]
fn digits_do_not_depend_on_vectors_and_cores() {
    let run = |cores: &str, vectors: &str| {
        let ended = crate::command::program()
            .args("integrate --interfaces 10001 --driving 100 --stiffness 0.01 --start spread:0.5 --until 0.2 --points 5 --draw residual_strength=8e-4:1.2e-3 -q --format csv".split(' '))
            .env("RAYON_NUM_THREADS", cores)
            .env("TWINSLIP_VECTORS", vectors)
            .output()
            .expect("the program starts");
        assert!(ended.status.success());
        let text = String::from_utf8(ended.stdout).expect("UTF-8");
        assert_eq!(csv(&text).len(), 6, "{text}");
        text
    };
    let known = run("1", "none");
    for (cores, vectors) in [("2", "none"), ("1", "avx2"), ("2", "avx512")] {
        assert_eq!(run(cores, vectors), known, "{cores} cores, {vectors}");
    }
}

#[test]
fn constants_are_drawn_by_a_seed() {
    let run = |draw: &str| {
        let made = object(&format!(
            "integrate --interfaces 20 --driving 200 --stiffness 0.014 --until 1 --final-only --rtol 1e-12 {draw}"
        ));
        number(&made, "/result/final/stress")
    };
    let plain = run("--residual-strength 0.002");
    // Where there is nothing to choose from all are as without.
    assert_eq!(run("--draw residual_strength=0.002:0.002"), plain);
    let drawn = run("--draw residual_strength=0.001:0.003log,slip_length=0.9:1.1");
    assert_ne!(drawn, plain);
    assert_eq!(
        run("--draw residual_strength=0.001:0.003log,slip_length=0.9:1.1 --seed 1"),
        drawn
    );
    assert_ne!(
        run("--draw residual_strength=0.001:0.003log,slip_length=0.9:1.1 --seed 2"),
        drawn
    );
}

#[test]
fn what_many_can_not_be_is_said() {
    let run = "integrate --driving 10 --stiffness 0.1 --until 1 --interfaces 9";
    for (what, sentence) in [
        ("--damping -1", "damping"),
        (
            "--law scenes/laws/spinodal.toml",
            "from a file can have at most 7",
        ),
        ("--si", "computed without units"),
        ("--program 0.5:1", "V_H is constant"),
        ("--events e.csv --method rodas5p", "found on power series"),
        #[cfg(feature = "sundials")]
        ("--method cvode-adams", "a Rosenbrock method or cvode-bdf"),
        #[cfg(not(feature = "sundials"))]
        ("--method cvode-bdf", "cvode-bdf"),
        ("--estimate-error", "have no estimate"),
        ("--set residual_strength_2=1", "by --draw"),
        ("--columns state_10", "state_1"),
        ("--start 9,1", "must be TAU,PSI1,...,PSI9"),
        ("--start -1,1,1,1,1,1,1,1,1,1", "tau in --start is -1"),
        ("--draw residual_strength=2:1", "0 < A <= B"),
        ("--draw stiffness=1:2", "is none of healing_time"),
        ("--max-steps 0", "max-steps"),
    ] {
        refused_in_one_line(&format!("{run} {what}"), sentence);
    }
}
