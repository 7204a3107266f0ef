//! One group: some methods at some tolerances on one problem, timed by criterion, with a row of results for each.

use crate::common::reach::median;
use crate::common::results::{OK, Row, rounded};
use criterion::{BenchmarkId, Criterion, SamplingMode};
use rustix::time::{ClockId, clock_gettime};
use std::hint::black_box;
use std::time::Duration;
use twinslip::integrate::{Choice, Integrator, Tolerances};

/// A run that takes longer is not repeated, nor are tighter tolerances of the same method tried.
const LIMIT: Duration = Duration::from_millis(300);
/// A run with more steps is too long as well.
const MAX_STEPS: usize = 3_000_000;
/// criterion's samples.
const SAMPLES: usize = 10;

/// CPU time of this thread: a busy machine disturbs it less than the clock on the wall.
fn cpu_time() -> Duration {
    let now = clock_gettime(ClockId::ThreadCPUTime);
    Duration::new(
        now.tv_sec.try_into().expect("positive"),
        now.tv_nsec.try_into().expect("positive"),
    )
}

fn timed<A>(run: impl FnOnce() -> A) -> (A, Duration) {
    let begin = cpu_time();
    let answer = run();
    (answer, cpu_time() - begin)
}

/// What is timed, and how an answer is judged.
pub struct Task<'a, A> {
    /// The scene's name in the results.
    pub scene: &'a str,
    /// Loose to tight.
    pub tolerances: &'a [f64],
    pub run: &'a dyn Fn(&mut dyn Integrator<3>) -> twinslip::Result<A>,
    pub error: &'a dyn Fn(&A) -> f64,
}

/// Times every method at every tolerance, and gives a row for each that ran, failed or was skipped.
pub fn group<A>(
    criterion: &mut Criterion,
    name: &str,
    methods: &[(String, Choice)],
    task: &Task<'_, A>,
) -> Vec<Row> {
    let mut group = criterion.benchmark_group(format!("{name}/{}", task.scene));
    group
        .sample_size(SAMPLES)
        .sampling_mode(SamplingMode::Flat)
        .nresamples(1000)
        .warm_up_time(Duration::from_millis(100))
        .measurement_time(LIMIT);
    let mut rows = Vec::new();
    for (method, choice) in methods {
        let mut slow: Option<String> = None;
        let (before, mut left_out) = (rows.len(), false);
        for &tolerance in task.tolerances {
            let without = |status: String| {
                println!("{name}/{}/{method}/{tolerance:.0e}: {status}", task.scene);
                Row::without(task.scene, method, tolerance, status)
            };
            if let Some(reason) = &slow {
                rows.push(without(format!("skipped: {reason}")));
                continue;
            }
            // Set-up, and a first run for error and work.
            let integrator = Tolerances::equal(tolerance)
                .and_then(|tolerances| choice.integrator::<3>(tolerances, MAX_STEPS));
            let mut integrator = match integrator {
                Ok(integrator) => integrator,
                Err(error) => {
                    rows.push(without(error.to_string()));
                    continue;
                }
            };
            let (answer, time) = timed(|| (task.run)(&mut *integrator));
            if time > LIMIT {
                slow = Some(format!("took {time:.2?} at {tolerance:.0e} already"));
            }
            let answer = match answer {
                Ok(_) if time > LIMIT => {
                    rows.push(without(format!("skipped: takes {time:.2?}")));
                    continue;
                }
                Ok(answer) => answer,
                Err(error) => {
                    rows.push(without(error.to_string()));
                    continue;
                }
            };
            let (error, work) = ((task.error)(&answer), integrator.work());
            let mut samples = Vec::new();
            let label = BenchmarkId::new(method, format!("{tolerance:.0e}"));
            group.bench_function(label, |bencher| {
                bencher.iter_custom(|repeat| {
                    let (_, time) = timed(|| {
                        for _ in 0..repeat {
                            black_box((task.run)(black_box(&mut *integrator))).ok();
                        }
                    });
                    samples.push(time.as_secs_f64() / repeat as f64);
                    time
                });
            });
            // The last samples are criterion's, the first ones its warm-up. None: a filter left this one out.
            let measured = samples.split_off(samples.len().saturating_sub(SAMPLES));
            let Some(seconds) = median(measured) else {
                left_out = true;
                continue;
            };
            println!(
                "    error {error:.1e}, {} steps, {} refused",
                work.steps, work.rejected
            );
            rows.push(Row {
                scene: task.scene.to_owned(),
                method: method.clone(),
                tolerance,
                seconds: Some(rounded(seconds)),
                error: Some(rounded(error)),
                steps: Some(work.steps),
                rejected: Some(work.rejected),
                status: OK.into(),
            });
        }
        // What a filter leaves out was not tried: older rows of it stand.
        if left_out {
            let tried = rows.split_off(before);
            rows.extend(tried.into_iter().filter(|row| row.seconds.is_some()));
        }
    }
    group.finish();
    rows
}
