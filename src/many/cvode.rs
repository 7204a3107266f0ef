//! CVODE's BDF for all interfaces at once, with the arrow matrix.

use super::constants::LANES;
use super::field::{Arrow, ManyField, Slips};
use super::interfaces::ManyInterfaces;
use super::state::{Dense, DenseStep, ManyState, Scales};
use super::step::{Beginning, ManyObserver, until_save};
use crate::error::{Error, Result};
use crate::friction::positive;
use crate::integrate::Work;
use crate::sundials::{LargeCvode, LinearTime};

/// CVODE's BDF with its tolerance, which holds for the largest error of all: the root of the mean square would let one that slips hide
/// among a million that stick.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ManyCvode {
    tolerance: f64,
    max_steps: usize,
}

impl ManyCvode {
    /// # Errors
    /// [`Error::Parameter`] for a tolerance or a bound on steps that is not positive.
    pub fn new(tolerance: f64, max_steps: usize) -> Result<Self> {
        positive("rtol", tolerance)?;
        if max_steps == 0 {
            return Err(Error::parameter("max-steps", 0, "at least 1"));
        }
        Ok(ManyCvode {
            tolerance: tolerance.max(f64::EPSILON),
            max_steps,
        })
    }

    /// Bytes that a run takes, without rows.
    pub fn memory(&self, interfaces: &ManyInterfaces) -> usize {
        // six of Nordsieck's array, weights and seven more of CVODE's, the state twice, the matrix, and the start
        const VECTORS: usize = 6 + 8 + 2 + 4 + 1;
        let held = interfaces.blocks() * LANES * size_of::<f64>();
        VECTORS * held + interfaces.constants_memory()
    }

    /// From a beginning on until a time, or until the observer says `false`; it sees every step, with the slips that are asked for.
    ///
    /// # Errors
    /// As [`super::ManyRosenbrock::run`], and [`Error::Sundials`].
    pub fn run<'a>(
        &self,
        interfaces: &'a ManyInterfaces,
        beginning: Beginning<'_>,
        until: f64,
        slips: &Slips,
        observer: &mut dyn ManyObserver,
    ) -> Result<ManyState<'a>> {
        let field = ManyField::new(interfaces, slips);
        let (mut time, mut steps, mut y) = field.begun(beginning)?;
        let mut work = Work::default();
        let mut goes_on = true;
        while goes_on && time < until {
            let mut cvode = self.begun(ManyField::new(interfaces, slips), y, (time, until))?;
            let left = until_save(observer, steps);
            let mut slipped = cvode.state()[field.logs()..].to_vec();
            let mut done = 0;
            while goes_on && done < left && time < until {
                if steps + done >= self.max_steps {
                    return Err(Error::TooManySteps {
                        t: time,
                        end: until,
                        limit: self.max_steps,
                    });
                }
                let end = cvode.step()?;
                done += 1;
                if end == time {
                    continue;
                }
                goes_on = observer.step(&DenseStep::new(&cvode, (time, end), &slipped))?;
                slipped.copy_from_slice(&cvode.state()[field.logs()..]);
                time = end;
            }
            steps += done;
            work += cvode.work()?;
            y = cvode.state().to_vec();
            if done == left {
                field.forget_slips(&mut y);
                observer.save(field.saved(time, steps, &y))?;
            }
        }
        Ok(ManyState::new(field, y, time, work))
    }

    fn begun<'a>(
        &self,
        field: ManyField<'a>,
        y: Vec<f64>,
        (time, until): (f64, f64),
    ) -> Result<LargeCvode<Scaled<'a>>> {
        let mut arrow = Arrow::default();
        field.linearise(&y, &mut arrow);
        let fastest = field.largest(&arrow);
        if !fastest.is_finite() {
            let what = "the Jacobian";
            return Err(Error::NonFinite { what, t: time });
        }
        // CVODE's own first step is never below a hundred spacings of the end, in which a fast start is over.
        let first = (self.tolerance.sqrt() / fastest).min(until - time);
        let scales = Scales::new(&field, self.tolerance, until);
        LargeCvode::new(Scaled { field, scales }, y, (time, until), first)
    }
}

/// A field with what its errors count.
struct Scaled<'a> {
    field: ManyField<'a>,
    scales: Scales,
}

impl LinearTime for Scaled<'_> {
    type Matrix = Arrow;

    fn rates(&self, y: &[f64], rates: &mut [f64]) {
        self.field.rates(y, rates);
    }

    fn linearise(&self, y: &[f64], arrow: &mut Arrow) {
        self.field.linearise(y, arrow);
    }

    fn factorise(&self, diagonal: f64, arrow: &mut Arrow) -> bool {
        self.field.factorise(diagonal, arrow)
    }

    fn solve(&self, arrow: &Arrow, b: &mut [f64]) {
        self.field.solve(arrow, b);
    }

    fn weights(&self, y: &[f64], weights: &mut [f64]) {
        let (logs, rest) = weights.split_at_mut(self.field.logs());
        logs.fill(1.0 / self.scales.of_logs());
        for (i, weight) in rest.iter_mut().enumerate() {
            let place = logs.len() + i;
            *weight = 1.0 / self.scales.of(&self.field, place, y[place]);
        }
    }

    fn largest(&self, own: f64) -> f64 {
        let [largest] = self.field.interfaces.share.largest([own]);
        largest
    }
}

impl Dense for &LargeCvode<Scaled<'_>> {
    fn field(&self) -> &ManyField<'_> {
        &self.system().field
    }

    fn stands(&self, time: f64) -> Option<&[f64]> {
        (time == self.time()).then(|| self.state())
    }

    fn make(&self, time: f64, state: &mut [f64]) {
        let within = self.dense(time, state);
        within.expect("a time of the step");
    }
}
