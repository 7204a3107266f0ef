//! Events: zeros of functions of the state, located by CVODES on the way.
#![allow(unsafe_code)]

use super::cvode::{Cvode, Operations};
use super::vector::{OwnVectors, Serial};
use super::{callback, check, counted};
use crate::error::Result;
use std::ffi::c_int;

impl<const N: usize> Cvode<N> {
    /// Watches for zeros of `count` event functions, which the [`super::Problem`] then must have; zero for none. Each may be watched
    /// in one direction of crossing only: 1 upwards, -1 downwards, 0 both; missing ones are 0.
    ///
    /// # Errors
    /// [`crate::Error::Sundials`] if CVODES can't allocate; [`crate::Error::Parameter`] for more events than C can count.
    pub fn watch_events(&mut self, count: usize, directions: &[i32]) -> Result<()> {
        let counted = counted("the number of events", count)?;
        let m = self.memory.as_ptr();
        let g = match self.operations {
            Operations::Fixed => callback::events::<OwnVectors, N>,
            Operations::Stock => callback::events::<Serial, N>,
        };
        let mut direction: Vec<c_int> = directions.to_vec();
        direction.resize(count, 0);
        self.event_count = 0;
        // SAFETY: a live memory; the callback is of this N and storage; CVODES copies the `count` directions.
        unsafe {
            check!(
                CV,
                &self.messages,
                CVodeRootInit(m, counted, (count > 0).then_some(g as _))
            )?;
            if count > 0 {
                check!(
                    CV,
                    &self.messages,
                    CVodeSetRootDirection(m, direction.as_mut_ptr())
                )?;
                check!(CV, &self.messages, CVodeSetNoInactiveRootWarn(m))?;
            }
        }
        self.event_count = count;
        Ok(())
    }

    /// For each watched event whether it was found by the last [`Cvode::advance`]: 1 upwards, -1 downwards, 0 not.
    ///
    /// # Errors
    /// [`crate::Error::Sundials`]; not after a successful [`Cvode::advance`].
    pub fn events_found(&self) -> Result<Vec<i32>> {
        let mut found = vec![0 as c_int; self.event_count.max(1)];
        let m = self.memory.as_ptr();
        // SAFETY: a live memory and a place for as many flags as events are watched.
        unsafe { check!(CV, &self.messages, CVodeGetRootInfo(m, found.as_mut_ptr()))? };
        found.truncate(self.event_count);
        Ok(found)
    }
}
