//! The command line: see `twinslip --help`.

fn main() -> std::process::ExitCode {
    twinslip::cli::main(std::env::args_os())
}
