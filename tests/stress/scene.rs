//! What is integrated: a law, a loading, a start, and a time in which something happens.

use proptest::prelude::*;
use twinslip::friction::{AnyLaw, Parameters};
use twinslip::model::Loading;

/// One run, whatever the method.
#[derive(Debug, Clone, Copy)]
pub struct Scene {
    pub law: AnyLaw,
    pub loading: Loading,
    /// (tau, ln psi1, ln psi2); in two dimensions ln psi1 is that of both interfaces.
    pub start: [f64; 3],
    pub end: f64,
    /// 3, or 2 for the symmetric subspace.
    pub dimension: usize,
}

/// Which of a scene's own times its end is made of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Span {
    /// Three times the shortest.
    Short,
    /// Three times the longest.
    Long,
}

/// The parameters of the laws that a scene varies.
#[derive(Debug, Clone, Copy)]
pub struct Variety {
    pub law: usize,
    pub beta: f64,
    pub healing_time: f64,
    pub residual_strength: f64,
}

impl Variety {
    fn law(self) -> AnyLaw {
        let direct = 0.0349;
        let parameters = Parameters::new(
            direct,
            direct * self.beta,
            0.369,
            self.healing_time,
            self.residual_strength,
        );
        AnyLaw::named(AnyLaw::NAMES[self.law], parameters.expect("valid")).expect("known")
    }
}

impl Scene {
    pub fn new(
        variety: Variety,
        loading: Loading,
        (tau, psi): (f64, [f64; 2]),
        span: Span,
        dimension: usize,
    ) -> Self {
        let law = variety.law();
        Scene {
            law,
            loading,
            start: [tau, psi[0].ln(), psi[1].ln()],
            end: end(&law, &loading, variety.healing_time, span),
            dimension,
        }
    }
}

/// The times of a scene: in which the spring raises the stress by one, in which the slab moves by one, and in which a resting
/// interface heals where the law has such a time.
fn end(law: &AnyLaw, loading: &Loading, healing_time: f64, span: Span) -> f64 {
    let mut times = vec![
        1.0 / (loading.stiffness * loading.driving),
        1.0 / loading.driving,
    ];
    if matches!(law, AnyLaw::Spinodal(_) | AnyLaw::Bounded(_)) {
        times.push(healing_time);
    }
    times.sort_by(f64::total_cmp);
    3.0 * match span {
        Span::Short => times[0],
        Span::Long => times[times.len() - 1],
    }
}

const STIFFNESSES: [f64; 5] = [1e-6, 1e-3, 0.14, 10.0, 1e4];
const DRIVINGS: [f64; 5] = [1e-8, 1e-3, 1.0, 1e3, 1e8];
/// (tau, psi1, psi2), all far from where a scene comes to rest.
const STARTS: [(f64, [f64; 2]); 6] = [
    (10.0, [0.5, 1e-3]),
    (-50.0, [1.0, 1e-3]),
    (30.0, [1e-30, 0.2]),
    (500.0, [0.5, 1e-300]),
    (-5.0, [0.01, 0.9]),
    (15.0, [1.0, 1.0]),
];
const BETAS: [f64; 4] = [1.4, 0.3, 3.0, 0.9];
const HEALING_TIMES: [f64; 3] = [100.0, 1.0, 1e4];
const RESIDUAL_STRENGTHS: [f64; 4] = [1e-3, 0.0, 0.1, 1e-6];

/// Every law with every K, V_H, start and span; beta, R, c and the dimension go round at paces without a common divisor, so
/// that each meets each.
pub fn grid() -> Vec<Scene> {
    let mut scenes = Vec::new();
    for law in 0..AnyLaw::NAMES.len() {
        for stiffness in STIFFNESSES {
            for driving in DRIVINGS {
                for start in STARTS {
                    for span in [Span::Short, Span::Long] {
                        let i = scenes.len();
                        let variety = Variety {
                            law,
                            beta: BETAS[(i / 2) % 4],
                            healing_time: HEALING_TIMES[(i / 7) % 3],
                            residual_strength: RESIDUAL_STRENGTHS[(i / 5) % 4],
                        };
                        let loading = Loading::new(driving, stiffness).expect("valid");
                        let dimension = if i % 3 == 2 { 2 } else { 3 };
                        scenes.push(Scene::new(variety, loading, start, span, dimension));
                    }
                }
            }
        }
    }
    scenes
}

/// Random scenes, over the same ranges.
pub fn random() -> impl Strategy<Value = Scene> {
    let variety = (
        0..AnyLaw::NAMES.len(),
        0.3..3.0,
        0.0..4.0_f64,
        prop_oneof![1 => Just(f64::NEG_INFINITY), 4 => -6.0..-1.0_f64],
    )
        .prop_map(|(law, beta, log_r, log_c)| Variety {
            law,
            beta,
            healing_time: 10f64.powf(log_r),
            residual_strength: 10f64.powf(log_c),
        });
    let loading = (-8.0..8.0_f64, -6.0..4.0_f64)
        .prop_map(|(v, k)| Loading::new(10f64.powf(v), 10f64.powf(k)).expect("valid"));
    let tau = prop_oneof![6 => -20.0..60.0_f64, 1 => -500.0..500.0_f64];
    let log_psi = || prop_oneof![6 => -6.0..0.0_f64, 1 => -300.0..0.0_f64];
    let start = (tau, log_psi(), log_psi())
        .prop_map(|(tau, first, second)| (tau, [first, second].map(|x| 10f64.powf(x))));
    let span = prop_oneof![Just(Span::Short), Just(Span::Long)];
    (variety, loading, start, span, 2_usize..=3).prop_map(
        |(variety, loading, start, span, dimension)| {
            Scene::new(variety, loading, start, span, dimension)
        },
    )
}
