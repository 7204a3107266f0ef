//! Handing on what is found, with a word where a special point is less accurate than was asked for.

use crate::bifurcation::{BranchRow, Event, LocusRow, Seen, Special};
use std::ops::ControlFlow;

/// Tells the observer.
pub(super) struct Teller<'a> {
    seen: Seen<'a>,
    /// Asked for, relative.
    tolerance: f64,
    /// Numbers of the branches or curves of which nothing is to be told, and whether the last row was of one of them.
    skip: &'a [usize],
    skipping: bool,
}

impl<'a> Teller<'a> {
    pub fn new(seen: Seen<'a>, tolerance: f64, skip: &'a [usize]) -> Self {
        Teller {
            seen,
            tolerance,
            skip,
            skipping: false,
        }
    }

    pub fn branch(&mut self, row: BranchRow) -> ControlFlow<()> {
        self.row(row.branch, Event::Branch(row))
    }

    pub fn locus(&mut self, row: LocusRow) -> ControlFlow<()> {
        self.row(row.curve, Event::Locus(row))
    }

    fn row(&mut self, number: usize, row: Event) -> ControlFlow<()> {
        self.skipping = self.skip.contains(&number);
        if self.skipping {
            return ControlFlow::Continue(());
        }
        (self.seen)(row)
    }

    /// After the row that it is the special point of.
    pub fn special(&mut self, special: Special) -> ControlFlow<()> {
        if self.skipping {
            return ControlFlow::Continue(());
        }
        (self.seen)(Event::Special(special).against(self.tolerance))
    }
}
