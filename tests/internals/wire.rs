//! Rows as bytes.

use twinslip::equilibrium::Symmetry;
use twinslip::number::Uncertain;
use twinslip::section::Regime;
use twinslip::sweep::SweepRow;
use twinslip_cli::internals::{pack, unpack};

#[test]
fn rows_come_back_to_the_bit() {
    let parameters = vec![0.1, 1.0 / 3.0, -2.0];
    let start = vec![11.3, f64::MIN_POSITIVE.ln(), -0.0];
    let mut full = SweepRow::new(7, parameters, start, Regime::Periodic);
    full.symmetry = Some(Symmetry::Asymmetric);
    full.returns_per_period = Some(3);
    full.period = Some(1e300);
    full.range = Some((-1.5, 12.0));
    full.lyapunov_max = Some(Uncertain::new(-1e-3, f64::INFINITY));
    full.returns = 1234;
    full.note = Some("a note, \"quoted\": ψ".into());
    let empty = SweepRow::new(8, Vec::new(), Vec::new(), Regime::Undecided);
    let rows = vec![full, empty];
    let bytes = pack(&rows);
    assert_eq!(unpack(&bytes), Some(rows));
    assert_eq!(unpack(&[]), Some(Vec::new()));
    assert_eq!(unpack(&bytes[..bytes.len() - 1]), None);
}
