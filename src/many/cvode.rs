//! CVODE's BDF for all interfaces at once, with the arrow matrix.

use super::block::Extent;
use super::constants::LANES;
use super::field::{Arrow, ManyField, Slips};
use super::interfaces::ManyInterfaces;
use super::state::{ManyState, Scales};
use super::step::{Beginning, Looking, ManyObserver, ManyStep, until_save};
use crate::error::{Error, Result};
use crate::friction::positive;
use crate::integrate::Work;
use crate::sundials::{LargeCvode, LinearTime};
use std::cell::RefCell;

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

    /// From (tau, psi of every interface that is held here) at time 0 on, until a time, or until the observer says `false`; it sees every
    /// step, with the slips that are asked for.
    ///
    /// # Errors
    /// As [`super::ManyRosenbrock::flow`], and [`Error::Sundials`].
    pub fn flow<'a>(
        &self,
        interfaces: &'a ManyInterfaces,
        (stress, states): (f64, &[f64]),
        until: f64,
        slips: &Slips,
        observer: &mut dyn FnMut(&dyn ManyStep) -> Result<bool>,
    ) -> Result<ManyState<'a>> {
        let beginning = Beginning::Start(stress, states);
        self.run(interfaces, beginning, until, slips, &mut Looking(observer))
    }

    /// The same from any beginning on, with all that an observer may see.
    ///
    /// # Errors
    /// As [`ManyCvode::flow`].
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
                goes_on = observer.step(&CvodeStep {
                    cvode: &cvode,
                    begin: time,
                    end,
                    slipped: &slipped,
                    at: RefCell::new((f64::NAN, Vec::new())),
                })?;
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

/// A step with its continuous solution.
struct CvodeStep<'a, 'f> {
    cvode: &'a LargeCvode<Scaled<'f>>,
    begin: f64,
    end: f64,
    /// What is behind the ln psi at the beginning.
    slipped: &'a [f64],
    /// The state at the time last asked for.
    at: RefCell<(f64, Vec<f64>)>,
}

impl CvodeStep<'_, '_> {
    /// Looks at the state at a time of the step.
    fn with<R>(&self, time: f64, look: impl FnOnce(&ManyField<'_>, &[f64]) -> R) -> R {
        let field = &self.cvode.system().field;
        if time == self.end {
            return look(field, self.cvode.state());
        }
        let mut at = self.at.borrow_mut();
        if at.0 != time {
            at.0 = time;
            at.1.resize(field.len(), 0.0);
            let within = self.cvode.dense(time, &mut at.1);
            within.expect("a time of the step");
        }
        look(field, &at.1)
    }

    /// By how much a number of the state changes from the beginning of the step.
    fn change(&self, time: f64, place: usize) -> f64 {
        let logs = self.cvode.system().field.logs();
        self.with(time, |_, y| y[place]) - self.slipped[place - logs]
    }
}

impl ManyStep for CvodeStep<'_, '_> {
    fn begin(&self) -> f64 {
        self.begin
    }

    fn end(&self) -> f64 {
        self.end
    }

    fn stress(&self, time: f64) -> f64 {
        self.with(time, |field, y| y[field.stress()])
    }

    fn extent(&self, time: f64, faster_than: f64) -> Extent {
        self.with(time, |field, y| field.extent(y, faster_than))
    }

    fn interface(&self, interface: usize, time: f64) -> [f64; 2] {
        self.with(time, |field, y| field.interface(y, interface))
    }

    fn slip(&self, interface: usize, time: f64) -> f64 {
        let place = self.cvode.system().field.slip(interface);
        self.change(time, place.expect("a slip that is asked for"))
    }

    fn slip_of_all(&self, time: f64) -> f64 {
        self.change(time, self.cvode.system().field.slip_of_all())
    }
}
