//! Interfaces: with a built-in law or by its formulas, equal or not, few or many.

use super::parameters::{Declared, InterfaceParameters};
use super::{LawDescription, ModelDescription, ModelKind, StateDescription, symbol_of_state, unit};
use crate::scene::general::{SlabSubject, Subject};
use crate::scene::locus::CurveChoice;
use crate::scene::many::many_run_columns;
use crate::scene::options::{ModelOptions, SlabOptions};
use crate::scene::shipped::{about, shipped_laws};
use crate::scene::system::{Described, System};
use crate::scene::text::{MOST_APART, TextModel, law_text, remarks as remarks_of};
use crate::scene::units::{Quantity, TimeUnit, Units};
use std::collections::BTreeMap;
use twinslip::equilibrium::MOST_INTERFACES;
use twinslip::error::Result;
use twinslip::friction::AnyLaw;

/// V_H and K, which need not be given.
const LOADING: [&str; 2] = ["driving", "stiffness"];
const DAMPING: &str = "damping";
/// In SI the units of other numbers, and parameters too.
const UNITS: [&str; 2] = ["slip_length", "normal_stress"];

/// Interfaces, checked.
enum Interfaces {
    /// One or two with a built-in law, or many that are equal.
    Closed(Box<System>),
    /// A few, or clusters, by the formulas of their law.
    Formulas(Box<TextModel>),
}

/// Describes the interfaces of these options.
///
/// # Errors
/// Those of the system.
pub(super) fn described(options: &ModelOptions) -> Result<ModelDescription> {
    let slab = &options.slab;
    let interfaces = Interfaces::new(options)?;
    let units = *interfaces.described().units();
    // Checked also where no unit is asked for.
    TimeUnit::named(&slab.time_unit)?;
    let count = slab.count();
    let parameters = InterfaceParameters {
        options,
        units: &units,
        echo: interfaces.described().echo(),
    };
    Ok(ModelDescription {
        kind: ModelKind::Interfaces,
        title: interfaces.title(slab),
        states: interfaces.states(&units),
        parameters: parameters.described(&interfaces.declared(options)?)?,
        axes: LOADING.map(str::to_owned).to_vec(),
        laws: laws(),
        symmetries: match interfaces.are_two_equal() {
            true => vec!["symmetric", "asymmetric"],
            false => Vec::new(),
        },
        interfaces: Some(count),
        loci: interfaces.loci(slab),
        rests: interfaces.rest(),
        surface: None,
        duration: None,
        text: None,
        si: slab.si,
        time_unit: unit(&units, Quantity::Time),
    })
}

impl Interfaces {
    fn new(options: &ModelOptions) -> Result<Self> {
        let slab = &options.slab;
        let many = slab.clusters.is_none() && slab.count() as usize > MOST_APART;
        if many && slab.law_file().is_none() {
            return Ok(Interfaces::Closed(Box::new(System::of_many(options)?)));
        }
        Ok(match TextModel::of(options, &LOADING)? {
            Some(model) => Interfaces::Formulas(Box::new(model)),
            None => Interfaces::Closed(Box::new(System::new(options)?)),
        })
    }

    fn described(&self) -> &dyn Described {
        match self {
            Interfaces::Closed(system) => &**system,
            Interfaces::Formulas(model) => &**model,
        }
    }

    /// Whether any two have other constants than each other.
    fn differ(&self) -> bool {
        match self {
            Interfaces::Closed(system) => system.unequal.is_some(),
            Interfaces::Formulas(model) => {
                let slab = model.slab.as_ref();
                slab.is_some_and(|slab| slab.differ(&model.system))
            }
        }
    }

    /// Whether they are two equal ones with a built-in law, whose symmetry all commands know.
    fn are_two_equal(&self) -> bool {
        matches!(self, Interfaces::Closed(system) if system.interfaces == 2 && system.unequal.is_none())
    }

    fn title(&self, slab: &SlabOptions) -> String {
        let count = match slab.count() {
            1 => "one interface".to_owned(),
            2 if self.differ() => "two unequal interfaces".to_owned(),
            2 => "two interfaces".to_owned(),
            n if self.differ() => format!("{n} unequal interfaces"),
            n => format!("{n} interfaces"),
        };
        let clusters = slab.clusters.as_ref().map(|text| {
            let sizes: Vec<&str> = text.split(',').map(str::trim).collect();
            format!(" in clusters of {}", sizes.join(", "))
        });
        let law = match self {
            Interfaces::Closed(system) => system.law.name(),
            Interfaces::Formulas(model) => model.name(),
        };
        let word = if law.ends_with("law") { "" } else { " law" };
        format!("{count}{}, {law}{word}", clusters.unwrap_or_default())
    }

    /// The stress, and ln psi of each; of many what rows tell of all.
    fn states(&self, units: &Units) -> Vec<StateDescription> {
        let state = |name: String, quantity| StateDescription {
            label: symbol_of_state(&name).unwrap_or_else(|| name.clone()),
            unit: unit(units, quantity),
            name: name.into(),
        };
        let each = match self {
            Interfaces::Closed(system) if system.interfaces > MOST_APART => {
                let columns = many_run_columns().into_iter();
                let stated = columns.filter(|column| {
                    [Quantity::Stress, Quantity::State].contains(&column.quantity)
                });
                return stated
                    .map(|column| StateDescription {
                        label: symbol_of_state(&column.name)
                            .or(column.meaning.map(str::to_owned))
                            .unwrap_or_else(|| column.name.to_string()),
                        unit: unit(units, column.quantity),
                        name: column.name,
                    })
                    .collect();
            }
            Interfaces::Closed(system) => system.interfaces,
            Interfaces::Formulas(model) => {
                let names = model.system.states().iter().enumerate();
                let each = names.map(|(i, name)| state((*name).to_owned(), model.quantity(i)));
                return each.collect();
            }
        };
        let logs = (1..=each).map(|i| state(format!("log_state_{i}"), Quantity::LogState));
        let stress = state("stress".to_owned(), Quantity::Stress);
        std::iter::once(stress).chain(logs).collect()
    }

    /// The parameters by which branches can be followed: of a constant in which interfaces differ those of each, else that of all.
    fn declared(&self, options: &ModelOptions) -> Result<Vec<Declared>> {
        let slab = &options.slab;
        let names = match self {
            Interfaces::Closed(system) => names_of_system(system)?,
            Interfaces::Formulas(model) => names_of_formulas(model, options),
        };
        let text = slab.law_file().map(law_text).transpose()?;
        let remarks = text.map_or_else(BTreeMap::new, |text| remarks_of(&text));
        let declared = names.into_iter();
        let declared = declared.map(|name| Declared::of(name, slab, &remarks));
        Ok(declared.collect())
    }

    /// Whether nothing that is modulated keeps them from rest.
    fn rest(&self) -> bool {
        match self {
            Interfaces::Closed(_) => true,
            Interfaces::Formulas(model) => model.system.phase().is_none(),
        }
    }

    /// The bifurcations that they may have: those of equilibria of many equal interfaces alone.
    fn loci(&self, slab: &SlabOptions) -> Vec<&'static str> {
        let count = slab.count() as usize;
        // Of more than two the same constant given for each is not known to be the same.
        let alike = count <= 2 || slab.sets_one_interface() == Ok(false);
        let equal = slab.clusters.is_none() && slab.law_file().is_none();
        let equal = equal && alike && !self.differ();
        let symmetric = equal && (2..=MOST_INTERFACES).contains(&count);
        let parts = match self {
            Interfaces::Closed(system) => system.interfaces,
            Interfaces::Formulas(model) => {
                let slab = model.slab.as_ref();
                slab.map_or(0, |slab| slab.layout().parts)
            }
        };
        let variables = match self {
            Interfaces::Closed(system) => system.interfaces + 1,
            Interfaces::Formulas(model) => model.system.states().len(),
        };
        let broken = [symmetric, symmetric && count == 2];
        match parts {
            _ if parts > MOST_INTERFACES => Vec::new(),
            _ if !self.rest() => CurveChoice::of_forced(variables),
            _ if parts > MOST_APART => CurveChoice::of_equilibria(broken[0]),
            // A single one has one steady state.
            _ => {
                let mut curves = CurveChoice::of_system(variables, parts > 1, broken);
                // Those of interfaces take minutes.
                curves.retain(|name| *name != "homoclinic");
                curves
            }
        }
    }
}

/// The parameters of a system that may vary. One without damping may have some.
fn names_of_system(system: &System) -> Result<Vec<&'static str>> {
    let echo = system.echo();
    let told = |name: &str| name == DAMPING || echo.contains_key(name);
    // Of a constant of each interface that of all has no one value.
    let of_each = |name: &str| echo.contains_key(&format!("{name}_1"));
    let varies = |name: &str| SlabSubject::new(system.clone(), &[name]).is_ok();
    let all = SlabSubject::new(system.clone(), &[DAMPING])?.parameters();
    let names = all.into_iter().map(|(name, _)| name);
    let names = names.filter(|name| told(name) && !of_each(name) && varies(name));
    Ok(names.collect())
}

/// The parameters of formulas that may vary; likewise, where the formulas take damping.
fn names_of_formulas(model: &TextModel, options: &ModelOptions) -> Vec<&'static str> {
    let freed = |more: &[&str]| {
        let free = [&LOADING[..], more].concat();
        TextModel::of(options, &free).ok().flatten()
    };
    let varies = |name: &str| {
        let model = freed(&[name]);
        model.is_some_and(|model| model.system.parameter_names().contains(&name))
    };
    let in_si: &[&str] = if options.slab.si { &UNITS } else { &[] };
    let all = freed(&[&[DAMPING], in_si].concat());
    let system = &all.as_ref().unwrap_or(model).system;
    let names = system.parameter_names().iter().copied();
    names.filter(|name| varies(name)).collect()
}

/// The laws that are built in, and those that the program carries as files.
fn laws() -> Vec<LawDescription> {
    let files = shipped_laws();
    let of = |name: &str| files.iter().find(|(file, _)| *file == name);
    let built_in = AnyLaw::NAMES.iter().zip(AnyLaw::SOURCES);
    let built_in = built_in.map(|(name, source)| LawDescription {
        name: (*name).to_owned(),
        meaning: of(name).map_or_else(|| source.to_owned(), |(_, text)| about(text)),
    });
    let others = files
        .iter()
        .filter(|(file, _)| !AnyLaw::NAMES.contains(file));
    let others = others.map(|(file, text)| LawDescription {
        name: (*file).to_owned(),
        meaning: about(text),
    });
    built_in.chain(others).collect()
}
