//! What a misspelt name was probably meant to be.

/// Names less alike than this are not proposed.
const NEAR: f64 = 0.66;
/// Names longer than this are compared by their beginnings only.
const LONGEST: usize = 100;

/// The candidate nearest to a name, where one is near enough to be worth saying. Of equals the first.
pub(crate) fn nearest<'n>(wanted: &str, among: impl IntoIterator<Item = &'n str>) -> Option<&'n str> {
    let short = |name: &str| name.chars().take(LONGEST).collect::<String>().to_lowercase();
    let wanted = short(wanted);
    let mut best: Option<(f64, &str)> = None;
    for candidate in among {
        let score = strsim::normalized_damerau_levenshtein(&wanted, &short(candidate));
        if score > NEAR && best.is_none_or(|(b, _)| score > b) {
            best = Some((score, candidate));
        }
    }
    best.map(|(_, name)| name)
}

/// A few names, for a line of help.
pub(crate) fn listed<'n>(names: impl IntoIterator<Item = &'n str>) -> String {
    let names: Vec<String> = names.into_iter().map(|n| format!("`{n}`")).collect();
    const MOST: usize = 8;
    match names.len() {
        0 => "none".to_owned(),
        count if count > MOST => {
            format!("{} and {} more", names.get(..MOST).unwrap_or_default().join(", "), count - MOST)
        }
        _ => names.join(", "),
    }
}
