//! Several trajectories of two interfaces at once, one in every lane, each with its own loading.

use super::Loading;
use crate::friction::AnyLaw;
use crate::series::{Accuracy, Expansion};
#[cfg(target_arch = "x86_64")]
use {
    super::ageing_lanes::AgeingLanes,
    super::in_states::InStates,
    super::lanes::Lanes,
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

/// The lanes in which runs with this law go, by the recurrences that it has of its own or by its recorded formula; `None` where the processor
/// has none.
#[doc(hidden)]
pub fn batch_solution(law: AnyLaw) -> Option<Box<dyn BatchSolution>> {
    #[cfg(target_arch = "x86_64")]
    {
        let (law, simd) = (law.form(), crate::series::avx2()?);
        let four = Four::new(simd, [0.0; 4]);
        if law.undamped_ageing().is_none() {
            // Of eight lanes there are no kernels.
            let recorded = LaneFormula::new(&InStates(law), false, four);
            return Some(Box::new(Lanes::new(simd, law, four, recorded)));
        }
        Some(match crate::series::avx512() {
            Some(wide) => {
                let eight = Eight::new(wide, [0.0; 8]);
                Box::new(Lanes::new(wide, law, eight, AgeingLanes::new(eight)))
            }
            None => Box::new(Lanes::new(simd, law, four, AgeingLanes::new(four))),
        })
    }
    #[cfg(not(target_arch = "x86_64"))]
    {
        let _ = law;
        None
    }
}
