//! How residuals count.

/// How residuals count that are large beside `scale`: each rho(r^2/scale^2), rho(u) = u for small u.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Loss {
    /// u
    Linear,
    /// 2 (sqrt(1 + u) - 1)
    SoftL1 {
        /// In friction.
        scale: f64,
    },
    /// u up to 1, then 2 sqrt(u) - 1
    Huber {
        /// In friction.
        scale: f64,
    },
    /// ln(1 + u)
    Cauchy {
        /// In friction.
        scale: f64,
    },
}

impl Loss {
    /// The z with z^2 = scale^2 rho and the sign of r, and dz/dr.
    pub(super) fn apply(self, r: f64) -> (f64, f64) {
        let scale = match self {
            Loss::Linear => return (r, 1.0),
            Loss::Huber { scale } if r.abs() <= scale => return (r, 1.0),
            Loss::SoftL1 { scale } | Loss::Huber { scale } | Loss::Cauchy { scale } => scale,
        };
        let u = (r / scale).powi(2);
        if u == 0.0 {
            return (r, 1.0);
        }
        let (rho, slope) = match self {
            Loss::Linear => (u, 1.0),
            Loss::SoftL1 { .. } => {
                let root = (1.0 + u).sqrt();
                (2.0 * u / (root + 1.0), 1.0 / root)
            }
            Loss::Huber { .. } => (2.0 * u.sqrt() - 1.0, 1.0 / u.sqrt()),
            Loss::Cauchy { .. } => (u.ln_1p(), 1.0 / (1.0 + u)),
        };
        let z = (scale * rho.sqrt()).copysign(r);
        (z, slope * r / z)
    }
}
