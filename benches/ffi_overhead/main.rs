//! What the safe types cost and gain against a plain C program with stock CVODES, side by side in one run.
//!
//! Scene: two interfaces, law (35), K = 0.14, V_H = 10, from beside the symmetric state; 20 stick-slip cycles for the state,
//! one for the tangent. The C program is compiled here with `cc -O3`, runs as a child, and takes turns with Rust, so that a
//! busy machine disturbs both alike; the ratio printed is the median of the ratios of neighbours, beside that of the best times.
//! Errors: the largest component of |y - y*| / |y*| for the state, of |M - M*| / max |M*| for the tangent, against a run at
//! 1e-13.
//!
//! First the table, then criterion on the same work.

mod stock;

use criterion::{Criterion, criterion_group};
use std::hint::black_box;
use std::path::Path;
use std::time::{Duration, Instant};
use stock::{Answer, Clock, Program, Question, Stock};
use twinslip::field::{Jacobian, State};
use twinslip::friction::{AnyLaw, Parameters};
use twinslip::integrate::Tolerances;
use twinslip::model::{Driven, Loading, two_interfaces};
use twinslip::sundials::{
    self, Cvode, Kinsol, Mode, MultistepMethod, Operations, Problem, Residual, Sensitivity,
};

const STIFFNESS: f64 = 0.14;
const DRIVING: f64 = 10.0;
/// Twenty cycles.
const LONG: f64 = 64.0;
/// One cycle.
const SHORT: f64 = 4.0;
const STATE_TOLERANCE: f64 = 1e-8;
const TANGENT_TOLERANCE: f64 = 1e-10;
const ROUNDS: usize = 41;

fn field() -> Box<dyn Driven<3>> {
    let law = AnyLaw::named("spinodal", Parameters::heslot_1994()).expect("a law");
    two_interfaces(law, Loading::new(DRIVING, STIFFNESS).expect("positive"))
}

fn start() -> State<3> {
    let w = 0.01_f64.ln();
    State::<3>::new(9.0, w, w + 0.01)
}

/// The C program on this scene.
struct C(Stock);

impl C {
    fn new() -> Self {
        let root = Path::new(env!("CARGO_MANIFEST_DIR"));
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR"));
        let program = Program::compile(root, folder, Clock::Wall);
        let law = AnyLaw::Spinodal(Parameters::heslot_1994().spinodal());
        let loading = Loading::new(DRIVING, STIFFNESS).expect("positive");
        C(program
            .start(law, loading, &start())
            .expect("a law it knows"))
    }

    fn run(&mut self, tangent: bool, repeat: u64) -> Answer {
        let question = if tangent {
            Question::new("tangent", TANGENT_TOLERANCE, SHORT, repeat)
        } else {
            Question::new("bdf", STATE_TOLERANCE, LONG, repeat)
        };
        self.0.ask(&question).expect("an answer")
    }
}

/// Our wrapper, with either operations.
struct Ours {
    solver: Cvode<3>,
    field: Box<dyn Driven<3>>,
    unit: Vec<State<3>>,
}

impl Ours {
    fn new(method: MultistepMethod, operations: Operations) -> Self {
        let identity = Jacobian::<3>::identity();
        Ours {
            solver: Cvode::new(method, operations).expect("SUNDIALS"),
            field: field(),
            unit: identity.column_iter().map(|c| c.into_owned()).collect(),
        }
    }

    fn state(&mut self, tolerance: f64, end: f64) -> State<3> {
        let tolerances = Tolerances::equal(tolerance).expect("sensible");
        self.solver.set_tolerances(tolerances).expect("accepted");
        self.solver.start(0.0, &start()).expect("finite");
        let problem = Problem::new(&*self.field);
        self.solver
            .advance(&problem, end, Mode::Normal)
            .expect("an end");
        self.solver.state()
    }

    fn tangent(&mut self, tolerance: f64, end: f64) -> Jacobian<3> {
        let tolerances = Tolerances::equal(tolerance).expect("sensible");
        self.solver.set_tolerances(tolerances).expect("accepted");
        self.solver
            .start_with_sensitivities(0.0, &start(), &self.unit, &Sensitivity::default())
            .expect("finite");
        let problem = Problem::new(&*self.field);
        self.solver
            .advance(&problem, end, Mode::Normal)
            .expect("an end");
        Jacobian::<3>::from_columns(&self.solver.sensitivities().expect("some"))
    }

    fn run(&mut self, tangent: bool, repeat: u64) -> Answer {
        let begin = Instant::now();
        let mut m = None;
        for _ in 0..repeat {
            if tangent {
                m = Some(black_box(self.tangent(TANGENT_TOLERANCE, SHORT)));
            } else {
                black_box(self.state(STATE_TOLERANCE, LONG));
            }
        }
        Answer {
            time: begin.elapsed(),
            steps: self.solver.work().expect("counted").steps,
            y: self.solver.state(),
            m,
        }
    }
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

/// One row of the table.
fn row(name: &str, times: &[f64], c: &[f64], answer: &Answer, error: f64) {
    let time = median(times.to_vec());
    let ratio = median(times.iter().zip(c).map(|(ours, c)| ours / c).collect());
    let least = |times: &[f64]| times.iter().copied().fold(f64::INFINITY, f64::min);
    let best = least(times) / least(c);
    println!(
        "{name:62} {:9.1} us  {ratio:.3} x C (best {best:.3})  {:6} steps  {:7.1} ns/step  error {error:.2e}",
        1e6 * time,
        answer.steps,
        1e9 * time / answer.steps as f64,
    );
}

fn table() {
    let mut c = C::new();
    let mut stock = Ours::new(MultistepMethod::Bdf, Operations::Stock);
    let mut fixed = Ours::new(MultistepMethod::Bdf, Operations::Fixed);
    let mut tight = Ours::new(MultistepMethod::Adams, Operations::Fixed);
    let y = tight.state(1e-13, LONG);
    let m = tight.tangent(1e-13, SHORT);
    let error = |answer: &Answer| match answer.m {
        Some(ours) => (ours - m).amax() / m.amax(),
        None => (answer.y - y).component_div(&y).amax(),
    };

    println!("SUNDIALS {}", sundials::version());
    println!("{} cycles by t = {LONG}, one by t = {SHORT}", cycles());
    for (tangent, repeat, title) in [
        (false, 1, "state, 20 cycles, 1e-8"),
        (true, 3, "tangent, 1 cycle, 1e-10, simultaneous"),
    ] {
        let mut times: [Vec<f64>; 3] = Default::default();
        let mut answers: [Option<Answer>; 3] = Default::default();
        for round in 0..=ROUNDS {
            let runs = [
                c.run(tangent, repeat),
                stock.run(tangent, repeat),
                fixed.run(tangent, repeat),
            ];
            for (i, run) in runs.into_iter().enumerate() {
                // The first round warms up.
                if round > 0 {
                    times[i].push(run.time.as_secs_f64() / repeat as f64);
                }
                answers[i] = Some(run);
            }
        }
        let names = ["C, stock CVODES BDF", "ours, stock operations", "ours"];
        for (i, name) in names.iter().enumerate() {
            let answer = answers[i].as_ref().expect("run");
            row(
                &format!("{title}: {name}"),
                &times[i],
                &times[0],
                answer,
                error(answer),
            );
        }
    }
}

/// Slips: falls of the stress through its middle. One interface slips, the other creeps.
fn cycles() -> usize {
    let mut solver = Cvode::<3>::new(MultistepMethod::Adams, Operations::Fixed).expect("SUNDIALS");
    let field = field();
    solver.watch_events(1, &[-1]).expect("room");
    solver.start(0.0, &start()).expect("finite");
    let problem = Problem {
        events: Some(&|_, y: &State<3>, g| g[0] = y[0] - 9.5),
        ..Problem::new(&*field)
    };
    let mut count = 0;
    while solver
        .advance(&problem, LONG, Mode::Normal)
        .expect("an end")
        .t
        < LONG
    {
        count += 1;
    }
    count
}

/// The equilibria of the system in (tau, w1, w2).
struct Equilibrium(Box<dyn Driven<3>>);

impl Residual<3> for Equilibrium {
    fn residual(&self, u: &State<3>) -> State<3> {
        self.0.f(u)
    }

    fn jacobian(&self, u: &State<3>) -> Jacobian<3> {
        self.0.jacobian(u)
    }
}

/// An asymmetric equilibrium from a guess one per cent off in every unknown, with a solver that is reused.
fn equilibrium(criterion: &mut Criterion) {
    let law = AnyLaw::named("spinodal", Parameters::heslot_1994()).expect("a law");
    let (k, v_h) = (0.14, 0.12);
    let problem = Equilibrium(two_interfaces(law, Loading::new(v_h, k).expect("positive")));
    // Of tests/data/equilibria.json.
    let (v_slow, v_fast) = (0.007155123670426197, 0.1128448763295738);
    let root = State::<3>::new(
        11.343406289643613,
        0.5829162291169635_f64.ln(),
        0.08140347647199829_f64.ln(),
    );
    let f_scale = State::<3>::new(1.0 / (k * v_h), 1.0 / v_slow, 1.0 / v_fast);
    let u_scale = State::<3>::repeat(1.0);
    let mut kinsol = Kinsol::<3>::new().expect("SUNDIALS");
    let mut solve = || {
        kinsol
            .solve(&problem, &black_box(root * 1.01), &u_scale, &f_scale)
            .expect("a root")
    };
    let error = (solve() - root).amax();
    let iterations = kinsol.work().expect("counted").iterations;
    let mut solve = || {
        kinsol
            .solve(&problem, &black_box(root * 1.01), &u_scale, &f_scale)
            .expect("a root")
    };
    let mut times = Vec::new();
    for _ in 0..ROUNDS {
        let begin = Instant::now();
        for _ in 0..1000 {
            black_box(solve());
        }
        times.push(begin.elapsed().as_secs_f64() / 1000.0);
    }
    println!(
        "KINSOL, asymmetric equilibrium: {:.2} us, {iterations} iterations, error {error:.1e}",
        1e6 * median(times)
    );
    criterion.bench_function("kinsol/asymmetric equilibrium", |b| b.iter(&mut solve));
}

fn cvodes(criterion: &mut Criterion) {
    // Not when `cargo test` only looks whether the bench runs.
    if std::env::args().any(|argument| argument == "--bench") {
        table();
    }
    let mut c = C::new();
    for (tangent, name) in [(false, "state"), (true, "tangent")] {
        let mut group = criterion.benchmark_group(name);
        group.bench_function("C stock", |b| {
            b.iter_custom(|repeat| c.run(tangent, repeat).time)
        });
        for operations in [Operations::Stock, Operations::Fixed] {
            let mut ours = Ours::new(MultistepMethod::Bdf, operations);
            group.bench_function(format!("ours, {operations:?}"), |b| {
                b.iter_custom(|repeat| ours.run(tangent, repeat).time)
            });
        }
        group.finish();
    }
}

criterion_group! {
    name = benches;
    config = Criterion::default()
        .sample_size(20)
        .warm_up_time(Duration::from_millis(500))
        .measurement_time(Duration::from_secs(2));
    targets = equilibrium, cvodes
}

fn main() {
    benches();
    Criterion::default().configure_from_args().final_summary();
}
