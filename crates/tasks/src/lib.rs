//! What the commands of twinslip compute: options, checked plans, runs, rows and pictures. The command and the Python package are
//! made of it.

// Printing may fail, as nobody may read it: these macros would panic.
#![warn(clippy::print_stderr, clippy::print_stdout)]

pub mod scene;
pub mod views;
