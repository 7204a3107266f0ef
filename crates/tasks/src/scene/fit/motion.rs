//! How the load point moved: by a program, by the steps that its displacement shows, or as it was recorded.

use super::data::Measured;
use super::options::FitOptions;
use super::recorded::{Recorded, motions_as_recorded};
use super::steps::motion_in_steps;
use crate::scene::program::{Change, Program};
use twinslip::error::{Error, Result};
use twinslip::fit::{Motion, Record, Stretch};
use twinslip::friction::positive;

/// Velocities nearer to each other than this factor are one.
const STEP: f64 = 1.05;

/// How the load point moves, with the record to which it belongs.
pub(super) struct Loaded {
    /// In steps: of a program, or of the displacement.
    pub motion: Motion,
    /// As it was recorded, where that is asked for, at several smoothings.
    pub recorded: Vec<Recorded>,
    pub record: Record,
}

/// The motion that is asked for.
pub(super) fn loaded(options: &FitOptions, measured: &Measured) -> Result<Loaded> {
    let Measured {
        times,
        displacement,
        friction,
        weights,
        ..
    } = measured;
    let shown = displacement.as_ref().map(|x| motion_in_steps(times, x));
    let is_recorded = options.load_point == "recorded";
    let motion = match (&options.program, options.load_point.as_str()) {
        (Some(_), "recorded") => {
            return Err(Error::Input(
                "`program` and `load_point` recorded: the load point moves by one or the other"
                    .into(),
            ));
        }
        (Some(program), "steps") => by_program(program, options.driving, times, shown.as_ref())?,
        (None, "steps" | "recorded") => shown.ok_or_else(|| {
            let option = if is_recorded {
                "`load_point` recorded"
            } else {
                "`program` is missing"
            };
            Error::Input(format!(
                "{option}: the record has no column that is known as displacement; {}; say which by `displacement`",
                measured.seen
            ))
        })?,
        (_, other) => return Err(Error::unknown("load_point", other, &["steps", "recorded"])),
    };
    let before = match options.driving {
        Some(driving) if options.program.is_none() => positive("driving", driving)?,
        _ => motion.before,
    };
    let motion = Motion { before, ..motion };
    if motion.before <= 0.0 {
        return Err(Error::Input(format!(
            "the load point moves at {} m/s as the window begins; a fit begins at steady sliding: give `driving`, or begin the window by `from` where it slides",
            motion.before
        )));
    }
    let changes = |v: f64| v > STEP * motion.before || v < motion.before / STEP;
    if !motion
        .stretches
        .iter()
        .any(|stretch| changes(stretch.velocity.1))
    {
        return Err(Error::Input(format!(
            "the window from {} to {} s has no step of velocity: the load point moves at {:e} m/s all the time",
            times[0],
            times[times.len() - 1],
            motion.before
        )));
    }
    let record = Record {
        displacement: match displacement {
            Some(x) => x.iter().map(|at| at - x[0]).collect(),
            None => motion.displacement(times),
        },
        times: times.clone(),
        friction: friction.clone(),
        weights: weights.clone(),
    };
    let recorded = displacement.as_ref().filter(|_| is_recorded);
    Ok(Loaded {
        recorded: recorded.map_or_else(Vec::new, |x| motions_as_recorded(times, x, &motion)),
        motion,
        record,
    })
}

/// By a program: what it changes before the window is the velocity that it begins with. So is what it changes as the window begins, unless an
/// earlier velocity is known: then the record begins with that step.
pub(super) fn by_program(
    program: &str,
    driving: Option<f64>,
    times: &[f64],
    shown: Option<&Motion>,
) -> Result<Motion> {
    let (begin, end) = (times[0], times[times.len() - 1]);
    let program = Program::read(program, end)?;
    let done = |change: &&Change| {
        change
            .until
            .map_or(change.time < begin, |until| until <= begin)
    };
    let mut rest = program.changes.iter().skip_while(done);
    let at_once = rest.find(|change| change.until.is_none() && change.time <= begin);
    let earlier = program.changes.iter().take_while(done).last();
    let of = |change: &Change| change.driving;
    let known = earlier.map(of).or(driving).or(at_once.map(of));
    let before = known.or(shown.map(|motion| motion.before)).ok_or_else(|| {
        Error::Input(
            "`driving`, the velocity before the first change of the `program`, is missing".into(),
        )
    })?;
    let (mut stretches, mut now, mut velocity) = (Vec::new(), begin, before);
    let mut add = |span: (f64, f64), velocity: (f64, f64)| {
        if span.1 > span.0 {
            stretches.push(Stretch { span, velocity });
        }
    };
    for change in program.changes.iter().skip_while(done) {
        let at = change.time.max(begin);
        add((now, at), (velocity, velocity));
        now = at;
        if let Some(until) = change.until {
            add((at, until), (velocity, change.driving));
            now = until;
        }
        velocity = change.driving;
    }
    add((now, end), (velocity, velocity));
    Ok(Motion { before, stretches })
}
