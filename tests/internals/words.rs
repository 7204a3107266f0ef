//! Numbers as people write them.

use twinslip_cli::internals::{count, flagged, several, time};

#[test]
fn an_option_is_told_as_its_flag() {
    for (text, told) in [
        ("raise `max_steps`", "raise --max-steps"),
        (
            "`start` 1,2 and `period-guess`",
            "--start 1,2 and --period-guess",
        ),
        (
            "use `section` to see what it does, or give a `start`",
            "use `section` to see what it does, or give a --start",
        ),
        ("one ` alone, then `rtol", "one ` alone, then `rtol"),
        ("`a``rtol``", "`a`--rtol`"),
    ] {
        assert_eq!(flagged(text), told);
    }
}

#[test]
fn numbers_are_written_as_people_write_them() {
    let counts = [0, 999, 1000, 63_183, 10_000_000].map(count);
    assert_eq!(counts, ["0", "999", "1,000", "63,183", "10,000,000"]);
    assert_eq!(several(1, "event", "events"), "1 event");
    assert_eq!(several(2000, "event", "events"), "2,000 events");
    let times = [0.0, 0.0213, 0.0999, 0.325, 1.23, 59.96, 200.2, 7509.0].map(time);
    let expected = [
        "1 ms",
        "21 ms",
        "0.10 s",
        "0.33 s",
        "1.2 s",
        "1 min 0 s",
        "3 min 20 s",
        "2 h 5 min",
    ];
    assert_eq!(times, expected);
}
