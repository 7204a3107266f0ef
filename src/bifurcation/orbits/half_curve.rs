//! Half of a two-parameter curve of bifurcations: from its first point in one direction.

use super::branches::{ROUGH, new_corrector};
use super::cubic_coefficient::{CubicCoefficient, Decided, degenerate_pitchfork};
use super::locus::Locus;
use super::refine::{rough, special};
use super::rows::{GivenParameters, asked};
use super::slab_chart::{Chart, middle};
use super::top::top;
use crate::bifurcation::{Event, EventObserver, Label, LocusRequest, LocusRow, Special};
use crate::continuation::{Met, Stop};
use crate::equilibrium::Symmetry;
use crate::error::Result;
use crate::model::{DRIVING, STIFFNESS};
use crate::number::Uncertain;
use crate::orbit::{
    ContinuationPoint, DirectedPoint, OverLoadings, Palc, Regular, TestFunction, WatchedFunction,
};
use std::ops::ControlFlow::{self, Break, Continue};

/// The most steps on a curve, each way.
const STEPS: usize = 3000;

/// How much longer steps are where the difference of the interfaces is a variable: its logarithm changes by tens along the curve.
const LONGER: f64 = 10.0;

/// R1 to R4 and the value of tr there.
const RESONANCES: [(Label, f64); 4] = [
    (Label::R1, 2.0),
    (Label::R2, -2.0),
    (Label::R3, -1.0),
    (Label::R4, 0.0),
];

/// In ln V_H, ln K and ln T: orbits that differ by less are the same one. What is found on branches is off by 1.5e-8 at most.
const SAME: f64 = 1e-6;

/// Where a curve passes one of the values of K at which bifurcations are looked for.
#[derive(Debug, Clone, Copy)]
pub(super) struct Pass {
    /// (ln V_H, ln K).
    pub at: [f64; 2],
    /// ln T.
    pub period: f64,
}

impl Pass {
    pub fn of(site: &ContinuationPoint) -> Self {
        Pass {
            at: site.at,
            period: site.shooting.period().ln(),
        }
    }

    /// Whether both are the same orbit.
    pub fn is(&self, other: &Self) -> bool {
        let near = |a: f64, b: f64| (a - b).abs() < SAME;
        near(self.at[DRIVING], other.at[DRIVING])
            && near(self.at[STIFFNESS], other.at[STIFFNESS])
            && near(self.period, other.period)
    }
}

/// What is known of one way along a curve.
pub(super) struct HalfCurve<'r, 's> {
    request: &'r LocusRequest,
    test_function: TestFunction,
    number: usize,
    /// The variables that orbits are in at the moment.
    chart: Chart,
    /// Where both ways begin.
    begin: Pass,
    /// Who is told, or what is to be told later.
    seen: Option<EventObserver<'s>>,
    events: Vec<Event>,
    /// The values of ln K at which the curve is to be known again, and where it passes these.
    scan: &'r [f64],
    passes: Vec<Pass>,
    pub told: ControlFlow<()>,
}

impl<'r, 's> HalfCurve<'r, 's> {
    pub fn new(
        locus: &Locus<'r>,
        number: usize,
        begin: Pass,
        seen: Option<EventObserver<'s>>,
    ) -> Self {
        HalfCurve {
            request: locus.request,
            test_function: locus.test_function,
            number,
            chart: locus.chart,
            begin,
            seen,
            events: Vec::new(),
            scan: locus.scan,
            passes: Vec::new(),
            told: Continue(()),
        }
    }

    /// Where it passes, and what nobody was told.
    pub fn kept(self) -> (Vec<Pass>, Vec<Event>) {
        (self.passes, self.events)
    }

    fn tell(&mut self, event: Event) -> ControlFlow<()> {
        let event = event.on(self.number, self.chart.symmetry());
        let event = event.against(self.request.tolerance);
        let Some(seen) = &mut self.seen else {
            self.events.push(event);
            return Continue(());
        };
        let told = seen(event);
        if told.is_break() {
            self.told = told;
        }
        told
    }

    fn watches(&self) -> Vec<WatchedFunction> {
        let request = self.request;
        let mut watches = vec![WatchedFunction::Turn(STIFFNESS)];
        match self.test_function {
            TestFunction::Torus => {
                let resonances = RESONANCES.iter();
                watches.extend(
                    resonances.map(|r| WatchedFunction::TestFunction(TestFunction::Trace(r.1))),
                );
            }
            TestFunction::Doubling | TestFunction::Fold
                if self.chart.symmetry() == Symmetry::Asymmetric =>
            {
                watches.push(WatchedFunction::TestFunction(TestFunction::Torus));
            }
            _ => {}
        }
        let (a, b) = request.driving;
        let drivings = [a, b].into_iter().chain(request.at_driving.iter().copied());
        watches.extend(drivings.map(|x| WatchedFunction::Value(0, x.ln())));
        let (a, b) = request.stiffness;
        let stiffnesses = [a, b]
            .into_iter()
            .chain(request.at_stiffness.iter().copied());
        watches.extend(stiffnesses.map(|x| WatchedFunction::Value(1, x.ln())));
        for &log in self.scan {
            let watch = WatchedFunction::Value(1, log);
            if !watches.contains(&watch) {
                watches.push(watch);
            }
        }
        watches
    }

    /// What was asked for at the orbit where both ways begin: neither comes to it.
    pub fn begins(&mut self, palc: &mut Palc<'_, '_>) {
        let here = palc.now.here.clone();
        for watch in self.watches() {
            if let WatchedFunction::Value(i, value) = watch
                && (self.begin.at[i] - value).abs() < SAME
                && self.told.is_continue()
            {
                // That it may be the range's end is seen to by who asks whether the way leaves it.
                let _ = self.zero(palc, watch, &here);
            }
        }
    }

    /// Whether the way begins at the end of a range and leads out of it.
    pub fn leaves(&self, now: &DirectedPoint) -> bool {
        let ranges = [self.request.driving, self.request.stiffness];
        (0..2).any(|i| {
            let (from, to) = (ranges[i].0.ln(), ranges[i].1.ln());
            let (x, slope) = (now.here.site.at[i], now.direction.parameters[i]);
            x < from + SAME && slope < 0.0 || x > to - SAME && slope > 0.0
        })
    }

    /// To the end, in other variables where these lose digits.
    pub fn go(&mut self, palc: &mut Palc<'_, '_>) -> Result<()> {
        // From where both ways begin on, and up to the ends of the ranges.
        let decided_at = |way: Option<CubicCoefficient>, here: &Regular| {
            way.and_then(|way| Decided::new(here, way.coefficient, way.criticality))
        };
        let mut decided = decided_at(self.way(&palc.now.here), &palc.now.here);
        let mut lost = false;
        let watches = self.watches();
        let end = palc.follow(&watches, STEPS, &mut |palc, before, met| match met {
            Met::Zero(WatchedFunction::Value(..), at)
                if Pass::of(&at.here.site).is(&self.begin) =>
            {
                Continue(())
            }
            Met::Zero(watch, at) => {
                let here = &at.here;
                if let WatchedFunction::Value(..) = watch
                    && let Some(now) = decided_at(self.way(here), here)
                {
                    self.changed(decided.replace(now.clone()), &now)?;
                }
                self.zero(palc, watch, here)
            }
            Met::Point(now) => {
                let here = &now.here;
                let chart = self.chart;
                if chart.merges(&here.site, &before.here.site) {
                    return self.merged(&chart.slab(), &chart.usual(&here.site));
                }
                let way = self.row(here)?;
                if let Some(now) = decided_at(way, here) {
                    self.changed(decided.replace(now.clone()), &now)?;
                }
                lost = chart.loses(&here.site);
                if lost { Break(()) } else { Continue(()) }
            }
        })?;
        if end == Stop::Observer && !lost || self.told.is_break() {
            return Ok(());
        }
        let site = &palc.now.here.site;
        if let Some((chart, there)) = self.chart.keeping(site) {
            let mut corrector = new_corrector(chart.family())?;
            let longest = LONGER * palc.curve.settings.longest;
            if let Some(mut palc) = Palc::resumed(&mut corrector, palc, there, longest) {
                self.chart = chart;
                return self.go(&mut palc);
            }
        }
        let mut special = rough(Label::Mx, &self.chart.usual(site));
        special.note = Some(end.to_string());
        let _ = self.tell(Event::Special(special));
        Ok(())
    }

    /// Tells of where the coefficient is zero between two orbits.
    fn changed(&mut self, before: Option<Decided>, now: &Decided) -> ControlFlow<()> {
        let (chart, test_function) = (self.chart, self.test_function);
        let zero = before
            .and_then(|before| chart.with_curve(test_function, |curve| before.change(now, curve)));
        match zero {
            Some(zero) => self.tell(Event::Special(zero.special())),
            None => Continue(()),
        }
    }

    /// A point of the curve; which way the bifurcation goes there, where that is asked for.
    fn row(&mut self, here: &Regular) -> ControlFlow<(), Option<CubicCoefficient>> {
        // The last correction was made; with old gradients a small part of it is left.
        const LEFT: f64 = 0.05;
        let uncertainty = LEFT * here.residual + 100.0 * ROUGH;
        let at = here
            .site
            .at
            .map(|x| Uncertain::new(x.exp(), uncertainty * x.exp()));
        let way = self.way(here);
        self.put(here, at, way, None)?;
        Continue(way)
    }

    fn way(&self, here: &Regular) -> Option<CubicCoefficient> {
        let wanted = self.request.criticality;
        wanted.then(|| CubicCoefficient::along(self.chart, &here.site, self.test_function))?
    }

    fn put(
        &mut self,
        here: &Regular,
        [driving, stiffness]: [Uncertain; 2],
        way: Option<CubicCoefficient>,
        label: Option<Label>,
    ) -> ControlFlow<()> {
        let period = here.site.shooting.period();
        let torus = self.test_function == TestFunction::Torus;
        let angle = (0.5 * here.spectrum.trace).clamp(-1.0, 1.0).acos();
        let row = LocusRow {
            share: None,
            curve: self.number,
            symmetry: self.chart.symmetry(),
            driving,
            stiffness,
            period: Some(period),
            angle_over_pi: torus.then_some(angle / std::f64::consts::PI),
            criticality: way.map(|way| way.criticality),
            label,
        };
        self.tell(Event::Locus(row))
    }

    fn zero(
        &mut self,
        palc: &mut Palc<'_, '_>,
        watch: WatchedFunction,
        at: &Regular,
    ) -> ControlFlow<()> {
        let test_function = self.test_function;
        let trace = at.spectrum.trace;
        if let WatchedFunction::Value(1, log) = watch
            && self.scan.contains(&log)
        {
            self.passes.push(Pass::of(&at.site));
        }
        let (label, ends) = match watch {
            // Nobody asked for it.
            WatchedFunction::Value(i, value) if self.given(i, value)[i].is_none() => {
                return Continue(());
            }
            WatchedFunction::Value(i, value) => {
                let range = [self.request.driving, self.request.stiffness][i];
                let end = value == range.0.ln() || value == range.1.ln();
                let label = if end { Label::Ep } else { Label::Uz };
                (label, end)
            }
            WatchedFunction::Turn(_) => return self.turn(at),
            WatchedFunction::TestFunction(TestFunction::Trace(value)) => {
                let Some((label, _)) = RESONANCES.iter().find(|r| r.1 == value) else {
                    return Continue(());
                };
                (*label, value.abs() == 2.0)
            }
            // Both multipliers are -1, or 1.
            WatchedFunction::TestFunction(_) => match test_function {
                TestFunction::Doubling if trace < 0.0 => (Label::R2, false),
                TestFunction::Fold if trace > 0.0 => (Label::R1, false),
                _ => return Continue(()),
            },
        };
        let meets = [WatchedFunction::TestFunction(test_function), watch];
        let meets = (&palc.curve.settings.free[..], &meets[..]);
        let (mut special, orbit) = special(self.chart, label, &at.site, meets);
        let orbit = orbit.as_ref().unwrap_or(at);
        if let WatchedFunction::Value(i, value) = watch {
            special.given(self.given(i, value));
        }
        let way = self.way(orbit);
        special.goes(way);
        let known = [special.driving, special.stiffness];
        self.put(orbit, known, way, Some(label))?;
        self.tell(Event::Special(special))?;
        if ends { Break(()) } else { Continue(()) }
    }

    fn given(&self, i: usize, value: f64) -> GivenParameters {
        let request = self.request;
        let ranges = [request.driving, request.stiffness];
        let wanted = [&request.at_driving, &request.at_stiffness];
        let mut given = [None; 2];
        given[i] = asked(value, ranges[i], wanted[i]);
        given
    }

    /// K is stationary along the curve here: its largest value, if it is that.
    fn turn(&mut self, at: &Regular) -> ControlFlow<()> {
        if let Some(top) = top(self.chart.family(), &at.site, self.test_function)
            && top.largest
        {
            let [driving, stiffness] = top.at;
            self.put(&top.orbit, top.at, None, Some(Label::Top))?;
            self.tell(Event::Special(Special {
                period: Some(top.period),
                ..Special::new(Label::Top, driving, stiffness)
            }))?;
        }
        Continue(())
    }

    /// A curve of asymmetric orbits has come to symmetric ones: to the pitchfork at this K.
    fn merged(&mut self, family: &OverLoadings, last: &ContinuationPoint) -> ControlFlow<()> {
        let near = middle(last);
        let special = degenerate_pitchfork(family, &near).unwrap_or_else(|| {
            let mut special = rough(Label::Cp, &near);
            special.note = Some("the curve ends on that of the pitchforks of orbits".into());
            special
        });
        let _ = self.tell(Event::Special(special));
        Break(())
    }
}
