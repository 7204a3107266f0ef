//! When each value is used next.

use crate::operations::{Operation, Operations, Value};

/// Not used any more.
pub const NEVER: u32 = u32::MAX;

/// The next use of every value, as the operations are gone through in order.
#[derive(Debug)]
pub struct Uses {
    /// The next use of each value from now on.
    next: Vec<u32>,
    /// For each operation and operand the use of the operand after it.
    after: Vec<[u32; 3]>,
}

impl Uses {
    /// Before the first operation. What no store needs has no use.
    pub fn of(operations: &Operations) -> Self {
        let list = operations.list();
        let mut next = vec![NEVER; list.len()];
        let mut after = vec![[NEVER; 3]; list.len()];
        for (at, (operation, _)) in list.iter().enumerate().rev() {
            let is_store = matches!(operation, Operation::Store(..));
            if !is_store && next[at] == NEVER {
                continue;
            }
            let mut operand = 0;
            operation.for_each_operand(|value| {
                after[at][operand] = next[value.index()];
                operand += 1;
            });
            operation.for_each_operand(|value| next[value.index()] = at as u32);
        }
        Uses { next, after }
    }

    /// The first use of a value from now on, which may be the operation at hand.
    pub fn next(&self, value: Value) -> u32 {
        self.next[value.index()]
    }

    /// The use of an operand after this operation.
    pub fn after(&self, at: usize, operation: &Operation, value: Value) -> u32 {
        let (mut operand, mut found) = (0, NEVER);
        operation.for_each_operand(|other| {
            if other == value {
                found = self.after[at][operand];
            }
            operand += 1;
        });
        found
    }

    /// Goes on behind this operation.
    pub fn pass(&mut self, at: usize, operation: &Operation) {
        let mut operand = 0;
        operation.for_each_operand(|value| {
            self.next[value.index()] = self.after[at][operand];
            operand += 1;
        });
    }
}
