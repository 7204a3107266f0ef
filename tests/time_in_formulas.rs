//! Systems from files whose formulas name t, the time: runs of them against closed forms and references, by every method; and what other commands say.

use crate::command::{number, object, refused_in_one_line, twinslip};
use crate::common::ivp::{between, methods, plan, sampled, solved};
use crate::common::text::{file, near};
use std::convert::Infallible;
use twinslip::field::Vector;
use twinslip::integrate::{AnyField, AnyIntegrator, Choice, Tolerances};
use twinslip_tasks::scene::{IvpAsked, IvpEvent, IvpFormula, SystemFile};

/// By a tolerance near the last digit; one of order 2 would take millions of steps.
fn tight(method: &str) -> (f64, f64) {
    match method {
        "rosenbrock23" => (1e-8, 1e-5),
        _ => (1e-13, 1e-10),
    }
}

fn system(folder: &str, states: &[(&str, &str, f64)], more: &str) -> String {
    let part = |f: &dyn Fn(&(&str, &str, f64)) -> String| -> String {
        states.iter().map(f).collect::<Vec<_>>().join("\n")
    };
    let names: Vec<String> = states.iter().map(|one| format!("{:?}", one.0)).collect();
    let rates = part(&|(name, rate, _)| format!("{name} = {rate:?}"));
    let start = part(&|(name, _, x)| format!("{name} = {x:?}"));
    let names = names.join(", ");
    let text = format!(
        "name = \"forced\"\nstates = [{names}]\n[rates]\n{rates}\n[start]\n{start}\n{more}"
    );
    file(folder, &text)
}

/// x'' = -x + g cos(w t) from rest.
fn forced(folder: &str) -> String {
    let rates = [("x", "v", 0.0), ("v", "-x + g*cos(w*t)", 0.0)];
    system(folder, &rates, "[parameters]\ng = 1\nw = 2\n")
}

fn exact(t: f64) -> [f64; 2] {
    let x = (t.cos() - (2.0 * t).cos()) / 3.0;
    [x, (2.0 * (2.0 * t).sin() - t.sin()) / 3.0]
}

/// The end of a run of `integrate`.
#[track_caller]
fn end(arguments: &str, names: &[&str]) -> Vec<f64> {
    let made = object(&format!("integrate {arguments} --final-only"));
    let value = |name: &&str| number(&made, &format!("/result/final/{name}"));
    names.iter().map(value).collect()
}

#[test]
fn a_forced_oscillator_is_its_closed_form_by_every_method() {
    let path = forced("time-oscillator");
    for method in methods() {
        let (rtol, allowed) = tight(method);
        let run = format!("--system {path} --until 20 --rtol {rtol} --method {method}");
        for (made, exact) in end(&run, &["x", "v"]).iter().zip(exact(20.0)) {
            let off = (made - exact).abs();
            assert!(off < allowed, "{method}: {off:e}");
        }
    }
}

#[test]
fn duffings_oscillator_is_the_reference_by_every_method() {
    // By power series of order 50 in 60 decimal digits, from t = 0 to 20 and from 3 to 13.
    let exact = [-0.709_758_751_313_553_1, 0.011_323_776_654_692_194];
    let shifted = [-1.053_624_531_117_949_4, 0.643_766_937_931_296_5];
    for method in methods() {
        let (rtol, allowed) = tight(method);
        let words = format!("--system duffing --rtol {rtol} --method {method}");
        for (made, exact) in end(&format!("{words} --until 20"), &["x", "v"])
            .iter()
            .zip(exact)
        {
            let off = (made - exact).abs();
            assert!(off < allowed, "{method}: {off:e}");
        }
        let there = sampled(
            &plan(&words, (3.0, 13.0), &[0.5, -0.25]),
            &[8.0, 13.0],
            true,
        );
        let solution = there.solution.expect("asked for");
        for (i, exact) in shifted.into_iter().enumerate() {
            let off = (there.y[2 + i] - exact).abs();
            assert!(off < allowed, "{method} from 3: {off:e}");
            assert!((solution.at(8.0)[i] - there.y[i]).abs() < allowed);
        }
        let back = sampled(&plan(&words, (13.0, 3.0), &there.y[2..]), &[3.0], false);
        for (made, exact) in back.y.iter().zip([0.5, -0.25]) {
            let off = (made - exact).abs();
            assert!(off < 100.0 * allowed, "{method}, back: {off:e}");
        }
    }
}

#[test]
fn time_is_no_state_and_no_column() {
    let path = forced("time-columns");
    let made = object(&format!(
        "integrate --system {path} --until 20 --points 5 --estimate-error --reference"
    ));
    let rows = made["result"]["rows"].as_array().expect("rows");
    for row in rows {
        let t = row["time"].as_f64().expect("a time");
        assert_eq!(row.as_object().map(|row| row.len()), Some(3));
        for (name, exact) in ["x", "v"].into_iter().zip(exact(t)) {
            near(row[name].as_f64().expect("a state"), exact, 1e-7);
        }
    }
    assert_eq!(rows.len(), 5);
    assert_eq!(made["numerics"]["dimension"], 2);
    for (name, exact) in ["x", "v"].into_iter().zip(exact(20.0)) {
        let value = number(&made, &format!("/result/final/{name}"));
        let bound = number(&made, &format!("/result/final/{name}_uncertainty"));
        assert!((value - exact).abs() <= bound && bound < 1e-6, "{name}");
    }
    let told = twinslip(&format!(
        "integrate --system {path} --until 1 --final-only --explain"
    ));
    assert!(told.err.contains("2: x, v, driven by t"), "{}", told.err);
    refused_in_one_line(
        &format!("integrate --system {path} --until 1 --start 0,0,0"),
        "must have 2 values, one for each of x, v",
    );
}

#[test]
fn a_polynomial_in_time_is_exact() {
    let path = system("time-square", &[("x", "t^2", 0.0)], "");
    for method in methods() {
        let (rtol, allowed) = tight(method);
        let run = format!("--system {path} --until 3 --rtol {rtol} --method {method}");
        near(end(&run, &["x"])[0], 9.0, allowed);
    }
    near(
        end(&format!("--system {path} --until 3"), &["x"])[0],
        9.0,
        1e-15,
    );
}

#[test]
fn a_stiff_approach_to_a_cosine_ends_on_it() {
    // Prothero and Robinson (1974).
    let path = system(
        "time-stiff",
        &[("y", "-1e4*(y - cos(t)) - sin(t)", 1.5)],
        "",
    );
    for method in methods() {
        let (rtol, allowed) = match method {
            "rosenbrock23" => (1e-7, 1e-6),
            "cvode-bdf" | "cvode-adams" => (1e-11, 1e-9),
            _ => (1e-11, 1e-10),
        };
        let run = format!("--system {path} --until 10 --rtol {rtol} --method {method}");
        near(end(&run, &["y"])[0], 10.0_f64.cos(), allowed);
    }
}

#[test]
fn kinks_in_time_are_met() {
    let path = system(
        "time-kinks",
        &[
            ("x", "abs(sin(t))", 0.0),
            ("y", "max(t - 1, 0)", 0.0),
            ("z", "min(t, 2) + z*0", 0.0),
        ],
        "",
    );
    let made = end(
        &format!("--system {path} --until 10 --rtol 1e-13"),
        &["x", "y", "z"],
    );
    // Three arches, and a part of the fourth.
    let part = 1.0 + (10.0 - 3.0 * std::f64::consts::PI).cos();
    near(made[0], 8.0 - part, 1e-12);
    near(made[1], 40.5, 1e-13);
    near(made[2], 18.0, 1e-13);
}

#[test]
fn many_steps_do_not_make_time_late() {
    // A million steps and more, by a method in which time is a sum of roundings.
    let path = system("time-late", &[("x", "-x + cos(t)", 0.5)], "");
    let run = format!("--system {path} --until 2e4 --rtol 1e-12 --method rodas5p");
    let exact = (2e4_f64.cos() + 2e4_f64.sin()) / 2.0;
    near(end(&run, &["x"])[0], exact, 3e-12);
}

#[test]
fn results_are_the_same_in_other_units_of_time() {
    // Seconds and years, of which the ratio is no power of two.
    const YEAR: f64 = 31_556_952.0;
    for (rate, sized) in [("-a*x + g*cos(w*t)", 1.0), ("g*cos(w*t)", 1e-9)] {
        let of = |unit: f64, folder: &str| {
            let [a, g, w] = [1e-6 * unit, sized * unit, 2e3 * unit];
            let parameters = format!("[parameters]\na = {a:e}\ng = {g:e}\nw = {w:e}\n");
            let path = system(folder, &[("x", rate, 0.0)], &parameters);
            let until = 100.123 / 2e3 / unit;
            end(&format!("--system {path} --until {until:e}"), &["x"])[0]
        };
        let (one, other) = (of(1.0, "time-seconds"), of(YEAR, "time-years"));
        let size = sized / 2e3;
        assert!((one - 100.123_f64.sin() * size).abs() < 1e-6 * size);
        assert!((one - other).abs() < 1e-7 * size, "{one} and {other}");
    }
}

#[test]
fn a_shifted_start_gives_the_same_numbers() {
    let path = system("time-shift", &[("x", "-x + cos(t - 1e6)", 0.5)], "");
    let words = format!("--system {path} --rtol 1e-12");
    let times = between(1e6, 1e6 + 10.0, 3);
    let made = sampled(&plan(&words, (1e6, 1e6 + 10.0), &[0.5]), &times, false);
    // Times near 1e6 are rounded to 1e-10.
    near(made.y[2], (10.0_f64.cos() + 10.0_f64.sin()) / 2.0, 1e-10);
}

#[test]
fn a_short_push_is_met_with_a_largest_step() {
    let path = system("time-push", &[("x", "exp(-((t - 50)/0.01)^2)", 0.0)], "");
    for method in methods() {
        let run = format!(
            "--system {path} --until 100 --method {method} --max-step 0.01 --rtol 1e-6 --atol 1e-9"
        );
        near(
            end(&run, &["x"])[0],
            0.01 * std::f64::consts::PI.sqrt(),
            1e-6,
        );
    }
}

#[test]
fn events_may_depend_on_time() {
    let path = forced("time-events");
    for method in methods() {
        let (rtol, allowed) = tight(method);
        let words = format!("--system {path} --rtol {rtol} --method {method}");
        let text = "name = \"event\"\nstates = [\"x\", \"v\"]\n[rates]\nx = \"x*0 + sin(3*t)\"\nv = \"0\"\n";
        let formula = IvpFormula::parse(text, 2).expect("a formula");
        let crossing = IvpEvent::new(|t, y: &[f64]| Ok(y[0] - exact(t)[0] + t - 2.5));
        let outcome = solved(
            &plan(&words, (0.1, 5.0), &exact(0.1)),
            IvpAsked::<Infallible> {
                events: vec![
                    IvpEvent::of(formula),
                    IvpEvent {
                        terminal: Some(1),
                        ..crossing
                    },
                ],
                ..IvpAsked::default()
            },
        );
        assert_eq!(outcome.status, 1, "{method}");
        near(outcome.t_events[1][0], 2.5, allowed);
        let third = std::f64::consts::PI / 3.0;
        assert_eq!(outcome.t_events[0].len(), 2, "{method}");
        for (k, t) in outcome.t_events[0].iter().enumerate() {
            near(*t, third * (k + 1) as f64, 1e-13);
        }
    }
}

#[test]
fn a_blow_up_is_told_at_its_time() {
    // x = y'/y of Airy's equation y'' = -t y with y'(0) = 0: the first zero of sqrt(3) Ai(-t) + Bi(-t), by SciPy 1.17.
    let path = system("time-blow-up", &[("x", "x^2 + t", 0.0)], "");
    let ended = twinslip(&format!("integrate --system {path} --until 5 --final-only"));
    assert_eq!(ended.code, 1, "{}", ended.err);
    assert!(ended.err.contains("1.98635"), "{}", ended.err);
}

#[test]
fn derivatives_are_those_of_the_closed_form() {
    let text = std::fs::read_to_string(forced("time-derivatives")).expect("a file");
    let system = SystemFile::parse("forced", &text).expect("a system").system;
    let g = system
        .parameter_names()
        .iter()
        .position(|name| *name == "g");
    let field = AnyField::of_text(std::borrow::Cow::Borrowed(&system)).expect("a field");
    let start = Vector::from_vec(vec![0.0; 3]);
    for choice in [Choice::Taylor, Choice::Radau] {
        let tolerances = Tolerances::equal(1e-13).expect("tolerances");
        let mut by = AnyIntegrator::new(choice, tolerances, 100_000).expect("a method");
        let (end, made) = by
            .derivatives(&field, (0.0, 7.0), &start, &[g.expect("a name")])
            .expect("derivatives");
        let [x, v] = exact(7.0);
        for (row, value) in [x, v, 0.0].into_iter().enumerate() {
            near(made.parameters[(row, 0)], value, 1e-11);
        }
        for (row, value) in [x, v, 7.0].into_iter().enumerate() {
            near(end[row], value, 1e-11);
        }
        near(made.start[(0, 0)], 7.0_f64.cos(), 1e-11);
        near(made.start[(0, 1)], 7.0_f64.sin(), 1e-11);
        // Of a later beginning: x'' + x = -2 sin(2 t), from rest.
        near(
            made.start[(0, 2)],
            2.0 * (14.0_f64.sin() - 2.0 * 7.0_f64.sin()) / 3.0,
            1e-11,
        );
    }
}

#[test]
fn what_is_called_t_is_not_time() {
    let text = "name = \"own\"\nstates = [\"t\"]\n[rates]\nt = \"-t\"\n[start]\nt = 1\n";
    let path = file("time-own", text);
    near(
        end(&format!("--system {path} --until 1"), &["t"])[0],
        (-1.0_f64).exp(),
        1e-8,
    );
    object(&format!("equilibria --system {path}"));
    let path = system(
        "time-parameter",
        &[("x", "-x + t", 0.0)],
        "[parameters]\nt = 2\n",
    );
    let made = object(&format!("equilibria --system {path}"));
    near(number(&made, "/result/equilibria/0/x/value"), 2.0, 1e-14);
}

#[test]
fn the_states_beside_time_are_bounded() {
    let most = twinslip::model::TextSystem::LARGEST;
    let names: Vec<String> = (1..=most).map(|i| format!("x{i}")).collect();
    let of = |count: usize| {
        let states: Vec<_> = names[..count]
            .iter()
            .map(|name| (&**name, "cos(t)", 0.0))
            .collect();
        system("time-many", &states, "")
    };
    let last = names[most - 2].as_str();
    near(
        end(&format!("--system {} --until 1", of(most - 1)), &[last])[0],
        1.0_f64.sin(),
        1e-8,
    );
    refused_in_one_line(
        &format!("integrate --system {} --until 1", of(most)),
        &format!(
            "there are {most} states, but there must be 1 to {} where the rate of x1 names t, the time",
            most - 1
        ),
    );
}

#[test]
fn other_commands_refuse_time_in_one_sentence() {
    let path = system(
        "time-refused",
        &[("x", "v", 1.0), ("v", "-x + push", 0.0)],
        "[parameters]\ng = 1\nw = 2\n[where]\npush = \"w*cos(w*t)\"\n",
    );
    let sentence = ":13:17: push names t, the time: only `integrate`, and solve_ivp in Python, take such a system, unless the file says of what period that is";
    for command in [
        "equilibria",
        "equilibria --box x=-1:1,v=-1:1",
        "orbit",
        "orbit --period-guess 3 --points 5",
        "section --surface x=0",
        "branch equilibria --along w --from 1 --to 2",
        "branch orbits --along w --from 1 --to 2",
        "locus hopf --in w,g --range w=1,2 --range g=1,2",
        "locus torus --in w,g --range w=1,2 --range g=1,2",
        "sweep --grid w=1:2:2",
        "sweep --basin --state-1 x=-1:1:2 --state-2 v=-1:1:2",
        "law",
    ] {
        refused_in_one_line(&format!("{command} --system {path}"), sentence);
    }
    refused_in_one_line(&format!("orbit --system {path}"), "period = \"2*pi/w\"");
    // A law is the same at all times.
    let law = "slip_rate = \"sinh(tau)*psi*t\"\nevolution = \"1 - v*psi\"\n";
    let path = file("time-law", law);
    for command in ["law", "integrate --driving 1 --stiffness 1 --until 1"] {
        refused_in_one_line(
            &format!("{command} --law {path}"),
            ":1:28: \"t\" is time, on which a law cannot depend",
        );
    }
}
