//! The normal forms of orbits at points of codimension two: the cusp and the resonances 1:1, 1:2, 1:3 and 1:4.
//!
//! Kuznetsov, Y. A. (2004). Elements of Applied Bifurcation Theory, 3rd edition, sections 9.3 and 9.5;
//!
//! Kuznetsov, Y. A. and Meijer, H. G. E. (2005). Numerical normal forms for codim 2 bifurcations of fixed points with at most two
//! critical eigenvalues. SIAM J. Sci. Comput. 26, 1932-1954.
//!
//! As the cubic coefficients of one parameter (`normal_form`), by cyclic linear systems around the orbit, for a critical eigenvector q whose mean
//! square over the period is 1. At a double multiplier there is a generalised one, A q_1 = mu q_1 + q_0.

use super::normal_form::{C, Circle, solutions};
use crate::bifurcation::Label;
use crate::bifurcation::equilibria::normal_form::NormalFormCoefficient;
use crate::field::{Matrix, Vector};
use crate::orbit::{Axes, CVector, ContinuationPoint, ParametrisedField, cyclic};
use std::f64::consts::TAU;

/// A coefficient: its name, its value for an eigenvector q, and the power of the length of q that it is divided by.
type Value = (&'static str, f64, i32);

/// The coefficients at a point of codimension two; none where they are not known.
pub(super) fn coefficients(
    family: &dyn ParametrisedField,
    site: &ContinuationPoint,
    label: Label,
) -> Vec<NormalFormCoefficient> {
    let made = solutions(family, site, Axes::Any, &|circle| {
        let (q, values) = match label {
            Label::Cp => circle.cusp()?,
            Label::R1 => circle.double_one()?,
            Label::R2 => circle.double_minus_one()?,
            Label::R3 => circle.third_root()?,
            Label::R4 => circle.fourth_root()?,
            _ => return None,
        };
        let told = |(name, value, power): Value| (name, circle.for_length(value, power, &q)[1]);
        Some(values.into_iter().map(told).collect::<Vec<_>>())
    });
    let Some([first, second]) = made else {
        return Vec::new();
    };
    // The resonance 1:4 of an orbit along which nothing else has its angle has an infinite A_0.
    let finite = |all: &[(&str, f64)]| all.iter().all(|(_, x)| x.is_finite());
    if !finite(&first) || !finite(&second) {
        return Vec::new();
    }
    let each = first.into_iter().zip(second);
    let each = each.map(|((name, first), (_, second))| NormalFormCoefficient {
        name,
        value: super::normal_form::between(first, second),
        time: 0,
    });
    each.collect()
}

/// A Jordan block of a double real multiplier: eigenvector and generalised one at all nodes, and what the components along them are of a change at the end
/// of the circle that is the sum of changes at all arcs.
struct Chain {
    q: [Vec<Vector>; 2],
    /// At the end of every arc.
    p: [Vec<Vector>; 2],
}

impl Chain {
    /// The product of p_0 or p_1 with what changes at the arcs add up to.
    fn product(&self, i: usize, changes: &[CVector]) -> f64 {
        let pairs = self.p[i].iter().zip(changes);
        pairs.map(|(p, r)| p.dot(&r.map(|x| x.re))).sum()
    }
}

impl Circle<'_> {
    /// c = <p, C(q,q,q) + 3 B(q, h)> / 6, where <p, B(q,q)> = 0: w -> w + c w^3 (9.3).
    fn cusp(&mut self) -> Option<(Vec<CVector>, Vec<Value>)> {
        let one = C::from(1.0);
        let (q, p) = self.eigenvectors(one)?;
        let square = self.each(|maps, k| maps.second(k, &q[k], &q[k]))?;
        let h = self.solve_singular(one, &square)?;
        let cube = self.each(|maps, k| {
            Some(maps.third(k, &q[k])? + maps.second(k, &q[k], &h[k])? * C::from(3.0))
        })?;
        let c = self.solvability(one, &p, &q, &cube).re / 6.0;
        Some((q, vec![("c", c, 2)]))
    }

    /// (w_0, w_1) -> (w_0 + w_1, w_1 + a w_0^2 + b w_0 w_1): a = <p_0, B(q_0,q_0)> / 2, b = <p_0, B(q_0,q_1)> + <p_1, B(q_0,q_0)>.
    fn double_one(&mut self) -> Option<(Vec<CVector>, Vec<Value>)> {
        let chain = self.chain(1.0)?;
        let [q_0, q_1] = chain.q.each_ref().map(|q| complex(q));
        let square = self.each(|maps, k| maps.second(k, &q_0[k], &q_0[k]))?;
        let mixed = self.each(|maps, k| maps.second(k, &q_0[k], &q_1[k]))?;
        let a = 0.5 * chain.product(0, &square);
        let b = chain.product(0, &mixed) + chain.product(1, &square);
        // With the other sign of the vectors both have the other sign.
        let sign = a.signum();
        Some((q_0, vec![("a", a * sign, 1), ("b", b * sign, 1)]))
    }

    /// (w_0, w_1) -> (-w_0 + w_1, -w_1 + C_1 w_0^3 + D_1 w_0^2 w_1).
    fn double_minus_one(&mut self) -> Option<(Vec<CVector>, Vec<Value>)> {
        let one = C::from(1.0);
        let chain = self.chain(-1.0)?;
        let [q_0, q_1] = chain.q.each_ref().map(|q| complex(q));
        let square = self.each(|maps, k| maps.second(k, &q_0[k], &q_0[k]))?;
        let h_20 = self.solve(one, &square)?;
        let mut mixed = self.each(|maps, k| maps.second(k, &q_0[k], &q_1[k]))?;
        *mixed.last_mut()? += &h_20[0];
        let h_11 = self.solve(one, &mixed)?;
        let cube = self.each(|maps, k| {
            Some(maps.third(k, &q_0[k])? + maps.second(k, &q_0[k], &h_20[k])? * C::from(3.0))
        })?;
        let [own, other] = &chain.q;
        let next = self.each(|maps, k| {
            Some(
                maps.third_of_two(k, &own[k], &other[k])?
                    + maps.second(k, &q_1[k], &h_20[k])?
                    + maps.second(k, &q_0[k], &h_11[k])? * C::from(2.0),
            )
        })?;
        let c_1 = chain.product(0, &cube) / 6.0;
        let d_1 = 0.5 * (chain.product(0, &next) + chain.product(1, &cube));
        Some((q_0, vec![("C_1", c_1, 2), ("D_1", d_1, 2)]))
    }

    /// w -> e^(2 pi i/3) w + B w*^2 + C w |w|^2; its third iterate is the flow of w' = B_1 w*^2 + C_1 w |w|^2 for the time 1 with B_1 = 3 e^(-2 pi i/3) B and
    /// C_1 = 3 e^(-2 pi i/3) C - 3 |B|^2 (9.5.3).
    fn third_root(&mut self) -> Option<(Vec<CVector>, Vec<Value>)> {
        let mu = C::from_polar(1.0, TAU / 3.0);
        let (q, p) = self.eigenvectors(mu)?;
        let [q_bar, p_bar] = [&q, &p].map(|all| conjugate(all));
        let square = self.each(|maps, k| maps.second(k, &q_bar[k], &q_bar[k]))?;
        let b = mu * self.solvability(mu, &p, &q, &square) / 2.0;
        let length = self.each(|maps, k| maps.second(k, &q[k], &q_bar[k]))?;
        let h_11 = self.solve(C::from(1.0), &length)?;
        let mut square = conjugate(&square);
        *square.last_mut()? -= &q_bar[0] * (b.conj() * 2.0);
        let mut h_20 = self.solve_singular(mu * mu, &square)?;
        // Without a part along q*.
        let along = |x: &CVector| p_bar.last().map(|p| p.dot(x));
        let part = along(&h_20[0])? / along(&q_bar[0])?;
        for (h, q) in h_20.iter_mut().zip(&q_bar) {
            *h -= q * part;
        }
        let cube = self.torus_cube(&q, &q_bar, &h_11, &h_20)?;
        let c = mu * self.solvability(mu, &p, &q, &cube) / 2.0;
        let c_1 = mu * mu * c * 3.0 - 3.0 * b.norm_sqr();
        Some((q, vec![("B_1", 3.0 * b.norm(), 1), ("C_1", c_1.re, 2)]))
    }

    /// w -> i w + C w |w|^2 + D w*^3; A_0 = -i C / |D| (9.5.4).
    fn fourth_root(&mut self) -> Option<(Vec<CVector>, Vec<Value>)> {
        let mu = C::I;
        let (q, p) = self.eigenvectors(mu)?;
        let q_bar = conjugate(&q);
        let length = self.each(|maps, k| maps.second(k, &q[k], &q_bar[k]))?;
        let h_11 = self.solve(C::from(1.0), &length)?;
        let square = self.each(|maps, k| maps.second(k, &q[k], &q[k]))?;
        let h_20 = self.solve(mu * mu, &square)?;
        let h_02 = conjugate(&h_20);
        let cube = self.torus_cube(&q, &q_bar, &h_11, &h_20)?;
        let c = mu * self.solvability(mu, &p, &q, &cube) / 2.0;
        let cube = self.each(|maps, k| {
            Some(maps.cube(k, &q_bar[k])? + maps.second(k, &q_bar[k], &h_02[k])? * C::from(3.0))
        })?;
        let d = mu * self.solvability(mu, &p, &q, &cube) / 6.0;
        let a_0 = -C::I * c / d.norm();
        Some((q, vec![("Re A_0", a_0.re, 0), ("Im A_0", a_0.im, 0)]))
    }

    /// C(q,q,q*) + 2 B(q, h11) + B(q*, h20)
    pub(super) fn torus_cube(
        &mut self,
        q: &[CVector],
        q_bar: &[CVector],
        h_11: &[CVector],
        h_20: &[CVector],
    ) -> Option<Vec<CVector>> {
        self.each(|maps, k| {
            Some(
                maps.third(k, &q[k])?
                    + maps.second(k, &q[k], &h_11[k])? * C::from(2.0)
                    + maps.second(k, &q_bar[k], &h_20[k])?,
            )
        })
    }

    /// The Jordan block of a double multiplier 1 or -1, with <p_0, q_1> = <p_1, q_0> = 1 and <p_0, q_0> = <p_1, q_1> = 0. The eigenvectors border the singular
    /// equations.
    fn chain(&self, mu: f64) -> Option<Chain> {
        let real = |all: &[CVector]| -> Vec<Vector> {
            let each = all.iter();
            each.map(|v| v.map(|x| x.re)).collect()
        };
        /// How far beside the multiplier the border is taken.
        const ROUGHLY: f64 = 1e-3;
        let (q, p) = self.eigenvectors_beside(C::from(mu), ROUGHLY)?;
        let (q, p) = (real(&q), real(&p));
        let maps = self.maps.linear();
        let last = maps.len() - 1;
        let mut transposed: Vec<_> = maps[..last].iter().rev().map(Matrix::transpose).collect();
        transposed.push(maps[last].transpose());
        // What belongs to the transposed maps begins at the last node.
        let first = if last > 0 { &p[last - 1] } else { &p[last] };
        let [q_0, q_1] = block(maps, mu, (&q[0], &p[last]))?;
        let [v_0, v_1] = block(
            &transposed,
            mu,
            (first, &q[if last > 0 { last } else { 0 }]),
        )?;
        // At the ends of the arcs: of all but the last by what comes back to them once around.
        let at_ends = |all: &dyn Fn(usize) -> Vector| -> Vec<Vector> {
            let before = (0..last).map(|k| all(last - 1 - k));
            before.collect()
        };
        let mut p_0 = at_ends(&|j| &v_0[j] * mu);
        let mut p_1 = at_ends(&|j| &v_1[j] * mu + &v_0[j]);
        p_0.push(v_0[last].clone());
        p_1.push(v_1[last].clone());
        let scale = p_0[last].dot(&q_1[0]);
        let part = p_1[last].dot(&q_1[0]) / scale;
        for (one, zero) in p_1.iter_mut().zip(&p_0) {
            *one = (&*one - zero * part) / scale;
        }
        p_0.iter_mut().for_each(|p| *p /= scale);
        Some(Chain {
            q: [q_0, q_1],
            p: [p_0, p_1],
        })
    }
}

/// u_0 and u_1 with u_m = mu u_0 around the circle for the first, and that plus the first one for the second; row and column of the border.
fn block(maps: &[Matrix], mu: f64, (row, column): (&Vector, &Vector)) -> Option<[Vec<Vector>; 2]> {
    let mut maps = maps.to_vec();
    *maps.last_mut()? /= mu;
    let mut right = vec![Vector::zeros(row.len()); maps.len()];
    let first = cyclic::solve_bordered(&maps, &right, column, (row, row.norm_squared()))?;
    *right.last_mut()? = &first[0] / -mu;
    let second = cyclic::solve_bordered(&maps, &right, column, (row, 0.0))?;
    Some([first, second])
}

fn complex(all: &[Vector]) -> Vec<CVector> {
    all.iter().map(|v| v.map(C::from)).collect()
}

fn conjugate(all: &[CVector]) -> Vec<CVector> {
    all.iter().map(CVector::conjugate).collect()
}
