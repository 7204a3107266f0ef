//! The paper's constants as the decimals that they are, and its steady stress in 31 digits: a second computation of all that
//! the laws alone decide, by Newton's method on the logarithm of the friction law's argument.

use twinslip::number::{DoubleDouble, Jet, Real};

/// Newton steps from a double: the first gives 30 digits.
const STEPS: usize = 4;

/// beta = b/a = 0.0489 / 0.0349.
pub fn beta<T: Real>() -> T {
    T::constant(489.0) / 349.0
}

/// a = 0.0349.
pub fn direct_effect() -> DoubleDouble {
    DoubleDouble::constant(349.0) / 1e4
}

/// a_v / a = 0.369 / 0.0349.
pub fn reference_stress<T: Real>() -> T {
    T::constant(3690.0) / 349.0
}

/// Which law: (35), or its limit (6) for c = 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Strength {
    /// c = 1e-3.
    Residual,
    /// c = 0.
    None,
}

impl Strength {
    fn c<T: Real>(self) -> T {
        match self {
            Strength::Residual => T::constant(1.0) / 1e3,
            Strength::None => T::constant(0.0),
        }
    }

    /// ln of (V/gamma0) [c + (1+R)/(1+RV)]^beta, R = 100: what (36) takes the inverse hyperbolic sine of.
    fn logarithm<T: Real>(self, v: T) -> T {
        let strength = self.c::<T>() + T::constant(101.0) / (v * 100.0 + 1.0);
        v.ln() + beta::<T>() * strength.ln() - T::constant(2.0).ln() + reference_stress::<T>()
    }

    /// tau_ss(V)  (36).
    pub fn steady_stress(self, v: DoubleDouble) -> DoubleDouble {
        self.logarithm(v).exp().asinh()
    }

    /// The logarithm with its first and second derivative.
    fn derivatives(self, v: DoubleDouble) -> [DoubleDouble; 3] {
        let inner = Jet::<DoubleDouble, 1>::variable(v, 0);
        let at = self.logarithm(Jet::<Jet<DoubleDouble, 1>, 1>::variable(inner, 0));
        let first = at.gradient[0];
        [at.value.value, first.value, first.gradient[0]]
    }

    /// The extremum of tau_ss near a rate.
    pub fn extremum(self, near: f64) -> DoubleDouble {
        let mut v = DoubleDouble::constant(near);
        for _ in 0..STEPS {
            let [_, slope, curvature] = self.derivatives(v);
            v = v - slope / curvature;
        }
        v
    }

    /// The fold V_sn: both rates of tau_ss(V_1) = tau_ss(V_2), tau_ss'(V_1) + tau_ss'(V_2) = 0, near a pair. At equal stress the
    /// slopes are those of the logarithm, up to the same factor.
    pub fn fold(self, near: [f64; 2]) -> [DoubleDouble; 2] {
        let [mut slow, mut fast] = near.map(DoubleDouble::constant);
        for _ in 0..STEPS {
            let [level_s, slope_s, curve_s] = self.derivatives(slow);
            let [level_f, slope_f, curve_f] = self.derivatives(fast);
            let (apart, sum) = (level_s - level_f, slope_s + slope_f);
            // [slope_s, -slope_f; curve_s, curve_f] (d slow, d fast) = -(apart, sum)
            let determinant = slope_s * curve_f + slope_f * curve_s;
            slow = slow - (apart * curve_f + sum * slope_f) / determinant;
            fast = fast - (sum * slope_s - apart * curve_s) / determinant;
        }
        [slow, fast]
    }
}
