//! The rows of a return map: a return, and the slip rate at the next.

use super::super::any_system::{AnySystem, SlipRate};
use super::super::column::Column;
use super::super::run::Sink;
use super::super::system::Described;
use super::super::units::Quantity;
use super::SectionPlan;
use twinslip::integrate::Control;

/// A return to the section, dimensionless.
#[derive(Debug, Clone, PartialEq)]
pub struct SectionRow {
    /// Its number after the returns let pass, from 0.
    pub number: usize,
    /// When it is.
    pub time: f64,
    /// The values of all states.
    pub state: Vec<f64>,
    /// The slip rate of each interface or cluster; none of what is no interface.
    pub slip_rate: Vec<f64>,
    /// The slip rate of all interfaces together.
    pub slip_rate_sum: f64,
    /// The same at the return that follows.
    pub next_slip_rate_sum: f64,
}

/// The columns of a return map.
pub fn section_columns(system: &AnySystem) -> Vec<Column<SectionRow>> {
    use Quantity::{Number, SlipRate, Stress, Time};
    type Row = SectionRow;
    let states = system.states();
    // A system may have a state of that name.
    let number = if states.iter().any(|name| name == "n") {
        "return"
    } else {
        "n"
    };
    let mut columns = vec![
        Column::new(number, Number, |row: &Row| row.number.into()).meaning("number of the return"),
        Column::new("time", Time, |row: &Row| row.time.into()).meaning("time"),
    ];
    let stress = usize::from(system.slides());
    for (i, name) in states.into_iter().enumerate().skip(stress) {
        let value = move |row: &Row| row.state[i].into();
        columns.push(
            Column::new(name, system.quantity(i), value)
                .meaning(meaning_of_state(system.quantity(i))),
        );
    }
    if !system.slides() {
        return columns;
    }
    for i in 0..system.clusters().len() {
        let rate = move |row: &Row| row.slip_rate[i].into();
        let rate = Column::new(format!("slip_rate_{}", i + 1), SlipRate, rate);
        columns.push(rate.meaning("slip rate of interface or cluster i"));
    }
    columns.extend([
        Column::new("slip_rate_sum", SlipRate, |row: &Row| {
            row.slip_rate_sum.into()
        })
        .meaning("sum of the slip rates"),
        Column::new("next_slip_rate_sum", SlipRate, |row: &Row| {
            Some(row.next_slip_rate_sum)
                .filter(|x| x.is_finite())
                .into()
        })
        .meaning("sum of the slip rates at the next return"),
        Column::new("stress", Stress, |row: &Row| row.state[0].into())
            .meaning("shear stress τ")
            .not_in_table(),
    ]);
    columns
}

/// What the columns of the states of interfaces mean.
fn meaning_of_state(quantity: Quantity) -> &'static str {
    match quantity {
        Quantity::LogSlipRate => "ln v of interface i",
        _ => "ln ψ of interface i",
    }
}

/// Makes a row of each return and the next.
pub(super) struct RowMaker<'a> {
    plan: &'a SectionPlan,
    slip_rate: SlipRate,
    columns: Vec<Column<SectionRow>>,
    /// The last return, whose next is not known yet.
    open: Option<SectionRow>,
    made: usize,
    /// Returns of this run, which may repeat those of a run before it.
    seen: usize,
}

impl<'a> RowMaker<'a> {
    pub fn new(plan: &'a SectionPlan) -> Self {
        RowMaker {
            plan,
            slip_rate: plan.system.slip_rate(),
            columns: section_columns(&plan.system),
            open: None,
            made: 0,
            seen: 0,
        }
    }

    /// The run begins again, in other units: the rows that are made stay.
    pub fn restart(&mut self) {
        self.seen = 0;
        self.open = None;
    }

    /// The run does not return again: the last row has no next return.
    pub fn end(&mut self, sink: &mut dyn Sink) {
        if let Some(row) = self.open.take().filter(|_| self.made < self.plan.returns) {
            let _ = self.emit(&row, sink);
        }
    }

    fn emit(&mut self, row: &SectionRow, sink: &mut dyn Sink) -> Control {
        self.made += 1;
        let units = self.plan.system.units();
        let numbers = self.columns.iter().map(|column| column.number(row, units));
        sink.row(&numbers.collect::<Vec<f64>>())
    }

    /// The row of the return before is complete with this one, at a time and values of the states of the plan's subspace.
    pub fn next(&mut self, time: f64, y: &[f64], sink: &mut dyn Sink) -> Control {
        self.seen += 1;
        if self.seen <= self.made {
            return Control::Continue;
        }
        let mut state = Vec::with_capacity(y.len() + 1);
        self.plan.subspace.whole(y, &mut state);
        let clusters = self.plan.system.clusters();
        let slip_rate = (0..clusters.len()).map(|i| (self.slip_rate)(i, &state, time));
        let slip_rate: Vec<f64> = slip_rate.collect();
        let each = clusters.iter().zip(&slip_rate);
        let sum = each.map(|(&count, v)| count as f64 * v).sum();
        let told = self.open.take().map(|mut row| {
            row.next_slip_rate_sum = sum;
            self.emit(&row, sink)
        });
        self.open = Some(SectionRow {
            number: self.made,
            time,
            state,
            slip_rate,
            slip_rate_sum: sum,
            next_slip_rate_sum: f64::NAN,
        });
        told.unwrap_or(Control::Continue)
    }
}
