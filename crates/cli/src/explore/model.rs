//! The description of a model, from which the page makes its controls.

use super::begin::MODEL;
use crate::catalogue::options;
use serde_json::{Value, json};
use twinslip::error::Result;
use twinslip_tasks::scene::ModelDescription;

/// The description of the model that these words of a command line make, the command's name first; with `options`, the names of those that
/// make a model and are no parameters.
///
/// # Errors
/// Those of the options.
pub fn model_description(words: &[String]) -> Result<Value> {
    let model = ModelDescription::of_words(&words[1..])?;
    let is_parameter = |name: &str| model.parameters.iter().any(|one| one.name == name);
    let all = options("orbit").into_iter();
    let own = all.filter(|option| MODEL.contains(&option.heading.as_str()) && !option.repeated);
    let names = own.map(|option| option.name.replace('-', "_"));
    let names: Vec<String> = names.filter(|name| !is_parameter(name)).collect();
    let mut description = serde_json::to_value(&model).expect("a description can be written");
    description["options"] = json!(names);
    Ok(description)
}
