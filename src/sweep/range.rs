//! The values of a grid along one of its axes.

use crate::error::{Error, Result, option_name};
use crate::number::between_in_log;

/// More values than this along one axis are a slip of the pen.
const MOST: usize = 10_000_000;

/// Values from one end to the other, evenly spaced or evenly in the logarithm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Range {
    /// The first value.
    pub from: f64,
    /// The last value, not below the first.
    pub to: f64,
    /// How many there are: one only where both ends are the same.
    pub count: usize,
    /// Whether they are spaced evenly in the logarithm.
    pub log: bool,
}

/// The fields of a range: `A:B` or `A:B:N`. Commas in place of all colons mean the same, as they are what a list in a scene
/// becomes.
pub fn fields(text: &str) -> Vec<&str> {
    let between = if text.contains(':') { ':' } else { ',' };
    text.split(between).map(str::trim).collect()
}

impl Range {
    /// Reads `A:B:N` or `A:B:Nlog`: N positive values from A to B. `name` is how the user knows the axis.
    ///
    /// # Errors
    /// [`Error::Input`] if it cannot be read, [`Error::Parameter`] for values outside their domain.
    ///
    /// ```
    /// use twinslip::sweep::Range;
    /// # fn main() -> twinslip::Result<()> {
    /// let driving = Range::parse("driving", "0.01:100:5log")?;
    /// assert_eq!(driving.value(4), 100.0);
    /// assert!((driving.value(2) - 1.0).abs() < 1e-15);
    /// assert!(Range::parse("driving", "0.01:100").is_err());
    /// # Ok(())
    /// # }
    /// ```
    pub fn parse(name: &str, text: &str) -> Result<Self> {
        let range = Range::read(name, text)?;
        range.checked_positive(name)?;
        Ok(range)
    }

    /// The same where values may be zero or negative, unless they are spaced in the logarithm.
    ///
    /// # Errors
    /// As [`Range::parse`].
    pub fn of_any_sign(name: &str, text: &str) -> Result<Self> {
        let range = Range::read(name, text)?;
        range.checked(name)?;
        Ok(range)
    }

    fn read(name: &str, text: &str) -> Result<Self> {
        let unreadable = || {
            Error::Input(format!(
                "{} {text:?} must be A:B:N or A:B:Nlog, N values from A to B",
                option_name(name)
            ))
        };
        let [from, to, count] = fields(text)[..] else {
            return Err(unreadable());
        };
        let (count, log) = match count.strip_suffix("log") {
            Some(count) => (count, true),
            None => (count, false),
        };
        let end = |text: &str| text.parse::<f64>().map_err(|_| unreadable());
        Ok(Range {
            from: end(from)?,
            to: end(to)?,
            count: count.parse().map_err(|_| unreadable())?,
            log,
        })
    }

    /// Whether the values are positive, as velocities, stiffnesses and states are, and some that can be computed with.
    pub(super) fn checked_positive(&self, name: &str) -> Result<()> {
        for end in [self.from, self.to] {
            if !(end > 0.0 && end.is_finite()) {
                return Err(Error::parameter(
                    name,
                    end,
                    "positive and finite at both ends",
                ));
            }
        }
        self.checked(name)
    }

    /// Whether the values are some that can be computed with.
    pub(super) fn checked(&self, name: &str) -> Result<()> {
        let refused = |value: String, must| Err(Error::parameter(name, value, must));
        for end in [self.from, self.to] {
            if !end.is_finite() {
                return refused(end.to_string(), "finite at both ends");
            }
            if self.log && end <= 0.0 {
                return refused(
                    end.to_string(),
                    "positive at both ends, as it is logarithmic",
                );
            }
        }
        if self.from > self.to {
            let value = format!("{}:{}", self.from, self.to);
            return refused(value, "from the smaller to the larger value");
        }
        if !(1..=MOST).contains(&self.count) {
            return refused(self.count.to_string(), "of 1 to 1e7 values");
        }
        if (self.count == 1) != (self.from == self.to) {
            return refused(
                self.text(),
                "of two values or more, or of a single one from it to itself",
            );
        }
        Ok(())
    }

    /// The i-th value, from 0; the ends are exact.
    pub fn value(&self, i: usize) -> f64 {
        let last = self.count - 1;
        if i == 0 {
            return self.from;
        }
        if i >= last {
            return self.to;
        }
        let part = i as f64 / last as f64;
        if self.log {
            between_in_log(self.from, self.to, part)
        } else {
            self.from + part * (self.to - self.from)
        }
    }

    /// All of them, in order.
    pub fn values(&self) -> impl ExactSizeIterator<Item = f64> + '_ {
        (0..self.count).map(|i| self.value(i))
    }

    /// As [`Range::parse`] reads it, in one way only.
    pub fn text(&self) -> String {
        let log = if self.log { "log" } else { "" };
        format!("{}:{}:{}{log}", self.from, self.to, self.count)
    }
}
