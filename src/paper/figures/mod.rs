//! The figures of the paper, one a file.

mod curve;
pub mod fig01;
pub mod fig02;
pub mod fig04;
pub mod fig15;
pub mod fig17;
