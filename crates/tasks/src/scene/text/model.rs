//! A user-defined system with what the command line says about it.

use super::file::SystemFile;
use super::forcing::{TimeIs, is_periodic, no_period};
use super::law_file::{DAMPING, DRIVING, LawFile, SCALES, STIFFNESS};
use super::options::TextOptions;
use super::slab::TextSlab;
use crate::scene::file::read_bounded;
use crate::scene::options::ModelOptions;
use crate::scene::program::{Program, Stretch};
use crate::scene::set::assignments;
use crate::scene::shipped::{law_names, shipped_law, shipped_system, shipped_system_names};
use crate::scene::system::Described;
use crate::scene::units::{Quantity, Units};
use serde_json::{Map, Value, json};
use std::borrow::Cow;
use std::path::Path;
use std::sync::{Mutex, PoisonError};
use twinslip::error::{Error, Result, did_you_mean};
use twinslip::field::Vector;
use twinslip::integrate::AnyField;
use twinslip::model::TextSystem;
use twinslip::number::{Interval, Uncertain};

/// No file is longer, in bytes.
const LONGEST: u64 = 1 << 16;

/// A user-defined system, or interfaces with a user-defined law; its parameters as they were set.
#[derive(Debug, Clone, PartialEq)]
pub struct TextModel {
    /// Its equations. Of interfaces the states are the stress and ln psi of each, and the first two parameters V_H and K.
    pub system: TextSystem,
    /// The interfaces, where it is these.
    pub slab: Option<TextSlab>,
    start: Vec<Option<f64>>,
    units: Units,
    echo: Map<String, Value>,
}

impl TextModel {
    /// The system that the options name, or the interfaces with the law that they name; `None` where all of that is built in. Of V_H and
    /// K those that are `free` need not be given: they then have values that must be set before they count.
    ///
    /// # Errors
    /// As [`TextModel::named`], and those of the options of interfaces.
    pub fn of(options: &ModelOptions, free: &[&str]) -> Result<Option<Self>> {
        Self::with_time(options, free, TimeIs::Phase)
    }

    /// The same of an initial value problem, whose formulas may name time.
    ///
    /// # Errors
    /// As of [`TextModel::of`].
    pub fn in_time(options: &ModelOptions, free: &[&str]) -> Result<Option<Self>> {
        Self::with_time(options, free, TimeIs::Time)
    }

    fn with_time(options: &ModelOptions, free: &[&str], time: TimeIs) -> Result<Option<Self>> {
        let law = match options.slab.law_file() {
            Some(path) => read_law(path)?,
            None if options.slab.text.system.is_some() => {
                return Self::read(&options.slab.text, time);
            }
            None if options.slab.has_clusters() || options.slab.needs_formulas(free)? => {
                built_in_law(&options.slab.law)?
            }
            None => return Ok(None),
        };
        let (slab, system) = TextSlab::new(law, options, (free, time))?;
        let mut echo = slab.echo(&system, &options.slab);
        // The unit of what varies is any value of it.
        for name in free.iter().filter(|name| SCALES.contains(name)) {
            echo.insert((*name).to_owned(), Value::Null);
        }
        let missing = [("driving", slab.driving), ("stiffness", slab.stiffness)];
        let mut model = TextModel {
            echo,
            start: Vec::new(),
            units: slab.units,
            slab: Some(slab),
            system,
        };
        // What is not given has no value, whatever stands in for it until it varies.
        for (name, _) in missing.iter().filter(|(_, given)| given.is_none()) {
            model.vary(name);
        }
        // So is that of damping, which a law has that has none.
        if free.contains(&DAMPING) {
            model.vary(DAMPING);
        }
        Ok(Some(model))
    }

    /// The system that the options name; `None` where they name none.
    ///
    /// # Errors
    /// [`Error::File`] for a file that can't be read, [`Error::Input`] for what is wrong in it, by line and column, and where a formula
    /// names time, and [`Error::Parameter`] for a parameter that it does not have.
    pub fn named(options: &TextOptions) -> Result<Option<Self>> {
        Self::read(options, TimeIs::Phase)
    }

    fn read(options: &TextOptions, time: TimeIs) -> Result<Option<Self>> {
        let Some(path) = &options.system else {
            return Ok(None);
        };
        let mut read = read(path)?;
        if let (TimeIs::Phase, Some(named)) = (time, &read.time) {
            let Some(forced) = read.forced.take() else {
                return Err(no_period(&called(path), named));
            };
            read.system = forced;
            read.start.push(Some(0.0));
        }
        for (name, value) in assignments(&options.set)? {
            if read.system.parameter_names().is_empty() {
                let what = format!("`set` {name}: the system {} has no parameters", read.name);
                return Err(Error::Input(what));
            }
            if !read.system.parameter_names().contains(&name) {
                return Err(Error::no_parameter(
                    "set",
                    name,
                    read.system.parameter_names(),
                ));
            }
            read.system.set(name, value)?;
        }
        if read.system.phase().is_some() {
            is_periodic(&read.system, &read.start)?;
        }
        let names = read.system.parameter_names().iter();
        let parameters: Map<String, Value> = names
            .zip(read.system.parameters())
            .map(|(name, value)| ((*name).to_owned(), json!(value)))
            .collect();
        let mut echo = Map::new();
        echo.insert("system".into(), json!(read.name));
        echo.insert("formulas".into(), json!(read.fingerprint));
        echo.insert("states".into(), json!(read.system.states()));
        echo.insert("parameters".into(), Value::Object(parameters));
        Ok(Some(TextModel {
            system: read.system,
            slab: None,
            start: read.start,
            units: Units::none(),
            echo,
        }))
    }

    /// The same with another system of these states.
    pub fn with(&self, system: TextSystem) -> Self {
        TextModel {
            system,
            ..self.clone()
        }
    }

    /// V_H of interfaces; 0 where nothing is driven.
    pub(in crate::scene) fn driving(&self) -> f64 {
        self.of_interfaces(DRIVING).unwrap_or(0.0)
    }

    /// K of interfaces; 0 where there are none.
    pub(in crate::scene) fn stiffness(&self) -> f64 {
        self.of_interfaces(STIFFNESS).unwrap_or(0.0)
    }

    /// The quantity that a state measures.
    pub fn quantity(&self, state: usize) -> Quantity {
        let layout = self.slab.as_ref().map(TextSlab::layout);
        layout.map_or(Quantity::Number, |layout| layout.quantity(state))
    }

    fn of_interfaces(&self, place: usize) -> Option<f64> {
        let slab = self.slab.as_ref();
        slab.map(|_| self.system.parameters()[place])
    }

    /// Takes the changes of V_H, of which the first may say which it is before.
    ///
    /// # Errors
    /// [`Error::Input`] for a system without V_H, and where V_H at the start is missing.
    pub(in crate::scene) fn programmed(&mut self, program: &Program) -> Result<()> {
        let Some(slab) = &self.slab else {
            return Err(Error::Input(
                "`program` changes the driving velocity of interfaces; a user-defined `system` has none".into(),
            ));
        };
        if slab.varies_in_time("driving") {
            return Err(Error::Input(
                "`program` and `modulate` driving both say how the driving velocity changes; give one of them".into(),
            ));
        }
        let inward = |v| self.units.inward(Quantity::SlipRate, v);
        let Some(first) = slab.driving.or(program.first().map(inward)) else {
            return Err(Error::Input(
                "`driving` V_H is missing: which velocity is it before the first change of `program`?"
                    .into(),
            ));
        };
        self.system
            .set(self.system.parameter_names()[DRIVING], first)?;
        let told = self
            .units
            .outward_uncertain(Quantity::SlipRate, Uncertain::new(first, 0.0));
        self.echo.insert("driving".into(), json!(told.value + 0.0));
        self.echo.insert("program".into(), json!(program.told()));
        Ok(())
    }

    /// The equations of a stretch of a run: on a ramp V_H is their last state.
    ///
    /// # Errors
    /// Those of the formulas.
    pub(in crate::scene) fn on(&self, stretch: &Stretch) -> Result<Cow<'_, TextSystem>> {
        let (rate, driving) = (stretch.rate(), stretch.driving.0);
        let slab = self.slab.as_ref();
        let Some(slab) = slab.filter(|_| rate != 0.0 || driving != self.driving()) else {
            return Ok(Cow::Borrowed(&self.system));
        };
        if rate != 0.0 {
            return slab.on_ramp(&self.system, rate).map(Cow::Owned);
        }
        let mut system = self.system.clone();
        system.set(system.parameter_names()[DRIVING], driving)?;
        Ok(Cow::Owned(system))
    }

    /// What it is called.
    pub fn name(&self) -> &str {
        let of = |key: &str| self.echo.get(key).and_then(Value::as_str);
        of("system").or(of("law")).unwrap_or_default()
    }

    /// Tells that a parameter varies: it has no one value.
    pub(in crate::scene) fn vary(&mut self, name: &str) {
        for key in ["parameters", name] {
            match self.echo.get_mut(key) {
                Some(Value::Object(all)) if all.contains_key(name) => {
                    all.insert(name.to_owned(), Value::Null);
                }
                Some(value) if key == name => *value = Value::Null,
                _ => (),
            }
        }
    }

    /// Its field.
    ///
    /// # Errors
    /// Those of [`AnyField::of_text`].
    pub fn field(&self) -> Result<AnyField<'_>> {
        AnyField::of_text(Cow::Borrowed(&self.system))
    }

    /// The values of all variables where the states have these: time is one, where formulas name it.
    pub(in crate::scene) fn at_time(&self, states: Vector, time: f64) -> Vector {
        match self.system.is_timed() {
            true => states.push(time),
            false => states,
        }
    }

    /// The values of all states of interfaces: under a forcing its phase is 0.
    pub(in crate::scene) fn at_phase_0(&self, mut start: Vec<f64>) -> Vector {
        start.extend(self.system.phase().map(|_| 0.0));
        Vector::from_vec(start)
    }

    /// The values of all states: those of a text, or of the file where none is given. Of interfaces the text has tau and psi, as that of
    /// those that are built in, or says that they start near the symmetric steady state, as where none is given.
    ///
    /// # Errors
    /// [`Error::Input`] for a text that can't be read, and for a state without a start; [`Error::Parameter`] for a psi that is not positive,
    /// and [`Error::NotConverged`] where the law has no steady state.
    pub fn start(&self, text: Option<&str>) -> Result<Vector> {
        self.start_but(text, &[])
    }

    /// The same, where states at these places need none: theirs is then 0.
    ///
    /// # Errors
    /// As [`TextModel::start`].
    pub(in crate::scene) fn start_but(&self, text: Option<&str>, free: &[usize]) -> Result<Vector> {
        if let Some(slab) = &self.slab {
            return Ok(self.at_phase_0(slab.start(text, &self.system)?));
        }
        let states = self.system.states();
        let Some(text) = text else {
            let start = states.iter().zip(&self.start).enumerate();
            let value = |(place, (state, value)): (usize, (&&str, &Option<f64>))| {
                value.or(free.contains(&place).then_some(0.0)).ok_or_else(|| {
                    Error::Input(format!(
                        "the state {state} has no start: give `start` {}, or {state} = ... in [start] of the file",
                        states.join(",").to_uppercase()
                    ))
                })
            };
            let start: Result<Vec<f64>> = start.map(value).collect();
            return Ok(Vector::from_vec(start?));
        };
        let number = |part: &str| {
            number(part).ok_or_else(|| {
                Error::Input(format!("`start` {text:?}: {part:?} is not a finite number"))
            })
        };
        let start: Result<Vec<f64>> = text.split(',').map(number).collect();
        let mut start = start?;
        // The phase may be left out: it is 0.
        if self.system.phase().is_some() && start.len() + 1 == states.len() {
            start.push(0.0);
        }
        if start.len() != states.len() {
            return Err(Error::Input(format!(
                "`start` {text:?} must have {} values, one for each of {}",
                states.len(),
                states.join(", ")
            )));
        }
        Ok(Vector::from_vec(start))
    }

    /// A box with the steady states of interfaces: what stress and states have at rates from a small part of V_H to all of it.
    pub(in crate::scene) fn steady_box(&self) -> Result<Vec<Interval>> {
        match &self.slab {
            Some(slab) => slab.steady_box(&self.system),
            None => Ok(Vec::new()),
        }
    }

    /// The place of the state of this name.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a name that is none.
    pub fn state(&self, option: &str, name: &str) -> Result<usize> {
        let states = self.system.states();
        let place = states.iter().position(|state| *state == name);
        place.ok_or_else(|| Error::unknown(option, name, states))
    }
}

impl Described for TextModel {
    fn echo(&self) -> &Map<String, Value> {
        &self.echo
    }

    fn units(&self) -> &Units {
        &self.units
    }
}

/// A finite number.
pub(super) fn number(text: &str) -> Option<f64> {
    text.trim().parse::<f64>().ok().filter(|x| x.is_finite())
}

/// What is given in place of a file's name: a text of several lines, which no name has.
pub(in crate::scene) fn given_text(word: &Path) -> Option<&str> {
    word.to_str().filter(|text| text.contains('\n'))
}

/// Such a text, unless it is longer than a file may be; `name` is what messages call it.
fn bounded<'a>(name: &str, text: &'a str) -> Result<&'a str> {
    if text.len() as u64 > LONGEST {
        let what = format!("{name}: its text is longer than {LONGEST} bytes");
        return Err(Error::Input(what));
    }
    Ok(text)
}

/// What messages call the file of a system, or its text.
fn called(path: &Path) -> String {
    match given_text(path) {
        Some(_) => "the system".into(),
        None => path.display().to_string(),
    }
}

/// The system of a file, of the one that is built in, or of the text itself.
fn read(path: &Path) -> Result<SystemFile> {
    parsed(&called(path), &system_text(path)?)
}

/// The text of a system: what the file holds, or where there is none of that name the system that is built in; or the text itself.
///
/// # Errors
/// [`Error::File`] for a file that can't be read; [`Error::Input`] for a name that is neither, and for a text that is too long.
pub(in crate::scene) fn system_text(path: &Path) -> Result<Cow<'_, str>> {
    let name = called(path);
    if let Some(text) = given_text(path) {
        return Ok(bounded(&name, text)?.into());
    }
    if path.exists() {
        return Ok(read_bounded(path, LONGEST)?.into());
    }
    if let Some(text) = shipped_system(path) {
        return Ok(text.into());
    }
    let known = shipped_system_names();
    let hint = did_you_mean(&name, known.iter().copied());
    Err(Error::Input(format!(
        "`system` {name}: there is no such file, and no built-in system of this name; those are {}{hint}",
        known.join(", ")
    )))
}

/// The system of a text. The last ones are kept: a short run takes no longer than to read its text.
fn parsed(name: &str, text: &str) -> Result<SystemFile> {
    const KEPT: usize = 8;
    /// Each with its text, the last one that was asked for first.
    static LAST: Mutex<Vec<(String, SystemFile)>> = Mutex::new(Vec::new());
    let last = || LAST.lock().unwrap_or_else(PoisonError::into_inner);
    {
        let mut last = last();
        if let Some(at) = last.iter().position(|(known, _)| known == text) {
            last[..=at].rotate_right(1);
            return Ok(last[0].1.clone());
        }
    }
    let system = SystemFile::parse(name, text)?;
    let mut last = last();
    last.truncate(KEPT - 1);
    last.insert(0, (text.to_owned(), system.clone()));
    Ok(system)
}

/// The formulas of a law that is built in, with its own constants.
fn built_in_law(name: &str) -> Result<LawFile> {
    let text = shipped_law(Path::new(name));
    LawFile::parse(
        name,
        text.ok_or_else(|| Error::unknown("law", name, &law_names()))?,
    )
}

/// What messages call the file of a law, or its text.
fn law_called(path: &Path) -> String {
    match given_text(path) {
        Some(_) => "the law".into(),
        None => path.display().to_string(),
    }
}

/// The law of a file, of the one that the program carries, or of the text itself.
pub(super) fn read_law(path: &Path) -> Result<LawFile> {
    LawFile::parse(&law_called(path), &law_text(path)?)
}

/// The text of a law: what the file holds, or where there is none of that name the one that the program carries; or the text itself.
///
/// # Errors
/// As of [`system_text`].
pub(in crate::scene) fn law_text(path: &Path) -> Result<Cow<'_, str>> {
    if let Some(text) = given_text(path) {
        return Ok(bounded(&law_called(path), text)?.into());
    }
    match shipped_law(path) {
        Some(text) if !path.exists() => Ok(text.into()),
        _ => Ok(read_bounded(path, LONGEST)?.into()),
    }
}
