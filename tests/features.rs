//! The tests of what differs between builds with the C solvers and without, with MPI and Parquet and without: they run in both.
#![allow(missing_docs, dead_code)]

mod command;
mod common;
mod drawn;

mod branches;
mod cli_faults;
mod cli_given;
mod cli_input;
mod cli_runs;
mod cli_units;
mod cli_words;
mod equilibria;
mod equilibria_random;
mod extremes;
mod internals;
mod orbits;
#[cfg(feature = "parquet")]
mod parquet;
mod scenes;
mod schema;
mod scorecard;
mod stress;
mod sweep_parts;
mod sweep_rows;
