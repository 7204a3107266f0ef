//! Curves of bifurcations of periodic orbits in the plane of two parameters, with their resonances.

use super::branches::{LONGEST, ROUGH, new_corrector, orbits};
use super::chart::{Chart, embedded, middle};
use super::cubic_coefficient::{CoefficientCurve, Decided};
use super::normal_form::{Form, normal_form};
use super::orbit_point::{orbit_point, pass, special_orbit, sum_of_pair};
use crate::bifurcation::equilibria::generic_curve::EquilibriumBifurcation;
use crate::bifurcation::general::curves::{equilibrium_curves, in_order, looked_along, scanned};
use crate::bifurcation::general::{
    GeneralBranch, GeneralCurve, GeneralEvent, GeneralFollowing, GeneralObserver, GeneralPoint,
    GeneralSolution, SAME, Teller,
};
use crate::bifurcation::{Criticality, Label};
use crate::continuation::{Met, Stop};
use crate::equilibrium::Symmetry;
use crate::error::Result;
use crate::field::Vector;
use crate::number::Uncertain;
use crate::orbit::{
    Condition, ContinuationPoint, DirectedPoint, Goal, Palc, PalcSettings, ParametrisedField,
    Regular, ShootingNodes, TangentVector, TestFunction, WatchedFunction,
};
use std::cell::OnceCell;
use std::f64::consts::PI;
use std::ops::ControlFlow::{self, Break, Continue};

/// The most steps on a curve, each way.
const STEPS: usize = 3000;
/// R1 to R4 and the sum of the pair of multipliers there.
const RESONANCES: [(Label, f64); 4] = [
    (Label::R1, 2.0),
    (Label::R2, -2.0),
    (Label::R3, -1.0),
    (Label::R4, 0.0),
];

/// A curve of folds of orbits this much smaller than the largest shrinks to an equilibrium.
const SHRUNK: f64 = 0.05;

/// Follows all curves of this bifurcation of orbits through the ranges and hands on what is found.
///
/// # Errors
/// Those of the orbits; [`crate::Error::TooManyPoints`]. That a curve ends early is none: it is told as `MX`.
pub fn orbit_curves(
    curve: &GeneralCurve<'_>,
    test_function: TestFunction,
    seen: GeneralObserver<'_>,
) -> Result<()> {
    let mut teller = Teller::new(seen, &curve.following);
    let mut curves = OrbitCurves {
        curve,
        test_function,
        along: 0,
        count: 0,
        passes: Vec::new(),
        degenerate: OnceCell::new(),
    };
    test_function.checked(curves.family().dimension())?;
    for along in [0, 1] {
        curves.along = along;
        let given = curve.orbit.iter().map(|orbit| orbit.at[1 - along]);
        let scan: Vec<f64> = given.chain(scanned(curve, 1 - along)).collect();
        for held in scan {
            for seed in curves.seeds(held)? {
                if curves.is_known(&seed) {
                    continue;
                }
                if curves.through(seed, &mut teller)?.is_break() {
                    return teller.end();
                }
            }
        }
        // Branches of orbits take seconds: they are followed along the second coordinate only where a curve may lie along it.
        if curves.count > 0 {
            break;
        }
    }
    teller.end()
}

struct OrbitCurves<'c, 'a> {
    curve: &'c GeneralCurve<'a>,
    test_function: TestFunction,
    /// The coordinate along which bifurcations are looked for.
    along: usize,
    count: usize,
    /// Where curves pass the values at which bifurcations are looked for: both coordinates and ln T.
    passes: Vec<[f64; 3]>,
    /// Degenerate Hopf points in the ranges, once they were asked for.
    degenerate: OnceCell<Vec<GeneralPoint>>,
}

impl<'a> OrbitCurves<'_, 'a> {
    /// The variables in which the curve is followed: of pitchforks those of states in which both parts move alike.
    fn chart(&self) -> Chart<'a> {
        Chart::of(
            &self.curve.system,
            match self.test_function {
                TestFunction::Transverse => Symmetry::Symmetric,
                _ => Symmetry::Asymmetric,
            },
        )
    }

    fn family(&self) -> &'a dyn ParametrisedField {
        self.chart().family()
    }

    /// The bifurcations along a coordinate at a value of the other one.
    fn seeds(&self, held: f64) -> Result<Vec<ContinuationPoint>> {
        let wanted = match self.test_function {
            TestFunction::Fold => Label::Sn,
            TestFunction::Doubling => Label::Pd,
            TestFunction::Transverse => Label::Pf,
            _ => Label::Tr,
        };
        let along = self.along;
        let mut found = Vec::new();
        looked_along(self.curve, along, held, |branch| {
            let given = self.curve.orbit.clone();
            let given = given.filter(|orbit| orbit.at[1 - along] == held);
            let branch = GeneralBranch {
                orbit: given.map(|orbit| ContinuationPoint {
                    at: in_order(along, orbit.at),
                    ..orbit
                }),
                ..branch.clone()
            };
            orbits(&branch, &mut |event| {
                if let GeneralEvent::Row(point) = event
                    && point.label == Some(wanted)
                    && let GeneralSolution::Orbit { shooting, .. } = point.solution
                {
                    let at = in_order(along, point.at);
                    let site = ContinuationPoint { shooting, at };
                    found.push(match self.test_function {
                        TestFunction::Transverse => middle(&site),
                        _ if site.shooting.dimension() < self.family().dimension() => {
                            embedded(&site)
                        }
                        _ => site,
                    });
                }
                Continue(())
            })
        })?;
        Ok(found)
    }

    fn is_known(&self, seed: &ContinuationPoint) -> bool {
        let here = pass(seed);
        let near = |pass: &[f64; 3]| (0..3).all(|i| (pass[i] - here[i]).abs() < SAME);
        self.passes.iter().any(near)
    }

    /// The curve through a bifurcation, both ways.
    fn through(
        &mut self,
        seed: ContinuationPoint,
        teller: &mut Teller<'_>,
    ) -> Result<ControlFlow<()>> {
        self.passes.push(pass(&seed));
        let step = self.curve.following.step;
        let settings = PalcSettings::locus(self.test_function, LONGEST * step);
        let mut corrector = new_corrector(self.family())?;
        let held = settings.and(Condition::Parameter(
            1 - self.along,
            seed.at[1 - self.along],
        ));
        let Ok(closed) = corrector.correct(seed, &settings.free, &held, Goal::STEP) else {
            return Ok(Continue(()));
        };
        let Ok(here) = corrector.look(closed.site, &settings.free, &settings.own()) else {
            return Ok(Continue(()));
        };
        let Some(direction) = settings.direction(&here, &here.along[0]) else {
            return Ok(Continue(()));
        };
        // Told with the second coordinate growing, as curves of equilibria are.
        let sense = direction.parameters[1].signum();
        let direction = direction.scaled(-sense);
        let number = self.count;
        self.count += 1;
        let mut back = Vec::new();
        let begin = (&here, &direction);
        self.half(begin, &settings, number, 1.0, &mut |point, special| {
            back.push((point, special));
            Continue(())
        })?;
        for (point, special) in back.into_iter().rev() {
            if teller.point(point, special).is_break() {
                return Ok(Break(()));
            }
        }
        let (first, special) = self.first(number, &here);
        if teller.point(first, special).is_break() {
            return Ok(Break(()));
        }
        self.half(begin, &settings, number, -1.0, &mut |point, special| {
            teller.point(point, special)
        })?;
        Ok(teller.told)
    }

    /// Where both ways begin, which neither comes to again: as a value that was asked for, if it is that.
    fn first(&self, number: usize, here: &Regular) -> (GeneralPoint, bool) {
        let at = here.site.at;
        let wanted = (0..2).find_map(|i| {
            let mut values = self.curve.at[i].iter();
            let value = values.find(|&&x| (x - at[i]).abs() < SAME)?;
            Some(WatchedFunction::Value(i, *value))
        });
        let Some(watch) = wanted else {
            return (self.row(number, here, None), false);
        };
        let meets = [WatchedFunction::TestFunction(self.test_function), watch];
        let special = (number, Label::Uz);
        let (point, orbit) = special_orbit(self.chart(), special, here, (&[0, 1], &meets));
        let orbit = orbit.as_ref().unwrap_or(here);
        (self.classified(self.angled(point, orbit), orbit), true)
    }

    fn watches(&self) -> Vec<WatchedFunction> {
        let mut watches = Vec::new();
        let dimension = self.family().dimension();
        match self.test_function {
            TestFunction::Torus => watches.extend(
                RESONANCES.map(|(_, sum)| WatchedFunction::TestFunction(TestFunction::Trace(sum))),
            ),
            TestFunction::Doubling | TestFunction::Fold if dimension > 2 => {
                watches.push(WatchedFunction::TestFunction(TestFunction::Torus));
            }
            _ => {}
        }
        for (i, (from, to)) in self.curve.ranges.into_iter().enumerate() {
            let wanted = self.curve.at[i].iter().copied();
            let values = [from, to].into_iter().chain(wanted);
            watches.extend(values.map(|x| WatchedFunction::Value(i, x)));
        }
        let held = 1 - self.along;
        let scan = scanned(self.curve, held).into_iter();
        watches.extend(scan.map(|x| WatchedFunction::Value(held, x)));
        watches
    }

    /// One way from a point of the curve.
    fn half(
        &mut self,
        (here, direction): (&Regular, &TangentVector),
        settings: &PalcSettings,
        number: usize,
        way: f64,
        seen: &mut dyn FnMut(GeneralPoint, bool) -> ControlFlow<()>,
    ) -> Result<()> {
        let mut corrector = new_corrector(self.family())?;
        let direction = direction.clone().scaled(way);
        let palc = Palc::from(
            &mut corrector,
            settings.clone(),
            here.site.clone(),
            direction,
        );
        let Ok(mut palc) = palc else {
            return Ok(());
        };
        let begin = pass(&here.site);
        let watches = self.watches();
        let mut decided = None;
        let mut largest = here.site.shooting.sizes();
        self.change(number, &mut decided, here);
        let end = palc.follow(&watches, STEPS, &mut |palc, _, met| match met {
            Met::Zero(watch, at) => {
                if matches!(watch, WatchedFunction::Value(..))
                    && let (_, Some(zero)) = self.change(number, &mut decided, &at.here)
                {
                    seen(zero, true)?;
                }
                self.zero(palc, (watch, at), number, begin, seen)
            }
            Met::Point(now) => {
                let point = self.row(number, &now.here, None);
                let (way, zero) = self.change(number, &mut decided, &now.here);
                if let Some(zero) = zero {
                    seen(zero, true)?;
                }
                seen(point.classified(way), false)?;
                let extents = now.here.site.shooting.extents();
                largest = largest.sup(&extents);
                if (0..largest.len()).all(|i| extents[i] < SHRUNK * largest[i])
                    && let Some(end) = self.degenerate_hopf_point(number, &now.here)
                {
                    seen(end, true)?;
                    return Break(());
                }
                Continue(())
            }
        })?;
        if end != Stop::Observer {
            let mut point = self.row(number, &palc.now.here, Some(Label::Mx));
            point.note = Some(end.to_string());
            let _ = seen(point, true);
        }
        Ok(())
    }

    /// The degenerate Hopf point to which a curve of folds shrinks. Beside it the fold's condition is a small power of the orbit's size, and soon
    /// rounding.
    fn degenerate_hopf_point(&self, number: usize, orbit: &Regular) -> Option<GeneralPoint> {
        /// Of the ranges, and of the period; and of how far the orbit goes.
        const NEAR: f64 = 0.05;
        const BESIDE: f64 = 2.0;
        if self.test_function != TestFunction::Fold {
            return None;
        }
        let all = self
            .degenerate
            .get_or_init(|| self.degenerate_hopf_points());
        let ContinuationPoint { shooting, at } = &orbit.site;
        let extents = shooting.extents();
        let ranges = self.curve.ranges;
        let near = |point: &&GeneralPoint| {
            let GeneralSolution::Orbit { shooting: rest, .. } = &point.solution else {
                return false;
            };
            let off = |x: &Vector| (x - &rest.nodes[0]).component_div(&extents).amax();
            let part = |i: usize| (point.at[i] - at[i]) / (ranges[i].1 - ranges[i].0);
            let of_period = (shooting.period() / rest.period()).ln();
            shooting.nodes.iter().all(|x| off(x) < BESIDE)
                && [part(0), part(1), of_period]
                    .iter()
                    .all(|off| off.abs() < NEAR)
        };
        let found = all.iter().find(near)?;
        Some(GeneralPoint {
            number,
            ..found.clone()
        })
    }

    /// All in the ranges, as orbits that have shrunk to a point.
    fn degenerate_hopf_points(&self) -> Vec<GeneralPoint> {
        let mut found = Vec::new();
        let mut look = |event| {
            if let GeneralEvent::Row(point) = event
                && point.label == Some(Label::Gh)
                && let GeneralSolution::Equilibrium { state, .. } = &point.solution
                && let Some(period) = point.period
            {
                let log_multipliers = vec![0.0; state.len() - 1];
                let shooting = ShootingNodes {
                    nodes: vec![state.clone()],
                    durations: vec![period.value],
                };
                let solution = GeneralSolution::Orbit {
                    shooting,
                    log_multipliers,
                    neutral: 0.0,
                };
                found.push(GeneralPoint { solution, ..point });
            }
            Continue(())
        };
        let curve = GeneralCurve {
            following: GeneralFollowing {
                skip: Vec::new(),
                ..self.curve.following.clone()
            },
            ..self.curve.clone()
        };
        let all = equilibrium_curves(&curve, EquilibriumBifurcation::Hopf, &mut look);
        all.map_or_else(|_| Vec::new(), |()| found)
    }

    fn zero(
        &mut self,
        palc: &Palc<'_, '_>,
        (watch, at): (WatchedFunction, &DirectedPoint),
        number: usize,
        begin: [f64; 3],
        seen: &mut dyn FnMut(GeneralPoint, bool) -> ControlFlow<()>,
    ) -> ControlFlow<()> {
        let near = &at.here;
        if let WatchedFunction::Value(i, value) = watch {
            let here = pass(&near.site);
            if (0..3).all(|k| (here[k] - begin[k]).abs() < SAME) {
                return Continue(());
            }
            if i == 1 - self.along && scanned(self.curve, i).contains(&value) {
                self.passes.push(here);
                if !self.curve.at[i].contains(&value) {
                    return Continue(());
                }
            }
        }
        /// The sum of a pair e^(+-i theta) that is certainly not real.
        const REAL: f64 = 1.999;
        let sum = |x: f64| RESONANCES.iter().find(|(_, sum)| *sum == x);
        let (label, ends) = match watch {
            WatchedFunction::Value(i, x) => {
                let (from, to) = self.curve.ranges[i];
                let end = x == from || x == to;
                (if end { Label::Ep } else { Label::Uz }, end)
            }
            WatchedFunction::TestFunction(TestFunction::Trace(x)) => match sum(x) {
                Some((label, _)) => (*label, x.abs() == 2.0),
                None => return Continue(()),
            },
            // Both multipliers are -1, or 1; elsewhere the pair whose product is 1 has nothing to do with the bifurcation.
            WatchedFunction::TestFunction(_) if sum_of_pair(near).abs() < REAL => {
                return Continue(());
            }
            WatchedFunction::TestFunction(_) if self.test_function == TestFunction::Doubling => {
                (Label::R2, false)
            }
            WatchedFunction::TestFunction(_) => (Label::R1, false),
            WatchedFunction::Turn(_) => return Continue(()),
        };
        let meets = [WatchedFunction::TestFunction(self.test_function), watch];
        let chart = self.chart();
        let settings = &palc.curve.settings;
        let (point, orbit) = special_orbit(chart, (number, label), near, (&settings.free, &meets));
        let orbit = orbit.as_ref().unwrap_or(near);
        let point = self.classified(self.angled(point, orbit), orbit);
        seen(point, true)?;
        if ends { Break(()) } else { Continue(()) }
    }

    fn row(&self, number: usize, orbit: &Regular, label: Option<Label>) -> GeneralPoint {
        /// The last correction was made; with old gradients a small part of it is left.
        const LEFT: f64 = 0.05;
        let off = LEFT * orbit.residual + 100.0 * ROUGH;
        let point = self.angled(orbit_point(self.chart(), number, orbit, label), orbit);
        let point = point.placed(self.family(), [off; 2]);
        let period = orbit.site.shooting.period();
        GeneralPoint {
            period: Some(Uncertain::new(period, f64::INFINITY)),
            ..point
        }
    }

    /// With the angle of the pair on the unit circle.
    fn angled(&self, mut point: GeneralPoint, orbit: &Regular) -> GeneralPoint {
        if self.test_function == TestFunction::Torus {
            let sum = sum_of_pair(orbit);
            point.angle_over_pi = Some((0.5 * sum).clamp(-1.0, 1.0).acos() / PI);
        }
        point
    }

    fn classified(&self, point: GeneralPoint, orbit: &Regular) -> GeneralPoint {
        point.classified(self.way(&orbit.site))
    }

    /// The cubic coefficient of an orbit of the curve, and which way that is; folds have none.
    fn way(&self, site: &ContinuationPoint) -> Option<(Uncertain, Criticality)> {
        let family = self.family();
        let way = match self.test_function {
            TestFunction::Doubling => normal_form(family, site, Form::Doubling),
            TestFunction::Torus => normal_form(family, site, Form::Torus),
            TestFunction::Transverse => {
                normal_form(self.curve.system.family, &embedded(site), Form::Pitchfork)
            }
            _ => return None,
        };
        way.ok()
    }

    /// Which way the bifurcation goes at an orbit, where that is asked for; and where the coefficient is zero between the last orbit
    /// at which that was decided and this one.
    fn change(
        &self,
        number: usize,
        last: &mut Option<Decided>,
        here: &Regular,
    ) -> (Option<(Uncertain, Criticality)>, Option<GeneralPoint>) {
        let way = match self.curve.criticality {
            true => self.way(&here.site),
            false => None,
        };
        let now = way.and_then(|(coefficient, way)| Decided::new(here, coefficient, way));
        let zero = now.and_then(|now| {
            let before = last.replace(now.clone())?;
            self.coefficient_zero(number, &before, &now)
        });
        (way, zero)
    }

    /// Where the cubic coefficient is zero between two orbits of the curve, if it is.
    fn coefficient_zero(
        &self,
        number: usize,
        before: &Decided,
        now: &Decided,
    ) -> Option<GeneralPoint> {
        let moved = |i: usize| (now.site().at[i] - before.site().at[i]).abs();
        let unknown = (Uncertain::new(0.0, f64::INFINITY), Criticality::Undecided);
        let zero = before.change(
            now,
            CoefficientCurve {
                family: self.family(),
                test_function: self.test_function,
                coefficient: &|site| self.way(site).unwrap_or(unknown),
                held: usize::from(moved(1) >= moved(0)),
            },
        )?;
        let point = GeneralPoint {
            parameters: zero.at,
            period: Some(zero.period),
            note: zero.note,
            ..orbit_point(self.chart(), number, &zero.orbit, Some(zero.label))
        };
        Some(self.angled(point, &zero.orbit))
    }
}
