//! What is compared.

use twinslip::integrate::Choice;

/// The methods of this build by their names, `auto` last.
pub fn methods() -> Vec<(String, Choice)> {
    let mut methods: Vec<(String, Choice)> = Choice::all()
        .into_iter()
        .map(|choice| (choice.name().to_owned(), choice))
        .filter(|(name, _)| name != "auto")
        .collect();
    methods.push(("auto".into(), Choice::named("auto").expect("it exists")));
    methods
}
