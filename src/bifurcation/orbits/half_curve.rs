//! Half of a two-parameter curve of bifurcations: from its first point in one direction.

use super::branches::{LONGEST, ROUGH, new_corrector};
use super::chart::Chart;
use super::codimension_two::{codimension_two, met_along};
use super::codimension_two_form::coefficients;
use super::cubic_coefficient::Decided;
use super::degenerate_hopf::DegenerateHopfPoints;
use super::multipliers_together::is_real;
use super::orbit_point::{orbit_point, pass, special_orbit, sum_of_pair};
use super::top::top;
use crate::bifurcation::equilibria::normal_form::{Unfolding, unfolding};
use crate::bifurcation::general::{
    Classified, GeneralCurve, GeneralEvent, GeneralObserver, GeneralPoint, SAME,
};
use crate::bifurcation::{Criticality, Label};
use crate::continuation::{Met, Stop};
use crate::error::Result;
use crate::field::Vector;
use crate::orbit::{
    ContinuationPoint, DirectedPoint, Palc, PalcSettings, Regular, TestFunction, WatchedFunction,
};
use std::f64::consts::PI;
use std::ops::ControlFlow::{self, Break, Continue};

/// The most steps on a curve, each way.
const STEPS: usize = 3000;

/// How much longer steps are where the difference of both parts is a variable: its logarithm changes by tens along the curve.
const LONGER: f64 = 10.0;

/// R1 to R4 and the sum of the pair of multipliers there.
const RESONANCES: [(Label, f64); 4] = [
    (Label::R1, 2.0),
    (Label::R2, -2.0),
    (Label::R3, -1.0),
    (Label::R4, 0.0),
];

/// The number of the function that vanishes along a curve of orbits that do not bifurcate.
const HELD: usize = 0;

/// A coordinate along which K may be largest.
const STIFFNESS: &str = "stiffness";

/// All that the curves of one bifurcation share.
pub(super) struct CurvesOfKind<'c, 'a> {
    pub curve: &'c GeneralCurve<'a>,
    /// What bifurcates; where nothing does, the first of the user's functions vanishes.
    pub test_function: Option<TestFunction>,
    /// The variables that orbits are in at first.
    pub chart: Chart<'a>,
    /// The coordinate at whose values bifurcations are looked for, and these values.
    pub held: usize,
    pub scan: Vec<f64>,
    pub degenerate: DegenerateHopfPoints,
}

impl<'c, 'a> CurvesOfKind<'c, 'a> {
    pub fn new(
        curve: &'c GeneralCurve<'a>,
        test_function: Option<TestFunction>,
        chart: Chart<'a>,
        held: usize,
        scan: &[f64],
    ) -> Self {
        CurvesOfKind {
            curve,
            test_function,
            chart,
            held,
            scan: scan.to_vec(),
            degenerate: DegenerateHopfPoints::default(),
        }
    }

    pub fn settings(&self) -> PalcSettings {
        let longest = LONGEST * self.curve.following.step;
        match self.test_function {
            Some(test_function) => PalcSettings::locus(test_function, longest),
            None => PalcSettings::held(HELD, longest),
        }
    }

    fn watches(&self) -> Vec<WatchedFunction> {
        let curve = self.curve;
        let mut watches = Vec::new();
        let stiffness = curve
            .system
            .names
            .iter()
            .position(|name| *name == STIFFNESS);
        let bifurcates = self.test_function.is_some();
        let dimension = self.chart.family().dimension();
        watches.extend(stiffness.filter(|_| bifurcates).map(WatchedFunction::Turn));
        match self.test_function {
            None => {
                // Each multiplier that comes to the unit circle.
                let along_branches = self.chart.watches().into_iter();
                let fold = WatchedFunction::TestFunction(TestFunction::Fold);
                watches.extend(along_branches.map(|watch| match watch {
                    WatchedFunction::Turn(_) => fold,
                    other => other,
                }));
            }
            Some(TestFunction::Torus) => watches.extend(
                RESONANCES.map(|(_, sum)| WatchedFunction::TestFunction(TestFunction::Trace(sum))),
            ),
            Some(TestFunction::Doubling | TestFunction::Fold) if dimension > 2 => {
                watches.push(WatchedFunction::TestFunction(TestFunction::Torus));
            }
            _ => {}
        }
        if self.test_function == Some(TestFunction::Fold) {
            // At a cusp both coordinates turn; one of them may but be bent.
            let turns = [0, 1].map(WatchedFunction::Turn).into_iter();
            let others: Vec<_> = turns.filter(|turn| !watches.contains(turn)).collect();
            watches.extend(others);
        }
        let met = self.test_function.map_or(&[][..], met_along);
        let met = met.iter().filter(|(_, least)| dimension >= *least);
        watches.extend(met.map(|(one, _)| WatchedFunction::TestFunction(*one)));
        for (i, (from, to)) in curve.ranges.into_iter().enumerate() {
            let values = [from, to].into_iter().chain(curve.at[i].iter().copied());
            watches.extend(values.map(|x| WatchedFunction::Value(i, x)));
        }
        let first = if bifurcates { 0 } else { HELD + 1 };
        watches.extend((first..curve.watch.len()).map(WatchedFunction::UserFunction));
        for &x in &self.scan {
            let watch = WatchedFunction::Value(self.held, x);
            if !watches.contains(&watch) {
                watches.push(watch);
            }
        }
        watches
    }

    /// The purpose of a value of a coordinate: the end of the range, or a point to land on.
    fn asked(&self, i: usize, x: f64) -> Option<Label> {
        let (from, to) = self.curve.ranges[i];
        match x == from || x == to {
            true => Some(Label::Ep),
            false => self.curve.at[i].contains(&x).then_some(Label::Uz),
        }
    }
}

/// What is known of one way along a curve.
pub(super) struct HalfCurve<'s, 'c, 'a> {
    pub kind: &'s CurvesOfKind<'c, 'a>,
    pub number: usize,
    /// The variables that orbits are in at the moment.
    pub chart: Chart<'a>,
    /// What is followed, with the pair on the unit circle where there may be two.
    settings: PalcSettings,
    /// Where there are cusps.
    cusps: Vec<[f64; 3]>,
    /// Where both ways begin.
    begin: [f64; 3],
    seen: GeneralObserver<'s>,
    told: ControlFlow<()>,
    /// Where it passes the values at which bifurcations are looked for.
    pub passes: Vec<[f64; 3]>,
    /// How far each variable goes on the largest orbit.
    largest: Vector,
    pub decided: Option<Decided>,
}

impl<'s, 'c, 'a> HalfCurve<'s, 'c, 'a> {
    pub fn new(
        kind: &'s CurvesOfKind<'c, 'a>,
        number: usize,
        (settings, begin): (&PalcSettings, &ContinuationPoint),
        seen: GeneralObserver<'s>,
    ) -> Self {
        HalfCurve {
            kind,
            number,
            chart: kind.chart,
            settings: settings.clone(),
            cusps: Vec::new(),
            begin: pass(begin),
            seen,
            told: Continue(()),
            passes: Vec::new(),
            largest: kind.chart.in_whole(begin).shooting.sizes(),
            decided: None,
        }
    }

    fn tell(&mut self, event: GeneralEvent) -> ControlFlow<()> {
        self.told?;
        self.told = (self.seen)(event);
        self.told
    }

    /// A special point and its row.
    pub fn special(&mut self, point: GeneralPoint) -> ControlFlow<()> {
        self.tell(GeneralEvent::Special(point.clone()))?;
        self.tell(GeneralEvent::Row(point))
    }

    /// The orbit where both ways begin: as a value that was asked for, if it is that.
    pub fn first(&self, here: &Regular) -> Vec<GeneralEvent> {
        let asked = self
            .kind
            .watches()
            .into_iter()
            .find_map(|watch| match watch {
                WatchedFunction::Value(i, x) if (self.begin[i] - x).abs() < SAME => {
                    Some((watch, self.kind.asked(i, x)?))
                }
                _ => None,
            });
        let Some((watch, label)) = asked else {
            let way = self.wanted_way(&here.site);
            return vec![GeneralEvent::Row(self.row(here, None).classified(way))];
        };
        let point = self.special_point(label, watch, here);
        vec![
            GeneralEvent::Special(point.clone()),
            GeneralEvent::Row(point),
        ]
    }

    /// Whether the way begins at the end of a range and leads out of it.
    pub fn leaves(&self, now: &DirectedPoint) -> bool {
        (0..2).any(|i| {
            let (from, to) = self.kind.curve.ranges[i];
            let (x, slope) = (now.here.site.at[i], now.direction.parameters[i]);
            x < from + SAME && slope < 0.0 || x > to - SAME && slope > 0.0
        })
    }

    /// To the end, in other variables where these lose digits.
    pub fn go(&mut self, palc: &mut Palc<'_, '_>) -> Result<()> {
        let mut loses = false;
        let watches = self.kind.watches();
        // From where both ways begin on, and up to the ends of the ranges.
        self.decided = None;
        let _ = self.changes(&palc.now.here);
        let end = palc.follow(&watches, STEPS, &mut |palc, before, met| match met {
            Met::Zero(watch, at) => {
                self.settings = palc.curve.settings.clone();
                self.zero(watch, &at.here)
            }
            Met::Point(now) => {
                self.settings = palc.curve.settings.clone();
                let here = &now.here;
                if self.chart.merges(&here.site, &before.here.site) {
                    return self.merges(here);
                }
                self.orbit(here)?;
                loses = self.chart.loses(&here.site);
                if loses { Break(()) } else { Continue(()) }
            }
        })?;
        if end == Stop::Observer && !loses || self.told.is_break() {
            return Ok(());
        }
        if let Some((chart, there)) = self.chart.keeping(&palc.now.here.site) {
            let mut corrector = new_corrector(chart.family())?;
            let longest = LONGER * palc.curve.settings.longest;
            if let Some(mut palc) = Palc::resumed(&mut corrector, palc, there, longest) {
                self.chart = chart;
                return self.go(&mut palc);
            }
        }
        let _ = self.special(GeneralPoint {
            note: Some(end.to_string()),
            ..self.row(&palc.now.here, Some(Label::Mx))
        });
        Ok(())
    }

    /// The next orbit of the curve.
    fn orbit(&mut self, here: &Regular) -> ControlFlow<()> {
        let way = self.changes(here)?;
        let point = self.row(here, None).classified(way);
        self.tell(GeneralEvent::Row(point))?;
        let whole = self.chart.in_whole(&here.site);
        self.largest = self.largest.sup(&whole.shooting.extents());
        match self.kind.shrinks_to(self.number, &whole, &self.largest) {
            Some(end) => {
                self.special(end)?;
                Break(())
            }
            None => Continue(()),
        }
    }

    /// Something that is watched is zero here.
    fn zero(&mut self, watch: WatchedFunction, near: &Regular) -> ControlFlow<()> {
        let test_function = self.kind.test_function;
        let sum = sum_of_pair(near);
        let (label, ends) = match watch {
            WatchedFunction::Value(i, x) => {
                let here = pass(&near.site);
                if (0..3).all(|k| (here[k] - self.begin[k]).abs() < SAME) {
                    return Continue(());
                }
                if i == self.kind.held && self.kind.scan.contains(&x) {
                    self.passes.push(here);
                }
                self.changes(near)?;
                match self.kind.asked(i, x) {
                    Some(label) => (label, label == Label::Ep),
                    None => return Continue(()),
                }
            }
            WatchedFunction::Turn(i) => return self.turns(near, i),
            WatchedFunction::UserFunction(_) => (Label::Uf, false),
            WatchedFunction::TestFunction(one) if test_function.is_none() => match one {
                TestFunction::Doubling => (Label::Pd, false),
                TestFunction::Torus if sum.abs() < 2.0 && !is_real(near) => (Label::Tr, false),
                TestFunction::Transverse => (Label::Pf, false),
                TestFunction::Fold => (Label::Sn, false),
                _ => return Continue(()),
            },
            WatchedFunction::TestFunction(TestFunction::Trace(x)) => {
                match RESONANCES.iter().find(|(_, sum)| *sum == x) {
                    Some((label, _)) => (*label, x.abs() == 2.0),
                    None => return Continue(()),
                }
            }
            WatchedFunction::TestFunction(one) => {
                let label = test_function
                    .and_then(|own| codimension_two(own, one, (near, self.sum_of_pair(near))));
                match label {
                    Some(label) => (label, false),
                    None => return Continue(()),
                }
            }
        };
        let point = self.special_point(label, watch, near);
        self.special(point)?;
        if ends { Break(()) } else { Continue(()) }
    }

    /// 2 cos of the angle of the pair that is followed, or else the sum of the two multipliers whose product is nearest to 1.
    fn sum_of_pair(&self, orbit: &Regular) -> f64 {
        match self.settings.condition {
            Some(WatchedFunction::TestFunction(TestFunction::Pair(last))) => {
                let own = orbit.spectrum.two_pairs(Some(last)).map(|[own, _]| own);
                own.unwrap_or(last)
            }
            _ => sum_of_pair(orbit),
        }
    }

    /// A point at which something else is zero too.
    fn special_point(&self, label: Label, watch: WatchedFunction, near: &Regular) -> GeneralPoint {
        let held = WatchedFunction::UserFunction(HELD);
        let own = self.settings.condition.unwrap_or(held);
        let meets = [own, self.settings.meaning(watch, near).unwrap_or(watch)];
        let (mut point, orbit) =
            special_orbit(self.chart, (self.number, label), near, (&[0, 1], &meets));
        match watch {
            WatchedFunction::Value(i, x) => point.at[i] = x,
            WatchedFunction::UserFunction(which) => {
                point = point.at_zero_of(&self.kind.curve.watch, which);
            }
            _ => {}
        }
        let orbit = orbit.as_ref().unwrap_or(near);
        let way = match self.kind.curve.criticality {
            Classified::Never => None,
            _ => self.way(&orbit.site),
        };
        let point = self.angled(point, orbit).classified(way);
        self.unfolded(point, orbit)
    }

    /// A coordinate is stationary along the curve here: a cusp, where both are, or else the largest K, if it is that.
    fn turns(&mut self, at: &Regular, i: usize) -> ControlFlow<()> {
        let curve = self.kind.curve;
        let test_function = self.kind.test_function;
        let top = test_function.and_then(|one| top(self.chart.family(), &at.site, one, i));
        let is_stiffness = curve.system.names[i] == STIFFNESS;
        let folds = test_function == Some(TestFunction::Fold);
        let (label, top) = match top {
            Some(top) if top.both && folds => (Label::Cp, top),
            Some(top) if top.largest && is_stiffness => (Label::Top, top),
            _ => return Continue(()),
        };
        if label == Label::Cp {
            let here = pass(&top.orbit.site);
            let same = |other: &[f64; 3]| (0..3).all(|k| (here[k] - other[k]).abs() < SAME);
            if self.cusps.iter().any(same) {
                return Continue(());
            }
            self.cusps.push(here);
        }
        let point = GeneralPoint {
            parameters: top.at,
            period: Some(top.period),
            ..orbit_point(self.chart, self.number, &top.orbit, Some(label))
        };
        let point = self.angled(point, &top.orbit);
        self.special(self.unfolded(point, &top.orbit))
    }

    /// With the coefficients of the normal form of a point of codimension two, and what these say; of equal parts they are not told.
    fn unfolded(&self, point: GeneralPoint, orbit: &Regular) -> GeneralPoint {
        let (Some(label), None) = (point.label, self.chart.symmetry()) else {
            return point;
        };
        let normal_form = coefficients(self.chart.family(), &orbit.site, label);
        if normal_form.is_empty() {
            return point;
        }
        let Unfolding { criticality, case } = unfolding(label, &normal_form);
        let alone = match &normal_form[..] {
            [alone] => Some(alone.value),
            _ => None,
        };
        // That of the torus has a pole at the other resonances.
        let of_torus = match label {
            Label::R4 => point.coefficient.zip(point.coefficient_uncertainty),
            _ => None,
        };
        let coefficient = alone.map(|alone| (alone.value, alone.uncertainty));
        let (coefficient, coefficient_uncertainty) = coefficient.or(of_torus).unzip();
        let decided = criticality.filter(|one| *one != Criticality::Undecided);
        GeneralPoint {
            criticality: decided.or(point.criticality).or(criticality),
            coefficient,
            coefficient_uncertainty,
            note: point.note.or(case),
            normal_form,
            ..point
        }
    }

    /// A curve of asymmetric orbits has come to symmetric ones: to the degenerate pitchfork at this value of the coordinate.
    fn merges(&mut self, last: &Regular) -> ControlFlow<()> {
        let (chart, site) = self.chart.symmetric(&last.site);
        let bifurcates = self.kind.test_function.is_some();
        let zero = || self.kind.degenerate_pitchfork(chart, &site);
        let zero = bifurcates.then(zero).flatten();
        let point = match zero {
            Some(zero) => self.zero_of_coefficient(chart, zero),
            None if self.kind.test_function.is_none() => GeneralPoint {
                note: Some("the curve ends on a pitchfork of symmetric orbits".into()),
                ..self.row(last, Some(Label::Ep))
            },
            None => GeneralPoint {
                note: Some("the curve ends on the curve of pitchforks of orbits".into()),
                ..self.row(last, Some(Label::Cp))
            },
        };
        self.special(point)?;
        Break(())
    }

    fn row(&self, orbit: &Regular, label: Option<Label>) -> GeneralPoint {
        /// The last correction was made; with old gradients a small part of it is left.
        const LEFT: f64 = 0.05;
        let off = LEFT * orbit.residual + 100.0 * ROUGH;
        let point = orbit_point(self.chart, self.number, orbit, label);
        self.angled(point, orbit)
            .placed(self.chart.family(), [off; 2])
    }

    /// With the angle of the pair on the unit circle.
    pub fn angled(&self, mut point: GeneralPoint, orbit: &Regular) -> GeneralPoint {
        if self.kind.test_function == Some(TestFunction::Torus) {
            let sum = self.sum_of_pair(orbit);
            point.angle_over_pi = Some((0.5 * sum).clamp(-1.0, 1.0).acos() / PI);
        }
        point
    }
}
