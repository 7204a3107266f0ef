//! Every form that the encoder can emit, read back by another program.

use super::encode::{Arithmetic, Encoder, Form, Operand, Pointer, Register};
use crate::operations::{Signs, Width};
use std::process::Command;

const WIDTHS: [Width; 3] = [Width::One, Width::Two, Width::Four];
/// On both sides of what needs another bit of the prefix.
const REGISTERS: [Register; 6] = [0, 3, 7, 8, 12, 15];
const POINTERS: [(Pointer, &str); 4] = [
    (Pointer::Rdx, "rdx"),
    (Pointer::Rsp, "rsp"),
    (Pointer::Rsi, "rsi"),
    (Pointer::Rdi, "rdi"),
];
/// Of no byte, of one, and of four.
const DISPLACEMENTS: [i32; 7] = [0, 8, -8, 127, 128, -129, 0x12_3458];

/// The name of a register as wide as a vector.
fn name(width: Width, register: Register) -> String {
    let letter = if width == Width::Four { 'y' } else { 'x' };
    format!("{letter}mm{register}")
}

fn suffix(width: Width) -> &'static str {
    if width == Width::One { "sd" } else { "pd" }
}

/// A place in memory of so many lanes.
fn in_memory(pointer: &str, displacement: i32, lanes: usize) -> String {
    let size = ["QWORD", "XMMWORD", "YMMWORD"][lanes / 2];
    let offset = match displacement {
        0 => String::new(),
        below if below < 0 => format!("-{:#x}", -below),
        above => format!("+{above:#x}"),
    };
    format!("{size} PTR [{pointer}{offset}]")
}

/// The second operands: as they are encoded, as registers of `width` or memory of so many lanes are written.
fn operands(width: Width, lanes: usize) -> Vec<(Operand, String)> {
    let registers = REGISTERS.map(|r| (Operand::Register(r), name(width, r)));
    let memory = POINTERS.iter().flat_map(|&(pointer, word)| {
        DISPLACEMENTS.map(|d| (Operand::Memory(pointer, d), in_memory(word, d, lanes)))
    });
    registers.into_iter().chain(memory).collect()
}

/// Instructions as they are encoded, and the lines that they are.
#[derive(Default)]
struct Expected {
    code: Encoder,
    lines: Vec<String>,
}

impl Expected {
    fn line(&mut self, mnemonic: &str, operands: &[&str]) {
        self.lines
            .push(format!("{mnemonic} {}", operands.join(",")));
    }

    fn loads_and_stores(&mut self, width: Width) {
        for to in REGISTERS {
            let register = name(width, to);
            for (operand, text) in operands(width, width.lanes()) {
                let Operand::Memory(..) = operand else {
                    continue;
                };
                let word = if width == Width::One {
                    "vmovsd"
                } else {
                    "vmovupd"
                };
                self.code.load(width, to, operand);
                self.line(word, &[&register, &text]);
                self.code.store(width, operand, to);
                self.line(word, &[&text, &register]);
            }
            for from in REGISTERS {
                self.code.copy(to, from);
                let (to, from) = (name(Width::Four, to), name(Width::Four, from));
                self.line("vmovapd", &[&to, &from]);
            }
            self.code.zero(to);
            let register = name(Width::Two, to);
            self.line("vxorpd", &[&register, &register, &register]);
        }
    }

    fn arithmetic(&mut self, width: Width) {
        let all = [
            (Arithmetic::Add, "vadd"),
            (Arithmetic::Multiply, "vmul"),
            (Arithmetic::Subtract, "vsub"),
            (Arithmetic::Divide, "vdiv"),
        ];
        for (what, word) in all {
            for to in REGISTERS {
                for first in REGISTERS {
                    for (operand, text) in operands(width, width.lanes()) {
                        self.code.arithmetic((width, what), to, first, operand);
                        let word = format!("{word}{}", suffix(width));
                        self.line(&word, &[&name(width, to), &name(width, first), &text]);
                    }
                }
            }
        }
    }

    fn fused(&mut self, width: Width) {
        let forms = [
            (Form::F132, "132"),
            (Form::F213, "213"),
            (Form::F231, "231"),
        ];
        let kinds = [
            (false, false, "vfmadd"),
            (false, true, "vfmsub"),
            (true, false, "vfnmadd"),
            (true, true, "vfnmsub"),
        ];
        for (form, digits) in forms {
            for (negative_product, negative_addend, word) in kinds {
                let signs = Signs {
                    negative_product,
                    negative_addend,
                };
                let word = format!("{word}{digits}{}", suffix(width));
                for to in REGISTERS {
                    for second in REGISTERS {
                        for (operand, text) in operands(width, width.lanes()) {
                            self.code.fused((width, form, signs), to, second, operand);
                            self.line(&word, &[&name(width, to), &name(width, second), &text]);
                        }
                    }
                }
            }
        }
    }

    fn moves_of_lanes(&mut self) {
        let (two, four) = (Width::Two, Width::Four);
        for to in REGISTERS {
            for (operand, text) in operands(two, 1) {
                let Operand::Memory(..) = operand else {
                    continue;
                };
                self.code.broadcast(two, to, operand);
                self.line("vmovddup", &[&name(two, to), &text]);
                self.code.broadcast(four, to, operand);
                self.line("vbroadcastsd", &[&name(four, to), &text]);
            }
            for a in REGISTERS {
                let narrow = name(two, a);
                self.code.lane_in_two(to, a, 0);
                self.line("vunpcklpd", &[&name(two, to), &narrow, &narrow]);
                self.code.lane_in_two(to, a, 1);
                self.line("vunpckhpd", &[&name(two, to), &narrow, &narrow]);
                for (i, lanes) in ["0x0", "0x55", "0xaa", "0xff"].into_iter().enumerate() {
                    self.code.lane_in_four(to, a, i);
                    self.line("vpermpd", &[&name(four, to), &name(four, a), lanes]);
                }
                self.code.second_half(to, a);
                self.line("vextractf128", &[&name(two, to), &name(four, a), "0x1"]);
                for b in REGISTERS {
                    self.code.two_of(to, a, b);
                    self.line("vunpcklpd", &[&name(two, to), &narrow, &name(two, b)]);
                }
                for (operand, text) in operands(two, 2) {
                    self.code.four_of(to, a, operand);
                    self.line(
                        "vinsertf128",
                        &[&name(four, to), &name(four, a), &text, "0x1"],
                    );
                }
            }
        }
    }

    /// Compares with what the disassembler reads of these bytes.
    fn check(self) {
        let bytes = self.code.into_bytes();
        let Some(read) = disassembled(&bytes) else {
            eprintln!("not checked: there is no objdump (of binutils) here");
            return;
        };
        assert!(self.lines.len() > 100);
        for (read, expected) in read.iter().zip(&self.lines) {
            assert_eq!(read, expected);
        }
        assert_eq!(read.len(), self.lines.len());
    }
}

/// The instructions of this code, as objdump writes them in Intel's syntax; `None` where it is not to be had.
fn disassembled(bytes: &[u8]) -> Option<Vec<String>> {
    let name = format!("twinslip-kernel-{}-{}", std::process::id(), bytes.len());
    let file = std::env::temp_dir().join(name);
    std::fs::write(&file, bytes).expect("a file for a moment");
    let run = Command::new("objdump")
        .args([
            "-D",
            "-b",
            "binary",
            "-m",
            "i386:x86-64",
            "-M",
            "intel",
            "-w",
        ])
        .arg(&file)
        .output();
    std::fs::remove_file(&file).expect("its end");
    let text = String::from_utf8(run.ok()?.stdout).expect("UTF-8");
    // The place, the bytes, and the instruction.
    let lines = text.lines().filter_map(|line| {
        let instruction = line.split('\t').nth(2)?;
        let code = instruction.split('#').next().unwrap_or(instruction);
        Some(code.split_whitespace().collect::<Vec<_>>().join(" "))
    });
    Some(lines.collect())
}

fn check(fill: impl Fn(&mut Expected, Width)) {
    for width in WIDTHS {
        let mut expected = Expected::default();
        fill(&mut expected, width);
        expected.check();
    }
}

#[test]
fn loads_and_stores_are_what_a_disassembler_reads() {
    check(Expected::loads_and_stores);
}

#[test]
fn arithmetic_is_what_a_disassembler_reads() {
    check(Expected::arithmetic);
}

#[test]
fn fused_operations_are_what_a_disassembler_reads() {
    check(Expected::fused);
}

#[test]
fn moves_of_lanes_are_what_a_disassembler_reads() {
    let mut expected = Expected::default();
    expected.moves_of_lanes();
    expected.check();
}

#[test]
fn the_frame_and_the_sign_bits_are_what_a_disassembler_reads() {
    let mut code = Encoder::default();
    code.negate(Width::Four, 9, 8);
    code.negate(Width::One, 1, 2);
    let bytes = code.finish(2 * 4096 + 32);
    // Behind the function only the sign bits, which are no instructions.
    let (function, constants) = bytes.split_at(bytes.len() - 32);
    assert_eq!(bytes.len() % 32, 0);
    for sign in constants.as_chunks::<8>().0 {
        assert_eq!(u64::from_le_bytes(*sign), 1 << 63);
    }
    let Some(mut read) = disassembled(function) else {
        eprintln!("not checked: there is no objdump (of binutils) here");
        return;
    };
    read.retain(|line| line != "int3");
    let expected = [
        "push rbp",
        "mov rbp,rsp",
        "and rsp,0xffffffffffffffe0",
        "test DWORD PTR [rsp-0x1000],eax",
        "test DWORD PTR [rsp-0x2000],eax",
        "sub rsp,0x2020",
        "vxorpd ymm9,ymm8,YMMWORD PTR [rip+0x1b]",
        "vxorpd xmm1,xmm2,XMMWORD PTR [rip+0x13]",
        "vzeroupper",
        "leave",
        "ret",
    ];
    assert_eq!(read, expected);
}
