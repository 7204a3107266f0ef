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
mod modulation;
mod more_states;
mod motion;
mod options;
mod orbit;
mod remarks;
mod slab;
mod slab_options;
mod slider;
mod sliding;

pub use equilibria::{SearchPlace, TextEquilibria, TextEquilibriaPlan, TextEquilibrium};
pub use file::SystemFile;
pub use friction::{Friction, Steady};
pub(super) use law::curve_of_formulas;
pub use law_file::LawFile;
pub use model::TextModel;
pub(super) use model::{given_text, law_text, system_text};
pub(super) use modulation::NORMAL_STRESS_COUPLING;
pub(super) use more_states::{MASS, SECOND_EVOLUTION_EFFECT, SECOND_SLIP_LENGTH};
pub use options::TextOptions;
pub(super) use orbit::{orbit_start, symmetry};
pub(super) use remarks::remarks;
pub(super) use slab::SPREAD;
pub use slab::TextSlab;
pub(super) use slab_options::MOST_APART;
pub use slider::TextSlider;
pub(super) use sliding::StateLayout;
