//! Curves of Hopf points of equilibria in the (V_H, K) plane.
//!
//! K of a Hopf point is a root of the Hurwitz determinant, a polynomial in K at every middle rate of a share: its curves are written down.
//! They end where K or omega vanishes, the latter at a fold (Bogdanov-Takens); a curve that passes a fold has a zero eigenvalue there beside
//! its pair (zero-Hopf).
//!
//! On the curve of the states in which all slide alike there is neither, as the third eigenvalue is k_c / F_V = N K / F_V > 0 (27) and
//! omega^2 = N K G_psi / F_V > 0. With the paper's parameters the curves of two interfaces end at K = 0: at 2 V_M and 2 V_m the symmetric one,
//! at 2 V_M and where V_fast = V_m the asymmetric one, but for one of no consequence that leaves the Bogdanov-Takens point of V_sn at
//! K = 4.4e-13. l_1 has no zero there either (tests/curves_equilibria.rs; a search over 1293 other sets of parameters of (35) found none
//! either).

use super::branch::told_share;
use super::course::{Course, Step, steady_curve};
use super::hopf_curve::{CurvePoint, Knot, Root};
use super::special::Teller;
use crate::bifurcation::{Label, LocusRequest, LocusRow, Parameter, Special};
use crate::equilibrium::{Share, SteadyCurve, Symmetry, shares};
use crate::error::Result;
use std::ops::ControlFlow;

/// See [`super::locus()`].
pub(super) fn locus(request: &LocusRequest, teller: &mut Teller<'_>) -> Result<ControlFlow<()>> {
    let (slab, interfaces) = (&request.slab, request.slab.interfaces);
    let steady = steady_curve(slab, request.driving.1)?;
    let mut run = Run {
        request,
        steady,
        teller,
        curves: 0,
    };
    let step = Step::new(request.step, request.max_points);
    let wants = |symmetry| request.symmetry.is_none_or(|wanted| wanted == symmetry);
    if wants(Symmetry::Symmetric) {
        let course = Course::alike(&slab.law, interfaces, request.driving, step);
        if run.of_share(&course, [0, interfaces, 0])?.is_break() {
            return Ok(ControlFlow::Break(()));
        }
    }
    let course = Course::shares(steady, request.driving.1, step);
    let Some(course) = course.filter(|_| wants(Symmetry::Asymmetric)) else {
        return Ok(ControlFlow::Continue(()));
    };
    for share in shares(steady.has(), interfaces) {
        if run.of_share(&course, share)?.is_break() {
            return Ok(ControlFlow::Break(()));
        }
    }
    Ok(ControlFlow::Continue(()))
}

struct Run<'a, 'b> {
    request: &'a LocusRequest,
    steady: SteadyCurve<'a>,
    teller: &'a mut Teller<'b>,
    curves: usize,
}

impl<'a> Run<'a, '_> {
    /// The curves of a share: as long as there are as many roots each is one.
    fn of_share(&mut self, course: &Course<'a>, share: Share) -> Result<ControlFlow<()>> {
        let knots = course.points.iter();
        let all: Vec<Knot<'a>> = knots.map(|one| Knot::at(&share, one.clone())).collect();
        if all.iter().all(|knot| knot.roots.is_empty()) {
            return Ok(ControlFlow::Continue(()));
        }
        let folds = course.folds(&share, self.request.driving)?;
        let mut from = 0;
        for stretch in all.chunk_by(|a, b| a.roots.len() == b.roots.len()) {
            let count = stretch[0].roots.len();
            let to = from + stretch.len();
            let outside = [from.checked_sub(1), Some(to)].map(|i| all.get(i?));
            let ends = [&stretch[0].point, &stretch[stretch.len() - 1].point];
            from = to;
            if count == 0 {
                continue;
            }
            let mut knots = stretch.to_vec();
            for (outside, inside) in outside.into_iter().zip(ends) {
                if let Some(outside) = outside {
                    let still = |point| {
                        Some(Knot::at(&share, point)).filter(|knot| knot.roots.len() == count)
                    };
                    knots.extend(course.up_to(inside, &outside.point, still));
                }
            }
            knots.sort_by(|a, b| a.point.rate().total_cmp(&b.point.rate()));
            for place in 0..count {
                let root = Root {
                    course,
                    share,
                    place,
                    count,
                };
                let points = root.points(self.request, &knots, &folds)?;
                let ends = outside.map(|knot| knot.map(|knot| knot.point.rate()));
                let doubles = root.double_zeros(&points, ends, &folds);
                let place = |one: &Special| [one.driving.value, one.stiffness.value];
                let doubles = doubles.map(|one| one.filter(|one| within(self.request, place(one))));
                if self.pieces(root, points, doubles)?.is_break() {
                    return Ok(ControlFlow::Break(()));
                }
            }
        }
        Ok(ControlFlow::Continue(()))
    }

    /// The part of a curve that lies in the ranges.
    fn pieces(
        &mut self,
        root: Root<'_, 'a>,
        points: Vec<CurvePoint<'a>>,
        [below, above]: [Option<Special>; 2],
    ) -> Result<ControlFlow<()>> {
        let request = self.request;
        let inside = |one: &CurvePoint<'_>| within(request, one.hopf.place());
        let last = points.len();
        let mut begin = 0;
        for piece in points.chunk_by(|a, b| inside(a) == inside(b)) {
            let from = begin;
            begin += piece.len();
            if !inside(&piece[0]) || piece.len() < 2 {
                continue;
            }
            let number = self.curves;
            self.curves += 1;
            if request.skip.contains(&number) {
                continue;
            }
            self.teller.on(number, piece[0].hopf.symmetry());
            let doubles = [
                below.as_ref().filter(|_| from == 0),
                above.as_ref().filter(|_| begin == last),
            ];
            let points = root.with_degenerate(piece)?;
            if self.piece(number, &points, doubles).is_break() {
                return Ok(ControlFlow::Break(()));
            }
        }
        Ok(ControlFlow::Continue(()))
    }

    /// Tells of the points of a curve, with the Bogdanov-Takens points at its ends.
    fn piece(
        &mut self,
        number: usize,
        points: &[CurvePoint<'_>],
        [below, above]: [Option<&Special>; 2],
    ) -> ControlFlow<()> {
        if let Some(below) = below {
            self.teller.special(below.clone())?;
        }
        for one in points {
            self.point(number, one)?;
        }
        match above {
            Some(above) => self.teller.special(above.clone()),
            None => ControlFlow::Continue(()),
        }
    }

    /// Tells of a point.
    fn point(&mut self, number: usize, one: &CurvePoint<'_>) -> ControlFlow<()> {
        /// A relative budget of K that is larger is one beside a fold.
        const CLOSE: f64 = 1e-12;
        let (request, hopf) = (self.request, &one.hopf);
        let mut special = hopf.special();
        // beside a fold V_H as it is leaves K open: there K is as it is
        if one.label.is_none() && special.stiffness.uncertainty > CLOSE * special.stiffness.value {
            let mut there = hopf.clone();
            there.along = Parameter::Driving;
            special = there.special();
        }
        let many = request.slab.interfaces > 2;
        let row = LocusRow {
            period: special.period.map(|period| period.value),
            criticality: special.criticality.filter(|_| request.criticality),
            label: one.label,
            share: many.then(|| told_share(&self.steady, &hopf.share, &hopf.point)),
            ..LocusRow::new(number, hopf.symmetry(), special.driving, special.stiffness)
        };
        self.teller.locus(row)?;
        let Some(label) = one.label else {
            return ControlFlow::Continue(());
        };
        special.label = label;
        match label {
            Label::Gh => special.criticality = None,
            // V_H has an extremum there, and K is open
            Label::Zh => special.stiffness.uncertainty = f64::INFINITY,
            _ => {}
        }
        self.teller.special(special)
    }
}

/// Whether V_H and K are in their ranges.
fn within(request: &LocusRequest, [driving, stiffness]: [f64; 2]) -> bool {
    (request.driving.0..=request.driving.1).contains(&driving)
        && (request.stiffness.0..=request.stiffness.1).contains(&stiffness)
}
