//! What a flow settles on: return maps to a section, their periodic points and invariant curves, Lyapunov exponents.

pub(crate) mod curve;
mod dense;
mod lyapunov;
mod periodicity;
mod regime;
mod rest;
mod returns;
mod surface;

pub use curve::{InvariantCurve, invariant_curve, regularity};
pub(crate) use dense::crossings;
pub(crate) use lyapunov::{ALIGNMENT, GrowthSegment, summary};
pub use lyapunov::{
    Exponents, FEWEST_FOR_EXPONENTS, LyapunovSpectrum, at_equilibrium, record_finely, spectrum,
    spectrum_watched,
};
pub(crate) use periodicity::{Closing, PeriodicSearch, closing_in, reduce};
pub use periodicity::{LONGEST_PERIOD, Periodic, periodicity};
pub use regime::aperiodic;
pub use regime::{FEWEST_RETURNS, Regime, RegimeVerdict, verdict};
pub(crate) use regime::{IRREGULAR, ON_SADDLE, REGULAR, points};
pub(crate) use rest::{equilibrium_near, growth};
pub(crate) use returns::{AT_START, Recorder, Watched};
pub use returns::{Ended, Return, ReturnRecord, See, Watching, record, usual_patience};
pub use surface::{Landing, SeriesVariables, Surface, half_driving_stress, return_map};
pub(crate) use surface::{STEPS_OF_PIECE, derivative_along};
