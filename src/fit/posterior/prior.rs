//! What is believed of a parameter before the record.

use super::super::free::Scale;

/// The distribution of a parameter before the record is known.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Prior {
    /// Normal.
    Normal {
        /// Its mean.
        mean: f64,
        /// Its standard deviation.
        deviation: f64,
    },
    /// The same density everywhere between two values.
    Uniform {
        /// The lower one.
        low: f64,
        /// The upper one.
        high: f64,
    },
    /// The logarithm is uniform between those of two values.
    LogUniform {
        /// The lower one.
        low: f64,
        /// The upper one.
        high: f64,
    },
}

impl Prior {
    /// Between which values the parameter lies.
    pub fn support(self) -> (f64, f64) {
        match self {
            Prior::Normal { .. } => (f64::NEG_INFINITY, f64::INFINITY),
            Prior::Uniform { low, high } | Prior::LogUniform { low, high } => (low, high),
        }
    }

    /// The logarithm of the density in the variable x of a scale, but for a constant, and its derivative in x.
    pub(super) fn log_density(self, scale: Scale, x: f64) -> (f64, f64) {
        let p = scale.outward(x);
        let slope = scale.slope(p);
        // ln |dp/dx| and its derivative
        let (jacobian, of_jacobian) = match scale {
            Scale::Logarithmic => (x, 1.0),
            Scale::Linear => (0.0, 0.0),
        };
        match self {
            Prior::Normal { mean, deviation } => {
                let off = (p - mean) / deviation;
                (
                    jacobian - 0.5 * off * off,
                    of_jacobian - off / deviation * slope,
                )
            }
            Prior::Uniform { .. } => (jacobian, of_jacobian),
            // 1/p: flat where x is the logarithm.
            Prior::LogUniform { .. } => (jacobian - p.ln(), of_jacobian - slope / p),
        }
    }
}

/// A variable between bounds as a number without any: x = low + (high - low)/(1 + e^-z).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Unbounded {
    low: f64,
    high: f64,
}

/// What the transformation makes of a number.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Inward {
    /// The variable.
    pub x: f64,
    /// dx/dz
    pub slope: f64,
    /// ln |dx/dz|
    pub log_slope: f64,
    /// Its derivative in z.
    pub of_log_slope: f64,
}

impl Unbounded {
    /// Infinite bounds are none.
    pub fn new((low, high): (f64, f64)) -> Self {
        Unbounded { low, high }
    }

    fn is_bounded(self) -> bool {
        (self.high - self.low).is_finite()
    }

    /// The variable.
    pub fn inward(self, z: f64) -> Inward {
        if !self.is_bounded() {
            return Inward {
                x: z,
                slope: 1.0,
                log_slope: 0.0,
                of_log_slope: 0.0,
            };
        }
        let width = self.high - self.low;
        // e^-|z|: nothing overflows.
        let small = (-z.abs()).exp();
        let part = if z >= 0.0 {
            1.0 / (1.0 + small)
        } else {
            small / (1.0 + small)
        };
        let slope = width * small / (1.0 + small).powi(2);
        Inward {
            x: self.low + width * part,
            slope,
            log_slope: width.ln() - z.abs() - 2.0 * small.ln_1p(),
            of_log_slope: 1.0 - 2.0 * part,
        }
    }

    /// The number of a variable, away from the bounds where it is at one.
    pub fn outward(self, x: f64) -> f64 {
        /// How near to a bound, in parts of the width.
        const NEAREST: f64 = 1e-3;
        if !self.is_bounded() {
            return x;
        }
        let part = ((x - self.low) / (self.high - self.low)).clamp(NEAREST, 1.0 - NEAREST);
        (part / (1.0 - part)).ln()
    }
}
