//! The text of a laboratory's file, and the cells of its lines.

/// How a file separates its columns.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Separator {
    /// A sign of one byte between two cells.
    Sign(u8),
    /// Any number of blanks.
    Blanks,
}

impl Separator {
    /// That of a line of numbers. A comma within quotes, or between digits where blanks or another sign separate the columns, is one of decimals.
    pub fn of(line: &str) -> Self {
        let bare: String = line.split('"').step_by(2).collect();
        if let Some(sign) = [';', '\t'].into_iter().find(|&sign| bare.contains(sign)) {
            return Separator::Sign(sign as u8);
        }
        let words: Vec<&str> = bare.split_ascii_whitespace().collect();
        let is_decimal = |word: &&str| {
            let is_number = word.starts_with(|c: char| c.is_ascii_digit() || "+-,.".contains(c));
            word.matches(',').count() <= 1
                && !word.contains('.')
                && is_number
                && !word.ends_with(',')
        };
        let by_blanks = words.len() > 1
            && words.iter().all(is_decimal)
            && words.iter().any(|word| word.contains(','));
        if bare.contains(',') && !by_blanks {
            Separator::Sign(b',')
        } else {
            Separator::Blanks
        }
    }

    /// The cells of a line, without their quotes.
    pub fn cells(self, line: &str) -> Cells<'_> {
        Cells {
            rest: Some(line),
            separator: self,
        }
    }

    /// The cells of a line without the empty ones at its end.
    pub fn filled(self, line: &str) -> Vec<&str> {
        let mut cells: Vec<&str> = self.cells(line).collect();
        while cells.last().is_some_and(|cell| cell.is_empty()) {
            cells.pop();
        }
        cells
    }
}

/// The cells of a line, one after the other; nothing is copied.
#[derive(Debug, Clone)]
pub(super) struct Cells<'a> {
    rest: Option<&'a str>,
    separator: Separator,
}

impl<'a> Iterator for Cells<'a> {
    type Item = &'a str;

    fn next(&mut self) -> Option<&'a str> {
        let mut rest = self.rest?;
        if self.separator == Separator::Blanks {
            rest = rest.trim_ascii_start();
            if rest.is_empty() {
                self.rest = None;
                return None;
            }
        }
        let mut is_quoted = false;
        let ends = |&byte: &u8| {
            is_quoted ^= byte == b'"';
            !is_quoted
                && match self.separator {
                    Separator::Sign(sign) => byte == sign,
                    Separator::Blanks => byte.is_ascii_whitespace(),
                }
        };
        // What ends a cell is ASCII, so that both parts are text.
        let end = rest.as_bytes().iter().position(ends);
        let cell = end.map_or(rest, |end| &rest[..end]);
        self.rest = end.map(|end| &rest[end + 1..]);
        let cell = cell.trim();
        match cell.as_bytes() {
            [b'"', ..] | [.., b'"'] => Some(cell.trim_matches('"').trim()),
            _ => Some(cell),
        }
    }
}

/// The text of a file in UTF-8, in UTF-16 as spreadsheets write it, or in Latin-1, as instruments write `µ`; with one way to end lines.
///
/// # Errors
/// A sentence's end for a file that is no text, with what to do.
pub(super) fn decoded(bytes: Vec<u8>) -> Result<String, &'static str> {
    /// How files begin that laboratories keep data in, but that are no text.
    const OTHERS: [(&[u8], &str); 5] = [
        (
            b"PK\x03\x04",
            "it is a spreadsheet or an archive; save its sheet as CSV",
        ),
        (
            b"\xd0\xcf\x11\xe0",
            "it is a spreadsheet; save its sheet as CSV",
        ),
        (b"\x1f\x8b", "it is compressed; unpack it, as by gunzip"),
        (
            b"\x89HDF",
            "it is HDF5, as MATLAB's new files are; save its columns as text",
        ),
        (
            b"MATLAB 5",
            "it is a file of MATLAB; save its columns as text, as by writematrix",
        ),
    ];
    if let Some((_, what)) = OTHERS.iter().find(|(head, _)| bytes.starts_with(head)) {
        return Err(what);
    }
    let wide = |begin: usize, of: fn([u8; 2]) -> u16| {
        let units = bytes[begin..]
            .chunks_exact(2)
            .map(|pair| of([pair[0], pair[1]]));
        let text = char::decode_utf16(units).map(|c| c.unwrap_or(char::REPLACEMENT_CHARACTER));
        text.collect::<String>()
    };
    // Without a mark at its beginning, text in two bytes shows by every other one being zero.
    let text = match bytes[..] {
        [0xff, 0xfe, ..] => wide(2, u16::from_le_bytes),
        [0xfe, 0xff, ..] => wide(2, u16::from_be_bytes),
        [a, 0, b, 0, ..] if a > 0 && b > 0 => wide(0, u16::from_le_bytes),
        [0, a, 0, b, ..] if a > 0 && b > 0 => wide(0, u16::from_be_bytes),
        _ => String::from_utf8(bytes)
            .unwrap_or_else(|error| error.as_bytes().iter().map(|&b| char::from(b)).collect()),
    };
    if text.contains('\0') {
        return Err("it is no text; save its columns as text");
    }
    // Old instruments end lines by a return alone.
    Ok(match text.contains('\r') && !text.contains('\n') {
        true => text.replace('\r', "\n"),
        false => text,
    })
}
