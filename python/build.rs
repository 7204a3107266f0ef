//! Leaves the symbols out of the compiled part. Not by the option `strip` of maturin, which is another profile: all would be compiled once
//! more beside the command.

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    if std::env::var("CARGO_CFG_TARGET_OS").is_ok_and(|system| system == "linux") {
        println!("cargo::rustc-cdylib-link-arg=-s");
    }
}
