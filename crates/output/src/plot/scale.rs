//! The range of an axis. Its ticks and what they say are in [`super::ticks`].

use super::Axis;

/// Decades on a logarithmic axis, at least.
const NARROWEST: f64 = 0.5;
/// The range of data whose relative differences are smaller than this is this wide.
const NARROW: f64 = 1e-5;
/// Relative differences smaller than this are rounding: the data is a constant, with so much room around it as a part of it.
const CONSTANT: f64 = 1e-9;
const AROUND: f64 = 0.05;

/// An axis with its range, in the coordinate that is drawn: log10 for a logarithmic axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scale {
    /// Left or lower end.
    pub lo: f64,
    /// Right or upper end.
    pub hi: f64,
    /// Whether the coordinate is log10.
    pub log: bool,
}

/// The least and the largest of what was shown to it.
#[derive(Debug, Clone, Copy)]
pub struct Reach {
    lo: f64,
    hi: f64,
}

impl Reach {
    /// Of nothing yet.
    pub fn none() -> Self {
        Reach {
            lo: f64::INFINITY,
            hi: f64::NEG_INFINITY,
        }
    }

    /// Takes a coordinate; one that is not finite changes nothing.
    pub fn take(&mut self, x: f64) {
        if x.is_finite() {
            self.lo = self.lo.min(x);
            self.hi = self.hi.max(x);
        }
    }
}

impl Reach {
    /// With so many times its length more on either side, and not less than `least`.
    pub fn widened(&self, times: f64, least: f64) -> Self {
        let more = (times * (self.hi - self.lo)).max(least);
        Reach {
            lo: self.lo - more,
            hi: self.hi + more,
        }
    }

    /// The coordinate in it that is nearest; not a number for one that is none.
    pub fn nearest(&self, x: f64) -> f64 {
        if x.is_nan() {
            x
        } else {
            x.max(self.lo).min(self.hi)
        }
    }
}

impl Scale {
    /// The fixed range of the axis, or that of the data with a `margin` that is a part of it; `None` without either.
    pub fn new(axis: &Axis, data: Reach, margin: f64) -> Option<Self> {
        let log = axis.log;
        if let Some((lo, hi)) = ends(axis) {
            return Some(Scale { lo, hi, log });
        }
        let Reach { lo, hi } = data;
        if lo > hi {
            return None;
        }
        // A constant gets a range that shows it as one.
        let pad = if log {
            (0.5 * (NARROWEST - (hi - lo))).max(margin * (hi - lo))
        } else {
            let size = lo.abs().max(hi.abs());
            match hi - lo {
                0.0 if size == 0.0 => 1.0,
                range if range <= CONSTANT * size => AROUND * size,
                range if range < NARROW * size => NARROW * size,
                range => margin * range,
            }
        };
        // What is never negative, as a stiffness or a count, has an axis without negative numbers.
        let positive = !log && lo >= 0.0;
        let negative = !log && hi <= 0.0 && lo < 0.0;
        Some(Scale {
            lo: if positive {
                (lo - pad).max(0.0)
            } else {
                lo - pad
            },
            hi: if negative {
                (hi + pad).min(0.0)
            } else {
                hi + pad
            },
            log,
        })
    }

    /// Where a value is drawn.
    pub fn at(&self, x: f64) -> f64 {
        coordinate(self.log, x)
    }

    /// The value that is drawn at a coordinate.
    pub fn value(&self, at: f64) -> f64 {
        if self.log { 10f64.powf(at) } else { at }
    }

    /// Which part of the axis lies below a coordinate.
    pub fn part(&self, at: f64) -> f64 {
        (at - self.lo) / (self.hi - self.lo)
    }
}

/// The fixed ends of an axis, as they are drawn; none if they can't be.
pub fn ends(axis: &Axis) -> Option<(f64, f64)> {
    let (a, b) = axis.range?;
    let (a, b) = (coordinate(axis.log, a), coordinate(axis.log, b));
    let (lo, hi) = (a.min(b), a.max(b));
    (lo.is_finite() && hi.is_finite() && lo < hi).then_some((lo, hi))
}

/// Where a value is drawn on such an axis; not finite if it can't be.
pub fn coordinate(log: bool, x: f64) -> f64 {
    if log { x.log10() } else { x }
}

#[cfg(test)]
mod test {
    use super::*;

    fn reach(lo: f64, hi: f64) -> Reach {
        Reach { lo, hi }
    }

    #[test]
    fn axes_of_what_is_never_negative_begin_at_zero() {
        let ends = |lo, hi| {
            let scale = Scale::new(&Axis::linear("K"), reach(lo, hi), 0.1).unwrap();
            (scale.lo, scale.hi)
        };
        assert_eq!(ends(0.0, 10.0), (0.0, 11.0));
        assert_eq!(ends(0.5, 10.5), (0.0, 11.5));
        assert_eq!(ends(5.0, 10.0), (4.5, 10.5));
        assert_eq!(ends(-10.0, 0.0), (-11.0, 0.0));
        assert_eq!(ends(-1.0, 9.0), (-2.0, 10.0));
    }

    #[test]
    fn ranges_hold_the_data_unless_they_are_fixed() {
        let scale = Scale::new(&Axis::linear("t"), reach(0.0, 2000.0), 0.0).unwrap();
        assert_eq!((scale.lo, scale.hi), (0.0, 2000.0));
        let constant = Scale::new(&Axis::linear("t"), reach(3.0, 3.0), 0.0).unwrap();
        assert!(constant.lo < 2.9 && constant.hi > 3.1);
        let zero = Scale::new(&Axis::linear("n"), reach(0.0, 0.0), 0.1).unwrap();
        assert_eq!((zero.lo, zero.hi), (0.0, 1.0));
        let narrow = Scale::new(&Axis::linear("t"), reach(1e6, 1e6 + 1.0), 0.0).unwrap();
        assert!(narrow.hi - narrow.lo < 25.0, "{narrow:?}");
        let fixed = Axis::log("v").within(1e3, 1e-2);
        let scale = Scale::new(&fixed, Reach::none(), 0.3).unwrap();
        assert_eq!((scale.lo, scale.hi), (-2.0, 3.0));
        // Zero has no place on a logarithmic axis.
        let none = Axis::log("v").within(0.0, 1.0);
        let scale = Scale::new(&none, reach(-4.0, 0.0), 0.0).unwrap();
        assert_eq!((scale.lo, scale.hi), (-4.0, 0.0));
        assert_eq!(Scale::new(&none, Reach::none(), 0.0), None);
    }
}
