//! Functions of what interfaces do whose zeros are special points of their branches and curves.

use crate::model::Loading;
use crate::orbit::Profile;
use std::fmt;
use std::sync::Arc;

/// The value of a function of what interfaces do: at V_H and K, of an equilibrium or of an orbit by what is told of it, with the period of the orbit or of
/// the oscillation at a Hopf point. NaN where it is undefined.
pub type ProfileFunction = dyn Fn(Loading, &Profile, Option<f64>) -> f64 + Send + Sync;

/// A function of what interfaces do whose zeros are special points.
#[derive(Clone)]
pub struct UserFunction {
    /// In words, which the special points have in their notes.
    pub text: String,
    /// Its value.
    pub value: Arc<ProfileFunction>,
}

/// The note of a zero of `EXPRESSION`, or of `EXPRESSION = VALUE`.
pub(super) fn zero_note(text: &str) -> String {
    match text.contains('=') {
        true => text.to_owned(),
        false => format!("{text} = 0"),
    }
}

impl fmt::Debug for UserFunction {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("UserFunction").field(&self.text).finish()
    }
}

impl PartialEq for UserFunction {
    fn eq(&self, other: &Self) -> bool {
        self.text == other.text && Arc::ptr_eq(&self.value, &other.value)
    }
}
