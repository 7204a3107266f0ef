//! The whole paper again: its figures, Table 1, a scorecard of what it says against what is computed, and a report to read.
//!
//! A [`Product`] is made of [`Pieces`], what the scene files compute; a piece that several products show is computed once. What
//! lies complete in the directory from an earlier run, made of the same scenes by the same program, is not made again.

pub(crate) mod clock;
mod figures;
mod going;
mod piece;
mod pieces;
mod product;
mod record;
mod report;
mod run;
pub mod scorecard;
mod sheet;

pub use going::{Going, Reached};
pub use piece::{Branches, Curves, Equilibria, LawCurve, Map, PeriodicOrbit, Run};
pub use pieces::Pieces;
pub use product::{Made, Make, PRODUCTS, Product};
pub use record::{ProductEntry, Record, Written, hash};
pub use run::{Done, RunEvent, Selection, reproduce};
pub use sheet::{Sheet, SheetPart};
