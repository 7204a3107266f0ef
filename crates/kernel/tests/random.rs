//! Compiled lists of operations do what the same lists do in Rust, bit by bit.

use twinslip_kernel::{Array, Kernel, Operations, Place, Signs, Value, Width, compile, execute};

/// Random numbers (splitmix64).
struct Random(u64);

impl Random {
    fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    fn below(&mut self, n: usize) -> usize {
        (self.bits() % n as u64) as usize
    }

    fn chance(&mut self, one_in: usize) -> bool {
        self.below(one_in) == 0
    }

    /// A number near 1 of either sign, and at times a special one.
    fn number(&mut self) -> f64 {
        const SPECIAL: [f64; 6] = [0.0, -0.0, f64::INFINITY, f64::NAN, 5e-324, 1e300];
        if self.chance(500) {
            return SPECIAL[self.below(SPECIAL.len())];
        }
        let size = (self.bits() >> 11) as f64 / (1_u64 << 53) as f64 + 0.5;
        if self.chance(2) { size } else { -size }
    }

    fn of<T: Copy>(&mut self, all: &[T]) -> T {
        all[self.below(all.len())]
    }
}

const WIDTHS: [Width; 3] = [Width::One, Width::Two, Width::Four];
const MOST_BYTES: usize = 1 << 24;

/// What lists are made like.
struct Kind {
    operations: usize,
    /// Doubles of each array.
    extent: usize,
    /// Operands are among so many of the newest values, most often.
    recent: usize,
}

/// A list that is being made, with its values by their width.
struct Drawn {
    operations: Operations,
    values: [Vec<Value>; 3],
}

impl Drawn {
    fn of(random: &mut Random, kind: &Kind) -> Operations {
        let mut drawn = Drawn {
            operations: Operations::new(),
            values: Default::default(),
        };
        for width in WIDTHS {
            let place = drawn.place(random, kind, width);
            let value = drawn.operations.load(place, width);
            drawn.add(value);
        }
        while drawn.operations.len() < kind.operations {
            drawn.operation(random, kind);
        }
        // What is left is stored, so that it is needed.
        for width in WIDTHS {
            let values = drawn.values[width as usize].clone();
            for value in values.into_iter().rev().take(20) {
                let place = drawn.place(random, kind, width);
                drawn.operations.store(place.offset, value);
            }
        }
        drawn.operations
    }

    fn add(&mut self, value: Value) {
        let width = self.operations.width(value);
        self.values[width as usize].push(value);
    }

    fn place(&self, random: &mut Random, kind: &Kind, width: Width) -> Place {
        Place {
            array: random.of(&[Array::Results, Array::First, Array::Second]),
            offset: random.below(kind.extent - width.lanes() + 1),
        }
    }

    fn value(&self, random: &mut Random, kind: &Kind, width: Width) -> Value {
        let all = &self.values[width as usize];
        let recent = if random.chance(10) {
            all.len()
        } else {
            kind.recent.min(all.len())
        };
        all[all.len() - 1 - random.below(recent)]
    }

    fn operation(&mut self, random: &mut Random, kind: &Kind) {
        let width = random.of(&WIDTHS);
        let mut operand = || self.value(random, kind, width);
        let [a, b, c] = [operand(), operand(), operand()];
        let all = &mut self.operations;
        let made = match random.below(18) {
            0 => all.zero(width),
            1 => {
                let place = self.place(random, kind, width);
                self.operations.load(place, width)
            }
            2 => {
                let place = self.place(random, kind, Width::One);
                self.operations.broadcast(place, width)
            }
            3 | 4 => {
                let place = self.place(random, kind, width);
                self.operations.store(place.offset, a);
                return;
            }
            5 => all.add(a, b),
            6 => all.subtract(a, b),
            7 | 8 => all.multiply(a, b),
            9 => all.divide(a, b),
            10 => all.negate(a),
            11 => all.lane(a, random.below(width.lanes()), random.of(&WIDTHS)),
            12 if width != Width::Four => all.beside(a, b),
            13 if width != Width::One => all.half(a, random.below(2)),
            _ => {
                let signs = Signs {
                    negative_product: random.chance(3),
                    negative_addend: random.chance(3),
                };
                all.fused(signs, [a, b, c])
            }
        };
        self.add(made);
    }
}

fn compiled(operations: &Operations) -> Option<Kernel> {
    let kernel = compile(operations, MOST_BYTES);
    if kernel.is_none() {
        let can = cfg!(target_arch = "x86_64") && cfg!(unix);
        eprintln!("not compiled: another processor, or no executable memory");
        #[cfg(target_arch = "x86_64")]
        if can && is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma") {
            panic!("this machine should be able to");
        }
        let _ = can;
    }
    kernel
}

/// The same bits, where not both are no numbers.
fn same(a: f64, b: f64) -> bool {
    a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan())
}

/// Compares on several inputs; returns whether there is compiled code.
fn check(random: &mut Random, operations: &Operations, what: &str) -> bool {
    let Some(kernel) = compiled(operations) else {
        return false;
    };
    let extents = operations.extents();
    for _ in 0..3 {
        let [results, first, second] =
            extents.map(|n| (0..n).map(|_| random.number()).collect::<Vec<f64>>());
        let (mut expected, mut found) = (results.clone(), results);
        execute(operations, &mut expected, [&first, &second]);
        kernel.run(&mut found, &first, &second);
        for (i, (a, b)) in expected.iter().zip(&found).enumerate() {
            assert!(same(*a, *b), "{what}, at {i}: {a:e} is {b:e}");
        }
    }
    true
}

#[test]
fn random_lists_are_carried_out_bit_by_bit() {
    let kinds = [
        // All in registers, much spilled, much overwritten.
        Kind {
            operations: 60,
            extent: 40,
            recent: 4,
        },
        Kind {
            operations: 300,
            extent: 100,
            recent: 12,
        },
        Kind {
            operations: 2000,
            extent: 2000,
            recent: 60,
        },
        Kind {
            operations: 2000,
            extent: 12,
            recent: 30,
        },
        Kind {
            operations: 12_000,
            extent: 5000,
            recent: 400,
        },
    ];
    let mut count = 0;
    for (number, kind) in kinds.iter().enumerate() {
        for seed in 0..400_000 / kind.operations as u64 {
            let mut random = Random(seed << 8 | number as u64);
            let operations = Drawn::of(&mut random, kind);
            count += operations.len();
            if !check(
                &mut random,
                &operations,
                &format!("kind {number}, list {seed}"),
            ) {
                return;
            }
        }
    }
    assert!(count > 1_900_000, "{count}");
}

#[test]
fn a_frame_of_many_pages_is_the_functions_own() {
    // All values are made before any is used, and none has a home.
    let mut operations = Operations::new();
    let place = |offset| Place {
        array: Array::First,
        offset,
    };
    let mut all = Vec::new();
    for i in 0..1200 {
        let (a, b) = (
            operations.load(place(i), Width::One),
            operations.load(place(i + 1), Width::One),
        );
        all.push(operations.multiply(a, b));
    }
    for (i, value) in all.into_iter().enumerate() {
        operations.store(i, value);
    }
    check(&mut Random(1), &operations, "many slots");
}

#[test]
fn code_that_would_be_too_long_is_not_made() {
    let operations = Drawn::of(
        &mut Random(5),
        &Kind {
            operations: 500,
            extent: 50,
            recent: 8,
        },
    );
    assert!(compile(&operations, 200).is_none());
}

#[test]
#[should_panic(expected = "first inputs")]
fn an_array_that_is_too_short_is_refused() {
    let mut operations = Operations::new();
    let place = Place {
        array: Array::First,
        offset: 7,
    };
    let a = operations.load(place, Width::One);
    operations.store(0, a);
    let none: [f64; 0] = [];
    match compiled(&operations) {
        Some(kernel) => kernel.run(&mut [0.0], &[0.0; 7], &none),
        None => panic!("first inputs: not tried"),
    }
}
