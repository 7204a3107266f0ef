//! User-defined systems and friction laws, from a file: their equations read, and what the commands make of them.

mod equilibria;
mod file;
mod fingerprint;
mod friction;
mod grammar;
mod law;
mod law_file;
mod lowering;
mod model;
mod motion;
mod observer;
mod options;
mod orbit;
mod plan;
mod run;
mod section;
mod slab;
mod slider;

pub use equilibria::{SearchPlace, TextEquilibria, TextEquilibriaPlan, TextEquilibrium};
pub use file::SystemFile;
pub use friction::{Friction, Steady};
pub use law::{TextLawPlan, TextLawPoint};
pub use law_file::LawFile;
pub use model::TextModel;
pub(super) use model::given_text;
pub use options::TextOptions;
pub use orbit::TextOrbitPlan;
pub(super) use orbit::orbit_start;
pub(super) use plan::numerics;
pub use plan::{TextInstant, TextPlan, text_columns};
pub use run::run_text;
pub use section::{TextReturn, TextSectionPlan, run_text_section, text_section_columns};
pub(super) use slab::SPREAD;
pub use slab::TextSlab;
pub use slider::TextSlider;
