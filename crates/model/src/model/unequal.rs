//! Two interfaces that differ, under one stress: (19) with a law for each.

use super::response::Response;
use super::{Driven, Loading, Smooth, stress_rate};
use crate::error::{Error, Result};
use crate::field::{Analytic, Jacobian, Parametrised, State, VectorField, place};
use crate::friction::{Formulas, InterfaceConstants, Law, ScaledLaw, UnequalLaws, positive};
use crate::number::{Free, Real, With};
use crate::series::{ByRecording, Equations, Jet3, Recorded, Solution, Tangent, TaylorMap};
use std::sync::LazyLock;

/// dtau/dt = K (V_H - v_1 - v_2), dw_i/dt = g_i(v_i, w_i), in the state (tau, w_1, w_2), w = ln psi, with v_i and g_i by the law of
/// interface i ([`UnequalLaws`]).
///
/// Its parameters are all constants by their names: with an index those of one interface, without those of both, which then move
/// together.
///
/// ```
/// use twinslip::field::Parametrised;
/// use twinslip::friction::{InterfaceConstants, UnequalLaws};
/// use twinslip::model::{Loading, UnequalInterfaces};
/// # fn main() -> twinslip::Result<()> {
/// let first = InterfaceConstants::heslot_1994();
/// let second = InterfaceConstants { residual_strength: 1.1e-3, ..first };
/// let laws = UnequalLaws::new("spinodal", [first, second], 0.0)?;
/// let two = UnequalInterfaces { laws, loading: Loading::new(10.0, 0.14)? };
/// assert!(two.names().contains(&"residual_strength_2"));
/// assert_eq!(two.with("residual_strength_2", 2e-3)?.parameter("residual_strength_2")?, 2e-3);
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct UnequalInterfaces {
    /// Their laws.
    pub laws: UnequalLaws,
    /// V_H and K.
    pub loading: Loading,
}

/// All names of parameters; a system has those of the constants that its law has.
const NAMES: [&str; 24] = [
    "driving",
    "stiffness",
    "damping",
    "healing_time",
    "healing_time_1",
    "healing_time_2",
    "residual_strength",
    "residual_strength_1",
    "residual_strength_2",
    "direct_effect",
    "direct_effect_1",
    "direct_effect_2",
    "evolution_effect",
    "evolution_effect_1",
    "evolution_effect_2",
    "reference_friction",
    "reference_friction_1",
    "reference_friction_2",
    "slip_length",
    "slip_length_1",
    "slip_length_2",
    "normal_stress",
    "normal_stress_1",
    "normal_stress_2",
];

/// So many of them.
pub(super) const MOST: usize = NAMES.len();

/// What a named parameter sets.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Target {
    Driving,
    Stiffness,
    Damping,
    /// A constant by its place among [`InterfaceConstants::NAMES`], of these interfaces.
    Constant(usize, [bool; 2]),
}

impl Target {
    fn named(name: &str) -> Self {
        let (name, of) = match name.rsplit_once('_') {
            Some((name, "1")) => (name, [true, false]),
            Some((name, "2")) => (name, [false, true]),
            _ => (name, [true; 2]),
        };
        match name {
            "driving" => Target::Driving,
            "stiffness" => Target::Stiffness,
            "damping" => Target::Damping,
            _ => {
                let mut names = InterfaceConstants::NAMES.iter();
                let place = names.position(|known| *known == name);
                Target::Constant(place.expect("the name of a constant"), of)
            }
        }
    }

    fn is_of_laws(self) -> bool {
        !matches!(self, Target::Driving | Target::Stiffness)
    }
}

/// The names that systems have: by whether the state heals in a finite time, whether there is a residual strength, and a damping; and
/// whether there is a parameter of one interface.
fn names_of(has: [bool; 4]) -> &'static [&'static str] {
    static TABLES: LazyLock<[Vec<&'static str>; 16]> = LazyLock::new(|| {
        std::array::from_fn(|i| {
            let has = |bit: usize| i & (1 << bit) != 0;
            let there = |name: &&str| match Target::named(name) {
                Target::Damping => has(2),
                Target::Constant(_, of) if of != [true; 2] && !has(3) => false,
                Target::Constant(0, _) => has(0),
                Target::Constant(1, _) => has(1),
                _ => true,
            };
            NAMES.into_iter().filter(there).collect()
        })
    });
    let bits = has.iter().enumerate();
    let table = bits
        .map(|(bit, &has)| usize::from(has) << bit)
        .sum::<usize>();
    &TABLES[table]
}

impl UnequalInterfaces {
    /// The value of the parameter of this name.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a name that is not among [`Parametrised::names`], and for one without an index of which the interfaces
    /// have two values.
    pub fn parameter(&self, name: &str) -> Result<f64> {
        let target = Target::named(self.names()[place(self.names(), name)?]);
        if let Target::Constant(at, [true, true]) = target {
            let [first, second] = self.constants().map(|all| all[at]);
            if first != second {
                let must =
                    format!("asked for as {name}_1 or {name}_2, as the interfaces differ in it");
                return Err(Error::parameter(
                    name,
                    format!("{first} and {second}"),
                    must,
                ));
            }
        }
        Ok(self.value(target))
    }

    /// The same interfaces with another value of the parameter of this name.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a name that is not among [`Parametrised::names`], and for a value outside its domain.
    pub fn with(&self, name: &str, value: f64) -> Result<Self> {
        let mut other = *self;
        let mut constants = self.constants();
        let mut damping = self.laws.damping();
        match Target::named(self.names()[place(self.names(), name)?]) {
            Target::Driving => other.loading.driving = positive("driving", value)?,
            Target::Stiffness => other.loading.stiffness = positive("stiffness", value)?,
            Target::Damping => damping = positive("damping", value)?,
            Target::Constant(at, of) => {
                for (constants, _) in constants.iter_mut().zip(of).filter(|(_, of)| *of) {
                    constants[at] = value;
                }
            }
        }
        other.laws = self.laws.with(constants.map(Into::into), damping)?;
        Ok(other)
    }

    fn constants(&self) -> [[f64; InterfaceConstants::NAMES.len()]; 2] {
        self.laws.constants().map(Into::into)
    }

    fn all_names(&self) -> &'static [&'static str] {
        self.named(true)
    }

    /// The names of its parameters; those of one interface, too, or not.
    pub(super) fn named(&self, of_one: bool) -> &'static [&'static str] {
        let mut law = self.laws.laws()[0];
        let [_, _, healing, residual, damping] = law.constants().map(|constant| constant.is_some());
        names_of([healing, residual, damping, of_one])
    }

    /// Of a constant of both interfaces that of the first.
    fn value(&self, target: Target) -> f64 {
        match target {
            Target::Driving => self.loading.driving,
            Target::Stiffness => self.loading.stiffness,
            Target::Damping => self.laws.damping(),
            Target::Constant(at, of) => self.constants()[usize::from(!of[0])][at],
        }
    }

    /// The equations in the parameters of these targets, the others being held.
    fn in_targets<const P: usize>(
        &self,
        targets: [Option<Target>; P],
    ) -> Smooth<InTargets<P>, 3, P> {
        Smooth {
            equations: InTargets {
                interfaces: *self,
                targets,
            },
            parameters: targets.map(|target| target.map_or(0.0, |target| self.value(target))),
        }
    }

    /// In V_H and K.
    pub(super) fn in_loading(&self) -> Smooth<InTargets<2>, 3, 2> {
        self.in_targets([Some(Target::Driving), Some(Target::Stiffness)])
    }

    /// In the parameters of these places among its names.
    fn in_places<const P: usize>(&self, places: &[usize]) -> Smooth<InTargets<P>, 3, P> {
        self.in_names(self.names(), places)
    }

    /// In the parameters of these places among some names.
    pub(super) fn in_names<const P: usize>(
        &self,
        names: &[&str],
        places: &[usize],
    ) -> Smooth<InTargets<P>, 3, P> {
        self.in_targets(std::array::from_fn(|i| {
            places.get(i).map(|&place| Target::named(names[place]))
        }))
    }
}

/// The equations of unequal interfaces whose parameters are P of all; a parameter without a target enters nowhere.
#[derive(Debug, Clone, Copy)]
pub struct InTargets<const P: usize> {
    interfaces: UnequalInterfaces,
    targets: [Option<Target>; P],
}

impl<const P: usize> InTargets<P> {
    /// V_H and K.
    pub(super) fn loading<T: Real>(&self, parameters: &[T; P]) -> (T, T) {
        let of = |target: Target| {
            let mut set = self.targets.iter().zip(parameters);
            let found = set.find(|(set, _)| **set == Some(target));
            found.map_or_else(|| T::constant(self.interfaces.value(target)), |(_, &p)| p)
        };
        (of(Target::Driving), of(Target::Stiffness))
    }

    /// The laws, where a parameter sets one of their constants.
    fn freed<T: Real>(&self, parameters: &[T; P]) -> Option<[ScaledLaw<Free<T>>; 2]> {
        let targets = self.targets.iter().zip(parameters);
        let mut of_laws = targets
            .filter_map(|(target, &p)| Some(((*target)?, p)))
            .filter(|(target, _)| target.is_of_laws())
            .peekable();
        of_laws.peek()?;
        let base = self.interfaces.constants();
        let mut damping = T::constant(self.interfaces.laws.damping());
        let mut constants = base.map(|all| all.map(T::constant));
        let mut moved = [[false; InterfaceConstants::NAMES.len()]; 2];
        for (target, p) in of_laws {
            let Target::Constant(at, of) = target else {
                damping = p;
                continue;
            };
            let value = self.interfaces.value(target);
            for i in (0..2).filter(|&i| of[i]) {
                // Of constants that differ, or that two parameters move, the difference is added.
                constants[i][at] = if base[i][at] == value && !moved[i][at] {
                    p
                } else {
                    constants[i][at] + (p - value)
                };
                moved[i][at] = true;
            }
        }
        Some(self.interfaces.laws.freed(&constants, damping))
    }

    /// What the first interface does.
    pub(super) fn response<T: Real>(&self, tau: T, w: T, parameters: &[T; P]) -> Response<T> {
        match self.freed(parameters) {
            None => of_law(&self.interfaces.laws.laws()[0], tau, w),
            Some(laws) => of_law(&laws[0], tau, w),
        }
    }

    /// What both interfaces do.
    fn responses<T: Real>(
        &self,
        [tau, first, second]: [T; 3],
        parameters: &[T; P],
    ) -> [Response<T>; 2] {
        match self.freed(parameters) {
            None => {
                let [one, other] = self.interfaces.laws.laws();
                [of_law(one, tau, first), of_law(other, tau, second)]
            }
            Some([one, other]) => [of_law(&one, tau, first), of_law(&other, tau, second)],
        }
    }
}

fn of_law<C, T: With<C>>(law: &impl Formulas<C>, tau: T, w: T) -> Response<T> {
    Response::new(law, Formulas::<C>::activation(law, tau), w)
}

impl<const P: usize> Equations<3, P> for InTargets<P> {
    const PARAMETERS: [&'static str; P] = ["parameter"; P];

    fn rates<T: Real>(&self, x: [T; 3], parameters: [T; P]) -> [T; 3] {
        let [first, second] = self.responses(x, &parameters);
        let loading = self.loading(&parameters);
        [stress_rate(loading, first.v + second.v), first.g, second.g]
    }

    fn slip_rates<T: Real>(&self, x: [T; 3], parameters: [T; P]) -> [Option<T>; 2] {
        self.responses(x, &parameters)
            .map(|response| Some(response.v))
    }

    fn lasting(&self) -> Option<&'static str> {
        let laws = &self.interfaces.laws;
        laws.laws()[0].lasts().then(|| laws.name())
    }
}

/// A vector field by its equations in V_H and K, `in_loading`, or in any parameters, `in_places`, and their names, `names`.
macro_rules! field_in_any_parameter {
    ($field:ident, $n:literal) => {
        impl VectorField<$n> for $field {
            fn f(&self, y: &State<$n>) -> State<$n> {
                self.in_loading().f(y)
            }

            fn jacobian(&self, y: &State<$n>) -> Jacobian<$n> {
                self.in_loading().jacobian(y)
            }

            fn second_derivative(&self, y: &State<$n>, u: &State<$n>, v: &State<$n>) -> State<$n> {
                self.in_loading().second_derivative(y, u, v)
            }

            fn lasting(&self) -> Option<&'static str> {
                self.in_loading().lasting()
            }

            fn has_spikes(&self) -> bool {
                false
            }

            fn parametrised(&self) -> Option<&dyn Parametrised<$n>> {
                Some(self)
            }

            fn analytic(&self) -> Option<&dyn Analytic<$n>> {
                Some(self)
            }
        }

        impl Parametrised<$n> for $field {
            fn names(&self) -> &[&'static str] {
                self.all_names()
            }

            fn parameter_derivative(&self, y: &State<$n>, place: usize) -> State<$n> {
                self.in_places::<1>(&[place]).parameter_derivative(y, 0)
            }

            fn parameter_jacobian(&self, y: &State<$n>, place: usize) -> Jacobian<$n> {
                self.in_places::<1>(&[place]).parameter_jacobian(y, 0)
            }
        }

        impl Analytic<$n> for $field {
            fn solution(&self) -> Box<dyn Solution<$n> + '_> {
                formula(self.in_loading()).solution()
            }

            fn reference(&self) -> Box<dyn Solution<$n> + '_> {
                formula(self.in_loading()).reference()
            }

            fn tangent(&self, free: &[usize]) -> Box<dyn Tangent<$n> + '_> {
                let all: Vec<usize> = (0..free.len()).collect();
                if free.len() <= 2 {
                    formula(self.in_places::<2>(free)).tangent(&all)
                } else {
                    formula(self.in_places::<MOST>(free)).tangent(&all)
                }
            }

            fn reference_tangent(&self, free: &[usize]) -> Box<dyn Tangent<$n> + '_> {
                let all: Vec<usize> = (0..free.len()).collect();
                if free.len() <= 2 {
                    formula(self.in_places::<2>(free)).reference_tangent(&all)
                } else {
                    formula(self.in_places::<MOST>(free)).reference_tangent(&all)
                }
            }

            fn transport(&self, start: [Jet3; $n]) -> Option<Box<dyn TaylorMap<$n> + '_>> {
                Some(formula(self.in_loading()).transport(start))
            }
        }
    };
}
pub(super) use field_in_any_parameter;

/// The same equations, recorded.
pub(super) fn formula<S: Equations<N, P>, const N: usize, const P: usize>(
    field: Smooth<S, N, P>,
) -> Recorded<S, N, P> {
    Recorded {
        equations: field.equations,
        parameters: field.parameters,
        symmetric: false,
    }
}

field_in_any_parameter! { UnequalInterfaces, 3 }

impl Driven<3> for UnequalInterfaces {
    fn slip_rates(&self, y: &State<3>) -> [f64; 2] {
        let of = |law: &ScaledLaw, w: f64| law.slip_rate(law.activation(y[0]), w.exp());
        let [first, second] = self.laws.laws();
        [of(first, y[1]), of(second, y[2])]
    }
}
