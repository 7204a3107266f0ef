//! Curves of bifurcations of equilibria of N interfaces in the (V_H, K) plane.
//!
//! K of a Hopf point is a root of the Hurwitz determinant, a polynomial in K at every middle rate of a share: its curves are written down.
//! Folds and branch points are the same at every K: vertical lines.

use super::branch::{steady_curve, told_share};
use super::course::Course;
use super::special::{ShareHopf, fold, meeting};
use crate::bifurcation::equilibria::special::Teller;
use crate::bifurcation::{Label, LocusKind, LocusRequest, LocusRow, Parameter, Special};
use crate::equilibrium::{
    Along, EquilibriumCurve, FAST, MIDDLE, SLOW, Share, SteadyCurve, SteadyPoint, Symmetry,
    constant, shares,
};
use crate::error::Result;
use crate::friction::rounding;
use crate::number::{DoubleDouble, Jet, Uncertain};
use std::ops::ControlFlow;

/// See [`super::locus()`].
pub(super) fn locus(request: &LocusRequest, teller: &mut Teller<'_>) -> Result<ControlFlow<()>> {
    let steady = steady_curve(&request.slab.law, request.driving.1)?;
    let mut run = Run {
        request,
        steady,
        teller,
        curves: 0,
    };
    match request.kind {
        LocusKind::Hopf => run.hopf(),
        _ => run.vertical(),
    }
}

struct Run<'a, 'b> {
    request: &'a LocusRequest,
    steady: SteadyCurve<'a>,
    teller: &'a mut Teller<'b>,
    curves: usize,
}

/// A point of a curve of Hopf points.
struct CurvePoint<'a> {
    hopf: ShareHopf<'a>,
    label: Option<Label>,
    /// What V_H may be off where K is largest, beside its own budget.
    driving_budget: f64,
}

impl<'a> Run<'a, '_> {
    fn wants(&self, symmetry: Symmetry) -> bool {
        self.request
            .symmetry
            .is_none_or(|wanted| wanted == symmetry)
    }

    fn hopf(&mut self) -> Result<ControlFlow<()>> {
        let request = self.request;
        let (law, interfaces) = (&request.slab.law, request.slab.interfaces);
        if self.wants(Symmetry::Symmetric) {
            let course = Course::alike(law, interfaces, request.driving, request.step);
            if self.of_share(&course, [0, interfaces, 0])?.is_break() {
                return Ok(ControlFlow::Break(()));
            }
        }
        let course = Course::shares(self.steady, request.driving.1, request.step);
        let course = course.filter(|_| self.wants(Symmetry::Asymmetric));
        let Some(course) = course else {
            return Ok(ControlFlow::Continue(()));
        };
        for share in shares(self.steady.has(), interfaces) {
            if self.of_share(&course, share)?.is_break() {
                return Ok(ControlFlow::Break(()));
            }
        }
        Ok(ControlFlow::Continue(()))
    }

    /// The curves of a share: as long as there are as many roots each is one.
    fn of_share(&mut self, course: &Course<'a>, share: Share) -> Result<ControlFlow<()>> {
        let roots = |point: &SteadyPoint| point.oscillation(&share).stiffnesses();
        let all: Vec<_> = course
            .points
            .iter()
            .map(|point| (point, roots(point)))
            .collect();
        let mut from = 0;
        for stretch in all.chunk_by(|a, b| a.1.len() == b.1.len()) {
            let count = stretch[0].1.len();
            let to = from + stretch.len();
            let outside = [from.checked_sub(1), Some(to)].map(|i| all.get(i?));
            let ends = [stretch[0].0, stretch[stretch.len() - 1].0];
            from = to;
            if count == 0 {
                continue;
            }
            let mut knots: Vec<SteadyPoint> =
                stretch.iter().map(|(point, _)| (*point).clone()).collect();
            for (outside, inside) in outside.into_iter().zip(ends) {
                if let Some((outside, _)) = outside {
                    let still = |point: &SteadyPoint| roots(point).len() == count;
                    knots.extend(course.up_to(inside, outside, still));
                }
            }
            knots.sort_by(|a, b| a.rate().total_cmp(&b.rate()));
            for root in 0..count {
                let curve = self.points(course, share, root, &knots)?;
                if self.pieces(&curve).is_break() {
                    return Ok(ControlFlow::Break(()));
                }
            }
        }
        Ok(ControlFlow::Continue(()))
    }

    /// The points of one root, with the ends of the ranges, what is asked for, and the largest K.
    fn points(
        &self,
        course: &Course<'a>,
        share: Share,
        root: usize,
        knots: &[SteadyPoint],
    ) -> Result<Vec<CurvePoint<'a>>> {
        let request = self.request;
        let curve = course.curve;
        let found = |point: &SteadyPoint, along, label| {
            let stiffness = point.oscillation(&share).stiffnesses();
            let hopf = ShareHopf {
                curve,
                share,
                point: point.clone(),
                stiffness: *stiffness.get(root)?,
                along,
            };
            Some(CurvePoint {
                hopf,
                label,
                driving_budget: 0.0,
            })
        };
        let stiffness = |point: &SteadyPoint| {
            let all = point.oscillation(&share).stiffnesses();
            all.get(root).map_or(f64::NAN, |k| k.to_f64())
        };
        let slope = |point: &SteadyPoint| -> Along {
            let oscillation = point.oscillation(&share);
            let of_root = oscillation.stiffnesses().get(root).copied();
            let k = of_root.unwrap_or(DoubleDouble::from(f64::NAN));
            // dK/dx = -h_x/h_K
            let h_x = oscillation.determinant_at(constant(k)).gradient[0];
            let h_k = oscillation.determinant_at(Jet::variable(k, 0)).gradient[0] - h_x;
            Jet {
                value: -(h_x / h_k),
                gradient: [DoubleDouble::from(f64::NAN)],
            }
        };
        let plain = knots.iter();
        let plain = plain.filter_map(|point| found(point, Parameter::Stiffness, None));
        let mut all: Vec<CurvePoint<'a>> = plain.collect();
        let asked = |values: &[f64], (from, to): (f64, f64)| -> Vec<(f64, Label)> {
            let ends = [from, to].into_iter().filter(|x| !values.contains(x));
            let asked = values.iter().map(|&x| (x, Label::Uz));
            asked.chain(ends.map(|x| (x, Label::Ep))).collect()
        };
        for pair in knots.windows(2) {
            let [a, b] = [&pair[0], &pair[1]];
            let ends = (a.rate(), b.rate());
            for (value, label) in asked(&request.at_driving, request.driving) {
                let off = |point: &SteadyPoint| point.driving(&share).value.to_f64() - value;
                if off(a) * off(b) < 0.0 {
                    let bracket = (ends.0, ends.1, off(a).signum());
                    let point = curve.zero("a wanted V_H", bracket, |point| {
                        point.driving(&share) - constant(DoubleDouble::from(value))
                    })?;
                    all.extend(found(&point, Parameter::Stiffness, Some(label)));
                }
            }
            for (value, label) in asked(&request.at_stiffness, request.stiffness) {
                let off = |point: &SteadyPoint| stiffness(point) - value;
                if off(a) * off(b) < 0.0 {
                    let bracket = (ends.0, ends.1, off(a).signum());
                    let point = curve.zero("a wanted K", bracket, |point| {
                        let k = point.oscillation(&share).stiffnesses();
                        let k = k.get(root).copied();
                        let k = k.unwrap_or(DoubleDouble::from(f64::NAN));
                        Jet {
                            value: k - value,
                            gradient: [slope(point).value],
                        }
                    })?;
                    let exact = found(&point, Parameter::Driving, Some(label));
                    all.extend(exact.map(|mut one| {
                        one.hopf.stiffness = DoubleDouble::from(value);
                        one
                    }));
                }
            }
            let rises = |point: &SteadyPoint| slope(point).value.to_f64();
            if rises(a) > 0.0 && rises(b) < 0.0 {
                let point = curve.zero("the largest K", (ends.0, ends.1, 1.0), slope)?;
                let top = found(&point, Parameter::Stiffness, Some(Label::Top));
                all.extend(top.map(|one| CurvePoint {
                    driving_budget: self.of_top(curve, &share, &point, &slope),
                    ..one
                }));
            }
        }
        all.sort_by(|a, b| a.hopf.point.rate().total_cmp(&b.hopf.point.rate()));
        Ok(all)
    }

    /// How far V_H of the largest K may be off: the law's parameters are rounded.
    fn of_top(
        &self,
        curve: EquilibriumCurve<'_>,
        share: &Share,
        point: &SteadyPoint,
        slope: &dyn Fn(&SteadyPoint) -> Along,
    ) -> f64 {
        /// Of the rate, relative, to see how the slope changes.
        const CHANGE: f64 = 1e-6;
        let x = point.rates[MIDDLE].value;
        let at =
            |curve: &EquilibriumCurve<'_>, x: DoubleDouble| slope(&curve.point(x)).value.to_f64();
        let [below, above] = [1.0 - CHANGE, 1.0 + CHANGE].map(|part| at(&curve, x * part));
        let steepness = (above - below) / (2.0 * CHANGE * point.rate());
        let of_inputs = rounding(curve.law(), |law| Some(at(&curve.of(law)?, x)));
        let off = of_inputs / steepness.abs() + point.rate() * f64::EPSILON;
        let driving = point.driving(share);
        driving.gradient[0].to_f64().abs() * off + driving.value.to_f64() * f64::EPSILON
    }

    /// What of a curve lies in the ranges.
    fn pieces(&mut self, curve: &[CurvePoint<'_>]) -> ControlFlow<()> {
        /// A relative budget of K that is larger is one beside a fold.
        const CLOSE: f64 = 1e-12;
        let request = self.request;
        let within = |x: f64, (from, to): (f64, f64)| (from..=to).contains(&x);
        let inside = |one: &CurvePoint<'_>| {
            let [driving, stiffness] = one.hopf.place();
            within(driving, request.driving) && within(stiffness, request.stiffness)
        };
        for piece in curve.chunk_by(|a, b| inside(a) == inside(b)) {
            if !inside(&piece[0]) || piece.len() < 2 {
                continue;
            }
            let number = self.curves;
            self.curves += 1;
            if request.skip.contains(&number) {
                continue;
            }
            for one in piece {
                let mut special = one.hopf.special();
                // beside a fold V_H as it is leaves K open: there K is as it is
                if one.label.is_none()
                    && special.stiffness.uncertainty > CLOSE * special.stiffness.value
                {
                    let along = Parameter::Driving;
                    special = ShareHopf {
                        along,
                        ..one.hopf.clone()
                    }
                    .special();
                }
                special.driving.uncertainty += one.driving_budget;
                let symmetry = one.hopf.symmetry();
                let row = LocusRow {
                    period: special.period.map(|period| period.value),
                    criticality: special.criticality.filter(|_| request.criticality),
                    label: one.label,
                    share: Some(told_share(&self.steady, &one.hopf.share, &one.hopf.point)),
                    ..LocusRow::new(number, symmetry, special.driving, special.stiffness)
                };
                self.teller.locus(row)?;
                if let Some(label) = one.label {
                    self.teller.special(Special { label, ..special })?;
                }
            }
        }
        ControlFlow::Continue(())
    }

    /// Lines of folds, or of branch points.
    fn vertical(&mut self) -> Result<ControlFlow<()>> {
        let request = self.request;
        let mut lines = match request.kind {
            LocusKind::SaddleNode => self.folds()?,
            _ => self.meetings(),
        };
        lines.retain(|(_, driving)| {
            (request.driving.0..=request.driving.1).contains(&driving.value)
        });
        for (share, driving) in lines {
            let number = self.curves;
            self.curves += 1;
            if request.skip.contains(&number) {
                continue;
            }
            let symmetry = match share.iter().filter(|&&n| n > 0).count() {
                1 => Symmetry::Symmetric,
                _ => Symmetry::Asymmetric,
            };
            let (from, to) = request.stiffness;
            let ends = [from, to]
                .into_iter()
                .filter(|k| !request.at_stiffness.contains(k));
            let mut all: Vec<(f64, Label)> = ends.map(|k| (k, Label::Ep)).collect();
            all.extend(request.at_stiffness.iter().map(|&k| (k, Label::Uz)));
            all.sort_by(|a, b| a.0.total_cmp(&b.0));
            for (k, label) in all {
                let stiffness = Uncertain::new(k, 0.0);
                let row = LocusRow {
                    label: Some(label),
                    share: Some(share),
                    ..LocusRow::new(number, symmetry, driving, stiffness)
                };
                let special = Special::new(label, driving, stiffness);
                if self.teller.locus(row).is_break() || self.teller.special(special).is_break() {
                    return Ok(ControlFlow::Break(()));
                }
            }
        }
        Ok(ControlFlow::Continue(()))
    }

    fn folds(&self) -> Result<Vec<(Share, Uncertain)>> {
        let request = self.request;
        let course = Course::shares(self.steady, request.driving.1, request.step);
        let course = course.filter(|_| self.wants(Symmetry::Asymmetric));
        let mut all = Vec::new();
        if let Some(course) = &course {
            for share in shares(self.steady.has(), request.slab.interfaces) {
                for bracket in course.fold_brackets(&share) {
                    all.push((share, fold(&course.curve, &share, bracket)?.1));
                }
            }
        }
        Ok(all)
    }

    /// Where n > 1 interfaces pass an extremum together: n = N first, then by their number.
    fn meetings(&self) -> Vec<(Share, Uncertain)> {
        let interfaces = self.request.slab.interfaces;
        let curve = EquilibriumCurve::Shares(self.steady);
        let mut all = Vec::new();
        for together in (2..=interfaces).rev() {
            let symmetry = match together == interfaces {
                true => Symmetry::Symmetric,
                false => Symmetry::Asymmetric,
            };
            for (branch, other) in [(SLOW, FAST), (FAST, SLOW)] {
                let mut share = [0; 3];
                (share[branch], share[other]) = (together, interfaces - together);
                let there = self.steady.has()[other] || share[other] == 0;
                if there
                    && self.wants(symmetry)
                    && let Some((_, driving)) = meeting(&curve, &share, branch)
                {
                    all.push((share, driving));
                }
            }
        }
        all
    }
}
