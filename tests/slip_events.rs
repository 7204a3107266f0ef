//! Slip events of many interfaces: against crossings found otherwise, a single interface, sums, and themselves on other cores.

use crate::command::{csv, folder, number, object, refused, refused_in_one_line, twinslip};
use proptest::prelude::*;
use serde_json::Value;
use std::path::Path;
use twinslip::friction::{AnyLaw, Parameters};
use twinslip::many::{ManyEvent, ManyInterfaces, ManyStep, ManyTaylor, OneOfMany, SlipEvents};
use twinslip::model::Loading;

#[track_caller]
fn close(made: f64, known: f64, tolerance: f64) {
    let off = (made / known - 1.0).abs();
    assert!(off <= tolerance, "{made} for {known}: {off:e}");
}

fn law(residual_strength: f64) -> AnyLaw {
    let parameters = Parameters::new(0.0349, 0.0489, 0.369, 100.0, residual_strength);
    AnyLaw::Spinodal(parameters.expect("parameters").spinodal())
}

/// A time in which an interface is above the threshold: from where to where, and its slip.
struct Stretch {
    interface: usize,
    from: f64,
    to: Option<f64>,
    slip: f64,
}

/// Looks at the rates themselves, at many times of each step, and halves where the side changes.
struct Brute {
    threshold: f64,
    /// Of each, the stretch that has not ended.
    open: Vec<Option<Stretch>>,
    done: Vec<Stretch>,
    begun: bool,
    /// Times, stresses and total rates.
    seen: Vec<[f64; 3]>,
    total: f64,
}

impl Brute {
    fn new(count: usize, threshold: f64) -> Self {
        Brute {
            threshold,
            open: (0..count).map(|_| None).collect(),
            done: Vec::new(),
            begun: false,
            seen: Vec::new(),
            total: 0.0,
        }
    }

    fn see(&mut self, step: &dyn ManyStep) {
        const PARTS: usize = 16;
        let begins = !std::mem::replace(&mut self.begun, true);
        let (begin, end) = (step.begin(), step.end());
        let time = |part: usize| match part {
            PARTS => end,
            part => begin + (end - begin) * part as f64 / PARTS as f64,
        };
        for interface in 0..self.open.len() {
            let above = |t: f64| step.interface(interface, t)[1] > self.threshold;
            let slip = |from: f64, to: f64| step.slip(interface, to) - step.slip(interface, from);
            if begins && above(begin) {
                self.open[interface] = Some(Stretch {
                    interface,
                    from: f64::NEG_INFINITY,
                    to: None,
                    slip: 0.0,
                });
            }
            let mut since = begin;
            for part in 1..=PARTS {
                let was = self.open[interface].is_some();
                if above(time(part)) == was {
                    continue;
                }
                let (mut a, mut b) = (time(part - 1), time(part));
                for _ in 0..80 {
                    let middle = 0.5 * (a + b);
                    if above(middle) == was {
                        a = middle;
                    } else {
                        b = middle;
                    }
                }
                match self.open[interface].take() {
                    Some(open) => self.done.push(Stretch {
                        to: Some(b),
                        slip: open.slip + slip(since, b),
                        ..open
                    }),
                    None => {
                        since = b;
                        self.open[interface] = Some(Stretch {
                            interface,
                            from: b,
                            to: None,
                            slip: 0.0,
                        });
                    }
                }
            }
            if let Some(open) = &mut self.open[interface] {
                open.slip += slip(since, end);
            }
        }
        for part in 0..=PARTS {
            let at = time(part);
            let total = step.extent(at, self.threshold).slip_rate;
            self.seen.push([at, step.stress(at), total]);
        }
        self.total += step.slip_of_all(end);
    }

    /// The stretches of each event that begins and ends within the run.
    fn events(self) -> Vec<Vec<Stretch>> {
        let mut all = self.done;
        all.extend(self.open.into_iter().flatten());
        all.sort_by(|a, b| {
            a.from
                .total_cmp(&b.from)
                .then(a.interface.cmp(&b.interface))
        });
        let end = |stretch: &Stretch| stretch.to.unwrap_or(f64::INFINITY);
        let (mut events, mut reached) = (Vec::<Vec<Stretch>>::new(), f64::NEG_INFINITY);
        for stretch in all {
            if events.is_empty() || stretch.from > reached {
                events.push(Vec::new());
            }
            reached = reached.max(end(&stretch));
            events.last_mut().expect("one").push(stretch);
        }
        let whole = |event: &Vec<Stretch>| {
            event[0].from > f64::NEG_INFINITY && event.iter().all(|one| one.to.is_some())
        };
        events.into_iter().filter(whole).collect()
    }
}

/// A run of interfaces that differ, from states that do: its events, and what brute force finds.
fn both(
    count: usize,
    (driving, stiffness): (f64, f64),
    threshold: f64,
    spread: f64,
    until: f64,
) -> (Vec<ManyEvent>, Vec<f64>, Brute) {
    let part = |i: usize, by: usize| (i * by % count) as f64 / count as f64 - 0.5;
    let laws: Vec<OneOfMany> = (0..count)
        .map(|i| OneOfMany {
            slip_length: 1.0 + spread * part(i, 3),
            ..law(1e-3 * (1.0 + spread * part(i, 7))).into()
        })
        .collect();
    let loading = Loading::new(driving, stiffness).expect("positive");
    let interfaces = ManyInterfaces::new(&laws, loading).expect("laws that age");
    let states: Vec<f64> = (0..count)
        .map(|i| 0.05 * (1.0 + spread * part(i, 11)))
        .collect();
    let events = SlipEvents::new(&interfaces, threshold).expect("positive");
    let mut events = events.with_participation(&interfaces);
    let mut brute = Brute::new(count, threshold);
    let taylor = ManyTaylor::new(1e-12, 100_000).expect("a tolerance");
    let start = (9.8, states.as_slice());
    let end = taylor.flow(&interfaces, start, until, &mut |step| {
        events.see(&step.series().expect("Taylor's steps are series"));
        brute.see(step);
        Ok(true)
    });
    end.expect("a flow");
    let (events, participation) = events.into_parts();
    let participation = participation.expect("asked for");
    let slips = participation.iter().map(|one| one.slip).collect();
    let times: usize = participation.iter().map(|one| one.events).sum();
    let participants: usize = events.iter().map(|event| event.participants).sum();
    assert_eq!(times, participants);
    (events, slips, brute)
}

/// What both have found is the same; how many events there are and how many slip in the largest.
fn compared(found: (Vec<ManyEvent>, Vec<f64>, Brute)) -> (usize, usize) {
    const TIGHT: f64 = 1e-8;
    let (made, slips, brute) = found;
    let seen = brute.seen.clone();
    let total = brute.total;
    let known = brute.events();
    assert_eq!(made.len(), known.len());
    let (mut each, mut onset_before) = (vec![0.0; slips.len()], None);
    for (made, known) in made.iter().zip(&known) {
        let onset = known[0].from;
        let ends = known.iter().filter_map(|one| one.to);
        let end = ends.fold(f64::NEG_INFINITY, f64::max);
        close(made.onset, onset, TIGHT);
        assert!((made.duration - (end - onset)).abs() < TIGHT * end);
        match onset_before.replace(onset) {
            None => assert_eq!(made.recurrence, None),
            Some(before) => {
                let recurrence = made.recurrence.expect("one before");
                assert!((recurrence - (onset - before)).abs() < TIGHT * onset);
            }
        }
        assert_eq!(made.first, known[0].interface);
        let mut own = vec![0.0; slips.len()];
        for stretch in known {
            own[stretch.interface] += stretch.slip;
            each[stretch.interface] += stretch.slip;
        }
        let participants = own.iter().filter(|slip| **slip != 0.0).count();
        assert_eq!(made.participants, participants);
        close(made.slip, own.iter().sum(), TIGHT);
        let most = own.iter().copied().fold(0.0, f64::max);
        close(own[made.leader], most, TIGHT);
        // Between the times that are looked at the rate may be larger, by little.
        let during = seen.iter().filter(|[t, ..]| (onset..=end).contains(t));
        let peak = during.map(|[.., rate]| *rate).fold(0.0, f64::max);
        assert!(made.peak_slip_rate >= peak * (1.0 - TIGHT));
        assert!(
            made.peak_slip_rate <= peak * 1.02,
            "{} {peak}",
            made.peak_slip_rate
        );
        // The stress at both ends lies between those at the times around.
        for (at, stress) in [
            (onset, made.stress_before),
            (end, made.stress_before - made.stress_drop),
        ] {
            // With one more on each side: between two that are alike it may turn.
            let i = seen.partition_point(|[t, ..]| *t < at).max(2);
            let around = seen[i - 2..seen.len().min(i + 2)].iter();
            let ends =
                |(low, high): (f64, f64), one: &[f64; 3]| (low.min(one[1]), high.max(one[1]));
            let (low, high) = around.fold((f64::INFINITY, f64::NEG_INFINITY), ends);
            let slack = (high - low) + TIGHT;
            assert!(stress > low - slack && stress < high + slack);
        }
    }
    for (made, known) in slips.iter().zip(&each) {
        assert!((made - known).abs() <= TIGHT * known, "{made} for {known}");
    }
    assert!(slips.iter().sum::<f64>() <= total);
    let most = made.iter().map(|event| event.participants).max();
    (made.len(), most.unwrap_or(0))
}

#[test]
fn crossings_are_those_of_brute_force() {
    // One alone slips, or several at once, or some begin while others do: by a low threshold, and where they hardly differ.
    for (count, loading, threshold, spread, until, least) in [
        (20, (20.0, 0.05), 10.0, 0.2, 60.0, (10, 1)),
        (20, (20.0, 0.05), 1.5, 0.2, 60.0, (1, 2)),
        (20, (60.0, 0.005), 30.0, 1e-4, 120.0, (5, 2)),
        (13, (40.0, 0.02), 1000.0, 0.01, 30.0, (5, 1)),
    ] {
        let (events, participants) = compared(both(count, loading, threshold, spread, until));
        println!("{count} {threshold}: {events} events, at most {participants} of them");
        assert!(events >= least.0 && participants >= least.1);
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 12, ..ProptestConfig::default() })]

    #[test]
    fn at_any_threshold(
        count in 1_usize..24,
        mean in 0.5_f64..4.0,
        whole in 0.1_f64..2.0,
        threshold in 0.0_f64..8.0,
        spread in 1e-4_f64..0.5,
    ) {
        let n = count as f64;
        let until = 30.0 / (mean * whole);
        compared(both(count, (n * mean, whole / n), mean * threshold.exp(), spread, until));
    }
}

/// Where the stress turns between two times that are looked at, just as an event begins.
#[test]
fn at_a_turn_of_the_stress() {
    let loading = (9.0 * 0.5, 0.7805462288105104 / 9.0);
    let threshold = 0.5 * 2.190933995897216_f64.exp();
    let until = 30.0 / (0.5 * 0.7805462288105104);
    let (events, _) = compared(both(9, loading, threshold, 0.2806865252429651, until));
    assert!(events > 0);
}

/// All alike are one alone at V_H/N and N K, integrated by the engine of few.
#[test]
fn eight_in_phase_are_one() {
    const THRESHOLD: f64 = 30.0;
    let eight = object(&format!(
        "integrate --interfaces 8 --driving 24 --stiffness 0.025 --start 9.8,{} --until 40 --final-only --rtol 1e-14 --events --event-threshold 10 --participation",
        ["0.01"; 8].join(",")
    ));
    let alone = |until: f64| {
        object(&format!(
            "integrate --interfaces 1 --driving 3 --stiffness 0.2 --start 9.8,0.01 --until {until:?} --final-only --rtol 1e-14 --method taylor"
        ))
    };
    let events = eight["result"]["events"].as_array().expect("a list");
    assert_eq!(events.len(), 5);
    // As many as the engine of few finds, which has the same peaks, but other ends: where the stress turns.
    let few = object(
        "integrate --interfaces 1 --driving 3 --stiffness 0.2 --start 9.8,0.01 --until 40 --final-only --rtol 1e-14 --method taylor --events",
    );
    let few = few["result"]["events"].as_array().expect("a list");
    assert_eq!(few.len(), 5);
    for (event, known) in events.iter().zip(few) {
        let of = |name: &str| number(event, &format!("/{name}"));
        close(
            of("peak_slip_rate") / 8.0,
            number(known, "/peak_slip_rate"),
            1e-8,
        );
        let onset = of("onset");
        let ends = [onset, onset + of("duration")].map(alone);
        let [begin, end] = &ends;
        let at = |one: &Value, name: &str| number(one, &format!("/result/final/{name}"));
        close(at(begin, "slip_rate_1"), THRESHOLD, 1e-8);
        close(at(end, "slip_rate_1"), THRESHOLD, 1e-8);
        close(of("stress_before"), at(begin, "stress"), 1e-10);
        close(
            of("stress_drop"),
            at(begin, "stress") - at(end, "stress"),
            1e-8,
        );
        let slip = at(end, "slip_1") - at(begin, "slip_1");
        close(of("slip_mean"), slip, 1e-8);
        close(of("slip"), 8.0 * slip, 1e-8);
        close(of("magnitude"), (8.0 * slip).log10(), 1e-8);
        // dtau/dt = K (V_H - v_1 - ...)
        close(
            of("stress_drop"),
            0.025 * (of("slip") - 24.0 * of("duration")),
            1e-8,
        );
        assert_eq!(event["participants"], 8);
        assert_eq!(of("participation"), 1.0);
        assert_eq!((&event["leader"], &event["first"]), (&1.into(), &1.into()));
    }
    assert!(events[0]["recurrence"].is_null());
    close(
        number(&events[2], "/recurrence"),
        number(&events[2], "/onset") - number(&events[1], "/onset"),
        1e-12,
    );
    let each = eight["result"]["participation"].as_array().expect("a list");
    assert_eq!(each.len(), 8);
    let slips: f64 = events.iter().map(|event| number(event, "/slip_mean")).sum();
    for (i, one) in each.iter().enumerate() {
        assert_eq!(
            (&one["interface"], &one["events"]),
            (&(i + 1).into(), &5.into())
        );
        close(number(one, "/slip"), slips, 1e-12);
    }
}

/// From three interfaces on, with and without constants drawn; these stand in the table of participation.
#[test]
fn columns_and_files() {
    let at = folder("slip-events-files");
    let file = |name: &str| at.join(name).display().to_string();
    let read = |name: &str| std::fs::read_to_string(at.join(name)).expect("a file");
    let run = "integrate --interfaces 3 --driving 10 --stiffness 0.05 --start spread:1 --until 20 --points 3 --events --participation";
    let made = twinslip(&format!(
        "{run} --draw slip_length=0.9:1.1,residual_strength=9e-4:1.1e-3 -o {} --plot-events {}",
        file("run.csv"),
        file("events.svg")
    ));
    assert_eq!(made.code, 0, "{}", made.err);
    let events = csv(&read("run.events.csv"));
    assert_eq!(
        events[0].join(","),
        "onset,recurrence,duration,stress_before,stress_drop,peak_slip_rate,participants,participation,slip,slip_mean,magnitude,leader,first"
    );
    assert!(events.len() > 3, "{events:?}");
    let each = csv(&read("run.participation.csv"));
    assert_eq!(
        each[0].join(","),
        "interface,events,slip,slip_length,residual_strength"
    );
    assert_eq!(each.len(), 4);
    let number = |text: &String| text.parse::<f64>().expect("a number");
    for row in &each[1..] {
        assert!((0.9..=1.1).contains(&number(&row[3])));
        assert!((9e-4..=1.1e-3).contains(&number(&row[4])));
    }
    let slip = |rows: &[Vec<String>], column: usize| {
        rows[1..]
            .iter()
            .map(|row| number(&row[column]))
            .sum::<f64>()
    };
    close(slip(&each, 2), slip(&events, 8), 1e-12);
    assert!(read("events.svg").starts_with("<svg"));
    let plain = object(run);
    let first = &plain["result"]["participation"][0];
    let names: Vec<&String> = first.as_object().expect("an object").keys().collect();
    assert_eq!(names, ["interface", "events", "slip"]);
    let without = object(&run.replace(" --events --participation", ""));
    assert!(without["result"].get("events").is_none());
    assert!(without["result"].get("participation").is_none());
}

/// An event that the run begins or ends in is none; that of the end is told, and what failed keeps what there was.
#[test]
fn events_without_both_ends_are_none() {
    let run = |start: &str, more: &str| {
        let each = [start.split_once(',').expect("two").1; 8].join(",");
        let tau = start.split_once(',').expect("two").0;
        twinslip(&format!(
            "integrate --interfaces 8 --driving 24 --stiffness 0.025 --start {tau},{each} --final-only --events --format json {more}"
        ))
    };
    let count = |out: &str| {
        let object: Value = serde_json::from_str(out).expect("JSON");
        object["result"]["events"].as_array().expect("a list").len()
    };
    // Begins at a slip rate above the threshold.
    let begun = run("11,1e-3", "--until 5");
    assert_eq!(begun.code, 0, "{}", begun.err);
    assert_eq!(count(&begun.out), 0, "{}", begun.out);
    assert!(begun.err.contains("0 events") && !begun.err.contains("under way"));
    let at = object(&format!(
        "integrate --interfaces 8 --driving 24 --stiffness 0.025 --start 9.8,{} --until 20 --final-only --events",
        ["0.01"; 8].join(",")
    ));
    let event = &at["result"]["events"][0];
    let middle = number(event, "/onset") + 0.5 * number(event, "/duration");
    let ended = run("9.8,0.01", &format!("--until {middle}"));
    assert_eq!((ended.code, count(&ended.out)), (0, 0));
    assert!(
        ended.err.contains("0 events and one under way since t = ")
            && ended.err.contains("with 8 participants"),
        "{}",
        ended.err
    );
    let failed = run("9.8,0.01", "--until 40 --max-steps 250");
    assert_eq!(failed.code, 1, "{}", failed.err);
    let kept = count(&failed.out);
    assert!((1..4).contains(&kept), "{kept}");
}

fn table(path: &Path) -> Vec<Vec<String>> {
    csv(&std::fs::read_to_string(path).expect("a file"))
}

#[test]
fn no_digit_depends_on_vectors_and_cores() {
    let at = folder("slip-events-cores");
    let run = |cores: &str, vectors: &str| {
        let (events, each) = (at.join("events.csv"), at.join("each.csv"));
        let ended = crate::command::program()
            .args("integrate --interfaces 8201 --driving 8200 --stiffness 1.2e-4 --start spread:1 --until 1 --points 2 --rtol 1e-4 --draw residual_strength=8e-4:1.2e-3 -q --force --format csv".split(' '))
            .arg("--events")
            .arg(&events)
            .arg("--participation")
            .arg(&each)
            .env("RAYON_NUM_THREADS", cores)
            .env("TWINSLIP_VECTORS", vectors)
            .output()
            .expect("the program starts");
        assert!(
            ended.status.success(),
            "{}",
            String::from_utf8_lossy(&ended.stderr)
        );
        (table(&events), table(&each))
    };
    let known = run("1", "none");
    assert!(known.0.len() > 1, "no event");
    assert_eq!(known.1.len(), 8202);
    for (cores, vectors) in [("2", "none"), ("1", "avx2"), ("2", "avx512")] {
        assert_eq!(run(cores, vectors), known, "{cores} cores, {vectors}");
    }
}

#[test]
fn scenes_have_all_of_it() {
    let at = folder("slip-events-scene");
    let scene = at.join("many.toml");
    std::fs::write(
        &scene,
        "command = \"integrate\"\ninterfaces = 9\ndriving = 30\nstiffness = 0.02\nstart = \"spread:1\"\nuntil = 15\npoints = 2\n\
         draw = [\"slip_length=0.9:1.1\"]\nseed = 3\nevents = true\nevent-threshold = 5\nparticipation = true\nformat = \"json\"\nquiet = true\n",
    )
    .expect("a file");
    let by_scene = twinslip(&format!("run {}", scene.display()));
    assert_eq!(by_scene.code, 0, "{}", by_scene.err);
    let by_scene: Value = serde_json::from_str(&by_scene.out).expect("JSON");
    let by_flags = object(
        "integrate --interfaces 9 --driving 30 --stiffness 0.02 --start spread:1 --until 15 --points 2 --draw slip_length=0.9:1.1 --seed 3 --events \
         --event-threshold 5 --participation",
    );
    assert!(
        by_flags["result"]["events"]
            .as_array()
            .is_some_and(|all| !all.is_empty())
    );
    assert_eq!(by_scene["result"], by_flags["result"]);
    let other = object(
        "integrate --interfaces 9 --driving 30 --stiffness 0.02 --start spread:1 --until 15 --points 2 --draw slip_length=0.9:1.1 --seed 4 --events \
         --event-threshold 5 --participation",
    );
    assert_ne!(other["result"]["events"], by_flags["result"]["events"]);
    let told = twinslip(&format!("run {} --explain", scene.display()));
    assert!(
        told.err.contains("any interface faster than 5 V_H/N"),
        "{}",
        told.err
    );
}

#[test]
fn bad_catalogues_are_refused() {
    let run = "integrate --driving 10 --stiffness 0.1 --until 1";
    for (what, sentence) in [
        (
            "--interfaces 9 --events --event-threshold 0.5 --format json",
            "event-threshold",
        ),
        (
            "--interfaces 9 --events --format csv",
            "--events needs a separate file",
        ),
        (
            "--interfaces 9 --events e.csv --participation --format csv",
            "--participation needs a separate file",
        ),
        (
            "--interfaces 9 --events --participation p.csv --format json",
            "a JSON object holds its participation itself",
        ),
        (
            "--interfaces 9 --events --plot-events e.gif --format json",
            "e.gif",
        ),
        (
            "--events --participation --format json",
            "participation is for the events of three or more interfaces",
        ),
        (
            "--interfaces 1 --events --plot-events e.svg --format json",
            "plot-events is for the events of three or more interfaces",
        ),
        ("--clusters 3,4 --events --format json", "stick-slip events"),
    ] {
        refused_in_one_line(&format!("{run} {what}"), sentence);
    }
    refused(&format!("{run} --interfaces 9 --participation"), "--events");
    refused(
        &format!("{run} --interfaces 9 --plot-events e.svg"),
        "--events",
    );
}
