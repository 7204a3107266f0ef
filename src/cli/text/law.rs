//! `twinslip law --law FILE`.

use crate::cli::Ending;
use crate::cli::law::{begun, picture, write};
use crate::error::Result;
use crate::output::plot;
use crate::scene::{Described, LawOptions, LawPoint, TextLawPlan, TextModel};
use crate::views;

pub fn run(options: &LawOptions, model: TextModel, words: &[String]) -> Result<Ending> {
    let plan = TextLawPlan::new(options, model)?;
    let report = begun(options, words, || plan.explain())?;
    let (points, failure) = plan.points();
    let landmarks = plan.landmarks(&points)?;
    if let Some(path) = &options.plot {
        let points: Vec<LawPoint> = points.iter().map(|at| at.point).collect();
        let direct_effect = plan.direct_effect();
        let drawing = picture(plan.model.units(), direct_effect, (&points, &landmarks));
        plot::write(path, &drawing)?;
    }
    let (columns, curve) = (views::text_law_columns(), (points.as_slice(), &landmarks));
    let ending = write(&report, &plan.model, &columns, curve, failure.as_ref())?;
    failure.map_or(Ok(ending), Err)
}
