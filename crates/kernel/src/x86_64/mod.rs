//! Code for x86-64 with AVX2 and FMA.

mod encode;
#[cfg(test)]
mod encode_tests;
mod registers;
mod uses;

use crate::operations::{Operation, Operations, Signs, Value, Width};
use crate::target::Target;
use encode::{Arithmetic, Encoder, Form, Operand, Register};
use registers::Registers;
use uses::{NEVER, Uses};

/// Frames above this are refused: the stack of a thread may be short.
const LARGEST_FRAME: usize = 64 * 1024;
/// Arrays of more doubles than this are refused: offsets in instructions are of 31 bits.
const LONGEST_ARRAY: usize = 1 << 27;

/// x86-64 with AVX2 and FMA, called as on all systems but Windows: the arrays in `rdi`, `rsi` and `rdx`.
pub struct Avx2;

impl Target for Avx2 {
    fn is_here() -> bool {
        is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma")
    }

    fn assemble(operations: &Operations, most_bytes: usize) -> Option<Vec<u8>> {
        if operations.extents().iter().any(|&n| n > LONGEST_ARRAY) {
            return None;
        }
        let list = operations.list();
        let widths = list.iter().map(|(_, width)| *width).collect();
        let mut code = Assembly {
            registers: Registers::new(widths, Uses::of(operations)),
        };
        for (at, (operation, width)) in list.iter().enumerate() {
            code.operation(at, operation, *width);
            if code.registers.encoder.len() > most_bytes {
                return None;
            }
        }
        let frame = code.registers.frame();
        if frame > LARGEST_FRAME {
            return None;
        }
        Some(code.registers.encoder.finish(frame as i32))
    }
}

/// Code that is being made.
struct Assembly {
    registers: Registers,
}

impl Assembly {
    fn encoder(&mut self) -> &mut Encoder {
        &mut self.registers.encoder
    }

    /// The code of one operation.
    fn operation(&mut self, at: usize, operation: &Operation, width: Width) {
        let made = Value(at as u32);
        let is_store = matches!(operation, Operation::Store(..));
        if !is_store && self.registers.uses.next(made) == NEVER {
            return;
        }
        self.registers.begin(at);
        match *operation {
            Operation::Zero => self.registers.make_later_zero(made),
            Operation::Load(place) => self.registers.load_later(made, place, false),
            Operation::Broadcast(place) => self.registers.load_later(made, place, true),
            Operation::Store(place, a) => {
                self.registers.store(place, a);
                self.pass(at, operation);
                self.registers.stands_at(a, place);
            }
            Operation::Add(a, b) => self.arithmetic(at, operation, Arithmetic::Add, [a, b]),
            Operation::Subtract(a, b) => {
                self.arithmetic(at, operation, Arithmetic::Subtract, [a, b]);
            }
            Operation::Multiply(a, b) => {
                self.arithmetic(at, operation, Arithmetic::Multiply, [a, b]);
            }
            Operation::Divide(a, b) => self.arithmetic(at, operation, Arithmetic::Divide, [a, b]),
            Operation::Fused(signs, of) => self.fused(at, operation, (width, signs), of),
            Operation::Negate(a) => {
                let from = self.registers.in_register(a);
                let to = self.result(at, operation);
                self.encoder().negate(width, to, from);
            }
            Operation::Lane(a, i) => self.lane(at, operation, (a, i), width),
            Operation::Beside(a, b) => {
                let first = self.registers.in_register(a);
                if width == Width::Two {
                    let second = self.registers.in_register(b);
                    let to = self.result(at, operation);
                    self.encoder().two_of(to, first, second);
                } else {
                    let second = self.operand(at, operation, b);
                    let to = self.result(at, operation);
                    self.encoder().four_of(to, first, second);
                }
            }
            Operation::Half(a, i) => match (i, width) {
                (0, _) | (_, Width::One) => self.lane_or_half(at, operation, a, i),
                _ => {
                    let from = self.registers.in_register(a);
                    let to = self.result(at, operation);
                    self.encoder().second_half(to, from);
                }
            },
        }
    }

    /// The first half of a vector, or the second lane of two.
    fn lane_or_half(&mut self, at: usize, operation: &Operation, a: Value, i: usize) {
        let from = self.registers.in_register(a);
        let to = self.result(at, operation);
        if i == 1 {
            self.encoder().lane_in_two(to, from, 1);
        } else if to != from {
            self.encoder().copy(to, from);
        }
    }

    fn lane(&mut self, at: usize, operation: &Operation, (a, i): (Value, usize), width: Width) {
        let from = self.registers.in_register(a);
        let to = self.result(at, operation);
        match (width, i) {
            (Width::One, 0) if to == from => {}
            (Width::One, 0) => self.encoder().copy(to, from),
            (Width::One | Width::Two, 0 | 1) => self.encoder().lane_in_two(to, from, i),
            _ => self.encoder().lane_in_four(to, from, i),
        }
    }

    /// Goes on behind an operation whose operands have been read.
    fn pass(&mut self, at: usize, operation: &Operation) {
        self.registers.uses.pass(at, operation);
        operation.for_each_operand(|value| self.registers.let_go(value));
    }

    /// The register of the result of an operation whose operands have been fetched: that of one that is not needed again, if there is one.
    fn result(&mut self, at: usize, operation: &Operation) -> Register {
        self.pass(at, operation);
        self.registers.unpin();
        let to = self.registers.free();
        self.registers.hold(Value(at as u32), to);
        to
    }

    fn operand(&mut self, at: usize, operation: &Operation, value: Value) -> Operand {
        let after = self.registers.uses.after(at, operation, value);
        self.registers.operand(value, after)
    }

    fn arithmetic(
        &mut self,
        at: usize,
        operation: &Operation,
        what: Arithmetic,
        [mut a, mut b]: [Value; 2],
    ) {
        let commutes = matches!(what, Arithmetic::Add | Arithmetic::Multiply);
        let is_in = |value| self.registers.register_of(value).is_some();
        if commutes && !is_in(a) && (is_in(b) || !self.registers.is_in_memory(b)) {
            std::mem::swap(&mut a, &mut b);
        }
        let width = self.registers.width(Value(at as u32));
        if let Some(register) = self.registers.register_of(b) {
            self.registers.pin(register);
        }
        let first = self.registers.in_register(a);
        let second = self.operand(at, operation, b);
        let to = self.result(at, operation);
        self.encoder().arithmetic((width, what), to, first, second);
    }

    /// a b + c. The result overwrites an operand: one that is not needed again if there is one, else a copy of c.
    fn fused(
        &mut self,
        at: usize,
        operation: &Operation,
        (width, signs): (Width, Signs),
        [mut a, mut b, c]: [Value; 3],
    ) {
        let dies = |code: &Self, value: Value| {
            let after = code.registers.uses.after(at, operation, value);
            after == NEVER && code.registers.register_of(value).is_some()
        };
        for value in [a, b, c] {
            if let Some(register) = self.registers.register_of(value) {
                self.registers.pin(register);
            }
        }
        // Of the factors the one in memory last.
        if self.registers.register_of(a).is_none() && self.registers.register_of(b).is_some() {
            std::mem::swap(&mut a, &mut b);
        }
        if !dies(self, c) && !dies(self, a) && dies(self, b) {
            std::mem::swap(&mut a, &mut b);
        }
        let (form, to, second, third);
        if !dies(self, c) && dies(self, a) {
            to = self.registers.in_register(a);
            let c_in_memory = self.registers.register_of(c).is_none();
            if c_in_memory || a == b {
                form = Form::F213;
                second = self.registers.in_register(b);
                third = self.operand(at, operation, c);
            } else {
                form = Form::F132;
                second = self.registers.in_register(c);
                third = self.operand(at, operation, b);
            }
        } else {
            form = Form::F231;
            second = self.registers.in_register(a);
            third = self.operand(at, operation, b);
            to = if dies(self, c) {
                self.registers.in_register(c)
            } else {
                self.registers.copied(c)
            };
        }
        self.pass(at, operation);
        self.registers.hold(Value(at as u32), to);
        self.encoder()
            .fused((width, form, signs), to, second, third);
    }
}
