//! `twinslip law --law FILE`.

use crate::Ending;
use crate::call::Call;
use crate::law::write;
use crate::report;
use twinslip::error::Result;
use twinslip_tasks::scene::{
    Described, LawCurve, LawOptions, TextLawPlan, TextLawPoint, TextModel,
};
use twinslip_tasks::views;

pub fn run(options: &LawOptions, model: TextModel, call: &Call) -> Result<Ending> {
    let plan = TextLawPlan::new(options, model)?;
    let outputs = (&options.output, options.plot.as_deref());
    let report = report::begun(outputs, call, || plan.explain())?;
    let (curves, failure) = plan.curves()?;
    if let Some(path) = &options.plot {
        let curves: Vec<LawCurve> = curves.iter().map(plain).collect();
        report.draw(path, &views::picture_of_law(plan.model.units(), &curves))?;
    }
    let columns = views::text_law_columns(curves.len() > 1);
    let ending = write(
        &report,
        &plan.model,
        &columns,
        (&curves, plan.together),
        failure.as_ref(),
    )?;
    failure.map_or(Ok(ending), Err)
}

/// Without error budgets.
fn plain(curve: &LawCurve<TextLawPoint>) -> LawCurve {
    LawCurve {
        interface: curve.interface,
        points: curve.points.iter().map(|at| at.point).collect(),
        together: curve.together.map(|at| at.point),
        landmarks: curve.landmarks.clone(),
        coefficient: curve.coefficient,
    }
}
