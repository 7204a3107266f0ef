//! What a number on the command line is measured in: dimensionless, or SI with `--si`.

use twinslip::error::{Error, MessageUnits, Result};
use twinslip::integrate::Tolerances;
use twinslip::model::scales::Scales;
use twinslip::number::Uncertain;

/// What a number measures.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quantity {
    /// Stress tau.
    Stress,
    /// Slip rate v, and the driving velocity.
    SlipRate,
    /// Slip.
    Length,
    /// Time.
    Time,
    /// A healing time, which stays in seconds in SI whatever the unit of times is.
    HealingTime,
    /// State psi: a number in (0, 1], or a time for the laws that do not bound it.
    State,
    /// ln psi.
    LogState,
    /// ln v.
    LogSlipRate,
    /// Mass of an interface per area.
    Mass,
    /// Stiffness K.
    Stiffness,
    /// An eigenvalue.
    Growth,
    /// A time over a stress.
    TimePerStress,
    /// Radiation damping eta.
    Damping,
    /// Normal stress sigma of an interface.
    NormalStress,
    /// A friction coefficient, a ratio, a name.
    Number,
}

impl Quantity {
    /// The quantity that a parameter of interfaces measures, by its name; the name of a parameter of one interface ends in its index.
    pub fn of_parameter(name: &str) -> Self {
        let stem = name.trim_end_matches(|c: char| c.is_ascii_digit());
        match stem.strip_suffix('_').unwrap_or(name) {
            "driving" => Quantity::SlipRate,
            "stiffness" => Quantity::Stiffness,
            "damping" => Quantity::Damping,
            "healing_time" => Quantity::HealingTime,
            "slip_length" | "second_slip_length" => Quantity::Length,
            "mass" => Quantity::Mass,
            "direct_cutoff_rate" | "evolution_cutoff_rate" | "weakening_rate" => Quantity::SlipRate,
            "driving_period" | "normal_stress_period" => Quantity::Time,
            "normal_stress" => Quantity::NormalStress,
            _ => Quantity::Number,
        }
    }
}

/// A unit of time beside SI.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TimeUnit {
    name: &'static str,
    /// The name of its inverse.
    inverse: &'static str,
    /// That of it over the pascal.
    per_pascal: &'static str,
    seconds: f64,
}

impl TimeUnit {
    /// The second.
    pub const SECOND: TimeUnit = TimeUnit {
        name: "s",
        inverse: "1/s",
        per_pascal: "s/Pa",
        seconds: 1.0,
    };

    /// The hour.
    pub(super) const HOUR: TimeUnit = TimeUnit {
        name: "hour",
        inverse: "1/hour",
        per_pascal: "hour/Pa",
        seconds: 3600.0,
    };
    /// The day.
    pub(super) const DAY: TimeUnit = TimeUnit {
        name: "day",
        inverse: "1/day",
        per_pascal: "day/Pa",
        seconds: 86_400.0,
    };
    /// The year, of 365.25 days.
    pub(super) const YEAR: TimeUnit = TimeUnit {
        name: "year",
        inverse: "1/year",
        per_pascal: "year/Pa",
        seconds: 31_557_600.0,
    };
    const ALL: [TimeUnit; 4] = [
        TimeUnit::SECOND,
        TimeUnit::HOUR,
        TimeUnit::DAY,
        TimeUnit::YEAR,
    ];

    /// The names by which the command line knows them.
    pub const NAMES: [&'static str; 4] = {
        let [a, b, c, d] = TimeUnit::ALL;
        [a.name, b.name, c.name, d.name]
    };

    /// Its length in seconds.
    pub(super) const fn seconds(self) -> f64 {
        self.seconds
    }

    /// The unit of this name.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a name that is not in [`TimeUnit::NAMES`].
    pub fn named(name: &str) -> Result<Self> {
        let unit = TimeUnit::ALL.into_iter().find(|unit| unit.name == name);
        unit.ok_or_else(|| Error::unknown("time-unit", name, &TimeUnit::NAMES))
    }
}

/// The units in which numbers come in and go out.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Units {
    scales: Option<Scales>,
    state_is_time: bool,
    time_unit: TimeUnit,
    /// L/V* in that unit; 1 without units.
    time: f64,
    /// Whether they have names.
    named: bool,
}

impl Units {
    /// SI by these scales, or dimensionless without; `state_is_time` for laws whose steady state is psi = L/V.
    pub fn new(scales: Option<Scales>, state_is_time: bool) -> Self {
        Units {
            scales,
            state_is_time,
            time_unit: TimeUnit::SECOND,
            time: scales.map_or(1.0, |scales| scales.time),
            named: true,
        }
    }

    /// SI for numbers that are in SI already, as those of measurements.
    pub fn measured() -> Self {
        Self::new(Scales::new(1.0, 1.0, 1.0, 1.0).ok(), false)
    }

    /// Of a user-defined system: whatever its equations are in.
    pub fn none() -> Self {
        Units {
            named: false,
            ..Self::new(None, false)
        }
    }

    /// The same with times in this unit, where they are in SI.
    pub fn in_time(self, time_unit: TimeUnit) -> Self {
        let of_scales = |scales: Scales| scales.time / time_unit.seconds;
        Units {
            time_unit,
            time: self.scales.map_or(1.0, of_scales),
            ..self
        }
    }

    /// Whether the numbers are in SI.
    pub fn si(&self) -> bool {
        self.scales.is_some()
    }

    /// One dimensionless unit, in the user's units.
    pub fn factor(&self, quantity: Quantity) -> f64 {
        let Some(scales) = &self.scales else {
            return 1.0;
        };
        match quantity {
            Quantity::Stress => scales.stress,
            Quantity::SlipRate => scales.slip_rate,
            Quantity::Length => scales.length,
            Quantity::Time => self.time,
            Quantity::HealingTime => scales.time,
            Quantity::Stiffness => scales.stiffness,
            Quantity::Growth => 1.0 / self.time,
            Quantity::TimePerStress => self.time / scales.stress,
            Quantity::Damping => scales.stress / scales.slip_rate,
            Quantity::NormalStress => scales.stress / scales.friction,
            Quantity::Mass => scales.stress * scales.time / scales.slip_rate,
            Quantity::State if self.state_is_time => self.time,
            Quantity::State | Quantity::LogState | Quantity::LogSlipRate | Quantity::Number => 1.0,
        }
    }

    /// The unit's name as the label of an axis has it.
    pub fn short_name(&self, quantity: Quantity) -> String {
        self.name(quantity).replace("sigma", "σ").replace(' ', "")
    }

    /// From dimensionless to the user's units. A time that a user has given comes back as it was given, and not off by the rounding of the
    /// conversion: of the times that are the same inward, the one of 15 digits.
    pub fn outward(&self, quantity: Quantity, x: f64) -> f64 {
        match quantity {
            Quantity::LogState => x + self.factor(Quantity::State).ln(),
            Quantity::LogSlipRate => x + self.factor(Quantity::SlipRate).ln(),
            Quantity::Time if self.si() => {
                let given = self.as_given(quantity, x);
                given.unwrap_or(x * self.factor(quantity))
            }
            _ => x * self.factor(quantity),
        }
    }

    /// The number of at most 15 digits in the user's units that is x inward, where there is one.
    fn as_given(&self, quantity: Quantity, x: f64) -> Option<f64> {
        let outward = x * self.factor(quantity);
        let round = format!("{outward:.14e}").parse().ok()?;
        (self.inward(quantity, round) == x).then_some(round)
    }

    /// From the user's units to dimensionless.
    pub fn inward(&self, quantity: Quantity, x: f64) -> f64 {
        match quantity {
            Quantity::LogState => x - self.factor(Quantity::State).ln(),
            Quantity::LogSlipRate => x - self.factor(Quantity::SlipRate).ln(),
            _ => x / self.factor(quantity),
        }
    }

    /// The largest step in the user's time, where there is one.
    pub fn max_step(&self, tolerances: Tolerances) -> Option<f64> {
        let longest = Some(tolerances.max_step).filter(|h| h.is_finite());
        longest.map(|h| self.outward(Quantity::Time, h))
    }

    /// A value and the bound on its error, in the user's units; conversion in and out costs a few roundings more. What a user has given is
    /// exact, and comes back as it was given.
    pub fn outward_uncertain(&self, quantity: Quantity, x: Uncertain) -> Uncertain {
        /// Roundings of the inputs, of the scales and of the product, generously.
        const CONVERSION_ULPS: f64 = 16.0;
        if !self.si() {
            return x;
        }
        if x.uncertainty == 0.0
            && let Some(given) = self.as_given(quantity, x.value)
        {
            return Uncertain::new(given, 0.0);
        }
        let value = self.outward(quantity, x.value);
        let rounding = CONVERSION_ULPS * f64::EPSILON * value.abs();
        Uncertain::new(value, x.uncertainty * self.factor(quantity) + rounding)
    }

    /// The same error, its numbers in the user's units.
    pub fn told(&self, error: Error) -> Error {
        if !self.si() {
            return error;
        }
        let unit = |quantity| (self.factor(quantity), self.name(quantity));
        error.in_units(&MessageUnits {
            time: unit(Quantity::Time),
            stress: unit(Quantity::Stress),
            slip_rate: unit(Quantity::SlipRate),
            stiffness: unit(Quantity::Stiffness),
        })
    }

    /// The unit's name.
    pub fn name(&self, quantity: Quantity) -> &'static str {
        let si = self.si();
        match quantity {
            _ if !self.named => "1",
            Quantity::Stress if si => "Pa",
            Quantity::Stress => "a sigma",
            Quantity::SlipRate if si => "m/s",
            Quantity::SlipRate => "V*",
            Quantity::Length if si => "m",
            Quantity::Length => "L",
            Quantity::Time if si => self.time_unit.name,
            Quantity::Time => "L/V*",
            Quantity::HealingTime if si => "s",
            Quantity::HealingTime => "L/V*",
            Quantity::Stiffness if si => "Pa/m",
            Quantity::Stiffness => "a sigma/L",
            Quantity::Growth if si => self.time_unit.inverse,
            Quantity::Growth => "V*/L",
            Quantity::TimePerStress if si => self.time_unit.per_pascal,
            Quantity::TimePerStress => "L/(V* a sigma)",
            Quantity::Damping if si => "Pa s/m",
            Quantity::Damping => "a sigma/V*",
            Quantity::NormalStress if si => "Pa",
            Quantity::NormalStress => "sigma",
            Quantity::Mass if si => "kg/m^2",
            Quantity::Mass => "a sigma L/V*^2",
            Quantity::State if self.state_is_time && si => self.time_unit.name,
            Quantity::State if self.state_is_time => "L/V*",
            Quantity::State | Quantity::LogState | Quantity::LogSlipRate | Quantity::Number => "1",
        }
    }

    /// The names of all units, by quantity: what the `units` object of the output holds.
    pub fn names(&self) -> Vec<(&'static str, &'static str)> {
        if !self.named {
            return Vec::new();
        }
        vec![
            ("stress", self.name(Quantity::Stress)),
            ("slip_rate", self.name(Quantity::SlipRate)),
            ("slip", self.name(Quantity::Length)),
            ("time", self.name(Quantity::Time)),
            ("state", self.name(Quantity::State)),
            ("stiffness", self.name(Quantity::Stiffness)),
            ("eigenvalue", self.name(Quantity::Growth)),
        ]
    }
}
