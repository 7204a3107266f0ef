//! Slip events of many interfaces: times in which at least one of them slides faster than a threshold.
//!
//! An interface *slips* while its rate is above the threshold. An event lasts from the moment at which the first one goes above to that
//! from which on none is above. Crossings are roots of the series of the rates. In a step of the tolerance these change by little: a
//! bound by the sums of the absolute terms tells for nearly all interfaces, eight at a time, that they do not cross at all.

mod saved;

use crate::error::Result;
use crate::friction::positive;
use crate::many::block::{Layout, MOST};
use crate::many::constants::{LANES, Lanes};
use crate::many::interfaces::ManyInterfaces;
use crate::many::share::{CHUNK, MANY};
use crate::many::taylor::StepSeries;
use crate::many::vectors::Vectorised;
use crate::number::DoubleDouble;
use crate::number::polynomial::{Crossing, evaluate, roots};
use crate::series::Zeros;
use pulp::NullaryFnOnce;
use rayon::prelude::*;

/// One slip event of many interfaces, dimensionless.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct ManyEvent {
    /// The time at which the first interface begins to slip.
    pub onset: f64,
    /// Time since the onset of the event before.
    pub recurrence: Option<f64>,
    /// Time from the onset until no interface slips any more.
    pub duration: f64,
    /// tau at the onset.
    pub stress_before: f64,
    /// How far tau is lower at the end. Below 0 if it has risen, as where one slips slower than V_H.
    pub stress_drop: f64,
    /// The largest total slip rate of all interfaces.
    pub peak_slip_rate: f64,
    /// How many interfaces slip.
    pub participants: usize,
    /// The slip of all participants together, each while it slips.
    pub slip: f64,
    /// The interface that slips farthest, from 0; of equal ones that with the lowest number.
    pub leader: usize,
    /// The interface that begins, from 0; of those that begin at once that with the lowest number.
    pub first: usize,
}

impl ManyEvent {
    /// log10 of the slip of all participants together.
    pub fn magnitude(&self) -> f64 {
        self.slip.log10()
    }
}

/// What an interface has done in all events so far.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Participation {
    /// In how many it slipped.
    pub events: usize,
    /// Its slip in these, while it slipped.
    pub slip: f64,
}

/// An event whose end is not known yet.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct UnderWay {
    /// Its onset; `None` where the flow began within it.
    pub since: Option<f64>,
    /// How many interfaces have slipped in it.
    pub participants: usize,
}

/// Finds the slip events of a flow, from each of its steps in turn. An event in which the flow begins is none, as its onset is not known.
///
/// ```
/// use twinslip::friction::{AnyLaw, Parameters};
/// use twinslip::many::{ManyInterfaces, ManyTaylor, SlipEvents};
/// use twinslip::model::Loading;
/// # fn main() -> twinslip::Result<()> {
/// let law = AnyLaw::Spinodal(Parameters::heslot_1994().spinodal());
/// let ten = ManyInterfaces::alike(law, 10, Loading::new(10.0, 0.14)?)?;
/// let states: Vec<f64> = (1..=10).map(|i| 0.002 * (1.0 + 0.01 * f64::from(i))).collect();
/// let mut events = SlipEvents::new(&ten, 10.0)?;
/// ManyTaylor::new(1e-12, 100_000)?.flow(&ten, (9.9, &states), 20.0, &mut |step| {
///     events.see(&step.series().expect("Taylor's steps are series"));
///     Ok(true)
/// })?;
/// let last = events.events().last().expect("an event");
/// assert_eq!(last.participants, 1);
/// assert!(last.recurrence.is_some_and(|time| (3.0..4.0).contains(&time)));
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone)]
pub struct SlipEvents {
    threshold: f64,
    watched: Vec<Watched>,
    begun: bool,
    open: Option<Open>,
    last_onset: Option<DoubleDouble>,
    events: Vec<ManyEvent>,
    participation: Option<Vec<Participation>>,
}

/// Eight interfaces; a bit of a mask is one of them.
#[derive(Debug, Clone, Copy, Default)]
struct Watched {
    /// Which slip, at the end of the last step.
    above: u8,
    /// Which have slipped in the event under way.
    taken: u8,
    /// Which are above the threshold during the whole step, for certain.
    surely: u8,
    /// Which may be above it at some time of the step.
    maybe: u8,
    /// Slip in the event under way.
    slip: Lanes,
}

/// An event under way.
#[derive(Debug, Clone)]
struct Open {
    /// `None` where the flow begins within it.
    from: Option<Moment>,
    peak: f64,
    participants: Vec<usize>,
}

#[derive(Debug, Clone, Copy)]
struct Moment {
    time: DoubleDouble,
    stress: f64,
}

/// A time within a step in which an interface slips, in the step's unit.
#[derive(Debug, Clone, Copy)]
struct Stretch {
    interface: usize,
    from: f64,
    to: f64,
    slip: f64,
    /// Whether it goes above here; else it has been before the step.
    rises: bool,
    /// Whether it goes below here; else it is above at the end of the step.
    falls: bool,
}

/// What is found of the interfaces of a chunk in a step.
#[derive(Debug, Default)]
struct Found {
    stretches: Vec<Stretch>,
    /// Whether any slips all the time; it has no stretch.
    throughout: bool,
}

impl SlipEvents {
    /// Of a flow of these interfaces, which slip while they are faster than so much.
    ///
    /// # Errors
    /// [`crate::error::Error::Parameter`] for a threshold that is not positive.
    pub fn new(interfaces: &ManyInterfaces, threshold: f64) -> Result<Self> {
        Ok(SlipEvents {
            threshold: positive("threshold", threshold)?,
            watched: vec![Watched::default(); interfaces.count().div_ceil(LANES)],
            begun: false,
            open: None,
            last_onset: None,
            events: Vec::new(),
            participation: None,
        })
    }

    /// Also tells what each interface does.
    #[must_use]
    pub fn with_participation(self, interfaces: &ManyInterfaces) -> Self {
        SlipEvents {
            participation: Some(vec![Participation::default(); interfaces.count()]),
            ..self
        }
    }

    /// The events that have ended, in their order.
    pub fn events(&self) -> &[ManyEvent] {
        &self.events
    }

    /// The event that has not.
    pub fn under_way(&self) -> Option<UnderWay> {
        self.open.as_ref().map(|open| UnderWay {
            since: open.from.map(|from| from.time.hi()),
            participants: open.participants.len(),
        })
    }

    /// The events, and what each interface has done in them, where that is asked for.
    pub fn into_parts(self) -> (Vec<ManyEvent>, Option<Vec<Participation>>) {
        (self.events, self.participation)
    }

    /// Looks at the next step.
    ///
    /// # Panics
    /// Where the step is one of more interfaces.
    pub fn see(&mut self, step: &StepSeries<'_>) {
        let (rows, layout) = step.rows();
        let length = step.length();
        let blocks = rows.len() / layout.rows();
        assert!(blocks <= self.watched.len(), "steps of one flow");
        let (threshold, begins) = (self.threshold, !self.begun);
        self.begun = true;
        let look = |(at, (rows, watched)): (usize, (&[Lanes], &mut [Watched]))| {
            Bound {
                rows,
                watched,
                layout,
                length,
                threshold,
            }
            .vectorised();
            let mut of = Looking {
                length,
                unit: step.unit(),
                threshold,
                zeros: Zeros::default(),
                found: Found::default(),
            };
            let blocks = rows.chunks_exact(layout.rows());
            for (i, (rows, watched)) in blocks.zip(watched).enumerate() {
                let rates = layout.rate(rows);
                if begins {
                    watched.begin(rates, threshold);
                }
                if watched.above | watched.maybe != 0 {
                    of.look(rates, watched, (at * CHUNK + i) * LANES);
                }
            }
            of.found
        };
        let size = CHUNK * layout.rows();
        let found: Vec<Found> = if blocks * LANES >= MANY {
            let watched = self.watched.par_chunks_mut(CHUNK);
            let chunks = rows.par_chunks(size).zip(watched);
            chunks.enumerate().map(look).collect()
        } else {
            let watched = self.watched.chunks_mut(CHUNK);
            let chunks = rows.chunks(size).zip(watched);
            chunks.enumerate().map(look).collect()
        };
        let throughout = found.iter().any(|found| found.throughout);
        let mut stretches: Vec<Stretch> = found
            .into_iter()
            .flat_map(|found| found.stretches)
            .collect();
        stretches.sort_by(|a, b| a.from.total_cmp(&b.from).then(a.rises.cmp(&b.rises)));
        self.join(step, &stretches, throughout);
    }

    /// Makes events of the stretches of a step, in the order of their beginnings.
    fn join(&mut self, step: &StepSeries<'_>, stretches: &[Stretch], throughout: bool) {
        if stretches.is_empty() && self.open.is_none() {
            return;
        }
        let length = step.length();
        let turnings = turnings(step.total_rates(), length);
        // Until when the event under way lasts at least, in this step, and since when it does.
        let mut reached = if throughout { length } else { 0.0 };
        let mut since = 0.0;
        for stretch in stretches {
            if self.open.is_some() && stretch.from > reached {
                self.raise(step, &turnings, (since, reached));
                self.close(moment(step, reached));
            }
            let open = self.open.get_or_insert_with(|| {
                since = stretch.from;
                Open {
                    from: stretch.rises.then(|| moment(step, stretch.from)),
                    peak: 0.0,
                    participants: Vec::new(),
                }
            });
            let (watched, lane) = (
                &mut self.watched[stretch.interface / LANES],
                stretch.interface % LANES,
            );
            if watched.taken & bit(lane) == 0 {
                watched.taken |= bit(lane);
                watched.slip[lane] = 0.0;
                open.participants.push(stretch.interface);
            }
            watched.slip[lane] += stretch.slip;
            reached = reached.max(stretch.to);
        }
        self.raise(step, &turnings, (since, reached));
        if !throughout && stretches.iter().all(|stretch| stretch.falls) {
            self.close(moment(step, reached));
        }
    }

    /// The total slip rate between two times of the event under way.
    fn raise(&mut self, step: &StepSeries<'_>, turnings: &[f64], (from, to): (f64, f64)) {
        let inside = turnings.iter().copied().filter(|s| (from..=to).contains(s));
        let rates = inside.chain([from, to]);
        let most = rates.map(|s| evaluate(step.total_rates(), s));
        if let Some(open) = &mut self.open {
            open.peak = most.fold(open.peak, f64::max);
        }
    }

    /// No interface slips any more.
    fn close(&mut self, end: Moment) {
        let Some(Open {
            from,
            peak,
            participants,
        }) = self.open.take()
        else {
            return;
        };
        let (mut slip, mut most, mut leader) = (0.0, f64::NEG_INFINITY, 0);
        for &interface in &participants {
            let watched = &mut self.watched[interface / LANES];
            watched.taken &= !bit(interface % LANES);
            let own = watched.slip[interface % LANES];
            slip += own;
            if own > most || own == most && interface < leader {
                (most, leader) = (own, interface);
            }
            if let (Some(_), Some(all)) = (from, &mut self.participation) {
                all[interface].events += 1;
                all[interface].slip += own;
            }
        }
        let Some(from) = from else { return };
        let last_onset = self.last_onset.replace(from.time);
        self.events.push(ManyEvent {
            onset: from.time.hi(),
            recurrence: last_onset.map(|last| (from.time - last).hi()),
            duration: (end.time - from.time).hi(),
            stress_before: from.stress,
            stress_drop: from.stress - end.stress,
            peak_slip_rate: peak,
            participants: participants.len(),
            slip,
            leader,
            first: participants[0],
        });
    }
}

impl Watched {
    /// Which slip where a flow begins.
    fn begin(&mut self, rates: &[Lanes], threshold: f64) {
        for (lane, (&rate, &slope)) in rates[0].iter().zip(&rates[1]).enumerate() {
            if rate > threshold || rate == threshold && slope > 0.0 {
                self.above |= bit(lane);
            }
        }
    }
}

/// Looks for stretches in one step.
struct Looking {
    /// Of the step, in its unit.
    length: f64,
    unit: f64,
    threshold: f64,
    zeros: Zeros,
    found: Found,
}

impl Looking {
    /// Those of the interfaces of a block, the first of which has this number.
    fn look(&mut self, rates: &[Lanes], watched: &mut Watched, first: usize) {
        for lane in 0..LANES {
            let of = |mask: u8| mask & bit(lane) != 0;
            if of(watched.above & watched.taken & watched.surely) {
                let series = series(rates, lane);
                watched.slip[lane] += self.unit * integral(&series[..rates.len()], self.length);
                self.found.throughout = true;
            } else if of(watched.above | watched.maybe) {
                let above = self.follow(rates, (lane, of(watched.above)), first + lane);
                watched.above = watched.above & !bit(lane) | if above { bit(lane) } else { 0 };
            }
        }
    }

    /// Goes along one interface, and tells whether it slips at the end.
    fn follow(&mut self, of: &[Lanes], (lane, above): (usize, bool), interface: usize) -> bool {
        let series = series(of, lane);
        let (rates, length, unit) = (&series[..of.len()], self.length, self.unit);
        let mut excess = series;
        excess[0] -= self.threshold;
        let mut zeros = std::mem::take(&mut self.zeros);
        zeros.sign = if above { 1.0 } else { -1.0 };
        let mut since = above.then_some((0.0, false));
        let mut end = |(from, rises): (f64, bool), to: f64, falls: bool| {
            let slip = unit * (integral(rates, to) - integral(rates, from));
            self.found.stretches.push(Stretch {
                interface,
                from,
                to,
                slip,
                rises,
                falls,
            });
        };
        for root in zeros.follow(&excess[..rates.len()], length) {
            match root.crossing {
                Crossing::Upwards => since = Some((root.at, true)),
                Crossing::Downwards => {
                    if let Some(since) = since.take() {
                        end(since, root.at, true);
                    }
                }
                Crossing::Touching => {}
            }
        }
        if let Some(since) = since {
            end(since, length, false);
        }
        self.zeros = zeros;
        since.is_some()
    }
}

/// Which interfaces are above the threshold all the time, and which may be at some, by the first term and the sum of the absolute values
/// of all others.
struct Bound<'a> {
    rows: &'a [Lanes],
    watched: &'a mut [Watched],
    layout: Layout,
    length: f64,
    threshold: f64,
}

impl Vectorised for Bound<'_> {}

impl NullaryFnOnce for Bound<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let blocks = self.rows.chunks_exact(self.layout.rows());
        for (rows, watched) in blocks.zip(self.watched) {
            let rates = self.layout.rate(rows);
            let mut change = [0.0; LANES];
            for term in rates[1..].iter().rev() {
                for l in 0..LANES {
                    change[l] = (change[l] + term[l].abs()) * self.length;
                }
            }
            (watched.surely, watched.maybe) = (0, 0);
            for (l, (rate, change)) in rates[0].iter().zip(change).enumerate() {
                watched.surely |= u8::from(rate - change > self.threshold) << l;
                watched.maybe |= u8::from(rate + change >= self.threshold) << l;
            }
        }
    }
}

fn bit(lane: usize) -> u8 {
    1 << lane
}

/// The rates of an interface.
fn series(rates: &[Lanes], lane: usize) -> [f64; MOST] {
    let mut series = [0.0; MOST];
    for (term, rates) in series.iter_mut().zip(rates) {
        *term = rates[lane];
    }
    series
}

fn moment(step: &StepSeries<'_>, at: f64) -> Moment {
    let (time, stress) = step.moment(at);
    Moment { time, stress }
}

/// The integral of a polynomial from 0 on.
fn integral(coefficients: &[f64], to: f64) -> f64 {
    let terms = coefficients.iter().enumerate().rev();
    to * terms.fold(0.0, |sum, (k, term)| sum * to + term / (k + 1) as f64)
}

/// Where a polynomial is largest or smallest.
fn turnings(coefficients: &[f64], length: f64) -> Vec<f64> {
    let terms = coefficients.iter().enumerate().skip(1);
    let slope: Vec<f64> = terms.map(|(k, c)| k as f64 * c).collect();
    let mut found = Vec::new();
    roots(&slope, length, &mut found);
    found.into_iter().map(|root| root.at).collect()
}
