//! Finds SUNDIALS and writes what the `sundials-sys` bindings lack. Without the feature `sundials` it does nothing.

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rustc-check-cfg=cfg(sundials_major, values(\"6\", \"7\"))");
    #[cfg(feature = "sundials")]
    if let Err(sentence) = sundials::bind() {
        println!("cargo::error={sentence}");
        std::process::exit(1);
    }
}

#[cfg(feature = "sundials")]
mod sundials {
    use bindgen::callbacks::{IntKind, ParseCallbacks};
    use std::collections::BTreeMap;
    use std::fmt::Write;
    use std::path::PathBuf;
    use std::sync::{Arc, Mutex};
    use std::{env, fs, panic};

    const HEADER: &str = "src/sundials/missing.h";
    const REMEDY: &str = "`apt-get install -y libsundials-dev libclang-dev` (or ./setup) installs what is needed, \
        SUNDIALS_INCLUDE_DIR and SUNDIALS_LIBRARY_DIR name another place, and `--no-default-features` builds without C";

    /// Tables of flags, as (name in Rust, prefix in C, non-negative flags that are return values).
    const TABLES: [(&str, &str, &[&str]); 5] = [
        (
            "CV",
            "CV_",
            &[
                "CV_SUCCESS",
                "CV_TSTOP_RETURN",
                "CV_ROOT_RETURN",
                "CV_WARNING",
            ],
        ),
        ("CVLS", "CVLS_", &["CVLS_SUCCESS"]),
        (
            "KIN",
            "KIN_",
            &[
                "KIN_SUCCESS",
                "KIN_INITIAL_GUESS_OK",
                "KIN_STEP_LT_STPTOL",
                "KIN_WARNING",
            ],
        ),
        ("KINLS", "KINLS_", &["KINLS_SUCCESS"]),
        // Of vectors, matrices, linear solvers and the context.
        ("SUN", "SUNLS_", &["SUNLS_SUCCESS"]),
    ];

    #[derive(Debug, Clone, Default)]
    struct Macros(Arc<Mutex<BTreeMap<String, i64>>>);

    impl ParseCallbacks for Macros {
        fn int_macro(&self, name: &str, value: i64) -> Option<IntKind> {
            self.0
                .lock()
                .expect("one thread")
                .insert(name.to_owned(), value);
            None
        }
    }

    pub fn bind() -> Result<(), String> {
        println!("cargo::rerun-if-changed={HEADER}");
        for variable in ["SUNDIALS_INCLUDE_DIR", "SUNDIALS_LIBRARY_DIR"] {
            println!("cargo::rerun-if-env-changed={variable}");
        }
        let macros = Macros::default();
        let bindings = generate(&macros)?;
        let macros = macros.0.lock().expect("one thread").clone();
        let major = check(&macros)?;
        println!("cargo::rustc-cfg=sundials_major=\"{major}\"");

        let out = PathBuf::from(env::var_os("OUT_DIR").expect("cargo sets OUT_DIR"));
        fs::write(out.join("missing.rs"), bindings).map_err(|e| e.to_string())?;
        fs::write(out.join("flags.rs"), flags(&macros)).map_err(|e| e.to_string())
    }

    fn generate(macros: &Macros) -> Result<String, String> {
        let builder = bindgen::Builder::default()
            .header(HEADER)
            .clang_args(include_arguments())
            .allowlist_function("SUNDIALSGetVersionNumber")
            .allowlist_function("CVodeSetErrHandlerFn|KINSetErrHandlerFn")
            .allowlist_function("SUNContext_(Push|Clear)ErrHandlers?")
            .allowlist_var("SUNDIALS_VERSION_(MAJOR|MINOR|PATCH)")
            .layout_tests(false)
            .parse_callbacks(Box::new(macros.clone()));
        // bindgen panics where it can't load libclang.
        let quiet = panic::take_hook();
        panic::set_hook(Box::new(|_| {}));
        let generated = panic::catch_unwind(panic::AssertUnwindSafe(|| builder.generate()));
        panic::set_hook(quiet);
        match generated {
            Err(_) => Err(format!("libclang can't be loaded: {REMEDY}")),
            Ok(Err(reason)) => {
                let reason = reason.to_string();
                let first = reason.lines().next().unwrap_or_default();
                Err(format!(
                    "the SUNDIALS headers can't be read ({first}): {REMEDY}"
                ))
            }
            // As Rust of 2024 has it, which the bindgen that sundials-sys brings does not know.
            Ok(Ok(bindings)) => Ok(bindings
                .to_string()
                .replace("extern \"C\" {", "unsafe extern \"C\" {")),
        }
    }

    fn include_arguments() -> Vec<String> {
        if let Ok(directory) = env::var("SUNDIALS_INCLUDE_DIR") {
            return vec![format!("-I{directory}")];
        }
        // Debian ships no pkg-config file for SUNDIALS; where there is one it knows better than the default path.
        pkg_config::Config::new()
            .cargo_metadata(false)
            .probe("sundials")
            .map(|library| {
                library
                    .include_paths
                    .iter()
                    .map(|p| format!("-I{}", p.display()))
                    .collect()
            })
            .unwrap_or_default()
    }

    /// The major version, if everything needed is there.
    fn check(macros: &BTreeMap<String, i64>) -> Result<i64, String> {
        let Some(&major) = macros.get("SUNDIALS_VERSION_MAJOR") else {
            return Err(format!("the SUNDIALS headers are not found: {REMEDY}"));
        };
        if !(6..=7).contains(&major) {
            return Err(format!(
                "SUNDIALS {major} is installed, but 6 or 7 is needed: {REMEDY}"
            ));
        }
        if !macros.contains_key("SUNDIALS_DOUBLE_PRECISION") {
            return Err(format!(
                "the SUNDIALS found is not in double precision: {REMEDY}"
            ));
        }
        for (part, flag) in [("CVODES", "CV_SUCCESS"), ("KINSOL", "KIN_SUCCESS")] {
            if !macros.contains_key(flag) {
                return Err(format!("the SUNDIALS found has no {part}: {REMEDY}"));
            }
        }
        Ok(major)
    }

    fn flags(macros: &BTreeMap<String, i64>) -> String {
        let mut text = String::new();
        for (table, prefix, outcomes) in TABLES {
            writeln!(text, "pub(crate) const {table}: &[(i32, &str)] = &[").expect("a String");
            for (name, value) in macros.iter().filter(|(name, _)| name.starts_with(prefix)) {
                if *value < 0 || outcomes.contains(&name.as_str()) {
                    writeln!(text, "    ({value}, \"{name}\"),").expect("a String");
                }
            }
            writeln!(text, "];").expect("a String");
        }
        text
    }
}
