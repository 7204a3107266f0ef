//! Joining ranks of MPI in a build without it: there are none.

use twinslip::error::{Error, Result};

/// Nobody.
pub enum Joined {}

impl Joined {
    /// Makes sure that this process is alone.
    ///
    /// # Errors
    /// [`Error::Input`] if mpirun has started several, which would all write the same file.
    pub fn join() -> Result<Option<Self>> {
        let several = |name: &str| {
            let size = std::env::var(name).ok().and_then(|n| n.parse().ok());
            size.is_some_and(|size: usize| size > 1)
        };
        if ["OMPI_COMM_WORLD_SIZE", "PMI_SIZE"]
            .into_iter()
            .any(several)
        {
            return Err(Error::Input(
                "mpirun has started several processes, but this build has no MPI; build it with --features mpi"
                    .into(),
            ));
        }
        Ok(None)
    }
}
