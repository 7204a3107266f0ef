//! A number with its error budget.

/// The truth lies within `uncertainty` of `value`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Uncertain {
    /// Best value.
    pub value: f64,
    /// Bound on the error; infinite where none could be established.
    pub uncertainty: f64,
}

impl Uncertain {
    /// A value and the bound on its error; a bound that came out as no number is none.
    pub fn new(value: f64, uncertainty: f64) -> Self {
        let known = uncertainty >= 0.0 && !value.is_nan();
        Uncertain {
            value,
            uncertainty: if known { uncertainty } else { f64::INFINITY },
        }
    }
}
