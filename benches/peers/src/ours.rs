//! twinslip's own methods.

use crate::common::methods::methods;
use crate::common::scene::Problem;
use crate::peer::{Answer, Peer, Question, timed};
use twinslip::field::State;
use twinslip::integrate::{Choice, MAX_STEPS, Tolerances};
use twinslip::model::Driven;

/// A method of twinslip.
pub struct Ours {
    name: String,
    choice: Choice,
    field: Box<dyn Driven<3>>,
    start: State<3>,
    until: f64,
}

/// Every method of the build, and `auto`.
pub fn all(problem: &Problem) -> Vec<Box<dyn Peer>> {
    let ours = |(name, choice)| -> Box<dyn Peer> {
        Box::new(Ours {
            name: format!("twinslip {name}"),
            choice,
            field: problem.field(),
            start: problem.start,
            until: problem.until,
        })
    };
    methods().into_iter().map(ours).collect()
    // Batches of runs, beside heyoka's, belong here.
}

impl Peer for Ours {
    fn name(&self) -> &str {
        &self.name
    }

    fn ask(&mut self, question: &Question) -> Result<Answer, String> {
        let Question {
            tolerance, repeat, ..
        } = *question;
        let mut integrator = Tolerances::equal(tolerance)
            .and_then(|tolerances| self.choice.integrator::<3>(tolerances, MAX_STEPS))
            .map_err(|error| error.to_string())?;
        let t = (0.0, self.until);
        let ((end, tangent), seconds) = timed(repeat, || {
            let ended = if question.tangent {
                let ended = integrator.tangent_flow(&*self.field, t, &self.start);
                ended.map(|(y, m)| (y, Some(m)))
            } else {
                let ended = integrator.flow(&*self.field, t, &self.start, None);
                ended.map(|y| (y, None))
            };
            ended.map_err(|error| error.to_string())
        })?;
        Ok(Answer {
            seconds,
            steps: Some(integrator.work().steps),
            end: end.into(),
            tangent: tangent.map(|m| std::array::from_fn(|i| std::array::from_fn(|j| m[(i, j)]))),
        })
    }
}
