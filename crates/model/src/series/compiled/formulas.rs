//! The formulas of this process and their kernels, which live as long as it does.
//!
//! A formula is known by its [`Shape`]: solutions of one formula at other parameters, from other starts or in other threads share its
//! kernels, and the steps that are made of it are counted together.

use super::data::Layout;
use super::recurrences::operations;
use super::shape::{Shape, Step};
use crate::series::MAX_ORDER;
use crate::series::compiling::{Compiling, used};
use crate::series::placed::Products;
use std::collections::HashMap;
use std::hash::Hash;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, LazyLock, Mutex, OnceLock, PoisonError};
use twinslip_kernel::{Kernel, Operations, compile};

/// Steps after which compiling a formula saves more time than it takes, about.
const STEPS: usize = 500;
/// The most bytes of a kernel: straight-line code outgrows the processor's first cache at a tenth of this, and its second one here.
const LONGEST: usize = 256 * 1024;
/// The most operations that are looked at, and the lowest order of steps.
pub const MOST_OPERATIONS: usize = 50_000;
pub const LOWEST_ORDER: usize = 12;
/// The most bytes of all kernels together, and the most formulas that are remembered. Nothing is forgotten: more are interpreted.
const MOST_CODE: usize = 64 * 1024 * 1024;
const MOST_FORMULAS: usize = 4096;

/// When a kernel is made.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum When {
    /// Before the first step.
    AtOnce,
    /// After so many steps that it saves time.
    InTime,
}

impl When {
    /// As the user allows; `None` for never.
    pub fn allowed() -> Option<Self> {
        match used() {
            Compiling::Off => None,
            Compiling::On => Some(When::InTime),
            Compiling::Always => Some(When::AtOnce),
        }
    }
}

/// The bytes of all kernels.
static CODE: AtomicUsize = AtomicUsize::new(0);

/// The kernels for something, by the order of the series.
#[derive(Debug, Default)]
pub struct Kernels {
    /// How many steps have been made.
    steps: AtomicUsize,
    by_order: [OnceLock<Option<Kernel>>; MAX_ORDER + 1],
}

impl Kernels {
    /// The kernel for an order, made of these operations where enough steps have been made; another step is counted else.
    pub fn kernel(
        &self,
        (order, when): (usize, When),
        operations: impl FnOnce() -> Option<Operations>,
    ) -> Option<&Kernel> {
        let kernel = self.by_order.get(order)?;
        if let Some(made) = kernel.get() {
            return made.as_ref();
        }
        let steps = self.steps.fetch_add(1, Ordering::Relaxed);
        if steps < STEPS && when == When::InTime {
            return None;
        }
        let made = || {
            if CODE.load(Ordering::Relaxed) >= MOST_CODE {
                return None;
            }
            let kernel = compile(&operations()?, LONGEST)?;
            CODE.fetch_add(kernel.size(), Ordering::Relaxed);
            Some(kernel)
        };
        kernel.get_or_init(made).as_ref()
    }
}

/// Kernels by what they are for.
pub struct Known<K>(LazyLock<Mutex<HashMap<K, Arc<Kernels>>>>);

impl<K: Hash + Eq> Known<K> {
    pub const fn new() -> Self {
        Known(LazyLock::new(Mutex::default))
    }

    /// The kernels for this; `None` where too much is known.
    pub fn kernels(&self, of: K) -> Option<Arc<Kernels>> {
        let mut known = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(kernels) = known.get(&of) {
            return Some(Arc::clone(kernels));
        }
        if known.len() >= MOST_FORMULAS {
            return None;
        }
        let kernels = Arc::new(Kernels::default());
        known.insert(of, Arc::clone(&kernels));
        Some(kernels)
    }
}

static FORMULAS: Known<Arc<Shape>> = Known::new();

/// A formula, and its kernels.
#[derive(Debug, Clone)]
pub struct Formula {
    shape: Arc<Shape>,
    layout: Layout,
    kernels: Arc<Kernels>,
}

impl Formula {
    /// `None` where it is not compiled.
    pub fn of(shape: Shape) -> Option<Self> {
        if operations_at_least(&shape, LOWEST_ORDER) > MOST_OPERATIONS {
            return None;
        }
        let shape = Arc::new(shape);
        let kernels = FORMULAS.kernels(Arc::clone(&shape))?;
        Some(Formula {
            layout: Layout::of(&shape),
            shape,
            kernels,
        })
    }

    pub fn shape(&self) -> &Shape {
        &self.shape
    }

    pub fn layout(&self) -> &Layout {
        &self.layout
    }

    /// The kernel for an order, once enough steps have been made.
    pub fn kernel(&self, order: usize, when: When) -> Option<&Kernel> {
        self.kernels.kernel((order, when), || {
            (operations_at_least(&self.shape, order) <= MOST_OPERATIONS)
                .then(|| operations(&self.shape, &self.layout, order))
        })
    }
}

/// Fewer operations than this there are not.
fn operations_at_least(shape: &Shape, order: usize) -> usize {
    let of_step = |step: &Step| match step {
        Step::Sum { terms, .. } => terms.len() * order,
        Step::Recurrence(one) => {
            let sums = match one.products {
                Products::Nothing => 0,
                Products::One(_) => 1,
                Products::Two(_) | Products::Shared(..) => 2,
            };
            (1 + sums * order / 2) * order
        }
    };
    shape.steps.iter().map(of_step).sum()
}
