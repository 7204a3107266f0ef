//! Any number of interfaces under one stress, in time and memory that grow with their number: dtau/dt = K (V_H - sum of v_i).
//!
//! All interfaces see the same tau, and nothing else of each other. Order by order, Taylor's method makes the next coefficient of every
//! slip rate, adds these up, and has the next coefficient of tau; across interfaces it works in whole vector registers, and on many
//! cores where there are enough of them. Sums are taken in an order that depends on the number of interfaces alone: so do all digits,
//! whatever the machine's vectors and cores.

mod block;
mod constants;
#[cfg(feature = "sundials")]
mod cvode;
mod equilibrium;
mod field;
mod interfaces;
#[cfg(feature = "sundials")]
mod kinsol;
mod local;
mod method;
mod newton;
mod rosenbrock;
mod share;
mod slip_events;
mod stability;
mod state;
mod step;
mod taylor;
mod vectors;

pub use block::Extent;
pub use constants::OneOfMany;
#[cfg(feature = "sundials")]
pub use cvode::ManyCvode;
pub use equilibrium::{ManyEquilibrium, equilibrium_of_many};
pub use field::{Slips, arrow_solution};
pub use interfaces::ManyInterfaces;
pub use method::ManyMethod;
pub use rosenbrock::ManyRosenbrock;
pub use share::{Gather, Processes, Share};
pub use slip_events::{ManyEvent, Participation, SlipEvents, UnderWay};
pub use stability::{ManyStability, stability_of_many};
pub use state::ManyState;
pub use step::{Beginning, ManyObserver, ManyStep, Saved};
pub use taylor::{ManySolution, ManyTaylor, StepSeries};
