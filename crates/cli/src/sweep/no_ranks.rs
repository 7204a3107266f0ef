//! Ranks of MPI in a build without it: there are none.

use crate::ranks::Joined;
use std::ops::ControlFlow;
use std::sync::atomic::AtomicBool;
use twinslip::error::Result;
use twinslip::sweep::{SweepRow, SweepSettings, UnitShare};
use twinslip_tasks::scene::SweepPlan;

/// Nobody.
pub enum Ranks {}

impl Ranks {
    /// Makes sure that this process is alone.
    ///
    /// # Errors
    /// Those of [`Joined::join`].
    pub fn join() -> Result<Option<Self>> {
        Ok(Joined::join()?.map(|joined| match joined {}))
    }

    pub fn leads(&self) -> bool {
        match *self {}
    }

    pub fn serve(&self, _: Option<&SweepPlan>) {
        match *self {}
    }

    pub fn run(
        &mut self,
        _: &SweepSettings,
        _: UnitShare,
        _: &AtomicBool,
        _: &mut dyn FnMut(&[SweepRow]) -> ControlFlow<()>,
    ) -> Result<()> {
        match *self {}
    }

    pub fn dismiss(&mut self) {
        match *self {}
    }
}
