//! What a misspelt name was meant to be.

/// The name that is most like the one given, if one is like it.
pub(crate) fn nearest<'n>(name: &str, names: impl IntoIterator<Item = &'n str>) -> Option<&'n str> {
    // Who writes names of this length does not want them corrected.
    if name.len() > 100 {
        return None;
    }
    let distance = |n: &'n str| (strsim::damerau_levenshtein(name, n), n);
    let (far, near) = names.into_iter().filter(|n| n.len() <= 100).take(2_000).map(distance).min()?;
    (far <= 1 + name.len() / 4 && far < name.len()).then_some(near)
}
