//! Each step of velocity fitted by itself.

use twinslip::error::Result;
use twinslip::fit::{Fit, Motion, Record, Stretch};
use twinslip_tasks::scene::{FitPlan, LawToFit, Piece, Recording};

/// A step, and what it says alone.
pub struct FittedStep {
    /// Of which record, by its place among them.
    pub record: usize,
    /// When the velocity changes, in s.
    pub time: f64,
    /// From the change before to the one after.
    pub window: (f64, f64),
    /// The velocities before and after, in m/s.
    pub driving: (f64, f64),
    pub fit: Result<Fit>,
}

/// All steps, each from the change before to the one after. The slider moves from the beginning of the record on, so that a window begins in the
/// state that the steps before have left.
///
/// # Errors
/// [`twinslip::Error::Input`] where the load point moves as it was recorded: it has no steps then.
pub fn each(plan: &FitPlan, law: &LawToFit) -> Result<Vec<FittedStep>> {
    let mut all = Vec::new();
    for (at, recording) in plan.recordings.iter().enumerate() {
        all.extend(of_recording(plan, law, (at, recording))?);
    }
    Ok(all)
}

fn of_recording(
    plan: &FitPlan,
    law: &LawToFit,
    (at, recording): (usize, &Recording),
) -> Result<Vec<FittedStep>> {
    let stretches = &recording.motion.stretches;
    if recording.motion != recording.steps {
        return Err(twinslip::Error::Input(
            "`each_step`: the load point moves as it was recorded, and has no steps".into(),
        ));
    }
    let steady = |stretch: &Stretch| stretch.velocity.0 == stretch.velocity.1;
    let steps = stretches.windows(2).enumerate().filter(|(_, pair)| {
        pair.iter().all(steady) && pair[0].velocity.0 > 0.0 && pair[1].velocity.0 > 0.0
    });
    let of = |(last, pair): (usize, &[Stretch])| {
        let window = (pair[0].span.0, pair[1].span.1);
        let alone = Motion {
            before: pair[0].velocity.0,
            stretches: pair.to_vec(),
        };
        let motion = Motion {
            before: recording.motion.before,
            stretches: stretches[..last + 2].to_vec(),
        };
        let piece = Piece {
            of: at,
            motion: &motion,
            record: &part(&recording.record, window),
        };
        FittedStep {
            record: at,
            time: pair[1].span.0,
            window,
            driving: (pair[0].velocity.0, pair[1].velocity.0),
            fit: plan.fit_to(law, piece, &alone),
        }
    };
    Ok(steps.map(of).collect())
}

fn part(record: &Record, (from, to): (f64, f64)) -> Record {
    let first = record.times.partition_point(|&t| t < from);
    let last = record.times.partition_point(|&t| t <= to);
    let of = |all: &[f64]| all[first..last].to_vec();
    let origin = record.displacement.get(first).copied().unwrap_or(0.0);
    Record {
        times: of(&record.times),
        displacement: of(&record.displacement)
            .iter()
            .map(|x| x - origin)
            .collect(),
        friction: of(&record.friction),
        weights: of(&record.weights),
    }
}
