//! Values with units, symbols of parameters, and ranges by name, on the command line and in scene files.

use crate::command;
use command::{Ended, folder, number, object, refused, run, twinslip};

/// A fault, its numbers with units.
const FAULT: &str = "integrate --law ageing --interfaces 1 --set a=0.01,b=0.015,mu0=0.6 --slip-length 10um --normal-stress 50MPa \
    --driving 1nm/s --stiffness 50MPa/mm --until 2year --final-only";
/// The same in SI.
const IN_SI: &str = "integrate --law dieterich-ruina --interfaces 1 --si --direct-effect 0.01 --evolution-effect 0.015 \
    --reference-friction 0.6 --slip-length 1e-5 --normal-stress 5e7 --driving 1e-9 --stiffness 5e10 --until 63115200 --final-only";

#[test]
fn units_and_symbols_are_numbers_in_si_and_names() {
    let (with, without) = (object(FAULT), object(IN_SI));
    for part in ["model", "units", "result"] {
        assert_eq!(with[part], without[part], "{part}");
    }
    assert_eq!(number(&with, "/model/slip_length"), 1e-5);
    assert_eq!(with["model"]["law"], "dieterich-ruina");
    // What was typed is in the output as it was typed.
    assert!(with["command"].to_string().contains("10um"));
}

#[test]
fn every_unit_has_its_size() {
    let read = |option: &str, name: &str| {
        let made = object(&format!("law --si --points 2 --damping 1 {option}"));
        number(&made, &format!("/model/{name}"))
    };
    for (value, size) in [
        ("2km", 2e3),
        ("2m", 2.0),
        ("2cm", 2e-2),
        ("2mm", 2e-3),
        ("2um", 2e-6),
        ("2µm", 2e-6),
        ("2e3nm", 2e-6),
    ] {
        assert_eq!(read(&format!("--slip-length {value}"), "slip_length"), size);
    }
    for (value, size) in [
        ("3Pa", 3.0),
        ("3kPa", 3e3),
        ("3MPa", 3e6),
        ("3GPa", 3e9),
        ("3bar", 3e5),
    ] {
        assert_eq!(
            read(&format!("--normal-stress {value}"), "normal_stress"),
            size
        );
    }
    for (value, size) in [
        ("5m/s", 5.0),
        ("5mm/s", 5e-3),
        ("5um/s", 5e-6),
        ("5nm/s", 5e-9),
        ("5mm/year", 5e-3 / 31_557_600.0),
        ("5cm/year", 5e-2 / 31_557_600.0),
    ] {
        assert_eq!(read(&format!("--driving {value}"), "driving"), size);
    }
    for (value, size) in [
        ("7s", 7.0),
        ("7ms", 7e-3),
        ("7min", 420.0),
        ("7hour", 25_200.0),
        ("7day", 604_800.0),
        ("7year", 220_903_200.0),
    ] {
        assert_eq!(
            read(&format!("--healing-time {value}"), "healing_time"),
            size
        );
    }
    for (value, size) in [("4Pa/m", 4.0), ("4MPa/mm", 4e9), ("4GPa/km", 4e6)] {
        assert_eq!(read(&format!("--stiffness {value}"), "stiffness"), size);
    }
    let damped = object("law --points 2 --damping 2MPa.s/m");
    assert_eq!(number(&damped, "/model/damping"), 2e6);
}

/// Times of a run are in the unit of --time-unit, and parameters in SI.
#[test]
fn times_with_a_unit_come_out_in_the_unit_that_is_asked_for() {
    let made = object(&format!("{FAULT} --time-unit day --set healing_time=3day"));
    assert_eq!(number(&made, "/result/final/time"), 2.0 * 365.25);
    assert_eq!(number(&made, "/model/healing_time"), 3.0 * 86_400.0);
    let program = "--program 1day:1um/s,2day-3day:0,1year:1nm/s --time-unit day";
    let made = object(&format!("{FAULT} {program}"));
    assert_eq!(
        made["model"]["program"],
        "1:0.000001,2-3:0,365.25:0.000000001"
    );
}

#[test]
fn a_unit_of_another_kind_is_refused() {
    for (option, sentence) in [
        (
            "--driving 10um",
            "--driving 10um: a velocity is wanted, as 10um/s",
        ),
        (
            "--slip-length 3MPa",
            "--slip-length 3MPa: a length is wanted, as 3um",
        ),
        ("--until 5km", "--until 5km: a time is wanted, as 5year"),
        ("--normal-stress 5year", "a stress is wanted, as 5MPa"),
        ("--stiffness 5MPa", "a stiffness is wanted, as 5MPa/mm"),
        (
            "--driving 10um/fortnight",
            "\"um/fortnight\" is not a unit; a velocity is wanted",
        ),
        (
            "--set a=1um",
            "--set direct_effect=1um: a number without a unit is wanted",
        ),
        (
            "--set Dc=10um/s",
            "--set slip_length=10um/s: a length is wanted, as 10um",
        ),
        ("--program 1um:2um/s", "--program 1um: a time is wanted"),
    ] {
        refused(&format!("integrate {option}"), sentence);
    }
    // Numbers of a system from a file have no units.
    refused(
        "integrate --system lorenz --until 10 --set r=5um",
        "\"5um\" is not a finite number",
    );
}

#[test]
fn a_number_without_a_unit_beside_one_with_is_pointed_out() {
    let Ended { err, .. } = twinslip("law --points 2 --slip-length 2um --driving 5");
    assert!(
        err.contains("warning: --driving 5 is without a unit and is read in SI"),
        "{err}"
    );
    for quiet in [
        "law --points 2 --slip-length 2um --driving 5 -q",
        "law --points 2 --si --slip-length 2um --driving 5",
        "law --points 2 --driving 5",
    ] {
        let err = twinslip(quiet).err;
        assert!(!err.contains("without a unit"), "{quiet}: {err}");
    }
}

#[test]
fn ranges_by_name_are_those_of_the_older_options() {
    for (new, old) in [
        (
            "branch equilibria --stiffness 0.3 --along driving=0.1:10",
            "branch equilibria --stiffness 0.3 --along driving --from 0.1 --to 10",
        ),
        (
            "branch equilibria --driving 1 --along K=0.1:0.5 --set c=2e-3",
            "branch equilibria --driving 1 --along stiffness --from 0.1 --to 0.5 --residual-strength 2e-3",
        ),
        (
            "branch equilibria --system lorenz --along r=0.5:5 --box x=-9:9,y=-9:9,z=-9:40",
            "branch equilibria --system lorenz --along r --from 0.5 --to 5 --box x=-9:9,y=-9:9,z=-9:40",
        ),
        (
            "locus hopf --in driving=0.01:100,K=0.2:0.4",
            "locus hopf --range driving=0.01,100 --range stiffness=0.2,0.4",
        ),
        (
            "sweep --grid K=0.3:0.5:2 --driving 1000",
            "sweep --grid stiffness=0.3:0.5:2 --driving 1000",
        ),
        (
            "branch equilibria --driving 1um/s --stiffness 5GPa/m --along Dc=1um:2um",
            "branch equilibria --si --driving 1e-6 --stiffness 5e9 --along slip_length --from 1e-6 --to 2e-6",
        ),
    ] {
        let (new, old) = (object(new), object(old));
        assert_eq!(new["result"], old["result"]);
        assert_eq!(new["numerics"], old["numerics"]);
    }
    refused(
        "branch equilibria --stiffness 0.3 --along driving=0.1:10:20",
        "points are placed by the curve",
    );
    refused(
        "branch equilibria --stiffness 0.3 --along driving=0.1:10 --from 1",
        "--from",
    );
}

/// A scene file holds the same values, and a unit of the wrong kind is found by its line.
#[test]
fn scenes_take_units_symbols_and_ranges() {
    let path = folder("units-in-scenes").join("fault.toml");
    let name = path.to_str().expect("UTF-8").to_owned();
    let scene = |driving: &str| {
        format!(
            "command = \"integrate\"\nlaw = \"aging\"\ninterfaces = 1\ndriving = {driving}\nslip-length = \"10um\"\n\
             normal-stress = \"50MPa\"\nstiffness = \"50MPa/mm\"\nuntil = \"2year\"\nfinal-only = true\n\
             [set]\na = 0.01\nb = 0.015\nmu0 = 0.6\n"
        )
    };
    std::fs::write(&path, scene("\"1nm/s\"")).expect("written");
    let (scened, typed) = (object(&format!("run {name}")), object(IN_SI));
    assert_eq!(scened["result"], typed["result"]);
    std::fs::write(&path, scene("\"1nm\"")).expect("written");
    let ended = run(&["run", &name]);
    assert_eq!(ended.code, 2, "{}", ended.err);
    assert!(
        ended.err.contains("fault.toml:4:") && ended.err.contains("a velocity is wanted, as 1um/s"),
        "{}",
        ended.err
    );
}
