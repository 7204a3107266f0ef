//! Where values are: in registers, in memory, or both.
//!
//! A value that is loaded or stored has a home in memory, and its register can be given to another one at no cost. Any other one is
//! written to the stack when its register is needed. The register that is given up is that of the value whose next use is furthest away
//! (Belady's rule), with some preference for values that have a home.

use super::encode::{Encoder, Operand, Pointer, Register};
use super::uses::{NEVER, Uses};
use crate::operations::{Array, Place, Value, Width};
use std::collections::HashMap;

/// Bytes of a double.
const DOUBLE: usize = 8;
const REGISTERS: usize = 16;
/// A value that is needed again within so many operations is loaded into a register instead of being read from memory twice.
const SOON: u32 = 24;
/// The number of operations by which a value without a home may be used later than one with a home before it is given up first.
const COST_OF_SPILL: u32 = 20;

/// Where a value can be had again.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Home {
    Nowhere,
    Zero,
    Memory(Place),
    Broadcast(Place),
    Slot(usize),
}

/// The registers and homes of all values while code is made.
#[derive(Debug)]
pub struct Registers {
    pub encoder: Encoder,
    pub uses: Uses,
    held: [Option<Value>; REGISTERS],
    register: Vec<Option<Register>>,
    homes: Vec<Home>,
    widths: Vec<Width>,
    /// The registers that the operation at hand needs, one bit each.
    pinned: u16,
    /// The values whose home is in the results, by each double of it.
    in_results: HashMap<usize, Vec<Value>>,
    /// Places on the stack that are free, in doubles, by the width of what has been there.
    free_slots: [Vec<usize>; 3],
    /// Those that are free once the operation at hand has read them.
    left_slots: [Vec<usize>; 3],
    /// The doubles of stack that are taken.
    frame: usize,
    now: u32,
}

impl Registers {
    pub fn new(widths: Vec<Width>, uses: Uses) -> Self {
        Registers {
            encoder: Encoder::default(),
            uses,
            held: [None; REGISTERS],
            register: vec![None; widths.len()],
            homes: vec![Home::Nowhere; widths.len()],
            widths,
            pinned: 0,
            in_results: HashMap::new(),
            free_slots: Default::default(),
            left_slots: Default::default(),
            frame: 0,
            now: 0,
        }
    }

    /// The bytes of stack that are taken.
    pub fn frame(&self) -> usize {
        (self.frame * DOUBLE).next_multiple_of(32)
    }

    /// The width of a value.
    pub fn width(&self, value: Value) -> Width {
        self.widths[value.index()]
    }

    /// Begins with an operation.
    pub fn begin(&mut self, at: usize) {
        self.now = at as u32;
        self.pinned = 0;
        for (free, left) in self.free_slots.iter_mut().zip(&mut self.left_slots) {
            free.append(left);
        }
    }

    pub fn pin(&mut self, register: Register) {
        self.pinned |= 1 << register;
    }

    /// Once all operands have been read any register may be overwritten.
    pub fn unpin(&mut self) {
        self.pinned = 0;
    }

    /// The register of a value, if it is in one.
    pub fn register_of(&self, value: Value) -> Option<Register> {
        self.register[value.index()]
    }

    /// Whether an instruction can read the value where it is in memory.
    pub fn is_in_memory(&self, value: Value) -> bool {
        matches!(self.homes[value.index()], Home::Memory(_) | Home::Slot(_))
    }

    /// Gives a value a home without a register: it is made when it is needed.
    pub fn make_later_zero(&mut self, value: Value) {
        self.homes[value.index()] = Home::Zero;
    }

    /// Gives a value that is to be loaded a home.
    pub fn load_later(&mut self, value: Value, place: Place, broadcast: bool) {
        self.settle(value, place, broadcast);
    }

    fn settle(&mut self, value: Value, place: Place, broadcast: bool) {
        let (home, lanes) = if broadcast {
            (Home::Broadcast(place), 1)
        } else {
            let lanes = self.widths[value.index()].lanes();
            (Home::Memory(place), lanes)
        };
        self.homes[value.index()] = home;
        if place.array == Array::Results {
            for double in place.offset..place.offset + lanes {
                self.in_results.entry(double).or_default().push(value);
            }
        }
    }

    /// Where a home in memory is.
    fn operand_at(home: Home) -> Option<Operand> {
        let (pointer, bytes) = match home {
            Home::Memory(place) | Home::Broadcast(place) => {
                let pointer = match place.array {
                    Array::Results => Pointer::Rdi,
                    Array::First => Pointer::Rsi,
                    Array::Second => Pointer::Rdx,
                };
                (pointer, place.offset * DOUBLE)
            }
            Home::Slot(slot) => (Pointer::Rsp, slot * DOUBLE),
            Home::Zero | Home::Nowhere => return None,
        };
        // Longer arrays are refused before.
        Some(Operand::Memory(pointer, bytes as i32))
    }

    /// Fills a register with a value that has a home.
    fn fetch(&mut self, value: Value, into: Register) {
        let (home, width) = (self.homes[value.index()], self.widths[value.index()]);
        match (home, Self::operand_at(home)) {
            (Home::Broadcast(_), Some(from)) => self.encoder.broadcast(width, into, from),
            (_, Some(from)) => self.encoder.load(width, into, from),
            (_, None) => {
                debug_assert_eq!(home, Home::Zero, "a value that is somewhere");
                self.encoder.zero(into);
            }
        }
    }

    /// A register for something new, which no operand of the operation at hand is in unless it has been read.
    pub fn free(&mut self) -> Register {
        let (mut best, mut furthest) = (0, None);
        for register in 0..REGISTERS as u8 {
            if self.pinned & 1 << register != 0 {
                continue;
            }
            let Some(value) = self.held[usize::from(register)] else {
                return register;
            };
            let next = self.uses.next(value);
            let distance = if next == NEVER {
                NEVER
            } else {
                let has_home = self.homes[value.index()] != Home::Nowhere;
                next - self.now + if has_home { COST_OF_SPILL } else { 0 }
            };
            if furthest.is_none_or(|furthest| distance > furthest) {
                (best, furthest) = (register, Some(distance));
            }
        }
        self.give_up(best);
        best
    }

    /// Takes the value out of a register, and writes it to the stack if it has no home and is needed again.
    fn give_up(&mut self, register: Register) {
        let Some(value) = self.held[usize::from(register)].take() else {
            return;
        };
        let at = value.index();
        self.register[at] = None;
        if self.homes[at] == Home::Nowhere && self.uses.next(value) != NEVER {
            let width = self.widths[at];
            let slot = self.free_slots[width as usize].pop();
            let slot = slot.unwrap_or_else(|| {
                let slot = self.frame.next_multiple_of(width.lanes());
                self.frame = slot + width.lanes();
                slot
            });
            self.homes[at] = Home::Slot(slot);
            let to = Operand::Memory(Pointer::Rsp, (slot * DOUBLE) as i32);
            self.encoder.store(width, to, register);
        }
    }

    /// Puts a value that has just been made into a register, which is free.
    pub fn hold(&mut self, value: Value, register: Register) {
        self.held[usize::from(register)] = Some(value);
        self.register[value.index()] = Some(register);
    }

    /// The register of a value, which is fetched if it is in none, kept for the operation at hand.
    pub fn in_register(&mut self, value: Value) -> Register {
        let register = self.register_of(value).unwrap_or_else(|| {
            let register = self.free();
            self.fetch(value, register);
            self.hold(value, register);
            register
        });
        self.pin(register);
        register
    }

    /// The value in a register of its own, which the operation at hand overwrites.
    pub fn copied(&mut self, value: Value) -> Register {
        let to = self.free();
        self.pin(to);
        match self.register_of(value) {
            Some(from) => self.encoder.copy(to, from),
            None => self.fetch(value, to),
        }
        to
    }

    /// Where an instruction reads the value, `after` being the use after it: in memory if it is there and not needed again soon.
    pub fn operand(&mut self, value: Value, after: u32) -> Operand {
        let home = self.homes[value.index()];
        let soon = after != NEVER && after - self.now <= SOON;
        match (self.register_of(value), Self::operand_at(home)) {
            (None, Some(memory)) if self.is_in_memory(value) && !soon => memory,
            _ => Operand::Register(self.in_register(value)),
        }
    }

    /// Lets go of a value that has no use any more; its register is free at once, its slot after the operation at hand.
    pub fn let_go(&mut self, value: Value) {
        if self.uses.next(value) != NEVER {
            return;
        }
        if let Some(register) = self.register[value.index()].take() {
            self.held[usize::from(register)] = None;
        }
        self.leave_home(value);
    }

    fn leave_home(&mut self, value: Value) {
        let home = std::mem::replace(&mut self.homes[value.index()], Home::Nowhere);
        if let Home::Slot(slot) = home {
            self.left_slots[self.widths[value.index()] as usize].push(slot);
        }
    }

    /// Writes a value into the results. What was to be read from there later is read before.
    pub fn store(&mut self, place: Place, value: Value) {
        let width = self.widths[value.index()];
        let register = self.in_register(value);
        let mut overwritten = Vec::new();
        for double in place.offset..place.offset + width.lanes() {
            overwritten.extend(self.in_results.remove(&double).unwrap_or_default());
        }
        for other in overwritten {
            let home = self.homes[other.index()];
            let (Home::Memory(at) | Home::Broadcast(at)) = home else {
                continue;
            };
            let lanes = match home {
                Home::Broadcast(_) => 1,
                _ => self.widths[other.index()].lanes(),
            };
            let apart = at.array != Array::Results
                || at.offset + lanes <= place.offset
                || place.offset + width.lanes() <= at.offset;
            if apart {
                continue;
            }
            if self.uses.next(other) != NEVER && self.register_of(other).is_none() {
                let register = self.free();
                self.fetch(other, register);
                self.hold(other, register);
            }
            self.homes[other.index()] = Home::Nowhere;
        }
        let to = Self::operand_at(Home::Memory(place)).unwrap_or(Operand::Register(register));
        self.encoder.store(width, to, register);
    }

    /// Notes that a value that has been stored stands there, if that is of use.
    pub fn stands_at(&mut self, value: Value, place: Place) {
        if self.uses.next(value) == NEVER {
            return;
        }
        if matches!(self.homes[value.index()], Home::Nowhere | Home::Slot(_)) {
            self.leave_home(value);
            self.settle(value, place, false);
        }
    }
}
