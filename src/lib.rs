//! Sliding modes of interacting frictional interfaces.
//!
//! Parallel frictional interfaces divide an elastic slab that is sheared at the velocity V_H; each obeys a rate-and-state
//! friction law. Putelat, Willis and Dawes (2008) found equilibria, stick-slip cycles, tori and resonances in the three
//! stiff differential equations (19) that follow. This crate integrates them and solves for their equilibria and periodic
//! orbits.
//!
//! | Type | Role |
//! |---|---|
//! | [`friction::Law`] | how an interface resists: two formulas, and what follows from them |
//! | [`field::VectorField`] | what a dynamical system is |
//! | [`model::TwoInterfaces`] | the system (19); also [`model::SingleInterface`], [`model::Symmetric`] |
//! | [`series::Equations`] | any other small system, from its right-hand side written once; with it [`model::Smooth`] is a field |
//! | `sundials::Cvode`, `sundials::Kinsol` | CVODES and KINSOL as safe types (feature `sundials`) |
//! | [`integrate::Integrator`] | a method that makes flows and tangent flows of a field |
//! | [`equilibrium::steady_states`] | all steady states at a driving velocity, with error budgets and stability |
//! | [`orbit::find()`] | periodic orbits with their Floquet multipliers, each with an error budget |
//! | [`continuation::Continuation`] | any curve of solutions followed by pseudo-arclength; [`continuation::follow()`] curves of zeros |
//! | [`bifurcation::Event`] | what is found along branches and along the curves of their bifurcations |
//! | [`bifurcation::equilibria`] | branches of equilibria, and curves of their bifurcations in the (V_H, K) plane |
//! | [`section::record()`] | the returns of a run to a section; what they settle on by [`section::verdict()`] |
//! | [`fit::fit()`] | friction parameters from laboratory records, with errors that hold |
//! | [`sweep::run()`] | maps of regimes over a grid of (V_H, K) or any parameters, or of starts |
//!
//! The default feature `sundials` is the C solvers. What the commands compute is in the crate `twinslip-tasks`, the paper's figures in
//! `twinslip-paper`, the command in `twinslip-cli`; tables, files, pictures and pages are of `twinslip-output`.
//!
//! Everything is dimensionless unless it says otherwise: stress tau in a sigma, slip rate v in V*, length in L, time in
//! L/V*. K = k L / (a sigma), R = t** V*/L, beta = b/a, gamma0 = 2 exp(-a_v/a). Numbers in parentheses are the equations of
//!
//! Putelat, T., Willis, J. R. and Dawes, J. H. P. (2008). Sliding modes of two interacting frictional interfaces.
//! Journal of the Mechanics and Physics of Solids.

// Printing may fail, as nobody may read it: these macros would panic.
#![warn(clippy::print_stderr, clippy::print_stdout)]

// Bottom up: a room imports only from those above it here. The drawing in CONTRIBUTING.md says from which.
pub use twinslip_error as error;
pub use twinslip_model::{expression, field, friction, model, number, series};

pub mod contract;

pub mod random;

#[cfg(feature = "sundials")]
pub mod sundials;

pub mod integrate;

pub mod continuation;

pub mod equilibrium;

pub mod section;

pub mod orbit;

pub mod sweep;

pub mod bifurcation;

pub mod many;

pub mod fit;

/// What the tests of this repository reach for. Nothing here is kept as it is.
#[doc(hidden)]
pub mod internals {
    pub use twinslip_model::internals::*;

    pub use crate::integrate::rosenbrock::control::{MayErr, error_norm, first_step};
    pub use crate::integrate::rosenbrock::factors::Factors;
    pub use crate::integrate::singularity::time_to_singularity;
    pub use crate::orbit::branch::period_from_hopf;
    pub use crate::orbit::cyclic::solve as solve_cyclic;
    pub use crate::orbit::floquet::pair;
    pub use crate::orbit::periodic_schur::{LogEigenvalue, eigenvalues};
    pub use crate::orbit::shooting::newton_step;
    pub use crate::section::curve::weighted_mean;
    #[cfg(feature = "sundials")]
    pub use crate::sundials::{compatible, counted};
}

pub use error::{Error, Result};

#[cfg(doctest)]
#[doc = include_str!("../docs/library.md")]
struct Library;

#[cfg(doctest)]
#[doc = include_str!("../docs/own-system.md")]
struct OwnSystem;
