//! The runs of tests/data/trajectories.json: problems with end states of twenty certain digits.

use nalgebra::SVector;
use serde_json::Value;
use twinslip::field::State;
use twinslip::friction::{AnyLaw, Parameters};
use twinslip::model::Loading;

/// One run of two interfaces, and where it ends.
pub struct Run {
    /// The scene's name and its end time.
    pub name: String,
    pub law: AnyLaw,
    pub loading: Loading,
    /// (tau, ln psi1, ln psi2) at t = 0.
    pub start: State<3>,
    pub end_time: f64,
    /// (tau, psi1, psi2) at the end.
    pub end: [f64; 3],
}

impl Run {
    /// All runs, every end of a scene one of them.
    pub fn all() -> Vec<Run> {
        let file: Value = serde_json::from_str(include_str!("../data/trajectories.json")).unwrap();
        let scenes = file["scenes"].as_object().unwrap().iter();
        scenes.flat_map(|(name, scene)| runs(name, scene)).collect()
    }

    /// The run with this name, such as `D_K0.2_VH0.102_torus, t = 6000`.
    #[allow(dead_code, reason = "not every test asks for one run")]
    pub fn named(name: &str) -> Run {
        let mut all = Run::all().into_iter();
        all.find(|run| run.name == name).expect(name)
    }

    /// Starts on the symmetric subspace, which a run in three dimensions leaves by rounding.
    #[allow(dead_code, reason = "not every test integrates the symmetric run")]
    pub fn is_symmetric(&self) -> bool {
        self.start[1] == self.start[2]
    }

    /// The largest relative error of (tau, psi1, psi2), from (tau, ln psi1, ln psi2) or (tau, ln psi).
    pub fn error<const N: usize>(&self, y: &SVector<f64, N>) -> f64 {
        let relative = |i: usize| {
            let value = if i == 0 { y[0] } else { y[i].exp() };
            (value / self.end[i] - 1.0).abs()
        };
        (0..N).map(relative).fold(0.0, f64::max)
    }
}

fn runs(name: &str, scene: &Value) -> Vec<Run> {
    let parameters = Parameters::heslot_1994();
    let law = match scene["law"].as_str().unwrap() {
        "spinodal(35)" => AnyLaw::Spinodal(parameters.spinodal()),
        "Dieterich-Ruina(4/8)" => AnyLaw::DieterichRuina(parameters.dieterich_ruina()),
        other => panic!("the law {other} of {name}"),
    };
    let loading = Loading::new(number(&scene["V_H"]), number(&scene["K"])).unwrap();
    let [tau, first, second] = numbers(&scene["y0(tau,psi1,psi2)"]);
    let start = State::<3>::new(tau, first.ln(), second.ln());
    let ends = scene["ends"].as_object().unwrap().iter();
    ends.map(|(time, end)| {
        let exact = end.get("y_end_f64inputs").filter(|end| !end.is_null());
        Run {
            name: format!("{name}, t = {time}"),
            law,
            loading,
            start,
            end_time: time.parse().unwrap(),
            end: numbers(exact.unwrap_or(&end["y_end"])),
        }
    })
    .collect()
}

fn number(value: &Value) -> f64 {
    value.as_str().unwrap().parse().unwrap()
}

fn numbers(values: &Value) -> [f64; 3] {
    std::array::from_fn(|i| number(&values[i]))
}
