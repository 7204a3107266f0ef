//! The whole paper again: its figures, Table 1, a scorecard of what it says against what is computed, and a report to read.
//!
//! A [`Product`] is made of pieces, what the scene files compute; a piece that several products show is computed once. What
//! lies complete in the directory from an earlier run, made of the same scenes by the same program, is not made again.

#[doc(hidden)]
pub mod clock;
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
pub(crate) use piece::{Branches, Curves, GeneralCurves, Map, Run};
#[doc(hidden)]
pub use pieces::Pieces;
#[doc(hidden)]
pub use product::{Made, Make};
pub use product::{PRODUCTS, Product};
#[doc(hidden)]
pub use record::hash;
pub use run::{Done, RunEvent, Selection, reproduce};
pub(crate) use sheet::Sheet;
