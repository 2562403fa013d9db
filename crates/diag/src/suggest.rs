//! What a misspelt name was probably meant to be.

/// The candidate nearest to `wanted`, where one is near enough to be worth saying. Of equals the first.
pub fn nearest<'a>(wanted: &str, among: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let (exact, wanted) = (wanted, wanted.to_lowercase());
    let mut best: Option<(f64, &str)> = None;
    for candidate in among.into_iter().filter(|c| *c != exact).take(MOST) {
        let score = likeness(&wanted, &candidate.to_lowercase());
        if score > NEAR && best.is_none_or(|(b, _)| score > b) {
            best = Some((score, candidate));
        }
    }
    best.map(|(_, candidate)| candidate)
}

/// Names less alike than this are not proposed.
const NEAR: f64 = 0.66;

/// What a name with one slip counts as, at least.
const ONE_SLIP: f64 = 0.67;

/// Names longer than this are compared by their beginnings only, and no more names than this are looked at: they come from files of strangers, and a
/// comparison takes as many steps as the lengths multiplied.
const LONGEST: usize = 100;
const MOST: usize = 2_000;

/// From 0 to 1. Slips of the finger count little, whatever their kind; a name that is the other's whole last part counts as near.
fn likeness(a: &str, b: &str) -> f64 {
    let (a, b): (String, String) = (a.chars().take(LONGEST).collect(), b.chars().take(LONGEST).collect());
    let slips = match strsim::damerau_levenshtein(&a, &b) {
        // In a name of two or three letters one slip weighs too much to be told from another name by its share; a single letter is nobody's slip.
        1 if a.len() > 1 => strsim::normalized_damerau_levenshtein(&a, &b).max(ONE_SLIP),
        _ => strsim::normalized_damerau_levenshtein(&a, &b),
    };
    let tail = |long: &str, short: &str| {
        let joint = |rest: &str| short.starts_with('/') || rest.ends_with(['/', '.', '_']);
        short.len() > 2 && long.strip_suffix(short).is_some_and(joint)
    };
    if a != b && (tail(&a, &b) || tail(&b, &a)) { slips.max(0.7) } else { slips }
}

/// The end of a message: `; did you mean `x`?`, or nothing.
pub fn or_else(found: Option<&str>) -> String {
    found.map(|name| format!("; did you mean `{name}`?")).unwrap_or_default()
}

/// The first of many names, for a line of help; `none` where there are none.
pub fn listed<'a>(names: impl IntoIterator<Item = &'a str>) -> String {
    let names: Vec<&str> = names.into_iter().collect();
    if names.is_empty() {
        return "none".to_owned();
    }
    let shown = names.iter().take(12).map(|n| format!("`{n}`")).collect::<Vec<_>>().join(", ");
    if names.len() > 12 { format!("{shown}, and {} more", names.len() - 12) } else { shown }
}

#[cfg(test)]
mod tests {
    use super::nearest;

    #[test]
    fn slips_are_understood_and_strangers_are_not() {
        let topics = ["/odom", "/scan", "/cmd_vel", "/robot1/imu"];
        assert_eq!(nearest("/odmo", topics), Some("/odom"));
        assert_eq!(nearest("/cmdvel", topics), Some("/cmd_vel"));
        assert_eq!(nearest("/imu", topics), Some("/robot1/imu"));
        assert_eq!(nearest("/battery_state", topics), None);
        assert_eq!(nearest("cc", ["d", "c"]), Some("c"));
        assert_eq!(nearest("d", ["c"]), None);
    }
}
