//! Options of interfaces that are given by a law's formulas: their number, their units, and the parameters of each.

use super::law_file::{DAMPING, LawFile, SCALES};
use super::modulation::NORMAL_STRESS_COUPLING;
use super::more_states::{MASS, SECOND_EVOLUTION_EFFECT, SECOND_SLIP_LENGTH};
use crate::scene::options::{ModelOptions, SlabOptions};
use crate::scene::set::{assignments, put_in, twice};
use crate::scene::system::{damping, scales};
use crate::scene::units::{Quantity, TimeUnit, Units};
use crate::scene::words::indexed;
use twinslip::error::{Error, Result};
use twinslip::friction::positive;

/// Parameters of built-in laws that are not negative.
const POSITIVE: [&str; 7] = [
    "healing_time",
    "direct_effect",
    "evolution_effect",
    "slip_length",
    "normal_stress",
    SECOND_SLIP_LENGTH,
    MASS,
];

/// A parameter of the law: of all interfaces, or where they differ of each.
pub(super) struct Own {
    pub name: String,
    pub values: Vec<f64>,
    pub differs: bool,
}

/// Interfaces, or clusters of them, that move on their own by formulas: all steady states of as many are found by bisection, whose work grows
/// exponentially with their number.
pub(in crate::scene) const MOST_APART: usize = 7;

/// How many interfaces there are in each cluster: one, where the options say nothing of clusters.
pub(super) fn counts(options: &SlabOptions) -> Result<Vec<usize>> {
    const MOST: usize = MOST_APART;
    let interfaces = options.count();
    let Some(text) = &options.clusters else {
        return match interfaces {
            0 => Err(Error::parameter("interfaces", interfaces, "at least 1")),
            _ if interfaces as usize <= MOST => Ok(vec![1; interfaces as usize]),
            _ => Err(Error::Input(format!(
                "`interfaces` {interfaces}: at most {MOST} can move independently here; group equal ones with `clusters`"
            ))),
        };
    };
    let wrong = |must: String| Error::Input(format!("`clusters` {text:?} must be {must}"));
    let read = |part: &str| part.trim().parse::<u32>().ok().filter(|&count| count > 0);
    let counts: Option<Vec<u32>> = text.split(',').map(read).collect();
    let counts = counts
        .filter(|counts| counts.len() <= MOST)
        .ok_or_else(|| wrong(format!("1 to {MOST} whole numbers, each at least 1")))?;
    let sum: u64 = counts.iter().copied().map(u64::from).sum();
    if sum != u64::from(interfaces) {
        return Err(wrong(format!(
            "numbers that together are {interfaces}, the number of `interfaces`"
        )));
    }
    Ok(counts.into_iter().map(|count| count as usize).collect())
}

/// SI by the slip length, the normal stress and a of the first interface; no units where that is not asked for.
///
/// # Errors
/// [`Error::Input`] in SI for a law from a file that the user has.
pub(super) fn units(law: &LawFile, slab: &SlabOptions) -> Result<Units> {
    if !slab.si {
        return Ok(Units::none());
    }
    if slab.law_file().is_some() && !slab.law_is_shipped() {
        return Err(Error::Input(format!(
            "`si`: the law {} is from a file, whose numbers have no units",
            law.name
        )));
    }
    let mut first = first(slab)?;
    if first.direct_effect.is_none() {
        let own = law
            .parameters
            .iter()
            .find(|(name, _)| name == "direct_effect");
        first.direct_effect = own.map(|(_, a)| *a);
    }
    let units = Units::new(Some(scales(&first)?), !law.bounds_state());
    Ok(units.in_time(TimeUnit::named(&slab.time_unit)?))
}

/// The options with what `set` says of the slip length, the normal stress and a of the first interface.
fn first(slab: &SlabOptions) -> Result<SlabOptions> {
    let mut first = slab.clone();
    for (name, value) in assignments(&slab.text.set)? {
        match name {
            "slip_length" => put_in(&mut first.slip_length, name, value)?,
            "normal_stress" => put_in(&mut first.normal_stress, name, value)?,
            "direct_effect" | "direct_effect_1" => first.direct_effect = Some(value),
            _ => {}
        }
    }
    Ok(first)
}

/// The a of the unit of stress, where the interfaces have units of their own: in SI any, else that of the first. `None` where all have the same units, and for a
/// law from a file, whose formulas say what tau is.
pub(super) fn unit_of_stress(
    slab: &SlabOptions,
    units: &Units,
    free: &[&str],
) -> Result<Option<f64>> {
    if slab.law_file().is_some() {
        return Ok(None);
    }
    let indexed = |name: &&&str| name.ends_with(|c: char| c.is_ascii_digit());
    let free: Vec<&str> = match slab.si {
        true => free.to_vec(),
        false => free.iter().filter(indexed).copied().collect(),
    };
    if !differ_in_units(slab, &free)? {
        return Ok(None);
    }
    let of_first = ["slip_length_1", "normal_stress_1", "direct_effect_1"];
    if let Some(name) = free.iter().find(|name| !slab.si && of_first.contains(name)) {
        return Err(Error::Input(format!(
            "`{name}` is the unit of other numbers and cannot vary without `si`; give values with units"
        )));
    }
    Ok(Some(match slab.si {
        true => units.factor(Quantity::Stress) / units.factor(Quantity::NormalStress),
        false => first(slab)?.a(),
    }))
}

/// Whether what units are made of varies, or is given for one of the interfaces.
fn differ_in_units(slab: &SlabOptions, free: &[&str]) -> Result<bool> {
    let set = assignments(&slab.text.set)?;
    let names = set.into_iter().map(|(name, _)| name);
    let indexed = names.filter(|name| name.ends_with(|c: char| c.is_ascii_digit()));
    let mut all = indexed.chain(free.iter().copied());
    Ok(all.any(|name| {
        let stem = name.trim_end_matches(|c: char| c.is_ascii_digit());
        let stem = stem.strip_suffix('_').unwrap_or(stem);
        SCALES.contains(&stem) || stem == "direct_effect"
    }))
}

/// A value that an option, or `set`, gives to a parameter of all interfaces, in the user's units; any value where the parameter is free.
fn given(
    slab: &SlabOptions,
    name: &str,
    option: Option<f64>,
    free: &[&str],
) -> Result<Option<f64>> {
    let set = assignments(&slab.text.set)?;
    let mut set = set.iter().filter(|(set, _)| *set == name);
    let value = option.or(set.next().map(|(_, value)| *value));
    Ok(value.or(free.contains(&name).then_some(1.0)))
}

impl SlabOptions {
    /// Whether the interfaces are such that formulas alone describe them: they have a second state variable or mass, of which these parameters
    /// may be some, or a parameter that varies in time.
    ///
    /// # Errors
    /// [`Error::Input`] for what `set` says.
    pub fn needs_formulas(&self, free: &[&str]) -> Result<bool> {
        const MORE: [&str; 4] = [
            MASS,
            SECOND_EVOLUTION_EFFECT,
            SECOND_SLIP_LENGTH,
            NORMAL_STRESS_COUPLING,
        ];
        let set = assignments(&self.text.set)?;
        // Without mass it is 0.
        let is_given = |(name, value): &(&str, f64)| *name != MASS || *value != 0.0;
        let set = set
            .iter()
            .filter(|pair| is_given(pair))
            .map(|(name, _)| *name);
        let mut names = set.chain(free.iter().copied());
        let named = names.any(|name| MORE.contains(&indexed(name).0));
        let options = [
            (MASS, self.mass),
            (SECOND_EVOLUTION_EFFECT, self.second_evolution_effect),
            (SECOND_SLIP_LENGTH, self.second_slip_length),
            (NORMAL_STRESS_COUPLING, self.normal_stress_coupling),
        ];
        let named = named || !self.modulate.is_empty();
        let mut options = options.iter();
        Ok(named || options.any(|(name, value)| value.is_some_and(|x| is_given(&(name, x)))))
    }
}

/// The law with the second state variable and the mass that the options give it. What is free has any value, which is set before it counts.
pub(super) fn extended(
    mut law: LawFile,
    slab: &SlabOptions,
    (units, free): (&Units, &[&str]),
) -> Result<LawFile> {
    let bases: Vec<&str> = free.iter().map(|name| indexed(name).0).collect();
    let second = given(
        slab,
        SECOND_EVOLUTION_EFFECT,
        slab.second_evolution_effect,
        &bases,
    )?;
    let length = given(slab, SECOND_SLIP_LENGTH, slab.second_slip_length, &bases)?;
    law = match (second, length) {
        (None, None) => law,
        (Some(b), Some(length)) => {
            let length = positive(SECOND_SLIP_LENGTH, length)?;
            law.with_second_state(b, units.inward(Quantity::Length, length))?
        }
        (Some(_), None) => {
            return Err(Error::Input(
                "`second-slip-length` L2 is missing: a second state variable has a slip length of its own, without `si` in units of the first".into(),
            ));
        }
        (None, Some(_)) => {
            return Err(Error::Input(
                "`second-evolution-effect` b2 is missing: how strong is the second state variable?"
                    .into(),
            ));
        }
    };
    law = match given(slab, MASS, slab.mass, &bases)? {
        None | Some(0.0) => law,
        Some(mass) => law.with_mass(units.inward(Quantity::Mass, positive(MASS, mass)?))?,
    };
    law = law.modulated(&slab.modulate, units)?;
    match given(
        slab,
        NORMAL_STRESS_COUPLING,
        slab.normal_stress_coupling,
        &bases,
    )? {
        None => Ok(law),
        Some(alpha) => law.coupled(alpha),
    }
}

/// The law with the radiation damping that the options give it, where it has no parameter of that name itself. Where that is free it has any
/// value, which is set before it counts.
pub(super) fn damped(
    law: LawFile,
    options: &ModelOptions,
    (units, free): (&Units, &[&str]),
) -> Result<LawFile> {
    if law.place(DAMPING).is_some() {
        return Ok(law);
    }
    let set = assignments(&options.slab.text.set)?;
    let set = set.into_iter().rfind(|(name, _)| *name == DAMPING);
    let given = SlabOptions {
        damping: set.map(|(_, value)| value).or(options.slab.damping),
        ..options.slab.clone()
    };
    match damping(&given)? {
        0.0 if free.contains(&DAMPING) => law.damped(1.0),
        0.0 => Ok(law),
        eta => law.damped(units.inward(Quantity::Damping, eta)),
    }
}

/// The parameters of the law, with what the options and `--set` say; V_H and K go to `loading`. One that is free for an interface alone is that
/// of each.
pub(super) fn parameters(
    law: &LawFile,
    options: &ModelOptions,
    (interfaces, units, free): (usize, &Units, &[&str]),
    loading: &mut [Option<f64>; 2],
) -> Result<Vec<Own>> {
    let inward = |name: &str, value| units.inward(Quantity::of_parameter(name), value);
    let of_file = law.parameters.iter().map(|(name, value)| Own {
        name: name.clone(),
        values: vec![*value; interfaces],
        differs: false,
    });
    let mut own: Vec<Own> = of_file.collect();
    let slab = &options.slab;
    let given = [
        ("healing_time", slab.healing_time),
        ("residual_strength", slab.residual_strength),
        ("direct_effect", slab.direct_effect),
        ("evolution_effect", slab.evolution_effect),
        ("reference_friction", slab.reference_friction),
        (DAMPING, slab.damping),
        (SECOND_EVOLUTION_EFFECT, slab.second_evolution_effect),
        (SECOND_SLIP_LENGTH, slab.second_slip_length),
        (MASS, slab.mass),
        (NORMAL_STRESS_COUPLING, slab.normal_stress_coupling),
    ];
    for (name, value) in given {
        let Some(value) = value else { continue };
        let Some(own) = own.iter_mut().find(|own| own.name == name) else {
            // Without damping or mass a law needs none.
            if name == DAMPING || (name == MASS && value == 0.0) {
                continue;
            }
            let option = name.replace('_', "-");
            return Err(Error::Input(format!(
                "`{option}`: the law {} is from a file, and has no parameter {name}",
                law.name
            )));
        };
        own.values.fill(inward(name, value));
    }
    for (name, value) in assignments(&slab.text.set)? {
        if slab.law_file().is_none() && POSITIVE.contains(&indexed(name).0) && value != 0.0 {
            positive(name, value)?;
        }
        match name {
            "driving" => put_in(&mut loading[0], name, value)?,
            "stiffness" => put_in(&mut loading[1], name, value)?,
            _ if given
                .iter()
                .any(|(option, value)| *option == name && value.is_some()) =>
            {
                return Err(twice(name, name));
            }
            DAMPING if law.place(DAMPING).is_none() => {}
            MASS if value == 0.0 && law.place(MASS).is_none() => {}
            // These make the units.
            _ if slab.si && SCALES.contains(&name) => {}
            _ => put(&mut own, name, inward(name, value), interfaces)?,
        }
    }
    for name in free {
        if own.iter().all(|own| own.name != *name)
            && let Some((own, _)) = of_one(&mut own, name, interfaces)
        {
            own.differs = true;
        }
    }
    Ok(own)
}

/// The parameter that a name with an index is of, and the interface.
fn of_one<'o>(own: &'o mut [Own], name: &str, interfaces: usize) -> Option<(&'o mut Own, usize)> {
    let (stem, number) = name.rsplit_once('_')?;
    let i = number.parse::<usize>().ok()?;
    let there = interfaces > 1 && (1..=interfaces).contains(&i);
    let own = own.iter_mut().find(|own| own.name == stem);
    own.filter(|_| there).map(|own| (own, i - 1))
}

/// Another value of a parameter of all interfaces, or of one.
fn put(own: &mut [Own], name: &str, value: f64, interfaces: usize) -> Result<()> {
    if let Some(own) = own.iter_mut().find(|own| own.name == name) {
        own.values.fill(value);
        return Ok(());
    }
    if let Some((own, i)) = of_one(own, name, interfaces) {
        own.values[i] = value;
        own.differs = true;
        return Ok(());
    }
    let names = own.iter().map(|own| own.name.as_str());
    let known: Vec<&str> = ["driving", "stiffness"].into_iter().chain(names).collect();
    Err(Error::no_parameter("set", name, &known))
}
