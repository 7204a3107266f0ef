//! Any number of interfaces under one stress, in time and memory that grow with their number: dtau/dt = K (V_H - sum of v_i).
//!
//! All interfaces see the same tau, and nothing else of each other. Order by order, Taylor's method makes the next coefficient of every
//! slip rate, adds these up, and has the next coefficient of tau; across interfaces it works in whole vector registers, and on many
//! cores where there are enough of them. Sums are taken in an order that depends on the number of interfaces alone: so do all digits,
//! whatever the machine's vectors and cores.

mod block;
mod interfaces;
mod slip_events;
mod taylor;

pub use block::Extent;
pub use interfaces::ManyInterfaces;
pub use slip_events::{ManyEvent, Participation, SlipEvents, UnderWay};
pub use taylor::{ManySolution, ManyStep, ManyTaylor};
