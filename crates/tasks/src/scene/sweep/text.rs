//! A system, or interfaces with a law, from a file, at the points of a grid of any of its parameters.

use super::axes::Axes;
use super::interfaces::{PATIENCE, is_loading};
use super::options::SweepOptions;
use crate::scene::options::ModelOptions;
use crate::scene::section::phase_of_section;
use crate::scene::system::Described;
use crate::scene::text::TextModel;
use crate::scene::units::Quantity;
use std::borrow::Cow;
use twinslip::error::{Error, Result};
use twinslip::field::Vector;
use twinslip::friction::positive;
use twinslip::integrate::{AnyField, MotionUnits};
use twinslip::number::polynomial::Crossing;
use twinslip::random::Random;
use twinslip::section::{Surface, usual_patience};
use twinslip::sweep::{Enclosure, SectionPlace, SystemPoint, SystemPoints, start_of_interfaces};

/// Periods of a forcing in which its phase comes again for certain.
const WAITED: f64 = 2.0;

/// A system from a file of which some parameters vary.
#[derive(Debug)]
pub(super) struct TextPoints {
    model: TextModel,
    names: Vec<String>,
    /// Of a system where its first run starts, and which section it has.
    begins: Option<(Vector, SectionPlace)>,
}

impl TextPoints {
    /// Interfaces with a law from a file; `None` where the law is built in.
    ///
    /// # Errors
    /// Those of the law's file and of the options.
    pub fn of_law(options: &SweepOptions, axes: &Axes) -> Result<Option<Self>> {
        let mut free = vec!["driving", "stiffness"];
        free.extend(axes.names.iter().map(String::as_str));
        let mut asked = ModelOptions {
            driving: axes.driving,
            stiffness: axes.stiffness,
            slab: options.slab.clone(),
        };
        for name in &axes.names {
            asked.slab.hold_healing_time(name)?;
        }
        let Some(model) = TextModel::of(&asked, &free)? else {
            return Ok(None);
        };
        axes.needs_loading()?;
        let two = options.slab.count() == 2;
        let known = model.system.parameter_names();
        for (name, range) in axes.names.iter().zip(&axes.ranges) {
            let of_one = ["_1", "_2"].iter().find_map(|end| name.strip_suffix(end));
            let of_one = of_one.filter(|base| two && !is_loading(base) && known.contains(base));
            if of_one.is_none() && !known.contains(&name.as_str()) {
                return Err(Error::unknown("grid", name, known));
            }
            if is_loading(name) {
                for end in [range.from, range.to] {
                    positive(name, end)?;
                }
            } else {
                // What one interface has of its own becomes a parameter of the system.
                asked.slab.text.set.push(format!("{name}={:?}", range.from));
            }
        }
        let model = TextModel::of(&asked, &free)?;
        Ok(model.map(|model| TextPoints {
            model,
            names: axes.names.clone(),
            begins: None,
        }))
    }

    /// A system; states that are free need no start.
    ///
    /// # Errors
    /// [`Error::Input`] and [`Error::Parameter`] for what it does not have, and for a system of one state.
    pub fn of_system(
        options: &SweepOptions,
        model: TextModel,
        (axes, free): (&Axes, &[usize]),
    ) -> Result<Self> {
        let known = model.system.parameter_names();
        if options.driving.is_some() || options.stiffness.is_some() {
            return Err(Error::Input(
                "`driving` and `stiffness` belong to interfaces; for a `system` give what varies by `grid` NAME=A:B:N".into(),
            ));
        }
        if axes.names.is_empty() && !options.basin {
            return Err(Error::Input(format!(
                "`grid` NAME=A:B:N is missing: which parameter of {} varies? They are {}",
                model.name(),
                known.join(", ")
            )));
        }
        for name in &axes.names {
            if !known.contains(&name.as_str()) {
                return Err(Error::unknown("grid", name, known));
            }
        }
        let states = model.system.states();
        if states.len() < 2 {
            return Err(Error::Input(
                "a system of one state has no return map: it never comes back".into(),
            ));
        }
        let section = section(options.surface.as_deref(), &model)?;
        Ok(TextPoints {
            begins: Some((model.start_but(options.start.as_deref(), free)?, section)),
            names: axes.names.clone(),
            model,
        })
    }

    /// How many parts slide.
    pub fn parts(&self) -> usize {
        let slab = self.model.slab.as_ref();
        slab.map_or(0, |slab| slab.clusters().len())
    }

    /// What it is, at the first point.
    pub fn model(&self) -> &TextModel {
        &self.model
    }

    /// The place of the state that the section is in.
    pub fn section_state(&self) -> usize {
        if self.model.system.phase().is_some() {
            return 0;
        }
        match &self.begins {
            Some((_, SectionPlace::Middle(state))) => *state,
            Some((_, SectionPlace::Known(surface, _) | SectionPlace::Untimed(surface))) => {
                surface.normal.iamax()
            }
            None => 0,
        }
    }
}

/// Where the section of a system is.
fn section(text: Option<&str>, model: &TextModel) -> Result<SectionPlace> {
    let state = |name: &str| model.state("the state of `surface`", name.trim());
    if let Some(phase) = model.system.phase() {
        let value = text.map_or(Ok(0.0), phase_of_section)?;
        let states = model.system.states().len();
        return Ok(SectionPlace::Untimed(Surface::stroboscopic(
            states, phase, value,
        )));
    }
    let Some(text) = text else {
        return Ok(SectionPlace::Middle(0));
    };
    let Some((name, value)) = text.split_once('=') else {
        return Ok(SectionPlace::Middle(state(text)?));
    };
    let value = value.trim().parse::<f64>().ok().filter(|x| x.is_finite());
    let value = value.ok_or_else(|| {
        Error::Input(format!(
            "`surface` {text:?} must be STATE=VALUE, or STATE alone"
        ))
    })?;
    let states = model.system.states().len();
    Ok(SectionPlace::at(state(name)?, states, value))
}

impl SystemPoints for TextPoints {
    fn parameters(&self, values: &[f64]) -> Vec<f64> {
        let axes = self.names.iter().zip(values);
        if self.model.slab.is_none() {
            return values.to_vec();
        }
        let system = &self.model.system;
        let fixed = system.parameter_names().iter().zip(system.parameters());
        let units = self.model.units();
        let of = |name: &str| {
            let varies = axes.clone().find(|(known, _)| *known == name);
            let varies =
                varies.map(|(_, value)| units.inward(Quantity::of_parameter(name), *value));
            let fixed = || fixed.clone().find(|(known, _)| **known == name);
            varies.or_else(|| fixed().map(|(_, value)| *value))
        };
        let loading = ["driving", "stiffness"].into_iter().filter_map(of);
        let others = axes.clone().filter(|(name, _)| !is_loading(name));
        loading.chain(others.map(|(_, value)| *value)).collect()
    }

    fn at(&self, values: &[f64], start: usize, mut random: Random) -> Result<SystemPoint> {
        let mut system = self.model.system.clone();
        for (name, &value) in self.names.iter().zip(values) {
            let quantity = match self.model.slab {
                Some(_) => Quantity::of_parameter(name),
                None => Quantity::Number,
            };
            system.set(name, self.model.units().inward(quantity, value))?;
        }
        let mut units = MotionUnits::given(system.states().len());
        let (begin, section, equal_parts) = match (&self.begins, &self.model.slab) {
            (Some((first, section)), _) => {
                units = MotionUnits::measured(&system, first)?.rounded();
                let mut begin = units.inward(first);
                if start > 0 {
                    let phase = system.phase().map(|(place, _)| place);
                    for (_, x) in begin
                        .iter_mut()
                        .enumerate()
                        .filter(|(i, _)| Some(*i) != phase)
                    {
                        *x += random.between((-1.0, 1.0)) * (1.0 + x.abs());
                    }
                }
                let mut section = section.clone().inward(&units);
                if let SectionPlace::Untimed(surface) = &section
                    && let Some(period) = system.forcing_period()
                {
                    section = SectionPlace::Known(surface.clone(), WAITED * period / units.time);
                }
                (begin, section, false)
            }
            (None, Some(slab)) => {
                let stress = slab.mean_stress(&system)?;
                let mut begin = match start {
                    0 => slab.start(None, &system)?,
                    kind => {
                        let steady = slab.start(Some("near-symmetric:0"), &system)?;
                        let (states, others) = steady[1..].split_at(slab.layout().parts);
                        let mut begin = start_of_interfaces(kind, random, stress, states);
                        begin.extend_from_slice(others);
                        begin
                    }
                };
                let [driving, stiffness, ..] = system.parameters() else {
                    unreachable!("interfaces have V_H and K");
                };
                let (surface, patience) = match (system.phase(), system.forcing_period()) {
                    (Some(phase), Some(period)) => {
                        begin.push(0.0);
                        let surface = Surface::stroboscopic(begin.len(), phase, 0.0);
                        (surface, WAITED * period)
                    }
                    _ => (
                        Surface::stress(begin.len(), stress, Crossing::Downwards),
                        PATIENCE * usual_patience(*driving, *stiffness),
                    ),
                };
                let section = SectionPlace::Known(surface, patience);
                let equal_parts = slab.are_equal(&system) && system.phase().is_none();
                (Vector::from_vec(begin), section, equal_parts)
            }
            (None, None) => unreachable!("a system has a start"),
        };
        let system = units.inward_system(&system)?;
        Ok(SystemPoint {
            units,
            // Under a forcing nothing rests.
            enclosed: match system.phase() {
                None => Some(Enclosure(Box::new(system.clone()))),
                Some(_) => None,
            },
            field: AnyField::of_text(Cow::Owned(system))?,
            start: begin,
            section,
            equal_parts,
            lane: None,
        })
    }
}
