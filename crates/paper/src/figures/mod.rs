//! The figures of the paper, one a file; what several share of drawing is in [`curve`], [`runs`] and [`plane`].

mod curve;
mod plane;
mod regimes;
mod runs;

pub mod fig01;
pub mod fig02;
pub mod fig03;
pub mod fig04;
pub mod fig05;
pub mod fig05_unfolded;
pub mod fig06;
pub mod fig06_unfolded;
pub mod fig07;
pub mod fig08;
pub mod fig09;
pub mod fig10;
pub mod fig11;
pub mod fig12;
pub mod fig13;
pub mod fig14;
pub mod fig15;
pub mod fig16;
pub mod fig17;
