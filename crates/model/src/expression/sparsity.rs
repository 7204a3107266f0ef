//! Which variables every formula depends on, for derivatives along many of them at once.

use super::{Expressions, Operation};

/// Groups of variables of which no formula depends on more than one: its derivatives along all of a group are that along the one, so that a
/// Jacobian takes as many derivatives as there are groups. (Curtis, Powell & Reid 1974, On the estimation of sparse Jacobian matrices.)
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ColumnGroups {
    /// The group of every variable.
    of_variable: Vec<usize>,
    count: usize,
    /// For every formula its variables, each with its group.
    rows: Vec<Vec<(usize, usize)>>,
}

/// A set of variables, each a bit.
type Variables = u128;

/// As many variables are told apart.
const MOST: usize = Variables::BITS as usize;

fn members(set: Variables) -> impl Iterator<Item = usize> {
    (0..MOST).filter(move |i| set >> i & 1 == 1)
}

impl Expressions {
    /// The variables that each formula depends on.
    fn dependencies(&self) -> Vec<Variables> {
        let mut sets: Vec<Variables> = Vec::with_capacity(self.operations.len());
        for operation in &self.operations {
            let mut set = match operation {
                Operation::Variable(i) => 1 << i,
                _ => 0,
            };
            let _ = operation.moved(|operand| {
                set |= sets[operand];
                operand
            });
            sets.push(set);
        }
        self.outputs.iter().map(|&place| sets[place]).collect()
    }

    /// Groups of so many variables, found one after the other: each comes into the first group where it meets no other one in a formula.
    ///
    /// # Panics
    /// For more than 128 variables.
    pub fn column_groups(&self, variables: usize) -> ColumnGroups {
        assert!(variables <= MOST, "a bit for each of {variables} variables");
        let rows = self.dependencies();
        let mut groups: Vec<Variables> = Vec::new();
        let mut of_variable = Vec::with_capacity(variables);
        for j in 0..variables {
            let with_it = rows.iter().filter(|row| *row >> j & 1 == 1);
            let others = with_it.fold(0, |all, row| all | row);
            let free = groups.iter().position(|group| group & others == 0);
            let group = free.unwrap_or(groups.len());
            if group == groups.len() {
                groups.push(0);
            }
            groups[group] |= 1 << j;
            of_variable.push(group);
        }
        let entries = |row: Variables| members(row).map(|j| (of_variable[j], j)).collect();
        ColumnGroups {
            rows: rows.into_iter().map(entries).collect(),
            count: groups.len(),
            of_variable,
        }
    }
}

impl ColumnGroups {
    /// The number of groups.
    pub fn count(&self) -> usize {
        self.count
    }

    /// 1 for a variable of this group, 0 for others.
    pub fn seed(&self, variable: usize, group: usize) -> f64 {
        f64::from(u8::from(self.of_variable[variable] == group))
    }

    /// The variables that a formula depends on, each with its group.
    pub fn row(&self, formula: usize) -> &[(usize, usize)] {
        &self.rows[formula]
    }
}
