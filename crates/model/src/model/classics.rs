//! Classic small systems with known answers: what methods are tried on, and what readers know them by.
//!
//! Each is an [`Equations`] with its two control parameters, to be put in a [`super::Smooth`].

use crate::number::Real;
use crate::series::Equations;

/// x' = sigma (y - x), y' = x (rho - z) - y, z' = x y - beta z, in the parameters (rho, beta).
///
/// Lorenz, E. N. (1963). Deterministic nonperiodic flow. Journal of the Atmospheric Sciences 20, 130-141.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lorenz {
    /// The Prandtl number.
    pub sigma: f64,
}

impl Lorenz {
    /// sigma = 10, as Lorenz took it.
    pub fn classical() -> Self {
        Lorenz { sigma: 10.0 }
    }

    /// The steady states beside the origin, for rho > 1: (+-x, +-x, rho - 1), x^2 = beta (rho - 1).
    pub fn steady(&self, [rho, beta]: [f64; 2]) -> [f64; 3] {
        let x = (beta * (rho - 1.0)).sqrt();
        [x, x, rho - 1.0]
    }

    /// rho at which they lose stability in a subcritical Hopf bifurcation, sigma (sigma + beta + 3) / (sigma - beta - 1), for
    /// sigma > beta + 1.
    pub fn hopf(&self, beta: f64) -> f64 {
        self.sigma * (self.sigma + beta + 3.0) / (self.sigma - beta - 1.0)
    }
}

impl Equations<3, 2> for Lorenz {
    const PARAMETERS: [&'static str; 2] = ["rho", "beta"];

    #[inline(always)]
    fn rates<T: Real>(&self, [x, y, z]: [T; 3], [rho, beta]: [T; 2]) -> [T; 3] {
        [(y - x) * self.sigma, x * (rho - z) - y, x * y - beta * z]
    }
}

/// x' = -y - z, y' = x + a y, z' = b + z (x - c), in the parameters (a, c).
///
/// Roessler, O. E. (1976). An equation for continuous chaos. Physics Letters A 57, 397-398.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Roessler {
    /// b; 0.2 as Roessler took it.
    pub b: f64,
}

impl Roessler {
    /// The steady state near the origin, for c^2 > 4 a b: (a z, -z, z), z = (c - sqrt(c^2 - 4 a b)) / (2 a).
    pub fn steady(&self, [a, c]: [f64; 2]) -> [f64; 3] {
        let z = 2.0 * self.b / (c + (c * c - 4.0 * a * self.b).sqrt());
        [a * z, -z, z]
    }
}

impl Equations<3, 2> for Roessler {
    const PARAMETERS: [&'static str; 2] = ["a", "c"];

    #[inline(always)]
    fn rates<T: Real>(&self, [x, y, z]: [T; 3], [a, c]: [T; 2]) -> [T; 3] {
        [-(y + z), x + a * y, z * (x - c) + self.b]
    }
}

/// x' = A - (B + 1) x + x^2 y, y' = B x - x^2 y, in the parameters (A, B).
///
/// Prigogine, I. and Lefever, R. (1968). Symmetry breaking instabilities in dissipative systems II. Journal of Chemical
/// Physics 48, 1695-1700.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Brusselator;

impl Brusselator {
    /// The steady state (A, B / A).
    pub fn steady([a, b]: [f64; 2]) -> [f64; 2] {
        [a, b / a]
    }

    /// B at which it loses stability in a supercritical Hopf bifurcation, 1 + A^2, with the frequency A.
    pub fn hopf(a: f64) -> f64 {
        1.0 + a * a
    }
}

impl Equations<2, 2> for Brusselator {
    const PARAMETERS: [&'static str; 2] = ["a", "b"];

    #[inline(always)]
    fn rates<T: Real>(&self, [x, y]: [T; 2], [a, b]: [T; 2]) -> [T; 2] {
        let reaction = x * x * y;
        let consumed = b * x;
        [a - consumed - x + reaction, consumed - reaction]
    }
}

/// x' = y, y' = mu (1 - x^2) y - x + b, in the parameters (mu, b).
///
/// van der Pol, B. (1926). On relaxation-oscillations. Philosophical Magazine 2, 978-992.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VanDerPol;

impl VanDerPol {
    /// The period for large mu at b = 0, (3 - 2 ln 2) mu + 3 alpha mu^(-1/3), with -alpha the first zero of the Airy function.
    /// It errs by a few ln mu / mu. Dorodnitsyn, A. A. (1947), Prikladnaya Matematika i Mekhanika 11, 313-328.
    pub fn relaxation_period(mu: f64) -> f64 {
        const ALPHA: f64 = 2.338107410459767;
        (3.0 - 2.0 * std::f64::consts::LN_2) * mu + 3.0 * ALPHA / mu.cbrt()
    }
}

impl Equations<2, 2> for VanDerPol {
    const PARAMETERS: [&'static str; 2] = ["mu", "b"];

    #[inline(always)]
    fn rates<T: Real>(&self, [x, y]: [T; 2], [mu, b]: [T; 2]) -> [T; 2] {
        let damping = mu * (T::constant(1.0) - x * x);
        [y, damping * y - x + b]
    }
}

/// x' = (z - 0.7) x - omega y, y' = omega x + (z - 0.7) y, z' = 0.6 + z - z^3/3 - (x^2 + y^2)(1 + rho z) + eps z x^3, in the
/// parameters (rho, eps).
///
/// At eps = 0 everything turns about the z axis with the frequency omega: periodic orbits are steady states of (r, z), and
/// invariant tori are its cycles.
///
/// Langford, W. F. (1984). Numerical studies of torus bifurcations. In: Numerical Methods for Bifurcation Problems,
/// International Series of Numerical Mathematics 70, 285-295.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Langford {
    /// The frequency; 3.5 as usual.
    pub omega: f64,
}

impl Langford {
    /// The radius of the periodic orbit in z = 0.7 at eps = 0: r^2 = (1.3 - 0.7^3/3) / (1 + 0.7 rho).
    pub fn radius(rho: f64) -> f64 {
        ((1.3 - 0.343 / 3.0) / (1.0 + 0.7 * rho)).sqrt()
    }

    /// rho at which that orbit sheds a torus at eps = 0: where the trace of the Jacobian in (r, z), 1 - z^2 - rho r^2, is zero.
    pub fn torus() -> f64 {
        0.51 / (1.3 - 0.343 / 3.0 - 0.51 * 0.7)
    }
}

impl Equations<3, 2> for Langford {
    const PARAMETERS: [&'static str; 2] = ["rho", "eps"];

    #[inline(always)]
    fn rates<T: Real>(&self, [x, y, z]: [T; 3], [rho, eps]: [T; 2]) -> [T; 3] {
        let growth = z - 0.7;
        let squared = x * x;
        let turned = (squared + y * y) * (rho * z + 1.0);
        [
            growth * x - y * self.omega,
            x * self.omega + growth * y,
            z - z * z * z / 3.0 + 0.6 - turned + eps * z * squared * x,
        ]
    }
}
