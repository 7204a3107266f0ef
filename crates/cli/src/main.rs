//! The command line: see `twinslip --help`.

fn main() -> std::process::ExitCode {
    twinslip_cli::main(std::env::args_os())
}
