//! Derivatives of an orbit in parameters, by name and in the user's units.

use super::super::any_system::AnySystem;
use super::super::general::{SlabSubject, Subject};
use super::super::options::ModelOptions;
use super::super::system::Described;
use super::super::text::TextModel;
use super::super::units::Quantity;
use super::search::{Search, held};
use twinslip::error::{Error, Result};
use twinslip::integrate::MotionUnits;
use twinslip::number::Uncertain;
use twinslip::orbit::{
    AlongArcs, Coordinate, Families, Orbit, OrbitAccuracy, OverText, ParametrisedField,
    Sensitivity, ShootingNodes, sensitivity,
};

/// The derivatives of an orbit in one parameter.
#[derive(Debug, Clone, PartialEq)]
pub struct OrbitDerivatives {
    /// The parameter.
    pub name: String,
    /// Of the period.
    pub period: Uncertain,
    /// Of the least and the largest value of every state.
    pub extremes: Vec<[Uncertain; 2]>,
    /// Of the logarithms of the multipliers, in their order, those within clusters last; `None` of what is below the floor.
    pub ln_abs: Vec<Option<Uncertain>>,
}

/// The parameters that are asked for.
///
/// # Errors
/// [`Error::Input`] for a name that is none.
pub(super) fn names(text: &str, system: &AnySystem) -> Result<Vec<String>> {
    let known: Vec<&str> = match system.closed_forms() {
        None => {
            let model = system.formulas().expect("formulas, or closed forms");
            model.system.parameter_names().to_vec()
        }
        Some((system, _)) => {
            let all = SlabSubject::new(system.clone(), &[])?.parameters();
            all.into_iter().map(|(name, _)| name).collect()
        }
    };
    let one = |name: &str| match known.contains(&name) {
        true => Ok(name.to_owned()),
        false if known.is_empty() => Err(Error::Input(format!(
            "`derivatives` {name}: the system has no parameters"
        ))),
        false => Err(Error::no_parameter("derivatives", name, &known)),
    };
    text.split(',').map(str::trim).map(one).collect()
}

/// The derivatives of an orbit in a parameter.
pub(super) fn derivatives(
    search: &Search,
    (system, options): (&AnySystem, &ModelOptions),
    orbit: &Orbit,
    (accuracy, atol_is_given): (&OrbitAccuracy, bool),
    name: &str,
) -> Result<OrbitDerivatives> {
    let (found, quantity) = match search {
        Search::FromStart {
            units, logarithmic, ..
        } => {
            let units = logarithmic.get().unwrap_or(units);
            let accuracy = units.inward_accuracy(*accuracy, atol_is_given);
            of_formulas(units, options, orbit, &accuracy, name)?
        }
        Search::BySymmetry { .. } | Search::Unequal(..) => {
            of_closed_forms(system, orbit, accuracy, name)?
        }
    };
    let units = system.units();
    let outward = |x: Uncertain, of: Quantity| {
        let factor = units.factor(of) / units.factor(quantity);
        Uncertain::new(x.value * factor, x.uncertainty * factor)
    };
    // Where both interfaces move alike they share a state.
    let extremes = (0..system.states().len()).map(|i| {
        let both = found.extremes[i.min(found.extremes.len() - 1)];
        both.map(|x| outward(x, system.quantity(i)))
    });
    let within = found.within.iter().copied().map(Some);
    let ln_abs = found.ln_abs.iter().copied().chain(within);
    Ok(OrbitDerivatives {
        name: name.to_owned(),
        period: outward(found.period, Quantity::Time),
        extremes: extremes.collect(),
        ln_abs: ln_abs
            .map(|x| x.map(|x| outward(x, Quantity::Number)))
            .collect(),
    })
}

fn of_formulas(
    units: &MotionUnits,
    options: &ModelOptions,
    orbit: &Orbit,
    accuracy: &OrbitAccuracy,
    name: &str,
) -> Result<(Sensitivity, Quantity)> {
    let model = TextModel::of(options, &[name])?.expect("formulas, as without a free parameter");
    let place = twinslip::field::place(model.system.parameter_names(), name)?;
    let value = model.system.parameters()[place];
    let coordinate = match value {
        0.0 => Coordinate::Linear(1.0),
        value => Coordinate::Linear(value.abs()),
    };
    let system = units.inward_system(&model.system)?;
    let family = OverText::one(&system, name, coordinate)?;
    let slab = model.slab.as_ref().filter(|slab| slab.has_clusters());
    let along = AlongArcs {
        method: accuracy.method,
        tolerances: accuracy.tolerances,
        uncertainty: 0.0,
    };
    let within = |at: [f64; 2], shooting: &ShootingNodes| {
        let mut there = model.system.clone();
        there.set(name, family.parameters(at)[0])?;
        let outward = ShootingNodes {
            nodes: shooting.nodes.iter().map(|x| units.outward(x)).collect(),
            durations: shooting.durations.iter().map(|t| t * units.time).collect(),
        };
        let all = slab.map_or(Ok(Vec::new()), |slab| slab.within(&there, &outward, along))?;
        Ok(all.iter().map(|one| one.ln_abs.value).collect())
    };
    let families = Families {
        own: &family,
        whole: None,
        within: slab.is_some().then_some(&within),
    };
    let known = held(units, orbit)?;
    let at = [coordinate.inward(value), 0.0];
    let found = sensitivity(&families, at, &known, accuracy)
        .map_err(|error| units.outward_error(error, 0))?;
    let quantity = match model.slab {
        Some(_) => Quantity::of_parameter(name),
        None => Quantity::Number,
    };
    Ok((units.outward_sensitivity(found, &known.extremes), quantity))
}

fn of_closed_forms(
    system: &AnySystem,
    orbit: &Orbit,
    accuracy: &OrbitAccuracy,
    name: &str,
) -> Result<(Sensitivity, Quantity)> {
    let (system, _) = system.closed_forms().expect("closed forms");
    let subject = SlabSubject::new(system.clone(), &[name])?;
    // What is 0 has no derivative on both sides, and a law without damping none to begin with.
    let given = SlabSubject::new(system.clone(), &[])?.value(name)?;
    if given <= 0.0 {
        return Err(Error::Input(format!(
            "`derivatives` {name} is {given:?} here, and must be positive: give it a small value"
        )));
    }
    let at = [subject.value(name)?.ln(), 0.0];
    let (whole, plane) = subject.both(name)?;
    let shared = orbit.point.len() < system.interfaces + 1;
    let (families, orbit) = match (shared, &plane) {
        (false, _) => (Families::of(&*whole), orbit.clone()),
        (true, Some(plane)) => {
            let families = Families {
                whole: Some(&*whole),
                ..Families::of(&**plane)
            };
            (families, orbit.clone())
        }
        // What one interface has alone parts them.
        (true, None) => (Families::of(&*whole), apart(orbit)),
    };
    let found = sensitivity(&families, at, &orbit, accuracy)?;
    Ok((found, Quantity::of_parameter(name)))
}

/// An orbit of two interfaces that move alike, in the states of both.
fn apart(orbit: &Orbit) -> Orbit {
    let mut orbit = orbit.clone();
    for x in orbit.nodes.iter_mut().chain([&mut orbit.point]) {
        x.push(x[1]);
    }
    let last = orbit.extremes[1];
    orbit.extremes.push(last);
    orbit
}
