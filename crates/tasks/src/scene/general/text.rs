//! A user-defined system, to be continued in any of its parameters.

use super::{RowKind, Subject};
use crate::scene::continuation::SearchOptions;
use crate::scene::following;
use crate::scene::system::Described;
use crate::scene::text::{SearchPlace, TextEquilibriaPlan, TextModel, TextSlab, orbit_start};
use crate::scene::units::{Quantity, Units};
use serde_json::{Map, Value};
use std::borrow::Cow;
use twinslip::bifurcation::general::{GeneralPoint, GeneralSolution, StateRange};
use twinslip::equilibrium::Symmetry;
use twinslip::error::{Error, Result};
use twinslip::field::Vector;
use twinslip::integrate::{AnyField, Choice, MotionUnits, Tolerances};
use twinslip::model::TextSystem;
use twinslip::number::Interval;
use twinslip::orbit::{
    AlongArcs, ContinuationPoint, Coordinate, Digits, FoundOrbit, OrbitAccuracy, OverText,
    ParametrisedField, Solution, WithinCluster, find_from, ranges,
};

/// A user-defined system, and where its equilibria and orbits are looked for.
#[derive(Debug, Clone, PartialEq)]
pub struct TextSubject {
    /// The system.
    pub model: TextModel,
    /// The units in which it is followed.
    units: MotionUnits,
    /// The equations in these.
    system: TextSystem,
    /// Where equilibria are looked for; of interfaces, where nothing is said, among all their steady states.
    pub place: Option<SearchPlace>,
    /// A point at or near an orbit and the period, roughly.
    pub orbit: Option<(Vector, Option<f64>)>,
    /// How many periods of a forcing orbits last.
    turns: usize,
}

impl Described for TextSubject {
    fn echo(&self) -> &Map<String, Value> {
        self.model.echo()
    }

    fn units(&self) -> &Units {
        self.model.units()
    }
}

impl TextSubject {
    /// Of a system with where its equilibria and orbits are looked for: in a box or near the file's start, and near a point
    /// with a rough period.
    ///
    /// # Errors
    /// Those of the box and of the start.
    pub fn new(model: TextModel, search: &SearchOptions, orbits: bool) -> Result<Self> {
        let (within, start) = (search.within.as_deref(), search.start.as_deref());
        if !orbits {
            model.may_rest()?;
        }
        let period = model.period(search.turns, search.period_guess)?;
        let turns = search.turns.unwrap_or(1);
        let orbit = match start.filter(|_| orbits) {
            Some(start) => Some((model.start(Some(start))?, period)),
            None if search.period_guess.is_some() => {
                let what = "`period_guess` needs a `start` near the orbit";
                return Err(Error::Input(what.into()));
            }
            None => None,
        };
        let near = start.filter(|_| !orbits);
        if within.is_some() && near.is_some() {
            return Err(Error::Input(
                "`start` and `box` both set where equilibria are searched for; give one of them"
                    .into(),
            ));
        }
        let place = match (within, near) {
            (Some(text), _) => Some(SearchPlace::within(text, &model)?),
            (None, None) if model.slab.is_some() => None,
            // Where an orbit is given none is needed.
            (None, None) if orbit.is_some() && model.start(None).is_err() => {
                Some(SearchPlace::Near(model.start(start)?))
            }
            (None, near) => Some(SearchPlace::Near(model.start(near)?)),
        };
        let start = match (&orbit, &place) {
            (Some((start, _)), _) | (None, Some(SearchPlace::Near(start))) => Some(start.clone()),
            _ => model.start(None).ok(),
        };
        let system = &model.system;
        let units = match (start, &place) {
            (Some(start), _) => model.motion_units_of_branch(&start)?,
            (None, Some(SearchPlace::Within(ranges))) => model.motion_units_within(ranges)?,
            (None, _) => MotionUnits::given(system.states().len()),
        };
        Ok(TextSubject {
            system: units.inward_system(system)?,
            units,
            model,
            place,
            orbit,
            turns,
        })
    }

    fn at(&self, values: &[(&str, f64)]) -> Result<TextSystem> {
        Self::set(&self.model.system, values)
    }

    /// The period of orbits under a forcing.
    fn forced_period(&self, system: &TextSystem) -> Option<f64> {
        let period = system.forcing_period()?;
        Some(self.turns as f64 * period)
    }

    fn set(system: &TextSystem, values: &[(&str, f64)]) -> Result<TextSystem> {
        let mut system = system.clone();
        for &(name, value) in values {
            system.set(name, value)?;
        }
        Ok(system)
    }
}

impl Subject for TextSubject {
    fn parameters(&self) -> Vec<(&'static str, Quantity)> {
        let names = self.model.system.parameter_names().iter();
        let slides = self.model.slab.is_some();
        let quantity = |name: &str| match slides {
            true => Quantity::of_parameter(name),
            false => Quantity::Number,
        };
        names.map(|name| (*name, quantity(name))).collect()
    }

    fn value(&self, name: &str) -> Result<f64> {
        let system = &self.model.system;
        Ok(system.parameters()[twinslip::field::place(system.parameter_names(), name)?])
    }

    fn family<'s>(
        &'s self,
        names: &[&str],
        coordinates: [Coordinate; 2],
    ) -> Result<Box<dyn ParametrisedField + 's>> {
        let system = &self.system;
        Ok(match *names {
            [first, second] => Box::new(OverText::two(system, [first, second], coordinates)?),
            [only] => Box::new(OverText::one(system, only, coordinates[0])?),
            _ => return Err(Error::Input("one parameter may vary, or two".into())),
        })
    }

    fn equilibria(&self, values: &[(&str, f64)]) -> Result<Vec<Vector>> {
        if !self.may_rest() {
            return Ok(Vec::new());
        }
        let system = self.at(values)?;
        let model = self.model.with(system);
        let place = match &self.place {
            Some(place) => place.clone(),
            None => SearchPlace::Within(model.steady_box()?),
        };
        let plan = TextEquilibriaPlan { place, model };
        let found = match plan.solve() {
            Ok(found) => found.equilibria,
            // There need not be one near the start for each value.
            Err(Error::NotConverged { .. }) => Vec::new(),
            Err(error) => return Err(error),
        };
        let state = found.iter().map(|one| one.state.iter().map(|x| x.value));
        Ok(state
            .map(|state| self.units.inward(&Vector::from_vec(state.collect())))
            .collect())
    }

    fn may_rest(&self) -> bool {
        self.system.phase().is_none()
    }

    fn bounds(&self) -> Vec<StateRange> {
        let Some(SearchPlace::Within(ranges)) = &self.place else {
            return Vec::new();
        };
        let states = self.model.system.states().iter();
        let all = states.zip(ranges).zip(&self.units.sizes);
        let bound = |((name, range), size): ((&&str, &Interval), &f64)| {
            let said = |x: f64, side: &str| {
                format!("the branch leaves the box at {name} = {x}, its {side} bound")
            };
            StateRange {
                range: (range.lo() / size, range.hi() / size),
                said: [said(range.lo(), "lower"), said(range.hi(), "upper")],
            }
        };
        all.map(bound).collect()
    }

    fn orbit(&self, values: &[(&str, f64)]) -> Result<Option<ContinuationPoint>> {
        let Some((start, period)) = &self.orbit else {
            return Ok(None);
        };
        let system = Self::set(&self.system, values)?;
        let given = period.map(|t| t / self.units.time);
        let (start, period) = (
            self.units.inward(start),
            self.forced_period(&system).or(given),
        );
        let field = AnyField::of_text(Cow::Owned(system))?;
        let found = find_from(&field, &start, period, &OrbitAccuracy::unchecked())?;
        Ok(Some(found.orbit.beginning()))
    }

    fn orbits(&self, values: &[(&str, f64)]) -> Vec<ContinuationPoint> {
        let search = || -> Result<_> {
            let model = self.model.with(self.at(values)?);
            let start = orbit_start(None, Symmetry::Symmetric, &model)?;
            let system = Self::set(&self.system, values)?;
            let period = self.forced_period(&system);
            let field = AnyField::of_text(Cow::Owned(system))?;
            let start = self.units.inward(&start);
            find_from(&field, &start, period, &OrbitAccuracy::unchecked())
        };
        search().map_or(Vec::new(), FoundOrbit::beginnings)
    }

    fn coordinate(&self, _: &str, ends: [f64; 2]) -> Result<Coordinate> {
        Ok(Coordinate::of(&ends))
    }

    fn default_range(&self, name: &str) -> Option<(f64, f64)> {
        // Of interfaces as of those that are built in.
        self.model.slab.as_ref()?;
        let (from, to) = following::loading_range(name)?;
        let outward = |x| self.units().outward(Quantity::of_parameter(name), x);
        Some((outward(from), outward(to)))
    }

    fn always_told(&self) -> Vec<(&'static str, Quantity)> {
        let loading = ["driving", "stiffness"].map(|name| (name, Quantity::of_parameter(name)));
        let slab = self.model.slab.as_ref();
        slab.map_or(Vec::new(), |_| loading.to_vec())
    }

    fn interchangeable(&self) -> Vec<Vec<Vec<usize>>> {
        let slab = self.model.slab.as_ref();
        slab.map_or(Vec::new(), TextSlab::interchangeable)
    }

    fn clusters(&self) -> Vec<usize> {
        let counts = self.model.slab.iter().flat_map(|slab| slab.clusters());
        let split = counts.zip(1..).filter(|(count, _)| **count > 1);
        split.map(|(_, cluster)| cluster).collect()
    }

    fn within(
        &self,
        family: &dyn ParametrisedField,
        point: &GeneralPoint,
        sharp: bool,
    ) -> Result<Vec<WithinCluster>> {
        /// Of rows: tolerance of the flow, and what their nodes may be off.
        const ROUGH: (f64, f64) = (1e-8, 1e-6);
        const FINE: (f64, f64) = (1e-15, 1e-13);
        let slab = self.model.slab.as_ref();
        let Some(slab) = slab.filter(|slab| slab.has_clusters()) else {
            return Ok(Vec::new());
        };
        let names = self.model.system.parameter_names();
        let places = family.plane();
        let values = family.parameters(point.at);
        let mut system = self.model.system.clone();
        for (place, value) in places.into_iter().zip(values).rev() {
            system.set(names[place], value)?;
        }
        match &point.solution {
            GeneralSolution::Equilibrium { state, .. } => Ok(slab.within_state(&system, state)),
            GeneralSolution::Orbit { shooting, .. } => {
                let (tolerance, uncertainty) = if sharp { FINE } else { ROUGH };
                let along = AlongArcs {
                    method: Choice::Taylor,
                    tolerances: Tolerances::equal(tolerance)?,
                    uncertainty,
                };
                slab.within(&system, shooting, along)
            }
        }
    }

    fn dimension(&self) -> usize {
        self.model.system.states().len()
    }

    fn states(&self) -> Vec<(String, Quantity)> {
        let states = self.model.system.states().iter().enumerate();
        states
            .map(|(place, name)| ((*name).to_owned(), self.model.quantity(place)))
            .collect()
    }

    fn state_outward(&self, state: &Vector) -> Vec<f64> {
        self.units.outward(state).as_slice().to_vec()
    }

    fn state_inward(&self, states: &[f64]) -> Vector {
        self.units.inward(&Vector::from_column_slice(states))
    }

    fn numbers(&self, kind: RowKind) -> Vec<(String, Quantity)> {
        let states = self.states().into_iter();
        match kind.orbits {
            true => states
                .take(self.model.moving())
                .flat_map(|(name, quantity)| {
                    ["min", "max"].map(|end| (format!("{name}_{end}"), quantity))
                })
                .collect(),
            false => states.collect(),
        }
    }

    fn told(
        &self,
        (family, at): (&dyn ParametrisedField, [f64; 2]),
        solution: Solution<'_>,
        digits: Digits,
    ) -> Result<Vec<f64>> {
        match solution {
            Solution::Equilibrium { state, .. } => Ok(self.state_outward(state)),
            Solution::Orbit(shooting) => {
                let ranges = ranges(&family.field(at), shooting, digits)?;
                let ranges = ranges.into_iter().zip(&self.units.sizes);
                let ranges = ranges.take(self.model.moving());
                Ok(ranges
                    .flat_map(|((a, b), size)| [a * size, b * size])
                    .collect())
            }
        }
    }

    fn unit_of_time(&self) -> f64 {
        self.units.time
    }

    fn length(&self, direction: &Vector) -> f64 {
        self.units.outward(direction).norm()
    }
}
