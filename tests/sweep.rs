//! Maps of regimes: against the bifurcations of `tests/data/`, against orbits and multipliers found otherwise, and against themselves.

use crate::command;
use std::ops::ControlFlow;
use std::sync::atomic::AtomicBool;
use twinslip::equilibrium::{Symmetry, Verdict};
use twinslip::field::State;
use twinslip::friction::{AnyLaw, Parameters};
use twinslip::integrate::{Choice, Integrator, Taylor, Tolerances};
use twinslip::model::{Loading, two_interfaces};
use twinslip::orbit::{InitialGuess, InterfaceSystem, Orbit, OrbitAccuracy, Query, find};
use twinslip::section::Regime;
use twinslip::sweep::{Grid, Range, SweepRow, SweepSettings, Sweeper, UnitShare, run};

fn law() -> AnyLaw {
    AnyLaw::Spinodal(Parameters::heslot_1994().spinodal())
}

fn settings(driving: &str, stiffness: &str, starts: usize) -> SweepSettings {
    SweepSettings {
        grid: Grid::Plane {
            law: law(),
            driving: Range::parse("driving", driving).unwrap(),
            stiffness: Range::parse("stiffness", stiffness).unwrap(),
        },
        starts,
        seed: 7,
        follow: false,
        rtol: 1e-9,
        lyapunov: false,
        diagram: None,
        max_returns: 2000,
        max_steps: 10_000_000,
    }
}

fn rows(settings: &SweepSettings) -> Vec<SweepRow> {
    in_chunks(settings, usize::MAX)
}

fn in_chunks(settings: &SweepSettings, size: usize) -> Vec<SweepRow> {
    let mut sweeper = Sweeper::new(settings).unwrap();
    let (mut rows, mut next) = (Vec::new(), 0);
    while next < settings.units() {
        let end = next.saturating_add(size).min(settings.units());
        sweeper.rows(next..end, &mut rows);
        next = end;
    }
    rows
}

fn over(settings: &SweepSettings, units: UnitShare, threads: usize) -> Vec<SweepRow> {
    let mut all = Vec::new();
    let stop = AtomicBool::new(false);
    let seen = &mut |rows: &[SweepRow]| {
        all.extend_from_slice(rows);
        ControlFlow::Continue(())
    };
    run(settings, units, Some(threads), &stop, seen).unwrap();
    all
}

fn is_small_orbit(row: &SweepRow) -> bool {
    row.regime == Regime::Periodic && row.returns_per_period == Some(1)
}

/// By multiple shooting.
fn orbit(driving: f64, stiffness: f64, symmetry: Symmetry) -> Orbit {
    let slab = InterfaceSystem {
        law: law(),
        interfaces: 2,
        loading: Loading::new(driving, stiffness).unwrap(),
    };
    let query = Query {
        symmetry,
        begin: InitialGuess::Hopf,
    };
    let found = find(&slab, &query, &OrbitAccuracy::of(Choice::Taylor));
    found.unwrap().orbit
}

/// Of `tests/data/`: the values of V_H at K = 0.14.
const PITCHFORK: f64 = 0.049_863_166_268_876_87;
const HOPF: f64 = 0.063_039_679_884_633_17;
const TORUS: f64 = 0.076_739_869_727_358_17;
const TORUS_AGAIN: f64 = 0.100_026_498_087_912_47;

#[test]
fn along_k_014_the_regimes_change_where_the_bifurcations_say() {
    let settings = settings("0.045:0.115:36", "0.14:0.14:1", 1);
    for row in rows(&settings) {
        let v = row.parameters[0];
        let found = (row.regime, row.symmetry);
        if v < PITCHFORK {
            assert_eq!(found, (Regime::Steady, Some(Symmetry::Symmetric)), "{v}");
        } else if v < HOPF {
            assert_eq!(found, (Regime::Steady, Some(Symmetry::Asymmetric)), "{v}");
        } else if !(TORUS - 0.0015..=TORUS_AGAIN + 0.0005).contains(&v) {
            // Closer to the first, large motions coexist.
            assert!(is_small_orbit(&row), "{v}: {row:?}");
            assert_eq!(row.symmetry, Some(Symmetry::Asymmetric), "{v}");
        } else if (TORUS..TORUS_AGAIN - 0.0005).contains(&v) {
            assert!(!is_small_orbit(&row), "{v}: {row:?}");
            assert_ne!(row.regime, Regime::Steady, "{v}");
        }
    }
}

/// Stability by multiple shooting and Floquet multipliers, of which the sweep knows nothing.
#[test]
fn along_k_02_the_torus_is_where_the_orbit_is_unstable() {
    let settings = settings("0.098:0.118:11", "0.2:0.2:1", 1);
    let mut changes = Vec::new();
    let mut before = None;
    for row in rows(&settings) {
        let orbit = orbit(row.parameters[0], row.parameters[1], Symmetry::Asymmetric);
        let stable = orbit.verdict() == Verdict::Stable;
        assert_eq!(is_small_orbit(&row), stable, "{row:?}");
        if stable {
            let period = row.period.unwrap();
            assert!((period / orbit.period.value - 1.0).abs() < 1e-8, "{row:?}");
            let (low, high) = row.range.unwrap();
            assert!((low - orbit.stress_min.value).abs() < 1e-6, "{row:?}");
            assert!((high - orbit.stress_max.value).abs() < 1e-6, "{row:?}");
        }
        if before.is_some_and(|before| before != stable) {
            changes.push(row.parameters[0]);
        }
        before = Some(stable);
    }
    assert_eq!(changes.len(), 2, "a torus between two torus bifurcations");
}

fn at(driving: f64, stiffness: f64, start: usize) -> SweepRow {
    let settings = SweepSettings {
        rtol: 1e-8,
        ..settings(
            &format!("{driving}:{driving}:1"),
            &format!("{stiffness}:{stiffness}:1"),
            2,
        )
    };
    rows(&settings).swap_remove(start)
}

/// With more returns than usual.
fn at_length(driving: f64, stiffness: f64, start: usize) -> SweepRow {
    let settings = SweepSettings {
        rtol: 1e-8,
        max_returns: 4000,
        ..settings(
            &format!("{driving}:{driving}:1"),
            &format!("{stiffness}:{stiffness}:1"),
            2,
        )
    };
    rows(&settings).swap_remove(start)
}

/// Runs that leave an unstable steady state or come to a cycle so slowly that their returns drift all the while. After twice the
/// usual returns those on three points have come to the cycle that multiple shooting finds there; on the last, with a multiplier of
/// exp(-1.6e-4), they may not.
#[test]
fn slow_runs_are_neither_tori_nor_chaos() {
    let mut settled = Vec::new();
    for (driving, stiffness, start) in [
        (0.104_615_384_615_384_61, 0.104_827_586_206_896_56, 1),
        (0.109_230_769_230_769_21, 0.109_655_172_413_793_1, 1),
        (0.115_384_615_384_615_39, 0.114_482_758_620_689_66, 1),
        (0.086_153_846_153_846_15, 0.235_172_413_793_103_44, 0),
        (0.086_153_846_153_846_15, 0.235_172_413_793_103_44, 1),
    ] {
        for row in [
            at(driving, stiffness, start),
            at_length(driving, stiffness, start),
        ] {
            match row.regime {
                Regime::Periodic => {
                    let period = orbit(driving, stiffness, Symmetry::Asymmetric).period.value;
                    let off = row.period.unwrap() / period - 1.0;
                    assert!(off.abs() < 1e-8, "{row:?}: {period}");
                    settled.push(driving);
                }
                Regime::Undecided => {}
                _ => panic!("{row:?}"),
            }
        }
    }
    settled.dedup();
    assert!(settled.len() >= 3, "{settled:?}");
}

/// Canards along which the multipliers of the symmetric cycle become exp(-39): below what rounding leaves of a derivative.
#[test]
fn cycles_that_forget_everything_are_periodic() {
    let (driving, stiffness) = (0.082_448_979_591_836_74, 0.029_387_755_102_040_815);
    let row = at(driving, stiffness, 0);
    let found = (row.regime, row.symmetry, row.returns_per_period);
    let expected = (Regime::Periodic, Some(Symmetry::Symmetric), Some(1));
    assert_eq!(found, expected, "{row:?}");
    let orbit = orbit(driving, stiffness, Symmetry::Symmetric);
    assert!(orbit.floquet.multipliers[0].ln_abs.value < -30.0);
    let off = row.period.unwrap() / orbit.period.value - 1.0;
    assert!(off.abs() < 1e-8, "{off:e}");
    assert!(row.lyapunov_max.is_none(), "{row:?}");
}

/// Runs whose interface that sticks comes to its end over thousands of cycles leap there. Multiple shooting says where that is and
/// how slowly it is come to; the returns of a run that does not leap, followed to the end, say that they come there.
#[test]
fn slow_runs_leap_to_where_they_come_in_the_end() {
    for (driving, stiffness) in [(95.9, 0.2727), (80.0, 0.29), (30.0, 0.1), (12.25, 0.3737)] {
        let row = at(driving, stiffness, 0);
        assert_eq!(row.regime, Regime::Periodic, "{row:?}");
        assert!(row.returns < 400, "{row:?}");
        let orbit = orbit(driving, stiffness, Symmetry::Asymmetric);
        let (period, slowest) = (
            orbit.period.value,
            orbit.floquet.multipliers[0].ln_abs.value,
        );
        let off = row.period.unwrap() / period - 1.0;
        assert!(off.abs() < 3e-7, "{row:?}: {period}");
        let exponent = row.lyapunov_max.unwrap();
        let off = (exponent.value - slowest / period).abs();
        assert!(
            off < exponent.uncertainty,
            "{exponent:?}: {}",
            slowest / period
        );
        // So long that what is left is a part of 1e-5.
        let returns = (11.5 / -slowest) as usize;
        let all = command::object(&format!(
            "section --driving {driving} --stiffness {stiffness} --start {},{},{} --skip {returns} --returns 20 --method taylor",
            row.start[0],
            row.start[1].exp(),
            row.start[2].exp()
        ));
        let time = |n: usize| command::number(&all, &format!("/result/rows/{n}/time"));
        let off = (time(19) - time(18)) / period - 1.0;
        assert!(off.abs() < 1e-6, "{driving} {stiffness}: {off:e}");
    }
}

/// Left of the pitchfork: the section goes through the steady state, which a run comes to along one slow direction and so few steps
/// that its returns repeat themselves before anything else is seen.
#[test]
fn returns_beside_a_steady_state_are_no_orbit() {
    let at_rest = (Regime::Steady, Some(Symmetry::Symmetric));
    for (driving, stiffness) in [
        (0.046_530_612_244_897_96, 0.226_530_612_244_897_96),
        (0.046_5, 0.3),
        (0.046_5, 0.34),
    ] {
        let row = at(driving, stiffness, 0);
        assert_eq!((row.regime, row.symmetry), at_rest, "{row:?}");
    }
    let settings = settings("0.04:0.0495:20", "0.15:0.4:20", 1);
    for row in rows(&SweepSettings {
        rtol: 1e-8,
        ..settings
    }) {
        assert_eq!((row.regime, row.symmetry), at_rest, "{row:?}");
    }
}

/// A run is at rest as soon as a neighbourhood of the steady state holds it. Followed on, it comes there.
#[test]
fn runs_that_are_held_come_to_rest() {
    let mut held = 0;
    for (drivings, stiffnesses) in [
        ("5:100:4", "0.4:1:3"),
        ("0.045:0.062:4", "0.03:0.2:4"),
        // Where cycles coexist with the steady state.
        ("0.0625:0.0640:4", "0.12:0.15:4"),
    ] {
        for row in rows(&settings(drivings, stiffnesses, 2)) {
            // Those let go from where rounding held them start elsewhere.
            if row.regime != Regime::Steady || row.note.is_some() {
                continue;
            }
            held += 1;
            let loading = Loading::new(row.parameters[0], row.parameters[1]).unwrap();
            let field = two_interfaces(law(), loading);
            let slowest = -row.lyapunov_max.unwrap().value;
            assert!(slowest > 0.0, "{row:?}");
            let mut taylor = Taylor::new(Tolerances::equal(1e-10).unwrap(), 10_000_000).unwrap();
            let start = State::<3>::from_column_slice(&row.start);
            let end = taylor
                .flow(&*field, (0.0, 25.0 / slowest), &start, None)
                .unwrap();
            let (tau, _) = row.range.unwrap();
            assert!((end[0] - tau).abs() < 1e-5, "{row:?}: {end}");
        }
    }
    assert!(held > 30, "{held}");
}

/// Along a cycle of stick-slip tangents grow by nine orders and shrink again: what the multipliers of the return map keep of that
/// is compared with those of multiple shooting, which the sweep knows nothing of.
#[test]
fn exponents_are_those_of_the_multipliers() {
    for (driving, stiffness) in [
        (0.158_974, 0.051_724),
        (0.167_179, 0.059_655),
        (0.16, 0.07),
        // The run comes to this one with a step of Newton's method that is large for how the map bends.
        (0.094_868_329_805_051_39, 0.085_714_285_714_285_71),
        (0.168_702_397_557_104_76, 0.118_571_428_571_428_57),
        (0.533_483_823_011_676_9, 0.184_285_714_285_714_3),
        (3.0, 0.25),
    ] {
        let row = at(driving, stiffness, 0);
        let orbit = orbit(driving, stiffness, Symmetry::Asymmetric);
        let period = orbit.period.value;
        let largest = orbit.floquet.multipliers[0].ln_abs.value;
        let found = row.lyapunov_max.expect("an exponent");
        let off = (found.value * period - largest).abs();
        let claimed = found.uncertainty * period;
        println!("{driving} {stiffness}: off by {off:e} of {claimed:e}");
        assert!(off < claimed, "{found:?}: {}", largest / period);
        assert!(claimed < 1e-3, "{found:?}");
    }
}

/// What runs beside a chaotic one tell is what its tangents tell, from five times as many returns.
#[test]
fn chaos_has_the_exponent_of_the_tangents() {
    let row = at(0.094, 0.14, 0);
    assert_eq!(row.regime, Regime::Chaotic, "{row:?}");
    let found = row.lyapunov_max.unwrap();
    let tangents = command::object(
        "section --driving 0.094 --stiffness 0.14 --start near-symmetric:0.01 --skip 1000 --returns 5000 --lyapunov",
    );
    let value = command::number(&tangents, "/result/lyapunov/0/value");
    let uncertainty = command::number(&tangents, "/result/lyapunov/0/uncertainty");
    let off = (found.value - value).abs();
    assert!(
        off < found.uncertainty + uncertainty,
        "{found:?}: {value} +- {uncertainty}"
    );
}

#[test]
fn a_large_motion_coexists_with_the_small_orbit_below_the_torus_bifurcation() {
    let settings = settings("0.0755:0.0758:16", "0.14:0.14:1", 2);
    let rows = rows(&settings);
    let large = |row: &SweepRow| row.range.is_some_and(|(low, _)| low < 8.0);
    let both = |pair: &[SweepRow]| {
        pair.iter().any(|row| is_small_orbit(row) && !large(row)) && pair.iter().any(large)
    };
    assert!(rows.chunks(2).any(both), "{rows:?}");
}

#[test]
fn symmetric_and_asymmetric_orbits_coexist_at_k_01() {
    let rows = rows(&settings("0.2:0.3:3", "0.1:0.1:1", 2));
    for pair in rows.chunks(2) {
        assert_eq!(pair[0].symmetry, Some(Symmetry::Asymmetric));
        assert_eq!(pair[1].symmetry, Some(Symmetry::Symmetric));
    }
    // tests/data/orbits.json: the symmetric orbit at V_H = 0.2.
    let symmetric = &rows[1];
    assert!((symmetric.period.unwrap() / 285.050_555_092_935_55 - 1.0).abs() < 1e-9);
    let mu = (symmetric.lyapunov_max.unwrap().value * symmetric.period.unwrap()).exp();
    assert!((mu - 0.032_948_715_082_417_63).abs() < 1e-5, "{mu}");
}

/// From states in the midst of a slip the interfaces find together; from larger ones they don't, but for equal ones.
#[test]
fn a_basin_has_both_attractors() {
    const SIDE: usize = 9;
    let states = Range::parse("state-1", "1e-6:1:9log").unwrap();
    let loading = Loading::new(2.0, 0.1).unwrap();
    let settings = SweepSettings {
        grid: Grid::Basin {
            law: law(),
            loading,
            state_1: states,
            state_2: states,
        },
        ..settings("1:2:2", "1:2:2", 1)
    };
    let rows = rows(&settings);
    for symmetry in [Symmetry::Symmetric, Symmetry::Asymmetric] {
        let all: Vec<&SweepRow> = rows
            .iter()
            .filter(|row| row.symmetry == Some(symmetry))
            .collect();
        let unequal = all.iter().filter(|row| row.start[1] != row.start[2]);
        assert!(unequal.count() >= 6, "{symmetry:?}");
        let period = orbit(2.0, 0.1, symmetry).period.value;
        for row in all {
            assert_eq!(row.regime, Regime::Periodic);
            let off = row.period.unwrap() / period - 1.0;
            assert!(off.abs() < 1e-8, "{row:?}: {period}");
        }
    }
    for i in 0..SIDE {
        for j in 0..i {
            let mirrored = [rows[i * SIDE + j].symmetry, rows[j * SIDE + i].symmetry];
            assert_eq!(mirrored[0], mirrored[1], "{i} {j}");
        }
    }
}

#[test]
fn rows_depend_on_their_numbers_alone() {
    let plane = settings("0.05:0.13:4", "0.1:0.2:2", 3);
    let all = rows(&plane);
    assert_eq!(all.len(), plane.points());
    assert!(all.iter().enumerate().all(|(k, row)| row.number == k));
    assert_eq!(in_chunks(&plane, 1), all);
    assert_eq!(in_chunks(&plane, 7), all);
    for threads in [1, 2, 3] {
        assert_eq!(over(&plane, UnitShare::from(0), threads), all);
    }
    assert_eq!(over(&plane, UnitShare::from(8), 2), all[8..]);
    for shard in 1..=3 {
        let of_shard: Vec<SweepRow> = all.iter().skip(shard - 1).step_by(3).cloned().collect();
        assert_eq!(over(&plane, UnitShare::shard(shard, 3, 0), 2), of_shard);
        assert_eq!(
            over(&plane, UnitShare::shard(shard, 3, 4), 2),
            of_shard[4..]
        );
    }
}

#[test]
fn lines_that_follow_depend_on_themselves_alone() {
    let plane = SweepSettings {
        follow: true,
        ..settings("0.045:0.09:10", "0.1:0.2:4", 2)
    };
    assert_eq!(plane.units(), 4);
    let all = rows(&plane);
    assert!(all.iter().enumerate().all(|(k, row)| row.number == k));
    assert_eq!(in_chunks(&plane, 1), all);
    assert_eq!(over(&plane, UnitShare::from(0), 2), all);
    assert_eq!(over(&plane, UnitShare::from(1), 2), all[20..]);
}

#[test]
fn lanes_find_what_single_runs_find() {
    let plane = settings("0.05:0.2:7", "0.08:0.25:5", 1);
    let mut alone = Vec::new();
    let mut sweeper = Sweeper::one_by_one(&plane).unwrap();
    sweeper.rows(0..plane.units(), &mut alone);
    let (mut compared, mut of_one_cycle) = (0, 0);
    for (row, alone) in rows(&plane).iter().zip(&alone) {
        if matches!(row.regime, Regime::Steady | Regime::Periodic) {
            compared += 1;
            of_one_cycle += usize::from(row.returns_per_period == alone.returns_per_period);
            assert_eq!((row.regime, row.symmetry), (alone.regime, alone.symmetry));
            if row.returns_per_period == alone.returns_per_period {
                let near = |x: f64, y: f64| (x - y).abs() < 1e-7 * x.abs();
                assert!(
                    row.period
                        .iter()
                        .zip(&alone.period)
                        .all(|(x, y)| near(*x, *y))
                );
            }
        }
    }
    // Of 35 points: one has no verdict, and where cycles coexist rounding may choose.
    assert!(compared >= 32, "{compared}");
    assert!(of_one_cycle >= 30, "{of_one_cycle}");
}

#[test]
fn seeds_reproduce() {
    let plane = settings("0.06:0.1:3", "0.14:0.14:1", 5);
    let other = SweepSettings {
        seed: 8,
        ..plane.clone()
    };
    let starts = |settings: &SweepSettings| -> Vec<Vec<f64>> {
        rows(settings).iter().map(|row| row.start.clone()).collect()
    };
    let (first, again, other) = (starts(&plane), starts(&plane), starts(&other));
    assert_eq!(first, again);
    for (k, (a, b)) in first.iter().zip(&other).enumerate() {
        // The first three starts are no matter of chance.
        assert_eq!(a == b, k % 5 < 3, "{k}");
    }
}

#[test]
fn a_point_that_fails_is_a_row() {
    let plane = SweepSettings {
        max_steps: 100,
        ..settings("0.1:0.2:3", "0.14:0.14:1", 1)
    };
    let rows = rows(&plane);
    assert_eq!(rows.len(), 3);
    for row in &rows {
        assert_eq!(row.regime, Regime::Undecided);
        let note = row.note.as_ref().expect("a reason");
        assert!(note.contains("`max_steps`"), "{note}");
    }
}

#[test]
fn ranges_refuse_nonsense() {
    for text in [
        "",
        "1",
        "1:2",
        "1:2:3:4",
        "a:2:3",
        "1:b:3",
        "1:2:c",
        "1:2:3lg",
        "1:2:-3",
        "1:2:0",
        "2:1:3",
        "0:1:3",
        "-1:1:3",
        "1:inf:3",
        "nan:1:3",
        "1:2:1",
        "1:1:2",
        "1:2:99999999999",
    ] {
        let error = Range::parse("driving", text).unwrap_err();
        assert!(error.is_input(), "{text}");
        assert!(error.to_string().contains("driving"), "{text}: {error}");
    }
    let range = Range::parse("driving", "0.1:0.3:7").unwrap();
    assert_eq!((range.value(0), range.value(6)), (0.1, 0.3));
    assert_eq!(Range::parse("driving", &range.text()).unwrap(), range);
    // the ratio of both ends is no double
    let wide = Range::parse("driving", "1e-300:1e300:7log").unwrap();
    for (value, exponent) in wide.values().zip([-300, -200, -100, 0, 100, 200, 300]) {
        assert!(
            (value.log10() - f64::from(exponent)).abs() < 1e-12,
            "{value:e}"
        );
    }
    let log = Range::parse("driving", " 1e-3 : 10 : 5log").unwrap();
    assert!((log.value(2) - 0.1).abs() < 1e-16);
    assert_eq!(Range::parse("driving", &log.text()).unwrap(), log);
}

#[test]
fn settings_refuse_nonsense() {
    let good = settings("0.1:0.2:2", "0.1:0.2:2", 1);
    assert!(good.checked().is_ok());
    let states = Range::parse("state-1", "0.1:1:2").unwrap();
    let basin = Grid::Basin {
        law: law(),
        loading: Loading::new(0.2, 0.1).unwrap(),
        state_1: states,
        state_2: states,
    };
    for bad in [
        SweepSettings {
            starts: 0,
            ..good.clone()
        },
        SweepSettings {
            max_returns: 10,
            ..good.clone()
        },
        SweepSettings {
            max_steps: 0,
            ..good.clone()
        },
        SweepSettings {
            rtol: 0.0,
            ..good.clone()
        },
        SweepSettings {
            grid: basin.clone(),
            follow: true,
            ..good.clone()
        },
        SweepSettings {
            grid: basin,
            starts: 2,
            ..good.clone()
        },
    ] {
        assert!(bad.checked().unwrap_err().is_input(), "{bad:?}");
    }
}
