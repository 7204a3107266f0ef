//! Processor time of a piece of work, which does not grow with what else the machine does.

use rustix::time::{ClockId, clock_gettime};
use std::time::Duration;

/// The processor time that this thread has had.
fn processor() -> Duration {
    let time = clock_gettime(ClockId::ThreadCPUTime);
    // The clock of a thread begins at zero and only runs forwards.
    Duration::new(
        time.tv_sec.try_into().unwrap_or_default(),
        time.tv_nsec.try_into().unwrap_or_default(),
    )
}

/// What a piece of work gives, and the processor time that it takes. It must be done by this thread alone: one that waits for
/// others in the midst of it may be given quite different work.
pub fn timed<T>(work: impl FnOnce() -> T) -> (T, Duration) {
    let begun = processor();
    let made = work();
    (made, processor().saturating_sub(begun))
}

#[cfg(test)]
mod test {
    use super::timed;
    use std::time::{Duration, Instant};

    #[test]
    fn waiting_takes_no_processor_time_and_work_does() {
        let ((), waited) = timed(|| std::thread::sleep(Duration::from_millis(300)));
        assert!(waited < Duration::from_millis(150), "{waited:?}");
        let ((), worked) = timed(|| {
            let begun = Instant::now();
            let mut x = 1.0_f64;
            // So long that a busy machine gives some of it.
            while begun.elapsed() < Duration::from_millis(300) {
                x = std::hint::black_box(x * 1.000_001);
            }
        });
        assert!(worked > Duration::ZERO, "{worked:?}");
    }
}
