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
    /// Propagate the uncertainty of a fit: the parameters of a law from `twinslip fit`, with their covariance. Numbers get a 95 % interval,
    /// yes-or-no results a probability. Implies --si; options given here replace values that were fixed in the fit. N draws check the
    /// intervals, which follow from derivatives; without draws there are no probabilities [default N: 200; 50 for sweep, which uses draws
    /// alone]
    #[arg(long, value_name = "FIT.json[:N]", conflicts_with = "system")]
    pub ensemble: Option<String>,
}
