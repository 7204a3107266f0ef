//! The command line.

use twinslip::internals::program;
#[test]
fn arguments_are_consistent() {
    program().debug_assert();
}
