//! What the C library is, and can count.

use twinslip::internals::{compatible, counted};
#[test]
fn a_point_update_is_the_same_library() {
    assert!(compatible([6, 4, 1], [6, 4, 1]));
    assert!(compatible([6, 4, 2], [6, 4, 1]));
    assert!(!compatible([6, 5, 0], [6, 4, 1]));
    assert!(!compatible([7, 4, 1], [6, 4, 1]));
}

#[test]
fn what_c_cannot_count_is_refused() {
    assert_eq!(counted("x", 3), Ok(3));
    assert!(counted("x", 1 << 31).is_err_and(|error| error.is_input()));
}
