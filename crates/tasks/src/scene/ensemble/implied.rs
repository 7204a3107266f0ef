//! What a command line says without saying it.

/// What the words of a command line imply: fits are in SI.
pub fn implied<S: AsRef<str>>(words: &[S]) -> Option<&'static str> {
    const SI: &str = "--si";
    let has = |flag: &str| {
        let mut words = words.iter().map(AsRef::as_ref);
        words.any(|word| {
            let rest = word.strip_prefix(flag);
            rest.is_some_and(|rest| rest.is_empty() || rest.starts_with('='))
        })
    };
    (has("--ensemble") && !has(SI) && !has("--system")).then_some(SI)
}
