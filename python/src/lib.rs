//! The bridge to Python: commands that run, their rows as arrays, their options told.
//!
//! The Python side, in `python/twinslip`, has the words that users see.

mod explore;
mod ivp;
mod run;
mod table;
mod threads;
mod timing;

use explore::{Asked, explore_begin, explore_script, explore_style};
use ivp::{IvpRun, Solution, solve_ivp};
use pyo3::prelude::*;
use run::{Picture, Run};
use timing::timed;
use twinslip_cli::{OptionInfo, commands, options, scene_words};

/// An option: name, whether it is positional, kind, form, whether it may be given again, default, heading, help.
type Told = (
    String,
    bool,
    &'static str,
    String,
    bool,
    Option<String>,
    String,
    String,
);

fn told(option: OptionInfo) -> Told {
    (
        option.name,
        option.positional,
        option.kind.name(),
        option.form,
        option.repeated,
        option.default,
        option.heading,
        option.help,
    )
}

/// The compiled part of twinslip.
#[pymodule]
mod _core {
    use super::*;

    #[pymodule_export]
    use super::{
        Asked, IvpRun, Picture, Run, Solution, explore_begin, explore_script, explore_style,
        solve_ivp, timed,
    };

    /// The version of twinslip.
    #[pyfunction]
    fn version() -> &'static str {
        env!("CARGO_PKG_VERSION")
    }

    /// The version of SUNDIALS, or None in a build without it.
    #[pyfunction]
    fn sundials() -> Option<String> {
        twinslip_cli::sundials()
    }

    /// The words of a scene, without what says where results go.
    #[pyfunction]
    #[pyo3(name = "scene")]
    fn scene_told(path: std::path::PathBuf) -> PyResult<Vec<String>> {
        scene_words(&path)
            .map_err(|error| pyo3::exceptions::PyValueError::new_err(error.to_string()))
    }

    /// The scenes that are built in.
    #[pyfunction]
    fn scenes() -> Vec<&'static str> {
        twinslip_tasks::scene::shipped_names()
    }

    /// The commands, each with what it does.
    #[pyfunction]
    #[pyo3(name = "commands")]
    fn commands_told() -> Vec<(String, String)> {
        commands()
    }

    /// The options of a command.
    #[pyfunction]
    #[pyo3(name = "options")]
    fn options_told(command: &str) -> Vec<Told> {
        options(command).into_iter().map(told).collect()
    }
}
