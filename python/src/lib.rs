//! The compiled part of the Python package `twinslip`: the module `twinslip._core`.

use pyo3::prelude::*;

/// The compiled part of twinslip; what it has is for the package alone.
#[pymodule]
mod _core {
    use pyo3::prelude::*;

    /// The version of twinslip.
    #[pyfunction]
    fn version() -> &'static str {
        env!("CARGO_PKG_VERSION")
    }

    /// The version of SUNDIALS, or None in the build without C.
    #[pyfunction]
    fn sundials() -> Option<&'static str> {
        #[cfg(feature = "sundials")]
        return Some(twinslip::sundials::version());
        #[cfg(not(feature = "sundials"))]
        None
    }
}
