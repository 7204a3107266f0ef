//! Which parameters vary over a grid, and between which values.

use super::super::options::SlabOptions;
use super::super::set::NAMES;
use super::super::unequal::of_one;
use super::grain::Grain;
use super::options::SweepOptions;
use twinslip::error::{Error, Result};
use twinslip::sweep::Range;

/// A grid has no more axes.
const MOST: usize = 2;
/// In SI the unit of stress changes with it.
const DIRECT_EFFECT: &str = "direct_effect";
/// The parameters of the first interface that units are made of.
const UNITS: [&str; 3] = ["slip_length", "normal_stress", DIRECT_EFFECT];

/// Whether the units of other numbers are made of a parameter.
fn sets_units(name: &str) -> bool {
    UNITS.contains(&name.strip_suffix("_1").unwrap_or(name))
}

/// The parameters that vary, the first fastest, and of V_H and K those that are fixed; all in the user's units.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Axes {
    pub names: Vec<String>,
    pub ranges: Vec<Range>,
    pub driving: Option<f64>,
    pub stiffness: Option<f64>,
    /// The options that say so, with their values.
    pub said: Vec<(&'static str, String)>,
}

impl Axes {
    /// What the options say. Whether the names are those of parameters is yet to be seen.
    ///
    /// # Errors
    /// [`Error::Input`] and [`Error::Parameter`] for what can't be read, for a parameter that is given twice, and for more than two that
    /// vary.
    pub fn read(options: &SweepOptions) -> Result<Self> {
        let mut axes = Axes {
            names: Vec::new(),
            ranges: Vec::new(),
            driving: None,
            stiffness: None,
            said: Vec::new(),
        };
        for (name, text) in [
            ("driving", &options.driving),
            ("stiffness", &options.stiffness),
        ] {
            let Some(text) = text else { continue };
            let grain = Grain::parse(name, text)?;
            axes.said.push((name, grain.to_string()));
            if !grain.single {
                axes.vary(name, grain.range);
            } else if name == "driving" {
                axes.driving = Some(grain.range.from);
            } else {
                axes.stiffness = Some(grain.range.from);
            }
        }
        for text in &options.grid {
            let unreadable = || {
                Error::Input(format!(
                    "`grid` {text:?} must be NAME=A:B:N or NAME=A:B:Nlog, N values of NAME from A to B"
                ))
            };
            let (name, range) = text.split_once('=').ok_or_else(unreadable)?;
            let name = name.trim();
            if let Some(other) = axes.says(name).or(said(options, name)?) {
                return Err(Error::Input(format!(
                    "`grid` {name}: {other} already sets it"
                )));
            }
            let range = Range::of_any_sign(&format!("grid {name}"), range)?;
            let text = format!("{name}={}", Grain::of(name, range));
            axes.said.push(("grid", text));
            axes.vary(name, range);
        }
        if axes.names.len() > MOST {
            return Err(Error::Input(format!(
                "a grid has two axes at most, but here {} vary: {}",
                axes.names.len(),
                axes.names.join(", ")
            )));
        }
        Ok(axes)
    }

    fn vary(&mut self, name: &str, range: Range) {
        self.names.push(name.to_owned());
        self.ranges.push(range);
    }

    /// What has said before what a parameter is.
    fn says(&self, name: &str) -> Option<String> {
        let fixed = (name == "driving" && self.driving.is_some())
            || (name == "stiffness" && self.stiffness.is_some());
        let varies = self.names.iter().any(|known| known == name);
        let loading = ["driving", "stiffness"].contains(&name);
        match varies || fixed {
            true if loading && self.said.iter().any(|(known, _)| *known == name) => {
                Some(format!("`{name}`"))
            }
            true => Some("another `grid`".to_owned()),
            false => None,
        }
    }

    /// Whether V_H and K are there, fixed or varying.
    ///
    /// # Errors
    /// [`Error::Input`] that names the missing one.
    pub fn needs_loading(&self) -> Result<()> {
        for (name, fixed) in [("driving", self.driving), ("stiffness", self.stiffness)] {
            if fixed.is_none() && !self.names.iter().any(|known| known == name) {
                return Err(missing(name));
            }
        }
        Ok(())
    }

    /// Whether these are parameters of interfaces with a law that is built in, and such as may vary.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a name that is none; [`Error::Input`] for those of interfaces that there are not, and for units.
    pub fn known_of_interfaces(&self, slab: &SlabOptions) -> Result<()> {
        let refused = |name: &str, why: &str| Err(Error::Input(format!("`grid` {name}: {why}")));
        for name in &self.names {
            let own = of_one("grid", name)?;
            if own.is_some() && slab.count() == 1 {
                return refused(name, "there is one interface");
            }
            if own.is_none() && !NAMES.contains(&name.as_str()) {
                return Err(Error::unknown("grid", name, &NAMES));
            }
            if !slab.si && sets_units(name) && !name.starts_with(DIRECT_EFFECT) {
                return refused(
                    name,
                    "without `si` it is the unit of other numbers and cannot vary; give values with units",
                );
            }
        }
        Ok(())
    }

    /// The ends of all axes, in all combinations.
    pub fn corners(&self) -> Vec<Vec<f64>> {
        let mut corners = vec![Vec::new()];
        for range in &self.ranges {
            let with = |corner: &Vec<f64>, end: f64| [&corner[..], &[end]].concat();
            let both = |corner| [range.from, range.to].map(|end| with(corner, end));
            corners = corners.iter().flat_map(both).collect();
        }
        corners
    }

    /// Whether nothing but V_H and K varies, V_H faster.
    pub fn are_of_loading(&self) -> bool {
        let names: Vec<&str> = self.names.iter().map(String::as_str).collect();
        matches!(
            names[..],
            [] | ["driving"] | ["stiffness"] | ["driving", "stiffness"]
        )
    }

    /// The values of V_H or K, of which one may be fixed.
    pub fn grain(&self, name: &str) -> Result<Grain> {
        let place = self.names.iter().position(|known| known == name);
        let fixed = match name {
            "driving" => self.driving,
            _ => self.stiffness,
        };
        match (place, fixed) {
            (Some(place), _) => Ok(Grain::of(name, self.ranges[place])),
            (None, Some(value)) => Grain::parse(name, &format!("{value:?}")),
            (None, None) => Err(missing(name)),
        }
    }
}

/// That V_H or K is not given.
pub(super) fn missing(name: &str) -> Error {
    Error::Input(format!("`{name}` A:B:N is missing, and has no default"))
}

/// What else than the grid says what a parameter is.
fn said(options: &SweepOptions, name: &str) -> Result<Option<String>> {
    let slab = &options.slab;
    if slab.sets(name)? {
        return Ok(Some("`set`".into()));
    }
    Ok(slab.flag(name).then(|| format!("`{name}`")))
}
