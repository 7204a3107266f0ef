//! The encoding of the few instructions that kernels are made of.
//!
//! Intel 64 and IA-32 Architectures Software Developer's Manual, volume 2, sections 2.3 (VEX prefix) and 2.1.5 (ModR/M and SIB bytes).

use crate::operations::{Signs, Width};

/// A vector register, 0 to 15.
pub type Register = u8;

/// A register that holds an address.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub enum Pointer {
    Rdx = 2,
    Rsp = 4,
    Rsi = 6,
    Rdi = 7,
}

/// The second operand of an instruction.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Operand {
    Register(Register),
    /// So many bytes after an address.
    Memory(Pointer, i32),
    /// The sign bits that stand behind the code.
    SignBits,
}

/// The arithmetic of two operands, by its code.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub enum Arithmetic {
    Add = 0x58,
    Multiply = 0x59,
    Subtract = 0x5c,
    Divide = 0x5e,
}

/// Which operands of a fused multiply-add are multiplied: 1 is the destination, 2 a register, 3 a register or memory, and the last one is
/// added.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub enum Form {
    F132 = 0x90,
    F213 = 0xa0,
    F231 = 0xb0,
}

/// The table of codes.
#[derive(Debug, Clone, Copy)]
#[repr(u8)]
enum Map {
    Of0F = 1,
    Of0F38 = 2,
    Of0F3A = 3,
}

/// The prefix that the VEX prefix stands for.
#[derive(Debug, Clone, Copy)]
#[repr(u8)]
enum Prefix {
    Of66 = 1,
    OfF2 = 3,
}

/// A code, its table, its prefix, and the bit W.
#[derive(Debug, Clone, Copy)]
struct Code {
    map: Map,
    prefix: Prefix,
    wide: bool,
    byte: u8,
}

impl Code {
    fn new(map: Map, prefix: Prefix, code: u8) -> Self {
        Code {
            map,
            prefix,
            wide: false,
            byte: code,
        }
    }

    /// Of vectors, or the like code of single doubles.
    fn of(width: Width, code: u8) -> Self {
        let prefix = match width {
            Width::One => Prefix::OfF2,
            _ => Prefix::Of66,
        };
        Code::new(Map::Of0F, prefix, code)
    }

    fn wide(self) -> Self {
        Code { wide: true, ..self }
    }
}

/// Machine code that is being written.
#[derive(Debug, Default)]
pub struct Encoder {
    bytes: Vec<u8>,
    /// Where an offset to the sign bits is to be filled in.
    sign_bits: Vec<usize>,
}

impl Encoder {
    /// The number of bytes so far.
    pub fn len(&self) -> usize {
        self.bytes.len()
    }

    /// An instruction in VEX encoding: destination, first operand, second one.
    fn vex(&mut self, code: Code, long: bool, to: Register, first: Register, second: Operand) {
        let extends = matches!(second, Operand::Register(register) if register >= 8);
        let last = (!first & 15) << 3 | u8::from(long) << 2 | code.prefix as u8;
        if matches!(code.map, Map::Of0F) && !code.wide && !extends {
            self.bytes.extend([0xc5, u8::from(to < 8) << 7 | last]);
        } else {
            // The bit between these two extends an index, of which there is none.
            let extension = u8::from(to < 8) << 7 | 1 << 6 | u8::from(!extends) << 5;
            self.bytes.extend([
                0xc4,
                extension | code.map as u8,
                u8::from(code.wide) << 7 | last,
            ]);
        }
        self.bytes.push(code.byte);
        self.operand(to, second);
    }

    /// The ModR/M byte, and what follows it.
    fn operand(&mut self, register: Register, operand: Operand) {
        let field = (register & 7) << 3;
        match operand {
            Operand::Register(other) => self.bytes.push(0xc0 | field | other & 7),
            Operand::Memory(pointer, displacement) => {
                let short = i8::try_from(displacement).ok();
                let mode = match short {
                    Some(0) => 0x00,
                    Some(_) => 0x40,
                    None => 0x80,
                };
                self.bytes.push(mode | field | pointer as u8);
                if pointer == Pointer::Rsp {
                    self.bytes.push(0x24);
                }
                match short {
                    Some(0) => {}
                    Some(short) => self.bytes.extend(short.to_le_bytes()),
                    None => self.bytes.extend(displacement.to_le_bytes()),
                }
            }
            Operand::SignBits => {
                self.bytes.push(field | 5);
                self.sign_bits.push(self.bytes.len());
                self.bytes.extend([0; 4]);
            }
        }
    }

    /// Reads a vector.
    pub fn load(&mut self, width: Width, to: Register, from: Operand) {
        self.vex(Code::of(width, 0x10), width == Width::Four, to, 0, from);
    }

    /// Writes a vector.
    pub fn store(&mut self, width: Width, to: Operand, from: Register) {
        self.vex(Code::of(width, 0x11), width == Width::Four, from, 0, to);
    }

    /// Copies a register, whatever it holds.
    pub fn copy(&mut self, to: Register, from: Register) {
        let code = Code::new(Map::Of0F, Prefix::Of66, 0x28);
        self.vex(code, true, to, 0, Operand::Register(from));
    }

    /// Zero.
    pub fn zero(&mut self, to: Register) {
        let code = Code::new(Map::Of0F, Prefix::Of66, 0x57);
        self.vex(code, false, to, to, Operand::Register(to));
    }

    /// -a
    pub fn negate(&mut self, width: Width, to: Register, a: Register) {
        let code = Code::new(Map::Of0F, Prefix::Of66, 0x57);
        self.vex(code, width == Width::Four, to, a, Operand::SignBits);
    }

    /// The double in memory, in every lane of two or four.
    pub fn broadcast(&mut self, width: Width, to: Register, from: Operand) {
        let long = width == Width::Four;
        let code = if long {
            Code::new(Map::Of0F38, Prefix::Of66, 0x19)
        } else {
            Code::new(Map::Of0F, Prefix::OfF2, 0x12)
        };
        self.vex(code, long, to, 0, from);
    }

    /// a with b
    pub fn arithmetic(
        &mut self,
        (width, what): (Width, Arithmetic),
        to: Register,
        a: Register,
        b: Operand,
    ) {
        let code = Code::of(width, what as u8);
        self.vex(code, width == Width::Four, to, a, b);
    }

    /// A product and a sum, rounded once; the destination is an operand.
    pub fn fused(
        &mut self,
        (width, form, signs): (Width, Form, Signs),
        to: Register,
        second: Register,
        third: Operand,
    ) {
        let signs = match (signs.negative_product, signs.negative_addend) {
            (false, false) => 0x8,
            (false, true) => 0xa,
            (true, false) => 0xc,
            (true, true) => 0xe,
        };
        let code = form as u8 | signs | u8::from(width == Width::One);
        let code = Code::new(Map::Of0F38, Prefix::Of66, code).wide();
        self.vex(code, width == Width::Four, to, second, third);
    }

    /// The i-th lane of a in the lanes of two.
    pub fn lane_in_two(&mut self, to: Register, a: Register, i: usize) {
        // vunpcklpd, vunpckhpd
        let code = Code::new(Map::Of0F, Prefix::Of66, if i == 0 { 0x14 } else { 0x15 });
        self.vex(code, false, to, a, Operand::Register(a));
    }

    /// The i-th lane of a in the lanes of four.
    pub fn lane_in_four(&mut self, to: Register, a: Register, i: usize) {
        // vpermpd, with the lane to take in two bits for each
        let code = Code::new(Map::Of0F3A, Prefix::Of66, 0x01).wide();
        self.vex(code, true, to, 0, Operand::Register(a));
        self.bytes.push(0b0101_0101 * i as u8);
    }

    /// Two single doubles side by side.
    pub fn two_of(&mut self, to: Register, a: Register, b: Register) {
        let code = Code::new(Map::Of0F, Prefix::Of66, 0x14);
        self.vex(code, false, to, a, Operand::Register(b));
    }

    /// Two vectors of two side by side.
    pub fn four_of(&mut self, to: Register, a: Register, b: Operand) {
        // vinsertf128
        let code = Code::new(Map::Of0F3A, Prefix::Of66, 0x18);
        self.vex(code, true, to, a, b);
        self.bytes.push(1);
    }

    /// The second half of four.
    pub fn second_half(&mut self, to: Register, a: Register) {
        // vextractf128, whose destination is the second operand
        let code = Code::new(Map::Of0F3A, Prefix::Of66, 0x19);
        self.vex(code, true, a, 0, Operand::Register(to));
        self.bytes.push(1);
    }

    /// The function of these instructions, with room for so many bytes at `rsp`, which is a multiple of 32. The sign bits are added
    /// behind it.
    pub fn finish(mut self, frame: i32) -> Vec<u8> {
        // vzeroupper; leave; ret
        self.bytes.extend([0xc5, 0xf8, 0x77, 0xc9, 0xc3]);
        let mut all = entry(frame);
        let begin = all.len();
        all.append(&mut self.bytes);
        if self.sign_bits.is_empty() {
            return all;
        }
        all.resize(all.len().next_multiple_of(32), 0xcc);
        let constants = all.len();
        for _ in 0..4 {
            all.extend((1_u64 << 63).to_le_bytes());
        }
        for place in self.sign_bits {
            let place = begin + place;
            // Counted from the end of the instruction, which is the end of the offset.
            let offset = (constants - place - 4) as i32;
            all[place..place + 4].copy_from_slice(&offset.to_le_bytes());
        }
        all
    }

    /// The bytes of the instructions alone.
    #[cfg(test)]
    pub fn into_bytes(self) -> Vec<u8> {
        self.bytes
    }
}

/// The begin of a function with room for so many bytes at `rsp`, which is a multiple of 32.
fn entry(frame: i32) -> Vec<u8> {
    const PAGE: i32 = 4096;
    // push rbp; mov rbp, rsp; and rsp, -32
    let mut bytes = vec![0x55, 0x48, 0x89, 0xe5, 0x48, 0x83, 0xe4, 0xe0];
    // Each page of the stack is touched in turn: the system adds them one by one.
    for page in 1..=frame / PAGE {
        // test [rsp - ...], eax
        bytes.extend([0x85, 0x84, 0x24]);
        bytes.extend((-page * PAGE).to_le_bytes());
    }
    // sub rsp, frame
    bytes.extend([0x48, 0x81, 0xec]);
    bytes.extend(frame.to_le_bytes());
    bytes
}
