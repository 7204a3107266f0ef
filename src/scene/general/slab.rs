//! Two interfaces, equal or not, to be continued in any of their parameters.

use super::{RowKind, Subject};
use crate::bifurcation::general::{GeneralPoint, GeneralSolution};
use crate::equilibrium::{Symmetry, unequal_steady_states};
use crate::error::{Error, Result};
use crate::field::{Matrix, Parametrised, State, Vector};
use crate::friction::{AnyLaw, Law, Parameters, UnequalLaws, positive};
use crate::integrate::{AnyField, Choice};
use crate::model::{Driven, Loading, UnequalInterfaces};
use crate::orbit::{
    ContinuationPoint, Coordinate, InitialGuess, InterfaceSystem, OrbitAccuracy, OverLogarithms,
    OverUnequal, ParametrisedField, Profile, ShootingNodes, find_unequal, profile_of,
};
use crate::scene::following;
use crate::scene::plan::{self, Point};
use crate::scene::system::{Described, System};
use crate::scene::units::{Quantity, Units};
use serde_json::{Map, Value};

/// Two interfaces with V_H and K.
#[derive(Debug, Clone, PartialEq)]
pub struct SlabSubject {
    /// What slides.
    pub system: System,
    /// The same; what varies has any value.
    interfaces: UnequalInterfaces,
    /// Whether both are equal, whatever varies.
    equal: bool,
    /// A point at or near an orbit and the period, roughly.
    orbit: Option<(Point, Option<f64>)>,
}

impl SlabSubject {
    /// Two interfaces of which these parameters vary.
    ///
    /// # Errors
    /// [`Error::Input`] for one interface, for SI units of parameters that have none here, and where V_H or K is given though
    /// it varies.
    pub fn new(system: System, free: &[&str]) -> Result<Self> {
        if system.interfaces != 2 {
            return Err(Error::Input(
                "a single interface is followed along driving and stiffness; take two, or write it as a `system`".into(),
            ));
        }
        for (name, given) in [("driving", system.driving), ("stiffness", system.stiffness)] {
            if given.is_some() && free.contains(&name) {
                return Err(Error::Input(format!(
                    "`{name}` varies and can't be given; its range is asked for"
                )));
            }
        }
        let laws = match system.unequal {
            Some(laws) => laws,
            None => UnequalLaws::new(system.law.name(), system.constants, system.law.damping())?,
        };
        // A law without damping has no parameter of this name.
        let laws = if free.contains(&"damping") && laws.damping() == 0.0 {
            UnequalLaws::new(laws.name(), *laws.constants(), 1.0)?
        } else {
            laws
        };
        if system.units.si()
            && let Some(name) = free.iter().find(|name| WITHOUT_UNITS.contains(name))
        {
            return Err(Error::Input(format!(
                "`{name}` is followed in dimensionless numbers; leave `si` out"
            )));
        }
        let loading = Loading {
            driving: system.driving.unwrap_or(1.0),
            stiffness: system.stiffness.unwrap_or(1.0),
        };
        Ok(SlabSubject {
            interfaces: UnequalInterfaces { laws, loading },
            equal: system.unequal.is_none() && free.iter().all(|name| !of_one(name)),
            system,
            orbit: None,
        })
    }

    /// The same with a point at or near an orbit, where branches of orbits begin.
    ///
    /// # Errors
    /// [`Error::Input`] for a text that is no point, and for a period without one.
    pub fn beginning(self, start: Option<&str>, period: Option<f64>) -> Result<Self> {
        let inward = |t| {
            let period = positive("period-guess", t)?;
            Ok(self.units().inward(Quantity::Time, period))
        };
        let period = period.map(inward).transpose()?;
        let orbit = match start {
            Some(text) => {
                let point = plan::start(text, &self.system, &self.interfaces.loading)?;
                Some((point, period))
            }
            None if period.is_some() => {
                let what = "`period_guess` needs a `start` near the orbit";
                return Err(Error::Input(what.into()));
            }
            None => None,
        };
        Ok(SlabSubject { orbit, ..self })
    }

    /// The law of both, with the damping that may vary.
    fn law(&self) -> Result<AnyLaw> {
        let damping = self.interfaces.laws.damping();
        let constants = self.interfaces.laws.constants()[0];
        let parameters = Parameters::new(
            constants.direct_effect,
            constants.evolution_effect,
            constants.reference_friction,
            constants.healing_time,
            constants.residual_strength,
        )?;
        AnyLaw::named(self.interfaces.laws.name(), parameters.damped(damping)?)
    }

    fn at(&self, values: &[(&str, f64)]) -> Result<UnequalInterfaces> {
        let mut interfaces = self.interfaces;
        for &(name, value) in values {
            interfaces = interfaces.with(name, value)?;
        }
        Ok(interfaces)
    }
}

/// Parameters whose SI units have no place here.
const WITHOUT_UNITS: [&str; 3] = ["damping", "slip_length_2", "normal_stress_2"];

/// A parameter that is held where this one varies.
fn other_than(name: &str) -> &'static str {
    if name == "driving" {
        "stiffness"
    } else {
        "driving"
    }
}

/// Whether a parameter is of one of the interfaces.
fn of_one(name: &str) -> bool {
    name.ends_with("_1") || name.ends_with("_2")
}

fn quantity(name: &str) -> Quantity {
    match name {
        "driving" => Quantity::SlipRate,
        "stiffness" => Quantity::Stiffness,
        _ if name.starts_with("healing_time") => Quantity::Time,
        _ => Quantity::Number,
    }
}

impl Described for SlabSubject {
    fn echo(&self) -> &Map<String, Value> {
        self.system.echo()
    }

    fn units(&self) -> &Units {
        self.system.units()
    }
}

impl Subject for SlabSubject {
    fn parameters(&self) -> Vec<(&'static str, Quantity)> {
        let names = self.interfaces.names().iter();
        names.map(|&name| (name, quantity(name))).collect()
    }

    fn value(&self, name: &str) -> Result<f64> {
        match name {
            "driving" => self.system.needed_driving(),
            "stiffness" => self.system.needed_stiffness(),
            _ => self.interfaces.parameter(name),
        }
    }

    fn family<'s>(
        &'s self,
        names: &[&str],
        _: [Coordinate; 2],
    ) -> Result<Box<dyn ParametrisedField + 's>> {
        for held in ["driving", "stiffness"] {
            if !names.contains(&held) {
                self.value(held)?;
            }
        }
        Ok(match *names {
            [first, second] => Box::new(OverUnequal::new(&self.interfaces, [first, second])?),
            [only] => {
                let other = if only == "driving" {
                    "stiffness"
                } else {
                    "driving"
                };
                Box::new(Held {
                    at: self.value(other)?.ln(),
                    family: OverUnequal::new(&self.interfaces, [only, other])?,
                })
            }
            _ => return Err(Error::Input("one parameter may vary, or two".into())),
        })
    }

    fn alike(&self, names: &[&str]) -> Option<Box<dyn ParametrisedField + '_>> {
        if !self.equal {
            return None;
        }
        let slab = InterfaceSystem {
            law: self.law().ok()?,
            interfaces: 2,
            loading: self.interfaces.loading,
        };
        let over = |names| OverLogarithms::new(slab, Symmetry::Symmetric, names).ok();
        Some(match *names {
            [first, second] => Box::new(over([first, second])?),
            [only] => {
                let other = other_than(only);
                Box::new(Held {
                    at: self.value(other).ok()?.ln(),
                    family: over([only, other])?,
                })
            }
            _ => return None,
        })
    }

    fn equilibria(&self, values: &[(&str, f64)]) -> Result<Vec<Vector>> {
        let interfaces = self.at(values)?;
        let found = unequal_steady_states(&interfaces.laws, interfaces.loading.driving)?;
        let state = |one: &crate::equilibrium::Equilibrium| {
            Vector::from_vec(vec![one.stress.value, one.log_state[0], one.log_state[1]])
        };
        Ok(found.equilibria.iter().map(state).collect())
    }

    fn orbit(&self, values: &[(&str, f64)]) -> Result<Option<ContinuationPoint>> {
        let Some((start, period)) = self.orbit else {
            return Ok(None);
        };
        let begin = InitialGuess::At { start, period };
        let accuracy = OrbitAccuracy {
            checked: false,
            ..OrbitAccuracy::of(Choice::Auto)
        };
        let found = find_unequal(&self.at(values)?, begin, &accuracy)?;
        Ok(Some(found.orbit.beginning()))
    }

    fn coordinate(&self, name: &str, ends: [f64; 2]) -> Result<Coordinate> {
        for end in ends {
            positive(name, end)?;
        }
        Ok(Coordinate::Logarithm)
    }

    fn has_equal_parts(&self) -> bool {
        self.equal
    }

    fn default_range(&self, name: &str) -> Option<(f64, f64)> {
        let (from, to) = match name {
            "driving" => following::DRIVING,
            "stiffness" => following::STIFFNESS,
            _ => return None,
        };
        let outward = |x| self.units().outward(quantity(name), x);
        Some((outward(from), outward(to)))
    }

    fn always_told(&self) -> Vec<(&'static str, Quantity)> {
        let names = ["driving", "stiffness"];
        names.map(|name| (name, quantity(name))).to_vec()
    }

    fn numbers(&self, _: RowKind) -> Vec<(String, Quantity)> {
        use Quantity::{SlipRate, State, Stress};
        let all = [
            ("stress", Stress),
            ("stress_min", Stress),
            ("stress_max", Stress),
            ("state_1", State),
            ("state_2", State),
            ("slip_rate_1", SlipRate),
            ("slip_rate_2", SlipRate),
        ];
        all.map(|(name, quantity)| (name.to_owned(), quantity))
            .to_vec()
    }

    fn told(&self, family: &dyn ParametrisedField, point: &GeneralPoint) -> Result<Vec<f64>> {
        let values = family.parameters(point.at);
        let names = self.interfaces.names();
        let places = family.plane();
        let there = [0, 1].map(|i| (names[places[i]], values[i]));
        let interfaces = self.at(&there)?;
        let profile = match &point.solution {
            GeneralSolution::Equilibrium { state, .. } => {
                let y = State::<3>::from_column_slice(state.as_slice());
                Profile {
                    mean_stress: y[0],
                    stress_range: (y[0], y[0]),
                    state: [y[1].exp(), y[2].exp()],
                    slip_rate: interfaces.slip_rates(&y),
                }
            }
            GeneralSolution::Orbit { shooting, .. } => {
                let field = AnyField::of::<3>(&interfaces);
                // In the states in which both move alike there is one state for both.
                let whole = |x: &Vector| Vector::from_vec(vec![x[0], x[1], x[x.len() - 1]]);
                let shooting = ShootingNodes {
                    nodes: shooting.nodes.iter().map(whole).collect(),
                    durations: shooting.durations.clone(),
                };
                profile_of(&field, &|y| interfaces.slip_rates(y), &shooting)?
            }
        };
        let Profile {
            mean_stress,
            stress_range: (least, most),
            state,
            slip_rate,
        } = profile;
        let rest = state.into_iter().chain(slip_rate);
        Ok([mean_stress, least, most].into_iter().chain(rest).collect())
    }
}

/// A family of which the second coordinate is held.
struct Held<F> {
    family: F,
    at: f64,
}

impl<F: ParametrisedField> ParametrisedField for Held<F> {
    fn dimension(&self) -> usize {
        self.family.dimension()
    }

    fn plane(&self) -> [usize; 2] {
        self.family.plane()
    }

    fn field(&self, at: [f64; 2]) -> AnyField<'_> {
        self.family.field([at[0], self.at])
    }

    fn parameters(&self, at: [f64; 2]) -> [f64; 2] {
        self.family.parameters([at[0], self.at])
    }

    fn scale(&self, at: [f64; 2]) -> [f64; 2] {
        [self.family.scale(at)[0], 0.0]
    }

    fn normal(&self, x: &Vector, flow: Vector) -> Vector {
        self.family.normal(x, flow)
    }

    fn across(&self, x: &Vector, flow: &Vector) -> Matrix {
        self.family.across(x, flow)
    }
}
