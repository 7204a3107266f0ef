//! Scene files as benchmark problems: field, start, end time.

use clap::{CommandFactory, Parser};
use std::path::Path;
use twinslip::field::State;
use twinslip::friction::AnyLaw;
use twinslip::model::{Driven, Loading, two_interfaces};
use twinslip_tasks::scene::{IntegrateOptions, Plan, SceneFile};

/// The scenes of every comparison, from easy to odd: stick-slip at three driving velocities, soft systems, the torus, a
/// strongly damped and a stiff relaxation, and the other law.
pub const SCENES: [&str; 9] = [
    "relaxation-1",
    "relaxation-10",
    "relaxation-100",
    "asymmetric",
    "fig11",
    "fig13",
    "damped",
    "stiff",
    "fig03a",
];

/// Scenes whose cycles have a tangent flow worth having, when a cycle begins there and how long it is, to some per cent: any
/// time near it is as hard.
pub const CYCLES: [(&str, f64, f64); 2] =
    [("relaxation-10", 32.0, 3.13), ("asymmetric", 4000.0, 460.0)];

/// What a scene file may hold here.
#[derive(Parser)]
enum Program {
    Integrate(IntegrateOptions),
}

/// A run of two interfaces.
#[derive(Clone)]
pub struct Problem {
    /// The file's name without `.toml`.
    pub name: String,
    /// The law of both interfaces.
    pub law: AnyLaw,
    /// V_H and K.
    pub loading: Loading,
    /// (tau, ln psi1, ln psi2) at t = 0.
    pub start: State<3>,
    /// When it ends.
    pub until: f64,
}

impl Problem {
    /// The scene `scenes/NAME.toml` below the repository's `root`.
    pub fn load(root: &Path, name: &str) -> Self {
        let path = root.join("scenes").join(format!("{name}.toml"));
        let read = || -> twinslip::Result<Plan> {
            let scene = SceneFile::read(&path, &Program::command())?;
            let words = std::iter::once("twinslip".to_owned()).chain(scene.arguments(&[]));
            let Program::Integrate(options) = Program::parse_from(words);
            Plan::new(&options)
        };
        let plan = read().unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        let [tau, w1, w2] = plan.start.as_slice() else {
            panic!("{name} is not in 3-D");
        };
        let (system, loading) = plan.system.closed_forms().expect("a built-in law");
        Problem {
            name: name.to_owned(),
            law: system.law,
            loading,
            start: State::<3>::new(*tau, *w1, *w2),
            until: plan.until,
        }
    }

    /// The same with another end.
    pub fn until(&self, until: f64) -> Self {
        Problem {
            until,
            ..self.clone()
        }
    }

    /// The system (19) of this scene.
    pub fn field(&self) -> Box<dyn Driven<3>> {
        two_interfaces(self.law, self.loading)
    }

    /// Name and parameters, for a reader.
    pub fn title(&self) -> String {
        let Loading { driving, stiffness } = self.loading;
        let law = match self.law {
            AnyLaw::DieterichRuina(_) => ", Dieterich-Ruina law",
            _ => "",
        };
        format!(
            "{}: K = {stiffness}, V_H = {driving}, t = {}{law}",
            self.name, self.until
        )
    }
}

/// The largest relative error of (tau, psi1, psi2) in `y`, both in (tau, ln psi1, ln psi2).
pub fn state_error(y: &State<3>, exact: &State<3>) -> f64 {
    let stress = (y[0] / exact[0] - 1.0).abs();
    (1..3).fold(stress, |error, i| {
        error.max((y[i] - exact[i]).exp_m1().abs())
    })
}
