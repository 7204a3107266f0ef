//! Slip events so far as numbers, from which a flow that was interrupted goes on.

use super::{ManyEvent, Moment, Open, Participation, SlipEvents, bit};
use crate::error::{Error, Result};
use crate::many::constants::LANES;
use crate::many::interfaces::ManyInterfaces;
use crate::number::DoubleDouble;

/// Numbers one after the other.
struct Reader<'a>(std::slice::Iter<'a, f64>);

impl Reader<'_> {
    fn next(&mut self) -> Result<f64> {
        let damaged = || Error::Input("what was saved of slip events is of another run".into());
        self.0.next().copied().ok_or_else(damaged)
    }

    fn count(&mut self) -> Result<usize> {
        Ok(self.next()? as usize)
    }

    fn time(&mut self) -> Result<DoubleDouble> {
        Ok(DoubleDouble::new(self.next()?, self.next()?))
    }

    fn option<T>(&mut self, read: impl FnOnce(&mut Self) -> Result<T>) -> Result<Option<T>> {
        match self.next()? {
            0.0 => Ok(None),
            _ => read(self).map(Some),
        }
    }

    fn list<T>(&mut self, read: impl Fn(&mut Self) -> Result<T>) -> Result<Vec<T>> {
        (0..self.count()?).map(|_| read(self)).collect()
    }
}

/// 1 and the numbers, or 0.
fn option(numbers: &mut Vec<f64>, some: Option<&[f64]>) {
    numbers.push(f64::from(u8::from(some.is_some())));
    numbers.extend(some.into_iter().flatten());
}

fn pair(time: DoubleDouble) -> [f64; 2] {
    [time.hi(), time.lo()]
}

impl SlipEvents {
    /// All that is known so far; whole numbers as they are.
    pub fn saved(&self) -> Vec<f64> {
        let mut numbers = vec![f64::from(u8::from(self.begun))];
        option(
            &mut numbers,
            self.last_onset.map(pair).as_ref().map(|of| &of[..]),
        );
        let events = self.events.iter().flat_map(numbers_of);
        numbers.push(self.events.len() as f64);
        numbers.extend(events);
        let all = self.participation.iter().flatten();
        numbers.push(self.participation.as_ref().map_or(0, Vec::len) as f64);
        numbers.extend(all.flat_map(|did| [did.events as f64, did.slip]));
        numbers.extend(self.watched.iter().map(|watched| f64::from(watched.above)));
        let Some(open) = &self.open else {
            numbers.push(0.0);
            return numbers;
        };
        numbers.push(1.0);
        let from = open
            .from
            .map(|from| [from.time.hi(), from.time.lo(), from.stress]);
        option(&mut numbers, from.as_ref().map(|of| &of[..]));
        numbers.extend([open.peak, open.participants.len() as f64]);
        for &interface in &open.participants {
            let slip = self.watched[interface / LANES].slip[interface % LANES];
            numbers.extend([interface as f64, slip]);
        }
        numbers
    }

    /// The same events as were saved, of a flow of the same interfaces with the same threshold.
    ///
    /// # Errors
    /// [`Error::Input`] for numbers of another flow, and as [`SlipEvents::new`].
    pub fn restored(
        interfaces: &ManyInterfaces,
        threshold: f64,
        numbers: &[f64],
    ) -> Result<SlipEvents> {
        let mut events = SlipEvents::new(interfaces, threshold)?;
        let mut reader = Reader(numbers.iter());
        events.begun = reader.next()? != 0.0;
        events.last_onset = reader.option(Reader::time)?;
        events.events = reader.list(event)?;
        let all = reader.list(|reader| {
            Ok(Participation {
                events: reader.count()?,
                slip: reader.next()?,
            })
        })?;
        events.participation = (!all.is_empty()).then_some(all);
        for watched in &mut events.watched {
            watched.above = reader.next()? as u8;
        }
        let open = reader.option(|reader| {
            let from = reader.option(|reader| {
                Ok(Moment {
                    time: reader.time()?,
                    stress: reader.next()?,
                })
            })?;
            let peak = reader.next()?;
            let participants = reader.list(|reader| Ok((reader.count()?, reader.next()?)))?;
            Ok((from, peak, participants))
        })?;
        if let Some((from, peak, participants)) = open {
            for &(interface, slip) in &participants {
                let watched = events.watched.get_mut(interface / LANES);
                let watched = watched.ok_or_else(|| {
                    Error::Input("what was saved of slip events is of another run".into())
                })?;
                watched.taken |= bit(interface % LANES);
                watched.slip[interface % LANES] = slip;
            }
            events.open = Some(Open {
                from,
                peak,
                participants: participants.into_iter().map(|(one, _)| one).collect(),
            });
        }
        Ok(events)
    }
}

fn numbers_of(event: &ManyEvent) -> [f64; 10] {
    [
        event.onset,
        // no time is as short as that
        event.recurrence.unwrap_or(-1.0),
        event.duration,
        event.stress_before,
        event.stress_drop,
        event.peak_slip_rate,
        event.participants as f64,
        event.slip,
        event.leader as f64,
        event.first as f64,
    ]
}

fn event(reader: &mut Reader<'_>) -> Result<ManyEvent> {
    let made = ManyEvent {
        onset: reader.next()?,
        recurrence: Some(reader.next()?).filter(|time| *time >= 0.0),
        duration: reader.next()?,
        stress_before: reader.next()?,
        stress_drop: reader.next()?,
        peak_slip_rate: reader.next()?,
        participants: reader.count()?,
        slip: reader.next()?,
        leader: reader.count()?,
        first: reader.count()?,
    };
    Ok(made)
}
