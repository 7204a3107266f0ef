//! Test functions of periodic orbits, zero at bifurcations (fold, period doubling, Neimark-Sacker), and their derivatives.
//!
//! With the trace and the determinant of the return map, 1 - tr + det and 1 + tr + det; the determinant by the integral of
//! the Jacobian's trace. The trace changes as the maps of the single arcs do: a difference of two traces would lose, at small
//! stiffness, what the maps' product loses.
//!
//! With a return map of more dimensions tr and det are not the sum and the product of two multipliers. There the test functions
//! are products over all multipliers, from the maps' periodic Schur form, and their changes are differences. Of strong resonances it
//! is the sum of the pair that is nearest to the unit circle.

use super::linear::Linear;
use super::multipliers::{CirclePair, Products};
use crate::error::{Error, Result};
use crate::field::Matrix;

/// What is to be zero.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum TestFunction {
    /// A multiplier is 1: 1 - tr + det; in the plane, where there is but one, its logarithm. Also at a pitchfork, in the whole space.
    Fold,
    /// A multiplier is -1: 1 + tr + det.
    Doubling,
    /// The product of two is 1: ln det. A torus (Neimark-Sacker) bifurcation where they are conjugate, a neutral saddle elsewhere.
    Torus,
    /// The sum of two multipliers has this value: of both, where there are no more, else of the two whose product is nearest to 1. On a
    /// torus bifurcation that is 2 cos of the critical pair's angle: 2, -2, -1 and 0 at the resonances 1:1 to 1:4.
    Trace(f64),
    /// The multiplier across the symmetric subspace is 1.
    Transverse,
    /// The product of a conjugate pair is 1: of both that are nearest to the unit circle the one for which 2 cos of the angle is nearest to this value. Unlike
    /// [`TestFunction::Torus`] it has a simple zero where a second pair is on the circle.
    Pair(f64),
    /// The product of two is 1, but those of the conjugate pair that is nearest to the unit circle: along a curve of torus bifurcations a second pair comes to
    /// the circle, or two real ones have the product 1.
    SecondPair,
}

/// What the test functions are made of, or its change.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Spectrum {
    /// The number of variables: one more than there are nontrivial multipliers.
    pub dimension: usize,
    /// Of the return map: the sum of the nontrivial multipliers.
    pub trace: f64,
    /// ln of the product of the nontrivial multipliers' moduli.
    pub volume: f64,
    /// ln of the multiplier across the symmetric subspace; not a number where there is none.
    pub across: f64,
    /// Over all multipliers, where there are more than two.
    pub(super) products: Option<Products>,
}

impl Spectrum {
    pub(super) fn new(linear: &Linear) -> Self {
        let dimension = linear.dimension();
        let mut products = Chain::identity(dimension - 1);
        linear.maps.iter().for_each(|map| products.then(map));
        let across: Option<f64> = linear.logs.iter().map(|logs| logs.transverse).sum();
        Spectrum {
            dimension,
            trace: products.matrix.trace(),
            volume: volume(linear),
            across: across.unwrap_or(f64::NAN),
            products: (dimension > 3)
                .then(|| Products::new(&linear.maps))
                .flatten(),
        }
    }

    /// The change from one linearisation to another in the same planes, divided by the step between them.
    pub(super) fn change(from: &Linear, spectrum: &Spectrum, to: &Linear, step: f64) -> Self {
        let (count, planar) = (from.maps.len(), from.dimension() - 1);
        let mut after = Vec::with_capacity(count);
        after.push(Matrix::identity(planar, planar));
        for k in 1..count {
            after.push(&after[k - 1] * &from.maps[count - k]);
        }
        let mut before = Chain::identity(planar);
        let mut trace = 0.0;
        for (k, after) in after.iter().rev().enumerate() {
            // The trace of after times the change times before.
            before.spare.copy_from(&to.maps[k]);
            before.spare -= &from.maps[k];
            for (i, column) in before.matrix.column_iter().enumerate() {
                for (j, x) in column.iter().enumerate() {
                    trace += x * before.spare.column(j).tr_dot(&after.row(i));
                }
            }
            before.then(&from.maps[k]);
        }
        let logs = from.logs.iter().zip(&to.logs);
        let volume: f64 = logs.map(|(a, b)| b.volume - a.volume).sum();
        let there = Spectrum::new(to);
        let products = spectrum.products.zip(there.products);
        Spectrum {
            dimension: from.dimension(),
            trace: trace / step,
            volume: volume / step,
            across: (there.across - spectrum.across) / step,
            products: products.map(|(here, there)| there.less(&here).scaled(1.0 / step)),
        }
    }

    /// 2 cos of the angles of the two conjugate pairs nearest to the unit circle, where both are near it and certainly not real: first of the one for which that
    /// is nearest to a value, or else of the one that is nearest to the circle.
    pub(crate) fn two_pairs(&self, first: Option<f64>) -> Option<[f64; 2]> {
        /// Of ln of a product.
        const NEAR: f64 = 4.0;
        const REAL: f64 = 1.9;
        let pairs = self.products?.circle;
        let own = first.map_or(0, |sum| CirclePair::place_near(&pairs, sum));
        let near = |one: &CirclePair| one.ln_product.abs() < NEAR && one.sum.abs() < REAL;
        let sums = [pairs[own].sum, pairs[1 - own].sum];
        pairs.iter().all(near).then_some(sums)
    }

    /// ln of the products of both conjugate pairs that are nearest to the unit circle.
    pub(crate) fn pairs_off(&self) -> Option<[f64; 2]> {
        let off = self.products?.circle.map(|pair| pair.ln_product);
        off.iter().all(|off| off.is_finite()).then_some(off)
    }

    /// ln |mu| of both nontrivial multipliers, the larger one first, of an orbit in three dimensions.
    ///
    /// # Errors
    /// [`Error::Dimension`] in others.
    pub fn log_multipliers(&self) -> Result<[f64; 2]> {
        let Spectrum {
            dimension,
            trace,
            volume,
            ..
        } = *self;
        let what = "the pair of multipliers by trace and determinant";
        Error::dimension_unless(dimension == 3, what, "3", dimension)?;
        let det = volume.exp();
        let half = 0.5 * trace;
        let discriminant = half * half - det;
        if discriminant < 0.0 {
            return Ok([0.5 * volume; 2]);
        }
        // Away from cancellation; the other one by the product.
        let larger = (half.abs() + discriminant.sqrt()).ln();
        Ok([larger, volume - larger])
    }
}

/// A product of maps, made one by one.
struct Chain {
    matrix: Matrix,
    /// Room for the next.
    spare: Matrix,
}

impl Chain {
    fn identity(count: usize) -> Self {
        let matrix = Matrix::identity(count, count);
        Chain {
            spare: matrix.clone(),
            matrix,
        }
    }

    fn then(&mut self, map: &Matrix) {
        map.mul_to(&self.matrix, &mut self.spare);
        std::mem::swap(&mut self.matrix, &mut self.spare);
    }
}

fn volume(linear: &Linear) -> f64 {
    linear.logs.iter().map(|logs| logs.volume).sum()
}

impl TestFunction {
    /// Whether it is a test function of orbits of so many variables.
    ///
    /// # Errors
    /// [`Error::Dimension`] where it is not: its zeros would be no bifurcations.
    pub fn checked(self, dimension: usize) -> Result<()> {
        let (what, known, holds) = match self {
            TestFunction::Fold => (
                "the test function of folds of orbits",
                "2 or more",
                dimension >= 2,
            ),
            TestFunction::Doubling => (
                "the test function of period doublings",
                "3 or more",
                dimension >= 3,
            ),
            TestFunction::Torus => (
                "the test function of torus bifurcations",
                "3 or more",
                dimension >= 3,
            ),
            TestFunction::Trace(_) => (
                "the test function of strong resonances",
                "3 or more",
                dimension >= 3,
            ),
            TestFunction::Transverse => (
                "the test function of pitchforks of orbits",
                "2",
                dimension == 2,
            ),
            TestFunction::Pair(_) | TestFunction::SecondPair => (
                "the test functions of two pairs of multipliers",
                "5 or more",
                dimension >= 5,
            ),
        };
        Error::dimension_unless(holds, what, known, dimension)
    }

    /// Its value, where it is a test function.
    pub(crate) fn of(self, spectrum: &Spectrum) -> f64 {
        let Spectrum {
            dimension,
            trace,
            volume,
            across,
            products,
        } = *spectrum;
        let product = |of: fn(&Products) -> f64| products.as_ref().map_or(f64::NAN, of);
        match self {
            TestFunction::Fold if dimension > 3 => product(|all| all.fold),
            TestFunction::Doubling if dimension > 3 => product(|all| all.doubling),
            TestFunction::Torus if dimension > 3 => product(|all| all.torus),
            TestFunction::Trace(value) if dimension > 3 => product(|all| all.pair) - value,
            TestFunction::Fold if dimension == 2 => volume,
            TestFunction::Fold => 1.0 - trace + volume.exp(),
            TestFunction::Doubling => 1.0 + trace + volume.exp(),
            TestFunction::Torus => volume,
            TestFunction::Trace(value) => trace - value,
            TestFunction::Transverse => across,
            TestFunction::Pair(_) | TestFunction::SecondPair => {
                products.map_or(f64::NAN, |all| self.of_pair(&all, &all))
            }
        }
    }

    /// That of a pair, which the first products tell, in the second ones.
    fn of_pair(self, at: &Products, of: &Products) -> f64 {
        match self {
            TestFunction::Pair(sum) => {
                of.circle[CirclePair::place_near(&at.circle, sum)].ln_product
            }
            _ => of.circle[0].others,
        }
    }

    /// What its value is to be divided by to be of order one.
    pub(crate) fn size(self, at: &Spectrum) -> f64 {
        match self {
            TestFunction::Fold if at.dimension == 2 => 1.0 + at.volume.abs(),
            TestFunction::Fold | TestFunction::Doubling if at.dimension == 3 => {
                1.0 + at.trace.abs() + at.volume.exp()
            }
            _ => 1.0,
        }
    }

    /// Its change with that of the spectrum.
    pub(crate) fn change_along(self, at: &Spectrum, by: &Spectrum) -> f64 {
        if at.dimension > 3 {
            // All are linear in the products.
            return match self {
                TestFunction::Pair(_) | TestFunction::SecondPair => {
                    let both = at.products.zip(by.products);
                    both.map_or(f64::NAN, |(at, by)| self.of_pair(&at, &by))
                }
                TestFunction::Trace(_) => TestFunction::Trace(0.0).of(by),
                _ => self.of(by),
            };
        }
        let of_det = at.volume.exp() * by.volume;
        match self {
            TestFunction::Fold if at.dimension == 2 => by.volume,
            TestFunction::Fold => of_det - by.trace,
            TestFunction::Doubling => of_det + by.trace,
            TestFunction::Torus => by.volume,
            TestFunction::Trace(_) => by.trace,
            TestFunction::Transverse => by.across,
            TestFunction::Pair(_) | TestFunction::SecondPair => f64::NAN,
        }
    }
}
