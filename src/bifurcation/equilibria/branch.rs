//! Branches of equilibria along V_H at fixed K, or along K at fixed V_H.

use super::branch_observer::BranchObserver;
use super::curves::{AlongDriving, AlongStiffness, CurveVariables};
use super::pieces::{Ends, PieceEnd};
use super::special::Teller;
use crate::bifurcation::{BranchRequest, EventObserver, Parameter};
use crate::continuation::{Branch, Settings, Stop, ZeroProblem, follow};
use crate::equilibrium::{Solver, Symmetry, steady_states};
use crate::error::{Error, Result};
use std::ops::ControlFlow;

/// The longest step, in ln V_H and ln K.
const LONGEST: f64 = 0.2;

/// See [`super::branch()`].
pub(super) fn branch(request: &BranchRequest, seen: EventObserver<'_>) -> Result<()> {
    let settings = settings(request)?;
    let interfaces = request.slab.interfaces;
    let mut run = BranchRun {
        request,
        settings,
        teller: Teller::new(seen, request.tolerance, &request.skip),
        branches: 0,
    };
    // an observer's end is no error
    let _ = match request.along {
        Parameter::Driving => run.along_driving(interfaces)?,
        Parameter::Stiffness => run.along_stiffness(interfaces)?,
    };
    Ok(())
}

fn settings(request: &BranchRequest) -> Result<Settings> {
    let (a, b) = request.range;
    let inside = |x: &&f64| **x >= a.min(b) && **x <= a.max(b);
    let wanted = request.at.iter().filter(inside).map(|x| x.ln()).collect();
    Settings {
        wanted,
        max_points: request.max_points,
        ..Settings::new((a.min(b).ln(), a.max(b).ln()), LONGEST * request.step)?
    }
    .checked()
}

struct BranchRun<'a> {
    request: &'a BranchRequest,
    settings: Settings,
    teller: Teller<'a>,
    branches: usize,
}

impl BranchRun<'_> {
    fn wants(&self, symmetry: Symmetry) -> bool {
        self.request
            .symmetry
            .is_none_or(|wanted| wanted == symmetry)
    }

    fn along_driving(&mut self, interfaces: usize) -> Result<ControlFlow<()>> {
        let (law, (from, to)) = (&self.request.slab.law, self.request.range);
        if self.wants(Symmetry::Symmetric) {
            let curve = CurveVariables::Symmetric { interfaces };
            let problem = AlongDriving { law, curve };
            let rates = [from / interfaces as f64; 2];
            let begin = PieceEnd::at_range_end(law, curve, from, from < to, rates);
            if self.one(&problem, curve, None, &begin)?.is_break() {
                return Ok(ControlFlow::Break(()));
            }
        }
        if interfaces == 2 && self.wants(Symmetry::Asymmetric) {
            let curve = CurveVariables::Asymmetric;
            let problem = AlongDriving { law, curve };
            let mut ends = Ends::of(law, (from, to))?;
            while let Some(begin) = ends.next() {
                match self.one(&problem, curve, None, &begin)? {
                    ControlFlow::Continue(branch) => ends.reached(&branch),
                    ControlFlow::Break(()) => return Ok(ControlFlow::Break(())),
                }
            }
        }
        Ok(ControlFlow::Continue(()))
    }

    fn along_stiffness(&mut self, interfaces: usize) -> Result<ControlFlow<()>> {
        let slab = &self.request.slab;
        let driving = slab.loading.driving;
        let states = steady_states(&slab.law, driving, interfaces, Solver::Newton)?;
        let (from, to) = self.request.range;
        for symmetry in [Symmetry::Symmetric, Symmetry::Asymmetric] {
            let these = states.equilibria.iter().filter(|e| e.symmetry == symmetry);
            for state in these.filter(|_| self.request.symmetry.is_none_or(|s| s == symmetry)) {
                let curve = match symmetry {
                    Symmetry::Symmetric => CurveVariables::Symmetric { interfaces },
                    Symmetry::Asymmetric => CurveVariables::Asymmetric,
                };
                let rates = [state.slip_rate[0], state.slip_rate[interfaces - 1]];
                let fixed = PieceEnd::on_a_line(&slab.law, from, from < to, rates);
                if self
                    .one(&AlongStiffness, curve, Some(rates), &fixed)?
                    .is_break()
                {
                    return Ok(ControlFlow::Break(()));
                }
            }
        }
        Ok(ControlFlow::Continue(()))
    }

    /// One branch from its begin to its end.
    fn one(
        &mut self,
        problem: &dyn ZeroProblem,
        curve: CurveVariables,
        rates: Option<[f64; 2]>,
        begin: &PieceEnd,
    ) -> Result<ControlFlow<(), Branch>> {
        let mut observer = BranchObserver {
            request: self.request,
            curve,
            rates,
            begin,
            number: self.branches,
            teller: &mut self.teller,
            failure: None,
        };
        self.branches += 1;
        let branch = follow(problem, &begin.start, &self.settings, &mut observer)?;
        if let Some(error) = observer.failure {
            return Err(error);
        }
        if matches!(branch.stopped, Stop::MaxPoints(_)) {
            let limit = self.request.max_points;
            return Err(Error::TooManyPoints { limit });
        }
        if let Stop::StepTooSmall { .. } = branch.stopped
            && observer.gave_up(&branch).is_break()
        {
            return Ok(ControlFlow::Break(()));
        }
        Ok(match branch.stopped {
            Stop::Observer => ControlFlow::Break(()),
            _ => ControlFlow::Continue(branch),
        })
    }
}
