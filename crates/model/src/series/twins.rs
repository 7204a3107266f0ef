//! Programs of which one part is like another, carried out in two lanes.
//!
//! Two interfaces under one stress have the same formulas, each in its own state. Where two operations are the same but for such a pair
//! of variables, one stands for both: the first lane of its row has what the one makes, the second what the other makes. Rows that the
//! two share have the same number in both lanes.

use super::constants::{Constant, Constants};
use super::program::{Instruction, Operation, Program, Source};

/// Fewer pairs of operations than this are not worth it.
const FEWEST: usize = 4;
/// Programs of more operations are not looked at: the search is quadratic.
const LONGEST: usize = 400;

/// Where a row of the program stands among the rows of two lanes.
#[derive(Debug, Clone, Copy, PartialEq)]
enum At {
    Both(usize),
    Lane(usize, usize),
}

impl Program {
    /// The same program in two lanes, by the two variables that make most pairs of operations; `None` where few are alike. Which
    /// constants are the same is decided with that.
    pub fn in_two_lanes(&mut self) -> Option<Program> {
        let mut constants = std::mem::take(&mut self.constants);
        let folded = self.folded_in_two(&mut constants);
        self.constants = constants;
        folded
    }

    fn folded_in_two(&self, constants: &mut Constants) -> Option<Program> {
        if self.instructions().len() > LONGEST || self.branches {
            return None;
        }
        let n = self.variables();
        let choices = (0..n).flat_map(|i| (i + 1..n).map(move |j| [i, j]));
        let pairings = choices.map(|twins| Pairing::new(self, twins, constants));
        let best = pairings.max_by_key(|pairing| pairing.count)?;
        (best.count >= FEWEST)
            .then(|| best.folded(constants))
            .flatten()
    }
}

/// Which operations stand for each other.
struct Pairing<'a> {
    program: &'a Program,
    variables: [usize; 2],
    /// For every row the one that is its twin, and the lane in which it stands itself.
    twins: Vec<Option<(usize, usize)>>,
    /// The operation in the second lane, of those in the first.
    seconds: Vec<Option<usize>>,
    /// Those in the second lane.
    taken: Vec<bool>,
    count: usize,
}

impl<'a> Pairing<'a> {
    fn new(program: &'a Program, [first, second]: [usize; 2], constants: &mut Constants) -> Self {
        let all = program.instructions();
        let mut pairing = Pairing {
            program,
            variables: [first, second],
            twins: vec![None; program.rows()],
            seconds: vec![None; all.len()],
            taken: vec![false; all.len()],
            count: 0,
        };
        pairing.twins[first] = Some((second, 0));
        pairing.twins[second] = Some((first, 1));
        for (a, one) in all.iter().enumerate() {
            if pairing.taken[a] || pairing.lane(one) != Some(0) {
                continue;
            }
            let image = pairing.image(one.operation);
            let alike = |b: &usize| {
                let free = !pairing.taken[*b] && *b != a && pairing.seconds[*b].is_none();
                free && all[*b].operation.is_like(image, constants)
            };
            // Also before it: of the two either may come first.
            let found = (0..all.len()).find(alike);
            if let Some(b) = found {
                pairing.join(a, b);
            }
        }
        pairing
    }

    /// The lane of all operands that are in one; `None` where none is, or not all are in the same.
    fn lane(&self, instruction: &Instruction<Constant>) -> Option<usize> {
        let operands = instruction.operation.operands().into_iter().flatten();
        let mut lanes = operands.filter_map(|row| self.twins[row].map(|(_, lane)| lane));
        let first = lanes.next()?;
        lanes.all(|lane| lane == first).then_some(first)
    }

    fn image(&self, operation: Operation<Constant>) -> Operation<Constant> {
        operation.moved(|row| self.twins[row].map_or(row, |(twin, _)| twin))
    }

    fn join(&mut self, a: usize, b: usize) {
        let all = self.program.instructions();
        let (one, other) = (all[a], all[b]);
        self.seconds[a] = Some(b);
        self.taken[b] = true;
        self.count += 1;
        let mut twin = |row: usize, with: usize| {
            self.twins[row] = Some((with, 0));
            self.twins[with] = Some((row, 1));
        };
        twin(one.result, other.result);
        if let (Some(row), Some(with)) = (one.second_result(), other.second_result()) {
            twin(row, with);
        }
    }

    /// The program of one operation for each pair.
    fn folded(&self, constants: &mut Constants) -> Option<Program> {
        let program = self.program;
        let mut folding = Folding {
            made: Program::empty(program.variables() - 1, Constants::default()),
            places: vec![None; program.rows()],
            lanes: Vec::new(),
        };
        let [first, second] = self.variables;
        for variable in 0..program.variables() {
            let row = variable - usize::from(variable > second);
            folding.places[variable] = Some(match variable {
                v if v == first => At::Lane(row, 0),
                v if v == second => At::Lane(first, 1),
                _ => At::Both(row),
            });
        }
        for (a, &one) in program.instructions().iter().enumerate() {
            if self.taken[a] {
                continue;
            }
            let other = self.seconds[a].map(|b| program.instructions()[b]);
            folding.emit(one, other);
        }
        folding.complete(program, self.variables, constants)
    }
}

/// A program in two lanes on its way.
struct Folding {
    made: Program,
    /// Where every row stands.
    places: Vec<Option<At>>,
    /// Rows that hold a lane of another in both.
    lanes: Vec<(usize, usize, usize)>,
}

impl Folding {
    fn place(&self, row: usize) -> At {
        self.places[row].expect("operands stand before what is made of them")
    }

    /// A row with this number in both lanes.
    fn both(&mut self, at: At) -> usize {
        let (row, lane) = match at {
            At::Both(row) => return row,
            At::Lane(row, lane) => (row, lane),
        };
        let known = self
            .lanes
            .iter()
            .find(|(from, of, _)| (*from, *of) == (row, lane));
        if let Some((.., made)) = known {
            return *made;
        }
        let result = self.made.take_row();
        self.made.push(Instruction {
            operation: Operation::Lane(row, lane),
            result,
            spare: result,
        });
        self.lanes.push((row, lane, result));
        result
    }

    fn emit(&mut self, one: Instruction<Constant>, other: Option<Instruction<Constant>>) {
        let mut operation = one.operation;
        let operands = one.operation.operands().into_iter().flatten();
        let moved: Vec<(usize, usize)> = operands
            .map(|row| match (self.place(row), other) {
                (At::Lane(to, _), Some(_)) => (row, to),
                (at, _) => (row, self.both(at)),
            })
            .collect();
        let second = one.second_result().map(|row| (row, self.made.take_row()));
        operation = operation.moved(|row| {
            let all = moved.iter().chain(&second);
            let to = all.clone().find(|(from, _)| *from == row);
            to.expect("an operand or a result").1
        });
        let result = self.made.take_row();
        let spare = if one.spare == one.result {
            result
        } else {
            self.made.take_row()
        };
        self.made.push(Instruction {
            operation,
            result,
            spare,
        });
        let at = |row: usize, lane: usize| match other {
            Some(_) => At::Lane(row, lane),
            None => At::Both(row),
        };
        self.places[one.result] = Some(at(result, 0));
        if let Some((row, to)) = second {
            self.places[row] = Some(at(to, 0));
        }
        if let Some(other) = other {
            self.places[other.result] = Some(at(result, 1));
            if let (Some(row), Some((_, to))) = (other.second_result(), second) {
                self.places[row] = Some(at(to, 1));
            }
        }
    }

    /// With the rates of the variables, those of twins in two lanes, and what else the program gives.
    fn complete(
        mut self,
        program: &Program,
        [first, second]: [usize; 2],
        constants: &mut Constants,
    ) -> Option<Program> {
        let n = program.variables();
        let mut outputs = Vec::new();
        for variable in (0..n).filter(|v| *v != second) {
            let rate = program.outputs[variable];
            outputs.push(match rate {
                Source::Number(x) if variable == first => match program.outputs[second] {
                    Source::Number(y) if constants.are_same(x, y) => rate,
                    _ => return None,
                },
                Source::Number(_) => rate,
                Source::Row(row) if variable == first => {
                    let Source::Row(other) = program.outputs[second] else {
                        return None;
                    };
                    match (self.place(row), self.place(other)) {
                        (At::Lane(a, 0), At::Lane(b, 1)) if a == b => Source::Row(a),
                        (At::Both(a), At::Both(b)) if a == b => Source::Row(a),
                        _ => return None,
                    }
                }
                Source::Row(row) => {
                    let at = self.place(row);
                    Source::Row(self.both(at))
                }
            });
        }
        let mut lanes = vec![0; outputs.len()];
        for &output in &program.outputs[n..] {
            let (source, lane) = match output {
                Source::Number(_) => (output, 0),
                Source::Row(row) => match self.place(row) {
                    At::Both(row) => (Source::Row(row), 0),
                    At::Lane(row, lane) => (Source::Row(row), lane),
                },
            };
            outputs.push(source);
            lanes.push(lane);
        }
        let at = |row: &usize| match self.place(*row) {
            At::Both(row) | At::Lane(row, _) => row,
        };
        let rows = |of: &[usize]| {
            let mut rows: Vec<usize> = of.iter().map(at).collect();
            rows.dedup();
            rows
        };
        let [kinks, branch_points, bases] =
            [&program.kinks, &program.branch_points, &program.bases].map(|of| rows(of));
        let places = (0..n).map(|variable| match self.place(variable) {
            At::Both(row) => (row, 0),
            At::Lane(row, lane) => (row, lane),
        });
        self.made.places = places.collect();
        self.made.own_factors.clone_from(&program.own_factors);
        self.made.kinks = kinks;
        self.made.branch_points = branch_points;
        self.made.bases = bases;
        self.made.outputs = outputs;
        self.made.lanes = lanes;
        self.made.constants = constants.clone();
        self.made.order();
        Some(self.made)
    }
}
