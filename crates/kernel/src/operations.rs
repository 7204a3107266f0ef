//! Straight-line arithmetic as a list of operations, each of which makes one vector of doubles or stores one.

/// The number of lanes of a vector.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Width {
    /// A double.
    One,
    /// Two doubles.
    Two,
    /// Four doubles.
    Four,
}

impl Width {
    /// The number of lanes.
    #[must_use]
    pub fn lanes(self) -> usize {
        match self {
            Width::One => 1,
            Width::Two => 2,
            Width::Four => 4,
        }
    }

    /// The width of twice as many lanes, if there is one.
    #[must_use]
    pub fn doubled(self) -> Option<Self> {
        match self {
            Width::One => Some(Width::Two),
            Width::Two => Some(Width::Four),
            Width::Four => None,
        }
    }
}

/// A vector that an operation makes: the place of the operation in its list.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Value(pub(crate) u32);

impl Value {
    pub(crate) fn index(self) -> usize {
        self.0 as usize
    }
}

/// The arrays that a kernel is called with.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Array {
    /// Read and written.
    Results,
    /// Read only.
    First,
    /// Read only.
    Second,
}

/// A place in an array, counted in doubles.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Place {
    /// The array.
    pub array: Array,
    /// The number of doubles before it.
    pub offset: usize,
}

/// An operation. All operands of arithmetic have the width of the result.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Operation {
    /// Zero in every lane.
    Zero,
    /// As many doubles as there are lanes, from a place on.
    Load(Place),
    /// The double at a place, in every lane.
    Broadcast(Place),
    /// Writes a vector.
    Store(Place, Value),
    /// a + b
    Add(Value, Value),
    /// a - b
    Subtract(Value, Value),
    /// a b
    Multiply(Value, Value),
    /// a / b
    Divide(Value, Value),
    /// a b + c, rounded once, with the signs that [`Signs`] says.
    Fused(Signs, [Value; 3]),
    /// -a
    Negate(Value),
    /// One lane of a vector of any width, in every lane.
    Lane(Value, usize),
    /// The lanes of a vector of half the width, and after them those of another.
    Beside(Value, Value),
    /// The first or the second half of a vector of twice the width.
    Half(Value, usize),
}

/// The signs in a fused multiply-add.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Signs {
    /// Whether the product counts negatively.
    pub negative_product: bool,
    /// Whether the addend counts negatively.
    pub negative_addend: bool,
}

impl Operation {
    /// Calls `f` with each operand.
    pub fn for_each_operand(&self, mut f: impl FnMut(Value)) {
        match *self {
            Operation::Zero | Operation::Load(_) | Operation::Broadcast(_) => {}
            Operation::Store(_, a)
            | Operation::Negate(a)
            | Operation::Lane(a, _)
            | Operation::Half(a, _) => f(a),
            Operation::Add(a, b)
            | Operation::Subtract(a, b)
            | Operation::Multiply(a, b)
            | Operation::Divide(a, b)
            | Operation::Beside(a, b) => {
                f(a);
                f(b);
            }
            Operation::Fused(_, [a, b, c]) => {
                f(a);
                f(b);
                f(c);
            }
        }
    }
}

/// A list of operations, in the order in which they are carried out.
///
/// Methods panic where the widths of operands do not fit: the list is made by code, not from input.
#[derive(Debug, Clone, Default)]
pub struct Operations {
    list: Vec<(Operation, Width)>,
    /// For each array one more than the last double that is read or written.
    extents: [usize; 3],
}

impl Operations {
    /// An empty list.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// The number of operations.
    #[must_use]
    pub fn len(&self) -> usize {
        self.list.len()
    }

    /// Whether there is no operation.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.list.is_empty()
    }

    /// The number of doubles of each array that are read or written.
    #[must_use]
    pub fn extents(&self) -> [usize; 3] {
        self.extents
    }

    /// The operations and the widths of what they make; of a store the width of what it writes.
    #[must_use]
    pub fn list(&self) -> &[(Operation, Width)] {
        &self.list
    }

    /// The number of lanes of a vector.
    #[must_use]
    pub fn width(&self, of: Value) -> Width {
        self.list[of.index()].1
    }

    fn push(&mut self, operation: Operation, width: Width) -> Value {
        let place = u32::try_from(self.list.len()).expect("fewer operations than 2^32");
        self.list.push((operation, width));
        Value(place)
    }

    fn reach(&mut self, place: Place, lanes: usize) {
        let extent = &mut self.extents[place.array as usize];
        *extent = (*extent).max(place.offset + lanes);
    }

    /// The width of both.
    fn common(&self, a: Value, b: Value) -> Width {
        assert_eq!(self.width(a), self.width(b), "operands of one width");
        self.width(a)
    }

    /// Zero.
    pub fn zero(&mut self, width: Width) -> Value {
        self.push(Operation::Zero, width)
    }

    /// The doubles that stand there when this operation is carried out.
    pub fn load(&mut self, place: Place, width: Width) -> Value {
        self.reach(place, width.lanes());
        self.push(Operation::Load(place), width)
    }

    /// The double that stands there when this operation is carried out, in every lane.
    pub fn broadcast(&mut self, place: Place, width: Width) -> Value {
        self.reach(place, 1);
        let operation = if width == Width::One {
            Operation::Load(place)
        } else {
            Operation::Broadcast(place)
        };
        self.push(operation, width)
    }

    /// Writes a vector into the results.
    pub fn store(&mut self, offset: usize, a: Value) {
        let place = Place {
            array: Array::Results,
            offset,
        };
        let width = self.width(a);
        self.reach(place, width.lanes());
        self.push(Operation::Store(place, a), width);
    }

    /// a + b
    pub fn add(&mut self, a: Value, b: Value) -> Value {
        let width = self.common(a, b);
        self.push(Operation::Add(a, b), width)
    }

    /// a - b
    pub fn subtract(&mut self, a: Value, b: Value) -> Value {
        let width = self.common(a, b);
        self.push(Operation::Subtract(a, b), width)
    }

    /// a b
    pub fn multiply(&mut self, a: Value, b: Value) -> Value {
        let width = self.common(a, b);
        self.push(Operation::Multiply(a, b), width)
    }

    /// a / b
    pub fn divide(&mut self, a: Value, b: Value) -> Value {
        let width = self.common(a, b);
        self.push(Operation::Divide(a, b), width)
    }

    /// a b + c with these signs, rounded once.
    pub fn fused(&mut self, signs: Signs, [a, b, c]: [Value; 3]) -> Value {
        let width = self.common(a, b);
        self.common(b, c);
        self.push(Operation::Fused(signs, [a, b, c]), width)
    }

    /// a b + c, rounded once.
    pub fn multiply_add(&mut self, a: Value, b: Value, c: Value) -> Value {
        let signs = Signs {
            negative_product: false,
            negative_addend: false,
        };
        self.fused(signs, [a, b, c])
    }

    /// -a
    pub fn negate(&mut self, a: Value) -> Value {
        let width = self.width(a);
        self.push(Operation::Negate(a), width)
    }

    /// The i-th lane of a, in every lane.
    ///
    /// # Panics
    /// If there is no such lane.
    pub fn lane(&mut self, a: Value, i: usize, width: Width) -> Value {
        assert!(i < self.width(a).lanes(), "a lane that there is");
        self.push(Operation::Lane(a, i), width)
    }

    /// The lanes of a and after them those of b.
    ///
    /// # Panics
    /// If these are more than four.
    pub fn beside(&mut self, a: Value, b: Value) -> Value {
        let width = self.common(a, b).doubled().expect("at most four lanes");
        self.push(Operation::Beside(a, b), width)
    }

    /// The first half of a, or the second one.
    ///
    /// # Panics
    /// If a has a single lane, or i is neither 0 nor 1.
    pub fn half(&mut self, a: Value, i: usize) -> Value {
        assert!(i < 2, "one of two halves");
        let width = match self.width(a) {
            Width::Four => Width::Two,
            Width::Two => Width::One,
            Width::One => unreachable!("a single lane has no halves"),
        };
        self.push(Operation::Half(a, i), width)
    }
}
