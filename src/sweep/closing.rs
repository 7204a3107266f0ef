//! Whether returns close in on a periodic point, and after how many they come round.

use crate::field::Vector;
use crate::section::{LONGEST_PERIOD, Return};

/// Returns that have come this close to each other after q, and come closer, make q a candidate; those closer than the second at
/// once.
const NEAR: f64 = 1e-3;
pub(super) const ARRIVED: f64 = 1e-5;
/// What distances must shrink to from a window of returns to the next.
const SHRUNK: f64 = 0.7;
/// The least returns in a window.
const WINDOW: usize = 3;
/// Where so many more rounds would bring a candidate to [`ARRIVED`], they are waited for: Newton's method takes as long.
const WORTH_WAITING: f64 = 30.0;
/// Fewer returns show nothing.
pub(super) const FEWEST_TO_CLOSE: usize = 2 * WINDOW + 1;

/// The smallest number of returns after which the last ones have come close to where they were, and ever closer; `unit` is what
/// distances are measured in.
pub(super) fn closing(returns: &[Return], unit: f64) -> Option<usize> {
    let n = returns.len();
    let moved = |i: usize, q: usize| apart(&returns[i].state, &returns[i - q].state) / unit;
    (1..=LONGEST_PERIOD.min(n / 3)).find(|&q| {
        let window = q.max(WINDOW).max(n / 8);
        if moved(n - 1, q) > NEAR || n < 2 * window + q {
            return false;
        }
        let largest =
            |range: std::ops::Range<usize>| range.map(|i| moved(i, q)).fold(0.0, f64::max);
        let late = largest(n - window..n);
        let early = largest(n - 2 * window..n - window);
        if late > NEAR || late >= SHRUNK * early {
            // Arrived, where the error of the run moves it about.
            return late < ARRIVED;
        }
        let wait = (late / ARRIVED).ln() / (early / late).ln() * window as f64;
        wait <= 0.0 || wait > WORTH_WAITING * q as f64
    })
}

/// The largest difference in a component, without room for the difference: returns are compared after each of them.
pub(super) fn apart(a: &Vector, b: &Vector) -> f64 {
    let differences = a.iter().zip(b.iter()).map(|(a, b)| (a - b).abs());
    differences.fold(0.0, f64::max)
}
