//! What an observer of a run sees: one step, with everything at any time of it.

use super::block::Extent;

/// A step of all interfaces, from its beginning to its end.
pub trait ManyStep {
    /// The time at its beginning.
    fn begin(&self) -> f64;

    /// The time at its end.
    fn end(&self) -> f64;

    /// tau at a time of the step.
    fn stress(&self, time: f64) -> f64;

    /// What all interfaces do at a time of the step; `sliding` counts those that are faster than this.
    fn extent(&self, time: f64, faster_than: f64) -> Extent;

    /// psi and v of an interface that is held here at a time of the step.
    ///
    /// # Panics
    /// Where it is not held here, as the next.
    fn interface(&self, interface: usize, time: f64) -> [f64; 2];

    /// How far an interface whose slip is asked for slips from the beginning of the step to a time of it.
    fn slip(&self, interface: usize, time: f64) -> f64;

    /// The same of all interfaces together.
    fn slip_of_all(&self, time: f64) -> f64;
}
