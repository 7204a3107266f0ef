//! Normal forms of bifurcations of orbits (period doubling, Neimark-Sacker, pitchfork): criticality by the cubic coefficient.
//!
//! Along the centre manifold of an orbit, whose part in the k-th plane is
//!
//! H_k(w) = q_k w + ... + h20_k w^2 / 2 + h11_k |w|^2 + ...,
//!
//! the maps P_k from plane to plane act as the normal form of the return map does:
//!
//! Kuznetsov, Y. A. (2004). Elements of Applied Bifurcation Theory, 3rd edition, (5.40) period doubling, (5.45) torus;
//!
//! that of the pitchfork is (5.40) with the multiplier 1. The coefficients depend on the length of the eigenvector q. As in
//!
//! Kuznetsov, Y. A., Govaerts, W., Doedel, E. J. and Dhooge, A. (2005). Numerical periodic normalization for codim 1
//! bifurcations of limit cycles. SIAM J. Numer. Anal. 43, 1407-1435,
//!
//! it is measured all along the orbit, by the integral of |q|^2 over the period T, and not at a section or at nodes that were
//! chosen: here, where a map is normalised and no flow, that integral is T. |q| is the length across the flow, in the system's own
//! variables: of two interfaces (tau, ln psi_1, ln psi_2). Every order is a cyclic linear system; the cubic coefficient is the
//! condition that the last one can be solved. So no map around the whole orbit is needed, whose derivatives a canard makes
//! huge. The same with twice as many nodes and another tolerance shows what a coefficient errs by.

use crate::bifurcation::Criticality;
use crate::error::{Error, Result};
use crate::field::{Matrix, Vector};
use crate::number::Uncertain;
use crate::orbit::{
    Across, Axes, CVector, ContinuationPoint, LogEigenvalue, ParametrisedField, PoincareMaps,
    across_in_units, cut_into, cyclic, eigenvalues_of, finely_cut, squares, unit_pair,
};
use nalgebra::Complex;
use std::f64::consts::PI;

pub(super) type C = Complex<f64>;

/// What bifurcates.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Form {
    /// A multiplier -1: b > 0 is supercritical.
    Doubling,
    /// A pair e^(+-i theta): d < 0 is supercritical.
    Torus,
    /// A multiplier 1 and a symmetry: c < 0 is supercritical.
    Pitchfork,
}

/// Tolerances of the maps, and into how many parts the arcs are cut for each.
const SOLUTIONS: [(f64, usize); 2] = [(1e-16, 1), (1e-15, 2)];
/// The difference of both times this, and what is always left: the orbit itself is off by rounding.
const SAFETY: f64 = 10.0;
const LEAST: f64 = 1e-8;
/// How far the logarithm of a multiplier that bifurcates may be off.
const NEAR: f64 = 1e-4;

impl Form {
    /// Whether orbits of so many variables have it.
    ///
    /// # Errors
    /// [`Error::Dimension`] where they do not.
    pub fn checked(self, dimension: usize) -> Result<()> {
        let (what, known, holds) = match self {
            Form::Doubling => (
                "the normal form of period doublings",
                "3 or more",
                dimension >= 3,
            ),
            Form::Torus => (
                "the normal form of torus bifurcations",
                "3 or more",
                dimension >= 3,
            ),
            Form::Pitchfork => (
                "the normal form of pitchforks of orbits of two interfaces",
                "3",
                dimension == 3,
            ),
        };
        Error::dimension_unless(holds, what, known, dimension)
    }
}

/// The cubic coefficient of an orbit that bifurcates, and which way that is: b of (5.40) or Re d of (5.45) of the return map,
/// for an eigenvector whose length across the flow, in the system's own variables as [`ParametrisedField::across`] measures it, has
/// the mean square 1 over the period. Where it is not known, and where nothing bifurcates, its uncertainty is infinite.
///
/// # Errors
/// [`Error::Dimension`] for forms that orbits of so many variables do not have; those of
/// [`crate::orbit::ShootingNodes::checked`] for nodes with another number of variables than the family.
pub fn normal_form(
    family: &dyn ParametrisedField,
    site: &ContinuationPoint,
    form: Form,
) -> Result<(Uncertain, Criticality)> {
    let dimension = family.dimension();
    site.shooting.checked(dimension)?;
    form.checked(dimension)?;
    Ok(classified(family, site, form))
}

/// The same of a form that such orbits have.
fn classified(
    family: &dyn ParametrisedField,
    site: &ContinuationPoint,
    form: Form,
) -> (Uncertain, Criticality) {
    let Some([followed, told]) = coefficient(family, site, form) else {
        return (Uncertain::new(0.0, f64::INFINITY), Criticality::Undecided);
    };
    // To which side it goes does not depend on the units of length: by those in which it is known better.
    let margin = |x: &Uncertain| x.value.abs() / x.uncertainty;
    let decisive = if margin(&told) > margin(&followed) {
        told
    } else {
        followed
    };
    let supercritical = match form {
        Form::Doubling => decisive.value > 0.0,
        Form::Torus | Form::Pitchfork => decisive.value < 0.0,
    };
    let criticality = if decisive.value.abs() <= decisive.uncertainty {
        Criticality::Undecided
    } else if supercritical {
        Criticality::Supercritical
    } else {
        Criticality::Subcritical
    };
    (told, criticality)
}

/// The coefficient for the length in the variables that are followed, and for that in the units in which it is told.
fn coefficient(
    family: &dyn ParametrisedField,
    site: &ContinuationPoint,
    form: Form,
) -> Option<[Uncertain; 2]> {
    let axes = match form {
        Form::Pitchfork => Axes::Symmetry,
        _ => Axes::Any,
    };
    let [first, second] = solutions(family, site, axes, &|circle| match form {
        Form::Torus => circle.torus(),
        Form::Doubling => circle.doubling(),
        Form::Pitchfork => circle.pitchfork(),
    })?;
    let finite = |both: &[f64; 2]| both.iter().all(|x| x.is_finite());
    (finite(&first) && finite(&second)).then(|| [0, 1].map(|i| between(first[i], second[i])))
}

/// The first of two solutions, by what they differ.
pub(super) fn between(first: f64, second: f64) -> Uncertain {
    let uncertainty = SAFETY * (second - first).abs() + LEAST * first.abs();
    Uncertain::new(first, uncertainty)
}

/// What is found on two circles: of other nodes, by maps of another tolerance.
pub(super) fn solutions<R>(
    family: &dyn ParametrisedField,
    site: &ContinuationPoint,
    axes: Axes,
    of: &dyn Fn(&mut Circle<'_>) -> Option<R>,
) -> Option<[R; 2]> {
    let site = finely_cut(family, site)?;
    let [first, second] = SOLUTIONS.map(|(tolerance, parts)| {
        let cut = cut_into(parts, family, &site)?;
        let followed: Across<'_> = &|x, flow| family.across(x, flow);
        let is_forced = family.field(site.at).phase().is_some();
        let in_units = family
            .units()
            .map(|units| move |_: &Vector, flow: &Vector| across_in_units(units, flow, is_forced));
        let told = in_units.as_ref().map(|across| across as Across<'_>);
        let measures: Vec<_> = [followed].into_iter().chain(told).collect();
        let mut squares = squares(family, &cut, axes, &measures)?.into_iter();
        let mut circle = Circle {
            maps: PoincareMaps::new(family, &cut, axes, tolerance)?,
            squares: squares.next()?,
            told: squares.next(),
            period: cut.shooting.period(),
        }
        .begun_at_the_top(axes);
        of(&mut circle)
    });
    Some([first?, second?])
}

/// An orbit with the maps around it.
pub(super) struct Circle<'a> {
    pub maps: PoincareMaps<'a>,
    /// What the square of a displacement in a node's plane adds up to, over the arc that begins there.
    squares: Vec<Matrix>,
    /// The same in the units in which lengths are told, where these are others.
    told: Option<Vec<Matrix>>,
    period: f64,
}

impl Circle<'_> {
    /// The dimension of the planes.
    fn dimension(&self) -> usize {
        self.maps.linear().first().map_or(0, Matrix::ncols)
    }

    /// The same from the node to which most has grown. All nodes are found from the first; from the small end of what grows by
    /// many decades nothing is found.
    fn begun_at_the_top(mut self, axes: Axes) -> Self {
        let mut top = (0, 0.0);
        // Of symmetric orbits, what is symmetric is all that has to be solved for.
        let kept = |mut x: Vector| {
            if axes == Axes::Symmetry {
                x[0] = 0.0;
            }
            x
        };
        let (mut log, mut moved) = (0.0, kept(Vector::repeat(self.dimension(), 1.0)));
        // Once around for what is there at the beginning to die out.
        for turn in 0..2 {
            for (k, map) in self.maps.linear().iter().enumerate() {
                if turn == 1 && (k == 0 || log > top.1) {
                    top = (k, log);
                }
                moved = kept(map * moved);
                let length = moved.norm();
                log += length.ln();
                moved /= length;
            }
        }
        self.squares.rotate_left(top.0);
        if let Some(told) = &mut self.told {
            told.rotate_left(top.0);
        }
        Circle {
            maps: self.maps.beginning_at(top.0),
            ..self
        }
    }

    /// b = <p, C(q,q,q) + 3 B(q, h)> / 6  (5.40)
    fn doubling(&mut self) -> Option<[f64; 2]> {
        let (mu, one) = (C::from(-1.0), C::from(1.0));
        if !self.doubles() {
            return None;
        }
        let (q, p) = self.eigenvectors(mu)?;
        let square = self.each(|maps, k| maps.second(k, &q[k], &q[k]))?;
        let h = self.solve(one, &square)?;
        let cube = self.each(|maps, k| {
            Some(maps.third(k, &q[k])? + maps.second(k, &q[k], &h[k])? * C::from(3.0))
        })?;
        let cubic = (mu * self.solvability(mu, &p, &q, &cube)).re / 6.0;
        Some(self.for_length_one(cubic, &q))
    }

    /// c = <p, C(q,q,q) + 3 B(q, h)> / 6, with q antisymmetric and h symmetric: each is one number in every plane. As products
    /// and quotients they keep their digits where small differences fall by fifty decades along the orbit.
    fn pitchfork(&mut self) -> Option<[f64; 2]> {
        let axis = |i: usize| CVector::from_fn(2, |j, _| C::from(f64::from(u8::from(i == j))));
        let (across, along) = (axis(0), axis(1));
        let mut q = vec![1.0];
        for map in self.maps.linear() {
            q.push(q[q.len() - 1] * map[(0, 0)]);
        }
        // The multiplier across the symmetry, which is 1.
        if q[q.len() - 1].abs().ln().abs() > NEAR {
            return None;
        }
        let longest = q.iter().copied().fold(0.0, f64::max);
        q.iter_mut().for_each(|q| *q /= longest);
        let maps = self.maps.linear().iter();
        let in_plane = maps.map(|map| Matrix::from_element(1, 1, map[(1, 1)]));
        let in_plane: Vec<_> = in_plane.collect();
        let bent = self.each(|maps, k| maps.second(k, &across, &across))?;
        let square = |(bent, q): (&CVector, &f64)| Vector::from_element(1, bent[1].re * q * q);
        let squares: Vec<_> = bent.iter().zip(&q).map(square).collect();
        let h = cyclic::solve(&in_plane, &squares)?;
        let mut sum = 0.0;
        for k in 0..h.len() {
            let third = self.maps.third(k, &across)?[0].re * q[k] * q[k];
            let mixed = self.maps.second(k, &across, &along)?[0].re * h[k][0];
            sum += (third + 3.0 * mixed) * (q[k] / q[k + 1]);
        }
        let q: Vec<_> = q.iter().map(|&q| &across * C::from(q)).collect();
        Some(self.for_length_one(sum / 6.0, &q))
    }

    /// A coefficient of q as one of an eigenvector of which the mean over the period of |q|^2 is 1, both ways in which that is measured.
    fn for_length_one(&self, coefficient: f64, q: &[CVector]) -> [f64; 2] {
        self.for_length(coefficient, 2, q)
    }

    /// The same of a coefficient that falls with this power of the length.
    pub fn for_length(&self, coefficient: f64, power: i32, q: &[CVector]) -> [f64; 2] {
        let by = |squares: &[Matrix]| coefficient / self.mean_square(squares, q).sqrt().powi(power);
        let followed = by(&self.squares);
        let told = self.told.as_ref().map(|squares| by(squares));
        [followed, told.unwrap_or(followed)]
    }

    fn mean_square(&self, squares: &[Matrix], q: &[CVector]) -> f64 {
        let of = |(q, square): (&CVector, &Matrix)| {
            let (re, im) = (q.map(|x| x.re), q.map(|x| x.im));
            re.dot(&(square * &re)) + im.dot(&(square * &im))
        };
        let sum: f64 = q.iter().zip(squares).map(of).sum();
        sum / self.period
    }

    /// d = Re e^(-i theta) <p, C(q,q,q*) + 2 B(q, h11) + B(q*, h20)> / 2  (5.45)
    fn torus(&mut self) -> Option<[f64; 2]> {
        let one = C::from(1.0);
        let mu = self.multiplier()?;
        let (q, p) = self.eigenvectors(mu)?;
        let conjugate: Vec<_> = q.iter().map(CVector::conjugate).collect();
        let length = self.each(|maps, k| maps.second(k, &q[k], &conjugate[k]))?;
        let h11 = self.solve(one, &length)?;
        let square = self.each(|maps, k| maps.second(k, &q[k], &q[k]))?;
        let h20 = self.solve(mu * mu, &square)?;
        let cube = self.torus_cube(&q, &conjugate, &h11, &h20)?;
        let cubic = self.solvability(mu, &p, &q, &cube).re / 2.0;
        Some(self.for_length_one(cubic, &q))
    }

    pub fn each(
        &mut self,
        of: impl Fn(&mut PoincareMaps<'_>, usize) -> Option<CVector>,
    ) -> Option<Vec<CVector>> {
        let count = self.maps.linear().len();
        (0..count).map(|k| of(&mut self.maps, k)).collect()
    }

    /// Whether a multiplier is -1, by all of them.
    fn doubles(&self) -> bool {
        let off = |one: &LogEigenvalue| one.ln_abs.hypot(PI - one.arg.abs());
        let all = eigenvalues_of(self.maps.linear());
        all.is_some_and(|all| all.iter().any(|one| off(one) < NEAR))
    }

    /// e^(i theta): by the pair that is nearest to the unit circle; of a return map of two dimensions by its trace, to more digits.
    fn multiplier(&self) -> Option<C> {
        let maps = self.maps.linear();
        let pair = unit_pair(&eigenvalues_of(maps)?)?;
        let sum = (pair.off < NEAR).then_some(pair.sum)?;
        let sum = if self.dimension() == 2 {
            let start = Matrix::identity(2, 2);
            maps.iter().fold(start, |map, next| next * map).trace()
        } else {
            sum
        };
        let half = 0.5 * sum;
        (half.abs() < 1.0).then(|| C::new(half, (1.0 - half * half).sqrt()))
    }

    /// u_{k+1} = P_k u_k + r_k with u_m = mu u_0.
    pub fn solve(&self, mu: C, right: &[CVector]) -> Option<Vec<CVector>> {
        let mut right = right.to_vec();
        *right.last_mut()? /= mu;
        around(self.maps.linear(), mu.inv(), &right)
    }

    /// The same for a multiplier mu, where the right-hand sides have no part along what is free: the mean of the solutions a little beside it, in which what is
    /// free cancels.
    pub fn solve_singular(&self, mu: C, right: &[CVector]) -> Option<Vec<CVector>> {
        let beside = |side: f64| self.solve(mu * (1.0 + side * BESIDE), right);
        let (below, above) = (beside(-1.0)?, beside(1.0)?);
        let pairs = below.into_iter().zip(above);
        Some(pairs.map(|(a, b)| (a + b) * C::from(0.5)).collect())
    }

    /// q_{k+1} = P_k q_k, q_m = mu q_0; and the same of the transposed maps, p_k for the k-th map. By
    /// inverse iteration a little beside the multiplier.
    pub fn eigenvectors(&self, mu: C) -> Option<(Vec<CVector>, Vec<CVector>)> {
        self.eigenvectors_beside(mu, BESIDE)
    }

    /// The same at this distance beside it: of a double multiplier they are the eigenvector to about so much, as next to it the equations are singular twice.
    pub fn eigenvectors_beside(&self, mu: C, beside: f64) -> Option<(Vec<CVector>, Vec<CVector>)> {
        const ITERATIONS: usize = 3;
        let (maps, count) = (self.maps.linear(), self.dimension());
        let last = maps.len() - 1;
        // From the last plane but one down to the first, and from the last plane at last, where the circle closes.
        let mut transposed: Vec<_> = maps[..last].iter().rev().map(Matrix::transpose).collect();
        transposed.push(maps[last].transpose());
        let factor = (mu * (1.0 + beside)).inv();
        let kernel = |maps: &[Matrix]| {
            // Real, so that what belongs to a real multiplier stays real; and only where the circle closes, so that it is the
            // return map's.
            let mut start = CVector::from_fn(count, |i, _| C::from(0.7_f64.powi(i as i32)));
            let mut v = Vec::new();
            for _ in 0..ITERATIONS {
                let mut right = vec![CVector::zeros(count); maps.len()];
                right[last] = start;
                v = around(maps, factor, &right)?;
                let longest = v.iter().map(|v| v.norm()).fold(0.0, f64::max);
                v.iter_mut().for_each(|v| *v /= C::from(longest));
                start = v[0].clone();
            }
            Some(v)
        };
        let (q, mut p) = (kernel(maps)?, kernel(&transposed)?);
        p[..last].reverse();
        Some((q, p))
    }

    /// What keeps g_{k+1} = P_k g_k + r_k, g_m = mu g_0, from being solvable: x, where x mu q_0 has to be added to g_m; divided by
    /// mu.
    pub fn solvability(&self, mu: C, p: &[CVector], q: &[CVector], right: &[CVector]) -> C {
        let last = right.len() - 1;
        let mut sum = C::from(0.0);
        for (k, (p, r)) in p.iter().zip(right).enumerate() {
            sum += p.dot(r) / if k == last { mu } else { C::from(1.0) };
        }
        sum / p[last].dot(&q[0])
    }
}

/// How far beside a multiplier systems are solved that would be singular there.
const BESIDE: f64 = 1e-7;

/// u_{k+1} = P_k u_k + r_k, u_m = u_0, where the last of the maps is P times a complex factor.
fn around(maps: &[Matrix], factor: C, right: &[CVector]) -> Option<Vec<CVector>> {
    if maps.first()?.ncols() == 2 {
        return around_plane(maps, factor, right);
    }
    let mut maps: Vec<_> = maps.iter().map(|map| map.map(C::from)).collect();
    *maps.last_mut()? *= factor;
    cyclic::solve(&maps, right)
}

/// The same in planes of two dimensions, in real numbers: coefficients keep their last digits.
fn around_plane(maps: &[Matrix], factor: C, right: &[CVector]) -> Option<Vec<CVector>> {
    let last = maps.len() - 1;
    let real = |(k, map): (usize, &Matrix)| -> Matrix {
        let factor = if k == last { factor } else { C::from(1.0) };
        let rotation = [factor.re, -factor.im, factor.im, factor.re];
        Matrix::from_row_slice(2, 2, &rotation).kronecker(map)
    };
    let real: Vec<_> = maps.iter().enumerate().map(real).collect();
    let right = right.iter();
    let right: Vec<_> = right
        .map(|r| Vector::from_column_slice(&[r[0].re, r[1].re, r[0].im, r[1].im]))
        .collect();
    let solution = cyclic::solve(&real, &right)?;
    let complex = |u: &Vector| CVector::from_fn(2, |i, _| C::new(u[i], u[i + 2]));
    Some(solution.iter().map(complex).collect())
}
