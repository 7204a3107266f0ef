//! One interface or two, equal or not, to be continued in any of their parameters.

use super::{RowKind, Subject};
use crate::scene::following;
use crate::scene::plan::{self, Point};
use crate::scene::system::{Described, System};
use crate::scene::units::{Quantity, Units};
use serde_json::{Map, Value};
use twinslip::equilibrium::{Symmetry, unequal_steady_states};
use twinslip::error::{Error, Result};
use twinslip::field::{Matrix, Parametrised, State, Vector};
use twinslip::friction::{AnyLaw, Law, Parameters, UnequalLaws, positive};
use twinslip::integrate::AnyField;
use twinslip::model::{AlikeInterfaces, Driven, Loading, UnequalInterfaces};
use twinslip::orbit::{
    ContinuationPoint, Coordinate, Digits, InitialGuess, InterfaceSystem, OrbitAccuracy,
    OverDifferenceChart, OverInterfaces, OverLoadings, OverLogarithms, ParametrisedField, Profile,
    Query, ShootingNodes, Solution, find, find_either, find_unequal, profile_of,
};

/// Interfaces with V_H and K.
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
    /// Interfaces of which these parameters vary.
    ///
    /// # Errors
    /// [`Error::Input`] for a parameter that is the unit of others, where these have no units.
    pub fn new(mut system: System, free: &[&str]) -> Result<Self> {
        let laws = match system.unequal {
            Some(laws) => laws,
            None => UnequalLaws::new(system.law.name(), system.constants, system.law.damping())?,
        };
        // A law without damping has no parameter of this name.
        let laws = if free.contains(&"damping") && laws.damping() == 0.0 {
            laws.with(*laws.constants(), 1.0)?
        } else {
            laws
        };
        // In SI the units stay those of the reference values, whatever varies.
        let laws = match system.units.si() {
            true => laws.measured_in(system.direct_effect)?,
            false => laws,
        };
        for (name, others) in SCALES {
            let indexed = format!("{name}_1");
            let of_first = free.iter().find(|free| **free == name || **free == indexed);
            if let Some(free) = of_first.filter(|_| !system.units.si()) {
                return Err(Error::Input(format!(
                    "`{free}` is the unit of other numbers and cannot vary without `si`; {others} instead, or give values with units"
                )));
            }
        }
        if system.units.si() {
            free.iter().for_each(|name| system.vary(name));
        }
        let loading = Loading {
            driving: system.driving.unwrap_or(1.0),
            stiffness: system.stiffness.unwrap_or(1.0),
        };
        Ok(SlabSubject {
            interfaces: UnequalInterfaces { laws, loading },
            equal: system.interfaces == 2
                && system.unequal.is_none()
                && free.iter().all(|name| !of_one(name)),
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

    /// Equal interfaces in units of their own, a_1 sigma_1 and L_1, with the damping that may vary.
    fn slab(&self, interfaces: &UnequalInterfaces) -> Result<(InterfaceSystem, OwnUnits)> {
        let constants = interfaces.laws.constants()[0];
        let own = OwnUnits::of(&interfaces.laws);
        let parameters = Parameters::new(
            constants.direct_effect,
            constants.evolution_effect,
            constants.reference_friction,
            constants.healing_time / own.time,
            constants.residual_strength,
        )?;
        let damping = interfaces.laws.damping() / own.stress;
        let Loading { driving, stiffness } = interfaces.loading;
        let slab = InterfaceSystem {
            law: AnyLaw::named(interfaces.laws.name(), parameters.damped(damping)?)?,
            interfaces: self.system.interfaces,
            loading: Loading {
                driving,
                stiffness: stiffness * own.time / own.stress,
            },
        };
        Ok((slab, own))
    }

    /// There is one.
    fn is_single(&self) -> bool {
        self.system.interfaces == 1
    }

    fn alike_interfaces(&self) -> AlikeInterfaces {
        AlikeInterfaces {
            interfaces: self.interfaces,
            count: self.system.interfaces,
        }
    }

    /// What rows tell of a profile.
    pub(super) fn shown(&self, profile: &Profile) -> Vec<f64> {
        let (least, most) = profile.stress_range;
        let shown = self.system.interfaces;
        let pairs = [profile.state, profile.slip_rate].into_iter();
        let rest = pairs.flat_map(|pair| pair.into_iter().take(shown));
        let stress = [profile.mean_stress, least, most].into_iter();
        stress.chain(rest).collect()
    }

    /// Over these parameters.
    fn over(&self, names: [&str; 2]) -> Result<OverInterfaces> {
        match self.is_single() {
            true => OverInterfaces::alike(&self.alike_interfaces(), names),
            false => OverInterfaces::new(&self.interfaces, names),
        }
    }

    /// Over one parameter, in the variables of all interfaces and, of equal ones that move alike whatever its value, in those of one.
    pub(in crate::scene) fn both(&self, name: &str) -> Result<(Family<'_>, Option<Family<'_>>)> {
        let names = [name, other_than(name)];
        let alike = || OverInterfaces::alike(&self.alike_interfaces(), names);
        let alike = self.equal.then(alike).transpose()?;
        let alike = alike.map(|over| self.held(over, names[1])).transpose()?;
        Ok((self.held(self.over(names)?, names[1])?, alike))
    }

    fn held(&self, family: impl ParametrisedField + 'static, other: &str) -> Result<Family<'_>> {
        Ok(Box::new(Held {
            at: self.value(other)?.ln(),
            family: Box::new(family),
        }))
    }

    fn at(&self, values: &[(&str, f64)]) -> Result<UnequalInterfaces> {
        let mut interfaces = self.interfaces;
        for &(name, value) in values {
            interfaces = interfaces.with(name, value)?;
        }
        Ok(interfaces)
    }
}

/// The units of one interface, in those of the branch. V* is the unit of slip rates of both.
#[derive(Debug, Clone, Copy)]
struct OwnUnits {
    /// a_1 sigma_1/(a sigma)
    stress: f64,
    /// L_1/L
    time: f64,
    /// ln of the unit of psi, which is L_1/V* where the law does not bound psi.
    log_state: f64,
}

impl OwnUnits {
    fn of(laws: &UnequalLaws) -> Self {
        let first = laws.constants()[0];
        let time = first.slip_length;
        OwnUnits {
            stress: first.normal_stress * (first.direct_effect / laws.unit_of_stress()),
            time,
            log_state: match laws.laws()[0].bounds_state() {
                true => 0.0,
                false => time.ln(),
            },
        }
    }

    /// tau and all ln psi.
    fn outward(self, mut state: Vector) -> Vector {
        state[0] *= self.stress;
        state.iter_mut().skip(1).for_each(|w| *w += self.log_state);
        state
    }

    /// tau and the ln psi of two interfaces, from the units of the branch.
    fn inward(self, (stress, log_state): Point) -> Point {
        (stress / self.stress, log_state.map(|w| w - self.log_state))
    }

    fn outward_orbit(self, orbit: ContinuationPoint) -> ContinuationPoint {
        let ShootingNodes { nodes, durations } = orbit.shooting;
        ContinuationPoint {
            shooting: ShootingNodes {
                nodes: nodes.into_iter().map(|node| self.outward(node)).collect(),
                durations: durations.into_iter().map(|t| t * self.time).collect(),
            },
            at: orbit.at,
        }
    }
}

/// Parameters of the first interface by which all is dimensionless, and what may vary in their place.
const SCALES: [(&str, &str); 2] = [
    ("slip_length", "vary `stiffness` and `healing_time`"),
    ("normal_stress", "vary `stiffness`"),
];

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
        let alike = self.alike_interfaces();
        let names = match self.is_single() {
            true => alike.names(),
            false => self.interfaces.names(),
        };
        names
            .iter()
            .map(|&name| (name, Quantity::of_parameter(name)))
            .collect()
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
            [first, second] => Box::new(self.over([first, second])?),
            [only] => {
                let other = other_than(only);
                self.held(self.over([only, other])?, other)?
            }
            _ => return Err(Error::Input("one parameter may vary, or two".into())),
        })
    }

    fn alike(&self, names: &[&str]) -> Option<Box<dyn ParametrisedField + '_>> {
        if !self.equal {
            return None;
        }
        let (slab, _) = self.slab(&self.interfaces).ok()?;
        let (names, held) = match *names {
            [first, second] => ([first, second], None),
            [only] => {
                let other = other_than(only);
                ([only, other], Some(self.value(other).ok()?.ln()))
            }
            _ => return None,
        };
        // Compiled for the constants that laws have.
        let family: Box<dyn ParametrisedField> =
            match OverLogarithms::new(slab, Symmetry::Symmetric, names) {
                Ok(over) => Box::new(over),
                Err(_) => Box::new(OverInterfaces::alike(&self.alike_interfaces(), names).ok()?),
            };
        Some(match held {
            Some(at) => Box::new(Held { at, family }),
            None => family,
        })
    }

    fn difference(&self, names: &[&str]) -> Option<Box<dyn ParametrisedField + '_>> {
        if !self.equal || names != ["driving", "stiffness"] {
            return None;
        }
        let (slab, own) = self.slab(&self.interfaces).ok()?;
        // In other units than its own states have other logarithms.
        let is_own = own.stress == 1.0 && own.time == 1.0 && own.log_state == 0.0;
        let chart = || OverDifferenceChart(OverLoadings::new(slab, Symmetry::Asymmetric));
        is_own.then(|| Box::new(chart()) as _)
    }

    fn equilibria(&self, values: &[(&str, f64)]) -> Result<Vec<Vector>> {
        let interfaces = self.at(values)?;
        if self.is_single() {
            let (slab, own) = self.slab(&interfaces)?;
            let state = vec![slab.steady_stress(), slab.steady_log_state()];
            return Ok(vec![own.outward(Vector::from_vec(state))]);
        }
        let found = unequal_steady_states(&interfaces.laws, interfaces.loading.driving)?;
        let state = |one: &twinslip::equilibrium::Equilibrium| {
            Vector::from_vec(vec![one.stress.value, one.log_state[0], one.log_state[1]])
        };
        Ok(found.equilibria.iter().map(state).collect())
    }

    fn orbit(&self, values: &[(&str, f64)]) -> Result<Option<ContinuationPoint>> {
        let Some((start, period)) = self.orbit else {
            return Ok(None);
        };
        let accuracy = OrbitAccuracy::unchecked();
        let interfaces = self.at(values)?;
        if !self.is_single() {
            let begin = InitialGuess::At { start, period };
            let found = find_unequal(&interfaces, begin, &accuracy)?;
            return Ok(Some(found.orbit.beginning()));
        }
        let (slab, own) = self.slab(&interfaces)?;
        let query = Query {
            symmetry: Symmetry::Symmetric,
            begin: InitialGuess::At {
                start: own.inward(start),
                period: period.map(|t| t / own.time),
            },
        };
        let found = find(&slab, &query, &accuracy)?;
        Ok(Some(own.outward_orbit(found.orbit.beginning())))
    }

    fn orbits(&self, values: &[(&str, f64)]) -> Vec<ContinuationPoint> {
        let search = || -> Result<Vec<ContinuationPoint>> {
            let interfaces = self.at(values)?;
            let accuracy = OrbitAccuracy::unchecked();
            if !self.equal && !self.is_single() {
                let found = find_unequal(&interfaces, InitialGuess::Anywhere, &accuracy)?;
                return Ok(found.beginnings());
            }
            let (slab, own) = self.slab(&interfaces)?;
            let found = find_either(&slab, &accuracy)?.beginnings().into_iter();
            Ok(found.map(|orbit| own.outward_orbit(orbit)).collect())
        };
        search().unwrap_or_default()
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
        let (from, to) = following::loading_range(name)?;
        let outward = |x| self.units().outward(Quantity::of_parameter(name), x);
        Some((outward(from), outward(to)))
    }

    fn always_told(&self) -> Vec<(&'static str, Quantity)> {
        let names = ["driving", "stiffness"];
        names
            .map(|name| (name, Quantity::of_parameter(name)))
            .to_vec()
    }

    fn dimension(&self) -> usize {
        self.system.interfaces + 1
    }

    fn states(&self) -> Vec<(String, Quantity)> {
        let states = (1..=self.system.interfaces).map(|i| (format!("state_{i}"), Quantity::State));
        let stress = [("stress".to_owned(), Quantity::Stress)];
        stress.into_iter().chain(states).collect()
    }

    fn state_outward(&self, state: &Vector) -> Vec<f64> {
        // In the states in which both move alike there is one state for both.
        let states = (1..=self.system.interfaces).map(|i| state[i.min(state.len() - 1)].exp());
        [state[0]].into_iter().chain(states).collect()
    }

    fn state_inward(&self, states: &[f64]) -> Vector {
        let logs = states[1..].iter().map(|psi| psi.ln());
        Vector::from_iterator(states.len(), [states[0]].into_iter().chain(logs))
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
        all.into_iter()
            .filter(|(name, _)| !(self.is_single() && name.ends_with("_2")))
            .map(|(name, quantity)| (name.to_owned(), quantity))
            .collect()
    }

    fn told(
        &self,
        (family, at): (&dyn ParametrisedField, [f64; 2]),
        solution: Solution<'_>,
        digits: Digits,
    ) -> Result<Vec<f64>> {
        let values = family.parameters(at);
        let names = self.parameters();
        let places = family.plane();
        let there = [0, 1].map(|i| (names[places[i]].0, values[i]));
        let interfaces = self.at(&there)?;
        let profile = match solution {
            Solution::Equilibrium { state, .. } => {
                let y = State::<3>::new(state[0], state[1], state[state.len() - 1]);
                Profile {
                    mean_stress: y[0],
                    stress_range: (y[0], y[0]),
                    state: [y[1].exp(), y[2].exp()],
                    slip_rate: interfaces.slip_rates(&y),
                }
            }
            Solution::Orbit(shooting) => {
                let rates = |y: &State<3>| interfaces.slip_rates(y);
                if self.is_single() {
                    let field = family.field(at);
                    return Ok(self.shown(&profile_of(&field, &rates, shooting, digits)?));
                }
                let field = AnyField::of::<3>(&interfaces);
                // In the states in which both move alike there is one state for both.
                let whole = |x: &Vector| Vector::from_vec(vec![x[0], x[1], x[x.len() - 1]]);
                let shooting = ShootingNodes {
                    nodes: shooting.nodes.iter().map(whole).collect(),
                    durations: shooting.durations.clone(),
                };
                profile_of(&field, &rates, &shooting, digits)?
            }
        };
        Ok(self.shown(&profile))
    }
}

/// A family over the parameters of interfaces.
pub(in crate::scene) type Family<'s> = Box<dyn ParametrisedField + 's>;

/// A family of which the second coordinate is held.
struct Held<'f> {
    family: Box<dyn ParametrisedField + 'f>,
    at: f64,
}

impl ParametrisedField for Held<'_> {
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
