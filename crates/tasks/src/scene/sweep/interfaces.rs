//! Interfaces with a law that is built in, at the points of a grid of any of their parameters.

use super::super::options::SlabOptions;
use super::super::system::System;
use super::super::units::{Quantity, Units};
use super::axes::Axes;
use crate::scene::plan::NEAR_SYMMETRIC;
use twinslip::error::Result;
use twinslip::field::Vector;
use twinslip::friction::{Formulas, Law, beside};
use twinslip::integrate::{AnyField, MotionUnits};
use twinslip::model::{self, AlikeInterfaces};
use twinslip::number::polynomial::Crossing;
use twinslip::random::Random;
use twinslip::section::{Surface, usual_patience};
use twinslip::sweep::{
    SectionPlace, SystemPoint, SystemPoints, equal_interfaces, start_of_interfaces,
};

/// Part of the usual patience: some 20 periods of stick-slip.
pub(super) const PATIENCE: f64 = 0.1;

/// Interfaces of which some parameters vary.
#[derive(Debug)]
pub(super) struct InterfacePoints {
    slab: SlabOptions,
    axes: Axes,
    units: Units,
}

impl InterfacePoints {
    /// Of these options, and what varies of them.
    ///
    /// # Errors
    /// Those of the options at the ends of the axes.
    pub fn new(slab: &SlabOptions, axes: &Axes) -> Result<(Self, System)> {
        let mut slab = slab.clone();
        for name in &axes.names {
            slab.hold_healing_time(name)?;
        }
        let mut points = InterfacePoints {
            slab,
            axes: axes.clone(),
            units: Units::none(),
        };
        let mut systems = Vec::new();
        for corner in axes.corners() {
            let system = points.in_own_units(&corner)?;
            system.loading()?;
            systems.push(system);
        }
        // All points have the units of one, of that with the least unit of stress: then no error of a stress is larger than asked for.
        let unit = |system: &System| system.units.factor(Quantity::Stress);
        let least = systems.into_iter().reduce(|least, other| {
            if unit(&other) < unit(&least) {
                other
            } else {
                least
            }
        });
        let system = least.expect("there is a corner");
        points.units = system.units;
        Ok((points, system))
    }

    fn system(&self, values: &[f64]) -> Result<System> {
        self.in_own_units(values)?.measured_in(&self.units)
    }

    fn in_own_units(&self, values: &[f64]) -> Result<System> {
        let mut slab = self.slab.clone();
        let (mut driving, mut stiffness) = (self.axes.driving, self.axes.stiffness);
        for (name, value) in self.axes.names.iter().zip(values) {
            match name.as_str() {
                "driving" => driving = Some(*value),
                "stiffness" => stiffness = Some(*value),
                _ => slab.text.set.push(format!("{name}={value:?}")),
            }
        }
        System::of(&slab.resolved()?, driving, stiffness)
    }

    fn told(&self, values: &[f64]) -> Vec<f64> {
        let of = |name: &str, fixed: Option<f64>| {
            let place = self.axes.names.iter().position(|known| known == name);
            place.map(|place| values[place]).or(fixed)
        };
        let loading = [
            (of("driving", self.axes.driving), Quantity::SlipRate),
            (of("stiffness", self.axes.stiffness), Quantity::Stiffness),
        ];
        let inward = |(value, quantity): (Option<f64>, Quantity)| {
            self.units
                .inward(quantity, value.expect("it is fixed or varies"))
        };
        let others = self.axes.names.iter().zip(values);
        let others = others.filter(|(name, _)| !is_loading(name));
        let others = others.map(|(_, value)| *value);
        loading.map(inward).into_iter().chain(others).collect()
    }
}

/// Whether a parameter is V_H or K.
pub(super) fn is_loading(name: &str) -> bool {
    ["driving", "stiffness"].contains(&name)
}

impl SystemPoints for InterfacePoints {
    fn parameters(&self, values: &[f64]) -> Vec<f64> {
        self.told(values)
    }

    fn at(&self, values: &[f64], start: usize, random: Random) -> Result<SystemPoint> {
        let system = self.system(values)?;
        let loading = system.loading()?;
        let field = match (system.interfaces, system.unequal(loading)) {
            (1, None) => AnyField::new::<2>(model::single_interface(system.law, loading)),
            (1, Some(interfaces)) => AnyField::new::<2>(Box::new(AlikeInterfaces {
                interfaces,
                count: 1,
            })),
            (_, Some(unequal)) => AnyField::new::<3>(Box::new(unequal)),
            (_, None) => return Ok(equal_interfaces(system.law, loading, start, random)),
        };
        let stress = system.steady_stress(loading.driving);
        let laws = &system.laws()[..system.interfaces];
        let v = loading.driving / system.interfaces as f64;
        let steady: Vec<f64> = laws.iter().map(|law| law.steady_state(v).ln()).collect();
        let mut begin = match start {
            0 => std::iter::once(stress).chain(steady).collect(),
            kind => start_of_interfaces(kind, random, stress, &steady),
        };
        if start == 0
            && let Some(last) = begin.last_mut()
        {
            *last = beside(&system.law, *last, NEAR_SYMMETRIC);
        }
        if system.law.bounds_state() {
            begin[1..].iter_mut().for_each(|w| *w = w.min(0.0));
        }
        let patience = PATIENCE * usual_patience(loading.driving, loading.stiffness);
        let surface = Surface::stress(begin.len(), stress, Crossing::Downwards);
        Ok(SystemPoint {
            units: MotionUnits::given(begin.len()),
            field,
            start: Vector::from_vec(begin),
            section: SectionPlace::Known(surface, patience),
            equal_parts: system.interfaces == 2 && system.constants[0] == system.constants[1],
            lane: None,
            enclosed: None,
        })
    }
}
