//! User-defined systems.

use super::parameters::around;
use super::surface::surface;
use super::{ModelDescription, ModelKind, ParameterDescription, StateDescription};
use crate::scene::locus::CurveChoice;
use crate::scene::options::ModelOptions;
use crate::scene::text::{TextModel, remarks, system_text};
use std::path::Path;
use twinslip::error::{Error, Result};

/// Describes the system of these options, of a file, a built-in one or a text.
///
/// # Errors
/// Those of the system.
pub(super) fn described(options: &ModelOptions, path: &Path) -> Result<ModelDescription> {
    let text = system_text(path)?;
    let model = TextModel::in_time(options, &[])?;
    let model = model.ok_or_else(|| Error::Input("`system` names no system".into()))?;
    let system = &model.system;
    let remarks = remarks(&text);
    let names = system.parameter_names().iter();
    let parameters = names.zip(system.parameters()).map(|(&name, &value)| {
        let (range, log) = around(value);
        ParameterDescription {
            name: name.to_owned(),
            symbol: name.to_owned(),
            meaning: remarks.get(name).cloned().unwrap_or_default(),
            unit: None,
            value,
            option: false,
            range: [range.0, range.1],
            log,
            positive: false,
            integer: false,
        }
    });
    let parameters: Vec<ParameterDescription> = parameters.collect();
    let axes = parameters.iter().take(2).map(|one| one.name.clone());
    let states = system.states().iter().map(|&name| StateDescription {
        name: name.into(),
        label: name.to_owned(),
        unit: None,
    });
    // Branches and sections take formulas of time that are periodic in it, and no others.
    let timed = system.is_timed();
    let forced = TextModel::of(options, &[]).ok().flatten();
    let rests = forced.is_none_or(|model| model.system.phase().is_none());
    let variables = system.states().len();
    let loci = match () {
        () if parameters.len() < 2 => Vec::new(),
        () if !rests => CurveChoice::of_forced(variables),
        () if timed => Vec::new(),
        () => CurveChoice::of_system(variables, true, [false; 2]),
    };
    Ok(ModelDescription {
        kind: ModelKind::System,
        title: model.name().to_owned(),
        states: states.collect(),
        axes: axes.collect(),
        laws: Vec::new(),
        symmetries: Vec::new(),
        interfaces: None,
        loci,
        rests,
        surface: match timed {
            true => None,
            false => surface(&model),
        },
        duration: match timed {
            true => None,
            false => duration(&model),
        },
        si: false,
        time_unit: None,
        parameters,
        text: Some(text.into_owned()),
    })
}

/// A hundred times as long as the system takes to move by about 1 in its own units.
fn duration(model: &TextModel) -> Option<f64> {
    let start = model.start(None).ok()?;
    let units = model.motion_units_of_run(&start).ok()?;
    Some(100.0 * units.time).filter(|duration| duration.is_finite() && *duration > 0.0)
}
