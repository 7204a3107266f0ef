//! The parameters that are looked for.

/// The name of the slope of a straight line that is added to the friction, per metre that the load point moves.
pub const DRIFT: &str = "drift";

/// What a parameter is varied by.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scale {
    /// Its logarithm: it stays positive, and errors are relative.
    Logarithmic,
    /// Itself.
    Linear,
}

impl Scale {
    /// The variable at a value of the parameter.
    pub fn inward(self, value: f64) -> f64 {
        match self {
            Scale::Logarithmic => value.ln(),
            Scale::Linear => value,
        }
    }

    /// The value of the parameter.
    pub fn outward(self, variable: f64) -> f64 {
        match self {
            Scale::Logarithmic => variable.exp(),
            Scale::Linear => variable,
        }
    }

    /// d value / d variable
    pub fn slope(self, value: f64) -> f64 {
        match self {
            Scale::Logarithmic => value,
            Scale::Linear => 1.0,
        }
    }
}

/// A parameter that is looked for.
#[derive(Debug, Clone, PartialEq)]
pub struct FreeParameter {
    /// Its name: one of [`super::Sliders::names`], or [`DRIFT`].
    pub name: String,
    /// What it is varied by.
    pub scale: Scale,
    /// Between which values.
    pub bounds: (f64, f64),
    /// Of which of several records it is, by its place among them; of all where none is named.
    pub of_record: Option<usize>,
}
