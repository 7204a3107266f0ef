//! `branch` and `locus` in any parameters.

use super::branch::BRANCHES;
use super::call::Call;
use super::continuation::{Recheck, Task};
use super::locus::CURVES;
use super::rows::Found;
use super::{Ending, special};
use serde_json::Value;
use std::path::PathBuf;
use twinslip::error::Result;
use twinslip_tasks::scene::{
    BranchOptions, Free, GeneralBranchPlan, GeneralFound, GeneralLocusPlan, GeneralRow,
    LocusOptions, OutputOptions, Quantity, RowKind, SpecialRow, Subject, shown,
};
use twinslip_tasks::views;

/// Branches along a parameter of any system.
pub fn branch(options: &BranchOptions, subject: &dyn Subject, call: &Call) -> Result<Ending> {
    let plan = GeneralBranchPlan::new(options, subject)?;
    let files = (options.resume.as_ref(), options.plot.as_ref());
    let free = [&plan.free];
    let frame = Frame::new(subject, plan.kind, &free);
    let second = plan.following.second;
    let again = |one: &GeneralRow| second.map_or(Ok(None), |method| plan.crosscheck(one, method));
    let second = second.map(|method| (method, &again as _));
    let task = frame.task(&plan.numerics, second, files, &options.output, call);
    let report = task.report()?;
    if options.output.explain {
        call.say(plan.explain());
    }
    task.run(
        &report,
        |known, seen| plan.follow(known, &mut |found| seen(found.into())),
        |rows, special| views::general_branches(rows, special, &plan),
    )
}

/// Curves in the plane of two parameters of any system.
pub fn locus(
    options: &LocusOptions,
    begin: Option<SpecialRow>,
    subject: &dyn Subject,
    call: &Call,
) -> Result<Ending> {
    let plan = GeneralLocusPlan::new(options, begin, subject)?;
    let files = (options.resume.as_ref(), options.plot.as_ref());
    let free = plan.free.each_ref();
    let frame = Frame::new(subject, plan.kind, &free);
    let second = plan.following.second;
    let again = |one: &GeneralRow| second.map_or(Ok(None), |method| plan.crosscheck(one, method));
    let second = second.map(|method| (method, &again as _));
    let task = frame.task(&plan.numerics, second, files, &options.output, call);
    let report = task.report()?;
    if options.output.explain {
        call.say(plan.explain());
    }
    task.run(
        &report,
        |known, seen| plan.follow(known, &mut |found| seen(found.into())),
        |rows, special| views::general_curves(rows, special, &plan),
    )
}

impl From<GeneralFound> for Found<GeneralRow> {
    fn from(found: GeneralFound) -> Self {
        match found {
            GeneralFound::Row(row) => Found::Row(row),
            GeneralFound::Special(special) => Found::Special(special),
        }
    }
}

type Reader<'s> = Box<dyn Fn(&dyn Fn(&str) -> String) -> Option<GeneralRow> + 's>;
type Lines<'s> = Box<dyn Fn(&[GeneralRow], &special::Checks<'_>) -> Vec<String> + 's>;

/// What the tasks of branches and curves share.
struct Frame<'s> {
    subject: &'s dyn Subject,
    kind: RowKind,
    names: Vec<(&'static str, Quantity)>,
    read: Reader<'s>,
    read_special: Reader<'s>,
    lines: Lines<'s>,
}

impl<'s> Frame<'s> {
    fn new(subject: &'s dyn Subject, kind: RowKind, free: &[&Free]) -> Self {
        let names = shown(subject, free);
        let (numbers, states) = (subject.numbers(kind), subject.states());
        let (of_rows, of_special, of_lines) = (names.clone(), names.clone(), names.clone());
        let units = subject.units();
        Frame {
            subject,
            kind,
            names,
            read: Box::new(move |cell| GeneralRow::read(cell, units, &of_rows, (&numbers, &[]))),
            read_special: Box::new(move |cell| {
                GeneralRow::read(cell, units, &of_special, (&[], &states))
            }),
            lines: Box::new(move |special, checks| {
                let columns = GeneralRow::special_columns(subject, &of_lines);
                special::general_lines(special, &columns, checks, units)
            }),
        }
    }

    fn task<'t>(
        &'t self,
        numerics: &Value,
        second: Option<Recheck<'t, GeneralRow>>,
        (resume, plot): (Option<&'t PathBuf>, Option<&'t PathBuf>),
        output: &'t OutputOptions,
        call: &'t Call,
    ) -> Task<'t, GeneralRow> {
        Task {
            system: self.subject,
            whole: if self.kind.curve { CURVES } else { BRANCHES },
            // That nothing is found is an error there.
            nothing: "",
            names: self.names.iter().map(|(name, _)| *name).collect(),
            columns: GeneralRow::columns(self.subject, self.kind, &self.names),
            special_columns: GeneralRow::special_columns(self.subject, &self.names),
            read: (&*self.read, &*self.read_special),
            lines: &*self.lines,
            numerics: numerics.clone(),
            second,
            resume,
            plot,
            output,
            call,
        }
    }
}
