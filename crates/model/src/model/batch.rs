//! Several trajectories of two interfaces at once, one in every lane, each with its own loading.

use super::Loading;
use crate::friction::AnyLaw;
use crate::series::{Accuracy, Expansion};
#[cfg(target_arch = "x86_64")]
use {
    super::ageing_lanes::AgeingLanes,
    super::lanes::{Lanes, Wide},
    super::series::InStates,
    crate::friction::LawForm,
    crate::series::{Eight, Four, LaneFormula},
};

/// The most lanes that there are.
#[doc(hidden)]
pub const MAX_LANES: usize = 8;

/// Trajectories on their way in lanes.
#[doc(hidden)]
pub trait BatchSolution: Send {
    /// How many lanes there are.
    fn lanes(&self) -> usize;
    /// Begins at y = (tau, ln psi_1, ln psi_2) in this lane with the next step.
    fn start(&mut self, lane: usize, loading: &Loading, y: &[f64; 3]);
    /// Lets this lane do nothing that matters: interfaces at rest under constant stress, for which any limit > 0 will do.
    fn idle(&mut self, lane: usize);
    /// As [`crate::series::Solution::advance`], in every lane.
    fn advance(&mut self, accuracy: &Accuracy, limits: &[f64; MAX_LANES]) -> [f64; MAX_LANES];
    /// The state reached in this lane.
    fn state(&self, lane: usize) -> [f64; 3];
    /// Bounds on how far the stress strays within the last steps.
    fn reaches(&self) -> &[f64; MAX_LANES];
    /// The series at the beginning of the last step in this lane.
    fn expansion(&self, lane: usize, order: usize, into: &mut Expansion<3>);
}

/// As many lanes as this processor has, in which runs with this law go; `None` where it has none.
#[doc(hidden)]
pub fn batch_solution(law: AnyLaw) -> Option<Box<dyn BatchSolution>> {
    #[cfg(target_arch = "x86_64")]
    {
        if let Some(simd) = crate::series::avx512() {
            let zero = Eight::new(simd, [0.0; 8]);
            return Some(lanes(simd, law.form(), zero));
        }
        if let Some(simd) = crate::series::avx2() {
            let zero = Four::new(simd, [0.0; 4]);
            return Some(lanes(simd, law.form(), zero));
        }
    }
    let _ = law;
    None
}

/// By the recurrences that the law has of its own, or by its recorded formula.
#[cfg(target_arch = "x86_64")]
fn lanes<S, E: Wide>(simd: S, law: LawForm, zero: E) -> Box<dyn BatchSolution>
where
    Lanes<S, E, AgeingLanes<E>>: BatchSolution + 'static,
    Lanes<S, E, LaneFormula<E>>: BatchSolution + 'static,
{
    if law.undamped_ageing().is_some() {
        return Box::new(Lanes::new(simd, law, zero, AgeingLanes::new(zero)));
    }
    let recorded = LaneFormula::new(&InStates(law), false, zero);
    Box::new(Lanes::new(simd, law, zero, recorded))
}
