//! The plain C program with stock CVODES as a child that answers questions.

use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::time::Duration;
use twinslip::field::{Jacobian, State};
use twinslip::friction::AnyLaw;
use twinslip::model::Loading;
use twinslip::sundials;

/// What the program's times are read from.
#[derive(Clone, Copy)]
#[allow(dead_code, reason = "each of its users takes one")]
pub enum Clock {
    /// The clock on the wall.
    Wall,
    /// CPU time of the thread.
    Cpu,
}

/// The program, compiled.
pub struct Program(PathBuf);

impl Program {
    /// Compiles the C source of the repository at `root` into `folder`.
    pub fn compile(root: &Path, folder: &Path, clock: Clock) -> Self {
        let program = folder.join("stock_cvodes");
        let source = root.join("benches/ffi_overhead/stock.c");
        let mut compile = Command::new("cc");
        compile.args(["-O3", "-o"]).arg(&program).arg(&source);
        compile.arg(match clock {
            Clock::Wall => "-DCLOCK=CLOCK_MONOTONIC",
            Clock::Cpu => "-DCLOCK=CLOCK_THREAD_CPUTIME_ID",
        });
        if let Ok(directory) = std::env::var("SUNDIALS_INCLUDE_DIR") {
            compile.arg(format!("-I{directory}"));
        }
        if let Ok(directory) = std::env::var("SUNDIALS_LIBRARY_DIR") {
            compile.args([format!("-L{directory}"), format!("-Wl,-rpath,{directory}")]);
        }
        if sundials::version().starts_with('7') {
            compile.arg("-lsundials_core");
        }
        compile.args([
            "-lsundials_cvodes",
            "-lsundials_nvecserial",
            "-lsundials_sunlinsoldense",
            "-lsundials_sunmatrixdense",
            "-lm",
        ]);
        let status = compile.status().expect("a C compiler, as `cc`");
        assert!(status.success(), "{} can't be compiled", source.display());
        Program(program)
    }

    /// A child for one scene; `None` for a law that it does not know.
    pub fn start(&self, law: AnyLaw, loading: Loading, y0: &State<3>) -> Option<Stock> {
        // v = a(tau) / (c + p psi)^beta, dpsi/dt = h - (q + |v|) psi, with a = gamma0 sinh(tau) or gamma0/2 exp(tau).
        let (beta, gamma0, [c, p, h, q], odd) = match law {
            AnyLaw::Spinodal(law) => {
                let heal = 1.0 / law.r;
                (law.beta, law.gamma0, [law.c, 1.0 + law.r, heal, heal], 1.0)
            }
            AnyLaw::DieterichRuina(law) => (law.beta, law.gamma0, [0.0, 1.0, 1.0, 0.0], 0.0),
            _ => return None,
        };
        let Loading { driving, stiffness } = loading;
        let numbers = [
            stiffness, driving, beta, gamma0, c, p, h, q, odd, y0[0], y0[1], y0[2],
        ];
        let mut child = Command::new(&self.0)
            .args(numbers.map(|x| format!("{x:e}")))
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .expect("the program just compiled");
        Some(Stock {
            input: child.stdin.take().expect("piped"),
            output: BufReader::new(child.stdout.take().expect("piped")),
            child,
        })
    }
}

/// What it is asked.
pub struct Question<'a> {
    /// `bdf` or `adams` for the state, `tangent` for both by BDF.
    what: &'a str,
    tolerance: f64,
    end: f64,
    repeat: u64,
}

impl<'a> Question<'a> {
    pub fn new(what: &'a str, tolerance: f64, end: f64, repeat: u64) -> Self {
        Question {
            what,
            tolerance,
            end,
            repeat,
        }
    }
}

/// One answer: time of all repeats, steps of one, state, and tangent if asked for.
pub struct Answer {
    pub time: Duration,
    pub steps: usize,
    pub y: State<3>,
    pub m: Option<Jacobian<3>>,
}

/// A child.
pub struct Stock {
    child: Child,
    input: ChildStdin,
    output: BufReader<ChildStdout>,
}

impl Stock {
    /// The answer, or what failed.
    pub fn ask(&mut self, question: &Question<'_>) -> Result<Answer, String> {
        let Question {
            what,
            tolerance,
            end,
            repeat,
        } = question;
        let gone = |error: std::io::Error| format!("the C program is gone: {error}");
        writeln!(self.input, "{what} {tolerance:e} {end:e} {repeat}").map_err(gone)?;
        let mut line = String::new();
        self.output.read_line(&mut line).map_err(gone)?;
        let numbers: Result<Vec<f64>, _> = line.split_whitespace().map(str::parse).collect();
        let numbers = numbers.map_err(|_| line.trim().to_owned())?;
        if numbers.len() < 5 {
            return Err(format!("the C program answered {line:?}"));
        }
        Ok(Answer {
            time: Duration::from_secs_f64(numbers[0]),
            steps: numbers[1] as usize,
            y: State::from_column_slice(&numbers[2..5]),
            m: (numbers.len() == 14).then(|| Jacobian::from_column_slice(&numbers[5..])),
        })
    }
}

impl Drop for Stock {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}
