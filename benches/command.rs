//! The command as a whole process: how soon the first row is there, what a long run costs beside the library's, and how long curves and
//! the paper take.
//!
//! `first-row/...`: from the start of the process to the end of its first row of numbers. `final-only/...`: one run of 64,000 time units,
//! by the command, which counts slips, and by the library. `whole/...`: with all cores.
#![allow(missing_docs)]

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use std::io::{BufRead, BufReader};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};
use twinslip::field::State;
use twinslip::friction::Parameters;
use twinslip::integrate::{Integrator, Taylor, Tolerances};
use twinslip::model::{Loading, TwoInterfaces};

fn begin(arguments: &str) -> Child {
    let mut command = Command::new(env!("CARGO_BIN_EXE_twinslip"));
    command.args(arguments.split_whitespace());
    command.stdout(Stdio::piped()).stderr(Stdio::null());
    command.spawn().expect("the command")
}

fn first_row(arguments: &str) -> Duration {
    let begun = Instant::now();
    let mut child = begin(arguments);
    let lines = BufReader::new(child.stdout.take().expect("a pipe")).lines();
    let lines = lines.map(|line| line.expect("text"));
    // Below remarks and the names of columns.
    let row = lines.filter(|line| !line.starts_with('#')).nth(1);
    let time = begun.elapsed();
    assert!(row.is_some(), "{arguments}");
    child.kill().expect("it runs, or has ended");
    child.wait().expect("it ends");
    time
}

fn first_rows(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("first-row");
    group
        .sample_size(10)
        .measurement_time(Duration::from_secs(2));
    for (name, arguments) in [
        ("law", "law"),
        (
            "integrate",
            "integrate --driving 10 --stiffness 0.14 --until 64",
        ),
        ("equilibria", "equilibria --driving 1 --stiffness 0.14"),
        ("orbit", "orbit --driving 10 --stiffness 0.14"),
        (
            "section",
            "section --driving 0.102 --stiffness 0.2 --skip 0",
        ),
        ("branch-equilibria", "branch equilibria --stiffness 0.14"),
        ("branch-orbits", "branch orbits --stiffness 0.14"),
        ("locus-hopf", "locus hopf"),
        ("locus-torus", "locus torus"),
        (
            "sweep",
            "sweep --driving 0.04:0.2:200 --stiffness 0.02:0.25:200",
        ),
    ] {
        let arguments = format!("{arguments} --format csv -q");
        group.bench_function(name, |bencher| {
            bencher.iter_custom(|times| (0..times).map(|_| first_row(&arguments)).sum());
        });
    }
    group.finish();
}

fn whole(arguments: &str) {
    let ended = begin(arguments).wait_with_output().expect("it ends");
    assert!(ended.status.success(), "{arguments}");
}

fn final_only(criterion: &mut Criterion) {
    const UNTIL: f64 = 64_000.0;
    let mut group = criterion.benchmark_group("final-only");
    group
        .sample_size(10)
        .measurement_time(Duration::from_secs(5))
        .throughput(Throughput::Elements(890_284));
    let command = format!(
        "integrate --driving 10 --stiffness 0.14 --until {UNTIL} --final-only --method taylor --rtol 1e-9 --atol 1e-9 --start 10,0.9,1e-3 -q"
    );
    group.bench_function("command", |bencher| bencher.iter(|| whole(&command)));
    let law = Parameters::heslot_1994().spinodal();
    let loading = Loading::new(10.0, 0.14).expect("positive");
    let field = TwoInterfaces { law, loading };
    let tolerances = Tolerances::equal(1e-9).expect("positive");
    let mut taylor = Taylor::new(tolerances, 10_000_000).expect("steps");
    let start = State::<3>::new(10.0, 0.9_f64.ln(), 1e-3_f64.ln());
    group.bench_function("library", |bencher| {
        bencher.iter(|| {
            taylor
                .flow(&field, (0.0, UNTIL), &start, None)
                .expect("a run")
        });
    });
    group.finish();
}

fn processes(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("whole");
    group
        .sample_size(10)
        .measurement_time(Duration::from_secs(10));
    for kind in [
        "torus",
        "period-doubling",
        "orbit-pitchfork",
        "orbit-saddle-node",
    ] {
        let command = format!("locus {kind} -q");
        group.bench_function(format!("locus-{kind}"), |bencher| {
            bencher.iter(|| whole(&command))
        });
    }
    let out = concat!(env!("CARGO_TARGET_TMPDIR"), "/bench-reproduce");
    let command = format!("reproduce --out {out} --force -q");
    group.bench_function("reproduce", |bencher| bencher.iter(|| whole(&command)));
    group.finish();
}

criterion_group!(benches, first_rows, final_only, processes);
criterion_main!(benches);
