//! Rows as bytes, to the last bit, on their way from one rank to another.

use twinslip::equilibrium::Symmetry;
use twinslip::number::Uncertain;
use twinslip::sweep::SweepRow;
use twinslip_tasks::views::REGIMES;

/// All rows, one after the other.
pub fn pack(rows: &[SweepRow]) -> Vec<u8> {
    let mut to = Vec::new();
    for row in rows {
        count(&mut to, row.number);
        for list in [&row.parameters, &row.start, &row.dots] {
            count(&mut to, list.len());
            numbers(&mut to, list);
        }
        let regime = REGIMES.iter().position(|&regime| regime == row.regime);
        count(&mut to, regime.expect("all regimes are listed"));
        count(
            &mut to,
            match row.symmetry {
                None => 0,
                Some(Symmetry::Symmetric) => 1,
                Some(Symmetry::Asymmetric) => 2,
            },
        );
        // No orbit closes after no return at all.
        count(&mut to, row.returns_per_period.unwrap_or(0));
        count(&mut to, row.returns);
        maybe(&mut to, row.period.map(|x| [x]));
        maybe(&mut to, row.range.map(|(low, high)| [low, high]));
        let exponent = row.lyapunov_max.map(|x| [x.value, x.uncertainty]);
        maybe(&mut to, exponent);
        let note = row.note.as_deref().unwrap_or_default();
        count(&mut to, usize::from(row.note.is_some()));
        count(&mut to, note.len());
        to.extend_from_slice(note.as_bytes());
    }
    to
}

fn count(to: &mut Vec<u8>, n: usize) {
    to.extend((n as u64).to_le_bytes());
}

fn numbers(to: &mut Vec<u8>, list: &[f64]) {
    for x in list {
        to.extend(x.to_le_bytes());
    }
}

fn maybe<const N: usize>(to: &mut Vec<u8>, list: Option<[f64; N]>) {
    count(to, usize::from(list.is_some()));
    numbers(to, &list.unwrap_or([0.0; N]));
}

/// The rows again; `None` if these are not the bytes of any.
pub fn unpack(bytes: &[u8]) -> Option<Vec<SweepRow>> {
    let mut from = From(bytes);
    let mut rows = Vec::new();
    while !from.0.is_empty() {
        rows.push(from.row()?);
    }
    Some(rows)
}

/// What is still to be read.
struct From<'a>(&'a [u8]);

impl From<'_> {
    fn row(&mut self) -> Option<SweepRow> {
        let number = self.count()?;
        Some(SweepRow {
            number,
            parameters: self.list()?,
            start: self.list()?,
            dots: self.list()?,
            regime: *REGIMES.get(self.count()?)?,
            symmetry: match self.count()? {
                0 => None,
                1 => Some(Symmetry::Symmetric),
                2 => Some(Symmetry::Asymmetric),
                _ => return None,
            },
            returns_per_period: Some(self.count()?).filter(|&q| q > 0),
            returns: self.count()?,
            period: self.maybe()?.map(|[x]| x),
            range: self.maybe()?.map(|[low, high]| (low, high)),
            lyapunov_max: self.maybe()?.map(|[x, bound]| Uncertain::new(x, bound)),
            note: self.note()?,
        })
    }

    fn take(&mut self, length: usize) -> Option<&[u8]> {
        let (taken, rest) = self.0.split_at_checked(length)?;
        self.0 = rest;
        Some(taken)
    }

    fn count(&mut self) -> Option<usize> {
        let bytes = self.take(8)?.try_into().ok()?;
        usize::try_from(u64::from_le_bytes(bytes)).ok()
    }

    fn numbers<const N: usize>(&mut self) -> Option<[f64; N]> {
        let mut list = [0.0; N];
        for x in &mut list {
            *x = f64::from_le_bytes(self.take(8)?.try_into().ok()?);
        }
        Some(list)
    }

    fn list(&mut self) -> Option<Vec<f64>> {
        let length = self.count()?;
        // No longer than what is there, whatever the length says.
        let bytes = self.take(length.checked_mul(8)?)?;
        let number = |bytes: &[u8]| Some(f64::from_le_bytes(bytes.try_into().ok()?));
        bytes.chunks(8).map(number).collect()
    }

    fn maybe<const N: usize>(&mut self) -> Option<Option<[f64; N]>> {
        let there = self.count()? == 1;
        let list = self.numbers()?;
        Some(there.then_some(list))
    }

    fn note(&mut self) -> Option<Option<String>> {
        let there = self.count()? == 1;
        let length = self.count()?;
        let text = String::from_utf8(self.take(length)?.to_vec()).ok()?;
        Some(there.then_some(text))
    }
}
