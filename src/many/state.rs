//! The state of all interfaces as the methods of rates and matrices carry it, and what an error of it counts.

use super::block::{Extent, larger};
use super::field::ManyField;
use super::step::ManyStep;
use crate::integrate::Work;
use std::cell::RefCell;

/// Where a run by rates and matrices ended.
#[derive(Debug)]
pub struct ManyState<'a> {
    field: ManyField<'a>,
    y: Vec<f64>,
    time: f64,
    work: Work,
}

impl<'a> ManyState<'a> {
    pub(crate) fn new(field: ManyField<'a>, y: Vec<f64>, time: f64, work: Work) -> Self {
        ManyState {
            field,
            y,
            time,
            work,
        }
    }

    /// The time reached.
    pub fn time(&self) -> f64 {
        self.time
    }

    /// tau there.
    pub fn stress(&self) -> f64 {
        self.y[self.field.stress()]
    }

    /// psi there of an interface that is held here.
    ///
    /// # Panics
    /// Where it is not.
    pub fn state(&self, interface: usize) -> f64 {
        let [psi, _] = self.field.interface(&self.y, interface);
        psi
    }

    /// What it cost.
    pub fn work(&self) -> Work {
        self.work
    }
}

/// What an error counts: that of ln psi itself, that of tau over 1 + |tau|, that of a slip over itself and the mean slip of the whole run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Scales {
    tolerance: f64,
    mean_slip: f64,
}

impl Scales {
    /// Of a run until a time.
    pub fn new(field: &ManyField<'_>, tolerance: f64, until: f64) -> Self {
        let interfaces = field.interfaces;
        Scales {
            tolerance,
            mean_slip: interfaces.loading.driving / interfaces.count() as f64 * until,
        }
    }

    /// What an error of 1 is of a number of the state behind the ln psi.
    pub fn of(&self, field: &ManyField<'_>, place: usize, y: f64) -> f64 {
        let size = if place == field.stress() {
            1.0
        } else {
            self.mean_slip
        };
        self.tolerance * (size + y.abs())
    }

    /// What an error of 1 is of ln psi.
    pub fn of_logs(&self) -> f64 {
        self.tolerance
    }

    /// The largest error in what is allowed; `None` if something is not finite.
    pub fn norm(
        &self,
        field: &ManyField<'_>,
        error: &[f64],
        (y0, y1): (&[f64], &[f64]),
    ) -> Option<f64> {
        let logs = field.logs();
        let both = error[..logs].iter().zip(&y1[..logs]);
        // What is not finite in y1 is to be seen.
        let of_logs = both.fold(0.0, |most, (error, y)| larger(most, error.abs() + 0.0 * y));
        let rest = (logs..error.len()).map(|i| {
            let scale = self.of(field, i, y0[i].abs().max(y1[i].abs()));
            error[i].abs() / scale + 0.0 * y1[i]
        });
        let own = rest.fold(of_logs / self.of_logs(), larger);
        let [norm] = field.interfaces.share.largest([own]);
        norm.is_finite().then_some(norm)
    }

    /// Whether all numbers are finite, in all processes.
    pub fn are_finite(&self, field: &ManyField<'_>, y: &[f64]) -> bool {
        let own = y.iter().fold(0.0, |sum, x| larger(sum, 0.0 * x));
        let [all] = field.interfaces.share.largest([own]);
        all == 0.0
    }
}

/// A step of which the state is known at its end, and can be made at any time of it.
pub(super) trait Dense {
    /// Whose state it is.
    fn field(&self) -> &ManyField<'_>;

    /// The state at a time, where it stands somewhere.
    fn stands(&self, time: f64) -> Option<&[f64]>;

    /// Makes the state at any other time of the step.
    fn make(&self, time: f64, state: &mut [f64]);
}

/// A step by its states.
pub(super) struct DenseStep<'a, D> {
    pub dense: D,
    pub begin: f64,
    pub end: f64,
    /// What is behind the ln psi at the beginning.
    pub slipped: &'a [f64],
    /// The state at the time last asked for.
    pub at: RefCell<(f64, Vec<f64>)>,
}

impl<'a, D: Dense> DenseStep<'a, D> {
    pub fn new(dense: D, (begin, end): (f64, f64), slipped: &'a [f64]) -> Self {
        DenseStep {
            dense,
            begin,
            end,
            slipped,
            at: RefCell::new((f64::NAN, Vec::new())),
        }
    }

    /// Looks at the state at a time of the step.
    fn with<R>(&self, time: f64, look: impl FnOnce(&ManyField<'_>, &[f64]) -> R) -> R {
        let field = self.dense.field();
        if let Some(state) = self.dense.stands(time) {
            return look(field, state);
        }
        let mut at = self.at.borrow_mut();
        if at.0 != time {
            at.0 = time;
            at.1.resize(field.len(), 0.0);
            self.dense.make(time, &mut at.1);
        }
        look(field, &at.1)
    }

    /// By how much a number of the state changes from the beginning of the step.
    fn change(&self, time: f64, place: usize) -> f64 {
        let logs = self.dense.field().logs();
        self.with(time, |_, y| y[place]) - self.slipped[place - logs]
    }
}

impl<D: Dense> ManyStep for DenseStep<'_, D> {
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
        let place = self.dense.field().slip(interface);
        self.change(time, place.expect("a slip that is asked for"))
    }

    fn slip_of_all(&self, time: f64) -> f64 {
        self.change(time, self.dense.field().slip_of_all())
    }
}
