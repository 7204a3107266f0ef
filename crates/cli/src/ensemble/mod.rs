//! `--ensemble FIT.json[:N]`: a command with the uncertainty of a fit.
//!
//! The members of an ensemble are the command itself with other values of the fitted parameters. Those on both sides of the estimate
//! give derivatives, and with the covariance of the fit a band for every number; those that are drawn check these, and say how probable
//! it is what may be so or not.

mod added;
pub(crate) mod bands;
mod curves;
pub(crate) mod draws;
mod equilibria;
mod gather;
pub(crate) mod item;
mod law;
mod member;
mod picture;
mod sweep;
mod write;

use super::call::Call;
use super::ranks::Joined;
use super::report::Report;
use super::words::several;
use super::{Ending, interrupt};
use added::Added;
use bands::{Banded, Check, bands};
use curves::Course;
use gather::{Gathered, Items, Members};
use item::Item;
use member::Yield;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use sweep::Tally;
use twinslip::error::{Error, Result};
use twinslip_output::{Format, RowFile, plot, seven_digits};
use twinslip_tasks::scene::{Command, EnsemblePlan};
use write::{Finished, Parts};

/// A band that is narrower than this, relatively, is none.
const SAME: f64 = 1e-9;

/// Runs a command that asks for an ensemble.
pub fn run(plan: &EnsemblePlan, command: &Command, call: &Call) -> Result<Ending> {
    if let Some(law) = given_law(&call.words)
        && law != plan.fit.law
    {
        let law = if law.contains('\n') { "(a text)" } else { law };
        return Err(Error::Input(format!(
            "`law` {law}: `ensemble` {} is a fit of the law {}",
            plan.file.told(),
            plan.fit.law
        )));
    }
    if Joined::join()?.is_some() {
        return Err(Error::Input(
            "`ensemble` runs on the threads of one machine: leave out mpirun".into(),
        ));
    }
    let output = command.output();
    let parquet = |path: &PathBuf| path.extension().is_some_and(|ending| ending == "parquet");
    if output.format.as_deref() == Some("parquet") || output.output.as_ref().is_some_and(parquet) {
        return Err(Error::Input(
            "`ensemble` is written as CSV or JSON, not as Parquet".into(),
        ));
    }
    let plot = command.plot();
    if let Some(path) = plot {
        plot::PictureFormat::of(path)?;
    }
    let plots: Vec<&Path> = plot.into_iter().collect();
    let report = Report::new(command.output(), call, &plots)?;
    if !plan.fit.converged {
        report.say(format!(
            "warning: the fit in {} is undecided: its uncertainty may be wrong",
            plan.file.told()
        ));
    }
    if call.outlet.is_none() {
        // All is in memory until the end.
        interrupt::keeps("");
        interrupt::holds();
    }
    let curves = matches!(command, Command::Branch(_) | Command::Locus(_));
    let special_file = match curves {
        true => write::claim_special(&report, command.output().force)?,
        false => None,
    };
    call.watch();
    let ended = Ensemble {
        plan,
        report: &report,
        plot,
    }
    .ended(command, special_file);
    call.unwatch();
    ended
}

/// The law that a command line names: the options have one in any case.
fn given_law(words: &[String]) -> Option<&str> {
    let mut words = words.iter();
    while let Some(word) = words.next() {
        match word.strip_prefix("--law") {
            Some("") => return words.next().map(String::as_str),
            Some(rest) if rest.starts_with('=') => return Some(&rest[1..]),
            _ => {}
        }
    }
    None
}

/// An ensemble that is asked for, and where it goes.
struct Ensemble<'a> {
    plan: &'a EnsemblePlan,
    report: &'a Report<'a>,
    plot: Option<&'a Path>,
}

/// What members have come to.
struct Known {
    /// What is known of each thing of the estimate.
    banded: Vec<Banded>,
    /// How far both kinds of bands are apart, and where.
    check: Check,
    /// How many draws there are.
    draws: usize,
    /// How many things each of them has.
    counts: Vec<usize>,
}

impl Ensemble<'_> {
    fn ended(&self, command: &Command, special_file: Option<RowFile>) -> Result<Ending> {
        if command.output().explain {
            self.explain(matches!(command, Command::Sweep(_)));
        }
        let (estimate, ending) = member::run(&self.plan.estimate(), self.report.call, true)?;
        match command {
            Command::Law(_) => self.law(estimate, ending),
            Command::Equilibria(_) => self.equilibria(estimate, ending),
            Command::Sweep(_) => self.sweep(estimate, ending),
            _ => self.curves(estimate, ending, special_file),
        }
    }

    /// Says which members there will be.
    fn explain(&self, sweeps: bool) {
        let (fit, draws) = (&self.plan.fit, self.plan.draws);
        let names: Vec<&str> = fit.parameters.iter().map(|one| one.name).collect();
        let derivatives = match sweeps {
            true => "off: regimes have no derivatives".to_owned(),
            false => format!(
                "{} members, one on either side in each parameter",
                2 * names.len()
            ),
        };
        self.report.call.say(format!(
            "plan of the ensemble\n  law               {}\n  fitted            {}\n  derivatives       {derivatives}\n  draws             {draws}, seed {}",
            fit.law,
            names.join(", "),
            draws::SEED
        ));
    }

    /// The members beside the estimate, of which these are the things.
    fn members(&self, besides: usize) -> Members<'_> {
        let sides = 2 * self.plan.fit.parameters.len();
        Members::new(self.plan, self.report, sides + besides)
    }

    /// What all members have come to.
    fn known(
        &self,
        members: &Members<'_>,
        estimate: &[Item],
        items: (Items<'_>, [&[f64]; 2]),
    ) -> Result<Known> {
        let Gathered { sides, draws } = members.gather(estimate, items)?;
        let correlation = &self.plan.fit.correlation;
        let (banded, check) = bands(estimate, (&sides, correlation), &draws);
        Ok(Known {
            banded,
            check,
            draws: draws.len(),
            counts: draws.iter().map(|draw| draw.things).collect(),
        })
    }

    /// `result.ensemble`, and its lines.
    fn told(&self, members: &Members<'_>, draws: usize, check: Option<(&Check, &[Item])>) -> Value {
        let (failed, first) = members.failures();
        let fit = &self.plan.fit;
        let names: Vec<&str> = fit.parameters.iter().map(|one| one.name).collect();
        let check = check.map(|(check, items)| {
            let place = check.at.map(|(item, number)| {
                format!(
                    "{} of {}",
                    items[item].numbers[number].name, items[item].class
                )
            });
            (check, place)
        });
        self.report.say(format!(
            "the uncertainty of {} in {}: {} (seed {}){}",
            names.join(", "),
            self.plan.file.told(),
            several(draws, "draw", "draws"),
            draws::SEED,
            match (failed, first) {
                (0, _) | (_, None) => String::new(),
                (n, Some(error)) => format!(
                    "; {} failed, the first one as {error}",
                    several(n, "member", "members")
                ),
            }
        ));
        if let Some((check, Some(place))) = &check
            && check.apart > 0
        {
            self.report.say(format!(
                "the bands of derivatives and of draws differ at {} of {} numbers by more than a fifth of half their width, and by up to {:.2} of it at {place}: there the fit is too uncertain for bands that are linear in its parameters",
                check.apart, check.numbers, check.largest
            ));
        }
        json!({
            "file": self.plan.file.told(),
            "draws": draws,
            "seed": draws::SEED,
            "failed": failed,
            "parameters": names,
            "check": check.and_then(|(check, place)| Some(json!({
                "largest": check.largest,
                "where": place?,
                "by_chance": check.by_chance,
                "apart": check.apart,
                "numbers": check.numbers,
            }))),
        })
    }

    fn law(&self, mut estimate: Yield, ending: Ending) -> Result<Ending> {
        let items = law::items(&estimate);
        let members = self.members(0);
        let known = self.known(&members, &items, (&law::items, [&[]; 2]))?;
        if let Some(mut drawing) = estimate.picture.take() {
            let points = law::points(&estimate, &items, &known.banded);
            let shown = law::shown(&estimate, &known.banded);
            picture::with_bands(&mut drawing, &shown, &points);
            estimate.picture = Some(drawing);
        }
        let (rows, lines) = law::finish(&mut estimate, &items, &known.banded);
        let ensemble = self.told(&members, known.draws, Some((&known.check, &items)));
        self.finish(
            estimate,
            ensemble,
            Parts::of_rows(rows, lines, false),
            ending,
        )
    }

    fn equilibria(&self, mut estimate: Yield, ending: Ending) -> Result<Ending> {
        let items = equilibria::items(&estimate);
        let members = self.members(0);
        let known = self.known(&members, &items, (&equilibria::items, [&[]; 2]))?;
        if let Some(mut drawing) = estimate.picture.take() {
            let points = equilibria::points(&items, &known.banded);
            picture::with_bands(&mut drawing, &picture::BandsAt::default(), &points);
            estimate.picture = Some(drawing);
        }
        let (rows, lines) = equilibria::finish(&mut estimate, &items, &known.banded);
        let mut ensemble = self.told(&members, known.draws, Some((&known.check, &items)));
        ensemble["counts"] = json!(equilibria::counts(&known.counts));
        self.finish(
            estimate,
            ensemble,
            Parts::of_rows(rows, lines, false),
            ending,
        )
    }

    fn sweep(&self, mut estimate: Yield, ending: Ending) -> Result<Ending> {
        let members = self.members(0);
        let tally = Tally::of(self.plan, &members, estimate.rows.len());
        let own = sweep::regimes(&estimate);
        if let Some(drawing) = &mut estimate.picture {
            picture::with_probabilities(drawing, &tally, &own);
        }
        let (rows, regimes, lines) = tally.finish(&mut estimate);
        let mut ensemble = self.told(&members, tally.draws, None);
        ensemble["regimes"] = Value::Object(regimes);
        self.finish(
            estimate,
            ensemble,
            Parts::of_rows(rows, lines, true),
            ending,
        )
    }

    fn curves(
        &self,
        mut estimate: Yield,
        ending: Ending,
        special_file: Option<RowFile>,
    ) -> Result<Ending> {
        if estimate.rows.is_empty() && estimate.special.is_empty() {
            // Without a point of the estimate nothing is there to have a band.
            let ensemble = self.told(&self.members(0), 0, None);
            let parts = Parts {
                special_file,
                ..Parts::of_rows(Added::default(), Vec::new(), true)
            };
            return self.finish(estimate, ensemble, parts, ending);
        }
        let course = Course::new(self.plan, &estimate);
        let course = course.expect("curves have something that varies");
        let members = self.members(1);
        let landings = &course.landings;
        let middle = self.plan.fit.middle();
        let landed = members.run(&self.plan.landing(self.plan.member(&middle), landings));
        let mut items = landed.map_or(Vec::new(), |landed| course.rows(&landed));
        let of_rows = items.len();
        items.extend(course.special(&estimate, false));
        let both = |found: &Yield| [course.rows(found), course.special(found, true)].concat();
        let known = self.known(&members, &items, (&both, [landings, &course.thinned()]))?;
        let (rows, special) = known.banded.split_at(of_rows);
        let (landed, special_items) = items.split_at(of_rows);
        let rows = course.of_rows(&estimate, landed, rows);
        if let Some(mut drawing) = estimate.picture.take() {
            let points = course.points(special_items, special);
            picture::with_bands(&mut drawing, &course.shown(&estimate, &rows), &points);
            estimate.picture = Some(drawing);
        }
        let (rows, special, lines) = course.finish(&mut estimate, &rows, (special_items, special));
        let ensemble = self.told(&members, known.draws, Some((&known.check, &items)));
        let parts = Parts {
            special,
            special_file,
            ..Parts::of_rows(rows, lines, true)
        };
        self.finish(estimate, ensemble, parts, ending)
    }

    /// Writes all of it, and says how it ended.
    fn finish(
        &self,
        mut estimate: Yield,
        ensemble: Value,
        parts: Parts,
        ending: Ending,
    ) -> Result<Ending> {
        let report = self.report;
        estimate.object["result"]["ensemble"] = ensemble;
        if report.format != Format::Json {
            parts.lines.iter().for_each(|line| report.say(line));
        }
        let whole = !report.call.stops();
        if let (Some(path), Some(drawing)) = (self.plot, &estimate.picture) {
            report.draw(path, drawing)?;
        }
        if let (false, Some(path)) = (whole, report.place.path()) {
            let kept = format!("what was computed is in {}", path.display());
            report.call.keeps(kept);
        }
        let written = Finished {
            report,
            estimate,
            parts,
            whole,
        }
        .write()?;
        Ok(match written {
            Ending::Done if !whole => Ending::Interrupted,
            Ending::Done => ending,
            other => other,
        })
    }
}

/// A thing with its bands in words.
fn told(item: &Item, known: &Banded) -> String {
    let number = |(number, band): (&item::Measured, &bands::Band)| {
        // What is the same in all members needs no band.
        let ends = band
            .linear
            .filter(|[low, high]| high - low > SAME * number.value.abs());
        let ends = ends.map(|ends| ends.map(seven_digits));
        let ends = ends.map_or(String::new(), |[low, high]| format!(" ({low} to {high})"));
        format!("{} {}{ends}", number.name, seven_digits(number.value))
    };
    let numbers = item.numbers.iter().zip(&known.bands);
    let numbers: Vec<String> = numbers
        .filter(|(number, _)| number.value.is_finite())
        .map(number)
        .collect();
    let probability = known.probability.map_or(String::new(), |probability| {
        format!(", in {} of draws", percent(probability))
    });
    format!("{} at {}{probability}", item.class, numbers.join(", "))
}

/// A part of all in percent.
fn percent(part: f64) -> String {
    let tenths = (1000.0 * part).round() / 10.0;
    format!("{tenths} %")
}
