//! Times as the clocks of instruments write them: `12:30:01.25`, `2023-05-01T12:30:01`, `01.05.2023 12:30:01`.

const DAY: f64 = 86_400.0;

/// A time of day, with its day where that is written.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Moment {
    /// Days since some day.
    day: Option<i64>,
    /// Seconds since midnight.
    second: f64,
}

impl Moment {
    /// Reads it; `None` for what is none, and for dates with strokes, whose day and month change places between countries.
    pub fn read(cell: &str) -> Option<Self> {
        let cell = cell.trim().trim_end_matches('Z');
        let (date, clock) = match cell.split_once(['T', ' ']) {
            Some((date, clock)) => (Some(date), clock.trim()),
            None => (None, cell),
        };
        let mut parts = clock.split(':');
        let mut whole = |most: u32| {
            let part: u32 = parts.next()?.parse().ok()?;
            (part < most).then_some(f64::from(part))
        };
        let (hours, minutes) = (whole(24)?, whole(60)?);
        let seconds = match parts.next() {
            None => 0.0,
            Some(text) if text.starts_with(|c: char| c.is_ascii_digit()) => {
                text.replace(',', ".").parse().ok()?
            }
            Some(_) => return None,
        };
        if parts.next().is_some() || !(0.0..61.0).contains(&seconds) {
            return None;
        }
        let day = match date {
            Some(date) => Some(day_of(date)?),
            None => None,
        };
        Some(Moment {
            day,
            second: 3600.0 * hours + 60.0 * minutes + seconds,
        })
    }

    /// The seconds since the first of some moments. A clock without days that goes back by half a day has passed midnight.
    pub fn seconds(moments: &[Moment]) -> Vec<f64> {
        let Some(first) = moments.first() else {
            return Vec::new();
        };
        let (mut midnights, mut before) = (0.0, first.second);
        let of = |moment: &Moment| {
            let days = match (moment.day, first.day) {
                (Some(day), Some(first)) => (day - first) as f64,
                _ => {
                    midnights += f64::from(moment.second < before - 0.5 * DAY);
                    before = moment.second;
                    midnights
                }
            };
            days * DAY + (moment.second - first.second)
        };
        moments.iter().map(of).collect()
    }
}

/// The number of a day, from `2023-05-01` or `01.05.2023`.
fn day_of(date: &str) -> Option<i64> {
    let of = |sign: char| -> Option<[i64; 3]> {
        let parts: Option<Vec<i64>> = date.split(sign).map(|part| part.parse().ok()).collect();
        parts?.try_into().ok()
    };
    let [year, month, day] = of('-').or_else(|| of('.').map(|[d, m, y]| [y, m, d]))?;
    let is_date =
        (1..=9999).contains(&year) && (1..=12).contains(&month) && (1..=31).contains(&day);
    // Years that begin in March end with the day that may be missing.
    let (year, month) = if month > 2 {
        (year, month - 3)
    } else {
        (year - 1, month + 9)
    };
    let leaps = year / 4 - year / 100 + year / 400;
    is_date.then_some(365 * year + leaps + (153 * month + 2) / 5 + day)
}

#[cfg(test)]
mod test {
    use super::*;

    fn seconds(cells: &[&str]) -> Option<Vec<f64>> {
        let moments: Option<Vec<Moment>> = cells.iter().map(|cell| Moment::read(cell)).collect();
        moments.map(|all| Moment::seconds(&all))
    }

    #[test]
    fn clocks_are_read_across_midnight_and_the_end_of_a_month() {
        for (cells, after) in [
            (["12:30:01", "12:30:01.25"], 0.25),
            (["23:59:59", "00:00:01"], 2.0),
            (["2024-02-28T23:59:59", "2024-02-29 00:00:01"], 2.0),
            (["2023-02-28T00:00:00Z", "2023-03-01T00:00:00Z"], DAY),
            (["31.12.2023 12:00", "01.01.2024 12:00"], DAY),
        ] {
            assert_eq!(seconds(&cells), Some(vec![0.0, after]), "{cells:?}");
        }
        for cell in [
            "0.5",
            "12",
            "25:00:00",
            "12:61",
            "05/01/2023 12:00",
            "2023-13-01 12:00",
            "a:b",
        ] {
            assert_eq!(Moment::read(cell), None, "{cell}");
        }
    }
}
