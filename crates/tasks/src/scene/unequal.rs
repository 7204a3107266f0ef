//! Numbers of one interface, such as `residual_strength_2`, by `--set` and in the table `[set]` of a scene.

use super::options::SlabOptions;
use super::set::assignments;
use serde_json::{Map, Value, json};
use twinslip::error::{Error, Result};
use twinslip::friction::{InterfaceConstants, positive};

/// What parameters one interface may have of its own.
const NAMES: [&str; COUNT] = InterfaceConstants::NAMES;
const COUNT: usize = InterfaceConstants::NAMES.len();
/// What all interfaces have in common.
const COMMON: [&str; 3] = ["driving", "stiffness", "damping"];

/// A parameter of one interface: its place among the names, and the interface, 0 or 1. `None` for a name that has no index.
///
/// # Errors
/// [`Error::Input`] for an index that no interface has, and of a parameter that they have in common.
pub(super) fn of_one(option: &str, name: &str) -> Result<Option<(usize, usize)>> {
    let Some((base, index)) = name.rsplit_once('_') else {
        return Ok(None);
    };
    if index.is_empty() || !index.bytes().all(|byte| byte.is_ascii_digit()) {
        return Ok(None);
    }
    if COMMON.contains(&base) {
        let what =
            format!("`{option}` {name}: the interfaces have one {base} in common; say {base}");
        return Err(Error::Input(what));
    }
    let Some(place) = NAMES.iter().position(|known| *known == base) else {
        return Ok(None);
    };
    match index {
        "1" => Ok(Some((place, 0))),
        "2" => Ok(Some((place, 1))),
        _ => {
            let what = format!("`{option}` {name}: the index is {index}, but must be 1 or 2");
            Err(Error::Input(what))
        }
    }
}

/// Whether a name is that of a parameter of one interface, of however many.
pub(super) fn is_of_one(name: &str) -> bool {
    name.rsplit_once('_').is_some_and(|(base, index)| {
        NAMES.contains(&base) && index.bytes().all(|byte| byte.is_ascii_digit())
    })
}

/// The numbers that are given for one interface, in the user's units.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct OfOne([[Option<f64>; COUNT]; 2]);

impl OfOne {
    /// What `set` says of single interfaces.
    ///
    /// # Errors
    /// As [`of_one`]; [`Error::Parameter`] for a value outside its domain; [`Error::Input`] for an interface that there is not.
    pub fn read(options: &SlabOptions) -> Result<Self> {
        let mut all = OfOne::default();
        for (name, value) in assignments(&options.text.set)? {
            let Some((place, interface)) = of_one("set", name)? else {
                continue;
            };
            if interface >= options.count() as usize {
                let what = format!("`set` {name}: there is one interface");
                return Err(Error::Input(what));
            }
            let may_be_zero = ["residual_strength", "reference_friction"].contains(&NAMES[place]);
            if !(may_be_zero && value == 0.0) {
                let must = if may_be_zero {
                    "zero or positive"
                } else {
                    "positive"
                };
                positive(name, value).map_err(|_| Error::parameter(name, value, must))?;
            }
            let is_unit = ["slip_length", "normal_stress"].contains(&NAMES[place]);
            if is_unit && interface == 0 && !options.si && value != 1.0 {
                let must = "1: without `si` it is the unit";
                return Err(Error::parameter(name, value, must));
            }
            all.0[interface][place] = Some(value);
        }
        Ok(all)
    }

    /// The constants of an interface, of which `common` are those of both.
    pub fn constants(&self, interface: usize, common: [f64; COUNT]) -> [f64; COUNT] {
        let own = self.0[interface];
        std::array::from_fn(|place| own[place].unwrap_or(common[place]))
    }

    /// The options of the first interface.
    pub fn first(&self, options: &SlabOptions) -> SlabOptions {
        let [healing_time, c, a, b, a_v, slip_length, normal_stress] = self.0[0];
        let in_si = |own: Option<f64>| own.filter(|_| options.si);
        SlabOptions {
            healing_time: healing_time.or(options.healing_time),
            residual_strength: c.or(options.residual_strength),
            direct_effect: a.or(options.direct_effect),
            evolution_effect: b.or(options.evolution_effect),
            reference_friction: a_v.or(options.reference_friction),
            slip_length: in_si(slip_length).or(options.slip_length),
            normal_stress: in_si(normal_stress).or(options.normal_stress),
            ..options.clone()
        }
    }

    /// Adds to what the output tells of a system what is each interface's own: what is given so, and what they differ in.
    pub fn echo(&self, constants: &[[f64; COUNT]; 2], echo: &mut Map<String, Value>) {
        for (place, name) in NAMES.iter().enumerate() {
            let given = self.0.iter().any(|own| own[place].is_some());
            let [first, second] = constants.map(|all| all[place]);
            if given || first != second {
                for (index, value) in [(1, first), (2, second)] {
                    echo.insert(format!("{name}_{index}"), json!(value));
                }
            }
        }
    }
}
