//! Systems of one's own, from a file: their equations read, and what the commands make of them.

mod equilibria;
mod file;
mod grammar;
mod lowering;
mod model;
mod options;
mod orbit;
mod plan;
mod run;
mod section;

pub use equilibria::{SearchPlace, TextEquilibria, TextEquilibriaPlan, TextEquilibrium};
pub use file::SystemFile;
pub use model::TextModel;
pub use options::TextOptions;
pub use orbit::TextOrbitPlan;
pub use plan::{TextInstant, TextPlan, text_columns};
pub use run::{TextOutcome, run_text};
pub use section::{TextReturn, TextSectionPlan, run_text_section, text_section_columns};
