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
//! chosen: here, where a map is normalised and no flow, that integral is T. |q| is the length across the flow, in (tau, ln psi_1,
//! ln psi_2). Every order is a cyclic linear system; the cubic coefficient is the
//! condition that the last one can be solved. So no map around the whole orbit is needed, whose derivatives a canard makes
//! huge. The same with twice as many nodes and another tolerance shows what a coefficient errs by.

use crate::bifurcation::Criticality;
use crate::number::Uncertain;
use crate::orbit::{
    Axes, ContinuationPoint, ParametrisedField, PoincareJet, cut_into, cyclic, finely_cut, jets,
    squares,
};
use nalgebra::{Complex, Matrix1, Matrix2, Matrix4, Vector1, Vector2, Vector4};

type C = Complex<f64>;
type C2 = Vector2<C>;

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

/// The cubic coefficient of an orbit that bifurcates, and which way that is: b of (5.40) or Re d of (5.45) of the return map,
/// for an eigenvector whose length across the flow, in (tau, ln psi_1, ln psi_2), has the mean square 1 over the period.
pub fn normal_form<F: ParametrisedField<3>>(
    family: &F,
    site: &ContinuationPoint<3>,
    form: Form,
) -> (Uncertain, Criticality) {
    let Some(coefficient) = coefficient(family, site, form) else {
        return (Uncertain::new(0.0, f64::INFINITY), Criticality::Undecided);
    };
    let supercritical = match form {
        Form::Doubling => coefficient.value > 0.0,
        Form::Torus | Form::Pitchfork => coefficient.value < 0.0,
    };
    let criticality = if coefficient.value.abs() <= coefficient.uncertainty {
        Criticality::Undecided
    } else if supercritical {
        Criticality::Supercritical
    } else {
        Criticality::Subcritical
    };
    (coefficient, criticality)
}

fn coefficient<F: ParametrisedField<3>>(
    family: &F,
    site: &ContinuationPoint<3>,
    form: Form,
) -> Option<Uncertain> {
    let site = finely_cut(family, site)?;
    let axes = match form {
        Form::Pitchfork => Axes::Symmetry,
        _ => Axes::Any,
    };
    let [first, second] = SOLUTIONS.map(|(tolerance, parts)| {
        let cut = cut_into(parts, family, &site)?;
        let circle = Circle {
            jets: jets(family, &cut, axes, tolerance)?,
            squares: squares(family, &cut, axes)?,
            period: cut.shooting.period(),
        }
        .begun_at_the_top(axes);
        let coefficient = match form {
            Form::Torus => circle.torus()?,
            Form::Doubling => circle.doubling()?,
            Form::Pitchfork => circle.pitchfork()?,
        };
        coefficient.is_finite().then_some(coefficient)
    });
    let (first, second) = (first?, second?);
    let uncertainty = SAFETY * (second - first).abs() + LEAST * first.abs();
    Some(Uncertain::new(first, uncertainty))
}

/// The maps around an orbit.
struct Circle {
    jets: Vec<PoincareJet>,
    /// What the square of a displacement in a node's plane adds up to, over the arc that begins there.
    squares: Vec<Matrix2<f64>>,
    period: f64,
}

impl Circle {
    /// The same from the node to which most has grown. All nodes are found from the first; from the small end of what grows by
    /// many decades nothing is found.
    fn begun_at_the_top(mut self, axes: Axes) -> Self {
        let mut top = (0, 0.0);
        let (mut log, mut moved) = (0.0, Vector2::new(1.0, 1.0));
        // Once around for what is there at the beginning to die out.
        for turn in 0..2 {
            for (k, jet) in self.jets.iter().enumerate() {
                if turn == 1 && (k == 0 || log > top.1) {
                    top = (k, log);
                }
                moved = match axes {
                    Axes::Any => jet.linear() * moved,
                    // What is symmetric is all that has to be solved for.
                    Axes::Symmetry => Vector2::new(0.0, jet.linear()[(1, 1)] * moved[1]),
                };
                let length = moved.norm();
                log += length.ln();
                moved /= length;
            }
        }
        self.jets.rotate_left(top.0);
        self.squares.rotate_left(top.0);
        self
    }

    /// b = <p, C(q,q,q) + 3 B(q, h)> / 6  (5.40)
    fn doubling(&self) -> Option<f64> {
        let (mu, one) = (C::from(-1.0), C::from(1.0));
        let (q, p) = self.eigenvectors(mu)?;
        let h = self.solve(one, &self.each(|k, jet| jet.second(&q[k], &q[k])))?;
        let cube = self.each(|k, jet| {
            jet.third(&q[k], &q[k], &q[k]) + jet.second(&q[k], &h[k]) * C::from(3.0)
        });
        Some((mu * self.solvability(mu, &p, &q, &cube)).re / 6.0 / self.mean_square(&q))
    }

    /// c = <p, C(q,q,q) + 3 B(q, h)> / 6, with q antisymmetric and h symmetric: each is one number in every plane. As products
    /// and quotients they keep their digits where small differences fall by fifty decades along the orbit.
    fn pitchfork(&self) -> Option<f64> {
        let (across, along) = (
            C2::new(C::from(1.0), C::from(0.0)),
            C2::new(C::from(0.0), C::from(1.0)),
        );
        let mut q = vec![1.0];
        for jet in &self.jets {
            q.push(q[q.len() - 1] * jet.linear()[(0, 0)]);
        }
        let longest = q.iter().copied().fold(0.0, f64::max);
        q.iter_mut().for_each(|q| *q /= longest);
        let in_plane: Vec<_> = self
            .jets
            .iter()
            .map(|jet| Matrix1::new(jet.linear()[(1, 1)]))
            .collect();
        let square = |(jet, q): (&PoincareJet, &f64)| {
            Vector1::new(jet.second(&across, &across)[1].re * q * q)
        };
        let squares: Vec<_> = self.jets.iter().zip(&q).map(square).collect();
        let h = cyclic::solve(&in_plane, &squares)?;
        let mut sum = 0.0;
        for (k, jet) in self.jets.iter().enumerate() {
            let third = jet.third(&across, &across, &across)[0].re * q[k] * q[k];
            let mixed = jet.second(&across, &along)[0].re * h[k][0];
            sum += (third + 3.0 * mixed) * (q[k] / q[k + 1]);
        }
        let q: Vec<C2> = q.iter().map(|&q| across * C::from(q)).collect();
        Some(sum / 6.0 / self.mean_square(&q))
    }

    /// The mean over the period of |q|^2.
    fn mean_square(&self, q: &[C2]) -> f64 {
        let of = |(q, square): (&C2, &Matrix2<f64>)| {
            let (re, im) = (q.map(|x| x.re), q.map(|x| x.im));
            re.dot(&(square * re)) + im.dot(&(square * im))
        };
        let sum: f64 = q.iter().zip(&self.squares).map(of).sum();
        sum / self.period
    }

    /// d = Re e^(-i theta) <p, C(q,q,q*) + 2 B(q, h11) + B(q*, h20)> / 2  (5.45)
    fn torus(&self) -> Option<f64> {
        let one = C::from(1.0);
        let mu = self.multiplier()?;
        let (q, p) = self.eigenvectors(mu)?;
        let conjugate: Vec<C2> = q.iter().map(|q| q.map(|x| x.conj())).collect();
        let h11 = self.solve(one, &self.each(|k, jet| jet.second(&q[k], &conjugate[k])))?;
        let h20 = self.solve(mu * mu, &self.each(|k, jet| jet.second(&q[k], &q[k])))?;
        let cube = self.each(|k, jet| {
            jet.third(&q[k], &q[k], &conjugate[k])
                + jet.second(&q[k], &h11[k]) * C::from(2.0)
                + jet.second(&conjugate[k], &h20[k])
        });
        Some(self.solvability(mu, &p, &q, &cube).re / 2.0 / self.mean_square(&q))
    }

    fn each(&self, of: impl Fn(usize, &PoincareJet) -> C2) -> Vec<C2> {
        self.jets
            .iter()
            .enumerate()
            .map(|(k, jet)| of(k, jet))
            .collect()
    }

    /// e^(i theta), by the trace of the return map.
    fn multiplier(&self) -> Option<C> {
        let map = self
            .jets
            .iter()
            .fold(Matrix2::identity(), |map, jet| jet.linear() * map);
        let half = 0.5 * map.trace();
        (half.abs() < 1.0).then(|| C::new(half, (1.0 - half * half).sqrt()))
    }

    /// u_{k+1} = P_k u_k + r_k with u_m = mu u_0.
    fn solve(&self, mu: C, right: &[C2]) -> Option<Vec<C2>> {
        let maps: Vec<_> = self.jets.iter().map(PoincareJet::linear).collect();
        let mut right = right.to_vec();
        *right.last_mut()? /= mu;
        around(&maps, mu.inv(), &right)
    }

    /// q_{k+1} = P_k q_k, q_m = mu q_0; and the same of the transposed maps, p_k for the k-th map. By
    /// inverse iteration a little beside the multiplier.
    fn eigenvectors(&self, mu: C) -> Option<(Vec<C2>, Vec<C2>)> {
        const ITERATIONS: usize = 3;
        let maps: Vec<_> = self.jets.iter().map(PoincareJet::linear).collect();
        let last = maps.len() - 1;
        // From the last plane but one down to the first, and from the last plane at last, where the circle closes.
        let mut transposed: Vec<_> = maps[..last].iter().rev().map(Matrix2::transpose).collect();
        transposed.push(maps[last].transpose());
        let factor = (mu * (1.0 + BESIDE)).inv();
        let kernel = |maps: &[Matrix2<f64>]| {
            // Real, so that what belongs to a real multiplier stays real; and only where the circle closes, so that it is the
            // return map's.
            let mut v = vec![C2::zeros(); maps.len()];
            v[0] = C2::new(C::from(1.0), C::from(0.7));
            for _ in 0..ITERATIONS {
                let mut right = vec![C2::zeros(); maps.len()];
                right[last] = v[0];
                v = around(maps, factor, &right)?;
                let longest = v.iter().map(|v| v.norm()).fold(0.0, f64::max);
                v.iter_mut().for_each(|v| *v /= C::from(longest));
            }
            Some(v)
        };
        let (q, mut p) = (kernel(&maps)?, kernel(&transposed)?);
        p[..last].reverse();
        Some((q, p))
    }

    /// What keeps g_{k+1} = P_k g_k + r_k, g_m = mu g_0, from being solvable: x, where x mu q_0 has to be added to g_m; divided by
    /// mu.
    fn solvability(&self, mu: C, p: &[C2], q: &[C2], right: &[C2]) -> C {
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
fn around(maps: &[Matrix2<f64>], factor: C, right: &[C2]) -> Option<Vec<C2>> {
    let last = maps.len() - 1;
    let real: Vec<Matrix4<f64>> = maps
        .iter()
        .enumerate()
        .map(|(k, map)| {
            let factor = if k == last { factor } else { C::from(1.0) };
            let rotation = Matrix2::new(factor.re, -factor.im, factor.im, factor.re);
            rotation.kronecker(map)
        })
        .collect();
    let right: Vec<Vector4<f64>> = right
        .iter()
        .map(|r| Vector4::new(r[0].re, r[1].re, r[0].im, r[1].im))
        .collect();
    let solution = cyclic::solve(&real, &right)?;
    let complex = |u: &Vector4<f64>| C2::new(C::new(u[0], u[2]), C::new(u[1], u[3]));
    Some(solution.iter().map(complex).collect())
}
