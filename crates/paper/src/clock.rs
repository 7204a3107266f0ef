//! Processor time of a piece of work, which does not grow with what else the machine does.

use std::time::Duration;

/// The processor time that this thread has had.
#[cfg(unix)]
fn processor() -> Duration {
    use rustix::time::{ClockId, clock_gettime};
    let time = clock_gettime(ClockId::ThreadCPUTime);
    // The clock of a thread begins at zero and only runs forwards.
    Duration::new(
        time.tv_sec.try_into().unwrap_or_default(),
        time.tv_nsec.try_into().unwrap_or_default(),
    )
}

/// The processor time that this thread has had: `rustix` has no clocks on Windows.
#[cfg(windows)]
fn processor() -> Duration {
    cpu_time::ThreadTime::now().as_duration()
}

/// What a piece of work gives, and the processor time that it takes. It must be done by this thread alone: one that waits for
/// others in the midst of it may be given quite different work.
pub fn timed<T>(work: impl FnOnce() -> T) -> (T, Duration) {
    let begun = processor();
    let made = work();
    (made, processor().saturating_sub(begun))
}
