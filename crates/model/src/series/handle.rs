//! What a formula computes with when it is evaluated on series.

use super::element::Element;
use super::tape::{Order, Row, Tape};
use crate::number::DoubleDouble;
use std::fmt;

/// A series, at the order of its tape.
///
/// A record and no enumeration: with a place of its own for every field the compiler sees through it.
pub struct Series<'t, E, O> {
    tape: Option<&'t Tape<'t, E, O>>,
    row: usize,
    newest: Option<E>,
    factor: Option<E>,
    value: Option<E>,
    exact: DoubleDouble,
    literal: bool,
}

/// What a series is.
pub(super) enum SeriesKind<'t, E, O> {
    /// A constant in the program's text: what it is the compiler knows.
    Literal(f64),
    /// A constant of 31 digits.
    Exact(DoubleDouble),
    /// A constant.
    Value(E),
    /// A series on a tape.
    Row(Row<'t, E, O>),
}

use SeriesKind::{Exact, Value};

impl<E, O> SeriesKind<'_, E, O> {
    /// The same, and no literal any more.
    #[inline(always)]
    pub(super) fn released(self) -> Self {
        match self {
            SeriesKind::Literal(x) => Exact(DoubleDouble::from(x)),
            other => other,
        }
    }
}

impl<E: Copy, O> Clone for Series<'_, E, O> {
    #[inline(always)]
    fn clone(&self) -> Self {
        *self
    }
}
impl<E: Copy, O> Copy for Series<'_, E, O> {}

impl<E: fmt::Debug, O> fmt::Debug for Series<'_, E, O> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "row {} or {:?} or {:?}",
            self.row, self.value, self.exact
        )
    }
}

#[inline(always)]
pub(super) fn exact<'t, E, O>(x: DoubleDouble) -> Series<'t, E, O> {
    Series {
        tape: None,
        row: 0,
        newest: None,
        factor: None,
        value: None,
        exact: x,
        literal: false,
    }
}
#[inline(always)]
pub(super) fn literal<'t, E, O>(x: f64) -> Series<'t, E, O> {
    Series {
        literal: true,
        ..exact(DoubleDouble::from(x))
    }
}
/// A constant, which may differ from lane to lane.
#[inline(always)]
pub fn value<'t, E, O>(x: E) -> Series<'t, E, O> {
    Series {
        value: Some(x),
        ..exact(DoubleDouble::ZERO)
    }
}
#[inline(always)]
pub(super) fn row<'t, E, O>(x: Row<'t, E, O>) -> Series<'t, E, O> {
    Series {
        tape: Some(x.tape),
        row: x.row,
        newest: x.newest,
        factor: x.factor,
        value: None,
        exact: DoubleDouble::ZERO,
        literal: false,
    }
}

impl<'t, E: Element, O: Order> Series<'t, E, O> {
    #[inline(always)]
    pub(super) fn kind(self) -> SeriesKind<'t, E, O> {
        if let Some(tape) = self.tape {
            SeriesKind::Row(Row {
                tape,
                row: self.row,
                newest: self.newest,
                factor: self.factor,
            })
        } else if let Some(x) = self.value {
            Value(x)
        } else if self.literal {
            SeriesKind::Literal(self.exact.hi())
        } else {
            Exact(self.exact)
        }
    }

    /// The coefficient at the order of the tape, times x.
    #[inline(always)]
    pub(super) fn times(self, x: E, order: O) -> E {
        let constant = |y: E| {
            if order.index() == 0 {
                y * x
            } else {
                y.like(0.0)
            }
        };
        let like = x;
        match self.kind() {
            Exact(y) => constant(like.like_exact(y)),
            Value(y) => constant(y),
            SeriesKind::Literal(y) => constant(like.like(y)),
            SeriesKind::Row(row) => row.times(x),
        }
    }

    /// The sum over the interfaces that are lanes of the coefficients.
    #[inline(always)]
    pub fn over_interfaces(self) -> Self {
        match self.kind() {
            SeriesKind::Row(a) => row(a.mapped(a.newest().over_interfaces())),
            _ => self,
        }
    }

    /// The row that it stands in, if it is no constant.
    #[inline(always)]
    pub(super) fn row(self) -> Option<usize> {
        match self.kind() {
            SeriesKind::Row(a) => Some(a.stored().row),
            _ => None,
        }
    }
}
