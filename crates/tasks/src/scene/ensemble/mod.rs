//! The uncertainty of a fit, carried through a command: the friction parameters that `twinslip fit` has fitted, with their covariance.

mod file;
mod fit;
mod implied;
mod plan;
mod prepare;

pub use file::EnsembleFile;
pub use fit::{FittedParameter, FrictionFit};
pub(super) use implied::implied;
pub use plan::EnsemblePlan;

/// What a user can set about the parameters of a fit.
#[derive(Debug, Clone, Default, PartialEq, clap::Args)]
#[command(next_help_heading = "Uncertainty")]
pub struct EnsembleOptions {
    /// The parameters of a law that `twinslip fit` has fitted, with their uncertainty, which is carried through everything: numbers get
    /// an interval of 95 %, what may happen or not a probability. --si is implied; what else is given holds over what was fixed in the
    /// fit. N draws check the intervals, which follow from derivatives; without draws there are no probabilities [N: 200; of sweep, which
    /// has draws alone, 50]
    #[arg(long, value_name = "FIT.json[:N]", conflicts_with = "system")]
    pub ensemble: Option<String>,
}
