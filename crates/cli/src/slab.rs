//! Branches and curves of equal interfaces in V_H and K: what `branch` and `locus` share of them.

use super::call::Call;
use super::continuation::Task;
use super::rows::{SlabRow, special_row};
use super::{Ending, special};
use serde_json::Value;
use std::ops::ControlFlow;
use std::path::PathBuf;
use twinslip::bifurcation::{EventObserver, Special, UserFunction, orbits};
use twinslip::error::Result;
use twinslip::integrate::Choice;
use twinslip::orbit::InterfaceSystem;
use twinslip_output::plot;
use twinslip_tasks::scene::{Column, Described, OutputOptions, System};
use twinslip_tasks::views;

/// What is followed, and where it goes.
pub struct SlabCurves<'a> {
    /// What the rows of one number make up, and what several do.
    pub whole: [&'static str; 2],
    /// What is said where there is none.
    pub nothing: &'a str,
    /// What slides.
    pub system: &'a System,
    /// The same for the crosscheck of special points.
    pub slab: &'a InterfaceSystem,
    /// The functions whose zeros are special points.
    pub watch: &'a [UserFunction],
    /// The method of that crosscheck, where one is asked for.
    pub second: Option<Choice>,
    /// What was asked for.
    pub numerics: &'a Value,
    /// The plan in words.
    pub explain: &'a dyn Fn() -> String,
    /// The file to go on with, and the picture.
    pub files: (Option<&'a PathBuf>, Option<&'a PathBuf>),
    /// Where results go.
    pub output: &'a OutputOptions,
    /// The command line.
    pub call: &'a Call,
}

impl SlabCurves<'_> {
    /// Follows them, whose rows are of one kind.
    pub fn follow<R: SlabRow>(
        &self,
        columns: Vec<Column<R>>,
        events: impl FnOnce(&[usize], EventObserver<'_>) -> Result<()>,
        picture: impl Fn(&[R], &[Special]) -> plot::Drawing,
    ) -> Result<Ending> {
        let units = self.system.units();
        let again = |one: &Special| {
            let second = self.second;
            let checked =
                second.map(|method| orbits::crosscheck((self.slab, self.watch), one, method));
            Ok(checked.transpose()?.flatten().map(Vec::from))
        };
        let task = Task {
            system: self.system,
            whole: self.whole,
            nothing: self.nothing,
            names: vec![],
            columns,
            special_columns: views::special_columns(),
            read: (&|cell| R::read(cell, units), &|cell| {
                special_row(cell, units)
            }),
            lines: &|special, checks| special::lines(special, checks, units),
            numerics: self.numerics.clone(),
            second: self.second.map(|second| (second, &again as _)),
            resume: self.files.0,
            plot: self.files.1,
            output: self.output,
            call: self.call,
        };
        let report = task.report()?;
        if self.output.explain {
            self.call.say((self.explain)());
        }
        task.run(
            &report,
            |known, seen| {
                events(known, &mut |event| {
                    R::found(event).map_or(ControlFlow::Continue(()), &mut *seen)
                })
            },
            picture,
        )
    }
}
