//! The description of a model, from which the page makes its controls.

use serde_json::Value;
use twinslip::error::Result;
use twinslip_tasks::scene::ModelDescription;

/// The description of the model that these words of a command line make, the command's name first.
///
/// # Errors
/// Those of the options.
pub fn model_description(words: &[String]) -> Result<Value> {
    let model = ModelDescription::of_words(&words[1..])?;
    Ok(serde_json::to_value(model).expect("a description can be written"))
}
