//! Integrators of other Rust crates. Set-up is outside of the times wherever their interfaces allow.

use crate::common::scene::Problem;
use crate::model::{Chart, Model};
use crate::peer::{Answer, Peer, Question, timed};
use differential_equations::prelude::{ExplicitRungeKutta, IVP, ImplicitRungeKutta, Matrix, ODE};
use diffsol::{NalgebraLU, NalgebraMat, OdeBuilder, OdeSolverMethod, OdeSolverStopReason};
use russell_lab::Vector;
use russell_ode::{Method, OdeSolver, Params, System};
use russell_sparse::{CooMatrix, Sym};

/// More steps are too many.
const MAX_STEPS: usize = 3_000_000;

type Run = fn(&Crate, f64, u32) -> Result<Ended, String>;

/// Time, steps and end of a run.
struct Ended {
    seconds: f64,
    steps: usize,
    end: [f64; 3],
}

/// A method of a crate on one scene.
struct Crate {
    name: String,
    model: Model,
    chart: Chart,
    start: [f64; 3],
    until: f64,
    run: Run,
}

/// The methods, each in the chart in which it does better here: psi for all, by a third of the time in most scenes.
pub fn all(problem: &Problem) -> Vec<Box<dyn Peer>> {
    let methods: [(&str, Chart, Run); 5] = [
        ("diffsol bdf", Chart::Psi, diffsol_bdf),
        ("russell_ode Radau5", Chart::Psi, russell_radau5),
        ("russell_ode DoPri8", Chart::Psi, russell_dopri8),
        ("differential-equations Radau5", Chart::Psi, de_radau5),
        ("differential-equations DOP853", Chart::Psi, de_dop853),
    ];
    let chosen = std::env::var("PEERS_CHART");
    let peer = |(name, chart, run): (&str, Chart, Run)| -> Option<Box<dyn Peer>> {
        // For whoever wants to see the other one.
        let chart = match chosen.as_deref() {
            Ok("psi") => Chart::Psi,
            Ok("ln-psi") => Chart::LnPsi,
            _ => chart,
        };
        Some(Box::new(Crate {
            name: format!("{name} ({})", chart.name()),
            model: Model::new(problem.law, problem.loading, chart)?,
            chart,
            start: chart.inward(problem.start.into()),
            until: problem.until,
            run,
        }))
    };
    methods.into_iter().filter_map(peer).collect()
}

impl Peer for Crate {
    fn name(&self) -> &str {
        &self.name
    }

    fn ask(&mut self, question: &Question) -> Result<Answer, String> {
        let ended = (self.run)(self, question.tolerance, question.repeat)?;
        Ok(Answer {
            seconds: ended.seconds,
            steps: Some(ended.steps),
            end: self.chart.outward(ended.end),
            tangent: None,
        })
    }
}

fn diffsol_bdf(scene: &Crate, tolerance: f64, repeat: u32) -> Result<Ended, String> {
    let (model, start) = (scene.model, scene.start);
    let problem = OdeBuilder::<NalgebraMat<f64>>::new()
        .rtol(tolerance)
        .atol([tolerance; 3])
        .rhs_implicit(
            |y, _, _, dy| dy.copy_from_slice(&model.f([y[0], y[1], y[2]])),
            |y, _, _, v, jv| {
                let j = model.jacobian([y[0], y[1], y[2]]);
                for (out, row) in jv.iter_mut().zip(j) {
                    *out = row[0] * v[0] + row[1] * v[1] + row[2] * v[2];
                }
            },
        )
        .init(|_, _, y| y.copy_from_slice(&start), 3)
        .build()
        .map_err(|error| error.to_string())?;
    let (ended, seconds) = timed(repeat, || {
        let run = || {
            let mut solver = problem.bdf::<NalgebraLU<f64>>()?;
            solver.set_stop_time(scene.until)?;
            let mut steps = 0;
            while !matches!(solver.step()?, OdeSolverStopReason::TstopReached) {
                steps += 1;
                if steps > MAX_STEPS {
                    break;
                }
            }
            let state = solver.state();
            Ok((steps, state.t, [state.y[0], state.y[1], state.y[2]]))
        };
        run().map_err(|error: diffsol::error::DiffsolError| error.to_string())
    })?;
    let (steps, t, end) = ended;
    if t < scene.until {
        return Err(format!("{MAX_STEPS} steps at t = {t}"));
    }
    Ok(Ended {
        seconds,
        steps,
        end,
    })
}

fn russell_radau5(scene: &Crate, tolerance: f64, repeat: u32) -> Result<Ended, String> {
    russell(scene, Method::Radau5, tolerance, repeat)
}

fn russell_dopri8(scene: &Crate, tolerance: f64, repeat: u32) -> Result<Ended, String> {
    russell(scene, Method::DoPri8, tolerance, repeat)
}

fn russell(scene: &Crate, method: Method, tolerance: f64, repeat: u32) -> Result<Ended, String> {
    let model = scene.model;
    let state = |y: &Vector| [y[0], y[1], y[2]];
    let mut system = System::new(3, move |f: &mut Vector, _, y: &Vector, _: &mut ()| {
        let values = model.f(state(y));
        (0..3).for_each(|i| f[i] = values[i]);
        Ok(())
    });
    system.set_jacobian(
        Some(9),
        Sym::No,
        move |jj: &mut CooMatrix, alpha, _, y: &Vector, _: &mut ()| {
            let j = model.jacobian(state(y));
            jj.reset();
            for (i, row) in j.iter().enumerate() {
                for (k, entry) in row.iter().enumerate() {
                    jj.put(i, k, alpha * entry)?;
                }
            }
            Ok(())
        },
    )?;
    let mut params = Params::new(method);
    params.set_tolerances(tolerance, tolerance, None)?;
    params.step.n_step_max = MAX_STEPS;
    // Its two linear systems by turns: threads would cost more than they gain in 3-D, and hide time from this clock.
    params.radau5.concurrent = false;
    let mut solver = OdeSolver::new(params, system)?;
    let (end, seconds) = timed(repeat, || {
        let mut y = Vector::from(&scene.start);
        solver.solve(&mut y, 0.0, scene.until, None, &mut (), None)?;
        Ok(state(&y))
    })?;
    Ok(Ended {
        seconds,
        steps: solver.stats().n_accepted,
        end,
    })
}

struct Field(Model);

impl ODE<f64, [f64; 3]> for Field {
    fn diff(&self, _: f64, y: &[f64; 3], dydt: &mut [f64; 3]) {
        *dydt = self.0.f(*y);
    }

    fn jacobian(&self, _: f64, y: &[f64; 3], j: &mut Matrix<f64>) {
        for (i, row) in self.0.jacobian(*y).into_iter().enumerate() {
            for (k, entry) in row.into_iter().enumerate() {
                j[(i, k)] = entry;
            }
        }
    }
}

/// Both methods have types of their own and no common trait with tolerances.
macro_rules! differential_equations {
    ($scene:ident, $tolerance:ident, $repeat:ident, $method:expr) => {{
        let field = Field($scene.model);
        let (ended, seconds) = timed($repeat, || {
            let method = $method
                .rtol($tolerance)
                .atol($tolerance)
                .max_steps(MAX_STEPS);
            // Only the end is kept.
            IVP::ode(&field, 0.0, $scene.until, $scene.start)
                .t_eval([$scene.until])
                .method(method)
                .solve()
                .map_err(|error| format!("{error:?}"))
        })?;
        Ok(Ended {
            seconds,
            steps: ended.steps.accepted,
            end: *ended.y.last().ok_or("no state at the end")?,
        })
    }};
}

fn de_radau5(scene: &Crate, tolerance: f64, repeat: u32) -> Result<Ended, String> {
    differential_equations!(scene, tolerance, repeat, ImplicitRungeKutta::radau5())
}

fn de_dop853(scene: &Crate, tolerance: f64, repeat: u32) -> Result<Ended, String> {
    differential_equations!(scene, tolerance, repeat, ExplicitRungeKutta::dop853())
}
