//! The catalogue of slip events of a run: what is asked for, and what is found.

use super::draw::Drawn;
use crate::scene::options::IntegrateOptions;
use twinslip::error::{Error, Result};
use twinslip::many::{ManyEvent, ManyInterfaces, Participation, SlipEvents, UnderWay};

/// How much faster than V_H/N an interface is that slips.
const THRESHOLD: f64 = 10.0;

/// What is asked for of slip events.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CataloguePlan {
    /// An interface slips while it is faster than so many times V_H/N.
    pub threshold: f64,
    /// That rate.
    pub rate: f64,
    /// Whether it is asked for what each interface does.
    pub participation: bool,
}

impl CataloguePlan {
    /// Of a run with this V_H/N; `None` where events are not asked for.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a threshold below 1.
    pub fn new(options: &IntegrateOptions, mean: f64) -> Result<Option<Self>> {
        if options.events.is_none() {
            return Ok(None);
        }
        let threshold = options.event_threshold.unwrap_or(THRESHOLD);
        if threshold < 1.0 {
            // The mean is not below V_H/N for long: nearly always one is faster than less than that.
            return Err(Error::parameter("event-threshold", threshold, "at least 1"));
        }
        Ok(Some(CataloguePlan {
            threshold,
            rate: threshold * mean,
            participation: options.participation.is_some(),
        }))
    }

    /// What finds them.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a rate that is no double.
    pub fn events(&self, interfaces: &ManyInterfaces) -> Result<SlipEvents> {
        let events = SlipEvents::new(interfaces, self.rate)?;
        Ok(match self.participation {
            true => events.with_participation(interfaces),
            false => events,
        })
    }
}

/// The slip events of a run.
#[derive(Debug, Clone, PartialEq)]
pub struct Catalogue {
    /// Those that began and ended in it.
    pub events: Vec<ManyEvent>,
    /// One that the run ends in.
    pub under_way: Option<UnderWay>,
    /// What each interface did in them, where that is asked for.
    pub participation: Option<Vec<Participation>>,
}

impl From<SlipEvents> for Catalogue {
    fn from(found: SlipEvents) -> Self {
        let under_way = found.under_way();
        let (events, participation) = found.into_parts();
        Catalogue {
            events,
            under_way,
            participation,
        }
    }
}

/// An interface in the events of a run.
#[derive(Debug, Clone, PartialEq)]
pub struct Participant {
    /// Its number, from 1.
    pub interface: usize,
    /// What it did.
    pub did: Participation,
    /// Its constants that are drawn, in the order in which they were asked for.
    pub drawn: Vec<f64>,
}

impl Catalogue {
    /// All interfaces, with their constants; `None` where they are not asked for.
    pub fn participants(&self, drawn: &[Drawn]) -> Option<Vec<Participant>> {
        let all = self.participation.as_ref()?.iter().enumerate();
        let one = |(i, &did)| Participant {
            interface: i + 1,
            did,
            drawn: drawn.iter().map(|drawn| drawn.values[i]).collect(),
        };
        Some(all.map(one).collect())
    }
}
