//! To what each option of the commands is changed.

use super::runs::Kind::{self, Clusters, Law, Many, One, Si, System, Two, Unequal};

/// How an option is changed.
pub enum Change {
    /// To this value; empty for a switch.
    To(&'static str),
    /// Likewise, beside other options.
    With(&'static str, &'static str),
    /// To a file, which is written; beside other options.
    File(&'static str),
    /// Not, for the reason that stands beside it.
    Exempt,
}
use Change::{Exempt, File, To, With};

/// What is refused for every kind that is run here: of two commands that share their options what is of orbits alone, what a law has none of, and all
/// clusters where all steady states are found; what varies in time where nothing moves. What varies is given to no run of these kinds.
pub const NEVER: [(&str, &str); 23] = [
    ("branch equilibria", "crosscheck"),
    ("branch equilibria", "doublings"),
    ("branch equilibria", "modulate"),
    ("branch equilibria", "normal-stress-coupling"),
    ("branch equilibria", "period-guess"),
    ("branch equilibria", "turns"),
    ("branch orbits", "driving"),
    ("branch orbits", "turns"),
    ("equilibria", "clusters"),
    ("equilibria", "modulate"),
    ("equilibria", "normal-stress-coupling"),
    ("law", "clusters"),
    ("law", "modulate"),
    ("law", "normal-stress-coupling"),
    ("law", "system"),
    ("locus hopf", "crosscheck"),
    ("locus hopf", "driving"),
    ("locus hopf", "hold"),
    ("locus hopf", "period-guess"),
    ("locus hopf", "stiffness"),
    ("locus hopf", "system"),
    ("locus hopf", "turns"),
    ("orbit", "turns"),
];

/// To what an option is changed, so that something must come of it; `None` where nobody has thought of that.
pub fn change(command: &str, kind: Kind, option: &str) -> Option<Change> {
    let system = kind == System;
    let follows = follows(command);
    Some(match option {
        // Of the program.
        "help" => Exempt,
        // How results are shown, which a test of their own looks at.
        "format" | "output" | "force" | "quiet" | "explain" => Exempt,
        // Files of an earlier run: tests/durability_files.rs, tests/many.rs, tests/ensemble.rs.
        "resume" | "checkpoint" | "checkpoint-steps" | "ensemble" => Exempt,
        // The same: tests/curves_that_begin.rs.
        "begin" => Exempt,
        // They change how fast a sweep is, and no row.
        "threads" => Exempt,
        // Both come to the same digits, as its help says.
        "solver" => Exempt,
        "plot" if command == "sweep" && kind == Two => {
            File("--driving 10:10.5:2 --stiffness 0.14:0.15:2 --curves hopf")
        }
        "plot" if command == "sweep" && !system => File(if kind == Si {
            "--driving 1e-5:1.05e-5:2"
        } else {
            "--driving 10:10.5:2"
        }),
        "plot" => File(""),
        "curves" => Exempt,
        "data" => To("tests/data/steady-friction.csv"),
        "plot-events" => File("--events"),
        _ if model(option) => return model_change(command, kind, option),
        "along" if system && command == "branch orbits" => To("a --from 1 --to 1.5"),
        "along" if system => To("s --from 9 --to 11"),
        // Where an orbit is found at once.
        "along" if kind == Clusters && command == "branch orbits" => {
            With("--driving 188", "healing_time --from 99 --to 101")
        }
        "along" => With("--driving 200", "healing_time --from 90 --to 110"),
        "at" if command == "locus hopf" => To(match kind {
            System => "r=24.8",
            Si => "stiffness=5.45e9",
            _ => "stiffness=0.14",
        }),
        "at" if command == "branch orbits" => To(orbit_at(kind)),
        "at" => To(match kind {
            System => "24.7",
            Si => "2e-4",
            _ => "190",
        }),
        "at-driving" if kind == Si => To("2.3e-4"),
        "at-driving" => To(if kind == Two || kind == Clusters {
            "190"
        } else {
            "231"
        }),
        "at-stiffness" => To(if kind == Si { "5.45e9" } else { "0.1405" }),
        "atol" => To("1e-4"),
        "basin" if system => To("--grid b=1.5:1.5:1"),
        "basin" => To("--state-1 1e-3:1:2log --state-2 1e-3:1:2log"),
        "box" if command == "locus hopf" && system => To("x=5:10,y=5:10,z=10:40"),
        "box" if system => To("x=5:10,y=5:10,z=10:40"),
        "box" if kind == Law && command.starts_with("equ") => {
            To("stress=0:5,log_state_1=-9:0,log_state_2=-9:0")
        }
        // Along it the branch would come to a Hopf point of which nothing is known.
        "box" if command == "branch orbits" => With(
            if kind == Clusters {
                "--to 187"
            } else {
                "--to 225"
            },
            "stress=0:5,log_state_1=-5:0",
        ),
        "box" => To("stress=0:5,log_state_1=-9:0"),
        "columns" => To("time"),
        // Curves of equilibria in any parameters say it at every point, asked for or not.
        "criticality" if [Unequal, Clusters, Law, System].contains(&kind) => Exempt,
        "criticality" => To(""),
        // Those of two interfaces take longest: tests/branches.rs, tests/any_parameter_slab.rs.
        "crosscheck" if command == "branch orbits" && [Two, Unequal].contains(&kind) => Exempt,
        "crosscheck" if command == "branch orbits" => With(
            match orbit_at(kind) {
                "2.05" => "--at 2.05",
                "188" => "--at 188",
                _ => "--at 225",
            },
            "rodas5p",
        ),
        "crosscheck" => To("rodas5p"),
        "derivatives" => To(match system {
            true => "r",
            false => "stiffness",
        }),
        // Where periods double is far along these branches: tests/any_parameter.rs.
        "doublings" if command == "branch orbits" => Exempt,
        "doublings" => To("1"),
        "draw" if kind == Many => To("evolution_effect=0.048:0.049"),
        "draw" => To("healing_time=90:110"),
        "driving-range" if kind == Si => To("1.8e-4:2.2e-4"),
        "driving-range" => To("180:210"),
        "estimate-error" | "final-only" | "upwards" => To(""),
        // Each of many slips while it is faster, and there are others of these events with any other threshold.
        "event-threshold" if kind == Many => With("--until 20 --start spread:1 --events", "1e3"),
        "event-threshold" => With("--until 20 --events", "1e5"),
        "events" => To(""),
        "every" => To("0.5"),
        "follow" | "shard" if system => To(if option == "shard" { "1/2" } else { "" }),
        "follow" | "shard" => With(
            if kind == Si {
                "--driving 1e-5:1.05e-5:2"
            } else {
                "--driving 10:10.5:2"
            },
            if option == "shard" { "1/2" } else { "" },
        ),
        "from" if command == "law" => To("1e-8"),
        "from" if command == "branch orbits" && system => To("2.2"),
        "from" => To(match kind {
            System => "24.6",
            Si => "1.87e-4",
            _ if command == "branch orbits" => orbit_at(kind),
            _ => "187",
        }),
        "diagram" => To(if system { "x" } else { "stress" }),
        "grid" if system => To("a=1:1.1:2"),
        "grid" => To("healing_time=90:110:2"),
        "in" if system => To("s,r"),
        "in" => With(
            "--driving 190",
            "stiffness,healing_time --range healing_time=90,110",
        ),
        // The regime of a torus or of chaos alone: minutes.
        "lyapunov" if command == "sweep" => Exempt,
        "lyapunov" => With("--returns 60", ""),
        "max-points" => To("2"),
        // No point takes more than the least that is allowed, which tells a torus.
        "max-returns" => Exempt,
        "max-step" => To(if command == "orbit" { "0.1" } else { "0.01" }),
        "max-steps" => To("1"),
        // Quick with such a tolerance.
        "method" if command == "orbit" => With("--rtol 1e-5", "rodas5p"),
        "method" => To("rodas5p"),
        "participation" => With("--events", ""),
        "patience" => To("1e-3"),
        // What an orbit of formulas is found from takes seconds: tests/cluster_branches.rs.
        "period-guess"
            if command == "branch orbits" && [Unequal, Clusters, Law].contains(&kind) =>
        {
            Exempt
        }
        "period-guess" if follows => With(
            match kind {
                System if command == "branch orbits" => "--from 2.1 --to 2.2 --start 1.9,1.5",
                System => "--start 1,1,20",
                One | Law | Clusters => "--start 9,1e-3",
                _ => "--start 9,1e-3,2e-3",
            },
            "7",
        ),
        "period-guess" if system => With("--start 1.9,1.5", "7.5"),
        "period-guess" => With("--start near-symmetric:0.1", "3"),
        "phase-response" => To(""),
        "points" => To("7"),
        "program" => To("1:5"),
        "range" if system => To("r=24.5,26"),
        "range" if kind == Si => To("driving=1.8e-4,2.2e-4"),
        "range" => To("driving=180,210"),
        "reference" => With("--estimate-error", ""),
        "returns" => To("3"),
        "rtol" if command == "sweep" => To("1e-7"),
        "rtol" => To("1e-5"),
        "seed" if command == "sweep" => With("--starts 4", "2"),
        "seed" => To("2"),
        "skip" => To("1"),
        "start" if command == "branch orbits" && system => With("--from 2.1 --to 2.2", "1.9,1.5"),
        "start" if system && (follows || command == "equilibria") => To("5,5,20"),
        "start" if system => To("1.2,2.5"),
        "start" if kind == Many => To("near-symmetric:0.5"),
        // From so far away no equilibrium is found.
        "start" if follows => To("1e3,1e-3"),
        "start" if kind == One => To("9,1e-3"),
        "start" => To("near-symmetric:-0.1"),
        "starts" => To("2"),
        "state-1" | "state-2" if system => To("x=1:2:2"),
        "state-1" | "state-2" => With(
            "--basin --state-1 1e-3:1:2log --state-2 1e-3:1:2log",
            "1e-2:0.9:2log",
        ),
        "stiffness-range" if kind == Si => To("5.42e9:5.5e9"),
        "stiffness-range" => To("0.1395:0.141"),
        "step-limit" => To("0.3"),
        "hold" => To("period=1"),
        "watch" if command == "branch equilibria" => To(match kind {
            System => "z=24",
            Si => "driving=2e-4",
            _ => "driving=190",
        }),
        "watch" if command == "branch orbits" => To(match kind {
            System => "period=6.3",
            Clusters => "driving=188",
            Two => "driving=187",
            Unequal => "driving=231.1",
            _ => "driving=225",
        }),
        "watch" => To(match kind {
            System => "r=24.8",
            Si => "stiffness=5.45e9",
            _ => "stiffness=0.14",
        }),
        "surface" if system => To(if command == "sweep" { "y" } else { "x=1.1" }),
        "surface" => To("stress=9.5"),
        "symmetry" => To("asymmetric"),
        "to" if command == "law" => To("1e9"),
        "to" if command == "branch orbits" && system => To("1.99"),
        "to" => To(match kind {
            System => "24.8",
            Si => "2.2e-4",
            Two | Clusters if command == "branch orbits" => "190",
            Unequal if command == "branch orbits" => "232",
            _ if command == "branch orbits" => "225",
            _ => "210",
        }),
        "tolerance" => To("1e-15"),
        // Nothing is forced here: tests/forced.rs.
        "turns" => To("2"),
        "until" => To("2"),
        _ => return None,
    })
}

/// A value along the branches of orbits.
fn orbit_at(kind: Kind) -> &'static str {
    match kind {
        System => "2.05",
        Two | Clusters => "188",
        Unequal => "231.2",
        _ => "225",
    }
}

/// Whether an option says what slides.
fn model(option: &str) -> bool {
    [
        "driving",
        "stiffness",
        "system",
        "set",
        "law",
        "interfaces",
        "clusters",
        "healing-time",
        "residual-strength",
        "direct-effect",
        "evolution-effect",
        "reference-friction",
        "damping",
        "second-evolution-effect",
        "second-slip-length",
        "mass",
        "modulate",
        "normal-stress-coupling",
        "si",
        "shear-modulus",
        "shear-wave-speed",
        "slip-length",
        "reference-rate",
        "time-unit",
        "normal-stress",
    ]
    .contains(&option)
}

/// Whether a command follows branches or curves.
fn follows(command: &str) -> bool {
    command.starts_with("branch") || command.starts_with("locus")
}

fn model_change(command: &str, kind: Kind, option: &str) -> Option<Change> {
    let si = kind == Si;
    let of_law = command == "law";
    // These take longest: what slides is read for them as for the equilibria on which they begin.
    let dear = match command {
        "branch orbits" => kind != System,
        "orbit" => [Unequal, Clusters, Law].contains(&kind),
        _ => command == "locus hopf" && kind == Unequal,
    };
    Some(match option {
        "driving" if command == "branch equilibria" => With(
            if si {
                "--along residual_strength --from 1e-3 --to 2e-3 --driving 2e-4"
            } else {
                "--along healing_time --from 90 --to 110 --driving 200"
            },
            if si { "2.1e-4" } else { "210" },
        ),
        "driving" => To(if si { "1.1e-5" } else { "11" }),
        "stiffness" if of_law => With(
            if si { "--driving 1e-5" } else { "--driving 10" },
            if si { "5e9" } else { "0.15" },
        ),
        // Whether it is stable changes, which is all that there is of the stiffness.
        "stiffness" if kind == Many && command == "equilibria" => To("1e-6"),
        "stiffness" if command == "branch orbits" => To("0.1399"),
        "stiffness" => To(if si { "5.5e9" } else { "0.15" }),
        "system" if command == "locus hopf" => To(if kind == System {
            "lorenz-84 --in a,b"
        } else {
            "roessler --in a,b"
        }),
        "system" if command == "branch equilibria" && kind == System => {
            With("--along b --from 2 --to 3", "roessler")
        }
        "system" if kind == System => To(if command == "integrate" {
            "van-der-pol"
        } else {
            "lorenz-84"
        }),
        "system" => To("roessler"),
        "set" if kind == System => To(match command {
            "equilibria" | "branch equilibria" | "locus hopf" => "b=2",
            "integrate" => "g=1.2",
            _ => "a=0.98",
        }),
        "set" if kind == Many => To("residual_strength=2e-3"),
        "set" => To("healing_time=95"),
        "law" => To("slip"),
        "interfaces" if of_law => With(
            if si { "--driving 1e-5" } else { "--driving 10" },
            if kind == One { "2" } else { "1" },
        ),
        "interfaces" if kind == Many => To("51"),
        "interfaces" if kind == Clusters => To("3"),
        "interfaces"
            if kind == One
                || kind == Law && !["equilibria", "integrate", "section"].contains(&command) =>
        {
            To("2")
        }
        "interfaces" => To("1"),
        "clusters" if kind == Clusters && ["integrate", "section"].contains(&command) => To("1,3"),
        // Formulas with a state for each of two interfaces are those of two without clusters.
        "clusters" if kind == Law && ["integrate", "section"].contains(&command) => To("2"),
        "clusters" if kind == Two && follows(command) => To("2"),
        "clusters" if kind == Unequal && follows(command) => To("2"),
        "clusters" => To("1,1"),
        _ if dear && !["driving", "stiffness", "system", "law"].contains(&option) => Exempt,
        // A time t**, of which 90 s are what is usual.
        "healing-time" => To("85"),
        "residual-strength" => To("1.5e-3"),
        "direct-effect" => To("0.036"),
        "evolution-effect" => To("0.05"),
        "reference-friction" => To("0.38"),
        "damping" => To(if si { "1e7" } else { "0.01" }),
        // All steady states in a box of more dimensions, for each value on the way.
        "second-evolution-effect" | "second-slip-length" | "mass" if command == "locus hopf" => {
            Exempt
        }
        "second-evolution-effect" => With(
            if si {
                "--second-slip-length 4e-6 --second-evolution-effect 1e-3"
            } else {
                "--second-slip-length 4 --second-evolution-effect 1e-3"
            },
            "1.5e-3",
        ),
        "second-slip-length" => With(
            if si {
                "--second-slip-length 4e-6 --second-evolution-effect 1e-3"
            } else {
                "--second-slip-length 4 --second-evolution-effect 1e-3"
            },
            if si { "5e-6" } else { "5" },
        ),
        // In units of 3.5e10 kg/m^2.
        "mass" => To(if si { "3.5e11" } else { "10" }),
        "modulate" => To("driving=0.1:5"),
        // Where it has an orbit of one period.
        "normal-stress-coupling" if command == "orbit" => With(
            "--modulate normal_stress=0.01:5 --normal-stress-coupling 0.1",
            "0.3",
        ),
        "normal-stress-coupling" => With(
            "--modulate normal_stress=0.1:5 --normal-stress-coupling 0.1",
            "0.3",
        ),
        // In numbers of SI, which these are not, runs take long: those of the kind in SI are made of them.
        "si" if [Two, Unequal, One, Si].contains(&kind) && !of_law => Exempt,
        "si" if si => Exempt,
        "si" => To(""),
        "shear-modulus" if si => With("--shear-wave-speed 3000 --shear-modulus 20e9", "30e9"),
        "shear-wave-speed" if si => With("--shear-modulus 30e9 --shear-wave-speed 2000", "3000"),
        "shear-modulus" => To("30e9"),
        "shear-wave-speed" => To("3000"),
        "slip-length" => To("1e-6"),
        "reference-rate" => To("1.1e-6"),
        "time-unit" if command == "integrate" => With("--final-only --until 0.001", "day"),
        "time-unit" => To("day"),
        "normal-stress" => To("1.1e6"),
        _ => return None,
    })
}
