//! The stiffness at which a pair of eigenvalues crosses the imaginary axis, in closed form: (16), (29) and (34).

use crate::equilibrium::{Interface, routh_hurwitz};
use crate::friction::{Law, critical_stiffness};
use crate::number::Real;

/// Which root of (42).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum QuadraticRoot {
    /// k_+, the larger one: (34), the boundary of stability.
    Larger,
    /// k_-. With the paper's parameters nothing oscillates there; with others it may.
    Smaller,
}

/// k_c(V) / n: (16) of one interface, (29) of the symmetric state of two.
pub(super) fn symmetric<T: Real>(law: &impl Law, rate: T, interfaces: usize) -> T {
    critical_stiffness(law, rate) / interfaces as f64
}

/// A root of (42), which is c_2 c_1 = c_0 of the polynomial (30). Not a number where there is none.
pub(super) fn asymmetric<T: Real>(
    one: &Interface<T>,
    two: &Interface<T>,
    root: QuadraticRoot,
) -> T {
    let a_3 = one.compliance + two.compliance;
    let (sum, product) = (one.s + two.s, one.s * two.s);
    // c of (42); a_i s_i is one number
    let c = one.a_s + two.a_s - a_3 * sum;
    let quadratic = c * a_3;
    let half = (one.a_s * two.s + two.a_s * one.s - c * sum) * 0.5;
    let constant = -(product * sum);
    let discriminant = (half * half - quadratic * constant).sqrt();
    // without the subtraction of like numbers
    let adding = if half.leading() > 0.0 {
        -(half + discriminant)
    } else {
        discriminant - half
    };
    let larger_adds = (adding.leading() > 0.0) == (quadratic.leading() > 0.0);
    if larger_adds == (root == QuadraticRoot::Larger) {
        adding / quadratic
    } else {
        constant / adding
    }
}

/// omega^2 = n K G_psi / F_V: the product of the roots of (14), and of P_2 in (26).
pub(super) fn symmetric_frequency<T: Real>(one: &Interface<T>, k: T, interfaces: usize) -> T {
    k * one.g_psi * one.compliance * interfaces as f64
}

/// omega^2 = c_1 of (30), where c_2 c_1 = c_0.
pub(super) fn asymmetric_frequency<T: Real>(one: &Interface<T>, two: &Interface<T>, k: T) -> T {
    routh_hurwitz(one, two, k)[1]
}
