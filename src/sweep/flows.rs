//! How the runs of a sweep are advanced: side by side in the lanes of the processor, or one after the other.

use crate::error::Result;
use crate::field::State;
use crate::friction::AnyLaw;
use crate::integrate::{
    Batch, BatchObserver, BatchRun, Integrator, Observer, Step, Taylor, Tolerances,
};
use crate::model::two_interfaces;

/// What advances runs with one law.
pub(super) struct Flows {
    law: AnyLaw,
    way: Backend,
}

enum Backend {
    Lanes(Batch),
    OneByOne(Taylor),
}

impl Flows {
    pub fn lanes(law: AnyLaw, rtol: f64, max_steps: usize) -> Result<Self> {
        let batch = Batch::new(law, Tolerances::equal(rtol)?, max_steps)?;
        let way = Backend::Lanes(batch);
        Ok(Flows { law, way })
    }

    pub fn one_by_one(law: AnyLaw, rtol: f64, max_steps: usize) -> Result<Self> {
        let taylor = Taylor::new(Tolerances::equal(rtol)?, max_steps)?;
        let way = Backend::OneByOne(taylor);
        Ok(Flows { law, way })
    }

    /// Goes on with another law; lanes stay with theirs.
    pub fn set_law(&mut self, law: AnyLaw) {
        self.law = law;
    }

    /// As [`Batch::flow`].
    pub fn flow(
        &mut self,
        runs: &[BatchRun],
        observer: BatchObserver<'_>,
    ) -> Vec<Result<State<3>>> {
        let taylor = match &mut self.way {
            Backend::Lanes(batch) => return batch.flow(runs, Some(observer)),
            Backend::OneByOne(taylor) => taylor,
        };
        let mut one = |(k, run): (usize, &BatchRun)| {
            let field = two_interfaces(self.law, run.loading);
            let mut of_run = |step: &Step<'_, 3>| observer(k, step);
            let see: Observer<'_, 3> = &mut of_run;
            taylor.flow(&*field, run.t, &run.start, Some(see))
        };
        runs.iter().enumerate().map(&mut one).collect()
    }
}
