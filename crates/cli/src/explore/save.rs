//! The page as one file that needs no server: script, styles, and the answers to what it shows.

use super::{assets, bundle};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde::de::IgnoredAny;
use serde_json::Value;
use sha2::{Digest, Sha256};
use std::collections::BTreeMap;

/// What a page keeps of itself.
#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct Content {
    /// The lines of each answer, by the name of its place on the page.
    #[serde(rename = "recording")]
    _recording: BTreeMap<String, IgnoredAny>,
    /// What is looked at.
    #[serde(default, rename = "state")]
    _state: IgnoredAny,
}

/// The page with this content, a JSON object of `recording` and `state`; `begin` is what the page begins with.
///
/// # Errors
/// A sentence for what is no such object.
pub fn saved_page(begin: &Value, content: &str) -> Result<String, String> {
    let _: Content = serde_json::from_str(content).map_err(|error| {
        format!("the content of a page is an object of recording and state: {error}")
    })?;
    let script = bundle::bundle(&assets::modules(), assets::MAIN)?;
    let (script, style) = (closed(&script, "script"), closed(&assets::style(), "style"));
    let policy = format!(
        "default-src 'none'; script-src 'sha256-{}'; style-src 'sha256-{}'; img-src data: blob:; base-uri 'none'; form-action 'none'",
        hash(&script),
        hash(&style)
    );
    // The content goes in as it came: it may be large.
    let mut told = begin.to_string();
    told.pop();
    let between = if told.ends_with('{') { "" } else { "," };
    let told = in_script(&format!("{told}{between}\"saved\":{content}}}"));
    let page = assets::index();
    let mut page = page.into_owned();
    let parts = [
        (
            STYLE,
            format!(
                "<meta http-equiv=\"Content-Security-Policy\" content=\"{policy}\">\n<style>{style}</style>"
            ),
        ),
        (BEGIN, begin_element(&told)),
        (SCRIPT, String::new()),
        ("</body>", format!("<script>{script}</script>\n</body>")),
    ];
    for (part, instead) in parts {
        let (before, after) = page
            .split_once(part)
            .ok_or(format!("the page lacks {part}"))?;
        page = [before, &instead, after].concat();
    }
    Ok(page)
}

/// The parts of the page that others stand in place of.
const STYLE: &str = "<link rel=\"stylesheet\" href=\"style.css\">";
const SCRIPT: &str = "<script src=\"explore.js\" defer></script>";
pub const BEGIN: &str = "<script type=\"application/json\" id=\"begin\"></script>";

/// The element with what the page begins with.
pub fn begin_element(json: &str) -> String {
    format!("<script type=\"application/json\" id=\"begin\">{json}</script>")
}

/// JSON that stands in a script, which it must not end; a `<` is in texts alone.
pub fn in_script(json: &str) -> String {
    json.replace('<', "\\u003c")
}

/// A text that does not end the element that it stands in.
fn closed(text: &str, element: &str) -> String {
    text.replace(&format!("</{element}"), &format!("<\\/{element}"))
        .replace("<!--", "<\\!--")
}

fn hash(text: &str) -> String {
    STANDARD.encode(Sha256::digest(text))
}
