//! The ends of steps: what a series does not see from its beginning, zeros of kinks within a step, values that sink below the absolute
//! tolerance and grow again.
//!
//! Values of systems in `tests/data/cases` were computed independently of this code, to the digits that are written; that of the tank
//! is a closed form.

use crate::command;
use crate::common::text::{ends_at, file, near};
use command::{number, object, refused, twinslip};
use proptest::prelude::*;
use twinslip::field::{State, VectorField};
use twinslip::friction::{AnyLaw, Parameters};
use twinslip::integrate::{Choice, Integrator, MAX_STEPS, RosenbrockMethod, Taylor, Tolerances};
use twinslip::model::{Loading, Smooth, two_interfaces};
use twinslip::number::Real;
use twinslip::series::Equations;

#[test]
fn a_switch_beyond_the_sight_of_a_series_is_met() {
    for (k, truth) in [
        (10, 0.972339625143258),
        (20, 0.972879498358905),
        (40, 0.973006498369836),
        (1000, 0.973048145502),
    ] {
        for method in ["auto", "taylor", "rodas5p"] {
            let run = format!("tanh-switch.toml --set k={k} --until 5 --method {method}");
            ends_at(&run, &[("x", truth)], 1e-5);
        }
        let run = format!("tanh-switch.toml --set k={k} --until 5 --rtol 1e-12 --atol 1e-12");
        ends_at(&run, &[("x", truth)], 1e-11);
    }
}

#[test]
fn steps_that_leave_the_solution_are_counted() {
    let made = ends_at(
        "diode.toml --until 0.002",
        &[("x", 0.574147339189913)],
        1e-9,
    );
    assert!(number(&made, "/work/rejected") > 0.0);
    ends_at("diode.toml --until 1", &[("x", 0.574147339189913)], 1e-9);
}

/// h' = -sqrt(h) from 1 is (1 - t/2)^2 and ends at t = 2, where a series goes on with the other sign of the root.
#[test]
fn a_root_ends_the_run_at_its_branch_point() {
    for options in [
        "",
        "--method taylor",
        "--rtol 1e-12 --atol 1e-12",
        "--rtol 1e-4 --atol 1e-4",
        "--method rodas5p",
    ] {
        let ended = twinslip(&format!(
            "integrate --system tests/data/cases/torricelli.toml --until 3 {options}"
        ));
        assert_eq!(ended.code, 1, "{options}: {}", ended.err);
        let at = ended.err.split("at t = ").nth(1).expect("a time");
        let at: f64 = at
            .split([',', ' '])
            .next()
            .and_then(|t| t.parse().ok())
            .expect("a number");
        assert!((at - 2.0).abs() < 1e-3, "{options}: {}", ended.err);
        assert!(!ended.err.contains("(0 rejected)"), "{}", ended.err);
        assert!(
            ended.err.contains("not smooth or not defined"),
            "{}",
            ended.err
        );
    }
    ends_at("torricelli.toml --until 1.5", &[("h", 0.0625)], 1e-9);
}

#[test]
fn kinks_that_a_step_passes_twice_are_met() {
    for method in ["auto", "taylor"] {
        let sprott = [("x", 0.24148201), ("y", -0.85685317), ("z", -0.88978798)];
        ends_at(
            &format!("sprott-abs.toml --until 60 --method {method}"),
            &sprott,
            1e-7,
        );
        let chua = [("x", 1.08871811), ("y", -0.19004961), ("z", -1.10380692)];
        ends_at(
            &format!("chua-pw.toml --until 20 --method {method}"),
            &chua,
            1e-6,
        );
        ends_at(
            &format!("soft-stop.toml --until 20 --method {method}"),
            &[("x", 1.21410274)],
            1e-6,
        );
    }
    ends_at(
        "soft-stop.toml --until 20 --reference",
        &[("x", 1.21410274)],
        1e-6,
    );
    ends_at("pulse-parabola.toml --until 2", &[("u", 0.3315455)], 1e-7);
}

/// The sign of a product changes where that of a factor does, that of sinh where its argument does; the root of a square has a corner.
#[test]
fn corners_of_products_roots_and_odd_functions_are_met() {
    let path = file(
        "corners",
        r#"
        name = "corners"
        states = ["s", "product", "odd", "root", "quotient"]
        [rates]
        s = "1"
        product = "abs(3*(s - 1)*(s - 1.2))"
        odd = "abs(sinh(s - 1)*exp(-s)*exp(s))"
        root = "sqrt((s - 1)^2)"
        quotient = "abs((1 - s)/(1 + s))"
        [start]
        s = 0.0
        product = 0.0
        odd = 0.0
        root = 0.0
        quotient = 0.0
        "#,
    );
    let made = object(&format!(
        "integrate --system {path} --until 2 --final-only --rtol 1e-12 --atol 1e-12"
    ));
    let at = |name: &str| number(&made, &format!("/result/final/{name}"));
    near(
        at("product"),
        3.0 * (13.0 / 15.0 + 2.0 / 3.0 - 0.864),
        1e-11,
    );
    near(at("odd"), 2.0 * (1.0_f64.cosh() - 1.0), 1e-11);
    near(at("root"), 1.0, 1e-11);
    near(at("quotient"), 2.0 * (4.0_f64 / 3.0).ln(), 1e-11);
}

#[test]
fn the_orbit_of_a_piecewise_linear_net_is_found() {
    // Its second method does not cross the corners well enough to say more.
    let ended = twinslip("orbit --system tests/data/cases/relu-net.toml --format json -q");
    assert_eq!(ended.code, 3, "{}", ended.err);
    let made: serde_json::Value = serde_json::from_str(&ended.out).expect("JSON");
    let period = number(&made, "/result/orbit/period/value");
    assert!((period - 3.62759873).abs() < 1e-8, "{period}");
}

/// A slow passage through a Hopf point: the oscillation sinks to e^-90 and comes back. What a run loses below its absolute tolerance,
/// its estimate must say.
#[test]
fn an_estimate_holds_where_values_sink_below_the_tolerance() {
    for method in [
        "auto",
        "taylor",
        "rodas5p",
        "rodas4",
        "cvode-bdf",
        "cvode-adams",
    ] {
        if !cfg!(feature = "sundials") && method.starts_with("cvode") {
            continue;
        }
        let run =
            format!("delayed-hopf.toml --until 200 --rtol 1e-10 --atol 1e-12 --method {method}");
        ends_at(&run, &[("x", 0.0482363670825)], 1.0);
    }
    // Next to no absolute tolerance still leaves one for the second run.
    let run = "delayed-hopf.toml --until 1 --atol 1e-300 --method taylor";
    ends_at(run, &[], 1.0);
    // Followed all the way it is had.
    let run = "delayed-hopf.toml --until 200 --rtol 1e-12 --atol 1e-40 --method taylor";
    ends_at(run, &[("x", 0.0482363670825)], 1e-8);
}

/// The formulas that are written by hand for the laws have no such check: what is hidden there are exponentials of a stress that a step
/// changes by little.
#[test]
fn laws_are_loaded_from_far_below() {
    for name in AnyLaw::NAMES {
        for stress in [-300.0, -100.0, -40.0] {
            let law = AnyLaw::named(name, Parameters::heslot_1994()).expect("a law");
            let field = two_interfaces(law, Loading::new(1000.0, 10.0).expect("positive"));
            let start = State::<3>::new(stress, 0.5_f64.ln(), 0.45_f64.ln());
            let tolerances = Tolerances::equal(1e-12).expect("positive");
            let mut taylor = Taylor::new(tolerances, MAX_STEPS).expect("a method");
            let implicit = Choice::Rosenbrock(RosenbrockMethod::Rodas5P);
            let mut rodas = implicit
                .integrator::<3>(tolerances, MAX_STEPS)
                .expect("a method");
            let end = |by: &mut dyn Integrator<3>| {
                by.flow(&*field, (0.0, 0.2), &start, None)
                    .unwrap_or_else(|e| panic!("{name} {stress}: {e}"))
            };
            let off = (end(&mut taylor) - end(&mut *rodas)).amax();
            assert!(off < 1e-8, "{name} from {stress}: {off:e}");
        }
    }
}

/// An oscillator with a soft stop, x'' = -x - K max(x - c, 0).
#[derive(Debug, Clone, Copy)]
struct SoftStop;

impl Equations<2, 2> for SoftStop {
    const PARAMETERS: [&'static str; 2] = ["stiffness", "gap"];

    fn rates<T: Real>(&self, [x, v]: [T; 2], [stiffness, gap]: [T; 2]) -> [T; 2] {
        let into = x - gap;
        let force = stiffness * (into + into.abs()) / 2.0;
        [v, -x - force]
    }
}

/// Its solution from rest at -A by a sine in each region, from one passage of the stop to the next.
fn soft_stop([stiffness, gap]: [f64; 2], amplitude: f64, until: f64) -> [f64; 2] {
    let (mut t, mut x, mut v) = (0.0, -amplitude, 0.0_f64);
    let mut inside = false;
    loop {
        // x = centre + r cos(w s - phase)
        let squared = if inside { 1.0 + stiffness } else { 1.0 };
        let centre = if inside {
            stiffness * gap / squared
        } else {
            0.0
        };
        let w = squared.sqrt();
        let r = (x - centre).hypot(v / w);
        let phase = (v / w).atan2(x - centre);
        let after = |s: f64| {
            let angle = w * s - phase;
            [centre + r * angle.cos(), -r * w * angle.sin()]
        };
        let level = (gap - centre) / r;
        let next = if level.abs() < 1.0 {
            // Outside it is met going up, inside going down.
            let angle = if inside { level.acos() } else { -level.acos() };
            let turn = std::f64::consts::TAU;
            (angle + phase).rem_euclid(turn) / w
        } else {
            f64::INFINITY
        };
        if t + next >= until {
            return after(until - t);
        }
        t += next;
        [x, v] = [gap, after(next)[1]];
        inside = !inside;
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1000))]

    #[test]
    fn soft_stops_are_those_of_the_closed_form(
        stiffness in 0.1..30.0_f64,
        gap in 0.05..0.999_f64,
        until in 1.0..40.0_f64,
        digits in 6..14_i32,
    ) {
        let tolerances = Tolerances::equal(10_f64.powi(-digits)).expect("positive");
        let field = Smooth { equations: SoftStop, parameters: [stiffness, gap] };
        let start = State::<2>::new(-1.0, 0.0);
        let exact = soft_stop([stiffness, gap], 1.0, until);
        let mut taylor = Taylor::new(tolerances, MAX_STEPS).expect("a method");
        let end = taylor.flow(&field as &dyn VectorField<2>, (0.0, until), &start, None).expect("a run");
        let off = (end - State::from(exact)).amax();
        // Each passage of the stop, of which there are two a turn, may shift the phase by what a step may err.
        let allowed = 1e3 * tolerances.rtol * (1.0 + until) + 1e-12 * (1.0 + until);
        prop_assert!(off < allowed, "{off:e} of {allowed:e} for {stiffness} {gap} {until} {digits}");
    }
}

/// A pulse shorter than a step that begins and ends smoothly is below rounding at both ends of it: no method can see it.
#[test]
fn pulses_that_no_method_sees_are_met_with_a_largest_step() {
    // The integral over a turn of exp(-(pi - phi)) exp(-2 (1 - cos phi)/w^2)/w, over 1 - exp(-2 pi), by mpmath.
    const AFTER: f64 = 0.076_738_003_602_258;
    let path = "tests/data/cases/pulse-on-circle.toml";
    let at = |options: &str| {
        let run = format!("section --system {path} --surface y=0 --skip 5 --returns 5 {options}");
        let made = object(&run);
        let rows = made["result"]["rows"].as_array().expect("rows");
        rows.last().expect("a row")["z"].as_f64().expect("a number")
    };
    assert!(at("").abs() < 1e-30);
    for (method, within) in [
        ("auto", 1e-10),
        ("taylor", 1e-10),
        ("rodas5p", 1e-9),
        ("cvode-bdf", 1e-8),
    ] {
        if method == "cvode-bdf" && !cfg!(feature = "sundials") {
            continue;
        }
        let rtol = if method == "cvode-bdf" { 1e-9 } else { 1e-8 };
        let z = at(&format!(
            "--method {method} --max-step 5e-4 --rtol {rtol:e}"
        ));
        near(z, AFTER, within);
    }
    let orbit = object(&format!("orbit --system {path} --max-step 5e-4"));
    assert_eq!(number(&orbit, "/numerics/max_step"), 5e-4);
    let largest = &orbit["result"]["orbit"]["extremes"]["z"]["max"];
    let [value, off] =
        ["value", "uncertainty"].map(|part| largest[part].as_f64().expect("a number"));
    // By mpmath too.
    assert!(
        (value - 1.770_977_308_208_453_7).abs() < off && off < 1e-9,
        "{largest}"
    );
    refused(
        &format!("integrate --system {path} --until 1 --max-step 0"),
        "max-step is 0, but must be positive and finite",
    );
    refused(
        "integrate --interfaces 40 --driving 1 --stiffness 0.14 --until 1 --max-step 0.1",
        "--max-step",
    );
}

/// Kinks within a step of which the states know nothing, and plateaus between switches of `tanh`: the integrals by quadrature (mpmath), split
/// where the arguments are 0.
#[test]
fn what_rises_and_falls_between_the_ends_of_a_step_is_seen() {
    let along_a_line = [
        (
            "max(0, 0.3^2 - (sin(3*x) - 0.5)^2)/0.3^3",
            -1.9,
            1.800755383,
        ),
        ("max(0, 0.1^2 - (tanh(x) - 0.5)^2)/0.1^3", -1.9, 1.789027288),
        (
            "max(0, 0.001^2 - (exp(x)/3 - 1.5)^2)/0.001^3",
            -2.0,
            0.88888897,
        ),
        ("min(0, (sin(3*x) - 0.5)^2 - 0.09)", -1.9, -0.0486204),
        ("tanh((x + 1)/0.02) - tanh((x - 1)/0.02)", -2.0, 4.0),
    ];
    let integral = |states: &str, rates: &str, start: &str, options: &str| {
        let text = format!(
            "name = \"integral\"\nstates = [{states}]\n[rates]\n{rates}\n[start]\n{start}\ny = 0.0\n"
        );
        let path = file("integrals", &text);
        let made = object(&format!(
            "integrate --system {path} --final-only --estimate-error {options}"
        ));
        let off = number(&made, "/result/final/y_uncertainty");
        (number(&made, "/result/final/y"), off)
    };
    for (y, begin, truth) in along_a_line {
        let rates = format!("x = \"1\"\ny = \"{y}\"");
        let (made, off) = integral(
            "\"x\", \"y\"",
            &rates,
            &format!("x = {begin:?}"),
            "--until 4",
        );
        near(made, truth, off + 1e-7);
    }
    let along_an_oscillation = [
        ("max(0, 0.1^2 - (sin(3*u) - 0.5)^2)/0.1^3", 6.3224881),
        ("max(0, 0.3^2 - (tanh(3*u) - 0.5)^2)/0.3^3", 2.5880688),
        ("tanh((u^2 - 0.25)/0.01)", 2.6705066),
    ];
    for (y, truth) in along_an_oscillation {
        let rates = format!("u = \"v\"\nv = \"-u\"\ny = \"{y}\"");
        let states = "\"u\", \"v\", \"y\"";
        let (made, off) = integral(states, &rates, "u = 0.0\nv = 1.0", "--until 10");
        near(made, truth, off + 1e-7);
    }
}

/// A state that stays 0 is exact however much it would grow; one that passes 0 with all others has an estimate too.
#[test]
fn estimates_are_numbers_where_states_are_zero() {
    let growing = file(
        "growing",
        "name = \"growing\"\nstates = [\"x\", \"y\"]\n[rates]\nx = \"-x\"\ny = \"1000*y\"\n[start]\nx = 1.0\ny = 0.0\n",
    );
    let made = object(&format!(
        "integrate --system {growing} --until 3 --method rodas4 --rtol 1e-4 --atol 1e-4 --final-only --estimate-error"
    ));
    let [x, off] =
        ["x", "x_uncertainty"].map(|name| number(&made, &format!("/result/final/{name}")));
    assert!((x - (-3.0_f64).exp()).abs() <= off && off < 1e-3, "{made}");
    assert!(number(&made, "/result/final/error_estimate") > 1e-6);
    let clock = file(
        "clock",
        "name = \"clock\"\nstates = [\"x\"]\n[rates]\nx = \"1\"\n[start]\nx = -1.0\n",
    );
    let made = object(&format!(
        "integrate --system {clock} --until 2 --final-only --estimate-error"
    ));
    assert!(number(&made, "/result/final/x_uncertainty") < 1e-14);
}

/// Two runs of unlike tolerances can err alike by chance: ends in which a run of a hundredth of the tolerance did. By quadruple precision.
#[test]
fn second_runs_err_much_less_than_the_first() {
    for (run, name, truth) in [
        (
            "molniya-j2.toml --until 51891.1 --method taylor",
            "z",
            14468122.951933154,
        ),
        (
            "cstr.toml --until 62.6673 --method rodas4 --rtol 1e-6",
            "c",
            51.326_674_353_986_54,
        ),
        (
            "double-pendulum.toml --until 4.50708",
            "wb",
            1.335385066405342,
        ),
        ("jansen-rit.toml --until 0.966981", "yc", 15.602649196629087),
    ] {
        let made = object(&format!(
            "integrate --system tests/data/cases/{run} --final-only --estimate-error"
        ));
        let [value, off] =
            ["", "_uncertainty"].map(|part| number(&made, &format!("/result/final/{name}{part}")));
        assert!(
            (value - truth).abs() <= off,
            "{run}: {name} = {value} ± {off} for {truth}"
        );
    }
}

/// A diode that conducts for a moment of each turn, by an exponential of which the trace between is nothing, charges a capacitor. By quadruple
/// precision.
#[test]
fn a_diode_that_conducts_within_a_step_is_seen() {
    for method in ["auto", "taylor", "rodas5p"] {
        let run = format!("rectifier.toml --until 0.1 --method {method}");
        ends_at(&run, &[("v", 7.624_874_019_760_679)], 1e-5);
    }
}

/// The tighter run of an estimate also goes past where |x + y|^1.3 is 0, and past where a root that does not count there is: the lesser of two.
#[test]
fn estimates_are_made_where_powers_pass_zero() {
    let power = "name = \"power\"
states = [\"x\", \"y\"]
[rates]
x = \"y*y - 0.837*x\"
y = \"abs(x + y)^1.3 - 1.99*y\"
[start]
x = 0.0
y = -0.741
";
    let root = "name = \"root\"
states = [\"x\", \"y\"]
[rates]
x = \"max(sqrt(0.1 + abs(x + y)), abs(2*y)^0.5)\"
y = \"x\"
[start]
x = 1.838
y = -1.722
";
    for (name, text) in [("power-past-zero", power), ("lesser-root", root)] {
        let file = file(name, text);
        for method in ["taylor", "rodas5p"] {
            let made = object(&format!(
                "integrate --system {file} --until 5 --method {method} --final-only --estimate-error"
            ));
            let estimate = &made["result"]["final"]["error_estimate"];
            assert!(
                estimate.as_f64().is_some_and(|x| x < 1e-5),
                "{name} by {method}: {estimate}"
            );
        }
    }
}

/// Where a root of what is 0 for a stretch has no derivative implicit methods need none.
#[test]
fn implicit_methods_go_where_roots_are_zero() {
    let text = "name = \"root of nothing\"
states = [\"x\", \"y\"]
[rates]
x = \"sqrt(max(0, y - 1)) - x\"
y = \"1\"
[start]
x = 1.0
y = 0.0
";
    let file = file("root-of-nothing", text);
    for method in ["rodas5p", "rodas4", "rosenbrock23", "cvode-bdf"] {
        if method.starts_with("cvode") && !cfg!(feature = "sundials") {
            continue;
        }
        let made = object(&format!(
            "integrate --system {file} --until 0.9 --method {method} --final-only"
        ));
        let x = number(&made, "/result/final/x");
        assert!((x - (-0.9_f64).exp()).abs() < 1e-6, "{method}: {x}");
    }
}
