//! The command line.

use twinslip_cli::internals::program;
#[test]
fn arguments_are_consistent() {
    program().debug_assert();
}
