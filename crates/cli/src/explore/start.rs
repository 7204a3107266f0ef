//! The answers to what the page shows first, for a page that is saved without having been opened: the commands are those that the page asks
//! for, under the names of its places (`page/app.js`, `page/requests.js`).

use super::model;
use super::outbox::Outbox;
use super::queue::Queue;
use super::request::{number_text, words};
use super::work::{Work, begin};
use crate::failure::Failure;
use serde_json::{Map, Value, json};
use std::sync::Arc;
use std::thread;
use std::time::Duration;
use twinslip::error::Result;

/// Steps of a run of a user-defined system, at least.
const STEPS: f64 = 600.0;
/// Between two looks at what is done.
const GLANCE: Duration = Duration::from_millis(10);

type Options = Map<String, Value>;

/// The recording of a page that begins with these options of a model: the lines of each answer by its place. `reached` is told what
/// part of them is there.
///
/// # Errors
/// Those of the model.
pub fn recording(given: &Options, mut reached: impl FnMut(f64)) -> Result<Value> {
    let queue = Arc::new(Queue::new());
    let mut all = Map::new();
    let model = model::model_description(&words("orbit", given)?)?;
    all.insert(
        "model".into(),
        json!([{"object": model}, {"ended": "done"}]),
    );
    let scene = Scene {
        given,
        model: &model,
    };
    let first = answers(&queue, scene.first(), &mut |_| {});
    let until = scene.until(&first);
    all.extend(first);
    let rest = answers(&queue, scene.rest(until), &mut reached);
    all.extend(rest);
    if let Some(asked) = scene.around(&all) {
        all.extend(answers(&queue, vec![asked], &mut |_| {}));
    }
    Ok(Value::Object(all))
}

/// A command of the page: its place, its name and its options.
type Asked = (String, &'static str, Options);

/// The lines of the answers to these, several at a time.
fn answers(queue: &Arc<Queue>, asked: Vec<Asked>, reached: &mut dyn FnMut(f64)) -> Options {
    let begun = |(place, command, options): Asked| {
        let outbox = Arc::new(Outbox::new(true, None));
        match Work::new(command, &options) {
            // There is room for all.
            Ok(work) => drop(begin(queue, &outbox, work)),
            Err(error) => outbox.end(Err(Failure::of(&error))),
        }
        (place, outbox, Vec::new(), false)
    };
    let mut all: Vec<(String, Arc<Outbox>, Vec<u8>, bool)> = asked.into_iter().map(begun).collect();
    let count = all.len();
    while all.iter().any(|one| !one.3) {
        for (_, outbox, text, ended) in all.iter_mut().filter(|one| !one.3) {
            let (more, last) = outbox.take();
            text.extend(more);
            *ended = last;
        }
        reached(all.iter().filter(|one| one.3).count() as f64 / count as f64);
        thread::sleep(GLANCE);
    }
    let lines = |text: Vec<u8>| -> Vec<Value> {
        let lines = text.split(|&byte| byte == b'\n');
        let mut lines: Vec<Value> = lines
            .filter_map(|line| serde_json::from_slice(line).ok())
            .collect();
        lines.retain(|line| line.get("reached").is_none());
        lines
    };
    all.into_iter()
        .map(|(place, _, text, _)| (place, json!(lines(text))))
        .collect()
}

/// The scene that the page begins with.
struct Scene<'a> {
    given: &'a Options,
    model: &'a Value,
}

impl Scene<'_> {
    fn parameters(&self) -> impl Iterator<Item = &Value> {
        self.model["parameters"].as_array().into_iter().flatten()
    }

    fn parameter(&self, name: &str) -> Option<&Value> {
        self.parameters().find(|one| one["name"] == name)
    }

    fn axes(&self) -> Vec<&str> {
        let axes = self.model["axes"].as_array().into_iter().flatten();
        axes.filter_map(Value::as_str).collect()
    }

    /// The options of the system at the point, without these parameters.
    fn system(&self, without: &[&str]) -> Options {
        let mut options: Options = self.given.clone();
        let given_set = self
            .given
            .get("set")
            .and_then(Value::as_array)
            .cloned()
            .unwrap_or_default();
        let plain = self.model["options"].as_array().into_iter().flatten();
        let plain: Vec<&str> = plain.filter_map(Value::as_str).collect();
        options.retain(|name, _| plain.contains(&name.as_str()));
        let name_of = |set: &Value| {
            let text = set.as_str().unwrap_or_default();
            text.split('=').next().unwrap_or_default().trim().to_owned()
        };
        let mut set = Vec::new();
        for one in self.parameters() {
            let name = one["name"].as_str().unwrap_or_default();
            let begun =
                self.given.contains_key(name) || given_set.iter().any(|set| name_of(set) == name);
            if without.contains(&name) || !(self.axes().contains(&name) || begun) {
                continue;
            }
            match one["option"] == true {
                true => drop(options.insert(name.into(), one["value"].clone())),
                false => set.push(json!(format!("{name}={}", shown(&one["value"])))),
            }
        }
        let others = given_set.into_iter().filter(|set| {
            let name = name_of(set);
            self.parameter(&name).is_none() && !without.contains(&name.as_str())
        });
        set.extend(others);
        if !set.is_empty() {
            options.insert("set".into(), json!(set));
        }
        options
    }

    /// The range of an axis as `NAME=A:B`; of a parameter that must be positive it begins above 0.
    fn range(&self, name: &str) -> String {
        /// Part of the end of such a range.
        const LEAST: f64 = 0.02;
        let one = self.parameter(name).unwrap_or(&Value::Null);
        let end = |at: usize| one["range"][at].as_f64().unwrap_or_default();
        let least = match end(0) {
            lo if lo <= 0.0 && one["positive"] == true => LEAST * end(1),
            lo => lo,
        };
        format!("{name}={}:{}", shown(&json!(least)), shown(&json!(end(1))))
    }

    /// Whether there may be equilibria.
    fn rests(&self) -> bool {
        self.model["rests"] == true
    }

    /// What says how long a run is shown.
    fn first(&self) -> Vec<Asked> {
        let orbit = with(self.system(&[]), [("crosscheck", json!("none"))]);
        let mut all: Vec<Asked> = vec![("orbit:0".into(), "orbit", orbit)];
        if self.rests() {
            all.insert(0, ("equilibria:0".into(), "equilibria", self.system(&[])));
        }
        all
    }

    fn rest(&self, until: Option<f64>) -> Vec<Asked> {
        let mut all: Vec<Asked> = Vec::new();
        if let Some(until) = until {
            let mut run = with(
                self.system(&[]),
                [("until", json!(until)), ("plot", json!(true))],
            );
            if self.model["kind"] == "system" {
                run.insert("max_step".into(), json!(to_three_digits(until / STEPS)));
            }
            all.push(("run:0".into(), "integrate", run));
        }
        let section = [
            ("returns", json!(600)),
            ("skip", json!(400)),
            ("lyapunov", json!(true)),
            ("plot", json!(true)),
            ("surface", self.model["surface"].clone()),
        ];
        all.push((
            "section:0".into(),
            "section",
            with(self.system(&[]), section),
        ));
        let axes = self.axes();
        for (which, along) in ["x", "y"].into_iter().zip(&axes) {
            let kinds: &[&str] = if self.rests() {
                &["equilibria", "orbits"]
            } else {
                &["orbits"]
            };
            for of in kinds {
                let options = [("of", json!(of)), ("along", json!(self.range(along)))];
                all.push((
                    format!("branch:{which}:{of}"),
                    "branch",
                    with(self.system(&[along]), options),
                ));
            }
        }
        if let [x, y] = axes[..] {
            for kind in self.model["loci"].as_array().into_iter().flatten() {
                let within = format!("{},{}", self.range(x), self.range(y));
                let options = [("of", kind.clone()), ("in", json!(within))];
                let place = format!("locus:{}", kind.as_str().unwrap_or_default());
                all.push((place, "locus", with(self.system(&[x, y]), options)));
            }
        }
        all
    }

    /// How long a run is shown: some periods of the orbit, or some times of what grows or decays most slowly.
    fn until(&self, first: &Options) -> Option<f64> {
        let result = |place: &str| {
            let lines = first.get(place).and_then(Value::as_array);
            let object = lines
                .into_iter()
                .flatten()
                .find_map(|line| line.get("object"));
            object.map_or(Value::Null, |object| object["result"].clone())
        };
        let period = &result("orbit:0")["orbit"]["period"];
        if let Some(period) = period
            .as_f64()
            .or(period["value"].as_f64())
            .filter(|&x| x > 0.0)
        {
            return Some(rounded(8.0 * period));
        }
        let eigenvalues = result("equilibria:0")["equilibria"][0]["eigenvalues"].clone();
        let parts = |at: usize| {
            let all = eigenvalues.as_array().into_iter().flatten();
            all.filter_map(move |pair| pair[at].as_f64().map(f64::abs))
                .collect::<Vec<_>>()
        };
        let fastest = parts(1).into_iter().fold(0.0, f64::max);
        let slowest = parts(0)
            .into_iter()
            .filter(|&x| x > 0.0)
            .fold(f64::INFINITY, f64::min);
        let slow = if slowest.is_finite() {
            8.0 / slowest
        } else {
            0.0
        };
        let turning = if fastest > 0.0 {
            24.0 * std::f64::consts::PI / fastest
        } else {
            0.0
        };
        let until = match (slow > 0.0, turning > 0.0) {
            (true, true) => slow.max(turning).min(10.0 * turning),
            (false, false) => self.model["duration"].as_f64()?,
            _ => slow.max(turning),
        };
        Some(rounded(until))
    }

    /// All equilibria in a box around the run, for systems whose equilibria are found near a start alone.
    fn around(&self, all: &Options) -> Option<Asked> {
        let lines = all
            .get("run:0")?
            .as_array()
            .filter(|_| self.model["kind"] == "system" && self.rests())?;
        let columns = lines
            .iter()
            .find_map(|line| line.get("columns"))?
            .as_array()?;
        let rows = || {
            lines
                .iter()
                .filter_map(|line| line.get("rows")?.as_array())
                .flatten()
        };
        let side = |state: &Value| {
            let at = columns.iter().position(|column| *column == state["name"])?;
            let numbers = rows().filter_map(|row| row[at].as_f64());
            let (lo, hi) = numbers.fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), x| {
                (lo.min(x), hi.max(x))
            });
            let (half, name) = (0.5 * (hi - lo), state["name"].as_str()?);
            // Digits that the width has, however far from 0 the box is.
            let unit = 10f64.powf((hi - lo).log10().floor() - 1.0);
            let digits = |count: f64| format!("{:.11e}", count * unit).parse::<f64>();
            let ends = [((lo - half) / unit).floor(), ((hi + half) / unit).ceil()];
            let [Ok(from), Ok(to)] = ends.map(digits) else {
                return None;
            };
            (half > 0.0).then(|| format!("{name}={from}:{to}"))
        };
        let states = self.model["states"]
            .as_array()
            .filter(|states| states.len() <= 6)?;
        let sides: Vec<String> = states.iter().map(side).collect::<Option<_>>()?;
        let options = with(self.system(&[]), [("box", json!(sides.join(",")))]);
        Some(("equilibria:0".into(), "equilibria", options))
    }
}

fn with<const N: usize>(mut options: Options, more: [(&str, Value); N]) -> Options {
    options.extend(more.map(|(name, value)| (name.to_owned(), value)));
    options
}

/// A number as a page writes it.
fn shown(number: &Value) -> String {
    number.as_number().map_or_else(String::new, number_text)
}

/// The longest step of a run as the page has it.
fn to_three_digits(x: f64) -> f64 {
    format!("{x:.2e}").parse().unwrap_or(x)
}

/// Two digits are enough for what is only shown.
fn rounded(x: f64) -> f64 {
    format!("{x:.1e}").parse().unwrap_or(x)
}
