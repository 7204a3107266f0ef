//! Where orbits of interfaces with a law from a file are looked for.

use super::model::TextModel;
use crate::scene::options::OrbitOptions;
use twinslip::equilibrium::Symmetry;
use twinslip::error::{Error, Result};
use twinslip::field::Vector;
use twinslip::orbit::{AlongArcs, Orbit, OrbitAccuracy, ShootingNodes};

impl TextModel {
    /// Adds the multipliers of an orbit within clusters, by the method that it was found by.
    ///
    /// # Errors
    /// Those of [`within_clusters`](twinslip::orbit::within_clusters).
    pub(in crate::scene) fn complete_orbit(
        &self,
        orbit: &mut Orbit,
        accuracy: &OrbitAccuracy,
    ) -> Result<()> {
        let Some(slab) = self.slab.as_ref().filter(|slab| slab.has_clusters()) else {
            return Ok(());
        };
        let vector = |node: &Vec<f64>| Vector::from_column_slice(node);
        let shooting = ShootingNodes {
            nodes: orbit.nodes.iter().map(vector).collect(),
            durations: orbit.durations.clone(),
        };
        let along = AlongArcs {
            method: accuracy.method,
            tolerances: accuracy.tolerances,
            uncertainty: orbit.point_uncertainty,
        };
        orbit.floquet.within = slab.within(&self.system, &shooting, along)?;
        Ok(())
    }
}

/// Where the search begins. Interfaces that start alike stay so: their symmetric orbits are found from such a start, and others from one
/// beside it.
pub(in crate::scene) fn orbit_start(
    given: Option<&str>,
    symmetry: Symmetry,
    model: &TextModel,
) -> Result<Vector> {
    match (&model.slab, given) {
        (Some(slab), None) if symmetry == Symmetry::Symmetric => {
            Ok(model.at_phase_0(slab.alike(&model.system)?))
        }
        _ => model.start(given),
    }
}

/// Whether the interfaces of an orbit that is asked for move alike; of another system nothing is said by it.
///
/// # Errors
/// [`Error::Input`] where the interfaces or the start have no such orbit.
pub(in crate::scene) fn symmetry(options: &OrbitOptions, model: &TextModel) -> Result<Symmetry> {
    let name = options.symmetry.as_deref().unwrap_or("symmetric");
    let symmetry = Symmetry::named(name)
        .ok_or_else(|| Error::unknown("symmetry", name, &["symmetric", "asymmetric"]))?;
    if let (Some(slab), Some(name)) = (&model.slab, &options.symmetry) {
        let refused = |why: &str| Err(Error::Input(format!("`symmetry` {name}: {why}")));
        if slab.differ(&model.system) {
            return refused("unequal interfaces have no symmetric orbits; leave it out");
        }
        if slab.clusters().len() == 1 && symmetry == Symmetry::Asymmetric {
            return refused("what moves alike has nothing to differ from");
        }
        if let Some(text) = &options.start {
            let start = model.start(Some(text))?;
            let alike = slab.move_alike(start.as_slice(), |x, y| x == y);
            if alike != (symmetry == Symmetry::Symmetric) {
                let how = if alike { "alike" } else { "apart" };
                return refused(&format!("in `start` {text} the interfaces move {how}"));
            }
        }
    }
    Ok(symmetry)
}
