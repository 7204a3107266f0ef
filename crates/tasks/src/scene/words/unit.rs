//! Numbers with a unit, such as `10um` and `1nm/s`: what they measure, and their value in SI.

use crate::scene::units::TimeUnit;

/// What a number measures, by its unit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in super::super) enum Kind {
    Number,
    Length,
    Time,
    Stress,
    Velocity,
    Stiffness,
    Damping,
    Mass,
    MassPerArea,
}

impl Kind {
    /// Powers of length, time and stress.
    fn dimensions(self) -> [i8; 3] {
        match self {
            Kind::Number => [0, 0, 0],
            Kind::Length => [1, 0, 0],
            Kind::Time => [0, 1, 0],
            Kind::Stress => [0, 0, 1],
            Kind::Velocity => [1, -1, 0],
            Kind::Stiffness => [-1, 0, 1],
            Kind::Damping => [-1, 1, 1],
            // A kilogram is a Pa m s^2.
            Kind::Mass => [1, 2, 1],
            Kind::MassPerArea => [-1, 2, 1],
        }
    }

    /// Its name, and a unit in which it is often given.
    fn example(self) -> (&'static str, &'static str) {
        match self {
            Kind::Number => ("a number without a unit", ""),
            Kind::Length => ("a length", "um"),
            Kind::Time => ("a time", "year"),
            Kind::Stress => ("a stress", "MPa"),
            Kind::Velocity => ("a velocity", "um/s"),
            Kind::Stiffness => ("a stiffness", "MPa/mm"),
            Kind::Damping => ("a damping", "MPa.s/m"),
            Kind::Mass => ("a mass", "kg"),
            Kind::MassPerArea => ("a mass per area", "kg/m^2"),
        }
    }
}

/// A unit or a product of units: its dimensions, the power of ten, and the factor beside it as a ratio.
#[derive(Debug, Clone, Copy)]
struct Unit {
    dimensions: [i8; 3],
    power: i32,
    ratio: (f64, f64),
}

/// The units that products and quotients are made of, and that heads of columns have: name, kind, power of ten, and a number of seconds beside that.
const UNITS: [(&str, Kind, i32, f64); 29] = [
    ("m", Kind::Length, 0, 1.0),
    ("km", Kind::Length, 3, 1.0),
    ("cm", Kind::Length, -2, 1.0),
    ("mm", Kind::Length, -3, 1.0),
    ("um", Kind::Length, -6, 1.0),
    // The micro sign and the Greek letter look the same.
    ("\u{b5}m", Kind::Length, -6, 1.0),
    ("\u{3bc}m", Kind::Length, -6, 1.0),
    ("micron", Kind::Length, -6, 1.0),
    ("microns", Kind::Length, -6, 1.0),
    ("micrometers", Kind::Length, -6, 1.0),
    ("micrometres", Kind::Length, -6, 1.0),
    ("nm", Kind::Length, -9, 1.0),
    ("Pa", Kind::Stress, 0, 1.0),
    ("kPa", Kind::Stress, 3, 1.0),
    ("MPa", Kind::Stress, 6, 1.0),
    ("GPa", Kind::Stress, 9, 1.0),
    ("bar", Kind::Stress, 5, 1.0),
    ("kg", Kind::Mass, 0, 1.0),
    ("s", Kind::Time, 0, 1.0),
    ("sec", Kind::Time, 0, 1.0),
    ("seconds", Kind::Time, 0, 1.0),
    ("ms", Kind::Time, -3, 1.0),
    ("min", Kind::Time, 0, 60.0),
    ("minutes", Kind::Time, 0, 60.0),
    ("h", Kind::Time, 0, TimeUnit::HOUR.seconds()),
    ("hours", Kind::Time, 0, TimeUnit::HOUR.seconds()),
    ("d", Kind::Time, 0, TimeUnit::DAY.seconds()),
    ("yr", Kind::Time, 0, TimeUnit::YEAR.seconds()),
    ("days", Kind::Time, 0, TimeUnit::DAY.seconds()),
];

fn base(name: &str) -> Option<Unit> {
    let unit = |kind: Kind, power, seconds| Unit {
        dimensions: kind.dimensions(),
        power,
        ratio: (seconds, 1.0),
    };
    let known = UNITS.iter().find(|(known, ..)| *known == name);
    match known {
        Some((_, kind, power, seconds)) => Some(unit(*kind, *power, *seconds)),
        None => Some(unit(Kind::Time, 0, TimeUnit::named(name).ok()?.seconds())),
    }
}

impl Kind {
    /// The names of its units.
    pub(in super::super) fn names(self) -> impl Iterator<Item = &'static str> {
        let of_kind = UNITS.iter().filter(move |(_, kind, ..)| *kind == self);
        let times = TimeUnit::NAMES.into_iter().skip(1);
        let times = times.filter(move |_| self == Kind::Time);
        of_kind.map(|(name, ..)| *name).chain(times)
    }

    /// The size in SI of the unit of this name, in whatever case where no other has exactly that name.
    pub(in super::super) fn size(self, name: &str) -> Option<f64> {
        let exactly = self.names().find(|known| *known == name);
        let found = exactly.or_else(|| self.names().find(|known| known.eq_ignore_ascii_case(name)));
        base(found?)?.in_si("1")
    }
}

impl Unit {
    /// `MPa.s/m`: factors with a dot, a star or a space between, and what they are divided by after strokes; `m^2` for two of one.
    fn parse(text: &str) -> Option<Unit> {
        let mut product = Unit {
            dimensions: [0; 3],
            power: 0,
            ratio: (1.0, 1.0),
        };
        for (place, part) in text.split('/').enumerate() {
            let sign: i8 = if place == 0 { 1 } else { -1 };
            let factors = part.split(['.', '*', ' ', '\u{b7}']).flat_map(|factor| {
                let square = factor.strip_suffix("^2").or(factor.strip_suffix('\u{b2}'));
                std::iter::repeat_n(square.unwrap_or(factor), 1 + usize::from(square.is_some()))
            });
            for factor in factors {
                let factor = base(factor)?;
                for (sum, one) in product.dimensions.iter_mut().zip(factor.dimensions) {
                    *sum += sign * one;
                }
                product.power += i32::from(sign) * factor.power;
                match sign {
                    1 => product.ratio.0 *= factor.ratio.0,
                    _ => product.ratio.1 *= factor.ratio.0,
                }
            }
        }
        Some(product)
    }

    /// A decimal number of these in SI. The power of ten goes into the text, so that 10um is the double nearest to 1e-5.
    fn in_si(self, number: &str) -> Option<f64> {
        let (mantissa, exponent) = number.split_once(['e', 'E']).unwrap_or((number, "0"));
        let exponent = exponent.parse::<i32>().ok()?.checked_add(self.power)?;
        let x: f64 = format!("{mantissa}e{exponent}").parse().ok()?;
        Some(x * self.ratio.0 / self.ratio.1).filter(|x| x.is_finite())
    }
}

/// A number and the unit behind it; `None` for a text that begins with no number, and for a number alone.
pub(in super::super) fn with_unit(text: &str) -> Option<(&str, &str)> {
    let text = text.trim();
    let digits = text.trim_start_matches(['-', '+']);
    if !digits.starts_with(|c: char| c.is_ascii_digit() || c == '.') {
        return None;
    }
    let mut ends = (1..=text.len()).rev();
    let end = ends.find(|&i| text.is_char_boundary(i) && text[..i].parse::<f64>().is_ok())?;
    let (number, unit) = (&text[..end], text[end..].trim_start());
    unit.starts_with(|c: char| c.is_alphabetic() || c == '/')
        .then_some((number, unit))
}

/// The number in SI of a text that has a unit; `None` of one without. Times are in so many seconds.
///
/// # Errors
/// A sentence without its subject: for an unknown unit, and one of another kind.
pub(super) fn in_si(text: &str, kind: Kind, seconds: f64) -> Result<Option<f64>, String> {
    let Some((number, unit)) = with_unit(text) else {
        return Ok(None);
    };
    let (name, usual) = kind.example();
    let wanted = match kind {
        Kind::Number => format!("{name} is wanted"),
        _ => format!("{name} is wanted, as {number}{usual}"),
    };
    let Some(mut unit) = Unit::parse(unit) else {
        return Err(format!("{unit:?} is not a unit; {wanted}"));
    };
    if unit.dimensions != kind.dimensions() {
        return Err(wanted);
    }
    if kind == Kind::Time {
        unit.ratio.1 *= seconds;
    }
    let x = unit.in_si(number);
    x.map(Some)
        .ok_or_else(|| format!("{text:?} is beyond what a double holds"))
}
