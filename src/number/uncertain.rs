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
    /// A value and the bound on its error.
    pub fn new(value: f64, uncertainty: f64) -> Self {
        Uncertain { value, uncertainty }
    }
}
