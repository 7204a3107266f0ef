//! Peers that are other programs: plain C, and Python.

use crate::common::scene::Problem;
use crate::peer::{Answer, Peer, Question};
use crate::stock;
use std::cell::RefCell;
use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::rc::Rc;

/// Plain C with stock CVODES.
pub struct Stock {
    name: &'static str,
    what: &'static str,
    child: stock::Stock,
    until: f64,
}

/// BDF, which makes tangents too, and Adams.
pub fn c(problem: &Problem, program: &stock::Program, tangent: bool) -> Vec<Box<dyn Peer>> {
    let methods = [("C cvode-bdf", "bdf"), ("C cvode-adams", "adams")];
    let wanted = methods
        .into_iter()
        .filter(|(_, what)| !tangent || *what == "bdf");
    let peer = |(name, what)| -> Option<Box<dyn Peer>> {
        let child = program.start(problem.law, problem.loading, &problem.start)?;
        Some(Box::new(Stock {
            name,
            what,
            child,
            until: problem.until,
        }))
    };
    wanted.filter_map(peer).collect()
}

impl Peer for Stock {
    fn name(&self) -> &str {
        self.name
    }

    fn ask(&mut self, question: &Question) -> Result<Answer, String> {
        let what = if question.tangent {
            "tangent"
        } else {
            self.what
        };
        let repeat = u64::from(question.repeat);
        let asked = stock::Question::new(what, question.tolerance, self.until, repeat);
        let answer = self.child.ask(&asked)?;
        Ok(Answer {
            seconds: answer.time.as_secs_f64() / repeat as f64,
            steps: Some(answer.steps),
            end: answer.y.into(),
            tangent: answer
                .m
                .map(|m| std::array::from_fn(|i| std::array::from_fn(|j| m[(i, j)]))),
        })
    }
}

/// A Python script that answers questions on one scene.
struct Script {
    child: Child,
    input: ChildStdin,
    output: BufReader<ChildStdout>,
}

impl Script {
    fn start(root: &Path, script: &str, problem: &Problem) -> Result<Self, String> {
        let python = std::env::var("PEERS_PYTHON").unwrap_or_else(|_| "python3".into());
        let start: [f64; 3] = problem.start.into();
        let mut child = Command::new(python)
            .arg(root.join("benches/peers/python").join(script))
            .arg(root.join("scenes").join(format!("{}.toml", problem.name)))
            .args([problem.until, start[0], start[1], start[2]].map(|x| format!("{x:e}")))
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .map_err(|error| format!("{script}: {error}"))?;
        Ok(Script {
            input: child.stdin.take().expect("piped"),
            output: BufReader::new(child.stdout.take().expect("piped")),
            child,
        })
    }

    /// A line for a line.
    fn ask(&mut self, line: &str) -> Result<String, String> {
        let gone = |error: std::io::Error| format!("the script is gone: {error}");
        writeln!(self.input, "{line}").map_err(gone)?;
        let mut answer = String::new();
        self.output.read_line(&mut answer).map_err(gone)?;
        Ok(answer)
    }
}

impl Drop for Script {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// One method of a script, which several share.
pub struct Python {
    name: String,
    method: String,
    script: Rc<RefCell<Script>>,
}

/// The methods of all scripts; what is not installed is told and left out.
pub fn python(root: &Path, problem: &Problem, tangent: bool) -> Vec<Box<dyn Peer>> {
    let mut peers: Vec<Box<dyn Peer>> = Vec::new();
    let flows: [(&str, &[&str]); 2] = [
        ("scipy_peer.py", &["Radau", "LSODA", "DOP853"]),
        ("heyoka_peer.py", &["taylor", "batch"]),
    ];
    let tangents: [(&str, &[&str]); 1] = [("heyoka_peer.py", &["taylor"])];
    let scripts = if tangent { &tangents[..] } else { &flows[..] };
    for (file, methods) in scripts {
        let script = Script::start(root, file, problem).and_then(|mut script| {
            let hello = script.ask("hello")?;
            Ok((script, hello.trim().to_owned()))
        });
        match script {
            Ok((script, hello)) if !hello.is_empty() => {
                let script = Rc::new(RefCell::new(script));
                for method in *methods {
                    peers.push(Box::new(Python {
                        name: format!("{hello} {method}"),
                        method: (*method).to_owned(),
                        script: Rc::clone(&script),
                    }));
                }
            }
            Ok(_) => println!("{file} does not start: left out"),
            Err(error) => println!("{error}: left out"),
        }
    }
    peers
}

impl Peer for Python {
    fn name(&self) -> &str {
        &self.name
    }

    fn ask(&mut self, question: &Question) -> Result<Answer, String> {
        let what = if question.tangent { "tangent" } else { "flow" };
        let Question {
            tolerance, repeat, ..
        } = question;
        let line = format!("{} {what} {tolerance:e} {repeat}", self.method);
        let answer = self.script.borrow_mut().ask(&line)?;
        let numbers: Result<Vec<f64>, _> = answer.split_whitespace().map(str::parse).collect();
        let numbers = numbers.map_err(|_| answer.trim().to_owned())?;
        let [seconds, steps, end @ ..] = &numbers[..] else {
            return Err("the script ended".into());
        };
        if end.len() != if question.tangent { 12 } else { 3 } {
            return Err(format!("the script answered {answer:?}"));
        }
        let row = |i: usize| std::array::from_fn(|j| end[3 + 3 * i + j]);
        Ok(Answer {
            seconds: *seconds,
            steps: Some(*steps as usize),
            end: std::array::from_fn(|i| end[i]),
            tangent: question.tangent.then(|| std::array::from_fn(row)),
        })
    }
}
