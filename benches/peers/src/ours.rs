//! twinslip's own methods.

use crate::common::methods::methods;
use crate::common::scene::Problem;
use crate::peer::{Answer, Peer, Question, timed};
use twinslip::field::State;
use twinslip::friction::AnyLaw;
use twinslip::integrate::{Batch, BatchRun, Choice, MAX_STEPS, Tolerances};
use twinslip::model::Driven;

/// A method of twinslip.
pub struct Ours {
    name: String,
    choice: Choice,
    field: Box<dyn Driven<3>>,
    start: State<3>,
    until: f64,
}

/// Runs in lanes: as many as fill them, from the starts that heyoka's batch has.
pub struct OurBatch {
    law: AnyLaw,
    runs: Vec<BatchRun>,
}

/// Every method of the build, and `auto`; with many runs at once where no tangent flow is asked for.
pub fn all(problem: &Problem, tangent: bool) -> Vec<Box<dyn Peer>> {
    let ours = |(name, choice)| -> Box<dyn Peer> {
        Box::new(Ours {
            name: format!("twinslip {name}"),
            choice,
            field: problem.field(),
            start: problem.start,
            until: problem.until,
        })
    };
    let mut peers: Vec<Box<dyn Peer>> = methods().into_iter().map(ours).collect();
    if !tangent {
        peers.push(Box::new(OurBatch::new(problem)));
    }
    peers
}

impl OurBatch {
    fn new(problem: &Problem) -> Self {
        let lanes = Tolerances::equal(1e-9)
            .and_then(|tolerances| Batch::new(problem.law, tolerances, MAX_STEPS))
            .expect("it has methods")
            .lanes();
        let run = |lane: usize| {
            let mut start = problem.start;
            start[1] += (1e-3 * lane as f64).ln_1p();
            let Problem { loading, until, .. } = *problem;
            let t = (0.0, until);
            BatchRun { loading, start, t }
        };
        OurBatch {
            law: problem.law,
            runs: (0..lanes).map(run).collect(),
        }
    }
}

impl Peer for OurBatch {
    fn name(&self) -> &str {
        "twinslip batch"
    }

    fn ask(&mut self, question: &Question) -> Result<Answer, String> {
        let mut batch = Tolerances::equal(question.tolerance)
            .and_then(|tolerances| Batch::new(self.law, tolerances, MAX_STEPS))
            .map_err(|error| error.to_string())?;
        let (end, seconds) = timed(question.repeat, || {
            let ends: twinslip::Result<Vec<_>> = batch.flow(&self.runs, None).into_iter().collect();
            ends.map(|ends| ends[0]).map_err(|error| error.to_string())
        })?;
        Ok(Answer {
            seconds: seconds / self.runs.len() as f64,
            steps: None,
            end: end.into(),
            tangent: None,
        })
    }
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
