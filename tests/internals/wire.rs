//! Rows as bytes.

use twinslip::equilibrium::Symmetry;
use twinslip::internals::{pack, unpack};
use twinslip::number::Uncertain;
use twinslip::section::Regime;
use twinslip::sweep::SweepRow;

#[test]
fn rows_come_back_to_the_bit() {
    let full = SweepRow {
        number: 7,
        driving: 0.1,
        stiffness: 1.0 / 3.0,
        start: [11.3, f64::MIN_POSITIVE.ln(), -0.0],
        regime: Regime::Periodic,
        symmetry: Some(Symmetry::Asymmetric),
        returns_per_period: Some(3),
        period: Some(1e300),
        stress_range: Some((-1.5, 12.0)),
        lyapunov_max: Some(Uncertain::new(-1e-3, f64::INFINITY)),
        returns: 1234,
        note: Some("a note, \"quoted\": ψ".into()),
    };
    let empty = SweepRow {
        number: 8,
        regime: Regime::Undecided,
        symmetry: None,
        returns_per_period: None,
        period: None,
        stress_range: None,
        lyapunov_max: None,
        returns: 0,
        note: None,
        ..full.clone()
    };
    let rows = vec![full, empty];
    let bytes = pack(&rows);
    assert_eq!(unpack(&bytes), Some(rows));
    assert_eq!(unpack(&[]), Some(Vec::new()));
    assert_eq!(unpack(&bytes[..bytes.len() - 1]), None);
}
