//! What branches and curves hand on, kept; and how it is held against what is known.

use std::ops::ControlFlow::{self, Continue};
use twinslip::Result;
use twinslip::bifurcation::{BranchRow, Event, EventObserver, Label, LocusRow, Special};
use twinslip::friction::{AnyLaw, Parameters};
use twinslip::model::Loading;
use twinslip::number::Uncertain;
use twinslip::orbit::InterfaceSystem;

pub fn spinodal() -> AnyLaw {
    AnyLaw::Spinodal(Parameters::heslot_1994().spinodal())
}

pub fn slab(law: AnyLaw, interfaces: usize, driving: f64, stiffness: f64) -> InterfaceSystem {
    let loading = Loading::new(driving, stiffness).expect("a loading");
    InterfaceSystem {
        law,
        interfaces,
        loading,
    }
}

/// The slab of the paper.
pub fn two(driving: f64, stiffness: f64) -> InterfaceSystem {
    slab(spinodal(), 2, driving, stiffness)
}

#[derive(Default)]
pub struct Heard {
    pub rows: Vec<BranchRow>,
    pub points: Vec<LocusRow>,
    pub special: Vec<Special>,
}

impl Heard {
    /// All that is told by this.
    pub fn of_all(told: impl FnOnce(EventObserver<'_>) -> Result<()>) -> Self {
        let mut heard = Heard::default();
        told(&mut |event| heard.hear(event)).expect("branches or curves");
        heard
    }

    fn hear(&mut self, event: Event) -> ControlFlow<()> {
        match event {
            Event::Branch(row) => self.rows.push(row),
            Event::Locus(row) => self.points.push(row),
            Event::Special(special) => self.special.push(special),
        }
        Continue(())
    }

    pub fn of(&self, label: Label) -> Vec<&Special> {
        self.special.iter().filter(|s| s.label == label).collect()
    }

    /// The one of this label nearest to a V_H.
    pub fn nearest(&self, label: Label, driving: f64) -> &Special {
        let far = |s: &&Special| (s.driving.value / driving).ln().abs();
        let all = self.special.iter().filter(|s| s.label == label);
        all.min_by(|a, b| far(a).total_cmp(&far(b)))
            .unwrap_or_else(|| panic!("no {} near {driving}", label.name()))
    }

    /// What is special and where.
    pub fn list(&self) -> Vec<(Label, f64, f64)> {
        let all = self.special.iter();
        all.map(|s| (s.label, s.driving.value, s.stiffness.value))
            .collect()
    }
}

/// Within the bar, and within what is claimed; how many times the error that is, the rounding of a double being one at least.
#[track_caller]
pub fn assert_known(what: &str, found: Uncertain, exact: f64, bar: f64) -> f64 {
    let error = (found.value - exact).abs();
    assert!(error <= bar * exact.abs(), "{what}: {found:?}, not {exact}");
    assert!(
        error <= found.uncertainty + f64::EPSILON * exact.abs(),
        "{what}: {found:?} claims too much, {exact}"
    );
    found.uncertainty / error.max(0.5 * f64::EPSILON * exact.abs())
}

/// Of claims that are this many times the errors: a typical one is sharp, and none is useless.
#[track_caller]
pub fn assert_sharp_claims(mut ratios: Vec<f64>) {
    ratios.sort_by(f64::total_cmp);
    let (median, worst) = (ratios[ratios.len() / 2], ratios[ratios.len() - 1]);
    assert!(median <= 30.0, "median {median:.0} of {ratios:.1?}");
    assert!(worst <= 1e3, "{ratios:.1?}");
}

/// Within 1e-12, and within the budget, up to the rounding of the reference to a double; and the budget is small.
#[track_caller]
pub fn assert_sharp(what: &str, found: Uncertain, exact: f64) {
    let error = (found.value - exact).abs();
    assert!(
        error <= 1e-12 * exact.abs(),
        "{what}: {found:?}, not {exact}"
    );
    let off = error - 0.5 * f64::EPSILON * exact.abs();
    assert!(
        off <= found.uncertainty,
        "{what}: off by {off:e}, not {:e}",
        found.uncertainty
    );
    assert!(
        found.uncertainty <= 1e-11 * exact.abs(),
        "{what}: {:e}",
        found.uncertainty
    );
}

/// The same labels at the same places.
#[track_caller]
pub fn assert_same(usual: &[(Label, f64, f64)], other: &[(Label, f64, f64)], bar: f64) {
    let labels = |list: &[(Label, f64, f64)]| list.iter().map(|s| s.0).collect::<Vec<_>>();
    assert_eq!(labels(usual), labels(other));
    for (a, b) in usual.iter().zip(other) {
        for (a, b) in [(a.1, b.1), (a.2, b.2)] {
            assert!((a - b).abs() <= bar * b.abs(), "{a}, not {b}");
        }
    }
}
