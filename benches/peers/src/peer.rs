//! What a peer is asked and what it answers.

use rustix::time::{ClockId, clock_gettime};
use std::hint::black_box;

/// One question: the state at the end of a scene, or the tangent flow.
#[derive(Clone, Copy)]
pub struct Question {
    pub tolerance: f64,
    /// Whether the tangent flow is asked for.
    pub tangent: bool,
    /// So many runs in one time.
    pub repeat: u32,
}

/// One answer.
pub struct Answer {
    /// Thread CPU time of one run.
    pub seconds: f64,
    pub steps: Option<usize>,
    /// (tau, ln psi1, ln psi2) at the end.
    pub end: [f64; 3],
    /// d end / d start by rows, in the same variables.
    pub tangent: Option<[[f64; 3]; 3]>,
}

/// A program or library that integrates one scene by one method.
pub trait Peer {
    /// Its name in tables.
    fn name(&self) -> &str;

    /// The answer, or what failed.
    fn ask(&mut self, question: &Question) -> Result<Answer, String>;
}

/// CPU time of this thread in seconds.
fn cpu_time() -> f64 {
    let now = clock_gettime(ClockId::ThreadCPUTime);
    now.tv_sec as f64 + 1e-9 * now.tv_nsec as f64
}

/// The last answer of `repeat` runs with the time of one.
pub fn timed<A>(
    repeat: u32,
    mut run: impl FnMut() -> Result<A, String>,
) -> Result<(A, f64), String> {
    let begin = cpu_time();
    for _ in 1..repeat {
        black_box(run()?);
    }
    let answer = run()?;
    Ok((answer, (cpu_time() - begin) / f64::from(repeat)))
}
