//! Two interfaces, equal or not, to be continued in any of their parameters.

use super::{RowKind, Subject};
use crate::bifurcation::general::{GeneralPoint, GeneralSolution};
use crate::equilibrium::unequal_steady_states;
use crate::error::{Error, Result};
use crate::field::{Matrix, Parametrised, State, Vector};
use crate::friction::{Law, UnequalLaws, positive};
use crate::integrate::AnyField;
use crate::model::{Driven, Loading, UnequalInterfaces};
use crate::orbit::{
    ContinuationPoint, Coordinate, OverUnequal, ParametrisedField, Profile, profile_of,
};
use crate::scene::following;
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
            system,
        })
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

    fn equilibria(&self, values: &[(&str, f64)]) -> Result<Vec<Vector>> {
        let interfaces = self.at(values)?;
        let found = unequal_steady_states(&interfaces.laws, interfaces.loading.driving)?;
        let state = |one: &crate::equilibrium::Equilibrium| {
            Vector::from_vec(vec![one.stress.value, one.log_state[0], one.log_state[1]])
        };
        Ok(found.equilibria.iter().map(state).collect())
    }

    fn orbit(&self, _: &[(&str, f64)]) -> Result<Option<ContinuationPoint>> {
        Ok(None)
    }

    fn coordinate(&self, name: &str, ends: [f64; 2]) -> Result<Coordinate> {
        for end in ends {
            positive(name, end)?;
        }
        Ok(Coordinate::Logarithm)
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
                profile_of(&field, &|y| interfaces.slip_rates(y), shooting)?
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
