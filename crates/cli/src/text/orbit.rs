//! `twinslip orbit --system`.

use crate::orbit::{OrbitSearch, logarithm, multipliers};
use serde_json::{Map, Value, json};
use twinslip::error::Result;
use twinslip::orbit::{Crosscheck, FoundOrbit, Orbit, OrbitAccuracy};
use twinslip_tasks::scene::{Column, Described, TextModel, TextOrbitPlan, TextPlan};
use twinslip_tasks::views;

impl OrbitSearch for TextOrbitPlan {
    type Run = TextPlan;

    fn explain(&self) -> String {
        self.explain()
    }

    fn system(&self) -> &dyn Described {
        &self.model
    }

    fn accuracy(&self, orbit: &Orbit) -> (OrbitAccuracy, Option<OrbitAccuracy>) {
        self.accuracies(orbit)
    }

    fn absolute_tolerance(&self, accuracy: &OrbitAccuracy) -> Value {
        self.told_atol(accuracy)
    }

    fn has_rows(&self) -> bool {
        self.rows.is_some()
    }

    fn find(&self) -> Result<FoundOrbit> {
        self.find()
    }

    fn crosscheck(&self, orbit: &Orbit) -> Result<Option<Crosscheck>> {
        self.crosscheck(orbit)
    }

    fn along(&self, orbit: &Orbit) -> Option<TextPlan> {
        self.along(orbit)
    }

    fn columns(&self) -> Vec<Column<Orbit>> {
        views::text_orbit_columns(&self.model)
    }

    fn object(&self, orbit: &Orbit) -> Value {
        object(orbit, &self.model)
    }
}

fn object(orbit: &Orbit, model: &TextModel) -> Value {
    let uncertain =
        |x: twinslip::number::Uncertain| twinslip_output::uncertain((x.value, x.uncertainty));
    let states = || model.system.states().iter();
    let extremes: Map<String, Value> = states()
        .zip(&orbit.extremes)
        .map(|(name, [least, most])| {
            let ends = json!({"min": uncertain(*least), "max": uncertain(*most)});
            ((*name).to_owned(), ends)
        })
        .collect();
    let mut logs: Vec<Value> = orbit.floquet.multipliers.iter().map(logarithm).collect();
    logs.extend(orbit.floquet.within.iter().map(|within| {
        json!({
            "ln_abs": uncertain(within.ln_abs),
            "angle_over_pi": 0.0,
            "kind": "within",
            "cluster": within.cluster,
            "multiplicity": within.multiplicity,
        })
    }));
    json!({
        "period": uncertain(orbit.period),
        "point": orbit.point,
        "point_uncertainty": orbit.point_uncertainty,
        "extremes": extremes,
        "multipliers": multipliers(orbit),
        "log_multipliers": logs,
        "trivial_defect": orbit.floquet.trivial_defect,
        "liouville_defect": orbit.floquet.liouville_defect,
        "verdict": orbit.verdict().name(),
        "family": orbit.in_family,
        "method": orbit.method,
    })
}
