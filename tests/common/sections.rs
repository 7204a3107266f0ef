//! Runs of two interfaces to the paper's section, and what they settle on.

use super::heard::spinodal;
use nalgebra::{Complex, DMatrix};
use twinslip::field::Vector;
use twinslip::friction::AnyLaw;
use twinslip::integrate::{AnyField, AnyIntegrator, Choice, Control, MAX_STEPS, Tolerances};
use twinslip::model::{Loading, two_interfaces};
use twinslip::number::polynomial::Crossing;
use twinslip::section::{
    Periodic, RegimeVerdict, ReturnRecord, Surface, Watching, half_driving_stress, record,
    return_map, verdict,
};

/// Two interfaces with the paper's section.
pub struct Case {
    pub field: AnyField<'static>,
    pub surface: Surface,
    pub law: AnyLaw,
    pub v: f64,
}

impl Case {
    pub fn new(law: AnyLaw, k: f64, v: f64) -> Self {
        Case {
            field: AnyField::new::<3>(two_interfaces(law, Loading::new(v, k).unwrap())),
            surface: Surface::stress(3, half_driving_stress(&law, v, 2), Crossing::Downwards),
            law,
            v,
        }
    }

    pub fn paper(k: f64, v: f64) -> Self {
        Self::new(spinodal(), k, v)
    }

    /// psi_2 off the symmetric steady state by exp(asymmetry).
    pub fn near_symmetric(&self, asymmetry: f64) -> Vector {
        use twinslip::friction::Formulas;
        let w = self.law.steady_state(0.5 * self.v).ln();
        Vector::from_vec(vec![self.surface.offset, w, w + asymmetry])
    }

    pub fn record(
        &self,
        method: &str,
        rtol: f64,
        start: Vector,
        count: (usize, usize),
    ) -> ReturnRecord {
        let watching = Watching {
            skip: count.0,
            returns: count.1,
            patience: 2e4,
            accuracy: rtol,
            max_step: f64::INFINITY,
            waypoints: true,
        };
        let (choice, rtol) = (Choice::named(method).unwrap(), Tolerances::equal(rtol));
        let mut integrator = AnyIntegrator::new(choice, rtol.unwrap(), MAX_STEPS).unwrap();
        let see = &mut |_: usize, _: Option<&_>| Control::Continue;
        record(
            &mut integrator,
            &self.field,
            &start,
            &self.surface,
            &watching,
            see,
        )
    }

    pub fn verdict(&self, record: &ReturnRecord) -> RegimeVerdict {
        verdict(&self.field, &self.surface, record, None).unwrap()
    }

    pub fn periodic(&self, record: &ReturnRecord) -> Periodic {
        let verdict = self.verdict(record);
        verdict
            .periodic
            .clone()
            .unwrap_or_else(|| panic!("{verdict:?}"))
    }

    /// The fixed point of the map near a state, stable or not, by Newton's method on (ln psi_1, ln psi_2), and its multipliers.
    pub fn fixed_point(&self, near: Vector) -> (Vector, [Complex<f64>; 2]) {
        let tolerances = Tolerances::equal(1e-13).unwrap();
        let mut taylor = AnyIntegrator::new(Choice::Taylor, tolerances, MAX_STEPS).unwrap();
        let mut y = near.clone();
        y[0] = self.surface.offset;
        for _ in 0..30 {
            let to = return_map(&self.field, &self.surface, &mut taylor, &y, 2e4).unwrap();
            let d = DMatrix::from_fn(2, 2, |i, j| to.derivative[(i + 1, j + 1)]);
            let r = DMatrix::from_fn(2, 1, |i, _| to.state[i + 1] - y[i + 1]);
            let step = (DMatrix::identity(2, 2) - &d).lu().solve(&r).unwrap();
            (y[1], y[2]) = (y[1] + step[0], y[2] + step[1]);
            if step.amax() < 1e-11 {
                let mu = d.complex_eigenvalues();
                return (y, [mu[0], mu[1]]);
            }
        }
        panic!("no fixed point near {near}");
    }
}

/// At K = 0.14 the orbit that is born at the Hopf point of the asymmetric equilibria, followed from V_H = 0.07, where it
/// attracts everything; and its multipliers.
pub fn orbit_beyond_hopf(v: f64) -> (Vector, [Complex<f64>; 2]) {
    let case = Case::paper(0.14, 0.07);
    let record = case.record("auto", 1e-10, case.near_symmetric(0.01), (200, 60));
    let mut point = case.periodic(&record).point;
    for i in 1..10 {
        let case = Case::paper(0.14, 0.07 + (v - 0.07) * f64::from(i) / 10.0);
        point = case.fixed_point(point).0;
    }
    let case = Case::paper(0.14, v);
    case.fixed_point(point)
}

pub fn mean(record: &ReturnRecord) -> Vector {
    let states = record.returns.iter().map(|r| &r.state);
    states.sum::<Vector>() / record.returns.len() as f64
}
