//! The rows of a return map: a return, and the slip rate at the next.

use super::super::column::Column;
use super::super::run::Sink;
use super::super::units::Quantity;
use super::SectionPlan;
use twinslip::friction::{Formulas, ScaledLaw};
use twinslip::integrate::Control;
use twinslip::section::Return;

/// A return to the section, dimensionless. With one interface both entries of a pair are the same.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SectionRow {
    /// Its number after the returns let pass, from 0.
    pub number: usize,
    /// When it is.
    pub time: f64,
    /// ln psi of each interface.
    pub log_state: [f64; 2],
    /// The slip rate of each interface.
    pub slip_rate: [f64; 2],
    /// The slip rate of the interfaces together.
    pub slip_rate_sum: f64,
    /// The same at the return that follows.
    pub next_slip_rate_sum: f64,
}

/// The columns of a return map of one or two interfaces.
pub fn section_columns(interfaces: usize) -> Vec<Column<SectionRow>> {
    use Quantity::{LogState, Number, SlipRate, Time};
    let mut columns = vec![
        Column::new("n", Number, |row: &SectionRow| row.number.into()),
        Column::new("time", Time, |row: &SectionRow| row.time.into()),
    ];
    columns.extend((0..interfaces).map(|i| {
        Column::new(
            format!("log_state_{}", i + 1),
            LogState,
            move |row: &SectionRow| row.log_state[i].into(),
        )
    }));
    columns.extend((0..interfaces).map(|i| {
        Column::new(
            format!("slip_rate_{}", i + 1),
            SlipRate,
            move |row: &SectionRow| row.slip_rate[i].into(),
        )
    }));
    columns.extend([
        Column::new("slip_rate_sum", SlipRate, |row: &SectionRow| {
            row.slip_rate_sum.into()
        }),
        Column::new("next_slip_rate_sum", SlipRate, |row: &SectionRow| {
            Some(row.next_slip_rate_sum)
                .filter(|x| x.is_finite())
                .into()
        }),
    ]);
    columns
}

/// Makes a row of each return and the next.
pub(super) struct RowMaker<'a> {
    plan: &'a SectionPlan,
    laws: [ScaledLaw; 2],
    columns: Vec<Column<SectionRow>>,
    /// The last return, whose next is not known yet.
    open: Option<SectionRow>,
    made: usize,
}

impl<'a> RowMaker<'a> {
    pub fn new(plan: &'a SectionPlan) -> Self {
        RowMaker {
            plan,
            laws: plan.system.laws(),
            columns: section_columns(plan.system.interfaces),
            open: None,
            made: 0,
        }
    }

    /// The run does not return again: if the last row that was asked for is open, it is complete without a next return.
    pub fn end(&mut self, sink: &mut dyn Sink) {
        if let Some(row) = self.open.take().filter(|_| self.made < self.plan.returns) {
            let _ = self.tell(&row, sink);
        }
    }

    fn tell(&mut self, row: &SectionRow, sink: &mut dyn Sink) -> Control {
        self.made += 1;
        let units = &self.plan.system.units;
        let numbers = self.columns.iter().map(|column| column.number(row, units));
        sink.row(&numbers.collect::<Vec<f64>>())
    }

    /// The row of the return before is complete with this one.
    pub fn next(&mut self, at: &Return, sink: &mut dyn Sink) -> Control {
        let (laws, y) = (&self.laws, &at.state);
        let log_state = [y[1], y[y.len() - 1]];
        let slip_rate = [0, 1].map(|i| {
            let law = &laws[i];
            law.slip_rate(law.activation(y[0]), log_state[i].exp())
        });
        let sum = slip_rate[..self.plan.system.interfaces].iter().sum();
        let told = self.open.take().map(|mut row| {
            row.next_slip_rate_sum = sum;
            self.tell(&row, sink)
        });
        self.open = Some(SectionRow {
            number: self.made,
            time: at.time,
            log_state,
            slip_rate,
            slip_rate_sum: sum,
            next_slip_rate_sum: f64::NAN,
        });
        told.unwrap_or(Control::Continue)
    }
}
