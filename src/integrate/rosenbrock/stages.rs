//! What every step is made of: the method, the stages in order, sums of them, and the field at one state.

use crate::field::{Jacobian, State, VectorField, with_differences};
use crate::integrate::tableau::{MAX_STAGES, Tableau};
use nalgebra::SMatrix;

/// A Rosenbrock method as the steps use it.
pub(super) trait Scheme: Copy {
    /// Whether the coefficients are known to the compiler. The stages then are written out, and zeros among the coefficients cost
    /// nothing; a loop of this size is not unrolled. In other dimensions one loop serves all methods.
    const WRITTEN_OUT: bool;
    /// The coefficients.
    fn tableau(self) -> &'static Tableau;
}

/// Something that has stages.
pub(super) trait Staged {
    /// Computes stage i from those before it.
    fn stage(&mut self, tableau: &Tableau, i: usize);

    /// All stages of the method.
    #[inline(always)]
    fn all_stages<S: Scheme>(&mut self, scheme: S) {
        let tableau = scheme.tableau();
        if !S::WRITTEN_OUT {
            for i in 0..tableau.stages {
                self.stage(tableau, i);
            }
            return;
        }
        self.stage(tableau, 0);
        self.stage(tableau, 1);
        self.stage(tableau, 2);
        if tableau.stages > 3 {
            self.stage(tableau, 3);
            self.stage(tableau, 4);
            self.stage(tableau, 5);
        }
        if tableau.stages > 6 {
            self.stage(tableau, 6);
            self.stage(tableau, 7);
        }
    }
}

/// The u_i of a step: vectors, or matrices of tangent columns.
pub(super) type Stages<const N: usize, const COLUMNS: usize> =
    [SMatrix<f64, N, COLUMNS>; MAX_STAGES];

/// start + sum_j weights_j u_j over the first `count`; with constant weights no test is left.
#[inline(always)]
pub(super) fn combination<const N: usize, const COLUMNS: usize>(
    start: SMatrix<f64, N, COLUMNS>,
    weights: &[f64; MAX_STAGES],
    count: usize,
    u: &Stages<N, COLUMNS>,
) -> SMatrix<f64, N, COLUMNS> {
    let mut sum = start;
    for j in 0..count {
        if weights[j] == 1.0 {
            sum += u[j];
        } else if weights[j] != 0.0 {
            sum += u[j] * weights[j];
        }
    }
    sum
}

/// f and J at one state.
#[derive(Debug, Clone, Copy)]
pub(super) struct Linearisation<const N: usize> {
    pub f: State<N>,
    pub jacobian: Jacobian<N>,
}

impl<const N: usize> Linearisation<N> {
    /// `None` if something is not finite.
    #[inline]
    pub fn new(field: &dyn VectorField<N>, y: &State<N>, f: State<N>) -> Option<Self> {
        Self::of(f, field.jacobian(y))
    }

    /// The same with differences in place of what is no number in J: steps are good with these, tangents are not.
    #[inline]
    pub fn for_steps(field: &dyn VectorField<N>, y: &State<N>, f: State<N>) -> Option<Self> {
        let jacobian = field.jacobian(y);
        Self::of(f, jacobian).or_else(|| Self::of(f, with_differences(field, y, jacobian)))
    }

    #[inline]
    fn of(f: State<N>, jacobian: Jacobian<N>) -> Option<Self> {
        let finite = f.iter().chain(jacobian.iter()).all(|x| x.is_finite());
        finite.then_some(Linearisation { f, jacobian })
    }
}

/// The error estimate is the difference of the two solutions: it is of the order of the lower one, plus one.
pub(crate) const fn error_order(tableau: &Tableau) -> u32 {
    if tableau.order < tableau.embedded_order {
        tableau.order + 1
    } else {
        tableau.embedded_order + 1
    }
}
