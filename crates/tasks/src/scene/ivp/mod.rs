//! Initial value problems: solutions in numbers of the user's, at chosen times, up to events, and dense.
//!
//! The solution of a slab that is built in, of interfaces with a law from a file or of a system from a file, all by one path:
//! [`IvpPlan`] checks what is asked, [`IvpPlan::solve`] runs it, and [`IvpSolution`] is the solution at any time. Values are those that
//! the user knows: (tau, psi_1, psi_2, ...) of interfaces, in SI where the model is, and the states of a system in the order of its
//! file. Events, chosen times and dense output mean what they mean in `scipy.integrate.solve_ivp` (SciPy 1.17).
//!
//! ```
//! use std::convert::Infallible;
//! use twinslip::scene::{IntegrateOptions, IvpAsked, IvpEvent, IvpPlan};
//!
//! #[derive(clap::Parser)]
//! struct Line { #[command(flatten)] options: IntegrateOptions }
//! let line = <Line as clap::Parser>::parse_from(["line", "--driving=10", "--stiffness=0.14"]);
//! let (model, numerics) = (&line.options.model, &line.options.numerics);
//! let plan = IvpPlan::new(model, numerics, (0.0, 20.0), &[10.0, 0.5, 0.001])?;
//! // Where the stress falls to 10, at most twice.
//! let event = IvpEvent::<Infallible> {
//!     direction: -1.0,
//!     terminal: Some(2),
//!     ..IvpEvent::new(|_, y| Ok(y[0] - 10.0))
//! };
//! let asked = IvpAsked { events: vec![event], dense_output: true, ..IvpAsked::default() };
//! let outcome = plan.solve(asked).expect("no error");
//! assert_eq!(outcome.status, 1);
//! let last = outcome.t_events[0][1];
//! assert_eq!(outcome.t.last(), Some(&last));
//! let solution = outcome.solution.expect("asked for");
//! assert!((solution.at(last)[0] - 10.0).abs() < 1e-12);
//! # Ok::<(), twinslip::Error>(())
//! ```

mod chart;
mod event;
mod formula;
mod outcome;
mod plan;
mod run;
mod solution;

pub use event::{Halt, IvpEvent};
pub use formula::IvpFormula;
pub use outcome::{IvpAsked, IvpError, IvpOutcome};
pub use plan::IvpPlan;
pub use solution::{IvpParts, IvpSolution};
