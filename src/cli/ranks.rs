//! Joining the ranks that mpirun has started.

use crate::error::{Error, Result};
use mpi::environment::Universe;
use mpi::topology::SimpleCommunicator;
use mpi::traits::Communicator;

/// This process among others. MPI ends when it is dropped.
pub struct Joined(Universe);

impl Joined {
    /// The ranks that mpirun has started; `None` without mpirun, and if there is just this one.
    ///
    /// # Errors
    /// [`Error::Input`] if MPI does not start.
    pub fn join() -> Result<Option<Self>> {
        let started = ["OMPI_COMM_WORLD_SIZE", "PMIX_RANK", "PMI_RANK", "PMI_SIZE"];
        if !started.iter().any(|name| std::env::var_os(name).is_some()) {
            return Ok(None);
        }
        let universe = mpi::initialize()
            .ok_or_else(|| Error::Input("MPI is there but does not start".into()))?;
        if universe.world().size() < 2 {
            return Ok(None);
        }
        // A rank that only unwinds would leave the others waiting.
        let told = std::panic::take_hook();
        std::panic::set_hook(Box::new(move |panic| {
            told(panic);
            std::process::abort();
        }));
        Ok(Some(Joined(universe)))
    }

    /// All ranks.
    pub fn world(&self) -> SimpleCommunicator {
        self.0.world()
    }
}
