//! Handing on what is found, with a word where a special point is less accurate than was asked for.

use crate::bifurcation::{BranchRow, Event, EventObserver, LocusRow, Special};
use crate::equilibrium::Symmetry;
use std::ops::ControlFlow;

/// Tells the observer.
pub(super) struct Teller<'a> {
    seen: EventObserver<'a>,
    /// Asked for, relative.
    tolerance: f64,
    /// Numbers of the branches or curves of which nothing is to be told.
    skip: &'a [usize],
    /// The branch or curve that is told of.
    number: usize,
    symmetry: Symmetry,
}

impl<'a> Teller<'a> {
    pub fn new(seen: EventObserver<'a>, tolerance: f64, skip: &'a [usize]) -> Self {
        Teller {
            seen,
            tolerance,
            skip,
            number: 0,
            symmetry: Symmetry::Symmetric,
        }
    }

    /// What follows is of the branch or curve of that number.
    pub fn on(&mut self, number: usize, symmetry: Symmetry) {
        (self.number, self.symmetry) = (number, symmetry);
    }

    pub fn branch(&mut self, row: BranchRow) -> ControlFlow<()> {
        self.on(row.branch, row.symmetry);
        self.tell(Event::Branch(row))
    }

    pub fn locus(&mut self, row: LocusRow) -> ControlFlow<()> {
        self.on(row.curve, row.symmetry);
        self.tell(Event::Locus(row))
    }

    /// After the row that it is the special point of, or after [`Teller::on`].
    pub fn special(&mut self, special: Special) -> ControlFlow<()> {
        let event = Event::Special(special).on(self.number, self.symmetry);
        self.tell(event.against(self.tolerance))
    }

    fn tell(&mut self, event: Event) -> ControlFlow<()> {
        if self.skip.contains(&self.number) {
            return ControlFlow::Continue(());
        }
        (self.seen)(event)
    }
}
