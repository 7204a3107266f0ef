//! Processor time.

use std::time::{Duration, Instant};
use twinslip_paper::clock::timed;

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
